/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * How a method of plain steps comes to run its loop: with the energy ledger and without it are two
 * functions, each compiled for several processors, so that who keeps no ledger does not pay for it.
 */
#ifndef STRUT_ENGINE_INTEGRATE_PLAIN_STEPS_H
#define STRUT_ENGINE_INTEGRATE_PLAIN_STEPS_H

#include "engine/forces/forces_kernel.h"

/**
 * Defines advance_plain(model, state, work, dt, count), which runs
 * `steps(model, state, work, dt, count, ledger)`, an inlined function, as the state's ledger asks.
 */
#define STRUT_PLAIN_STEPS(work_type, steps)                                                        \
  STRUT_CLONES                                                                                     \
  static void advance_with_ledger(const strut_model *model, strut_state *state, work_type *work,   \
                                  double dt, int64_t count) {                                      \
    steps(model, state, work, dt, count, true);                                                    \
  }                                                                                                \
                                                                                                   \
  STRUT_CLONES                                                                                     \
  static void advance_without_ledger(const strut_model *model, strut_state *state,                 \
                                     work_type *work, double dt, int64_t count) {                  \
    steps(model, state, work, dt, count, false);                                                   \
  }                                                                                                \
                                                                                                   \
  static void advance_plain(const strut_model *model, strut_state *state, work_type *work,         \
                            double dt, int64_t count) {                                            \
    (state->ledger ? advance_with_ledger : advance_without_ledger)(model, state, work, dt, count); \
  }

#endif
