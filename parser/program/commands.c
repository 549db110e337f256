/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of commands: a new one is one file, one line here and one in the header. */
#include "parser/program/commands.h"

#include <stdio.h>
#include <string.h>

#include "parser/yaml/diagnostics.h"

static strut_status print_help(const strut_arguments *arguments);

static const strut_option help_options[] = {
    {STRUT_OPTION_MAN, "man", NULL, "print the source of the manual page, for man -l"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static const strut_command help_command = {
    .name = "help",
    .model = "COMMAND",
    .model_optional = true,
    .summary = "explains the program, or one of its commands",
    .details =
        "\nWith --man, COMMAND may also be 'model', for the page strut-model(5) of the language.\n",
    .options = help_options,
    .run = print_help,
};

/* clang-format off */
static const strut_command *const commands[] = {
    &strut_command_run,
    &strut_command_check,
    &strut_command_equilibria,
    &strut_command_modes,
    &strut_command_form,
    &strut_command_path,
    &strut_command_rigidity,
    &strut_command_compare,
    &strut_command_merge,
    &strut_command_sweep,
    &strut_command_tradeoff,
    &strut_command_view,
    &strut_command_export,
    &strut_command_plot,
    &strut_command_write,
    &strut_command_keys,
    &strut_command_schema,
    &strut_command_completion,
    &strut_command_fmt,
    &strut_command_new,
    &strut_command_examples,
    &strut_command_evaluate,
    &strut_command_import,
    &strut_command_follow,
    &help_command,
    NULL,
};
/* clang-format on */

const strut_command *strut_command_at(size_t i) {
  return i < sizeof commands / sizeof commands[0] ? commands[i] : NULL;
}

static const char *command_name_at(const void *context, size_t i) {
  (void)context;
  return commands[i] ? commands[i]->name : NULL;
}

const strut_command *strut_command_find(const char *name) {
  for (size_t i = 0; commands[i]; i++) {
    if (strcmp(commands[i]->name, name) == 0) return commands[i];
  }
  const char *near = strut_did_you_mean(name, command_name_at, NULL);
  fprintf(stderr, "strut: unknown command '%s'", name);
  if (near) fprintf(stderr, "; did you mean '%s'?", near);
  fprintf(stderr, "\n'strut help' lists the commands\n");
  return NULL;
}

void strut_program_help(void) {
  int width = 0;
  for (size_t i = 0; commands[i]; i++) {
    int length = (int)strlen(commands[i]->name);
    if (length > width) width = length;
  }
  printf(
      "strut %s: planar structures of bars, springs and cables, described in YAML\n\n"
      "usage: strut COMMAND [OPTION]... [MODEL]\n\nCommands:\n",
      STRUT_VERSION);
  for (size_t i = 0; commands[i]; i++)
    printf("  %-*s  %s\n", width, commands[i]->name, commands[i]->summary);
  printf(
      "\n'strut help COMMAND' explains a command; 'strut --version' prints the version.\n"
      "MODEL is a file in strut's language (see 'strut keys'), or - for standard input.\n\n"
      "Exit codes: 0 success, 1 wrong usage, 2 invalid scene, 3 computation failed,\n"
      "4 file or memory trouble, 5 less accurate than requested, 130 interrupted.\n");
}

static strut_status print_help(const strut_arguments *arguments) {
  if (arguments->man && arguments->model && strcmp(arguments->model, "model") == 0) {
    strut_manual_of_language();
    return STRUT_OK;
  }
  const strut_command *command = arguments->model ? strut_command_find(arguments->model) : NULL;
  if (arguments->model && !command) return STRUT_USAGE;
  if (arguments->man && command)
    strut_manual_of_command(command);
  else if (arguments->man)
    strut_manual_of_program();
  else if (command)
    strut_command_help(command);
  else
    strut_program_help();
  return STRUT_OK;
}
