/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about collisions, and overlaps at the start. See check.h. */
#include <math.h>
#include <stdio.h>

#include "engine/base/vec.h"
#include "engine/scene/check_rules.h"

static bool exists(int32_t index, size_t count) { return index >= 0 && (size_t)index < count; }

/* Do two bodies exist, and do both members run straight? */
static bool check_bodies(strut_checker *checker, size_t index, const char *owner) {
  const strut_scene *scene = checker->scene;
  const strut_collision *c = &scene->collisions[index];
  int bodies = 0;
  for (int k = 0; k < 2; k++) {
    bodies += (c->node[k] != -1) + (c->member[k] != -1);
    if ((c->node[k] == -1 || exists(c->node[k], scene->node_count)) &&
        (c->member[k] == -1 || exists(c->member[k], scene->member_count)))
      continue;
    strut_report_finding(checker, STRUT_ON_COLLISION, index, NULL,
                         "%s is of a node or a member that does not exist", owner);
    return false;
  }
  if (bodies != 2 || (c->node[0] == -1 && c->node[1] != -1) ||
      (c->member[0] == -1 && c->member[1] != -1)) {
    strut_report_finding(checker, STRUT_ON_COLLISION, index, NULL,
                         "%s must be of two nodes, of two members, or of a node and a member",
                         owner);
    return false;
  }
  for (int k = 0; k < 2; k++) {
    if (c->member[k] < 0 || !scene->members[c->member[k]].guide_count) continue;
    strut_report_finding(checker, STRUT_ON_COLLISION, index, k ? "members" : "member",
                         "%s is of member '%s', which runs over guides; only straight members "
                         "collide",
                         owner, scene->members[c->member[k]].name);
    return false;
  }
  return true;
}

/* The node that both bodies have, or -1. */
static int32_t shared_node(const strut_scene *scene, const strut_collision *c) {
  int32_t ends[2][2];
  for (int k = 0; k < 2; k++) {
    int32_t body = k == 0 && c->node[0] < 0 ? 0 : k == 1 && c->node[0] < 0 ? 1 : -1;
    int32_t member = body >= 0 ? c->member[body] : k == 1 ? c->member[0] : -1;
    int32_t node = member >= 0 ? -1 : c->node[k];
    for (int e = 0; e < 2; e++) ends[k][e] = member >= 0 ? scene->members[member].node[e] : node;
  }
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++)
      if (ends[0][i] == ends[1][j]) return ends[0][i];
  return -1;
}

void strut_check_collisions(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->collision_count; i++) {
    const strut_collision *c = &scene->collisions[i];
    char owner[200];
    strut_format_name(owner, "collision", c->name, i);
    const strut_checked whose = {STRUT_ON_COLLISION, i, owner, NULL};
    strut_check_fields(checker, &whose, STRUT_FIELDS_COLLISION, c, NULL);
    if (!check_bodies(checker, i, owner)) continue;
    int32_t shared = shared_node(scene, c);
    bool ends =
        c->member[0] < 0 || (exists(scene->members[c->member[0]].node[0], scene->node_count) &&
                             exists(scene->members[c->member[0]].node[1], scene->node_count));
    if (shared < 0 || !ends) continue;
    const char *key = c->node[1] >= 0 ? "nodes" : c->member[1] >= 0 ? "members" : "node";
    const char *name = scene->nodes[shared].name;
    if (c->node[1] >= 0)
      strut_report_finding(checker, STRUT_ON_COLLISION, i, key,
                           "%s names node '%s' twice, expected two different nodes", owner, name);
    else if (c->member[1] >= 0)
      strut_report_finding(checker, STRUT_ON_COLLISION, i, key,
                           "%s is of members that share node '%s' and so always touch", owner,
                           name);
    else
      strut_report_finding(checker, STRUT_ON_COLLISION, i, key,
                           "%s is of node '%s' and a member that ends there, so they always touch",
                           owner, name);
  }
}

static double distance_to_segment(const double p[2], const double a[2], const double b[2]) {
  double wx = b[0] - a[0], wy = b[1] - a[1], w2 = wx * wx + wy * wy;
  double s = w2 > 0.0 ? ((p[0] - a[0]) * wx + (p[1] - a[1]) * wy) / w2 : 0.0;
  s = fmin(fmax(s, 0.0), 1.0);
  return hypot(p[0] - a[0] - s * wx, p[1] - a[1] - s * wy);
}

/* Least distance of the two axes at the start. */
static double start_distance(const strut_scene *scene, const strut_collision *c) {
  const double *node[2] = {NULL, NULL};
  const double *end[2][2] = {{NULL, NULL}, {NULL, NULL}};
  for (int k = 0; k < 2; k++) {
    if (c->node[k] >= 0) node[k] = scene->nodes[c->node[k]].start;
    for (int e = 0; e < 2 && c->member[k] >= 0; e++)
      end[k][e] = scene->nodes[scene->members[c->member[k]].node[e]].start;
  }
  if (node[1]) return strut_distance(node[0], node[1]);
  if (node[0]) return distance_to_segment(node[0], end[0][0], end[0][1]);
  double least = HUGE_VAL;
  for (int k = 0; k < 2; k++)
    for (int e = 0; e < 2; e++)
      least = fmin(least, distance_to_segment(end[k][e], end[1 - k][0], end[1 - k][1]));
  return least;
}

void strut_warn_of_overlaps(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const double rounding = 1e-9;
  size_t count = 0, first = 0;
  double depth = 0.0;
  for (size_t i = 0; i < scene->collision_count; i++) {
    const strut_collision *c = &scene->collisions[i];
    double overlap = c->thickness - start_distance(scene, c);
    if (!(overlap > rounding * c->thickness)) continue;
    if (!count++) first = i, depth = overlap;
  }
  char more[40] = "";
  if (count > 1) snprintf(more, sizeof more, "; the same of %zu more", count - 1);
  if (count)
    strut_report_finding(checker, STRUT_ON_COLLISION, first, "overlap",
                         "collision '%s' starts with an overlap of %.3g m, so that its two sides "
                         "are pushed apart; move them, or reduce the thickness%s",
                         scene->collisions[first].name, depth, more);
}
