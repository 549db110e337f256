/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Analyses: what `strut equilibria`, `modes`, `rigidity`, `form` and `path` compute of a model and report. The
 * program, the library and what is built on it do the same by these rows.
 */
#ifndef STRUT_PARSER_COMMAND_ANALYSES_H
#define STRUT_PARSER_COMMAND_ANALYSES_H

#include "engine/base/number_text.h"
#include "engine/output/draw/chart.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/form/form.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/modes/waves.h"
#include "engine/statics/path/path.h"
#include "engine/statics/rigidity/rigidity.h"
#include "parser/command/arguments.h"
#include "parser/command/varied_scenes.h"

/* ---- rows for tables of options ---- */

#define STRUT_EQUILIBRIA_OPTIONS                                                                   \
  {STRUT_OPTION_SUPPORTS, "supports", "NODES", "hold only these contact nodes, such as n1,n4"},    \
      {STRUT_OPTION_STARTS, "starts", "N",                                                         \
       "number of random starts per search (default automatic)"},                                  \
      {STRUT_OPTION_SEED, "seed", "S", "seed of the random starts (default as the scene says)"}, { \
    STRUT_OPTION_ALL, "all", NULL, "list every equilibrium, and the positions of those that stand" \
  }

#define STRUT_MODES_OPTIONS                                                                        \
  {STRUT_OPTION_AT, "at", "NAME",                                                                  \
   "equilibrium to linearise about (default: that of the start), or drawn"},                       \
      {STRUT_OPTION_COUNT, "count", "N", "number of modes or bands, lowest first"},                \
      {STRUT_OPTION_WAVE, "wave", NULL,                                                            \
       "instead: waves of the structure repeated by its lattice, bands and gaps"},                 \
  {                                                                                                \
    STRUT_OPTION_STUCK, "stuck", NULL, "treat closed contacts as stuck instead of frictionless"    \
  }

#define STRUT_FORM_OPTIONS                                                                         \
  {STRUT_OPTION_GIVEN, "given", "WHAT",                                                            \
   "densities, lengths or prestress (default: by what the model gives)"},                          \
      {STRUT_OPTION_LEAST_TENSION, "least-tension", "FORCE",                                       \
       "lower bound on the tension of every cable"},                                               \
      {STRUT_OPTION_LEAST_DENSITY, "least-density", "DENSITY",                                     \
       "lower bound on the force density of every cable"},                                         \
  {                                                                                                \
    STRUT_OPTION_OBJECTIVE, "objective", "WHAT",                                                   \
        "which prestress: minimal largest (default), sum or squares"                               \
  }

#define STRUT_SHAPE_OPTIONS                                                                        \
  { STRUT_OPTION_AT, "at", "NAME", "the shape: drawn (default), start, or an equilibrium" }

#define STRUT_PATH_OPTIONS                                                                         \
  {STRUT_OPTION_LOAD, "load", "NAME",                                                              \
   "load to scale, or several: P,Q (default: all without a signal)"},                              \
      {STRUT_OPTION_OVER, "over", "WHAT",                                                          \
       "vary a parameter, an actuator, or a displacement NODE.x or NODE.y; also "                  \
       "WHAT=FROM..UNTIL"},                                                                        \
      {STRUT_OPTION_FROM, "from", "VALUE", "start value: a load factor, or in the unit of WHAT"},  \
      {STRUT_OPTION_UNTIL, "until", "VALUE", "end value, likewise (default: load factor 1)"},      \
      {STRUT_OPTION_STOP, "stop", "NODE.x=VALUE",                                                  \
       "or end earlier, where a node has moved so far along x or y"},                              \
      {STRUT_OPTION_AT, "at", "NAME", "equilibrium to start from (default: that of the start)"},   \
      {STRUT_OPTION_FRICTION, "friction", "none|kept",                                             \
       "kept: contacts stick and slide as the path goes (default: as the file says)"},             \
      {STRUT_OPTION_BRANCHES, "branches", "DEPTH",                                                 \
       "follow paths that leave at bifurcations: 1 of this path, 2 of its branches too, ..."},     \
  {                                                                                                \
    STRUT_OPTION_STEPS, "steps", "N",                                                              \
        "maximum number of steps (default " STRUT_TEXT_OF(STRUT_PATH_USUAL_STEPS) ")"              \
  }

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
  strut_status (*compute)(strut_analysis *a, strut_error *error);
  /** Fails where nothing was found, which is a result, too. May be NULL. */
  strut_status (*verdict)(const strut_analysis *a, strut_error *error);
  /** Rows of the result and, into *result, what they are of; strut_analysis_json writes it. */
  const strut_value_rows *(*values)(const strut_analysis *a, const void **result);
  char *(*csv)(const strut_analysis *a); /* NULL: no such file */
  char *(*table)(const strut_analysis *a);
  /** Tells the listener what is doubtful in the result. May be NULL. */
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
char *strut_analysis_json(const strut_analysis *a);

/** Computes; a->result is zero before. Call strut_analysis_free in any case. */
strut_status strut_analysis_compute(strut_analysis *a, strut_error *error);
void strut_analysis_free(strut_analysis *a);

#endif
