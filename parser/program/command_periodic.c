/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/output/figures/table_figure.h"
#include "engine/output/result_values.h"
#include "engine/scene/things.h"
#include "engine/study/follow/follow_study.h"
#include "engine/study/sweep/sweep.h"
#include "parser/program/command/analyses.h"
#include "parser/program/command/scene_options.h"

#define RANGE .expected = "NAME=LOW..HIGH, such as frequency=8Hz..12Hz"

static const strut_option options[] = {
    {.kind = STRUT_OPTION_SELECTOR,
     .name = "periodic",
     NULL,
     "follow periodic motions instead of equilibria"},
    {STRUT_FILLS(over), "over", "NAME=LOW..HIGH", "the parameter and its range", RANGE},
    {STRUT_FILLS(from), "from", "VALUE", "low end of the range, if --over gives none"},
    {STRUT_FILLS(until), "until", "VALUE", "high end, likewise"},
    {STRUT_FILLS(and_over), "and", "NAME=LOW..HIGH",
     "a second parameter, over which curves of folds, doublings and grazings are followed", RANGE},
    {STRUT_FILLS(values), "values", "VALUE,...",
     "values at which branches start (default: the model's own, or the middle)"},
    {STRUT_FILLS(at), "at", "NAME,...", "configurations to start from (default: the start)"},
    {STRUT_FILLS(accuracy), "accuracy", "E",
     "relative error of velocities (default " STRUT_TEXT_OF(STRUT_FOLLOW_USUAL_PERCENT) " %)",
     .limits = STRUT_LIMITS_SHARE(STRUT_FOLLOW_MOST_ACCURACY)},
    {STRUT_FILLS_TEXT(integrator), "integrator", "NAME",
     "method, which must locate events (default: rk4-events, or else adaptive)",
     .words = STRUT_INTEGRATOR_WORDS},
    {STRUT_FILLS(steps), "steps", "N",
     "maximum number of steps each way (default " STRUT_TEXT_OF(
         STRUT_FOLLOW_USUAL_STEPS) ", of curves " STRUT_TEXT_OF(STRUT_FOLLOW_USUAL_CURVE_STEPS) ")",
     .least = 1, .most = 100000},
    {STRUT_FILLS(basins), "basins", NULL, "kick the stable motions at the values of --values"},
    STRUT_SET_OPTION,
    STRUT_THREADS_OPTION,
    STRUT_OUTPUT_OPTION("DIR", "write branches.csv, .json and .svg into DIR"),
    STRUT_PRINT_OPTIONS,
    {.table = strut_plot_options},
    {.table = strut_axis_options},
    {.name = NULL},
};

enum { MOST_AT = 8, MOST_STARTS = 64 };

/* Scenes over the parameter, and the options that refer to them. Must not move. */
typedef struct follow_source {
  strut_varied_scenes scenes;
  char from[1024]; /* names of configurations */
  strut_follow_start starts[MOST_STARTS];
} follow_source;

/* A range whose ends may be those of --from and --until. */
typedef struct followed {
  const char *option; /* "--over" */
  const strut_given_range *given;
  const char *low, *high;
} followed;

/* The name must be that of a number of the scene. */
static strut_status check_range(const strut_arguments *arguments, const strut_scene *scene,
                                const followed *self) {
  const bool apart = self->given == &arguments->over && (arguments->from || arguments->until);
  const char *name = self->given->name;
  if (!self->given->text || !self->low || !self->high || (apart && self->given->high))
    return strut_usage_error(
        arguments, "missing %s NAME=LOW..HIGH, such as %s frequency=8Hz..12Hz%s", self->option,
        self->option, apart ? ", or --over NAME, --from and --until" : "");
  const strut_parameter *parameter = strut_parameter_named(scene, name);
  if (!parameter)
    return strut_usage_error(
        arguments, "%s: the model has no parameter '%s'%s", self->option, name,
        strut_near_to(name, strut_row_name, STRUT_NAMED(scene->parameters, scene->parameter_count))
            .text);
  if (!isfinite(parameter->value))
    return strut_usage_error(arguments, "%s: parameter '%s' is a text, expected a number",
                             self->option, name);
  return STRUT_OK;
}

static strut_status read_ends(const strut_arguments *arguments, const followed *self,
                              strut_dimension dimension, double *low, double *high) {
  if (strut_quantities_read(self->low, dimension, low, 1) == 1 &&
      strut_quantities_read(self->high, dimension, high, 1) == 1 && *low < *high &&
      isfinite(*low) && isfinite(*high))
    return STRUT_OK;
  const char *example = strut_dimension_example(dimension);
  return strut_usage_error(
      arguments, "%s %s: expected two values LOW..HIGH, the lower one first%s%s", self->option,
      self->given->name, example ? ", each such as " : "", example ? example : "");
}

static strut_status setup_at(void *context, const double values[2], strut_setup *setup,
                             strut_error *error) {
  const strut_study_value both[] = {{.number = values[0]}, {.number = values[1]}};
  return strut_varied_scenes_read(&((follow_source *)context)->scenes, both, setup, error);
}

/* The scene's own value where it is within the range, or the middle. */
static double own_value(const strut_scene *scene, const char *name, double low, double high) {
  double own = strut_parameter_named(scene, name)->value;
  return own >= low && own <= high ? own : 0.5 * (low + high);
}

/* --over and --and */
static strut_status read_ranges(const strut_arguments *arguments, const strut_scene *scene,
                                follow_source *source, strut_follow_options *wanted,
                                strut_dimension *dimension) {
  const strut_given_range *over = &arguments->over, *and_over = &arguments->and_over;
  const bool both = and_over->text;
  const followed first = {"--over", over, over->high ? over->low : arguments->from,
                          over->high ? over->high : arguments->until};
  const followed other = {"--and", and_over, and_over->low, and_over->high};
  const char *const names[2] = {over->name, and_over->name};
  strut_dimension dimensions[2] = {STRUT_DIM_NONE};
  strut_follow_second *second = &wanted->second;
  strut_status status = check_range(arguments, scene, &first);
  if (!status && both) status = check_range(arguments, scene, &other);
  if (!status && both && strcmp(names[0], names[1]) == 0)
    status =
        strut_usage_error(arguments, "--over and --and name the same parameter '%s'", names[0]);
  if (status) return status;
  source->scenes.purpose = STRUT_FOR_RUN_STEP_LATER;
  status = strut_varied_scenes_open(arguments, names, both ? 2 : 1, &source->scenes, dimensions);
  if (!status) status = read_ends(arguments, &first, dimensions[0], &wanted->low, &wanted->high);
  if (!status && both)
    status = read_ends(arguments, &other, dimensions[1], &second->low, &second->high);
  if (status) return status;
  *dimension = dimensions[0];
  wanted->name = names[0];
  wanted->unit = strut_unit_of(dimensions[0]);
  wanted->shown = strut_parameter_named(scene, names[0])->shown;
  wanted->scenes = (strut_follow_scenes){setup_at, source};
  if (!both) return STRUT_OK;
  second->name = names[1];
  second->unit = strut_unit_of(dimensions[1]);
  second->shown = strut_parameter_named(scene, names[1])->shown;
  second->value = own_value(scene, names[1], second->low, second->high);
  return STRUT_OK;
}

/* Values of --values, or the scene's own where it is within the range, or the middle. */
static strut_status read_values(const strut_arguments *arguments, const strut_scene *scene,
                                strut_dimension dimension, const strut_follow_options *wanted,
                                double values[MOST_AT], size_t *count) {
  const char *at = arguments->values;
  *count = 1;
  values[0] = own_value(scene, wanted->name, wanted->low, wanted->high);
  if (!at) return STRUT_OK;
  *count = strut_quantities_read(at, dimension, values, MOST_AT);
  bool good = *count > 0;
  for (size_t i = 0; i < *count; i++)
    good = good && values[i] >= wanted->low && values[i] <= wanted->high;
  if (good) return STRUT_OK;
  return strut_usage_error(arguments,
                           "--values expects values of %s within the range, with commas between",
                           wanted->name);
}

/* Names of --at, in source->from; returns how many, 0 where there are none. */
static size_t read_names(const strut_arguments *arguments, follow_source *source,
                         const char *names[MOST_STARTS]) {
  size_t count = 0;
  char *rest = source->from, *name;
  snprintf(source->from, sizeof source->from, "%s", arguments->at ? arguments->at : "");
  while (count < MOST_STARTS / MOST_AT && (name = strtok_r(rest, ", ", &rest)))
    names[count++] = name;
  return count;
}

/* What is followed, of the scene as it was read: --over, --and, --values, --at and others. STRUT_USAGE. */
static strut_status read_options(const strut_arguments *arguments, const strut_scene *scene,
                                 follow_source *source, strut_follow_options *wanted) {
  strut_dimension dimension = STRUT_DIM_NONE;
  const char *names[MOST_STARTS] = {NULL};
  double values[MOST_AT];
  size_t value_count = 0, name_count = read_names(arguments, source, names);
  strut_status status = read_ranges(arguments, scene, source, wanted, &dimension);
  if (!status) status = read_values(arguments, scene, dimension, wanted, values, &value_count);
  for (size_t i = 0; i < name_count && !status; i++)
    if (strut_thing_find(scene, STRUT_THING_CONFIGURATION, names[i]) < 0)
      status = strut_usage_error(arguments, "--at: the model has no configuration '%s'", names[i]);
  if (status) return status;
  for (size_t v = 0; v < value_count; v++)
    for (size_t k = 0; k < (name_count ? name_count : 1); k++)
      source->starts[wanted->start_count++] = (strut_follow_start){values[v], names[k]};
  wanted->starts = source->starts;
  wanted->steps = (int32_t)arguments->steps.value;
  wanted->accuracy = arguments->accuracy.value;
  wanted->basins = arguments->basins;
  wanted->method = arguments->integrator.text;
  return STRUT_OK;
}

/* What is followed, and what was found. */
typedef struct followed_study {
  follow_source source;
  strut_follow_result result;
} followed_study;

static void free_study(strut_analysis *analysis) {
  followed_study *self = analysis->result.own;
  if (!self) return;
  strut_follow_free(&self->result);
  strut_varied_scenes_free(&self->source.scenes);
  strut_release(self);
}

static strut_status compute(strut_analysis *analysis, strut_error *error) {
  followed_study *self = analysis->result.own = strut_allocate(1, sizeof *self);
  if (!self) return strut_no_memory(error, "");
  strut_follow_options wanted = {.threads = strut_sweep_threads(),
                                 .interrupt = analysis->interrupt,
                                 .progress = analysis->progress,
                                 .progress_context = analysis->progress_context};
  self->source.scenes = analysis->scenes;
  analysis->found = &self->result;
  analysis->scene = NULL;
  strut_status status =
      read_options(analysis->arguments, &analysis->setup->scene, &self->source, &wanted);
  if (!status) status = strut_follow_make(&wanted, &self->result, error);
  analysis->partial = status == STRUT_INTERRUPTED && self->result.count > 0;
  return status;
}

enum { FIGURE, BRANCHES, CURVES };

static const strut_follow_result *result_of(const strut_analysis *analysis) {
  return &((const followed_study *)analysis->result.own)->result;
}

static bool has_curves(const strut_analysis *analysis, size_t number) {
  const strut_follow_result *result = result_of(analysis);
  return result->second.name && (result->curve_count || number != CURVES);
}

static strut_status draw(const strut_analysis *analysis, const strut_plot *plot,
                         strut_error *error) {
  size_t number = analysis->picture;
  bool curves = number == CURVES || (number == FIGURE && has_curves(analysis, CURVES));
  const strut_follow_result *result = result_of(analysis);
  strut_table table = {0};
  char *text = strut_values_csv(curves ? &strut_follow_curves_values : &strut_follow_values,
                                curves ? "curves.points" : "branches.points", NULL, result, NULL);
  strut_status status = text ? strut_table_parse(NULL, "", text, strlen(text), &table)
                             : strut_no_memory(error, "while drawing");
  if (!status) {
    strut_table_show_unit(&table, result->name, result->shown);
    strut_table_show_unit(&table, result->second.name, result->second.shown);
    status = strut_follow_figure(plot, result->title, 0, &table, error);
  }
  strut_arena_free(&table.arena);
  strut_release(text);
  return status;
}

static const strut_output_file files[] = {
    {.name = "branches.csv", .list = "branches.points"},
    {.name = "branches.json"},
    {.name = "branches.svg", .draw = draw, .number = BRANCHES},
    {.name = "curves.csv",
     .list = "curves.points",
     .rows = &strut_follow_curves_values,
     .there = has_curves},
    {.name = "curves.svg", .draw = draw, .number = CURVES, .there = has_curves},
    {.name = NULL}};

static const strut_analysis_kind periodic_analysis = {.files = files,
                                                      .rows = &strut_follow_values,
                                                      .uncompiled = true,
                                                      .asks = true,
                                                      .compute = compute,
                                                      .draw = draw,
                                                      .release = free_study};

static const strut_refused_option refused[] = {
    {"step", "it follows from --accuracy and the method's stability limit"},
    {"load", "periodic motions are followed_study over parameters: --over NAME=LOW..HIGH"},
    {NULL, NULL}};

static const char periodic_details[] =
    "\nRuns the model at each VALUE from each NAME until its motion is steady, and follows the\n"
    "periodic motion both ways over the parameter, past folds. Tells at each point whether the\n"
    "motion is stable, by its Floquet multipliers, and locates folds, period doublings (whose\n"
    "branches it follows, too), tori, and where touchdowns, lift-offs, stick or slip begin or\n"
    "cease within a period. Motions that travel along level ground repeat but for their travel.\n"
    "--and follows these points over a second parameter: curves of folds, doublings, grazings and\n"
    "lift-offs, with their cusps.\n";

const strut_command strut_command_periodic = {
    .name = "path --periodic",
    .model = "MODEL",
    .summary = "follows periodic motions, stable or not, as a parameter changes",
    .details = periodic_details,
    .options = options,
    .analysis = &periodic_analysis,
    .refused = refused,
    .timed = true,
};
