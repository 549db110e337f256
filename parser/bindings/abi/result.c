/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Results: their texts, the tree of their values, and their arrays. */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/text.h"
#include "engine/output/result_values.h"
#include "parser/bindings/abi/handles.h"
#include "parser/language/write/write_scene.h"

void abi_tree_free(abi_tree *tree) { cJSON_Delete(tree); }

char *abi_tree_write(const abi_tree *tree) {
  strut_c_locale locale = strut_c_locale_enter();
  char *text = strut_json_print(tree);
  strut_c_locale_leave(locale);
  return text;
}

/* ---- from a scene ---- */

static cJSON *scalar_of(const strut_tree *node) {
  const char *text = node->text;
  char *end;
  if (!node->quoted && *text) {
    double value = strtod(text, &end);
    bool digits = strspn(text, "+-.0123456789eE") == strlen(text);
    if (digits && !*end && isfinite(value)) return cJSON_CreateNumber(value);
    if (strcmp(text, "yes") == 0 || strcmp(text, "true") == 0) return cJSON_CreateBool(1);
    if (strcmp(text, "no") == 0 || strcmp(text, "false") == 0) return cJSON_CreateBool(0);
  }
  return cJSON_CreateString(text);
}

static cJSON *node_of(const strut_tree *node);

static bool add_children(const strut_tree *node, cJSON *to) {
  const strut_tree *child = node->first;
  for (uint32_t i = 0; i < node->count && child; i++) {
    const strut_tree *key = node->kind == STRUT_TREE_MAP ? child : NULL;
    if (key) child = child->next;
    cJSON *value = child ? node_of(child) : NULL;
    bool added = value && (key ? cJSON_AddItemToObject(to, key->text, value)
                               : cJSON_AddItemToArray(to, value));
    if (!added) {
      cJSON_Delete(value);
      return false;
    }
    child = child->next;
  }
  return true;
}

static cJSON *node_of(const strut_tree *node) {
  if (node->kind == STRUT_TREE_SCALAR) return scalar_of(node);
  cJSON *to = node->kind == STRUT_TREE_LIST ? cJSON_CreateArray() : cJSON_CreateObject();
  if (to && add_children(node, to)) return to;
  cJSON_Delete(to);
  return NULL;
}

abi_tree *abi_tree_of(const strut_tree *root) {
  strut_c_locale locale = strut_c_locale_enter();
  cJSON *tree = node_of(root);
  strut_c_locale_leave(locale);
  return tree;
}

bool abi_tree_set(abi_tree *tree, const char *name, const char *key, double number,
                  const char *text) {
  cJSON *to = cJSON_GetObjectItemCaseSensitive(tree, name);
  if (!to || !cJSON_HasObjectItem(to, key)) return true;
  cJSON *value = text ? cJSON_CreateString(text) : cJSON_CreateNumber(number);
  if (value && cJSON_ReplaceItemInObjectCaseSensitive(to, key, value)) return true;
  cJSON_Delete(value);
  return false;
}

/* ---- by name ---- */

/* The number that a name begins with, up to a dot or the end; -1: it does not. */
static int number_of(const char *name, const char **rest) {
  int value = 0, digits = 0;
  for (; *name >= '0' && *name <= '9' && digits < 9; name++, digits++)
    value = 10 * value + (*name - '0');
  if (digits == 0 || (*name && *name != '.')) return -1;
  *rest = *name ? name + 1 : name;
  return value;
}

/* The child of a mapping whose key is the longest that the name begins with; *rest: what follows. */
static const cJSON *child_of(const cJSON *map, const char *name, const char **rest) {
  const cJSON *best = NULL;
  size_t longest = 0;
  for (const cJSON *child = map->child; child; child = child->next) {
    size_t length = child->string ? strlen(child->string) : 0;
    if (strncmp(name, child->string ? child->string : "", length) != 0) continue;
    if (name[length] && name[length] != '.') continue;
    if (best && length <= longest) continue;
    best = child;
    longest = length;
    *rest = name[length] ? name + length + 1 : name + length;
  }
  return best;
}

static const cJSON *find(const cJSON *at, const char *name) {
  if (!name) return NULL;
  while (at && *name) {
    int index;
    if (cJSON_IsObject(at)) {
      at = child_of(at, name, &name);
    } else if (cJSON_IsArray(at) && (index = number_of(name, &name)) >= 0) {
      at = cJSON_GetArrayItem(at, index);
    } else {
      return NULL;
    }
  }
  return at;
}

bool abi_tree_number(const abi_tree *tree, const char *name, double *value) {
  const cJSON *at = find(tree, name);
  if (!at || !value || !cJSON_IsNumber(at)) return false;
  *value = at->valuedouble;
  return true;
}

bool abi_tree_flag(const abi_tree *tree, const char *name, int *value) {
  const cJSON *at = find(tree, name);
  if (!at || !value || !cJSON_IsBool(at)) return false;
  *value = cJSON_IsTrue(at) ? 1 : 0;
  return true;
}

const char *abi_tree_text(const abi_tree *tree, const char *name) {
  const cJSON *at = find(tree, name);
  return at && cJSON_IsString(at) ? at->valuestring : NULL;
}

/* ---- arrays ---- */

typedef struct extent {
  abi_array array; /* of dimension -1 before the first number */
  bool wrong;      /* texts, or numbers at different depths */
  double *data;    /* NULL while measuring */
} extent;

static void visit(const cJSON *at, const char *name, int depth, size_t offset, extent *self);

static void visit_children(const cJSON *at, const char *name, int depth, size_t offset,
                           extent *self) {
  size_t i = 0;
  if (depth >= STRUTLIB_DIMENSIONS) {
    self->wrong = true;
    return;
  }
  for (const cJSON *child = at->child; child && !self->wrong; child = child->next, i++)
    visit(child, name, depth + 1, offset + (self->data ? i * self->array.stride[depth] : 0), self);
  if (!self->data && i > self->array.shape[depth]) self->array.shape[depth] = i;
}

static void take_number(double value, int depth, size_t offset, extent *self) {
  if (self->array.dimensions < 0) self->array.dimensions = depth;
  if (self->array.dimensions != depth) self->wrong = true;
  if (self->data && !self->wrong) self->data[offset] = value;
}

static void visit(const cJSON *at, const char *name, int depth, size_t offset, extent *self) {
  const char *rest = name;
  if (cJSON_IsNull(at)) return; /* stays NAN */
  if (*name && cJSON_IsArray(at)) {
    int index = number_of(name, &rest);
    const cJSON *item = index >= 0 ? cJSON_GetArrayItem(at, index) : NULL;
    if (index < 0)
      visit_children(at, name, depth, offset, self);
    else if (item)
      visit(item, rest, depth, offset, self);
  } else if (*name) {
    const cJSON *child = cJSON_IsObject(at) ? child_of(at, name, &rest) : NULL;
    if (child) visit(child, rest, depth, offset, self);
  } else if (cJSON_IsArray(at) || cJSON_IsObject(at)) {
    visit_children(at, name, depth, offset, self);
  } else if (cJSON_IsNumber(at)) {
    take_number(at->valuedouble, depth, offset, self);
  } else if (cJSON_IsBool(at)) {
    take_number(cJSON_IsTrue(at) ? 1.0 : 0.0, depth, offset, self);
  } else {
    self->wrong = true;
  }
}

/*
 * The numbers behind a name as an array, row by row: each list on the way is a dimension, and so is what lies
 * behind. False where there is none, or more than STRUTLIB_DIMENSIONS, and where memory is out.
 */
static bool read_array(const abi_tree *tree, const char *name, strut_arena *arena,
                       abi_array *array) {
  extent e = {.array = {.dimensions = -1}};
  visit(tree, name, 0, 0, &e);
  if (e.wrong || e.array.dimensions < 0) return false;
  e.array = abi_array_of(name, "", NULL, e.array.dimensions, e.array.shape);
  size_t count = e.array.dimensions ? e.array.shape[0] * e.array.stride[0] : 1;
  e.data = strut_arena_allocate(arena, count, sizeof *e.data);
  for (size_t i = 0; e.data && i < count; i++) e.data[i] = (double)NAN;
  if (e.data) visit(tree, name, 0, 0, &e);
  *array = e.array, array->data = e.data;
  return e.data != NULL;
}

/* Results: what all kinds of them show alike. */

strutlib_result *abi_result_create(const strut_command *command) {
  strutlib_result *result = strut_allocate(1, sizeof *result);
  if (result && pthread_mutex_init(&result->lock, NULL) == 0) {
    result->command = command;
    return result;
  }
  strut_release(result);
  return NULL;
}

void strutlib_result_free(strutlib_result *result) {
  if (!result) return;
  if (result->detail) result->release(result->detail);
  strut_model_free(result->model);
  if (result->opened) strut_setup_free(&result->setup);
  abi_tree_free(result->tree);
  strut_release(result->json);
  strut_release(result->table);
  abi_arrays_free(&result->made);
  abi_arrays_free(&result->arrays);
  abi_messages_free(&result->messages);
  pthread_mutex_destroy(&result->lock);
  strut_release(result);
}

/* ---- texts ---- */

#define OF_RESULT(TYPE, PART, VALUE, NONE)                                                         \
  TYPE strutlib_result_##PART(const strutlib_result *result) { return result ? VALUE : NONE; }
OF_RESULT(int, status, result->status, STRUTLIB_USAGE)
OF_RESULT(const char *, command, result->command->name, NULL)
OF_RESULT(const char *, json, result->json ? result->json : "{}\n", "{}\n")
OF_RESULT(const char *, table, result->table ? result->table : "", "")

const char *strutlib_result_warning(const strutlib_result *result, size_t i) {
  return result && i < result->messages.count ? result->messages.warnings[i] : NULL;
}

char *strutlib_result_yaml(const strutlib_result *result, strutlib_error **error) {
  strut_error what = {0};
  char *text = NULL;
  if (abi_lacks(error, result, "result")) return NULL;
  abi_enter(error);
  if (result->opened)
    text = strut_setup_write(&result->setup);
  else
    strut_fail(&what, STRUT_USAGE, "the result of %s holds no scene", result->command->name);
  return abi_leave_text(error, text, &what);
}

/* ---- values ---- */

/* The tree of the JSON; NULL: memory is out. With the lock. */
static const abi_tree *locked_tree(strutlib_result *result) {
  strut_c_locale locale = strut_c_locale_enter();
  if (!result->tree) result->tree = cJSON_Parse(strutlib_result_json(result));
  strut_c_locale_leave(locale);
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

ABI_TREE_VALUES(result)

size_t strutlib_result_count(const strutlib_result *result, const char *name) {
  const cJSON *at = find(tree_of(result), name);
  return cJSON_IsArray(at) || cJSON_IsObject(at) ? (size_t)cJSON_GetArraySize(at) : 0;
}

const char *strutlib_result_key(const strutlib_result *result, const char *name, size_t i) {
  const cJSON *at = find(tree_of(result), name);
  at = cJSON_IsObject(at) ? at->child : NULL;
  while (at && i-- > 0) at = at->next;
  return at ? at->string : NULL;
}

/* ---- arrays ---- */

abi_array abi_array_of(const char *name, const char *unit, const double *data, int dimensions,
                       const size_t *shape) {
  abi_array array = {.name = name, .unit = unit, .data = data, .dimensions = dimensions};
  size_t stride = 1;
  for (int d = dimensions - 1; d >= 0; d--) {
    array.shape[d] = shape[d];
    array.stride[d] = stride;
    stride *= shape[d];
  }
  return array;
}

const abi_array *abi_add_array(abi_arrays *list, const abi_array *array) {
  abi_array copy = *array;
  copy.name = strut_arena_text(&list->arena, array->name, strlen(array->name));
  copy.unit = strut_arena_text(&list->arena, array->unit, strlen(array->unit));
  if (!copy.name || !copy.unit ||
      !strut_grow(&list->items, &list->capacity, list->count, sizeof copy))
    return NULL;
  list->items[list->count] = copy;
  return &list->items[list->count++];
}

double *abi_new_array(abi_arrays *list, const char *name, const char *unit, size_t count,
                      size_t components) {
  double *data = strut_arena_allocate(&list->arena, count * components, sizeof *data);
  const size_t shape[] = {count, components};
  const abi_array array = abi_array_of(name, unit, data, components > 1 ? 2 : 1, shape);
  return data && abi_add_array(list, &array) ? data : NULL;
}

const abi_array *abi_find_array(const abi_arrays *list, const char *name) {
  for (size_t i = 0; i < list->count; i++)
    if (strcmp(list->items[i].name, name) == 0) return &list->items[i];
  return NULL;
}

void abi_arrays_free(abi_arrays *list) {
  strut_release(list->items);
  strut_arena_free(&list->arena);
}

int abi_show_array(const abi_array *array, const double **data, int *dimensions, size_t *shape,
                   size_t *stride) {
  if (!array || !data || !dimensions || !shape || !stride) return 0;
  *data = array->data;
  *dimensions = array->dimensions;
  for (int d = 0; d < array->dimensions; d++) {
    shape[d] = array->shape[d];
    stride[d] = array->stride[d];
  }
  return 1;
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

/* An array that is not in the JSON, or a part of one, which `part` has room for; or NULL. */
static const abi_array *given_array(const strutlib_result *result, const char *name,
                                    abi_array *part) {
  const abi_array *found = abi_find_array(&result->arrays, name);
  for (size_t i = 0; !found && i < result->arrays.count; i++)
    if (slice(result, &result->arrays.items[i], name, part)) found = part;
  return found;
}

int strutlib_result_array(const strutlib_result *constant, const char *name, const double **data,
                          int *dimensions, size_t *shape, size_t *stride) {
  abi_array part;
  if (!constant || !name) return 0;
  const abi_array *found = given_array(constant, name, &part);
  if (found) return abi_show_array(found, data, dimensions, shape, stride);
  strutlib_result *result =
      lock(constant); /* an array of the JSON is made when it is first asked for */
  found = abi_find_array(&result->made, name);
  if (!found && read_array(locked_tree(result), name, &result->made.arena, &part))
    found = abi_add_array(&result->made, &part);
  int shown = abi_show_array(found, data, dimensions, shape, stride);
  pthread_mutex_unlock(&result->lock);
  return shown;
}

const char *strutlib_result_array_name(const strutlib_result *result, size_t i) {
  return result && i < result->arrays.count ? result->arrays.items[i].name : NULL;
}

const char *strutlib_result_array_unit(const strutlib_result *result, const char *name) {
  abi_array part;
  const abi_array *found = result && name ? given_array(result, name, &part) : NULL;
  return found ? found->unit : NULL;
}
