/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/statics/minimise.h"

#include "engine/base/vec.h"
#include "engine/statics/algebra.h"

/* |x| for the multiplier mu, and d|x|/dmu; mu lies above minus the lowest value. */
static double step_length_at(void *quadratic, double mu, double *slope) {
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

/* Errors of a step's length, relative: of one from modes, and of one from factors, each of which takes time. */
static const double CLOSE = 1e-6, ROUGH = 1e-4;

/* The multiplier at which |x| is the radius, between low (too long a step there) and high. */
static double solve_secular(double (*step_length)(void *r, double mu, double *slope), void *r,
                            double low, double high, double radius, double error) {
  double mu = low > 0 ? low * (1.0 + 1e-12) : low;
  for (int i = 0; i < 80 && high - low > 0.01 * error * error * high; i++) {
    if (!(mu > low && mu < high)) mu = low > 0 ? 0.5 * (low + high) : 1e-3 * high;
    double slope, length = step_length(r, mu, &slope);
    if (fabs(length - radius) <= error * radius) return mu;
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
  strut_quadratic own = *quadratic;
  int32_t low = -1;
  for (int32_t i = 0; i < own.n; i++) {
    if (own.idle[i]) continue;
    if (low < 0 || own.value[i] < own.value[low]) low = i;
    size += own.part[i] * own.part[i];
  }
  size = sqrt(size);
  if (low < 0) return shares_at(&own, 0.0, vector); /* no mode has a force */
  double lowest = own.value[low];
  double floor = fmax(0.0, -lowest) + (lowest <= 0 ? DBL_EPSILON * own.scale + 1e-300 : 0.0);
  double length = step_length_at(&own, floor, &slope);
  if (length > radius)
    return shares_at(
        &own, solve_secular(step_length_at, &own, floor, floor + size / radius, radius, CLOSE),
        vector);
  shares_at(&own, floor, vector);
  if (lowest > -own.noise) return floor;
  double rest = sqrt(fmax(radius * radius - length * length, 0.0)); /* the hard case */
  vector[low] += own.part[low] > 0 ? -rest : rest;
  return floor;
}

/*
 * Steps by an L D L' factor of the Hessian, shifted until they are as long as the radius. Up to
 * STRUT_DENSE_STATICS coordinates its modes serve where it is singular, so that motions without stiffness are left
 * alone, where the lowest one is needed, and where there are so few that they cost next to nothing.
 */
enum { FEW_MODES = 20 };

/* Pivots of this share of their diagonal are rounding: neither their size nor their sign counts. */
static const double NOISE = 32 * DBL_EPSILON;

struct strut_curvature {
  const strut_potential *potential;
  strut_sparse *hessian;
  double *known;  /* (nonzeros) the Hessian decomposed last */
  double scale;   /* no |eigenvalue| is larger */
  strut_ldl *ldl; /* NULL: there are few coordinates */
  strut_inertia inertia;
  double shift;                      /* of the current factor; NAN without one */
  strut_spectrum_workspace *spectra; /* NULL: there are too many coordinates for modes */
  const double *q;                   /* where it was decomposed last; NULL before */
  bool has_modes;                    /* `now` is filled */
  strut_spectrum now;
  const double *gradient; /* of the step at hand */
  double *part, *x;       /* (n) the gradient and the step in the modes; or scratch, and the step */
  uint8_t *idle;          /* (n) modes to leave alone */
  double multiplier;      /* of the step that strut_curvature_trust_step gave last */
  double border;          /* between soft and stiff modes for it; NAN: not known yet */
};

strut_status strut_curvature_create(const strut_potential *potential, strut_arena *arena,
                                    strut_curvature **curvature, strut_error *error) {
  size_t n = (size_t)potential->n;
  bool modes = potential->n <= STRUT_DENSE_STATICS;
  strut_curvature *c = *curvature = strut_arena_allocate(arena, 1, sizeof *c);
  strut_sparse *hessian = strut_potential_matrix(potential, arena);
  if (!c || !hessian || !STRUT_ALLOCATE(arena, STRUT_NEW(c->idle, n)) ||
      !STRUT_NUMBERS(arena, n, &c->part, &c->x) ||
      !STRUT_NUMBERS(arena, (size_t)hessian->start[n], &c->known) ||
      (modes && !(c->spectra = strut_spectrum_create(potential, arena))))
    return strut_no_memory(error, "");
  c->potential = potential;
  c->hessian = hessian;
  c->shift = (double)NAN;
  return n > FEW_MODES ? strut_ldl_create(potential->pattern, arena, &c->ldl, error) : STRUT_OK;
}

/* The modes where the Hessian was decomposed; false: there are too many. */
static bool find_modes(strut_curvature *curvature) {
  if (curvature->has_modes || !curvature->spectra) return curvature->has_modes;
  curvature->has_modes = strut_spectrum_compute(curvature->spectra, curvature->hessian,
                                                curvature->q, 0.0, false, &curvature->now);
  if (curvature->has_modes && curvature->now.n)
    curvature->scale =
        fmax(fabs(curvature->now.value[0]), fabs(curvature->now.value[curvature->now.n - 1]));
  return curvature->has_modes;
}

/* Factorises H + shift, unless that was done last; true where it is positive definite beyond rounding. */
static bool factorise(strut_curvature *curvature, double shift) {
  bool good = curvature->shift == shift ||
              strut_ldl_factorise(curvature->ldl, curvature->hessian, shift, &curvature->inertia) ==
                  STRUT_OK;
  curvature->shift = good ? shift : (double)NAN;
  return good && curvature->inertia.negative == 0 && curvature->inertia.smallest > NOISE;
}

/* May some eigenvalue be all rounding? Where all pivots are large none is. */
static bool is_singular(strut_curvature *curvature) {
  const double large = 1e-5;
  double noise = strut_spectrum_noise(curvature->spectra, curvature->scale);
  factorise(curvature, 0.0);
  if (!isnan(curvature->shift) && curvature->inertia.smallest > large) return false;
  if (factorise(curvature, -noise)) return false;
  int32_t above = curvature->inertia.negative;
  bool known = !isnan(curvature->shift);
  factorise(curvature, noise);
  return !known || isnan(curvature->shift) || curvature->inertia.negative != above;
}

bool strut_curvature_decompose(strut_curvature *curvature, const double *q) {
  const strut_sparse *matrix = curvature->hessian;
  size_t bytes = (size_t)matrix->start[matrix->n] * sizeof *matrix->value;
  double square = 0.0;
  strut_potential_hessian(curvature->potential, q, curvature->hessian);
  for (int32_t j = 0; j < matrix->n; j++)
    for (int32_t k = matrix->start[j]; k < matrix->start[j + 1]; k++) {
      if (!isfinite(matrix->value[k])) return false;
      square += (k == matrix->start[j] ? 1.0 : 2.0) * matrix->value[k] * matrix->value[k];
    }
  if (curvature->q && memcmp(curvature->known, matrix->value, bytes) == 0) return true;
  memcpy(curvature->known, matrix->value, bytes);
  curvature->q = q;
  curvature->scale = sqrt(square);
  curvature->shift = (double)NAN;
  curvature->has_modes = false;
  if (curvature->spectra && (!curvature->ldl || is_singular(curvature)))
    return find_modes(curvature);
  return true;
}

/* |x| of x = -(H + mu)^-1 g, and d|x|/dmu; infinite where H + mu is not positive definite. */
static double factored_length_at(void *memory, double mu, double *slope) {
  strut_curvature *curvature = memory;
  int32_t n = curvature->hessian->n;
  double *x = curvature->x;
  *slope = 0.0;
  if (!factorise(curvature, mu)) return HUGE_VAL;
  for (int32_t i = 0; i < n; i++) x[i] = -curvature->gradient[i];
  strut_ldl_solve(curvature->ldl, x);
  memcpy(curvature->part, x, (size_t)n * sizeof *x);
  strut_ldl_solve(curvature->ldl, curvature->part);
  double length = sqrt(strut_dot(x, x, n));
  if (length > 0) *slope = -strut_dot(x, curvature->part, n) / length;
  return length;
}

/* A step by factors. False in the hard case, which needs the lowest mode: g has next to no share of it. */
static bool step_by_factor(strut_curvature *curvature, const double *gradient, double radius,
                           double *s, strut_model_step *step) {
  int32_t n = curvature->hessian->n;
  curvature->gradient = gradient;
  double slope, mu = 0.0, length = factored_length_at(curvature, mu, &slope);
  if (length > radius) {
    double size = sqrt(strut_dot(gradient, gradient, n)),
           lowest = isfinite(length) ? 0.0 : curvature->scale;
    mu = solve_secular(factored_length_at, curvature, 0.0, lowest + size / radius, radius, ROUGH);
    length = factored_length_at(curvature, mu, &slope);
    if (!isfinite(length)) length = factored_length_at(curvature, mu *= 1.0 + ROUGH, &slope);
    if (!isfinite(length) || (curvature->spectra && length < (1.0 - ROUGH) * radius)) return false;
  }
  curvature->multiplier = mu;
  *step = (strut_model_step){length,
                             0.5 * (mu * length * length - strut_dot(gradient, curvature->x, n))};
  memcpy(s, curvature->x, (size_t)n * sizeof *s);
  return true;
}

/* s from its shares; its length and what the model gains by it. */
static strut_model_step assemble_step(const strut_curvature *curvature, double *s) {
  strut_model_step step = {.length = strut_spectrum_combine(&curvature->now, curvature->x, s)};
  for (int32_t i = 0; i < curvature->now.n; i++)
    if (curvature->x[i] != 0.0)
      step.reduction -=
          curvature->x[i] * (curvature->part[i] + 0.5 * curvature->now.value[i] * curvature->x[i]);
  return step;
}

strut_model_step strut_curvature_trust_step(strut_curvature *curvature, const double *gradient,
                                            double radius, double still, double *s) {
  strut_model_step step = {0};
  curvature->border = (double)NAN;
  if (!curvature->has_modes && step_by_factor(curvature, gradient, radius, s, &step)) return step;
  if (!find_modes(curvature)) return step;
  strut_spectrum_split(&curvature->now, gradient, still, curvature->part, curvature->idle);
  strut_quadratic model = {curvature->now.n, curvature->now.value, curvature->part,
                           curvature->idle,  curvature->scale,     0.0};
  if (curvature->now.n > 0) model.noise = 4.0 * curvature->now.noise[0];
  curvature->multiplier = strut_trust_step(&model, radius, curvature->x);
  return assemble_step(curvature, s);
}

/* Eigenvalues of H below `border`. */
static int32_t count_below(strut_curvature *curvature, double border) {
  factorise(curvature, -border);
  return curvature->inertia.negative;
}

/* A border in the middle of the gap above `stiff`; 0: no mode is stiffer. */
static double find_border(strut_curvature *curvature, double stiff) {
  int32_t soft = count_below(curvature, stiff);
  double high = stiff;
  if (soft == curvature->hessian->n) return 0.0;
  while (high < curvature->scale && count_below(curvature, 10.0 * high) == soft) high *= 10.0;
  return sqrt(stiff * high);
}

/*
 * Newton's step weighed mode by mode by 1 - 5 u^4 + 4 u^5, u = c / (value + c): 1 for stiff modes, to
 * (c / value)^4, and 0 for soft ones, to (value / c)^2.
 */
static bool rebalance_by_factor(strut_curvature *curvature, const double *gradient, double c,
                                double *step) {
  int32_t n = curvature->hessian->n;
  if (c == 0.0 || !factorise(curvature, c)) return false;
  memcpy(curvature->part, gradient, (size_t)n * sizeof *gradient);
  for (int k = 1; k <= 5; k++) {
    strut_ldl_solve(curvature->ldl, curvature->part);
    for (int32_t i = 0; i < n; i++) step[i] -= (k < 5 ? 1.0 : -4.0) * curvature->part[i];
    for (int32_t i = 0; i < n; i++) curvature->part[i] *= c;
  }
  return true;
}

bool strut_curvature_rebalance(strut_curvature *curvature, const double *gradient, double *step) {
  double stiff = curvature->multiplier > 0 ? 10.0 * curvature->multiplier : 1e-3 * curvature->scale;
  if (!curvature->has_modes) {
    if (isnan(curvature->border)) curvature->border = find_border(curvature, stiff);
    return rebalance_by_factor(curvature, gradient, 2.0 * curvature->border, step);
  }
  return strut_spectrum_rebalance(&curvature->now, curvature->now.value, stiff, gradient, step);
}

double strut_curvature_newton_step(strut_curvature *curvature, const double *gradient, double *s) {
  strut_model_step step;
  if (!curvature->has_modes && !factorise(curvature, 0.0) && !find_modes(curvature) &&
      (isnan(curvature->shift) || curvature->inertia.smallest <= NOISE))
    factorise(curvature, 1e-13 * curvature->scale);
  if (!curvature->has_modes) {
    if (isnan(curvature->shift)) return HUGE_VAL;
    for (int32_t i = 0; i < curvature->hessian->n; i++) s[i] = -gradient[i];
    strut_ldl_solve(curvature->ldl, s);
    return sqrt(strut_dot(s, s, curvature->hessian->n));
  }
  strut_spectrum_split(&curvature->now, gradient, HUGE_VAL, curvature->part, curvature->idle);
  for (int32_t i = 0; i < curvature->now.n; i++)
    curvature->x[i] = curvature->idle[i] ? 0.0 : -curvature->part[i] / curvature->now.value[i];
  step = assemble_step(curvature, s);
  return step.length;
}

bool strut_curvature_unstable_direction(strut_curvature *curvature, double *step) {
  int32_t n = curvature->hessian->n;
  double least = 1e-13 * curvature->scale;
  if (n == 0 || (!curvature->has_modes && factorise(curvature, 0.0))) return false;
  if (find_modes(curvature)) {
    memcpy(step, curvature->now.vector, (size_t)n * sizeof *step);
    return curvature->now.value[0] < -4.0 * curvature->now.noise[0];
  }
  curvature->shift = (double)NAN;
  return strut_ldl_lowest(curvature->ldl, curvature->hessian, least, step, curvature->x) < -least;
}

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
