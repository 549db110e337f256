/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/search/merge.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/model/pose.h"
#include "engine/statics/search/critical.h"

/* Largest factor by which a soft direction may enlarge the distance within which points are one. */
static const double MOST_BLUR = 1000.0;

struct strut_congruent_copy {
  const double *q;
  strut_congruent_copy *next;
};

/* Finds the rigid motions that no support, load or ground forbids. */
static void find_free_motions(strut_stationary_set *g) {
  const strut_potential *p = g->potential;
  const strut_model *model = p->model;
  int32_t fixed[2] = {0, 0}, first = -1;
  bool at_one_node = true, loaded = p->force_scale > 0;
  for (int32_t at = 0; at < 2 * model->node_count; at++) {
    if (p->row_of[at] >= 0) continue;
    fixed[at % 2]++;
    at_one_node = at_one_node && (first < 0 || first == at / 2);
    first = at / 2;
  }
  bool grounded = p->ground && model->contacts.count > 0;
  double net[2] = {0.0, 0.0};
  for (int32_t at = 0; at < 2 * model->node_count; at++) net[at % 2] += p->force[at];
  g->congruent = fixed[0] + fixed[1] <= 3;
  g->shifts[0] =
      fixed[0] == 0 && net[0] == 0 && !(grounded && !strut_contacts_are_level(&model->contacts));
  g->shifts[1] = fixed[1] == 0 && net[1] == 0 && !grounded;
  g->turns = at_one_node && !loaded && !grounded;
}

void strut_stationary_set_start(strut_stationary_set *g, const strut_potential *potential,
                                strut_arena *arena) {
  const strut_model *model = potential->model;
  double size = model->size > 0 ? model->size : 1.0;
  *g = (strut_stationary_set){.potential = potential, .arena = arena};
  g->near = 1e-6 * size;
  g->flat = 1e-15 * strut_stiffest(model) * size * size + 1e-12 * potential->force_scale * size;
  find_free_motions(g);
}

void strut_stationary_set_free(strut_stationary_set *g) {
  strut_release(g->points);
  strut_release(g->placement);
  g->points = NULL, g->placement = NULL, g->count = g->room = 0;
}

/* Largest distance between two placements, up to the free rigid motions. */
static double place_distance(const strut_stationary_set *g, const double *a, const double *b) {
  const strut_model *model = g->potential->model;
  double mean[2] = {0.0, 0.0}, largest = 0.0;
  if (g->turns) return strut_shape_distance(model, a, b, false, NULL);
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    if (g->shifts[at % 2]) mean[at % 2] += (a[at] - b[at]) / model->node_count;
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    largest = fmax(largest, fabs(a[at] - b[at] - mean[at % 2]));
  return largest;
}

static bool same_energy(const strut_stationary_set *g, double a, double b) {
  return fabs(a - b) <= g->flat + 1e-9 * fmin(fabs(a), fabs(b));
}

static bool same_point(const strut_stationary_set *g, const double *q, const double *known,
                       double near) {
  if (place_distance(g, q, known) <= near) return true;
  return g->congruent && strut_shape_distance(g->potential->model, q, known, true, NULL) <= near;
}

/*
 * Close to a fork the softest direction is so soft that a point is known there only to the rounding
 * of the forces over that stiffness: each of two copies to no more than strut_minimise allows.
 */
static double position_blur(const strut_stationary_set *g, const strut_critical_point *point) {
  const strut_potential *p = g->potential;
  double soft = 0.0, last = 0.0;
  for (int32_t skip = 0; skip <= point->zero; skip++) { /* the next larger one, in magnitude */
    soft = HUGE_VAL;
    for (int32_t i = 0; i < point->eigenvalue_count; i++) {
      double size = fabs(point->eigenvalues[i]);
      if (size < soft && (skip == 0 || size > last)) soft = size;
    }
    last = soft;
  }
  double far = 16.0 * sqrt((double)p->n) * strut_potential_rounding(p, point->q) / soft;
  return fmin(far, MOST_BLUR * g->near);
}

static int32_t find_point(const strut_stationary_set *g, const double *q, double energy) {
  for (size_t i = 0; i < g->count; i++)
    if (same_energy(g, energy, g->points[i].potential) && same_point(g, q, g->points[i].q, g->near))
      return (int32_t)i;
  for (size_t i = 0; i < g->count; i++) {
    const strut_critical_point *known = &g->points[i];
    if (fabs(energy - known->potential) > g->flat + 1e-12 * fabs(energy)) continue;
    double near = position_blur(g, known);
    if (near > g->near && same_point(g, q, known->q, near)) return (int32_t)i;
  }
  return -1;
}

int32_t strut_stationary_set_find(const strut_stationary_set *g, const double *q) {
  return find_point(g, q, strut_potential_value(g->potential, q));
}

static bool remember_placement(strut_stationary_set *g, int32_t index, const double *q) {
  strut_congruent_copy **end = &g->placement[index];
  double near = fmax(g->near, position_blur(g, &g->points[index]));
  for (; *end; end = &(*end)->next)
    if (place_distance(g, q, (*end)->q) <= near) return true;
  size_t length = (size_t)g->potential->model->length;
  double *copy = strut_arena_allocate(g->arena, length, sizeof *copy);
  *end = strut_arena_allocate(g->arena, 1, sizeof **end);
  if (!copy || !*end) {
    *end = NULL;
    return false;
  }
  memcpy(copy, q, length * sizeof *q);
  (*end)->q = copy;
  return true;
}

static bool reserve_points(strut_stationary_set *g) {
  if (g->count < g->room) return true;
  size_t room = g->room ? 2 * g->room : 16;
  strut_critical_point *points = strut_reallocate(g->points, room, sizeof *points);
  if (!points) return false;
  g->points = points;
  strut_congruent_copy **placement = strut_reallocate(g->placement, room, sizeof *placement);
  if (!placement) return false;
  g->placement = placement;
  g->room = room;
  return true;
}

static bool is_minimum(const strut_critical_point *point) {
  return point->label == STRUT_STABLE || point->label == STRUT_FLOPPY;
}

/* One of a continuum: some motion that is no rigid one meets no stiffness. */
static bool is_degenerate(const strut_critical_point *point) { return point->zero > point->rigid; }

/* A continuum counts as one point: all of one energy, its ends included. */
static int32_t find_degenerate(const strut_stationary_set *g, const strut_critical_point *point) {
  for (size_t i = 0; i < g->count; i++)
    if ((is_degenerate(point) || is_degenerate(&g->points[i])) &&
        is_minimum(point) == is_minimum(&g->points[i]) &&
        same_energy(g, point->potential, g->points[i].potential))
      return (int32_t)i;
  return -1;
}

static int32_t count_placements(const strut_stationary_set *g, int32_t index) {
  int32_t count = 0;
  for (const strut_congruent_copy *at = g->placement[index]; at; at = at->next) count++;
  return count;
}

/* Replaces the end of a continuum by a point inside it, which represents it better. */
static void make_degenerate(strut_critical_point *known, const strut_critical_point *point) {
  if (is_degenerate(known)) return;
  strut_critical_point before = *known;
  *known = *point;
  known->found = before.found, known->placements = 1;
  known->down[0] = before.down[0], known->down[1] = before.down[1];
}

strut_status strut_stationary_set_add(strut_stationary_set *g, const double *q, int32_t *index,
                                      bool *fresh, strut_error *error) {
  strut_critical_point point;
  *index = strut_stationary_set_find(g, q);
  *fresh = *index < 0;
  if (*fresh) {
    strut_status status = strut_critical_judge(g->potential, q, g->arena, &point, error);
    if (status) return status;
    *index = find_degenerate(g, &point);
    *fresh = *index < 0;
    if (!*fresh && is_degenerate(&point)) make_degenerate(&g->points[*index], &point);
  }
  if (*fresh) {
    if (!reserve_points(g)) return strut_no_memory(error, "");
    *index = (int32_t)g->count++;
    g->placement[*index] = NULL;
    g->points[*index] = point;
    g->points[*index].found = 0;
  }
  strut_critical_point *known = &g->points[*index];
  known->found++;
  if (is_degenerate(known) && !*fresh) return STRUT_OK;
  if (!remember_placement(g, *index, q)) return strut_no_memory(error, "");
  known->placements = count_placements(g, *index);
  return STRUT_OK;
}

const double *strut_stationary_set_placement(const strut_stationary_set *g, int32_t index,
                                             int32_t k) {
  assert(index >= 0 && (size_t)index < g->count);
  assert(k >= 0);
  const strut_congruent_copy *at = g->placement[index];
  while (at && k-- > 0) at = at->next;
  return at ? at->q : NULL;
}

void strut_number_shapes(const strut_stationary_set *like, strut_critical_point *points,
                         size_t count) {
  const strut_model *model = like->potential->model;
  int32_t next = 0;
  for (size_t i = 0; i < count; i++) {
    points[i].shape = -1;
    for (size_t k = 0; k < i && points[i].shape < 0; k++)
      if (same_energy(like, points[i].potential, points[k].potential) &&
          strut_shape_distance(model, points[i].q, points[k].q, true, NULL) <= like->near)
        points[i].shape = points[k].shape;
    if (points[i].shape < 0) points[i].shape = next++;
  }
}

/* Distance of two shapes after the best rigid motion (Procrustes in the plane). */

static void centre_of(const strut_model *model, const double *q, double centre[2]) {
  centre[0] = centre[1] = 0.0;
  for (int32_t at = 0; at < 2 * model->node_count; at++) centre[at % 2] += q[at];
  for (int c = 0; c < 2; c++) centre[c] /= model->node_count;
}

/* b, mirrored in x where `side` is -1, turned and shifted onto a by least squares. */
static double aligned_distance(const strut_model *model, const double *a, const double *b,
                               double side) {
  double p[2], r[2], along = 0.0, across = 0.0, largest = 0.0;
  centre_of(model, a, p);
  centre_of(model, b, r);
  for (int32_t i = 0; i < model->node_count; i++) {
    double ax = a[2 * i] - p[0], ay = a[2 * i + 1] - p[1];
    double bx = side * (b[2 * i] - r[0]), by = b[2 * i + 1] - r[1];
    along += ax * bx + ay * by;
    across += ay * bx - ax * by;
  }
  double size = sqrt(along * along + across * across);
  double c = size > 0 ? along / size : 1.0, s = size > 0 ? across / size : 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    double ax = a[2 * i] - p[0], ay = a[2 * i + 1] - p[1];
    double bx = side * (b[2 * i] - r[0]), by = b[2 * i + 1] - r[1];
    largest = fmax(largest, hypot(ax - (c * bx - s * by), ay - (s * bx + c * by)));
  }
  return largest;
}

double strut_shape_distance(const strut_model *model, const double *a, const double *b, bool mirror,
                            bool *mirrored) {
  double plain = aligned_distance(model, a, b, 1.0);
  double other = mirror ? aligned_distance(model, a, b, -1.0) : HUGE_VAL;
  if (mirrored) *mirrored = other < plain;
  return fmin(plain, other);
}
