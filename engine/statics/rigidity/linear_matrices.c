/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/linear_matrices.h"

#include <math.h>

#include "engine/forces/tangent.h"

typedef struct sums {
  strut_triplets mass, elastic, geometric, contact;
  const strut_model *model;
  int32_t *row_of;
  int32_t touching;
} sums;

/* Along the member into the elastic part, across it into the geometric one. */
static void add_member(void *context, int32_t j, const strut_member_tangent *m) {
  sums *s = context;
  const strut_vec2 u = m->pose.unit, turned = {u.y, -u.x};
  int32_t row[4];
  strut_member_rows(s->model, s->row_of, j, row);
  if (!(m->pose.length > 0.0)) { /* an isotropic spring, or no direction */
    const strut_block all = strut_block_of(m->across, m->across, u);
    if (m->across > 0.0) strut_block_add(&all, STRUT_MEMBER_ENTRIES, row, &s->elastic);
    return;
  }
  const strut_block along = strut_block_of(m->along, 0.0, u);
  const strut_block across = strut_block_of(m->across, 0.0, turned);
  strut_block_add(&along, STRUT_MEMBER_ENTRIES, row, &s->elastic);
  strut_block_add(&across, STRUT_MEMBER_ENTRIES, row, &s->geometric);
}

static void add_contact(void *context, int32_t i, const strut_closed_contact *contact) {
  sums *s = context;
  const strut_contact_table *c = &s->model->contacts;
  const strut_block block = strut_block_of_contact(contact->stiffness, c->normal);
  strut_block_add(&block, STRUT_CONTACT_ENTRIES, s->row_of + c->at[i], &s->contact);
  s->touching++;
}

static void add_mass(const strut_model *model, sums *s) {
  const strut_member_table *t = &model->members;
  bool consistent = model->scene->mass_model == STRUT_MASS_CONSISTENT;
  for (int32_t at = 0; at < 2 * model->node_count; at++) {
    int32_t row = s->row_of[at];
    if (row >= 0) strut_triplets_add(&s->mass, row, row, model->point_mass[at / 2]);
  }
  for (int32_t j = 0; j < t->count; j++)
    for (uint32_t k = 0; k < 2; k++) {
      int32_t a = s->row_of[t->from[j] + k], b = s->row_of[t->to[j] + k];
      double own = consistent ? t->mass[j] / 3.0 : t->mass[j] / 2.0;
      if (a >= 0) strut_triplets_add(&s->mass, a, a, own);
      if (b >= 0) strut_triplets_add(&s->mass, b, b, own);
      if (a >= 0 && b >= 0 && consistent) strut_triplets_add(&s->mass, a, b, t->mass[j] / 6.0);
    }
}

static bool reserve(const strut_model *model, sums *s, strut_arena *scratch) {
  size_t members = (size_t)model->members.count, contacts = (size_t)model->contacts.count;
  return strut_triplets_reserve(&s->mass, (size_t)model->length + 6 * members, scratch) &&
         strut_triplets_reserve(&s->elastic, STRUT_MEMBER_ENTRIES * members + 1, scratch) &&
         strut_triplets_reserve(&s->geometric, STRUT_MEMBER_ENTRIES * members + 1, scratch) &&
         strut_triplets_reserve(&s->contact, STRUT_CONTACT_ENTRIES * contacts + 1, scratch);
}

strut_status strut_linear_matrices_build(const strut_model *model, const double *q,
                                         strut_arena *arena, strut_linear_matrices *matrices) {
  strut_arena scratch = {0};
  sums s = {.model = model};
  strut_tangent tangent = {0};
  *matrices = (strut_linear_matrices){0};
  s.row_of = strut_arena_allocate(&scratch, (size_t)model->length, sizeof *s.row_of);
  int32_t *coordinate = strut_arena_allocate(&scratch, (size_t)model->length, sizeof *coordinate);
  strut_status status = STRUT_NO_MEMORY;
  if (s.row_of && coordinate && reserve(model, &s, &scratch)) {
    int32_t n = matrices->n = strut_number_free(model, NULL, s.row_of, coordinate);
    add_mass(model, &s);
    strut_tangent_visit(model, q, model->members.rest, -HUGE_VAL, STRUT_CLOSED_TOUCHING, &s,
                        add_member, add_contact);
    matrices->mass = strut_sparse_build(n, &s.mass, arena);
    matrices->elastic = strut_sparse_build(n, &s.elastic, arena);
    matrices->geometric = strut_sparse_build(n, &s.geometric, arena);
    if (s.touching) matrices->contact = strut_sparse_build(n, &s.contact, arena);
    status = strut_tangent_assemble(model, q, model->members.rest, STRUT_CLOSED_TOUCHING, arena,
                                    &tangent);
    matrices->damping = tangent.damping;
    bool built = matrices->mass && matrices->elastic && matrices->geometric &&
                 (matrices->contact || !s.touching);
    if (!built) status = STRUT_NO_MEMORY;
  }
  strut_arena_free(&scratch);
  return status;
}
