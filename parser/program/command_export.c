/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut export`: a model as one file. */
#include <sys/stat.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/commands.h"
#include "parser/program/open_model.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"

static strut_status put_scene(const strut_arguments *arguments, const char *text) {
  strut_error error = {0};
  if (!arguments->output) return strut_print(text);
  return strut_print_failure(strut_file_write_path(arguments->output, text, &error), &error);
}

/* Flat, or with --parts as short as the file gave it where that can be kept. */
static strut_status run_export(const strut_arguments *arguments) {
  const bool parts = arguments->parts;
  strut_setup setup;
  strut_open_report kept = {.prints = true};
  char *text = NULL;
  struct stat found;
  if (stat(arguments->model, &found) == 0 && S_ISDIR(found.st_mode))
    return strut_usage_error(arguments, "the scene of a run is %s/scene.yaml", arguments->model);
  strut_status status = strut_open_model(
      arguments, parts ? STRUT_OPEN_FOR_STATICS : STRUT_OPEN_AS_RUN, &setup, &kept);
  if (status != STRUT_OK) return status;
  char *flat = strut_setup_write(&setup);
  if (!flat) status = strut_print_out_of_memory();
  if (flat && parts)
    status = strut_write_short(arguments, kept.text, kept.length, flat, &setup, true, &text);
  if (status == STRUT_OK) status = put_scene(arguments, text ? text : flat);
  strut_release(text);
  strut_release(flat);
  strut_open_report_free(&kept);
  strut_setup_free(&setup);
  return status;
}

static const strut_option options[] = {
    STRUT_OUTPUT_OPTION("FILE", "file to write (default: print)"),
    STRUT_SET_OPTION,
    {STRUT_FILLS(parts), "parts", NULL, "keep parameters, groups and parts"},
    {.name = NULL},
};

const strut_command strut_command_export = {
    .name = "export",
    .model = "MODEL",
    .summary = "writes a model as one file",
    .details =
        "\n"
        "One file without parts and parameters, with every value in SI units; a run of it gives\n"
        "bit-identical results. With --parts as short as the original, with its base and parts\n"
        "written out. For other programs' formats: python3 -m strut.formats --help\n",
    .options = options,
    .run = run_export,
};
