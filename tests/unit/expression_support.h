/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an expression must give, with a scope of a few parameters. */
#pragma once

#include <stddef.h>

#include "parser/language/expression/expression.h"

/** f = 10 Hz, a = 2 mm, amplitude = 1 mm, t = 3 (named like a unit), two = 2; lost has no value. */
extern const strut_scope test_scope;
/** Its lookup, which also counts its calls where context is an int. */
int test_lookup(void *context, const char *name, size_t length, strut_quantity *q);

/** A bare value, to 1e-15. */
void expect_bare(const char *text, double value);
/** A value with this dimension, to the last bit. */
void expect_quantity(const char *text, double value, strut_dimension dimension);
/** The same of texts "expression = value". */
#define EXPECT_BARE(...) expect_values(true, STRUT_DIM_NONE, (const char *[]){__VA_ARGS__, NULL})
#define EXPECT_QUANTITIES(dimension, ...)                                                          \
  expect_values(false, dimension, (const char *[]){__VA_ARGS__, NULL})
void expect_values(bool bare, strut_dimension dimension, const char *const *equations);
/** A refusal at these characters of the text, in these words; the result is left alone. */
void expect_error(const char *text, size_t offset, size_t length, const char *message);
