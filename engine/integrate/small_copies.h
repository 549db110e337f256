/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The methods of small models for one set of registers: with the ledger and without it, and once more for
 * models that have neither cables, slope nor other laws, which those copies do not ask for.
 *
 * A file defines STRUT_SMALL_WIDTH and STRUT_SMALL_NAME(method), the name of the public function, and includes
 * this once.
 */
#ifndef STRUT_ENGINE_INTEGRATE_SMALL_COPIES_H
#define STRUT_ENGINE_INTEGRATE_SMALL_COPIES_H

#include "engine/integrate/small_rk4.h"
#include "engine/integrate/small_verlet.h"

#define STRUT_SMALL_METHOD(method)                                                                 \
  STRUT_SMALL_TARGET                                                                               \
  static void method##_common_with_ledger(const strut_model *model, strut_state *state,            \
                                          const strut_small_kept *kept, double dt,                 \
                                          int64_t count) {                                         \
    small_##method(model, state, kept, dt, count, STRUT_SMALL_COMMON, true);                       \
  }                                                                                                \
  STRUT_SMALL_TARGET                                                                               \
  static void method##_common(const strut_model *model, strut_state *state,                        \
                              const strut_small_kept *kept, double dt, int64_t count) {            \
    small_##method(model, state, kept, dt, count, STRUT_SMALL_COMMON, false);                      \
  }                                                                                                \
  STRUT_SMALL_TARGET                                                                               \
  static void method##_with_ledger(const strut_model *model, strut_state *state,                   \
                                   const strut_small_kept *kept, double dt, int64_t count) {       \
    small_##method(model, state, kept, dt, count, STRUT_TERMS_ALL, true);                          \
  }                                                                                                \
  STRUT_SMALL_TARGET                                                                               \
  static void method##_without_ledger(const strut_model *model, strut_state *state,                \
                                      const strut_small_kept *kept, double dt, int64_t count) {    \
    small_##method(model, state, kept, dt, count, STRUT_TERMS_ALL, false);                         \
  }                                                                                                \
                                                                                                   \
  void STRUT_SMALL_NAME(method)(const strut_model *model, strut_state *state,                      \
                                const strut_small_kept *kept, double dt, int64_t count) {          \
    bool common = !(model->plan & ~STRUT_SMALL_COMMON);                                            \
    if (common && state->ledger)                                                                   \
      method##_common_with_ledger(model, state, kept, dt, count);                                  \
    else if (common)                                                                               \
      method##_common(model, state, kept, dt, count);                                              \
    else if (state->ledger)                                                                        \
      method##_with_ledger(model, state, kept, dt, count);                                         \
    else                                                                                           \
      method##_without_ledger(model, state, kept, dt, count);                                      \
  }

#endif
