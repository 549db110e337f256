/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/follow/follow_system.h"

#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/model/pose.h"
#include "engine/run/orbit/orbit.h"

#ifdef _OPENMP
#include <omp.h>
#endif

/* Steps of the differences, in unknowns of order one and in the parameter over its range. */
static const double DIFFERENCE = 1e-5, PARAMETER_DIFFERENCE = 1e-5;
/* Instants within a period at which the size of the motion is sampled. */
enum { SAMPLES = 16 };

/* ---- which scenes have motions to follow ---- */

/* Number of drive periods after which no signal starts or ends any more; -1: some signal never repeats. */
static int64_t periods_before(const strut_scene *scene, double period) {
  for (size_t i = 0; i < scene->signal_count; i++) {
    const strut_signal *s = &scene->signals[i];
    if ((s->kind != STRUT_SINE && s->kind != STRUT_SQUARE) || isfinite(s->stop)) continue;
    double turns = period * s->frequency;
    if (fabs(turns - round(turns)) > 1e-9 * fmax(1.0, turns)) return -1;
  }
  return (int64_t)ceil(strut_scene_last_signal_event(scene) / period * (1.0 - 1e-12));
}

static strut_status check_scene(const strut_follow_system *s, strut_error *error) {
  const strut_model *m = s->model;
  const strut_integrator *method = strut_integrator_find(s->how.method);
  if (!(s->setup.experiment.periods > 0.0) || !(s->period > 0.0))
    return strut_fail(error, STRUT_USAGE,
                      "there is no drive whose period a motion could repeat: give 'run' in periods "
                      "of an actuator or a load, such as {periods: 100, of: NAME}");
  if (periods_before(m->scene, s->period) < 0)
    return strut_fail(error, STRUT_USAGE,
                      "the drive does not repeat itself: some signal's frequency is no multiple of "
                      "that of the drive's period");
  if (!m->mass) return strut_fail(error, STRUT_SINGULAR, "a free node has no mass");
  if (!method) return strut_fail(error, STRUT_USAGE, "no method is called '%s'", s->how.method);
  if (!method->events && (m->contacts.count || (m->terms & STRUT_TERM_SLACK)))
    return strut_fail(error, STRUT_USAGE,
                      "'%s' locates no events, without which the period map of contacts and cables "
                      "has no derivative; use adaptive, rk4-events or verlet-events",
                      s->how.method);
  if ((m->terms & STRUT_TERM_MEMORY) || strut_feedback_remembers(&m->feedback) ||
      (m->terms & STRUT_TERM_SLIDING_MASS) || m->contacts.grips)
    return strut_fail(
        error, STRUT_USAGE,
        "what breaks, yields, folds or slides along members, friction that follows a signal, and "
        "internal states of controllers cannot be followed: positions and velocities are not all "
        "of "
        "the state, or their derivatives are not known");
  strut_experiment e = s->setup.experiment;
  e.integrator = s->how.method;
  return strut_integrator_check(m, &e, error);
}

/* ---- models of values ---- */

static void drop_model(strut_follow_system *s) {
  for (int i = 0; s->map && i < s->how.threads; i++) {
    s->spent.evaluations += s->map[i].evaluations;
    s->spent.maps += s->map[i].applied;
    strut_period_map_free(&s->map[i]);
  }
  strut_model_free(s->model);
  s->model = NULL;
  s->variation = NULL;
  strut_setup_free(&s->setup);
  s->value = (double)NAN;
}

static strut_status make_maps(strut_follow_system *s, strut_error *error) {
  strut_experiment e = s->setup.experiment;
  e.integrator = s->how.method;
  e.tolerance = s->how.tolerance;
  e.step = s->period / (double)s->how.steps_per_period;
  e.refine = e.refine_time = 0.0;
  e.accuracy = 0.0;
  int64_t before = periods_before(s->model->scene, s->period);
  int count = s->how.threads;
  for (int i = 0; i < count; i++) {
    strut_period_map *map = &s->map[i];
    strut_status status = strut_period_map_create(s->model, &e, s->how.repeats, map, error);
    if (status) return status;
    map->interrupt = s->how.interrupt;
    map->time = (double)before * s->period;
    if (strut_variation_possible(s->model, map->method)) count = 1; /* one run then does */
  }
  if (strut_variation_possible(s->model, s->map[0].method)) {
    s->variation = strut_variation_create(s->model, s->map[0].state);
    if (!s->variation) return strut_no_memory(error, "");
  }
  if (!s->log) s->log = strut_event_log_create(s->model, &s->arena);
  return s->log ? STRUT_OK : strut_no_memory(error, "");
}

/* Are numbers of nodes, contacts, members and elements those of the first model? */
static bool has_same_structure(const strut_follow_system *s) {
  const strut_model *m = s->model;
  return 2 * (size_t)m->length + 1 == s->both && m->contacts.count == s->log->contacts &&
         m->members.count == s->log->members && m->elements.count == s->log->elements;
}

strut_status strut_follow_set_value(strut_follow_system *s, double value, strut_error *error) {
  if (s->model && s->value == value) return STRUT_OK;
  drop_model(s);
  strut_status status = s->scenes.setup(s->scenes.context, value, &s->setup, error);
  if (status) return status;
  s->spent.scenes++;
  status = strut_model_compile(&s->setup.scene, &s->model, error);
  if (!status) {
    s->period = strut_experiment_span(&s->setup.experiment, &s->setup.scene).period;
    status = check_scene(s, error);
  }
  if (!status && s->log && !has_same_structure(s))
    status =
        strut_fail(error, STRUT_USAGE,
                   "the parameter changes what the structure consists of, over which no motion "
                   "is followed");
  if (!status) status = make_maps(s, error);
  if (status) {
    drop_model(s);
    return status;
  }
  s->value = value;
  return STRUT_OK;
}

strut_status strut_follow_set_repeats(strut_follow_system *s, int32_t repeats, strut_error *error) {
  double value = s->value;
  if (repeats == s->how.repeats) return STRUT_OK;
  s->how.repeats = repeats;
  s->derivative.known = false;
  drop_model(s);
  return strut_follow_set_value(s, value, error);
}

strut_status strut_follow_set_steps(strut_follow_system *s, int64_t steps, strut_error *error) {
  double value = s->value;
  if (steps == s->how.steps_per_period) return STRUT_OK;
  s->how.steps_per_period = steps;
  s->derivative.known = false;
  drop_model(s);
  return strut_follow_set_value(s, value, error);
}

static bool allocate(strut_follow_system *s) {
  strut_arena *a = &s->arena;
  size_t n = s->n, square = (n + 1) * (n + 1);
  return (s->place = strut_arena_allocate(a, n, sizeof *s->place)) &&
         (s->along = strut_arena_allocate(a, n, sizeof(double))) &&
         (s->derivative.jacobian = strut_arena_allocate(a, square, sizeof(double))) &&
         (s->derivative.column = strut_arena_allocate(a, n, sizeof(double))) &&
         (s->buffers.there =
              strut_arena_allocate(a, (size_t)s->how.threads * s->both, sizeof(double))) &&
         (s->buffers.end = strut_arena_allocate(a, s->both, sizeof(double))) &&
         (s->buffers.seen = strut_arena_allocate(a, 4 * s->both, sizeof(double))) &&
         (s->buffers.matrix = strut_arena_allocate(a, square, sizeof(double)));
}

static void choose_unknowns(strut_follow_system *s) {
  const strut_model *m = s->model;
  size_t k = 0, nodes = (size_t)m->node_count;
  for (size_t i = 0; i < 2 * nodes; i++) {
    if (m->fixed[i]) continue;
    s->place[k] = i;
    s->place[s->n / 2 + k] = (size_t)m->length + i;
    s->along[k] = s->travels ? m->contacts.tangent[i % 2] / sqrt((double)nodes) : 0.0;
    k++;
  }
}

strut_status strut_follow_open(strut_follow_system *s, double value, strut_error *error) {
  if (s->how.threads < 1) s->how.threads = 1;
  s->value = (double)NAN;
  s->n = s->both = 0;
  s->map = strut_arena_allocate(&s->arena, (size_t)s->how.threads, sizeof *s->map);
  if (!s->map) return strut_no_memory(error, "");
  strut_status status = strut_follow_set_value(s, value, error);
  if (status) return status;
  const strut_model *m = s->model;
  for (int32_t i = 0; i < 2 * m->node_count; i++) s->n += m->fixed[i] ? 0 : 2;
  s->both = 2 * (size_t)m->length + 1;
  s->travels = s->map[0].travels;
  if (s->n == 0 || s->n > STRUT_FOLLOW_MOST)
    return strut_fail(error, STRUT_USAGE,
                      "%zu free coordinates; motions are followed with 1 to %d of them", s->n / 2,
                      STRUT_FOLLOW_MOST / 2);
  if (!allocate(s)) return strut_no_memory(error, "");
  choose_unknowns(s);
  s->length = m->size;
  s->speed = m->size * STRUT_TAU / s->period;
  return STRUT_OK;
}

void strut_follow_close(strut_follow_system *s) {
  drop_model(s);
  strut_arena_free(&s->arena);
}

/* ---- the map ---- */

bool strut_follow_set_units(strut_follow_system *s, const double *y) {
  const strut_model *m = s->model;
  strut_period_map *map = &s->map[0];
  double most = 0.0, at = map->time;
  int64_t steps = map->steps;
  int32_t repeats = map->repeats;
  double *here = s->buffers.end;
  memcpy(here, y, s->both * sizeof(double));
  bool good = true;
  /* parts of a period that are whole steps, as the map takes them */
  map->repeats = 1;
  for (int k = 0; k < SAMPLES && good; k++) {
    int64_t from = steps * k / SAMPLES, to = steps * (k + 1) / SAMPLES;
    if (from == to) continue;
    map->steps = to - from;
    map->time = at + (double)from * map->dt;
    good = isfinite(strut_period_map_apply(map, here));
    for (int32_t i = 0; i < 2 * m->node_count; i++) most = fmax(most, fabs(here[i] - y[i]));
  }
  map->steps = steps, map->time = at, map->repeats = repeats;
  if (!(most > 1e-9 * m->size)) most = 1e-3 * m->size;
  s->length = most;
  s->speed = most * STRUT_TAU / s->period;
  return good;
}

/* Range of each coordinate: ends of steps, and extrema of the cubics between them. */
static void watch_range(void *context, const strut_state *state) {
  strut_follow_system *s = context;
  size_t count = 2 * (size_t)s->model->node_count;
  double *low = s->buffers.seen, *high = low + count, *q = high + count, *v = q + count;
  double h = s->map[0].dt;
  for (size_t i = 0; i < count; i++) {
    double rise = state->q[i] - q[i], a = h * v[i], b = h * state->v[i];
    double top = state->q[i];
    if (a * b < 0.0) { /* slope of the cubic: a + 2 c x + 3 d x^2 */
      double c = 3.0 * rise - 2.0 * a - b, d = a + b - 2.0 * rise;
      double root = sqrt(fmax(0.0, c * c - 3.0 * d * a));
      double x = -a / (c + (a < 0.0 ? root : -root));
      if (x > 0.0 && x < 1.0) top = q[i] + x * (a + x * (c + x * d));
    }
    low[i] = fmin(low[i], fmin(top, state->q[i]));
    high[i] = fmax(high[i], fmax(top, state->q[i]));
    q[i] = state->q[i], v[i] = state->v[i];
  }
}

/* Of the measured node, or of all where the centre of mass is measured. */
static double amplitude_of(const strut_follow_system *s) {
  size_t count = 2 * (size_t)s->model->node_count;
  int32_t node = s->setup.experiment.measure_node;
  double most = 0.0;
  for (size_t i = 0; i < count; i++)
    if (node < 0 || i / 2 == (size_t)node)
      most = fmax(most, s->buffers.seen[count + i] - s->buffers.seen[i]);
  return 0.5 * most;
}

strut_follow_period strut_follow_apply(strut_follow_system *s, double *y, bool works) {
  strut_period_map *map = &s->map[0];
  strut_follow_period p = {0};
  map->state->balance = works;
  map->state->watched.event_log = works ? s->log : NULL;
  map->watch = works ? watch_range : NULL;
  map->watch_context = s;
  size_t count = 2 * (size_t)s->model->node_count, bytes = count * sizeof(double);
  for (int k = 0; k < 3; k++) memcpy(s->buffers.seen + (size_t)k * count, y, bytes);
  memcpy(s->buffers.seen + 3 * count, y + s->model->length, bytes);
  p.travel = strut_period_map_apply(map, y);
  p.amplitude = works ? amplitude_of(s) : 0.0;
  map->watch = NULL;
  map->state->balance = false;
  map->state->watched.event_log = NULL;
  const double *w = map->state->work;
  p.work = works ? w[STRUT_POWER_DRIVE] + w[STRUT_POWER_LOAD] + w[STRUT_POWER_BELT] : 0.0;
  return p;
}

double strut_follow_change(const strut_follow_system *s, const double *y, const double *end,
                           double *f) {
  double most = 0.0;
  for (size_t i = 0; i < s->n; i++) {
    f[i] = (end[s->place[i]] - y[s->place[i]]) / strut_follow_unit(s, i);
    most = fmax(most, fabs(f[i]));
  }
  return most;
}

double strut_follow_residual(strut_follow_system *s, const double *y, double *f) {
  memcpy(s->buffers.end, y, s->both * sizeof(double));
  if (!isfinite(strut_follow_apply(s, s->buffers.end, false).travel)) return HUGE_VAL;
  return strut_follow_change(s, y, s->buffers.end, f);
}

strut_follow_period strut_follow_carry(strut_follow_system *s, double *y, bool works) {
  strut_variation *x = s->variation;
  size_t n = s->n;
  strut_variation_reset(x);
  s->map[0].state->watched.variation = x;
  strut_follow_period p = strut_follow_apply(s, y, works);
  s->map[0].state->watched.variation = NULL;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      s->derivative.jacobian[i * n + j] =
          x->columns[i * (size_t)x->stride + j] * strut_follow_unit(s, j) / strut_follow_unit(s, i);
  for (size_t j = 0; j < n && s->travels; j++) { /* the map takes the travel out */
    double shift = 0.0;
    for (size_t i = 0; i < n; i++) shift += s->along[i] * s->derivative.jacobian[i * n + j];
    for (size_t i = 0; i < n; i++) s->derivative.jacobian[i * n + j] -= shift * s->along[i];
  }
  s->derivative.known = isfinite(p.travel);
  return p;
}

void strut_follow_difference(strut_follow_system *s, const double *y, bool *lost) {
  size_t n = s->n;
  int gone = 0;
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic) num_threads(s->how.threads) reduction(+ : gone)
#endif
  for (size_t j = 0; j < n; j++) {
#ifdef _OPENMP
    int t = omp_get_thread_num();
#else
    int t = 0;
#endif
    double *there = s->buffers.there + (size_t)t * s->both;
    for (int side = -1; side <= 1; side += 2) {
      memcpy(there, y, s->both * sizeof(double));
      there[s->place[j]] += side * DIFFERENCE * strut_follow_unit(s, j);
      if (!isfinite(strut_period_map_apply(&s->map[t], there))) gone++;
      for (size_t i = 0; i < n; i++) {
        double moved = side * (there[s->place[i]] - y[s->place[i]]) / strut_follow_unit(s, i);
        double *entry = &s->derivative.jacobian[i * n + j];
        *entry = (side < 0 ? 0.0 : *entry) + moved / (2.0 * DIFFERENCE);
      }
    }
  }
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) s->derivative.jacobian[i * n + j] -= s->along[i] * s->along[j];
  *lost = gone > 0;
  s->derivative.known = !*lost;
}

strut_status strut_follow_differentiate(strut_follow_system *s, const double *y, const double *f,
                                        bool *lost, strut_error *error) {
  memcpy(s->buffers.end, y, s->both * sizeof(double));
  if (s->variation)
    *lost = !isfinite(strut_follow_carry(s, s->buffers.end, false).travel);
  else
    strut_follow_difference(s, y, lost);
  return *lost ? STRUT_OK : strut_follow_differentiate_parameter(s, y, f, lost, error);
}

strut_status strut_follow_differentiate_parameter(strut_follow_system *s, const double *y,
                                                  const double *f, bool *lost, strut_error *error) {
  size_t n = s->n;
  double value = s->value, step = PARAMETER_DIFFERENCE * (s->high - s->low);
  if (value + step > fmax(s->low, s->high)) step = -step;
  strut_status status = strut_follow_set_value(s, value + step, error);
  if (status) return status;
  *lost = !isfinite(strut_follow_residual(s, y, s->derivative.column));
  for (size_t i = 0; i < n; i++)
    s->derivative.column[i] = (s->derivative.column[i] - f[i]) * (s->high - s->low) / step;
  return strut_follow_set_value(s, value, error);
}

/* ---- unknowns ---- */

void strut_follow_move(const strut_follow_system *s, double *y, const double *d, double factor) {
  for (size_t i = 0; i < s->n; i++) y[s->place[i]] += factor * d[i] * strut_follow_unit(s, i);
}

void strut_follow_centre(const strut_follow_system *s, double *y) {
  const strut_model *m = s->model;
  const double *t = m->contacts.tangent;
  double mean = 0.0;
  if (!s->travels) return;
  for (int32_t i = 0; i < 2 * m->node_count; i++) mean += y[i] * t[i % 2] / m->node_count;
  for (int32_t i = 0; i < 2 * m->node_count; i++) y[i] -= mean * t[i % 2];
}

bool strut_follow_solve_with(const strut_follow_system *s, const strut_follow_border *border,
                             double *a, double *x) {
  size_t n = s->n, m = n + border->count;
  double most = 0.0;
  for (size_t i = 0; i < n; i++) {
    for (size_t j = 0; j < n; j++) a[i * m + j] = s->derivative.jacobian[i * n + j] - (i == j);
    for (size_t k = 0; k < border->count; k++) a[i * m + n + k] = border->column[k][i];
  }
  for (size_t k = 0; k < border->count; k++)
    memcpy(a + (n + k) * m, border->row[k], m * sizeof(double));
  for (size_t i = 0; i < m * m; i++) most = fmax(most, fabs(a[i]));
  return strut_solve_dense(a, x, m, 1e-14 * most);
}

bool strut_follow_solve(strut_follow_system *s, const double *normal, double *x) {
  const strut_follow_border border = {1, {s->derivative.column}, {normal}};
  return strut_follow_solve_with(s, &border, s->buffers.matrix, x);
}

void strut_follow_update(strut_follow_system *s, const strut_follow_border *border, const double *f,
                         const double *x) {
  double size = 0.0;
  for (size_t j = 0; j < s->n + border->count; j++) size += x[j] * x[j];
  if (!(size > 0.0)) return;
  for (size_t i = 0; i < s->n; i++) {
    for (size_t j = 0; j < s->n; j++) s->derivative.jacobian[i * s->n + j] += f[i] * x[j] / size;
    for (size_t k = 0; k < border->count; k++) border->column[k][i] += f[i] * x[s->n + k] / size;
  }
}
