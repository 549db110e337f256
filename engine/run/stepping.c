/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/stepping.h"

#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/forces.h"
#include "engine/run/simulate_parts.h"

/* ---- inputs ---- */

/* What the caller has written, and what of it the model has. */
typedef struct stepping_inputs {
  strut_scene *scene; /* whose loads and signals are changed */
  double *given;      /* (count) rest, actuators, loads, rates: what the caller writes */
  double *applied;    /* (count) what the model has */
  double *rates;      /* (actuators) of it */
  double *points;     /* two times, and two values for each actuator: tables of values that move */
  size_t count, members, actuators, nodes;
  bool loads;            /* loads were asked for */
  int32_t first_signal;  /* of the signals that hold actuators, one for each */
  size_t first_load;     /* of the loads, one for each node */
  double *constant;      /* (length) the model's constant force, of which: */
  double *constant_base; /* (length) the scene's */
  double work;           /* that changes have done [J] */
  strut_arena arena;
} stepping_inputs;

/* Adds the signals that hold actuators to the scene, before it is compiled: 0 until write_actuators. */
static strut_status inputs_prepare(strut_setup *setup, strut_error *error) {
  strut_scene *scene = &setup->scene;
  size_t before = scene->signal_count, more = scene->actuator_count;
  strut_signal *signals = strut_arena_allocate(&scene->arena, before + more, sizeof *signals);
  if (!signals) return strut_no_memory(error, "");
  if (before) memcpy(signals, scene->signals, before * sizeof *signals);
  scene->signals = signals;
  scene->signal_count = before + more;
  return STRUT_OK;
}

static strut_status inputs_create(strut_setup *setup, const strut_model *model, stepping_inputs *in,
                                  strut_error *error) {
  strut_scene *scene = &setup->scene;
  *in = (stepping_inputs){.scene = scene,
                          .members = scene->member_count,
                          .actuators = scene->actuator_count,
                          .nodes = scene->node_count};
  in->first_signal = (int32_t)(scene->signal_count - scene->actuator_count);
  in->count = in->members + 2 * in->actuators + 2 * in->nodes;
  if (!STRUT_ALLOCATE(&in->arena, STRUT_NEW(in->given, in->count),
                      STRUT_NEW(in->applied, in->count),
                      STRUT_NEW(in->points, 2 + 2 * in->actuators)))
    return strut_no_memory(error, "");
  in->rates = in->applied + in->count - in->actuators;
  for (size_t i = 0; i < in->members; i++) in->given[i] = model->members.rest[i];
  for (size_t i = 0; i < in->actuators; i++) in->given[in->members + i] = (double)NAN;
  memcpy(in->applied, in->given, in->count * sizeof *in->given);
  return STRUT_OK;
}

/* Makes a load of each node, and the constant force a term of the model. */
static bool add_loads(stepping_inputs *in, strut_model *model) {
  strut_scene *scene = in->scene;
  size_t before = scene->load_count, length = (size_t)model->length;
  strut_load *loads = strut_arena_allocate(&scene->arena, before + in->nodes, sizeof *loads);
  if (!loads || !STRUT_NUMBERS(&in->arena, length, &in->constant, &in->constant_base)) return false;
  if (before) memcpy(loads, scene->loads, before * sizeof *loads);
  for (size_t i = 0; i < in->nodes; i++)
    loads[before + i] = (strut_load){.name = "", .node = (int32_t)i, .signal = -1};
  if (model->constant_force) {
    memcpy(in->constant, model->constant_force, length * sizeof *in->constant);
    memcpy(in->constant_base, model->constant_force, length * sizeof *in->constant_base);
  }
  in->first_load = before;
  scene->loads = loads;
  scene->load_count = before + in->nodes;
  model->constant_force = in->constant;
  model->terms |= STRUT_TERM_CONSTANT;
  in->loads = true;
  return true;
}

/* ---- changes ---- */

static strut_status check_inputs(const stepping_inputs *in, strut_error *error) {
  const strut_scene *scene = in->scene;
  const double *actuators = in->given + in->members, *loads = actuators + in->actuators;
  const double *rates = loads + 2 * in->nodes;
  for (size_t i = 0; i < in->members; i++) {
    const strut_member *member = &scene->members[i];
    bool changed = in->given[i] != in->applied[i], rigid = scene->bar_model == STRUT_BARS_RIGID;
    const char *wrong = NULL;
    if (!(in->given[i] >= 0.0) || !isfinite(in->given[i]))
      wrong = "must be a number from 0 on";
    else if (changed && !(in->given[i] > 0.0) && member->axial_stiffness > 0.0)
      wrong = "must be above zero: the member has an axial_stiffness";
    else if (changed && rigid && member->kind == STRUT_BAR)
      wrong = "must stay: the member is a rigid bar";
    if (wrong)
      return strut_fail(error, STRUT_USAGE, "input 'rest': the rest length of member '%s' %s",
                        member->name, wrong);
  }
  for (size_t i = 0; i < in->actuators; i++)
    if (isinf(actuators[i]) || !isfinite(rates[i]))
      return strut_fail(error, STRUT_USAGE,
                        "input 'actuators': the value of '%s' must be a number, or NAN for the "
                        "scene's signal, and its rate a number",
                        scene->actuators[i].name);
  for (size_t i = 0; i < 2 * in->nodes; i++)
    if (!isfinite(loads[i]))
      return strut_fail(error, STRUT_USAGE, "input 'load': the force on '%s.%c' must be a number",
                        scene->nodes[i / 2].name, i % 2 ? 'y' : 'x');
  return STRUT_OK;
}

/* EA over the rest length, of a member that no actuator drives: there the law follows by itself. */
static void write_stiffness(strut_model *model, int32_t member, double stiffness) {
  strut_model_inputs tables = strut_model_inputs_of(model);
  int32_t i =
      strut_member_is_element(&model->elements, member) ? model->elements.of_member[member] : -1;
  if (i < 0) {
    tables.stiffness[member] = stiffness;
  } else if (tables.element[i].law != STRUT_LAW_AXIAL) {
    tables.element[i].numbers.stiffness = tables.element_stiffness[i] = stiffness;
  }
}

/* The tables of a model that inputs change, which is why it belongs to one stepping alone. */
static void write_rest(const stepping_inputs *in, strut_model *model) {
  const strut_member *members = in->scene->members;
  double *rest = strut_model_inputs_of(model).rest;
  for (size_t i = 0; i < in->members; i++) {
    rest[i] = in->applied[i];
    if (members[i].axial_stiffness > 0.0)
      write_stiffness(model, (int32_t)i, members[i].axial_stiffness / rest[i]);
  }
}

/* Long after any end: values move at their rates between two points of a table. */
static const double FAR = 0x1p20; /* s */

/* Lets values of actuators move from time t of their signals on. */
static void begin_to_move(stepping_inputs *in, double t) {
  in->points[0] = t;
  in->points[1] = t + FAR;
  for (size_t i = 0; i < in->actuators; i++) {
    double *value = in->points + 2 + 2 * i;
    value[0] = in->applied[in->members + i];
    value[1] = value[0] + FAR * in->rates[i];
  }
}

/* Values that have moved are what the caller finds. */
static void follow_actuators(stepping_inputs *in, double t) {
  for (size_t i = 0; i < in->actuators; i++)
    if (in->rates[i] != 0.0)
      in->given[in->members + i] = in->applied[in->members + i] =
          in->points[2 + 2 * i] + in->rates[i] * (t - in->points[0]);
}

/* Actuators of rest lengths and those of forces stand in two tables, each in the scene's order. */
static void write_actuators(const stepping_inputs *in, strut_model *model) {
  const strut_scene *scene = in->scene;
  strut_model_inputs tables = strut_model_inputs_of(model);
  size_t drives = 0, forces = 0;
  for (size_t i = 0; i < in->actuators; i++) {
    double value = in->applied[in->members + i];
    int32_t held = in->first_signal + (int32_t)i;
    int32_t now = isnan(value) ? scene->actuators[i].signal : held;
    bool moves = in->rates[i] != 0.0 && !isnan(value);
    scene->signals[held] = (strut_signal){.kind = moves ? STRUT_TABLE : STRUT_CONSTANT,
                                          .stop = HUGE_VAL,
                                          .amplitude = isnan(value) ? 0.0 : value,
                                          .point_count = 2,
                                          .time = in->points,
                                          .value = in->points + 2 + 2 * i};
    if (scene->actuators[i].force)
      tables.actuator_force[forces++].signal = now;
    else
      tables.drive_signal[drives++] = now;
  }
}

static void write_loads(const stepping_inputs *in) {
  const double *loads = in->applied + in->members + in->actuators;
  for (size_t i = 0; i < 2 * in->nodes; i++) {
    in->scene->loads[in->first_load + i / 2].force[i % 2] = loads[i];
    in->constant[i] = in->constant_base[i] + loads[i];
  }
}

static void write_all(const stepping_inputs *in, strut_model *model) {
  write_rest(in, model);
  write_actuators(in, model);
  if (in->loads) write_loads(in);
}

/* Takes what is given into the model, as an event of the run. STRUT_USAGE: nothing is changed. */
static strut_status inputs_apply(stepping_inputs *in, strut_model *model, strut_run *run,
                                 strut_error *error) {
  strut_state *state = run->state;
  double t = strut_time_grid_at(&run->grid, state->step);
  strut_status status = check_inputs(in, error);
  if (status) return status;
  strut_energies before = strut_energy_evaluate(model, state, t);
  double loads = in->loads ? strut_energy_load_potential(model, state) : 0.0;
  /* Rest lengths that no drive and no memory sets follow here. */
  for (size_t i = 0; i < in->members; i++)
    if (in->applied[i] != in->given[i]) state->latest->rest[i] = in->given[i];
  memcpy(in->applied, in->given, in->count * sizeof *in->given);
  begin_to_move(in, t + state->time_offset);
  write_all(in, model);
  /* Constant loads do work along displacements only: what they have done so far stays. */
  if (in->loads) state->load_work_origin += strut_energy_load_potential(model, state) - loads;
  state->latest->drive_time = (double)NAN;
  strut_energies after = strut_energy_evaluate(model, state, t);
  double work = after.elastic - before.elastic;
  strut_power_add(state->work, STRUT_POWER_DRIVE, work);
  in->work += work;
  state->latest->drive_time = (double)NAN;
  if (run->method->restart) run->method->restart(model, state, run->workspace, run->dt);
  return STRUT_OK;
}

/* ---- stepping ---- */

/* No run is as long: the end is never reached, and nothing is measured. */
static const double ENDLESS = 0x1p50; /* steps */

struct strut_stepping {
  strut_run run;
  strut_run_options options;
  strut_experiment experiment;
  strut_model *model;
  strut_summary summary;
  strut_error error;
  stepping_inputs inputs;
  strut_recording live;
  strut_channels shown; /* channels that follow */
  strut_sink *sink;     /* or NULL */
  int64_t stop;         /* step of the next strut_run_sample */
  strut_status status;
  uint64_t identity;
  bool begun;
};

struct strut_stepping_snapshot {
  uint64_t identity;
  strut_run run;
  strut_state state;
  int64_t stop;
  strut_status status;
  double input_work;
  void *stored[3]; /* strut_arena_store of each of list_arenas */
};

/* What is in the inputs, in the state, and measured. */
static void list_arenas(strut_stepping *stepping, strut_arena *arenas[3]) {
  arenas[0] = &stepping->inputs.arena;
  arenas[1] = &stepping->run.state->arena;
  arenas[2] = &stepping->run.measure.arena;
}

static uint64_t next_identity(void) {
  static atomic_uint_fast64_t last;
  return atomic_fetch_add(&last, 1) + 1;
}

/* Of one motion as it is, and where nobody records it without measurements, and without an end. */
static strut_status make_plain(strut_experiment *experiment, bool recorded, strut_error *error) {
  if (!(experiment->step > 0.0))
    return strut_fail(error, STRUT_USAGE,
                      "the scene leaves its step to be chosen: a simulation needs the option "
                      "'step', such as 0.1 ms");
  experiment->accuracy = 0.0;
  experiment->steady.wanted = false;
  if (recorded) return STRUT_OK;
  experiment->quantity_count = 0;
  experiment->periods = 0.0;
  experiment->duration = ENDLESS * experiment->step;
  experiment->measure_last = experiment->step;
  return STRUT_OK;
}

strut_status strut_stepping_create(strut_setup *setup, bool force, const strut_flag *interrupt,
                                   strut_sink *sink, strut_stepping **stepping,
                                   strut_error *error) {
  strut_stepping *s = strut_allocate(1, sizeof *s);
  *stepping = NULL;
  if (!s) return strut_no_memory(error, "");
  s->experiment = setup->experiment;
  s->sink = sink;
  s->options = (strut_run_options){
      .force = force, .interrupt = interrupt, .sinks = &s->sink, .sink_count = sink ? 1 : 0};
  s->identity = next_identity();
  strut_status status = make_plain(&s->experiment, sink, error);
  if (!status) status = inputs_prepare(setup, error);
  if (!status) status = strut_model_compile(&setup->scene, &s->model, error);
  if (!status) {
    status = strut_run_begin(s->model, &s->experiment, &s->options, &s->summary, error, &s->run);
    s->begun = true;
  }
  if (status == STRUT_OK)
    status = strut_recording_create_alone(s->model, &s->run.grid, &s->live, error);
  if (!status) status = inputs_create(setup, s->model, &s->inputs, error);
  if (!status) status = strut_run_sample(&s->run, &s->stop);
  s->run.error = &s->error; /* `error` is the caller's, and may be gone */
  if (!status) {
    *stepping = s;
    return STRUT_OK;
  }
  strut_stepping_free(s);
  return status;
}

void strut_stepping_free(strut_stepping *stepping) {
  if (!stepping) return;
  stepping->run.error = &stepping->error;
  if (stepping->begun) strut_run_free(&stepping->run);
  strut_summary_free(&stepping->summary);
  strut_recording_free(&stepping->live);
  strut_arena_free(&stepping->inputs.arena);
  strut_model_free(stepping->model);
  strut_release(stepping);
}

double strut_stepping_time(const strut_stepping *stepping) {
  return strut_run_time(&stepping->run);
}
double strut_stepping_step(const strut_stepping *stepping) { return stepping->run.dt; }

static void refresh(strut_stepping *stepping) {
  if (stepping->shown)
    strut_recording_observe(stepping->run.state, &stepping->live, stepping->shown);
}

/* ---- steps ---- */

/* With the checks and the records of a run between its steps. */
static strut_status step_to(strut_stepping *stepping, int64_t last) {
  strut_run *run = &stepping->run;
  strut_status status = STRUT_OK;
  while (status == STRUT_OK && run->state->step < last) {
    if (stepping->stop > run->state->step)
      strut_run_step(run, stepping->stop < last ? stepping->stop : last);
    if (run->state->step >= stepping->stop || run->state->trouble)
      status = strut_run_sample(run, &stepping->stop);
  }
  return status;
}

strut_status strut_stepping_advance(strut_stepping *stepping, int64_t steps, strut_error *error) {
  if (stepping->status != STRUT_OK) {
    if (error) *error = stepping->error;
    return stepping->status;
  }
  if (steps < 0) return strut_fail(error, STRUT_USAGE, "a simulation cannot go back");
  const strut_flag *interrupt = stepping->options.interrupt;
  if (interrupt && *interrupt)
    return strut_fail(error, STRUT_INTERRUPTED, "interrupted at t = %.9g s",
                      strut_run_time(&stepping->run));
  stepping_inputs *in = &stepping->inputs; /* bits are compared, so that NAN equals itself */
  if (memcmp(in->given, in->applied, in->count * sizeof *in->given) != 0) {
    strut_status valid = inputs_apply(in, stepping->model, &stepping->run, error);
    if (valid) return valid;
  }
  int64_t done = stepping->run.state->step, most = stepping->run.steps - done;
  strut_status status = step_to(stepping, done + (steps < most ? steps : most));
  follow_actuators(in, strut_run_time(&stepping->run) + stepping->run.state->time_offset);
  refresh(stepping);
  if (!status) return STRUT_OK;
  if (error) *error = stepping->error;
  if (status != STRUT_INTERRUPTED) stepping->status = status;
  if (status == STRUT_INTERRUPTED) stepping->run.state->trouble = STRUT_FAILURE_NONE;
  return status;
}

strut_status strut_stepping_finish(strut_stepping *stepping, strut_summary *summary) {
  strut_run *run = &stepping->run;
  bool whole = run->state->step >= run->steps;
  strut_status status = stepping->status || whole ? stepping->status : STRUT_INTERRUPTED;
  status = strut_run_complete(run, status);
  *summary = stepping->summary;
  summary->controlled = true;
  summary->input_work = stepping->inputs.work;
  stepping->summary = (strut_summary){0};
  stepping->identity = next_identity(); /* no snapshot brings it back to where it records */
  if (!stepping->status)
    stepping->status = strut_fail(&stepping->error, STRUT_USAGE, "the simulation was finished");
  return status;
}

/* ---- what it shows ---- */

const strut_record_channel *strut_stepping_channel(strut_stepping *stepping, strut_channels id,
                                                   const double **data) {
  for (size_t k = 0; k < stepping->live.layout.channel_count; k++) {
    const strut_record_channel *channel = &stepping->live.channel[k];
    if (channel->id != id) continue;
    stepping->shown |= id;
    refresh(stepping);
    *data = stepping->live.rows + channel->offset;
    return channel;
  }
  return NULL;
}

/* Loads become terms of the model only where they are asked for. */
double *strut_stepping_input(strut_stepping *stepping, strut_input input, size_t *count) {
  stepping_inputs *in = &stepping->inputs;
  const size_t counts[STRUT_INPUTS] = {in->members, in->actuators, 2 * in->nodes, in->actuators};
  double *given = in->given;
  if (input == STRUT_INPUT_LOAD && !in->loads && !add_loads(in, stepping->model)) return NULL;
  for (int i = 0; i < (int)input; i++) given += counts[i];
  *count = counts[input];
  return given;
}

double strut_stepping_input_work(const strut_stepping *stepping) { return stepping->inputs.work; }

int64_t strut_stepping_recorded(const strut_stepping *stepping) {
  return stepping->run.recording.sampled;
}

/* ---- snapshots ---- */

strut_stepping_snapshot *strut_stepping_store(strut_stepping *stepping) {
  strut_stepping_snapshot *snapshot = strut_allocate(1, sizeof *snapshot);
  const strut_state *state = stepping->run.state;
  strut_arena *arenas[3];
  if (!snapshot || strut_recording_flush(&stepping->run.recording, NULL) != STRUT_OK)
    return strut_release(snapshot), NULL;
  *snapshot = (strut_stepping_snapshot){.identity = stepping->identity,
                                        .run = stepping->run,
                                        .state = *state,
                                        .stop = stepping->stop,
                                        .status = stepping->status,
                                        .input_work = stepping->inputs.work};
  list_arenas(stepping, arenas);
  for (int k = 0; k < 3; k++) {
    snapshot->stored[k] = strut_allocate(strut_arena_stored_size(arenas[k]), 1);
    if (!snapshot->stored[k]) return strut_stepping_snapshot_free(snapshot), NULL;
    strut_arena_store(arenas[k], snapshot->stored[k]);
  }
  return snapshot;
}

bool strut_stepping_restore(strut_stepping *stepping, const strut_stepping_snapshot *snapshot) {
  if (snapshot->identity != stepping->identity) return false;
  strut_state *state = stepping->run.state;
  strut_arena arena = state->arena, measured = stepping->run.measure.arena; /* may have grown */
  strut_arena_restore(&stepping->inputs.arena, snapshot->stored[0]);
  stepping->inputs.work = snapshot->input_work;
  write_all(&stepping->inputs, stepping->model);
  stepping->run = snapshot->run;
  stepping->run.measure.arena = measured;
  stepping->stop = snapshot->stop;
  stepping->status = snapshot->status;
  *state = snapshot->state;
  state->arena = arena;
  strut_arena_restore(&state->arena, snapshot->stored[1]);
  strut_arena_restore(&stepping->run.measure.arena, snapshot->stored[2]);
  refresh(stepping);
  return true;
}

void strut_stepping_snapshot_free(strut_stepping_snapshot *snapshot) {
  if (!snapshot) return;
  for (int k = 0; k < 3; k++) strut_release(snapshot->stored[k]);
  strut_release(snapshot);
}
