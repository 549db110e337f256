/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What comes before the first step of a run. */
#include <math.h>
#include <string.h>

#include "engine/integrate/limit/step_limit.h"
#include "engine/model/memory_estimate.h"
#include "engine/run/settle.h"
#include "engine/run/simulate_parts.h"

static strut_status refuse_large_step(const strut_run *r, bool bound) {
  double limit = r->summary->step_limit;
  if (r->dt <= limit || r->options->force) return STRUT_OK;
  if (bound)
    return strut_fail(
        r->error, STRUT_STEP_TOO_LARGE,
        "the step %g s is above %.4g s, up to which %s is stable (all contacts closed; "
        "a bound, the structure being too large for its largest stable step to be "
        "found); use solver.step <= %.3g s, or --force to run all the same",
        r->dt, limit, r->method->name, 0.99 * limit);
  return strut_fail(r->error, STRUT_STEP_TOO_LARGE,
                    "the step %g s is above the largest stable step of %s, %.4g s (all contacts "
                    "closed); use solver.step <= %.2g s, or --force to run all the same",
                    r->dt, r->method->name, limit, 0.9 * limit);
}

static strut_status fill_names(strut_run *r) {
  const strut_scene *scene = r->model->scene;
  strut_summary *s = r->summary;
  const strut_experiment *e = r->experiment;
  size_t contacts = (size_t)r->model->contacts.count;
  s->node_names = strut_allocate(scene->node_count, sizeof *s->node_names);
  s->positions = strut_allocate(2 * scene->node_count, sizeof *s->positions);
  s->contacts = strut_allocate(contacts, sizeof *s->contacts);
  if (e->quantity_count) s->measured = strut_allocate(e->quantity_count, sizeof *s->measured);
  if (!s->node_names || !s->positions || !s->contacts || (e->quantity_count && !s->measured))
    return strut_memory_fail_model(r->model->scene, r->error);
  s->node_count = scene->node_count;
  s->contact_count = contacts;
  s->measured_count = e->quantity_count;
  if (e->measure_node >= 0) s->measured_node = scene->nodes[e->measure_node].name;
  for (size_t i = 0; i < s->measured_count; i++)
    s->measured[i] = (strut_measured){.name = e->quantities[i].name,
                                      .unit = e->quantities[i].unit,
                                      .value = (double)NAN,
                                      .spread = (double)NAN,
                                      .scale = (double)NAN,
                                      .expected = (double)NAN};
  for (size_t i = 0; i < s->node_count; i++) s->node_names[i] = scene->nodes[i].name;
  for (size_t i = 0; i < contacts; i++)
    s->contacts[i].node = scene->nodes[r->model->contacts.entry[i].node].name;
  return STRUT_OK;
}

/* The step, made to divide the drive's period where that is watched; first and last step. */
static void choose_steps(strut_run *r, const strut_span *span) {
  const strut_experiment *e = r->experiment;
  double last = e->output_last;
  r->dt = e->step;
  if (r->watching) {
    r->period_steps = (int64_t)ceil(span->period / r->dt * (1.0 - 1e-9));
    r->dt = span->period / (double)r->period_steps;
    r->more_periods = r->options->sink_count && last > 1.0 ? (int64_t)ceil(last - 1e-9) : 1;
  }
  r->summary->step = r->dt;
  r->first = r->options->from ? llround(r->options->from->time / r->dt) : 0;
  r->steps = r->first + (int64_t)ceil(span->duration / r->dt - 1e-6);
  r->grid = (strut_time_grid){
      .step = r->dt, .last = r->steps, .end = (double)r->first * r->dt + span->duration};
  double offset = r->options->from ? r->options->from->time - (double)r->first * r->dt : 0.0;
  if (!r->watching && fabs(offset) > 1e-6 * r->dt) r->grid.offset = offset;
}

/* Where the run begins: as the scene says, settled, or where another one ended. */
static strut_status place_state(strut_run *r) {
  const strut_snapshot *from = r->options->from;
  size_t bytes = (size_t)r->model->length * sizeof(double);
  r->state->step = r->first;
  if (from) {
    memcpy(r->state->q, from->q, bytes);
    memcpy(r->state->v, from->v, bytes);
    r->state->refined_until = from->time - r->grid.offset + from->refined;
    return STRUT_OK;
  }
  if (!r->experiment->settle.wanted) return STRUT_OK;
  memset(r->state->v, 0, bytes);
  return strut_settle_experiment(r->model, r->experiment, r->limits, r->options->interrupt,
                                 r->state->q, &r->summary->settle_time, &r->summary->settle,
                                 r->error);
}

strut_status strut_run_prepare(strut_run *r) {
  const strut_scene *scene = r->model->scene;
  strut_span span = strut_experiment_span(r->experiment, scene);
  r->watching = r->experiment->steady.wanted && span.period > 0.0;
  choose_steps(r, &span);
  strut_status status = strut_integrator_check(r->model, r->experiment, r->error);
  if (status) return status;
  r->method = strut_integrator_find(r->experiment->integrator);
  for (size_t i = 0; i + 1 < sizeof r->summary->method && r->method->name[i]; i++)
    r->summary->method[i] = r->method->name[i];
  if (scene->start_equilibrium >= 0)
    return strut_fail(r->error, STRUT_USAGE,
                      "the run wants to start at the equilibrium of configuration '%s'; resolve it "
                      "into positions first (strut_resolve_start_equilibrium)",
                      scene->configurations[scene->start_equilibrium].name);
  if (!r->model->mass)
    return strut_fail(r->error, STRUT_SINGULAR, "some node that can move has no mass");
  double *limit = &r->summary->step_limit;
  bool bound = false;
  status = r->limits ? strut_step_limit_cached(r->model, r->method, r->limits, limit, r->error)
                     : strut_step_limit_with_bound(r->model, r->method, limit, &bound, r->error);
  if (status) return status;
  if ((status = refuse_large_step(r, bound)) || (status = fill_names(r)) ||
      (status = strut_state_create(r->model, &r->state, r->error)))
    return status;
  const strut_integrator_settings settings = strut_integrator_settings_of(r->experiment);
  r->workspace = r->method->create(r->model, r->state, &settings);
  double begin = (double)r->first * r->dt;
  int64_t room = r->more_periods > STRUT_LONGEST_REPEAT ? r->more_periods : STRUT_LONGEST_REPEAT;
  if (!r->workspace ||
      strut_measure_create(r->model, r->experiment, &r->grid, begin, (size_t)room + 1,
                           &r->measure) ||
      (r->watching && strut_steady_detector_create(r->model, &r->experiment->steady, span.period,
                                                   begin, &r->watch)))
    return strut_memory_fail_model(r->model->scene, r->error);
  if ((status = place_state(r))) return status;
  r->state->time_offset = r->grid.offset;
  r->state->ledger = !r->options->without_ledger || strut_quantities_need_ledger(r->experiment);
  r->state->interrupt = r->options->interrupt;
  r->state->most_evaluations = r->options->most_evaluations;
  if (r->method->restart) r->method->restart(r->model, r->state, r->workspace, r->dt);
  if (!strut_step_limit_monitor_create(r->model, r->state, r->method, r->dt, &r->guard) ||
      !strut_stick_band_create(r->model, r->state, r->method, r->dt, &r->band))
    return strut_memory_fail_model(r->model->scene, r->error);
  strut_energy_reset_load_work(r->model, r->state);
  r->initial = strut_energy_evaluate(r->model, r->state, begin);
  strut_balance_begin(r->state, &r->initial, begin, r->method->evaluations, &r->balance);
  return strut_recording_create(r->model, r->experiment, &r->grid, begin, r->options->sinks,
                                r->options->sink_count, &r->recording, r->error);
}
