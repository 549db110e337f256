/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a search for equilibria found, a row for each value. */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdio.h>

#include "engine/statics/equilibria/equilibria_parts.h"

const char *strut_outcome_name(strut_outcome outcome) {
  static const char *const names[] = {"stands",   "tips",   "below ground",
                                      "unstable", "floppy", "no rest"};
  assert((size_t)outcome < sizeof names / sizeof names[0]);
  return names[outcome];
}

static const char *node_or_none(const strut_scene *scene, int32_t node) {
  return node >= 0 ? scene->nodes[node].name : NULL;
}

static const char *collision_or_none(const strut_scene *scene, int32_t collision) {
  return collision >= 0 ? scene->collisions[collision].name : NULL;
}

static const char *listed(const strut_equilibria *all, int32_t i) {
  return i >= 0 ? all->list[i].name : NULL;
}

/* ---- of one equilibrium ---- */

static const strut_equilibrium *rest_of(const strut_result_object *of) { return of->outer->at; }

static bool touches(const strut_result_object *of, size_t node) {
  const strut_equilibrium *equilibrium = rest_of(of);
  return strut_is_listed(equilibrium->contacts, equilibrium->contact_count, (int32_t)node);
}

static double normal_on(const strut_result_object *of, size_t node) {
  const strut_equilibrium *equilibrium = rest_of(of);
  int32_t i = 0;
  while (equilibrium->contacts[i] != (int32_t)node) i++;
  return equilibrium->normal[i];
}

#define REST(X)                                                                                    \
  X("nodes", "m", OF(NODE, e->rest), "positions", .label = {" x", " y"})                           \
  X("energy", "J", NUMBER(e->rest_energy), "there")                                                \
  X("residual", "N", NUMBER(e->rest_residual), "largest net force there")                          \
  X("friction", "1", NUMBER(e->friction), "coefficient that holds it along the ground")            \
  X("contacts", "N", THINGS(NODE, 1, NULL, normal_on, touches), "normal forces of the ground",     \
    .label = {" presses with"})
STRUT_VALUES_HERE(rest_values, REST, const strut_equilibrium *e = rest_of(of))

static const char *contact_name(const strut_result_object *of, size_t i) {
  return of->scene->nodes[((const strut_equilibrium *)of->at)->contacts[i]].name;
}

static const char *support_name(const strut_result_object *of, size_t i) {
  return of->scene->nodes[((const strut_equilibrium *)of->at)->supports->node[i]].name;
}

static const char *name_below(const strut_result_object *of, size_t i) {
  return ((const strut_equilibrium *)of->at)->below[i] ? of->scene->nodes[i].name : NULL;
}

static const char *name_down(const strut_result_object *of, size_t i) {
  const char *name = listed(of->outer->at, ((const strut_equilibrium *)of->at)->point.down[i]);
  return name ? name : STRUT_NAME_NULL;
}

static bool is_support(const strut_result_object *of, size_t k) {
  const strut_node_set *held = ((const strut_equilibrium *)of->at)->supports;
  const strut_node *node = &of->scene->nodes[k / 2];
  return (held && strut_is_listed(held->node, (int32_t)held->count, (int32_t)(k / 2))) ||
         node->fixed[0] || node->fixed[1];
}

static void write_flaws(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  const strut_equilibrium *equilibrium = of->at;
  if (equilibrium->collapsed)
    snprintf(text, STRUT_VALUE_ROOM, "collapsed");
  else if (equilibrium->crossings)
    snprintf(text, STRUT_VALUE_ROOM, "%d crossing%s", (int)equilibrium->crossings,
             equilibrium->crossings == 1 ? "" : "s");
}

/* Of the energy; 0 where it is rounding beside those of the others. */
static double shown_energy(const strut_equilibria *all, double energy) {
  double largest = 0.0;
  for (size_t i = 0; i < all->count; i++) largest = fmax(largest, fabs(all->list[i].energy));
  return fabs(energy) > 4.0 * DBL_EPSILON * largest ? energy : 0.0;
}

/* The lowest eigenvalue of a motion that is not free. */
static double lowest_stiffness(const strut_critical_point *point) {
  int32_t first = point->label == STRUT_STABLE ? point->zero : 0;
  return first < point->eigenvalue_count ? point->eigenvalues[first] : (double)NAN;
}

#define EQUILIBRIUM(X)                                                                             \
  X("name", "", TEXT(e->name), "unique in the list", .label = {"equilibrium"})                     \
  X("label", "", TEXT(strut_stability_name(p->label)), "stable, saddle, ... on its supports",      \
    .label = {""})                                                                                 \
  X("energy", "J", NUMBER(e->energy), "elastic")                                                   \
  X(NULL, "J", ROUNDED(6, NUMBER(shown_energy(all, e->energy))), "", .label = {"energy"})          \
  X(NULL, "N/m", NUMBER(lowest_stiffness(p)), "", .label = {"stiffness"})                          \
  X("potential", "J", NUMBER(p->potential), "with weights and loads")                              \
  X("contacts", "", NAMES(contact_name, e->contact_count), "nodes that touch the ground",          \
    .label = {"touching"})                                                                         \
  X("supports", "", KNOWN(e->supports, NAMES(support_name, e->supports->count)),                   \
    "contact nodes that were held; null: the scene as it stands", .label = {"held"})               \
  X("outcome", "", TEXT(strut_outcome_name(e->outcome)), "on the real ground")                     \
  X("verdict", "", TEXT(e->verdict), "in words", .label = {""})                                    \
  X("tips_over", "", TEXT(node_or_none(of->scene, e->tips_over)), "node about which it turns")     \
  X("ends_as", "", TEXT(listed(all, e->ends_as)), "the equilibrium that it ends in")               \
  X("shape", "", COUNT(p->shape), "number of its shape: congruent ones share it")                  \
  X("congruent_copies", "", COUNT(p->placements), "of its shape")                                  \
  X("found", "", COUNT(p->found), "random starts that met it", .label = {""})                      \
  X("collapsed", "", FLAG(e->collapsed), "whether two nodes coincide")                             \
  X("crossings", "", COUNT(e->crossings), "pairs of members that cross")                           \
  X(NULL, "", WORDS(write_flaws), "", .label = {"shape"})                                          \
  X(NULL, "1", POSITIVE(e->friction), "", .label = {"needs friction"})                             \
  X("overlap", "", IF(of->scene->collision_count, TEXT(collision_or_none(of->scene, e->overlap))), \
    "collision whose bodies lie in each other", .label = {""})                                     \
  X("through", "", IF(of->scene->collision_count, TEXT(collision_or_none(of->scene, e->through))), \
    "collision on every known way here, or on a way down", .label = {""})                          \
  X("nodes", "m", OF(NODE, p->q), "positions")                                                     \
  X("forces", "N", OF(MEMBER, e->member_force), "tensions of members")                             \
  X("reactions", "N", OF_WHERE(NODE, (const double *)e->reaction, is_support), "of supports")      \
  X("below_ground", "", NAMES(name_below, of->scene->node_count), "nodes under the ground")        \
  X("eigenvalues", "N/m", NUMBERS(p->eigenvalues, p->eigenvalue_count), "of the stiffness")        \
  X("negative_eigenvalues", "", COUNT(p->negative), "of them, below zero")                         \
  X("zero_eigenvalues", "", COUNT(p->zero), "of them, zero up to rounding")                        \
  X("rest", "", KNOWN(e->rest, PART(e->rest)), "where it comes to rest on the real ground",        \
    .rows = &rest_values)                                                                          \
  X("down", "", IF(p->label == STRUT_SADDLE && p->negative == 1, NAMES(name_down, 2)),             \
    "where the two ways down from a saddle lead", .label = {"between"})
STRUT_VALUES_HERE(equilibrium_values, EQUILIBRIUM, const strut_equilibrium *e = of->at;
                  const strut_critical_point *p = &e->point;
                  const strut_equilibria *all = of->outer->at)

/* ---- of all ---- */

static const char *name_via(const strut_result_object *of, size_t k) {
  const char *name = listed(of->outer->at, ((const strut_barrier *)of->at)->via[k]);
  return name ? name : STRUT_NAME_NULL;
}

#define BARRIER(X)                                                                                 \
  X("from", "", TEXT(all->list[b->from].name), "a stable equilibrium", .label = {""})              \
  X("to", "", TEXT(all->list[b->to].name), "another one", .label = {""})                           \
  X("height", "J", NUMBER(b->height), "of the lowest known way, above `from`",                     \
    .label = {"barrier"})                                                                          \
  X("saddle", "", TEXT(listed(all, b->saddle)), "the highest on the way", .label = {"over"})       \
  X("via", "", NAMES(name_via, b->via_count), "equilibria in between", .label = {""})              \
  X("direct", "J", NUMBER(b->direct), "height of the lowest saddle that connects them directly",   \
    .label = {""})                                                                                 \
  X("direct_saddle", "", TEXT(listed(all, b->direct_saddle)), "that one")
STRUT_VALUES_HERE(barrier_values, BARRIER, const strut_barrier *b = of->at;
                  const strut_equilibria *all = of->outer->at)

static const char climbs[] = "passes between stable ones; others are met by chance";

#define MISSED(X)                                                                                  \
  X("probability", "1", NUMBER(all->missed.probability),                                           \
    "estimate: that one more start finds a new stable one",                                        \
    .label = {"estimated probability of a new stable one"})                                        \
  X("probability_bound", "1", NUMBER(all->missed.below), "of it, at 95 %",                         \
    .label = {"at most (95 %)"})                                                                   \
  X("unreached", "", COUNT(all->unmet), "stable ones that no random start met",                    \
    .label = {"stable ones met by no random start"})                                               \
  X("smallest_basin", "1", NUMBER(all->missed.one), "share of starts that one as rare would meet", \
    .label = {"a missed one attracts less than (95 %)"})                                           \
  X("at_least", "", COUNT(all->unseen), "stable ones that exist besides, at 95 %")                 \
  X(NULL, "", IF(all->unseen, COUNT(all->unseen)), "",                                             \
    .label = {"more stable ones exist, at least (95 %)"})                                          \
  X("unstable", "", TEXT(all->climbs ? climbs : "not looked for"),                                 \
    "which unstable ones were looked for", .label = {"unstable ones"})                             \
  X("cut_short", "", FLAG(all->cut_short), "whether some search ended early")
STRUT_VALUES_HERE(missed_values, MISSED, const strut_equilibria *all = of->at)

static const char cut_short[] =
    "a search of all shapes, bounded to some ten seconds of work; --starts N asks for more";

static bool is_shown(const strut_result_object *of, size_t i) {
  const strut_equilibria *all = of->at;
  return all->shows_all || all->list[i].outcome == STRUT_OUTCOME_STANDS;
}

/* Those between configurations, where there are some. */
static bool is_shown_barrier(const strut_result_object *of, size_t i) {
  const strut_equilibria *all = of->at;
  const strut_barrier *barrier = &all->barriers[i];
  bool names = false;
  for (size_t k = 0; k < all->count; k++) names = names || all->list[k].configured;
  return all->shows_all || !names ||
         (all->list[barrier->from].configured && all->list[barrier->to].configured);
}

static bool stands(const strut_result_object *of, size_t i) {
  const strut_equilibrium *equilibrium = &((const strut_equilibria *)of->at)->list[i];
  return equilibrium->outcome == STRUT_OUTCOME_STANDS && equilibrium->rest;
}

#define POSITION(X)                                                                                \
  X(NULL, "", TEXT(e->name), "", .label = {"equilibrium"})                                         \
  X(NULL, "", PART(e->rest), "", .rows = &rest_values)
STRUT_VALUES_HERE(position_values, POSITION, const strut_equilibrium *e = of->at)

static strut_value shown_of(const strut_equilibria *all) {
  return STRUT_VALUE_AS_LIST_WHERE(all->list, all->count, is_shown);
}

static size_t standing_of(const strut_equilibria *all) {
  size_t count = 0;
  for (size_t i = 0; i < all->count; i++) count += all->list[i].outcome == STRUT_OUTCOME_STANDS;
  return count;
}

#define EQUILIBRIA(X)                                                                              \
  X(NULL, "", COUNT(all->count), "", .label = {"equilibria"})                                      \
  X("seed", "", COUNT(all->seed), "of the random starts", .label = {""})                           \
  X("starts", "", COUNT(all->starts), "random starts of a search", .label = {""})                  \
  X("missed", "", PART(all), "what may be missing", .rows = &missed_values, .label = {" "})        \
  X("settle", "", IF(all->settle.evaluations, PART(&all->settle)),                                 \
    "how the scene's start settled", .rows = &strut_settle_values, .label = {""})                  \
  X("start", "", IF(all->settle.evaluations > 0, TEXT(listed(all, all->start))), "where it did",   \
    .label = {"the start settles in"})                                                             \
  X("start_trouble", "", IF(all->start_trouble[0], TEXT(all->start_trouble)), "why it did not",    \
    .label = {""})                                                                                 \
  X("remark", "", TEXT(all->remark[0] ? all->remark : NULL), "why none was found, or what moves",  \
    .label = {""})                                                                                 \
  X(NULL, "", BY(shown_of(all)), "", .rows = &equilibrium_values, .label = {"equilibria"})         \
  X(NULL, "", IF(!all->shows_all, COUNT(all->count - standing_of(all))), "",                       \
    .label = {"others, that --all lists"})                                                         \
  X(NULL, "", IF(all->cut_short, TEXT(cut_short)), "", .label = {"cut short"})                     \
  X(NULL, "", LIST_WHERE(all->barriers, all->barrier_count, is_shown_barrier), "",                 \
    .rows = &barrier_values, .label = {"barriers"})                                                \
  X(NULL, "", IF(all->shows_all, LIST_WHERE(all->list, all->count, stands)), "",                   \
    .rows = &position_values, .label = {"positions"})                                              \
  X("equilibria", "", LIST(all->list, all->count), "by supports; those of the real ground last",   \
    .rows = &equilibrium_values)                                                                   \
  X("barriers", "", LIST(all->barriers, all->barrier_count), "between stable ones",                \
    .rows = &barrier_values)
STRUT_VALUES(strut_equilibria_values, EQUILIBRIA, const strut_equilibria *all = of->at)
