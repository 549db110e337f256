/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The methods for batches of 2 lanes. */
#define STRUT_LANE_WIDTH 2
#include "engine/integrate/batch_rk4.h"

STRUT_LANE_TARGET
static void rk4_plain(strut_batch *batch, int64_t count) { batch_rk4_steps(batch, count, false); }

STRUT_LANE_TARGET
static void rk4_with_ledger(strut_batch *batch, int64_t count) {
  batch_rk4_steps(batch, count, true);
}

void strut_batch_rk4_2(strut_batch *batch, int64_t count) {
  if (batch->ledger)
    rk4_with_ledger(batch, count);
  else
    rk4_plain(batch, count);
}
