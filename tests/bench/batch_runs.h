/* SPDX-License-Identifier: GPL-3.0-or-later */
/** How long a step of a lane takes: the crawler at other frequencies in each lane. */
#ifndef STRUT_TESTS_BENCH_BATCH_RUNS_H
#define STRUT_TESTS_BENCH_BATCH_RUNS_H

/** Single runs and batches of 2, 4 and 8 lanes take turns; prints the medians. */
void bench_batch(int repeats);

#endif
