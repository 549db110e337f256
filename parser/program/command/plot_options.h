/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Options of figures: width, title, axes, what a figure of a run shows; and tables that are drawn.
 */
#pragma once

#include "engine/output/draw/chart.h"
#include "engine/output/figures/run_figure.h"
#include "engine/output/record_files.h"
#include "parser/program/command/arguments.h"

/** Tables of options: width; this and the title; what a figure of a run shows; labels and limits of one pair of axes. */
extern const strut_option strut_width_options[], strut_plot_setting_options[],
    strut_run_figure_options[], strut_axis_options[];

/**
 * Reads all but the file into a plot. `usual` is the default width [pt]; 0: a page's. STRUT_USAGE; the
 * listener hears why.
 */
strut_status strut_plot_settings_read(const strut_arguments *arguments, double usual,
                                      strut_plot *plot);
/** Reads labels and limits; limits of a logarithmic axis must be above 0. STRUT_USAGE as above. */
strut_status strut_axes_read(const strut_arguments *arguments, bool log_x, bool log_y,
                             strut_axis_choice *choice, strut_axis_choice *other_choice);

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
