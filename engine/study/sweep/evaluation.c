/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/sweep/evaluation.h"

#include <math.h>
#include <string.h>

#include "engine/statics/rigidity/rigidity_parts.h"
#include "engine/study/sweep/evaluation_parts.h"
#include "engine/study/sweep/sweep_parts.h"

#ifdef _OPENMP
#include <omp.h>
#endif

struct strut_evaluator {
  const volatile sig_atomic_t *interrupt;
  int threads;
  strut_equilibrium_cache *equilibria;
  strut_sweep_plan plan; /* of the latest evaluation, which owns its results */
  strut_sweep_job job;
  strut_error error;
};

strut_evaluator *strut_evaluator_create(const volatile sig_atomic_t *interrupt, int threads) {
  strut_evaluator *e = strut_allocate(1, sizeof *e);
  if (!e) return NULL;
  e->interrupt = interrupt;
  e->threads = threads;
  e->equilibria = strut_equilibrium_cache_create();
  if (e->equilibria) return e;
  strut_release(e);
  return NULL;
}

void strut_evaluator_free(strut_evaluator *e) {
  if (!e) return;
  strut_sweep_plan_free(&e->plan);
  strut_equilibrium_cache_free(e->equilibria);
  strut_release(e);
}

/* The scene of the only point: the given one, which moves. */
static strut_status give_setup(void *context, const strut_study_value *values, strut_setup *setup,
                               strut_error *error) {
  strut_setup *given = context;
  (void)values;
  (void)error;
  *setup = *given;
  *given = (strut_setup){0};
  return STRUT_OK;
}

static bool allocate_cells(strut_sweep_plan *plan, strut_row_buffer *cells) {
  size_t count = plan->column_count + 1;
  cells->values = strut_arena_allocate(&plan->arena, 1, sizeof *cells->values);
  cells->numbers = strut_arena_allocate(&plan->arena, count, sizeof *cells->numbers);
  cells->words = strut_arena_allocate(&plan->arena, count, sizeof *cells->words);
  return cells->values && cells->numbers && cells->words;
}

/* Runs the point as a sweep would. False: memory is out. */
static bool compute(strut_evaluator *e, const strut_study *study) {
  const strut_sweep_options options = {.interrupt = e->interrupt};
  strut_sweep_worker worker = {.plan = &e->plan, .options = &options, .standing = e->equilibria};
  if (study->limit_time > 0.0) {
    worker.watch = strut_sweep_watch_create(study->limit_time, &e->job, 1, e->interrupt);
    if (!worker.watch) return false;
  }
#ifdef _OPENMP
  int before = omp_get_max_threads();
  omp_set_num_threads(e->threads);
#endif
  if (strut_sweep_job_begin(&worker, 0, &e->job)) strut_sweep_job_finish(&worker, &e->job);
#ifdef _OPENMP
  omp_set_num_threads(before);
#endif
  strut_sweep_watch_free(worker.watch);
  return true;
}

/* False: memory is out. */
static bool list_results(strut_evaluator *e, strut_evaluation *evaluation) {
  strut_arena *arena = &e->plan.arena;
  const strut_sweep_job *job = &e->job;
  size_t numbers = 0, words = 0;
  strut_evaluated *list = strut_arena_allocate(arena, e->plan.column_count + 1, sizeof *list);
  const char **warnings = strut_arena_allocate(arena, job->warning_count + 1, sizeof *warnings);
  if (!list || !warnings) return false;
  for (size_t i = 0; i < e->plan.column_count; i++) {
    const strut_slot_column *c = &e->plan.columns[i];
    list[i] = (strut_evaluated){.name = c->name, .unit = *c->unit ? c->unit : "1"};
    if (c->word)
      list[i].word = job->cells.words[words++];
    else
      list[i].number = job->cells.numbers[numbers++];
    if (!c->word && strcmp(c->name, STRUT_KEPT_COLUMN) == 0)
      evaluation->inaccurate = list[i].number == 0.0;
  }
  for (size_t i = 0; i < job->warning_count; i++) warnings[i] = job->warnings[i].text;
  evaluation->count = e->plan.column_count;
  evaluation->results = list;
  evaluation->warning_count = job->warning_count;
  evaluation->warnings = warnings;
  return true;
}

static strut_status no_memory(strut_evaluator *e, strut_evaluation *evaluation) {
  evaluation->status = strut_no_memory(&e->error, "");
  evaluation->message = e->error.message;
  return STRUT_OK;
}

strut_status strut_evaluate(strut_evaluator *e, const strut_study *study, strut_setup *setup,
                            strut_evaluation *evaluation) {
  const strut_sweep_scenes scenes = {.setup = give_setup, .context = setup};
  *evaluation = (strut_evaluation){0};
  e->error = (strut_error){0};
  e->job = (strut_sweep_job){0};
  strut_sweep_plan_free(&e->plan);
  strut_status status = strut_sweep_plan_of_setup(study, &scenes, setup, &e->plan, &e->error);
  if (!status && (!allocate_cells(&e->plan, &e->job.cells) || !compute(e, study)))
    status = strut_no_memory(&e->error, "");
  strut_setup_free(setup); /* nothing where the point had it */
  if (status) {
    evaluation->status = status;
    evaluation->message = e->error.message;
    return STRUT_OK;
  }
  if (e->job.status == STRUT_INTERRUPTED) return STRUT_INTERRUPTED;
  evaluation->status = e->job.status ? e->job.status : e->job.cells.row.status;
  evaluation->message =
      e->job.error.message[0] ? e->job.error.message : strut_status_text(evaluation->status);
  if (evaluation->status) return STRUT_OK;
  return list_results(e, evaluation) ? STRUT_OK : no_memory(e, evaluation);
}

static int32_t find_node(const strut_scene *scene, const char *name) {
  for (size_t i = 0; i < scene->node_count; i++)
    if (strcmp(scene->nodes[i].name, name) == 0) return (int32_t)i;
  return -1;
}

static const strut_configuration *find_configuration(const strut_scene *scene, const char *name) {
  for (size_t i = 0; i < scene->configuration_count; i++)
    if (strcmp(scene->configurations[i].name, name) == 0) return &scene->configurations[i];
  return NULL;
}

static strut_status check_node(const strut_scene *scene, const char *key, const char *name,
                               strut_error *error) {
  if (!name || find_node(scene, name) >= 0) return STRUT_OK;
  return strut_fail(error, STRUT_BAD_SCENE, "'%s' of the study: the model has no node '%.60s'", key,
                    name);
}

strut_status strut_goals_check(const strut_study *study, const strut_scene *scene,
                               strut_error *error) {
  strut_status status = check_node(scene, "stiffness_at", study->stiffness_node, error);
  for (size_t i = 0; i < study->shape_count && !status; i++)
    status = check_node(scene, "shape", study->shape_nodes[i], error);
  if (status || !study->like) return status;
  const strut_configuration *c = find_configuration(scene, study->like);
  if (!c)
    return strut_fail(error, STRUT_BAD_SCENE,
                      "'like' of the study: the model has no configuration '%.60s'", study->like);
  if (!c->shaped)
    return strut_fail(error, STRUT_BAD_SCENE,
                      "'like' of the study: configuration '%.60s' gives no positions of its shape",
                      study->like);
  return STRUT_OK;
}

/* The i-th pair of a node's place and of the place that is wanted; false: no such node. */
static bool find_pair(const strut_study *study, const strut_scene *scene,
                      const strut_configuration *like, const double *positions, size_t i,
                      double is[2], double wanted[2]) {
  int32_t node = like ? (int32_t)i : find_node(scene, study->shape_nodes[i]);
  if (node < 0) return false;
  memcpy(is, positions + 2 * node, 2 * sizeof *is);
  memcpy(wanted, like ? like->position[i] : study->shape[i], 2 * sizeof *wanted);
  return true;
}

double strut_goals_shape_distance(const strut_study *study, const strut_scene *scene,
                                  const double *positions) {
  const strut_configuration *like = study->like ? find_configuration(scene, study->like) : NULL;
  size_t count = like ? scene->node_count : study->like ? 0 : study->shape_count;
  double a[2], b[2], middle_a[2] = {0.0, 0.0}, middle_b[2] = {0.0, 0.0};
  double square = 0.0, dot = 0.0, cross = 0.0, n = (double)count;
  for (size_t i = 0; i < count; i++) {
    if (!find_pair(study, scene, like, positions, i, a, b)) return (double)NAN;
    for (int d = 0; d < 2; d++) middle_a[d] += a[d] / n, middle_b[d] += b[d] / n;
  }
  for (size_t i = 0; i < count; i++) {
    find_pair(study, scene, like, positions, i, a, b);
    for (int d = 0; d < 2; d++) a[d] -= middle_a[d], b[d] -= middle_b[d];
    dot += a[0] * b[0] + a[1] * b[1];
    cross += a[0] * b[1] - a[1] * b[0];
  }
  double size = hypot(dot, cross), c = size > 0.0 ? dot / size : 1.0;
  double s = size > 0.0 ? cross / size : 0.0;
  for (size_t i = 0; i < count; i++) {
    find_pair(study, scene, like, positions, i, a, b);
    for (int d = 0; d < 2; d++) a[d] -= middle_a[d], b[d] -= middle_b[d];
    double x = c * a[0] - s * a[1] - b[0], y = s * a[0] + c * a[1] - b[1];
    square += x * x + y * y;
  }
  return count ? sqrt(square / n) : (double)NAN;
}

/* The force that holds the displaced coordinate, at a displacement; NAN: not reached. */
static double force_at(const strut_path *path, double displacement) {
  for (size_t i = 0; i < path->point_count; i++) {
    const strut_path_point *p = &path->points[i], *before = i ? p - 1 : p;
    double u = p->factor, u0 = before->factor;
    double f = p->reaction[path->coordinate], f0 = before->reaction[path->coordinate];
    if (u == displacement) return f;
    if (i && (u0 - displacement) * (u - displacement) < 0.0)
      return f0 + (f - f0) * (displacement - u0) / (u - u0);
  }
  return (double)NAN;
}

double strut_goals_curve_distance(const strut_study *study, const strut_path *path) {
  double square = 0.0;
  if (path->coordinate < 0 || !study->curve_count) return (double)NAN;
  for (size_t i = 0; i < study->curve_count; i++) {
    double away = force_at(path, study->curve[i][0]) - study->curve[i][1];
    square += away * away;
  }
  return sqrt(square / (double)study->curve_count);
}

strut_status strut_goals_stiffness(const strut_study *study, const strut_model *model,
                                   const double *q, double *stiffness, strut_error *error) {
  strut_node_stiffness *s;
  const char *reason;
  int32_t node = study->stiffness_node ? find_node(model->scene, study->stiffness_node) : -1;
  *stiffness = (double)NAN;
  if (node < 0) return STRUT_OK;
  strut_status status = strut_node_stiffness_create(model, q, &s, &reason, error);
  if (status || !s) return status;
  const double direction[2] = {cos(study->stiffness_direction), sin(study->stiffness_direction)};
  *stiffness = strut_node_stiffness_along(s, node, direction);
  strut_node_stiffness_free(s);
  return STRUT_OK;
}
