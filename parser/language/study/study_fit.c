/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a study fits: parameters, and the measured numbers that the model shall match. See study_reader.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "parser/language/study/study_reader.h"

static const strut_owner fit_owner = {"the fit", NULL};

/* Numbers and weights up to this have a finite sum of squares. */
static const double MOST_NUMBER = 1e150;
/* How often a run may be as long as the model's own, and how often it is usually. */
static const double MOST = 1e7, USUAL = 100.0;

/* A match while it is read. */
typedef struct reading {
  strut_fit_match *to;
  strut_owner owner;
  strut_fields fields; /* of its own keys */
  strut_tree own;      /* a mapping of these */
  strut_tree rest;     /* and one of what is compared */
  const strut_data_table *table;
} reading;

/* ---- parameters ---- */

static void read_over(strut_study_reader *reader, const strut_slot *over, strut_study_fit *fit) {
  strut_study_read_variables(reader, over, "the fit", STRUT_FIT_MOST_VARIABLES, &fit->variables,
                             &fit->variable_count, &fit->column);
  for (size_t i = 0; i < fit->variable_count; i++) {
    const strut_search_variable *variable = &fit->variables[i];
    if (variable->choice_count || variable->wraps || variable->integer)
      strut_report_error(reader->reader, over->value->place,
                         "'%s' of the fit needs a range of any number, such as {from: 1, to: 2}",
                         variable->name);
  }
}

/* ---- what is compared ---- */

static const char *match_key(const void *context, size_t i) {
  (void)context;
  int first = strut_section_first(STRUT_SECTION_MATCH);
  return i < (size_t)strut_section_size(STRUT_SECTION_MATCH) ? strut_key_at(first + (int)i)->name
                                                             : NULL;
}

/* Is a key the match's own, perhaps misspelt? What is compared has a column or a number, and another name. */
static bool is_own(const strut_reader *reader, const strut_tree *key) {
  const strut_data_table *table;
  if (strut_key_find(STRUT_SECTION_MATCH, key->text) >= 0) return true;
  if (key->next->kind != STRUT_TREE_SCALAR) return true;
  return !strchr(key->text, '.') && strut_did_you_mean(key->text, match_key, NULL) &&
         !strut_data_find(reader->tables, reader->table_count, key->next->text, &table);
}

/* Divides the mapping of a match into its own keys and the others. */
static bool divide(strut_study_reader *reader, const strut_tree *map, reading *self) {
  strut_tree *items = strut_reader_allocate(reader->reader, &reader->reader->scratch,
                                            2 * (size_t)map->count + 1, sizeof *items);
  strut_tree **ends[] = {&self->own.first, &self->rest.first};
  if (!items) return false;
  self->own = self->rest = *map;
  self->own.first = self->rest.first = NULL;
  self->own.count = self->rest.count = 0;
  for (const strut_tree *key = map->first; key; key = key->next->next) {
    bool own = is_own(reader->reader, key);
    items[0] = *key, items[1] = *key->next;
    items[0].next = &items[1], items[1].next = NULL;
    *ends[!own] = items;
    ends[!own] = &items[1].next;
    (own ? &self->own : &self->rest)->count++;
    items += 2;
  }
  return true;
}

/* The column behind one of the match's own keys, all of the same table. */
static const double *read_at(strut_study_reader *reader, reading *self, int key,
                             strut_dimension dimension, bool ascending) {
  strut_reader *r = reader->reader;
  const strut_slot *slot = strut_slot_of(&self->fields, key);
  const strut_data_table *table;
  if (slot->state != STRUT_GIVEN) return NULL;
  const strut_data_column *column =
      strut_read_data_column(r, slot->value, slot->key->text, self->owner, &dimension, &table);
  if (!column) return NULL;
  const char *flaw = NULL;
  size_t rows = table->row_count, i = 0;
  for (const double *at = column->values; i < rows && !flaw; i++)
    flaw = !isfinite(at[i])                         ? "a number is missing"
           : ascending && i && !(at[i] > at[i - 1]) ? "times must ascend"
           : ascending && rows < 2                  ? "a motion needs two times or more"
                                                    : NULL;
  if (flaw) strut_refuse_data(r, slot->value, table, column, i - 1, flaw);
  if (flaw) return NULL;
  self->table = table;
  self->to->count = table->row_count;
  return column->values;
}

static bool set_noise_unit(strut_study_reader *reader, reading *self, const strut_tree *value,
                           const char *unit) {
  const strut_slot *noise = strut_slot_of(&self->fields, STRUT_KEY_MATCH_NOISE);
  strut_quantity q;
  if (noise->state != STRUT_GIVEN) {
    self->to->noise_unit = unit;
    return true;
  }
  if (!self->to->noise_unit) {
    if (!strut_read_quantity(reader->reader, noise->value, "noise", self->owner, &q)) return false;
    self->to->noise = q.value;
    self->to->noise_unit = q.bare ? unit : strut_dimension_unit(q.dimension);
    if (!(q.value > 0.0))
      return strut_report_error(reader->reader, noise->value->place,
                                "'noise' of match '%s' must be above 0", self->to->name);
  }
  return strcmp(self->to->noise_unit, unit) == 0 ||
         strut_report_error(reader->reader, value->place,
                            "'noise' of match '%s' is in %s, this in %s: give numbers of another "
                            "dimension a match of their own",
                            self->to->name, self->to->noise_unit, unit);
}

/* A number of its own, or a column of the match's table, or of any table where it has none. */
static bool read_numbers(strut_study_reader *reader, reading *self, const strut_tree *value,
                         strut_fit_series *series) {
  strut_reader *r = reader->reader;
  strut_quantity q;
  const strut_data_table *table;
  bool plain = value->kind == STRUT_TREE_SCALAR && !value->quoted &&
               strpbrk(value->text, "0123456789+-") == value->text;
  if (plain && !self->to->at) {
    double *number = strut_study_allocate(reader, 1, sizeof *number);
    if (!number || !strut_read_quantity(r, value, series->of, self->owner, &q)) return false;
    if (self->table)
      return strut_report_error(r, value->place,
                                "match '%s' has columns of '%s': put single numbers "
                                "into a match of their own",
                                self->to->name, self->table->name);
    *number = q.value;
    series->measured = number;
    series->unit = q.bare ? "1" : strut_dimension_unit(q.dimension);
    self->to->count = 1;
    return true;
  }
  const strut_data_column *column =
      strut_read_data_column(r, value, series->of, self->owner, NULL, &table);
  if (!column) return false;
  if (self->table && table != self->table)
    return strut_report_error(r, value->place,
                              "match '%s' compares columns of '%s': '%s' needs a "
                              "match of its own",
                              self->to->name, self->table->name, table->name);
  self->table = table;
  self->to->count = table->row_count;
  series->measured = column->values;
  series->weights = column->weights;
  series->unit = strcmp(column->unit, "1") == 0 ? "1" : strut_dimension_unit(column->dimension);
  if (column->gap_count == table->row_count)
    return strut_refuse_data(r, value, table, column, 0, "there are no numbers");
  return true;
}

/* Reports a number of a series, in its cell where it has one. */
static bool refuse_number(strut_study_reader *reader, const reading *self, const strut_tree *value,
                          const double *numbers, size_t row, const char *message) {
  const strut_data_table *table = self->table;
  for (size_t i = 0; table && i < table->column_count; i++)
    if (table->columns[i].values == numbers)
      return strut_refuse_data(reader->reader, value, table, &table->columns[i], row, message);
  return strut_report_error(reader->reader, value->place, "%s", message);
}

/* Squares of residuals must not overflow, and some must count. */
static bool check_numbers(strut_study_reader *reader, const reading *self, const strut_tree *value,
                          const strut_fit_series *series) {
  bool counts = false;
  double noise = self->to->noise > 0.0 ? self->to->noise : 1.0;
  for (size_t i = 0; i < self->to->count; i++) {
    double weight = series->weights ? series->weights[i] : 1.0;
    if (fabs(series->measured[i]) > MOST_NUMBER * fmin(noise, 1.0))
      return refuse_number(reader, self, value, series->measured, i,
                           "a number this large has no finite square in the sum of a fit");
    if (weight > MOST_NUMBER)
      return refuse_number(reader, self, value, series->weights, i,
                           "a weight this large has no finite product in the sum of a fit");
    counts = counts || (weight > 0.0 && !isnan(series->measured[i]));
  }
  return counts || refuse_number(reader, self, value, series->weights, 0,
                                 "no number of this match has a weight above 0");
}

/* Does the model itself measure a quantity of that name? */
static bool is_measured(const strut_study_file *file, const char *name) {
  const char *const keys[] = {"run", "measure", "quantities", name};
  const strut_tree *at = file->source_count ? file->sources[0]->document.root : NULL;
  for (size_t i = 0; i < sizeof keys / sizeof *keys && at; i++)
    at = at->kind == STRUT_TREE_MAP ? strut_tree_find(at, keys[i], NULL) : NULL;
  return at != NULL;
}

static bool add_series(strut_study_reader *reader, reading *self, const strut_tree *key) {
  strut_fit_series *series = &self->to->series[self->to->series_count];
  *series = (strut_fit_series){.of = key->text, .place = {key->place.line, key->place.column}};
  if (!read_numbers(reader, self, key->next, series) ||
      !set_noise_unit(reader, self, key->next, series->unit) ||
      !check_numbers(reader, self, key->next, series))
    return false;
  self->to->series_count++;
  bool moves = self->to->kind == STRUT_FIT_MOTION || self->to->kind == STRUT_FIT_REST;
  if (moves && !is_measured(reader->file, key->text) && !strut_study_measure(reader->file, key))
    reader->reader->out_of_memory = true;
  return true;
}

/* The other coordinate of the place of a series, which was not measured but turns with it. */
static void add_partner(strut_study_reader *reader, reading *self, const strut_tree *key,
                        const double *gaps) {
  strut_fit_match *to = self->to;
  size_t length = strlen(key->text);
  char last = length > 2 && key->text[length - 2] == '.' ? key->text[length - 1] : '\0';
  if (last != 'x' && last != 'y') return;
  char *text = strut_arena_text(&reader->file->arena, key->text, length);
  if (!text) return;
  text[length - 1] = last == 'x' ? 'y' : 'x';
  for (size_t s = 0; s < to->series_count; s++)
    if (strcmp(to->series[s].of, text) == 0) return;
  strut_tree other = *key;
  other.text = text;
  to->series[to->series_count++] = (strut_fit_series){.of = text,
                                                      .place = {key->place.line, key->place.column},
                                                      .unit = "m",
                                                      .measured = gaps,
                                                      .empty = true};
  if (!strut_study_measure(reader->file, &other)) reader->reader->out_of_memory = true;
}

static void add_partners(strut_study_reader *reader, reading *self) {
  double *gaps = strut_study_allocate(reader, self->to->count, sizeof *gaps);
  for (size_t i = 0; gaps && i < self->to->count; i++) gaps[i] = (double)NAN;
  for (const strut_tree *key = self->rest.first; key && gaps; key = key->next->next)
    add_partner(reader, self, key, gaps);
}

static void read_curve(strut_study_reader *reader, reading *self) {
  const strut_slot *force = strut_slot_of(&self->fields, STRUT_KEY_MATCH_FORCE);
  self->to->at = read_at(reader, self, STRUT_KEY_MATCH_DISPLACEMENT, STRUT_DIM_LENGTH, false);
  if (force->state != STRUT_GIVEN)
    strut_report_error(reader->reader, self->own.place,
                       "match '%s' of a displacement lacks 'force'", self->to->name);
  else if (self->to->at)
    add_series(reader, self, force->key);
}

/* What kind of match it is, by the keys that it has. */
static void choose_kind(strut_study_reader *reader, reading *self) {
  strut_fields fields;
  bool over_time = strut_slot_of(&self->fields, STRUT_KEY_MATCH_TIME)->state != STRUT_ABSENT;
  bool curve = strut_slot_of(&self->fields, STRUT_KEY_MATCH_DISPLACEMENT)->state != STRUT_ABSENT;
  bool table = strut_slot_of(&self->fields, STRUT_KEY_MATCH_COMPUTE)->state != STRUT_ABSENT;
  const strut_slot *align = strut_slot_of(&self->fields, STRUT_KEY_MATCH_ALIGN);
  self->to->kind = over_time ? STRUT_FIT_MOTION
                   : curve   ? STRUT_FIT_CURVE
                   : table   ? STRUT_FIT_TABLE
                             : STRUT_FIT_REST;
  if (curve) self->to->compute = STRUT_COMPUTE_PATH;
  if (align->state == STRUT_GIVEN)
    strut_read_object(reader->reader, STRUT_SECTION_ALIGN, align->value, self->owner, &fields,
                      self->to);
  if (over_time + curve + table > 1)
    strut_report_error(reader->reader, self->own.place,
                       "match '%s' can have only one of 'time', 'displacement' and 'compute'",
                       self->to->name);
  if (align->state == STRUT_GIVEN && (curve || table))
    strut_report_error(reader->reader, align->key->place,
                       "'align' of match '%s' is for motions and shapes", self->to->name);
  if (self->to->align.delay && !over_time)
    strut_report_error(reader->reader, align->value->place, "a delay needs the 'time' of a motion");
}

static void read_match(strut_study_reader *reader, const strut_tree *key, strut_fit_match *to) {
  reading self = {.to = to, .owner = {"match", key->text}};
  strut_reader *r = reader->reader;
  strut_read_name(r, key, "match");
  *to = (strut_fit_match){.name = key->text};
  if (key->next->kind != STRUT_TREE_MAP) {
    strut_report_error(r, key->next->place,
                       "expected a mapping such as {time: film.t, n1.x: film.x} "
                       "for match '%s', found %s",
                       key->text, strut_found(r, key->next));
    return;
  }
  if (!divide(reader, key->next, &self)) return;
  strut_read_object(r, STRUT_SECTION_MATCH, &self.own, self.owner, &self.fields, to);
  choose_kind(reader, &self);
  to->series = strut_study_allocate(reader, 2 * (size_t)self.rest.count + 1, sizeof *to->series);
  if (!to->series) return;
  if (to->kind == STRUT_FIT_CURVE) read_curve(reader, &self);
  if (to->kind == STRUT_FIT_MOTION)
    to->at = read_at(reader, &self, STRUT_KEY_MATCH_TIME, STRUT_DIM_TIME, true);
  if (to->kind == STRUT_FIT_MOTION && !to->at) return;
  if (to->kind == STRUT_FIT_MOTION && to->at[0] < 0.0 && !to->align.delay)
    strut_report_error(r, strut_slot_of(&self.fields, STRUT_KEY_MATCH_TIME)->value->place,
                       "the times of match '%s' begin before 0, where the run starts: let 'align' "
                       "have 'delay: free'",
                       to->name);
  const strut_tree *first = self.rest.first;
  if (to->kind == STRUT_FIT_CURVE && first)
    strut_report_error(r, first->place,
                       "a match of a displacement compares its 'force' alone, not '%s'",
                       strut_sanitised_text(r, first->text));
  for (; first && to->kind != STRUT_FIT_CURVE; first = first->next->next)
    add_series(reader, &self, first);
  if (to->align.rotate && to->series_count) add_partners(reader, &self);
  if (!self.rest.count && to->kind != STRUT_FIT_CURVE)
    strut_report_error(r, key->place,
                       "match '%s' compares nothing: add what the model has, such as "
                       "'n1.x: film.x'",
                       key->text);
}

/* ---- what matches set ---- */

/* A column of a parameter that each match sets, which the first of them names. */
static void add_set(strut_study_reader *reader, const strut_tree *const *sets,
                    const strut_tree *key, strut_study_axis *axis, strut_study_fit *fit) {
  const strut_study_value *first = &fit->matches[0].values[fit->set_count];
  strut_study_along a = {.key = key, .value = key->next};
  if (!strut_study_begin_along(reader, axis, &a)) return;
  for (size_t m = 0; m < fit->match_count; m++) {
    const strut_tree *value = sets[m] ? strut_tree_find(sets[m], key->text, NULL) : NULL;
    strut_study_value *to = &fit->matches[m].values[fit->set_count];
    if (!value)
      strut_report_error(reader->reader, key->place, "every match must set '%s': '%s' does not",
                         a.parameter->name, fit->matches[m].name);
    else if (a.parameter->text)
      to->word = value->kind == STRUT_TREE_SCALAR ? value->text : "";
    else
      strut_study_read_value(reader, &a, value, key->text, m == 0, &to->number);
  }
  a.column->kind = STRUT_RANGE_LIST;
  a.column->number = &first->number, a.column->words = a.parameter->text ? &first->word : NULL;
  fit->set_count++;
}

/* `sets`: of each match, or NULL. */
static void read_sets(strut_study_reader *reader, const strut_tree *const *sets,
                      strut_study_fit *fit) {
  strut_study *study = &reader->file->study;
  size_t most = reader->declared_count;
  strut_study_axis *axis = &study->axes[study->axis_count];
  *axis = (strut_study_axis){.count = 1};
  axis->columns = strut_study_allocate(reader, most + 1, sizeof *axis->columns);
  strut_study_value *values =
      strut_study_allocate(reader, fit->match_count * (most + 1), sizeof *values);
  if (!axis->columns || !values) return;
  for (size_t m = 0; m < fit->match_count; m++) fit->matches[m].values = values + m * (most + 1);
  for (size_t m = 0; m < fit->match_count; m++)
    for (const strut_tree *key = sets[m] ? sets[m]->first : NULL; key; key = key->next->next) {
      const strut_named_rows *known = STRUT_NAMED(axis->columns, axis->column_count);
      if (strut_row_find(known, key->text) == axis->column_count)
        add_set(reader, sets, key, axis, fit);
    }
  if (axis->column_count) study->axis_count++;
}

/* ---- all of it ---- */

/* The axis that numbers the fits: of starts, beside the best, of both ends of each interval, without each match. */
static void add_rows(strut_study_reader *reader, strut_study_fit *fit, size_t variables,
                     strut_study_axis *axis) {
  size_t numbers_before = 0;
  for (size_t m = 0; m < fit->match_count; m++)
    for (size_t s = 0; s < fit->matches[m].series_count; s++) {
      fit->matches[m].series[s].first = numbers_before;
      numbers_before += fit->matches[m].count;
    }
  fit->beside_count = variables;
  for (size_t m = 0; m < fit->match_count; m++) fit->beside_count += fit->matches[m].align.delay;
  fit->omission_count = fit->match_count > 1 ? fit->match_count : 0;
  size_t count = (size_t)fit->starts + STRUT_FIT_ROUNDS * fit->beside_count + 2 * variables +
                 fit->omission_count;
  double *numbers = strut_study_allocate(reader, count, sizeof *numbers);
  *axis = (strut_study_axis){.count = numbers ? (int64_t)count : 1, .column_count = 1};
  axis->columns = strut_study_allocate(reader, 1, sizeof *axis->columns);
  for (size_t i = 0; i < count && numbers; i++) numbers[i] = (double)(i + 1);
  if (axis->columns)
    axis->columns[0] = (strut_study_column){.name = "fit", .unit = "1", .number = numbers};
  reader->file->column_count++; /* a setting without a name: no parameter */
}

/* Several matches, or numbers of several dimensions, can be weighed only by their noise. */
static void require_noise(strut_study_reader *reader, const strut_tree *matches,
                          const strut_study_fit *fit) {
  for (size_t m = 0; m < fit->match_count; m++) {
    const strut_fit_match *match = &fit->matches[m];
    bool several = fit->match_count > 1;
    for (size_t s = 1; s < match->series_count; s++)
      several = several || strcmp(match->series[s].unit, match->series[0].unit) != 0;
    if (several && match->series_count && !(match->noise > 0.0))
      strut_report_error(reader->reader, matches->place,
                         "match '%s' lacks 'noise', the standard deviation of its numbers: without "
                         "it several kinds of numbers cannot be weighed",
                         match->name);
  }
}

/* The same numbers, twice, would seem to be twice as many. */
static void refuse_twice(strut_study_reader *reader, const strut_fit_match *a,
                         const strut_fit_match *b) {
  for (size_t s = 0; s < a->series_count; s++)
    for (size_t k = 0; k < b->series_count; k++) {
      const strut_fit_series *first = &b->series[k], *second = &a->series[s];
      if (first != second && !second->empty && first->measured == second->measured &&
          (a != b || k < s))
        strut_report_error(reader->reader,
                           strut_place_at(second->place.line, second->place.column, 1),
                           "the numbers of '%s' are compared already, with '%s' of match '%s'",
                           strut_sanitised_text(reader->reader, second->of), first->of, b->name);
    }
}

/* The first values of all axes. */
static strut_study_value *first_values(strut_study_reader *reader) {
  const strut_study *study = &reader->file->study;
  strut_study_value *values = strut_study_allocate(reader, reader->file->column_count + 1,
                                                   sizeof *values),
                    *value = values;
  for (size_t i = 0; i < study->axis_count && values; i++)
    for (size_t c = 0; c < study->axes[i].column_count; c++, value++) {
      const strut_study_column *column = &study->axes[i].columns[c];
      value->number = column->number ? column->number[0] : (double)NAN;
      value->word = column->word ? column->words[0] : NULL;
    }
  return values;
}

/* Times in another unit than that of their column make runs that are much longer than the model's own, or do not end. */
static void check_durations(strut_study_reader *reader, const strut_tree *matches,
                            const strut_study_fit *fit) {
  strut_setup setup;
  strut_error error = {0};
  char message[200];
  const strut_tree *key = matches->first;
  const strut_study_value *values = reader->reader->failed ? NULL : first_values(reader);
  if (!values || strut_study_setup(reader->file, values, &setup, &error)) return;
  double own = strut_experiment_span(&setup.experiment, &setup.scene).duration;
  for (size_t m = 0; m < fit->match_count; m++, key = key->next->next) {
    const strut_fit_match *match = &fit->matches[m];
    double last = match->kind == STRUT_FIT_MOTION ? match->at[match->count - 1] : 0.0;
    if (match->align.delay) last -= match->at[0];
    if (!(last > USUAL * own && own > 0.0)) continue;
    const strut_tree *value = strut_tree_find(key->next, "time", NULL);
    reading self = {0};
    strut_data_find(reader->reader->tables, reader->reader->table_count, value->text, &self.table);
    snprintf(message, sizeof message,
             "the runs of match '%.40s' would last %.4g s, %.3g times the model's own of %.4g s: "
             "check the unit of this column",
             match->name, last, last / own, own);
    if (last > MOST * own)
      refuse_number(reader, &self, value, match->at, match->count - 1, message);
    else
      strut_note(reader->reader->diagnostics, value->place, "%s", message);
  }
  strut_setup_free(&setup);
}

bool strut_study_fit_computes(const strut_study_fit *fit, const char *words) {
  const char *const all = strut_key_at(STRUT_KEY_MATCH_COMPUTE)->words;
  char word[40];
  bool found = false;
  for (size_t m = 0; m < fit->match_count && !found; m++)
    found = strut_word_at(all, (int)fit->matches[m].compute, word, sizeof word) &&
            strut_word_find(words, word) >= 0;
  return found;
}

/* Keys of the study that no match has a use for. */
static void refuse_unused(strut_study_reader *reader, strut_fields *top,
                          const strut_study_fit *fit) {
  int first = strut_section_first(STRUT_SECTION_STUDY), n = strut_section_size(STRUT_SECTION_STUDY);
  for (int k = first; k < first + n; k++) {
    const strut_slot *slot = strut_slot_of(top, k);
    const char *words = strut_study_key_computes(k);
    if (words && slot->state == STRUT_GIVEN && !strut_study_fit_computes(fit, words))
      strut_report_error(reader->reader, slot->key->place, "no match of the fit uses '%s'",
                         slot->key->text);
  }
}

void strut_study_read_fit(strut_study_reader *reader, strut_fields *top) {
  static const int others[] = {STRUT_KEY_STUDY_AXES,         STRUT_KEY_STUDY_VARIANTS,
                               STRUT_KEY_STUDY_REFINE,       STRUT_KEY_STUDY_SEARCH,
                               STRUT_KEY_STUDY_FOLLOW,       STRUT_KEY_STUDY_SENSITIVITY,
                               STRUT_KEY_STUDY_TRAJECTORIES, STRUT_KEY_STUDY_CHECK,
                               STRUT_KEY_STUDY_KEEP,         STRUT_KEY_STUDY_COMPUTE};
  const strut_slot *slot = strut_slot_of(top, STRUT_KEY_STUDY_FIT);
  strut_study *study = &reader->file->study;
  strut_fields fields;
  if (slot->state != STRUT_GIVEN) return;
  strut_study_exclude(reader, top, slot, others, sizeof others / sizeof others[0]);
  strut_study_fit *fit = strut_study_allocate(reader, 1, sizeof *fit);
  if (!fit || !study->axes || reader->reader->failed) return;
  *fit = (strut_study_fit){.starts = 8, .seed = 1};
  strut_read_object(reader->reader, STRUT_SECTION_FIT, slot->value, fit_owner, &fields, fit);
  const strut_slot *over = strut_slot_of(&fields, STRUT_KEY_FIT_OVER);
  const strut_slot *matches = strut_slot_of(&fields, STRUT_KEY_FIT_MATCH);
  if (over->state != STRUT_GIVEN || matches->state != STRUT_GIVEN) return;
  size_t count = matches->value->count;
  if (!count || count > STRUT_FIT_MOST_MATCHES) {
    strut_report_error(reader->reader, matches->value->place,
                       "a fit has 1 to %d matches, found %zu", STRUT_FIT_MOST_MATCHES, count);
    return;
  }
  fit->matches = strut_study_allocate(reader, count, sizeof *fit->matches);
  if (!fit->matches) return;
  const strut_tree *sets[STRUT_FIT_MOST_MATCHES];
  for (const strut_tree *key = matches->value->first; key; key = key->next->next) {
    bool map = key->next->kind == STRUT_TREE_MAP;
    const strut_tree *set = map ? strut_tree_find(key->next, "set", NULL) : NULL;
    sets[fit->match_count] = set && set->kind == STRUT_TREE_MAP ? set : NULL;
    read_match(reader, key, &fit->matches[fit->match_count++]);
  }
  require_noise(reader, matches->value, fit);
  for (size_t m = 0; m < fit->match_count; m++)
    for (size_t k = 0; k <= m; k++) refuse_twice(reader, &fit->matches[m], &fit->matches[k]);
  refuse_unused(reader, top, fit);
  strut_study_axis *rows = &study->axes[study->axis_count++];
  add_rows(reader, fit, over->value->count, rows);
  read_over(reader, over, fit);
  read_sets(reader, sets, fit);
  if (reader->reader->failed) return;
  study->fit = fit;
  check_durations(reader, matches->value, fit);
}
