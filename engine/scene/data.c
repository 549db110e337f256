/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of measured data. See data.h. */
#include "engine/scene/data.h"

#include <string.h>

const strut_data_column *strut_data_find(const strut_data_table *tables, size_t count,
                                         const char *name, const strut_data_table **table) {
  size_t length = strcspn(name, ".");
  if (table) *table = NULL;
  for (size_t i = 0; i < count; i++) {
    if (strncmp(tables[i].name, name, length) != 0 || tables[i].name[length]) continue;
    if (table) *table = &tables[i];
    for (size_t k = 0; name[length] && k < tables[i].column_count; k++)
      if (strcmp(tables[i].columns[k].name, name + length + 1) == 0) return &tables[i].columns[k];
  }
  return NULL;
}
