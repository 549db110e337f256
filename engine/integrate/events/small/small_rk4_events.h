/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the classical Runge-Kutta method between events for small models; see rk4_events.c, whose operations
 * these are.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_RK4_EVENTS_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_RK4_EVENTS_H

#include "engine/integrate/events/small/small_checks.h"
#include "engine/integrate/small_rk4.h"

/* A step from `now` at time t over h to `next`, with the works of it. */
STRUT_SMALL_INLINE void small_rk4_events_step(small_events *e, const strut_model *model,
                                              strut_state *state, double t, double h,
                                              const small_end_point *now, small_end_point *next,
                                              small_work *gained, bool balance) {
  static const double instants[2] = {0.5, 1.0}, part[4] = {0.0, 0.5, 0.5, 1.0};
  static const double weight[4] = {1.0, 2.0, 2.0, 1.0};
  int stride = e->run.terms & STRUT_TERM_DRIVE ? 1 : 0;
  const small_rest *rest = small_rest_at(model, state, e->stepper->small, t, h, instants, 2);
  const double sixth = h / 6.0;
  small_points v[5], a[5], q, next_q;
  v[0] = now->v, a[0] = now->a;
  q.x = small_ahead(now->q.x, 0.5 * h, v[0].x), q.y = small_ahead(now->q.y, 0.5 * h, v[0].y);
  small_shapes shapes = {0};
  small_measure_members(e->run.tables, &q, &shapes);
  if (balance) *gained = small_scaled_work(sixth, &now->power);
#pragma GCC unroll 4
  for (int k = 1; k <= 4; k++) {
    const double step = part[k % 4] * h, further = part[(k + 1) % 4] * h;
    if (k < 4) {
      v[k].x = small_ahead(v[0].x, step, a[k - 1].x);
      v[k].y = small_ahead(v[0].y, step, a[k - 1].y);
    } else {
      v[4].x = small_combine(v[0].x, sixth, a[0].x, small_add(a[1].x, a[2].x), a[3].x);
      v[4].y = small_combine(v[0].y, sixth, a[0].y, small_add(a[1].y, a[2].y), a[3].y);
    }
    if (k < 3) {
      next_q.x = small_ahead(now->q.x, further, v[k].x);
      next_q.y = small_ahead(now->q.y, further, v[k].y);
    } else if (k == 3) {
      next_q.x = small_combine(now->q.x, sixth, v[0].x, small_add(v[1].x, v[2].x), v[3].x);
      next_q.y = small_combine(now->q.y, sixth, v[0].y, small_add(v[1].y, v[2].y), v[3].y);
    }
    a[k] = small_accelerate_in_modes(e, rest + k / 3 * stride, &q, &shapes, k < 4 ? &next_q : NULL,
                                     &v[k], balance);
    if (k < 4) q = next_q;
    if (balance && k < 4) small_add_work(gained, weight[k] * h / 6.0, &e->power);
  }
  *next = (small_end_point){q, v[4], a[4], e->power};
  state->evaluations += 4;
  e->rest = rest + stride;
  e->time = t + h;
}

#endif
