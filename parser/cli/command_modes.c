/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/command_modes.h"

#include "engine/base/memory.h"
#include "engine/output/figures/modes_figure.h"
#include "engine/output/file.h"
#include "engine/output/report/modes_report.h"
#include "parser/cli/open_model.h"
#include "parser/cli/option_values.h"
#include "parser/cli/plot_options.h"
#include "parser/cli/streams.h"

enum { MOST_MODES = 1000 };

static const char *const file_names[] = {"modes.json", "modes.csv", NULL};

static const strut_option options[] = {
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "give a parameter another value; may be repeated"},
    {STRUT_OPTION_AT, "at", "NAME", "at this configuration's equilibrium, or 'drawn'"},
    {STRUT_OPTION_COUNT, "count", "N", "the lowest N modes"},
    {STRUT_OPTION_STUCK, "stuck", NULL, "hold nodes that touch along the ground too"},
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write modes.json and modes.csv into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

/* Writes a text as a file and releases it. */
static strut_status write_file(const char *directory, const char *name, char *text,
                               strut_error *error) {
  strut_status status = text ? strut_file_write_text(directory, name, text, error)
                             : strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  strut_release(text);
  return status;
}

static strut_status write_files(const char *directory, const strut_model *model,
                                const strut_modes *modes, strut_error *error) {
  strut_status status = strut_directory_create(directory, error);
  if (status == STRUT_OK)
    status = write_file(directory, "modes.json", strut_modes_json(model, modes), error);
  if (status == STRUT_OK)
    status = write_file(directory, "modes.csv", strut_modes_csv(modes), error);
  return status;
}

static strut_status show(const strut_arguments *arguments, const strut_model *model,
                         const strut_modes *modes) {
  char *text = arguments->json ? strut_modes_json(model, modes) : strut_modes_table(model, modes);
  if (!text) return strut_print_out_of_memory();
  strut_status status = strut_print(text);
  strut_release(text);
  return status;
}

/* `panels` is what --count says, or 0. */
static strut_status report(const strut_arguments *arguments, const strut_plot *plot,
                           const strut_model *model, const strut_modes *modes, size_t panels) {
  strut_error error = {0};
  if (arguments->output && write_files(arguments->output, model, modes, &error) != STRUT_OK) {
    strut_print_error(&error);
    return error.status;
  }
  strut_status status = show(arguments, model, modes);
  if (status != STRUT_OK || !plot->path) return status;
  status = strut_modes_figure(plot->path, plot->width, model, modes, panels, &error);
  if (status != STRUT_OK) strut_print_error(&error);
  return status;
}

static strut_status run(const strut_arguments *arguments) {
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
    status = report(arguments, &plot, model, &modes, (size_t)count);
  strut_modes_free(&modes);
  strut_model_free(model);
  strut_setup_free(&setup);
  return status;
}

const strut_command strut_command_modes = {
    .name = "modes",
    .model = "MODEL",
    .summary = "natural frequencies and shapes of small motions about an equilibrium",
    .details =
        "\nContacts that are closed there stay closed, and slide without friction unless\n"
        "--stuck holds them. Without --at it is the equilibrium that the start comes to\n"
        "rest in. Up to 400 coordinates all modes are computed, above the ten lowest.\n",
    .options = options,
    .run = run,
    .timed = true,
};
