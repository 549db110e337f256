/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Arithmetic on values with a dimension: operators and functions of expressions.
 */
#ifndef STRUT_PARSER_EXPRESSION_QUANTITY_H
#define STRUT_PARSER_EXPRESSION_QUANTITY_H

#include "parser/expression/expression.h"

/** Most arguments of a function. */
enum { STRUT_ARGUMENT_MOST = 16 };

/** Why an operation is refused. */
typedef struct strut_reason {
  char text[200];
} strut_reason;

/** a = a OP b for one of + - * / ^. False with the reason. The result is finite, or varies. */
bool strut_quantity_operate(char operation, strut_quantity *a, strut_quantity b,
                            strut_reason *reason);

typedef struct strut_function strut_function;
/** The function of that name, or NULL. */
const strut_function *strut_function_find(const char *name, size_t length);
/** Name of the i-th function, or NULL after the last. */
const char *strut_function_name(size_t i);
/** What a program calls it. */
strut_operation strut_function_operation(const strut_function *function);
/** Applies the function to its arguments. False with the reason. The result is finite. */
bool strut_function_apply(const strut_function *function, const strut_quantity *arguments,
                          size_t count, strut_quantity *result, strut_reason *reason);

#endif
