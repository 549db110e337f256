/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Points of a table over two of its columns, coloured by a third, some of them marked.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_TABLE_PARTS_H
#define STRUT_ENGINE_OUTPUT_FIGURES_TABLE_PARTS_H

#include "engine/output/draw/canvas.h"
#include "engine/output/figures/table_figure.h"

typedef struct strut_scatter_figure {
  const char *title; /* may be NULL */
  double width;      /* [pt] */
  int x, y, value;   /* columns of numbers; value: STRUT_NO_COLUMN for one colour */
  strut_axis_choice x_axis, y_axis;
  strut_colours colours;      /* AUTO: sequential */
  const bool *shown, *marked; /* (rows) marked ones lie on top, in a ring */
} strut_scatter_figure;

/** As strut_table_curves. */
STRUT_API strut_status strut_table_scatter(const char *path, const strut_scatter_figure *figure,
                                           const strut_table *table, strut_error *error);

/* Shared by figures of tables: groups of rows, a page of panels, and tables derived from tables. */

enum { STRUT_MOST_TABLE_GROUPS = 40 };

/** The different texts of a column, in their order; of no column, one group without a name. */
typedef struct strut_table_groups {
  size_t count;
  const char *name[STRUT_MOST_TABLE_GROUPS];
} strut_table_groups;

/** STRUT_USAGE where there are more than `most`, named `what` in the message ("panels"). */
strut_status strut_table_groups_find(const strut_table *table, int column, size_t most,
                                     const char *what, strut_table_groups *groups,
                                     strut_error *error);
/** True if a row belongs to a group of that column. */
bool strut_table_belongs(const strut_table *table, int column, const char *name, size_t row);
/** STRUT_USAGE where the column does not hold numbers. */
strut_status strut_table_numbers(const strut_table *table, int column, strut_error *error);
/** "a) friction = 0.1", or "" where there are no panels. */
void strut_table_panel_title(const strut_table *table, int column, const char *name, size_t panel,
                             char title[300]);

/** The axis for a column named `name` with that unit; its range is NAN where it is not limited. */
strut_axis strut_table_axis_of(const strut_axis_choice *wanted, const char *name, const char *unit,
                               bool logarithmic);

/** A page of panels of one size, below a title and `head` [pt] for a legend. */
typedef struct strut_panel_page {
  double width, head;         /* [pt] */
  double least_width, aspect; /* of a panel: least width [pt], height over width */
  size_t panels;
} strut_panel_page;

/** Draws the panel-th panel into its box. */
typedef strut_status (*strut_panel_draw)(void *context, strut_canvas *canvas, strut_box box,
                                         size_t panel);
/** Opens the page, draws title, head (may be NULL) and panels, and completes the file. */
strut_status strut_panel_page_draw(const char *path, const char *title,
                                   const strut_panel_page *page,
                                   void (*head)(void *context, strut_canvas *canvas, strut_box box),
                                   strut_panel_draw panel, void *context, strut_error *error);

enum { STRUT_MOST_KEYS_OF_ROWS = 4 };

/** The rows and columns under comparison. Columns by number. */
typedef struct strut_table_pairing {
  int of;                            /* its two texts are the sides: first, second */
  int keys[STRUT_MOST_KEYS_OF_ROWS]; /* equal in matching rows; -1: unused */
  size_t key_count;
  bool between;      /* the first side is interpolated linearly over the last key */
  const int *values; /* (value_count) compared columns */
  size_t value_count;
} strut_table_pairing;

/**
 * A copy of (count) rows in the arena of `some`, with room for one column more; texts are shared.
 * STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_table_rows(const strut_table *table, const size_t *rows, size_t count,
                                        strut_table *some, strut_error *error);
/**
 * The rows whose column has that text, in their order. `some` shares texts with `table` and has its
 * own arena, which frees it. STRUT_USAGE where there are none; STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_table_only(const strut_table *table, int column, const char *text,
                                        strut_table *some, strut_error *error);
/**
 * The rows of the second text minus those of the first: compared numbers are subtracted (NAN where
 * the first has no such row) and their columns renamed; compared texts are kept. An additional last
 * column is 1 where a text differs, else 0. Fails as strut_table_only, and with STRUT_USAGE where
 * the column does not have two texts.
 */
STRUT_API strut_status strut_table_difference(const strut_table *table,
                                              const strut_table_pairing *pairing,
                                              strut_table *difference, strut_error *error);

/** A table chosen from another. Zero-initialise. */
typedef struct strut_table_chosen {
  const strut_table *table; /* the result: one of these, or the table itself */
  strut_table some, difference;
} strut_table_chosen;
/**
 * Applies the choice: first `only`, then `difference`, which sets pairing.of. Free it after a
 * failure too.
 */
STRUT_API strut_status strut_table_choose(const strut_table *table,
                                          const strut_table_choice *choice,
                                          strut_table_pairing pairing, strut_table_chosen *chosen,
                                          strut_error *error);
STRUT_API void strut_table_chosen_free(strut_table_chosen *chosen);

#endif
