/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/compile_parts.h"

static int32_t find_contact(const strut_model *model, int32_t node) {
  for (int32_t i = 0; i < model->contacts.count; i++)
    if (model->contacts.entry[i].node == node) return i;
  return -1;
}

static strut_sensor_entry compile_sensor(const strut_model *model, const strut_sensor *s) {
  strut_sensor_entry entry = {s->kind, s->item};
  switch (s->kind) {
    case STRUT_SENSOR_ANGLE:
      entry.at = strut_element_find(&model->elements, STRUT_ELEMENT_HINGE, s->item);
      break;
    case STRUT_SENSOR_CONTACT_FORCE:
    case STRUT_SENSOR_CONTACT: entry.at = find_contact(model, s->item); break;
    case STRUT_SENSOR_AREA:
    case STRUT_SENSOR_PRESSURE:
      entry.at = strut_element_find(&model->elements, STRUT_ELEMENT_CELL, s->item);
      break;
    case STRUT_SENSOR_DISTANCE:
      entry.at = strut_element_find(&model->elements, STRUT_ELEMENT_DISTANCE, s->item);
      break;
    case STRUT_SENSOR_COLLISION_FORCE:
      entry.at = strut_element_find(&model->elements, STRUT_ELEMENT_COLLISION, s->item);
      break;
    case STRUT_SENSOR_POSITION:
    case STRUT_SENSOR_VELOCITY: entry.at = 2 * s->item + (int32_t)s->along; break;
    case STRUT_SENSOR_ENERGY: entry.at = (int32_t)s->energy; break;
    case STRUT_SENSOR_LENGTH:
    case STRUT_SENSOR_FORCE:
    case STRUT_SENSOR_KINDS: break;
  }
  return entry;
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
  strut_feedback_table *f = &model->feedback;
  size_t count = 0;
  for (size_t i = 0; i < scene->member_count; i++)
    count += scene->members[i].maxwell.stiffness > 0.0;
  strut_maxwell_entry *entry = strut_arena_allocate(&model->arena, count, sizeof *entry);
  if (!entry) return false;
  for (size_t i = 0; i < scene->member_count; i++) {
    const strut_maxwell *m = &scene->members[i].maxwell;
    if (!(m->stiffness > 0.0)) continue;
    int32_t state = (int32_t)scene->state_count + f->lag_count + f->maxwell_count;
    double damping = m->time > 0.0 ? m->stiffness * m->time : m->damping;
    entry[f->maxwell_count++] = (strut_maxwell_entry){(int32_t)i, state, m->stiffness, damping};
    ((double *)model->velocity)[f->base + state] = m->force;
  }
  f->maxwell = entry;
  return true;
}

static bool compile_sensors(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_feedback_table *f = &model->feedback;
  strut_sensor_entry *sensor =
      strut_arena_allocate(&model->arena, scene->sensor_count, sizeof *sensor);
  if (!sensor) return false;
  for (size_t i = 0; i < scene->sensor_count; i++) {
    sensor[i] = compile_sensor(model, &scene->sensors[i]);
    if (strut_sensor_needs_drives(sensor[i].kind)) f->needs_drives = true;
  }
  f->count = (int32_t)scene->sensor_count;
  f->sensor = sensor;
  return true;
}

bool strut_feedback_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_feedback_table *f = &model->feedback;
  size_t signals = scene->signal_count;
  int32_t *lagged = strut_arena_allocate(&model->arena, signals, sizeof *lagged);
  int32_t *lag_of = strut_arena_allocate(&model->arena, signals, sizeof *lag_of);
  int32_t *sampled = strut_arena_allocate(&model->arena, signals, sizeof *sampled);
  int32_t *triggered = strut_arena_allocate(&model->arena, signals, sizeof *triggered);
  int32_t *relay = strut_arena_allocate(&model->arena, signals, sizeof *relay);
  if (!lagged || !lag_of || !sampled || !triggered || !relay || !compile_sensors(model))
    return false;
  for (size_t i = 0; i < signals; i++) {
    const strut_signal *s = &scene->signals[i];
    lag_of[i] = s->lag > 0.0 ? (int32_t)scene->state_count + f->lag_count : -1;
    if (s->lag > 0.0) lagged[f->lag_count++] = (int32_t)i;
    if (s->trigger.kind != STRUT_TRIGGER_NONE) triggered[f->trigger_count++] = (int32_t)i;
    if (s->every > 0.0)
      sampled[f->sampled_count++] = (int32_t)i;
    else if (s->kind == STRUT_RELAY)
      relay[f->relay_count++] = (int32_t)i;
  }
  f->lagged = lagged, f->lag_of = lag_of, f->sampled = sampled, f->triggered = triggered;
  f->relay = relay;
  f->state_count = (int32_t)strut_feedback_states(scene);
  f->bristle_count = (int32_t)strut_bristle_count(scene);
  f->base = 2 * model->node_count + 2;
  if (!compile_maxwell(model)) return false;
  double *velocity = (double *)model->velocity;
  for (size_t i = 0; i < scene->state_count; i++)
    velocity[(size_t)f->base + i] = scene->states[i].start;
  for (int32_t i = 0; i < f->state_count; i++) ((uint8_t *)model->fixed)[f->base + i] = 1;
  if (f->count || f->state_count || f->sampled_count || f->trigger_count || f->relay_count)
    model->terms |= STRUT_TERM_FEEDBACK;
  return true;
}
