/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/language/read/csv.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "parser/language/yaml/text.h"

enum {
  MOST_COLUMNS = 10000,
  MOST_ROWS = 5000000,
  MOST_MESSAGES = 20,
  SAMPLED_LINES = 30,
  PEEKED_LINES = 6
};

/* A CSV text being read: a copy, in which a NUL ends each cell. */
typedef struct reader {
  char *at, *end, separator;
  strut_diagnostics *diagnostics;
  size_t most_messages;
  strut_csv *csv;
  char **cell; /* of strut_allocate */
  size_t cell_count, cell_capacity;
  size_t *line; /* (line_count + 1) the first cell of each, of strut_allocate */
  size_t line_count, line_capacity;
  size_t names, units,
      rows;    /* lines: with the names; with their units, or SIZE_MAX; the first row */
  bool failed; /* memory was out */
} reader;

/* ---- places ---- */

static strut_place place_of(const char *text, const char *at, size_t length) {
  strut_cursor cursor = strut_cursor_begin(text, (size_t)(at - text));
  strut_cursor_to_offset(&cursor, cursor.length);
  return strut_place_at(cursor.line, cursor.column,
                        length ? (uint32_t)fmin((double)length, 1e6) : 1);
}

strut_place strut_csv_place(const strut_csv *csv, size_t cell) {
  const char *at = csv->text + (csv->cell[cell] - csv->copy);
  if (at > csv->text && at[-1] == '"') at--;
  return place_of(csv->text, at, strlen(csv->cell[cell]));
}

static void report(const reader *self, const char *at, const char *what) {
  const strut_csv *csv = self->csv;
  strut_diagnose(self->diagnostics, place_of(csv->text, csv->text + (at - csv->copy), 1), "%s",
                 what);
}

/* The place of a whole line. */
static strut_place line_place(const reader *self, size_t line) {
  const strut_csv *csv = self->csv;
  const char *at = csv->text + (self->cell[self->line[line]] - csv->copy);
  return strut_place_at(place_of(csv->text, at, 1).line, 1, 1);
}

/* ---- lines ---- */

/* Keeps a cell, with a point for the comma of 1,5 where commas do not separate. */
static void keep(reader *self, char *from, char *to) {
  if (!strut_grow(&self->cell, &self->cell_capacity, self->cell_count, sizeof *self->cell))
    self->failed = true;
  else
    self->cell[self->cell_count++] = from;
  char *comma = self->separator == ',' ? NULL : memchr(from, ',', (size_t)(to - from));
  size_t digits = comma ? strspn(from, "+-0123456789eE,") : 0;
  if (comma && from + digits == to && !memchr(comma + 1, ',', (size_t)(to - comma - 1)))
    *comma = '.';
}

/* Reads one line. In quotes, quotes are doubled; other cells are without spaces around them. */
static void read_line(reader *self) {
  char *from = self->at, *to = from; /* begin of the cell; where its next character goes */
  enum { PLAIN, QUOTED, CLOSED, WRONG } state = PLAIN;
  for (bool last = false; !last && !self->failed; self->at += self->at < self->end) {
    char c = *self->at;
    bool over = self->at >= self->end, twice = c == '"' && self->at[1] == '"';
    last = over || (c == '\n' && state != QUOTED);
    if (state == QUOTED && !over) {
      if (c == '"' && !twice) state = CLOSED;
      if (state == QUOTED) *to++ = c, self->at += twice;
    } else if (last || c == self->separator) {
      if (state == QUOTED) report(self, from - 1, "unterminated quoted cell");
      if (state == PLAIN && to > from && to[-1] == '\r') to--;
      while (state == PLAIN && to > from && to[-1] == ' ') to--;
      while (state == PLAIN && from < to && *from == ' ') from++;
      *self->at = *to = '\0'; /* behind the text is one, too */
      keep(self, from, to);
      from = to = self->at + 1, state = PLAIN;
    } else if (c == '"' && self->at == from && state == PLAIN) {
      state = QUOTED, from = ++to;
    } else if (state == PLAIN) {
      to++;
    } else if (state == CLOSED && c != '\r') {
      report(self, self->at,
             self->separator == ',' ? "expected a comma or the end of the line after a quoted cell"
                                    : "expected the end of the cell after its quote");
      state = WRONG;
    }
  }
}

/*
 * Reads the lines of the header, and others that are no comments. Empty ones may be gaps of a single column, but not
 * where `header` lines, or some that may be one, are about to end.
 */
static void read_lines(reader *self, size_t header) {
  size_t most = MOST_ROWS + header + PEEKED_LINES, sure = header ? header + 1 : PEEKED_LINES;
  while (self->at < self->end && self->line_count <= most &&
         self->diagnostics->count < self->most_messages) {
    bool counts = *self->at != '#' || self->line_count < header;
    size_t first = self->cell_count;
    read_line(self);
    self->failed = self->failed || !strut_grow(&self->line, &self->line_capacity,
                                               self->line_count + 1, sizeof *self->line);
    if (self->failed) return;
    bool empty = self->cell_count == first + 1 && !*self->cell[first];
    if (empty && self->line_count >= header && self->line_count < sure) counts = false;
    self->line[self->line_count] = first;
    if (counts) self->line[++self->line_count] = self->cell_count;
    if (!counts) self->cell_count = first;
  }
}

/* The character that separates cells in most of the first lines, behind those of the header above names. */
static char find_separator(const reader *self, size_t header) {
  static const char all[] = {'\t', ';', ','};
  size_t lines[sizeof all] = {0}, best = sizeof all - 1;
  const char *line = self->at;
  for (size_t i = 0; line < self->end && i < header + SAMPLED_LINES; i++) {
    const char *end = memchr(line, '\n', (size_t)(self->end - line));
    if (!end) end = self->end;
    for (size_t k = 0; k < sizeof all && *line != '#' && i + 1 >= header; k++) {
      bool quoted = false, found = false;
      for (const char *c = line; c < end && !found; c++) {
        quoted = quoted != (*c == '"');
        found = *c == all[k] && !quoted;
      }
      lines[k] += found;
    }
    line = end + 1;
  }
  for (size_t k = sizeof all; k-- > 0;)
    if (lines[k] >= lines[best] && lines[k]) best = k;
  return all[best];
}

/* ---- the header ---- */

static size_t cells_in(const reader *self, size_t line) {
  return self->line[line + 1] - self->line[line];
}

static const char *head_cell(const reader *self, size_t line, size_t column) {
  return column < cells_in(self, line) ? self->cell[self->line[line] + column] : "";
}

static bool is_number(const char *text) {
  double value;
  return strut_csv_number(text, 0, &value) && !isnan(value);
}

static bool is_filled(const char *text) { return *text; }

static size_t count_cells(const reader *self, size_t line, bool (*is)(const char *text)) {
  size_t count = 0;
  for (size_t i = 0; i < cells_in(self, line); i++) count += is(head_cell(self, line, i));
  return count;
}

/* The text without brackets around it. */
static const char *unbracketed(reader *self, const char *text) {
  size_t length = strlen(text);
  bool within = length > 1 && ((*text == '[' && text[length - 1] == ']') ||
                               (*text == '(' && text[length - 1] == ')'));
  return within ? strut_arena_text(&self->csv->arena, text + 1, length - 2) : text;
}

/* Has the line units, and otherwise nothing? */
static bool is_of_units(reader *self, size_t line) {
  size_t units = 0;
  for (size_t i = 0; i < cells_in(self, line); i++) {
    const char *text = unbracketed(self, head_cell(self, line, i));
    strut_quantity q;
    if (!text) self->failed = true;
    if (!text || !*text || strut_csv_is_dimensionless(text)) continue;
    if (!strut_csv_unit(text, &q)) return false;
    units++;
  }
  return units > 0;
}

static bool is_deeplabcut(const reader *self) {
  return strcmp(head_cell(self, 0, 0), "scorer") == 0;
}

/*
 * How many lines a header has that does not say: one, and units below; or all above the first number, where the
 * first has less in it than the next, as Tracker's, or is DeepLabCut's.
 */
static size_t count_header(reader *self) {
  size_t count = 1, last = (self->line_count < PEEKED_LINES ? self->line_count : PEEKED_LINES) - 1;
  bool more = last > 1 && (count_cells(self, 0, is_filled) < count_cells(self, 1, is_filled) ||
                           is_deeplabcut(self));
  while (more && count < last && !count_cells(self, count, is_number)) count++;
  if (!more && last > 1 && !count_cells(self, 1, is_number) && count_cells(self, 2, is_number) &&
      is_of_units(self, 1))
    count++;
  return count <= last && count_cells(self, count, is_number) ? count : 1;
}

/* Finds the names, and where rows begin. False: that was reported. */
static bool find_header(reader *self, size_t header) {
  if (self->line_count < header || !self->line_count) {
    report(self, self->csv->copy,
           header ? "the file has fewer lines than its header should have"
                  : "the file is empty, expected a table");
    return false;
  }
  size_t last = self->rows = header ? header : count_header(self);
  while (last > 1 && count_cells(self, last - 1, is_filled) == 0) last--;
  self->units = last > 1 && is_of_units(self, last - 1) ? --last : SIZE_MAX;
  while (last > 1 && count_cells(self, last - 1, is_filled) == 0) last--;
  self->names = last - 1;
  return !self->failed;
}

/* ---- titles ---- */

/* "name [unit]" or "name (unit)" in two. */
static void split_title(reader *self, const char *title, strut_csv_title *column) {
  strut_arena *arena = &self->csv->arena;
  size_t length = strlen(title), name = length;
  bool round = length && title[length - 1] == ')';
  const char *open = strrchr(title, round ? '(' : '[');
  bool has_unit = open && open > title && (round ? open[-1] == ' ' : title[length - 1] == ']');
  if (has_unit) name = (size_t)(open - title);
  column->unit = has_unit ? strut_arena_text(arena, open + 1, length - name - 2) : "";
  while (name > 0 && title[name - 1] == ' ') name--;
  column->name = strut_arena_text(arena, title, name);
}

/* A name that is there twice, or is DeepLabCut's, belongs to what is above it: a cell counts until the next one. */
static const char *whole_name(reader *self, size_t i, const char *name) {
  size_t count = 0, at = i;
  for (size_t k = 0; k < cells_in(self, self->names); k++)
    count += strcmp(head_cell(self, self->names, k), head_cell(self, self->names, i)) == 0;
  if ((count < 2 && !(i > 0 && is_deeplabcut(self))) || !self->names) return name;
  while (at > 0 && !*head_cell(self, self->names - 1, at)) at--;
  const char *of = head_cell(self, self->names - 1, at);
  return *of ? strut_arena_format(&self->csv->arena, "%s.%s", of, name) : name;
}

/* The titles, from the cells of the header before rows take their place. */
static void make_titles(reader *self) {
  strut_csv *csv = self->csv;
  size_t count = cells_in(self, self->names);
  csv->titles = strut_arena_allocate(&csv->arena, count, sizeof *csv->titles);
  if (!csv->titles) self->failed = true;
  for (size_t i = 0; i < count && !self->failed; i++) {
    strut_csv_title *column = &csv->titles[i];
    const char *title = head_cell(self, self->names, i);
    split_title(self, title + (i == 0 ? strspn(title, "# ") : 0), column);
    if (column->name) column->name = whole_name(self, i, column->name);
    if (self->units != SIZE_MAX && column->unit && !*column->unit)
      column->unit = unbracketed(self, head_cell(self, self->units, i));
    if (!column->name || !column->unit) self->failed = true;
  }
}

/* ---- rows ---- */

/* Moves the cells of the names to the front, and those of rows behind them. */
static void take_rows(reader *self) {
  strut_csv *csv = self->csv;
  size_t columns = csv->column_count = cells_in(self, self->names),
         bytes = columns * sizeof(char *);
  if (columns > MOST_COLUMNS)
    strut_diagnose(self->diagnostics, line_place(self, self->names), "more than %d columns",
                   MOST_COLUMNS);
  memmove(self->cell, self->cell + self->line[self->names], bytes);
  for (size_t i = self->rows;
       i < self->line_count && self->diagnostics->count < self->most_messages; i++) {
    char **cell = self->cell + self->line[i];
    size_t count = cells_in(self, i);
    if (columns > 1 && count == 1 && !**cell) continue;
    while (count > columns && !*cell[count - 1]) count--;
    if (count != columns)
      strut_diagnose(self->diagnostics, line_place(self, i),
                     "%zu cells, expected %zu as in the header", count, columns);
    else if (csv->row_count < MOST_ROWS)
      memmove(self->cell + ++csv->row_count * columns, cell, bytes);
    else
      strut_diagnose(self->diagnostics, line_place(self, i), "more than %d rows", MOST_ROWS);
  }
}

strut_status strut_csv_read(const char *text, size_t length, int header,
                            strut_diagnostics *diagnostics, strut_csv *csv) {
  size_t before = diagnostics->count;
  reader r = {.diagnostics = diagnostics, .most_messages = before + MOST_MESSAGES, .csv = csv};
  const char *nul = memchr(text, '\0', length); /* it would end a cell */
  *csv = (strut_csv){.text = text};
  csv->copy = r.at = strut_arena_text(&csv->arena, text, length);
  r.failed = !r.at;
  const char *wide = strut_text_wide(text, length);
  if (wide)
    strut_diagnose(diagnostics, strut_place_at(1, 1, 1), "the file is %s; save it as UTF-8", wide);
  else if (nul)
    strut_diagnose(diagnostics, place_of(text, nul, 1),
                   "a NUL byte is not allowed; the file is damaged, or no text");
  if (r.at && !nul && !wide) {
    r.end = r.at + length;
    r.at += strut_text_mark(text, length);
    r.separator = find_separator(&r, (size_t)header);
    read_lines(&r, (size_t)header);
    bool fine = !r.failed && find_header(&r, (size_t)header);
    if (fine) make_titles(&r);
    if (fine && !r.failed) take_rows(&r);
  }
  if (!r.failed && diagnostics->count == before && !csv->row_count)
    strut_diagnose(diagnostics, strut_place_at(1, 1, 1), "the table has a header but no rows");
  if (!r.failed && diagnostics->count == before) {
    size_t count = (1 + csv->row_count) * csv->column_count;
    csv->cell = strut_arena_copy(&csv->arena, r.cell, count, sizeof *csv->cell);
    r.failed = !csv->cell;
  }
  strut_release(r.cell);
  strut_release(r.line);
  if (r.failed || diagnostics->out_of_memory) return STRUT_NO_MEMORY;
  return diagnostics->count > before ? STRUT_BAD_SCENE : STRUT_OK;
}

/* ---- numbers and units ---- */

bool strut_csv_number(const char *text, int decimal, double *value) {
  static const char *const nothing[] = {"", "nan", "NaN", "NAN", "NA", "null", "none", "-"};
  bool minus = *text == '-';
  const char *digits = text + (minus || *text == '+');
  bool fine = *digits == '.' || (*digits >= '0' && *digits <= '9');
  if (fine && !strut_number_read_scaled(digits, strlen(digits), decimal, value)) return false;
  if (!fine && (fine = strcmp(digits, "inf") == 0)) *value = HUGE_VAL;
  if (fine && minus) *value = -*value;
  for (size_t i = 0; !fine && i < sizeof nothing / sizeof *nothing; i++)
    if (strcmp(text, nothing[i]) == 0) *value = (double)NAN, fine = true;
  return fine;
}

bool strut_csv_is_dimensionless(const char *text) {
  return strcmp(text, "1") == 0 || strcmp(text, "-") == 0;
}

bool strut_csv_unit(const char *text, strut_quantity *one) {
  char whole[110], twice[110];
  strut_quantity two;
  strut_expression_error error;
  int length = snprintf(whole, sizeof whole, "1 %s", text);
  snprintf(twice, sizeof twice, "2 %s", text);
  if (is_number(text) || length < 0 || (size_t)length >= sizeof whole) return false;
  bool unit = strut_expression_evaluate(whole, NULL, one, &error) &&
              strut_expression_evaluate(twice, NULL, &two, &error) &&
              two.value == 2.0 * one->value; /* not "1 -1 mm" */
  return unit ||
         (strut_expression_evaluate(text, NULL, one, &error) && one->value != 0.0 && !one->bare);
}
