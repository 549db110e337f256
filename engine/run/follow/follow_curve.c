/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/follow/follow_parts.h"

#include <math.h>
#include <string.h>

#include "engine/base/vec.h"

/* Steps of arclength [1]: the first, the least, the most; of those near a cusp. */
static const double FIRST = 0.01, LEAST = 2e-5, MOST = 0.3, CUSP = 0.01;
/* Angles between the direction and the step [rad]: above, the step shrinks; below, it grows. */
static const double SHARP = 0.4, STRAIGHT = 0.12;
/* Part of a step to which the root is found, and part that it may be off the direction. */
static const double FOUND = 1e-4, ASIDE = 0.7;
/* Window in which the first root is sought [1]; distance to an edge of the range that counts as on it. */
static const double WINDOW = 0.05, EDGE = 1e-5;
/* The same motion as that of a curve: parts of the range, and unknowns of order one. */
static const double SAME = 5e-3, NEAR = 0.1;
enum { MOST_ROOTS = 12, FEW = 4, CLOSED = 8 };

/* Where a walk stands, and what it works with. */
typedef struct curve_walk {
  strut_follow_walk w;
  strut_follow_criterion criterion;
  double *along, *across; /* (m) the direction, and across it in the surface */
  double *step, *before;  /* (m) unit vectors of the latest step and the one before */
  double slope;           /* of the test function across; NAN: not known */
} curve_walk;

static double normalise(double *a, size_t n) {
  double length = sqrt(strut_dot(a, a, (ptrdiff_t)n));
  for (size_t i = 0; i < n && length > 0.0; i++) a[i] /= length;
  return length;
}

bool strut_follow_curve_known(strut_follow_kind kind) {
  return kind == STRUT_FOLLOW_FOLD || kind == STRUT_FOLLOW_DOUBLING || kind == STRUT_FOLLOW_TOUCH ||
         kind == STRUT_FOLLOW_LIFT;
}

/* Of a point at o: the largest multiplier but for the one that decides, and whether all are within the circle. */
static void judge(const strut_follow_orbit *orbit, strut_follow_kind kind, strut_follow_point *to) {
  double wanted = kind == STRUT_FOLLOW_DOUBLING ? -1.0 : 1.0, least = HUGE_VAL;
  bool decides = kind == STRUT_FOLLOW_FOLD || kind == STRUT_FOLLOW_DOUBLING;
  size_t own = orbit->multipliers;
  for (size_t i = 0; i < orbit->multipliers && decides; i++) {
    double off = hypot(orbit->multiplier[i][0] - wanted, orbit->multiplier[i][1]);
    if (off < least) least = off, own = i;
  }
  to->stable = true;
  to->multiplier[0] = to->multiplier[1] = (double)NAN;
  for (size_t i = orbit->multipliers; i-- > 0;) {
    if (i == own) continue;
    memcpy(to->multiplier, orbit->multiplier[i], sizeof to->multiplier);
    to->stable = to->stable && hypot(orbit->multiplier[i][0], orbit->multiplier[i][1]) <= 1.0;
  }
}

/* Appends o, which is complete. False: the motion is lost, or status. */
static bool add_point(curve_walk *self, strut_follow_orbit *orbit) {
  strut_follow_branch *curve = self->w.branch;
  if (!strut_follow_measure(self->w.s, &curve->arena, orbit)) return false;
  strut_follow_point *to = strut_follow_add(&self->w, orbit, self->w.arc, STRUT_FOLLOW_REGULAR);
  if (to) judge(orbit, curve->kind, to);
  return to != NULL;
}

/* ---- the root across a direction ---- */

/* A trial across the direction: its place and the test function there. */
typedef struct trial {
  double at, value;
  strut_follow_orbit *p;
} trial;

/* An orbit at `from`, moved by a multiple of a direction. NULL: out of memory. */
static strut_follow_orbit *moved_by(curve_walk *self, const strut_follow_orbit *from,
                                    const double *direction, double factor) {
  strut_follow_orbit *orbit = strut_follow_orbit_new(self->w.s, &self->w.branch->arena, &from->at);
  if (orbit) strut_follow_move(self->w.s, &orbit->at, direction, factor);
  return orbit;
}

/* Evaluates the trial `aside` of the direction, from `guess`, which lies on the surface or near it. */
static bool try_aside(curve_walk *self, const strut_follow_orbit *base, double h, double aside,
                      const strut_follow_orbit *guess, double moved, trial *t) {
  const strut_follow_planes planes = {&base->at, {self->along, self->across}, {h, aside}};
  int rounds;
  t->p = guess ? moved_by(self, guess, self->across, moved) : NULL;
  t->at = aside;
  return t->p && strut_follow_newton(self->w.s, &planes, &t->p->at, &rounds) &&
         strut_follow_criterion_at(self->w.s, &self->criterion, t->p, &t->value);
}

/*
 * The root at distance h along the direction from base, at most `window` aside of it. NULL: there is none.
 * *tries: how many evaluations it took.
 */
static strut_follow_orbit *find_root(curve_walk *self, const strut_follow_orbit *base, double h,
                                     double window, int *tries) {
  trial a, b, c;
  double least = FOUND * fmax(h, 0.1 * window) + 1e-9;
  *tries = 1;
  if (!try_aside(self, base, h, 0.0, moved_by(self, base, self->along, h), 0.0, &a)) return NULL;
  double guess =
      isfinite(self->slope) && self->slope != 0.0 ? -a.value / self->slope : 0.1 * window;
  guess = fmin(fmax(guess, -0.5 * window), 0.5 * window);
  if (fabs(guess) < least) guess = guess < 0.0 ? -least : least;
  if (!try_aside(self, base, h, guess, a.p, guess - a.at, &b)) return NULL;
  for (*tries = 2; *tries < MOST_ROOTS; ++*tries) {
    bool bracketed = (a.value <= 0.0) != (b.value <= 0.0);
    double slope = (b.value - a.value) / (b.at - a.at);
    if (fabs(a.value) < fabs(b.value)) { /* b is the better one */
      trial keep = a;
      a = b, b = keep;
    }
    double at = slope != 0.0 && isfinite(slope) ? b.at - b.value / slope : 2.0 * b.at - a.at;
    if (isfinite(slope) && slope != 0.0) self->slope = slope;
    if (b.value == 0.0 || fabs(at - b.at) < least) return fabs(b.at) <= window ? b.p : NULL;
    if (bracketed && !((at - a.at) * (at - b.at) < 0.0)) at = 0.5 * (a.at + b.at);
    if (fabs(at) > window || !try_aside(self, base, h, at, b.p, at - b.at, &c)) return NULL;
    /* where a root is between two trials it stays there */
    bool stays =
        bracketed && (c.value <= 0.0) == (b.value <= 0.0) && (c.value <= 0.0) != (a.value <= 0.0);
    if (!stays) a = b;
    b = c;
    if (stays && fabs(b.at - a.at) < least) return b.p;
  }
  return NULL;
}

/* ---- directions ---- */

/* Sets the direction to the vector's part in the tangent plane at o, and what is across it. */
static bool set_direction(curve_walk *self, const strut_follow_orbit *orbit, const double *vector) {
  size_t m = self->w.s->m;
  double c = strut_dot(vector, orbit->tangent[0], (ptrdiff_t)m),
         d = strut_dot(vector, orbit->tangent[1], (ptrdiff_t)m), length = hypot(c, d);
  if (!(length > 1e-6)) return false;
  c /= length, d /= length;
  double turn = 0.0, *across = self->w.s->buffers.x;
  for (size_t i = 0; i < m; i++) {
    across[i] = -d * orbit->tangent[0][i] + c * orbit->tangent[1][i];
    turn += across[i] * self->across[i];
    self->along[i] = c * orbit->tangent[0][i] + d * orbit->tangent[1][i];
  }
  for (size_t i = 0; i < m; i++) self->across[i] = turn < 0.0 ? -across[i] : across[i];
  return true;
}

/*
 * The orbit on the curve near o, at the second parameter's value; sets the direction there, in which the second
 * parameter grows. NULL: there is no curve.
 */
static strut_follow_orbit *begin(curve_walk *self, strut_follow_orbit *orbit) {
  strut_follow_system *system = self->w.s;
  size_t m = system->m;
  int tries;
  double value;
  if (!strut_follow_complete(system, orbit, NULL)) return NULL;
  double a = orbit->tangent[0][m - 1], b = orbit->tangent[1][m - 1], length = hypot(a, b);
  if (!(length > 0.0)) return NULL;
  for (size_t i = 0; i < m; i++) { /* along: to the second parameter; across: at its value */
    self->along[i] = (a * orbit->tangent[0][i] + b * orbit->tangent[1][i]) / length;
    self->across[i] = (b * orbit->tangent[0][i] - a * orbit->tangent[1][i]) / length;
  }
  orbit = find_root(self, orbit, 0.0, WINDOW, &tries);
  if (!orbit || !isfinite(self->slope) || !strut_follow_complete(system, orbit, NULL)) return NULL;
  /* the direction in which the test function stays zero */
  const double h = 0.1 * WINDOW;
  trial t;
  if (!strut_follow_criterion_at(system, &self->criterion, orbit, &value) ||
      !try_aside(self, orbit, h, 0.0, moved_by(self, orbit, self->along, h), 0.0, &t))
    return NULL;
  double beside = (t.value - value) / h, *vector = self->before;
  for (size_t i = 0; i < m; i++)
    vector[i] = self->slope * self->along[i] - beside * self->across[i];
  if (normalise(vector, m) == 0.0) return NULL;
  for (size_t i = 0; i < m && self->before[m - 1] < 0.0; i++) vector[i] = -vector[i];
  self->slope = (double)NAN;
  return set_direction(self, orbit, vector) ? orbit : NULL;
}

/* ---- the walk ---- */

/* Distance of the values to the nearest edge of the ranges [1]; below 0 outside. */
static double within(const strut_follow_system *system, const double value[2]) {
  double least = HUGE_VAL;
  for (size_t k = 0; k < 2; k++) {
    double part = strut_follow_scaled(system, k, value[k]);
    least = fmin(least, fmin(part, 1.0 - part));
  }
  return least;
}

/* The step shortened so that it ends on the first edge it would pass. */
static double limited(const curve_walk *self, const strut_follow_orbit *orbit, double h) {
  const strut_follow_system *system = self->w.s;
  for (size_t k = 0; k < 2; k++) {
    double rate = self->along[system->n + k];
    double part = strut_follow_scaled(system, k, orbit->at.value[k]);
    h = fmin(h, self->w.limits->longest / fmax(fabs(rate), 1e-9));
    if (rate > 0.0) h = fmin(h, fmax((1.0 - part) / rate, 0.5 * EDGE));
    if (rate < 0.0) h = fmin(h, fmax(-part / rate, 0.5 * EDGE));
  }
  return h;
}

/* Does the curve turn back in the plane of the parameters between the step before and the latest? */
static bool turns_back(const curve_walk *self, bool stepped) {
  size_t n = self->w.s->n;
  return stepped && self->w.branch->kind == STRUT_FOLLOW_FOLD &&
         strut_dot(self->step + n, self->before + n, 2) < 0.0;
}

/*
 * The cusp within the latest three points a, b and the one that is appended next, at which the parameters'
 * rates vanish: by parabolas through them.
 */
static bool add_cusp(curve_walk *self, const strut_follow_orbit *next, double length) {
  const strut_follow_system *system = self->w.s;
  strut_follow_branch *curve = self->w.branch;
  if (curve->count < 2) return true;
  strut_follow_point a = curve->points[curve->count - 2], b = curve->points[curve->count - 1];
  double x = fabs(b.arc - a.arc), z = length, up = 0.0, down = 0.0, rate[2], bend[2];
  for (int k = 0; k < 2; k++) {
    double range = system->high[k] - system->low[k];
    double p = (b.at.value[k] - a.at.value[k]) / range / x,
           q = (next->at.value[k] - b.at.value[k]) / range / z;
    bend[k] = (q - p) / (x + z);
    rate[k] = p + x * bend[k]; /* at b */
    up -= rate[k] * bend[k], down += 2.0 * bend[k] * bend[k];
  }
  double at = down > 0.0 ? fmin(fmax(up / down, -x), z) : 0.0;
  strut_follow_point *cusp = strut_follow_add(&self->w, next, 0.0, STRUT_FOLLOW_CUSP);
  if (!cusp) return false;
  *cusp = b;
  cusp->kind = STRUT_FOLLOW_CUSP;
  cusp->arc = b.arc + (self->w.backwards ? -at : at);
  for (int k = 0; k < 2; k++)
    cusp->at.value[k] += at * (rate[k] + at * bend[k]) * (system->high[k] - system->low[k]);
  if (at < 0.0) { /* it lies before b */
    cusp[-1] = *cusp;
    *cusp = b;
  }
  return true;
}

/* The direction behind a step, with half of the change between the latest two. */
static bool lead_on(curve_walk *self, const strut_follow_orbit *orbit, bool stepped) {
  double ahead[STRUT_FOLLOW_MOST + 2], weight = stepped ? 0.5 : 0.0;
  for (size_t i = 0; i < self->w.s->m; i++) {
    double latest = self->step[i];
    ahead[i] = latest + weight * (latest - self->before[i]);
    self->before[i] = latest;
  }
  return set_direction(self, orbit, ahead);
}

/* Takes steps from o until the curve ends; returns why. */
static const char *walk_on(curve_walk *self, const strut_follow_orbit *first) {
  strut_follow_system *system = self->w.s;
  const strut_follow_orbit *here = first;
  double h = FIRST;
  bool stepped = false;
  for (int32_t steps = 0; steps < self->w.limits->steps;) {
    int tries = 0;
    h = limited(self, here, h);
    strut_follow_orbit *next = find_root(self, here, h, ASIDE * h, &tries);
    bool good = next && strut_follow_complete(system, next, NULL);
    if (system->status) return "interrupted";
    double length = 0.0, angle = 0.0;
    if (good) {
      strut_follow_between(system, &here->at, &next->at, self->step);
      length = normalise(self->step, system->m);
      angle = acos(fmin(1.0, strut_dot(self->step, self->along, (ptrdiff_t)system->m)));
    }
    bool back = good && turns_back(self, stepped);
    if (!good || angle > SHARP || (back && h > CUSP)) {
      if (h <= LEAST) return "no such motion was found beyond";
      h = back && good && angle <= SHARP ? CUSP : fmax(0.4 * h, LEAST);
      self->slope = good ? self->slope : (double)NAN;
      continue;
    }
    double in = within(system, next->at.value);
    if (in < -10.0 * EDGE) { /* past an edge: nearer to it first */
      if (h <= LEAST) return "the range of a parameter ends";
      h = fmax(0.5 * h, LEAST);
      continue;
    }
    if (back && !add_cusp(self, next, length)) return "interrupted";
    self->w.arc += length;
    if (!add_point(self, next))
      return system->status ? "interrupted" : "the motion was lost beyond";
    self->criterion.phase = self->criterion.next_phase;
    steps++;
    if (in < EDGE) return "the range of a parameter ends";
    if (steps > CLOSED && strut_follow_is_closed(&self->w, first, next, h))
      return "the curve is closed";
    if (!lead_on(self, next, stepped)) return "no such motion was found beyond";
    stepped = true;
    here = next;
    if (tries <= FEW && angle < STRAIGHT) h = fmin(1.5 * h, MOST);
  }
  return "the number of steps is used up";
}

/* ---- the curve ---- */

/* Both ways from the orbit, which is on the curve. */
static void walk_both_ways(curve_walk *self, strut_follow_orbit *orbit) {
  strut_follow_branch *curve = self->w.branch;
  strut_follow_system *system = self->w.s;
  const strut_follow_criterion criterion = self->criterion;
  double back[STRUT_FOLLOW_MOST + 2];
  for (size_t i = 0; i < system->m; i++) back[i] = -self->along[i];
  if (!add_point(self, orbit)) return;
  curve->ends[1] = curve->ends[0] = walk_on(self, orbit);
  size_t forth = curve->count;
  if (!system->status && strcmp(curve->ends[1], "the curve is closed") != 0) {
    self->criterion = criterion;
    self->w.arc = 0.0;
    self->w.backwards = true;
    self->slope = (double)NAN;
    curve->ends[0] = set_direction(self, orbit, back) ? walk_on(self, orbit) : "";
  }
  strut_follow_order(curve, forth);
}

strut_status strut_follow_curve_make(strut_follow_system *system,
                                     const strut_follow_curve_start *start,
                                     const strut_follow_limits *limits,
                                     strut_follow_branch *curve) {
  *curve = (strut_follow_branch){.kind = start->kind,
                                 .repeats = system->how.repeats,
                                 .travels = system->travels,
                                 .ends = {"", ""}};
  curve_walk w = {.w = {.s = system, .limits = limits, .branch = curve},
                  .criterion = {.kind = start->kind},
                  .slope = (double)NAN};
  if (!STRUT_NUMBERS(&curve->arena, system->m, &w.along, &w.across, &w.step, &w.before))
    system->status = strut_no_memory(system->error, "");
  strut_follow_orbit *orbit = strut_follow_orbit_new(system, &curve->arena, &start->at);
  if (system->status) return system->status;
  bool gap = start->kind == STRUT_FOLLOW_TOUCH || start->kind == STRUT_FOLLOW_LIFT;
  system->derivative.known = false;
  system->precision = STRUT_FOLLOW_EXACT;
  if (start->node) curve->node = strut_arena_format(&curve->arena, "%s", start->node);
  if (gap && !strut_follow_criterion_choose(system, &w.criterion, &start->at, start->node))
    curve->ends[0] = "no extremum of its gap is near zero there";
  else if (!(orbit = begin(&w, orbit)))
    curve->ends[0] = "no curve leads through it";
  else
    walk_both_ways(&w, orbit);
  return system->status;
}

bool strut_follow_curve_passes(const strut_follow_system *system, const strut_follow_branch *curve,
                               const strut_follow_curve_start *start) {
  bool same_node =
      !start->node == !curve->node && (!start->node || strcmp(start->node, curve->node) == 0);
  if (curve->kind != start->kind || curve->repeats != system->how.repeats || !same_node)
    return false;
  const double *wanted = start->at.value;
  for (size_t k = 0; k + 1 < curve->count; k++) {
    const strut_follow_motion *a = &curve->points[k].at, *b = &curve->points[k + 1].at;
    double rise = b->value[1] - a->value[1], most = 0.0;
    if ((a->value[1] - wanted[1]) * (b->value[1] - wanted[1]) > 0.0) continue;
    double part = rise != 0.0 ? (wanted[1] - a->value[1]) / rise : 0.0;
    double off = fabs(a->value[0] + part * (b->value[0] - a->value[0]) - wanted[0]);
    for (size_t i = 0; i < system->n; i++) {
      size_t at = system->place[i];
      double y = a->y[at] + part * (b->y[at] - a->y[at]);
      most = fmax(most, fabs(y - start->at.y[at]) / strut_follow_unit(system, i));
    }
    if (off < SAME * (system->high[0] - system->low[0]) && most < NEAR) return true;
  }
  return false;
}
