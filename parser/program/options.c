/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/options.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/draw/figure.h"
#include "parser/language/yaml/diagnostics.h"
#include "parser/program/commands.h"
#include "parser/program/open_model.h"
#include "parser/program/streams.h"

const strut_option strut_plot_options[] = {
    {STRUT_FILLS(plot), "plot", "FILE", "draw a figure into FILE (.svg, .pdf, .png or .json)"},
    {.table = strut_plot_setting_options},
    {.name = NULL}};

/* Every command has these, after its own. */
static const strut_option common_options[] = {
    {STRUT_FILLS(quiet), "quiet", NULL, "print no report or progress, only warnings and errors",
     .letter = 'q'},
    {STRUT_FILLS(help), "help", NULL, "print this help", .letter = 'h'},
};
enum { COMMON_OPTIONS = sizeof common_options / sizeof common_options[0] };

const strut_option *strut_option_at(const strut_command *command, size_t i) {
  const strut_option *own = strut_option_row(command->options, i);
  size_t count = 0;
  if (own) return own;
  while (strut_option_row(command->options, count)) count++;
  return i < count + COMMON_OPTIONS ? &common_options[i - count] : NULL;
}

static const char *option_name_at(const void *context, size_t i) {
  const strut_option *option = strut_option_at(context, i);
  return option ? option->name : NULL;
}

/* Says where the options are, behind a message. */
static strut_status with_help(const strut_arguments *to, strut_status status) {
  fprintf(stderr, "'strut %s --help' lists the options\n", to->command->name);
  return status;
}

const strut_option *strut_option_of(const strut_command *command, char *word, char **value) {
  const bool letter = word[1] != '-';
  const size_t length = letter ? 2 : strcspn(word, "=");
  const strut_option *row;
  for (size_t i = 0; (row = strut_option_at(command, i)); i++)
    if (letter ? row->letter && row->letter == word[1]
               : strlen(row->name) + 2 == length && !strncmp(row->name, word + 2, length - 2))
      break;
  *value = !row || !word[length] ? NULL : word + length + !letter;
  return row;
}

/* `word` starts with its dashes. */
static strut_status unknown_option(const strut_arguments *to, const char *word) {
  const size_t length = strcspn(word, "=") - 2;
  const strut_option *row;
  const char *meant = NULL; /* the first that it abbreviates, or one that is near */
  char name[64];
  snprintf(name, sizeof name, "%.*s", (int)length, word + 2);
  for (const strut_refused_option *option = to->command->refused; option && option->name; option++)
    if (strcmp(option->name, name) == 0)
      return strut_usage_error(to, "--%s cannot be used here: %s", name, option->reason);
  for (size_t i = 0; length && !meant && (row = strut_option_at(to->command, i)); i++)
    if (strncmp(row->name, name, length) == 0) meant = row->name;
  if (strut_word_find("film|movie|video|animate", name) >= 0) {
    if (to->command != &strut_command_run)
      return strut_usage_error(to, "unknown option '--%s'; 'strut run --animate FILE' makes films",
                               name);
    meant = "animate";
  }
  if (!meant) meant = strut_did_you_mean(name, option_name_at, to->command);
  return with_help(to, strut_usage_error(to, "unknown option '--%s'%s%s%s", name,
                                         meant ? "; did you mean '--" : "", meant ? meant : "",
                                         meant ? "'?" : ""));
}

/* One --set or --vary: splits NAME=VALUE in place. */
static strut_status add_override(const strut_option *option, char *text, strut_arguments *to) {
  char *equals = strchr(text, '=');
  bool varied = option->member == offsetof(strut_arguments, varied);
  if (!equals || equals == text) {
    strut_usage_error(to, "--%s expects %s, not '%s'", option->name, option->argument, text);
    return with_help(to, STRUT_USAGE);
  }
  *equals = '\0';
  const strut_override override = {text, equals + 1};
  if (varied) {
    to->varied[to->varied_count++] = override;
  } else {
    to->override_model[to->override_count] = to->model_count;
    to->overrides[to->override_count++] = override;
  }
  return STRUT_OK;
}

static strut_status add_model(const char *text, strut_arguments *to) {
  if (!to->command->model || (to->model && !to->command->many))
    return with_help(to, strut_usage_error(to, "unexpected argument '%s'", text));
  if (!to->model) to->model = text;
  to->models[to->model_count++] = text;
  return STRUT_OK;
}

/* Reads an option, or several letters, at argv[*i]; its value may be the next word, which *i then is. */
static strut_status read_option(strut_arguments *to, char **argv, int *i) {
  const bool letters = argv[*i][1] != '-';
  for (char *at = argv[*i], *value;; at++) {
    const strut_option *option = strut_option_of(to->command, at, &value);
    const int length = letters ? 1 : (int)strcspn(at, "=") - 1;
    if (!option && !letters) return unknown_option(to, at);
    if (!option) return with_help(to, strut_usage_error(to, "unknown option '-%c'", at[1]));
    if (!letters && value && !option->argument)
      return with_help(to, strut_usage_error(to, "option '-%.*s' takes no value", length, at + 1));
    if (option->argument && !value && !(value = argv[++*i]))
      return with_help(to, strut_usage_error(to, "option '-%.*s' needs a value", length, at + 1));
    if (option->kind == STRUT_OPTION_SETTING) return add_override(option, value, to);
    strut_status status = option->kind ? strut_argument_read(option, value, to) : STRUT_OK;
    if (status || option->argument || !letters || !at[2]) return status;
  }
}

strut_status strut_arguments_read(const strut_command *command, int argc, char **argv,
                                  strut_arguments *arguments) {
  *arguments = (strut_arguments){.command = command, .listener = strut_stderr_listener()};
  arguments->overrides = strut_allocate((size_t)argc, sizeof *arguments->overrides);
  arguments->override_model = strut_allocate((size_t)argc, sizeof *arguments->override_model);
  arguments->varied = strut_allocate((size_t)argc, sizeof *arguments->varied);
  arguments->models = strut_allocate((size_t)argc, sizeof *arguments->models);
  if (!arguments->overrides || !arguments->override_model || !arguments->varied ||
      !arguments->models)
    return strut_print_out_of_memory();
  strut_status status = STRUT_OK;
  bool options = true; /* until "--" */
  for (int i = 1; i < argc && !status; i++) {
    if (options && strcmp(argv[i], "--") == 0)
      options = false;
    else if (options && argv[i][0] == '-' && argv[i][1])
      status = read_option(arguments, argv, &i);
    else
      status = add_model(argv[i], arguments);
  }
  bool missing = command->model && !command->model_optional && !arguments->model;
  if (status == STRUT_OK && missing && !arguments->help)
    return with_help(arguments, strut_usage_error(arguments, "missing %s", command->model));
  return status;
}

void strut_arguments_free(strut_arguments *arguments) {
  strut_release(arguments->overrides);
  strut_release(arguments->override_model);
  strut_release(arguments->varied);
  strut_release(arguments->models);
  *arguments = (strut_arguments){0};
}

enum { COLUMN = 24 };

static void print_option(const strut_option *option) {
  char left[64], letter[8] = "    ";
  if (option->letter) snprintf(letter, sizeof letter, "-%c, ", option->letter);
  snprintf(left, sizeof left, "%s--%s%s%s", letter, option->name, option->argument ? " " : "",
           option->argument ? option->argument : "");
  printf("  %-*s %s\n", COLUMN, left, option->help);
}

void strut_command_help(const strut_command *command) {
  printf("Usage: strut %s", command->name);
  printf(" [OPTION]...");
  if (command->model) printf(command->model_optional ? " [%s]" : " %s", command->model);
  if (command->model_optional && command->many) printf("...");
  printf("\n\nstrut %s: %s.\n", command->name, command->summary);
  if (command->details) printf("%s", command->details);
  printf("\nOptions:\n");
  for (size_t i = 0; strut_option_at(command, i); i++) print_option(strut_option_at(command, i));
  for (const strut_command_variant *variant = command->forms; variant && variant->selector;
       variant++) {
    if (variant > command->forms && variant->command == variant[-1].command) continue;
    printf("\n'strut %s' %s; see 'strut %s --help'.\n", variant->command->name,
           variant->command->summary, variant->command->name);
  }
}

const strut_command *strut_command_variant_of(const strut_command *command, int count,
                                              char **words) {
  for (const strut_command_variant *variant = command->forms; variant && variant->selector;
       variant++) {
    size_t length = strlen(variant->selector);
    for (int i = 0; i < count && strcmp(words[i], "--") != 0; i++)
      if (strncmp(words[i], "--", 2) == 0 &&
          strncmp(words[i] + 2, variant->selector, length) == 0 &&
          (!words[i][2 + length] || words[i][2 + length] == '='))
        return variant->command;
  }
  return command;
}

strut_status strut_plot_read(const strut_arguments *arguments, double usual, strut_plot *plot) {
  const strut_option *option;
  *plot = (strut_plot){.path = arguments->plot};
  for (size_t i = 0; !plot->path && (option = strut_option_at(arguments->command, i)); i++)
    if (option->of_figure && strut_given_text(option, arguments))
      return strut_usage_error(arguments, "--%s needs --plot FILE", option->name);
  if (!plot->path) return STRUT_OK;
  strut_error error = {0};
  strut_status status = strut_plot_settings_read(arguments, usual, plot);
  if (status) return status;
  if (plot->texts && strut_picture_format_of(plot->path) != STRUT_PICTURE_SVG)
    return strut_usage_error(arguments, "--svg-text is for figures that end with .svg");
  status = strut_figure_check_name(plot->path, &error);
  return status ? strut_print_failure(status, &error) : strut_try_file(plot->path);
}
