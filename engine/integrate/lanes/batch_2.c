/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The methods for batches of 2 lanes. */
#define STRUT_LANE_WIDTH 2
#include "engine/integrate/lanes/batch_rk4.h"
#include "engine/integrate/lanes/batch_verlet.h"

void strut_batch_rk4_2(strut_batch *batch, int64_t count) { batch_rk4(batch, count); }

const strut_batch_kernels strut_batch_verlet_2 = {verlet_predict_any, verlet_correct_any,
                                                  verlet_measure_any};
