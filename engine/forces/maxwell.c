/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hot where members have such branches. See maxwell.h. */
#include "engine/forces/maxwell.h"

#include <math.h>

#include "engine/model/pose.h"

void strut_maxwell_apply(const strut_model *model, strut_state *state, const double *q,
                         const double *v, double *force) {
  const strut_feedback_table *f = &model->feedback;
  const strut_member_table *t = &model->members;
  for (int32_t i = 0; i < f->maxwell_count; i++) {
    const strut_maxwell_entry *m = &f->maxwell[i];
    strut_member_pose pose = strut_member_pose_at(t, state->rest, m->member, q);
    double rest_rate = state->rest_rate[m->member], tension = v[f->base + m->state];
    double rate = strut_member_rate(t, m->member, &pose, v) - rest_rate;
    uint32_t a = t->from[m->member], b = t->to[m->member];
    force[a] += tension * pose.unit.x, force[a + 1] += tension * pose.unit.y;
    force[b] -= tension * pose.unit.x, force[b + 1] -= tension * pose.unit.y;
    force[f->base + m->state] = m->stiffness * (rate - tension / m->damping);
    if (!state->ledger) continue;
    double drive = -tension * rest_rate, lost = tension * tension / m->damping;
    state->power[STRUT_POWER_DRIVE] += drive;
    state->power[STRUT_POWER_MEMBERS] += lost;
    state->power[STRUT_POWER_EXCHANGED] += fabs(drive) + lost;
  }
}

double strut_maxwell_force(const strut_model *model, const double *v, int32_t member) {
  const strut_feedback_table *f = &model->feedback;
  for (int32_t i = 0; i < f->maxwell_count; i++)
    if (f->maxwell[i].member == member) return v[f->base + f->maxwell[i].state];
  return 0.0;
}

double strut_maxwell_energy(const strut_model *model, const double *v) {
  const strut_feedback_table *f = &model->feedback;
  double sum = 0.0;
  for (int32_t i = 0; i < f->maxwell_count; i++) {
    double tension = v[f->base + f->maxwell[i].state];
    sum += 0.5 * tension * tension / f->maxwell[i].stiffness;
  }
  return sum;
}
