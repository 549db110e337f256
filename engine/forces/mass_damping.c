/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/mass_damping.h"

/* Of the mass of a member at each of its ends, and between them. */
typedef struct mass_shares {
  double own, other;
} mass_shares;

static mass_shares shares_of(const strut_model *model) {
  bool consistent = model->scene->mass_model == STRUT_MASS_CONSISTENT;
  return consistent ? (mass_shares){1.0 / 3.0, 1.0 / 6.0} : (mass_shares){0.5, 0.0};
}

void strut_mass_damping_apply(const strut_model *model, strut_state *state, const double *v) {
  const strut_member_table *t = &model->members;
  const mass_shares share = shares_of(model);
  double alpha = model->mass_damping, lost = 0.0, *force = state->force;
  for (int c = 0; c < 2; c++, v++, force++) {
    for (int32_t i = 0; i < model->node_count; i++) {
      double drag = alpha * model->point_mass[i] * v[2 * i];
      force[2 * i] -= drag;
      lost += drag * v[2 * i];
    }
    for (int32_t j = 0; j < t->count; j++) {
      double a = v[t->from[j]], b = v[t->to[j]], m = alpha * t->mass[j];
      double at_a = m * (share.own * a + share.other * b);
      double at_b = m * (share.other * a + share.own * b);
      force[t->from[j]] -= at_a;
      force[t->to[j]] -= at_b;
      lost += at_a * a + at_b * b;
    }
  }
  if (!state->ledger) return;
  state->power[STRUT_POWER_MEMBERS] += lost;
  state->power[STRUT_POWER_EXCHANGED] += lost;
}

void strut_mass_damping_add(const strut_model *model, const int32_t *row_of, strut_triplets *sum) {
  const strut_member_table *t = &model->members;
  const mass_shares share = shares_of(model);
  if (!(model->plan & STRUT_TERM_MASS_DAMPING)) return;
  for (int c = 0; c < 2; c++, row_of++) {
    for (int32_t i = 0; i < model->node_count; i++)
      if (row_of[2 * i] >= 0)
        strut_triplets_add(sum, row_of[2 * i], row_of[2 * i],
                           model->mass_damping * model->point_mass[i]);
    for (int32_t j = 0; j < t->count; j++) {
      double m = model->mass_damping * t->mass[j];
      int32_t a = row_of[t->from[j]], b = row_of[t->to[j]];
      if (a >= 0) strut_triplets_add(sum, a, a, share.own * m);
      if (b >= 0) strut_triplets_add(sum, b, b, share.own * m);
      if (a >= 0 && b >= 0) strut_triplets_add(sum, a, b, share.other * m);
    }
  }
}
