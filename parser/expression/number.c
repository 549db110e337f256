/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/expression/number.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "parser/expression/expression.h"

enum { EXPONENT_MOST = 99999, FAST_POWER = 22 };

/* A literal taken apart: mantissa * 10^exponent, where the mantissa fits 64 bits. */
typedef struct literal {
  size_t mantissa_length; /* bytes before the 'e' */
  uint64_t mantissa;      /* its digits as one integer */
  bool exact;             /* mantissa holds all digits */
  bool zero;
  long fraction; /* digits behind the point */
  long exponent; /* the written one, cut to +-EXPONENT_MOST */
} literal;

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

static size_t read_digits(const char *text, size_t at, size_t left, literal *parts) {
  for (; at < left && is_digit(text[at]); at++) {
    unsigned digit = (unsigned)(text[at] - '0');
    if (digit) parts->zero = false;
    if (parts->mantissa > (UINT64_MAX - 9) / 10) parts->exact = false;
    if (parts->exact) parts->mantissa = parts->mantissa * 10 + digit;
  }
  return at;
}

/* Bytes of the exponent that begins at text[at]: 0 where no complete one does. */
static size_t read_exponent(const char *text, size_t at, size_t left, literal *parts) {
  size_t begin = at;
  if (at >= left || (text[at] != 'e' && text[at] != 'E')) return 0;
  at++;
  bool negative = at < left && text[at] == '-';
  if (at < left && (text[at] == '-' || text[at] == '+')) at++;
  if (at >= left || !is_digit(text[at])) return 0;
  long exponent = 0;
  for (; at < left && is_digit(text[at]); at++) {
    exponent = exponent * 10 + (text[at] - '0');
    if (exponent > EXPONENT_MOST) exponent = EXPONENT_MOST;
  }
  parts->exponent = negative ? -exponent : exponent;
  return at - begin;
}

static size_t take_apart(const char *text, size_t left, literal *parts) {
  *parts = (literal){.exact = true, .zero = true};
  size_t whole = read_digits(text, 0, left, parts), at = whole;
  if (at + 1 < left && text[at] == '.' && is_digit(text[at + 1])) {
    size_t end = read_digits(text, at + 1, left, parts);
    parts->fraction = (long)(end - at - 1);
    at = end;
  }
  if (!at) return 0;
  parts->mantissa_length = at;
  return at + read_exponent(text, at, left, parts);
}

size_t strut_number_scan(const char *text, size_t left) {
  literal parts;
  return take_apart(text, left, &parts);
}

/* Up to 2^53 and 10^22 both factors are exact doubles, so one operation rounds once. */
static bool read_fast(const literal *parts, long exponent, double *value) {
  static const double power[FAST_POWER + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                               1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                               1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  if (FLT_EVAL_METHOD != 0 || !parts->exact || parts->mantissa > UINT64_C(1) << 53) return false;
  if (exponent < -FAST_POWER || exponent > FAST_POWER) return false;
  double mantissa = (double)parts->mantissa;
  *value = exponent < 0 ? mantissa / power[-exponent] : mantissa * power[exponent];
  return true;
}

static bool read_slow(const char *text, const literal *parts, long exponent, double *value) {
  char buffer[STRUT_NUMBER_MOST + 32], *end;
  memcpy(buffer, text, parts->mantissa_length);
  int tail = 0;
  buffer[parts->mantissa_length] = '\0';
  if (exponent) tail = snprintf(buffer + parts->mantissa_length, 32, "e%ld", exponent);
  strut_c_locale locale = strut_c_locale_enter();
  *value = strtod(buffer, &end);
  strut_c_locale_leave(locale);
  /* Under a foreign locale (memory was out) strtod stops at the point: refuse, never guess. */
  return tail >= 0 && end == buffer + parts->mantissa_length + tail;
}

bool strut_number_read_scaled(const char *text, size_t length, int decimal, double *value) {
  literal parts;
  if (!length || length > STRUT_NUMBER_MOST || take_apart(text, length, &parts) != length)
    return false;
  *value = 0;
  if (parts.zero) return true;
  long exponent = parts.exponent + decimal;
  if (read_fast(&parts, exponent - parts.fraction, value)) return true;
  return read_slow(text, &parts, exponent, value) && isfinite(*value) && *value != 0;
}

bool strut_number_read(const char *text, size_t length, double *value) {
  return strut_number_read_scaled(text, length, 0, value);
}
