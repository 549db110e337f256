/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/statics/search/critical.h"

#include "engine/base/vec.h"
#include "engine/model/pose.h"
#include "engine/statics/algebra.h"

enum { MOST_STEPS = 150, MOST_BENDS = 4 };

struct strut_climber {
  const strut_potential *potential;
  strut_minimiser *minimiser; /* which polishes what a climb ends on */
  strut_spectrum_workspace *spectra;
  strut_sparse *hessian;
  strut_spectrum now;
  double size;
  int64_t hessian_count;
  double *g, *part, *value, *x; /* (n) */
  double *step, *follow;        /* (n) */
  double *straight, *g_trial;   /* (n) the step before it was bent, and the gradient at its end */
  uint8_t *idle;                /* (n) */
  double *trial, *begin;        /* (length) */
};

strut_climber *strut_climber_create(const strut_potential *potential, strut_minimiser *minimiser,
                                    strut_arena *arena) {
  strut_climber *climber = strut_arena_allocate(arena, 1, sizeof *climber);
  size_t n = (size_t)potential->n;
  if (!climber || !STRUT_ALLOCATE(arena, STRUT_NEW(climber->idle, n)) ||
      !STRUT_NUMBERS(arena, n, &climber->g, &climber->part, &climber->value, &climber->x,
                     &climber->step, &climber->follow, &climber->straight, &climber->g_trial) ||
      !STRUT_NUMBERS(arena, potential->model->length, &climber->trial, &climber->begin))
    return NULL;
  climber->potential = potential;
  climber->minimiser = minimiser;
  climber->size = potential->model->size > 0 ? potential->model->size : 1.0;
  climber->spectra = strut_spectrum_create(potential, arena);
  climber->hessian = strut_potential_matrix(potential, arena);
  return climber->spectra && climber->hessian ? climber : NULL;
}

int64_t strut_climber_hessian_count(const strut_climber *climber) { return climber->hessian_count; }

/* Shares of the gradient, and which modes have neither stiffness nor force. */
static void split_gradient(strut_climber *climber, double still) {
  strut_spectrum_split(&climber->now, climber->g, still, climber->part, climber->idle);
  memcpy(climber->value, climber->now.value, (size_t)climber->now.n * sizeof *climber->value);
}

/* The mode that leans most on the direction followed so far becomes that direction. */
static int32_t find_followed_mode(strut_climber *climber) {
  int32_t n = climber->now.n, best = -1;
  double largest = 0.0;
  for (int32_t i = 0; i < n; i++) {
    double lean = climber->idle[i]
                      ? 0.0
                      : strut_dot(climber->now.vector + (size_t)i * (size_t)n, climber->follow, n);
    if (fabs(lean) > fabs(largest)) largest = lean, best = i;
  }
  for (int32_t i = 0; best >= 0 && i < n; i++)
    climber->follow[i] =
        (largest < 0 ? -1.0 : 1.0) * climber->now.vector[(size_t)best * (size_t)n + (size_t)i];
  return best;
}

/* Negates the quadratic along the followed modes; false if there are too few. */
static bool build_image_function(strut_climber *climber, int32_t index, bool following) {
  if (following) {
    int32_t mode = find_followed_mode(climber);
    if (mode < 0) return false;
    climber->value[mode] = -climber->value[mode], climber->part[mode] = -climber->part[mode];
    return true;
  }
  int32_t left = index;
  for (int32_t i = 0; i < climber->now.n && left > 0; i++) {
    if (climber->idle[i]) continue;
    climber->value[i] = -climber->value[i], climber->part[i] = -climber->part[i];
    left--;
  }
  return left == 0;
}

/* The step from its shares, and the energy that the true quadratic changes by. */
static double assemble_step(strut_climber *climber, double *length) {
  int32_t n = climber->now.n;
  double change = 0.0;
  *length = strut_spectrum_combine(&climber->now, climber->x, climber->step);
  for (int32_t i = 0; i < n; i++) {
    const double *mode = climber->now.vector + (size_t)i * (size_t)n;
    if (climber->x[i] == 0.0) continue;
    change += climber->x[i] *
              (strut_dot(mode, climber->g, n) + 0.5 * climber->now.value[i] * climber->x[i]);
  }
  return change;
}

static bool decompose_hessian(strut_climber *climber, const double *positions, bool careful) {
  climber->hessian_count++;
  strut_potential_hessian(climber->potential, positions, climber->hessian);
  return strut_spectrum_compute(climber->spectra, climber->hessian, positions, 0.0, careful,
                                &climber->now);
}

static void set_trial(strut_climber *climber, const double *positions) {
  strut_potential_move(climber->potential, climber->step, 1.0, positions, climber->trial);
}

/*
 * Corrects the step in the stiff modes, as a descent does: turning stiff bars stretch to second
 * order, and without the correction a climb beside them stalls. Stops when the energy `there` no
 * longer falls.
 */
static double bend_step(strut_climber *climber, const double *positions, double mu, double scale,
                        double there, double wanted) {
  size_t bytes = (size_t)climber->now.n * sizeof *climber->step;
  for (int i = 0; i < MOST_BENDS && !(there < wanted); i++) {
    memcpy(climber->straight, climber->step, bytes);
    strut_potential_gradient(climber->potential, climber->trial, climber->g_trial);
    /* modes much stiffer than mu, except followed ones */
    if (!strut_spectrum_rebalance(&climber->now, climber->value, mu > 0 ? 10.0 * mu : 1e-3 * scale,
                                  climber->g_trial, climber->step))
      break;
    set_trial(climber, positions);
    double lower = strut_potential_value_near(climber->potential, climber->trial, positions);
    if (lower < there) {
      there = lower;
      continue;
    }
    memcpy(climber->step, climber->straight, bytes);
    set_trial(climber, positions);
    break;
  }
  return there;
}

/* One step of the climb; the radius follows how true the quadratic was. */
static bool climb_once(strut_climber *climber, double *positions, double *radius) {
  const strut_potential *potential = climber->potential;
  strut_quadratic image = {climber->now.n,
                           climber->value,
                           climber->part,
                           climber->idle,
                           0.0,
                           4.0 * climber->now.noise[0]};
  for (int32_t i = 0; i < climber->now.n; i++)
    image.scale = fmax(image.scale, fabs(climber->value[i]));
  double here = strut_potential_value(potential, positions);
  for (int tries = 0; tries < 30; tries++) {
    double length, ratio = 1.0;
    double mu = strut_trust_step(&image, *radius, climber->x);
    double change = assemble_step(climber, &length);
    if (!(length > 0)) return false;
    set_trial(climber, positions);
    double there = strut_potential_value_near(potential, climber->trial, positions);
    there =
        bend_step(climber, positions, mu, image.scale, there, here + change + 0.3 * fabs(change));
    if (fabs(change) > 1e-9 * (fabs(here) + fabs(there))) ratio = (there - here) / change;
    bool good = ratio > 0.0 && ratio < 2.0;
    if (good && fabs(ratio - 1.0) < 0.3 && length > 0.99 * *radius)
      *radius = fmin(1.6 * *radius, 0.2 * climber->size);
    if (fabs(ratio - 1.0) > 0.7) *radius = 0.4 * length;
    if (good || length < 1e-4 * climber->size) {
      memcpy(positions, climber->trial, (size_t)potential->model->length * sizeof *positions);
      return true;
    }
  }
  return false;
}

static double evaluate_gradient(strut_climber *climber, const double *positions) {
  strut_potential_gradient(climber->potential, positions, climber->g);
  return strut_largest_magnitude(climber->g, climber->potential->n);
}

/* A member with a rest length that has shrunk to a point pushes nowhere: no gradient is defined. */
static bool has_collapsed(const strut_climber *climber, const double *positions) {
  const strut_model *model = climber->potential->model;
  strut_force force;
  for (int32_t i = 0; i < strut_force_count(model, false); i++) {
    strut_force_begin(model, i, &force);
    if (strut_force_has_collapsed(model, 1e-7, positions, &force)) return true;
  }
  return strut_shape_has_collapsed(model, positions);
}

/* True if the climb has no end: bars that only stretch, bodies that only rise. */
static bool has_escaped(const strut_climber *climber, const double *positions) {
  const strut_potential *potential = climber->potential;
  for (int32_t i = 0; i < potential->n; i++)
    if (!(fabs(positions[potential->coordinate[i]] - climber->begin[potential->coordinate[i]]) <
          3.0 * climber->size))
      return true;
  return false;
}

bool strut_climb(strut_climber *climber, int32_t index, const double *direction,
                 double *positions) {
  assert(index >= 1 && index <= climber->potential->n);
  const strut_potential *potential = climber->potential;
  double radius = 0.03 * climber->size, root = sqrt((double)potential->n);
  memcpy(climber->begin, positions, (size_t)potential->model->length * sizeof *positions);
  if (direction) memcpy(climber->follow, direction, (size_t)potential->n * sizeof *direction);
  for (int i = 0; i < MOST_STEPS; i++) {
    double residual = evaluate_gradient(climber, positions),
           allowed = 8.0 * strut_potential_rounding(potential, positions);
    if (residual <= allowed)
      return strut_polish(climber->minimiser, positions).end == STRUT_DESCENT_REACHED &&
             !has_collapsed(climber, positions);
    if (!decompose_hessian(climber, positions, false)) return false;
    split_gradient(climber, root * allowed);
    if (has_escaped(climber, positions) ||
        !build_image_function(climber, index, direction != NULL) ||
        !climb_once(climber, positions, &radius))
      return false;
  }
  return false;
}

bool strut_climb_away(strut_climber *climber, int32_t mode, double far, double *positions,
                      double *direction) {
  int32_t n = climber->potential->n, left = mode;
  evaluate_gradient(climber, positions);
  if (!decompose_hessian(climber, positions, true)) return false;
  split_gradient(climber, HUGE_VAL);
  for (int32_t i = 0; i < n; i++) {
    if (climber->idle[i] || left-- > 0) continue;
    for (int32_t k = 0; k < n; k++)
      direction[k] =
          (far < 0 ? -1.0 : 1.0) * climber->now.vector[(size_t)i * (size_t)n + (size_t)k];
    for (int32_t k = 0; k < n; k++) climber->step[k] = fabs(far) * direction[k];
    set_trial(climber, positions);
    memcpy(positions, climber->trial,
           (size_t)climber->potential->model->length * sizeof *positions);
    return true;
  }
  return false;
}
