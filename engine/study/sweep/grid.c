/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/sweep/grid.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

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
  assert(i < study->axis_count);
  if (axis) *axis = i;
  return &study->axes[i].columns[k];
}

/* So that 0.1 + 0.2 is 0.3. */
double strut_grid_rounded(double value, double scale) {
  static const double tens[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22}; /* all exact */
  enum { EXACT = sizeof tens / sizeof tens[0] };
  char text[48];
  if (!(scale > 1e-280) || !isfinite(scale)) return value;
  int k = 14 - (int)floor(log10(scale));
  double power = abs(k) < EXACT ? tens[abs(k)] : pow(10.0, abs(k));
  double digits = rint(k > 0 ? value * power : value / power);
  if (digits == 0.0) return 0.0;                                      /* not -0 */
  if (abs(k) < EXACT) return k > 0 ? digits / power : digits * power; /* rounded once */
  snprintf(text, sizeof text, "%.0fe%d", digits, -k); /* no decimal point: locale-independent */
  return strtod(text, NULL);
}

double strut_grid_value(const strut_study_column *column, int64_t i, int64_t count) {
  double from = column->from, to = column->to, sum, last = (double)(count - 1);
  if (column->kind == STRUT_RANGE_LIST) return column->number[i];
  if (i == 0) return from;
  if (column->kind == STRUT_RANGE_STEP) {
    sum = from + (double)i * column->step;
    return strut_grid_rounded(sum, fmax(fabs(from), fabs(sum)));
  }
  if (i == count - 1) return to; /* exactly */
  if (column->kind == STRUT_RANGE_EVEN) {
    sum = from + (to - from) * (double)i / last;
    return strut_grid_rounded(sum, fmax(fabs(from), fabs(sum)));
  }
  long double first = (long double)from, part = (long double)i / (long double)last;
  long double ratio = powl((long double)to / first, part);
  double value = (double)(first * ratio);
  return strut_grid_rounded(value, fabs(value));
}

void strut_grid_values(const strut_study *study, int64_t point, strut_study_value *values) {
  size_t k = strut_grid_columns(study);
  assert(point >= 0);
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
  assert(k == 0 && point == 0);
}
