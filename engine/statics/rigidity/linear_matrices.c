/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/linear_matrices.h"

#include <math.h>

#include "engine/forces/stiffness.h"

/* Entries of the lower triangle of a member's 4 x 4 block, and of a contact's 2 x 2 one. */
enum { MEMBER_ENTRIES = 10, CONTACT_ENTRIES = 3 };

typedef struct sums {
  strut_triplets mass, elastic, geometric, contact;
  const int32_t *row_of;
  int32_t touching;
} sums;

/* A block of xx, xy, yy at both ends, its opposite between them. */
static void add_member(strut_triplets *sum, const int32_t *row_of, uint32_t a, uint32_t b,
                       const double block[3]) {
  const int32_t row[4] = {row_of[a], row_of[a + 1], row_of[b], row_of[b + 1]};
  for (int i = 0; i < 4; i++)
    for (int j = 0; j <= i; j++) {
      if (row[i] < 0 || row[j] < 0) continue;
      double value = block[i % 2 + j % 2];
      strut_triplets_add(sum, row[i], row[j], i / 2 == j / 2 ? value : -value);
    }
}

static void add_stiffness(const strut_model *model, const double *q, sums *s) {
  const strut_member_table *t = &model->members;
  for (int32_t j = 0; j < t->count; j++) {
    uint32_t a = t->from[j], b = t->to[j];
    double dx = q[b] - q[a], dy = q[b + 1] - q[a + 1], length = sqrt(dx * dx + dy * dy);
    double c = t->stiffness[j], stretch = length - t->rest[j];
    if (!(stretch > t->slack[j])) continue;
    if (!(length > 0)) {
      const double all[3] = {c, 0, c};
      if (!(t->rest[j] > 0)) add_member(&s->elastic, s->row_of, a, b, all);
      continue;
    }
    double ux = dx / length, uy = dy / length, density = c * stretch / length;
    const double along[3] = {c * ux * ux, c * ux * uy, c * uy * uy};
    const double across[3] = {density * uy * uy, -density * ux * uy, density * ux * ux};
    add_member(&s->elastic, s->row_of, a, b, along);
    add_member(&s->geometric, s->row_of, a, b, across);
  }
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

static void add_contacts(const strut_model *model, const double *q, sums *s) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t i = 0; i < c->count; i++) {
    uint32_t at = c->at[i];
    if (!(q[at] * c->normal[0] + (q[at + 1] - c->height) * c->normal[1] < 0)) continue;
    s->touching++;
    for (uint32_t k = 0; k < 2; k++)
      for (uint32_t m = 0; m <= k; m++)
        if (s->row_of[at + k] >= 0 && s->row_of[at + m] >= 0)
          strut_triplets_add(&s->contact, s->row_of[at + k], s->row_of[at + m],
                             c->entry[i].stiffness * c->normal[k] * c->normal[m]);
  }
}

static bool reserve(const strut_model *model, sums *s, strut_arena *scratch) {
  size_t members = (size_t)model->members.count, contacts = (size_t)model->contacts.count;
  return strut_triplets_reserve(&s->mass, (size_t)model->length + 6 * members, scratch) &&
         strut_triplets_reserve(&s->elastic, MEMBER_ENTRIES * members + 1, scratch) &&
         strut_triplets_reserve(&s->geometric, MEMBER_ENTRIES * members + 1, scratch) &&
         strut_triplets_reserve(&s->contact, CONTACT_ENTRIES * contacts + 1, scratch);
}

static int32_t *number_rows(const strut_model *model, strut_arena *scratch, int32_t *n) {
  int32_t *row_of = strut_arena_allocate(scratch, (size_t)model->length, sizeof *row_of);
  for (int32_t at = 0; row_of && at < model->length; at++) {
    bool free = at < 2 * model->node_count && !model->fixed[at];
    row_of[at] = free ? (*n)++ : -1;
  }
  return row_of;
}

strut_status strut_linear_matrices_build(const strut_model *model, const double *q,
                                         strut_arena *arena, strut_linear_matrices *matrices) {
  strut_arena scratch = {0};
  sums s = {0};
  strut_tangent tangent = {0};
  *matrices = (strut_linear_matrices){0};
  s.row_of = number_rows(model, &scratch, &matrices->n);
  strut_status status = STRUT_NO_MEMORY;
  if (s.row_of && reserve(model, &s, &scratch)) {
    int32_t n = matrices->n;
    add_mass(model, &s);
    add_stiffness(model, q, &s);
    add_contacts(model, q, &s);
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
