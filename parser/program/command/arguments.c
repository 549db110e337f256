/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/command/arguments.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "parser/language/expression/expression.h"
#include "parser/language/yaml/document.h"

void strut_tell(const strut_listener *listener, strut_message_kind kind, const char *command,
                const char *format, ...) {
  char text[STRUT_MESSAGE_MOST];
  va_list values;
  if (!listener) return;
  va_start(values, format);
  vsnprintf(text, sizeof text, format, values);
  va_end(values);
  listener->hear(listener->context, kind, command, text);
}

strut_status strut_tell_failure(const strut_listener *listener, strut_status status,
                                const strut_error *error) {
  const char *text = error && error->message[0] ? error->message : strut_status_text(status);
  if (status) strut_tell(listener, STRUT_MESSAGE_ERROR, NULL, "%s", text);
  return status;
}

strut_status strut_tell_lines(const strut_listener *listener, const char *lines) {
  if (!lines) return strut_tell_failure(listener, STRUT_NO_MEMORY, NULL);
  if (listener) listener->hear(listener->context, STRUT_MESSAGE_LINES, NULL, lines);
  return STRUT_OK;
}

strut_status strut_usage_error(const strut_arguments *arguments, const char *format, ...) {
  char text[STRUT_MESSAGE_MOST];
  va_list values;
  va_start(values, format);
  vsnprintf(text, sizeof text, format, values);
  va_end(values);
  strut_tell(arguments->listener, STRUT_MESSAGE_USAGE, arguments->command->name, "%s", text);
  return STRUT_USAGE;
}

/* ---- rows ---- */

static const strut_option *row_at(const strut_option *table, size_t *i) {
  for (const strut_option *option = table; option->name || option->table; option++) {
    const strut_option *row = option->table ? row_at(option->table, i) : (*i)-- ? NULL : option;
    if (row) return row;
  }
  return NULL;
}

const strut_option *strut_option_row(const strut_option *table, size_t i) {
  return table ? row_at(table, &i) : NULL;
}

static const char *name_at(const void *table, size_t i) {
  const strut_option *option = strut_option_row(table, i);
  return option ? option->name : NULL;
}

const char *strut_given_text(const strut_option *option, const strut_arguments *arguments) {
  if (option->kind < STRUT_OPTION_TEXT) return NULL;
  return *(const char *const *)((const char *)arguments + option->member);
}

const char *strut_option_words(const strut_option *option) {
  return option->key ? strut_key_at(option->key)->words : option->words;
}

const char *strut_option_word(const strut_option *option, int i, char *buffer, size_t size) {
  const char *words = strut_option_words(option);
  return words ? strut_word_at(words, i, buffer, size) : NULL;
}

/* ---- values ---- */

strut_status strut_quantity_read(const strut_arguments *arguments, const char *name,
                                 const char *text, strut_dimension dimension, double *value) {
  strut_expression_error error = {0};
  strut_quantity quantity;
  char kind[64];
  if (!text) return STRUT_OK;
  if (!strut_expression_evaluate(text, NULL, &quantity, &error))
    return strut_usage_error(arguments, "--%s '%s': %s", name, text, error.message);
  if (!quantity.bare && !strut_dimension_equal(quantity.dimension, dimension)) {
    const char *example = strut_dimension_example(dimension);
    return strut_usage_error(arguments, "--%s expects %s%s%s, not '%s'", name,
                             strut_dimension_name(dimension, kind, sizeof kind),
                             example ? ", such as " : "", example ? example : "", text);
  }
  *value = quantity.value;
  return STRUT_OK;
}

static strut_status read_number(const strut_option *option, const strut_arguments *arguments,
                                strut_given_number *to) {
  const double low = option->low, high = option->high;
  char fault[STRUT_LIMITS_TEXT];
  strut_status status = strut_quantity_read(arguments, option->name, to->text,
                                            strut_measure_dimension(option->measure), &to->value);
  if (status) return status;
  if (strut_limits_fault(option->limits, to->value, fault))
    return strut_usage_error(arguments, "--%s %s", option->name, fault);
  if (low == high || (to->value >= low && to->value <= high)) return STRUT_OK;
  return strut_usage_error(arguments, "--%s expects a value from %g to %g, not '%s'", option->name,
                           low, high, to->text);
}

static strut_status read_whole(const strut_option *option, const strut_arguments *arguments,
                               strut_given_whole *to) {
  uint64_t sum = 0, most = (uint64_t)option->most;
  bool good = *to->text;
  for (const char *c = to->text; good && *c; c++) {
    good = *c >= '0' && *c <= '9' && sum <= most / 10;
    sum = 10 * sum + (uint64_t)(*c - '0');
    good = good && sum <= most;
  }
  to->value = good ? (int64_t)sum : -1;
  if (to->value >= option->least) return STRUT_OK;
  return strut_usage_error(arguments,
                           "--%s expects a whole number from %" PRId64 " to %" PRId64 ", not '%s'",
                           option->name, option->least, option->most, to->text);
}

enum { WORD = 40, MOST_WORDS = 64 };

/* A word of the language may have other spellings. */
static strut_status read_word(const strut_option *option, const strut_arguments *arguments,
                              strut_given_word *to) {
  const strut_key *key = strut_key_at(option->key);
  const strut_spelling *other =
      option->key ? strut_spelling_find(key->section, key->name, to->text) : NULL;
  char text[STRUT_MESSAGE_MOST / 2], copies[MOST_WORDS][WORD];
  const char *words[MOST_WORDS];
  if (other && other->kind == STRUT_SPELLING_FORMER)
    strut_tell(arguments->listener, STRUT_MESSAGE_NOTE, arguments->command->name,
               "'%s' is now called '%s'", other->other, other->current);
  to->index = strut_word_find(strut_option_words(option), other ? other->current : to->text);
  if (to->index >= 0) return STRUT_OK;
  for (int i = 0; i < MOST_WORDS; i++) words[i] = strut_option_word(option, i, copies[i], WORD);
  return strut_usage_error(
      arguments, "--%s expects %s, not '%s'%s", option->name,
      strut_words_text(strut_option_words(option), text, sizeof text), to->text,
      strut_near_to(to->text, strut_row_name, STRUT_NAMED(words, MOST_WORDS)).text);
}

static strut_status read_words(const strut_option *option, const strut_arguments *arguments,
                               strut_given_words *to) {
  strut_status status = STRUT_OK;
  to->set = 0;
  for (const char *text = to->text; *text && !status;) {
    char part[WORD];
    size_t length = strcspn(text, ",");
    strut_given_word one = {.text = part};
    snprintf(part, sizeof part, "%.*s", (int)length, text);
    status = read_word(option, arguments, &one);
    if (!status) to->set |= (uint64_t)1 << one.index;
    text += length + (text[length] == ',');
  }
  return status;
}

static strut_status read_range(const strut_option *option, const strut_arguments *arguments,
                               strut_given_range *to) {
  size_t name = strcspn(to->text, "=");
  const char *low = to->text + name + 1, *dots = to->text[name] ? strstr(low, "..") : NULL;
  bool good = name > 0 && name < sizeof to->name && (dots || !to->text[name]);
  if (!good || (dots && (dots == low || dots - low >= (int)sizeof to->low || !dots[2])))
    return strut_usage_error(arguments, "--%s expects %s", option->name, option->expected);
  snprintf(to->name, sizeof to->name, "%.*s", (int)name, to->text);
  snprintf(to->low, sizeof to->low, "%.*s", dots ? (int)(dots - low) : 0, low);
  to->high = dots ? dots + 2 : NULL;
  return STRUT_OK;
}

strut_status strut_argument_read(const strut_option *option, const char *text,
                                 strut_arguments *arguments) {
  void *to = (char *)arguments + option->member;
  if (option->kind >= STRUT_OPTION_TEXT) *(const char **)to = text;
  if (option->kind == STRUT_OPTION_FLAG) *(bool *)to = true;
  if (option->kind == STRUT_OPTION_NUMBER) return read_number(option, arguments, to);
  if (option->kind == STRUT_OPTION_WHOLE) return read_whole(option, arguments, to);
  if (option->kind == STRUT_OPTION_RANGE) return read_range(option, arguments, to);
  if (option->kind == STRUT_OPTION_WORD) return read_word(option, arguments, to);
  return option->kind == STRUT_OPTION_WORDS ? read_words(option, arguments, to) : STRUT_OK;
}

strut_status strut_argument_set(const char *name, const char *value, strut_arguments *arguments) {
  const strut_option *option, *table = arguments->command->options;
  size_t i = 0;
  while ((option = strut_option_row(table, i)) && strcmp(option->name, name) != 0) i++;
  if (!option)
    return strut_usage_error(arguments, "unknown option '%s'%s", name,
                             strut_near_to(name, name_at, table).text);
  if (option->argument) return strut_argument_read(option, value, arguments);
  int yes = strut_switch_find(value);
  if (yes < 0) return strut_usage_error(arguments, "--%s expects yes or no, not '%s'", name, value);
  *(bool *)((char *)arguments + option->member) = yes;
  return STRUT_OK;
}

size_t strut_quantities_read(const char *text, strut_dimension dimension, double *values,
                             size_t most) {
  char part[100];
  size_t count = 0;
  for (const char *rest = text; rest; count++) {
    size_t length = strcspn(rest, ",");
    strut_expression_error error = {0};
    strut_quantity quantity;
    if (length >= sizeof part || count == most) return 0;
    memcpy(part, rest, length);
    part[length] = '\0';
    if (!strut_expression_evaluate(part, NULL, &quantity, &error)) return 0;
    if (!quantity.bare && !strut_dimension_equal(quantity.dimension, dimension)) return 0;
    values[count] = quantity.value;
    rest = rest[length] ? rest + length + 1 : NULL;
  }
  return count;
}
