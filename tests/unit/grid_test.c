/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The values of ranges: round where they are round, their ends as written, near the exact ones. */
#include "engine/study/sweep/sweep.h"
#include "tests/support/check.h"

static double value_of(strut_range_kind kind, double from, double to, int64_t i, int64_t count) {
  const strut_study_column column = {
      .kind = kind, .from = from, .to = to, .step = (to - from) / (double)(count - 1)};
  return strut_grid_value(&column, i, count);
}

/* Each decade is what its text says. */
static void assert_decades(int first, int last, int sign) {
  int count = last - first + 1;
  char text[32];
  for (int i = 0; i < count; i++) {
    snprintf(text, sizeof text, "1e%d", first + i);
    double wanted = sign * strtod(text, NULL);
    snprintf(text, sizeof text, "1e%d", first);
    double from = sign * strtod(text, NULL);
    snprintf(text, sizeof text, "1e%d", last);
    double to = sign * strtod(text, NULL);
    double found = value_of(STRUT_RANGE_RATIO, from, to, i, count);
    if (found != wanted) fail_msg("%d of %g to %g: %.17g, not %.17g", i, from, to, found, wanted);
    found = value_of(STRUT_RANGE_RATIO, to, from, count - 1 - i, count);
    if (found != wanted) fail_msg("%g down to %g: %.17g, not %.17g", to, from, found, wanted);
  }
}

TEST(decades_are_round) {
  assert_decades(0, 7, 1); /* once 9999999.999999998 */
  assert_decades(-3, 0, 1);
  assert_decades(-9, 12, -1);
  assert_decades(-40, -20, 1); /* where powers of ten are not exact */
  assert_decades(20, 60, 1);
  assert_decades(-250, 250, 1);
}

/* No decades: 15 digits of the exact value, here with long doubles from logarithms of base 2. */
TEST(other_ratios) {
  static const double ends[][2] = {
      {2.0, 3.0}, {0.1, 0.7}, {-5.0, -0.03}, {9.5, 11.0}, {1e-5, 37.0}};
  for (size_t k = 0; k < sizeof ends / sizeof ends[0]; k++)
    for (int count = 2; count < 40; count++)
      for (int i = 0; i < count; i++) {
        double from = ends[k][0], to = ends[k][1];
        double found = value_of(STRUT_RANGE_RATIO, from, to, i, count);
        long double exact = from * exp2l(log2l((long double)to / from) * i / (count - 1));
        if (i == 0) assert_true(found == from);
        if (i == count - 1) assert_true(found == to);
        assert_true(fabsl(found - exact) <= 5.1e-15L * fabsl(exact));
      }
  assert_true(value_of(STRUT_RANGE_RATIO, 1.0, 16.0, 2, 5) == 4.0);
  assert_true(value_of(STRUT_RANGE_RATIO, 0.3, 1.2, 1, 3) == 0.6);
}

/* Tenths, thousandths, ... over zero too, are the doubles nearest to them. */
TEST(even_steps_are_round) {
  static const struct {
    double from, to, unit;
    int64_t count;
  } ranges[] = {{0.1, 1.0, 10, 10},   {-0.3, 0.3, 10, 7},      {-1.0, 1.0, 100, 201},
                {0.1, 20.0, 10, 200}, {1e-3, 1.0, 1000, 1000}, {0.0, 1e-3, 1e6, 1001},
                {10.1, -9.9, 10, 201}};
  for (size_t k = 0; k < sizeof ranges / sizeof ranges[0]; k++)
    for (int64_t i = 0; i < ranges[k].count; i++) {
      double from = ranges[k].from, to = ranges[k].to, unit = ranges[k].unit;
      double first = rint(from * unit), last = rint(to * unit);
      double wanted = (first + (last - first) * (double)i / (double)(ranges[k].count - 1)) / unit;
      double even = value_of(STRUT_RANGE_EVEN, from, to, i, ranges[k].count);
      double step = value_of(STRUT_RANGE_STEP, from, to, i, ranges[k].count);
      if (even != wanted || step != wanted || (wanted == 0.0 && signbit(even)))
        fail_msg("%lld of %g to %g: %.17g, %.17g, not %.17g", (long long)i, from, to, even, step,
                 wanted);
    }
}

/* Ends with more than 15 digits are as written, however many values lie between. */
TEST(ends_are_as_written) {
  const double ends[] = {1.0 / 3.0, 0.1 + 0.2, 3.14159265358979323846, 1e22 / 7.0, 1e-300 / 3.0};
  for (size_t k = 0; k < sizeof ends / sizeof ends[0]; k++)
    for (int64_t count = 2; count < 20; count++) {
      double to = ends[k], from = to / 7.0;
      assert_all(value_of(STRUT_RANGE_EVEN, from, to, count - 1, count) == to,
                 value_of(STRUT_RANGE_RATIO, from, to, count - 1, count) == to,
                 value_of(STRUT_RANGE_EVEN, to, from, count - 1, count) == from,
                 value_of(STRUT_RANGE_RATIO, to, from, count - 1, count) == from,
                 value_of(STRUT_RANGE_STEP, to, from, 0, count) == to);
    }
}

/* What is not round stays within 15 digits; the smallest and the largest numbers stay numbers. */
TEST(extremes) {
  for (int i = 0; i < 1000; i++) {
    double third = value_of(STRUT_RANGE_EVEN, 0.0, 1.0, i, 1000);
    assert_true(fabs(third - i / 999.0) <= 5.1e-15 * third);
  }
  assert_all(value_of(STRUT_RANGE_EVEN, 0.0, 4e-310, 1, 3) == 2e-310,
             value_of(STRUT_RANGE_RATIO, 1e-310, 1e-300, 1, 3) > 0.0,
             value_of(STRUT_RANGE_EVEN, 1e307, 3e307, 1, 3) == 2e307,
             isfinite(value_of(STRUT_RANGE_RATIO, 1e-300, 1e300, 599, 601)));
}

/* The last axis runs fastest: by hand for 2 x 3 x 2 points. */
TEST(points_count_the_last_axis_first) {
  static const int64_t counts[] = {2, 3, 2};
  strut_study_column columns[3];
  strut_study_axis axes[3];
  int64_t point = 0;
  for (int i = 0; i < 3; i++) {
    columns[i] =
        (strut_study_column){.name = "a", .kind = STRUT_RANGE_STEP, .from = 10 * i, .step = 1};
    axes[i] = (strut_study_axis){.count = counts[i], .column_count = 1, .columns = &columns[i]};
  }
  const strut_study study = {.name = "test", .axis_count = 3, .axes = axes};
  assert_int_equal(strut_grid_points(&study), 12);
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 3; b++)
      for (int c = 0; c < 2; c++, point++) {
        strut_study_value values[3];
        strut_grid_values(&study, point, values);
        assert_all(values[0].number == a && values[1].number == 10 + b, values[2].number == 20 + c);
      }
}
