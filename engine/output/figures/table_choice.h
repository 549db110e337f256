/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Tables made of tables: groups of rows, some rows, the difference of two sides. */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_TABLE_CHOICE_H
#define STRUT_ENGINE_OUTPUT_FIGURES_TABLE_CHOICE_H

#include "engine/output/figures/table_figure.h"

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
