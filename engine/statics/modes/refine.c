/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/modes/parts.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/model/pose.h"

/* The shape to twice a double's precision, and what last bits do to a stiffness. */

enum { MOST_STEPS = 8, SAMPLES = 3 };

/* Shares of the largest eigenvalue: one that a plain factor bears, and next to none. */
static const double FIRM = 1.01e-10, HARDLY = 1e-24;

static double largest(const strut_dd *x, int32_t n) {
  double size = 0.0;
  for (int32_t i = 0; i < n; i++) size = fmax(size, fabs(x[i].hi));
  return size;
}

static void move(strut_vibration *v, const strut_dd *step, double sign) {
  for (int32_t i = 0; i < v->n; i++) {
    strut_dd *q = &v->q[v->shape->coordinate[i]];
    *q = dd_add(*q, dd_scale(step[i], sign));
  }
  strut_vibration_update(v);
}

/*
 * Newton's method from the shape as doubles give it, whose last bits leave forces of c times a bit.
 * It is that close already; a step that is not tiny is taken back. `firm` makes K regular where
 * something moves freely, and slows down what is softer. Returns true when nothing is left to do.
 */
static bool settle(strut_modes_work *work, double firm, strut_dd *step) {
  strut_vibration *v = work->v;
  strut_vibration_force(v, step);
  double force = largest(step, v->n);
  for (int i = 0; i < MOST_STEPS && force > 0; i++) {
    strut_modes_factorise(&work->solver, firm * v->largest);
    strut_modes_solve(&work->solver, step);
    double size = largest(step, v->n);
    if (!(size < 1e-6 * v->model->size)) return true;
    move(v, step, 1.0);
    strut_dd *after = v->work;
    strut_vibration_force(v, after);
    double left = largest(after, v->n);
    if (!(left < force)) {
      move(v, step, -1.0);
      return size < 1e-20 * v->model->size;
    }
    memcpy(step, after, (size_t)v->n * sizeof *step);
    if (left < 1e-25 * v->shape->force_scale || size < 1e-22 * v->model->size) return true;
    if (left > 1e-2 * force && i > 0) return false;
    force = left;
  }
  return !(force > 0);
}

/* -1 to 1, from an index. */
static double stirred(uint64_t i) {
  uint64_t z = (i + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1.0;
}

/* Elements: the last bits of strain and natural strain, and of the positions they are made of. */
static void sample_elements(const strut_modes_work *work, bool at_rest, uint64_t first,
                            double *noise, strut_dd *x) {
  const strut_vibration *v = work->v;
  const strut_element_table *t = &v->model->elements;
  strut_element_pose pose;
  for (int32_t i = 0; i < t->count; i++) {
    const strut_element *e = &t->element[i];
    bool acts = strut_vibration_pose(v, i, &pose);
    double bits = DBL_EPSILON * (fabs(pose.strain) + fabs(pose.natural));
    if (e->strain == STRUT_STRAIN_ANGLE) bits += 4.0 * DBL_EPSILON; /* of directions */
    for (int32_t k = 0; k < e->nodes && !at_rest; k++) {
      const double *at = v->rounded + t->at[e->first + k];
      bits += hypot(pose.b[2 * k], pose.b[2 * k + 1]) * strut_coordinate_rounding(at, at);
    }
    noise[i] = acts ? -pose.slope * bits * stirred(first + (uint64_t)i) : 0.0;
    for (int32_t k = 0; k < 2 * e->nodes && at_rest; k++) {
      int32_t row = v->shape->row_of[t->at[e->first + k / 2] + (uint32_t)(k % 2)];
      if (row >= 0) x[row] = dd_sub(x[row], dd_of(noise[i] * pose.b[k]));
    }
  }
}

/* How the forces of elements follow once the shape has come to rest again. */
static void settle_elements(const strut_modes_work *work, const double *moved, double *noise) {
  const strut_vibration *v = work->v;
  strut_element_pose pose;
  for (int32_t i = 0; i < v->model->elements.count; i++) {
    if (strut_vibration_pose(v, i, &pose))
      noise[i] += pose.slope * strut_vibration_strain(v, i, &pose, moved);
  }
}

/*
 * Rest lengths off by up to half of their last bit: how the forces follow once it has come to rest
 * again; or, in a shape that is not at rest, lengths off by their last bits.
 */
static void sample_noise(strut_modes_work *work, bool at_rest, uint64_t sample, double *noise,
                         double *elements, strut_dd *x) {
  const strut_vibration *v = work->v;
  const strut_member_table *t = &v->model->members;
  uint64_t first = sample * (uint64_t)t->count;
  for (int32_t i = 0; i < v->n; i++) x[i] = dd_of(0.0);
  for (int32_t j = 0; j < t->count; j++) {
    const strut_vibration_member *m = &v->member[j];
    double bits = 0.5 * DBL_EPSILON * t->rest[j] * stirred(first + (uint64_t)j);
    if (!at_rest) bits = DBL_EPSILON * (m->length + t->rest[j]) * stirred(first + (uint64_t)j);
    noise[j] = m->taut ? -t->stiffness[j] * bits : 0.0;
    if (!at_rest || !m->taut) continue;
    double pull[2] = {noise[j] * m->ux.hi, noise[j] * m->uy.hi};
    for (uint32_t c = 0; c < 2; c++) {
      int32_t a = v->shape->row_of[t->from[j] + c], b = v->shape->row_of[t->to[j] + c];
      if (a >= 0) x[a] = dd_add(x[a], dd_of(pull[c]));
      if (b >= 0) x[b] = dd_sub(x[b], dd_of(pull[c]));
    }
  }
  uint64_t behind = SAMPLES * (uint64_t)t->count + sample * (uint64_t)v->model->elements.count;
  sample_elements(work, at_rest, behind, elements, x);
  if (at_rest) {
    strut_modes_solve(&work->solver, x);
    double *moved = (double *)v->work;
    for (int32_t i = 0; i < v->n; i++) moved[i] = dd_double(x[i]);
    for (int32_t j = 0; j < t->count; j++)
      if (v->member[j].taut)
        noise[j] += t->stiffness[j] * strut_vibration_spread(v, j, moved).along;
    settle_elements(work, moved, elements);
  }
  for (int32_t j = 0; j < t->count; j++)
    noise[j] = v->member[j].length > 0 ? noise[j] / v->member[j].length : 0.0;
}

/* What the noise of its force, and the rounding of its gradient, do to a motion x (n). */
static double element_noise(const strut_vibration *v, int32_t i, double noise, const double *x) {
  const strut_element *e = &v->model->elements.element[i];
  const uint32_t *at = v->model->elements.at + e->first;
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT] = {0}, sum = 0.0, size = 0.0, far = 0.0;
  double blur = 2.0 * DBL_EPSILON; /* relative, of second derivatives */
  int32_t n = 2 * e->nodes;
  strut_element_pose pose;
  if (!strut_vibration_pose(v, i, &pose)) return 0.0;
  strut_element_bend(v->model, i, v->rounded, 1.0, bend);
  for (int32_t k = 0; k < e->nodes && e->strain == STRUT_STRAIN_ANGLE; k++) {
    const double *place = v->rounded + at[k];
    blur += 2.0 * hypot(pose.b[2 * k], pose.b[2 * k + 1]) * strut_coordinate_rounding(place, place);
  }
  /* of the last node nothing: it moves by 0 against itself */
  int32_t moving = e->strain == STRUT_STRAIN_FOOT ? n : n - 2;
  for (int32_t r = 0; r < moving; r++) {
    double own = strut_vibration_relative(v, i, r, x);
    far += fabs(pose.b[r] * own);
    for (int32_t c = 0; c < moving; c++) {
      double part = own * bend[r * n + c] * strut_vibration_relative(v, i, c, x);
      sum += part, size += fabs(part);
    }
  }
  double along = fabs(strut_vibration_strain(v, i, &pose, x)), bits = 2.0 * DBL_EPSILON * far;
  return fabs(noise * sum) + blur * fabs(pose.force) * size +
         fabs(pose.slope) * bits * (2.0 * along + bits);
}

static void measure_noise(strut_modes_work *work, const double *noise, const double *elements) {
  const strut_vibration *v = work->v;
  strut_eigen_set *set = &work->set;
  for (int32_t i = 0; i < set->count; i++) {
    double sum = 0.0;
    for (int32_t j = 0; j < v->model->members.count; j++) {
      if (noise[j] == 0) continue;
      double across = strut_vibration_spread(v, j, set->vector + (size_t)i * (size_t)v->n).across;
      sum += noise[j] * across * across;
    }
    for (int32_t j = 0; j < v->model->elements.count; j++)
      sum = fabs(sum) + element_noise(v, j, elements[j], set->vector + (size_t)i * (size_t)v->n);
    double rounding = 4.0 * STRUT_DD_EPSILON * v->largest;           /* of the sums that make K */
    set->noise[i] = fmax(set->noise[i], 2.0 * fabs(sum) + rounding); /* twice: few samples */
  }
}

strut_status strut_modes_settle(strut_modes_work *work, strut_error *error) {
  strut_dd *step = strut_arena_allocate(work->arena, (size_t)work->v->n, sizeof *step);
  if (!step) return strut_no_memory(error, "");
  if (!settle(work, FIRM, step)) settle(work, HARDLY, step);
  return STRUT_OK;
}

/* Of what last bits make of a force: it is known from here on. Of k times the length: it is more than the
   rounding of twice a double's digits. */
static const double KNOWN = 1e3, SOME = 1e-22;

/* Largest noise of the forces of members (members) and elements [N]. */
static strut_status sample_forces(strut_modes_work *work, bool at_rest, double *members,
                                  double *elements, strut_error *error) {
  const strut_vibration *v = work->v;
  size_t member_count = (size_t)v->model->members.count;
  size_t element_count = (size_t)v->model->elements.count;
  strut_arena scratch = {0};
  strut_dd *x = strut_arena_allocate(&scratch, (size_t)v->n, sizeof *x);
  double *one = strut_arena_allocate(&scratch, member_count, sizeof *one);
  double *other = strut_arena_allocate(&scratch, element_count, sizeof *other);
  bool good = x && one && other;
  if (good && at_rest) strut_modes_factorise(&work->solver, FIRM * v->largest);
  for (uint64_t sample = 0; sample < SAMPLES && good; sample++) {
    sample_noise(work, at_rest, sample, one, other, x);
    for (size_t j = 0; j < member_count; j++)
      members[j] = fmax(members[j], fabs(one[j]) * v->member[j].length);
    for (size_t i = 0; i < element_count; i++) elements[i] = fmax(elements[i], fabs(other[i]));
  }
  strut_arena_free(&scratch);
  return good ? STRUT_OK : strut_no_memory(error, "");
}

static bool is_known(double force, double noise, double largest) {
  return fabs(force) > KNOWN * noise && fabs(force) > SOME * largest;
}

/* Borderline ones, which are made to act for now; their number. */
static int32_t hold_borderline(strut_modes_work *work, uint8_t *member, uint8_t *element) {
  strut_vibration *v = work->v;
  int32_t count = 0;
  for (int32_t j = 0; j < v->model->members.count; j++)
    if ((member[j] = strut_vibration_is_borderline(v, j))) v->member[j].state = 1, count++;
  for (int32_t i = 0; i < v->model->elements.count; i++)
    if ((element[i] = strut_vibration_element_is_borderline(v, i))) count++;
  return count;
}

static void release_borderline(strut_modes_work *work, const uint8_t *member,
                               const uint8_t *element, const double *member_noise,
                               const double *element_noise) {
  strut_vibration *v = work->v;
  const strut_member_table *t = &v->model->members;
  for (int32_t j = 0; j < t->count; j++) {
    strut_vibration_member *m = &v->member[j];
    double force = t->stiffness[j] * dd_double(m->stretch), most = t->stiffness[j] * m->length;
    if (!member[j]) continue;
    bool known = is_known(force, member_noise[j], most);
    m->state = known ? 0 : -1;
    if (!known) work->idleness[j] = STRUT_JUST_TAUT;
  }
  for (int32_t i = 0; i < v->model->elements.count; i++) {
    const strut_element *e = &v->model->elements.element[i];
    strut_element_pose pose;
    if (!element[i]) continue;
    bool acts = strut_vibration_pose(v, i, &pose);
    v->idle[i] = !acts || !is_known(pose.force, element_noise[i], pose.slope * pose.strain);
    if (v->idle[i] && e->role == STRUT_ELEMENT_MEMBER) work->idleness[e->item] = STRUT_JUST_TAUT;
  }
}

static void find_slack(strut_modes_work *work) {
  const strut_vibration *v = work->v;
  strut_element_pose pose;
  for (int32_t j = 0; j < v->model->members.count; j++)
    if (!v->member[j].taut && v->model->members.stiffness[j] > 0 && work->idleness[j] == STRUT_ACTS)
      work->idleness[j] = STRUT_SLACK;
  for (int32_t i = 0; i < v->model->elements.count; i++) {
    const strut_element *e = &v->model->elements.element[i];
    if (e->role != STRUT_ELEMENT_MEMBER || work->idleness[e->item] != STRUT_ACTS) continue;
    if (!strut_vibration_pose(v, i, &pose)) work->idleness[e->item] = STRUT_SLACK;
  }
}

strut_status strut_modes_loosen(strut_modes_work *work, bool at_rest, strut_error *error) {
  strut_vibration *v = work->v;
  size_t members = (size_t)v->model->members.count, elements = (size_t)v->model->elements.count;
  strut_arena scratch = {0};
  uint8_t *member = strut_arena_allocate(&scratch, members, sizeof *member);
  uint8_t *element = strut_arena_allocate(&scratch, elements, sizeof *element);
  double *member_noise = strut_arena_allocate(&scratch, members, sizeof *member_noise);
  double *element_noise = strut_arena_allocate(&scratch, elements, sizeof *element_noise);
  work->idleness = strut_arena_allocate(work->arena, members, sizeof *work->idleness);
  bool good = member && element && member_noise && element_noise && work->idleness;
  strut_status status = good ? STRUT_OK : strut_no_memory(error, "");
  if (good && hold_borderline(work, member, element) > 0) {
    strut_vibration_update(v);
    if (at_rest) status = strut_modes_settle(work, error);
    if (status == STRUT_OK)
      status = sample_forces(work, at_rest, member_noise, element_noise, error);
    if (status == STRUT_OK) release_borderline(work, member, element, member_noise, element_noise);
    strut_vibration_update(v);
  }
  if (status == STRUT_OK) find_slack(work);
  strut_arena_free(&scratch);
  return status;
}

/* A shift that leaves all but the motions without stiffness as they are. */
static double find_soft(const strut_modes_work *work) {
  const strut_eigen_set *set = &work->set;
  double low = work->v->largest;
  for (int32_t i = 0; i < set->count; i++)
    if (fabs(set->value[i]) > 1e-20 * work->v->largest) low = fmin(low, fabs(set->value[i]));
  return 1e-3 * low;
}

strut_status strut_modes_noise(strut_modes_work *work, bool at_rest, strut_error *error) {
  strut_vibration *v = work->v;
  strut_dd *step = strut_arena_allocate(work->arena, (size_t)v->n, sizeof *step);
  double *noise = strut_arena_allocate(work->arena, (size_t)v->model->members.count, sizeof *noise);
  double *elements =
      strut_arena_allocate(work->arena, (size_t)v->model->elements.count, sizeof *elements);
  if (!step || !noise || !elements) return strut_no_memory(error, "");
  if (at_rest) strut_modes_factorise(&work->solver, find_soft(work));
  strut_status status = STRUT_OK;
  for (uint64_t sample = 0; sample < SAMPLES && status == STRUT_OK; sample++) {
    status = strut_experiment_end(work->experiment, status, error);
    sample_noise(work, at_rest, sample, noise, elements, step);
    measure_noise(work, noise, elements);
  }
  return status;
}

/* Eigenpairs by inverse iteration in twice a double's precision, and how far off they are. */

enum { MOST_ITERATIONS = 5 };

/* Eigenvalues below the largest by this factor are zero. */
static const double NOTHING = 1e-24;
/* Eigenvalues are one where they differ by less than this, relative. */
static const double CLUSTER = 1e-6;
static const double OFFSET =
    1e-7; /* of the shift from the eigenvalue, so that it stays invertible */
static const double GOOD = 1e-13; /* relative error at which nothing is left to do */

typedef struct pair {
  strut_dd *x, *mx, *kx;
  double value, error, residual; /* error absolute */
} pair;

static double dot(const strut_dd *x, const strut_dd *y, int32_t n) {
  strut_dd sum = dd_of(0.0);
  for (int32_t i = 0; i < n; i++) sum = dd_add(sum, dd_mul(x[i], y[i]));
  return dd_double(sum);
}

static strut_dd exact_dot(const strut_dd *x, const strut_dd *y, int32_t n) {
  strut_dd sum = dd_of(0.0);
  for (int32_t i = 0; i < n; i++) sum = dd_add(sum, dd_mul(x[i], y[i]));
  return sum;
}

/*
 * The quotient of x and its distance to an eigenvalue: at most |r|, and |r|^2 / gap, with the norm of M^-1,
 * which is at most twice that of its diagonal without sliding masses. Rows without mass store energy |r|^2 /
 * k.
 */
static void measure(const strut_vibration *v, double gap, pair *p) {
  const strut_sparse *a = v->shape->pattern;
  strut_vibration_mass(v, p->x, p->mx);
  strut_vibration_stiffness(v, p->x, p->kx);
  strut_dd square = exact_dot(p->x, p->mx, v->n);
  strut_dd value = dd_div(exact_dot(p->x, p->kx, v->n), square);
  double rest = 0.0, idle = 0.0, size = 0.0, r2 = 0.0, kx2 = 0.0, mx2 = 0.0;
  for (int32_t i = 0; i < v->n; i++) {
    strut_dd inertia = dd_mul(value, p->mx[i]);
    double r = dd_double(dd_sub(p->kx[i], inertia)), m = v->own_mass[i];
    r2 += r * r, kx2 += p->kx[i].hi * p->kx[i].hi, mx2 += inertia.hi * inertia.hi;
    if (v->mass[i] > 0)
      rest += 2.0 * r * r / m;
    else if (fabs(v->k[a->start[i]].hi) > 0)
      idle += r * r / fabs(v->k[a->start[i]].hi);
  }
  size = dd_double(square);
  p->value = dd_double(value);
  rest /= size;
  double norm = sqrt(rest);
  p->error = (gap > 0 ? fmin(norm, rest / gap) : norm) + idle / size;
  p->residual = sqrt(r2) / (sqrt(kx2) + sqrt(mx2));
  if (!(kx2 + mx2 > 0)) p->residual = 0.0;
}

static bool together(const strut_modes_work *work, double a, double b) {
  double nothing = NOTHING * work->v->largest;
  return fabs(a - b) <= CLUSTER * fmax(fabs(a), fabs(b)) || fabs(a - b) <= nothing;
}

/* To the nearest eigenvalue that is not in the same cluster; 0: none is known. */
static double gap_of(const strut_modes_work *work, int32_t i) {
  const strut_eigen_set *set = &work->set;
  double gap = 0.0;
  for (int32_t k = i - 1; k >= 0; k--)
    if (!together(work, set->value[k], set->value[i])) {
      gap = set->value[i] - set->value[k];
      break;
    }
  for (int32_t k = i + 1; k < set->count; k++)
    if (!together(work, set->value[k], set->value[i])) {
      double above = set->value[k] - set->value[i];
      gap = gap > 0 ? fmin(gap, above) : above;
      break;
    }
  return fabs(gap);
}

static void subtract(strut_dd *x, strut_dd factor, const double *y, int32_t n) {
  for (int32_t i = 0; i < n; i++) x[i] = dd_sub(x[i], dd_scale(factor, y[i]));
}

/* x'Mx = 1 after what earlier vectors of the same eigenvalue take; false: nothing of it is left. */
static bool normalise(const strut_modes_work *work, int32_t index, double value, pair *p) {
  const strut_eigen_set *set = &work->set;
  int32_t n = set->n;
  strut_vibration_mass(work->v, p->x, p->mx);
  double before = dot(p->x, p->mx, n);
  for (int32_t k = index - 1; k >= 0; k--) {
    if (!together(work, set->value[k], value)) continue;
    const double *y = set->vector + (size_t)k * (size_t)n;
    strut_dd share = dd_of(0.0);
    for (int32_t i = 0; i < n; i++) share = dd_add(share, dd_scale(p->mx[i], y[i]));
    subtract(p->x, share, y, n);
    strut_vibration_mass(work->v, p->x, p->mx);
  }
  double square = dot(p->x, p->mx, n);
  if (!(square > 1e-6 * before)) return false;
  strut_dd scale = dd_div(dd_of(1.0), dd_sqrt(exact_dot(p->x, p->mx, n)));
  for (int32_t i = 0; i < n; i++) p->x[i] = dd_mul(p->x[i], scale);
  return true;
}

/* Noise counts as an error of its own: it is no use to be much better than it. */
static bool good_enough(const strut_modes_work *work, int32_t i, const pair *p) {
  double size = fabs(p->value);
  return p->error <= GOOD * size || size <= NOTHING * work->v->largest ||
         (p->error <= 1e-3 * work->set.noise[i] && p->error <= 1e-10 * size);
}

static void improve(strut_modes_work *work, int32_t index, double gap, pair *p) {
  const strut_vibration *v = work->v;
  for (int i = 0; i < MOST_ITERATIONS && !good_enough(work, index, p); i++) {
    double shift = p->value - OFFSET * fabs(p->value), before = p->error;
    strut_extended_factorise(work->solver.extended, v->shape->pattern, v->k, v->m, -shift);
    for (int k = 0; k < 2; k++) {
      strut_vibration_mass(v, p->x, p->mx);
      memcpy(p->x, p->mx, (size_t)v->n * sizeof *p->x);
      strut_extended_solve(work->solver.extended, p->x);
      if (!normalise(work, index, p->value, p)) {
        p->error = HUGE_VAL;
        return;
      }
    }
    measure(v, gap, p);
    if (i > 1 && !(p->error < 0.5 * before)) return;
  }
}

static void swap(double *a, double *b) {
  double c = *a;
  *a = *b, *b = c;
}

/* Insertion: what was sorted stays nearly so. */
static void sort(strut_eigen_set *set) {
  size_t n = (size_t)set->n;
  for (int32_t i = 1; i < set->count; i++)
    for (int32_t k = i; k > 0 && set->value[k] < set->value[k - 1]; k--) {
      swap(&set->value[k], &set->value[k - 1]);
      swap(&set->noise[k], &set->noise[k - 1]);
      swap(&set->error[k], &set->error[k - 1]);
      swap(&set->residual[k], &set->residual[k - 1]);
      double *x = set->vector + (size_t)k * n, *y = x - n;
      for (size_t j = 0; j < n; j++) swap(&x[j], &y[j]);
    }
}

strut_status strut_modes_refine(strut_modes_work *work, strut_error *error) {
  const strut_vibration *v = work->v;
  strut_eigen_set *set = &work->set;
  size_t n = (size_t)v->n;
  strut_arena scratch = {0};
  pair p = {.x = strut_arena_allocate(&scratch, n, sizeof *p.x),
            .mx = strut_arena_allocate(&scratch, n, sizeof *p.mx),
            .kx = strut_arena_allocate(&scratch, n, sizeof *p.kx)};
  strut_status status = STRUT_OK;
  if (!p.x || !p.mx || !p.kx) status = strut_no_memory(error, "");
  for (int32_t i = 0; i < set->count && status == STRUT_OK; i++) {
    status = strut_experiment_end(work->experiment, status, error);
    double *x = set->vector + (size_t)i * n, gap = gap_of(work, i);
    for (size_t k = 0; k < n; k++) p.x[k] = dd_of(x[k]);
    measure(v, gap, &p);
    improve(work, i, gap, &p);
    set->value[i] = p.value;
    set->error[i] = p.error;
    set->residual[i] = p.residual;
    if (!(p.error < HUGE_VAL)) continue;
    for (size_t k = 0; k < n; k++) x[k] = dd_double(p.x[k]);
  }
  if (status == STRUT_OK) sort(set);
  strut_arena_free(&scratch);
  return status;
}
