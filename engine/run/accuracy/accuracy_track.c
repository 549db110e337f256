/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/accuracy/accuracy_track.h"

#include <math.h>
#include <string.h>

#include "engine/model/pose.h"

/* Moments of two runs closer than this, relative to their spacing, are the same. */
static const double SAME_MOMENT = 1e-3;
/* Smallest motion that distances are relative to, over the size of the structure. */
static const double LEAST_MOTION = 1e-4;

static strut_status begin_track(void *context, const strut_record_layout *layout,
                                strut_error *error) {
  (void)layout, (void)error;
  ((strut_track *)context)->count = 0;
  return STRUT_OK;
}

static strut_status record_track_rows(void *context, const double *rows, size_t count,
                                      strut_error *error) {
  strut_track *t = context;
  size_t both = 2 * (size_t)t->model->node_count;
  (void)error;
  for (size_t k = 0; k < count && t->count < t->capacity; k++, t->count++) {
    const double *row = rows + k * (both + 1);
    t->time[t->count] = row[0];
    memcpy(t->position + t->count * both, row + 1, both * sizeof(double));
  }
  return STRUT_OK;
}

static strut_status end_track(void *context, strut_status status, strut_error *error) {
  (void)context, (void)status, (void)error;
  return STRUT_OK;
}

strut_status strut_track_create(const strut_model *model, size_t capacity, strut_arena *arena,
                                strut_track *t) {
  size_t both = 2 * (size_t)model->node_count;
  *t = (strut_track){.model = model, .capacity = capacity};
  t->sink = (strut_sink){t, begin_track, record_track_rows, end_track, STRUT_CHANNEL_POSITION};
  t->time = strut_arena_allocate(arena, capacity, sizeof(double));
  t->position = strut_arena_allocate(arena, capacity * both, sizeof(double));
  return t->time && t->position ? STRUT_OK : STRUT_NO_MEMORY;
}

/* Mean position along the ground at moment k; 0 where a support holds it or there is no ground. */
static double mean_along_ground(const strut_track *t, size_t k) {
  const strut_model *model = t->model;
  const double *q = t->position + 2 * k * (size_t)model->node_count;
  double sum = 0.0;
  if (!strut_contacts_allow_travel(&model->contacts)) return 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    if (model->fixed[2 * i] || model->fixed[2 * i + 1]) return 0.0;
    sum += q[2 * i] * model->contacts.tangent[0] + q[2 * i + 1] * model->contacts.tangent[1];
  }
  return sum / model->node_count;
}

double strut_track_distance(const strut_track *a, const strut_track *b, double period) {
  const strut_model *model = a->model;
  size_t both = 2 * (size_t)model->node_count, count = a->count;
  double away = 0.0, motion = LEAST_MOTION * model->size;
  if (count != b->count || count < 2) return HUGE_VAL;
  double apart = (a->time[count - 1] - a->time[0]) / (double)(count - 1);
  double first = mean_along_ground(a, 0);
  for (size_t k = 0; k < count; k++) {
    double here = mean_along_ground(a, k), there = mean_along_ground(b, k);
    double later = a->time[k] - b->time[k];
    if (period > 0.0) later = remainder(later, period);
    if (fabs(later) > SAME_MOMENT * apart) return HUGE_VAL;
    for (size_t i = 0; i < both; i++) {
      double t =
          strut_contacts_allow_travel(&model->contacts) ? model->contacts.tangent[i % 2] : 0.0;
      double x = a->position[k * both + i] - here * t, y = b->position[k * both + i] - there * t;
      double x0 = a->position[i] - first * t;
      away = fmax(away, fabs(x - y));
      motion = fmax(motion, fabs(x - x0));
    }
  }
  return away / motion;
}
