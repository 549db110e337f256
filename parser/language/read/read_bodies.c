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

/* The collisions that one stands for, added to `to` (room for all) unless that is NULL; returns how many. */
static size_t add_pairs(strut_reader *reader, const strut_collision *like,
                        const char *const group[2], strut_collision *to) {
  const strut_scene *scene = reader->scene;
  size_t count = 0;
  for (size_t i = 0; i < scene->member_count && count <= MOST_PAIRS; i++)
    for (size_t j = i + 1; j < scene->member_count; j++) {
      bool one = belongs(reader, i, group[0]) && belongs(reader, j, group[1]);
      bool other = belongs(reader, i, group[1]) && belongs(reader, j, group[0]);
      if (!(one || other) || !apart(scene, i, j, like->thickness)) continue;
      if (to) {
        to[count] = *like;
        to[count].name = strut_kept_text(reader, "%s_%s_%s", like->name, scene->members[i].name,
                                         scene->members[j].name);
        to[count].member[0] = (int32_t)i, to[count].member[1] = (int32_t)j;
      }
      count++;
    }
  return count;
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

/* A collision of the file with what it stands for. */
typedef struct body_pairs {
  strut_collision like;
  const strut_tree *key;
  const char *group[2];
  bool many;
  size_t count;
} body_pairs;

static bool find_pairs(strut_reader *reader, const strut_source *source,
                       const strut_collision *collision, body_pairs *pairs) {
  const strut_tree *between =
      source->value ? strut_tree_find(source->value, "between", NULL) : NULL;
  strut_owner owner = {"collision", collision->name};
  *pairs =
      (body_pairs){.like = *collision, .key = source->key, .many = between != NULL, .count = 1};
  if (!between) return true;
  bool list = between->kind == STRUT_TREE_LIST && between->count == 2;
  if (source->broken || (between->kind == STRUT_TREE_LIST && !list))
    return !source->broken &&
           strut_refuse_form(reader, STRUT_KEY_COLLISION_BETWEEN, between, owner);
  for (int k = 0; k < 2; k++)
    if (!read_set(reader,
                  !list ? between
                  : k   ? between->first->next
                        : between->first,
                  owner, &pairs->group[k]))
      return false;
  pairs->count = add_pairs(reader, collision, pairs->group, NULL);
  if (pairs->count <= MOST_PAIRS) return true;
  return strut_report_error(reader, between->place, "%s stands for more than %d pairs of members",
                            strut_owner_text(reader, owner), (int)MOST_PAIRS);
}

/* Puts all pairs in place of the collisions that were read, with their names. */
static void replace_collisions(strut_reader *reader, const body_pairs *pairs, size_t given,
                               size_t total) {
  strut_scene *scene = reader->scene;
  strut_things_read *read = &reader->things[STRUT_THING_COLLISION];
  strut_collision *all = strut_keep_array(reader, total + 1, sizeof *all);
  strut_source *source = strut_scratch_array(reader, total + 1, sizeof *source);
  if (!all || !source) return;
  size_t count = 0;
  for (size_t i = 0; i < given; i++) {
    if (pairs[i].many)
      add_pairs(reader, &pairs[i].like, pairs[i].group, all + count);
    else
      all[count] = pairs[i].like;
    for (size_t k = 0; k < pairs[i].count; k++)
      source[count + k] = (strut_source){pairs[i].key, pairs[i].key->next,
                                         pairs[i].many ? false : read->source[i].broken};
    count += pairs[i].count;
  }
  strut_name_map_free(&read->names);
  strut_reserve_names(reader, &read->names, count);
  for (size_t i = 0; i < count; i++) strut_add_name(reader, &read->names, all[i].name, i);
  scene->collisions = all, scene->collision_count = count;
  read->source = source;
}

void strut_read_bodies(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  const strut_slot *slot = strut_slot_of(&reader->top, STRUT_KEY_SCENE_COLLISIONS);
  bool all = slot->key && slot->state == STRUT_ABSENT;
  size_t given = scene->collision_count + all, total = 0;
  bool many = all;
  if (!given) return;
  body_pairs *pairs = strut_scratch_array(reader, given, sizeof *pairs);
  for (size_t i = 0; pairs && i < scene->collision_count; i++) {
    if (!find_pairs(reader, &reader->things[STRUT_THING_COLLISION].source[i], &scene->collisions[i],
                    &pairs[i])) {
      reader->failed = true;
      pairs[i].count = 0, pairs[i].many = true, pairs[i].group[0] = pairs[i].group[1] = "";
    }
    many = many || pairs[i].many;
    total += pairs[i].count;
  }
  if (!pairs || !many) return;
  if (all) {
    body_pairs *last = &pairs[given - 1];
    *last = (body_pairs){.like = usual_collision(scene), .key = slot->key, .many = true};
    if (last->like.stiffness > 0.0 && last->like.thickness > 0.0)
      last->count = add_pairs(reader, &last->like, last->group, NULL);
    if (last->count > MOST_PAIRS)
      strut_report_error(reader, slot->key->place, "these are more than %d pairs of members",
                         (int)MOST_PAIRS);
    if (last->count > MOST_PAIRS) return;
    total += last->count;
  }
  replace_collisions(reader, pairs, given, total);
}
