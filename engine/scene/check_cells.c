/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about cells. See check.h. */
#include <math.h>

#include "engine/base/vec.h"
#include "engine/scene/check_rules.h"

/* An area this small beside that of a square of the same circumference is none. */
static const double THIN = 1e-9;

/* Do the corners exist, each but once? */
static bool check_corners(strut_checker *checker, size_t index, const char *owner) {
  const strut_scene *scene = checker->scene;
  const strut_cell *c = &scene->cells[index];
  if (c->node_count < 3 || c->node_count > STRUT_MOST_ELEMENT_NODES) {
    strut_report_finding(checker, STRUT_ON_CELL, index, "nodes",
                         "%s has %zu nodes, expected 3 to %d", owner, c->node_count,
                         STRUT_MOST_ELEMENT_NODES);
    return false;
  }
  for (size_t k = 0; k < c->node_count; k++) {
    if (c->node[k] < 0 || (size_t)c->node[k] >= scene->node_count) {
      strut_report_finding(checker, STRUT_ON_CELL, index, "nodes",
                           "%s has a node that does not exist", owner);
      return false;
    }
    for (size_t i = 0; i < k; i++)
      if (c->node[i] == c->node[k]) {
        strut_report_finding(checker, STRUT_ON_CELL, index, "nodes",
                             "%s names node '%s' twice, expected each corner once", owner,
                             scene->nodes[c->node[k]].name);
        return false;
      }
  }
  return true;
}

typedef struct polygon {
  size_t count;
  double corner[STRUT_MOST_ELEMENT_NODES][2];
} polygon;

static polygon polygon_of(const strut_scene *scene, const strut_cell *c, bool start) {
  polygon p = {.count = c->node_count};
  for (size_t k = 0; k < c->node_count; k++) {
    const strut_node *node = &scene->nodes[c->node[k]];
    for (int d = 0; d < 2; d++) p.corner[k][d] = start ? node->start[d] : node->position[d];
  }
  return p;
}

/* Twice the area of the triangle a, b, c. */
static double turn_of(const double a[2], const double b[2], const double c[2]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
}

static double area_of(const polygon *p) {
  double twice = 0.0;
  for (size_t k = 1; k + 1 < p->count; k++)
    twice += turn_of(p->corner[0], p->corner[k], p->corner[k + 1]);
  return 0.5 * twice;
}

static double circumference_of(const polygon *p) {
  double sum = 0.0;
  for (size_t k = 0; k < p->count; k++)
    sum += strut_distance(p->corner[k], p->corner[(k + 1) % p->count]);
  return sum;
}

static bool cross(const double *a, const double *b, const double *c, const double *d) {
  return turn_of(a, b, c) * turn_of(a, b, d) < 0.0 && turn_of(c, d, a) * turn_of(c, d, b) < 0.0;
}

/* The first side that crosses a later one, which goes to *other; or the number of sides. */
static size_t crossing_side(const polygon *p, size_t *other) {
  for (size_t i = 0; i < p->count; i++)
    for (size_t j = i + 2; j < p->count; j++) {
      if ((j + 1) % p->count == i) continue;
      *other = j;
      if (cross(p->corner[i], p->corner[(i + 1) % p->count], p->corner[j],
                p->corner[(j + 1) % p->count]))
        return i;
    }
  return p->count;
}

/* An area as drawn, without crossing sides, and one of the same sense at the start. */
static void check_area(strut_checker *checker, size_t index, const char *owner) {
  const strut_scene *scene = checker->scene;
  const strut_cell *c = &scene->cells[index];
  polygon drawn = polygon_of(scene, c, false), start = polygon_of(scene, c, true);
  double area = area_of(&drawn), circumference = circumference_of(&drawn);
  size_t n = c->node_count, j = 0, i = crossing_side(&drawn, &j);
  if (!isfinite(area) || !isfinite(area_of(&start))) return; /* reported at the node */
  if (i < n)
    strut_report_finding(
        checker, STRUT_ON_CELL, index, "nodes",
        "the sides '%s'-'%s' and '%s'-'%s' of %s cross, expected corners in order around the cell",
        scene->nodes[c->node[i]].name, scene->nodes[c->node[(i + 1) % n]].name,
        scene->nodes[c->node[j]].name, scene->nodes[c->node[(j + 1) % n]].name, owner);
  else if (!(fabs(area) > THIN * circumference * circumference / 16.0))
    strut_report_finding(checker, STRUT_ON_CELL, index, "nodes", "%s is drawn without an area",
                         owner);
  else if (!(area_of(&start) / area > STRUT_CELL_COLLAPSED))
    strut_report_finding(checker, STRUT_ON_CELL, index, "nodes",
                         "%s starts without an area, or turned over beside how it is drawn", owner);
}

void strut_check_cells(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->cell_count; i++) {
    const strut_cell *c = &scene->cells[i];
    bool gas = c->law != STRUT_LAW_PRESSURE;
    char owner[200];
    strut_format_name(owner, "cell", c->name, i);
    if ((unsigned)c->law >= STRUT_LAW_COUNT || !strut_law_is_of_cells(c->law))
      strut_report_finding(checker, STRUT_ON_CELL, i, "gas", "%s has a law that is not for cells",
                           owner);
    const strut_checked whose = {STRUT_ON_CELL, i, owner, NULL};
    bool fine = strut_check_fields(checker, &whose, gas ? STRUT_FIELDS_GAS : STRUT_FIELDS_CELL, c,
                                   strut_thing_at(STRUT_THING_CELL)->usual);
    if (fine && c->law == STRUT_LAW_ISENTROPIC && !(c->exponent > 1.0))
      strut_report_finding(checker, STRUT_ON_CELL, i, "exponent",
                           "the exponent of %s must be above 1, found %g", owner, c->exponent);
    if (check_corners(checker, i, owner)) check_area(checker, i, owner);
  }
}
