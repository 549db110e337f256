/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/stiffness.h"

#include <math.h>

/* Adds factor * B to the places of nodes a and b: B at (a,a) and (b,b), -B at (a,b). */
static void add_member(strut_triplets *sum, const int32_t *row_of, uint32_t a, uint32_t b,
                       const double block[3]) {
  int32_t row[4] = {row_of[a], row_of[a + 1], row_of[b], row_of[b + 1]};
  for (int i = 0; i < 4; i++)
    for (int j = 0; j <= i; j++) {
      if (row[i] < 0 || row[j] < 0) continue;
      double value = block[i % 2 + j % 2];
      strut_triplets_add(sum, row[i], row[j], i / 2 == j / 2 ? value : -value);
    }
}

static void add_members(const strut_model *model, const double *q, const double *rest,
                        const int32_t *row_of, strut_triplets *stiffness, strut_triplets *damping) {
  const strut_member_table *t = &model->members;
  for (int32_t j = 0; j < t->count; j++) {
    uint32_t a = t->from[j], b = t->to[j];
    double dx = q[b] - q[a], dy = q[b + 1] - q[a + 1];
    double length = sqrt(dx * dx + dy * dy), stretch = length - rest[j];
    if (!(stretch > t->slack[j])) continue;
    double ux = length > 0 ? dx / length : 0, uy = length > 0 ? dy / length : 0;
    double c = t->stiffness[j], k = t->damping[j];
    /* of zero length and zero rest length: an isotropic spring */
    double across = length > 0 ? c * stretch / length : rest[j] > 0 ? 0 : c;
    double along = c - across;
    double block[3] = {across + along * ux * ux, along * ux * uy, across + along * uy * uy};
    add_member(stiffness, row_of, a, b, block);
    if (!(k > 0)) continue;
    double damper[3] = {k * ux * ux, k * ux * uy, k * uy * uy};
    add_member(damping, row_of, a, b, damper);
  }
}

/* Normal force of a contact at rest, for the largest step: a body rests on two of them. */
static double resting_force(const strut_model *model) {
  const strut_contact_table *c = &model->contacts;
  const double *g = model->scene->gravity;
  double mass = 0.0, down = -(g[0] * c->normal[0] + g[1] * c->normal[1]);
  for (int32_t i = 0; i < model->node_count; i++) mass += model->weight[i];
  return down > 0.0 ? mass * down / (c->count > 1 ? 2.0 : 1.0) : 0.0;
}

static void add_contacts(const strut_model *model, const double *q, strut_closed closed,
                         const int32_t *row_of, strut_triplets *stiffness,
                         strut_triplets *damping) {
  const strut_contact_table *c = &model->contacts;
  bool resting = closed == STRUT_CLOSED_ALL || closed == STRUT_CLOSED_UNDAMPED;
  double weight = resting && (model->plan & STRUT_TERM_LAWS) ? resting_force(model) : 0.0;
  for (int32_t i = 0; i < c->count && closed != STRUT_CLOSED_NONE; i++) {
    const strut_contact_entry *e = &c->entry[i];
    double damper = e->damping + weight * e->dissipation;
    double slide = e->law == STRUT_FRICTION_SMOOTH ? weight * e->mu_kinetic / e->width : 0.0;
    uint32_t at = c->at[i];
    int32_t row[2] = {row_of[at], row_of[at + 1]};
    double gap = q[at] * c->normal[0] + (q[at + 1] - c->height) * c->normal[1];
    if (closed == STRUT_CLOSED_TOUCHING && !(gap < 0)) continue;
    for (int a = 0; a < 2; a++)
      for (int b = 0; b <= a; b++) {
        if (row[a] < 0 || row[b] < 0) continue;
        double nn = c->normal[a] * c->normal[b];
        strut_triplets_add(stiffness, row[a], row[b], c->entry[i].stiffness * nn);
        if (closed != STRUT_CLOSED_UNDAMPED)
          strut_triplets_add(damping, row[a], row[b],
                             damper * nn + slide * c->tangent[a] * c->tangent[b]);
        else if (slide > 0.0)
          strut_triplets_add(damping, row[a], row[b], slide * c->tangent[a] * c->tangent[b]);
      }
  }
}

strut_status strut_tangent_assemble(const strut_model *model, const double *q, const double *rest,
                                    strut_closed closed, strut_arena *arena,
                                    strut_tangent *tangent) {
  strut_arena scratch = {0};
  strut_triplets stiffness = {0}, damping = {0};
  size_t both = (size_t)model->length;
  size_t most = 10 * (size_t)model->members.count + 3 * (size_t)model->contacts.count;
  int32_t *row_of = strut_arena_allocate(&scratch, both, sizeof *row_of);
  tangent->coordinate = strut_arena_allocate(arena, both, sizeof *tangent->coordinate);
  tangent->rigid = NULL;
  strut_status status = STRUT_NO_MEMORY;
  if (row_of && tangent->coordinate && strut_triplets_reserve(&stiffness, most, &scratch) &&
      strut_triplets_reserve(&damping, most, &scratch)) {
    int32_t n = 0;
    for (int32_t at = 0; at < 2 * model->node_count; at++) {
      row_of[at] = model->fixed[at] ? -1 : n;
      if (!model->fixed[at]) tangent->coordinate[n++] = at;
    }
    add_members(model, q, rest, row_of, &stiffness, &damping);
    add_contacts(model, q, closed, row_of, &stiffness, &damping);
    tangent->n = n;
    tangent->stiffness = strut_sparse_build(n, &stiffness, arena);
    tangent->damping = strut_sparse_build(n, &damping, arena);
    if (tangent->stiffness && tangent->damping) status = STRUT_OK;
  }
  strut_arena_free(&scratch);
  return status;
}
