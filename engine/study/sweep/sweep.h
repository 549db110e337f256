/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The points of a study run side by side, each into its slot. */
#pragma once

#include "engine/base/flag.h"
#include "engine/output/record_files.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"
#include "engine/scene/study.h"
#include "engine/study/results/slots.h"

/* The points of a study: from a point's number to its values, at once and without a list. */

/** Number of points; -1 beyond STRUT_STUDY_MOST_POINTS. Without axes there is one. */
STRUT_API int64_t strut_grid_points(const strut_study *study);
/** Number of columns: of all axes together, in their order. */
STRUT_API size_t strut_grid_columns(const strut_study *study);
/** The k-th column of all axes together, and through `axis` (may be NULL) whose it is. */
STRUT_API const strut_study_column *strut_grid_column(const strut_study *study, size_t k,
                                                      size_t *axis);
/**
 * Value i of a column whose axis has `count` values; a LIST must be one of numbers. What a range gives
 * between its ends is rounded to 15 digits, so that round numbers come out round, and the same from
 * every C library; the ends have their own bits.
 */
STRUT_API double strut_grid_value(const strut_study_column *column, int64_t i, int64_t count);
/** The values of all columns (strut_grid_columns) at a point from 0 on; the last axis is the fastest. */
STRUT_API void strut_grid_values(const strut_study *study, int64_t point,
                                 strut_study_value *values);

/**
 * The value to the 15 digits that a double can represent, counted from the first digit of `scale`.
 */
STRUT_API double strut_grid_rounded(double value, double scale);

/** Makes scenes of points; called from several threads at once. */
typedef struct strut_sweep_scenes {
  /** The scene and its experiment where the axes have these values; strut_setup_free releases it. */
  strut_status (*setup)(void *context, const strut_study_value *values, strut_setup *setup,
                        strut_error *error);
  /** Both as a text, in a block of strut_allocate; NULL: memory is out. */
  char *(*text)(const strut_setup *setup);
  void *context;
  /**
   * The setup where numbers of its parameters are others: the values (count) of `by` [SI]. NULL: there are no
   * derivatives.
   */
  strut_status (*vary)(void *context, const strut_study_value *values, const strut_derived_by *by,
                       size_t count, const double *numbers, strut_setup *setup, strut_error *error);
} strut_sweep_scenes;

/** What of the study is not in the model: its key, and the name there. Zero: nothing. */
typedef struct strut_study_fault {
  const char *key, *name;
} strut_study_fault;

/** A column that is differentiated. */
typedef struct strut_derived_column {
  size_t column;
  bool stepped; /* a count or a setting: differences of it are exact */
} strut_derived_column;

/** Columns and points of a study's table. Constant once made. */
typedef struct strut_sweep_plan {
  const strut_study *study;
  strut_sweep_scenes scenes;
  int64_t points;
  strut_keep_set keep;
  size_t quantity_count;
  const char **quantities; /* (quantity_count) names of the measured quantities that are kept */
  bool check, flips;       /* each point is run twice; and outcomes are compared */
  bool accurate;           /* a further column says whether the requested accuracy was reached */
  bool start;              /* a column says whether the start settled on an unstable equilibrium */
  bool texts;              /* those of its figures are texts, not outlines */
  size_t axis_columns;     /* the first columns */
  size_t column_count, column_capacity;
  strut_slot_column *columns; /* of the axes, of what is kept, of the check */
  strut_arena arena;
  /* names in the first point's scene; other points may have others, and leave these cells empty */
  size_t contact_count, node_count, member_count;
  const char **contacts, **nodes, **members;
  bool smooth; /* do the columns that are added follow parameters smoothly? */
  size_t by_count, derived_count, first_derivative; /* column of the first derivative, if any */
  strut_derived_by *by; /* (by_count) parameters that the derived numbers are differentiated by */
  size_t own_by_count;  /* the first of them, at all points; the others at the medians */
  strut_derived_column *derived; /* (derived_count) that are differentiated */
  bool *names_member;      /* (quantity_count) a word beside it: the member of the largest force */
  strut_study_fault fault; /* why it could not be made */
} strut_sweep_plan;

/**
 * Decides the columns, by the scene of the first point. Release with strut_sweep_plan_free, after a
 * failure too. STRUT_USAGE where there are more columns than a slot holds; what the scene gives.
 */
STRUT_API strut_status strut_sweep_plan_make(const strut_study *study,
                                             const strut_sweep_scenes *scenes,
                                             strut_sweep_plan *plan, strut_error *error);
STRUT_API void strut_sweep_plan_free(strut_sweep_plan *plan);

/** A warning that runs of a sweep gave. */
typedef struct strut_sweep_warning {
  const char *code; /* as in strut_warning */
  int64_t runs;     /* how many of the runs computed now gave it */
  int64_t point;    /* the first of those points */
  char text[600];   /* its text there */
} strut_sweep_warning;
enum { STRUT_SWEEP_MOST_WARNINGS = 16 };

/** Progress of a sweep. */
typedef struct strut_sweep_state {
  int64_t points, done, failed; /* of the file; done includes earlier and failed points */
  int64_t computed;             /* by this call */
  double seconds;               /* since it began, or went on */
  int64_t last;                 /* the latest point */
  const strut_result_slot *row; /* and its row */
  size_t warning_count;
  strut_sweep_warning warnings[STRUT_SWEEP_MOST_WARNINGS]; /* by code */
  bool has_best;                                           /* of a search: */
  double best;                                             /* the best objective so far */
} strut_sweep_state;

struct strut_sweep_job;

typedef struct strut_sweep_options {
  int threads;                 /* 0: strut_sweep_threads */
  const strut_flag *interrupt; /* may be NULL */
  const char *directory;       /* of runs, where trajectories are wanted */
  /** A few times a second, one thread at a time; may be NULL. */
  void (*progress)(void *context, const strut_sweep_state *state);
  void *progress_context;
  /** Points to be computed; NULL: all. Those of the file that it wants, and of these the done ones. */
  bool (*wants)(const void *context, int64_t point);
  const void *wants_context;
  int64_t wanted, wanted_done;
  /** May replace values of a point, and change its scene and experiment; may be NULL. From any thread. */
  void (*values)(const void *context, int64_t point, strut_study_value *values);
  void (*adjust)(const void *context, int64_t point, strut_setup *setup);
  const void *point_context;
  /** Computes a point into the job's row, or leaves what stops everything; NULL: as its scene says. */
  void (*compute)(void *context, struct strut_sweep_job *job, int64_t point);
  void *compute_context;
  bool nested; /* that may use threads itself */
  /** Of a search whose slots are shared: this process is `worker`, from 0, of `workers`; 0: alone. */
  int64_t worker, workers;
} strut_sweep_options;

/**
 * Runs every point of the file that has no result yet. A failed point gets a row with the reason.
 * STRUT_INTERRUPTED: what was under way is lost, the rest is kept. STRUT_NO_MEMORY, STRUT_FILE_TROUBLE:
 * the same. The bits of a row depend on its point alone. `state` is filled at the end.
 */
STRUT_API strut_status strut_sweep_run(const strut_sweep_plan *plan, strut_slots *slots,
                                       const strut_sweep_options *options, strut_sweep_state *state,
                                       strut_error *error);

/**
 * The derivatives of a run of the setup's experiment, whose scenes these are at no axes: fills those of its summary,
 * which refer to the setup. As strut_simulate.
 */
STRUT_API strut_status strut_sweep_derive_run(const strut_sweep_scenes *scenes,
                                              const strut_setup *setup,
                                              const strut_sweep_options *options,
                                              strut_summary *summary, strut_error *error);

/** OMP_NUM_THREADS; else the processors that this process may use, SLURM_CPUS_PER_TASK at most. */
STRUT_API int strut_sweep_threads(void);

/*
 * What the runs of a study recorded, where it has `trajectories: yes`: as a table, and as pictures.
 */

/** The i-th name of the columns behind those of the axes, and its unit, or NULL after the last; "node" is first. */
STRUT_API const char *strut_study_motion_column(size_t i, const char **unit);

/**
 * The motion as a table in an arena of its own: for each run in turn a row for each time and node,
 * with the columns of the axes and `node`, `time`, `elapsed`, `x`, `y`, `dx`, `dy`. Only the rows that
 * the figure draws, as far as its `only`, `from` and `to` say so. Numbers of runs have no texts.
 * STRUT_USAGE where there are none, or too many; STRUT_NO_MEMORY, STRUT_FILE_TROUBLE.
 */
STRUT_API strut_status strut_study_motion(const strut_sweep_plan *plan, const char *directory,
                                          const strut_study_figure *figure, strut_table *table,
                                          strut_error *error);
/**
 * Draws each run by itself into directory/NAME.svg, or NAME-TEXT-TEXT.svg after the axes along which they
 * differ (what is zipped by its first); with `difference` those of the second text, the others dashed over
 * them. As strut_study_motion.
 */
STRUT_API strut_status strut_study_pictures(const strut_sweep_plan *plan, const char *directory,
                                            const strut_study_figure *figure, strut_error *error);
