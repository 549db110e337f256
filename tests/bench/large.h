/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the order of nodes and members costs a large structure. */
#ifndef STRUT_TESTS_BENCH_LARGE_H
#define STRUT_TESTS_BENCH_LARGE_H

/** Prints a table for grids of X-frames of so many members; 0: of 1e4, 1e5 and 1e6. */
void bench_large(long members);

#endif
