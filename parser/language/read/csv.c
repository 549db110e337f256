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

static void step(reader *self) {
  unsigned char c = (unsigned char)*self->at++;
  if (!c) /* texts end there */
    strut_diagnose(self->diagnostics, strut_place_at(self->line, self->column, 1),
                   "a NUL byte is not allowed; the file is damaged, or no text");
  if (c == '\n') {
    self->line++;
    self->column = 1;
  } else if ((c & 0xC0) != 0x80) {
    self->column++;
  }
}

static void keep(reader *self, const char *cell, strut_place place) {
  size_t places = self->cell_capacity;
  self->failed =
      self->failed || !cell ||
      !strut_grow(&self->place, &places, self->cell_count, sizeof *self->place) ||
      !strut_grow(&self->cell, &self->cell_capacity, self->cell_count, sizeof *self->cell);
  if (self->failed) return;
  self->place[self->cell_count] = place;
  self->cell[self->cell_count++] = cell;
}

/* A cell in quotes, which are doubled inside. */
static void read_quoted(reader *self) {
  strut_place begin = strut_place_at(self->line, self->column, 1);
  step(self);
  const char *from = self->at;
  char *copy = NULL;
  size_t length = 0;
  for (int pass = 0; pass < 2; pass++) { /* measure, then copy */
    const char *c = from;
    size_t used = 0;
    for (; c < self->end; c++) {
      if (*c == '"') {
        if (c + 1 < self->end && c[1] == '"') {
          c++;
        } else {
          break;
        }
      }
      if (copy) copy[used] = *c;
      used++;
    }
    length = used;
    if (!pass) copy = strut_arena_allocate(&self->csv->arena, length + 1, 1);
    if (!copy) break;
  }
  keep(self, copy, begin);
  for (;;) {
    if (self->at >= self->end) {
      strut_diagnose(self->diagnostics, begin, "unterminated quoted cell");
      return;
    }
    bool quote = *self->at == '"';
    step(self);
    if (!quote) continue;
    if (self->at < self->end && *self->at == '"') {
      step(self);
      continue;
    }
    break;
  }
  if (self->at < self->end && *self->at != ',' && *self->at != '\n' && *self->at != '\r')
    strut_diagnose(self->diagnostics, strut_place_at(self->line, self->column, 1),
                   "expected a comma or the end of the line after a quoted cell");
  while (self->at < self->end && *self->at != ',' && *self->at != '\n') step(self);
}

static void read_plain(reader *self) {
  const char *from = self->at;
  strut_place place = strut_place_at(self->line, self->column, 0);
  while (self->at < self->end && *self->at != ',' && *self->at != '\n') step(self);
  size_t length = (size_t)(self->at - from);
  if (length && from[length - 1] == '\r') length--;
  place.length = strut_place_at(0, 0, length ? (uint32_t)length : 1).length;
  keep(self, strut_arena_text(&self->csv->arena, from, length), place);
}

/* Reads one line; how many cells it has. */
static size_t read_line(reader *self) {
  size_t before = self->cell_count;
  for (;;) {
    if (self->at < self->end && *self->at == '"') {
      read_quoted(self);
    } else {
      read_plain(self);
    }
    if (self->failed || self->at >= self->end || *self->at == '\n') break;
    step(self); /* the comma */
  }
  if (self->at < self->end) step(self);
  return self->cell_count - before;
}

static void read_lines(reader *self) {
  size_t columns = read_line(self);
  if (columns > MOST_COLUMNS)
    strut_diagnose(self->diagnostics, strut_place_at(1, 1, 1), "more than %d columns",
                   MOST_COLUMNS);
  self->csv->column_count = columns;
  while (self->at < self->end && !self->failed) {
    uint32_t line = self->line;
    size_t before = self->cell_count, count = read_line(self);
    if (count == 1 && self->cell[before] && !*self->cell[before] && columns > 1) {
      self->cell_count = before; /* skip an empty line */
      continue;
    }
    if (count != columns && !self->failed)
      strut_diagnose(self->diagnostics, strut_place_at(line, 1, 1),
                     "%zu cells, expected %zu as in the header", count, columns);
    self->csv->row_count++;
  }
}

/* "name [unit]" in two. */
static bool split_title(reader *self, size_t i) {
  strut_csv_title *column = &self->csv->titles[i];
  const char *title = self->cell[i], *open = strrchr(title, '[');
  size_t length = strlen(title);
  bool has_unit = open && open > title && title[length - 1] == ']';
  size_t name = has_unit ? (size_t)(open - title) : length;
  while (name > 0 && title[name - 1] == ' ') name--;
  column->name = strut_arena_text(&self->csv->arena, title, name);
  column->unit = has_unit ? strut_arena_text(&self->csv->arena, open + 1,
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
static bool finish(reader *self) {
  strut_csv *csv = self->csv;
  csv->titles = strut_arena_allocate(&csv->arena, csv->column_count, sizeof *csv->titles);
  csv->cell = strut_arena_allocate(&csv->arena, self->cell_count, sizeof *csv->cell);
  csv->place = strut_arena_allocate(&csv->arena, self->cell_count, sizeof *csv->place);
  if (!csv->titles || !csv->cell || !csv->place) return false;
  memcpy(csv->cell, self->cell, self->cell_count * sizeof *csv->cell);
  memcpy(csv->place, self->place, self->cell_count * sizeof *csv->place);
  for (size_t i = 0; i < csv->column_count; i++)
    if (!split_title(self, i)) return false;
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
