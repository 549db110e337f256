/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/command/option_values.h"

#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "parser/expression/expression.h"
#include "parser/yaml/diagnostics.h"

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
