/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "parser/expression/expression_parts.h"
#include "parser/expression/quantity.h"
#include "parser/yaml/diagnostics.h"
#include "parser/yaml/text.h"

/* Longest stretch of the text that a message repeats. */
enum { SHOWN_MOST = 40 };

bool strut_expression_fail(strut_expression_reader *r, size_t begin, size_t end, const char *format,
                           ...) {
  if (r->scope && r->scope->unread) {
    *r->error = (strut_expression_error){.message = "?"};
    return false;
  }
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(r->error->message, sizeof r->error->message, format, arguments);
  va_end(arguments);
  if (end > r->length) end = r->length;
  if (begin > end) begin = end;
  r->error->offset = strut_text_points(r->text, begin);
  r->error->length = strut_text_points(r->text + begin, end - begin);
  return false;
}

/* Which names a suggestion may come from, in this order. */
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

static bool fail_with_hint(strut_expression_reader *r, size_t begin, size_t length,
                           const char *what, bool parameters, bool functions, bool units) {
  char word[SHOWN_MOST + 1];
  bool cut = length > SHOWN_MOST;
  snprintf(word, sizeof word, "%.*s", cut ? SHOWN_MOST : (int)length, r->text + begin);
  bool named = parameters && r->scope && r->scope->names;
  candidates all = {r->scope, named, functions, units, 0, 0};
  bool silent = cut || (r->scope && r->scope->no_hints);
  const char *near = silent ? NULL : strut_did_you_mean(word, next_candidate, &all);
  return strut_expression_fail(r, begin, begin + length, "unknown %s '%s%s'%s%s%s", what, word,
                               cut ? "..." : "", near ? "; did you mean '" : "", near ? near : "",
                               near ? "'?" : "");
}

/* Bytes of the first of two units that the word joins, as in Ns for N s; 0: it is no such word. */
static size_t first_of_two_units(const char *word, size_t length) {
  for (size_t first = length; first-- > 1;) {
    const strut_unit *a = strut_unit_find(word, first);
    const strut_unit *b = strut_unit_find(word + first, length - first);
    if (a && b && !strut_dimension_equal(a->dimension, b->dimension)) return first;
  }
  return 0;
}

static bool is_word(const strut_expression_reader *r, size_t begin, size_t length,
                    const char *word) {
  return strlen(word) == length && memcmp(r->text + begin, word, length) == 0;
}

bool strut_expression_unknown_unit(strut_expression_reader *r, size_t begin, size_t length) {
  strut_quantity ignored;
  if (length <= SHOWN_MOST && (strut_expression_reserved(r->text + begin, length) ||
                               strut_expression_lookup(r, r->text + begin, length, &ignored) != 0))
    return strut_expression_fail(r, begin, begin + length,
                                 "expected an operator before '%.*s'; write '*' to multiply",
                                 (int)length, r->text + begin);
  size_t first = first_of_two_units(r->text + begin, length);
  if (first)
    return strut_expression_fail(r, begin, begin + length,
                                 "unknown unit '%.*s'; did you mean '%.*s %.*s'?", (int)length,
                                 r->text + begin, (int)first, r->text + begin,
                                 (int)(length - first), r->text + begin + first);
  return fail_with_hint(r, begin, length, "unit", false, false, true);
}

bool strut_expression_unknown_name(strut_expression_reader *r, size_t begin, size_t length) {
  static const char *const not_numbers[] = {"nan", "NaN", "NAN", "inf", "Inf", "INF", "infinity"};
  for (size_t i = 0; i < sizeof not_numbers / sizeof not_numbers[0]; i++)
    if (is_word(r, begin, length, not_numbers[i]))
      return strut_expression_fail(r, begin, begin + length,
                                   "'%s' is not allowed, expected a finite number", not_numbers[i]);
  if (strut_function_find(r->text + begin, length))
    return strut_expression_fail(r, begin, begin + length,
                                 "the function '%.*s' needs its arguments in parentheses",
                                 (int)length, r->text + begin);
  if (strut_unit_find(r->text + begin, length))
    return strut_expression_fail(r, begin, begin + length,
                                 "the unit '%.*s' needs a number before it, such as '1 %.*s'",
                                 (int)length, r->text + begin, (int)length, r->text + begin);
  bool parameters = r->scope && r->scope->lookup;
  return fail_with_hint(r, begin, length, parameters ? "parameter" : "name", true, true, true);
}

bool strut_expression_unknown_function(strut_expression_reader *r, size_t begin, size_t length) {
  strut_quantity ignored;
  if (strut_expression_reserved(r->text + begin, length) ||
      strut_expression_lookup(r, r->text + begin, length, &ignored) != 0)
    return strut_expression_fail(r, begin, begin + length,
                                 "'%.*s' is no function; write '*' to multiply",
                                 length > SHOWN_MOST ? SHOWN_MOST : (int)length, r->text + begin);
  return fail_with_hint(r, begin, length, "function", false, true, false);
}

/* What people type or paste in place of plain characters. */
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

bool strut_expression_unexpected(strut_expression_reader *r, const char *expected) {
  if (strut_expression_peek(r) == '\0' && r->at >= r->length)
    return strut_expression_fail(r, r->length, r->length,
                                 "the expression ends too early, expected %s", expected);
  uint32_t code;
  const char *here = r->text + r->at;
  size_t size = strut_text_decode(here, r->length - r->at, &code);
  for (size_t i = 0; i < sizeof lookalikes / sizeof lookalikes[0]; i++)
    if (lookalikes[i].code == code)
      return strut_expression_fail(r, r->at, r->at + size, "unexpected '%.*s'; %s", (int)size, here,
                                   lookalikes[i].advice);
  if (r->at && here[0] == '*' && here[-1] == '*')
    return strut_expression_fail(r, r->at - 1, r->at + 1,
                                 "unexpected '**'; powers are written '^'");
  size_t word = strut_expression_word(r, r->at);
  if (word) size = word > SHOWN_MOST ? SHOWN_MOST : word;
  return strut_expression_fail(r, r->at, r->at + size, "unexpected '%.*s', expected %s", (int)size,
                               here, expected);
}
