/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A table of nodes and one of members, with units in their headers as strut's own tables have them. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "parser/expression/expression.h"
#include "parser/import/import_parts.h"
#include "parser/read/csv.h"

enum { MOST_COLUMNS = 64 };

/* Columns that are numbers: title, key of the language, its dimension (kg, m, s, angle). */
typedef struct number_column {
  const char *title, *key;
  strut_dimension dimension;
} number_column;

static const number_column node_numbers[] = {
    {"x", NULL, {0, 1, 0, 0}}, {"y", NULL, {0, 1, 0, 0}}, {"mass", "mass", {1, 0, 0, 0}}};
static const number_column member_numbers[] = {
    {"stiffness", "stiffness", {1, 0, -2, 0}},
    {"axial stiffness", "axial_stiffness", {1, 1, -2, 0}},
    {"damping", "damping", {1, 0, -1, 0}},
    {"mass", "mass", {1, 0, 0, 0}},
    {"rest length", "rest_length", {0, 1, 0, 0}},
    {"made length", "rest_length", {0, 1, 0, 0}}, /* of a build list */
    {"rest length ratio", "rest_length_ratio", {0, 0, 0, 0}},
    {"pretension", "pretension", {1, 1, -2, 0}},
    {"force density", "force_density", {1, 0, -2, 0}}};
enum {
  NODE_NUMBERS = sizeof node_numbers / sizeof node_numbers[0],
  MEMBER_NUMBERS = sizeof member_numbers / sizeof member_numbers[0]
};

typedef struct table {
  strut_import_scene *scene;
  strut_diagnostics *said;
  strut_csv csv;
} table;

/* Titles may have underscores in place of blanks. */
static bool same_title(const char *title, const char *name) {
  for (; *title && *name; title++, name++)
    if (*title != *name && !(*title == '_' && *name == ' ')) return false;
  return !*title && !*name;
}

/* The column of that title, or -1. */
static long find_column(const table *t, const char *title) {
  for (size_t i = 0; i < t->csv.column_count; i++)
    if (same_title(t->csv.titles[i].name, title)) return (long)i;
  return -1;
}

static long require_column(table *t, const char *title, const char *of) {
  long column = find_column(t, title);
  if (column < 0)
    strut_diagnose(t->said, strut_place_at(1, 1, 1), "the table of %s has no column '%s'", of,
                   title);
  return column;
}

static size_t cell_of(const table *t, size_t row, long column) {
  return (row + 1) * t->csv.column_count + (size_t)column;
}

static const char *text_at(const table *t, size_t row, long column) {
  return column < 0 ? "" : t->csv.cell[cell_of(t, row, column)];
}

/* A cell with its column's unit, in SI: 1; 0: it is empty; -1: it was reported. */
static int read_number(table *t, size_t row, long column, const number_column *kind,
                       double *value) {
  char whole[200], expected[120];
  strut_quantity q;
  strut_expression_error error;
  size_t cell = cell_of(t, row, column);
  const char *text = t->csv.cell[cell], *unit = t->csv.titles[column].unit;
  double plain;
  if (!*text) return 0;
  bool one = strcmp(unit, "1") == 0;
  bool fine = strut_csv_number(text, &plain) && isfinite(plain);
  int n = snprintf(whole, sizeof whole, "%s %s", *text == '+' ? text + 1 : text, one ? "" : unit);
  fine = fine && n > 0 && (size_t)n < sizeof whole &&
         strut_expression_evaluate(whole, NULL, &q, &error);
  if (fine && (q.bare || strut_dimension_equal(q.dimension, kind->dimension))) {
    *value = q.value;
    if (q.bare && kind->dimension.m == 1.0f && kind->dimension.kg == 0.0f)
      *value *= t->scene->unit; /* a length without unit */
    return 1;
  }
  strut_diagnose(
      t->said, t->csv.place[cell], "expected %s for '%s', found '%.40s%s%.20s'",
      fine ? strut_dimension_name(kind->dimension, expected, sizeof expected) : "a number",
      kind->title, text, *unit && fine ? " " : "", fine ? unit : "");
  return -1;
}

/* Appends ", key: value unit" of each column that has a value in this row. */
static const char *read_numbers(table *t, size_t row, const number_column *columns, size_t count) {
  const char *text = "";
  for (size_t i = 0; i < count; i++) {
    long column = columns[i].key ? find_column(t, columns[i].title) : -1;
    double value = 0.0;
    char suffix[120];
    if (column < 0 || read_number(t, row, column, &columns[i], &value) <= 0) continue;
    const char *unit = strut_dimension_unit(columns[i].dimension);
    snprintf(suffix, sizeof suffix, "%s%s", strcmp(unit, "1") == 0 ? "" : " ",
             strcmp(unit, "1") == 0 ? "" : unit);
    text = strut_import_text(t->scene, "%s, %s: %s%s", text, columns[i].key,
                             strut_import_number(t->scene, value), suffix);
  }
  return text;
}

/* Notes of columns that are not read. */
static void note_columns(table *t, const char *const *known, const number_column *numbers,
                         size_t count) {
  for (size_t i = 0; i < t->csv.column_count; i++) {
    const char *title = t->csv.titles[i].name;
    bool found = false;
    for (size_t k = 0; known[k]; k++) found = found || same_title(title, known[k]);
    for (size_t k = 0; k < count; k++) found = found || same_title(title, numbers[k].title);
    if (!found) strut_note(t->said, t->csv.place[i], "not imported: the column '%.60s'", title);
  }
}

static void read_nodes(table *t) {
  static const char *const known[] = {"node", "fixed", NULL};
  strut_import_scene *s = t->scene;
  long name = require_column(t, "node", "nodes"), x = require_column(t, "x", "nodes");
  long y = require_column(t, "y", "nodes"), fixed = find_column(t, "fixed");
  if (name < 0 || x < 0 || y < 0) return;
  note_columns(t, known, node_numbers, NODE_NUMBERS);
  for (size_t i = 0; i < t->csv.row_count && !strut_diagnostics_full(t->said); i++) {
    double p[2] = {0.0, 0.0};
    const char *held = text_at(t, i, fixed);
    bool none = !*held || strcmp(held, "no") == 0;
    if (!*text_at(t, i, name))
      strut_diagnose(t->said, t->csv.place[cell_of(t, i, name)], "a node has no name");
    if (!none && strcmp(held, "x") != 0 && strcmp(held, "y") != 0 && strcmp(held, "both") != 0)
      strut_diagnose(t->said, t->csv.place[cell_of(t, i, fixed)],
                     "expected no, x, y or both for 'fixed', found '%.40s'", held);
    for (int c = 0; c < 2; c++)
      if (read_number(t, i, c ? y : x, &node_numbers[c], &p[c]) == 0)
        strut_diagnose(t->said, t->csv.place[cell_of(t, i, c ? y : x)], "a coordinate is missing");
    const char *value = strut_import_text(
        s, "{position: [%s, %s]%s%s%s}", strut_import_number(s, p[0]), strut_import_number(s, p[1]),
        read_numbers(t, i, node_numbers, NODE_NUMBERS), none ? "" : ", fixed: ", none ? "" : held);
    strut_import_node_add(s, t->said, t->csv.place[cell_of(t, i, name)], text_at(t, i, name),
                          value);
  }
}

/* ", NAME" for each of the nodes that a text names, with ';' between; NULL where that was reported. */
static const char *read_passed(table *t, size_t row, long column) {
  const char *at = text_at(t, row, column), *names = "";
  while (*at) {
    size_t length = strcspn(at, ";");
    const char *name = strut_import_text(t->scene, "%.*s", (int)length, at);
    if (strut_name_map_find(&t->scene->node_names, name) < 0) {
      strut_diagnose(t->said, t->csv.place[cell_of(t, row, column)], "there is no node '%.60s'",
                     name);
      return NULL;
    }
    names = strut_import_text(t->scene, "%s%s%s", names, *names ? ", " : "",
                              strut_import_node_use(t->scene, name));
    at += length + (at[length] == ';');
  }
  return names;
}

static void read_members(table *t) {
  static const char *const known[] = {"member", "kind", "from", "to", "over", NULL};
  strut_import_scene *s = t->scene;
  long name = require_column(t, "member", "members"), kind = require_column(t, "kind", "members");
  long from = require_column(t, "from", "members"), to = require_column(t, "to", "members");
  long over = find_column(t, "over");
  if (name < 0 || kind < 0 || from < 0 || to < 0) return;
  note_columns(t, known, member_numbers, MEMBER_NUMBERS);
  for (size_t i = 0; i < t->csv.row_count && !strut_diagnostics_full(t->said); i++) {
    const char *word = text_at(t, i, kind);
    if (strcmp(word, "bar") != 0 && strcmp(word, "spring") != 0 && strcmp(word, "cable") != 0)
      strut_diagnose(t->said, t->csv.place[cell_of(t, i, kind)],
                     "expected bar, spring or cable for 'kind', found '%.40s'", word);
    const char *first = read_passed(t, i, from), *last = read_passed(t, i, to);
    const char *between = over < 0 ? "" : read_passed(t, i, over);
    if (first && last && (!*first || !*last))
      strut_diagnose(t->said, t->csv.place[cell_of(t, i, *first ? to : from)],
                     "a member lacks one of its nodes");
    if (!first || !last || !between) continue;
    strut_import_line(
        s, &s->section[STRUT_IMPORT_MEMBERS], "  %s: {kind: %s, nodes: [%s, %s%s%s]%s}",
        strut_import_name(s, text_at(t, i, name)), word, first, between, *between ? ", " : "", last,
        read_numbers(t, i, member_numbers, MEMBER_NUMBERS));
  }
}

strut_status strut_import_tables(strut_import_scene *s) {
  table tables[2] = {{.scene = s}, {.scene = s}};
  strut_status status = STRUT_OK;
  for (int i = 0; i < 2 && status != STRUT_NO_MEMORY; i++) {
    tables[i].said = &s->files[i].diagnostics;
    strut_status read =
        strut_csv_read(s->files[i].text, s->files[i].length, tables[i].said, &tables[i].csv);
    if (read) status = read;
  }
  if (!status) {
    int members = find_column(&tables[0], "member") >= 0 ? 0 : 1;
    read_nodes(&tables[1 - members]);
    read_members(&tables[members]);
  }
  for (int i = 0; i < 2; i++) strut_arena_free(&tables[i].csv.arena);
  return status;
}
