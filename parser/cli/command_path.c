/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/command_path.h"

#include "engine/base/memory.h"
#include "engine/output/figures/path_figure.h"
#include "engine/output/file.h"
#include "engine/output/report/path_report.h"
#include "parser/cli/open_model.h"
#include "parser/cli/option_values.h"
#include "parser/cli/path_over.h"
#include "parser/cli/plot_options.h"
#include "parser/cli/streams.h"

enum { MOST_STEPS = 1000000 };

static const char *const file_names[] = {"path.json", "path.csv", NULL};

static const strut_option options[] = {
    {STRUT_OPTION_LOAD, "load", "NAME", "the load to grow; else all loads without a signal"},
    {STRUT_OPTION_OVER, "over", "WHAT", "follow a parameter, an actuator, or NODE.x, NODE.y"},
    {STRUT_OPTION_FROM, "from", "VALUE", "where to begin: factor, or in the unit of WHAT"},
    {STRUT_OPTION_UNTIL, "until", "VALUE",
     "where to end, likewise; a load's factor 1 if not given"},
    {STRUT_OPTION_AT, "at", "NAME", "begin at this configuration's equilibrium"},
    {STRUT_OPTION_STEPS, "steps", "N", "most steps; 400 if not given"},
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "give a parameter another value; may be repeated"},
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write path.json and path.csv into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status write_files(const char *directory, const strut_path *path,
                                const strut_scene *scene, strut_error *error) {
  char *json = strut_path_json(path, scene), *csv = strut_path_csv(path, scene);
  strut_status status = json && csv ? strut_directory_create(directory, error)
                                    : strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  if (status == STRUT_OK) status = strut_file_write_text(directory, "path.json", json, error);
  if (status == STRUT_OK) status = strut_file_write_text(directory, "path.csv", csv, error);
  strut_release(json);
  strut_release(csv);
  return status;
}

static strut_status show(const strut_arguments *arguments, const strut_path *path,
                         const strut_scene *scene) {
  char *text = arguments->json ? strut_path_json(path, scene) : strut_path_table(path, scene);
  if (!text) return strut_print_out_of_memory();
  strut_status status = strut_print(text);
  strut_release(text);
  return status;
}

/* Everything that was asked for; a sentence on stderr where that cannot be had. */
static strut_status report(const strut_arguments *arguments, const strut_plot *plot,
                           const strut_model *model, const strut_path *path) {
  strut_error error = {0};
  strut_status status = STRUT_OK;
  if (arguments->output) status = write_files(arguments->output, path, model->scene, &error);
  if (status == STRUT_OK) {
    status = show(arguments, path, model->scene);
    if (status != STRUT_OK || !plot->path) return status;
    status = strut_path_figure(plot->path, plot->width, model, path, &error);
  }
  if (status != STRUT_OK) strut_print_error(&error);
  return status;
}

static strut_status follow(const strut_arguments *arguments, const strut_plot *plot,
                           const strut_path_options *wanted, const strut_setup *setup) {
  strut_path path = {0};
  strut_model *model = NULL;
  strut_error error = {0};
  strut_status status = strut_model_compile(&setup->scene, &model, &error);
  if (status == STRUT_OK)
    status = strut_path_follow(model, &setup->experiment, wanted, &path, &error);
  if (status == STRUT_OK)
    status = report(arguments, plot, model, &path);
  else
    strut_print_error(&error);
  strut_path_free(&path);
  strut_model_free(model);
  return status;
}

static strut_status run(const strut_arguments *arguments) {
  strut_setup setup;
  strut_path_options wanted = {.at = strut_option_text(arguments, STRUT_OPTION_AT)};
  strut_path_over_source source = {0};
  strut_plot plot;
  int64_t steps = 0;
  strut_status status = strut_option_integer(&strut_command_path, arguments, STRUT_OPTION_STEPS, 1,
                                             MOST_STEPS, &steps);
  wanted.steps = (int32_t)steps;
  if (status == STRUT_OK) status = strut_plot_read(&strut_command_path, arguments, 0, &plot);
  if (status != STRUT_OK) return status;
  status = strut_check_output_writable(arguments, file_names);
  if (status != STRUT_OK) return status;
  status = strut_open_model_text(arguments, &source.text, &source.length, &setup);
  if (status != STRUT_OK) return status;
  status = strut_path_over_read(&strut_command_path, arguments, &setup.scene, &source, &wanted);
  if (status == STRUT_OK) status = follow(arguments, &plot, &wanted, &setup);
  strut_path_over_free(&source);
  strut_setup_free(&setup);
  return status;
}

const strut_command strut_command_path = {
    .name = "path",
    .model = "MODEL",
    .summary = "follows the equilibria as a load, a length or any parameter changes",
    .details =
        "\nBegins without the load, at the equilibrium that the start comes to rest in, and\n"
        "follows the equilibria as the factor of the load grows, past limit points, to the\n"
        "factor VALUE. Finds the points where the factor turns back, where another path\n"
        "branches off, where cables go slack or taut, where nodes touch or leave the ground,\n"
        "and what each does to stability. Friction and drives are left out.\n"
        "--over follows something else, loads staying as they are: a number under\n"
        "'parameters' (from the value that it has), an actuator (what it adds to its member's\n"
        "rest length), or the displacement of a node along x or y, which is held from then on.\n",
    .options = options,
    .run = run,
    .timed = true,
};
