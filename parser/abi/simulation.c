/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run that is advanced from outside. */
#include <math.h>
#include <string.h>

#include "engine/run/stepping.h"
#include "engine/statics/equilibria/rest_state.h"
#include "parser/abi/handles.h"
#include "parser/command/fidelity_settings.h"
#include "parser/command/option_values.h"
#include "parser/command/run_settings.h"

struct strutlib_simulation {
  strut_setup setup; /* of the stepping, which refers to it */
  bool opened;
  strut_stepping *stepping;
};

struct strutlib_snapshot {
  strut_stepping_snapshot *stored;
};

static strut_status open_setup(abi_call *call, const strutlib_scene *scene,
                               strutlib_simulation *simulation) {
  const strut_arguments *arguments = &call->arguments;
  strut_setup *setup = &simulation->setup;
  strut_error what = {0};
  bool later = strut_option_text(arguments, STRUT_OPTION_STEP) != NULL;
  strut_status status =
      abi_setup(scene, later ? STRUT_FOR_RUN_STEP_LATER : STRUT_FOR_RUN, setup, call->error);
  if (status != STRUT_OK) return status;
  simulation->opened = true;
  status = strut_resolve_start_equilibrium(setup, &what);
  if (status == STRUT_OK)
    status = strut_run_settings_apply(&abi_simulation_command, arguments, &setup->experiment);
  if (status == STRUT_OK)
    status = strut_model_options_apply(&abi_simulation_command, arguments, &setup->scene);
  if (status == STRUT_OK)
    status = strut_stepping_create(setup, arguments->force, abi_interrupt_of(call->control),
                                   &simulation->stepping, &what);
  if (status != STRUT_OK) abi_call_fail(call, status, &what);
  return status;
}

strutlib_simulation *strutlib_simulation_open(const strutlib_scene *scene, size_t count,
                                              const char *const *names, const char *const *values,
                                              strutlib_control *control, strutlib_error **error) {
  abi_messages messages = {0};
  abi_call call;
  abi_enter(error);
  strutlib_simulation *simulation = strut_allocate(1, sizeof *simulation);
  strut_status status = STRUT_NO_MEMORY;
  if (simulation)
    status = abi_call_begin(&call, scene, &abi_simulation_command, count, names, values, control,
                            error, &messages);
  else
    abi_no_memory(error);
  if (status == STRUT_OK) status = open_setup(&call, scene, simulation);
  if (status != STRUT_OK) {
    strutlib_simulation_close(simulation);
    simulation = NULL;
  }
  abi_messages_free(&messages);
  abi_leave();
  return simulation;
}

void strutlib_simulation_close(strutlib_simulation *simulation) {
  if (!simulation) return;
  strut_stepping_free(simulation->stepping);
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

double strutlib_simulation_time(const strutlib_simulation *simulation) {
  return simulation ? strut_stepping_time(simulation->stepping) : (double)NAN;
}

double strutlib_simulation_step(const strutlib_simulation *simulation) {
  return simulation ? strut_stepping_step(simulation->stepping) : (double)NAN;
}

double strutlib_simulation_input_work(const strutlib_simulation *simulation) {
  return simulation ? strut_stepping_input_work(simulation->stepping) : (double)NAN;
}

/* ---- arrays ---- */

static int show(size_t items, size_t components, int *dimensions, size_t *shape, size_t *stride) {
  *dimensions = components > 1 ? 2 : 1;
  shape[0] = items;
  stride[0] = components;
  if (components > 1) {
    shape[1] = components;
    stride[1] = 1;
  }
  return 1;
}

int strutlib_simulation_array(strutlib_simulation *simulation, const char *name,
                              const double **data, int *dimensions, size_t *shape, size_t *stride) {
  if (!simulation || !name || !data || !dimensions || !shape || !stride) return 0;
  const strut_channel_row *row = strut_channel_named(name);
  if (!row || !strut_stepping_channel(simulation->stepping, row->id, data)) return 0;
  bool of_system = row->owner == STRUT_OWNER_SYSTEM; /* its components are the things */
  return show(strut_channel_things(row, &simulation->setup.scene), of_system ? 1 : row->components,
              dimensions, shape, stride);
}

static const char *const input_names[] = {"rest", "actuators", "load", NULL};

int strutlib_simulation_input(strutlib_simulation *simulation, const char *name, double **data,
                              int *dimensions, size_t *shape, size_t *stride) {
  if (!simulation || !name || !data || !dimensions || !shape || !stride) return 0;
  for (int i = 0; input_names[i]; i++) {
    size_t count, components = i == STRUT_INPUT_LOAD ? 2 : 1;
    if (strcmp(input_names[i], name) != 0) continue;
    *data = strut_stepping_input(simulation->stepping, (strut_input)i, &count);
    return *data ? show(count / components, components, dimensions, shape, stride) : 0;
  }
  return 0;
}

/* Index of "m8", "drive" or "n1.x" in an input, or -1. */
static long index_of(const strut_scene *scene, int input, const char *name) {
  if (input == STRUT_INPUT_REST) {
    for (size_t i = 0; i < scene->member_count; i++)
      if (strcmp(scene->members[i].name, name) == 0) return (long)i;
  } else if (input == STRUT_INPUT_ACTUATORS) {
    for (size_t i = 0; i < scene->actuator_count; i++)
      if (strcmp(scene->actuators[i].name, name) == 0) return (long)i;
  } else {
    for (size_t i = 0; i < scene->node_count; i++) {
      size_t length = strlen(scene->nodes[i].name);
      if (strncmp(name, scene->nodes[i].name, length) != 0) continue;
      if (strcmp(name + length, ".x") == 0) return (long)(2 * i);
      if (strcmp(name + length, ".y") == 0) return (long)(2 * i + 1);
    }
  }
  return -1;
}

int strutlib_simulation_set(strutlib_simulation *simulation, const char *input, const char *name,
                            double value, strutlib_error **error) {
  int which = 0;
  size_t count;
  if (abi_lacks(error, simulation, "simulation") || abi_lacks(error, input, "input") ||
      abi_lacks(error, name, "name"))
    return STRUTLIB_USAGE;
  if (error) *error = NULL;
  while (input_names[which] && strcmp(input_names[which], input) != 0) which++;
  if (!input_names[which])
    return abi_fail(error, STRUTLIB_USAGE,
                    "there is no input '%s'; expected rest, actuators or load", input);
  long index = index_of(&simulation->setup.scene, which, name);
  if (index < 0) return abi_fail(error, STRUTLIB_USAGE, "input '%s' has no '%s'", input, name);
  double *data = strut_stepping_input(simulation->stepping, (strut_input)which, &count);
  if (!data) return abi_no_memory(error);
  data[index] = value;
  return STRUTLIB_OK;
}

/* ---- snapshots ---- */

strutlib_snapshot *strutlib_simulation_snapshot(const strutlib_simulation *simulation,
                                                strutlib_error **error) {
  if (abi_lacks(error, simulation, "simulation")) return NULL;
  if (error) *error = NULL;
  strutlib_snapshot *snapshot = strut_allocate(1, sizeof *snapshot);
  if (snapshot) snapshot->stored = strut_stepping_store(simulation->stepping);
  if (snapshot && snapshot->stored) return snapshot;
  strut_release(snapshot);
  abi_no_memory(error);
  return NULL;
}

int strutlib_simulation_restore(strutlib_simulation *simulation, const strutlib_snapshot *snapshot,
                                strutlib_error **error) {
  if (abi_lacks(error, simulation, "simulation") || abi_lacks(error, snapshot, "snapshot"))
    return STRUTLIB_USAGE;
  if (error) *error = NULL;
  if (strut_stepping_restore(simulation->stepping, snapshot->stored)) return STRUTLIB_OK;
  return abi_fail(error, STRUTLIB_USAGE, "the snapshot is of another simulation");
}

void strutlib_snapshot_free(strutlib_snapshot *snapshot) {
  if (!snapshot) return;
  strut_stepping_snapshot_free(snapshot->stored);
  strut_release(snapshot);
}
