/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * How a method of plain steps comes to run its loop: with the energy balance and without it are two
 * functions, and a third is for scenes with rare terms, each compiled for several processors, so that a
 * scene does not pay for what it does not need.
 */
#ifndef STRUT_ENGINE_INTEGRATE_PLAIN_STEPS_H
#define STRUT_ENGINE_INTEGRATE_PLAIN_STEPS_H

#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/forces_kernel.h"

/** Terms whose impulses and positions plain methods apply at the end of a step. */
enum {
  STRUT_TERMS_AT_STEP_END =
      STRUT_TERM_SUPPORT_MOTION | STRUT_TERM_UNBALANCE | STRUT_TERM_SLIDING_MASS
};

/** At the end of the step of dt [s] from state->step on: supports that move, and impulses. */
static inline void end_moving_step(const strut_model *model, strut_state *state, double dt) {
  double t = ((double)state->step + 1.0) * dt;
  state->kicked = strut_sliding_masses_kick(model, state, t - dt, t);
  state->kicked = strut_support_motion_kick(model, state, t - dt, t) || state->kicked;
  state->kicked = strut_unbalance_kick(model, state, t - dt, t) || state->kicked;
  strut_support_motion_place(model, state, t, state->q, state->v);
}

/**
 * Defines NAME_plain(model, state, work, dt, count), which runs
 * `steps(model, state, work, dt, count, terms, balance)`, an inlined function, as terms and balance ask.
 * NAME must be the method's own: cloned functions of equal names do not link with clang (hot.h).
 */
#define STRUT_PLAIN_STEPS(name, work_type, steps)                                                  \
  STRUT_CLONES                                                                                     \
  static void name##_with_balance(const strut_model *model, strut_state *state, work_type *work,   \
                                  double dt, int64_t count) {                                      \
    steps(model, state, work, dt, count, STRUT_TERMS_COMMON, true);                                \
  }                                                                                                \
                                                                                                   \
  STRUT_CLONES                                                                                     \
  static void name##_without_balance(const strut_model *model, strut_state *state,                 \
                                     work_type *work, double dt, int64_t count) {                  \
    steps(model, state, work, dt, count, STRUT_TERMS_COMMON, false);                               \
  }                                                                                                \
                                                                                                   \
  STRUT_CLONES                                                                                     \
  static void name##_with_rare_terms(const strut_model *model, strut_state *state,                 \
                                     work_type *work, double dt, int64_t count) {                  \
    steps(model, state, work, dt, count, STRUT_TERMS_ALL, state->balance);                         \
  }                                                                                                \
                                                                                                   \
  static void name##_plain(const strut_model *model, strut_state *state, work_type *work,          \
                           double dt, int64_t count) {                                             \
    if (model->terms & STRUT_TERMS_RARE)                                                           \
      name##_with_rare_terms(model, state, work, dt, count);                                       \
    else if (state->balance)                                                                       \
      name##_with_balance(model, state, work, dt, count);                                          \
    else                                                                                           \
      name##_without_balance(model, state, work, dt, count);                                       \
  }

#endif
