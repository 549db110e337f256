/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the files of the expression reader share: the text under the reader's eye, and its errors. */
#pragma once

#include "parser/language/expression/expression.h"

typedef struct strut_expression_reader {
  const char *text;
  size_t length, at; /* bytes */
  int depth;
  const strut_scope *scope;
  strut_expression_error *error;
  strut_compiler *compiler; /* NULL: there are no columns */
} strut_expression_reader;

/** Fills the error for the stretch text[begin..end) and returns false. */
bool strut_expression_fail(strut_expression_reader *reader, size_t begin, size_t end,
                           const char *format, ...) __attribute__((format(printf, 4, 5)));
/** Skips blanks; returns the next character, or NUL at the end. */
char strut_expression_peek(strut_expression_reader *reader);
/** Bytes of the word (letter or _, then also digits) at `at`, or 0. */
size_t strut_expression_word(const strut_expression_reader *reader, size_t at);
/** Looks a parameter up, as strut_lookup. */
int strut_expression_lookup(const strut_expression_reader *reader, const char *name, size_t length,
                            strut_quantity *quantity);

/** Errors in words: a name that nothing has, and a character that does not fit here. */
bool strut_expression_unknown_unit(strut_expression_reader *reader, size_t begin, size_t length);
bool strut_expression_unknown_name(strut_expression_reader *reader, size_t begin, size_t length);
bool strut_expression_unknown_function(strut_expression_reader *reader, size_t begin,
                                       size_t length);
bool strut_expression_unexpected(strut_expression_reader *reader, const char *expected);

/* terms.c: columns, and the program that is made of them. Without a compiler the
   functions that emit do nothing. */

/** Reads a column where one stands here: 1; 0: none does; -1: it was refused. */
int strut_expression_column(strut_expression_reader *reader, strut_quantity *quantity);
/** The same for a word alone, text[begin..begin + length), that is no parameter. */
int strut_expression_column_word(strut_expression_reader *reader, size_t begin, size_t length,
                                 strut_quantity *quantity);
void strut_expression_emit_number(strut_expression_reader *reader, const strut_quantity *number);
/** What replaces `operands` numbers by one. Their result, if it does not vary, is the number itself. */
void strut_expression_emit(strut_expression_reader *reader, strut_operation operation,
                           size_t operands, const strut_quantity *result);

/** A literal with the unit behind it. */
bool strut_expression_literal(strut_expression_reader *reader, strut_quantity *quantity);

/* quantity.c: arithmetic on values with a dimension. */

/** Most arguments of a function. */
enum { STRUT_ARGUMENT_MOST = 16 };

/** Why an operation is refused. */
typedef struct strut_reason {
  char text[200];
} strut_reason;

/** a = a OP b for one of + - * / ^. False with the reason. The result is finite, or varies. */
bool strut_quantity_operate(char operation, strut_quantity *quantity, strut_quantity b,
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
