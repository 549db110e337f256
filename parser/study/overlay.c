/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/study/overlay.h"

#include <string.h>

#include "parser/language/keys.h"

/* Keys that a key laid over replaces besides its own name. */
static const char *const rivals[][2] = {
    {"duration", "periods"},      {"duration", "of"},         {"periods", "duration"},
    {"step", "accuracy"},         {"integrator", "accuracy"}, {"equilibrium", "configuration"},
    {"equilibrium", "positions"}, {"equilibrium", "settle"},  {"configuration", "equilibrium"},
    {"positions", "equilibrium"}, {"settle", "equilibrium"}};

strut_place strut_overlay_place(strut_place place) {
  place.line |= STRUT_OVERLAY_LINE;
  return place;
}

/* A node as it is, its children shared; NULL: memory is out. */
static strut_tree *copied(strut_arena *arena, const strut_tree *node) {
  strut_tree *copy = strut_arena_allocate(arena, 1, sizeof *copy);
  if (!copy) return NULL;
  *copy = *node;
  copy->next = NULL;
  return copy;
}

/* All of it, marked. Documents are no deeper than 64 levels. */
static strut_tree *marked(strut_arena *arena, const strut_tree *node) {
  strut_tree *copy = copied(arena, node);
  if (!copy) return NULL;
  copy->place = strut_overlay_place(copy->place);
  copy->text = strut_arena_text(arena, node->text, strlen(node->text));
  strut_tree **end = &copy->first;
  for (const strut_tree *child = node->first; child && copy->text; child = child->next) {
    *end = marked(arena, child);
    if (!*end) return NULL;
    end = &(*end)->next;
  }
  return copy->text ? copy : NULL;
}

/* Does a key laid over replace this one? Either may have its former name. */
static bool replaced(strut_section section, const strut_tree *over, const char *key) {
  const char *current = strut_key_current(section, key);
  for (const strut_tree *k = over->first; k; k = k->next->next) {
    if (strcmp(strut_key_current(section, k->text), current) == 0) return true;
    for (size_t i = 0; i < sizeof rivals / sizeof rivals[0]; i++)
      if (strcmp(k->text, rivals[i][0]) == 0 && strcmp(key, rivals[i][1]) == 0) return true;
  }
  return false;
}

static strut_tree *merged(strut_arena *arena, strut_section section, const strut_tree *base,
                          const strut_tree *over);

/* The value of a key laid over: two mappings become one. */
static strut_tree *joined(strut_arena *arena, const strut_tree *base, const strut_tree *key) {
  const strut_tree *below = strut_tree_find(base, key->text, NULL), *value = key->next;
  if (below && below->kind == STRUT_TREE_MAP && value->kind == STRUT_TREE_MAP)
    return merged(arena, strut_section_find(key->text), below, value);
  return marked(arena, value);
}

/* A mapping with the keys of `base` that stay, then those of `over`. NULL: memory is out. */
static strut_tree *merged(strut_arena *arena, strut_section section, const strut_tree *base,
                          const strut_tree *over) {
  strut_tree *map = copied(arena, base);
  if (!map) return NULL;
  strut_tree **end = &map->first;
  map->count = 0;
  map->first = NULL;
  for (const strut_tree *k = base->first; k; k = k->next->next) {
    if (replaced(section, over, k->text)) continue;
    strut_tree *key = copied(arena, k), *value = copied(arena, k->next);
    if (!key || !value) return NULL;
    *end = key, key->next = value, end = &value->next;
    map->count++;
  }
  for (const strut_tree *k = over->first; k; k = k->next->next) {
    strut_tree bare = *k;
    bare.first = NULL;
    strut_tree *key = marked(arena, &bare), *value = joined(arena, base, k);
    if (!key || !value) return NULL;
    *end = key, key->next = value, end = &value->next;
    map->count++;
  }
  return map;
}

/* A new key of the document with what is laid over as its value. */
static bool append(strut_document *document, const char *section, const strut_tree *value) {
  strut_tree *root = document->root, *last = root->first;
  const strut_tree named = {.kind = STRUT_TREE_SCALAR, .place = value->place, .text = section};
  strut_tree *key = marked(&document->arena, &named), *copy = marked(&document->arena, value);
  if (!key || !copy) return false;
  key->next = copy;
  while (last && last->next) last = last->next;
  if (last)
    last->next = key;
  else
    root->first = key;
  root->count++;
  return true;
}

bool strut_overlay(strut_document *document, const char *section, const strut_tree *value) {
  strut_tree *root = document->root;
  if (root->kind != STRUT_TREE_MAP || value->kind != STRUT_TREE_MAP) return true;
  strut_tree *below = strut_tree_find(root, section, NULL);
  if (!below) return append(document, section, value);
  if (below->kind != STRUT_TREE_MAP) return true; /* what is wrong with it will be said */
  strut_tree *map = merged(&document->arena, strut_section_find(section), below, value);
  if (!map) return false;
  below->first = map->first;
  below->count = map->count;
  return true;
}

static void split_notes(strut_diagnostics *from, strut_diagnostics *over) {
  size_t kept = 0;
  for (size_t i = 0; i < from->note_count; i++) {
    strut_diagnostic note = from->notes[i];
    if (note.place.line & STRUT_OVERLAY_LINE) {
      note.place.line &= ~STRUT_OVERLAY_LINE;
      strut_note(over, note.place, "%s", note.message);
    } else {
      from->notes[kept++] = note;
    }
  }
  from->note_count = kept;
}

bool strut_overlay_split(strut_diagnostics *from, strut_diagnostics *over) {
  size_t kept = 0;
  split_notes(from, over);
  for (size_t i = 0; i < from->count; i++) {
    strut_diagnostic item = from->items[i];
    if (!(item.place.line & STRUT_OVERLAY_LINE)) {
      from->items[kept++] = item;
      continue;
    }
    item.place.line &= ~STRUT_OVERLAY_LINE;
    strut_diagnose(over, item.place, "%s", item.message);
  }
  from->count = kept;
  return !over->out_of_memory;
}
