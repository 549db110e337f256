/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/dense.h"

#include <math.h>
#include <string.h>

#include "engine/forces/drive.h"
#include "engine/forces/forces.h"
#include "engine/forces/support_motion.h"
#include "engine/run/measure/time_grid.h"

bool strut_dense_create(const strut_model *model, strut_arena *arena, strut_dense *d) {
  double **const arrays[] = {&d->q, &d->v, &d->begin_q, &d->begin_v, &d->a[0], &d->a[1]};
  *d = (strut_dense){.model = model};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    if (!(*arrays[i] = strut_arena_allocate(arena, (size_t)model->length, sizeof(double))))
      return false;
  return true;
}

void strut_dense_keep(strut_dense *d, const strut_state *state) {
  size_t bytes = (size_t)d->model->length * sizeof(double);
  memcpy(d->begin_q, state->q, bytes);
  memcpy(d->begin_v, state->v, bytes);
  memcpy(d->begin_work, state->work, sizeof d->begin_work);
}

strut_motion_piece strut_dense_step(strut_dense *d, const strut_state *state, double t, double h) {
  return (strut_motion_piece){.begin = t,
                              .length = h,
                              .q = {d->begin_q, state->q},
                              .v = {d->begin_v, state->v},
                              .work = {d->begin_work, state->work},
                              .power = {d->power[0], d->power[1]},
                              .smooth = true,
                              .ends_only = state->kicked};
}

/* Accelerations and powers at both ends of a step of the grid. */
static void accelerate_ends(strut_dense *d, strut_state *state, strut_motion_piece *piece) {
  int64_t evaluations = state->evaluations;
  for (int k = 0; k < 2; k++) {
    double t = piece->begin + k * piece->length;
    state->drive_time = (double)NAN;
    strut_forces_acceleration(d->model, state, t, piece->q[k], piece->v[k], d->a[k]);
    memcpy(d->power[k], state->power, sizeof d->power[k]);
    piece->a[k] = d->a[k];
  }
  state->evaluations = evaluations; /* observing is not part of the run's cost */
}

/* The polynomial of fifth order through values, rates and second derivatives at both ends. */
static double hermite_of_second_order(const strut_motion_piece *p, int32_t i, double s) {
  double h = p->length, r = 1.0 - s, s3 = s * s * s, r3 = r * r * r;
  return p->q[0][i] * r3 * (1.0 + 3.0 * s + 6.0 * s * s) +
         h * (p->v[0][i] * s * r3 * (1.0 + 3.0 * s) - p->v[1][i] * r * s3 * (1.0 + 3.0 * r)) +
         0.5 * h * h * (p->a[0][i] * s * s * r3 + p->a[1][i] * r * r * s3) +
         p->q[1][i] * s3 * (1.0 + 3.0 * r + 6.0 * r * r);
}

static void interpolate(strut_dense *d, const strut_motion_piece *p, double s) {
  double h = p->length;
  for (int32_t i = 0; i < d->model->length; i++) {
    if (d->coarse) {
      double rise = p->v[1][i] - p->v[0][i] - h * p->a[0][i];
      d->q[i] = strut_hermite(p->q[0][i], p->v[0][i], p->q[1][i], p->v[1][i], h, s);
      d->v[i] = p->v[0][i] + s * (h * p->a[0][i] + s * rise);
    } else {
      d->q[i] = hermite_of_second_order(p, i, s);
      d->v[i] = strut_hermite(p->v[0][i], p->a[0][i], p->v[1][i], p->a[1][i], h, s);
    }
  }
}

double strut_dense_place(strut_dense *d, strut_state *state, strut_motion_piece *piece, double s) {
  double t = piece->begin + (s > 0.0 ? s * piece->length : piece->moment);
  if (!d->away) {
    d->end_q = state->q, d->end_v = state->v;
    memcpy(d->end_work, state->work, sizeof d->end_work);
    piece->work[1] = d->end_work;
    d->away = true;
  }
  if (!piece->a[0]) accelerate_ends(d, state, piece);
  state->q = d->q, state->v = d->v;
  interpolate(d, piece, s);
  if (d->model->plan & STRUT_TERM_SUPPORT_MOTION)
    strut_support_motion_place(d->model, state, t, d->q, d->v);
  for (int p = 0; p < STRUT_POWER_COUNT && state->ledger; p++)
    state->work[p] = strut_hermite(piece->work[0][p], piece->power[0][p], piece->work[1][p],
                                   piece->power[1][p], piece->length, s);
  state->drive_time = (double)NAN;
  if (piece->hold) piece->hold(piece, d->model, state, t, d->q, d->v);
  return t;
}

void strut_dense_return(strut_dense *d, strut_state *state, const strut_motion_piece *piece) {
  const strut_model *model = d->model;
  double t = piece->begin + piece->length;
  if (!d->away) return;
  d->away = false;
  state->q = d->end_q, state->v = d->end_v;
  memcpy(state->work, d->end_work, sizeof d->end_work);
  state->drive_time = (double)NAN;
  strut_drive_apply(model, state, t);
  if (model->plan & (STRUT_TERMS_RARE | STRUT_TERM_ELEMENTS | STRUT_TERM_RIGID))
    strut_forces_observe(model, state, t);
}
