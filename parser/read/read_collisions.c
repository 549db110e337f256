/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collisions of nodes and members. See reader.h. */
#include "parser/read/reader.h"

static int32_t read_member(strut_reader *reader, const strut_tree *item, const char *key,
                           strut_owner owner) {
  if (strut_slot_of(&reader->top, STRUT_KEY_SCENE_MEMBERS)->state == STRUT_BROKEN) return -1;
  return strut_read_reference(reader, item, key, owner, "member", &reader->member_names,
                              strut_member_name, reader->scene->member_count);
}

/* Two nodes, two members, or a node and a member; false if some are not known. */
static bool read_bodies(strut_reader *reader, strut_fields *fields, strut_owner owner,
                        strut_collision *collision) {
  const strut_slot *node = strut_slot_of(fields, STRUT_KEY_COLLISION_NODE);
  const strut_slot *member = strut_slot_of(fields, STRUT_KEY_COLLISION_MEMBER);
  const strut_slot *nodes = strut_slot_of(fields, STRUT_KEY_COLLISION_NODES);
  const strut_slot *members = strut_slot_of(fields, STRUT_KEY_COLLISION_MEMBERS);
  if (node->state == STRUT_GIVEN && member->state == STRUT_GIVEN) {
    collision->node[0] = strut_read_node(reader, node->value, owner);
    collision->member[0] = read_member(reader, member->value, "member", owner);
    return collision->node[0] >= 0 && collision->member[0] >= 0;
  }
  const strut_slot *pair = nodes->state == STRUT_GIVEN ? nodes : members;
  if (pair->state != STRUT_GIVEN) return false;
  const strut_tree *item = pair->value->first;
  bool known = true;
  for (int k = 0; k < 2; k++, item = item->next) {
    int32_t found = pair == nodes ? strut_read_node(reader, item, owner)
                                  : read_member(reader, item, "members", owner);
    (pair == nodes ? collision->node : collision->member)[k] = found;
    known = known && found >= 0;
  }
  return known;
}

/* Is there one of the three forms? If not, that is reported. */
static bool check_form(strut_reader *reader, strut_fields *fields, strut_owner owner,
                       strut_place place) {
  const strut_slot *node = strut_slot_of(fields, STRUT_KEY_COLLISION_NODE);
  bool member = strut_slot_of(fields, STRUT_KEY_COLLISION_MEMBER)->state != STRUT_ABSENT;
  bool pair = strut_slot_of(fields, STRUT_KEY_COLLISION_NODES)->state != STRUT_ABSENT ||
              strut_slot_of(fields, STRUT_KEY_COLLISION_MEMBERS)->state != STRUT_ABSENT;
  bool alone = node->state != STRUT_ABSENT;
  if (fields->broken || (pair && !alone) || (member && alone && !pair)) return true;
  strut_report_error(reader, alone && pair ? node->key->place : place,
                     "%s %s, expected 'node' and 'member', or 'nodes' with two nodes, or 'members' "
                     "with two members",
                     strut_owner_text(reader, owner),
                     alone && pair ? "names a node beside a pair" : "does not name two things");
  return false;
}

static bool read_collision(strut_reader *reader, const strut_tree *key,
                           strut_collision *collision) {
  strut_owner owner = {"collision", collision->name};
  bool fine = strut_read_name(reader, key, "collision");
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_COLLISION, key->next, owner, &fields);
  strut_require(reader, &fields, owner, key->place);
  fine = check_form(reader, &fields, owner, key->place) && fine;
  if (!fine || !read_bodies(reader, &fields, owner, collision)) {
    reader->ends_unknown = true;
    fine = false;
  }
  strut_store_fields(reader, &fields, &reader->scene->arena, collision, sizeof *collision);
  return fine && !fields.broken;
}

void strut_read_collisions(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_COLLISIONS);
  if (!map) return;
  scene->collisions =
      strut_reader_allocate(reader, &scene->arena, map->count, sizeof *scene->collisions);
  reader->collision_source =
      strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *reader->collision_source);
  if (!scene->collisions || !reader->collision_source) return;
  for (const strut_tree *key = strut_first_entry(reader, map); key;
       key = strut_following_entry(reader, key)) {
    size_t i = strut_next_entry(reader, &scene->collision_count);
    scene->collisions[i] = strut_collision_default();
    scene->collisions[i].name = strut_keep_text(reader, key->text);
    strut_add_name(reader, &reader->collision_names, scene->collisions[i].name, i);
    bool fine = read_collision(reader, key, &scene->collisions[i]);
    reader->collision_source[i] = (strut_source){key, key->next, !fine};
  }
}
