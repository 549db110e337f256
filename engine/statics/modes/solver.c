/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "engine/statics/modes/parts.h"

enum { MOST_SHIFTS = 4 }; /* where one is an eigenvalue to the last bit */

strut_status strut_modes_solver_create(const strut_vibration *v, strut_modes_solver *solver,
                                       strut_error *error) {
  size_t entries = (size_t)v->shape->pattern->start[v->n];
  *solver = (strut_modes_solver){.v = v, .sum = *v->shape->pattern};
  solver->sum.value = strut_arena_allocate(&solver->arena, entries, sizeof(double));
  if (!solver->sum.value) return strut_no_memory(error, "");
  return strut_ldl_create(v->shape->pattern, &solver->ldl, error);
}

void strut_modes_solver_free(strut_modes_solver *solver) {
  strut_ldl_free(solver->ldl);
  strut_arena_free(&solver->arena);
  *solver = (strut_modes_solver){0};
}

static bool is_interrupted(const strut_modes_solver *s) { return s->interrupt && *s->interrupt; }

void strut_modes_factorise(strut_modes_solver *s, double shift) {
  const strut_vibration *v = s->v;
  strut_status status = STRUT_SINGULAR;
  for (int i = 0; i < MOST_SHIFTS && status == STRUT_SINGULAR && !is_interrupted(s); i++) {
    for (int32_t at = 0; at < s->sum.start[v->n]; at++)
      s->sum.value[at] = v->k[at] + shift * v->m[at];
    status = strut_ldl_factorise(s->ldl, &s->sum, 0.0, &s->inertia);
    shift *= 1.0 + 1e-3;
  }
  if (status != STRUT_OK) s->inertia.smallest = 0.0;
  if (status == STRUT_NO_MEMORY) s->no_memory = true;
}

void strut_modes_solve(strut_modes_solver *s, double *x) {
  if (is_interrupted(s)) return;
  if (s->inertia.smallest > 0.0)
    strut_ldl_solve(s->ldl, x);
  else
    memset(x, 0, (size_t)s->v->n * sizeof *x);
}
