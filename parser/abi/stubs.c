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

strutlib_simulation *strutlib_simulation_open(const strutlib_scene *scene, size_t count,
                                              const char *const *names, const char *const *values,
                                              strutlib_control *control, strutlib_error **error) {
  (void)scene;
  (void)count;
  (void)names;
  (void)values;
  (void)control;
  (void)error;
  return NULL;
}

void strutlib_simulation_close(strutlib_simulation *simulation) { (void)simulation; }

int strutlib_simulation_advance(strutlib_simulation *simulation, long steps,
                                strutlib_error **error) {
  (void)simulation;
  (void)steps;
  (void)error;
  return 0;
}

double strutlib_simulation_time(const strutlib_simulation *simulation) {
  (void)simulation;
  return 0.0;
}

double strutlib_simulation_step(const strutlib_simulation *simulation) {
  (void)simulation;
  return 0.0;
}

int strutlib_simulation_array(strutlib_simulation *simulation, const char *name,
                              const double **data, int *dimensions, size_t *shape, size_t *stride) {
  (void)simulation;
  (void)name;
  (void)data;
  (void)dimensions;
  (void)shape;
  (void)stride;
  return 0;
}

int strutlib_simulation_input(strutlib_simulation *simulation, const char *name, double **data,
                              int *dimensions, size_t *shape, size_t *stride) {
  (void)simulation;
  (void)name;
  (void)data;
  (void)dimensions;
  (void)shape;
  (void)stride;
  return 0;
}

int strutlib_simulation_set(strutlib_simulation *simulation, const char *input, const char *name,
                            double value, strutlib_error **error) {
  (void)simulation;
  (void)input;
  (void)name;
  (void)value;
  (void)error;
  return 0;
}

double strutlib_simulation_input_work(const strutlib_simulation *simulation) {
  (void)simulation;
  return 0.0;
}

strutlib_snapshot *strutlib_simulation_snapshot(const strutlib_simulation *simulation,
                                                strutlib_error **error) {
  (void)simulation;
  (void)error;
  return NULL;
}

int strutlib_simulation_restore(strutlib_simulation *simulation, const strutlib_snapshot *snapshot,
                                strutlib_error **error) {
  (void)simulation;
  (void)snapshot;
  (void)error;
  return 0;
}

void strutlib_snapshot_free(strutlib_snapshot *snapshot) { (void)snapshot; }
