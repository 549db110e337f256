/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The points of two goals that no other point is better than in both. See search_parts.h. */
#include <string.h>

#include "engine/study/search/search_parts.h"

/* Is a at least as good as b in both goals? */
static bool covers(const strut_study_search *search, const strut_search_point *a,
                   const strut_search_point *b) {
  if (search->maximise) return a->objective >= b->objective && a->second >= b->second;
  return a->objective <= b->objective && a->second <= b->second;
}

static bool make_room(strut_search_front *front, strut_arena *arena) {
  if (front->count < front->room) return true;
  size_t room = front->room ? 2 * front->room : 32;
  strut_search_point *points = strut_arena_allocate(arena, room, sizeof *points);
  if (!points) return false;
  if (front->count) memcpy(points, front->points, front->count * sizeof *points);
  front->points = points;
  front->room = room;
  return true;
}

bool strut_search_front_take(const strut_study_search *search, strut_search_front *front,
                             const strut_search_point *point, strut_arena *arena) {
  size_t n = search->variable_count, kept = 0, at = 0;
  for (size_t i = 0; i < front->count; i++)
    if (covers(search, &front->points[i], point)) return true;
  strut_study_value *values = strut_arena_allocate(arena, n, sizeof *values);
  if (!values || !make_room(front, arena)) return false;
  memcpy(values, point->values, n * sizeof *values);
  for (size_t i = 0; i < front->count; i++)
    if (!covers(search, point, &front->points[i])) front->points[kept++] = front->points[i];
  front->count = kept;
  while (at < kept && front->points[at].objective < point->objective) at++;
  if (!make_room(front, arena)) return false;
  memmove(front->points + at + 1, front->points + at, (kept - at) * sizeof *front->points);
  front->points[at] = *point;
  front->points[at].values = values;
  front->count++;
  return true;
}
