/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of measured data, and their columns where they are used. See reader.h. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/read/csv.h"
#include "parser/language/read/reader.h"

enum { MOST_BYTES = 1 << 28 };

/* A table being read. */
typedef struct loader {
  strut_reader *reader;
  strut_fields fields;
  strut_data_table *table;
  strut_data_column *columns;
  strut_csv csv;
} loader;

static const strut_tree *value_of(loader *self, int key) {
  return strut_slot_of(&self->fields, key)->value;
}

/* ---- messages about a file ---- */

/* The file's number for places, with a text that lasts as long as messages; 0: there are too many. */
static unsigned show_file(strut_reader *reader, const strut_data_table *table) {
  size_t length = strlen(table->text);
  char *copy = strut_allocate(length + 1, 1);
  if (!copy) reader->out_of_memory = true;
  if (!copy) return 0;
  memcpy(copy, table->text, length);
  unsigned number = strut_diagnostics_use(reader->diagnostics, table->path, copy, length);
  if (number)
    strut_diagnostics_own(reader->diagnostics, number, copy);
  else
    strut_release(copy);
  return number;
}

/* Reports about a place in the file, which `used` names; about that name where the file has no number. */
static void report_in_file(strut_reader *reader, strut_place place, unsigned file,
                           const strut_tree *used, const char *message) {
  size_t before = reader->diagnostics->count;
  place.file = file & 0xFFu;
  strut_report_error(reader, file ? place : used->place, "%s", message);
  if (file && reader->diagnostics->count > before)
    strut_diagnose_note(reader->diagnostics, before, used->place, "the data are used here");
}

bool strut_refuse_data(strut_reader *reader, const strut_tree *value, const strut_data_table *table,
                       const strut_data_column *column, size_t row, const char *message) {
  strut_diagnostics unused = {0};
  strut_csv csv;
  size_t line = row == SIZE_MAX ? 0 : 1 + row + (size_t)table->skip;
  bool read =
      strut_csv_read(table->text, strlen(table->text), table->header, &unused, &csv) == STRUT_OK;
  strut_place place = {.line = 0};
  if (read)
    place = strut_csv_place(&csv, line * csv.column_count + (size_t)(column - table->columns));
  report_in_file(reader, place, read ? show_file(reader, table) : 0, value, message);
  strut_arena_free(&csv.arena);
  strut_diagnostics_free(&unused);
  return false;
}

static bool refuse_column(loader *self, const strut_tree *at, const char *name) {
  return strut_report_error(self->reader, at->place, "'%s' has no column '%s'",
                            strut_sanitised_text(self->reader, self->table->file),
                            strut_sanitised_text(self->reader, name));
}

/* ---- columns and their units ---- */

/* The name of the column, or what follows its last dot? */
static bool is_called(const strut_data_column *column, const char *name) {
  const char *dot = strrchr(column->name, '.');
  return strcmp(column->name, name) == 0 || (dot && strcmp(dot + 1, name) == 0);
}

/* Is there a column with that name? */
static bool has_column(const loader *self, const char *name) {
  for (size_t i = 0; i < self->table->column_count; i++)
    if (is_called(&self->columns[i], name)) return true;
  return false;
}

/* `units: {NAME: UNIT}`, which the table keeps. */
static bool keep_units(loader *self, const strut_tree *map) {
  strut_reader *reader = self->reader;
  strut_data_table *table = self->table;
  const strut_owner owner = {"the units of data", table->name};
  strut_quantity q;
  bool fine = true;
  table->units = strut_keep_array(reader, 2 * map->count, sizeof(char *));
  for (const strut_tree *key = table->units ? map->first : NULL; key; key = key->next->next) {
    const char *unit = key->next->text;
    if (!strut_read_scalar(reader, key->next, key->text, owner, "a unit such as mm"))
      fine = false;
    else if (!strut_csv_is_dimensionless(unit) && !strut_csv_unit(unit, &q))
      fine = strut_report_error(
          reader, key->next->place, "expected a unit such as mm for '%s' of %s, found '%s'",
          strut_sanitised_text(reader, key->text), strut_owner_text(reader, owner),
          strut_sanitised_text(reader, unit));
    else if (!has_column(self, key->text))
      fine = refuse_column(self, key, key->text);
    if (!fine) continue;
    table->units[2 * table->unit_count] = strut_keep_text(reader, key->text);
    table->units[2 * table->unit_count++ + 1] = strut_keep_text(reader, unit);
  }
  return fine;
}

/* The power of ten that the number is, so that 0.1 mm has the bits of 1e-4; 0 where it is none. */
static int power_of_ten(double number) {
  for (int power = -30; power <= 30; power++) {
    double ten;
    if (strut_number_read_scaled("1", 1, power, &ten) && ten == number) return power;
  }
  return 0;
}

/* Sets the column's unit; what its numbers are to be multiplied by. */
static double find_unit(loader *self, size_t i, int *power) {
  const strut_data_table *table = self->table;
  strut_data_column *column = &self->columns[i];
  const char *unit = self->csv.titles[i].unit;
  strut_quantity q;
  bool whole = false; /* which takes precedence over the last part of a name */
  for (size_t k = 0; k < table->unit_count && !whole; k++)
    if (is_called(column, table->units[2 * k])) {
      unit = table->units[2 * k + 1];
      whole = strcmp(column->name, table->units[2 * k]) == 0;
    }
  *power = 0;
  if (strut_csv_is_dimensionless(unit) || (!*unit && is_called(column, "likelihood")))
    column->unit = "1";
  if (column->unit || !*unit || !strut_csv_unit(unit, &q)) return 1.0;
  column->unit = strut_keep_text(self->reader, unit);
  column->dimension = q.dimension;
  *power = power_of_ten(fabs(q.value));
  return *power ? copysign(1.0, q.value) : q.value;
}

/* A column's numbers; none where a cell is something else. */
static void read_numbers(loader *self, size_t i) {
  const strut_csv *csv = &self->csv;
  strut_data_column *column = &self->columns[i];
  size_t rows = self->table->row_count, skip = (size_t)self->table->skip;
  int power;
  double factor = find_unit(self, i, &power);
  double *values = strut_keep_array(self->reader, rows, sizeof *values);
  for (size_t k = 0; k < rows && values; k++) {
    const char *cell = csv->cell[(1 + skip + k) * csv->column_count + i];
    column->flaw = k;
    if (!strut_csv_number(cell, power, &values[k]) || isinf(values[k])) return;
    values[k] *= factor;
  }
  column->values = values;
}

static void find_range(strut_data_column *column, size_t rows) {
  column->least = column->most = (double)NAN;
  for (size_t k = 0; column->values && k < rows; k++) {
    column->least = fmin(column->least, column->values[k]);
    column->most = fmax(column->most, column->values[k]);
    column->gap_count += isnan(column->values[k]) ? 1 : 0;
  }
}

/* ---- coordinates ---- */

static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/* Where the name has an x or y that stands alone; NULL: nowhere. */
static const char *axis_in(const char *name) {
  for (const char *c = name + strlen(name); c-- > name;)
    if (strchr("xXyY", *c) && !is_letter(c[1]) && (c == name || !is_letter(c[-1]))) return c;
  return NULL;
}

/* A column of a length whose name has an axis. */
static bool is_coordinate(const strut_data_column *column) {
  return axis_in(column->name) && column->unit &&
         strut_dimension_equal(column->dimension, STRUT_DIM_LENGTH);
}

/* The numbers of the coordinate whose name has y where that of column i has x, or x where it has y; or NULL. */
static double *partner_of(const loader *self, size_t i) {
  const char *name = self->columns[i].name;
  size_t count = self->table->column_count;
  char *other = strut_arena_text(&self->reader->scratch, name, strlen(name));
  if (!other) self->reader->out_of_memory = true;
  if (!other) return NULL;
  other[axis_in(name) - name] ^= 'x' ^ 'y';
  size_t k = strut_row_find(STRUT_NAMED(self->columns, count), other);
  bool found = k < count && is_coordinate(&self->columns[k]);
  return found ? (double *)(uintptr_t)self->columns[k].values : NULL;
}

/* Scales or flips coordinates, turns pairs of them, and shifts them. */
static bool move(loader *self) {
  const strut_data_table *table = self->table;
  bool turns = table->rotate != 0.0;
  double s, c, factor[2];
  strut_sincos_turns(table->rotate / STRUT_TAU, &s, &c);
  for (int k = 0; k < 2; k++) factor[k] = table->flip >> k & 1u ? -table->scale : table->scale;
  for (size_t i = 0; i < table->column_count; i++) {
    if (!is_coordinate(&self->columns[i])) continue;
    int axis = *axis_in(self->columns[i].name) % 2; /* of "x" and "X" 0 */
    double *x = (double *)(uintptr_t)self->columns[i].values,
           *y = turns ? partner_of(self, i) : NULL;
    if (x && turns && !y)
      return strut_report_error(self->reader, value_of(self, STRUT_KEY_DATA_ROTATE)->place,
                                "column '%s' has no column of %c beside it to be turned with",
                                strut_sanitised_text(self->reader, self->columns[i].name),
                                axis ? 'x' : 'y');
    for (size_t k = 0; x && !(y && axis) && k < table->row_count; k++) {
      double along = x[k] * factor[axis], across = y ? y[k] * factor[1] : 0.0;
      x[k] = (y ? c * along - s * across : along) + table->shift[axis];
      if (y) y[k] = s * along + c * across + table->shift[1];
    }
  }
  return true;
}

/* Keys that move coordinates have none to move; `near`: a column that might be one, or NULL. */
static bool refuse_moves(loader *self, const char *near) {
  static const int keys[] = {STRUT_KEY_DATA_FLIP, STRUT_KEY_DATA_SCALE, STRUT_KEY_DATA_ROTATE,
                             STRUT_KEY_DATA_SHIFT};
  bool fine = true;
  for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
    const strut_slot *slot = strut_slot_of(&self->fields, keys[i]);
    if (slot->state != STRUT_GIVEN) continue;
    fine = strut_report_error(
        self->reader, slot->key->place,
        near ? "'%s' finds no coordinates in data '%s': '%s' would be one with a length as its "
               "unit, in the header, under 'units' or by a 'scale' such as 0.2 mm"
             : "'%s' finds no coordinates in data '%s': they are columns of lengths with an x or y "
               "that stands alone in their names, such as x, y2 or n1.x",
        slot->key->text, self->table->name, near ? strut_sanitised_text(self->reader, near) : "");
  }
  return fine;
}

/* Flips, scales, turns and shifts coordinates. False: that was reported. */
static bool place_coordinates(loader *self) {
  const strut_data_table *table = self->table;
  const char *near = NULL;
  bool any = false;
  for (size_t i = 0; i < table->column_count; i++) {
    strut_data_column *column = &self->columns[i];
    if (!axis_in(column->name)) continue;
    if (table->scale_unit && is_coordinate(column))
      return strut_report_error(self->reader, value_of(self, STRUT_KEY_DATA_SCALE)->place,
                                "column '%s' has a unit, expected a 'scale' without one for it",
                                strut_sanitised_text(self->reader, column->name));
    if (table->scale_unit && !column->unit)
      column->unit = "m", column->dimension = STRUT_DIM_LENGTH;
    any = any || is_coordinate(column);
    if (!near) near = column->name;
  }
  return any ? move(self) : refuse_moves(self, near);
}

/* ---- weights ---- */

/* Do these weights, which `weights` of the table names, belong to the column? */
static bool is_weighted(const strut_data_column *column, const strut_data_column *by,
                        const char *name) {
  const char *dot = strrchr(by->name, '.');
  if (column == by) return false;
  return strcmp(by->name, name) == 0 ||
         (dot && strncmp(column->name, by->name, (size_t)(dot - by->name) + 1) == 0);
}

static bool find_weights(loader *self) {
  strut_data_table *table = self->table;
  if (!*table->weights) return true;
  for (size_t i = 0; i < table->column_count; i++) {
    const strut_data_column *by = &self->columns[i];
    if (!is_called(by, table->weights)) continue;
    double *values = (double *)(uintptr_t)by->values;
    size_t k = values ? 0 : by->flaw;
    for (;
         values && k < table->row_count && !(values[k] < 0.0 || values[k] > STRUT_DATA_MOST_NUMBER);
         k++)
      if (isnan(values[k])) values[k] = 0.0;
    if (k < table->row_count)
      return strut_refuse_data(self->reader, value_of(self, STRUT_KEY_DATA_WEIGHTS), table, by, k,
                               "expected weights, numbers from 0 to 1e150");
    for (size_t c = 0; c < table->column_count; c++)
      if (is_weighted(&self->columns[c], by, table->weights)) self->columns[c].weights = values;
  }
  return has_column(self, table->weights) ||
         refuse_column(self, value_of(self, STRUT_KEY_DATA_WEIGHTS), table->weights);
}

/* ---- tables ---- */

/* Names the columns. False: two have one name, which was reported. */
static bool name_columns(loader *self) {
  for (size_t i = 0; i < self->table->column_count; i++) {
    const char *name = self->csv.titles[i].name;
    self->columns[i].name = strut_keep_text(self->reader, name);
    if (!*name || strut_row_find(STRUT_NAMED(self->csv.titles, i), name) == i) continue;
    report_in_file(self->reader, strut_csv_place(&self->csv, i),
                   show_file(self->reader, self->table), value_of(self, STRUT_KEY_DATA_FILE),
                   "an earlier column has this name too, give one of them another");
    return false;
  }
  return true;
}

static bool make_columns(loader *self) {
  strut_reader *reader = self->reader;
  strut_data_table *table = self->table;
  size_t count = self->csv.column_count;
  if ((size_t)table->skip >= self->csv.row_count)
    return strut_report_error(reader, value_of(self, STRUT_KEY_DATA_SKIP)->place,
                              "all rows are left out, expected a 'skip' below %zu, their number",
                              self->csv.row_count);
  self->columns = strut_keep_array(reader, count, sizeof *self->columns);
  if (!self->columns) return false;
  table->columns = self->columns, table->column_count = count;
  table->row_count = self->csv.row_count - (size_t)table->skip;
  if (!name_columns(self)) return false;
  const strut_tree *units = value_of(self, STRUT_KEY_DATA_UNITS);
  if (units && !keep_units(self, units)) return false;
  for (size_t i = 0; i < count; i++) read_numbers(self, i);
  if (!place_coordinates(self)) return false;
  for (size_t i = count; i-- > 0;) {
    const strut_data_column *column = &self->columns[i];
    find_range(&self->columns[i], table->row_count);
    if (column->values && column->unit && strut_dimension_equal(column->dimension, STRUT_DIM_TIME))
      table->time = (int32_t)i;
  }
  return find_weights(self);
}

bool strut_read_file_of(strut_reader *reader, const strut_tree *name, size_t most,
                        strut_safe_text *text) {
  const char *folder = strut_folder_of(reader->diagnostics->file, &reader->scratch);
  strut_error error = {0};
  strut_status status =
      folder
          ? strut_safe_read(folder, strut_diagnostics_text(reader->diagnostics, name->place).file,
                            name->text, most, text, &error)
          : STRUT_NO_MEMORY;
  if (status == STRUT_NO_MEMORY) reader->out_of_memory = true;
  return !status || strut_report_error(reader, name->place, "%s", error.message);
}

/* Reads the file, which the table keeps. */
static bool read_file(loader *self) {
  strut_reader *reader = self->reader;
  strut_data_table *table = self->table;
  const strut_tree *name = value_of(self, STRUT_KEY_DATA_FILE);
  strut_safe_text text = {0};
  if (!strut_read_file_of(reader, name, MOST_BYTES, &text)) return false;
  table->path = strut_keep_text(reader, text.path);
  table->text = strut_arena_text(reader->keep, text.text, text.length);
  strut_diagnostics own = {0};
  strut_status status = strut_csv_read(text.text, text.length, table->header, &own, &self->csv);
  if (status == STRUT_NO_MEMORY || !table->text) reader->out_of_memory = true;
  bool fine = status == STRUT_OK && table->text && make_columns(self);
  unsigned file = own.count && table->text ? show_file(reader, table) : 0;
  for (size_t i = 0; i < own.count; i++)
    report_in_file(reader, own.items[i].place, file, name, own.items[i].message);
  strut_arena_free(&self->csv.arena);
  strut_diagnostics_free(&own);
  strut_safe_text_free(&text);
  return fine;
}

/* A length for each unit of coordinates, or a factor. */
static bool read_scale(loader *self, strut_owner owner) {
  const strut_tree *value = value_of(self, STRUT_KEY_DATA_SCALE);
  strut_quantity q;
  if (!value) return true;
  if (!strut_read_any_quantity(self->reader, value, "scale", owner, "a number", &q)) return false;
  bool length = !q.bare && strut_dimension_equal(q.dimension, STRUT_DIM_LENGTH);
  self->table->scale = q.value;
  self->table->scale_unit = length ? "m" : NULL;
  if (!length && !q.bare)
    return strut_refuse_dimension(self->reader, value, "scale", owner,
                                  "a length such as '0.2 mm', or a factor,", q.dimension);
  return q.value > 0.0 || strut_report_error(self->reader, value->place,
                                             "'scale' of %s must be above zero, found %g",
                                             strut_owner_text(self->reader, owner), q.value);
}

static bool read_table(strut_reader *reader, const strut_tree *key, strut_data_table *table) {
  loader l = {.reader = reader, .table = table};
  strut_owner owner = {"data", key->text};
  *table = (strut_data_table)STRUT_DATA_USUAL;
  table->name = strut_keep_text(reader, key->text);
  bool fine = strut_read_name(reader, key, "table");
  if (fine && strchr(key->text, '.'))
    fine = strut_report_error(reader, key->place,
                              "a name of data has no dot: one ends it, as in film.x");
  strut_read_fields_of(reader, STRUT_SECTION_DATA, key, owner, &l.fields);
  strut_require(reader, &l.fields, key->place);
  fine = strut_store(reader, &l.fields, table) && fine && !l.fields.broken;
  return fine && read_scale(&l, owner) && read_file(&l);
}

void strut_read_data(strut_reader *reader, const strut_slot *slot) {
  reader->tables_unknown = slot->state == STRUT_BROKEN;
  if (slot->state != STRUT_GIVEN || reader->tables) return;
  strut_name_map parameters = reader->parameter_names;
  reader->parameter_names = (strut_name_map){0}; /* a file is read once for all their values */
  strut_data_table *tables = strut_keep_array(reader, slot->value->count, sizeof *tables);
  for (const strut_tree *key = tables ? slot->value->first : NULL; key; key = key->next->next) {
    bool fine = read_table(reader, key, &tables[reader->table_count]);
    reader->table_count += fine ? 1 : 0;
    reader->tables_unknown = reader->tables_unknown || !fine;
  }
  reader->tables = tables;
  reader->parameter_names = parameters;
}

void strut_read_scene_data(strut_reader *reader) {
  strut_read_data(reader, strut_slot_of(&reader->top, STRUT_KEY_SCENE_DATA));
  reader->scene->tables = reader->tables;
  reader->scene->table_count = reader->table_count;
}

/* ---- columns where they are used ---- */

/* Reports a name that is none. */
static void refuse_name(strut_reader *reader, const strut_tree *value, strut_owner owner,
                        const strut_data_table *table) {
  const char *dot = strchr(value->text, '.');
  const char *name = strut_arena_text(&reader->scratch, value->text, strcspn(value->text, "."));
  const strut_named_rows *rows = table ? STRUT_NAMED(table->columns, table->column_count)
                                       : STRUT_NAMED(reader->tables, reader->table_count);
  const char *word = table && dot ? dot + 1 : name, *hint = "";
  if (name) hint = strut_hint_of_rows(reader, word, rows);
  if (!*hint && table) hint = strut_list_names(reader, strut_row_name, rows);
  if (!*hint && value->place.file && !table)
    hint = "; a part takes none of its file: write them under 'data' of the scene that uses it";
  if (!name || (reader->tables_unknown && !table))
    reader->failed = true;
  else if (!dot)
    strut_report_error(reader, value->place, "expected a column such as film.x for %s, found '%s'",
                       strut_owner_text(reader, owner), strut_sanitised_text(reader, value->text));
  else if (table)
    strut_report_error(reader, value->place, "data '%s' have no column '%s'%s", table->name,
                       strut_sanitised_text(reader, dot + 1), hint);
  else
    strut_report_error(reader, value->place, "unknown data '%s' for %s%s",
                       strut_sanitised_text(reader, name), strut_owner_text(reader, owner), hint);
}

const strut_data_column *strut_read_data_column(strut_reader *reader, const strut_tree *value,
                                                const char *key, strut_owner owner,
                                                const strut_dimension *expected,
                                                const strut_data_table **table) {
  char message[500], wanted[200], found[80];
  size_t row = SIZE_MAX;
  if (!strut_read_scalar(reader, value, key, owner, "a column such as film.x")) return NULL;
  const strut_data_column *column =
      strut_data_find(reader->tables, reader->table_count, value->text, table);
  if (!column) refuse_name(reader, value, owner, *table);
  if (!column) return NULL;
  const char *name = strut_sanitised_text(reader, column->name);
  const char *unit = expected && !strut_dimension_equal(*expected, STRUT_DIM_LENGTH)
                         ? strut_dimension_unit(*expected)
                         : "mm";
  if (!column->values) {
    row = column->flaw;
    snprintf(message, sizeof message, "expected a finite number");
  } else if (!column->unit) {
    snprintf(message, sizeof message,
             "column '%s' has no unit that is known; write it in the header, '%s [%s]', or under "
             "'units' of the data, {%s: %s}; 1: none",
             name, name, unit, name, unit);
  } else if (expected && !strut_dimension_equal(column->dimension, *expected)) {
    strut_expected_quantity(key, *expected, wanted, sizeof wanted);
    snprintf(message, sizeof message, "expected %s for '%s' of %s, found the unit '%s' of %s",
             wanted, key, strut_owner_text(reader, owner), column->unit,
             strut_dimension_name(column->dimension, found, sizeof found));
  } else {
    return column;
  }
  strut_refuse_data(reader, value, *table, column, row, message);
  return NULL;
}
