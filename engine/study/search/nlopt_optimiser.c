/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The optimisers of NLopt. The only file that uses it. */
#include <math.h>
#include <nlopt.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/study/search/optimiser.h"

/* Movements below this end a search, in widths of the box. */
static const double FINEST = 1e-7;
/* First steps of a local method: from any start, and from the best point of a global one. */
static const double FIRST_STEP = 0.2, REFINED_STEP = 0.1;
/* Shares of the evaluations of crs2 for evenly spread points, and of the rest for controlled random search. */
static const double SPREAD_SHARE = 0.4, GLOBAL_SHARE = 0.5;

/* CRS2 looks at the same point for ever once all of its population are there. */
enum { MOST_STUCK = 1000 };

/* A search in progress. NLopt 2.7.1 may return a point that is not the best, so this one remembers it. */
typedef struct nlopt_search {
  const strut_search_task *task;
  const strut_search_asker *asker;
  nlopt_opt opt;
  int64_t asked, most; /* by this method */
  int64_t stuck;       /* how often in a row it has looked at the same point */
  bool ended;          /* the asker wants no more */
  double *best, least; /* (dimension) and its value */
  double *last, value; /* the latest point and its value, for the conditions */
  double *broken;      /* (conditions) there */
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
 * Asks for the start and points spread evenly over the box. Controlled random search alone, which begins at
 * random, misses a narrow basin more often.
 */
static bool spread(nlopt_search *s) {
  size_t n = s->task->dimension;
  const strut_search_spread sequence = strut_search_spread_begin(n, s->task->seed);
  double usual = 20.0 * ((double)n + 1.0), *point = strut_allocate(n, sizeof *point);
  if (!point) return false;
  int64_t count = (int64_t)fmin(usual, floor(SPREAD_SHARE * (double)s->task->evaluations));
  s->most = INT64_MAX;
  look_at(s, s->task->start);
  for (int64_t k = 1; k < count && !s->ended; k++) {
    for (size_t i = 0; i < n; i++) point[i] = strut_search_spread_at(&sequence, k, i);
    look_at(s, point);
  }
  strut_release(point);
  return true;
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
  bool two = task->method == STRUT_SEARCH_CRS2, fine;
  fine = !two || spread(&s);
  double rest = (double)(task->evaluations - s.asked) * GLOBAL_SHARE;
  if (fine && !s.ended)
    fine = run(&s, task->method, FIRST_STEP, two ? (int64_t)fmax(ceil(rest), 1.0) : INT64_MAX);
  if (fine && two && !s.ended) fine = run(&s, STRUT_SEARCH_SBPLX, REFINED_STEP, INT64_MAX);
  strut_release(block);
  return fine;
}
