/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What a force evaluation costs by each method. */
#pragma once

/** Prints a row for each method: processor time of an evaluation in the crawler, and how many times that of
    `rk4`; the best of `repeats`. only: of this method; NULL: of all. All but rk4 take steps that are so many times
    `finer`: at 16 hardly one of them meets an event. */
void bench_methods(int repeats, const char *only, double finer);
