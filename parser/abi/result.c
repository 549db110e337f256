/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Results: what all kinds of them show alike. */
#include <stdint.h>
#include <string.h>

#include "parser/abi/handles.h"
#include "parser/write/write_scene.h"

strutlib_result *abi_result_create(const strut_command *command, strutlib_error **error) {
  strutlib_result *result = strut_allocate(1, sizeof *result);
  if (result && pthread_mutex_init(&result->lock, NULL) == 0) {
    result->command = command;
    return result;
  }
  strut_release(result);
  abi_no_memory(error);
  return NULL;
}

void strutlib_result_free(strutlib_result *result) {
  if (!result) return;
  if (result->detail) ((abi_detail *)result->detail)->release(result->detail);
  strut_model_free(result->model);
  if (result->opened) strut_setup_free(&result->setup);
  abi_tree_free(result->tree);
  strut_release(result->json);
  strut_release(result->table);
  strut_release(result->yaml);
  strut_release(result->made);
  abi_messages_free(&result->messages);
  strut_arena_free(&result->arena);
  strut_arena_free(&result->made_arena);
  pthread_mutex_destroy(&result->lock);
  strut_release(result);
}

/* ---- texts ---- */

int strutlib_result_status(const strutlib_result *result) {
  return result ? result->status : STRUTLIB_USAGE;
}

const char *strutlib_result_command(const strutlib_result *result) {
  return result ? result->command->name : NULL;
}

const char *strutlib_result_json(const strutlib_result *result) {
  return result && result->json ? result->json : "{}\n";
}

const char *strutlib_result_table(const strutlib_result *result) {
  return result && result->table ? result->table : "";
}

const char *strutlib_result_warning(const strutlib_result *result, size_t i) {
  return result && i < result->messages.count ? result->messages.warnings[i] : NULL;
}

char *strutlib_result_yaml(const strutlib_result *result, strutlib_error **error) {
  if (abi_lacks(error, result, "result")) return NULL;
  abi_enter(error);
  char *text = NULL;
  if (result->yaml || result->opened)
    text = abi_give(result->yaml ? strut_allocate(strlen(result->yaml) + 1, 1)
                                 : strut_setup_write(&result->setup),
                    error);
  else
    abi_fail(error, STRUTLIB_USAGE, "the result of %s holds no scene", result->command->name);
  if (text && result->yaml) strcpy(text, result->yaml);
  abi_leave();
  return text;
}

/* ---- values ---- */

/* The tree of the JSON; NULL: memory is out. With the lock. */
static const abi_tree *locked_tree(strutlib_result *result) {
  if (!result->tree) result->tree = abi_tree_read(strutlib_result_json(result));
  return result->tree;
}

static strutlib_result *lock(const strutlib_result *constant) {
  strutlib_result *result =
      (strutlib_result *)(uintptr_t)constant; /* the lock guards what changes */
  pthread_mutex_lock(&result->lock);
  return result;
}

static const abi_tree *tree_of(const strutlib_result *constant) {
  if (!constant) return NULL;
  strutlib_result *result = lock(constant);
  const abi_tree *tree = locked_tree(result);
  pthread_mutex_unlock(&result->lock);
  return tree;
}

int strutlib_result_number(const strutlib_result *result, const char *name, double *value) {
  const abi_tree *tree = tree_of(result);
  return tree && abi_tree_number(tree, name, value) ? 1 : 0;
}

int strutlib_result_flag(const strutlib_result *result, const char *name, int *value) {
  const abi_tree *tree = tree_of(result);
  return tree && abi_tree_flag(tree, name, value) ? 1 : 0;
}

const char *strutlib_result_text(const strutlib_result *result, const char *name) {
  const abi_tree *tree = tree_of(result);
  return tree ? abi_tree_text(tree, name) : NULL;
}

size_t strutlib_result_count(const strutlib_result *result, const char *name) {
  const abi_tree *tree = tree_of(result);
  return tree ? abi_tree_count(tree, name) : 0;
}

const char *strutlib_result_key(const strutlib_result *result, const char *name, size_t i) {
  const abi_tree *tree = tree_of(result);
  return tree ? abi_tree_key(tree, name, i) : NULL;
}

/* ---- arrays ---- */

bool abi_result_add_array(strutlib_result *result, const char *name, const char *unit,
                          const double *data, int dimensions, const size_t *shape) {
  size_t count = result->array_count;
  if ((count & (count - 1)) == 0) { /* a power of two, or none: it is full */
    abi_array *wider = strut_arena_allocate(&result->arena, count ? 2 * count : 1, sizeof *wider);
    if (!wider) return false;
    if (count) memcpy(wider, result->arrays, count * sizeof *wider);
    result->arrays = wider;
  }
  abi_array *a = &result->arrays[count];
  *a = (abi_array){.name = strut_arena_text(&result->arena, name, strlen(name)),
                   .unit = strut_arena_text(&result->arena, unit, strlen(unit)),
                   .data = data,
                   .dimensions = dimensions};
  size_t stride = 1;
  for (int d = dimensions - 1; d >= 0; d--) {
    a->shape[d] = shape[d];
    a->stride[d] = stride;
    stride *= shape[d];
  }
  if (!a->name || !a->unit) return false;
  result->array_count++;
  return true;
}

static const abi_array *find_array(const abi_array *arrays, size_t count, const char *name) {
  for (size_t i = 0; i < count; i++)
    if (strcmp(arrays[i].name, name) == 0) return &arrays[i];
  return NULL;
}

static long component_of(const strut_channel_row *row, const char *name) {
  for (size_t c = 0; c < row->components; c++)
    if (strcmp(name, row->component_names[c]) == 0) return (long)c;
  return -1;
}

/* "position.n1" or "position.n1.x" of the channel "position". */
static bool slice(const strutlib_result *result, const abi_array *whole, const char *name,
                  abi_array *part) {
  size_t before = strlen(whole->name);
  if (!result->opened || strncmp(name, whole->name, before) != 0 || name[before] != '.')
    return false;
  const char *rest = name + before + 1;
  const strut_channel_row *row = strut_channel_named(whole->name);
  for (size_t i = 0; row && whole->dimensions > 1 && i < whole->shape[1]; i++) {
    const char *thing = strut_channel_thing(row, &result->setup.scene, i);
    size_t length = strlen(thing);
    if (strncmp(rest, thing, length) != 0 || (rest[length] && rest[length] != '.')) continue;
    long component = rest[length] ? component_of(row, rest + length + 1) : 0;
    if (rest[length] && (component < 0 || whole->dimensions < 3)) continue;
    *part = *whole;
    part->data += i * whole->stride[1] + (size_t)component;
    part->dimensions = whole->dimensions == 3 && !rest[length] ? 2 : 1;
    part->shape[1] = whole->shape[2];
    part->stride[1] = whole->stride[2];
    return true;
  }
  return false;
}

/* An array of the JSON, made when it is first asked for. With the lock. */
static const abi_array *made_array(strutlib_result *result, const char *name) {
  const abi_array *made = find_array(result->made, result->made_count, name);
  if (made) return made;
  const abi_tree *tree = locked_tree(result);
  bool no_memory;
  abi_array a = {.unit = ""};
  if (!tree) return NULL;
  double *data = abi_tree_array(tree, name, STRUTLIB_DIMENSIONS, &result->made_arena, &a.dimensions,
                                a.shape, &no_memory);
  if (!data) return NULL;
  if (result->made_count == result->made_capacity) {
    size_t wider = result->made_capacity ? 2 * result->made_capacity : 8;
    abi_array *list = strut_reallocate(result->made, wider, sizeof *list);
    if (!list) return NULL;
    result->made = list;
    result->made_capacity = wider;
  }
  a.data = data;
  a.name = strut_arena_text(&result->made_arena, name, strlen(name));
  if (!a.name) return NULL;
  size_t stride = 1;
  for (int d = a.dimensions - 1; d >= 0; d--) {
    a.stride[d] = stride;
    stride *= a.shape[d];
  }
  result->made[result->made_count] = a;
  return &result->made[result->made_count++];
}

int strutlib_result_array(const strutlib_result *constant, const char *name, const double **data,
                          int *dimensions, size_t *shape, size_t *stride) {
  if (!constant || !name) return 0;
  const abi_array *found = find_array(constant->arrays, constant->array_count, name);
  if (found) return abi_show_array(found, data, dimensions, shape, stride);
  abi_array part;
  for (size_t i = 0; i < constant->array_count; i++)
    if (slice(constant, &constant->arrays[i], name, &part))
      return abi_show_array(&part, data, dimensions, shape, stride);
  strutlib_result *result = lock(constant);
  found = made_array(result, name);
  int shown = found ? abi_show_array(found, data, dimensions, shape, stride) : 0;
  pthread_mutex_unlock(&result->lock);
  return shown;
}

const char *strutlib_result_array_name(const strutlib_result *result, size_t i) {
  return result && i < result->array_count ? result->arrays[i].name : NULL;
}

const char *strutlib_result_array_unit(const strutlib_result *result, const char *name) {
  if (!result || !name) return NULL;
  const abi_array *found = find_array(result->arrays, result->array_count, name);
  abi_array part;
  for (size_t i = 0; !found && i < result->array_count; i++)
    if (slice(result, &result->arrays[i], name, &part)) return result->arrays[i].unit;
  return found ? found->unit : NULL;
}
