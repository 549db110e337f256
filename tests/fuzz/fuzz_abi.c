/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * libFuzzer target: the library's entries for texts. The input is a name, a value and a text with NULs between
 * them: any text is opened or refused with a message, any setting and any option is taken or refused, and
 * any dotted name has a value or none. Seeds: as of fuzz_scene.
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "parser/bindings/abi/abi.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void release_error(strutlib_error *error) {
  if (!error || !strutlib_error_message(error)[0]) abort();
  for (size_t i = 0; i < strutlib_error_count(error); i++)
    if (!strutlib_error_text(error, i) || !strutlib_error_key(error, i)) abort();
  strutlib_error_free(error);
}

/* Values by a name that may be anything. */
static void ask(const strutlib_scene *scene, const char *name) {
  double number;
  int flag, dimensions;
  const double *data;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  strutlib_scene_number(scene, name, &number);
  strutlib_scene_flag(scene, name, &flag);
  strutlib_scene_text(scene, name);
  strutlib_scene_array(scene, name, &data, &dimensions, shape, stride);
  strutlib_name_count(scene, name);
}

static void analyse(const strutlib_scene *scene, const char *name, const char *value) {
  strutlib_error *error;
  const double *data;
  int dimensions;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  if (strutlib_name_count(scene, "nodes") > 12) return; /* fast ones find more */
  const char *names[] = {"at"}, *values[] = {"drawn"};
  strutlib_result *result = strutlib_rigidity(scene, 1, names, values, NULL, &error);
  if (!result) release_error(error);
  if (result) strutlib_result_array(result, name, &data, &dimensions, shape, stride);
  strutlib_result_free(result);
  result = strutlib_rigidity(scene, 1, &name, &value, NULL, &error);
  if (!result) release_error(error);
  strutlib_result_free(result);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  char *text = malloc(size + 1);
  if (!text) return 0;
  memcpy(text, data, size);
  text[size] = '\0';
  const char *name = text, *value = name + strlen(name), *body = name;
  if (value < text + size) body = ++value;
  body += body == value ? strlen(value) : 0;
  bool set = body < text + size && body != name;
  if (set) body++;
  if (!set) body = text;
  size_t length = size - (size_t)(body - text);
  strutlib_error *error;
  strutlib_scene *scene =
      strutlib_open_text("fuzz.yaml", body, length, set ? 1 : 0, &name, &value, &error);
  if (!scene) release_error(error);
  if (scene && set) {
    ask(scene, name);
    ask(scene, value);
    strutlib_scene *other = strutlib_scene_with(scene, 1, &name, &name, &error);
    if (!other) release_error(error);
    strutlib_close(other);
    analyse(scene, name, value);
  }
  if (scene) {
    char *json = strutlib_scene_json(scene, &error);
    if (!json) release_error(error);
    strutlib_release(json);
  }
  strutlib_close(scene);
  free(text);
  return 0;
}
