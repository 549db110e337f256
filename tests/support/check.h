/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Tests, assertions about numbers that say the numbers, and memory that is refused.
 */
#ifndef STRUT_TESTS_SUPPORT_CHECK_H
#define STRUT_TESTS_SUPPORT_CHECK_H

#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "tests/support/test.h"

/** |actual - expected| <= tolerance; a NAN fails. */
#define assert_near(actual, expected, tolerance)                                                   \
  check_near((actual), (expected), (tolerance), #actual, __FILE__, __LINE__)
/** |actual - expected| <= tolerance * |expected|. */
#define assert_relative(actual, expected, tolerance)                                               \
  check_relative((actual), (expected), (tolerance), #actual, __FILE__, __LINE__)
/** low <= actual <= high. */
#define assert_within(actual, low, high)                                                           \
  check_within((actual), (low), (high), #actual, __FILE__, __LINE__)
/** The same bits, so that 0 and -0 differ and a NAN equals itself. */
#define assert_same_bits(actual, expected)                                                         \
  check_same_bits((actual), (expected), #actual, __FILE__, __LINE__)

/** The call returns that status, and the strut_error that it fills has these words. */
#define assert_fails(call, expected, error, words)                                                 \
  (assert_int_equal((call), (expected)), check_words((error).message, (words), __FILE__, __LINE__))

void check_near(double actual, double expected, double tolerance, const char *what,
                const char *file, int line);
void check_relative(double actual, double expected, double tolerance, const char *what,
                    const char *file, int line);
void check_within(double actual, double low, double high, const char *what, const char *file,
                  int line);
void check_same_bits(double actual, double expected, const char *what, const char *file, int line);

static inline void check_words(const char *text, const char *words, const char *file, int line) {
  if (strstr(text, words)) return;
  print_error("'%s' lacks '%s'\n", text, words);
  _fail(file, line);
}

/** Least-squares slope of log2(error) over halvings of the step: the observed order. */
double observed_order(const double *error, size_t count);

/**
 * The status of a call when the allocation after n good ones fails, STRUT_OK or STRUT_NO_MEMORY; anything
 * else fails the test.
 */
#define refused(n, call) (strut_fail_allocation_after(n), granted_again(call))

static inline strut_status granted_again(strut_status status) {
  strut_fail_allocation_after(-1);
  if (status != STRUT_OK) assert_int_equal(status, STRUT_NO_MEMORY);
  return status;
}

#endif
