/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How a structure moves: its run to a wanted accuracy, which for a driven one ends when the motion is
 * steady; then whole periods of that motion, for energies and contacts.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/forces/memory.h"
#include "engine/run/accuracy/accuracy.h"
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

static strut_status put_contacts(strut_compare_work *work, const strut_summary *s) {
  strut_compare_column *c = work->column;
  double sum = 0.0, touching = 0.0;
  c->contacts = strut_arena_allocate(work->arena, s->contact_count + 1, sizeof *c->contacts);
  if (!c->contacts) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < s->contact_count; i++) {
    c->contacts[c->contact_count++] = s->contacts[i];
    if (s->contacts[i].duty > 0.0) touching++;
    sum += s->contacts[i].duty;
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

static void put_velocity(strut_compare_work *work, const strut_summary *s, double period) {
  strut_compare_put(work, STRUT_COMPARE_VELOCITY, s->velocity);
  strut_compare_put(work, STRUT_COMPARE_VELOCITY_ERROR, s->accuracy.expected);
  if (period > 0.0)
    strut_compare_put(work, STRUT_COMPARE_TRAVEL, s->velocity * period);
  else
    strut_compare_leave(work, STRUT_COMPARE_TRAVEL, STRUT_COMPARE_TRAVEL,
                        "the run is not given in periods");
}

static void put_cost(strut_compare_work *work, const strut_summary *s, double cpu) {
  double spent = (double)(s->force_evaluations + s->accuracy.check_evaluations);
  strut_compare_put(work, STRUT_COMPARE_EVALUATIONS, spent / s->duration);
  strut_compare_put(work, STRUT_COMPARE_CPU, cpu / s->duration);
}

static strut_status put_motion(strut_compare_work *work, const strut_summary *run,
                               const strut_snapshot *end, double cpu) {
  strut_compare_column *c = work->column;
  strut_error error = {0};
  double period = strut_experiment_span(&c->input->setup->experiment, c->model->scene).period,
         seconds = run->duration;
  c->motion = word_of(run->steady.kind);
  c->repeats = run->steady.kind == STRUT_MOTION_PERIODIC ? run->steady.repeats : 0;
  c->how = strut_arena_format(work->arena, "%s", run->accuracy.why);
  if (!c->how) return STRUT_NO_MEMORY;
  c->inaccurate = strut_summary_is_inaccurate(run);
  double uncertain = run->accuracy.expected * fmax(fabs(run->velocity), run->accuracy.scale);
  c->still = fabs(run->velocity) <= uncertain;
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
  strut_experiment *e = &work->column->input->setup->experiment;
  const char *none = work->options->no_motion               ? "not requested"
                     : !(e->duration > 0 || e->periods > 0) ? "the model has no run"
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
      .memory = strut_arena_allocate(work->arena, strut_memory_count(model), sizeof *end.memory)};
  if (!end.q || !end.v || !end.memory) return STRUT_NO_MEMORY;
  e->accuracy = work->options->accuracy;
  e->steady.wanted = e->periods > 0.0;
  e->quantity_count = 0; /* the accuracy is that of the velocity */
  const strut_run_options wanted = {.interrupt = work->options->interrupt, .to = &end};
  double began = strut_tradeoff_cpu_clock();
  strut_status status = strut_simulate_accurately(model, e, &wanted, &summary, &error);
  double cpu = strut_tradeoff_cpu_clock() - began;
  if (status == STRUT_OK)
    status = put_motion(work, &summary, &end, cpu);
  else
    status = strut_compare_leave_failed(work, STRUT_COMPARE_VELOCITY, STRUT_COMPARE_CPU, &error,
                                        status, true);
  strut_summary_free(&summary);
  return status;
}
