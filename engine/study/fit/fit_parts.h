/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the parts of a fit share. Internal to engine/study/fit.
 *
 * Parameters of the least-squares problem are those of the alignments, in the order of the matches, then the fitted
 * ones. An alignment's is 1 + value / scale; a fitted one's is 1 at its least value, 2 at its largest, and its
 * logarithm is even between them where the study says so.
 */
#pragma once

#include "engine/study/fit/fit.h"
#include "engine/study/fit/least_squares.h"
#include "engine/study/sweep/sweep_parts.h"

/* ---- fit_layout.c ---- */

/** What an alignment's number does. */
typedef enum strut_fit_aligns {
  STRUT_FIT_SHIFT_X,
  STRUT_FIT_SHIFT_Y,
  STRUT_FIT_ROTATE,
  STRUT_FIT_DELAY,
  STRUT_FIT_ALIGNS_COUNT
} strut_fit_aligns;

/** A film that begins at most this many of its lengths late may have the clock of the run. */
#define STRUT_FIT_OWN_CLOCK 10.0

/** A parameter of the problem. */
typedef struct strut_fit_unknown {
  const char *name, *unit;               /* "film.shift_x" */
  const strut_search_variable *variable; /* NULL: a number of an alignment, as follows */
  strut_fit_aligns what;
  double starts[2], scale; /* SI; the second of a start in four */
} strut_fit_unknown;

/** A series as the model has it. */
typedef struct strut_fit_source {
  int axis;        /* 0: x of a place, 1: y, -1: neither */
  int32_t partner; /* the series of the other coordinate of the same place, or -1 */
  int64_t column;  /* of a TABLE: its number among those of numbers */
} strut_fit_source;

/** What is known of a match. */
typedef struct strut_fit_part {
  strut_fit_source *sources;               /* (series) */
  strut_study study;                       /* as given, with the match's `compute` */
  strut_sweep_plan table;                  /* of a TABLE */
  double noise;                            /* by which residuals are divided */
  int32_t aligned[STRUT_FIT_ALIGNS_COUNT]; /* parameters of the problem; -1: none */
} strut_fit_part;

/** What all evaluations have in common. Constant once made, but for its cache. */
typedef struct strut_fit_layout {
  const strut_sweep_plan *plan;
  const strut_study_fit *fit;
  size_t count; /* of residuals */
  size_t aligned_count, parameters;
  strut_fit_unknown *unknowns; /* (parameters) */
  strut_fit_part *parts;       /* (matches) */
  strut_fit_number *numbers;   /* (count) */
  bool noise_known;
  double *low, *high; /* (parameters) the box */
  strut_equilibrium_cache *standing;
  const strut_flag *interrupt;
  strut_fit_refusal refused;
  strut_arena arena;
} strut_fit_layout;

/** An evaluation: of one thread at a time. */
typedef struct strut_fit_case {
  const strut_fit_layout *layout;
  double share;        /* of the time of motions that counts */
  double between;      /* motions are predicted so far between each time and the next */
  int32_t left_out;    /* this match does not count; -1: all do */
  double *weight;      /* (count) factors of residuals; 0: a gap, or it does not count */
  size_t used;         /* residuals that count */
  int64_t evaluations; /* of the residuals, so far */
  int64_t budget;      /* of them, at most, for each parameter and once more */
  bool spent;          /* that was too little */
  double *predicted;   /* (count) by the model, not aligned */
  double *latest;      /* (parameters) of that */
  bool known;
  strut_study_value *values; /* of all columns of the axes */
  /* of the match that is being predicted */
  const strut_fit_match *match;
  size_t index;
  double align[STRUT_FIT_ALIGNS_COUNT];
  double delay[2];   /* in which range it is to be found; both 0: it is known */
  double from, to;   /* times of the samples from which it is found */
  double *placing;   /* parameters whose alignments are to be found while the model is predicted */
  bool delays;       /* with their delays */
  int32_t elsewhere; /* this match takes one of the next best, by its rank; -1: none does */
  size_t rank;       /* 0: the best */
  double placed_sum; /* of squares, then */
  const strut_fit_series *missing; /* the model has no such number at the latest point; or NULL */
  double *buffer;                  /* (3 count + 3) */
  strut_status status;             /* of what must stop all */
  strut_error error; /* likewise, or why there were no residuals at the latest such point */
  strut_arena arena;
} strut_fit_case;

/** Release it after a failure too. STRUT_BAD_SCENE with what does not fit the model; STRUT_NO_MEMORY. */
strut_status strut_fit_layout_make(const strut_sweep_plan *plan, const strut_flag *interrupt,
                                   strut_fit_layout *layout, strut_error *error);
void strut_fit_layout_free(strut_fit_layout *layout);

/** From a parameter of the problem to its value in SI, and back; and by how much one changes with the other. */
double strut_fit_value(const strut_fit_layout *layout, size_t i, double parameter);
double strut_fit_parameter(const strut_fit_layout *layout, size_t i, double value);
double strut_fit_slope(const strut_fit_layout *layout, size_t i, double parameter);
/** The values of all columns of the axes in a row, with those of the parameters. */
void strut_fit_fill_values(const strut_fit_layout *layout, int64_t row, const double *parameters,
                           strut_study_value *values);

/** Smaller residuals than this part of the range of the numbers are those of the runs themselves. */
#define STRUT_FIT_EXACT 1e-8

/** So many places are tried where the model cannot be computed at a start. */
enum { STRUT_FIT_MOST_PLACES = 50 };

/** Parameters (parameters) where a start begins: the first where the study says, the others spread evenly. */
void strut_fit_choose_start(const strut_fit_layout *layout, int64_t start, double *parameters);

/* ---- fit_residuals.c ---- */

/** The time that the numbers of a match take [s]. */
double strut_fit_span(const strut_fit_match *match);
/** The quantity of that name, or NULL. */
const strut_quantity_definition *strut_fit_quantity(const strut_experiment *experiment,
                                                    const char *name);

/** All residuals count. False: memory is out. Release the arena, after a failure too. */
bool strut_fit_case_create(const strut_fit_layout *layout, strut_fit_case *one);
/** The problem of the case; `near` and most_steps are the caller's to change. */
strut_least_squares strut_fit_problem(strut_fit_case *one);
/** The numbers of all series as the case has predicted them at the parameters, aligned: (count). */
void strut_fit_align_all(const strut_fit_case *one, const double *parameters, double *to);
/**
 * Sets the alignments at the other parameters to those with the least sum, shifts and turns in closed form, and delays
 * too if so said, of the match `elsewhere` (-1: none) to a next best one. A turn needs both coordinates. Returns the sum;
 * HUGE_VAL, without a change, where the model cannot be computed, nothing is aligned or there is no such delay.
 */
double strut_fit_place(strut_fit_case *one, bool delays, int32_t elsewhere, size_t rank,
                       double *parameters);
/**
 * The match whose motion leaves the lines between its numbers the most, by more than the noise, or NULL; and by which part
 * of the squared steps from number to number. `at`: the numbers at the parameters, aligned.
 */
const strut_fit_match *strut_fit_find_coarse(strut_fit_case *one, const double *parameters,
                                             const double *at, double *coarseness);
/** Residuals count within a share of the time of motions, and of all matches but one; -1: of all. */
void strut_fit_choose(strut_fit_case *one, double share, int32_t left_out);

/* ---- fit_report.c: the result notes where memory is out ---- */

/**
 * Describes the residuals of the best fit, and gives as the reason why it does not explain the data, or "". A match of its
 * own has no more degrees of freedom than numbers.
 */
void strut_fit_find_flaw(const strut_fit_layout *layout, strut_fit_result *result);
/** Fills what starts and spectrum say besides, and the verdict of each estimate. */
void strut_fit_judge(const strut_fit_layout *layout, const strut_fit_spectrum *spectrum,
                     strut_fit_result *result);
