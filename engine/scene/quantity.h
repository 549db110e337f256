/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Measured quantities: an expression of columns of the motion, and its reduction to a number over
 * the window.
 *
 * An expression is a short program in postfix order for a stack of numbers. The parser compiles it,
 * with all names resolved and dimensions checked; the engine evaluates it after each step of the
 * window.
 */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "engine/scene/observables.h"

/** How a result changes with its operands; see engine/run/measure/quantities.c. */
typedef enum strut_sensitivity {
  STRUT_SENSITIVITY_SUM, /* as much as they do */
  STRUT_SENSITIVITY_PRODUCT,
  STRUT_SENSITIVITY_QUOTIENT,
  STRUT_SENSITIVITY_POWER,
  STRUT_SENSITIVITY_ROOT,
  STRUT_SENSITIVITY_EXPONENTIAL,
  STRUT_SENSITIVITY_LOGARITHM, /* relative to the first */
  STRUT_SENSITIVITY_BOUNDED    /* likewise, while it is at most 1 */
} strut_sensitivity;

/** X(id, operands, word, sensitivity); the functions are those of the language. */
#define STRUT_OPERATION_TABLE(X)                                                                   \
  X(NUMBER, 0, "", SUM)                                                                            \
  X(COLUMN, 0, "", SUM)                                                                            \
  X(ADD, 2, "+", SUM)                                                                              \
  X(SUBTRACT, 2, "-", SUM)                                                                         \
  X(MULTIPLY, 2, "*", PRODUCT)                                                                     \
  X(DIVIDE, 2, "/", QUOTIENT)                                                                      \
  X(POWER, 2, "^", POWER)                                                                          \
  X(NEGATE, 1, "-", SUM)                                                                           \
  X(SIN, 1, "sin", BOUNDED)                                                                        \
  X(COS, 1, "cos", BOUNDED)                                                                        \
  X(TAN, 1, "tan", SUM)                                                                            \
  X(ASIN, 1, "asin", BOUNDED)                                                                      \
  X(ACOS, 1, "acos", BOUNDED)                                                                      \
  X(ATAN, 1, "atan", BOUNDED)                                                                      \
  X(ATAN2, 2, "atan2", LOGARITHM)                                                                  \
  X(SQRT, 1, "sqrt", ROOT)                                                                         \
  X(EXP, 1, "exp", EXPONENTIAL)                                                                    \
  X(LOG, 1, "log", LOGARITHM)                                                                      \
  X(LOG10, 1, "log10", LOGARITHM)                                                                  \
  X(TANH, 1, "tanh", BOUNDED)                                                                      \
  X(ABS, 1, "abs", SUM)                                                                            \
  X(MIN, 2, "min", SUM)                                                                            \
  X(MAX, 2, "max", SUM)                                                                            \
  X(FLOOR, 1, "floor", SUM)                                                                        \
  X(CEIL, 1, "ceil", SUM)                                                                          \
  X(ROUND, 1, "round", SUM)                                                                        \
  X(HYPOT, 2, "hypot", SUM)

typedef enum strut_operation {
#define STRUT_OPERATION_ENUM(id, ...) STRUT_OPERATION_##id,
  STRUT_OPERATION_TABLE(STRUT_OPERATION_ENUM) STRUT_OPERATION_COUNT
} strut_operation;

/** One operation: pushes a number or a column, or replaces its operands by their result. */
typedef struct strut_instruction {
  strut_operation operation;
  strut_column column; /* of COLUMN */
  double number;       /* of NUMBER, SI */
  const char *unit;    /* of NUMBER: unit as written, such as "kg m s^-2"; or NULL */
} strut_instruction;

/** Reduction of the values of a quantity over the window. */
typedef enum strut_reduction {
  STRUT_TAKE_MEAN,
  STRUT_TAKE_MIN,
  STRUT_TAKE_MAX,
  STRUT_TAKE_RANGE, /* max - min */
  STRUT_TAKE_RMS,
  STRUT_TAKE_FINAL,  /* at the window's end */
  STRUT_TAKE_CHANGE, /* end - begin */
  STRUT_TAKE_RATE,   /* change per second */
  STRUT_TAKE_RISE,   /* sum of all increases: of the work of drives that which is positive */
  STRUT_TAKE_ARRIVAL /* time at which `target` is first reached or passed [s]; missing: never */
} strut_reduction;

typedef struct strut_quantity_definition {
  const char *name, *unit;    /* unit of the value; "1": none */
  size_t length, depth;       /* instructions; the most numbers on the stack */
  strut_instruction *program; /* (length) */
  strut_reduction take;
  double accuracy;           /* wanted; 0: that of the run */
  const char *accuracy_unit; /* `unit`; NULL: it is relative */
  double target;             /* of ARRIVAL, in the expression's SI unit */
  const char *target_unit;   /* of ARRIVAL: that unit; "1": none */
} strut_quantity_definition;

/** Is its value a sum over the window? */
static inline bool strut_takes_sum(const strut_quantity_definition *quantity) {
  return quantity->take == STRUT_TAKE_MEAN || quantity->take == STRUT_TAKE_RMS ||
         quantity->take == STRUT_TAKE_RISE;
}

/**
 * Error allowed for a value of a quantity, in its unit, where `accuracy` is that of the run. Relative ones refer to
 * the value, or to a thousandth of its largest term, `scale`, if that is larger.
 */
static inline double strut_quantity_allowed_error(const strut_quantity_definition *definition,
                                                  double accuracy, double value, double scale) {
  if (definition->accuracy_unit) return definition->accuracy;
  double part = definition->accuracy > 0.0 ? definition->accuracy : accuracy;
  return part * fmax(fabs(value), 1e-3 * scale);
}
