/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/commands.h"

#include <stdio.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "engine/output/results.h"
#include "engine/study/compare/compare_figure.h"
#include "engine/study/compare/compare_report.h"
#include "parser/cli/interrupt.h"
#include "parser/cli/open_compared.h"
#include "parser/cli/option_values.h"
#include "parser/cli/plot_options.h"
#include "parser/cli/progress.h"
#include "parser/cli/streams.h"
#include "parser/cli/terminal.h"

enum { USUAL_COLUMNS = 100, FIXED_FILES = 3, FILE_NAME = 24, PATH = 4096 };
static const double PAGE = 510.24, ONE = 249.45; /* 180 mm, 88 mm [pt] */

static const strut_option options[] = {
    {STRUT_OPTION_SET, "set", "NAME=VALUE",
     "change a parameter: of every model that has it, or behind a MODEL of that one only"},
    {STRUT_OPTION_ACCURACY, "accuracy", "X", "of velocities, such as 1%; 0.5% if not given"},
    {STRUT_OPTION_NO_MOTION, "no-motion", NULL, "leave out runs"},
    {STRUT_OPTION_NO_STATES, "no-states", NULL, "leave out the search for stable states"},
    {STRUT_OPTION_OUTPUT, "output", "DIR",
     "write compare.csv, .json and .svg, and model-1.svg and so on, into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    {STRUT_OPTION_CSV, "csv", NULL, "print CSV, a row for each model"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

/* Names of all files that a comparison may leave in its directory. */
typedef struct file_names {
  char pictures[STRUT_COMPARE_MOST][FILE_NAME];
  const char *list[STRUT_COMPARE_MOST + FIXED_FILES + 1];
} file_names;

static void fill_names(file_names *names) {
  names->list[0] = "compare.csv";
  names->list[1] = "compare.json";
  names->list[2] = "compare.svg";
  for (int i = 0; i < STRUT_COMPARE_MOST; i++) {
    snprintf(names->pictures[i], FILE_NAME, "model-%d.svg", i + 1);
    names->list[FIXED_FILES + i] = names->pictures[i];
  }
  names->list[STRUT_COMPARE_MOST + FIXED_FILES] = NULL;
}

static strut_status draw(const char *stage, const char *name, double width,
                         const strut_compare *result, size_t first, size_t count,
                         strut_error *error) {
  char path[PATH];
  if (snprintf(path, sizeof path, "%s/%s", stage, name) >= (int)sizeof path)
    return strut_fail(error, STRUT_FILE_TROUBLE, "cannot write '%s': the path is too long", name);
  return strut_compare_figure(path, width, result, first, count, error);
}

/* All of them, or none. */
static strut_status write_files(strut_results *files, const file_names *names,
                                const strut_compare *result) {
  strut_error error = {0};
  if (!files->stage) return STRUT_OK;
  strut_status status =
      strut_file_write_block(files->stage, "compare.csv", strut_compare_csv(result), &error);
  if (status == STRUT_OK)
    status =
        strut_file_write_block(files->stage, "compare.json", strut_compare_json(result), &error);
  if (status == STRUT_OK)
    status = draw(files->stage, "compare.svg", PAGE, result, 0, result->count, &error);
  for (size_t i = 0; i < result->count && status == STRUT_OK; i++)
    status = draw(files->stage, names->pictures[i], ONE, result, i, 1, &error);
  if (status == STRUT_OK) status = strut_results_commit(files, &error);
  if (status != STRUT_OK) strut_print_error(&error);
  return status;
}

static strut_status show(const strut_arguments *arguments, const strut_compare *result) {
  if (arguments->quiet && !arguments->json && !arguments->csv) return STRUT_OK;
  char *text = arguments->json  ? strut_compare_json(result)
               : arguments->csv ? strut_compare_csv(result)
                                : strut_compare_table(
                                      result, strut_terminal_columns(STDOUT_FILENO, USUAL_COLUMNS));
  return strut_print_block(text);
}

/* Repeats on stderr what could not be computed. */
static strut_status report_failures(const strut_compare *result) {
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < result->count; i++) {
    const strut_compare_column *c = &result->columns[i];
    strut_error error = {0};
    if (c->status == STRUT_OK) continue;
    strut_fail(&error, c->status, "%s: %s", c->input->label, c->message);
    strut_print_error(&error);
    if (status == STRUT_OK) status = c->status;
  }
  return status;
}

static strut_status compare(const strut_arguments *arguments, const strut_plot *plot,
                            strut_compare_options *wanted, const strut_compared *models) {
  strut_results files = {0};
  strut_compare result = {0};
  strut_error error = {0};
  file_names names;
  fill_names(&names);
  wanted->interrupt = strut_interrupt_watch(); /* before there are files */
  strut_status status = STRUT_OK;
  if (arguments->output)
    status = strut_results_begin_named(&files, arguments->output, names.list, &error);
  if (status == STRUT_OK) {
    strut_progress progress = strut_progress_begin(arguments->quiet);
    wanted->progress = progress.wanted ? strut_progress_show : NULL;
    wanted->progress_context = &progress;
    status = strut_compare_make(models->inputs, models->count, wanted, &result, &error);
    strut_progress_end(&progress);
  }
  if (status != STRUT_OK) {
    strut_print_error(&error);
  } else {
    status = write_files(&files, &names, &result);
    if (status == STRUT_OK) status = show(arguments, &result);
    if (status == STRUT_OK && plot->path) {
      status = strut_compare_figure(plot->path, plot->width, &result, 0, result.count, &error);
      if (status != STRUT_OK) strut_print_error(&error);
    }
    if (status == STRUT_OK) status = report_failures(&result);
  }
  strut_compare_free(&result);
  strut_results_abandon(&files); /* nothing where they are complete */
  return status;
}

static strut_status read_options(const strut_arguments *arguments, strut_plot *plot,
                                 strut_compare_options *wanted) {
  strut_status status = strut_plot_read(&strut_command_compare, arguments, 0, plot);
  if (status == STRUT_OK)
    status = strut_option_number(&strut_command_compare, arguments, STRUT_OPTION_ACCURACY,
                                 STRUT_DIM_NONE, &wanted->accuracy);
  if (status != STRUT_OK) return status;
  bool given = strut_option_text(arguments, STRUT_OPTION_ACCURACY);
  if (given && !(wanted->accuracy > 0.0 && wanted->accuracy <= 1.0)) {
    fputs("strut compare: --accuracy must be above 0 and at most 1, that is 100%\n", stderr);
    return STRUT_USAGE;
  }
  if (arguments->json && arguments->csv) {
    fputs("strut compare: --json and --csv are two ways to print: give one of them\n", stderr);
    return STRUT_USAGE;
  }
  wanted->no_motion = arguments->no_motion;
  wanted->no_states = arguments->no_states;
  return STRUT_OK;
}

static strut_status run(const strut_arguments *arguments) {
  strut_compare_options wanted = {.accuracy = 0.0};
  strut_compared models;
  strut_plot plot;
  strut_status status = read_options(arguments, &plot, &wanted);
  if (status == STRUT_OK) status = strut_compared_open(&strut_command_compare, arguments, &models);
  if (status != STRUT_OK) return status;
  status = compare(arguments, &plot, &wanted, &models);
  strut_compared_free(&models);
  return status;
}

const strut_command strut_command_compare = {
    .name = "compare",
    .model = "MODEL...",
    .many = true,
    .summary = "puts structures side by side: how they are built, stand and move",
    .details =
        "\nFor each model what check, rigidity, equilibria, modes and run would say of it alone:\n"
        "counts, mass, self-stress, mechanisms; stable states and the lowest way out of the one "
        "it\n"
        "starts in; forces, frequencies and stiffness at rest, every node under a unit load in x\n"
        "and y, contacts held; largest step; and, where it has a run, velocity, travel per "
        "period,\n"
        "drive energy, cost of transport (drive power over weight times speed) and contact duty "
        "of\n"
        "the steady motion, with what a simulated second costs.\n"
        "Then how the effective scenes differ from the first: + added, - removed, ~ changed.\n"
        "Missing values are '-', left empty in CSV, and null with a reason in JSON.\n"
        "'strut compare m.yaml m.yaml --set mu=0.2' compares a model with a variant of itself.\n",
    .options = options,
    .run = run,
    .timed = true,
};
