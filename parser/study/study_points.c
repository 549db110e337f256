/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An axis whose values stand in a file: one row a value of all its parameters. See study_reader.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "parser/read/csv.h"
#include "parser/study/study_reader.h"
#include "parser/yaml/text.h"

enum { MOST_ROWS = 1000000, MOST_WORD = 24 };

/* Columns of strut's own tables that say nothing about the model. */
static const char *const skipped[] = {"point", "status", "message"};

/* A file of points being read. */
typedef struct table {
  strut_study_reader *r;
  strut_study_points *points;
  const strut_tree *columns; /* the list of those to use, or NULL: all */
  strut_csv csv;
  strut_place place; /* of the file's name in the study */
} table;

static bool has_key(const strut_tree *map, const char *key) {
  return map->kind == STRUT_TREE_MAP && strut_tree_find(map, key, NULL);
}

/* The value of an item {NAME: value}, or NULL. */
static const strut_tree *only_value(const strut_tree *item, const char *name) {
  if (item->kind != STRUT_TREE_MAP || item->count != 1) return NULL;
  return strcmp(item->first->text, name) == 0 ? item->first->next : NULL;
}

bool strut_study_is_points(const strut_study_reader *r, const strut_tree *item) {
  const strut_tree *value = only_value(item, "points");
  if (!value) return false;
  return value->kind == STRUT_TREE_SCALAR || has_key(value, "file") ||
         !strut_study_declared(r, "points");
}

static strut_diagnostics *messages(table *t) { return &t->points->diagnostics; }

/* Is the column to be used? */
static bool is_wanted(const table *t, const char *name) {
  for (const strut_tree *item = t->columns ? t->columns->first : NULL; item; item = item->next)
    if (strcmp(item->text, name) == 0) return true;
  if (t->columns) return false;
  for (size_t i = 0; i < sizeof skipped / sizeof skipped[0]; i++)
    if (strcmp(skipped[i], name) == 0) return false;
  return true;
}

/* Reports wanted columns that the file does not have. */
static void check_columns(table *t) {
  for (const strut_tree *item = t->columns ? t->columns->first : NULL; item; item = item->next) {
    bool found = false;
    for (size_t i = 0; i < t->csv.column_count; i++)
      found = found || strcmp(t->csv.titles[i].name, item->text) == 0;
    if (!found)
      strut_report_error(t->r->reader, item->place, "'%s' has no column '%s'",
                         strut_sanitised_text(t->r->reader, t->points->node->text),
                         strut_sanitised_text(t->r->reader, item->text));
  }
}

/* The parameter that a column gives; NULL where that was reported. */
static const strut_declared *parameter_of(table *t, size_t i) {
  strut_reader *reader = t->r->reader;
  const char *name = t->csv.titles[i].name;
  const strut_declared *found = strut_study_declared(t->r, name);
  if (!found) {
    strut_diagnose(messages(t), t->csv.place[i], "the model has no parameter '%s'%s%s",
                   strut_sanitised_text(reader, name),
                   strut_hint(reader, name, strut_study_declared_name, t->r, t->r->declared_count),
                   t->columns ? "" : "; {points: {file: ..., columns: [...]}} chooses columns");
    return NULL;
  }
  if (strut_name_map_find(&t->r->given, found->name) >= 0) {
    strut_diagnose(messages(t), t->csv.place[i], "parameter '%s' is given twice", found->name);
    return NULL;
  }
  strut_add_name(reader, &t->r->given, found->name, (size_t)(found - t->r->declared));
  return found;
}

/* A plain number with the column's unit; the whole text is read as one, so that 0.1 mm has its bits. */
static bool read_number(const char *text, const char *unit, strut_quantity *q) {
  char whole[200];
  double plain;
  strut_expression_error error;
  if (!strut_csv_number(text, &plain) || !isfinite(plain)) return false;
  int n = snprintf(whole, sizeof whole, "%s %s", *text == '+' ? text + 1 : text, unit);
  return n > 0 && (size_t)n < sizeof whole && strut_expression_evaluate(whole, NULL, q, &error);
}

/* The unit of a column: "" for none. False where that was reported. */
static bool check_unit(table *t, size_t i, const strut_study_along *a, const char **unit) {
  char expected[200];
  strut_quantity q;
  strut_setting *s = a->setting;
  const char *title = t->csv.titles[i].unit;
  *unit = strcmp(title, "1") == 0 ? "" : title;
  if (!**unit) return true;
  bool known = !a->parameter->text && read_number("1", *unit, &q);
  if (known && s->bare && !q.bare) {
    s->bare = false;
    s->dimension = q.dimension;
  }
  if (known && !q.bare && strut_dimension_equal(q.dimension, s->dimension)) return true;
  strut_diagnose(messages(t), t->csv.place[i], "expected %s in column '%s', found the unit '%s'",
                 a->parameter->text ? "texts"
                 : s->bare          ? "a unit"
                           : strut_expected_number(s->dimension, expected, sizeof expected),
                 a->parameter->name, strut_sanitised_text(t->r->reader, title));
  return false;
}

/* Is it a text that a scene may have? */
static bool is_text(const char *text) {
  for (size_t left = strlen(text); left > 0;) {
    uint32_t code;
    size_t bytes = strut_text_decode(text, left, &code);
    if (code == STRUT_BAD_CODE || code < ' ' || strut_text_forbidden(code)) return false;
    text += bytes;
    left -= bytes;
  }
  return true;
}

static void refuse_cell(table *t, size_t cell, const strut_study_along *a) {
  const char *text = t->csv.cell[cell];
  const char *expected = a->parameter->text ? "a text of 1 to 23 bytes" : "a number";
  if (!*text)
    strut_diagnose(messages(t), t->csv.place[cell], "expected %s for '%s', found an empty cell",
                   expected, a->parameter->name);
  else
    strut_diagnose(messages(t), t->csv.place[cell], "expected %s for '%s', found '%s'", expected,
                   a->parameter->name, strut_sanitised_text(t->r->reader, text));
}

/* The cells of column i. */
static void read_cells(table *t, size_t i, const strut_study_along *a, const char *unit) {
  strut_arena *arena = &t->r->file->arena;
  size_t rows = t->csv.row_count;
  bool text = a->parameter->text;
  double *numbers = text ? NULL : strut_reader_allocate(t->r->reader, arena, rows, sizeof *numbers);
  const char **words =
      text ? strut_reader_allocate(t->r->reader, arena, rows, sizeof *words) : NULL;
  if (!numbers && !words) return;
  for (size_t k = 0; k < rows && !strut_diagnostics_full(messages(t)); k++) {
    size_t cell = (k + 1) * t->csv.column_count + i, length = strlen(t->csv.cell[cell]);
    strut_quantity q = {.value = 0.0};
    bool fine = text ? length > 0 && length < MOST_WORD && is_text(t->csv.cell[cell])
                     : read_number(t->csv.cell[cell], unit, &q);
    if (!fine) {
      refuse_cell(t, cell, a);
    } else if (text) {
      words[k] = strut_arena_text(arena, t->csv.cell[cell], length);
      if (!words[k]) t->r->reader->out_of_memory = true;
    } else {
      numbers[k] = q.value;
    }
  }
  a->column->kind = STRUT_RANGE_LIST;
  a->column->number = numbers;
  a->column->words = words;
}

static void read_column(table *t, size_t i, strut_study_axis *axis) {
  strut_study_along a = {.parameter = parameter_of(t, i)};
  const char *unit = "";
  if (!a.parameter) return;
  a.column = &axis->columns[axis->column_count++];
  a.setting = &t->r->file->columns[t->r->file->column_count++];
  a.column->unit = "1";
  if (!strut_study_begin_along(t->r, &a, t->place) || !check_unit(t, i, &a, &unit)) return;
  read_cells(t, i, &a, unit);
  a.column->unit =
      a.setting->bare || a.parameter->text ? "1" : strut_dimension_unit(a.setting->dimension);
}

static void read_columns(table *t, strut_study_axis *axis) {
  strut_study_reader *r = t->r;
  check_columns(t);
  if (t->csv.row_count > MOST_ROWS) {
    strut_report_error(r->reader, t->place, "'%s' has %zu rows, a file of points may have 1e6",
                       strut_sanitised_text(r->reader, t->points->node->text), t->csv.row_count);
    return;
  }
  axis->columns = strut_reader_allocate(r->reader, &r->file->arena, r->declared_count + 1,
                                        sizeof *axis->columns);
  if (!axis->columns) return;
  axis->count = (int64_t)t->csv.row_count;
  for (size_t i = 0; i < t->csv.column_count; i++)
    if (is_wanted(t, t->csv.titles[i].name)) read_column(t, i, axis);
  if (axis->column_count == 0 && !messages(t)->count)
    strut_report_error(r->reader, t->place, "'%s' has no column of a parameter of the model",
                       strut_sanitised_text(r->reader, t->points->node->text));
}

static void read_file(table *t, const strut_tree *name, strut_study_axis *axis) {
  strut_study_reader *r = t->r;
  strut_error error = {0};
  char *root = strut_folder_of(r->file->path, &r->file->arena);
  t->points = &r->file->tables[r->file->table_count];
  t->points->node = name;
  t->points->copy = strut_arena_format(&r->file->arena, "points-%zu.csv", r->file->table_count + 1);
  if (!root || !t->points->copy) {
    r->reader->out_of_memory = true;
    return;
  }
  strut_status status =
      strut_safe_read(root, r->file->path, name->text, STRUT_TEXT_MOST, &t->points->file, &error);
  if (status) {
    if (status == STRUT_NO_MEMORY) r->reader->out_of_memory = true;
    strut_report_error(r->reader, name->place, "%s", error.message);
    return;
  }
  r->file->table_count++;
  strut_diagnostics_source(messages(t), t->points->file.path, t->points->file.text,
                           t->points->file.length);
  status = strut_csv_read(t->points->file.text, t->points->file.length, messages(t), &t->csv);
  if (status == STRUT_OK) read_columns(t, axis);
  if (status == STRUT_NO_MEMORY || messages(t)->out_of_memory) r->reader->out_of_memory = true;
  if (messages(t)->count) r->reader->failed = true;
  strut_arena_free(&t->csv.arena);
}

void strut_study_read_points(strut_study_reader *r, const strut_tree *value,
                             strut_study_axis *axis) {
  const strut_owner owner = {"the file of points", NULL};
  const strut_tree *name = value;
  table t = {.r = r};
  if (value->kind == STRUT_TREE_MAP) {
    strut_fields fields;
    strut_read_fields(r->reader, STRUT_SECTION_POINTS, value, owner, &fields);
    if (!fields.broken) strut_require(r->reader, &fields, owner, value->place);
    if (fields.broken) return;
    const strut_slot *columns = strut_slot_of(&fields, STRUT_KEY_POINTS_COLUMNS);
    name = strut_slot_of(&fields, STRUT_KEY_POINTS_FILE)->value;
    if (columns->state == STRUT_GIVEN) t.columns = columns->value;
    for (const strut_tree *item = t.columns ? t.columns->first : NULL; item; item = item->next)
      if (!strut_read_scalar(r->reader, item, "columns", owner, "a column's name")) return;
  }
  if (!strut_read_scalar(r->reader, name, "points", owner, "the path of a CSV file")) return;
  t.place = name->place;
  read_file(&t, name, axis);
}
