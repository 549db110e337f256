/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/commands.h"

#include "engine/output/figures/statics_figures.h"
#include "engine/output/file.h"
#include "engine/output/report/modes_report.h"
#include "parser/cli/open_model.h"
#include "parser/cli/option_values.h"
#include "parser/cli/streams.h"

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

static strut_status write_files(const char *directory, const strut_model *model,
                                const strut_modes *modes, strut_error *error) {
  strut_status status = strut_directory_create(directory, error);
  if (status == STRUT_OK)
    status = strut_file_write_block(directory, "modes.json", strut_modes_json(model, modes), error);
  if (status == STRUT_OK)
    status = strut_file_write_block(directory, "modes.csv", strut_modes_csv(modes), error);
  return status;
}

/* `panels`: the value of --count, or 0 without it. */
static strut_status report_modes(const strut_arguments *arguments, const strut_plot *plot,
                                 const strut_model *model, const strut_modes *modes,
                                 size_t panels) {
  strut_error error = {0};
  if (arguments->output && write_files(arguments->output, model, modes, &error) != STRUT_OK)
    return strut_print_failure(error.status, &error);
  strut_status status =
      strut_print_report(arguments, arguments->json ? strut_modes_json(model, modes)
                                                    : strut_modes_table(model, modes));
  if (status != STRUT_OK || !plot->path) return status;
  status = strut_modes_figure(plot, model, modes, panels, &error);
  return strut_print_failure(status, &error);
}

static strut_status run_modes(const strut_arguments *arguments) {
  strut_setup setup;
  strut_model *model = NULL;
  strut_modes modes = {0};
  strut_error error = {0};
  strut_plot plot;
  int64_t count = 0;
  strut_status status = strut_option_integer(&strut_command_modes, arguments, STRUT_OPTION_COUNT, 1,
                                             MOST_MODES, &count);
  if (status == STRUT_OK) status = strut_plot_read(&strut_command_modes, arguments, 0, &plot);
  if (status != STRUT_OK) return status;
  status = strut_check_output_writable(arguments, file_names);
  if (status != STRUT_OK) return status;
  status = strut_open_model(arguments, STRUT_OPEN_FOR_ANY, &setup);
  if (status != STRUT_OK) return status;
  strut_modes_options wanted = {.at = strut_option_text(arguments, STRUT_OPTION_AT),
                                .count = (int32_t)count,
                                .stuck = arguments->stuck};
  status = strut_model_compile(&setup.scene, &model, &error);
  if (status == STRUT_OK)
    status = strut_modes_find(model, &setup.experiment, &wanted, &modes, &error);
  if (status != STRUT_OK)
    strut_print_error(&error);
  else
    status = report_modes(arguments, &plot, model, &modes, (size_t)count);
  strut_modes_free(&modes);
  strut_model_free(model);
  strut_setup_free(&setup);
  return status;
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
