/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collisions as YAML. See writer.h. */
#include "parser/write/writer.h"

static void put_names(strut_writer *writer, const char *first, const char *second) {
  strut_put(writer, "[");
  strut_put_name(writer, first);
  strut_put(writer, ", ");
  strut_put_name(writer, second);
  strut_put(writer, "]");
}

static void put_collision_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                                  const void *object) {
  const strut_collision *c = object;
  const strut_scene *scene = writer->scene;
  bool nodes = c->node[1] >= 0, members = c->member[1] >= 0, mixed = !nodes && !members;
  if (key == STRUT_KEY_COLLISION_NODE && mixed) {
    strut_put_key_name(writer, mapping, key);
    strut_put_name(writer, scene->nodes[c->node[0]].name);
  } else if (key == STRUT_KEY_COLLISION_MEMBER && mixed) {
    strut_put_key_name(writer, mapping, key);
    strut_put_name(writer, scene->members[c->member[0]].name);
  } else if (key == STRUT_KEY_COLLISION_NODES && nodes) {
    strut_put_key_name(writer, mapping, key);
    put_names(writer, scene->nodes[c->node[0]].name, scene->nodes[c->node[1]].name);
  } else if (key == STRUT_KEY_COLLISION_MEMBERS && members) {
    strut_put_key_name(writer, mapping, key);
    put_names(writer, scene->members[c->member[0]].name, scene->members[c->member[1]].name);
  }
}

void strut_put_collisions(strut_writer *writer) {
  const strut_scene *scene = writer->scene;
  const strut_collision usual = strut_collision_default();
  if (scene->collision_count) strut_put(writer, "collisions:\n");
  for (size_t i = 0; i < scene->collision_count; i++) {
    strut_mapping mapping = STRUT_MAPPING_INLINE;
    strut_put(writer, "  ");
    strut_put_name(writer, scene->collisions[i].name);
    strut_put(writer, ": {");
    strut_put_fields(writer, &mapping, STRUT_SECTION_COLLISION, &scene->collisions[i], &usual,
                     put_collision_by_hand);
    strut_put(writer, "}\n");
  }
}
