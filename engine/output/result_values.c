/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/result_values.h"

#include <assert.h>
#include <cjson/cJSON.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/scene/scene.h"

strut_json strut_json_begin(void) {
  cJSON *root = cJSON_CreateObject();
  return (strut_json){root, root == NULL};
}

/* Takes ownership of the value. */
static cJSON *add(strut_json *json, cJSON *to, const char *key, cJSON *value) {
  bool added = value && to && !json->failed;
  if (added) added = key ? cJSON_AddItemToObject(to, key, value) : cJSON_AddItemToArray(to, value);
  if (added) return value;
  cJSON_Delete(value);
  json->failed = true;
  return NULL;
}

void strut_json_text(strut_json *json, cJSON *to, const char *key, const char *text) {
  add(json, to, key, text ? cJSON_CreateString(text) : cJSON_CreateNull());
}

static cJSON *number(double value) {
  char text[STRUT_NUMBER_TEXT];
  if (!isfinite(value)) return cJSON_CreateNull();
  strut_number_text(value, text);
  return cJSON_CreateRaw(text);
}

void strut_json_number(strut_json *json, cJSON *to, const char *key, double value) {
  add(json, to, key, number(value));
}

void strut_json_integer(strut_json *json, cJSON *to, const char *key, int64_t value) {
  char text[32];
  snprintf(text, sizeof text, "%" PRId64, value);
  add(json, to, key, cJSON_CreateRaw(text));
}

void strut_json_raw(strut_json *json, cJSON *to, const char *key, const char *text) {
  add(json, to, key, cJSON_CreateRaw(text));
}

void strut_json_bool(strut_json *json, cJSON *to, const char *key, bool value) {
  add(json, to, key, cJSON_CreateBool(value));
}

void strut_json_numbers(strut_json *json, cJSON *to, const char *key, const double *values,
                        size_t count) {
  cJSON *array = strut_json_array(json, to, key);
  for (size_t i = 0; i < count; i++) add(json, array, NULL, number(values[i]));
}

cJSON *strut_json_object(strut_json *json, cJSON *to, const char *key) {
  return add(json, to, key, cJSON_CreateObject());
}

cJSON *strut_json_array(strut_json *json, cJSON *to, const char *key) {
  return add(json, to, key, cJSON_CreateArray());
}

char *strut_json_print(const cJSON *tree) {
  char *printed = cJSON_Print(tree);
  if (!printed) return NULL;
  size_t length = strlen(printed);
  char *text = strut_allocate(length + 2, 1);
  if (text) {
    memcpy(text, printed, length);
    text[length] = '\n';
  }
  cJSON_free(printed);
  return text;
}

char *strut_json_end(strut_json *json) {
  char *text = json->failed ? NULL : strut_json_print(json->root);
  cJSON_Delete(json->root);
  *json = (strut_json){NULL, true};
  return text;
}

double strut_value_item(const strut_value *value, const strut_result_object *of, size_t k) {
  return value->each ? value->each(of, k) : ((const double *)value->items)[k];
}

bool strut_value_has(const strut_value *value, const strut_result_object *of, size_t k) {
  return !value->has || value->has(of, k);
}

/* A text, or words written into `room`; NULL: null. */
static const char *text_of(const strut_value *value, const strut_result_object *of,
                           char room[STRUT_VALUE_ROOM]) {
  if (value->kind == STRUT_VALUE_TEXT) return value->text;
  *room = '\0';
  value->write(of, room);
  return *room ? room : NULL;
}

/* ---- JSON ---- */

static void put_things(strut_json *json, struct cJSON *to, const char *key,
                       const strut_result_object *of, const strut_value *value) {
  struct cJSON *map = strut_json_object(json, to, key);
  size_t columns = value->columns;
  for (size_t i = 0; i < value->count; i++) {
    double number[2];
    const char *name = strut_owner_name(value->owner, of->scene, i);
    if (!strut_value_has(value, of, columns * i) &&
        !strut_value_has(value, of, columns * (i + 1) - 1))
      continue;
    for (size_t k = 0; k < columns; k++) number[k] = strut_value_item(value, of, columns * i + k);
    if (columns == 1)
      strut_json_number(json, map, name, number[0]);
    else
      strut_json_numbers(json, map, name, number, columns);
  }
}

static double rounded(double value, int digits) {
  if (!digits || value == 0.0 || !isfinite(value)) return value;
  double unit = pow(10, digits - 1 - floor(log10(fabs(value))));
  double result = round(value * unit) / unit;
  return isfinite(result) ? result : value;
}

static void put_numbers(strut_json *json, struct cJSON *to, const char *key,
                        const strut_value *value) {
  struct cJSON *list = strut_json_array(json, to, key);
  for (size_t i = 0; i < value->count; i++) {
    const double *item = (const void *)((const char *)value->items + i * value->size);
    struct cJSON *row = value->columns ? strut_json_array(json, list, NULL) : list;
    for (size_t k = 0; k < (value->columns ? value->columns : 1); k++)
      strut_json_number(json, row, NULL, rounded(item[k], value->digits));
  }
}

static void put_indices(strut_json *json, struct cJSON *to, const char *key,
                        const strut_value *value) {
  struct cJSON *list = strut_json_array(json, to, key);
  const int32_t *index = value->items;
  for (size_t i = 0; i < value->count; i++)
    if (index[i] >= 0) strut_json_integer(json, list, NULL, index[i]);
}

static void put_list(strut_json *json, struct cJSON *to, const strut_value_row *row,
                     const strut_result_object *of, const strut_value *value) {
  struct cJSON *list =
      value->name ? strut_json_object(json, to, row->key) : strut_json_array(json, to, row->key);
  for (size_t i = 0; i < value->count; i++) {
    const char *name = value->name ? value->name(of, i) : NULL;
    const strut_scene *scene = value->scene ? value->scene(of, i) : of->scene;
    strut_result_object item = {(const char *)value->items + i * value->size, of, scene, i};
    if ((name || !value->name) && strut_value_has(value, of, i))
      strut_json_values(json, strut_json_object(json, list, name), row->rows, &item);
  }
}

static void put_names(strut_json *json, struct cJSON *to, const char *key,
                      const strut_result_object *of, const strut_value *value) {
  struct cJSON *list = strut_json_array(json, to, key);
  for (size_t i = 0; i < value->count; i++) {
    const char *name = value->name(of, i);
    if (name) strut_json_text(json, list, NULL, *name ? name : NULL);
  }
}

static void put_map(strut_json *json, struct cJSON *to, const strut_value_row *row,
                    const strut_result_object *of, const strut_value *value);

static void put(strut_json *json, struct cJSON *to, const strut_value_row *row,
                const strut_result_object *of, const strut_value *value) {
  char room[STRUT_VALUE_ROOM];
  bool array = value->kind == STRUT_VALUE_NUMBERS || value->kind == STRUT_VALUE_LIST;
  if (array && !value->items && value->count) {
    strut_json_text(json, to, row->key, NULL);
    return;
  }
  switch (value->kind) {
    case STRUT_VALUE_ABSENT: break;
    case STRUT_VALUE_NUMBER:
      strut_json_number(json, to, row->key, rounded(value->number, value->digits));
      break;
    case STRUT_VALUE_COUNT: strut_json_integer(json, to, row->key, value->integer); break;
    case STRUT_VALUE_FLAG: strut_json_bool(json, to, row->key, value->integer != 0); break;
    case STRUT_VALUE_TEXT:
    case STRUT_VALUE_WORDS: strut_json_text(json, to, row->key, text_of(value, of, room)); break;
    case STRUT_VALUE_NUMBERS: put_numbers(json, to, row->key, value); break;
    case STRUT_VALUE_INDICES: put_indices(json, to, row->key, value); break;
    case STRUT_VALUE_NAMES: put_names(json, to, row->key, of, value); break;
    case STRUT_VALUE_THINGS: put_things(json, to, row->key, of, value); break;
    case STRUT_VALUE_MAP: put_map(json, to, row, of, value); break;
    case STRUT_VALUE_LIST: put_list(json, to, row, of, value); break;
    case STRUT_VALUE_PART: {
      strut_result_object part = {value->items, of, of->scene, 0};
      struct cJSON *object = row->key ? strut_json_object(json, to, row->key) : to;
      strut_json_values(json, object, row->rows, value->items == of->at ? of : &part);
    }
  }
}

static void put_map(strut_json *json, struct cJSON *to, const strut_value_row *row,
                    const strut_result_object *of, const strut_value *value) {
  struct cJSON *map = !value->name ? strut_json_array(json, to, row->key)
                      : row->key   ? strut_json_object(json, to, row->key)
                                   : to;
  for (size_t i = 0; i < value->count; i++) {
    strut_value_row entry = {.key = value->name ? value->name(of, i) : NULL, .rows = row->rows};
    strut_value item = value->value(of, i);
    put(json, map, &entry, of, &item);
  }
}

void strut_json_values(strut_json *json, struct cJSON *to, const strut_value_rows *rows,
                       const strut_result_object *of) {
  strut_value value[STRUT_MOST_VALUES];
  assert(rows->count <= STRUT_MOST_VALUES);
  rows->fill(of, value);
  for (size_t i = 0; i < rows->count; i++)
    if (rows->row[i].key || value[i].kind == STRUT_VALUE_MAP || value[i].kind == STRUT_VALUE_PART)
      put(json, to, &rows->row[i], of, &value[i]);
}

char *strut_values_json(const strut_value_rows *rows, const void *result,
                        const strut_scene *scene) {
  strut_c_locale locale = strut_c_locale_enter();
  strut_json json = strut_json_begin();
  if (scene) strut_json_text(&json, json.root, "name", scene->name);
  if (scene) strut_json_text(&json, json.root, "strut_version", STRUT_VERSION);
  strut_json_values(&json, json.root, rows, &(strut_result_object){result, NULL, scene, 0});
  strut_c_locale_leave(locale);
  return strut_json_end(&json);
}

/* ---- CSV ---- */

/* A line under way: names of columns or their values, and what stands before the next cell and name. */
typedef struct line {
  strut_buffer *csv;
  bool names;
  const char *before, *part;
} line;

static void next_cell(line *at) {
  strut_buffer_add(at->csv, "%s", at->before);
  at->before = ",";
}

static void add_cell(line *at, const strut_value_row *row, const strut_value *value,
                     const strut_result_object *of) {
  char room[STRUT_VALUE_ROOM];
  const char *text;
  next_cell(at);
  if (at->names && value->own_unit && !*row->column[0])
    strut_csv_add_text(at->csv, *value->own_unit ? "%s [%s]" : "%s", value->text, value->own_unit);
  else if (at->names)
    strut_buffer_add(at->csv, "%s%s", at->part, row->column[0]);
  else if (value->kind == STRUT_VALUE_NUMBER)
    strut_csv_add_number(at->csv, value->number);
  else if (value->kind == STRUT_VALUE_TEXT || value->kind == STRUT_VALUE_WORDS)
    strut_csv_add_text(at->csv, "%s", (text = text_of(value, of, room)) ? text : "");
  else
    strut_buffer_add(at->csv, "%lld", (long long)value->integer);
}

static void add_numbers(line *at, const strut_value_row *row, const strut_value *value) {
  for (size_t k = 0; k < value->count; k++) {
    next_cell(at);
    if (at->names)
      strut_buffer_add(at->csv, "%s %zu [%s]", row->column[0], k + 1, row->unit);
    else
      strut_csv_add_number(at->csv, ((const double *)value->items)[k]);
  }
}

static void add_things(line *at, const strut_value_row *row, const strut_value *value,
                       const strut_result_object *of) {
  size_t columns = value->columns;
  for (size_t k = 0; k < columns * value->count; k++) {
    if (!strut_value_has(value, of, k)) continue;
    next_cell(at);
    if (at->names)
      strut_csv_add_text(at->csv, "%s.%s", strut_owner_name(value->owner, of->scene, k / columns),
                         row->column[k % columns]);
    else
      strut_csv_add_number(at->csv, strut_value_item(value, of, k));
  }
}

static void add_columns(line *at, const strut_value_rows *rows, const strut_result_object *of);

static void add_part(line *at, const strut_value_row *row, const strut_result_object *of,
                     const strut_value *value) {
  strut_result_object part = {value->items, of, of->scene, 0};
  const char *outer = at->part;
  if (row->column[0]) at->part = row->column[0];
  add_columns(at, row->rows, value->items == of->at ? of : &part);
  at->part = outer;
}

static void add_map(line *at, const strut_value_row *row, const strut_value *value,
                    const strut_result_object *of) {
  for (size_t k = 0; k < value->count; k++) {
    const strut_value item = value->value(of, k);
    const char *unit = item.own_unit ? item.own_unit : "";
    if (!at->names) {
      add_cell(at, row, &item, of);
      continue;
    }
    next_cell(at);
    strut_csv_add_text(at->csv, *unit ? "%s [%s]" : "%s", value->name(of, k), unit);
  }
}

static void add_columns(line *at, const strut_value_rows *rows, const strut_result_object *of) {
  strut_value values[STRUT_MOST_VALUES];
  rows->fill(of, values);
  for (size_t i = 0; i < rows->count; i++) {
    const strut_value_row *row = &rows->row[i];
    const strut_value *value = &values[i];
    if (value->kind == STRUT_VALUE_PART && (!row->key || row->column[0]))
      add_part(at, row, of, value);
    else if (!row->column[0] || value->kind == STRUT_VALUE_ABSENT)
      continue;
    else if (value->kind == STRUT_VALUE_THINGS)
      add_things(at, row, value, of);
    else if (value->kind == STRUT_VALUE_NUMBERS)
      add_numbers(at, row, value);
    else if (value->kind == STRUT_VALUE_MAP)
      add_map(at, row, value, of);
    else
      add_cell(at, row, value, of);
  }
}

void strut_csv_add_names(strut_buffer *csv, const strut_value_rows *rows,
                         const strut_result_object *of) {
  add_columns(&(line){csv, true, ",", ""}, rows, of);
}

void strut_csv_add_values(strut_buffer *csv, const strut_value_rows *rows,
                          const strut_result_object *of) {
  add_columns(&(line){csv, false, ",", ""}, rows, of);
}

/* The names of the columns of an empty list are those of a struct of zeros. */
static const double zeros[256];

static void add_lines(strut_buffer *csv, const strut_value_rows *rows, const char *path,
                      const char *const before[2], const strut_result_object *of) {
  strut_value values[STRUT_MOST_VALUES];
  size_t at = 0, length = strcspn(path, ".");
  rows->fill(of, values);
  while (!rows->row[at].key || strncmp(rows->row[at].key, path, length) != 0) at++;
  bool none = !csv->length && !values[at].count;
  assert(!none || values[at].size <= sizeof zeros);
  for (size_t i = 0; i < values[at].count + none; i++) {
    const char *item =
        none ? (const char *)zeros : (const char *)values[at].items + i * values[at].size;
    const strut_result_object within = {item, of, of->scene, i};
    if (path[length]) add_lines(csv, rows->row[at].rows, path + length + 1, before, &within);
    for (int names = !csv->length; names >= none && !path[length]; names--) {
      line cells = {csv, names, "", ""};
      strut_buffer_add(csv, "%s", before ? before[!names] : "");
      add_columns(&cells, rows->row[at].rows, &within);
      strut_buffer_add(csv, "\n");
    }
  }
}

char *strut_values_csv(const strut_value_rows *rows, const char *path, const char *const before[2],
                       const void *result, const strut_scene *scene) {
  strut_buffer csv = {0};
  add_lines(&csv, rows, path, before, &(strut_result_object){result, NULL, scene, 0});
  return strut_buffer_take(&csv);
}

/* ---- the page of results ---- */

void strut_values_describe(strut_buffer *page, const strut_value_rows *rows, const char *before) {
  for (size_t i = 0; i < rows->count; i++) {
    const strut_value_row *row = &rows->row[i];
    const char *unit = row->unit[0] && strcmp(row->unit, "1") != 0 ? row->unit : "";
    char key[200];
    snprintf(key, sizeof key, "%s%s", before, row->key ? row->key : "");
    if (row->key)
      strut_buffer_add(page, "| `%s` | %s | %s |%s\n", key, unit, row->what,
                       row->column[0] ? " x |" : "  |");
    if (!row->rows) continue;
    if (row->key) snprintf(key, sizeof key, "%s%s.", before, row->key);
    strut_values_describe(page, row->rows, key);
  }
}
