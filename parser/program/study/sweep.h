/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The parts of `strut sweep`: the study that is opened, copies of its texts, its figures, its reports,
 * and scripts for clusters.
 */
#ifndef STRUT_PARSER_PROGRAM_STUDY_SWEEP_H
#define STRUT_PARSER_PROGRAM_STUDY_SWEEP_H

#include "engine/output/record_files.h"
#include "engine/study/report/study_report.h"
#include "engine/study/results/study_table.h"
#include "engine/study/search/search.h"
#include "engine/study/sweep/sweep.h"
#include "engine/study/sweep/sweep_parts.h"
#include "parser/language/study/read_study.h"
#include "parser/program/options.h"
#include "parser/program/progress.h"

/** Stays where it is while in use. Zero-initialise; strut_sweep_study_close releases it. */
typedef struct strut_sweep_study {
  strut_study_file file;
  strut_sweep_plan plan;
  strut_slots_description slots; /* of all points in one file */
} strut_sweep_study;

/**
 * Opens the study that the command's argument names. Messages go to stderr; close it after a failure
 * too. The first point and the ends of every axis must make a model.
 */
strut_status strut_sweep_study_open(const strut_arguments *arguments, strut_sweep_study *study);
/** The same without messages: those about a place are in the file's diagnostics, others in `error`. */
strut_status strut_sweep_study_try(const strut_arguments *arguments, strut_sweep_study *study,
                                   strut_error *error);
/** Prints the messages of a failure; returns `status`. */
strut_status strut_sweep_study_report(strut_sweep_study *study, strut_status status,
                                      strut_error *error);
void strut_sweep_study_close(strut_sweep_study *study);

/**
 * STRUT_USAGE where the copies would take the place of other files of the user's: results go into
 * the study's own folder, and one of the names is taken there.
 */
strut_status strut_sweep_texts_check(const strut_arguments *arguments,
                                     const strut_sweep_study *study, strut_error *error);
/** Writes study.yaml and model.yaml into the directory of the results, which exists. */
strut_status strut_sweep_texts_write(const strut_arguments *arguments,
                                     const strut_sweep_study *study, strut_error *error);

/** Checks that all figures name existing columns. STRUT_BAD_SCENE with the reason. */
strut_status strut_sweep_figures_check(const strut_sweep_plan *plan, strut_error *error);
/**
 * Fails where strut would have to overwrite somebody else's table.csv or picture. Pictures of single runs
 * are refused when they are drawn.
 */
strut_status strut_sweep_figures_check_files(const strut_sweep_plan *plan, const char *directory,
                                             strut_error *error);
/**
 * Draws each as directory/NAME.svg, of the table at `path` or of the runs beside it. Messages go to
 * stderr.
 */
strut_status strut_sweep_figures_draw(const strut_sweep_plan *plan, const char *directory,
                                      const char *path, const strut_refinement *refinement);

/** Takes note of what all files of a directory hold: `own`, and those of other shards. */
void strut_sweep_refine_learn(strut_refinement *refinement, const char *directory,
                              strut_shard shard, strut_slots *own);
/** How far the refinement in a directory is. */
strut_status strut_sweep_refine_status(const strut_sweep_plan *plan, const char *directory,
                                       strut_slots *slots, strut_slots_progress *progress,
                                       strut_error *error);
/**
 * Writes directory/table.csv of the shards of a refined study, in place of strut_merge. *merged is true if
 * the study in the directory is a refined one; otherwise nothing is done.
 */
strut_status strut_sweep_refine_merge(const strut_arguments *arguments, bool *merged);

/* sweep_search.c; nothing where the study has no sensitivity analysis */

/** Checks that what is analysed are columns. STRUT_BAD_SCENE with the reason. */
strut_status strut_sweep_sensitivity_check(const strut_sweep_plan *plan, strut_error *error);
/** Writes sensitivity.csv and sensitivity.svg into the directory, and prints what is in the former. */
strut_status strut_sweep_sensitivity_complete(const strut_arguments *arguments,
                                              const strut_sweep_plan *plan, strut_slots *slots);

#define STRUT_PARTIAL_TABLE "table-partial.csv"

/** A study that is computed, and where its results go. */
typedef struct strut_study_job {
  const strut_arguments *arguments;
  strut_sweep_study *study;
  strut_shard shard;  /* of a search: which of its workers; count 0: none */
  strut_slots *slots; /* strut_slots_close closes them */
  strut_sweep_state state;
} strut_study_job;

/** Opens or creates the job's file of slots, in a directory that no one else's results are in. */
strut_status strut_study_job_open(strut_study_job *job, const char *path, strut_error *error);
/** Computes the job's points; `options` have progress and interrupt. */
typedef strut_status strut_study_compute(strut_study_job *job, const strut_sweep_options *options,
                                         void *context, strut_error *error);
/** Does that with progress, and now and then the table of the rows that there are, also when it has failed. */
strut_status strut_study_job_run(strut_study_job *job, strut_study_compute *compute, void *context,
                                 strut_error *error);

/** Prints each warning of the runs once, with its count, on stderr. */
void strut_sweep_print_warnings(const strut_sweep_state *state);
/** Prints how many points failed or are inaccurate on stderr; the status that follows from it. */
strut_status strut_sweep_judge(int64_t points, int64_t failed, int64_t inaccurate);

/** STRUT_BAD_SCENE, with a message on stderr, where several workers could not share the search. */
strut_status strut_sweep_search_check_workers(strut_sweep_study *study);
/** Computes a study that searches, once its slots are open, and writes its results. */
strut_status strut_sweep_search(strut_study_job *job);
/** Does the same with a study that fits. */
strut_status strut_sweep_fit(strut_study_job *job);
/** Prints which measurements would determine the parameters of a study that fits best. */
strut_status strut_sweep_fit_plan(const strut_arguments *arguments, const strut_sweep_study *study);
/** Do points depend on those before, so that shards are workers that share one file? */
static inline bool strut_study_has_stages(const strut_study *study) {
  return study->search || study->fit;
}
/** Are all searches in a directory finished? */
bool strut_sweep_search_is_finished(const char *directory);
/** Adds the columns of a study that follows motions, and checks that its first point has some. */
strut_status strut_sweep_follow_check(strut_sweep_study *study, strut_error *error);
/** Does the same with a study that follows motions. */
strut_status strut_sweep_follow(strut_study_job *job);

/** Prints the script for the study of that name. */
strut_status strut_sweep_emit(const strut_arguments *arguments, const char *name);

#endif
