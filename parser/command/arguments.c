/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/command/arguments.h"

#include <assert.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "parser/expression/expression.h"
#include "parser/yaml/diagnostics.h"

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

strut_status strut_usage_error(const strut_command *command, const strut_arguments *arguments,
                               const char *format, ...) {
  char text[STRUT_MESSAGE_MOST];
  va_list values;
  va_start(values, format);
  vsnprintf(text, sizeof text, format, values);
  va_end(values);
  strut_tell(arguments->listener, STRUT_MESSAGE_USAGE, command->name, "%s", text);
  return STRUT_USAGE;
}

const char *strut_option_text(const strut_arguments *arguments, strut_option_id id) {
  assert(id >= STRUT_OPTION_TEXTS && id < STRUT_OPTION_TEXTS_END);
  return arguments->texts[(int)id - (int)STRUT_OPTION_TEXTS];
}

static const char *option_name_at(const void *context, size_t i) {
  return ((const strut_command *)context)->options[i].name; /* NULL in the last row */
}

/* Where an option without value is kept, of those that calls of the library may have. */
static bool *flag_of(strut_option_id id, strut_arguments *arguments) {
  if (id == STRUT_OPTION_FORCE) return &arguments->force;
  if (id == STRUT_OPTION_STUCK) return &arguments->stuck;
  if (id == STRUT_OPTION_WAVE) return &arguments->wave;
  return id == STRUT_OPTION_ALL ? &arguments->all : NULL;
}

static strut_status set_flag(const strut_command *command, const strut_option *option,
                             const char *value, strut_arguments *arguments) {
  bool *flag = flag_of(option->id, arguments);
  bool yes = strcmp(value, "yes") == 0 || strcmp(value, "true") == 0;
  if (!yes && strcmp(value, "no") != 0 && strcmp(value, "false") != 0)
    return strut_usage_error(command, arguments, "--%s expects yes or no, not '%s'", option->name,
                             value);
  assert(flag);
  if (flag) *flag = yes;
  return STRUT_OK;
}

strut_status strut_argument_set(const strut_command *command, const char *name, const char *value,
                                strut_arguments *arguments) {
  const strut_option *option = command->options;
  while (option->id != STRUT_OPTION_END && strcmp(option->name, name) != 0) option++;
  if (option->id == STRUT_OPTION_END) {
    const char *near = strut_did_you_mean(name, option_name_at, command);
    return strut_usage_error(command, arguments, "unknown option '%s'%s%s%s", name,
                             near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
  }
  if (!option->argument) return set_flag(command, option, value, arguments);
  arguments->texts[(int)option->id - (int)STRUT_OPTION_TEXTS] = value;
  return STRUT_OK;
}

static const char *name_of(const strut_command *command, strut_option_id id) {
  const strut_option *option = command->options;
  while (option->id != STRUT_OPTION_END && option->id != id) option++;
  assert(option->id == id);
  return option->name;
}

strut_status strut_option_number(const strut_command *command, const strut_arguments *arguments,
                                 strut_option_id id, strut_dimension dimension, double *value) {
  const char *text = strut_option_text(arguments, id);
  strut_expression_error error = {0};
  strut_quantity quantity;
  char kind[64];
  if (!text) return STRUT_OK; /* the command may not even have the option */
  const char *name = name_of(command, id);
  if (!strut_expression_evaluate(text, NULL, &quantity, &error)) {
    return strut_usage_error(command, arguments, "--%s '%s': %s", name, text, error.message);
  }
  if (!quantity.bare && !strut_dimension_equal(quantity.dimension, dimension)) {
    const char *example = strut_dimension_example(dimension);
    return strut_usage_error(command, arguments, "--%s expects %s%s%s, not '%s'", name,
                             strut_dimension_name(dimension, kind, sizeof kind),
                             example ? ", such as " : "", example ? example : "", text);
  }
  *value = quantity.value;
  return STRUT_OK;
}

strut_status strut_option_within(const strut_command *command, const strut_arguments *arguments,
                                 strut_option_id id, strut_dimension dimension, double low,
                                 double high, double *value) {
  const char *text = strut_option_text(arguments, id);
  strut_status status = strut_option_number(command, arguments, id, dimension, value);
  if (status != STRUT_OK || !text || (*value >= low && *value <= high)) return status;
  return strut_usage_error(command, arguments, "--%s expects a value from %g to %g, not '%s'",
                           name_of(command, id), low, high, text);
}

size_t strut_option_numbers(const char *text, strut_dimension dimension, double *values,
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

bool strut_range_text_split(const char *text, strut_range_text *range) {
  size_t length = strcspn(text, "=");
  const char *low = text[length] ? text + length + 1 : NULL, *dots = low ? strstr(low, "..") : NULL;
  *range = (strut_range_text){.name = text, .name_length = length};
  if (low && (!dots || dots == low || !dots[2])) return false;
  if (low) range->low = low, range->low_length = (size_t)(dots - low), range->high = dots + 2;
  return length > 0;
}

strut_status strut_option_integer(const strut_command *command, const strut_arguments *arguments,
                                  strut_option_id id, int64_t low, int64_t high, int64_t *value) {
  const char *text = strut_option_text(arguments, id);
  uint64_t sum = 0, most = high < 0 ? 0 : (uint64_t)high;
  bool good = text && *text;
  for (const char *c = text; good && *c; c++) {
    good = *c >= '0' && *c <= '9' && sum <= most / 10;
    sum = 10 * sum + (uint64_t)(*c - '0');
    good = good && sum <= most;
  }
  if (!text) return STRUT_OK;
  if (!good || (int64_t)sum < low)
    return strut_usage_error(
        command, arguments, "--%s expects a whole number from %" PRId64 " to %" PRId64 ", not '%s'",
        name_of(command, id), low, high, text);
  *value = (int64_t)sum;
  return STRUT_OK;
}

static const char *word_at(const void *context, size_t i) {
  return ((const char *const *)context)[i];
}

strut_status strut_option_word(const strut_command *command, const strut_arguments *arguments,
                               strut_option_id id, const char *const *words, int *value) {
  const char *text = strut_option_text(arguments, id);
  if (!text) return STRUT_OK;
  for (int i = 0; words[i]; i++) {
    if (strcmp(words[i], text) != 0) continue;
    *value = i;
    return STRUT_OK;
  }
  const char *near = strut_did_you_mean(text, word_at, words);
  char list[STRUT_MESSAGE_MOST / 2] = "";
  for (size_t i = 0, used = 0; words[i] && used < sizeof list; i++)
    used += (size_t)snprintf(list + used, sizeof list - used, "%s%s",
                             i == 0         ? ""
                             : words[i + 1] ? ", "
                                            : " or ",
                             words[i]);
  return strut_usage_error(command, arguments, "--%s expects %s, not '%s'%s%s%s",
                           name_of(command, id), list, text, near ? "; did you mean '" : "",
                           near ? near : "", near ? "'?" : "");
}
