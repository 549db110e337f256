/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The formulas of a step of the classical Runge-Kutta method, of which the loops of all kernels are made; one
 * text for all of them, see laws/words.h.
 */
#ifndef STRUT_RK4_STAGES
/** Its stages; X(time, weight): when in the step, and six times the share in it. */
#define STRUT_RK4_STAGES(X) X(0.0, 1.0) X(0.5, 2.0) X(0.5, 2.0) X(1.0, 1.0)
#endif

#include "engine/scene/laws/words.h"

/**
 * A position or velocity for the stage that is `h` after the begin of the step, by the rate of the one
 * before.
 */
LAW_INLINE real LAW(rk4_stage)(real begin, real h, real rate) { return begin + h * rate; }

/**
 * At the end of the step, by the rates of its stages, those of the inner two as their sum; sixth: of the
 * step.
 */
LAW_INLINE real LAW(rk4_end)(real begin, real sixth, real k1, real inner, real k4) {
  real sum = k1 + 2.0 * inner + k4;
  return begin + sixth * sum;
}

#include "engine/scene/laws/words_end.h"
