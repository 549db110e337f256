/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The crawler straight from the paper, as a yardstick that shares no code with strut.
 *
 * A state z holds positions and then velocities: (x1, y1, ..., x5, y5, their rates), in SI units.
 */
#pragma once

#include <stdbool.h>

enum { REFERENCE_NODES = 5, REFERENCE_STATE = 4 * REFERENCE_NODES };

typedef struct reference_crawler {
  double inverse_mass[2 * REFERENCE_NODES][2 * REFERENCE_NODES]; /* filled by reference_prepare */
  double frequency, amplitude, mu;                               /* [Hz], [m], [1] */
  bool half_wave; /* drives during the first half of its first period only: (15) */
} reference_crawler;

/** Over the window at the run's end: (14) in [m/s], fractions of steps, heights in [m]. */
typedef struct reference_figures {
  double velocity, velocity_one; /* of the centre of mass, of node 1 */
  double duty[REFERENCE_NODES], highest[REFERENCE_NODES];
} reference_figures;

/** Fills the inverse mass, and z with state I as drawn, or with its mirror image, state II. */
void reference_prepare(reference_crawler *it, int mirrored, double *z);
/**
 * Lets it come to rest on the ground: drive and friction off, velocities to zero at each peak of
 * the kinetic energy. False: it did not.
 */
int reference_settle(const reference_crawler *it, double dt, double *z);
/** The step from n dt to (n + 1) dt. */
void reference_step(const reference_crawler *it, long n, double dt, double *z);
/** The centre of mass, along the ground [m]. */
double reference_centre(const double *q);
/** Runs so many periods from z on, and measures over the last `window` of them. */
void reference_run(const reference_crawler *it, double dt, double periods, double window, double *z,
                   reference_figures *figures);
