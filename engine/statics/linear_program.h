/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The seam around GLPK: a linear programme with bounds, solved by the simplex method.
 *
 * The same programme gives the same bits.
 */
#ifndef STRUT_ENGINE_STATICS_LINEAR_PROGRAM_H
#define STRUT_ENGINE_STATICS_LINEAR_PROGRAM_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/memory.h"
#include "engine/base/status.h"

/** Least sum of cost x with row_low <= A x <= row_high, low <= x <= high; all may be infinite. */
typedef struct strut_linear_program {
  int32_t rows, columns;
  double *row_low, *row_high; /* (rows); 0 at first */
  double *low, *high, *cost;  /* (columns); 0, INFINITY, 0 at first */
  size_t entry_count, entry_room;
  int32_t *entry_row, *entry_column; /* each place once */
  double *entry;
  const volatile sig_atomic_t *interrupt; /* ends the solution; NULL at first */
} strut_linear_program;

typedef enum strut_linear_program_end {
  STRUT_PROGRAM_OPTIMAL,
  STRUT_PROGRAM_INFEASIBLE,
  STRUT_PROGRAM_UNBOUNDED,
  STRUT_PROGRAM_FAILED /* the simplex method gave up */
} strut_linear_program_end;

/** Room for `entries` nonzeros, all in the arena; false: out of memory. */
bool strut_linear_program_create(strut_linear_program *program, int32_t rows, int32_t columns,
                                 size_t entries, strut_arena *arena);
/** A(row, column) = value; nothing where it is 0. */
void strut_linear_program_add(strut_linear_program *program, int32_t row, int32_t column,
                              double value);
/** x (columns) and the sum, filled where optimal; STRUT_NO_MEMORY, STRUT_INTERRUPTED or STRUT_OK. */
strut_status strut_linear_program_solve(const strut_linear_program *program, double *x, double *sum,
                                        strut_linear_program_end *end);

#endif
