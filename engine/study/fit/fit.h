/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Fits the parameters of a model to measured numbers, and says which of them the numbers determine.
 *
 * From each of several starts the weighted sum of squared residuals is made least (least_squares.h), that of motions
 * over short times first. The interval of a parameter is that of its profile: the values at which the least sum over
 * all others exceeds the best by what the residuals of a right model do in 5 % of all cases. An interval is given
 * only where the model explains the numbers, the starts agree, and the numbers determine the parameter.
 *
 * The rows of the study's table are the fits: of each start, of both ends of each interval, and without each match.
 */
#pragma once

#include "engine/base/memory.h"
#include "engine/scene/value_rows.h"
#include "engine/study/fit/least_squares.h"
#include "engine/study/sweep/sweep.h"

/** X(NAME, words): what is said of a parameter; the first that applies. */
#define STRUT_FIT_VERDICTS(X)                                                                      \
  X(UNEXPLAINED, "the model does not explain the data")                                            \
  X(DISAGREE, "starts disagree")                                                                   \
  X(UNDETERMINED, "not determined by these data")                                                  \
  X(BOUND, "ends at a bound of its range")                                                         \
  X(IDENTIFIED, "identified")

typedef enum strut_fit_verdict {
#define STRUT_FIT_VERDICT_ENUM(NAME, words) STRUT_FIT_##NAME,
  STRUT_FIT_VERDICTS(STRUT_FIT_VERDICT_ENUM) STRUT_FIT_VERDICT_COUNT
} strut_fit_verdict;

/** A parameter of the study, or a number of an alignment. SI. */
typedef struct strut_fit_estimate {
  const char *name, *unit; /* unit "1": none */
  double value;
  double error;     /* standard error, from the derivatives; HUGE_VAL if unknown */
  double low, high; /* 95 %, by the profile, of an alignment by the error; NAN: not given */
  double linear_low, linear_high; /* 95 %, by the error */
  bool at_bound;                  /* the value is an end of its range */
  double also;                    /* another delay that fits as well; NAN: none does */
  strut_fit_verdict verdict;
} strut_fit_estimate;

/** A fit of its own. */
typedef struct strut_fit_row {
  strut_fit_end end;
  double sum; /* of squared residuals */
  int64_t used, evaluations;
  double values[STRUT_LEAST_SQUARES_MOST]; /* (parameters) SI */
  bool agrees;                             /* with the best */
} strut_fit_row;

/** A number of a match. */
typedef struct strut_fit_number {
  const strut_fit_match *match;
  const strut_fit_series *series;
  double at;                  /* time or displacement; NAN: it has none */
  double measured;            /* NAN: a gap */
  double factor;              /* of its residual */
  double predicted, residual; /* at the best fit: aligned; weighted, 0 at gaps */
} strut_fit_number;

/** Residuals of a match, at the best fit. */
typedef struct strut_fit_residuals {
  const strut_fit_match *match;
  int64_t used;
  double rms;        /* of numbers, SI, weighted */
  double chi_square; /* sum of squares in units of the noise; NAN: that is not known */
  double lag; /* correlation of successive residuals, in its standard errors; NAN: no motion */
} strut_fit_residuals;

/** A direction in the space of the fitted parameters, each in units of its range. */
typedef struct strut_fit_direction {
  double error;           /* standard deviation along it, in such units */
  const double *part;     /* (variables) of length 1 */
  const char *words;      /* "friction and damping together" */
  const char *determined; /* of two parameters: "friction + 0.98 damping", "k/m"; else NULL */
} strut_fit_direction;

typedef struct strut_fit_result {
  const strut_study_fit *fit;
  const strut_sweep_plan *plan;
  size_t parameters, aligned_count, variable_count;
  size_t start_count, best; /* best: a start, or beside one */
  bool settled;             /* beside the best none was found that is better */
  bool found;               /* some start has residuals: all below is there */
  strut_fit_row *starts; /* (start_count), then (beside_count) that lie beside the best of them */
  strut_fit_row *ends;   /* (variables, 2) of the profiles, low and high */
  size_t beside_count;
  strut_fit_row *omissions;      /* without each match; none where there is only one */
  strut_fit_estimate *estimates; /* (parameters) alignments first */
  double *correlation;           /* (variables, variables) */
  size_t direction_count;
  strut_fit_direction *directions; /* that the numbers do not determine */
  strut_fit_residuals *residuals;  /* (matches) */
  size_t number_count;
  strut_fit_number *numbers;               /* (number_count) */
  size_t agreeing;                         /* starts that agree with the best */
  double chi_square, freedom, probability; /* of a sum so large; NAN: the noise is not known */
  double scale;                  /* by which standard errors of unit noise are multiplied */
  const strut_fit_match *coarse; /* whose times are furthest apart for what moves; or NULL */
  double coarseness;             /* 0: not at all */
  const char *reason; /* why the model does not explain the data or starts disagree; or "" */
  const strut_fit_series *missing; /* the model has no such number: nothing is found; or NULL */
  bool out_of_memory;
  strut_arena arena;
} strut_fit_result;

/** A series that does not fit the model, or NULL; and the table of its match, which has no such column, or nothing. */
typedef struct strut_fit_refusal {
  const strut_fit_series *series;
  strut_sweep_plan table;
} strut_fit_refusal;

/**
 * Replaces the columns that are kept by those of a fit. STRUT_BAD_SCENE with what does not fit the model, whose table
 * the caller frees.
 */
STRUT_API strut_status strut_fit_add_columns(strut_sweep_plan *plan, strut_fit_refusal *refusal,
                                             strut_error *error);
/** As strut_sweep_run. The result is complete on STRUT_OK; release its arena in any case. */
STRUT_API strut_status strut_fit_run(const strut_sweep_plan *plan, strut_slots *slots,
                                     const strut_sweep_options *options, strut_sweep_state *state,
                                     strut_fit_result *result, strut_error *error);
/** Draws fit.svg, residuals.svg and profiles.svg into the directory. */
STRUT_API strut_status strut_fit_figures(const strut_fit_result *result, const char *directory,
                                         strut_error *error);
/** Are all parameters identified? */
STRUT_API bool strut_fit_is_identified(const strut_fit_result *result);
/** The rows of a result as people and programs read them. */
STRUT_API extern const strut_value_rows strut_fit_values;
/**
 * Writes fit.csv, covariance.csv, residuals.csv, and of the model beside them, `model`, fitted.yaml with the fitted
 * values and, where all are identified, uncertain.yaml, a study that samples them.
 */
STRUT_API strut_status strut_fit_write(const strut_fit_result *result, const char *directory,
                                       const char *model, strut_error *error);

/* ---- how to measure ---- */

/** A place of a match, a match or all of them: what their numbers would say of the parameters. */
typedef struct strut_fit_candidate {
  const char *name;
  size_t numbers;
  double determinant; /* log10 of that of the information, in units of ranges */
  double least;       /* singular value of the derivatives, in units of the noise per range */
  double *errors;     /* (variables) standard errors, SI; HUGE_VAL: not determined */
} strut_fit_candidate;

typedef struct strut_fit_plan {
  const strut_study_fit *fit;
  size_t variable_count, count;
  strut_fit_candidate *candidates; /* (count) the best first */
  double *at;                      /* (parameters) of the problem: the first start */
  strut_arena arena;
} strut_fit_plan;

/** From the model alone, at the first start. Release the arena, after a failure too. */
STRUT_API strut_status strut_fit_plan_find(const strut_sweep_plan *of, const strut_flag *interrupt,
                                           strut_fit_plan *plan, strut_error *error);
STRUT_API extern const strut_value_rows strut_fit_plan_values;
