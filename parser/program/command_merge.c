/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include <stdio.h>
#include <sys/resource.h>

#include "engine/study/results/study_table.h"
#include "parser/program/streams.h"
#include "parser/program/sweep.h"

/* All shards are open at once, which may exceed the usual limit of open files. */
static void allow_many_files(void) {
  struct rlimit limit;
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

static strut_status run_merge(const strut_arguments *arguments) {
  strut_merged merged;
  strut_error error = {0};
  bool refined = false;
  allow_many_files();
  strut_status early = strut_sweep_refine_merge(arguments, &refined);
  if (refined) return early;
  strut_status status = strut_merge(arguments->model, &merged, &error);
  if (status != STRUT_OK) {
    strut_print_error(&error);
    return status;
  }
  if (!arguments->quiet) {
    printf("%s/table.csv: %lld points", arguments->model, (long long)merged.points);
    if (merged.shards) printf(" of %lld shards", (long long)merged.shards);
    printf("\n");
  }
  return strut_sweep_judge(merged.points, merged.failed, merged.inaccurate);
}

const strut_command strut_command_merge = {
    .name = "merge",
    .model = "DIR",
    .summary = "merges the shards of a sweep into one table",
    .details =
        "\nDIR is the --output of the shards. All shards must be present, complete, and of the "
        "same\n"
        "study, model and version of strut. DIR/table.csv is then byte for byte the table of an\n"
        "undivided sweep; otherwise the command reports what is missing.\n"
        "\nExit code: 3 if points of the study failed, 4 if shards or points are missing, else 5 "
        "if\n"
        "points are less accurate than requested.\n",
    .run = run_merge,
};
