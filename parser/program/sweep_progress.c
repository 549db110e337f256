/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/sweep.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/number_text.h"
#include "parser/program/streams.h"

enum { WIDTH = 20, BAR_ROOM = 3 * WIDTH + 1, TEXT = 300 };

/* Between two lines without a terminal, and before the first bar [s]. */
static const double REPORT_INTERVAL = 30.0, PATIENCE = 0.5;

strut_sweep_progress strut_sweep_progress_begin(const strut_sweep_plan *plan, bool quiet) {
  return (strut_sweep_progress){.bar = strut_progress_begin(quiet), .plan = plan, .quiet = quiet};
}

/* "frequency 3.2 Hz, velocity 0.0098 m/s": the first few cells of a row. */
static void format_row(const strut_sweep_plan *plan, const strut_result_slot *row, char *text,
                       size_t size) {
  size_t used = 0, number = 0, word = 0, most = plan->axis_columns + 1;
  *text = '\0';
  for (size_t i = 0; i < plan->column_count && i < most && used < size; i++) {
    const strut_slot_column *c = &plan->columns[i];
    const char *unit = strcmp(c->unit, "1") == 0 ? "" : c->unit;
    int n = c->word ? snprintf(text + used, size - used, "%s%s %s", i ? ", " : "", c->name,
                               row->words[word++])
                    : snprintf(text + used, size - used, "%s%s %.4g%s%s", i ? ", " : "", c->name,
                               row->numbers[number++], *unit ? " " : "", unit);
    used += n > 0 ? (size_t)n : 0;
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

void strut_sweep_progress_show(void *context, const strut_sweep_state *state) {
  strut_sweep_progress *progress = context;
  strut_progress *bar = &progress->bar;
  char text[TEXT], row[TEXT], all[2 * TEXT + 40], blocks[BAR_ROOM];
  if (progress->quiet || state->seconds < PATIENCE) return;
  if (!bar->wanted && state->seconds - progress->reported < REPORT_INTERVAL) return;
  progress->reported = state->seconds;
  format_state(state, text, sizeof text);
  format_row(progress->plan, state->row, row, sizeof row);
  if (state->has_best)
    snprintf(all, sizeof all, "%s; best %.5g; %s", text, state->best, row);
  else
    snprintf(all, sizeof all, "%s; %s", text, row);
  if (!bar->wanted) {
    fprintf(stderr, "strut: %s\n", all);
    return;
  }
  int size = bar->columns - 1, width = size > 3 * WIDTH ? WIDTH : 0;
  strut_progress_bar(blocks, width, (double)state->done / (double)state->points, bar->unicode);
  const char *on = bar->colour ? "\033[36m" : "", *off = bar->colour ? "\033[0m" : "";
  fprintf(stderr, "\r%s%s%s %-*.*s", on, blocks, off, size - width - 1, size - width - 1, all);
  fflush(stderr);
  bar->shown = true;
}

void strut_sweep_progress_end(strut_sweep_progress *progress) {
  strut_progress_end(&progress->bar);
}

void strut_sweep_print_warnings(const strut_sweep_state *state) {
  for (size_t i = 0; i < state->warning_count; i++) {
    const strut_sweep_warning *w = &state->warnings[i];
    fprintf(stderr, "strut: warning: %lld of %lld runs, first point %lld: %s\n", (long long)w->runs,
            (long long)state->computed, (long long)w->point, w->text);
  }
}

strut_status strut_sweep_judge(int64_t points, int64_t failed, int64_t inaccurate) {
  if (failed)
    fprintf(stderr,
            "strut: %lld of %lld points failed: see the table's columns status and message\n",
            (long long)failed, (long long)points);
  if (inaccurate)
    fprintf(stderr,
            "strut: %lld of %lld points are less accurate than requested: see the table's "
            "column " STRUT_KEPT_COLUMN "\n",
            (long long)inaccurate, (long long)points);
  return failed ? STRUT_DIVERGED : inaccurate ? STRUT_INACCURATE : STRUT_OK;
}
