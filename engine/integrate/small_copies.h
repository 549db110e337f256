/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The methods of small models for one set of registers: with the energy balance and without it, for all
 * models, for those that have neither cables, slope nor other laws, and for those that have exactly the usual
 * terms. Copies do not ask for what they know.
 *
 * A file defines STRUT_SMALL_WIDTH and STRUT_SMALL_NAME(method), the name of the public function, and
 * includes this once.
 */
#ifndef STRUT_ENGINE_INTEGRATE_SMALL_COPIES_H
#define STRUT_ENGINE_INTEGRATE_SMALL_COPIES_H

#include "engine/integrate/small_rk4.h"
#include "engine/integrate/small_verlet.h"

#define STRUT_SMALL_COPY(method, name, terms, balance)                                             \
  STRUT_SMALL_TARGET                                                                               \
  static void method##_##name(const strut_model *model, strut_state *state,                        \
                              const strut_small_kept *kept, double dt, int64_t count) {            \
    small_##method(model, state, kept, dt, count, terms, balance);                                 \
  }

#define STRUT_SMALL_METHOD(method)                                                                 \
  STRUT_SMALL_COPY(method, usual_with_balance, STRUT_SMALL_USUAL, true)                            \
  STRUT_SMALL_COPY(method, usual, STRUT_SMALL_USUAL, false)                                        \
  STRUT_SMALL_COPY(method, common_with_balance, STRUT_SMALL_COMMON, true)                          \
  STRUT_SMALL_COPY(method, common, STRUT_SMALL_COMMON, false)                                      \
  STRUT_SMALL_COPY(method, with_balance, STRUT_TERMS_ALL, true)                                    \
  STRUT_SMALL_COPY(method, without_balance, STRUT_TERMS_ALL, false)                                \
                                                                                                   \
  void STRUT_SMALL_NAME(method)(const strut_model *model, strut_state *state,                      \
                                const strut_small_kept *kept, double dt, int64_t count) {          \
    static strut_small_steps *const copies[3][2] = {                                               \
        {method##_without_balance, method##_with_balance},                                         \
        {method##_common, method##_common_with_balance},                                           \
        {method##_usual, method##_usual_with_balance}};                                            \
    copies[small_copy_of(model)][state->balance](model, state, kept, dt, count);                   \
  }

#endif
