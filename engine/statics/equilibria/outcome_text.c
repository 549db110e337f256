/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was found, in words: verdicts, what moves freely, why nothing can rest. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/statics/equilibria/equilibrium_search.h"
#include "engine/statics/equilibria/floppy.h"
#include "engine/statics/equilibria/naming.h"

enum { NAMES = 100 };

/* A part of the structure (nodes that members connect): what acts on it, what may hold it. */
typedef struct part {
  double force[2];
  bool held[2], touches;
} part;

static int32_t root(int32_t *parent, int32_t a) {
  while (parent[a] != a) a = parent[a] = parent[parent[a]];
  return a;
}

/* parent[] of each node becomes its part's first found node; part[] is filled there. */
static void sum_parts(const strut_equilibrium_search *h, int32_t *parent, part *parts) {
  const strut_model *model = h->model;
  for (int32_t i = 0; i < model->node_count; i++) parent[i] = i;
  for (int32_t j = 0; j < model->members.count; j++) {
    int32_t a = (int32_t)model->members.from[j] / 2, b = (int32_t)model->members.to[j] / 2;
    parent[root(parent, a)] = root(parent, b);
  }
  for (int32_t i = 0; i < model->node_count; i++) {
    part *p = &parts[parent[i] = root(parent, i)];
    for (int c = 0; c < 2; c++) {
      p->held[c] = p->held[c] || model->fixed[2 * i + c];
      if (!model->fixed[2 * i + c]) p->force[c] += h->world->force[2 * i + c];
    }
  }
  for (int32_t i = 0; i < model->contacts.count && h->on_ground; i++)
    parts[parent[model->contacts.entry[i].node]].touches = true;
}

/* Why a part cannot be at rest: the forces on it against what could hold them. */
static strut_instability_cause unrest_of(const strut_equilibrium_search *h, const part *p) {
  double scale = 1e-12 * h->world->force_scale;
  bool across = !p->held[1] && fabs(p->force[1]) > scale;
  bool along = !p->held[0] && fabs(p->force[0]) > scale;
  if (!p->touches) return across || along ? STRUT_INSTABILITY_FALLS : STRUT_INSTABILITY_NONE;
  if (across && p->force[1] > 0) return STRUT_INSTABILITY_LIFTED;
  return along ? STRUT_INSTABILITY_SLIDES : STRUT_INSTABILITY_NONE;
}

/* What friction would have to do: the force along the ground against the one that presses on it. */
static void say_friction(const part *p, size_t room, char *text) {
  if (p->force[1] < 0)
    snprintf(text, room, "with it, a coefficient of at least %.4g holds it",
             fabs(p->force[0] / p->force[1]));
  else
    snprintf(text, room, "with it too, as nothing presses it down");
}

static void say_unrest(strut_equilibrium_search *h, strut_instability_cause unrest, const part *p,
                       const uint8_t *flag) {
  char names[NAMES] = "all nodes", friction[NAMES], *remark = h->out->remark;
  size_t room = sizeof h->out->remark;
  int32_t count = 0;
  say_friction(p, sizeof friction, friction);
  for (int32_t i = 0; i < h->model->node_count; i++) count += flag[i];
  bool all = count == h->model->node_count;
  if (!all) strut_list_nodes(&h->flat.scene, flag, sizeof names, names);
  const char *what = all ? "the structure" : "a part of the structure";
  if (unrest == STRUT_INSTABILITY_FALLS)
    snprintf(remark, room, "nothing holds %s: it falls freely, %s", what, names);
  else if (unrest == STRUT_INSTABILITY_LIFTED)
    snprintf(remark, room, "loads lift %s off the ground, %s", what, names);
  else
    snprintf(remark, room,
             "nothing but friction holds %s along the ground, %s: without friction it slides; %s",
             what, names, friction);
}

strut_instability_cause strut_equilibrium_search_instability(strut_equilibrium_search *h) {
  int32_t nodes = h->model->node_count, moves = -1;
  strut_instability_cause worst = STRUT_INSTABILITY_NONE;
  strut_arena scratch = {0};
  int32_t *parent = strut_arena_allocate(&scratch, (size_t)nodes, sizeof *parent);
  part *parts = strut_arena_allocate(&scratch, (size_t)nodes, sizeof *parts);
  uint8_t *flag = strut_arena_allocate(&scratch, (size_t)nodes, 1);
  if (parent && parts && flag) {
    sum_parts(h, parent, parts);
    for (int32_t i = 0; i < nodes && worst == STRUT_INSTABILITY_NONE; i++)
      if (parent[i] == i && (worst = unrest_of(h, &parts[i])) != STRUT_INSTABILITY_NONE) moves = i;
    for (int32_t i = 0; i < nodes; i++) flag[i] = parent[i] == moves;
    if (moves >= 0) say_unrest(h, worst, &parts[moves], flag);
  }
  strut_arena_free(&scratch);
  return worst;
}

/* Does the free motion lead anywhere? Asked of the forces that it was found with. */
static bool leads_away(const strut_equilibrium_search *h, const strut_equilibrium *e,
                       uint8_t *held) {
  strut_potential *potential = NULL;
  if (!e->supports) return strut_floppy_stays(h->world, &e->point);
  memset(held, 0, (size_t)h->model->length);
  strut_supports_hold(&h->supports, e->supports, held);
  bool stays = strut_potential_create(h->model, held, false, &potential, NULL) == STRUT_OK &&
               strut_floppy_stays(potential, &e->point);
  strut_potential_free(potential);
  return stays;
}

/* True if it leads away at one energy. flag: (length) */
static bool say_floppy(strut_equilibrium_search *h, const strut_equilibrium *e, uint8_t *flag,
                       size_t room, char *text) {
  char names[NAMES];
  int32_t count = 0;
  bool away = leads_away(h, e, flag);
  strut_floppy_nodes(h->model, &e->point, flag);
  for (int32_t i = 0; i < h->model->node_count; i++) count += flag[i];
  strut_list_nodes(&h->flat.scene, flag, sizeof names, names);
  if (away)
    snprintf(text, room, "%s %s %s without stiffness", count == 1 ? "node" : "nodes", names,
             count == 1 ? "moves" : "move together");
  else
    snprintf(text, room, "%s %s %s no stiffness to second order", count == 1 ? "node" : "nodes",
             names, count == 1 ? "meets" : "meet");
  return away;
}

static void say_tips(strut_equilibrium_search *h, const strut_candidate_equilibrium *finds,
                     const strut_candidate_equilibrium *f, uint8_t *flag, strut_equilibrium *e) {
  char names[NAMES];
  const strut_scene *scene = &h->flat.scene;
  const char *over = e->tips_over >= 0 ? scene->nodes[e->tips_over].name : NULL;
  memset(flag, 0, (size_t)h->model->node_count);
  for (int32_t i = 0; i < e->contact_count; i++) flag[e->contacts[i]] = 1;
  strut_list_nodes(scene, flag, sizeof names, names);
  const char *end = e->ends_as >= 0 ? finds[e->ends_as].e.name : NULL;
  (void)f;
  int length = snprintf(e->verdict, sizeof e->verdict, "%s%.24s onto %s%s%.60s",
                        over ? "tips over " : "gives way", over ? over : "", names, end ? ": " : "",
                        end ? end : ""); /* a long list of names is cut */
  if (length < 0) e->verdict[0] = '\0';
}

static void say_no_rest(const strut_equilibrium_search *h, strut_equilibrium *e) {
  static const char *const why[] = {
      [STRUT_INSTABILITY_NONE] = "does not come to rest",
      [STRUT_INSTABILITY_FALLS] = "falls",
      [STRUT_INSTABILITY_SLIDES] = "slides along the ground without friction",
      [STRUT_INSTABILITY_LIFTED] = "is lifted off the ground"};
  snprintf(e->verdict, sizeof e->verdict, "%s", why[h->unrest]);
}

static void say_one(strut_equilibrium_search *h, strut_candidate_equilibrium *finds,
                    strut_candidate_equilibrium *f, uint8_t *flag) {
  strut_equilibrium *e = &f->e;
  size_t room = sizeof e->verdict;
  char names[NAMES];
  switch (e->fate) {
    case STRUT_OUTCOME_STANDS: snprintf(e->verdict, room, "stands"); break;
    case STRUT_OUTCOME_TIPS: say_tips(h, finds, f, flag, e); break;
    case STRUT_OUTCOME_BELOW_GROUND:
      strut_list_nodes(&h->flat.scene, e->below, sizeof names, names);
      snprintf(e->verdict, room, "below ground (%s)", names);
      break;
    case STRUT_OUTCOME_FLOPPY: say_floppy(h, e, flag, room, e->verdict); break;
    case STRUT_OUTCOME_UNSTABLE:
      snprintf(e->verdict, room, "unstable: %d negative eigenvalue%s", (int)e->point.negative,
               e->point.negative == 1 ? "" : "s");
      break;
    default: say_no_rest(h, e); break;
  }
}

/* Only where there is nothing better to stand in do free motions need a remark. */
static void remark_on(strut_equilibrium_search *h, strut_candidate_equilibrium *finds, size_t count,
                      uint8_t *flag) {
  char *remark = h->out->remark;
  size_t room = sizeof h->out->remark;
  int32_t floppy = -1;
  for (size_t i = 0; i < count; i++) {
    if (finds[i].e.fate == STRUT_OUTCOME_STANDS) return;
    if (floppy < 0 && finds[i].e.fate == STRUT_OUTCOME_FLOPPY) floppy = (int32_t)i;
  }
  if (floppy >= 0) {
    bool away = say_floppy(h, &finds[floppy].e, flag, room, remark);
    size_t used = strlen(remark);
    if (away)
      snprintf(remark + used, room - used, ": '%s' is one of many shapes of one energy",
               finds[floppy].e.name);
    else
      snprintf(remark + used, room - used, " in '%s'; pushed further, it does not stay",
               finds[floppy].e.name);
  } else if (count == 0) {
    snprintf(remark, room, "no equilibrium was found from any of %lld starts",
             (long long)h->out->starts);
  } else if (h->flat.askew >= 0) {
    snprintf(remark, room,
             "node '%s' is held in one direction only, which no slope can be turned away from: "
             "no contacts were held in turn, only the real ground was searched",
             h->flat.scene.nodes[h->flat.askew].name);
  } else if (h->supports.many) {
    snprintf(remark, room,
             "there are too many pairs of contact nodes to hold each in turn: only the real ground "
             "was searched; name some by equilibria.supports");
  }
}

void strut_report_candidates(strut_equilibrium_search *h, strut_candidate_equilibrium *finds,
                             size_t count) {
  uint8_t *flag = strut_arena_allocate(&h->out->arena, (size_t)h->model->length, 1);
  if (!flag) return;
  for (size_t i = 0; i < count; i++) say_one(h, finds, &finds[i], flag);
  if (!h->out->remark[0]) remark_on(h, finds, count, flag);
}
