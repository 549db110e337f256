/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/equilibria/passages.h"

#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/forces/strains/reach.h"

enum { RODS = 4, PARTS = 16 }; /* elements of two rods; parts of a motion, each all but straight */

static const double DEEP = 0.5; /* of the thickness: axes closer than this are in each other */

static const uint32_t *nodes_of(const strut_model *model, int32_t i) {
  return model->elements.at + model->elements.element[i].first;
}

static bool is_collision(const strut_model *model, int32_t i) {
  return model->elements.element[i].role == STRUT_ELEMENT_COLLISION;
}

static double distance_of(const strut_model *model, int32_t i, const double *q) {
  const uint32_t *at = nodes_of(model, i);
  bool rod = model->elements.element[i].strain == STRUT_STRAIN_REACH;
  return rod ? strut_reach_of(at, q).distance : strut_distance(q + at[0], q + at[1]);
}

/* Twice the area between a rod and a node: its sign is the side of the rod's axis on which the node is. */
static double side_of(const uint32_t *at, const double *q) {
  strut_vec2 rod = strut_vec2_between(q + at[1], q + at[2]);
  strut_vec2 node = strut_vec2_between(q + at[1], q + at[0]);
  return rod.x * node.y - rod.y * node.x;
}

static bool are_opposite(double a, double b) { return (a > 0.0) != (b > 0.0); }

/* Of the first of the four elements of two rods: do these cross? Of any other element: no. */
static bool rods_cross(const strut_model *model, int32_t i, const double *q) {
  const strut_element *e = &model->elements.element[i];
  double side[RODS];
  if (i && is_collision(model, i - 1) && e[-1].item == e->item) return false;
  if (strut_element_end(&model->elements, i) - i != RODS) return false;
  for (int k = 0; k < RODS; k++) side[k] = side_of(nodes_of(model, i + k), q);
  return are_opposite(side[0], side[1]) && are_opposite(side[2], side[3]);
}

int32_t strut_overlap_find(const strut_model *model, const double *q) {
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *e = &model->elements.element[i];
    if (!is_collision(model, i)) continue;
    if (distance_of(model, i, q) < DEEP * e->natural || rods_cross(model, i, q)) return e->item;
  }
  return -1;
}

int32_t strut_crossing_find(const strut_model *model, const double *a, const double *b) {
  for (int32_t i = 0; i < model->elements.count; i++)
    if (is_collision(model, i) && rods_cross(model, i, a) != rods_cross(model, i, b))
      return model->elements.element[i].item;
  return -1;
}

/* The nodes of an element, and these alone, at the share t of the way from a to b. */
static void place_between(const uint32_t *at, int32_t nodes, const double *a, const double *b,
                          double t, double *q, uint32_t *own) {
  for (int32_t k = 0; k < nodes; k++) {
    own[k] = 2 * (uint32_t)k;
    for (uint32_t c = 0; c < 2; c++)
      q[own[k] + c] = a[at[k] + c] + t * (b[at[k] + c] - a[at[k] + c]);
  }
}

/* Does the node pass through the axis of the rod, or past its round end by less than half the thickness? */
static bool passes_rod(const strut_model *model, int32_t i, const double *a, const double *b) {
  const uint32_t *at = nodes_of(model, i);
  uint32_t own[3];
  double q[6], before = side_of(at, a);
  for (int k = 1; k <= PARTS; k++) {
    place_between(at, 3, a, b, (double)k / PARTS, q, own);
    double after = side_of(own, q);
    if (are_opposite(before, after)) {
      place_between(at, 3, a, b, (k - after / (after - before)) / PARTS, q, own);
      if (strut_reach_of(own, q).distance < DEEP * model->elements.element[i].natural) return true;
    }
    before = after;
  }
  return false;
}

/* Does the way of one node past the other come closer than half the thickness? */
static bool passes_node(const strut_model *model, int32_t i, const double *a, const double *b) {
  const uint32_t *at = nodes_of(model, i);
  strut_vec2 from = strut_vec2_between(a + at[0], a + at[1]);
  strut_vec2 to = strut_vec2_between(b + at[0], b + at[1]);
  const double way[4] = {from.x, from.y, to.x, to.y}, origin[2] = {0.0, 0.0};
  double points[6] = {origin[0], origin[1], way[0], way[1], way[2], way[3]};
  const uint32_t own[3] = {0, 2, 4};
  return strut_reach_of(own, points).distance < DEEP * model->elements.element[i].natural;
}

int32_t strut_passage_find(const strut_model *model, const double *a, const double *b) {
  for (int32_t i = 0; i < model->elements.count; i++) {
    if (!is_collision(model, i)) continue;
    bool rod = model->elements.element[i].strain == STRUT_STRAIN_REACH;
    if (rod ? passes_rod(model, i, a, b) : passes_node(model, i, a, b))
      return model->elements.element[i].item;
  }
  return -1;
}

/* A way down, point by point. */
typedef struct way_down {
  const strut_model *model;
  double *last;    /* (length) */
  int32_t through; /* the first collision met, or -1 */
} way_down;

static void follow(void *context, const double *q) {
  way_down *way = context;
  if (way->through < 0) way->through = strut_passage_find(way->model, way->last, q);
  memcpy(way->last, q, (size_t)way->model->length * sizeof *q);
}

strut_status strut_passages_find(const strut_potential *potential, const strut_critical_set *set,
                                 bool merged, const volatile sig_atomic_t *interrupt,
                                 int32_t *through, strut_error *error) {
  const strut_model *model = potential->model;
  size_t length = (size_t)model->length;
  strut_arena scratch = {0};
  way_down way = {model, strut_arena_allocate(&scratch, length, sizeof(double)), -1};
  double *q = strut_arena_allocate(&scratch, length, sizeof *q);
  strut_minimiser *minimiser = NULL;
  strut_status status = way.last && q ? strut_minimiser_create(potential, &minimiser, error)
                                      : strut_no_memory(error, "");
  if (status == STRUT_OK) strut_minimiser_visit(minimiser, follow, &way);
  if (status == STRUT_OK) strut_minimiser_watch(minimiser, interrupt);
  for (size_t i = 0; i < set->count && status == STRUT_OK; i++) {
    const strut_critical_point *p = &set->points[i];
    through[i] = -1;
    for (int k = 0; k < 2 && p->negative == 1 && through[i] < 0; k++) {
      if (p->down[k] < 0) continue;
      memcpy(q, p->q, length * sizeof *q);
      memcpy(way.last, p->q, length * sizeof *q);
      way.through = -1;
      strut_descend_along(minimiser, p->softest, k ? -1.0 : 1.0, q);
      const strut_critical_point *end = &set->points[p->down[k]];
      if (way.through < 0 && merged) way.through = strut_crossing_find(model, q, end->q);
      if (way.through < 0 && !merged && end->label == STRUT_FLOPPY) follow(&way, end->q);
      through[i] = way.through;
    }
  }
  strut_minimiser_free(minimiser);
  strut_arena_free(&scratch);
  return status;
}
