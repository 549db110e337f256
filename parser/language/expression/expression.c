/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/language/expression/expression.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/expression/expression_parts.h"
#include "parser/language/yaml/document.h"
#include "parser/language/yaml/text.h"

enum { DEPTH_MOST = 64, LENGTH_MOST = 1000, PROGRAM_MOST = 10000 };

static bool read_sum(strut_expression_reader *reader, strut_quantity *quantity);
static bool read_signed(strut_expression_reader *reader, strut_quantity *quantity);

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

char strut_expression_peek(strut_expression_reader *reader) {
  while (reader->at < reader->length && is_blank(reader->text[reader->at])) reader->at++;
  return reader->at < reader->length ? reader->text[reader->at] : '\0';
}

static bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

size_t strut_expression_word(const strut_expression_reader *reader, size_t at) {
  size_t begin = at;
  if (at >= reader->length || !is_letter(reader->text[at])) return 0;
  while (at < reader->length &&
         (is_letter(reader->text[at]) || (reader->text[at] >= '0' && reader->text[at] <= '9')))
    at++;
  return at - begin;
}

int strut_expression_lookup(const strut_expression_reader *reader, const char *name, size_t length,
                            strut_quantity *quantity) {
  if (!reader->scope || !reader->scope->lookup) return 0;
  return reader->scope->lookup(reader->scope->context, name, length, quantity);
}

bool strut_expression_reserved(const char *name, size_t length) {
  return (length == 2 && memcmp(name, "pi", 2) == 0) || strut_function_find(name, length);
}

static bool expect_character(strut_expression_reader *reader, char wanted, const char *words) {
  if (strut_expression_peek(reader) != wanted) return strut_expression_unexpected(reader, words);
  reader->at++;
  return true;
}

/* Reads arguments and the closing parenthesis; the opening one has been read. */
static bool read_call(strut_expression_reader *reader, const strut_function *function, size_t begin,
                      strut_quantity *quantity) {
  strut_quantity arguments[STRUT_ARGUMENT_MOST];
  strut_reason reason;
  size_t count = 0;
  do {
    if (count) reader->at++;
    if (count == STRUT_ARGUMENT_MOST)
      return strut_expression_fail(reader, begin, reader->at, "more than %d arguments",
                                   STRUT_ARGUMENT_MOST);
    if (!read_sum(reader, &arguments[count])) return false;
    count++;
  } while (strut_expression_peek(reader) == ',');
  if (!expect_character(reader, ')', "an operator, ',' or ')'")) return false;
  if (!strut_function_apply(function, arguments, count, quantity, &reason))
    return strut_expression_fail(reader, begin, reader->at, "%s", reason.text);
  strut_expression_emit(reader, strut_function_operation(function), count, quantity);
  return true;
}

static bool read_name(strut_expression_reader *reader, size_t length, strut_quantity *quantity) {
  size_t begin = reader->at;
  const char *name = reader->text + begin;
  reader->at += length;
  if (strut_expression_peek(reader) == '(') {
    const strut_function *function = strut_function_find(name, length);
    if (!function) return strut_expression_unknown_function(reader, begin, length);
    reader->at++;
    return read_call(reader, function, begin, quantity);
  }
  if (length == 2 && memcmp(name, "pi", 2) == 0) {
    *quantity = (strut_quantity){.value = STRUT_PI, .bare = true};
    strut_expression_emit_number(reader, quantity);
    return true;
  }
  int found = strut_expression_lookup(reader, name, length, quantity);
  if (found < 0) {
    strut_expression_fail(reader, begin, begin + length, "%s", "");
    reader->error->message[0] = '\0'; /* the lookup has reported it */
    return false;
  }
  if (found > 0) {
    strut_expression_emit_number(reader, quantity);
    return true;
  }
  found = strut_expression_column_word(reader, begin, length, quantity);
  return found > 0 || (found == 0 && strut_expression_unknown_name(reader, begin, length));
}

static bool read_literal(strut_expression_reader *reader, strut_quantity *quantity) {
  if (!strut_expression_literal(reader, quantity)) return false;
  strut_expression_emit_number(reader, quantity);
  return true;
}

static bool read_primary(strut_expression_reader *reader, strut_quantity *quantity) {
  char c = strut_expression_peek(reader);
  int column = strut_expression_column(reader, quantity);
  if (column) return column > 0;
  if ((c >= '0' && c <= '9') || c == '.') return read_literal(reader, quantity);
  if (c == '(') {
    reader->at++;
    return read_sum(reader, quantity) && expect_character(reader, ')', "an operator or ')'");
  }
  size_t length = strut_expression_word(reader, reader->at);
  if (length) return read_name(reader, length, quantity);
  return strut_expression_unexpected(reader, "a number, a name or '('");
}

/* *q = *q OP b, where the operands stand in text[begin..at). */
static bool apply_operator(strut_expression_reader *reader, size_t begin, char operation,
                           strut_quantity *quantity, strut_quantity b) {
  static const char signs[] = "+-*/^";
  static const strut_operation operations[] = {STRUT_OPERATION_ADD, STRUT_OPERATION_SUBTRACT,
                                               STRUT_OPERATION_MULTIPLY, STRUT_OPERATION_DIVIDE,
                                               STRUT_OPERATION_POWER};
  strut_reason reason;
  if (!strut_quantity_operate(operation, quantity, b, &reason))
    return strut_expression_fail(reader, begin, reader->at, "%s", reason.text);
  strut_expression_emit(reader, operations[strchr(signs, operation) - signs], 2, quantity);
  return true;
}

/* A power binds tighter than a sign before it, and groups to the right. */
static bool read_power(strut_expression_reader *reader, strut_quantity *quantity) {
  strut_expression_peek(reader);
  size_t begin = reader->at;
  strut_quantity exponent;
  if (!read_primary(reader, quantity)) return false;
  size_t end = reader->at;
  if (strut_expression_peek(reader) != '^') {
    reader->at = end;
    return true;
  }
  reader->at++;
  return read_signed(reader, &exponent) && apply_operator(reader, begin, '^', quantity, exponent);
}

/* Every kind of nesting passes through here, so the depth is counted here. */
static bool read_signed(strut_expression_reader *reader, strut_quantity *quantity) {
  char c = strut_expression_peek(reader);
  if (reader->depth > DEPTH_MOST)
    return strut_expression_fail(reader, reader->at, reader->at + 1,
                                 "more than %d levels of nesting", DEPTH_MOST);
  reader->depth++;
  bool sign = c == '-' || c == '+', fine;
  if (sign) reader->at++;
  fine = sign ? read_signed(reader, quantity) : read_power(reader, quantity);
  if (fine && c == '-') {
    quantity->value = -quantity->value;
    strut_expression_emit(reader, STRUT_OPERATION_NEGATE, 1, quantity);
  }
  reader->depth--;
  return fine;
}

/* Operands that two operators of one rank join, from left to right. */
static bool read_chain(strut_expression_reader *reader, char first, char second,
                       bool (*read)(strut_expression_reader *, strut_quantity *),
                       strut_quantity *quantity) {
  strut_expression_peek(reader);
  size_t begin = reader->at;
  bool fine = read(reader, quantity);
  while (fine) {
    size_t end = reader->at;
    char c = strut_expression_peek(reader);
    strut_quantity operand;
    if (c != first && c != second) {
      reader->at = end;
      break;
    }
    reader->at++;
    fine = read(reader, &operand) && apply_operator(reader, begin, c, quantity, operand);
  }
  return fine;
}

static bool read_product(strut_expression_reader *reader, strut_quantity *quantity) {
  return read_chain(reader, '*', '/', read_signed, quantity);
}

static bool read_sum(strut_expression_reader *reader, strut_quantity *quantity) {
  return read_chain(reader, '+', '-', read_product, quantity);
}

bool strut_expression_evaluate(const char *text, const strut_scope *scope, strut_quantity *quantity,
                               strut_expression_error *error) {
  return strut_expression_compile(text, scope, NULL, quantity, error);
}

bool strut_expression_compile(const char *text, const strut_scope *scope, strut_compiler *compiler,
                              strut_quantity *quantity, strut_expression_error *error) {
  strut_expression_reader r = {text, strlen(text), 0, 0, scope, error, compiler};
  strut_quantity q = {0};
  int most =
      compiler ? PROGRAM_MOST : LENGTH_MOST; /* what is evaluated in every step is read once */
  if (r.length > (size_t)most && strut_text_points(text, r.length) > (size_t)most)
    return strut_expression_fail(&r, 0, r.length, "the expression is longer than %d characters",
                                 most);
  if (strut_expression_peek(&r) == '\0' && r.at >= r.length)
    return strut_expression_fail(&r, 0, r.length, "a number is missing here");
  if (!read_sum(&r, &q)) return false;
  if (strut_expression_peek(&r) != '\0' || r.at < r.length)
    return strut_expression_unexpected(&r, "an operator or the end");
  assert(isfinite(q.value));
  error->message[0] = '\0';
  *quantity = q;
  return true;
}

/* Longest piece of the text that a message quotes. */
enum { SHOWN_MOST = 40 };

bool strut_expression_fail(strut_expression_reader *reader, size_t begin, size_t end,
                           const char *format, ...) {
  if (reader->scope && reader->scope->unread) {
    *reader->error = (strut_expression_error){.message = "?"};
    return false;
  }
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(reader->error->message, sizeof reader->error->message, format, arguments);
  va_end(arguments);
  if (end > reader->length) end = reader->length;
  if (begin > end) begin = end;
  reader->error->offset = strut_text_points(reader->text, begin);
  reader->error->length = strut_text_points(reader->text + begin, end - begin);
  return false;
}

/* The names that may be suggested, in this order. */
typedef struct candidates {
  const strut_scope *scope;
  bool parameters, functions, units;
  size_t functions_from, units_from; /* found while walking */
} candidates;

static const char *next_candidate(const void *context, size_t i) {
  candidates *all = (candidates *)(uintptr_t)context;
  if (all->parameters) {
    const char *name = all->scope->names(all->scope->context, i);
    if (name) return name;
    all->parameters = false;
    all->functions_from = i;
  }
  if (all->functions) {
    if (i == all->functions_from) return "pi";
    const char *name = strut_function_name(i - all->functions_from - 1);
    if (name) return name;
    all->functions = false;
    all->units_from = i;
  }
  const strut_unit *unit = all->units ? strut_unit_at(i - all->units_from) : NULL;
  return unit ? unit->name : NULL;
}

static bool fail_with_hint(strut_expression_reader *reader, size_t begin, size_t length,
                           const char *what, bool parameters, bool functions, bool units) {
  char word[SHOWN_MOST + 1];
  bool cut = length > SHOWN_MOST;
  snprintf(word, sizeof word, "%.*s", cut ? SHOWN_MOST : (int)length, reader->text + begin);
  bool named = parameters && reader->scope && reader->scope->names;
  candidates all = {reader->scope, named, functions, units, 0, 0};
  bool silent = cut || (reader->scope && reader->scope->no_hints);
  return strut_expression_fail(reader, begin, begin + length, "unknown %s '%s%s'%s", what, word,
                               cut ? "..." : "",
                               silent ? "" : strut_near_to(word, next_candidate, &all).text);
}

/* Bytes of the first of two units that the word joins, as in Ns for N s; 0: it is no such word. */
static size_t first_of_two_units(const char *word, size_t length) {
  for (size_t first = length; first-- > 1;) {
    const strut_unit *unit = strut_unit_find(word, first);
    const strut_unit *b = strut_unit_find(word + first, length - first);
    if (unit && b && !strut_dimension_equal(unit->dimension, b->dimension)) return first;
  }
  return 0;
}

static bool is_word(const strut_expression_reader *reader, size_t begin, size_t length,
                    const char *word) {
  return strlen(word) == length && memcmp(reader->text + begin, word, length) == 0;
}

bool strut_expression_unknown_unit(strut_expression_reader *reader, size_t begin, size_t length) {
  strut_quantity ignored;
  if (length <= SHOWN_MOST &&
      (strut_expression_reserved(reader->text + begin, length) ||
       strut_expression_lookup(reader, reader->text + begin, length, &ignored) != 0))
    return strut_expression_fail(reader, begin, begin + length,
                                 "expected an operator before '%.*s'; write '*' to multiply",
                                 (int)length, reader->text + begin);
  size_t first = first_of_two_units(reader->text + begin, length);
  if (first)
    return strut_expression_fail(reader, begin, begin + length,
                                 "unknown unit '%.*s'; did you mean '%.*s %.*s'?", (int)length,
                                 reader->text + begin, (int)first, reader->text + begin,
                                 (int)(length - first), reader->text + begin + first);
  return fail_with_hint(reader, begin, length, "unit", false, false, true);
}

bool strut_expression_unknown_name(strut_expression_reader *reader, size_t begin, size_t length) {
  static const char *const not_numbers[] = {"nan", "NaN", "NAN", "inf", "Inf", "INF", "infinity"};
  for (size_t i = 0; i < sizeof not_numbers / sizeof not_numbers[0]; i++)
    if (is_word(reader, begin, length, not_numbers[i]))
      return strut_expression_fail(reader, begin, begin + length,
                                   "'%s' is not allowed, expected a finite number", not_numbers[i]);
  if (strut_function_find(reader->text + begin, length))
    return strut_expression_fail(reader, begin, begin + length,
                                 "the function '%.*s' needs its arguments in parentheses",
                                 (int)length, reader->text + begin);
  if (strut_unit_find(reader->text + begin, length))
    return strut_expression_fail(
        reader, begin, begin + length, "the unit '%.*s' needs a number before it, such as '1 %.*s'",
        (int)length, reader->text + begin, (int)length, reader->text + begin);
  bool parameters = reader->scope && reader->scope->lookup;
  return fail_with_hint(reader, begin, length, parameters ? "parameter" : "name", true, true, true);
}

bool strut_expression_unknown_function(strut_expression_reader *reader, size_t begin,
                                       size_t length) {
  strut_quantity ignored;
  if (strut_expression_reserved(reader->text + begin, length) ||
      strut_expression_lookup(reader, reader->text + begin, length, &ignored) != 0)
    return strut_expression_fail(
        reader, begin, begin + length, "'%.*s' is not a function; write '*' to multiply",
        length > SHOWN_MOST ? SHOWN_MOST : (int)length, reader->text + begin);
  return fail_with_hint(reader, begin, length, "function", false, true, false);
}

/* Characters that are typed or pasted instead of plain ones. */
static const struct lookalike {
  uint32_t code;
  const char *advice;
} lookalikes[] = {
    {0xA0, "this is a no-break space; use a plain one"},
    {0x202F, "this is a no-break space; use a plain one"},
    {0x2009, "this is a thin space; use a plain one"},
    {0x2212, "write '-' for minus"},
    {0x2013, "write '-' for minus"},
    {0xD7, "write '*' to multiply"},
    {0xB7, "write '*' to multiply"},
    {0x22C5, "write '*' to multiply"},
    {0xF7, "write '/' to divide"},
    {0xB2, "write '^2'"},
    {0xB3, "write '^3'"},
    {0xB5, "write 'u' for micro, as in 'um'"},
    {0x3BC, "write 'u' for micro, as in 'um'"},
    {0xB0, "write 'deg' for degrees"},
    {0x3C0, "write 'pi'"},
    {',', "the decimal mark is a point"},
    {'=', "a value is one expression"},
};

bool strut_expression_unexpected(strut_expression_reader *reader, const char *expected) {
  if (strut_expression_peek(reader) == '\0' && reader->at >= reader->length)
    return strut_expression_fail(reader, reader->length, reader->length,
                                 "the expression ends too early, expected %s", expected);
  uint32_t code;
  const char *here = reader->text + reader->at;
  size_t size = strut_text_decode(here, reader->length - reader->at, &code);
  for (size_t i = 0; i < sizeof lookalikes / sizeof lookalikes[0]; i++)
    if (lookalikes[i].code == code)
      return strut_expression_fail(reader, reader->at, reader->at + size, "unexpected '%.*s'; %s",
                                   (int)size, here, lookalikes[i].advice);
  if (reader->at && here[0] == '*' && here[-1] == '*')
    return strut_expression_fail(reader, reader->at - 1, reader->at + 1,
                                 "unexpected '**'; powers are written '^'");
  size_t word = strut_expression_word(reader, reader->at);
  if (word) size = word > SHOWN_MOST ? SHOWN_MOST : word;
  return strut_expression_fail(reader, reader->at, reader->at + size,
                               "unexpected '%.*s', expected %s", (int)size, here, expected);
}
