/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Rows of a table that are drawn: all, those of a text, or those of a second side less the first. */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_TABLE_CHOICE_H
#define STRUT_ENGINE_OUTPUT_FIGURES_TABLE_CHOICE_H

#include "engine/output/figures/table_figure.h"

enum { STRUT_MOST_TABLE_GROUPS = 40, STRUT_MOST_KEYS_OF_ROWS = 4 };

/** What is compared of two sides. Columns by number. */
typedef struct strut_table_pairing {
  int keys[STRUT_MOST_KEYS_OF_ROWS]; /* equal in matching rows; -1: unused */
  size_t key_count;
  bool between;      /* the first side is interpolated linearly over the last key */
  const int *values; /* (value_count) compared columns */
  size_t value_count;
} strut_table_pairing;

/** The row of the first side, or two and a weight between them; SIZE_MAX: there is none. */
typedef struct strut_table_partner {
  size_t row, next;
  double weight; /* of `next` */
} strut_table_partner;

typedef struct strut_table_rows {
  const strut_table *table;
  bool *shown; /* (rows) */
  /* Of a difference, else NULL. */
  strut_table_pairing pairing;
  const char *side[2];          /* the texts: first, second */
  strut_table_partner *partner; /* (rows) */
} strut_table_rows;

/**
 * Applies the choice, in the arena: first `only`, then `difference`, of whose two texts the rows of the second are
 * shown. STRUT_USAGE where there is no such row, or there are not two texts; STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_table_rows_choose(const strut_table *table,
                                               const strut_table_choice *choice,
                                               const strut_table_pairing *pairing,
                                               strut_arena *arena, strut_table_rows *rows,
                                               strut_error *error);
/** True if there is a difference of this column. */
STRUT_API bool strut_table_compares(const strut_table_rows *rows, int column);
/** A number; of a compared column less its partner's, NAN without one. */
STRUT_API double strut_table_number(const strut_table_rows *rows, int column, size_t row);
/** True if the text is another one than its partner's, or there is no partner. */
STRUT_API bool strut_table_differs(const strut_table_rows *rows, int column, size_t row);

/** The different texts of a column in the rows shown, in their order; of no column, one group without a name. */
typedef struct strut_table_groups {
  size_t count;
  const char *name[STRUT_MOST_TABLE_GROUPS];
  size_t row[STRUT_MOST_TABLE_GROUPS]; /* the first of each */
} strut_table_groups;

/** STRUT_USAGE where there are more than `most`, named `what` in the message ("panels"). */
strut_status strut_table_groups_find(const strut_table_rows *rows, int column, size_t most,
                                     const char *what, strut_table_groups *groups,
                                     strut_error *error);
/** True if a row is shown and belongs to a group of that column. */
bool strut_table_belongs(const strut_table_rows *rows, int column, const char *name, size_t row);

#endif
