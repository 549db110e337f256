/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/table_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "parser/cli/streams.h"
#include "parser/expression/expression.h"
#include "parser/read/read_scene.h"
#include "parser/yaml/diagnostics.h"

enum { MOST_MESSAGES = 20, MOST_COLUMNS = 10000 };

/* A CSV text being read. */
typedef struct reader {
  const char *at, *end;
  uint32_t line, column; /* of `at`, 1-based */
  strut_diagnostics diagnostics;
  strut_table *table;
  const char **cell; /* all cells, row by row, the header first */
  size_t cell_count, cell_capacity;
  bool failed; /* memory was out */
} reader;

static void step(reader *r) {
  unsigned char c = (unsigned char)*r->at++;
  if (c == '\n') {
    r->line++;
    r->column = 1;
  } else if ((c & 0xC0) != 0x80) {
    r->column++;
  }
}

static void keep(reader *r, const char *cell) {
  if (r->cell_count == r->cell_capacity) {
    size_t capacity = 2 * r->cell_capacity + 1024;
    const char **more = strut_reallocate(r->cell, capacity, sizeof *more);
    r->failed = r->failed || !more;
    if (!more) return;
    r->cell = more;
    r->cell_capacity = capacity;
  }
  r->failed = r->failed || !cell;
  r->cell[r->cell_count++] = cell;
}

/* A cell in quotes, which are doubled inside. */
static void read_quoted(reader *r) {
  strut_place begin = strut_place_at(r->line, r->column, 1);
  step(r);
  const char *from = r->at;
  char *copy = NULL;
  size_t length = 0;
  for (int pass = 0; pass < 2; pass++) { /* measure, then copy */
    const char *c = from;
    size_t used = 0;
    for (; c < r->end; c++) {
      if (*c == '"') {
        if (c + 1 < r->end && c[1] == '"') {
          c++;
        } else {
          break;
        }
      }
      if (copy) copy[used] = *c;
      used++;
    }
    length = used;
    if (!pass) copy = strut_arena_allocate(&r->table->arena, length + 1, 1);
    if (!copy) break;
  }
  keep(r, copy);
  for (;;) {
    if (r->at >= r->end) {
      strut_diagnose(&r->diagnostics, begin, "unterminated quoted cell");
      return;
    }
    bool quote = *r->at == '"';
    step(r);
    if (!quote) continue;
    if (r->at < r->end && *r->at == '"') {
      step(r);
      continue;
    }
    break;
  }
  if (r->at < r->end && *r->at != ',' && *r->at != '\n' && *r->at != '\r')
    strut_diagnose(&r->diagnostics, strut_place_at(r->line, r->column, 1),
                   "expected a comma or the end of the line after a quoted cell");
  while (r->at < r->end && *r->at != ',' && *r->at != '\n') step(r);
}

static void read_plain(reader *r) {
  const char *from = r->at;
  while (r->at < r->end && *r->at != ',' && *r->at != '\n') step(r);
  size_t length = (size_t)(r->at - from);
  if (length && from[length - 1] == '\r') length--;
  keep(r, strut_arena_text(&r->table->arena, from, length));
}

/* Reads one line; how many cells it has. */
static size_t read_line(reader *r) {
  size_t before = r->cell_count;
  for (;;) {
    if (r->at < r->end && *r->at == '"') {
      read_quoted(r);
    } else {
      read_plain(r);
    }
    if (r->failed || r->at >= r->end || *r->at == '\n') break;
    step(r); /* the comma */
  }
  if (r->at < r->end) step(r);
  return r->cell_count - before;
}

static void read_lines(reader *r) {
  size_t columns = read_line(r);
  if (columns > MOST_COLUMNS)
    strut_diagnose(&r->diagnostics, strut_place_at(1, 1, 1), "more than %d columns", MOST_COLUMNS);
  r->table->column_count = columns;
  while (r->at < r->end && !r->failed) {
    uint32_t line = r->line;
    size_t before = r->cell_count, count = read_line(r);
    if (count == 1 && r->cell[before] && !*r->cell[before] && columns > 1) {
      r->cell_count = before; /* skip an empty line */
      continue;
    }
    if (count != columns && !r->failed)
      strut_diagnose(&r->diagnostics, strut_place_at(line, 1, 1),
                     "%zu cells, expected %zu as in the header", count, columns);
    r->table->row_count++;
  }
}

/* "name [unit]" in two. */
static bool name_column(reader *r, size_t i) {
  strut_table_column *column = &r->table->columns[i];
  const char *title = r->cell[i], *open = strrchr(title, '[');
  size_t length = strlen(title);
  bool has_unit = open && open > title && title[length - 1] == ']';
  size_t name = has_unit ? (size_t)(open - title) : length;
  while (name > 0 && title[name - 1] == ' ') name--;
  column->name = strut_arena_text(&r->table->arena, title, name);
  column->unit = has_unit ? strut_arena_text(&r->table->arena, open + 1,
                                             (size_t)(title + length - 1 - (open + 1)))
                          : "";
  return column->name && column->unit;
}

/* A number, or NAN for an empty cell. */
static bool read_number(const char *text, double *value) {
  static const char *const nothing[] = {"", "nan", "NaN", "null", "none", "-"};
  for (size_t i = 0; i < sizeof nothing / sizeof *nothing; i++)
    if (strcmp(text, nothing[i]) == 0) {
      *value = (double)NAN;
      return true;
    }
  bool minus = *text == '-';
  const char *digits = text + (minus || *text == '+');
  if (strcmp(digits, "inf") == 0) {
    *value = minus ? -HUGE_VAL : HUGE_VAL;
    return true;
  }
  if (!strut_number_read_scaled(digits, strlen(digits), 0, value)) return false;
  if (minus) *value = -*value;
  return true;
}

static bool fill_column(reader *r, size_t i) {
  strut_table *t = r->table;
  const char **text = strut_arena_allocate(&t->arena, t->row_count, sizeof *text);
  double *value = strut_arena_allocate(&t->arena, t->row_count, sizeof *value);
  bool numbers = true, some = false;
  if (!text || !value) return false;
  for (size_t k = 0; k < t->row_count; k++) {
    text[k] = r->cell[(k + 1) * t->column_count + i];
    numbers = numbers && read_number(text[k], &value[k]);
    some = some || (numbers && !isnan(value[k]));
  }
  t->columns[i].text = text;
  t->columns[i].value = numbers && some ? value : NULL;
  return name_column(r, i);
}

static bool make_columns(reader *r) {
  strut_table *t = r->table;
  t->columns = strut_arena_allocate(&t->arena, t->column_count, sizeof *t->columns);
  bool good = t->columns;
  for (size_t i = 0; i < t->column_count && good; i++) good = fill_column(r, i);
  return good;
}

static strut_status read_text(reader *r) {
  if (r->end - r->at >= 3 && memcmp(r->at, "\xEF\xBB\xBF", 3) == 0)
    r->at += 3; /* a byte order mark */
  if (r->at == r->end) {
    strut_diagnose(&r->diagnostics, (strut_place){0}, "the file is empty, expected a table");
  } else {
    read_lines(r);
  }
  if (!r->failed && !r->diagnostics.count && !r->table->row_count)
    strut_diagnose(&r->diagnostics, (strut_place){0}, "the table has a header but no rows");
  if (!r->failed && !r->diagnostics.count && !make_columns(r)) r->failed = true;
  if (r->failed) return strut_print_out_of_memory();
  if (!r->diagnostics.count) return STRUT_OK;
  const char *messages = strut_diagnostics_render(&r->diagnostics, MOST_MESSAGES);
  if (!messages) return strut_print_out_of_memory();
  fputs(messages, stderr);
  return STRUT_BAD_SCENE;
}

strut_status strut_table_read(const char *path, strut_table *table) {
  char *text;
  size_t length;
  strut_error error = {0};
  *table = (strut_table){0};
  strut_status status = strut_file_read(path, &text, &length, &error);
  if (status != STRUT_OK) {
    strut_print_error(&error);
    return status;
  }
  reader r = {.at = text, .end = text + length, .line = 1, .column = 1, .table = table};
  strut_diagnostics_source(&r.diagnostics, strcmp(path, "-") == 0 ? "<stdin>" : path, text, length);
  status = read_text(&r);
  strut_diagnostics_free(&r.diagnostics);
  strut_release(r.cell);
  strut_release(text);
  if (status != STRUT_OK) strut_arena_free(&table->arena);
  return status;
}
