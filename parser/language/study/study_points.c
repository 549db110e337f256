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

/* Columns of strut's own tables that say nothing about the model. */
static const char *const skipped[] = {"point", "status", "message"};

/* A file of points being read. */
typedef struct table {
  strut_study_reader *r;
  strut_study_points *points;
  const strut_tree *columns; /* the list of those to use, or NULL: all */
  strut_csv csv;
  strut_place place; /* of the file's name in the study */
} table;

static bool has_key(const strut_tree *map, const char *key) {
  return map->kind == STRUT_TREE_MAP && strut_tree_find(map, key, NULL);
}

/* The value of an item {NAME: value}, or NULL. */
static const strut_tree *only_value(const strut_tree *item, const char *name) {
  if (item->kind != STRUT_TREE_MAP || item->count != 1) return NULL;
  return strcmp(item->first->text, name) == 0 ? item->first->next : NULL;
}

bool strut_study_is_points(const strut_study_reader *r, const strut_tree *item) {
  const strut_tree *value = only_value(item, "points");
  if (!value) return false;
  return value->kind == STRUT_TREE_SCALAR || has_key(value, "file") ||
         !strut_study_declared(r, "points");
}

static strut_diagnostics *messages(table *t) { return &t->points->diagnostics; }

/* Is the column to be used? */
static bool is_wanted(const table *t, const char *name) {
  for (const strut_tree *item = t->columns ? t->columns->first : NULL; item; item = item->next)
    if (strcmp(item->text, name) == 0) return true;
  if (t->columns) return false;
  for (size_t i = 0; i < sizeof skipped / sizeof skipped[0]; i++)
    if (strcmp(skipped[i], name) == 0) return false;
  return true;
}

/* Reports wanted columns that the file does not have. */
static void check_columns(table *t) {
  for (const strut_tree *item = t->columns ? t->columns->first : NULL; item; item = item->next) {
    bool found = false;
    for (size_t i = 0; i < t->csv.column_count; i++)
      found = found || strcmp(t->csv.titles[i].name, item->text) == 0;
    if (!found)
      strut_report_error(t->r->reader, item->place, "'%s' has no column '%s'",
                         strut_sanitised_text(t->r->reader, t->points->node->text),
                         strut_sanitised_text(t->r->reader, item->text));
  }
}

/* The parameter that a column gives; NULL where that was reported. */
static const strut_declared *parameter_of(table *t, size_t i) {
  strut_reader *reader = t->r->reader;
  const char *name = t->csv.titles[i].name;
  const strut_declared *found = strut_study_declared(t->r, name);
  if (!found) {
    strut_diagnose(messages(t), t->csv.place[i], "the model has no parameter '%s'%s%s",
                   strut_sanitised_text(reader, name),
                   strut_hint(reader, name, strut_study_declared_name, t->r, t->r->declared_count),
                   t->columns ? "" : "; {points: {file: ..., columns: [...]}} chooses columns");
    return NULL;
  }
  if (strut_name_map_find(&t->r->given, found->name) >= 0) {
    strut_diagnose(messages(t), t->csv.place[i], "parameter '%s' is given twice", found->name);
    return NULL;
  }
  strut_add_name(reader, &t->r->given, found->name, (size_t)(found - t->r->declared));
  return found;
}

/* A plain number with the column's unit; the whole text is read as one, so that 0.1 mm has its bits. */
static bool read_number(const char *text, const char *unit, strut_quantity *q) {
  char whole[200];
  double plain;
  strut_expression_error error;
  if (!strut_csv_number(text, &plain) || !isfinite(plain)) return false;
  int n = snprintf(whole, sizeof whole, "%s %s", *text == '+' ? text + 1 : text, unit);
  return n > 0 && (size_t)n < sizeof whole && strut_expression_evaluate(whole, NULL, q, &error);
}

/* The unit of a column: "" for none. False where that was reported. */
static bool check_unit(table *t, size_t i, const strut_study_along *a, const char **unit) {
  char expected[200];
  strut_quantity q;
  strut_setting *s = a->setting;
  const char *title = t->csv.titles[i].unit;
  *unit = strcmp(title, "1") == 0 ? "" : title;
  if (!**unit) return true;
  bool known = !a->parameter->text && read_number("1", *unit, &q);
  if (known && s->bare && !q.bare) {
    s->bare = false;
    s->dimension = q.dimension;
  }
  if (known && !q.bare && strut_dimension_equal(q.dimension, s->dimension)) return true;
  strut_diagnose(messages(t), t->csv.place[i], "expected %s in column '%s', found the unit '%s'",
                 a->parameter->text ? "texts"
                 : s->bare          ? "a unit"
                           : strut_expected_number(s->dimension, expected, sizeof expected),
                 a->parameter->name, strut_sanitised_text(t->r->reader, title));
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

static void refuse_cell(table *t, size_t cell, const strut_study_along *a) {
  const char *text = t->csv.cell[cell];
  const char *expected = a->parameter->text ? "a text of 1 to 23 bytes" : "a number";
  if (!*text)
    strut_diagnose(messages(t), t->csv.place[cell], "expected %s for '%s', found an empty cell",
                   expected, a->parameter->name);
  else
    strut_diagnose(messages(t), t->csv.place[cell], "expected %s for '%s', found '%s'", expected,
                   a->parameter->name, strut_sanitised_text(t->r->reader, text));
}

/* The cells of column i. */
static void read_cells(table *t, size_t i, const strut_study_along *a, const char *unit) {
  strut_arena *arena = &t->r->file->arena;
  size_t rows = t->csv.row_count;
  bool text = a->parameter->text;
  double *numbers = text ? NULL : strut_reader_allocate(t->r->reader, arena, rows, sizeof *numbers);
  const char **words =
      text ? strut_reader_allocate(t->r->reader, arena, rows, sizeof *words) : NULL;
  if (!numbers && !words) return;
  for (size_t k = 0; k < rows && !strut_diagnostics_full(messages(t)); k++) {
    size_t cell = (k + 1) * t->csv.column_count + i, length = strlen(t->csv.cell[cell]);
    strut_quantity q = {.value = 0.0};
    bool fine = text ? length > 0 && length < MOST_WORD && is_text(t->csv.cell[cell])
                     : read_number(t->csv.cell[cell], unit, &q);
    if (!fine) {
      refuse_cell(t, cell, a);
    } else if (text) {
      words[k] = strut_arena_text(arena, t->csv.cell[cell], length);
      if (!words[k]) t->r->reader->out_of_memory = true;
    } else {
      numbers[k] = q.value;
    }
  }
  a->column->kind = STRUT_RANGE_LIST;
  a->column->number = numbers;
  a->column->words = words;
}

static void read_column(table *t, size_t i, strut_study_axis *axis) {
  strut_study_along a = {.parameter = parameter_of(t, i)};
  const char *unit = "";
  if (!a.parameter) return;
  a.column = &axis->columns[axis->column_count++];
  a.setting = &t->r->file->columns[t->r->file->column_count++];
  a.column->unit = "1";
  if (!strut_study_begin_along(t->r, &a, t->place) || !check_unit(t, i, &a, &unit)) return;
  read_cells(t, i, &a, unit);
  a.column->unit =
      a.setting->bare || a.parameter->text ? "1" : strut_dimension_unit(a.setting->dimension);
}

static void read_columns(table *t, strut_study_axis *axis) {
  strut_study_reader *r = t->r;
  check_columns(t);
  if (t->csv.row_count > MOST_ROWS) {
    strut_report_error(r->reader, t->place, "'%s' has %zu rows, a file of points may have 1e6",
                       strut_sanitised_text(r->reader, t->points->node->text), t->csv.row_count);
    return;
  }
  axis->columns = strut_reader_allocate(r->reader, &r->file->arena, r->declared_count + 1,
                                        sizeof *axis->columns);
  if (!axis->columns) return;
  axis->count = (int64_t)t->csv.row_count;
  for (size_t i = 0; i < t->csv.column_count; i++)
    if (is_wanted(t, t->csv.titles[i].name)) read_column(t, i, axis);
  if (axis->column_count == 0 && !messages(t)->count)
    strut_report_error(r->reader, t->place, "'%s' has no column of a parameter of the model",
                       strut_sanitised_text(r->reader, t->points->node->text));
}

static void read_file(table *t, const strut_tree *name, strut_study_axis *axis) {
  strut_study_reader *r = t->r;
  strut_error error = {0};
  char *root = strut_folder_of(r->file->path, &r->file->arena);
  t->points = &r->file->tables[r->file->table_count];
  t->points->node = name;
  t->points->copy = strut_arena_format(&r->file->arena, "points-%zu.csv", r->file->table_count + 1);
  if (!root || !t->points->copy) {
    r->reader->out_of_memory = true;
    return;
  }
  strut_status status =
      strut_safe_read(root, r->file->path, name->text, STRUT_TEXT_MOST, &t->points->file, &error);
  if (status) {
    if (status == STRUT_NO_MEMORY) r->reader->out_of_memory = true;
    strut_report_error(r->reader, name->place, "%s", error.message);
    return;
  }
  r->file->table_count++;
  strut_diagnostics_source(messages(t), t->points->file.path, t->points->file.text,
                           t->points->file.length);
  status = strut_csv_read(t->points->file.text, t->points->file.length, messages(t), &t->csv);
  if (status == STRUT_OK) read_columns(t, axis);
  if (status == STRUT_NO_MEMORY || messages(t)->out_of_memory) r->reader->out_of_memory = true;
  if (messages(t)->count) r->reader->failed = true;
  strut_arena_free(&t->csv.arena);
}

void strut_study_read_points(strut_study_reader *r, const strut_tree *value,
                             strut_study_axis *axis) {
  const strut_owner owner = {"the file of points", NULL};
  const strut_tree *name = value;
  table t = {.r = r};
  if (value->kind == STRUT_TREE_MAP) {
    strut_fields fields;
    strut_points_keys keys = {0};
    if (!strut_read_object(r->reader, STRUT_SECTION_POINTS, value, owner, &fields, &keys)) return;
    name = keys.file, t.columns = keys.columns;
    for (const strut_tree *item = t.columns ? t.columns->first : NULL; item; item = item->next)
      if (!strut_read_scalar(r->reader, item, "columns", owner, "a column's name")) return;
  }
  if (!strut_read_scalar(r->reader, name, "points", owner, "the path of a CSV file")) return;
  t.place = name->place;
  read_file(&t, name, axis);
}

/* ---- samples of distributions ---- */

static const strut_owner sample_owner = {"the sample", NULL};

bool strut_study_is_sample(const strut_study_reader *r, const strut_tree *item) {
  if (item->kind != STRUT_TREE_MAP || item->count != 1) return false;
  const strut_tree *value = item->first->next;
  if (strcmp(item->first->text, "sample") != 0) return false;
  return (value->kind == STRUT_TREE_MAP && strut_tree_find(value, "over", NULL)) ||
         !strut_study_declared(r, "sample");
}

/* Numbers of a distribution; the last one of a lognormal one has no unit. */
static bool read_numbers(strut_study_reader *r, strut_study_along *a, const strut_slot *slot,
                         strut_distribution *d) {
  size_t wanted = d->kind == STRUT_DISTRIBUTION_TRIANGULAR ? 3 : 2, i = 0;
  const char *name = slot->key->text;
  const strut_owner owner = {"parameter", a->parameter->name};
  bool fine = true;
  if (slot->value->count != wanted)
    return strut_report_error(
        r->reader, slot->value->place, "expected %zu numbers for '%s' of %s, found %s", wanted,
        name, strut_owner_text(r->reader, owner), strut_found(r->reader, slot->value));
  for (const strut_tree *item = slot->value->first; item; item = item->next, i++) {
    bool bare = d->kind == STRUT_DISTRIBUTION_LOGNORMAL && i == 1;
    bool read = bare ? strut_read_number(r->reader, item, name, owner, STRUT_DIM_NONE,
                                         STRUT_RANGE_ANY, &d->number[i])
                     : strut_study_read_value(r, a, item, name, i == 0, &d->number[i]);
    fine = fine && read;
  }
  const char *flaw = fine ? strut_distribution_flaw(d) : NULL;
  if (flaw)
    strut_report_error(r->reader, slot->value->place, "'%s' of %s %s", name,
                       strut_owner_text(r->reader, owner), flaw);
  return fine && !flaw;
}

/* One parameter and its distribution. */
static bool read_parameter(strut_study_reader *r, strut_study_along *a, strut_distribution *d) {
  strut_fields fields;
  int kinds = 0;
  a->parameter = strut_study_parameter(r, a->key);
  if (!a->parameter) return false;
  const strut_owner owner = {"parameter", a->parameter->name};
  bool fine = strut_study_begin_along(r, a, a->key->place);
  a->column->unit = "1";
  if (a->parameter->text)
    return strut_report_error(r->reader, a->key->place,
                              "parameter '%s' is a text, which has no distribution",
                              a->parameter->name);
  strut_read_fields(r->reader, STRUT_SECTION_DISTRIBUTION, a->value, owner, &fields);
  if (fields.broken) return false;
  for (int k = 0; k < STRUT_DISTRIBUTION_COUNT; k++) {
    const int key = STRUT_KEY_DISTRIBUTION_UNIFORM + k;
    const strut_slot *slot = strut_slot_of(&fields, key);
    if (slot->state != STRUT_GIVEN) continue;
    kinds++;
    strut_store_choice(strut_key_at(key), d);
    fine = read_numbers(r, a, slot, d) && fine;
  }
  if (kinds == 0)
    strut_report_error(r->reader, a->value->place,
                       "expected a distribution such as {uniform: [1, 2]} for parameter '%s'",
                       a->parameter->name);
  a->column->kind = STRUT_RANGE_LIST;
  a->column->unit = a->setting->bare ? "1" : strut_dimension_unit(a->setting->dimension);
  return fine && kinds > 0;
}

/* Makes the values of all columns. */
static void make_values(strut_study_reader *r, const strut_sample_keys *keys,
                        strut_study_axis *axis, const strut_distribution *distributions) {
  double *values[STRUT_SAMPLE_MOST_NUMBERS];
  for (size_t i = 0; i < axis->column_count; i++) {
    values[i] =
        strut_reader_allocate(r->reader, &r->file->arena, (size_t)axis->count, sizeof *values[i]);
    if (!values[i]) return;
    axis->columns[i].number = values[i];
  }
  if (!strut_sample_make((strut_sample_scheme)keys->scheme, (uint32_t)keys->seed, axis->count,
                         axis->column_count, distributions, values))
    r->reader->out_of_memory = true;
}

bool strut_study_read_distributions(strut_study_reader *r, const strut_tree *over,
                                    strut_owner owner, size_t most, strut_study_axis *axis,
                                    strut_distribution *distributions) {
  bool fine = true;
  if (over->count == 0 || over->count > most)
    return strut_report_error(r->reader, over->place,
                              "expected 1 to %zu parameters for 'over' of %s, found %zu", most,
                              strut_owner_text(r->reader, owner), (size_t)over->count);
  axis->columns =
      strut_reader_allocate(r->reader, &r->file->arena, over->count, sizeof *axis->columns);
  if (!axis->columns) return false;
  for (const strut_tree *key = over->first; key; key = key->next->next) {
    strut_study_along a = {.key = key, .value = key->next};
    if (!strut_study_declared(r, key->text) ||
        strut_name_map_find(&r->given, key->text) >= 0) { /* no slot for it */
      strut_study_parameter(r, key);
      fine = false;
      continue;
    }
    a.column = &axis->columns[axis->column_count];
    a.setting = &r->file->columns[r->file->column_count++];
    fine = read_parameter(r, &a, &distributions[axis->column_count++]) && fine;
  }
  return fine;
}

void strut_study_read_sample(strut_study_reader *r, const strut_tree *value,
                             strut_study_axis *axis) {
  strut_fields fields;
  strut_sample_keys keys = {.count = 1, .scheme = STRUT_SAMPLE_SOBOL, .seed = 1};
  strut_distribution distributions[STRUT_SAMPLE_MOST_NUMBERS] = {0};
  strut_read_object(r->reader, STRUT_SECTION_SAMPLE, value, sample_owner, &fields, &keys);
  const strut_slot *over = strut_slot_of(&fields, STRUT_KEY_SAMPLE_OVER);
  if (over->state != STRUT_GIVEN) return;
  axis->count = keys.count;
  bool fine = strut_study_read_distributions(r, over->value, sample_owner,
                                             STRUT_SAMPLE_MOST_NUMBERS, axis, distributions);
  if (fine && !fields.broken) make_values(r, &keys, axis, distributions);
}

/* ---- sensitivity analyses ---- */

static const strut_owner sensitivity_owner = {"the sensitivity analysis", NULL};

/* The accuracy of the runs at the first point; 0 for that of rounding, or where no point can be read yet. */
static double find_accuracy(strut_study_reader *r) {
  const strut_study *study = &r->file->study;
  strut_setup setup;
  strut_error error = {0};
  size_t k = 0;
  if (study->compute != STRUT_COMPUTE_RUN || r->reader->failed) return 0.0;
  strut_study_value *values = strut_allocate(r->file->column_count + 1, sizeof *values);
  if (!values) {
    r->reader->out_of_memory = true;
    return 0.0;
  }
  for (size_t i = 0; i < study->axis_count; i++)
    for (size_t c = 0; c < study->axes[i].column_count; c++, k++) {
      const strut_study_column *column = &study->axes[i].columns[c];
      bool list = column->kind == STRUT_RANGE_LIST;
      values[k].number = column->word ? (double)NAN : list ? column->number[0] : column->from;
      values[k].word = column->word ? column->words[0] : NULL;
    }
  double accuracy = 0.0;
  if (strut_study_setup(r->file, values, &setup, &error) == STRUT_OK) {
    accuracy = setup.experiment.accuracy;
    strut_setup_free(&setup);
  }
  strut_release(values);
  return accuracy;
}

/* Gives the axis its points; first the medians alone, at which the accuracy is found. */
static void make_points(strut_study_reader *r, const strut_slot *slot, strut_study_axis *axis,
                        const strut_distribution *distributions) {
  strut_study *study = &r->file->study;
  strut_study_sensitivity *s = &study->sensitivity;
  double *values[STRUT_SENSITIVITY_MOST], points = 1.0;
  axis->count = strut_sensitivity_points(s, axis->column_count);
  for (size_t i = 0; i < study->axis_count; i++) points *= (double)study->axes[i].count;
  if (points > (double)STRUT_STUDY_MOST_POINTS) {
    strut_report_error(r->reader, slot->key->place,
                       "the axes and the sensitivity analysis make %.3g points, a study may have "
                       "1e9",
                       points);
    return;
  }
  for (size_t i = 0; i < axis->column_count; i++) {
    values[i] =
        strut_reader_allocate(r->reader, &r->file->arena, (size_t)axis->count, sizeof *values[i]);
    if (!values[i]) return;
    values[i][0] = strut_distribution_value(&distributions[i], 0.5);
    axis->columns[i].number = values[i];
  }
  s->accuracy = find_accuracy(r);
  if (!strut_sensitivity_fill(s, axis->column_count, distributions, values))
    r->reader->out_of_memory = true;
}

void strut_study_read_sensitivity(strut_study_reader *r, strut_fields *top) {
  strut_study *study = &r->file->study;
  strut_study_sensitivity *s = &study->sensitivity;
  const strut_slot *slot = strut_slot_of(top, STRUT_KEY_STUDY_SENSITIVITY);
  strut_distribution distributions[STRUT_SENSITIVITY_MOST] = {0};
  strut_fields fields;
  static const int others[] = {STRUT_KEY_STUDY_REFINE, STRUT_KEY_STUDY_TRAJECTORIES,
                               STRUT_KEY_STUDY_SEARCH};
  if (slot->state != STRUT_GIVEN) return;
  strut_study_exclude(r, top, slot, others, sizeof others / sizeof others[0]);
  if (!study->axes) /* the study has no others */
    strut_study_read_axes(r, NULL, strut_slot_of(top, STRUT_KEY_STUDY_SEARCH));
  s->samples = 256, s->seed = 1, s->derivatives = true;
  strut_read_object(r->reader, STRUT_SECTION_SENSITIVITY, slot->value, sensitivity_owner, &fields,
                    s);
  const strut_slot *of = strut_slot_of(&fields, STRUT_KEY_SENSITIVITY_OF);
  const strut_slot *over = strut_slot_of(&fields, STRUT_KEY_SENSITIVITY_OVER);
  if (of->state == STRUT_GIVEN && !of->value->count)
    strut_report_error(r->reader, of->value->place,
                       "expected columns of the table for 'of' of the sensitivity analysis");
  if (over->state != STRUT_GIVEN || !study->axes || !r->file->columns) return;
  if (s->samples == 0 && !s->derivatives)
    strut_report_error(r->reader, slot->key->place,
                       "the sensitivity analysis has neither samples nor derivatives");
  strut_study_axis *axis = &study->axes[study->axis_count];
  *axis = (strut_study_axis){.count = 1};
  bool fine = strut_study_read_distributions(r, over->value, sensitivity_owner,
                                             STRUT_SENSITIVITY_MOST, axis, distributions);
  s->axis = study->axis_count++;
  s->wanted = true;
  if (fine && !fields.broken && !r->reader->failed) make_points(r, slot, axis, distributions);
}
