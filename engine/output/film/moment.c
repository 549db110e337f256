/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/film/moment.h"

#include <math.h>

static const double FAR = 20; /* sizes from where it began: farther it is no motion to look at */

/* Whether a shape is all there, and in one piece if the run diverged. */
static bool shows(const strut_model *model, const strut_trajectory *motion, const double *q) {
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  for (size_t i = 0; i < 2 * motion->node_count; i++) {
    if (!isfinite(q[i])) return false;
    low[i % 2] = fmin(low[i % 2], q[i]);
    high[i % 2] = fmax(high[i % 2], q[i]);
  }
  double size = fmax(high[0] - low[0], high[1] - low[1]);
  return motion->status != STRUT_DIVERGED || size < FAR * model->size;
}

size_t strut_frames_to_show(const strut_model *model, const strut_trajectory *motion) {
  size_t frames = 0;
  while (frames < motion->frames &&
         shows(model, motion, motion->position + 2 * motion->node_count * frames))
    frames++;
  return frames;
}

bool strut_moment_create(strut_moment *moment, const strut_model *model,
                         const strut_trajectory *motion, strut_arena *arena) {
  *moment = (strut_moment){0};
  moment->q = strut_arena_allocate(arena, (size_t)model->length, sizeof(double));
  if (motion->force) {
    moment->force = strut_arena_allocate(arena, motion->member_count, sizeof(double));
    if (!moment->force) return false;
  }
  if (motion->contact && motion->contact_count > 0) {
    moment->contact = strut_arena_allocate(arena, 2 * motion->contact_count, sizeof(double));
    if (!moment->contact) return false;
  }
  return moment->q;
}

/* to = (1 - part) row i + part row j of (rows, count). */
static void mix(double *to, const double *rows, size_t count, size_t i, size_t j, double part) {
  const double *from = rows + i * count, *next = rows + j * count;
  for (size_t k = 0; k < count; k++)
    to[k] = part > 0 ? from[k] + part * (next[k] - from[k]) : from[k];
}

void strut_moment_at(strut_moment *moment, const strut_trajectory *motion, size_t frames,
                     double time) {
  const double *t = motion->time;
  size_t i = moment->frame;
  while (i + 1 < frames && t[i + 1] <= time) i++;
  size_t j = i + 1 < frames ? i + 1 : i;
  double part = t[j] > t[i] && time > t[i] ? fmin(1, (time - t[i]) / (t[j] - t[i])) : 0;
  moment->frame = i;
  moment->time = time;
  mix(moment->q, motion->position, 2 * motion->node_count, i, j, part);
  if (moment->force) mix(moment->force, motion->force, motion->member_count, i, j, part);
  if (moment->contact) mix(moment->contact, motion->contact, 2 * motion->contact_count, i, j, part);
}

double strut_moment_travel(const strut_moment *moment, const strut_model *model, int32_t node) {
  double sum = 0, weight = 0;
  if (node >= 0) return moment->q[2 * node];
  for (int32_t i = 0; i < model->node_count; i++) {
    sum += model->weight[i] * moment->q[2 * i];
    weight += model->weight[i];
  }
  return weight > 0 ? sum / weight : moment->q[0];
}
