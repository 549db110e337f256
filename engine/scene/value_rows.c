/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scene/value_rows.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/scene/scene.h"

const strut_value_row *strut_value_at(const strut_value_rows *rows, const char *path,
                                      const strut_result_object *of, strut_value *value) {
  strut_value values[STRUT_MOST_VALUES];
  size_t length = strcspn(path, ".");
  assert(rows->count <= STRUT_MOST_VALUES);
  if (of) rows->fill(of, values);
  for (size_t i = 0; i < rows->count; i++) {
    const strut_value_row *row = &rows->row[i];
    if (!row->key || strncmp(row->key, path, length) != 0 || row->key[length]) continue;
    if (of) *value = values[i];
    if (!path[length]) return row;
    strut_result_object part = {of ? values[i].items : NULL, of, of ? of->scene : NULL, 0};
    return strut_value_at(row->rows, path + length + 1,
                          of && values[i].kind == STRUT_VALUE_PART ? &part : NULL, value);
  }
  return NULL;
}

const char *strut_name_of_parameter(const strut_result_object *of, size_t i) {
  return of->scene->parameters[i].name;
}

strut_value strut_value_of_parameter(const strut_result_object *of, size_t i) {
  const strut_parameter *parameter = &of->scene->parameters[i];
  return isnan(parameter->value) ? STRUT_VALUE_AS_TEXT(parameter->text)
                                 : STRUT_VALUE_AS_NUMBER(parameter->value);
}
