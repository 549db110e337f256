/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/grid.h"

#include <math.h>

int64_t strut_grid_points(const strut_study *study) {
  int64_t points = 1;
  for (size_t i = 0; i < study->axis_count; i++) {
    int64_t count = study->axes[i].count;
    if (count < 1 || count > STRUT_STUDY_MOST_POINTS / points) return -1;
    points *= count;
  }
  return points;
}

size_t strut_grid_columns(const strut_study *study) {
  size_t columns = 0;
  for (size_t i = 0; i < study->axis_count; i++) columns += study->axes[i].column_count;
  return columns;
}

const strut_study_column *strut_grid_column(const strut_study *study, size_t k, size_t *axis) {
  size_t i = 0;
  while (k >= study->axes[i].column_count) k -= study->axes[i++].column_count;
  if (axis) *axis = i;
  return &study->axes[i].columns[k];
}

double strut_grid_value(const strut_study_column *column, int64_t i, int64_t count) {
  double from = column->from, to = column->to;
  if (column->kind == STRUT_RANGE_LIST) return column->number[i];
  if (column->kind == STRUT_RANGE_STEP) return from + (double)i * column->step;
  if (i == 0) return from;
  if (i == count - 1) return to; /* exactly */
  double last = (double)(count - 1);
  if (column->kind == STRUT_RANGE_EVEN) return from + (to - from) * (double)i / last;
  return from * pow(to / from, (double)i / last);
}

void strut_grid_indices(const strut_study *study, int64_t point, int64_t *index) {
  for (size_t i = study->axis_count; i-- > 0;) {
    index[i] = point % study->axes[i].count;
    point /= study->axes[i].count;
  }
}

void strut_grid_values(const strut_study *study, int64_t point, strut_study_value *values) {
  size_t k = strut_grid_columns(study);
  for (size_t a = study->axis_count; a-- > 0;) {
    const strut_study_axis *axis = &study->axes[a];
    int64_t i = point % axis->count;
    point /= axis->count;
    for (size_t c = axis->column_count; c-- > 0;) {
      const strut_study_column *column = &axis->columns[c];
      strut_study_value *value = &values[--k];
      *value = (strut_study_value){.number = (double)NAN};
      if (column->word)
        value->word = column->words[i];
      else
        value->number = strut_grid_value(column, i, axis->count);
    }
  }
}
