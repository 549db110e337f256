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
    const strut_signal *signal = &scene->signals[i];
    if ((signal->kind != STRUT_SINE && signal->kind != STRUT_SQUARE) || isfinite(signal->stop))
      continue;
    double turns = period * signal->frequency;
    if (fabs(turns - round(turns)) > 1e-9 * fmax(1.0, turns)) return -1;
  }
  return (int64_t)ceil(strut_scene_last_signal_event(scene) / period * (1.0 - 1e-12));
}

static strut_status check_scene(const strut_follow_system *system, strut_error *error) {
  const strut_model *model = system->model;
  const strut_integrator *method = strut_integrator_find(system->how.method);
  if (!(system->setup.experiment.periods > 0.0) || !(system->period > 0.0))
    return strut_fail(error, STRUT_USAGE,
                      "there is no drive whose period a motion could repeat: give 'run' in periods "
                      "of an actuator or a load, such as {periods: 100, of: NAME}");
  if (periods_before(model->scene, system->period) < 0)
    return strut_fail(error, STRUT_USAGE,
                      "the drive does not repeat itself: some signal's frequency is no multiple of "
                      "that of the drive's period");
  if (!model->mass) return strut_fail(error, STRUT_SINGULAR, "a free node has no mass");
  if (!method)
    return strut_fail(error, STRUT_USAGE, "no method is called '%s'", system->how.method);
  if (!method->events && (model->contacts.count || (model->terms & STRUT_TERM_SLACK)))
    return strut_fail(error, STRUT_USAGE,
                      "'%s' locates no events, without which the period map of contacts and cables "
                      "has no derivative; use adaptive, rk4-events or verlet-events",
                      system->how.method);
  if ((model->terms & STRUT_TERM_MEMORY) || strut_feedback_remembers(&model->feedback) ||
      (model->terms & STRUT_TERM_SLIDING_MASS) || model->contacts.grips)
    return strut_fail(
        error, STRUT_USAGE,
        "what breaks, yields, folds or slides along members, friction that follows a signal, and "
        "internal states of controllers cannot be followed: positions and velocities are not all "
        "of "
        "the state, or their derivatives are not known");
  strut_experiment e = system->setup.experiment;
  e.integrator = system->how.method;
  return strut_integrator_check(model, &e, error);
}

/* ---- models of values ---- */

static void drop_model(strut_follow_system *system) {
  for (int i = 0; system->map && i < system->how.threads; i++) {
    system->spent.evaluations += system->map[i].evaluations;
    system->spent.maps += system->map[i].applied;
    strut_period_map_free(&system->map[i]);
  }
  strut_model_free(system->model);
  system->model = NULL;
  system->variation = NULL;
  strut_setup_free(&system->setup);
  system->value = (double)NAN;
}

static strut_status make_maps(strut_follow_system *system, strut_error *error) {
  strut_experiment e = system->setup.experiment;
  e.integrator = system->how.method;
  e.tolerance = system->how.tolerance;
  e.step = system->period / (double)system->how.steps_per_period;
  e.refine = e.refine_time = 0.0;
  e.accuracy = 0.0;
  int64_t before = periods_before(system->model->scene, system->period);
  int count = system->how.threads;
  for (int i = 0; i < count; i++) {
    strut_period_map *map = &system->map[i];
    strut_status status =
        strut_period_map_create(system->model, &e, system->how.repeats, map, error);
    if (status) return status;
    map->interrupt = system->how.interrupt;
    map->time = (double)before * system->period;
    if (strut_variation_possible(system->model, map->method)) count = 1; /* one run then does */
  }
  if (strut_variation_possible(system->model, system->map[0].method)) {
    system->variation = strut_variation_create(system->model, system->map[0].state);
    if (!system->variation) return strut_no_memory(error, "");
  }
  if (!system->log) system->log = strut_event_log_create(system->model, &system->arena);
  return system->log ? STRUT_OK : strut_no_memory(error, "");
}

/* Are numbers of nodes, contacts, members and elements those of the first model? */
static bool has_same_structure(const strut_follow_system *system) {
  const strut_model *model = system->model;
  return 2 * (size_t)model->length + 1 == system->both &&
         model->contacts.count == system->log->contacts &&
         model->members.count == system->log->members &&
         model->elements.count == system->log->elements;
}

strut_status strut_follow_set_value(strut_follow_system *system, double value, strut_error *error) {
  if (system->model && system->value == value) return STRUT_OK;
  drop_model(system);
  strut_status status = system->scenes.setup(system->scenes.context, value, &system->setup, error);
  if (status) return status;
  system->spent.scenes++;
  status = strut_model_compile(&system->setup.scene, &system->model, error);
  if (!status) {
    system->period = strut_experiment_span(&system->setup.experiment, &system->setup.scene).period;
    status = check_scene(system, error);
  }
  if (!status && system->log && !has_same_structure(system))
    status =
        strut_fail(error, STRUT_USAGE,
                   "the parameter changes what the structure consists of, over which no motion "
                   "is followed");
  if (!status) status = make_maps(system, error);
  if (status) {
    drop_model(system);
    return status;
  }
  system->value = value;
  return STRUT_OK;
}

strut_status strut_follow_set_repeats(strut_follow_system *system, int32_t repeats,
                                      strut_error *error) {
  double value = system->value;
  if (repeats == system->how.repeats) return STRUT_OK;
  system->how.repeats = repeats;
  system->derivative.known = false;
  drop_model(system);
  return strut_follow_set_value(system, value, error);
}

strut_status strut_follow_set_steps(strut_follow_system *system, int64_t steps,
                                    strut_error *error) {
  double value = system->value;
  if (steps == system->how.steps_per_period) return STRUT_OK;
  system->how.steps_per_period = steps;
  system->derivative.known = false;
  drop_model(system);
  return strut_follow_set_value(system, value, error);
}

static bool allocate(strut_follow_system *system) {
  strut_arena *arena = &system->arena;
  size_t n = system->n, square = (n + 1) * (n + 1);
  return (system->place = strut_arena_allocate(arena, n, sizeof *system->place)) &&
         (system->along = strut_arena_allocate(arena, n, sizeof(double))) &&
         (system->derivative.jacobian = strut_arena_allocate(arena, square, sizeof(double))) &&
         (system->derivative.column = strut_arena_allocate(arena, n, sizeof(double))) &&
         (system->buffers.there = strut_arena_allocate(
              arena, (size_t)system->how.threads * system->both, sizeof(double))) &&
         (system->buffers.end = strut_arena_allocate(arena, system->both, sizeof(double))) &&
         (system->buffers.seen = strut_arena_allocate(arena, 4 * system->both, sizeof(double))) &&
         (system->buffers.matrix = strut_arena_allocate(arena, square, sizeof(double)));
}

static void choose_unknowns(strut_follow_system *system) {
  const strut_model *model = system->model;
  size_t k = 0, nodes = (size_t)model->node_count;
  for (size_t i = 0; i < 2 * nodes; i++) {
    if (model->fixed[i]) continue;
    system->place[k] = i;
    system->place[system->n / 2 + k] = (size_t)model->length + i;
    system->along[k] = system->travels ? model->contacts.tangent[i % 2] / sqrt((double)nodes) : 0.0;
    k++;
  }
}

strut_status strut_follow_open(strut_follow_system *system, double value, strut_error *error) {
  if (system->how.threads < 1) system->how.threads = 1;
  system->value = (double)NAN;
  system->n = system->both = 0;
  system->map =
      strut_arena_allocate(&system->arena, (size_t)system->how.threads, sizeof *system->map);
  if (!system->map) return strut_no_memory(error, "");
  strut_status status = strut_follow_set_value(system, value, error);
  if (status) return status;
  const strut_model *model = system->model;
  for (int32_t i = 0; i < 2 * model->node_count; i++) system->n += model->fixed[i] ? 0 : 2;
  system->both = 2 * (size_t)model->length + 1;
  system->travels = system->map[0].travels;
  if (system->n == 0 || system->n > STRUT_FOLLOW_MOST)
    return strut_fail(error, STRUT_USAGE,
                      "%zu free coordinates; motions are followed with 1 to %d of them",
                      system->n / 2, STRUT_FOLLOW_MOST / 2);
  if (!allocate(system)) return strut_no_memory(error, "");
  choose_unknowns(system);
  system->length = model->size;
  system->speed = model->size * STRUT_TAU / system->period;
  return STRUT_OK;
}

void strut_follow_close(strut_follow_system *system) {
  drop_model(system);
  strut_arena_free(&system->arena);
}

/* ---- the map ---- */

bool strut_follow_set_units(strut_follow_system *system, const double *unknowns) {
  const strut_model *model = system->model;
  strut_period_map *map = &system->map[0];
  double most = 0.0, at = map->time;
  int64_t steps = map->steps;
  int32_t repeats = map->repeats;
  double *here = system->buffers.end;
  memcpy(here, unknowns, system->both * sizeof(double));
  bool good = true;
  /* parts of a period that are whole steps, as the map takes them */
  map->repeats = 1;
  for (int k = 0; k < SAMPLES && good; k++) {
    int64_t from = steps * k / SAMPLES, to = steps * (k + 1) / SAMPLES;
    if (from == to) continue;
    map->steps = to - from;
    map->time = at + (double)from * map->dt;
    good = isfinite(strut_period_map_apply(map, here));
    for (int32_t i = 0; i < 2 * model->node_count; i++)
      most = fmax(most, fabs(here[i] - unknowns[i]));
  }
  map->steps = steps, map->time = at, map->repeats = repeats;
  if (!(most > 1e-9 * model->size)) most = 1e-3 * model->size;
  system->length = most;
  system->speed = most * STRUT_TAU / system->period;
  return good;
}

/* Range of each coordinate: ends of steps, and extrema of the cubics between them. */
static void watch_range(void *context, const strut_state *state) {
  strut_follow_system *system = context;
  size_t count = 2 * (size_t)system->model->node_count;
  double *low = system->buffers.seen, *high = low + count, *q = high + count, *v = q + count;
  double h = system->map[0].dt;
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
static double amplitude_of(const strut_follow_system *system) {
  size_t count = 2 * (size_t)system->model->node_count;
  int32_t node = system->setup.experiment.measure_node;
  double most = 0.0;
  for (size_t i = 0; i < count; i++)
    if (node < 0 || i / 2 == (size_t)node)
      most = fmax(most, system->buffers.seen[count + i] - system->buffers.seen[i]);
  return 0.5 * most;
}

strut_follow_period strut_follow_apply(strut_follow_system *system, double *unknowns, bool works) {
  strut_period_map *map = &system->map[0];
  strut_follow_period p = {0};
  map->state->balance = works;
  map->state->watched.event_log = works ? system->log : NULL;
  map->watch = works ? watch_range : NULL;
  map->watch_context = system;
  size_t count = 2 * (size_t)system->model->node_count, bytes = count * sizeof(double);
  for (int k = 0; k < 3; k++) memcpy(system->buffers.seen + (size_t)k * count, unknowns, bytes);
  memcpy(system->buffers.seen + 3 * count, unknowns + system->model->length, bytes);
  p.travel = strut_period_map_apply(map, unknowns);
  p.amplitude = works ? amplitude_of(system) : 0.0;
  map->watch = NULL;
  map->state->balance = false;
  map->state->watched.event_log = NULL;
  const double *w = map->state->work;
  p.work = works ? w[STRUT_POWER_DRIVE] + w[STRUT_POWER_LOAD] + w[STRUT_POWER_BELT] : 0.0;
  return p;
}

double strut_follow_change(const strut_follow_system *system, const double *unknowns,
                           const double *end, double *f) {
  double most = 0.0;
  for (size_t i = 0; i < system->n; i++) {
    f[i] = (end[system->place[i]] - unknowns[system->place[i]]) / strut_follow_unit(system, i);
    most = fmax(most, fabs(f[i]));
  }
  return most;
}

double strut_follow_residual(strut_follow_system *system, const double *unknowns, double *f) {
  memcpy(system->buffers.end, unknowns, system->both * sizeof(double));
  if (!isfinite(strut_follow_apply(system, system->buffers.end, false).travel)) return HUGE_VAL;
  return strut_follow_change(system, unknowns, system->buffers.end, f);
}

strut_follow_period strut_follow_carry(strut_follow_system *system, double *unknowns, bool works) {
  strut_variation *variation = system->variation;
  size_t n = system->n;
  strut_variation_reset(variation);
  system->map[0].state->watched.variation = variation;
  strut_follow_period p = strut_follow_apply(system, unknowns, works);
  system->map[0].state->watched.variation = NULL;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      system->derivative.jacobian[i * n + j] =
          variation->columns[i * (size_t)variation->stride + j] * strut_follow_unit(system, j) /
          strut_follow_unit(system, i);
  for (size_t j = 0; j < n && system->travels; j++) { /* the map takes the travel out */
    double shift = 0.0;
    for (size_t i = 0; i < n; i++)
      shift += system->along[i] * system->derivative.jacobian[i * n + j];
    for (size_t i = 0; i < n; i++)
      system->derivative.jacobian[i * n + j] -= shift * system->along[i];
  }
  system->derivative.known = isfinite(p.travel);
  return p;
}

void strut_follow_difference(strut_follow_system *system, const double *unknowns, bool *lost) {
  size_t n = system->n;
  int gone = 0;
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic) num_threads(system->how.threads) reduction(+ : gone)
#endif
  for (size_t j = 0; j < n; j++) {
#ifdef _OPENMP
    int t = omp_get_thread_num();
#else
    int t = 0;
#endif
    double *there = system->buffers.there + (size_t)t * system->both;
    for (int side = -1; side <= 1; side += 2) {
      memcpy(there, unknowns, system->both * sizeof(double));
      there[system->place[j]] += side * DIFFERENCE * strut_follow_unit(system, j);
      if (!isfinite(strut_period_map_apply(&system->map[t], there))) gone++;
      for (size_t i = 0; i < n; i++) {
        double moved = side * (there[system->place[i]] - unknowns[system->place[i]]) /
                       strut_follow_unit(system, i);
        double *entry = &system->derivative.jacobian[i * n + j];
        *entry = (side < 0 ? 0.0 : *entry) + moved / (2.0 * DIFFERENCE);
      }
    }
  }
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      system->derivative.jacobian[i * n + j] -= system->along[i] * system->along[j];
  *lost = gone > 0;
  system->derivative.known = !*lost;
}

strut_status strut_follow_differentiate(strut_follow_system *system, const double *unknowns,
                                        const double *f, bool *lost, strut_error *error) {
  memcpy(system->buffers.end, unknowns, system->both * sizeof(double));
  if (system->variation)
    *lost = !isfinite(strut_follow_carry(system, system->buffers.end, false).travel);
  else
    strut_follow_difference(system, unknowns, lost);
  return *lost ? STRUT_OK : strut_follow_differentiate_parameter(system, unknowns, f, lost, error);
}

strut_status strut_follow_differentiate_parameter(strut_follow_system *system,
                                                  const double *unknowns, const double *f,
                                                  bool *lost, strut_error *error) {
  size_t n = system->n;
  double value = system->value, step = PARAMETER_DIFFERENCE * (system->high - system->low);
  if (value + step > fmax(system->low, system->high)) step = -step;
  strut_status status = strut_follow_set_value(system, value + step, error);
  if (status) return status;
  *lost = !isfinite(strut_follow_residual(system, unknowns, system->derivative.column));
  for (size_t i = 0; i < n; i++)
    system->derivative.column[i] =
        (system->derivative.column[i] - f[i]) * (system->high - system->low) / step;
  return strut_follow_set_value(system, value, error);
}

/* ---- unknowns ---- */

void strut_follow_move(const strut_follow_system *system, double *unknowns, const double *change,
                       double factor) {
  for (size_t i = 0; i < system->n; i++)
    unknowns[system->place[i]] += factor * change[i] * strut_follow_unit(system, i);
}

void strut_follow_centre(const strut_follow_system *system, double *unknowns) {
  const strut_model *model = system->model;
  const double *t = model->contacts.tangent;
  double mean = 0.0;
  if (!system->travels) return;
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    mean += unknowns[i] * t[i % 2] / model->node_count;
  for (int32_t i = 0; i < 2 * model->node_count; i++) unknowns[i] -= mean * t[i % 2];
}

bool strut_follow_solve_with(const strut_follow_system *system, const strut_follow_border *border,
                             double *a, double *vector) {
  size_t n = system->n, m = n + border->count;
  double most = 0.0;
  for (size_t i = 0; i < n; i++) {
    for (size_t j = 0; j < n; j++) a[i * m + j] = system->derivative.jacobian[i * n + j] - (i == j);
    for (size_t k = 0; k < border->count; k++) a[i * m + n + k] = border->column[k][i];
  }
  for (size_t k = 0; k < border->count; k++)
    memcpy(a + (n + k) * m, border->row[k], m * sizeof(double));
  for (size_t i = 0; i < m * m; i++) most = fmax(most, fabs(a[i]));
  return strut_solve_dense(a, vector, m, 1e-14 * most);
}

bool strut_follow_solve(strut_follow_system *system, const double *normal, double *vector) {
  const strut_follow_border border = {1, {system->derivative.column}, {normal}};
  return strut_follow_solve_with(system, &border, system->buffers.matrix, vector);
}

void strut_follow_update(strut_follow_system *system, const strut_follow_border *border,
                         const double *f, const double *vector) {
  double size = 0.0;
  for (size_t j = 0; j < system->n + border->count; j++) size += vector[j] * vector[j];
  if (!(size > 0.0)) return;
  for (size_t i = 0; i < system->n; i++) {
    for (size_t j = 0; j < system->n; j++)
      system->derivative.jacobian[i * system->n + j] += f[i] * vector[j] / size;
    for (size_t k = 0; k < border->count; k++)
      border->column[k][i] += f[i] * vector[system->n + k] / size;
  }
}
