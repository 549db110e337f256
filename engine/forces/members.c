/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lengths and forces of members, hinges and cells for observers (recording, measuring). The step's own loop:
   members_kernel.h. */
#include <assert.h>
#include <math.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/elements.h"
#include "engine/forces/forces.h"
#include "engine/forces/history.h"
#include "engine/forces/members_kernel.h"
#include "engine/forces/rigid.h"
#include "engine/model/pose.h"

/* Adds the forces of a member's elements; a running cable's length is theirs, too. */
static void measure_elements(const strut_model *model, const strut_state *state,
                             const strut_element *e, const double *q, const double *v,
                             strut_member_values *values) {
  strut_element_pose pose;
  for (; e; e = e->sibling >= 0 ? &model->elements.element[e->sibling] : NULL) {
    int32_t i = (int32_t)(e - model->elements.element);
    values->force += strut_element_measure_at(model, state, i, q, v, &pose);
    values->length = pose.strain;
    values->rate = strut_element_rate(model, i, &pose, v);
  }
}

strut_member_values strut_member_measure_at(const strut_model *model, const strut_state *state,
                                            int32_t j, const double *q, const double *v) {
  assert(j >= 0 && j < model->members.count);
  const strut_member_table *t = &model->members;
  strut_member_pose pose = strut_member_pose_at(t, state->latest->rest, j, q);
  double rate = strut_member_rate(t, j, &pose, v);
  double force =
      t->stiffness[j] * pose.stretch + t->damping[j] * (rate - state->latest->rest_rate[j]);
  bool pulls = pose.taut && force > t->slack[j];
  strut_member_values values = {pose.length, rate, pulls ? force : t->slack[j]};
  const strut_element *element = strut_element_of_member(&model->elements, j);
  if (element) measure_elements(model, state, element, q, v, &values);
  if (model->feedback.maxwell_count) values.force += strut_maxwell_force(model, v, j);
  return values;
}

void strut_members_measure(const strut_model *model, const strut_state *state, double *length,
                           double *force) {
  for (int32_t j = 0; j < model->members.count; j++) {
    strut_member_values values = strut_member_measure_at(model, state, j, state->q, state->v);
    length[j] = values.length;
    force[j] = values.force;
  }
  if (state->rigid) strut_rigid_add_tensions(state->rigid, force);
  strut_actuator_forces_add_tensions(model, state, force);
}

/*
 * Forces of more members than the energy balance adds up in one sum: called, so that smaller structures do
 * not pay for it.
 */

STRUT_CLONES
static void add_forces_of_many(const strut_model *model, const strut_state *state,
                               const double *restrict q, const double *restrict v,
                               double *restrict force, four_member_powers *powers) {
  const strut_member_table t = model->members;
  four_member_powers sum = {0}, part = {0};
  for (int32_t b = 0; b < t.blocks; b++) {
    members_of_block(&t, state, q, v, force, b, true, &part);
    if ((b + 1) % STRUT_BALANCE_BLOCKS && b + 1 < t.blocks) continue;
    members_add_powers(&sum, &part);
    part = (four_member_powers){0};
  }
  *powers = sum;
}

void strut_many_members_add_forces(const strut_model *model, const strut_state *state,
                                   const double *q, const double *v, double *force,
                                   four_member_powers *powers) {
  add_forces_of_many(model, state, q, v, force, powers);
}
