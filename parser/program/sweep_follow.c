/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut sweep` of a study that follows motions. */
#include <stdio.h>
#include <string.h>

#include "engine/output/file.h"
#include "engine/study/follow/follow_parts.h"
#include "engine/study/results/study_table.h"
#include "parser/program/option_values.h"
#include "parser/program/streams.h"
#include "parser/program/sweep.h"
#include "parser/program/table_file.h"

static const char table_name[] = "table.csv", partial_name[] = "table-partial.csv";
static const char branches_name[] = "branches.csv";
static const char partial_branches_name[] = "branches-partial.csv";
static const double PAGE = 510.24; /* 180 mm [pt] */

static strut_status setup_at(void *context, const strut_study_value *values, double value,
                             strut_setup *setup, strut_error *error) {
  return strut_study_setup_at(context, values, value, setup, error);
}

strut_status strut_sweep_follow_check(strut_sweep_study *study, strut_error *error) {
  const strut_follow_points_options how = {.setup = setup_at, .context = &study->file};
  strut_status status = strut_follow_points_columns(&study->plan, error);
  return status ? status : strut_follow_points_check(&study->plan, &how, error);
}

/* What is there of an interrupted study. */
static void write_partial(const strut_arguments *arguments, const strut_sweep_plan *plan,
                          strut_slots *slots) {
  int64_t rows = 0, points = 0;
  strut_error error = {0};
  strut_slots *const sources[] = {slots};
  strut_status status =
      strut_study_table_write_partial(arguments->output, partial_name, sources, 1, &points, &error);
  if (!status)
    status = strut_follow_points_combine(plan, slots, arguments->output, partial_branches_name,
                                         true, &rows, &error);
  if (status)
    strut_print_error(&error);
  else
    fprintf(stderr, "strut: %s/%s has what was followed so far, %lld points of branches\n",
            arguments->output, partial_branches_name, (long long)rows);
}

static strut_status run_points(const strut_arguments *arguments, strut_sweep_study *study,
                               int threads, strut_slots *slots, strut_sweep_state *state,
                               strut_error *error) {
  strut_sweep_progress shown = strut_sweep_progress_begin(&study->plan, arguments->quiet);
  const strut_follow_points_options how = {.setup = setup_at,
                                           .context = &study->file,
                                           .directory = arguments->output,
                                           .threads = threads,
                                           .interrupt = strut_interrupt_watch(),
                                           .progress = strut_sweep_progress_show,
                                           .progress_context = &shown};
  strut_status status = strut_sweep_texts_write(arguments, study, error);
  if (!status) status = strut_follow_points_run(&study->plan, slots, &how, state, error);
  strut_sweep_progress_end(&shown);
  strut_error late = {0};
  strut_status synced = strut_slots_sync(slots, &late);
  if (!status && synced) status = strut_fail(error, synced, "%s", late.message);
  if (status == STRUT_INTERRUPTED) {
    write_partial(arguments, &study->plan, slots);
    strut_fail(error, status, "interrupted after %lld of %lld points; the same command resumes",
               (long long)state->done, (long long)state->points);
  }
  return status;
}

static strut_status draw_branches(const strut_arguments *arguments, strut_sweep_plan *plan,
                                  strut_error *error) {
  strut_table table = {0};
  const char *from = strut_arena_format(&plan->arena, "%s/%s", arguments->output, branches_name);
  const strut_plot plot = {
      .path = strut_arena_format(&plan->arena, "%s/branches.svg", arguments->output),
      .width = PAGE};
  if (!from || !plot.path) return strut_no_memory(error, "");
  strut_status status = strut_table_read(from, &table);
  if (!status) status = strut_follow_points_figure(&plot, plan, &table, error);
  strut_arena_free(&table.arena);
  return status;
}

/* Writes branches.csv, branches.svg, report.json and the table; *report: the JSON text. */
static strut_status write_results(const strut_arguments *arguments, strut_sweep_plan *plan,
                                  strut_slots *slots, char **report, strut_error *error) {
  strut_slots *const sources[] = {slots};
  const char *directory = arguments->output;
  int64_t rows = 0;
  strut_status status =
      strut_follow_points_combine(plan, slots, directory, branches_name, false, &rows, error);
  if (!status && rows) status = draw_branches(arguments, plan, error);
  if (!status) status = strut_follow_points_json(plan, slots, directory, report, error);
  if (!status) status = strut_file_write_text(directory, "report.json", *report, error);
  if (!status) status = strut_study_table_write(directory, table_name, sources, 1, error);
  if (status) return status;
  strut_file_remove(directory, partial_name);
  strut_file_remove(directory, partial_branches_name);
  return STRUT_OK;
}

static strut_status print_report(const strut_arguments *arguments, const strut_sweep_plan *plan,
                                 strut_slots *slots, const char *report) {
  if (arguments->json) return strut_print(report);
  if (arguments->quiet) return STRUT_OK;
  char *text = strut_follow_points_table(plan, slots);
  strut_status status = text ? strut_print(text) : strut_print_out_of_memory();
  strut_release(text);
  if (!status) printf("%s/%s\n", arguments->output, branches_name);
  return status;
}

static strut_status complete(const strut_arguments *arguments, strut_sweep_study *study,
                             strut_slots *slots) {
  strut_error error = {0};
  char *report = NULL;
  strut_sweep_plan *plan = &study->plan;
  strut_status status = write_results(arguments, plan, slots, &report, &error);
  if (status) strut_print_failure(status, &error);
  const char *table = strut_arena_format(&plan->arena, "%s/%s", arguments->output, table_name);
  if (!status && !table) status = strut_print_out_of_memory();
  if (!status) status = strut_sweep_figures_draw(plan, arguments->output, table, NULL);
  if (!status) status = print_report(arguments, plan, slots, report);
  strut_release(report);
  return status ? status
                : strut_sweep_judge(plan->points, strut_slots_failed(slots),
                                    strut_slots_inaccurate(slots));
}

strut_status strut_sweep_follow(const strut_arguments *arguments, strut_sweep_study *study,
                                int threads) {
  strut_slots *slots = NULL;
  strut_sweep_state state = {0};
  strut_error error = {0};
  const char *path = strut_shard_path(arguments->output, (strut_shard){0}, &study->plan.arena);
  if (!path) return strut_print_out_of_memory();
  strut_status status = strut_sweep_texts_check(arguments, study, &error);
  if (!status) status = strut_sweep_figures_check_files(&study->plan, arguments->output, &error);
  if (!status) status = strut_directory_create(arguments->output, &error);
  if (!status) status = strut_shard_begin(arguments->output, (strut_shard){0}, &error);
  if (!status) status = strut_slots_open(path, &study->slots, &slots, &error);
  if (!status && arguments->retry) status = strut_slots_retry(slots, &error);
  if (!status && strut_slots_missing(slots) > 0)
    strut_file_remove(arguments->output, table_name); /* outdated */
  if (!status) status = run_points(arguments, study, threads, slots, &state, &error);
  strut_print_failure(status, &error);
  if (!status) status = complete(arguments, study, slots);
  strut_slots_close(slots);
  return status;
}
