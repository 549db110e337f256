/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Axes of several parameters: files of points, samples, sensitivity analyses. See study_reader.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/scene/sample.h"
#include "parser/language/read/csv.h"
#include "parser/language/study/study_reader.h"
#include "parser/language/yaml/text.h"

/* ---- points from a file ---- */

enum { MOST_ROWS = 1000000, MOST_WORD = 24 };

/* A file of points being read. */
typedef struct table {
  strut_study_reader *r;
  const strut_tree *name;    /* of the file */
  const strut_tree *columns; /* the list of those to use, or NULL: all */
  strut_csv csv;
  unsigned file; /* its number in places; 0: it has none */
} table;

static bool has_key(const strut_tree *map, const char *key) {
  return map->kind == STRUT_TREE_MAP && strut_tree_find(map, key, NULL);
}

/* The value of an item {NAME: value}, or NULL. */
static const strut_tree *only_value(const strut_tree *item, const char *name) {
  if (item->kind != STRUT_TREE_MAP || item->count != 1) return NULL;
  return strcmp(item->first->text, name) == 0 ? item->first->next : NULL;
}

bool strut_study_is_points(const strut_study_reader *reader, const strut_tree *item) {
  const strut_tree *value = only_value(item, "points");
  if (!value) return false;
  return value->kind == STRUT_TREE_SCALAR || has_key(value, "file") ||
         !strut_study_declared(reader, "points");
}

/* The place of a cell, or that of the file's name. */
static strut_place place_of(const table *self, size_t cell) {
  strut_place place = strut_csv_place(&self->csv, cell);
  place.file = self->file & 0xFFu;
  return self->file ? place : self->name->place;
}

/* Is the column to be used? */
static bool is_wanted(const table *self, const char *name) {
  for (const strut_tree *item = self->columns ? self->columns->first : NULL; item;
       item = item->next)
    if (strcmp(item->text, name) == 0) return true;
  return !self->columns && strut_word_find(STRUT_STUDY_OWN_COLUMNS, name) < 0;
}

/* Reports wanted columns that the file does not have. */
static void check_columns(table *self) {
  for (const strut_tree *item = self->columns ? self->columns->first : NULL; item;
       item = item->next) {
    const size_t count = self->csv.column_count;
    if (strut_row_find(STRUT_NAMED(self->csv.titles, count), item->text) == count)
      strut_report_error(self->r->reader, item->place, "'%s' has no column '%s'",
                         strut_sanitised_text(self->r->reader, self->name->text),
                         strut_sanitised_text(self->r->reader, item->text));
  }
}

/* A plain number with the column's unit; the whole text is read as one, so that 0.1 mm has its bits. */
static bool read_number(const char *text, const char *unit, strut_quantity *quantity) {
  char whole[200];
  double plain;
  strut_expression_error error;
  if (!strut_csv_number(text, 0, &plain) || !isfinite(plain)) return false;
  int n = snprintf(whole, sizeof whole, "%s %s", *text == '+' ? text + 1 : text, unit);
  return n > 0 && (size_t)n < sizeof whole &&
         strut_expression_evaluate(whole, NULL, quantity, &error);
}

/* The unit of a column: "" for none. False where that was reported. */
static bool check_unit(table *self, size_t i, const strut_study_along *along, const char **unit) {
  char expected[200];
  strut_quantity q;
  strut_setting *setting = along->setting;
  const char *title = self->csv.titles[i].unit;
  *unit = strcmp(title, "1") == 0 ? "" : title;
  if (!**unit) return true;
  bool known = !along->parameter->text && read_number("1", *unit, &q);
  if (known && setting->bare && !q.bare) {
    setting->bare = false;
    setting->dimension = q.dimension;
    along->column->unit = strut_dimension_unit(q.dimension);
  }
  if (known && !q.bare && strut_dimension_equal(q.dimension, setting->dimension)) return true;
  strut_report_error(
      self->r->reader, place_of(self, i), "expected %s in column '%s', found the unit '%s'",
      along->parameter->text ? "texts"
      : setting->bare        ? "a unit"
                             : strut_expected_number(setting->dimension, expected, sizeof expected),
      along->parameter->name, strut_sanitised_text(self->r->reader, title));
  return false;
}

/* Is it a text that a scene may have? */
static bool is_text(const char *text) {
  for (size_t left = strlen(text); left > 0;) {
    uint32_t code;
    size_t bytes = strut_text_decode(text, left, &code);
    if (code == STRUT_BAD_CODE || code < ' ' || strut_text_forbidden(code)) return false;
    text += bytes;
    left -= bytes;
  }
  return true;
}

static void refuse_cell(table *self, size_t cell, const strut_study_along *along) {
  const char *text = self->csv.cell[cell];
  const char *quote = *text ? "'" : "";
  strut_report_error(self->r->reader, place_of(self, cell), "expected %s for '%s', found %s%s%s",
                     along->parameter->text ? "a text of 1 to 23 bytes" : "a number",
                     along->parameter->name, quote,
                     *text ? strut_sanitised_text(self->r->reader, text) : "an empty cell", quote);
}

/* The cells of column i. */
static void read_cells(table *self, size_t i, const strut_study_along *along, const char *unit) {
  strut_arena *arena = &self->r->file->arena;
  size_t rows = self->csv.row_count;
  bool text = along->parameter->text;
  double *numbers = text ? NULL : strut_study_allocate(self->r, rows, sizeof *numbers);
  const char **words = text ? strut_study_allocate(self->r, rows, sizeof *words) : NULL;
  if (!numbers && !words) return;
  for (size_t k = 0; k < rows && !strut_diagnostics_full(self->r->reader->diagnostics); k++) {
    size_t cell = (k + 1) * self->csv.column_count + i, length = strlen(self->csv.cell[cell]);
    strut_quantity q = {.value = 0.0};
    bool fine = text ? length > 0 && length < MOST_WORD && is_text(self->csv.cell[cell])
                     : read_number(self->csv.cell[cell], unit, &q);
    if (!fine) {
      refuse_cell(self, cell, along);
    } else if (text) {
      words[k] = strut_arena_text(arena, self->csv.cell[cell], length);
      if (!words[k]) self->r->reader->out_of_memory = true;
    } else {
      numbers[k] = q.value;
    }
  }
  along->column->kind = STRUT_RANGE_LIST;
  along->column->number = numbers;
  along->column->words = words;
}

static void read_column(table *self, size_t i, strut_study_axis *axis) {
  const strut_tree cell = {.text = self->csv.titles[i].name, .place = place_of(self, i)};
  strut_study_along a = {.key = &cell};
  const char *unit = "";
  if (!self->columns) a.advice = "; {points: {file: ..., columns: [...]}} chooses columns";
  if (!strut_study_begin_along(self->r, axis, &a)) return;
  a.setting->place = self->name->place;
  if (!check_unit(self, i, &a, &unit)) return;
  read_cells(self, i, &a, unit);
  strut_arena *arena = &self->r->file->arena;
  const char *one = *unit ? strut_arena_format(arena, "1 %s", unit) : NULL;
  if (one) a.column->shown = strut_unit_of_text(one, NULL);
}

static void read_columns(table *self, strut_study_axis *axis) {
  strut_study_reader *reader = self->r;
  size_t before = reader->reader->diagnostics->count;
  check_columns(self);
  if (self->csv.row_count > MOST_ROWS) {
    strut_report_error(reader->reader, self->name->place,
                       "'%s' has %zu rows, a file of points may have 1e6",
                       strut_sanitised_text(reader->reader, self->name->text), self->csv.row_count);
    return;
  }
  axis->columns = strut_study_allocate(reader, reader->declared_count + 1, sizeof *axis->columns);
  if (!axis->columns) return;
  axis->count = (int64_t)self->csv.row_count;
  for (size_t i = 0; i < self->csv.column_count; i++)
    if (is_wanted(self, self->csv.titles[i].name)) read_column(self, i, axis);
  if (axis->column_count == 0 && reader->reader->diagnostics->count == before)
    strut_report_error(reader->reader, self->name->place,
                       "'%s' has no column of a parameter of the model",
                       strut_sanitised_text(reader->reader, self->name->text));
}

static void read_file(table *self, strut_study_axis *axis) {
  strut_study_file *file = self->r->file;
  strut_reader *reader = self->r->reader;
  strut_diagnostics *messages = reader->diagnostics;
  strut_study_points *points = &file->tables[file->table_count];
  size_t before = messages->count;
  points->node = self->name;
  points->copy = strut_arena_format(&file->arena, "points-%zu.csv", file->table_count + 1);
  if (!points->copy) reader->out_of_memory = true;
  if (!points->copy || !strut_read_file_of(reader, self->name, STRUT_TEXT_MOST, &points->file))
    return;
  file->table_count++;
  const strut_safe_text *text = &points->file;
  self->file = strut_diagnostics_use(messages, text->path, text->text, text->length);
  strut_status status =
      strut_csv_read(text->text, text->length, STRUT_CSV_ANY_HEADER, messages, &self->csv);
  for (size_t i = before; i < messages->count; i++) {
    strut_place *place = &messages->items[i].place;
    place->file = self->file & 0xFFu;
    if (!self->file) *place = self->name->place;
  }
  if (status == STRUT_BAD_SCENE) reader->failed = true;
  if (status == STRUT_NO_MEMORY) reader->out_of_memory = true;
  if (status == STRUT_OK) read_columns(self, axis);
  strut_arena_free(&self->csv.arena);
}

void strut_study_read_points(strut_study_reader *reader, const strut_tree *value,
                             strut_study_axis *axis) {
  const strut_owner owner = {"the file of points", NULL};
  table t = {.r = reader, .name = value};
  if (value->kind == STRUT_TREE_MAP) {
    strut_fields fields;
    strut_points_keys keys = {0};
    if (!strut_read_object(reader->reader, STRUT_SECTION_POINTS, value, owner, &fields, &keys))
      return;
    t.name = keys.file, t.columns = keys.columns;
    for (const strut_tree *item = t.columns ? t.columns->first : NULL; item; item = item->next)
      if (!strut_read_scalar(reader->reader, item, "columns", owner, "a column's name")) return;
  }
  if (strut_read_scalar(reader->reader, t.name, "points", owner, "the path of a CSV file"))
    read_file(&t, axis);
}

/* ---- samples of distributions ---- */

static const strut_owner sample_owner = {"the sample", NULL};

bool strut_study_is_sample(const strut_study_reader *reader, const strut_tree *item) {
  const strut_tree *value = only_value(item, "sample");
  return value && (has_key(value, "over") || !strut_study_declared(reader, "sample"));
}

/* Numbers of a distribution; the last one of a lognormal one has no unit. */
static bool read_numbers(strut_study_reader *reader, strut_study_along *along,
                         const strut_slot *slot, strut_distribution *distribution) {
  size_t wanted = distribution->kind == STRUT_DISTRIBUTION_TRIANGULAR ? 3 : 2, i = 0;
  const char *name = slot->key->text;
  const strut_owner owner = {"parameter", along->parameter->name};
  bool fine = true;
  if (slot->value->count != wanted)
    return strut_report_error(
        reader->reader, slot->value->place, "expected %zu numbers for '%s' of %s, found %s", wanted,
        name, strut_owner_text(reader->reader, owner), strut_found(reader->reader, slot->value));
  for (const strut_tree *item = slot->value->first; item; item = item->next, i++) {
    bool bare = distribution->kind == STRUT_DISTRIBUTION_LOGNORMAL && i == 1;
    bool read =
        bare ? strut_read_number(reader->reader, item, name, owner, STRUT_DIM_NONE,
                                 STRUT_WITHIN(ANY), &distribution->number[i])
             : strut_study_read_value(reader, along, item, name, i == 0, &distribution->number[i]);
    fine = fine && read;
  }
  const char *flaw = fine ? strut_distribution_flaw(distribution) : NULL;
  if (flaw)
    strut_report_error(reader->reader, slot->value->place, "'%s' of %s %s", name,
                       strut_owner_text(reader->reader, owner), flaw);
  return fine && !flaw;
}

/* One parameter and its distribution. */
static bool read_parameter(strut_study_reader *reader, strut_study_axis *axis,
                           strut_study_along *along, strut_distribution *distributions) {
  strut_fields fields;
  bool fine = strut_study_begin_along(reader, axis, along);
  if (!along->parameter) return false; /* it has no column */
  const strut_owner owner = {"parameter", along->parameter->name};
  strut_distribution *distribution = &distributions[along->column - axis->columns];
  if (along->parameter->text)
    return strut_report_error(reader->reader, along->key->place,
                              "parameter '%s' is a text, which has no distribution",
                              along->parameter->name);
  strut_read_fields(reader->reader, STRUT_SECTION_DISTRIBUTION, along->value, owner, &fields);
  if (!strut_check_rules(reader->reader, &fields) || fields.broken) return false;
  for (int k = 0; k < STRUT_DISTRIBUTION_COUNT; k++) {
    const int key = STRUT_KEY_DISTRIBUTION_UNIFORM + k;
    const strut_slot *slot = strut_slot_of(&fields, key);
    if (slot->state != STRUT_GIVEN) continue;
    strut_store_choice(strut_key_at(key), distribution);
    fine = read_numbers(reader, along, slot, distribution) && fine;
  }
  along->column->kind = STRUT_RANGE_LIST;
  return fine;
}

/* Is this a list of so many, one for each parameter? */
static bool is_list_of(strut_reader *reader, const strut_tree *list, size_t count,
                       const char *what) {
  return (list->kind == STRUT_TREE_LIST && list->count == count) ||
         strut_report_error(reader, list->place,
                            "expected a list of %zu %s, one for each parameter, found %s", count,
                            what, strut_found(reader, list));
}

/* The factor of the correlation of the parameters; *factor: NULL without one. False: that was reported. */
static bool read_factor(strut_study_reader *reader, const strut_slot *slot, size_t count,
                        double **factor) {
  strut_reader *r = reader->reader;
  bool right = true;
  size_t k = 0;
  *factor = NULL;
  if (slot->state != STRUT_GIVEN) return true;
  if (!is_list_of(r, slot->value, count, "rows")) return false;
  double *matrix = *factor = strut_study_allocate(reader, count * count, sizeof *matrix);
  if (!matrix) return false;
  for (const strut_tree *row = slot->value->first; row; row = row->next) {
    if (!is_list_of(r, row, count, "numbers")) return false;
    for (const strut_tree *item = row->first; item; item = item->next)
      if (!strut_read_number(r, item, "correlation", sample_owner, STRUT_DIM_NONE,
                             STRUT_WITHIN(ANY), &matrix[k++]))
        return false;
  }
  for (size_t i = 0; i < count; i++)
    for (size_t j = 0; j <= i; j++)
      right = right && matrix[i * count + j] == (i == j ? 1.0 : matrix[j * count + i]);
  return (right && strut_correlation_factor(count, matrix)) ||
         strut_report_error(r, slot->value->place,
                            "'correlation' must be symmetric and positive definite, with 1 on its "
                            "diagonal");
}

/* Makes the values of all columns. */
static void make_values(strut_study_reader *reader, const strut_sample_keys *keys,
                        const double *factor, strut_study_axis *axis,
                        const strut_distribution *distributions) {
  double *values[STRUT_SAMPLE_MOST_NUMBERS];
  for (size_t i = 0; i < axis->column_count; i++) {
    values[i] = strut_study_allocate(reader, (size_t)axis->count, sizeof *values[i]);
    if (!values[i]) return;
    axis->columns[i].number = values[i];
  }
  if (!strut_sample_make((strut_sample_scheme)keys->scheme, (uint32_t)keys->seed, axis->count,
                         axis->column_count, distributions, factor, values))
    reader->reader->out_of_memory = true;
}

/* Reads parameters and their distributions into columns of the axis; false: reported. */
static bool read_distributions(strut_study_reader *reader, const strut_tree *over,
                               strut_study_axis *axis, strut_distribution *distributions) {
  bool fine = true;
  axis->columns = strut_study_allocate(reader, over->count, sizeof *axis->columns);
  if (!axis->columns) return false;
  for (const strut_tree *key = over->first; key; key = key->next->next) {
    strut_study_along a = {.key = key, .value = key->next};
    fine = read_parameter(reader, axis, &a, distributions) && fine;
  }
  return fine;
}

void strut_study_read_sample(strut_study_reader *reader, const strut_tree *value,
                             strut_study_axis *axis) {
  strut_fields fields;
  strut_sample_keys keys = {.count = 1, .scheme = STRUT_SAMPLE_SOBOL, .seed = 1};
  strut_distribution distributions[STRUT_SAMPLE_MOST_NUMBERS] = {0};
  strut_read_object(reader->reader, STRUT_SECTION_SAMPLE, value, sample_owner, &fields, &keys);
  const strut_slot *over = strut_slot_of(&fields, STRUT_KEY_SAMPLE_OVER);
  if (over->state != STRUT_GIVEN) return;
  axis->count = keys.count;
  bool fine = read_distributions(reader, over->value, axis, distributions);
  double *factor = NULL;
  fine = fine && read_factor(reader, strut_slot_of(&fields, STRUT_KEY_SAMPLE_CORRELATION),
                             axis->column_count, &factor);
  if (fine && !fields.broken) make_values(reader, &keys, factor, axis, distributions);
}

/* ---- sensitivity analyses ---- */

static const strut_owner sensitivity_owner = {"the sensitivity analysis", NULL};

static const double DEVIATION = 0.8413447460685429; /* the 84th percentile */

/* Gives the axis its points. */
static void make_points(strut_study_reader *reader, const strut_slot *slot, strut_study_axis *axis,
                        const strut_distribution *distributions) {
  strut_study *study = &reader->file->study;
  strut_study_sensitivity *sensitivity = &study->sensitivity;
  double *values[STRUT_SENSITIVITY_MOST], points = 1.0;
  axis->count = strut_sensitivity_points(sensitivity, axis->column_count);
  for (size_t i = 0; i < study->axis_count; i++) points *= (double)study->axes[i].count;
  if (points > (double)STRUT_STUDY_MOST_POINTS) {
    strut_report_error(reader->reader, slot->key->place,
                       "the axes and the sensitivity analysis make %.3g points, a study may have "
                       "1e9",
                       points);
    return;
  }
  double *scales = strut_study_allocate(reader, axis->column_count, sizeof *scales);
  for (size_t i = 0; i < axis->column_count; i++) {
    values[i] = strut_study_allocate(reader, (size_t)axis->count, sizeof *values[i]);
    if (!values[i] || !scales) return;
    axis->columns[i].number = values[i];
    scales[i] = fabs(strut_distribution_value(&distributions[i], DEVIATION) -
                     strut_distribution_value(&distributions[i], 0.5));
  }
  sensitivity->scales = scales;
  if (!strut_sensitivity_fill(sensitivity, axis->column_count, distributions, values))
    reader->reader->out_of_memory = true;
}

void strut_study_read_sensitivity(strut_study_reader *reader, strut_fields *top) {
  strut_study *study = &reader->file->study;
  strut_study_sensitivity *sensitivity = &study->sensitivity;
  const strut_slot *slot = strut_slot_of(top, STRUT_KEY_STUDY_SENSITIVITY);
  strut_distribution distributions[STRUT_SENSITIVITY_MOST] = {0};
  strut_fields fields;
  if (slot->state != STRUT_GIVEN) return;
  sensitivity->samples = 256, sensitivity->seed = 1, sensitivity->derivatives = true;
  strut_read_object(reader->reader, STRUT_SECTION_SENSITIVITY, slot->value, sensitivity_owner,
                    &fields, sensitivity);
  const strut_slot *of = strut_slot_of(&fields, STRUT_KEY_SENSITIVITY_OF);
  const strut_slot *over = strut_slot_of(&fields, STRUT_KEY_SENSITIVITY_OVER);
  if (of->state == STRUT_GIVEN && !of->value->count)
    strut_report_error(reader->reader, of->value->place,
                       "expected columns of the table for 'of' of the sensitivity analysis");
  if (over->state != STRUT_GIVEN || !study->axes || !reader->file->columns) return;
  if (sensitivity->samples == 0 && !sensitivity->derivatives)
    strut_report_error(reader->reader, slot->key->place,
                       "the sensitivity analysis has neither samples nor derivatives");
  strut_study_axis *axis = &study->axes[study->axis_count];
  *axis = (strut_study_axis){.count = 1};
  bool fine = read_distributions(reader, over->value, axis, distributions);
  sensitivity->axis = study->axis_count++;
  sensitivity->wanted = true;
  if (fine && !fields.broken && !reader->reader->failed)
    make_points(reader, slot, axis, distributions);
}
