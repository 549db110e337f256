/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Beams: each becomes nodes, bars and hinges of the scene, as if the file had listed them. See reader.h.
 *
 * With parts of the length h, a hinge between two parts has the stiffness EI / h, and one between a part
 * and a clamp 2 EI / h: half a part bends. The deflection of a cantilever then converges with the square
 * of the number of parts.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/read/reader.h"

/* Ends that are clamped to members and to other beams, see below. */
static bool read_clamped_to(strut_reader *reader, const strut_slot *slot, strut_beam *b);
static void add_coupling_hinges(strut_reader *reader);

/* Node k of the beam, from 0 to its number of parts. */
static int32_t node_of(const strut_beam *b, int32_t k) {
  return k == 0 ? b->node[0] : k == b->parts ? b->node[1] : b->first_node + k - 1;
}

enum { THINGS_OF_PART = 3 }; /* a node, a bar and a hinge */

enum { CLAMPED_START = 1, CLAMPED_END = 2 }; /* the words of the key, as bits */

static size_t count_clamps(const strut_beam *b) {
  return (size_t)(b->clamped & 1u) + (size_t)(b->clamped >> 1);
}

static double part_length(const strut_reader *reader, const strut_beam *b) {
  const strut_node *nodes = reader->scene->nodes;
  return strut_distance(nodes[b->node[0]].position, nodes[b->node[1]].position) / (double)b->parts;
}

/* "rod.3" */
static const char *part_name(strut_reader *reader, const strut_beam *b, size_t part) {
  const char *name = strut_arena_format(&reader->scene->arena, "%s.%zu", b->name, part);
  if (!name) reader->out_of_memory = true;
  return name ? name : "";
}

static const char *clamp_name(strut_reader *reader, const strut_beam *b, bool end) {
  const char *name =
      strut_arena_format(&reader->scene->arena, "%s.%s", b->name, end ? "end" : "start");
  if (!name) reader->out_of_memory = true;
  return name ? name : "";
}

/* A thing of the beam; NULL where its name is taken, which is reported once for the beam. */
static void *add_thing(strut_reader *reader, strut_beam *b, strut_thing kind, const char *name) {
  if (strut_name_map_find(&reader->things[kind].names, name) < 0)
    return strut_add_thing(reader, kind, b->key, name);
  if (!b->broken)
    strut_report_error(reader, b->key->place,
                       "beam '%s' makes a %s '%s', but there is another one; rename one of them",
                       b->name, strut_thing_at(kind)->word, name);
  b->broken = reader->ends_unknown = true;
  return NULL;
}

/* Ends that are known and apart, and held where they are clamped. */
static bool check_ends(strut_reader *reader, const strut_tree *key, const strut_slot *clamped,
                       const strut_beam *b) {
  const strut_node *nodes = reader->scene->nodes;
  for (int k = 0; k < 2; k++) {
    const strut_node *end = &nodes[b->node[k]];
    if (!(b->clamped >> k & 1u) || (end->fixed[0] && end->fixed[1])) continue;
    return strut_report_error(
        reader, clamped->value->place,
        "beam '%s' is clamped at node '%s', which is not fixed; write fixed: both "
        "for it, or join the beam to another by a hinge",
        b->name, end->name);
  }
  double length = part_length(reader, b);
  if (length > 0.0) return true;
  if (!isnan(length))
    strut_report_error(reader, key->place,
                       "nodes '%s' and '%s' are drawn in one place, so beam '%s' has no direction",
                       nodes[b->node[0]].name, nodes[b->node[1]].name, b->name);
  return false;
}

static bool read_beam(strut_reader *reader, const strut_tree *key, strut_beam *b) {
  strut_owner owner = {"beam", key->text};
  bool fine = strut_read_name(reader, key, "beam");
  strut_fields fields;
  *b = (strut_beam){.name = strut_keep_text(reader, key->text),
                    .key = key,
                    .node = {-1, -1},
                    .parts = STRUT_USUAL_PARTS};
  strut_read_fields_of(reader, STRUT_SECTION_BEAM, key, owner, &fields);
  strut_require(reader, &fields, owner, key->place);
  fine = strut_store(reader, &fields, owner, b) && fine;
  const strut_slot *clamped = strut_slot_of(&fields, STRUT_KEY_BEAM_CLAMPED);
  fine = read_clamped_to(reader, strut_slot_of(&fields, STRUT_KEY_BEAM_CLAMPED_TO), b) && fine;
  return fine && !fields.broken && check_ends(reader, key, clamped, b);
}

/* A node of the beam, at the share s of its length; held: the end that it is the clamp of, or -1. */
static void add_node(strut_reader *reader, strut_beam *b, const char *name, double s,
                     int32_t held) {
  strut_scene *scene = reader->scene;
  const double *from = scene->nodes[b->node[0]].position, *to = scene->nodes[b->node[1]].position;
  size_t i = scene->node_count;
  strut_node *node = add_thing(reader, b, STRUT_THING_NODE, name);
  if (!node) return;
  node->fixed[0] = node->fixed[1] = held >= 0;
  if (held >= 0) reader->node_moves[i] = reader->node_moves[held]; /* a clamp moves with its end */
  for (int d = 0; d < 2; d++) node->position[d] = node->start[d] = from[d] + s * (to[d] - from[d]);
}

static void add_nodes(strut_reader *reader, strut_beam *b) {
  double parts = (double)b->parts;
  b->first_node = (int32_t)reader->scene->node_count;
  for (int32_t k = 1; k < b->parts && !b->broken; k++)
    add_node(reader, b, part_name(reader, b, (size_t)k), k / parts, -1);
  b->clamp_node[0] = (int32_t)reader->scene->node_count;
  if (b->clamped & CLAMPED_START && !b->broken)
    add_node(reader, b, clamp_name(reader, b, false), -1.0 / parts, b->node[0]);
  b->clamp_node[1] = (int32_t)reader->scene->node_count;
  if (b->clamped & CLAMPED_END && !b->broken)
    add_node(reader, b, clamp_name(reader, b, true), 1.0 + 1.0 / parts, b->node[1]);
}

void strut_read_beams(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_BEAMS);
  size_t parts = 0, clamps = 0;
  if (!map || !scene->nodes) return;
  reader->beams =
      strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *reader->beams);
  for (const strut_tree *key = strut_first_entry(reader, map); key && reader->beams;
       key = strut_following_entry(reader, key)) {
    strut_beam *b = &reader->beams[reader->beam_count];
    if (!read_beam(reader, key, b)) {
      reader->ends_unknown = true;
      continue;
    }
    parts += (size_t)b->parts, clamps += count_clamps(b);
    reader->beam_count++;
  }
  double most = floor(reader->limit_things / THINGS_OF_PART);
  if ((double)parts > most) {
    strut_report_error(reader, map->place, "the beams have %zu parts, at most %.0f are possible%s",
                       parts, most, strut_limit_hint(reader));
    reader->ends_unknown = true;
    reader->beam_count = 0;
  }
  if (!reader->beam_count || strut_diagnostics_full(reader->diagnostics)) return;
  const strut_tree **moves = strut_reader_allocate(
      reader, &reader->scratch, scene->node_count + parts + clamps, sizeof *moves);
  if (!moves || !strut_reserve_things(reader, STRUT_THING_NODE, parts + clamps)) return;
  memcpy(moves, reader->node_moves, scene->node_count * sizeof *moves);
  reader->node_moves = moves;
  for (size_t i = 0; i < reader->beam_count; i++) add_nodes(reader, &reader->beams[i]);
}

static size_t count_parts(const strut_reader *reader) {
  size_t parts = 0;
  for (size_t i = 0; i < reader->beam_count; i++) parts += (size_t)reader->beams[i].parts;
  return parts;
}

static void add_part(strut_reader *reader, strut_beam *b, int32_t k) {
  strut_member *m = add_thing(reader, b, STRUT_THING_MEMBER, part_name(reader, b, (size_t)k));
  if (!m) return;
  m->node[0] = node_of(b, k - 1), m->node[1] = node_of(b, k);
  m->axial_stiffness = b->axial_stiffness;
  m->damping = b->damping * b->axial_stiffness / part_length(reader, b);
  m->mass = b->mass / (double)b->parts;
}

void strut_add_beam_members(strut_reader *reader) {
  size_t parts = count_parts(reader);
  if (!parts || !strut_reserve_things(reader, STRUT_THING_MEMBER, parts)) return;
  for (size_t i = 0; i < reader->beam_count; i++) {
    strut_beam *b = &reader->beams[i];
    for (int32_t k = 1; k <= b->parts && !b->broken; k++) add_part(reader, b, k);
  }
}

static void put_hinge(strut_reader *reader, strut_beam *b, const char *name, const int32_t node[3],
                      double stiffness, double damping, double rest_angle) {
  strut_hinge *h = add_thing(reader, b, STRUT_THING_HINGE, name);
  if (!h) return;
  for (int k = 0; k < 3; k++) h->node[k] = node[k];
  h->stiffness = stiffness;
  h->damping = damping;
  h->rest_angle = rest_angle;
}

/* A hinge that is straight at rest; `parts`: of those that meet there, as many as bend. */
static void add_hinge(strut_reader *reader, strut_beam *b, const char *name, const int32_t node[3],
                      double parts) {
  double stiffness = b->bending_stiffness / (parts * part_length(reader, b));
  put_hinge(reader, b, name, node, stiffness, b->damping * stiffness, STRUT_PI);
}

static void add_hinges(strut_reader *reader, strut_beam *b) {
  for (int32_t k = 1; k < b->parts && !b->broken; k++) {
    const int32_t node[3] = {node_of(b, k - 1), node_of(b, k), node_of(b, k + 1)};
    add_hinge(reader, b, part_name(reader, b, (size_t)k), node, 1.0);
  }
  const int32_t start[3] = {b->clamp_node[0], b->node[0], node_of(b, 1)};
  const int32_t end[3] = {node_of(b, b->parts - 1), b->node[1], b->clamp_node[1]};
  if (b->clamped & CLAMPED_START && !b->broken)
    add_hinge(reader, b, clamp_name(reader, b, false), start, 0.5);
  if (b->clamped & CLAMPED_END && !b->broken)
    add_hinge(reader, b, clamp_name(reader, b, true), end, 0.5);
}

void strut_add_beam_hinges(strut_reader *reader) {
  size_t most = count_parts(reader) + 2 * reader->beam_count;
  if (!reader->beam_count || !strut_reserve_things(reader, STRUT_THING_HINGE, most)) return;
  for (size_t i = 0; i < reader->beam_count; i++) add_hinges(reader, &reader->beams[i]);
  add_coupling_hinges(reader);
}

/* ---- ends that are clamped to members and to other beams ---- */

/* Ends of beams at one joint: their hinges are those of all pairs. */
enum { MOST_ENDS = 64 };

/* What an end is clamped to: a member, or an end of a beam. */
typedef struct coupling_target {
  int32_t member; /* -1: a beam */
  strut_beam *beam;
  int end;
} coupling_target;

static bool read_clamped_to(strut_reader *reader, const strut_slot *slot, strut_beam *b) {
  strut_fields fields;
  strut_owner owner = {"beam", b->name};
  if (slot->state != STRUT_GIVEN) return slot->state == STRUT_ABSENT;
  strut_read_object(reader, STRUT_SECTION_CLAMPED_TO, slot->value, owner, &fields, b);
  for (int k = 0; k < 2; k++) {
    const strut_tree *end = b->clamped_to[k];
    if (!end || !(b->clamped >> k & 1u)) continue;
    return strut_report_error(
        reader, end->place,
        "the %s of beam '%s' is clamped in a fixed direction and to '%s'; give one",
        k ? "end" : "start", b->name, strut_sanitised_text(reader, end->text));
  }
  return !fields.broken;
}

static strut_beam *find_beam(const strut_reader *reader, const char *name) {
  for (size_t i = 0; i < reader->beam_count; i++)
    if (strcmp(strut_local_name(reader, reader->beams[i].name), name) == 0)
      return &reader->beams[i];
  return NULL;
}

static const char *target_name(const void *context, size_t i) {
  const strut_reader *reader = context;
  const strut_scene *scene = reader->scene;
  if (i < scene->member_count) return scene->members[i].name;
  i -= scene->member_count;
  return i < reader->beam_count ? reader->beams[i].name : NULL;
}

static bool find_target(strut_reader *reader, const strut_beam *b, int end,
                        coupling_target *target) {
  const strut_tree *value = b->clamped_to[end];
  const char *name = value->text, *which = end ? "ends" : "starts";
  const strut_node *node = &reader->scene->nodes[b->node[end]];
  *target = (coupling_target){strut_find_thing(reader, STRUT_THING_MEMBER, NULL, name),
                              find_beam(reader, name), 0};
  const strut_member *m = target->member >= 0 ? &reader->scene->members[target->member] : NULL;
  const int32_t *ends = m ? m->node : target->beam ? target->beam->node : NULL;
  if (!ends) {
    if (!reader->ends_unknown)
      strut_report_error(reader, value->place, "unknown member or beam '%s'%s",
                         strut_sanitised_text(reader, name),
                         strut_hint(reader, name, target_name, reader,
                                    reader->scene->member_count + reader->beam_count));
    return false;
  }
  target->end = ends[1] == b->node[end];
  if (m && target->beam)
    return strut_report_error(reader, value->place,
                              "there are a member and a beam '%s'; rename one of them", name);
  if (target->beam == b)
    return strut_report_error(reader, value->place, "beam '%s' is clamped to itself", name);
  if (m && m->kind == STRUT_CABLE)
    return strut_report_error(
        reader, value->place,
        "beam '%s' is clamped to cable '%s', which has no direction of its own; "
        "clamp it to a bar or to a beam",
        b->name, name);
  if (ends[0] != b->node[end] && ends[1] != b->node[end])
    return strut_report_error(reader, value->place,
                              "beam '%s' %s at node '%s', which is no end of %s '%s'", b->name,
                              which, node->name, m ? "member" : "beam", name);
  return true;
}

/* Stiffness of the half part at an end. */
static double half_stiffness(const strut_reader *reader, const strut_beam *b) {
  return 2.0 * b->bending_stiffness / part_length(reader, b);
}

/* The node next to an end. */
static int32_t inner_node(const strut_beam *b, int end) {
  return node_of(b, end ? b->parts - 1 : 1);
}

/* All ends of beams: end k of beam i is number 2 i + k. */
typedef struct joints {
  strut_reader *reader;
  int32_t *parent;      /* union-find: equal roots are one joint */
  int32_t *rigid;       /* of a root: the node that gives the rigid direction, or -1 */
  int32_t *target;      /* the end that this one is clamped to, or -1 */
  int32_t *next, *last; /* of a joint's ends; the root is the first */
} joints;

static strut_beam *beam_of(const joints *j, int32_t end) { return &j->reader->beams[end / 2]; }

static int32_t root_of(const joints *j, int32_t end) {
  while (j->parent[end] != end) end = j->parent[end] = j->parent[j->parent[end]];
  return end;
}

/* The lesser number becomes the root, so that names follow the order of the file. */
static void join(const joints *j, int32_t a, int32_t b) {
  a = root_of(j, a), b = root_of(j, b);
  int32_t root = a < b ? a : b, other = a < b ? b : a;
  if (a == b) return;
  j->parent[other] = root;
  if (j->rigid[root] < 0) j->rigid[root] = j->rigid[other];
}

static bool make_couplings(strut_reader *reader, joints *j) {
  size_t ends = 2 * reader->beam_count;
  int32_t **arrays[] = {&j->parent, &j->rigid, &j->target, &j->next, &j->last};
  j->reader = reader;
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
    *arrays[i] = strut_reader_allocate(reader, &reader->scratch, ends, sizeof(int32_t));
    if (!*arrays[i]) return false;
  }
  for (int32_t e = 0; e < (int32_t)ends; e++) {
    const strut_beam *b = beam_of(j, e);
    j->parent[e] = j->last[e] = e;
    j->rigid[e] = b->clamped >> (e % 2) & 1u ? b->clamp_node[e % 2] : -1;
    j->target[e] = j->next[e] = -1;
  }
  return true;
}

/* Resolves what ends are clamped to. */
static void join_all(const joints *j) {
  strut_reader *reader = j->reader;
  for (int32_t e = 0; e < 2 * (int32_t)reader->beam_count; e++) {
    strut_beam *b = beam_of(j, e);
    coupling_target to;
    if (b->broken || !b->clamped_to[e % 2]) continue;
    strut_enter_scope(reader, b->key);
    bool found = find_target(reader, b, e % 2, &to);
    reader->scope = NULL;
    if (!found) {
      b->broken = reader->ends_unknown = true;
      continue;
    }
    if (to.member >= 0) {
      j->rigid[root_of(j, e)] = reader->scene->members[to.member].node[1 - to.end];
      j->target[e] = e;
      continue;
    }
    j->target[e] = 2 * (int32_t)(to.beam - reader->beams) + to.end;
    join(j, e, j->target[e]);
  }
  for (int32_t e = 0; e < 2 * (int32_t)reader->beam_count; e++) {
    int32_t root = root_of(j, e);
    if (root == e) continue;
    j->next[j->last[root]] = e;
    j->last[root] = e;
  }
}

static void add_coupling_hinge(const joints *j, int32_t end, int32_t other_node, const char *other,
                               double stiffness, double time) {
  strut_beam *b = beam_of(j, end);
  const char *name =
      strut_arena_format(&j->reader->scene->arena, "%s.%s%s%s", b->name, end % 2 ? "end" : "start",
                         other ? "." : "", other ? other : "");
  const int32_t node[3] = {other_node, b->node[end % 2], inner_node(b, end % 2)};
  if (!name) j->reader->out_of_memory = true;
  if (!name || b->broken) return;
  put_hinge(j->reader, b, name, node, stiffness, time * stiffness, (double)NAN);
}

/* Between ends that are clamped to each other, and without a rigid direction. */
static void add_pair(const joints *j, int32_t a, int32_t b, double sum) {
  bool turned = j->target[a] != b && j->target[b] == a;
  int32_t own = turned ? b : a, other = turned ? a : b;
  const strut_beam *p = beam_of(j, own), *q = beam_of(j, other);
  double k = half_stiffness(j->reader, p), l = half_stiffness(j->reader, q);
  const char *further = j->target[own] == other ? NULL : q->name;
  /* the dampings in a row, for slow motions */
  double time = (p->damping / k + q->damping / l) / (1.0 / k + 1.0 / l);
  add_coupling_hinge(j, own, inner_node(q, other % 2), further, k * l / sum, time);
}

static void add_coupling(const joints *j, int32_t root) {
  double sum = 0.0;
  for (int32_t e = root; e >= 0; e = j->next[e]) sum += half_stiffness(j->reader, beam_of(j, e));
  for (int32_t e = root; e >= 0; e = j->next[e]) {
    const strut_beam *b = beam_of(j, e);
    if (j->rigid[root] >= 0 && j->target[e] >= 0)
      add_coupling_hinge(j, e, j->rigid[root], NULL, half_stiffness(j->reader, b), b->damping);
    for (int32_t other = j->next[e]; other >= 0 && j->rigid[root] < 0; other = j->next[other])
      add_pair(j, e, other, sum);
  }
}

/* The number of hinges of a joint; 0: there are too many, which is reported. */
static size_t count_hinges(const joints *j, int32_t root) {
  size_t ends = 0;
  for (int32_t e = root; e >= 0; e = j->next[e]) ends++;
  if (j->rigid[root] >= 0) return ends;
  if (ends <= MOST_ENDS) return ends * (ends - 1) / 2;
  strut_report_error(j->reader, beam_of(j, root)->key->place,
                     "%zu beams are clamped to each other at node '%s', at most %d may be; clamp "
                     "them to a stiff bar",
                     ends, j->reader->scene->nodes[beam_of(j, root)->node[root % 2]].name,
                     (int)MOST_ENDS);
  return 0;
}

static void add_coupling_hinges(strut_reader *reader) {
  joints j;
  size_t more = 0;
  bool any = false;
  for (size_t i = 0; i < reader->beam_count; i++)
    any = any || reader->beams[i].clamped_to[0] || reader->beams[i].clamped_to[1];
  if (!any || !make_couplings(reader, &j)) return;
  join_all(&j);
  for (int32_t e = 0; e < 2 * (int32_t)reader->beam_count; e++)
    if (root_of(&j, e) == e) more += count_hinges(&j, e);
  if (reader->failed || !strut_reserve_things(reader, STRUT_THING_HINGE, more)) return;
  for (int32_t e = 0; e < 2 * (int32_t)reader->beam_count; e++)
    if (root_of(&j, e) == e) add_coupling(&j, e);
}
