/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * When the steps of a run end: at whole multiples of the step, but for a last one that ends the run.
 */
#ifndef STRUT_ENGINE_RUN_MEASURE_TIME_GRID_H
#define STRUT_ENGINE_RUN_MEASURE_TIME_GRID_H

#include <stdint.h>

typedef struct strut_time_grid {
  double step;   /* [s] */
  double offset; /* the time at step 0: not 0 in a run that goes on from between two steps [s] */
  int64_t last;  /* the step that ends the run at `end`; -1: none does */
  double end;    /* less the offset [s] */
} strut_time_grid;

/** When step n has ended, less the offset [s]: what methods and forces call the time. */
static inline double strut_time_grid_at(const strut_time_grid *grid, int64_t n) {
  return n == grid->last ? grid->end : (double)n * grid->step;
}

/** When step n has ended [s]: what is reported. */
static inline double strut_time_grid_real(const strut_time_grid *grid, int64_t n) {
  return grid->offset + strut_time_grid_at(grid, n);
}

/** The length of the last step, where it is shorter than the others; else 0 [s]. */
static inline double strut_time_grid_rest(const strut_time_grid *grid) {
  double rest = grid->last > 0 ? grid->end - (double)(grid->last - 1) * grid->step : grid->step;
  return rest < grid->step * (1.0 - 1e-6) ? rest : 0.0;
}

/** The cubic through both ends of a step with their slopes: at the fraction s of a step of length h, from x0 with slope v0 to x1 with slope v1. */
static inline double strut_hermite(double x0, double v0, double x1, double v1, double h, double s) {
  double r = 1.0 - s;
  return x0 * (1.0 + 2.0 * s) * r * r + h * v0 * s * r * r + x1 * s * s * (3.0 - 2.0 * s) -
         h * v1 * s * s * r;
}

#endif
