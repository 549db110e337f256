/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: driven rest lengths of a small model for many instants at once. Sines go by vectors, with the bits
 * of strut_signal_evaluate; all other signals through it.
 */
#ifndef STRUT_ENGINE_FORCES_SMALL_DRIVES_H
#define STRUT_ENGINE_FORCES_SMALL_DRIVES_H

#include "engine/base/trig.h"
#include "engine/forces/small_ledger.h"

enum { SMALL_STEPS = 16, SMALL_INSTANTS = 2 * SMALL_STEPS + 4 }; /* whole groups of 4 */

STRUT_DEFINE_TRIG(STRUT_SMALL_INLINE, strut_lanes, small_sine, small_cosine)

/* strut_sincos_turns for turns that need no floor; quarters are the last bits of the rounded number. */
STRUT_SMALL_INLINE void small_sincos(strut_lanes turns, strut_lanes *sine, strut_lanes *cosine) {
  const double rounder = 6755399441055744.0;
  strut_lanes rounded = 4.0 * turns + rounder, quarter = rounded - rounder;
  strut_lanes x = STRUT_TAU * (turns - 0.25 * quarter);
  strut_lanes s = small_sine(x), c = small_cosine(x);
  strut_lane_mask quadrant = (strut_lane_mask)rounded, odd = -(quadrant & 1);
  strut_lanes first = small4_choose(odd, c, s), second = small4_choose(odd, s, c);
  *sine = small4_choose(-((quadrant >> 1) & 1), -first, first);
  *cosine = small4_choose(-(((quadrant + 1) >> 1) & 1), -second, second);
}

/* Is the signal a sine, and on, at all of these times? */
STRUT_SMALL_INLINE bool small_is_wave(const strut_signal *s, const double *time, int32_t count) {
  double first = s->frequency * (time[0] - s->start) + s->phase;
  double last = s->frequency * (time[count - 1] - s->start) + s->phase;
  return s->kind == STRUT_SINE && time[0] >= s->start && time[count - 1] < s->stop &&
         fabs(first) < 0x1p48 && fabs(last) < 0x1p48;
}

/* Values and rates of a signal at `count` times, which ascend. */
STRUT_SMALL_INLINE void small_signal(const strut_signal *signals, int32_t index, const double *time,
                                     int32_t count, double *value, double *rate) {
  const strut_signal *s = &signals[index];
  if (!small_is_wave(s, time, count)) {
    for (int32_t h = 0; h < count; h++)
      strut_signal_evaluate(signals, index, time[h], &value[h], &rate[h]);
    return;
  }
  double fast = s->amplitude * STRUT_TAU * s->frequency;
  for (int32_t h = 0; h < count; h += STRUT_LANES) {
    strut_lanes sine, cosine;
    strut_lanes turns = s->frequency * (small4_load(time + h) - s->start) + s->phase;
    small_sincos(turns, &sine, &cosine);
    small4_store(value + h, s->amplitude * sine);
    small4_store(rate + h, fast * cosine);
  }
}

/*
 * row[j] = x, by a store as wide as the loads that the law of members makes: one that has to gather a row from several
 * stores waits until these have left the processor's queue, and with them all that came before.
 */
STRUT_SMALL_INLINE void small_put(double *row, int32_t j, double x) {
  static const int64_t one[2 * STRUT_SMALL_SLOTS] = {[STRUT_SMALL_SLOTS] = -1};
  int32_t from = j / SMALL_WIDTH * SMALL_WIDTH;
  const int64_t *at = one + STRUT_SMALL_SLOTS - (j - from);
  if (from < 8) {
    small_store(row + from,
                small_choose(small_mask_load(at), small_all(x), small_load(row + from)));
    return;
  }
  strut_lane_mask there = (strut_lane_mask)_mm256_loadu_si256((const __m256i *)at);
  small4_store(row + from, small4_choose(there, _mm256_set1_pd(x), small4_load(row + from)));
}

/* The drives' share of rest lengths at `count` times; rows have the other members' already. */
STRUT_SMALL_INLINE void small_drive(const strut_model *model, const double *time, int32_t count,
                                    small_rest *rows) {
  const strut_drive_table *d = &model->drives;
  double value[SMALL_INSTANTS], rate[SMALL_INSTANTS];
  for (int32_t i = 0; i < d->count; i++) {
    int32_t j = d->member[i];
    double natural = model->members.rest[j];
    small_signal(model->scene->signals, d->signal[i], time, count, value, rate);
    for (int32_t h = 0; h < count && d->first[i]; h++)
      small_put(rows[h].rest, j, natural + value[h]), small_put(rows[h].rate, j, rate[h]);
    for (int32_t h = 0; h < count && !d->first[i]; h++) {
      small_put(rows[h].rest, j, rows[h].rest[j] + value[h]);
      small_put(rows[h].rate, j, rows[h].rate[j] + rate[h]);
    }
  }
}

#endif
