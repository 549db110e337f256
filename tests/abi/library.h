/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The library as a program of somebody else's sees it: scenes opened, options, arrays, refusals; what fails, fails the test. */
#pragma once

#include <strut/abi.h>

#include "tests/support/test.h"

FREED_BY(strutlib_result_free, strutlib_result)
FREED_BY(strutlib_close, strutlib_scene)
FREED_BY(strutlib_control_free, strutlib_control)
FREED_BY(strutlib_simulation_close, strutlib_simulation)
FREED_BY(strutlib_snapshot_free, strutlib_snapshot)

/** Options of a call: none, or one or two of them. */
#define NONE 0, NULL, NULL
#define WITH(name, value)                                                                          \
  1, (const char *const[]){name}, (const char *const[]) { value }
#define WITH_BOTH(name, value, other, its)                                                         \
  2, (const char *const[]){name, other}, (const char *const[]) { value, its }

/** The call gives something; otherwise the test says why not. `error` is where it puts that. */
#define given(call, error) library_given((call), error, __FILE__, __LINE__)

static inline void *library_given(void *answer, strutlib_error *error, const char *file, int line) {
  if (answer) return answer;
  print_error("%s\n", strutlib_error_report(error));
  _fail(file, line);
  return NULL;
}

static inline strutlib_scene *library_open(const char *path) {
  strutlib_error *error = NULL;
  strutlib_scene *scene = strutlib_open(path, NONE, &error);
  return given(scene, error);
}

static inline strutlib_scene *library_open_text(const char *text) {
  strutlib_error *error = NULL;
  strutlib_scene *scene = strutlib_open_text("text", text, strlen(text), NONE, &error);
  return given(scene, error);
}

static inline void assert_refused(strutlib_error *error, int status, const char *words) {
  assert_non_null(error);
  if (strutlib_error_status(error) != status || !strstr(strutlib_error_message(error), words))
    fail_msg("%d: %s", strutlib_error_status(error), strutlib_error_message(error));
  strutlib_error_free(error);
}

/** An array of a result, a scene or a simulation. */
typedef struct array {
  const double *data;
  int dimensions;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
} array;

static inline size_t array_size(const array *a) {
  size_t size = 1;
  for (int d = 0; d < a->dimensions; d++) size *= a->shape[d];
  return size;
}

static inline array array_of(const strutlib_result *result, const char *name) {
  array a = {.data = NULL};
  if (!strutlib_result_array(result, name, &a.data, &a.dimensions, a.shape, a.stride))
    fail_msg("no array '%s'", name);
  return a;
}
