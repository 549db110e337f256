/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Analyses: what `strut equilibria`, `modes`, `rigidity`, `form` and `path` compute of a model and report. The
 * program, the library and what is built on it do the same by these rows.
 */
#ifndef STRUT_PARSER_COMMAND_ANALYSES_H
#define STRUT_PARSER_COMMAND_ANALYSES_H

#include "engine/output/draw/chart.h"
#include "engine/statics/rigidity/rigidity.h"
#include "parser/command/statics_options.h"

/** ROW(name) for each analysis. */
#define STRUT_ANALYSES(ROW) ROW(equilibria) ROW(modes) ROW(rigidity) ROW(form) ROW(path)

typedef struct strut_analysis strut_analysis;

/** A kind of analysis. Texts are blocks of strut_allocate, NULL where memory is out. */
struct strut_analysis_kind {
  const char *files[3]; /* of its JSON and, where it has one, its CSV; NULL after the last */
  bool uncompiled;      /* compute needs no model */
  bool asks;            /* compute soon notices an interrupt */
  /** Reads the options, whose faults the listener hears, and computes. */
  strut_status (*compute)(strut_analysis *a, strut_error *error);
  /** May be NULL. Fails where the result is that there is none. */
  strut_status (*verdict)(const strut_analysis *a, strut_error *error);
  char *(*json)(const strut_analysis *a);
  char *(*csv)(const strut_analysis *a); /* NULL: no such file */
  char *(*table)(const strut_analysis *a);
  /** May be NULL. Tells of what is doubtful in the result. */
  void (*warn)(const strut_analysis *a, const strut_listener *listener);
  strut_status (*draw)(const strut_analysis *a, const strut_plot *plot, strut_error *error);
  void (*release)(strut_analysis *a); /* may be NULL */
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
  const strut_command *command;     /* whose name messages have */
  const strut_arguments *arguments; /* while it computes */
  strut_setup *setup;               /* its interrupt is asked */
  const strut_model *model;         /* of the setup; NULL if uncompiled */
  strut_varied_scenes scenes;       /* the setup's text, for those over a parameter */
  bool all;                         /* the table lists every equilibrium */
  strut_arena arena;
  union {
    strut_equilibria equilibria;
    struct {
      strut_modes found;
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

/** Computes; a->result is zero before. Call strut_analysis_free in any case. */
strut_status strut_analysis_compute(strut_analysis *a, strut_error *error);
void strut_analysis_free(strut_analysis *a);

#endif
