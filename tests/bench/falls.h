/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What events cost a large structure with many contacts. */
#ifndef STRUT_TESTS_BENCH_FALLS_H
#define STRUT_TESTS_BENCH_FALLS_H

/** Prints processor time of a step by each method, and how many times that of `rk4`: a grid of about so many
    nodes, ten high, falls on its lowest row; 0: 3000. */
void bench_falls(long nodes);

#endif
