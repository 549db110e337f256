/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Commands by name, and the command line. */
#include "parser/program/commands.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/output/draw/figure.h"
#include "engine/output/result_values.h"
#include "parser/language/keys/keys.h"
#include "parser/language/yaml/document.h"

static strut_status print_help(const strut_arguments *arguments);

const strut_command strut_command_help = {
    .name = "help",
    .model = "COMMAND|KEY",
    .model_optional = true,
    .summary = "explains the program, a command, or a key of the language",
    .run = print_help,
};

static const struct {
  const char *group;
  const strut_command *command;
} rows[] = {
#define COMMAND_ROW(name, group) {group, &strut_command_##name},
    STRUT_COMMAND_TABLE(COMMAND_ROW)};
enum { COMMANDS = sizeof rows / sizeof rows[0] };

/* The i-th command, or NULL after the last. */
static const strut_command *command_at(size_t i) { return i < COMMANDS ? rows[i].command : NULL; }

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

/* Prints the help of the whole program on stdout. */
static void print_program_help(void) {
  const char *group = "";
  printf(
      "strut %s: planar structures of bars, springs and cables, described in YAML\n\n"
      "Usage: strut COMMAND [OPTION]... [MODEL]\n   or: strut MODEL [OPTION]...\n",
      STRUT_VERSION);
  for (size_t i = 0; i < COMMANDS; i++) {
    if (strcmp(rows[i].group, group) != 0) printf("\n%s:\n", rows[i].group);
    group = rows[i].group;
    printf("  %-10s  %s\n", rows[i].command->name, rows[i].command->summary);
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
    strut_command_explain(command);
  else
    print_program_help();
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
  for (size_t i = 0; command_at(i); i++) offer(self, command_at(i)->name);
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

/* ---- options ---- */

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
  const bool whole = meant && strncmp(meant, name, length) == 0 && meant[length] == '-';
  const char *end = whole ? "=VALUE'?" : meant ? "'?" : "";
  return with_help(
      to, strut_usage_error(to, "unknown option '--%s'%s%s%s%s%s", name,
                            meant ? "; did you mean '--" : "", meant ? meant : "",
                            whole ? "', or of a parameter '--set " : "", whole ? name : "", end));
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
  const strut_setting override = {.name = text, .text = equals + 1};
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
    return with_help(to, strut_usage_error(to, "unexpected argument '%s'%s", text,
                                           to->override_count || to->varied_count
                                               ? "; a value with a space is quoted: NAME='20 Hz'"
                                               : ""));
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

void strut_command_explain(const strut_command *command) {
  printf("Usage: strut %s [OPTION]...", command->name);
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
