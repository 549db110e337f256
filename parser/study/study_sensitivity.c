/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sensitivity analysis: its points become the study's last axis. See study_reader.h; the points are
 * made by scene/sensitivity_design. */
#include <math.h>
#include <string.h>

#include "engine/scene/sensitivity_design.h"
#include "parser/study/study_reader.h"

static const strut_owner sensitivity_owner = {"the sensitivity analysis", NULL};

static void read_of(strut_study_reader *r, const strut_slot *slot, strut_study_sensitivity *s) {
  s->of = strut_reader_allocate(r->reader, &r->file->arena, slot->value->count + 1, sizeof *s->of);
  if (!s->of) return;
  for (const strut_tree *item = slot->value->first; item; item = item->next)
    if (strut_read_scalar(r->reader, item, "of", sensitivity_owner, "a column of the table"))
      s->of[s->of_count++] = item->text;
  if (!slot->value->count)
    strut_report_error(r->reader, slot->value->place,
                       "expected columns of the table for 'of' of the sensitivity analysis");
}

/* Keys that choose points in another way. */
static void refuse_others(strut_study_reader *r, strut_fields *top, const strut_slot *own) {
  static const int others[] = {STRUT_KEY_STUDY_REFINE, STRUT_KEY_STUDY_TRAJECTORIES,
                               STRUT_KEY_STUDY_SEARCH};
  for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
    const strut_slot *slot = strut_slot_of(top, others[i]);
    if (slot->state == STRUT_GIVEN)
      strut_report_error(r->reader, slot->key->place,
                         "'%s' and '%s' exclude each other: use two studies", slot->key->text,
                         own->key->text);
  }
}

/* The accuracy of the runs at the first point; 0 where it is that of rounding, or there is none yet. */
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
  if (slot->state != STRUT_GIVEN) return;
  refuse_others(r, top, slot);
  if (!study->axes) /* the study has no others */
    strut_study_read_axes(r, NULL, strut_slot_of(top, STRUT_KEY_STUDY_SEARCH));
  strut_read_fields(r->reader, STRUT_SECTION_SENSITIVITY, slot->value, sensitivity_owner, &fields);
  if (!fields.broken) strut_require(r->reader, &fields, sensitivity_owner, slot->value->place);
  const strut_slot *of = strut_slot_of(&fields, STRUT_KEY_SENSITIVITY_OF);
  const strut_slot *over = strut_slot_of(&fields, STRUT_KEY_SENSITIVITY_OVER);
  if (of->state == STRUT_GIVEN) read_of(r, of, s);
  if (over->state != STRUT_GIVEN || !study->axes || !r->file->columns) return;
  s->samples = 256, s->seed = 1, s->derivatives = true;
  strut_store_fields(r->reader, &fields, sensitivity_owner, &r->file->arena, s, sizeof *s);
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
