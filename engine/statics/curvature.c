/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/statics/minimise.h"

#include "engine/base/vec.h"
#include "engine/statics/algebra.h"

/* |x| for the multiplier mu, and d|x|/dmu; mu lies above minus the lowest value. */
static double step_length_at(const void *quadratic, double mu, double *slope) {
  const strut_quadratic *r = quadratic;
  double square = 0.0, cube = 0.0;
  for (int32_t i = 0; i < r->n; i++) {
    if (r->idle[i] || r->part[i] == 0.0) continue;
    double x = r->part[i] / (r->value[i] + mu);
    square += x * x;
    cube += x * x / (r->value[i] + mu);
  }
  double length = sqrt(square);
  *slope = length > 0 ? -cube / length : 0.0;
  return length;
}

/* The multiplier at which |x| is the radius, between low (too long a step there) and high. */
static double solve_secular(double (*step_length)(const void *r, double mu, double *slope),
                            const void *r, double low, double high, double radius) {
  double mu = low > 0 ? low * (1.0 + 1e-12) : low;
  for (int i = 0; i < 80 && high - low > 1e-14 * high; i++) {
    if (!(mu > low && mu < high)) mu = low > 0 ? 0.5 * (low + high) : 1e-3 * high;
    double slope, length = step_length(r, mu, &slope);
    if (fabs(length - radius) <= 1e-6 * radius) return mu;
    if (length > radius)
      low = mu;
    else
      high = mu;
    mu += (length / radius - 1.0) * (slope < 0 ? -length / slope : 0.0); /* Newton on 1/|x| */
  }
  return isfinite(mu) && mu >= low && mu <= high ? mu : high;
}

/* x at the multiplier mu; returns mu. */
static double shares_at(const strut_quadratic *quadratic, double mu, double *vector) {
  for (int32_t i = 0; i < quadratic->n; i++)
    vector[i] = quadratic->idle[i] || quadratic->part[i] == 0.0
                    ? 0.0
                    : -quadratic->part[i] / (quadratic->value[i] + mu);
  return mu;
}

double strut_trust_step(const strut_quadratic *quadratic, double radius, double *vector) {
  assert(radius > 0.0);
  double size = 0.0, slope;
  int32_t low = -1;
  for (int32_t i = 0; i < quadratic->n; i++) {
    if (quadratic->idle[i]) continue;
    if (low < 0 || quadratic->value[i] < quadratic->value[low]) low = i;
    size += quadratic->part[i] * quadratic->part[i];
  }
  size = sqrt(size);
  if (low < 0) return shares_at(quadratic, 0.0, vector); /* no mode has a force */
  double lowest = quadratic->value[low];
  double floor = fmax(0.0, -lowest) + (lowest <= 0 ? DBL_EPSILON * quadratic->scale + 1e-300 : 0.0);
  double length = step_length_at(quadratic, floor, &slope);
  if (length > radius)
    return shares_at(quadratic,
                     solve_secular(step_length_at, quadratic, floor, floor + size / radius, radius),
                     vector);
  shares_at(quadratic, floor, vector);
  if (lowest > -quadratic->noise) return floor;
  double rest = sqrt(fmax(radius * radius - length * length, 0.0)); /* the hard case */
  vector[low] += quadratic->part[low] > 0 ? -rest : rest;
  return floor;
}

/*
 * Exact trust-region steps in the basis of the Hessian's tridiagonal form, for a quarter of the work
 * of its eigenvectors. These serve where it is singular, so that motions without stiffness are left
 * alone, where the lowest one is needed, and where there are so few that they cost next to nothing.
 */
enum { FEW_MODES = 20 };

typedef struct dense_curvature {
  strut_spectrum_workspace *spectra;
  strut_tridiagonal *reduced;
  bool has_modes; /* `now` is filled, and `reduced` has lost its reflections */
  strut_spectrum now;
  double *part, *x; /* (n) the gradient and the step in the modes, or in the basis of T */
  uint8_t *idle;    /* (n) modes to leave alone */
  strut_arena arena;
  double scale;      /* largest |eigenvalue| */
  double multiplier; /* of the step that descend gave last */
} dense_curvature;

static void dense_free(void *memory) {
  dense_curvature *curvature = memory;
  if (!curvature) return;
  strut_spectrum_free(curvature->spectra);
  strut_arena_free(&curvature->arena);
  strut_release(curvature);
}

static void *dense_create(const strut_potential *potential) {
  dense_curvature *curvature = strut_allocate(1, sizeof *curvature);
  if (!curvature) return NULL;
  curvature->spectra = strut_spectrum_create(potential);
  size_t n = (size_t)potential->n;
  curvature->idle = strut_arena_allocate(&curvature->arena, n, sizeof *curvature->idle);
  if (curvature->spectra && curvature->idle &&
      STRUT_NUMBERS(&curvature->arena, n, &curvature->part, &curvature->x))
    return curvature;
  dense_free(curvature);
  return NULL;
}

/* The modes of what was reduced last, at q; NULL where it is not singular, which refines nothing. */
static bool find_modes(dense_curvature *curvature, const double *q) {
  if (curvature->has_modes) return true;
  curvature->has_modes = strut_spectrum_finish(curvature->spectra, q, false, &curvature->now);
  if (curvature->has_modes && curvature->now.n)
    curvature->scale =
        fmax(fabs(curvature->now.value[0]), fabs(curvature->now.value[curvature->now.n - 1]));
  return curvature->has_modes;
}

static bool dense_decompose(void *memory, const double *q) {
  dense_curvature *curvature = memory;
  bool singular;
  curvature->has_modes = false;
  if (!strut_spectrum_reduce(curvature->spectra, q, &curvature->reduced, &singular)) return false;
  curvature->scale = curvature->reduced->bound;
  return (!singular && curvature->reduced->n > FEW_MODES) || find_modes(curvature, q);
}

static bool is_definite(dense_curvature *curvature) {
  return !curvature->has_modes && strut_tridiagonal_factor(curvature->reduced, 0.0) == 0;
}

/* |x| of x = -(T + mu)^-1 part, and d|x|/dmu; infinite where T + mu is not positive definite. */
static double reduced_length_at(const void *memory, double mu, double *slope) {
  const dense_curvature *curvature = memory;
  int32_t n = curvature->reduced->n;
  *slope = 0.0;
  if (strut_tridiagonal_factor(curvature->reduced, mu) > 0) return HUGE_VAL;
  for (int32_t i = 0; i < n; i++) curvature->x[i] = -curvature->part[i];
  strut_tridiagonal_solve(curvature->reduced, curvature->x);
  double length = sqrt(strut_dot(curvature->x, curvature->x, n));
  if (length > 0) *slope = -strut_tridiagonal_form(curvature->reduced, curvature->x) / length;
  return length;
}

static void enter_basis(dense_curvature *curvature, const double *gradient) {
  memcpy(curvature->part, gradient, (size_t)curvature->reduced->n * sizeof *gradient);
  strut_tridiagonal_enter(curvature->reduced, curvature->part);
}

/* False in the hard case, which needs the lowest mode: g has next to no share of it. */
static bool step_in_basis(dense_curvature *curvature, const double *gradient, double radius,
                          double *s, strut_model_step *step) {
  int32_t n = curvature->reduced->n;
  enter_basis(curvature, gradient);
  double slope, mu = 0.0, length = reduced_length_at(curvature, mu, &slope);
  if (length > radius) {
    double size = sqrt(strut_dot(curvature->part, curvature->part, n)),
           lowest = isfinite(length) ? 0.0 : curvature->scale;
    mu = solve_secular(reduced_length_at, curvature, 0.0, lowest + size / radius, radius);
    length = reduced_length_at(curvature, mu, &slope);
    if (!(fabs(length - radius) <= 1e-5 * radius)) return false;
  }
  curvature->multiplier = mu;
  *step = (strut_model_step){
      length, 0.5 * (mu * length * length - strut_dot(curvature->part, curvature->x, n))};
  memcpy(s, curvature->x, (size_t)n * sizeof *s);
  strut_tridiagonal_leave(curvature->reduced, s);
  return true;
}

/* s from its shares; its length and what the model gains by it. */
static strut_model_step assemble_step(const dense_curvature *curvature, double *s) {
  strut_model_step step = {.length = strut_spectrum_combine(&curvature->now, curvature->x, s)};
  for (int32_t i = 0; i < curvature->now.n; i++)
    if (curvature->x[i] != 0.0)
      step.reduction -=
          curvature->x[i] * (curvature->part[i] + 0.5 * curvature->now.value[i] * curvature->x[i]);
  return step;
}

static strut_model_step dense_trust_step(void *memory, const double *gradient, double radius,
                                         double still, double *s) {
  dense_curvature *curvature = memory;
  strut_model_step step = {0};
  if (!curvature->has_modes && step_in_basis(curvature, gradient, radius, s, &step)) return step;
  if (!find_modes(curvature, NULL)) return step;
  strut_spectrum_split(&curvature->now, gradient, still, curvature->part, curvature->idle);
  strut_quadratic model = {curvature->now.n, curvature->now.value, curvature->part,
                           curvature->idle,  curvature->scale,     0.0};
  if (curvature->now.n > 0) model.noise = 4.0 * curvature->now.noise[0];
  curvature->multiplier = strut_trust_step(&model, radius, curvature->x);
  return assemble_step(curvature, s);
}

/* A border in the middle of the gap above `stiff`; 0: no mode is stiffer. */
static double find_border(dense_curvature *curvature, double stiff) {
  int32_t soft = strut_tridiagonal_factor(curvature->reduced, -stiff);
  double high = stiff;
  if (soft == curvature->reduced->n) return 0.0;
  while (strut_tridiagonal_factor(curvature->reduced, -10.0 * high) == soft) high *= 10.0;
  return sqrt(stiff * high);
}

/*
 * Newton's step weighed mode by mode by 1 - 5 u^4 + 4 u^5, u = c / (value + c): 1 for stiff modes, to
 * (c / value)^4, and 0 for soft ones, to (value / c)^2. A border within a gap is as good as a sharp one.
 */
static bool rebalance_in_basis(dense_curvature *curvature, const double *gradient, double stiff,
                               double *step) {
  int32_t n = curvature->reduced->n;
  double c = 2.0 * find_border(curvature, stiff);
  if (c == 0.0 || strut_tridiagonal_factor(curvature->reduced, c) > 0) return false;
  enter_basis(curvature, gradient);
  memset(curvature->x, 0, (size_t)n * sizeof *curvature->x);
  for (int k = 1; k <= 5; k++) {
    strut_tridiagonal_solve(curvature->reduced, curvature->part);
    for (int32_t i = 0; i < n; i++) curvature->x[i] += (k < 5 ? 1.0 : -4.0) * curvature->part[i];
    for (int32_t i = 0; i < n; i++) curvature->part[i] *= c;
  }
  strut_tridiagonal_leave(curvature->reduced, curvature->x);
  for (int32_t i = 0; i < n; i++) step[i] -= curvature->x[i];
  return true;
}

static bool dense_rebalance(void *memory, const double *gradient, double *step) {
  dense_curvature *curvature = memory;
  double stiff = curvature->multiplier > 0 ? 10.0 * curvature->multiplier : 1e-3 * curvature->scale;
  if (!curvature->has_modes) return rebalance_in_basis(curvature, gradient, stiff, step);
  return strut_spectrum_rebalance(&curvature->now, curvature->now.value, stiff, gradient, step);
}

static double dense_newton_step(void *memory, const double *gradient, double *s) {
  dense_curvature *curvature = memory;
  strut_model_step step;
  if (is_definite(curvature) && step_in_basis(curvature, gradient, HUGE_VAL, s, &step))
    return step.length;
  if (!find_modes(curvature, NULL)) return HUGE_VAL;
  strut_spectrum_split(&curvature->now, gradient, HUGE_VAL, curvature->part, curvature->idle);
  for (int32_t i = 0; i < curvature->now.n; i++)
    curvature->x[i] = curvature->idle[i] ? 0.0 : -curvature->part[i] / curvature->now.value[i];
  return assemble_step(curvature, s).length;
}

static bool dense_unstable_direction(void *memory, double *step) {
  dense_curvature *curvature = memory;
  if (is_definite(curvature)) return false;
  if (!find_modes(curvature, NULL) || curvature->now.n == 0 ||
      !(curvature->now.value[0] < -4.0 * curvature->now.noise[0]))
    return false;
  memcpy(step, curvature->now.vector, (size_t)curvature->now.n * sizeof *step);
  return true;
}

const strut_curvature strut_curvature_dense = {
    dense_create,      dense_decompose,          dense_trust_step, dense_rebalance,
    dense_newton_step, dense_unstable_direction, dense_free};

/* Steps by a sparse L D L' factor of the Hessian, shifted until it is positive definite. */

typedef struct sparse_curvature {
  const strut_potential *potential;
  strut_sparse *hessian;
  strut_ldl *ldl;
  strut_inertia inertia;
  double shift;           /* of the factor at hand; NAN: there is none */
  double scale;           /* largest diagonal entry */
  double *work, *scratch; /* (n) */
  double *factored;       /* (nonzeros) the Hessian that the factor is of */
  strut_arena arena;
} sparse_curvature;

static void sparse_free(void *memory) {
  sparse_curvature *curvature = memory;
  if (!curvature) return;
  strut_ldl_free(curvature->ldl);
  strut_arena_free(&curvature->arena);
  strut_release(curvature);
}

static void *sparse_create(const strut_potential *potential) {
  sparse_curvature *curvature = strut_allocate(1, sizeof *curvature);
  if (!curvature) return NULL;
  curvature->potential = potential;
  curvature->hessian = strut_potential_matrix(potential, &curvature->arena);
  curvature->shift = (double)NAN;
  if (curvature->hessian &&
      STRUT_NUMBERS(&curvature->arena, potential->n, &curvature->work, &curvature->scratch) &&
      STRUT_NUMBERS(&curvature->arena, (size_t)curvature->hessian->start[potential->n],
                    &curvature->factored) &&
      strut_ldl_create(potential->pattern, &curvature->ldl, NULL) == STRUT_OK)
    return curvature;
  sparse_free(curvature);
  return NULL;
}

/* Pivots of this share of their diagonal are rounding: neither their size nor their sign counts. */
static const double NOISE = 32 * DBL_EPSILON;

/* Factorises H + shift, unless that was done last; true where it is positive definite beyond rounding. */
static bool factorise(sparse_curvature *curvature, double shift) {
  bool good = curvature->shift == shift ||
              strut_ldl_factorise(curvature->ldl, curvature->hessian, shift, &curvature->inertia) ==
                  STRUT_OK;
  curvature->shift = good ? shift : (double)NAN;
  return good && curvature->inertia.negative == 0 && curvature->inertia.smallest > NOISE;
}

static bool sparse_decompose(void *memory, const double *q) {
  sparse_curvature *curvature = memory;
  const strut_sparse *matrix = curvature->hessian;
  size_t bytes = (size_t)matrix->start[matrix->n] * sizeof *matrix->value;
  strut_potential_hessian(curvature->potential, q, curvature->hessian);
  bool same = memcmp(curvature->factored, matrix->value, bytes) == 0;
  curvature->scale = 0.0;
  for (int32_t k = 0; k < matrix->start[matrix->n]; k++)
    if (!isfinite(matrix->value[k])) return false;
  for (int32_t j = 0; j < matrix->n; j++)
    curvature->scale = fmax(curvature->scale, fabs(matrix->value[matrix->start[j]]));
  if (same) return true;
  memcpy(curvature->factored, matrix->value, bytes);
  curvature->shift = (double)NAN;
  return true;
}

/* s = -(H + shift)^-1 g; its length. */
static double solve_shifted(sparse_curvature *curvature, const double *gradient, double *step) {
  int32_t n = curvature->hessian->n;
  for (int32_t i = 0; i < n; i++) step[i] = -gradient[i];
  strut_ldl_solve(curvature->ldl, step);
  return sqrt(strut_dot(step, step, n));
}

static strut_model_step evaluate_step(sparse_curvature *curvature, const double *gradient,
                                      const double *step) {
  int32_t n = curvature->hessian->n;
  strut_sparse_multiply(curvature->hessian, step, curvature->work);
  return (strut_model_step){
      sqrt(strut_dot(step, step, n)),
      -strut_dot(gradient, step, n) - 0.5 * strut_dot(step, curvature->work, n)};
}

/* The smallest of the shifts tried at which H + shift is positive definite; false: none is. */
static bool find_shift(sparse_curvature *curvature, double *low, double *shift) {
  *low = 0.0;
  if (factorise(curvature, 0.0)) {
    *shift = 0.0;
    return true;
  }
  double next = 1e-14 * curvature->scale + 1e-300;
  for (int i = 0; i < 40; i++, next *= 10.0) {
    if (factorise(curvature, next)) {
      *shift = next;
      return true;
    }
    if (!isnan(curvature->shift)) *low = next;
  }
  return false;
}

/* Reduces a shift that is larger than necessary towards `low`, which is too small: a longer step. */
static double lengthen_step(sparse_curvature *curvature, const double *gradient, double radius,
                            double low, double shift, double length, double *step) {
  for (int i = 0; i < 3 && low > 0 && length < 0.7 * radius; i++) {
    double between = sqrt(low * shift);
    bool good = factorise(curvature, between);
    double longer = good ? solve_shifted(curvature, gradient, step) : HUGE_VAL;
    if (longer <= radius) {
      shift = between, length = longer;
      continue;
    }
    low = between;
    factorise(curvature, shift);
    length = solve_shifted(curvature, gradient, step);
  }
  return length;
}

/*
 * From a shift whose step is too long upwards: Newton's method on 1/|s|, each trial a new factor.
 */
static void shorten_step(sparse_curvature *curvature, const double *gradient, double radius,
                         double low, double length, double *step) {
  int32_t n = curvature->hessian->n;
  double high = HUGE_VAL, shift = low;
  for (int i = 0; i < 30 && !(length <= radius && length > 0.7 * radius); i++) {
    memcpy(curvature->scratch, step, (size_t)n * sizeof *step);
    strut_ldl_solve(curvature->ldl, curvature->scratch);
    double slope = strut_dot(step, curvature->scratch, n); /* -|s| d|s|/dshift */
    double next = shift + length * length * (length / (0.85 * radius) - 1.0) / slope;
    if (!(next > low && next < high))
      next = high == HUGE_VAL ? fmax(10.0 * low, 1e-14 * curvature->scale) : 0.5 * (low + high);
    if (high - low <= 1e-3 * high && length <= radius) break;
    if (!factorise(curvature, next)) break;
    shift = next;
    length = solve_shifted(curvature, gradient, step);
    *(length > radius ? &low : &high) = shift;
  }
  if (length <= radius) return;
  for (int32_t i = 0; i < n; i++) step[i] *= radius / length;
}

/* A step of 0.7 to 1 radius is good enough, or a shorter one where Newton's is. */
static strut_model_step sparse_trust_step(void *memory, const double *gradient, double radius,
                                          double still, double *step) {
  sparse_curvature *curvature = memory;
  double low, shift;
  (void)still;
  if (!find_shift(curvature, &low, &shift)) return (strut_model_step){0};
  double length = solve_shifted(curvature, gradient, step);
  if (length > radius)
    shorten_step(curvature, gradient, radius, shift, length, step);
  else if (shift > 0)
    lengthen_step(curvature, gradient, radius, low, shift, length, step);
  return evaluate_step(curvature, gradient, step);
}

/* A factor does not know its stiff modes. */
static bool sparse_rebalance(void *memory, const double *gradient, double *step) {
  (void)memory, (void)gradient, (void)step;
  return false;
}

static double sparse_newton_step(void *memory, const double *gradient, double *step) {
  sparse_curvature *curvature = memory;
  factorise(curvature, 0.0);
  if (isnan(curvature->shift) || curvature->inertia.smallest <= NOISE)
    factorise(curvature, 1e-13 * curvature->scale);
  return isnan(curvature->shift) ? HUGE_VAL : solve_shifted(curvature, gradient, step);
}

/*
 * Inverse iteration from a start that leans on no motion, shifted to just below the lowest value.
 */
static bool sparse_unstable_direction(void *memory, double *step) {
  sparse_curvature *curvature = memory;
  int32_t n = curvature->hessian->n;
  double low, shift, quotient = 0.0;
  if (!find_shift(curvature, &low, &shift)) return false;
  if (shift <= 1e-13 * curvature->scale) return false;
  for (int32_t i = 0; i < n; i++) step[i] = sin(1.0 + 12.9898 * i);
  for (int turn = 0; turn < 20; turn++) {
    strut_ldl_solve(curvature->ldl, step);
    double length = sqrt(strut_dot(step, step, n));
    for (int32_t i = 0; i < n; i++) step[i] /= length;
    strut_sparse_multiply(curvature->hessian, step, curvature->work);
    quotient = strut_dot(step, curvature->work, n);
    if (turn > 3 && quotient < 0) break;
  }
  return quotient < -1e-13 * curvature->scale;
}

const strut_curvature strut_curvature_sparse = {
    sparse_create,      sparse_decompose,          sparse_trust_step, sparse_rebalance,
    sparse_newton_step, sparse_unstable_direction, sparse_free};

/* Displacement of coordinate `at` per unit of (along x, along y, rotation about the centre by 1/size). */
typedef struct frame {
  double centre[2], size;
} frame;

static frame frame_of(const strut_model *model, const double *q) {
  frame f = {{0.0, 0.0}, model->size > 0 ? model->size : 1.0};
  for (int32_t at = 0; at < 2 * model->node_count; at++) f.centre[at % 2] += q[at];
  for (int c = 0; c < 2; c++) f.centre[c] /= model->node_count;
  return f;
}

static void motion_at(const frame *self, const double *q, int32_t at, double row[3]) {
  int32_t node = at / 2;
  row[0] = at % 2 == 0, row[1] = at % 2 == 1;
  row[2] = at % 2 == 0 ? -(q[2 * node + 1] - self->centre[1]) / self->size
                       : (q[2 * node] - self->centre[0]) / self->size;
}

/* Takes the directions of the earlier ones out of row `count`; false where nothing is left. */
static bool make_orthonormal(double *motion, int32_t n, int32_t count) {
  double *row = motion + (size_t)count * (size_t)n, before = strut_dot(row, row, n);
  double left = strut_remove_shares(motion, (size_t)count, (size_t)n, row);
  if (!(left > 1e-18 * before)) return false;
  for (int32_t i = 0; i < n; i++) row[i] /= sqrt(left);
  return true;
}

/* held (3, 3) += row row' of a row of displacements in the motions. */
static void hold(const double row[3], double held[9]) {
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) held[3 * i + k] += row[i] * row[k];
}

int32_t strut_rigid_motions(const strut_potential *potential, const double *q,
                            const uint8_t *closed, double *motion) {
  const strut_model *model = potential->model;
  frame f = frame_of(model, q);
  double held[9] = {0}, value[3], vector[9], row[3], beside[3];
  if (!strut_model_may_turn(model)) held[8] = 1.0;
  for (int32_t at = 0; at < 2 * model->node_count; at++) {
    if (potential->row_of[at] >= 0) continue;
    motion_at(&f, q, at, row);
    hold(row, held);
  }
  for (int32_t i = 0; i < model->contacts.count && closed; i++) {
    if (!closed[i]) continue;
    const strut_contact_pose pose = strut_contact_pose_at(&model->contacts, i, q, NULL, -1);
    motion_at(&f, q, (int32_t)model->contacts.at[i], row);
    motion_at(&f, q, (int32_t)model->contacts.at[i] + 1, beside);
    for (int k = 0; k < 3; k++)
      row[k] = pose.axes.normal[0] * row[k] + pose.axes.normal[1] * beside[k];
    hold(row, held);
  }
  if (!strut_symmetric_eigen(held, 3, value, vector)) return 0;
  int32_t count = 0;
  for (int i = 0; i < 3 && potential->n > 0; i++) {
    if (value[i] > 1e-14 * (1.0 + value[2])) continue;
    double *to = motion + (size_t)count * (size_t)potential->n;
    for (int32_t k = 0; k < potential->n; k++) {
      motion_at(&f, q, potential->coordinate[k], row);
      to[k] = vector[3 * i] * row[0] + vector[3 * i + 1] * row[1] + vector[3 * i + 2] * row[2];
    }
    if (make_orthonormal(motion, potential->n, count)) count++;
  }
  return count;
}

int32_t strut_rigid_motions_free(int32_t rows, double tolerance, int32_t count, double *motion,
                                 double *image) {
  assert(count >= 0 && count <= 3);
  size_t n = (size_t)rows, all = (size_t)count, kept = 0;
  double form[9], value[3], vector[9];
  for (size_t i = 0; i < all; i++)
    for (size_t k = 0; k < all; k++)
      form[i * all + k] = strut_dot(image + i * n, image + k * n, rows);
  if (!strut_symmetric_eigen(form, all, value, vector)) return 0;
  memcpy(image, motion, all * n * sizeof *image);
  for (; kept < all && value[kept] <= tolerance * tolerance; kept++)
    for (size_t at = 0; at < n; at++) {
      double sum = 0.0;
      for (size_t k = 0; k < all; k++) sum += vector[kept * all + k] * image[k * n + at];
      motion[kept * n + at] = sum;
    }
  return (int32_t)kept;
}
