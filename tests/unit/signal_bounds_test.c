/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bounds of random expressions against their values and rates; kinks and the longest steps of known ones. */

#include "engine/scene/signal_program.h"
#include "tests/support/random.h"
#include "tests/support/test.h"

enum { MOST = 40, PROGRAMS = 20000, POINTS = 40 };

static uint64_t seed = 59;

static double uniform(double low, double high) { return random_between(&seed, low, high); }

static strut_instruction number(double x) {
  return (strut_instruction){.operation = STRUT_OPERATION_NUMBER, .number = x};
}

static const strut_instruction TIME = {.operation = STRUT_OPERATION_COLUMN,
                                       .column = {STRUT_COLUMN_TIME, -1, -1}};

static strut_instruction operation(strut_operation id) {
  return (strut_instruction){.operation = id};
}

/* A random program of the time and of numbers, some of them whole. */
static strut_program random_program(strut_instruction *p) {
  size_t count = 0, top = 0, wanted = (size_t)uniform(2, 12);
  while (count < wanted || top > 1) {
    int id = (int)uniform(STRUT_OPERATION_ADD, STRUT_OPERATION_COUNT);
    int operands = strut_operation_operands((strut_operation)id);
    if (top < 2 && (count >= wanted ? operands == 2 : uniform(0, 1) < 0.5)) operands = 0;
    if (count >= wanted && top > 1 && operands != 2) continue;
    if ((size_t)operands > top) continue;
    double x = uniform(-3, 3);
    if (operands == 0)
      p[count++] = uniform(0, 1) < 0.6 ? TIME : number(uniform(0, 1) < 0.5 ? floor(x) : x);
    else
      p[count++] = operation((strut_operation)id);
    top += operands == 0 ? 1 : 1 - (size_t)operands;
  }
  return (strut_program){.length = count, .depth = MOST, .instruction = p};
}

static bool within(strut_range range, double x) {
  double slack = 1e-12 * fabs(x) + 1e-300;
  return isnan(x) || isinf(x) || (range.low <= x + slack && x - slack <= range.high);
}

/* Is an operand of the program none at time t, though the program may not show it? */
static bool has_no_number(strut_program program, double t) {
  strut_instruction p[MOST];
  double value, rate;
  for (size_t i = 0; i < program.length; i++) {
    strut_operation id = program.instruction[i].operation;
    bool hides = id == STRUT_OPERATION_MIN || id == STRUT_OPERATION_MAX ||
                 id == STRUT_OPERATION_HYPOT || id == STRUT_OPERATION_ATAN2;
    p[i] = hides ? operation(STRUT_OPERATION_ADD) : program.instruction[i];
  }
  program.instruction = p;
  strut_program_evaluate(&program, NULL, NULL, t, &value, &rate);
  return isnan(value);
}

TEST(bounds_hold_values_and_rates) {
  strut_instruction p[MOST];
  int tight = 0;
  for (int n = 0; n < PROGRAMS; n++) {
    strut_program program = random_program(p);
    double from = uniform(0, 4), to = from + pow(10.0, uniform(-6, 0.5));
    strut_signal_bounds all = strut_program_bound(&program, NULL, NULL, from, to);
    assert_true(all.value.low <= all.value.high && all.rate.low <= all.rate.high);
    for (int k = 0; k <= POINTS; k++) {
      double t = k == POINTS ? to : from + (to - from) * k / POINTS, value, rate;
      strut_program_evaluate(&program, NULL, NULL, t, &value, &rate);
      if (isnan(value) || has_no_number(program, t)) continue;
      if (!within(all.value, value) || !within(all.rate, rate))
        fail_msg("program %d at %.17g in %.17g to %.17g: value %g in %g to %g, rate %g in %g to %g",
                 n, t, from, to, value, all.value.low, all.value.high, rate, all.rate.low,
                 all.rate.high);
    }
    tight += all.value.high < HUGE_VAL && all.value.low > -HUGE_VAL;
  }
  assert_true(tight > PROGRAMS / 2);
}

/* All kinks from t = 0 on, one after the other, are `times` (count), and no more up to 100 s. */
static void check_kinks(strut_program program, const double *times, int count) {
  double t = 0.0;
  for (int k = 0; k < count; k++) {
    double next = strut_program_next_kink(&program, NULL, NULL, t, 100.0);
    if (!(fabs(next - times[k]) <= 1e-14 * (1.0 + times[k])))
      fail_msg("kink %d at %.17g, expected %.17g", k, next, times[k]);
    t = next + 1e-12;
  }
  assert_true(isinf(strut_program_next_kink(&program, NULL, NULL, t, 100.0)));
}

/* A program in postfix order: numbers, t, and operations by their words, as in "t 1 - abs". */
static strut_program postfix(const char *text, strut_instruction *p) {
  static const struct {
    const char *word;
    strut_operation id;
  } words[] = {{"+", STRUT_OPERATION_ADD},      {"-", STRUT_OPERATION_SUBTRACT},
               {"*", STRUT_OPERATION_MULTIPLY}, {"/", STRUT_OPERATION_DIVIDE},
               {"^", STRUT_OPERATION_POWER},    {"neg", STRUT_OPERATION_NEGATE},
               {"abs", STRUT_OPERATION_ABS},    {"max", STRUT_OPERATION_MAX},
               {"sin", STRUT_OPERATION_SIN},    {"exp", STRUT_OPERATION_EXP}};
  size_t count = 0, most = sizeof words / sizeof *words;
  for (size_t length; *text; text += length + (text[length] == ' '), count++) {
    size_t k = 0;
    length = strcspn(text, " ");
    while (k < most && (strlen(words[k].word) != length || strncmp(text, words[k].word, length)))
      k++;
    p[count] = k < most ? operation(words[k].id) : *text == 't' ? TIME : number(strtod(text, NULL));
  }
  return (strut_program){.length = count, .depth = MOST, .instruction = p};
}

TEST(kinks_of_a_triangle) { /* max(0, 1 - abs(t - 0.53) / 1e-5) */
  strut_instruction p[MOST];
  check_kinks(postfix("0 1 t 0.53 - abs 1e-5 / - max", p), (const double[]){0.52999, 0.53, 0.53001},
              3);
}

TEST(kinks_of_a_sine_that_is_cut_off) { /* max(sin(t) + 0.01 t, 1.9) */
  strut_instruction p[MOST];
  strut_program program = postfix("t sin 0.01 t * + 1.9 max", p);
  double t = 0.0, before = 0.0;
  int count = 0;
  while ((t = strut_program_next_kink(&program, NULL, NULL, t, 100.0)) < HUGE_VAL) {
    double apart = sin(t) + 0.01 * t - 1.9;
    assert_true(fabs(apart) < 1e-13 && t > before);
    before = t, t += 1e-12, count++;
  }
  assert_int_equal(count, 2); /* at 95.5 s and 96.2 s */
}

TEST(a_place_that_is_touched_is_passed) { /* abs(t^2 - 2 t + 1) */
  strut_instruction p[MOST];
  strut_program program = postfix("t 2 ^ 2 t * - 1 + abs", p);
  int count = 0;
  for (double t = 0.0; t < 100.0 && count < 1000; count++)
    t = strut_program_next_kink(&program, NULL, NULL, t, 100.0);
  assert_true(count < 1000);
}

TEST(steps_end_before_a_pulse_and_grow_with_what_is_smooth) { /* exp(-((t - 1) / 1e-4)^2); sin(t) */
  strut_instruction p[MOST];
  strut_program pulse = postfix("t 1 - 1e-4 / 2 ^ neg exp", p);
  int steps = 0, within_pulse = 0;
  for (double t = 0.0; t < 2.0; steps++) {
    double h = strut_program_longest_step(&pulse, NULL, NULL, t, 0.5, 1e-6, 1e-9);
    assert_true(h > 0.0);
    if (t + h > 1.0 - 1e-4 && t < 1.0 + 1e-4) within_pulse++;
    t += h;
  }
  assert_true(within_pulse >= 2 && steps < 100);
  strut_instruction s[MOST];
  strut_program sine = postfix("t sin", s);
  for (double t = 0.0; t < 10.0; t += 0.1)
    assert_true(strut_program_longest_step(&sine, NULL, NULL, t, 1.0, 1e-6, 1e-9) > 0.4);
}
