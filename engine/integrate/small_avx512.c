/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of small models with a register for each coordinate of all nodes. */
#if defined(__x86_64__)
#define STRUT_SMALL_WIDTH 8
#include "engine/integrate/small_rk4.h"

enum { COMMON = ~(STRUT_TERM_SLACK | STRUT_TERM_SLOPE | STRUT_TERM_LAWS) };

STRUT_SMALL_TARGET
static void small_rk4_common_with_ledger_8(const strut_model *model, strut_state *state, double dt,
                                           int64_t count) {
  small_rk4(model, state, dt, count, (unsigned)COMMON, true);
}

STRUT_SMALL_TARGET
static void small_rk4_common_8(const strut_model *model, strut_state *state, double dt,
                               int64_t count) {
  small_rk4(model, state, dt, count, (unsigned)COMMON, false);
}

STRUT_SMALL_TARGET
static void small_rk4_with_ledger_8(const strut_model *model, strut_state *state, double dt,
                                    int64_t count) {
  small_rk4(model, state, dt, count, STRUT_TERMS_ALL, true);
}

STRUT_SMALL_TARGET
static void small_rk4_8(const strut_model *model, strut_state *state, double dt, int64_t count) {
  small_rk4(model, state, dt, count, STRUT_TERMS_ALL, false);
}

void strut_small_rk4_avx512(const strut_model *model, strut_state *state, double dt,
                            int64_t count) {
  bool common = !(model->plan & ~(unsigned)COMMON);
  if (common && state->ledger)
    small_rk4_common_with_ledger_8(model, state, dt, count);
  else if (common)
    small_rk4_common_8(model, state, dt, count);
  else if (state->ledger)
    small_rk4_with_ledger_8(model, state, dt, count);
  else
    small_rk4_8(model, state, dt, count);
}
#endif
