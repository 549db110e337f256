/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The yardstick: the paper's crawler as a kernel written by hand for this one structure.
 *
 * Table 1 is compiled in; equations (1) to (10) with the laws (8) and (9) as printed, RK4, drive
 * a sin(2 pi f t) on member 8, mu for both friction coefficients.
 */
#pragma once

/** Nodes 1 to 5 at time n * dt; SI units. */
typedef struct hand_crawler_state {
  double x[5], y[5], vx[5], vy[5];
  long long n;
} hand_crawler_state;

/** State I of the paper as drawn (equations (12)), or its mirror image, state II; at rest. */
void hand_crawler_place(hand_crawler_state *state, int mirrored);

/** Advances by so many steps of dt [s]; drive f [Hz], a [m]. Plain scalar straight-line code. */
void hand_crawler_run_scalar(hand_crawler_state *state, double dt, double f, double a, double mu,
                             long long steps);
