/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/language/read/csv.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "parser/language/expression/expression.h"

enum { MOST_COLUMNS = 10000 };

/* A CSV text being read. */
typedef struct reader {
  const char *at, *end;
  uint32_t line, column; /* of `at`, 1-based */
  strut_diagnostics *diagnostics;
  strut_csv *csv;
  const char **cell;  /* all cells, row by row, the header first; of strut_allocate */
  strut_place *place; /* likewise */
  size_t cell_count, cell_capacity;
  bool failed; /* memory was out */
} reader;

static void step(reader *r) {
  unsigned char c = (unsigned char)*r->at++;
  if (!c) /* texts end there */
    strut_diagnose(r->diagnostics, strut_place_at(r->line, r->column, 1),
                   "a NUL byte is not allowed; the file is damaged, or no text");
  if (c == '\n') {
    r->line++;
    r->column = 1;
  } else if ((c & 0xC0) != 0x80) {
    r->column++;
  }
}

static void keep(reader *r, const char *cell, strut_place place) {
  size_t places = r->cell_capacity;
  r->failed = r->failed || !cell ||
              !strut_grow(&r->place, &places, r->cell_count, sizeof *r->place) ||
              !strut_grow(&r->cell, &r->cell_capacity, r->cell_count, sizeof *r->cell);
  if (r->failed) return;
  r->place[r->cell_count] = place;
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
    if (!pass) copy = strut_arena_allocate(&r->csv->arena, length + 1, 1);
    if (!copy) break;
  }
  keep(r, copy, begin);
  for (;;) {
    if (r->at >= r->end) {
      strut_diagnose(r->diagnostics, begin, "unterminated quoted cell");
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
    strut_diagnose(r->diagnostics, strut_place_at(r->line, r->column, 1),
                   "expected a comma or the end of the line after a quoted cell");
  while (r->at < r->end && *r->at != ',' && *r->at != '\n') step(r);
}

static void read_plain(reader *r) {
  const char *from = r->at;
  strut_place place = strut_place_at(r->line, r->column, 0);
  while (r->at < r->end && *r->at != ',' && *r->at != '\n') step(r);
  size_t length = (size_t)(r->at - from);
  if (length && from[length - 1] == '\r') length--;
  place.length = strut_place_at(0, 0, length ? (uint32_t)length : 1).length;
  keep(r, strut_arena_text(&r->csv->arena, from, length), place);
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
    strut_diagnose(r->diagnostics, strut_place_at(1, 1, 1), "more than %d columns", MOST_COLUMNS);
  r->csv->column_count = columns;
  while (r->at < r->end && !r->failed) {
    uint32_t line = r->line;
    size_t before = r->cell_count, count = read_line(r);
    if (count == 1 && r->cell[before] && !*r->cell[before] && columns > 1) {
      r->cell_count = before; /* skip an empty line */
      continue;
    }
    if (count != columns && !r->failed)
      strut_diagnose(r->diagnostics, strut_place_at(line, 1, 1),
                     "%zu cells, expected %zu as in the header", count, columns);
    r->csv->row_count++;
  }
}

/* "name [unit]" in two. */
static bool split_title(reader *r, size_t i) {
  strut_csv_title *column = &r->csv->titles[i];
  const char *title = r->cell[i], *open = strrchr(title, '[');
  size_t length = strlen(title);
  bool has_unit = open && open > title && title[length - 1] == ']';
  size_t name = has_unit ? (size_t)(open - title) : length;
  while (name > 0 && title[name - 1] == ' ') name--;
  column->name = strut_arena_text(&r->csv->arena, title, name);
  column->unit = has_unit ? strut_arena_text(&r->csv->arena, open + 1,
                                             (size_t)(title + length - 1 - (open + 1)))
                          : "";
  return column->name && column->unit;
}

bool strut_csv_number(const char *text, double *value) {
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

/* Hands the cells over to the table. */
static bool finish(reader *r) {
  strut_csv *csv = r->csv;
  csv->titles = strut_arena_allocate(&csv->arena, csv->column_count, sizeof *csv->titles);
  csv->cell = strut_arena_allocate(&csv->arena, r->cell_count, sizeof *csv->cell);
  csv->place = strut_arena_allocate(&csv->arena, r->cell_count, sizeof *csv->place);
  if (!csv->titles || !csv->cell || !csv->place) return false;
  memcpy(csv->cell, r->cell, r->cell_count * sizeof *csv->cell);
  memcpy(csv->place, r->place, r->cell_count * sizeof *csv->place);
  for (size_t i = 0; i < csv->column_count; i++)
    if (!split_title(r, i)) return false;
  return true;
}

strut_status strut_csv_read(const char *text, size_t length, strut_diagnostics *diagnostics,
                            strut_csv *csv) {
  reader r = {.at = text,
              .end = text + length,
              .line = 1,
              .column = 1,
              .diagnostics = diagnostics,
              .csv = csv};
  *csv = (strut_csv){0};
  if (length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0) r.at += 3; /* a byte order mark */
  if (r.at == r.end)
    strut_diagnose(diagnostics, strut_place_at(1, 1, 1), "the file is empty, expected a table");
  else
    read_lines(&r);
  if (!r.failed && !diagnostics->count && !csv->row_count)
    strut_diagnose(diagnostics, strut_place_at(1, 1, 1), "the table has a header but no rows");
  if (!r.failed && !diagnostics->count && !finish(&r)) r.failed = true;
  strut_release(r.cell);
  strut_release(r.place);
  if (r.failed || diagnostics->out_of_memory) return STRUT_NO_MEMORY;
  return diagnostics->count ? STRUT_BAD_SCENE : STRUT_OK;
}
