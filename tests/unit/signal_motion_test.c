/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Accelerations of signals against differences of their rates, and where their values jump. */
#include "engine/scene/signal.h"
#include "tests/support/test.h"

static double rate_of(const strut_signal *signals, int32_t index, double t) {
  double value, rate;
  strut_signal_evaluate(signals, index, t, &value, &rate);
  return rate;
}

static strut_signal wave(strut_signal_kind kind, double amplitude, double frequency) {
  strut_signal s = strut_signal_default(kind);
  s.amplitude = amplitude, s.frequency = frequency;
  return s;
}

TEST(accelerations_are_derivatives) {
  static const int32_t terms[] = {0, 1, 2};
  strut_signal s[4] = {wave(STRUT_SINE, 2, 1.5), wave(STRUT_HALF_SINE, 3, 0.25),
                       wave(STRUT_RAMP, 4, 0), strut_signal_default(STRUT_SUM)};
  s[0].phase = 0.3, s[0].start = -1;
  s[2].start = 0.1, s[2].stop = 5;
  s[3].terms = terms, s[3].term_count = 3, s[3].start = -10;
  for (int32_t i = 0; i < 4; i++)
    for (double t = 0.2; t < 1.9; t += 0.17) {
      double h = 1e-4, a = strut_signal_acceleration(s, i, t);
      double d = (rate_of(s, i, t + h) - rate_of(s, i, t - h)) / (2 * h);
      if (!(fabs(a - d) <= 1e-6 * (1 + fabs(a)))) fail_msg("signal %d at %g: %g, %g", i, t, a, d);
    }
}

TEST(jumps_of_values_are_found) {
  double when = 0;
  strut_signal s = wave(STRUT_SINE, 1, 2);
  assert_false(strut_signal_value_jumps(&s, 0, HUGE_VAL, &when));
  s.stop = 0.75; /* one and a half periods */
  assert_false(strut_signal_value_jumps(&s, 0, HUGE_VAL, &when));
  s.stop = 0.8;
  assert_true(strut_signal_value_jumps(&s, 0, HUGE_VAL, &when) && when == 0.8);
  assert_false(strut_signal_value_jumps(&s, 0, 0.5, &when));
  s = wave(STRUT_SINE, 1, 2);
  s.phase = 0.25; /* it begins with a jump at its start, unless that is t = 0 */
  assert_false(strut_signal_value_jumps(&s, 0, HUGE_VAL, &when));
  s.start = 0.1;
  assert_true(strut_signal_value_jumps(&s, 0, HUGE_VAL, &when) && when == 0.1);
  s = wave(STRUT_CONSTANT, 1, 0);
  assert_false(strut_signal_value_jumps(&s, 0, HUGE_VAL, &when));
  s = wave(STRUT_SQUARE, 1, 2);
  assert_true(strut_signal_value_jumps(&s, 0, HUGE_VAL, &when) && when == 0.25);
  s = wave(STRUT_HALF_SINE, 1, 2);
  s.start = 0.1;
  assert_false(strut_signal_value_jumps(&s, 0, HUGE_VAL, &when));
  s.stop = 0.2;
  assert_true(strut_signal_value_jumps(&s, 0, HUGE_VAL, &when) && when == 0.2);
  s = wave(STRUT_RAMP, 1, 0);
  s.start = 1, s.stop = 2;
  assert_false(strut_signal_value_jumps(&s, 0, HUGE_VAL, &when));
  assert_true(strut_signal_has_corners(&s, 0));
}
