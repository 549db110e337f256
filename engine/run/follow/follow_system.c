/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/follow/follow.h"

#include <gsl/gsl_linalg.h>
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
  if (!strut_scene_signals_repeat(scene, period)) return -1;
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
  for (int i = 0; system->map && i < system->how.threads; i++)
    strut_period_map_free(&system->map[i]);
  strut_model_free(system->model);
  system->model = NULL;
  system->variation = NULL;
  strut_setup_free(&system->setup);
  system->value[0] = system->value[1] = (double)NAN;
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

static strut_status make_model(strut_follow_system *system, const double value[2],
                               strut_error *error) {
  strut_status status = system->scenes.setup(system->scenes.context, value, &system->setup, error);
  if (status) return status;
  status = strut_model_compile(&system->setup.scene, &system->model, error);
  if (status) return status;
  system->period = strut_experiment_span(&system->setup.experiment, &system->setup.scene).period;
  status = check_scene(system, error);
  if (!status && system->log && !has_same_structure(system))
    status =
        strut_fail(error, STRUT_USAGE,
                   "the parameter changes what the structure consists of, over which no motion "
                   "is followed");
  return status ? status : make_maps(system, error);
}

bool strut_follow_set_value(strut_follow_system *system, const double value[2]) {
  const double wanted[2] = {value[0], value[1]};
  if (system->status) return false;
  if (system->model && system->value[0] == value[0] && system->value[1] == value[1]) return true;
  drop_model(system);
  strut_status status = make_model(system, wanted, system->error);
  if (status) drop_model(system);
  /* in a plane some values may have no scene, where curves end */
  if (!(status == STRUT_BAD_SCENE && system->parameters == 2)) system->status = status;
  if (status) return false;
  memcpy(system->value, wanted, sizeof wanted);
  return true;
}

bool strut_follow_set_periods(strut_follow_system *system, int32_t repeats, int64_t steps) {
  const double value[2] = {system->value[0], system->value[1]};
  if (repeats == system->how.repeats && steps == system->how.steps_per_period)
    return !system->status;
  system->how.repeats = repeats;
  system->how.steps_per_period = steps;
  system->derivative.known = false;
  drop_model(system);
  return strut_follow_set_value(system, value);
}

void *strut_follow_allocate(strut_follow_system *system, strut_arena *arena, size_t count,
                            size_t size) {
  void *array = strut_arena_allocate(arena, count, size);
  if (!array && !system->status) system->status = strut_no_memory(system->error, "");
  return array;
}

static void allocate(strut_follow_system *system) {
  size_t n = system->n, m = system->m, both = system->both;
  const struct {
    double **array;
    size_t count;
  } arrays[] = {{&system->along, n},
                {&system->upward, m},
                {&system->derivative.jacobian, n * n},
                {&system->derivative.column[0], n},
                {&system->derivative.column[1], n},
                {&system->buffers.there, (size_t)system->how.threads * both},
                {&system->buffers.end, both},
                {&system->buffers.seen, 4 * both},
                {&system->buffers.matrix, m * m},
                {&system->buffers.trials, 2 * (both + n)},
                {&system->buffers.f, n},
                {&system->buffers.x, m}};
  system->place = strut_follow_allocate(system, &system->arena, n, sizeof *system->place);
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
    *arrays[i].array =
        strut_follow_allocate(system, &system->arena, arrays[i].count, sizeof(double));
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
  system->upward[system->m - 1] = 1.0;
}

strut_status strut_follow_open(strut_follow_system *system, const double value[2],
                               strut_error *error) {
  if (system->how.threads < 1) system->how.threads = 1;
  system->error = error;
  system->n = system->both = 0;
  system->map = strut_follow_allocate(system, &system->arena, (size_t)system->how.threads,
                                      sizeof *system->map);
  if (!system->map || !strut_follow_set_value(system, value)) return system->status;
  const strut_model *model = system->model;
  for (int32_t i = 0; i < 2 * model->node_count; i++) system->n += model->fixed[i] ? 0 : 2;
  system->m = system->n + system->parameters;
  system->both = 2 * (size_t)model->length + 1;
  system->travels = system->map[0].travels;
  if (system->n == 0 || system->n > STRUT_FOLLOW_MOST)
    return system->status =
               strut_fail(error, STRUT_USAGE,
                          "%zu free coordinates; motions are followed with 1 to %d of them",
                          system->n / 2, STRUT_FOLLOW_MOST / 2);
  allocate(system);
  if (system->status) return system->status;
  choose_unknowns(system);
  system->length = model->size;
  system->speed = model->size * STRUT_TAU / system->period;
  return STRUT_OK;
}

void strut_follow_close(strut_follow_system *system) {
  drop_model(system);
  strut_arena_free(&system->arena);
}

bool strut_follow_interrupted(strut_follow_system *system) {
  if (!system->how.interrupt || !*system->how.interrupt) return false;
  system->status = strut_fail(system->error, STRUT_INTERRUPTED,
                              "interrupted at %.9g of the parameter", system->value[0]);
  return true;
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

double strut_follow_extremum(double rise, double a, double b) {
  double c = 3.0 * rise - 2.0 * a - b, d = a + b - 2.0 * rise; /* slope a + 2 c x + 3 d x^2 */
  double root = sqrt(fmax(0.0, c * c - 3.0 * d * a));
  return -a / (c + (a < 0.0 ? root : -root));
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
    if (a * b < 0.0) {
      double c = 3.0 * rise - 2.0 * a - b, d = a + b - 2.0 * rise;
      double x = strut_follow_extremum(rise, a, b);
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

/* Fills the jacobian by central differences of whole runs. */
static bool difference(strut_follow_system *system, const double *unknowns) {
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
  return system->derivative.known = !gone;
}

bool strut_follow_differentiate_states(strut_follow_system *system,
                                       const strut_follow_motion *motion, double *f) {
  double *end = system->buffers.end;
  if (!strut_follow_set_value(system, motion->value)) return false;
  if (!system->variation)
    return isfinite(strut_follow_residual(system, motion->y, f)) && difference(system, motion->y);
  memcpy(end, motion->y, system->both * sizeof(double));
  bool lost = !isfinite(strut_follow_carry(system, end, false).travel);
  strut_follow_change(system, motion->y, end, f);
  return !lost;
}

bool strut_follow_differentiate_parameters(strut_follow_system *system,
                                           const strut_follow_motion *motion, const double *f) {
  bool lost = false;
  for (size_t k = 0; k < system->parameters && !lost; k++) {
    double *column = system->derivative.column[k];
    double range = system->high[k] - system->low[k], step = PARAMETER_DIFFERENCE * range;
    double beside[2] = {motion->value[0], motion->value[1]};
    if (beside[k] + step > system->high[k]) step = -step;
    beside[k] += step;
    lost = !strut_follow_set_value(system, beside) ||
           !isfinite(strut_follow_residual(system, motion->y, column)) ||
           strut_follow_interrupted(system);
    for (size_t i = 0; i < system->n; i++) column[i] = (column[i] - f[i]) * range / step;
  }
  return strut_follow_set_value(system, motion->value) && !lost;
}

/* ---- unknowns ---- */

void strut_follow_move(const strut_follow_system *system, strut_follow_motion *motion,
                       const double *change, double factor) {
  for (size_t i = 0; i < system->n; i++)
    motion->y[system->place[i]] += factor * change[i] * strut_follow_unit(system, i);
  for (size_t k = 0; k < system->parameters; k++)
    motion->value[k] += factor * change[system->n + k] * (system->high[k] - system->low[k]);
}

double strut_follow_between(const strut_follow_system *system, const strut_follow_motion *from,
                            const strut_follow_motion *to, double *change) {
  strut_follow_change(system, from->y, to->y, change);
  for (size_t k = 0; k < system->parameters; k++)
    change[system->n + k] = (to->value[k] - from->value[k]) / (system->high[k] - system->low[k]);
  return sqrt(strut_dot(change, change, (ptrdiff_t)system->m));
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

bool strut_follow_solve(strut_follow_system *system, const double *const rows[2], double *vector) {
  size_t n = system->n, m = system->m;
  double most = 0.0, *a = system->buffers.matrix;
  for (size_t i = 0; i < n; i++) {
    for (size_t j = 0; j < n; j++) a[i * m + j] = system->derivative.jacobian[i * n + j] - (i == j);
    for (size_t k = 0; n + k < m; k++) a[i * m + n + k] = system->derivative.column[k][i];
  }
  for (size_t k = 0; n + k < m; k++) memcpy(a + (n + k) * m, rows[k], m * sizeof(double));
  for (size_t i = 0; i < m * m; i++) most = fmax(most, fabs(a[i]));
  gsl_matrix_view matrix = gsl_matrix_view_array(a, m, m);
  gsl_vector_view right = gsl_vector_view_array(vector, m);
  gsl_permutation *order = gsl_permutation_alloc(m);
  int sign;
  bool regular = order && gsl_linalg_LU_decomp(&matrix.matrix, order, &sign) == 0;
  for (size_t i = 0; i < m && regular; i++) regular = fabs(a[i * m + i]) > 1e-14 * most;
  if (regular) gsl_linalg_LU_svx(&matrix.matrix, order, &right.vector);
  gsl_permutation_free(order);
  return regular;
}

void strut_follow_update(strut_follow_system *system, const double *f, const double *vector) {
  size_t n = system->n;
  double size = strut_dot(vector, vector, (ptrdiff_t)system->m);
  for (size_t i = 0; i < n && size > 0.0; i++) {
    for (size_t j = 0; j < n; j++)
      system->derivative.jacobian[i * n + j] += f[i] * vector[j] / size;
    for (size_t k = 0; k < system->parameters; k++)
      system->derivative.column[k][i] += f[i] * vector[n + k] / size;
  }
}
