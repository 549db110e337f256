/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "engine/statics/modes/parts.h"

enum { MOST_SHIFTS = 4 }; /* where one is an eigenvalue to the last bit */

strut_status strut_modes_solver_create(const strut_vibration *vibration, strut_modes_solver *solver,
                                       strut_error *error) {
  size_t entries = (size_t)vibration->shape->pattern->start[vibration->n];
  *solver = (strut_modes_solver){.v = vibration, .sum = *vibration->shape->pattern};
  solver->sum.value = strut_arena_allocate(&solver->arena, entries, sizeof(double));
  if (!solver->sum.value) return strut_no_memory(error, "");
  return strut_ldl_create(vibration->shape->pattern, &solver->ldl, error);
}

void strut_modes_solver_free(strut_modes_solver *solver) {
  strut_ldl_free(solver->ldl);
  strut_arena_free(&solver->arena);
  *solver = (strut_modes_solver){0};
}

static bool is_interrupted(const strut_modes_solver *solver) {
  return solver->interrupt && *solver->interrupt;
}

void strut_modes_factorise(strut_modes_solver *solver, double shift) {
  const strut_vibration *vibration = solver->v;
  strut_status status = STRUT_SINGULAR;
  for (int i = 0; i < MOST_SHIFTS && status == STRUT_SINGULAR && !is_interrupted(solver); i++) {
    for (int32_t at = 0; at < solver->sum.start[vibration->n]; at++)
      solver->sum.value[at] = vibration->k[at] + shift * vibration->m[at];
    status = strut_ldl_factorise(solver->ldl, &solver->sum, 0.0, &solver->inertia);
    shift *= 1.0 + 1e-3;
  }
  if (status != STRUT_OK) solver->inertia.smallest = 0.0;
  if (status == STRUT_NO_MEMORY) solver->no_memory = true;
}

void strut_modes_solve(strut_modes_solver *solver, double *vector) {
  if (is_interrupted(solver)) return;
  if (solver->inertia.smallest > 0.0)
    strut_ldl_solve(solver->ldl, vector);
  else
    memset(vector, 0, (size_t)solver->v->n * sizeof *vector);
}
