/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/command/table_file.h"

#include <math.h>
#include <string.h>

#include "engine/base/memory.h"
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
