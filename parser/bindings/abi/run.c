/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs: strutlib_run does what `strut run` does, with the motion in memory; a simulation is advanced from outside. */
#include <math.h>
#include <string.h>

#include "engine/output/run_report.h"
#include "engine/run/accuracy/accuracy.h"
#include "engine/run/simulate.h"
#include "engine/run/stepping.h"
#include "engine/scene/things.h"
#include "parser/bindings/abi/handles.h"
#include "parser/program/command/arguments.h"
#include "parser/program/command/scene_options.h"

/* No frame is left out: the caller decides how much is recorded. */
static const size_t ROOM = SIZE_MAX / 64;

typedef struct run_detail {
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

/* What the scene records and what the page and the figures show, unless the caller says. 0: nothing. */
static strut_channels choose_channels(const strut_arguments *arguments, const strut_setup *setup) {
  if (arguments->record.index == 1) return 0;
  if (arguments->channels.text) return arguments->channels.set; /* bits in the table's order */
  return setup->experiment.channels | strut_run_figure_channels(STRUT_RUN_OVERVIEW);
}

/* ---- the run ---- */

/* The scene as it is run with the options of the call; *opened: there is a setup, also after a failure. */
static strut_status open_setup(abi_call *call, strut_setup *setup, bool *opened) {
  strut_status status =
      abi_setup(call->scene, strut_run_options_purpose(&call->arguments), setup, call->error);
  *opened = status == STRUT_OK;
  if (status == STRUT_OK) status = strut_resolve_start_equilibrium(setup, &call->what);
  return status ? status : strut_run_options_apply(&call->arguments, setup);
}

static void show_progress(void *context, double fraction) { abi_progress(context, fraction); }

static strut_status simulate(abi_call *call, const strutlib_result *result, strut_sink *sink) {
  run_detail *run = result->detail;
  strut_sink *sinks[1] = {sink};
  const strut_run_options options = {
      .force = call->arguments.force,
      .interrupt = abi_interrupt_of(call->control),
      .progress = call->control && call->control->progress ? show_progress : NULL,
      .progress_context = call->control,
      .sinks = sinks,
      .sink_count = sink ? 1 : 0};
  strut_varied_scenes scenes = {.file = call->scene->source->name,
                                .source = call->scene->source->tree,
                                .purpose = strut_run_options_purpose(&call->arguments)};
  strut_status status = strut_simulate_as_asked(result->model, &result->setup.experiment, &options,
                                                &run->summary, &call->what);
  return status ? status
                : strut_varied_scenes_derive(&call->arguments, &scenes, &result->setup,
                                             options.interrupt, &run->summary, &call->what);
}

/* ---- what it shows ---- */

static bool add_arrays(abi_arrays *list, const strut_trajectory *trajectory,
                       const strut_scene *scene) {
  const strut_channel_row *row;
  if (trajectory->frames == 0) return true;
  abi_array array = abi_array_of("time", "s", trajectory->time, 1, &trajectory->frames);
  bool good = abi_add_array(list, &array);
  for (size_t i = 0; good && (row = strut_channel_at(i)) != NULL; i++) {
    const double *values = strut_trajectory_channel(trajectory, row->id);
    const size_t shape[] = {trajectory->frames, strut_channel_things(row, scene), row->components};
    int dimensions = !strut_channel_is_whole(row) && row->components > 1 ? 3 : 2;
    array = abi_array_of(row->name, row->unit, values, dimensions, shape);
    good = !values || abi_add_array(list, &array);
  }
  return good;
}

static bool complete(strutlib_result *result, abi_messages *messages) {
  const strut_scene *scene = &result->setup.scene;
  const run_detail *run = result->detail;
  result->json = strut_summary_json(&run->summary, scene, false);
  result->table = strut_summary_table(&run->summary, scene, 0);
  for (size_t i = 0; i < run->summary.warning_count; i++)
    abi_add_warning(messages, run->summary.warnings[i].text);
  return result->json && result->table && !messages->out_of_memory &&
         add_arrays(&result->arrays, &run->motion, scene);
}

static strut_status draw(const strutlib_result *result, const strut_arguments *arguments,
                         const char *path, strut_error *error) {
  const run_detail *run = result->detail;
  strut_run_figure figure = {.experiment = &result->setup.experiment};
  double times[STRUT_MOST_TIMES];
  strut_status status = abi_plot_read(arguments, path, &figure.plot);
  if (status == STRUT_OK) status = strut_run_figure_read(arguments, &figure, times);
  if (status != STRUT_OK) return status;
  unsigned needed = strut_run_figure_channels(figure.view);
  if (!run->motion.position || ((needed & STRUT_CHANNEL_FORCE) && !run->motion.force))
    return strut_fail(error, STRUT_USAGE, "the run has not recorded what the figure shows");
  return strut_run_figure_draw(&figure, result->model, &run->motion, &run->summary, error);
}

/* A model of the result's setup, and a sink for what is recorded, if anything is. */
static strut_status prepare(const strut_arguments *arguments, strutlib_result *result,
                            strut_sink **sink, strut_error *what) {
  run_detail *run = strut_allocate(1, sizeof *run);
  if (!run) return strut_no_memory(what, "");
  result->release = release;
  result->detail = run;
  result->draw = draw;
  const strut_channels channels = choose_channels(arguments, &result->setup);
  strut_status status = strut_model_compile(&result->setup.scene, &result->model, what);
  if (status == STRUT_OK && channels) {
    *sink = strut_trajectory_sink(&run->motion, &result->setup.scene, channels, ROOM);
    if (!*sink) status = strut_no_memory(what, "");
  }
  return status;
}

/* Of a run that ended early there is a result, too. */
static strut_status run(abi_call *call, strutlib_result *result) {
  strut_sink *sink = NULL;
  strut_status status = open_setup(call, &result->setup, &result->opened);
  if (status == STRUT_OK) status = prepare(&call->arguments, result, &sink, &call->what);
  if (status != STRUT_OK) return status;
  status = simulate(call, result, sink);
  strut_trajectory_sink_free(sink);
  if (!strut_run_has_results(status)) return status;
  call->complete = complete(result, &call->messages);
  return call->complete ? status : strut_no_memory(&call->what, "");
}

ABI_CALL(run, run)

/* A run that is advanced from outside. */

struct strutlib_simulation {
  strut_setup setup; /* of the stepping, which refers to it */
  bool opened;
  strut_stepping *stepping;
  strutlib_result *recorded; /* the run that it becomes, or NULL */
  strut_sink *sink;          /* of its motion */
};

/* The result has a scene and a model of its own, since inputs change those of the simulation. */
static strut_status begin_recording(abi_call *call, strutlib_simulation *simulation) {
  strutlib_result *result = simulation->recorded = abi_result_create(&abi_run_command);
  if (!result) return STRUT_NO_MEMORY;
  strut_status status = open_setup(call, &result->setup, &result->opened);
  return status ? status : prepare(&call->arguments, result, &simulation->sink, &call->what);
}

static strut_status begin(abi_call *call, strutlib_simulation *simulation) {
  const strut_given_word *record = &call->arguments.record;
  bool records = record->text ? record->index == 0 : call->arguments.channels.text != NULL;
  strut_status status = open_setup(call, &simulation->setup, &simulation->opened);
  if (status == STRUT_OK && records) status = begin_recording(call, simulation);
  if (status != STRUT_OK) return status;
  return strut_stepping_create(&simulation->setup, call->arguments.force,
                               abi_interrupt_of(call->control), simulation->sink,
                               &simulation->stepping, &call->what);
}

strutlib_simulation *strutlib_simulation_open(const strutlib_scene *scene, size_t count,
                                              const char *const *names, const char *const *values,
                                              strutlib_control *control, strutlib_error **error) {
  if (abi_lacks(error, scene, "scene")) return NULL;
  abi_call call = abi_call_of(scene, &abi_simulation_command, control, error);
  abi_enter(error);
  strutlib_simulation *simulation = strut_allocate(1, sizeof *simulation);
  strut_status status = STRUT_NO_MEMORY;
  if (simulation) status = abi_call_begin(&call, &(abi_pairs){count, names, values});
  if (status == STRUT_OK) status = begin(&call, simulation);
  abi_call_leave(&call, status);
  abi_messages_free(&call.messages);
  if (status == STRUT_OK) return simulation;
  strutlib_simulation_close(simulation);
  return NULL;
}

void strutlib_simulation_close(strutlib_simulation *simulation) {
  if (!simulation) return;
  strut_stepping_free(simulation->stepping);
  strut_trajectory_sink_free(simulation->sink);
  strutlib_result_free(simulation->recorded);
  if (simulation->opened) strut_setup_free(&simulation->setup);
  strut_release(simulation);
}

int strutlib_simulation_advance(strutlib_simulation *simulation, long steps,
                                strutlib_error **error) {
  strut_error what;
  if (abi_lacks(error, simulation, "simulation")) return STRUTLIB_USAGE;
  if (error) *error = NULL;
  what.message[0] = '\0'; /* a step is short: nothing more is cleared */
  strut_status status = strut_stepping_advance(simulation->stepping, steps, &what);
  return status == STRUT_OK ? STRUTLIB_OK : abi_fail_with(error, status, &what);
}

strutlib_result *strutlib_simulation_finish(strutlib_simulation *simulation,
                                            strutlib_error **error) {
  if (abi_lacks(error, simulation, "simulation")) return NULL;
  strutlib_result *result = simulation->recorded;
  if (!result) {
    abi_fail(error, STRUTLIB_USAGE, "the simulation records nothing, or was finished before");
    return NULL;
  }
  abi_enter(error);
  simulation->recorded = NULL;
  run_detail *detail = result->detail;
  result->status = (int)strut_stepping_finish(simulation->stepping, &detail->summary);
  bool kept = complete(result, &result->messages);
  abi_leave(error, kept ? STRUT_OK : STRUT_NO_MEMORY, NULL);
  if (kept) return result;
  strutlib_result_free(result);
  return NULL;
}

#define OF_SIMULATION(PART)                                                                        \
  double strutlib_simulation_##PART(const strutlib_simulation *simulation) {                       \
    return simulation ? strut_stepping_##PART(simulation->stepping) : (double)NAN;                 \
  }
OF_SIMULATION(time)
OF_SIMULATION(step)
OF_SIMULATION(input_work)

/* ---- arrays ---- */

static int show(size_t items, size_t components, int *dimensions, size_t *shape, size_t *stride) {
  const double *unused;
  const size_t both[] = {items, components};
  const abi_array array = abi_array_of("", "", NULL, components > 1 ? 2 : 1, both);
  return abi_show_array(&array, &unused, dimensions, shape, stride);
}

int strutlib_simulation_array(strutlib_simulation *simulation, const char *name,
                              const double **data, int *dimensions, size_t *shape, size_t *stride) {
  if (!simulation || !name || !data || !dimensions || !shape || !stride) return 0;
  const strut_channel_row *row = strut_channel_named(name);
  if (!row || !strut_stepping_channel(simulation->stepping, row->id, data)) return 0;
  bool of_system = strut_channel_is_whole(row); /* its components are the things */
  return show(strut_channel_things(row, &simulation->setup.scene), of_system ? 1 : row->components,
              dimensions, shape, stride);
}

/* A strut_input; STRUT_INPUTS where none has the name. */
static int input_named(const char *name) {
  static const char *const names[STRUT_INPUTS] = {"rest", "actuators", "load", "rates"};
  int i = 0;
  while (i < STRUT_INPUTS && strcmp(names[i], name) != 0) i++;
  return i;
}

int strutlib_simulation_input(strutlib_simulation *simulation, const char *name, double **data,
                              int *dimensions, size_t *shape, size_t *stride) {
  if (!simulation || !name || !data || !dimensions || !shape || !stride) return 0;
  int input = input_named(name);
  size_t count, components = input == STRUT_INPUT_LOAD ? 2 : 1;
  *data = input < STRUT_INPUTS
              ? strut_stepping_input(simulation->stepping, (strut_input)input, &count)
              : NULL;
  return *data ? show(count / components, components, dimensions, shape, stride) : 0;
}

/* Index of "m8", "drive" or "n1.x" in an input, or -1. */
static long index_of(const strut_scene *scene, int input, const char *name) {
  if (input == STRUT_INPUT_REST) return strut_thing_find(scene, STRUT_THING_MEMBER, name);
  if (input != STRUT_INPUT_LOAD) return strut_thing_find(scene, STRUT_THING_ACTUATOR, name);
  for (size_t i = 0; i < scene->node_count; i++) {
    size_t length = strlen(scene->nodes[i].name);
    if (strncmp(name, scene->nodes[i].name, length) != 0) continue;
    if (strcmp(name + length, ".x") == 0) return (long)(2 * i);
    if (strcmp(name + length, ".y") == 0) return (long)(2 * i + 1);
  }
  return -1;
}

int strutlib_simulation_set(strutlib_simulation *simulation, const char *input, const char *name,
                            double value, strutlib_error **error) {
  size_t count;
  if (abi_lacks(error, simulation, "simulation") || abi_lacks(error, input, "input") ||
      abi_lacks(error, name, "name"))
    return STRUTLIB_USAGE;
  if (error) *error = NULL;
  int which = input_named(input);
  if (which == STRUT_INPUTS)
    return abi_fail(error, STRUTLIB_USAGE,
                    "there is no input '%s'; expected rest, actuators, load or rates", input);
  long index = index_of(&simulation->setup.scene, which, name);
  if (index < 0) return abi_fail(error, STRUTLIB_USAGE, "input '%s' has no '%s'", input, name);
  double *data = strut_stepping_input(simulation->stepping, (strut_input)which, &count);
  if (!data) return abi_no_memory(error);
  data[index] = value;
  return STRUTLIB_OK;
}

/* ---- snapshots: strutlib_snapshot is the engine's own ---- */

strutlib_snapshot *strutlib_simulation_snapshot(const strutlib_simulation *simulation,
                                                strutlib_error **error) {
  if (abi_lacks(error, simulation, "simulation")) return NULL;
  if (error) *error = NULL;
  strut_stepping_snapshot *stored = strut_stepping_store(simulation->stepping);
  if (!stored) abi_no_memory(error);
  return (strutlib_snapshot *)stored;
}

int strutlib_simulation_restore(strutlib_simulation *simulation, const strutlib_snapshot *snapshot,
                                strutlib_error **error) {
  if (abi_lacks(error, simulation, "simulation") || abi_lacks(error, snapshot, "snapshot"))
    return STRUTLIB_USAGE;
  if (error) *error = NULL;
  if (!strut_stepping_restore(simulation->stepping, (const strut_stepping_snapshot *)snapshot))
    return abi_fail(error, STRUTLIB_USAGE, "the snapshot is of another simulation");
  if (simulation->recorded) {
    run_detail *run = simulation->recorded->detail;
    strut_trajectory_cut(&run->motion, (size_t)strut_stepping_recorded(simulation->stepping));
  }
  return STRUTLIB_OK;
}

void strutlib_snapshot_free(strutlib_snapshot *snapshot) {
  strut_stepping_snapshot_free((strut_stepping_snapshot *)snapshot);
}
