/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/analysis.h"
#include "parser/program/commands.h"

#include "engine/output/figures/statics_figures.h"
#include "engine/output/report/reports.h"
#include "parser/command/statics_options.h"

static const char *const file_names[] = {"rigidity.json", NULL};

static const strut_option options[] = {
    STRUT_SHAPE_OPTIONS,
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write rigidity.json into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status analyse_rigidity(strut_analysis *a, strut_error *error) {
  const strut_model *model = a->model;
  strut_arena arena = {0};
  strut_named_shape shape;
  strut_rigidity rigidity = {0};
  strut_status status =
      strut_named_shape_find(a->arguments, model, &a->setup.experiment, &arena, &shape, error);
  if (status == STRUT_OK) status = strut_rigidity_find(model, shape.q, &rigidity, error);
  if (status == STRUT_OK)
    status = strut_report(a->arguments, a->names,
                          strut_report_needs_json(a->arguments)
                              ? strut_rigidity_json(&rigidity, model, shape.name)
                              : NULL,
                          NULL, strut_rigidity_table(&rigidity, model, shape.name), error);
  if (status == STRUT_OK && a->plot.path)
    status = strut_rigidity_figure(&a->plot, model, shape.q, shape.name, &rigidity, error);
  strut_rigidity_free(&rigidity);
  strut_arena_free(&arena);
  return status;
}

static strut_status run_rigidity(const strut_arguments *arguments) {
  return strut_analysis_run(&strut_command_rigidity, arguments, file_names, analyse_rigidity);
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
