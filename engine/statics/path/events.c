/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/path/path_parts.h"

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
static const double APART = 1e-4;  /* [units of y] between trials about a bifurcation */

double strut_path_measure_eigenvalue(strut_path_system *system, const double *unknowns,
                                     const strut_path_piece *piece, int32_t which) {
  assert(which >= 0 && which < system->n);
  (void)piece;
  if (!strut_path_spectrum(system, unknowns)) return (double)NAN;
  return system->spectrum.value[which];
}

/* Linear interpolation between two points; must be corrected afterwards. */
static void interpolate_linearly(const strut_path_system *system, double share, const double *low,
                                 const double *high, double *unknowns) {
  for (int32_t i = 0; i < 2 * (system->n + 1); i++)
    unknowns[i] = low[i] + share * (high[i] - low[i]);
}

/* The point of the path at `place` along the tangent, begun between the two ends low and high. */
static bool point_at(strut_path_system *system, const strut_path_piece *piece, double place,
                     double share, const double *low, const double *high, double *unknowns) {
  double value = place;
  interpolate_linearly(system, share, low, high, unknowns);
  for (int32_t i = 0; i <= system->n; i++) value += piece->tangent[i] * piece->from[i];
  return strut_path_correct(system, piece->tangent, value, unknowns) >= 0;
}

/* Is another eigenvalue as near to zero? Then their order changes where they pass it: each is smooth on one side. */
static bool is_one_of_several(strut_path_system *system, const double *unknowns, int32_t which) {
  if (which < 0 || !strut_path_spectrum(system, unknowns)) return false;
  double value = fabs(system->spectrum.value[which]);
  for (int32_t i = 0; i < system->n; i++)
    if (i != which && fabs(system->spectrum.value[i]) < ALIKE * value) return true;
  return false;
}

/*
 * Where an eigenvalue vanishes near `place`. Newton's method would be led astray there, so that the
 * point is interpolated between four on its two sides, by a polynomial in the measure: near enough for a
 * cubic and far enough for Newton's method. `slope` is the measure's derivative. False: they are not to be had.
 */
static bool interpolate_fork(strut_path_system *system, const strut_path_piece *piece,
                             strut_path_measure measure, int32_t which, double scale, double slope,
                             double *place, double *unknowns) {
  static const double sides[2][KEPT] = {{-2, -1, 1, 2}, {-1, -2, -3, -4}};
  int32_t numbers = 2 * (system->n + 1), known = 0;
  double noise = which < 0 ? 0.0 : BLURRED * system->spectrum.noise;
  double apart = fmin(fmax(fmax(FORK * scale, noise) / slope, APART), 0.1 * piece->length);
  double middle = *place, at[KEPT], value[KEPT], sum = 0;
  strut_arena arena = {0};
  double *y = strut_arena_allocate(&arena, KEPT * (size_t)numbers, sizeof *y);
  int way = point_at(system, piece, middle - apart, (middle - apart) / piece->length, piece->from,
                     piece->to, unknowns) &&
            is_one_of_several(system, unknowns, which);
  for (int k = 0; k < KEPT && y; k++) {
    double *point = y + known * numbers;
    at[known] = middle + sides[way][k] * apart;
    if (!point_at(system, piece, at[known], at[known] / piece->length, piece->from, piece->to,
                  point))
      continue;
    value[known] = measure(system, point, piece, which);
    known += fabs(value[known]) <= 2 * scale;
  }
  if (known > 1) memcpy(unknowns, y, (size_t)numbers * sizeof *y);
  for (int k = 0; k < known && known > 1; k++) {
    double weight = 1;
    for (int l = 0; l < known; l++) weight *= l == k ? 1.0 : value[l] / (value[l] - value[k]);
    sum += weight * at[k];
    for (int32_t i = 0, count = numbers / 2; i < count; i++) {
      double change =
          weight * ((y[k * numbers + i] - y[i]) + (y[k * numbers + count + i] - y[count + i]));
      strut_dd moved = dd_add((strut_dd){unknowns[i], unknowns[count + i]}, dd_of(change));
      unknowns[i] = moved.hi, unknowns[count + i] = moved.lo;
    }
  }
  strut_arena_free(&arena);
  if (known < 2 || !(sum >= -NARROW * piece->length && sum <= (1 + NARROW) * piece->length))
    return false;
  *place = fmax(0.0, fmin(piece->length, sum));
  return true;
}

double strut_path_locate(strut_path_system *system, const strut_path_piece *piece,
                         strut_path_measure measure, int32_t which, double *unknowns) {
  assert(piece->length >= 0);
  system->strayed = false;
  size_t bytes = 2 * ((size_t)system->n + 1) * sizeof *unknowns;
  double at[2] = {0, piece->length}, place = -1;
  double value[2] = {measure(system, piece->from, piece, which),
                     measure(system, piece->to, piece, which)};
  double scale = fmax(fabs(value[0]), fabs(value[1])), slope = scale / piece->length;
  bool fork = measure == strut_path_measure_eigenvalue || which < 0;
  double near = (fork ? 10 * FORK : ZERO) * scale;
  strut_arena arena = {0};
  double *end[2] = {strut_arena_copy(&arena, piece->from, 1, bytes),
                    strut_arena_copy(&arena, piece->to, 1, bytes)};
  if (end[0] && end[1] && value[0] * value[1] <= 0 && scale > 0) {
    for (int k = 0, last = -1; k < MOST_TRIALS; k++) {
      double share = value[0] / (value[0] - value[1]), before = value[0] - value[1];
      place = at[0] + share * (at[1] - at[0]);
      if (at[1] > at[0]) slope = fabs(before) / (at[1] - at[0]);
      bool found = point_at(system, piece, place, share, end[0], end[1], unknowns);
      double now = found ? measure(system, unknowns, piece, which) : (double)NAN;
      if (!found || !(fabs(now) <= 2 * scale)) { /* it left the path: the last point before */
        system->strayed = !fork;
        if (!fork) place = at[0];
        interpolate_linearly(system, fork ? share : 0.0, end[0], end[1], unknowns);
        break;
      }
      if (fabs(now) <= near || at[1] - at[0] <= NARROW * piece->length) break;
      int side = now * value[1] > 0 || (now == 0 && value[1] != 0) ? 1 : 0;
      at[side] = place, value[side] = now;
      memcpy(end[side], unknowns, bytes);
      if (side == last) value[1 - side] *= 0.5;
      last = side;
    }
    memcpy(end[0], unknowns, bytes);
    if (fork && !interpolate_fork(system, piece, measure, which, scale, slope, &place, unknowns))
      memcpy(unknowns, end[0], bytes);
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

static const double LOOSE = 1e-12,
                    FIRM = 1e-10;   /* of the largest eigenvalue: none; certainly one */
static const double AHEAD = 1e-6;   /* how far along a tangent it is seen what a switch will do */
static const double STEADY = 1e-12; /* of what moves: a switch that changes less stays as it is */
static const double LAST = 1e-15;   /* of the size: likewise, by rounding */

/* The switches that stand at zero at a kink, in their order; the one that made it is `first`. */
typedef struct switch_group {
  int32_t count, first, which[MOST_TOGETHER];
  bool was_on[MOST_TOGETHER];
  double here[MOST_TOGETHER]; /* their values at the kink [m] */
} switch_group;

static switch_group collect_switches(strut_path_walk *walk, int32_t which) {
  strut_path_system *system = &walk->system;
  switch_group g = {0};
  for (int32_t k = 0; k < strut_path_switch_count(system); k++) {
    double here = strut_path_switch_value(system, k, walk->y);
    strut_path_switch_kind kind = strut_path_switch_at(system, k).of;
    if (kind == STRUT_PATH_FACET || kind == STRUT_PATH_GRIP) continue; /* are passed one by one */
    if (k == which) g.first = g.count;
    if (k != which &&
        !(fabs(here) <= STRUT_PATH_EVEN * system->size && g.count + (k < which) < MOST_TOGETHER))
      continue;
    g.which[g.count] = k;
    g.was_on[g.count] = strut_path_switch_is_on(system, k);
    g.here[g.count++] = here;
  }
  return g;
}

static void set_switches(strut_path_walk *walk, const switch_group *self, unsigned thrown) {
  strut_path_system *system = &walk->system;
  strut_path_evaluate(system, walk->y); /* what touches does so here */
  for (int32_t i = 0; i < self->count; i++)
    strut_path_switch_set(system, self->which[i], self->was_on[i] != (thrown >> i & 1));
}

/* Change of a switch's value over a small step along a tangent [m]. */
static double change_ahead(strut_path_walk *walk, const switch_group *self, int32_t i,
                           const double *tangent) {
  strut_path_system *system = &walk->system;
  memcpy(walk->spare, walk->y, 2 * ((size_t)system->n + 1) * sizeof *walk->y);
  for (int32_t k = 0; k <= system->n; k++) walk->spare[k] += AHEAD * tangent[k];
  return strut_path_switch_value(system, self->which[i], walk->spare) - self->here[i];
}

/*
 * The tangent with these switches thrown, into w->next_tangent, so that each switch continues to
 * where it was put. False: no such tangent exists, or it contradicts a switch.
 */
static bool find_tangent(strut_path_walk *walk, const switch_group *self, unsigned thrown,
                         const double *beyond) {
  strut_path_system *system = &walk->system;
  double sense = 0;
  set_switches(walk, self, thrown);
  for (int32_t i = 0; i <= system->n; i++) walk->trial[i] = beyond[i] - walk->y[i];
  if (!strut_path_tangent(system, walk->y, walk->tangent, walk->next_tangent) &&
      !strut_path_tangent(system, walk->y, walk->trial, walk->next_tangent))
    return false;
  double motion = sqrt(strut_dot(walk->next_tangent, walk->next_tangent, system->n));
  double least = fmax(STEADY * motion, LAST) * system->size;
  for (int32_t i = 0; i < self->count; i++) {
    double change = change_ahead(walk, self, i, walk->next_tangent);
    if (!(fabs(change) > least)) continue;
    bool on = self->was_on[i] != (thrown >> i & 1);
    double wanted = (change > 0) == on ? 1 : -1;
    if (sense == 0) {
      sense = wanted;
    } else if (sense != wanted) {
      return false;
    }
  }
  for (int32_t i = 0; i <= system->n && sense < 0; i++)
    walk->next_tangent[i] = -walk->next_tangent[i];
  return true;
}

/* Does a stable path continue with the parameter, and, if that is asked, without loose motions? */
static bool leads_on(strut_path_walk *walk, bool firm) {
  strut_path_system *system = &walk->system;
  return walk->tangent[system->n] * walk->next_tangent[system->n] > 0 &&
         strut_path_spectrum(system, walk->y) && system->spectrum.negative == 0 &&
         !(firm && strut_path_is_loose(system, FIRM));
}

/*
 * Chooses the switches thrown here: those that the old stiffness throws, else any consistent set. Where the parameter
 * would turn back, or a motion lose its stiffness, a stable path on which they do not goes first, but not twice in one
 * place.
 */
static bool choose_switches(strut_path_walk *walk, const switch_group *self, const double *beyond,
                            unsigned *thrown) {
  int32_t n = walk->system.n;
  unsigned first = 1u << self->first;
  for (int32_t i = 0; i < self->count; i++) {
    double value = strut_path_switch_value(&walk->system, self->which[i], beyond);
    if (self->was_on[i] ? value < 0 : value > 0) first |= 1u << i;
  }
  bool found = find_tangent(walk, self, first, beyond);
  bool turned = found && walk->tangent[n] * walk->next_tangent[n] < 0;
  *thrown = first;
  if (found && !turned && strut_path_spectrum(&walk->system, walk->y) &&
      !strut_path_is_loose(&walk->system, LOOSE))
    return true;
  const strut_path *path = walk->path;
  bool again = path->event_count && walk->arc == path->events[path->event_count - 1].at.arc;
  int most = !again ? 2 : turned ? 1 : 0; /* 2: firm, and leads on; 1: leads on; 0: any */
  int least = !found ? 0 : turned ? 1 : 2;
  for (int wish = most; wish >= least; wish--)
    for (*thrown = 1; *thrown < 1u << self->count; ++*thrown)
      if (*thrown != first && find_tangent(walk, self, *thrown, beyond) &&
          (wish < 1 || leads_on(walk, wish == 2)))
        return true;
  *thrown = first;
  if (found) return find_tangent(walk, self, first, beyond);
  set_switches(walk, self, first);
  return false;
}

/* What an element does as its switch is thrown: "m1 reaches its longest length". */
static strut_path_event_kind describe_element(const strut_path_system *system, int32_t which,
                                              bool on, char *text, size_t room) {
  const strut_scene *scene = system->model->scene;
  const strut_path_element_switch *element_switch = &system->elements.switches[which];
  const strut_element *element = &system->model->elements.element[element_switch->element];
  const char *name = strut_element_name(scene, element);
  strut_path_event_kind kind = on ? STRUT_PATH_ENGAGE : STRUT_PATH_RELEASE;
  const char *what = on ? "begins to act" : "ceases to act";
  if (element_switch->kink >= 0) {
    bool fold = strut_law_way(element->law, &element->numbers, element_switch->kink) !=
                strut_law_way(element->law, &element->numbers, element_switch->kink + 1);
    kind = STRUT_PATH_LAW, what = fold ? "reaches a fold of its law" : "passes a kink of its law";
  }
  if (element->role == STRUT_ELEMENT_LONGEST)
    what = on ? "reaches its longest length" : "leaves its longest length";
  if (element->role == STRUT_ELEMENT_SHORTEST)
    what = on ? "reaches its shortest length" : "leaves its shortest length";
  if (element->role == STRUT_ELEMENT_COLLISION) what = on ? "touches" : "separates";
  if (element_switch->kink < 0 && element->role == STRUT_ELEMENT_MEMBER) {
    bool cable = scene->members[element->item].kind == STRUT_CABLE;
    if (cable) kind = on ? STRUT_PATH_TAUT : STRUT_PATH_SLACK;
    what = cable                  ? (on ? "begins to pull" : "goes slack")
           : element->carries > 0 ? (on ? "begins to pull" : "ceases to pull")
                                  : (on ? "begins to push" : "ceases to push");
  }
  snprintf(text, room, "%s %s", name, what);
  return kind;
}

bool strut_path_is_bend(const strut_path_system *system, int32_t which) {
  const strut_path_switch found = strut_path_switch_at(system, which);
  if (found.of != STRUT_PATH_ELEMENT || system->elements.switches[found.index].kink < 0)
    return false;
  const strut_path_element_switch *own = &system->elements.switches[found.index];
  const strut_element *element = &system->model->elements.element[own->element];
  int kink = own->kink;
  return element->law == STRUT_LAW_FOLDING && element->numbers.curve->smooth &&
         strut_folding_way(element->numbers.curve, kink) ==
             strut_folding_way(element->numbers.curve, kink + 1);
}

static void report_switch(strut_path_walk *walk, int32_t which, int32_t before, int32_t after) {
  const strut_path_system *system = &walk->system;
  if (strut_path_is_bend(system, which)) return;
  const strut_scene *scene = system->model->scene;
  const strut_path_switch own = strut_path_switch_at(system, which);
  bool on = strut_path_switch_is_on(system, which);
  const char *stable = !before && after   ? ", unstable from here"
                       : before && !after ? ", stable from here"
                                          : "";
  char detail[300], what[240];
  int32_t index = which;
  strut_path_event_kind kind = on ? STRUT_PATH_TAUT : STRUT_PATH_SLACK;
  if (own.of == STRUT_PATH_ELEMENT) {
    int32_t element = system->elements.switches[own.index].element;
    kind = describe_element(system, own.index, on, what, sizeof what);
    index = kind == STRUT_PATH_TAUT || kind == STRUT_PATH_SLACK
                ? system->model->elements.element[element].item
                : element;
  } else if (own.of == STRUT_PATH_CABLE) {
    snprintf(what, sizeof what, "%s %s", scene->members[which].name,
             on ? "begins to pull" : "goes slack");
  } else {
    index = system->model->contacts.entry[own.index].node;
    kind = on ? STRUT_PATH_TOUCHDOWN : STRUT_PATH_LIFT_OFF;
    snprintf(what, sizeof what, "%s %s %s", scene->nodes[index].name, on ? "touches" : "leaves",
             strut_path_ground_name(system, own.index));
  }
  snprintf(detail, sizeof detail, "%s%s", what, stable);
  strut_path_add_event(walk, kind, walk->y, index, before, after, detail);
}

void strut_path_report_exchange(strut_path_walk *walk, double turn, int32_t before) {
  strut_path_system *system = &walk->system;
  char detail[300];
  if (turn * walk->tangent[system->n] < 0) {
    snprintf(detail, sizeof detail, "%s %s here", strut_path_subject(walk),
             strut_path_turn(walk, turn));
    strut_path_add_event(walk, STRUT_PATH_KINK_LIMIT, walk->y, 0, before, walk->negative, detail);
  } else if (before != walk->negative) {
    int32_t count = walk->negative > before ? walk->negative - before : before - walk->negative;
    snprintf(detail, sizeof detail, "%d eigenvalue%s of the stiffness jump%s %s zero%s", (int)count,
             count == 1 ? "" : "s", count == 1 ? "s" : "",
             walk->negative > before ? "below" : "above",
             count % 2 ? "; another path branches off" : "");
    strut_path_add_event(walk, STRUT_PATH_KINK_BIFURCATION, walk->y, 0, before, walk->negative,
                         detail);
  }
}

bool strut_path_pass_kink(strut_path_walk *walk, int32_t which, const double *beyond) {
  strut_path_system *system = &walk->system;
  switch_group g = collect_switches(walk, which);
  double turn = walk->tangent[system->n];
  int32_t before = walk->negative;
  unsigned thrown;
  bool found = choose_switches(walk, &g, beyond, &thrown);
  if (found)
    memcpy(walk->tangent, walk->next_tangent, ((size_t)system->n + 1) * sizeof *walk->tangent);
  strut_path_count_negative(walk);
  int32_t last = g.count - 1;
  while (!(thrown >> last & 1)) last--;
  for (int32_t i = 0; i <= last; i++)
    if (thrown >> i & 1)
      report_switch(walk, g.which[i], before, i == last ? walk->negative : before);
  bool turned = found && turn * walk->tangent[system->n] < 0;
  if (turned && strut_path_leave_mechanism(walk, walk->y, turn)) return true;
  if (found) strut_path_report_exchange(walk, turn, before);
  return found;
}
