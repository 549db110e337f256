/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The walk along a branch: prediction, correction, step control, ends. */
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/run/follow/follow.h"
#include "engine/run/follow/follow_parts.h"
#include "engine/run/simulate.h"

/* Steps of arclength [1]: the first, the least; and least cosine between successive tangents. */
static const double FIRST = 0.01, LEAST = 5e-5, MOST = 1.0, STRAIGHT = 0.5;
/* Below this step a corner is passed whatever the tangents say. */
static const double CORNER = 1e-3;
/* Part of a step: orbits this near to the way come have been passed before. */
static const double BACK = 0.02;
/* Longest step along a parabola, in the step before, and least cosine of the tangents at its ends. */
static const double REACH = 2.0, SMOOTH = 0.95;
/* Rounds of Newton's method after which the step grows, and shrinks. */
enum { FEW = 7, MANY = 13, CLOSED = 12, LATEST = 12 };
/* Amplitude with which a doubled branch is left [1]. */
static const double LEAVE = 0.02;

const char *strut_follow_kind_word(strut_follow_kind kind) {
  static const char *const words[] = {
#define STRUT_FOLLOW_WORD(name, word, what) word,
      STRUT_FOLLOW_TABLE(STRUT_FOLLOW_WORD)
#undef STRUT_FOLLOW_WORD
  };
  return words[kind];
}

static bool grow(strut_follow_walk *w) {
  strut_follow_branch *b = w->branch;
  if (b->count < w->room) return true;
  size_t room = w->room ? 2 * w->room : 256;
  strut_follow_point *points = strut_arena_allocate(&b->arena, room, sizeof *points);
  if (!points) w->status = strut_no_memory(w->error, "");
  if (!points) return false;
  if (b->count) memcpy(points, b->points, b->count * sizeof *points);
  b->points = points;
  w->room = room;
  return true;
}

strut_follow_point *strut_follow_add(strut_follow_walk *w, const strut_follow_orbit *o, double arc,
                                     strut_follow_kind kind) {
  strut_follow_branch *b = w->branch;
  if (!grow(w)) return NULL;
  strut_follow_point *p = &b->points[b->count];
  *p = (strut_follow_point){.kind = kind,
                            .value = o->value,
                            .arc = w->backwards ? -arc : arc,
                            .velocity = o->velocity,
                            .work = o->work,
                            .amplitude = o->amplitude,
                            .multiplier = {(double)NAN, (double)NAN},
                            .y = o->y};
  const strut_follow_signature g = o->signature;
  p->stable = o->complete && g.plus == 0 && g.minus == 0 && g.pairs == 0;
  if (o->complete && o->multipliers) memcpy(p->multiplier, o->multiplier[0], sizeof p->multiplier);
  p->word = strut_follow_word_text(w->s, &o->word, &b->arena);
  if (!p->word) w->status = strut_no_memory(w->error, "");
  if (!p->word) return NULL;
  b->count++;
  return p;
}

/*
 * A guess of the orbit one step h from o, along the parabola through o and the orbit before, whose tangents
 * turn by little; along the tangent of o otherwise.
 */
static void predict(strut_follow_walk *w, const strut_follow_orbit *o, double h,
                    strut_follow_orbit *next) {
  const strut_follow_system *s = w->s;
  const strut_follow_orbit *a = o->before;
  double bend = 0.0, *way = w->right;
  if (a && a->complete && h <= REACH * o->distance &&
      strut_dot(a->tangent, o->tangent, (ptrdiff_t)(s->n + 1)) > SMOOTH)
    bend = 0.5 * h * h / o->distance;
  for (size_t i = 0; i <= s->n; i++) {
    way[i] = h * o->tangent[i];
    if (bend > 0.0) way[i] += bend * (o->tangent[i] - a->tangent[i]);
  }
  memcpy(next->y, o->y, s->both * sizeof(double));
  strut_follow_move(s, next->y, way, 1.0);
  next->value = o->value + way[s->n] * (s->high - s->low);
  next->distance = h;
}

/* The orbit one step h from o, complete; NULL: none, and `reason` says why. */
static strut_follow_orbit *try_step(strut_follow_walk *w, const strut_follow_orbit *o, double h,
                                    int *rounds, const char **reason) {
  strut_follow_orbit *next = strut_follow_orbit_new(w);
  if (!next) return NULL;
  predict(w, o, h, next);
  next->before = o;
  if (!strut_follow_newton(w, next->y, &next->value,
                           &(strut_follow_section){o->tangent, o->y, o->value, h}, rounds)) {
    *reason = "no periodic motion was found beyond: Newton's method does not converge";
    return NULL;
  }
  if (!strut_follow_examine(w, next, o->tangent)) {
    *reason = "the motion was lost beyond";
    return NULL;
  }
  return next;
}

/* secant (n + 1): unit vector from a to b; returns their distance. */
static double secant_of(const strut_follow_system *s, const strut_follow_orbit *a,
                        const strut_follow_orbit *b, double *secant) {
  size_t n = s->n;
  for (size_t i = 0; i < n; i++)
    secant[i] = (b->y[s->place[i]] - a->y[s->place[i]]) / strut_follow_unit(s, i);
  secant[n] = (b->value - a->value) / (s->high - s->low);
  double length = sqrt(strut_dot(secant, secant, (ptrdiff_t)(n + 1)));
  for (size_t i = 0; i <= n && length > 0.0; i++) secant[i] /= length;
  return length;
}

/*
 * Behind a corner the derivative may be that of neither side, and its tangent lead back: then the way
 * come from a to b leads on.
 */
static bool straighten(strut_follow_walk *w, const strut_follow_orbit *a, strut_follow_orbit *b) {
  size_t n = w->s->n;
  double *secant = strut_arena_allocate(&w->branch->arena, n + 1, sizeof(double));
  if (!secant) w->status = strut_no_memory(w->error, "");
  if (!secant) return false;
  secant_of(w->s, a, b, secant);
  if (strut_dot(secant, b->tangent, (ptrdiff_t)(n + 1)) >= STRAIGHT) return true;
  memcpy(b->tangent, secant, (n + 1) * sizeof(double));
  b->signature.turn = secant[n] < 0.0 ? -1 : 1;
  return true;
}

/* Does b lie on the way behind a, on which the latest points are? */
static bool retraces(const strut_follow_walk *w, const strut_follow_orbit *a,
                     const strut_follow_orbit *b) {
  const strut_follow_system *s = w->s;
  const strut_follow_branch *branch = w->branch;
  size_t from = branch->count > LATEST ? branch->count - LATEST : 0;
  if (from < w->begin) from = w->begin;
  double step = 0.0, least = HUGE_VAL;
  for (size_t i = 0; i < s->n; i++)
    step += pow((b->y[s->place[i]] - a->y[s->place[i]]) / strut_follow_unit(s, i), 2);
  step += pow((b->value - a->value) / (s->high - s->low), 2);
  for (size_t k = from; k + 1 < branch->count; k++) {
    const strut_follow_point *p = &branch->points[k], *q = p + 1;
    double whole = 0.0, along = 0.0, off = 0.0;
    for (size_t i = 0; i <= s->n; i++) {
      double unit = i < s->n ? strut_follow_unit(s, i) : s->high - s->low;
      double d = (i < s->n ? q->y[s->place[i]] - p->y[s->place[i]] : q->value - p->value) / unit;
      double e = (i < s->n ? b->y[s->place[i]] - p->y[s->place[i]] : b->value - p->value) / unit;
      whole += d * d, along += d * e, off += e * e;
    }
    double part = whole > 0.0 ? along / whole : 0.0;
    if (part < 0.0 || part > 1.0) continue;
    least = fmin(least, off - part * along);
  }
  return least < BACK * BACK * step;
}

static bool outside(const strut_follow_system *s, double value) {
  double part = strut_follow_scaled(s, value);
  return part < -1e-9 || part > 1.0 + 1e-9;
}

/* The orbit at the edge of the range that lies between o and next. */
static strut_follow_orbit *at_edge(strut_follow_walk *w, const strut_follow_orbit *o,
                                   const strut_follow_orbit *next) {
  strut_follow_system *s = w->s;
  double edge = strut_follow_scaled(s, next->value) > 0.5 ? s->high : s->low;
  double part = (edge - o->value) / (next->value - o->value);
  int rounds;
  double *normal = strut_arena_allocate(&w->branch->arena, s->n + 1, sizeof(double));
  strut_follow_orbit *last = strut_follow_orbit_new(w);
  if (!normal && !w->status) w->status = strut_no_memory(w->error, "");
  if (!normal || !last) return NULL;
  if (!(part > 1e-6)) return NULL; /* o is there already */
  for (size_t i = 0; i < s->both; i++) last->y[i] = o->y[i] + part * (next->y[i] - o->y[i]);
  last->value = edge;
  normal[s->n] = 1.0;
  if (!strut_follow_newton(w, last->y, &last->value,
                           &(strut_follow_section){normal, last->y, edge, 0.0}, &rounds) ||
      !strut_follow_examine(w, last, o->tangent))
    return NULL;
  last->value = edge;
  double z = (last->value - o->value) / (s->high - s->low) * o->tangent[s->n];
  for (size_t i = 0; i < s->n; i++)
    z += o->tangent[i] * (last->y[s->place[i]] - o->y[s->place[i]]) / strut_follow_unit(s, i);
  last->distance = z;
  return last;
}

/* Accepts the step from o to next: special points, then the point itself. */
static bool accept_step(strut_follow_walk *w, const strut_follow_orbit *o,
                        const strut_follow_orbit *next, strut_follow_kind kind) {
  if (!strut_follow_locate(w, o, next)) return false;
  w->arc += next->distance;
  return strut_follow_add(w, next, w->arc, kind) != NULL;
}

/* Has the branch come back to where it began? */
static bool is_closed(const strut_follow_walk *w, const strut_follow_orbit *begin,
                      const strut_follow_orbit *o, double h) {
  const strut_follow_system *s = w->s;
  double off = pow((o->value - begin->value) / (s->high - s->low), 2);
  for (size_t i = 0; i < s->n; i++)
    off += pow((o->y[s->place[i]] - begin->y[s->place[i]]) / strut_follow_unit(s, i), 2);
  return sqrt(off) < 0.6 * h && strut_dot(o->tangent, begin->tangent, (ptrdiff_t)(s->n + 1)) > 0.8;
}

/* Beyond a corner the branch may lead backwards: looks along the tangent that holds there. */
static strut_follow_orbit *turn_at_corner(strut_follow_walk *w, strut_follow_orbit *o, double h,
                                          const char **reason) {
  strut_follow_system *s = w->s;
  strut_follow_orbit *beyond = strut_follow_orbit_new(w);
  if (!beyond) return NULL;
  memcpy(beyond->y, o->y, s->both * sizeof(double));
  strut_follow_move(s, beyond->y, o->tangent, h);
  beyond->value = o->value + h * o->tangent[s->n] * (s->high - s->low);
  if (outside(s, beyond->value) || !strut_follow_complete(w, beyond, o->tangent)) return NULL;
  for (int side = 1; side >= -1; side -= 2) {
    strut_follow_orbit from = *o;
    double *tangent = strut_arena_allocate(&w->branch->arena, s->n + 1, sizeof(double));
    int rounds;
    if (!tangent) w->status = strut_no_memory(w->error, "");
    if (!tangent) return NULL;
    for (size_t i = 0; i <= s->n; i++) tangent[i] = side * beyond->tangent[i];
    from.tangent = tangent;
    if (strut_dot(tangent, o->tangent, (ptrdiff_t)(s->n + 1)) < -0.98) continue;
    strut_follow_orbit *next = try_step(w, &from, 4.0 * h, &rounds, reason);
    if (w->status) return NULL;
    if (!next || strut_dot(next->tangent, o->tangent, (ptrdiff_t)(s->n + 1)) < -0.98) continue;
    return next;
  }
  return NULL;
}

/* A step that is not too long, neither in the parameter nor in the motion. */
static double limited(const strut_follow_walk *w, const strut_follow_orbit *o, double h) {
  double along = fabs(o->tangent[w->s->n]);
  return fmin(h, fmin(MOST, w->limits->longest / fmax(along, 1e-9)));
}

static const char *walk_on(strut_follow_walk *w, strut_follow_orbit *o, double first) {
  strut_follow_system *s = w->s;
  w->begin = w->branch->count - (w->backwards ? 0 : 1);
  strut_follow_orbit *begin = o;
  double h = first;
  const char *reason = "";
  for (int32_t steps = 0; steps < w->limits->steps; steps++) {
    int rounds = 0;
    strut_follow_orbit *next = try_step(w, o, h, &rounds, &reason);
    if (w->status) return "";
    if (next && retraces(w, o, next)) {
      reason = "no periodic motion was found beyond: the branch leads back";
      next = NULL;
    }
    bool sharp = next && h > CORNER &&
                 strut_dot(o->tangent, next->tangent, (ptrdiff_t)(s->n + 1)) < STRAIGHT;
    if (!next || sharp || (rounds > MANY && h > CORNER)) {
      if (h > LEAST) {
        h = fmax(0.35 * h, LEAST);
        steps--;
        continue;
      }
      next = turn_at_corner(w, o, 10.0 * LEAST, &reason);
      if (w->status || !next || retraces(w, o, next)) return reason;
    }
    if (!straighten(w, o, next)) return "";
    if (outside(s, next->value)) {
      strut_follow_orbit *last = at_edge(w, o, next);
      if (!w->status && !last && h > LEAST) { /* nearer to the edge first */
        h = fmax(0.35 * h, LEAST);
        steps--;
        continue;
      }
      if (!w->status && last) accept_step(w, o, last, STRUT_FOLLOW_END);
      return "the range of the parameter ends";
    }
    if (!accept_step(w, o, next, STRUT_FOLLOW_REGULAR)) return reason;
    if (steps > CLOSED && is_closed(w, begin, next, h)) return "the branch is closed";
    if (w->limits->progress)
      w->limits->progress(w->limits->progress_context, strut_follow_scaled(s, next->value));
    if (rounds <= FEW) h *= 1.5;
    h = limited(w, next, h);
    o = next;
  }
  return "the number of steps is used up";
}

static bool allocate(strut_follow_walk *w) {
  strut_arena *a = &w->branch->arena;
  size_t n = w->s->n;
  bool good = (w->right = strut_arena_allocate(a, n + 1, sizeof(double))) &&
              (w->f = strut_arena_allocate(a, n, sizeof(double))) &&
              (w->try_y = strut_arena_allocate(a, w->s->both, sizeof(double))) &&
              (w->trials = strut_arena_allocate(a, 2 * (w->s->both + n), sizeof(double))) &&
              (w->eigen = strut_arena_allocate(a, (n + 1) * (n + 1), sizeof(double)));
  if (!good) w->status = strut_no_memory(w->error, "");
  return good;
}

/* The points of the way back, which were appended last, go before those of the way forth. */
static void order_points(strut_follow_branch *b, size_t forth) {
  size_t back = b->count - forth;
  strut_follow_point *p = b->points;
  for (size_t i = 0, k = b->count - 1; i < k; i++, k--) {
    strut_follow_point keep = p[i];
    p[i] = p[k], p[k] = keep;
  }
  for (size_t i = back, k = b->count - 1; i < k; i++, k--) {
    strut_follow_point keep = p[i];
    p[i] = p[k], p[k] = keep;
  }
  b->start = back;
  double least = b->count ? p[0].arc : 0.0;
  for (size_t i = 0; i < b->count; i++) p[i].arc -= least;
}

/* The first orbit, with a tangent in which the parameter grows. */
static strut_follow_orbit *first_orbit(strut_follow_walk *w, const double *y) {
  strut_follow_system *s = w->s;
  double *upward = strut_arena_allocate(&w->branch->arena, s->n + 1, sizeof(double));
  strut_follow_orbit *o = strut_follow_orbit_new(w);
  if (!upward && !w->status) w->status = strut_no_memory(w->error, "");
  if (!upward || !o) return NULL;
  upward[s->n] = 1.0;
  memcpy(o->y, y, s->both * sizeof(double));
  o->value = s->value;
  return strut_follow_examine(w, o, upward) ? o : NULL;
}

/*
 * The first orbit of a doubled branch, off y along the direction, behind y itself as the branch's first
 * point. NULL: there is none.
 */
static strut_follow_orbit *doubled_orbit(strut_follow_walk *w, const double *y,
                                         const double *direction, const char **reason) {
  strut_follow_system *s = w->s;
  strut_follow_orbit *base = strut_follow_orbit_new(w), *next = NULL;
  int rounds;
  if (!base) return NULL;
  memcpy(base->y, y, s->both * sizeof(double));
  memcpy(base->tangent, direction, s->n * sizeof(double));
  base->value = s->value;
  if (!strut_follow_measure(w, base)) return NULL;
  for (double off = LEAVE; off > 0.01 * LEAVE && !next && !w->status; off *= 0.3)
    next = try_step(w, base, off, &rounds, reason);
  if (!next || !strut_follow_add(w, base, 0.0, STRUT_FOLLOW_START)) return NULL;
  w->arc = next->distance;
  return next;
}

strut_status strut_follow_branch_make(strut_follow_system *s, const double *y,
                                      const double *direction, const strut_follow_limits *limits,
                                      strut_follow_branch *branch, strut_error *error) {
  double clock = strut_run_clock();
  int64_t evaluations = s->spent.evaluations, maps = s->spent.maps, scenes = s->spent.scenes;
  *branch =
      (strut_follow_branch){.repeats = s->how.repeats, .travels = s->travels, .ends = {"", ""}};
  strut_follow_walk w = {.s = s, .limits = limits, .branch = branch, .error = error};
  double first = fmin(FIRST, limits->longest);
  if (!allocate(&w)) return w.status;
  strut_follow_orbit *o =
      direction ? doubled_orbit(&w, y, direction, &branch->ends[1]) : first_orbit(&w, y);
  strut_follow_kind kind = direction ? STRUT_FOLLOW_REGULAR : STRUT_FOLLOW_START;
  if (o && strut_follow_add(&w, o, w.arc, kind)) {
    branch->ends[1] = walk_on(&w, o, first);
    size_t forth = branch->count;
    w.arc = 0.0;
    w.backwards = true;
    if (!w.status && !direction && strcmp(branch->ends[1], "the branch is closed") != 0) {
      for (size_t i = 0; i <= s->n; i++) o->tangent[i] = -o->tangent[i];
      o->signature.turn = -o->signature.turn;
      branch->ends[0] = walk_on(&w, o, first);
    } else {
      branch->ends[0] = direction ? "the branch begins here" : branch->ends[1];
    }
    if (w.status == STRUT_INTERRUPTED) {
      if (!direction) branch->ends[0] = "interrupted";
      if (!*branch->ends[1]) branch->ends[1] = "interrupted";
    }
    order_points(branch, forth);
  }
  branch->evaluations = s->spent.evaluations - evaluations;
  branch->maps = s->spent.maps - maps;
  branch->scenes = s->spent.scenes - scenes;
  branch->seconds = strut_run_clock() - clock;
  return w.status;
}

void strut_follow_branch_free(strut_follow_branch *branch) {
  strut_arena_free(&branch->arena);
  *branch = (strut_follow_branch){.count = 0};
}

/* Shapes closer than this to each other, in unknowns of order one, are the same. */
static const double SAME = 1e-4, NEAR = 0.3;

/* Largest difference of two states in unknowns. */
static double apart(const strut_follow_system *s, const double *a, const double *b) {
  double most = 0.0;
  for (size_t i = 0; i < s->n; i++)
    most = fmax(most, fabs(a[s->place[i]] - b[s->place[i]]) / strut_follow_unit(s, i));
  return most;
}

strut_status strut_follow_is_on(strut_follow_system *s, const strut_follow_branch *branch,
                                const double *y, bool *on, strut_error *error) {
  double *here = strut_arena_allocate(&s->arena, 2 * s->both, sizeof(double));
  double *mine = here + s->both;
  char reason[200];
  double value = s->value;
  *on = false;
  if (!here) return strut_no_memory(error, "");
  memcpy(mine, y, s->both * sizeof(double));
  strut_follow_centre(s, mine);
  for (size_t i = 0; i + 1 < branch->count && !*on; i++) {
    const strut_follow_point *a = &branch->points[i], *b = a + 1;
    if ((a->value - value) * (b->value - value) > 0.0) continue;
    double part = b->value != a->value ? (value - a->value) / (b->value - a->value) : 0.0;
    for (size_t k = 0; k < s->both; k++) here[k] = a->y[k] + part * (b->y[k] - a->y[k]);
    if (apart(s, here, mine) > NEAR) continue;
    bool found;
    strut_status status = strut_follow_correct(s, here, &found, reason, error);
    if (status) return status;
    if (!found) continue;
    strut_follow_centre(s, here);
    *on = apart(s, here, mine) < SAME;
  }
  return STRUT_OK;
}

/* How many fixed steps of a period a branch takes. */

/*
 * A step turns the fastest vibration by so much [rad] at the usual accuracy, and by its fourth root at others:
 * the crawler's bars, which ring at 3 kHz, then cost 0.03 % of its velocity. Part of the largest stable step.
 */
static const double TURN = 0.8, USUAL_ACCURACY = 1e-3, MOST_TURN = 1.0, STABLE = 0.5;
/* Travel that matters, in amplitudes a period. */
static const double LITTLE_TRAVEL = 0.3;
enum { LEAST_STEPS = 400, MOST_STEPS = 20000, MOST_DOUBLINGS = 3 };

/* Steps of the period at the present value. */
static strut_status steps_here(const strut_follow_system *s, double accuracy, double *steps,
                               strut_error *error) {
  strut_step_limit limit;
  strut_status status = strut_step_limit_estimate(s->model, &limit, error);
  double turn = fmin(TURN * pow(accuracy / USUAL_ACCURACY, 0.25), MOST_TURN);
  if (status) return status;
  double longest = STABLE * limit.of[s->map[0].method->region];
  if (limit.largest_frequency > 0.0) longest = fmin(longest, turn / limit.largest_frequency);
  *steps = fmax(*steps, ceil(s->period / longest));
  return STRUT_OK;
}

strut_status strut_follow_choose_steps(strut_follow_system *s, double accuracy, bool *good,
                                       strut_error *error) {
  const double value = s->value, at[3] = {s->low, s->high, value};
  double steps = LEAST_STEPS;
  for (int k = 0; k < 3; k++) {
    strut_status status = strut_follow_set_value(s, at[k], error);
    if (!status) status = steps_here(s, accuracy, &steps, error);
    if (status) return status;
  }
  *good = steps <= MOST_STEPS;
  return *good ? strut_follow_set_steps(s, (int64_t)steps, error) : STRUT_OK;
}

/* What a branch tells of the motion y: velocity [m/s] and amplitude over a period [m/s]. */
static bool tell_motion(strut_follow_system *s, const double *y, double *velocity, double *swing) {
  double *end = strut_arena_allocate(&s->arena, s->both, sizeof *end);
  if (!end) return false;
  memcpy(end, y, s->both * sizeof *end);
  strut_follow_period p = strut_follow_apply(s, end, true);
  *velocity = p.travel / (s->period * s->how.repeats);
  *swing = p.amplitude / s->period;
  return isfinite(p.travel);
}

strut_status strut_follow_check_steps(strut_follow_system *s, double *y, double accuracy,
                                      strut_error *error) {
  double *fine = strut_arena_allocate(&s->arena, s->both, sizeof *fine);
  double u[2] = {0}, swing[2] = {0};
  char reason[200];
  if (!fine) return strut_no_memory(error, "");
  for (int k = 0; k < MOST_DOUBLINGS; k++) {
    int64_t steps = s->how.steps_per_period;
    bool found = tell_motion(s, y, &u[0], &swing[0]);
    memcpy(fine, y, s->both * sizeof *fine);
    strut_status status = strut_follow_set_steps(s, 2 * steps, error);
    if (!status && found) status = strut_follow_correct(s, fine, &found, reason, error);
    found = found && !status && tell_motion(s, fine, &u[1], &swing[1]);
    double travel = s->travels ? fmax(fabs(u[0]), LITTLE_TRAVEL * swing[0]) : HUGE_VAL;
    bool near = found && fabs(u[1] - u[0]) <= accuracy * travel &&
                (s->travels || fabs(swing[1] - swing[0]) <= accuracy * swing[0]);
    if (!status && (near || !found)) return strut_follow_set_steps(s, steps, error);
    if (status) return status;
    memcpy(y, fine, s->both * sizeof *y);
  }
  return STRUT_OK;
}
