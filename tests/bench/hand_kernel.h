/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The yardstick: the paper's crawler as a kernel written by hand for this one structure.
 *
 * Table 1 is compiled in; equations (1) to (10) with the laws (8) and (9) as printed, RK4 with 0.1 ms, a drive of
 * 0.1 mm and 10 Hz on member 8, mu = 0.1 for both friction coefficients.
 */
#pragma once

/** x of node 1 [m] so many steps after state I as drawn (equations (12)), at rest. */
double hand_crawler_run(long long steps);
