/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Beams that are clamped to members and to each other. The half part of a beam at a joint bends with the
 * stiffness k = 2 EI / h. Where it meets a rigid direction, that of a member or of a fixed clamp, it gets
 * the hinge k. Where ends of beams meet, each two of them get k_i k_j / (k_1 + k_2 + ...): the mesh that
 * turns as the star of all half parts about one rigid joint does. See reader.h.
 */
#include <math.h>
#include <string.h>

#include "parser/read/beams.h"

/* Ends of beams at one joint: their hinges are those of all pairs. */
enum { MOST_ENDS = 64 };

/* What an end is clamped to: a member, or an end of a beam. */
typedef struct joint_target {
  int32_t member; /* -1: a beam */
  strut_beam *beam;
  int end;
} joint_target;

bool strut_read_clamped_to(strut_reader *reader, const strut_slot *slot, strut_beam *b) {
  strut_fields fields;
  strut_owner owner = {"beam", b->name};
  if (slot->state != STRUT_GIVEN) return slot->state == STRUT_ABSENT;
  strut_read_fields(reader, STRUT_SECTION_CLAMPED_TO, slot->value, owner, &fields);
  for (int k = 0; k < 2; k++) {
    const strut_slot *end = strut_slot_of(&fields, STRUT_KEY_CLAMPED_TO_START + k);
    if (end->state != STRUT_GIVEN) continue;
    b->clamped_to[k] = end->value;
    if (!(b->clamped >> k & 1u)) continue;
    strut_report_error(reader, end->value->place,
                       "the %s of beam '%s' is clamped in a fixed direction and to '%s'; give one",
                       k ? "end" : "start", b->name,
                       strut_sanitised_text(reader, end->value->text));
    return false;
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

static bool find_target(strut_reader *reader, const strut_beam *b, int end, joint_target *target) {
  const strut_tree *value = b->clamped_to[end];
  const char *name = value->text, *which = end ? "ends" : "starts";
  const strut_node *node = &reader->scene->nodes[b->node[end]];
  *target = (joint_target){strut_find_thing(reader, STRUT_THING_MEMBER, NULL, name),
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
    strut_report_error(reader, value->place,
                       "there are a member and a beam '%s'; rename one of them", name);
  else if (target->beam == b)
    strut_report_error(reader, value->place, "beam '%s' is clamped to itself", name);
  else if (m && m->kind == STRUT_CABLE)
    strut_report_error(reader, value->place,
                       "beam '%s' is clamped to cable '%s', which has no direction of its own; "
                       "clamp it to a bar or to a beam",
                       b->name, name);
  else if (ends[0] != b->node[end] && ends[1] != b->node[end])
    strut_report_error(reader, value->place,
                       "beam '%s' %s at node '%s', which is no end of %s '%s'", b->name, which,
                       node->name, m ? "member" : "beam", name);
  else
    return true;
  return false;
}

/* Stiffness of the half part at an end. */
static double half_stiffness(const strut_reader *reader, const strut_beam *b) {
  return 2.0 * b->bending_stiffness / strut_beam_part_length(reader, b);
}

/* The node next to an end. */
static int32_t inner_node(const strut_beam *b, int end) {
  return strut_beam_node(b, end ? b->parts - 1 : 1);
}

/* All ends of beams: end k of beam i is number 2 i + k. */
typedef struct joints {
  strut_reader *reader;
  int32_t *parent;      /* union-find: equal roots are one joint */
  int32_t *rigid;       /* of a root: the node that gives the rigid direction; -1: there is none */
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

static bool make_joints(strut_reader *reader, joints *j) {
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
    joint_target to;
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

static void add_hinge(const joints *j, int32_t end, int32_t other_node, const char *other,
                      double stiffness, double time) {
  strut_beam *b = beam_of(j, end);
  const char *name =
      strut_arena_format(&j->reader->scene->arena, "%s.%s%s%s", b->name, end % 2 ? "end" : "start",
                         other ? "." : "", other ? other : "");
  const int32_t node[3] = {other_node, b->node[end % 2], inner_node(b, end % 2)};
  if (!name) j->reader->out_of_memory = true;
  if (!name || b->broken) return;
  strut_add_beam_hinge(j->reader, b, name, node, stiffness, time * stiffness, (double)NAN);
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
  add_hinge(j, own, inner_node(q, other % 2), further, k * l / sum, time);
}

static void add_joint(const joints *j, int32_t root) {
  double sum = 0.0;
  for (int32_t e = root; e >= 0; e = j->next[e]) sum += half_stiffness(j->reader, beam_of(j, e));
  for (int32_t e = root; e >= 0; e = j->next[e]) {
    const strut_beam *b = beam_of(j, e);
    if (j->rigid[root] >= 0 && j->target[e] >= 0)
      add_hinge(j, e, j->rigid[root], NULL, half_stiffness(j->reader, b), b->damping);
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

void strut_add_joint_hinges(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  joints j;
  size_t more = 0;
  bool any = false;
  for (size_t i = 0; i < reader->beam_count; i++)
    any = any || reader->beams[i].clamped_to[0] || reader->beams[i].clamped_to[1];
  if (!any || !make_joints(reader, &j)) return;
  join_all(&j);
  for (int32_t e = 0; e < 2 * (int32_t)reader->beam_count; e++)
    if (root_of(&j, e) == e) more += count_hinges(&j, e);
  scene->hinges = strut_lengthen(reader, &scene->arena, scene->hinges, scene->hinge_count, more,
                                 sizeof *scene->hinges);
  reader->things[STRUT_THING_HINGE].source =
      strut_lengthen(reader, &reader->scratch, reader->things[STRUT_THING_HINGE].source,
                     scene->hinge_count, more, sizeof *reader->things[STRUT_THING_HINGE].source);
  if (!scene->hinges || !reader->things[STRUT_THING_HINGE].source || reader->failed) return;
  for (int32_t e = 0; e < 2 * (int32_t)reader->beam_count; e++)
    if (root_of(&j, e) == e) add_joint(&j, e);
}
