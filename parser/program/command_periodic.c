/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "engine/study/follow/follow_study.h"
#include "engine/study/sweep/sweep.h"
#include "parser/program/command/analyses.h"
#include "parser/program/command/follow_options.h"
#include "parser/program/options.h"

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
     .low = DBL_MIN, .high = 0.1, .expected = "expects a value up to 10 %"},
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
    STRUT_JSON_OPTION,
    {.table = strut_plot_options},
    {.table = strut_axis_options},
    {.name = NULL},
};

/* What is followed, and what was found. */
typedef struct followed {
  strut_follow_source source;
  strut_follow_result result;
} followed;

static void free_followed(strut_analysis *analysis) {
  followed *self = analysis->result.own;
  if (!self) return;
  strut_follow_free(&self->result);
  strut_follow_source_free(&self->source);
  strut_release(self);
}

static strut_status compute(strut_analysis *analysis, strut_error *error) {
  followed *self = analysis->result.own = strut_allocate(1, sizeof *self);
  if (!self) return strut_no_memory(error, "");
  strut_follow_options wanted = {.threads = strut_sweep_threads(),
                                 .interrupt = analysis->interrupt,
                                 .progress = analysis->progress,
                                 .progress_context = analysis->progress_context};
  self->source.scenes = analysis->scenes;
  analysis->found = &self->result;
  analysis->scene = NULL;
  strut_status status = strut_follow_options_read(analysis->arguments, &analysis->setup->scene,
                                                  &self->source, &wanted);
  if (!status) status = strut_follow_make(&wanted, &self->result, error);
  analysis->partial = status == STRUT_INTERRUPTED && self->result.count > 0;
  return status;
}

enum { FIGURE, BRANCHES, CURVES };

static const strut_follow_result *result_of(const strut_analysis *analysis) {
  return &((const followed *)analysis->result.own)->result;
}

static bool has_curves(const strut_analysis *analysis, size_t number) {
  const strut_follow_result *result = result_of(analysis);
  return result->second.name && (result->curve_count || number != CURVES);
}

static strut_status draw(const strut_analysis *analysis, const strut_plot *plot, size_t number,
                         strut_error *error) {
  bool curves = number == CURVES || (number == FIGURE && has_curves(analysis, CURVES));
  return (curves ? strut_follow_curves_figure : strut_follow_figure)(plot, result_of(analysis),
                                                                     error);
}

static strut_status draw_figure(const strut_analysis *analysis, const strut_plot *plot,
                                strut_error *error) {
  return draw(analysis, plot, FIGURE, error);
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
                                                      .draw = draw_figure,
                                                      .release = free_followed};

static const strut_refused_option refused[] = {
    {"step", "it follows from --accuracy and the method's stability limit"},
    {"load", "periodic motions are followed over parameters: --over NAME=LOW..HIGH"},
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
