/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which models of a scene make sense, and how a scene is changed into each. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/quantity_text.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

/* All there can be, in the order in which they are run: the dearest last. */
typedef enum kind { OWN, MASS, RIGID, GROUND, KARNOPP, COULOMB, SMOOTH, KINDS } kind;

static bool has_member_mass(const strut_scene *scene) {
  for (size_t i = 0; i < scene->member_count; i++)
    if (scene->members[i].mass > 0) return true;
  return false;
}

/* Whether there are bars that could be rigid: none of them is driven. */
static bool has_still_bars(const strut_scene *scene) {
  bool any = false;
  for (size_t i = 0; i < scene->member_count; i++) any = any || scene->members[i].kind == STRUT_BAR;
  for (size_t i = 0; i < scene->actuator_count; i++)
    any = any && scene->members[scene->actuators[i].member].kind != STRUT_BAR;
  return any;
}

static bool has_friction(const strut_scene *scene, strut_friction_law law) {
  for (size_t i = 0; i < scene->contact_count; i++)
    if (scene->contacts[i].friction.law == law) return true;
  return false;
}

static bool rubs(const strut_scene *scene) {
  for (size_t i = 0; i < scene->contact_count; i++)
    if (scene->contacts[i].friction.law != STRUT_FRICTION_NONE) return true;
  return false;
}

/* Depth of a contact at rest if all of them carried the weight alike [m]; 0 without gravity. */
static double depth_at_rest(const strut_scene *scene, const strut_contact *contact) {
  double mass = 0, gravity = hypot(scene->gravity[0], scene->gravity[1]);
  for (size_t i = 0; i < scene->node_count; i++) mass += scene->nodes[i].mass;
  for (size_t i = 0; i < scene->member_count; i++) mass += scene->members[i].mass;
  return mass * gravity / (contact->stiffness * (double)scene->contact_count);
}

static bool damped_ground(const strut_scene *scene) {
  bool any = false;
  for (size_t i = 0; i < scene->contact_count; i++) {
    const strut_contact *c = &scene->contacts[i];
    any = any || c->damping > 0 || c->dissipation > 0;
    if (!(depth_at_rest(scene, c) > 0)) return false;
  }
  return any;
}

static bool makes_sense(const strut_scene *scene, kind what) {
  switch (what) {
    case OWN: return true;
    case MASS: return has_member_mass(scene);
    case RIGID: return has_still_bars(scene);
    case KARNOPP: return rubs(scene) && !has_friction(scene, STRUT_FRICTION_KARNOPP);
    case COULOMB: return rubs(scene) && !has_friction(scene, STRUT_FRICTION_COULOMB);
    case SMOOTH: return rubs(scene) && !has_friction(scene, STRUT_FRICTION_SMOOTH);
    case GROUND: return scene->contact_count > 0 && damped_ground(scene);
    default: return false;
  }
}

/* The speed over which a law of friction that needs one goes through zero [m/s]. */
static double soft_speed(const study *s, const strut_friction *friction) {
  if (friction->stick_velocity > 0) return friction->stick_velocity;
  return friction->width > 0 ? friction->width : s->scale[0];
}

static void describe(const study *s, kind what, strut_model_variant *f) {
  const strut_scene *scene = &s->setups[0]->scene;
  if (what == OWN) snprintf(f->name, sizeof f->name, "the scene's own model");
  if (what == COULOMB) snprintf(f->name, sizeof f->name, "Coulomb friction");
  if (what == MASS)
    snprintf(f->name, sizeof f->name, "%s masses",
             scene->mass_model == STRUT_MASS_LUMPED ? "consistent" : "lumped");
  if (what == RIGID)
    snprintf(f->name, sizeof f->name, "%s bars",
             scene->bar_model == STRUT_BARS_RIGID ? "elastic" : "rigid");
  if (what == KARNOPP || what == SMOOTH) {
    double speed = soft_speed(s, &scene->contacts[0].friction);
    snprintf(f->name, sizeof f->name, "%s friction, %s", what == SMOOTH ? "smooth" : "Karnopp",
             strut_quantity_of(speed, 3, "m/s").text);
  }
  if (what != GROUND) return;
  bool printed = scene->ground.damping_law == STRUT_DAMPING_APPROACH;
  snprintf(f->name, sizeof f->name, "%s",
           printed ? "Hunt-Crossley ground" : "printed ground damping");
  snprintf(f->remark, sizeof f->remark,
           "damps as the scene's law does at the depth at which the ground carries the weight, %s",
           strut_quantity_of(depth_at_rest(scene, &scene->contacts[0]), 3, "m").text);
}

/* The kind of the i-th fidelity in the list. */
static kind kind_of(const study *s, int fidelity) {
  int found = -1;
  for (int what = OWN; what < KINDS; what++)
    if (makes_sense(&s->setups[0]->scene, (kind)what) && ++found == fidelity) return (kind)what;
  return OWN;
}

strut_status strut_study_list_fidelities(study *s) {
  strut_tradeoff *r = s->result;
  bool all = !s->options->own_model && r->measure != STRUT_TRADEOFF_ENERGY;
  r->fidelities = strut_arena_allocate(&r->arena, KINDS, sizeof *r->fidelities);
  if (!r->fidelities) return STRUT_NO_MEMORY;
  for (int what = OWN; what < KINDS; what++) {
    if (!makes_sense(&s->setups[0]->scene, (kind)what) || (what != OWN && !all)) continue;
    strut_model_variant *f = &r->fidelities[r->fidelity_count++];
    describe(s, (kind)what, f);
    f->value = strut_arena_allocate(&r->arena, r->point_count * r->value_count, sizeof *f->value);
    f->floor = strut_arena_allocate(&r->arena, r->point_count, sizeof *f->floor);
    f->model_error = strut_arena_allocate(&r->arena, r->point_count, sizeof *f->model_error);
    if (!f->value || !f->floor || !f->model_error) return STRUT_NO_MEMORY;
  }
  return STRUT_OK;
}

static void change_contact(const study *s, kind what, const strut_scene *scene,
                           strut_contact *contact) {
  double depth = depth_at_rest(scene, contact), slope = contact->stiffness * depth;
  bool rough = contact->friction.law != STRUT_FRICTION_NONE;
  double speed = soft_speed(s, &contact->friction);
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

strut_status strut_study_change_scene(const study *s, int fidelity, strut_scene *scene,
                                      strut_arena *arena) {
  kind what = kind_of(s, fidelity);
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
    change_contact(s, what, scene, &contacts[i]);
  }
  scene->contacts = contacts;
  return STRUT_OK;
}

strut_status strut_study_model(const study *s, size_t point, int fidelity,
                               const strut_model **model) {
  study_variant *v = &s->variants[point * STRUT_STUDY_VARIANTS + (size_t)fidelity];
  strut_status status = STRUT_OK;
  if (!v->model) {
    v->scene = s->setups[point]->scene;
    status = strut_study_change_scene(s, fidelity, &v->scene, &v->arena)
                 ? strut_fail(s->error, STRUT_NO_MEMORY, "out of memory")
                 : strut_model_compile(&v->scene, &v->model, s->error);
  }
  *model = v->model;
  return status;
}

void strut_study_free_models(study *s) {
  size_t count = s->variants ? s->result->point_count * STRUT_STUDY_VARIANTS : 0;
  for (size_t i = 0; i < count; i++) {
    strut_model_free(s->variants[i].model);
    strut_arena_free(&s->variants[i].arena);
  }
  strut_release(s->variants);
}

bool strut_study_switches(const strut_scene *scene) {
  for (size_t i = 0; i < scene->member_count; i++)
    if (scene->members[i].kind == STRUT_CABLE) return true;
  return scene->contact_count > 0;
}

bool strut_study_able(const study *s, const strut_integrator *method, int fidelity) {
  kind what = kind_of(s, fidelity);
  bool own = has_friction(&s->setups[0]->scene, STRUT_FRICTION_COULOMB);
  bool exact = own ? what <= GROUND : what == COULOMB;
  if (exact && !method->events) return false;
  return !method->events || strut_study_adaptive(method) ||
         strut_study_switches(&s->setups[0]->scene);
}

bool strut_study_allowed(const study *s, const strut_integrator *method, int fidelity) {
  bool wanted = s->options->method_count == 0;
  for (size_t i = 0; i < s->options->method_count; i++)
    wanted = wanted || s->options->methods[i] == method;
  return wanted && strut_study_able(s, method, fidelity);
}
