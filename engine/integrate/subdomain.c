/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/subdomain.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/forces/members_kernel.h"

enum { BALANCE_MEMBERS = STRUT_BLOCK * STRUT_BALANCE_BLOCKS, FAR = 255 };

static int32_t member_at(const strut_subdivision *s, int32_t k) {
  return s->member ? s->member[k] : k;
}

static int32_t end_of(const uint32_t *ends, int32_t j) { return (int32_t)(ends[j] / 2); }

/* ---- the whole ---- */

/* Nodes by their last members; those without any come first. */
static void order_nodes(strut_subdivision *s) {
  const strut_member_table *t = &s->model->members;
  int32_t nodes = s->model->node_count, next = nodes;
  for (int32_t i = 0; i < nodes; i++) s->place[i] = -1;
  for (int32_t k = t->count - 1; k >= 0; k--) {
    int32_t j = member_at(s, k), a = end_of(t->from, j), b = end_of(t->to, j);
    int32_t high = a > b ? a : b, low = a > b ? b : a;
    if (s->place[high] < 0) s->node[s->place[high] = --next] = high;
    if (s->place[low] < 0) s->node[s->place[low] = --next] = low;
  }
  for (int32_t i = nodes - 1; i >= 0; i--)
    if (s->place[i] < 0) s->node[s->place[i] = --next] = i;
}

/* Whole blocks of the energy balance for each part, and the nodes that they are the last ones of. */
static void divide(strut_subdivision *s) {
  const strut_member_table *t = &s->model->members;
  int64_t blocks = (t->count + BALANCE_MEMBERS - 1) / BALANCE_MEMBERS;
  int part = s->parts;
  int32_t first = s->model->node_count;
  for (int p = 0; p <= part; p++) s->block[p] = (int32_t)(blocks * p / part);
  s->begin[0] = 0;
  for (int32_t k = t->count - 1; k >= 0;
       k--) { /* `first`: the first node whose last member is k or later */
    while (part > 0 && k < s->block[part] * BALANCE_MEMBERS) s->begin[part--] = first;
    int32_t j = member_at(s, k), a = s->place[end_of(t->from, j)], b = s->place[end_of(t->to, j)];
    if (a == first - 1 || b == first - 1) first--;
    if (a == first - 1 || b == first - 1) first--;
  }
  for (; part > 0; part--) s->begin[part] = first;
}

bool strut_subdivision_create(const strut_model *model, const int32_t *member, int parts, int depth,
                              strut_arena *arena, strut_subdivision *s) {
  size_t nodes = (size_t)model->node_count, many = (size_t)parts + 1;
  *s = (strut_subdivision){.model = model, .member = member, .parts = parts, .depth = depth};
  s->node = strut_arena_allocate(arena, nodes, sizeof *s->node);
  s->place = strut_arena_allocate(arena, nodes, sizeof *s->place);
  s->begin = strut_arena_allocate(arena, many, sizeof *s->begin);
  s->block = strut_arena_allocate(arena, many, sizeof *s->block);
  s->shared = strut_arena_allocate(arena, nodes, sizeof *s->shared);
  if (!s->node || !s->place || !s->begin || !s->block || !s->shared) return false;
  order_nodes(s);
  divide(s);
  return true;
}

double strut_subdivision_overlap(const strut_subdivision *s) {
  const strut_member_table *t = &s->model->members;
  int64_t twice = 0;
  for (int p = 0; p < s->parts && s->parts > 1; p++) {
    int32_t end =
        s->block[p + 1] * BALANCE_MEMBERS < t->count ? s->block[p + 1] * BALANCE_MEMBERS : t->count;
    for (int32_t k = s->block[p] * BALANCE_MEMBERS; k < end; k++) {
      int32_t j = member_at(s, k), a = s->place[end_of(t->from, j)], b = s->place[end_of(t->to, j)];
      twice += a < s->begin[p] || b < s->begin[p] || a >= s->begin[p + 1] || b >= s->begin[p + 1];
    }
  }
  return 1.0 + (double)twice * (s->depth + 1) /
                   (double)t->count; /* a layer of ghosts per pass, on both sides */
}

/* ---- one of them ---- */

typedef struct builder {
  const strut_subdivision *s;
  strut_subdomain *d;
  strut_arena *arena, scratch;
  uint8_t *level;  /* (nodes) 0: own; layers of ghosts; FAR: none of it */
  int32_t *local;  /* (nodes) */
  int32_t *member; /* (slots) the scene's, or -1 */
  int32_t slots;
  bool failed;
} builder;

static void *allocate(builder *b, size_t count, size_t size) {
  void *block = strut_arena_allocate(b->arena, count, size);
  if (!block) b->failed = true;
  return block;
}

static void *allocate_scratch(builder *b, size_t count, size_t size) {
  void *block = strut_arena_allocate(&b->scratch, count, size);
  if (!block) b->failed = true;
  return block;
}

/* Own nodes; ends of their members and of those that the energy balance counts here; and so on. */
static void find_levels(builder *b, int32_t first, int32_t end) {
  const strut_subdivision *s = b->s;
  const strut_member_table *t = &s->model->members;
  for (int32_t i = 0; i < s->model->node_count; i++)
    b->level[i] = s->place[i] >= b->d->own_begin && s->place[i] < b->d->own_end ? 0 : FAR;
  if (s->parts == 1) return;
  for (uint8_t layer = 1; layer <= s->depth; layer++)
    for (int32_t k = 0; k < t->count; k++) {
      int32_t j = member_at(s, k);
      uint8_t *from = &b->level[t->from[j] / 2], *to = &b->level[t->to[j] / 2];
      bool met = *from < layer || *to < layer || (layer == 1 && k >= first && k < end);
      if (met && *from > layer) *from = layer;
      if (met && *to > layer) *to = layer;
    }
}

static void number_nodes(builder *b) {
  const strut_subdivision *s = b->s;
  strut_subdomain *d = b->d;
  int32_t nodes = s->model->node_count, own_begin = d->own_begin, own_end = d->own_end;
  for (int32_t i = 0; i < nodes; i++) d->count += b->level[i] != FAR;
  d->node = allocate(b, (size_t)d->count, sizeof *d->node);
  if (b->failed) return;
  d->count = 0;
  for (int32_t i = 0; i < nodes; i++) {
    int32_t node = s->node[i];
    if (i == own_begin) d->own_begin = d->count;
    if (i == own_end) d->own_end = d->count;
    if (b->level[node] == FAR) continue;
    b->local[node] = d->count;
    d->node[d->count++] = node;
  }
  if (own_begin == nodes) d->own_begin = d->count;
  if (own_end == nodes) d->own_end = d->count;
}

static int32_t padded(int32_t count, int32_t to) { return (count + to - 1) / to * to; }

/* Members with an end in the last layer but one, or nearer; whole blocks before, of, and behind the own ones. */
static void list_members(builder *b, int32_t first, int32_t end) {
  const strut_subdivision *s = b->s;
  const strut_member_table *t = &s->model->members;
  int32_t before = 0, behind = 0;
  for (int pass = 0; pass < 2; pass++) {
    int32_t at = 0;
    for (int32_t k = 0; k < t->count; k++) {
      int32_t j = member_at(s, k);
      if (k == first && pass) at = b->d->block_begin * STRUT_BLOCK;
      if (k == end && pass) at = b->d->block_end * STRUT_BLOCK;
      bool own = k >= first && k < end;
      if (!own && b->level[t->from[j] / 2] >= s->depth && b->level[t->to[j] / 2] >= s->depth)
        continue;
      if (pass)
        b->member[at++] = j;
      else if (!own)
        k < first ? before++ : behind++;
    }
    if (pass) return;
    b->d->block_begin = padded(before, STRUT_BLOCK) / STRUT_BLOCK;
    b->d->block_end = b->d->block_begin + padded(end - first, STRUT_BLOCK) / STRUT_BLOCK;
    b->slots = b->d->block_end * STRUT_BLOCK + padded(behind, STRUT_BLOCK);
    b->member = allocate_scratch(b, (size_t)b->slots, sizeof *b->member);
    if (b->failed) return;
    for (int32_t i = 0; i < b->slots; i++) b->member[i] = -1;
  }
}

static double *copy_of_members(builder *b, const double *from, double otherwise) {
  double *to = allocate(b, (size_t)b->slots, sizeof *to);
  for (int32_t i = 0; i < b->slots && to; i++)
    to[i] = b->member[i] < 0 ? otherwise : from[b->member[i]];
  return to;
}

static uint32_t *copy_ends(builder *b, const uint32_t *from) {
  uint32_t *to = allocate(b, (size_t)b->slots, sizeof *to);
  for (int32_t i = 0; i < b->slots && to; i++)
    to[i] = 2 * (uint32_t)(b->member[i] < 0 ? b->d->count : b->local[end_of(from, b->member[i])]);
  return to;
}

static void make_members(builder *b) {
  const strut_member_table *from = &b->s->model->members;
  strut_member_table *t = &b->d->model.members;
  t->count = t->slots = b->slots, t->blocks = b->slots / STRUT_BLOCK;
  t->from = copy_ends(b, from->from), t->to = copy_ends(b, from->to);
  t->stiffness = copy_of_members(b, from->stiffness, 0.0);
  t->rest = copy_of_members(b, from->rest, 0.0);
  t->slack = copy_of_members(b, from->slack, -HUGE_VAL);
  t->damping = copy_of_members(b, from->damping, 0.0);
  t->mass = NULL;
  uint16_t *terms = allocate(b, (size_t)t->blocks, sizeof *terms);
  if (b->failed) return;
  for (int32_t i = 0; i < b->slots; i++) {
    unsigned needs = STRUT_TERM_MEMBERS;
    if (t->damping[i] > 0) needs |= STRUT_TERM_DAMPING;
    if (t->slack[i] > -HUGE_VAL) needs |= STRUT_TERM_SLACK;
    terms[i / STRUT_BLOCK] = (uint16_t)(terms[i / STRUT_BLOCK] | needs);
  }
  t->block_terms = terms;
  t->rows = strut_pull_rows_create(b->arena, b->slots, t->from, t->to);
  if (!t->rows) b->failed = true;
}

/* Actuators of its members, in the scene's order, and a second list of them by slot. */
static void make_drives(builder *b) {
  const strut_drive_table *from = &b->s->model->drives;
  strut_drive_table *to = &b->d->model.drives;
  size_t most = (size_t)from->count;
  *to = (strut_drive_table){0};
  if (!most) return;
  uint16_t *terms = (uint16_t *)b->d->model.members.block_terms;
  int32_t *slot = allocate_scratch(b, (size_t)b->s->model->members.slots, sizeof *slot);
  int32_t *member = allocate(b, most, sizeof *member), *signal = allocate(b, most, sizeof *signal);
  uint8_t *first = allocate(b, most, 1);
  int32_t *order = b->d->drive_order = allocate(b, most, sizeof *order);
  int32_t *next = allocate_scratch(b, (size_t)b->slots + 1, sizeof *next);
  if (b->failed) return;
  for (int32_t i = 0; i < b->slots; i++)
    if (b->member[i] >= 0) slot[b->member[i]] = i + 1;
  for (int32_t i = 0; i < from->count; i++) {
    int32_t at = slot[from->member[i]] - 1;
    if (at < 0) continue;
    member[to->count] = at, signal[to->count] = from->signal[i],
    first[to->count++] = from->first[i];
    terms[at / STRUT_BLOCK] |= STRUT_TERM_DRIVE;
    next[at + 1]++;
  }
  for (int32_t i = 0; i < b->slots; i++) next[i + 1] += next[i];
  for (int32_t i = 0; i < to->count; i++) order[next[member[i]]++] = i;
  to->member = member, to->signal = signal, to->first = first;
}

/* Which of `count` things at nodes are here, by node. NULL: out of memory. */
static int32_t *sort_by_node(builder *b, int32_t count, const uint32_t *at, const int32_t *node,
                             int32_t *found) {
  int32_t *list = allocate(b, (size_t)count, sizeof *list);
  int32_t *next = count ? allocate_scratch(b, (size_t)b->d->count + 2, sizeof *next) : NULL;
  *found = 0;
  for (int pass = 0; pass < 2 && count && !b->failed; pass++) {
    for (int32_t i = 0; i < count; i++) {
      int32_t of = at ? (int32_t)(at[i] / 2) : node[i], local = b->local[of];
      if (b->level[of] == FAR) continue;
      if (pass)
        list[next[local]++] = i;
      else
        next[local + 1]++, ++*found;
    }
    for (int32_t i = 0; i < b->d->count && !pass; i++) next[i + 1] += next[i];
  }
  return list;
}

static void make_contacts_and_loads(builder *b) {
  const strut_model *model = b->s->model;
  strut_model *own = &b->d->model;
  int32_t contacts, loads;
  b->d->contact = sort_by_node(b, model->contacts.count, model->contacts.at, NULL, &contacts);
  b->d->load = sort_by_node(b, model->loads.count, NULL, model->loads.node, &loads);
  uint32_t *at = allocate(b, (size_t)contacts, sizeof *at);
  strut_contact_entry *entry = allocate(b, (size_t)contacts, sizeof *entry);
  int32_t *node = allocate(b, (size_t)loads, sizeof *node);
  int32_t *signal = allocate(b, (size_t)loads, sizeof *signal);
  double *x = allocate(b, (size_t)loads, sizeof *x), *y = allocate(b, (size_t)loads, sizeof *y);
  if (b->failed) return;
  for (int32_t i = 0; i < contacts; i++) {
    entry[i] = model->contacts.entry[b->d->contact[i]];
    entry[i].node = b->local[entry[i].node];
    at[i] = 2 * (uint32_t)entry[i].node;
  }
  for (int32_t i = 0; i < loads; i++) {
    int32_t l = b->d->load[i];
    node[i] = b->local[model->loads.node[l]], signal[i] = model->loads.signal[l];
    x[i] = model->loads.x[l], y[i] = model->loads.y[l];
  }
  own->contacts.count = contacts, own->contacts.at = at, own->contacts.entry = entry;
  own->loads = (strut_load_table){loads, node, signal, x, y};
}

/* How far each block of members leads: nodes are begun and finished by twos. */
static void find_progress(builder *b) {
  strut_subdomain *d = b->d;
  const strut_member_table *t = &d->model.members;
  int32_t *last = allocate_scratch(b, (size_t)d->count + 1, sizeof *last);
  d->need = allocate(b, (size_t)t->blocks, sizeof *d->need);
  d->ready = allocate(b, (size_t)t->blocks, sizeof *d->ready);
  if (b->failed) return;
  int32_t most = 0, ready = 0;
  for (int32_t i = 0; i < t->slots; i++)
    last[t->from[i] / 2] = last[t->to[i] / 2] = i / STRUT_BLOCK;
  for (int32_t k = 0; k < t->blocks; k++) {
    for (int32_t i = k * STRUT_BLOCK; i < (k + 1) * STRUT_BLOCK; i++) {
      int32_t a = end_of(t->from, i), c = end_of(t->to, i);
      if (a < d->count && a >= most) most = a + 1;
      if (c < d->count && c >= most) most = c + 1;
    }
    while (ready < d->count && last[ready] <= k) ready++;
    bool whole = ready == d->count;
    d->ready[k] = whole ? padded(ready, 2) : ready / 2 * 2;
    if (most < ready) most = ready;
    d->need[k] = padded(most, 2);
  }
}

static void make_state(builder *b) {
  strut_subdomain *d = b->d;
  strut_state *state = &d->state;
  size_t slots = (size_t)b->slots, contacts = (size_t)d->model.contacts.count;
  bool driven = d->model.drives.count > 0;
  const double *rest = d->model.members.rest;
  state->latest.rest = driven ? copy_of_members(b, b->s->model->members.rest, 0.0) : (double *)rest;
  state->latest.rest_rate = allocate(b, driven ? slots : STRUT_LANES, sizeof(double));
  state->modes.slack_length_threshold = (double *)d->model.members.slack;
  state->modes.slack_force_threshold = (double *)d->model.members.slack;
  state->latest.normal = allocate(b, contacts, sizeof(double));
  state->latest.friction = allocate(b, contacts, sizeof(double));
  state->latest.drive_time = (double)NAN;
}

bool strut_subdomain_create(const strut_subdivision *s, int part, strut_arena *arena,
                            strut_subdomain *d) {
  assert(part >= 0 && part < s->parts);
  const strut_model *model = s->model;
  size_t nodes = (size_t)model->node_count;
  builder b = {.s = s, .d = d, .arena = arena};
  int32_t first = s->block[part] * BALANCE_MEMBERS, end = s->block[part + 1] * BALANCE_MEMBERS;
  if (end > model->members.count) end = model->members.count;
  *d = (strut_subdomain){.model = *model,
                         .own_begin = s->begin[part],
                         .own_end = s->begin[part + 1],
                         .balance_begin = s->block[part]};
  d->model.arena = (strut_arena){0};
  b.level = allocate_scratch(&b, nodes, 1);
  b.local = allocate_scratch(&b, nodes, sizeof *b.local);
  if (!b.failed) find_levels(&b, first, end);
  if (!b.failed) number_nodes(&b);
  if (!b.failed) list_members(&b, first, end);
  if (!b.failed) make_members(&b);
  if (!b.failed) make_drives(&b);
  if (!b.failed) make_contacts_and_loads(&b);
  if (!b.failed) find_progress(&b);
  if (!b.failed) make_state(&b);
  d->model.node_count = d->count;
  d->model.length = (2 * d->count + 2 + STRUT_LANES - 1) / STRUT_LANES * STRUT_LANES;
  strut_arena_free(&b.scratch);
  return !b.failed;
}

/* ---- what they tell each other ---- */

void strut_subdivision_share(strut_subdivision *s, strut_subdomain *const *domain) {
  for (int32_t i = 0; i < s->model->node_count; i++) s->shared[i] = -1;
  s->shared_count = 0;
  for (int p = 0; p < s->parts; p++)
    for (int32_t i = 0; i < domain[p]->count; i++) {
      bool own = i >= domain[p]->own_begin && i < domain[p]->own_end;
      int32_t *shared = &s->shared[domain[p]->node[i]];
      if (!own && *shared < 0) *shared = s->shared_count++;
    }
}

bool strut_subdomain_connect(const strut_subdivision *s, strut_arena *arena, strut_subdomain *d) {
  for (int pass = 0; pass < 2; pass++) {
    d->published_count = d->ghost_count = 0;
    for (int32_t i = 0; i < d->count; i++) {
      bool own = i >= d->own_begin && i < d->own_end;
      if (own && s->shared[d->node[i]] < 0) continue;
      int32_t *count = own ? &d->published_count : &d->ghost_count;
      if (pass) (own ? d->published : d->ghost)[*count] = i;
      ++*count;
    }
    if (pass) break;
    d->published = strut_arena_allocate(arena, (size_t)d->published_count, sizeof *d->published);
    d->ghost = strut_arena_allocate(arena, (size_t)d->ghost_count, sizeof *d->ghost);
    if (!d->published || !d->ghost) return false;
  }
  return true;
}
