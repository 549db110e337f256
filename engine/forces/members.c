/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lengths and forces of members for observers (recording, measuring). The step's own loop:
   members_kernel.h. */
#include <math.h>

#include "engine/forces/forces.h"
#include "engine/forces/rigid.h"

/* Without what the multiplier of a rigid bar adds. */
static strut_member_values measure(const strut_model *model, const strut_state *state, int32_t j) {
  const strut_member_table *t = &model->members;
  const double *qa = state->q + t->from[j], *qb = state->q + t->to[j];
  const double *va = state->v + t->from[j], *vb = state->v + t->to[j];
  double dx = qb[0] - qa[0], dy = qb[1] - qa[1];
  double l = sqrt(dx * dx + dy * dy), inverse = l > 0 ? 1.0 / l : 0.0;
  double rate = (vb[0] - va[0]) * (dx * inverse) + (vb[1] - va[1]) * (dy * inverse);
  double stretch = l - state->rest[j];
  double f = t->stiffness[j] * stretch + t->damping[j] * (rate - state->rest_rate[j]);
  bool pulls = stretch > t->slack[j] && f > t->slack[j];
  return (strut_member_values){l, rate, pulls ? f : t->slack[j]};
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
