/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "engine/study/report/study_report.h"
#include "engine/study/results/study_table.h"
#include "parser/program/command/run_settings.h"
#include "parser/program/commands.h"
#include "parser/program/open_model.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"
#include "parser/program/study/sweep.h"

static const strut_option options[] = {
    STRUT_OUTPUT_OPTION(
        "DIR", "results directory (default: named after STUDY); an unfinished sweep is resumed"),
    {.table = strut_run_setting_options},
    STRUT_THREADS_OPTION,
    {STRUT_FILLS(retry), "retry", NULL, "recompute points that failed"},
    {STRUT_FILLS(shard), "shard", "K/N",
     "only points K, K+N, K+2N, ... with K from 0 to N-1, of a search as one of N workers; or "
     "slurm/N, pbs/N, torque/N, lsf/N, sge/N, kubernetes/N, env:VARIABLE/N"},
    {STRUT_FILLS(emit), "emit", "KIND", "only print a cluster script: slurm", .words = "slurm"},
    {STRUT_FILLS(shards), "shards", "N", "with --emit: number of shards", .least = 1,
     .most = STRUT_MOST_SHARDS},
    {STRUT_FILLS(cpus), "cpus", "N", "with --emit: processors per task (default 1)", .least = 1,
     .most = 4096},
    {STRUT_FILLS(time), "time", "TIME", "with --emit: time limit per task, such as 12:00:00"},
    {STRUT_FILLS(memory), "memory", "SIZE", "with --emit: memory per task, such as 2G"},
    STRUT_SET_OPTION,
    {STRUT_FILLS(plot), "plot", "FILE",
     "draw the first result over the first axis, or as a map of two (.svg, .pdf, .png or .json)"},
    {STRUT_FILLS(count_points), "count", NULL, "only print the number of points and the columns"},
    {STRUT_FILLS(plan), "plan", NULL,
     "only print which measurements would determine the parameters of a fit best"},
    {STRUT_FILLS(status), "status", NULL, "only print what is done, missing and failed in DIR"},
    {STRUT_FILLS(json), "json", NULL, "print one JSON object"},
    {.name = NULL},
};

static const char table_name[] = "table.csv";

/* DIR/name in the study's arena, or NULL. */
static const char *inside(strut_sweep_study *study, const char *directory, const char *name) {
  return strut_arena_format(&study->plan.arena, "%s/%s", directory, name);
}

/* Finds the shard that --shard names, and the file of its slots, which the workers of a search share. */
static strut_status find_shard(const strut_arguments *arguments, strut_sweep_study *study,
                               strut_shard *shard, const char **path) {
  const strut_array_task task = {
      .id = getenv("SLURM_ARRAY_TASK_ID"),
      .min = getenv("SLURM_ARRAY_TASK_MIN"),
      .max = getenv("SLURM_ARRAY_TASK_MAX"),
      .step = getenv("SLURM_ARRAY_TASK_STEP"),
      .count = getenv("SLURM_ARRAY_TASK_COUNT"),
      .variable = getenv,
  };
  const char *text = arguments->shard;
  strut_error error = {0};
  *shard = (strut_shard){0};
  strut_status status = text ? strut_shard_read(text, &task, shard, &error) : STRUT_OK;
  if (status) return strut_print_failure(status, &error);
  const strut_shard part = strut_study_has_stages(study->plan.study) ? (strut_shard){0} : *shard;
  if (part.count) strut_shard_points(part, &study->slots);
  *path = strut_shard_path(arguments->output, part, &study->plan.arena);
  return *path ? STRUT_OK : strut_print_out_of_memory();
}

static strut_status show_status(const strut_arguments *arguments, strut_sweep_study *study) {
  strut_slots *slots = NULL;
  strut_slots_description there;
  strut_error error = {0};
  strut_shard shard;
  const char *path;
  strut_shards_found found;
  strut_arena *arena = &study->plan.arena;
  strut_status status = find_shard(arguments, study, &shard, &path);
  if (status) return status;
  status = strut_shards_find(arguments->output, &found, arena, &error);
  if (status) return strut_print_failure(status, &error);
  if (!shard.count && found.count) {
    strut_shards_progress progress;
    status = strut_shards_progress_find(arguments->output, &found, arena, &progress, &error);
    if (status) return strut_print_failure(status, &error);
    return strut_print_values(arguments, &strut_shards_progress_values, &progress, NULL);
  }
  status = strut_slots_read(path, &slots, &there, &error);
  if (status) return strut_print_failure(status, &error);
  strut_slots_progress progress;
  strut_slots_progress_find(slots, &progress);
  progress.searches = strut_study_has_stages(study->plan.study);
  progress.finished = progress.searches && strut_sweep_search_is_finished(arguments->output);
  if (study->plan.study->refine.depth)
    status = strut_sweep_refine_status(&study->plan, arguments->output, slots, &progress, &error);
  strut_slots_close(slots);
  if (status) return strut_print_failure(status, &error);
  return strut_print_values(arguments, &strut_slots_progress_values, &progress, NULL);
}

/* `context`: the refinement, or NULL. */
static strut_status run_points(strut_study_job *job, const strut_sweep_options *given,
                               void *context, strut_error *error) {
  strut_sweep_options how = *given;
  if (context) {
    how.wants = strut_refinement_wants;
    how.wants_context = context;
    strut_refinement_count(context, job->slots, &how.wanted, &how.wanted_done);
  }
  return strut_sweep_run(&job->study->plan, job->slots, &how, &job->state, error);
}

/* Adds the warnings of a round to those before. */
static void add_warnings(strut_sweep_state *all, const strut_sweep_state *round) {
  for (size_t i = 0; i < round->warning_count; i++) {
    const strut_sweep_warning *warning = &round->warnings[i];
    size_t at = 0;
    while (at < all->warning_count && strcmp(all->warnings[at].code, warning->code) != 0) at++;
    if (at == STRUT_SWEEP_MOST_WARNINGS) continue;
    int64_t runs = at < all->warning_count ? all->warnings[at].runs : 0;
    bool first = at == all->warning_count || warning->point < all->warnings[at].point;
    if (at == all->warning_count) all->warning_count++;
    if (first) all->warnings[at] = *warning;
    all->warnings[at].runs = runs + warning->runs;
  }
}

/*
 * Computes what is wanted until that wants nothing further. *others: points of other shards that must be
 * known before more can be.
 */
static strut_status run_refined(strut_study_job *job, strut_refinement *refinement, int64_t *others,
                                strut_error *error) {
  int64_t wanted, done;
  strut_sweep_state all = {0}, *state = &job->state;
  strut_status status = STRUT_OK;
  for (bool first = true; !status; first = false) {
    strut_sweep_refine_learn(refinement, job->arguments->output, job->shard, job->slots);
    *others = strut_refinement_choose(refinement);
    strut_refinement_count(refinement, job->slots, &wanted, &done);
    if (wanted == done && !first) break;
    status = strut_study_job_run(job, run_points, refinement, error);
    all.computed += state->computed;
    all.seconds += state->seconds;
    add_warnings(&all, state);
  }
  state->computed = all.computed;
  state->seconds = all.seconds;
  state->warning_count = all.warning_count;
  memcpy(state->warnings, all.warnings, sizeof all.warnings);
  return status;
}

/* Writes table and figures. Failed points do not stop a sweep, but change the exit code. */
static strut_status complete_sweep(const strut_study_job *job, const strut_refinement *refinement) {
  const strut_arguments *arguments = job->arguments;
  const bool whole = !job->shard.count;
  strut_error error = {0};
  strut_slots *const sources[] = {job->slots};
  const char *table = whole ? inside(job->study, arguments->output, table_name)
                            : "one shard: 'strut sweep --merge' writes the table of all";
  if (!table) return strut_print_out_of_memory();
  strut_status status = STRUT_OK;
  if (whole && refinement)
    status =
        strut_study_table_write_partial(arguments->output, table_name, sources, 1, NULL, &error);
  else if (whole)
    status = strut_study_table_write(arguments->output, table_name, sources, 1, &error);
  if (status) return strut_print_failure(status, &error);
  if (whole) strut_file_remove(arguments->output, STRUT_PARTIAL_TABLE);
  if (whole)
    status = strut_sweep_figures_draw(&job->study->plan, arguments->output, table, refinement);
  if (status) return status;
  status = strut_print_values(arguments, &strut_sweep_end_values,
                              &(strut_sweep_end){&job->state, table}, NULL);
  if (!status && whole)
    status = strut_sweep_sensitivity_complete(arguments, &job->study->plan, job->slots);
  return status ? status
                : strut_sweep_judge(job->state.points, job->state.failed,
                                    strut_slots_inaccurate(job->slots));
}

static strut_status sweep(strut_study_job *job) {
  strut_error error = {0};
  strut_refinement *refinement = NULL;
  int64_t others = 0;
  strut_status status = STRUT_OK;
  if (job->study->plan.study->refine.depth)
    status = strut_refinement_create(&job->study->plan, &refinement, &error);
  if (!status)
    status = refinement ? run_refined(job, refinement, &others, &error)
                        : strut_study_job_run(job, run_points, NULL, &error);
  strut_sweep_print_warnings(&job->state);
  strut_print_failure(status, &error);
  if (!status) status = complete_sweep(job, refinement);
  if (others && (!status || status == STRUT_DIVERGED || status == STRUT_INACCURATE))
    fprintf(stderr,
            "strut: %lld points of other shards decide what is refined next: run this shard again "
            "when they are done\n",
            (long long)others);
  strut_refinement_free(refinement);
  return status;
}

static strut_status compute_study(const strut_arguments *arguments, strut_sweep_study *study) {
  strut_study_job job = {.arguments = arguments, .study = study};
  strut_error error = {0};
  const char *path;
  strut_status status = find_shard(arguments, study, &job.shard, &path);
  if (status) return status;
  status = strut_print_failure(strut_study_job_open(&job, path, &error), &error);
  if (!status)
    status = study->plan.study->search   ? strut_sweep_search(&job)
             : study->plan.study->follow ? strut_sweep_follow(&job)
             : study->plan.study->fit    ? strut_sweep_fit(&job)
                                         : sweep(&job);
  strut_slots_close(job.slots);
  return status;
}

/* Prints the script for a cluster. */
static strut_status emit_script(const strut_arguments *arguments, const strut_study *study) {
  strut_status status = strut_sweep_emit(arguments, study->name);
  if (!status && study->refine.depth)
    fputs(
        "strut: a refined study needs its shards in rounds: submit the script again until no shard "
        "asks for another\n",
        stderr);
  return status;
}

/* A search decides by each point where the next one is. */
static strut_status check_search(const strut_arguments *arguments, strut_sweep_study *study) {
  if (arguments->retry)
    return strut_usage_error(
        arguments,
        "--retry cannot be used with a study that searches or fits: each of its "
        "points depends on those before it");
  bool several = study->plan.study->search && (arguments->shard || arguments->emit.text);
  return several ? strut_sweep_search_check_workers(study) : STRUT_OK;
}

/* The branches of all points go into one folder. */
static strut_status check_follow(const strut_arguments *arguments) {
  const char *option = arguments->shard ? "--shard" : arguments->emit.text ? "--emit" : NULL;
  if (!option) return STRUT_OK;
  return strut_usage_error(
      arguments,
      "%s cannot be used with a study that follows motions: its points run on the threads of one "
      "machine",
      option);
}

/* "gait" of "studies/gait.yaml": the usual directory of results; false if there is none. */
static bool name_results(const char *study, char name[PATH_MAX]) {
  const char *base = strrchr(study, '/') ? strrchr(study, '/') + 1 : study;
  const char *dot = strrchr(base, '.');
  int length = dot ? (int)(dot - base) : (int)strlen(base);
  return strcmp(study, "-") != 0 && length > 0 &&
         snprintf(name, PATH_MAX, "%.*s%s", length, base, dot ? "" : ".results") < PATH_MAX;
}

/* --plot: the first result over the first axis, as `strut plot` draws it. */
static strut_status plot_table(const strut_arguments *arguments, const strut_sweep_study *study) {
  const strut_sweep_plan *plan = &study->plan;
  char path[PATH_MAX];
  size_t y = plan->axis_columns;
  bool map = plan->axis_columns == 2 && !plan->columns[0].word && !plan->columns[1].word;
  while (y < plan->column_count && plan->columns[y].word) y++;
  if (y == plan->column_count || plan->axis_columns == 0)
    return strut_usage_error(arguments, "--plot needs a number among the results, and an axis");
  if (snprintf(path, sizeof path, "%s/%s", arguments->output, table_name) >= (int)sizeof path)
    return strut_usage_error(arguments, "the path of the table is too long");
  const strut_arguments own = {.command = &strut_command_plot,
                               .listener = arguments->listener,
                               .quiet = arguments->quiet,
                               .model = path,
                               .plot = arguments->plot,
                               .kind.index = map,
                               .x = plan->columns[0].name,
                               .y = plan->columns[map ? 1 : y].name,
                               .label = map ? plan->columns[y].name : NULL,
                               .by = !map && plan->axis_columns > 1 ? plan->columns[1].name : NULL};
  return strut_command_plot.run(&own);
}

static strut_status run_sweep(const strut_arguments *given) {
  strut_arguments own = *given, *arguments = &own;
  char results[PATH_MAX];
  strut_sweep_study study = {0};
  if (arguments->plot &&
      (arguments->count_points || arguments->status || arguments->emit.text || arguments->shard))
    return strut_usage_error(arguments, "--plot needs the table of all points");
  strut_status status = strut_try_file(arguments->plot);
  if (status) return status;
  if (!arguments->output && name_results(arguments->model, results)) own.output = results;
  if (!arguments->output && !arguments->count_points && !arguments->plan)
    return strut_usage_error(arguments, "missing -o DIR, the results directory");
  if (arguments->retry && (arguments->count_points || arguments->status || arguments->emit.text))
    return strut_usage_error(arguments,
                             "--retry cannot be combined with --count, --status or --emit");
  status = strut_sweep_study_open(arguments, &study);
  if (!status && arguments->plot &&
      (strut_study_has_stages(study.plan.study) || study.plan.study->follow))
    status = strut_usage_error(arguments,
                               "--plot is for studies of single points: searches, fits and "
                               "branches of motions are drawn in DIR");
  if (!status && study.plan.study->sensitivity.wanted && (arguments->shard || arguments->emit.text))
    status = strut_usage_error(arguments,
                               "a sensitivity analysis needs all points in one file: run it "
                               "without --shard and --emit");
  if (!status && strut_study_has_stages(study.plan.study)) status = check_search(arguments, &study);
  if (!status && study.plan.study->follow) status = check_follow(arguments);
  if (!status && arguments->plan)
    status = strut_sweep_fit_plan(arguments, &study);
  else if (!status && arguments->count_points)
    status = strut_print_values(arguments, &strut_sweep_count_values, &study.plan, NULL);
  else if (!status && arguments->emit.text)
    status = emit_script(arguments, study.plan.study);
  else if (!status && arguments->status)
    status = show_status(arguments, &study);
  else if (!status)
    status = compute_study(arguments, &study);
  if (arguments->plot &&
      (status == STRUT_OK || status == STRUT_DIVERGED || status == STRUT_INACCURATE)) {
    strut_status plotted = plot_table(arguments, &study);
    if (plotted) status = plotted;
  }
  strut_sweep_study_close(&study);
  return status;
}

static const strut_command_variant forms[] = {{"merge", &strut_command_merge}, {NULL, NULL}};

static const char sweep_details[] =
    "\nSTUDY is a file that names a model, axes over its parameters and what to keep of each run\n"
    "(see 'strut keys'). DIR receives table.csv, one row per point, and points.slots, which\n"
    "stores every result as soon as its point is finished. After any interruption the same\n"
    "command resumes; the final table is the same byte for byte, whatever the number of\n"
    "threads. Remove points.slots to start afresh.\n"
    "An interrupted sweep leaves table-partial.csv, the rows that are done.\n"
    "A failed point is a row that gives the reason; the exit code is then 3, and only --retry\n"
    "recomputes it. Where an accuracy is requested, the column accuracy_kept says of each point\n"
    "whether it was reached; the exit code is 5 if it was not everywhere. Ctrl-C stops after a\n"
    "moment.\n";

const strut_command strut_command_sweep = {
    .name = "sweep",
    .model = "STUDY",
    .summary = "computes a model at many parameter values, or searches for the best ones",
    .details = sweep_details,
    .options = options,
    .run = run_sweep,
    .forms = forms,
};

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
  if (status != STRUT_OK) return strut_print_failure(status, &error);
  if (!arguments->quiet) {
    printf("%s/table.csv: %lld points", arguments->model, (long long)merged.points);
    if (merged.shards) printf(" of %lld shards", (long long)merged.shards);
    printf("\n");
  }
  return strut_sweep_judge(merged.points, merged.failed, merged.inaccurate);
}

static const strut_option merge_options[] = {
    {.kind = STRUT_OPTION_SELECTOR, .name = "merge", NULL, "merge the shards in DIR"},
    {.name = NULL},
};

const strut_command strut_command_merge = {
    .name = "sweep --merge",
    .model = "DIR",
    .summary = "merges the shards of a sweep into one table",
    .details =
        "\nDIR is the --output of the shards. All shards must be present, complete, and of the "
        "same\n"
        "study, model and version of strut. DIR/table.csv is then byte for byte the table of an\n"
        "undivided sweep; otherwise the command reports what is missing. The workers of a search\n"
        "write its files themselves: the command then reports whether they have.\n"
        "\nExit code: 3 if points of the study failed, 4 if shards or points are missing, else 5 "
        "if\n"
        "points are less accurate than requested.\n",
    .options = merge_options,
    .run = run_merge,
};
