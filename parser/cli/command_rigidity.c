/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/commands.h"

#include "engine/output/figures/statics_figures.h"
#include "engine/output/file.h"
#include "engine/output/report/rigidity_report.h"
#include "parser/cli/open_model.h"
#include "parser/cli/option_values.h"
#include "parser/cli/streams.h"

static const char *const file_names[] = {"rigidity.json", NULL};

static const strut_option options[] = {
    {STRUT_OPTION_AT, "at", "NAME", "the shape: drawn (default), start, or an equilibrium"},
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write rigidity.json into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status report_rigidity(const strut_arguments *arguments, const strut_model *model,
                                    const strut_named_shape *shape, const strut_rigidity *rigidity,
                                    strut_error *error) {
  strut_status status = STRUT_OK;
  if (arguments->output) status = strut_directory_create(arguments->output, error);
  if (arguments->output && status == STRUT_OK)
    status = strut_file_write_block(arguments->output, "rigidity.json",
                                    strut_rigidity_json(rigidity, model, shape->name), error);
  if (status != STRUT_OK) return status;
  return strut_print_report(arguments, arguments->json
                                           ? strut_rigidity_json(rigidity, model, shape->name)
                                           : strut_rigidity_table(rigidity, model, shape->name));
}

static strut_status analyse_rigidity(const strut_arguments *arguments, const strut_plot *plot,
                                     const strut_model *model, const strut_experiment *experiment,
                                     strut_error *error) {
  strut_arena arena = {0};
  strut_named_shape shape;
  strut_rigidity rigidity = {0};
  strut_status status = strut_named_shape_find(arguments, model, experiment, &arena, &shape, error);
  if (status == STRUT_OK) status = strut_rigidity_find(model, shape.q, &rigidity, error);
  if (status == STRUT_OK) status = report_rigidity(arguments, model, &shape, &rigidity, error);
  if (status == STRUT_OK && plot->path)
    status = strut_rigidity_figure(plot, model, shape.q, shape.name, &rigidity, error);
  strut_rigidity_free(&rigidity);
  strut_arena_free(&arena);
  return status;
}

static strut_status run_rigidity(const strut_arguments *arguments) {
  strut_setup setup;
  strut_model *model = NULL;
  strut_error error = {0};
  strut_plot plot;
  strut_status status = strut_check_output_writable(arguments, file_names);
  if (status == STRUT_OK) status = strut_plot_read(&strut_command_rigidity, arguments, 0, &plot);
  if (status != STRUT_OK) return status;
  status = strut_open_model(arguments, STRUT_OPEN_FOR_ANY, &setup);
  if (status != STRUT_OK) return status;
  status = strut_model_compile(&setup.scene, &model, &error);
  if (status == STRUT_OK)
    status = analyse_rigidity(arguments, &plot, model, &setup.experiment, &error);
  if (status != STRUT_OK && error.message[0]) strut_print_error(&error);
  strut_model_free(model);
  strut_setup_free(&setup);
  return status;
}

const strut_command strut_command_rigidity = {
    .name = "rigidity",
    .model = "MODEL",
    .summary = "computes self-stress states and mechanisms, and classifies them",
    .details =
        "\nPrints the rank of the equilibrium matrix with its spectral gap, self-stress states,\n"
        "mechanisms (rigid-body, infinitesimal, finite), super stability, and the\n"
        "member forces in the shape. Supports are those of the scene; the ground does not\n"
        "count as one.\n",
    .options = options,
    .run = run_rigidity,
    .timed = true,
};
