/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The axes of a study, what it refines, what it wants of its points, and what it follows. See study_reader.h. */
#include <math.h>
#include <string.h>

#include "parser/language/study/study_reader.h"

typedef strut_study_along along;

static strut_owner owner_of(const along *self) {
  return (strut_owner){self->of ? "variable" : "axis", self->parameter->name};
}

bool strut_study_read_value(strut_study_reader *study_reader, along *self, const strut_tree *value,
                            const char *key, bool first, double *number) {
  strut_quantity q;
  char expected[200];
  strut_reader *reader = study_reader->reader;
  strut_setting *setting = self->setting;
  if (!strut_read_any_quantity(reader, value, key, owner_of(self), "a number", &q)) return false;
  *number = q.value;
  const strut_file_unit unit = strut_unit_of_text(value->text, NULL);
  if (unit.name) self->column->shown = unit;
  if (first && setting->bare && !q.bare) {
    setting->bare = false;
    setting->dimension = q.dimension;
    self->column->unit = strut_dimension_unit(q.dimension);
  }
  if (q.bare || (!setting->bare && strut_dimension_equal(q.dimension, setting->dimension)))
    return true;
  return strut_refuse_dimension(
      reader, value, key, owner_of(self),
      setting->bare ? "a number without unit, as before,"
                    : strut_expected_number(setting->dimension, expected, sizeof expected),
      q.dimension);
}

bool strut_study_store_value(strut_study_reader *reader, along *self, strut_fields *fields, int key,
                             bool first, void *object) {
  const strut_key *k = strut_key_at(key);
  const strut_slot *slot = strut_slot_of(fields, key);
  if (slot->state != STRUT_GIVEN) return slot->state == STRUT_ABSENT;
  return strut_study_read_value(reader, self, slot->value, k->name, first,
                                (double *)(void *)((char *)object + k->field.offset));
}

static bool read_list(strut_study_reader *reader, along *self) {
  size_t count = self->value->count, i = 0;
  double *numbers = strut_study_allocate(reader, count, sizeof *numbers);
  const char **words = strut_study_allocate(reader, count, sizeof *words);
  bool fine = numbers && words;
  self->count = (int64_t)count;
  if (!count)
    return strut_report_error(reader->reader, self->value->place, "axis '%s' has no values",
                              self->parameter->name);
  for (const strut_tree *item = self->value->first; item && fine; item = item->next, i++) {
    if (!self->parameter->text) {
      fine =
          strut_study_read_value(reader, self, item, self->parameter->name, i == 0, &numbers[i]) &&
          fine;
    } else if (strut_read_scalar(reader->reader, item, self->parameter->name, owner_of(self),
                                 "a text")) {
      words[i] = item->text;
      if (strlen(item->text) < 24) continue;
      fine = strut_report_error(reader->reader, item->place,
                                "texts of an axis may have at most 23 bytes, found %zu",
                                strlen(item->text));
    } else {
      fine = false;
    }
  }
  self->column->kind = STRUT_RANGE_LIST;
  self->column->number = numbers;
  self->column->words = words;
  return fine;
}

static bool refuse_range(strut_study_reader *reader, const along *self, const char *why) {
  return strut_report_error(reader->reader, self->value->place, "the range of axis '%s' %s",
                            self->parameter->name, why);
}

/* from, to and step: how many values? The last is `to` itself where the steps meet it. */
static bool count_steps(strut_study_reader *reader, along *self, double step) {
  strut_study_column *column = self->column;
  double steps = (column->to - column->from) / step;
  if (step == 0.0 || !(steps >= 0.0) || !isfinite(steps))
    return refuse_range(reader, self, "never reaches 'to' with this 'step'");
  double whole = floor(steps * (1.0 + 1e-12) + 1e-9);
  if (whole >= (double)STRUT_STUDY_MOST_POINTS)
    return refuse_range(reader, self, "has more than 1e9 values");
  self->count = (int64_t)whole + 1;
  bool meets = fabs(steps - whole) <= 1e-9 * fmax(1.0, whole);
  column->kind = meets && self->count > 1 ? STRUT_RANGE_EVEN : STRUT_RANGE_STEP;
  return true;
}

static bool count_even(strut_study_reader *reader, along *self, double count, bool logarithmic) {
  strut_study_column *column = self->column;
  if (count != floor(count) || count > (double)STRUT_STUDY_MOST_POINTS)
    return refuse_range(reader, self, "needs a whole 'count' from 1 to 1e9");
  if (count == 1.0 && column->from != column->to)
    return refuse_range(reader, self, "of one value cannot have both 'from' and 'to'");
  if (logarithmic && !(column->from * column->to > 0.0))
    return refuse_range(reader, self,
                        "cannot be logarithmic: 'from' and 'to' must be on one side of 0");
  self->count = (int64_t)count;
  column->kind = logarithmic ? STRUT_RANGE_RATIO : STRUT_RANGE_EVEN;
  return true;
}

static bool read_range(strut_study_reader *reader, along *self) {
  strut_fields fields;
  if (self->parameter->text)
    return refuse_range(reader, self,
                        "is for numbers; the parameter is a text: give a list of texts");
  strut_range_keys keys = {0};
  if (!strut_read_object(reader->reader, STRUT_SECTION_RANGE, self->value, owner_of(self), &fields,
                         &keys))
    return false;
  bool fine = strut_study_store_value(reader, self, &fields, STRUT_KEY_RANGE_FROM, true, &keys);
  fine = strut_study_store_value(reader, self, &fields, STRUT_KEY_RANGE_TO, false, &keys) && fine;
  fine = strut_study_store_value(reader, self, &fields, STRUT_KEY_RANGE_STEP, false, &keys) && fine;
  self->column->from = keys.from, self->column->to = keys.to, self->column->step = keys.step;
  if (!fine) return false;
  if (keys.count > 0.0) return count_even(reader, self, keys.count, keys.scale == 1);
  if (keys.scale == 1)
    return refuse_range(reader, self, "needs 'count' instead of 'step' where it is logarithmic");
  return count_steps(reader, self, keys.step);
}

/* Names of the table's own columns, which no axis may have. */
static bool is_reserved(const strut_study_reader *reader, const char *name) {
  static const char searching[] = "search|evaluation|objective|objective_2|violation";
  static const char following[] =
      "branch|arclength|velocity|work|amplitude|period_multiple|stable|multiplier|multiplier_angle|"
      "node|detail|word|changes_stability";
  return strut_word_find(STRUT_STUDY_OWN_COLUMNS, name) >= 0 ||
         (reader->variant_count > 0 && strcmp(name, "variant") == 0) ||
         (reader->searching && strut_word_find(searching, name) >= 0) ||
         (reader->following && strut_word_find(following, name) >= 0);
}

bool strut_study_begin_along(strut_study_reader *reader, strut_study_axis *axis, along *self) {
  if (!self->parameter) self->parameter = strut_study_parameter(reader, self->key, self->advice);
  const strut_declared *parameter = self->parameter;
  if (!parameter) return false;
  if (axis) self->column = &axis->columns[axis->column_count++];
  if (axis) self->setting = &reader->file->columns[reader->file->column_count++];
  bool plain = parameter->bare || parameter->text;
  *self->column =
      (strut_study_column){.name = parameter->name,
                           .unit = plain ? "1" : strut_dimension_unit(parameter->dimension),
                           .shown = parameter->shown,
                           .word = parameter->text};
  *self->setting = (strut_setting){.name = parameter->name,
                                   .text = "",
                                   .known = !parameter->text,
                                   .bare = parameter->bare,
                                   .dimension = parameter->dimension,
                                   .place = self->key->place};
  if (!is_reserved(reader, parameter->name)) return true;
  return strut_report_error(
      reader->reader, self->key->place,
      "the table has a column '%s' of its own: give the model's parameter another name",
      parameter->name);
}

bool strut_study_read_along(strut_study_reader *reader, strut_study_axis *axis, along *self) {
  strut_study_begin_along(reader, axis, self);
  if (!self->parameter) return false;
  if (self->value->kind == STRUT_TREE_LIST) return read_list(reader, self);
  if (self->value->kind == STRUT_TREE_MAP) return read_range(reader, self);
  return strut_report_error(
      reader->reader, self->value->place,
      "expected a list, or a range such as {from: 1, to: 2, count: 11}, for axis '%s', "
      "found %s",
      self->parameter->name, strut_found(reader->reader, self->value));
}

/* The mapping whose keys are the axis' parameters: the item itself, or what is zipped in it. */
static const strut_tree *parameters_of(strut_study_reader *reader, const strut_tree *item) {
  if (item->kind != STRUT_TREE_MAP || item->count == 0) {
    strut_report_error(reader->reader, item->place,
                       "expected an axis such as {friction: [0.1, 0.2]}, found %s",
                       strut_found(reader->reader, item));
    return NULL;
  }
  bool zip = strcmp(item->first->text, "zip") == 0;
  if (item->count > 1) {
    strut_report_error(
        reader->reader, item->first->next->next->place,
        "an axis gives one parameter; write parameters that vary together as {zip: {...}}, and "
        "further axes as further items of the list");
    return NULL;
  }
  if (!zip) return item;
  const strut_tree *map = item->first->next;
  if (map->kind == STRUT_TREE_MAP && map->count > 0) return map;
  strut_report_error(reader->reader, map->place,
                     "expected {NAME: [...], NAME: [...]} for 'zip', found %s",
                     strut_found(reader->reader, map));
  return NULL;
}

static void read_axis(strut_study_reader *reader, const strut_tree *item, strut_study_axis *axis) {
  if (strut_study_is_points(reader, item)) {
    strut_study_read_points(reader, item->first->next, axis);
    return;
  }
  if (strut_study_is_sample(reader, item)) {
    strut_study_read_sample(reader, item->first->next, axis);
    return;
  }
  const strut_tree *map = parameters_of(reader, item);
  if (!map) return;
  axis->columns = strut_study_allocate(reader, map->count, sizeof *axis->columns);
  if (!axis->columns) return;
  bool fine = true;
  for (const strut_tree *key = map->first; key; key = key->next->next) {
    along a = {.key = key, .value = key->next};
    fine = strut_study_read_along(reader, axis, &a) && fine;
    if (fine && axis->column_count > 1 && a.count != axis->count)
      fine = strut_report_error(
          reader->reader, key->next->place,
          "zipped parameters need equally many values: '%s' has %lld values, '%s' %lld",
          axis->columns[0].name, (long long)axis->count, a.parameter->name, (long long)a.count);
    if (axis->column_count == 1) axis->count = a.count;
  }
}

/* The axis of the variants, before all others. */
static void add_variants(strut_study_reader *reader) {
  strut_study_file *file = reader->file;
  strut_study_column *column = strut_study_allocate(reader, 1, sizeof *column);
  if (!column) return;
  *column = (strut_study_column){
      .name = "variant", .unit = "1", .word = true, .words = reader->variant_names};
  file->columns[file->column_count++] = (strut_setting){.name = column->name, .bare = true};
  file->study.axes[file->study.axis_count++] = (strut_study_axis){
      .count = (int64_t)reader->variant_count, .column_count = 1, .columns = column};
  file->variants = true;
}

/* Axes, and columns, beside those of parameters: variants, evaluations, fits and the like. */
enum { MOST_OWN = 8 };

void strut_study_read_axes(strut_study_reader *reader, const strut_tree *list,
                           const strut_slot *search) {
  strut_study *study = &reader->file->study;
  size_t listed = list ? list->count : 0;
  size_t most = reader->declared_count + MOST_OWN; /* none is given twice */
  reader->searching = search->state == STRUT_GIVEN;
  study->axes = strut_study_allocate(reader, listed + most, sizeof *study->axes);
  reader->file->columns = strut_study_allocate(reader, most, sizeof *reader->file->columns);
  reader->file->tables = strut_study_allocate(reader, listed + 1, sizeof *reader->file->tables);
  if (!study->axes || !reader->file->columns || !reader->file->tables) return;
  if (reader->variant_count > 0) add_variants(reader);
  for (const strut_tree *item = list ? list->first : NULL; item; item = item->next)
    read_axis(reader, item, &study->axes[study->axis_count++]);
  strut_study_read_search(reader, search);
  double points = 1.0;
  for (size_t i = 0; i < study->axis_count; i++) points *= (double)study->axes[i].count;
  if (points > (double)STRUT_STUDY_MOST_POINTS)
    strut_report_error(reader->reader, list ? list->place : search->key->place,
                       "the axes make %.3g points, a study may have 1e9", points);
}

/* ---- what is refined ---- */

static const strut_owner refine_owner = {"the refinement", NULL};

static bool is_range(const strut_study_axis *axis) {
  bool all = axis->count > 1 && axis->column_count > 0;
  for (size_t i = 0; i < axis->column_count; i++)
    all = all && axis->columns[i].kind != STRUT_RANGE_LIST;
  return all;
}

static bool has_parameter(const strut_study_axis *axis, const char *name) {
  const size_t count = axis->column_count;
  return strut_row_find(STRUT_NAMED(axis->columns, count), name) < count;
}

/* The axis of a named parameter, which must be a range; axis_count where that was reported. */
static size_t find_axis(strut_study_reader *reader, const strut_tree *item) {
  const strut_study *study = &reader->file->study;
  size_t axis = 0;
  if (!strut_read_scalar(reader->reader, item, "axes", refine_owner, "a parameter of an axis"))
    return study->axis_count;
  while (axis < study->axis_count && !has_parameter(&study->axes[axis], item->text)) axis++;
  if (axis < study->axis_count && is_range(&study->axes[axis])) return axis;
  strut_report_error(reader->reader, item->place,
                     axis < study->axis_count
                         ? "axis '%s' has no range such as {from: 1, to: 2, count: 11}: it cannot "
                           "be refined"
                         : "the study has no axis of '%s'",
                     strut_sanitised_text(reader->reader, item->text));
  return study->axis_count;
}

/* The two axes that are named, or the only two that can be refined. */
static bool choose_axes(strut_study_reader *reader, const strut_slot *refine,
                        const strut_slot *named) {
  strut_study *study = &reader->file->study;
  size_t *axes = study->refine.axes, count = 0;
  if (named->state == STRUT_GIVEN) {
    for (const strut_tree *item = named->value->first; item; item = item->next) {
      size_t axis = find_axis(reader, item);
      if (axis == study->axis_count) return false;
      if (count < 2) axes[count] = axis;
      count++;
    }
  } else {
    for (size_t i = 0; i < study->axis_count; i++) {
      if (!is_range(&study->axes[i])) continue;
      if (count < 2) axes[count] = i;
      count++;
    }
  }
  if (count == 2 && axes[0] > axes[1]) {
    size_t first = axes[1];
    axes[1] = axes[0], axes[0] = first;
  }
  if (count == 2 && axes[0] < axes[1]) return true;
  return strut_report_error(
      reader->reader, refine->key->place,
      "'refine' divides two axes with ranges of more than one value, found %zu; name "
      "them: axes: [NAME, NAME]",
      count == 2 ? (size_t)1 : count);
}

/* Gives an axis the values of the finest grid; those of the coarsest keep their bits. */
static void refine_axis(strut_study_axis *axis, int32_t depth) {
  int64_t parts = (int64_t)1 << depth;
  axis->count = (axis->count - 1) * parts + 1;
  for (size_t i = 0; i < axis->column_count; i++) axis->columns[i].step /= (double)parts;
}

void strut_study_read_refine(strut_study_reader *reader, const strut_slot *slot) {
  strut_study *study = &reader->file->study;
  strut_fields fields;
  if (slot->state != STRUT_GIVEN) return;
  bool fine = strut_read_object(reader->reader, STRUT_SECTION_REFINE, slot->value, refine_owner,
                                &fields, study);
  int32_t depth = study->refine.depth;
  study->refine.depth = 0;
  if (!fine || reader->reader->failed) return; /* the axes may be incomplete */
  if (!choose_axes(reader, slot, strut_slot_of(&fields, STRUT_KEY_REFINE_AXES))) return;
  double points = 1.0;
  for (int i = 0; i < 2; i++) refine_axis(&study->axes[study->refine.axes[i]], depth);
  for (size_t i = 0; i < study->axis_count; i++) points *= (double)study->axes[i].count;
  study->refine.depth = depth;
  if (points > (double)STRUT_STUDY_MOST_REFINED)
    strut_report_error(reader->reader, slot->key->place,
                       "the finest grid has %.3g points, a refined study may have %.0e", points,
                       (double)STRUT_STUDY_MOST_REFINED);
}

static const strut_owner shape_owner = {"the shape", NULL};
static const strut_owner curve_owner = {"the curve", NULL};

static void read_shape(strut_study_reader *reader, const strut_slot *slot) {
  strut_study *study = &reader->file->study;
  size_t count = slot->value->count, i = 0;
  study->goal.shape_nodes =
      strut_study_allocate(reader, count + 1, sizeof *study->goal.shape_nodes);
  study->goal.shape = strut_study_allocate(reader, count + 1, sizeof *study->goal.shape);
  if (!study->goal.shape_nodes || !study->goal.shape) return;
  for (const strut_tree *key = slot->value->first; key; key = key->next->next, i++) {
    study->goal.shape_nodes[i] = key->text;
    strut_read_pair(reader->reader, key->next, key->text, shape_owner, STRUT_DIM_LENGTH,
                    study->goal.shape[i]);
  }
  study->goal.shape_count = count;
}

static void read_curve(strut_study_reader *reader, const strut_slot *slot) {
  strut_study *study = &reader->file->study;
  study->goal.curve =
      strut_study_allocate(reader, slot->value->count + 1, sizeof *study->goal.curve);
  if (!study->goal.curve) return;
  for (const strut_tree *item = slot->value->first; item; item = item->next) {
    double *pair = study->goal.curve[study->goal.curve_count];
    if (item->kind != STRUT_TREE_LIST || item->count != 2) {
      strut_refuse_value(reader->reader, item, "curve", (strut_owner){"the study", NULL},
                         "a displacement and a force such as [-1 mm, 2 N]");
      continue;
    }
    if (strut_read_number(reader->reader, item->first, "curve", curve_owner, STRUT_DIM_LENGTH,
                          STRUT_WITHIN(ANY), &pair[0]) &&
        strut_read_number(reader->reader, item->first->next, "curve", curve_owner, STRUT_DIM_FORCE,
                          STRUT_WITHIN(ANY), &pair[1]))
      study->goal.curve_count++;
  }
}

/* A column that is kept needs what it compares with, and what is given a column. */
static void require_pairs(strut_study_reader *reader, strut_fields *top) {
  const strut_study *study = &reader->file->study;
  static const struct {
    strut_keep keep;
    int keys[2];
    const char *word;
  } goals[] = {
      {STRUT_KEEP_STIFFNESS,
       {STRUT_KEY_STUDY_STIFFNESS_AT, STRUT_KEY_STUDY_STIFFNESS_AT},
       "stiffness"},
      {STRUT_KEEP_SHAPE, {STRUT_KEY_STUDY_SHAPE, STRUT_KEY_STUDY_LIKE}, "shape_distance"},
      {STRUT_KEEP_CURVE, {STRUT_KEY_STUDY_CURVE, STRUT_KEY_STUDY_CURVE}, "curve_distance"}};
  for (size_t i = 0; i < sizeof goals / sizeof goals[0]; i++) {
    const strut_slot *first = strut_slot_of(top, goals[i].keys[0]);
    const strut_slot *second = strut_slot_of(top, goals[i].keys[1]);
    bool kept = strut_keep_has(&study->keep, goals[i].keep);
    const strut_slot *given = first->state != STRUT_ABSENT    ? first
                              : second->state != STRUT_ABSENT ? second
                                                              : NULL;
    if (kept && !given)
      strut_report_error(reader->reader, strut_slot_of(top, STRUT_KEY_STUDY_KEEP)->value->place,
                         "'%s' needs '%s' of the study%s", goals[i].word,
                         strut_key_at(goals[i].keys[0])->name,
                         first == second ? "" : ", or 'like'");
    if (!kept && given && given->key)
      strut_report_error(reader->reader, given->key->place,
                         "'%s' is for the column '%s': add it to 'keep'", given->key->text,
                         goals[i].word);
  }
}

void strut_study_read_goals(strut_study_reader *reader, strut_fields *top) {
  const strut_slot *shape = strut_slot_of(top, STRUT_KEY_STUDY_SHAPE);
  const strut_slot *curve = strut_slot_of(top, STRUT_KEY_STUDY_CURVE);
  if (shape->state == STRUT_GIVEN) read_shape(reader, shape);
  if (curve->state == STRUT_GIVEN) read_curve(reader, curve);
  if (curve->state == STRUT_GIVEN && reader->file->study.compute == STRUT_COMPUTE_PATH &&
      (!reader->file->study.path.over || !strchr(reader->file->study.path.over, '.')))
    strut_report_error(reader->reader, curve->key->place,
                       "'curve' is force over the displacement of a node: the path needs "
                       "'over: NODE.x' or 'over: NODE.y'");
  require_pairs(reader, top);
}

/* ---- motions that are followed ---- */

static const strut_owner follow_owner = {"what is followed", NULL};

/* Both ends of the range, and values within it. */
static void read_values(strut_study_reader *reader, strut_fields *fields, strut_study_along *a,
                        strut_study_follow *follow) {
  const strut_slot *from = strut_slot_of(fields, STRUT_KEY_FOLLOW_FROM);
  const strut_slot *to = strut_slot_of(fields, STRUT_KEY_FOLLOW_TO);
  const strut_slot *at = strut_slot_of(fields, STRUT_KEY_FOLLOW_AT);
  bool fine = from->state == STRUT_GIVEN && to->state == STRUT_GIVEN &&
              strut_study_store_value(reader, a, fields, STRUT_KEY_FOLLOW_FROM, true, follow) &&
              strut_study_store_value(reader, a, fields, STRUT_KEY_FOLLOW_TO, false, follow);
  if (fine && !(follow->from < follow->to))
    fine = strut_report_error(reader->reader, to->value->place,
                              "'to' of what is followed must be above 'from'");
  if (!fine || at->state != STRUT_GIVEN) return;
  double *values = strut_study_allocate(reader, at->value->count, sizeof *values);
  follow->at = values;
  for (const strut_tree *item = at->value->first; item && values; item = item->next) {
    double *value = &values[follow->at_count++];
    if (!strut_study_read_value(reader, a, item, "at", false, value)) continue;
    if (*value < follow->from || *value > follow->to)
      strut_report_error(reader->reader, item->place, "'%s' of 'at' is not within 'from' and 'to'",
                         strut_sanitised_text(reader->reader, item->text));
  }
}

/* The parameter, its range and its unit. */
static void read_over(strut_study_reader *reader, strut_fields *fields,
                      strut_study_follow *follow) {
  const strut_slot *over = strut_slot_of(fields, STRUT_KEY_FOLLOW_OVER);
  strut_study_column unused = {0};
  strut_study_along a = {.key = over->value, .column = &unused, .setting = &reader->file->followed};
  if (over->state != STRUT_GIVEN) return;
  if (!strut_study_begin_along(reader, NULL, &a)) return;
  if (a.parameter->text) {
    strut_report_error(reader->reader, over->value->place,
                       "parameter '%s' is a text, over which no motion is followed",
                       a.parameter->name);
    return;
  }
  follow->over = a.parameter->name;
  read_values(reader, fields, &a, follow);
  follow->unit = a.setting->bare ? "" : strut_dimension_unit(a.setting->dimension);
  follow->shown = unused.shown;
  if (strcmp(follow->unit, "1") == 0 || strcmp(follow->unit, "SI") == 0) follow->unit = "";
}

void strut_study_read_follow(strut_study_reader *reader, strut_fields *top) {
  const strut_slot *slot = strut_slot_of(top, STRUT_KEY_STUDY_FOLLOW);
  strut_study *study = &reader->file->study;
  strut_fields fields;
  if (slot->state != STRUT_GIVEN) return;
  const strut_slot *compute = strut_slot_of(top, STRUT_KEY_STUDY_COMPUTE);
  if (compute->state == STRUT_GIVEN && study->compute != STRUT_COMPUTE_RUN)
    strut_report_error(reader->reader, compute->value->place,
                       "a study that follows motions computes no '%s'", compute->value->text);
  strut_study_follow *follow = strut_study_allocate(reader, 1, sizeof *follow);
  if (!follow) return;
  strut_read_object(reader->reader, STRUT_SECTION_FOLLOW, slot->value, follow_owner, &fields,
                    follow);
  read_over(reader, &fields, follow);
  study->follow = follow;
}
