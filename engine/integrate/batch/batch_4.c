/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rk4 for batches of 4 lanes. */
#define STRUT_BATCH_WIDTH 4
#if defined(__x86_64__)
#define STRUT_BATCH_TARGET __attribute__((target("avx2")))
#endif
#include "engine/integrate/batch/batch_rk4.h"

void strut_batch_rk4_4(strut_batch *batch, int64_t count) { batch_rk4(batch, count); }
