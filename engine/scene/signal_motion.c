/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scene/signal_motion.h"

#include <math.h>

#include "engine/base/trig.h"
#include "engine/base/vec.h"

/* Values below this part of the amplitude are zero but for rounding. */
static const double ROUNDING = 1e-9;

static double wave_acceleration(const strut_signal *s, double turns) {
  double sine, cosine, omega = STRUT_TAU * s->frequency;
  strut_sincos_turns(turns, &sine, &cosine);
  return -s->amplitude * omega * omega * sine;
}

double strut_signal_acceleration(const strut_signal *signals, int32_t index, double t) {
  const strut_signal *s = &signals[index];
  double turns = s->frequency * (t - s->start) + s->phase, sum = 0.0;
  bool on = t >= s->start && t < s->stop;
  switch (s->kind) {
    case STRUT_SINE: return on ? wave_acceleration(s, turns) : 0.0;
    case STRUT_HALF_SINE: return on && turns < 0.5 ? wave_acceleration(s, turns) : 0.0;
    case STRUT_SUM:
      for (size_t i = 0; i < s->term_count && on; i++)
        sum += strut_signal_acceleration(signals, s->terms[i], t);
      return sum;
    case STRUT_CONSTANT:
    case STRUT_SQUARE:
    case STRUT_RAMP:
    case STRUT_TABLE:
    case STRUT_EXPRESSION:
    case STRUT_RELAY:
    case STRUT_SIGNAL_KINDS: break;
  }
  return 0.0;
}

/* Is the signal away from zero at its time `at`, where it is switched on or off? */
static bool is_cut(const strut_signal *s, double at) {
  double sine, cosine;
  if (s->kind == STRUT_CONSTANT || s->kind == STRUT_SQUARE) return s->amplitude != 0.0;
  double turns = s->frequency * (at - s->start) + s->phase;
  if (s->kind == STRUT_HALF_SINE && turns >= 0.5) return false;
  strut_sincos_turns(turns, &sine, &cosine);
  return s->amplitude != 0.0 && fabs(sine) > ROUNDING * (1.0 + fabs(turns));
}

/* A start or stop of the signal after 0 and up to `last`, if there is one. */
static bool switches_within(double time, double last) {
  return time > 0.0 && time <= last && time < HUGE_VAL;
}

bool strut_signal_value_jumps(const strut_signal *signals, int32_t index, double last,
                              double *when) {
  const strut_signal *s = &signals[index];
  switch (s->kind) {
    case STRUT_RAMP:
    case STRUT_TABLE: return false;
    case STRUT_SUM:
      for (size_t i = 0; i < s->term_count; i++)
        if (strut_signal_value_jumps(signals, s->terms[i], last, when)) return true;
      return false;
    case STRUT_SQUARE:
      *when = strut_signal_next_break(signals, index, 0.0);
      if (s->amplitude != 0.0 && *when <= last) return true;
      break;
    case STRUT_CONSTANT:
    case STRUT_SINE:
    case STRUT_HALF_SINE:
    case STRUT_EXPRESSION:
    case STRUT_RELAY:
    case STRUT_SIGNAL_KINDS: break;
  }
  if (switches_within(*when = s->start, last) && is_cut(s, s->start)) return true;
  return switches_within(*when = s->stop, last) && is_cut(s, s->stop);
}

bool strut_signal_is_wave(const strut_signal *signals, int32_t index) {
  const strut_signal *s = &signals[index];
  if (strut_signal_has_program(s) || s->lag > 0.0 || s->every > 0.0) return false;
  if (s->trigger.kind != STRUT_TRIGGER_NONE) return false;
  for (size_t i = 0; s->kind == STRUT_SUM && i < s->term_count; i++)
    if (!strut_signal_is_wave(signals, s->terms[i])) return false;
  return true;
}

bool strut_signal_has_corners(const strut_signal *signals, int32_t index) {
  return strut_signal_next_break(signals, index, 0.0) < HUGE_VAL;
}
