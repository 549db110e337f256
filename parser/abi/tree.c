/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/abi/tree.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/c_locale.h"

abi_tree *abi_tree_read(const char *json) {
  strut_c_locale locale = strut_c_locale_enter();
  cJSON *tree = cJSON_Parse(json);
  strut_c_locale_leave(locale);
  return tree;
}

void abi_tree_free(abi_tree *tree) { cJSON_Delete(tree); }

char *abi_tree_write(const abi_tree *tree) {
  strut_c_locale locale = strut_c_locale_enter();
  char *printed = cJSON_Print(tree), *text = NULL;
  strut_c_locale_leave(locale);
  if (!printed) return NULL;
  size_t length = strlen(printed);
  text = strut_allocate(length + 2, 1);
  if (text) {
    memcpy(text, printed, length);
    text[length] = '\n';
  }
  cJSON_free(printed);
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

size_t abi_tree_count(const abi_tree *tree, const char *name) {
  const cJSON *at = find(tree, name);
  return at && (cJSON_IsArray(at) || cJSON_IsObject(at)) ? (size_t)cJSON_GetArraySize(at) : 0;
}

const char *abi_tree_key(const abi_tree *tree, const char *name, size_t i) {
  const cJSON *at = find(tree, name);
  if (!at || !cJSON_IsObject(at)) return NULL;
  at = at->child;
  while (at && i-- > 0) at = at->next;
  return at ? at->string : NULL;
}

/* ---- arrays ---- */

typedef struct extent {
  int most, dimensions; /* dimensions: of the numbers found so far; -1 before the first */
  size_t shape[8];
  bool wrong;   /* texts, or numbers at different depths */
  double *data; /* NULL while measuring */
  size_t stride[8];
} extent;

static void visit(const cJSON *at, const char *name, int depth, size_t offset, extent *e);

static void visit_children(const cJSON *at, const char *name, int depth, size_t offset, extent *e) {
  size_t i = 0;
  if (depth >= e->most) {
    e->wrong = true;
    return;
  }
  for (const cJSON *child = at->child; child && !e->wrong; child = child->next, i++)
    visit(child, name, depth + 1, offset + (e->data ? i * e->stride[depth] : 0), e);
  if (!e->data && i > e->shape[depth]) e->shape[depth] = i;
}

static void take_number(double value, int depth, size_t offset, extent *e) {
  if (e->dimensions < 0) e->dimensions = depth;
  if (e->dimensions != depth) e->wrong = true;
  if (e->data && !e->wrong) e->data[offset] = value;
}

static void visit(const cJSON *at, const char *name, int depth, size_t offset, extent *e) {
  const char *rest = name;
  if (cJSON_IsNull(at)) return; /* stays NAN */
  if (*name && cJSON_IsArray(at)) {
    int index = number_of(name, &rest);
    const cJSON *item = index >= 0 ? cJSON_GetArrayItem(at, index) : NULL;
    if (index < 0)
      visit_children(at, name, depth, offset, e);
    else if (item)
      visit(item, rest, depth, offset, e);
  } else if (*name) {
    const cJSON *child = cJSON_IsObject(at) ? child_of(at, name, &rest) : NULL;
    if (child) visit(child, rest, depth, offset, e);
  } else if (cJSON_IsArray(at) || cJSON_IsObject(at)) {
    visit_children(at, name, depth, offset, e);
  } else if (cJSON_IsNumber(at)) {
    take_number(at->valuedouble, depth, offset, e);
  } else if (cJSON_IsBool(at)) {
    take_number(cJSON_IsTrue(at) ? 1.0 : 0.0, depth, offset, e);
  } else {
    e->wrong = true;
  }
}

double *abi_tree_array(const abi_tree *tree, const char *name, int most, strut_arena *arena,
                       int *dimensions, size_t *shape, bool *no_memory) {
  extent e = {.most = most, .dimensions = -1};
  *no_memory = false;
  visit(tree, name, 0, 0, &e);
  if (e.wrong || e.dimensions < 0) return NULL;
  size_t count = 1;
  for (int d = e.dimensions - 1; d >= 0; d--) {
    e.stride[d] = count;
    count *= e.shape[d];
    shape[d] = e.shape[d];
  }
  *dimensions = e.dimensions;
  e.data = strut_arena_allocate(arena, count, sizeof *e.data);
  *no_memory = !e.data;
  for (size_t i = 0; e.data && i < count; i++) e.data[i] = (double)NAN;
  if (e.data) visit(tree, name, 0, 0, &e);
  return e.data;
}
