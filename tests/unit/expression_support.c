/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/expression_support.h"

#include "tests/support/test.h"

int test_lookup(void *context, const char *name, size_t length, strut_quantity *q) {
  static const struct {
    const char *name;
    strut_quantity value;
  } table[] = {{"f", {10, {0, 0, -1, 0}, false, false}},
               {"a", {0.002, {0, 1, 0, 0}, false, false}},
               {"t", {3, {0, 0, 0, 0}, true, false}},
               {"two", {2, {0, 0, 0, 0}, true, false}},
               {"amplitude", {0.001, {0, 1, 0, 0}, false, false}}};
  if (context) ++*(int *)context;
  if (length == 4 && memcmp(name, "lost", 4) == 0) return -1;
  for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
    if (strlen(table[i].name) != length || memcmp(table[i].name, name, length) != 0) continue;
    *q = table[i].value;
    return 1;
  }
  return 0;
}

static const char *names(const void *context, size_t i) {
  static const char *const all[] = {"f", "a", "t", "two", "amplitude", "lost"};
  (void)context;
  return i < sizeof all / sizeof all[0] ? all[i] : NULL;
}

const strut_scope test_scope = {.lookup = test_lookup, .names = names};

static strut_quantity evaluate(const char *text) {
  strut_quantity q = {0};
  strut_expression_error error;
  if (!strut_expression_evaluate(text, &test_scope, &q, &error))
    fail_msg("'%s' was refused at %zu: %s", text, error.offset, error.message);
  return q;
}

void expect_bare(const char *text, double value) {
  strut_quantity q = evaluate(text);
  if (!(fabs(q.value - value) <= 1e-15 * fabs(value)))
    fail_msg("'%s' gave %.17g, expected %.17g", text, q.value, value);
  if (!q.bare) fail_msg("'%s' is not bare", text);
}

/* The exact bits, where the text is a literal or arithmetic that is exact. */
void expect_quantity(const char *text, double value, strut_dimension dimension) {
  strut_quantity q = evaluate(text);
  if (q.value != value) fail_msg("'%s' gave %.17g, expected %.17g", text, q.value, value);
  char name[80];
  if (q.bare || !strut_dimension_equal(q.dimension, dimension))
    fail_msg("'%s' is %s%s", text, q.bare ? "bare " : "",
             strut_dimension_name(q.dimension, name, sizeof name));
}

void expect_values(bool bare, strut_dimension dimension, const char *const *equations) {
  for (; *equations; equations++) {
    char text[80];
    const char *equals = strstr(*equations, " = ");
    assert_non_null(equals);
    snprintf(text, sizeof text, "%.*s", (int)(equals - *equations), *equations);
    if (bare)
      expect_bare(text, strtod(equals + 3, NULL));
    else
      expect_quantity(text, strtod(equals + 3, NULL), dimension);
  }
}

void expect_error(const char *text, size_t offset, size_t length, const char *message) {
  strut_quantity q = {7, STRUT_DIM_MASS, false, false};
  strut_expression_error error;
  if (strut_expression_evaluate(text, &test_scope, &q, &error))
    fail_msg("'%s' gave %.17g", text, q.value);
  if (strcmp(error.message, message) != 0)
    fail_msg("'%s': '%s', expected '%s'", text, error.message, message);
  if (error.offset != offset || error.length != length)
    fail_msg("'%s': at %zu+%zu, expected %zu+%zu", text, error.offset, error.length, offset,
             length);
  assert_true(q.value == 7); /* a refusal leaves the result alone */
}
