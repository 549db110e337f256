/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A map from names to indices: a hash table that grows as names are added. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"

/** Zero-initialise it; strut_name_map_free releases it. Names are not copied. */
typedef struct strut_name_map {
  size_t count, slots;
  struct strut_name_slot *slot;
} strut_name_map;

/**
 * Adds name -> index (index >= 0). Returns -1 when the name is new, the index it already has (the
 * map is unchanged) otherwise, and -2 when memory is out.
 */
STRUT_API int32_t strut_name_map_add(strut_name_map *map, const char *name, int32_t index);
/** Makes room for `count` names in all, for which the map need not grow any more. 0: memory is out. */
STRUT_API int strut_name_map_reserve(strut_name_map *map, size_t count);
/** The index of a name, or -1. */
STRUT_API int32_t strut_name_map_find(const strut_name_map *map, const char *name);
STRUT_API void strut_name_map_free(strut_name_map *map);
