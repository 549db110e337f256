/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/rubbing.h"

#include <assert.h>
#include <math.h>

#include "engine/forces/elements.h"
#include "engine/forces/nearby.h"
#include "engine/forces/strains/strains.h"
#include "engine/scene/friction.h"

static void slide_foot(const strut_element *element, const uint32_t *at, const double *q,
                       double *b) {
  const strut_foot_pose pose =
      strut_foot_pose_of(at, element->nodes, q, element->axis, element->radius);
  /* the tangent is to the right of the normal; rolling, the middle moves as the member turns */
  double tx = pose.ny, ty = -pose.nx, roll = pose.turn * (1.0 - pose.along);
  b[2] = -roll * pose.uy, b[3] = roll * pose.ux;
  b[0] = tx - b[2], b[1] = ty - b[3];
}

int32_t strut_rubbing_slide(const strut_model *model, int32_t item, const double *q,
                            double b[STRUT_MOST_RUBBING]) {
  assert(item >= 0 && item < model->rubbing.count);
  int32_t element = model->rubbing.item[item].element;
  const strut_element *e = &model->elements.element[element];
  double across[STRUT_MOST_GRADIENT];
  if (e->strain == STRUT_STRAIN_FOOT) {
    slide_foot(e, model->elements.at + e->first, q, b);
    return e->nodes;
  }
  /* along the surfaces the nodes have the shares that they have across them */
  strut_element_strain(model, element, q, 0.0, across);
  for (int32_t k = 0; k < e->nodes; k++)
    b[2 * k] = across[2 * k + 1], b[2 * k + 1] = -across[2 * k];
  return e->nodes;
}

/* An entry at q and v: how it slides, and the forces normal to the surfaces and along them. */
typedef struct rubbing_forces {
  int32_t nodes; /* 0: it does not touch */
  double slide[STRUT_MOST_RUBBING], slip, normal, friction;
  double bend_rate; /* of bristles [1/s] */
} rubbing_forces;

/* Bristles at the bend y that slip; where nothing presses, or nothing rubs, their own damper straightens them. */
static void bend_bristles(const strut_friction *friction, double y, rubbing_forces *self) {
  const strut_law_friction_numbers numbers = strut_friction_numbers(friction);
  bool bends = self->nodes && friction->mu_static > 0.0;
  self->bend_rate =
      bends ? strut_law_friction_bristle_rate(&numbers, self->slip, y) : -y / friction->relaxation;
  self->friction = bends ? -self->normal * (y + friction->relaxation * self->bend_rate) : 0.0;
}

static rubbing_forces forces_of(const strut_model *model, const strut_state *state, int32_t item,
                                const double *q, const double *velocity) {
  const strut_rubbing_entry *entry = &model->rubbing.item[item];
  const uint32_t *at = model->elements.at + model->elements.element[entry->element].first;
  strut_element_pose pose;
  rubbing_forces r = {
      .normal = -strut_element_measure_at(model, state, entry->element, q, velocity, &pose)};
  if (!(r.normal > 0.0)) {
    r = (rubbing_forces){.nodes = 0};
    if (entry->bend >= 0) bend_bristles(&entry->friction, velocity[entry->bend], &r);
    return r;
  }
  r.nodes = strut_rubbing_slide(model, item, q, r.slide);
  for (int32_t k = 0; k < 2 * r.nodes; k++)
    r.slip += r.slide[k] * velocity[at[k / 2] + (uint32_t)(k % 2)];
  r.slip -= entry->belt_speed;
  if (entry->bend >= 0)
    bend_bristles(&entry->friction, velocity[entry->bend], &r);
  else
    r.friction = strut_friction_force(&entry->friction, r.normal, r.slip, 0.0);
  return r;
}

double strut_rubbing_slip(const strut_model *model, const strut_state *state, int32_t item,
                          double *normal) {
  rubbing_forces r = forces_of(model, state, item, state->q, state->v);
  *normal = r.nodes ? r.normal : 0.0;
  return r.slip;
}

static void add_entry(const strut_model *model, const strut_state *state, int32_t item,
                      const double *q, const double *velocity) {
  const strut_rubbing_entry *entry = &model->rubbing.item[item];
  const uint32_t *at = model->elements.at + model->elements.element[entry->element].first;
  if (entry->friction.law == STRUT_FRICTION_NONE) return;
  rubbing_forces r = forces_of(model, state, item, q, velocity);
  if (entry->bend >= 0) state->latest->force[entry->bend] = r.bend_rate;
  for (int32_t k = 0; k < 2 * r.nodes; k++)
    state->latest->force[at[k / 2] + (uint32_t)(k % 2)] += r.friction * r.slide[k];
  if (!state->balance) return;
  double lost = -r.friction * r.slip, belt = r.friction * entry->belt_speed;
  strut_power_add_two(state->latest->power, STRUT_POWER_FRICTION, lost, STRUT_POWER_BELT, belt);
}

void strut_rubbing_add_forces(const strut_model *model, const strut_state *state, const double *q,
                              const double *velocity) {
  const strut_rubbing_table *table = &model->rubbing;
  if (!model->elements.scattered) {
    for (int32_t i = 0; i < table->count; i++) add_entry(model, state, i, q, velocity);
    return;
  }
  const strut_nearby *near = strut_nearby_at(model, state, q);
  for (int32_t k = 0; k < near->count; k++) {
    int32_t i = table->of_element[near->element[k]];
    if (i >= 0) add_entry(model, state, i, q, velocity);
  }
}

double strut_rubbing_bristle_decay(const strut_model *model, const strut_state *state,
                                   int32_t item) {
  assert(item >= 0 && item < model->rubbing.count);
  const strut_rubbing_entry *entry = &model->rubbing.item[item];
  if (entry->bend < 0) return 0.0;
  const strut_law_friction_numbers numbers = strut_friction_numbers(&entry->friction);
  rubbing_forces r = forces_of(model, state, item, state->q, state->v);
  return r.nodes ? strut_law_friction_bristle_decay(&numbers, r.slip)
                 : 1.0 / entry->friction.relaxation;
}

void strut_rubbing_show_feet(const strut_model *model, const strut_state *state, const double *q,
                             const double *velocity) {
  for (int32_t i = 0; i < model->rubbing.count; i++) {
    int32_t contact = model->rubbing.item[i].contact;
    if (contact < 0) continue;
    rubbing_forces r = forces_of(model, state, i, q, velocity);
    state->latest->normal[contact] = r.normal;
    state->latest->friction[contact] = r.friction;
  }
}
