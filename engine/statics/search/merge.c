/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/statics/search/critical.h"

#include "engine/base/vec.h"
#include "engine/model/pose.h"
#include "engine/statics/algebra.h"

/* Distance of two shapes after the best rigid motion (Procrustes in the plane). */

strut_rigid_fit strut_rigid_fit_find(int32_t nodes, const double *a, const double *positions,
                                     double side) {
  strut_rigid_fit fit = {.cosine = 1.0, .side = side};
  double along = 0.0, across = 0.0;
  for (int32_t at = 0; at < 2 * nodes; at++)
    fit.to[at % 2] += a[at], fit.from[at % 2] += positions[at];
  for (int c = 0; c < 2; c++) fit.to[c] /= nodes, fit.from[c] /= nodes;
  for (int32_t i = 0; i < nodes; i++) {
    double ax = a[2 * i] - fit.to[0], ay = a[2 * i + 1] - fit.to[1];
    double bx = side * (positions[2 * i] - fit.from[0]), by = positions[2 * i + 1] - fit.from[1];
    along += ax * bx + ay * by;
    across += ay * bx - ax * by;
  }
  double size = sqrt(along * along + across * across);
  if (size > 0) fit.cosine = along / size, fit.sine = across / size;
  return fit;
}

void strut_rigid_fit_apply(const strut_rigid_fit *fit, const double at[2], double moved[2]) {
  double x = fit->side * (at[0] - fit->from[0]), y = at[1] - fit->from[1];
  moved[0] = fit->to[0] + (fit->cosine * x - fit->sine * y);
  moved[1] = fit->to[1] + (fit->sine * x + fit->cosine * y);
}

/* b, mirrored in x where `side` is -1, turned and shifted onto a by least squares. */
static double aligned_distance(const strut_model *model, const double *first, const double *second,
                               double side) {
  const strut_rigid_fit fit = strut_rigid_fit_find(model->node_count, first, second, side);
  double largest = 0.0, moved[2];
  for (int32_t at = 0; at < 2 * model->node_count; at += 2) {
    strut_rigid_fit_apply(&fit, second + at, moved);
    largest = fmax(largest, hypot(first[at] - moved[0], first[at + 1] - moved[1]));
  }
  return largest;
}

double strut_shape_distance(const strut_model *model, const double *first, const double *second,
                            bool mirror, bool *mirrored) {
  double plain = aligned_distance(model, first, second, 1.0);
  double other = mirror ? aligned_distance(model, first, second, -1.0) : HUGE_VAL;
  if (mirrored) *mirrored = other < plain;
  return fmin(plain, other);
}

/*
 * Classifies a stationary point: small structures by all eigenvalues, large ones by a factor's
 * signs.
 */

typedef struct judgement {
  const strut_potential *potential;
  strut_sparse *hessian; /* at the shape, without cables and contacts that rounding alone closes */
  double least;          /* [N] what they must pull or push by */
  double *motion;        /* (3, n) rigid-body motions without stiffness, orthonormal */
  int32_t rigid;         /* number of rigid-body motions */
  double *work;          /* (3 n) */
  const strut_sparse_algebra_library *sparse; /* for large ones; a browser has none */
} judgement;

/* The direction of a mode without its share of rigid-body motions; false where little is left. */
static bool without_rigid(const judgement *self, const double *mode, double *direction) {
  size_t n = (size_t)self->potential->n;
  memcpy(direction, mode, n * sizeof *direction);
  double square = strut_remove_shares(self->motion, (size_t)self->rigid, n, direction);
  if (square < 0.25) return false;
  for (size_t i = 0; i < n; i++) direction[i] /= sqrt(square);
  return true;
}

/* The first of `count` modes (count, n), softest first, that is no rigid motion, as the softest. */
static void set_softest(const judgement *self, const double *modes, int32_t count,
                        double *direction, strut_critical_point *point) {
  const strut_potential *potential = self->potential;
  for (size_t i = 0; i < (size_t)count; i++) {
    if (!without_rigid(self, modes + i * (size_t)potential->n, direction)) continue;
    for (int32_t k = 0; k < potential->n; k++)
      point->softest[potential->coordinate[k]] = direction[k];
    return;
  }
}

static double largest_diagonal(const strut_sparse *matrix) {
  double largest = 0.0;
  for (int32_t j = 0; j < matrix->n; j++)
    largest = fmax(largest, fabs(matrix->value[matrix->start[j]]));
  return largest;
}

/* Large structures: signs of the pivots, and the lowest eigenvalues by Lanczos's method. */

enum { WANTED = 6 };

/* Negative eigenvalues of H + shift; -1: it cannot be factorised. A shift that meets a zero pivot is moved. */
static int32_t count_negative(const judgement *self, strut_ldl *ldl, double shift) {
  strut_inertia inertia;
  for (int i = 0; i < 8; i++, shift *= 1.125)
    if (strut_ldl_factorise(ldl, self->hessian, shift, &inertia) == STRUT_OK)
      return inertia.negative;
  return -1;
}

typedef struct shifted {
  strut_ldl *ldl;
  size_t n;
} shifted;

static void solve(void *context, double *vector) {
  const shifted *factor = context;
  strut_ldl_solve(factor->ldl, vector);
}

static void copy(void *context, const double *vector, double *y) {
  const shifted *factor = context;
  memcpy(y, vector, factor->n * sizeof *y);
}

/* Those next above minus the shift of a factor that is positive definite, the shift as small as powers of ten allow. */
static strut_status find_lowest(const judgement *self, strut_ldl *ldl, double shift, double *value,
                                double *vector, strut_error *error) {
  strut_inertia inertia;
  int left = 25;
  while (left-- > 0 && (strut_ldl_factorise(ldl, self->hessian, shift, &inertia) != STRUT_OK ||
                        inertia.negative > 0))
    shift *= 10.0;
  shifted factor = {ldl, (size_t)self->hessian->n};
  const strut_lanczos_problem problem = {
      .n = self->hessian->n, .shift = -shift, .context = &factor, .solve = solve, .mass = copy};
  if (left < 0) return strut_no_memory(error, "");
  return self->sparse->lowest_eigenpairs(&problem, WANTED, value, vector, error);
}

/* Signs of D and the lowest eigenvalues. */
static strut_status judge_sparse(const judgement *self, strut_arena *arena,
                                 strut_critical_point *point, strut_error *error) {
  size_t n = (size_t)self->hessian->n;
  strut_arena scratch = {0};
  strut_ldl *ldl = NULL;
  double noise = 64.0 * DBL_EPSILON * largest_diagonal(self->hessian) + 1e-300;
  double *vector = strut_arena_allocate(&scratch, WANTED * n, sizeof *vector);
  point->eigenvalues = strut_arena_allocate(arena, WANTED, sizeof *point->eigenvalues);
  bool good =
      vector && point->eigenvalues && !strut_ldl_create(self->hessian, &scratch, &ldl, NULL);
  int32_t above = good ? count_negative(self, ldl, -noise) : -1;
  /* where none is below the upper bound, none is below the lower one */
  int32_t below = above > 0 ? count_negative(self, ldl, noise) : above;
  strut_status status = STRUT_NO_MEMORY;
  if (below < 0) {
    strut_no_memory(error, "");
  } else {
    point->negative = below;
    point->zero = above > below ? above - below : 0;
    status = find_lowest(self, ldl, noise, point->eigenvalues, vector, error);
  }
  if (!status) {
    point->eigenvalue_count = WANTED;
    set_softest(self, vector, WANTED, self->work, point);
  }
  strut_arena_free(&scratch);
  return status;
}

/* Classification of a stationary point: eigenvalues, motions without stiffness, label. */

static const double LARGEST = 1e150;  /* entry of a stiffness matrix */
static const double FARTHEST = 1e100; /* coordinate [m], so that products of three are finite */

const char *strut_stability_name(strut_stability stability) {
  static const char *const names[] = {"stable", "floppy", "saddle", "maximum"};
  assert((size_t)stability < sizeof names / sizeof names[0]);
  return names[stability];
}

/* Few coordinates: all eigenvalues, each with its own error. */
static strut_status judge_dense(const judgement *self, const double *positions, strut_arena *arena,
                                strut_critical_point *point, strut_error *error) {
  int32_t n = self->potential->n;
  strut_arena scratch = {0};
  strut_spectrum spectrum;
  strut_spectrum_workspace *room = strut_spectrum_create(self->potential, &scratch);
  bool good =
      room && strut_spectrum_compute(room, self->hessian, positions, self->least, true, &spectrum);
  point->eigenvalues = strut_arena_allocate(arena, (size_t)n, sizeof *point->eigenvalues);
  if (good && point->eigenvalues) {
    for (int32_t i = 0; i < n; i++) {
      double value = point->eigenvalues[i] = spectrum.value[i], wrong = 16.0 * spectrum.noise[i];
      if (value < -wrong) point->negative++;
      if (fabs(value) <= wrong) point->zero++;
    }
    point->eigenvalue_count = n;
    set_softest(self, spectrum.vector, n, self->work, point);
  }
  strut_arena_free(&scratch);
  return good && point->eigenvalues ? STRUT_OK : strut_no_memory(error, "");
}

static strut_stability label_of(const strut_critical_point *point, int32_t n) {
  if (point->negative > 0)
    return point->negative == n - point->rigid ? STRUT_MAXIMUM : STRUT_SADDLE;
  return point->zero > point->rigid ? STRUT_FLOPPY : STRUT_STABLE;
}

/* True if products of two entries, as factors and eigenvalues form them, cannot overflow. */
static bool is_finite(const strut_sparse *matrix) {
  for (int32_t k = 0; k < matrix->start[matrix->n]; k++)
    if (!(fabs(matrix->value[k]) < LARGEST)) return false;
  return true;
}

static strut_status judge_point(judgement *self, const double *positions, strut_arena *arena,
                                strut_critical_point *point, strut_error *error) {
  const strut_potential *potential = self->potential;
  double size = potential->model->size > 0 ? potential->model->size : 1.0;
  strut_potential_gradient(potential, positions, self->work);
  point->residual = strut_largest_magnitude(self->work, potential->n);
  point->potential = strut_potential_value(potential, positions);
  self->least = 32.0 * strut_potential_rounding(potential, positions);
  strut_potential_hessian_above(potential, positions, self->least, self->hessian);
  double noise =
      potential->n * DBL_EPSILON * largest_diagonal(self->hessian) + 64.0 * self->least / size;
  self->rigid = strut_rigid_motions(potential, positions, NULL, self->motion);
  for (int32_t i = 0; i < self->rigid * potential->n; i += potential->n)
    strut_sparse_multiply(self->hessian, self->motion + i, self->work + i);
  self->rigid =
      strut_rigid_motions_free(potential->n, noise, self->rigid, self->motion, self->work);
  point->rigid = self->rigid;
  bool dense = potential->n <= STRUT_DENSE_STATICS ||
               strut_sparse_algebra_load(&self->sparse, NULL) != STRUT_OK;
  strut_status status = dense ? judge_dense(self, positions, arena, point, error)
                              : judge_sparse(self, arena, point, error);
  if (status) return status;
  if (point->zero < point->rigid) point->zero = point->rigid;
  point->label = label_of(point, potential->n);
  return STRUT_OK;
}

/*
 * Classifies one stationary point q: label, eigenvalues, zero modes. The point's arrays are in the
 * arena.
 */
static strut_status critical_judge(const strut_potential *potential, const double *positions,
                                   strut_arena *arena, strut_critical_point *point,
                                   strut_error *error) {
  size_t n = (size_t)potential->n, length = (size_t)potential->model->length;
  strut_arena scratch = {0};
  judgement j = {.potential = potential};
  *point = (strut_critical_point){.found = 1, .placements = 1, .down = {-1, -1}};
  point->q = strut_arena_copy(arena, positions, length, sizeof *positions);
  j.hessian = strut_potential_matrix(potential, &scratch);
  bool good = point->q && j.hessian && STRUT_NUMBERS(arena, length, &point->softest) &&
              STRUT_NUMBERS(&scratch, 3 * n, &j.motion, &j.work);
  strut_status status =
      good ? judge_point(&j, positions, arena, point, error) : strut_no_memory(error, "");
  bool finite = !status || !j.hessian || is_finite(j.hessian);
  for (size_t i = 0; i < length; i++) finite = finite && fabs(positions[i]) < FARTHEST;
  strut_arena_free(&scratch);
  if (!finite)
    return strut_fail(error, STRUT_DIVERGED,
                      "the structure moves to where energies and stiffnesses leave the range of "
                      "numbers; check the units of sizes, stiffnesses and loads");
  return status;
}

/* Largest factor by which a soft direction may enlarge the distance within which points are one. */
static const double MOST_BLUR = 1000.0;

struct strut_congruent_copy {
  const double *q;
  strut_congruent_copy *next;
};

/* Finds the rigid motions that no support, load or ground forbids. */
static void find_free_motions(strut_stationary_set *set) {
  const strut_potential *potential = set->potential;
  const strut_model *model = potential->model;
  int32_t fixed[2] = {0, 0}, first = -1;
  bool at_one_node = true, loaded = potential->force_scale > 0;
  for (int32_t at = 0; at < 2 * model->node_count; at++) {
    if (potential->row_of[at] >= 0) continue;
    fixed[at % 2]++;
    at_one_node = at_one_node && (first < 0 || first == at / 2);
    first = at / 2;
  }
  bool grounded = potential->ground && model->contacts.count > 0;
  double net[2] = {0.0, 0.0};
  for (int32_t at = 0; at < 2 * model->node_count; at++) net[at % 2] += potential->force[at];
  set->congruent = fixed[0] + fixed[1] <= 3 && strut_model_may_turn(model);
  set->shifts[0] =
      fixed[0] == 0 && net[0] == 0 && !(grounded && !strut_contacts_are_level(&model->contacts));
  set->shifts[1] = fixed[1] == 0 && net[1] == 0 && !grounded;
  set->turns = at_one_node && !loaded && !grounded && strut_model_may_turn(model);
}

void strut_stationary_set_start(strut_stationary_set *set, const strut_potential *potential,
                                strut_arena *arena) {
  const strut_model *model = potential->model;
  double size = model->size > 0 ? model->size : 1.0;
  *set = (strut_stationary_set){.potential = potential, .arena = arena};
  set->near = 1e-6 * size;
  set->flat = 1e-15 * strut_stiffest(model) * size * size + 1e-12 * potential->force_scale * size;
  find_free_motions(set);
}

void strut_stationary_set_free(strut_stationary_set *set) {
  strut_release(set->points);
  strut_release(set->placement);
  *set = (strut_stationary_set){0};
}

/* Largest distance between two placements, up to the free rigid motions. */
static double place_distance(const strut_stationary_set *set, const double *first,
                             const double *second) {
  const strut_model *model = set->potential->model;
  double mean[2] = {0.0, 0.0}, largest = 0.0;
  if (set->turns) return strut_shape_distance(model, first, second, false, NULL);
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    if (set->shifts[at % 2]) mean[at % 2] += (first[at] - second[at]) / model->node_count;
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    largest = fmax(largest, fabs(first[at] - second[at] - mean[at % 2]));
  return largest;
}

static bool same_energy(const strut_stationary_set *set, double a, double b) {
  return fabs(a - b) <= set->flat + 1e-9 * fmin(fabs(a), fabs(b));
}

static bool same_point(const strut_stationary_set *set, const double *positions,
                       const double *known, double near) {
  if (place_distance(set, positions, known) <= near) return true;
  return set->congruent &&
         strut_shape_distance(set->potential->model, positions, known, true, NULL) <= near;
}

/*
 * Close to a fork the softest direction is so soft that a point is known there only to the rounding
 * of the forces over that stiffness: each of two copies to no more than strut_minimise allows.
 */
static double position_blur(const strut_stationary_set *set, const strut_critical_point *point) {
  const strut_potential *potential = set->potential;
  double soft = 0.0, last = 0.0;
  for (int32_t skip = 0; skip <= point->zero; skip++) { /* the next larger one, in magnitude */
    soft = HUGE_VAL;
    for (int32_t i = 0; i < point->eigenvalue_count; i++) {
      double size = fabs(point->eigenvalues[i]);
      if (size < soft && (skip == 0 || size > last)) soft = size;
    }
    last = soft;
  }
  double far =
      16.0 * sqrt((double)potential->n) * strut_potential_rounding(potential, point->q) / soft;
  return fmin(far, MOST_BLUR * set->near);
}

/* Index of the point that q equals, or -1. */
static int32_t find_point(const strut_stationary_set *set, const double *positions) {
  double energy = strut_potential_value(set->potential, positions);
  for (size_t i = 0; i < set->count; i++)
    if (same_energy(set, energy, set->points[i].potential) &&
        same_point(set, positions, set->points[i].q, set->near))
      return (int32_t)i;
  for (size_t i = 0; i < set->count; i++) {
    const strut_critical_point *known = &set->points[i];
    if (fabs(energy - known->potential) > set->flat + 1e-12 * fabs(energy)) continue;
    double near = position_blur(set, known);
    if (near > set->near && same_point(set, positions, known->q, near)) return (int32_t)i;
  }
  return -1;
}

static bool remember_placement(strut_stationary_set *set, int32_t index, const double *positions) {
  strut_congruent_copy **end = &set->placement[index];
  double near = fmax(set->near, position_blur(set, &set->points[index]));
  for (; *end; end = &(*end)->next)
    if (place_distance(set, positions, (*end)->q) <= near) return true;
  const strut_congruent_copy copy = {.q = strut_arena_copy(set->arena, positions,
                                                           (size_t)set->potential->model->length,
                                                           sizeof *positions)};
  *end = copy.q ? strut_arena_copy(set->arena, &copy, 1, sizeof copy) : NULL;
  return *end;
}

/* One of a continuum: some motion that is no rigid one meets no stiffness. */
static bool is_degenerate(const strut_critical_point *point) { return point->zero > point->rigid; }

/* A continuum counts as one point: all of one energy, its ends included. */
static int32_t find_degenerate(const strut_stationary_set *set, const strut_critical_point *point) {
  for (size_t i = 0; i < set->count; i++)
    if ((is_degenerate(point) || is_degenerate(&set->points[i])) &&
        strut_is_minimum(point) == strut_is_minimum(&set->points[i]) &&
        same_energy(set, point->potential, set->points[i].potential))
      return (int32_t)i;
  return -1;
}

static int32_t count_placements(const strut_stationary_set *set, int32_t index) {
  int32_t count = 0;
  for (const strut_congruent_copy *at = set->placement[index]; at; at = at->next) count++;
  return count;
}

/* Replaces the end of a continuum by a point inside it, which represents it better. */
static void make_degenerate(strut_critical_point *known, const strut_critical_point *point) {
  if (is_degenerate(known)) return;
  strut_critical_point before = *known;
  *known = *point;
  known->found = before.found, known->placements = 1;
  known->down[0] = before.down[0], known->down[1] = before.down[1];
}

strut_status strut_stationary_set_add(strut_stationary_set *set, const double *positions,
                                      int32_t *index, bool *fresh, strut_error *error) {
  strut_critical_point point;
  *index = find_point(set, positions);
  *fresh = *index < 0;
  if (*fresh) {
    strut_status status = critical_judge(set->potential, positions, set->arena, &point, error);
    if (status) return status;
    *index = find_degenerate(set, &point);
    *fresh = *index < 0;
    if (!*fresh && is_degenerate(&point)) make_degenerate(&set->points[*index], &point);
  }
  if (*fresh) {
    if (!strut_grow(&set->points, &set->room[0], set->count, sizeof *set->points) ||
        !strut_grow(&set->placement, &set->room[1], set->count, sizeof *set->placement))
      return strut_no_memory(error, "");
    *index = (int32_t)set->count++;
    set->placement[*index] = NULL;
    set->points[*index] = point;
    set->points[*index].found = 0;
  }
  strut_critical_point *known = &set->points[*index];
  known->found++;
  if (is_degenerate(known) && !*fresh) return STRUT_OK;
  if (!remember_placement(set, *index, positions)) return strut_no_memory(error, "");
  known->placements = count_placements(set, *index);
  return STRUT_OK;
}

const double *strut_stationary_set_placement(const strut_stationary_set *set, int32_t index,
                                             int32_t k) {
  assert(index >= 0 && (size_t)index < set->count);
  assert(k >= 0);
  const strut_congruent_copy *at = set->placement[index];
  while (at && k-- > 0) at = at->next;
  return at ? at->q : NULL;
}

void strut_number_shapes(const strut_stationary_set *like, strut_critical_point *points,
                         size_t count) {
  const strut_model *model = like->potential->model;
  int32_t next = 0;
  for (size_t i = 0; i < count; i++) {
    points[i].shape = -1;
    for (size_t k = 0; k < i && points[i].shape < 0; k++)
      if (same_energy(like, points[i].potential, points[k].potential) &&
          strut_shape_distance(model, points[i].q, points[k].q, true, NULL) <= like->near)
        points[i].shape = points[k].shape;
    if (points[i].shape < 0) points[i].shape = next++;
  }
}
