/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Number literals, correctly rounded in any locale, and the units behind them. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "parser/language/expression/expression_parts.h"

enum { EXPONENT_MOST = 99999 };

/* A literal taken apart: mantissa * 10^exponent. */
typedef struct literal {
  size_t mantissa_length; /* bytes before the 'e' */
  bool zero;
  long exponent; /* the written one, cut to +-EXPONENT_MOST */
} literal;

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

static size_t read_digits(const char *text, size_t at, size_t left, literal *parts) {
  for (; at < left && is_digit(text[at]); at++) {
    if (text[at] != '0') parts->zero = false;
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
  *parts = (literal){.zero = true};
  size_t whole = read_digits(text, 0, left, parts), at = whole;
  if (at + 1 < left && text[at] == '.' && is_digit(text[at + 1])) {
    at = read_digits(text, at + 1, left, parts);
  }
  if (!at) return 0;
  parts->mantissa_length = at;
  return at + read_exponent(text, at, left, parts);
}

size_t strut_number_scan(const char *text, size_t left) {
  literal parts;
  return take_apart(text, left, &parts);
}

static bool read_value(const char *text, const literal *parts, long exponent, double *value) {
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
  return read_value(text, &parts, parts.exponent + decimal, value) && isfinite(*value) &&
         *value != 0;
}

enum { UNIT_POWER_MOST = 12 };

/* The unit so far: up / down * 10^decimal. */
typedef struct unit_product {
  int decimal;
  double up, down;
  strut_dimension dimension;
  bool bare; /* nothing but percent */
} unit_product;

static void multiply(unit_product *product, const strut_unit *unit, int power) {
  float times = (float)power;
  product->decimal += unit->decimal * power;
  for (int i = 0; i < power; i++) product->up *= unit->rest;
  for (int i = 0; i > power; i--) product->down *= unit->rest;
  product->dimension.kg += times * unit->dimension.kg;
  product->dimension.m += times * unit->dimension.m;
  product->dimension.s += times * unit->dimension.s;
  product->dimension.angle += times * unit->dimension.angle;
  if (!strut_dimension_equal(unit->dimension, STRUT_DIM_NONE)) product->bare = false;
}

/* An optional ^ and whole number behind a unit. */
static bool read_power(strut_expression_reader *r, int *power) {
  *power = 1;
  size_t resume = r->at;
  if (strut_expression_peek(r) != '^') {
    r->at = resume;
    return true;
  }
  r->at++;
  char c = strut_expression_peek(r);
  size_t begin = r->at;
  if (c == '-' || c == '+') r->at++;
  size_t digits = r->at;
  int value = 0;
  for (; r->at < r->length && r->text[r->at] >= '0' && r->text[r->at] <= '9'; r->at++)
    if (value <= UNIT_POWER_MOST) value = value * 10 + (r->text[r->at] - '0');
  size_t end = r->at;
  if (end < r->length && (r->text[end] == '.' || strut_expression_word(r, end))) end++;
  if (r->at == digits || end != r->at || value > UNIT_POWER_MOST)
    return strut_expression_fail(r, begin, end, "the power of a unit is a whole number such as 2");
  *power = c == '-' ? -value : value;
  return true;
}

static const strut_unit *unit_here(const strut_expression_reader *r, size_t *length) {
  *length = strut_expression_word(r, r->at);
  if (!*length && r->at < r->length && r->text[r->at] == '%') *length = 1;
  return *length ? strut_unit_find(r->text + r->at, *length) : NULL;
}

/* True where the word of that length at `at` is a function with its parenthesis: min( is no unit. */
static bool is_call(const strut_expression_reader *r, size_t length) {
  strut_expression_reader ahead = *r;
  ahead.at += length;
  return strut_expression_peek(&ahead) == '(';
}

/*
 * Whether one more unit follows: 1 or -1 with r at its word (behind * or /), 0 with r unmoved. A
 * word that a parameter has too is refused: both readings would be sensible. 2: refused.
 */
static int read_joint(strut_expression_reader *r, size_t *length) {
  size_t resume = r->at;
  char c = strut_expression_peek(r);
  bool operation = c == '*' || c == '/';
  if (operation) {
    r->at++;
    strut_expression_peek(r);
  }
  const strut_unit *unit = strut_expression_word(r, r->at) ? unit_here(r, length) : NULL;
  if (!unit || is_call(r, *length)) {
    r->at = resume;
    return 0;
  }
  strut_quantity ignored;
  bool asks = operation && r->compiler && r->compiler->claims;
  strut_piece word = {r->text + r->at, *length};
  int claimed = asks ? r->compiler->claims(r->compiler->context, word) : 0;
  if (claimed > 0) {
    r->at = resume;
    return 0;
  }
  if (claimed < 0) {
    strut_expression_fail(r, r->at, r->at + *length,
                          "'%.*s' is a unit and a sensor; rename the sensor, or write '%c (%.*s)' "
                          "for it",
                          (int)*length, r->text + r->at, c, (int)*length, r->text + r->at);
    return 2;
  }
  if (operation && strut_expression_lookup(r, r->text + r->at, *length, &ignored) != 0) {
    strut_expression_fail(r, r->at, r->at + *length,
                          "'%.*s' is a unit and a parameter; rename the parameter, or write "
                          "'%c (%.*s)' for it",
                          (int)*length, r->text + r->at, c, (int)*length, r->text + r->at);
    r->error->parameter = (strut_piece){r->text + r->at, *length};
    return 2;
  }
  return c == '/' ? -1 : 1;
}

static bool read_unit(strut_expression_reader *r, unit_product *product) {
  size_t length;
  const strut_unit *unit = unit_here(r, &length);
  if (!unit) return strut_expression_unknown_unit(r, r->at, length);
  for (int sign = 1;; unit = strut_unit_find(r->text + r->at, length)) {
    int power;
    r->at += length;
    if (!read_power(r, &power)) return false;
    multiply(product, unit, sign * power);
    sign = read_joint(r, &length);
    if (sign == 2) return false;
    if (sign == 0) return true;
  }
}

/* Reports characters right after a literal that make it look like another kind of number. */
static bool check_end(strut_expression_reader *r, size_t begin) {
  char c = r->at < r->length ? r->text[r->at] : '\0';
  size_t word = strut_expression_word(r, r->at), end = r->at + (word ? word : 1);
  if (c == '.')
    return strut_expression_fail(r, begin, end,
                                 "a number has one decimal point and digits after it");
  if (c == '_') return strut_expression_fail(r, begin, end, "digits cannot be grouped with '_'");
  if ((c == 'x' || c == 'X') && r->at == begin + 1 && r->text[begin] == '0')
    return strut_expression_fail(r, begin, end, "hexadecimal numbers are not allowed");
  if ((c == 'e' || c == 'E') && word == 1)
    return strut_expression_fail(r, begin, end, "the exponent of this number has no digits");
  return true;
}

bool strut_expression_literal(strut_expression_reader *r, strut_quantity *quantity) {
  size_t begin = r->at, scanned = strut_number_scan(r->text + begin, r->length - begin);
  if (!scanned) return strut_expression_unexpected(r, "a number");
  r->at += scanned;
  if (!check_end(r, begin)) return false;
  size_t end = r->at;
  unit_product product = {0, 1, 1, STRUT_DIM_NONE, true};
  char c = strut_expression_peek(r);
  if ((c == '%' || strut_expression_word(r, r->at)) && !read_unit(r, &product)) return false;
  if (!strut_number_read_scaled(r->text + begin, scanned, product.decimal, &quantity->value))
    return strut_expression_fail(r, begin, end, "this number is beyond the range of numbers");
  if (product.up != 1) quantity->value *= product.up;
  if (product.down != 1) quantity->value /= product.down;
  if (!isfinite(quantity->value))
    return strut_expression_fail(r, begin, r->at, "this number is beyond the range of numbers");
  quantity->dimension = product.dimension;
  quantity->bare = product.bare;
  quantity->varies = false;
  return true;
}
