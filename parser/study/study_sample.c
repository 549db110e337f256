/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An axis of parameters from distributions. See study_reader.h; the numbers are made by scene/sample. */
#include <string.h>

#include "engine/scene/sample.h"
#include "parser/study/study_reader.h"

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
  if (slot->value->count != wanted) {
    strut_report_error(r->reader, slot->value->place,
                       "expected %zu numbers for '%s' of %s, found %s", wanted, name,
                       strut_owner_text(r->reader, owner), strut_found(r->reader, slot->value));
    return false;
  }
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
  if (a->parameter->text) {
    strut_report_error(r->reader, a->key->place,
                       "parameter '%s' is a text, which has no distribution", a->parameter->name);
    return false;
  }
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
  if (over->count == 0 || over->count > most) {
    strut_report_error(r->reader, over->place,
                       "expected 1 to %zu parameters for 'over' of %s, found %zu", most,
                       strut_owner_text(r->reader, owner), (size_t)over->count);
    return false;
  }
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
  strut_read_fields(r->reader, STRUT_SECTION_SAMPLE, value, sample_owner, &fields);
  if (!fields.broken) strut_require(r->reader, &fields, sample_owner, value->place);
  const strut_slot *over = strut_slot_of(&fields, STRUT_KEY_SAMPLE_OVER);
  if (over->state != STRUT_GIVEN) return;
  strut_store_fields(r->reader, &fields, sample_owner, &r->file->arena, &keys, sizeof keys);
  axis->count = keys.count;
  bool fine = strut_study_read_distributions(r, over->value, sample_owner,
                                             STRUT_SAMPLE_MOST_NUMBERS, axis, distributions);
  if (fine && !fields.broken) make_values(r, &keys, axis, distributions);
}
