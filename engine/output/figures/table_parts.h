/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What figures of tables share: groups of rows, and a page with a title and panels.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_TABLE_PARTS_H
#define STRUT_ENGINE_OUTPUT_FIGURES_TABLE_PARTS_H

#include "engine/output/draw/canvas.h"
#include "engine/output/figures/table_figure.h"

enum { STRUT_MOST_GROUPS = 40 };

/** The different texts of a column, in their order; of no column, one group without a name. */
typedef struct strut_table_groups {
  size_t count;
  const char *name[STRUT_MOST_GROUPS];
} strut_table_groups;

/** STRUT_USAGE where there are more than `most`, which make what `what` says ("panels"). */
strut_status strut_table_groups_find(const strut_table *table, int column, size_t most,
                                     const char *what, strut_table_groups *groups,
                                     strut_error *error);
/** Whether a row belongs to a group of that column. */
bool strut_table_belongs(const strut_table *table, int column, const char *name, size_t row);
/** STRUT_USAGE where the column is not one of numbers. */
strut_status strut_table_numbers(const strut_table *table, int column, strut_error *error);
/** "a) friction = 0.1", or "" where there are no panels. */
void strut_table_panel_title(const strut_table *table, int column, const char *name, size_t panel,
                             char title[300]);

/** A page of panels of one size, below a title and `head` [pt] for a legend. */
typedef struct strut_panel_page {
  double width, head;         /* [pt] */
  double least_width, aspect; /* of a panel: at least so wide, so high for its width */
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

/** What is compared with what. Columns by number. */
typedef struct strut_table_pairing {
  int of;                            /* its two texts tell the sides apart: first, second */
  int keys[STRUT_MOST_KEYS_OF_ROWS]; /* equal in rows that belong together; may be none (-1) */
  size_t key_count;
  bool between; /* what the first side lacks at a value of the last key is taken from the straight
                        line between its neighbours there */
  const int *values; /* (value_count) what is compared */
  size_t value_count;
} strut_table_pairing;

/**
 * The rows whose column has that text, in their order. `some` shares texts with `table`, has an arena
 * of its own, and is freed by that. STRUT_USAGE where there are none; STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_table_only(const strut_table *table, int column, const char *text,
                                        strut_table *some, strut_error *error);
/**
 * The rows of the second text, whose compared numbers have those of the first taken off (NAN where the
 * first has no such row) and are named so; what is compared as a text stays. One more column, the
 * last, says 1 where a text differs, else 0; its name tells so. As strut_table_only; STRUT_USAGE also
 * where the column has not two texts.
 */
STRUT_API strut_status strut_table_difference(const strut_table *table,
                                              const strut_table_pairing *pairing,
                                              strut_table *difference, strut_error *error);

/** A table chosen from another. Zero-initialise. */
typedef struct strut_table_chosen {
  const strut_table *table; /* what is drawn: one of these, or the table itself */
  strut_table some, difference;
} strut_table_chosen;
/** Both in turn, as the choice says; pairing.of is that of the choice. Free it after a failure too. */
STRUT_API strut_status strut_table_choose(const strut_table *table,
                                          const strut_table_choice *choice,
                                          strut_table_pairing pairing, strut_table_chosen *chosen,
                                          strut_error *error);
STRUT_API void strut_table_chosen_free(strut_table_chosen *chosen);

#endif
