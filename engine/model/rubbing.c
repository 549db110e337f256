/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/rubbing.h"

#include <math.h>

#include "engine/model/compile_parts.h"
#include "engine/model/model.h"

int32_t strut_foot_of_contact(const strut_scene *scene, size_t i) {
  for (size_t f = 0; f < scene->foot_count; f++)
    if (scene->feet[f].node == scene->contacts[i].node) return (int32_t)f;
  return -1;
}

bool strut_contact_is_element(const strut_scene *scene, size_t i) {
  return strut_friction_has_bristles(scene->contacts[i].friction.law) ||
         strut_foot_of_contact(scene, i) >= 0;
}

size_t strut_bristle_count(const strut_scene *scene) {
  size_t count = 0;
  for (size_t i = 0; i < scene->contact_count; i++)
    count += strut_friction_has_bristles(scene->contacts[i].friction.law);
  return count;
}

/* Friction that sticks has no stick here: within its band it grows with the speed. */
static strut_friction friction_of(const strut_friction *friction) {
  strut_friction own = *friction;
  if (friction->law != STRUT_FRICTION_KARNOPP) return own;
  own.law = STRUT_FRICTION_SMOOTH;
  own.width = friction->stick_velocity;
  return own;
}

/* The place of a foot on the straight ground of contact i. */
static void place_element(const strut_contact_table *contacts, int32_t i, strut_element *element) {
  strut_contact_axes axes = contacts->axes;
  double point[2] = {0.0, contacts->height};
  if (contacts->surface) {
    const strut_facet *line = contacts->surface[contacts->surface_of[i]].facet;
    axes = line->axes;
    point[0] = line->point[0], point[1] = line->point[1];
  }
  double nx = axes.normal[0], ny = axes.normal[1];
  element->axis = tan(0.5 * atan2(ny, nx));
  element->natural = nx * point[0] + ny * point[1] + element->radius;
}

/* Friction of element k, instead of the contact of its node, which touches nothing any more. */
static strut_rubbing_entry take_contact(strut_model *model, int32_t k) {
  strut_contact_table *contacts = &model->contacts;
  strut_element *element = (strut_element *)&model->elements.element[k];
  int32_t i = element->contact;
  strut_contact_entry *entry = (strut_contact_entry *)&contacts->entry[i];
  place_element(contacts, i, element);
  bool bristles = strut_friction_has_bristles(entry->friction.law);
  const strut_feedback_table *feedback = &model->feedback;
  int32_t bend =
      feedback->base + feedback->state_count - feedback->bristle_count + model->rubbing.bristles;
  model->rubbing.bristles += bristles;
  const strut_rubbing_entry item = {k, i, bristles ? bend : -1,
                                    contacts->surface
                                        ? contacts->surface[contacts->surface_of[i]].belt_speed
                                        : contacts->belt_speed,
                                    friction_of(&entry->friction)};
  entry->stiffness = entry->damping = entry->dissipation = 0.0;
  entry->friction = (strut_friction){STRUT_FRICTION_NONE};
  return item;
}

bool strut_collisions_rub(const strut_scene *scene) {
  for (size_t i = 0; i < scene->collision_count; i++)
    if (scene->collisions[i].friction.mu_kinetic > 0.0) return true;
  return false;
}

/* Smooth friction, or with a coefficient that falls from the static one, Stribeck's. */
static strut_friction friction_of_collision(const strut_collision *collision) {
  strut_friction own = collision->friction;
  own.law = own.decay_velocity > 0.0 ? STRUT_FRICTION_STRIBECK : STRUT_FRICTION_SMOOTH;
  return own;
}

bool strut_rubbing_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_rubbing_entry *item =
      strut_arena_allocate(&model->arena, (size_t)model->elements.count, sizeof *item);
  int32_t *of = strut_arena_allocate(&model->arena, (size_t)model->elements.count, sizeof *of);
  int32_t *at_contact =
      strut_arena_allocate(&model->arena, (size_t)model->contacts.count, sizeof *at_contact);
  if (!item || !of || !at_contact) return false;
  for (int32_t i = 0; i < model->contacts.count; i++) at_contact[i] = -1;
  for (int32_t k = 0; k < model->elements.count; k++) {
    int32_t before = model->rubbing.count;
    const strut_element *element = &model->elements.element[k];
    const strut_collision *collision =
        element->role == STRUT_ELEMENT_COLLISION ? &scene->collisions[element->item] : NULL;
    if (element->strain == STRUT_STRAIN_FOOT) item[model->rubbing.count++] = take_contact(model, k);
    if (collision && collision->friction.mu_kinetic > 0.0)
      item[model->rubbing.count++] =
          (strut_rubbing_entry){k, -1, -1, 0.0, friction_of_collision(collision)};
    of[k] = model->rubbing.count > before ? before : -1;
    if (of[k] >= 0 && item[before].contact >= 0) at_contact[item[before].contact] = before;
  }
  model->rubbing.item = item, model->rubbing.of_element = of;
  model->rubbing.of_contact = at_contact;
  if (model->rubbing.count) model->terms |= STRUT_TERM_RUBBING;
  return true;
}
