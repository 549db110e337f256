/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The keys of a mapping: none twice, none empty. */
#include <string.h>

#include "parser/yaml/document_parts.h"
#include "parser/yaml/text.h"

enum { FEW_KEYS = 8 };

uint64_t strut_document_hash(const char *text, size_t length, uint64_t seed) {
  uint64_t hash = seed ^ UINT64_C(0xCBF29CE484222325);
  for (size_t i = 0; i < length; i++)
    hash = (hash ^ (unsigned char)text[i]) * UINT64_C(0x100000001B3);
  hash ^= hash >> 32;
  hash *= UINT64_C(0x9E3779B97F4A7C15);
  return hash ^ hash >> 29;
}

static bool clear_table(strut_key_table *table, size_t count) {
  size_t capacity = 32;
  while (capacity < 2 * count) capacity *= 2;
  if (capacity > table->capacity) {
    strut_release(table->slots);
    table->slots = strut_allocate(capacity, sizeof(strut_tree *));
    table->capacity = table->slots ? capacity : 0;
    return table->slots != NULL;
  }
  memset(table->slots, 0, capacity * sizeof(strut_tree *));
  return true;
}

/* An earlier key of the same text; otherwise NULL, and `key` is stored. */
static strut_tree *find_or_add_key(strut_key_table *table, size_t mask, strut_tree *key) {
  size_t slot = (size_t)strut_document_hash(key->text, strlen(key->text), table->seed) & mask;
  for (; table->slots[slot]; slot = (slot + 1) & mask)
    if (strcmp(table->slots[slot]->text, key->text) == 0) return table->slots[slot];
  table->slots[slot] = key;
  return NULL;
}

static strut_tree *find_among_few(strut_tree *map, strut_tree *key) {
  for (strut_tree *other = map->first; other != key; other = other->next->next)
    if (strcmp(other->text, key->text) == 0) return other;
  return NULL;
}

/* Longest stretch of a key that a message repeats, in bytes. */
enum { SHOWN_MOST = 64 };

static bool refuse_key(strut_tree *key, strut_tree *earlier, strut_diagnostics *diagnostics) {
  bool plain = !key->quoted;
  if (plain && key->text[0] == '\0')
    strut_diagnose(diagnostics, key->place, "a key is missing before this ':'");
  else if (plain && strcmp(key->text, "<<") == 0)
    strut_diagnose(diagnostics, key->place,
                   "'<<' is not allowed; use groups to share keys between things");
  else if (earlier)
    strut_diagnose(diagnostics, key->place, "duplicate key '%.*s'; the first one is in line %u",
                   strut_text_cut(key->text, SHOWN_MOST), key->text, earlier->place.line);
  else
    return false;
  return true;
}

bool strut_document_check_keys(strut_tree *map, strut_key_table *table,
                               strut_diagnostics *diagnostics) {
  bool few = map->count <= FEW_KEYS;
  if (!few && !clear_table(table, map->count)) return false;
  size_t mask = 31;
  while (mask + 1 < 2 * (size_t)map->count) mask = 2 * mask + 1;
  strut_tree **link = &map->first;
  while (*link) {
    strut_tree *key = *link;
    strut_tree *earlier = few ? find_among_few(map, key) : find_or_add_key(table, mask, key);
    if (refuse_key(key, earlier, diagnostics)) {
      *link = key->next->next;
      map->count--;
    } else {
      link = &key->next->next;
    }
  }
  return true;
}
