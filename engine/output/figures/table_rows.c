/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of a table that are drawn: those of a text, groups, and the difference of two sides. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "engine/output/figures/table_figure.h"

int strut_table_column_of(const strut_table *table, const char *name, size_t length) {
  for (size_t i = 0; name && i < table->column_count; i++)
    if (strlen(table->columns[i].name) == length &&
        memcmp(table->columns[i].name, name, length) == 0)
      return (int)i;
  return STRUT_NO_COLUMN;
}

void strut_table_show_unit(strut_table *table, const char *name, strut_file_unit shown) {
  int column = name ? strut_table_column_of(table, name, strlen(name)) : STRUT_NO_COLUMN;
  if (column != STRUT_NO_COLUMN) table->columns[column].shown = shown;
}

bool strut_table_belongs(const strut_table_rows *rows, int column, const char *name, size_t row) {
  return rows->shown[row] &&
         (column == STRUT_NO_COLUMN || strcmp(rows->table->columns[column].text[row], name) == 0);
}

strut_status strut_table_groups_find(const strut_table_rows *rows, int column, size_t most,
                                     const char *what, strut_table_groups *groups,
                                     strut_error *error) {
  groups->count = column == STRUT_NO_COLUMN;
  groups->name[0] = NULL;
  for (size_t i = 0; i < rows->table->row_count && column != STRUT_NO_COLUMN; i++) {
    const strut_table_column *of = &rows->table->columns[column];
    size_t k = 0;
    while (k < groups->count && strcmp(groups->name[k], of->text[i]) != 0) k++;
    if (!rows->shown[i] || k < groups->count) continue;
    if (groups->count == most)
      return strut_fail(error, STRUT_USAGE, "column '%s' makes more than %zu %s", of->name, most,
                        what);
    groups->row[groups->count] = i;
    groups->name[groups->count++] = of->text[i];
  }
  return STRUT_OK;
}

/* ---- the difference of two sides ---- */

/* A row that knows where its keys are, to be sorted. */
typedef struct keyed {
  const strut_table_rows *rows;
  size_t row;
  int keys; /* that count */
} keyed;

/* Numbers by value, NAN first; texts alphabetically. */
static int compare_keys(const void *first, const void *second) {
  const keyed *one = first, *two = second;
  for (int i = 0; i < one->keys; i++) {
    int column = one->rows->keys[i];
    if (column == STRUT_NO_COLUMN) continue;
    const strut_table_column *of = &one->rows->table->columns[column];
    int order;
    if (of->value) {
      double x = of->value[one->row], y = of->value[two->row];
      order = isnan(x) || isnan(y) ? isnan(y) - isnan(x) : (x > y) - (x < y);
    } else {
      order = strcmp(of->text[one->row], of->text[two->row]);
    }
    if (order) return order;
  }
  return 0;
}

/* True if all keys but the last are equal. */
static bool alongside(keyed first, keyed second) {
  first.keys--;
  return compare_keys(&first, &second) == 0;
}

/* Among (count) sorted rows. */
static strut_table_partner find_partner(const keyed *first, size_t count, const keyed *wanted) {
  const strut_table_rows *rows = wanted->rows;
  size_t low = 0, high = count;
  while (low < high) { /* the first not before `wanted` */
    size_t middle = (low + high) / 2;
    bool before = compare_keys(&first[middle], wanted) < 0;
    *(before ? &low : &high) = middle + before;
  }
  if (low < count && compare_keys(&first[low], wanted) == 0)
    return (strut_table_partner){first[low].row, first[low].row, 0};
  if (!rows->between || low == 0 || low == count || !alongside(first[low - 1], *wanted) ||
      !alongside(first[low], *wanted))
    return (strut_table_partner){SIZE_MAX, SIZE_MAX, 0};
  const double *x = rows->table->columns[rows->keys[STRUT_KEYS_OF_ROWS - 1]].value;
  size_t before = first[low - 1].row, after = first[low].row;
  return (strut_table_partner){before, after,
                               (x[wanted->row] - x[before]) / (x[after] - x[before])};
}

/* Hides the rows of the first side and finds the partners of the others. */
static strut_status pair_sides(strut_table_rows *rows, int of, strut_arena *arena,
                               strut_error *error) {
  strut_table_groups sides;
  size_t count = 0, all = rows->table->row_count;
  strut_status status = strut_table_groups_find(rows, of, 2, "sides to compare", &sides, error);
  if (status) return status;
  if (sides.count < 2)
    return strut_fail(error, STRUT_USAGE,
                      "column '%.60s' has only the text '%.60s', so there is nothing to compare",
                      rows->table->columns[of].name, sides.name[0]);
  keyed *first = strut_arena_allocate(arena, all, sizeof *first);
  rows->partner = strut_arena_allocate(arena, all, sizeof *rows->partner);
  if (!first || !rows->partner) return strut_no_memory(error, "while drawing");
  memcpy(rows->side, sides.name, sizeof rows->side);
  for (size_t i = 0; i < all; i++) {
    if (!strut_table_belongs(rows, of, rows->side[0], i)) continue;
    first[count++] = (keyed){rows, i, STRUT_KEYS_OF_ROWS};
    rows->shown[i] = false;
  }
  qsort(first, count, sizeof *first, compare_keys);
  for (size_t i = 0; i < all; i++)
    if (rows->shown[i])
      rows->partner[i] = find_partner(first, count, &(keyed){rows, i, STRUT_KEYS_OF_ROWS});
  return STRUT_OK;
}

bool strut_table_compares(const strut_table_rows *rows, int column) {
  for (size_t i = 0; i < rows->value_count && rows->partner; i++)
    if (rows->values[i] == column) return true;
  return false;
}

double strut_table_number(const strut_table_rows *rows, int column, size_t row) {
  const double *value = column >= 0 ? rows->table->columns[column].value : NULL;
  if (!value) return (double)NAN;
  if (!strut_table_compares(rows, column)) return value[row];
  const strut_table_partner *partner = &rows->partner[row];
  if (partner->row == SIZE_MAX) return (double)NAN;
  double less = value[row] - value[partner->row];
  if (partner->weight > 0) less -= partner->weight * (value[partner->next] - value[partner->row]);
  return less;
}

bool strut_table_differs(const strut_table_rows *rows, int column, size_t row) {
  const char *const *text = rows->table->columns[column].text;
  size_t other = rows->partner[row].row;
  return other == SIZE_MAX || strcmp(text[other], text[row]) != 0;
}

strut_status strut_table_rows_choose(strut_table_rows *rows, int only, const char *text,
                                     int difference, strut_arena *arena, strut_error *error) {
  size_t count = rows->table->row_count, shown = only == STRUT_NO_COLUMN;
  rows->shown = strut_arena_allocate(arena, count + 1, 1);
  if (!rows->shown) return strut_no_memory(error, "while drawing");
  memset(rows->shown, true, count);
  for (size_t i = 0; i < count; i++)
    shown += rows->shown[i] = strut_table_belongs(rows, only, text, i);
  if (!shown)
    return strut_fail(error, STRUT_USAGE, "no row of the table has '%.60s' in column '%.60s'", text,
                      rows->table->columns[only].name);
  return difference == STRUT_NO_COLUMN ? STRUT_OK : pair_sides(rows, difference, arena, error);
}
