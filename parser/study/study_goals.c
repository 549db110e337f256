/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a study wants of its points: a shape, a curve, the stiffness at a node. See study_reader.h. */
#include <string.h>

#include "parser/study/study_reader.h"

static const strut_owner shape_owner = {"the shape", NULL};
static const strut_owner curve_owner = {"the curve", NULL};

static void read_shape(strut_study_reader *r, const strut_slot *slot) {
  strut_study *study = &r->file->study;
  size_t count = slot->value->count, i = 0;
  study->shape_nodes =
      strut_reader_allocate(r->reader, &r->file->arena, count + 1, sizeof *study->shape_nodes);
  study->shape = strut_reader_allocate(r->reader, &r->file->arena, count + 1, sizeof *study->shape);
  if (!study->shape_nodes || !study->shape) return;
  for (const strut_tree *key = slot->value->first; key; key = key->next->next, i++) {
    study->shape_nodes[i] = key->text;
    strut_read_pair(r->reader, key->next, key->text, shape_owner, STRUT_DIM_LENGTH,
                    study->shape[i]);
  }
  study->shape_count = count;
}

static void read_curve(strut_study_reader *r, const strut_slot *slot) {
  strut_study *study = &r->file->study;
  study->curve = strut_reader_allocate(r->reader, &r->file->arena, slot->value->count + 1,
                                       sizeof *study->curve);
  if (!study->curve) return;
  for (const strut_tree *item = slot->value->first; item; item = item->next) {
    double *pair = study->curve[study->curve_count];
    if (item->kind != STRUT_TREE_LIST || item->count != 2) {
      strut_report_error(r->reader, item->place,
                         "expected a displacement and a force such as [-1 mm, 2 N] for 'curve' of "
                         "the study, found %s",
                         strut_found(r->reader, item));
      continue;
    }
    if (strut_read_number(r->reader, item->first, "curve", curve_owner, STRUT_DIM_LENGTH,
                          STRUT_RANGE_ANY, &pair[0]) &&
        strut_read_number(r->reader, item->first->next, "curve", curve_owner, STRUT_DIM_FORCE,
                          STRUT_RANGE_ANY, &pair[1]))
      study->curve_count++;
  }
}

/* A column that is kept needs what it compares with, and what is given a column. */
static void require_pairs(strut_study_reader *r, strut_fields *top) {
  const strut_study *study = &r->file->study;
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
      strut_report_error(r->reader, strut_slot_of(top, STRUT_KEY_STUDY_KEEP)->value->place,
                         "'%s' needs '%s' of the study%s", goals[i].word,
                         strut_key_at(goals[i].keys[0])->name,
                         first == second ? "" : ", or 'like'");
    if (!kept && given && given->key)
      strut_report_error(r->reader, given->key->place,
                         "'%s' is for the column '%s': add it to 'keep'", given->key->text,
                         goals[i].word);
  }
}

void strut_study_read_goals(strut_study_reader *r, strut_fields *top) {
  const strut_slot *stiffness = strut_slot_of(top, STRUT_KEY_STUDY_STIFFNESS_AT);
  const strut_slot *shape = strut_slot_of(top, STRUT_KEY_STUDY_SHAPE);
  const strut_slot *like = strut_slot_of(top, STRUT_KEY_STUDY_LIKE);
  const strut_slot *curve = strut_slot_of(top, STRUT_KEY_STUDY_CURVE);
  strut_fields fields;
  if (stiffness->state == STRUT_GIVEN) {
    const strut_owner owner = {"the stiffness", NULL};
    strut_read_fields(r->reader, STRUT_SECTION_STIFFNESS_AT, stiffness->value, owner, &fields);
    if (!fields.broken) strut_require(r->reader, &fields, owner, stiffness->value->place);
    strut_store_fields(r->reader, &fields, owner, &r->file->arena, &r->file->study,
                       sizeof(strut_study));
  }
  if (shape->state == STRUT_GIVEN && like->state == STRUT_GIVEN)
    strut_report_error(r->reader, like->key->place,
                       "'shape' and 'like' of the study exclude each other");
  if (shape->state == STRUT_GIVEN) read_shape(r, shape);
  if (curve->state == STRUT_GIVEN) read_curve(r, curve);
  if (curve->state == STRUT_GIVEN && r->file->study.compute == STRUT_COMPUTE_PATH &&
      (!r->file->study.path_over || !strchr(r->file->study.path_over, '.')))
    strut_report_error(r->reader, curve->key->place,
                       "'curve' is force over the displacement of a node: the path needs "
                       "'over: NODE.x' or 'over: NODE.y'");
  require_pairs(r, top);
}
