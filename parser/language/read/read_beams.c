/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Beams: each becomes nodes, bars and hinges of the scene, as if the file had listed them. See reader.h.
 *
 * With parts of the length h, a hinge between two parts has the stiffness EI / h, and one between a part and a clamp 2
 * EI / h: half a part bends. The deflection of a cantilever then converges with the square of the number of parts.
 */
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/read/reader.h"

/* Ends that are clamped to members and to other beams, see below. */
static bool read_clamped_to(strut_reader *reader, const strut_slot *slot, strut_beam *beam);
static void add_coupling_hinges(strut_reader *reader);

/* Node k of the beam, from 0 to its number of parts. */
static int32_t node_of(const strut_beam *beam, int32_t k) {
  return k == 0 ? beam->node[0] : k == beam->parts ? beam->node[1] : beam->first_node + k - 1;
}

enum { THINGS_OF_PART = 3 }; /* a node, a bar and a hinge */

enum { CLAMPED_START = 1, CLAMPED_END = 2 }; /* the words of the key, as bits */

static double part_length(const strut_reader *reader, const strut_beam *beam) {
  const strut_node *nodes = reader->scene->nodes;
  return strut_distance(nodes[beam->node[0]].position, nodes[beam->node[1]].position) /
         (double)beam->parts;
}

/* "rod.3" */
static const char *part_name(strut_reader *reader, const strut_beam *beam, size_t part) {
  return strut_kept_text(reader, "%s.%zu", beam->name, part);
}

static const char *clamp_name(strut_reader *reader, const strut_beam *beam, bool end) {
  return strut_kept_text(reader, "%s.%s", beam->name, end ? "end" : "start");
}

/* A thing of the beam; NULL where its name is taken, which is reported once for the beam. */
static void *add_thing(strut_reader *reader, strut_beam *beam, strut_thing kind, const char *name) {
  if (strut_name_map_find(&reader->things[kind].names, name) < 0)
    return strut_add_thing(reader, kind, beam->key, name);
  if (!beam->broken)
    strut_report_error(reader, beam->key->place,
                       "beam '%s' makes a %s '%s', but there is another one; rename one of them",
                       beam->name, strut_thing_at(kind)->word, name);
  beam->broken = reader->ends_unknown = true;
  return NULL;
}

/* Ends that are known and apart, and held where they are clamped. */
static bool check_ends(strut_reader *reader, const strut_tree *key, const strut_slot *clamped,
                       const strut_beam *beam) {
  const strut_node *nodes = reader->scene->nodes;
  for (int k = 0; k < 2; k++) {
    const strut_node *end = &nodes[beam->node[k]];
    if (!(beam->clamped >> k & 1u) || (end->fixed[0] && end->fixed[1])) continue;
    return strut_report_error(
        reader, clamped->value->place,
        "beam '%s' is clamped at node '%s', which is not fixed; write fixed: both "
        "for it, or join the beam to another by a hinge",
        beam->name, end->name);
  }
  double length = part_length(reader, beam);
  if (length > 0.0) return true;
  if (!isnan(length))
    strut_report_error(reader, key->place,
                       "nodes '%s' and '%s' are drawn in one place, so beam '%s' has no direction",
                       nodes[beam->node[0]].name, nodes[beam->node[1]].name, beam->name);
  return false;
}

static bool read_beam(strut_reader *reader, const strut_tree *key, strut_beam *beam) {
  strut_owner owner = {"beam", key->text};
  bool fine = strut_read_name(reader, key, "beam");
  strut_fields fields;
  *beam = (strut_beam){.name = strut_keep_text(reader, key->text),
                       .key = key,
                       .node = {-1, -1},
                       .parts = STRUT_USUAL_PARTS};
  strut_read_fields_of(reader, STRUT_SECTION_BEAM, key, owner, &fields);
  strut_require(reader, &fields, key->place);
  fine = strut_store(reader, &fields, beam) && fine;
  const strut_slot *clamped = strut_slot_of(&fields, STRUT_KEY_BEAM_CLAMPED);
  fine = read_clamped_to(reader, strut_slot_of(&fields, STRUT_KEY_BEAM_CLAMPED_TO), beam) && fine;
  return fine && !fields.broken && check_ends(reader, key, clamped, beam);
}

/* A node of the beam, at the share s of its length; held: the end that it is the clamp of, or -1. */
static void add_node(strut_reader *reader, strut_beam *beam, const char *name, double s,
                     int32_t held) {
  strut_scene *scene = reader->scene;
  const double *from = scene->nodes[beam->node[0]].position,
               *to = scene->nodes[beam->node[1]].position;
  size_t i = scene->node_count;
  strut_node *node = add_thing(reader, beam, STRUT_THING_NODE, name);
  if (!node) return;
  node->fixed[0] = node->fixed[1] = held >= 0;
  if (held >= 0) reader->node_moves[i] = reader->node_moves[held]; /* a clamp moves with its end */
  for (int d = 0; d < 2; d++) node->position[d] = node->start[d] = from[d] + s * (to[d] - from[d]);
}

static void add_nodes(strut_reader *reader, strut_beam *beam) {
  double parts = (double)beam->parts;
  beam->first_node = (int32_t)reader->scene->node_count;
  for (int32_t k = 1; k < beam->parts && !beam->broken; k++)
    add_node(reader, beam, part_name(reader, beam, (size_t)k), k / parts, -1);
  beam->clamp_node[0] = (int32_t)reader->scene->node_count;
  if (beam->clamped & CLAMPED_START && !beam->broken)
    add_node(reader, beam, clamp_name(reader, beam, false), -1.0 / parts, beam->node[0]);
  beam->clamp_node[1] = (int32_t)reader->scene->node_count;
  if (beam->clamped & CLAMPED_END && !beam->broken)
    add_node(reader, beam, clamp_name(reader, beam, true), 1.0 + 1.0 / parts, beam->node[1]);
}

void strut_read_beams(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_BEAMS);
  size_t parts = 0, clamps = 0;
  if (!map || !scene->nodes) return;
  reader->beams = strut_scratch_array(reader, map->count, sizeof *reader->beams);
  STRUT_ENTRIES (reader, key, reader->beams ? map : NULL) {
    strut_beam *beam = &reader->beams[reader->beam_count];
    if (!read_beam(reader, key, beam)) {
      reader->ends_unknown = true;
      continue;
    }
    parts += (size_t)beam->parts, clamps += (beam->clamped & 1u) + (beam->clamped >> 1);
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
  const strut_tree **moves =
      strut_scratch_array(reader, scene->node_count + parts + clamps, sizeof *moves);
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

static void add_part(strut_reader *reader, strut_beam *beam, int32_t k) {
  strut_member *member =
      add_thing(reader, beam, STRUT_THING_MEMBER, part_name(reader, beam, (size_t)k));
  if (!member) return;
  member->node[0] = node_of(beam, k - 1), member->node[1] = node_of(beam, k);
  member->axial_stiffness = beam->axial_stiffness;
  member->damping = beam->damping * beam->axial_stiffness / part_length(reader, beam);
  member->mass = beam->mass / (double)beam->parts;
}

void strut_add_beam_members(strut_reader *reader) {
  size_t parts = count_parts(reader);
  if (!parts || !strut_reserve_things(reader, STRUT_THING_MEMBER, parts)) return;
  for (size_t i = 0; i < reader->beam_count; i++) {
    strut_beam *beam = &reader->beams[i];
    for (int32_t k = 1; k <= beam->parts && !beam->broken; k++) add_part(reader, beam, k);
  }
}

static void put_hinge(strut_reader *reader, strut_beam *beam, const char *name,
                      const int32_t node[3], double stiffness, double damping, double rest_angle) {
  strut_hinge *hinge = add_thing(reader, beam, STRUT_THING_HINGE, name);
  if (!hinge) return;
  for (int k = 0; k < 3; k++) hinge->node[k] = node[k];
  hinge->stiffness = stiffness;
  hinge->damping = damping;
  hinge->rest_angle = rest_angle;
}

/* A hinge that is straight at rest; `parts`: of those that meet there, as many as bend. */
static void add_hinge(strut_reader *reader, strut_beam *beam, const char *name,
                      const int32_t node[3], double parts) {
  double stiffness = beam->bending_stiffness / (parts * part_length(reader, beam));
  put_hinge(reader, beam, name, node, stiffness, beam->damping * stiffness, STRUT_PI);
}

static void add_hinges(strut_reader *reader, strut_beam *beam) {
  for (int32_t k = 1; k < beam->parts && !beam->broken; k++) {
    const int32_t node[3] = {node_of(beam, k - 1), node_of(beam, k), node_of(beam, k + 1)};
    add_hinge(reader, beam, part_name(reader, beam, (size_t)k), node, 1.0);
  }
  const int32_t start[3] = {beam->clamp_node[0], beam->node[0], node_of(beam, 1)};
  const int32_t end[3] = {node_of(beam, beam->parts - 1), beam->node[1], beam->clamp_node[1]};
  if (beam->clamped & CLAMPED_START && !beam->broken)
    add_hinge(reader, beam, clamp_name(reader, beam, false), start, 0.5);
  if (beam->clamped & CLAMPED_END && !beam->broken)
    add_hinge(reader, beam, clamp_name(reader, beam, true), end, 0.5);
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

static bool read_clamped_to(strut_reader *reader, const strut_slot *slot, strut_beam *beam) {
  strut_fields fields;
  strut_owner owner = {"beam", beam->name};
  if (slot->state != STRUT_GIVEN) return slot->state == STRUT_ABSENT;
  strut_read_object(reader, STRUT_SECTION_CLAMPED_TO, slot->value, owner, &fields, beam);
  for (int k = 0; k < 2; k++) {
    const strut_tree *end = beam->clamped_to[k];
    if (!end || !(beam->clamped >> k & 1u)) continue;
    return strut_report_error(
        reader, end->place,
        "the %s of beam '%s' is clamped in a fixed direction and to '%s'; give one",
        k ? "end" : "start", beam->name, strut_sanitised_text(reader, end->text));
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

static bool find_target(strut_reader *reader, const strut_beam *beam, int end,
                        coupling_target *target) {
  const strut_tree *value = beam->clamped_to[end];
  const char *name = value->text, *which = end ? "ends" : "starts";
  const strut_node *node = &reader->scene->nodes[beam->node[end]];
  *target = (coupling_target){strut_find_thing(reader, STRUT_THING_MEMBER, NULL, name),
                              find_beam(reader, name), 0};
  const strut_member *member = target->member >= 0 ? &reader->scene->members[target->member] : NULL;
  const int32_t *ends = member ? member->node : target->beam ? target->beam->node : NULL;
  if (!ends) {
    if (!reader->ends_unknown)
      strut_report_error(reader, value->place, "unknown member or beam '%s'%s",
                         strut_sanitised_text(reader, name),
                         strut_hint(reader, name, target_name, reader));
    return false;
  }
  target->end = ends[1] == beam->node[end];
  if (member && target->beam)
    return strut_report_error(reader, value->place,
                              "there are a member and a beam '%s'; rename one of them", name);
  if (target->beam == beam)
    return strut_report_error(reader, value->place, "beam '%s' is clamped to itself", name);
  if (member && member->kind == STRUT_CABLE)
    return strut_report_error(
        reader, value->place,
        "beam '%s' is clamped to cable '%s', which has no direction of its own; "
        "clamp it to a bar or to a beam",
        beam->name, name);
  if (ends[0] != beam->node[end] && ends[1] != beam->node[end])
    return strut_report_error(reader, value->place,
                              "beam '%s' %s at node '%s', which is no end of %s '%s'", beam->name,
                              which, node->name, member ? "member" : "beam", name);
  return true;
}

static double half_stiffness(const strut_reader *reader, const strut_beam *beam) {
  return 2.0 * beam->bending_stiffness / part_length(reader, beam);
}

static int32_t inner_node(const strut_beam *beam, int end) {
  return node_of(beam, end ? beam->parts - 1 : 1);
}

/* All ends of beams: end k of beam i is number 2 i + k. */
typedef struct joints {
  strut_reader *reader;
  int32_t *parent;      /* union-find: equal roots are one joint */
  int32_t *rigid;       /* of a root: the node that gives the rigid direction, or -1 */
  int32_t *target;      /* the end that this one is clamped to, or -1 */
  int32_t *next, *last; /* of a joint's ends; the root is the first */
} joints;

static strut_beam *beam_of(const joints *self, int32_t end) {
  return &self->reader->beams[end / 2];
}

static int32_t root_of(const joints *self, int32_t end) {
  while (self->parent[end] != end) end = self->parent[end] = self->parent[self->parent[end]];
  return end;
}

/* The lesser number becomes the root, so that names follow the order of the file. */
static void join(const joints *self, int32_t a, int32_t b) {
  a = root_of(self, a), b = root_of(self, b);
  int32_t root = a < b ? a : b, other = a < b ? b : a;
  if (a == b) return;
  self->parent[other] = root;
  if (self->rigid[root] < 0) self->rigid[root] = self->rigid[other];
}

static bool make_couplings(strut_reader *reader, joints *self) {
  size_t ends = 2 * reader->beam_count;
  int32_t **arrays[] = {&self->parent, &self->rigid, &self->target, &self->next, &self->last};
  self->reader = reader;
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
    *arrays[i] = strut_scratch_array(reader, ends, sizeof(int32_t));
    if (!*arrays[i]) return false;
  }
  for (int32_t e = 0; e < (int32_t)ends; e++) {
    const strut_beam *beam = beam_of(self, e);
    self->parent[e] = self->last[e] = e;
    self->rigid[e] = beam->clamped >> (e % 2) & 1u ? beam->clamp_node[e % 2] : -1;
    self->target[e] = self->next[e] = -1;
  }
  return true;
}

static void join_all(const joints *self) {
  strut_reader *reader = self->reader;
  for (int32_t e = 0; e < 2 * (int32_t)reader->beam_count; e++) {
    strut_beam *beam = beam_of(self, e);
    coupling_target to;
    if (beam->broken || !beam->clamped_to[e % 2]) continue;
    strut_enter_scope(reader, beam->key);
    bool found = find_target(reader, beam, e % 2, &to);
    reader->scope = NULL;
    if (!found) {
      beam->broken = reader->ends_unknown = true;
      continue;
    }
    if (to.member >= 0) {
      self->rigid[root_of(self, e)] = reader->scene->members[to.member].node[1 - to.end];
      self->target[e] = e;
      continue;
    }
    self->target[e] = 2 * (int32_t)(to.beam - reader->beams) + to.end;
    join(self, e, self->target[e]);
  }
  for (int32_t e = 0; e < 2 * (int32_t)reader->beam_count; e++) {
    int32_t root = root_of(self, e);
    if (root == e) continue;
    self->next[self->last[root]] = e;
    self->last[root] = e;
  }
}

static void add_coupling_hinge(const joints *self, int32_t end, int32_t other_node,
                               const char *other, double stiffness, double time) {
  strut_beam *beam = beam_of(self, end);
  const char *name =
      strut_kept_text(self->reader, "%s.%s%s%s", beam->name, end % 2 ? "end" : "start",
                      other ? "." : "", other ? other : "");
  const int32_t node[3] = {other_node, beam->node[end % 2], inner_node(beam, end % 2)};
  if (beam->broken) return;
  put_hinge(self->reader, beam, name, node, stiffness, time * stiffness, (double)NAN);
}

/* Between ends that are clamped to each other, and without a rigid direction. */
static void add_pair(const joints *self, int32_t a, int32_t b, double sum) {
  bool turned = self->target[a] != b && self->target[b] == a;
  int32_t own = turned ? b : a, other = turned ? a : b;
  const strut_beam *beam = beam_of(self, own), *q = beam_of(self, other);
  double k = half_stiffness(self->reader, beam), l = half_stiffness(self->reader, q);
  const char *further = self->target[own] == other ? NULL : q->name;
  /* the dampings in a row, for slow motions */
  double time = (beam->damping / k + q->damping / l) / (1.0 / k + 1.0 / l);
  add_coupling_hinge(self, own, inner_node(q, other % 2), further, k * l / sum, time);
}

static void add_coupling(const joints *self, int32_t root) {
  double sum = 0.0;
  for (int32_t e = root; e >= 0; e = self->next[e])
    sum += half_stiffness(self->reader, beam_of(self, e));
  for (int32_t e = root; e >= 0; e = self->next[e]) {
    const strut_beam *beam = beam_of(self, e);
    if (self->rigid[root] >= 0 && self->target[e] >= 0)
      add_coupling_hinge(self, e, self->rigid[root], NULL, half_stiffness(self->reader, beam),
                         beam->damping);
    for (int32_t other = self->next[e]; other >= 0 && self->rigid[root] < 0;
         other = self->next[other])
      add_pair(self, e, other, sum);
  }
}

/* The number of hinges of a joint; 0: there are too many, which is reported. */
static size_t count_hinges(const joints *self, int32_t root) {
  size_t ends = 0;
  for (int32_t e = root; e >= 0; e = self->next[e]) ends++;
  if (self->rigid[root] >= 0) return ends;
  if (ends <= MOST_ENDS) return ends * (ends - 1) / 2;
  strut_report_error(self->reader, beam_of(self, root)->key->place,
                     "%zu beams are clamped to each other at node '%s', at most %d may be; clamp "
                     "them to a stiff bar",
                     ends, self->reader->scene->nodes[beam_of(self, root)->node[root % 2]].name,
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
