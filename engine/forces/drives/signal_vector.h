/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: a signal at many times at once. Sines go by vectors, with the bits of strut_signal_evaluate; all other
 * signals through it.
 */
#pragma once

#include "engine/base/vec.h"
#include "engine/model/algebra/hot.h"
#include "engine/model/model.h"

STRUT_DEFINE_TRIG(STRUT_INLINE, strut_lanes, signal_vector_sine, signal_vector_cosine)

/* strut_sincos_turns for turns that need no floor; quarters are the last bits of the rounded number. */
STRUT_INLINE void signal_vector_sincos(strut_lanes turns, strut_lanes *sine, strut_lanes *cosine) {
  const double rounder = 6755399441055744.0;
  strut_lanes rounded = 4.0 * turns + rounder, quarter = rounded - rounder;
  strut_lanes x = STRUT_TAU * (turns - 0.25 * quarter);
  strut_lanes s = signal_vector_sine(x), c = signal_vector_cosine(x);
  strut_lane_mask quadrant = (strut_lane_mask)rounded, odd = -(quadrant & 1);
  strut_lanes first = four_choose(odd, c, s), second = four_choose(odd, s, c);
  *sine = four_choose(-((quadrant >> 1) & 1), -first, first);
  *cosine = four_choose(-(((quadrant + 1) >> 1) & 1), -second, second);
}

/* Is the signal a sine, and on, at all of these times? */
STRUT_INLINE bool signal_is_wave(const strut_signal *signal, const double *time, int32_t count) {
  double first = signal->frequency * (time[0] - signal->start) + signal->phase;
  double last = signal->frequency * (time[count - 1] - signal->start) + signal->phase;
  return signal->kind == STRUT_SINE && time[0] >= signal->start && time[count - 1] < signal->stop &&
         fabs(first) < 0x1p48 && fabs(last) < 0x1p48;
}

/* A wave at `count` times, in whole vectors. */
STRUT_INLINE void signal_wave(const strut_signal *signal, const double *time, int32_t count,
                              double *value, double *rate) {
  double fast = signal->amplitude * STRUT_TAU * signal->frequency;
  for (int32_t h = 0; h < count; h += STRUT_LANES) {
    strut_lanes sine, cosine;
    strut_lanes turns =
        signal->frequency * (strut_lanes_load(time + h) - signal->start) + signal->phase;
    signal_vector_sincos(turns, &sine, &cosine);
    strut_lanes_store(value + h, signal->amplitude * sine);
    strut_lanes_store(rate + h, fast * cosine);
  }
}

/* All signals but a sine, whose caller so keeps its registers. */
static __attribute__((noinline, unused)) void signal_at_times_otherwise(
    const strut_signal *signals, int32_t index, const double *time, int32_t count, double *value,
    double *rate) {
  for (int32_t h = 0; h < count; h++)
    strut_signal_evaluate(signals, index, time[h], &value[h], &rate[h]);
}

/* Values and rates of a signal at `count` times, none before the first or after the last; arrays have room for
   whole vectors. */
STRUT_INLINE void signal_at_times(const strut_signal *signals, int32_t index, const double *time,
                                  int32_t count, double *value, double *rate) {
  if (signal_is_wave(&signals[index], time, count))
    signal_wave(&signals[index], time, count, value, rate);
  else
    signal_at_times_otherwise(signals, index, time, count, value, rate);
}
