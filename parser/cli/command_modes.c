/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/analysis.h"
#include "parser/cli/commands.h"

#include "engine/output/figures/statics_figures.h"
#include "engine/output/report/modes_report.h"

enum { MOST_MODES = 1000 };

static const char *const file_names[] = {"modes.json", "modes.csv", NULL};

static const strut_option options[] = {
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_AT, "at", "NAME",
     "equilibrium to linearise about (default: that of the start), or drawn"},
    {STRUT_OPTION_COUNT, "count", "N", "number of modes, lowest first"},
    {STRUT_OPTION_STUCK, "stuck", NULL, "treat closed contacts as stuck instead of frictionless"},
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write modes.json and modes.csv into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status analyse_modes(strut_analysis *a, strut_error *error) {
  strut_modes modes = {0};
  int64_t count = 0;
  strut_status status = strut_option_integer(&strut_command_modes, a->arguments, STRUT_OPTION_COUNT,
                                             1, MOST_MODES, &count);
  if (status != STRUT_OK) return status;
  strut_modes_options wanted = {.at = strut_option_text(a->arguments, STRUT_OPTION_AT),
                                .count = (int32_t)count,
                                .stuck = a->arguments->stuck};
  status = strut_modes_find(a->model, &a->setup.experiment, &wanted, &modes, error);
  if (status == STRUT_OK)
    status = strut_report(a->arguments, a->names, strut_modes_json(a->model, &modes),
                          strut_modes_csv(&modes), strut_modes_table(a->model, &modes), error);
  if (status == STRUT_OK) strut_warn_of_overload(a->model, modes.q, "in this shape");
  if (status == STRUT_OK && a->plot.path)
    status = strut_modes_figure(&a->plot, a->model, &modes, (size_t)count, error);
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
