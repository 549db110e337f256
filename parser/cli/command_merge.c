/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/commands.h"

#include <stdio.h>
#include <sys/resource.h>

#include "engine/study/results/merge.h"
#include "parser/cli/streams.h"

/* All shards are open at a time, and there may be more of them than is usual. */
static void allow_many_files(void) {
  struct rlimit limit;
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

static strut_status run(const strut_arguments *arguments) {
  strut_merged merged;
  strut_error error = {0};
  allow_many_files();
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
  if (!merged.failed) return STRUT_OK;
  fprintf(stderr, "strut: %lld of %lld points failed: the columns status and message say why\n",
          (long long)merged.failed, (long long)merged.points);
  return STRUT_DIVERGED;
}

const strut_command strut_command_merge = {
    .name = "merge",
    .model = "DIR",
    .summary = "joins the shards of a study to its table",
    .details =
        "\nDIR is what the shards were given as --output. All of them must be there, complete, "
        "and\n"
        "of the same study, model and version of strut; DIR/table.csv is then the same, byte for\n"
        "byte, as that of the study in one piece. What is missing is said otherwise.\n"
        "\nExit code: 3 where points of the study failed, 4 where shards or points are missing.\n",
    .run = run,
};
