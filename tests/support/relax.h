/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A state at rest by a single relaxation with the step of the experiment. */
#pragma once

#include <string.h>

#include "engine/run/settle.h"

/** The time that it simulates [s]; 0: it failed. */
static inline double relax(const strut_model *model, const strut_experiment *experiment,
                           strut_state *state, strut_error *error) {
  strut_relaxation r;
  size_t bytes = (size_t)model->length * sizeof(double);
  bool rests = strut_relaxation_create(model, experiment, &r, error) == STRUT_OK &&
               strut_relaxation_run(&r, error) == STRUT_OK;
  double time = rests ? r.time : 0.0;
  if (rests) memcpy(state->q, r.state->q, bytes), memset(state->v, 0, bytes);
  strut_relaxation_free(&r);
  return time;
}
