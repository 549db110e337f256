/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/impulse.h"

#include <math.h>

#include "engine/forces/sliding_masses.h"
#include "engine/model/mass.h"

void strut_impulse_apply(const strut_model *model, strut_state *state, strut_power power) {
  double work = 0.0, *change = state->support_answer;
  strut_mass_solve(model, state->force, change, state->scratch);
  if (model->plan & STRUT_TERM_SLIDING_MASS) strut_sliding_masses_correct(model, state, change);
  for (int32_t i = 0; i < model->length; i++) {
    work += state->force[i] * (state->v[i] + 0.5 * change[i]);
    state->v[i] += change[i];
  }
  if (!state->ledger) return;
  state->work[power] += work;
  state->work[STRUT_POWER_EXCHANGED] += fabs(work);
}
