/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/orbit/orbit.h"

#include <assert.h>
#include <math.h>
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
  map->measure.grid = (strut_time_grid){.step = map->dt, .last = -1};
  map->method = strut_integrator_find(experiment->integrator);
  const strut_integrator_settings settings = strut_integrator_settings_of(experiment);
  strut_status status = strut_state_create(model, &map->state, error);
  if (!status) map->workspace = map->method->create(model, map->state, &settings);
  if (!status && (!map->workspace || strut_measure_create(model, experiment, 0, 0, &map->measure)))
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

static double mean_along(const strut_model *model, const double *positions) {
  const double *t = model->contacts.tangent;
  double sum = 0.0;
  for (int32_t i = 0; i < model->node_count; i++)
    sum += positions[2 * i] * t[0] + positions[2 * i + 1] * t[1];
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
         map->evaluations + map->state->latest->evaluations > map->most_evaluations;
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
  map->evaluations += state->latest->evaluations;
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

double strut_period_map_size(const strut_period_map *map, const double *change) {
  const strut_model *model = map->model;
  double speed = model->size * STRUT_TAU / map->period, most = 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i++) {
    most = fmax(most, fabs(change[i]) / model->size);
    most = fmax(most, fabs(change[model->length + i]) / speed);
  }
  return most;
}

void strut_period_map_subtract(const strut_period_map *map, const double *from, const double *to,
                               double *change) {
  const strut_model *model = map->model;
  const double *t = model->contacts.tangent;
  double along = 0.0;
  for (int32_t i = 0; i <= 2 * model->length; i++) change[i] = to[i] - from[i];
  for (int32_t i = 0; i < model->node_count && map->travels; i++)
    along += (change[2 * i] * t[0] + change[2 * i + 1] * t[1]) / model->node_count;
  for (int32_t i = 0; i < 2 * model->node_count; i++) change[i] -= along * t[i % 2];
}

void strut_period_map_free(strut_period_map *map) {
  strut_measure_free(&map->measure);
  strut_state_free(map->state);
  *map = (strut_period_map){.model = NULL};
}
