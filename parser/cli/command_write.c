/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/command_write.h"

#include "engine/base/memory.h"
#include "parser/cli/open_model.h"
#include "parser/cli/streams.h"
#include "parser/write/write_scene.h"

static const strut_option options[] = {
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "give a parameter another value; may be repeated"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status run(const strut_arguments *arguments) {
  strut_setup setup;
  strut_status status = strut_open_model(arguments, STRUT_OPEN_AS_RUN, &setup);
  if (status != STRUT_OK) return status;
  char *text = strut_setup_write(&setup);
  status = text ? strut_print(text) : strut_print_out_of_memory();
  strut_release(text);
  strut_setup_free(&setup);
  return status;
}

const strut_command strut_command_write = {
    .name = "write",
    .model = "MODEL",
    .summary = "prints a model as it would be run",
    .details =
        "\nParameters, groups and units are resolved: every value stands where it is used,\n"
        "in SI units, and running the text gives the same bits.\n",
    .options = options,
    .run = run,
};
