/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/orbit/orbit.h"

#include <assert.h>
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/model/pose.h"

/* Members and nodes times steps between two checks of the interrupt flag. */
static const int64_t CHUNK_WORK = 200000;

strut_status strut_period_map_create(const strut_model *model, const strut_experiment *experiment,
                                     int32_t repeats, strut_period_map *map, strut_error *error) {
  *map = (strut_period_map){.model = model, .repeats = repeats};
  map->period = strut_experiment_span(experiment, model->scene).period;
  assert(repeats >= 1 && map->period > 0.0 && experiment->step > 0.0);
  map->steps = (int64_t)ceil(map->period / experiment->step * (1.0 - 1e-9));
  map->dt = map->period / (double)map->steps;
  const strut_time_grid grid = {.step = map->dt, .last = -1};
  map->method = strut_integrator_find(experiment->integrator);
  const strut_integrator_settings settings = strut_integrator_settings_of(experiment);
  strut_status status = strut_state_create(model, &map->state, error);
  if (!status) map->workspace = map->method->create(model, map->state, &settings);
  if (!status &&
      (!map->workspace || strut_measure_create(model, experiment, &grid, 0, 0, &map->measure)))
    status = strut_no_memory(error, "");
  if (status) {
    strut_period_map_free(map);
    return status;
  }
  map->travels = strut_contacts_allow_travel(&map->model->contacts);
  for (int32_t i = 0; i < 2 * map->model->node_count; i++)
    map->travels = map->travels && !map->model->fixed[i];
  return STRUT_OK;
}

static double mean_along(const strut_model *model, const double *q) {
  const double *t = model->contacts.tangent;
  double sum = 0.0;
  for (int32_t i = 0; i < model->node_count; i++) sum += q[2 * i] * t[0] + q[2 * i + 1] * t[1];
  return sum / model->node_count;
}

bool strut_period_map_interrupted(const strut_period_map *map) {
  return map->interrupt && *map->interrupt;
}

bool strut_period_map_spent(const strut_period_map *map) {
  return map->most_evaluations > 0 && map->evaluations > map->most_evaluations;
}

/* Is the limit exceeded, the present application included? */
static bool is_spent_now(const strut_period_map *map) {
  return map->most_evaluations > 0 &&
         map->evaluations + map->state->evaluations > map->most_evaluations;
}

/*
 * Advances in chunks long enough for the checks to cost nothing, and short enough to interrupt
 * promptly.
 */
static void advance_application(strut_period_map *map) {
  const strut_model *model = map->model;
  strut_state *state = map->state;
  int64_t most = CHUNK_WORK / (model->members.count + model->node_count + 1) + 1;
  int64_t left = map->steps * map->repeats;
  state->limits.interrupt = map->interrupt;
  if (map->most_evaluations > 0)
    state->limits.most_evaluations =
        map->most_evaluations > map->evaluations ? map->most_evaluations - map->evaluations : 1;
  while (left > 0 && !state->trouble && !strut_period_map_interrupted(map) && !is_spent_now(map)) {
    int64_t count = map->watch ? 1 : left < most ? left : most;
    strut_integrator_advance(map->method, model, state, map->workspace, map->dt, count);
    if (map->watch) map->watch(map->watch_context, state);
    left -= count;
  }
}

double strut_period_map_apply(strut_period_map *map, double *y) {
  const strut_model *model = map->model;
  strut_state *state = map->state;
  size_t bytes = (size_t)model->length * sizeof(double);
  double from, to, speed, before = mean_along(model, y);
  strut_state_reset(model, state);
  state->step = llround(map->time / map->dt);
  memcpy(state->q, y, bytes);
  memcpy(state->v, y + model->length, bytes);
  state->refined_until = map->time + y[2 * model->length];
  strut_measure_tracked_point(model, state, &map->measure, &from, &speed);
  if (map->method->restart) map->method->restart(model, state, map->workspace, map->dt);
  advance_application(map);
  map->evaluations += state->evaluations;
  map->events += state->events;
  map->forced += state->forced.count;
  map->applied += map->repeats;
  strut_measure_tracked_point(model, state, &map->measure, &to, &speed);
  memcpy(y, state->q, bytes);
  memcpy(y + model->length, state->v, bytes);
  y[2 * model->length] = fmax(0.0, state->refined_until - (double)state->step * map->dt);
  double shift = map->travels ? mean_along(model, y) - before : 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    y[i] -= shift * model->contacts.tangent[i % 2];
  bool whole =
      !state->trouble && !strut_period_map_interrupted(map) && !strut_period_map_spent(map);
  return whole ? to - from : (double)NAN;
}

double strut_period_map_size(const strut_period_map *map, const double *d) {
  const strut_model *model = map->model;
  double speed = model->size * STRUT_TAU / map->period, most = 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i++) {
    most = fmax(most, fabs(d[i]) / model->size);
    most = fmax(most, fabs(d[model->length + i]) / speed);
  }
  return most;
}

void strut_period_map_subtract(const strut_period_map *map, const double *from, const double *to,
                               double *d) {
  const strut_model *model = map->model;
  const double *t = model->contacts.tangent;
  double along = 0.0;
  for (int32_t i = 0; i <= 2 * model->length; i++) d[i] = to[i] - from[i];
  for (int32_t i = 0; i < model->node_count && map->travels; i++)
    along += (d[2 * i] * t[0] + d[2 * i + 1] * t[1]) / model->node_count;
  for (int32_t i = 0; i < 2 * model->node_count; i++) d[i] -= along * t[i % 2];
}

void strut_period_map_free(strut_period_map *map) {
  strut_measure_free(&map->measure);
  strut_state_free(map->state);
  *map = (strut_period_map){.model = NULL};
}

static const double DIFFERENCE = 1e-6; /* step of the central differences, in scaled unknowns */
static const double ROUNDING = 1e-13;  /* residuals below this are rounding */
static const double CONVERGED = 1e-8;  /* largest residual of an orbit that counts as found */
enum { MOST_ROUNDS = 8, MOST_HALVINGS = 6 };

/* Unknowns are free coordinates over the size, then their velocities over size times 2 pi f. */
typedef struct shooting_problem {
  strut_period_map *map;
  size_t count, both;
  size_t *place;  /* (count) of an unknown in y */
  double *unit;   /* (count) [m], [m/s] */
  double *along;  /* (count) the shift along the ground, of length 1; zeros where there is none */
  double *matrix; /* (count, count) derivative of the map, without the neutral shift */
  double *work;   /* (count, count) */
  double *f, *change;           /* (count) */
  double *here, *there, *trial; /* (both) */
  strut_arena arena;
} shooting_problem;

static bool allocate_problem(shooting_problem *s) {
  strut_arena *a = &s->arena;
  size_t n = s->count, square = n * n;
  return (s->place = strut_arena_allocate(a, n, sizeof *s->place)) &&
         (s->unit = strut_arena_allocate(a, n, sizeof(double))) &&
         (s->along = strut_arena_allocate(a, n, sizeof(double))) &&
         (s->matrix = strut_arena_allocate(a, square, sizeof(double))) &&
         (s->work = strut_arena_allocate(a, square, sizeof(double))) &&
         (s->f = strut_arena_allocate(a, n, sizeof(double))) &&
         (s->change = strut_arena_allocate(a, n, sizeof(double))) &&
         (s->here = strut_arena_allocate(a, s->both, sizeof(double))) &&
         (s->there = strut_arena_allocate(a, s->both, sizeof(double))) &&
         (s->trial = strut_arena_allocate(a, s->both, sizeof(double)));
}

static void choose_unknowns(shooting_problem *s) {
  const strut_model *m = s->map->model;
  size_t k = 0, nodes = (size_t)m->node_count, half = s->count / 2;
  for (size_t i = 0; i < 2 * nodes; i++) {
    if (m->fixed[i]) continue;
    s->place[k] = i, s->unit[k] = m->size;
    s->place[half + k] = (size_t)m->length + i,
                    s->unit[half + k] = m->size * STRUT_TAU / s->map->period;
    if (s->map->travels) s->along[k] = m->contacts.tangent[i % 2] / sqrt((double)nodes);
    k++;
  }
}

/*
 * Evaluates one application from y: scaled residual in f, end in s->there; returns the largest
 * residual.
 */
static double evaluate_residual(shooting_problem *s, const double *y, double *travel) {
  memcpy(s->there, y, s->both * sizeof(double));
  double gone = strut_period_map_apply(s->map, s->there), most = 0.0;
  if (travel) *travel = gone;
  if (!isfinite(gone)) return HUGE_VAL;
  for (size_t i = 0; i < s->count; i++) {
    s->f[i] = (s->there[s->place[i]] - y[s->place[i]]) / s->unit[i];
    most = fmax(most, fabs(s->f[i]));
  }
  return most;
}

/* Differentiates the map at y by central differences; false where the motion was lost. */
static bool differentiate(shooting_problem *s, const double *y) {
  size_t n = s->count;
  for (size_t j = 0; j < n; j++) {
    for (int side = -1; side <= 1; side += 2) {
      memcpy(s->there, y, s->both * sizeof(double));
      s->there[s->place[j]] += side * DIFFERENCE * s->unit[j];
      if (!isfinite(strut_period_map_apply(s->map, s->there))) return false;
      for (size_t i = 0; i < n; i++) {
        double part = side * s->there[s->place[i]] / s->unit[i] / (2.0 * DIFFERENCE);
        s->matrix[i * n + j] = side < 0 ? part : s->matrix[i * n + j] + part;
      }
    }
  }
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) s->matrix[i * n + j] -= s->along[i] * s->along[j];
  return true;
}

bool strut_solve_dense(double *a, double *x, size_t n, double least) {
  for (size_t p = 0; p < n; p++) {
    size_t best = p;
    for (size_t i = p + 1; i < n; i++)
      if (fabs(a[i * n + p]) > fabs(a[best * n + p])) best = i;
    if (!(fabs(a[best * n + p]) > least)) return false;
    for (size_t j = 0; j < n && best != p; j++) {
      double keep = a[p * n + j];
      a[p * n + j] = a[best * n + j], a[best * n + j] = keep;
    }
    double keep = x[p];
    x[p] = x[best], x[best] = keep;
    for (size_t i = p + 1; i < n; i++) {
      double factor = a[i * n + p] / a[p * n + p];
      for (size_t j = p; j < n; j++) a[i * n + j] -= factor * a[p * n + j];
      x[i] -= factor * x[p];
    }
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t j = i + 1; j < n; j++) x[i] -= a[i * n + j] * x[j];
    x[i] /= a[i * n + i];
  }
  return true;
}

/* change = -(J - 1)^-1 f; false where it is singular. */
static bool solve_newton_step(shooting_problem *s) {
  size_t n = s->count;
  memcpy(s->work, s->matrix, n * n * sizeof(double));
  for (size_t i = 0; i < n; i++) s->work[i * n + i] -= 1.0, s->change[i] = -s->f[i];
  return strut_solve_dense(s->work, s->change, n, 1e-12);
}

/*
 * Line search along the change, halved until the residual falls; returns the new residual, or the
 * old one.
 */
static double search_line(shooting_problem *s, double before, double *travel) {
  double part = 1.0;
  for (int k = 0; k < MOST_HALVINGS && !strut_period_map_interrupted(s->map); k++, part *= 0.5) {
    double gone;
    memcpy(s->trial, s->here, s->both * sizeof(double));
    for (size_t i = 0; i < s->count; i++) s->trial[s->place[i]] += part * s->change[i] * s->unit[i];
    double left = evaluate_residual(s, s->trial, &gone);
    if (left < before) {
      memcpy(s->here, s->trial, s->both * sizeof(double));
      *travel = gone;
      return left;
    }
  }
  return before;
}

/*
 * Newton's method from s->here until the residual stops falling; the matrix is the derivative at
 * the last point.
 */
static double iterate_newton(shooting_problem *s, double *travel, strut_steady_summary *found) {
  double left = evaluate_residual(s, s->here, travel);
  for (int round = 0; round < MOST_ROUNDS; round++) {
    if (!differentiate(s, s->here)) return HUGE_VAL;
    if (left <= ROUNDING) break;
    evaluate_residual(s, s->here, NULL);
    if (!solve_newton_step(s)) {
      snprintf(found->reason, sizeof found->reason,
               "the period map has another neutral direction, so that the orbit is not isolated");
      break;
    }
    double before = left;
    left = search_line(s, before, travel);
    found->iterations++;
    if (left > 0.5 * before || (left <= CONVERGED * 1e-2 && left > 0.1 * before)) break;
  }
  return left;
}

static void find_multipliers(shooting_problem *s, strut_steady_summary *found) {
  size_t n = s->count;
  gsl_matrix_view view = gsl_matrix_view_array(s->work, n, n);
  gsl_eigen_nonsymm_workspace *w = gsl_eigen_nonsymm_alloc(n);
  gsl_vector_complex *values = gsl_vector_complex_alloc(n);
  memcpy(s->work, s->matrix, n * n * sizeof(double));
  found->multiplier_count = 0;
  if (w && values && gsl_eigen_nonsymm(&view.matrix, values, w) == 0) {
    size_t kept = 0, room = n - (s->map->travels ? 1 : 0);
    if (room > STRUT_MOST_MULTIPLIERS) room = STRUT_MOST_MULTIPLIERS;
    for (size_t i = 0; i < n; i++) { /* insertion by magnitude, largest first */
      double re = GSL_REAL(gsl_vector_complex_get(values, i));
      double im = GSL_IMAG(gsl_vector_complex_get(values, i)), size = hypot(re, im);
      size_t at = kept;
      while (at > 0 && size > hypot(found->multiplier[at - 1][0], found->multiplier[at - 1][1]))
        at--;
      if (at >= room) continue;
      size_t last = kept < room ? kept : room - 1;
      memmove(found->multiplier + at + 1, found->multiplier + at,
              (last - at) * sizeof found->multiplier[0]);
      found->multiplier[at][0] = re, found->multiplier[at][1] = im;
      if (kept < room) kept++;
    }
    found->multiplier_count = kept;
  }
  gsl_eigen_nonsymm_free(w);
  gsl_vector_complex_free(values);
}

strut_status strut_shoot(strut_period_map *map, double *y, double *travel,
                         strut_steady_summary *found) {
  shooting_problem s = {.map = map, .both = 2 * (size_t)map->model->length + 1};
  found->shot = false, found->iterations = 0, found->multiplier_count = 0;
  found->reason[0] = '\0';
  for (int32_t i = 0; i < 2 * map->model->node_count; i++) s.count += map->model->fixed[i] ? 0 : 2;
  if (s.count == 0 || s.count > STRUT_MOST_SHOT) {
    snprintf(found->reason, sizeof found->reason,
             "%zu free coordinates and velocities; shooting supports 1 to %d", s.count,
             STRUT_MOST_SHOT);
    return STRUT_OK;
  }
  if (!allocate_problem(&s)) {
    strut_arena_free(&s.arena);
    return STRUT_NO_MEMORY;
  }
  choose_unknowns(&s);
  memcpy(s.here, y, s.both * sizeof(double));
  double gone = 0.0, left = iterate_newton(&s, &gone, found);
  bool interrupted = strut_period_map_interrupted(map);
  if (!interrupted && left <= CONVERGED) {
    found->shot = true;
    found->residual = left;
    memcpy(y, s.here, s.both * sizeof(double));
    *travel = gone;
    find_multipliers(&s, found);
  } else if (!interrupted && !found->reason[0]) {
    snprintf(found->reason, sizeof found->reason,
             "Newton's method did not converge: residual %.2g of the size", left);
  }
  strut_arena_free(&s.arena);
  return interrupted ? STRUT_INTERRUPTED : STRUT_OK;
}
