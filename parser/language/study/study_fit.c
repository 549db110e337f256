/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a study fits: parameters, and the measured numbers that the model shall match. See study_reader.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "parser/language/study/study_reader.h"

static const strut_owner fit_owner = {"the fit", NULL};

/* How often a run may be as long as the model's own, and how often it is usually. */
static const double MOST = 1e7, USUAL = 100.0;

/* A match while it is read. */
typedef struct reading {
  strut_study_reader *study;
  strut_reader *reader;
  strut_fit_match *to;
  strut_owner owner;
  strut_fields fields;           /* of its own keys */
  const strut_tree *rest;        /* a mapping of what is compared */
  const strut_data_table *table; /* of all its numbers; NULL: they are single ones */
} reading;

/* ---- parameters ---- */

static void read_over(strut_study_reader *reader, const strut_slot *over, strut_study_fit *fit) {
  strut_study_read_variables(reader, over, "the fit", &fit->variables, &fit->variable_count,
                             &fit->column);
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

/* Does the model itself measure a quantity of that name? */
static bool is_measured(const strut_study_file *file, const char *name) {
  const char *const keys[] = {"run", "measure", "quantities", name};
  const strut_tree *at = file->source_count ? file->sources[0]->document.root : NULL;
  for (size_t i = 0; i < sizeof keys / sizeof *keys && at; i++)
    at = at->kind == STRUT_TREE_MAP ? strut_tree_find(at, keys[i], NULL) : NULL;
  return at != NULL;
}

/* Is a key the match's own, perhaps misspelt? What is compared has a column or a number, and another name. */
static bool is_own(const reading *self, const strut_tree *key) {
  if (strut_key_find(STRUT_SECTION_MATCH, key->text) >= 0) return true;
  if (key->next->kind != STRUT_TREE_SCALAR) return true;
  return !strchr(key->text, '.') && !is_measured(self->study->file, key->text) &&
         strut_did_you_mean(key->text, match_key, NULL);
}

/* Reads the match's own keys, and keeps the others in `rest`, which is NULL where there is no mapping. */
static void divide(reading *self, const strut_tree *map) {
  strut_arena *arena = &self->reader->scratch;
  strut_tree_builder own = strut_tree_begin(arena, map), rest = own;
  bool given = map->kind == STRUT_TREE_MAP;
  if (given) rest = strut_tree_begin(arena, map);
  for (const strut_tree *key = map->first; given && key; key = key->next->next)
    if (!strut_tree_share(is_own(self, key) ? &own : &rest, arena, key, key->next))
      self->reader->out_of_memory = true;
  strut_read_object(self->reader, STRUT_SECTION_MATCH, given && own.map ? own.map : map,
                    self->owner, &self->fields, self->to);
  self->rest = given ? rest.map : NULL;
}

/* Refuses number i behind a key, in the file of its table where it has one. */
static bool refuse(const reading *self, const strut_tree *value, const strut_data_column *column,
                   size_t i, const char *flaw) {
  return self->table ? strut_refuse_data(self->reader, value, self->table, column, i, flaw)
                     : strut_report_error(self->reader, value->place, "%s", flaw);
}

/* All numbers of a match are columns of one table, or single ones (NULL). */
static bool keep_table(reading *self, const strut_tree *value, const strut_data_table *table) {
  if (self->to->count && table != self->table)
    return strut_report_error(self->reader, value->place,
                              "match '%s' has %s%s%s: give other numbers a match of their own",
                              self->to->name, self->table ? "columns of '" : "single numbers",
                              self->table ? self->table->name : "", self->table ? "'" : "");
  self->table = table;
  self->to->count = table ? table->row_count : 1;
  return true;
}

static const strut_data_column *read_column(reading *self, const strut_tree *value, const char *key,
                                            const strut_dimension *dimension) {
  const strut_data_table *table;
  const strut_data_column *column =
      strut_read_data_column(self->reader, value, key, self->owner, dimension, &table);
  return column && keep_table(self, value, table) ? column : NULL;
}

/* Times in another unit than that of their column make runs that are much longer than the model's own, or do not end. */
static void check_duration(reading *self, const strut_slot *slot, const strut_data_column *times,
                           double own) {
  char message[200];
  const strut_fit_match *to = self->to;
  double last = to->at[to->count - 1] - (to->align.delay ? to->at[0] : 0.0);
  if (to->at[0] < 0.0 && !to->align.delay)
    strut_report_error(self->reader, slot->value->place,
                       "the times of match '%s' begin before 0, where the run starts: let 'align' "
                       "have 'delay: free'",
                       to->name);
  if (!(last > USUAL * own && own > 0.0)) return;
  snprintf(message, sizeof message,
           "the runs of match '%.40s' would last %.4g s, %.3g times the model's own of %.4g s: "
           "check the unit of this column",
           to->name, last, last / own, own);
  if (last > MOST * own)
    refuse(self, slot->value, times, to->count - 1, message);
  else
    strut_note(self->reader->diagnostics, slot->value->place, "%s", message);
}

/* The times of a motion, ascending, or the displacements of a curve, without gaps. False: that was reported. */
static bool read_axis(reading *self, double own) {
  strut_fit_match *to = self->to;
  bool motion = to->kind == STRUT_FIT_MOTION;
  const strut_dimension dimensions[] = {STRUT_DIM_LENGTH, STRUT_DIM_TIME};
  const strut_slot *slot =
      strut_slot_of(&self->fields, motion ? STRUT_KEY_MATCH_TIME : STRUT_KEY_MATCH_DISPLACEMENT);
  if (!motion && to->kind != STRUT_FIT_CURVE) return true;
  const strut_data_column *column =
      slot->state == STRUT_GIVEN
          ? read_column(self, slot->value, slot->key->text, &dimensions[motion])
          : NULL;
  for (size_t i = 0; column && i < to->count; i++) {
    const double *at = &column->values[i];
    const char *flaw = !isfinite(*at)                   ? "a number is missing"
                       : motion && i && !(*at > at[-1]) ? "times must ascend"
                       : motion && to->count < 2        ? "a motion needs two times or more"
                                                        : NULL;
    if (flaw) return refuse(self, slot->value, column, i, flaw);
  }
  if (column) to->at = column->values;
  if (column && motion) check_duration(self, slot, column, own);
  return column != NULL;
}

static void read_noise(reading *self) {
  const strut_slot *slot = strut_slot_of(&self->fields, STRUT_KEY_MATCH_NOISE);
  strut_quantity q;
  if (slot->state != STRUT_GIVEN ||
      !strut_read_quantity(self->reader, slot->value, "noise", self->owner, &q))
    return;
  self->to->noise = q.value;
  if (!q.bare) self->to->noise_unit = strut_dimension_unit(q.dimension);
  if (!(q.value > 0.0))
    strut_report_error(self->reader, slot->value->place, "'noise' of match '%s' must be above 0",
                       self->to->name);
}

/* A column of the match's table, or of a number of its own; NULL: that was reported. */
static const strut_data_column *read_numbers(reading *self, const strut_tree *value,
                                             const char *of) {
  bool plain = value->kind == STRUT_TREE_SCALAR && !value->quoted && !self->to->at &&
               strpbrk(value->text, "0123456789+-") == value->text;
  const strut_data_column *column = plain ? NULL : read_column(self, value, of, NULL);
  if (column && column->gap_count == self->to->count)
    return refuse(self, value, column, 0, "there are no numbers") ? column : NULL;
  if (!plain) return column;
  strut_quantity q;
  double *number = strut_study_allocate(self->study, 1, sizeof *number);
  strut_data_column *own = strut_study_allocate(self->study, 1, sizeof *own);
  if (!number || !own || !strut_read_quantity(self->reader, value, of, self->owner, &q) ||
      !keep_table(self, value, NULL))
    return NULL;
  *number = q.value;
  *own = (strut_data_column){.unit = q.bare ? "1" : "", .dimension = q.dimension, .values = number};
  return own;
}

/* A noise without unit is in that of the numbers, which must have one in common, and finite squares in the sum. */
static bool check_numbers(reading *self, const strut_tree *value, const strut_fit_series *series) {
  strut_fit_match *to = self->to;
  double noise = to->noise > 0.0 ? fmin(to->noise, 1.0) : 1.0;
  if (!to->noise_unit) to->noise_unit = series->unit;
  if (to->noise > 0.0 && strcmp(to->noise_unit, series->unit) != 0)
    return strut_report_error(self->reader, value->place,
                              "'noise' of match '%s' is in %s, this in %s: give numbers of another "
                              "dimension a match of their own",
                              to->name, to->noise_unit, series->unit);
  for (size_t i = 0; i < to->count; i++)
    if (fabs(series->column->values[i]) > STRUT_DATA_MOST_NUMBER * noise)
      return refuse(self, value, series->column, i,
                    "a number this large has no finite square in the sum of a fit");
  return true;
}

static void add_series(reading *self, const strut_tree *key) {
  strut_fit_match *to = self->to;
  strut_fit_series *series = &to->series[to->series_count];
  *series = (strut_fit_series){.of = key->text, .place = {key->place.line, key->place.column}};
  const strut_data_column *column = series->column = read_numbers(self, key->next, key->text);
  if (!column) return;
  series->unit = strcmp(column->unit, "1") == 0 ? "1" : strut_dimension_unit(column->dimension);
  if (!check_numbers(self, key->next, series)) return;
  to->series_count++;
  bool moves = to->kind == STRUT_FIT_MOTION || to->kind == STRUT_FIT_REST;
  strut_study_file *file = self->study->file;
  if (moves && !is_measured(file, key->text) && !strut_study_measure(file, key))
    self->reader->out_of_memory = true;
}

/* The other coordinates of places, which were not measured but turn with those that were. */
static void add_partners(reading *self) {
  strut_fit_match *to = self->to;
  for (const strut_tree *key = self->rest->first; key; key = key->next->next) {
    size_t length = strlen(key->text);
    char *text = strut_arena_text(&self->study->file->arena, key->text, length);
    char axis = text && length > 2 && text[length - 2] == '.' ? text[length - 1] : '\0';
    if (axis != 'x' && axis != 'y') continue;
    text[length - 1] = axis == 'x' ? 'y' : 'x';
    if (strut_tree_find(self->rest, text, NULL)) continue;
    strut_tree other = *key;
    other.text = text;
    to->series[to->series_count++] =
        (strut_fit_series){.of = text, .place = {key->place.line, key->place.column}, .unit = "m"};
    if (!strut_study_measure(self->study->file, &other)) self->reader->out_of_memory = true;
  }
}

/* What kind of match it is, by the keys that it has; and what such a match cannot have, or lacks. */
static void choose_kind(reading *self, const strut_tree *key) {
  strut_reader *reader = self->reader;
  strut_fit_match *to = self->to;
  bool over_time = strut_mentions(&self->fields, STRUT_KEY_MATCH_TIME);
  bool curve = strut_mentions(&self->fields, STRUT_KEY_MATCH_DISPLACEMENT);
  bool table = strut_mentions(&self->fields, STRUT_KEY_MATCH_COMPUTE);
  const strut_slot *align = strut_slot_of(&self->fields, STRUT_KEY_MATCH_ALIGN);
  const strut_tree *first = self->rest->first;
  to->kind = over_time ? STRUT_FIT_MOTION
             : curve   ? STRUT_FIT_CURVE
             : table   ? STRUT_FIT_TABLE
                       : STRUT_FIT_REST;
  if (curve) to->compute = STRUT_COMPUTE_PATH;
  if (to->align.delay && !over_time)
    strut_report_error(reader, align->value->place, "a delay needs the 'time' of a motion");
  curve = to->kind == STRUT_FIT_CURVE;
  if (curve && first)
    strut_report_error(reader, first->place,
                       "a match of a displacement compares its 'force' alone, not '%s'",
                       strut_sanitised_text(reader, first->text));
  if (!curve && !first)
    strut_report_error(reader, key->place,
                       "match '%s' compares nothing: add what the model has, such as "
                       "'n1.x: film.x'",
                       key->text);
}

/* `own`: how long the model's own run lasts [s]; 0: not known. Returns the mapping of what it sets, or NULL. */
static const strut_tree *read_match(strut_study_reader *study, const strut_tree *key, double own,
                                    strut_fit_match *to) {
  strut_reader *r = study->reader;
  reading self = {.study = study, .reader = r, .to = to, .owner = {"match", key->text}};
  strut_read_name(r, key, "match");
  *to = (strut_fit_match){.name = key->text};
  divide(&self, key->next);
  if (!self.rest) return NULL;
  const strut_slot *force = strut_slot_of(&self.fields, STRUT_KEY_MATCH_FORCE);
  to->series = strut_study_allocate(study, 2 * (size_t)self.rest->count + 1, sizeof *to->series);
  choose_kind(&self, key);
  read_noise(&self);
  if (!to->series || !read_axis(&self, own)) return NULL;
  if (to->kind == STRUT_FIT_CURVE && force->state == STRUT_GIVEN) add_series(&self, force->key);
  const strut_tree *of = to->kind == STRUT_FIT_CURVE ? NULL : self.rest->first;
  for (; of; of = of->next->next) add_series(&self, of);
  if (to->align.rotate && to->series_count) add_partners(&self);
  return strut_given(&self.fields, STRUT_KEY_MATCH_SET);
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
  *axis = (strut_study_axis){.count = fit->starts + STRUT_FIT_ROUNDS * (int64_t)fit->beside_count +
                                      2 * (int64_t)variables + (int64_t)fit->omission_count,
                             .column_count = 1};
  axis->columns = strut_study_allocate(reader, 1, sizeof *axis->columns);
  if (axis->columns)
    axis->columns[0] = (strut_study_column){.name = "fit",
                                            .unit = "1",
                                            .kind = STRUT_RANGE_STEP,
                                            .from = 1.0,
                                            .to = (double)axis->count,
                                            .step = 1.0};
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
      if (second->column && first->column == second->column && (a != b || k < s))
        strut_report_error(reader->reader,
                           strut_place_at(second->place.line, second->place.column, 1),
                           "the numbers of '%s' are compared already, with '%s' of match '%s'",
                           strut_sanitised_text(reader->reader, second->of), first->of, b->name);
    }
}

/* How long the model's own run lasts [s]; 0: that is not known. */
static double own_duration(const strut_study_file *file) {
  strut_setup setup;
  strut_diagnostics unused = {0};
  double duration = 0.0;
  if (strut_scene_source_read(file->sources[0], file->settings, file->setting_count,
                              STRUT_FOR_RUN_STEP_LATER, &unused, &setup) == STRUT_OK) {
    duration = strut_experiment_span(&setup.experiment, &setup.scene).duration;
    strut_setup_free(&setup);
  }
  strut_diagnostics_free(&unused);
  return duration;
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
  const strut_slot *slot = strut_slot_of(top, STRUT_KEY_STUDY_FIT);
  strut_study *study = &reader->file->study;
  strut_fields fields;
  if (slot->state != STRUT_GIVEN) return;
  strut_study_fit *fit = strut_study_allocate(reader, 1, sizeof *fit);
  if (!fit || !study->axes || reader->reader->failed) return;
  *fit = (strut_study_fit){.starts = 8, .seed = 1};
  strut_read_object(reader->reader, STRUT_SECTION_FIT, slot->value, fit_owner, &fields, fit);
  const strut_slot *over = strut_slot_of(&fields, STRUT_KEY_FIT_OVER);
  const strut_slot *matches = strut_slot_of(&fields, STRUT_KEY_FIT_MATCH);
  if (over->state != STRUT_GIVEN || matches->state != STRUT_GIVEN) return;
  size_t count = matches->value->count;
  fit->matches = strut_study_allocate(reader, count, sizeof *fit->matches);
  if (!fit->matches) return;
  const strut_tree *sets[STRUT_FIT_MOST_MATCHES];
  double own = own_duration(reader->file);
  for (const strut_tree *key = matches->value->first; key;
       key = key->next->next, fit->match_count++)
    sets[fit->match_count] = read_match(reader, key, own, &fit->matches[fit->match_count]);
  require_noise(reader, matches->value, fit);
  for (size_t m = 0; m < fit->match_count; m++)
    for (size_t k = 0; k <= m; k++) refuse_twice(reader, &fit->matches[m], &fit->matches[k]);
  refuse_unused(reader, top, fit);
  strut_study_axis *rows = &study->axes[study->axis_count++];
  add_rows(reader, fit, over->value->count, rows);
  read_over(reader, over, fit);
  read_sets(reader, sets, fit);
  if (!reader->reader->failed) study->fit = fit;
}
