/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models of the scene besides its own, and which methods can run them. */
#include <math.h>
#include <stdio.h>

#include "engine/study/tradeoff/tradeoff_parts.h"

/* All variants in the order in which they run: the most expensive last. */
typedef enum kind { OWN, MASS, RIGID, GROUND, KARNOPP, COULOMB, SMOOTH, KINDS } kind;

static bool has_member_mass(const strut_scene *scene) {
  for (size_t i = 0; i < scene->member_count; i++)
    if (scene->members[i].mass > 0) return true;
  return false;
}

/* True if there are bars and none is driven, so that they could be rigid. */
static bool has_still_bars(const strut_scene *scene) {
  bool any = false;
  for (size_t i = 0; i < scene->member_count; i++) any = any || scene->members[i].kind == STRUT_BAR;
  for (size_t i = 0; i < scene->actuator_count; i++)
    any = any && (scene->actuators[i].member < 0 || scene->actuators[i].force ||
                  scene->members[scene->actuators[i].member].kind != STRUT_BAR);
  return any;
}

static bool has_friction(const strut_scene *scene, strut_friction_law law) {
  for (size_t i = 0; i < scene->contact_count; i++)
    if (scene->contacts[i].friction.law == law) return true;
  return false;
}

static bool has_any_friction(const strut_scene *scene) {
  for (size_t i = 0; i < scene->contact_count; i++)
    if (scene->contacts[i].friction.law != STRUT_FRICTION_NONE) return true;
  return false;
}

/* Depth of a contact at rest if all contacts shared the weight equally [m]; 0 without gravity. */
static double depth_at_rest(const strut_scene *scene, const strut_contact *contact) {
  double mass = 0, gravity = hypot(scene->gravity[0], scene->gravity[1]);
  for (size_t i = 0; i < scene->node_count; i++) mass += scene->nodes[i].mass;
  for (size_t i = 0; i < scene->member_count; i++) mass += scene->members[i].mass;
  return mass * gravity / (contact->stiffness * (double)scene->contact_count);
}

static bool has_damped_ground(const strut_scene *scene) {
  bool any = false;
  for (size_t i = 0; i < scene->contact_count; i++) {
    const strut_contact *contact = &scene->contacts[i];
    any = any || contact->damping > 0 || contact->dissipation > 0;
    if (!(depth_at_rest(scene, contact) > 0)) return false;
  }
  return any;
}

static bool makes_sense(const strut_scene *scene, kind what) {
  switch (what) {
    case OWN: return true;
    case MASS: return has_member_mass(scene);
    case RIGID: return has_still_bars(scene) && !scene->ground_count;
    case KARNOPP: return has_any_friction(scene) && !has_friction(scene, STRUT_FRICTION_KARNOPP);
    case COULOMB: return has_any_friction(scene) && !has_friction(scene, STRUT_FRICTION_COULOMB);
    case SMOOTH: return has_any_friction(scene) && !has_friction(scene, STRUT_FRICTION_SMOOTH);
    case GROUND:
      return scene->contact_count > 0 && !scene->ground_count && has_damped_ground(scene);
    case KINDS: break;
  }
  return false;
}

/* The regularisation speed for friction laws that need one [m/s]. */
static double regularisation_speed(const tradeoff_study *study, const strut_friction *friction) {
  if (friction->stick_velocity > 0) return friction->stick_velocity;
  return friction->width > 0 ? friction->width : study->scale[0];
}

static void describe(const tradeoff_study *study, kind what, strut_model_variant *variant) {
  const strut_scene *scene = &study->setups[0]->scene;
  if (what == OWN) snprintf(variant->name, sizeof variant->name, "unchanged model");
  if (what == COULOMB) snprintf(variant->name, sizeof variant->name, "Coulomb friction");
  if (what == MASS)
    snprintf(variant->name, sizeof variant->name, "%s masses",
             scene->mass_model == STRUT_MASS_LUMPED ? "consistent" : "lumped");
  if (what == RIGID)
    snprintf(variant->name, sizeof variant->name, "%s bars",
             scene->bar_model == STRUT_BARS_RIGID ? "elastic" : "rigid");
  if (what == KARNOPP || what == SMOOTH) {
    double speed = regularisation_speed(study, &scene->contacts[0].friction);
    snprintf(variant->name, sizeof variant->name, "%s friction, %s",
             what == SMOOTH ? "smooth" : "Karnopp", strut_quantity_of(speed, 3, "m/s").text);
  }
  if (what != GROUND) return;
  bool printed = scene->ground.damping_law == STRUT_DAMPING_APPROACH;
  snprintf(variant->name, sizeof variant->name, "%s",
           printed ? "Hunt-Crossley ground" : "approach-only ground damping");
  snprintf(variant->remark, sizeof variant->remark,
           "damped as by the scene's law at the depth at which the ground carries the weight, %s",
           strut_quantity_of(depth_at_rest(scene, &scene->contacts[0]), 3, "m").text);
}

/* The kind of the i-th variant in the list. */
static kind kind_of(const tradeoff_study *study, int variant) {
  int found = -1;
  for (int what = OWN; what < KINDS; what++)
    if (makes_sense(&study->setups[0]->scene, (kind)what) && ++found == variant) return (kind)what;
  return OWN;
}

strut_status strut_tradeoff_list_variants(tradeoff_study *study) {
  strut_tradeoff *tradeoff = study->result;
  bool all = !study->options->own_model && tradeoff->measure != STRUT_TRADEOFF_ENERGY;
  tradeoff->variants = strut_arena_allocate(&tradeoff->arena, KINDS, sizeof *tradeoff->variants);
  if (!tradeoff->variants) return STRUT_NO_MEMORY;
  for (int what = OWN; what < KINDS; what++) {
    if (!makes_sense(&study->setups[0]->scene, (kind)what) || (what != OWN && !all)) continue;
    strut_model_variant *variant = &tradeoff->variants[tradeoff->variant_count++];
    describe(study, (kind)what, variant);
    variant->value = strut_arena_allocate(
        &tradeoff->arena, tradeoff->point_count * tradeoff->value_count, sizeof *variant->value);
    variant->floor =
        strut_arena_allocate(&tradeoff->arena, tradeoff->point_count, sizeof *variant->floor);
    variant->model_error =
        strut_arena_allocate(&tradeoff->arena, tradeoff->point_count, sizeof *variant->model_error);
    if (!variant->value || !variant->floor || !variant->model_error) return STRUT_NO_MEMORY;
  }
  return STRUT_OK;
}

static void change_contact(const tradeoff_study *study, kind what, const strut_scene *scene,
                           strut_contact *contact) {
  double depth = depth_at_rest(scene, contact), slope = contact->stiffness * depth;
  bool rough = contact->friction.law != STRUT_FRICTION_NONE;
  double speed = regularisation_speed(study, &contact->friction);
  if (what == GROUND && scene->ground.damping_law == STRUT_DAMPING_HUNT_CROSSLEY)
    contact->dissipation = contact->damping / slope;
  else if (what == GROUND)
    contact->damping = contact->dissipation * slope;
  if (!rough) return;
  if (what == KARNOPP) contact->friction.law = STRUT_FRICTION_KARNOPP;
  if (what == COULOMB) contact->friction.law = STRUT_FRICTION_COULOMB;
  if (what == SMOOTH) contact->friction.law = STRUT_FRICTION_SMOOTH;
  if (what == KARNOPP) contact->friction.stick_velocity = speed;
  if (what == SMOOTH) contact->friction.width = speed;
}

strut_status strut_tradeoff_change_scene(const tradeoff_study *study, int variant,
                                         strut_scene *scene, strut_arena *arena) {
  kind what = kind_of(study, variant);
  if (what == MASS)
    scene->mass_model =
        scene->mass_model == STRUT_MASS_LUMPED ? STRUT_MASS_CONSISTENT : STRUT_MASS_LUMPED;
  if (what == RIGID)
    scene->bar_model = scene->bar_model == STRUT_BARS_RIGID ? STRUT_BARS_ELASTIC : STRUT_BARS_RIGID;
  if (what < GROUND) return STRUT_OK;
  strut_contact *contacts = strut_arena_allocate(arena, scene->contact_count, sizeof *contacts);
  if (!contacts) return STRUT_NO_MEMORY;
  if (what == GROUND)
    scene->ground.damping_law = scene->ground.damping_law == STRUT_DAMPING_APPROACH
                                    ? STRUT_DAMPING_HUNT_CROSSLEY
                                    : STRUT_DAMPING_APPROACH;
  for (size_t i = 0; i < scene->contact_count; i++) {
    contacts[i] = scene->contacts[i];
    change_contact(study, what, scene, &contacts[i]);
  }
  scene->contacts = contacts;
  return STRUT_OK;
}

bool strut_tradeoff_has_switches(const strut_scene *scene) {
  for (size_t i = 0; i < scene->member_count; i++)
    if (scene->members[i].kind == STRUT_CABLE) return true;
  return scene->contact_count > 0;
}

bool strut_tradeoff_can_run(const tradeoff_study *study, const strut_integrator *method,
                            int variant) {
  kind what = kind_of(study, variant);
  bool own = has_friction(&study->setups[0]->scene, STRUT_FRICTION_COULOMB);
  bool exact = own ? what <= GROUND : what == COULOMB;
  if (exact && !method->events) return false;
  return !method->events || strut_tradeoff_is_adaptive(method) ||
         strut_tradeoff_has_switches(&study->setups[0]->scene);
}

bool strut_tradeoff_is_wanted(const tradeoff_study *study, const strut_integrator *method,
                              int variant) {
  bool wanted = study->options->method_count == 0;
  for (size_t i = 0; i < study->options->method_count; i++)
    wanted = wanted || study->options->methods[i] == method;
  return wanted && strut_tradeoff_can_run(study, method, variant);
}
