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
enum { MOST_ROOTS = 12, FEW = 4, CLOSED = 8, SLOTS = 6 };

/* Where a walk stands, and what it works with. */
typedef struct walk {
  strut_follow_surface *u;
  strut_follow_criterion criterion;
  strut_follow_curve *curve;
  const strut_follow_curve_limits *limits;
  strut_follow_surface_point *slot[SLOTS]; /* points: here, next, trials */
  double *along, *across;                  /* (m) the direction, and across it in the surface */
  double *step, *before; /* (m) unit vectors of the latest step and the one before */
  double slope;          /* of the test function across; NAN: not known */
  size_t room;
  double arc;
  bool backwards;
} walk;

static double normalise(double *a, size_t n) {
  double length = sqrt(strut_dot(a, a, (ptrdiff_t)n));
  for (size_t i = 0; i < n && length > 0.0; i++) a[i] /= length;
  return length;
}

bool strut_follow_curve_known(strut_follow_kind kind) {
  return kind == STRUT_FOLLOW_FOLD || kind == STRUT_FOLLOW_DOUBLING || kind == STRUT_FOLLOW_TOUCH ||
         kind == STRUT_FOLLOW_LIFT;
}

/* ---- points of the result ---- */

static strut_follow_curve_point *append(walk *self) {
  strut_follow_curve *curve = self->curve;
  if (curve->count == self->room) {
    size_t room = self->room ? 2 * self->room : 128;
    strut_follow_curve_point *points = strut_arena_allocate(&curve->arena, room, sizeof *points);
    if (!points) {
      self->u->status = strut_no_memory(self->u->error, "");
      return NULL;
    }
    if (curve->count) memcpy(points, curve->points, curve->count * sizeof *points);
    curve->points = points;
    self->room = room;
  }
  return &curve->points[curve->count++];
}

/* Multipliers but for the one that decides: the largest, and whether all are within the circle. */
static void judge(const walk *self, const strut_follow_surface_point *point,
                  strut_follow_curve_point *to) {
  double wanted = self->curve->kind == STRUT_FOLLOW_DOUBLING ? -1.0 : 1.0, least = HUGE_VAL;
  bool decides =
      self->curve->kind == STRUT_FOLLOW_FOLD || self->curve->kind == STRUT_FOLLOW_DOUBLING;
  size_t own = point->multipliers;
  for (size_t i = 0; i < point->multipliers && decides; i++) {
    double off = hypot(point->multiplier[i][0] - wanted, point->multiplier[i][1]);
    if (off < least) least = off, own = i;
  }
  to->stable = true;
  to->multiplier[0] = to->multiplier[1] = (double)NAN;
  for (size_t i = point->multipliers; i-- > 0;) {
    if (i == own) continue;
    memcpy(to->multiplier, point->multiplier[i], sizeof to->multiplier);
    to->stable = to->stable && hypot(point->multiplier[i][0], point->multiplier[i][1]) <= 1.0;
  }
}

/* Appends p, which is complete. False: the motion is lost, or status. */
static bool add_point(walk *self, strut_follow_surface_point *point) {
  strut_follow_surface *surface = self->u;
  strut_follow_system *system = &surface->s;
  if (!strut_follow_surface_set(surface, point->value)) return false;
  double *y = strut_arena_allocate(&self->curve->arena, system->both, sizeof *y);
  if (!y) surface->status = strut_no_memory(surface->error, "");
  if (!y) return false;
  strut_follow_centre(system, point->y);
  memcpy(y, point->y, system->both * sizeof *y);
  memcpy(system->buffers.end, point->y, system->both * sizeof *y);
  const strut_follow_period period = strut_follow_apply(system, system->buffers.end, true);
  if (!isfinite(period.travel)) return false;
  strut_follow_curve_point *to = append(self);
  if (!to) return false;
  *to =
      (strut_follow_curve_point){.value = {point->value[0], point->value[1]},
                                 .arc = self->backwards ? -self->arc : self->arc,
                                 .velocity = period.travel / (system->period * system->how.repeats),
                                 .work = period.work / system->how.repeats,
                                 .amplitude = period.amplitude,
                                 .y = y};
  judge(self, point, to);
  return true;
}

/* ---- the root across a direction ---- */

/* A trial across the direction: its place and the test function there. */
typedef struct trial {
  double at, value;
  strut_follow_surface_point *p;
} trial;

/* Evaluates the trial `aside` of the direction, from `guess`, which lies on the surface or near it. */
static bool try_aside(walk *self, const strut_follow_surface_point *base, double h, double aside,
                      const strut_follow_surface_point *guess, double moved, trial *t) {
  const double *const rows[2] = {self->along, self->across};
  const double offset[2] = {h, aside};
  strut_follow_surface_point_copy(self->u, guess, t->p);
  strut_follow_surface_move(self->u, t->p, self->across, moved);
  t->at = aside;
  return strut_follow_surface_correct(self->u, t->p, base, rows, offset) &&
         strut_follow_criterion_at(self->u, &self->criterion, t->p, &t->value);
}

/*
 * The root at distance h along the direction from base, at most `window` aside of it, into `next`; slots 2 to
 * 4 are scratch. False: there is none. *tries: how many evaluations it took.
 */
static bool find_root(walk *self, const strut_follow_surface_point *base, double h, double window,
                      strut_follow_surface_point *next, int *tries) {
  trial a = {.p = self->slot[2]}, b = {.p = self->slot[3]}, c = {.p = self->slot[4]};
  double least = FOUND * fmax(h, 0.1 * window) + 1e-9;
  bool bracketed = false;
  strut_follow_surface_point *ahead = self->slot[5];
  strut_follow_surface_point_copy(self->u, base, ahead);
  strut_follow_surface_move(self->u, ahead, self->along, h);
  *tries = 1;
  if (!try_aside(self, base, h, 0.0, ahead, 0.0, &a)) return false;
  double guess =
      isfinite(self->slope) && self->slope != 0.0 ? -a.value / self->slope : 0.1 * window;
  guess = fmin(fmax(guess, -0.5 * window), 0.5 * window);
  if (fabs(guess) < least) guess = guess < 0.0 ? -least : least;
  if (!try_aside(self, base, h, guess, a.p, guess - a.at, &b)) return false;
  for (*tries = 2; *tries < MOST_ROOTS; ++*tries) {
    bracketed = (a.value <= 0.0) != (b.value <= 0.0);
    double slope = (b.value - a.value) / (b.at - a.at);
    if (fabs(a.value) < fabs(b.value)) { /* b is the better one */
      trial keep = a;
      a = b, b = keep;
    }
    double at = slope != 0.0 && isfinite(slope) ? b.at - b.value / slope : 2.0 * b.at - a.at;
    if (isfinite(slope) && slope != 0.0) self->slope = slope;
    if (b.value == 0.0 || fabs(at - b.at) < least) {
      strut_follow_surface_point_copy(self->u, b.p, next);
      return fabs(b.at) <= window;
    }
    if (bracketed && !((at - a.at) * (at - b.at) < 0.0)) at = 0.5 * (a.at + b.at);
    if (fabs(at) > window || !try_aside(self, base, h, at, b.p, at - b.at, &c)) return false;
    /* where a root is between two trials it stays there */
    if (bracketed && (c.value <= 0.0) == (b.value <= 0.0) && (c.value <= 0.0) != (a.value <= 0.0)) {
      trial keep = b;
      b = c, c = keep;
      if (fabs(b.at - a.at) < least) {
        strut_follow_surface_point_copy(self->u, b.p, next);
        return true;
      }
    } else {
      trial keep = a;
      a = b, b = c, c = keep;
    }
  }
  return false;
}

/* ---- directions ---- */

/* Sets the direction to the vector's part in the tangent plane at p, and what is across it. */
static bool set_direction(walk *self, const strut_follow_surface_point *point,
                          const double *vector) {
  size_t m = self->u->m;
  double c = strut_dot(vector, point->basis[0], (ptrdiff_t)m),
         d = strut_dot(vector, point->basis[1], (ptrdiff_t)m), length = hypot(c, d);
  if (!(length > 1e-6)) return false;
  c /= length, d /= length;
  double turn = 0.0;
  for (size_t i = 0; i < m; i++) {
    double across = -d * point->basis[0][i] + c * point->basis[1][i];
    turn += across * self->across[i];
    self->along[i] = c * point->basis[0][i] + d * point->basis[1][i];
    self->step[i] = across; /* kept for a moment */
  }
  for (size_t i = 0; i < m; i++) self->across[i] = turn < 0.0 ? -self->step[i] : self->step[i];
  return true;
}

/*
 * Moves p, near the curve, onto it at the second parameter's value, and sets the direction there, in which
 * the second parameter grows. False: there is no curve.
 */
static bool begin(walk *self, strut_follow_surface_point *point) {
  strut_follow_surface *surface = self->u;
  size_t m = surface->m;
  int tries;
  double value, beside;
  if (!strut_follow_surface_complete(surface, point)) return false;
  double a = point->basis[0][m - 1], b = point->basis[1][m - 1], length = hypot(a, b);
  if (!(length > 0.0)) return false;
  for (size_t i = 0; i < m; i++) { /* along: to the second parameter; across: at its value */
    self->along[i] = (a * point->basis[0][i] + b * point->basis[1][i]) / length;
    self->across[i] = (b * point->basis[0][i] - a * point->basis[1][i]) / length;
  }
  self->slope = (double)NAN;
  if (!find_root(self, point, 0.0, WINDOW, self->slot[1], &tries) || !isfinite(self->slope))
    return false;
  strut_follow_surface_point_copy(surface, self->slot[1], point);
  if (!strut_follow_surface_complete(surface, point)) return false;
  /* the direction in which the test function stays zero */
  const double h = 0.1 * WINDOW;
  trial t = {.p = self->slot[2]};
  strut_follow_surface_point *ahead = self->slot[5];
  strut_follow_surface_point_copy(surface, point, ahead);
  strut_follow_surface_move(surface, ahead, self->along, h);
  if (!strut_follow_criterion_at(surface, &self->criterion, point, &value) ||
      !try_aside(self, point, h, 0.0, ahead, 0.0, &t))
    return false;
  beside = (t.value - value) / h;
  double *vector = self->before;
  for (size_t i = 0; i < m; i++)
    vector[i] = self->slope * self->along[i] - beside * self->across[i];
  if (normalise(vector, m) == 0.0) return false;
  if (vector[m - 1] < 0.0)
    for (size_t i = 0; i < m; i++) vector[i] = -vector[i];
  self->slope = (double)NAN;
  return set_direction(self, point, vector);
}

/* ---- the walk ---- */

/* Which edge of the ranges a value is nearest to, as a distance within [1]; below 0 outside. */
static double within(const strut_follow_surface *surface, const double value[2], int *which) {
  double least = HUGE_VAL;
  for (int k = 0; k < 2; k++) {
    double part = (value[k] - surface->low[k]) / (surface->high[k] - surface->low[k]),
           in = fmin(part, 1.0 - part);
    if (in < least) least = in, *which = k;
  }
  return least;
}

/* The step shortened so that it ends on the first edge it would pass. */
static double limited(const walk *self, const strut_follow_surface_point *point, double h) {
  const strut_follow_surface *surface = self->u;
  for (size_t k = 0; k < 2; k++) {
    double rate = self->along[surface->s.n + k];
    double part = (point->value[k] - surface->low[k]) / (surface->high[k] - surface->low[k]);
    h = fmin(h, self->limits->longest / fmax(fabs(rate), 1e-9));
    if (rate > 0.0) h = fmin(h, fmax((1.0 - part) / rate, 0.5 * EDGE));
    if (rate < 0.0) h = fmin(h, fmax(-part / rate, 0.5 * EDGE));
  }
  return h;
}

/* Unit vector of the step into w->step; returns its length. */
static double measure_step(walk *self, const strut_follow_surface_point *first,
                           const strut_follow_surface_point *second) {
  for (size_t i = 0; i < self->u->m; i++)
    self->step[i] = strut_follow_surface_difference(self->u, first, second, i);
  return normalise(self->step, self->u->m);
}

/* Does the curve turn back in the plane of the parameters between the step before and the latest? */
static bool turns_back(const walk *self, bool stepped) {
  size_t n = self->u->s.n;
  return stepped && self->curve->kind == STRUT_FOLLOW_FOLD &&
         strut_dot(self->step + n, self->before + n, 2) < 0.0;
}

/*
 * The cusp within the latest three points a, b and the one that is appended next, at which the parameters'
 * rates vanish: by parabolas through them.
 */
static bool add_cusp(walk *self, const strut_follow_surface_point *next, double length) {
  strut_follow_curve *curve = self->curve;
  if (curve->count < 2) return true;
  strut_follow_curve_point a = curve->points[curve->count - 2], b = curve->points[curve->count - 1];
  double x = fabs(b.arc - a.arc), z = length, up = 0.0, down = 0.0, rate[2], bend[2];
  for (int k = 0; k < 2; k++) {
    double range = self->u->high[k] - self->u->low[k];
    double p = (b.value[k] - a.value[k]) / range / x, q = (next->value[k] - b.value[k]) / range / z;
    bend[k] = (q - p) / (x + z);
    rate[k] = p + x * bend[k]; /* at b */
    up -= rate[k] * bend[k], down += 2.0 * bend[k] * bend[k];
  }
  double at = down > 0.0 ? fmin(fmax(up / down, -x), z) : 0.0;
  strut_follow_curve_point *cusp = append(self);
  if (!cusp) return false;
  *cusp = b;
  cusp->cusp = true;
  cusp->arc = b.arc + (self->backwards ? -at : at);
  for (int k = 0; k < 2; k++)
    cusp->value[k] += at * (rate[k] + at * bend[k]) * (self->u->high[k] - self->u->low[k]);
  if (at < 0.0) { /* it lies before b */
    curve->points[curve->count - 2] = *cusp;
    curve->points[curve->count - 1] = b;
  }
  return true;
}

static bool is_closed(const walk *self, const strut_follow_surface_point *first,
                      const strut_follow_surface_point *point, double h) {
  double off = 0.0;
  for (size_t i = 0; i < self->u->m; i++)
    off += pow(strut_follow_surface_difference(self->u, first, point, i), 2);
  return sqrt(off) < 0.6 * h;
}

/* Takes steps from slot 0 until the curve ends; returns why. */
static const char *walk_on(walk *self, const strut_follow_surface_point *first) {
  strut_follow_surface *surface = self->u;
  strut_follow_surface_point *here = self->slot[0], *next = self->slot[1];
  double h = FIRST;
  bool stepped = false;
  size_t m = surface->m;
  int which = 0;
  for (int32_t steps = 0; steps < self->limits->steps;) {
    int tries = 0;
    h = limited(self, here, h);
    bool good = find_root(self, here, h, ASIDE * h, next, &tries) &&
                strut_follow_surface_complete(surface, next);
    if (surface->status) return "interrupted";
    double length = good ? measure_step(self, here, next) : 0.0;
    double angle = good ? acos(fmin(1.0, strut_dot(self->step, self->along, (ptrdiff_t)m))) : 0.0;
    bool back = good && turns_back(self, stepped);
    if (!good || angle > SHARP || (back && h > CUSP)) {
      if (h <= LEAST) return "no such motion was found beyond";
      h = back && good && angle <= SHARP ? CUSP : fmax(0.4 * h, LEAST);
      self->slope = good ? self->slope : (double)NAN;
      continue;
    }
    double in = within(surface, next->value, &which);
    if (in < -10.0 * EDGE) { /* past an edge: nearer to it first */
      if (h <= LEAST) return "the range of a parameter ends";
      h = fmax(0.5 * h, LEAST);
      continue;
    }
    if (back && !add_cusp(self, next, length)) return "interrupted";
    self->arc += length;
    if (!add_point(self, next))
      return surface->status ? "interrupted" : "the motion was lost beyond";
    self->criterion.phase = self->criterion.next_phase;
    steps++;
    if (in < EDGE) return "the range of a parameter ends";
    if (steps > CLOSED && is_closed(self, first, next, h)) return "the curve is closed";
    /* the direction, with half of the change between the latest two steps */
    double vector_weight = stepped ? 0.5 : 0.0;
    for (size_t i = 0; i < m; i++) {
      double latest = self->step[i], change = latest - self->before[i];
      self->before[i] = latest;
      self->along[i] = latest + vector_weight * change;
    }
    memcpy(surface->x, self->along, m * sizeof(double));
    if (!set_direction(self, next, surface->x)) return "no such motion was found beyond";
    stepped = true;
    here = next, next = self->slot[0];
    self->slot[1] = next, self->slot[0] = here;
    if (tries <= FEW && angle < STRAIGHT) h = fmin(1.5 * h, MOST);
  }
  return "the number of steps is used up";
}

/* ---- the curve ---- */

static bool allocate(walk *self, strut_arena *arena) {
  size_t m = self->u->m;
  bool good = (self->along = strut_arena_allocate(arena, m, sizeof(double))) &&
              (self->across = strut_arena_allocate(arena, m, sizeof(double))) &&
              (self->step = strut_arena_allocate(arena, m, sizeof(double))) &&
              (self->before = strut_arena_allocate(arena, m, sizeof(double))) &&
              (self->criterion.scratch = strut_arena_allocate(arena, m * m, sizeof(double)));
  for (int i = 0; i < SLOTS && good; i++)
    good = (self->slot[i] = strut_follow_surface_point_new(self->u, arena)) != NULL;
  if (!good) self->u->status = strut_no_memory(self->u->error, "");
  return good;
}

/* The points of the way back, which were appended last, go before those of the way forth. */
static void order_points(strut_follow_curve *curve, size_t forth) {
  size_t back = curve->count - forth;
  strut_follow_curve_point *point = curve->points;
  for (size_t i = 0, k = curve->count; i + 1 < k; i++) {
    strut_follow_curve_point keep = point[i];
    point[i] = point[--k], point[k] = keep;
  }
  for (size_t i = back, k = curve->count; i + 1 < k; i++) {
    strut_follow_curve_point keep = point[i];
    point[i] = point[--k], point[k] = keep;
  }
  curve->start = back;
  double least = curve->count ? point[0].arc : 0.0;
  for (size_t i = 0; i < curve->count; i++) point[i].arc -= least;
}

/* Both ways from the point in slot 0, which is on the curve; `first`: a copy of it. */
static void walk_both_ways(walk *self, strut_follow_surface_point *first, double *direction) {
  strut_follow_curve *curve = self->curve;
  size_t m = self->u->m;
  const strut_follow_criterion criterion = self->criterion;
  memcpy(direction, self->along, m * sizeof(double));
  strut_follow_surface_point_copy(self->u, self->slot[0], first);
  if (!add_point(self, self->slot[0])) return;
  curve->ends[1] = walk_on(self, first);
  size_t forth = curve->count;
  if (!self->u->status && strcmp(curve->ends[1], "the curve is closed") != 0) {
    strut_follow_surface_point_copy(self->u, first, self->slot[0]);
    for (size_t i = 0; i < m; i++) direction[i] = -direction[i];
    self->criterion = criterion;
    self->arc = 0.0;
    self->backwards = true;
    self->slope = (double)NAN;
    curve->ends[0] = set_direction(self, self->slot[0], direction) ? walk_on(self, first) : "";
  } else {
    curve->ends[0] = curve->ends[1];
  }
  order_points(curve, forth);
}

strut_status strut_follow_curve_make(strut_follow_surface *surface,
                                     const strut_follow_curve_start *start,
                                     const strut_follow_curve_limits *limits,
                                     strut_follow_curve *curve, strut_error *error) {
  strut_arena arena = {0};
  int64_t maps = surface->s.spent.maps;
  *curve = (strut_follow_curve){.kind = start->kind,
                                .repeats = surface->s.how.repeats,
                                .travels = surface->s.travels,
                                .ends = {"", ""}};
  walk w = {.u = surface,
            .criterion = {.kind = start->kind},
            .curve = curve,
            .limits = limits,
            .slope = (double)NAN};
  surface->error = error;
  surface->status = STRUT_OK;
  strut_follow_surface_point *first = NULL;
  double *direction = NULL;
  if (allocate(&w, &arena)) {
    first = strut_follow_surface_point_new(surface, &arena);
    direction = strut_arena_allocate(&arena, surface->m, sizeof *direction);
    if (!first || !direction) surface->status = strut_no_memory(error, "");
  }
  if (!surface->status) {
    strut_follow_surface_point *point = w.slot[0];
    bool gap = start->kind == STRUT_FOLLOW_TOUCH || start->kind == STRUT_FOLLOW_LIFT;
    memcpy(point->value, start->value, sizeof point->value);
    memcpy(point->y, start->y, surface->s.both * sizeof(double));
    surface->s.derivative.known = false;
    if (start->node) curve->node = strut_arena_format(&curve->arena, "%s", start->node);
    if (gap && !strut_follow_criterion_choose(surface, &w.criterion, point, start->node))
      curve->ends[0] = "no extremum of its gap is near zero there";
    else if (!begin(&w, point))
      curve->ends[0] = "no curve leads through it";
    else
      walk_both_ways(&w, first, direction);
    curve->contact = w.criterion.contact;
  }
  curve->maps = surface->s.spent.maps - maps;
  strut_arena_free(&arena);
  return surface->status;
}

void strut_follow_curve_free(strut_follow_curve *curve) {
  strut_arena_free(&curve->arena);
  *curve = (strut_follow_curve){.count = 0};
}

bool strut_follow_curve_passes(const strut_follow_surface *surface, const strut_follow_curve *curve,
                               const strut_follow_curve_start *start) {
  const strut_follow_system *system = &surface->s;
  bool same_node =
      !start->node == !curve->node && (!start->node || strcmp(start->node, curve->node) == 0);
  if (curve->kind != start->kind || curve->repeats != system->how.repeats || !same_node)
    return false;
  double b = start->value[1];
  for (size_t k = 0; k + 1 < curve->count; k++) {
    const strut_follow_curve_point *point = &curve->points[k], *q = point + 1;
    if ((point->value[1] - b) * (q->value[1] - b) > 0.0) continue;
    double part = q->value[1] != point->value[1]
                      ? (b - point->value[1]) / (q->value[1] - point->value[1])
                      : 0.0;
    double off = fabs(point->value[0] + part * (q->value[0] - point->value[0]) - start->value[0]);
    double most = 0.0;
    for (size_t i = 0; i < system->n; i++) {
      double y =
          point->y[system->place[i]] + part * (q->y[system->place[i]] - point->y[system->place[i]]);
      most = fmax(most, fabs(y - start->y[system->place[i]]) / strut_follow_unit(system, i));
    }
    if (off < SAME * (surface->high[0] - surface->low[0]) && most < NEAR) return true;
  }
  return false;
}
