/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/stepping_inputs.h"

#include <math.h>
#include <string.h>

#include "engine/forces/drive.h"
#include "engine/forces/forces.h"
#include "engine/model/small_model.h"

/* ---- room ---- */

strut_status strut_stepping_inputs_prepare(strut_setup *setup, strut_error *error) {
  strut_scene *scene = &setup->scene;
  size_t before = scene->signal_count, more = scene->actuator_count;
  strut_signal *signals = strut_arena_allocate(&scene->arena, before + more, sizeof *signals);
  if (!signals) return strut_no_memory(error, "");
  if (before) memcpy(signals, scene->signals, before * sizeof *signals);
  for (size_t i = 0; i < more; i++)
    signals[before + i] = (strut_signal){.kind = STRUT_CONSTANT, .stop = HUGE_VAL};
  scene->signals = signals;
  scene->signal_count = before + more;
  return STRUT_OK;
}

strut_status strut_stepping_inputs_create(strut_setup *setup, const strut_model *model,
                                          strut_stepping_inputs *in, strut_error *error) {
  strut_scene *scene = &setup->scene;
  *in = (strut_stepping_inputs){.scene = scene,
                                .members = scene->member_count,
                                .actuators = scene->actuator_count,
                                .nodes = scene->node_count};
  in->first_signal = (int32_t)(scene->signal_count - scene->actuator_count);
  in->count = in->members + in->actuators + 2 * in->nodes;
  in->given = strut_arena_allocate(&in->arena, in->count, sizeof *in->given);
  in->applied = strut_arena_allocate(&in->arena, in->count, sizeof *in->applied);
  if (!in->given || !in->applied) return strut_no_memory(error, "");
  for (size_t i = 0; i < in->members; i++) in->given[i] = model->members.rest[i];
  for (size_t i = 0; i < in->actuators; i++) in->given[in->members + i] = (double)NAN;
  memcpy(in->applied, in->given, in->count * sizeof *in->given);
  return STRUT_OK;
}

void strut_stepping_inputs_free(strut_stepping_inputs *in) { strut_arena_free(&in->arena); }

/* Makes a load of each node, and the constant force a term of the model. */
static bool add_loads(strut_stepping_inputs *in, strut_model *model) {
  strut_scene *scene = in->scene;
  size_t before = scene->load_count, length = (size_t)model->length;
  strut_load *loads = strut_arena_allocate(&scene->arena, before + in->nodes, sizeof *loads);
  in->constant = strut_arena_allocate(&in->arena, length, sizeof *in->constant);
  in->constant_base = strut_arena_allocate(&in->arena, length, sizeof *in->constant_base);
  if (!loads || !in->constant || !in->constant_base) return false;
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
  model->plan |= STRUT_TERM_CONSTANT;
  in->loads = true;
  return true;
}

static void restart(const strut_model *model, strut_run *run) {
  run->state->drive_time = (double)NAN;
  if (run->method->restart) run->method->restart(model, run->state, run->workspace, run->dt);
}

double *strut_stepping_inputs_show(strut_stepping_inputs *in, strut_model *model, strut_run *run,
                                   strut_input input, size_t *count) {
  (void)run;
  switch (input) {
    case STRUT_INPUT_REST: *count = in->members; return in->given;
    case STRUT_INPUT_ACTUATORS: *count = in->actuators; return in->given + in->members;
    case STRUT_INPUT_LOAD:
      if (!in->loads && !add_loads(in, model)) return NULL;
      *count = 2 * in->nodes;
      return in->given + in->members + in->actuators;
    case STRUT_INPUTS: break;
  }
  return NULL;
}

/* ---- changes ---- */

/* Bits are compared, so that NAN equals itself. */
bool strut_stepping_inputs_changed(const strut_stepping_inputs *in) {
  return memcmp(in->given, in->applied, in->count * sizeof *in->given) != 0;
}

static strut_status check(const strut_stepping_inputs *in, strut_error *error) {
  const strut_scene *s = in->scene;
  const double *actuators = in->given + in->members, *loads = actuators + in->actuators;
  for (size_t i = 0; i < in->members; i++) {
    bool changed = in->given[i] != in->applied[i], rigid = s->bar_model == STRUT_BARS_RIGID;
    if (!(in->given[i] >= 0.0) || !isfinite(in->given[i]))
      return strut_fail(error, STRUT_USAGE,
                        "input 'rest': the rest length of member '%s' must be a number from 0 on",
                        s->members[i].name);
    if (changed && !(in->given[i] > 0.0) && s->members[i].axial_stiffness > 0.0)
      return strut_fail(error, STRUT_USAGE,
                        "input 'rest': the rest length of member '%s', which has an "
                        "axial_stiffness, must be above zero",
                        s->members[i].name);
    if (changed && rigid && s->members[i].kind == STRUT_BAR)
      return strut_fail(error, STRUT_USAGE,
                        "input 'rest': member '%s' is a rigid bar, which keeps its length",
                        s->members[i].name);
  }
  for (size_t i = 0; i < in->actuators; i++)
    if (isinf(actuators[i]))
      return strut_fail(error, STRUT_USAGE,
                        "input 'actuators': the value of '%s' must be a number, or NAN for the "
                        "scene's signal",
                        s->actuators[i].name);
  for (size_t i = 0; i < 2 * in->nodes; i++)
    if (!isfinite(loads[i]))
      return strut_fail(error, STRUT_USAGE, "input 'load': the force on '%s.%c' must be a number",
                        s->nodes[i / 2].name, i % 2 ? 'y' : 'x');
  return STRUT_OK;
}

/* EA over the rest length, of a member that no actuator drives: there the law follows by itself. */
static void write_stiffness(const strut_model *model, int32_t member, double stiffness) {
  const strut_element_table *t = &model->elements;
  strut_element *e = (strut_element *)(uintptr_t)strut_element_of_member(t, member);
  bool element = e && e->role == STRUT_ELEMENT_MEMBER;
  if (element && e->law == STRUT_LAW_AXIAL) return;
  if (element) {
    e->numbers.stiffness = stiffness;
    ((double *)(uintptr_t)t->stiffness)[e - t->element] = stiffness;
    return;
  }
  ((double *)(uintptr_t)model->members.stiffness)[member] = stiffness;
  if (model->small) model->small->stiffness[member] = stiffness;
}

/* The tables of a model that inputs change, which is why it belongs to one stepping alone. */
static void write_rest(const strut_stepping_inputs *in, const strut_model *model) {
  const strut_member *members = in->scene->members;
  double *rest = (double *)(uintptr_t)model->members.rest;
  for (size_t i = 0; i < in->members; i++) {
    rest[i] = in->applied[i];
    if (members[i].axial_stiffness > 0.0)
      write_stiffness(model, (int32_t)i, members[i].axial_stiffness / rest[i]);
  }
}

/* Actuators of rest lengths and those of forces stand in two tables, each in the scene's order. */
static void write_actuators(const strut_stepping_inputs *in, const strut_model *model) {
  const strut_scene *s = in->scene;
  int32_t *signal = (int32_t *)(uintptr_t)model->drives.signal;
  strut_actuator_force *force = (strut_actuator_force *)(uintptr_t)model->actuator_forces.item;
  size_t drives = 0, forces = 0;
  for (size_t i = 0; i < in->actuators; i++) {
    double value = in->applied[in->members + i];
    int32_t held = in->first_signal + (int32_t)i;
    int32_t now = isnan(value) ? s->actuators[i].signal : held;
    s->signals[held].amplitude = isnan(value) ? 0.0 : value;
    if (s->actuators[i].force)
      force[forces++].signal = now;
    else
      signal[drives++] = now;
  }
}

static void write_loads(const strut_stepping_inputs *in) {
  const double *loads = in->applied + in->members + in->actuators;
  for (size_t i = 0; i < 2 * in->nodes; i++) {
    in->scene->loads[in->first_load + i / 2].force[i % 2] = loads[i];
    in->constant[i] = in->constant_base[i] + loads[i];
  }
}

static void write_all(const strut_stepping_inputs *in, const strut_model *model) {
  write_rest(in, model);
  write_actuators(in, model);
  if (in->loads) write_loads(in);
}

strut_status strut_stepping_inputs_apply(strut_stepping_inputs *in, strut_model *model,
                                         strut_run *run, strut_error *error) {
  strut_state *state = run->state;
  double t = strut_time_grid_at(&run->grid, state->step);
  strut_status status = check(in, error);
  if (status != STRUT_OK) return status;
  strut_energies before = strut_energy_evaluate(model, state, t);
  double loads = in->loads ? strut_energy_load_potential(model, state) : 0.0;
  /* Rest lengths that no drive and no memory sets follow here. */
  for (size_t i = 0; i < in->members; i++)
    if (in->applied[i] != in->given[i]) state->rest[i] = in->given[i];
  memcpy(in->applied, in->given, in->count * sizeof *in->given);
  write_all(in, model);
  /* Constant loads do work along displacements only: what they have done so far stays. */
  if (in->loads) state->load_work_origin += strut_energy_load_potential(model, state) - loads;
  state->drive_time = (double)NAN;
  strut_energies after = strut_energy_evaluate(model, state, t);
  double work = after.elastic - before.elastic;
  state->work[STRUT_POWER_DRIVE] += work;
  state->work[STRUT_POWER_EXCHANGED] += fabs(work);
  in->work += work;
  restart(model, run);
  return STRUT_OK;
}

/* ---- snapshots ---- */

double *strut_stepping_inputs_store(const strut_stepping_inputs *in) {
  double *stored = strut_allocate(2 * in->count + 1, sizeof *stored);
  if (!stored) return NULL;
  memcpy(stored, in->given, in->count * sizeof *stored);
  memcpy(stored + in->count, in->applied, in->count * sizeof *stored);
  stored[2 * in->count] = in->work;
  return stored;
}

void strut_stepping_inputs_restore(strut_stepping_inputs *in, strut_model *model,
                                   const double *stored) {
  memcpy(in->given, stored, in->count * sizeof *stored);
  memcpy(in->applied, stored + in->count, in->count * sizeof *stored);
  in->work = stored[2 * in->count];
  write_all(in, model);
}
