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

static strut_follow_curve_point *append(walk *w) {
  strut_follow_curve *c = w->curve;
  if (c->count == w->room) {
    size_t room = w->room ? 2 * w->room : 128;
    strut_follow_curve_point *points = strut_arena_allocate(&c->arena, room, sizeof *points);
    if (!points) {
      w->u->status = strut_no_memory(w->u->error, "");
      return NULL;
    }
    if (c->count) memcpy(points, c->points, c->count * sizeof *points);
    c->points = points;
    w->room = room;
  }
  return &c->points[c->count++];
}

/* Multipliers but for the one that decides: the largest, and whether all are within the circle. */
static void judge(const walk *w, const strut_follow_surface_point *p,
                  strut_follow_curve_point *to) {
  double wanted = w->curve->kind == STRUT_FOLLOW_DOUBLING ? -1.0 : 1.0, least = HUGE_VAL;
  bool decides = w->curve->kind == STRUT_FOLLOW_FOLD || w->curve->kind == STRUT_FOLLOW_DOUBLING;
  size_t own = p->multipliers;
  for (size_t i = 0; i < p->multipliers && decides; i++) {
    double off = hypot(p->multiplier[i][0] - wanted, p->multiplier[i][1]);
    if (off < least) least = off, own = i;
  }
  to->stable = true;
  to->multiplier[0] = to->multiplier[1] = (double)NAN;
  for (size_t i = p->multipliers; i-- > 0;) {
    if (i == own) continue;
    memcpy(to->multiplier, p->multiplier[i], sizeof to->multiplier);
    to->stable = to->stable && hypot(p->multiplier[i][0], p->multiplier[i][1]) <= 1.0;
  }
}

/* Appends p, which is complete. False: the motion is lost, or status. */
static bool add_point(walk *w, strut_follow_surface_point *p) {
  strut_follow_surface *u = w->u;
  strut_follow_system *s = &u->s;
  if (!strut_follow_surface_set(u, p->value)) return false;
  double *y = strut_arena_allocate(&w->curve->arena, s->both, sizeof *y);
  if (!y) u->status = strut_no_memory(u->error, "");
  if (!y) return false;
  strut_follow_centre(s, p->y);
  memcpy(y, p->y, s->both * sizeof *y);
  memcpy(s->buffers.end, p->y, s->both * sizeof *y);
  const strut_follow_period period = strut_follow_apply(s, s->buffers.end, true);
  if (!isfinite(period.travel)) return false;
  strut_follow_curve_point *to = append(w);
  if (!to) return false;
  *to = (strut_follow_curve_point){.value = {p->value[0], p->value[1]},
                                   .arc = w->backwards ? -w->arc : w->arc,
                                   .velocity = period.travel / (s->period * s->how.repeats),
                                   .work = period.work / s->how.repeats,
                                   .amplitude = period.amplitude,
                                   .y = y};
  judge(w, p, to);
  return true;
}

/* ---- the root across a direction ---- */

/* A trial across the direction: its place and the test function there. */
typedef struct trial {
  double at, value;
  strut_follow_surface_point *p;
} trial;

/* Evaluates the trial `aside` of the direction, from `guess`, which lies on the surface or near it. */
static bool try_aside(walk *w, const strut_follow_surface_point *base, double h, double aside,
                      const strut_follow_surface_point *guess, double moved, trial *t) {
  const double *const rows[2] = {w->along, w->across};
  const double offset[2] = {h, aside};
  strut_follow_surface_point_copy(w->u, guess, t->p);
  strut_follow_surface_move(w->u, t->p, w->across, moved);
  t->at = aside;
  return strut_follow_surface_correct(w->u, t->p, base, rows, offset) &&
         strut_follow_criterion_at(w->u, &w->criterion, t->p, &t->value);
}

/*
 * The root at distance h along the direction from base, at most `window` aside of it, into `next`; slots 2 to
 * 4 are scratch. False: there is none. *tries: how many evaluations it took.
 */
static bool find_root(walk *w, const strut_follow_surface_point *base, double h, double window,
                      strut_follow_surface_point *next, int *tries) {
  trial a = {.p = w->slot[2]}, b = {.p = w->slot[3]}, c = {.p = w->slot[4]};
  double least = FOUND * fmax(h, 0.1 * window) + 1e-9;
  bool bracketed = false;
  strut_follow_surface_point *ahead = w->slot[5];
  strut_follow_surface_point_copy(w->u, base, ahead);
  strut_follow_surface_move(w->u, ahead, w->along, h);
  *tries = 1;
  if (!try_aside(w, base, h, 0.0, ahead, 0.0, &a)) return false;
  double guess = isfinite(w->slope) && w->slope != 0.0 ? -a.value / w->slope : 0.1 * window;
  guess = fmin(fmax(guess, -0.5 * window), 0.5 * window);
  if (fabs(guess) < least) guess = guess < 0.0 ? -least : least;
  if (!try_aside(w, base, h, guess, a.p, guess - a.at, &b)) return false;
  for (*tries = 2; *tries < MOST_ROOTS; ++*tries) {
    bracketed = (a.value <= 0.0) != (b.value <= 0.0);
    double slope = (b.value - a.value) / (b.at - a.at);
    if (fabs(a.value) < fabs(b.value)) { /* b is the better one */
      trial keep = a;
      a = b, b = keep;
    }
    double at = slope != 0.0 && isfinite(slope) ? b.at - b.value / slope : 2.0 * b.at - a.at;
    if (isfinite(slope) && slope != 0.0) w->slope = slope;
    if (b.value == 0.0 || fabs(at - b.at) < least) {
      strut_follow_surface_point_copy(w->u, b.p, next);
      return fabs(b.at) <= window;
    }
    if (bracketed && !((at - a.at) * (at - b.at) < 0.0)) at = 0.5 * (a.at + b.at);
    if (fabs(at) > window || !try_aside(w, base, h, at, b.p, at - b.at, &c)) return false;
    /* where a root is between two trials it stays there */
    if (bracketed && (c.value <= 0.0) == (b.value <= 0.0) && (c.value <= 0.0) != (a.value <= 0.0)) {
      trial keep = b;
      b = c, c = keep;
      if (fabs(b.at - a.at) < least) {
        strut_follow_surface_point_copy(w->u, b.p, next);
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
static bool set_direction(walk *w, const strut_follow_surface_point *p, const double *vector) {
  size_t m = w->u->m;
  double c = strut_dot(vector, p->basis[0], (ptrdiff_t)m),
         d = strut_dot(vector, p->basis[1], (ptrdiff_t)m), length = hypot(c, d);
  if (!(length > 1e-6)) return false;
  c /= length, d /= length;
  double turn = 0.0;
  for (size_t i = 0; i < m; i++) {
    double across = -d * p->basis[0][i] + c * p->basis[1][i];
    turn += across * w->across[i];
    w->along[i] = c * p->basis[0][i] + d * p->basis[1][i];
    w->step[i] = across; /* kept for a moment */
  }
  for (size_t i = 0; i < m; i++) w->across[i] = turn < 0.0 ? -w->step[i] : w->step[i];
  return true;
}

/*
 * Moves p, near the curve, onto it at the second parameter's value, and sets the direction there, in which
 * the second parameter grows. False: there is no curve.
 */
static bool begin(walk *w, strut_follow_surface_point *p) {
  strut_follow_surface *u = w->u;
  size_t m = u->m;
  int tries;
  double value, beside;
  if (!strut_follow_surface_complete(u, p)) return false;
  double a = p->basis[0][m - 1], b = p->basis[1][m - 1], length = hypot(a, b);
  if (!(length > 0.0)) return false;
  for (size_t i = 0; i < m; i++) { /* along: to the second parameter; across: at its value */
    w->along[i] = (a * p->basis[0][i] + b * p->basis[1][i]) / length;
    w->across[i] = (b * p->basis[0][i] - a * p->basis[1][i]) / length;
  }
  w->slope = (double)NAN;
  if (!find_root(w, p, 0.0, WINDOW, w->slot[1], &tries) || !isfinite(w->slope)) return false;
  strut_follow_surface_point_copy(u, w->slot[1], p);
  if (!strut_follow_surface_complete(u, p)) return false;
  /* the direction in which the test function stays zero */
  const double h = 0.1 * WINDOW;
  trial t = {.p = w->slot[2]};
  strut_follow_surface_point *ahead = w->slot[5];
  strut_follow_surface_point_copy(u, p, ahead);
  strut_follow_surface_move(u, ahead, w->along, h);
  if (!strut_follow_criterion_at(u, &w->criterion, p, &value) ||
      !try_aside(w, p, h, 0.0, ahead, 0.0, &t))
    return false;
  beside = (t.value - value) / h;
  double *vector = w->before;
  for (size_t i = 0; i < m; i++) vector[i] = w->slope * w->along[i] - beside * w->across[i];
  if (normalise(vector, m) == 0.0) return false;
  if (vector[m - 1] < 0.0)
    for (size_t i = 0; i < m; i++) vector[i] = -vector[i];
  w->slope = (double)NAN;
  return set_direction(w, p, vector);
}

/* ---- the walk ---- */

/* Which edge of the ranges a value is nearest to, as a distance within [1]; below 0 outside. */
static double within(const strut_follow_surface *u, const double value[2], int *which) {
  double least = HUGE_VAL;
  for (int k = 0; k < 2; k++) {
    double part = (value[k] - u->low[k]) / (u->high[k] - u->low[k]), in = fmin(part, 1.0 - part);
    if (in < least) least = in, *which = k;
  }
  return least;
}

/* The step shortened so that it ends on the first edge it would pass. */
static double limited(const walk *w, const strut_follow_surface_point *p, double h) {
  const strut_follow_surface *u = w->u;
  for (size_t k = 0; k < 2; k++) {
    double rate = w->along[u->s.n + k];
    double part = (p->value[k] - u->low[k]) / (u->high[k] - u->low[k]);
    h = fmin(h, w->limits->longest / fmax(fabs(rate), 1e-9));
    if (rate > 0.0) h = fmin(h, fmax((1.0 - part) / rate, 0.5 * EDGE));
    if (rate < 0.0) h = fmin(h, fmax(-part / rate, 0.5 * EDGE));
  }
  return h;
}

/* Unit vector of the step into w->step; returns its length. */
static double measure_step(walk *w, const strut_follow_surface_point *a,
                           const strut_follow_surface_point *b) {
  for (size_t i = 0; i < w->u->m; i++) w->step[i] = strut_follow_surface_difference(w->u, a, b, i);
  return normalise(w->step, w->u->m);
}

/* Does the curve turn back in the plane of the parameters between the step before and the latest? */
static bool turns_back(const walk *w, bool stepped) {
  size_t n = w->u->s.n;
  return stepped && w->curve->kind == STRUT_FOLLOW_FOLD &&
         strut_dot(w->step + n, w->before + n, 2) < 0.0;
}

/*
 * The cusp within the latest three points a, b and the one that is appended next, at which the parameters'
 * rates vanish: by parabolas through them.
 */
static bool add_cusp(walk *w, const strut_follow_surface_point *next, double length) {
  strut_follow_curve *c = w->curve;
  if (c->count < 2) return true;
  strut_follow_curve_point a = c->points[c->count - 2], b = c->points[c->count - 1];
  double x = fabs(b.arc - a.arc), z = length, up = 0.0, down = 0.0, rate[2], bend[2];
  for (int k = 0; k < 2; k++) {
    double range = w->u->high[k] - w->u->low[k];
    double p = (b.value[k] - a.value[k]) / range / x, q = (next->value[k] - b.value[k]) / range / z;
    bend[k] = (q - p) / (x + z);
    rate[k] = p + x * bend[k]; /* at b */
    up -= rate[k] * bend[k], down += 2.0 * bend[k] * bend[k];
  }
  double at = down > 0.0 ? fmin(fmax(up / down, -x), z) : 0.0;
  strut_follow_curve_point *cusp = append(w);
  if (!cusp) return false;
  *cusp = b;
  cusp->cusp = true;
  cusp->arc = b.arc + (w->backwards ? -at : at);
  for (int k = 0; k < 2; k++)
    cusp->value[k] += at * (rate[k] + at * bend[k]) * (w->u->high[k] - w->u->low[k]);
  if (at < 0.0) { /* it lies before b */
    c->points[c->count - 2] = *cusp;
    c->points[c->count - 1] = b;
  }
  return true;
}

static bool is_closed(const walk *w, const strut_follow_surface_point *first,
                      const strut_follow_surface_point *p, double h) {
  double off = 0.0;
  for (size_t i = 0; i < w->u->m; i++)
    off += pow(strut_follow_surface_difference(w->u, first, p, i), 2);
  return sqrt(off) < 0.6 * h;
}

/* Takes steps from slot 0 until the curve ends; returns why. */
static const char *walk_on(walk *w, const strut_follow_surface_point *first) {
  strut_follow_surface *u = w->u;
  strut_follow_surface_point *here = w->slot[0], *next = w->slot[1];
  double h = FIRST;
  bool stepped = false;
  size_t m = u->m;
  int which = 0;
  for (int32_t steps = 0; steps < w->limits->steps;) {
    int tries = 0;
    h = limited(w, here, h);
    bool good =
        find_root(w, here, h, ASIDE * h, next, &tries) && strut_follow_surface_complete(u, next);
    if (u->status) return "interrupted";
    double length = good ? measure_step(w, here, next) : 0.0;
    double angle = good ? acos(fmin(1.0, strut_dot(w->step, w->along, (ptrdiff_t)m))) : 0.0;
    bool back = good && turns_back(w, stepped);
    if (!good || angle > SHARP || (back && h > CUSP)) {
      if (h <= LEAST) return "no such motion was found beyond";
      h = back && good && angle <= SHARP ? CUSP : fmax(0.4 * h, LEAST);
      w->slope = good ? w->slope : (double)NAN;
      continue;
    }
    double in = within(u, next->value, &which);
    if (in < -10.0 * EDGE) { /* past an edge: nearer to it first */
      if (h <= LEAST) return "the range of a parameter ends";
      h = fmax(0.5 * h, LEAST);
      continue;
    }
    if (back && !add_cusp(w, next, length)) return "interrupted";
    w->arc += length;
    if (!add_point(w, next)) return u->status ? "interrupted" : "the motion was lost beyond";
    w->criterion.phase = w->criterion.next_phase;
    steps++;
    if (in < EDGE) return "the range of a parameter ends";
    if (steps > CLOSED && is_closed(w, first, next, h)) return "the curve is closed";
    /* the direction, with half of the change between the latest two steps */
    double vector_weight = stepped ? 0.5 : 0.0;
    for (size_t i = 0; i < m; i++) {
      double latest = w->step[i], change = latest - w->before[i];
      w->before[i] = latest;
      w->along[i] = latest + vector_weight * change;
    }
    memcpy(u->x, w->along, m * sizeof(double));
    if (!set_direction(w, next, u->x)) return "no such motion was found beyond";
    stepped = true;
    here = next, next = w->slot[0];
    w->slot[1] = next, w->slot[0] = here;
    if (tries <= FEW && angle < STRAIGHT) h = fmin(1.5 * h, MOST);
  }
  return "the number of steps is used up";
}

/* ---- the curve ---- */

static bool allocate(walk *w, strut_arena *arena) {
  size_t m = w->u->m;
  bool good = (w->along = strut_arena_allocate(arena, m, sizeof(double))) &&
              (w->across = strut_arena_allocate(arena, m, sizeof(double))) &&
              (w->step = strut_arena_allocate(arena, m, sizeof(double))) &&
              (w->before = strut_arena_allocate(arena, m, sizeof(double))) &&
              (w->criterion.scratch = strut_arena_allocate(arena, m * m, sizeof(double)));
  for (int i = 0; i < SLOTS && good; i++)
    good = (w->slot[i] = strut_follow_surface_point_new(w->u, arena)) != NULL;
  if (!good) w->u->status = strut_no_memory(w->u->error, "");
  return good;
}

/* The points of the way back, which were appended last, go before those of the way forth. */
static void order_points(strut_follow_curve *c, size_t forth) {
  size_t back = c->count - forth;
  strut_follow_curve_point *p = c->points;
  for (size_t i = 0, k = c->count; i + 1 < k; i++) {
    strut_follow_curve_point keep = p[i];
    p[i] = p[--k], p[k] = keep;
  }
  for (size_t i = back, k = c->count; i + 1 < k; i++) {
    strut_follow_curve_point keep = p[i];
    p[i] = p[--k], p[k] = keep;
  }
  c->start = back;
  double least = c->count ? p[0].arc : 0.0;
  for (size_t i = 0; i < c->count; i++) p[i].arc -= least;
}

/* Both ways from the point in slot 0, which is on the curve; `first`: a copy of it. */
static void walk_both_ways(walk *w, strut_follow_surface_point *first, double *direction) {
  strut_follow_curve *c = w->curve;
  size_t m = w->u->m;
  const strut_follow_criterion criterion = w->criterion;
  memcpy(direction, w->along, m * sizeof(double));
  strut_follow_surface_point_copy(w->u, w->slot[0], first);
  if (!add_point(w, w->slot[0])) return;
  c->ends[1] = walk_on(w, first);
  size_t forth = c->count;
  if (!w->u->status && strcmp(c->ends[1], "the curve is closed") != 0) {
    strut_follow_surface_point_copy(w->u, first, w->slot[0]);
    for (size_t i = 0; i < m; i++) direction[i] = -direction[i];
    w->criterion = criterion;
    w->arc = 0.0;
    w->backwards = true;
    w->slope = (double)NAN;
    c->ends[0] = set_direction(w, w->slot[0], direction) ? walk_on(w, first) : "";
  } else {
    c->ends[0] = c->ends[1];
  }
  order_points(c, forth);
}

strut_status strut_follow_curve_make(strut_follow_surface *u, const strut_follow_curve_start *start,
                                     const strut_follow_curve_limits *limits,
                                     strut_follow_curve *curve, strut_error *error) {
  strut_arena arena = {0};
  int64_t maps = u->s.spent.maps;
  *curve = (strut_follow_curve){
      .kind = start->kind, .repeats = u->s.how.repeats, .travels = u->s.travels, .ends = {"", ""}};
  walk w = {.u = u,
            .criterion = {.kind = start->kind},
            .curve = curve,
            .limits = limits,
            .slope = (double)NAN};
  u->error = error;
  u->status = STRUT_OK;
  strut_follow_surface_point *first = NULL;
  double *direction = NULL;
  if (allocate(&w, &arena)) {
    first = strut_follow_surface_point_new(u, &arena);
    direction = strut_arena_allocate(&arena, u->m, sizeof *direction);
    if (!first || !direction) u->status = strut_no_memory(error, "");
  }
  if (!u->status) {
    strut_follow_surface_point *p = w.slot[0];
    bool gap = start->kind == STRUT_FOLLOW_TOUCH || start->kind == STRUT_FOLLOW_LIFT;
    memcpy(p->value, start->value, sizeof p->value);
    memcpy(p->y, start->y, u->s.both * sizeof(double));
    u->s.derivative.known = false;
    if (start->node) curve->node = strut_arena_format(&curve->arena, "%s", start->node);
    if (gap && !strut_follow_criterion_choose(u, &w.criterion, p, start->node))
      curve->ends[0] = "no extremum of its gap is near zero there";
    else if (!begin(&w, p))
      curve->ends[0] = "no curve leads through it";
    else
      walk_both_ways(&w, first, direction);
    curve->contact = w.criterion.contact;
  }
  curve->maps = u->s.spent.maps - maps;
  strut_arena_free(&arena);
  return u->status;
}

void strut_follow_curve_free(strut_follow_curve *curve) {
  strut_arena_free(&curve->arena);
  *curve = (strut_follow_curve){.count = 0};
}

bool strut_follow_curve_passes(const strut_follow_surface *u, const strut_follow_curve *curve,
                               const strut_follow_curve_start *start) {
  const strut_follow_system *s = &u->s;
  bool same_node =
      !start->node == !curve->node && (!start->node || strcmp(start->node, curve->node) == 0);
  if (curve->kind != start->kind || curve->repeats != s->how.repeats || !same_node) return false;
  double b = start->value[1];
  for (size_t k = 0; k + 1 < curve->count; k++) {
    const strut_follow_curve_point *p = &curve->points[k], *q = p + 1;
    if ((p->value[1] - b) * (q->value[1] - b) > 0.0) continue;
    double part =
        q->value[1] != p->value[1] ? (b - p->value[1]) / (q->value[1] - p->value[1]) : 0.0;
    double off = fabs(p->value[0] + part * (q->value[0] - p->value[0]) - start->value[0]);
    double most = 0.0;
    for (size_t i = 0; i < s->n; i++) {
      double y = p->y[s->place[i]] + part * (q->y[s->place[i]] - p->y[s->place[i]]);
      most = fmax(most, fabs(y - start->y[s->place[i]]) / strut_follow_unit(s, i));
    }
    if (off < SAME * (u->high[0] - u->low[0]) && most < NEAR) return true;
  }
  return false;
}
