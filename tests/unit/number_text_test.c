/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shortest text of a double: against the C library, over random bits and all hard corners. */
#include <stdbool.h>

#include "engine/base/text.h"
#include "tests/support/random.h"
#include "tests/support/test.h"

static uint64_t seed = 1;

static double from_bits(uint64_t bits) {
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static uint64_t to_bits(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

static int significant_digits(const char *text) {
  int count = 0, zeros = 0;
  for (; *text && *text != 'e'; text++) {
    if (*text < '0' || *text > '9') continue;
    if (*text != '0') {
      count += zeros + 1;
      zeros = 0;
    } else if (count) {
      zeros++;
    }
  }
  return count;
}

/* Reads back, cannot be shorter, and is the nearest of its length: the C library's decides. */
static void assert_shortest(double value) {
  char text[STRUT_NUMBER_TEXT], shorter[64];
  size_t length = strut_number_text(value, text);
  assert_int_equal(length, strlen(text));
  assert_true(length < STRUT_NUMBER_TEXT);
  assert_true(to_bits(strtod(text, NULL)) == to_bits(value));
  int digits = significant_digits(text);
  if (digits > 1) { /* fewer digits, correctly rounded, are not enough */
    snprintf(shorter, sizeof shorter, "%.*e", digits - 2, value);
    if (to_bits(strtod(shorter, NULL)) == to_bits(value))
      fail_msg("%.17g: '%s' is longer than '%s'", value, text, shorter);
  }
  snprintf(shorter, sizeof shorter, "%.*e", digits ? digits - 1 : 0, value);
  double nearest = strtod(shorter, NULL);
  if (to_bits(nearest) == to_bits(value)) { /* then it is the nearest of that length, as ours is */
    if (strtold(shorter, NULL) != strtold(text, NULL))
      fail_msg("%.17g: '%s' is not the nearest, '%s' is", value, text, shorter);
  }
}

TEST(random_bits) {
  for (int i = 0; i < 300000; i++) {
    double value = from_bits(random_bits(&seed));
    if (isfinite(value)) assert_shortest(value);
  }
}

TEST(numbers_of_everyday_size) {
  for (int i = 0; i < 200000; i++) {
    double unit = random_between(&seed, -0.5, 0.5);
    assert_shortest(unit * pow(10.0, random_below(&seed, 24) - 12));
    assert_shortest((double)(random_bits(&seed) % 1000000) / 1000.0);
  }
}

TEST(powers_and_their_neighbours) {
  for (int e = -1074; e <= 1023; e++) {
    double power = ldexp(1.0, e);
    assert_shortest(power);
    assert_shortest(nextafter(power, 0.0));
    if (e < 1023) assert_shortest(nextafter(power, (double)INFINITY));
  }
  for (int e = -323; e <= 308; e++) {
    char text[16];
    snprintf(text, sizeof text, "1e%d", e);
    double power = strtod(text, NULL);
    assert_shortest(power);
    assert_shortest(nextafter(power, 0.0));
    assert_shortest(nextafter(power, (double)INFINITY));
  }
}

/* The C library's strtod reads the number that each text is of. */
TEST(how_numbers_look) {
  static const char *const expected[] = {"0",
                                         "-0",
                                         "1",
                                         "-1.5",
                                         "0.1",
                                         "0.30000000000000004",
                                         "100",
                                         "0.0001",
                                         "1e-5",
                                         "1e-6",
                                         "3.3333333333333335e-5",
                                         "123456.789",
                                         "9007199254740992",
                                         "10000000000000000",
                                         "1e17",
                                         "1.2345e20",
                                         "6.02214076e23",
                                         "5e-324",
                                         "2.2250738585072014e-308",
                                         "9.5e-8",
                                         "1.7976931348623157e308",
                                         "inf",
                                         "-inf",
                                         "nan"};
  for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
    char text[STRUT_NUMBER_TEXT];
    strut_number_text(strtod(expected[i], NULL), text);
    assert_string_equal(text, expected[i]);
  }
}
