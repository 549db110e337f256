/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/commands.h"

#include "parser/cli/open_model.h"
#include "parser/cli/streams.h"
#include "parser/write/write_scene.h"

static const strut_option options[] = {
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status run_write(const strut_arguments *arguments) {
  strut_setup setup;
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
        "units. A run of the printed scene gives bit-identical results.\n",
    .options = options,
    .run = run_write,
};
