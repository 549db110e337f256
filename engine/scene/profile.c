/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Surfaces of grounds: their pieces, crossings and outlines. See profile.h. */
#include "engine/scene/profile.h"

#include <math.h>

#include "engine/base/indices.h"

static strut_vec2 segment_of(const strut_ground *ground, size_t k) {
  return strut_vec2_between(ground->points[k], ground->points[k + 1]);
}

static double cross(strut_vec2 a, strut_vec2 b) { return a.x * b.y - a.y * b.x; }
static double dot(strut_vec2 a, strut_vec2 b) { return a.x * b.x + a.y * b.y; }

static bool is_concave(const strut_ground *ground, size_t point) {
  strut_vec2 a = segment_of(ground, point - 1), b = segment_of(ground, point);
  return cross(a, b) > STRUT_PROFILE_STRAIGHT * strut_vec2_length(a) * strut_vec2_length(b);
}

size_t strut_ground_pieces(const strut_ground *ground) {
  size_t count = 1;
  if (ground->shape != STRUT_GROUND_PROFILE) return 1;
  for (size_t k = 1; k + 1 < ground->point_count; k++) count += is_concave(ground, k);
  return count;
}

size_t strut_profile_piece_end(const strut_ground *ground, size_t first) {
  size_t last = first + 1;
  while (last + 1 < ground->point_count && !is_concave(ground, last)) last++;
  return last;
}

/* Two segments that meet, though no neighbours. */
static strut_profile_fault find_crossing(const strut_ground *ground, size_t *segment,
                                         size_t *other) {
  strut_arena arena = {0};
  strut_profile_index index;
  strut_profile_fault fault = STRUT_PROFILE_NO_MEMORY;
  if (strut_profile_index_create(&arena, ground, &index))
    fault = strut_profile_find_crossing(&index, segment, other) ? STRUT_PROFILE_CROSSES
                                                                : STRUT_PROFILE_FINE;
  strut_arena_free(&arena);
  return fault;
}

strut_profile_fault strut_profile_check(const strut_ground *ground, size_t *segment,
                                        size_t *other) {
  *segment = *other = 0;
  if (ground->point_count < 2) return STRUT_PROFILE_SHORT;
  for (size_t k = 0; k < ground->point_count; k++) {
    *segment = k;
    if (!isfinite(ground->points[k][0]) || !isfinite(ground->points[k][1]))
      return STRUT_PROFILE_POINT;
  }
  for (size_t k = 0; k + 1 < ground->point_count; k++) {
    *segment = k, *other = k ? k - 1 : 0;
    strut_vec2 a = segment_of(ground, k);
    if (!(strut_vec2_length(a) > 0.0)) return STRUT_PROFILE_ZERO;
    if (!k) continue;
    strut_vec2 before = segment_of(ground, k - 1);
    if (fabs(cross(before, a)) <=
            STRUT_PROFILE_STRAIGHT * strut_vec2_length(before) * strut_vec2_length(a) &&
        dot(before, a) < 0.0)
      return STRUT_PROFILE_BACK;
  }
  return strut_profile_is_monotone(ground) ? STRUT_PROFILE_FINE
                                           : find_crossing(ground, segment, other);
}

double strut_profile_reach(const strut_profile_index *index, size_t at, bool forward) {
  const strut_ground *ground = index->ground;
  if (at == 0 || at + 1 == ground->point_count) return HUGE_VAL;
  strut_vec2 along = segment_of(ground, forward ? at - 1 : at);
  if (!forward) along = (strut_vec2){-along.x, -along.y};
  const strut_stretch ray = {ground->points[at], along, 0.0, HUGE_VAL};
  return 0.5 * strut_profile_cast_ray(index, &ray, at) * strut_vec2_length(along);
}

/* The nearest point of the profile decides on which side a point is: near a segment the side of its line,
   near a corner whether that is concave. */
static double profile_depth(const strut_ground *ground, const double p[2]) {
  double least = HUGE_VAL, depth = 0.0;
  for (size_t k = 0; k + 1 < ground->point_count; k++) {
    strut_stretch s = strut_profile_stretch(ground, k);
    strut_vec2 to = strut_vec2_between(s.from, p);
    double length = strut_vec2_length(s.along), at = dot(to, s.along) / (length * length);
    double held = fmax(s.low, fmin(s.high, at));
    strut_vec2 away = {to.x - held * s.along.x, to.y - held * s.along.y};
    double distance = strut_vec2_length(away);
    if (!(distance < least)) continue;
    least = distance;
    bool inside =
        held == at ? cross(s.along, to) < 0.0 : is_concave(ground, held > 0.0 ? k + 1 : k);
    depth = inside ? distance : -distance;
  }
  return depth;
}

double strut_ground_depth(const strut_ground *ground, const double p[2]) {
  switch (ground->shape) {
    case STRUT_GROUND_PROFILE: return profile_depth(ground, p);
    case STRUT_GROUND_CIRCLE: {
      double depth = ground->radius - strut_distance(ground->centre, p);
      return ground->inside ? -depth : depth;
    }
    case STRUT_GROUND_LINE: break;
  }
  double x = ground->placed ? p[0] - ground->through[0] : p[0];
  double y = p[1] - (ground->placed ? ground->through[1] : ground->height);
  return x * sin(ground->slope) - y * cos(ground->slope);
}

/* ---- crossings with a line ---- */

enum { DIRECTIONS = 4 };

strut_stretch strut_profile_stretch(const strut_ground *ground, size_t k) {
  bool first = k == 0, last = k + 2 == ground->point_count;
  return (strut_stretch){ground->points[k], segment_of(ground, k), first ? -HUGE_VAL : 0.0,
                         last ? HUGE_VAL : 1.0};
}

/* Lines that are this part of a's length apart are one line. */
static const double ONE_LINE = 1e-9;

double strut_stretches_meet(const strut_stretch *first, const strut_stretch *second) {
  strut_vec2 between = strut_vec2_between(first->from, second->from);
  double area = cross(first->along, second->along);
  double size = strut_vec2_length(first->along) * strut_vec2_length(second->along);
  if (fabs(area) > STRUT_PROFILE_STRAIGHT * size) {
    double s = cross(between, second->along) / area, t = cross(between, first->along) / area;
    bool both = s >= first->low && s <= first->high && t >= second->low && t <= second->high;
    return both ? s : (double)NAN;
  }
  double length = strut_vec2_length(first->along);
  if (fabs(cross(between, first->along)) > ONE_LINE * length * length) return (double)NAN;
  double scale = dot(second->along, first->along) / (length * length);
  double at = dot(between, first->along) / (length * length);
  double p = at + scale * second->low, q = at + scale * second->high;
  double low = fmax(first->low, fmin(p, q)), high = fmin(first->high, fmax(p, q));
  return low <= high ? (isfinite(low) ? low : high) : (double)NAN;
}

/* ---- bounds ---- */

/* By how much segment k turns to the left of the one before [rad]. */
static double turn_before(const strut_ground *ground, size_t k) {
  strut_vec2 a = segment_of(ground, k - 1), b = segment_of(ground, k);
  return atan2(cross(a, b), dot(a, b));
}

/* Directions within less than half a turn have one along which all of them advance. */
static bool advances(double least, double most) { return most - least < 0.5 * STRUT_TAU - 1e-9; }

bool strut_profile_is_monotone(const strut_ground *ground) {
  double angle = 0.0, least = 0.0, most = 0.0;
  for (size_t k = 1; k + 1 < ground->point_count; k++) {
    angle += turn_before(ground, k);
    least = fmin(least, angle), most = fmax(most, angle);
  }
  return advances(least, most);
}

static strut_profile_bounds no_bounds(void) {
  strut_profile_bounds b = {.least = HUGE_VAL, .most = -HUGE_VAL};
  for (int d = 0; d < DIRECTIONS; d++) b.low[d] = HUGE_VAL, b.high[d] = -HUGE_VAL;
  return b;
}

static void add_bounds(strut_profile_bounds *to, const strut_profile_bounds *bounds) {
  for (int d = 0; d < DIRECTIONS; d++) {
    to->low[d] = fmin(to->low[d], bounds->low[d]);
    to->high[d] = fmax(to->high[d], bounds->high[d]);
  }
  to->least = fmin(to->least, bounds->least), to->most = fmax(to->most, bounds->most);
}

/* With what the test for meeting tolerates. */
static strut_profile_bounds bounds_of(const strut_ground *ground, size_t k, double angle) {
  strut_profile_bounds b = no_bounds();
  double size = strut_vec2_length(segment_of(ground, k));
  for (int end = 0; end < 2; end++) {
    const double *p = ground->points[k + (size_t)end];
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
static void build(const strut_ground *ground, strut_profile_bounds *node, strut_subtree r,
                  double *angle) {
  node[r.at] = no_bounds();
  for (size_t k = r.begin; k < r.end && strut_subtree_is_leaf(r); k++) {
    if (k) *angle += turn_before(ground, k);
    strut_profile_bounds own = bounds_of(ground, k, *angle);
    add_bounds(&node[r.at], &own);
  }
  for (int i = 0; i < 2 && !strut_subtree_is_leaf(r); i++) {
    strut_subtree part = strut_subtree_child(r, i);
    build(ground, node, part, angle);
    add_bounds(&node[r.at], &node[part.at]);
  }
}

static strut_subtree whole(const strut_profile_index *index) {
  return (strut_subtree){0, 0, index->segments};
}

bool strut_profile_index_create(strut_arena *arena, const strut_ground *ground,
                                strut_profile_index *index) {
  size_t nodes = strut_subtree_nodes(ground->point_count - 1);
  strut_profile_bounds *node = strut_arena_allocate(arena, nodes, sizeof *node);
  double angle = 0.0;
  if (!node) return false;
  *index = (strut_profile_index){ground, ground->point_count - 1, node};
  build(ground, node, whole(index), &angle);
  return true;
}

/* ---- crossings ---- */

typedef struct crossing {
  const strut_profile_index *index;
  bool found;
  size_t segment, other; /* the first found so far */
} crossing;

static void try_pair(crossing *self, size_t other, size_t segment) {
  if (other + 1 >= segment) return;
  if (self->found &&
      (segment > self->segment || (segment == self->segment && other >= self->other)))
    return;
  strut_stretch a = strut_profile_stretch(self->index->ground, other);
  strut_stretch b = strut_profile_stretch(self->index->ground, segment);
  if (isnan(strut_stretches_meet(&a, &b))) return;
  self->found = true, self->segment = segment, self->other = other;
}

static bool are_apart(const strut_profile_bounds *first, const strut_profile_bounds *second) {
  bool apart = false;
  for (int d = 0; d < DIRECTIONS; d++)
    apart = apart || first->low[d] > second->high[d] || second->low[d] > first->high[d];
  return apart;
}

/* Pairs of a segment of a and a later one of b. */
static void cross_ranges(crossing *self, strut_subtree a, strut_subtree b) {
  const strut_profile_bounds *bounds = &self->index->node[a.at], *y = &self->index->node[b.at];
  bool one_chain =
      a.end == b.begin && advances(fmin(bounds->least, y->least), fmax(bounds->most, y->most));
  if (one_chain || are_apart(bounds, y) || (self->found && b.begin > self->segment)) return;
  if (strut_subtree_is_leaf(a) && strut_subtree_is_leaf(b)) {
    for (size_t k = b.begin; k < b.end; k++)
      for (size_t j = a.begin; j < a.end; j++) try_pair(self, j, k);
    return;
  }
  bool divide_b =
      strut_subtree_is_leaf(a) || (!strut_subtree_is_leaf(b) && b.end - b.begin > a.end - a.begin);
  for (int i = 0; i < 2; i++)
    if (divide_b)
      cross_ranges(self, a, strut_subtree_child(b, i));
    else
      cross_ranges(self, strut_subtree_child(a, i), b);
}

static void cross_range(crossing *self, strut_subtree r) {
  const strut_profile_bounds *bounds = &self->index->node[r.at];
  if (advances(bounds->least, bounds->most) || (self->found && r.begin > self->segment)) return;
  if (strut_subtree_is_leaf(r)) {
    for (size_t k = r.begin; k < r.end; k++)
      for (size_t j = r.begin; j < k; j++) try_pair(self, j, k);
    return;
  }
  cross_range(self, strut_subtree_child(r, 0));
  cross_ranges(self, strut_subtree_child(r, 0), strut_subtree_child(r, 1));
  cross_range(self, strut_subtree_child(r, 1));
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

static void try_segment(cast *self, size_t k) {
  if (k == self->at || k + 1 == self->at) return;
  strut_stretch other = strut_profile_stretch(self->index->ground, k);
  double where = strut_stretches_meet(self->ray, &other);
  if (where < self->first) self->first = where;
}

/* Is a box beside the ray, or beyond the first place where that met something? */
static bool misses(const cast *self, const strut_profile_bounds *bounds) {
  const strut_stretch *ray = self->ray;
  double length = strut_vec2_length(ray->along), half_x = 0.5 * (bounds->high[0] - bounds->low[0]),
         half_y = 0.5 * (bounds->high[1] - bounds->low[1]);
  strut_vec2 to = {bounds->low[0] + half_x - ray->from[0], bounds->low[1] + half_y - ray->from[1]};
  double x = fabs(ray->along.x), y = fabs(ray->along.y), wide = 2.0 * ONE_LINE * length;
  double beside = fabs(cross(to, ray->along)), ahead = dot(to, ray->along);
  double rounding = 1e-13 * (x * (fabs(to.x) + half_x) + y * (fabs(to.y) + half_y));
  if (beside > x * half_y + y * half_x + wide * length + rounding) return true;
  double reach = x * half_x + y * half_y + wide * length + rounding;
  return ahead + reach < 0.0 || ahead - reach > self->first * length * length;
}

static void cast_into(cast *self, strut_subtree r) {
  if (misses(self, &self->index->node[r.at])) return;
  for (size_t k = r.begin; k < r.end && strut_subtree_is_leaf(r); k++) try_segment(self, k);
  bool backward = self->ray->along.x * (self->index->ground->points[r.end][0] -
                                        self->index->ground->points[r.begin][0]) <
                  0.0;
  for (int i = 0; i < 2 && !strut_subtree_is_leaf(r); i++)
    cast_into(self, strut_subtree_child(r, backward ? 1 - i : i));
}

double strut_profile_cast_ray(const strut_profile_index *index, const strut_stretch *ray,
                              size_t at) {
  cast c = {index, ray, at, HUGE_VAL};
  try_segment(&c, 0);
  try_segment(&c, index->segments - 1);
  cast_into(&c, whole(index));
  return c.first;
}

/* ---- outlines to draw ---- */

enum { CIRCLE_PARTS = 96 };

size_t strut_outline_most(const strut_ground *ground) {
  switch (ground->shape) {
    case STRUT_GROUND_LINE: return 2;
    case STRUT_GROUND_PROFILE: return ground->point_count + 2;
    case STRUT_GROUND_CIRCLE: break;
  }
  return CIRCLE_PARTS + 1;
}

static size_t outline_circle(const strut_ground *ground, double (*points)[2]) {
  for (int k = 0; k <= CIRCLE_PARTS; k++) {
    double sine, cosine, turns = (double)(k % CIRCLE_PARTS) / CIRCLE_PARTS;
    strut_sincos_turns(ground->inside ? turns : -turns, &sine, &cosine);
    points[k][0] = ground->centre[0] + ground->radius * cosine;
    points[k][1] = ground->centre[1] + ground->radius * sine;
  }
  return CIRCLE_PARTS + 1;
}

static size_t outline_line(const strut_ground *ground, const double middle[2], double far,
                           double (*points)[2]) {
  double along[2] = {cos(ground->slope), sin(ground->slope)};
  double from[2] = {ground->placed ? ground->through[0] : 0.0,
                    ground->placed ? ground->through[1] : ground->height};
  double foot = (middle[0] - from[0]) * along[0] + (middle[1] - from[1]) * along[1];
  for (int k = 0; k < 2; k++)
    for (int c = 0; c < 2; c++) points[k][c] = from[c] + (foot + (k ? far : -far)) * along[c];
  return 2;
}

/* The point beyond `end`, away from `next`. */
static void extend(const double *end, const double *next, double by, double point[2]) {
  double length = strut_distance(next, end);
  for (int c = 0; c < 2; c++) point[c] = end[c] + (end[c] - next[c]) / length * by;
}

static size_t outline_profile(const strut_ground *ground, const double middle[2], double far,
                              double (*points)[2]) {
  size_t n = ground->point_count;
  for (size_t k = 0; k < n; k++)
    for (int c = 0; c < 2; c++) points[k + 1][c] = ground->points[k][c];
  extend(ground->points[0], ground->points[1], far + strut_distance(middle, ground->points[0]),
         points[0]);
  extend(ground->points[n - 1], ground->points[n - 2],
         far + strut_distance(middle, ground->points[n - 1]), points[n + 1]);
  return n + 2;
}

size_t strut_outline_of(const strut_ground *ground, const double *place, const double middle[2],
                        double far, double (*points)[2]) {
  double own[2] = {middle[0] - (place ? place[0] : 0.0), middle[1] - (place ? place[1] : 0.0)};
  size_t count = ground->shape == STRUT_GROUND_LINE      ? outline_line(ground, own, far, points)
                 : ground->shape == STRUT_GROUND_PROFILE ? outline_profile(ground, own, far, points)
                                                         : outline_circle(ground, points);
  for (size_t k = 0; k < count && place; k++)
    for (int c = 0; c < 2; c++) points[k][c] += place[c];
  return count;
}

void strut_ground_place(const strut_scene *scene, size_t ground, double t, double place[2]) {
  const strut_ground *g = &scene->grounds[ground];
  for (int c = 0; c < 2; c++) {
    double rate;
    place[c] = 0.0;
    if (g->moves[c]) strut_signal_evaluate(scene->signals, g->motion[c], t, &place[c], &rate);
  }
}
