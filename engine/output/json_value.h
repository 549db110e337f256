/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Building JSON with cJSON: numbers as the shortest text that reads back to the same bits.
 *
 * Every function does nothing once memory was out, so that only strut_json_end has to ask.
 */
#ifndef STRUT_ENGINE_OUTPUT_JSON_VALUE_H
#define STRUT_ENGINE_OUTPUT_JSON_VALUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"

struct cJSON;

typedef struct strut_json {
  struct cJSON *root; /* an object; owned */
  bool failed;        /* memory was out */
} strut_json;

STRUT_API strut_json strut_json_begin(void);
/** Adds to the object `to`, or appends to the array `to` when key is NULL. NULL text is null. */
STRUT_API void strut_json_text(strut_json *json, struct cJSON *to, const char *key,
                               const char *text);
/** Not finite is null. */
STRUT_API void strut_json_number(strut_json *json, struct cJSON *to, const char *key, double value);
STRUT_API void strut_json_integer(strut_json *json, struct cJSON *to, const char *key,
                                  int64_t value);
STRUT_API void strut_json_bool(strut_json *json, struct cJSON *to, const char *key, bool value);
/** A number, true or false as JSON writes it. */
STRUT_API void strut_json_raw(strut_json *json, struct cJSON *to, const char *key,
                              const char *text);
/** An array of numbers. */
STRUT_API void strut_json_numbers(strut_json *json, struct cJSON *to, const char *key,
                                  const double *values, size_t count);
/** An empty object or array in `to`, to be filled; belongs to json. */
STRUT_API struct cJSON *strut_json_object(strut_json *json, struct cJSON *to, const char *key);
STRUT_API struct cJSON *strut_json_array(strut_json *json, struct cJSON *to, const char *key);
/** The text of a tree with a final newline in a block of strut_allocate, or NULL. */
STRUT_API char *strut_json_print(const struct cJSON *tree);
/** Frees the tree; its text with a final newline in a block of strut_allocate, or NULL. */
STRUT_API char *strut_json_end(strut_json *json);

#endif
