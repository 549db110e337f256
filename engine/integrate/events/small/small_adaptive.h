/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: pairs with error control for small models; see adaptive.c, whose operations these are.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_ADAPTIVE_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_ADAPTIVE_H

#include "engine/integrate/events/small/small_checks.h"

STRUT_SMALL_INLINE small_row small_scaled(double weight, small_row x) {
  SMALL_EACH(p) x.part[p] = weight * x.part[p];
  return x;
}

/* Sums of velocities and of accelerations over stages. */
typedef struct small_sums {
  small_points v, a;
} small_sums;

STRUT_SMALL_INLINE void small_add_weighted(small_points *sum, double weight,
                                           const small_points *k) {
  SMALL_EACH(p) {
    sum->x.part[p] += weight * k->x.part[p];
    sum->y.part[p] += weight * k->y.part[p];
  }
}

/* sum_j for_v[j] v[j] and sum_j for_a[j] a[j] over `count` stages. The second one has mostly weight 0, and is
   left out then. Loops, since a copy of all that follows for each stage would not stay in the processor's cache
   of instructions. */
STRUT_SMALL_INLINE small_sums small_weighted(const small_points *v, const double *for_v,
                                             const small_points *a, const double *for_a,
                                             int count) {
  small_sums sum = {{small_scaled(for_v[0], v[0].x), small_scaled(for_v[0], v[0].y)},
                    {small_scaled(for_a[0], a[0].x), small_scaled(for_a[0], a[0].y)}};
  if (count > 1 && for_v[1] != 0.0) small_add_weighted(&sum.v, for_v[1], &v[1]);
  if (count > 1 && for_a[1] != 0.0) small_add_weighted(&sum.a, for_a[1], &a[1]);
  for (int j = 2; j < count; j++) {
    small_add_weighted(&sum.v, for_v[j], &v[j]);
    small_add_weighted(&sum.a, for_a[j], &a[j]);
  }
  return sum;
}

/* The largest magnitude so far, lane by lane; `poison` is no number once one was none. */
typedef struct small_largest {
  small_real most, poison;
} small_largest;

STRUT_SMALL_INLINE void small_enlarge(small_largest *so_far, small_real x) {
  small_real size = small_magnitude(x);
  so_far->most = small_choose(small_less(so_far->most, size), size, so_far->most);
  so_far->poison += x - x;
}

STRUT_SMALL_INLINE double small_largest_of(const small_largest *x) {
  small_real zero = {0};
  if (small_set_bits(small_at_least(x->poison, zero)) != (1u << SMALL_WIDTH) - 1) return HUGE_VAL;
#if STRUT_SMALL_WIDTH == 8
  return _mm512_reduce_max_pd(x->most);
#else
  __m128d most = _mm_max_pd(_mm256_castpd256_pd128(x->most), _mm256_extractf128_pd(x->most, 1));
  return _mm_cvtsd_f64(_mm_max_sd(most, _mm_unpackhi_pd(most, most)));
#endif
}

/* Local error over what is allowed, by the difference of the pair. */
STRUT_SMALL_INLINE double small_error(const strut_model *model, strut_event_stepper *l, double h,
                                      const small_points *v, const small_points *a) {
  const strut_tableau *tableau = l->stepper->tableau;
  const small_points *speed = &v[tableau->stages];
  small_largest position = {0}, velocity = {0}, fastest = {0};
  small_sums off_by =
      small_weighted(v, tableau->difference, a, tableau->difference, tableau->stages + 1);
  SMALL_EACH(p) {
    small_enlarge(&position, h * off_by.v.x.part[p]);
    small_enlarge(&position, h * off_by.v.y.part[p]);
    small_enlarge(&velocity, h * off_by.a.x.part[p]);
    small_enlarge(&velocity, h * off_by.a.y.part[p]);
    small_enlarge(&fastest, v[0].x.part[p]), small_enlarge(&fastest, v[0].y.part[p]);
    small_enlarge(&fastest, speed->x.part[p]), small_enlarge(&fastest, speed->y.part[p]);
  }
  double fast = small_largest_of(&fastest), off = small_largest_of(&velocity);
  if (fast > l->fastest) l->fastest = fast;
  return relative_error(model, l, h, small_largest_of(&position), off);
}

/* A step from `now` at time t over h to `next`, with the works of it; leaves rest lengths and forces in the
   state. */
STRUT_SMALL_INLINE void small_adaptive_step(small_events *e, const strut_model *model,
                                            strut_state *state, double t, double h,
                                            const small_end_point *now, small_end_point *next,
                                            small_work *gained, bool balance) {
  strut_event_stepper *l = e->stepper;
  const strut_tableau *tableau = l->stepper->tableau;
  const int stride = e->run.terms & STRUT_TERM_DRIVE ? 1 : 0, end = tableau->stages;
  const double *ahead = tableau->ahead, *last = tableau->weight[end];
  const small_rest *rest = small_rest_at(model, state, l->small, t, h, ahead + 1, end - 1);
  small_points v[STRUT_MOST_STAGES + 1], a[STRUT_MOST_STAGES + 1], q, next_q;
  v[0] = now->v, a[0] = now->a;
  q.x = small_ahead(now->q.x, h, small_scaled(tableau->weight[1][0], v[0].x));
  q.y = small_ahead(now->q.y, h, small_scaled(tableau->weight[1][0], v[0].y));
  small_shapes shapes = {0};
  small_measure_members(e->run.tables, &q, &shapes);
  if (balance) *gained = small_scaled_work(last[0] * h, &now->power);
  for (int k = 1; k <= end; k++) {
    const double *further = tableau->weight[k < end ? k + 1 : 0]; /* positions are a stage ahead */
    small_sums sum = small_weighted(v, further, a, tableau->weight[k], k);
    v[k].x = small_ahead(v[0].x, h, sum.a.x), v[k].y = small_ahead(v[0].y, h, sum.a.y);
    if (k < end) small_add_weighted(&sum.v, further[k], &v[k]);
    next_q.x = small_ahead(now->q.x, h, sum.v.x), next_q.y = small_ahead(now->q.y, h, sum.v.y);
    a[k] = small_accelerate_in_modes(e, rest + (k < end ? k - 1 : end - 2) * stride, &q, &shapes,
                                     k < end ? &next_q : NULL, &v[k], balance);
    if (k == end) break;
    q = next_q;
    if (small_keeps_margins(e)) small_note_stage(e, ahead[k], k == 1);
    if (balance) small_add_work(gained, last[k] * h, &e->power);
  }
  state->evaluations += end;
  *next = (small_end_point){q, v[end], a[end], e->power};
  e->rest = rest + (end - 2) * stride;
  e->time = t + h;
  l->error = small_error(model, l, h, v, a);
}

#endif
