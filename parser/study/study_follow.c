/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A study that follows motions over a parameter. See study_reader.h; engine/study/follow follows them. */
#include <math.h>
#include <string.h>

#include "parser/study/study_reader.h"

static const strut_owner follow_owner = {"what is followed", NULL};

/* Keys that choose or judge points in another way. */
static void refuse_others(strut_study_reader *r, strut_fields *top, const strut_slot *own) {
  static const int others[] = {
      STRUT_KEY_STUDY_REFINE,      STRUT_KEY_STUDY_TRAJECTORIES, STRUT_KEY_STUDY_SEARCH,
      STRUT_KEY_STUDY_SENSITIVITY, STRUT_KEY_STUDY_KEEP,         STRUT_KEY_STUDY_CHECK,
      STRUT_KEY_STUDY_LIMIT,       STRUT_KEY_STUDY_SHAPE,        STRUT_KEY_STUDY_LIKE};
  for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
    const strut_slot *slot = strut_slot_of(top, others[i]);
    if (slot->state == STRUT_GIVEN)
      strut_report_error(r->reader, slot->key->place,
                         "'%s' and '%s' exclude each other: use two studies", slot->key->text,
                         own->key->text);
  }
  const strut_slot *compute = strut_slot_of(top, STRUT_KEY_STUDY_COMPUTE);
  if (compute->state == STRUT_GIVEN && r->file->study.compute != STRUT_COMPUTE_RUN)
    strut_report_error(r->reader, compute->value->place,
                       "a study that follows motions computes no '%s'", compute->value->text);
}

/* Both ends of the range, and values within it. */
static void read_values(strut_study_reader *r, strut_fields *fields, strut_study_along *a,
                        strut_study_follow *f) {
  const strut_slot *from = strut_slot_of(fields, STRUT_KEY_FOLLOW_FROM);
  const strut_slot *to = strut_slot_of(fields, STRUT_KEY_FOLLOW_TO);
  const strut_slot *at = strut_slot_of(fields, STRUT_KEY_FOLLOW_AT);
  bool fine = from->state == STRUT_GIVEN && to->state == STRUT_GIVEN &&
              strut_study_store_value(r, a, fields, STRUT_KEY_FOLLOW_FROM, true, f) &&
              strut_study_store_value(r, a, fields, STRUT_KEY_FOLLOW_TO, false, f);
  if (fine && !(f->from < f->to)) {
    strut_report_error(r->reader, to->value->place,
                       "'to' of what is followed must be above 'from'");
    fine = false;
  }
  if (!fine || at->state != STRUT_GIVEN) return;
  if (!at->value->count || at->value->count > STRUT_STUDY_FOLLOW_MOST_AT) {
    strut_report_error(r->reader, at->value->place, "'at' may have 1 to %d values, found %zu",
                       STRUT_STUDY_FOLLOW_MOST_AT, (size_t)at->value->count);
    return;
  }
  double *values =
      strut_reader_allocate(r->reader, &r->file->arena, at->value->count, sizeof *values);
  f->at = values;
  for (const strut_tree *item = at->value->first; item && values; item = item->next) {
    double *value = &values[f->at_count++];
    if (!strut_study_read_value(r, a, item, "at", false, value)) continue;
    if (*value < f->from || *value > f->to)
      strut_report_error(r->reader, item->place, "'%s' of 'at' is not within 'from' and 'to'",
                         strut_sanitised_text(r->reader, item->text));
  }
}

static void read_starts(strut_study_reader *r, const strut_slot *slot, strut_study_follow *f) {
  if (slot->state != STRUT_GIVEN) return;
  if (!slot->value->count || slot->value->count > STRUT_STUDY_FOLLOW_MOST_FROM) {
    strut_report_error(r->reader, slot->value->place,
                       "'start_from' may have 1 to %d configurations, found %zu",
                       STRUT_STUDY_FOLLOW_MOST_FROM, (size_t)slot->value->count);
    return;
  }
  f->start_from =
      strut_reader_allocate(r->reader, &r->file->arena, slot->value->count, sizeof *f->start_from);
  for (const strut_tree *item = slot->value->first; item && f->start_from; item = item->next)
    if (strut_read_scalar(r->reader, item, "start_from", follow_owner, "a configuration"))
      f->start_from[f->start_count++] = item->text;
}

/* The parameter and what is told of it. */
static void read_over(strut_study_reader *r, strut_fields *fields, strut_study_follow *f) {
  const strut_slot *over = strut_slot_of(fields, STRUT_KEY_FOLLOW_OVER);
  strut_study_column unused = {0};
  strut_study_along a = {.key = over->value, .column = &unused, .setting = &r->file->followed};
  if (over->state != STRUT_GIVEN) return;
  a.parameter = strut_study_parameter(r, over->value);
  if (!a.parameter || !strut_study_begin_along(r, &a, over->value->place)) return;
  if (a.parameter->text) {
    strut_report_error(r->reader, over->value->place,
                       "parameter '%s' is a text, over which no motion is followed",
                       a.parameter->name);
    return;
  }
  f->over = a.parameter->name;
  read_values(r, fields, &a, f);
  f->unit = a.setting->bare ? "" : strut_dimension_unit(a.setting->dimension);
  if (strcmp(f->unit, "1") == 0 || strcmp(f->unit, "SI") == 0) f->unit = "";
}

void strut_study_read_follow(strut_study_reader *r, strut_fields *top) {
  const strut_slot *slot = strut_slot_of(top, STRUT_KEY_STUDY_FOLLOW);
  const strut_slot *search = strut_slot_of(top, STRUT_KEY_STUDY_SEARCH);
  strut_study *study = &r->file->study;
  strut_fields fields;
  if (slot->state != STRUT_GIVEN) return;
  refuse_others(r, top, slot);
  if (!study->axes) strut_study_read_axes(r, NULL, search); /* the study has none */
  strut_study_follow *f = strut_reader_allocate(r->reader, &r->file->arena, 1, sizeof *f);
  if (!f) return;
  strut_read_fields(r->reader, STRUT_SECTION_FOLLOW, slot->value, follow_owner, &fields);
  if (!fields.broken) strut_require(r->reader, &fields, follow_owner, slot->value->place);
  strut_store_fields(r->reader, &fields, follow_owner, &r->file->arena, f, sizeof *f);
  const strut_slot *accuracy = strut_slot_of(&fields, STRUT_KEY_FOLLOW_ACCURACY);
  if (accuracy->state == STRUT_GIVEN && f->accuracy > 0.1)
    strut_report_error(r->reader, accuracy->value->place,
                       "'accuracy' of what is followed may be up to 10 %%");
  read_starts(r, strut_slot_of(&fields, STRUT_KEY_FOLLOW_START_FROM), f);
  read_over(r, &fields, f);
  study->follow = f;
}
