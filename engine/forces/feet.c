/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/feet.h"

#include <assert.h>
#include <math.h>

#include "engine/forces/elements.h"
#include "engine/forces/strains/foot.h"
#include "engine/scene/friction.h"

void strut_foot_slide(const strut_model *model, int32_t foot, const double *q, double b[4]) {
  assert(foot >= 0 && foot < model->feet.count);
  const strut_foot_entry *f = &model->feet.item[foot];
  const strut_element *e = &model->elements.element[f->element];
  const strut_foot_pose pose =
      strut_foot_pose_of(model->elements.at + e->first, q, e->axis, e->radius);
  /* the tangent is to the right of the normal; rolling, the middle moves as the member turns */
  double tx = pose.ny, ty = -pose.nx, roll = pose.turn * (1.0 - pose.along);
  b[2] = -roll * pose.uy, b[3] = roll * pose.ux;
  b[0] = tx - b[2], b[1] = ty - b[3];
}

/* A foot at q and v: how it slides, and the forces normal to the ground and along it. */
typedef struct foot_forces {
  double slide[4], slip, normal, friction;
} foot_forces;

static foot_forces forces_of(const strut_model *model, const strut_state *state, int32_t foot,
                             const double *q, const double *v) {
  const strut_foot_entry *f = &model->feet.item[foot];
  const uint32_t *at = model->elements.at + model->elements.element[f->element].first;
  strut_element_pose pose;
  foot_forces r = {.normal = -strut_element_measure_at(model, state, f->element, q, v, &pose)};
  if (!(r.normal > 0.0)) return (foot_forces){.normal = 0.0};
  strut_foot_slide(model, foot, q, r.slide);
  for (int k = 0; k < 4; k++) r.slip += r.slide[k] * v[at[k / 2] + (uint32_t)(k % 2)];
  r.slip -= f->belt_speed;
  r.friction = strut_friction_force(&f->friction, r.normal, r.slip, 0.0);
  return r;
}

void strut_feet_add_forces(const strut_model *model, strut_state *state, const double *q,
                           const double *v) {
  for (int32_t i = 0; i < model->feet.count; i++) {
    const strut_foot_entry *f = &model->feet.item[i];
    const uint32_t *at = model->elements.at + model->elements.element[f->element].first;
    if (f->friction.law == STRUT_FRICTION_NONE) continue;
    foot_forces r = forces_of(model, state, i, q, v);
    for (int k = 0; k < 4; k++)
      state->latest.force[at[k / 2] + (uint32_t)(k % 2)] += r.friction * r.slide[k];
    if (!state->balance) continue;
    double lost = -r.friction * r.slip, belt = r.friction * f->belt_speed;
    state->latest.power[STRUT_POWER_FRICTION] += lost;
    state->latest.power[STRUT_POWER_BELT] += belt;
    state->latest.power[STRUT_POWER_EXCHANGED] += fabs(lost) + fabs(belt);
  }
}

void strut_feet_show(const strut_model *model, strut_state *state, const double *q,
                     const double *v) {
  for (int32_t i = 0; i < model->feet.count; i++) {
    foot_forces r = forces_of(model, state, i, q, v);
    state->latest.normal[model->feet.item[i].contact] = r.normal;
    state->latest.friction[model->feet.item[i].contact] = r.friction;
  }
}
