/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The walk along a branch: prediction, correction, step control, ends. */
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/run/follow/follow_parts.h"

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
      STRUT_FOLLOW_TABLE(STRUT_FOLLOW_WORD)};
  return words[kind];
}

strut_follow_point *strut_follow_add(strut_follow_walk *walk, const strut_follow_orbit *orbit,
                                     double arc, strut_follow_kind kind) {
  strut_follow_branch *branch = walk->branch;
  strut_follow_system *system = walk->s;
  if (branch->count == branch->room) {
    size_t room = branch->room ? 2 * branch->room : 256;
    strut_follow_point *points =
        strut_follow_allocate(system, &branch->arena, room, sizeof *points);
    if (!points) return NULL;
    if (branch->count) memcpy(points, branch->points, branch->count * sizeof *points);
    branch->points = points;
    branch->room = room;
  }
  strut_follow_point *point = &branch->points[branch->count];
  *point = (strut_follow_point){.kind = kind,
                                .at = orbit->at,
                                .arc = walk->backwards ? -arc : arc,
                                .velocity = orbit->velocity,
                                .work = orbit->work,
                                .amplitude = orbit->amplitude,
                                .multiplier = {(double)NAN, (double)NAN}};
  const strut_follow_signature g = orbit->signature;
  point->stable = orbit->complete && g.plus == 0 && g.minus == 0 && g.pairs == 0;
  if (orbit->complete && orbit->multipliers)
    memcpy(point->multiplier, orbit->multiplier[0], sizeof point->multiplier);
  point->word = strut_follow_word_text(system, &orbit->word, &branch->arena);
  if (!point->word) system->status = strut_no_memory(system->error, "");
  if (!point->word) return NULL;
  branch->count++;
  return point;
}

static double cosine(const strut_follow_walk *walk, const double *first, const double *second) {
  return strut_dot(first, second, (ptrdiff_t)walk->s->m);
}

/*
 * A guess of the orbit one step h from o, along the parabola through o and the orbit before, whose tangents
 * turn by little; along the tangent of o otherwise.
 */
static void predict(const strut_follow_walk *walk, const strut_follow_orbit *orbit, double h,
                    strut_follow_orbit *next) {
  const strut_follow_orbit *before = orbit->before;
  const double *tangent = orbit->tangent[0];
  double bend = 0.0, *way = walk->s->buffers.x;
  if (before && before->complete && h <= REACH * orbit->distance &&
      cosine(walk, before->tangent[0], tangent) > SMOOTH)
    bend = 0.5 * h * h / orbit->distance;
  for (size_t i = 0; i < walk->s->m; i++) {
    way[i] = h * tangent[i];
    if (bend > 0.0) way[i] += bend * (tangent[i] - before->tangent[0][i]);
  }
  strut_follow_move(walk->s, &next->at, way, 1.0);
  next->distance = h;
}

/* The orbit one step h from o, complete; NULL: none, and `reason` says why. */
static strut_follow_orbit *try_step(strut_follow_walk *walk, const strut_follow_orbit *orbit,
                                    double h, int *rounds, const char **reason) {
  strut_arena *arena = &walk->branch->arena;
  strut_follow_orbit *next = strut_follow_orbit_new(walk->s, arena, &orbit->at);
  if (!next) return NULL;
  predict(walk, orbit, h, next);
  next->before = orbit;
  if (!strut_follow_newton(walk->s, &(strut_follow_planes){&orbit->at, {orbit->tangent[0]}, {h}},
                           &next->at, rounds)) {
    *reason = "no periodic motion was found beyond: Newton's method does not converge";
    return NULL;
  }
  if (!strut_follow_examine(walk->s, arena, next, orbit->tangent[0])) {
    *reason = "the motion was lost beyond";
    return NULL;
  }
  return next;
}

/*
 * Behind a corner the derivative may be that of neither side, and its tangent lead back: then the way
 * come from a to b leads on.
 */
static void straighten(const strut_follow_walk *walk, const strut_follow_orbit *first,
                       strut_follow_orbit *second) {
  double *secant = walk->s->buffers.x;
  double length = strut_follow_between(walk->s, &first->at, &second->at, secant);
  for (size_t i = 0; i < walk->s->m && length > 0.0; i++) secant[i] /= length;
  if (cosine(walk, secant, second->tangent[0]) >= STRAIGHT) return;
  memcpy(second->tangent[0], secant, walk->s->m * sizeof(double));
  second->signature.turn = secant[walk->s->n] < 0.0 ? -1 : 1;
}

/* Does b lie on the way behind a, on which the latest points are? */
static bool retraces(const strut_follow_walk *walk, const strut_follow_orbit *first,
                     const strut_follow_orbit *second) {
  const strut_follow_system *system = walk->s;
  const strut_follow_branch *branch = walk->branch;
  size_t from = branch->count > LATEST ? branch->count - LATEST : 0;
  if (from < walk->begin) from = walk->begin;
  double d[STRUT_FOLLOW_MOST + 2], e[STRUT_FOLLOW_MOST + 2], least = HUGE_VAL;
  double step = strut_follow_between(system, &first->at, &second->at, d);
  for (size_t k = from; k + 1 < branch->count; k++) {
    const strut_follow_point *point = &branch->points[k];
    double whole = strut_follow_between(system, &point->at, &point[1].at, d);
    double off = strut_follow_between(system, &point->at, &second->at, e);
    double along = cosine(walk, d, e), part = whole > 0.0 ? along / (whole * whole) : 0.0;
    if (part >= 0.0 && part <= 1.0) least = fmin(least, off * off - part * along);
  }
  return least < BACK * BACK * step * step;
}

static bool outside(const strut_follow_system *system, double value) {
  double part = strut_follow_scaled(system, 0, value);
  return part < -1e-9 || part > 1.0 + 1e-9;
}

/* The orbit at the edge of the range that lies between o and next. */
static strut_follow_orbit *at_edge(strut_follow_walk *walk, const strut_follow_orbit *orbit,
                                   const strut_follow_orbit *next) {
  strut_follow_system *system = walk->s;
  const double value = orbit->at.value[0], beyond = next->at.value[0];
  double edge = strut_follow_scaled(system, 0, beyond) > 0.5 ? system->high[0] : system->low[0];
  double part = (edge - value) / (beyond - value);
  int rounds;
  strut_follow_orbit *last = strut_follow_orbit_new(system, &walk->branch->arena, &orbit->at);
  if (!last || !(part > 1e-6)) return NULL; /* o is there already */
  for (size_t i = 0; i < system->both; i++)
    last->at.y[i] += part * (next->at.y[i] - orbit->at.y[i]);
  last->at.value[0] = edge;
  if (!strut_follow_newton(system, &(strut_follow_planes){&last->at, {system->upward}, {0.0}},
                           &last->at, &rounds) ||
      !strut_follow_examine(system, &walk->branch->arena, last, orbit->tangent[0]))
    return NULL;
  last->at.value[0] = edge;
  strut_follow_between(system, &orbit->at, &last->at, system->buffers.x);
  last->distance = cosine(walk, orbit->tangent[0], system->buffers.x);
  return last;
}

/* Accepts the step from o to next: special points, then the point itself. */
static bool accept_step(strut_follow_walk *walk, const strut_follow_orbit *orbit,
                        const strut_follow_orbit *next, strut_follow_kind kind) {
  if (!strut_follow_locate(walk, orbit, next)) return false;
  walk->arc += next->distance;
  return strut_follow_add(walk, next, walk->arc, kind) != NULL;
}

bool strut_follow_is_closed(const strut_follow_walk *walk, const strut_follow_orbit *begin,
                            const strut_follow_orbit *orbit, double step) {
  return strut_follow_between(walk->s, &begin->at, &orbit->at, walk->s->buffers.x) < 0.6 * step;
}

/* Beyond a corner the branch may lead backwards: looks along the tangent that holds there. */
static strut_follow_orbit *turn_at_corner(strut_follow_walk *walk, strut_follow_orbit *orbit,
                                          double h, const char **reason) {
  strut_follow_system *system = walk->s;
  strut_arena *arena = &walk->branch->arena;
  strut_follow_orbit *beyond = strut_follow_orbit_new(system, arena, &orbit->at);
  if (!beyond) return NULL;
  strut_follow_move(system, &beyond->at, orbit->tangent[0], h);
  if (outside(system, beyond->at.value[0]) ||
      !strut_follow_complete(system, beyond, orbit->tangent[0]))
    return NULL;
  for (int side = 1; side >= -1; side -= 2) {
    strut_follow_orbit from = *orbit;
    double *tangent = strut_follow_allocate(system, arena, system->m, sizeof *tangent);
    int rounds;
    if (!tangent) return NULL;
    for (size_t i = 0; i < system->m; i++) tangent[i] = side * beyond->tangent[0][i];
    from.tangent[0] = tangent;
    if (cosine(walk, tangent, orbit->tangent[0]) < -0.98) continue;
    strut_follow_orbit *next = try_step(walk, &from, 4.0 * h, &rounds, reason);
    if (system->status) return NULL;
    if (next && cosine(walk, next->tangent[0], orbit->tangent[0]) >= -0.98) return next;
  }
  return NULL;
}

static const char *walk_on(strut_follow_walk *walk, strut_follow_orbit *orbit, double first) {
  strut_follow_system *system = walk->s;
  walk->begin = walk->branch->count - (walk->backwards ? 0 : 1);
  strut_follow_orbit *begin = orbit;
  double h = first;
  const char *reason = "";
  for (int32_t steps = 0; steps < walk->limits->steps; steps++) {
    int rounds = 0;
    strut_follow_orbit *next = try_step(walk, orbit, h, &rounds, &reason);
    if (system->status) return "";
    if (next && retraces(walk, orbit, next)) {
      reason = "no periodic motion was found beyond: the branch leads back";
      next = NULL;
    }
    bool sharp = next && h > CORNER && cosine(walk, orbit->tangent[0], next->tangent[0]) < STRAIGHT;
    if (!next || sharp || (rounds > MANY && h > CORNER)) {
      if (h > LEAST) {
        h = fmax(0.35 * h, LEAST);
        steps--;
        continue;
      }
      next = turn_at_corner(walk, orbit, 10.0 * LEAST, &reason);
      if (system->status || !next || retraces(walk, orbit, next)) return reason;
    }
    straighten(walk, orbit, next);
    if (outside(system, next->at.value[0])) {
      strut_follow_orbit *last = at_edge(walk, orbit, next);
      if (!system->status && !last && h > LEAST) { /* nearer to the edge first */
        h = fmax(0.35 * h, LEAST);
        steps--;
        continue;
      }
      if (!system->status && last) accept_step(walk, orbit, last, STRUT_FOLLOW_END);
      return "the range of the parameter ends";
    }
    if (!accept_step(walk, orbit, next, STRUT_FOLLOW_REGULAR)) return reason;
    if (steps > CLOSED && strut_follow_is_closed(walk, begin, next, h) &&
        cosine(walk, next->tangent[0], begin->tangent[0]) > 0.8)
      return "the branch is closed";
    if (walk->limits->progress)
      walk->limits->progress(walk->limits->progress_context,
                             strut_follow_scaled(system, 0, next->at.value[0]));
    if (rounds <= FEW) h *= 1.5;
    double along = fabs(next->tangent[0][system->n]); /* not too far in parameter and motion */
    h = fmin(h, fmin(MOST, walk->limits->longest / fmax(along, 1e-9)));
    orbit = next;
  }
  return "the number of steps is used up";
}

static void reverse(strut_follow_point *points, size_t count) {
  for (size_t i = 0; 2 * i + 1 < count; i++) {
    strut_follow_point keep = points[i];
    points[i] = points[count - 1 - i], points[count - 1 - i] = keep;
  }
}

void strut_follow_order(strut_follow_branch *branch, size_t forth) {
  size_t back = branch->count - forth;
  reverse(branch->points, branch->count);
  reverse(branch->points + back, forth);
  branch->start = back;
  double least = branch->count ? branch->points[0].arc : 0.0;
  for (size_t i = 0; i < branch->count; i++) branch->points[i].arc -= least;
}

/*
 * The first orbit of a doubled branch, off y along the direction, behind y itself as the branch's first
 * point. NULL: there is none.
 */
static strut_follow_orbit *doubled_orbit(strut_follow_walk *walk, strut_follow_orbit *base,
                                         const double *direction, const char **reason) {
  strut_follow_system *system = walk->s;
  strut_follow_orbit *next = NULL;
  int rounds;
  memcpy(base->tangent[0], direction, system->n * sizeof(double));
  if (!strut_follow_measure(system, &walk->branch->arena, base)) return NULL;
  for (double off = LEAVE; off > 0.01 * LEAVE && !next && !system->status; off *= 0.3)
    next = try_step(walk, base, off, &rounds, reason);
  if (!next || !strut_follow_add(walk, base, 0.0, STRUT_FOLLOW_START)) return NULL;
  walk->arc = next->distance;
  return next;
}

strut_status strut_follow_branch_make(strut_follow_system *system, const double *unknowns,
                                      const double *direction, const strut_follow_limits *limits,
                                      strut_follow_branch *branch) {
  *branch = (strut_follow_branch){
      .repeats = system->how.repeats, .travels = system->travels, .ends = {"", ""}};
  strut_follow_walk w = {.s = system, .limits = limits, .branch = branch};
  double first = fmin(FIRST, limits->longest);
  strut_follow_orbit *orbit = strut_follow_orbit_new(system, &branch->arena, NULL);
  if (orbit) memcpy(orbit->at.y, unknowns, system->both * sizeof(double));
  if (orbit && direction)
    orbit = doubled_orbit(&w, orbit, direction, &branch->ends[1]);
  else if (orbit && !strut_follow_examine(system, &branch->arena, orbit, system->upward))
    orbit = NULL;
  strut_follow_kind kind = direction ? STRUT_FOLLOW_REGULAR : STRUT_FOLLOW_START;
  if (!orbit || !strut_follow_add(&w, orbit, w.arc, kind)) return system->status;
  branch->ends[1] = walk_on(&w, orbit, first);
  size_t forth = branch->count;
  w.arc = 0.0;
  w.backwards = true;
  if (!system->status && !direction && strcmp(branch->ends[1], "the branch is closed") != 0) {
    for (size_t i = 0; i < system->m; i++) orbit->tangent[0][i] = -orbit->tangent[0][i];
    orbit->signature.turn = -orbit->signature.turn;
    branch->ends[0] = walk_on(&w, orbit, first);
  } else {
    branch->ends[0] = direction ? "the branch begins here" : branch->ends[1];
  }
  if (system->status == STRUT_INTERRUPTED) {
    if (!direction) branch->ends[0] = "interrupted";
    if (!*branch->ends[1]) branch->ends[1] = "interrupted";
  }
  strut_follow_order(branch, forth);
  return system->status;
}

void strut_follow_branch_free(strut_follow_branch *branch) {
  strut_arena_free(&branch->arena);
  *branch = (strut_follow_branch){.count = 0};
}

/* Shapes closer than this to each other, in unknowns of order one, are the same. */
static const double SAME = 1e-4, NEAR = 0.3;

bool strut_follow_is_on(strut_follow_system *system, const strut_follow_branch *branch,
                        const double *unknowns) {
  double *here = strut_follow_allocate(system, &system->arena, 2 * system->both, sizeof *here);
  double *f = system->buffers.f, value = system->value[0];
  char reason[200];
  if (!here) return false;
  double *mine = here + system->both;
  memcpy(mine, unknowns, system->both * sizeof(double));
  strut_follow_centre(system, mine);
  for (size_t i = 0; i + 1 < branch->count && !system->status; i++) {
    const strut_follow_motion *a = &branch->points[i].at, *b = &branch->points[i + 1].at;
    if ((a->value[0] - value) * (b->value[0] - value) > 0.0) continue;
    double part =
        b->value[0] != a->value[0] ? (value - a->value[0]) / (b->value[0] - a->value[0]) : 0.0;
    for (size_t k = 0; k < system->both; k++) here[k] = a->y[k] + part * (b->y[k] - a->y[k]);
    if (strut_follow_change(system, mine, here, f) > NEAR ||
        !strut_follow_correct(system, here, reason))
      continue;
    strut_follow_centre(system, here);
    if (strut_follow_change(system, mine, here, f) < SAME) return true;
  }
  return false;
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

bool strut_follow_choose_steps(strut_follow_system *system, double accuracy) {
  const double own = system->value[0], other = system->value[1];
  const double at[3][2] = {{system->low[0], other}, {system->high[0], other}, {own, other}};
  double steps = LEAST_STEPS;
  double turn = fmin(TURN * pow(accuracy / USUAL_ACCURACY, 0.25), MOST_TURN);
  for (int k = 0; k < 3; k++) {
    strut_step_limit limit;
    if (!strut_follow_set_value(system, at[k])) return false;
    system->status = strut_step_limit_estimate(system->model, &limit, system->error);
    if (system->status) return false;
    double longest = STABLE * limit.of[system->map[0].method->region];
    if (limit.largest_frequency > 0.0) longest = fmin(longest, turn / limit.largest_frequency);
    steps = fmax(steps, ceil(system->period / longest));
  }
  return steps <= MOST_STEPS &&
         strut_follow_set_periods(system, system->how.repeats, (int64_t)steps);
}

/* What a branch tells of the motion y: velocity [m/s] and amplitude over a period [m/s]. */
static bool tell_motion(strut_follow_system *system, const double *unknowns, double *velocity,
                        double *swing) {
  double *end = system->buffers.end;
  memcpy(end, unknowns, system->both * sizeof *end);
  strut_follow_period p = strut_follow_apply(system, end, true);
  *velocity = p.travel / (system->period * system->how.repeats);
  *swing = p.amplitude / system->period;
  return isfinite(p.travel);
}

void strut_follow_check_steps(strut_follow_system *system, double *unknowns, double accuracy) {
  double *fine = strut_follow_allocate(system, &system->arena, system->both, sizeof *fine);
  double u[2] = {0}, swing[2] = {0};
  char reason[200];
  for (int k = 0; k < MOST_DOUBLINGS && !system->status; k++) {
    int64_t steps = system->how.steps_per_period;
    bool found = tell_motion(system, unknowns, &u[0], &swing[0]);
    memcpy(fine, unknowns, system->both * sizeof *fine);
    found = strut_follow_set_periods(system, system->how.repeats, 2 * steps) && found &&
            strut_follow_correct(system, fine, reason) &&
            tell_motion(system, fine, &u[1], &swing[1]);
    double travel = system->travels ? fmax(fabs(u[0]), LITTLE_TRAVEL * swing[0]) : HUGE_VAL;
    bool near = found && fabs(u[1] - u[0]) <= accuracy * travel &&
                (system->travels || fabs(swing[1] - swing[0]) <= accuracy * swing[0]);
    if (near || !found) {
      strut_follow_set_periods(system, system->how.repeats, steps);
      return;
    }
    memcpy(unknowns, fine, system->both * sizeof *unknowns);
  }
}
