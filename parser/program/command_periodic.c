/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "engine/study/follow/follow_study.h"
#include "engine/study/sweep/sweep.h"
#include "parser/program/command/follow_options.h"
#include "parser/program/open_model.h"
#include "parser/program/options.h"
#include "parser/program/outputs.h"
#include "parser/program/progress.h"
#include "parser/program/streams.h"

enum { BRANCHES, CURVES };

static strut_status draw(const strut_plot *plot, const void *result, size_t index,
                         strut_error *error) {
  return index == CURVES ? strut_follow_curves_figure(plot, result, error)
                         : strut_follow_figure(plot, result, error);
}

/* With those of curves the last two. */
static const strut_output_file all_files[] = {
    {.name = "branches.csv", .list = "branches.points"},
    {.name = "branches.json"},
    {.name = "branches.svg", .draw = draw},
    {.name = "curves.csv", .list = "curves.points", .rows = &strut_follow_curves_values},
    {.name = "curves.svg", .draw = draw, .index = CURVES},
    {.name = NULL}};
enum { FILES = sizeof all_files / sizeof *all_files, CURVES_CSV = 3, CURVES_SVG };

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

static strut_status report(const strut_arguments *arguments, const strut_plot *plot,
                           const strut_follow_result *result) {
  bool curves = result->second.name && result->curve_count;
  strut_output_file files[FILES];
  memcpy(files, all_files, sizeof files);
  files[CURVES_CSV].absent = !result->second.name;
  files[CURVES_SVG].absent = !curves;
  return strut_outputs_make(arguments, plot,
                            &(strut_outputs){.rows = &strut_follow_values,
                                             .result = result,
                                             .files = files,
                                             .draw = draw,
                                             .index = curves ? CURVES : BRANCHES});
}

static strut_status follow(const strut_arguments *arguments, const strut_plot *plot,
                           strut_follow_options *wanted) {
  strut_error error = {0};
  strut_follow_result *result = strut_allocate(1, sizeof *result);
  if (!result) return strut_print_out_of_memory();
  strut_progress progress = strut_progress_begin(arguments->quiet);
  wanted->interrupt = strut_interrupt_watch();
  wanted->progress = progress.wanted ? strut_progress_show : NULL;
  wanted->progress_context = &progress;
  wanted->threads = strut_sweep_threads();
  strut_status status = strut_follow_make(wanted, result, &error);
  strut_progress_end(&progress);
  strut_print_failure(status, &error);
  if (!status)
    status = report(arguments, plot, result);
  else if (status == STRUT_INTERRUPTED && result->count > 0)
    report(arguments, plot, result);
  strut_follow_free(result);
  strut_release(result);
  return status;
}

static strut_status run_follow(const strut_arguments *arguments) {
  strut_setup setup;
  strut_plot plot;
  strut_follow_source source = {.scenes = {.file = strut_model_name(arguments)}};
  strut_follow_options wanted = {0};
  char *text = NULL;
  strut_status status = strut_plot_read(arguments, 0, &plot);
  if (!status) status = strut_outputs_check(arguments, all_files);
  if (!status) status = strut_open_model_text(arguments, &text, &source.scenes.length, &setup);
  if (status) return status;
  source.scenes.text = text;
  status = strut_follow_options_read(arguments, &setup.scene, &source, &wanted);
  strut_setup_free(&setup);
  if (!status) status = follow(arguments, &plot, &wanted);
  strut_follow_source_free(&source);
  strut_release(text);
  return status;
}

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
    .run = run_follow,
    .refused = refused,
    .timed = true,
};
