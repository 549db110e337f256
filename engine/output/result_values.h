/* SPDX-License-Identifier: GPL-3.0-or-later */
/** JSON; and emitters of results that are described by rows, as engine/scene/value_rows.h has them. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"
#include "engine/output/buffer.h"
#include "engine/scene/value_rows.h"

/*
 * Building JSON with cJSON: numbers as the shortest text that reads back to the same bits.
 *
 * Every function does nothing once memory was out, so that only strut_json_end has to ask.
 */

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

/** Number k of things, thing by thing, and whether it is there. */
STRUT_API double strut_value_item(const strut_value *value, const strut_result_object *of,
                                  size_t k);
STRUT_API bool strut_value_has(const strut_value *value, const strut_result_object *of, size_t k);

/** Adds the values of a struct as members of an object. */
STRUT_API void strut_json_values(strut_json *json, struct cJSON *to, const strut_value_rows *rows,
                                 const strut_result_object *of);
/** A whole result as JSON: of a scene (or NULL) its name and strut's version, its values; a block of strut_allocate or NULL. */
STRUT_API char *strut_values_json(const strut_value_rows *rows, const void *result,
                                  const struct strut_scene *scene);

/** Appends the names of the columns of a CSV, or their values, each after a comma. */
STRUT_API void strut_csv_add_names(strut_buffer *csv, const strut_value_rows *rows,
                                   const strut_result_object *of);
STRUT_API void strut_csv_add_values(strut_buffer *csv, const strut_value_rows *rows,
                                    const strut_result_object *of);
/**
 * The structs of a list, or of lists within one, "branches.points", as a CSV in a
 * block of strut_allocate or NULL. `before`: what stands before the names, and before the values; NULL: nothing.
 */
STRUT_API char *strut_values_csv(const strut_value_rows *rows, const char *path,
                                 const char *const before[2], const void *result,
                                 const struct strut_scene *scene);

/** Width of texts that no terminal shows, and that of tables in LaTeX; most structs of a list, unless all are wanted. */
enum { STRUT_REPORT_WIDTH = 100, STRUT_REPORT_LATEX = -1, STRUT_REPORT_ROWS = 60 };
/**
 * What people read of a result, in a block of strut_allocate or NULL: values with a label, those of the struct
 * each in a line, those of a list in a table with a line for each struct or, of few that are wider than `width`, a
 * column for each. An empty label is the key, and " " of a part leaves
 * its own title out; behind it "%" says how a ratio is shown, and "0" that a zero is not.
 */
STRUT_API char *strut_values_text(const strut_value_rows *rows, const void *result,
                                  const struct strut_scene *scene, int width, size_t most);

/** What limits tables: letters of a line, structs of a list, digits of numbers. */
typedef struct strut_table_page {
  int width; /* or STRUT_REPORT_LATEX */
  size_t most;
  int digits;
} strut_table_page;
/** Appends all of that but the name of the scene. */
STRUT_API void strut_values_add_tables(strut_buffer *text, const strut_value_rows *rows,
                                       const strut_result_object *of, const strut_table_page *page);

/** Appends rows of a Markdown table about the values, their keys after `before`. */
STRUT_API void strut_values_describe(strut_buffer *page, const strut_value_rows *rows,
                                     const char *before);
