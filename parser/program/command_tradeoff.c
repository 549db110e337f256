/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/mixed_bits.h"
#include "engine/base/text.h"
#include "engine/study/tradeoff/tradeoff.h"
#include "parser/program/command/analyses.h"

/* ---- operating points: parameters drawn at random, the same from the same seed ---- */

enum { MOST_TEXT = 400, MOST_METHODS = 64 };
#define USUAL_POINTS 40
#define USUAL_SEED 1
#define PAGE 510.24 /* 180 mm [pt] */

/* A study, and the scenes of one model that it is of. */
typedef struct tradeoff_study {
  strut_tradeoff_options options;
  const strut_integrator *methods[MOST_METHODS];
  strut_setup *setups;      /* (count) in the arena, as below */
  const strut_setup **list; /* (count) them */
  size_t count;
  strut_arena arena;
  strut_tradeoff result;
} tradeoff_study;

static size_t word_count(const char *text) {
  size_t count = 1;
  for (; *text; text++) count += *text == ',';
  return count;
}

/* Writes the value at the fraction u of a range, as an expression, or the word at u. */
static bool write_drawn_value(const char *range, double u, char text[MOST_TEXT]) {
  const char *dots = strstr(range, "..");
  int used;
  if (dots) {
    int low = (int)(dots - range);
    strut_c_locale locale = strut_c_locale_enter();
    used = snprintf(text, MOST_TEXT, "(%.*s) + %.17g*((%s) - (%.*s))", low, range, u, dots + 2, low,
                    range);
    strut_c_locale_leave(locale);
  } else {
    size_t wanted = (size_t)(u * (double)word_count(range));
    const char *word = range;
    while (wanted-- > 0) word = strchr(word, ',') + 1;
    used = snprintf(text, MOST_TEXT, "%.*s", (int)strcspn(word, ","), word);
  }
  return used > 0 && used < MOST_TEXT;
}

/* Checks NAME=LOW..HIGH or NAME=WORD,WORD. */
static strut_status check_varied(const strut_arguments *arguments, const strut_setting *varied) {
  const char *value = varied->text, *dots = strstr(value, "..");
  bool good = dots ? dots > value && dots[2] : *value && *value != ',';
  for (const char *c = value; *c && !dots; c++)
    good = good && !(*c == ',' && (c[1] == ',' || c[1] == '\0'));
  if (good && strlen(value) < MOST_TEXT / 3) return STRUT_OK;
  return strut_usage_error(arguments,
                           "--vary expects NAME=LOW..HIGH or NAME=WORD,WORD,... and not '%s=%s'",
                           varied->name, value);
}

/* Are all that vary parameters of the model? */
static strut_status check_names(const strut_arguments *arguments) {
  strut_setup setup;
  strut_arguments quiet = *arguments;
  quiet.no_notes = true;
  strut_status status = strut_open_model(&quiet, STRUT_OPEN_FOR_ANY, &setup, NULL);
  if (status) return status;
  const strut_named_rows *names = STRUT_NAMED(setup.scene.parameters, setup.scene.parameter_count);
  for (size_t i = 0; i < arguments->varied_count && !status; i++) {
    const char *name = arguments->varied[i].name;
    if (strut_parameter_named(&setup.scene, name)) continue;
    strut_usage_error(arguments, "--vary %s: the model has no such parameter%s", name,
                      strut_near_to(name, strut_row_name, names).text);
    status = STRUT_BAD_SCENE;
  }
  strut_setup_free(&setup);
  return status;
}

static strut_status open_point(const strut_arguments *arguments, uint64_t *seed, size_t number,
                               strut_setup *setup) {
  size_t varied = arguments->varied_count, set = arguments->override_count;
  strut_setting *overrides = strut_allocate(set + varied + 1, sizeof *overrides);
  char(*texts)[MOST_TEXT] = strut_allocate(varied + 1, sizeof *texts);
  strut_status status = overrides && texts ? STRUT_OK : strut_print_out_of_memory();
  for (size_t i = 0; i < set && status == STRUT_OK; i++) overrides[i] = arguments->overrides[i];
  for (size_t i = 0; i < varied && status == STRUT_OK; i++) {
    write_drawn_value(arguments->varied[i].text, strut_draw_uniform(seed), texts[i]);
    overrides[set + i] = (strut_setting){.name = arguments->varied[i].name, .text = texts[i]};
  }
  if (status == STRUT_OK) {
    strut_arguments here = *arguments;
    here.overrides = overrides;
    here.override_count = set + varied;
    here.no_notes = number > 0;
    status = strut_open_model(&here, STRUT_OPEN_FOR_RUN, setup, NULL);
    if (status != STRUT_OK && varied > 0) {
      fprintf(stderr, "strut tradeoff: at operating point %zu:", number + 1);
      for (size_t i = 0; i < varied; i++)
        fprintf(stderr, " --set '%s=%s'", overrides[set + i].name, overrides[set + i].text);
      fputc('\n', stderr);
    }
  }
  strut_release(overrides);
  strut_release(texts);
  return status;
}

static strut_status open_points(const strut_arguments *arguments, tradeoff_study *study) {
  uint64_t seed = arguments->seed.text ? (uint64_t)arguments->seed.value : USUAL_SEED;
  const size_t given = arguments->points.text ? (size_t)arguments->points.value : USUAL_POINTS;
  const size_t count = arguments->varied_count ? given : 1;
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < arguments->varied_count && status == STRUT_OK; i++)
    status = check_varied(arguments, &arguments->varied[i]);
  if (status == STRUT_OK && count > 1 && strcmp(arguments->model, "-") == 0)
    status = strut_usage_error(arguments, "operating points need a model file, not standard input");
  if (status == STRUT_OK && arguments->varied_count && strcmp(arguments->model, "-") != 0)
    status = check_names(arguments);
  if (status != STRUT_OK) return status;
  study->setups = strut_arena_allocate(&study->arena, count, sizeof *study->setups);
  study->list = strut_arena_allocate(&study->arena, count, sizeof *study->list);
  if (!study->setups || !study->list) return strut_print_out_of_memory();
  for (size_t p = 0; p < count && status == STRUT_OK; p++) {
    status = open_point(arguments, &seed, p, &study->setups[p]);
    study->list[p] = &study->setups[p];
    if (status == STRUT_OK) study->count++;
  }
  return status;
}

static const strut_option options[] = {
    {STRUT_FILLS(accuracy), "accuracy", "X",
     "recommend method and step for a relative error of X, such as 0.1%", STRUT_ACCURACY_RANGE},
    {STRUT_FILLS(measure), "measure", "WHAT",
     "measured quantity: velocity, position or energy (default automatic)",
     .words = "velocity|position|energy"},
    {STRUT_FILLS_TEXT(integrator), "integrator", "NAME,...",
     "only these methods, such as rk4,verlet-events", .words = STRUT_INTEGRATOR_WORDS},
    {STRUT_FILLS(step_sizes), "step-sizes", "N",
     "steps per method, five per decade (default " STRUT_TEXT_OF(
         STRUT_TRADEOFF_USUAL_STEPS) ", or as many as --accuracy takes)",
     .least = 1, .most = STRUT_TRADEOFF_MOST_STEPS},
    {STRUT_FILLS(periods), "periods", "N",
     "maximum number of periods of a run (default " STRUT_TEXT_OF(STRUT_TRADEOFF_USUAL_PERIODS) ")",
     .low = 1, .high = 1e7},
    {STRUT_FILLS(varied), "vary", "NAME=RANGE",
     "draw a parameter at random: LOW..HIGH or WORD,WORD; may be repeated"},
    {STRUT_FILLS(points), "points", "N",
     "number of points drawn with --vary (default " STRUT_TEXT_OF(USUAL_POINTS) ")", .least = 1,
     .most = 10000},
    {STRUT_FILLS(seed), "seed", "N",
     "seed of the random points (default " STRUT_TEXT_OF(USUAL_SEED) ")", .most = INT64_MAX / 10},
    {STRUT_FILLS(cpu_time), "cpu-time", "TIME",
     "begin no run after this CPU time (default " STRUT_TEXT_OF(STRUT_TRADEOFF_USUAL_BUDGET) " s)",
     .measure = STRUT_MEASURE_TIME, .low = 1e-3, .high = 1e7},
    {STRUT_FILLS(own_model), "own-model", NULL, "skip variants of the model"},
    STRUT_SET_OPTION,
    STRUT_OUTPUT_OPTION("DIR", "write tradeoff.csv, .json and .svg into DIR"),
    STRUT_PRINT_OPTIONS,
    STRUT_THREADS_OPTION,
    {STRUT_FILLS(plot), "plot", "FILE",
     "draw error against cost into FILE (.svg, .pdf, .png or .json)"},
    {.table = strut_width_options},
    {.name = NULL},
};

static strut_status draw(const strut_analysis *analysis, const strut_plot *plot,
                         strut_error *error) {
  return strut_tradeoff_figure(plot, analysis->found, error);
}

static const strut_output_file files[] = {{.name = "tradeoff.csv", .list = "settings"},
                                          {.name = "tradeoff.json"},
                                          {.name = "tradeoff.svg", .draw = draw, .width = PAGE},
                                          {.name = NULL}};

static strut_status read_methods(const strut_arguments *arguments, tradeoff_study *self) {
  const char *text = arguments->integrator.text;
  char list[500], name[40];
  while (text) {
    int length = (int)strcspn(text, ",");
    snprintf(name, sizeof name, "%.*s", length, text);
    const strut_integrator *found = strut_integrator_find(name);
    if (!found || self->options.method_count == MOST_METHODS)
      return strut_usage_error(arguments, "--integrator: unknown method '%.*s'; expected %s",
                               length, text,
                               strut_words_text(STRUT_INTEGRATOR_WORDS, list, sizeof list));
    self->methods[self->options.method_count++] = found;
    text = text[length] ? text + length + 1 : NULL;
  }
  self->options.methods = self->methods;
  return STRUT_OK;
}

static strut_status read_options(const strut_arguments *arguments, tradeoff_study *self) {
  self->options.steps = (int)arguments->step_sizes.value;
  self->options.measure =
      (strut_tradeoff_measure)(arguments->measure.text ? arguments->measure.index + 1 : 0);
  self->options.periods = arguments->periods.value;
  self->options.budget = arguments->cpu_time.value;
  self->options.accuracy = arguments->accuracy.value;
  self->options.own_model = arguments->own_model;
  if (arguments->varied_count == 0 && (arguments->points.text || arguments->seed.text))
    return strut_usage_error(arguments, "--points and --seed need --vary");
  return read_methods(arguments, self);
}

static strut_status open_study(strut_analysis *analysis, char **text) {
  tradeoff_study *study = analysis->result.own = strut_allocate(1, sizeof *study);
  (void)text;
  analysis->setup = NULL;
  if (!study) return strut_print_out_of_memory();
  strut_status status = read_options(analysis->arguments, study);
  return status ? status : open_points(analysis->arguments, study);
}

static strut_status measure(strut_analysis *analysis, strut_error *error) {
  tradeoff_study *study = analysis->result.own;
  study->options.interrupt = analysis->interrupt;
  study->options.progress = analysis->progress;
  study->options.progress_context = analysis->progress_context;
  analysis->found = &study->result;
  analysis->scene = &study->setups[0].scene;
  return strut_tradeoff_make(study->list, study->count, &study->options, &study->result, error);
}

static void free_study(strut_analysis *analysis) {
  tradeoff_study *study = analysis->result.own;
  if (!study) return;
  for (size_t p = 0; p < study->count; p++) strut_setup_free(&study->setups[p]);
  strut_tradeoff_free(&study->result);
  strut_arena_free(&study->arena);
  strut_release(study);
}

static const strut_analysis_kind tradeoff_analysis = {.files = files,
                                                      .rows = &strut_tradeoff_values,
                                                      .width = PAGE,
                                                      .uncompiled = true,
                                                      .asks = true,
                                                      .compute = measure,
                                                      .draw = draw,
                                                      .release = free_study};

static const strut_refused_option refused[] = {
    {"step", "it runs each method with many steps; --step-sizes says how many"}, {NULL, NULL}};

static const char tradeoff_details[] =
    "\nRuns the model with every method, with steps from above the stability limit downwards,\n"
    "and as variants (lumped masses, rigid bars, other laws of friction and ground), as far as\n"
    "they apply. Errors are relative to references on which two methods agree; their remaining\n"
    "difference is the floor of all errors. Costs are force evaluations relative to rk4 with the\n"
    "scene's step; CPU times are as measured here, and decide nothing. The step error of a run is\n"
    "kept apart from the model error of a variant.\n"
    "Ends with the cheapest setting for each error, or for that of --accuracy with the cost of\n"
    "half the error and how well the reference is known. Work is at most 30 reference runs.\n"
    "With --vary, errors are median, 90th percentile and worst over random points, since a\n"
    "single small error at a large step may be luck.\n";

const strut_command strut_command_tradeoff = {
    .name = "tradeoff",
    .model = "MODEL",
    .summary = "measures error against cost of methods, steps and model variants",
    .details = tradeoff_details,
    .options = options,
    .analysis = &tradeoff_analysis,
    .open = open_study,
    .refused = refused,
    .timed = true,
};
