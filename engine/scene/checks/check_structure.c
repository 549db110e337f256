/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about laws, hinges, cells, collisions and distances. See check.h. */
#include <math.h>
#include <stdio.h>

#include "engine/base/vec.h"
#include "engine/scene/checks/check_rules.h"
#include "engine/scene/law.h"

/* ---- laws, stops and hinges ---- */

/* Methods with events number the pieces of a law by 16 bits. */
enum { MOST_POINTS = 30000 };

/* What is wrong with the lists of a law, or NULL. */
static const char *fault_of_lists(const strut_law *law) {
  bool points = strut_law_allows(law->kind, STRUT_LAW_PARAMETER_POINTS);
  for (size_t i = 0; i < law->count; i++)
    if (!isfinite(law->force[i]) || (points && !isfinite(law->x[i])))
      return "has a number that is not finite";
  if (strut_law_needs(law->kind, STRUT_LAW_PARAMETER_COEFFICIENTS) && !law->count)
    return "needs at least one coefficient";
  if (points && law->count < 2) return "needs at least two points";
  bool zero = law->count > 0;
  for (size_t i = 0; i < law->count; i++) zero = zero && law->force[i] == 0.0;
  if (zero) return "gives no force anywhere; leave it out, or give it a number that is not 0";
  const char *fault = points ? strut_curve_fault(law) : NULL;
  if (!fault && points && strut_curve_room(law) > 2 * MOST_POINTS)
    return "has more than 30000 points, those of its rounded corners included";
  return fault;
}

static bool check_law_numbers(strut_checker *checker, const strut_law *law) {
  bool unknown = (unsigned)law->kind >= STRUT_LAW_COUNT || law->kind == STRUT_LAW_AXIAL;
  const char *fault = unknown                            ? "is of an unknown kind"
                      : strut_law_is_of_cells(law->kind) ? "is for cells only"
                      : (unsigned)law->carries > STRUT_CARRIES_COMPRESSION
                          ? "carries an unknown sign"
                          : fault_of_lists(law);
  if (fault) return strut_fault_of(checker, "law", "the law of %s %s", checker->owner, fault);
  bool valid = true;
  for (int p = 0; p < STRUT_LAW_NUMBER_COUNT; p++) {
    const strut_law_parameter *row = strut_law_parameter_at(p);
    double value = strut_law_value(law, p);
    bool positive = strut_law_needs(law->kind, p) && row->above_zero;
    if (isfinite(value) && (!positive || value > 0.0)) continue;
    valid = strut_fault_of(checker, "law", "the law of %s needs a %s%s", checker->owner, row->key,
                           row->above_zero ? " above zero" : "");
  }
  return valid;
}

/* Is the law valid, and the stiffness given where and only where the law does not bring its own? */
static bool check_law(strut_checker *checker, const strut_law *law, bool stiffness) {
  if (!check_law_numbers(checker, law)) return false;
  if (stiffness && strut_law_at(law->kind)->own)
    return strut_fault(checker, "stiffness", "gives a stiffness beside its law, which has its own");
  if (!stiffness && !strut_law_at(law->kind)->own && law->kind != STRUT_LAW_LINEAR)
    return strut_fault_of(checker, "law", "the law %s of %s needs a stiffness",
                          strut_law_at(law->kind)->word, checker->owner);
  return true;
}

/* Does the second slope of an elastic-plastic law lie between 0 and the first? `stiffness`: the first. */
static bool check_hardening(strut_checker *checker, const strut_law *law, double stiffness) {
  if (law->kind != STRUT_LAW_ELASTIC_PLASTIC) return true;
  if (law->second_stiffness >= 0.0 && law->second_stiffness < stiffness) return true;
  return strut_fault_of(checker, "law",
                        "the second_stiffness of %s must be at least 0 and below its stiffness, "
                        "found %g beside %g",
                        checker->owner, law->second_stiffness, stiffness);
}

static bool check_end_of_member(strut_checker *checker) {
  const strut_member *member = &checker->scene->members[checker->index];
  bool rigid = member->kind == STRUT_BAR && checker->scene->bar_model == STRUT_BARS_RIGID;
  const char *key = member->breaks_at > 0.0 ? "breaks_at" : "released_at";
  if (strut_member_ends(member) && rigid)
    return strut_fault(checker, key,
                       "is a rigid bar, which cannot break or be released; make the member a "
                       "spring, or bars: elastic");
  if (member->breaks_at > 0.0 && member->law.carries == STRUT_CARRIES_COMPRESSION)
    return strut_fault(checker, key, "carries compression only, so that no tension breaks it");
  return true;
}

static bool check_guide_friction(strut_checker *checker, double length) {
  const strut_member *member = &checker->scene->members[checker->index];
  const char *fault = member->guide_friction == 0.0 ? NULL
                      : !member->guide_count        ? "has guide_friction, but runs over no guides"
                      : member->law.kind != STRUT_LAW_LINEAR || member->kind != STRUT_CABLE
                          ? "has guide_friction; only linear cables may rub"
                      : !(length > 0.0) ? "has guide_friction, which needs a rest length above zero"
                                        : NULL;
  if (fault) strut_fault(checker, "guide_friction", "%s", fault);
  return !fault;
}

/* Circles about guides: each on a side of the cable, away from the points before and behind it. */
static bool check_guide_radius(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_member *member = &scene->members[checker->index];
  const char *fault = member->guide_radius == 0.0 ? NULL
                      : !member->guide_count      ? "has guide_radius, but runs over no guides"
                      : member->guide_friction > 0.0
                          ? "has guide_radius and guide_friction; only guides "
                            "that are points rub"
                          : NULL;
  if (fault) strut_fault(checker, "guide_radius", "%s", fault);
  bool circles = member->guide_radius > 0.0 && !fault && !checker->loose[checker->index];
  for (size_t k = 1; k <= member->guide_count && circles; k++) {
    if (member->guide_side != STRUT_GUIDE_AS_DRAWN ||
        !strut_member_is_straight_at(scene, member, k))
      continue;
    return strut_fault(checker, "guide_radius",
                       "is drawn straight over '%s': say by guide_side on which side of it its "
                       "guides are",
                       scene->nodes[strut_member_node(member, k)].name);
  }
  for (size_t k = 0; k <= member->guide_count && circles; k++) {
    int32_t a = strut_member_node(member, k), b = strut_member_node(member, k + 1);
    double across =
        (k > 0) + (k < member->guide_count) == 2 && member->guide_side == STRUT_GUIDE_AS_DRAWN
            ? 2.0 * member->guide_radius
            : member->guide_radius;
    if (strut_distance(scene->nodes[a].position, scene->nodes[b].position) > across) continue;
    return strut_fault_of(checker, "guide_radius",
                          "nodes '%s' and '%s' of %s are too close for guides with this radius",
                          scene->nodes[a].name, scene->nodes[b].name, checker->owner);
  }
  return !fault;
}

static bool check_stops(strut_checker *checker) {
  const strut_member *member = &checker->scene->members[checker->index];
  bool stops = member->shortest > 0.0 || member->longest > 0.0;
  bool stiff = member->stop_stiffness > 0.0 || member->stiffness > 0.0 ||
               member->axial_stiffness > 0.0 || strut_law_at(member->law.kind)->own;
  if (member->longest > 0.0 && member->shortest >= member->longest)
    return strut_fault_of(checker, "longest",
                          "the longest of %s, %g m, must be above its shortest, %g m",
                          checker->owner, member->longest, member->shortest);
  if (!stops && (member->stop_stiffness > 0.0 || member->stop_damping > 0.0))
    return strut_fault(checker, member->stop_stiffness > 0.0 ? "stop_stiffness" : "stop_damping",
                       "describes stops, but has neither a shortest nor a longest");
  if (stops && !stiff)
    return strut_fault_of(checker, "stop_stiffness", "the stops of %s need a stop_stiffness",
                          checker->owner);
  return true;
}

bool strut_check_member_law(strut_checker *checker) {
  const strut_member *member = &checker->scene->members[checker->index];
  bool stiffness = member->stiffness > 0.0 || member->axial_stiffness > 0.0;
  if (!check_law(checker, &member->law, stiffness)) return false;
  if (member->kind == STRUT_CABLE && member->law.carries == STRUT_CARRIES_COMPRESSION)
    return strut_fault(checker, "law", "is a cable, which cannot carry compression");
  if (member->law.kind == STRUT_LAW_LOGARITHMIC && member->rest_value <= 0.0)
    return strut_fault_of(
        checker, "law", "the law logarithmic of %s needs a rest length above zero", checker->owner);
  strut_rest rest;
  bool known =
      !checker->loose[checker->index] && strut_member_rest(checker->scene, checker->index, &rest);
  double slope = known ? rest.stiffness : HUGE_VAL;
  if (!check_guide_friction(checker, known ? rest.length : 1.0) || !check_guide_radius(checker))
    return false;
  return check_hardening(checker, &member->law, slope) && check_end_of_member(checker) &&
         check_stops(checker);
}

static bool check_nodes(strut_checker *checker, const char *key, const int32_t *node, size_t count,
                        const char *expected) {
  const strut_scene *scene = checker->scene;
  for (size_t k = 0; k < count; k++) {
    if (!strut_exists(node[k], scene->node_count))
      return strut_fault(checker, key, "names a node that does not exist");
    for (size_t i = 0; i < k; i++)
      if (node[i] == node[k])
        return strut_fault(checker, key, "names node '%s' twice, expected %s",
                           scene->nodes[node[k]].name, expected);
  }
  return true;
}

bool strut_check_apart(strut_checker *checker, const char *key, int32_t first, int32_t second,
                       const char *what) {
  const strut_node *node = &checker->scene->nodes[first], *b = &checker->scene->nodes[second];
  bool drawn = strut_distance(node->position, b->position) == 0.0;
  if (!drawn && strut_distance(node->start, b->start) != 0.0) return true;
  return strut_fault_of(checker, key,
                        "nodes '%s' and '%s' %s in one place, so %s%s has no direction", node->name,
                        b->name, drawn ? "are drawn" : "start", what, checker->owner);
}

static bool check_arms(strut_checker *checker) {
  const int32_t *node = checker->scene->hinges[checker->index].node;
  return check_nodes(checker, "nodes", node, 3, "three different nodes") &&
         strut_check_apart(checker, "nodes", node[1], node[0], "an arm of ") &&
         strut_check_apart(checker, "nodes", node[1], node[2], "an arm of ");
}

void strut_check_hinges(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->hinge_count; i++) {
    const strut_hinge *hinge = &scene->hinges[i];
    strut_check_begin(checker, STRUT_THING_HINGE, i);
    bool valid = strut_check_thing(checker) &&
                 check_law(checker, &hinge->law, hinge->stiffness > 0.0) &&
                 check_hardening(checker, &hinge->law, hinge->stiffness);
    if (valid && hinge->law.kind == STRUT_LAW_LOGARITHMIC)
      strut_fault_of(checker, "law", "the law logarithmic is for members, not for %s",
                     checker->owner);
    else if (valid && hinge->stiffness == 0.0 && hinge->damping == 0.0 &&
             !strut_law_at(hinge->law.kind)->own && !strut_is_pulled(scene, -1, (int32_t)i))
      strut_fault(checker, NULL, "has neither stiffness nor damping, so it does nothing");
    check_arms(checker);
  }
}

/* ---- cells ---- */

/* A cell with a smaller share of the area of a square of the same circumference has no area. */
static const double THIN = 1e-9;

static bool check_corners(strut_checker *checker) {
  const strut_cell *cell = &checker->scene->cells[checker->index];
  if (cell->node_count < 3 || cell->node_count > STRUT_MOST_ELEMENT_NODES)
    return strut_fault(checker, "nodes", "has %zu nodes, expected 3 to %d", cell->node_count,
                       STRUT_MOST_ELEMENT_NODES);
  return check_nodes(checker, "nodes", cell->node, cell->node_count, "each corner once");
}

typedef struct polygon {
  size_t count;
  double corner[STRUT_MOST_ELEMENT_NODES][2];
} polygon;

static polygon polygon_of(const strut_scene *scene, const strut_cell *cell, bool start) {
  polygon p = {.count = cell->node_count};
  for (size_t k = 0; k < cell->node_count; k++) {
    const strut_node *node = &scene->nodes[cell->node[k]];
    for (int d = 0; d < 2; d++) p.corner[k][d] = start ? node->start[d] : node->position[d];
  }
  return p;
}

/* Twice the area of the triangle a, b, c. */
static double turn_of(const double a[2], const double b[2], const double c[2]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
}

static double area_of(const polygon *self) {
  double twice = 0.0;
  for (size_t k = 1; k + 1 < self->count; k++)
    twice += turn_of(self->corner[0], self->corner[k], self->corner[k + 1]);
  return 0.5 * twice;
}

static double circumference_of(const polygon *self) {
  double sum = 0.0;
  for (size_t k = 0; k < self->count; k++)
    sum += strut_distance(self->corner[k], self->corner[(k + 1) % self->count]);
  return sum;
}

static bool cross(const double *first, const double *second, const double *c,
                  const double *change) {
  return turn_of(first, second, c) * turn_of(first, second, change) < 0.0 &&
         turn_of(c, change, first) * turn_of(c, change, second) < 0.0;
}

/* The first side that crosses a later one, which goes to *other; or the number of sides. */
static size_t crossing_side(const polygon *self, size_t *other) {
  for (size_t i = 0; i < self->count; i++)
    for (size_t j = i + 2; j < self->count; j++) {
      if ((j + 1) % self->count == i) continue;
      *other = j;
      if (cross(self->corner[i], self->corner[(i + 1) % self->count], self->corner[j],
                self->corner[(j + 1) % self->count]))
        return i;
    }
  return self->count;
}

/* An area as drawn, without crossing sides, and one of the same sense at the start. */
static void check_area(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_cell *cell = &scene->cells[checker->index];
  polygon drawn = polygon_of(scene, cell, false), start = polygon_of(scene, cell, true);
  double area = area_of(&drawn), circumference = circumference_of(&drawn);
  size_t n = cell->node_count, j = 0, i = crossing_side(&drawn, &j);
  if (!isfinite(area) || !isfinite(area_of(&start))) return; /* reported at the node */
  if (i < n)
    strut_fault_of(
        checker, "nodes",
        "the sides '%s'-'%s' and '%s'-'%s' of %s cross, expected corners in order around the cell",
        scene->nodes[cell->node[i]].name, scene->nodes[cell->node[(i + 1) % n]].name,
        scene->nodes[cell->node[j]].name, scene->nodes[cell->node[(j + 1) % n]].name,
        checker->owner);
  else if (!(fabs(area) > THIN * circumference * circumference / 16.0))
    strut_fault(checker, "nodes", "is drawn without an area");
  else if (!(area_of(&start) / area > STRUT_CELL_COLLAPSED))
    strut_fault(checker, "nodes", "starts without an area, or turned over beside how it is drawn");
}

/* Is the law of what is no member valid, and does it do anything? */
static void check_elastic(strut_checker *checker, const strut_law *law, double stiffness,
                          double damping) {
  if (!check_law(checker, law, stiffness > 0.0) || !check_hardening(checker, law, stiffness))
    return;
  if (law->kind == STRUT_LAW_LOGARITHMIC)
    strut_fault(checker, NULL, "has the law logarithmic, which is for members only");
  else if (stiffness == 0.0 && damping == 0.0 && !strut_law_at(law->kind)->own)
    strut_fault(checker, NULL, "has neither stiffness nor damping, so it does nothing");
}

void strut_check_cells(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->cell_count; i++) {
    const strut_cell *cell = &scene->cells[i];
    bool elastic = cell->law == STRUT_LAW_LINEAR, gas = !elastic && cell->law != STRUT_LAW_PRESSURE;
    strut_check_begin(checker, STRUT_THING_CELL, i);
    if ((unsigned)cell->law >= STRUT_LAW_COUNT || !(elastic || strut_law_is_of_cells(cell->law)))
      strut_fault(checker, "gas", "has a law that is not for cells");
    bool fine = strut_check_fields(checker, gas ? STRUT_FIELDS_GAS : STRUT_FIELDS_CELL, cell,
                                   strut_thing_at(STRUT_THING_CELL)->usual);
    if (fine && cell->law == STRUT_LAW_ISENTROPIC && !(cell->exponent > 1.0))
      strut_fault_of(checker, "exponent", "the exponent of %s must be above 1, found %g",
                     checker->owner, cell->exponent);
    if (fine && elastic) check_elastic(checker, &cell->elastic, cell->stiffness, cell->damping);
    if (check_corners(checker)) check_area(checker);
  }
}

/* ---- collisions ---- */

/* Do two bodies exist, and do both members run straight? */
static bool check_bodies(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_collision *collision = &scene->collisions[checker->index];
  int bodies = 0;
  for (int k = 0; k < 2; k++) {
    bodies += (collision->node[k] != -1) + (collision->member[k] != -1);
    if ((collision->node[k] == -1 || strut_exists(collision->node[k], scene->node_count)) &&
        (collision->member[k] == -1 || strut_exists(collision->member[k], scene->member_count)))
      continue;
    return strut_fault(checker, NULL, "is of a node or a member that does not exist");
  }
  if (bodies != 2 || (collision->node[0] == -1 && collision->node[1] != -1) ||
      (collision->member[0] == -1 && collision->member[1] != -1))
    return strut_fault(checker, NULL,
                       "must be of two nodes, of two members, or of a node and a member");
  for (int k = 0; k < 2; k++) {
    if (collision->member[k] < 0 || !scene->members[collision->member[k]].guide_count) continue;
    return strut_fault(checker, k ? "members" : "member",
                       "is of member '%s', which runs over guides; only straight members "
                       "collide",
                       scene->members[collision->member[k]].name);
  }
  return true;
}

/* The node that both bodies have, or -1. */
static int32_t shared_node(const strut_scene *scene, const strut_collision *collision) {
  int32_t ends[2][2];
  for (int k = 0; k < 2; k++) {
    int32_t body = k == 0 && collision->node[0] < 0 ? 0 : k == 1 && collision->node[0] < 0 ? 1 : -1;
    int32_t member = body >= 0 ? collision->member[body] : k == 1 ? collision->member[0] : -1;
    int32_t node = member >= 0 ? -1 : collision->node[k];
    for (int e = 0; e < 2; e++) ends[k][e] = member >= 0 ? scene->members[member].node[e] : node;
  }
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++)
      if (ends[0][i] == ends[1][j]) return ends[0][i];
  return -1;
}

/* Friction of a collision: smooth, or Stribeck's with both further numbers. */
static void check_rubbing(strut_checker *checker) {
  const strut_friction *friction = &checker->scene->collisions[checker->index].friction;
  const strut_friction none = {STRUT_FRICTION_NONE};
  if (friction->mu_kinetic == 0.0 && friction->width == 0.0 && friction->mu_static == 0.0) return;
  checker->within = "friction";
  strut_check_fields(checker, STRUT_FIELDS_RUBBING, friction, &none);
  checker->within = NULL;
}

void strut_check_collisions(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->collision_count; i++) {
    const strut_collision *collision = &scene->collisions[i];
    strut_check_begin(checker, STRUT_THING_COLLISION, i);
    strut_check_fields(checker, STRUT_FIELDS_COLLISION, collision, NULL);
    check_rubbing(checker);
    if (!check_bodies(checker)) continue;
    int32_t shared = shared_node(scene, collision);
    bool ends = collision->member[0] < 0 ||
                (strut_exists(scene->members[collision->member[0]].node[0], scene->node_count) &&
                 strut_exists(scene->members[collision->member[0]].node[1], scene->node_count));
    if (shared < 0 || !ends) continue;
    const char *key = collision->node[1] >= 0     ? "nodes"
                      : collision->member[1] >= 0 ? "members"
                                                  : "node";
    const char *name = scene->nodes[shared].name;
    if (collision->node[1] >= 0)
      strut_fault(checker, key, "names node '%s' twice, expected two different nodes", name);
    else if (collision->member[1] >= 0)
      strut_fault(checker, key, "is of members that share node '%s' and so always touch", name);
    else
      strut_fault(checker, key,
                  "is of node '%s' and a member that ends there, so they always touch", name);
  }
}

/* ---- distances ---- */

static bool check_ends(strut_checker *checker) {
  const strut_distance_spring *spring = &checker->scene->distances[checker->index];
  bool line = spring->line[0] != -1 || spring->line[1] != -1;
  const int32_t node[3] = {spring->node[0], line ? spring->line[0] : spring->node[1],
                           line ? spring->line[1] : -1};
  const char *key = line ? "line" : "nodes";
  return check_nodes(checker, key, node, line ? 3 : 2, "different nodes") &&
         (!line || strut_check_apart(checker, key, node[1], node[2], "the line of "));
}

void strut_check_distances(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->distance_count; i++) {
    const strut_distance_spring *spring = &scene->distances[i];
    strut_check_begin(checker, STRUT_THING_DISTANCE, i);
    if (strut_check_thing(checker) && check_ends(checker))
      check_elastic(checker, &spring->law, spring->stiffness, spring->damping);
  }
}

/* ---- collisions that overlap ---- */

/* Least distance of the two axes at the start. */
static double start_distance(const strut_scene *scene, const strut_collision *collision) {
  const double *node[2] = {NULL, NULL};
  const double *end[2][2] = {{NULL, NULL}, {NULL, NULL}};
  for (int k = 0; k < 2; k++) {
    if (collision->node[k] >= 0) node[k] = scene->nodes[collision->node[k]].start;
    for (int e = 0; e < 2 && collision->member[k] >= 0; e++)
      end[k][e] = scene->nodes[scene->members[collision->member[k]].node[e]].start;
  }
  if (node[1]) return strut_distance(node[0], node[1]);
  if (node[0]) return strut_distance_to_segment(node[0], end[0][0], end[0][1]);
  double least = HUGE_VAL;
  for (int k = 0; k < 2; k++)
    for (int e = 0; e < 2; e++)
      least = fmin(least, strut_distance_to_segment(end[k][e], end[1 - k][0], end[1 - k][1]));
  return least;
}

void strut_warn_of_overlaps(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const double rounding = 1e-9;
  size_t count = 0, first = 0;
  double depth = 0.0;
  for (size_t i = 0; i < scene->collision_count; i++) {
    const strut_collision *collision = &scene->collisions[i];
    double overlap = collision->thickness - start_distance(scene, collision);
    if (!(overlap > rounding * collision->thickness)) continue;
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
