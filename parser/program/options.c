/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/options.h"

#include <assert.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/file.h"
#include "parser/program/streams.h"
#include "parser/yaml/diagnostics.h"

enum { MOST_OPTIONS = 48, FIRST_WITHOUT_LETTER = 256, POSITIONAL = 1, COLUMN = 24 };

/* Every command has these, after its own. */
static const strut_option common_options[] = {
    {STRUT_OPTION_QUIET, "quiet", NULL, "print no report or progress, only warnings and errors"},
    {STRUT_OPTION_HELP, "help", NULL, "print this help"},
};
enum { COMMON_OPTIONS = sizeof common_options / sizeof common_options[0] };

const strut_option *strut_option_at(const strut_command *command, size_t i) {
  size_t count = 0;
  while (command->options && command->options[count].id != STRUT_OPTION_END) count++;
  if (i < count) return &command->options[i];
  return i < count + COMMON_OPTIONS ? &common_options[i - count] : NULL;
}

static const char *option_name_at(const void *context, size_t i) {
  const strut_option *option = strut_option_at(context, i);
  return option ? option->name : NULL;
}

static strut_status usage_error(const strut_command *command) {
  fprintf(stderr, "'strut %s --help' lists the options\n", command->name);
  return STRUT_USAGE;
}

/* Why the command cannot use an option that others have, or NULL. */
static const char *reason_to_refuse(const strut_command *command, const char *name) {
  const strut_refused_option *row = command->refused;
  while (row && row->name && strcmp(row->name, name) != 0) row++;
  return row ? row->reason : NULL;
}

/* `word` starts with its dashes. `meant`: the option it abbreviates, or NULL to look for one. */
static strut_status unknown_option(const strut_command *command, const char *word,
                                   const char *meant) {
  int length = (int)strcspn(word, "=");
  char name[64];
  snprintf(name, sizeof name, "%.*s", length > 2 ? length - 2 : 0, word + 2);
  const char *reason = reason_to_refuse(command, name);
  if (reason) {
    fprintf(stderr, "strut %s: --%s cannot be used here: %s\n", command->name, name, reason);
    return STRUT_USAGE;
  }
  if (!meant) meant = strut_did_you_mean(name, option_name_at, command);
  fprintf(stderr, "strut %s: unknown option '%.*s'", command->name, length, word);
  if (meant) fprintf(stderr, "; did you mean '--%s'?", meant);
  fputc('\n', stderr);
  return usage_error(command);
}

/* Reports why getopt rejected argv[optind - 1], or a letter in it. */
static strut_status report_rejected(const strut_command *command, int code, char **argv) {
  const char *word = argv[optind - 1];
  bool letter = strncmp(word, "--", 2) != 0;
  if (code == ':' && letter) {
    fprintf(stderr, "strut %s: option '-%c' needs a value\n", command->name, optopt);
  } else if (code == ':') {
    fprintf(stderr, "strut %s: option '%s' needs a value\n", command->name, word);
  } else if (letter) {
    fprintf(stderr, "strut %s: unknown option '-%c'\n", command->name, optopt);
  } else if (optopt) {
    int length = (int)strcspn(word, "=");
    fprintf(stderr, "strut %s: option '%.*s' takes no value\n", command->name, length, word);
  } else {
    return unknown_option(command, word, NULL);
  }
  return usage_error(command);
}

/* One --set or --vary: splits NAME=VALUE in place. */
static strut_status add_override(const strut_command *command, int id, char *text,
                                 strut_arguments *to) {
  char *equals = strchr(text, '=');
  bool varied = id == STRUT_OPTION_VARY;
  if (!equals || equals == text) {
    fprintf(stderr, "strut %s: --%s expects NAME=%s, not '%s'\n", command->name,
            varied ? "vary" : "set", varied ? "RANGE" : "VALUE", text);
    return usage_error(command);
  }
  *equals = '\0';
  if (varied) {
    to->varied[to->varied_count++] = (strut_override){text, equals + 1};
  } else {
    to->override_model[to->override_count] = to->model_count;
    to->overrides[to->override_count++] = (strut_override){text, equals + 1};
  }
  return STRUT_OK;
}

static strut_status add_model(const strut_command *command, const char *text, strut_arguments *to) {
  if (!command->model || (to->model && !command->many)) {
    fprintf(stderr, "strut %s: unexpected argument '%s'\n", command->name, text);
    return usage_error(command);
  }
  if (!to->model) to->model = text;
  to->models[to->model_count++] = text;
  return STRUT_OK;
}

/* Stores one option or positional argument, with its value in optarg. */
static strut_status store_option(const strut_command *command, int id, strut_arguments *to) {
  if (id >= (int)STRUT_OPTION_TEXTS && id < (int)STRUT_OPTION_TEXTS_END) {
    to->texts[id - (int)STRUT_OPTION_TEXTS] = optarg;
    return STRUT_OK;
  }
  switch (id) {
    case POSITIONAL: return add_model(command, optarg, to);
    case STRUT_OPTION_SET:
    case STRUT_OPTION_VARY: return add_override(command, id, optarg, to);
    case STRUT_OPTION_OUTPUT: to->output = optarg; break;
    case STRUT_OPTION_JSON: to->json = true; break;
    case STRUT_OPTION_QUIET: to->quiet = true; break;
    case STRUT_OPTION_FORCE: to->force = true; break;
    case STRUT_OPTION_STUCK: to->stuck = true; break;
    case STRUT_OPTION_WAVE: to->wave = true; break;
    case STRUT_OPTION_OWN_MODEL: to->own_model = true; break;
    case STRUT_OPTION_ALL: to->all = true; break;
    case STRUT_OPTION_CSV: to->csv = true; break;
    case STRUT_OPTION_NO_MOTION: to->no_motion = true; break;
    case STRUT_OPTION_NO_STATES: to->no_states = true; break;
    case STRUT_OPTION_COUNT_POINTS: to->count_points = true; break;
    case STRUT_OPTION_STATUS: to->status = true; break;
    case STRUT_OPTION_RETRY: to->retry = true; break;
    case STRUT_OPTION_PARTS: to->parts = true; break;
    case STRUT_OPTION_STUDY: to->study = true; break;
    case STRUT_OPTION_BASINS: to->basins = true; break;
    case STRUT_OPTION_HELP: to->help = true; break;
    default: break;
  }
  return STRUT_OK;
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
    rows[i] = (struct option){option->name, needs, NULL, (int)option->id};
    if ((int)option->id >= FIRST_WITHOUT_LETTER) continue;
    *at++ = (char)option->id;
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
  *arguments = (strut_arguments){.listener = strut_stderr_listener()};
  arguments->overrides = strut_allocate((size_t)argc, sizeof *arguments->overrides);
  arguments->override_model = strut_allocate((size_t)argc, sizeof *arguments->override_model);
  arguments->varied = strut_allocate((size_t)argc, sizeof *arguments->varied);
  arguments->models = strut_allocate((size_t)argc, sizeof *arguments->models);
  if (!arguments->overrides || !arguments->override_model || !arguments->varied ||
      !arguments->models) {
    fprintf(stderr, "strut %s: out of memory\n", command->name);
    return STRUT_NO_MEMORY;
  }
  strut_status status = STRUT_OK;
  opterr = 0;
  while (status == STRUT_OK) {
    int row = -1, id = getopt_long(argc, argv, letters, rows, &row);
    if (id == -1) break;
    if (id == '?' || id == ':') {
      status = report_rejected(command, id, argv);
    } else if (row >= 0 && is_abbreviated(argv, &rows[row])) {
      const char *word = argv[optind - (rows[row].has_arg && optarg == argv[optind - 1] ? 2 : 1)];
      status = unknown_option(command, word, rows[row].name);
    } else {
      status = store_option(command, id, arguments);
    }
  }
  for (; status == STRUT_OK && optind < argc; optind++) { /* after "--" */
    status = add_model(command, argv[optind], arguments);
  }
  bool missing = command->model && !command->model_optional && !arguments->model;
  if (status == STRUT_OK && missing && !arguments->help) {
    fprintf(stderr, "strut %s: missing %s\n", command->name, command->model);
    status = usage_error(command);
  }
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
  if ((int)option->id < FIRST_WITHOUT_LETTER) {
    snprintf(letter, sizeof letter, "-%c, ", (char)option->id);
  }
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
  strut_file file;
  strut_error error = {0};
  strut_status status = strut_canvas_check_name(path, &error);
  if (status == STRUT_OK) status = strut_file_open_path(&file, path, &error);
  if (status == STRUT_OK) {
    strut_file_abandon(&file);
  } else {
    strut_print_error(&error);
  }
  return status;
}

/* Reports the first option of a figure that was given without --plot. */
static strut_status refuse_without_plot(const strut_command *command,
                                        const strut_arguments *arguments) {
  for (const strut_option *o = command->options; o->id != STRUT_OPTION_END; o++) {
    bool figure = o->id == STRUT_OPTION_WIDTH || o->id == STRUT_OPTION_DRAW ||
                  (o->id >= STRUT_OPTION_TITLE && o->id <= STRUT_OPTION_Y_LIMITS);
    if (!figure || !strut_option_text(arguments, o->id)) continue;
    fprintf(stderr, "strut %s: --%s needs --plot FILE\n", command->name, o->name);
    return STRUT_USAGE;
  }
  return STRUT_OK;
}

strut_status strut_plot_read(const strut_command *command, const strut_arguments *arguments,
                             double usual, strut_plot *plot) {
  *plot = (strut_plot){.path = strut_option_text(arguments, STRUT_OPTION_PLOT)};
  if (!plot->path) return refuse_without_plot(command, arguments);
  strut_status status = strut_plot_settings_read(command, arguments, usual, plot);
  return status == STRUT_OK ? try_path(plot->path) : status;
}
