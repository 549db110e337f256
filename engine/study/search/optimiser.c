/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/study/search/optimisers.h"

#include "engine/base/mixed_bits.h"
#include "engine/study/sweep/sweep.h"

/* Generations are multiples of this, on any machine, so that they fill processors. */
enum { SIDE_BY_SIDE = 8 };

static const double SPREAD = 0.3; /* of CMA-ES at the start */

static size_t generation_of(size_t dimension) {
  size_t usual = 4 + (size_t)floor(3.0 * log((double)dimension));
  return (usual + SIDE_BY_SIDE - 1) / SIDE_BY_SIDE * SIDE_BY_SIDE;
}

bool strut_search_has_generations(strut_search_method method) {
  return method == STRUT_SEARCH_CMA || method == STRUT_SEARCH_NSGA2;
}

/* Asks for all points of the grid at once, or for as many as may be, from the start on. */
static bool look_at_grid(const strut_search_task *task, const strut_search_asker *asker) {
  const size_t n = task->dimension;
  strut_arena arena = {0};
  int64_t all = 1, at = 0;
  for (size_t i = 0; i < n; i++) {
    at += all * (int64_t)(task->start[i] * (double)task->counts[i]);
    all *= task->counts[i];
  }
  const size_t count = (size_t)(all < task->evaluations ? all : task->evaluations);
  double *points, *values;
  bool fine = STRUT_ALLOCATE(&arena, STRUT_NEW(points, count * n),
                             STRUT_NEW(values, count * (2 + task->conditions)));
  for (size_t k = 0; fine && k < count; k++, at = (at + 1) % all) {
    int64_t rest = at;
    for (size_t i = 0; i < n; i++) {
      points[k * n + i] = ((double)(rest % task->counts[i]) + 0.5) / (double)task->counts[i];
      rest /= task->counts[i];
    }
  }
  if (fine) asker->ask(asker->context, count, points, values, values + 2 * count);
  strut_arena_free(&arena);
  return fine;
}

bool strut_search_optimise(const strut_search_task *task, const strut_search_asker *asker) {
  if (task->counts) return look_at_grid(task, asker);
  if (task->method == STRUT_SEARCH_NSGA2) return strut_search_optimise_by_nsga2(task, asker);
  return task->method == STRUT_SEARCH_CMA
             ? strut_search_optimise_by_cma(task, asker, generation_of(task->dimension), SPREAD)
             : strut_search_optimise_by_nlopt(task, asker);
}

double strut_search_share(uint64_t *state) {
  uint64_t bits = strut_mix_bits(*state += 0x9e3779b97f4a7c15u);
  return ((double)(bits >> 11) + 0.5) * 0x1p-53;
}

strut_search_spread strut_search_spread_begin(size_t dimension, uint64_t seed) {
  strut_search_spread spread = {.golden = 2.0, .seed = seed};
  for (int i = 0; i < 60; i++)
    spread.golden = pow(1.0 + spread.golden, 1.0 / ((double)dimension + 1.0));
  return spread;
}

double strut_search_spread_at(const strut_search_spread *spread, int64_t i, size_t k) {
  uint64_t state = spread->seed + k * 0x9e3779b97f4a7c15u; /* the k-th number after the seed */
  double at = strut_search_share(&state) + (double)i * pow(spread->golden, -(double)(k + 1));
  return at - floor(at);
}

void strut_search_spread_points(const strut_search_task *task, size_t count, double *points) {
  const size_t n = task->dimension;
  const strut_search_spread spread = strut_search_spread_begin(n, task->seed);
  memcpy(points, task->start, n * sizeof *points);
  for (size_t i = 1; i < count; i++)
    for (size_t k = 0; k < n; k++)
      points[i * n + k] = strut_search_spread_at(&spread, (int64_t)i, k);
}

int64_t strut_search_count(const strut_search_variable *variable) {
  if (variable->choice_count) return (int64_t)variable->choice_count;
  return variable->integer ? (int64_t)(floor(variable->to) - ceil(variable->from)) + 1 : 0;
}

/* Which of `count` equal parts of the box. */
static int64_t part_of(double number, int64_t count) {
  int64_t part = (int64_t)floor(number * (double)count);
  return part < count ? part : count - 1;
}

/* A value between the bounds, to 15 digits, so that tables have round numbers where they are. */
static double between(const strut_search_variable *variable, double value) {
  value = strut_grid_rounded(value, fmax(fabs(variable->from), fabs(value)));
  return fmin(fmax(value, variable->from), variable->to);
}

strut_study_value strut_search_value(const strut_search_variable *variable, double number) {
  strut_study_value value = {.number = (double)NAN};
  int64_t count = strut_search_count(variable);
  if (variable->wraps) number -= floor(number);
  number = fmin(fmax(number, 0.0), 1.0); /* NaN becomes 0 */
  if (variable->choice_count) {
    int64_t i = part_of(number, count);
    if (variable->word)
      value.word = variable->words[i];
    else
      value.number = variable->numbers[i];
  } else if (variable->integer) {
    value.number = ceil(variable->from) + (double)part_of(number, count);
  } else if (number == 0.0) {
    value.number = variable->from; /* its own bits */
  } else if (number == 1.0) {
    value.number = variable->wraps ? variable->from : variable->to;
  } else if (variable->logarithmic) {
    value.number = between(variable, variable->from * pow(variable->to / variable->from, number));
  } else {
    value.number = between(variable, variable->from + (variable->to - variable->from) * number);
  }
  return value;
}

bool strut_search_same(strut_study_value a, strut_study_value b) {
  if (a.word || b.word) return a.word && b.word && strcmp(a.word, b.word) == 0;
  return a.number == b.number;
}

double strut_search_number(const strut_search_variable *variable, strut_study_value value) {
  int64_t count = strut_search_count(variable);
  if (variable->choice_count) {
    int64_t i = 0;
    while (i + 1 < count && !(variable->word ? strcmp(variable->words[i], value.word) == 0
                                             : variable->numbers[i] == value.number))
      i++;
    return ((double)i + 0.5) / (double)count;
  }
  if (variable->integer) return (value.number - ceil(variable->from) + 0.5) / (double)count;
  if (variable->logarithmic)
    return log(value.number / variable->from) / log(variable->to / variable->from);
  return (value.number - variable->from) / (variable->to - variable->from);
}

double strut_search_start(const strut_search_variable *variable) {
  strut_study_value value = {.number = variable->start};
  if (variable->choice_count) value = strut_search_value(variable, 0.0);
  return strut_search_number(variable, value);
}

int strut_search_bound(const strut_search_variable *variable, strut_study_value value) {
  if (variable->choice_count || variable->wraps) return 0;
  if (value.number <= (variable->integer ? ceil(variable->from) : variable->from)) return -1;
  return value.number >= (variable->integer ? floor(variable->to) : variable->to) ? 1 : 0;
}

/*
 * Two goals at once: the evolution of K. Deb and others (NSGA-II, IEEE Trans. Evol. Comput. 6, 2002), with
 * simulated binary crossover and polynomial mutation in the unit box. A generation is asked for at a time;
 * its size does not depend on the machine.
 */

/* Indices of the distributions of children about their parents, and the share of crossed pairs. */
static const double CROSSOVER = 15.0, MUTATION = 20.0, CROSSED = 0.9;
/* Share of the evaluations for evenly spread points, of which the best become the first parents. */
static const double SPREAD_SHARE = 0.3;
enum { LEAST = 8, MOST = 48, BATCH = 8, GENERATIONS = 12 };

typedef struct individual {
  const double *point; /* (dimension) */
  double value[2], crowding;
  size_t rank, index;
} individual;

typedef struct evolution {
  const strut_search_task *task;
  size_t n, size;
  uint64_t state;
  double *points[2],
      *values[2];  /* (2 size, dimension), (2 size, 2): parents, then children; room for the next */
  individual *all; /* (2 size) */
} evolution;

static double share(evolution *self) { return strut_search_share(&self->state); }

static bool dominates(const individual *first, const individual *second) {
  return first->value[0] <= second->value[0] && first->value[1] <= second->value[1] &&
         (first->value[0] < second->value[0] || first->value[1] < second->value[1]);
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

static int by_worth(const void *first, const void *second) {
  const individual *self = first, *y = second;
  if (self->rank != y->rank) return self->rank < y->rank ? -1 : 1;
  if (self->crowding != y->crowding) return self->crowding > y->crowding ? -1 : 1;
  return self->index < y->index ? -1 : 1;
}

/* The best of `count` become the parents, in order. */
static void select_parents(evolution *self, size_t count) {
  double *points = self->points[1], *values = self->values[1];
  for (size_t i = 0; i < count; i++) {
    self->all[i] = (individual){.point = self->points[0] + i * self->n, .index = i};
    memcpy(self->all[i].value, self->values[0] + 2 * i, sizeof self->all[i].value);
  }
  rank_all(self->all, count);
  find_crowding(self->all, count);
  qsort(self->all, count, sizeof *self->all, by_worth);
  for (size_t i = 0; i < self->size; i++) {
    memcpy(points + i * self->n, self->all[i].point, self->n * sizeof *points);
    memcpy(values + 2 * i, self->all[i].value, 2 * sizeof *values);
  }
  self->points[1] = self->points[0], self->points[0] = points;
  self->values[1] = self->values[0], self->values[0] = values;
}

/* The better of two parents by chance; parents are in order. */
static size_t choose(evolution *self) {
  size_t a = (size_t)(share(self) * (double)self->size),
         b = (size_t)(share(self) * (double)self->size);
  return a < b ? a : b;
}

static double mutate(evolution *self, double x, bool wraps) {
  double u = share(self), power = 1.0 / (MUTATION + 1.0);
  if (share(self) * (double)self->n > 1.0) return x;
  x += u < 0.5 ? pow(2.0 * u, power) - 1.0 : 1.0 - pow(2.0 - 2.0 * u, power);
  return wraps ? x - floor(x) : fmin(fmax(x, 0.0), 1.0);
}

/* Two children behind the parents. */
static void make_children(evolution *self, size_t at) {
  const double *a = self->points[0] + choose(self) * self->n,
               *b = self->points[0] + choose(self) * self->n;
  double *first = self->points[0] + at * self->n, *second = first + self->n;
  bool crossed = share(self) < CROSSED;
  for (size_t i = 0; i < self->n; i++) {
    double u = share(self), power = 1.0 / (CROSSOVER + 1.0);
    double spread = u < 0.5 ? pow(2.0 * u, power) : pow(0.5 / (1.0 - u), power);
    if (!crossed || share(self) < 0.5) spread = 1.0;
    double middle = 0.5 * (a[i] + b[i]), half = 0.5 * spread * (b[i] - a[i]);
    first[i] = mutate(self, fmin(fmax(middle - half, 0.0), 1.0), self->task->wraps[i]);
    second[i] = mutate(self, fmin(fmax(middle + half, 0.0), 1.0), self->task->wraps[i]);
  }
}

bool strut_search_optimise_by_nsga2(const strut_search_task *task,
                                    const strut_search_asker *asker) {
  evolution e = {.task = task, .n = task->dimension, .state = task->seed};
  size_t size = (size_t)task->evaluations / GENERATIONS;
  size = size < LEAST ? LEAST : size > MOST ? MOST : size;
  e.size = (size + BATCH - 1) / BATCH * BATCH;
  size_t first = (size_t)(SPREAD_SHARE * (double)task->evaluations);
  first = first < e.size ? e.size : first > 20 * (e.n + 1) ? 20 * (e.n + 1) : first;
  if (first < e.size) first = e.size;
  size_t most = first > 2 * e.size ? first : 2 * e.size;
  strut_arena arena = {0};
  bool fine = STRUT_NUMBERS(&arena, most * e.n, &e.points[0], &e.points[1]) &&
              STRUT_NUMBERS(&arena, 2 * most, &e.values[0], &e.values[1]) &&
              STRUT_ALLOCATE(&arena, STRUT_NEW(e.all, most));
  if (fine) strut_search_spread_points(task, first, e.points[0]);
  bool more = fine && asker->ask(asker->context, first, e.points[0], e.values[0], NULL);
  for (size_t count = first; more; count = 2 * e.size) {
    select_parents(&e, count);
    for (size_t i = e.size; i < 2 * e.size; i += 2) make_children(&e, i);
    more = asker->ask(asker->context, e.size, e.points[0] + e.size * e.n, e.values[0] + 2 * e.size,
                      NULL);
  }
  strut_arena_free(&arena);
  return fine;
}
