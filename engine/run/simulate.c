/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/simulate.h"

#include <math.h>
#include <string.h>
#include <time.h>

#include "engine/base/subnormals.h"
#include "engine/run/simulate_parts.h"

/* Work, in members times steps, between two looks at the state and at the interrupt flag. */
static const int64_t CHUNK_WORK = 2000, LONGEST_CHUNK = 64;

double strut_run_clock(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Where to stop stepping for a while: a sample, the window, the end, or just to look around. */
static int64_t next_stop(const strut_run *r, int64_t chunk) {
  int64_t n = r->state->step, stop = n + chunk;
  int64_t sample = strut_recording_next_step(&r->recording);
  int64_t window = strut_measure_first_step(&r->measure);
  int64_t whole = strut_time_grid_rest(&r->grid) > 0.0 ? r->steps - 1 : r->steps;
  if (stop > whole) stop = n < whole ? whole : r->steps;
  if (sample > n && stop > sample) stop = sample;
  if (window > n && stop > window) stop = window;
  if (r->balance.next > n && stop > r->balance.next) stop = r->balance.next;
  if (!r->watching) return stop;
  int64_t period = r->period_steps, past = (n - r->first) % period, end = n - past + period;
  int64_t middle = n - past + strut_run_middle(period);
  if (middle > n && stop > middle) stop = middle;
  return stop > end ? end : stop;
}

static void step_with_quantities(strut_run *r, int64_t stop) {
  while (r->state->step < stop) {
    r->method->advance(r->model, r->state, r->workspace, r->dt, 1);
    strut_measure_step_quantities(r->model, r->state, &r->measure);
  }
}

static void step_to(strut_run *r, int64_t stop) {
  int64_t n = r->state->step;
  if (n < strut_measure_first_step(&r->measure)) {
    r->method->advance(r->model, r->state, r->workspace, r->dt, stop - n);
    return;
  }
  if (r->measure.quantities) {
    step_with_quantities(r, stop);
    return;
  }
  for (; n < stop; n++) {
    r->method->advance(r->model, r->state, r->workspace, r->dt, 1);
    strut_measure_step(r->model, r->state, &r->measure);
  }
}

double strut_run_time(const strut_run *r) { return strut_time_grid_real(&r->grid, r->state->step); }

bool strut_run_last_step_due(const strut_run *r) {
  return r->state->step == r->grid.last - 1 && strut_time_grid_rest(&r->grid) > 0.0;
}

/* A step of another length: n times that is not the time, so drives are told how much later it is. */
static void take_last_step(strut_run *r) {
  strut_state *state = r->state;
  double length = strut_time_grid_rest(&r->grid), before = state->time_offset;
  double later = (double)state->step * (r->dt - length);
  state->time_offset += later;
  state->refined_until -= later;
  state->drive_time = (double)NAN;
  r->method->advance(r->model, state, r->workspace, length, 1);
  state->time_offset = before;
  state->refined_until += later;
  state->drive_time = (double)NAN;
  if (state->step != r->grid.last || state->step <= strut_measure_first_step(&r->measure)) return;
  if (r->measure.quantities)
    strut_measure_step_quantities(r->model, state, &r->measure);
  else
    strut_measure_step(r->model, state, &r->measure);
}

/* Motion that has died away must not be slow: numbers too small for full speed are zero. */
void strut_run_step(strut_run *r, int64_t stop) {
  unsigned before = strut_subnormals_off();
  if (strut_run_last_step_due(r))
    take_last_step(r);
  else
    step_to(r, stop);
  strut_subnormals_restore(before);
}

static void look_at_balance(strut_run *r) {
  strut_balance_sample(r->model, r->state, &r->initial,
                       strut_time_grid_at(&r->grid, r->state->step), &r->balance,
                       &r->summary->energy);
}

strut_status strut_run_sample(strut_run *r, int64_t *stop) {
  const strut_run_options *o = r->options;
  int64_t n = r->state->step;
  int32_t lost = strut_run_lost_node(r->model, r->state);
  strut_status guarded = strut_run_watch_step(r);
  *stop = n;
  if (guarded) return guarded;
  if (lost >= 0) return strut_run_diverged(r, lost);
  if (n >= r->balance.next) look_at_balance(r);
  strut_status watched = r->watching ? strut_run_watch(r) : STRUT_OK;
  if (watched) return watched;
  if (n == strut_measure_first_step(&r->measure))
    strut_measure_begin(r->model, r->state, &r->measure);
  if (n == strut_recording_next_step(&r->recording) ||
      (n >= r->steps && strut_recording_lacks(&r->recording, n))) {
    strut_status status = strut_recording_sample(r->model, r->state, &r->recording, r->error);
    if (status) return status;
  }
  if (n >= r->steps) return STRUT_OK;
  if (o->interrupt && *o->interrupt)
    return strut_fail(r->error, STRUT_INTERRUPTED, "interrupted at t = %.9g s", strut_run_time(r));
  if (r->state->trouble == STRUT_FAILURE_WORK ||
      (o->most_evaluations > 0 && r->state->evaluations > o->most_evaluations))
    return strut_fail(r->error, STRUT_WORK_LIMIT,
                      "%s used up the work allowed, %lld evaluations of the forces, by t = %.9g s",
                      r->method->name, (long long)o->most_evaluations, strut_run_time(r));
  if (r->state->trouble) return strut_run_stuck(r);
  if (o->progress && strut_run_clock() - r->told > 0.1) {
    o->progress(o->progress_context, (double)(n - r->first) / (double)(r->steps - r->first));
    r->told = strut_run_clock();
  }
  *stop = next_stop(r, r->chunk);
  return STRUT_OK;
}

/* The end of the run for whoever goes on from it. */
static void keep_end(const strut_run *r) {
  strut_snapshot *to = r->options->to;
  if (!to) return;
  size_t bytes = (size_t)r->model->length * sizeof(double);
  memcpy(to->q, r->state->q, bytes);
  memcpy(to->v, r->state->v, bytes);
  to->time = strut_run_time(r);
  to->refined = fmax(0.0, r->state->refined_until - (to->time - r->grid.offset));
}

static void fill_contacts(strut_run *r) {
  for (int32_t i = 0; i < r->model->contacts.count; i++)
    r->summary->contacts[i].band_needed = strut_stick_band_missed(r->model, &r->band, i);
}

static void fill_summary(strut_run *r, strut_status status) {
  strut_summary *s = r->summary;
  fill_contacts(r);
  s->status = status;
  s->steps = r->state->step - r->first;
  s->duration = (double)(s->steps + r->shot_periods * r->period_steps) * r->dt;
  if (r->state->step == r->grid.last)
    s->duration = strut_experiment_span(r->experiment, r->model->scene).duration;
  s->force_evaluations = r->state->evaluations;
  s->events = r->state->events;
  s->limit_fell = (strut_step_limit_violation){.limit = r->guard.lowest,
                                               .time = r->guard.lowest_time,
                                               .since = r->guard.first_time,
                                               .steps = r->guard.steps_below};
  strut_measure_finish(&r->measure, s);
  if (r->watching) strut_steady_detector_finish(&r->watch, s);
  s->velocity_zero = strut_measure_is_zero(&r->measure, s->velocity);
  for (size_t i = 0; i < 2 * s->node_count; i++) s->positions[i] = r->state->q[i];
  if (r->state->ledger) {
    look_at_balance(r);
    s->balance = strut_balance_judge(&s->energy, s->steps);
  }
  strut_run_warn(r);
  keep_end(r);
}

strut_status strut_run_begin(const strut_model *model, const strut_experiment *experiment,
                             const strut_run_options *options, strut_step_limits *limits,
                             strut_summary *summary, strut_error *error, strut_run *r) {
  int64_t chunk = CHUNK_WORK / (model->members.count + model->node_count + 1);
  *summary = (strut_summary){.velocity = (double)NAN, .velocity_spread = (double)NAN};
  *r = (strut_run){.model = model,
                   .experiment = experiment,
                   .options = options,
                   .limits = limits,
                   .summary = summary,
                   .error = error};
  r->chunk = chunk < 1 ? 1 : chunk > LONGEST_CHUNK ? LONGEST_CHUNK : chunk;
  strut_status status = strut_run_prepare(r);
  r->begun = !status;
  r->began = r->told = strut_run_clock();
  return status;
}

strut_status strut_run_end(strut_run *r, strut_status status) {
  strut_summary *summary = r->summary;
  strut_error *error = r->error;
  if (r->begun) {
    summary->wall_time = strut_run_clock() - r->began;
    fill_summary(r, status);
    strut_error first = *error;
    strut_status written = strut_recording_finish(&r->recording, status, error);
    if (written && (!status || status == STRUT_DIVERGED || status == STRUT_INTERRUPTED))
      status = written;
    else if (status)
      *error = first;
  }
  summary->status = status;
  for (size_t i = 0; status && i + 1 < sizeof summary->reason; i++)
    if (!(summary->reason[i] = error->message[i])) break;
  strut_recording_free(&r->recording);
  strut_measure_free(&r->measure);
  strut_steady_detector_free(&r->watch);
  strut_state_free(r->state);
  return status;
}

strut_status strut_simulate(const strut_model *model, const strut_experiment *experiment,
                            const strut_run_options *options, strut_summary *summary,
                            strut_error *error) {
  strut_error own = {0};
  strut_run r;
  int64_t stop = INT64_MAX;
  strut_status status =
      strut_run_begin(model, experiment, options, NULL, summary, error ? error : &own, &r);
  while (!status) {
    status = strut_run_sample(&r, &stop);
    if (status || stop == r.state->step) break;
    strut_run_step(&r, stop);
  }
  return strut_run_end(&r, status);
}
