/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/curvature.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/algebra.h"
#include "engine/statics/potential.h"

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
static double shares_at(const strut_quadratic *r, double mu, double *x) {
  for (int32_t i = 0; i < r->n; i++)
    x[i] = r->idle[i] || r->part[i] == 0.0 ? 0.0 : -r->part[i] / (r->value[i] + mu);
  return mu;
}

double strut_trust_step(const strut_quadratic *r, double radius, double *x) {
  assert(radius > 0.0);
  double size = 0.0, slope;
  int32_t low = -1;
  for (int32_t i = 0; i < r->n; i++) {
    if (r->idle[i]) continue;
    if (low < 0 || r->value[i] < r->value[low]) low = i;
    size += r->part[i] * r->part[i];
  }
  size = sqrt(size);
  if (low < 0) return shares_at(r, 0.0, x); /* no mode has a force */
  double lowest = r->value[low];
  double floor = fmax(0.0, -lowest) + (lowest <= 0 ? DBL_EPSILON * r->scale + 1e-300 : 0.0);
  double length = step_length_at(r, floor, &slope);
  if (length > radius)
    return shares_at(r, solve_secular(step_length_at, r, floor, floor + size / radius, radius), x);
  shares_at(r, floor, x);
  if (lowest > -r->noise) return floor;
  double rest = sqrt(fmax(radius * radius - length * length, 0.0)); /* the hard case */
  x[low] += r->part[low] > 0 ? -rest : rest;
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
  double *part, *x;  /* (n) the gradient and the step in the modes, or in the basis of T */
  uint8_t *idle;     /* (n) modes to leave alone */
  double scale;      /* largest |eigenvalue| */
  double multiplier; /* of the step that descend gave last */
} dense_curvature;

static void dense_free(void *memory) {
  dense_curvature *r = memory;
  if (!r) return;
  strut_spectrum_free(r->spectra);
  strut_release(r->part);
  strut_release(r->x);
  strut_release(r->idle);
  strut_release(r);
}

void *strut_curvature_dense_create(const strut_potential *potential) {
  dense_curvature *r = strut_allocate(1, sizeof *r);
  if (!r) return NULL;
  r->spectra = strut_spectrum_create(potential);
  r->part = strut_allocate((size_t)potential->n, sizeof *r->part);
  r->x = strut_allocate((size_t)potential->n, sizeof *r->x);
  r->idle = strut_allocate((size_t)potential->n, sizeof *r->idle);
  if (r->spectra && r->part && r->x && r->idle) return r;
  dense_free(r);
  return NULL;
}

/* The modes of what was reduced last, at q; NULL where it is not singular, which refines nothing. */
static bool find_modes(dense_curvature *r, const double *q) {
  if (r->has_modes) return true;
  r->has_modes = strut_spectrum_finish(r->spectra, q, false, &r->now);
  if (r->has_modes && r->now.n)
    r->scale = fmax(fabs(r->now.value[0]), fabs(r->now.value[r->now.n - 1]));
  return r->has_modes;
}

static bool dense_decompose(void *memory, const double *q) {
  dense_curvature *r = memory;
  bool singular;
  r->has_modes = false;
  if (!strut_spectrum_reduce(r->spectra, q, &r->reduced, &singular)) return false;
  r->scale = r->reduced->bound;
  return (!singular && r->reduced->n > FEW_MODES) || find_modes(r, q);
}

static bool is_definite(dense_curvature *r) {
  return !r->has_modes && strut_tridiagonal_factor(r->reduced, 0.0) == 0;
}

/* |x| of x = -(T + mu)^-1 part, and d|x|/dmu; infinite where T + mu is not positive definite. */
static double reduced_length_at(const void *memory, double mu, double *slope) {
  const dense_curvature *r = memory;
  int32_t n = r->reduced->n;
  *slope = 0.0;
  if (strut_tridiagonal_factor(r->reduced, mu) > 0) return HUGE_VAL;
  for (int32_t i = 0; i < n; i++) r->x[i] = -r->part[i];
  strut_tridiagonal_solve(r->reduced, r->x);
  double length = sqrt(strut_dot(r->x, r->x, n));
  if (length > 0) *slope = -strut_tridiagonal_form(r->reduced, r->x) / length;
  return length;
}

static void enter_basis(dense_curvature *r, const double *g) {
  memcpy(r->part, g, (size_t)r->reduced->n * sizeof *g);
  strut_tridiagonal_enter(r->reduced, r->part);
}

/* False in the hard case, which needs the lowest mode: g has next to no share of it. */
static bool step_in_basis(dense_curvature *r, const double *g, double radius, double *s,
                          strut_model_step *step) {
  int32_t n = r->reduced->n;
  enter_basis(r, g);
  double slope, mu = 0.0, length = reduced_length_at(r, mu, &slope);
  if (length > radius) {
    double size = sqrt(strut_dot(r->part, r->part, n)), lowest = isfinite(length) ? 0.0 : r->scale;
    mu = solve_secular(reduced_length_at, r, 0.0, lowest + size / radius, radius);
    length = reduced_length_at(r, mu, &slope);
    if (!(fabs(length - radius) <= 1e-5 * radius)) return false;
  }
  r->multiplier = mu;
  *step = (strut_model_step){length, 0.5 * (mu * length * length - strut_dot(r->part, r->x, n))};
  memcpy(s, r->x, (size_t)n * sizeof *s);
  strut_tridiagonal_leave(r->reduced, s);
  return true;
}

/* s from its shares; its length and what the model gains by it. */
static strut_model_step assemble_step(const dense_curvature *r, double *s) {
  strut_model_step step = {.length = strut_spectrum_combine(&r->now, r->x, s)};
  for (int32_t i = 0; i < r->now.n; i++)
    if (r->x[i] != 0.0) step.reduction -= r->x[i] * (r->part[i] + 0.5 * r->now.value[i] * r->x[i]);
  return step;
}

static strut_model_step dense_trust_step(void *memory, const double *g, double radius, double still,
                                         double *s) {
  dense_curvature *r = memory;
  strut_model_step step = {0};
  if (!r->has_modes && step_in_basis(r, g, radius, s, &step)) return step;
  if (!find_modes(r, NULL)) return step;
  strut_spectrum_split(&r->now, g, still, r->part, r->idle);
  strut_quadratic model = {r->now.n, r->now.value, r->part, r->idle, r->scale, 0.0};
  if (r->now.n > 0) model.noise = 4.0 * r->now.noise[0];
  r->multiplier = strut_trust_step(&model, radius, r->x);
  return assemble_step(r, s);
}

/* A border in the middle of the gap above `stiff`; 0: no mode is stiffer. */
static double find_border(dense_curvature *r, double stiff) {
  int32_t soft = strut_tridiagonal_factor(r->reduced, -stiff);
  double high = stiff;
  if (soft == r->reduced->n) return 0.0;
  while (strut_tridiagonal_factor(r->reduced, -10.0 * high) == soft) high *= 10.0;
  return sqrt(stiff * high);
}

/*
 * Newton's step weighed mode by mode by 1 - 5 u^4 + 4 u^5, u = c / (value + c): 1 for stiff modes, to
 * (c / value)^4, and 0 for soft ones, to (value / c)^2. A border within a gap is as good as a sharp one.
 */
static bool rebalance_in_basis(dense_curvature *r, const double *g, double stiff, double *s) {
  int32_t n = r->reduced->n;
  double c = 2.0 * find_border(r, stiff);
  if (c == 0.0 || strut_tridiagonal_factor(r->reduced, c) > 0) return false;
  enter_basis(r, g);
  memset(r->x, 0, (size_t)n * sizeof *r->x);
  for (int k = 1; k <= 5; k++) {
    strut_tridiagonal_solve(r->reduced, r->part);
    for (int32_t i = 0; i < n; i++) r->x[i] += (k < 5 ? 1.0 : -4.0) * r->part[i];
    for (int32_t i = 0; i < n; i++) r->part[i] *= c;
  }
  strut_tridiagonal_leave(r->reduced, r->x);
  for (int32_t i = 0; i < n; i++) s[i] -= r->x[i];
  return true;
}

static bool dense_rebalance(void *memory, const double *g, double *s) {
  dense_curvature *r = memory;
  double stiff = r->multiplier > 0 ? 10.0 * r->multiplier : 1e-3 * r->scale;
  if (!r->has_modes) return rebalance_in_basis(r, g, stiff, s);
  return strut_spectrum_rebalance(&r->now, r->now.value, stiff, g, s);
}

static double dense_newton_step(void *memory, const double *g, double *s) {
  dense_curvature *r = memory;
  strut_model_step step;
  if (is_definite(r) && step_in_basis(r, g, HUGE_VAL, s, &step)) return step.length;
  if (!find_modes(r, NULL)) return HUGE_VAL;
  strut_spectrum_split(&r->now, g, HUGE_VAL, r->part, r->idle);
  for (int32_t i = 0; i < r->now.n; i++) r->x[i] = r->idle[i] ? 0.0 : -r->part[i] / r->now.value[i];
  return assemble_step(r, s).length;
}

static bool dense_unstable_direction(void *memory, double *s) {
  dense_curvature *r = memory;
  if (is_definite(r)) return false;
  if (!find_modes(r, NULL) || r->now.n == 0 || !(r->now.value[0] < -4.0 * r->now.noise[0]))
    return false;
  memcpy(s, r->now.vector, (size_t)r->now.n * sizeof *s);
  return true;
}

const strut_curvature strut_curvature_dense = {dense_decompose,          dense_trust_step,
                                               dense_rebalance,          dense_newton_step,
                                               dense_unstable_direction, dense_free};

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
  sparse_curvature *r = memory;
  if (!r) return;
  strut_ldl_free(r->ldl);
  strut_arena_free(&r->arena);
  strut_release(r);
}

void *strut_curvature_sparse_create(const strut_potential *potential) {
  sparse_curvature *r = strut_allocate(1, sizeof *r);
  if (!r) return NULL;
  r->potential = potential;
  r->hessian = strut_potential_matrix(potential, &r->arena);
  r->work = strut_arena_allocate(&r->arena, (size_t)potential->n, sizeof *r->work);
  r->scratch = strut_arena_allocate(&r->arena, (size_t)potential->n, sizeof *r->scratch);
  size_t nonzeros = r->hessian ? (size_t)r->hessian->start[r->hessian->n] : 0;
  r->factored = strut_arena_allocate(&r->arena, nonzeros, sizeof *r->factored);
  r->shift = (double)NAN;
  if (r->hessian && r->work && r->scratch && r->factored &&
      strut_ldl_create(potential->pattern, &r->ldl, NULL) == STRUT_OK)
    return r;
  sparse_free(r);
  return NULL;
}

/* Pivots of this share of their diagonal are rounding: neither their size nor their sign counts. */
static const double NOISE = 32 * DBL_EPSILON;

/* Factorises H + shift, unless that was done last; true where it is positive definite beyond rounding. */
static bool factorise(sparse_curvature *r, double shift) {
  bool good =
      r->shift == shift || strut_ldl_factorise(r->ldl, r->hessian, shift, &r->inertia) == STRUT_OK;
  r->shift = good ? shift : (double)NAN;
  return good && r->inertia.negative == 0 && r->inertia.smallest > NOISE;
}

static bool sparse_decompose(void *memory, const double *q) {
  sparse_curvature *r = memory;
  const strut_sparse *h = r->hessian;
  size_t bytes = (size_t)h->start[h->n] * sizeof *h->value;
  strut_potential_hessian(r->potential, q, r->hessian);
  bool same = memcmp(r->factored, h->value, bytes) == 0;
  r->scale = 0.0;
  for (int32_t k = 0; k < h->start[h->n]; k++)
    if (!isfinite(h->value[k])) return false;
  for (int32_t j = 0; j < h->n; j++) r->scale = fmax(r->scale, fabs(h->value[h->start[j]]));
  if (same) return true;
  memcpy(r->factored, h->value, bytes);
  r->shift = (double)NAN;
  return true;
}

/* s = -(H + shift)^-1 g; its length. */
static double solve_shifted(sparse_curvature *r, const double *g, double *s) {
  int32_t n = r->hessian->n;
  for (int32_t i = 0; i < n; i++) s[i] = -g[i];
  strut_ldl_solve(r->ldl, s);
  return sqrt(strut_dot(s, s, n));
}

static strut_model_step evaluate_step(sparse_curvature *r, const double *g, const double *s) {
  int32_t n = r->hessian->n;
  strut_sparse_multiply(r->hessian, s, r->work);
  return (strut_model_step){sqrt(strut_dot(s, s, n)),
                            -strut_dot(g, s, n) - 0.5 * strut_dot(s, r->work, n)};
}

/* The smallest of the shifts tried at which H + shift is positive definite; false: none is. */
static bool find_shift(sparse_curvature *r, double *low, double *shift) {
  *low = 0.0;
  if (factorise(r, 0.0)) {
    *shift = 0.0;
    return true;
  }
  double next = 1e-14 * r->scale + 1e-300;
  for (int i = 0; i < 40; i++, next *= 10.0) {
    if (factorise(r, next)) {
      *shift = next;
      return true;
    }
    if (!isnan(r->shift)) *low = next;
  }
  return false;
}

/* Reduces a shift that is larger than necessary towards `low`, which is too small: a longer step. */
static double lengthen_step(sparse_curvature *r, const double *g, double radius, double low,
                            double shift, double length, double *s) {
  for (int i = 0; i < 3 && low > 0 && length < 0.7 * radius; i++) {
    double between = sqrt(low * shift);
    bool good = factorise(r, between);
    double longer = good ? solve_shifted(r, g, s) : HUGE_VAL;
    if (longer <= radius) {
      shift = between, length = longer;
      continue;
    }
    low = between;
    factorise(r, shift);
    length = solve_shifted(r, g, s);
  }
  return length;
}

/*
 * From a shift whose step is too long upwards: Newton's method on 1/|s|, each trial a new factor.
 */
static void shorten_step(sparse_curvature *r, const double *g, double radius, double low,
                         double length, double *s) {
  int32_t n = r->hessian->n;
  double high = HUGE_VAL, shift = low;
  for (int i = 0; i < 30 && !(length <= radius && length > 0.7 * radius); i++) {
    memcpy(r->scratch, s, (size_t)n * sizeof *s);
    strut_ldl_solve(r->ldl, r->scratch);
    double slope = strut_dot(s, r->scratch, n); /* -|s| d|s|/dshift */
    double next = shift + length * length * (length / (0.85 * radius) - 1.0) / slope;
    if (!(next > low && next < high))
      next = high == HUGE_VAL ? fmax(10.0 * low, 1e-14 * r->scale) : 0.5 * (low + high);
    if (high - low <= 1e-3 * high && length <= radius) break;
    if (!factorise(r, next)) break;
    shift = next;
    length = solve_shifted(r, g, s);
    *(length > radius ? &low : &high) = shift;
  }
  if (length <= radius) return;
  for (int32_t i = 0; i < n; i++) s[i] *= radius / length;
}

/* A step of 0.7 to 1 radius is good enough, or a shorter one where Newton's is. */
static strut_model_step sparse_trust_step(void *memory, const double *g, double radius,
                                          double still, double *s) {
  sparse_curvature *r = memory;
  double low, shift;
  (void)still;
  if (!find_shift(r, &low, &shift)) return (strut_model_step){0};
  double length = solve_shifted(r, g, s);
  if (length > radius)
    shorten_step(r, g, radius, shift, length, s);
  else if (shift > 0)
    lengthen_step(r, g, radius, low, shift, length, s);
  return evaluate_step(r, g, s);
}

/* A factor does not know its stiff modes. */
static bool sparse_rebalance(void *memory, const double *g, double *s) {
  (void)memory, (void)g, (void)s;
  return false;
}

static double sparse_newton_step(void *memory, const double *g, double *s) {
  sparse_curvature *r = memory;
  factorise(r, 0.0);
  if (isnan(r->shift) || r->inertia.smallest <= NOISE) factorise(r, 1e-13 * r->scale);
  return isnan(r->shift) ? HUGE_VAL : solve_shifted(r, g, s);
}

/*
 * Inverse iteration from a start that leans on no motion, shifted to just below the lowest value.
 */
static bool sparse_unstable_direction(void *memory, double *s) {
  sparse_curvature *r = memory;
  int32_t n = r->hessian->n;
  double low, shift, quotient = 0.0;
  if (!find_shift(r, &low, &shift)) return false;
  if (shift <= 1e-13 * r->scale) return false;
  for (int32_t i = 0; i < n; i++) s[i] = sin(1.0 + 12.9898 * i);
  for (int turn = 0; turn < 20; turn++) {
    strut_ldl_solve(r->ldl, s);
    double length = sqrt(strut_dot(s, s, n));
    for (int32_t i = 0; i < n; i++) s[i] /= length;
    strut_sparse_multiply(r->hessian, s, r->work);
    quotient = strut_dot(s, r->work, n);
    if (turn > 3 && quotient < 0) break;
  }
  return quotient < -1e-13 * r->scale;
}

const strut_curvature strut_curvature_sparse = {sparse_decompose,          sparse_trust_step,
                                                sparse_rebalance,          sparse_newton_step,
                                                sparse_unstable_direction, sparse_free};

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

static void motion_at(const frame *f, const double *q, int32_t at, double row[3]) {
  int32_t node = at / 2;
  row[0] = at % 2 == 0, row[1] = at % 2 == 1;
  row[2] = at % 2 == 0 ? -(q[2 * node + 1] - f->centre[1]) / f->size
                       : (q[2 * node] - f->centre[0]) / f->size;
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

int32_t strut_rigid_motions(const strut_potential *p, const double *q, const uint8_t *closed,
                            double *motion) {
  const strut_model *model = p->model;
  frame f = frame_of(model, q);
  double held[9] = {0}, value[3], vector[9], row[3], beside[3];
  if (!strut_model_may_turn(model)) held[8] = 1.0;
  for (int32_t at = 0; at < 2 * model->node_count; at++) {
    if (p->row_of[at] >= 0) continue;
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
  for (int i = 0; i < 3 && p->n > 0; i++) {
    if (value[i] > 1e-14 * (1.0 + value[2])) continue;
    double *to = motion + (size_t)count * (size_t)p->n;
    for (int32_t k = 0; k < p->n; k++) {
      motion_at(&f, q, p->coordinate[k], row);
      to[k] = vector[3 * i] * row[0] + vector[3 * i + 1] * row[1] + vector[3 * i + 2] * row[2];
    }
    if (make_orthonormal(motion, p->n, count)) count++;
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
