/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables from tables: rows of a text, groups, and the difference of two sides. */
#include <math.h>
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

strut_status strut_table_groups_find(const strut_table *table, int column, size_t most,
                                     const char *what, strut_table_groups *groups,
                                     strut_error *error) {
  groups->count = column == STRUT_NO_COLUMN;
  groups->name[0] = NULL;
  for (size_t i = 0; i < table->row_count && column != STRUT_NO_COLUMN; i++) {
    const strut_table_column *of = &table->columns[column];
    size_t k = 0;
    while (k < groups->count && strcmp(groups->name[k], of->text[i]) != 0) k++;
    if (k < groups->count) continue;
    if (groups->count == most)
      return strut_fail(error, STRUT_USAGE, "column '%s' makes more than %zu %s", of->name, most,
                        what);
    groups->row[groups->count] = i;
    groups->name[groups->count++] = of->text[i];
  }
  return STRUT_OK;
}

/* Keeps those rows. False: out of memory. */
static bool keep_rows(strut_table *table, const bool *kept) {
  size_t all = table->row_count, count = 0;
  for (strut_table_column *c = table->columns; c < table->columns + table->column_count; c++) {
    const char **text = strut_arena_allocate(&table->arena, all + 1, sizeof *text);
    double *value = strut_arena_allocate(&table->arena, all + 1, sizeof *value);
    if (!text || !value) return false;
    count = 0;
    for (size_t i = 0; i < all; i++) {
      if (!kept[i]) continue;
      if (c->text) text[count] = c->text[i];
      if (c->value) value[count] = c->value[i];
      count++;
    }
    if (c->text) c->text = text;
    if (c->value) c->value = value;
  }
  table->row_count = count;
  return true;
}

strut_status strut_table_choose(const strut_table *from, int column, const char *text,
                                const bool *shown, strut_table *chosen, strut_error *error) {
  size_t rows = from->row_count, left = 0;
  strut_arena *arena = &chosen->arena;
  bool *kept = strut_arena_allocate(arena, rows + 1, sizeof *kept);
  chosen->columns = strut_arena_allocate(arena, from->column_count + 2, sizeof *from->columns);
  if (!kept || !chosen->columns) return strut_no_memory(error, "while drawing");
  chosen->row_count = rows, chosen->column_count = from->column_count;
  memcpy(chosen->columns, from->columns, from->column_count * sizeof *from->columns);
  for (size_t i = 0; i < rows; i++)
    left += kept[i] = (!shown || shown[i]) && (column == STRUT_NO_COLUMN ||
                                               strcmp(from->columns[column].text[i], text) == 0);
  if (column != STRUT_NO_COLUMN && !left)
    return strut_fail(error, STRUT_USAGE, "no row of the table has '%.60s' in column '%.60s'", text,
                      from->columns[column].name);
  return left == rows || keep_rows(chosen, kept) ? STRUT_OK
                                                 : strut_no_memory(error, "while drawing");
}

/* ---- the difference of two sides ---- */

/* A row that knows where its keys are, to be sorted. */
typedef struct keyed {
  const strut_table *table;
  const strut_table_pairing *pairing;
  size_t row;
  int keys; /* that count */
} keyed;

/* The row of the first side, or two and a weight between them; SIZE_MAX if no row fits. */
typedef struct partner {
  size_t row, next;
  double weight; /* of `next` */
} partner;

/* Numbers by value, NAN first; texts alphabetically. */
static int compare_keys(const void *first, const void *second) {
  const keyed *one = first, *two = second;
  for (int i = 0; i < one->keys; i++) {
    int column = one->pairing->keys[i], order;
    if (column == STRUT_NO_COLUMN) continue;
    const strut_table_column *of = &one->table->columns[column];
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
static partner find_partner(const keyed *first, size_t count, const keyed *wanted) {
  const strut_table_pairing *pairing = wanted->pairing;
  size_t low = 0, high = count;
  while (low < high) { /* the first not before `wanted` */
    size_t middle = (low + high) / 2;
    bool before = compare_keys(&first[middle], wanted) < 0;
    *(before ? &low : &high) = middle + before;
  }
  if (low < count && compare_keys(&first[low], wanted) == 0)
    return (partner){first[low].row, first[low].row, 0};
  if (!pairing->between || low == 0 || low == count || !alongside(first[low - 1], *wanted) ||
      !alongside(first[low], *wanted))
    return (partner){SIZE_MAX, SIZE_MAX, 0};
  const double *x = wanted->table->columns[pairing->keys[STRUT_KEYS_OF_ROWS - 1]].value;
  size_t before = first[low - 1].row, after = first[low].row;
  return (partner){before, after, (x[wanted->row] - x[before]) / (x[after] - x[before])};
}

/* Replaces a column's numbers of rows with partners by differences; of texts a column says where they differ. */
static bool subtract(strut_table *table, int column, const char *name, const char *other,
                     const partner *partners, const bool *second) {
  strut_table_column *of = &table->columns[column];
  double *less = strut_arena_allocate(&table->arena, table->row_count + 1, sizeof *less);
  const char **differs = strut_arena_allocate(&table->arena, table->row_count + 1, sizeof *differs);
  if (!less || !differs || !name || !other) return false;
  for (size_t i = 0; i < table->row_count; i++) {
    const partner *p = &partners[i];
    bool alone = !second[i] || p->row == SIZE_MAX;
    less[i] = (double)NAN;
    if (!of->value) differs[i] = alone || strcmp(of->text[p->row], of->text[i]) != 0 ? "yes" : "";
    if (!of->value || alone) continue;
    less[i] = of->value[i] - of->value[p->row];
    if (p->weight > 0) less[i] -= p->weight * (of->value[p->next] - of->value[p->row]);
  }
  if (of->value)
    of->value = less, of->name = name;
  else
    table->columns[table->column_count++] =
        (strut_table_column){.name = other, .unit = "", .text = differs};
  return true;
}

strut_status strut_table_subtract(strut_table *table, int column,
                                  const strut_table_pairing *pairing, strut_error *error) {
  strut_table_groups sides;
  strut_arena *arena = &table->arena;
  const strut_table_column *by = &table->columns[column];
  size_t count = 0, all = table->row_count;
  strut_status status =
      strut_table_groups_find(table, column, 2, "sides to compare", &sides, error);
  if (status) return status;
  if (sides.count < 2)
    return strut_fail(error, STRUT_USAGE,
                      "column '%.60s' has only the text '%.60s', so there is nothing to compare",
                      by->name, sides.name[0]);
  keyed *first = strut_arena_allocate(arena, all, sizeof *first);
  partner *partners = strut_arena_allocate(arena, all, sizeof *partners);
  bool *second = strut_arena_allocate(arena, all, sizeof *second),
       fine = first && partners && second;
  for (size_t i = 0; i < all && fine; i++) {
    second[i] = strcmp(by->text[i], sides.name[0]) != 0;
    if (!second[i]) first[count++] = (keyed){table, pairing, i, STRUT_KEYS_OF_ROWS};
  }
  if (fine) qsort(first, count, sizeof *first, compare_keys);
  for (size_t i = 0; i < all && fine; i++)
    if (second[i])
      partners[i] = find_partner(first, count, &(keyed){table, pairing, i, STRUT_KEYS_OF_ROWS});
  const char *other = strut_arena_format(arena, "%s: other", sides.name[0]);
  for (size_t k = 0; k < pairing->value_count && fine; k++) {
    int value = pairing->values[k];
    const char *name = strut_arena_format(arena, "%s, %s%s%s less %s", table->columns[value].name,
                                          by->value ? by->name : "", by->value ? " " : "",
                                          sides.name[1], sides.name[0]);
    fine = subtract(table, value, name, other, partners, second);
  }
  return fine && keep_rows(table, second) ? STRUT_OK : strut_no_memory(error, "while drawing");
}
