/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * End times of the steps of a run: whole multiples of the step, except for a shorter last one.
 * Interpolation within a step.
 */
#ifndef STRUT_ENGINE_RUN_MEASURE_TIME_GRID_H
#define STRUT_ENGINE_RUN_MEASURE_TIME_GRID_H

#include <stdint.h>

typedef struct strut_time_grid {
  double step;   /* [s] */
  double offset; /* time of step 0, not 0 in a run that starts between two steps [s] */
  int64_t last;  /* last step, which ends at `end`; -1: none */
  double end;    /* end of the run without the offset [s] */
} strut_time_grid;

/** End of step n without the offset [s]: the time of methods and forces. */
static inline double strut_time_grid_at(const strut_time_grid *grid, int64_t n) {
  return n == grid->last ? grid->end : (double)n * grid->step;
}

/** End of step n [s], as reported. */
static inline double strut_time_grid_real(const strut_time_grid *grid, int64_t n) {
  return grid->offset + strut_time_grid_at(grid, n);
}

/** Length of the last step [s] where it is shorter than the others, otherwise 0. */
static inline double strut_time_grid_rest(const strut_time_grid *grid) {
  double rest = grid->last > 0 ? grid->end - (double)(grid->last - 1) * grid->step : grid->step;
  return rest < grid->step * (1.0 - 1e-6) ? rest : 0.0;
}

/**
 * Cubic Hermite interpolation at the fraction s of a step of length h, from x0 with slope v0 to x1
 * with slope v1.
 */
static inline double strut_hermite(double x0, double v0, double x1, double v1, double h, double s) {
  double r = 1.0 - s;
  return x0 * (1.0 + 2.0 * s) * r * r + h * v0 * s * r * r + x1 * s * s * (3.0 - 2.0 * s) -
         h * v1 * s * s * r;
}

#endif
