/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Printed tables of results that are described by rows. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/number_text.h"
#include "engine/base/vec.h"
#include "engine/output/result_values.h"

enum { NARROWEST_NAME = 12, WIDEST_NAME = 40, COLUMN = 13, CELL = STRUT_VALUE_ROOM };

/* A value of each struct, or one of its numbers. */
typedef struct column {
  size_t row, part, parts;
} column;

static bool is_behind(const strut_value_row *row) {
  return row->label[0] && strcmp(row->label[0], STRUT_LABEL_BEHIND) == 0;
}

/* A label, or "rest_length" as "rest length"; "state 2" of numbers without labels of their own. */
static void write_title(const strut_value_row *row, const column *at, char title[CELL]) {
  const bool numbered = at->parts > 1 && !row->label[1];
  const char *label = row->label[(at->part && !numbered) || is_behind(row)];
  snprintf(title, CELL, "%s", label && *label ? label : row->key);
  if (numbered) snprintf(title, CELL, "%s %zu", label, at->part + 1);
  for (char *c = title; *c; c++)
    if (*c == '_') *c = ' ';
}

static void write_number(const strut_value_row *row, double number, int digits, char text[CELL]) {
  bool angle = strcmp(row->unit, "rad") == 0;
  if (angle) number *= 180.0 / STRUT_PI;
  strut_rounded_quantity shown = strut_quantity_of_any(number, digits, angle ? "deg" : row->unit);
  snprintf(text, CELL, "%s", isfinite(number) ? shown.text : "not known");
}

static void write_value(const strut_value_row *row, const strut_value *value,
                        const strut_result_object *of, size_t part, int digits, char text[CELL]) {
  *text = '\0';
  switch ((int)value->kind) {
    case STRUT_VALUE_NUMBER: write_number(row, value->number, digits, text); break;
    case STRUT_VALUE_NUMBERS:
      write_number(row, strut_value_item(value, of, part), digits, text);
      break;
    case STRUT_VALUE_COUNT: snprintf(text, CELL, "%" PRId64, value->integer); break;
    case STRUT_VALUE_FLAG: snprintf(text, CELL, "%s", value->integer ? "yes" : "no"); break;
    case STRUT_VALUE_WORDS: value->write(of, text); break;
    case STRUT_VALUE_TEXT: snprintf(text, CELL, "%s", value->text ? value->text : "none"); break;
    case STRUT_VALUE_MAP:
      for (size_t k = 0; k < value->count; k++) {
        size_t used = strlen(text);
        snprintf(text + used, CELL - used, "%s%s", k ? ", " : "", value->value(of, k).text);
      }
      break;
    default: break;
  }
}

/* The columns of structs, as many as there is space for. */
static size_t find_columns(const strut_value_rows *rows, const strut_value *value,
                           column columns[STRUT_MOST_VALUES]) {
  size_t count = 0;
  for (size_t k = 0; k < rows->count; k++) {
    const strut_value_row *row = &rows->row[k];
    size_t parts = row->label[1] ? 2 : value[k].kind == STRUT_VALUE_NUMBERS ? value[k].count : 1;
    if (!row->label[0] || is_behind(row)) parts = 0;
    for (size_t part = 0; part < parts && count < STRUT_MOST_VALUES; part++)
      columns[count++] = (column){k, part, parts};
  }
  return count;
}

static void add_titles(strut_buffer *table, const strut_value_rows *rows, const column *columns,
                       size_t count) {
  char title[CELL];
  for (size_t i = 0; i < count; i++) {
    write_title(&rows->row[columns[i].row], &columns[i], title);
    strut_buffer_add(table, "  %*s", COLUMN, title);
  }
  strut_buffer_add(table, "\n");
}

static void add_struct(strut_buffer *table, const strut_value_rows *rows,
                       const strut_result_object *of, const strut_value *value, int digits) {
  column columns[STRUT_MOST_VALUES];
  char text[CELL], title[CELL];
  size_t count = find_columns(rows, value, columns);
  for (size_t i = 0; i < count; i++) {
    const strut_value_row *row = &rows->row[columns[i].row];
    write_title(row, &columns[i], title);
    write_value(row, &value[columns[i].row], of, columns[i].part, digits, text);
    strut_buffer_add(table, "  %*s", strlen(title) > COLUMN ? (int)strlen(title) : COLUMN, text);
  }
  for (size_t k = 0; k < rows->count; k++) {
    if (!is_behind(&rows->row[k]) || value[k].kind == STRUT_VALUE_ABSENT) continue;
    write_title(&rows->row[k], &(column){k, 0, 1}, title);
    write_value(&rows->row[k], &value[k], of, 0, digits, text);
    strut_buffer_add(table, ", %s %s", title, text);
  }
  strut_buffer_add(table, "\n");
}

/* The name of a struct of a list, or its number; NULL: it is left out. */
static const char *name_at(const strut_value *list, const strut_result_object *of, size_t i,
                           char number[24]) {
  snprintf(number, 24, "%zu", i + 1);
  return list->name ? list->name(of, i) : number;
}

static void add_list(strut_buffer *table, const strut_value_row *row, const strut_value *list,
                     const strut_result_object *of, int names, const strut_table_limits *limits) {
  strut_value value[STRUT_MOST_VALUES];
  column columns[STRUT_MOST_VALUES];
  char number[24];
  bool titled = false;
  for (size_t i = 0; i < list->count && i < limits->rows; i++) {
    const char *name = name_at(list, of, i, number);
    const strut_result_object item = {(const char *)list->items + i * list->size, of, of->scene, i};
    if (!name) continue;
    row->rows->fill(&item, value);
    if (!titled) {
      strut_buffer_add(table, "\n  %-*s", names, row->label[0]);
      add_titles(table, row->rows, columns, find_columns(row->rows, value, columns));
    }
    titled = true;
    strut_buffer_add(table, "  %-*s", names, name);
    add_struct(table, row->rows, &item, value, limits->digits);
  }
  if (list->count > limits->rows)
    strut_buffer_add(table, "  ... and %zu more; --json lists all\n", list->count - limits->rows);
}

void strut_values_add_tables(strut_buffer *table, const strut_value_rows *rows,
                             const strut_result_object *of, const strut_table_limits *limits) {
  strut_value value[STRUT_MOST_VALUES];
  char number[24];
  size_t names = NARROWEST_NAME;
  rows->fill(of, value);
  for (size_t k = 0; k < rows->count; k++)
    for (size_t i = 0; rows->row[k].label[0] && i < value[k].count && i < limits->rows; i++) {
      const char *name = value[k].kind == STRUT_VALUE_LIST ? name_at(&value[k], of, i, number) : "";
      if (name && strlen(name) > names) names = strlen(name);
    }
  if (names > WIDEST_NAME) names = WIDEST_NAME;
  for (size_t k = 0; k < rows->count; k++)
    if (rows->row[k].label[0] && value[k].kind == STRUT_VALUE_LIST && value[k].items)
      add_list(table, &rows->row[k], &value[k], of, (int)names, limits);
    else if (value[k].kind == STRUT_VALUE_PART && rows->row[k].rows)
      strut_values_add_tables(table, rows->row[k].rows,
                              &(strut_result_object){value[k].items, of, of->scene, 0}, limits);
}
