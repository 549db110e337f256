/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/physics/slow_expression.h"

#include <ctype.h>

#include "tests/support/check.h"

enum { WORD = 32 };

typedef struct cursor {
  const char *at;
  slow_variable *variable;
  void *context;
} cursor;

static long double sum_at(cursor *c);

static void skip_spaces(cursor *c) {
  while (*c->at == ' ') c->at++;
}

static int takes(cursor *c, char sign) {
  skip_spaces(c);
  if (*c->at != sign) return 0;
  c->at++;
  return 1;
}

static void read_word(cursor *c, char *word) {
  size_t n = 0;
  skip_spaces(c);
  while (isalnum((unsigned char)*c->at) || *c->at == '_') {
    assert_true(n + 1 < WORD);
    word[n++] = *c->at++;
  }
  word[n] = '\0';
}

static long double call(const char *name, const long double *x, int count) {
  static const struct {
    const char *name;
    long double (*of)(long double);
  } one[] = {{"sin", sinl},   {"cos", cosl},     {"tan", tanl},   {"asin", asinl},
             {"acos", acosl}, {"atan", atanl},   {"exp", expl},   {"log", logl},
             {"sqrt", sqrtl}, {"log10", log10l}, {"tanh", tanhl}, {"abs", fabsl}};
  for (size_t i = 0; i < sizeof one / sizeof one[0] && count == 1; i++)
    if (!strcmp(name, one[i].name)) return one[i].of(x[0]);
  if (!strcmp(name, "min") && count == 2) return x[0] < x[1] ? x[0] : x[1];
  if (!strcmp(name, "max") && count == 2) return x[0] > x[1] ? x[0] : x[1];
  if (!strcmp(name, "hypot") && count == 2) return hypotl(x[0], x[1]);
  if (!strcmp(name, "atan2") && count == 2) return atan2l(x[0], x[1]);
  fail_msg("no function '%s' of %d numbers here", name, count);
  return 0;
}

static long double word_at(cursor *c) {
  char name[WORD], other[WORD];
  long double x[2];
  int count = 0;
  read_word(c, name);
  if (!takes(c, '(')) return strcmp(name, "pi") ? c->variable(c->context, name, 0) : acosl(-1);
  if (!strcmp(name, "rate")) {
    read_word(c, other);
    assert_true(takes(c, ')'));
    return c->variable(c->context, other, 1);
  }
  do {
    assert_true(count < 2);
    x[count++] = sum_at(c);
  } while (takes(c, ','));
  assert_true(takes(c, ')'));
  return call(name, x, count);
}

static long double number_at(cursor *c) {
  char *end, unit[WORD];
  long double value = strtold(c->at, &end);
  if (end == c->at) fail_msg("a number is wanted at '%s'", c->at);
  c->at = end;
  skip_spaces(c);
  if (!isalpha((unsigned char)*c->at)) return value;
  read_word(c, unit);
  if (!strncmp(c->at, "/s", 2) && !isalnum((unsigned char)c->at[2])) c->at += 2; /* m/s, rad/s */
  return value;
}

static long double atom_at(cursor *c) {
  if (takes(c, '(')) {
    long double x = sum_at(c);
    assert_true(takes(c, ')'));
    return x;
  }
  return isalpha((unsigned char)*c->at) ? word_at(c) : number_at(c);
}

/* Powers bind more tightly than the sign, and the last of them first. */
static long double signed_at(cursor *c) {
  if (takes(c, '-')) return -signed_at(c);
  long double x = atom_at(c);
  return takes(c, '^') ? powl(x, signed_at(c)) : x;
}

static long double product_at(cursor *c) {
  long double x = signed_at(c);
  for (;;) {
    if (takes(c, '*'))
      x *= signed_at(c);
    else if (takes(c, '/'))
      x /= signed_at(c);
    else
      return x;
  }
}

static long double sum_at(cursor *c) {
  long double x = product_at(c);
  for (;;) {
    if (takes(c, '+'))
      x += product_at(c);
    else if (takes(c, '-'))
      x -= product_at(c);
    else
      return x;
  }
}

long double slow_expression(const char *text, slow_variable *variable, void *context) {
  cursor c = {text, variable, context};
  long double value = sum_at(&c);
  skip_spaces(&c);
  if (*c.at) fail_msg("unexpected '%s' in '%s'", c.at, text);
  return value;
}
