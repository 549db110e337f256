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

static size_t count_laws(const strut_scene *scene, strut_friction_law law) {
  size_t count = 0;
  for (size_t i = 0; i < scene->contact_count; i++) count += scene->contacts[i].friction.law == law;
  return count;
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

/* What the contacts of the last three have. */
static const strut_friction_law law_of[KINDS] = {[KARNOPP] = STRUT_FRICTION_KARNOPP,
                                                 [COULOMB] = STRUT_FRICTION_COULOMB,
                                                 [SMOOTH] = STRUT_FRICTION_SMOOTH};

static bool makes_sense(const strut_scene *scene, kind what) {
  if (what == OWN) return true;
  if (what == MASS) return has_member_mass(scene);
  if (what == RIGID) return has_still_bars(scene) && !scene->ground_count;
  if (what == GROUND)
    return scene->contact_count > 0 && !scene->ground_count && has_damped_ground(scene);
  bool rough = count_laws(scene, STRUT_FRICTION_NONE) < scene->contact_count;
  return rough && !count_laws(scene, law_of[what]);
}

/* The regularisation speed for friction laws that need one [m/s]. */
static double regularisation_speed(const tradeoff_study *study, const strut_friction *friction) {
  if (friction->stick_velocity > 0) return friction->stick_velocity;
  return friction->width > 0 ? friction->width : study->points[0].scale;
}

static void describe(const tradeoff_study *study, kind what, strut_model_variant *variant) {
  const strut_scene *scene = &study->setups[0]->scene;
  const bool lumped = scene->mass_model == STRUT_MASS_LUMPED,
             rigid = scene->bar_model == STRUT_BARS_RIGID,
             approach = scene->ground.damping_law == STRUT_DAMPING_APPROACH;
  const char *const names[KINDS] = {
      [OWN] = "unchanged model",
      [MASS] = lumped ? "consistent masses" : "lumped masses",
      [RIGID] = rigid ? "elastic bars" : "rigid bars",
      [GROUND] = approach ? "Hunt-Crossley ground" : "approach-only ground damping",
      [KARNOPP] = "Karnopp friction, ",
      [COULOMB] = "Coulomb friction",
      [SMOOTH] = "smooth friction, "};
  strut_rounded_quantity speed = {""};
  if (what == KARNOPP || what == SMOOTH)
    speed = strut_quantity_of(regularisation_speed(study, &scene->contacts[0].friction), 3, "m/s");
  snprintf(variant->name, sizeof variant->name, "%s%s", names[what], speed.text);
  if (what != GROUND) return;
  snprintf(variant->remark, sizeof variant->remark,
           "damped as by the scene's law at the depth at which the ground carries the weight, %s",
           strut_quantity_of(depth_at_rest(scene, &scene->contacts[0]), 3, "m").text);
}

/* The kind of the i-th variant; the unchanged model may be run before they are listed. */
static kind kind_of(const tradeoff_study *study, int variant) {
  return variant ? (kind)study->result->variants[variant].kind : OWN;
}

void strut_tradeoff_list_variants(tradeoff_study *study) {
  strut_tradeoff *tradeoff = study->result;
  const size_t points = tradeoff->point_count;
  bool all = !study->options->own_model && tradeoff->measure != STRUT_TRADEOFF_ENERGY;
  tradeoff->variants = strut_tradeoff_allocate(study, KINDS, sizeof *tradeoff->variants);
  for (int what = OWN; what < KINDS && !study->status; what++) {
    if (!makes_sense(&study->setups[0]->scene, (kind)what) || (what != OWN && !all)) continue;
    strut_model_variant *variant = &tradeoff->variants[tradeoff->variant_count++];
    variant->kind = what;
    describe(study, (kind)what, variant);
    variant->floor =
        strut_tradeoff_allocate(study, points * (tradeoff->value_count + 2), sizeof(double));
    if (study->status) return;
    variant->model_error = variant->floor + points;
    variant->value = variant->model_error + points;
  }
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
  if (what > GROUND) contact->friction.law = law_of[what];
  if (what == KARNOPP) contact->friction.stick_velocity = speed;
  if (what == SMOOTH) contact->friction.width = speed;
}

/* Changes a scene into that of a variant; new contacts come from the arena. */
static strut_status change_scene(const tradeoff_study *study, int variant, strut_scene *scene,
                                 strut_arena *arena) {
  kind what = kind_of(study, variant);
  if (what == MASS)
    scene->mass_model =
        scene->mass_model == STRUT_MASS_LUMPED ? STRUT_MASS_CONSISTENT : STRUT_MASS_LUMPED;
  if (what == RIGID)
    scene->bar_model = scene->bar_model == STRUT_BARS_RIGID ? STRUT_BARS_ELASTIC : STRUT_BARS_RIGID;
  if (what < GROUND) return STRUT_OK;
  strut_contact *contacts = strut_arena_allocate(arena, scene->contact_count, sizeof *contacts);
  if (!contacts) return strut_no_memory(study->error, "");
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

strut_status strut_tradeoff_compile(const tradeoff_study *study, size_t point, int variant,
                                    const strut_model **model) {
  tradeoff_model *self = &study->models[point * TRADEOFF_VARIANTS + (size_t)variant];
  strut_status status = STRUT_OK;
  if (!self->model) {
    self->scene = study->setups[point]->scene;
    status = change_scene(study, variant, &self->scene, &self->arena);
    if (!status) status = strut_model_compile(&self->scene, &self->model, study->error);
  }
  *model = self->model;
  return status;
}

bool strut_tradeoff_has_switches(const strut_scene *scene) {
  for (size_t i = 0; i < scene->member_count; i++)
    if (scene->members[i].kind == STRUT_CABLE) return true;
  return scene->contact_count > 0;
}

bool strut_tradeoff_can_run(const tradeoff_study *study, const strut_integrator *method,
                            int variant) {
  kind what = kind_of(study, variant);
  bool own = count_laws(&study->setups[0]->scene, STRUT_FRICTION_COULOMB);
  bool exact = own ? what <= GROUND : what == COULOMB;
  if (exact && !method->events) return false;
  return !method->events || strut_tradeoff_is_adaptive(method) ||
         strut_tradeoff_has_switches(&study->setups[0]->scene);
}
