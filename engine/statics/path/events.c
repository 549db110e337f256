/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/path/path_parts.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Regula falsi with the Illinois correction; each trial is corrected back onto the path. */

enum { MOST_TRIALS = 60, KEPT = 4 };

static const double ZERO = 1e-13;   /* of the measure at the ends */
static const double NARROW = 1e-13; /* of the piece's length */
/*
 * Of the eigenvalue at the ends. Nearer to zero Newton's method may leave by the other branch, and
 */
static const double FORK = 1e-4;
static const double BLURRED = 100; /* and this many roundings of the stiffness */
static const double ALIKE = 20;    /* over an eigenvalue: another one that is near zero beside it */
static const double APART =
    1e-4; /* [units of y] between trials about a bifurcation, where the piece has room */

double strut_path_measure_switch(strut_path_system *s, const double *y,
                                 const strut_path_piece *piece, int32_t which) {
  bool grip =
      which >= strut_path_first_grip_switch(s) && which < strut_path_first_element_switch(s);
  return grip ? strut_path_measure_grip(s, y, piece, which) : strut_path_switch_value(s, which, y);
}

double strut_path_measure_eigenvalue(strut_path_system *s, const double *y,
                                     const strut_path_piece *piece, int32_t which) {
  assert(which >= 0 && which < s->n);
  (void)piece;
  if (!strut_path_spectrum(s, y, STRUT_PATH_VALUES)) return (double)NAN;
  return s->spectrum.value[which];
}

/* Linear interpolation between two points; must be corrected afterwards. */
static void interpolate_linearly(const strut_path_system *s, double share, const double *low,
                                 const double *high, double *y) {
  for (int32_t i = 0; i < 2 * (s->n + 1); i++) y[i] = low[i] + share * (high[i] - low[i]);
}

/* The point of the path at `place` along the tangent, begun between the two ends low and high. */
static bool point_at(strut_path_system *s, const strut_path_piece *piece, double place,
                     double share, const double *low, const double *high, double *y) {
  double value = place;
  interpolate_linearly(s, share, low, high, y);
  for (int32_t i = 0; i <= s->n; i++) value += piece->tangent[i] * piece->from[i];
  return strut_path_correct(s, piece->tangent, value, y) >= 0;
}

/* Points of the path where the measure is known, those nearest to zero first. */
typedef struct trial {
  double place, value, *y; /* y (2 n + 2) */
} trial;

typedef struct trials {
  strut_path_measure measure;
  int32_t which; /* eigenvalue that is followed */
  int count;
  trial kept[KEPT];
} trials;

static bool make_trials(const strut_path_system *s, strut_arena *arena, trials *t) {
  for (int k = 0; k < KEPT; k++) {
    t->kept[k].y = strut_arena_allocate(arena, 2 * ((size_t)s->n + 1), sizeof(double));
    if (!t->kept[k].y) return false;
  }
  return true;
}

static void keep_trial(const strut_path_system *s, trials *t, double place, double value,
                       const double *y) {
  int at = t->count < KEPT ? t->count++ : KEPT;
  if (at == KEPT && !(fabs(value) < fabs(t->kept[--at].value))) return;
  double *block = t->kept[at].y;
  for (; at > 0 && fabs(value) < fabs(t->kept[at - 1].value); at--) t->kept[at] = t->kept[at - 1];
  t->kept[at] = (trial){place, value, block};
  memcpy(block, y, 2 * ((size_t)s->n + 1) * sizeof *y);
}

/*
 * Where the measure vanishes, by a polynomial in it through the trials kept; false: off the piece.
 */
static bool interpolate(const strut_path_system *s, const trials *t, double length, double *place,
                        double *y) {
  double weight[KEPT], sum = 0;
  const trial *nearest = &t->kept[0];
  for (int k = 0; k < t->count; k++) {
    weight[k] = 1;
    for (int l = 0; l < t->count; l++)
      if (l != k) weight[k] *= t->kept[l].value / (t->kept[l].value - t->kept[k].value);
    sum += weight[k] * t->kept[k].place;
  }
  if (!(sum >= -NARROW * length && sum <= (1 + NARROW) * length)) return false;
  *place = fmax(0.0, fmin(length, sum));
  for (int32_t i = 0, count = s->n + 1; i < count; i++) {
    double change = 0;
    for (int k = 1; k < t->count; k++)
      change += weight[k] * ((t->kept[k].y[i] - nearest->y[i]) +
                             (t->kept[k].y[count + i] - nearest->y[count + i]));
    strut_dd at = dd_add((strut_dd){nearest->y[i], nearest->y[count + i]}, dd_of(change));
    y[i] = at.hi, y[count + i] = at.lo;
  }
  return true;
}

/* Is another eigenvalue as near to zero? Then their order changes where they pass it: each is smooth on one side. */
static bool is_one_of_several(strut_path_system *s, const double *y, int32_t which) {
  if (which < 0 || !strut_path_spectrum(s, y, STRUT_PATH_VALUES)) return false;
  double value = fabs(s->spectrum.value[which]);
  for (int32_t i = 0; i < s->n; i++)
    if (i != which && fabs(s->spectrum.value[i]) < ALIKE * value) return true;
  return false;
}

/*
 * Where an eigenvalue vanishes near `place`. Newton's method would be led astray there, so that the
 * point is interpolated between four on its two sides, near enough for a cubic and far enough for
 * Newton's method. `slope` is the measure's derivative. False: they are not to be had.
 */
static bool interpolate_fork(strut_path_system *s, const strut_path_piece *piece, double scale,
                             double slope, trials *t, double *place, double *y) {
  static const double sides[2][KEPT] = {{-2, -1, 1, 2}, {-1, -2, -3, -4}};
  double noise = t->which < 0 ? 0.0 : BLURRED * s->spectrum.noise;
  double apart = fmin(fmax(fmax(FORK * scale, noise) / slope, APART), 0.1 * piece->length);
  double middle = *place;
  int way = point_at(s, piece, middle - apart, (middle - apart) / piece->length, piece->from,
                     piece->to, y) &&
            is_one_of_several(s, y, t->which);
  t->count = 0;
  for (int k = 0; k < KEPT; k++) {
    double at = middle + sides[way][k] * apart;
    if (!point_at(s, piece, at, at / piece->length, piece->from, piece->to, y)) continue;
    double value = t->measure(s, y, piece, t->which);
    if (fabs(value) <= 2 * scale) keep_trial(s, t, at, value, y);
  }
  return t->count > 1 && interpolate(s, t, piece->length, place, y);
}

double strut_path_locate(strut_path_system *s, const strut_path_piece *piece,
                         strut_path_measure measure, int32_t which, double *y) {
  assert(piece->length >= 0);
  s->strayed = false;
  size_t bytes = 2 * ((size_t)s->n + 1) * sizeof *y;
  double at[2] = {0, piece->length}, place = -1;
  double value[2] = {measure(s, piece->from, piece, which), measure(s, piece->to, piece, which)};
  double scale = fmax(fabs(value[0]), fabs(value[1])), slope = scale / piece->length;
  bool fork = measure == strut_path_measure_eigenvalue || which < 0;
  double near = (fork ? 10 * FORK : ZERO) * scale;
  strut_arena arena = {0};
  trials t = {.measure = measure, .which = which};
  double *end[2] = {strut_arena_allocate(&arena, 1, bytes), strut_arena_allocate(&arena, 1, bytes)};
  if (end[0] && end[1] && make_trials(s, &arena, &t) && value[0] * value[1] <= 0 && scale > 0) {
    memcpy(end[0], piece->from, bytes);
    memcpy(end[1], piece->to, bytes);
    for (int k = 0, last = -1; k < MOST_TRIALS; k++) {
      double share = value[0] / (value[0] - value[1]), before = value[0] - value[1];
      place = at[0] + share * (at[1] - at[0]);
      if (at[1] > at[0]) slope = fabs(before) / (at[1] - at[0]);
      bool found = point_at(s, piece, place, share, end[0], end[1], y);
      double now = found ? measure(s, y, piece, which) : (double)NAN;
      if (!found || !(fabs(now) <= 2 * scale)) { /* it left the path: the last point before */
        s->strayed = !fork;
        if (!fork) place = at[0];
        interpolate_linearly(s, fork ? share : 0.0, end[0], end[1], y);
        break;
      }
      if (fabs(now) <= near || at[1] - at[0] <= NARROW * piece->length) break;
      int side = now * value[1] > 0 || (now == 0 && value[1] != 0) ? 1 : 0;
      at[side] = place, value[side] = now;
      memcpy(end[side], y, bytes);
      if (side == last) value[1 - side] *= 0.5;
      last = side;
    }
    double *rough = end[0];
    memcpy(rough, y, bytes);
    if (fork && !interpolate_fork(s, piece, scale, slope, &t, &place, y)) memcpy(y, rough, bytes);
  }
  strut_arena_free(&arena);
  return place;
}

/*
 * A kink of the path: a cable goes slack or taut, a node touches or leaves the ground. The
 * stiffness jumps there, so that the parameter may turn back, and stability change, with no
 * eigenvalue at zero.
 */

/* Switches at one kink of which all combinations are tried. */
enum { MOST_TOGETHER = 10 };

static const double AHEAD = 1e-6;   /* how far along a tangent it is seen what a switch will do */
static const double STEADY = 1e-12; /* of the size: a switch that changes less stays as it is */

/* The switches that stand at zero at a kink, in their order; the one that made it is `first`. */
typedef struct switch_group {
  int32_t count, first, which[MOST_TOGETHER];
  bool was_on[MOST_TOGETHER];
  double here[MOST_TOGETHER]; /* their values at the kink [m] */
} switch_group;

static bool is_thrown(bool on, double value) { return on ? value < 0 : value > 0; }

static switch_group collect_switches(strut_path_walk *w, int32_t which) {
  strut_path_system *s = &w->system;
  switch_group g = {0};
  for (int32_t k = 0; k < strut_path_switch_count(s); k++) {
    double here = strut_path_switch_value(s, k, w->y);
    if (k >= strut_path_first_corner_switch(s) && k < strut_path_first_element_switch(s))
      continue; /* they are passed one by one */
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

static void set_switches(strut_path_walk *w, const switch_group *g, unsigned thrown) {
  strut_path_system *s = &w->system;
  strut_path_evaluate(s, w->y); /* what touches does so here */
  for (int32_t i = 0; i < g->count; i++)
    strut_path_switch_set(s, g->which[i], g->was_on[i] != (thrown >> i & 1));
}

/* Change of a switch's value over a small step along a tangent [m]. */
static double change_ahead(strut_path_walk *w, const switch_group *g, int32_t i,
                           const double *tangent) {
  strut_path_system *s = &w->system;
  memcpy(w->spare, w->y, 2 * ((size_t)s->n + 1) * sizeof *w->y);
  for (int32_t k = 0; k <= s->n; k++) w->spare[k] += AHEAD * tangent[k];
  return strut_path_switch_value(s, g->which[i], w->spare) - g->here[i];
}

/*
 * The tangent with these switches thrown, into w->next_tangent, so that each switch continues to
 * where it was put. False: no such tangent exists, or it contradicts a switch.
 */
static bool find_tangent(strut_path_walk *w, const switch_group *g, unsigned thrown,
                         const double *beyond) {
  strut_path_system *s = &w->system;
  double sense = 0;
  set_switches(w, g, thrown);
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

/*
 * Chooses the switches thrown here: those that the old stiffness throws, else any consistent set.
 */
static bool choose_switches(strut_path_walk *w, const switch_group *g, const double *beyond,
                            unsigned *thrown) {
  unsigned first = 1u << g->first;
  for (int32_t i = 0; i < g->count; i++)
    if (is_thrown(g->was_on[i], strut_path_switch_value(&w->system, g->which[i], beyond)))
      first |= 1u << i;
  *thrown = first;
  if (find_tangent(w, g, first, beyond)) return true;
  for (*thrown = 1; *thrown < 1u << g->count; ++*thrown)
    if (*thrown != first && find_tangent(w, g, *thrown, beyond)) return true;
  set_switches(w, g, first);
  *thrown = first;
  return false;
}

/* What an element does as its switch is thrown: "m1 reaches its longest length". */
static strut_path_event_kind describe_element(const strut_path_system *s, int32_t which, bool on,
                                              char *text, size_t room) {
  const strut_scene *scene = s->model->scene;
  const strut_path_element_switch *w = &s->elements.switches[which];
  const strut_element *e = &s->model->elements.element[w->element];
  const char *name = strut_element_name(scene, e);
  strut_path_event_kind kind = on ? STRUT_PATH_ENGAGE : STRUT_PATH_RELEASE;
  const char *what = on ? "begins to act" : "ceases to act";
  if (w->kink >= 0) {
    bool fold = strut_law_way(e->law, &e->numbers, w->kink) !=
                strut_law_way(e->law, &e->numbers, w->kink + 1);
    kind = STRUT_PATH_LAW, what = fold ? "reaches a fold of its law" : "passes a kink of its law";
  }
  if (e->role == STRUT_ELEMENT_LONGEST)
    what = on ? "reaches its longest length" : "leaves its longest length";
  if (e->role == STRUT_ELEMENT_SHORTEST)
    what = on ? "reaches its shortest length" : "leaves its shortest length";
  if (e->role == STRUT_ELEMENT_COLLISION) what = on ? "touches" : "separates";
  if (w->kink < 0 && e->role == STRUT_ELEMENT_MEMBER) {
    bool cable = scene->members[e->item].kind == STRUT_CABLE;
    if (cable) kind = on ? STRUT_PATH_TAUT : STRUT_PATH_SLACK;
    what = cable            ? (on ? "begins to pull" : "goes slack")
           : e->carries > 0 ? (on ? "begins to pull" : "ceases to pull")
                            : (on ? "begins to push" : "ceases to push");
  }
  snprintf(text, room, "%s %s", name, what);
  return kind;
}

bool strut_path_is_bend(const strut_path_system *s, int32_t which) {
  int32_t k = which - strut_path_first_element_switch(s);
  if (k < 0 || s->elements.switches[k].kink < 0) return false;
  const strut_element *e = &s->model->elements.element[s->elements.switches[k].element];
  int kink = s->elements.switches[k].kink;
  return e->law == STRUT_LAW_FOLDING && e->numbers.curve->smooth &&
         strut_folding_way(e->numbers.curve, kink) == strut_folding_way(e->numbers.curve, kink + 1);
}

static void report_switch(strut_path_walk *w, int32_t which, int32_t before, int32_t after) {
  const strut_path_system *s = &w->system;
  if (strut_path_is_bend(s, which)) return;
  const strut_scene *scene = s->model->scene;
  int32_t members = s->model->members.count, elements = strut_path_first_element_switch(s);
  bool on = strut_path_switch_is_on(s, which);
  const char *stable = !before && after   ? ", unstable from here"
                       : before && !after ? ", stable from here"
                                          : "";
  char detail[300], what[240];
  int32_t index = which;
  strut_path_event_kind kind = on ? STRUT_PATH_TAUT : STRUT_PATH_SLACK;
  if (which >= elements) {
    int32_t element = s->elements.switches[which - elements].element;
    kind = describe_element(s, which - elements, on, what, sizeof what);
    index = kind == STRUT_PATH_TAUT || kind == STRUT_PATH_SLACK
                ? s->model->elements.element[element].item
                : element;
  } else if (which < members) {
    snprintf(what, sizeof what, "%s %s", scene->members[which].name,
             on ? "begins to pull" : "goes slack");
  } else {
    int32_t contact = which - members;
    index = s->model->contacts.entry[contact].node;
    kind = on ? STRUT_PATH_TOUCHDOWN : STRUT_PATH_LIFT_OFF;
    snprintf(what, sizeof what, "%s %s %s", scene->nodes[index].name, on ? "touches" : "leaves",
             strut_path_ground_name(s, contact));
  }
  snprintf(detail, sizeof detail, "%s%s", what, stable);
  strut_path_add_event(w, kind, w->y, index, before, after, detail);
}

void strut_path_report_exchange(strut_path_walk *w, double turn, int32_t before) {
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
  switch_group g = collect_switches(w, which);
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
  if (found) strut_path_report_exchange(w, turn, before);
  return found;
}
