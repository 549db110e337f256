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
  SMALL_EACH(p) z.part[p] = small_rk4_stage(z.part[p], small_all(h), k.part[p]);
  return z;
}

/* A coordinate array, lane by lane; padding follows the nodes. */
#if STRUT_SMALL_WIDTH == 8
STRUT_SMALL_INLINE small_points small_read(const strut_small_model *s, const double *array) {
  static const int64_t even[8] = {0, 2, 4, 6, 8, 10, 12, 14}, odd[8] = {1, 3, 5, 7, 9, 11, 13, 15};
  unsigned lanes = (1u << 2 * s->nodes) - 1;
  __m512d low = _mm512_maskz_loadu_pd((__mmask8)lanes, array);
  __m512d high = _mm512_maskz_loadu_pd((__mmask8)(lanes >> 8), array + 8);
  return (small_points){{{_mm512_permutex2var_pd(low, (__m512i)small_bits_load(even), high)}},
                        {{_mm512_permutex2var_pd(low, (__m512i)small_bits_load(odd), high)}}};
}

STRUT_SMALL_INLINE void small_write(const strut_small_model *s, const small_points *x,
                                    double *array) {
  static const int64_t first[8] = {0, 8, 1, 9, 2, 10, 3, 11},
                       last[8] = {4, 12, 5, 13, 6, 14, 7, 15};
  unsigned lanes = (1u << 2 * s->nodes) - 1;
  __m512d a = x->x.part[0], b = x->y.part[0];
  __m512d low = _mm512_permutex2var_pd(a, (__m512i)small_bits_load(first), b);
  __m512d high = _mm512_permutex2var_pd(a, (__m512i)small_bits_load(last), b);
  _mm512_mask_storeu_pd(array, (__mmask8)lanes, low);
  _mm512_mask_storeu_pd(array + 8, (__mmask8)(lanes >> 8), high);
}
#else
STRUT_SMALL_INLINE small_points small_read(const strut_small_model *s, const double *array) {
  small_points x;
  SMALL_EACH(p) {
    strut_lanes low = {0}, high = {0};
    if (s->nodes > 4 * p) low = small4_load(array + 8 * p);
    if (s->nodes > 4 * p + 2) high = small4_load(array + 8 * p + 4);
    x.x.part[p] = _mm256_permute4x64_pd(_mm256_unpacklo_pd(low, high), 0xd8);
    x.y.part[p] = _mm256_permute4x64_pd(_mm256_unpackhi_pd(low, high), 0xd8);
  }
  return x;
}

STRUT_SMALL_INLINE void small_write(const strut_small_model *s, const small_points *x,
                                    double *array) {
  SMALL_EACH(p) {
    strut_lanes a = _mm256_permute4x64_pd(x->x.part[p], 0xd8);
    strut_lanes b = _mm256_permute4x64_pd(x->y.part[p], 0xd8);
    if (s->nodes > 4 * p) small4_store(array + 8 * p, _mm256_unpacklo_pd(a, b));
    if (s->nodes > 4 * p + 2) small4_store(array + 8 * p + 4, _mm256_unpackhi_pd(a, b));
  }
}
#endif

STRUT_SMALL_INLINE void small_begin(const strut_model *model, const strut_state *state,
                                    unsigned terms, int64_t instants, small_run *r,
                                    strut_small_inputs *inputs, small_rest *rows, small_motion *m) {
  const strut_small_model *s = model->small;
  r->tables = s;
  r->contacts = &model->contacts;
  r->terms = small_terms_in_copy(model, terms);
  r->inputs = inputs;
  strut_small_inputs_read(model, state, inputs);
  r->driven = inputs->driven;
  bool driven = r->terms & STRUT_TERM_DRIVE && model->drives.count;
  strut_small_rest_fill(model, state,
                        !driven                     ? 1
                        : instants < SMALL_INSTANTS ? instants
                                                    : SMALL_INSTANTS,
                        rows);
  m->q = small_read(s, state->q), m->v = small_read(s, state->v);
  m->work = small_work_load(state->work);
  m->power = small_work_load(state->latest.power);
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
                                  const small_rest *rest, const small_motion *m, bool balance) {
  const strut_small_model *s = r->tables;
  small_write(s, &m->q, state->q);
  small_write(s, &m->v, state->v);
  small_write(s, &m->f, state->latest.force);
  if (balance) {
    small_work_store(state->work, m->work);
    small_work_store(state->latest.power, m->power);
  }
  if (!(r->terms & STRUT_TERM_DRIVE)) return;
  state->latest.drive_time = (double)state->step * dt;
  for (int32_t j = 0; j < s->members; j++)
    state->latest.rest[j] = rest->rest[j], state->latest.rest_rate[j] = rest->rate[j];
}

#endif
