/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "engine/output/draw/chart.h"
#include "engine/output/figures/table_figure.h"
#include "engine/output/figures/table_parts.h"

static const double PANEL_WIDTH = 200, ASPECT = 0.8;
enum { MOST_CELLS = 4000000 };

typedef struct mapper {
  const strut_table_map_figure *figure;
  const strut_table *table;
  strut_table_groups panels, names;
  double *xs, *ys;
  size_t columns, rows;
  double low, high;    /* of the values; equal if there is no or one value */
  strut_beyond beyond; /* this range */
  strut_arena arena;
} mapper;

/* The different finite values of a column, ascending; NULL: no memory. */
static double *distinct_values(mapper *m, int column, size_t *count) {
  const double *value = m->table->columns[column].value;
  double *all = strut_arena_allocate(&m->arena, m->table->row_count, sizeof *all);
  size_t used = 0, kept = 0;
  for (size_t i = 0; all && i < m->table->row_count; i++)
    if (isfinite(value[i])) all[used++] = value[i];
  if (all && used) gsl_sort(all, 1, used);
  double grain = used ? 1e-9 * (all[used - 1] - all[0]) : 0; /* 0.1 + 0.2 equals 0.3 */
  for (size_t i = 0; i < used; i++)
    if (!kept || all[i] - all[kept - 1] > grain) all[kept++] = all[i];
  *count = kept;
  return all;
}

/* Index of the nearest of (count) ascending positions. */
static size_t nearest_index(const double *at, size_t count, double value) {
  assert(count > 0);
  size_t low = 0, high = count - 1;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (0.5 * (at[middle] + at[middle + 1]) < value) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

static bool is_doubtful(const char *text) {
  static const char *const none[] = {"", "0", "false", "no", "nan", "null"};
  for (size_t i = 0; i < sizeof none / sizeof *none; i++)
    if (strcmp(text, none[i]) == 0) return false;
  return true;
}

/* Values of the cells; arrays (rows, columns). */
typedef struct cells {
  int *category;
  double *value;
  bool *doubtful;
} cells;

static void fill_cells(const mapper *m, size_t panel, cells *c) {
  const strut_table_map_figure *f = m->figure;
  const strut_table_column *columns = m->table->columns;
  for (size_t k = 0; k < m->rows * m->columns; k++) {
    c->value[k] = (double)NAN;
    c->category[k] = -1;
  }
  for (size_t i = 0; i < m->table->row_count; i++) {
    double x = columns[f->x].value[i], y = columns[f->y].value[i];
    if (!isfinite(x) || !isfinite(y)) continue;
    if (!strut_table_belongs(m->table, f->panels, m->panels.name[panel], i)) continue;
    size_t k = nearest_index(m->ys, m->rows, y) * m->columns + nearest_index(m->xs, m->columns, x);
    if (columns[f->value].value) c->value[k] = columns[f->value].value[i];
    for (size_t g = 0; !columns[f->value].value && g < m->names.count; g++)
      if (strcmp(m->names.name[g], columns[f->value].text[i]) == 0) c->category[k] = (int)g;
    if (f->doubt != STRUT_NO_COLUMN) c->doubtful[k] = is_doubtful(columns[f->doubt].text[i]);
  }
}

static strut_status draw_panel(void *context, strut_canvas *canvas, strut_box box, size_t panel) {
  mapper *m = context;
  const strut_table_map_figure *f = m->figure;
  const strut_table_column *x = &m->table->columns[f->x], *y = &m->table->columns[f->y];
  const strut_table_column *value = &m->table->columns[f->value];
  size_t count = m->rows * m->columns;
  cells c = {.category = strut_arena_allocate(&m->arena, count, sizeof(int)),
             .value = strut_arena_allocate(&m->arena, count, sizeof(double)),
             .doubtful = strut_arena_allocate(&m->arena, count, sizeof(bool))};
  char title[300];
  if (!c.category || !c.value || !c.doubtful) return STRUT_NO_MEMORY;
  fill_cells(m, panel, &c);
  strut_table_panel_title(m->table, f->panels, m->panels.name[panel], panel, title);
  const strut_map map = {
      .title = title[0] ? title : NULL,
      .x = strut_table_axis_of(&f->x_axis, x->name, x->unit, false),
      .y = strut_table_axis_of(&f->y_axis, y->name, y->unit, false),
      .columns = m->columns,
      .rows = m->rows,
      .xs = m->xs,
      .ys = m->ys,
      .category = value->value ? NULL : c.category,
      .category_count = value->value ? 0 : m->names.count,
      .names = m->names.name,
      .value = value->value ? c.value : NULL,
      .value_low = m->low,
      .value_high = m->high,
      .beyond = m->beyond,
      .value_name = value->name,
      .value_unit = value->unit,
      .colours = f->colours,
      .doubtful = f->doubt == STRUT_NO_COLUMN ? NULL : c.doubtful,
      .doubt = f->doubt == STRUT_NO_COLUMN ? NULL : m->table->columns[f->doubt].name};
  return strut_draw_map(canvas, box, &map);
}

/* Finds the colour range, which all panels share. False: out of memory. */
static bool find_range(mapper *m) {
  const double *value = m->table->columns[m->figure->value].value;
  size_t count = m->table->row_count, known = 0;
  double *sorted = value ? strut_arena_copy(&m->arena, value, count, sizeof *value) : NULL;
  if (value && !sorted) return false;
  for (size_t i = 0; value && i < count; i++) {
    if (!isfinite(value[i])) continue;
    m->low = known ? fmin(m->low, value[i]) : value[i];
    m->high = known ? fmax(m->high, value[i]) : value[i];
    known++;
  }
  if (known) strut_range_without_outliers(sorted, count, &m->low, &m->high, &m->beyond);
  return true;
}

static int by_text(const void *a, const void *b) {
  return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Finds the grid's positions and the categories. */
static strut_status prepare_grid(mapper *m, strut_error *error) {
  const strut_table_map_figure *f = m->figure;
  strut_status status = strut_table_numbers(m->table, f->x, error);
  if (status == STRUT_OK) status = strut_table_numbers(m->table, f->y, error);
  if (status == STRUT_OK)
    status = strut_table_groups_find(m->table, f->panels, STRUT_MOST_PANELS, "panels", &m->panels,
                                     error);
  if (status == STRUT_OK && !m->table->columns[f->value].value)
    status = strut_table_groups_find(m->table, f->value, STRUT_MOST_TABLE_GROUPS, "categories",
                                     &m->names, error);
  if (status != STRUT_OK) return status;
  qsort(m->names.name, m->names.count, sizeof *m->names.name, by_text);
  if (m->names.count && !*m->names.name[0]) { /* an empty text is no category */
    m->names.count--;
    memmove(m->names.name, m->names.name + 1, m->names.count * sizeof *m->names.name);
  }
  if (!find_range(m)) return strut_no_memory(error, "while drawing");
  m->xs = distinct_values(m, f->x, &m->columns);
  m->ys = distinct_values(m, f->y, &m->rows);
  if (!m->xs || !m->ys) return strut_no_memory(error, "while drawing");
  if (!m->columns || !m->rows || m->rows > MOST_CELLS / m->columns)
    return strut_fail(error, STRUT_USAGE,
                      "the map would have %zu by %zu cells: its x and y have to form a grid",
                      m->columns, m->rows);
  return STRUT_OK;
}

static strut_status draw_table(const char *path, const strut_table_map_figure *figure,
                               const strut_table *table, strut_error *error) {
  mapper m = {.figure = figure, .table = table};
  strut_status status = prepare_grid(&m, error);
  const strut_panel_page page = {.width = figure->width,
                                 .least_width = PANEL_WIDTH,
                                 .aspect = ASPECT,
                                 .panels = m.panels.count};
  if (status == STRUT_OK)
    status = strut_panel_page_draw(path, figure->title, &page, NULL, draw_panel, &m, error);
  strut_arena_free(&m.arena);
  return status;
}

strut_status strut_table_map(const char *path, const strut_table_map_figure *figure,
                             const strut_table *table, strut_error *error) {
  strut_table_chosen chosen = {0};
  strut_table_map_figure drawn = *figure;
  const strut_table_pairing pairing = {.keys = {figure->x, figure->y, figure->panels},
                                       .key_count = 3,
                                       .values = &figure->value,
                                       .value_count = 1};
  strut_status status = strut_table_choose(table, &figure->choice, pairing, &chosen, error);
  if (status == STRUT_OK && figure->choice.difference != STRUT_NO_COLUMN &&
      !table->columns[figure->value].value)
    drawn.doubt = (int)chosen.table->column_count - 1;
  if (status == STRUT_OK && figure->choice.difference != STRUT_NO_COLUMN &&
      drawn.colours == STRUT_COLOURS_AUTO)
    drawn.colours = STRUT_COLOURS_DIVERGING;
  if (status == STRUT_OK) status = draw_table(path, &drawn, chosen.table, error);
  strut_table_chosen_free(&chosen);
  return status;
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
static int compare_keys(const void *a, const void *b) {
  const keyed *one = a, *two = b;
  for (size_t i = 0; i < one->pairing->key_count; i++) {
    int column = one->pairing->keys[i];
    if (column == STRUT_NO_COLUMN) continue;
    const strut_table_column *c = &one->table->columns[column];
    int order;
    if (c->value) {
      double x = c->value[one->row], y = c->value[two->row];
      order = isnan(x) || isnan(y) ? isnan(y) - isnan(x) : (x > y) - (x < y);
    } else {
      order = strcmp(c->text[one->row], c->text[two->row]);
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

static strut_status find_sides(const strut_table *table, const strut_table_pairing *p, sides *s,
                               strut_arena *arena, strut_error *error) {
  const char *name = table->columns[p->of].name;
  strut_status status =
      strut_table_groups_find(table, p->of, 2, "sides to compare", &s->names, error);
  if (status) return status;
  if (s->names.count < 2)
    return strut_fail(error, STRUT_USAGE,
                      "column '%.60s' has only the text '%.60s', so there is nothing to compare",
                      name, s->names.name[0]);
  size_t *rows = rows_with(table, p->of, s->names.name[0], arena, &s->first_count);
  s->second = rows_with(table, p->of, s->names.name[1], arena, &s->second_count);
  s->first = strut_arena_allocate(arena, s->first_count, sizeof *s->first);
  if (!rows || !s->second || !s->first) return strut_no_memory(error, "while drawing");
  for (size_t i = 0; i < s->first_count; i++)
    s->first[i] = (keyed){.table = table, .pairing = p, .row = rows[i]};
  qsort(s->first, s->first_count, sizeof *s->first, compare_keys);
  return STRUT_OK;
}

/* The rows of the first side matching a row of the second. */
typedef struct partner {
  size_t row, next; /* SIZE_MAX: none */
  double weight;    /* of `next` */
} partner;

/* True if all keys but the last are equal. */
static bool alongside(const keyed *a, const keyed *b) {
  strut_table_pairing but_last = *a->pairing;
  but_last.key_count--;
  const keyed one = {.table = a->table, .pairing = &but_last, .row = a->row};
  const keyed two = {.table = b->table, .pairing = &but_last, .row = b->row};
  return compare_keys(&one, &two) == 0;
}

static partner find_partner(const sides *s, const keyed *wanted) {
  const strut_table_pairing *p = wanted->pairing;
  size_t low = 0, high = s->first_count;
  while (low < high) { /* the first not before `wanted` */
    size_t middle = (low + high) / 2;
    if (compare_keys(&s->first[middle], wanted) < 0) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  const keyed *after = s->first + low, *before = after - 1;
  if (low < s->first_count && compare_keys(after, wanted) == 0)
    return (partner){after->row, after->row, 0};
  if (!p->between || low == 0 || low == s->first_count || !alongside(before, wanted) ||
      !alongside(after, wanted))
    return (partner){SIZE_MAX, SIZE_MAX, 0};
  const double *x = wanted->table->columns[p->keys[p->key_count - 1]].value;
  return (partner){before->row, after->row,
                   (x[wanted->row] - x[before->row]) / (x[after->row] - x[before->row])};
}

/* Compares one column: numbers are subtracted, different texts marked. */
static bool compare_column(const strut_table *table, const sides *s, const partner *partners,
                           int column, strut_table *out, const char **mark) {
  strut_table_column *to = &out->columns[column];
  const strut_table_column *from = &table->columns[column];
  for (size_t k = 0; !from->value && k < s->second_count; k++)
    if (partners[k].row == SIZE_MAX || strcmp(from->text[partners[k].row], to->text[k]) != 0)
      mark[k] = "1";
  if (!from->value) return true;
  double *value = strut_arena_allocate(&out->arena, s->second_count, sizeof *value);
  to->name = strut_arena_format(&out->arena, "%s, %s less %s", from->name, s->names.name[1],
                                s->names.name[0]);
  if (!value || !to->name) return false;
  for (size_t k = 0; k < s->second_count; k++) {
    const partner *p = &partners[k];
    value[k] = (double)NAN;
    if (p->row == SIZE_MAX) continue;
    value[k] = to->value[k] - from->value[p->row];
    if (p->weight > 0) value[k] -= p->weight * (from->value[p->next] - from->value[p->row]);
  }
  to->value = value;
  return true;
}

static strut_status subtract_sides(const strut_table *table, const strut_table_pairing *p,
                                   const sides *s, strut_table *out, strut_error *error) {
  partner *partners = strut_arena_allocate(&out->arena, s->second_count, sizeof *partners);
  const char **mark = strut_arena_allocate(&out->arena, s->second_count, sizeof *mark);
  const char *name = strut_arena_format(&out->arena, "%s: other", s->names.name[0]);
  if (!partners || !mark || !name) return strut_no_memory(error, "while drawing");
  for (size_t k = 0; k < s->second_count; k++) {
    const keyed wanted = {.table = table, .pairing = p, .row = s->second[k]};
    partners[k] = find_partner(s, &wanted);
    mark[k] = "0";
  }
  for (size_t i = 0; i < p->value_count; i++)
    if (!compare_column(table, s, partners, p->values[i], out, mark))
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
