/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a study refines. See study_reader.h; the cells are divided by engine/study/sweep/refine. */
#include <string.h>

#include "parser/study/study_reader.h"

static const strut_owner refine_owner = {"the refinement", NULL};

static bool is_range(const strut_study_axis *axis) {
  bool all = axis->count > 1 && axis->column_count > 0;
  for (size_t i = 0; i < axis->column_count; i++)
    all = all && axis->columns[i].kind != STRUT_RANGE_LIST;
  return all;
}

static bool has_parameter(const strut_study_axis *axis, const char *name) {
  for (size_t i = 0; i < axis->column_count; i++)
    if (strcmp(axis->columns[i].name, name) == 0) return true;
  return false;
}

/* The axis of a named parameter, which must be a range; axis_count where that was reported. */
static size_t find_axis(strut_study_reader *r, const strut_tree *item) {
  const strut_study *study = &r->file->study;
  size_t axis = 0;
  if (!strut_read_scalar(r->reader, item, "axes", refine_owner, "a parameter of an axis"))
    return study->axis_count;
  while (axis < study->axis_count && !has_parameter(&study->axes[axis], item->text)) axis++;
  if (axis < study->axis_count && is_range(&study->axes[axis])) return axis;
  strut_report_error(r->reader, item->place,
                     axis < study->axis_count
                         ? "axis '%s' has no range such as {from: 1, to: 2, count: 11}: it cannot "
                           "be refined"
                         : "the study has no axis of '%s'",
                     strut_sanitised_text(r->reader, item->text));
  return study->axis_count;
}

/* The two axes that are named, or the only two that can be refined. */
static bool choose_axes(strut_study_reader *r, const strut_slot *refine, const strut_slot *named) {
  strut_study *study = &r->file->study;
  size_t count = 0;
  if (named->state == STRUT_GIVEN) {
    for (const strut_tree *item = named->value->first; item; item = item->next) {
      size_t axis = find_axis(r, item);
      if (axis == study->axis_count) return false;
      if (count < 2) study->refine_axes[count] = axis;
      count++;
    }
  } else {
    for (size_t i = 0; i < study->axis_count; i++) {
      if (!is_range(&study->axes[i])) continue;
      if (count < 2) study->refine_axes[count] = i;
      count++;
    }
  }
  if (count == 2 && study->refine_axes[0] != study->refine_axes[1]) {
    if (study->refine_axes[0] > study->refine_axes[1]) {
      size_t first = study->refine_axes[1];
      study->refine_axes[1] = study->refine_axes[0];
      study->refine_axes[0] = first;
    }
    return true;
  }
  strut_report_error(
      r->reader, refine->key->place,
      "'refine' divides two axes with ranges of more than one value, found %zu; name "
      "them: axes: [NAME, NAME]",
      count == 2 ? (size_t)1 : count);
  return false;
}

/* Gives an axis the values of the finest grid; those of the coarsest keep their bits. */
static void refine_axis(strut_study_axis *axis, int32_t depth) {
  int64_t parts = (int64_t)1 << depth;
  axis->count = (axis->count - 1) * parts + 1;
  for (size_t i = 0; i < axis->column_count; i++) axis->columns[i].step /= (double)parts;
}

void strut_study_read_refine(strut_study_reader *r, const strut_slot *slot) {
  strut_study *study = &r->file->study;
  strut_fields fields;
  if (slot->state != STRUT_GIVEN) return;
  strut_read_fields(r->reader, STRUT_SECTION_REFINE, slot->value, refine_owner, &fields);
  if (!fields.broken) strut_require(r->reader, &fields, refine_owner, slot->value->place);
  if (fields.broken || r->reader->failed) return; /* the axes may be incomplete */
  strut_store_fields(r->reader, &fields, refine_owner, &r->file->arena, study, sizeof *study);
  int32_t depth = study->refine_depth;
  study->refine_depth = 0;
  if (!choose_axes(r, slot, strut_slot_of(&fields, STRUT_KEY_REFINE_AXES))) return;
  double points = 1.0;
  for (int i = 0; i < 2; i++) refine_axis(&study->axes[study->refine_axes[i]], depth);
  for (size_t i = 0; i < study->axis_count; i++) points *= (double)study->axes[i].count;
  study->refine_depth = depth;
  if (points > (double)STRUT_STUDY_MOST_REFINED)
    strut_report_error(r->reader, slot->key->place,
                       "the finest grid has %.3g points, a refined study may have %.0e", points,
                       (double)STRUT_STUDY_MOST_REFINED);
}
