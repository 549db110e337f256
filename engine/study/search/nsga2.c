/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Two goals at once: the evolution of K. Deb and others (NSGA-II, IEEE Trans. Evol. Comput. 6, 2002), with
 * simulated binary crossover and polynomial mutation in the unit box. A generation is asked for at a time;
 * its size does not depend on the machine.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/study/search/optimiser.h"

/* Indices of the distributions of children about their parents, and the share of crossed pairs. */
static const double CROSSOVER = 15.0, MUTATION = 20.0, CROSSED = 0.9;
/* Share of the evaluations for evenly spread points, of which the best become the first parents. */
static const double SPREAD_SHARE = 0.3;
enum { LEAST = 8, MOST = 48, SIDE_BY_SIDE = 8, GENERATIONS = 12 };

typedef struct individual {
  const double *point; /* (dimension) */
  double value[2], crowding;
  size_t rank, index;
} individual;

typedef struct evolution {
  const strut_search_task *task;
  size_t n, size;
  uint64_t state;
  double *points, *values; /* (2 size, dimension), (2 size, 2): parents, then children */
  individual *all;         /* (2 size) */
} evolution;

static double share(evolution *e) { return strut_search_share(&e->state); }

static bool dominates(const individual *a, const individual *b) {
  return a->value[0] <= b->value[0] && a->value[1] <= b->value[1] &&
         (a->value[0] < b->value[0] || a->value[1] < b->value[1]);
}

/* The number of individuals that a chain of dominations passes through before each. */
static void rank_all(individual *all, size_t count) {
  for (size_t i = 0; i < count; i++) all[i].rank = SIZE_MAX;
  size_t left = count;
  for (size_t rank = 0; left > 0; rank++) {
    for (size_t i = 0; i < count; i++) {
      bool free = all[i].rank == SIZE_MAX;
      for (size_t k = 0; k < count && free; k++)
        free = all[k].rank < rank || !dominates(&all[k], &all[i]);
      if (free) all[i].rank = rank, left--;
      if (free) all[i].crowding = 0.0;
    }
  }
}

/* The gap between the neighbours of an individual within its rank; infinite at the ends. */
static void find_crowding(individual *all, size_t count) {
  for (size_t i = 0; i < count; i++) {
    for (int k = 0; k < 2; k++) {
      double below = -HUGE_VAL, above = HUGE_VAL, low = HUGE_VAL, high = -HUGE_VAL;
      for (size_t j = 0; j < count; j++) {
        double value = all[j].value[k];
        if (all[j].rank != all[i].rank) continue;
        low = fmin(low, value), high = fmax(high, value);
        if (j == i) continue;
        bool under = value < all[i].value[k] || (value == all[i].value[k] && j < i);
        if (under)
          below = fmax(below, value);
        else
          above = fmin(above, value);
      }
      all[i].crowding += high > low ? (above - below) / (high - low) : 0.0;
    }
  }
}

static int by_worth(const void *a, const void *b) {
  const individual *x = a, *y = b;
  if (x->rank != y->rank) return x->rank < y->rank ? -1 : 1;
  if (x->crowding != y->crowding) return x->crowding > y->crowding ? -1 : 1;
  return x->index < y->index ? -1 : 1;
}

static void sort(evolution *e, size_t count) {
  for (size_t i = 0; i < count; i++) {
    e->all[i] = (individual){.point = e->points + i * e->n, .index = i};
    memcpy(e->all[i].value, e->values + 2 * i, sizeof e->all[i].value);
  }
  rank_all(e->all, count);
  find_crowding(e->all, count);
  qsort(e->all, count, sizeof *e->all, by_worth);
}

/* The better half become the parents. False: no memory. */
static bool select_parents(evolution *e) {
  double *points = strut_allocate(e->size * e->n, sizeof *points);
  double *values = strut_allocate(2 * e->size, sizeof *values);
  bool fine = points && values;
  for (size_t i = 0; fine && i < e->size; i++) {
    memcpy(points + i * e->n, e->all[i].point, e->n * sizeof *points);
    memcpy(values + 2 * i, e->all[i].value, 2 * sizeof *values);
  }
  if (fine) {
    memcpy(e->points, points, e->size * e->n * sizeof *points);
    memcpy(e->values, values, 2 * e->size * sizeof *values);
  }
  strut_release(points);
  strut_release(values);
  return fine;
}

/* The better of two parents by chance; parents are in order. */
static size_t choose(evolution *e) {
  size_t a = (size_t)(share(e) * (double)e->size), b = (size_t)(share(e) * (double)e->size);
  return a < b ? a : b;
}

static double mutate(evolution *e, double x, bool wraps) {
  double u = share(e), power = 1.0 / (MUTATION + 1.0);
  if (share(e) * (double)e->n > 1.0) return x;
  x += u < 0.5 ? pow(2.0 * u, power) - 1.0 : 1.0 - pow(2.0 - 2.0 * u, power);
  return wraps ? x - floor(x) : fmin(fmax(x, 0.0), 1.0);
}

/* Two children behind the parents. */
static void make_children(evolution *e, size_t at) {
  const double *a = e->points + choose(e) * e->n, *b = e->points + choose(e) * e->n;
  double *first = e->points + at * e->n, *second = first + e->n;
  bool crossed = share(e) < CROSSED;
  for (size_t i = 0; i < e->n; i++) {
    double u = share(e), power = 1.0 / (CROSSOVER + 1.0);
    double spread = u < 0.5 ? pow(2.0 * u, power) : pow(0.5 / (1.0 - u), power);
    if (!crossed || share(e) < 0.5) spread = 1.0;
    double middle = 0.5 * (a[i] + b[i]), half = 0.5 * spread * (b[i] - a[i]);
    first[i] = mutate(e, fmin(fmax(middle - half, 0.0), 1.0), e->task->wraps[i]);
    second[i] = mutate(e, fmin(fmax(middle + half, 0.0), 1.0), e->task->wraps[i]);
  }
}

static void spread_points(evolution *e, size_t count) {
  strut_search_spread spread = strut_search_spread_begin(e->n, e->task->seed);
  memcpy(e->points, e->task->start, e->n * sizeof *e->points);
  for (size_t i = 1; i < count; i++)
    for (size_t k = 0; k < e->n; k++)
      e->points[i * e->n + k] = strut_search_spread_at(&spread, (int64_t)i, k);
}

bool strut_search_optimise_by_nsga2(const strut_search_task *task,
                                    const strut_search_asker *asker) {
  evolution e = {.task = task, .n = task->dimension, .state = task->seed};
  size_t size = (size_t)task->evaluations / GENERATIONS;
  size = size < LEAST ? LEAST : size > MOST ? MOST : size;
  e.size = (size + SIDE_BY_SIDE - 1) / SIDE_BY_SIDE * SIDE_BY_SIDE;
  size_t first = (size_t)(SPREAD_SHARE * (double)task->evaluations);
  first = first < e.size ? e.size : first > 20 * (e.n + 1) ? 20 * (e.n + 1) : first;
  if (first < e.size) first = e.size;
  size_t most = first > 2 * e.size ? first : 2 * e.size;
  e.points = strut_allocate(most * e.n, sizeof *e.points);
  e.values = strut_allocate(2 * most, sizeof *e.values);
  e.all = strut_allocate(most, sizeof *e.all);
  bool fine = e.points && e.values && e.all, more = fine;
  if (fine) spread_points(&e, first);
  more = more && asker->ask(asker->context, first, e.points, e.values, NULL);
  if (more) {
    sort(&e, first);
    fine = select_parents(&e);
  }
  while (more && fine) {
    for (size_t i = e.size; i < 2 * e.size; i += 2) make_children(&e, i);
    more = asker->ask(asker->context, e.size, e.points + e.size * e.n, e.values + 2 * e.size, NULL);
    if (!more) break;
    sort(&e, 2 * e.size);
    fine = select_parents(&e);
  }
  strut_release(e.points);
  strut_release(e.values);
  strut_release(e.all);
  return fine;
}
