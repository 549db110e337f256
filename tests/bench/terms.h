/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What each term costs: the crawler with it and without it, in turn. */
#ifndef STRUT_TESTS_BENCH_TERMS_H
#define STRUT_TESTS_BENCH_TERMS_H

/** Prints a row for each term: times of a step with and without, medians of `repeats`. */
void bench_terms(int repeats);

#endif
