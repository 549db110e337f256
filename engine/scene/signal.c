/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values, rates and periods of the waveforms. See signal.h. */
#include "engine/scene/signal.h"

#include <math.h>
#include <stdbool.h>

#include "engine/base/trig.h"

static const double TWO_PI = 6.283185307179586476925;

strut_signal strut_signal_default(strut_signal_kind kind) {
  return (strut_signal){.kind = kind, .stop = (double)INFINITY};
}

static inline void wave(const strut_signal *s, double turns, double *value, double *rate) {
  double sine, cosine;
  strut_sincos_turns(turns, &sine, &cosine);
  *value = s->amplitude * sine;
  *rate = s->amplitude * TWO_PI * s->frequency * cosine;
}

static void ramp(const strut_signal *s, double t, double *value, double *rate) {
  *value = *rate = 0.0;
  if (t >= s->stop) {
    *value = s->amplitude;
  } else if (t >= s->start) {
    *value = s->amplitude * ((t - s->start) / (s->stop - s->start));
    *rate = s->amplitude / (s->stop - s->start);
  }
}

static void table(const strut_signal *s, double t, double *value, double *rate) {
  size_t low = 0, high = s->point_count; /* points before `low` are at or before t */
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (s->time[middle] <= t)
      low = middle + 1;
    else
      high = middle;
  }
  *rate = 0.0;
  *value = s->value[low ? low - 1 : 0];
  if (low == 0 || low == s->point_count) return;
  double span = s->time[low] - s->time[low - 1], rise = s->value[low] - s->value[low - 1];
  *value += rise * ((t - s->time[low - 1]) / span);
  *rate = rise / span;
}

/* All but sines, which strut_signal_evaluate looks at first. */
static void evaluate(const strut_signal *signals, int32_t index, double t, double turns,
                     double *value, double *rate) {
  const strut_signal *s = &signals[index];
  *value = *rate = 0.0;
  if (s->kind == STRUT_RAMP) {
    ramp(s, t, value, rate);
    return;
  }
  if (s->kind == STRUT_TABLE) {
    table(s, t, value, rate);
    return;
  }
  if (t < s->start || t >= s->stop) return;
  switch (s->kind) {
    case STRUT_CONSTANT:
      *value = s->amplitude;
      break;
    case STRUT_HALF_SINE:
      if (turns < 0.5) wave(s, turns, value, rate);
      break;
    case STRUT_SQUARE:
      *value = turns - floor(turns) < 0.5 ? s->amplitude : -s->amplitude;
      break;
    default:
      for (size_t i = 0; i < s->term_count; i++) {
        double part, part_rate;
        strut_signal_evaluate(signals, s->terms[i], t, &part, &part_rate);
        *value += part;
        *rate += part_rate;
      }
  }
}

void strut_signal_evaluate(const strut_signal *signals, int32_t index, double t, double *value,
                           double *rate) {
  const strut_signal *s = &signals[index];
  double turns = s->frequency * (t - s->start) + s->phase;
  if (s->kind == STRUT_SINE && t >= s->start && t < s->stop)
    wave(s, turns, value, rate);
  else
    evaluate(signals, index, t, turns, value, rate);
}

/* Longest period among a signal's repeating parts, or among its pulses; 0 where there is none. */
static double longest_period(const strut_signal *signals, int32_t index, bool pulses) {
  const strut_signal *s = &signals[index];
  bool repeats = s->kind == STRUT_SINE || s->kind == STRUT_SQUARE;
  if (pulses ? s->kind == STRUT_HALF_SINE : repeats) return 1.0 / s->frequency;
  double longest = 0.0;
  for (size_t i = 0; s->kind == STRUT_SUM && i < s->term_count; i++)
    longest = fmax(longest, longest_period(signals, s->terms[i], pulses));
  return longest;
}

/* True where every repeating part of the signal fits a whole number of times into `period`. */
static bool repeats_within(const strut_signal *signals, int32_t index, double period) {
  const strut_signal *s = &signals[index];
  if (s->kind == STRUT_SINE || s->kind == STRUT_SQUARE) {
    double times = period * s->frequency;
    return fabs(times - floor(times + 0.5)) <= 1e-9 * times;
  }
  for (size_t i = 0; s->kind == STRUT_SUM && i < s->term_count; i++)
    if (!repeats_within(signals, s->terms[i], period)) return false;
  return true;
}

double strut_signal_period(const strut_signal *signals, int32_t index) {
  double longest = longest_period(signals, index, false);
  if (longest == 0.0) return longest_period(signals, index, true);
  return repeats_within(signals, index, longest) ? longest : 0.0;
}
