/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Analyses: what `strut equilibria`, `modes`, `rigidity`, `form` and `path` compute of a model and report. The
 * program, the library and what is built on it do the same by these rows; the program has further kinds of its own.
 */
#pragma once

#include "engine/output/draw/chart.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/form/form.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/modes/waves.h"
#include "engine/statics/path/path.h"
#include "engine/statics/rigidity/rigidity.h"
#include "parser/program/command/arguments.h"
#include "parser/program/command/scene_options.h"

/** ROW(name) for each analysis of the library. */
#define STRUT_ANALYSES(ROW) ROW(equilibria) ROW(modes) ROW(rigidity) ROW(form) ROW(path)

typedef struct strut_analysis strut_analysis;

/** A file that -o DIR receives: JSON of all, a CSV, or a picture. */
typedef struct strut_output_file {
  const char *name;             /* of numbered pictures "model" of model-1.svg, ... */
  const char *list;             /* of a CSV: the path of its structs */
  const strut_value_rows *rows; /* of a CSV; NULL: those of the result */
  char *(*csv)(const strut_analysis *analysis); /* of a CSV: its text, instead of these */
  /** Of a picture: draws it. */
  strut_status (*draw)(const strut_analysis *analysis, const strut_plot *plot, strut_error *error);
  size_t number, most; /* what it draws; of numbered pictures the first, and how many at most */
  double width;        /* of a picture [pt]; 0: as --plot has it */
  bool (*there)(const strut_analysis *analysis, size_t number); /* NULL: always */
} strut_output_file;

/** A kind of analysis. Texts are blocks of strut_allocate, NULL where memory is out. */
struct strut_analysis_kind {
  const strut_output_file *files; /* the last has no name; NULL: -o FILE is the command's own */
  const strut_value_rows *rows;   /* of the result */
  const char *printed;            /* the list that --csv prints */
  double width;                   /* of the figure, where --width says none [pt]; 0: a page's */
  bool uncompiled;                /* compute needs no model */
  bool asks;                      /* compute soon notices an interrupt */
  /** Reads the options, whose faults the listener hears, and computes. */
  strut_status (*compute)(strut_analysis *analysis, strut_error *error);
  /** Fails where nothing was found, which is a result, too. May be NULL. */
  strut_status (*verdict)(const strut_analysis *analysis, strut_error *error);
  /** Tells the listener what is doubtful in the result. May be NULL. */
  void (*warn)(const strut_analysis *analysis, const strut_listener *listener);
  /** Draws the figure of --plot, picture 0. */
  strut_status (*draw)(const strut_analysis *analysis, const strut_plot *plot, strut_error *error);
  void (*release)(strut_analysis *analysis); /* may be NULL */
};

/** Each kind, and the options of its computation. */
#define STRUT_ANALYSIS_KIND(NAME)                                                                  \
  extern const strut_analysis_kind strut_##NAME##_analysis;                                        \
  extern const strut_option strut_##NAME##_analysis_options[];
STRUT_ANALYSES(STRUT_ANALYSIS_KIND)

/** An analysis under way. What stands before `found` is the caller's, and stays while there are results. */
struct strut_analysis {
  const strut_analysis_kind *kind;  /* a computation may put a nearer one in its place */
  const strut_arguments *arguments; /* while it computes */
  strut_setup *setup;
  const strut_model *model;    /* of the setup; NULL if uncompiled */
  strut_varied_scenes scenes;  /* the setup's text, for those over a parameter */
  const strut_flag *interrupt; /* may be NULL */
  void (*progress)(void *context, double fraction); /* may be NULL */
  void *progress_context;
  const void *found;        /* what the rows are of */
  const strut_scene *scene; /* of the result, or NULL */
  size_t count;             /* of modes, as asked for; 0: as many as are usual */
  size_t picture;           /* the number of what is drawn */
  bool partial;             /* what failed has found something all the same */
  strut_arena arena;
  union {
    strut_equilibria equilibria;
    strut_modes modes;
    strut_waves waves;
    struct {
      strut_rigidity found;
      strut_rest_state shape; /* in the arena */
    } rigidity;
    struct {
      strut_form found;
      double (*drawn)[2]; /* (nodes) positions before [m], in the arena */
      char *before;       /* the caller's scene as it was read, or NULL; released with the rest */
    } form;
    strut_path path;
    void *own; /* of other kinds */
  } result;
};

/** The result as JSON, in a block of strut_allocate; NULL where memory is out. */
char *strut_analysis_json(const strut_analysis *analysis);
/** What people read of it. */
char *strut_analysis_text(const strut_analysis *analysis, int width);

/** Computes; a->result is zero before. Call strut_analysis_free in any case. */
strut_status strut_analysis_compute(strut_analysis *analysis, strut_error *error);
void strut_analysis_free(strut_analysis *analysis);
