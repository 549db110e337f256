/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the classical Runge-Kutta method of small models; see rk4.c, whose operations these are.
 */
#ifndef STRUT_ENGINE_INTEGRATE_SMALL_RK4_H
#define STRUT_ENGINE_INTEGRATE_SMALL_RK4_H

#include "engine/integrate/small_run.h"

/* The end of a step, see rk4_end. */
STRUT_SMALL_INLINE small_row small_combine(small_row z, double sixth, small_row k1, small_row inner,
                                           small_row k4) {
  SMALL_EACH(p)
  z.part[p] = small_rk4_end(z.part[p], small_all(sixth), k1.part[p], inner.part[p], k4.part[p]);
  return z;
}
STRUT_SMALL_INLINE small_row small_add(small_row a, small_row b) {
  SMALL_EACH(p) a.part[p] = a.part[p] + b.part[p];
  return a;
}

/*
 * Forces f and accelerations at positions q and velocities v. shapes: of the members at q; they become those
 * at next_q, the positions of the stage after, which are known already: so roots and divisions are there when
 * velocities are. powers: those of this stage, where the energy balance is kept.
 */
STRUT_SMALL_INLINE small_points small_stage(const small_run *r, const small_rest *rest,
                                            const small_points *q, const small_points *next_q,
                                            small_shapes *shapes, const small_points *v,
                                            small_points *f, bool balance,
                                            small_stage_powers *powers) {
  small_pulls px, py;
  small_touch touch = {0};
  small_run run = *r;
  if (balance) SMALL_READS_AGAIN(run.tables);
  r = &run;
  small_members(r, rest, shapes, next_q, v, balance, &px, &py, &powers->members);
  *f = small_sum_pulls(r, &px, &py);
  small_ground(r, q, v, f, balance, &touch);
  if (balance) small_accumulate_touch(r, &touch, powers);
  return small_divide_points(r->tables, f);
}

/*
 * One step over the rest lengths at its begin, middle and end; shapes: of the members where it begins, and
 * then where it ends. Of the two inner stages sums are kept.
 */
STRUT_SMALL_INLINE void small_rk4_step(const small_run *r, const small_rest *rest, int stride,
                                       double dt, small_motion *m, small_shapes *shapes,
                                       bool balance) {
  small_points q = m->q, next_q, v = m->v, a, first, inner_v, inner_a;
  small_stage_powers powers[4];
  const double half = 0.5 * dt, sixth = dt / 6.0;
#define SMALL_AHEAD(h)                                                                             \
  next_q.x = small_ahead(m->q.x, h, v.x), next_q.y = small_ahead(m->q.y, h, v.y)
#define SMALL_STAGE(at, k)                                                                         \
  a = small_stage(r, rest + (at)*stride, &q, &next_q, shapes, &v, &m->f, balance, &powers[k]);     \
  q = next_q
#define SMALL_NEXT(h) v.x = small_ahead(m->v.x, h, a.x), v.y = small_ahead(m->v.y, h, a.y)
  SMALL_AHEAD(half);
  SMALL_STAGE(0, 0);
  first = a;
  SMALL_NEXT(half);
  SMALL_AHEAD(half);
  inner_v = v;
  SMALL_STAGE(1, 1);
  inner_a = a;
  SMALL_NEXT(half);
  SMALL_AHEAD(dt);
  inner_v.x = small_add(inner_v.x, v.x), inner_v.y = small_add(inner_v.y, v.y);
  SMALL_STAGE(1, 2);
  inner_a.x = small_add(inner_a.x, a.x), inner_a.y = small_add(inner_a.y, a.y);
  SMALL_NEXT(dt);
  next_q.x = small_combine(m->q.x, sixth, m->v.x, inner_v.x, v.x);
  next_q.y = small_combine(m->q.y, sixth, m->v.y, inner_v.y, v.y);
  SMALL_STAGE(2, 3);
#undef SMALL_AHEAD
#undef SMALL_STAGE
#undef SMALL_NEXT
  m->q = q;
  m->v.x = small_combine(m->v.x, sixth, first.x, inner_a.x, a.x);
  m->v.y = small_combine(m->v.y, sixth, first.y, inner_a.y, a.y);
  if (!balance) return;
  SMALL_WAITS_IN_MEMORY(powers);
  small_end_stages(r, powers, sixth, &m->work);
}

STRUT_SMALL_INLINE void small_rk4(const strut_model *model, strut_state *state,
                                  const strut_small_kept *kept, double dt, int64_t count,
                                  unsigned terms, bool balance) {
  (void)kept;
  small_run run;
  strut_small_inputs inputs;
  small_rest rows[SMALL_INSTANTS];
  small_motion m;
  small_begin(model, state, terms, 2 * count + 1, &run, &inputs, rows, &m);
  small_shapes shapes = {0};
  small_measure_members(run.tables, &m.q, &shapes);
  m.power = (small_work){0}; /* none but those of the step, see step_balance.h */
  int stride = run.terms & STRUT_TERM_DRIVE && model->drives.count ? 1 : 0;
  for (int64_t left = count; left > 0;) {
    int32_t steps = left < SMALL_STEPS ? (int32_t)left : SMALL_STEPS;
    if (stride) small_drive_instants(model, state, dt, 0.5, 2 * steps + 1, rows);
    for (int32_t n = 0; n < steps; n++)
      small_rk4_step(&run, rows + 2 * n * stride, stride, dt, &m, &shapes, balance);
    state->step += steps;
    state->evaluations += 4 * steps;
    left -= steps;
    if (left == 0) small_end(&run, state, dt, rows + 2 * steps * stride, &m, balance);
  }
}

#endif
