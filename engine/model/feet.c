/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/feet.h"

#include <math.h>

#include "engine/model/compile_parts.h"
#include "engine/model/model.h"

int32_t strut_foot_of_contact(const strut_scene *scene, size_t i) {
  for (size_t f = 0; f < scene->foot_count; f++)
    if (scene->feet[f].node == scene->contacts[i].node) return (int32_t)f;
  return -1;
}

/* Friction that sticks has no stick here: within its band it grows with the speed. */
static strut_friction friction_of(const strut_friction *f) {
  strut_friction own = *f;
  if (f->law != STRUT_FRICTION_KARNOPP) return own;
  own.law = STRUT_FRICTION_SMOOTH;
  own.width = f->stick_velocity;
  return own;
}

/* The place of a foot on the straight ground of contact i. */
static void place_element(const strut_contact_table *t, int32_t i, strut_element *e) {
  strut_contact_axes axes = t->axes;
  double point[2] = {0.0, t->height};
  if (t->surface) {
    const strut_facet *line = t->surface[t->surface_of[i]].facet;
    axes = line->axes;
    point[0] = line->point[0], point[1] = line->point[1];
  }
  double nx = axes.normal[0], ny = axes.normal[1];
  e->axis = tan(0.5 * atan2(ny, nx));
  e->natural = nx * point[0] + ny * point[1] + e->radius;
}

bool strut_feet_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_contact_table *t = &model->contacts;
  size_t count = 0;
  for (size_t i = 0; i < scene->contact_count; i++) count += strut_foot_of_contact(scene, i) >= 0;
  if (!count) return true;
  strut_foot_entry *item = strut_arena_allocate(&model->arena, count, sizeof *item);
  if (!item) return false;
  for (int32_t k = 0; k < model->elements.count; k++) {
    strut_element *e = (strut_element *)&model->elements.element[k];
    if (e->role != STRUT_ELEMENT_FOOT) continue;
    int32_t i = e->contact;
    strut_contact_entry *entry = (strut_contact_entry *)&t->entry[i];
    place_element(t, i, e);
    item[model->feet.count++] = (strut_foot_entry){
        k, i, t->surface ? t->surface[t->surface_of[i]].belt_speed : t->belt_speed,
        friction_of(&entry->friction)};
    /* the node itself touches nothing any more */
    entry->stiffness = entry->damping = entry->dissipation = 0.0;
    entry->friction = (strut_friction){STRUT_FRICTION_NONE};
  }
  model->feet.item = item;
  model->terms |= STRUT_TERM_FEET;
  return true;
}
