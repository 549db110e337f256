/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the parts of the sweep share. Internal to engine/study. */
#pragma once

#include "engine/base/derivatives.h"
#include "engine/base/flag.h"
#include "engine/run/simulate.h"
#include "engine/scene/experiment.h"
#include "engine/scene/study.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/path/path.h"
#include "engine/study/sweep/sweep.h"

/*
 * What evaluating a point of a study needs: distances from its goals, equilibria of points nearby.
 */

/* How far a point is from what a study wants: a shape, a curve of force over displacement; and what a
 * small force at a node meets.
 */

/** Are the nodes and the configuration there that the study names? STRUT_BAD_SCENE, with the fault. */
strut_status strut_goals_check(const strut_study *study, const strut_scene *scene,
                               strut_study_fault *fault, strut_error *error);
/**
 * Root mean square distance [m] of nodes from the wanted shape after the best rigid motion, which turns
 * and moves the whole but does not mirror it. positions (node_count, 2). NAN: the study wants none, or a
 * node is not there.
 */
double strut_goals_shape_distance(const strut_study *study, const strut_scene *scene,
                                  const double *positions);
/**
 * The force that holds the displaced coordinate at a displacement [N]; NAN: that is not reached, or the path displaces
 * none.
 */
double strut_goals_force_at(const strut_path *path, double displacement);
/**
 * Root mean square difference [N] of the force that holds the displaced coordinate from the wanted
 * curve; where a path passes a displacement several times, its first passage counts. NAN: one of the
 * displacements is not reached.
 */
double strut_goals_curve_distance(const strut_study *study, const strut_path *path);
/** Stiffness at the study's node along its direction, at the equilibrium q [N/m]; NAN: none. */
strut_status strut_goals_stiffness(const strut_study *study, const strut_model *model,
                                   const double *positions, double *stiffness, strut_error *error);

/** Indices of those that stand, by energy, *count of them, in the arena; equal ones in the order of the list. NULL: memory is out. */
int32_t *strut_standing_states(const strut_equilibria *equilibria, strut_arena *arena,
                               size_t *count);
/** The i-th lowest elastic mode, or NULL; unknown ones count. */
const strut_mode *strut_elastic_mode(const strut_modes *modes, size_t i);

/* Equilibria of a study's scenes, found once for all points with the same statics.
 *
 * Where a structure stands does not depend on its drive, on friction or on how it is integrated. So
 * the points of most studies have their equilibria in common; those that have are identified by the
 * numbers that do matter, compared bit by bit. A point gets the bits it would get on its own.
 */

/** Safe from several threads. */
typedef struct strut_equilibrium_cache strut_equilibrium_cache;

/** NULL: memory is out. */
strut_equilibrium_cache *strut_equilibrium_cache_create(void);
void strut_equilibrium_cache_free(strut_equilibrium_cache *standing); /* NULL is allowed */

/** As strut_resolve_start_equilibrium. */
strut_status strut_equilibrium_cache_resolve(strut_equilibrium_cache *standing, strut_setup *setup,
                                             strut_error *error);

/**
 * The configuration whose equilibrium is nearest to a shape (node_count, 2), turned and shifted at
 * will, or mirrored too where contacts alone tell the configuration: its index, -1 where none is
 * within a tenth of the structure's size. STRUT_OK, STRUT_NO_MEMORY.
 */
strut_status strut_equilibrium_cache_nearest(strut_equilibrium_cache *standing,
                                             const strut_setup *setup, const double *positions,
                                             int32_t *index, strut_error *error);

/** The cells of a row while its point is computed. */
typedef struct strut_row_buffer {
  strut_study_value *values;       /* (axis columns) */
  double *numbers;                 /* (columns) */
  char (*words)[STRUT_SLOT_WORD];  /* (columns) */
  size_t number_count, word_count; /* filled so far */
  char message[STRUT_SLOT_MESSAGE];
  strut_result_slot row;
} strut_row_buffer;

/* sweep_columns.c */

/** Appends the kept values of a run; summary NULL: all missing. outcome may be "". */
void strut_sweep_fill(const strut_sweep_plan *plan, const strut_setup *setup,
                      const strut_summary *summary, const char *outcome, strut_row_buffer *cells);
/** Appends the counts of a point's structure and its mass. */
void strut_sweep_fill_counts(const strut_sweep_plan *plan, const strut_model *model,
                             strut_row_buffer *cells);
void strut_sweep_number(strut_row_buffer *cells, double value);
void strut_sweep_word(strut_row_buffer *cells, const char *word);
/** The cells of the axes, with which a row begins. */
void strut_sweep_axes(const strut_sweep_plan *plan, const strut_study_value *values,
                      strut_row_buffer *cells);
/** Makes a row of the cells, with the message of the error unless that is NULL. */
void strut_sweep_end_row(strut_row_buffer *cells, strut_status status, const strut_error *error);
/** Does this end the study, instead of the point alone? */
bool strut_sweep_stops(strut_status status);
/** Says whether the columns that are added next follow parameters smoothly: no counts, words and settings do. */
void strut_sweep_begin_smooth(strut_sweep_plan *plan, strut_keep keep);

/** Adds a column to a plan; one with the name of an axis gets the prefix "run_". False: no memory. */
bool strut_sweep_add_column(strut_sweep_plan *plan, const char *prefix, const char *name,
                            const char *unit, bool word);
/** Appends the positions (2 node_count) of the nodes that the columns name; NULL: missing. */
void strut_sweep_fill_positions(const strut_sweep_plan *plan, const strut_scene *scene,
                                const double *positions, strut_row_buffer *cells);
/** Index in the scene of what was the i-th of its kind by name; -1: there is none of that name. */
int64_t strut_sweep_named(const char *name, size_t i, const strut_scene *scene,
                          strut_channel_owner owner);

/* sweep_point.c */

typedef struct strut_sweep_worker {
  const strut_sweep_plan *plan;
  const strut_sweep_options *options;
  strut_equilibrium_cache *standing;
  struct strut_sweep_watch *watch; /* NULL: points may take any time */
} strut_sweep_worker;

struct strut_sweep_watch;

/** A point being computed. Must not move in memory meanwhile. */
typedef struct strut_sweep_job {
  int64_t point;
  strut_row_buffer cells;
  strut_setup setup;
  strut_run_options options;
  strut_sink *sink;              /* of the run's files, if it has some */
  strut_derivative *derivatives; /* (derived numbers, parameters) */
  size_t warning_count;          /* of the first run */
  strut_warning warnings[STRUT_MOST_WARNINGS];
  strut_status status; /* at the end: STRUT_OK with cells.row, or what stops the sweep */
  strut_error error;
  double deadline; /* by strut_run_clock [s]; 0: none; guarded by the watch */
  strut_flag stop; /* set by the watch when it has passed, or the sweep is interrupted */
} strut_sweep_job;

/** What ends the job's computation early; may be NULL. */
const strut_flag *strut_sweep_interrupt_of(const strut_sweep_worker *worker,
                                           const strut_sweep_job *job);
/** Computes a point, with the run for the check where the study wants one. */
void strut_sweep_compute(const strut_sweep_worker *worker, int64_t point, strut_sweep_job *job);

/** Runs the scene of the job; the counts of its structure go before the cells of a `first` run. */
strut_status strut_sweep_run_scene(const strut_sweep_worker *worker, strut_sweep_job *job,
                                   bool first, strut_summary *summary);

/* sweep_derivatives.c */

/** Does a sensitivity analysis want derivatives of the column, at the medians? */
bool strut_sweep_is_analysed(const strut_study *study, const char *name);
/**
 * Adds the columns of derivatives of the numbers so far, by the scene of the first point and its values. STRUT_USAGE: a
 * parameter is missing, or nothing uses it.
 */
strut_status strut_sweep_derivative_columns(strut_sweep_plan *plan, const strut_setup *setup,
                                            const strut_study_value *values, strut_error *error);
/** Adds a warning of the job's run, with a printf-style text; too many are left out. */
void strut_sweep_warn(strut_sweep_job *job, const char *code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/** Appends the derivatives of the job's row, whose scene is still there, and adds a warning of what has none. */
strut_status strut_sweep_derive(const strut_sweep_worker *worker, strut_sweep_job *job);

/* statics_point.c */

/** What is usual to keep of a computation that is no run. */
strut_keep_set strut_statics_usual(strut_compute compute);
/** Adds the columns of the structure and of what is computed, but those of its things. False: no memory. */
bool strut_kept_columns(strut_sweep_plan *plan, const strut_setup *setup);
/** Appends the cells of what a run gave; summary NULL: all missing. */
void strut_kept_fill_run(const strut_sweep_plan *plan, const strut_setup *setup,
                         const strut_summary *summary, strut_row_buffer *cells);
/** STRUT_BAD_SCENE where the study asks for what the scene does not have. */
strut_status strut_statics_check(const strut_study *study, const strut_setup *setup,
                                 strut_error *error);
/** Follows the path that the study wants; release it with strut_path_free, after a failure too. */
strut_status strut_statics_path(const strut_study *study, const strut_setup *setup,
                                const strut_model *model, strut_path *path, strut_error *error);
/** Computes what the study wants of a point at rest and appends its cells. */
strut_status strut_statics_point(const strut_sweep_worker *worker, strut_sweep_job *job);

/* sweep_point.c */

/** Ends jobs that take longer than the study allows. NULL: there is no memory or no thread for it. */
struct strut_sweep_watch *strut_sweep_watch_create(double seconds, strut_sweep_job *jobs,
                                                   size_t count, const strut_flag *interrupt);
void strut_sweep_watch_free(struct strut_sweep_watch *watch);

/* sweep.c */

/** Points of a file that are computed side by side; zero-initialise but for what the user fills in. */
typedef struct strut_points {
  strut_slots *slots;
  strut_sweep_state *state;
  strut_error *error;
  void *context; /* of both functions: */
  /** The i-th point to be looked at; false: it is not computed. NULL: that of the file, as the options want. */
  bool (*choose)(void *context, int64_t i, int64_t *point);
  /** Computes it into the job's row, or leaves the status that stops everything and its error. */
  void (*compute)(void *context, strut_sweep_job *job, int64_t point);
  bool nested; /* points may use threads themselves */
  bool shared; /* others write rows of the file, too */
  int threads;
  strut_sweep_job *jobs; /* (threads) */
  strut_sweep_worker worker;
  const strut_flag *interrupt; /* may be NULL, like progress */
  void (*progress)(void *context, const strut_sweep_state *state);
  void *progress_context;
  int64_t next, count;    /* of the points that are looked at; read and written atomically */
  double began, reported; /* [s] */
  strut_status status;    /* of what stopped it */
} strut_points;

/** The state of what is in the file; the clock begins. */
void strut_points_begin(strut_points *points);
/** Threads, jobs in the arena, and what watches over them. STRUT_NO_MEMORY; close it in any case. */
strut_status strut_points_open(strut_points *points, const strut_sweep_plan *plan,
                               const strut_sweep_options *options, strut_arena *arena);
void strut_points_close(strut_points *points);
/**
 * Looks at points until all have rows, and waits for those that other workers compute. left(context): how many are looked at
 * next; 0: all have rows. STRUT_INTERRUPTED.
 */
strut_status strut_points_complete(strut_points *points, int64_t (*left)(void *context));
/** Done and failed points of the file, as it is now. */
void strut_points_count(strut_points *points);
/** The status, STRUT_INTERRUPTED where points are missing after an interrupt. */
strut_status strut_points_end(strut_points *points);
/** Jobs with room for their rows; NULL: no memory. */
strut_sweep_job *strut_sweep_make_jobs(const strut_sweep_plan *plan, strut_arena *arena,
                                       size_t count);
/* sweep_point.c */

/** Removes what killed processes left of unfinished runs below the directory, and nothing else. */
void strut_sweep_records_clear(const char *directory);

/* Refinement of a map: which points of the finest grid are to be computed.
 *
 * A cell has its corners on a grid whose steps are 2^k of the finest ones. It is divided where points on
 * its edges that are known differ in a column; then its centre and the middles of its edges are wanted,
 * and its quarters are cells. A quarter's points may show to the cell beside it that this has to be
 * divided as well. What is wanted grows with what is known, and the largest set does not depend on the
 * order in which points are computed: threads, shards and interruptions change nothing.
 */

typedef struct strut_refinement strut_refinement;

/**
 * The refinement of a plan whose study has one. STRUT_BAD_SCENE where the table has no column of that
 * name; STRUT_NO_MEMORY. The plan must outlive it.
 */
STRUT_API strut_status strut_refinement_create(const strut_sweep_plan *plan,
                                               strut_refinement **refinement, strut_error *error);
STRUT_API void strut_refinement_free(strut_refinement *refinement); /* NULL is allowed */
/** Takes note of all points of a file that are done. */
STRUT_API void strut_refinement_learn(strut_refinement *refinement, strut_slots *slots);
/** Marks all points that are wanted by what is known; how many of them are not known. */
STRUT_API int64_t strut_refinement_choose(strut_refinement *refinement);
/** Is the point wanted? `refinement` is a strut_refinement, as strut_sweep_options has it. */
STRUT_API bool strut_refinement_wants(const void *refinement, int64_t point);
/** The number of wanted points of a file, and of those that are done. */
STRUT_API void strut_refinement_count(const strut_refinement *refinement, strut_slots *slots,
                                      int64_t *wanted, int64_t *done);
/** Points of the coarsest grid. */
STRUT_API int64_t strut_refinement_coarse(const strut_sweep_plan *plan);
