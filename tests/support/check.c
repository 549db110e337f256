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
