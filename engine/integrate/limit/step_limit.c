/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/limit/step_limit.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "engine/forces/rigid.h"
#include "engine/forces/tangent.h"
#include "engine/integrate/limit/tangent_limits.h"
#include "engine/model/mass.h"
#include "engine/scene/signal_program.h"

/* |R(z)| of RK4 for z = x + i y, R(z) = 1 + z (1 + z/2 (1 + z/3 (1 + z/4))). */
static double growth(double x, double y) {
  double re = 1.0, im = 0.0;
  for (int k = 4; k >= 1; k--) {
    double next = 1.0 + (re * x - im * y) / k;
    im = (re * y + im * x) / k;
    re = next;
  }
  return sqrt(re * re + im * im); /* hypot differs by the C library */
}

double strut_rk4_limit(double re, double im) {
  double size = sqrt(re * re + im * im);
  if (!(size > 0)) return HUGE_VAL;
  if (re > 0) re = 0, size = fabs(im); /* a motion that grows by itself says nothing of the step */
  if (!(size > 0)) return HUGE_VAL;
  double x = re / size, y = im / size;
  double inside = 0.0, outside = 3.5;         /* RK4's region lies within |z| < 3.5 */
  for (double r = 0.05; r < 3.5; r += 0.05) { /* and holds |z| < 2.6 */
    if (r > 2.6 && growth(r * x, r * y) > 1.0 + 1e-12) {
      outside = r;
      break;
    }
    inside = r;
  }
  for (int i = 0; i < 60; i++) {
    double middle = 0.5 * (inside + outside);
    if (middle == inside || middle == outside) break;
    if (growth(middle * x, middle * y) > 1.0 + 1e-12)
      outside = middle;
    else
      inside = middle;
  }
  return inside / size;
}

/*
 * One step of Verlet maps (q, v, a) linearly. Are the roots of its characteristic polynomial,
 * x^3 + p x^2 + r x + s, within the unit circle? Jury's conditions; undamped modes lie on it.
 */
static bool verlet_holds(double h, double k, double d) {
  double hk = h * h * k, hd = h * d; /* rows of the matrix for (q, h v, h^2 a) */
  double m[3][3] = {{1.0, 1.0, 0.5},
                    {-0.5 * hk, 1.0 - 0.5 * (hk + hd), 0.5 - 0.5 * (0.5 * hk + hd)},
                    {-hk, -hk - hd, -0.5 * hk - hd}};
  double p = -(m[0][0] + m[1][1] + m[2][2]);
  double r = m[0][0] * m[1][1] - m[0][1] * m[1][0] + m[0][0] * m[2][2] - m[0][2] * m[2][0] +
             m[1][1] * m[2][2] - m[1][2] * m[2][1];
  double s = -(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
  const double slack = 1e-12;
  return 1.0 + p + r + s >= -slack && 1.0 - p + r - s >= -slack && fabs(s) <= 1.0 + slack &&
         fabs(r - p * s) <= 1.0 - s * s + slack;
}

double strut_verlet_limit(double k, double d) {
  double scale = fmax(sqrt(fmax(k, 0.0)), d);
  if (!(scale > 0.0)) return HUGE_VAL;
  double inside = 0.0, outside = 4.0;
  for (double x = 0.02; x < 4.0; x += 0.02) {
    if (!verlet_holds(x / scale, k, d)) {
      outside = x;
      break;
    }
    inside = x;
  }
  for (int i = 0; i < 60; i++) {
    double middle = 0.5 * (inside + outside);
    *(verlet_holds(middle / scale, k, d) ? &inside : &outside) = middle;
  }
  return inside / scale;
}

/* Semi-implicit Euler: (sqrt(d^2 + 4 k) - d) / k. */
static double euler_limit(double k, double d) {
  if (!(k > 0.0)) return d > 0.0 ? 2.0 / d : HUGE_VAL;
  return 4.0 / (d + sqrt(d * d + 4.0 * k));
}

/* The limit of a region for an eigenvalue re + i im of a mode with k and d. */
static double region_limit(strut_region region, double re, double im, double k, double d) {
  if (re > 0.0) k = im * im, d = 0.0; /* grows by itself, whatever the step */
  switch (region) {
    case STRUT_REGION_RK4: return strut_rk4_limit(re, im);
    case STRUT_REGION_VERLET: return strut_verlet_limit(k, fmax(d, 0.0));
    case STRUT_REGION_EULER: return euler_limit(k, fmax(d, 0.0));
    case STRUT_REGION_ALL:
    case STRUT_REGIONS: break;
  }
  return HUGE_VAL;
}

const strut_region_data *strut_region_at(strut_region region) {
  /* RK4 bears every complex eigenvalue below 2.6 / h, and every real one below 2.785 / h */
  static const strut_region_data data[STRUT_REGIONS] = {
      [STRUT_REGION_RK4] = {.sets = 2,
                            .set = {{1.0 / (2.6 * 2.6), 0.0}, {0.0, 1.0 / 2.7852935634}},
                            .growth = 4.0,
                            .by_eigenvalue = true},
      [STRUT_REGION_VERLET] = {.sets = 1, .set = {{0.25, 1.0}}, .growth = 1.0},
      [STRUT_REGION_EULER] = {.sets = 1, .set = {{0.25, 0.5}}, .growth = 1.0}};
  assert(region >= 0 && region < STRUT_REGIONS);
  return &data[region];
}

/*
 * Many coordinates: a space that grows by what the binding motions leave of K x and D x, Davidson's
 * method on the quadratic problem itself. Unlike Arnoldi's on the first-order system it keeps the
 * signs of K and D, so that no false eigenvalue lies beyond the true ones, with vectors half as long;
 * ARPACK, a floor above, knows the first-order form only.
 */
enum { ROOM = 64, MOST_ROUNDS = 14 };
/* Quotients come from below; the space has converged to a fraction of this. */
static const double MARGIN = 0.998, SETTLED = 2e-4;

typedef struct search {
  const strut_tangent *tangent;
  strut_arena *arena;
  strut_krylov_basis space;
  strut_tangent_limits found;
  bool damped, rk4;
  double *x, *y, *other, *mix, *work; /* (n) thrice, coefficients of binding motions */
} search;

static bool begin(search *self, const strut_model *model, int most) {
  size_t n = (size_t)self->tangent->n, m = (size_t)most;
  self->damped = false;
  for (int32_t i = 0; i < self->tangent->damping->start[n]; i++)
    self->damped = self->damped || self->tangent->damping->value[i] != 0.0;
  return STRUT_NUMBERS(self->arena, n, &self->x, &self->y, &self->other) &&
         STRUT_NUMBERS(self->arena, 2 * STRUT_MOST_BINDING * m, &self->mix) &&
         STRUT_NUMBERS(self->arena, m, &self->work) &&
         strut_krylov_basis_create(model, self->tangent, most, self->arena, &self->space) &&
         strut_tangent_limits_create(most, self->arena, &self->found);
}

/* Few coordinates: the space of all motions. */
static bool take_all(search *self) {
  for (int32_t i = 0; i < self->tangent->n; i++) {
    memset(self->x, 0, (size_t)self->tangent->n * sizeof *self->x);
    self->x[i] = 1.0;
    if (self->tangent->rigid) { /* a push on the coordinate moves it as the bars allow */
      strut_apply_inverse_mass(&self->space, self->x);
    }
    strut_krylov_basis_add(&self->space, self->x);
  }
  return strut_tangent_limits_find(&self->space, self->damped, self->rk4, &self->found);
}

/* to = M^-1 (K x + re D x - im D y). */
static void residual(search *self, double a, double re, double im, const double *vector,
                     const double *y, double *to) {
  strut_tangent_apply(&self->space, a, re, vector, to);
  if (im != 0.0) {
    double *image = self->space.image;
    strut_tangent_apply(&self->space, 0.0, -im, y, image);
    for (int32_t i = 0; i < self->tangent->n; i++) to[i] += image[i];
  }
  strut_apply_inverse_mass(&self->space, to);
}

/* Adds what binding motion i leaves. */
static void grow(search *self, const strut_critical_mode *mode) {
  strut_krylov_basis_combine(&self->space, mode->x, self->x);
  if (!mode->rk4 || !mode->complex_pair) {
    double a = mode->rk4 ? 1.0 : mode->a, c = mode->rk4 ? mode->re : mode->b;
    residual(self, a, c, 0.0, self->x, NULL, self->other);
    strut_krylov_basis_add(&self->space, self->other);
    return;
  }
  strut_krylov_basis_combine(&self->space, mode->y, self->y);
  residual(self, 1.0, mode->re, mode->im, self->x, self->y, self->other);
  strut_krylov_basis_add(&self->space, self->other);
  residual(self, 1.0, mode->re, -mode->im, self->y, self->x, self->other);
  strut_krylov_basis_add(&self->space, self->other);
}

/* Keeps the binding motions only. */
static void shrink(search *self) {
  size_t columns = (size_t)self->space.count;
  int rows = 0;
  for (int i = 0; i < self->found.count; i++) {
    const strut_critical_mode *mode = &self->found.binding[i];
    memcpy(self->mix + (size_t)rows++ * columns, mode->x, columns * sizeof(double));
    if (mode->complex_pair)
      memcpy(self->mix + (size_t)rows++ * columns, mode->y, columns * sizeof(double));
  }
  strut_krylov_basis_shrink(&self->space, self->mix, rows, self->work);
}

static bool find(search *self) {
  return strut_tangent_limits_find(&self->space, self->damped, self->rk4, &self->found);
}

/* By how much, relatively, some limit has fallen. */
static double fallen(const strut_tangent_limits *found, const double *before) {
  double most = 0.0;
  for (int region = 0; region < STRUT_REGIONS; region++)
    if (found->of[region] < HUGE_VAL)
      most = fmax(most, before[region] < HUGE_VAL
                            ? fabs(before[region] - found->of[region]) / found->of[region]
                            : 1.0);
  return most;
}

static bool look_around(search *self) {
  if (!strut_lanczos_limits(&self->space, 1.0, 0.0)) return false;
  if (!self->damped) return find(self);
  if (!strut_lanczos_limits(&self->space, 0.0, 1.0) || !find(self)) return false;
  double h = self->found.of[STRUT_REGION_VERLET];
  return !(h < HUGE_VAL) || (strut_lanczos_limits(&self->space, 0.25 * h * h, h) && find(self));
}

static bool improve(search *self) {
  int quiet = 0;
  for (int round = 0; round < MOST_ROUNDS && quiet < 2; round++) {
    double before[STRUT_REGIONS];
    memcpy(before, self->found.of, sizeof before);
    if (self->space.count + 2 * STRUT_MOST_BINDING > self->space.most) {
      shrink(self);
      if (!find(self)) return false;
    }
    strut_tangent_limits *found = &self->found;
    for (int i = 0; i < found->count; i++) {
      int had = self->space.count;
      grow(self, &found->binding[i]);
      /* coefficients of the other motions end where the space did when they were found */
      for (int k = i + 1; k < found->count; k++)
        for (int j = had; j < self->space.count; j++)
          found->binding[k].x[j] = found->binding[k].y[j] = 0.0;
    }
    if (!find(self)) return false;
    quiet = fallen(found, before) < SETTLED ? quiet + 1 : 0;
  }
  return true;
}

static void tell_found(const search *self, bool all, strut_step_limit *limit) {
  limit->exact = all && self->found.solved;
  limit->largest_frequency = self->found.largest_frequency;
  for (int region = 0; region < STRUT_REGIONS; region++)
    limit->of[region] = limit->exact ? self->found.of[region] : MARGIN * self->found.of[region];
}

/* Signals with a lag and Maxwell branches relax by themselves at these rates, at most [1/s]. */
static double fastest_relaxation(const strut_model *model) {
  const strut_feedback_table *feedback = &model->feedback;
  double rate = 0.0;
  for (int32_t i = 0; i < feedback->lag_count; i++)
    rate = fmax(rate, 1.0 / model->scene->signals[feedback->lagged[i]].lag);
  for (int32_t i = 0; i < feedback->maxwell_count; i++)
    rate = fmax(rate, feedback->maxwell[i].stiffness / feedback->maxwell[i].damping);
  return rate;
}

static void keep_to_relaxation(const strut_model *model, strut_step_limit *limit) {
  double rate = fastest_relaxation(model);
  if (!(rate > 0.0)) return;
  for (strut_region region = 0; region < STRUT_REGIONS; region++)
    limit->of[region] = fmin(limit->of[region], region_limit(region, -rate, 0.0, 0.0, rate));
  limit->limit = limit->of[STRUT_REGION_RK4];
}

/* Without ground's dampers: for methods in which they are implicit, none of which is RK4's kind. */
static strut_status limits(const strut_model *model, const double *positions, const double *rest,
                           strut_closed closed, bool rk4, strut_arena *arena,
                           strut_step_limit *limit) {
  strut_tangent tangent;
  search s = {.tangent = &tangent, .arena = arena, .rk4 = rk4};
  *limit = (strut_step_limit){.limit = HUGE_VAL, .exact = true};
  for (int region = 0; region < STRUT_REGIONS; region++)
    limit->of[region] = limit->of_implicit[region] = HUGE_VAL;
  strut_status status = strut_tangent_assemble(model, positions, rest, closed, arena, &tangent);
  if (!status && tangent.n == 0) keep_to_relaxation(model, limit);
  if (status || tangent.n == 0) return status;
  if ((model->terms & STRUT_TERM_RIGID) &&
      !(tangent.rigid = strut_rigid_standing(model, positions, arena)))
    return STRUT_NO_MEMORY;
  bool all = tangent.n <= STRUT_EXACT_LIMIT; /* few: all motions; many: those that bind */
  if (!begin(&s, model, all ? tangent.n : ROOM)) return STRUT_NO_MEMORY;
  if (!(all ? take_all(&s) : look_around(&s) && improve(&s))) return STRUT_NO_MEMORY;
  tell_found(&s, all, limit);
  limit->limit = limit->of[STRUT_REGION_RK4];
  keep_to_relaxation(model, limit);
  return STRUT_OK;
}

static bool ground_damps(const strut_model *model) {
  bool damped = false;
  for (int32_t i = 0; i < model->contacts.count; i++)
    damped = damped || model->contacts.entry[i].damping > 0.0 ||
             model->contacts.entry[i].dissipation > 0.0;
  return damped;
}

strut_status strut_step_limit_for_method(const strut_model *model, const strut_integrator *method,
                                         double *limit, strut_error *error) {
  strut_arena arena = {0};
  strut_step_limit found;
  *limit = HUGE_VAL;
  if (strut_region_at(method->region)->sets == 0) return STRUT_OK;
  bool undamped = method->implicit_damper && ground_damps(model);
  strut_status status = limits(model, model->start, model->members.rest,
                               undamped ? STRUT_CLOSED_UNDAMPED : STRUT_CLOSED_ALL,
                               strut_region_at(method->region)->by_eigenvalue, &arena, &found);
  *limit = found.of[method->region];
  strut_arena_free(&arena);
  return status ? strut_no_memory(error, "for the model") : STRUT_OK;
}

strut_status strut_step_limit_estimate(const strut_model *model, strut_step_limit *limit,
                                       strut_error *error) {
  strut_arena arena = {0};
  strut_step_limit implicit;
  strut_status status =
      limits(model, model->start, model->members.rest, STRUT_CLOSED_ALL, true, &arena, limit);
  implicit = *limit;
  strut_arena_free(&arena);
  if (!status && ground_damps(model))
    status = limits(model, model->start, model->members.rest, STRUT_CLOSED_UNDAMPED, false, &arena,
                    &implicit);
  for (int region = 0; region < STRUT_REGIONS; region++)
    limit->of_implicit[region] = implicit.of[region];
  strut_arena_free(&arena);
  return status ? strut_no_memory(error, "for the model") : STRUT_OK;
}

strut_status strut_step_limit_at_shape(const strut_model *model, const double *positions,
                                       const double *rest, strut_closed closed,
                                       strut_step_limit *limit, strut_error *error) {
  strut_arena arena = {0};
  strut_status status = limits(model, positions, rest, closed, true, &arena, limit);
  for (int region = 0; region < STRUT_REGIONS; region++)
    limit->of_implicit[region] = limit->of[region];
  strut_arena_free(&arena);
  return status ? strut_no_memory(error, "for the model") : STRUT_OK;
}

double strut_step_limit_of_method(const strut_step_limit *limit, const strut_integrator *method) {
  return method->implicit_damper ? limit->of_implicit[method->region] : limit->of[method->region];
}

/* ---- effort of error control ---- */

strut_status strut_step_limit_check_effort(const strut_model *model, const strut_integrator *method,
                                           double dt, strut_error *error) {
  const double most = 1e9;
  strut_step_limit limit;
  if (!strut_integrator_controls_error(method) ||
      strut_model_fastest_spring(model) * dt < 0.1 * most)
    return STRUT_OK;
  strut_status status = strut_step_limit_estimate(model, &limit, error);
  if (status || dt <= most * limit.limit) return status;
  return strut_fail(error, STRUT_STEP_TOO_LARGE,
                    "%s would take more than %g steps in each step of %g s: the fastest vibration "
                    "allows %.3g s; make what is stiffest softer or rigid, or what is lightest "
                    "heavier, or use --force to run anyway",
                    method->name, most, dt, limit.limit);
}

static void count_elements(const strut_model *model, strut_cost_estimate *estimate) {
  const strut_scene *scene = model->scene;
  estimate->count.nodes = scene->node_count;
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    estimate->count.degrees_of_freedom += !model->fixed[i];
  for (size_t j = 0; j < scene->member_count; j++) {
    estimate->count.bars += scene->members[j].kind == STRUT_BAR;
    estimate->count.springs += scene->members[j].kind == STRUT_SPRING;
    estimate->count.cables += scene->members[j].kind == STRUT_CABLE;
  }
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *member = &scene->members[j];
    estimate->count.running_cables += member->guide_count > 0;
    estimate->count.laws +=
        member->law.kind != STRUT_LAW_LINEAR || member->law.carries == STRUT_CARRIES_COMPRESSION;
    estimate->count.stops += (size_t)(member->shortest > 0.0) + (size_t)(member->longest > 0.0);
  }
  estimate->count.hinges = scene->hinge_count;
  estimate->count.cells = scene->cell_count;
  estimate->count.collisions = scene->collision_count;
  estimate->count.contacts = (size_t)model->contacts.count;
  estimate->count.actuators = scene->actuator_count;
  estimate->count.loads = scene->load_count;
  estimate->bytes = model->arena.bytes + sizeof *model;
}

strut_status strut_cost_estimate_describe(const strut_model *model, strut_cost_estimate *estimate,
                                          strut_error *error) {
  *estimate = (strut_cost_estimate){0};
  count_elements(model, estimate);
  if (!model->mass) return STRUT_OK;
  estimate->runnable = true;
  estimate->feedback = strut_scene_has_feedback(model->scene);
  estimate->matrix.mass_nonzeros = model->mass->matrix_nonzeros;
  estimate->matrix.factor_nonzeros = model->mass->factor_nonzeros;
  estimate->matrix.dense_entries = model->mass->dense_entries;
  strut_step_limit limit;
  strut_status status = strut_step_limit_estimate(model, &limit, error);
  estimate->largest_frequency = limit.largest_frequency;
  estimate->step_limit = limit.limit;
  estimate->limits = limit;
  estimate->step_limit_exact = limit.exact;
  return status;
}
