/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The trust-region loop: step length, acceptance, and termination. */
#include "engine/statics/minimise.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/model/algebra/linear_solver.h"
#include "engine/statics/curvature.h"

enum { MOST_STEPS = 400, MOST_POLISH = 30, MOST_EXTRA = 25, MOST_BENDS = 4 };

struct strut_minimiser {
  const strut_potential *potential;
  const strut_curvature *curvature;
  void *workspace;
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
  strut_arena arena;
};

strut_status strut_minimiser_create(const strut_potential *potential, strut_minimiser **minimiser,
                                    strut_error *error) {
  strut_minimiser *m = *minimiser = strut_allocate(1, sizeof *m);
  size_t n = (size_t)potential->n, length = (size_t)potential->model->length;
  if (!m) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  bool dense = potential->n <= STRUT_DENSE_STATICS;
  strut_status status = dense ? STRUT_OK : strut_linear_solver_load(error);
  if (status) {
    strut_release(m);
    *minimiser = NULL;
    return status;
  }
  m->potential = potential;
  m->size = potential->model->size > 0 ? potential->model->size : 1.0;
  m->longest_step = HUGE_VAL;
  m->first_step = 0.1 * m->size;
  m->curvature = dense ? &strut_curvature_dense : &strut_curvature_sparse;
  m->workspace =
      dense ? strut_curvature_dense_create(potential) : strut_curvature_sparse_create(potential);
  m->g = strut_arena_allocate(&m->arena, n, sizeof *m->g);
  m->g_trial = strut_arena_allocate(&m->arena, n, sizeof *m->g_trial);
  m->step = strut_arena_allocate(&m->arena, n, sizeof *m->step);
  m->unbent = strut_arena_allocate(&m->arena, n, sizeof *m->unbent);
  m->trial = strut_arena_allocate(&m->arena, length, sizeof *m->trial);
  m->before = strut_arena_allocate(&m->arena, length, sizeof *m->before);
  if (m->workspace && m->g && m->g_trial && m->step && m->unbent && m->trial && m->before)
    return STRUT_OK;
  strut_minimiser_free(m);
  *minimiser = NULL;
  return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
}

void strut_minimiser_free(strut_minimiser *minimiser) {
  if (!minimiser) return;
  if (minimiser->workspace) minimiser->curvature->free(minimiser->workspace);
  strut_arena_free(&minimiser->arena);
  strut_release(minimiser);
}

int64_t strut_minimiser_hessian_count(const strut_minimiser *m) { return m->hessian_count; }

static bool decompose_hessian(strut_minimiser *m, const double *q) {
  m->hessian_count++;
  return m->curvature->decompose(m->workspace, q);
}

/* trial = q + factor * step. */
static void set_trial(strut_minimiser *m, const double *q, double factor) {
  strut_potential_move(m->potential, m->step, factor, q, m->trial);
}

static void keep_trial(strut_minimiser *m, double *q) {
  memcpy(q, m->trial, (size_t)m->potential->model->length * sizeof *q);
  double *swap = m->g;
  m->g = m->g_trial, m->g_trial = swap;
}

/* The largest coordinate, in sizes of the structure: beyond some thousands nothing comes back. */
static bool ran_away(const strut_minimiser *m, const double *q, const double *start) {
  double largest = 0.0;
  for (int32_t i = 0; i < m->potential->n; i++) {
    int32_t at = m->potential->coordinate[i];
    largest = fmax(largest, fabs(q[at] - start[at]));
  }
  return !(largest <= 1e4 * m->size);
}

static double residual_allowed(const strut_minimiser *m, const double *q, double tolerance,
                               double *rounding) {
  *rounding = strut_potential_rounding(m->potential, q);
  return fmax(tolerance, 8.0 * *rounding);
}

/*
 * Newton steps from a q whose gradient is small, as long as they become shorter: the residual may
 * be all rounding long before soft directions have converged. Ends with the last residual.
 */
static void polish_point(strut_minimiser *m, double *q, double tolerance, double reach,
                         strut_descent *end) {
  int32_t n = m->potential->n;
  double earlier = HUGE_VAL;
  for (int i = 0; i < MOST_POLISH; i++) {
    double length =
        decompose_hessian(m, q) ? m->curvature->newton_step(m->workspace, m->g, m->step) : HUGE_VAL;
    if (!(length < 0.9 * earlier) || length > reach) break;
    set_trial(m, q, 1.0);
    strut_potential_gradient(m->potential, m->trial, m->g_trial);
    double residual = strut_largest_magnitude(m->g_trial, n);
    double allowed = residual_allowed(m, m->trial, tolerance, &end->rounding);
    if (!(residual <= fmax(allowed, end->residual))) break;
    keep_trial(m, q);
    end->residual = residual;
    end->step = earlier = length;
    end->iterations++;
    if (length <= 4.0 * DBL_EPSILON * m->size) break;
  }
}

/* Leaves a stationary point that is no minimum along the unstable direction, on its lower side. */
static bool leave_ridge(strut_minimiser *m, double *q, double radius) {
  double here = strut_potential_value(m->potential, q);
  if (!m->curvature->unstable_direction(m->workspace, m->step)) return false;
  for (double far = radius; far > 1e-6 * m->size; far *= 0.25) {
    set_trial(m, q, far);
    double up = strut_potential_value_near(m->potential, m->trial, q);
    set_trial(m, q, -far);
    double down = strut_potential_value_near(m->potential, m->trial, q);
    if (!(up < here) && !(down < here)) continue;
    if (!(down < up)) set_trial(m, q, far);
    strut_potential_gradient(m->potential, m->trial, m->g_trial);
    keep_trial(m, q);
    return true;
  }
  return false;
}

/* Moves a free end of a straight member aside; false if both are held. */
static bool move_end(const strut_potential *p, uint32_t from, uint32_t to, double far, double *q) {
  bool free = p->row_of[to] >= 0 || p->row_of[to + 1] >= 0;
  uint32_t end = free ? to : from;
  bool any = false;
  if (p->row_of[end] >= 0) q[end] += far, any = true;
  if (p->row_of[end + 1] >= 0) q[end + 1] += 0.7 * far, any = true;
  return any;
}

/*
 * A member that has shrunk to a point pushes its ends apart, but its gradient is undefined: moves
 * its free end aside. False if there is no such member.
 */
static bool leave_collapse(strut_minimiser *m, double *q) {
  const strut_potential *p = m->potential;
  strut_force force;
  bool any = false;
  for (int32_t i = 0; i < strut_force_count(p->model, false); i++) {
    strut_force_begin(p->model, i, &force);
    if (strut_force_has_collapsed(p->model, 1e-8, q, &force) &&
        move_end(p, force.at[0], force.at[1], 1e-3 * m->size, q))
      any = true;
  }
  if (any) strut_potential_gradient(p, q, m->g);
  return any;
}

/*
 * The energy lost from q to the trial. Where it drowns in the rounding of the energies themselves,
 * it is the work of the mean of both gradients.
 */
static double energy_lost(const strut_minimiser *m, double here, double there, double expected) {
  if (expected > 1e-9 * (fabs(here) + fabs(there))) return here - there;
  double work = 0.0;
  for (int32_t i = 0; i < m->potential->n; i++)
    work -= 0.5 * (m->g[i] + m->g_trial[i]) * m->step[i];
  return work;
}

/*
 * The trial and its energy; where the quadratic did not hold, again with the stiff modes brought
 * back into balance, as long as that leads lower. Returns the share of the reduction expected.
 */
static double try_step(strut_minimiser *m, const double *q, double here, double expected,
                       double *there) {
  size_t bytes = (size_t)m->potential->n * sizeof *m->step;
  set_trial(m, q, 1.0);
  *there = strut_potential_value_near(m->potential, m->trial, q);
  strut_potential_gradient(m->potential, m->trial, m->g_trial);
  double ratio = energy_lost(m, here, *there, expected) / expected;
  for (int i = 0; i < MOST_BENDS && !(ratio > 0.75); i++) {
    memcpy(m->unbent, m->step, bytes);
    if (!m->curvature->rebalance(m->workspace, m->g_trial, m->step)) break;
    set_trial(m, q, 1.0);
    double lower = strut_potential_value_near(m->potential, m->trial, q);
    bool better = lower < *there;
    if (better) *there = lower;
    if (!better) memcpy(m->step, m->unbent, bytes);
    if (!better) set_trial(m, q, 1.0);
    strut_potential_gradient(m->potential, m->trial, m->g_trial);
    if (!better) break;
    ratio = energy_lost(m, here, *there, expected) / expected;
  }
  return ratio;
}

/* Growth factor of the next step. Short steps grow while the quadratic model holds. */
static double radius_growth(const strut_minimiser *m, double ratio) {
  if (!m->short_steps) return 2.5;
  return fabs(ratio - 1.0) < 0.01 ? 10.0 : fabs(ratio - 1.0) < 0.25 ? 2.5 : 1.0;
}

/* One trust-region step; false where the radius has shrunk to nothing. */
static bool descend_once(strut_minimiser *m, double *q, double still, double *radius,
                         double *energy) {
  strut_model_step step = m->curvature->trust_step(m->workspace, m->g, *radius, still, m->step);
  if (!(step.length > 0)) return false;
  for (int tries = 0; tries < 60; tries++) {
    double there, ratio = try_step(m, q, *energy, step.reduction, &there);
    /* far more than expected: it may have left the valley it was in */
    bool astray = m->short_steps && ratio > 1.75 && step.length > 1e-6 * m->size;
    if (ratio > 1e-4 && !astray) {
      if (ratio > 0.75 && step.length > 0.99 * *radius)
        *radius = fmin(radius_growth(m, ratio) * *radius, m->longest_step);
      if (ratio < 0.25) *radius = 0.5 * step.length;
      keep_trial(m, q);
      bool couples = m->potential->model->elements.couples > 0;
      *energy = couples ? strut_potential_value(m->potential, q) : there;
      return true;
    }
    *radius = (ratio > -1.0 ? 0.25 : 0.1) * step.length;
    if (!(*radius > DBL_EPSILON * m->size)) return false;
    step = m->curvature->trust_step(m->workspace, m->g, *radius, still, m->step);
  }
  return false;
}

/*
 * A gradient within rounding ends the descent only if the Newton step is short too: beside very
 * stiff members rounding hides forces that soft members still yield to.
 */
void strut_minimiser_watch(strut_minimiser *m, const strut_flag *interrupt) {
  m->interrupt = interrupt;
}

void strut_minimiser_stay(strut_minimiser *m) { m->stays = true; }

void strut_minimiser_visit(strut_minimiser *m, void (*visit)(void *context, const double *q),
                           void *context) {
  m->visit = visit;
  m->visitor = context;
}

static void visit(const strut_minimiser *m, const double *q) {
  if (m->visit) m->visit(m->visitor, q);
}

strut_descent strut_minimise(strut_minimiser *m, double *q, double tolerance) {
  strut_descent end = {.end = STRUT_DESCENT_EXHAUSTED};
  int32_t n = m->potential->n, extra = 0;
  double radius = fmin(m->first_step, m->longest_step),
         energy = strut_potential_value(m->potential, q);
  memcpy(m->before, q, (size_t)m->potential->model->length * sizeof *q);
  strut_potential_gradient(m->potential, q, m->g);
  for (; end.iterations < MOST_STEPS; end.iterations++) {
    end.residual = strut_largest_magnitude(m->g, n);
    double allowed = residual_allowed(m, q, tolerance, &end.rounding);
    end.end = STRUT_DESCENT_EXHAUSTED;
    visit(m, q);
    if (ran_away(m, q, m->before)) {
      end.end = STRUT_DESCENT_RUNAWAY;
      return end;
    }
    if (m->interrupt && *m->interrupt) return end;
    if (!decompose_hessian(m, q)) return end;
    if (end.residual <= allowed) {
      if (!m->stays &&
          ((extra < 3 && leave_collapse(m, q) && ++extra) || leave_ridge(m, q, radius))) {
        energy = strut_potential_value(m->potential, q);
        continue;
      }
      end.end = STRUT_DESCENT_REACHED;
      double left = m->curvature->newton_step(m->workspace, m->g, m->step);
      end.step = left;
      if (left <= 1e-3 * m->size || extra++ == MOST_EXTRA) break;
    }
    if (!descend_once(m, q, sqrt((double)n) * allowed, &radius, &energy)) break;
  }
  if (end.end != STRUT_DESCENT_REACHED) return end;
  polish_point(m, q, tolerance, 1e-3 * m->size, &end);
  visit(m, q);
  if (end.step > 1e-5 * m->size || strut_shape_has_collapsed(m->potential->model, q))
    end.end = STRUT_DESCENT_EXHAUSTED;
  return end;
}

/*
 * Returns the distance from the saddle at which the force along the step exceeds rounding. A well
 * about to vanish may lie that close to its saddle.
 */
static double leave_saddle(strut_minimiser *m, const double *q, double side) {
  const strut_potential *p = m->potential;
  double far = 1e-7 * m->size, enough = 100.0 * strut_potential_rounding(p, q);
  for (; far < 0.02 * m->size; far *= 4.0) {
    double down = 0.0;
    set_trial(m, q, side * far);
    strut_potential_gradient(p, m->trial, m->g_trial);
    for (int32_t i = 0; i < p->n; i++) down -= side * m->step[i] * m->g_trial[i];
    if (down > enough) break;
  }
  set_trial(m, q, side * far);
  return far;
}

/* Down by steps that begin no longer than `first_step` and stay in the valley they are in. */
static strut_descent_end descend_shortly(strut_minimiser *m, double first_step, double *q) {
  double usual = m->first_step;
  m->first_step = first_step, m->longest_step = 0.03 * m->size, m->short_steps = true;
  strut_descent end = strut_minimise(m, q, 0.0);
  m->first_step = usual, m->longest_step = HUGE_VAL, m->short_steps = false;
  return end.end;
}

strut_descent_end strut_descend_gently(strut_minimiser *m, double *q) {
  return descend_shortly(m, 0.005 * m->size, q);
}

bool strut_descend_along(strut_minimiser *m, const double *direction, double side, double *q) {
  const strut_potential *p = m->potential;
  for (int32_t i = 0; i < p->n; i++) m->step[i] = direction[p->coordinate[i]];
  double first_step = leave_saddle(m, q, side);
  memcpy(q, m->trial, (size_t)p->model->length * sizeof *q);
  return descend_shortly(m, first_step, q) == STRUT_DESCENT_REACHED;
}

strut_descent strut_polish(strut_minimiser *m, double *q, double tolerance) {
  strut_descent end = {.end = STRUT_DESCENT_EXHAUSTED};
  strut_potential_gradient(m->potential, q, m->g);
  end.residual = strut_largest_magnitude(m->g, m->potential->n);
  polish_point(m, q, tolerance, 0.1 * m->size, &end);
  end.residual = strut_largest_magnitude(m->g, m->potential->n);
  if (end.residual <= residual_allowed(m, q, tolerance, &end.rounding))
    end.end = STRUT_DESCENT_REACHED;
  return end;
}
