/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The search in its order: known shapes, random ones, folds of what was found; then saddles. */
#include "engine/statics/search/critical.h"

#include <assert.h>
#include <math.h>

/*
 * Work limit of all searches of one command (decomposed Hessians times their cost), and the share
 * of it at which each phase must end.
 */
static const double MOST_WORK = 6e9;
static const double KNOWN_BY = 0.2, RANDOM_BY = 0.4, FOLDS_BY = 0.5, CROSSES_BY = 0.55,
                    CLIMBS_BY = 0.9;

/*
 * Crossings per pair of minima, their limit as a fraction of the random starts, and shakes per
 * minimum.
 */
enum { CROSSINGS = 2, PART_CROSSED = 8, SHAKES = 6 };
enum { LEAST_RANDOM = 256, PER_MINIMUM = 32, MODES_CLIMBED = 5, ROUNDS = 4, RANDOM_CLIMBS = 8 };

typedef struct search {
  const strut_potential *potential;
  const strut_critical_effort *effort;
  strut_critical_set *set;
  strut_stationary_set all;
  strut_search_tasks *batch;
  strut_task task[STRUT_BATCH];
  size_t tasks;
  int64_t random; /* random starts made */
  int64_t *hits;  /* (count) of these, those that ended at each point; of strut_allocate */
  size_t room;    /* how many points `hits` has room for */
  int64_t climbs_left;
  double cost, spent, budget; /* of one Hessian, so far, and at most */
  size_t batch_size;          /* tasks between checks of the work done */
  size_t climbed, paired;     /* points up to which modes and pairs were climbed */
  size_t shaken;              /* points up to which rare minima were shaken */
  strut_status status;        /* once it is set, no more tasks are added */
  strut_error *error;
} search;

/* Reads one result into the points. */
static strut_status read_result(search *self, const strut_task *task,
                                const strut_task_result *result) {
  bool start = task->kind <= STRUT_TASK_RANDOM, down = task->kind == STRUT_TASK_DOWN, fresh;
  int32_t index;
  if (start) self->set->starts++;
  if (!start && !down) self->set->saddle_starts++;
  if (start && result->end == STRUT_DESCENT_RUNAWAY) self->set->runaway++;
  if (start && result->end == STRUT_DESCENT_EXHAUSTED) self->set->exhausted++;
  if (result->end != STRUT_DESCENT_REACHED) return STRUT_OK;
  strut_status status =
      strut_stationary_set_add(&self->all, result->q, &index, &fresh, self->error);
  if (status) return status;
  if (fresh && !strut_grow(&self->hits, &self->room, (size_t)index, sizeof *self->hits))
    return strut_no_memory(self->error, "");
  if (fresh) self->hits[index] = 0;
  if (task->kind == STRUT_TASK_RANDOM) self->hits[index]++;
  if (!down) return STRUT_OK;
  self->all.points[index].found--;
  if (strut_is_minimum(&self->all.points[index]))
    self->all.points[task->from].down[task->side > 0 ? 0 : 1] = index;
  return STRUT_OK;
}

/* Runs the tasks added so far; nothing once the search has failed. */
static void run_tasks(search *self) {
  const strut_flag *interrupt = self->effort->interrupt;
  if (self->status) return;
  const strut_task_result *result =
      strut_search_tasks_run(self->batch, self->task, self->tasks, interrupt);
  if (interrupt && *interrupt)
    self->status = strut_fail(self->error, STRUT_INTERRUPTED, "interrupted while searching");
  for (size_t i = 0; i < self->tasks && !self->status; i++) {
    self->spent += self->cost * (double)result[i].hessian_count;
    self->status = read_result(self, &self->task[i], &result[i]);
  }
  self->tasks = 0;
}

/* Appends a task to the batch, which runs when full. */
static void add_task(search *self, strut_task task) {
  if (self->status) return;
  assert(self->tasks < self->batch_size && self->batch_size <= STRUT_BATCH);
  self->task[self->tasks++] = task;
  if (self->tasks == self->batch_size) run_tasks(self);
}

/* True, and the search cut short, if this share of the budget is spent. */
static bool is_over_budget(search *self, double share) {
  if (self->spent <= share * self->budget) return false;
  self->set->cut_short = true;
  return true;
}

static void set_budget(search *self) {
  double n = self->potential->n, descent, size;
  self->cost = n * n * (n + 30.0);
  self->budget = MOST_WORK / (self->effort->searches > 1 ? self->effort->searches : 1);
  descent = 60.0 * self->cost + 1.0;
  size = 0.05 * self->budget / descent;
  self->batch_size = size < 4.0 ? 4 : size > STRUT_BATCH ? STRUT_BATCH : (size_t)size;
}

/* Number of descents or climbs affordable at this size: their cost grows with n^3. */
static int64_t affordable_count(int32_t n, double budget, int64_t least, int64_t most) {
  double count = budget / ((double)n * n * n + 1.0);
  return count < (double)least ? least : count > (double)most ? most : (int64_t)count;
}

/* Starts from the model's own shape, its folds, and the caller's shapes. */
static void search_known_shapes(search *self) {
  const double *own = self->potential->model->start;
  add_task(self, (strut_task){.kind = STRUT_TASK_SHAPE, .q = own});
  for (size_t i = 0; i < self->effort->extra_count; i++)
    add_task(self, (strut_task){.kind = STRUT_TASK_SHAPE, .q = self->effort->extra[i]});
  int64_t most = affordable_count(self->potential->n, 4e6, 4, 256),
          folds = strut_fold_count(self->potential);
  if (self->potential->n > STRUT_DENSE_STATICS) folds = 0;
  if (folds > most) folds = most;
  for (int64_t i = 0; i < folds && !is_over_budget(self, KNOWN_BY); i++)
    add_task(self, (strut_task){.kind = STRUT_TASK_FOLD, .q = own, .number = i});
  run_tasks(self);
}

/* Minima that random starts have met at all, exactly once, exactly twice, and never. */
typedef struct meetings {
  int64_t distinct, once, twice, never;
} meetings;

static meetings count_meetings(const search *self) {
  meetings m = {0};
  for (size_t i = 0; i < self->all.count; i++) {
    if (!strut_is_minimum(&self->all.points[i])) continue;
    m.distinct += self->hits[i] > 0;
    m.once += self->hits[i] == 1;
    m.twice += self->hits[i] == 2;
    m.never += self->hits[i] == 0;
  }
  return m;
}

static bool has_enough_starts(search *self, int64_t most) {
  meetings m = count_meetings(self);
  int64_t least = PER_MINIMUM * m.distinct;
  if (least < LEAST_RANDOM) least = LEAST_RANDOM;
  if (self->random >= least && 150 * m.once <= self->random) return true;
  if (self->random >= most) self->set->cut_short = true;
  return self->random >= most || is_over_budget(self, RANDOM_BY);
}

static void search_random_shapes(search *self) {
  int32_t n = self->potential->n;
  int64_t wanted = self->effort->starts, most = affordable_count(n, 1.5e7, 4, 4000);
  if (n == 0 || (wanted <= 0 && n > STRUT_DENSE_STATICS)) return;
  double before = self->spent;
  int64_t size = (int64_t)self->batch_size;
  while (!self->status && (wanted > 0 ? self->random < wanted : !has_enough_starts(self, most))) {
    int64_t left = (wanted > 0 ? wanted : most) - self->random;
    for (int64_t i = 0; i < left && i < size; i++)
      add_task(self, (strut_task){.kind = STRUT_TASK_RANDOM, .number = self->random++});
    run_tasks(self);
  }
  if (wanted > 0) self->budget += self->spent - before; /* requested starts cost no budget */
}

/* Folds of the minima found: a shape that random starts seldom meet often lies next to one. */
static void search_folded_minima(search *self) {
  int64_t folds = strut_fold_count(self->potential), left = self->random / 2;
  for (int64_t fold = 0; fold < folds && left > 0; fold++)
    for (size_t i = 0; i < self->all.count && left > 0 && !is_over_budget(self, FOLDS_BY);
         i++, left--)
      add_task(self,
               (strut_task){.kind = STRUT_TASK_FOLD, .q = self->all.points[i].q, .number = fold});
  run_tasks(self);
}

/*
 * Part of one minimum and the rest of another, in all pairs: where a structure has several bistable
 * parts, its rare states are made of those that its common ones have.
 */
static void search_crossed_minima(search *self) {
  int64_t left = self->random / PART_CROSSED, number = 0;
  size_t end = self->all.count;
  for (int turn = 0; turn < CROSSINGS; turn++)
    for (size_t i = 1; i < end; i++)
      for (size_t k = 0; k < i && left > 0 && !is_over_budget(self, CROSSES_BY); k++, left--)
        add_task(self, (strut_task){.kind = STRUT_TASK_CROSS,
                                    .q = self->all.points[i].q,
                                    .other = self->all.points[k].q,
                                    .number = number++});
  run_tasks(self);
}

/*
 * Shakes minima that random starts found at most once: neighbours of small basins may be small too.
 */
static void shake_rare_minima(search *self) {
  size_t end = self->all.count;
  for (; self->shaken < end && !self->status; self->shaken++) {
    const double *q = self->all.points[self->shaken].q;
    if (!strut_is_minimum(&self->all.points[self->shaken]) || self->hits[self->shaken] > 1)
      continue;
    for (int64_t k = 0; k < SHAKES && !is_over_budget(self, CLIMBS_BY); k++)
      add_task(self,
               (strut_task){
                   .kind = STRUT_TASK_SHAKE, .q = q, .number = SHAKES * (int64_t)self->shaken + k});
  }
  run_tasks(self);
}

/* Upper 95 % limit of the mean of a count with this variance; of a count of none it is exact. */
static double upper_limit(double count, double variance) {
  return count - log(0.05) + 1.645 * sqrt(variance);
}

strut_missed strut_estimate_missed(int64_t starts, int64_t distinct, int64_t once, int64_t twice) {
  assert(starts >= 0 && distinct >= once + twice);
  double n = (double)starts, f1 = (double)once, f2 = (double)twice;
  strut_missed missed = {1.0, 1.0, 1.0, (double)distinct};
  if (starts == 0) return missed;
  missed.probability = fmin(1.0, (f1 + 1.0) / (n + 1.0));
  missed.below = fmin(1.0, upper_limit(f1, f1 + 2.0 * f2) / n);
  /* No more than 1/p minima have a share of p; that one of them is missed has exp(-n p) / p = 5 %. */
  for (int i = 0; i < 60; i++) missed.one = -log(0.05 * missed.one) / n;
  missed.one = fmin(missed.one, missed.below);
  double least = fmax(0.0, f1 - 1.645 * sqrt(f1));
  missed.count += floor(least * least / (2.0 * upper_limit(f2, f2)));
  return missed;
}

static void estimate_missed(search *self) {
  meetings m = count_meetings(self);
  self->set->missed = strut_estimate_missed(self->random, m.distinct, m.once, m.twice);
  if (self->random == 0) return;
  self->set->unmet = m.never;
  self->set->unseen = (int64_t)fmax(0.0, self->set->missed.count - (double)(m.distinct + m.never));
}

static void climb_from(search *self, strut_task task) {
  if (self->climbs_left-- <= 0) self->set->cut_short = true;
  if (self->climbs_left >= 0 && !is_over_budget(self, CLIMBS_BY)) add_task(self, task);
}

/* Along the softest modes of every minimum not yet climbed from. */
static void climb_modes(search *self) {
  size_t end = self->all.count;
  for (; self->climbed < end; self->climbed++) {
    const strut_critical_point *point = &self->all.points[self->climbed];
    int64_t modes = self->potential->n < MODES_CLIMBED ? self->potential->n : MODES_CLIMBED;
    const double *q = point->q;
    if (!strut_is_minimum(point)) continue;
    for (int64_t k = 0; k < 2 * modes; k++)
      climb_from(
          self,
          (strut_task){
              .kind = STRUT_TASK_CLIMB_MODE, .q = q, .number = k / 2, .side = k % 2 ? -1.0 : 1.0});
  }
  run_tasks(self);
}

/* Between every two minima, in all different placements of the second; copies of one included. */
static void climb_pairs(search *self) {
  size_t end = self->all.count;
  for (; self->paired < end; self->paired++) {
    if (!strut_is_minimum(&self->all.points[self->paired])) continue;
    for (size_t i = 0; i <= self->paired; i++) {
      if (!strut_is_minimum(&self->all.points[i])) continue;
      const double *a = self->all.points[i].q, *b;
      for (int32_t k = i == self->paired; k < 3; k++) {
        b = strut_stationary_set_placement(&self->all, (int32_t)self->paired, k);
        if (!b) break;
        climb_from(self, (strut_task){.kind = STRUT_TASK_CLIMB_PAIR, .q = a, .other = b});
        climb_from(self,
                   (strut_task){.kind = STRUT_TASK_CLIMB_PAIR, .q = a, .other = b, .side = 1.0});
      }
    }
  }
  run_tasks(self);
}

/* Down both sides of every saddle with one unstable direction, from point `begin` on. */
static void descend_from_saddles(search *self, size_t begin) {
  size_t end = self->all.count;
  for (size_t i = begin; i < end && !is_over_budget(self, 1.0); i++) {
    const strut_critical_point *point = &self->all.points[i];
    const double *q = point->q, *direction = point->softest;
    if (strut_is_minimum(point) || point->negative != 1) continue;
    for (int k = 0; k < 2; k++)
      add_task(self, (strut_task){.kind = STRUT_TASK_DOWN,
                                  .q = q,
                                  .other = direction,
                                  .side = k ? -1.0 : 1.0,
                                  .from = (int32_t)i});
  }
  run_tasks(self);
}

/* Even numbers start from a shaken minimum, each in turn; odd ones from a random shape. */
static strut_task random_climb_task(const search *self, int64_t number) {
  strut_task task = {.kind = STRUT_TASK_CLIMB_RANDOM, .number = number};
  int64_t minima = 0, wanted;
  for (size_t i = 0; i < self->all.count; i++) minima += strut_is_minimum(&self->all.points[i]);
  if (number % 2 || minima == 0) return task;
  wanted = number / 2 % minima;
  for (size_t i = 0; i < self->all.count && !task.q; i++)
    if (strut_is_minimum(&self->all.points[i]) && wanted-- == 0) task.q = self->all.points[i].q;
  return task;
}

static void climb_hints(search *self) {
  for (size_t i = 0; i < self->effort->hint_count; i++)
    climb_from(self, (strut_task){.kind = STRUT_TASK_CLIMB_SHAPE, .q = self->effort->hint[i]});
  run_tasks(self);
}

static int64_t count_passes(const search *self) {
  int64_t count = 0;
  for (size_t i = 0; i < self->all.count; i++)
    count += !strut_is_minimum(&self->all.points[i]) && self->all.points[i].negative == 1;
  return count;
}

/* Climbs from random shapes until a whole batch finds no new pass. */
static void climb_at_random(search *self) {
  int64_t number = 0;
  for (int turn = 0; turn < RANDOM_CLIMBS; turn++) {
    int64_t before = count_passes(self);
    for (int i = 0; i < STRUT_BATCH; i++, number++)
      climb_from(self, random_climb_task(self, number));
    run_tasks(self);
    if (count_passes(self) == before) break;
  }
}

static void find_saddles(search *self) {
  size_t gone = 0;
  self->climbs_left = affordable_count(self->potential->n, 4e6, 4, 2000);
  for (int turn = 0; turn < ROUNDS && !self->status; turn++) {
    if (turn == 0)
      climb_hints(self);
    else
      shake_rare_minima(self);
    climb_modes(self);
    climb_pairs(self);
    if (turn == 0) climb_at_random(self);
    while (!self->status && gone < self->all.count) { /* below: new */
      size_t begin = gone;
      gone = self->all.count;
      descend_from_saddles(self, begin);
    }
    if (self->climbed == self->all.count) break;
  }
}

static int kind_rank(const strut_critical_point *point) {
  return strut_is_minimum(point) ? 0 : point->label == STRUT_SADDLE ? 1 : 2;
}

static bool comes_before(const strut_critical_point *first, const strut_critical_point *second) {
  return kind_rank(first) != kind_rank(second) ? kind_rank(first) < kind_rank(second)
                                               : first->potential < second->potential;
}

/* Sorts the points into the set, minima first, by energy, and renumbers the saddles' ends. */
static strut_status sort_into_set(search *self) {
  size_t count = self->all.count;
  strut_arena scratch = {0};
  int32_t *order, *place;
  bool good = STRUT_ALLOCATE(&scratch, STRUT_NEW(order, count), STRUT_NEW(place, count)) &&
              STRUT_ALLOCATE(&self->set->arena, STRUT_NEW(self->set->points, count));
  for (size_t i = 0; i < count && good; i++) {
    size_t k = i;
    for (; k > 0 && comes_before(&self->all.points[i], &self->all.points[order[k - 1]]); k--)
      order[k] = order[k - 1];
    order[k] = (int32_t)i;
  }
  for (size_t i = 0; i < count && good; i++) place[order[i]] = (int32_t)i;
  for (size_t i = 0; i < count && good; i++) {
    strut_critical_point *point = &self->set->points[i];
    *point = self->all.points[order[i]];
    for (int k = 0; k < 2; k++)
      if (point->down[k] >= 0) point->down[k] = place[point->down[k]];
  }
  if (good) strut_number_shapes(&self->all, self->set->points, count);
  self->set->count = good ? count : 0;
  strut_arena_free(&scratch);
  return good ? STRUT_OK : strut_no_memory(self->error, "");
}

strut_status strut_critical_search(const strut_potential *potential,
                                   const strut_critical_effort *effort, strut_critical_set *set,
                                   strut_error *error) {
  search s = {.potential = potential, .effort = effort, .set = set, .error = error};
  bool dense = potential->n > 0 && potential->n <= STRUT_DENSE_STATICS;
  *set = (strut_critical_set){0};
  set_budget(&s);
  strut_stationary_set_start(&s.all, potential, &set->arena);
  s.status =
      strut_search_tasks_create(potential, effort->seed, dense && effort->saddles, &s.batch, error);
  search_known_shapes(&s);
  search_random_shapes(&s);
  if (dense) {
    search_folded_minima(&s);
    search_crossed_minima(&s);
    shake_rare_minima(&s);
  }
  set->climbs = dense && effort->saddles;
  if (set->climbs) find_saddles(&s);
  if (!s.status) estimate_missed(&s);
  if (!s.status) s.status = sort_into_set(&s);
  strut_search_tasks_free(s.batch);
  strut_stationary_set_free(&s.all);
  strut_release(s.hits);
  if (s.status) strut_critical_free(set);
  return s.status;
}

void strut_critical_free(strut_critical_set *set) {
  strut_arena_free(&set->arena);
  *set = (strut_critical_set){0};
}
