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

/* The first segment that meets one before it, other than its neighbour, and the first of those. */
static bool find_crossing(const strut_ground *ground, size_t *segment, size_t *other) {
  for (*segment = 2; *segment + 1 < ground->point_count; ++*segment) {
    strut_stretch later = strut_profile_stretch(ground, *segment);
    for (*other = 0; *other + 1 < *segment; ++*other) {
      strut_stretch earlier = strut_profile_stretch(ground, *other);
      if (!isnan(strut_stretches_meet(&earlier, &later))) return true;
    }
  }
  return false;
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
  bool crosses = !strut_profile_is_monotone(ground) && find_crossing(ground, segment, other);
  return crosses ? STRUT_PROFILE_CROSSES : STRUT_PROFILE_FINE;
}

/*
 * Where a ray from point `at` first meets another segment than the two there [lengths of ray->along]; INFINITY: nowhere.
 * Along a monotone profile the first segment that it meets is the nearest, or the next one where it meets their corner.
 */
static double cast_ray(const strut_ground *ground, bool monotone, size_t at, bool forward,
                       const strut_stretch *ray) {
  size_t segments = ground->point_count - 1, from = forward ? at : segments - at;
  double first = HUGE_VAL;
  for (size_t n = monotone ? from + 1 : 0, more = 2; n < segments && more; n++) {
    size_t k = forward ? n : segments - 1 - n;
    if (k == at || k + 1 == at) continue;
    strut_stretch other = strut_profile_stretch(ground, k);
    double where = strut_stretches_meet(ray, &other);
    if (where < first) first = where;
    if (monotone && first < HUGE_VAL) more--;
  }
  return first;
}

double strut_profile_reach(const strut_ground *ground, bool monotone, size_t at, bool forward) {
  if (at == 0 || at + 1 == ground->point_count) return HUGE_VAL;
  strut_vec2 along = segment_of(ground, forward ? at - 1 : at);
  if (!forward) along = (strut_vec2){-along.x, -along.y};
  const strut_stretch ray = {ground->points[at], along, 0.0, HUGE_VAL};
  return 0.5 * cast_ray(ground, monotone, at, forward, &ray) * strut_vec2_length(along);
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

/* By how much segment k turns to the left of the one before [rad]. */
static double turn_before(const strut_ground *ground, size_t k) {
  strut_vec2 a = segment_of(ground, k - 1), b = segment_of(ground, k);
  return atan2(cross(a, b), dot(a, b));
}

bool strut_profile_is_monotone(const strut_ground *ground) {
  double angle = 0.0, least = 0.0, most = 0.0;
  for (size_t k = 1; k + 1 < ground->point_count; k++) {
    angle += turn_before(ground, k);
    least = fmin(least, angle), most = fmax(most, angle);
  }
  return most - least < 0.5 * STRUT_TAU - 1e-9; /* within less than half a turn */
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
