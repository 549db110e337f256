/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances from grounds, by their definitions. */
#include "tests/physics/slow_world.h"
#include "tests/support/check.h"

typedef struct point {
  long double x, y;
} point;

static point point_of(const double *p) { return (point){p[0], p[1]}; }
static point from_to(point a, point b) { return (point){b.x - a.x, b.y - a.y}; }
static long double cross(point a, point b) { return a.x * b.y - a.y * b.x; }
static long double length_of(point a) { return hypotl(a.x, a.y); }

static long double over_line(point through, point along, point p, long double *normal) {
  long double size = length_of(along);
  normal[0] = -along.y / size, normal[1] = along.x / size;
  return (p.x - through.x) * normal[0] + (p.y - through.y) * normal[1];
}

/* Where the ray from `from` along `along` first meets the profile but at the corner itself, as a length. */
static long double way_out(const strut_ground *g, size_t corner, point from, point along) {
  long double first = HUGE_VALL;
  for (size_t k = 0; k + 1 < g->point_count; k++) {
    if (k == corner || k + 1 == corner) continue;
    point a = point_of(g->points[k]), d = from_to(a, point_of(g->points[k + 1]));
    long double area = cross(along, d);
    if (area == 0) continue;
    point to = from_to(from, a);
    long double s = cross(to, d) / area, t = cross(to, along) / area;
    bool on = (t >= 0 || k == 0) && (t <= 1 || k + 2 == g->point_count);
    if (s > 0 && on && s < first) first = s;
  }
  return first * length_of(along);
}

/*
 * A piece of a profile between two corners to the left: the node is inside where it is below all of its
 * segments, and then the nearest of them counts, but not further beyond an end than half the way on which
 * the line is inside the ground.
 */
static long double over_piece(const strut_ground *g, size_t piece, point p, long double *normal) {
  size_t first = 0, last = g->point_count - 1, corners = 0;
  for (size_t k = 1; k + 1 < g->point_count; k++) {
    point in = from_to(point_of(g->points[k - 1]), point_of(g->points[k]));
    point out = from_to(point_of(g->points[k]), point_of(g->points[k + 1]));
    if (cross(in, out) <= 0) continue;
    corners++;
    if (corners == piece) first = k;
    if (corners == piece + 1) last = k;
  }
  assert_true(piece <= corners);
  long double gap = -HUGE_VALL, before = 0, beyond = 0;
  size_t nearest = first;
  for (size_t k = first; k < last; k++) {
    long double n[2];
    point a = point_of(g->points[k]), along = from_to(a, point_of(g->points[k + 1]));
    long double own = over_line(a, along, p, n);
    if (own <= gap) continue;
    long double at = ((p.x - a.x) * along.x + (p.y - a.y) * along.y) / length_of(along);
    gap = own, nearest = k, normal[0] = n[0], normal[1] = n[1];
    before = -at, beyond = at - length_of(along);
  }
  point a = point_of(g->points[first]), b = point_of(g->points[last]);
  point in = from_to(point_of(g->points[first + 1]), a);
  point out = from_to(point_of(g->points[last - 1]), b);
  if (first > 0 && nearest == first && before > 0.5L * way_out(g, first, a, in)) return 1;
  if (last + 1 < g->point_count && nearest + 1 == last && beyond > 0.5L * way_out(g, last, b, out))
    return 1;
  return gap;
}

long double slow_ground_gap(const strut_scene *scene, const strut_contact *contact,
                            const long double *at, long double *normal) {
  bool single = scene->ground.present;
  const strut_ground *g = single ? &scene->ground : &scene->grounds[contact->ground];
  point p = {at[0], at[1]};
  if (!single && g->shape == STRUT_GROUND_PROFILE)
    return over_piece(g, (size_t)contact->piece, p, normal);
  if (!single && g->shape == STRUT_GROUND_CIRCLE) {
    point out = from_to(point_of(g->centre), p);
    long double far = length_of(out), sign = g->inside ? -1 : 1;
    normal[0] = sign * out.x / far, normal[1] = sign * out.y / far;
    return sign * (far - g->radius);
  }
  point through = g->placed ? point_of(g->through) : (point){0, g->height};
  return over_line(through, (point){cosl(g->slope), sinl(g->slope)}, p, normal);
}
