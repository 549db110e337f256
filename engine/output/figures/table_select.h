/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Tables made of tables: the rows that carry a text, and how the rows of two texts differ.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_TABLE_SELECT_H
#define STRUT_ENGINE_OUTPUT_FIGURES_TABLE_SELECT_H

#include "engine/output/figures/table_figure.h"

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
