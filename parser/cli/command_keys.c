/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/command_keys.h"

#include "engine/base/memory.h"
#include "parser/cli/streams.h"
#include "parser/write/keys_page.h"

static strut_status run(const strut_arguments *arguments) {
  (void)arguments;
  char *page = strut_keys_page();
  if (!page) return strut_print_out_of_memory();
  strut_status status = strut_print(page);
  strut_release(page);
  return status;
}

const strut_command strut_command_keys = {
    .name = "keys",
    .summary = "prints every key of the language, as a page of Markdown",
    .run = run,
};
