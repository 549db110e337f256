/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lengths and forces of members for whoever looks on. The step's own loop: members_kernel.h. */
#include <math.h>

#include "engine/forces/forces.h"
#include "engine/forces/rigid.h"

void strut_members_measure(const strut_model *model, const strut_state *state, double *length,
                           double *force) {
  const strut_member_table *t = &model->members;
  for (int32_t j = 0; j < t->count; j++) {
    const double *qa = state->q + t->from[j], *qb = state->q + t->to[j];
    const double *va = state->v + t->from[j], *vb = state->v + t->to[j];
    double dx = qb[0] - qa[0], dy = qb[1] - qa[1];
    double l = sqrt(dx * dx + dy * dy), inverse = l > 0 ? 1.0 / l : 0.0;
    double rate = (vb[0] - va[0]) * (dx * inverse) + (vb[1] - va[1]) * (dy * inverse);
    double stretch = l - state->rest[j];
    double f = t->stiffness[j] * stretch + t->damping[j] * (rate - state->rest_rate[j]);
    length[j] = l;
    force[j] = stretch > t->slack[j] && f > t->slack[j] ? f : t->slack[j];
  }
  if (state->rigid) strut_rigid_add_tensions(state->rigid, force);
}
