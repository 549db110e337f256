/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One thread's points of a sweep: alone, or side by side in the lanes of a batch. */
#include "engine/integrate/lanes/batch.h"
#include "engine/run/simulate_batch.h"
#include "engine/study/sweep/sweep_parts.h"

/* After so many points in a row that are unlike the batch's, another batch is begun. */
enum { MOST_UNLIKE = 4 };
/* Steps below which setting up a batch costs more than its lanes save. */
static const double FEWEST_STEPS = 200.0;

typedef struct desk {
  const strut_sweep_worker *worker;
  const strut_sweep_queue *queue;
  strut_sweep_job *jobs; /* (lanes) */
  int32_t lanes;
  strut_setup setup; /* of the example */
  strut_model *example;
  int unlike;
} desk;

/* A job that waits for its run, begun with the queue's next point if need be; NULL: there is none. */
static strut_sweep_job *next_job(desk *d) {
  strut_sweep_job *idle = NULL;
  int64_t point;
  for (int32_t i = 0; i < d->lanes; i++) {
    if (d->jobs[i].stage == STRUT_SWEEP_WAITING) return &d->jobs[i];
    if (d->jobs[i].stage == STRUT_SWEEP_IDLE) idle = &d->jobs[i];
  }
  while (idle && d->queue->next(d->queue->context, &point)) {
    if (strut_sweep_job_begin(d->worker, point, idle)) return idle;
    d->queue->over(d->queue->context, idle);
  }
  return NULL;
}

static void finish_alone(desk *d, strut_sweep_job *job) {
  strut_sweep_job_finish(d->worker, job);
  d->queue->over(d->queue->context, job);
}

/* Can its run be in lanes at all? Leaves it with a model then. */
static bool suits_lanes(strut_sweep_job *job) {
  const strut_experiment *e = &job->setup.experiment;
  const strut_integrator *method = strut_integrator_find(e->integrator);
  if (e->accuracy > 0.0 || !method || !strut_batch_knows(method)) return false;
  if (strut_experiment_span(e, &job->setup.scene).duration < FEWEST_STEPS * e->step) return false;
  return !strut_sweep_job_compile(job) && strut_batch_possible(job->model, method);
}

/* The next run for the batch. Points that no lane can take are run on the way. */
static bool next_run(void *context, strut_batch_point *run) {
  desk *d = context;
  for (strut_sweep_job *job; (job = next_job(d));) {
    if (!suits_lanes(job)) {
      finish_alone(d, job);
      continue;
    }
    bool alike = strut_lanes_alike(d->example, job->model);
    d->unlike = alike ? 0 : d->unlike + 1;
    if (d->unlike > MOST_UNLIKE) return false; /* it waits for the next batch */
    job->stage = STRUT_SWEEP_RUNNING;
    *run = (strut_batch_point){job->model, &job->setup.experiment, &job->options, job};
    return true;
  }
  return false;
}

static void take_result(void *context, const strut_batch_point *run, strut_status status,
                        strut_summary *summary, const strut_error *error) {
  desk *d = context;
  strut_sweep_job *job = run->context;
  if (!strut_sweep_job_take(d->worker, job, status, summary, error))
    d->queue->over(d->queue->context, job);
}

/* A model like the job's that stays. False: no memory for it. */
static bool make_example(desk *d, const strut_sweep_job *job) {
  const strut_sweep_scenes *scenes = &d->worker->plan->scenes;
  d->unlike = 0;
  if (scenes->setup(scenes->context, job->room.values, &d->setup, NULL)) return false;
  if (!strut_model_compile(&d->setup.scene, &d->example, NULL)) return true;
  strut_setup_free(&d->setup);
  return false;
}

static void run_batch(desk *d) {
  strut_simulate_batch(&(strut_batch_source){.context = d,
                                             .next = next_run,
                                             .result = take_result,
                                             .example = d->example,
                                             .integrator = d->setup.experiment.integrator,
                                             .width = d->lanes});
  strut_model_free(d->example);
  strut_setup_free(&d->setup);
  d->example = NULL;
}

void strut_sweep_work(const strut_sweep_worker *worker, const strut_sweep_queue *queue,
                      strut_sweep_job *jobs, int32_t lanes) {
  desk d = {.worker = worker, .queue = queue, .jobs = jobs, .lanes = lanes};
  for (strut_sweep_job *job; (job = next_job(&d));) {
    if (lanes > 1 && suits_lanes(job) && make_example(&d, job))
      run_batch(&d);
    else
      finish_alone(&d, job);
  }
}
