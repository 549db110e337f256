/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: a step of velocity Verlet in all lanes of a batch; see verlet_events.c, whose operations these
 * are. The ground, which differs most from lane to lane, is batch_events.c's.
 */
#ifndef STRUT_ENGINE_INTEGRATE_LANES_BATCH_VERLET_H
#define STRUT_ENGINE_INTEGRATE_LANES_BATCH_VERLET_H

#include "engine/forces/lane_kernel.h"
#include "engine/integrate/events/event_stepping.h"
#include "engine/integrate/lanes/batch.h"

STRUT_LANE_INLINE void verlet_predict_row(strut_batch *b, size_t i, int p, lane_real h) {
  const strut_batch_end *now = b->events->now, *next = b->events->next;
  lane_real rate = lane_row(now->v, i, p), bend = lane_row(now->a, i, p), half = 0.5 * h;
  lane_put(next->q, i, p, lane_row(now->q, i, p) + h * (rate + half * bend));
  lane_put(b->events->predicted, i, p, rate + h * bend);
}

/* In which lanes does a contact open or close within the step? */
STRUT_LANE_INLINE void verlet_cross(const strut_batch *b, const strut_lane_tables *t, int p) {
  const strut_contact_table *c = &t->first->contacts;
  lane_real zero = {0}, height = lane_row(t->ground, STRUT_LANE_HEIGHT, p);
  lane_mask crossed = {0};
  for (int32_t i = 0; i < c->count; i++) {
    lane_real up = lane_row(b->events->next->q, c->at[i] + 1, p) - height;
    crossed |= lane_row(b->events->outward, (size_t)i, p) * up < zero;
  }
  lane_put(b->events->crossed, 0, p, lane_choose(crossed, zero + 1.0, zero));
}

STRUT_LANE_INLINE void verlet_predict(strut_batch *b, bool ledger) {
  strut_batch_events *e = b->events;
  strut_lane_tables tables = b->tables;
  size_t n = 2 * (size_t)tables.first->node_count;
  lane_real h[LANE_PARTS], time[LANE_PARTS];
  LANE_EACH((h[p] = lane_row(e->h, 0, p), time[p] = lane_row(e->time, 0, p) + h[p]));
  tables.force = e->next->structure;
  tables.power = e->next->structure_power;
  for (size_t i = 0; i < n; i++) LANE_EACH(verlet_predict_row(b, i, p, h[p]));
  LANE_EACH(verlet_cross(b, &tables, p));
  LANE_EACH(lane_drive_part(&tables, p, time[p]));
  lane_structure(&tables, e->next->q, e->predicted, ledger, NULL);
  lane_mass(&tables, e->next->a);
  for (size_t k = 0; k < STRUT_LANE_POWERS && ledger; k++)
    LANE_EACH(lane_put(e->next->power, k, p, lane_row(tables.power, k, p)));
}

STRUT_LANE_INLINE void verlet_correct_row(const strut_batch_events *e, size_t i, int p,
                                          lane_real half) {
  lane_real sum = lane_row(e->now->a, i, p) + lane_row(e->next->a, i, p);
  lane_put(e->next->v, i, p, lane_row(e->now->v, i, p) + half * sum);
}

STRUT_LANE_INLINE void verlet_measure_law(const strut_batch_events *e, const strut_lane_tables *t,
                                          int32_t k, int p) {
  const strut_law_switch *law = &e->laws[k];
  const double *q = e->next->q, *v = e->next->v;
  lane_switch s = law->member >= 0 ? lane_measure_cable(t, (size_t)law->member, p, q, v)
                                   : lane_measure_element(t, law->element,
                                                          law->event == STRUT_EVENT_KINK, p, q, v);
  lane_put(e->stretch, (size_t)k, p, s.stretch);
  lane_put(e->stretch_rate, (size_t)k, p, s.rate);
  lane_put(e->tension, (size_t)k, p, s.tension);
}

STRUT_LANE_INLINE void verlet_correct(strut_batch *b) {
  const strut_batch_events *e = b->events;
  size_t n = 2 * (size_t)b->tables.first->node_count;
  lane_real half[LANE_PARTS];
  LANE_EACH((half[p] = 0.5 * lane_row(e->h, 0, p)));
  for (size_t i = 0; i < n; i++) LANE_EACH(verlet_correct_row(e, i, p, half[p]));
}

STRUT_LANE_TARGET
static void verlet_predict_plain(strut_batch *b) { verlet_predict(b, false); }

STRUT_LANE_TARGET
static void verlet_predict_with_ledger(strut_batch *b) { verlet_predict(b, true); }

static void verlet_predict_any(strut_batch *b) {
  if (b->ledger)
    verlet_predict_with_ledger(b);
  else
    verlet_predict_plain(b);
}

STRUT_LANE_TARGET
static void verlet_correct_any(strut_batch *b) { verlet_correct(b); }

STRUT_LANE_TARGET
static void verlet_measure_any(strut_batch *b) {
  const strut_batch_events *e = b->events;
  for (int32_t k = 0; k < e->law_count; k++) LANE_EACH(verlet_measure_law(e, &b->tables, k, p));
}

#endif
