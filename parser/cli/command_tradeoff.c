/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/commands.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "engine/output/results.h"
#include "engine/study/tradeoff/tradeoff.h"
#include "engine/study/tradeoff/tradeoff_figure.h"
#include "engine/study/tradeoff/tradeoff_report.h"
#include "parser/cli/interrupt.h"
#include "parser/cli/operating_points.h"
#include "parser/cli/option_values.h"
#include "parser/cli/progress.h"
#include "parser/cli/streams.h"

enum { MOST_METHODS = 64, MOST_POINTS = 10000, USUAL_POINTS = 40 };
static const double PAGE = 510.24; /* 180 mm [pt] */
static const double LEAST_BUDGET = 1e-3, MOST_BUDGET = 1e7, MOST_PERIODS = 1e7;

static const strut_option options[] = {
    {STRUT_OPTION_MEASURE, "measure", "WHAT", "velocity, position or energy"},
    {STRUT_OPTION_METHODS, "methods", "LIST", "only these, such as rk4,verlet-events"},
    {STRUT_OPTION_STEPS, "steps", "N", "of each method, five in a decade; 8 if not given"},
    {STRUT_OPTION_PERIODS, "periods", "N", "of a run given in periods, at most; 120 if not given"},
    {STRUT_OPTION_VARY, "vary", "NAME=RANGE",
     "draw a parameter: LOW..HIGH, or WORD,WORD; may be "
     "repeated"},
    {STRUT_OPTION_POINTS, "points", "N", "drawn with --vary; 40 if not given"},
    {STRUT_OPTION_SEED, "seed", "N", "of what is drawn; 1 if not given"},
    {STRUT_OPTION_BUDGET, "budget", "TIME", "CPU time to spend about; 2 min if not given"},
    {STRUT_OPTION_OWN_MODEL, "own-model", NULL, "leave out other models of the scene"},
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "give a parameter another value; may be repeated"},
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write tradeoff.csv, .json and .svg into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static const char *const file_names[] = {"tradeoff.csv", "tradeoff.json", "tradeoff.svg", NULL};

/* Options as read. */
typedef struct wishes {
  strut_tradeoff_options study;
  const strut_integrator *methods[MOST_METHODS];
  size_t points;
  uint64_t seed;
} wishes;

static strut_status bad_method(const char *name, int length) {
  fprintf(stderr, "strut tradeoff: --methods: there is no method '%.*s'; there are", length, name);
  for (size_t i = 0; strut_integrator_at(i); i++)
    fprintf(stderr, "%s %s", i ? "," : "", strut_integrator_at(i)->name);
  fputc('\n', stderr);
  return STRUT_USAGE;
}

static strut_status read_methods(const strut_arguments *arguments, wishes *w) {
  const char *text = strut_option_text(arguments, STRUT_OPTION_METHODS);
  while (text) {
    size_t length = strcspn(text, ",");
    const strut_integrator *found = NULL;
    for (size_t i = 0; strut_integrator_at(i); i++) {
      const char *name = strut_integrator_at(i)->name;
      if (strlen(name) == length && strncmp(name, text, length) == 0)
        found = strut_integrator_at(i);
    }
    if (!found || w->study.method_count == MOST_METHODS) return bad_method(text, (int)length);
    w->methods[w->study.method_count++] = found;
    text = text[length] ? text + length + 1 : NULL;
  }
  w->study.methods = w->methods;
  return STRUT_OK;
}

static strut_status check_positive(const char *name, double value, double least, double most) {
  if (value == 0 || (value >= least && value <= most)) return STRUT_OK;
  fprintf(stderr, "strut tradeoff: --%s is from %g to %g\n", name, least, most);
  return STRUT_USAGE;
}

static strut_status read_numbers(const strut_arguments *arguments, wishes *w) {
  const strut_command *command = &strut_command_tradeoff;
  static const char *const measures[] = {"velocity", "position", "energy", NULL};
  int64_t steps = 0, seed = 1, points = arguments->varied_count > 0 ? USUAL_POINTS : 1;
  int measure = -1;
  strut_status status =
      strut_option_word(command, arguments, STRUT_OPTION_MEASURE, measures, &measure);
  if (status == STRUT_OK)
    status = strut_option_integer(command, arguments, STRUT_OPTION_STEPS, 1,
                                  STRUT_TRADEOFF_MOST_STEPS, &steps);
  if (status == STRUT_OK)
    status = strut_option_integer(command, arguments, STRUT_OPTION_SEED, 0, INT64_MAX / 10, &seed);
  if (status == STRUT_OK)
    status = strut_option_integer(command, arguments, STRUT_OPTION_POINTS, 1, MOST_POINTS, &points);
  if (status == STRUT_OK)
    status = strut_option_number(command, arguments, STRUT_OPTION_PERIODS, STRUT_DIM_NONE,
                                 &w->study.periods);
  if (status == STRUT_OK)
    status = strut_option_number(command, arguments, STRUT_OPTION_BUDGET, STRUT_DIM_TIME,
                                 &w->study.budget);
  if (status == STRUT_OK) status = check_positive("periods", w->study.periods, 1, MOST_PERIODS);
  if (status == STRUT_OK)
    status = check_positive("budget", w->study.budget, LEAST_BUDGET, MOST_BUDGET);
  w->study.steps = (int)steps;
  w->study.measure = (strut_tradeoff_measure)(measure + 1);
  w->points = (size_t)points;
  w->seed = (uint64_t)seed;
  return status;
}

static strut_status read_options(const strut_arguments *arguments, wishes *w) {
  strut_status status = read_numbers(arguments, w);
  if (status == STRUT_OK) status = read_methods(arguments, w);
  if (status != STRUT_OK) return status;
  w->study.own_model = arguments->own_model;
  if (arguments->varied_count == 0 && (strut_option_text(arguments, STRUT_OPTION_POINTS) ||
                                       strut_option_text(arguments, STRUT_OPTION_SEED))) {
    fputs("strut tradeoff: --points and --seed belong to what --vary draws: give that too\n",
          stderr);
    return STRUT_USAGE;
  }
  return STRUT_OK;
}

/* All three, or none. */
static strut_status write_files(const char *stage, const strut_tradeoff *result, const char *json,
                                strut_error *error) {
  char path[4096];
  strut_status status =
      strut_file_write_block(stage, "tradeoff.csv", strut_tradeoff_csv(result), error);
  if (status == STRUT_OK) status = strut_file_write_text(stage, "tradeoff.json", json, error);
  int used = snprintf(path, sizeof path, "%s/tradeoff.svg", stage);
  if (status == STRUT_OK && used >= (int)sizeof path)
    status =
        strut_fail(error, STRUT_FILE_TROUBLE, "cannot write '%s': the path is too long", stage);
  return status == STRUT_OK ? strut_tradeoff_figure(path, PAGE, result, error) : status;
}

static strut_status show(const strut_arguments *arguments, const strut_tradeoff *result,
                         const char *json) {
  if (arguments->json) return strut_print(json);
  if (arguments->quiet) return STRUT_OK;
  return strut_print_block(strut_tradeoff_table(result));
}

static strut_status report(const strut_arguments *arguments, strut_results *files,
                           const strut_tradeoff *result, const strut_operating_points *points) {
  strut_error error = {0};
  char *json = strut_tradeoff_json(result, points->list);
  if (!json) return strut_print_out_of_memory();
  strut_status status = STRUT_OK;
  if (files->stage) {
    status = write_files(files->stage, result, json, &error);
    if (status == STRUT_OK) status = strut_results_commit(files, &error);
    if (status != STRUT_OK) strut_print_error(&error);
  }
  if (status == STRUT_OK) status = show(arguments, result, json);
  strut_release(json);
  return status;
}

static strut_status study(const strut_arguments *arguments, wishes *w,
                          const strut_operating_points *points) {
  strut_results files = {0};
  strut_tradeoff result = {.name = ""};
  strut_error error = {0};
  w->study.interrupt = strut_interrupt_watch(); /* before there are files */
  strut_status status = STRUT_OK;
  if (arguments->output)
    status = strut_results_begin_named(&files, arguments->output, file_names, &error);
  if (status == STRUT_OK) {
    strut_progress progress = strut_progress_begin(arguments->quiet);
    w->study.progress = progress.wanted ? strut_progress_show : NULL;
    w->study.progress_context = &progress;
    status = strut_tradeoff_make(points->list, points->count, &w->study, &result, &error);
    strut_progress_end(&progress);
  }
  if (status == STRUT_OK)
    status = report(arguments, &files, &result, points);
  else
    strut_print_error(&error);
  strut_tradeoff_free(&result);
  strut_results_abandon(&files); /* nothing where they are complete */
  return status;
}

static strut_status run(const strut_arguments *arguments) {
  wishes w = {.points = 1};
  strut_operating_points points = {0};
  strut_status status = read_options(arguments, &w);
  if (status == STRUT_OK)
    status =
        strut_operating_points_open(&strut_command_tradeoff, arguments, w.points, w.seed, &points);
  if (status != STRUT_OK) return status;
  status = study(arguments, &w, &points);
  strut_operating_points_free(&points);
  return status;
}

const strut_command strut_command_tradeoff = {
    .name = "tradeoff",
    .model = "MODEL",
    .summary = "measures what accuracy costs, by method and step",
    .details =
        "\nRuns the model's experiment with every method, with steps from above the largest\n"
        "stable one down, and with other models of it (lumped masses, rigid bars, laws of\n"
        "friction and of the ground), each as far as the scene has what they change. Errors are\n"
        "against references on which two methods agree; how far these differ is the floor below\n"
        "which no error is told. Costs are relative to rk4 with the scene's step: evaluations of\n"
        "the forces, and CPU time as measured here. The step error of a run is kept apart from\n"
        "the model error of another model. Ends with advice.\n"
        "With --vary errors are medians, 90th percentiles and worst over points drawn at random:\n"
        "one small error at a large step is luck.\n",
    .options = options,
    .run = run,
    .timed = true,
};
