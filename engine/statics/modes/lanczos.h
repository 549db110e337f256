/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The lowest eigenpairs of K x = z M x by shift-invert Lanczos: the seam around ARPACK.
 *
 * ARPACK keeps its state in static variables, so that one lock lets one search run at a time.
 */
#ifndef STRUT_ENGINE_STATICS_MODES_LANCZOS_H
#define STRUT_ENGINE_STATICS_MODES_LANCZOS_H

#include <signal.h>
#include <stdint.h>

#include "engine/base/status.h"

typedef struct strut_lanczos_problem {
  int32_t n;
  double shift; /* below all eigenvalues */
  void *context;
  void (*solve)(void *context, double *x);                 /* x becomes (K - shift M)^-1 x */
  void (*mass)(void *context, const double *x, double *y); /* y = M x */
  const volatile sig_atomic_t *interrupt; /* ends it with STRUT_INTERRUPTED; or NULL */
} strut_lanczos_problem;

/**
 * The `count` eigenvalues next above the shift, ascending, and their vectors (count, n) with
 * x'Mx = 1. count < n. The start vector is always the same. STRUT_SINGULAR where it does not
 * converge, STRUT_NO_MEMORY.
 */
strut_status strut_lanczos(const strut_lanczos_problem *problem, int32_t count, double *value,
                           double *vector, strut_error *error);

#endif
