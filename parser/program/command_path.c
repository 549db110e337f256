/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/analysis.h"
#include "parser/program/commands.h"

#include "engine/base/memory.h"
#include "engine/output/figures/statics_figures.h"
#include "engine/output/report/reports.h"
#include "engine/statics/path/path.h"
#include "parser/command/overload_warnings.h"
#include "parser/command/path_options.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"

static const char *const file_names[] = {"path.json", "path.csv", NULL};

static const strut_option options[] = {
    STRUT_PATH_OPTIONS,
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write path.json and path.csv into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    STRUT_AXIS_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

/* Writes, prints and draws the path; reports what fails on stderr. */
static strut_status report_path(const strut_arguments *arguments, const strut_plot *plot,
                                const strut_model *model, const strut_path *path) {
  strut_error error = {0};
  strut_status status = strut_report(arguments, file_names, strut_path_json(path, model->scene),
                                     strut_path_csv(path, model->scene),
                                     strut_path_table(path, model->scene), &error);
  if (status == STRUT_OK) strut_warn_of_path(arguments->listener, model->scene, path);
  if (status == STRUT_OK && plot->path) status = strut_path_figure(plot, model, path, &error);
  if (status != STRUT_OK && error.message[0]) strut_print_error(&error);
  return status;
}

static strut_status follow_path(const strut_arguments *arguments, const strut_plot *plot,
                                const strut_path_options *wanted, const strut_setup *setup) {
  strut_path path = {0};
  strut_model *model = NULL;
  strut_error error = {0};
  strut_status status = strut_model_compile(&setup->scene, &model, &error);
  if (status == STRUT_OK)
    status = strut_path_follow(model, &setup->experiment, wanted, &path, &error);
  if (status == STRUT_OK)
    status = report_path(arguments, plot, model, &path);
  else
    strut_print_error(&error);
  strut_path_free(&path);
  strut_model_free(model);
  return status;
}

static strut_status run_path(const strut_arguments *arguments) {
  strut_setup setup;
  strut_path_options wanted;
  strut_varied_scenes followed = {.file = strut_model_name(arguments)};
  strut_plot plot;
  char *text = NULL;
  strut_status status = strut_path_options_read(&strut_command_path, arguments, &wanted);
  if (status == STRUT_OK) status = strut_plot_read(&strut_command_path, arguments, 0, &plot);
  if (status != STRUT_OK) return status;
  status = strut_check_output_writable(arguments, file_names);
  if (status != STRUT_OK) return status;
  status = strut_open_model_text(arguments, &text, &followed.length, &setup);
  if (status != STRUT_OK) return status;
  followed.text = text;
  status =
      strut_path_followed_read(&strut_command_path, arguments, &setup.scene, &followed, &wanted);
  if (status == STRUT_OK) status = follow_path(arguments, &plot, &wanted, &setup);
  strut_varied_scenes_free(&followed);
  strut_release(text);
  strut_setup_free(&setup);
  return status;
}

const strut_command strut_command_path = {
    .name = "path",
    .model = "MODEL",
    .summary = "follows an equilibrium as a load, an actuator or a parameter changes",
    .details =
        "\nStarts without the load at the equilibrium in which the start comes to rest, and "
        "follows\n"
        "the equilibria as the load factor grows, past limit points, to the factor VALUE. Detects\n"
        "limit points, bifurcations, cables that become slack or taut, and nodes that touch or\n"
        "leave the ground, each with its effect on stability. Friction and drives are ignored.\n"
        "--over varies something else at constant loads: a number under 'parameters' (from its\n"
        "value in the file), an actuator (the change of its member's rest length, its hinge's "
        "rest\n"
        "angle or its cell's pressure), or the prescribed displacement of a node along x or y.\n",
    .options = options,
    .run = run_path,
    .timed = true,
};
