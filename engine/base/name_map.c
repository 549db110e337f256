/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/name_map.h"

#include <string.h>

#include "engine/base/memory.h"

struct strut_name_slot {
  const char *name; /* NULL: free */
  uint32_t hash;
  int32_t index;
};

static uint32_t hash_of(const char *name) {
  uint64_t hash = 0x9e3779b97f4a7c15u;
  for (; *name; name++) {
    hash = (hash ^ (unsigned char)*name) * 0xff51afd7ed558ccdu;
    hash ^= hash >> 32;
  }
  return (uint32_t)hash;
}

/* Maps of fewer names begin small. */
enum { FIRST_SLOTS = 16 };

/* The slot that holds the name, or the free one where it belongs. */
static struct strut_name_slot *slot_for(const strut_name_map *map, const char *name,
                                        uint32_t hash) {
  size_t i = (size_t)((uint64_t)hash * map->slots >> 32);
  while (map->slot[i].name && (map->slot[i].hash != hash || strcmp(map->slot[i].name, name) != 0))
    i = i + 1 < map->slots ? i + 1 : 0;
  return &map->slot[i];
}

/* Moves the names to a larger table; returns 0 when memory is out. */
static int grow(strut_name_map *map, size_t slots) {
  strut_name_map bigger = {map->count, slots, NULL};
  bigger.slot = strut_allocate(bigger.slots, sizeof *bigger.slot);
  if (!bigger.slot) return 0;
  for (size_t i = 0; i < map->slots; i++)
    if (map->slot[i].name) *slot_for(&bigger, map->slot[i].name, map->slot[i].hash) = map->slot[i];
  strut_release(map->slot);
  *map = bigger;
  return 1;
}

int strut_name_map_reserve(strut_name_map *map, size_t count) {
  size_t slots = count + count / 2;
  return slots <= FIRST_SLOTS || slots <= map->slots || grow(map, slots);
}

int32_t strut_name_map_add(strut_name_map *map, const char *name, int32_t index) {
  size_t wider = map->slots ? 2 * map->slots : FIRST_SLOTS;
  if (5 * (map->count + 1) > 4 * map->slots && !grow(map, wider)) return -2;
  uint32_t hash = hash_of(name);
  struct strut_name_slot *slot = slot_for(map, name, hash);
  if (slot->name) return slot->index;
  *slot = (struct strut_name_slot){name, hash, index};
  map->count++;
  return -1;
}

int32_t strut_name_map_find(const strut_name_map *map, const char *name) {
  if (!map->slots) return -1;
  const struct strut_name_slot *slot = slot_for(map, name, hash_of(name));
  return slot->name ? slot->index : -1;
}

void strut_name_map_free(strut_name_map *map) {
  strut_release(map->slot);
  *map = (strut_name_map){0};
}
