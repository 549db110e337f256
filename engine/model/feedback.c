/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/compile_parts.h"

strut_column strut_column_find(const strut_model *model, strut_column column, int32_t near) {
  static const strut_element_role roles[STRUT_OWNER_COUNT] = {
      [STRUT_OWNER_HINGE] = STRUT_ELEMENT_HINGE,
      [STRUT_OWNER_CELL] = STRUT_ELEMENT_CELL,
      [STRUT_OWNER_COLLISION] = STRUT_ELEMENT_COLLISION,
      [STRUT_OWNER_DISTANCE] = STRUT_ELEMENT_DISTANCE};
  const strut_contact_table *contacts = &model->contacts;
  strut_channel_owner owner = strut_observable_at(column.kind)->owner;
  if (roles[owner])
    column.item = strut_element_find_near(&model->elements, roles[owner], column.item, near);
  if (owner != STRUT_OWNER_CONTACT) return column;
  int32_t first = 0;
  while (first < contacts->count && contacts->entry[first].node != column.item) first++;
  int32_t end = first;
  while (end < contacts->count && contacts->at[end] == contacts->at[first]) end++;
  column.item = first, column.other = end;
  return column;
}

size_t strut_feedback_states(const strut_scene *scene) {
  size_t count = scene->state_count;
  for (size_t i = 0; i < scene->signal_count; i++) count += scene->signals[i].lag > 0.0;
  for (size_t i = 0; i < scene->member_count; i++)
    count += scene->members[i].maxwell.stiffness > 0.0;
  return count + strut_bristle_count(scene);
}

static bool compile_maxwell(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_feedback_table *feedback = &model->feedback;
  size_t count = 0;
  for (size_t i = 0; i < scene->member_count; i++)
    count += scene->members[i].maxwell.stiffness > 0.0;
  strut_maxwell_entry *entry = strut_arena_allocate(&model->arena, count, sizeof *entry);
  if (!entry) return false;
  for (size_t i = 0; i < scene->member_count; i++) {
    const strut_maxwell *maxwell = &scene->members[i].maxwell;
    if (!(maxwell->stiffness > 0.0)) continue;
    int32_t state = (int32_t)scene->state_count + feedback->lag_count + feedback->maxwell_count;
    double damping = maxwell->time > 0.0 ? maxwell->stiffness * maxwell->time : maxwell->damping;
    entry[feedback->maxwell_count++] =
        (strut_maxwell_entry){(int32_t)i, state, maxwell->stiffness, damping};
    ((double *)model->velocity)[feedback->base + state] = maxwell->force;
  }
  feedback->maxwell = entry;
  return true;
}

static bool compile_sensors(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_feedback_table *feedback = &model->feedback;
  strut_column *sensor = strut_arena_allocate(&model->arena, scene->sensor_count, sizeof *sensor);
  if (!sensor) return false;
  for (size_t i = 0; i < scene->sensor_count; i++) {
    sensor[i] = strut_column_find(model, strut_sensor_column(&scene->sensors[i]), 0);
    if (strut_column_needs_drives(sensor[i])) feedback->needs_drives = true;
  }
  feedback->count = (int32_t)scene->sensor_count;
  feedback->sensor = sensor;
  return true;
}

bool strut_feedback_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_feedback_table *feedback = &model->feedback;
  size_t signals = scene->signal_count;
  int32_t *lagged = strut_arena_allocate(&model->arena, signals, sizeof *lagged);
  int32_t *lag_of = strut_arena_allocate(&model->arena, signals, sizeof *lag_of);
  int32_t *sampled = strut_arena_allocate(&model->arena, signals, sizeof *sampled);
  int32_t *triggered = strut_arena_allocate(&model->arena, signals, sizeof *triggered);
  int32_t *relay = strut_arena_allocate(&model->arena, signals, sizeof *relay);
  if (!lagged || !lag_of || !sampled || !triggered || !relay || !compile_sensors(model))
    return false;
  for (size_t i = 0; i < signals; i++) {
    const strut_signal *signal = &scene->signals[i];
    lag_of[i] = signal->lag > 0.0 ? (int32_t)scene->state_count + feedback->lag_count : -1;
    if (signal->lag > 0.0) lagged[feedback->lag_count++] = (int32_t)i;
    if (signal->trigger.kind != STRUT_TRIGGER_NONE)
      triggered[feedback->trigger_count++] = (int32_t)i;
    if (signal->every > 0.0)
      sampled[feedback->sampled_count++] = (int32_t)i;
    else if (signal->kind == STRUT_RELAY)
      relay[feedback->relay_count++] = (int32_t)i;
  }
  feedback->lagged = lagged, feedback->lag_of = lag_of, feedback->sampled = sampled,
  feedback->triggered = triggered;
  feedback->relay = relay;
  feedback->state_count = (int32_t)strut_feedback_states(scene);
  feedback->bristle_count = (int32_t)strut_bristle_count(scene);
  feedback->base = 2 * model->node_count + 2;
  if (!compile_maxwell(model)) return false;
  double *velocity = (double *)model->velocity;
  for (size_t i = 0; i < scene->state_count; i++)
    velocity[(size_t)feedback->base + i] = scene->states[i].start;
  for (int32_t i = 0; i < feedback->state_count; i++)
    ((uint8_t *)model->fixed)[feedback->base + i] = 1;
  if (feedback->count || feedback->state_count || feedback->sampled_count ||
      feedback->trigger_count || feedback->relay_count)
    model->terms |= STRUT_TERM_FEEDBACK;
  return true;
}
