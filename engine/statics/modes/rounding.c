/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/base/mixed_bits.h"
#include "engine/statics/modes/parts.h"

#include "engine/base/vec.h"
#include "engine/statics/algebra.h"

/* The shape below the last bits of its positions, and what last bits do to a stiffness. */

enum { MOST_STEPS = 8, SAMPLES = 3 };

static void move(strut_vibration *vibration, double *positions, const double *step, double sign) {
  strut_potential_move(vibration->shape, step, sign, positions, positions);
  strut_vibration_update(vibration);
}

/* Last bits of a strain and of its natural one, and, in a shape that is not at rest, of the positions it is made of. */
static double bits_of(const strut_vibration *vibration, const strut_force *force, bool at_rest) {
  const strut_element_pose *pose = &force->pose;
  if (force->kind == STRUT_FORCE_MEMBER) {
    double rest = vibration->model->members.rest[force->index];
    return DBL_EPSILON * (at_rest ? 0.5 * rest : pose->strain + rest);
  }
  double bits = DBL_EPSILON * (fabs(pose->strain) + fabs(pose->natural));
  if (vibration->model->elements.element[force->index].strain == STRUT_STRAIN_ANGLE)
    bits += 4.0 * DBL_EPSILON; /* of directions */
  for (int32_t k = 0; k < force->nodes && !at_rest; k++) {
    const double *at = vibration->q + force->at[k], *b = &pose->b[2 * k];
    bits += hypot(b[0], b[1]) * strut_coordinate_rounding(at, at);
  }
  return bits;
}

/*
 * Forces (members, then elements) that natural strains are off by, up to half of their last bit: how they follow once
 * the shape has come to rest again; or, in a shape that is not at rest, strains off by their last bits.
 */
static void sample_noise(strut_modes_work *work, bool at_rest, uint64_t sample, double *noise,
                         double *vector) {
  const strut_vibration *vibration = work->v;
  uint64_t members = (uint64_t)vibration->model->members.count;
  uint64_t elements = (uint64_t)vibration->model->elements.count;
  int32_t count = strut_force_count(vibration->model, false);
  strut_force force;
  memset(vector, 0, (size_t)vibration->n * sizeof *vector);
  for (int32_t i = 0; i < count; i++) {
    bool acts = strut_vibration_force_at(vibration, i, &force);
    uint64_t own = (uint64_t)force.index, first = sample * members;
    if (force.kind == STRUT_FORCE_ELEMENT) first = SAMPLES * members + sample * elements;
    noise[i] = acts ? -force.pose.slope *
                          (bits_of(vibration, &force, at_rest) * strut_stirred(first + own))
                    : 0.0;
    for (int32_t k = 0; k < 2 * force.nodes && at_rest && acts; k++) {
      int32_t row = vibration->shape->row_of[strut_force_coordinate(&force, k)];
      if (row >= 0) vector[row] -= noise[i] * force.pose.b[k];
    }
  }
  if (!at_rest) return;
  strut_modes_solve(&work->solver, vector);
  for (int32_t i = 0; i < count; i++)
    if (strut_vibration_force_at(vibration, i, &force))
      noise[i] += force.pose.slope * strut_vibration_strain(vibration, &force, vector);
}

static void measure_noise(strut_modes_work *work, const double *noise) {
  const strut_vibration *vibration = work->v;
  strut_eigen_set *set = &work->set;
  strut_force force;
  for (int32_t i = 0; i < set->count; i++) {
    const double *x = set->vector + (size_t)i * (size_t)vibration->n;
    double members = 0.0, elements = 0.0;
    for (int32_t j = 0; j < strut_force_count(vibration->model, false); j++) {
      if (noise[j] == 0) continue;
      strut_vibration_force_at(vibration, j, &force);
      double change = noise[j] * strut_vibration_bow(vibration, &force, x).sum;
      members += force.kind == STRUT_FORCE_MEMBER ? change : 0.0;
      elements += force.kind == STRUT_FORCE_MEMBER ? 0.0 : fabs(change);
    }
    double sum = fabs(members) + elements;
    set->noise[i] = fmax(set->noise[i], 2.0 * sum); /* twice: few samples */
  }
}

/*
 * Newton's method from the shape as doubles give it, whose last bits leave forces of c times a bit.
 * It is that close already; a step that is not tiny, or does not help, is taken back.
 */
strut_status strut_modes_settle(strut_modes_work *work, strut_error *error) {
  strut_vibration *vibration = work->v;
  strut_arena scratch = {0};
  double *step = strut_arena_allocate(&scratch, (size_t)vibration->n, sizeof *step);
  if (!step) return strut_no_memory(error, "");
  strut_vibration_force(vibration, step);
  double force = strut_largest_magnitude(step, vibration->n);
  for (int i = 0; i < MOST_STEPS && force > 0; i++) {
    double *positions = i == 0 ? vibration->q : vibration->low; /* then q and its rounding stay */
    strut_modes_factorise(&work->solver, STRUT_FIRM * vibration->largest);
    strut_modes_solve(&work->solver, step);
    if (!(strut_largest_magnitude(step, vibration->n) < 1e-6 * vibration->model->size)) break;
    move(vibration, positions, step, 1.0);
    strut_vibration_force(vibration, vibration->work);
    bool helped = strut_largest_magnitude(vibration->work, vibration->n) < force;
    if (!helped) move(vibration, positions, step, -1.0);
    if (!helped && i > 0) break;
    strut_vibration_force(vibration, step);
    force = strut_largest_magnitude(step, vibration->n);
  }
  strut_arena_free(&scratch);
  return STRUT_OK;
}

/* Of what last bits make of a force: it is known from here on. Of k times the length: it is more than
   the rounding of positions and what is below their last bits. */
static const double KNOWN = 1e3, SOME = 1e-22;

/* Largest noise of the forces of members and elements [N]. */
static strut_status sample_forces(strut_modes_work *work, bool at_rest, double *noise,
                                  strut_error *error) {
  const strut_vibration *vibration = work->v;
  size_t count = (size_t)strut_force_count(vibration->model, false);
  strut_arena scratch = {0};
  double *x, *one;
  bool good = STRUT_NUMBERS(&scratch, vibration->n, &x) && STRUT_NUMBERS(&scratch, count, &one);
  if (good && at_rest) strut_modes_factorise(&work->solver, STRUT_FIRM * vibration->largest);
  for (uint64_t sample = 0; sample < SAMPLES && good; sample++) {
    sample_noise(work, at_rest, sample, one, x);
    for (size_t i = 0; i < count; i++) noise[i] = fmax(noise[i], fabs(one[i]));
  }
  strut_arena_free(&scratch);
  return good ? STRUT_OK : strut_no_memory(error, "");
}

/* Borderline ones; members among them are made to act for now. Their number. */
static int32_t hold_borderline(strut_modes_work *work, uint8_t *borderline) {
  strut_vibration *vibration = work->v;
  int32_t count = 0;
  for (int32_t i = 0; i < strut_force_count(vibration->model, false); i++) {
    if (!(borderline[i] = strut_vibration_is_borderline(vibration, i))) continue;
    if (i < vibration->model->members.count) vibration->state[i] = 1;
    count++;
  }
  return count;
}

/* The member whose force this is, or -1. */
static int32_t member_of(const strut_model *model, const strut_force *force) {
  if (force->kind == STRUT_FORCE_MEMBER) return force->index;
  const strut_element *element = &model->elements.element[force->index];
  return element->role == STRUT_ELEMENT_MEMBER ? element->item : -1;
}

static void release_borderline(strut_modes_work *work, const uint8_t *borderline,
                               const double *noise) {
  strut_vibration *vibration = work->v;
  strut_force force;
  for (int32_t i = 0; i < strut_force_count(vibration->model, false); i++) {
    if (!borderline[i]) continue;
    bool acts = strut_vibration_force_at(vibration, i, &force);
    double least = fmax(KNOWN * noise[i], SOME * (force.pose.slope * force.pose.strain));
    int32_t member = member_of(vibration->model, &force);
    vibration->state[i] = acts && fabs(force.pose.force) > least ? 0 : -1;
    if (vibration->state[i] && member >= 0) work->idleness[member] = STRUT_JUST_TAUT;
  }
}

static void find_slack(strut_modes_work *work) {
  const strut_vibration *vibration = work->v;
  strut_force force;
  for (int32_t i = 0; i < strut_force_count(vibration->model, false); i++) {
    bool acts = strut_vibration_force_at(vibration, i, &force);
    int32_t member = member_of(vibration->model, &force);
    bool plain = force.kind == STRUT_FORCE_MEMBER;
    if (acts || member < 0 || (plain && !(force.pose.slope > 0))) continue;
    if (work->idleness[member] == STRUT_ACTS) work->idleness[member] = STRUT_SLACK;
  }
}

strut_status strut_modes_loosen(strut_modes_work *work, bool at_rest, strut_error *error) {
  strut_vibration *vibration = work->v;
  size_t members = (size_t)vibration->model->members.count;
  size_t count = (size_t)strut_force_count(vibration->model, false);
  strut_arena scratch = {0};
  uint8_t *borderline = strut_arena_allocate(&scratch, count, sizeof *borderline);
  double *noise = strut_arena_allocate(&scratch, count, sizeof *noise);
  work->idleness = strut_arena_allocate(work->arena, members, sizeof *work->idleness);
  bool good = borderline && noise && work->idleness;
  strut_status status = good ? STRUT_OK : strut_no_memory(error, "");
  if (good && hold_borderline(work, borderline) > 0) {
    strut_vibration_update(vibration);
    if (at_rest) status = strut_modes_settle(work, error);
    if (status == STRUT_OK) status = sample_forces(work, at_rest, noise, error);
    if (status == STRUT_OK) release_borderline(work, borderline, noise);
    strut_vibration_update(vibration);
  }
  if (status == STRUT_OK) find_slack(work);
  strut_arena_free(&scratch);
  return status;
}

strut_status strut_modes_noise(strut_modes_work *work, bool at_rest, strut_error *error) {
  strut_vibration *vibration = work->v;
  double *step = strut_arena_allocate(work->arena, (size_t)vibration->n, sizeof *step);
  double *noise = strut_arena_allocate(
      work->arena, (size_t)strut_force_count(vibration->model, false), sizeof *noise);
  if (!step || !noise) return strut_no_memory(error, "");
  if (at_rest) strut_modes_factorise(&work->solver, STRUT_FIRM * vibration->largest);
  strut_status status = STRUT_OK;
  for (uint64_t sample = 0; sample < SAMPLES && status == STRUT_OK; sample++) {
    status = strut_experiment_end(work->experiment, status, error);
    sample_noise(work, at_rest, sample, noise, step);
    measure_noise(work, noise);
  }
  return status;
}

/* How far off the eigenpairs are. */

enum { MOST_ITERATIONS = 4 };

/* Relative error that needs no improvement; of the shift from the eigenvalue, so that it stays invertible. */
static const double GOOD = 1e-11, OFFSET = 1e-7;
/* Eigenvalues are one where they differ by less than this, relative, or of the largest. */
static const double CLUSTER = 1e-6, NOTHING = 1e-15;

static bool together(const strut_modes_work *work, double a, double b) {
  return fabs(a - b) <= fmax(CLUSTER * fmax(fabs(a), fabs(b)), NOTHING * work->v->largest);
}

/* To the nearest eigenvalue that is not in the same cluster; 0: none is known. */
static double gap_of(const strut_modes_work *work, int32_t i) {
  const strut_eigen_set *set = &work->set;
  double gap = 0.0;
  for (int32_t k = i - 1; k >= 0 && gap == 0.0; k--)
    if (!together(work, set->value[k], set->value[i])) gap = set->value[i] - set->value[k];
  for (int32_t k = i + 1; k < set->count; k++)
    if (!together(work, set->value[k], set->value[i])) {
      double above = set->value[k] - set->value[i];
      return gap > 0 ? fmin(gap, above) : above;
    }
  return gap;
}

static void measure_value(strut_modes_work *work, int32_t i, double *mx) {
  const strut_vibration *vibration = work->v;
  strut_eigen_set *set = &work->set;
  const double *x = set->vector + (size_t)i * (size_t)vibration->n;
  const strut_vibration_energy energy = strut_vibration_energy_of(vibration, x);
  strut_vibration_multiply(vibration, vibration->m, x, mx);
  double size = strut_dot(x, mx, vibration->n);
  set->value[i] = energy.value / size;
  set->noise[i] = (set->noise[i] + energy.rounding) / size;
}

/*
 * The distance of a quotient to an eigenvalue: at most |r|, and |r|^2 / gap, with the norm of M^-1,
 * which is at most twice that of its diagonal without sliding masses. Rows without mass store energy
 * |r|^2 / k.
 */
static void measure_error(strut_modes_work *work, int32_t i, double *kx, double *mx) {
  const strut_vibration *vibration = work->v;
  const strut_sparse *matrix = vibration->shape->pattern;
  strut_eigen_set *set = &work->set;
  const double *x = set->vector + (size_t)i * (size_t)vibration->n;
  double rest = 0.0, idle = 0.0, r2 = 0.0, kx2 = 0.0, mx2 = 0.0, gap = gap_of(work, i);
  strut_vibration_multiply(vibration, vibration->k, x, kx);
  strut_vibration_multiply(vibration, vibration->m, x, mx);
  double size = strut_dot(x, mx, vibration->n);
  for (int32_t k = 0; k < vibration->n; k++) {
    double inertia = set->value[i] * mx[k], r = kx[k] - inertia,
           own = fabs(vibration->k[matrix->start[k]]);
    r2 += r * r, kx2 += kx[k] * kx[k], mx2 += inertia * inertia;
    if (vibration->mass[k] > 0)
      rest += 2.0 * r * r / vibration->own_mass[k];
    else if (own > 0)
      idle += r * r / own;
  }
  double norm = sqrt(rest / size);
  set->error[i] = (gap > 0 ? fmin(norm, rest / size / gap) : norm) + idle / size;
  set->residual[i] = kx2 + mx2 > 0 ? sqrt(r2) / (sqrt(kx2) + sqrt(mx2)) : 0.0;
}

/* Inverse iteration: takes out what the eigensolver left of stiffer motions, or of lighter nodes. */
static void improve(strut_modes_work *work, int32_t i, double *kx, double *mx) {
  const strut_vibration *vibration = work->v;
  strut_eigen_set *set = &work->set;
  double *x = set->vector + (size_t)i * (size_t)vibration->n, before = HUGE_VAL;
  for (int k = 0; k < MOST_ITERATIONS; k++) {
    double value = set->value[i], size = fabs(value), error = set->error[i];
    if (size <= 4.0 * set->noise[i]) return; /* a zero */
    if (error <= GOOD * size || error >= size || error > 0.5 * before) return;
    before = error;
    strut_modes_factorise(&work->solver, OFFSET * size - value);
    strut_vibration_multiply(vibration, vibration->m, x, mx);
    memcpy(x, mx, (size_t)vibration->n * sizeof *x);
    strut_modes_solve(&work->solver, x);
    for (int32_t j = i - 1; j >= 0 && together(work, set->value[j], value); j--) {
      const double *y = set->vector + (size_t)j * (size_t)vibration->n;
      strut_vibration_multiply(vibration, vibration->m, y, mx);
      double share = strut_dot(x, mx, vibration->n);
      for (int32_t r = 0; r < vibration->n; r++) x[r] -= share * y[r];
    }
    strut_vibration_multiply(vibration, vibration->m, x, mx);
    double length = sqrt(strut_dot(x, mx, vibration->n));
    for (int32_t r = 0; r < vibration->n; r++) x[r] /= length;
    measure_value(work, i, mx);
    measure_error(work, i, kx, mx);
  }
}

static void swap(double *first, double *second) {
  double c = *first;
  *first = *second, *second = c;
}

/* Insertion: what was sorted stays nearly so. */
static void sort(strut_eigen_set *set) {
  size_t n = (size_t)set->n;
  for (int32_t i = 1; i < set->count; i++)
    for (int32_t k = i; k > 0 && set->value[k] < set->value[k - 1]; k--) {
      swap(&set->value[k], &set->value[k - 1]);
      swap(&set->noise[k], &set->noise[k - 1]);
      double *x = set->vector + (size_t)k * n, *y = x - n;
      for (size_t j = 0; j < n; j++) swap(&x[j], &y[j]);
    }
}

strut_status strut_modes_measure(strut_modes_work *work, strut_error *error) {
  size_t n = (size_t)work->v->n;
  strut_arena scratch = {0};
  double *kx, *mx;
  bool good = STRUT_NUMBERS(&scratch, n, &kx, &mx);
  strut_status status = good ? STRUT_OK : strut_no_memory(error, "");
  for (int32_t i = 0; i < work->set.count && status == STRUT_OK; i++) measure_value(work, i, mx);
  if (status == STRUT_OK) sort(&work->set);
  for (int32_t i = 0; i < work->set.count && status == STRUT_OK; i++) {
    measure_error(work, i, kx, mx);
    improve(work, i, kx, mx);
    status = strut_experiment_end(work->experiment, status, error);
  }
  strut_arena_free(&scratch);
  return status;
}
