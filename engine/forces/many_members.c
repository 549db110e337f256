/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forces of more members than the ledger adds up in one sum: called, so that smaller structures do not pay for it. */
#include "engine/forces/members_kernel.h"

STRUT_CLONES
static void add_forces_of_many(const strut_model *model, const strut_state *state,
                               const double *restrict q, const double *restrict v,
                               double *restrict force, four_member_powers *powers) {
  const strut_member_table t = model->members;
  four_member_powers sum = {0}, part = {0};
  for (int32_t b = 0; b < t.blocks; b++) {
    members_of_block(&t, state, q, v, force, b, true, &part);
    if ((b + 1) % STRUT_LEDGER_BLOCKS && b + 1 < t.blocks) continue;
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
