/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Steps of small models, see engine/model/small_model.h; with the bits of the general methods.
 */
#ifndef STRUT_ENGINE_INTEGRATE_SMALL_STEPS_H
#define STRUT_ENGINE_INTEGRATE_SMALL_STEPS_H

#include "engine/model/small_model.h"
#include "engine/model/state.h"

/* Those of each set of registers. */
void strut_small_rk4_avx2(const strut_model *model, strut_state *state, double dt, int64_t count);
void strut_small_rk4_avx512(const strut_model *model, strut_state *state, double dt, int64_t count);

/** Advances a model by `count` steps of dt [s] of the classical Runge-Kutta method. False, and nothing done,
    where the model is none that is stepped so. */
static inline bool strut_small_rk4(const strut_model *model, strut_state *state, double dt,
                                   int64_t count) {
#if defined(__x86_64__)
  if (!model->small || model->small->level == STRUT_SMALL_NONE) return false;
  if (model->small->level == STRUT_SMALL_AVX512)
    strut_small_rk4_avx512(model, state, dt, count);
  else
    strut_small_rk4_avx2(model, state, dt, count);
  return true;
#else
  (void)model, (void)state, (void)dt, (void)count;
  return false;
#endif
}

#endif
