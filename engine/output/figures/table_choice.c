/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables made of tables: some rows, or the difference of two sides. */
#include "engine/output/figures/table_choice.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

strut_status strut_table_groups_find(const strut_table *table, int column, size_t most,
                                     const char *what, strut_table_groups *groups,
                                     strut_error *error) {
  groups->count = 1;
  groups->name[0] = NULL;
  if (column == STRUT_NO_COLUMN) return STRUT_OK;
  groups->count = 0;
  for (size_t i = 0; i < table->row_count; i++) {
    const char *text = table->columns[column].text[i];
    size_t k = 0;
    while (k < groups->count && strcmp(groups->name[k], text) != 0) k++;
    if (k < groups->count) continue;
    if (groups->count == most)
      return strut_fail(error, STRUT_USAGE, "column '%s' makes more than %zu %s",
                        table->columns[column].name, most, what);
    groups->name[groups->count++] = text;
  }
  return STRUT_OK;
}

bool strut_table_belongs(const strut_table *table, int column, const char *name, size_t row) {
  return column == STRUT_NO_COLUMN || strcmp(table->columns[column].text[row], name) == 0;
}

strut_status strut_table_rows(const strut_table *table, const size_t *rows, size_t count,
                              strut_table *some, strut_error *error) {
  some->row_count = count;
  some->column_count = table->column_count;
  some->columns =
      strut_arena_allocate(&some->arena, table->column_count + 1, sizeof *some->columns);
  if (!some->columns) return strut_no_memory(error, "while drawing");
  for (size_t i = 0; i < table->column_count; i++) {
    const strut_table_column *from = &table->columns[i];
    const char **text = strut_arena_allocate(&some->arena, count, sizeof *text);
    double *value = strut_arena_allocate(&some->arena, count, sizeof *value);
    if (!text || !value) return strut_no_memory(error, "while drawing");
    for (size_t k = 0; k < count; k++) {
      if (from->text) text[k] = from->text[rows[k]];
      if (from->value) value[k] = from->value[rows[k]];
    }
    some->columns[i] = (strut_table_column){
        .name = from->name, .unit = from->unit, .text = text, .value = from->value ? value : NULL};
  }
  return STRUT_OK;
}

/* Numbers of the rows with that text, in the arena; NULL: memory is out. */
static size_t *rows_with(const strut_table *table, int column, const char *text, strut_arena *arena,
                         size_t *count) {
  size_t *rows = strut_arena_allocate(arena, table->row_count + 1, sizeof *rows);
  *count = 0;
  for (size_t i = 0; rows && i < table->row_count; i++)
    if (strut_table_belongs(table, column, text, i)) rows[(*count)++] = i;
  return rows;
}

strut_status strut_table_only(const strut_table *table, int column, const char *text,
                              strut_table *some, strut_error *error) {
  size_t count;
  *some = (strut_table){0};
  size_t *rows = rows_with(table, column, text, &some->arena, &count);
  if (!rows) return strut_no_memory(error, "while drawing");
  if (!count)
    return strut_fail(error, STRUT_USAGE, "no row of the table has '%.60s' in column '%.60s'", text,
                      table->columns[column].name);
  return strut_table_rows(table, rows, count, some, error);
}

/* A row that knows where its keys are, to be sorted. */
typedef struct keyed {
  const strut_table *table;
  const strut_table_pairing *pairing;
  size_t row;
} keyed;

/* Numbers by value, NAN first; texts alphabetically. */
static int compare_keys(const void *first, const void *second) {
  const keyed *one = first, *two = second;
  for (size_t i = 0; i < one->pairing->key_count; i++) {
    int column = one->pairing->keys[i];
    if (column == STRUT_NO_COLUMN) continue;
    const strut_table_column *table_column = &one->table->columns[column];
    int order;
    if (table_column->value) {
      double x = table_column->value[one->row], y = table_column->value[two->row];
      order = isnan(x) || isnan(y) ? isnan(y) - isnan(x) : (x > y) - (x < y);
    } else {
      order = strcmp(table_column->text[one->row], table_column->text[two->row]);
    }
    if (order) return order;
  }
  return 0;
}

typedef struct sides {
  strut_table_groups names; /* two */
  size_t *second, second_count;
  keyed *first; /* (first_count) sorted */
  size_t first_count;
} sides;

static strut_status find_sides(const strut_table *table, const strut_table_pairing *pairing,
                               sides *self, strut_arena *arena, strut_error *error) {
  const char *name = table->columns[pairing->of].name;
  strut_status status =
      strut_table_groups_find(table, pairing->of, 2, "sides to compare", &self->names, error);
  if (status) return status;
  if (self->names.count < 2)
    return strut_fail(error, STRUT_USAGE,
                      "column '%.60s' has only the text '%.60s', so there is nothing to compare",
                      name, self->names.name[0]);
  size_t *rows = rows_with(table, pairing->of, self->names.name[0], arena, &self->first_count);
  self->second = rows_with(table, pairing->of, self->names.name[1], arena, &self->second_count);
  self->first = strut_arena_allocate(arena, self->first_count, sizeof *self->first);
  if (!rows || !self->second || !self->first) return strut_no_memory(error, "while drawing");
  for (size_t i = 0; i < self->first_count; i++)
    self->first[i] = (keyed){.table = table, .pairing = pairing, .row = rows[i]};
  qsort(self->first, self->first_count, sizeof *self->first, compare_keys);
  return STRUT_OK;
}

/* The rows of the first side matching a row of the second. */
typedef struct partner {
  size_t row, next; /* SIZE_MAX: none */
  double weight;    /* of `next` */
} partner;

/* True if all keys but the last are equal. */
static bool alongside(const keyed *first, const keyed *second) {
  strut_table_pairing but_last = *first->pairing;
  but_last.key_count--;
  const keyed one = {.table = first->table, .pairing = &but_last, .row = first->row};
  const keyed two = {.table = second->table, .pairing = &but_last, .row = second->row};
  return compare_keys(&one, &two) == 0;
}

static partner find_partner(const sides *self, const keyed *wanted) {
  const strut_table_pairing *pairing = wanted->pairing;
  size_t low = 0, high = self->first_count;
  while (low < high) { /* the first not before `wanted` */
    size_t middle = (low + high) / 2;
    if (compare_keys(&self->first[middle], wanted) < 0) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  const keyed *after = self->first + low, *before = after - 1;
  if (low < self->first_count && compare_keys(after, wanted) == 0)
    return (partner){after->row, after->row, 0};
  if (!pairing->between || low == 0 || low == self->first_count || !alongside(before, wanted) ||
      !alongside(after, wanted))
    return (partner){SIZE_MAX, SIZE_MAX, 0};
  const double *x = wanted->table->columns[pairing->keys[pairing->key_count - 1]].value;
  return (partner){before->row, after->row,
                   (x[wanted->row] - x[before->row]) / (x[after->row] - x[before->row])};
}

/* Compares one column: numbers are subtracted, different texts marked. */
static bool compare_column(const strut_table *table, const sides *self, const partner *partners,
                           int column, strut_table *out, const char **mark) {
  strut_table_column *to = &out->columns[column];
  const strut_table_column *from = &table->columns[column];
  for (size_t k = 0; !from->value && k < self->second_count; k++)
    if (partners[k].row == SIZE_MAX || strcmp(from->text[partners[k].row], to->text[k]) != 0)
      mark[k] = "1";
  if (!from->value) return true;
  double *value = strut_arena_allocate(&out->arena, self->second_count, sizeof *value);
  to->name = strut_arena_format(&out->arena, "%s, %s less %s", from->name, self->names.name[1],
                                self->names.name[0]);
  if (!value || !to->name) return false;
  for (size_t k = 0; k < self->second_count; k++) {
    const partner *p = &partners[k];
    value[k] = (double)NAN;
    if (p->row == SIZE_MAX) continue;
    value[k] = to->value[k] - from->value[p->row];
    if (p->weight > 0) value[k] -= p->weight * (from->value[p->next] - from->value[p->row]);
  }
  to->value = value;
  return true;
}

static strut_status subtract_sides(const strut_table *table, const strut_table_pairing *pairing,
                                   const sides *self, strut_table *out, strut_error *error) {
  partner *partners = strut_arena_allocate(&out->arena, self->second_count, sizeof *partners);
  const char **mark = strut_arena_allocate(&out->arena, self->second_count, sizeof *mark);
  const char *name = strut_arena_format(&out->arena, "%s: other", self->names.name[0]);
  if (!partners || !mark || !name) return strut_no_memory(error, "while drawing");
  for (size_t k = 0; k < self->second_count; k++) {
    const keyed wanted = {.table = table, .pairing = pairing, .row = self->second[k]};
    partners[k] = find_partner(self, &wanted);
    mark[k] = "0";
  }
  for (size_t i = 0; i < pairing->value_count; i++)
    if (!compare_column(table, self, partners, pairing->values[i], out, mark))
      return strut_no_memory(error, "while drawing");
  out->columns[out->column_count++] = (strut_table_column){.name = name, .unit = "", .text = mark};
  return STRUT_OK;
}

strut_status strut_table_difference(const strut_table *table, const strut_table_pairing *pairing,
                                    strut_table *difference, strut_error *error) {
  sides s;
  *difference = (strut_table){0};
  strut_status status = find_sides(table, pairing, &s, &difference->arena, error);
  if (!status) status = strut_table_rows(table, s.second, s.second_count, difference, error);
  return status ? status : subtract_sides(table, pairing, &s, difference, error);
}

strut_status strut_table_choose(const strut_table *table, const strut_table_choice *choice,
                                strut_table_pairing pairing, strut_table_chosen *chosen,
                                strut_error *error) {
  strut_status status = STRUT_OK;
  chosen->table = table;
  if (choice->only != STRUT_NO_COLUMN) {
    status = strut_table_only(table, choice->only, choice->only_value, &chosen->some, error);
    chosen->table = &chosen->some;
  }
  if (status || choice->difference == STRUT_NO_COLUMN) return status;
  pairing.of = choice->difference;
  status = strut_table_difference(chosen->table, &pairing, &chosen->difference, error);
  chosen->table = &chosen->difference;
  return status;
}

void strut_table_chosen_free(strut_table_chosen *chosen) {
  strut_arena_free(&chosen->some.arena);
  strut_arena_free(&chosen->difference.arena);
}
