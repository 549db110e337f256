/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The optimisers of NLopt. The only file that uses it. */
#include <math.h>
#include <nlopt.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/study/search/optimisers.h"

/* Movements below this end a search, in widths of the box. */
static const double FINEST = 1e-7;
/* First steps of a local method: from any start, and from the best point of a global one. */
static const double FIRST_STEP = 0.2, REFINED_STEP = 0.1;
/* Shares of the evaluations of crs2 for evenly spread points, and of the rest for controlled random search. */
static const double SPREAD_SHARE = 0.4, GLOBAL_SHARE = 0.5;
/*
 * multistart: share of the evaluations for evenly spread points; share of the rest for descents from the best
 * of them, which lie further apart than APART, in widths of the box; first step of the descent that continues
 * from the best point with what is left.
 */
static const double MULTISTART_SPREAD = 0.3, DESCENT_SHARE = 0.5, APART = 0.2, LAST_STEP = 0.05;
enum { DESCENTS = 2 };

/* CRS2 looks at the same point for ever once all of its population are there. */
enum { MOST_STUCK = 1000 };

/* A search in progress. NLopt 2.7.1 may return a point that is not the best, so this one remembers it. */
typedef struct nlopt_search {
  const strut_search_task *task;
  const strut_search_asker *asker;
  nlopt_opt opt;
  int64_t asked, most; /* by this method */
  int64_t stuck;       /* how often in a row it has asked for the same point */
  bool ended;          /* the asker wants no more */
  double *best, least; /* (dimension) and its value */
  double *last, value; /* the latest point and its value, for the conditions */
  double *broken;      /* (conditions) there */
  double *spread,
      *spread_values; /* (spread_count, dimension) evenly spread points; (spread_count) */
  size_t spread_count;
} nlopt_search;

static const struct method_row {
  nlopt_algorithm algorithm;
  bool global, conditions;
} rows[STRUT_SEARCH_METHOD_COUNT] = {
    [STRUT_SEARCH_CRS2] = {NLOPT_GN_CRS2_LM, true, false},
    [STRUT_SEARCH_DIRECT] = {NLOPT_GN_DIRECT_L, true, false},
    [STRUT_SEARCH_ISRES] = {NLOPT_GN_ISRES, true, true},
    [STRUT_SEARCH_COBYLA] = {NLOPT_LN_COBYLA, false, true},
    [STRUT_SEARCH_BOBYQA] = {NLOPT_LN_BOBYQA, false, false},
    [STRUT_SEARCH_SBPLX] = {NLOPT_LN_SBPLX, false, false},
    [STRUT_SEARCH_NELDERMEAD] = {NLOPT_LN_NELDERMEAD, false, false},
    [STRUT_SEARCH_MULTISTART] = {NLOPT_LN_SBPLX, false, false},
};

bool strut_search_knows_conditions(strut_search_method method) {
  return rows[method].conditions; /* of others: no */
}

/* Asks for a point, unless it is the latest one. */
static double look_at(nlopt_search *s, const double *point) {
  size_t n = s->task->dimension;
  if (s->asked > 0 && memcmp(point, s->last, n * sizeof *point) == 0) {
    if (++s->stuck > MOST_STUCK && s->opt) nlopt_force_stop(s->opt);
    return s->value;
  }
  s->stuck = 0;
  if (s->ended || s->asked >= s->most) {
    if (s->opt) nlopt_force_stop(s->opt);
    return s->value;
  }
  double value = s->value;
  if (!s->asker->ask(s->asker->context, 1, point, &value, s->broken)) {
    s->ended = true;
    if (s->opt) nlopt_force_stop(s->opt);
    return s->value;
  }
  s->asked++;
  memcpy(s->last, point, n * sizeof *point);
  s->value = value;
  double excess = 0.0;
  for (size_t i = 0; i < s->task->conditions; i++) excess = fmax(excess, s->broken[i]);
  if (excess <= 0.0 && value < s->least) {
    s->least = value;
    memcpy(s->best, point, n * sizeof *point);
  }
  return value;
}

static double objective(unsigned n, const double *point, double *gradient, void *context) {
  (void)n, (void)gradient;
  return look_at(context, point);
}

static void conditions(unsigned m, double *result, unsigned n, const double *point,
                       double *gradient, void *context) {
  nlopt_search *s = context;
  (void)n, (void)gradient;
  look_at(s, point);
  memcpy(result, s->broken, m * sizeof *result);
}

/* Bounds: what wraps may go on beyond them, where a method walks from a point. */
static bool set_bounds(nlopt_search *s, bool global) {
  size_t n = s->task->dimension;
  double *bound = strut_allocate(2 * n, sizeof *bound);
  if (!bound) return false;
  for (size_t i = 0; i < n; i++) {
    bool beyond = s->task->wraps[i] && !global;
    bound[i] = beyond ? s->best[i] - 1.0 : 0.0;
    bound[n + i] = beyond ? s->best[i] + 1.0 : 1.0;
  }
  bool fine =
      nlopt_set_lower_bounds(s->opt, bound) >= 0 && nlopt_set_upper_bounds(s->opt, bound + n) >= 0;
  strut_release(bound);
  return fine;
}

/* The population of a global method: the usual one, or less where evaluations are few. */
static unsigned population(const nlopt_search *s, strut_search_method method) {
  double n = (double)s->task->dimension, few = floor((double)s->most / 3.0);
  double usual = method == STRUT_SEARCH_CRS2 ? 10.0 * (n + 1.0) : 20.0 * (n + 1.0);
  return (unsigned)fmax(n + 3.0, fmin(usual, few));
}

/* Runs one method from s->best. False: no memory. */
static bool run(nlopt_search *s, strut_search_method method, double first_step, int64_t most) {
  const struct method_row *row = &rows[method];
  size_t n = s->task->dimension, m = s->task->conditions;
  double value;
  s->opt = nlopt_create(row->algorithm, (unsigned)n);
  double *point = strut_allocate(n, sizeof *point);
  bool fine = s->opt && point && set_bounds(s, row->global);
  s->asked = s->stuck = 0;
  s->most = most;
  if (fine) {
    memcpy(point, s->best, n * sizeof *point);
    nlopt_set_min_objective(s->opt, objective, s);
    if (m) {
      double *tolerance = strut_allocate(m, sizeof *tolerance);
      fine = tolerance &&
             nlopt_add_inequality_mconstraint(s->opt, (unsigned)m, conditions, s, tolerance) >= 0;
      strut_release(tolerance);
    }
    nlopt_set_xtol_abs1(s->opt, FINEST);
    if (!row->global) nlopt_set_initial_step1(s->opt, first_step);
    if (method == STRUT_SEARCH_CRS2 || method == STRUT_SEARCH_ISRES)
      nlopt_set_population(s->opt, population(s, method));
  }
  if (fine) {
    nlopt_srand(s->task->seed); /* of this thread */
    fine = nlopt_optimize(s->opt, point, &value) != NLOPT_OUT_OF_MEMORY;
  }
  if (s->opt) nlopt_destroy(s->opt);
  s->opt = NULL;
  strut_release(point);
  return fine;
}

/*
 * Asks at once for the start and for points spread evenly over the box, together a share of the evaluations, and
 * keeps them in s->spread. Controlled random search alone, which begins at random, misses a narrow basin more often.
 */
static bool spread_points(nlopt_search *s, double share) {
  size_t n = s->task->dimension;
  const strut_search_spread sequence = strut_search_spread_begin(n, s->task->seed);
  double usual = 20.0 * ((double)n + 1.0);
  int64_t count = (int64_t)fmax(fmin(usual, floor(share * (double)s->task->evaluations)), 1.0);
  s->spread = strut_allocate((size_t)count * n, sizeof *s->spread);
  s->spread_values = strut_allocate((size_t)count, sizeof *s->spread_values);
  if (!s->spread || !s->spread_values) return false;
  for (int64_t k = 0; k < count; k++)
    for (size_t i = 0; i < n; i++)
      s->spread[(size_t)k * n + i] =
          k == 0 ? s->task->start[i] : strut_search_spread_at(&sequence, k, i);
  s->spread_count = (size_t)count;
  s->asked = count;
  s->ended = !s->asker->ask(s->asker->context, s->spread_count, s->spread, s->spread_values, NULL);
  for (size_t k = 0; k < s->spread_count && !s->ended; k++) {
    if (s->spread_values[k] >= s->least) continue;
    s->least = s->spread_values[k];
    memcpy(s->best, s->spread + k * n, n * sizeof *s->best);
  }
  return true;
}

/* Is the point within APART of another one, in every number? */
static bool is_near(const nlopt_search *s, const double *point, const double *other) {
  double largest = 0.0;
  for (size_t i = 0; i < s->task->dimension; i++) {
    double apart = fabs(point[i] - other[i]);
    if (s->task->wraps[i]) apart = fmin(apart, 1.0 - apart);
    largest = fmax(largest, apart);
  }
  return largest <= APART;
}

/* The best of the spread points that is near to none of `others`; NULL: there is none. */
static const double *best_apart(const nlopt_search *s, const double *const *others, size_t count) {
  size_t n = s->task->dimension;
  size_t best = s->spread_count;
  for (size_t k = 0; k < s->spread_count; k++) {
    bool near = false;
    for (size_t i = 0; i < count && !near; i++) near = is_near(s, s->spread + k * n, others[i]);
    if (!near && (best == s->spread_count || s->spread_values[k] < s->spread_values[best]))
      best = k;
  }
  return best < s->spread_count ? s->spread + best * n : NULL;
}

/* A descent from a point. s->best becomes the best of what it was and of the descent. */
static bool descend(nlopt_search *s, const double *from, double first_step, int64_t most,
                    double *before) {
  size_t n = s->task->dimension;
  double least = s->least;
  memcpy(before, s->best, n * sizeof *before);
  memcpy(s->best, from, n * sizeof *from);
  s->least = HUGE_VAL;
  bool fine = run(s, STRUT_SEARCH_SBPLX, first_step, most);
  if (least <= s->least) {
    memcpy(s->best, before, n * sizeof *before);
    s->least = least;
  }
  return fine;
}

/*
 * Descends from the best spread points that lie apart, and continues from the better end: a narrow basin may be
 * deeper than the one with the best of the spread points.
 */
static bool descend_from_spread(nlopt_search *s) {
  size_t n = s->task->dimension, count = 0;
  const double *from[DESCENTS];
  double *before = strut_allocate(n, sizeof *before);
  bool fine = before != NULL;
  while (count < DESCENTS && (from[count] = best_apart(s, from, count))) count++;
  double rest = (double)(s->task->evaluations - s->asked) * DESCENT_SHARE;
  int64_t most = (int64_t)fmax(ceil(rest / (double)(count ? count : 1)), 1.0);
  for (size_t i = 0; i < count && fine && !s->ended; i++)
    fine = descend(s, from[i], REFINED_STEP, most, before);
  if (fine && !s->ended) fine = run(s, STRUT_SEARCH_SBPLX, LAST_STEP, INT64_MAX);
  strut_release(before);
  return fine;
}

/* Controlled random search, then a descent from the best point. */
static bool search_and_descend(nlopt_search *s) {
  double rest = (double)(s->task->evaluations - s->asked) * GLOBAL_SHARE;
  bool fine = run(s, STRUT_SEARCH_CRS2, FIRST_STEP, (int64_t)fmax(ceil(rest), 1.0));
  return fine && (s->ended || run(s, STRUT_SEARCH_SBPLX, REFINED_STEP, INT64_MAX));
}

bool strut_search_optimise_by_nlopt(const strut_search_task *task,
                                    const strut_search_asker *asker) {
  size_t n = task->dimension;
  nlopt_search s = {.task = task, .asker = asker, .least = HUGE_VAL};
  double *block = strut_allocate(2 * n + task->conditions + 1, sizeof *block);
  if (!block) return false;
  s.best = block;
  s.last = block + n;
  s.broken = block + 2 * n;
  memcpy(s.best, task->start, n * sizeof *block);
  bool two = task->method == STRUT_SEARCH_CRS2, many = task->method == STRUT_SEARCH_MULTISTART;
  bool fine = true;
  if (two || many) fine = spread_points(&s, two ? SPREAD_SHARE : MULTISTART_SPREAD);
  if (fine && !s.ended)
    fine = two    ? search_and_descend(&s)
           : many ? descend_from_spread(&s)
                  : run(&s, task->method, FIRST_STEP, INT64_MAX);
  strut_release(s.spread);
  strut_release(s.spread_values);
  strut_release(block);
  return fine;
}
