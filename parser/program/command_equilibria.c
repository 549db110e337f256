/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/analysis.h"
#include "parser/program/commands.h"

#include "engine/output/figures/statics_figures.h"
#include "engine/output/report/reports.h"
#include "parser/command/overload_warnings.h"
#include "parser/command/statics_options.h"
#include "parser/program/streams.h"

static const char *const file_names[] = {"equilibria.json", NULL};

static const strut_option options[] = {
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    STRUT_EQUILIBRIA_OPTIONS,
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write equilibria.json into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status analyse_equilibria(strut_analysis *a, strut_error *error) {
  strut_equilibria_options wanted;
  strut_equilibria all = {0};
  uint64_t seed;
  strut_status status = strut_equilibria_options_read(&strut_command_equilibria, a->arguments,
                                                      &a->setup, &wanted, &seed);
  wanted.interrupt = strut_interrupt_watch();
  if (!status) status = strut_equilibria_find(a->model, &a->setup.experiment, &wanted, &all, error);
  if (!status)
    status = strut_report(
        a->arguments, a->names,
        strut_report_needs_json(a->arguments) ? strut_equilibria_json(&all, a->model) : NULL, NULL,
        strut_equilibria_table(&all, a->model, a->arguments->all), error);
  if (!status) strut_warn_of_equilibria(a->arguments->listener, a->model, &all);
  if (!status && a->plot.path && all.count > 0)
    status = strut_equilibria_figure(&a->plot, a->model, &all, error);
  if (!status && all.count == 0) status = strut_fail(error, STRUT_NOT_SETTLED, "%s", all.remark);
  strut_equilibria_free(&all);
  return status;
}

static strut_status run_equilibria(const strut_arguments *arguments) {
  return strut_analysis_run(&strut_command_equilibria, arguments, file_names, analyse_equilibria);
}

const strut_command strut_command_equilibria = {
    .name = "equilibria",
    .model = "MODEL",
    .summary = "finds all equilibria, and the energy barriers between stable ones",
    .details =
        "\nThe search holds pairs of contact nodes in turn in place of the ground and starts from\n"
        "the drawn shape, mirrored copies and random shapes. Stable shapes are then released on\n"
        "the real ground, without drive and friction. The table lists what stands there and the\n"
        "energy barriers between; 'stiffness' is the lowest eigenvalue, 'found' the number of\n"
        "starts that ended there. --all adds shapes that sink, tip over or are unstable.\n"
        "Names such as n1-n4-2 give the touching nodes and the rank by energy.\n"
        "Exit code 3 if nothing ever comes to rest.\n",
    .options = options,
    .run = run_equilibria,
    .timed = true,
};
