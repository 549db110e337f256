/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Tests, assertions about numbers that say the numbers, and memory that is refused.
 */
#pragma once

#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "tests/support/test.h"

/** As FREED, by strut_release. */
#define RELEASED __attribute__((cleanup(own_release)))
static inline void own_release(void *pointer) { strut_release(*(void **)pointer); }

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

/** The same of pairs: actual, expected, actual, expected, ... */
#define assert_all_near(tolerance, ...)                                                            \
  check_pairs(check_near, PAIRS(double, __VA_ARGS__), (tolerance), __FILE__, __LINE__)
#define assert_all_relative(tolerance, ...)                                                        \
  check_pairs(check_relative, PAIRS(double, __VA_ARGS__), (tolerance), __FILE__, __LINE__)
/** The call returns that status, and the strut_error that it fills has these words. */
#define assert_fails(call, expected, error, ...)                                                   \
  (assert_int_equal((call), (expected)),                                                           \
   check_words((error).message, (const char *[]){__VA_ARGS__, NULL}, __FILE__, __LINE__))

void check_near(double actual, double expected, double tolerance, const char *what,
                const char *file, int line);
void check_relative(double actual, double expected, double tolerance, const char *what,
                    const char *file, int line);
void check_within(double actual, double low, double high, const char *what, const char *file,
                  int line);
void check_same_bits(double actual, double expected, const char *what, const char *file, int line);

typedef void check_of_numbers(double actual, double expected, double tolerance, const char *what,
                              const char *file, int line);
void check_pairs(check_of_numbers *check, const double *pairs, size_t count, const char *what,
                 double tolerance, const char *file, int line);

void check_words(const char *text, const char *const *words, const char *file, int line);

/** Least-squares slope of log2(error) over halvings of the step: the observed order. */
double observed_order(const double *error, size_t count);

/**
 * The status of a call when the allocation after n good ones fails, STRUT_OK or STRUT_NO_MEMORY; anything
 * else fails the test.
 */
#define refused(n, call) (strut_fail_allocation_after(n), granted_again(call))

/**
 * A block whose n-th allocation is refused, for n = 0, 1, ... until none is; in it `status` becomes what
 * refused() gives. More than `least` of them must be refused.
 *
 *     REFUSE_EACH(n, status, 5) status = refused(n, strut_merge(path, &merged, NULL));
 */
#define REFUSE_EACH(n, status, least)                                                              \
  for (int64_t n = 0, status = STRUT_NO_MEMORY; refuse_another(status, n, least); n++)

static inline strut_status granted_again(strut_status status) {
  strut_fail_allocation_after(-1);
  if (status != STRUT_OK) assert_int_equal(status, STRUT_NO_MEMORY);
  return status;
}

static inline bool refuse_another(int64_t status, int64_t n, int64_t least) {
  assert_true(n < 20000);
  if (status == STRUT_NO_MEMORY) return true;
  assert_ok(status);
  assert_true(n > least);
  return false;
}
