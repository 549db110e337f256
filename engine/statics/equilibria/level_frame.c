/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/equilibria/level_frame.h"

#include <math.h>
#include <string.h>

/* Counterclockwise by the angle of c, s; exactly nothing at 1, 0. */
static void turn(double c, double s, size_t count, double *xy) {
  if (s == 0.0 && c == 1.0) return;
  for (size_t i = 0; i < count; i++, xy += 2) {
    double x = xy[0], y = xy[1];
    xy[0] = c * x - s * y;
    xy[1] = s * x + c * y;
  }
}

void strut_level_frame_to_original(const strut_level_frame *flat, size_t count, double *xy) {
  turn(flat->cosine, flat->sine, count, xy);
}

void strut_level_frame_from_original(const strut_level_frame *flat, size_t count, double *xy) {
  turn(flat->cosine, -flat->sine, count, xy);
}

/* A node that is held in x alone or in y alone has no such support in turned coordinates. */
static int32_t held_askew(const strut_scene *scene) {
  if (!scene->ground.present || scene->ground.slope == 0.0) return -1;
  for (size_t i = 0; i < scene->node_count; i++)
    if (scene->nodes[i].fixed[0] != scene->nodes[i].fixed[1]) return (int32_t)i;
  return -1;
}

static void *copied(strut_arena *arena, const void *from, size_t count, size_t size) {
  void *copy = strut_arena_allocate(arena, count, size);
  if (copy && count) memcpy(copy, from, count * size);
  return copy;
}

static bool copy_arrays(strut_level_frame *flat) {
  strut_scene *s = &flat->scene;
  s->nodes = copied(&flat->arena, s->nodes, s->node_count, sizeof *s->nodes);
  s->members = copied(&flat->arena, s->members, s->member_count, sizeof *s->members);
  s->contacts = copied(&flat->arena, s->contacts, s->contact_count, sizeof *s->contacts);
  s->loads = copied(&flat->arena, s->loads, s->load_count, sizeof *s->loads);
  s->configurations =
      copied(&flat->arena, s->configurations, s->configuration_count, sizeof *s->configurations);
  if (!s->nodes || !s->members || !s->contacts || !s->loads || !s->configurations) return false;
  for (size_t i = 0; i < s->configuration_count; i++) {
    strut_configuration *c = &s->configurations[i];
    if (c->position)
      c->position = copied(&flat->arena, c->position, s->node_count, sizeof *c->position);
    if (c->shaped && !c->position) return false;
  }
  return true;
}

/* Rest lengths as resolved in the original, so that turning changes no bit of them. */
static void keep_rest_lengths(const strut_scene *original, strut_scene *s) {
  for (size_t j = 0; j < s->member_count; j++) {
    strut_rest rest;
    if (!strut_member_rest(original, j, &rest)) continue;
    s->members[j].rest_kind = STRUT_REST_LENGTH;
    s->members[j].rest_value = rest.length;
    s->members[j].stiffness = rest.stiffness;
    s->members[j].axial_stiffness = 0.0;
  }
}

static void quieten(strut_scene *s) {
  size_t kept = 0;
  s->actuator_count = 0;
  s->ground.belt_speed = 0.0;
  for (size_t i = 0; i < s->load_count; i++)
    if (s->loads[i].signal < 0) s->loads[kept++] = s->loads[i];
  s->load_count = kept;
  for (size_t i = 0; i < s->contact_count; i++) s->contacts[i].friction.law = STRUT_FRICTION_NONE;
  for (size_t i = 0; i < s->node_count; i++)
    s->nodes[i].velocity[0] = s->nodes[i].velocity[1] = 0.0;
}

static void level(strut_level_frame *flat) {
  strut_scene *s = &flat->scene;
  if (flat->sine == 0.0) return;
  s->ground.height *= flat->cosine;
  s->ground.slope = 0.0;
  strut_level_frame_from_original(flat, 1, s->gravity);
  for (size_t i = 0; i < s->node_count; i++) {
    strut_level_frame_from_original(flat, 1, s->nodes[i].position);
    strut_level_frame_from_original(flat, 1, s->nodes[i].start);
  }
  for (size_t i = 0; i < s->load_count; i++)
    strut_level_frame_from_original(flat, 1, s->loads[i].force);
  for (size_t i = 0; i < s->configuration_count; i++)
    if (s->configurations[i].position)
      strut_level_frame_from_original(flat, s->node_count, s->configurations[i].position[0]);
}

strut_status strut_level_frame_create(const strut_scene *original, strut_level_frame *flat,
                                      strut_error *error) {
  *flat = (strut_level_frame){.scene = *original, .cosine = 1.0, .askew = held_askew(original)};
  flat->scene.arena = (strut_arena){0};
  if (!copy_arrays(flat)) {
    strut_level_frame_free(flat);
    return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  }
  if (original->ground.present && flat->askew < 0 && original->ground.slope != 0.0) {
    flat->cosine = cos(original->ground.slope);
    flat->sine = sin(original->ground.slope);
  }
  keep_rest_lengths(original, &flat->scene);
  quieten(&flat->scene);
  level(flat);
  return STRUT_OK;
}

void strut_level_frame_free(strut_level_frame *flat) {
  strut_arena_free(&flat->arena);
  memset(flat, 0, sizeof *flat);
}
