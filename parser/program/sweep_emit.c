/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/sweep.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/study/cluster/cluster_script.h"
#include "engine/study/results/study_table.h"
#include "parser/program/commands.h"
#include "parser/program/option_values.h"
#include "parser/program/streams.h"

enum { MOST_CPUS = 4096 };

/* The settings of the command line, for every shard. */
static const char *const *words_of(const strut_arguments *arguments, strut_arena *arena,
                                   size_t *count) {
  const char **words =
      strut_arena_allocate(arena, 2 * arguments->override_count + 1, sizeof *words);
  *count = 2 * arguments->override_count;
  for (size_t i = 0; words && i < arguments->override_count; i++) {
    const strut_override *override = &arguments->overrides[i];
    words[2 * i] = "--set";
    words[2 * i + 1] = strut_arena_format(arena, "%s=%s", override->name, override->value);
    if (!words[2 * i + 1]) return NULL;
  }
  return words;
}

/* The paths of this program and of the current directory. */
static strut_status find_places(char program[PATH_MAX], char folder[PATH_MAX]) {
  ssize_t length = readlink("/proc/self/exe", program, PATH_MAX - 1);
  if (length > 0)
    program[length] = '\0';
  else
    strcpy(program, "strut");
  if (getcwd(folder, PATH_MAX)) return STRUT_OK;
  strut_error error = {0};
  strut_fail(&error, STRUT_FILE_TROUBLE, "the current directory has no name: %s", strerror(errno));
  strut_print_error(&error);
  return STRUT_FILE_TROUBLE;
}

static strut_status print_script(const strut_arguments *arguments, strut_cluster_script *script,
                                 strut_cluster cluster, strut_arena *arena) {
  strut_error error = {0};
  char program[PATH_MAX], folder[PATH_MAX], *text = NULL;
  strut_status status = find_places(program, folder);
  if (status != STRUT_OK) return status;
  script->program = program;
  script->folder = folder;
  script->words = words_of(arguments, arena, &script->word_count);
  if (!script->words) return strut_print_out_of_memory();
  status = strut_cluster_script_write(cluster, script, &text, &error);
  if (status == STRUT_USAGE) fprintf(stderr, "strut sweep: --emit: %s\n", error.message);
  if (status == STRUT_NO_MEMORY) strut_print_error(&error);
  if (status == STRUT_OK) status = strut_print(text);
  strut_release(text);
  return status;
}

/* Checks what does not depend on numbers. */
static strut_status check_emit_options(const strut_arguments *arguments, strut_cluster cluster) {
  const char *wrong = NULL;
  if (strcmp(arguments->model, "-") == 0)
    wrong = "--emit needs a file that the tasks can read, not standard input";
  else if (cluster != STRUT_CLUSTER_SLURM && strut_option_text(arguments, STRUT_OPTION_TIME))
    wrong = "--time is for --emit slurm";
  else if (cluster == STRUT_CLUSTER_PARALLEL && strut_option_text(arguments, STRUT_OPTION_MEMORY))
    wrong = "--memory is for --emit slurm and htcondor";
  else if (!strut_option_text(arguments, STRUT_OPTION_SHARDS))
    wrong = "--emit needs --shards N, the number of tasks";
  if (!wrong) return STRUT_OK;
  fprintf(stderr, "strut sweep: %s\n", wrong);
  return STRUT_USAGE;
}

strut_status strut_sweep_emit(const strut_arguments *arguments, const char *name) {
  static const char *const kinds[] = {"slurm", "parallel", "htcondor", NULL};
  const strut_command *command = &strut_command_sweep;
  strut_cluster_script script = {.name = name,
                                 .study = arguments->model,
                                 .output = arguments->output,
                                 .time = strut_option_text(arguments, STRUT_OPTION_TIME),
                                 .memory = strut_option_text(arguments, STRUT_OPTION_MEMORY),
                                 .cpus = 1};
  int kind = 0;
  strut_status status = strut_option_word(command, arguments, STRUT_OPTION_EMIT, kinds, &kind);
  if (status == STRUT_OK) status = check_emit_options(arguments, (strut_cluster)kind);
  if (status == STRUT_OK)
    status = strut_option_integer(command, arguments, STRUT_OPTION_SHARDS, 1, STRUT_MOST_SHARDS,
                                  &script.shards);
  if (status == STRUT_OK)
    status =
        strut_option_integer(command, arguments, STRUT_OPTION_CPUS, 1, MOST_CPUS, &script.cpus);
  if (status != STRUT_OK) return status;
  strut_arena arena = {0};
  status = print_script(arguments, &script, (strut_cluster)kind, &arena);
  strut_arena_free(&arena);
  return status;
}
