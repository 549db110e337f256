/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scene/profile.h"

#include <math.h>

#include "engine/base/vec.h"
#include "engine/scene/profile_index.h"

static strut_vec2 segment_of(const strut_ground *g, size_t k) {
  return strut_vec2_between(g->points[k], g->points[k + 1]);
}

static double cross(strut_vec2 a, strut_vec2 b) { return a.x * b.y - a.y * b.x; }
static double dot(strut_vec2 a, strut_vec2 b) { return a.x * b.x + a.y * b.y; }

static bool is_concave(const strut_ground *g, size_t point) {
  strut_vec2 a = segment_of(g, point - 1), b = segment_of(g, point);
  return cross(a, b) > STRUT_PROFILE_STRAIGHT * strut_vec2_length(a) * strut_vec2_length(b);
}

size_t strut_ground_pieces(const strut_ground *g) {
  size_t count = 1;
  if (g->shape != STRUT_GROUND_PROFILE) return 1;
  for (size_t k = 1; k + 1 < g->point_count; k++) count += is_concave(g, k);
  return count;
}

size_t strut_profile_piece_end(const strut_ground *g, size_t first) {
  size_t last = first + 1;
  while (last + 1 < g->point_count && !is_concave(g, last)) last++;
  return last;
}

/* Two segments that meet, though no neighbours. */
static strut_profile_fault find_crossing(const strut_ground *g, size_t *segment, size_t *other) {
  strut_arena arena = {0};
  strut_profile_index index;
  strut_profile_fault fault = STRUT_PROFILE_NO_MEMORY;
  if (strut_profile_index_create(&arena, g, &index))
    fault = strut_profile_find_crossing(&index, segment, other) ? STRUT_PROFILE_CROSSES
                                                                : STRUT_PROFILE_FINE;
  strut_arena_free(&arena);
  return fault;
}

strut_profile_fault strut_profile_check(const strut_ground *g, size_t *segment, size_t *other) {
  *segment = *other = 0;
  if (g->point_count < 2) return STRUT_PROFILE_SHORT;
  for (size_t k = 0; k < g->point_count; k++) {
    *segment = k;
    if (!isfinite(g->points[k][0]) || !isfinite(g->points[k][1])) return STRUT_PROFILE_POINT;
  }
  for (size_t k = 0; k + 1 < g->point_count; k++) {
    *segment = k, *other = k ? k - 1 : 0;
    strut_vec2 a = segment_of(g, k);
    if (!(strut_vec2_length(a) > 0.0)) return STRUT_PROFILE_ZERO;
    if (!k) continue;
    strut_vec2 before = segment_of(g, k - 1);
    if (fabs(cross(before, a)) <=
            STRUT_PROFILE_STRAIGHT * strut_vec2_length(before) * strut_vec2_length(a) &&
        dot(before, a) < 0.0)
      return STRUT_PROFILE_BACK;
  }
  return strut_profile_is_monotone(g) ? STRUT_PROFILE_FINE : find_crossing(g, segment, other);
}

double strut_profile_reach(const strut_profile_index *index, size_t at, bool forward) {
  const strut_ground *g = index->ground;
  if (at == 0 || at + 1 == g->point_count) return HUGE_VAL;
  strut_vec2 along = segment_of(g, forward ? at - 1 : at);
  if (!forward) along = (strut_vec2){-along.x, -along.y};
  const strut_stretch ray = {g->points[at], along, 0.0, HUGE_VAL};
  return 0.5 * strut_profile_cast_ray(index, &ray, at) * strut_vec2_length(along);
}

/* The nearest point of the profile decides on which side a point is: near a segment the side of its line,
   near a corner whether that is concave. */
static double profile_depth(const strut_ground *g, const double p[2]) {
  double least = HUGE_VAL, depth = 0.0;
  for (size_t k = 0; k + 1 < g->point_count; k++) {
    strut_stretch s = strut_profile_stretch(g, k);
    strut_vec2 to = strut_vec2_between(s.from, p);
    double length = strut_vec2_length(s.along), at = dot(to, s.along) / (length * length);
    double held = fmax(s.low, fmin(s.high, at));
    strut_vec2 away = {to.x - held * s.along.x, to.y - held * s.along.y};
    double distance = strut_vec2_length(away);
    if (!(distance < least)) continue;
    least = distance;
    bool inside = held == at ? cross(s.along, to) < 0.0 : is_concave(g, held > 0.0 ? k + 1 : k);
    depth = inside ? distance : -distance;
  }
  return depth;
}

double strut_ground_depth(const strut_ground *g, const double p[2]) {
  switch (g->shape) {
    case STRUT_GROUND_PROFILE: return profile_depth(g, p);
    case STRUT_GROUND_CIRCLE: {
      double depth = g->radius - strut_distance(g->centre, p);
      return g->inside ? -depth : depth;
    }
    case STRUT_GROUND_LINE: break;
  }
  double x = g->placed ? p[0] - g->through[0] : p[0];
  double y = p[1] - (g->placed ? g->through[1] : g->height);
  return x * sin(g->slope) - y * cos(g->slope);
}
