/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/feedback_compile.h"

static int32_t find_contact(const strut_model *model, int32_t node) {
  for (int32_t i = 0; i < model->contacts.count; i++)
    if (model->contacts.entry[i].node == node) return i;
  return -1;
}

static strut_sensor_entry compile_sensor(const strut_model *model, const strut_sensor *s) {
  strut_sensor_entry entry = {s->kind, s->item};
  switch (s->kind) {
    case STRUT_SENSOR_ANGLE: entry.at = strut_element_of_hinge(&model->elements, s->item); break;
    case STRUT_SENSOR_CONTACT: entry.at = find_contact(model, s->item); break;
    case STRUT_SENSOR_POSITION:
    case STRUT_SENSOR_VELOCITY: entry.at = 2 * s->item + (int32_t)s->along; break;
    case STRUT_SENSOR_ENERGY: entry.at = (int32_t)s->energy; break;
    case STRUT_SENSOR_LENGTH:
    case STRUT_SENSOR_FORCE:
    case STRUT_SENSOR_KINDS: break;
  }
  return entry;
}

bool strut_feedback_compile(strut_model *model) {
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
  if (f->count) model->plan |= STRUT_TERM_FEEDBACK;
  return true;
}
