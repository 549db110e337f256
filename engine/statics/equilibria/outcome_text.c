/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/statics/equilibria/equilibria_parts.h"

#include "engine/model/model.h"

/* Nodes that move at least this share of the one that moves most. */
static const double MOVES = 0.1;
/* Size of the push, and the distance at which it must stay away, in model sizes. */
static const double PUSHED = 0.02, AWAY = 0.005;

/* A velocity of one node, and a rate of turning about it. */
typedef struct whole {
  int32_t about;
  double shift[2], turn;
} whole;

static double node_speed(const double *positions, const double *mode, const whole *self,
                         int32_t i) {
  double dx = positions[2 * i] - positions[2 * self->about],
         dy = positions[2 * i + 1] - positions[2 * self->about + 1];
  return hypot(mode[2 * i] - self->shift[0] + self->turn * dy,
               mode[2 * i + 1] - self->shift[1] - self->turn * dx);
}

/* Flags the nodes that move besides w; their count. */
static int32_t flag_moving(const strut_model *model, const strut_critical_point *point,
                           const whole *self, uint8_t *flag) {
  double most = 0.0;
  int32_t count = 0;
  for (int32_t i = 0; i < model->node_count; i++)
    most = fmax(most, node_speed(point->q, point->softest, self, i));
  for (int32_t i = 0; i < model->node_count; i++)
    count += flag[i] = node_speed(point->q, point->softest, self, i) > MOVES * most;
  return count;
}

/* The rigid motion that follows node a, and b as far as a rotation can. */
static whole rigid_motion_of(const strut_critical_point *point, bool turns, int32_t a, int32_t b) {
  const double *q = point->q, *mode = point->softest;
  double dx = q[2 * b] - q[2 * a], dy = q[2 * b + 1] - q[2 * a + 1], square = dx * dx + dy * dy;
  whole w = {.about = a, .shift = {mode[2 * a], turns ? mode[2 * a + 1] : 0.0}};
  if (turns && square > 0)
    w.turn = ((mode[2 * b + 1] - mode[2 * a + 1]) * dx - (mode[2 * b] - mode[2 * a]) * dy) / square;
  return w;
}

/*
 * flag (node_count): 1 where a node moves in point->softest, once the free rigid motion is added
 * that keeps most nodes still.
 */
static void flag_floppy_nodes(const strut_model *model, const strut_critical_point *point,
                              uint8_t *flag) {
  whole still = {0}, best = still;
  int32_t least = flag_moving(model, point, &still, flag);
  bool turns = point->rigid == 3;
  for (int32_t a = 0; a < model->node_count && point->rigid > 0; a++)
    for (int32_t b = 0; b < (turns ? model->node_count : 1); b++) {
      whole w = rigid_motion_of(point, turns, a, b);
      int32_t count = flag_moving(model, point, &w, flag);
      if (count > 0 && count < least) least = count, best = w;
    }
  flag_moving(model, point, &best, flag);
}

/* Largest distance moved, up to rigid motions if the structure is free. */
static double distance_moved(const strut_model *model, const strut_critical_point *point,
                             const double *positions) {
  double most = 0.0;
  if (point->rigid > 0) return strut_shape_distance(model, point->q, positions, false, NULL);
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    most = fmax(most, fabs(positions[at] - point->q[at]));
  return most;
}

/*
 * True where the structure, pushed along point->softest by a fiftieth of its size and let down
 * again, stays away at the same energy: else stiffness of a higher order brings it back, or it
 * falls further. False when memory is out too.
 */
static bool stays_displaced(const strut_potential *potential, const strut_critical_point *point) {
  const strut_model *model = potential->model;
  size_t length = (size_t)model->length;
  double size = model->size > 0 ? model->size : 1.0, most = 0.0;
  strut_minimiser *minimiser = NULL;
  strut_arena scratch = {0};
  double *q = strut_arena_allocate(&scratch, length, sizeof *q);
  bool good = q && !strut_minimiser_create(potential, &scratch, &minimiser, NULL), stays = false;
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    most = fmax(most, fabs(point->softest[at]));
  double same = 1e-12 * (fabs(point->potential) + strut_stiffest(model) * size * size);
  for (int side = -1; side <= 1 && good && most > 0 && !stays; side += 2) {
    memcpy(q, point->q, length * sizeof *q);
    for (int32_t at = 0; at < 2 * model->node_count; at++)
      q[at] += side * PUSHED * size / most * point->softest[at];
    strut_descent end = strut_minimise(minimiser, q);
    stays = end.end == STRUT_DESCENT_REACHED && distance_moved(model, point, q) > AWAY * size &&
            fabs(strut_potential_value(potential, q) - point->potential) <= same;
  }
  strut_arena_free(&scratch);
  return stays;
}

/* Verdicts, free motions and causes of instability in words. */

enum { NAMES = 100 };

/* Why a part cannot rest: the forces on it against the supports that could balance them. */
static strut_instability_cause instability_of(const strut_equilibrium_search *search,
                                              const strut_connected_part *part) {
  double scale = 1e-12 * search->potential->force_scale;
  bool across = !part->held[1] && fabs(part->force[1]) > scale;
  bool along = !part->held[0] && fabs(part->force[0]) > scale;
  if (!part->touches || !search->on_ground)
    return across || along ? STRUT_INSTABILITY_FALLS : STRUT_INSTABILITY_NONE;
  const strut_contact_table *contacts = &search->model->contacts;
  if (contacts->surface) { /* that nothing holds it is known beforehand only along parallel lines */
    double pull = part->force[0] * contacts->tangent[0] + part->force[1] * contacts->tangent[1];
    bool free = contacts->parallel && !part->held[0] && !part->held[1] && fabs(pull) > scale;
    return free ? STRUT_INSTABILITY_SLIDES : STRUT_INSTABILITY_NONE;
  }
  if (across && part->force[1] > 0) return STRUT_INSTABILITY_LIFTED;
  return along ? STRUT_INSTABILITY_SLIDES : STRUT_INSTABILITY_NONE;
}

/* The friction coefficient that would hold the part: force along the ground over normal force. */
static void describe_friction(const strut_connected_part *part, size_t room, char *text) {
  if (part->force[1] < 0)
    snprintf(text, room, "a friction coefficient of at least %.4g holds it",
             fabs(part->force[0] / part->force[1]));
  else
    snprintf(text, room, "friction cannot hold it, because nothing presses it down");
}

static void describe_instability(strut_equilibrium_search *search, strut_instability_cause cause,
                                 const strut_connected_part *part, const uint8_t *flag) {
  char names[NAMES] = "all nodes", friction[NAMES], *remark = search->out->remark;
  size_t room = sizeof search->out->remark;
  int32_t count = 0;
  describe_friction(part, sizeof friction, friction);
  for (int32_t i = 0; i < search->model->node_count; i++) count += flag[i];
  bool all = count == search->model->node_count;
  if (!all) strut_list_nodes(&search->level.scene, flag, sizeof names, names);
  const char *what = all ? "the structure" : "a part of the structure";
  if (cause == STRUT_INSTABILITY_FALLS)
    snprintf(remark, room, "nothing holds %s: it falls freely, %s", what, names);
  else if (cause == STRUT_INSTABILITY_LIFTED)
    snprintf(remark, room, "loads lift %s off the ground, %s", what, names);
  else
    snprintf(remark, room,
             "nothing but friction holds %s along the ground, %s: without friction it slides; %s",
             what, names, friction);
}

strut_instability_cause strut_equilibrium_search_instability(strut_equilibrium_search *search) {
  int32_t nodes = search->model->node_count, moves = -1;
  strut_instability_cause worst = STRUT_INSTABILITY_NONE;
  strut_arena scratch = {0};
  int32_t *parent = strut_arena_allocate(&scratch, (size_t)nodes, sizeof *parent);
  strut_connected_part *parts = strut_arena_allocate(&scratch, (size_t)nodes, sizeof *parts);
  uint8_t *flag = strut_arena_allocate(&scratch, (size_t)nodes, 1);
  if (parent && parts && flag) {
    strut_connected_parts_find(search->model, search->potential->force, parent, parts);
    for (int32_t i = 0; i < nodes && worst == STRUT_INSTABILITY_NONE; i++)
      if (parent[i] == i && (worst = instability_of(search, &parts[i])) != STRUT_INSTABILITY_NONE)
        moves = i;
    for (int32_t i = 0; i < nodes; i++) flag[i] = parent[i] == moves;
    if (moves >= 0) describe_instability(search, worst, &parts[moves], flag);
  }
  strut_arena_free(&scratch);
  return worst;
}

/* True if the free motion leads away, under the potential that the equilibrium was found with. */
static bool leads_away(const strut_equilibrium_search *search, const strut_equilibrium *equilibrium,
                       uint8_t *held) {
  strut_potential *potential;
  strut_arena scratch = {0};
  if (!equilibrium->supports) return stays_displaced(search->potential, &equilibrium->point);
  memset(held, 0, (size_t)search->model->length);
  strut_supports_hold(&search->supports, equilibrium->supports, held);
  bool stays =
      strut_potential_create(search->model, held, false, &scratch, &potential, NULL) == STRUT_OK &&
      stays_displaced(potential, &equilibrium->point);
  strut_arena_free(&scratch);
  return stays;
}

/* Describes a motion without stiffness; true if it leads away at equal energy. flag: (length) */
static bool describe_floppy_motion(strut_equilibrium_search *search,
                                   const strut_equilibrium *equilibrium, uint8_t *flag, size_t room,
                                   char *text) {
  char names[NAMES];
  int32_t count = 0;
  bool away = leads_away(search, equilibrium, flag);
  flag_floppy_nodes(search->model, &equilibrium->point, flag);
  for (int32_t i = 0; i < search->model->node_count; i++) count += flag[i];
  strut_list_nodes(&search->level.scene, flag, sizeof names, names);
  if (away)
    snprintf(text, room, "%s %s %s without stiffness", count == 1 ? "node" : "nodes", names,
             count == 1 ? "moves" : "move together");
  else
    snprintf(text, room, "%s %s %s no stiffness to second order", count == 1 ? "node" : "nodes",
             names, count == 1 ? "meets" : "meet");
  return away;
}

static void describe_tipping(strut_equilibrium_search *search,
                             const strut_candidate_equilibrium *finds, uint8_t *flag,
                             strut_equilibrium *equilibrium) {
  char names[NAMES];
  const strut_scene *scene = &search->level.scene;
  const char *over = equilibrium->tips_over >= 0 ? scene->nodes[equilibrium->tips_over].name : NULL;
  memset(flag, 0, (size_t)search->model->node_count);
  for (int32_t i = 0; i < equilibrium->contact_count; i++) flag[equilibrium->contacts[i]] = 1;
  strut_list_nodes(scene, flag, sizeof names, names);
  const char *end = equilibrium->ends_as >= 0 ? finds[equilibrium->ends_as].e.name : NULL;
  int length = snprintf(equilibrium->verdict, sizeof equilibrium->verdict, "%s%.24s onto %s%s%.60s",
                        over ? "tips over " : "gives way", over ? over : "", names, end ? ": " : "",
                        end ? end : ""); /* a long list of names is cut */
  if (length < 0) equilibrium->verdict[0] = '\0';
}

static void describe_no_rest(const strut_equilibrium_search *search,
                             strut_equilibrium *equilibrium) {
  static const char *const why[] = {
      [STRUT_INSTABILITY_NONE] = "does not come to rest",
      [STRUT_INSTABILITY_FALLS] = "falls",
      [STRUT_INSTABILITY_SLIDES] = "slides along the ground without friction",
      [STRUT_INSTABILITY_LIFTED] = "is lifted off the ground"};
  snprintf(
      equilibrium->verdict, sizeof equilibrium->verdict, "%s",
      search->held_by_friction ? "tips over or slides once released" : why[search->instability]);
}

static void describe_outcome(strut_equilibrium_search *search, strut_candidate_equilibrium *finds,
                             strut_candidate_equilibrium *candidate, uint8_t *flag) {
  strut_equilibrium *equilibrium = &candidate->e;
  size_t room = sizeof equilibrium->verdict;
  char names[NAMES];
  int used;
  switch (equilibrium->outcome) {
    case STRUT_OUTCOME_STANDS:
      used = snprintf(equilibrium->verdict, room, "stands");
      if (equilibrium->friction > 0.0)
        snprintf(equilibrium->verdict + used, room - (size_t)used,
                 " by friction, with a coefficient of %.4g", equilibrium->friction);
      break;
    case STRUT_OUTCOME_TIPS: describe_tipping(search, finds, flag, equilibrium); break;
    case STRUT_OUTCOME_BELOW_GROUND:
      strut_list_nodes(&search->level.scene, equilibrium->below, sizeof names, names);
      snprintf(equilibrium->verdict, room, "below ground (%s)", names);
      break;
    case STRUT_OUTCOME_FLOPPY:
      describe_floppy_motion(search, equilibrium, flag, room, equilibrium->verdict);
      break;
    case STRUT_OUTCOME_UNSTABLE:
      snprintf(equilibrium->verdict, room, "unstable: %d negative eigenvalue%s",
               (int)equilibrium->point.negative, equilibrium->point.negative == 1 ? "" : "s");
      break;
    case STRUT_OUTCOME_NO_REST: describe_no_rest(search, equilibrium); break;
  }
}

/* Free motions need a remark only if no equilibrium stands. */
static void write_remark(strut_equilibrium_search *search, strut_candidate_equilibrium *finds,
                         size_t count, uint8_t *flag) {
  char *remark = search->out->remark;
  size_t room = sizeof search->out->remark;
  int32_t floppy = -1;
  for (size_t i = 0; i < count; i++) {
    if (finds[i].e.outcome == STRUT_OUTCOME_STANDS) return;
    if (floppy < 0 && finds[i].e.outcome == STRUT_OUTCOME_FLOPPY) floppy = (int32_t)i;
  }
  if (floppy >= 0) {
    bool away = describe_floppy_motion(search, &finds[floppy].e, flag, room, remark);
    size_t used = strlen(remark);
    if (away)
      snprintf(remark + used, room - used,
               ": '%s' is one of a continuous family of shapes of equal energy",
               finds[floppy].e.name);
    else
      snprintf(remark + used, room - used, " in '%s'; pushed further, it does not stay",
               finds[floppy].e.name);
  } else if (count == 0) {
    snprintf(remark, room, "no equilibrium was found from %lld starts",
             (long long)search->out->starts);
  } else if (search->level.oblique_node >= 0) {
    snprintf(remark, room,
             "node '%s' is held in one direction only, so the slope cannot be turned level: only "
             "the real ground was searched, without holding contacts in turn",
             search->level.scene.nodes[search->level.oblique_node].name);
  } else if (search->supports.many) {
    snprintf(remark, room,
             "too many pairs of contact nodes to hold each in turn: only the real ground was "
             "searched; list pairs in equilibria.supports");
  }
}

/* Appends what the potential alone does not say: bodies in each other, and ways through them. */
static void add_collisions(const strut_scene *scene, strut_equilibrium *equilibrium) {
  size_t used = strlen(equilibrium->verdict), room = sizeof equilibrium->verdict - used;
  if (equilibrium->overlap >= 0)
    snprintf(equilibrium->verdict + used, room, "; '%.60s' overlaps",
             scene->collisions[equilibrium->overlap].name);
  else if (equilibrium->through >= 0)
    snprintf(
        equilibrium->verdict + used, room, "; %s '%.60s'",
        equilibrium->outcome == STRUT_OUTCOME_UNSTABLE ? "leads through" : "reached only through",
        scene->collisions[equilibrium->through].name);
}

void strut_report_candidates(strut_equilibrium_search *search, strut_candidate_equilibrium *finds,
                             size_t count) {
  uint8_t *flag = strut_arena_allocate(&search->out->arena, (size_t)search->model->length, 1);
  if (!flag) return;
  for (size_t i = 0; i < count; i++) {
    describe_outcome(search, finds, &finds[i], flag);
    add_collisions(&search->level.scene, &finds[i].e);
  }
  if (!search->out->remark[0]) write_remark(search, finds, count, flag);
}
