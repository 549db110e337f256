/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/json_value.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"

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
