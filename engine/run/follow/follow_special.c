/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What changes between two orbits of a step: events by bisection on their words, then multipliers and
 * turns by bisection on their signatures, within what is left between the events.
 */
#include <complex.h>
#include <math.h>
#include <string.h>

#include "engine/model/pose.h"
#include "engine/run/follow/follow_parts.h"

/* A change is located to this part of the step. */
static const double LOCATED = 2e-3, LOCATED_EVENT = 4e-3;
/* A pair of multipliers this near to the real axis [rad] is real but for rounding. */
static const double REAL = 1e-3;
/* Beyond so many events in a period they are located only where stability changes. */
enum { MOST_CHANGES = 40, MOST_HALVINGS = 24, MOST_LETTERS = 24 };

/* An interval within a step: orbits at its ends. */
typedef struct bracket {
  strut_follow_orbit *from, *to;
} bracket;

/* The step under search. */
typedef struct span {
  strut_follow_walk *w;
  const strut_follow_orbit *a; /* its begin, with the tangent */
} span;

/* The orbit at `distance` along the step, from a guess between two others; NULL: none. */
static strut_follow_orbit *orbit_between(const span *self, const strut_follow_orbit *left,
                                         const strut_follow_orbit *right, double distance) {
  strut_follow_system *system = self->w->s;
  strut_arena *arena = &self->w->branch->arena;
  strut_follow_orbit *orbit = strut_follow_orbit_new(system, arena, &left->at);
  int rounds;
  if (!orbit) return NULL;
  double part = (distance - left->distance) / (right->distance - left->distance);
  for (size_t i = 0; i < system->both; i++)
    orbit->at.y[i] += part * (right->at.y[i] - left->at.y[i]);
  orbit->at.value[0] += part * (right->at.value[0] - left->at.value[0]);
  orbit->distance = distance;
  const strut_follow_planes planes = {&self->a->at, {self->a->tangent[0]}, {distance}};
  bool found = strut_follow_newton(system, &planes, &orbit->at, &rounds) &&
               strut_follow_measure(system, arena, orbit);
  return found ? orbit : NULL;
}

static bool same_signature(strut_follow_signature a, strut_follow_signature b) {
  return a.plus == b.plus && a.minus == b.minus && a.pairs == b.pairs && a.turn == b.turn;
}

/*
 * Narrows the first change after `from`: of the word or, between complete orbits, of the signature. False: no orbit
 * there, or a status.
 */
static bool narrow(const span *self, double least, bool signatures, bracket *k) {
  for (int i = 0; i < MOST_HALVINGS && k->to->distance - k->from->distance > least; i++) {
    strut_follow_orbit *orbit =
        orbit_between(self, k->from, k->to, 0.5 * (k->from->distance + k->to->distance));
    if (!orbit || (signatures && !strut_follow_complete(self->w->s, orbit, self->a->tangent[0])))
      return false;
    bool same = signatures ? same_signature(k->from->signature, orbit->signature)
                           : strut_follow_words_equal(&k->from->word, &orbit->word);
    *(same ? &k->from : &k->to) = orbit;
  }
  return true;
}

static int32_t unstable_count(strut_follow_signature g) { return g.plus + g.minus + 2 * g.pairs; }

static void note_stability(strut_follow_point *point, const bracket *self) {
  point->unstable[0] = unstable_count(self->from->signature);
  point->unstable[1] = unstable_count(self->to->signature);
  point->changes = (point->unstable[0] == 0) != (point->unstable[1] == 0);
}

static bool add_event(const span *self, const bracket *k) {
  strut_follow_walk *walk = self->w;
  strut_follow_point found = {0};
  const bracket ahead = walk->backwards ? (bracket){k->to, k->from} : *k;
  if (!strut_follow_words_compare(walk->s, &ahead.from->word, &ahead.to->word, &walk->branch->arena,
                                  &found)) {
    walk->s->status = strut_no_memory(walk->s->error, "");
    return false;
  }
  strut_follow_point *point = strut_follow_add(
      walk, k->to, walk->arc + 0.5 * (k->from->distance + k->to->distance), found.kind);
  if (!point) return false;
  point->node = found.node, point->detail = found.detail;
  if (k->from->complete && k->to->complete) {
    note_stability(point, &ahead);
    point->stable = k->from->complete && unstable_count(k->from->signature) == 0;
  } else {
    const strut_follow_signature g = self->a->signature; /* no signature changes on this step */
    point->stable = unstable_count(g) == 0;
    memcpy(point->multiplier, self->a->multiplier[0], sizeof point->multiplier);
  }
  return true;
}

/* The multiplier of o nearest to the circle; `minus`: of the negative ones. Returns its size less 1. */
static double critical_multiplier(const strut_follow_orbit *orbit, bool minus, double value[2]) {
  double best = HUGE_VAL;
  for (size_t i = 0; i < orbit->multipliers; i++) {
    const double *m = orbit->multiplier[i];
    double off = hypot(m[0], m[1]) - 1.0;
    if (minus && !(m[0] < 0.0 && m[1] == 0.0)) continue;
    if (fabs(off) < fabs(best)) best = off, value[0] = m[0], value[1] = m[1];
  }
  return best;
}

/* Part of the bracket at which the multiplier is on the circle, by interpolation. */
static double part_on_circle(const bracket *self, bool minus, double value[2]) {
  double other[2] = {1.0, 0.0};
  double from = critical_multiplier(self->from, minus, other);
  double to = critical_multiplier(self->to, minus, value);
  if (fabs(from) < fabs(to)) value[0] = other[0], value[1] = other[1];
  return from * to < 0.0 && isfinite(from) && isfinite(to) ? from / (from - to) : 0.5;
}

static bool add_signature(const span *self, const bracket *k) {
  strut_follow_walk *walk = self->w;
  strut_follow_signature a = k->from->signature, b = k->to->signature;
  double value[2] = {1.0, 0.0};
  strut_follow_kind kind = STRUT_FOLLOW_BRANCHING;
  bool doubles = a.minus != b.minus && a.pairs == b.pairs;
  double part = part_on_circle(k, doubles, value);
  if (a.turn != b.turn)
    kind = STRUT_FOLLOW_FOLD;
  else if (doubles)
    kind = STRUT_FOLLOW_DOUBLING;
  else if (a.pairs != b.pairs)
    kind = a.plus != b.plus || a.minus != b.minus ? STRUT_FOLLOW_REGULAR : STRUT_FOLLOW_TORUS;
  if (kind == STRUT_FOLLOW_REGULAR) return true; /* a pair outside the circle becomes real */
  if (kind == STRUT_FOLLOW_TORUS && fabs(atan2(value[1], value[0])) < REAL)
    kind = STRUT_FOLLOW_BRANCHING;
  double arc = walk->arc + k->from->distance + part * (k->to->distance - k->from->distance);
  strut_follow_point *point = strut_follow_add(walk, k->to, arc, kind);
  if (!point) return false;
  if (kind != STRUT_FOLLOW_FOLD)
    point->at.value[0] = k->from->at.value[0] + part * (k->to->at.value[0] - k->from->at.value[0]);
  const bracket ahead = walk->backwards ? (bracket){k->to, k->from} : *k;
  note_stability(point, &ahead);
  point->multiplier[0] = value[0], point->multiplier[1] = value[1];
  const char *sense = unstable_count(ahead.to->signature) > unstable_count(ahead.from->signature)
                          ? "leaves"
                          : "enters";
  strut_arena *arena = &walk->branch->arena;
  double angle = fabs(atan2(value[1], value[0])) * 57.29577951308232;
  const bool torus = kind == STRUT_FOLLOW_TORUS;
  point->detail = kind == STRUT_FOLLOW_FOLD
                      ? strut_arena_format(arena, "the branch turns; a multiplier passes 1")
                      : strut_arena_format(arena,
                                           torus ? "%s %s the unit circle at +-%.4g deg"
                                                 : "%s %s the unit circle at %.0f",
                                           torus ? "a pair of multipliers" : "a multiplier", sense,
                                           torus                           ? angle
                                           : kind == STRUT_FOLLOW_DOUBLING ? -1.0
                                                                           : 1.0);
  if (!point->detail) walk->s->status = strut_no_memory(walk->s->error, "");
  if (!point->detail) return false;
  if (kind == STRUT_FOLLOW_DOUBLING) {
    size_t index = (size_t)(point - walk->branch->points);
    double *direction = strut_follow_allocate(walk->s, arena, walk->s->n, sizeof(double));
    if (direction && strut_follow_eigenvector(walk->s, k->to, value[0], direction))
      walk->branch->points[index].critical = direction;
  }
  return walk->s->status == STRUT_OK;
}

/* Changes of the signature between two complete orbits without events between them. */
static bool locate_signatures(const span *self, strut_follow_orbit *from, strut_follow_orbit *to) {
  double least = LOCATED * fmax(to->distance - from->distance, 1e-6);
  for (int i = 0; i < MOST_CHANGES && !same_signature(from->signature, to->signature); i++) {
    bracket k = {from, to};
    if (!narrow(self, least, true, &k)) return self->w->s->status == STRUT_OK;
    if (!add_signature(self, &k)) return false;
    from = k.to;
  }
  return true;
}

bool strut_follow_locate(strut_follow_walk *walk, const strut_follow_orbit *first,
                         const strut_follow_orbit *second) {
  const span p = {walk, first};
  strut_follow_orbit from = *first, to = *second;
  strut_follow_orbit *here = &from;
  bool signatures = !same_signature(first->signature, second->signature);
  from.distance = 0.0;
  double least = LOCATED_EVENT * to.distance;
  bool many = first->word.count > MOST_LETTERS || second->word.count > MOST_LETTERS;
  if (many && !signatures) return true;
  for (int i = 0; i < MOST_CHANGES; i++) {
    if (strut_follow_words_equal(&here->word, &to.word)) break;
    bracket k = {here, &to};
    walk->s->precision = STRUT_FOLLOW_ROUGH;
    bool found = narrow(&p, least, false, &k);
    walk->s->precision = STRUT_FOLLOW_CLOSE;
    if (walk->s->status) return false;
    if (!found) break;
    if (signatures) {
      if (!strut_follow_complete(walk->s, k.from, first->tangent[0]) ||
          !strut_follow_complete(walk->s, k.to, first->tangent[0]))
        return walk->s->status == STRUT_OK;
      if (!locate_signatures(&p, here, k.from)) return false;
    }
    if (!add_event(&p, &k)) return false;
    here = k.to;
  }
  if (!signatures) return true;
  if (!strut_follow_complete(walk->s, here, first->tangent[0])) return walk->s->status == STRUT_OK;
  return locate_signatures(&p, here, &to);
}

/* Gap in units of the motion within which a start is on the curve; shift of the phase in a step. */
static const double NEAR = 0.02, PHASE = 0.1;
enum { MOST_EXTREMA = 64 };

/* ---- extrema of a gap ---- */

typedef struct extremum {
  double gap, phase; /* [m], [repetitions] */
} extremum;

/* What looks on during a period: the gap of a contact at the ends of steps, and its extrema between. */
typedef struct gap_watch {
  const strut_model *model;
  int32_t contact;
  bool highest; /* maxima instead of minima */
  double gap, rate, time, begin, span, dt;
  size_t count;
  extremum found[MOST_EXTREMA];
} gap_watch;

/* The gap and its rate; of a ground that moves, without its own velocity. */
static double gap_of(const gap_watch *self, const double *positions, const double *velocity,
                     const strut_ground_motion *motion, double *rate) {
  const strut_contact_table *contacts = &self->model->contacts;
  const strut_contact_pose pose =
      strut_contact_pose_at(contacts, self->contact, positions, motion, -1);
  const double *at = velocity + contacts->at[self->contact];
  *rate = at[0] * pose.axes.normal[0] + at[1] * pose.axes.normal[1];
  return pose.gap;
}

/* An extremum of the cubic between two ends of a step. */
static void watch_gap(void *context, const strut_state *state) {
  gap_watch *self = context;
  double rate, h = self->dt;
  double gap = gap_of(self, state->q, state->v, state->latest->ground_motion, &rate);
  double sign = self->highest ? -1.0 : 1.0;
  if (sign * self->rate < 0.0 && sign * rate >= 0.0 && self->count < MOST_EXTREMA) {
    double rise = gap - self->gap, a = h * self->rate, b = h * rate;
    double c = 3.0 * rise - 2.0 * a - b, d = a + b - 2.0 * rise;
    double x = strut_follow_extremum(rise, a, b);
    if (!(x >= 0.0 && x <= 1.0)) x = 1.0;
    self->found[self->count++] = (extremum){self->gap + x * (a + x * (c + x * d)),
                                            (self->time + x * h - self->begin) / self->span};
  }
  self->gap = gap, self->rate = rate, self->time += h;
}

/* All extrema of the contact's gap in a repetition. False: the motion is lost. */
static bool find_extrema(strut_follow_system *system, const strut_follow_motion *motion,
                         bool highest, int32_t contact, gap_watch *self) {
  if (!strut_follow_set_value(system, motion->value)) return false;
  strut_period_map *map = &system->map[0];
  double *end = system->buffers.end;
  *self = (gap_watch){.model = system->model, .contact = contact, .highest = highest};
  self->dt = map->dt;
  self->span = system->period * system->how.repeats;
  memcpy(end, motion->y, system->both * sizeof(double));
  self->gap = gap_of(self, end, end + system->model->length, NULL, &self->rate);
  map->watch = watch_gap;
  map->watch_context = self;
  double travel = strut_period_map_apply(map, end);
  map->watch = NULL;
  return isfinite(travel);
}

static double phase_distance(double a, double b) {
  double off = fabs(a - b);
  off -= floor(off);
  return fmin(off, 1.0 - off);
}

static bool gap_at(strut_follow_system *system, strut_follow_criterion *criterion,
                   const strut_follow_motion *motion, double *value) {
  gap_watch w;
  double nearest = HUGE_VAL;
  if (!find_extrema(system, motion, criterion->kind == STRUT_FOLLOW_LIFT, criterion->contact, &w))
    return false;
  for (size_t i = 0; i < w.count; i++) {
    double off = phase_distance(w.found[i].phase, criterion->phase);
    if (off >= nearest) continue;
    nearest = off;
    *value = w.found[i].gap / system->length;
    criterion->next_phase = w.found[i].phase;
  }
  return nearest <= PHASE;
}

bool strut_follow_criterion_choose(strut_follow_system *system, strut_follow_criterion *criterion,
                                   const strut_follow_motion *motion, const char *node) {
  double least = NEAR * system->length;
  bool found = false;
  gap_watch w;
  if (!node || !strut_follow_set_value(system, motion->value)) return false;
  for (int32_t i = 0; i < system->model->contacts.count && !system->status; i++) {
    const char *name = system->setup.scene.nodes[system->model->contacts.entry[i].node].name;
    if (strcmp(name, node) != 0) continue;
    if (!find_extrema(system, motion, criterion->kind == STRUT_FOLLOW_LIFT, i, &w)) continue;
    for (size_t k = 0; k < w.count; k++) {
      if (fabs(w.found[k].gap) >= least) continue;
      least = fabs(w.found[k].gap);
      criterion->contact = i;
      criterion->phase = criterion->next_phase = w.found[k].phase;
      found = true;
    }
  }
  return found;
}

/* Of folds and doublings det(jacobian -+ 1), which is the product of the multipliers -+ 1: pairs make it real. */
bool strut_follow_criterion_at(strut_follow_system *system, strut_follow_criterion *criterion,
                               strut_follow_orbit *orbit, double *value) {
  double complex product = 1.0;
  if (criterion->kind == STRUT_FOLLOW_TOUCH || criterion->kind == STRUT_FOLLOW_LIFT)
    return gap_at(system, criterion, &orbit->at, value);
  if (!strut_follow_complete(system, orbit, NULL)) return false;
  const double shift = criterion->kind == STRUT_FOLLOW_DOUBLING ? 1.0 : -1.0;
  for (size_t i = 0; i < orbit->multipliers; i++)
    product *= CMPLX(orbit->multiplier[i][0] + shift, orbit->multiplier[i][1]);
  *value = creal(product);
  return isfinite(*value);
}
