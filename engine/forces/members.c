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
                             const strut_element *element, const double *q, const double *velocity,
                             strut_member_values *values) {
  strut_element_pose pose;
  for (; element;
       element = element->sibling >= 0 ? &model->elements.element[element->sibling] : NULL) {
    int32_t i = (int32_t)(element - model->elements.element);
    values->force += strut_element_measure_at(model, state, i, q, velocity, &pose);
    values->length = pose.strain;
    values->rate = strut_element_rate(model, i, &pose, velocity);
  }
}

strut_member_values strut_member_measure_at(const strut_model *model, const strut_state *state,
                                            int32_t j, const double *q, const double *velocity) {
  assert(j >= 0 && j < model->members.count);
  const strut_member_table *members = &model->members;
  strut_member_pose pose = strut_member_pose_at(members, state->latest->rest, j, q);
  double rate = strut_member_rate(members, j, &pose, velocity);
  double force = members->stiffness[j] * pose.stretch +
                 members->damping[j] * (rate - state->latest->rest_rate[j]);
  bool pulls = pose.taut && force > members->slack[j];
  strut_member_values values = {pose.length, rate, pulls ? force : members->slack[j]};
  const strut_element *element = strut_element_of_member(&model->elements, j);
  if (element) measure_elements(model, state, element, q, velocity, &values);
  if (model->feedback.maxwell_count) values.force += strut_maxwell_force(model, velocity, j);
  return values;
}

/*
 * Forces of more members than the energy balance adds up in one sum: called, so that smaller structures do
 * not pay for it.
 */

STRUT_CLONES
static void add_forces_of_many(const strut_model *model, const strut_state *state,
                               const double *restrict q, const double *restrict velocity,
                               double *restrict force, four_member_powers *powers) {
  const strut_member_table t = model->members;
  four_member_powers sum = {0}, part = {0};
  for (int32_t b = 0; b < t.blocks; b++) {
    members_of_block(&t, state, q, velocity, force, b, true, &part);
    if ((b + 1) % STRUT_BALANCE_BLOCKS && b + 1 < t.blocks) continue;
    members_add_powers(&sum, &part);
    part = (four_member_powers){0};
  }
  *powers = sum;
}

void strut_many_members_add_forces(const strut_model *model, const strut_state *state,
                                   const double *q, const double *velocity, double *force,
                                   four_member_powers *powers) {
  add_forces_of_many(model, state, q, velocity, force, powers);
}
