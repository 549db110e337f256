/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How a structure moves: its run to a wanted accuracy, which for a driven one ends when the motion is
 * steady; then whole periods of that motion, for energies and contacts.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/history.h"
#include "engine/model/pose.h"
#include "engine/run/accuracy/accuracy.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/potential.h"
#include "engine/statics/rigidity/rigidity.h"
#include "engine/statics/rigidity/rigidity_parts.h"
#include "engine/study/compare/compare_parts.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

enum { LONG_WINDOW = 20 }; /* periods of a motion that is not periodic */
static const double WINDOW_TOLERANCE = 1e-6, STEPS = 50.0;

static const char *word_of(strut_motion kind) {
  return kind == STRUT_MOTION_NOT_WATCHED ? NULL : strut_motion_name(kind);
}

/* The steady motion over whole periods, from where the run ended. */
static strut_status run_window(const strut_compare_work *work, const strut_summary *run,
                               const strut_snapshot *end, double *seconds, strut_summary *window,
                               strut_error *error) {
  const strut_model *model = work->column->model;
  strut_experiment e = work->column->input->setup->experiment;
  double period = strut_experiment_span(&e, model->scene).period;
  bool periodic = run->steady.kind == STRUT_MOTION_PERIODIC;
  if (model->scene->bar_model == STRUT_BARS_RIGID) { /* which error control does not support */
    e.step = run->step;
  } else {
    e.integrator = strut_integrator_for(STRUT_ROLE_REFERENCE)->name;
    e.tolerance = WINDOW_TOLERANCE;
    e.step = period / STEPS;
  }
  e.accuracy = 0.0;
  e.refine = e.refine_time = 0.0;
  e.steady.wanted = false;
  e.periods = periodic ? run->steady.repeats : LONG_WINDOW;
  e.measure_last = 0.0;
  e.output_last = 0.0;
  *seconds = e.periods * period;
  const strut_run_options wanted = {.interrupt = work->options->interrupt, .from = end};
  return strut_simulate(model, &e, &wanted, window, error);
}

static strut_status put_contacts(strut_compare_work *work, const strut_summary *summary) {
  strut_compare_column *column = work->column;
  double sum = 0.0, touching = 0.0;
  column->contacts =
      strut_arena_allocate(work->arena, summary->end.contact_count + 1, sizeof *column->contacts);
  if (!column->contacts) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < summary->end.contact_count; i++) {
    column->contacts[column->contact_count++] = summary->end.contacts[i];
    if (summary->end.contacts[i].duty > 0.0) touching++;
    sum += summary->end.contacts[i].duty;
  }
  if (touching > 0.0)
    strut_compare_put(work, STRUT_COMPARE_DUTY, sum / touching);
  else
    strut_compare_leave(work, STRUT_COMPARE_DUTY, STRUT_COMPARE_DUTY, "nothing touches a ground");
  return STRUT_OK;
}

/* Drive energy and cost of transport. */
static void put_energy(strut_compare_work *work, double drive_work, double seconds, double period) {
  const strut_compare_cell *cell = work->column->cell;
  const strut_scene *scene = &work->column->input->setup->scene;
  if (scene->actuator_count == 0) {
    strut_compare_leave(work, STRUT_COMPARE_DRIVE_ENERGY, STRUT_COMPARE_TRANSPORT,
                        "there is no drive");
    return;
  }
  double power = drive_work / seconds;
  strut_compare_put(work, STRUT_COMPARE_DRIVE_POWER, power);
  if (period > 0.0)
    strut_compare_put(work, STRUT_COMPARE_DRIVE_ENERGY, power * period);
  else
    strut_compare_leave(work, STRUT_COMPARE_DRIVE_ENERGY, STRUT_COMPARE_DRIVE_ENERGY,
                        "the run is not given in periods");
  double gravity = hypot(scene->gravity[0], scene->gravity[1]);
  double weight = cell[STRUT_COMPARE_MASS].value * gravity;
  double speed = fabs(cell[STRUT_COMPARE_VELOCITY].value);
  if (weight > 0.0 && !work->column->still && speed > 0.0 && power > 0.0)
    strut_compare_put(work, STRUT_COMPARE_TRANSPORT, power / (weight * speed));
  else
    strut_compare_leave(work, STRUT_COMPARE_TRANSPORT, STRUT_COMPARE_TRANSPORT,
                        !(weight > 0.0)       ? "there is no weight"
                        : work->column->still ? "the velocity is zero within its error"
                                              : "the drives do no work");
}

static void put_velocity(strut_compare_work *work, const strut_summary *summary, double period) {
  strut_compare_put(work, STRUT_COMPARE_VELOCITY, summary->velocity);
  strut_compare_put(work, STRUT_COMPARE_VELOCITY_ERROR, summary->accuracy.expected);
  if (period > 0.0)
    strut_compare_put(work, STRUT_COMPARE_TRAVEL, summary->velocity * period);
  else
    strut_compare_leave(work, STRUT_COMPARE_TRAVEL, STRUT_COMPARE_TRAVEL,
                        "the run is not given in periods");
}

static void put_cost(strut_compare_work *work, const strut_summary *summary, double cpu) {
  double spent = (double)(summary->spent.evaluations + summary->accuracy.check_evaluations);
  strut_compare_put(work, STRUT_COMPARE_EVALUATIONS, spent / summary->duration);
  strut_compare_put(work, STRUT_COMPARE_CPU, cpu / summary->duration);
}

static strut_status put_motion(strut_compare_work *work, const strut_summary *run,
                               const strut_snapshot *end, double cpu) {
  strut_compare_column *column = work->column;
  strut_error error = {0};
  double period =
             strut_experiment_span(&column->input->setup->experiment, column->model->scene).period,
         seconds = run->duration;
  column->motion = word_of(run->steady.kind);
  column->repeats = run->steady.kind == STRUT_MOTION_PERIODIC ? run->steady.repeats : 0;
  column->how = strut_arena_format(work->arena, "%s", run->accuracy.why);
  if (!column->how) return STRUT_NO_MEMORY;
  column->inaccurate = strut_summary_is_inaccurate(run);
  double uncertain = run->accuracy.expected * fmax(fabs(run->velocity), run->accuracy.scale);
  column->still = fabs(run->velocity) <= uncertain;
  put_velocity(work, run, period);
  put_cost(work, run, cpu);
  strut_summary window = {0};
  strut_status status = STRUT_OK;
  if (period > 0.0) status = run_window(work, run, end, &seconds, &window, &error);
  if (status != STRUT_OK) {
    status = strut_compare_leave_failed(work, STRUT_COMPARE_DRIVE_ENERGY, STRUT_COMPARE_DUTY,
                                        &error, status, true);
  } else {
    const strut_summary *source = period > 0.0 ? &window : run;
    put_energy(work, source->energy.drive_work, seconds, period);
    status = put_contacts(work, source);
  }
  strut_summary_free(&window);
  return status;
}

strut_status strut_compare_motion(strut_compare_work *work, const strut_model *model) {
  strut_experiment *experiment = &work->column->input->setup->experiment;
  const char *none = work->options->no_motion ? "not requested"
                     : !(experiment->duration > 0 || experiment->periods > 0)
                         ? "the model has no run"
                         : NULL;
  if (none) {
    strut_compare_leave(work, STRUT_COMPARE_VELOCITY, STRUT_COMPARE_CPU, none);
    return STRUT_OK;
  }
  strut_error error = {0};
  strut_summary summary = {0};
  strut_snapshot end = {
      .q = strut_arena_allocate(work->arena, (size_t)model->length, sizeof *end.q),
      .v = strut_arena_allocate(work->arena, (size_t)model->length, sizeof *end.v),
      .memory = strut_arena_allocate(work->arena, strut_history_count(model), sizeof *end.memory)};
  if (!end.q || !end.v || !end.memory) return STRUT_NO_MEMORY;
  experiment->accuracy = work->options->accuracy;
  experiment->steady.wanted = experiment->periods > 0.0;
  experiment->quantity_count = 0; /* the accuracy is that of the velocity */
  const strut_run_options wanted = {.interrupt = work->options->interrupt, .to = &end};
  double began = strut_tradeoff_cpu_clock();
  strut_status status = strut_simulate_accurately(model, experiment, &wanted, &summary, &error);
  double cpu = strut_tradeoff_cpu_clock() - began;
  if (status == STRUT_OK)
    status = put_motion(work, &summary, &end, cpu);
  else
    status = strut_compare_leave_failed(work, STRUT_COMPARE_VELOCITY, STRUT_COMPARE_CPU, &error,
                                        status, true);
  strut_summary_free(&summary);
  return status;
}

/* Properties of a structure at rest: rigidity, forces, states, frequencies. */

static void put_counts(strut_compare_work *work, const strut_rigidity *rigidity) {
  const strut_mechanisms *mechanisms = &rigidity->mechanisms;
  strut_compare_put(work, STRUT_COMPARE_SELF_STRESSES, rigidity->states.count);
  strut_compare_put(work, STRUT_COMPARE_MECHANISMS, mechanisms->count - mechanisms->rigid_body);
  strut_compare_put(work, STRUT_COMPARE_FINITE, mechanisms->finite);
  strut_compare_put(work, STRUT_COMPARE_RIGID_MOTIONS, mechanisms->rigid_body);
}

static void put_forces(strut_compare_work *work, const strut_rigidity *rigidity, size_t count) {
  double squares = 0.0, tension = 0.0, compression = 0.0;
  if (count == 0) {
    strut_compare_leave(work, STRUT_COMPARE_PRESTRESS, STRUT_COMPARE_COMPRESSION,
                        "there are no members");
    return;
  }
  for (size_t j = 0; j < count; j++) {
    squares += rigidity->force[j] * rigidity->force[j];
    tension = fmax(tension, rigidity->force[j]);
    compression = fmax(compression, -rigidity->force[j]);
  }
  strut_compare_put(work, STRUT_COMPARE_PRESTRESS, sqrt(squares / (double)count));
  strut_compare_put(work, STRUT_COMPARE_TENSION, tension);
  strut_compare_put(work, STRUT_COMPARE_COMPRESSION, compression);
}

/* Evaluates the drawn shape, as `strut rigidity` does. */
static strut_status evaluate_drawn(strut_compare_work *work, const strut_model *model) {
  strut_error error = {0};
  strut_arena scratch = {0};
  strut_rest_state drawn;
  strut_rigidity r = {0};
  strut_status status = strut_rest_state_find(model, &work->column->input->setup->experiment,
                                              "drawn", &scratch, &drawn, &error);
  if (status == STRUT_OK) status = strut_rigidity_find(model, drawn.q, &r, &error);
  if (status == STRUT_OK)
    put_counts(work, &r);
  else
    status = strut_compare_leave_failed(work, STRUT_COMPARE_SELF_STRESSES,
                                        STRUT_COMPARE_RIGID_MOTIONS, &error, status, true);
  strut_rigidity_free(&r);
  strut_arena_free(&scratch);
  return status;
}

strut_status strut_compare_rigidity(strut_compare_work *work, const strut_model *model) {
  strut_error error = {0};
  strut_rigidity r = {0};
  strut_status status = evaluate_drawn(work, model);
  if (status != STRUT_OK || !work->rest.q) return status;
  status = strut_rigidity_find(model, work->rest.q, &r, &error);
  if (status == STRUT_OK)
    put_forces(work, &r, model->scene->member_count);
  else
    status = strut_compare_leave_failed(work, STRUT_COMPARE_PRESTRESS, STRUT_COMPARE_COMPRESSION,
                                        &error, status, true);
  strut_rigidity_free(&r);
  return status;
}

/* ---- states ---- */

/* Adds a state to those before it, which are in order; of one energy they stay in the list's. */
static void insert_by_energy(strut_compare_column *column, strut_compare_state state) {
  size_t k = column->state_count++;
  for (; k > 0 && column->states[k - 1].energy > state.energy; k--)
    column->states[k] = column->states[k - 1];
  column->states[k] = state;
}

static strut_status keep_states(strut_compare_work *work, const strut_equilibria *all) {
  strut_compare_column *column = work->column;
  column->states = strut_arena_allocate(work->arena, all->count + 1, sizeof *column->states);
  column->barriers =
      strut_arena_allocate(work->arena, all->barrier_count + 1, sizeof *column->barriers);
  const char **names = strut_arena_allocate(work->arena, all->count + 1, sizeof *names);
  if (!column->states || !column->barriers || !names) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < all->count; i++) {
    names[i] = strut_arena_format(work->arena, "%s", all->list[i].name);
    if (!names[i]) return STRUT_NO_MEMORY;
    if (all->list[i].outcome == STRUT_OUTCOME_STANDS)
      insert_by_energy(column, (strut_compare_state){names[i], all->list[i].energy});
  }
  for (size_t i = 0; i < all->barrier_count; i++)
    column->barriers[column->barrier_count++] = (strut_compare_barrier){
        names[all->barriers[i].from], names[all->barriers[i].to], all->barriers[i].height};
  return STRUT_OK;
}

/* The name under which the list has the equilibrium that a run starts in, or NULL. */
static const char *start_name(const strut_compare_work *work, const strut_model *model,
                              const strut_equilibria *all) {
  const double *q = work->rest.q;
  if (!q) return NULL;
  for (size_t i = 0; i < all->count; i++) {
    const strut_equilibrium *equilibrium = &all->list[i];
    const double *p = equilibrium->rest ? equilibrium->rest : equilibrium->point.q;
    double shift = p[0] - q[0], apart = 0.0; /* along the ground it may lie anywhere */
    if (equilibrium->outcome != STRUT_OUTCOME_STANDS) continue;
    for (int32_t k = 0; k < 2 * model->node_count; k++)
      apart = fmax(apart,
                   fabs(p[k] - q[k] -
                        (k % 2 || !strut_contacts_allow_travel(&model->contacts) ? 0.0 : shift)));
    if (apart <= 1e-3 * model->size) return equilibrium->name;
  }
  return NULL;
}

static void put_barrier(strut_compare_work *work, const char *from, const strut_equilibria *all) {
  const strut_compare_quantity at = STRUT_COMPARE_LOWEST_BARRIER;
  double lowest = HUGE_VAL;
  for (size_t i = 0; from && i < all->barrier_count; i++)
    if (all->list[all->barriers[i].from].name == from)
      lowest = fmin(lowest, all->barriers[i].height);
  if (isfinite(lowest))
    strut_compare_put(work, at, lowest);
  else
    strut_compare_leave(
        work, at, at,
        from ? "no path to another state is known" : "the start is in none of the listed states");
}

static void put_states(strut_compare_work *work, const char *from, const strut_equilibria *all) {
  const strut_compare_column *column = work->column;
  strut_compare_put(work, STRUT_COMPARE_STATES, (double)column->state_count);
  if (column->state_count == 0) {
    const char *why = strut_arena_format(
        work->arena, "%s", all->remark[0] ? all->remark : "there is no state in which it stands");
    strut_compare_leave(work, STRUT_COMPARE_LOWEST_ENERGY, STRUT_COMPARE_LOWEST_BARRIER,
                        why ? why : "there is none");
    return;
  }
  double low = column->states[0].energy, high = column->states[column->state_count - 1].energy;
  strut_compare_put(work, STRUT_COMPARE_LOWEST_ENERGY, low);
  strut_compare_put(work, STRUT_COMPARE_ENERGY_SPAN, high - low);
  put_barrier(work, from, all);
}

strut_status strut_compare_states(strut_compare_work *work, const strut_model *model) {
  const strut_equilibria_options wanted = {.interrupt = work->options->interrupt};
  strut_error error = {0};
  strut_equilibria all = {0};
  if (work->options->no_states) {
    strut_compare_leave(work, STRUT_COMPARE_STATES, STRUT_COMPARE_LOWEST_BARRIER, "not requested");
    return STRUT_OK;
  }
  strut_status status =
      strut_equilibria_find(model, &work->column->input->setup->experiment, &wanted, &all, &error);
  if (status == STRUT_OK) {
    status = keep_states(work, &all);
    if (status == STRUT_OK) put_states(work, start_name(work, model, &all), &all);
  } else {
    status = strut_compare_leave_failed(work, STRUT_COMPARE_STATES, STRUT_COMPARE_LOWEST_BARRIER,
                                        &error, status, true);
  }
  strut_equilibria_free(&all);
  return status;
}

/* ---- frequencies ---- */

strut_status strut_compare_frequencies(strut_compare_work *work, const strut_model *model) {
  const strut_modes_options wanted = {.at = NULL};
  strut_error error = {0};
  strut_modes modes = {0};
  strut_status status =
      strut_modes_find(model, &work->column->input->setup->experiment, &wanted, &modes, &error);
  if (status == STRUT_OK) {
    int found = 0;
    strut_compare_leave(work, STRUT_COMPARE_FREQUENCY_1, STRUT_COMPARE_FREQUENCY_3,
                        "the model has fewer elastic modes");
    for (size_t i = 0; i < modes.count && found < STRUT_COMPARE_FREQUENCIES; i++)
      if (modes.list[i].kind == STRUT_MODE_ELASTIC || modes.list[i].kind == STRUT_MODE_UNKNOWN)
        strut_compare_put(work, (strut_compare_quantity)(STRUT_COMPARE_FREQUENCY_1 + found++),
                          modes.list[i].angular_frequency / STRUT_TAU);
  } else {
    status = strut_compare_leave_failed(work, STRUT_COMPARE_FREQUENCY_1, STRUT_COMPARE_FREQUENCY_3,
                                        &error, status, false);
  }
  strut_modes_free(&modes);
  return status;
}

/* ---- stiffness of every node ---- */

static void put_softest(strut_compare_work *work, const strut_model *model) {
  strut_compare_column *column = work->column;
  for (int d = 0; d < 2; d++) {
    const strut_compare_quantity at = d ? STRUT_COMPARE_STIFFNESS_Y : STRUT_COMPARE_STIFFNESS_X;
    for (int32_t i = 0; i < model->node_count; i++) {
      bool softer = column->softest[d] < 0 ||
                    column->stiffness[i][d] < column->stiffness[column->softest[d]][d];
      if (isfinite(column->stiffness[i][d]) && softer) column->softest[d] = i;
    }
    if (column->softest[d] >= 0)
      strut_compare_put(work, at, column->stiffness[column->softest[d]][d]);
    else
      strut_compare_leave(work, at, at, "no node can move in that direction");
  }
}

strut_status strut_compare_stiffness(strut_compare_work *work, const strut_model *model) {
  static const double axes[2][2] = {{1.0, 0.0}, {0.0, 1.0}};
  strut_node_stiffness *stiffness = NULL;
  strut_compare_column *column = work->column;
  const char *reason;
  strut_error error = {0};
  strut_status status =
      strut_node_stiffness_create(model, work->rest.q, &stiffness, &reason, &error);
  if (status) return status;
  if (!stiffness) {
    strut_compare_leave(work, STRUT_COMPARE_STIFFNESS_X, STRUT_COMPARE_STIFFNESS_Y, reason);
    return STRUT_OK;
  }
  column->stiffness =
      strut_arena_allocate(work->arena, (size_t)model->node_count, sizeof *column->stiffness);
  for (int32_t i = 0; i < model->node_count && column->stiffness; i++)
    for (int d = 0; d < 2; d++)
      column->stiffness[i][d] = strut_node_stiffness_along(stiffness, i, axes[d]);
  strut_node_stiffness_free(stiffness);
  if (!column->stiffness) return STRUT_NO_MEMORY;
  put_softest(work, model);
  return STRUT_OK;
}
