/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups: keys of a member, a node, a contact or a hinge that many things share. See reader.h. */
#include <assert.h>
#include <string.h>

#include "parser/language/read/reader.h"
#include "parser/language/read/reuse/copies.h"

enum { SECTIONS = STRUT_GROUP_SECTIONS, HINGE = 3 };

/* An earlier key of the group that belongs to the same set as `key`, or NULL. */
static const strut_tree *rival(const strut_group *group, int key) {
  int set = strut_key_at(key)->set;
  for (size_t i = 0; set && i < group->count; i++)
    if (group->items[i].key[0] >= 0 && strut_key_at(group->items[i].key[0])->set == set)
      return group->items[i].slot.key;
  return NULL;
}

/* The value as things of the section read it, in the scope of the group, once it is needed. */
static strut_slot *read_value(strut_reader *reader, const strut_group *group,
                              strut_group_item *item, size_t section) {
  bool hinge = section == HINGE && item->apart;
  strut_slot *slot = hinge ? &item->of_hinge : &item->slot;
  const strut_tree *key = item->slot.key;
  if (slot->state != STRUT_ABSENT) return slot;
  strut_copy *before = strut_enter_scope(reader, group->key);
  strut_read_slot(reader, hinge ? item->key[HINGE] : item->first, key, key->next,
                  (strut_owner){"group", group->name}, slot);
  reader->scope = before;
  return slot;
}

static void read_item(strut_reader *reader, strut_group *group, const strut_tree *key,
                      strut_owner owner) {
  strut_group_item item = {.key = {-1, -1, -1, -1}, .slot = {.key = key, .value = key->next}};
  int found = -1;
  for (size_t r = 0; r < SECTIONS; r++) {
    item.key[r] = strut_key_named(reader, strut_group_sections[r], key);
    if (found < 0) found = item.key[r];
  }
  if (found >= 0 && strut_key_at(found)->type == STRUT_TYPE_GROUPS) {
    strut_report_error(reader, key->place, "a group cannot have a group, found '%s' in %s",
                       key->text, strut_owner_text(reader, owner));
    group->broken = true;
    return;
  }
  if (found < 0) {
    int meant = strut_unknown_key(reader, key, strut_group_sections, SECTIONS, owner);
    group->broken = true;
    if (meant < 0) return;
    for (size_t r = 0; r < SECTIONS; r++)
      item.key[r] = strut_key_find(strut_group_sections[r], strut_key_at(meant)->name);
    item.slot.state = STRUT_BROKEN;
    group->items[group->count++] = item;
    return;
  }
  item.first = found;
  item.apart = item.key[HINGE] >= 0 &&
               strut_key_at(item.key[HINGE])->measure != strut_key_at(found)->measure;
  if (!item.apart) read_value(reader, group, &item, 0);
  const strut_tree *other = rival(group, found);
  if (other) {
    strut_report_error(reader, key->place, "%s gives both '%s' and '%s', expected one of them",
                       strut_owner_text(reader, owner), other->text, key->text);
    item.slot.state = item.of_hinge.state = STRUT_BROKEN;
  }
  if (item.slot.state == STRUT_GIVEN && strcmp(strut_key_at(found)->name, "friction") == 0) {
    item.nested = strut_reader_allocate(reader, &reader->scratch, 1, sizeof *item.nested);
    if (!item.nested) return;
    strut_read_fields(reader, STRUT_SECTION_FRICTION, key->next,
                      (strut_owner){"the friction of group", group->name}, item.nested);
  }
  group->items[group->count++] = item;
}

static void read_group(strut_reader *reader, const strut_tree *key, strut_group *group) {
  const strut_tree *map = key->next;
  strut_owner owner = {"group", key->text};
  if (!strut_read_name(reader, key, "group")) group->broken = true;
  if (map->kind != STRUT_TREE_MAP) {
    strut_report_error(reader, map->place,
                       "expected keys of a member, a node, a contact or a hinge for %s, found %s",
                       strut_owner_text(reader, owner), strut_found(reader, map));
    group->broken = true;
    return;
  }
  group->items = strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *group->items);
  for (const strut_tree *tree = map->first; tree && group->items; tree = tree->next->next)
    read_item(reader, group, tree, owner);
}

size_t strut_groups_named(strut_reader *reader, const strut_tree *value, strut_group **groups) {
  size_t count = 0;
  const strut_tree *item = value->kind == STRUT_TREE_LIST ? value->first : value;
  for (; item && count < STRUT_MOST_GROUPS; item = value == item ? NULL : item->next) {
    int32_t index = item->kind == STRUT_TREE_SCALAR
                        ? strut_find_named(reader, &reader->group_names, item, item->text)
                        : -1;
    if (index >= 0) groups[count++] = &reader->groups[index];
  }
  return count;
}

void strut_read_groups(strut_reader *reader) {
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_GROUPS);
  size_t i = 0;
  if (!map) return;
  reader->groups =
      strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *reader->groups);
  for (const strut_tree *key = strut_first_entry(reader, map); key && reader->groups;
       key = strut_following_entry(reader, key)) {
    reader->groups[reader->group_count] = (strut_group){.name = key->text, .key = key};
    strut_add_name(reader, &reader->group_names, key->text, reader->group_count++);
  }
  for (const strut_tree *key = strut_first_entry(reader, map); key && reader->groups;
       key = strut_following_entry(reader, key))
    read_group(reader, key, &reader->groups[i++]);
}

static bool check_names(strut_reader *reader, const strut_tree *value, const char *key,
                        strut_owner owner) {
  bool fine = true,
       known = strut_slot_of(&reader->top, STRUT_KEY_SCENE_GROUPS)->state != STRUT_BROKEN;
  const strut_tree *item = value->kind == STRUT_TREE_LIST ? value->first : value;
  if (value->kind == STRUT_TREE_LIST && value->count > STRUT_MOST_GROUPS)
    return strut_report_error(reader, value->place, "%s names %u groups, expected at most %d",
                              strut_owner_text(reader, owner), (unsigned)value->count,
                              STRUT_MOST_GROUPS);
  const strut_namespace names = {"group", &reader->group_names, strut_row_name,
                                 STRUT_NAMED(reader->groups, reader->group_count),
                                 reader->group_count};
  for (; item && known; item = value == item ? NULL : item->next)
    if (strut_read_name_of(reader, item, key, owner, &names) < 0) fine = false;
  return fine && known;
}

/* True where the fields have the key, or another one of its set, already. */
static bool taken(strut_fields *fields, int key) {
  int set = strut_key_at(key)->set;
  if (strut_slot_of(fields, key)->state != STRUT_ABSENT) return true;
  if (!set) return false;
  int size = strut_section_size(fields->section);
  const strut_key *keys = strut_key_at(strut_section_first(fields->section));
  for (int i = 0; i < size; i++)
    if (keys[i].set == set && fields->slot[i].state != STRUT_ABSENT) return true;
  return false;
}

static void apply_group(strut_reader *reader, strut_fields *fields, strut_group *group,
                        strut_owner owner) {
  size_t section = 0;
  while (strut_group_sections[section] != fields->section) section++;
  assert(section < SECTIONS);
  /* lengths of a group outside of a scaled copy are scaled with the thing that uses it */
  double scale = strut_scope_scale(reader, NULL);
  if (group->key->placed) scale /= strut_scope_scale(reader, group->key);
  group->used = true;
  for (size_t i = 0; i < group->count; i++) {
    strut_group_item *item = &group->items[i];
    int key = item->key[section];
    if (key >= 0) {
      if (taken(fields, key)) continue;
      const strut_slot *slot = read_value(reader, group, item, section);
      *strut_slot_of(fields, key) = *slot;
      strut_slot_of(fields, key)->from = item;
      if (strut_key_at(key)->measure == STRUT_MEASURE_LENGTH)
        strut_slot_of(fields, key)->number[0] *= scale;
      if (slot->state == STRUT_BROKEN || (item->nested && item->nested->broken))
        fields->broken = true;
    } else if (!item->refused[section]) {
      item->refused[section] = true;
      if (item->slot.state == STRUT_BROKEN) continue;
      strut_report_error(reader, item->slot.key->place,
                         "group '%s' gives '%s' to %s, but a %s has no '%s'", group->name,
                         item->slot.key->text, strut_owner_text(reader, owner),
                         strut_section_name(fields->section), item->slot.key->text);
    }
  }
  if (group->broken) fields->broken = true;
}

void strut_apply_groups(strut_reader *reader, strut_fields *fields, int group_key,
                        strut_owner owner) {
  const strut_slot *slot = strut_slot_of(fields, group_key);
  strut_group *groups[STRUT_MOST_GROUPS];
  if (slot->state == STRUT_BROKEN) {
    reader->groups_unknown = true;
    strut_suppress_missing(fields);
  }
  if (slot->state != STRUT_GIVEN) return;
  bool fine = check_names(reader, slot->value, strut_key_at(group_key)->name, owner);
  size_t count = strut_groups_named(reader, slot->value, groups);
  while (count > 0) apply_group(reader, fields, groups[--count], owner);
  if (fine) return;
  reader->groups_unknown = true;
  fields->broken = true; /* the unknown group may have given what seems to be missing */
  strut_suppress_missing(fields);
}

/* Does some `group` of a tree name the group? Then copies that are not made would use it. */
static bool is_mentioned(const strut_tree *tree, const char *name) {
  if (!tree || tree->kind == STRUT_TREE_SCALAR) return false;
  for (const strut_tree *k = tree->first; k; k = k->next) {
    bool group = tree->kind == STRUT_TREE_MAP && strcmp(k->text, "group") == 0;
    if (tree->kind == STRUT_TREE_MAP) k = k->next;
    if (group && k->kind == STRUT_TREE_SCALAR && strcmp(k->text, name) == 0) return true;
    for (const strut_tree *item = group ? k->first : NULL; item; item = item->next)
      if (item->kind == STRUT_TREE_SCALAR && strcmp(item->text, name) == 0) return true;
    if (!group && is_mentioned(k, name)) return true;
  }
  return false;
}

void strut_report_unused_groups(strut_reader *reader) {
  for (size_t i = 0; i < reader->group_count; i++)
    for (size_t k = 0; k < reader->groups[i].count; k++) {
      strut_group_item *item = &reader->groups[i].items[k]; /* wrong values of others, too */
      if (item->of_hinge.state == STRUT_ABSENT) read_value(reader, &reader->groups[i], item, 0);
    }
  if (reader->groups_unknown || reader->top.broken) return;
  for (size_t i = 0; i < reader->group_count; i++) {
    const strut_group *group = &reader->groups[i];
    if (group->used || group->broken || group->key->placed) continue;
    if (is_mentioned(strut_slot_of(&reader->top, STRUT_KEY_SCENE_PARTS)->value, group->name) ||
        is_mentioned(strut_slot_of(&reader->top, STRUT_KEY_SCENE_PLACE)->value, group->name))
      continue;
    strut_report_error(reader, group->key->place, "nothing uses group '%s'", group->name);
  }
}
