/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Studies by file, for `strut sweep` and the library: the study that is opened, copies of its texts, what
 * computes it, its results and figures. All messages go to the arguments' listener.
 */
#pragma once

#include "engine/output/record_files.h"
#include "engine/study/report/study_report.h"
#include "engine/study/results/study_table.h"
#include "engine/study/search/search.h"
#include "engine/study/sweep/sweep.h"
#include "engine/study/sweep/sweep_parts.h"
#include "parser/language/study/read_study.h"
#include "parser/program/command/arguments.h"

/** Stays where it is while in use. Zero-initialise; strut_sweep_study_close releases it. */
typedef struct strut_sweep_study {
  strut_study_file file;
  strut_sweep_plan plan;
  strut_slots_description slots; /* of all points in one file */
} strut_sweep_study;

/**
 * Opens the study that the command's argument names, and tells its messages and notes; close it after a
 * failure too. The first point and the ends of every axis must make a model.
 */
strut_status strut_sweep_study_open(const strut_arguments *arguments, strut_sweep_study *study);
/** The same without messages: those about a place are in the file's diagnostics, others in `error`. */
strut_status strut_sweep_study_try(const strut_arguments *arguments, strut_sweep_study *study,
                                   strut_error *error);
/** Tells the messages of a failure; returns `status`. */
strut_status strut_sweep_study_report(const strut_listener *listener, strut_sweep_study *study,
                                      strut_status status, const strut_error *error);
/** Reports what is wrong with a number of a fit where the study names it; STRUT_BAD_SCENE. */
strut_status strut_sweep_refuse_series(strut_sweep_study *study, const strut_fit_series *at,
                                       const char *why, const char *hint);
/** Its settings and options, each before its value; NULL: memory is out. */
const char *const *strut_sweep_words(const strut_arguments *arguments, strut_arena *arena,
                                     size_t *count);
void strut_sweep_study_close(strut_sweep_study *study);

/** Checks that all figures name existing columns. On STRUT_BAD_SCENE the study's messages say where and why. */
strut_status strut_sweep_figures_check(strut_sweep_study *study);
/**
 * Fails where strut would have to overwrite somebody else's table.csv or picture. Pictures of single runs
 * are refused when they are drawn.
 */
strut_status strut_sweep_figures_check_files(const strut_sweep_plan *plan, const char *directory,
                                             strut_error *error);
/** How far the refinement in a directory is. */
strut_status strut_sweep_refine_status(const strut_sweep_plan *plan, const char *directory,
                                       strut_slots *slots, strut_slots_progress *progress,
                                       strut_error *error);

#define STRUT_PARTIAL_TABLE "table-partial.csv"

/** A study that is computed, and where its results go. */
typedef struct strut_study_job strut_study_job;
struct strut_study_job {
  const strut_arguments *arguments;
  strut_sweep_study *study;
  const strut_flag *interrupt;
  void *context;
  /** A few times a second, one thread at a time; `state` NULL: the computation has ended. */
  void (*progress)(const strut_study_job *job, const strut_sweep_state *state);
  /** Shows a result; `json`: what --json is, if not these values, or NULL. */
  strut_status (*report)(const strut_study_job *job, const strut_value_rows *rows, const void *of,
                         const char *json);
  strut_shard shard;  /* of a search: which of its workers; count 0: none */
  strut_slots *slots; /* strut_slots_close closes them */
  strut_sweep_state state;
  strut_refinement *refinement;        /* of a refined map, or NULL */
  const strut_search_result *searched; /* of a search, once it is there */
  int64_t others; /* points of other shards that must be known before more can be */
};

/** Finds the shard that --shard names, and the file of its slots, which the workers of a search share. */
strut_status strut_sweep_find_shard(const strut_arguments *arguments, strut_sweep_study *study,
                                    strut_shard *shard, const char **path);
/** Computes or resumes the study, writes and reports its results. Close the slots, whatever it returns. */
strut_status strut_study_job_compute(strut_study_job *job);

/** Opens or creates the job's file of slots, in a directory that no one else's results are in. */
strut_status strut_study_job_open(strut_study_job *job, const char *path, strut_error *error);
/** Computes the job's points; `options` have progress and interrupt. */
typedef strut_status strut_study_compute(strut_study_job *job, const strut_sweep_options *options,
                                         void *context, strut_error *error);
/** Does that with progress, and now and then the table of the rows that there are, also when it has failed. */
strut_status strut_study_job_run(strut_study_job *job, strut_study_compute *compute, void *context,
                                 strut_error *error);

/** A form of studies: what it computes, and what it does with its result of `size` bytes, zero at first. */
typedef struct strut_study_form {
  size_t size;
  strut_study_compute *compute; /* `context`: the result */
  /** Writes files besides the table, before it. May be NULL. */
  strut_status (*write)(const strut_study_job *job, void *result, strut_error *error);
  /** Reports the result, whose table is there, and tells what failed or is inaccurate. */
  strut_status (*report)(const strut_study_job *job, const void *result, const char *table);
  void (*release)(void *result); /* may be NULL */
} strut_study_form;
extern const strut_study_form strut_follow_form;

/** Draws each figure as DIR/NAME.svg, of the table at `path` or of the runs beside it. */
strut_status strut_sweep_figures_draw(const strut_study_job *job, const char *path);
/** Tells each warning of the runs once, with its count. */
void strut_sweep_tell_warnings(const strut_study_job *job);
/** Tells how many points failed or are inaccurate; the status that follows from it. */
strut_status strut_sweep_judge(const strut_listener *listener, int64_t points, int64_t failed,
                               int64_t inaccurate);

/** STRUT_BAD_SCENE, which is told, where several workers could not share the search. */
strut_status strut_sweep_search_check_workers(const strut_arguments *arguments,
                                              strut_sweep_study *study);
/** Do points depend on those before, so that shards are workers that share one file? */
static inline bool strut_study_has_stages(const strut_study *study) {
  return study->search || study->fit;
}
/** Are all searches in a directory finished? */
bool strut_sweep_search_is_finished(const char *directory);
/** Adds the columns of a study that follows motions, and checks that its first point has some. */
strut_status strut_sweep_follow_check(strut_sweep_study *study, strut_error *error);
