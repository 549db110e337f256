/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/commands.h"

#include <stdio.h>
#include <stdlib.h>

#include "engine/output/file.h"
#include "engine/study/results/shard.h"
#include "engine/study/results/study_table.h"
#include "parser/cli/interrupt.h"
#include "parser/cli/option_values.h"
#include "parser/cli/streams.h"
#include "parser/cli/sweep_emit.h"
#include "parser/cli/sweep_figures.h"
#include "parser/cli/sweep_report.h"
#include "parser/cli/sweep_shards.h"
#include "parser/cli/sweep_study.h"
#include "parser/cli/sweep_texts.h"

static const strut_option options[] = {
    {STRUT_OPTION_OUTPUT, "output", "DIR", "where the results are, and go on"},
    {STRUT_OPTION_THREADS, "threads", "N", "points at a time; as many as there are processors"},
    {STRUT_OPTION_LANES, "lanes", "N",
     "points at a time on one processor, 1, 2, 4 or 8; as many as it is good for"},
    {STRUT_OPTION_RETRY, "retry", NULL, "compute points that failed once more"},
    {STRUT_OPTION_SHARD, "shard", "K/N",
     "only every N-th point from K on, counted from 0; or slurm/N"},
    {STRUT_OPTION_EMIT, "emit", "KIND",
     "only print the script for a cluster: slurm or parallel (GNU's)"},
    {STRUT_OPTION_SHARDS, "shards", "N", "with --emit: how many in all"},
    {STRUT_OPTION_CPUS, "cpus", "N", "with --emit: processors of a task; 1 if not given"},
    {STRUT_OPTION_TIME, "time", "TIME", "with --emit slurm: of a task, such as 12:00:00"},
    {STRUT_OPTION_MEMORY, "memory", "SIZE", "with --emit slurm: of a task, such as 2G"},
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "give a parameter another value; may be repeated"},
    {STRUT_OPTION_COUNT_POINTS, "count", NULL,
     "only tell how many points and which columns there are"},
    {STRUT_OPTION_STATUS, "status", NULL, "only tell what is done, missing and failed in DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print one JSON object"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

enum { MOST_THREADS = 4096, MOST_LANES = 8 };
static const char table_name[] = "table.csv";

/* How many points at a time; 0: as is good. */
typedef struct pace {
  int64_t threads, lanes;
} pace;

/* DIR/name in the study's memory; NULL: memory is out. */
static const char *inside(strut_sweep_study *study, const char *directory, const char *name) {
  return strut_arena_format(&study->plan.arena, "%s/%s", directory, name);
}

static strut_status complain(strut_status status, const strut_error *error) {
  if (status != STRUT_OK) strut_print_error(error);
  return status;
}

/* Which part of the study is meant, and the file of its slots. */
static strut_status find_shard(const strut_arguments *arguments, strut_sweep_study *study,
                               strut_shard *shard, const char **path) {
  const strut_array_task task = {
      .id = getenv("SLURM_ARRAY_TASK_ID"),
      .min = getenv("SLURM_ARRAY_TASK_MIN"),
      .max = getenv("SLURM_ARRAY_TASK_MAX"),
      .step = getenv("SLURM_ARRAY_TASK_STEP"),
      .count = getenv("SLURM_ARRAY_TASK_COUNT"),
  };
  const char *text = strut_option_text(arguments, STRUT_OPTION_SHARD);
  strut_error error = {0};
  *shard = (strut_shard){0};
  strut_status status = text ? strut_shard_read(text, &task, shard, &error) : STRUT_OK;
  if (status) return complain(status, &error);
  if (shard->count) strut_shard_points(*shard, &study->slots);
  *path = strut_shard_path(arguments->output, *shard, &study->plan.arena);
  return *path ? STRUT_OK : strut_print_out_of_memory();
}

static strut_status show_status(const strut_arguments *arguments, strut_sweep_study *study) {
  strut_slots *slots = NULL;
  strut_slots_plan there;
  strut_error error = {0};
  strut_shard shard;
  const char *path;
  strut_shards_found found;
  strut_arena *arena = &study->plan.arena;
  strut_status status = find_shard(arguments, study, &shard, &path);
  if (status) return status;
  status = strut_shards_find(arguments->output, &found, arena, &error);
  if (status) return complain(status, &error);
  if (!shard.count && found.count)
    return strut_sweep_print_shards(arguments->output, &found, arena, arguments->json);
  status = strut_slots_read(path, &slots, &there, &error);
  if (status) return complain(status, &error);
  status = strut_sweep_print_status(slots, arguments->json);
  strut_slots_close(slots);
  return status;
}

static strut_status run_points(const strut_arguments *arguments, strut_sweep_study *study,
                               pace at_a_time, strut_slots *slots, strut_sweep_state *state,
                               strut_error *error) {
  strut_sweep_progress progress = strut_sweep_progress_begin(&study->plan, arguments->quiet);
  const strut_sweep_options how = {.threads = (int)at_a_time.threads,
                                   .lanes = (int)at_a_time.lanes,
                                   .interrupt = strut_interrupt_watch(),
                                   .directory = arguments->output,
                                   .progress = strut_sweep_progress_show,
                                   .progress_context = &progress};
  strut_status status = strut_sweep_texts_write(arguments, study, error);
  if (!status) status = strut_sweep_run(&study->plan, slots, &how, state, error);
  strut_sweep_progress_end(&progress);
  strut_sweep_print_warnings(state);
  strut_error late = {0};
  strut_status synced = strut_slots_sync(slots, &late);
  if (!status && synced) status = strut_fail(error, synced, "%s", late.message);
  if (status == STRUT_INTERRUPTED)
    strut_fail(error, status,
               "interrupted with %lld of %lld points done; the same command goes on from there",
               (long long)state->done, (long long)state->points);
  return status;
}

/* Points that failed are no reason to stop, but the exit code tells of them. */
static strut_status finish(const strut_arguments *arguments, strut_sweep_study *study,
                           strut_shard shard, strut_slots *slots, const strut_sweep_state *state) {
  strut_error error = {0};
  strut_slots *const sources[] = {slots};
  const char *table = shard.count ? "one shard: 'strut merge' makes the table of all"
                                  : inside(study, arguments->output, table_name);
  if (!table) return strut_print_out_of_memory();
  strut_status status =
      shard.count ? STRUT_OK
                  : strut_study_table_write(arguments->output, table_name, sources, 1, &error);
  if (status) return complain(status, &error);
  if (!shard.count) status = strut_sweep_figures_draw(&study->plan, arguments->output, table);
  if (status) return status;
  if (!arguments->quiet || arguments->json)
    status = strut_sweep_print_end(state, table, arguments->json);
  if (status || !state->failed) return status;
  fprintf(stderr,
          "strut: %lld of %lld points failed; the table's columns status and message say "
          "why\n",
          (long long)state->failed, (long long)state->points);
  return STRUT_DIVERGED;
}

static strut_status sweep(const strut_arguments *arguments, strut_sweep_study *study,
                          pace at_a_time) {
  strut_slots *slots = NULL;
  strut_sweep_state state = {0};
  strut_error error = {0};
  strut_shard shard;
  const char *path;
  strut_status status = find_shard(arguments, study, &shard, &path);
  if (status) return status;
  status = strut_sweep_texts_check(arguments, study, &error);
  if (!status && !shard.count)
    status = strut_sweep_figures_check_files(&study->plan, arguments->output, &error);
  if (!status) status = strut_directory_create(arguments->output, &error);
  if (!status) status = strut_shard_begin(arguments->output, shard, &error);
  if (!status) status = strut_slots_open(path, &study->slots, &slots, &error);
  if (!status && arguments->retry) status = strut_slots_retry(slots, &error);
  if (!status && !shard.count && strut_slots_missing(slots) > 0)
    strut_file_remove(arguments->output, table_name); /* it would be another sweep's */
  if (!status) status = run_points(arguments, study, at_a_time, slots, &state, &error);
  complain(status, &error);
  if (!status) status = finish(arguments, study, shard, slots, &state);
  strut_slots_close(slots);
  return status;
}

static strut_status run(const strut_arguments *arguments) {
  strut_sweep_study study = {0};
  pace at_a_time = {0};
  strut_status status = strut_option_integer(&strut_command_sweep, arguments, STRUT_OPTION_THREADS,
                                             1, MOST_THREADS, &at_a_time.threads);
  if (!status)
    status = strut_option_integer(&strut_command_sweep, arguments, STRUT_OPTION_LANES, 1,
                                  MOST_LANES, &at_a_time.lanes);
  if (status) return status;
  if (arguments->retry && (arguments->count_points || arguments->status ||
                           strut_option_text(arguments, STRUT_OPTION_EMIT))) {
    fputs("strut sweep: --retry is for computing, not for --count, --status or --emit\n", stderr);
    return STRUT_USAGE;
  }
  if (!arguments->output && !arguments->count_points) {
    fputs("strut sweep: -o DIR is missing, where the results go\n", stderr);
    return STRUT_USAGE;
  }
  status = strut_sweep_study_open(arguments, &study);
  if (!status && arguments->count_points)
    status = strut_sweep_print_count(&study.plan, arguments->json);
  else if (!status && strut_option_text(arguments, STRUT_OPTION_EMIT))
    status = strut_sweep_emit(arguments, study.plan.study->name);
  else if (!status && arguments->status)
    status = show_status(arguments, &study);
  else if (!status)
    status = sweep(arguments, &study, at_a_time);
  strut_sweep_study_close(&study);
  return status;
}

const strut_command strut_command_sweep = {
    .name = "sweep",
    .model = "STUDY",
    .summary = "runs a model at many points",
    .details =
        "\nA study is a file that names a model, axes over its parameters and what to keep of "
        "each\n"
        "run ('strut keys' explains it). DIR gets table.csv, a row for each point, and "
        "points.slots,\n"
        "where results are as soon as a point is done: whatever stops the program, the same "
        "command\n"
        "goes on where it was, and the table has the same bytes in the end, whatever the number "
        "of\n"
        "threads. Remove points.slots to begin anew.\n"
        "A point that fails is a row that says why; the exit code is 3 then, and only --retry\n"
        "computes it again. Ctrl-C stops soon.\n",
    .options = options,
    .run = run,
};
