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
#include "parser/read/beams.h"

enum { THINGS_OF_PART = 3 }; /* a node, a bar and a hinge */

enum { CLAMPED_START = 1, CLAMPED_END = 2 }; /* the words of the key, as bits */

static size_t count_clamps(const strut_beam *b) {
  return (size_t)(b->clamped & 1u) + (size_t)(b->clamped >> 1);
}

double strut_beam_part_length(const strut_reader *reader, const strut_beam *b) {
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

/* Is the name free? If not, that is reported once for the beam. */
static bool claim_name(strut_reader *reader, strut_beam *b, const char *kind, strut_name_map *map,
                       const char *name, size_t index) {
  if (strut_name_map_find(map, name) < 0) {
    strut_add_name(reader, map, name, index);
    return true;
  }
  if (!b->broken)
    strut_report_error(reader, b->key->place,
                       "beam '%s' makes a %s '%s', but there is another one; rename one of them",
                       b->name, kind, name);
  b->broken = reader->ends_unknown = true;
  return false;
}

void *strut_lengthen(strut_reader *reader, strut_arena *arena, const void *old, size_t count,
                     size_t more, size_t size) {
  void *array = strut_reader_allocate(reader, arena, count + more, size);
  if (array && count) memcpy(array, old, count * size);
  return array;
}

/* Ends that are known and apart, and held where they are clamped. */
static bool check_ends(strut_reader *reader, const strut_tree *key, const strut_slot *clamped,
                       const strut_beam *b) {
  const strut_node *nodes = reader->scene->nodes;
  for (int k = 0; k < 2; k++) {
    const strut_node *end = &nodes[b->node[k]];
    if (!(b->clamped >> k & 1u) || (end->fixed[0] && end->fixed[1])) continue;
    strut_report_error(reader, clamped->value->place,
                       "beam '%s' is clamped at node '%s', which is not fixed; write fixed: both "
                       "for it, or join the beam to another by a hinge",
                       b->name, end->name);
    return false;
  }
  double length = strut_beam_part_length(reader, b);
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
  fine = strut_store_fields(reader, &fields, owner, &reader->scratch, b, sizeof *b) && fine;
  const strut_slot *clamped = strut_slot_of(&fields, STRUT_KEY_BEAM_CLAMPED);
  fine =
      strut_read_clamped_to(reader, strut_slot_of(&fields, STRUT_KEY_BEAM_CLAMPED_TO), b) && fine;
  return fine && !fields.broken && check_ends(reader, key, clamped, b);
}

/* A node of the beam, at the share s of its length; held: the end that it is the clamp of, or -1. */
static void add_node(strut_reader *reader, strut_beam *b, const char *name, double s,
                     int32_t held) {
  strut_scene *scene = reader->scene;
  const double *from = scene->nodes[b->node[0]].position, *to = scene->nodes[b->node[1]].position;
  size_t i = scene->node_count;
  if (!claim_name(reader, b, "node", &reader->things[STRUT_THING_NODE].names, name, i)) return;
  strut_node *node = &scene->nodes[i];
  *node = strut_node_default();
  node->name = name;
  node->fixed[0] = node->fixed[1] = held >= 0;
  if (held >= 0) reader->node_moves[i] = reader->node_moves[held]; /* a clamp moves with its end */
  for (int d = 0; d < 2; d++) node->position[d] = node->start[d] = from[d] + s * (to[d] - from[d]);
  reader->things[STRUT_THING_NODE].source[i] = (strut_source){b->key, b->key->next, false};
  scene->node_count++;
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
  scene->nodes = strut_lengthen(reader, &scene->arena, scene->nodes, scene->node_count,
                                parts + clamps, sizeof *scene->nodes);
  reader->things[STRUT_THING_NODE].source = strut_lengthen(
      reader, &reader->scratch, reader->things[STRUT_THING_NODE].source, scene->node_count,
      parts + clamps, sizeof *reader->things[STRUT_THING_NODE].source);
  reader->node_moves =
      strut_lengthen(reader, &reader->scratch, reader->node_moves, scene->node_count,
                     parts + clamps, sizeof *reader->node_moves);
  if (!scene->nodes || !reader->things[STRUT_THING_NODE].source || !reader->node_moves) return;
  for (size_t i = 0; i < reader->beam_count; i++) add_nodes(reader, &reader->beams[i]);
}

static size_t count_parts(const strut_reader *reader) {
  size_t parts = 0;
  for (size_t i = 0; i < reader->beam_count; i++) parts += (size_t)reader->beams[i].parts;
  return parts;
}

static void add_part(strut_reader *reader, strut_beam *b, int32_t k) {
  strut_scene *scene = reader->scene;
  size_t i = scene->member_count;
  const char *name = part_name(reader, b, (size_t)k);
  if (!claim_name(reader, b, "member", &reader->things[STRUT_THING_MEMBER].names, name, i)) return;
  strut_member *m = &scene->members[i];
  *m = strut_member_default();
  m->name = name;
  m->node[0] = strut_beam_node(b, k - 1), m->node[1] = strut_beam_node(b, k);
  m->axial_stiffness = b->axial_stiffness;
  m->damping = b->damping * b->axial_stiffness / strut_beam_part_length(reader, b);
  m->mass = b->mass / (double)b->parts;
  reader->things[STRUT_THING_MEMBER].source[i] = (strut_source){b->key, b->key->next, false};
  scene->member_count++;
}

void strut_add_beam_members(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  size_t parts = count_parts(reader);
  if (!parts) return;
  scene->members = strut_lengthen(reader, &scene->arena, scene->members, scene->member_count, parts,
                                  sizeof *scene->members);
  reader->things[STRUT_THING_MEMBER].source =
      strut_lengthen(reader, &reader->scratch, reader->things[STRUT_THING_MEMBER].source,
                     scene->member_count, parts, sizeof *reader->things[STRUT_THING_MEMBER].source);
  for (size_t i = 0;
       i < reader->beam_count && scene->members && reader->things[STRUT_THING_MEMBER].source; i++) {
    strut_beam *b = &reader->beams[i];
    for (int32_t k = 1; k <= b->parts && !b->broken; k++) add_part(reader, b, k);
  }
}

void strut_add_beam_hinge(strut_reader *reader, strut_beam *b, const char *name,
                          const int32_t node[3], double stiffness, double damping,
                          double rest_angle) {
  strut_scene *scene = reader->scene;
  size_t i = scene->hinge_count;
  if (!claim_name(reader, b, "hinge", &reader->things[STRUT_THING_HINGE].names, name, i)) return;
  strut_hinge *h = &scene->hinges[i];
  *h = strut_hinge_default();
  h->name = name;
  for (int k = 0; k < 3; k++) h->node[k] = node[k];
  h->stiffness = stiffness;
  h->damping = damping;
  h->rest_angle = rest_angle;
  reader->things[STRUT_THING_HINGE].source[i] = (strut_source){b->key, b->key->next, false};
  scene->hinge_count++;
}

/* A hinge that is straight at rest; `parts`: of those that meet there, as many as bend. */
static void add_hinge(strut_reader *reader, strut_beam *b, const char *name, const int32_t node[3],
                      double parts) {
  double stiffness = b->bending_stiffness / (parts * strut_beam_part_length(reader, b));
  strut_add_beam_hinge(reader, b, name, node, stiffness, b->damping * stiffness, STRUT_PI);
}

static void add_hinges(strut_reader *reader, strut_beam *b) {
  for (int32_t k = 1; k < b->parts && !b->broken; k++) {
    const int32_t node[3] = {strut_beam_node(b, k - 1), strut_beam_node(b, k),
                             strut_beam_node(b, k + 1)};
    add_hinge(reader, b, part_name(reader, b, (size_t)k), node, 1.0);
  }
  const int32_t start[3] = {b->clamp_node[0], b->node[0], strut_beam_node(b, 1)};
  const int32_t end[3] = {strut_beam_node(b, b->parts - 1), b->node[1], b->clamp_node[1]};
  if (b->clamped & CLAMPED_START && !b->broken)
    add_hinge(reader, b, clamp_name(reader, b, false), start, 0.5);
  if (b->clamped & CLAMPED_END && !b->broken)
    add_hinge(reader, b, clamp_name(reader, b, true), end, 0.5);
}

void strut_add_beam_hinges(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  size_t most = count_parts(reader) + 2 * reader->beam_count;
  if (!reader->beam_count) return;
  scene->hinges = strut_lengthen(reader, &scene->arena, scene->hinges, scene->hinge_count, most,
                                 sizeof *scene->hinges);
  reader->things[STRUT_THING_HINGE].source =
      strut_lengthen(reader, &reader->scratch, reader->things[STRUT_THING_HINGE].source,
                     scene->hinge_count, most, sizeof *reader->things[STRUT_THING_HINGE].source);
  for (size_t i = 0;
       i < reader->beam_count && scene->hinges && reader->things[STRUT_THING_HINGE].source; i++)
    add_hinges(reader, &reader->beams[i]);
  strut_add_joint_hinges(reader);
}
