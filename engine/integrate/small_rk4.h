/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the classical Runge-Kutta method of small models; see rk4.c, whose operations these are.
 */
#ifndef STRUT_ENGINE_INTEGRATE_SMALL_RK4_H
#define STRUT_ENGINE_INTEGRATE_SMALL_RK4_H

#include "engine/integrate/small_run.h"

/* z + sixth (k1 + 2 (k2 + k3) + k4) */
STRUT_SMALL_INLINE small_row small_combine(small_row z, double sixth, small_row k1, small_row k2,
                                           small_row k3, small_row k4) {
  SMALL_EACH(p) {
    small_real sum = k1.part[p] + 2.0 * (k2.part[p] + k3.part[p]) + k4.part[p];
    z.part[p] = z.part[p] + sixth * sum;
  }
  return z;
}

/* One step over the rest lengths at its begin, middle and end. The powers of its stages are summed at once. */
STRUT_SMALL_INLINE void small_rk4_step(const small_run *r, const small_rest *rest, int stride,
                                       double dt, small_motion *m, bool ledger,
                                       small_work4 *powers) {
  small_points v[4], a[4], q;
  small_entries entries[4];
  const double half = 0.5 * dt, sixth = dt / 6.0;
  v[0] = m->v;
#define SMALL_STAGE(k, at, where)                                                                  \
  a[k] = small_accelerate(r, rest + (at)*stride, where, &v[k], ledger, &m->f, &entries[k])
#define SMALL_NEXT(k, h)                                                                           \
  do {                                                                                             \
    q.x = small_ahead(m->q.x, h, v[(k)-1].x), q.y = small_ahead(m->q.y, h, v[(k)-1].y);            \
    v[k].x = small_ahead(m->v.x, h, a[(k)-1].x), v[k].y = small_ahead(m->v.y, h, a[(k)-1].y);      \
  } while (0)
  SMALL_STAGE(0, 0, &m->q);
  SMALL_NEXT(1, half);
  SMALL_STAGE(1, 1, &q);
  SMALL_NEXT(2, half);
  SMALL_STAGE(2, 1, &q);
  SMALL_NEXT(3, dt);
  SMALL_STAGE(3, 2, &q);
#undef SMALL_STAGE
#undef SMALL_NEXT
  m->q.x = small_combine(m->q.x, sixth, v[0].x, v[1].x, v[2].x, v[3].x);
  m->q.y = small_combine(m->q.y, sixth, v[0].y, v[1].y, v[2].y, v[3].y);
  m->v.x = small_combine(m->v.x, sixth, a[0].x, a[1].x, a[2].x, a[3].x);
  m->v.y = small_combine(m->v.y, sixth, a[0].y, a[1].y, a[2].y, a[3].y);
  if (!ledger) return;
  *powers = small_sum_powers_of_4(r, entries);
  small_add_work_of_4(&m->work, (strut_lanes){1, 2, 2, 1} * sixth, powers);
}

STRUT_SMALL_INLINE void small_rk4(const strut_model *model, strut_state *state,
                                  const strut_small_kept *kept, double dt, int64_t count,
                                  unsigned terms, bool ledger) {
  (void)kept;
  small_run run;
  strut_small_inputs inputs;
  small_rest rows[SMALL_INSTANTS];
  small_motion m;
  small_work4 powers = {0};
  small_begin(model, state, terms, 2 * count + 1, &run, &inputs, rows, &m);
  int stride = run.plan & STRUT_TERM_DRIVE && model->drives.count ? 1 : 0;
  for (int64_t left = count; left > 0;) {
    int32_t steps = left < SMALL_STEPS ? (int32_t)left : SMALL_STEPS;
    if (stride) small_drive_instants(model, state, dt, 0.5, 2 * steps + 1, rows);
    for (int32_t n = 0; n < steps; n++)
      small_rk4_step(&run, rows + 2 * n * stride, stride, dt, &m, ledger, &powers);
    state->step += steps;
    state->evaluations += 4 * steps;
    left -= steps;
    if (left == 0 && ledger) m.power = small_last_of_4(&powers);
    if (left == 0) small_end(&run, state, dt, rows + 2 * steps * stride, &m, ledger);
  }
}

#endif
