/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A study that searches: for which values of parameters is a column of its table best?
 *
 * The points of such a study have three kinds of axes: those of the study, for each of whose points there is
 * a search; the axis of evaluations, whose columns `search` and `evaluation` number what a search computes;
 * and the scenarios, all of which each evaluation runs through. Behind them is an axis of one value with the
 * variables. It holds where the first search begins; the values of other points are the search's.
 */
#ifndef STRUT_ENGINE_SCENE_STUDY_SEARCH_H
#define STRUT_ENGINE_SCENE_STUDY_SEARCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/scene/quantity.h"

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
  X(NSGA2, "nsga2")

typedef enum strut_search_method {
#define STRUT_SEARCH_METHOD_ENUM(name, word) STRUT_SEARCH_##name,
  STRUT_SEARCH_METHOD_TABLE(STRUT_SEARCH_METHOD_ENUM)
#undef STRUT_SEARCH_METHOD_ENUM
      STRUT_SEARCH_METHOD_COUNT
} strut_search_method;

enum { STRUT_SEARCH_MOST_CONDITIONS = 32, STRUT_SEARCH_MOST_VARIABLES = 100 };

/** A place in the study's text, from 1; line 0: none. */
typedef struct strut_search_place {
  uint32_t line, column;
} strut_search_place;

/** A parameter that is searched for. */
typedef struct strut_search_variable {
  const char *name, *unit; /* unit "1": none */
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

#endif
