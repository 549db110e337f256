/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/output/figures/table_figure.h"
#include "engine/study/cluster/cluster_script.h"
#include "engine/study/fit/fit.h"
#include "engine/study/report/study_report.h"
#include "engine/study/results/study_table.h"
#include "parser/program/command/scene_options.h"
#include "parser/program/commands.h"
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
    {.table = strut_svg_text_options},
    {STRUT_FILLS(count_points), "count", NULL, "only print the number of points and the columns"},
    {STRUT_FILLS(plan), "plan", NULL,
     "only print which measurements would determine the parameters of a fit best"},
    {STRUT_FILLS(status), "status", NULL, "only print what is done, missing and failed in DIR"},
    STRUT_PRINT_OPTIONS,
    {.name = NULL},
};

static const char table_name[] = "table.csv";

static strut_status show_status(const strut_arguments *arguments, strut_sweep_study *study) {
  strut_slots *slots = NULL;
  strut_slots_description there;
  strut_error error = {0};
  strut_shard shard;
  const char *path;
  strut_shards_found found;
  strut_arena *arena = &study->plan.arena;
  strut_status status = strut_sweep_find_shard(arguments, study, &shard, &path);
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
  return strut_print_failure(STRUT_FILE_TROUBLE, &error);
}

/* Prints the script for a cluster. */
static strut_status emit_script(const strut_arguments *arguments, strut_sweep_study *study) {
  strut_error error = {0};
  char program[PATH_MAX], folder[PATH_MAX], *text = NULL;
  strut_cluster_script script = {.name = study->plan.study->name,
                                 .study = arguments->model,
                                 .output = arguments->output,
                                 .time = arguments->time,
                                 .memory = arguments->memory,
                                 .shards = arguments->shards.value,
                                 .cpus = arguments->cpus.text ? arguments->cpus.value : 1,
                                 .program = program,
                                 .folder = folder};
  if (strcmp(arguments->model, "-") == 0)
    return strut_usage_error(arguments,
                             "--emit needs a file that the tasks can read, not standard input");
  if (!arguments->shards.text)
    return strut_usage_error(arguments, "--emit needs --shards N, the number of tasks");
  strut_status status = find_places(program, folder);
  if (status) return status;
  script.words = strut_sweep_words(arguments, &study->plan.arena, &script.word_count);
  if (!script.words) return strut_print_out_of_memory();
  status = strut_cluster_script_write(&script, &text, &error);
  if (status == STRUT_USAGE) fprintf(stderr, "strut sweep: --emit: %s\n", error.message);
  if (status == STRUT_NO_MEMORY) strut_print_error(&error);
  if (!status) status = strut_print(text);
  strut_release(text);
  if (!status && study->plan.study->refine.depth)
    strut_tell(arguments->listener, STRUT_MESSAGE_REMARK, NULL,
               "a refined study needs its shards in rounds: submit the script again until no shard "
               "asks for another");
  return status;
}

/* Refuses what the study cannot have: a figure of one table, several processes. */
static strut_status check_study(const strut_arguments *arguments, strut_sweep_study *opened) {
  const strut_study *study = opened->plan.study;
  const char *several = arguments->shard ? "--shard" : arguments->emit.text ? "--emit" : NULL;
  if (arguments->plot && (strut_study_has_stages(study) || study->follow))
    return strut_usage_error(arguments,
                             "--plot is for studies of single points: searches, fits and "
                             "branches of motions are drawn in DIR");
  if (!several) return STRUT_OK;
  if (study->sensitivity.wanted)
    return strut_usage_error(arguments,
                             "a sensitivity analysis needs all points in one file: run it "
                             "without --shard and --emit");
  if (study->follow) /* the branches of all points go into one folder */
    return strut_usage_error(arguments,
                             "%s cannot be used with a study that follows motions: its points run "
                             "on the threads of one machine",
                             several);
  return study->search ? strut_sweep_search_check_workers(arguments, opened) : STRUT_OK;
}

/* "gait" of "studies/gait.yaml": the usual directory of results; false if there is none. */
static bool name_results(const char *study, char name[PATH_MAX]) {
  const char *base = strrchr(study, '/') ? strrchr(study, '/') + 1 : study;
  const char *dot = strrchr(base, '.');
  int length = dot ? (int)(dot - base) : (int)strlen(base);
  return strcmp(study, "-") != 0 && length > 0 &&
         snprintf(name, PATH_MAX, "%.*s%s", length, base, dot ? "" : ".results") < PATH_MAX;
}

enum { WIDTH = 20, BAR_ROOM = 3 * WIDTH + 1, TEXT = 300 };

/* Between two lines without a terminal, and before the first bar [s]. */
static const double REPORT_INTERVAL = 30.0, PATIENCE = 0.5;

/* What a running study shows. */
typedef struct display {
  strut_progress bar;
  double reported; /* time of the latest line [s] */
} display;

/* "frequency 3.2 Hz, velocity 0.0098 m/s": the first few cells of a row. */
static void format_row(const strut_sweep_plan *plan, const strut_result_slot *row, char *text,
                       size_t size) {
  size_t used = 0, number = 0, word = 0, most = plan->axis_columns + 1;
  *text = '\0';
  for (size_t i = 0; i < plan->column_count && i < most && used < size; i++) {
    const strut_slot_column *column = &plan->columns[i];
    used += (size_t)snprintf(
        text + used, size - used, "%s%s %s", i ? ", " : "", column->name,
        column->word ? row->words[word++]
                     : strut_quantity_of_any(row->numbers[number++], 4, column->unit).text);
  }
  if (row->status != STRUT_OK && used < size)
    snprintf(text + used, size - used, ": %s", strut_status_text(row->status));
}

/* "123 of 1146 points (2 failed), 45 a second, 2 min 03 s left" */
static void format_state(const strut_sweep_state *state, char *text, size_t size) {
  char left[STRUT_DURATION_TEXT], failed[40] = "";
  double rate = state->seconds > 0.0 ? (double)state->computed / state->seconds : 0.0;
  strut_duration_text(rate > 0.0 ? (double)(state->points - state->done) / rate : HUGE_VAL, left);
  if (state->failed) snprintf(failed, sizeof failed, " (%lld failed)", (long long)state->failed);
  snprintf(text, size, "%lld of %lld points%s, %.3g a second, %s left", (long long)state->done,
           (long long)state->points, failed, rate, left);
}

static void show_state(const strut_study_job *job, const strut_sweep_state *state) {
  display *shown = job->context;
  strut_progress *bar = &shown->bar;
  char text[TEXT], row[TEXT], all[2 * TEXT + 40], blocks[BAR_ROOM];
  if (!state) strut_progress_end(bar);
  if (!state) return;
  if (job->arguments->quiet || state->seconds < PATIENCE) return;
  if (!bar->wanted && state->seconds - shown->reported < REPORT_INTERVAL) return;
  shown->reported = state->seconds;
  format_state(state, text, sizeof text);
  format_row(&job->study->plan, state->row, row, sizeof row);
  if (state->has_best)
    snprintf(all, sizeof all, "%s; best %.5g; %s", text, state->best, row);
  else
    snprintf(all, sizeof all, "%s; %s", text, row);
  if (!bar->wanted) {
    fprintf(stderr, "strut: %s\n", all);
    return;
  }
  int size = bar->columns - 1, width = size > 3 * WIDTH ? WIDTH : 0;
  strut_progress_bar(blocks, width, (double)state->done / (double)state->points);
  const char *on = bar->colour ? "\033[36m" : "", *off = bar->colour ? "\033[0m" : "";
  fprintf(stderr, "\r%s%s%s %-*.*s", on, blocks, off, size - width - 1, size - width - 1, all);
  fflush(stderr);
  bar->shown = true;
}

static strut_status print_result(const strut_study_job *job, const strut_value_rows *rows,
                                 const void *of, const char *json) {
  const strut_arguments *arguments = job->arguments;
  if (json && arguments->json) return strut_print(json);
  strut_status status = strut_print_values(arguments, rows, of, NULL);
  const char *mark = arguments->format.index ? "% " : "";
  if (json && !arguments->quiet) printf("%s%s/branches.csv\n", mark, arguments->output);
  return status;
}

static strut_status compute_study(const strut_arguments *arguments, strut_sweep_study *study) {
  display shown = {.bar = strut_progress_begin(arguments->quiet)};
  strut_study_job job = {.arguments = arguments,
                         .study = study,
                         .interrupt = strut_interrupt_watch(),
                         .context = &shown,
                         .progress = show_state,
                         .report = print_result};
  strut_status status = strut_study_job_compute(&job);
  strut_slots_close(job.slots);
  return status;
}

/* Which measurements would determine the parameters of a study that fits best. */
static strut_status show_plan(const strut_arguments *arguments, const strut_sweep_study *study) {
  strut_fit_plan plan = {0};
  strut_error error = {0};
  if (!study->plan.study->fit)
    return strut_usage_error(arguments, "--plan is for studies with 'fit'");
  strut_status status = strut_fit_plan_find(&study->plan, strut_interrupt_watch(), &plan, &error);
  strut_print_failure(status, &error);
  if (!status) status = strut_print_values(arguments, &strut_fit_plan_values, &plan, NULL);
  strut_arena_free(&plan.arena);
  return status;
}

/* --plot: the first result over the first axis, a curve for each value of the second, or as a map of both. */
static strut_status plot_table(const strut_arguments *arguments, strut_sweep_study *study,
                               const strut_plot *plot) {
  const strut_sweep_plan *plan = &study->plan;
  const strut_slot_column *columns = plan->columns;
  const char *path = strut_arena_format(&study->plan.arena, "%s/%s", arguments->output, table_name);
  strut_table table = {0};
  strut_error error = {0};
  size_t axes = plan->axis_columns, result = axes;
  bool map = axes == 2 && !columns[0].word && !columns[1].word;
  while (result < plan->column_count && columns[result].word) result++;
  if (result == plan->column_count || axes == 0)
    return strut_usage_error(arguments, "--plot needs a number among the results, and an axis");
  if (!path) return strut_print_out_of_memory();
  const strut_study_figure figure = {.kind = map ? STRUT_FIGURE_MAP : STRUT_FIGURE_LINES,
                                     .x = columns[0].name,
                                     .y = columns[map ? 1 : result].name,
                                     .color = columns[result].name,
                                     .series = axes > 1 ? columns[1].name : NULL,
                                     .panels = axes > 2 ? columns[2].name : NULL};
  strut_status status = strut_table_read(arguments->listener, path, &table);
  if (status) return status;
  strut_sweep_show_units(plan, &table);
  status = strut_table_draw(plot, &figure, &table, false, &error);
  strut_arena_free(&table.arena);
  return strut_print_failure(status, &error);
}

/* Refuses what would have no effect beside the options that only print. */
static strut_status check_combination(const strut_arguments *arguments) {
  const char *only = arguments->plan           ? "--plan"
                     : arguments->count_points ? "--count"
                     : arguments->status       ? "--status"
                     : arguments->emit.text    ? "--emit"
                                               : NULL;
  const char *extra = arguments->output ? "-o" : arguments->shard ? "--shard" : NULL;
  if (arguments->plot && (only || arguments->shard))
    return strut_usage_error(arguments, "--plot needs the table of all points");
  if (arguments->retry && only)
    return strut_usage_error(arguments,
                             "--retry cannot be combined with --count, --status, --emit or --plan");
  if (arguments->plan && extra)
    return strut_usage_error(arguments, "--plan only prints: %s has no effect on it", extra);
  return STRUT_OK;
}

static strut_status run_sweep(const strut_arguments *given) {
  strut_arguments own = *given, *arguments = &own;
  char results[PATH_MAX];
  strut_sweep_study study = {0};
  strut_plot plot;
  strut_status status = check_combination(arguments);
  if (!status && arguments->plot) status = strut_plot_read(arguments, 0, &plot);
  if (status) return status;
  if (!arguments->output && name_results(arguments->model, results)) own.output = results;
  if (!arguments->output && !arguments->count_points && !arguments->plan)
    return strut_usage_error(arguments, "missing -o DIR, the results directory");
  status = strut_sweep_study_open(arguments, &study);
  if (!status) status = check_study(arguments, &study);
  if (!status && arguments->plan)
    status = show_plan(arguments, &study);
  else if (!status && arguments->count_points)
    status = strut_print_values(arguments, &strut_sweep_count_values, &study.plan, NULL);
  else if (!status && arguments->emit.text)
    status = emit_script(arguments, &study);
  else if (!status && arguments->status)
    status = show_status(arguments, &study);
  else if (!status)
    status = compute_study(arguments, &study);
  if (arguments->plot &&
      (status == STRUT_OK || status == STRUT_DIVERGED || status == STRUT_INACCURATE)) {
    strut_status plotted = plot_table(arguments, &study, &plot);
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

/* `context`: the study. */
static strut_status check_refined(void *context, strut_slots *const *sources, size_t count,
                                  strut_error *error) {
  const strut_sweep_study *study = context;
  strut_refinement *refinement = NULL;
  strut_status status = strut_refinement_create(&study->plan, &refinement, error);
  for (size_t k = 0; k < count && !status; k++) {
    if (!sources[k])
      status = strut_fail(error, STRUT_FILE_TROUBLE, "shard %zu of %zu is missing", k, count);
    else if (strut_slots_description_of(sources[k])->points != study->plan.points)
      status = strut_fail(error, STRUT_USAGE, "shard %zu of %zu is of another study", k, count);
    else
      strut_refinement_learn(refinement, sources[k]);
  }
  int64_t unknown = status ? 0 : strut_refinement_choose(refinement);
  if (unknown)
    status = strut_fail(error, STRUT_FILE_TROUBLE,
                        "%lld points of the refinement are missing: run all shards again",
                        (long long)unknown);
  strut_refinement_free(refinement);
  return status;
}

/* Each worker of a search writes all files itself. Has one? */
static strut_status check_searches(const char *directory, bool quiet) {
  strut_error error = {0};
  if (!strut_sweep_search_is_finished(directory))
    return strut_print_failure(
        strut_fail(&error, STRUT_FILE_TROUBLE,
                   "'%s': the searches are not finished: run the study again to resume them",
                   directory),
        &error);
  if (!quiet) printf("%s/%s: the searches are finished\n", directory, table_name);
  return STRUT_OK;
}

/* Refined maps are merged where the points of all shards are those that their study wants. */
static strut_status merge(const strut_arguments *arguments, strut_sweep_study *refined) {
  const char *directory = arguments->model;
  strut_merged merged;
  strut_error error = {0};
  strut_status status =
      strut_merge(directory, refined ? check_refined : NULL, refined, &merged, &error);
  if (status) return strut_print_failure(status, &error);
  if (!arguments->quiet) {
    printf("%s/%s: %lld points", directory, table_name, (long long)merged.points);
    if (merged.shards && !refined) printf(" of %lld shards", (long long)merged.shards);
    printf("\n");
  }
  return strut_sweep_judge(arguments->listener, merged.points, merged.failed, merged.inaccurate);
}

static strut_status run_merge(const strut_arguments *arguments) {
  strut_sweep_study study = {0};
  strut_arena arena = {0};
  strut_error unused = {0};
  strut_arguments inner = *arguments;
  bool search = false, refined = false;
  allow_many_files();
  inner.model = strut_arena_format(&arena, "%s/study.yaml", arguments->model);
  if (inner.model && access(inner.model, R_OK) == 0 &&
      strut_study_open(inner.model, NULL, 0, &study.file, &unused) == STRUT_OK) {
    search = strut_study_has_stages(&study.file.study);
    refined = !search && study.file.study.refine.depth > 0;
  }
  strut_study_close(&study.file);
  study = (strut_sweep_study){0};
  strut_status status = refined ? strut_sweep_study_open(&inner, &study) : STRUT_OK;
  if (!status)
    status = search ? check_searches(arguments->model, arguments->quiet)
                    : merge(arguments, refined ? &study : NULL);
  strut_sweep_study_close(&study);
  strut_arena_free(&arena);
  return status;
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
