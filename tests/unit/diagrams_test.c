/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What diagrams are made of: round ticks, prefixes, thinned curves, the front of the best. */
#include "engine/base/vec.h"
#include "engine/output/draw/painter.h"
#include "engine/study/tradeoff/tradeoff.h"
#include "tests/support/random.h"
#include "tests/support/test.h"
#include "tests/unit/scratch.h"

/* 1, 2 or 5 times a power of ten. */
static bool is_round(double step) {
  double power = pow(10.0, floor(log10(step) + 1e-9)), part = step / power;
  return fabs(part - 1) < 1e-6 || fabs(part - 2) < 1e-6 || fabs(part - 5) < 1e-6;
}

TEST(ticks) {
  uint64_t seed = 1;
  for (int i = 0; i < 20000; i++) {
    double low = 2 * random_between(&seed, 0, 1) - 1;
    low *= pow(10.0, 12 * random_between(&seed, 0, 1) - 6);
    double span = pow(10.0, 12 * random_between(&seed, 0, 1) - 6), ticks[STRUT_MOST_TICKS];
    int wanted = 2 + (int)(8 * random_between(&seed, 0, 1));
    if (span < 1e-9 * fabs(low)) continue;
    size_t count = strut_ticks(low, low + span, wanted, ticks);
    if (count < (size_t)wanted / 2 || count > 2 * (size_t)wanted + 1)
      fail_msg("%zu ticks in %.17g + %.17g, wanted about %d", count, low, span, wanted);
    for (size_t k = 0; k < count; k++)
      assert_true(ticks[k] >= low - 1e-6 * span && ticks[k] <= low + span + 1e-6 * span);
    if (count > 1) {
      double step = ticks[1] - ticks[0];
      if (fabs(low) > 1e4 * span) continue; /* steps lose digits */
      assert_true(is_round(step));
      assert_true(fabs(ticks[0] / step - round(ticks[0] / step)) < 1e-3);
    }
  }
  double ticks[STRUT_MOST_TICKS];
  assert_int_equal(strut_ticks(0, 10, 5, ticks), 6);
  assert_true(ticks[0] == 0 && ticks[5] == 10);
  assert_int_equal(strut_ticks(1, 1, 5, ticks), 0);
  assert_int_equal(strut_ticks((double)NAN, 1, 5, ticks), 0);
  assert_int_equal(strut_ticks(-1e308, 1e308, 5, ticks), 0);
}

TEST(prefixes) {
  static const struct {
    double largest;
    const char *unit, *prefix;
    double factor;
  } cases[] = {{0.0214, "m/s", "m", 1e-3}, {1, "m", "", 1},           {999, "N", "", 1},
               {1000, "N", "k", 1e3},      {2e-7, "J", "n", 1e-9},    {0.02, "%", "", 1},
               {0.02, "kg", "", 1},        {0.02, "", "", 1},         {0, "m", "", 1},
               {1e40, "m", "", 1},         {(double)NAN, "m", "", 1}, {2e-6, "m^2", "", 1},
               {2e-6, "mm", "", 1},        {2000, "N/m", "k", 1e3},   {20, "kN/m", "", 1}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    double factor;
    assert_string_equal(strut_prefix(cases[i].largest, cases[i].unit, &factor), cases[i].prefix);
    assert_true(fabs(factor / cases[i].factor - 1) < 1e-12);
  }
}

static strut_tick_set ticks_of(const char *unit, bool logarithmic, double low, double high) {
  strut_tick_set set;
  const strut_axis axis = {
      .name = "error", .unit = unit, .logarithmic = logarithmic, .low = low, .high = high};
  strut_axis_ticks(&axis, 5, &set);
  return set;
}

/* One value far above all others is left out of a scale, several are not. */
TEST(outliers) {
  double values[40], heights[] = {167e3, 64, 71, 87}, two[] = {1, 100};
  double range[] = {NAN, NAN};
  char text[STRUT_BEYOND_TEXT];
  for (int i = 0; i < 40; i++) values[i] = i == 20 ? 100 : i % 10;
  strut_beyond beyond = strut_leave_out(values, 40, 0.05, range);
  assert_true(range[0] == 0 && range[1] == 9 && beyond.above == 1 && beyond.below == 0);
  const strut_file_unit cal = {"cal", 4.184}, none = {0};
  assert_string_equal(strut_beyond_text(&beyond, "point", "J", none, text),
                      "1 point beyond the scale, up to 100 J");
  assert_string_equal(strut_beyond_text(&beyond, "point", "J", cal, text),
                      "1 point beyond the scale, up to 23.9 cal");
  for (int i = 0; i < 40; i++) values[i] = i % 4 ? i % 10 : 100;
  range[0] = range[1] = NAN;
  beyond = strut_leave_out(values, 40, 0.05, range);
  assert_true(range[0] == 0 && range[1] == 100 && beyond.above == 0);
  range[0] = 0, range[1] = 68;
  beyond = strut_leave_out(heights, 4, 1.0 / 3, range);
  assert_true(range[0] == 0 && range[1] == 87);
  assert_true(beyond.above == 1 && beyond.farthest == 167e3);
  range[1] = 0;
  beyond = strut_leave_out(two, 2, 1.0 / 3, range);
  assert_true(range[1] == 100 && beyond.above == 0);
  assert_string_equal(strut_beyond_text(&beyond, "point", "J", none, text), "");
}

TEST(tick_texts) {
  strut_tick_set set = ticks_of("m/s", false, -0.011, 0.012);
  assert_string_equal(set.label, "error in mm/s");
  assert_string_equal(set.text[0], "-10"); /* the canvas draws minus signs */
  set = ticks_of("m", true, 1e-9, 1e-3);
  assert_all_texts(set.label, "error in m", set.text[0], "10⁻⁸");
  set = ticks_of("s", false, 1e6, 1e6 + 0.05); /* what all have in common is said once */
  assert_non_null(strstr(set.label, "1000000"));
  assert_string_equal(set.text[1], "10");
  set = ticks_of("m", false, 1e9 - 1.07e-3, 1e9 + 1.07e-3); /* of few digits, not the lower end */
  assert_string_equal(set.label, "error \xe2\x88\x92 1000000000 m in mm");
  assert_string_equal(set.text[0], "-1.0");
  set = ticks_of("m", false, 0, 9e-300);
  assert_string_equal(set.text[1], "2×10⁻³⁰⁰");
  set = ticks_of("", false, -9e299, 0);
  assert_string_equal(set.text[0], "-8×10²⁹⁹");
  set = ticks_of("rad", false, 0, STRUT_PI / 3);
  assert_all_texts(set.label, "error in deg", set.text[1], "10");
  assert_true(fabs(set.at[1] - STRUT_PI / 18) < 1e-12);
  strut_axis micro = {.name = "a", .unit = "m", .high = 2e-3, .shown = {"um", 1e-6}};
  strut_axis_ticks(&micro, 5, &set); /* in the unit that the file gives, whatever the range */
  assert_all_texts(set.label, "a in \xc2\xb5m", set.text[set.count - 1], "2000");
  micro = (strut_axis){.name = "c",
                       .unit = "N/m",
                       .logarithmic = true,
                       .low = 1e3,
                       .high = 1e6,
                       .shown = {"kN/m", 1e3}};
  strut_axis_ticks(&micro, 5, &set);
  assert_string_equal(set.label, "c in kN/m");
  assert_true(fabs(set.at[0] / 1e3 - 1) < 1e-12 && !strcmp(set.text[0], "10⁰"));
  set = ticks_of("", true, 2, 8);
  assert_all_texts(set.text[0], "2", set.text[1], "5");
}

/* Whatever the data, there is an axis that can be drawn. */
TEST(settle) {
  static const double values[] = {0,      -0.0,  1,        -3,          1e300,     -1e300, 1e-300,
                                  5e-324, 1e308, -1.7e308, (double)NAN, -HUGE_VAL, 42,     1e9};
  enum { COUNT = sizeof values / sizeof *values };
  for (size_t i = 0; i < COUNT; i++)
    for (size_t k = 0; k < COUNT; k++)
      for (int logarithmic = 0; logarithmic < 2; logarithmic++) {
        strut_axis axis = strut_axis_of("a", "m");
        axis.logarithmic = logarithmic;
        strut_tick_set set;
        strut_axis_include(&axis, values[i]);
        strut_axis_include(&axis, values[k]);
        strut_axis_settle(&axis, 0.06);
        if (!(axis.low < axis.high) || (logarithmic && !(axis.low > 0)))
          fail_msg("%g, %g: from %g to %g", values[i], values[k], axis.low, axis.high);
        strut_axis_ticks(&axis, 5, &set);
      }
}

/* Least and largest of each stretch survive, and the ends. */
TEST(thinning) {
  enum { COUNT = 20000 };
  double(*points)[2] = malloc(COUNT * sizeof *points), (*all)[2] = malloc(COUNT * sizeof *all);
  uint64_t seed = 2;
  for (size_t i = 0; i < COUNT; i++) {
    all[i][0] = 200.0 * (double)i / COUNT;
    all[i][1] = random_between(&seed, 0, 1) + (i == 777 ? 100 : i == 13131 ? -100 : 0);
  }
  memcpy(points, all, COUNT * sizeof *points);
  size_t count = strut_thin(points, COUNT, 0.25);
  assert_true(count <= 4 * 801 && count > 1600);
  for (size_t cell = 0, i = 0, k = 0; cell < 800; cell++) {
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    for (; i < COUNT && all[i][0] < 0.25 * (double)(cell + 1); i++) {
      low[0] = fmin(low[0], all[i][1]);
      high[0] = fmax(high[0], all[i][1]);
    }
    for (; k < count && points[k][0] < 0.25 * (double)(cell + 1); k++) {
      low[1] = fmin(low[1], points[k][1]);
      high[1] = fmax(high[1], points[k][1]);
    }
    assert_true(low[0] == low[1] && high[0] == high[1]);
  }
  assert_memory_equal(points[0], all[0], sizeof *all);
  assert_memory_equal(points[count - 1], all[COUNT - 1], sizeof *all);
  for (size_t i = 0; i < 100; i++) points[i][0] = (double)((7 * i) % 100); /* not a function of x */
  assert_int_equal(strut_thin(points, 100, 1000), 100);
  free(points);
  free(all);
}

TEST(front) {
  enum { COUNT = 60 };
  double b[COUNT][2];
  bool front[COUNT];
  uint64_t seed = 3;
  for (int round = 0; round < 200; round++) {
    for (size_t i = 0; i < COUNT; i++) {
      b[i][0] = 1 + floor(10 * random_between(&seed, 0, 1));
      b[i][1] = random_between(&seed, 0, 1) < 0.1 ? (double)NAN
                                                  : 1 + floor(10 * random_between(&seed, 0, 1));
    }
    strut_pareto_front((const double(*)[2])b, COUNT, front);
    for (size_t i = 0; i < COUNT; i++) {
      bool beaten = !isfinite(b[i][1]);
      for (size_t k = 0; k < COUNT; k++)
        if (isfinite(b[k][1]) && ((b[k][0] < b[i][0] && b[k][1] <= b[i][1]) ||
                                  (b[k][0] <= b[i][0] && b[k][1] < b[i][1])))
          beaten = true;
      assert_int_equal(front[i], !beaten);
    }
  }
}

static const unsigned char *pixel(strut_canvas *canvas, double x, double y) {
  size_t stride;
  const unsigned char *bytes = strut_canvas_pixels(canvas, &stride);
  return bytes + (size_t)y * stride + 4 * (size_t)x;
}

/* Two by two cells: each quarter of the frame has its category's colour; without seams between. */
TEST(map) {
  static const double xs[] = {1, 2}, ys[] = {10, 20};
  static const double category[] = {0, 1, 1, 0};
  static const char *const names[] = {"I", "II"};
  const strut_map map = {.columns = 2,
                         .rows = 2,
                         .xs = xs,
                         .ys = ys,
                         .name_count = 2,
                         .names = names,
                         .value = category};
  strut_panel panel = {.x = strut_axis_of("a", ""), .y = strut_axis_of("b", ""), .map = &map};
  strut_arena arena = {0};
  strut_canvas *canvas;
  assert_int_equal(strut_canvas_open_pixels(400, 300, 1, &canvas, NULL), STRUT_OK);
  assert_true(strut_panels_settle(&panel, 1, &arena));
  assert_true(strut_draw_panel(canvas, (strut_box){0, 0, 400, 300}, &panel, true, &arena));
  strut_arena_free(&arena);
  const unsigned char *low_left = pixel(canvas, 120, 220), *low_right = pixel(canvas, 320, 220);
  const unsigned char *high_left = pixel(canvas, 120, 80), *high_right = pixel(canvas, 320, 80);
  assert_memory_equal(low_left, high_right, 3);
  assert_memory_equal(low_right, high_left, 3);
  assert_memory_not_equal(low_left, low_right, 3);
  for (int x = 60; x < 380; x++) { /* along a row there are two colours, and no third between */
    const unsigned char *at = pixel(canvas, x, 220);
    int apart = abs(at[0] - low_left[0]) + abs(at[1] - low_left[1]) + abs(at[2] - low_left[2]);
    int other = abs(at[0] - low_right[0]) + abs(at[1] - low_right[1]) + abs(at[2] - low_right[2]);
    int both = abs(low_left[0] - low_right[0]) + abs(low_left[1] - low_right[1]) +
               abs(low_left[2] - low_right[2]);
    assert_true(apart + other <= both + 6);
  }
  strut_canvas_free(canvas);
}
