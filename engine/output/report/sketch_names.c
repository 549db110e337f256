/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/report/sketch_names.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

enum { MOST_HIDDEN = 1, ELLIPSIS = 0x2026, ROOM_FOR_MORE = 6 };

/* Letters that every terminal prints from left to right in the same width; all others may do what
 * they like: they combine, turn the direction, or are as wide as the font says. */
static const struct {
  uint32_t first, last;
  uint8_t width;
} plain[] = {
    {0x20, 0x7e, 1},     {0xa1, 0xac, 1},     {0xae, 0x2ff, 1},    {0x370, 0x377, 1},
    {0x37a, 0x37f, 1},   {0x384, 0x38a, 1},   {0x38c, 0x38c, 1},   {0x38e, 0x3a1, 1},
    {0x3a3, 0x482, 1},   {0x48a, 0x52f, 1},   {0x1e00, 0x1eff, 1}, {0x2010, 0x2015, 1},
    {0x2018, 0x2022, 1}, {0x2032, 0x2034, 1}, {0x2070, 0x2071, 1}, {0x2074, 0x208e, 1},
    {0x2190, 0x2193, 1}, {0x3041, 0x3096, 2}, {0x30a1, 0x30ff, 2}, {0x3400, 0x4dbf, 2},
    {0x4e00, 0x9fff, 2}, {0xac00, 0xd7a3, 2}, {0xff01, 0xff60, 2},
};

static int width_of(uint32_t code, bool unicode) {
  if (!unicode && code > 0x7e) return 0;
  for (size_t i = 0; i < sizeof plain / sizeof plain[0]; i++)
    if (code >= plain[i].first && code <= plain[i].last) return plain[i].width;
  return 0;
}

/* One code point of valid UTF-8, as every name is; 0 for anything else. */
static size_t decode(const char *text, uint32_t *code) {
  unsigned char lead = (unsigned char)*text;
  size_t count = lead < 0x80 ? 1 : lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  static const unsigned char masks[] = {0, 0x7f, 0x1f, 0x0f, 0x07};
  *code = lead & masks[count];
  for (size_t i = 1; i < count; i++) {
    unsigned char next = (unsigned char)text[i];
    if ((next & 0xc0) != 0x80) {
      *code = 0;
      return i;
    }
    *code = *code << 6 | (next & 0x3f);
  }
  return count;
}

static bool append(strut_sketch_name *name, uint32_t code, int width) {
  if (name->count >= STRUT_SKETCH_NAME || name->columns + width > STRUT_SKETCH_NAME) return false;
  name->code[name->count] = code;
  name->width[name->count++] = (uint8_t)width;
  name->columns += width;
  return true;
}

/* Makes room for so many columns at the end, with a sign that something is missing. */
static void cut(strut_sketch_name *name, int columns, bool unicode) {
  int sign = unicode ? 1 : 2;
  while (name->count > 0 && name->columns + sign + columns > STRUT_SKETCH_NAME)
    name->columns -= name->width[--name->count];
  for (int i = 0; i < sign; i++) append(name, unicode ? ELLIPSIS : '.', 1);
}

static strut_sketch_name number_of(size_t node) {
  strut_sketch_name name = {0};
  char digits[24];
  snprintf(digits, sizeof digits, "#%zu", node + 1);
  for (const char *c = digits; *c; c++) append(&name, (uint32_t)*c, 1);
  return name;
}

strut_sketch_name strut_sketch_name_of(const char *text, size_t node, bool unicode) {
  strut_sketch_name name = {0};
  bool whole = true;
  while (*text) {
    uint32_t code;
    text += decode(text, &code);
    int width = width_of(code, unicode);
    if (width == 0) return number_of(node);
    whole = whole && append(&name, code, width);
  }
  if (!whole) cut(&name, 0, unicode);
  return name;
}

void strut_sketch_name_more(strut_sketch_name *name, size_t more) {
  char text[24];
  int length = snprintf(text, sizeof text, " +%zu", more);
  bool unicode = true;
  for (int i = 0; i < name->count; i++) unicode = unicode && name->code[i] != '.';
  if (length > STRUT_SKETCH_NAME) return;
  if (name->columns + length > STRUT_SKETCH_NAME) cut(name, length, unicode);
  for (const char *c = text; *c; c++) append(name, (uint32_t)*c, 1);
}

/* Cells with dots that the name would hide there, or INT_MAX where it does not fit. */
static int hidden(const strut_sketch_grid *grid, int column, int row,
                  const strut_sketch_name *name) {
  int count = 0;
  for (int i = column - 1; i <= column + name->columns; i++) {
    bool beside = i < column || i == column + name->columns; /* no two names touch */
    if (!strut_sketch_inside(grid, i, row)) {
      if (beside) continue;
      return INT_MAX;
    }
    size_t cell = (size_t)row * (size_t)grid->columns + (size_t)i;
    uint32_t letter = grid->letter[cell];
    bool mark = letter >= STRUT_SKETCH_GROUND && letter <= STRUT_SKETCH_NODE;
    if (letter && !(beside && mark)) return INT_MAX;
    if (!beside && grid->dots[cell]) count++;
  }
  return count;
}

void strut_sketch_name_place(strut_sketch_grid *grid, int column, int row,
                             const strut_sketch_name *name) {
  int width = name->columns, best = MOST_HIDDEN + 1, at = 0, line = 0;
  const int places[][2] = {{column + 1, row},
                           {column - width, row},
                           {column - width / 2, row - 1},
                           {column - width / 2, row + 1},
                           {column + 1, row - 1},
                           {column - width, row - 1},
                           {column + 1, row + 1},
                           {column - width, row + 1}};
  for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
    int count = hidden(grid, places[i][0], places[i][1], name);
    if (count >= best) continue;
    best = count;
    at = places[i][0];
    line = places[i][1];
  }
  if (best > MOST_HIDDEN) return;
  for (int i = 0; i < name->count; i++) {
    strut_sketch_letter(grid, at, line, name->code[i], name->width[i]);
    at += name->width[i];
  }
}
