/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Hot: the stages of the classical Runge-Kutta method over arrays of coordinates, (n) each. */
#ifndef STRUT_ENGINE_INTEGRATE_RK4_STAGES_H
#define STRUT_ENGINE_INTEGRATE_RK4_STAGES_H

#include <stdint.h>

#include "engine/forces/members_kernel.h"
#include "engine/model/algebra/pull_rows.h"

#define STRUT_RK4_TIME(time, weight) time,
#define STRUT_RK4_WEIGHT(time, weight) weight,
static const double STRUT_RK4_AHEAD[4] = {STRUT_RK4_STAGES(STRUT_RK4_TIME)},
                    STRUT_RK4_WEIGHTS[4] = {STRUT_RK4_STAGES(STRUT_RK4_WEIGHT)};
#undef STRUT_RK4_TIME
#undef STRUT_RK4_WEIGHT

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

#endif
