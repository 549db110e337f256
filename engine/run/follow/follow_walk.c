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

static bool grow(strut_follow_walk *walk) {
  strut_follow_branch *branch = walk->branch;
  if (branch->count < walk->room) return true;
  size_t room = walk->room ? 2 * walk->room : 256;
  strut_follow_point *points = strut_arena_allocate(&branch->arena, room, sizeof *points);
  if (!points) walk->status = strut_no_memory(walk->error, "");
  if (!points) return false;
  if (branch->count) memcpy(points, branch->points, branch->count * sizeof *points);
  branch->points = points;
  walk->room = room;
  return true;
}

strut_follow_point *strut_follow_add(strut_follow_walk *walk, const strut_follow_orbit *orbit,
                                     double arc, strut_follow_kind kind) {
  strut_follow_branch *branch = walk->branch;
  if (!grow(walk)) return NULL;
  strut_follow_point *point = &branch->points[branch->count];
  *point = (strut_follow_point){.kind = kind,
                                .value = orbit->value,
                                .arc = walk->backwards ? -arc : arc,
                                .velocity = orbit->velocity,
                                .work = orbit->work,
                                .amplitude = orbit->amplitude,
                                .multiplier = {(double)NAN, (double)NAN},
                                .y = orbit->y};
  const strut_follow_signature g = orbit->signature;
  point->stable = orbit->complete && g.plus == 0 && g.minus == 0 && g.pairs == 0;
  if (orbit->complete && orbit->multipliers)
    memcpy(point->multiplier, orbit->multiplier[0], sizeof point->multiplier);
  point->word = strut_follow_word_text(walk->s, &orbit->word, &branch->arena);
  if (!point->word) walk->status = strut_no_memory(walk->error, "");
  if (!point->word) return NULL;
  branch->count++;
  return point;
}

/*
 * A guess of the orbit one step h from o, along the parabola through o and the orbit before, whose tangents
 * turn by little; along the tangent of o otherwise.
 */
static void predict(strut_follow_walk *walk, const strut_follow_orbit *orbit, double h,
                    strut_follow_orbit *next) {
  const strut_follow_system *system = walk->s;
  const strut_follow_orbit *follow_orbit = orbit->before;
  double bend = 0.0, *way = walk->right;
  if (follow_orbit && follow_orbit->complete && h <= REACH * orbit->distance &&
      strut_dot(follow_orbit->tangent, orbit->tangent, (ptrdiff_t)(system->n + 1)) > SMOOTH)
    bend = 0.5 * h * h / orbit->distance;
  for (size_t i = 0; i <= system->n; i++) {
    way[i] = h * orbit->tangent[i];
    if (bend > 0.0) way[i] += bend * (orbit->tangent[i] - follow_orbit->tangent[i]);
  }
  memcpy(next->y, orbit->y, system->both * sizeof(double));
  strut_follow_move(system, next->y, way, 1.0);
  next->value = orbit->value + way[system->n] * (system->high - system->low);
  next->distance = h;
}

/* The orbit one step h from o, complete; NULL: none, and `reason` says why. */
static strut_follow_orbit *try_step(strut_follow_walk *walk, const strut_follow_orbit *orbit,
                                    double h, int *rounds, const char **reason) {
  strut_follow_orbit *next = strut_follow_orbit_new(walk);
  if (!next) return NULL;
  predict(walk, orbit, h, next);
  next->before = orbit;
  if (!strut_follow_newton(walk, next->y, &next->value,
                           &(strut_follow_section){orbit->tangent, orbit->y, orbit->value, h},
                           rounds)) {
    *reason = "no periodic motion was found beyond: Newton's method does not converge";
    return NULL;
  }
  if (!strut_follow_examine(walk, next, orbit->tangent)) {
    *reason = "the motion was lost beyond";
    return NULL;
  }
  return next;
}

/* secant (n + 1): unit vector from a to b; returns their distance. */
static double secant_of(const strut_follow_system *system, const strut_follow_orbit *first,
                        const strut_follow_orbit *second, double *secant) {
  size_t n = system->n;
  for (size_t i = 0; i < n; i++)
    secant[i] =
        (second->y[system->place[i]] - first->y[system->place[i]]) / strut_follow_unit(system, i);
  secant[n] = (second->value - first->value) / (system->high - system->low);
  double length = sqrt(strut_dot(secant, secant, (ptrdiff_t)(n + 1)));
  for (size_t i = 0; i <= n && length > 0.0; i++) secant[i] /= length;
  return length;
}

/*
 * Behind a corner the derivative may be that of neither side, and its tangent lead back: then the way
 * come from a to b leads on.
 */
static bool straighten(strut_follow_walk *walk, const strut_follow_orbit *first,
                       strut_follow_orbit *second) {
  size_t n = walk->s->n;
  double *secant = strut_arena_allocate(&walk->branch->arena, n + 1, sizeof(double));
  if (!secant) walk->status = strut_no_memory(walk->error, "");
  if (!secant) return false;
  secant_of(walk->s, first, second, secant);
  if (strut_dot(secant, second->tangent, (ptrdiff_t)(n + 1)) >= STRAIGHT) return true;
  memcpy(second->tangent, secant, (n + 1) * sizeof(double));
  second->signature.turn = secant[n] < 0.0 ? -1 : 1;
  return true;
}

/* Does b lie on the way behind a, on which the latest points are? */
static bool retraces(const strut_follow_walk *walk, const strut_follow_orbit *first,
                     const strut_follow_orbit *second) {
  const strut_follow_system *system = walk->s;
  const strut_follow_branch *branch = walk->branch;
  size_t from = branch->count > LATEST ? branch->count - LATEST : 0;
  if (from < walk->begin) from = walk->begin;
  double step = 0.0, least = HUGE_VAL;
  for (size_t i = 0; i < system->n; i++)
    step += pow(
        (second->y[system->place[i]] - first->y[system->place[i]]) / strut_follow_unit(system, i),
        2);
  step += pow((second->value - first->value) / (system->high - system->low), 2);
  for (size_t k = from; k + 1 < branch->count; k++) {
    const strut_follow_point *point = &branch->points[k], *q = point + 1;
    double whole = 0.0, along = 0.0, off = 0.0;
    for (size_t i = 0; i <= system->n; i++) {
      double unit = i < system->n ? strut_follow_unit(system, i) : system->high - system->low;
      double d = (i < system->n ? q->y[system->place[i]] - point->y[system->place[i]]
                                : q->value - point->value) /
                 unit;
      double e = (i < system->n ? second->y[system->place[i]] - point->y[system->place[i]]
                                : second->value - point->value) /
                 unit;
      whole += d * d, along += d * e, off += e * e;
    }
    double part = whole > 0.0 ? along / whole : 0.0;
    if (part < 0.0 || part > 1.0) continue;
    least = fmin(least, off - part * along);
  }
  return least < BACK * BACK * step;
}

static bool outside(const strut_follow_system *system, double value) {
  double part = strut_follow_scaled(system, value);
  return part < -1e-9 || part > 1.0 + 1e-9;
}

/* The orbit at the edge of the range that lies between o and next. */
static strut_follow_orbit *at_edge(strut_follow_walk *walk, const strut_follow_orbit *orbit,
                                   const strut_follow_orbit *next) {
  strut_follow_system *system = walk->s;
  double edge = strut_follow_scaled(system, next->value) > 0.5 ? system->high : system->low;
  double part = (edge - orbit->value) / (next->value - orbit->value);
  int rounds;
  double *normal = strut_arena_allocate(&walk->branch->arena, system->n + 1, sizeof(double));
  strut_follow_orbit *last = strut_follow_orbit_new(walk);
  if (!normal && !walk->status) walk->status = strut_no_memory(walk->error, "");
  if (!normal || !last) return NULL;
  if (!(part > 1e-6)) return NULL; /* o is there already */
  for (size_t i = 0; i < system->both; i++)
    last->y[i] = orbit->y[i] + part * (next->y[i] - orbit->y[i]);
  last->value = edge;
  normal[system->n] = 1.0;
  if (!strut_follow_newton(walk, last->y, &last->value,
                           &(strut_follow_section){normal, last->y, edge, 0.0}, &rounds) ||
      !strut_follow_examine(walk, last, orbit->tangent))
    return NULL;
  last->value = edge;
  double z =
      (last->value - orbit->value) / (system->high - system->low) * orbit->tangent[system->n];
  for (size_t i = 0; i < system->n; i++)
    z += orbit->tangent[i] * (last->y[system->place[i]] - orbit->y[system->place[i]]) /
         strut_follow_unit(system, i);
  last->distance = z;
  return last;
}

/* Accepts the step from o to next: special points, then the point itself. */
static bool accept_step(strut_follow_walk *walk, const strut_follow_orbit *orbit,
                        const strut_follow_orbit *next, strut_follow_kind kind) {
  if (!strut_follow_locate(walk, orbit, next)) return false;
  walk->arc += next->distance;
  return strut_follow_add(walk, next, walk->arc, kind) != NULL;
}

/* Has the branch come back to where it began? */
static bool is_closed(const strut_follow_walk *walk, const strut_follow_orbit *begin,
                      const strut_follow_orbit *orbit, double h) {
  const strut_follow_system *system = walk->s;
  double off = pow((orbit->value - begin->value) / (system->high - system->low), 2);
  for (size_t i = 0; i < system->n; i++)
    off += pow(
        (orbit->y[system->place[i]] - begin->y[system->place[i]]) / strut_follow_unit(system, i),
        2);
  return sqrt(off) < 0.6 * h &&
         strut_dot(orbit->tangent, begin->tangent, (ptrdiff_t)(system->n + 1)) > 0.8;
}

/* Beyond a corner the branch may lead backwards: looks along the tangent that holds there. */
static strut_follow_orbit *turn_at_corner(strut_follow_walk *walk, strut_follow_orbit *orbit,
                                          double h, const char **reason) {
  strut_follow_system *system = walk->s;
  strut_follow_orbit *beyond = strut_follow_orbit_new(walk);
  if (!beyond) return NULL;
  memcpy(beyond->y, orbit->y, system->both * sizeof(double));
  strut_follow_move(system, beyond->y, orbit->tangent, h);
  beyond->value = orbit->value + h * orbit->tangent[system->n] * (system->high - system->low);
  if (outside(system, beyond->value) || !strut_follow_complete(walk, beyond, orbit->tangent))
    return NULL;
  for (int side = 1; side >= -1; side -= 2) {
    strut_follow_orbit from = *orbit;
    double *tangent = strut_arena_allocate(&walk->branch->arena, system->n + 1, sizeof(double));
    int rounds;
    if (!tangent) walk->status = strut_no_memory(walk->error, "");
    if (!tangent) return NULL;
    for (size_t i = 0; i <= system->n; i++) tangent[i] = side * beyond->tangent[i];
    from.tangent = tangent;
    if (strut_dot(tangent, orbit->tangent, (ptrdiff_t)(system->n + 1)) < -0.98) continue;
    strut_follow_orbit *next = try_step(walk, &from, 4.0 * h, &rounds, reason);
    if (walk->status) return NULL;
    if (!next || strut_dot(next->tangent, orbit->tangent, (ptrdiff_t)(system->n + 1)) < -0.98)
      continue;
    return next;
  }
  return NULL;
}

/* A step that is not too long, neither in the parameter nor in the motion. */
static double limited(const strut_follow_walk *walk, const strut_follow_orbit *orbit, double h) {
  double along = fabs(orbit->tangent[walk->s->n]);
  return fmin(h, fmin(MOST, walk->limits->longest / fmax(along, 1e-9)));
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
    if (walk->status) return "";
    if (next && retraces(walk, orbit, next)) {
      reason = "no periodic motion was found beyond: the branch leads back";
      next = NULL;
    }
    bool sharp = next && h > CORNER &&
                 strut_dot(orbit->tangent, next->tangent, (ptrdiff_t)(system->n + 1)) < STRAIGHT;
    if (!next || sharp || (rounds > MANY && h > CORNER)) {
      if (h > LEAST) {
        h = fmax(0.35 * h, LEAST);
        steps--;
        continue;
      }
      next = turn_at_corner(walk, orbit, 10.0 * LEAST, &reason);
      if (walk->status || !next || retraces(walk, orbit, next)) return reason;
    }
    if (!straighten(walk, orbit, next)) return "";
    if (outside(system, next->value)) {
      strut_follow_orbit *last = at_edge(walk, orbit, next);
      if (!walk->status && !last && h > LEAST) { /* nearer to the edge first */
        h = fmax(0.35 * h, LEAST);
        steps--;
        continue;
      }
      if (!walk->status && last) accept_step(walk, orbit, last, STRUT_FOLLOW_END);
      return "the range of the parameter ends";
    }
    if (!accept_step(walk, orbit, next, STRUT_FOLLOW_REGULAR)) return reason;
    if (steps > CLOSED && is_closed(walk, begin, next, h)) return "the branch is closed";
    if (walk->limits->progress)
      walk->limits->progress(walk->limits->progress_context,
                             strut_follow_scaled(system, next->value));
    if (rounds <= FEW) h *= 1.5;
    h = limited(walk, next, h);
    orbit = next;
  }
  return "the number of steps is used up";
}

static bool allocate(strut_follow_walk *walk) {
  strut_arena *arena = &walk->branch->arena;
  size_t n = walk->s->n;
  bool good =
      (walk->right = strut_arena_allocate(arena, n + 1, sizeof(double))) &&
      (walk->f = strut_arena_allocate(arena, n, sizeof(double))) &&
      (walk->try_y = strut_arena_allocate(arena, walk->s->both, sizeof(double))) &&
      (walk->trials = strut_arena_allocate(arena, 2 * (walk->s->both + n), sizeof(double))) &&
      (walk->eigen = strut_arena_allocate(arena, (n + 1) * (n + 1), sizeof(double)));
  if (!good) walk->status = strut_no_memory(walk->error, "");
  return good;
}

/* The points of the way back, which were appended last, go before those of the way forth. */
static void order_points(strut_follow_branch *branch, size_t forth) {
  size_t back = branch->count - forth;
  strut_follow_point *point = branch->points;
  for (size_t i = 0, k = branch->count - 1; i < k; i++, k--) {
    strut_follow_point keep = point[i];
    point[i] = point[k], point[k] = keep;
  }
  for (size_t i = back, k = branch->count - 1; i < k; i++, k--) {
    strut_follow_point keep = point[i];
    point[i] = point[k], point[k] = keep;
  }
  branch->start = back;
  double least = branch->count ? point[0].arc : 0.0;
  for (size_t i = 0; i < branch->count; i++) point[i].arc -= least;
}

/* The first orbit, with a tangent in which the parameter grows. */
static strut_follow_orbit *first_orbit(strut_follow_walk *walk, const double *unknowns) {
  strut_follow_system *system = walk->s;
  double *upward = strut_arena_allocate(&walk->branch->arena, system->n + 1, sizeof(double));
  strut_follow_orbit *orbit = strut_follow_orbit_new(walk);
  if (!upward && !walk->status) walk->status = strut_no_memory(walk->error, "");
  if (!upward || !orbit) return NULL;
  upward[system->n] = 1.0;
  memcpy(orbit->y, unknowns, system->both * sizeof(double));
  orbit->value = system->value;
  return strut_follow_examine(walk, orbit, upward) ? orbit : NULL;
}

/*
 * The first orbit of a doubled branch, off y along the direction, behind y itself as the branch's first
 * point. NULL: there is none.
 */
static strut_follow_orbit *doubled_orbit(strut_follow_walk *walk, const double *unknowns,
                                         const double *direction, const char **reason) {
  strut_follow_system *system = walk->s;
  strut_follow_orbit *base = strut_follow_orbit_new(walk), *next = NULL;
  int rounds;
  if (!base) return NULL;
  memcpy(base->y, unknowns, system->both * sizeof(double));
  memcpy(base->tangent, direction, system->n * sizeof(double));
  base->value = system->value;
  if (!strut_follow_measure(walk, base)) return NULL;
  for (double off = LEAVE; off > 0.01 * LEAVE && !next && !walk->status; off *= 0.3)
    next = try_step(walk, base, off, &rounds, reason);
  if (!next || !strut_follow_add(walk, base, 0.0, STRUT_FOLLOW_START)) return NULL;
  walk->arc = next->distance;
  return next;
}

strut_status strut_follow_branch_make(strut_follow_system *system, const double *unknowns,
                                      const double *direction, const strut_follow_limits *limits,
                                      strut_follow_branch *branch, strut_error *error) {
  double clock = strut_run_clock();
  int64_t evaluations = system->spent.evaluations, maps = system->spent.maps,
          scenes = system->spent.scenes;
  *branch = (strut_follow_branch){
      .repeats = system->how.repeats, .travels = system->travels, .ends = {"", ""}};
  strut_follow_walk w = {.s = system, .limits = limits, .branch = branch, .error = error};
  double first = fmin(FIRST, limits->longest);
  if (!allocate(&w)) return w.status;
  strut_follow_orbit *orbit = direction ? doubled_orbit(&w, unknowns, direction, &branch->ends[1])
                                        : first_orbit(&w, unknowns);
  strut_follow_kind kind = direction ? STRUT_FOLLOW_REGULAR : STRUT_FOLLOW_START;
  if (orbit && strut_follow_add(&w, orbit, w.arc, kind)) {
    branch->ends[1] = walk_on(&w, orbit, first);
    size_t forth = branch->count;
    w.arc = 0.0;
    w.backwards = true;
    if (!w.status && !direction && strcmp(branch->ends[1], "the branch is closed") != 0) {
      for (size_t i = 0; i <= system->n; i++) orbit->tangent[i] = -orbit->tangent[i];
      orbit->signature.turn = -orbit->signature.turn;
      branch->ends[0] = walk_on(&w, orbit, first);
    } else {
      branch->ends[0] = direction ? "the branch begins here" : branch->ends[1];
    }
    if (w.status == STRUT_INTERRUPTED) {
      if (!direction) branch->ends[0] = "interrupted";
      if (!*branch->ends[1]) branch->ends[1] = "interrupted";
    }
    order_points(branch, forth);
  }
  branch->evaluations = system->spent.evaluations - evaluations;
  branch->maps = system->spent.maps - maps;
  branch->scenes = system->spent.scenes - scenes;
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
static double apart(const strut_follow_system *system, const double *first, const double *second) {
  double most = 0.0;
  for (size_t i = 0; i < system->n; i++)
    most = fmax(most, fabs(first[system->place[i]] - second[system->place[i]]) /
                          strut_follow_unit(system, i));
  return most;
}

strut_status strut_follow_is_on(strut_follow_system *system, const strut_follow_branch *branch,
                                const double *unknowns, bool *on, strut_error *error) {
  double *here = strut_arena_allocate(&system->arena, 2 * system->both, sizeof(double));
  double *mine = here + system->both;
  char reason[200];
  double value = system->value;
  *on = false;
  if (!here) return strut_no_memory(error, "");
  memcpy(mine, unknowns, system->both * sizeof(double));
  strut_follow_centre(system, mine);
  for (size_t i = 0; i + 1 < branch->count && !*on; i++) {
    const strut_follow_point *point = &branch->points[i], *b = point + 1;
    if ((point->value - value) * (b->value - value) > 0.0) continue;
    double part =
        b->value != point->value ? (value - point->value) / (b->value - point->value) : 0.0;
    for (size_t k = 0; k < system->both; k++)
      here[k] = point->y[k] + part * (b->y[k] - point->y[k]);
    if (apart(system, here, mine) > NEAR) continue;
    bool found;
    strut_status status = strut_follow_correct(system, here, &found, reason, error);
    if (status) return status;
    if (!found) continue;
    strut_follow_centre(system, here);
    *on = apart(system, here, mine) < SAME;
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
static strut_status steps_here(const strut_follow_system *system, double accuracy, double *steps,
                               strut_error *error) {
  strut_step_limit limit;
  strut_status status = strut_step_limit_estimate(system->model, &limit, error);
  double turn = fmin(TURN * pow(accuracy / USUAL_ACCURACY, 0.25), MOST_TURN);
  if (status) return status;
  double longest = STABLE * limit.of[system->map[0].method->region];
  if (limit.largest_frequency > 0.0) longest = fmin(longest, turn / limit.largest_frequency);
  *steps = fmax(*steps, ceil(system->period / longest));
  return STRUT_OK;
}

strut_status strut_follow_choose_steps(strut_follow_system *system, double accuracy, bool *good,
                                       strut_error *error) {
  const double value = system->value, at[3] = {system->low, system->high, value};
  double steps = LEAST_STEPS;
  for (int k = 0; k < 3; k++) {
    strut_status status = strut_follow_set_value(system, at[k], error);
    if (!status) status = steps_here(system, accuracy, &steps, error);
    if (status) return status;
  }
  *good = steps <= MOST_STEPS;
  return *good ? strut_follow_set_steps(system, (int64_t)steps, error) : STRUT_OK;
}

/* What a branch tells of the motion y: velocity [m/s] and amplitude over a period [m/s]. */
static bool tell_motion(strut_follow_system *system, const double *unknowns, double *velocity,
                        double *swing) {
  double *end = strut_arena_allocate(&system->arena, system->both, sizeof *end);
  if (!end) return false;
  memcpy(end, unknowns, system->both * sizeof *end);
  strut_follow_period p = strut_follow_apply(system, end, true);
  *velocity = p.travel / (system->period * system->how.repeats);
  *swing = p.amplitude / system->period;
  return isfinite(p.travel);
}

strut_status strut_follow_check_steps(strut_follow_system *system, double *unknowns,
                                      double accuracy, strut_error *error) {
  double *fine = strut_arena_allocate(&system->arena, system->both, sizeof *fine);
  double u[2] = {0}, swing[2] = {0};
  char reason[200];
  if (!fine) return strut_no_memory(error, "");
  for (int k = 0; k < MOST_DOUBLINGS; k++) {
    int64_t steps = system->how.steps_per_period;
    bool found = tell_motion(system, unknowns, &u[0], &swing[0]);
    memcpy(fine, unknowns, system->both * sizeof *fine);
    strut_status status = strut_follow_set_steps(system, 2 * steps, error);
    if (!status && found) status = strut_follow_correct(system, fine, &found, reason, error);
    found = found && !status && tell_motion(system, fine, &u[1], &swing[1]);
    double travel = system->travels ? fmax(fabs(u[0]), LITTLE_TRAVEL * swing[0]) : HUGE_VAL;
    bool near = found && fabs(u[1] - u[0]) <= accuracy * travel &&
                (system->travels || fabs(swing[1] - swing[0]) <= accuracy * swing[0]);
    if (!status && (near || !found)) return strut_follow_set_steps(system, steps, error);
    if (status) return status;
    memcpy(unknowns, fine, system->both * sizeof *unknowns);
  }
  return STRUT_OK;
}
