/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One point of a sweep: its scene, its run, a second run for the check, and its row. */
#include <dirent.h>
#include <math.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "engine/output/file.h"
#include "engine/output/results.h"
#include "engine/output/run_report.h"
#include "engine/run/accuracy/accuracy.h"
#include "engine/scene/checks/check.h"
#include "engine/study/sweep/sweep_parts.h"

/* Records one run of a sweep as `strut run -o` does. */

typedef struct strut_sweep_record {
  strut_results results;
  char *text; /* of the scene */
  strut_sink *hdf5;
} strut_sweep_record;

static void discard(strut_sweep_record *record) {
  strut_hdf5_free(record->hdf5);
  strut_results_abandon(&record->results); /* does nothing once it is complete */
  strut_release(record->text);
  strut_release(record);
}

void strut_sweep_records_clear(const char *directory) {
  strut_arena arena = {0};
  char *runs = strut_arena_format(&arena, "%s/runs", directory);
  DIR *entries = runs ? opendir(runs) : NULL;
  for (struct dirent *entry = entries ? readdir(entries) : NULL; entry; entry = readdir(entries)) {
    if (entry->d_name[0] == '.') continue;
    char *path = strut_arena_format(&arena, "%s/%s", runs, entry->d_name);
    if (path && strut_stage_sweep(path)) rmdir(path); /* fails unless it is empty */
  }
  if (entries) closedir(entries);
  strut_arena_free(&arena);
}

/* Ends it: complete, or with a run that never began not at all. Frees it. */
static strut_status end_record(strut_sweep_record *record, const strut_scene *scene,
                               const strut_summary *summary, bool keep, strut_error *error) {
  strut_status status = STRUT_OK;
  if (keep) {
    char *json = strut_summary_json(summary, scene, false);
    if (!json) status = strut_no_memory(error, "");
    if (!status) status = strut_file_write_text(record->results.stage, "summary.json", json, error);
    if (!status) status = strut_results_commit(&record->results, error);
    strut_release(json);
  }
  discard(record);
  return status;
}

/* The clock of points: a thread that interrupts those that take longer than their study allows. */

typedef struct strut_sweep_watch {
  pthread_t thread;
  pthread_mutex_t lock; /* of `over` and of the jobs' deadlines */
  bool over;
  double seconds;
  strut_sweep_job *jobs; /* (count) */
  size_t count;
  const strut_flag *interrupt; /* of the sweep, or NULL */
} strut_sweep_watch;

/* True when the sweep is over. */
static bool look_at_jobs(strut_sweep_watch *watch) {
  pthread_mutex_lock(&watch->lock);
  bool over = watch->over, interrupted = watch->interrupt && *watch->interrupt;
  double now = strut_run_clock();
  for (size_t i = 0; i < watch->count; i++)
    if (interrupted || (watch->jobs[i].deadline > 0.0 && now > watch->jobs[i].deadline))
      watch->jobs[i].stop = 1;
  pthread_mutex_unlock(&watch->lock);
  return over;
}

static void *watch_jobs(void *context) {
  const struct timespec pause = {.tv_nsec = 20000000};
  while (!look_at_jobs(context)) nanosleep(&pause, NULL);
  return NULL;
}

strut_sweep_watch *strut_sweep_watch_create(double seconds, strut_sweep_job *jobs, size_t count,
                                            const strut_flag *interrupt) {
  strut_sweep_watch *watch = strut_allocate(1, sizeof *watch);
  if (!watch) return NULL;
  watch->seconds = seconds, watch->jobs = jobs, watch->count = count, watch->interrupt = interrupt;
  if (pthread_mutex_init(&watch->lock, NULL) == 0) {
    if (pthread_create(&watch->thread, NULL, watch_jobs, watch) == 0) return watch;
    pthread_mutex_destroy(&watch->lock);
  }
  strut_release(watch);
  return NULL;
}

void strut_sweep_watch_free(strut_sweep_watch *watch) {
  if (!watch) return;
  pthread_mutex_lock(&watch->lock);
  watch->over = true;
  pthread_mutex_unlock(&watch->lock);
  pthread_join(watch->thread, NULL);
  pthread_mutex_destroy(&watch->lock);
  strut_release(watch);
}

/* The time of a job begins. A NULL watch does nothing. */
static void begin_time(strut_sweep_watch *watch, strut_sweep_job *job) {
  if (!watch) return;
  pthread_mutex_lock(&watch->lock);
  job->stop = 0;
  job->deadline = strut_run_clock() + watch->seconds;
  pthread_mutex_unlock(&watch->lock);
}

/* It ends; true: it had passed. */
static bool end_time(strut_sweep_watch *watch, strut_sweep_job *job) {
  if (!watch) return false;
  pthread_mutex_lock(&watch->lock);
  bool passed = job->stop && !(watch->interrupt && *watch->interrupt);
  job->deadline = 0.0;
  pthread_mutex_unlock(&watch->lock);
  return passed;
}

/* ---- a point ---- */

/* The columns that a failed point leaves empty. */
static void pad_cells(const strut_sweep_plan *plan, strut_row_buffer *cells) {
  size_t words = 0;
  for (size_t i = 0; i < plan->column_count; i++) words += plan->columns[i].word;
  while (cells->word_count < words) strut_sweep_word(cells, "");
  while (cells->number_count < plan->column_count - words) strut_sweep_number(cells, (double)NAN);
}

const strut_flag *strut_sweep_interrupt_of(const strut_sweep_worker *worker,
                                           const strut_sweep_job *job) {
  return worker->watch ? &job->stop : worker->options->interrupt;
}

/* What an interrupted computation means: its own time has passed, or the sweep is interrupted. */
static strut_status explain_interrupt(const strut_sweep_worker *worker, strut_sweep_job *job,
                                      strut_status status) {
  bool passed = end_time(worker->watch, job);
  if (status != STRUT_INTERRUPTED || !passed) return status;
  return strut_fail(&job->error, STRUT_WORK_LIMIT,
                    "stopped after %.4g s by the clock, the study's limit: another machine may get "
                    "further",
                    worker->plan->study->limit.time);
}

/* Records the run into its own folder, as `strut run -o` does, if the study keeps trajectories; else *record is NULL. */
static strut_status begin_record(const strut_sweep_worker *worker, strut_sweep_job *job,
                                 strut_sweep_record **record) {
  const strut_scene *scene = &job->setup.scene;
  strut_error *error = &job->error;
  strut_arena arena = {0};
  *record = NULL;
  if (!worker->plan->study->trajectories || !worker->options->directory) return STRUT_OK;
  strut_sweep_record *self = strut_allocate(1, sizeof *self);
  char *text = self ? self->text = worker->plan->scenes.text(&job->setup) : NULL;
  char *path = strut_arena_format(&arena, "%s/runs/%09lld", worker->options->directory,
                                  (long long)job->point);
  strut_status status = STRUT_OK;
  if (!self || !text || !path) status = strut_no_memory(error, "");
  if (!status) status = strut_results_begin(&self->results, path, error);
  if (!status && !(self->hdf5 = strut_hdf5_create(self->results.stage, text, error)))
    status = error->status;
  if (!status) status = strut_file_write_text(self->results.stage, "scene.yaml", text, error);
  if (!status) status = strut_data_copy(scene->tables, scene->table_count, path, error);
  strut_arena_free(&arena);
  if (status && self) discard(self);
  if (status) return status;
  *record = self;
  job->sink = self->hdf5;
  job->options.sinks = &job->sink;
  job->options.sink_count = 1;
  return STRUT_OK;
}

/* The configuration that the run ended near; name: (STRUT_SLOT_WORD) */
static strut_status name_outcome(const strut_sweep_worker *worker, strut_sweep_job *job,
                                 const strut_summary *summary, char *name) {
  const strut_scene *scene = &job->setup.scene;
  int32_t index = -1;
  if (!strut_keep_has(&worker->plan->keep, STRUT_KEEP_OUTCOME) || !scene->configuration_count)
    return STRUT_OK;
  strut_status status = strut_equilibrium_cache_nearest(
      worker->standing, &job->setup, summary->end.positions, &index, &job->error);
  snprintf(name, STRUT_SLOT_WORD, "%s", index >= 0 ? scene->configurations[index].name : "other");
  return status;
}

static const char *outcome_word(const strut_sweep_plan *plan, const strut_summary *summary,
                                const char *outcome) {
  return plan->flips ? outcome : strut_motion_name(summary->steady.kind);
}

strut_status strut_sweep_run_scene(const strut_sweep_worker *worker, strut_sweep_job *job,
                                   bool first, strut_summary *summary) {
  const strut_experiment *experiment = &job->setup.experiment;
  strut_model *model = NULL;
  strut_status status = strut_model_compile(&job->setup.scene, &model, &job->error);
  if (!status)
    status = strut_simulate_as_asked(model, experiment, &job->options, summary, &job->error);
  if (first) strut_sweep_fill_counts(worker->plan, model, &job->cells);
  strut_model_free(model);
  return status;
}

void strut_sweep_warn(strut_sweep_job *job, const char *code, const char *format, ...) {
  if (job->warning_count == STRUT_MOST_WARNINGS) return;
  strut_warning *warning = &job->warnings[job->warning_count++];
  va_list arguments;
  warning->code = code;
  va_start(arguments, format);
  vsnprintf(warning->text, sizeof warning->text, format, arguments);
  va_end(arguments);
}

/* What `strut run` says of a scene before it runs it; and that a column asked for stays empty. */
static strut_status warn_of_scene(const strut_study *study, strut_sweep_job *job) {
  strut_findings found = {0};
  bool outcome = strut_keep_has(&study->keep, STRUT_KEEP_OUTCOME) ||
                 (study->refine.where && strcmp(study->refine.where, "outcome") == 0);
  if (outcome && !job->setup.scene.configuration_count)
    strut_sweep_warn(job, "outcome",
                     "'outcome' stays empty: the model has no configurations that a run could end "
                     "near");
  strut_status status = strut_setup_warn(&job->setup, &found);
  for (size_t i = 0; i < found.count; i++)
    strut_sweep_warn(job, found.items[i].key, "%s", found.items[i].message);
  strut_findings_free(&found);
  return status ? strut_no_memory(&job->error, "") : STRUT_OK;
}

/* The run of a point; word (STRUT_SLOT_WORD): what a second one is to repeat. */
static strut_status run_first(const strut_sweep_worker *worker, strut_sweep_job *job, char *word) {
  char outcome[STRUT_SLOT_WORD] = "";
  strut_summary summary = {0};
  strut_sweep_record *record = NULL;
  strut_status status = strut_equilibrium_cache_resolve(worker->standing, &job->setup, &job->error);
  if (!status) status = warn_of_scene(worker->plan->study, job);
  if (!status) status = begin_record(worker, job, &record);
  if (status) return status;
  status = strut_sweep_run_scene(worker, job, true, &summary);
  if (record) {
    strut_error late = {0};
    bool began = status == STRUT_OK || status == STRUT_DIVERGED;
    strut_status written = end_record(record, &job->setup.scene, &summary, began, &late);
    if (written) status = strut_fail(&job->error, written, "%s", late.message);
  }
  if (!status) status = name_outcome(worker, job, &summary, outcome);
  if (!status) {
    for (size_t i = 0; i < summary.warning_count; i++)
      strut_sweep_warn(job, summary.warnings[i].code, "%s", summary.warnings[i].text);
    strut_sweep_fill(worker->plan, &job->setup, &summary, outcome, &job->cells);
    status = strut_sweep_derive(worker, job);
    snprintf(word, STRUT_SLOT_WORD, "%s", outcome_word(worker->plan, &summary, outcome));
  }
  strut_summary_free(&summary);
  return status;
}

/* Refines the experiment for the check. */
static void refine_experiment(const strut_study *study, strut_experiment *experiment) {
  if (study->check_accuracy > 0.0) {
    experiment->accuracy = study->check_accuracy;
  } else if (experiment->accuracy > 0.0) {
    experiment->accuracy /= 2.0;
  } else {
    experiment->step /= 2.0;
    experiment->tolerance /= 10.0; /* of the adaptive method, which has its steps from it */
  }
}

/* Repeats the run more exactly. A second run that fails counts as another outcome. */
static strut_status run_again(const strut_sweep_worker *worker, strut_sweep_job *job,
                              const char *first) {
  char outcome[STRUT_SLOT_WORD] = "";
  strut_summary summary = {0};
  refine_experiment(worker->plan->study, &job->setup.experiment);
  job->options.sink_count = 0;
  job->error = (strut_error){0};
  strut_status status = strut_sweep_run_scene(worker, job, false, &summary);
  status = explain_interrupt(worker, job, status);
  if (!status) status = name_outcome(worker, job, &summary, outcome);
  const char *word = status ? "failed" : outcome_word(worker->plan, &summary, outcome);
  bool same = !status && strcmp(first, word) == 0;
  strut_sweep_number(&job->cells, status ? (double)NAN : summary.velocity);
  strut_sweep_word(&job->cells, word);
  strut_sweep_number(&job->cells, same ? 0.0 : 1.0);
  strut_summary_free(&summary);
  if (!strut_sweep_stops(status)) return STRUT_OK;
  return strut_fail(&job->error, status, "%s", strut_status_text(status));
}

static strut_status compute(const strut_sweep_worker *worker, strut_sweep_job *job) {
  const strut_sweep_plan *plan = worker->plan;
  char first[STRUT_SLOT_WORD] = "";
  bool run = plan->study->compute == STRUT_COMPUTE_RUN;
  strut_status status = run ? run_first(worker, job, first) : strut_statics_point(worker, job);
  if (!run && !status) status = strut_sweep_derive(worker, job);
  return run && !status && plan->check ? run_again(worker, job, first) : status;
}

void strut_sweep_compute(const strut_sweep_worker *worker, int64_t point, strut_sweep_job *job) {
  const strut_sweep_plan *plan = worker->plan;
  const strut_sweep_options *options = worker->options;
  strut_row_buffer *cells = &job->cells;
  cells->number_count = cells->word_count = 0;
  cells->message[0] = '\0';
  job->point = point;
  job->warning_count = 0;
  job->error = (strut_error){0};
  job->options = (strut_run_options){.interrupt = strut_sweep_interrupt_of(worker, job),
                                     .most_evaluations = plan->study->limit.evaluations};
  begin_time(worker->watch, job);
  strut_grid_values(plan->study, point, cells->values);
  if (options->values) options->values(options->point_context, point, cells->values);
  strut_sweep_axes(plan, cells->values, cells);
  strut_status status =
      plan->scenes.setup(plan->scenes.context, cells->values, &job->setup, &job->error);
  if (!status) {
    if (options->adjust) options->adjust(options->point_context, point, &job->setup);
    status = compute(worker, job);
    strut_setup_free(&job->setup);
  }
  status = explain_interrupt(worker, job, status);
  job->status = strut_sweep_stops(status) ? status : STRUT_OK;
  if (job->status) return;
  if (status) pad_cells(plan, cells);
  strut_sweep_end_row(cells, status, status ? &job->error : NULL);
}
