/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scene/profile.h"

#include <math.h>

#include "engine/base/vec.h"

static strut_vec2 segment_of(const strut_ground *g, size_t k) {
  return strut_vec2_between(g->points[k], g->points[k + 1]);
}

static double cross(strut_vec2 a, strut_vec2 b) { return a.x * b.y - a.y * b.x; }
static double dot(strut_vec2 a, strut_vec2 b) { return a.x * b.x + a.y * b.y; }

/* Angles below this are those of one straight line [rad]. */
static const double STRAIGHT = 1e-12;

static bool is_concave(const strut_ground *g, size_t point) {
  strut_vec2 a = segment_of(g, point - 1), b = segment_of(g, point);
  return cross(a, b) > STRAIGHT * strut_vec2_length(a) * strut_vec2_length(b);
}

size_t strut_ground_pieces(const strut_ground *g) {
  size_t count = 1;
  if (g->shape != STRUT_GROUND_PROFILE) return 1;
  for (size_t k = 1; k + 1 < g->point_count; k++) count += is_concave(g, k);
  return count;
}

void strut_profile_piece(const strut_ground *g, size_t piece, size_t *first, size_t *last) {
  *first = 0;
  for (*last = 1; *last + 1 < g->point_count; (*last)++) {
    if (!is_concave(g, *last)) continue;
    if (!piece--) return;
    *first = *last;
  }
}

/* A part of a straight line, from low to high times `along`. */
typedef struct stretch {
  const double *from;
  strut_vec2 along;
  double low, high;
} stretch;

/* Segment k of the profile, with the line beyond its ends. */
static stretch stretch_of(const strut_ground *g, size_t k) {
  bool first = k == 0, last = k + 2 == g->point_count;
  return (stretch){g->points[k], segment_of(g, k), first ? -HUGE_VAL : 0.0, last ? HUGE_VAL : 1.0};
}

/* Where a meets b, in lengths of a; NAN: nowhere. */
static double meet(const stretch *a, const stretch *b) {
  strut_vec2 between = strut_vec2_between(a->from, b->from);
  double area = cross(a->along, b->along);
  double size = strut_vec2_length(a->along) * strut_vec2_length(b->along);
  if (fabs(area) > STRAIGHT * size) {
    double s = cross(between, b->along) / area, t = cross(between, a->along) / area;
    bool both = s >= a->low && s <= a->high && t >= b->low && t <= b->high;
    return both ? s : (double)NAN;
  }
  double length = strut_vec2_length(a->along);
  if (fabs(cross(between, a->along)) > 1e-9 * length * length) return (double)NAN; /* apart */
  double scale = dot(b->along, a->along) / (length * length);
  double at = dot(between, a->along) / (length * length);
  double p = at + scale * b->low, q = at + scale * b->high;
  double low = fmax(a->low, fmin(p, q)), high = fmin(a->high, fmax(p, q));
  return low <= high ? (isfinite(low) ? low : high) : (double)NAN;
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
    if (fabs(cross(before, a)) <= STRAIGHT * strut_vec2_length(before) * strut_vec2_length(a) &&
        dot(before, a) < 0.0)
      return STRUT_PROFILE_BACK;
  }
  for (size_t k = 2; k + 1 < g->point_count; k++)
    for (size_t j = 0; j + 1 < k; j++) {
      stretch a = stretch_of(g, j), b = stretch_of(g, k);
      *segment = k, *other = j;
      if (!isnan(meet(&a, &b))) return STRUT_PROFILE_CROSSES;
    }
  return STRUT_PROFILE_FINE;
}

double strut_profile_reach(const strut_ground *g, size_t at, bool forward) {
  if (at == 0 || at + 1 == g->point_count) return HUGE_VAL;
  strut_vec2 along = segment_of(g, forward ? at - 1 : at);
  if (!forward) along = (strut_vec2){-along.x, -along.y};
  const stretch ray = {g->points[at], along, 0.0, HUGE_VAL};
  double first = HUGE_VAL;
  for (size_t k = 0; k + 1 < g->point_count; k++) {
    stretch other = stretch_of(g, k);
    double where = k == at || k + 1 == at ? (double)NAN : meet(&ray, &other);
    if (where < first) first = where;
  }
  return 0.5 * first * strut_vec2_length(along);
}

/* The nearest point of the profile decides on which side a point is: near a segment the side of its line,
   near a corner whether that is concave. */
static double profile_depth(const strut_ground *g, const double p[2]) {
  double least = HUGE_VAL, depth = 0.0;
  for (size_t k = 0; k + 1 < g->point_count; k++) {
    stretch s = stretch_of(g, k);
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
