/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/command/arguments.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

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
