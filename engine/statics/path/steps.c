/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The next point of a path, on the branch of the present one. */
#include <math.h>
#include <string.h>

#include "engine/base/interpolation.h"
#include "engine/statics/algebra.h"
#include "engine/statics/path/path_parts.h"

enum { SLOW = 8, PARTS = 4 };

static const double SHORTEST = 1e-9; /* step [units of y] */
static const double BLUNT = 1e-6;    /* step over a kink that is not located */
static const double BEND = 0.97;     /* cosine that tangents of neighbouring points keep */
static const double ASIDE = 0.06;    /* [rad] of a step against the mean of its tangents */
static const double FINEST = 1e-7;   /* step within which a bifurcation is one point */
static const double PLAIN = 1e-4;    /* likewise, a limit point */
static const double SAME = 1e-3;     /* of a step: its end when it is taken again */
static const double SOON = 0.5;   /* of its change: an eigenvalue so near zero may have passed it */
static const double LEVEL = 1e-9; /* a rate of the parameter that has no sign */
static const double PLACED = 1e-3; /* a part of a step in which changes are located */
static const double BLURRED = 100; /* roundings of the stiffness: an eigenvalue has no sign */
static const double ROUNDED = 30;  /* the same over a step's length, where elements act */
static const double share[PARTS] = {0.23, 0.51, 0.74, 1.0};

/* Is the step the chord of an arc with the tangents of its ends, or a jump to another one beside it? */
static bool is_arc(const strut_path_walk *walk) {
  double length = strut_path_distance(walk, walk->next, walk->y), sum = 0, aside = 0;
  for (int32_t i = 0; i <= walk->system.n; i++) {
    double mean = walk->tangent[i] + walk->next_tangent[i];
    sum += mean * mean;
  }
  for (int32_t i = 0; i <= walk->system.n; i++) {
    double mean = (walk->tangent[i] + walk->next_tangent[i]) / sqrt(sum);
    double off = (walk->next[i] - walk->y[i]) / length - mean;
    aside += off * off;
  }
  return aside <= ASIDE * ASIDE;
}

/* A step of the present length: the next point and its tangent, which may differ from this one as `bend` says. */
static bool try_step(strut_path_walk *walk, double bend) {
  strut_path_system *system = &walk->system;
  double here = strut_path_dot(walk, walk->tangent, walk->y);
  memcpy(walk->next, walk->y, strut_path_bytes(walk));
  for (int32_t i = 0; i <= system->n; i++) walk->next[i] += walk->step * walk->tangent[i];
  int used = strut_path_correct(system, walk->tangent, here + walk->step, walk->next);
  return used >= 0 && used <= SLOW &&
         strut_path_distance(walk, walk->next, walk->y) <= 1.5 * walk->step &&
         strut_path_tangent(system, walk->next, walk->tangent, walk->next_tangent) &&
         strut_path_dot(walk, walk->tangent, walk->next_tangent) >= bend &&
         (bend <= 0.0 || is_arc(walk));
}

/* Predictor and corrector, shorter until they succeed: the next point and its tangent. */
static bool find_next(strut_path_walk *walk) {
  for (; walk->step >= SHORTEST; walk->step *= 0.5)
    if (try_step(walk, BEND)) return true;
  /* cables that meet or leave a circle, or begin to rub, bend a path at once with no switch that says where */
  bool hidden = strut_path_has_rubbing(&walk->system) ||
                walk->system.model->strains >> STRUT_STRAIN_WRAP & 1u;
  for (walk->step = BLUNT; hidden && walk->step >= SHORTEST; walk->step *= 0.1)
    if (try_step(walk, 0.0)) return true;
  walk->step = SHORTEST;
  return false;
}

static bool is_changed(strut_path_side a, strut_path_side b) {
  return a.negative != b.negative || a.way * b.way < 0;
}

static int way_of(double rate) { return (rate > LEVEL) - (rate < -LEVEL); }

/*
 * Eigenvalues below zero where the path continues along a tangent. Elements are evaluated in double: the rounding
 * of their forces moves a soft mode, near zero by more than a short step.
 */
static bool find_side(strut_path_walk *walk, const double *unknowns, const double *tangent,
                      double step, strut_path_side *found, bool *blurred) {
  strut_path_system *system = &walk->system;
  if (!strut_path_spectrum(system, unknowns)) return false;
  double level = fmax(BLURRED * system->spectrum.noise, ROUNDED / step * system->elements.noise);
  *found = (strut_path_side){system->spectrum.negative, way_of(tangent[system->n])};
  for (int32_t i = 0; i < system->n; i++)
    if (fabs(system->spectrum.value[i]) < level) *blurred = true;
  return true;
}

/*
 * Takes a part again in shorter steps. False: they end elsewhere, or pass several changes, or one where the
 * part seemed to pass none. Else the part becomes the step on which the change is.
 */
static bool narrow(strut_path_walk *walk, strut_path_check *self, bool changes) {
  strut_path_system *system = &walk->system;
  size_t bytes = strut_path_bytes(walk);
  const double *row = self->whole.tangent;
  double from = strut_path_dot(walk, row, self->whole.y);
  double length = strut_path_dot(walk, row, self->whole.end) - from, at = 0;
  strut_path_side now = self->whole.before;
  int found = 0;
  memcpy(self->y, self->whole.y, bytes);
  memcpy(self->tangent, self->whole.tangent, bytes);
  for (int k = 0; k < PARTS; at = share[k++]) {
    double step = (share[k] - at) * length / strut_path_dot(walk, row, self->tangent);
    strut_path_side next = now;
    strut_path_part *inner = found ? NULL : &self->inner;
    if (inner) {
      memcpy(inner->y, self->y, bytes);
      memcpy(inner->tangent, self->tangent, bytes);
      inner->before = now;
    }
    for (int32_t i = 0; i <= system->n; i++) self->y[i] += step * self->tangent[i];
    if (strut_path_correct(system, row, from + share[k] * length, self->y) < 0 ||
        !strut_path_tangent(system, self->y, self->tangent, self->next_tangent) ||
        !(strut_path_dot(walk, self->tangent, self->next_tangent) >= BEND) ||
        !find_side(walk, self->y, self->next_tangent, length, &next, &self->blurred))
      return false;
    if (is_changed(now, next) && found++) return false;
    if (inner && found) memcpy(inner->end, self->y, bytes);
    memcpy(self->tangent, self->next_tangent, bytes);
    now = next;
  }
  if (strut_path_distance(walk, self->y, self->whole.end) > SAME * length) return false;
  if (found != changes) return false;
  strut_path_part narrowed = self->inner;
  if (found) self->inner = self->whole, self->whole = narrowed;
  return true;
}

/* Does the step lead where shorter ones do, with what changes on it at one place? */
static bool is_confirmed(strut_path_walk *walk, strut_path_check *self, strut_path_side after) {
  size_t bytes = strut_path_bytes(walk);
  strut_path_side before = {walk->negative, way_of(walk->tangent[walk->system.n])};
  bool changes = is_changed(before, after);
  int32_t crossed = after.negative - before.negative;
  double finest = crossed * crossed == 1 && before.way * after.way < 0 ? PLAIN : FINEST;
  memcpy(self->whole.y, walk->y, bytes);
  memcpy(self->whole.tangent, walk->tangent, bytes);
  memcpy(self->whole.end, walk->next, bytes);
  self->whole.before = before;
  self->blurred = false;
  double length = walk->step;
  do {
    if (!narrow(walk, self, changes))
      return length < walk->step &&
             (self->blurred || strut_path_is_rounding(walk, self->whole.y, self->whole.end));
    if (changes && (length > PLACED || !walk->part.known)) {
      memcpy(walk->part.from, self->whole.y, bytes);
      memcpy(walk->part.tangent, self->whole.tangent, bytes);
      memcpy(walk->part.to, self->whole.end, bytes);
      walk->part.known = true;
    }
    length = strut_path_distance(walk, self->whole.y, self->whole.end);
  } while (changes && length > finest && !self->blurred);
  return true;
}

/* May an eigenvalue have passed zero on the step, or be about to? */
static bool is_critical(const strut_path_walk *walk) {
  const strut_path_system *system = &walk->system;
  for (int32_t i = 0; i < system->n; i++) {
    double here = walk->values[i], there = system->spectrum.value[i];
    double near = fmin(fabs(here), fabs(there));
    if (fabs(there - here) > fmax(SOON * near, BLURRED * system->spectrum.noise)) return true;
  }
  return false;
}

/*
 * What reaches zero and turns back within a step shows at neither end: a cable that is taut for a moment, a contact
 * that closes and opens, a pair of limit points or of bifurcations. Such a step is to end where it turns.
 */

enum { LOOKS = 4 };

static const double WITHIN = 0.02;  /* of a step: what turns nearer to an end shows there */
static const double SMALL = 0.2;    /* of the values at both ends: an extreme that may be zero */
static const double GRAZING = 1e-4; /* likewise, one that is near enough */
static const double NEUTRAL = 1e-8; /* of the largest eigenvalue: it may be zero all along */
static const double WHOLE_STEP = 1.0;

static bool is_within(double at) { return at > WITHIN && at < WHOLE_STEP - WITHIN; }

enum { STOP = -1 }; /* in place of a switch: the coordinate at which the path stops */

/* A switch on the cubic through both ends of the step: above 0 while it stays as it is. */
static strut_reading measure_between(strut_path_walk *walk, int32_t which, double at) {
  strut_path_system *system = &walk->system;
  double length = strut_path_distance(walk, walk->next, walk->y), *point = walk->trial;
  memset(point, 0, strut_path_bytes(walk));
  for (int32_t i = 0; i <= system->n; i++)
    point[i] = strut_hermite(walk->y[i], walk->tangent[i], walk->next[i], walk->next_tangent[i],
                             length, at);
  if (which == STOP) {
    const strut_path_stop *stop = &system->parameter.options->stop;
    double ahead = strut_path_evaluate(system, point)
                       ? system->stop_at - system->latest.q[stop->coordinate]
                       : (double)NAN;
    return (strut_reading){at, copysign(1.0, stop->displacement) * ahead};
  }
  double value = strut_path_switch_value(system, which, point);
  return (strut_reading){at, strut_path_switch_is_on(system, which) ? value : -value};
}

/* Where a switch is thrown and thrown back; or where it is farthest from a change that has just been. */
static double find_switch_turn(strut_path_walk *walk, int32_t which) {
  double even = STRUT_PATH_EVEN * walk->system.size;
  strut_reading a = measure_between(walk, which, 0.0), c = measure_between(walk, which, WHOLE_STEP);
  bool begins = fabs(a.value) <= even && c.value < -even;
  if (!begins && !(a.value > even && c.value > even)) return WHOLE_STEP;
  strut_reading b = measure_between(walk, which, 0.5), vertex;
  double small = fmin(a.value, c.value);
  for (int k = 0; k < LOOKS; k++) {
    vertex = strut_vertex(a, b, c);
    if (!(vertex.at > a.at && vertex.at < c.at) || begins != (vertex.value > b.value)) break;
    if (!begins && !(vertex.value < SMALL * small)) break;
    vertex = measure_between(walk, which, vertex.at);
    if (begins ? vertex.value > even : vertex.value < GRAZING * small) return vertex.at;
    strut_reading *end = vertex.at < b.at ? &c : &a;
    *end = b, b = vertex;
  }
  return WHOLE_STEP;
}

/* Where the rate of the parameter, a parabola by its ends and its mean, changes sign and changes back. */
static double find_pair_of_limits(const strut_path_walk *walk) {
  int32_t n = walk->system.n;
  double from = walk->tangent[n], to = walk->next_tangent[n];
  double mean = (walk->next[n] - walk->y[n]) / strut_path_distance(walk, walk->next, walk->y);
  strut_reading vertex = strut_vertex((strut_reading){0.0, from},
                                      (strut_reading){0.5, 1.5 * mean - 0.25 * (from + to)},
                                      (strut_reading){WHOLE_STEP, to});
  bool turns = way_of(from) * way_of(to) > 0 && is_within(vertex.at) &&
               vertex.value * from < SMALL * from * (fabs(from) < fabs(to) ? from : to);
  return turns ? vertex.at : WHOLE_STEP;
}

/* Where an eigenvalue passes zero and comes back, by its values at both ends and at the point before. */
static double find_pair_of_zeros(const strut_path_walk *walk) {
  const strut_path_system *system = &walk->system;
  for (int32_t i = 0; i < system->n && walk->earlier > 0.0; i++) {
    double here = walk->values[i], there = system->spectrum.value[i];
    strut_reading vertex =
        strut_vertex((strut_reading){-walk->earlier / walk->step, walk->earlier_values[i]},
                     (strut_reading){0.0, here}, (strut_reading){WHOLE_STEP, there});
    double small = fabs(here) < fabs(there) ? here : there;
    if (here * there > 0.0 && is_within(vertex.at) &&
        fabs(small) > NEUTRAL * system->spectrum.value[system->n - 1] &&
        vertex.value * small < SMALL * small * small)
      return vertex.at;
  }
  return WHOLE_STEP;
}

/* The part of the step up to the first place where something turns; after find_side at its end. */
static double find_turn(strut_path_walk *walk) {
  double first = fmin(find_pair_of_limits(walk), find_pair_of_zeros(walk));
  if (walk->system.parameter.options->stop.given) first = fmin(first, find_switch_turn(walk, STOP));
  for (int32_t k = 0; k < strut_path_switch_count(&walk->system); k++) {
    strut_path_switch_kind of = strut_path_switch_at(&walk->system, k).of;
    bool smooth = of != STRUT_PATH_FACET && of != STRUT_PATH_GRIP;
    if (smooth && !strut_path_turns_round(&walk->system, k))
      first = fmin(first, find_switch_turn(walk, k));
  }
  return first;
}

/*
 * Near a limit point or bifurcation other solutions lie nearer than the step is long, and Newton's method may
 * end on one of them. There a step counts only if shorter ones find the same.
 */
bool strut_path_find_next(strut_path_walk *walk) {
  strut_path_system *system = &walk->system;
  walk->part.known = false;
  bool found = find_next(walk), done = !found || walk->negative < 0, cut = false;
  while (!done && walk->step > FINEST) {
    strut_path_side after = {0};
    bool blurred = false;
    if (!find_side(walk, walk->next, walk->next_tangent, walk->step, &after, &blurred)) break;
    strut_path_side before = {walk->negative, way_of(walk->tangent[system->n])};
    bool changed = is_changed(before, after), critical = is_critical(walk);
    double turn = changed || cut ? WHOLE_STEP : find_turn(walk);
    if (turn < WHOLE_STEP) {
      cut = true, walk->step *= turn;
      found = find_next(walk), done = !found;
      continue;
    }
    if (!changed && !critical) break;
    done = is_confirmed(walk, &walk->check, after) || walk->failed;
    if (done) break;
    walk->part.known = false;
    double whole = walk->step;
    walk->step *= 1.0 / PARTS;
    if (find_next(walk) && walk->step < whole) continue;
    walk->step = whole; /* no shorter step succeeds, or only a longer one over a kink: so be it */
    found = find_next(walk), done = true;
  }
  return found && !walk->failed;
}
