/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lengths and forces of members for observers (recording, measuring). The step's own loop:
   members_kernel.h. */
#include "engine/forces/forces.h"
#include "engine/forces/rigid.h"
#include "engine/model/pose.h"

/* Without what the multiplier of a rigid bar adds. */
static strut_member_values measure(const strut_model *model, const strut_state *state, int32_t j) {
  const strut_member_table *t = &model->members;
  strut_member_pose pose = strut_member_pose_at(t, state->rest, j, state->q);
  double rate = strut_member_rate(t, j, &pose, state->v);
  double force = t->stiffness[j] * pose.stretch + t->damping[j] * (rate - state->rest_rate[j]);
  bool pulls = pose.taut && force > t->slack[j];
  return (strut_member_values){pose.length, rate, pulls ? force : t->slack[j]};
}

strut_member_values strut_member_measure(const strut_model *model, const strut_state *state,
                                         int32_t member) {
  strut_member_values values = measure(model, state, member);
  if (state->rigid) values.force += strut_rigid_tension(state->rigid, member);
  return values;
}

void strut_members_measure(const strut_model *model, const strut_state *state, double *length,
                           double *force) {
  for (int32_t j = 0; j < model->members.count; j++) {
    strut_member_values values = measure(model, state, j);
    length[j] = values.length;
    force[j] = values.force;
  }
  if (state->rigid) strut_rigid_add_tensions(state->rigid, force);
}
