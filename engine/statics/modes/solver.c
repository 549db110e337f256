/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/modes/solver.h"

#include <math.h>
#include <string.h>

/* Of the largest eigenvalue: below this a shift may drown in a plain factor's rounding. */
static const double SAFE_SHIFT = 1e-10;
static const double SAFE_PIVOT = 1e-9; /* relative: what is less may have the wrong sign */

enum { CORRECTIONS = 2 };

strut_status strut_modes_solver_create(const strut_vibration *v, strut_modes_solver *solver,
                                       strut_error *error) {
  size_t n = (size_t)v->n, entries = (size_t)v->shape->pattern->start[n];
  *solver = (strut_modes_solver){.v = v, .sum = *v->shape->pattern};
  solver->sum.value = strut_arena_allocate(&solver->arena, entries, sizeof(double));
  solver->b = strut_arena_allocate(&solver->arena, n, sizeof *solver->b);
  solver->r = strut_arena_allocate(&solver->arena, n, sizeof *solver->r);
  solver->mx = strut_arena_allocate(&solver->arena, n, sizeof *solver->mx);
  solver->step = strut_arena_allocate(&solver->arena, n, sizeof *solver->step);
  if (!solver->sum.value || !solver->b || !solver->r || !solver->mx || !solver->step)
    return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  strut_status status = strut_ldl_create(v->shape->pattern, &solver->plain, error);
  if (status != STRUT_OK) return status;
  return strut_extended_create(v->shape->pattern, &solver->extended, error);
}

void strut_modes_solver_free(strut_modes_solver *solver) {
  strut_ldl_free(solver->plain);
  strut_extended_free(solver->extended);
  strut_arena_free(&solver->arena);
  *solver = (strut_modes_solver){0};
}

static bool factorise_plainly(strut_modes_solver *s) {
  const strut_vibration *v = s->v;
  strut_inertia inertia;
  for (int32_t i = 0; i < s->sum.start[v->n]; i++)
    s->sum.value[i] = v->k[i].hi + s->shift * v->m[i];
  if (strut_ldl_factorise(s->plain, &s->sum, 0.0, &inertia) != STRUT_OK) return false;
  if (!(inertia.smallest > SAFE_PIVOT)) return false;
  s->negative = inertia.negative;
  s->weakest = inertia.row;
  s->loss = inertia.smallest;
  return true;
}

void strut_modes_factorise(strut_modes_solver *s, double shift) {
  const strut_vibration *v = s->v;
  s->shift = shift;
  s->is_plain = fabs(shift) >= SAFE_SHIFT * v->largest && factorise_plainly(s);
  if (s->is_plain) return;
  strut_extended_factorise(s->extended, v->shape->pattern, v->k, v->m, shift);
  s->negative = s->extended->negative;
  s->weakest = s->extended->weakest;
  s->loss = s->extended->loss;
}

void strut_modes_solve(strut_modes_solver *s, strut_dd *x) {
  const strut_vibration *v = s->v;
  int32_t n = v->n;
  if (!s->is_plain) {
    strut_extended_solve(s->extended, x);
    return;
  }
  memcpy(s->b, x, (size_t)n * sizeof *x);
  for (int32_t i = 0; i < n; i++) s->step[i] = dd_double(x[i]);
  strut_ldl_solve(s->plain, s->step);
  for (int32_t i = 0; i < n; i++) x[i] = dd_of(s->step[i]);
  for (int k = 0; k < CORRECTIONS; k++) {
    strut_vibration_stiffness(v, x, s->r);
    strut_vibration_mass(v, x, s->mx);
    for (int32_t i = 0; i < n; i++)
      s->step[i] = dd_double(dd_sub(s->b[i], dd_add(s->r[i], dd_scale(s->mx[i], s->shift))));
    strut_ldl_solve(s->plain, s->step);
    for (int32_t i = 0; i < n; i++) x[i] = dd_add(x[i], dd_of(s->step[i]));
  }
}
