/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What steps of small models read beside the tables: numbers of the model and the state that stay for a run
 * of steps, and rest lengths at the instants of these.
 */
#ifndef STRUT_ENGINE_FORCES_SMALL_INPUTS_H
#define STRUT_ENGINE_FORCES_SMALL_INPUTS_H

#include "engine/model/small_model.h"
#include "engine/model/state.h"

typedef struct strut_small_inputs {
  strut_small_row constant[2]; /* constant forces [N] */
  double slack_length_threshold[STRUT_SMALL_SLOTS], slack_force_threshold[STRUT_SMALL_SLOTS];
  unsigned driven; /* bit g: rest lengths of some of the members 4 g to 4 g + 3 change */
} strut_small_inputs;

/** Rest lengths [m] and their rates [m/s] at one instant. */
typedef struct small_rest {
  double rest[STRUT_SMALL_SLOTS], rate[STRUT_SMALL_SLOTS];
} small_rest;

/** As model and state have them now. */
static inline void strut_small_inputs_read(const strut_model *model, const strut_state *state,
                                           strut_small_inputs *inputs) {
  const strut_small_model *s = model->small;
  bool constant = model->terms & STRUT_TERM_CONSTANT;
  for (int32_t i = 0; i < STRUT_SMALL_NODES; i++)
    for (int32_t c = 0; c < 2; c++)
      inputs->constant[c][i] = constant && i < s->nodes ? model->constant_force[2 * i + c] : 0.0;
  for (int32_t j = 0; j < STRUT_SMALL_SLOTS; j++) {
    bool there = j < s->members;
    inputs->slack_length_threshold[j] = there ? state->modes.slack_length_threshold[j] : 0.0;
    inputs->slack_force_threshold[j] = there ? state->modes.slack_force_threshold[j] : 0.0;
  }
  inputs->driven = 0;
  for (int32_t j = 0; j < s->members && model->terms & STRUT_TERM_DRIVE; j++)
    if (state->latest.rest_rate[j] != 0.0) inputs->driven |= 1u << j / 4;
  for (int32_t i = 0; i < model->drives.count; i++)
    inputs->driven |= 1u << model->drives.member[i] / 4;
}

/** Rest lengths before the drives change them, in `count` rows. */
static inline void strut_small_rest_fill(const strut_model *model, const strut_state *state,
                                         int64_t count, small_rest *rows) {
  bool driven = model->terms & STRUT_TERM_DRIVE;
  const double *rest = driven ? state->latest.rest : model->members.rest;
  for (int64_t h = 0; h < count; h++)
    for (int32_t j = 0; j < STRUT_SMALL_SLOTS; j++) {
      bool there = j < model->members.count;
      rows[h].rest[j] = there ? rest[j] : 0.0;
      rows[h].rate[j] = there ? state->latest.rest_rate[j] : 0.0;
    }
}

#endif
