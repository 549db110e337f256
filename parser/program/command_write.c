/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include "engine/base/memory.h"
#include "parser/program/open_model.h"
#include "parser/program/streams.h"
#include "parser/write/write_scene.h"

static const strut_option options[] = {
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_PARTS, "parts", NULL, "keep parameters, groups and parts; files are written out"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

/* The scene as short as the file gave it, or the flat one where that cannot be kept. */
static strut_status write_parts(const strut_arguments *arguments) {
  strut_setup setup;
  char *text, *result = NULL;
  size_t length;
  strut_status status = strut_open_model_text(arguments, &text, &length, &setup);
  if (status != STRUT_OK) return status;
  char *flat = strut_setup_write(&setup);
  if (!flat) status = strut_print_out_of_memory();
  if (flat) status = strut_write_short(arguments, text, length, flat, &setup, true, &result);
  if (status == STRUT_OK) status = strut_print(result ? result : flat);
  strut_release(result);
  strut_release(flat);
  strut_release(text);
  strut_setup_free(&setup);
  return status;
}

static strut_status run_write(const strut_arguments *arguments) {
  strut_setup setup;
  if (arguments->parts) return write_parts(arguments);
  strut_status status = strut_open_model(arguments, STRUT_OPEN_AS_RUN, &setup);
  if (status != STRUT_OK) return status;
  status = strut_print_block(strut_setup_write(&setup));
  strut_setup_free(&setup);
  return status;
}

const strut_command strut_command_write = {
    .name = "write",
    .model = "MODEL",
    .summary = "prints the scene that a run would use",
    .details =
        "\nParameters, groups and units are resolved: every value appears where it is used, in SI\n"
        "units. A run of the printed scene gives bit-identical results.\n"
        "--parts prints the scene as short as it was given, in one file: with its parameters (as\n"
        "--set changed them), groups and parts, and with what its base and its parts' files hold.\n"
        "Comments are lost.\n",
    .options = options,
    .run = run_write,
};
