/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The next point of a path, on the branch of the present one. */
#include <math.h>
#include <string.h>

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
static bool is_arc(const strut_path_walk *w) {
  double length = strut_path_distance(w, w->next, w->y), sum = 0, aside = 0;
  for (int32_t i = 0; i <= w->system.n; i++) {
    double mean = w->tangent[i] + w->next_tangent[i];
    sum += mean * mean;
  }
  for (int32_t i = 0; i <= w->system.n; i++) {
    double mean = (w->tangent[i] + w->next_tangent[i]) / sqrt(sum);
    double off = (w->next[i] - w->y[i]) / length - mean;
    aside += off * off;
  }
  return aside <= ASIDE * ASIDE;
}

/* A step of the present length: the next point and its tangent, which may differ from this one as `bend` says. */
static bool try_step(strut_path_walk *w, double bend) {
  strut_path_system *s = &w->system;
  double here = strut_path_dot(w, w->tangent, w->y);
  memcpy(w->next, w->y, strut_path_bytes(w));
  for (int32_t i = 0; i <= s->n; i++) w->next[i] += w->step * w->tangent[i];
  int used = strut_path_correct(s, w->tangent, here + w->step, w->next);
  return used >= 0 && used <= SLOW && strut_path_distance(w, w->next, w->y) <= 1.5 * w->step &&
         strut_path_tangent(s, w->next, w->tangent, w->next_tangent) &&
         strut_path_dot(w, w->tangent, w->next_tangent) >= bend && (bend <= 0.0 || is_arc(w));
}

/* Cables that meet or leave a circle, or begin to rub, bend a path at once with no switch that says where. */
static bool has_hidden_kinks(const strut_path_system *s) {
  return strut_path_has_rubbing(s) || s->model->strains >> STRUT_STRAIN_WRAP & 1u;
}

/* Predictor and corrector, shorter until they succeed: the next point and its tangent. */
static bool find_next(strut_path_walk *w) {
  for (; w->step >= SHORTEST; w->step *= 0.5)
    if (try_step(w, BEND)) return true;
  for (w->step = BLUNT; has_hidden_kinks(&w->system) && w->step >= SHORTEST; w->step *= 0.1)
    if (try_step(w, 0.0)) return true;
  w->step = SHORTEST;
  return false;
}

/* What changes at limit points and bifurcations: eigenvalues below zero, and the way of the parameter. */
typedef struct side {
  int32_t negative;
  int way; /* 0: along it nothing changes beyond rounding */
} side;

static bool is_changed(side a, side b) { return a.negative != b.negative || a.way * b.way < 0; }

static int way_of(double rate) { return (rate > LEVEL) - (rate < -LEVEL); }

/* A part of a step: its begin, and the place of its end along the tangent there. */
typedef struct part {
  double *y, *tangent, *end; /* (2 n + 2), (n + 1), (2 n + 2) */
  side before;
} part;

typedef struct check {
  part whole, inner;
  double *y, *tangent, *next_tangent; /* where it is */
  bool blurred;                       /* an eigenvalue had no sign */
  strut_arena arena;
} check;

static bool allocate_check(const strut_path_walk *w, check *c) {
  double **arrays[] = {&c->whole.y, &c->whole.tangent, &c->whole.end,
                       &c->inner.y, &c->inner.tangent, &c->inner.end,
                       &c->y,       &c->tangent,       &c->next_tangent};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
    if (!(*arrays[i] = strut_arena_allocate(&c->arena, 1, strut_path_bytes(w)))) return false;
  return true;
}

/*
 * Eigenvalues below zero where the path continues along a tangent. Elements are evaluated in double: the rounding
 * of their forces moves a soft mode, near zero by more than a short step.
 */
static bool find_side(strut_path_walk *w, const double *y, const double *tangent, double step,
                      side *found, bool *blurred) {
  strut_path_system *s = &w->system;
  if (!strut_path_spectrum(s, y, STRUT_PATH_SIGNS)) return false;
  double level = fmax(BLURRED * s->spectrum.noise, ROUNDED / step * s->elements.noise);
  *found = (side){s->spectrum.negative, way_of(tangent[s->n])};
  for (int32_t i = 0; i < s->n; i++)
    if (fabs(s->spectrum.value[i]) < level) *blurred = true;
  return true;
}

/*
 * Takes a part again in shorter steps. False: they end elsewhere, or pass several changes, or one where the
 * part seemed to pass none. Else the part becomes the step on which the change is.
 */
static bool narrow(strut_path_walk *w, check *c, bool changes) {
  strut_path_system *s = &w->system;
  size_t bytes = strut_path_bytes(w);
  const double *row = c->whole.tangent;
  double from = strut_path_dot(w, row, c->whole.y);
  double length = strut_path_dot(w, row, c->whole.end) - from, at = 0;
  side now = c->whole.before;
  int found = 0;
  memcpy(c->y, c->whole.y, bytes);
  memcpy(c->tangent, c->whole.tangent, bytes);
  for (int k = 0; k < PARTS; at = share[k++]) {
    double step = (share[k] - at) * length / strut_path_dot(w, row, c->tangent);
    side next = now;
    part *inner = found ? NULL : &c->inner;
    if (inner) {
      memcpy(inner->y, c->y, bytes);
      memcpy(inner->tangent, c->tangent, bytes);
      inner->before = now;
    }
    for (int32_t i = 0; i <= s->n; i++) c->y[i] += step * c->tangent[i];
    if (strut_path_correct(s, row, from + share[k] * length, c->y) < 0 ||
        !strut_path_tangent(s, c->y, c->tangent, c->next_tangent) ||
        !(strut_path_dot(w, c->tangent, c->next_tangent) >= BEND) ||
        !find_side(w, c->y, c->next_tangent, length, &next, &c->blurred))
      return false;
    if (is_changed(now, next) && found++) return false;
    if (inner && found) memcpy(inner->end, c->y, bytes);
    memcpy(c->tangent, c->next_tangent, bytes);
    now = next;
  }
  if (strut_path_distance(w, c->y, c->whole.end) > SAME * length) return false;
  if (found != changes) return false;
  part narrowed = c->inner;
  if (found) c->inner = c->whole, c->whole = narrowed;
  return true;
}

/* Does the step lead where shorter ones do, with what changes on it at one place? */
static bool is_confirmed(strut_path_walk *w, check *c, side after) {
  size_t bytes = strut_path_bytes(w);
  side before = {w->negative, way_of(w->tangent[w->system.n])};
  bool changes = is_changed(before, after);
  int32_t crossed = after.negative - before.negative;
  double finest = crossed * crossed == 1 && before.way * after.way < 0 ? PLAIN : FINEST;
  memcpy(c->whole.y, w->y, bytes);
  memcpy(c->whole.tangent, w->tangent, bytes);
  memcpy(c->whole.end, w->next, bytes);
  c->whole.before = before;
  c->blurred = false;
  double length = w->step;
  do {
    if (!narrow(w, c, changes))
      return length < w->step &&
             (c->blurred || strut_path_is_rounding(w, c->whole.y, c->whole.end));
    if (changes && (length > PLACED || !w->part.known)) {
      memcpy(w->part.from, c->whole.y, bytes);
      memcpy(w->part.tangent, c->whole.tangent, bytes);
      memcpy(w->part.to, c->whole.end, bytes);
      w->part.known = true;
    }
    length = strut_path_distance(w, c->whole.y, c->whole.end);
  } while (changes && length > finest && !c->blurred);
  return true;
}

/* May an eigenvalue have passed zero on the step, or be about to? */
static bool is_critical(const strut_path_walk *w) {
  const strut_path_system *s = &w->system;
  for (int32_t i = 0; i < s->n; i++) {
    double here = w->values[i], there = s->spectrum.value[i];
    double near = fmin(fabs(here), fabs(there));
    if (fabs(there - here) > fmax(SOON * near, BLURRED * s->spectrum.noise)) return true;
  }
  return false;
}

/*
 * Near a limit point or bifurcation other solutions lie nearer than the step is long, and Newton's method may
 * end on one of them. There a step counts only if shorter ones find the same.
 */
bool strut_path_find_next(strut_path_walk *w) {
  strut_path_system *s = &w->system;
  check c = {0};
  w->part.known = false;
  bool found = find_next(w), done = !found || w->negative < 0;
  while (!done && w->step > FINEST) {
    side after = {0};
    bool blurred = false;
    if (!find_side(w, w->next, w->next_tangent, w->step, &after, &blurred)) break;
    side before = {w->negative, way_of(w->tangent[s->n])};
    if (!is_changed(before, after) && !is_critical(w)) break;
    w->failed = w->failed || (!c.whole.y && !allocate_check(w, &c));
    done = w->failed || is_confirmed(w, &c, after);
    if (done) break;
    w->part.known = false;
    double whole = w->step;
    w->step *= 1.0 / PARTS;
    if (find_next(w) && w->step < whole) continue;
    w->step = whole; /* no shorter step succeeds, or only a longer one over a kink: so be it */
    found = find_next(w), done = true;
  }
  strut_arena_free(&c.arena);
  return found && !w->failed;
}
