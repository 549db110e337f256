/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of measured data, and their columns where they are used. See reader.h. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/read/csv.h"
#include "parser/language/read/reader.h"
#include "parser/language/read/reuse/used_files.h"

enum { MOST_BYTES = 1 << 28, LONGEST_UNIT = 100 };

/* A table being read. */
typedef struct loader {
  strut_reader *reader;
  const strut_tree *key; /* its name */
  strut_fields fields;
  strut_data_table *table;
  strut_data_column *columns;
  strut_csv csv;
} loader;

/* ---- files, and messages about their cells ---- */

static strut_status open_file(strut_reader *reader, const strut_data_table *table,
                              strut_safe_text *text, strut_error *error) {
  const char *folder = strut_folder_of(reader->diagnostics->file, &reader->scratch);
  if (!folder) return STRUT_NO_MEMORY;
  return strut_safe_read(folder, table->naming, table->file, MOST_BYTES, text, error);
}

/* Shows the text in messages from now on; it takes the text over. Its number for places, or 0. */
static unsigned show_file(strut_reader *reader, strut_safe_text *text) {
  unsigned number =
      strut_diagnostics_use(reader->diagnostics, text->path, text->text, text->length);
  if (number) strut_diagnostics_own(reader->diagnostics, number, text->text);
  if (number) text->text = NULL;
  return number;
}

/* Reports about a place in the file, which `used` names. */
static void report_in_file(strut_reader *reader, strut_place place, const strut_tree *used,
                           const char *message) {
  size_t before = reader->diagnostics->count;
  strut_report_error(reader, place.file ? place : used->place, "%s", message);
  if (place.file && reader->diagnostics->count > before)
    strut_diagnose_note(reader->diagnostics, before, used->place, "the data are used here");
}

/* Adds the messages of the reader of tables. */
static void take_messages(loader *self, const strut_diagnostics *own, strut_safe_text *text) {
  const strut_tree *name = strut_slot_of(&self->fields, STRUT_KEY_DATA_FILE)->value;
  unsigned number = show_file(self->reader, text);
  for (size_t i = 0; i < own->count; i++) {
    strut_place place = own->items[i].place;
    place.file = number & 0xFFu;
    report_in_file(self->reader, place, name, own->items[i].message);
  }
}

/* The file again, for a message about a cell of it. */
static strut_place place_of(strut_reader *reader, const strut_data_table *table, size_t column,
                            size_t row) {
  strut_safe_text text = {0};
  strut_error error = {0};
  strut_diagnostics unused = {0};
  strut_csv csv = {.row_count = 0};
  strut_place place = {.line = 0};
  bool fine = open_file(reader, table, &text, &error) == STRUT_OK &&
              strut_csv_read(text.text, text.length, table->header, &unused, &csv) == STRUT_OK;
  size_t line = row == SIZE_MAX ? 0 : 1 + row + (size_t)table->skip;
  if (fine && line <= csv.row_count && column < csv.column_count) {
    place = strut_csv_place(&csv, line * csv.column_count + column);
    place.file = show_file(reader, &text) & 0xFFu;
  }
  strut_arena_free(&csv.arena);
  strut_diagnostics_free(&unused);
  strut_safe_text_free(&text);
  return place;
}

bool strut_refuse_data(strut_reader *reader, const strut_tree *value, const strut_data_table *table,
                       const strut_data_column *column, size_t row, const char *message) {
  strut_place place = {.line = 0};
  if (!strut_diagnostics_full(reader->diagnostics))
    place = place_of(reader, table, (size_t)(column - table->columns), row);
  report_in_file(reader, place, value, message);
  return false;
}

/* ---- units ---- */

/* The name of the column, or what follows its last dot? */
static bool is_called(const char *column, const char *name) {
  const char *dot = strrchr(column, '.');
  return strcmp(column, name) == 0 || (dot && strcmp(dot + 1, name) == 0);
}

/* What one of a unit is, "mm" or "1/(240 Hz)". False: the text is none. */
static bool read_unit(const char *text, strut_quantity *quantity) {
  char whole[LONGEST_UNIT + 10];
  strut_expression_error error;
  if (strlen(text) > LONGEST_UNIT) return false;
  snprintf(whole, sizeof whole, "1 %s", text);
  return strut_expression_evaluate(whole, NULL, quantity, &error) ||
         (strut_expression_evaluate(text, NULL, quantity, &error) && quantity->value > 0.0);
}

static bool is_dimensionless(const char *text) {
  return strcmp(text, "1") == 0 || strcmp(text, "-") == 0;
}

/* `units: {NAME: UNIT}`, which the table keeps. */
static bool keep_units(loader *self, const strut_tree *map) {
  strut_reader *reader = self->reader;
  strut_data_table *table = self->table;
  const strut_owner owner = {"the units of data", table->name};
  bool fine = true;
  table->units = strut_reader_allocate(reader, reader->keep, 2 * map->count, sizeof(char *));
  for (const strut_tree *key = table->units ? map->first : NULL; key; key = key->next->next) {
    strut_quantity q;
    const char *text = key->next->text;
    if (!strut_read_scalar(reader, key->next, key->text, owner, "a unit such as mm"))
      fine = false;
    else if (!is_dimensionless(text) && !read_unit(text, &q))
      fine = strut_report_error(
          reader, key->next->place, "expected a unit such as mm for '%s' of %s, found '%s'",
          strut_sanitised_text(reader, key->text), strut_owner_text(reader, owner),
          strut_sanitised_text(reader, text));
    bool known = !self->columns;
    for (size_t i = 0; i < table->column_count; i++)
      known = known || is_called(self->columns[i].name, key->text);
    if (!known)
      fine = strut_report_error(reader, key->place, "'%s' has no column '%s'",
                                strut_sanitised_text(reader, table->file),
                                strut_sanitised_text(reader, key->text));
    if (!fine) continue;
    table->units[2 * table->unit_count] = strut_keep_text(reader, key->text);
    table->units[2 * table->unit_count++ + 1] = strut_keep_text(reader, text);
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

/* Sets the column's unit and the factor of its numbers. */
static void find_unit(loader *self, size_t i, double *factor, int *power) {
  const strut_data_table *table = self->table;
  strut_data_column *column = &self->columns[i];
  strut_quantity q;
  const char *unit = self->csv.titles[i].unit;
  for (size_t k = 0; k < table->unit_count; k++)
    if (is_called(column->name, table->units[2 * k])) unit = table->units[2 * k + 1];
  for (size_t k = 0; k < table->unit_count; k++) /* the whole name takes precedence */
    if (strcmp(column->name, table->units[2 * k]) == 0) unit = table->units[2 * k + 1];
  *factor = 1.0, *power = 0;
  if (is_dimensionless(unit)) {
    column->unit = "1";
  } else if (*unit && read_unit(unit, &q)) {
    column->unit = strut_keep_text(self->reader, unit);
    column->dimension = q.dimension;
    *power = power_of_ten(q.value);
    if (!*power) *factor = q.value;
  } else if (is_called(column->name, "likelihood")) {
    column->unit = "1";
  }
}

/* ---- numbers ---- */

/* A column's numbers; none where a cell is something else. */
static void read_numbers(loader *self, size_t i) {
  const strut_csv *csv = &self->csv;
  size_t rows = self->table->row_count, skip = (size_t)self->table->skip;
  double factor;
  int power;
  find_unit(self, i, &factor, &power);
  double *values = strut_reader_allocate(self->reader, self->reader->keep, rows, sizeof *values);
  for (size_t k = 0; k < rows && values; k++) {
    const char *cell = csv->cell[(1 + skip + k) * csv->column_count + i];
    self->columns[i].flaw = k;
    if (!strut_csv_number(cell, power, &values[k]) || isinf(values[k])) return;
    values[k] *= factor;
  }
  self->columns[i].values = values;
}

static void find_range(strut_data_column *column, size_t rows) {
  column->least = column->most = (double)NAN;
  for (size_t k = 0; column->values && k < rows; k++) {
    double value = column->values[k];
    column->gap_count += isnan(value) ? 1 : 0;
    if (!(value >= column->least)) column->least = isnan(value) ? column->least : value;
    if (!(value <= column->most)) column->most = isnan(value) ? column->most : value;
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

/* The numbers of the column if it is a coordinate, of x (0) or y, that is a length; else NULL. */
static double *coordinate(const loader *self, size_t i, int *axis) {
  strut_data_column *column = &self->columns[i];
  const char *at = axis_in(column->name);
  if (!at || !column->values || !column->unit ||
      !strut_dimension_equal(column->dimension, STRUT_DIM_LENGTH))
    return NULL;
  *axis = *at == 'y' || *at == 'Y';
  return (double *)(uintptr_t)column->values;
}

/* The column whose name has y where that of x column i has x; SIZE_MAX: none. */
static size_t partner_of(const loader *self, size_t i) {
  const char *name = self->columns[i].name;
  size_t at = (size_t)(axis_in(name) - name);
  for (size_t k = 0; k < self->table->column_count; k++) {
    const char *other = self->columns[k].name;
    if (strlen(other) == strlen(name) && strncmp(other, name, at) == 0 &&
        other[at] == name[at] + 1 && strcmp(other + at + 1, name + at + 1) == 0)
      return k;
  }
  return SIZE_MAX;
}

/* Coordinates without unit become lengths; others take a factor. False: that was reported. */
static bool scale_coordinates(loader *self) {
  const strut_data_table *table = self->table;
  const strut_slot *slot = strut_slot_of(&self->fields, STRUT_KEY_DATA_SCALE);
  for (size_t i = 0; slot->state == STRUT_GIVEN && i < table->column_count; i++) {
    strut_data_column *column = &self->columns[i];
    int axis;
    if (!axis_in(column->name) || !column->values) continue;
    if (table->scale_unit && !column->unit) {
      column->unit = "m";
      column->dimension = STRUT_DIM_LENGTH;
    } else if (table->scale_unit && coordinate(self, i, &axis)) {
      return strut_report_error(self->reader, slot->value->place,
                                "column '%s' has a unit, expected a 'scale' without one for it",
                                strut_sanitised_text(self->reader, column->name));
    }
    double *values = coordinate(self, i, &axis);
    for (size_t k = 0; values && k < table->row_count; k++) values[k] *= table->scale;
  }
  return true;
}

static void rotate(const loader *self, double *x, double *y) {
  double s, c;
  strut_sincos_turns(self->table->rotate / STRUT_TAU, &s, &c);
  for (size_t k = 0; k < self->table->row_count; k++) {
    double before = x[k];
    x[k] = c * before - s * y[k];
    y[k] = s * before + c * y[k];
  }
}

/* Flips, scales, turns and shifts coordinates. False: that was reported. */
static bool place_coordinates(loader *self) {
  const strut_data_table *table = self->table;
  int axis, other;
  if (!scale_coordinates(self)) return false;
  for (size_t i = 0; i < table->column_count; i++) {
    double *values = coordinate(self, i, &axis);
    bool flips = values && (table->flip >> axis & 1u);
    for (size_t k = 0; flips && k < table->row_count; k++) values[k] = -values[k];
  }
  for (size_t i = 0; table->rotate != 0.0 && i < table->column_count; i++) {
    double *values = coordinate(self, i, &axis);
    if (!values || axis) continue;
    size_t partner = partner_of(self, i);
    double *beside = partner == SIZE_MAX ? NULL : coordinate(self, partner, &other);
    if (!beside)
      return strut_report_error(self->reader,
                                strut_slot_of(&self->fields, STRUT_KEY_DATA_ROTATE)->value->place,
                                "column '%s' has no column of y beside it to be turned with",
                                strut_sanitised_text(self->reader, self->columns[i].name));
    rotate(self, values, beside);
  }
  for (size_t i = 0; i < table->column_count; i++) {
    double *values = coordinate(self, i, &axis);
    for (size_t k = 0; values && k < table->row_count; k++) values[k] += table->shift[axis];
  }
  return true;
}

/* ---- weights ---- */

/* The column has these weights. */
static bool is_weighted_by(const char *column, const char *weights, const char *name) {
  const char *dot = strrchr(weights, '.');
  size_t owner = dot ? (size_t)(dot - weights) + 1 : 0;
  return strcmp(weights, name) == 0 || strncmp(column, weights, owner) == 0;
}

static bool find_weights(loader *self) {
  strut_reader *reader = self->reader;
  strut_data_table *table = self->table;
  const strut_slot *slot = strut_slot_of(&self->fields, STRUT_KEY_DATA_WEIGHTS);
  size_t found = 0;
  for (size_t i = 0; slot->state == STRUT_GIVEN && i < table->column_count; i++) {
    const strut_data_column *weights = &self->columns[i];
    if (!is_called(weights->name, table->weights)) continue;
    double *values = (double *)(uintptr_t)weights->values;
    size_t bad = 0;
    while (values && bad < table->row_count && !(values[bad] < 0.0)) bad++;
    if (!values || bad < table->row_count)
      return strut_refuse_data(reader, slot->value, table, weights, values ? bad : SIZE_MAX,
                               "expected weights, numbers that are not negative");
    for (size_t k = 0; k < table->row_count; k++)
      if (isnan(values[k])) values[k] = 0.0;
    for (size_t k = 0; k < table->column_count; k++)
      if (k != i && is_weighted_by(self->columns[k].name, weights->name, table->weights))
        self->columns[k].weights = values;
    found++;
  }
  if (slot->state != STRUT_GIVEN || found) return true;
  return strut_report_error(reader, slot->value->place, "'%s' has no column '%s'",
                            strut_sanitised_text(reader, table->file),
                            strut_sanitised_text(reader, table->weights));
}

/* ---- tables ---- */

static bool make_columns(loader *self) {
  strut_reader *reader = self->reader;
  strut_data_table *table = self->table;
  const strut_slot *units = strut_slot_of(&self->fields, STRUT_KEY_DATA_UNITS);
  if ((size_t)table->skip >= self->csv.row_count)
    return strut_report_error(
        reader, strut_slot_of(&self->fields, STRUT_KEY_DATA_SKIP)->value->place,
        "all rows are left out, expected a 'skip' below %zu, their number", self->csv.row_count);
  self->columns =
      strut_reader_allocate(reader, reader->keep, self->csv.column_count, sizeof *self->columns);
  table->columns = self->columns;
  table->row_count = self->csv.row_count - (size_t)table->skip;
  table->column_count = self->columns ? self->csv.column_count : 0;
  for (size_t i = 0; i < table->column_count; i++) {
    self->columns[i].name = strut_keep_text(reader, self->csv.titles[i].name);
    for (size_t k = 0; k < i; k++)
      if (strcmp(self->columns[k].name, self->columns[i].name) == 0)
        self->columns[i].doubled = true;
  }
  if (units->state == STRUT_GIVEN && !keep_units(self, units->value)) return false;
  for (size_t i = 0; i < table->column_count; i++) read_numbers(self, i);
  if (!place_coordinates(self)) return false;
  for (size_t i = 0; i < table->column_count; i++) {
    find_range(&self->columns[i], table->row_count);
    bool time = self->columns[i].values && self->columns[i].unit &&
                strut_dimension_equal(self->columns[i].dimension, STRUT_DIM_TIME);
    if (time && table->time < 0) table->time = (int32_t)i;
  }
  return find_weights(self);
}

static bool read_file(loader *self) {
  strut_reader *reader = self->reader;
  const strut_tree *name = strut_slot_of(&self->fields, STRUT_KEY_DATA_FILE)->value;
  strut_safe_text text = {0};
  strut_error error = {0};
  strut_diagnostics own = {0};
  strut_status status = open_file(reader, self->table, &text, &error);
  if (status == STRUT_NO_MEMORY) reader->out_of_memory = true;
  if (status) return strut_report_error(reader, name->place, "%s", error.message);
  status = strut_csv_read(text.text, text.length, self->table->header, &own, &self->csv);
  if (status == STRUT_NO_MEMORY) reader->out_of_memory = true;
  bool fine = status == STRUT_OK && make_columns(self);
  if (status == STRUT_BAD_SCENE) take_messages(self, &own, &text);
  strut_arena_free(&self->csv.arena);
  strut_diagnostics_free(&own);
  strut_safe_text_free(&text);
  return fine;
}

/* A length for each unit of coordinates, or a factor. */
static bool read_scale(loader *self, strut_owner owner) {
  const strut_slot *slot = strut_slot_of(&self->fields, STRUT_KEY_DATA_SCALE);
  strut_quantity q;
  if (slot->state != STRUT_GIVEN) return true;
  if (!strut_read_any_quantity(self->reader, slot->value, "scale", owner, "a number", &q))
    return false;
  bool length = !q.bare && strut_dimension_equal(q.dimension, STRUT_DIM_LENGTH);
  self->table->scale = q.value;
  self->table->scale_unit = length ? "m" : NULL;
  if (!length && !q.bare)
    return strut_refuse_dimension(self->reader, slot->value, "scale", owner,
                                  "a length such as '0.2 mm', or a factor,", q.dimension);
  if (q.value > 0.0) return true;
  return strut_report_error(self->reader, slot->value->place,
                            "'scale' of %s must be above zero, found %g",
                            strut_owner_text(self->reader, owner), q.value);
}

static bool read_table(strut_reader *reader, const strut_tree *key, strut_data_table *table) {
  loader l = {.reader = reader, .key = key, .table = table};
  strut_owner owner = {"data", key->text};
  const strut_place place = key->place;
  *table = (strut_data_table)STRUT_DATA_USUAL;
  table->name = strut_keep_text(reader, key->text);
  table->naming = strut_keep_text(reader, strut_diagnostics_file(reader->diagnostics, place));
  bool fine = strut_read_name(reader, key, "table");
  if (fine && strchr(key->text, '.'))
    fine =
        strut_report_error(reader, place, "a name of data has no dot: one ends it, as in film.x");
  strut_read_fields_of(reader, STRUT_SECTION_DATA, key, owner, &l.fields);
  strut_require(reader, &l.fields, owner, place);
  fine = strut_store(reader, &l.fields, owner, table) && read_scale(&l, owner) && fine;
  return fine && !l.fields.broken && read_file(&l);
}

void strut_read_data(strut_reader *reader, const strut_slot *slot) {
  if (slot->state == STRUT_ABSENT) return;
  reader->tables_unknown = slot->state == STRUT_BROKEN;
  if (reader->tables || slot->state == STRUT_BROKEN) return;
  /* a file is read once for all values of parameters */
  strut_name_map parameters = reader->parameter_names;
  reader->parameter_names = (strut_name_map){0};
  strut_data_table *tables =
      strut_reader_allocate(reader, reader->keep, slot->value->count, sizeof *tables);
  for (const strut_tree *key = tables ? slot->value->first : NULL; key; key = key->next->next) {
    if (read_table(reader, key, &tables[reader->table_count]))
      reader->table_count++;
    else
      reader->tables_unknown = true;
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

/* Structs of that size, each with its name first. */
typedef struct names {
  const char *first;
  size_t count, size;
} names;

static const char *name_at(const void *context, size_t i) {
  const names *self = context;
  const char *name = NULL;
  if (i < self->count) memcpy(&name, self->first + i * self->size, sizeof name);
  return name;
}

/* Reports a name that is none. */
static void refuse_name(strut_reader *reader, const strut_tree *value, strut_owner owner,
                        const strut_data_table *table) {
  const names columns = {(const char *)(table ? table->columns : NULL),
                         table ? table->column_count : 0, sizeof *table->columns};
  const names tables = {(const char *)reader->tables, reader->table_count, sizeof *table};
  const char *dot = strchr(value->text, '.'), *text = value->text;
  if (reader->tables_unknown && !table) {
    reader->failed = true;
  } else if (!dot) {
    strut_report_error(reader, value->place, "expected a column such as film.x for %s, found '%s'",
                       strut_owner_text(reader, owner), strut_sanitised_text(reader, text));
  } else if (table) {
    strut_report_error(reader, value->place, "data '%s' have no column '%s'%s", table->name,
                       strut_sanitised_text(reader, dot + 1),
                       strut_hint(reader, dot + 1, name_at, &columns, columns.count));
  } else {
    const char *first = strut_arena_text(&reader->scratch, text, (size_t)(dot - text));
    strut_report_error(reader, value->place, "unknown data '%s' for %s%s",
                       strut_sanitised_text(reader, first ? first : ""),
                       strut_owner_text(reader, owner),
                       strut_hint(reader, first ? first : "", name_at, &tables, tables.count));
  }
}

const strut_data_column *strut_read_data_column(strut_reader *reader, const strut_tree *value,
                                                const char *key, strut_owner owner,
                                                const strut_dimension *expected,
                                                const strut_data_table **table) {
  char message[500], wanted[200], found[80];
  if (!strut_read_scalar(reader, value, key, owner, "a column such as film.x")) return NULL;
  const strut_data_column *column =
      strut_data_find(reader->tables, reader->table_count, value->text, table);
  if (!column) {
    refuse_name(reader, value, owner, *table);
    return NULL;
  }
  const char *name = strut_sanitised_text(reader, column->name);
  for (const strut_data_column *other = column; other < (*table)->columns + (*table)->column_count;
       other++)
    if (other->doubled && strcmp(other->name, column->name) == 0) {
      snprintf(message, sizeof message, "two columns are called '%s'", name);
      strut_refuse_data(reader, value, *table, other, SIZE_MAX, message);
      return NULL;
    }
  if (!column->values) {
    strut_refuse_data(reader, value, *table, column, column->flaw, "expected a finite number");
    return NULL;
  }
  bool fits = column->unit && (!expected || strut_dimension_equal(column->dimension, *expected));
  if (fits) return column;
  if (column->unit) {
    strut_expected_quantity(key, *expected, wanted, sizeof wanted);
    snprintf(message, sizeof message, "expected %s for '%s' of %s, found the unit '%s' of %s",
             wanted, key, strut_owner_text(reader, owner), column->unit,
             strut_dimension_name(column->dimension, found, sizeof found));
  } else {
    snprintf(message, sizeof message,
             "column '%s' has no unit that is known; write it in the header, '%s [mm]', or under "
             "'units' of the data, {%s: mm}; 1: none",
             name, name, name);
  }
  strut_refuse_data(reader, value, *table, column, SIZE_MAX, message);
  return NULL;
}
