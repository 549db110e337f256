/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/events/regions/local_region.h"

#include <math.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/model/hot.h"

static const unsigned POSSIBLE = STRUT_TERM_MEMBERS | STRUT_TERM_DAMPING | STRUT_TERM_SLACK |
                                 STRUT_TERM_DRIVE | STRUT_TERM_CONSTANT | STRUT_TERM_CONTACT |
                                 STRUT_TERM_FRICTION | STRUT_TERM_SLOPE | STRUT_TERM_SOLVE |
                                 STRUT_TERM_LAWS | STRUT_TERM_DIRECTION;

bool strut_local_region_possible(const strut_model *model) {
  const strut_feedback_table *f = &model->feedback;
  if (f->sampled_count || f->trigger_count || f->relay_count) return false;
  return (model->terms & STRUT_TERM_MEMBERS) && !(model->terms & ~POSSIBLE) && model->mass &&
         model->mass->shared;
}

bool strut_local_region_is_far(const strut_local_region *region, int32_t node) {
  return region->layer[node] > STRUT_LOCAL_MARGIN + 1;
}

/* ---- who is next to whom ---- */

static bool list_members(const strut_model *model, strut_arena *arena,
                         strut_local_region_map *map) {
  const strut_member_table *t = &model->members;
  size_t nodes = (size_t)model->node_count, members = (size_t)t->count;
  int32_t *start = strut_arena_allocate(arena, nodes + 2, sizeof *start);
  int32_t *list = strut_arena_allocate(arena, 2 * members, sizeof *list);
  if (!start || !list) return false;
  for (size_t j = 0; j < members; j++) start[t->from[j] / 2 + 2]++, start[t->to[j] / 2 + 2]++;
  for (size_t i = 2; i < nodes + 2; i++) start[i] += start[i - 1];
  for (size_t j = 0; j < members; j++) {
    list[start[t->from[j] / 2 + 1]++] = (int32_t)j;
    list[start[t->to[j] / 2 + 1]++] = (int32_t)j;
  }
  map->member_start = start, map->member = list;
  return true;
}

static bool list_masses(const strut_model *model, strut_arena *arena, strut_local_region_map *map) {
  const strut_mass_operator *op = &model->mass->coordinate[0];
  const strut_sparse *m = op->matrix;
  const int32_t *node = op->matrix_node;
  size_t nodes = (size_t)model->node_count, entries = 2 * (size_t)(m->start[m->n] - m->n);
  int32_t *start = strut_arena_allocate(arena, nodes + 2, sizeof *start);
  map->mass_node = strut_arena_allocate(arena, entries, sizeof *map->mass_node);
  map->mass_value = strut_arena_allocate(arena, entries, sizeof *map->mass_value);
  map->diagonal = strut_arena_allocate(arena, nodes, sizeof *map->diagonal);
  if (!start || !map->mass_node || !map->mass_value || !map->diagonal) return false;
  for (int32_t j = 0; j < m->n; j++)
    for (int32_t k = m->start[j] + 1; k < m->start[j + 1]; k++)
      start[node[j] + 2]++, start[node[m->row[k]] + 2]++;
  for (size_t i = 2; i < nodes + 2; i++) start[i] += start[i - 1];
  for (int32_t j = 0; j < m->n; j++) {
    map->diagonal[node[j]] = m->value[m->start[j]];
    for (int32_t k = m->start[j] + 1; k < m->start[j + 1]; k++)
      for (int end = 0; end < 2; end++) {
        int32_t one = node[end ? j : m->row[k]], other = node[end ? m->row[k] : j];
        map->mass_node[start[one + 1]] = other;
        map->mass_value[start[one + 1]++] = m->value[k];
      }
  }
  map->mass_start = start;
  return true;
}

static int32_t other_end(const strut_member_table *t, int32_t j, int32_t node) {
  int32_t from = (int32_t)(t->from[j] / 2), to = (int32_t)(t->to[j] / 2);
  return from == node ? to : from;
}

/* Breadth first from the lowest node of each part, and again from where that ends. */
static void rank_nodes(const strut_model *model, const strut_local_region_map *map) {
  int32_t count = 0;
  for (int32_t i = 0; i < model->node_count; i++) map->rank[i] = -1;
  for (int32_t part = 0; part < model->node_count; part++) {
    if (map->rank[part] >= 0) continue;
    int32_t begin = count, root = part;
    for (int pass = 0; pass < 2; pass++) {
      for (int32_t k = begin; k < count; k++) map->rank[map->ranked[k]] = -1;
      count = begin;
      map->ranked[count] = root, map->rank[root] = count++;
      for (int32_t k = begin; k < count; k++) {
        int32_t i = map->ranked[k];
        for (int32_t e = map->member_start[i]; e < map->member_start[i + 1]; e++) {
          int32_t other = other_end(&model->members, map->member[e], i);
          if (map->rank[other] < 0) map->ranked[count] = other, map->rank[other] = count++;
        }
      }
      root = map->ranked[count - 1];
    }
  }
}

strut_status strut_local_region_map_create(const strut_model *model, strut_arena *arena,
                                           strut_local_region_map *map) {
  size_t nodes = (size_t)model->node_count;
  map->rank = strut_arena_allocate(arena, nodes, sizeof *map->rank);
  map->ranked = strut_arena_allocate(arena, nodes, sizeof *map->ranked);
  map->contact = strut_arena_allocate(arena, nodes, sizeof *map->contact);
  if (!map->rank || !map->ranked || !map->contact || !list_members(model, arena, map) ||
      !list_masses(model, arena, map))
    return STRUT_NO_MEMORY;
  for (size_t i = 0; i < nodes; i++) map->contact[i] = -1;
  for (int32_t i = 0; i < model->contacts.count; i++) map->contact[model->contacts.at[i] / 2] = i;
  rank_nodes(model, map);
  return STRUT_OK;
}

/* Entries between the first and the diagonal of all rows of M, and at least a diagonal. */
static size_t count_entries(const strut_model *model, const strut_local_region_map *map) {
  size_t entries = 0;
  for (int32_t i = 0; i < model->node_count; i++) {
    int32_t first = map->rank[i];
    for (int32_t e = map->mass_start[i]; e < map->mass_start[i + 1]; e++)
      if (map->rank[map->mass_node[e]] < first) first = map->rank[map->mass_node[e]];
    entries += (size_t)(map->rank[i] - first) + 1;
  }
  return entries;
}

strut_status strut_local_region_create(const strut_model *model, const strut_local_region_map *map,
                                       strut_arena *arena, strut_local_region *r) {
  size_t nodes = (size_t)model->node_count, members = (size_t)model->members.count,
         contacts = (size_t)model->contacts.count;
  size_t most = nodes > members ? nodes : members;
  bool coupled = !model->mass->diagonal;
  r->node = strut_arena_allocate(arena, nodes, sizeof *r->node);
  r->halo = strut_arena_allocate(arena, nodes, sizeof *r->halo);
  r->member = strut_arena_allocate(arena, members, sizeof *r->member);
  r->contact = strut_arena_allocate(arena, contacts, sizeof *r->contact);
  r->slot = strut_arena_allocate(arena, nodes, sizeof *r->slot);
  r->layer = strut_arena_allocate(arena, nodes, sizeof *r->layer);
  r->seen = strut_arena_allocate(arena, most > contacts ? most : contacts, sizeof *r->seen);
  r->queue = strut_arena_allocate(arena, nodes, sizeof *r->queue);
  r->stack = strut_arena_allocate(arena, nodes, sizeof *r->stack);
  r->pair = strut_arena_allocate(arena, 2 * nodes, sizeof *r->pair);
  r->halo_a = strut_arena_allocate(arena, 2 * nodes, sizeof *r->halo_a);
  if (!r->node || !r->halo || !r->member || !r->contact || !r->slot || !r->layer || !r->seen ||
      !r->queue || !r->stack || !r->halo_a || !r->pair)
    return STRUT_NO_MEMORY;
  if (!coupled) return STRUT_OK;
  r->room = count_entries(model, map);
  r->row = strut_arena_allocate(arena, nodes + 1, sizeof *r->row);
  r->first = strut_arena_allocate(arena, nodes, sizeof *r->first);
  r->lower = strut_arena_allocate(arena, r->room, sizeof *r->lower);
  r->inverse = strut_arena_allocate(arena, nodes, sizeof *r->inverse);
  r->coupling = strut_arena_allocate(arena, (size_t)map->mass_start[nodes], sizeof *r->coupling);
  return r->row && r->first && r->lower && r->inverse && r->coupling ? STRUT_OK : STRUT_NO_MEMORY;
}

/* ---- growth ---- */

static void clear(strut_local_region *r) {
  for (int32_t k = 0; k < r->node_count; k++) r->slot[r->node[k]] = r->layer[r->node[k]] = 0;
  for (int32_t k = 0; k < r->halo_count; k++) r->slot[r->halo[k]] = 0;
  r->node_count = r->halo_count = r->member_count = r->contact_count = r->coupling_count = 0;
}

/* Nodes that have come nearer wait in a circle. */
typedef struct queue {
  int32_t begin, count;
} queue;

static void offer(const strut_model *model, const strut_local_region_map *map,
                  strut_local_region *r, queue *q, int32_t node, int layer) {
  if (layer > r->reach || !(map->diagonal[node] > 0.0))
    return; /* supported nodes pass nothing on */
  if (r->layer[node] && r->layer[node] <= layer + 1) return;
  if (!r->layer[node]) r->stack[r->node_count++] = node;
  r->layer[node] = (uint8_t)(layer + 1);
  if (r->seen[node]) return;
  r->seen[node] = 1;
  r->queue[(q->begin + q->count++) % model->node_count] = node;
}

static void reach(const strut_model *model, const strut_local_region_map *map, int32_t start,
                  const uint8_t *seed, uint8_t *joined, strut_local_region *r) {
  queue q = {0};
  offer(model, map, r, &q, start, 0);
  while (q.count) {
    int32_t i = r->queue[q.begin];
    q.begin = (q.begin + 1) % model->node_count, q.count--;
    r->seen[i] = 0;
    if (seed[i] && !joined[i]) joined[i] = 1, r->layer[i] = 1;
    int next = r->layer[i];
    for (int32_t e = map->member_start[i]; e < map->member_start[i + 1]; e++)
      offer(model, map, r, &q, other_end(&model->members, map->member[e], i), next);
    for (int32_t e = map->mass_start[i]; e < map->mass_start[i + 1]; e++)
      offer(model, map, r, &q, map->mass_node[e], next);
  }
}

/* Numbers below `most` that are marked, ascending, into `list`; clears the marks. */
static int32_t collect(uint8_t *mark, int32_t most, int32_t *list) {
  int32_t count = 0;
  for (int32_t i = 0; i < most; i += 8) {
    uint64_t eight = 1;
    if (i + 8 <= most) memcpy(&eight, mark + i, sizeof eight);
    if (!eight) continue;
    for (int32_t k = i; k < most && k < i + 8; k++)
      if (mark[k]) list[count++] = k, mark[k] = 0;
  }
  return count;
}

static void list_nodes(const strut_model *model, const strut_local_region_map *map,
                       strut_local_region *r) {
  for (int32_t k = 0; k < r->node_count; k++) r->seen[map->rank[r->stack[k]]] = 1;
  r->node_count = collect(r->seen, model->node_count, r->node);
  for (int32_t k = 0; k < r->node_count; k++) {
    r->node[k] = map->ranked[r->node[k]];
    r->slot[r->node[k]] = k + 1;
  }
}

static void offer_halo(strut_local_region *r, int32_t node) {
  if (r->slot[node]) return;
  r->halo[r->halo_count++] = node;
  r->slot[node] = -r->halo_count;
}

static void list_rest(const strut_model *model, const strut_local_region_map *map,
                      strut_local_region *r) {
  for (int32_t k = 0; k < r->node_count; k++) {
    int32_t i = r->node[k];
    for (int32_t e = map->member_start[i]; e < map->member_start[i + 1]; e++) {
      offer_halo(r, other_end(&model->members, map->member[e], i));
      r->seen[map->member[e]] = 1;
    }
    for (int32_t e = map->mass_start[i]; e < map->mass_start[i + 1]; e++)
      offer_halo(r, map->mass_node[e]);
  }
  r->member_count = collect(r->seen, model->members.count, r->member);
  for (int32_t k = 0; k < r->node_count; k++)
    if (map->contact[r->node[k]] >= 0) r->seen[map->contact[r->node[k]]] = 1;
  r->contact_count = collect(r->seen, model->contacts.count, r->contact);
}

/* ---- masses ---- */

static bool place_rows(const strut_local_region_map *map, strut_local_region *r) {
  size_t entries = 0;
  for (int32_t k = 0; k < r->node_count; k++) {
    int32_t i = r->node[k], first = k;
    for (int32_t e = map->mass_start[i]; e < map->mass_start[i + 1]; e++) {
      int32_t other = r->slot[map->mass_node[e]] - 1;
      if (other >= 0 && other < first) first = other;
    }
    r->first[k] = first;
    r->row[k] = entries;
    entries += (size_t)(k - first) + 1;
    if (entries > r->room) return false;
  }
  return true;
}

/*
 * L L' to L D L' with ones on the diagonal of L, and the inverse of D: its solutions have no products in a
 * row.
 */
static void scale_rows(strut_local_region *r) {
  for (int32_t k = 0; k < r->node_count; k++) {
    double *row = r->lower + r->row[k];
    for (int32_t j = r->first[k]; j < k; j++) row[j - r->first[k]] *= r->inverse[j];
  }
  for (int32_t k = 0; k < r->node_count; k++) r->inverse[k] *= r->inverse[k];
}

/* Sum of a[m] b[m] over `count` columns, in four parts. */
STRUT_INLINE double dot_rows(const double *a, const double *b, int32_t count) {
  strut_lanes part = {0};
  double rest = 0.0;
  int32_t m = 0;
  for (; m + STRUT_LANES <= count; m += STRUT_LANES)
    part += strut_lanes_load(a + m) * strut_lanes_load(b + m);
  for (; m < count; m++) rest += a[m] * b[m];
  return (part[0] + part[1]) + (part[2] + part[3]) + rest;
}

STRUT_CLONES
static bool factor_region(const strut_local_region_map *map, strut_local_region *r) {
  if (!place_rows(map, r)) return false;
  for (int32_t k = 0; k < r->node_count; k++) {
    int32_t i = r->node[k], begin = r->first[k];
    double *row = r->lower + r->row[k]; /* row[j - begin] is column j */
    memset(row, 0, (size_t)(k - begin + 1) * sizeof *row);
    row[k - begin] = map->diagonal[i];
    for (int32_t e = map->mass_start[i]; e < map->mass_start[i + 1]; e++) {
      int32_t other = r->slot[map->mass_node[e]] - 1;
      if (other >= 0 && other < k) row[other - begin] += map->mass_value[e];
    }
    double diagonal = row[k - begin];
    for (int32_t j = begin; j < k; j++) {
      const double *left = r->lower + r->row[j];
      int32_t from = r->first[j];
      int32_t both = begin > from ? begin : from;
      double sum = row[j - begin] - dot_rows(row + both - begin, left + both - from, j - both);
      sum *= r->inverse[j];
      row[j - begin] = sum;
      diagonal -= sum * sum;
    }
    if (!(diagonal > 0.0)) return false;
    row[k - begin] = sqrt(diagonal);
    r->inverse[k] = 1.0 / row[k - begin];
  }
  scale_rows(r);
  return true;
}

/* The masses that join the region to its halo. */
static void list_couplings(const strut_local_region_map *map, strut_local_region *r) {
  for (int32_t k = 0; k < r->node_count; k++)
    for (int32_t e = map->mass_start[r->node[k]]; e < map->mass_start[r->node[k] + 1]; e++) {
      int32_t halo = -1 - r->slot[map->mass_node[e]];
      if (halo < 0) continue;
      r->coupling[r->coupling_count++] = (strut_local_coupling){k, halo, map->mass_value[e]};
    }
}

bool strut_local_region_grow(const strut_model *model, const strut_local_region_map *map,
                             int32_t start, const uint8_t *seed, uint8_t *joined,
                             strut_local_region *region) {
  clear(region);
  reach(model, map, start, seed, joined, region);
  list_nodes(model, map, region);
  list_rest(model, map, region);
  if (model->mass->diagonal) return true;
  list_couplings(map, region);
  return factor_region(map, region);
}

/* Sum of row[j] x[j], j from 0 to below `count`, x and y side by side; in four parts, which need not wait. */
STRUT_INLINE strut_pair dot(const double *row, const double *x, int32_t count) {
  strut_pair sum[4] = {{0}, {0}, {0}, {0}};
  int32_t j = 0;
  for (; j + 4 <= count; j += 4)
    for (int part = 0; part < 4; part++)
      sum[part] += row[j + part] * strut_pair_load(x + 2 * (j + part));
  for (; j < count; j++) sum[0] += row[j] * strut_pair_load(x + 2 * j);
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/*
 * pair becomes (L D L')^-1 pair. What the row before has just become is used last: nothing else need wait for
 * it.
 */
STRUT_CLONES
static void solve_rows(const strut_local_region *r) {
  double *x = r->pair;
  for (int32_t k = 1; k < r->node_count; k++) {
    int32_t begin = r->first[k], last = k - begin - 1;
    if (last < 0) continue;
    const double *row = r->lower + r->row[k];
    strut_pair rest = strut_pair_load(x + 2 * k) - dot(row, x + 2 * begin, last);
    strut_pair_store(x + 2 * k, rest - row[last] * strut_pair_load(x + 2 * k - 2));
  }
  for (int32_t k = 0; k < r->node_count; k++)
    strut_pair_store(x + 2 * k, strut_pair_load(x + 2 * k) * r->inverse[k]);
  for (int32_t k = r->node_count - 1; k > 0; k--) {
    int32_t begin = r->first[k];
    const double *row = r->lower + r->row[k];
    strut_pair own = strut_pair_load(x + 2 * k);
    for (int32_t j = k - 1; j >= begin; j--)
      strut_pair_store(x + 2 * j, strut_pair_load(x + 2 * j) - row[j - begin] * own);
  }
}

void strut_local_region_solve(const strut_model *model, const strut_local_region *r) {
  double *x = r->pair;
  for (int32_t k = 0; k < r->node_count && model->mass->diagonal; k++)
    for (int c = 0; c < 2; c++) x[2 * k + c] *= model->mass->inverse[2 * r->node[k] + c];
  if (!model->mass->diagonal) solve_rows(r);
}

void strut_local_region_divide(const strut_model *model, const strut_local_region *r,
                               const double *force, double *a) {
  const double *inverse = model->mass->inverse;
  if (model->mass->diagonal) {
    for (int32_t k = 0; k < r->node_count; k++)
      for (int32_t i = 2 * r->node[k]; i < 2 * r->node[k] + 2; i++) a[i] = force[i] * inverse[i];
    return;
  }
  for (int32_t k = 0; k < r->node_count; k++)
    strut_pair_store(r->pair + 2 * k, strut_pair_load(force + 2 * r->node[k]));
  for (int32_t n = 0; n < r->coupling_count; n++) {
    const strut_local_coupling *j = &r->coupling[n];
    double *own = r->pair + 2 * j->own;
    strut_pair_store(own,
                     strut_pair_load(own) - j->mass * strut_pair_load(r->halo_a + 2 * j->halo));
  }
  strut_local_region_solve(model, r);
  for (int32_t k = 0; k < r->node_count; k++)
    strut_pair_store(a + 2 * r->node[k], strut_pair_load(r->pair + 2 * k));
}

void strut_local_region_pass_on(const strut_local_region *r, const double *change, double *force) {
  for (int32_t n = 0; n < r->coupling_count; n++) {
    const strut_local_coupling *j = &r->coupling[n];
    double *halo = force + 2 * r->halo[j->halo];
    strut_pair own = strut_pair_load(change + 2 * j->own);
    strut_pair_store(halo, strut_pair_load(halo) - j->mass * own);
  }
}
