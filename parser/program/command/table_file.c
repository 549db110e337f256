/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/command/table_file.h"

#include <math.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/figures/table_figure.h"
#include "parser/language/read/csv.h"
#include "parser/language/read/read_scene.h"

enum { MOST_MESSAGES = 20 };

static bool fill_column(const strut_csv *csv, strut_table *table, size_t i) {
  const char **text = strut_arena_allocate(&table->arena, table->row_count, sizeof *text);
  double *value = strut_arena_allocate(&table->arena, table->row_count, sizeof *value);
  bool numbers = true, some = false;
  if (!text || !value) return false;
  for (size_t k = 0; k < table->row_count; k++) {
    text[k] = csv->cell[(k + 1) * table->column_count + i];
    numbers = numbers && strut_csv_number(text[k], 0, &value[k]);
    some = some || (numbers && !isnan(value[k]));
  }
  table->columns[i].name = csv->titles[i].name;
  table->columns[i].unit = csv->titles[i].unit;
  table->columns[i].text = text;
  table->columns[i].value = numbers && some ? value : NULL;
  return true;
}

/* The table takes over the cells. */
static bool make_columns(strut_csv *csv, strut_table *table) {
  table->arena = csv->arena;
  csv->arena = (strut_arena){0};
  table->column_count = csv->column_count;
  table->row_count = csv->row_count;
  table->columns = strut_arena_allocate(&table->arena, table->column_count, sizeof *table->columns);
  bool good = table->columns;
  for (size_t i = 0; i < table->column_count && good; i++) good = fill_column(csv, table, i);
  return good;
}

strut_status strut_table_read(const strut_listener *listener, const char *path,
                              strut_table *table) {
  char *text;
  size_t length;
  strut_error error = {0};
  strut_diagnostics diagnostics = {0};
  strut_csv csv;
  *table = (strut_table){0};
  strut_status status = strut_file_read(path, &text, &length, &error);
  if (status) return strut_tell_failure(listener, status, &error);
  strut_diagnostics_source(&diagnostics, strcmp(path, "-") == 0 ? "<stdin>" : path, text, length);
  status = strut_csv_read(text, length, STRUT_CSV_ANY_HEADER, &diagnostics, &csv);
  if (status == STRUT_OK && !make_columns(&csv, table)) status = STRUT_NO_MEMORY;
  if (status == STRUT_BAD_SCENE) {
    const char *messages = strut_diagnostics_render(&diagnostics, MOST_MESSAGES);
    if (strut_tell_lines(listener, messages)) status = STRUT_NO_MEMORY;
  } else {
    strut_tell_failure(listener, status, NULL);
  }
  strut_diagnostics_free(&diagnostics);
  strut_arena_free(&csv.arena);
  strut_release(text);
  if (status != STRUT_OK) strut_arena_free(&table->arena);
  return status;
}

/* Adds a column with the same text in each row. */
static bool add_column(strut_table *table, const char *name, const char *word) {
  size_t count = table->column_count;
  strut_table_column *columns = strut_arena_allocate(&table->arena, count + 1, sizeof *columns);
  const char **text = strut_arena_allocate(&table->arena, table->row_count + 1, sizeof *text);
  if (!columns || !text) return false;
  for (size_t i = 0; i < table->row_count; i++) text[i] = word;
  memcpy(columns, table->columns, count * sizeof *columns);
  columns[count] = (strut_table_column){.name = name, .unit = "", .text = text};
  table->columns = columns;
  table->column_count++;
  return true;
}

/* Appends a column's cells to those of `to`. */
static bool append_cells(strut_table *table, strut_table_column *to, const strut_table *from,
                         const strut_table_column *cells) {
  size_t first = table->row_count, rows = first + from->row_count;
  const char **text = strut_arena_allocate(&table->arena, rows, sizeof *text);
  double *value = strut_arena_allocate(&table->arena, rows, sizeof *value);
  if (!text || !value) return false;
  memcpy(text, to->text, first * sizeof *text);
  for (size_t i = first; i < rows; i++) {
    const char *cell = cells->text[i - first];
    if (!(text[i] = strut_arena_text(&table->arena, cell, strlen(cell)))) return false;
  }
  bool numbers = to->value && cells->value;
  if (numbers) memcpy(value, to->value, first * sizeof *value);
  if (numbers) memcpy(value + first, cells->value, from->row_count * sizeof *value);
  to->text = text, to->value = numbers ? value : NULL;
  return true;
}

/* Appends the rows of a table with the same columns. */
static strut_status append_rows(strut_table *table, const strut_table *from, const char *path,
                                strut_error *error) {
  for (size_t c = 0; c < table->column_count; c++) {
    strut_table_column *to = &table->columns[c];
    int column = strut_table_column_of(from, to->name, strlen(to->name));
    if (column < 0 || strcmp(from->columns[column].unit, to->unit) != 0)
      return strut_fail(error, STRUT_USAGE,
                        "'%s' has no column '%s'%s%s, which the first table has", path, to->name,
                        *to->unit ? " in " : "", to->unit);
    if (!append_cells(table, to, from, &from->columns[column]))
      return strut_no_memory(error, "while reading a table");
  }
  table->row_count += from->row_count;
  return STRUT_OK;
}

strut_status strut_tables_read(const strut_listener *listener, const char *const *paths,
                               size_t count, strut_table *table) {
  strut_error error = {0};
  strut_status status = strut_table_read(listener, paths[0], table);
  for (size_t i = 0; i < count && count > 1 && !status; i++) {
    strut_table more = {0};
    const char *slash = strrchr(paths[i], '/');
    if (i) status = strut_table_read(listener, paths[i], &more);
    if (!status && !add_column(i ? &more : table, "table", slash ? slash + 1 : paths[i]))
      status = strut_no_memory(&error, "while reading a table");
    if (!status && i) status = append_rows(table, &more, paths[i], &error);
    strut_arena_free(&more.arena);
  }
  if (status && error.message[0]) strut_tell_failure(listener, status, &error);
  if (status) strut_arena_free(&table->arena);
  return status;
}
