/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions that are declared and not made yet. */
#include "parser/abi/abi.h"

strutlib_result *strutlib_sweep(const strutlib_scene *scene, size_t axis_count,
                                const char *const *axes, size_t point_count, const double *points,
                                const char *const *words, size_t keep_count,
                                const char *const *keep, size_t count, const char *const *names,
                                const char *const *values, strutlib_row row, void *context,
                                strutlib_control *control, strutlib_error **error) {
  (void)scene;
  (void)axis_count;
  (void)axes;
  (void)point_count;
  (void)points;
  (void)words;
  (void)keep_count;
  (void)keep;
  (void)count;
  (void)names;
  (void)values;
  (void)row;
  (void)context;
  (void)control;
  (void)error;
  return NULL;
}

const char *strutlib_result_cell(const strutlib_result *result, const char *column, size_t point) {
  (void)result;
  (void)column;
  (void)point;
  return NULL;
}

const char *strutlib_result_column(const strutlib_result *result, size_t i) {
  (void)result;
  (void)i;
  return NULL;
}
