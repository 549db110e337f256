/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/check.h"

static void fail_at(const char *file, int line, const char *what, double actual,
                    const char *expected, double a, double b) {
  print_error("%s is %.17g, expected %s %.17g, %.3g\n", what, actual, expected, a, b);
  _fail(file, line);
}

void check_near(double actual, double expected, double tolerance, const char *what,
                const char *file, int line) {
  if (fabs(actual - expected) <= tolerance) return;
  fail_at(file, line, what, actual, "(value, tolerance)", expected, tolerance);
}

void check_relative(double actual, double expected, double tolerance, const char *what,
                    const char *file, int line) {
  if (fabs(actual - expected) <= tolerance * fabs(expected)) return;
  fail_at(file, line, what, actual, "(value, relative tolerance)", expected, tolerance);
}

void check_within(double actual, double low, double high, const char *what, const char *file,
                  int line) {
  if (actual >= low && actual <= high) return;
  fail_at(file, line, what, actual, "(between)", low, high);
}

void check_same_bits(double actual, double expected, const char *what, const char *file, int line) {
  if (!memcmp(&actual, &expected, sizeof actual)) return;
  fail_at(file, line, what, actual, "(the same bits, difference)", expected, actual - expected);
}

void check_pairs(check_of_numbers *check, const double *pairs, size_t count, const char *what,
                 double tolerance, const char *file, int line) {
  for (size_t i = 0; i + 1 < count; i += 2)
    check(pairs[i], pairs[i + 1], tolerance, what, file, line);
}

void check_equal_pairs(const long double *pairs, size_t count, const char *what, const char *file,
                       int line) {
  for (size_t i = 0; i + 1 < count; i += 2) {
    if (pairs[i] == pairs[i + 1]) continue;
    print_error("pair %zu of '%s': %Lg, expected %Lg\n", i / 2 + 1, what, pairs[i], pairs[i + 1]);
    _fail(file, line);
  }
}

void check_text_pairs(const char *const *pairs, size_t count, const char *what, const char *file,
                      int line) {
  for (size_t i = 0; i + 1 < count; i += 2) {
    if (pairs[i] && pairs[i + 1] && !strcmp(pairs[i], pairs[i + 1])) continue;
    print_error("pair %zu of '%s': '%s', expected '%s'\n", i / 2 + 1, what, pairs[i], pairs[i + 1]);
    _fail(file, line);
  }
}

void check_all(const bool *conditions, size_t count, const char *what, const char *file, int line) {
  for (size_t i = 0; i < count; i++) {
    if (conditions[i]) continue;
    print_error("condition %zu of '%s' does not hold\n", i + 1, what);
    _fail(file, line);
  }
}

void check_words(const char *text, const char *const *words, const char *file, int line) {
  for (; *words; words++) {
    if (strstr(text, *words)) continue;
    print_error("'%s' lacks '%s'\n", text, *words);
    _fail(file, line);
  }
}

double observed_order(const double *error, size_t count) {
  double mean_k = 0.5 * (double)(count - 1), mean = 0.0, up = 0.0, down = 0.0;
  for (size_t k = 0; k < count; k++) mean += log2(error[k]) / (double)count;
  for (size_t k = 0; k < count; k++) {
    double d = (double)k - mean_k;
    up -= d * (log2(error[k]) - mean);
    down += d * d;
  }
  return up / down;
}
