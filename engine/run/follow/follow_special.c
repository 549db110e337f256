/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What changes between two orbits of a step: events by bisection on their words, then multipliers and
 * turns by bisection on their signatures, within what is left between the events.
 */
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
static strut_follow_orbit *orbit_between(const span *p, const strut_follow_orbit *left,
                                         const strut_follow_orbit *right, double distance) {
  strut_follow_walk *w = p->w;
  const strut_follow_system *s = w->s;
  strut_follow_orbit *o = strut_follow_orbit_new(w);
  int rounds;
  if (!o) return NULL;
  double part = (distance - left->distance) / (right->distance - left->distance);
  for (size_t i = 0; i < s->both; i++) o->y[i] = left->y[i] + part * (right->y[i] - left->y[i]);
  o->value = left->value + part * (right->value - left->value);
  o->distance = distance;
  if (!strut_follow_newton(w, o->y, &o->value,
                           &(strut_follow_section){p->a->tangent, p->a->y, p->a->value, distance},
                           &rounds) ||
      !strut_follow_measure(w, o))
    return NULL;
  return o;
}

static bool same_signature(strut_follow_signature a, strut_follow_signature b) {
  return a.plus == b.plus && a.minus == b.minus && a.pairs == b.pairs && a.turn == b.turn;
}

/* Narrows the first change of the word after `from`. False: no orbit there, or a status. */
static bool bracket_event(const span *p, double least, bracket *k) {
  while (k->to->distance - k->from->distance > least) {
    strut_follow_orbit *o =
        orbit_between(p, k->from, k->to, 0.5 * (k->from->distance + k->to->distance));
    if (!o) return false;
    if (strut_follow_words_equal(&k->from->word, &o->word))
      k->from = o;
    else
      k->to = o;
  }
  return true;
}

/* The same for signatures; both ends are complete. */
static bool bracket_signature(const span *p, double least, bracket *k) {
  for (int i = 0; i < MOST_HALVINGS && k->to->distance - k->from->distance > least; i++) {
    strut_follow_orbit *o =
        orbit_between(p, k->from, k->to, 0.5 * (k->from->distance + k->to->distance));
    if (!o || !strut_follow_complete(p->w, o, p->a->tangent)) return false;
    if (same_signature(k->from->signature, o->signature))
      k->from = o;
    else
      k->to = o;
  }
  return true;
}

static int32_t unstable_count(strut_follow_signature g) { return g.plus + g.minus + 2 * g.pairs; }

static bool note_stability(strut_follow_point *point, const bracket *k) {
  point->unstable[0] = unstable_count(k->from->signature);
  point->unstable[1] = unstable_count(k->to->signature);
  point->changes = (point->unstable[0] == 0) != (point->unstable[1] == 0);
  return true;
}

static bool add_event(const span *p, const bracket *k) {
  strut_follow_walk *w = p->w;
  strut_follow_point found = {0};
  const bracket ahead = w->backwards ? (bracket){k->to, k->from} : *k;
  if (!strut_follow_words_compare(w->s, &ahead.from->word, &ahead.to->word, &w->branch->arena,
                                  &found)) {
    w->status = strut_no_memory(w->error, "");
    return false;
  }
  strut_follow_point *point =
      strut_follow_add(w, k->to, w->arc + 0.5 * (k->from->distance + k->to->distance), found.kind);
  if (!point) return false;
  point->node = found.node, point->detail = found.detail;
  if (k->from->complete && k->to->complete) {
    note_stability(point, &ahead);
    point->stable = k->from->complete && unstable_count(k->from->signature) == 0;
  } else {
    const strut_follow_signature g = p->a->signature; /* no signature changes on this step */
    point->stable = unstable_count(g) == 0;
    memcpy(point->multiplier, p->a->multiplier[0], sizeof point->multiplier);
  }
  return true;
}

/* The multiplier of o nearest to the circle; `minus`: of the negative ones. Returns its size less 1. */
static double critical_multiplier(const strut_follow_orbit *o, bool minus, double value[2]) {
  double best = HUGE_VAL;
  for (size_t i = 0; i < o->multipliers; i++) {
    const double *m = o->multiplier[i];
    double off = hypot(m[0], m[1]) - 1.0;
    if (minus && !(m[0] < 0.0 && m[1] == 0.0)) continue;
    if (fabs(off) < fabs(best)) best = off, value[0] = m[0], value[1] = m[1];
  }
  return best;
}

/* Part of the bracket at which the multiplier is on the circle, by interpolation. */
static double part_on_circle(const bracket *k, bool minus, double value[2]) {
  double other[2] = {1.0, 0.0};
  double from = critical_multiplier(k->from, minus, other);
  double to = critical_multiplier(k->to, minus, value);
  if (fabs(from) < fabs(to)) value[0] = other[0], value[1] = other[1];
  return from * to < 0.0 && isfinite(from) && isfinite(to) ? from / (from - to) : 0.5;
}

static bool add_signature(const span *p, const bracket *k) {
  strut_follow_walk *w = p->w;
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
  double arc = w->arc + k->from->distance + part * (k->to->distance - k->from->distance);
  strut_follow_point *point = strut_follow_add(w, k->to, arc, kind);
  if (!point) return false;
  if (kind != STRUT_FOLLOW_FOLD)
    point->value = k->from->value + part * (k->to->value - k->from->value);
  const bracket ahead = w->backwards ? (bracket){k->to, k->from} : *k;
  note_stability(point, &ahead);
  point->multiplier[0] = value[0], point->multiplier[1] = value[1];
  const char *sense = unstable_count(ahead.to->signature) > unstable_count(ahead.from->signature)
                          ? "leaves"
                          : "enters";
  strut_arena *arena = &w->branch->arena;
  if (kind == STRUT_FOLLOW_FOLD)
    point->detail = strut_arena_format(arena, "the branch turns; a multiplier passes 1");
  else if (kind == STRUT_FOLLOW_DOUBLING)
    point->detail = strut_arena_format(arena, "a multiplier %s the unit circle at -1", sense);
  else if (kind == STRUT_FOLLOW_TORUS)
    point->detail =
        strut_arena_format(arena, "a pair of multipliers %s the unit circle at +-%.4g deg", sense,
                           fabs(atan2(value[1], value[0])) * 57.29577951308232);
  else
    point->detail = strut_arena_format(arena, "a multiplier %s the unit circle at 1", sense);
  if (!point->detail) w->status = strut_no_memory(w->error, "");
  if (!point->detail) return false;
  if (kind == STRUT_FOLLOW_DOUBLING) {
    size_t index = (size_t)(point - w->branch->points);
    double *direction = strut_arena_allocate(arena, w->s->n, sizeof(double));
    if (direction && strut_follow_eigenvector(w, k->to, value[0], direction))
      w->branch->points[index].critical = direction;
  }
  return w->status == STRUT_OK;
}

/* Changes of the signature between two complete orbits without events between them. */
static bool locate_signatures(const span *p, strut_follow_orbit *from, strut_follow_orbit *to) {
  double least = LOCATED * fmax(to->distance - from->distance, 1e-6);
  for (int i = 0; i < MOST_CHANGES && !same_signature(from->signature, to->signature); i++) {
    bracket k = {from, to};
    if (!bracket_signature(p, least, &k)) return p->w->status == STRUT_OK;
    if (!add_signature(p, &k)) return false;
    from = k.to;
  }
  return true;
}

bool strut_follow_locate(strut_follow_walk *w, const strut_follow_orbit *a,
                         const strut_follow_orbit *b) {
  const span p = {w, a};
  strut_follow_orbit from = *a, to = *b;
  strut_follow_orbit *here = &from;
  bool signatures = !same_signature(a->signature, b->signature);
  from.distance = 0.0;
  double least = LOCATED_EVENT * to.distance;
  bool many = a->word.count > MOST_LETTERS || b->word.count > MOST_LETTERS;
  if (many && !signatures) return true;
  for (int i = 0; i < MOST_CHANGES && !w->limits->without_words; i++) {
    if (strut_follow_words_equal(&here->word, &to.word)) break;
    bracket k = {here, &to};
    w->rough = true;
    bool narrow = bracket_event(&p, least, &k);
    w->rough = false;
    if (w->status) return false;
    if (!narrow) break;
    if (signatures) {
      if (!strut_follow_complete(w, k.from, a->tangent) ||
          !strut_follow_complete(w, k.to, a->tangent))
        return w->status == STRUT_OK;
      if (!locate_signatures(&p, here, k.from)) return false;
    }
    if (!add_event(&p, &k)) return false;
    here = k.to;
  }
  if (!signatures) return true;
  if (!strut_follow_complete(w, here, a->tangent)) return w->status == STRUT_OK;
  return locate_signatures(&p, here, &to);
}

/* Gap in units of the motion within which a start is on the curve; shift of the phase in a step. */
static const double NEAR = 0.02, PHASE = 0.1;
enum { MOST_EXTREMA = 64 };

/* ---- determinants ---- */

/* det(jacobian + shift), by elimination with pivots; the multipliers that decide are of order one. */
static double determinant(const double *jacobian, double shift, size_t n, double *a) {
  double value = 1.0;
  memcpy(a, jacobian, n * n * sizeof(double));
  for (size_t i = 0; i < n; i++) a[i * n + i] += shift;
  for (size_t k = 0; k < n; k++) {
    size_t best = k;
    for (size_t i = k + 1; i < n; i++)
      if (fabs(a[i * n + k]) > fabs(a[best * n + k])) best = i;
    double pivot = a[best * n + k];
    if (pivot == 0.0) return 0.0;
    for (size_t j = k; j < n && best != k; j++) {
      double keep = a[k * n + j];
      a[k * n + j] = a[best * n + j], a[best * n + j] = keep;
    }
    value *= best != k ? -pivot : pivot;
    for (size_t i = k + 1; i < n; i++) {
      double factor = a[i * n + k] / pivot;
      for (size_t j = k; j < n; j++) a[i * n + j] -= factor * a[k * n + j];
    }
  }
  return value;
}

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
static double gap_of(const gap_watch *w, const double *q, const double *v,
                     const strut_ground_motion *motion, double *rate) {
  const strut_contact_table *c = &w->model->contacts;
  const strut_contact_pose pose = strut_contact_pose_at(c, w->contact, q, motion, -1);
  const double *at = v + c->at[w->contact];
  *rate = at[0] * pose.axes.normal[0] + at[1] * pose.axes.normal[1];
  return pose.gap;
}

/* An extremum of the cubic between two ends of a step. */
static void watch_gap(void *context, const strut_state *state) {
  gap_watch *w = context;
  double rate, h = w->dt;
  double gap = gap_of(w, state->q, state->v, state->latest->ground_motion, &rate);
  double sign = w->highest ? -1.0 : 1.0;
  if (sign * w->rate < 0.0 && sign * rate >= 0.0 && w->count < MOST_EXTREMA) {
    double rise = gap - w->gap, a = h * w->rate, b = h * rate;
    double c = 3.0 * rise - 2.0 * a - b, d = a + b - 2.0 * rise; /* slope a + 2 c x + 3 d x^2 */
    double root = sqrt(fmax(0.0, c * c - 3.0 * d * a));
    double x = -a / (c + (a < 0.0 ? root : -root));
    if (!(x >= 0.0 && x <= 1.0)) x = 1.0;
    w->found[w->count++] =
        (extremum){w->gap + x * (a + x * (c + x * d)), (w->time + x * h - w->begin) / w->span};
  }
  w->gap = gap, w->rate = rate, w->time += h;
}

/* All extrema of the contact's gap in a repetition. False: the motion is lost. */
static bool find_extrema(strut_follow_surface *u, const strut_follow_surface_point *p, bool highest,
                         int32_t contact, gap_watch *w) {
  strut_follow_system *s = &u->s;
  if (!strut_follow_surface_set(u, p->value)) return false;
  strut_period_map *map = &s->map[0];
  *w = (gap_watch){.model = s->model, .contact = contact, .highest = highest};
  w->dt = map->dt;
  w->span = s->period * s->how.repeats;
  memcpy(s->buffers.end, p->y, s->both * sizeof(double));
  w->gap = gap_of(w, s->buffers.end, s->buffers.end + s->model->length, NULL, &w->rate);
  map->watch = watch_gap;
  map->watch_context = w;
  double travel = strut_period_map_apply(map, s->buffers.end);
  map->watch = NULL;
  return isfinite(travel);
}

static double phase_distance(double a, double b) {
  double off = fabs(a - b);
  off -= floor(off);
  return fmin(off, 1.0 - off);
}

static bool gap_at(strut_follow_surface *u, strut_follow_criterion *criterion,
                   const strut_follow_surface_point *p, double *value) {
  gap_watch w;
  double nearest = HUGE_VAL;
  if (!find_extrema(u, p, criterion->kind == STRUT_FOLLOW_LIFT, criterion->contact, &w))
    return false;
  for (size_t i = 0; i < w.count; i++) {
    double off = phase_distance(w.found[i].phase, criterion->phase);
    if (off >= nearest) continue;
    nearest = off;
    *value = w.found[i].gap / u->s.length;
    criterion->next_phase = w.found[i].phase;
  }
  return nearest <= PHASE;
}

bool strut_follow_criterion_choose(strut_follow_surface *u, strut_follow_criterion *criterion,
                                   const strut_follow_surface_point *p, const char *node) {
  double least = NEAR * u->s.length;
  bool found = false;
  gap_watch w;
  if (!strut_follow_surface_set(u, p->value)) return false;
  for (int32_t i = 0; i < u->s.model->contacts.count && !u->status; i++) {
    const char *name = u->s.setup.scene.nodes[u->s.model->contacts.entry[i].node].name;
    if (!node || strcmp(name, node) != 0) continue;
    if (!find_extrema(u, p, criterion->kind == STRUT_FOLLOW_LIFT, i, &w)) continue;
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

bool strut_follow_criterion_at(strut_follow_surface *u, strut_follow_criterion *criterion,
                               strut_follow_surface_point *p, double *value) {
  size_t n = u->s.n;
  if (criterion->kind == STRUT_FOLLOW_TOUCH || criterion->kind == STRUT_FOLLOW_LIFT)
    return gap_at(u, criterion, p, value);
  if (!strut_follow_surface_complete(u, p)) return false;
  *value = determinant(p->jacobian, criterion->kind == STRUT_FOLLOW_DOUBLING ? 1.0 : -1.0, n,
                       criterion->scratch);
  return isfinite(*value);
}
