/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/drawing_calls.h"

const void *strut_drawing_loaded;

strut_status strut_drawing_load(strut_error *error) {
  return strut_library_load(&strut_drawing_loaded, strut_drawing_table_find,
                            sizeof(strut_drawing_library), error);
}
