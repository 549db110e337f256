/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the parts of the study reader share. Internal to parser/. */
#pragma once

#include "engine/scene/sample.h"
#include "parser/language/read/reader.h"
#include "parser/language/read/reuse/overlay.h"
#include "parser/language/study/read_study.h"

typedef struct strut_study_reader {
  strut_reader *reader; /* of the study's text: its messages and its tree */
  strut_study_file *file;
  size_t declared_count; /* the model's parameters */
  strut_name_map given;  /* those that the study gives */
  size_t variant_count;  /* 0: the study has none */
  const char **variant_names;
  bool searching; /* the table has the columns of a search */
  bool following; /* the tables have those of branches */
} strut_study_reader;

/** count * size zeroed bytes of the study; NULL: memory is out, which the reader remembers. */
void *strut_study_allocate(strut_study_reader *reader, size_t count, size_t size);
/** A place in the study's text, as one of a file that the model uses. */
strut_place strut_study_place(const strut_study_file *file, strut_place place);
/** The parameter of the model that a key names; NULL where that was reported, with the advice. */
const strut_declared *strut_study_parameter(strut_study_reader *reader, const strut_tree *key,
                                            const char *advice);
/** Lets all variants measure a column of the motion, which `column` names, at the end of their runs. */
bool strut_study_measure(strut_study_file *file, const strut_tree *column);
/** Does a match of the fit compute one of the words of `compute`? */
bool strut_study_fit_computes(const strut_study_fit *fit, const char *words);
/** Opens the model that the study names, once for each variant, lays their keys over it, and finds its parameters. */
strut_status strut_study_open_sources(strut_study_reader *reader, strut_fields *top,
                                      strut_error *error);
/** Reads the axes into the study, and their columns; list NULL: none. Then what is searched. */
void strut_study_read_axes(strut_study_reader *reader, const strut_tree *list,
                           const strut_slot *search);

/** One parameter along its axis, while it is read. */
typedef struct strut_study_along {
  const strut_declared *parameter;
  const strut_tree *key, *value;
  strut_study_column *column;
  strut_setting *setting;
  int64_t count;
  const char *of;     /* of a variable: "the search", for messages */
  const char *advice; /* of a message that there is no such parameter; or NULL */
} strut_study_along;

/** The parameter of that name, or NULL; nothing is reported. */
const strut_declared *strut_study_declared(const strut_study_reader *reader, const char *name);
/**
 * Finds along->parameter by along->key unless it is known, and adds its column to the axis and its setting to the
 * study's; without an axis they are those of `along`. False: there is none, or the table has a column of that name.
 */
bool strut_study_begin_along(strut_study_reader *reader, strut_study_axis *axis,
                             strut_study_along *along);
/** A number in the parameter's dimension; where that has none the first value decides. */
bool strut_study_read_value(strut_study_reader *reader, strut_study_along *along,
                            const strut_tree *value, const char *key, bool first, double *number);

/** The same of a key that is given, into the field of its row. */
bool strut_study_store_value(strut_study_reader *reader, strut_study_along *along,
                             strut_fields *fields, int key, bool first, void *object);

/** Reads a parameter along its axis: a list or a range. False where something was reported. */
bool strut_study_read_along(strut_study_reader *reader, strut_study_axis *axis,
                            strut_study_along *along);

/* study_search.c */

/** Reads the parameters that a search or a fit, which `of` says, is over, and adds their axis. */
void strut_study_read_variables(strut_study_reader *reader, const strut_slot *over, const char *of,
                                strut_search_variable **variables, size_t *variable_count,
                                size_t *column);
/** Reads what is searched, after the axes, and adds its axes. Nothing without one. */
void strut_study_read_search(strut_study_reader *reader, const strut_slot *slot);

/* study_axes.c: what is refined */

/** Reads what is refined, after the axes, and gives the two axes the values of the finest grid. */
void strut_study_read_refine(strut_study_reader *reader, const strut_slot *slot);

/* study_points.c */

/** Columns of strut's own tables that no axis may have, and that say nothing about the model. */
#define STRUT_STUDY_OWN_COLUMNS "point|status|message"
/** Is the item of `axes` a file of points, or a sample, and no parameter of such a name? */
bool strut_study_is_points(const strut_study_reader *reader, const strut_tree *item);
bool strut_study_is_sample(const strut_study_reader *reader, const strut_tree *item);
void strut_study_read_points(strut_study_reader *reader, const strut_tree *value,
                             strut_study_axis *axis);
void strut_study_read_sample(strut_study_reader *reader, const strut_tree *value,
                             strut_study_axis *axis);

/* study_axes.c: goals */

/** Reads what the study wants of its points, after `keep`. */
void strut_study_read_goals(strut_study_reader *reader, strut_fields *top);

/* study_points.c: sensitivity analyses */

/** Reads the analysis and adds its points as the last axis, after all others. */
void strut_study_read_sensitivity(strut_study_reader *reader, strut_fields *top);

/* study_fit.c */

/** Reads what is fitted, and adds its axes. Nothing without it. */
void strut_study_read_fit(strut_study_reader *reader, strut_fields *top);

/* study_axes.c: what is followed */

/** Reads what is followed, after the axes. Nothing without it. */
void strut_study_read_follow(strut_study_reader *reader, strut_fields *top);
