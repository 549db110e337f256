/* SPDX-License-Identifier: GPL-3.0-or-later */
/* strutlib_run: what `strut run` does, with the motion in memory. */
#include <string.h>

#include "engine/output/figures/run_figure.h"
#include "engine/output/json.h"
#include "engine/run/accuracy/accuracy.h"
#include "engine/run/simulate.h"
#include "engine/statics/equilibria/rest_state.h"
#include "parser/abi/handles.h"
#include "parser/abi/pictures.h"
#include "parser/command/fidelity_settings.h"
#include "parser/command/option_values.h"
#include "parser/command/run_settings.h"

/* No frame is left out: the caller decides how much is recorded. */
static const size_t ROOM = SIZE_MAX / 64;

typedef struct run_detail {
  abi_detail base;
  strut_summary summary;
  strut_trajectory motion;
} run_detail;

static void release(void *detail) {
  run_detail *run = detail;
  strut_summary_free(&run->summary);
  strut_trajectory_free(&run->motion);
  strut_release(run);
}

const strut_trajectory *abi_result_motion(const strutlib_result *result) {
  if (result->command != &abi_run_command) return NULL;
  const run_detail *run = result->detail;
  return run->motion.frames > 0 ? &run->motion : NULL;
}

/* ---- what is recorded ---- */

/* Of "position,force" the bits of one after the other. */
static strut_status read_channels(const strut_arguments *given, const char *text,
                                  unsigned *channels) {
  strut_arguments one = *given;
  const char *words[STRUT_CHANNEL_COUNT + 1] = {NULL};
  for (size_t i = 0; i < STRUT_CHANNEL_COUNT; i++) words[i] = strut_channel_at(i)->name;
  *channels = 0;
  while (*text) {
    char word[40];
    size_t length = strcspn(text, ",");
    int index = 0;
    size_t kept = length < sizeof word ? length : sizeof word - 1;
    memcpy(word, text, kept);
    word[kept] = '\0';
    one.texts[STRUT_OPTION_CHANNELS - STRUT_OPTION_TEXTS] = word;
    strut_status status =
        strut_option_word(&abi_run_command, &one, STRUT_OPTION_CHANNELS, words, &index);
    if (status != STRUT_OK) return status;
    *channels |= (unsigned)strut_channel_at((size_t)index)->id;
    text += length;
    if (*text) text++;
  }
  return STRUT_OK;
}

/* What the scene records and what the page and the figures show, unless the caller says. 0: nothing. */
static strut_status choose_channels(const strut_arguments *arguments, const strut_setup *setup,
                                    unsigned *channels) {
  static const char *const answers[] = {"yes", "no", NULL};
  const char *text = strut_option_text(arguments, STRUT_OPTION_CHANNELS);
  int answer = 0;
  *channels = setup->experiment.channels | strut_run_figure_channels(STRUT_RUN_OVERVIEW);
  strut_status status =
      strut_option_word(&abi_run_command, arguments, STRUT_OPTION_RECORD, answers, &answer);
  if (status == STRUT_OK && text) status = read_channels(arguments, text, channels);
  if (answer == 1) *channels = 0;
  return status;
}

/* ---- the run ---- */

static strut_status open_setup(abi_call *call, const strutlib_scene *scene,
                               strutlib_result *result) {
  const strut_arguments *arguments = &call->arguments;
  bool later = strut_option_text(arguments, STRUT_OPTION_ACCURACY) ||
               strut_option_text(arguments, STRUT_OPTION_STEP);
  strut_error what = {0};
  strut_status status = abi_setup(scene, later ? STRUT_FOR_RUN_STEP_LATER : STRUT_FOR_RUN,
                                  &result->setup, call->error);
  if (status != STRUT_OK) return status;
  result->opened = true;
  status = strut_resolve_start_equilibrium(&result->setup, &what);
  if (status == STRUT_OK)
    status = strut_run_settings_apply(&abi_run_command, arguments, &result->setup.experiment);
  if (status == STRUT_OK)
    status = strut_model_options_apply(&abi_run_command, arguments, &result->setup.scene);
  if (status == STRUT_OK) status = strut_model_compile(&result->setup.scene, &result->model, &what);
  if (status != STRUT_OK) abi_call_fail(call, status, &what);
  return status;
}

static void show_progress(void *context, double fraction) {
  strutlib_control *control = context;
  if (control->progress(control->context, fraction)) control->interrupt = 1;
}

static strut_status simulate(abi_call *call, const strutlib_result *result, run_detail *run,
                             strut_sink *sink, strut_error *what) {
  const strut_experiment *experiment = &result->setup.experiment;
  strut_sink *sinks[1] = {sink};
  const strut_run_options options = {
      .force = call->arguments.force,
      .interrupt = abi_interrupt_of(call->control),
      .progress = call->control && call->control->progress ? show_progress : NULL,
      .progress_context = call->control,
      .sinks = sinks,
      .sink_count = sink ? 1 : 0};
  return experiment->accuracy > 0.0
             ? strut_simulate_accurately(result->model, experiment, &options, &run->summary, what)
             : strut_simulate(result->model, experiment, &options, &run->summary, what);
}

/* ---- what it shows ---- */

static bool add_arrays(strutlib_result *result, const strut_trajectory *m) {
  const strut_channel_row *row;
  bool good = m->frames == 0 ||
              abi_result_add_array(result, "time", "s", m->time, 1, (const size_t[]){m->frames});
  for (size_t i = 0; good && m->frames && (row = strut_channel_at(i)) != NULL; i++) {
    const double *values = strut_trajectory_channel(m, row->id);
    const size_t shape[] = {m->frames, strut_channel_things(row, &result->setup.scene),
                            row->components};
    int dimensions = row->owner != STRUT_OWNER_SYSTEM && row->components > 1 ? 3 : 2;
    if (values)
      good = abi_result_add_array(result, row->name, row->unit, values, dimensions, shape);
  }
  return good;
}

static bool complete(strutlib_result *result, run_detail *run) {
  const strut_scene *scene = &result->setup.scene;
  result->json = strut_summary_json(&run->summary, scene, false);
  result->table = strut_summary_table(&run->summary, scene);
  for (size_t i = 0; i < run->summary.warning_count; i++)
    abi_add_warning(&result->messages, run->summary.warnings[i].text);
  return result->json && result->table && !result->messages.out_of_memory &&
         add_arrays(result, &run->motion);
}

static strut_status draw(const strutlib_result *result, const strut_arguments *arguments,
                         const char *path, strut_error *error) {
  const run_detail *run = result->detail;
  strut_run_figure figure = {.experiment = &result->setup.experiment};
  double times[ABI_MOST_TIMES];
  strut_status status = abi_run_figure_read(arguments, &figure, times);
  if (status != STRUT_OK) return status;
  unsigned needed = strut_run_figure_channels(figure.view);
  if (!run->motion.position || ((needed & STRUT_CHANNEL_FORCE) && !run->motion.force))
    return strut_fail(error, STRUT_USAGE, "the run has not recorded what the figure shows");
  return strut_run_figure_draw(path, &figure, result->model, &run->motion, &run->summary, error);
}

static bool has_results(strut_status status) {
  return status == STRUT_OK || status == STRUT_DIVERGED || status == STRUT_INTERRUPTED;
}

/* Runs what is open, and completes the result; sets the error of a run that ended early, too. */
static strut_status run_model(abi_call *call, strutlib_result *result) {
  run_detail *run = strut_allocate(1, sizeof *run);
  strut_error what = {0};
  strut_sink *sink = NULL;
  unsigned channels;
  if (!run) return (strut_status)abi_no_memory(call->error);
  run->base.release = release;
  result->detail = run;
  result->draw = draw;
  strut_status status = choose_channels(&call->arguments, &result->setup, &channels);
  if (status == STRUT_OK && channels) {
    sink = strut_trajectory_sink(&run->motion, &result->setup.scene, channels, ROOM);
    if (!sink) status = strut_no_memory(&what, "");
  }
  if (status == STRUT_OK) status = simulate(call, result, run, sink, &what);
  strut_trajectory_sink_free(sink);
  result->status = (int)status;
  if (status != STRUT_OK) abi_call_fail(call, status, &what);
  if (!has_results(status) || complete(result, run)) return status;
  if (call->error && *call->error) strutlib_error_free(*call->error);
  return (strut_status)abi_no_memory(call->error);
}

strutlib_result *strutlib_run(const strutlib_scene *scene, size_t count, const char *const *names,
                              const char *const *values, strutlib_control *control,
                              strutlib_error **error) {
  abi_call call;
  abi_enter(error);
  strutlib_result *result = abi_result_create(&abi_run_command, error);
  strut_status status = result ? STRUT_OK : STRUT_NO_MEMORY;
  if (status == STRUT_OK)
    status = abi_call_begin(&call, scene, &abi_run_command, count, names, values, control, error,
                            &result->messages);
  if (status == STRUT_OK) status = open_setup(&call, scene, result);
  bool begun = status == STRUT_OK;
  if (begun) status = run_model(&call, result);
  if (!begun || !has_results(status)) {
    strutlib_result_free(result);
    result = NULL;
  }
  abi_leave();
  return result;
}
