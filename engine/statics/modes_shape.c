/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the modes are counted: the drawn shape, or what it comes to rest in. */
#include <math.h>
#include <string.h>

#include "engine/statics/minimise.h"
#include "engine/statics/modes_parts.h"

static strut_status come_to_rest(const strut_potential *potential, double *q, strut_error *error) {
  strut_minimiser *minimiser = NULL;
  strut_status status = strut_minimiser_create(potential, &minimiser, error);
  if (status != STRUT_OK) return status;
  strut_descent end = strut_minimise(minimiser, q, 0.0);
  if (end.end != STRUT_DESCENT_REACHED && !(end.residual <= 4 * end.rounding))
    status = strut_fail(error, STRUT_NOT_SETTLED, "the structure does not come to rest");
  strut_minimiser_free(minimiser);
  return status;
}

strut_status strut_modes_shape(const strut_model *model, const char *name, strut_arena *arena,
                               strut_stand *stand, strut_error *error) {
  if (name && strcmp(name, "start") == 0) name = NULL;
  size_t length = (size_t)model->length, most = (size_t)model->contacts.count;
  if (name && strcmp(name, "drawn") != 0)
    return strut_fail(error, STRUT_USAGE, "there is no configuration '%s'", name);
  strut_potential *potential = NULL;
  strut_status status = strut_potential_create(model, NULL, true, &potential, error);
  if (status != STRUT_OK) return status;
  stand->q = strut_arena_allocate(arena, length, sizeof *stand->q);
  stand->closed = strut_arena_allocate(arena, most, sizeof *stand->closed);
  double *g = strut_arena_allocate(arena, length, sizeof *g);
  if (!stand->q || !stand->closed || !g) status = STRUT_NO_MEMORY;
  if (status == STRUT_OK) {
    memcpy(stand->q, model->start, length * sizeof *stand->q);
    stand->name = name ? name : "start";
    strut_potential_gradient(potential, stand->q, g);
    for (int32_t i = 0; i < potential->n; i++) stand->residual = fmax(stand->residual, fabs(g[i]));
    stand->at_rest = stand->residual <= 4 * strut_potential_rounding(potential, stand->q);
    if (!name && !stand->at_rest) {
      status = come_to_rest(potential, stand->q, error);
      stand->at_rest = true;
    }
    const strut_contact_table *c = &model->contacts;
    for (int32_t i = 0; i < c->count; i++) {
      const double *at = stand->q + c->at[i];
      if (at[0] * c->normal[0] + (at[1] - c->height) * c->normal[1] < 0)
        stand->closed[stand->closed_count++] = c->entry[i].node;
    }
  }
  strut_potential_free(potential);
  return status;
}
