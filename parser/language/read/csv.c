/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/language/read/csv.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "parser/language/expression/expression.h"

enum {
  MOST_COLUMNS = 10000,
  MOST_ROWS = 5000000,
  MOST_MESSAGES = 20,
  SAMPLED_LINES = 30,
  PEEKED_LINES = 6
};

/* A line, as its first cell and how many it has. */
typedef struct record {
  size_t first, count;
  uint32_t line;
} record;

/* A CSV text being read: a copy, in which a NUL ends each cell. */
typedef struct reader {
  char *at, *end;
  char separator;
  uint32_t line; /* of `at`, from 1 */
  strut_diagnostics *diagnostics;
  strut_csv *csv;
  char **cell; /* of strut_allocate */
  uint32_t *row_line;
  size_t cell_count, cell_capacity, row_capacity;
  record *head; /* the lines of the header, and some more */
  size_t head_count;
  size_t names, rows;  /* of `head`: the line with the names, the first with data */
  size_t units, group; /* likewise, or SIZE_MAX: their units, and what several names belong to */
  bool always;         /* the group belongs to all names but the first */
  bool failed;         /* memory was out */
} reader;

/* ---- places ---- */

/* The place of `at` in a text whose line `line` begins at `begin`. */
static strut_place place_from(const char *begin, uint32_t line, const char *at, size_t length) {
  uint32_t column = 1;
  if (at - begin >= 3 && memcmp(begin, "\xEF\xBB\xBF", 3) == 0) begin += 3;
  for (; begin < at; begin++) {
    bool ends = *begin == '\n';
    if (ends) line++, column = 1;
    if (!ends && ((unsigned char)*begin & 0xC0) != 0x80) column++;
  }
  uint32_t shown = length < STRUT_PLACE_LENGTH_MOST ? (uint32_t)length : STRUT_PLACE_LENGTH_MOST;
  return strut_place_at(line, column, shown ? shown : 1);
}

strut_place strut_csv_place(const strut_csv *csv, size_t cell) {
  size_t row = cell / csv->column_count;
  const char *at = csv->text + (csv->cell[cell] - csv->copy);
  const char *begin = csv->text + (csv->cell[row * csv->column_count] - csv->copy);
  while (begin > csv->text && begin[-1] != '\n') begin--;
  if (at > csv->text && at[-1] == '"') at--;
  return place_from(begin, csv->line[row], at, strlen(csv->cell[cell]));
}

/* Reports about the line that begins at `begin`. */
static void report(reader *self, const char *begin, uint32_t line, const char *at,
                   const char *what) {
  const strut_csv *csv = self->csv;
  strut_diagnose(self->diagnostics,
                 place_from(csv->text + (begin - csv->copy), line, csv->text + (at - csv->copy), 1),
                 "%s", what);
}

/* ---- lines ---- */

static void keep(reader *self, char *cell) {
  if (!strut_grow(&self->cell, &self->cell_capacity, self->cell_count, sizeof *self->cell))
    self->failed = true;
  else
    self->cell[self->cell_count++] = cell;
}

/* A cell in quotes, which are doubled inside. False: they do not end. */
static bool read_quoted(reader *self) {
  char *to = ++self->at, *from = to;
  keep(self, to);
  for (;; from++) {
    if (from >= self->end) return false;
    if (*from == '"' && (from + 1 >= self->end || from[1] != '"')) break;
    if (*from == '"') from++;
    self->line += *from == '\n';
    *to++ = *from;
  }
  self->at = from + 1;
  *to = '\0';
  return true;
}

/* 1,5 in a file whose cells are not separated by commas. */
static void read_decimal_comma(char *cell) {
  char *comma = strchr(cell, ',');
  if (comma && cell[strspn(cell, "+-0123456789eE,")] == '\0' && !strchr(comma + 1, ','))
    *comma = '.';
}

static void read_plain(reader *self) {
  char *from = self->at, *to = from;
  while (to < self->end && *to != self->separator && *to != '\n') to++;
  self->at = to;
  if (to > from && to[-1] == '\r' && (to == self->end || *to == '\n')) to[-1] = '\0';
  while (*from == ' ' && from < to) from++;
  while (to > from && to[-1] == ' ') *--to = '\0';
  keep(self, from);
}

/* Reads one line. */
static record read_line(reader *self) {
  record result = {.first = self->cell_count, .line = self->line};
  const char *begin = self->at;
  for (;;) {
    bool quoted = self->at < self->end && *self->at == '"';
    char *open = self->at;
    if (quoted && !read_quoted(self)) {
      report(self, begin, result.line, open, "unterminated quoted cell");
      self->at = self->end;
    }
    if (!quoted) read_plain(self);
    char next = self->at < self->end ? *self->at : '\n';
    if (quoted && next != self->separator && next != '\n' && next != '\r')
      report(self, begin, result.line, self->at,
             self->separator == ',' ? "expected a comma or the end of the line after a quoted cell"
                                    : "expected the end of the cell after its quote");
    while (self->at < self->end && *self->at != self->separator && *self->at != '\n') self->at++;
    bool last = self->at >= self->end || *self->at == '\n';
    *self->at = '\0'; /* behind the text is one, too */
    if (!quoted && self->separator != ',' && !self->failed)
      read_decimal_comma(self->cell[self->cell_count - 1]);
    if (self->at < self->end) self->at++;
    if (last || self->failed) break;
  }
  self->line++;
  result.count = self->cell_count - result.first;
  return result;
}

static bool is_empty(const reader *self, record line) {
  return line.count == 1 && !*self->cell[line.first];
}

/* The next line that is neither empty nor a comment; count 0 after the last. */
static record next_line(reader *self, bool keep_empty) {
  while (self->at < self->end && !self->failed) {
    bool comment = *self->at == '#';
    record line = read_line(self);
    if (!self->failed && !comment && (keep_empty || !is_empty(self, line))) return line;
    self->cell_count = line.first;
  }
  return (record){.first = self->cell_count, .line = self->line};
}

/* The one that separates cells in most of the first lines. */
static char find_separator(const reader *self, int header) {
  static const char all[] = {'\t', ';', ','};
  size_t best = 0;
  char separator = ',';
  for (size_t k = 0; k < sizeof all; k++) {
    const char *line = self->at;
    size_t lines = 0, at = 0;
    for (; line < self->end && at < (size_t)(header > 0 ? header : 0) + SAMPLED_LINES; at++) {
      const char *end = memchr(line, '\n', (size_t)(self->end - line));
      if (!end) end = self->end;
      bool counts = *line != '#' && (int)at + 1 >= header, quoted = false, found = false;
      for (; line < end; line++) {
        quoted = quoted != (*line == '"');
        found = found || (*line == all[k] && !quoted);
      }
      lines += counts && found;
      line = end + 1;
    }
    if (lines > best) best = lines, separator = all[k];
  }
  return separator;
}

/* ---- the header ---- */

static const char *head_cell(const reader *self, size_t line, size_t column) {
  const record *r = &self->head[line];
  return column < r->count ? self->cell[r->first + column] : "";
}

static size_t filled(const reader *self, size_t line) {
  size_t count = 0;
  for (size_t i = 0; i < self->head[line].count; i++) count += *head_cell(self, line, i) != '\0';
  return count;
}

static bool is_number(const char *text) {
  double value;
  return strut_csv_number(text, 0, &value) && !isnan(value);
}

static size_t numbers(const reader *self, size_t line) {
  size_t count = 0;
  for (size_t i = 0; i < self->head[line].count; i++) count += is_number(head_cell(self, line, i));
  return count;
}

/* The text without brackets around it. */
static const char *unbracketed(reader *self, const char *text) {
  size_t length = strlen(text);
  bool within = length > 1 && ((*text == '[' && text[length - 1] == ']') ||
                               (*text == '(' && text[length - 1] == ')'));
  return within ? strut_arena_text(&self->csv->arena, text + 1, length - 2) : text;
}

/* Has the line a unit below each name, or nothing? */
static bool is_of_units(reader *self, size_t line) {
  size_t units = 0;
  for (size_t i = 0; i < self->head[line].count; i++) {
    const char *text = unbracketed(self, head_cell(self, line, i));
    if (!text) self->failed = true;
    if (!text || !*text || strcmp(text, "-") == 0 || strcmp(text, "1") == 0) continue;
    char whole[80];
    strut_quantity q;
    strut_expression_error error;
    int n = snprintf(whole, sizeof whole, "1 %s", text);
    if (n < 0 || (size_t)n >= sizeof whole || is_number(text) ||
        !strut_expression_evaluate(whole, NULL, &q, &error))
      return false;
    units++;
  }
  return units > 0;
}

/* Headers whose form says how long they are: DeepLabCut's; groups above names, as Tracker's; units below. */
static void find_form(reader *self) {
  size_t last = self->head_count - 1, names = 0;
  while (names < last && strcmp(head_cell(self, names, 0), "coords") != 0) names++;
  self->always = names > 0 && strcmp(head_cell(self, 0, 0), "scorer") == 0 &&
                 strcmp(head_cell(self, names, 0), "coords") == 0;
  bool grouped = last >= 2 && filled(self, 0) < filled(self, 1) &&
                 filled(self, 1) == self->head[1].count && !numbers(self, 1) && numbers(self, 2);
  self->names = self->always ? names : grouped ? 1 : 0;
  self->rows = self->names + 1;
  if (self->names > 0) self->group = self->always ? 1 : 0;
  if (self->rows + 1 <= last && !numbers(self, self->rows) && numbers(self, self->rows + 1) &&
      is_of_units(self, self->rows))
    self->units = self->rows++;
}

/* A header of so many lines. */
static void find_names(reader *self, size_t header) {
  size_t last = header;
  while (last > 1 && filled(self, last - 1) == 0) last--;
  if (last > 1 && is_of_units(self, last - 1)) self->units = --last;
  while (last > 1 && filled(self, last - 1) == 0) last--;
  self->names = last - 1;
  self->rows = header;
  if (self->names > 0) self->group = self->names - 1;
}

/* Finds the names, and where rows begin. False: that was reported. */
static bool read_header(reader *self, int header) {
  size_t wanted = header < 0 ? PEEKED_LINES : (size_t)header + 1;
  self->units = self->group = SIZE_MAX;
  self->head = strut_arena_allocate(&self->csv->arena, wanted, sizeof *self->head);
  if (!self->head) self->failed = true;
  while (self->head_count < wanted && self->at < self->end && !self->failed) {
    bool within = header >= 0 && self->head_count < (size_t)header;
    record line = within ? read_line(self) : next_line(self, false);
    if (line.count) self->head[self->head_count++] = line;
  }
  if (self->failed) return false;
  if (header > 0 && self->head_count < (size_t)header) {
    strut_diagnose(self->diagnostics, strut_place_at(1, 1, 1),
                   "the file has %zu lines, expected a header of %d", self->head_count, header);
    return false;
  }
  if (!self->head_count) {
    strut_diagnose(self->diagnostics, strut_place_at(1, 1, 1),
                   "the file is empty, expected a table");
    return false;
  }
  if (header < 0)
    find_form(self);
  else if (header > 0)
    find_names(self, (size_t)header);
  return !self->failed;
}

/* ---- rows ---- */

/* Moves the line's cells behind those that are kept. */
static void take_row(reader *self, record line, size_t *kept) {
  size_t columns = self->csv->column_count;
  while (line.count > columns && !*self->cell[line.first + line.count - 1]) line.count--;
  if (line.count != columns)
    strut_diagnose(self->diagnostics, strut_place_at(line.line, 1, 1),
                   "%zu cells, expected %zu as in the header", line.count, columns);
  size_t rows = self->csv->row_count;
  if (rows == MOST_ROWS) {
    strut_diagnose(self->diagnostics, strut_place_at(line.line, 1, 1), "more than %d rows",
                   MOST_ROWS);
    self->at = self->end;
  }
  if (!strut_grow(&self->row_line, &self->row_capacity, rows + 1, sizeof *self->row_line))
    self->failed = true;
  if (self->failed || line.count != columns) return;
  memmove(&self->cell[*kept], &self->cell[line.first], columns * sizeof *self->cell);
  self->row_line[++self->csv->row_count] = line.line;
  *kept += columns;
}

static void read_rows(reader *self) {
  const record names = self->head[self->names];
  size_t columns = names.count, kept;
  if (columns > MOST_COLUMNS)
    strut_diagnose(self->diagnostics, strut_place_at(names.line, 1, 1), "more than %d columns",
                   MOST_COLUMNS);
  if (!strut_grow(&self->row_line, &self->row_capacity, 0, sizeof *self->row_line))
    self->failed = true;
  if (self->failed) return;
  self->csv->column_count = columns;
  self->row_line[0] = names.line;
  if (self->names == self->rows) { /* no header: the first row stands for the names, too */
    for (size_t i = 0; i < columns; i++) keep(self, NULL);
    if (self->failed) return;
    memmove(&self->cell[columns], self->cell, (self->cell_count - columns) * sizeof *self->cell);
    for (size_t i = 0; i < self->head_count; i++) self->head[i].first += columns;
  } else if (names.first > 0) {
    memmove(self->cell, &self->cell[names.first], columns * sizeof *self->cell);
  }
  kept = columns;
  for (size_t i = self->rows; i < self->head_count; i++) take_row(self, self->head[i], &kept);
  self->cell_count = kept;
  while (!self->failed && self->diagnostics->count < MOST_MESSAGES) {
    record line = next_line(self, columns == 1);
    if (!line.count) break;
    take_row(self, line, &kept);
    self->cell_count = kept;
  }
}

/* ---- titles ---- */

/* "name [unit]" or "name (unit)" in two. */
static void split_title(reader *self, const char *title, strut_csv_title *column) {
  strut_arena *arena = &self->csv->arena;
  size_t length = strlen(title), name = length;
  bool round = length && title[length - 1] == ')';
  const char *open = strrchr(title, round ? '(' : '[');
  bool has_unit = open && open > title && (round ? open[-1] == ' ' : title[length - 1] == ']');
  column->unit = "";
  if (has_unit) {
    name = (size_t)(open - title);
    column->unit = strut_arena_text(arena, open + 1, length - name - 2);
  }
  while (name > 0 && title[name - 1] == ' ') name--;
  column->name = strut_arena_text(arena, title, name);
}

/* Is the name on the line with names more than once? */
static bool is_repeated(const reader *self, const char *name) {
  size_t count = 0;
  for (size_t i = 0; i < self->head[self->names].count; i++)
    count += strcmp(head_cell(self, self->names, i), name) == 0;
  return count > 1;
}

/* Of the lines above the names those that a name belongs to: a cell counts until the next one. */
static const char *name_group(reader *self, size_t i, const char *name) {
  for (size_t line = self->names; line-- > self->group;) {
    size_t at = i;
    while (at > 0 && !*head_cell(self, line, at)) at--;
    const char *of = head_cell(self, line, at);
    if (*of) name = strut_arena_format(&self->csv->arena, "%s.%s", of, name);
    if (!*of || !name) break;
  }
  return name;
}

static void make_title(reader *self, size_t i) {
  strut_csv_title *column = &self->csv->titles[i];
  const char *title = head_cell(self, self->names, i);
  if (self->names == self->rows) {
    column->name = strut_arena_format(&self->csv->arena, "%zu", i + 1);
    column->unit = "";
    return;
  }
  if (i == 0) title += strspn(title, "# ");
  split_title(self, title, column);
  if (self->always && i == 0) column->name = "frame";
  bool grouped = self->always ? i > 0 : self->group != SIZE_MAX && is_repeated(self, title);
  if (grouped && column->name) column->name = name_group(self, i, column->name);
  if (self->units != SIZE_MAX && column->unit && !*column->unit)
    column->unit = unbracketed(self, head_cell(self, self->units, i));
}

/* The titles, from the cells of the header before rows take their place. */
static void make_titles(reader *self) {
  strut_csv *csv = self->csv;
  size_t count = self->head[self->names].count;
  csv->titles = strut_arena_allocate(&csv->arena, count, sizeof *csv->titles);
  if (!csv->titles) self->failed = true;
  for (size_t i = 0; i < count && !self->failed; i++) {
    make_title(self, i);
    if (!csv->titles[i].name || !csv->titles[i].unit) self->failed = true;
  }
}

/* ---- numbers ---- */

bool strut_csv_number(const char *text, int decimal, double *value) {
  static const char *const nothing[] = {"", "nan", "NaN", "NAN", "NA", "null", "none", "-"};
  char whole[64];
  bool minus = *text == '-';
  const char *digits = text + (minus || *text == '+');
  if (*digits == '.' && strlen(digits) < sizeof whole - 2) {
    snprintf(whole, sizeof whole, "0%s", digits);
    digits = whole;
  }
  size_t length = strlen(digits);
  if (length > 1 && digits[length - 1] == '.') length--;
  bool fine = *digits >= '0' && *digits <= '9';
  if (fine && !strut_number_read_scaled(digits, length, decimal, value)) return false;
  if (!fine && (fine = strcmp(digits, "inf") == 0)) *value = HUGE_VAL;
  if (fine && minus) *value = -*value;
  for (size_t i = 0; !fine && i < sizeof nothing / sizeof *nothing; i++)
    if (strcmp(text, nothing[i]) == 0) *value = (double)NAN, fine = true;
  return fine;
}

/* ---- the whole text ---- */

/* Hands the cells over to the table. */
static bool finish(reader *self) {
  strut_csv *csv = self->csv;
  size_t count = (1 + csv->row_count) * csv->column_count;
  csv->cell = strut_arena_allocate(&csv->arena, count, sizeof *csv->cell);
  csv->line = strut_arena_allocate(&csv->arena, 1 + csv->row_count, sizeof *csv->line);
  if (!csv->cell || !csv->line) return false;
  memcpy(csv->cell, self->cell, count * sizeof *csv->cell);
  memcpy(csv->line, self->row_line, (1 + csv->row_count) * sizeof *csv->line);
  return true;
}

/* A NUL byte would end a cell. */
static bool is_text(reader *self, size_t length) {
  const char *begin = self->csv->text, *nul = memchr(begin, '\0', length);
  uint32_t line = 1;
  for (const char *c = begin; nul && c < nul; c++)
    if (*c == '\n') line++, begin = c + 1;
  if (nul)
    strut_diagnose(self->diagnostics, place_from(begin, line, nul, 1),
                   "a NUL byte is not allowed; the file is damaged, or no text");
  return !nul;
}

strut_status strut_csv_read(const char *text, size_t length, int header,
                            strut_diagnostics *diagnostics, strut_csv *csv) {
  reader r = {.line = 1, .diagnostics = diagnostics, .csv = csv};
  *csv = (strut_csv){.text = text};
  if (is_text(&r, length)) {
    csv->copy = r.at = strut_arena_text(&csv->arena, text, length);
    r.failed = !r.at;
  }
  if (r.at) {
    r.end = r.at + length;
    if (length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0) r.at += 3; /* a byte order mark */
    r.separator = find_separator(&r, header);
    bool fine = read_header(&r, header);
    if (fine) make_titles(&r);
    if (fine && !r.failed) read_rows(&r);
  }
  if (!r.failed && !diagnostics->count && !csv->row_count)
    strut_diagnose(diagnostics, strut_place_at(1, 1, 1), "the table has a header but no rows");
  if (!r.failed && !diagnostics->count && !finish(&r)) r.failed = true;
  strut_release(r.cell);
  strut_release(r.row_line);
  if (r.failed || diagnostics->out_of_memory) return STRUT_NO_MEMORY;
  return diagnostics->count ? STRUT_BAD_SCENE : STRUT_OK;
}
