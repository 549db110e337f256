/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Nodes that become one, by name or because they touch. See copies.h.
 *
 * The node that comes first stays: masses add, supports unite, and all names go on meaning it. Nodes that
 * are named must lie in the same place within a billionth of the structure's size; of those that only
 * touch, pairs that are a little further apart are an error, since they were probably meant.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/read/reuse/copies.h"

/* Over the size of the structure; NEAR also less than PART_OF_SPACING of the nodes' spacing in a row. */
static const double SAME = 1e-9, NEAR = 1e-4, PART_OF_SPACING = 0.01;

typedef struct merging {
  strut_reader *reader;
  int32_t near[2]; /* the first two that nearly touch */
  size_t near_count;
  size_t count;
  int32_t *root; /* (count) an earlier node of its set, or itself */
  double size;
} merging;

static int32_t find_root(merging *self, int32_t i) {
  while (self->root[i] != i) {
    self->root[i] = self->root[self->root[i]];
    i = self->root[i];
  }
  return i;
}

static double structure_size(const strut_scene *scene) {
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  for (size_t i = 0; i < scene->node_count; i++)
    for (int c = 0; c < 2; c++) {
      low[c] = fmin(low[c], scene->nodes[i].position[c]);
      high[c] = fmax(high[c], scene->nodes[i].position[c]);
    }
  return hypot(high[0] - low[0], high[1] - low[1]);
}

static strut_place drawn_place(const merging *self, int32_t node) {
  return self->reader->things[STRUT_THING_NODE].source[node].key->place;
}

static void report_apart(merging *self, const strut_merger *merger, int32_t a, int32_t b,
                         double apart) {
  strut_reader *reader = self->reader;
  const strut_node *nodes = reader->scene->nodes;
  const strut_tree *at = merger->a ? merger->a : merger->place;
  size_t before = reader->diagnostics->count;
  reader->ends_unknown = true;
  if (merger->a) {
    strut_report_error(reader, at->place, "'%s' and '%s' cannot be one node: they are %.3g m apart",
                       nodes[a].name, nodes[b].name, apart);
  } else {
    char more[80] = "";
    if (self->near_count > 1)
      snprintf(more, sizeof more, ", and %zu more pairs nearly touch", self->near_count - 1);
    strut_report_error(reader, at->place,
                       "'%s' and '%s' are %.3g m apart%s: merge them by name, or move them",
                       nodes[a].name, nodes[b].name, apart, more);
  }
  if (reader->diagnostics->count == before) return;
  strut_diagnose_note(reader->diagnostics, before, drawn_place(self, a), "'%s' is drawn here",
                      nodes[a].name);
  strut_diagnose_note(reader->diagnostics, before, drawn_place(self, b), "'%s' is drawn here",
                      nodes[b].name);
}

static double distance(const merging *self, int32_t a, int32_t b) {
  const strut_node *nodes = self->reader->scene->nodes;
  return strut_distance(nodes[a].position, nodes[b].position);
}

/* The earlier node stays. */
static void unite(merging *self, const strut_merger *merger, int32_t a, int32_t b) {
  strut_reader *reader = self->reader;
  a = find_root(self, a), b = find_root(self, b);
  if (a == b) return;
  int32_t stays = a < b ? a : b, goes = a < b ? b : a;
  strut_node *kept = &reader->scene->nodes[stays], *node = &reader->scene->nodes[goes];
  if (reader->node_moves[stays] && reader->node_moves[goes]) {
    strut_report_error(reader, (merger->a ? merger->a : merger->place)->place,
                       "'%s' and '%s' become one node, but both have 'moves'", kept->name,
                       node->name);
    return;
  }
  self->root[goes] = stays;
  kept->mass += node->mass;
  for (int c = 0; c < 2; c++) kept->fixed[c] = kept->fixed[c] || node->fixed[c];
  if (reader->node_moves[goes]) {
    reader->node_moves[stays] = reader->node_moves[goes];
    reader->things[STRUT_THING_NODE].source[stays].key =
        reader->things[STRUT_THING_NODE].source[goes].key; /* the scope of its signals */
  }
  if (reader->things[STRUT_THING_NODE].source[goes].broken)
    reader->things[STRUT_THING_NODE].source[stays].broken = true;
}

static void merge_named(merging *self, const strut_merger *merger) {
  strut_reader *reader = self->reader;
  strut_copy *own = merger->scope;
  bool onto = strcmp(merger->place->text, "onto") == 0;
  bool link = own && own->kind == STRUT_SCOPE_LINK && !onto;
  strut_owner owner = {!own   ? "the scene"
                       : onto ? "place"
                       : link ? "'next'"
                              : "part",
                       !own || link ? NULL
                       : onto       ? own->placement->key->text
                                    : own->placement->part->name};
  const char *key = onto ? "onto" : "merge";
  reader->scope = own;
  int32_t a = strut_read_reference(reader, merger->a, key, owner, STRUT_THING_NODE);
  if (link) owner.kind = "the next copy";
  int32_t b = strut_read_reference(reader, &merger->b.tree, key, owner, STRUT_THING_NODE);
  if (a >= 0 && b >= 0) {
    double apart = distance(self, a, b);
    if (apart > SAME * self->size)
      report_apart(self, merger, a, b, apart);
    else
      unite(self, merger, a, b);
  } else {
    reader->ends_unknown = true;
  }
  reader->scope = NULL;
}

/* ---- touching ---- */

/* A node in its square of a grid, whose squares are as wide as nodes may be near. */
typedef struct grid_node {
  int64_t x, y;
  int32_t node;
} grid_node;

static int compare(const void *first, const void *second) {
  const grid_node *self = first, *q = second;
  if (self->x != q->x) return self->x < q->x ? -1 : 1;
  if (self->y != q->y) return self->y < q->y ? -1 : 1;
  return self->node < q->node ? -1 : self->node > q->node;
}

/* The first of the sorted nodes in the square (x, y) or behind it. */
static size_t lower_bound(const grid_node *grid, size_t count, int64_t x, int64_t y) {
  size_t low = 0, high = count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    bool before = grid[middle].x < x || (grid[middle].x == x && grid[middle].y < y);
    if (before)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static double near_distance(const merging *self) {
  double near = fmin(NEAR, PART_OF_SPACING / (double)self->count);
  return fmax(near, SAME) * self->size;
}

/* Compares a node with those of one square; true where it has become another one. */
static bool meet_square(merging *self, const strut_merger *merger, const grid_node *grid,
                        size_t count, const grid_node *own, int64_t x, int64_t y) {
  for (size_t k = lower_bound(grid, count, x, y); k < count && grid[k].x == x && grid[k].y == y;
       k++) {
    int32_t other = grid[k].node;
    if (other >= own->node) return false; /* sorted: later nodes come later */
    if (find_root(self, other) != other || find_root(self, own->node) == other) continue;
    double apart = distance(self, other, own->node);
    if (apart <= SAME * self->size) {
      unite(self, merger, other, own->node);
      return true;
    }
    if (apart > near_distance(self) || self->near_count++) continue;
    self->near[0] = other, self->near[1] = own->node;
  }
  return false;
}

static void merge_touching(merging *self, const strut_merger *merger) {
  strut_reader *reader = self->reader;
  double width = near_distance(self);
  self->near_count = 0;
  const strut_copy *own = merger->scope;
  size_t count = 0, all = own ? own->node_end - own->node_begin : self->count;
  grid_node *grid = strut_allocate(all, sizeof *grid);
  if (!grid) {
    reader->out_of_memory = true;
    return;
  }
  for (size_t k = 0; k < all && width > 0.0; k++) {
    int32_t i = own ? strut_name_map_find(&reader->things[STRUT_THING_NODE].names,
                                          reader->copies->nodes[own->node_begin + k]->text)
                    : (int32_t)k;
    if (i < 0) continue; /* the scene removes it */
    const double *at = reader->scene->nodes[i].position;
    if (!isfinite(at[0] + at[1])) continue;
    grid[count++] = (grid_node){(int64_t)floor(at[0] / width), (int64_t)floor(at[1] / width), i};
  }
  qsort(grid, count, sizeof *grid, compare);
  for (size_t k = 0; k < count; k++) {
    bool met = false;
    for (int square = 0; square < 9 && !met; square++)
      met = meet_square(self, merger, grid, count, &grid[k], grid[k].x + square / 3 - 1,
                        grid[k].y + square % 3 - 1);
  }
  strut_release(grid);
  if (self->near_count)
    report_apart(self, merger, self->near[0], self->near[1],
                 distance(self, self->near[0], self->near[1]));
}

/* ---- the nodes that stay ---- */

/* The name of a port means the node behind it. */
static void name_port(strut_reader *reader, const strut_port *port) {
  if (port->node >= 0)
    strut_add_name(reader, &reader->things[STRUT_THING_NODE].names,
                   strut_scratch_text(reader, "%s%s", port->scope->prefix, port->key->text),
                   (size_t)port->node);
}

/* Is a node other than the port's own called by its name? */
static bool is_node_within(const strut_reader *reader, const strut_port *port) {
  strut_full_name full;
  snprintf(full.text, sizeof full.text, "%s%s", port->scope->prefix, port->key->text);
  int32_t node = strut_name_map_find(&reader->things[STRUT_THING_NODE].names, full.text);
  return node >= 0 && port->node >= 0 && node != port->node;
}

/* A port may show one of a copy within, which comes before it. */
static void find_ports(strut_reader *reader) {
  for (strut_port *port = reader->copies->ports; port; port = port->next) {
    strut_owner owner = {"part", port->scope->placement->part->name};
    reader->scope = port->scope;
    port->node = strut_read_reference(reader, port->key->next, "ports", owner, STRUT_THING_NODE);
    if (is_node_within(reader, port))
      strut_report_error(reader, port->key->place,
                         "port '%s' of part '%s' has the name of another node of the part",
                         port->key->text, owner.name);
    reader->scope = NULL;
    name_port(reader, port);
  }
}

/* Moves the nodes that stay together, and lets all names mean them. */
static void compact(merging *self) {
  strut_reader *reader = self->reader;
  strut_scene *scene = reader->scene;
  int32_t *index = strut_scratch_array(reader, self->count, sizeof *index);
  const char **name = strut_scratch_array(reader, self->count, sizeof *name);
  if (!index || !name) return;
  int32_t stays = 0;
  for (size_t i = 0; i < self->count; i++) {
    int32_t root = find_root(self, (int32_t)i);
    name[i] = scene->nodes[i].name;
    if (root != (int32_t)i) {
      index[i] = index[root];
      continue;
    }
    index[i] = stays;
    scene->nodes[stays] = scene->nodes[i];
    reader->things[STRUT_THING_NODE].source[stays] = reader->things[STRUT_THING_NODE].source[i];
    reader->node_moves[stays] = reader->node_moves[i];
    stays++;
  }
  scene->node_count = (size_t)stays;
  strut_name_map_free(&reader->things[STRUT_THING_NODE].names);
  for (size_t i = 0; i < self->count; i++)
    strut_add_name(reader, &reader->things[STRUT_THING_NODE].names, name[i], (size_t)index[i]);
  for (strut_port *port = reader->copies->ports; port; port = port->next) {
    if (port->node >= 0) port->node = index[port->node];
    name_port(reader, port);
  }
}

void strut_merge_nodes(strut_reader *reader) {
  const strut_merger *first = reader->copies ? reader->copies->mergers : NULL;
  merging m = {.reader = reader, .count = reader->scene->node_count};
  if (reader->copies && m.count) find_ports(reader);
  if (!first || !m.count || strut_diagnostics_full(reader->diagnostics)) return;
  m.root = strut_scratch_array(reader, m.count, sizeof *m.root);
  if (!m.root) return;
  for (size_t i = 0; i < m.count; i++) m.root[i] = (int32_t)i;
  m.size = structure_size(reader->scene);
  for (const strut_merger *merger = first; merger; merger = merger->next)
    if (merger->a)
      merge_named(&m, merger);
    else
      merge_touching(&m, merger);
  compact(&m);
}
