/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scene/profile_index.h"

#include <math.h>

#include "engine/base/range_tree.h"

enum { DIRECTIONS = 4 };

static strut_vec2 segment_of(const strut_ground *g, size_t k) {
  return strut_vec2_between(g->points[k], g->points[k + 1]);
}

static double cross(strut_vec2 a, strut_vec2 b) { return a.x * b.y - a.y * b.x; }
static double dot(strut_vec2 a, strut_vec2 b) { return a.x * b.x + a.y * b.y; }

strut_stretch strut_profile_stretch(const strut_ground *g, size_t k) {
  bool first = k == 0, last = k + 2 == g->point_count;
  return (strut_stretch){g->points[k], segment_of(g, k), first ? -HUGE_VAL : 0.0,
                         last ? HUGE_VAL : 1.0};
}

/* Lines that are this part of a's length apart are one line. */
static const double ONE_LINE = 1e-9;

double strut_stretches_meet(const strut_stretch *a, const strut_stretch *b) {
  strut_vec2 between = strut_vec2_between(a->from, b->from);
  double area = cross(a->along, b->along);
  double size = strut_vec2_length(a->along) * strut_vec2_length(b->along);
  if (fabs(area) > STRUT_PROFILE_STRAIGHT * size) {
    double s = cross(between, b->along) / area, t = cross(between, a->along) / area;
    bool both = s >= a->low && s <= a->high && t >= b->low && t <= b->high;
    return both ? s : (double)NAN;
  }
  double length = strut_vec2_length(a->along);
  if (fabs(cross(between, a->along)) > ONE_LINE * length * length) return (double)NAN; /* apart */
  double scale = dot(b->along, a->along) / (length * length);
  double at = dot(between, a->along) / (length * length);
  double p = at + scale * b->low, q = at + scale * b->high;
  double low = fmax(a->low, fmin(p, q)), high = fmin(a->high, fmax(p, q));
  return low <= high ? (isfinite(low) ? low : high) : (double)NAN;
}

/* ---- bounds ---- */

/* By how much segment k turns to the left of the one before [rad]. */
static double turn_before(const strut_ground *g, size_t k) {
  strut_vec2 a = segment_of(g, k - 1), b = segment_of(g, k);
  return atan2(cross(a, b), dot(a, b));
}

/* Directions within less than half a turn have one along which all of them advance. */
static bool advances(double least, double most) { return most - least < 0.5 * STRUT_TAU - 1e-9; }

bool strut_profile_is_monotone(const strut_ground *g) {
  double angle = 0.0, least = 0.0, most = 0.0;
  for (size_t k = 1; k + 1 < g->point_count; k++) {
    angle += turn_before(g, k);
    least = fmin(least, angle), most = fmax(most, angle);
  }
  return advances(least, most);
}

static strut_profile_bounds no_bounds(void) {
  strut_profile_bounds b = {.least = HUGE_VAL, .most = -HUGE_VAL};
  for (int d = 0; d < DIRECTIONS; d++) b.low[d] = HUGE_VAL, b.high[d] = -HUGE_VAL;
  return b;
}

static void add_bounds(strut_profile_bounds *to, const strut_profile_bounds *b) {
  for (int d = 0; d < DIRECTIONS; d++) {
    to->low[d] = fmin(to->low[d], b->low[d]);
    to->high[d] = fmax(to->high[d], b->high[d]);
  }
  to->least = fmin(to->least, b->least), to->most = fmax(to->most, b->most);
}

/* With what the test for meeting tolerates. */
static strut_profile_bounds bounds_of(const strut_ground *g, size_t k, double angle) {
  strut_profile_bounds b = no_bounds();
  double size = strut_vec2_length(segment_of(g, k));
  for (int end = 0; end < 2; end++) {
    const double *p = g->points[k + (size_t)end];
    const double value[DIRECTIONS] = {p[0], p[1], p[0] + p[1], p[0] - p[1]};
    double wide = 2.0 * ONE_LINE * size + 1e-15 * (fabs(p[0]) + fabs(p[1]));
    for (int d = 0; d < DIRECTIONS; d++) {
      b.low[d] = fmin(b.low[d], value[d] - wide);
      b.high[d] = fmax(b.high[d], value[d] + wide);
    }
  }
  b.least = b.most = angle;
  return b;
}

/* In the order of the profile, so that the angle adds up. */
static void build(const strut_ground *g, strut_profile_bounds *node, strut_subtree r,
                  double *angle) {
  node[r.at] = no_bounds();
  for (size_t k = r.begin; k < r.end && strut_subtree_is_leaf(r); k++) {
    if (k) *angle += turn_before(g, k);
    strut_profile_bounds own = bounds_of(g, k, *angle);
    add_bounds(&node[r.at], &own);
  }
  for (int i = 0; i < 2 && !strut_subtree_is_leaf(r); i++) {
    strut_subtree part = strut_subtree_child(r, i);
    build(g, node, part, angle);
    add_bounds(&node[r.at], &node[part.at]);
  }
}

static strut_subtree whole(const strut_profile_index *index) {
  return (strut_subtree){0, 0, index->segments};
}

bool strut_profile_index_create(strut_arena *arena, const strut_ground *g,
                                strut_profile_index *index) {
  size_t nodes = strut_subtree_nodes(g->point_count - 1);
  strut_profile_bounds *node = strut_arena_allocate(arena, nodes, sizeof *node);
  double angle = 0.0;
  if (!node) return false;
  *index = (strut_profile_index){g, g->point_count - 1, node};
  build(g, node, whole(index), &angle);
  return true;
}

/* ---- crossings ---- */

typedef struct crossing {
  const strut_profile_index *index;
  bool found;
  size_t segment, other; /* the first found so far */
} crossing;

static void try_pair(crossing *c, size_t other, size_t segment) {
  if (other + 1 >= segment) return;
  if (c->found && (segment > c->segment || (segment == c->segment && other >= c->other))) return;
  strut_stretch a = strut_profile_stretch(c->index->ground, other);
  strut_stretch b = strut_profile_stretch(c->index->ground, segment);
  if (isnan(strut_stretches_meet(&a, &b))) return;
  c->found = true, c->segment = segment, c->other = other;
}

static bool are_apart(const strut_profile_bounds *a, const strut_profile_bounds *b) {
  bool apart = false;
  for (int d = 0; d < DIRECTIONS; d++)
    apart = apart || a->low[d] > b->high[d] || b->low[d] > a->high[d];
  return apart;
}

/* Pairs of a segment of a and a later one of b. */
static void cross_ranges(crossing *c, strut_subtree a, strut_subtree b) {
  const strut_profile_bounds *x = &c->index->node[a.at], *y = &c->index->node[b.at];
  bool one_chain = a.end == b.begin && advances(fmin(x->least, y->least), fmax(x->most, y->most));
  if (one_chain || are_apart(x, y) || (c->found && b.begin > c->segment)) return;
  if (strut_subtree_is_leaf(a) && strut_subtree_is_leaf(b)) {
    for (size_t k = b.begin; k < b.end; k++)
      for (size_t j = a.begin; j < a.end; j++) try_pair(c, j, k);
    return;
  }
  bool divide_b =
      strut_subtree_is_leaf(a) || (!strut_subtree_is_leaf(b) && b.end - b.begin > a.end - a.begin);
  for (int i = 0; i < 2; i++)
    if (divide_b)
      cross_ranges(c, a, strut_subtree_child(b, i));
    else
      cross_ranges(c, strut_subtree_child(a, i), b);
}

static void cross_range(crossing *c, strut_subtree r) {
  const strut_profile_bounds *bounds = &c->index->node[r.at];
  if (advances(bounds->least, bounds->most) || (c->found && r.begin > c->segment)) return;
  if (strut_subtree_is_leaf(r)) {
    for (size_t k = r.begin; k < r.end; k++)
      for (size_t j = r.begin; j < k; j++) try_pair(c, j, k);
    return;
  }
  cross_range(c, strut_subtree_child(r, 0));
  cross_ranges(c, strut_subtree_child(r, 0), strut_subtree_child(r, 1));
  cross_range(c, strut_subtree_child(r, 1));
}

bool strut_profile_find_crossing(const strut_profile_index *index, size_t *segment, size_t *other) {
  crossing c = {.index = index};
  for (size_t k = 2; k < index->segments; k++) try_pair(&c, 0, k);
  cross_range(&c, whole(index));
  for (size_t j = 0; j < index->segments; j++) try_pair(&c, j, index->segments - 1);
  *segment = c.segment, *other = c.other;
  return c.found;
}

/* ---- rays ---- */

typedef struct cast {
  const strut_profile_index *index;
  const strut_stretch *ray;
  size_t at;
  double first;
} cast;

static void try_segment(cast *c, size_t k) {
  if (k == c->at || k + 1 == c->at) return;
  strut_stretch other = strut_profile_stretch(c->index->ground, k);
  double where = strut_stretches_meet(c->ray, &other);
  if (where < c->first) c->first = where;
}

/* Is a box beside the ray, or beyond the first place where that met something? */
static bool misses(const cast *c, const strut_profile_bounds *b) {
  const strut_stretch *ray = c->ray;
  double length = strut_vec2_length(ray->along), half_x = 0.5 * (b->high[0] - b->low[0]),
         half_y = 0.5 * (b->high[1] - b->low[1]);
  strut_vec2 to = {b->low[0] + half_x - ray->from[0], b->low[1] + half_y - ray->from[1]};
  double x = fabs(ray->along.x), y = fabs(ray->along.y), wide = 2.0 * ONE_LINE * length;
  double beside = fabs(cross(to, ray->along)), ahead = dot(to, ray->along);
  double rounding = 1e-13 * (x * (fabs(to.x) + half_x) + y * (fabs(to.y) + half_y));
  if (beside > x * half_y + y * half_x + wide * length + rounding) return true;
  double reach = x * half_x + y * half_y + wide * length + rounding;
  return ahead + reach < 0.0 || ahead - reach > c->first * length * length;
}

static void cast_into(cast *c, strut_subtree r) {
  if (misses(c, &c->index->node[r.at])) return;
  for (size_t k = r.begin; k < r.end && strut_subtree_is_leaf(r); k++) try_segment(c, k);
  bool backward = c->ray->along.x *
                      (c->index->ground->points[r.end][0] - c->index->ground->points[r.begin][0]) <
                  0.0;
  for (int i = 0; i < 2 && !strut_subtree_is_leaf(r); i++)
    cast_into(c, strut_subtree_child(r, backward ? 1 - i : i));
}

double strut_profile_cast_ray(const strut_profile_index *index, const strut_stretch *ray,
                              size_t at) {
  cast c = {index, ray, at, HUGE_VAL};
  try_segment(&c, 0);
  try_segment(&c, index->segments - 1);
  cast_into(&c, whole(index));
  return c.first;
}
