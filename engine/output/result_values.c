/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/result_values.h"

#include <math.h>
#include <string.h>

#include "engine/scene/scene.h"

size_t strut_value_columns(const strut_value_row *row) {
  return row->owner == STRUT_OWNER_NODE ? 2 : 1;
}

static size_t stored_count(const char *object, const strut_value_row *row) {
  if (row->counts_as == STRUT_VALUE_INTEGER)
    return (size_t) * (const int32_t *)(const void *)(object + row->count_at);
  return *(const size_t *)(const void *)(object + row->count_at);
}

strut_value strut_value_of(const strut_value_row *row, const strut_result_object *of) {
  const char *object = of->at;
  const void *stored = object + row->at;
  strut_value value = {.kind = row->kind};
  if (row->there && !row->there(of)) return (strut_value){0};
  if (row->get) return row->get(of);
  switch (row->kind) {
    case STRUT_VALUE_ABSENT:
    case STRUT_VALUE_NAMES: break;
    case STRUT_VALUE_NUMBER: value.number = *(const double *)stored; break;
    case STRUT_VALUE_INTEGER: value.integer = *(const int32_t *)stored; break;
    case STRUT_VALUE_COUNT: value.integer = *(const int64_t *)stored; break;
    case STRUT_VALUE_FLAG: value.integer = *(const bool *)stored; break;
    case STRUT_VALUE_TEXT: value.text = *(const char *const *)stored; break;
    case STRUT_VALUE_WORDS: value.text = *(const char *)stored ? stored : NULL; break;
    case STRUT_VALUE_PART: value.items = stored; break;
    case STRUT_VALUE_THINGS:
      value.items = *(const void *const *)stored;
      value.count = strut_owner_count(row->owner, of->scene);
      if (!value.count && row->owner != STRUT_OWNER_MEMBER && row->owner != STRUT_OWNER_CONTACT)
        value.kind = STRUT_VALUE_ABSENT;
      break;
    case STRUT_VALUE_NUMBERS:
    case STRUT_VALUE_LIST:
      value.items = *(const void *const *)stored;
      value.count = stored_count(object, row);
      if (!value.items && value.count) value = strut_value_text(NULL); /* not known */
      break;
  }
  return value;
}

bool strut_value_has(const strut_value_row *row, const strut_result_object *of, size_t k) {
  return !row->has || row->has(of, k);
}

/* ---- JSON ---- */

static void put_things(strut_json *json, struct cJSON *to, const strut_value_row *row,
                       const strut_result_object *of, const strut_value *value) {
  struct cJSON *map = strut_json_object(json, to, row->key);
  size_t columns = strut_value_columns(row);
  for (size_t i = 0; i < value->count; i++) {
    const double *number = (const double *)value->items + columns * i;
    const char *name = strut_owner_name(row->owner, of->scene, i);
    if (!strut_value_has(row, of, columns * i) &&
        !strut_value_has(row, of, columns * i + columns - 1))
      continue;
    if (columns == 1)
      strut_json_number(json, map, name, *number);
    else
      strut_json_numbers(json, map, name, number, columns);
  }
}

static void put_list(strut_json *json, struct cJSON *to, const strut_value_row *row,
                     const strut_result_object *of, const strut_value *value) {
  struct cJSON *list =
      value->name ? strut_json_object(json, to, row->key) : strut_json_array(json, to, row->key);
  for (size_t i = 0; i < value->count; i++) {
    const char *name = value->name ? value->name(of, i) : NULL;
    strut_result_object item = {(const char *)value->items + i * row->size, of, of->scene};
    if (name || !value->name)
      strut_json_values(json, strut_json_object(json, list, name), row->rows, &item);
  }
}

static void put_names(strut_json *json, struct cJSON *to, const char *key,
                      const strut_result_object *of, const strut_value *value) {
  struct cJSON *list = strut_json_array(json, to, key);
  for (size_t i = 0; i < value->count; i++) {
    const char *name = value->name(of, i);
    if (name) strut_json_text(json, list, NULL, name);
  }
}

static void put(strut_json *json, struct cJSON *to, const strut_value_row *row,
                const strut_result_object *of) {
  strut_value value = strut_value_of(row, of);
  switch (value.kind) {
    case STRUT_VALUE_ABSENT: break;
    case STRUT_VALUE_NUMBER: strut_json_number(json, to, row->key, value.number); break;
    case STRUT_VALUE_INTEGER:
    case STRUT_VALUE_COUNT: strut_json_integer(json, to, row->key, value.integer); break;
    case STRUT_VALUE_FLAG: strut_json_bool(json, to, row->key, value.integer != 0); break;
    case STRUT_VALUE_TEXT:
    case STRUT_VALUE_WORDS: strut_json_text(json, to, row->key, value.text); break;
    case STRUT_VALUE_NUMBERS:
      strut_json_numbers(json, to, row->key, value.items, value.count);
      break;
    case STRUT_VALUE_NAMES: put_names(json, to, row->key, of, &value); break;
    case STRUT_VALUE_THINGS: put_things(json, to, row, of, &value); break;
    case STRUT_VALUE_LIST: put_list(json, to, row, of, &value); break;
    case STRUT_VALUE_PART: {
      strut_result_object part = {value.items, of, of->scene};
      if (row->key)
        strut_json_values(json, strut_json_object(json, to, row->key), row->rows, &part);
      else
        strut_json_values(json, to, row->rows, of);
    }
  }
}

void strut_json_values(strut_json *json, struct cJSON *to, const strut_value_rows *rows,
                       const strut_result_object *of) {
  for (size_t i = 0; i < rows->count; i++) put(json, to, &rows->row[i], of);
}

char *strut_result_to_json(const strut_value_rows *rows, const void *result,
                           const strut_scene *scene) {
  strut_json json = strut_json_begin();
  strut_json_text(&json, json.root, "name", scene->name);
  strut_json_text(&json, json.root, "strut_version", STRUT_VERSION);
  strut_json_values(&json, json.root, rows, &(strut_result_object){result, NULL, scene});
  return strut_json_end(&json);
}

/* ---- CSV ---- */

void strut_csv_add_head(strut_buffer *csv, const strut_value_rows *rows,
                        const strut_result_object *of) {
  for (const strut_value_row *row = rows->row; row < rows->row + rows->count; row++) {
    strut_value value = strut_value_of(row, of);
    size_t columns = strut_value_columns(row);
    if (row->kind == STRUT_VALUE_PART && !row->key) strut_csv_add_head(csv, row->rows, of);
    if (!row->column[0] || value.kind == STRUT_VALUE_ABSENT) continue;
    if (row->kind != STRUT_VALUE_THINGS) strut_buffer_add(csv, ",%s", row->column[0]);
    for (size_t k = 0; row->kind == STRUT_VALUE_THINGS && k < columns * value.count; k++) {
      if (!strut_value_has(row, of, k)) continue;
      strut_buffer_add(csv, ",");
      strut_csv_add_text(csv, "%s.%s", strut_owner_name(row->owner, of->scene, k / columns),
                         row->column[k % columns]);
    }
  }
}

void strut_csv_add_values(strut_buffer *csv, const strut_value_rows *rows,
                          const strut_result_object *of) {
  for (const strut_value_row *row = rows->row; row < rows->row + rows->count; row++) {
    strut_value value = strut_value_of(row, of);
    if (row->kind == STRUT_VALUE_PART && !row->key) strut_csv_add_values(csv, row->rows, of);
    if (!row->column[0] || value.kind == STRUT_VALUE_ABSENT) continue;
    bool things = row->kind == STRUT_VALUE_THINGS;
    size_t count = things ? value.count * strut_value_columns(row) : 1;
    for (size_t k = 0; k < count; k++) {
      if (things && !strut_value_has(row, of, k)) continue;
      strut_buffer_add(csv, ",");
      if (things)
        strut_csv_add_number(csv, ((const double *)value.items)[k]);
      else if (value.kind == STRUT_VALUE_NUMBER)
        strut_csv_add_number(csv, value.number);
      else if (value.kind == STRUT_VALUE_TEXT || value.kind == STRUT_VALUE_WORDS)
        strut_csv_add_text(csv, "%s", value.text ? value.text : "");
      else
        strut_buffer_add(csv, "%lld", (long long)value.integer);
    }
  }
}
