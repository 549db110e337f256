/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about nodes and members, and the order of all rules. See check.h. */
#include "engine/scene/checks/check.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/name_map.h"
#include "engine/base/text.h"
#include "engine/base/vec.h"
#include "engine/scene/checks/check_rules.h"

static bool report(strut_checker *checker, strut_finding finding, const char *owner,
                   const char *format, va_list arguments) {
  strut_findings *findings = checker->findings;
  if (findings->count >= STRUT_FINDINGS_MOST) {
    findings->unstored++;
    return false;
  }
  char text[800];
  int used = owner ? snprintf(text, sizeof text, "%s ", owner) : 0;
  vsnprintf(text + used, 600, format, arguments);
  finding.message = strut_arena_text(&findings->arena, text, strlen(text));
  bool kept = finding.message && strut_grow(&findings->items, &findings->capacity, findings->count,
                                            sizeof *findings->items);
  if (kept) findings->items[findings->count++] = finding;
  if (!kept) checker->out_of_memory = true;
  return false;
}

bool strut_report_finding(strut_checker *checker, strut_subject subject, size_t index,
                          const char *key, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  report(checker, (strut_finding){subject, index, key, NULL}, NULL, format, arguments);
  va_end(arguments);
  return false;
}

bool strut_fault(strut_checker *checker, const char *key, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  report(checker, (strut_finding){checker->subject, checker->index, key, NULL}, checker->owner,
         format, arguments);
  va_end(arguments);
  return false;
}

void strut_check_begin(strut_checker *checker, strut_thing kind, size_t index) {
  checker->subject = strut_on_thing(kind), checker->index = index, checker->within = NULL;
  strut_format_name(checker->owner, strut_thing_at(kind)->word,
                    strut_thing_name(checker->scene, kind, index), index);
}

void strut_check_begin_with(strut_checker *checker, strut_subject subject, size_t index,
                            const char *owner) {
  checker->subject = subject, checker->index = index, checker->within = NULL;
  snprintf(checker->owner, sizeof checker->owner, "%s", owner);
}

static bool check_range(strut_checker *checker, const char *name, double value,
                        strut_key_limits limits) {
  const char *key = checker->within ? checker->within : name;
  char text[STRUT_LIMITS_TEXT];
  if (!isfinite(value))
    return strut_fault_of(checker, key, "the %s of %s is not a finite number", name,
                          checker->owner);
  return !strut_limits_fault(limits, value, text) ||
         strut_fault_of(checker, key, "the %s of %s %s", name, checker->owner, text);
}

bool strut_check_fields(strut_checker *checker, strut_thing_section section, const void *object,
                        const void *usual) {
  size_t count;
  const strut_field_row *rows = strut_fields_of(section, &count);
  bool valid = true;
  for (size_t i = 0; i < count; i++) {
    const strut_field *field = &rows[i].field;
    if (field->type != STRUT_FIELD_DOUBLE || field->role != STRUT_FIELD_VALUE) continue;
    const char *at = (const char *)object + field->offset;
    strut_key_limits limits = rows[i].limits;
    double value;
    if (usual && rows[i].need == STRUT_OPTIONAL) {
      const char *other = (const char *)usual + field->offset;
      if (memcmp(at, other, sizeof value) == 0) continue; /* not given */
      memcpy(&value, other, sizeof value);
      if (value == 0.0 && limits.range == STRUT_RANGE_ABOVE_ZERO)
        limits.range = STRUT_RANGE_NOT_NEGATIVE;
    }
    memcpy(&value, at, sizeof value);
    if (strut_field_is_chosen(field, object))
      valid = check_range(checker, rows[i].name, value, limits) && valid;
  }
  return valid;
}

bool strut_check_thing(strut_checker *checker) {
  strut_thing kind = (strut_thing)checker->subject;
  return strut_check_fields(checker, (strut_thing_section)kind,
                            strut_thing_object(checker->scene, kind, checker->index),
                            strut_thing_at(kind)->usual);
}

bool strut_check_number(strut_checker *checker, strut_thing_section section, const char *key,
                        double value) {
  size_t count, i = 0;
  const strut_field_row *rows = strut_fields_of(section, &count);
  while (i < count && strcmp(rows[i].name, key) != 0) i++;
  assert(i < count);
  return check_range(checker, key, value, rows[i].limits);
}

/*
 * Called for every item of a scene, so without snprintf: that took 5 % of the reading time of a
 * large one.
 */
const char *strut_format_name(char buffer[200], const char *kind, const char *name, size_t index) {
  enum { KIND_MOST = 40, NAME_MOST = 150 };
  if (!name || !*name) {
    snprintf(buffer, 200, "%s number %zu", kind, index + 1);
    return buffer;
  }
  size_t kinds = strnlen(kind, KIND_MOST), names = strnlen(name, NAME_MOST);
  memcpy(buffer, kind, kinds);
  memcpy(buffer + kinds, " '", 2);
  memcpy(buffer + kinds + 2, name, names);
  memcpy(buffer + kinds + 2 + names, "'", 2);
  return buffer;
}

static void check_name(strut_checker *checker, strut_name_map *map, strut_thing kind, size_t i) {
  const char *name = strut_thing_name(checker->scene, kind, i), *word = strut_thing_at(kind)->word;
  bool named = name && *name;
  int32_t first = named ? strut_name_map_add(map, name, (int32_t)i) : -1;
  if (!named)
    strut_report_finding(checker, strut_on_thing(kind), i, NULL, "%s number %zu has no name", word,
                         i + 1);
  if (first >= 0)
    strut_report_finding(checker, strut_on_thing(kind), i, NULL, "there are two %ss '%s'", word,
                         name);
  if (first == -2) checker->out_of_memory = true;
}

/* Names of contacts are made, and a signal needs none; a `ground` has "". */
static bool is_named(const strut_scene *scene, strut_thing kind, size_t i) {
  if (kind == STRUT_THING_CONTACT || kind == STRUT_THING_GROUND) return false;
  return kind != STRUT_THING_SIGNAL || scene->signals[i].name;
}

static void check_all_names(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  for (int k = 0; k < STRUT_THING_COUNT; k++) {
    strut_thing kind = (strut_thing)k;
    strut_name_map names = {0};
    size_t count = strut_thing_count(scene, kind);
    if (count && !strut_name_map_reserve(&names, count)) checker->out_of_memory = true;
    for (size_t i = 0; i < count; i++)
      if (is_named(scene, kind, i)) check_name(checker, &names, kind, i);
    strut_name_map_free(&names);
  }
}

/* Beyond it squares of distances have no number [m]. */
static const double FARTHEST = 1e150;

static void check_all_nodes(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  if (!scene->node_count)
    strut_report_finding(checker, STRUT_ON_SCENE, 0, "nodes", "the scene has no nodes");
  for (size_t i = 0; i < scene->node_count; i++) {
    const strut_node *node = &scene->nodes[i];
    strut_check_begin(checker, STRUT_THING_NODE, i);
    strut_check_thing(checker);
    const struct {
      const char *key, *what;
      const double *at;
    } places[] = {{"position", "position", node->position},
                  {"start", "start position", node->start}};
    for (size_t k = 0; k < 2; k++) {
      double away = fmax(fabs(places[k].at[0]), fabs(places[k].at[1]));
      bool finite = isfinite(places[k].at[0]) && isfinite(places[k].at[1]);
      if (finite && away <= FARTHEST) continue;
      if (finite)
        strut_fault_of(checker, places[k].key, "the %s of %s is more than %g m away",
                       places[k].what, checker->owner, FARTHEST);
      else
        strut_fault_of(checker, places[k].key, "the %s of %s is not finite", places[k].what,
                       checker->owner);
      break;
    }
    for (size_t c = 0; c < 2; c++) {
      if (!isfinite(node->velocity[c]))
        strut_fault_of(checker, "velocity", "the velocity of %s is not finite", checker->owner);
      else if (node->fixed[c] && node->velocity[c] != 0.0)
        strut_fault(checker, "velocity", "is fixed in %c and cannot have a velocity there",
                    "xy"[c]);
    }
  }
}

static const char *rest_key(strut_rest_kind kind) {
  static const char *const keys[] = {"rest_length_ratio", "rest_length", "pretension",
                                     "force_density"};
  return (unsigned)kind < 4 ? keys[kind] : NULL;
}

/* Does the member join nodes that exist, each to a different one? */
static bool check_ends(strut_checker *checker) {
  const strut_member *member = &checker->scene->members[checker->index];
  if (member->guide_count + 2 > STRUT_MOST_ELEMENT_NODES)
    return strut_fault(checker, "nodes", "runs over %zu nodes, more than %d",
                       member->guide_count + 2, (int)STRUT_MOST_ELEMENT_NODES);
  for (size_t k = 0; k < member->guide_count + 2; k++) {
    int32_t node = strut_member_node(member, k), before = k ? strut_member_node(member, k - 1) : -1;
    if (node < 0 || (size_t)node >= checker->scene->node_count)
      return strut_fault(checker, "nodes", "joins a node that does not exist");
    if (node != before) continue;
    return strut_fault(checker, "nodes", "joins node '%s' to itself",
                       checker->scene->nodes[node].name);
  }
  if (!member->guide_count || member->kind != STRUT_BAR) return true;
  return strut_fault(checker, "nodes", "runs over guides, which a bar cannot");
}

static bool check_numbers(strut_checker *checker) {
  const strut_member *member = &checker->scene->members[checker->index];
  bool valid = strut_check_thing(checker);
  if (rest_key(member->rest_kind) && (unsigned)member->kind <= STRUT_CABLE) return valid;
  return strut_fault(checker, "kind", "is of an unknown kind");
}

static bool check_law(strut_checker *checker) {
  const strut_member *member = &checker->scene->members[checker->index];
  const char *key = rest_key(member->rest_kind);
  bool force =
      member->rest_kind == STRUT_REST_PRETENSION || member->rest_kind == STRUT_REST_FORCE_DENSITY;
  bool given = member->stiffness > 0.0 || member->axial_stiffness > 0.0;
  bool elastic = given || strut_law_at(member->law.kind)->own,
       linear = member->law.kind == STRUT_LAW_LINEAR;
  if (!strut_check_member_law(checker)) return false;
  strut_check_maxwell(checker);
  if (member->stiffness > 0.0 && member->axial_stiffness > 0.0)
    return strut_fault(checker, "axial_stiffness",
                       "has both a stiffness and an axial_stiffness; give one");
  if (member->damping > 0.0 && member->damping_ratio > 0.0)
    return strut_fault(checker, "damping_ratio",
                       "has both a damping and a damping_ratio; give one");
  if (!elastic && member->damping_ratio > 0.0)
    return strut_fault_of(checker, "damping_ratio", "the damping_ratio of %s needs a stiffness",
                          checker->owner);
  if (!elastic && member->damping == 0.0 && member->maxwell.stiffness == 0.0 &&
      !strut_is_pulled(checker->scene, (int32_t)checker->index, -1))
    return strut_fault(checker, NULL, "has neither stiffness nor damping, so it does nothing");
  if (force && !linear)
    return strut_fault_of(checker, key, "the %s of %s needs a linear law; give its rest_length",
                          key, checker->owner);
  if (force && !elastic && member->rest_value != 0.0)
    return strut_fault_of(checker, key, "the %s of %s needs a stiffness", key, checker->owner);
  if (force && member->kind == STRUT_CABLE && member->rest_value < 0.0)
    return strut_fault_of(checker, key,
                          "the %s of %s must not be negative, since a cable cannot push; "
                          "give a slack cable its rest_length",
                          key, checker->owner);
  return true;
}

/* Checks the geometry of a member: a direction as drawn and at the start, and a rest length. */
static void check_shape(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_member *member = &scene->members[checker->index];
  double drawn = 0.0;
  bool free_length = member->rest_kind == STRUT_REST_LENGTH && member->rest_value == 0.0;
  for (size_t k = 0; k <= member->guide_count; k++) {
    int32_t a = strut_member_node(member, k), b = strut_member_node(member, k + 1);
    double start = strut_distance(scene->nodes[a].start, scene->nodes[b].start);
    drawn = strut_distance(scene->nodes[a].position, scene->nodes[b].position);
    if (isnan(drawn) || isnan(start)) return; /* reported at the node */
    if (!free_length && !strut_check_apart(checker, "nodes", a, b, "")) return;
  }
  const char *key = rest_key(member->rest_kind);
  strut_rest rest;
  if (!strut_member_rest(scene, checker->index, &rest) && member->axial_stiffness > 0.0)
    strut_fault_of(checker, key,
                   "the axial_stiffness of %s needs a rest length above zero, but its %s is %g "
                   "(drawn length %g m, axial_stiffness %g N)",
                   checker->owner, key, member->rest_value, drawn, member->axial_stiffness);
  else if (!strut_member_rest(scene, checker->index, &rest))
    strut_fault_of(checker, key,
                   "the %s %g of %s would need a rest length below zero "
                   "(drawn length %g m, stiffness %g N/m)",
                   key, member->rest_value, checker->owner, drawn, member->stiffness);
}

/* Steps lead somewhere, and two of them span the plane. */
static void check_lattice(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const double(*a)[2] = scene->lattice;
  double length[2] = {hypot(a[0][0], a[0][1]), hypot(a[1][0], a[1][1])};
  double area = fabs(a[0][0] * a[1][1] - a[0][1] * a[1][0]);
  bool empty = false;
  for (int32_t k = 0; k < scene->lattice_count; k++)
    empty = empty || !(length[k] > 0.0 && length[k] < HUGE_VAL);
  if (empty)
    strut_fault_of(checker, "lattice", "a step of the lattice must lead somewhere, it is [0, 0]");
  else if (scene->lattice_count == 2 && !(area > 1e-9 * length[0] * length[1]))
    strut_fault_of(checker, "lattice",
                   "the two steps of the lattice are parallel; one step is enough for a structure "
                   "that repeats along a line");
}

static void check_all_members(strut_checker *checker) {
  strut_check_begin_with(checker, STRUT_ON_SCENE, 0, "rayleigh in the scene");
  checker->within = "rayleigh";
  strut_check_fields(checker, STRUT_FIELDS_RAYLEIGH, checker->scene, NULL);
  check_lattice(checker);
  for (size_t i = 0; i < checker->scene->member_count; i++) {
    strut_check_begin(checker, STRUT_THING_MEMBER, i);
    checker->loose[i] = !check_ends(checker);
    bool valid = check_numbers(checker) && check_law(checker);
    if (valid && !checker->loose[i]) check_shape(checker);
  }
}

static void mark_nodes(unsigned char *joined, const strut_scene *scene, const int32_t *node,
                       size_t count) {
  for (size_t k = 0; k < count; k++)
    if (strut_exists(node[k], scene->node_count)) joined[node[k]] = 1;
}

unsigned char *strut_joined_nodes(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  unsigned char *joined = strut_allocate(scene->node_count, 1);
  checker->out_of_memory = checker->out_of_memory || !joined;
  if (!joined) return NULL;
  for (size_t i = 0; i < scene->member_count; i++) {
    mark_nodes(joined, scene, scene->members[i].node, 2);
    mark_nodes(joined, scene, scene->members[i].guides, scene->members[i].guide_count);
  }
  for (size_t i = 0; i < scene->hinge_count; i++)
    mark_nodes(joined, scene, scene->hinges[i].node, 3);
  for (size_t i = 0; i < scene->cell_count; i++)
    mark_nodes(joined, scene, scene->cells[i].node, scene->cells[i].node_count);
  for (size_t i = 0; i < scene->collision_count; i++)
    mark_nodes(joined, scene, scene->collisions[i].node, 2);
  for (size_t i = 0; i < scene->distance_count; i++) {
    mark_nodes(joined, scene, scene->distances[i].node, 2);
    mark_nodes(joined, scene, scene->distances[i].line, 2);
  }
  return joined;
}

/* Is every node used, and does every free node have mass in a run? */
static void check_all_use(strut_checker *checker) {
  enum { USED = 1, HEAVY = 2 };
  const strut_scene *scene = checker->scene;
  unsigned char *state = strut_joined_nodes(checker);
  if (!state) return;
  for (size_t i = 0; i < scene->member_count; i++)
    for (size_t e = 0; e < scene->members[i].guide_count + 2; e++) {
      int32_t n = strut_member_node(&scene->members[i], e);
      if (strut_exists(n, scene->node_count) && scene->members[i].mass > 0.0) state[n] |= HEAVY;
    }
  for (size_t i = 0; i < scene->unbalance_count; i++) {
    int32_t n = scene->unbalances[i].node;
    if (strut_exists(n, scene->node_count))
      state[n] = (unsigned char)(state[n] | USED | (scene->unbalances[i].mass > 0.0 ? HEAVY : 0));
  }
  for (size_t i = 0; i < scene->load_count; i++)
    if (strut_exists(scene->loads[i].node, scene->node_count)) state[scene->loads[i].node] |= USED;
  for (size_t i = 0; i < scene->node_count; i++) {
    const strut_node *node = &scene->nodes[i];
    strut_check_begin(checker, STRUT_THING_NODE, i);
    if (node->mass != 0.0) state[i] |= USED | HEAVY;
    if (!(state[i] & USED))
      strut_fault_of(checker, NULL, "nothing uses %s: it has no member, no load and no mass",
                     checker->owner);
    else if (checker->purpose == STRUT_FOR_RUN && !checker->resting && !(state[i] & HEAVY) &&
             !(node->fixed[0] && node->fixed[1]))
      strut_fault(checker, "mass",
                  "has no mass, so a run cannot move it; "
                  "give it or one of its members a mass, or fix it");
  }
  strut_release(state);
}

strut_status strut_setup_check(const strut_setup *setup, strut_purpose purpose,
                               strut_findings *findings) {
  static void (*const rules[])(strut_checker *) = {
      check_all_names,       check_all_nodes,        check_all_members,          strut_check_hinges,
      strut_check_cells,     strut_check_collisions, strut_check_distances,      check_all_use,
      strut_check_sensors,   strut_check_states,     strut_check_signals,        strut_check_ground,
      strut_check_feet,      strut_check_drives,     strut_check_sliding_masses, strut_check_shapes,
      strut_check_experiment};
  const strut_scene *scene = &setup->scene;
  const strut_experiment *experiment = &setup->experiment;
  bool runs = experiment->step != 0.0 || experiment->duration != 0.0 || experiment->periods != 0.0;
  bool resting = purpose == STRUT_FOR_ANY_STATICS;
  if (purpose == STRUT_FOR_ANY || resting) purpose = runs ? STRUT_FOR_RUN : STRUT_FOR_STATICS;
  bool step_later = resting || purpose == STRUT_FOR_RUN_STEP_LATER;
  if (purpose == STRUT_FOR_RUN_STEP_LATER) purpose = STRUT_FOR_RUN;
  size_t before = findings->count;
  strut_checker checker = {.scene = scene,
                           .experiment = experiment,
                           .purpose = purpose,
                           .step_given_later = step_later,
                           .resting = resting,
                           .findings = findings};
  checker.loose = strut_allocate(scene->member_count, sizeof *checker.loose);
  checker.wild = strut_allocate(scene->signal_count, sizeof *checker.wild);
  if (!checker.loose || !checker.wild) checker.out_of_memory = true;
  strut_c_locale locale = strut_c_locale_enter();
  for (size_t i = 0; i < sizeof rules / sizeof rules[0] && !checker.out_of_memory; i++)
    rules[i](&checker);
  strut_c_locale_leave(locale);
  strut_release(checker.loose);
  strut_release(checker.wild);
  if (checker.out_of_memory) return STRUT_NO_MEMORY;
  return findings->count > before ? STRUT_BAD_SCENE : STRUT_OK;
}

void strut_findings_free(strut_findings *findings) {
  strut_release(findings->items);
  strut_arena_free(&findings->arena);
  *findings = (strut_findings){0};
}
