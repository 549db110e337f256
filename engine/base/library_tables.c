/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/library_tables.h"

#include <pthread.h>
#include <string.h>

static pthread_mutex_t loading = PTHREAD_MUTEX_INITIALIZER;

static strut_status load(const void **table, const void *(*find)(strut_error *), size_t size,
                         strut_error *error) {
  strut_error own = {0};
  const strut_library_stamp *found = find(&own);
  if (!found) return strut_fail(error, own.status, "%s", own.message);
  if (found->size != size || strcmp(found->version, STRUT_VERSION) != 0)
    return strut_fail(error, STRUT_FILE_TROUBLE,
                      "a module belongs to strut %s, and this is strut " STRUT_VERSION
                      ": install strut again",
                      found->version);
  *table = found;
  return STRUT_OK;
}

strut_status strut_library_load(const void **table, const void *(*find)(strut_error *), size_t size,
                                strut_error *error) {
  strut_status status = STRUT_OK;
  pthread_mutex_lock(&loading);
  if (!*table) status = load(table, find, size, error);
  pthread_mutex_unlock(&loading);
  return status;
}
