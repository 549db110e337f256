/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/nearby.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "engine/base/indices.h"
#include "engine/base/vec.h"
#include "engine/forces/elements.h"

/* How far nodes may go while the list serves: a part of the mean distance between nodes [m]. */
static double way_of(const strut_model *model) {
  return 0.1 * model->size / sqrt((double)model->node_count);
}

/* The longest way of a node since the list was made [m]. */
static double way_since(const strut_model *model, const strut_nearby *near, const double *q) {
  double most = 0.0;
  if (!near->known) return HUGE_VAL;
  for (int32_t i = 0; i < 2 * model->node_count; i += 2) {
    double x = q[i] - near->q[i], y = q[i + 1] - near->q[i + 1];
    most = fmax(most, x * x + y * y);
  }
  return sqrt(most);
}

/* Is the first node further than `reach` from the box around the others? */
static bool is_outside(const uint32_t *at, int32_t nodes, const double *q, double reach) {
  for (uint32_t c = 0; c < 2; c++) {
    double p = q[at[0] + c], a = q[at[1] + c], b = q[at[nodes - 1] + c];
    double low = a < b ? a : b, high = a < b ? b : a;
    if (p < low - reach || p > high + reach) return true;
  }
  return false;
}

/* Are the bodies further apart than two ways? Other elements than collisions may act anywhere. */
static bool is_beyond(const strut_model *model, int32_t element, const double *q, double way) {
  const strut_element *e = &model->elements.element[element];
  double b[STRUT_MOST_GRADIENT], reach = e->natural + 2.0 * way;
  if (e->role != STRUT_ELEMENT_COLLISION) return false;
  return is_outside(model->elements.at + e->first, e->nodes, q, reach) ||
         strut_element_strain(model, element, q, 0.0, b) > reach;
}

bool strut_nearby_is_far(const strut_model *model, int32_t element, const double *q, bool soon) {
  const strut_element *e = &model->elements.element[element];
  if (soon) return is_beyond(model, element, q, way_of(model));
  return e->role == STRUT_ELEMENT_COLLISION &&
         is_outside(model->elements.at + e->first, e->nodes, q, e->natural);
}

const strut_nearby *strut_nearby_serving(const strut_model *model, const strut_state *state,
                                         const double *q) {
  if (!model->elements.scattered) return NULL;
  return way_since(model, state->nearby, q) <= way_of(model) ? state->nearby : NULL;
}

const strut_nearby *strut_nearby_around(const strut_model *model, const strut_state *state,
                                        const double *q, double way) {
  strut_nearby *near = state->nearby;
  if (way > way_of(model)) return NULL;
  if (way_since(model, near, q) + way <= way_of(model)) return near;
  near->count = 0;
  for (int32_t i = 0; i < model->elements.count; i++)
    if (!is_beyond(model, i, q, way_of(model))) near->element[near->count++] = i;
  memcpy(near->q, q, (size_t)model->length * sizeof *q);
  near->known = true;
  near->made++;
  return near;
}

const strut_nearby *strut_nearby_at(const strut_model *model, const strut_state *state,
                                    const double *q) {
  return strut_nearby_around(model, state, q, 0.0);
}

int32_t strut_nearby_find(const strut_nearby *near, int32_t element) {
  return strut_index_find(near->element, near->count, element);
}

/* The least of the listed elements; NULL: of all. */
static double least_of(const strut_model *model, const strut_nearby *list, const double *q,
                       int32_t *which) {
  int32_t count = list ? list->count : model->elements.count;
  double least = HUGE_VAL, b[STRUT_MOST_GRADIENT];
  for (int32_t k = 0; k < count; k++) {
    int32_t i = list ? list->element[k] : k;
    const strut_element *element = &model->elements.element[i];
    if (element->role != STRUT_ELEMENT_COLLISION) continue;
    double gap = strut_element_strain(model, i, q, 0.0, b) - element->natural;
    if (gap < least) least = gap, *which = i;
  }
  return least;
}

double strut_nearby_least_gap(const strut_model *model, const strut_state *state, const double *q,
                              int32_t *which) {
  *which = -1;
  double others = model->elements.scattered
                      ? 2.0 * (way_of(model) - way_since(model, state->nearby, q))
                      : -HUGE_VAL;
  double least = others > 0.0 ? least_of(model, state->nearby, q, which) : HUGE_VAL;
  return least <= others ? least : least_of(model, NULL, q, which);
}
