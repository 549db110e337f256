/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of commands: a new one is one file, one line here and one in the header. */
#include "parser/program/commands.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "engine/output/result_values.h"
#include "parser/language/keys/keys.h"
#include "parser/language/yaml/diagnostics.h"
#include "parser/program/streams.h"

static strut_status print_help(const strut_arguments *arguments);

static const strut_command help_command = {
    .name = "help",
    .model = "COMMAND|KEY",
    .model_optional = true,
    .summary = "explains the program, a command, or a key of the language",
    .run = print_help,
};

/* In the order of the help; each begins with the group that it belongs to. */
static const struct {
  const char *group;
  const strut_command *command;
} rows[] = {
    {"Simulate", &strut_command_run},
    {"Simulate", &strut_command_sweep},
    {"Simulate", &strut_command_compare},
    {"Simulate", &strut_command_tradeoff},
    {"Analyse equilibria", &strut_command_equilibria},
    {"Analyse equilibria", &strut_command_path},
    {"Analyse equilibria", &strut_command_modes},
    {"Analyse equilibria", &strut_command_rigidity},
    {"Analyse equilibria", &strut_command_form},
    {"Inspect, draw and convert", &strut_command_check},
    {"Inspect, draw and convert", &strut_command_view},
    {"Inspect, draw and convert", &strut_command_plot},
    {"Inspect, draw and convert", &strut_command_export},
    {"Learn", &strut_command_examples},
    {"Learn", &strut_command_keys},
    {"Learn", &help_command},
};
enum { COMMANDS = sizeof rows / sizeof rows[0] };

const strut_command *strut_command_at(size_t i) { return i < COMMANDS ? rows[i].command : NULL; }

static const char *command_name_at(const void *context, size_t i) {
  (void)context;
  return i < COMMANDS ? rows[i].command->name : NULL;
}

const strut_command *strut_command_named(const char *name) {
  for (size_t i = 0; i < COMMANDS; i++)
    if (strcmp(rows[i].command->name, name) == 0) return rows[i].command;
  return NULL;
}

const strut_command *strut_command_find(const char *name) {
  const strut_command *found = strut_command_named(name);
  if (found) return found;
  const bool study =
      strut_word_find("fit|search|follow|sensitivity|sample|optimise|optimize", name) >= 0;
  fprintf(stderr, "strut: unknown command '%s'%s\n'strut help' lists the commands\n", name,
          study ? "; 'strut sweep STUDY' computes studies: fits, searches, samples and others"
                : strut_near_to(name, command_name_at, NULL).text);
  return NULL;
}

void strut_program_help(void) {
  int width = 0;
  const char *group = "";
  for (size_t i = 0; i < COMMANDS; i++) {
    int length = (int)strlen(rows[i].command->name);
    if (length > width) width = length;
  }
  printf(
      "strut %s: planar structures of bars, springs and cables, described in YAML\n\n"
      "Usage: strut COMMAND [OPTION]... [MODEL]\n   or: strut MODEL [OPTION]...\n",
      STRUT_VERSION);
  for (size_t i = 0; i < COMMANDS; i++) {
    if (strcmp(rows[i].group, group) != 0) printf("\n%s:\n", rows[i].group);
    group = rows[i].group;
    printf("  %-*s  %s\n", width, rows[i].command->name, rows[i].command->summary);
  }
  printf(
      "\n'strut help COMMAND' explains a command, 'strut keys KEY' a key of the language.\n"
      "MODEL is a YAML file, or - for standard input. Without COMMAND, strut runs a model that\n"
      "describes a run, finds the equilibria of another, and computes the points of a study.\n\n"
      "Exit codes: 0 success, 1 wrong usage, 2 invalid scene, 3 computation failed,\n"
      "4 file or memory error, 5 less accurate than requested, 130 interrupted.\n");
}

int strut_report_width(const strut_arguments *arguments) {
  return arguments->format.index ? STRUT_REPORT_LATEX
                                 : strut_terminal_columns(STDOUT_FILENO, STRUT_REPORT_WIDTH);
}

strut_status strut_print_values(const strut_arguments *arguments, const strut_value_rows *values,
                                const void *result, const strut_scene *scene) {
  return strut_print_report(
      arguments, arguments->json
                     ? strut_values_json(values, result, scene)
                     : strut_values_text(values, result, scene, strut_report_width(arguments),
                                         STRUT_REPORT_ROWS));
}

static strut_status print_help(const strut_arguments *arguments) {
  const strut_command *command = arguments->model ? strut_command_named(arguments->model) : NULL;
  if (arguments->model && !command && strut_keys_know(arguments->model))
    return strut_command_keys.run(arguments);
  if (arguments->model && !command)
    return strut_command_find(arguments->model) ? STRUT_OK : STRUT_USAGE;
  if (command)
    strut_command_help(command);
  else
    strut_program_help();
  return STRUT_OK;
}

/*
 * `strut complete WORD...`, which strut.bash calls: prints the words that complete the last one, a line each, and a
 * last line that begins with a colon: ":" alone, ":files" or ":files yaml yml" where files (of these endings) fit
 * too, or ":folders".
 */

typedef struct completion {
  const char *word;   /* as typed so far, within an argument: behind its last comma or "--set=" */
  int kept;           /* bytes before it in the argument, which are printed again */
  const char *before; /* the argument */
} completion;

/* Prints the text if it begins as the word does. */
static void offer(const completion *self, const char *text) {
  if (strncmp(text, self->word, strlen(self->word)) == 0 && !strpbrk(text, "\t\n"))
    printf("%.*s%s\n", self->kept, self->before, text);
}

static void offer_commands(const completion *self) {
  for (size_t i = 0; strut_command_at(i); i++) offer(self, strut_command_at(i)->name);
}

static void offer_options(const completion *self, const strut_command *command) {
  char name[64];
  for (size_t i = 0; strut_option_at(command, i); i++) {
    snprintf(name, sizeof name, "--%s", strut_option_at(command, i)->name);
    offer(self, name);
  }
  for (const strut_command_variant *variant = command->forms; variant && variant->selector;
       variant++) {
    snprintf(name, sizeof name, "--%s", variant->selector);
    offer(self, name);
  }
}

static void offer_example(void *context, const char *model) { offer(context, model); }

/* ---- the command line ---- */

/* What fits the value of an option; returns the last line. */
static const char *complete_value(const strut_option *option, completion *self) {
  const char *comma = strrchr(self->word, ',');
  if (comma) { /* only what is behind the last comma is completed */
    self->kept += (int)(comma + 1 - self->word);
    self->word = comma + 1;
  }
  char word[40];
  for (int i = 0; strut_option_word(option, i, word, sizeof word); i++) offer(self, word);
  if (strcmp(option->argument, "DIR") == 0) return ":folders";
  return strncmp(option->argument, "FILE", 4) == 0 ? ":files" : ":";
}

static const char *complete_argument(const strut_command *command, completion *self) {
  const char *model = command->model ? command->model : "";
  if (strncmp(model, "COMMAND", 7) == 0) offer_commands(self);
  for (int i = 0; i < STRUT_SECTION_COUNT && strncmp(model, "SECTION", 7) == 0; i++)
    offer(self, strut_section_name((strut_section)i));
  if (strcmp(model, "EXAMPLE") == 0) strut_examples_list(offer_example, self);
  if (strcmp(model, "DIR") == 0) return ":folders";
  if (strcmp(model, "TABLE") == 0) return ":files csv";
  if (strstr(model, "RUN") || strncmp(model, "FILE", 4) == 0) return ":files";
  bool scene = strncmp(model, "MODEL", 5) == 0 || strcmp(model, "STUDY") == 0;
  return scene ? ":files yaml yml" : ":";
}

static const char *complete_in(const strut_command *command, int count, char **words) {
  char *word = words[count - 1], *value;
  completion c = {.word = word, .before = word};
  const strut_option *option = word[0] == '-' ? strut_option_of(command, word, &value) : NULL;
  if (option && value && option->argument) {
    c.kept = (int)(value - word);
    c.word = value;
    return complete_value(option, &c);
  }
  option = count > 1 && words[count - 2][0] == '-'
               ? strut_option_of(command, words[count - 2], &value)
               : NULL;
  if (option && !value && option->argument) return complete_value(option, &c);
  if (word[0] != '-') return complete_argument(command, &c);
  offer_options(&c, command);
  return ":";
}

strut_status strut_complete(int count, char **words) {
  const char *directive = ":";
  const strut_command *command = count > 1 ? strut_command_named(words[0]) : NULL;
  if (count == 1) offer_commands(&(completion){.word = words[0], .before = words[0]});
  if (command) {
    command = strut_command_variant_of(command, count - 2, words + 1);
    directive = complete_in(command, count - 1, words + 1);
  }
  puts(directive);
  return STRUT_OK;
}
