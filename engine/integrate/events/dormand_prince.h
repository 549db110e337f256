/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Dormand and Prince's pair of orders 5 and 4 (J. Comp. Appl. Math. 6, 1980). */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_DORMAND_PRINCE_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_DORMAND_PRINCE_H

enum { PAIR = 7 };

static const double ahead[PAIR] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0, 1.0};
static const double table[PAIR][PAIR - 1] = {
    {0},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
/* Weights of order 5 less those of order 4. */
static const double difference[PAIR] = {71.0 / 57600,      0.0,        -71.0 / 16695, 71.0 / 1920,
                                        -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

#endif
