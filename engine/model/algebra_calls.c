/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/algebra_calls.h"

const void *strut_algebra_loaded;

strut_status strut_algebra_load(strut_error *error) {
  return strut_library_load(&strut_algebra_loaded, strut_algebra_table_find,
                            sizeof(strut_algebra_library), error);
}
