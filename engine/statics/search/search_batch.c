/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/search/critical.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#ifdef _OPENMP
#include <omp.h>
#endif

#include "engine/base/mixed_bits.h"
#include "engine/model/pose.h"

/* Single nodes are folded across the line of one member of theirs and the next that leads away. */
enum { WHOLE = 2 };

typedef struct source {
  uint64_t seed, index, counter;
} source;

/* Bits of a generator that is a counter: the same for the same (seed, index, counter). */
static uint64_t next_bits(source *self) {
  uint64_t key = strut_mix_bits(self->seed + 0x9e3779b97f4a7c15u) ^
                 strut_mix_bits(self->index * 0xd1342543de82ef95u + 1);
  return strut_mix_bits(key + (self->counter += 1) * 0x9e3779b97f4a7c15u);
}

/* In [-1, 1). */
static double signed_unit(source *self) { return (double)(next_bits(self) >> 11) * 0x1p-52 - 1.0; }

static int64_t random_below(source *self, int64_t count) {
  assert(count > 0);
  return (int64_t)(next_bits(self) % (uint64_t)count);
}

int64_t strut_fold_count(const strut_potential *potential) {
  return WHOLE + 4 * (int64_t)potential->model->members.count;
}

static void set_node(const strut_potential *potential, double *positions, int32_t node,
                     const double at[2]) {
  for (int c = 0; c < 2; c++)
    if (potential->row_of[2 * node + c] >= 0) positions[2 * node + c] = at[c];
}

/* The mirror image of a node in the line through a with direction u (not of unit length). */
static void mirror_point(const double *at, const double *a, const double u[2], double image[2]) {
  double square = u[0] * u[0] + u[1] * u[1], dx = at[0] - a[0], dy = at[1] - a[1];
  double share = square > 0 ? (dx * u[0] + dy * u[1]) / square : 0.0;
  image[0] = a[0] + 2.0 * share * u[0] - dx;
  image[1] = a[1] + 2.0 * share * u[1] - dy;
}

/* All nodes on one side of a member's line go to the other. */
static void fold_side(const strut_potential *potential, int32_t member, double side,
                      double *positions) {
  const strut_member_table *members = &potential->model->members;
  double a[2] = {positions[members->from[member]], positions[members->from[member] + 1]};
  double u[2] = {positions[members->to[member]] - a[0], positions[members->to[member] + 1] - a[1]};
  for (int32_t i = 0; i < potential->model->node_count; i++) {
    double *at = positions + 2 * i, image[2];
    if (!(side * (u[0] * (at[1] - a[1]) - u[1] * (at[0] - a[0])) > 0)) continue;
    mirror_point(at, a, u, image);
    set_node(potential, positions, i, image);
  }
}

/* Mirrors one end of a member in the line through its other end and a further neighbour. */
static void flip_end(const strut_potential *potential, int32_t member, bool first,
                     double *positions) {
  const strut_member_table *members = &potential->model->members;
  uint32_t moved = first ? members->from[member] : members->to[member];
  uint32_t hinge = first ? members->to[member] : members->from[member];
  for (int32_t k = 1; k < members->count; k++) {
    int32_t j = (member + k) % members->count;
    if (members->from[j] != moved && members->to[j] != moved) continue;
    uint32_t other = members->from[j] == moved ? members->to[j] : members->from[j];
    if (other == hinge) continue;
    double u[2] = {positions[other] - positions[hinge],
                   positions[other + 1] - positions[hinge + 1]},
           image[2];
    mirror_point(positions + moved, positions + hinge, u, image);
    set_node(potential, positions, (int32_t)(moved / 2), image);
    return;
  }
}

static void mirror_whole(const strut_potential *potential, int axis, double *positions) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (int32_t i = 0; i < potential->model->node_count; i++) {
    low = fmin(low, positions[2 * i + axis]);
    high = fmax(high, positions[2 * i + axis]);
  }
  for (int32_t i = 0; i < potential->model->node_count; i++)
    if (potential->row_of[2 * i + axis] >= 0)
      positions[2 * i + axis] = low + high - positions[2 * i + axis];
}

/* q (length) becomes fold number `fold` of itself; held coordinates stay. */
static void strut_fold(const strut_potential *potential, int64_t fold, double *positions) {
  assert(fold >= 0 && fold < strut_fold_count(potential));
  if (fold < WHOLE) {
    mirror_whole(potential, (int)fold, positions);
    return;
  }
  int32_t member = (int32_t)((fold - WHOLE) / 4), variant = (int32_t)((fold - WHOLE) % 4);
  if (variant < 2)
    fold_side(potential, member, variant == 0 ? 1.0 : -1.0, positions);
  else
    flip_end(potential, member, variant == 2, positions);
}

/* Nodes anywhere in a box about the middle of the start. */
static void scatter_nodes(const strut_potential *potential, source *self, double half,
                          double *positions) {
  const strut_model *model = potential->model;
  double middle[2] = {0.0, 0.0};
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    middle[at % 2] += model->start[at] / model->node_count;
  for (int32_t i = 0; i < potential->n; i++) {
    int32_t at = potential->coordinate[i];
    positions[at] = middle[at % 2] + half * signed_unit(self);
  }
}

static void shake_nodes(const strut_potential *potential, source *self, double by,
                        double *positions) {
  for (int32_t i = 0; i < potential->n; i++)
    positions[potential->coordinate[i]] += by * signed_unit(self);
}

/* Random shape number `index` of `seed`: positions at random, or a shaken or folded start. */
static void random_shape(const strut_potential *potential, uint64_t seed, uint64_t index,
                         double *positions) {
  source s = {seed, index, 0};
  double size = potential->model->size > 0 ? potential->model->size : 1.0;
  memcpy(positions, potential->model->start, (size_t)potential->model->length * sizeof *positions);
  int64_t kind = random_below(&s, 4);
  double part = 0.65 + 0.35 * signed_unit(&s); /* 0.3 to 1 */
  if (kind < 2) {
    scatter_nodes(potential, &s, size * part, positions);
  } else if (kind == 2) {
    shake_nodes(potential, &s, size * part / (double)(1 << random_below(&s, 5)), positions);
  } else {
    for (int64_t folds = 1 + random_below(&s, 3); folds > 0; folds--)
      strut_fold(potential, random_below(&s, strut_fold_count(potential)), positions);
    shake_nodes(potential, &s, 0.02 * size, positions);
  }
}

/* q shaken by a random part of the structure's size, from a hundredth to a half. */
static void shake(const strut_potential *potential, uint64_t seed, uint64_t index,
                  double *positions) {
  source s = {seed, index, 0};
  double size = potential->model->size > 0 ? potential->model->size : 1.0;
  double part = 0.375 + 0.125 * signed_unit(&s); /* a quarter to a half */
  shake_nodes(potential, &s, size * part / (double)(1 << random_below(&s, 5)), positions);
}

/*
 * Replaces nodes of q by those of `other`, chosen by the bits of random number `index` of `seed`.
 */
static void cross(const strut_potential *potential, uint64_t seed, uint64_t index,
                  const double *other, double *positions) {
  source s = {seed, index, 0};
  for (int32_t i = 0; i < potential->model->node_count; i++)
    if (random_below(&s, 2)) set_node(potential, positions, i, other + 2 * i);
}

/* Climbs and crossings draw from numbers of their own. */
static const uint64_t CLIMBS = 0x5ad1e5u, CROSSES = 0xc0551u;

typedef struct worker {
  strut_minimiser *minimiser;
  strut_climber *climber;
  double *direction; /* (n) */
} worker;

struct strut_search_tasks {
  const strut_potential *potential;
  uint64_t seed;
  int worker_count;
  worker *workers;
  strut_task_result result[STRUT_BATCH];
  strut_arena arena;
};

static int thread_count(void) {
#ifdef _OPENMP
  int most = omp_in_parallel() ? 1 : omp_get_max_threads();
  return most < STRUT_BATCH ? most : STRUT_BATCH;
#else
  return 1;
#endif
}

strut_status strut_search_tasks_create(const strut_potential *potential, uint64_t seed, bool climbs,
                                       strut_search_tasks **batch, strut_error *error) {
  strut_search_tasks *tasks = *batch = strut_allocate(1, sizeof *tasks);
  size_t length = (size_t)potential->model->length;
  if (!tasks) return strut_no_memory(error, "");
  tasks->potential = potential;
  tasks->seed = seed;
  tasks->worker_count = thread_count();
  tasks->workers =
      strut_arena_allocate(&tasks->arena, (size_t)tasks->worker_count, sizeof *tasks->workers);
  bool good = tasks->workers != NULL;
  for (int i = 0; i < STRUT_BATCH && good; i++)
    good = (tasks->result[i].q = strut_arena_allocate(&tasks->arena, length, sizeof(double)));
  for (int i = 0; i < tasks->worker_count && good; i++) {
    worker *self = &tasks->workers[i];
    self->direction =
        strut_arena_allocate(&tasks->arena, (size_t)potential->n, sizeof *self->direction);
    good = self->direction &&
           strut_minimiser_create(potential, &tasks->arena, &self->minimiser, NULL) == STRUT_OK;
    if (good && climbs)
      good = (self->climber = strut_climber_create(potential, self->minimiser, &tasks->arena));
  }
  if (good) return STRUT_OK;
  strut_search_tasks_free(tasks);
  *batch = NULL;
  return strut_no_memory(error, "");
}

void strut_search_tasks_free(strut_search_tasks *batch) {
  if (!batch) return;
  strut_arena_free(&batch->arena);
  strut_release(batch);
}

/* Shift along x that brings b over a; 0 if something holds the structure along x. */
static double slide_onto(const strut_potential *potential, const double *first,
                         const double *second) {
  double sum = 0.0;
  int32_t nodes = potential->model->node_count;
  for (int32_t i = 0; i < nodes; i++) {
    if (potential->row_of[2 * i] < 0 || potential->force[2 * i] != 0.0) return 0.0;
    sum += first[2 * i] - second[2 * i];
  }
  if (potential->ground && potential->model->contacts.count &&
      !strut_contacts_are_level(&potential->model->contacts))
    return 0.0;
  return nodes ? sum / nodes : 0.0;
}

/* The highest of seven points on the straight line from a to b. */
static void highest_between(const strut_potential *potential, const double *first,
                            const double *second, double *positions) {
  size_t length = (size_t)potential->model->length;
  double highest = -HUGE_VAL, best = 0.5, slide = slide_onto(potential, first, second);
  for (int k = 1; k <= 8; k++) { /* the eighth time for good */
    double t = k < 8 ? k / 8.0 : best;
    for (size_t i = 0; i < length; i++)
      positions[i] = first[i] + t * (second[i] + (i % 2 ? 0.0 : slide) - first[i]);
    double value = strut_potential_value(potential, positions);
    if (k < 8 && value > highest) highest = value, best = t;
  }
}

static bool climb_task(const strut_search_tasks *tasks, worker *self, const strut_task *task,
                       double *positions) {
  assert(self->climber);
  const strut_potential *potential = tasks->potential;
  double far = 0.02 * (potential->model->size > 0 ? potential->model->size : 1.0);
  size_t bytes = (size_t)potential->model->length * sizeof *positions;
  if (task->kind == STRUT_TASK_CLIMB_MODE) {
    memcpy(positions, task->q, bytes);
    return strut_climb_away(self->climber, (int32_t)task->number, task->side * far, positions,
                            self->direction) &&
           strut_climb(self->climber, 1, self->direction, positions);
  }
  int32_t index = 1;
  if (task->kind == STRUT_TASK_CLIMB_PAIR) {
    highest_between(potential, task->q, task->other, positions);
  } else if (task->kind == STRUT_TASK_CLIMB_SHAPE) {
    memcpy(positions, task->q, bytes);
  } else if (task->q) {
    memcpy(positions, task->q, bytes);
    shake(potential, tasks->seed ^ CLIMBS, (uint64_t)task->number, positions);
  } else {
    random_shape(potential, tasks->seed ^ CLIMBS, (uint64_t)task->number, positions);
    index = 1 + (int32_t)(task->number / 2 % (potential->n < 4 ? potential->n : 4));
  }
  return index <= potential->n && strut_climb(self->climber, index, NULL, positions);
}

static strut_descent_end descend_task(const strut_search_tasks *tasks, worker *self,
                                      const strut_task *task, double *positions) {
  const strut_potential *potential = tasks->potential;
  if (task->kind == STRUT_TASK_RANDOM)
    random_shape(potential, tasks->seed, (uint64_t)task->number, positions);
  else
    memcpy(positions, task->q, (size_t)potential->model->length * sizeof *positions);
  if (task->kind == STRUT_TASK_FOLD) strut_fold(potential, task->number, positions);
  if (task->kind == STRUT_TASK_CROSS) {
    cross(potential, tasks->seed ^ CROSSES, (uint64_t)task->number, task->other, positions);
    return strut_descend_gently(self->minimiser, positions);
  }
  if (task->kind == STRUT_TASK_SHAKE) {
    shake(potential, tasks->seed ^ CROSSES, (uint64_t)task->number, positions);
    return strut_descend_gently(self->minimiser, positions);
  }
  if (task->kind != STRUT_TASK_DOWN) return strut_minimise(self->minimiser, positions).end;
  return strut_descend_along(self->minimiser, task->other, task->side, positions)
             ? STRUT_DESCENT_REACHED
             : STRUT_DESCENT_EXHAUSTED;
}

static int64_t hessians_of(const worker *self) {
  return strut_minimiser_hessian_count(self->minimiser) +
         (self->climber ? strut_climber_hessian_count(self->climber) : 0);
}

static void run_task(strut_search_tasks *tasks, worker *self, const strut_task *task,
                     strut_task_result *result) {
  bool up = task->kind >= STRUT_TASK_CLIMB_MODE && task->kind <= STRUT_TASK_CLIMB_RANDOM;
  int64_t before = hessians_of(self);
  if (up)
    result->end =
        climb_task(tasks, self, task, result->q) ? STRUT_DESCENT_REACHED : STRUT_DESCENT_EXHAUSTED;
  else
    result->end = descend_task(tasks, self, task, result->q);
  result->hessian_count = hessians_of(self) - before;
}

const strut_task_result *strut_search_tasks_run(strut_search_tasks *batch, const strut_task *task,
                                                size_t count, const strut_flag *interrupt) {
  assert(count <= STRUT_BATCH);
#ifdef _OPENMP
  int threads = (int)count < batch->worker_count ? (int)count : batch->worker_count;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) if (threads > 1)
#endif
  for (size_t i = 0; i < count; i++) {
#ifdef _OPENMP
    worker *self = &batch->workers[omp_get_thread_num()];
#else
    worker *self = &batch->workers[0];
#endif
    if (!interrupt || !*interrupt) run_task(batch, self, &task[i], &batch->result[i]);
  }
  return batch->result;
}
