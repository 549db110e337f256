/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A kink of the path: a cable goes slack or taut, a node touches or leaves the ground. The stiffness
 * jumps there, so that the parameter may turn back, and stability change, with no eigenvalue at zero.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/statics/path/walk.h"

/* Switches at one kink of which all combinations are tried. */
enum { MOST_TOGETHER = 10 };

static const double AHEAD = 1e-6;   /* how far along a tangent it is seen what a switch will do */
static const double STEADY = 1e-12; /* of the size: a switch that changes less stays as it is */

/* The switches that stand at zero at a kink, in their order; the one that made it is `first`. */
typedef struct gathering {
  int32_t count, first, which[MOST_TOGETHER];
  bool was_on[MOST_TOGETHER];
  double here[MOST_TOGETHER]; /* their values at the kink [m] */
} gathering;

static bool is_thrown(bool on, double value) { return on ? value < 0 : value > 0; }

static gathering gather(strut_path_walk *w, int32_t which) {
  strut_path_system *s = &w->system;
  gathering g = {0};
  for (int32_t k = 0; k < strut_path_switch_count(s); k++) {
    double here = strut_path_switch_value(s, k, w->y);
    if (k == which) g.first = g.count;
    if (k != which &&
        !(fabs(here) <= STRUT_PATH_EVEN * s->size && g.count + (k < which) < MOST_TOGETHER))
      continue;
    g.which[g.count] = k;
    g.was_on[g.count] = strut_path_switch_is_on(s, k);
    g.here[g.count++] = here;
  }
  return g;
}

static void set_switches(strut_path_system *s, const gathering *g, unsigned thrown) {
  for (int32_t i = 0; i < g->count; i++)
    strut_path_switch_set(s, g->which[i], g->was_on[i] != (thrown >> i & 1));
}

/* How much a switch's value changes a little ahead along a tangent [m]. */
static double change_ahead(strut_path_walk *w, const gathering *g, int32_t i,
                           const double *tangent) {
  strut_path_system *s = &w->system;
  memcpy(w->spare, w->y, 2 * ((size_t)s->n + 1) * sizeof *w->y);
  for (int32_t k = 0; k <= s->n; k++) w->spare[k] += AHEAD * tangent[k];
  return strut_path_switch_value(s, g->which[i], w->spare) - g->here[i];
}

/*
 * The tangent with these switches thrown, into w->next_tangent, so that each switch goes on to where
 * it was put. False: there is none, or it contradicts a switch.
 */
static bool find_tangent(strut_path_walk *w, const gathering *g, unsigned thrown,
                         const double *beyond) {
  strut_path_system *s = &w->system;
  double sense = 0;
  set_switches(s, g, thrown);
  for (int32_t i = 0; i <= s->n; i++) w->trial[i] = beyond[i] - w->y[i];
  if (!strut_path_tangent(s, w->y, w->tangent, w->next_tangent) &&
      !strut_path_tangent(s, w->y, w->trial, w->next_tangent))
    return false;
  for (int32_t i = 0; i < g->count; i++) {
    double change = change_ahead(w, g, i, w->next_tangent);
    if (!(fabs(change) > STEADY * s->size)) continue;
    bool on = g->was_on[i] != (thrown >> i & 1);
    double wanted = (change > 0) == on ? 1 : -1;
    if (sense == 0) {
      sense = wanted;
    } else if (sense != wanted) {
      return false;
    }
  }
  for (int32_t i = 0; i <= s->n && sense < 0; i++) w->next_tangent[i] = -w->next_tangent[i];
  return true;
}

/* The switches that go on from here: those that the old stiffness throws, else any that agree. */
static bool choose_switches(strut_path_walk *w, const gathering *g, const double *beyond,
                            unsigned *thrown) {
  unsigned first = 1u << g->first;
  for (int32_t i = 0; i < g->count; i++)
    if (is_thrown(g->was_on[i], strut_path_switch_value(&w->system, g->which[i], beyond)))
      first |= 1u << i;
  *thrown = first;
  if (find_tangent(w, g, first, beyond)) return true;
  for (*thrown = 1; *thrown < 1u << g->count; ++*thrown)
    if (*thrown != first && find_tangent(w, g, *thrown, beyond)) return true;
  set_switches(&w->system, g, first);
  *thrown = first;
  return false;
}

static void report_switch(strut_path_walk *w, int32_t which, int32_t before, int32_t after) {
  const strut_scene *scene = w->system.model->scene;
  int32_t members = w->system.model->members.count;
  bool on = strut_path_switch_is_on(&w->system, which);
  const char *stable = !before && after   ? ", unstable from here"
                       : before && !after ? ", stable from here"
                                          : "";
  char detail[300];
  if (which < members) {
    snprintf(detail, sizeof detail, "%s %s%s", scene->members[which].name,
             on ? "begins to pull" : "goes slack", stable);
    strut_path_add_event(w, on ? STRUT_PATH_TAUT : STRUT_PATH_SLACK, w->y, which, before, after,
                         detail);
    return;
  }
  int32_t node = w->system.model->contacts.entry[which - members].node;
  snprintf(detail, sizeof detail, "%s %s%s", scene->nodes[node].name,
           on ? "touches the ground" : "leaves the ground", stable);
  strut_path_add_event(w, on ? STRUT_PATH_TOUCHDOWN : STRUT_PATH_LIFT_OFF, w->y, node, before,
                       after, detail);
}

/* What the kink does besides: the parameter turns back, or stability changes though it goes on. */
static void report_exchange(strut_path_walk *w, double turn, int32_t before) {
  strut_path_system *s = &w->system;
  char detail[300];
  if (turn * w->tangent[s->n] < 0) {
    snprintf(detail, sizeof detail, "%s %s here", strut_path_subject(w), strut_path_turn(w, turn));
    strut_path_add_event(w, STRUT_PATH_KINK_LIMIT, w->y, 0, before, w->negative, detail);
  } else if (before != w->negative) {
    int32_t count = w->negative > before ? w->negative - before : before - w->negative;
    snprintf(detail, sizeof detail, "%d eigenvalue%s of the stiffness jump%s %s zero%s", (int)count,
             count == 1 ? "" : "s", count == 1 ? "s" : "", w->negative > before ? "below" : "above",
             count % 2 ? "; another path branches off" : "");
    strut_path_add_event(w, STRUT_PATH_KINK_BIFURCATION, w->y, 0, before, w->negative, detail);
  }
}

bool strut_path_pass_kink(strut_path_walk *w, int32_t which, const double *beyond) {
  strut_path_system *s = &w->system;
  gathering g = gather(w, which);
  double turn = w->tangent[s->n];
  int32_t before = w->negative;
  unsigned thrown;
  bool found = choose_switches(w, &g, beyond, &thrown);
  if (found) memcpy(w->tangent, w->next_tangent, ((size_t)s->n + 1) * sizeof *w->tangent);
  strut_path_count_negative(w);
  int32_t last = g.count - 1;
  while (!(thrown >> last & 1)) last--;
  for (int32_t i = 0; i <= last; i++)
    if (thrown >> i & 1) report_switch(w, g.which[i], before, i == last ? w->negative : before);
  if (found) report_exchange(w, turn, before);
  return found;
}
