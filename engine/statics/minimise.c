/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The trust-region loop: step length, acceptance, and termination. */
#include "engine/statics/minimise.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/model/algebra/linear_solver.h"
#include "engine/statics/algebra.h"

enum { MOST_STEPS = 400, MOST_POLISH = 30, MOST_EXTRA = 25, MOST_BENDS = 4 };

struct strut_minimiser {
  const strut_potential *potential;
  strut_curvature *curvature;
  int64_t hessian_count;
  double size;                /* of the structure [m] */
  double longest_step;        /* bound of all steps [m] */
  double first_step;          /* bound of the first step [m] */
  bool short_steps;           /* they began short, and may grow fast where the quadratic is exact */
  double *g, *g_trial, *step; /* (n) */
  double *unbent;             /* (n) the step before its correction */
  double *trial, *before;     /* (length) */
  bool stays;                 /* on a ridge, too */
  const strut_flag *interrupt;
  void (*visit)(void *context, const double *q); /* or NULL */
  void *visitor;
};

strut_status strut_minimiser_create(const strut_potential *potential, strut_arena *arena,
                                    strut_minimiser **minimiser, strut_error *error) {
  strut_minimiser *m = *minimiser = strut_arena_allocate(arena, 1, sizeof *m);
  if (!m || !STRUT_NUMBERS(arena, potential->n, &m->g, &m->g_trial, &m->step, &m->unbent) ||
      !STRUT_NUMBERS(arena, potential->model->length, &m->trial, &m->before))
    return strut_no_memory(error, "");
  m->potential = potential;
  m->size = potential->model->size > 0 ? potential->model->size : 1.0;
  m->longest_step = HUGE_VAL;
  m->first_step = 0.1 * m->size;
  return strut_curvature_create(potential, arena, &m->curvature, error);
}

int64_t strut_minimiser_hessian_count(const strut_minimiser *minimiser) {
  return minimiser->hessian_count;
}

static bool decompose_hessian(strut_minimiser *minimiser, const double *q) {
  minimiser->hessian_count++;
  return strut_curvature_decompose(minimiser->curvature, q);
}

/* trial = q + factor * step. */
static void set_trial(strut_minimiser *minimiser, const double *q, double factor) {
  strut_potential_move(minimiser->potential, minimiser->step, factor, q, minimiser->trial);
}

static void keep_trial(strut_minimiser *minimiser, double *q) {
  memcpy(q, minimiser->trial, (size_t)minimiser->potential->model->length * sizeof *q);
  double *swap = minimiser->g;
  minimiser->g = minimiser->g_trial, minimiser->g_trial = swap;
}

/* The largest coordinate, in sizes of the structure: beyond some thousands nothing comes back. */
static bool ran_away(const strut_minimiser *minimiser, const double *q, const double *start) {
  double largest = 0.0;
  for (int32_t i = 0; i < minimiser->potential->n; i++) {
    int32_t at = minimiser->potential->coordinate[i];
    largest = fmax(largest, fabs(q[at] - start[at]));
  }
  return !(largest <= 1e4 * minimiser->size);
}

static double residual_allowed(const strut_minimiser *minimiser, const double *q,
                               double *rounding) {
  *rounding = strut_potential_rounding(minimiser->potential, q);
  return 8.0 * *rounding;
}

/*
 * Newton steps from a q whose gradient is small, as long as they become shorter: the residual may
 * be all rounding long before soft directions have converged. Ends with the last residual.
 */
static void polish_point(strut_minimiser *minimiser, double *q, double reach, strut_descent *end) {
  int32_t n = minimiser->potential->n;
  double earlier = HUGE_VAL;
  for (int i = 0; i < MOST_POLISH; i++) {
    double length =
        decompose_hessian(minimiser, q)
            ? strut_curvature_newton_step(minimiser->curvature, minimiser->g, minimiser->step)
            : HUGE_VAL;
    if (!(length < 0.9 * earlier) || length > reach) break;
    set_trial(minimiser, q, 1.0);
    strut_potential_gradient(minimiser->potential, minimiser->trial, minimiser->g_trial);
    double residual = strut_largest_magnitude(minimiser->g_trial, n);
    double allowed = residual_allowed(minimiser, minimiser->trial, &end->rounding);
    if (!(residual <= fmax(allowed, end->residual))) break;
    keep_trial(minimiser, q);
    end->residual = residual;
    end->step = earlier = length;
    end->iterations++;
    if (length <= 4.0 * DBL_EPSILON * minimiser->size) break;
  }
}

/* Leaves a stationary point that is no minimum along the unstable direction, on its lower side. */
static bool leave_ridge(strut_minimiser *minimiser, double *q, double radius) {
  double here = strut_potential_value(minimiser->potential, q);
  if (!strut_curvature_unstable_direction(minimiser->curvature, minimiser->step)) return false;
  for (double far = radius; far > 1e-6 * minimiser->size; far *= 0.25) {
    set_trial(minimiser, q, far);
    double up = strut_potential_value_near(minimiser->potential, minimiser->trial, q);
    set_trial(minimiser, q, -far);
    double down = strut_potential_value_near(minimiser->potential, minimiser->trial, q);
    if (!(up < here) && !(down < here)) continue;
    if (!(down < up)) set_trial(minimiser, q, far);
    strut_potential_gradient(minimiser->potential, minimiser->trial, minimiser->g_trial);
    keep_trial(minimiser, q);
    return true;
  }
  return false;
}

/* Moves a free end of a straight member aside; false if both are held. */
static bool move_end(const strut_potential *potential, uint32_t from, uint32_t to, double far,
                     double *q) {
  bool free = potential->row_of[to] >= 0 || potential->row_of[to + 1] >= 0;
  uint32_t end = free ? to : from;
  bool any = false;
  if (potential->row_of[end] >= 0) q[end] += far, any = true;
  if (potential->row_of[end + 1] >= 0) q[end + 1] += 0.7 * far, any = true;
  return any;
}

/*
 * A member that has shrunk to a point pushes its ends apart, but its gradient is undefined: moves
 * its free end aside. False if there is no such member.
 */
static bool leave_collapse(strut_minimiser *minimiser, double *q) {
  const strut_potential *potential = minimiser->potential;
  strut_force force;
  bool any = false;
  for (int32_t i = 0; i < strut_force_count(potential->model, false); i++) {
    strut_force_begin(potential->model, i, &force);
    if (strut_force_has_collapsed(potential->model, 1e-8, q, &force) &&
        move_end(potential, force.at[0], force.at[1], 1e-3 * minimiser->size, q))
      any = true;
  }
  if (any) strut_potential_gradient(potential, q, minimiser->g);
  return any;
}

/*
 * The energy lost from q to the trial. Where it drowns in the rounding of the energies themselves,
 * it is the work of the mean of both gradients.
 */
static double energy_lost(const strut_minimiser *minimiser, double here, double there,
                          double expected) {
  if (expected > 1e-9 * (fabs(here) + fabs(there))) return here - there;
  double work = 0.0;
  for (int32_t i = 0; i < minimiser->potential->n; i++)
    work -= 0.5 * (minimiser->g[i] + minimiser->g_trial[i]) * minimiser->step[i];
  return work;
}

/*
 * The trial and its energy; where the quadratic did not hold, again with the stiff modes brought
 * back into balance, as long as that leads lower. Returns the share of the reduction expected.
 */
static double try_step(strut_minimiser *minimiser, const double *q, double here, double expected,
                       double *there) {
  size_t bytes = (size_t)minimiser->potential->n * sizeof *minimiser->step;
  set_trial(minimiser, q, 1.0);
  *there = strut_potential_value_near(minimiser->potential, minimiser->trial, q);
  strut_potential_gradient(minimiser->potential, minimiser->trial, minimiser->g_trial);
  double ratio = energy_lost(minimiser, here, *there, expected) / expected;
  for (int i = 0; i < MOST_BENDS && !(ratio > 0.75); i++) {
    memcpy(minimiser->unbent, minimiser->step, bytes);
    if (!strut_curvature_rebalance(minimiser->curvature, minimiser->g_trial, minimiser->step))
      break;
    set_trial(minimiser, q, 1.0);
    double lower = strut_potential_value_near(minimiser->potential, minimiser->trial, q);
    bool better = lower < *there;
    if (better) *there = lower;
    if (!better) memcpy(minimiser->step, minimiser->unbent, bytes);
    if (!better) set_trial(minimiser, q, 1.0);
    strut_potential_gradient(minimiser->potential, minimiser->trial, minimiser->g_trial);
    if (!better) break;
    ratio = energy_lost(minimiser, here, *there, expected) / expected;
  }
  return ratio;
}

/* Growth factor of the next step. Short steps grow while the quadratic model holds. */
static double radius_growth(const strut_minimiser *minimiser, double ratio) {
  if (!minimiser->short_steps) return 2.5;
  return fabs(ratio - 1.0) < 0.01 ? 10.0 : fabs(ratio - 1.0) < 0.25 ? 2.5 : 1.0;
}

/* One trust-region step; false where the radius has shrunk to nothing. */
static bool descend_once(strut_minimiser *minimiser, double *q, double still, double *radius,
                         double *energy) {
  strut_model_step step = strut_curvature_trust_step(minimiser->curvature, minimiser->g, *radius,
                                                     still, minimiser->step);
  if (!(step.length > 0)) return false;
  for (int tries = 0; tries < 60; tries++) {
    double there, ratio = try_step(minimiser, q, *energy, step.reduction, &there);
    /* far more than expected: it may have left the valley it was in */
    bool astray = minimiser->short_steps && ratio > 1.75 && step.length > 1e-6 * minimiser->size;
    if (ratio > 1e-4 && !astray) {
      if (ratio > 0.75 && step.length > 0.99 * *radius)
        *radius = fmin(radius_growth(minimiser, ratio) * *radius, minimiser->longest_step);
      if (ratio < 0.25) *radius = 0.5 * step.length;
      keep_trial(minimiser, q);
      bool couples = minimiser->potential->model->elements.couples > 0;
      *energy = couples ? strut_potential_value(minimiser->potential, q) : there;
      return true;
    }
    *radius = (ratio > -1.0 ? 0.25 : 0.1) * step.length;
    if (!(*radius > DBL_EPSILON * minimiser->size)) return false;
    step = strut_curvature_trust_step(minimiser->curvature, minimiser->g, *radius, still,
                                      minimiser->step);
  }
  return false;
}

/*
 * A gradient within rounding ends the descent only if the Newton step is short too: beside very
 * stiff members rounding hides forces that soft members still yield to.
 */
void strut_minimiser_watch(strut_minimiser *minimiser, const strut_flag *interrupt) {
  minimiser->interrupt = interrupt;
}

void strut_minimiser_stay(strut_minimiser *minimiser) { minimiser->stays = true; }

void strut_minimiser_visit(strut_minimiser *minimiser,
                           void (*visit)(void *context, const double *q), void *context) {
  minimiser->visit = visit;
  minimiser->visitor = context;
}

static void visit(const strut_minimiser *minimiser, const double *q) {
  if (minimiser->visit) minimiser->visit(minimiser->visitor, q);
}

strut_descent strut_minimise(strut_minimiser *minimiser, double *q) {
  strut_descent end = {.end = STRUT_DESCENT_EXHAUSTED};
  int32_t n = minimiser->potential->n, extra = 0;
  double radius = fmin(minimiser->first_step, minimiser->longest_step),
         energy = strut_potential_value(minimiser->potential, q);
  memcpy(minimiser->before, q, (size_t)minimiser->potential->model->length * sizeof *q);
  strut_potential_gradient(minimiser->potential, q, minimiser->g);
  for (; end.iterations < MOST_STEPS; end.iterations++) {
    end.residual = strut_largest_magnitude(minimiser->g, n);
    double allowed = residual_allowed(minimiser, q, &end.rounding);
    end.end = STRUT_DESCENT_EXHAUSTED;
    visit(minimiser, q);
    if (ran_away(minimiser, q, minimiser->before)) {
      end.end = STRUT_DESCENT_RUNAWAY;
      return end;
    }
    if (minimiser->interrupt && *minimiser->interrupt) return end;
    if (!decompose_hessian(minimiser, q)) return end;
    if (end.residual <= allowed) {
      if (!minimiser->stays && ((extra < 3 && leave_collapse(minimiser, q) && ++extra) ||
                                leave_ridge(minimiser, q, radius))) {
        energy = strut_potential_value(minimiser->potential, q);
        continue;
      }
      end.end = STRUT_DESCENT_REACHED;
      double left =
          strut_curvature_newton_step(minimiser->curvature, minimiser->g, minimiser->step);
      end.step = left;
      if (left <= 1e-3 * minimiser->size || extra++ == MOST_EXTRA) break;
    }
    if (!descend_once(minimiser, q, sqrt((double)n) * allowed, &radius, &energy)) break;
  }
  if (end.end != STRUT_DESCENT_REACHED) return end;
  polish_point(minimiser, q, 1e-3 * minimiser->size, &end);
  visit(minimiser, q);
  if (end.step > 1e-5 * minimiser->size ||
      strut_shape_has_collapsed(minimiser->potential->model, q))
    end.end = STRUT_DESCENT_EXHAUSTED;
  return end;
}

/*
 * Returns the distance from the saddle at which the force along the step exceeds rounding. A well
 * about to vanish may lie that close to its saddle.
 */
static double leave_saddle(strut_minimiser *minimiser, const double *q, double side) {
  const strut_potential *potential = minimiser->potential;
  double far = 1e-7 * minimiser->size, enough = 100.0 * strut_potential_rounding(potential, q);
  for (; far < 0.02 * minimiser->size; far *= 4.0) {
    double down = 0.0;
    set_trial(minimiser, q, side * far);
    strut_potential_gradient(potential, minimiser->trial, minimiser->g_trial);
    for (int32_t i = 0; i < potential->n; i++)
      down -= side * minimiser->step[i] * minimiser->g_trial[i];
    if (down > enough) break;
  }
  set_trial(minimiser, q, side * far);
  return far;
}

/* Down by steps that begin no longer than `first_step` and stay in the valley they are in. */
static strut_descent_end descend_shortly(strut_minimiser *minimiser, double first_step, double *q) {
  double usual = minimiser->first_step;
  minimiser->first_step = first_step, minimiser->longest_step = 0.03 * minimiser->size,
  minimiser->short_steps = true;
  strut_descent end = strut_minimise(minimiser, q);
  minimiser->first_step = usual, minimiser->longest_step = HUGE_VAL, minimiser->short_steps = false;
  return end.end;
}

strut_descent_end strut_descend_gently(strut_minimiser *minimiser, double *q) {
  return descend_shortly(minimiser, 0.005 * minimiser->size, q);
}

bool strut_descend_along(strut_minimiser *minimiser, const double *direction, double side,
                         double *q) {
  const strut_potential *potential = minimiser->potential;
  for (int32_t i = 0; i < potential->n; i++)
    minimiser->step[i] = direction[potential->coordinate[i]];
  double first_step = leave_saddle(minimiser, q, side);
  memcpy(q, minimiser->trial, (size_t)potential->model->length * sizeof *q);
  return descend_shortly(minimiser, first_step, q) == STRUT_DESCENT_REACHED;
}

strut_descent strut_polish(strut_minimiser *minimiser, double *q) {
  strut_descent end = {.end = STRUT_DESCENT_EXHAUSTED};
  strut_potential_gradient(minimiser->potential, q, minimiser->g);
  end.residual = strut_largest_magnitude(minimiser->g, minimiser->potential->n);
  polish_point(minimiser, q, 0.1 * minimiser->size, &end);
  end.residual = strut_largest_magnitude(minimiser->g, minimiser->potential->n);
  if (end.residual <= residual_allowed(minimiser, q, &end.rounding))
    end.end = STRUT_DESCENT_REACHED;
  return end;
}
