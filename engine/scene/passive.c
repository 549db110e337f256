/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scene/passive.h"

#include <string.h>

bool strut_scene_remove_feedback(strut_scene *scene, strut_arena *arena) {
  bool relaxes = false;
  scene->signal_count = scene->sensor_count = scene->state_count = 0;
  for (size_t i = 0; i < scene->member_count; i++)
    relaxes = relaxes || scene->members[i].maxwell.stiffness > 0.0;
  if (!relaxes) return true;
  strut_member *members = strut_arena_allocate(arena, scene->member_count, sizeof *members);
  if (!members) return false;
  memcpy(members, scene->members, scene->member_count * sizeof *members);
  for (size_t i = 0; i < scene->member_count; i++) members[i].maxwell = (strut_maxwell){0};
  scene->members = members;
  return true;
}
