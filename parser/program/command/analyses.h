/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Analyses: what `strut equilibria`, `modes`, `rigidity`, `form` and `path` compute of a model and report. The
 * program, the library and what is built on it do the same by these rows.
 */
#ifndef STRUT_PARSER_PROGRAM_COMMAND_ANALYSES_H
#define STRUT_PARSER_PROGRAM_COMMAND_ANALYSES_H

#include "engine/output/draw/chart.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/form/form.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/modes/waves.h"
#include "engine/statics/path/path.h"
#include "engine/statics/rigidity/rigidity.h"
#include "parser/program/command/arguments.h"
#include "parser/program/command/varied_scenes.h"

/* ---- shapes ---- */

typedef struct strut_named_shape {
  const char *name; /* "drawn", or the value of --at */
  const double *q;  /* (length) positions [m], in the arena */
} strut_named_shape;

/** Finds the shape that --at names, by default the drawn one; errors as strut_rest_state_find. */
strut_status strut_named_shape_find(const strut_arguments *arguments, const strut_model *model,
                                    const strut_experiment *experiment, strut_arena *arena,
                                    strut_named_shape *shape, strut_error *error);

/* ---- analyses ---- */

/** ROW(name) for each analysis. */
#define STRUT_ANALYSES(ROW) ROW(equilibria) ROW(modes) ROW(rigidity) ROW(form) ROW(path)

typedef struct strut_analysis strut_analysis;

/** A kind of analysis. Texts are blocks of strut_allocate, NULL where memory is out. */
struct strut_analysis_kind {
  const char *files[3]; /* that -o DIR receives: JSON and, where there is `csv`, CSV; then NULL */
  bool uncompiled;      /* compute needs no model */
  bool asks;            /* compute soon notices an interrupt */
  /** Reads the options, whose faults the listener hears, and computes. */
  strut_status (*compute)(strut_analysis *analysis, strut_error *error);
  /** Fails where nothing was found, which is a result, too. May be NULL. */
  strut_status (*verdict)(const strut_analysis *analysis, strut_error *error);
  /** Rows of the result and, into *result, what they are of; strut_analysis_json writes it. */
  const strut_value_rows *(*values)(const strut_analysis *analysis, const void **result);
  char *(*csv)(const strut_analysis *analysis); /* NULL: no such file */
  /** Tells the listener what is doubtful in the result. May be NULL. */
  void (*warn)(const strut_analysis *analysis, const strut_listener *listener);
  strut_status (*draw)(const strut_analysis *analysis, const strut_plot *plot, strut_error *error);
  void (*release)(strut_analysis *analysis); /* may be NULL */
};

/** Each kind, and the options of its computation. */
#define STRUT_ANALYSIS_KIND(NAME)                                                                  \
  extern const strut_analysis_kind strut_##NAME##_analysis;                                        \
  extern const strut_option strut_##NAME##_analysis_options[];
STRUT_ANALYSES(STRUT_ANALYSIS_KIND)
#undef STRUT_ANALYSIS_KIND

/** An analysis under way. What stands before `all` is the caller's, and stays while there are results. */
struct strut_analysis {
  const strut_analysis_kind *kind;
  const strut_arguments *arguments; /* while it computes */
  strut_setup *setup;               /* its interrupt is asked */
  const strut_model *model;         /* of the setup; NULL if uncompiled */
  strut_varied_scenes scenes;       /* the setup's text, for those over a parameter */
  strut_arena arena;
  union {
    strut_equilibria equilibria;
    struct {
      strut_modes found;
      strut_waves waves; /* instead, where `wave` */
      bool wave;
      size_t count; /* asked for; 0: as many as are usual */
    } modes;
    struct {
      strut_rigidity found;
      strut_named_shape shape; /* in the arena */
    } rigidity;
    struct {
      strut_form found;
      double (*drawn)[2]; /* (nodes) positions before [m], in the arena */
    } form;
    strut_path path;
  } result;
};

/** The result as JSON, in a block of strut_allocate; NULL where memory is out. */
char *strut_analysis_json(const strut_analysis *analysis);
/** What people read of it. */
char *strut_analysis_text(const strut_analysis *analysis, int width);

/** Computes; a->result is zero before. Call strut_analysis_free in any case. */
strut_status strut_analysis_compute(strut_analysis *analysis, strut_error *error);
void strut_analysis_free(strut_analysis *analysis);

#endif
