/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Derivatives of computed numbers by parameters, with an error each: central differences of any function.
 *
 * Of k parameters the function is evaluated 2k + 2 times besides the point itself: a pair along each parameter,
 * and a pair along all of them together with an eighth of the steps, which must agree with the sum of the others.
 * By how much it does not is the error. Where the values on both sides of the point lie on two different lines, as
 * where a contact only just grazes, or where they jump, there is no derivative. What a pair does not change by a bit
 * has the derivative 0, with the error that rounding may hide: 0 of a count, and of a parameter that changes nothing.
 */
#pragma once

#include <stddef.h>

#include "engine/base/status.h"

/** X(NAME, words): what a derivative is worth. */
#define STRUT_DERIVATIVE_VERDICTS(X)                                                               \
  X(UNKNOWN, "not known") /* a value beside the point is missing */                                \
  X(THERE, "differentiable")                                                                       \
  X(NONE, "not differentiable here") /* one-sided derivatives differ */

typedef enum strut_derivative_verdict {
#define STRUT_DERIVATIVE_ENUM(name, words) STRUT_DERIVATIVE_##name,
  STRUT_DERIVATIVE_VERDICTS(STRUT_DERIVATIVE_ENUM)
} strut_derivative_verdict;

typedef struct strut_derivative {
  double value, error; /* NAN unless it is there */
  strut_derivative_verdict verdict;
} strut_derivative;

/** Where the derivatives are taken. */
typedef struct strut_derivatives_parameter {
  double value;
  double low, high; /* values beyond are not asked for; -INFINITY, INFINITY: any may be */
  double scale;     /* a change that matters; 0: the size of the value, or 1 */
} strut_derivatives_parameter;

/** The function at parameters (parameter_count). */
typedef struct strut_derivatives_task {
  size_t parameter_count, output_count;
  const strut_derivatives_parameter *parameters;
  /**
   * Fills outputs (output_count) with values, or NAN, and errors with the error of each: 0 of a count, NAN, as before
   * the call, where it is not known. Called from several threads. STRUT_NO_MEMORY and STRUT_INTERRUPTED end
   * everything; after another failure there are no outputs.
   */
  strut_status (*evaluate)(void *context, const double *parameters, double *outputs, double *errors,
                           strut_error *error);
  void *context;
  const double *outputs, *errors; /* of the point itself; NULL: evaluated as well */
  int threads;                    /* at most, above 0 */
} strut_derivatives_task;

/**
 * derivatives (output_count, parameter_count). The same bits whatever the number of threads. What evaluations
 * that end everything return, and STRUT_NO_MEMORY. On success `error` says why the first point failed that did.
 */
STRUT_API strut_status strut_derivatives_find(const strut_derivatives_task *task,
                                              strut_derivative *derivatives, strut_error *error);
/** "differentiable", ... */
STRUT_API const char *strut_derivative_words(strut_derivative_verdict verdict);
