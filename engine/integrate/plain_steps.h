/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What methods of plain steps share. */
#pragma once

#include <stdint.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/forces_kernel.h"
#include "engine/forces/members_kernel.h"
#include "engine/model/algebra/pull_rows.h"

/** Terms whose impulses and positions plain methods apply at the end of a step. */
enum {
  STRUT_TERMS_AT_STEP_END =
      STRUT_TERM_SUPPORT_MOTION | STRUT_TERM_UNBALANCE | STRUT_TERM_SLIDING_MASS
};

/** At the end of the step of dt [s] from state->step on: supports that move, and impulses. */
static inline void end_moving_step(const strut_model *model, strut_state *state, double dt) {
  double t = ((double)state->step + 1.0) * dt;
  state->kicked = strut_moving_kick(model, state, t - dt, t);
  strut_support_motion_place(model, state, t, state->q, state->v);
}

/** Defines NAME_plain(model, state, work, dt, count), which runs `steps` in copies: STRUT_COPIES. */
#define STRUT_PLAIN_STEPS(name, work_type, steps)                                                  \
  STRUT_COPIES(                                                                                    \
      name##_plain, steps,                                                                         \
      (const strut_model *model, strut_state *state, work_type *work, double dt, int64_t count),   \
      model, state, work, dt, count)

/* Hot: the stages of the classical Runge-Kutta method over arrays of coordinates, (n) each. */

#define STRUT_RK4_TIME(time, weight) time,
#define STRUT_RK4_WEIGHT(time, weight) weight,
static const double STRUT_RK4_AHEAD[4] = {STRUT_RK4_STAGES(STRUT_RK4_TIME)},
                    STRUT_RK4_WEIGHTS[4] = {STRUT_RK4_STAGES(STRUT_RK4_WEIGHT)};

/* Positions and velocities h after the begin of the step, by the rates v and a of the stage before. */
STRUT_LOOP void rk4_next_stage(int32_t n, double h, const double *restrict q0,
                               const double *restrict v0, const double *restrict v,
                               const double *restrict a, double *restrict q,
                               double *restrict next) {
  strut_lanes step = four_all(h);
  for (int32_t i = 0; i < n; i += STRUT_LANES) {
    strut_lanes_store(q + i,
                      four_rk4_stage(strut_lanes_load(q0 + i), step, strut_lanes_load(v + i)));
    strut_lanes_store(
        next + i, four_rk4_stage(strut_lanes_load(v0 + i), step, strut_lanes_load_pairs(a + i)));
  }
}

/* Positions, or velocities, at the end of a step of h; out: may be z. */
STRUT_LOOP void rk4_end_of_step(int32_t n, double h, const double *z, const double *k1,
                                const double *restrict k2, const double *restrict k3,
                                const double *restrict k4, double *out) {
  strut_lanes sixth = four_all(h / 6.0);
  for (int32_t i = 0; i < n; i += STRUT_LANES)
    strut_lanes_store(out + i,
                      four_rk4_end(strut_lanes_load(z + i), sixth, strut_lanes_load(k1 + i),
                                   strut_lanes_load(k2 + i) + strut_lanes_load(k3 + i),
                                   strut_lanes_load_pairs(k4 + i)));
}
