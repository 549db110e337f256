/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One point of a sweep: its scene, its run, once more for the check, its row. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/run/accuracy.h"
#include "engine/run/simulate.h"
#include "engine/study/grid.h"
#include "engine/study/sweep_parts.h"

/* What a run came to. */
typedef struct outcome {
  strut_summary summary;
  char name[STRUT_SLOT_WORD]; /* of the nearest configuration, or "" */
} outcome;

/* Does this end the sweep, instead of the point alone? */
static bool stops(strut_status status) {
  return status == STRUT_NO_MEMORY || status == STRUT_FILE_TROUBLE || status == STRUT_INTERRUPTED;
}

static strut_status simulate(const strut_scene *scene, const strut_run_options *options,
                             strut_summary *summary, strut_error *error) {
  strut_model *model = NULL;
  if (scene->experiment.accuracy > 0.0)
    return strut_simulate_accurately(scene, options, summary, error);
  strut_status status = strut_model_compile(scene, &model, error);
  if (!status) status = strut_simulate(model, options, summary, error);
  strut_model_free(model);
  return status;
}

static strut_status name_outcome(const strut_sweep_worker *w, const strut_scene *scene, outcome *o,
                                 strut_error *error) {
  int32_t index = -1;
  o->name[0] = '\0';
  if (!(w->plan->keep >> STRUT_KEEP_OUTCOME & 1u) || !scene->configuration_count) return STRUT_OK;
  strut_status status =
      strut_standing_nearest(w->standing, scene, o->summary.positions, &index, error);
  snprintf(o->name, sizeof o->name, "%s", index >= 0 ? scene->configurations[index].name : "other");
  return status;
}

/* As `strut run` does it, into a folder of its own where that is wanted. */
static strut_status run_once(const strut_sweep_worker *w, int64_t point, const strut_scene *scene,
                             bool record, outcome *o, strut_error *error) {
  strut_sweep_record *files = NULL;
  strut_sink *sinks[1] = {NULL};
  strut_run_options options = {.interrupt = w->options->interrupt};
  *o = (outcome){.name = ""};
  if (record) {
    char *text = w->plan->scenes.text(scene);
    if (!text) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
    files = strut_sweep_record_begin(w->options->directory, point, text, error);
    strut_release(text);
    if (!files) return error->status;
    sinks[0] = strut_sweep_record_sink(files);
    options.sinks = sinks;
    options.sink_count = 1;
  }
  strut_status status = simulate(scene, &options, &o->summary, error);
  bool began = status == STRUT_OK || status == STRUT_DIVERGED;
  if (files) {
    strut_error late = {0};
    strut_status written = strut_sweep_record_end(files, scene, &o->summary, began, &late);
    if (written) status = strut_fail(error, written, "%s", late.message);
  }
  return status ? status : name_outcome(w, scene, o, error);
}

/* The experiment of the check. */
static void refine(const strut_study *study, strut_experiment *e) {
  if (study->check_accuracy > 0.0) {
    e->accuracy = study->check_accuracy;
  } else if (e->accuracy > 0.0) {
    e->accuracy /= 2.0;
  } else {
    e->step /= 2.0;
    e->tolerance /= 10.0; /* of the adaptive method, which has its steps from it */
  }
}

static const char *told(const strut_sweep_worker *w, const outcome *o) {
  static const char *const kinds[] = {"", "periodic", "irregular", "transient"};
  return w->plan->flips ? o->name : kinds[o->summary.steady.kind];
}

/* A second run that fails has ended elsewhere. */
static strut_status check(const strut_sweep_worker *w, int64_t point, strut_scene *scene,
                          const outcome *first, strut_sweep_room *room) {
  outcome second;
  strut_error error = {0};
  refine(w->plan->study, &scene->experiment);
  strut_status status = run_once(w, point, scene, false, &second, &error);
  bool same = !status && strcmp(told(w, first), told(w, &second)) == 0;
  strut_sweep_number(room, status ? (double)NAN : second.summary.velocity);
  strut_sweep_word(room, status ? "failed" : told(w, &second));
  strut_sweep_number(room, same ? 0.0 : 1.0);
  strut_summary_free(&second.summary);
  return stops(status) ? status : STRUT_OK;
}

static strut_status run_point(const strut_sweep_worker *w, int64_t point, strut_scene *scene,
                              strut_sweep_room *room, strut_error *error) {
  outcome o;
  bool record = w->plan->study->trajectories && w->options->directory;
  strut_status status = strut_standing_resolve(w->standing, scene, error);
  if (status) return status;
  status = run_once(w, point, scene, record, &o, error);
  if (!status) strut_sweep_fill(w->plan, scene, &o.summary, o.name, room);
  if (!status && w->plan->check) {
    status = check(w, point, scene, &o, room);
    if (status) strut_fail(error, status, "%s", strut_status_text(status));
  }
  strut_summary_free(&o.summary);
  return status;
}

/* What is not known of a point that failed. */
static void pad(const strut_sweep_plan *plan, strut_sweep_room *room) {
  size_t words = 0;
  for (size_t i = 0; i < plan->column_count; i++) words += plan->columns[i].word;
  while (room->word_count < words) strut_sweep_word(room, "");
  while (room->number_count < plan->column_count - words) strut_sweep_number(room, (double)NAN);
}

strut_status strut_sweep_point(const strut_sweep_worker *w, int64_t point, strut_sweep_room *room,
                               strut_error *error) {
  const strut_sweep_plan *plan = w->plan;
  strut_scene scene;
  room->number_count = room->word_count = 0;
  room->message[0] = '\0';
  *error = (strut_error){0};
  strut_grid_values(plan->study, point, room->values);
  for (size_t i = 0; i < plan->axis_columns; i++) {
    if (plan->columns[i].word)
      strut_sweep_word(room, room->values[i].word);
    else
      strut_sweep_number(room, room->values[i].number);
  }
  strut_status status = plan->scenes.scene(plan->scenes.context, room->values, &scene, error);
  if (!status) {
    status = run_point(w, point, &scene, room, error);
    strut_scene_free(&scene);
  }
  if (stops(status)) return status;
  if (status) {
    pad(plan, room);
    snprintf(room->message, sizeof room->message, "%.*s", (int)sizeof room->message - 1,
             error->message);
  }
  room->row = (strut_slot){.status = status,
                           .numbers = room->numbers,
                           .words = (const char(*)[STRUT_SLOT_WORD])room->words,
                           .message = room->message};
  return STRUT_OK;
}
