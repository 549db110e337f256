/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stretches and gaps are differences of long numbers, made with twice a double's digits. */
#include "engine/statics/algebra.h"
#include "engine/statics/path/path_parts.h"

#include <assert.h>
#include <gsl/gsl_blas.h>
#include <math.h>
#include <string.h>

enum { MOST_ITERATIONS = 14 };

static const double CONVERGED = 1e-14; /* of a Newton step, in units of size and range */
static const double BALANCED = 1e-15;  /* of the largest force: what equilibrium may leave */
static const double FAR = 2.0;         /* a step longer than this leads nowhere */
static const double NEAR = 1e-8;       /* from here on a step that shrinks no more is rounding */
static const double RIGID = 1e-10;     /* of the stiffness: what a rigid motion may meet */
static const double TOUCHED = 1e-14;   /* of the stiffness: what is lent to a motion without any */
static const double LOOSE = 1e-8;      /* of the forces: what a motion without stiffness may meet */
static const double FRESH = 1e-3;      /* of the range: rates from so near by do for a correction */

static bool make_matrices(strut_path_system *s) {
  strut_arena *arena = &s->arena;
  size_t unknowns = (size_t)s->n + 1; /* all may be held: then the parameter alone is unknown */
  size_t n = s->n > 0 ? (size_t)s->n : 1;
  s->algebra.eigen = gsl_eigen_symmv_alloc(n);
  s->algebra.values_only = gsl_eigen_symm_alloc(n);
  return (s->algebra.hessian = strut_arena_matrix(arena, n, n)) &&
         (s->algebra.work = strut_arena_matrix(arena, n, n)) &&
         (s->algebra.vectors = strut_arena_matrix(arena, n, n)) &&
         (s->algebra.values = strut_arena_vector(arena, n)) &&
         (s->algebra.bordered = strut_arena_matrix(arena, unknowns, unknowns)) &&
         (s->algebra.right = strut_arena_vector(arena, unknowns)) &&
         (s->algebra.solution = strut_arena_vector(arena, unknowns)) &&
         (s->algebra.order = strut_arena_order(arena, unknowns)) && s->algebra.eigen &&
         s->algebra.values_only;
}

static bool make_arrays(strut_path_system *s) {
  size_t length = (size_t)s->model->length, members = (size_t)s->model->members.count;
  double **arrays[] = {&s->latest.q,   &s->latest.q_low,   &s->latest.g,       &s->latest.slope,
                       &s->latest.row, &s->held.motion[0], &s->held.motion[1], &s->held.motion[2]};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
    if (!(*arrays[i] = strut_arena_allocate(&s->arena, length + 1, sizeof(double)))) return false;
  s->latest.pulling = strut_arena_allocate(&s->arena, members, 1);
  s->latest.ahead = strut_arena_allocate(&s->arena, 2 * members, sizeof(double));
  int32_t forces = strut_force_count(s->model, true);
  s->force = strut_arena_allocate(&s->arena, (size_t)forces, sizeof *s->force);
  if (!s->latest.pulling || !s->latest.ahead || !s->force) return false;
  for (int32_t i = 0; i < forces; i++) strut_force_begin(s->model, i, &s->force[i]);
  memset(s->latest.pulling, 1, members);
  return strut_path_elements_create(s->model, &s->arena, &s->elements) &&
         strut_path_contacts_create(s->model, &s->arena, &s->contacts) &&
         strut_path_terms_create(s->model, &s->arena, &s->equations.terms) &&
         strut_path_terms_create(s->model, &s->arena, &s->equations.rates);
}

strut_status strut_path_system_create(const strut_model *model, const uint8_t *held,
                                      strut_path_system *s, strut_error *error) {
  *s = (strut_path_system){.model = model};
  s->size = model->size > 0 ? model->size : 1.0;
  if (!make_arrays(s)) return strut_no_memory(error, "");
  strut_status status = strut_potential_create(model, held, false, &s->potential, error);
  if (status) return status;
  s->n = s->potential->n;
  if (s->n > STRUT_PATH_COORDINATES) return STRUT_OK;
  if (!make_matrices(s)) return strut_no_memory(error, "");
  s->spectrum.value = s->algebra.values->data;
  return STRUT_OK;
}

void strut_path_system_free(strut_path_system *s) {
  gsl_eigen_symmv_free(s->algebra.eigen);
  gsl_eigen_symm_free(s->algebra.values_only);
  strut_potential_free(s->potential);
  strut_path_parameter_free(&s->parameter);
  strut_path_terms_release(&s->equations.terms);
  strut_arena_free(&s->arena);
  *s = (strut_path_system){0};
}

static strut_dd long_value(const strut_path_system *s, const double *y) {
  const strut_dd share = {y[s->n], y[2 * s->n + 1]};
  return dd_add(dd_of(s->parameter.from), dd_scale(share, s->parameter.range));
}

double strut_path_value(const strut_path_system *s, const double *y) {
  return dd_double(long_value(s, y));
}

void strut_path_unplace(const strut_path_system *s, const double *q, double *y) {
  for (int32_t i = 0; i < s->n; i++) {
    strut_dd share = dd_div(dd_of(q[s->potential->coordinate[i]]), dd_of(s->size));
    y[i] = share.hi, y[s->n + 1 + i] = share.lo;
  }
  y[s->n] = y[2 * s->n + 1] = 0;
}

/* Terms at y's value, and where everything is. */
static bool place(strut_path_system *s, const double *y) {
  strut_dd value = long_value(s, y);
  if (!s->equations.has_terms || value.hi != s->equations.terms_at.hi ||
      value.lo != s->equations.terms_at.lo) {
    s->equations.has_terms = strut_path_parameter_terms(&s->parameter, value, &s->equations.terms);
    s->equations.terms_at = value;
    if (!s->equations.has_terms) return false;
  }
  size_t bytes = (size_t)s->model->length * sizeof *s->latest.q;
  memcpy(s->latest.q, s->equations.terms.position, bytes);
  memcpy(s->latest.q_low, s->equations.terms.position_low, bytes);
  for (int32_t i = 0; i < s->n; i++) {
    const strut_dd share = {y[i], y[s->n + 1 + i]};
    strut_dd at = dd_scale(share, s->size);
    s->latest.q[s->potential->coordinate[i]] = at.hi;
    s->latest.q_low[s->potential->coordinate[i]] = at.lo;
  }
  return true;
}

static strut_dd coordinate(const strut_path_system *s, uint32_t at) {
  return (strut_dd){s->latest.q[at], s->latest.q_low[at]};
}

/* Springs and bars whose force turns round where they shrink to nothing. */
bool strut_path_turns_round(const strut_path_system *s, int32_t j) {
  return j < s->model->members.count && s->model->scene->members[j].kind != STRUT_CABLE &&
         s->equations.terms.rest[j] > 0.0 && !s->model->scene->members[j].guide_count;
}

static const double SHORT = 1e-9; /* likewise, the shortest length by which a force is divided */

/*
 * A member with all digits; returns what it is longer than its rest length. Where its nodes have passed one another
 * since the last point kept both count as negative: what acts before goes on smoothly.
 */
static double measure_member(const strut_path_system *s, int32_t j, strut_force *force) {
  const strut_member_table *t = &s->model->members;
  const strut_dd rest = {s->equations.terms.rest[j], s->equations.terms.rest_low[j]};
  strut_dd dx = dd_sub(coordinate(s, t->to[j]), coordinate(s, t->from[j]));
  strut_dd dy = dd_sub(coordinate(s, t->to[j] + 1), coordinate(s, t->from[j] + 1));
  strut_dd length = dd_length(dx, dy);
  const double *ahead = &s->latest.ahead[2 * j];
  strut_vec2 unit = {0.0, 0.0};
  bool turns = strut_path_turns_round(s, j);
  if (turns && dx.hi * ahead[0] + dy.hi * ahead[1] < 0.0) length = dd_scale(length, -1.0);
  double size = dd_double(length), stretch = dd_double(dd_sub(length, rest));
  if (size != 0) unit = (strut_vec2){dd_double(dd_div(dx, length)), dd_double(dd_div(dy, length))};
  if (turns && fabs(size) < STRUT_PATH_NOTHING * s->size &&
      ahead[0] * ahead[0] + ahead[1] * ahead[1] > 0.0)
    unit = (strut_vec2){ahead[0], ahead[1]};
  /* of zero length and zero rest length: a spring alike in all directions */
  double k = s->equations.terms.stiffness[j];
  double divisor = copysign(fmax(fabs(size), SHORT * s->size), size);
  double across = rest.hi > 0 ? k * stretch / divisor : k;
  strut_force_set_member(k, across, unit, size, stretch, force);
  return stretch;
}

void strut_path_add_force(strut_path_system *s, const strut_force *force, const double *gradient,
                          const double *rate, const double *matrix) {
  int32_t n = 2 * force->nodes;
  for (int32_t a = 0; a < n; a++) {
    int32_t row = s->potential->row_of[strut_force_coordinate(force, a)];
    double pull = force->kind == STRUT_FORCE_ELEMENT ? gradient[a] : force->pose.force;
    double slope = rate[a];
    if (row < 0) continue;
    s->latest.forces = fmax(s->latest.forces, fabs(pull));
    for (int32_t b = 0; b < n; b++) {
      uint32_t at = strut_force_coordinate(force, b);
      int32_t column = s->potential->row_of[at];
      if (column >= 0)
        *gsl_matrix_ptr(s->algebra.hessian, (size_t)row, (size_t)column) += matrix[a * n + b];
      else
        slope += matrix[a * n + b] * s->equations.rates.position[at];
    }
    s->latest.g[row] += gradient[a];
    s->latest.slope[row] += slope;
  }
}

void strut_path_add_strain(strut_path_system *s, const strut_force *force, double rate) {
  double matrix[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  double gradient[STRUT_MOST_GRADIENT], change[STRUT_MOST_GRADIENT];
  strut_force_stiffness(s->model, force, s->latest.q, matrix);
  if (force->kind == STRUT_FORCE_ELEMENT && s->elements.element[force->index].turned)
    strut_force_bend(s->model, force, s->latest.q, -2.0, matrix);
  for (int32_t k = 0; k < 2 * force->nodes; k++)
    gradient[k] = force->pose.force * force->pose.b[k], change[k] = rate * force->pose.b[k];
  strut_path_add_force(s, force, gradient, change, matrix);
}

static void add_members(strut_path_system *s) {
  for (int32_t j = 0; j < s->model->members.count; j++) {
    strut_force *force = &s->force[j];
    double stretch = measure_member(s, j, force);
    force->pose.acts = s->latest.pulling[j];
    if (force->pose.acts)
      strut_path_add_strain(s, force,
                            s->equations.rates.stiffness[j] * stretch -
                                force->pose.slope * s->equations.rates.rest[j]);
    else
      force->pose.force = 0.0;
  }
}

/* A unit motion of the whole: along the ground, out of it, or a turn. False: supports forbid it. */
static bool rigid_motion(const strut_path_system *s, int which, double *motion) {
  const double axis[2][2] = {{1, 0}, {0, 1}};
  const strut_contact_table *grounds = &s->equations.terms.laws->contacts;
  const double *out = grounds->count ? grounds->normal : axis[1];
  const double *along = grounds->count ? grounds->tangent : axis[0];
  double centre[2] = {0, 0}, sum = 0;
  int32_t nodes = s->model->node_count, pins = 0;
  const int32_t *row_of = s->potential->row_of;
  for (int32_t i = 0; i < nodes; i++)
    for (int c = 0; c < 2; c++) centre[c] += s->latest.q[2 * i + c] / nodes;
  for (int32_t i = 0; i < nodes; i++)
    if (row_of[2 * i] < 0 && row_of[2 * i + 1] < 0 && pins++ == 0)
      centre[0] = s->latest.q[2 * i], centre[1] = s->latest.q[2 * i + 1];
  bool possible = true;
  for (int32_t at = 0; at < 2 * nodes; at++) {
    double turn =
        at % 2 == 0 ? -(s->latest.q[at + 1] - centre[1]) : s->latest.q[at - 1] - centre[0];
    double there = which == 0 ? along[at % 2] : which == 1 ? out[at % 2] : turn / s->size;
    int32_t row = row_of[at];
    if (row < 0 && fabs(there) > RIGID) possible = false;
    if (row >= 0) motion[row] = there, sum += there * there;
  }
  for (int32_t k = 0; k < s->n && sum > 0; k++) motion[k] /= sqrt(sum);
  return possible;
}

/*
 * Holds rigid motions that meet no stiffness and no load: they would make every matrix singular. What supports
 * forbid once is never held: two supports that meet allow a turn only there.
 */
static void hold_rigid_motions(strut_path_system *s) {
  size_t n = (size_t)s->n;
  double low, high, work = 0, load = 0;
  s->drifts = false;
  s->held.count = 0;
  if (n == 0) return;
  gsl_matrix_minmax(s->algebra.hessian, &low, &high);
  double stiff = fmax(-low, high);
  s->held.by = stiff > 0 ? stiff : 1.0;
  gsl_vector_view product = gsl_vector_subvector(s->algebra.solution, 0, n);
  for (int k = 0; k < STRUT_PATH_MOTIONS; k++) {
    double *row = s->held.motion[s->held.count];
    gsl_vector_view motion = gsl_vector_view_array(row, n);
    s->held.forbidden[k] = s->held.forbidden[k] || !rigid_motion(s, k, row);
    if (s->held.forbidden[k]) continue;
    work = load = 0;
    for (int32_t i = 0; i < s->n; i++)
      work += s->latest.slope[i] * row[i], load += s->latest.slope[i] * s->latest.slope[i];
    gsl_blas_dgemv(CblasNoTrans, 1.0, s->algebra.hessian, &motion.vector, 0.0, &product.vector);
    if (gsl_blas_dnrm2(&product.vector) > RIGID * stiff) continue;
    if (fabs(work) > RIGID * sqrt(load)) {
      s->drifts = true;
      continue;
    }
    gsl_blas_dger(s->held.by, &motion.vector, &motion.vector, s->algebra.hessian);
    s->held.count++;
  }
}

/* Rates of about there, or of exactly there. */
static bool update_rates(strut_path_system *s, bool exactly) {
  double value = dd_double(s->equations.terms_at);
  double apart = fabs(value - s->equations.rates_at) / fabs(s->parameter.range);
  if (s->equations.has_rates && (exactly ? apart == 0 : apart <= FRESH)) return true;
  s->equations.has_rates = strut_path_parameter_rates(&s->parameter, value, &s->equations.rates);
  s->equations.rates_at = value;
  return s->equations.has_rates;
}

static bool evaluate(strut_path_system *s, const double *y, bool exactly) {
  if (!place(s, y) || !update_rates(s, exactly)) return false;
  s->latest.forces = 0;
  for (int32_t i = 0; i < s->n; i++) {
    int32_t at = s->potential->coordinate[i];
    s->latest.g[i] = -s->equations.terms.force[at],
    s->latest.slope[i] = -s->equations.rates.force[at];
    s->latest.forces = fmax(s->latest.forces, fabs(s->equations.terms.force[at]));
  }
  gsl_matrix_set_zero(s->algebra.hessian);
  add_members(s);
  strut_path_add_elements(s);
  strut_path_add_contacts(s);
  for (int32_t i = 0; i < s->n; i++) s->latest.slope[i] *= s->parameter.range;
  hold_rigid_motions(s);
  return true;
}

bool strut_path_evaluate(strut_path_system *s, const double *y) { return evaluate(s, y, true); }

void strut_path_reactions(const strut_path_system *s, double *reaction, double *contact,
                          double *friction) {
  for (int32_t at = 0; at < s->model->length; at++) reaction[at] = -s->equations.terms.force[at];
  for (int32_t i = 0; i < strut_force_count(s->model, false); i++) {
    const strut_force *force = &s->force[i];
    bool element = force->kind == STRUT_FORCE_ELEMENT;
    bool rubs = element && force->pose.acts && strut_path_rubs(s, force->index);
    if (rubs) strut_path_rubbing_reactions(s, force->index, reaction);
    for (int32_t k = 0; k < 2 * force->nodes && !rubs; k++)
      reaction[strut_force_coordinate(force, k)] += force->pose.force * force->pose.b[k];
  }
  strut_path_contact_reactions(s, reaction, contact, friction);
  for (int32_t at = 0; at < s->model->length; at++)
    reaction[at] =
        at < 2 * s->model->node_count && s->potential->row_of[at] < 0 ? 0.0 + reaction[at] : 0.0;
}

/* Solves [K + by slope; row] x = (top, bottom); false: singular. */
static bool solve_with(strut_path_system *s, const double *row, const double *top, double bottom,
                       double by) {
  size_t n = (size_t)s->n;
  gsl_matrix *a = s->algebra.bordered;
  for (size_t i = 0; i <= n; i++) {
    for (size_t j = 0; j < n; j++)
      gsl_matrix_set(
          a, i, j,
          i == n ? row[j] : s->size * (gsl_matrix_get(s->algebra.hessian, i, j) + (i == j) * by));
    gsl_matrix_set(a, i, n, i == n ? row[n] : s->latest.slope[i]);
    gsl_vector_set(s->algebra.right, i, i == n ? bottom : top ? top[i] : 0.0);
  }
  return strut_solve_rows(a, s->algebra.right, s->algebra.order, s->algebra.solution);
}

/* Do [K slope] x and `top` agree? */
static bool is_solution(strut_path_system *s, const double *top) {
  double change = gsl_vector_get(s->algebra.solution, (size_t)s->n), left = 0, size = 0;
  for (size_t i = 0; i < (size_t)s->n; i++) {
    double sum = s->latest.slope[i] * change - (top ? top[i] : 0.0);
    size = fmax(size, fmax(fabs(s->latest.slope[i]), top ? fabs(top[i]) : 0.0));
    for (size_t j = 0; j < (size_t)s->n; j++)
      sum += s->size * gsl_matrix_get(s->algebra.hessian, i, j) *
             gsl_vector_get(s->algebra.solution, j);
    left = fmax(left, fabs(sum));
  }
  return left <= LOOSE * size;
}

/*
 * Solves [K slope; row] x = (top, bottom). A mechanism without stiffness that no force works on stays where it
 * is as long as the path has had one from its begin, as in a beam that lies straight; false: singular otherwise.
 */
static bool solve(strut_path_system *s, const double *row, const double *top, double bottom) {
  double low, high;
  if (solve_with(s, row, top, bottom, 0.0)) {
    s->lends = false;
    return true;
  }
  if (s->n == 0 || !s->lends) return false;
  gsl_matrix_minmax(s->algebra.hessian, &low, &high);
  return solve_with(s, row, top, bottom, TOUCHED * fmax(-low, high)) && is_solution(s, top);
}

int strut_path_correct(strut_path_system *s, const double *row, double value, double *y) {
  double before = HUGE_VAL;
  int32_t count = s->n + 1;
  int used = 0;
  for (int k = 1; k <= MOST_ITERATIONS; k++) {
    double bottom = value, change = 0, left = 0;
    if (!evaluate(s, y, false)) return -1;
    for (int32_t i = 0; i < count; i++) bottom -= row[i] * y[i];
    for (int32_t i = 0; i < count; i++) bottom -= row[i] * y[count + i];
    for (int32_t i = 0; i < s->n; i++) {
      left = fmax(left, fabs(s->latest.g[i]));
      s->latest.g[i] = -s->latest.g[i];
    }
    if (!solve(s, row, s->latest.g, bottom)) return -1;
    for (int32_t i = 0; i < count; i++) {
      double step = gsl_vector_get(s->algebra.solution, (size_t)i);
      change = fmax(change, fabs(step));
      strut_dd sum = dd_add((strut_dd){y[i], y[count + i]}, dd_of(step));
      y[i] = sum.hi, y[count + i] = sum.lo;
    }
    if (!used && change <= CONVERGED) used = k;
    if ((change <= CONVERGED && left <= BALANCED * s->latest.forces) ||
        (before <= NEAR && change <= NEAR && change > 0.3 * before))
      return used ? used : k;
    if (!isfinite(change) || change > FAR || (k > 2 && change > 4 * before)) return -1;
    before = change;
  }
  return before <= NEAR ? MOST_ITERATIONS : -1;
}

bool strut_path_tangent(strut_path_system *s, const double *y, const double *row, double *tangent) {
  double sum = 0;
  if (!evaluate(s, y, true) || !solve(s, row, NULL, 1.0)) return false;
  for (int32_t i = 0; i <= s->n; i++) {
    tangent[i] = gsl_vector_get(s->algebra.solution, (size_t)i);
    sum += tangent[i] * tangent[i];
  }
  if (!isfinite(sum) || sum == 0) return false;
  for (int32_t i = 0; i <= s->n; i++) tangent[i] /= sqrt(sum);
  return true;
}

int32_t strut_path_first_corner_switch(const strut_path_system *s) {
  return s->model->members.count + s->model->contacts.count;
}

int32_t strut_path_first_grip_switch(const strut_path_system *s) {
  int32_t corners = s->contacts.has_corners ? s->model->contacts.count : 0;
  return strut_path_first_corner_switch(s) + corners;
}

int32_t strut_path_first_element_switch(const strut_path_system *s) {
  int32_t grips = s->contacts.grip > 0.0 ? s->model->contacts.count : 0;
  return strut_path_first_grip_switch(s) + grips;
}

int32_t strut_path_switch_count(const strut_path_system *s) {
  return strut_path_first_element_switch(s) + s->elements.switch_count;
}

/* Plain cables alone: a running one and one with another law is an element. */
static bool is_plain_cable(const strut_model *model, int32_t j) {
  return model->scene->members[j].kind == STRUT_CABLE &&
         !strut_member_is_element(&model->elements, j);
}

/* How far the second node is ahead of the first, in the last direction [m]. */
static double measure_ahead(const strut_path_system *s, int32_t j) {
  const strut_member_table *t = &s->model->members;
  strut_dd dx = dd_sub(coordinate(s, t->to[j]), coordinate(s, t->from[j]));
  strut_dd dy = dd_sub(coordinate(s, t->to[j] + 1), coordinate(s, t->from[j] + 1));
  const double *ahead = &s->latest.ahead[2 * j];
  return dd_double(dd_add(dd_scale(dx, ahead[0]), dd_scale(dy, ahead[1])));
}

void strut_path_keep_directions(strut_path_system *s) {
  for (int32_t j = 0; j < s->model->members.count; j++)
    memcpy(&s->latest.ahead[2 * j], &s->force[j].pose.b[2], 2 * sizeof(double));
}

void strut_path_forget_directions(strut_path_system *s) {
  memset(s->latest.ahead, 0, 2 * (size_t)s->model->members.count * sizeof *s->latest.ahead);
}

double strut_path_switch_value(strut_path_system *s, int32_t which, const double *y) {
  int32_t members = s->model->members.count, elements = strut_path_first_element_switch(s);
  int32_t corners = strut_path_first_corner_switch(s), grips = strut_path_first_grip_switch(s);
  strut_force member;
  bool turns = strut_path_turns_round(s, which);
  if (which < members && !turns && !is_plain_cable(s->model, which)) return -HUGE_VAL;
  if (!place(s, y)) return (double)NAN;
  if (turns) return measure_ahead(s, which);
  if (which >= elements) return strut_path_element_switch_value(s, which - elements);
  if (which >= grips) return strut_path_grip_switch_value(s, which - grips);
  if (which >= corners) return strut_path_corner_value(s, which - corners);
  return which < members ? measure_member(s, which, &member)
                         : strut_path_contact_switch_value(s, which - members);
}

bool strut_path_switch_is_on(const strut_path_system *s, int32_t which) {
  int32_t members = s->model->members.count, elements = strut_path_first_element_switch(s);
  if (which >= elements) return strut_path_element_switch_is_on(s, which - elements);
  int32_t grips = strut_path_first_grip_switch(s);
  if (which >= grips) return s->contacts.contact[which - grips].sticks;
  if (which >= strut_path_first_corner_switch(s)) return true; /* it changes its facet instead */
  if (which < members && !is_plain_cable(s->model, which)) return true; /* it is turned round */
  return which < members ? s->latest.pulling[which] : s->contacts.contact[which - members].touches;
}

void strut_path_switch_set(strut_path_system *s, int32_t which, bool on) {
  assert(which >= 0 && which < strut_path_switch_count(s));
  int32_t members = s->model->members.count, corners = strut_path_first_corner_switch(s);
  int32_t elements = strut_path_first_element_switch(s), grips = strut_path_first_grip_switch(s);
  if (which >= elements)
    strut_path_element_switch_set(s, which - elements, on);
  else if (which >= grips)
    strut_path_grip_set(s, which - grips, on);
  else if (which < members)
    s->latest.pulling[which] = on || !is_plain_cable(s->model, which);
  else if (which < corners)
    strut_path_contact_switch_set(s, which - members, on);
}
