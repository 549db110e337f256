/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions that are declared and not made yet. */
#include "parser/abi/abi.h"

int strutlib_abi_version(void) { return 0; }

const char *strutlib_version(void) { return NULL; }

void strutlib_release(char *text) { (void)text; }

const char *strutlib_status_name(int status) {
  (void)status;
  return NULL;
}

const char *strutlib_status_text(int status) {
  (void)status;
  return NULL;
}

int strutlib_exit_code(int status) {
  (void)status;
  return 0;
}

int strutlib_error_status(const strutlib_error *error) {
  (void)error;
  return 0;
}

const char *strutlib_error_message(const strutlib_error *error) {
  (void)error;
  return NULL;
}

const char *strutlib_error_report(const strutlib_error *error) {
  (void)error;
  return NULL;
}

size_t strutlib_error_count(const strutlib_error *error) {
  (void)error;
  return 0;
}

const char *strutlib_error_text(const strutlib_error *error, size_t i) {
  (void)error;
  (void)i;
  return NULL;
}

const char *strutlib_error_file(const strutlib_error *error, size_t i) {
  (void)error;
  (void)i;
  return NULL;
}

size_t strutlib_error_line(const strutlib_error *error, size_t i) {
  (void)error;
  (void)i;
  return 0;
}

size_t strutlib_error_column(const strutlib_error *error, size_t i) {
  (void)error;
  (void)i;
  return 0;
}

size_t strutlib_error_length(const strutlib_error *error, size_t i) {
  (void)error;
  (void)i;
  return 0;
}

const char *strutlib_error_source(const strutlib_error *error, size_t i) {
  (void)error;
  (void)i;
  return NULL;
}

const char *strutlib_error_hint(const strutlib_error *error, size_t i) {
  (void)error;
  (void)i;
  return NULL;
}

const char *strutlib_error_key(const strutlib_error *error, size_t i) {
  (void)error;
  (void)i;
  return NULL;
}

void strutlib_error_free(strutlib_error *error) { (void)error; }

strutlib_control *strutlib_control_create(void) { return NULL; }

void strutlib_control_free(strutlib_control *control) { (void)control; }

void strutlib_interrupt(strutlib_control *control) { (void)control; }

void strutlib_control_reset(strutlib_control *control) { (void)control; }

int strutlib_control_interrupted(const strutlib_control *control) {
  (void)control;
  return 0;
}

void strutlib_control_on_progress(strutlib_control *control, strutlib_progress progress,
                                  void *context) {
  (void)control;
  (void)progress;
  (void)context;
}

strutlib_scene *strutlib_open(const char *path, size_t count, const char *const *names,
                              const char *const *values, strutlib_error **error) {
  (void)path;
  (void)count;
  (void)names;
  (void)values;
  (void)error;
  return NULL;
}

strutlib_scene *strutlib_open_text(const char *name, const char *text, size_t length, size_t count,
                                   const char *const *names, const char *const *values,
                                   strutlib_error **error) {
  (void)name;
  (void)text;
  (void)length;
  (void)count;
  (void)names;
  (void)values;
  (void)error;
  return NULL;
}

strutlib_scene *strutlib_scene_with(const strutlib_scene *scene, size_t count,
                                    const char *const *names, const char *const *values,
                                    strutlib_error **error) {
  (void)scene;
  (void)count;
  (void)names;
  (void)values;
  (void)error;
  return NULL;
}

void strutlib_close(strutlib_scene *scene) { (void)scene; }

size_t strutlib_name_count(const strutlib_scene *scene, const char *kind) {
  (void)scene;
  (void)kind;
  return 0;
}

const char *strutlib_name(const strutlib_scene *scene, const char *kind, size_t i) {
  (void)scene;
  (void)kind;
  (void)i;
  return NULL;
}

long strutlib_index(const strutlib_scene *scene, const char *kind, const char *name) {
  (void)scene;
  (void)kind;
  (void)name;
  return -1;
}

int strutlib_scene_number(const strutlib_scene *scene, const char *name, double *value) {
  (void)scene;
  (void)name;
  (void)value;
  return 0;
}

int strutlib_scene_flag(const strutlib_scene *scene, const char *name, int *value) {
  (void)scene;
  (void)name;
  (void)value;
  return 0;
}

const char *strutlib_scene_text(const strutlib_scene *scene, const char *name) {
  (void)scene;
  (void)name;
  return NULL;
}

int strutlib_scene_array(const strutlib_scene *scene, const char *name, const double **data,
                         int *dimensions, size_t *shape, size_t *stride) {
  (void)scene;
  (void)name;
  (void)data;
  (void)dimensions;
  (void)shape;
  (void)stride;
  return 0;
}

const char *strutlib_scene_warning(const strutlib_scene *scene, size_t i) {
  (void)scene;
  (void)i;
  return NULL;
}

char *strutlib_scene_yaml(const strutlib_scene *scene, int parts, strutlib_error **error) {
  (void)scene;
  (void)parts;
  (void)error;
  return NULL;
}

char *strutlib_scene_json(const strutlib_scene *scene, strutlib_error **error) {
  (void)scene;
  (void)error;
  return NULL;
}

char *strutlib_scene_svg(const strutlib_scene *scene, strutlib_error **error) {
  (void)scene;
  (void)error;
  return NULL;
}

char *strutlib_scene_html(const strutlib_scene *scene, int equilibria, strutlib_control *control,
                          strutlib_error **error) {
  (void)scene;
  (void)equilibria;
  (void)control;
  (void)error;
  return NULL;
}

const char *strutlib_option_name(const char *command, size_t i) {
  (void)command;
  (void)i;
  return NULL;
}

const char *strutlib_option_help(const char *command, size_t i) {
  (void)command;
  (void)i;
  return NULL;
}

strutlib_result *strutlib_run(const strutlib_scene *scene, size_t count, const char *const *names,
                              const char *const *values, strutlib_control *control,
                              strutlib_error **error) {
  (void)scene;
  (void)count;
  (void)names;
  (void)values;
  (void)control;
  (void)error;
  return NULL;
}

strutlib_result *strutlib_equilibria(const strutlib_scene *scene, size_t count,
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

strutlib_result *strutlib_modes(const strutlib_scene *scene, size_t count, const char *const *names,
                                const char *const *values, strutlib_control *control,
                                strutlib_error **error) {
  (void)scene;
  (void)count;
  (void)names;
  (void)values;
  (void)control;
  (void)error;
  return NULL;
}

strutlib_result *strutlib_rigidity(const strutlib_scene *scene, size_t count,
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

strutlib_result *strutlib_form(const strutlib_scene *scene, size_t count, const char *const *names,
                               const char *const *values, strutlib_control *control,
                               strutlib_error **error) {
  (void)scene;
  (void)count;
  (void)names;
  (void)values;
  (void)control;
  (void)error;
  return NULL;
}

strutlib_result *strutlib_path(const strutlib_scene *scene, size_t count, const char *const *names,
                               const char *const *values, strutlib_control *control,
                               strutlib_error **error) {
  (void)scene;
  (void)count;
  (void)names;
  (void)values;
  (void)control;
  (void)error;
  return NULL;
}

strutlib_result *strutlib_matrices(const strutlib_scene *scene, size_t count,
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

int strutlib_result_status(const strutlib_result *result) {
  (void)result;
  return 0;
}

const char *strutlib_result_command(const strutlib_result *result) {
  (void)result;
  return NULL;
}

const char *strutlib_result_json(const strutlib_result *result) {
  (void)result;
  return NULL;
}

const char *strutlib_result_table(const strutlib_result *result) {
  (void)result;
  return NULL;
}

const char *strutlib_result_warning(const strutlib_result *result, size_t i) {
  (void)result;
  (void)i;
  return NULL;
}

int strutlib_result_number(const strutlib_result *result, const char *name, double *value) {
  (void)result;
  (void)name;
  (void)value;
  return 0;
}

int strutlib_result_flag(const strutlib_result *result, const char *name, int *value) {
  (void)result;
  (void)name;
  (void)value;
  return 0;
}

const char *strutlib_result_text(const strutlib_result *result, const char *name) {
  (void)result;
  (void)name;
  return NULL;
}

size_t strutlib_result_count(const strutlib_result *result, const char *name) {
  (void)result;
  (void)name;
  return 0;
}

const char *strutlib_result_key(const strutlib_result *result, const char *name, size_t i) {
  (void)result;
  (void)name;
  (void)i;
  return NULL;
}

int strutlib_result_array(const strutlib_result *result, const char *name, const double **data,
                          int *dimensions, size_t *shape, size_t *stride) {
  (void)result;
  (void)name;
  (void)data;
  (void)dimensions;
  (void)shape;
  (void)stride;
  return 0;
}

const char *strutlib_result_array_name(const strutlib_result *result, size_t i) {
  (void)result;
  (void)i;
  return NULL;
}

const char *strutlib_result_array_unit(const strutlib_result *result, const char *name) {
  (void)result;
  (void)name;
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

char *strutlib_result_yaml(const strutlib_result *result, strutlib_error **error) {
  (void)result;
  (void)error;
  return NULL;
}

char *strutlib_result_svg(const strutlib_result *result, size_t count, const char *const *names,
                          const char *const *values, strutlib_error **error) {
  (void)result;
  (void)count;
  (void)names;
  (void)values;
  (void)error;
  return NULL;
}

char *strutlib_result_html(const strutlib_result *result, strutlib_error **error) {
  (void)result;
  (void)error;
  return NULL;
}

void strutlib_result_free(strutlib_result *result) { (void)result; }

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
