/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Waveforms against their closed forms, and their rates against differences. */
#include "engine/scene/signal.h"
#include "engine/scene/signal_program.h"
#include "tests/support/check.h"

static const double PI = 3.14159265358979323846;

static double value_of(const strut_signal *signals, int32_t index, double t) {
  double value, rate;
  strut_signal_evaluate(signals, index, t, &value, &rate);
  return value;
}

static double rate_of(const strut_signal *signals, int32_t index, double t) {
  double value, rate;
  strut_signal_evaluate(signals, index, t, &value, &rate);
  return rate;
}

static strut_signal sine(double amplitude, double frequency, double phase, double start) {
  strut_signal s = strut_signal_default(STRUT_SINE);
  s.amplitude = amplitude, s.frequency = frequency, s.phase = phase, s.start = start;
  return s;
}

static strut_signal sum(const int32_t *terms, size_t count) {
  strut_signal s = strut_signal_default(STRUT_SUM);
  s.terms = terms, s.term_count = count;
  return s;
}

TEST(defaults) {
  strut_signal s = strut_signal_default(STRUT_RAMP);
  assert_int_equal(s.kind, STRUT_RAMP);
  assert_true(s.start == 0.0 && isinf(s.stop) && s.phase == 0.0 && s.name == NULL);
}

TEST(constants_begin_at_zero) {
  strut_signal s = strut_signal_default(STRUT_CONSTANT);
  s.amplitude = 3;
  assert_all(value_of(&s, 0, -1) == 0.0, value_of(&s, 0, 0) == 3.0, value_of(&s, 0, 1e9) == 3.0);
  assert_true(rate_of(&s, 0, 5) == 0.0);
}

TEST(sines) {
  strut_signal s = sine(2, 10, 0.125, 0.3);
  s.stop = 5;
  for (int i = 0; i < 1000; i++) {
    double t = 0.3 + 0.0047 * i, angle = 2 * PI * (10 * (t - 0.3) + 0.125);
    assert_near(value_of(&s, 0, t), t < 5 ? 2 * sin(angle) : 0, 1e-12);
    assert_near(rate_of(&s, 0, t), t < 5 ? 2 * 2 * PI * 10 * cos(angle) : 0, 1e-10);
  }
  assert_all(value_of(&s, 0, 0.2999) == 0.0, rate_of(&s, 0, 0.2999) == 0.0);
  assert_true(value_of(&s, 0, 5.0001) == 0.0);
}

/* The phase is exact: after a million whole periods a sine stands where it began. */
TEST(sines_do_not_drift) {
  strut_signal s = sine(1, 0.25, 0, 0);
  for (int i = 0; i < 1000; i++) {
    double t = 4e6 + 0.015625 * i;
    assert_true(value_of(&s, 0, t) == value_of(&s, 0, 0.015625 * i));
  }
  assert_all(value_of(&s, 0, 4e6 + 1) == 1.0, value_of(&s, 0, 4e6 + 2) == 0.0);
}

TEST(half_sines_are_one_pulse) {
  strut_signal s = sine(0.8, 10, 0, 1);
  s.kind = STRUT_HALF_SINE;
  assert_true(value_of(&s, 0, 0.99) == 0.0);
  assert_near(value_of(&s, 0, 1.025), 0.8, 1e-13);
  assert_near(value_of(&s, 0, 1.01), 0.8 * sin(2 * PI * 0.1), 1e-13);
  assert_near(rate_of(&s, 0, 1), 0.8 * 2 * PI * 10, 1e-11);
  assert_all(value_of(&s, 0, 1.0501) == 0.0, value_of(&s, 0, 1.125) == 0.0,
             rate_of(&s, 0, 1.06) == 0.0, strut_signal_period(&s, 0) == 1.0 / 10);
}

TEST(squares) {
  strut_signal s = sine(3, 2, 0, 0);
  s.kind = STRUT_SQUARE;
  assert_all(value_of(&s, 0, 0) == 3.0, value_of(&s, 0, 0.2499) == 3.0,
             value_of(&s, 0, 0.25) == -3.0, value_of(&s, 0, 0.4999) == -3.0);
  assert_all(value_of(&s, 0, 100.5) == 3.0, rate_of(&s, 0, 0.25) == 0.0);
  s.phase = 0.25;
  assert_true(value_of(&s, 0, 0.1251) == -3.0);
  s.phase = -0.25;
  assert_all(value_of(&s, 0, 0) == -3.0, strut_signal_period(&s, 0) == 0.5);
}

TEST(ramps_hold_their_end) {
  strut_signal s = strut_signal_default(STRUT_RAMP);
  s.amplitude = -6, s.start = 1, s.stop = 3;
  assert_all(value_of(&s, 0, 0.5) == 0.0, value_of(&s, 0, 1.5) == -1.5, rate_of(&s, 0, 1) == -3.0,
             rate_of(&s, 0, 0.999) == 0.0, value_of(&s, 0, 3) == -6.0, rate_of(&s, 0, 3) == 0.0);
  assert_true(value_of(&s, 0, 1e6) == -6.0);
}

TEST(tables) {
  static const double time[] = {1, 2, 4, 4.5, 4.5}, value[] = {10, 20, -20, 0, 5};
  strut_signal s = strut_signal_default(STRUT_TABLE);
  s.time = time, s.value = value, s.point_count = 5;
  assert_true(value_of(&s, 0, 4.5) == 5.0 && value_of(&s, 0, 4.25) == -10.0);
  assert_true(strut_signal_value_jumps(&s, 0, 9, &(double){0}));
  s.point_count = 4;
  for (int i = 0; i < 4; i++) assert_true(value_of(&s, 0, time[i]) == value[i]);
  assert_all(value_of(&s, 0, -5) == 10.0 && rate_of(&s, 0, -5) == 0.0,
             value_of(&s, 0, 1.5) == 15.0 && rate_of(&s, 0, 1) == 10.0,
             value_of(&s, 0, 3) == 0.0 && rate_of(&s, 0, 2) == -20.0,
             value_of(&s, 0, 4.25) == -10.0 && rate_of(&s, 0, 4.25) == 40.0,
             value_of(&s, 0, 9) == 0.0 && rate_of(&s, 0, 4.5) == 0.0);
  s.point_count = 1;
  assert_true(value_of(&s, 0, 0) == 10.0 && value_of(&s, 0, 3) == 10.0);
}

TEST(sums_add_values_and_rates) {
  static const int32_t first[] = {0, 1, 1}, second[] = {2, 0};
  strut_signal s[4] = {sine(1, 3, 0, 0), strut_signal_default(STRUT_RAMP), sum(first, 3),
                       sum(second, 2)};
  s[1].amplitude = 2, s[1].stop = 4;
  for (double t = 0; t < 5; t += 0.37) {
    assert_near(value_of(s, 2, t), value_of(s, 0, t) + 2 * value_of(s, 1, t), 1e-14);
    assert_near(rate_of(s, 3, t), 2 * rate_of(s, 0, t) + 2 * rate_of(s, 1, t), 1e-12);
  }
}

TEST(rates_are_derivatives) {
  static const double time[] = {0.2, 0.9, 1.7}, value[] = {1, -3, 5};
  static const int32_t terms[] = {0, 1, 2, 3};
  strut_signal s[5] = {sine(1, 3, 0.1, 0), sine(2, 0.5, 0, 0), strut_signal_default(STRUT_TABLE),
                       strut_signal_default(STRUT_RAMP), sum(terms, 4)};
  s[1].kind = STRUT_HALF_SINE;
  s[2].time = time, s[2].value = value, s[2].point_count = 3;
  s[3].amplitude = 1, s[3].start = 0.1, s[3].stop = 1.95;
  for (int i = 0; i < 5; i++)
    for (double t = 0.0313; t < 1.9; t += 0.0177) {
      double h = 1e-6, slope = (value_of(s, i, t + h) - value_of(s, i, t - h)) / (2 * h);
      if (fabs(t - 0.2) < 2 * h || fabs(t - 0.9) < 2 * h || fabs(t - 1.7) < 2 * h) continue;
      assert_near(rate_of(s, i, t), slope, 1e-7);
    }
}

TEST(periods) {
  static const int32_t fitting[] = {0, 1, 3}, clashing[] = {0, 2}, none[] = {3}, nested[] = {4, 1},
                       pulsed[] = {0, 8}, pulse[] = {3, 8};
  strut_signal s[11] = {
      sine(1, 10, 0, 0), sine(1, 30, 0, 0), sine(1, 15, 0, 0), strut_signal_default(STRUT_CONSTANT),
      sum(fitting, 3),   sum(clashing, 2),  sum(none, 1),      sum(nested, 2),
      sine(1, 3, 0, 0),  sum(pulsed, 2),    sum(pulse, 2)};
  s[8].kind = STRUT_HALF_SINE; /* a pulse spoils no sum, and counts where nothing repeats */
  assert_all(strut_signal_period(s, 0) == 1.0 / 10, strut_signal_period(s, 3) == 0.0,
             strut_signal_period(s, 4) == 1.0 / 10, strut_signal_period(s, 5) == 0.0);
  assert_all(strut_signal_period(s, 6) == 0.0, strut_signal_period(s, 7) == 1.0 / 10,
             strut_signal_period(s, 9) == 1.0 / 10, strut_signal_period(s, 10) == 1.0 / 3);
}

/* When a signal or its rate jumps next: by hand, for each kind. */
TEST(breaks) {
  static const double times[] = {0.5, 1.0, 2.0}, values[] = {0, 1, 1};
  static const int32_t terms[] = {1, 4};
  strut_signal s[7];
  static const strut_signal_kind kinds[] = {STRUT_SINE,  STRUT_SQUARE, STRUT_HALF_SINE, STRUT_RAMP,
                                            STRUT_TABLE, STRUT_SUM,    STRUT_CONSTANT};
  for (int i = 0; i < 7; i++) s[i] = strut_signal_default(kinds[i]);
  for (int i = 0; i < 3; i++) s[i].frequency = 3, s[i].amplitude = 1;
  s[1].frequency = 4, s[1].phase = 0.25, s[1].start = 0.1;
  s[2].frequency = 2, s[2].start = s[3].start = s[6].start = 1, s[3].stop = 3, s[6].stop = 2;
  s[4].time = times, s[4].value = values, s[4].point_count = 3;
  s[5] = sum(terms, 2);
  assert_true(isinf(strut_signal_next_break(s, 0, 5)));
  assert_true(fabs(strut_signal_next_break(s, 1, 0) - (0.1)) <= 1e-15);
  /* half periods of 1/8 s, the first a quarter of a period after the start */
  assert_true(fabs(strut_signal_next_break(s, 1, 0.1) - (0.1625)) <= 1e-12);
  assert_true(fabs(strut_signal_next_break(s, 1, 0.17) - (0.2875)) <= 1e-12);
  double t = 0.1;
  for (int k = 0; k < 1000; k++) { /* none twice, none left out */
    double next = strut_signal_next_break(s, 1, t + 1e-9);
    assert_true(fabs(next - (0.1625 + 0.125 * k)) <= 1e-9);
    t = next;
  }
  assert_all(strut_signal_next_break(s, 2, 0) == 1.0, strut_signal_next_break(s, 2, 1) == 1.25,
             isinf(strut_signal_next_break(s, 2, 1.25)),
             strut_signal_next_break(s, 3, 0) == 1.0 && strut_signal_next_break(s, 3, 1) == 3.0,
             isinf(strut_signal_next_break(s, 3, 3)),
             strut_signal_next_break(s, 4, 0) == 0.5 && strut_signal_next_break(s, 4, 0.5) == 1.0,
             strut_signal_next_break(s, 4, 1.5) == 2.0 && isinf(strut_signal_next_break(s, 4, 2)),
             fabs(strut_signal_next_break(s, 5, 0.45) - (0.5)) <= 1e-12,
             strut_signal_next_break(s, 6, 0) == 1.0 && strut_signal_next_break(s, 6, 1) == 2.0,
             isinf(strut_signal_next_break(s, 6, 2)));
}

/* ---- measured signals ---- */

static const double measured_times[] = {0.0, 0.1, 0.15, 0.4, 0.5},
                    measured_values[] = {1.0, 2.0, 2.0, -1.0, 0.5};

static strut_signal measured(bool smooth, uint32_t outside) {
  strut_signal s = strut_signal_default(STRUT_DATA);
  s.time = measured_times, s.value = measured_values, s.point_count = 5;
  s.smooth = smooth, s.outside = outside;
  return s;
}

TEST(data_with_straight_lines_are_a_table) {
  strut_signal s = measured(false, STRUT_OUTSIDE_HOLD), table = s;
  table.kind = STRUT_TABLE;
  for (int i = -10; i < 80; i++) {
    double t = 0.01 * i;
    assert_true(value_of(&s, 0, t) == value_of(&table, 0, t));
    assert_true(rate_of(&s, 0, t) == rate_of(&table, 0, t));
    assert_true(strut_signal_next_break(&s, 0, t) == strut_signal_next_break(&table, 0, t));
  }
}

/* Monotone between points, smooth at them, with the rate that differences have. */
TEST(smooth_data_stay_between_their_points) {
  strut_signal s = measured(true, STRUT_OUTSIDE_HOLD);
  for (size_t i = 0; i < 5; i++)
    assert_near(value_of(&s, 0, measured_times[i]), measured_values[i], 0);
  for (int i = 1; i < 500; i++) {
    double t = 0.001 * i, h = 1e-7, value = value_of(&s, 0, t);
    assert_near(rate_of(&s, 0, t), (value_of(&s, 0, t + h) - value_of(&s, 0, t - h)) / (2 * h),
                1e-4);
    assert_near(strut_signal_acceleration(&s, 0, t),
                (rate_of(&s, 0, t + h) - rate_of(&s, 0, t)) / h, i % 50 ? 1e-2 : 1e9);
    assert_true(value >= -1.0 && value <= 2.0);
    if (t > 0.1 && t < 0.15) assert_near(value, 2.0, 0);
  }
  /* Steffen's slopes: of the first piece at its begin, the smaller of two secants inside */
  assert_near(rate_of(&s, 0, 0.0), 10.0, 1e-12);
  assert_near(rate_of(&s, 0, 0.1), 0.0, 1e-12);
}

TEST(bounds_of_smooth_data_hold) {
  for (int k = 0; k < 4000; k++) {
    strut_signal s = measured(true, k % 2 ? STRUT_OUTSIDE_REPEAT : STRUT_OUTSIDE_HOLD);
    double from = 0.0003 * k - 0.1, to = from + 0.0007 * (k % 97);
    const strut_instruction of = {.operation = STRUT_OPERATION_COLUMN,
                                  .column = {.kind = STRUT_COLUMN_SIGNAL, .item = 0}};
    const strut_program program = {1, 1, &of};
    strut_signal_bounds b = strut_program_bound(&program, &s, NULL, from, to);
    for (int i = 0; i <= 40; i++) {
      double t = from + (to - from) * i / 40, value = value_of(&s, 0, t), rate = rate_of(&s, 0, t);
      assert_true(value >= b.value.low - 1e-12 && value <= b.value.high + 1e-12);
      assert_true(rate >= b.rate.low - 1e-9 && rate <= b.rate.high + 1e-9);
    }
  }
}

TEST(repeated_data_are_periodic) {
  for (int smooth = 0; smooth < 2; smooth++) {
    strut_signal s = measured(smooth, STRUT_OUTSIDE_REPEAT);
    double when = 0.0, t = 0.0;
    assert_near(strut_signal_period(&s, 0), 0.5, 0);
    for (int i = 0; i < 400; i++)
      assert_near(value_of(&s, 0, 0.00125 * i + 7.5), value_of(&s, 0, 0.00125 * i), 1e-12);
    assert_true(strut_signal_value_jumps(&s, 0, 1.0, &when) && when == 0.5);
    for (int k = 1; k <= 1000; k++) { /* each point, none twice */
      double next = strut_signal_next_break(&s, 0, t);
      assert_near(next, 0.5 * ((k - 1) / 4) + measured_times[(k - 1) % 4 + 1], 1e-10);
      assert_true(next > t);
      t = next;
      if (k % 4 == 0) assert_near(value_of(&s, 0, t), 1.0, 1e-9); /* from the right */
    }
  }
}
