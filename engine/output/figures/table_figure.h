/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Figures of tables: curves in panels with grey bands, maps, clouds of points.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_TABLE_FIGURE_H
#define STRUT_ENGINE_OUTPUT_FIGURES_TABLE_FIGURE_H

#include <stdbool.h>

#include "engine/base/status.h"
#include "engine/output/draw/figure.h"
#include "engine/output/record_files.h"

enum { STRUT_NO_COLUMN = -1, STRUT_MOST_Y = 20, STRUT_MOST_PANELS = 24 };

/** Selection of rows, and whether their differences are drawn. */
typedef struct strut_table_choice {
  int only; /* rows whose column has the text `only_value` */
  const char *only_value;
  int difference; /* its two texts are two sides: the second minus the first; of categories, the
                     second with doubt where the first differs */
} strut_table_choice;

typedef enum strut_table_kind {
  STRUT_TABLE_CURVES, /* y over x, all y of one unit */
  STRUT_TABLE_MAP,    /* value over x and y: texts are categories, numbers get a colour scale */
  STRUT_TABLE_POINTS  /* y over x, coloured by value; the marked ones on top, in a ring */
} strut_table_kind;

/** What is drawn of a table. Columns by number, STRUT_NO_COLUMN for none. */
typedef struct strut_table_figure {
  strut_table_kind kind;
  int x, y[STRUT_MOST_Y], y_count;
  int panels; /* a panel for each of its texts */
  strut_table_choice choice;
  /* Of curves. */
  int by;   /* a curve for each of its texts */
  int band; /* grey where it has the text `band_value`, midway to the next points */
  const char *band_value;
  bool log_x, log_y,
      between; /* between: of a difference, the first side is interpolated linearly */
  /* Of maps and points. */
  int value, doubt; /* doubt: hatched where it is not empty, 0, false or no */
  strut_colours colours;
  const bool *shown, *marked; /* (rows) of points; NULL: all, none */
} strut_table_figure;

/** One without any column but the first as x and y. */
#define STRUT_TABLE_FIGURE                                                                         \
  (strut_table_figure) {                                                                           \
    .y_count = 1, .panels = STRUT_NO_COLUMN, .by = STRUT_NO_COLUMN, .band = STRUT_NO_COLUMN,       \
    .value = STRUT_NO_COLUMN, .doubt = STRUT_NO_COLUMN, .choice = {                                \
      .only = STRUT_NO_COLUMN,                                                                     \
      .difference = STRUT_NO_COLUMN                                                                \
    }                                                                                              \
  }

/**
 * Draws into the plot's file. Rows of a map are in any order; points of its grid without a row have no answer.
 * STRUT_USAGE for a column without numbers where numbers are needed, y of different units, too many panels or
 * curves, or too large a grid; otherwise as strut_figure_draw.
 */
STRUT_API strut_status strut_table_draw(const strut_plot *plot, const strut_table_figure *figure,
                                        const strut_table *table, strut_error *error);

/* ---- tables made of tables ---- */

enum { STRUT_MOST_TABLE_GROUPS = 40, STRUT_MOST_KEYS_OF_ROWS = 4 };

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
