/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lowest modes of a large structure: bracketed by counting, found by Lanczos's method. */
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/modes/lanczos.h"
#include "engine/statics/modes/parts.h"

enum { MOST_FACTORS = 80 };

/* Eigenvalues below z, by the signs of the factor of K - z M. */
static int32_t count_below(strut_modes_work *work, double z) {
  strut_modes_factorise(&work->solver, -z);
  return work->solver.negative;
}

/* Some z > 0 with at least `count` and a few more eigenvalues below; *below gets how many. */
static double find_bound(strut_modes_work *work, int32_t count, int32_t *below) {
  double low = 0.0, high = 0.0, z = 1e-7 * work->v->largest;
  int32_t least = count + 2, most = 2 * count + 10;
  for (int i = 0; i < MOST_FACTORS; i++) {
    int32_t found = count_below(work, z);
    if (found < least)
      low = z;
    else
      high = z, *below = found;
    if (found >= least && found <= most) break;
    if (low > 0 && high > 0 && high < 1.0001 * low) break; /* many at one place */
    z = low > 0 && high > 0 ? sqrt(low * high) : low > 0 ? 30.0 * low : 0.01 * high;
  }
  return high;
}

static void solve(void *context, double *x) {
  strut_modes_work *work = context;
  strut_dd *y = work->v->work;
  for (int32_t i = 0; i < work->v->n; i++) y[i] = dd_of(x[i]);
  strut_modes_solve(&work->solver, y);
  for (int32_t i = 0; i < work->v->n; i++) x[i] = dd_double(y[i]);
}

static void mass(void *context, const double *x, double *y) {
  strut_modes_work *work = context;
  strut_vibration_multiply(work->v, work->v->m, x, y);
}

strut_status strut_modes_sparse(strut_modes_work *work, int32_t count, strut_error *error) {
  strut_vibration *v = work->v;
  int32_t below = 0;
  if (count > v->massive - 3) count = v->massive - 3; /* Lanczos's method wants a few to spare */
  double bound = find_bound(work, count, &below), shift = -1e-3 * bound;
  if (below >= v->massive) below = v->massive - 1;
  size_t room = (size_t)below;
  strut_eigen_set *set = &work->set;
  set->n = v->n;
  set->count = below;
  set->value = strut_arena_allocate(work->arena, room, sizeof *set->value);
  set->vector = strut_arena_allocate(work->arena, room * (size_t)v->n, sizeof *set->vector);
  if (!set->value || !set->vector) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  for (int i = 0; i < MOST_FACTORS && count_below(work, shift) > 0; i++) shift *= 4.0;
  strut_lanczos_problem problem = {v->n, shift, work, solve, mass};
  strut_status status = strut_lanczos(&problem, below, set->value, set->vector, error);
  /* All that the signs have counted must be there. */
  if (status == STRUT_OK && !(set->value[below - 1] < 1.001 * bound))
    status = strut_fail(error, STRUT_SINGULAR,
                        "Lanczos's method missed some of the %d modes below %.4g Hz that there are",
                        (int)below, sqrt(bound) / STRUT_TAU);
  return status;
}
