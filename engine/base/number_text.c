/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/number_text.h"

#include <locale.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_powers.h"

strut_c_locale strut_c_locale_enter(void) {
  locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  strut_c_locale result = {(void *)c, NULL};
  if (c) result.previous = (void *)uselocale(c);
  return result;
}

void strut_c_locale_leave(strut_c_locale locale) {
  if (!locale.c) return;
  uselocale((locale_t)locale.previous);
  freelocale((locale_t)locale.c);
}

/*
 * The method is Raffaello Giulietti's Schubfach ("The Schubfach way to render doubles", 2020): one
 * table of powers of ten to 128 bits, one product, no loop over digits to decide, no fallback.
 * A value is c * 2^q; everything below is scaled by 4 so that the ends of the interval that rounds
 * to it are integers.
 */

/* digits * 10^exponent */
typedef struct decimal {
  uint64_t digits;
  int exponent;
} decimal;

/* Floor of log10(2^e), of log10(3/4 2^e) and of log2(10^e), for any exponent of a double. */
static int floor_shift(int value, int bits) {
  return value >= 0 ? value >> bits : -((-value + (1 << bits) - 1) >> bits);
}
static int log10_of_power_2(int e) { return floor_shift(e * 1262611, 22); }
static int log10_of_three_quarters_power_2(int e) { return floor_shift(e * 1262611 - 524031, 22); }
static int log2_of_power_10(int e) { return floor_shift(e * 1741647, 19); }

static uint64_t multiply(uint64_t a, uint64_t b, uint64_t *low) {
  uint64_t a0 = a & 0xffffffff, a1 = a >> 32, b0 = b & 0xffffffff, b1 = b >> 32;
  uint64_t p00 = a0 * b0, p01 = a0 * b1, p10 = a1 * b0;
  uint64_t middle = (p00 >> 32) + (p01 & 0xffffffff) + p10;
  *low = (middle << 32) | (p00 & 0xffffffff);
  return a1 * b1 + (p01 >> 32) + (middle >> 32);
}

/* A number of 192 bits, the highest word first. */
typedef struct wide {
  uint64_t high, middle, low;
} wide;

static wide product_of(const uint64_t power[2], uint64_t c) {
  wide p;
  uint64_t carry = multiply(power[1], c, &p.low);
  p.high = multiply(power[0], c, &p.middle);
  p.middle += carry;
  p.high += p.middle < carry;
  return p;
}

/* power * 2^shift, 0 <= shift < 64. */
static wide shifted(const uint64_t power[2], int shift) {
  return (wide){power[0] >> 1 >> (63 - shift), power[0] << shift | power[1] >> 1 >> (63 - shift),
                power[1] << shift};
}

static wide sum_of(wide a, wide b) {
  wide s = {a.high + b.high, a.middle + b.middle, a.low + b.low};
  uint64_t carry = s.low < a.low;
  s.high += s.middle < a.middle;
  s.middle += carry;
  s.high += s.middle < carry;
  return s;
}

static wide difference_of(wide a, wide b) {
  wide d = {a.high - b.high, a.middle - b.middle, a.low - b.low};
  uint64_t borrow = a.low < b.low;
  d.high -= a.middle < b.middle;
  d.high -= d.middle < borrow;
  d.middle -= borrow;
  return d;
}

/* floor(w / 2^128), its last bit set where anything was cut off. */
static uint64_t top_of(wide w) { return w.high | (w.middle > 1); }

/* Whichever of s and s + 1 lies inside [lower, upper]; if both do, the nearer to `quadruple` / 4. */
static uint64_t nearest(uint64_t s, uint64_t lower, uint64_t upper, uint64_t quadruple) {
  bool down = lower <= 4 * s, up = 4 * s + 4 <= upper;
  if (down != up) return s + up;
  uint64_t middle = 4 * s + 2;
  return s + (quadruple > middle || (quadruple == middle && (s & 1)));
}

static decimal shortest(uint64_t fraction, int biased) {
  uint64_t c = biased ? fraction | (UINT64_C(1) << 52) : fraction;
  int q = (biased ? biased : 1) - 1075;
  if (q <= 0 && q > -53 && (c & ((UINT64_C(1) << -q) - 1)) == 0) return (decimal){c >> -q, 0};

  bool uneven = fraction == 0 && biased > 1; /* the neighbour below is nearer */
  unsigned odd = c & 1;                      /* the interval's ends round away from it */
  int k = uneven ? log10_of_three_quarters_power_2(q) : log10_of_power_2(q);
  int h = q + log2_of_power_10(-k) + 1;
  const uint64_t *power = strut_number_powers[-k - STRUT_NUMBER_POWER_FIRST];
  wide value = product_of(power, 4 * c << h); /* what follows lies half a unit of c around it */
  uint64_t lower = top_of(difference_of(value, shifted(power, h + 1 - uneven))) + odd;
  uint64_t middle = top_of(value);
  uint64_t upper = top_of(sum_of(value, shifted(power, h + 1))) - odd;

  uint64_t s = middle / 4;
  if (s >= 10) { /* is there a multiple of ten inside? */
    uint64_t tens = s / 10;
    bool down = lower <= 40 * tens, up = 40 * tens + 40 <= upper;
    if (down != up) return (decimal){tens + up, k + 1};
  }
  return (decimal){nearest(s, lower, upper, middle), k};
}

static const char PAIRS[] =
    "0001020304050607080910111213141516171819"
    "2021222324252627282930313233343536373839"
    "4041424344454647484950515253545556575859"
    "6061626364656667686970717273747576777879"
    "8081828384858687888990919293949596979899";

static char *write_pair_before(char *at, uint32_t pair) {
  at -= 2;
  memcpy(at, PAIRS + 2 * pair, 2);
  return at;
}

/* Writes the digits of a positive integer below 10^17 so that they end at `end`, and makes *d one
 * without trailing zeros. Returns the first digit and their number. */
static const char *write_digits(decimal *d, char *end, int *count) {
  char *at = end;
  uint64_t rest = d->digits;
  if (rest >> 32) {
    uint32_t low = (uint32_t)(rest % 100000000);
    rest /= 100000000;
    if (low == 0)
      d->exponent += 8; /* of a short number most digits are zeros */
    else
      for (int i = 0; i < 4; i++, low /= 100) at = write_pair_before(at, low % 100);
  }
  uint32_t high = (uint32_t)rest;
  for (; high >= 100; high /= 100) at = write_pair_before(at, high % 100);
  if (high >= 10)
    at = write_pair_before(at, high);
  else if (high > 0)
    *--at = (char)('0' + high);
  for (; end[-1] == '0'; end--) d->exponent++;
  *count = (int)(end - at);
  return at;
}

static char *write_zeros(char *at, int count) {
  for (int i = 0; i < count; i++) *at++ = '0';
  return at;
}

static char *write_exponent(char *at, int exponent) {
  *at++ = 'e';
  if (exponent < 0) {
    *at++ = '-';
    exponent = -exponent;
  }
  if (exponent >= 100) *at++ = (char)('0' + exponent / 100);
  if (exponent >= 10) *at++ = (char)('0' + exponent / 10 % 10);
  *at++ = (char)('0' + exponent % 10);
  return at;
}

/* Digits with a point after the first `point` of them; point may lie outside. */
static char *write_decimal(char *at, decimal d) {
  char room[20];
  int count;
  const char *digits = write_digits(&d, room + sizeof room, &count);
  int point = count + d.exponent;
  bool scientific = point < -3 || point > 17;
  int before = scientific ? 1 : point;
  if (before <= 0) {
    *at++ = '0';
    *at++ = '.';
    at = write_zeros(at, -before);
  }
  int whole = before <= 0 || before > count ? count : before;
  memcpy(at, digits, (size_t)whole);
  at += whole;
  if (whole < count) {
    *at++ = '.';
    memcpy(at, digits + whole, (size_t)(count - whole));
    at += count - whole;
  }
  at = write_zeros(at, before - count);
  return scientific ? write_exponent(at, point - 1) : at;
}

size_t strut_number_text(double value, char text[STRUT_NUMBER_TEXT]) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  uint64_t fraction = bits & ((UINT64_C(1) << 52) - 1);
  int biased = (int)(bits >> 52 & 0x7ff);
  char *at = text;
  if (isnan(value)) {
    memcpy(text, "nan", 4);
    return 3;
  }
  if (bits >> 63) *at++ = '-';
  if (isinf(value)) {
    memcpy(at, "inf", 3);
    at += 3;
  } else if (fraction == 0 && biased == 0) {
    *at++ = '0';
  } else {
    at = write_decimal(at, shortest(fraction, biased));
  }
  *at = '\0';
  return (size_t)(at - text);
}

void strut_duration_text(double seconds, char text[STRUT_DURATION_TEXT]) {
  const size_t size = STRUT_DURATION_TEXT;
  double whole = ceil(seconds);
  if (!(whole < 1e7)) {
    snprintf(text, size, "?");
  } else if (whole < 60) {
    snprintf(text, size, "%.0f s", whole);
  } else if (whole < 3600) {
    snprintf(text, size, "%d min %02d s", (int)whole / 60, (int)whole % 60);
  } else {
    snprintf(text, size, "%d h %02d min", (int)whole / 3600, (int)whole / 60 % 60);
  }
}
