/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Scenes as options change them: method, step and span, accuracy; and over values of parameters. Options of figures:
 * width, title, axes, what a figure of a run shows; and tables that are drawn.
 */
#pragma once

#include "engine/output/draw/chart.h"
#include "engine/output/figures/run_figure.h"
#include "engine/output/record_files.h"
#include "engine/scene/experiment.h"
#include "engine/scene/study.h"
#include "engine/study/sweep/sweep.h"
#include "parser/program/command/arguments.h"

/**
 * Tables of options that change how a scene is run without changing the file: method, step and accuracy; those of
 * them that a run has which is advanced from outside; rigid bars, lumped masses and other laws; the first and these.
 */
extern const strut_option strut_run_setting_options[], strut_method_options[],
    strut_fidelity_options[], strut_experiment_options[];
#define STRUT_FORCE_OPTION                                                                         \
  { STRUT_FILLS(force), "force", NULL, "run even if the step exceeds the stability limit" }

/** The i-th of all these options that is given, or NULL. */
const strut_option *strut_run_option_given(const strut_arguments *arguments, size_t i);
/** What a scene is read for that is then run with them: its step may be given by them. */
strut_purpose strut_run_options_purpose(const strut_arguments *arguments);
/** Applies them to the scene and its experiment. STRUT_USAGE; the listener hears why. */
strut_status strut_run_options_apply(const strut_arguments *arguments, strut_setup *setup);

/* Scenes of one model over values of some of its parameters, as paths, branches and sweeps need them. */

/** Zero-initialise but for what stands before `own`. */
typedef struct strut_varied_scenes {
  const char *file, *text; /* of the model; not owned */
  size_t length;
  strut_purpose purpose;            /* what the scenes are for */
  const strut_scene_source *source; /* its tree; NULL: it is read from the text */
  strut_scene_source *own;
  strut_setting *settings; /* (setting_count) those of --set, and last the varied ones */
  size_t setting_count, varied;
  const strut_arguments *options; /* of method and model, applied to each scene; NULL: none */
} strut_varied_scenes;

/**
 * Varies the parameters `names`, which the scene has; the names are kept. Their dimensions go to
 * `dimensions`, unless it is NULL. STRUT_NO_MEMORY; the listener hears it. Free `scenes` in any case.
 */
strut_status strut_varied_scenes_open(const strut_arguments *arguments, const char *const *names,
                                      size_t count, strut_varied_scenes *scenes,
                                      strut_dimension *dimensions);
/**
 * The scene of the strut_varied_scenes where the parameters have these values. STRUT_BAD_SCENE with the first finding
 * and its place. From any thread.
 */
strut_status strut_varied_scenes_read(void *scenes, const strut_study_value *values,
                                      strut_setup *setup, strut_error *error);
/** The same where more parameters have the values numbers (count) [SI]. */
strut_status strut_varied_scenes_vary(void *scenes, const strut_study_value *values,
                                      const strut_derived_by *by, size_t count,
                                      const double *numbers, strut_setup *setup,
                                      strut_error *error);
/** The same of a single parameter. */
strut_status strut_varied_scenes_at(void *scenes, double value, strut_setup *setup,
                                    strut_error *error);
/**
 * The derivatives of a run of the setup that is done, whose scenes these are with the options of `arguments`; opens
 * and frees them. Fills those of the summary, where the experiment asks for some. As strut_sweep_derive_run.
 */
strut_status strut_varied_scenes_derive(const strut_arguments *arguments,
                                        strut_varied_scenes *scenes, const strut_setup *setup,
                                        const strut_flag *interrupt, strut_summary *summary,
                                        strut_error *error);
void strut_varied_scenes_free(strut_varied_scenes *scenes);

/** The unit to print behind values of a dimension, "" where there is none. */
const char *strut_unit_of(strut_dimension dimension);

/* ---- figures ---- */

/** Tables of options: width; this and the title; what a figure of a run shows; labels and limits of one pair of axes. */
extern const strut_option strut_svg_text_options[], strut_width_options[],
    strut_plot_setting_options[], strut_run_figure_options[], strut_axis_options[];

/**
 * Reads all but the file into a plot. `usual` is the default width [pt]; 0: a page's. STRUT_USAGE; the
 * listener hears why.
 */
strut_status strut_plot_settings_read(const strut_arguments *arguments, double usual,
                                      strut_plot *plot);

enum { STRUT_MOST_TIMES = 100 };

/** Reads what a figure of a run shows; `times` has room for STRUT_MOST_TIMES and stays in place. As above. */
strut_status strut_run_figure_read(const strut_arguments *arguments, strut_run_figure *figure,
                                   double *times);

/* A table of numbers and texts, from a file or the standard input. */

/** A column that a figure of a table names: by a key of a study, by an option of `strut plot`. */
typedef struct strut_figure_key {
  const char *key, *option;
  size_t member;    /* of strut_study_figure */
  const char *ends; /* a name in the text: "," has several, "=" of COLUMN=TEXT; else "" */
  bool number;      /* its column holds numbers */
} strut_figure_key;

/** The columns that a figure may name. */
typedef struct strut_figure_columns {
  const char *of;                                     /* "the table" */
  const char *(*name)(const void *context, size_t i); /* NULL behind the last */
  /** Says in `fault` why the key cannot have column i, or that text of it. */
  void (*judge)(const void *context, size_t i, const strut_figure_key *key, const char *text,
                char fault[STRUT_MESSAGE_MOST]);
  const void *context;
} strut_figure_columns;

/** The first key whose column is not there, or has a fault, which it says; NULL where all is well. */
const strut_figure_key *strut_figure_fault(const strut_study_figure *figure,
                                           const strut_figure_columns *columns,
                                           char fault[STRUT_MESSAGE_MOST]);

/**
 * Reads the file, "-" being the standard input. The listener hears messages, with line and column;
 * STRUT_BAD_SCENE where it is not a table. The table is freed by strut_arena_free(&table->arena).
 */
strut_status strut_table_read(const strut_listener *listener, const char *path, strut_table *table);
/** The same of the text of a file. */
strut_status strut_table_parse(const strut_listener *listener, const char *path, const char *text,
                               size_t length, strut_table *table);
