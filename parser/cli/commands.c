/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of commands: a new one is one file and one line here. */
#include "parser/cli/commands.h"

#include <stdio.h>
#include <string.h>

#include "parser/cli/command_check.h"
#include "parser/cli/command_compare.h"
#include "parser/cli/command_equilibria.h"
#include "parser/cli/command_export.h"
#include "parser/cli/command_form.h"
#include "parser/cli/command_keys.h"
#include "parser/cli/command_merge.h"
#include "parser/cli/command_modes.h"
#include "parser/cli/command_path.h"
#include "parser/cli/command_plot.h"
#include "parser/cli/command_rigidity.h"
#include "parser/cli/command_run.h"
#include "parser/cli/command_sweep.h"
#include "parser/cli/command_tradeoff.h"
#include "parser/cli/command_view.h"
#include "parser/cli/command_write.h"
#include "parser/yaml/diagnostics.h"

static const strut_command *const commands[] = {
    &strut_command_run,
    &strut_command_check,
    &strut_command_equilibria,
    &strut_command_modes,
    &strut_command_form,
    &strut_command_path,
    &strut_command_rigidity,
    &strut_command_compare,
    &strut_command_merge,
    &strut_command_sweep,
    &strut_command_tradeoff,
    &strut_command_view,
    &strut_command_export,
    &strut_command_plot,
    &strut_command_write,
    &strut_command_keys,
    NULL,
};

static const char *command_name_at(const void *context, size_t i) {
  (void)context;
  return commands[i] ? commands[i]->name : NULL;
}

const strut_command *strut_command_find(const char *name) {
  for (size_t i = 0; commands[i]; i++) {
    if (strcmp(commands[i]->name, name) == 0) return commands[i];
  }
  const char *near = strut_did_you_mean(name, command_name_at, NULL);
  fprintf(stderr, "strut: unknown command '%s'", name);
  if (near) fprintf(stderr, "; did you mean '%s'?", near);
  fprintf(stderr, "\n'strut help' lists the commands\n");
  return NULL;
}

void strut_program_help(void) {
  printf("strut %s: structures of bars, springs and cables, described in YAML\n\n", STRUT_VERSION);
  printf("usage: strut COMMAND [OPTION]... [MODEL]\n\nCommands:\n");
  for (size_t i = 0; commands[i]; i++) {
    printf("  %-8s %s\n", commands[i]->name, commands[i]->summary);
  }
  printf(
      "\n'strut COMMAND --help' explains one of them; 'strut --version' prints the version.\n"
      "MODEL is a file in strut's language ('strut keys' explains it), or - for the standard "
      "input.\n\n"
      "Exit code: 0 done, 1 wrong use, 2 the scene is not valid, 3 the computation failed,\n"
      "4 trouble with files or memory, 130 interrupted.\n");
}
