/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: from the state to registers at the begin of a run of steps, and back at its end.
 */
#ifndef STRUT_ENGINE_INTEGRATE_SMALL_RUN_H
#define STRUT_ENGINE_INTEGRATE_SMALL_RUN_H

#include "engine/forces/small_drives.h"
#include "engine/integrate/small_steps.h"

/* The state proper, and what the latest evaluation left. */
typedef struct small_motion {
  small_points q, v, f;
  small_work power, work;
} small_motion;

/* z + h k */
STRUT_SMALL_INLINE small_row small_ahead(small_row z, double h, small_row k) {
  SMALL_EACH(p) z.part[p] = z.part[p] + h * k.part[p];
  return z;
}

/* A coordinate array, lane by lane. */
STRUT_SMALL_INLINE small_points small_read(const strut_small_model *s, const double *array) {
  strut_small_row row[2] = {{0}};
  for (int32_t i = 0; i < s->nodes && array; i++)
    row[0][i] = array[2 * i], row[1][i] = array[2 * i + 1];
  return (small_points){small_row_load(row[0]), small_row_load(row[1])};
}

STRUT_SMALL_INLINE void small_write(const strut_small_model *s, const small_points *x,
                                    double *array) {
  strut_small_row row[2];
  small_row_store(row[0], x->x);
  small_row_store(row[1], x->y);
  for (int32_t i = 0; i < s->nodes; i++) array[2 * i] = row[0][i], array[2 * i + 1] = row[1][i];
}

/* Rest lengths before the drives change them, in the rows of `count` instants. */
STRUT_SMALL_INLINE void small_fill_rest(const strut_model *model, const strut_state *state,
                                        unsigned plan, int64_t count, small_rest *rows) {
  bool driven = plan & STRUT_TERM_DRIVE;
  const double *rest = driven ? state->rest : model->members.rest;
  if (count > SMALL_INSTANTS) count = SMALL_INSTANTS;
  if (!driven || !model->drives.count) count = 1;
  for (int64_t h = 0; h < count; h++)
    for (int32_t j = 0; j < STRUT_SMALL_SLOTS; j++) {
      bool there = j < model->members.count;
      rows[h].rest[j] = there ? rest[j] : 0.0;
      rows[h].rate[j] = there ? state->rest_rate[j] : 0.0;
    }
}

STRUT_SMALL_INLINE void small_begin(const strut_model *model, const strut_state *state,
                                    unsigned terms, int64_t instants, small_run *r,
                                    small_rest *rows, small_motion *m) {
  const strut_small_model *s = model->small;
  r->tables = s;
  r->contacts = &model->contacts;
  r->plan = model->plan & terms;
  small_points constant =
      small_read(s, r->plan & STRUT_TERM_CONSTANT ? model->constant_force : NULL);
  small_row_store(r->constant[0], constant.x);
  small_row_store(r->constant[1], constant.y);
  for (int32_t j = 0; j < STRUT_SMALL_SLOTS; j++) {
    bool there = j < s->members;
    r->slack_length_threshold[j] = there ? state->slack_length_threshold[j] : 0.0;
    r->slack_force_threshold[j] = there ? state->slack_force_threshold[j] : 0.0;
  }
  small_fill_rest(model, state, r->plan, instants, rows);
  m->q = small_read(s, state->q), m->v = small_read(s, state->v);
  m->work = small_work_load(state->work);
  m->power = small_work_load(state->power);
}

/* Rest lengths at `count` instants from the present step on, `part` steps apart. */
STRUT_SMALL_INLINE void small_drive_instants(const strut_model *model, const strut_state *state,
                                             double dt, double part, int32_t count,
                                             small_rest *rows) {
  double time[SMALL_INSTANTS];
  for (int32_t h = 0; h < SMALL_INSTANTS; h++)
    time[h] = ((double)state->step + part * (double)h) * dt + state->time_offset;
  small_drive(model, time, count, rows);
}

/* The state as the general kernel leaves it at its present step; rest: at its end. */
STRUT_SMALL_INLINE void small_end(const small_run *r, strut_state *state, double dt,
                                  const small_rest *rest, const small_motion *m, bool ledger) {
  const strut_small_model *s = r->tables;
  small_write(s, &m->q, state->q);
  small_write(s, &m->v, state->v);
  small_write(s, &m->f, state->force);
  if (ledger) {
    small_work_store(state->work, m->work);
    small_work_store(state->power, m->power);
  }
  if (!(r->plan & STRUT_TERM_DRIVE)) return;
  state->drive_time = (double)state->step * dt;
  for (int32_t j = 0; j < s->members; j++)
    state->rest[j] = rest->rest[j], state->rest_rate[j] = rest->rate[j];
}

#endif
