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
  double *answer; /* (1 + dimension) the value with its derivatives, of methods that follow them */
  double *broken; /* (conditions) there */
  double *spread,
      *spread_values; /* (spread_count, dimension) evenly spread points; (spread_count) */
  size_t spread_count;
  strut_arena arena;
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
    [STRUT_SEARCH_BFGS] = {NLOPT_LD_SLSQP, false, false},
    [STRUT_SEARCH_MULTISTART] = {NLOPT_LN_SBPLX, false, false},
};

bool strut_search_knows_conditions(strut_search_method method) {
  return rows[method].conditions; /* of others: no */
}

/* Asks for a point, unless it is the latest one; where it cannot, the method must end. */
static double look_at(nlopt_search *self, const double *point) {
  size_t n = self->task->dimension;
  bool same = self->asked > 0 && memcmp(point, self->last, n * sizeof *point) == 0;
  self->stuck = same ? self->stuck + 1 : 0;
  if (same && self->stuck <= MOST_STUCK) return self->value;
  bool open = !same && !self->ended && self->asked < self->most;
  if (open && !self->asker->ask(self->asker->context, 1, point, self->answer, self->broken))
    self->ended = true;
  if (!open || self->ended) {
    nlopt_force_stop(self->opt);
    return self->value;
  }
  double value = self->answer[0];
  self->asked++;
  memcpy(self->last, point, n * sizeof *point);
  self->value = value;
  double excess = 0.0;
  for (size_t i = 0; i < self->task->conditions; i++) excess = fmax(excess, self->broken[i]);
  if (excess <= 0.0 && value < self->least) {
    self->least = value;
    memcpy(self->best, point, n * sizeof *point);
  }
  return value;
}

static double objective(unsigned n, const double *point, double *gradient, void *context) {
  const nlopt_search *self = context;
  double value = look_at(context, point);
  bool flat = true; /* no way down is known */
  for (unsigned i = 0; gradient && i < n; i++) {
    gradient[i] = isfinite(self->answer[1 + i]) ? self->answer[1 + i] : 0.0;
    flat = flat && gradient[i] == 0.0;
  }
  if (gradient && flat) nlopt_force_stop(self->opt);
  return value;
}

static void conditions(unsigned m, double *result, unsigned n, const double *point,
                       double *gradient, void *context) {
  nlopt_search *self = context;
  (void)n, (void)gradient;
  look_at(self, point);
  memcpy(result, self->broken, m * sizeof *result);
}

/* Bounds: what wraps may go on beyond them, where a method walks from a point. */
static bool set_bounds(nlopt_search *self, bool global) {
  size_t n = self->task->dimension;
  double *bound = strut_arena_allocate(&self->arena, 2 * n, sizeof *bound);
  if (!bound) return false;
  for (size_t i = 0; i < n; i++) {
    bool beyond = self->task->wraps[i] && !global;
    bound[i] = beyond ? self->best[i] - 1.0 : 0.0;
    bound[n + i] = beyond ? self->best[i] + 1.0 : 1.0;
  }
  return nlopt_set_lower_bounds(self->opt, bound) >= 0 &&
         nlopt_set_upper_bounds(self->opt, bound + n) >= 0;
}

/* The population of a global method: the usual one, or less where evaluations are few. */
static unsigned population(const nlopt_search *self, strut_search_method method) {
  double n = (double)self->task->dimension, few = floor((double)self->most / 3.0);
  double usual = method == STRUT_SEARCH_CRS2 ? 10.0 * (n + 1.0) : 20.0 * (n + 1.0);
  return (unsigned)fmax(n + 3.0, fmin(usual, few));
}

/* Runs one method from s->best. False: no memory. */
static bool run(nlopt_search *self, strut_search_method method, double first_step, int64_t most) {
  const struct method_row *row = &rows[method];
  size_t n = self->task->dimension, m = self->task->conditions;
  double value, *point, *tolerance;
  self->opt = nlopt_create(row->algorithm, (unsigned)n);
  bool fine = self->opt && set_bounds(self, row->global) &&
              STRUT_ALLOCATE(&self->arena, STRUT_NEW(point, n), STRUT_NEW(tolerance, m));
  self->asked = self->stuck = 0;
  self->most = most;
  if (fine) {
    memcpy(point, self->best, n * sizeof *point);
    nlopt_set_min_objective(self->opt, objective, self);
    if (m)
      fine = nlopt_add_inequality_mconstraint(self->opt, (unsigned)m, conditions, self,
                                              tolerance) >= 0;
    nlopt_set_xtol_abs1(self->opt, FINEST);
    if (!row->global) nlopt_set_initial_step1(self->opt, first_step);
    if (method == STRUT_SEARCH_CRS2 || method == STRUT_SEARCH_ISRES)
      nlopt_set_population(self->opt, population(self, method));
  }
  if (fine) {
    nlopt_srand(self->task->seed); /* of this thread */
    fine = nlopt_optimize(self->opt, point, &value) != NLOPT_OUT_OF_MEMORY;
  }
  if (self->opt) nlopt_destroy(self->opt);
  self->opt = NULL;
  return fine;
}

/*
 * Asks at once for the start and for points spread evenly over the box, together a share of the evaluations, and
 * keeps them in s->spread. Controlled random search alone, which begins at random, misses a narrow basin more often.
 */
static bool spread_points(nlopt_search *self, double share) {
  size_t n = self->task->dimension;
  double usual = 20.0 * ((double)n + 1.0);
  int64_t count = (int64_t)fmax(fmin(usual, floor(share * (double)self->task->evaluations)), 1.0);
  if (!STRUT_ALLOCATE(&self->arena, STRUT_NEW(self->spread, (size_t)count * n),
                      STRUT_NEW(self->spread_values, count)))
    return false;
  strut_search_spread_points(self->task, (size_t)count, self->spread);
  self->spread_count = (size_t)count;
  self->asked = count;
  self->ended = !self->asker->ask(self->asker->context, self->spread_count, self->spread,
                                  self->spread_values, NULL);
  for (size_t k = 0; k < self->spread_count && !self->ended; k++) {
    if (self->spread_values[k] >= self->least) continue;
    self->least = self->spread_values[k];
    memcpy(self->best, self->spread + k * n, n * sizeof *self->best);
  }
  return true;
}

/* Is the point within APART of another one, in every number? */
static bool is_near(const nlopt_search *self, const double *point, const double *other) {
  double largest = 0.0;
  for (size_t i = 0; i < self->task->dimension; i++) {
    double apart = fabs(point[i] - other[i]);
    if (self->task->wraps[i]) apart = fmin(apart, 1.0 - apart);
    largest = fmax(largest, apart);
  }
  return largest <= APART;
}

/* The best of the spread points that is near to none of `others`; NULL: there is none. */
static const double *best_apart(const nlopt_search *self, const double *const *others,
                                size_t count) {
  size_t n = self->task->dimension;
  size_t best = self->spread_count;
  for (size_t k = 0; k < self->spread_count; k++) {
    bool near = false;
    for (size_t i = 0; i < count && !near; i++)
      near = is_near(self, self->spread + k * n, others[i]);
    if (!near && (best == self->spread_count || self->spread_values[k] < self->spread_values[best]))
      best = k;
  }
  return best < self->spread_count ? self->spread + best * n : NULL;
}

/* A descent from a point. s->best becomes the best of what it was and of the descent. */
static bool descend(nlopt_search *self, const double *from, double first_step, int64_t most,
                    double *before) {
  size_t n = self->task->dimension;
  double least = self->least;
  memcpy(before, self->best, n * sizeof *before);
  memcpy(self->best, from, n * sizeof *from);
  self->least = HUGE_VAL;
  bool fine = run(self, STRUT_SEARCH_SBPLX, first_step, most);
  if (least <= self->least) {
    memcpy(self->best, before, n * sizeof *before);
    self->least = least;
  }
  return fine;
}

/*
 * Descends from the best spread points that lie apart, and continues from the better end: a narrow basin may be
 * deeper than the one with the best of the spread points.
 */
static bool descend_from_spread(nlopt_search *self) {
  size_t n = self->task->dimension, count = 0;
  const double *from[DESCENTS];
  double *before = strut_arena_allocate(&self->arena, n, sizeof *before);
  bool fine = before != NULL;
  while (count < DESCENTS && (from[count] = best_apart(self, from, count))) count++;
  double rest = (double)(self->task->evaluations - self->asked) * DESCENT_SHARE;
  int64_t most = (int64_t)fmax(ceil(rest / (double)(count ? count : 1)), 1.0);
  for (size_t i = 0; i < count && fine && !self->ended; i++)
    fine = descend(self, from[i], REFINED_STEP, most, before);
  return fine && (self->ended || run(self, STRUT_SEARCH_SBPLX, LAST_STEP, INT64_MAX));
}

/* Controlled random search, then a descent from the best point. */
static bool search_and_descend(nlopt_search *self) {
  double rest = (double)(self->task->evaluations - self->asked) * GLOBAL_SHARE;
  bool fine = run(self, STRUT_SEARCH_CRS2, FIRST_STEP, (int64_t)fmax(ceil(rest), 1.0));
  return fine && (self->ended || run(self, STRUT_SEARCH_SBPLX, REFINED_STEP, INT64_MAX));
}

bool strut_search_optimise_by_nlopt(const strut_search_task *task,
                                    const strut_search_asker *asker) {
  size_t n = task->dimension;
  nlopt_search s = {.task = task, .asker = asker, .least = HUGE_VAL};
  bool fine = STRUT_ALLOCATE(&s.arena, STRUT_NEW(s.best, n), STRUT_NEW(s.last, n),
                             STRUT_NEW(s.answer, n + 1), STRUT_NEW(s.broken, task->conditions + 1));
  if (fine) memcpy(s.best, task->start, n * sizeof *s.best);
  bool two = task->method == STRUT_SEARCH_CRS2, many = task->method == STRUT_SEARCH_MULTISTART;
  if (fine && (two || many)) fine = spread_points(&s, two ? SPREAD_SHARE : MULTISTART_SPREAD);
  if (fine && !s.ended)
    fine = two    ? search_and_descend(&s)
           : many ? descend_from_spread(&s)
                  : run(&s, task->method, FIRST_STEP, INT64_MAX);
  strut_arena_free(&s.arena);
  return fine;
}
