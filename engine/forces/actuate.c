/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/actuate.h"

#include <math.h>

#include "engine/forces/drive.h"
#include "engine/forces/strains/angle.h"
#include "engine/forces/strains/path.h"

/* de/dq of the strain that the force works on. */
static void gradient_of(const strut_actuator_force *a, const uint32_t *at, const double *q,
                        double *b) {
  if (a->strain == STRUT_STRAIN_ANGLE)
    strut_strain_angle(at, a->nodes, q, 0.0, b);
  else
    strut_strain_path(at, a->nodes, q, 0.0, b);
}

void strut_actuator_forces_apply(const strut_model *model, strut_state *state, double t,
                                 const double *q, const double *v) {
  const strut_actuator_force_table *table = &model->actuator_forces;
  for (int32_t i = 0; i < table->count; i++) {
    const strut_actuator_force *a = &table->item[i];
    const uint32_t *at = table->at + a->first;
    double b[2 * STRUT_MOST_ELEMENT_NODES], size, speed = 0.0;
    size = strut_drive_signal(model, state, v, a->signal, t + state->time_offset);
    gradient_of(a, at, q, b);
    state->actuator_force[i] = size;
    for (int32_t k = 0; k < a->nodes; k++) {
      state->force[at[k]] -= size * b[2 * k];
      state->force[at[k] + 1] -= size * b[2 * k + 1];
      speed += b[2 * k] * v[at[k]] + b[2 * k + 1] * v[at[k] + 1];
    }
    if (!state->ledger) continue;
    state->power[STRUT_POWER_DRIVE] -= size * speed;
    state->power[STRUT_POWER_EXCHANGED] += fabs(size * speed);
  }
}

double strut_actuator_force_on_member(const strut_model *model, const strut_state *state,
                                      int32_t member) {
  const strut_actuator_force_table *table = &model->actuator_forces;
  double sum = 0.0;
  for (int32_t i = 0; i < table->count; i++)
    if (table->item[i].member == member) sum += state->actuator_force[i];
  return sum;
}

double strut_actuator_moment_on_hinge(const strut_model *model, const strut_state *state,
                                      int32_t hinge) {
  const strut_actuator_force_table *table = &model->actuator_forces;
  double sum = 0.0;
  for (int32_t i = 0; i < table->count; i++)
    if (table->item[i].hinge == hinge) sum += state->actuator_force[i];
  return sum;
}

void strut_actuator_forces_add_tensions(const strut_model *model, const strut_state *state,
                                        double *force) {
  const strut_actuator_force_table *table = &model->actuator_forces;
  for (int32_t i = 0; i < table->count; i++)
    if (table->item[i].member >= 0) force[table->item[i].member] += state->actuator_force[i];
}
