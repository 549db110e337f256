/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/analysis.h"
#include "parser/program/commands.h"

#include "engine/output/figures/statics_figures.h"
#include "engine/output/report/reports.h"
#include "parser/command/overload_warnings.h"
#include "parser/command/statics_options.h"

static const char *const file_names[] = {"modes.json", "modes.csv", NULL};

static const strut_option options[] = {
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    STRUT_MODES_OPTIONS,
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write modes.json and modes.csv into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status analyse_modes(strut_analysis *a, strut_error *error) {
  strut_modes modes = {0};
  strut_modes_options wanted;
  strut_status status = strut_modes_options_read(&strut_command_modes, a->arguments, &wanted);
  if (status != STRUT_OK) return status;
  status = strut_modes_find(a->model, &a->setup.experiment, &wanted, &modes, error);
  if (status == STRUT_OK)
    status = strut_report(
        a->arguments, a->names,
        strut_report_needs_json(a->arguments) ? strut_modes_json(a->model, &modes) : NULL,
        a->arguments->output ? strut_modes_csv(&modes) : NULL, strut_modes_table(a->model, &modes),
        error);
  if (status == STRUT_OK)
    strut_warn_of_overload(a->arguments->listener, a->model, modes.q, "in this shape");
  if (status == STRUT_OK && a->plot.path)
    status = strut_modes_figure(&a->plot, a->model, &modes, (size_t)wanted.count, error);
  strut_modes_free(&modes);
  return status;
}

static strut_status run_modes(const strut_arguments *arguments) {
  return strut_analysis_run(&strut_command_modes, arguments, file_names, analyse_modes);
}

const strut_command strut_command_modes = {
    .name = "modes",
    .model = "MODEL",
    .summary = "computes natural frequencies and mode shapes about an equilibrium",
    .details =
        "\nClosed contacts stay closed and slide without friction, unless --stuck holds them.\n"
        "Without --at, the equilibrium is the one in which the start comes to rest. All modes are\n"
        "computed up to 400 coordinates, beyond that the ten lowest.\n",
    .options = options,
    .run = run_modes,
    .timed = true,
};
