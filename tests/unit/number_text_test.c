/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shortest text of a double: against the C library, over random bits and all hard corners. */
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/number_powers.h"
#include "engine/base/number_text.h"
#include "tests/support/test.h"

static uint64_t state = UINT64_C(0x9e3779b97f4a7c15);

static uint64_t next_random(void) { /* xorshift64* */
  state ^= state >> 12;
  state ^= state << 25;
  state ^= state >> 27;
  return state * UINT64_C(2685821657736338717);
}

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
    if (to_bits(strtod(shorter, NULL)) == to_bits(value)) {
      fail_msg("%.17g: '%s' is longer than '%s'", value, text, shorter);
    }
  }
  snprintf(shorter, sizeof shorter, "%.*e", digits ? digits - 1 : 0, value);
  double nearest = strtod(shorter, NULL);
  if (to_bits(nearest) == to_bits(value)) { /* then it is the nearest of that length, as ours is */
    if (strtold(shorter, NULL) != strtold(text, NULL)) {
      fail_msg("%.17g: '%s' is not the nearest, '%s' is", value, text, shorter);
    }
  }
}

TEST(random_bits) {
  for (int i = 0; i < 300000; i++) {
    double value = from_bits(next_random());
    if (isfinite(value)) assert_shortest(value);
  }
}

TEST(numbers_of_everyday_size) {
  for (int i = 0; i < 200000; i++) {
    double unit = (double)(next_random() >> 11) / 9007199254740992.0;
    assert_shortest((unit - 0.5) * pow(10.0, (double)(next_random() % 24) - 12.0));
    assert_shortest((double)(next_random() % 1000000) / 1000.0);
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

TEST(how_numbers_look) {
  static const struct {
    double value;
    const char *text;
  } expected[] = {
      {0.0, "0"},
      {-0.0, "-0"},
      {1.0, "1"},
      {-1.5, "-1.5"},
      {0.1, "0.1"},
      {0.1 + 0.2, "0.30000000000000004"},
      {100.0, "100"},
      {0.0001, "0.0001"},
      {1e-4 / 3.0, "3.3333333333333335e-5"},
      {1e-5, "1e-5"},
      {1e-6, "1e-6"},
      {123456.789, "123456.789"},
      {9007199254740992.0, "9007199254740992"},
      {1e16, "10000000000000000"},
      {1e17, "1e17"},
      {1.2345e20, "1.2345e20"},
      {6.02214076e23, "6.02214076e23"},
      {5e-324, "5e-324"},
      {DBL_MIN, "2.2250738585072014e-308"},
      {DBL_MAX, "1.7976931348623157e308"},
      {9.5e-8, "9.5e-8"},
      {(double)INFINITY, "inf"},
      {(double)-INFINITY, "-inf"},
      {(double)NAN, "nan"},
  };
  for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
    char text[STRUT_NUMBER_TEXT];
    strut_number_text(expected[i].value, text);
    assert_string_equal(text, expected[i].text);
  }
}

/* A 1152-bit integer, enough for 10^324: the table's rows are recomputed digit by digit. */
enum { WORDS = 36 };

static void multiply_by_ten(uint32_t big[WORDS]) {
  uint64_t carry = 0;
  for (int i = 0; i < WORDS; i++) {
    carry += (uint64_t)big[i] * 10;
    big[i] = (uint32_t)carry;
    carry >>= 32;
  }
}

static int top_bit(const uint32_t big[WORDS]) {
  for (int bit = WORDS * 32 - 1; bit >= 0; bit--) {
    if (big[bit / 32] >> (bit % 32) & 1) return bit;
  }
  return -1;
}

static uint64_t bits_below(const uint32_t big[WORDS], int top) { /* bits top .. top - 63 */
  uint64_t value = 0;
  for (int bit = top; bit > top - 64; bit--) {
    value = value << 1 | (bit >= 0 ? big[bit / 32] >> (bit % 32) & 1 : 0);
  }
  return value;
}

TEST(positive_powers_of_the_table) {
  uint32_t big[WORDS] = {1};
  for (int k = 0; k <= STRUT_NUMBER_POWER_LAST; k++, multiply_by_ten(big)) {
    int top = top_bit(big);
    uint64_t high = bits_below(big, top), low = bits_below(big, top - 64);
    bool cut = false;
    for (int bit = top - 128; bit >= 0; bit--) cut = cut || (big[bit / 32] >> (bit % 32) & 1);
    if (cut && ++low == 0) high++;
    const uint64_t *row = strut_number_powers[k - STRUT_NUMBER_POWER_FIRST];
    assert_true(row[0] == high && row[1] == low);
  }
}

/* 10^-k times 10^k is one: the product of the rows, just above a power of two. */
TEST(negative_powers_of_the_table) {
  for (int k = 1; k <= -STRUT_NUMBER_POWER_FIRST; k++) {
    const uint64_t *row = strut_number_powers[-k - STRUT_NUMBER_POWER_FIRST];
    uint32_t big[WORDS] = {1}, product[WORDS + 4] = {0};
    uint32_t g[4] = {(uint32_t)row[1], (uint32_t)(row[1] >> 32), (uint32_t)row[0],
                     (uint32_t)(row[0] >> 32)};
    for (int i = 0; i < k; i++) multiply_by_ten(big);
    for (int i = 0; i < 4; i++) { /* product = row * 10^k, exactly */
      uint64_t carry = 0;
      for (int j = 0; j < WORDS; j++) {
        carry += product[i + j] + (uint64_t)g[i] * big[j];
        product[i + j] = (uint32_t)carry;
        carry >>= 32;
      }
      product[i + WORDS] = (uint32_t)carry;
    }
    int top = top_bit(product); /* rounded up: 2^top < product < 2^top + 10^k */
    product[top / 32] &= ~(UINT32_C(1) << (top % 32));
    int rest = top_bit(product), power = top_bit(big);
    assert_true(row[0] >> 63 == 1);
    assert_true(rest >= 0 && rest <= power);
    if (rest == power) {
      for (int i = WORDS - 1; i >= 0; i--) {
        if (product[i] == big[i]) continue;
        assert_true(product[i] < big[i]);
        break;
      }
    }
  }
}
