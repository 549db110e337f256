/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/renumber.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/model/mass.h"

/* Terms whose tables are stored in another order. */
static const unsigned STORED = STRUT_TERM_MEMBERS | STRUT_TERM_DAMPING | STRUT_TERM_SLACK |
                               STRUT_TERM_DRIVE | STRUT_TERM_CONSTANT | STRUT_TERM_LOADS |
                               STRUT_TERM_CONTACT | STRUT_TERM_FRICTION | STRUT_TERM_SLOPE |
                               STRUT_TERM_SOLVE | STRUT_TERM_LAWS | STRUT_TERM_DIRECTION;

/* Members from which on it pays: below, all of a model lies in the second cache. Nodes further apart than NEAR
   are far in memory: positions, velocities and forces of as many fill half of a usual second cache. One member
   in FEW may reach far, as those do that close a ring. */
enum { LEAST_MEMBERS = 16384, NEAR = 8192, FEW = 32 };

/* Members whose nodes have their last members in another eighth of the list, as where all bars are listed before
   all cables: threads that share the list by length would work on the same nodes. */
enum { SHARES = 8, MOST_STRAY = 4 };

static bool members_stray(const strut_model *model) {
  const strut_member_table *t = &model->members;
  uint8_t *last = strut_allocate((size_t)model->node_count, sizeof *last);
  int64_t stray = 0, count = t->count;
  for (int64_t j = 0; j < count && last; j++)
    last[t->from[j] / 2] = last[t->to[j] / 2] = (uint8_t)(SHARES * j / count);
  for (int64_t j = 0; j < count && last; j++) {
    int share = (int)(SHARES * j / count);
    stray += last[t->from[j] / 2] != share || last[t->to[j] / 2] != share;
  }
  strut_release(last);
  return stray > count / MOST_STRAY;
}

bool strut_model_is_scattered(const strut_model *model) {
  const strut_member_table *t = &model->members;
  int32_t far = 0;
  const strut_feedback_table *f = &model->feedback;
  if (t->count < LEAST_MEMBERS || (model->terms & ~STORED) || !model->mass) return false;
  if (f->sampled_count || f->trigger_count || f->relay_count) return false;
  for (int32_t j = 1; j < t->count; j++) {
    int64_t from = t->from[j] / 2, to = t->to[j] / 2, before = t->from[j - 1] / 2;
    far += llabs(to - from) > NEAR || llabs(from - before) > NEAR;
  }
  return far > t->count / FEW || members_stray(model);
}

/* ---- order of nodes ---- */

/* Which members meet at each node, in the scene's order. */
typedef struct incidence {
  int32_t *start;  /* (nodes + 1) */
  int32_t *member; /* (2 members) */
} incidence;

static bool find_incidence(const strut_model *model, strut_arena *arena, incidence *at) {
  const strut_member_table *t = &model->members;
  size_t nodes = (size_t)model->node_count, members = (size_t)t->count;
  at->start = strut_arena_allocate(arena, nodes + 2, sizeof *at->start);
  at->member = strut_arena_allocate(arena, 2 * members, sizeof *at->member);
  if (!at->start || !at->member) return false;
  for (size_t j = 0; j < members; j++)
    at->start[t->from[j] / 2 + 2]++, at->start[t->to[j] / 2 + 2]++;
  for (size_t i = 2; i < nodes + 2; i++) at->start[i] += at->start[i - 1];
  for (size_t j = 0; j < members; j++) {
    at->member[at->start[t->from[j] / 2 + 1]++] = (int32_t)j;
    at->member[at->start[t->to[j] / 2 + 1]++] = (int32_t)j;
  }
  return true;
}

/* Appends to `order` the nodes that are connected to `first` and have no place, level by level; returns the
   last. */
static int32_t visit_levels(const strut_model *model, const incidence *at, int32_t first,
                            int32_t *place, int32_t *order, int32_t *count) {
  const strut_member_table *t = &model->members;
  int32_t next = *count;
  place[first] = *count;
  order[(*count)++] = first;
  for (; next < *count; next++) {
    int32_t node = order[next];
    for (int32_t k = at->start[node]; k < at->start[node + 1]; k++) {
      int32_t j = at->member[k];
      int32_t other =
          (int32_t)(t->from[j] / 2) == node ? (int32_t)(t->to[j] / 2) : (int32_t)(t->from[j] / 2);
      if (place[other] >= 0) continue;
      place[other] = *count;
      order[(*count)++] = other;
    }
  }
  return order[*count - 1];
}

/* From a node at one end of each part, since levels from there are narrow: the last one visited from any. */
static void order_nodes(const strut_model *model, const incidence *at, int32_t *place,
                        int32_t *order) {
  int32_t count = 0;
  for (int32_t i = 0; i < model->node_count; i++) place[i] = -1;
  for (int32_t i = 0; i < model->node_count; i++) {
    if (place[i] >= 0) continue;
    int32_t begin = count;
    int32_t last = visit_levels(model, at, i, place, order, &count);
    for (int32_t k = begin; k < count; k++) place[order[k]] = -1;
    count = begin;
    visit_levels(model, at, last, place, order, &count);
  }
}

/* From the end at which the scene begins, so far as it has an order: members that must follow each other then
   stand where their nodes do. */
static void turn_as_listed(const strut_model *model, int32_t *place, int32_t *order) {
  const strut_member_table *t = &model->members;
  int32_t nodes = model->node_count, ahead = 0;
  for (int32_t j = 1; j < t->count; j++) {
    int32_t now = place[t->from[j] / 2], before = place[t->from[j - 1] / 2];
    ahead += (now > before) - (now < before);
  }
  for (int32_t i = 0; i < nodes && ahead < 0; i++) place[i] = nodes - 1 - place[i];
  for (int32_t i = 0; i < nodes && ahead < 0; i++) order[place[i]] = i;
}

/* ---- order of members ---- */

/* Node after node its members, each after those that stand before it in the scene at either end. */
static bool order_members(const strut_model *model, const incidence *at, const int32_t *order,
                          int32_t *member) {
  const strut_member_table *t = &model->members;
  size_t nodes = (size_t)model->node_count, most = (size_t)t->count + 1;
  strut_arena scratch = {0};
  int32_t *head = strut_arena_allocate(&scratch, nodes, sizeof *head); /* the next one at a node */
  int32_t *stack = strut_arena_allocate(&scratch, most, sizeof *stack);
  int32_t count = 0;
  bool good = head && stack;
  if (good) memcpy(head, at->start, nodes * sizeof *head);
  for (size_t i = 0; i < nodes && good; i++) {
    int32_t node = order[i];
    while (head[node] < at->start[node + 1]) {
      int32_t depth = 0;
      stack[depth++] = at->member[head[node]];
      while (depth > 0) {
        int32_t j = stack[depth - 1], a = (int32_t)(t->from[j] / 2), b = (int32_t)(t->to[j] / 2);
        if (at->member[head[a]] != j) {
          stack[depth++] = at->member[head[a]];
        } else if (at->member[head[b]] != j && a != b) {
          stack[depth++] = at->member[head[b]];
        } else {
          member[count++] = j;
          head[a]++, head[b]++;
          depth--;
        }
      }
    }
  }
  strut_arena_free(&scratch);
  return good;
}

/* Node after node those of its members that are not stored yet. */
static void order_members_freely(const strut_model *model, const incidence *at,
                                 const int32_t *order, const int32_t *place, int32_t *member) {
  const strut_member_table *t = &model->members;
  int32_t count = 0;
  for (int32_t i = 0; i < model->node_count; i++)
    for (int32_t k = at->start[order[i]]; k < at->start[order[i] + 1]; k++) {
      int32_t j = at->member[k], a = place[t->from[j] / 2], b = place[t->to[j] / 2];
      bool first = (a < b ? a : b) == i;
      if (first && (a != b || k == at->start[order[i]] || at->member[k - 1] != j))
        member[count++] = j;
    }
}

/* ---- tables ---- */

typedef struct copier {
  const strut_model *model;
  const int32_t *place, *order, *member, *stored;
  strut_arena *arena;
  bool failed;
} copier;

static void *allocate(copier *c, size_t count, size_t size) {
  void *block = strut_arena_allocate(c->arena, count, size);
  if (!block) c->failed = true;
  return block;
}

/* Two numbers of each node, and what follows the nodes. */
static const double *copy_coordinates(copier *c, const double *from) {
  size_t length = (size_t)c->model->length, nodes = (size_t)c->model->node_count;
  double *to = from ? allocate(c, length, sizeof *to) : NULL;
  if (!to) return NULL;
  memcpy(to + 2 * nodes, from + 2 * nodes, (length - 2 * nodes) * sizeof *to);
  for (size_t i = 0; i < nodes; i++)
    memcpy(to + 2 * i, from + 2 * (size_t)c->order[i], 2 * sizeof *to);
  return to;
}

static const double *copy_of_nodes(copier *c, const double *from) {
  size_t nodes = (size_t)c->model->node_count;
  double *to = allocate(c, nodes, sizeof *to);
  for (size_t i = 0; i < nodes && to; i++) to[i] = from[c->order[i]];
  return to;
}

static const uint8_t *copy_fixed(copier *c, const uint8_t *from) {
  size_t length = (size_t)c->model->length, nodes = (size_t)c->model->node_count;
  uint8_t *to = allocate(c, length, 1);
  if (!to) return NULL;
  memcpy(to, from, length);
  for (size_t i = 0; i < nodes; i++) memcpy(to + 2 * i, from + 2 * (size_t)c->order[i], 2);
  return to;
}

/* Where the x of a node stands. */
static uint32_t moved(const copier *c, uint32_t at) {
  return at / 2 < (uint32_t)c->model->node_count ? 2 * (uint32_t)c->place[at / 2] : at;
}

static const double *copy_of_members(copier *c, const double *from) {
  const strut_member_table *t = &c->model->members;
  double *to = allocate(c, (size_t)t->slots, sizeof *to);
  if (!to) return NULL;
  memcpy(to, from, (size_t)t->slots * sizeof *to);
  for (int32_t k = 0; k < t->count; k++) to[k] = from[c->member[k]];
  return to;
}

static const uint32_t *copy_ends(copier *c, const uint32_t *from) {
  const strut_member_table *t = &c->model->members;
  uint32_t *to = allocate(c, (size_t)t->slots, sizeof *to);
  if (!to) return NULL;
  for (int32_t k = 0; k < t->slots; k++)
    to[k] = k < t->count ? moved(c, from[c->member[k]]) : from[k];
  return to;
}

/* What the members of each block need, and the places of those that are driven. */
static void copy_terms(copier *c, strut_model *to) {
  const strut_member_table *t = &to->members;
  const strut_drive_table *d = &c->model->drives;
  uint16_t *terms = allocate(c, (size_t)t->blocks, sizeof *terms);
  int32_t *driven = allocate(c, (size_t)d->count, sizeof *driven);
  if (!c->failed) {
    for (int32_t k = 0; k < t->count; k++) {
      unsigned needs = STRUT_TERM_MEMBERS;
      if (t->damping[k] > 0) needs |= STRUT_TERM_DAMPING;
      if (t->slack[k] > -HUGE_VAL) needs |= STRUT_TERM_SLACK;
      terms[k / STRUT_BLOCK] = (uint16_t)(terms[k / STRUT_BLOCK] | needs);
    }
    for (int32_t i = 0; i < d->count; i++) {
      driven[i] = c->stored[d->member[i]];
      terms[driven[i] / STRUT_BLOCK] |= STRUT_TERM_DRIVE;
    }
  }
  to->members.block_terms = terms;
  to->drives.member = driven;
}

static void copy_members(copier *c, strut_model *to) {
  const strut_member_table *from = &c->model->members;
  strut_member_table *t = &to->members;
  t->from = copy_ends(c, from->from), t->to = copy_ends(c, from->to);
  t->stiffness = copy_of_members(c, from->stiffness);
  t->damping = copy_of_members(c, from->damping);
  t->rest = copy_of_members(c, from->rest);
  t->slack = copy_of_members(c, from->slack);
  t->mass = copy_of_members(c, from->mass);
  if (c->failed) return;
  copy_terms(c, to);
  t->rows = strut_pull_rows_create(c->arena, t->count, t->from, t->to);
  if (!t->rows) c->failed = true;
}

/* Contacts and loads keep their order: sums over them are the energy balance's. */
static void copy_contacts_and_loads(copier *c, strut_model *to) {
  size_t contacts = (size_t)c->model->contacts.count, loads = (size_t)c->model->loads.count;
  uint32_t *at = allocate(c, contacts, sizeof *at);
  strut_contact_entry *entry = allocate(c, contacts, sizeof *entry);
  int32_t *node = allocate(c, loads, sizeof *node);
  if (c->failed) return;
  for (size_t i = 0; i < contacts; i++) {
    at[i] = moved(c, c->model->contacts.at[i]);
    entry[i] = c->model->contacts.entry[i];
    entry[i].node = c->place[entry[i].node];
  }
  for (size_t i = 0; i < loads; i++) node[i] = c->place[c->model->loads.node[i]];
  to->contacts.at = at, to->contacts.entry = entry, to->loads.node = node;
}

static void copy_operator(copier *c, const strut_mass_operator *from, strut_mass_operator *to) {
  size_t rows = 0, factored = from->factor ? (size_t)from->factor->n : 0;
  size_t matrix = (size_t)from->matrix->n;
  for (int32_t b = 0; b < from->block_count; b++) rows += (size_t)from->block_size[b];
  uint32_t *at = allocate(c, rows, sizeof *at);
  int32_t *factor_node = allocate(c, factored, sizeof *factor_node);
  int32_t *matrix_node = allocate(c, matrix, sizeof *matrix_node);
  if (c->failed) return;
  for (size_t i = 0; i < rows; i++) at[i] = moved(c, from->block_at[i]);
  for (size_t i = 0; i < factored; i++) factor_node[i] = c->place[from->factor_node[i]];
  for (size_t i = 0; i < matrix; i++) matrix_node[i] = c->place[from->matrix_node[i]];
  to->block_at = at, to->factor_node = factor_node, to->matrix_node = matrix_node;
}

/* The inverses are those of the model, to the bit: only their places differ. */
static void copy_mass(copier *c, strut_model *to) {
  const strut_mass *from = c->model->mass;
  strut_mass *mass = allocate(c, 1, sizeof *mass);
  if (!mass) return;
  *mass = *from;
  mass->owned_factor[0] = mass->owned_factor[1] = NULL;
  for (int i = 0; i < 2; i++) copy_operator(c, &from->coordinate[i], &mass->coordinate[i]);
  mass->inverse = copy_coordinates(c, from->inverse);
  mass->coordinate[0].inverse = mass->coordinate[1].inverse = mass->inverse;
  to->mass = mass;
}

static strut_model *copy_model(copier *c) {
  const strut_model *from = c->model;
  strut_model *to = allocate(c, 1, sizeof *to);
  if (!to) return NULL;
  *to = *from;
  to->arena = (strut_arena){0};
  to->start = copy_coordinates(c, from->start);
  to->velocity = copy_coordinates(c, from->velocity);
  to->constant_force = copy_coordinates(c, from->constant_force);
  to->weight = copy_of_nodes(c, from->weight);
  to->point_mass = copy_of_nodes(c, from->point_mass);
  to->fixed = copy_fixed(c, from->fixed);
  if (!c->failed) copy_members(c, to);
  if (!c->failed) copy_contacts_and_loads(c, to);
  if (!c->failed) copy_mass(c, to);
  return c->failed ? NULL : to;
}

strut_status strut_renumbering_create(const strut_model *model, bool free_members,
                                      strut_renumbering **renumbering, strut_error *error) {
  strut_renumbering *r = *renumbering = strut_allocate(1, sizeof *r);
  if (!r) return strut_no_memory(error, "for the model");
  size_t nodes = (size_t)model->node_count;
  strut_arena scratch = {0};
  incidence at;
  int32_t *place = strut_arena_allocate(&r->arena, nodes, sizeof *place);
  int32_t *member = strut_arena_allocate(&r->arena, (size_t)model->members.count, sizeof *member);
  int32_t *order = strut_arena_allocate(&scratch, nodes, sizeof *order);
  int32_t *stored = strut_arena_allocate(&r->arena, (size_t)model->members.count, sizeof *stored);
  bool good = place && member && stored && order && find_incidence(model, &scratch, &at);
  if (good) order_nodes(model, &at, place, order);
  if (good) turn_as_listed(model, place, order);
  if (good && free_members)
    order_members_freely(model, &at, order, place, member);
  else
    good = good && order_members(model, &at, order, member);
  for (int32_t k = 0; k < model->members.count && good; k++) stored[member[k]] = k;
  copier c = {.model = model,
              .place = place,
              .order = order,
              .member = member,
              .stored = stored,
              .arena = &r->arena};
  r->place = place, r->member = member, r->stored = stored;
  if (good) r->model = copy_model(&c);
  strut_arena_free(&scratch);
  if (r->model) return STRUT_OK;
  strut_renumbering_free(r);
  *renumbering = NULL;
  return strut_no_memory(error, "for the model");
}

strut_status strut_member_order_create(const strut_model *model, strut_arena *arena,
                                       int32_t **member, strut_error *error) {
  size_t nodes = (size_t)model->node_count;
  strut_arena scratch = {0};
  incidence at;
  *member = strut_arena_allocate(arena, (size_t)model->members.count, sizeof **member);
  int32_t *place = strut_arena_allocate(&scratch, nodes, sizeof *place);
  int32_t *order = strut_arena_allocate(&scratch, nodes, sizeof *order);
  bool good = *member && place && order && find_incidence(model, &scratch, &at);
  if (good) order_nodes(model, &at, place, order);
  if (good) turn_as_listed(model, place, order);
  good = good && order_members(model, &at, order, *member);
  strut_arena_free(&scratch);
  return good ? STRUT_OK : strut_no_memory(error, "for the model");
}

void strut_renumbering_free(strut_renumbering *renumbering) {
  if (!renumbering) return;
  strut_arena_free(&renumbering->arena);
  strut_release(renumbering);
}
