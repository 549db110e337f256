/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/commands.h"

#include "parser/cli/streams.h"
#include "parser/write/keys_page.h"

static strut_status run(const strut_arguments *arguments) {
  (void)arguments;
  return strut_print_block(strut_keys_page());
}

const strut_command strut_command_keys = {
    .name = "keys",
    .summary = "prints all keys of the modelling language, as Markdown",
    .run = run,
};
