/* SPDX-License-Identifier: GPL-3.0-or-later */
/* When signals turn or jump, and by how much. See signal.h. */
#include <math.h>

#include "engine/scene/signal.h"

/* Of each wave that many turns and as many zeros are looked at: the next ones are like them. */
enum { WAVES = 8, MOST_TIMES = 256 };

typedef struct times {
  double from, to, *time;
  size_t count, room;
} times;

static void add(times *t, double time) {
  if (time >= t->from && time <= t->to && t->count < t->room) t->time[t->count++] = time;
}

/* Zeros and turns, a quarter of a period apart. */
static void add_wave(const strut_signal *s, times *t) {
  double begin = fmax(t->from, s->start);
  double quarter = floor(4.0 * (s->frequency * (begin - s->start) + s->phase));
  for (int k = 0; k < 2 * WAVES; k++)
    add(t, s->start + (0.25 * (quarter + k) - s->phase) / s->frequency);
}

static void add_signal(const strut_signal *signals, int32_t index, times *t) {
  const strut_signal *s = &signals[index];
  add(t, s->start);
  add(t, s->stop);
  if (s->kind == STRUT_SINE || s->kind == STRUT_SQUARE || s->kind == STRUT_HALF_SINE)
    add_wave(s, t);
  for (size_t i = 0; s->kind == STRUT_TABLE && i < s->point_count; i++) add(t, s->time[i]);
  for (size_t i = 0; s->kind == STRUT_SUM && i < s->term_count; i++)
    add_signal(signals, s->terms[i], t);
}

size_t strut_signal_times(const strut_signal *signals, int32_t index, double from, double to,
                          double *time, size_t room) {
  times t = {.from = from, .to = to, .time = time, .room = room};
  add_signal(signals, index, &t);
  return t.count;
}

double strut_signal_jump(const strut_signal *signals, int32_t index, double step, double from,
                         double to, double *when) {
  double time[MOST_TIMES], largest = 0.0;
  size_t count = strut_signal_times(signals, index, from, to, time, MOST_TIMES);
  for (size_t i = 0; i < count; i++) {
    double before, after, rate;
    strut_signal_evaluate(signals, index, time[i] - 1e-6 * step, &before, &rate);
    strut_signal_evaluate(signals, index, time[i] + step, &after, &rate);
    if (!(fabs(after - before) > largest * (1.0 + 1e-9))) continue;
    largest = fabs(after - before);
    *when = time[i];
  }
  return largest;
}
