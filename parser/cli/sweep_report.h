/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What `strut sweep` says: while it runs, at its end, and of a study's state on disk.
 */
#ifndef STRUT_PARSER_CLI_SWEEP_REPORT_H
#define STRUT_PARSER_CLI_SWEEP_REPORT_H

#include "engine/study/sweep/sweep.h"
#include "parser/cli/progress.h"

/** A bar on a terminal, a line now and then elsewhere. */
typedef struct strut_sweep_progress {
  strut_progress bar;
  const strut_sweep_plan *plan;
  bool quiet;
  double told; /* seconds of the sweep at the latest line */
} strut_sweep_progress;

strut_sweep_progress strut_sweep_progress_begin(const strut_sweep_plan *plan, bool quiet);
/** `context` is the strut_sweep_progress. */
void strut_sweep_progress_show(void *context, const strut_sweep_state *state);
void strut_sweep_progress_end(strut_sweep_progress *progress);

/** How many points and which columns, on stdout. */
strut_status strut_sweep_print_count(const strut_sweep_plan *plan, bool json);
/** What is done, missing and failed in a file of slots, on stdout. */
strut_status strut_sweep_print_status(strut_slots *slots, bool json);
/** Each warning that runs gave, once, on stderr. */
void strut_sweep_print_warnings(const strut_sweep_state *state);
/** The end of a sweep, on stdout. `table`: its path. */
strut_status strut_sweep_print_end(const strut_sweep_state *state, const char *table, bool json);

#endif
