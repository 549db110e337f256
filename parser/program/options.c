/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/options.h"

#include <assert.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/draw/canvas.h"
#include "parser/program/open_model.h"
#include "parser/program/streams.h"
#include "parser/yaml/diagnostics.h"

enum { MOST_OPTIONS = 48, FIRST = 256, POSITIONAL = 1, COLUMN = 24 };

const strut_option strut_plot_options[] = {
    {STRUT_FILLS(plot), "plot", "FILE", "draw a figure into FILE (.svg, .pdf or .png)"},
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

/* `word` starts with its dashes. `meant`: the option it abbreviates, or NULL to look for one. */
static strut_status unknown_option(const strut_arguments *to, const char *word, const char *meant) {
  int length = (int)strcspn(word, "=");
  char name[64];
  snprintf(name, sizeof name, "%.*s", length > 2 ? length - 2 : 0, word + 2);
  for (const strut_refused_option *row = to->command->refused; row && row->name; row++)
    if (strcmp(row->name, name) == 0)
      return strut_usage_error(to, "--%s cannot be used here: %s", name, row->reason);
  if (!meant) meant = strut_did_you_mean(name, option_name_at, to->command);
  return with_help(to, strut_usage_error(to, "unknown option '%.*s'%s%s%s", length, word,
                                         meant ? "; did you mean '--" : "", meant ? meant : "",
                                         meant ? "'?" : ""));
}

/* Reports why getopt rejected argv[optind - 1], or a letter in it. */
static strut_status report_rejected(const strut_arguments *to, int code, char **argv) {
  const char *word = argv[optind - 1];
  if (strncmp(word, "--", 2) != 0)
    return with_help(
        to, strut_usage_error(
                to, code == ':' ? "option '-%c' needs a value" : "unknown option '-%c'", optopt));
  if (code != ':' && !optopt) return unknown_option(to, word, NULL);
  return with_help(to, strut_usage_error(to, "option '%.*s' %s", (int)strcspn(word, "="), word,
                                         code == ':' ? "needs a value" : "takes no value"));
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

/* The option or positional argument that getopt found, with its value in optarg. */
static strut_status store_option(int id, strut_arguments *to) {
  size_t i = id >= FIRST ? (size_t)(id - FIRST) : 0;
  if (id == POSITIONAL) return add_model(optarg, to);
  while (id < FIRST && strut_option_at(to->command, i)->letter != id) i++;
  const strut_option *option = strut_option_at(to->command, i);
  if (option->kind == STRUT_OPTION_SETTING) return add_override(option, optarg, to);
  return option->kind == STRUT_OPTION_SELECTOR ? STRUT_OK : strut_argument_read(option, optarg, to);
}

/* The table in getopt's form. "-" returns positional arguments in order, ":" suppresses messages. */
static void fill_getopt(const strut_command *command, char letters[2 * MOST_OPTIONS + 3],
                        struct option rows[MOST_OPTIONS + 1]) {
  char *at = letters;
  assert(!strut_option_at(command, MOST_OPTIONS));
  *at++ = '-';
  *at++ = ':';
  for (size_t i = 0; i < MOST_OPTIONS && strut_option_at(command, i); i++) {
    const strut_option *option = strut_option_at(command, i);
    int needs = option->argument ? required_argument : no_argument;
    rows[i] = (struct option){option->name, needs, NULL, FIRST + (int)i};
    if (!option->letter) continue;
    *at++ = option->letter;
    if (option->argument) *at++ = ':';
  }
  *at = '\0';
}

/* Did getopt accept an abbreviation of the long option it found? */
static bool is_abbreviated(char **argv, const struct option *row) {
  const char *word = argv[optind - 1];
  if (row->has_arg && optarg == word) word = argv[optind - 2];
  size_t length = strcspn(word, "=");
  return length != strlen(row->name) + 2 || strncmp(word + 2, row->name, length - 2) != 0;
}

strut_status strut_arguments_read(const strut_command *command, int argc, char **argv,
                                  strut_arguments *arguments) {
  char letters[2 * MOST_OPTIONS + 3];
  struct option rows[MOST_OPTIONS + 1] = {{0}};
  fill_getopt(command, letters, rows);
  *arguments = (strut_arguments){.command = command, .listener = strut_stderr_listener()};
  arguments->overrides = strut_allocate((size_t)argc, sizeof *arguments->overrides);
  arguments->override_model = strut_allocate((size_t)argc, sizeof *arguments->override_model);
  arguments->varied = strut_allocate((size_t)argc, sizeof *arguments->varied);
  arguments->models = strut_allocate((size_t)argc, sizeof *arguments->models);
  if (!arguments->overrides || !arguments->override_model || !arguments->varied ||
      !arguments->models)
    return strut_print_out_of_memory();
  strut_status status = STRUT_OK;
  opterr = 0;
  while (status == STRUT_OK) {
    int row = -1, id = getopt_long(argc, argv, letters, rows, &row);
    if (id == -1) break;
    if (id == '?' || id == ':') {
      status = report_rejected(arguments, id, argv);
    } else if (row >= 0 && is_abbreviated(argv, &rows[row])) {
      const char *word = argv[optind - (rows[row].has_arg && optarg == argv[optind - 1] ? 2 : 1)];
      status = unknown_option(arguments, word, rows[row].name);
    } else {
      status = store_option(id, arguments);
    }
  }
  for (; status == STRUT_OK && optind < argc; optind++) /* after "--" */
    status = add_model(argv[optind], arguments);
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
  for (const strut_command_variant *f = command->forms; f && f->selector; f++) {
    if (f > command->forms && f->command == f[-1].command) continue;
    printf("\n'strut %s' %s; see 'strut %s --help'.\n", f->command->name, f->command->summary,
           f->command->name);
  }
}

const strut_command *strut_command_variant_of(const strut_command *command, int count,
                                              char **words) {
  for (const strut_command_variant *f = command->forms; f && f->selector; f++) {
    size_t length = strlen(f->selector);
    for (int i = 0; i < count && strcmp(words[i], "--") != 0; i++)
      if (strncmp(words[i], "--", 2) == 0 && strncmp(words[i] + 2, f->selector, length) == 0 &&
          (!words[i][2 + length] || words[i][2 + length] == '='))
        return f->command;
  }
  return command;
}

/* Checks that the file can be created. */
static strut_status try_path(const char *path) {
  strut_error error = {0};
  strut_status status = strut_canvas_check_name(path, &error);
  return status ? strut_print_failure(status, &error) : strut_try_file(path);
}

strut_status strut_plot_read(const strut_arguments *arguments, double usual, strut_plot *plot) {
  const strut_option *option;
  *plot = (strut_plot){.path = arguments->plot};
  for (size_t i = 0; !plot->path && (option = strut_option_at(arguments->command, i)); i++)
    if (option->of_figure && strut_given_text(option, arguments))
      return strut_usage_error(arguments, "--%s needs --plot FILE", option->name);
  if (!plot->path) return STRUT_OK;
  strut_status status = strut_plot_settings_read(arguments, usual, plot);
  return status ? status : try_path(plot->path);
}
