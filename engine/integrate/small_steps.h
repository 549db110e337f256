/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Steps of small models, see engine/model/small_model.h; with the bits of the general methods.
 */
#ifndef STRUT_ENGINE_INTEGRATE_SMALL_STEPS_H
#define STRUT_ENGINE_INTEGRATE_SMALL_STEPS_H

#include <assert.h>

#include "engine/model/small_model.h"
#include "engine/model/state.h"

/** What a method keeps from step to step beside the state, at its present step. */
typedef struct strut_small_kept {
  double *acceleration; /* (length) */
  double *power;        /* (STRUT_POWER_ROOM) */
} strut_small_kept;

/** Advances a model by `count` steps of dt [s]. */
typedef void strut_small_steps(const strut_model *model, strut_state *state,
                               const strut_small_kept *kept, double dt, int64_t count);

/* Those of each set of registers; Runge-Kutta keeps nothing. */
strut_small_steps strut_small_rk4_avx2, strut_small_rk4_avx512;
strut_small_steps strut_small_verlet_avx2, strut_small_verlet_avx512;

/** The registers that step the model. */
static inline strut_small_level strut_small_level_of(const strut_model *model) {
  if (!model->small) return STRUT_SMALL_NONE;
  return model->small->level;
}

/** The function of that name for the model; NULL where it is none that is stepped so. */
#if defined(__x86_64__)
#define STRUT_SMALL_STEPS(model, name)                                                             \
  (strut_small_level_of(model) == STRUT_SMALL_NONE ? NULL                                          \
   : (model)->small->level == STRUT_SMALL_AVX512   ? name##_avx512                                 \
                                                   : name##_avx2)
#else
#define STRUT_SMALL_STEPS(model, name) ((strut_small_steps *)NULL)
#endif

#endif
