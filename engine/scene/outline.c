/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scene/outline.h"

#include <math.h>

#include "engine/base/trig.h"

enum { CIRCLE_PARTS = 96 };

size_t strut_outline_most(const strut_ground *g) {
  switch (g->shape) {
    case STRUT_GROUND_LINE: return 2;
    case STRUT_GROUND_PROFILE: return g->point_count + 2;
    case STRUT_GROUND_CIRCLE: break;
  }
  return CIRCLE_PARTS + 1;
}

static size_t outline_circle(const strut_ground *g, double (*points)[2]) {
  for (int k = 0; k <= CIRCLE_PARTS; k++) {
    double sine, cosine, turns = (double)(k % CIRCLE_PARTS) / CIRCLE_PARTS;
    strut_sincos_turns(g->inside ? turns : -turns, &sine, &cosine);
    points[k][0] = g->centre[0] + g->radius * cosine;
    points[k][1] = g->centre[1] + g->radius * sine;
  }
  return CIRCLE_PARTS + 1;
}

static size_t outline_line(const strut_ground *g, const double middle[2], double far,
                           double (*points)[2]) {
  double along[2] = {cos(g->slope), sin(g->slope)};
  double from[2] = {g->placed ? g->through[0] : 0.0, g->placed ? g->through[1] : g->height};
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

static size_t outline_profile(const strut_ground *g, const double middle[2], double far,
                              double (*points)[2]) {
  size_t n = g->point_count;
  for (size_t k = 0; k < n; k++)
    for (int c = 0; c < 2; c++) points[k + 1][c] = g->points[k][c];
  extend(g->points[0], g->points[1], far + strut_distance(middle, g->points[0]), points[0]);
  extend(g->points[n - 1], g->points[n - 2], far + strut_distance(middle, g->points[n - 1]),
         points[n + 1]);
  return n + 2;
}

size_t strut_outline_of(const strut_ground *g, const double *place, const double middle[2],
                        double far, double (*points)[2]) {
  double own[2] = {middle[0] - (place ? place[0] : 0.0), middle[1] - (place ? place[1] : 0.0)};
  size_t count = g->shape == STRUT_GROUND_LINE      ? outline_line(g, own, far, points)
                 : g->shape == STRUT_GROUND_PROFILE ? outline_profile(g, own, far, points)
                                                    : outline_circle(g, points);
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
