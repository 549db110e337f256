/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "parser/program/commands.h"
#include "parser/program/complete.h"
#include "parser/program/shells.h"
#include "parser/program/streams.h"
#include "parser/yaml/diagnostics.h"

const char *const strut_shells[] = {"bash", "zsh", "fish", NULL};

static const char *shell_at(const void *context, size_t i) {
  (void)context;
  return strut_shells[i];
}

static strut_status run_completion(const strut_arguments *arguments) {
  static const strut_embedded *const scripts[] = {strut_bash_script, strut_zsh_script,
                                                  strut_fish_script};
  for (size_t i = 0; strut_shells[i]; i++)
    if (strcmp(strut_shells[i], arguments->model) == 0) return strut_print(scripts[i]->text);
  const char *near = strut_did_you_mean(arguments->model, shell_at, NULL);
  return strut_print_usage_error(
      &strut_command_completion, "expected bash, zsh or fish, not '%s'%s%s%s", arguments->model,
      near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

const strut_command strut_command_completion = {
    .name = "completion",
    .model = "SHELL",
    .summary = "prints the completion script of a shell: bash, zsh or fish",
    .details =
        "\nThe script completes commands, options and their values: a model's own parameters "
        "after\n"
        "--set, its configurations after --at, methods after --integrator. An installed strut has "
        "it\n"
        "in place. Otherwise, for the running shell:\n\n"
        "  bash  source <(strut completion bash)\n"
        "  zsh   source <(strut completion zsh)\n"
        "  fish  strut completion fish | source\n",
    .run = run_completion,
};
