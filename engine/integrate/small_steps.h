/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Steps of small models, see engine/model/small_model.h; with the bits of the general methods.
 */
#ifndef STRUT_ENGINE_INTEGRATE_SMALL_STEPS_H
#define STRUT_ENGINE_INTEGRATE_SMALL_STEPS_H

#include "engine/model/state.h"

/** Advances by `count` steps of dt [s] of the classical Runge-Kutta method. */
void strut_small_rk4_avx512(const strut_model *model, strut_state *state, double dt, int64_t count);

#endif
