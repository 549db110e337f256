/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/search/critical.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/model/pose.h"
#include "engine/statics/algebra.h"
#include "engine/statics/curvature.h"

enum { MOST_STEPS = 150, MOST_POLISH = 12, MOST_BENDS = 4 };

struct strut_climber {
  const strut_potential *potential;
  strut_spectrum_workspace *spectra;
  strut_spectrum now;
  double size;
  int64_t hessian_count;
  double *g, *part, *value, *x; /* (n) */
  double *step, *follow;        /* (n) */
  double *straight, *g_trial;   /* (n) the step before it was bent, and the gradient at its end */
  uint8_t *idle;                /* (n) */
  double *trial, *begin;        /* (length) */
  strut_arena arena;
};

strut_climber *strut_climber_create(const strut_potential *p) {
  strut_climber *c = strut_allocate(1, sizeof *c);
  size_t n = (size_t)p->n;
  if (!c) return NULL;
  c->potential = p;
  c->size = p->model->size > 0 ? p->model->size : 1.0;
  c->spectra = strut_spectrum_create(p);
  double **line[] = {&c->g,    &c->part,   &c->value,    &c->x,
                     &c->step, &c->follow, &c->straight, &c->g_trial};
  bool good = c->spectra != NULL;
  for (size_t i = 0; i < sizeof line / sizeof line[0]; i++)
    good = good && (*line[i] = strut_arena_allocate(&c->arena, n, sizeof(double)));
  c->idle = strut_arena_allocate(&c->arena, n, sizeof *c->idle);
  c->trial = strut_arena_allocate(&c->arena, (size_t)p->model->length, sizeof *c->trial);
  c->begin = strut_arena_allocate(&c->arena, (size_t)p->model->length, sizeof *c->begin);
  if (good && c->idle && c->trial && c->begin) return c;
  strut_climber_free(c);
  return NULL;
}

void strut_climber_free(strut_climber *c) {
  if (!c) return;
  strut_spectrum_free(c->spectra);
  strut_arena_free(&c->arena);
  strut_release(c);
}

int64_t strut_climber_hessian_count(const strut_climber *c) { return c->hessian_count; }

/* Shares of the gradient, and which modes have neither stiffness nor force. */
static void split_gradient(strut_climber *c, double still) {
  strut_spectrum_split(&c->now, c->g, still, c->part, c->idle);
  memcpy(c->value, c->now.value, (size_t)c->now.n * sizeof *c->value);
}

/* The mode that leans most on the direction followed so far becomes that direction. */
static int32_t find_followed_mode(strut_climber *c) {
  int32_t n = c->now.n, best = -1;
  double largest = 0.0;
  for (int32_t i = 0; i < n; i++) {
    double lean = c->idle[i] ? 0.0 : strut_dot(c->now.vector + (size_t)i * (size_t)n, c->follow, n);
    if (fabs(lean) > fabs(largest)) largest = lean, best = i;
  }
  for (int32_t i = 0; best >= 0 && i < n; i++)
    c->follow[i] = (largest < 0 ? -1.0 : 1.0) * c->now.vector[(size_t)best * (size_t)n + (size_t)i];
  return best;
}

/* Negates the quadratic along the followed modes; false if there are too few. */
static bool build_image_function(strut_climber *c, int32_t index, bool following) {
  if (following) {
    int32_t mode = find_followed_mode(c);
    if (mode < 0) return false;
    c->value[mode] = -c->value[mode], c->part[mode] = -c->part[mode];
    return true;
  }
  int32_t left = index;
  for (int32_t i = 0; i < c->now.n && left > 0; i++) {
    if (c->idle[i]) continue;
    c->value[i] = -c->value[i], c->part[i] = -c->part[i];
    left--;
  }
  return left == 0;
}

/* The step from its shares, and the energy that the true quadratic changes by. */
static double assemble_step(strut_climber *c, double *length) {
  int32_t n = c->now.n;
  double change = 0.0;
  *length = strut_spectrum_combine(&c->now, c->x, c->step);
  for (int32_t i = 0; i < n; i++) {
    const double *mode = c->now.vector + (size_t)i * (size_t)n;
    if (c->x[i] == 0.0) continue;
    change += c->x[i] * (strut_dot(mode, c->g, n) + 0.5 * c->now.value[i] * c->x[i]);
  }
  return change;
}

static bool decompose_hessian(strut_climber *c, const double *q, bool careful) {
  c->hessian_count++;
  return strut_spectrum_compute(c->spectra, q, 0.0, careful, &c->now);
}

static void set_trial(strut_climber *c, const double *q) {
  strut_potential_move(c->potential, c->step, 1.0, q, c->trial);
}

/* Balances modes much stiffer than mu, except followed ones, at the step's end. */
static bool rebalance_stiff_modes(strut_climber *c, double mu, double scale) {
  double stiff = mu > 0 ? 10.0 * mu : 1e-3 * scale;
  strut_potential_gradient(c->potential, c->trial, c->g_trial);
  return strut_spectrum_rebalance(&c->now, c->value, stiff, c->g_trial, c->step);
}

/*
 * Corrects the step in the stiff modes, as a descent does: turning stiff bars stretch to second
 * order, and without the correction a climb beside them stalls. Stops when the energy `there` no
 * longer falls.
 */
static double bend_step(strut_climber *c, const double *q, double mu, double scale, double there,
                        double wanted) {
  size_t bytes = (size_t)c->now.n * sizeof *c->step;
  for (int i = 0; i < MOST_BENDS && !(there < wanted); i++) {
    memcpy(c->straight, c->step, bytes);
    if (!rebalance_stiff_modes(c, mu, scale)) break;
    set_trial(c, q);
    double lower = strut_potential_value_near(c->potential, c->trial, q);
    if (lower < there) {
      there = lower;
      continue;
    }
    memcpy(c->step, c->straight, bytes);
    set_trial(c, q);
    break;
  }
  return there;
}

/* One step of the climb; the radius follows how true the quadratic was. */
static bool climb_once(strut_climber *c, double *q, double *radius) {
  const strut_potential *p = c->potential;
  strut_quadratic image = {c->now.n, c->value, c->part, c->idle, 0.0, 4.0 * c->now.noise[0]};
  for (int32_t i = 0; i < c->now.n; i++) image.scale = fmax(image.scale, fabs(c->value[i]));
  double here = strut_potential_value(p, q);
  for (int tries = 0; tries < 30; tries++) {
    double length, ratio = 1.0;
    double mu = strut_trust_step(&image, *radius, c->x);
    double change = assemble_step(c, &length);
    if (!(length > 0)) return false;
    set_trial(c, q);
    double there = strut_potential_value_near(p, c->trial, q);
    there = bend_step(c, q, mu, image.scale, there, here + change + 0.3 * fabs(change));
    if (fabs(change) > 1e-9 * (fabs(here) + fabs(there))) ratio = (there - here) / change;
    bool good = ratio > 0.0 && ratio < 2.0;
    if (good && fabs(ratio - 1.0) < 0.3 && length > 0.99 * *radius)
      *radius = fmin(1.6 * *radius, 0.2 * c->size);
    if (fabs(ratio - 1.0) > 0.7) *radius = 0.4 * length;
    if (good || length < 1e-4 * c->size) {
      memcpy(q, c->trial, (size_t)p->model->length * sizeof *q);
      return true;
    }
  }
  return false;
}

static double evaluate_gradient(strut_climber *c, const double *q) {
  strut_potential_gradient(c->potential, q, c->g);
  return strut_largest_magnitude(c->g, c->potential->n);
}

/* Newton steps as long as they become shorter. */
static void polish_saddle(strut_climber *c, double *q) {
  double earlier = HUGE_VAL, length;
  for (int i = 0; i < MOST_POLISH; i++) {
    evaluate_gradient(c, q);
    if (!decompose_hessian(c, q, false)) return;
    split_gradient(c, HUGE_VAL);
    for (int32_t k = 0; k < c->now.n; k++) c->x[k] = c->idle[k] ? 0.0 : -c->part[k] / c->value[k];
    assemble_step(c, &length);
    if (!(length < 0.9 * earlier) || length > 1e-3 * c->size) return;
    set_trial(c, q);
    memcpy(q, c->trial, (size_t)c->potential->model->length * sizeof *q);
    if (length <= 4.0 * DBL_EPSILON * c->size) return;
    earlier = length;
  }
}

/* A member with a rest length that has shrunk to a point pushes nowhere: no gradient is defined. */
static bool has_collapsed(const strut_climber *c, const double *q) {
  const strut_model *model = c->potential->model;
  strut_force force;
  for (int32_t i = 0; i < strut_force_count(model, false); i++) {
    strut_force_begin(model, i, &force);
    if (strut_force_has_collapsed(model, 1e-7, q, &force)) return true;
  }
  return strut_shape_has_collapsed(model, q);
}

/* True if the climb has no end: bars that only stretch, bodies that only rise. */
static bool has_escaped(const strut_climber *c, const double *q) {
  const strut_potential *p = c->potential;
  for (int32_t i = 0; i < p->n; i++)
    if (!(fabs(q[p->coordinate[i]] - c->begin[p->coordinate[i]]) < 3.0 * c->size)) return true;
  return false;
}

bool strut_climb(strut_climber *c, int32_t index, const double *direction, double *q) {
  assert(index >= 1 && index <= c->potential->n);
  const strut_potential *p = c->potential;
  double radius = 0.03 * c->size, root = sqrt((double)p->n);
  memcpy(c->begin, q, (size_t)p->model->length * sizeof *q);
  if (direction) memcpy(c->follow, direction, (size_t)p->n * sizeof *direction);
  for (int i = 0; i < MOST_STEPS; i++) {
    double residual = evaluate_gradient(c, q), allowed = 8.0 * strut_potential_rounding(p, q);
    if (residual <= allowed) {
      polish_saddle(c, q);
      return evaluate_gradient(c, q) <= 8.0 * strut_potential_rounding(p, q) &&
             !has_collapsed(c, q);
    }
    if (!decompose_hessian(c, q, false)) return false;
    split_gradient(c, root * allowed);
    if (has_escaped(c, q) || !build_image_function(c, index, direction != NULL) ||
        !climb_once(c, q, &radius))
      return false;
  }
  return false;
}

bool strut_climb_away(strut_climber *c, int32_t mode, double far, double *q, double *direction) {
  int32_t n = c->potential->n, left = mode;
  evaluate_gradient(c, q);
  if (!decompose_hessian(c, q, true)) return false;
  split_gradient(c, HUGE_VAL);
  for (int32_t i = 0; i < n; i++) {
    if (c->idle[i] || left-- > 0) continue;
    for (int32_t k = 0; k < n; k++)
      direction[k] = (far < 0 ? -1.0 : 1.0) * c->now.vector[(size_t)i * (size_t)n + (size_t)k];
    for (int32_t k = 0; k < n; k++) c->step[k] = fabs(far) * direction[k];
    set_trial(c, q);
    memcpy(q, c->trial, (size_t)c->potential->model->length * sizeof *q);
    return true;
  }
  return false;
}
