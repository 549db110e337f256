/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collisions of all members, or of groups: each stands for one of every two of them. See reader.h. */
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/read/reader.h"

enum { MOST_PAIRS = 100000 };

static bool names_group(const strut_tree *value, const char *group) {
  if (!value) return false;
  if (value->kind == STRUT_TREE_SCALAR) return strcmp(value->text, group) == 0;
  for (const strut_tree *item = value->first; item; item = item->next)
    if (item->kind == STRUT_TREE_SCALAR && strcmp(item->text, group) == 0) return true;
  return false;
}

/* `all`, or members of a group: is it one of these? */
static bool belongs(const strut_reader *reader, size_t member, const char *group) {
  const strut_source *source = reader->things[STRUT_THING_MEMBER].source;
  const strut_tree *value = source ? source[member].value : NULL;
  if (reader->scene->members[member].guide_count) return false;
  return !group || (value && names_group(strut_tree_find(value, "group", NULL), group));
}

/* The group of one of the two sets, NULL of all; false where it was reported that there is no such group. */
static bool read_set(strut_reader *reader, const strut_tree *value, strut_owner owner,
                     const char **group) {
  if (value->kind != STRUT_TREE_SCALAR)
    return strut_refuse_form(reader, STRUT_KEY_COLLISION_BETWEEN, value, owner);
  *group = strcmp(value->text, "all") == 0 ? NULL : value->text;
  for (size_t j = 0; *group && j < reader->scene->member_count; j++)
    if (belongs(reader, j, *group)) return true;
  if (!*group) return true;
  return strut_report_error(
      reader, value->place, "no straight member is of group '%s', which %s names",
      strut_sanitised_text(reader, value->text), strut_owner_text(reader, owner));
}

static double side_of(const double *first, const double *second, const double *p) {
  return (second[0] - first[0]) * (p[1] - first[1]) - (second[1] - first[1]) * (p[0] - first[0]);
}

/* Are two members drawn apart from each other, so that they may come to touch? */
static bool apart(const strut_scene *scene, size_t i, size_t j, double thickness) {
  const int32_t *m = scene->members[i].node, *n = scene->members[j].node;
  if (m[0] < 0 || m[1] < 0 || n[0] < 0 || n[1] < 0) return false;
  if (m[0] == n[0] || m[0] == n[1] || m[1] == n[0] || m[1] == n[1]) return false;
  const double *a = scene->nodes[m[0]].position, *b = scene->nodes[m[1]].position;
  const double *c = scene->nodes[n[0]].position, *d = scene->nodes[n[1]].position;
  if (side_of(a, b, c) * side_of(a, b, d) < 0.0 && side_of(c, d, a) * side_of(c, d, b) < 0.0)
    return false;
  double near = fmin(fmin(strut_distance_to_segment(a, c, d), strut_distance_to_segment(b, c, d)),
                     fmin(strut_distance_to_segment(c, a, b), strut_distance_to_segment(d, a, b)));
  return near >= thickness;
}

/* The collisions that one stands for, which are added unless `key` is NULL; returns how many. */
static size_t add_pairs(strut_reader *reader, const strut_collision *like,
                        const char *const group[2], const strut_tree *key) {
  const strut_scene *scene = reader->scene;
  size_t count = 0;
  for (size_t i = 0; i < scene->member_count && count <= MOST_PAIRS; i++)
    for (size_t j = i + 1; j < scene->member_count; j++) {
      bool one = belongs(reader, i, group[0]) && belongs(reader, j, group[1]);
      bool other = belongs(reader, i, group[1]) && belongs(reader, j, group[0]);
      if (!(one || other) || !apart(scene, i, j, like->thickness)) continue;
      count++;
      if (!key) continue;
      const char *name = strut_kept_text(reader, "%s_%s_%s", like->name, scene->members[i].name,
                                         scene->members[j].name);
      strut_collision *collision = strut_add_thing(reader, STRUT_THING_COLLISION, key, name);
      *collision = *like;
      collision->name = name;
      collision->member[0] = (int32_t)i, collision->member[1] = (int32_t)j;
    }
  return count;
}

/* Adds what one of `owner` stands for, where `more` may follow. False: there are too many, which was reported. */
static bool replace_collision(strut_reader *reader, const strut_collision *like,
                              const char *const group[2], const strut_tree *key, strut_place place,
                              const char *owner, size_t more) {
  size_t count = add_pairs(reader, like, group, NULL);
  if (count > MOST_PAIRS)
    return strut_report_error(reader, place, "%s more than %d pairs of members", owner,
                              (int)MOST_PAIRS);
  if (!count || !strut_reserve_things(reader, STRUT_THING_COLLISION, count + more)) return true;
  add_pairs(reader, like, group, key);
  return true;
}

/* What `collisions: all` takes: a hundredth of the drawn size, and ten times the stiffest member. */
static strut_collision usual_collision(const strut_scene *scene) {
  strut_collision usual = strut_collision_default();
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, stiffest = 0.0;
  for (size_t i = 0; i < scene->node_count; i++)
    for (int c = 0; c < 2; c++) {
      low[c] = fmin(low[c], scene->nodes[i].position[c]);
      high[c] = fmax(high[c], scene->nodes[i].position[c]);
    }
  strut_rest rest;
  for (size_t j = 0; j < scene->member_count; j++)
    if (scene->members[j].node[0] >= 0 && scene->members[j].node[1] >= 0 &&
        strut_member_rest(scene, j, &rest))
      stiffest = fmax(stiffest, rest.stiffness);
  usual.name = "all";
  usual.thickness = 0.01 * fmax(high[0] - low[0], high[1] - low[1]);
  usual.stiffness = 10.0 * stiffest;
  return usual;
}

/* `between` of a collision, or NULL. */
static const strut_tree *between_of(const strut_source *source) {
  return source->value ? strut_tree_find(source->value, "between", NULL) : NULL;
}

/* One `between` two sets of members. False: that was reported. */
static bool add_between(strut_reader *reader, const strut_source *source,
                        const strut_collision *collision, size_t more) {
  const strut_tree *between = between_of(source), *set = between;
  strut_owner owner = {"collision", collision->name};
  const char *group[2];
  bool list = between->kind == STRUT_TREE_LIST;
  if (source->broken) return false;
  if (list && between->count != 2)
    return strut_refuse_form(reader, STRUT_KEY_COLLISION_BETWEEN, between, owner);
  for (int k = 0; k < 2; k++) {
    if (list) set = k ? between->first->next : between->first;
    if (!read_set(reader, set, owner, &group[k])) return false;
  }
  return replace_collision(
      reader, collision, group, source->key, between->place,
      strut_scratch_text(reader, "%s stands for", strut_owner_text(reader, owner)), more);
}

void strut_read_bodies(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  strut_things_read *read = &reader->things[STRUT_THING_COLLISION];
  const strut_slot *slot = strut_slot_of(&reader->top, STRUT_KEY_SCENE_COLLISIONS);
  const strut_collision *given = scene->collisions;
  const strut_source *source = read->source;
  size_t count = scene->collision_count;
  bool all = slot->key && slot->state == STRUT_ABSENT, many = all;
  for (size_t i = 0; i < count; i++) many = many || between_of(&source[i]);
  if (!many) return;
  scene->collision_count = 0;
  strut_name_map_free(&read->names);
  if (!strut_reserve_things(reader, STRUT_THING_COLLISION, count)) return;
  for (size_t i = 0; i < count; i++) {
    if (between_of(&source[i])) {
      if (!add_between(reader, &source[i], &given[i], count - i - 1)) reader->failed = true;
      continue;
    }
    strut_collision *kept =
        strut_add_thing(reader, STRUT_THING_COLLISION, source[i].key, given[i].name);
    *kept = given[i];
    read->source[kept - scene->collisions].broken = source[i].broken;
  }
  const char *const everything[2] = {NULL, NULL};
  const strut_collision usual = usual_collision(scene);
  if (all && usual.stiffness > 0.0 && usual.thickness > 0.0)
    replace_collision(reader, &usual, everything, slot->key, slot->key->place, "these are", 0);
}
