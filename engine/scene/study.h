/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A study: one model at many points, as a plain description.
 * 
 * Points are the product of all axes, the last axis fastest. An axis gives one or several
 * parameters of the model, by a list or by a range that is never expanded, so that a billion points
 * need no memory. Variants of the model are the first axis, with the single column "variant". Texts
 * and arrays are owned by the creator of the study.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "engine/base/text.h"
#include "engine/scene/data.h"
#include "engine/scene/quantity.h"

/** Value of a parameter at a point. */
typedef struct strut_study_value {
  double number;    /* SI */
  const char *word; /* of a text parameter, else NULL */
} strut_study_value;

/* ---- searches ---- */

/** Methods of searches: X(NAME, word of the language). */
#define STRUT_SEARCH_METHOD_TABLE(X)                                                               \
  X(MULTISTART, "multistart")                                                                      \
  X(CRS2, "crs2")                                                                                  \
  X(DIRECT, "direct")                                                                              \
  X(ISRES, "isres")                                                                                \
  X(COBYLA, "cobyla")                                                                              \
  X(BOBYQA, "bobyqa")                                                                              \
  X(SBPLX, "sbplx")                                                                                \
  X(NELDERMEAD, "neldermead")                                                                      \
  X(CMA, "cma")                                                                                    \
  X(NSGA2, "nsga2")                                                                                \
  X(BFGS, "bfgs")

typedef enum strut_search_method {
#define STRUT_SEARCH_METHOD_ENUM(name, word) STRUT_SEARCH_##name,
  STRUT_SEARCH_METHOD_TABLE(STRUT_SEARCH_METHOD_ENUM) STRUT_SEARCH_METHOD_COUNT
} strut_search_method;

enum { STRUT_SEARCH_MOST_CONDITIONS = 32, STRUT_SEARCH_MOST_VARIABLES = 100 };

/** A place in the study's text, from 1; line 0: none. */
typedef struct strut_search_place {
  uint32_t line, column;
} strut_search_place;

/** A parameter that is searched for. */
typedef struct strut_search_variable {
  const char *name, *unit; /* unit "1": none */
  strut_file_unit shown;   /* as of a column */
  bool word;               /* a text parameter, with choices */
  bool logarithmic, wraps, integer;
  double from, to;     /* SI, from < to */
  double start;        /* where the first search begins */
  size_t choice_count; /* above 0: a list in place of a range */
  const double *numbers;
  const char *const *words;
} strut_search_variable;

/** An expression of columns; strut_column.item of its program is the number of a column of the table. */
typedef struct strut_search_formula {
  const char *text; /* as written */
  strut_search_place place;
  strut_quantity_definition program; /* its length is 0 until the columns are known */
} strut_search_formula;

typedef enum strut_search_relation {
  STRUT_SEARCH_BELOW, /* < or <= */
  STRUT_SEARCH_ABOVE, /* > or >= */
  STRUT_SEARCH_IS,    /* a column of words = WORD */
  STRUT_SEARCH_IS_NOT /* != */
} strut_search_relation;

/** What must hold: LEFT < RIGHT, or of a column of words WORD. */
typedef struct strut_search_condition {
  const char *text; /* as written */
  strut_search_place place;
  strut_search_relation relation;
  strut_search_formula left, right; /* of numbers */
  const char *word;
  size_t column; /* of words: its number in the table */
} strut_search_condition;

typedef struct strut_study_search {
  bool maximise;
  strut_search_formula goal, second; /* second.text NULL: one goal; NSGA2 is for two */
  size_t variable_count, condition_count;
  strut_search_variable *variables;   /* (variable_count) */
  strut_search_condition *conditions; /* (condition_count) */
  uint32_t method;                    /* strut_search_method */
  int32_t starts;
  int64_t evaluations, seed;
  size_t axis;          /* the axis of `search` and `evaluation` */
  size_t scenario_axes; /* how many axes follow it before that of the variables */
  size_t column;        /* of the first variable, among the columns of all axes */
} strut_study_search;

/* ---- fits ---- */

/** What the numbers of a match are compared with. */
typedef enum strut_fit_kind {
  STRUT_FIT_MOTION, /* quantities over time */
  STRUT_FIT_REST,   /* quantities where the run starts */
  STRUT_FIT_CURVE,  /* the force of a path at displacements */
  STRUT_FIT_TABLE   /* columns that a study with its `compute` keeps */
} strut_fit_kind;

/** Measured numbers and what they are compared with. */
typedef struct strut_fit_series {
  const char *of; /* quantity that the model measures, or a column */
  strut_search_place place;
  const char *unit; /* of the numbers, SI; "1": none */
  /* (count of the match) its values; without a name one of its own; NULL: all are gaps, as of the other coordinate of a
     place that turns */
  const strut_data_column *column;
  size_t first; /* of them among the numbers of all matches */
} strut_fit_series;

/** Alignment of the model with what was measured that is found together with the parameters. */
typedef struct strut_fit_alignment {
  uint32_t shift, rotate, delay; /* 1: free */
} strut_fit_alignment;

typedef struct strut_fit_match {
  const char *name;
  strut_fit_kind kind;
  uint32_t compute; /* strut_compute: RUN of motions, PATH of a CURVE */
  size_t count;     /* numbers of each series */
  const double
      *at; /* (count) times of a MOTION, ascending [s]; displacements of a CURVE [m]; else NULL */
  double noise; /* standard deviation of the numbers, SI; 0: not known */
  const char *noise_unit;
  strut_fit_alignment align;
  size_t series_count;
  strut_fit_series *series;
  strut_study_value *values; /* (set_count of the fit) of the parameters that matches set */
} strut_fit_match;

typedef struct strut_study_fit {
  size_t variable_count, match_count;
  strut_search_variable *variables; /* (variable_count) */
  strut_fit_match *matches;         /* (match_count) */
  int32_t starts;
  int64_t seed;
  size_t column;    /* of the first variable, among the columns of all axes */
  size_t set_count; /* columns behind those of the variables: parameters that matches set */
  size_t beside_count, omission_count; /* along which other fits are sought; fits without a match */
} strut_study_fit;

/* ROUNDS: how often is looked beside the best fit while that leads to a better one. */
enum { STRUT_FIT_ROUNDS = 3, STRUT_FIT_MOST_VARIABLES = 20, STRUT_FIT_MOST_MATCHES = 10 };

/* ---- branches ---- */

/** What zeros stand for: of the accuracy; of the steps of a branch, and of a curve over two parameters. */
#define STRUT_FOLLOW_USUAL_PERCENT 0.1
#define STRUT_FOLLOW_MOST_ACCURACY 0.1
#define STRUT_FOLLOW_USUAL_STEPS 400
#define STRUT_FOLLOW_USUAL_CURVE_STEPS 200

typedef struct strut_study_follow {
  const char *over, *unit; /* the parameter; unit "": none */
  strut_file_unit shown;   /* as of a column */
  double from, to;         /* its range [SI], from < to */
  size_t at_count;         /* 0: the model's own value, or the middle */
  const double *at;        /* (at_count) values at which runs start branches [SI] */
  size_t start_count;      /* 0: as the model says */
  const char **start_from; /* (start_count) configurations */
  double accuracy;         /* relative; 0: the usual one */
  const char *integrator;  /* NULL: chosen */
  int32_t steps;           /* 0: the usual ones */
  bool basins;
} strut_study_follow;

/** Most values and configurations to start from. */
enum { STRUT_STUDY_FOLLOW_MOST_AT = 8, STRUT_STUDY_FOLLOW_MOST_FROM = 8 };

/* ---- studies ---- */

/** Most points of a study, and most values of one list. */
#define STRUT_STUDY_MOST_POINTS ((int64_t)1000000000)

/** Most points of the finest grid of a refined study. */
#define STRUT_STUDY_MOST_REFINED ((int64_t)20000000)

/** Form of the values of an axis. */
typedef enum strut_range_kind {
  STRUT_RANGE_LIST, /* number, or word where the parameter is a text */
  STRUT_RANGE_EVEN, /* count values from `from` to `to`, both among them */
  STRUT_RANGE_STEP, /* from + i * step: `to` is not one of them */
  STRUT_RANGE_RATIO /* as EVEN, of the logarithms */
} strut_range_kind;

/** One parameter along its axis. */
typedef struct strut_study_column {
  const char *name, *unit; /* unit "1": none */
  strut_file_unit shown;   /* that the study gives its values in, else the model */
  bool word;               /* a text parameter: a LIST of words */
  strut_range_kind kind;
  double from, to, step;    /* SI */
  const double *number;     /* (count of the axis) of a LIST */
  const char *const *words; /* (count of the axis) of a LIST of words */
} strut_study_column;

typedef struct strut_study_axis {
  int64_t count; /* values, >= 1 */
  size_t column_count;
  strut_study_column *columns; /* (column_count) they go together */
} strut_study_axis;

/** What is computed at each point: X(NAME, word of the language), as the command of that name does. */
#define STRUT_COMPUTE_TABLE(X)                                                                     \
  X(RUN, "run")                                                                                    \
  X(EQUILIBRIA, "equilibria")                                                                      \
  X(MODES, "modes")                                                                                \
  X(RIGIDITY, "rigidity")                                                                          \
  X(PATH, "path")                                                                                  \
  X(FORM, "form")

typedef enum strut_compute {
#define STRUT_COMPUTE_ENUM(name, word) STRUT_COMPUTE_##name,
  STRUT_COMPUTE_TABLE(STRUT_COMPUTE_ENUM) STRUT_COMPUTE_COUNT
} strut_compute;

/** Sets of these. */
enum {
#define STRUT_OF_ENUM(name, word) STRUT_OF_##name = 1 << STRUT_COMPUTE_##name,
  STRUT_COMPUTE_TABLE(STRUT_OF_ENUM) STRUT_OF_ALL = (1 << STRUT_COMPUTE_COUNT) - 1,
  STRUT_KEEP_SMOOTH =
      1 << STRUT_COMPUTE_COUNT /* follows parameters smoothly: no counts, words and settings do */
};

/**
 * Values kept of a point: X(NAME, word of the language, the set of what has it), in the order of the
 * table.
 */
#define STRUT_KEEP_TABLE(X)                                                                        \
  X(VELOCITY, "velocity", STRUT_OF_RUN | STRUT_KEEP_SMOOTH)                                        \
  X(SPREAD, "velocity_spread", STRUT_OF_RUN)                                                       \
  X(INTERVAL, "velocity_interval", STRUT_OF_RUN)                                                   \
  X(MOTION, "motion", STRUT_OF_RUN)                                                                \
  X(REPEATS, "repeats", STRUT_OF_RUN)                                                              \
  X(PERIODS, "periods", STRUT_OF_RUN)                                                              \
  X(DISTANCE, "distance", STRUT_OF_RUN | STRUT_KEEP_SMOOTH)                                        \
  X(DURATION, "duration", STRUT_OF_RUN)                                                            \
  X(SETTLE_TIME, "settle_time", STRUT_OF_RUN)                                                      \
  X(STEPS, "steps", STRUT_OF_RUN)                                                                  \
  X(EVALUATIONS, "force_evaluations", STRUT_OF_RUN)                                                \
  X(CHECKS, "check_evaluations", STRUT_OF_RUN)                                                     \
  X(EVENTS, "events", STRUT_OF_RUN)                                                                \
  X(METHOD, "method", STRUT_OF_RUN)                                                                \
  X(STEP, "step", STRUT_OF_RUN)                                                                    \
  X(STEP_LIMIT, "step_limit", STRUT_OF_RUN)                                                        \
  X(EXPECTED, "expected_error", STRUT_OF_RUN)                                                      \
  X(ENERGY, "energy", STRUT_OF_RUN | STRUT_KEEP_SMOOTH)                                            \
  X(WORK, "work", STRUT_OF_RUN | STRUT_KEEP_SMOOTH)                                                \
  X(LOSSES, "losses", STRUT_OF_RUN | STRUT_KEEP_SMOOTH)                                            \
  X(RESIDUAL, "residual", STRUT_OF_RUN | STRUT_OF_RIGIDITY | STRUT_OF_FORM)                        \
  X(CONTACTS, "contacts", STRUT_OF_RUN)                                                            \
  X(POSITIONS, "positions", STRUT_OF_RUN | STRUT_OF_FORM | STRUT_KEEP_SMOOTH)                      \
  X(OUTCOME, "outcome", STRUT_OF_RUN)                                                              \
  X(QUANTITIES, "quantities", STRUT_OF_RUN | STRUT_KEEP_SMOOTH)                                    \
  X(KEPT, "accuracy_kept", STRUT_OF_RUN)                                                           \
  X(NODES, "node_count", STRUT_OF_ALL)                                                             \
  X(MEMBERS, "member_count", STRUT_OF_ALL)                                                         \
  X(FREEDOMS, "degrees_of_freedom", STRUT_OF_ALL)                                                  \
  X(TOTAL_MASS, "total_mass", STRUT_OF_ALL | STRUT_KEEP_SMOOTH)                                    \
  X(STABLE, "stable_count", STRUT_OF_EQUILIBRIA)                                                   \
  X(FOUND, "equilibrium_count", STRUT_OF_EQUILIBRIA)                                               \
  X(STATES, "states", STRUT_OF_EQUILIBRIA)                                                         \
  X(ENERGIES, "energies", STRUT_OF_EQUILIBRIA | STRUT_KEEP_SMOOTH)                                 \
  X(BARRIERS, "barriers", STRUT_OF_EQUILIBRIA | STRUT_KEEP_SMOOTH)                                 \
  X(STARTS, "starts", STRUT_OF_EQUILIBRIA)                                                         \
  X(MISSED, "missed_probability", STRUT_OF_EQUILIBRIA)                                             \
  X(AT, "at", STRUT_OF_MODES)                                                                      \
  X(FREQUENCIES, "frequencies", STRUT_OF_MODES | STRUT_KEEP_SMOOTH)                                \
  X(DAMPING_RATIOS, "damping_ratios", STRUT_OF_MODES | STRUT_KEEP_SMOOTH)                          \
  X(MODE_COUNTS, "mode_counts", STRUT_OF_MODES)                                                    \
  X(CONDITION, "condition", STRUT_OF_MODES)                                                        \
  X(RANK, "rank", STRUT_OF_RIGIDITY)                                                               \
  X(SELF_STRESS, "self_stress_count", STRUT_OF_RIGIDITY)                                           \
  X(MECHANISMS, "mechanism_count", STRUT_OF_RIGIDITY)                                              \
  X(MECHANISM_KINDS, "mechanism_kinds", STRUT_OF_RIGIDITY)                                         \
  X(SUPER_STABLE, "super_stable", STRUT_OF_RIGIDITY)                                               \
  X(LABEL, "label", STRUT_OF_RIGIDITY)                                                             \
  X(LIMIT, "limit_factor", STRUT_OF_PATH | STRUT_KEEP_SMOOTH)                                      \
  X(BIFURCATION, "bifurcation_factor", STRUT_OF_PATH | STRUT_KEEP_SMOOTH)                          \
  X(CRITICAL, "critical_factor", STRUT_OF_PATH | STRUT_KEEP_SMOOTH)                                \
  X(LAST_FACTOR, "last_factor", STRUT_OF_PATH)                                                     \
  X(PATH_EVENTS, "event_count", STRUT_OF_PATH)                                                     \
  X(END, "end", STRUT_OF_PATH)                                                                     \
  X(MOVED, "moved", STRUT_OF_FORM | STRUT_KEEP_SMOOTH)                                             \
  X(DENSITY_CHANGE, "density_change", STRUT_OF_FORM | STRUT_KEEP_SMOOTH)                           \
  X(LEAST_TENSION, "least_tension", STRUT_OF_FORM | STRUT_KEEP_SMOOTH)                             \
  X(LARGEST_FORCE, "largest_force", STRUT_OF_FORM | STRUT_KEEP_SMOOTH)                             \
  X(LENGTHS, "lengths", STRUT_OF_FORM | STRUT_KEEP_SMOOTH)                                         \
  X(COST, "cost_of_transport", STRUT_OF_RUN | STRUT_KEEP_SMOOTH)                                   \
  X(LOWEST_BARRIER, "lowest_barrier", STRUT_OF_EQUILIBRIA | STRUT_KEEP_SMOOTH)                     \
  X(STIFFNESS, "stiffness", STRUT_OF_MODES | STRUT_KEEP_SMOOTH)                                    \
  X(SHAPE, "shape_distance",                                                                       \
    STRUT_OF_RUN | STRUT_OF_EQUILIBRIA | STRUT_OF_MODES | STRUT_KEEP_SMOOTH)                       \
  X(CURVE, "curve_distance", STRUT_OF_PATH | STRUT_KEEP_SMOOTH)

/** The key's words, "velocity|velocity_spread|...". */
#define STRUT_KEEP_WORD(NAME, word, of) "|" word
#define STRUT_KEEP_WORD_LIST (&("" STRUT_KEEP_TABLE(STRUT_KEEP_WORD))[1])

typedef enum strut_keep {
#define STRUT_KEEP_ENUM(name, word, of) STRUT_KEEP_##name,
  STRUT_KEEP_TABLE(STRUT_KEEP_ENUM) STRUT_KEEP_COUNT
} strut_keep;

/** A word of `keep`, and the set of what has it. */
typedef struct strut_kept_word {
  const char *word;
  unsigned of;
} strut_kept_word;

/** NULL beyond the last. */
static inline const strut_kept_word *strut_kept_word_at(size_t i) {
  static const strut_kept_word words[] = {
#define STRUT_KEPT_WORD(name, word, of) {word, of},
      STRUT_KEEP_TABLE(STRUT_KEPT_WORD)};
  return i < STRUT_KEEP_COUNT ? &words[i] : NULL;
}

/** The strut_keep that `word` names of what computes so, or -1. */
static inline int strut_keep_find(const char *word, unsigned compute) {
  for (int i = 0; i < STRUT_KEEP_COUNT; i++) {
    const strut_kept_word *kept = strut_kept_word_at((size_t)i);
    if (kept->of >> compute & 1u && strcmp(kept->word, word) == 0) return i;
  }
  return -1;
}

/** A set of them: bit k % 64 of bits[k / 64] is strut_keep k. */
enum { STRUT_KEEP_WORDS = (STRUT_KEEP_COUNT + 63) / 64 };
typedef struct strut_keep_set {
  uint64_t bits[STRUT_KEEP_WORDS];
} strut_keep_set;

static inline void strut_keep_add(strut_keep_set *set, unsigned keep) {
  set->bits[keep / 64] |= (uint64_t)1 << keep % 64;
}
static inline bool strut_keep_has(const strut_keep_set *set, unsigned keep) {
  return set->bits[keep / 64] >> keep % 64 & 1u;
}
static inline bool strut_keep_is_empty(const strut_keep_set *set) {
  bool empty = true;
  for (unsigned i = 0; i < STRUT_KEEP_WORDS; i++) empty = empty && set->bits[i] == 0;
  return empty;
}

/** Kinds of figures, in the order of the language. */
typedef enum strut_study_figure_kind {
  STRUT_FIGURE_LINES,     /* of the table: x, y, series */
  STRUT_FIGURE_MAP,       /* of the table: x, y, color */
  STRUT_FIGURE_MOTION,    /* lines of recorded runs, node by node */
  STRUT_FIGURE_PERIOD,    /* node trajectories over the last period of each run */
  STRUT_FIGURE_SNAPSHOTS, /* shapes of each run */
  STRUT_FIGURE_BEST,      /* of a search: the best objective over evaluations */
  STRUT_FIGURE_POINTS,    /* of a search: its points over x and y, by color */
  STRUT_FIGURE_WINNER /* of a search: the best of all beside the start, as strut compare draws them */
} strut_study_figure_kind;

/** Colour scale of a map, as strut_colours of the figures. */
typedef enum strut_study_colours {
  STRUT_STUDY_COLOURS_AUTO,
  STRUT_STUDY_COLOURS_SEQUENTIAL,
  STRUT_STUDY_COLOURS_DIVERGING,
  STRUT_STUDY_COLOURS_GREY
} strut_study_colours;

/** A figure of the table or of recorded runs. */
typedef struct strut_study_figure {
  const char *name;
  strut_study_figure_kind kind;
  /* columns of the table; NULL where none is named */
  const char *x, *y, *series, *color, *panels, *difference; /* y: several with commas between */
  const char *doubt;                                        /* of a MAP; NULL: flips */
  const char *band, *only;                                  /* "COLUMN=TEXT", or NULL */
  /* Of LINES besides, columns, or NULL: ends of whiskers; "no" where a line is dashed; where it or a column before it
     differs, a line ends; kinds of marks, "" for none, and what they are about. */
  const char *low, *high, *stable, *line, *mark, *thing;
  const char *title;               /* or NULL */
  size_t label_count;              /* 0: by the columns */
  const char **labels;             /* (label_count) of the curves */
  const char *x_label, *y_label;   /* or NULL: the columns' names */
  double x_limits[2], y_limits[2]; /* in the columns' units; 0, 0: from the data */
  const char *limit_units[2];      /* that these were given in, or NULL */
  strut_study_colours colours;     /* of a MAP */
  double from, to;                 /* of MOTION [s]; without limits infinite */
  double scale[2];                 /* of PERIOD; 0: 1 */
  size_t time_count;               /* of SNAPSHOTS; 0: six */
  const double *times;             /* (time_count) [s] */
} strut_study_figure;

/** A sensitivity analysis: what follows from which parameters; see sample.h. */
typedef struct strut_study_sensitivity {
  bool wanted;
  size_t axis; /* of the study, the last one: a column for each parameter */
  size_t of_count;
  const char **of; /* (of_count) columns of the table */
  int64_t samples; /* base samples; 0: derivatives only */
  uint32_t seed;   /* of samples and of bootstraps */
  uint32_t scheme; /* strut_sample_scheme */
  bool derivatives;
  const double *scales; /* (parameters) from the median of each to its 84th percentile */
  double threshold;     /* numbers up to this have no sign; in the unit of their column */
} strut_study_sensitivity;

/** How many energies, barriers and frequencies a row lists, unless the study says. */
enum { STRUT_STUDY_LOWEST = 3, STRUT_STUDY_MOST_LOWEST = 20 };

typedef struct strut_study {
  const char *name, *description, *model; /* model: its file, from the study's folder */
  size_t axis_count, figure_count;
  strut_study_axis *axes;
  strut_study_figure *figures;
  strut_keep_set keep; /* empty: what is usual, if no quantity is kept either */
  size_t quantity_count;
  const char **quantities; /* (quantity_count) measured quantities that are kept by name */
  size_t derivative_count;
  struct strut_derived_by
      *derivatives;      /* (derivative_count) of what is kept; 0: as the model says */
  bool trajectories;     /* a directory of results for each run */
  bool half_step;        /* run each point again with half the step */
  double check_accuracy; /* or with this accuracy; 0: not */
  uint32_t compute;      /* strut_compute */
  int32_t lowest;        /* energies, barriers, frequencies in a row; 0: STRUT_STUDY_LOWEST */
  const char *at; /* equilibrium of modes, rigidity and path, as their commands know it; or NULL */
  struct {        /* as the command's options; NULL, 0: not given */
    const char *load, *over;
    double from, until;                 /* in SI, or a load factor */
    const char *from_unit, *until_unit; /* NULL: a number without unit */
    bool from_given, until_given;
    int32_t steps;
  } path;
  struct {                               /* likewise */
    uint32_t from;                       /* strut_form_source */
    uint32_t objective;                  /* strut_form_objective */
    double least_tension, least_density; /* [N], [N/m] */
  } form;
  struct {
    int64_t evaluations; /* of the forces, in each run of a point; 0: any number */
    double time;         /* of a point [s], by the clock; 0: any */
  } limit;
  struct {             /* of a map: the two axes then have the values of the finest grid */
    int32_t depth;     /* halvings of the axes' steps; 0: no refinement */
    const char *where; /* column whose value decides which cells are divided */
    double by;         /* by how much its numbers must differ, in SI */
    size_t axes[2];    /* in their order */
  } refine;
  strut_study_search *search; /* what is searched; NULL: the points are all of the axes */
  strut_study_sensitivity sensitivity;
  struct {                      /* see engine/study/sweep/sweep_parts.h */
    const char *stiffness_node; /* of the column stiffness; NULL: none */
    double stiffness_direction; /* [rad] */
    const char *like;           /* a configuration: the shape that is wanted; NULL: `shape` */
    size_t shape_count;
    const char **shape_nodes; /* (shape_count) */
    double (*shape)[2];       /* (shape_count) [m] */
    size_t curve_count;
    double (*curve)[2]; /* (curve_count) displacement [m], force [N] */
  } goal;
  strut_study_follow *follow; /* motions that are followed; NULL: none */
  strut_study_fit *fit;       /* what is fitted; NULL: nothing */
  size_t table_count;
  const strut_data_table *tables; /* (table_count) measured data of the study itself */
} strut_study;
