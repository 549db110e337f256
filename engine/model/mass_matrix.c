/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/mass_matrix.h"

#include "engine/model/sparse.h"

static void add_members(const strut_model *model, const int32_t *row_of, strut_triplets *sum) {
  const strut_member_table *t = &model->members;
  bool consistent = model->scene->mass_model == STRUT_MASS_CONSISTENT;
  for (int32_t j = 0; j < t->count; j++) {
    if (!(t->mass[j] > 0)) continue;
    int32_t a = row_of[t->from[j] / 2], b = row_of[t->to[j] / 2];
    double share = consistent ? t->mass[j] / 3.0 : t->mass[j] / 2.0;
    if (a >= 0) strut_triplets_add(sum, a, a, share);
    if (b >= 0) strut_triplets_add(sum, b, b, share);
    if (consistent && a >= 0 && b >= 0) strut_triplets_add(sum, a, b, t->mass[j] / 6.0);
  }
}

/* Those at rest on their members. */
static void add_sliding_masses(const strut_model *model, const int32_t *row_of,
                               strut_triplets *sum) {
  for (int32_t i = 0; i < model->sliding.count; i++) {
    const strut_sliding_item *s = &model->sliding.item[i];
    int32_t a = row_of[s->at[0] / 2], b = row_of[s->at[1] / 2];
    double far = s->start, near = 1.0 - far;
    if (s->signal >= 0) continue;
    if (a >= 0) strut_triplets_add(sum, a, a, s->mass * near * near);
    if (b >= 0) strut_triplets_add(sum, b, b, s->mass * far * far);
    if (a >= 0 && b >= 0) strut_triplets_add(sum, a, b, s->mass * near * far);
  }
}

/* Contributions from which on it pays to keep the entries only. */
enum { LARGE = 100000 };

strut_status strut_mass_matrix(strut_model *model, int coordinate, strut_arena *scratch,
                               strut_sparse **matrix, int32_t **node) {
  const uint8_t *fixed = model->fixed + coordinate;
  size_t count = (size_t)model->node_count;
  strut_triplets sum = {0};
  int32_t *row_of = strut_arena_allocate(scratch, count, sizeof *row_of);
  *node = strut_arena_allocate(&model->arena, count, sizeof **node);
  if (!row_of || !*node ||
      !strut_triplets_reserve(
          &sum, count + 3 * (size_t)(model->members.count + model->sliding.count), scratch))
    return STRUT_NO_MEMORY;
  int32_t n = 0;
  for (int32_t i = 0; i < model->node_count; i++) {
    row_of[i] = fixed[2 * i] ? -1 : n;
    if (fixed[2 * i]) continue;
    (*node)[n] = i;
    if (model->point_mass[i] > 0) strut_triplets_add(&sum, n, n, model->point_mass[i]);
    n++;
  }
  add_members(model, row_of, &sum);
  add_sliding_masses(model, row_of, &sum);
  bool large = sum.count > LARGE;
  *matrix = strut_sparse_build(n, &sum, large ? scratch : &model->arena);
  if (large && *matrix) *matrix = strut_sparse_copy(*matrix, &model->arena);
  return *matrix ? STRUT_OK : STRUT_NO_MEMORY;
}
