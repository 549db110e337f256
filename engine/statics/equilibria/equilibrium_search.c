/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One equilibrium's own figures. See hunt.h. */
#include "engine/statics/equilibria/equilibrium_search.h"

#include <math.h>
#include <string.h>

#include "engine/model/pose.h"
#include "engine/statics/equilibria/naming.h"

/* Depth and pull below these are rounding: in model sizes, in weights. */
static const double DEEP = 1e-9, PULL = 1e-9;

int32_t strut_equilibrium_search_add(strut_equilibrium_search *h) {
  if (h->count == h->room) {
    size_t room = h->room ? 2 * h->room : 32;
    strut_candidate_equilibrium *finds = strut_arena_allocate(&h->out->arena, room, sizeof *finds);
    if (!finds) return -1;
    if (h->count) memcpy(finds, h->finds, h->count * sizeof *finds);
    h->finds = finds;
    h->room = room;
  }
  h->finds[h->count] = (strut_candidate_equilibrium){.state = -1};
  h->finds[h->count].e.tips_over = h->finds[h->count].e.ends_as = -1;
  return (int32_t)h->count++;
}

static double *copied(strut_arena *arena, const double *from, size_t count) {
  double *copy = strut_arena_allocate(arena, count, sizeof *copy);
  if (copy && from && count) memcpy(copy, from, count * sizeof *copy);
  return copy;
}

static bool copy_point(strut_equilibrium_search *h, const strut_critical_point *from,
                       strut_critical_point *to) {
  strut_arena *arena = &h->out->arena;
  size_t length = (size_t)h->model->length;
  *to = *from;
  to->q = copied(arena, from->q, length);
  to->softest = copied(arena, from->softest, length);
  to->eigenvalues = copied(arena, from->eigenvalues, (size_t)from->eigenvalue_count);
  return to->q && to->softest && to->eigenvalues;
}

static void measure_members(const strut_model *model, const double *q, double *force) {
  const strut_member_table *t = &model->members;
  for (int32_t j = 0; j < t->count; j++) {
    strut_member_pose pose = strut_member_pose_at(t, t->rest, j, q);
    force[j] = strut_member_elastic_force(t, j, &pose);
  }
}

/* What holds the held coordinates: minus the net force there. */
static bool measure_reactions(strut_equilibrium_search *h, const strut_potential *potential,
                              const uint8_t *held, strut_candidate_equilibrium *f) {
  double *force = strut_allocate((size_t)h->model->length, sizeof *force);
  if (!force) return false;
  strut_potential_force(potential, f->e.point.q, force);
  for (int32_t i = 0; i < h->model->node_count; i++)
    for (int c = 0; c < 2; c++) {
      int32_t at = 2 * i + c;
      if (!h->model->fixed[at] && !(held && held[at])) continue;
      f->e.reaction[i][c] = 0.0 - force[at];
      bool by_ground = held && held[at] && c == 1 && !h->model->fixed[at];
      if (by_ground && -force[at] < -PULL * potential->force_scale) f->pulls = true;
    }
  strut_release(force);
  return true;
}

static void find_nodes_below(const strut_equilibrium_search *h, const uint8_t *held,
                             strut_equilibrium *e) {
  const strut_contact_table *c = &h->model->contacts;
  for (int32_t i = 0; i < c->count && h->on_ground; i++) {
    uint32_t at = c->at[i];
    double gap = strut_contact_gap(c, i, e->point.q);
    if (held && !held[at + 1] && gap < -DEEP * h->model->size) e->below[at / 2] = 1;
  }
}

strut_status strut_equilibrium_search_fill(strut_equilibrium_search *h,
                                           strut_candidate_equilibrium *find,
                                           const strut_potential *potential, const uint8_t *held,
                                           const strut_node_set *set,
                                           const strut_critical_point *point) {
  strut_arena *arena = &h->out->arena;
  strut_equilibrium *e = &find->e;
  size_t nodes = (size_t)h->model->node_count;
  e->supports = set;
  e->reaction = strut_arena_allocate(arena, nodes, sizeof *e->reaction);
  e->below = strut_arena_allocate(arena, nodes, 1);
  e->member_force = strut_arena_allocate(arena, (size_t)h->model->members.count, sizeof(double));
  if (!e->reaction || !e->below || !e->member_force || !copy_point(h, point, &e->point))
    return strut_fail(h->error, STRUT_NO_MEMORY, "out of memory");
  bool placed = 2 * h->model->node_count - potential->n <= 3; /* whole shapes are free to be so */
  if ((placed && strut_orient_shape(h->model, held, e->point.q, e->point.softest)) ||
      !measure_reactions(h, potential, held, find))
    return strut_fail(h->error, STRUT_NO_MEMORY, "out of memory");
  e->energy = strut_potential_energy(potential, e->point.q);
  measure_members(h->model, e->point.q, e->member_force);
  find_nodes_below(h, held, e);
  if (!set) return strut_equilibrium_search_contacts(h, e->point.q, e);
  e->contacts = set->node;
  e->contact_count = (int32_t)set->count;
  e->normal = strut_arena_allocate(arena, set->count, sizeof *e->normal);
  if (!e->normal) return strut_fail(h->error, STRUT_NO_MEMORY, "out of memory");
  for (size_t i = 0; i < set->count; i++) e->normal[i] = e->reaction[set->node[i]][1];
  return STRUT_OK;
}

strut_status strut_equilibrium_search_contacts(strut_equilibrium_search *h, const double *q,
                                               strut_equilibrium *e) {
  const strut_contact_table *c = &h->model->contacts;
  size_t most = h->on_ground ? (size_t)c->count : 0;
  e->contacts = strut_arena_allocate(&h->out->arena, most, sizeof *e->contacts);
  e->normal = strut_arena_allocate(&h->out->arena, most, sizeof *e->normal);
  if (!e->contacts || !e->normal) return strut_fail(h->error, STRUT_NO_MEMORY, "out of memory");
  e->contact_count = 0;
  for (size_t i = 0; i < most; i++) {
    double normal = -c->entry[i].stiffness * strut_contact_gap(c, (int32_t)i, q);
    if (!(normal > PULL * h->world->force_scale)) continue;
    e->contacts[e->contact_count] = c->entry[i].node;
    e->normal[e->contact_count++] = normal;
  }
  return STRUT_OK;
}
