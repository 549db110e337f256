/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Warnings about valid scenes: properties that are rarely intended, once per cause with the first
 * names. See check.h.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/text.h"
#include "engine/scene/checks/check_rules.h"
#include "engine/scene/profile.h"

enum { NAMED = 3, SAMPLES = 1000, MOST_TIMES = 256 };

/*
 * Nodes start inside the ground if they are this many times deeper than all weight on one of them
 * would press it, and deeper than this part of the size of the structure.
 */
static const double DEEPER = 10.0, DEEP = 1e-6;

/* Items of one warning. */
typedef struct named {
  size_t count, first; /* index of the first */
  char names[600];
} named;

static void add_name(named *all, size_t index, const char *text) {
  size_t used = strlen(all->names);
  if (!all->count) all->first = index;
  if (all->count < NAMED)
    snprintf(all->names + used, sizeof all->names - used, "%s%.150s", all->count ? ", " : "", text);
  all->count++;
}

/* "a, b, c and 2 more" */
static const char *list_names(named *all) {
  size_t used = strlen(all->names);
  if (all->count > NAMED)
    snprintf(all->names + used, sizeof all->names - used, " and %zu more", all->count - NAMED);
  all->count = all->count > NAMED ? NAMED : all->count;
  return all->names;
}

static bool drives_length_of(const strut_actuator *actuator, size_t member) {
  return !actuator->force && actuator->member >= 0 && (size_t)actuator->member == member;
}

static double rest_length_at(const strut_scene *scene, size_t member, double rest, double t) {
  for (size_t i = 0; i < scene->actuator_count; i++) {
    double value, rate;
    if (!drives_length_of(&scene->actuators[i], member)) continue;
    strut_signal_evaluate(scene->signals, scene->actuators[i].signal, t, &value, &rate);
    rest += value;
  }
  return rest;
}

/* The largest magnitude of a wave or a sum of waves; INFINITY of others. */
static double most_of(const strut_signal *signals, int32_t index) {
  const strut_signal *signal = &signals[index];
  double sum = 0.0;
  if (signal->kind <= STRUT_SQUARE) return fabs(signal->amplitude);
  if (signal->kind != STRUT_SUM) return (double)INFINITY;
  for (size_t i = 0; i < signal->term_count; i++) sum += most_of(signals, signal->terms[i]);
  return sum;
}

/* Are the drives of the member too small to take all of its rest length? */
static bool leaves_length(const strut_scene *scene, size_t member, double rest) {
  for (size_t i = 0; i < scene->actuator_count; i++)
    if (drives_length_of(&scene->actuators[i], member))
      rest -= most_of(scene->signals, scene->actuators[i].signal);
  return rest > 0.0;
}

/* Finds the shortest rest length up to the time `last` [s], and its time. */
static double find_shortest_rest_length(const strut_scene *scene, double last, size_t member,
                                        double rest, double *when) {
  double least = (double)INFINITY, time[MOST_TIMES];
  for (int k = 0; k <= SAMPLES; k++) {
    double t = last * k / SAMPLES, length = rest_length_at(scene, member, rest, t);
    if (length < least) least = length, *when = t;
  }
  for (size_t i = 0; i < scene->actuator_count; i++) {
    if (!drives_length_of(&scene->actuators[i], member)) continue;
    size_t count =
        strut_signal_times(scene->signals, scene->actuators[i].signal, 0.0, last, time, MOST_TIMES);
    for (size_t k = 0; k < count; k++) {
      double length = rest_length_at(scene, member, rest, time[k]);
      if (length < least) least = length, *when = time[k];
    }
  }
  return least;
}

static void warn_of_rest_lengths(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  named below = {0};
  double worst = 0.0, when = 0.0;
  double last = strut_experiment_span(checker->experiment, scene).duration;
  for (size_t i = 0; i < scene->actuator_count; i++) {
    size_t member = (size_t)scene->actuators[i].member, earlier = 0;
    if (scene->actuators[i].member < 0 || scene->actuators[i].force) continue;
    while (!drives_length_of(&scene->actuators[earlier], member)) earlier++;
    strut_rest rest;
    double t = 0.0;
    if (earlier < i || !strut_member_rest(scene, member, &rest) ||
        leaves_length(scene, member, rest.length))
      continue;
    double least = find_shortest_rest_length(scene, last, member, rest.length, &t);
    if (!(least < -1e-9 * rest.length)) continue;
    if (!below.count) worst = least, when = t;
    add_name(&below, member, scene->members[member].name);
  }
  if (!below.count) return;
  strut_report_finding(checker, STRUT_ON_MEMBER, below.first, "rest_length_below_zero",
                       "the drive takes the rest length of '%s' to %.4g m at t = %.4g s, which is "
                       "below zero; use a smaller amplitude or a longer member%s%s",
                       scene->members[below.first].name, worst, when,
                       below.count > 1 ? "; the same of " : "",
                       below.count > 1 ? list_names(&below) : "");
}

static void warn_of_depths(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_ground *ground = &scene->ground;
  double s = sin(ground->slope), c = cos(ground->slope), weight = 0.0, low[2] = {0.0},
         high[2] = {0.0};
  named below = {0};
  double depth_of_first = 0.0;
  int32_t last = -1;
  for (size_t i = 0; i < scene->node_count; i++) {
    weight += scene->nodes[i].mass;
    for (int d = 0; d < 2; d++) {
      double x = scene->nodes[i].start[d];
      low[d] = i && low[d] < x ? low[d] : x, high[d] = i && high[d] > x ? high[d] : x;
    }
  }
  for (size_t i = 0; i < scene->member_count; i++) weight += scene->members[i].mass;
  double whole = weight * hypot(scene->gravity[0], scene->gravity[1]);
  weight *= fmax(0.0, s * scene->gravity[0] - c * scene->gravity[1]);
  double size = scene->node_count ? hypot(high[0] - low[0], high[1] - low[1]) : 0.0;
  for (size_t i = 0; i < scene->contact_count; i++) {
    const strut_contact *contact = &scene->contacts[i];
    const strut_node *node = &scene->nodes[contact->node];
    if (contact->piece || contact->node == last || (node->fixed[0] && node->fixed[1])) continue;
    double depth = s * node->start[0] - c * (node->start[1] - ground->height),
           size_of_load = weight;
    if (scene->ground_count) {
      depth = strut_ground_depth(&scene->grounds[contact->ground], node->start);
      size_of_load = whole;
    }
    if (!(depth > DEEPER * size_of_load / contact->stiffness && depth > DEEP * size)) continue;
    last = contact->node;
    if (!below.count) depth_of_first = depth;
    add_name(&below, (size_t)contact->node, node->name);
  }
  if (below.count)
    strut_report_finding(checker, STRUT_ON_NODE, below.first, "inside_ground",
                         "node%s %s start%s inside the ground, '%s' %.3g m deep, and will be "
                         "ejected; %s",
                         below.count > 1 ? "s" : "", list_names(&below), below.count > 1 ? "" : "s",
                         scene->nodes[below.first].name, depth_of_first,
                         scene->ground_count ? "move the structure, or the ground"
                                             : "raise the structure, or lower ground.height");
}

typedef struct pair {
  int32_t low, high;
  size_t member;
} pair;

static int compare_pairs(const void *first, const void *second) {
  const pair *self = first, *y = second;
  if (self->low != y->low) return self->low < y->low ? -1 : 1;
  if (self->high != y->high) return self->high < y->high ? -1 : 1;
  return self->member < y->member ? -1 : self->member > y->member;
}

static bool only_damps(const strut_member *member) {
  return !(member->stiffness > 0.0) && !(member->axial_stiffness > 0.0);
}

static void warn_of_pairs(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  pair *pairs = strut_allocate(scene->member_count, sizeof *pairs);
  named twice = {0};
  if (!pairs) {
    checker->out_of_memory = true;
    return;
  }
  for (size_t i = 0; i < scene->member_count; i++) {
    int32_t a = scene->members[i].node[0], b = scene->members[i].node[1];
    if (scene->members[i].guide_count) a = -1, b = -(int32_t)i; /* like no other */
    pairs[i] = (pair){a < b ? a : b, a < b ? b : a, i};
  }
  if (scene->member_count) qsort(pairs, scene->member_count, sizeof *pairs, compare_pairs);
  for (size_t i = 1; i < scene->member_count; i++) {
    const strut_member *member = &scene->members[pairs[i - 1].member],
                       *n = &scene->members[pairs[i].member];
    char text[200];
    if (pairs[i].low != pairs[i - 1].low || pairs[i].high != pairs[i - 1].high) continue;
    if (only_damps(member) != only_damps(n)) continue; /* a spring and its damper */
    if (member->law.kind != STRUT_LAW_LINEAR && n->law.kind != STRUT_LAW_LINEAR)
      continue; /* as in an Iwan model */
    snprintf(text, sizeof text, "'%.80s' and '%.80s'", member->name, n->name);
    add_name(&twice, pairs[i].member, text);
  }
  strut_release(pairs);
  if (twice.count)
    strut_report_finding(checker, STRUT_ON_MEMBER, twice.first, "same_nodes",
                         "members %s join the same two nodes, so that both act there; remove one "
                         "if that is not intended",
                         list_names(&twice));
}

/* Warns of masses without members, if the scene has members. */
static void warn_of_loose_masses(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  unsigned char *used = strut_joined_nodes(checker);
  named loose = {0};
  if (!used) return;
  for (size_t i = 0; i < scene->node_count && scene->member_count; i++) {
    const strut_node *node = &scene->nodes[i];
    if (!used[i] && node->mass > 0.0 && !(node->fixed[0] && node->fixed[1]))
      add_name(&loose, i, node->name);
  }
  strut_release(used);
  if (loose.count)
    strut_report_finding(checker, STRUT_ON_NODE, loose.first, "loose_mass",
                         "node%s %s %s mass and can move, but no member holds %s",
                         loose.count > 1 ? "s" : "", list_names(&loose),
                         loose.count > 1 ? "have" : "has", loose.count > 1 ? "them" : "it");
}

strut_status strut_setup_warn(const strut_setup *setup, strut_findings *warnings) {
  const strut_scene *scene = &setup->scene;
  strut_checker checker = {.scene = scene, .experiment = &setup->experiment, .findings = warnings};
  strut_c_locale locale = strut_c_locale_enter();
  if (strut_experiment_span(&setup->experiment, scene).duration > 0.0)
    warn_of_rest_lengths(&checker);
  if (strut_scene_has_ground(scene)) warn_of_depths(&checker);
  warn_of_pairs(&checker);
  warn_of_loose_masses(&checker);
  strut_warn_of_overlaps(&checker);
  strut_c_locale_leave(locale);
  return checker.out_of_memory ? STRUT_NO_MEMORY : STRUT_OK;
}
