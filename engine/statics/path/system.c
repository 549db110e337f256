/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stretches and gaps are differences of long numbers, made with twice a double's digits. */
#include "engine/base/vec.h"
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
static const double ROUNDED =
    2.0; /* times a step: one that rounding has made of a singular matrix */
static const double LOOSE = 1e-8; /* of the forces: what a motion without stiffness may meet */
static const double FRESH = 1e-3; /* of the range: rates from so near by do for a correction */

static bool make_matrices(strut_path_system *system) {
  strut_arena *arena = &system->arena;
  size_t unknowns = (size_t)system->n + 1 + STRUT_PATH_KERNEL;
  size_t n = system->n > 0 ? (size_t)system->n : 1;
  return STRUT_NUMBERS(arena, n, &system->spectrum.value) &&
         STRUT_NUMBERS(arena, n * n, &system->spectrum.vector, &system->spectrum.work) &&
         (system->algebra.hessian = strut_arena_matrix(arena, n, n)) &&
         (system->algebra.bordered = strut_arena_matrix(arena, unknowns, unknowns)) &&
         (system->algebra.right = strut_arena_vector(arena, unknowns)) &&
         (system->algebra.solution = strut_arena_vector(arena, unknowns)) &&
         (system->algebra.order = strut_arena_order(arena, unknowns));
}

/* False: out of memory. */
static bool create_contacts(const strut_model *model, strut_arena *arena,
                            strut_path_contacts *contacts) {
  const strut_contact_table *t = &model->contacts;
  contacts->contact = strut_arena_allocate(arena, (size_t)t->count, sizeof *contacts->contact);
  for (int32_t k = 0; k < t->surfaces; k++) contacts->has_corners |= t->surface[k].facets > 1;
  return contacts->contact;
}

static bool make_arrays(strut_path_system *system) {
  size_t members = (size_t)system->model->members.count;
  int32_t forces = strut_force_count(system->model, true);
  if (!STRUT_NUMBERS(&system->arena, system->model->length + 1, &system->latest.q,
                     &system->latest.q_low, &system->latest.g, &system->latest.slope,
                     &system->latest.row) ||
      !STRUT_NUMBERS(&system->arena, 2 * STRUT_PATH_MOTIONS * (system->model->length + 1),
                     &system->held.motion) ||
      !STRUT_ALLOCATE(&system->arena, STRUT_NEW(system->latest.pulling, members),
                      STRUT_NEW(system->latest.ahead, 2 * members),
                      STRUT_NEW(system->force, forces)))
    return false;
  for (int32_t i = 0; i < forces; i++) strut_force_begin(system->model, i, &system->force[i]);
  memset(system->latest.pulling, 1, members);
  return strut_path_elements_create(system->model, &system->arena, &system->elements) &&
         create_contacts(system->model, &system->arena, &system->contacts) &&
         strut_path_terms_create(system->model, &system->arena, &system->equations.terms) &&
         strut_path_terms_create(system->model, &system->arena, &system->equations.rates);
}

strut_status strut_path_system_create(const strut_model *model, const uint8_t *held,
                                      strut_path_system *system, strut_error *error) {
  *system = (strut_path_system){.model = model, .held.most = STRUT_PATH_MOTIONS};
  system->size = model->size > 0 ? model->size : 1.0;
  if (!make_arrays(system)) return strut_no_memory(error, "");
  strut_status status =
      strut_potential_create(model, held, false, &system->arena, &system->potential, error);
  if (status) return status;
  system->n = system->potential->n;
  if (system->n > STRUT_PATH_COORDINATES) return STRUT_OK;
  return make_matrices(system) ? STRUT_OK : strut_no_memory(error, "");
}

/* Releases what its terms hold outside of the arena; zero-initialised ones may be freed. */
static void free_parameter(strut_path_parameter *parameter) {
  strut_path_terms_release(&parameter->base);
  strut_path_terms_release(&parameter->low);
  strut_path_terms_release(&parameter->high);
}

void strut_path_system_free(strut_path_system *system) {
  free_parameter(&system->parameter);
  strut_path_terms_release(&system->equations.terms);
  strut_arena_free(&system->arena);
  *system = (strut_path_system){0};
}

static strut_dd long_value(const strut_path_system *system, const double *unknowns) {
  const strut_dd share = {unknowns[system->n], unknowns[2 * system->n + 1]};
  return dd_add(dd_of(system->parameter.from), dd_scale(share, system->parameter.range));
}

double strut_path_value(const strut_path_system *system, const double *unknowns) {
  return dd_double(long_value(system, unknowns));
}

void strut_path_unplace(const strut_path_system *system, const double *q, double *unknowns) {
  for (int32_t i = 0; i < system->n; i++) {
    strut_dd share = dd_div(dd_of(q[system->potential->coordinate[i]]), dd_of(system->size));
    unknowns[i] = share.hi, unknowns[system->n + 1 + i] = share.lo;
  }
  unknowns[system->n] = unknowns[2 * system->n + 1] = 0;
}

/* Terms at y's value, and where everything is. */
static bool place(strut_path_system *system, const double *unknowns) {
  strut_dd value = long_value(system, unknowns);
  if (!system->equations.has_terms || value.hi != system->equations.terms_at.hi ||
      value.lo != system->equations.terms_at.lo) {
    system->equations.has_terms =
        strut_path_parameter_terms(&system->parameter, value, &system->equations.terms);
    system->equations.terms_at = value;
    if (!system->equations.has_terms) return false;
  }
  size_t bytes = (size_t)system->model->length * sizeof *system->latest.q;
  memcpy(system->latest.q, system->equations.terms.position, bytes);
  memcpy(system->latest.q_low, system->equations.terms.position_low, bytes);
  for (int32_t i = 0; i < system->n; i++) {
    const strut_dd share = {unknowns[i], unknowns[system->n + 1 + i]};
    strut_dd at = dd_scale(share, system->size);
    system->latest.q[system->potential->coordinate[i]] = at.hi;
    system->latest.q_low[system->potential->coordinate[i]] = at.lo;
  }
  return true;
}

static strut_dd coordinate(const strut_path_system *system, uint32_t at) {
  return (strut_dd){system->latest.q[at], system->latest.q_low[at]};
}

/* Springs and bars whose force turns round where they shrink to nothing. */
bool strut_path_turns_round(const strut_path_system *system, int32_t j) {
  return j < system->model->members.count && system->model->scene->members[j].kind != STRUT_CABLE &&
         system->equations.terms.rest[j] > 0.0 && !system->model->scene->members[j].guide_count;
}

static const double SHORT = 1e-9; /* likewise, the shortest length by which a force is divided */

/*
 * A member with all digits; returns what it is longer than its rest length. Where its nodes have passed one another
 * since the last point kept both count as negative: what acts before goes on smoothly.
 */
static double measure_member(const strut_path_system *system, int32_t j, strut_force *force) {
  const strut_member_table *members = &system->model->members;
  const strut_dd rest = {system->equations.terms.rest[j], system->equations.terms.rest_low[j]};
  strut_dd dx = dd_sub(coordinate(system, members->to[j]), coordinate(system, members->from[j]));
  strut_dd dy =
      dd_sub(coordinate(system, members->to[j] + 1), coordinate(system, members->from[j] + 1));
  strut_dd length = dd_length(dx, dy);
  const double *ahead = &system->latest.ahead[2 * j];
  strut_vec2 unit = {0.0, 0.0};
  bool turns = strut_path_turns_round(system, j);
  if (turns && dx.hi * ahead[0] + dy.hi * ahead[1] < 0.0) length = dd_scale(length, -1.0);
  double size = dd_double(length), stretch = dd_double(dd_sub(length, rest));
  if (size != 0) unit = (strut_vec2){dd_double(dd_div(dx, length)), dd_double(dd_div(dy, length))};
  if (turns && fabs(size) < STRUT_PATH_NOTHING * system->size &&
      ahead[0] * ahead[0] + ahead[1] * ahead[1] > 0.0)
    unit = (strut_vec2){ahead[0], ahead[1]};
  /* of zero length and zero rest length: a spring alike in all directions */
  double k = system->equations.terms.stiffness[j];
  double divisor = copysign(fmax(fabs(size), SHORT * system->size), size);
  double across = rest.hi > 0 ? k * stretch / divisor : k;
  strut_force_set_member(k, across, unit, size, stretch, force);
  return stretch;
}

void strut_path_add_force(strut_path_system *system, const strut_force *force,
                          const double *gradient, const double *rate, const double *matrix) {
  int32_t n = 2 * force->nodes;
  for (int32_t a = 0; a < n; a++) {
    int32_t row = system->potential->row_of[strut_force_coordinate(force, a)];
    double pull = force->kind == STRUT_FORCE_ELEMENT ? gradient[a] : force->pose.force;
    double slope = rate[a];
    if (row < 0) continue;
    system->latest.forces = fmax(system->latest.forces, fabs(pull));
    for (int32_t b = 0; b < n; b++) {
      uint32_t at = strut_force_coordinate(force, b);
      int32_t column = system->potential->row_of[at];
      if (column >= 0)
        *gsl_matrix_ptr(system->algebra.hessian, (size_t)row, (size_t)column) += matrix[a * n + b];
      else
        slope += matrix[a * n + b] * system->equations.rates.position[at];
    }
    system->latest.g[row] += gradient[a];
    system->latest.slope[row] += slope;
  }
}

void strut_path_add_strain(strut_path_system *system, const strut_force *force, double rate) {
  double matrix[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  double gradient[STRUT_MOST_GRADIENT], change[STRUT_MOST_GRADIENT];
  strut_force_stiffness(system->model, force, system->latest.q, matrix);
  if (force->kind == STRUT_FORCE_ELEMENT && system->elements.element[force->index].turned)
    strut_force_bend(system->model, force, system->latest.q, -2.0, matrix);
  for (int32_t k = 0; k < 2 * force->nodes; k++)
    gradient[k] = force->pose.force * force->pose.b[k], change[k] = rate * force->pose.b[k];
  strut_path_add_force(system, force, gradient, change, matrix);
}

static void add_members(strut_path_system *system) {
  for (int32_t j = 0; j < system->model->members.count; j++) {
    strut_force *force = &system->force[j];
    double stretch = measure_member(system, j, force);
    force->pose.acts = system->latest.pulling[j];
    if (force->pose.acts)
      strut_path_add_strain(system, force,
                            system->equations.rates.stiffness[j] * stretch -
                                force->pose.slope * system->equations.rates.rest[j]);
    else
      force->pose.force = 0.0;
  }
}

/*
 * Holds rigid motions that meet no stiffness and no load: they would make every matrix singular. What supports
 * forbid once is never held: two supports that meet allow a turn only there.
 */
static void hold_rigid_motions(strut_path_system *system) {
  size_t n = (size_t)system->n;
  double low, high, *motion = system->held.motion, *image = motion + STRUT_PATH_MOTIONS * n;
  const double *slope = system->latest.slope;
  system->drifts = false;
  system->held.count = 0;
  if (n == 0) return;
  gsl_matrix_minmax(system->algebra.hessian, &low, &high);
  double stiff = fmax(-low, high), load = sqrt(strut_dot(slope, slope, system->n));
  system->held.by = stiff > 0 ? stiff : 1.0;
  int32_t count = strut_rigid_motions(system->potential, system->latest.q, NULL, motion);
  count = system->held.most = count < system->held.most ? count : system->held.most;
  for (size_t k = 0; k < (size_t)count; k++) {
    gsl_vector_view row = gsl_vector_view_array(motion + k * n, n);
    gsl_vector_view product = gsl_vector_view_array(image + k * n, n);
    gsl_blas_dgemv(CblasNoTrans, 1.0, system->algebra.hessian, &row.vector, 0.0, &product.vector);
  }
  count = strut_rigid_motions_free(system->n, RIGID * stiff, count, motion, image);
  for (size_t k = 0; k < (size_t)count; k++) {
    double *row = motion + (size_t)system->held.count * n;
    memmove(row, motion + k * n, n * sizeof *row);
    bool works = fabs(strut_dot(slope, row, system->n)) > RIGID * load;
    gsl_vector_view held = gsl_vector_view_array(row, n);
    system->drifts = system->drifts || works;
    if (works) continue;
    gsl_blas_dger(system->held.by, &held.vector, &held.vector, system->algebra.hessian);
    system->held.count++;
  }
}

/* Rates of about there, or of exactly there. */
static bool update_rates(strut_path_system *system, bool exactly) {
  double value = dd_double(system->equations.terms_at);
  double apart = fabs(value - system->equations.rates_at) / fabs(system->parameter.range);
  if (system->equations.has_rates && (exactly ? apart == 0 : apart <= FRESH)) return true;
  system->equations.has_rates =
      strut_path_parameter_rates(&system->parameter, value, &system->equations.rates);
  system->equations.rates_at = value;
  return system->equations.has_rates;
}

static bool evaluate(strut_path_system *system, const double *unknowns, bool exactly) {
  if (!place(system, unknowns) || !update_rates(system, exactly)) return false;
  system->latest.forces = 0;
  for (int32_t i = 0; i < system->n; i++) {
    int32_t at = system->potential->coordinate[i];
    system->latest.g[i] = -system->equations.terms.force[at],
    system->latest.slope[i] = -system->equations.rates.force[at];
    system->latest.forces = fmax(system->latest.forces, fabs(system->equations.terms.force[at]));
  }
  gsl_matrix_set_zero(system->algebra.hessian);
  add_members(system);
  strut_path_add_elements(system);
  strut_path_add_contacts(system);
  for (int32_t i = 0; i < system->n; i++) system->latest.slope[i] *= system->parameter.range;
  hold_rigid_motions(system);
  return true;
}

bool strut_path_evaluate(strut_path_system *system, const double *unknowns) {
  return evaluate(system, unknowns, true);
}

bool strut_path_solve(strut_path_system *system, const strut_path_planes *planes, const double *top,
                      const double *bottom, double by) {
  size_t n = (size_t)system->n, m = (size_t)planes->null, all = n + 1 + m;
  gsl_matrix_view view = gsl_matrix_submatrix(system->algebra.bordered, 0, 0, all, all);
  gsl_vector_view right = gsl_vector_subvector(system->algebra.right, 0, all),
                  solution = gsl_vector_subvector(system->algebra.solution, 0, all);
  gsl_permutation order = {all, system->algebra.order->data};
  gsl_matrix *matrix = &view.matrix;
  gsl_matrix_set_zero(matrix);
  for (size_t i = 0; i < n; i++) {
    for (size_t j = 0; j < n; j++)
      gsl_matrix_set(
          matrix, i, j,
          system->size * (gsl_matrix_get(system->algebra.hessian, i, j) + (i == j) * by));
    gsl_matrix_set(matrix, i, n, system->latest.slope[i]);
    for (size_t k = 0; k < m; k++)
      gsl_matrix_set(matrix, i, n + 1 + k, planes->stiff * planes->row[k * (n + 1) + i]);
    gsl_vector_set(&right.vector, i, top ? top[i] : 0.0);
  }
  for (size_t k = 0; k <= m; k++) {
    for (size_t j = 0; j <= n; j++) gsl_matrix_set(matrix, n + k, j, planes->row[k * (n + 1) + j]);
    gsl_vector_set(&right.vector, n + k, bottom[k]);
  }
  return strut_solve_rows(matrix, &right.vector, &order, &solution.vector);
}

/* Do [K slope] x and `top` agree? */
static bool is_solution(strut_path_system *system, const double *top) {
  double change = gsl_vector_get(system->algebra.solution, (size_t)system->n), left = 0, size = 0;
  double stiff = 0;
  for (size_t i = 0; i < (size_t)system->n; i++) {
    double sum = system->latest.slope[i] * change - (top ? top[i] : 0.0);
    size = fmax(size, fmax(fabs(system->latest.slope[i]), top ? fabs(top[i]) : 0.0));
    for (size_t j = 0; j < (size_t)system->n; j++) {
      double k = gsl_matrix_get(system->algebra.hessian, i, j);
      stiff = fmax(stiff, fabs(k));
      sum += system->size * k * gsl_vector_get(system->algebra.solution, j);
    }
    left = fmax(left, fabs(sum));
  }
  return left <= fmax(LOOSE * size, BALANCED * stiff * system->size);
}

/*
 * The same. A mechanism without stiffness that no force works on stays where it is as long as the path has had one
 * from its begin, as in a beam that lies straight.
 */
static bool solve(strut_path_system *system, const strut_path_planes *planes, const double *top,
                  const double *bottom) {
  double low, high, near = 0.0;
  gsl_vector_view own = gsl_vector_subvector(system->algebra.solution, 0, (size_t)system->n + 1);
  bool lent = system->lends && system->n > 0 && !planes->null;
  gsl_matrix_minmax(system->algebra.hessian, &low, &high);
  double stiff = fmax(-low, high), by = stiff > 0.0 ? TOUCHED * stiff : 1.0;
  lent = lent && strut_path_solve(system, planes, top, bottom, by) && is_solution(system, top);
  if (lent) near = gsl_blas_dnrm2(&own.vector);
  if (strut_path_solve(system, planes, top, bottom, 0.0) &&
      !(lent && gsl_blas_dnrm2(&own.vector) > ROUNDED * near))
    return true;
  return lent && strut_path_solve(system, planes, top, bottom, by);
}

int strut_path_correct(strut_path_system *system, const double *row, double value,
                       double *unknowns) {
  const strut_path_planes plane = {.row = row, .value = &value, .far = FAR};
  return strut_path_correct_on(system, &plane, unknowns);
}

int strut_path_correct_on(strut_path_system *system, const strut_path_planes *planes,
                          double *unknowns) {
  double before = HUGE_VAL, bottom[STRUT_PATH_KERNEL + 1];
  int32_t count = system->n + 1;
  int used = 0;
  for (int k = 1; k <= MOST_ITERATIONS; k++) {
    double change = 0, left = 0;
    if (!evaluate(system, unknowns, false)) return -1;
    for (int32_t l = 0; l <= planes->null; l++) {
      const double *row = planes->row + l * count;
      bottom[l] = planes->value[l];
      for (int32_t i = 0; i < 2 * count; i++) bottom[l] -= row[i % count] * unknowns[i];
    }
    for (int32_t i = 0; i < system->n; i++) {
      left = fmax(left, fabs(system->latest.g[i]));
      system->latest.g[i] = -system->latest.g[i];
    }
    if (!solve(system, planes, system->latest.g, bottom)) return -1;
    const double *step = system->algebra.solution->data;
    for (int32_t i = 0; i < count; i++) {
      change = fmax(change, fabs(step[i]));
      strut_dd sum = dd_add((strut_dd){unknowns[i], unknowns[count + i]}, dd_of(step[i]));
      unknowns[i] = sum.hi, unknowns[count + i] = sum.lo;
    }
    for (int32_t l = 0; l < planes->null; l++) planes->lack[l] = step[count + l];
    bool balanced = planes->null || left <= BALANCED * system->latest.forces;
    if (!used && change <= CONVERGED) used = k;
    if ((change <= CONVERGED && balanced) ||
        (before <= NEAR && change <= NEAR && change > 0.3 * before))
      return used ? used : k;
    if (!isfinite(change) || change > planes->far || (k > 2 && change > 4 * before)) return -1;
    before = change;
  }
  return before <= NEAR ? MOST_ITERATIONS : -1;
}

bool strut_path_tangent(strut_path_system *system, const double *unknowns, const double *row,
                        double *tangent) {
  const double bottom = 1.0;
  const strut_path_planes plane = {.row = row};
  double sum = 0;
  if (!evaluate(system, unknowns, true) || !solve(system, &plane, NULL, &bottom)) return false;
  for (int32_t i = 0; i <= system->n; i++) {
    tangent[i] = gsl_vector_get(system->algebra.solution, (size_t)i);
    sum += tangent[i] * tangent[i];
  }
  if (!isfinite(sum) || sum == 0) return false;
  for (int32_t i = 0; i <= system->n; i++) tangent[i] /= sqrt(sum);
  return true;
}

enum { SWITCH_KINDS = STRUT_PATH_ELEMENT + 1 };

static int32_t count_switches(const strut_path_system *system, strut_path_switch_kind kind) {
  const int32_t contacts = system->model->contacts.count;
  const int32_t count[SWITCH_KINDS] = {
      [STRUT_PATH_CABLE] = system->model->members.count,
      [STRUT_PATH_TOUCH] = contacts,
      [STRUT_PATH_FACET] = system->contacts.has_corners ? contacts : 0,
      [STRUT_PATH_GRIP] = system->contacts.grip > 0.0 ? contacts : 0,
      [STRUT_PATH_ELEMENT] = system->elements.switch_count};
  return count[kind];
}

int32_t strut_path_switch_count(const strut_path_system *system) {
  int32_t sum = 0;
  for (int kind = 0; kind < SWITCH_KINDS; kind++) sum += count_switches(system, kind);
  return sum;
}

strut_path_switch strut_path_switch_at(const strut_path_system *system, int32_t which) {
  strut_path_switch found = {STRUT_PATH_CABLE, which};
  assert(which >= 0 && which < strut_path_switch_count(system));
  for (int32_t count; found.index >= (count = count_switches(system, found.of)); found.of++)
    found.index -= count;
  return found;
}

/* Plain cables alone: a running one and one with another law is an element. */
static bool is_plain_cable(const strut_model *model, int32_t j) {
  return model->scene->members[j].kind == STRUT_CABLE &&
         !strut_member_is_element(&model->elements, j);
}

/* How far the second node is ahead of the first, in the last direction [m]. */
static double measure_ahead(const strut_path_system *system, int32_t j) {
  const strut_member_table *members = &system->model->members;
  strut_dd dx = dd_sub(coordinate(system, members->to[j]), coordinate(system, members->from[j]));
  strut_dd dy =
      dd_sub(coordinate(system, members->to[j] + 1), coordinate(system, members->from[j] + 1));
  const double *ahead = &system->latest.ahead[2 * j];
  return dd_double(dd_add(dd_scale(dx, ahead[0]), dd_scale(dy, ahead[1])));
}

double strut_path_switch_value(strut_path_system *system, int32_t which, const double *unknowns) {
  const strut_path_switch own = strut_path_switch_at(system, which);
  bool member = own.of == STRUT_PATH_CABLE, turns = strut_path_turns_round(system, which);
  strut_force force;
  if (member && !turns && !is_plain_cable(system->model, which)) return -HUGE_VAL;
  if (!place(system, unknowns)) return (double)NAN;
  switch (own.of) {
    case STRUT_PATH_CABLE:
      return turns ? measure_ahead(system, which) : measure_member(system, which, &force);
    case STRUT_PATH_TOUCH: return strut_path_contact_switch_value(system, own.index);
    case STRUT_PATH_FACET: return strut_path_corner_value(system, own.index);
    case STRUT_PATH_GRIP: return strut_path_grip_value(system, own.index);
    case STRUT_PATH_ELEMENT: return strut_path_element_switch_value(system, own.index);
  }
  return (double)NAN;
}

static bool is_element_switch_on(const strut_path_system *system, int32_t which) {
  const strut_path_element_switch *element_switch = &system->elements.switches[which];
  const strut_path_element *own = &system->elements.element[element_switch->element];
  return element_switch->kink < 0 ? own->acts : own->piece > element_switch->kink;
}

bool strut_path_switch_is_on(const strut_path_system *system, int32_t which) {
  const strut_path_switch own = strut_path_switch_at(system, which);
  switch (own.of) {
    case STRUT_PATH_CABLE: /* others are turned round */
      return !is_plain_cable(system->model, which) || system->latest.pulling[which];
    case STRUT_PATH_TOUCH: return system->contacts.contact[own.index].touches;
    case STRUT_PATH_FACET: return true; /* it changes its facet instead */
    case STRUT_PATH_GRIP: return system->contacts.contact[own.index].sticks;
    case STRUT_PATH_ELEMENT: return is_element_switch_on(system, own.index);
  }
  return false;
}

static void set_element_switch(strut_path_system *system, int32_t which, bool on) {
  const strut_path_element_switch *element_switch = &system->elements.switches[which];
  strut_path_element *own = &system->elements.element[element_switch->element];
  if (element_switch->kink < 0)
    own->acts = on;
  else if (on)
    own->piece = own->piece > element_switch->kink ? own->piece : element_switch->kink + 1;
  else
    own->piece = own->piece > element_switch->kink ? element_switch->kink : own->piece;
}

void strut_path_switch_set(strut_path_system *system, int32_t which, bool on) {
  const strut_path_switch own = strut_path_switch_at(system, which);
  switch (own.of) {
    case STRUT_PATH_CABLE:
      system->latest.pulling[which] = on || !is_plain_cable(system->model, which);
      break;
    case STRUT_PATH_TOUCH: strut_path_contact_switch_set(system, own.index, on); break;
    case STRUT_PATH_FACET: break;
    case STRUT_PATH_GRIP: strut_path_grip_set(system, own.index, on); break;
    case STRUT_PATH_ELEMENT: set_element_switch(system, own.index, on); break;
  }
}
