/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: velocity Verlet of small models; see symplectic.c, whose operations these are.
 */
#ifndef STRUT_ENGINE_INTEGRATE_SMALL_VERLET_H
#define STRUT_ENGINE_INTEGRATE_SMALL_VERLET_H

#include "engine/integrate/small_run.h"

/* z + half (a + b) */
STRUT_SMALL_INLINE small_row small_mean(small_row z, double half, small_row a, small_row b) {
  SMALL_EACH(p) z.part[p] = z.part[p] + half * (a.part[p] + b.part[p]);
  return z;
}

/* z + h (v + half a) */
STRUT_SMALL_INLINE small_row small_glide(small_row z, double h, small_row v, small_row a) {
  double half = 0.5 * h;
  SMALL_EACH(p) z.part[p] = z.part[p] + h * (v.part[p] + half * a.part[p]);
  return z;
}

/* One step over the rest lengths at its end; a: the acceleration at its begin, and then at its end. */
STRUT_SMALL_INLINE void small_verlet_step(const small_run *r, const small_rest *rest, double dt,
                                          small_motion *m, small_points *a, bool balance) {
  const double half = 0.5 * dt;
  small_work before = m->power;
  m->q.x = small_glide(m->q.x, dt, m->v.x, a->x), m->q.y = small_glide(m->q.y, dt, m->v.y, a->y);
  small_points predicted = {small_ahead(m->v.x, dt, a->x), small_ahead(m->v.y, dt, a->y)};
  small_entries entries = {0};
  small_pulls px, py;
  small_shapes shapes = {0};
  small_measure_members(r->tables, &m->q, &shapes);
  small_members(r, rest, &shapes, NULL, &predicted, balance, &px, &py, &entries.members);
  if (balance) m->power = small_sum_members(&entries.members);
  m->f = small_sum_pulls(r, &px, &py);
  small_ground(r, &m->q, &predicted, &m->f, balance, &entries.touch);
  if (balance) small_add_contacts(r, &entries.touch, &m->power);
  small_points next = small_divide_points(r->tables, &m->f);
  m->v.x = small_mean(m->v.x, half, a->x, next.x), m->v.y = small_mean(m->v.y, half, a->y, next.y);
  *a = next;
  if (!balance) return;
  small_add_powers(&before, &m->power);
  small_add_work(&m->work, half, &before);
}

STRUT_SMALL_INLINE void small_verlet(const strut_model *model, strut_state *state,
                                     const strut_small_kept *kept, double dt, int64_t count,
                                     unsigned terms, bool balance) {
  enum { MOST = SMALL_INSTANTS - 4 };
  small_run run;
  strut_small_inputs inputs;
  small_rest rows[SMALL_INSTANTS];
  small_motion m;
  small_begin(model, state, terms, count + 1, &run, &inputs, rows, &m);
  small_points a = small_read(run.tables, kept->acceleration);
  m.power = small_work_load(kept->power);
  int stride = run.terms & STRUT_TERM_DRIVE && model->drives.count ? 1 : 0;
  for (int64_t left = count; left > 0;) {
    int32_t steps = left < MOST ? (int32_t)left : MOST;
    if (stride) small_drive_instants(model, state, dt, 1.0, steps + 1, rows);
    for (int32_t n = 1; n <= steps; n++)
      small_verlet_step(&run, rows + n * stride, dt, &m, &a, balance);
    state->step += steps;
    state->evaluations += steps;
    left -= steps;
    if (left == 0) small_end(&run, state, dt, rows + steps * stride, &m, balance);
  }
  small_write(run.tables, &a, kept->acceleration);
  if (balance) small_work_store(kept->power, m.power);
}

#endif
