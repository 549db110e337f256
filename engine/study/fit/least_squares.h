/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Nonlinear least squares: the parameters with the least sum of squared residuals, by GSL's trust-region method
 * (Levenberg and Marquardt) on central differences; and what the residuals say of them.
 *
 * Parameters are scaled by the caller so that a change of 1 is large, and lie in a box. Outside of it residuals are
 * those of the nearest point of the box, and further ones draw back to it. A parameter that would leave the box, or go
 * where there are no residuals, stays where it is as long as that is so.
 */
#pragma once

#include "engine/base/memory.h"
#include "engine/base/status.h"

enum { STRUT_LEAST_SQUARES_MOST = 60 }; /* parameters */

typedef struct strut_least_squares {
  size_t count;             /* of residuals, >= parameters */
  size_t parameters;        /* <= STRUT_LEAST_SQUARES_MOST */
  const double *low, *high; /* (parameters) the box; infinite where there is no bound */
  double step;              /* of differences, relative to a parameter where that is above 1 */
  double near;              /* changes of parameters at which the method ends, relative likewise */
  bool one_sided;           /* differences that cost half, where they need not be exact */
  int32_t held;             /* this parameter stays where it is; -1: none */
  int32_t most_steps;       /* of the method */
  /**
   * Fills the residuals (count) at the parameters; false where there are none: the point counts as worse than
   * others.
   */
  bool (*residuals)(void *context, const double *parameters, double *residual);
  void *context;
} strut_least_squares;

typedef enum strut_fit_end {
  STRUT_FIT_CONVERGED,
  STRUT_FIT_STUCK,  /* too many steps, or residuals end where they get smaller */
  STRUT_FIT_FAILED, /* there are no residuals where it begins */
  STRUT_FIT_NONE,   /* nothing was to be solved */
  STRUT_FIT_SPENT,  /* it took more evaluations than it may */
  STRUT_FIT_END_COUNT
} strut_fit_end;

/** "converged", ... */
extern const char *const strut_fit_ends[STRUT_FIT_END_COUNT];

typedef struct strut_fit_solution {
  strut_fit_end end;
  double sum; /* of squared residuals */
} strut_fit_solution;

/** Moves the parameters to the least sum nearby. STRUT_OK, whatever the end; STRUT_NO_MEMORY. */
STRUT_API strut_status strut_least_squares_solve(const strut_least_squares *problem,
                                                 double *parameters, strut_fit_solution *solution);
/**
 * The matrix (count, parameters) of derivatives, row by row; `residual` (count) there. False: there is none, or
 * memory is out.
 */
STRUT_API bool strut_least_squares_jacobian(const strut_least_squares *problem,
                                            const double *parameters, double *residual,
                                            double *jacobian);

/** What a matrix of derivatives says: singular value decomposition and covariance for residuals of variance 1. */
typedef struct strut_fit_spectrum {
  size_t parameters;
  double *singular;   /* (parameters) descending */
  double *direction;  /* (parameters, parameters) that of singular value k in row k */
  double *covariance; /* (parameters, parameters); HUGE_VAL on its diagonal: not determined */
} strut_fit_spectrum;

/** From the matrix (count, parameters), which is overwritten, in the arena. False: memory is out. */
STRUT_API bool strut_fit_spectrum_find(double *jacobian, size_t count, size_t parameters,
                                       strut_arena *arena, strut_fit_spectrum *spectrum);
