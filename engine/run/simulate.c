/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/simulate.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "engine/base/subnormals.h"
#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/support_motion.h"
#include "engine/forces/forces.h"
#include "engine/forces/history.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/run/settle.h"
#include "engine/run/simulate_parts.h"
#include "engine/scene/signal_program.h"

/* Members times steps between two checks of the state and the interrupt flag. */
static const int64_t CHUNK_WORK = 2000, LONGEST_CHUNK = 64;

double strut_run_clock(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- before the first step ---- */

/* More steps than these are refused, so that to recommend them is no help. */
static const double MOST_STEPS = 1e15;
/* At the limit itself a motion may grow; what rounding leaves of a limit does not matter. */
static const double AT_LIMIT = 1.0 - 1e-9;

static strut_status check_step_limit(const strut_run *r, bool bound) {
  double limit = r->summary->step_limit, duration = (double)(r->steps - r->first) * r->dt;
  if (r->dt < AT_LIMIT * limit || r->options->force) return STRUT_OK;
  if (!(limit * MOST_STEPS > duration))
    return strut_fail(r->error, STRUT_STEP_TOO_LARGE,
                      "the largest stable step of %s would be %.2g s (all contacts closed), too "
                      "small for a run of %.4g s: stiffnesses or dampings are far too large beside "
                      "the masses; check their units",
                      r->method->name, limit, duration);
  if (bound)
    return strut_fail(r->error, STRUT_STEP_TOO_LARGE,
                      "the step %g s is above %.4g s, a bound below which %s is stable (all "
                      "contacts closed; the structure is too large to compute its largest stable "
                      "step); use solver.step <= %.3g s, or --force to run anyway",
                      r->dt, limit, r->method->name, 0.99 * limit);
  return strut_fail(r->error, STRUT_STEP_TOO_LARGE,
                    "the step %g s is %s the largest stable step of %s, %.4g s (all contacts "
                    "closed); use solver.step <= %.2g s, or --force to run anyway",
                    r->dt, r->dt > limit ? "above" : "at", r->method->name, limit, 0.9 * limit);
}

/* Steps for a turn of what turns fastest, below which its mean over a step is wrong, or nothing is right. */
static const double FEW_STEPS = 10.0, LEAST_STEPS_OF_TURN = 2.0;

/* Methods whose own error does not choose their steps do not notice what turns about once in a step. */
static strut_status check_turns(const strut_run *r) {
  strut_turning fastest =
      strut_scene_fastest_turn(r->model->scene, (double)r->steps * r->dt, r->method->events);
  double steps = 1.0 / (fastest.rate * r->dt);
  if (strut_integrator_controls_error(r->method) || !(steps < FEW_STEPS)) return STRUT_OK;
  if (steps < LEAST_STEPS_OF_TURN && !r->options->force)
    return strut_fail(
        r->error, STRUT_STEP_TOO_LARGE,
        "%s turns at %.4g Hz, %.3g times in a step of %g s of %s, which sees "
        "nothing of that; use solver.step <= %.2g s, adaptive, or --force to run anyway",
        fastest.name, fastest.rate, 1.0 / steps, r->dt, r->method->name,
        0.5 / (FEW_STEPS * fastest.rate));
  if (!r->options->chosen)
    strut_summary_warn(r->summary, "coarse_step",
                       "%s turns at %.4g Hz, once in %.3g steps of %g s, too few to follow "
                       "it; use solver.step <= %.2g s, adaptive, or --accuracy 1%%",
                       fastest.name, fastest.rate, steps, r->dt, 0.5 / (FEW_STEPS * fastest.rate));
  return STRUT_OK;
}

static strut_status allocate_summary(strut_run *r) {
  const strut_scene *scene = r->model->scene;
  strut_summary *s = r->summary;
  const strut_experiment *e = r->experiment;
  size_t contacts = (size_t)r->model->contacts.count;
  s->end.node_names = strut_allocate(scene->node_count, sizeof *s->end.node_names);
  s->end.positions = strut_allocate(2 * scene->node_count, sizeof *s->end.positions);
  s->end.contacts = strut_allocate(contacts, sizeof *s->end.contacts);
  s->end.hinges = strut_allocate(scene->hinge_count, sizeof *s->end.hinges);
  s->end.cells = strut_allocate(scene->cell_count, sizeof *s->end.cells);
  s->end.breaks = strut_allocate((size_t)r->model->elements.breakable_count, sizeof *s->end.breaks);
  s->end.jumps = strut_allocate((size_t)r->model->elements.history_count, sizeof *s->end.jumps);
  if (e->quantity_count) s->measured = strut_allocate(e->quantity_count, sizeof *s->measured);
  if (!s->end.node_names || !s->end.positions || !s->end.contacts || !s->end.hinges ||
      !s->end.cells || !s->end.breaks || !s->end.jumps || (e->quantity_count && !s->measured))
    return strut_no_memory(r->error, "for the model");
  s->end.node_count = scene->node_count;
  s->end.contact_count = contacts;
  s->end.hinge_count = scene->hinge_count;
  s->end.cell_count = scene->cell_count;
  s->measured_count = e->quantity_count;
  if (e->measure_node >= 0) s->measured_node = scene->nodes[e->measure_node].name;
  for (size_t i = 0; i < s->measured_count; i++)
    s->measured[i] = (strut_measured){.name = e->quantities[i].name,
                                      .unit = e->quantities[i].unit,
                                      .value = (double)NAN,
                                      .spread = (double)NAN,
                                      .scale = (double)NAN,
                                      .expected = (double)NAN,
                                      .margin = (double)NAN,
                                      .arrival = e->quantities[i].take == STRUT_TAKE_ARRIVAL};
  for (size_t i = 0; i < s->end.node_count; i++) s->end.node_names[i] = scene->nodes[i].name;
  for (size_t i = 0; i < s->end.hinge_count; i++)
    s->end.hinges[i] = (strut_hinge_summary){scene->hinges[i].name, (double)NAN, (double)NAN};
  for (size_t i = 0; i < s->end.cell_count; i++)
    s->end.cells[i] = (strut_cell_summary){scene->cells[i].name, (double)NAN, (double)NAN};
  for (size_t i = 0; i < contacts; i++) s->end.contacts[i].node = strut_contact_name(scene, i);
  return STRUT_OK;
}

/*
 * Chooses the step, which divides the drive period where steady motion is detected, and the first
 * and last step number.
 */
static void choose_steps(strut_run *r, const strut_span *span) {
  const strut_experiment *e = r->experiment;
  double last = e->output_last;
  r->dt = e->step;
  if (r->steady.wanted) {
    r->steady.period_steps = (int64_t)ceil(span->period / r->dt * (1.0 - 1e-9));
    r->dt = span->period / (double)r->steady.period_steps;
    r->steady.recorded_periods = r->options->sink_count ? (int64_t)ceil(last - 1e-9) : 0;
    r->steady.answer_periods = e->steady.run_on > 1 ? e->steady.run_on : 1;
  }
  r->summary->step = r->dt;
  r->first = r->options->from ? llround(r->options->from->time / r->dt) : 0;
  r->steps = r->first + (int64_t)ceil(span->duration / r->dt - 1e-6);
  r->answer.step = r->steps;
  r->grid = (strut_time_grid){
      .step = r->dt, .last = r->steps, .end = (double)r->first * r->dt + span->duration};
  double offset = r->options->from ? r->options->from->time - (double)r->first * r->dt : 0.0;
  if (!r->steady.wanted && fabs(offset) > 1e-6 * r->dt) r->grid.offset = offset;
}

/* Places the state at the start: that of the scene, the settled one, or the end of another run. */
static strut_status place_state(strut_run *r) {
  const strut_snapshot *from = r->options->from;
  size_t bytes = (size_t)r->model->length * sizeof(double);
  r->state->step = r->first;
  r->state->time_offset = r->grid.offset;
  if (from) {
    memcpy(r->state->q, from->q, bytes);
    memcpy(r->state->v, from->v, bytes);
    r->state->refined_until = from->time - r->grid.offset + from->refined;
    return STRUT_OK;
  }
  if (!r->experiment->settle.wanted) return STRUT_OK;
  strut_status status = strut_settle_experiment(r->model, r->experiment, r->options->interrupt,
                                                r->state->q, &r->summary->settle, r->error);
  r->summary->settle_time = r->summary->settle.time;
  return status;
}

/* What breaks or yields at the start already, which statics and settling take as whole, is warned of. */
static void begin_history(strut_run *r, double begin) {
  const strut_snapshot *from = r->options->from;
  strut_overload worst;
  if (from && from->memory) {
    strut_history_load(r->model, r->state, from->memory);
  } else if (!from && strut_history_overload(r->model, r->state->q, &worst)) {
    strut_summary_warn(r->summary, "overloaded_start",
                       "%s '%s' carries %.4g %s at the start, above the %.4g %s at which it %s; it "
                       "does so at once",
                       worst.kind, worst.name, worst.force, worst.hinge ? "N m" : "N", worst.limit,
                       worst.hinge ? "N m" : "N", worst.breaks ? "breaks" : "yields");
  }
  strut_history_begin(r->model, r->state, begin);
}

static strut_status prepare_run(strut_run *r) {
  const strut_scene *scene = r->model->scene;
  strut_span span = strut_experiment_span(r->experiment, scene);
  r->steady.wanted = r->experiment->steady.wanted && span.period > 0.0;
  choose_steps(r, &span);
  strut_status status = strut_integrator_check(r->model, r->experiment, r->error);
  if (status) return status;
  r->method = strut_integrator_find(r->experiment->integrator);
  for (size_t i = 0; i + 1 < sizeof r->summary->method && r->method->name[i]; i++)
    r->summary->method[i] = r->method->name[i];
  if (scene->start_equilibrium >= 0)
    return strut_fail(r->error, STRUT_USAGE,
                      "the run starts at the equilibrium of configuration '%s'; resolve it to "
                      "positions first with strut_resolve_start_equilibrium",
                      scene->configurations[scene->start_equilibrium].name);
  if (!r->model->mass) return strut_fail(r->error, STRUT_SINGULAR, "a free node has no mass");
  if ((status = strut_integrator_check_samples(r->method, r->model, r->dt, r->error)))
    return status;
  if ((status = check_turns(r))) return status;
  r->summary->feedback = strut_scene_has_feedback(scene);
  double *limit = &r->summary->step_limit;
  bool bound = false;
  status = strut_step_limit_with_bound(r->model, r->method, limit, &bound, r->error);
  if (status) return status;
  if (!r->options->force &&
      (status = strut_step_limit_check_effort(r->model, r->method, r->dt, r->error)))
    return status;
  if ((status = check_step_limit(r, bound)) || (status = allocate_summary(r)) ||
      (status = strut_state_create(r->model, &r->state, r->error)))
    return status;
  const strut_integrator_settings settings = strut_integrator_settings_of(r->experiment);
  r->workspace = r->method->create(r->model, r->state, &settings);
  double begin = (double)r->first * r->dt;
  int64_t marks = r->steady.answer_periods > STRUT_LONGEST_REPEAT ? r->steady.answer_periods
                                                                  : STRUT_LONGEST_REPEAT;
  if (!r->workspace ||
      strut_measure_create(r->model, r->experiment, &r->grid, begin, (size_t)marks + 1,
                           &r->measure) ||
      (r->steady.wanted && strut_steady_detector_create(r->model, &r->experiment->steady,
                                                        span.period, begin, &r->steady.detector)))
    return strut_no_memory(r->error, "for the model");
  if (r->measure.quantities && strut_quantities_need_pieces(r->measure.quantities) &&
      r->method->observe) {
    if (!r->method->observe(r->model, r->state, r->workspace))
      return strut_no_memory(r->error, "for the model");
    strut_quantities_observe(r->measure.quantities);
  }
  if ((status = place_state(r))) return status;
  if (r->model->terms & STRUT_TERM_SUPPORT_MOTION)
    strut_support_motion_place(r->model, r->state, begin, r->state->q, r->state->v);
  if (r->model->terms & STRUT_TERM_MEMORY) begin_history(r, begin);
  r->state->balance = !r->options->without_balance || strut_quantities_need_balance(r->experiment);
  r->state->limits.interrupt = r->options->interrupt;
  r->state->limits.most_evaluations = r->options->most_evaluations;
  if (r->method->restart) r->method->restart(r->model, r->state, r->workspace, r->dt);
  if (!strut_step_limit_monitor_create(r->model, r->state, r->method, r->dt, &r->watch.limit) ||
      !strut_stick_band_create(r->model, r->state, r->method, r->dt, &r->watch.band) ||
      !strut_motion_frequency_create(r->model, r->state, &r->watch.frequency))
    return strut_no_memory(r->error, "for the model");
  strut_energy_reset_load_work(r->model, r->state);
  r->watch.initial = strut_energy_evaluate(r->model, r->state, begin);
  if ((status = strut_run_check_rates(r))) return status;
  if (r->options->from && r->options->from->balance && r->state->balance)
    strut_balance_continue(r->options->from->balance, r->state, &r->watch.initial);
  strut_balance_begin(r->state, &r->watch.initial, begin, r->method->evaluations,
                      &r->watch.balance);
  r->recording = (strut_recording){
      .sinks = r->options->sinks, .sink_count = r->options->sink_count, .grid = r->grid};
  return strut_recording_create(r->model, r->experiment, begin, &r->recording, r->error);
}

static void advance(strut_run *r, double dt, int64_t count) {
  strut_integrator_advance(r->method, r->model, r->state, r->workspace, dt, count);
}

/* ---- steady motion ---- */

/* A step within the period that no symmetry of the drive prefers. */
static int64_t asymmetric_phase(int64_t period) { return (int64_t)(0.382 * (double)period); }

/*
 * Samples the detector at the end of each period and once within it. Once the motion is steady, the run
 * continues for at least one period, over which contacts are measured, and which ends the summary. It may go on
 * for more that are recorded, of which the summary knows nothing: an answer does not depend on recordings.
 */
static void detect_steady_motion(strut_run *r) {
  int64_t n = r->state->step, past = (n - r->first) % r->steady.period_steps;
  if (past == asymmetric_phase(r->steady.period_steps))
    strut_steady_detector_half_period(r->state, &r->steady.detector);
  if (past != 0) return;
  double x, v;
  bool before = r->steady.detector.known;
  strut_measure_tracked_point(r->model, r->state, &r->measure, &x, &v);
  if (!strut_steady_detector_period(r->state, x, &r->steady.detector) || before) return;
  double now = (double)n * r->dt, period = r->steady.detector.period;
  int64_t periods = r->steady.answer_periods, repeats = r->steady.detector.result.repeats;
  if (r->measure.quantities && periods < repeats)
    periods = repeats; /* a window over the whole orbit */
  int64_t recorded = r->steady.recorded_periods, all = recorded > periods ? recorded : periods;
  r->answer.step = n + periods * r->steady.period_steps;
  r->steps = n + all * r->steady.period_steps;
  r->grid.last = r->measure.grid.last = r->recording.grid.last = -1;
  strut_measure_window(r->model, r->state, now, period, (size_t)periods, &r->measure);
  if (recorded > 0) r->recording.start = now + (double)(all - recorded) * period;
}

/* ---- stepping ---- */

/*
 * Finds the step at which to look at the state next: the window, a period, the end, or a check. It does not
 * depend on what is recorded.
 */
static int64_t find_next_check(const strut_run *r, int64_t chunk) {
  int64_t n = r->state->step, stop = n - (n - r->first) % chunk + chunk;
  int64_t window = strut_measure_first_step(&r->measure);
  int64_t whole = strut_time_grid_rest(&r->grid) > 0.0 ? r->steps - 1 : r->steps;
  if (stop > whole) stop = n < whole ? whole : r->steps;
  if (window > n && stop > window) stop = window;
  if (r->watch.balance.next > n && stop > r->watch.balance.next) stop = r->watch.balance.next;
  if (r->watch.limit.next > n && stop > r->watch.limit.next) stop = r->watch.limit.next;
  if (!r->steady.wanted) return stop;
  int64_t period = r->steady.period_steps, past = (n - r->first) % period, end = n - past + period;
  int64_t middle = n - past + asymmetric_phase(period);
  if (middle > n && stop > middle) stop = middle;
  return stop > end ? end : stop;
}

static void step_with_quantities(strut_run *r, int64_t stop) {
  while (r->state->step < stop) {
    advance(r, r->dt, 1);
    if (r->state->trouble) return;
    strut_measure_step_quantities(r->model, r->state, &r->measure);
  }
}

static void step_to(strut_run *r, int64_t stop) {
  int64_t n = r->state->step;
  if (n < strut_measure_first_step(&r->measure)) {
    advance(r, r->dt, stop - n);
    return;
  }
  if (r->measure.quantities) {
    step_with_quantities(r, stop);
    return;
  }
  for (; n < stop; n++) {
    advance(r, r->dt, 1);
    if (r->state->trouble) return;
    strut_measure_step(r->model, r->state, &r->measure);
  }
}

double strut_run_time(const strut_run *r) { return strut_time_grid_real(&r->grid, r->state->step); }

/* Is the next step the last one and shorter than the others? */
static bool is_short_step_due(const strut_run *r) {
  return r->state->step == r->grid.last - 1 && strut_time_grid_rest(&r->grid) > 0.0;
}

/*
 * Makes the last step of another length. Step number times step is then not the time, so the drives
 * get the difference as offset.
 */
static void step_short(strut_run *r) {
  strut_state *state = r->state;
  double length = strut_time_grid_rest(&r->grid), before = state->time_offset;
  double later = (double)state->step * (r->dt - length);
  state->time_offset += later;
  state->refined_until -= later;
  state->latest->drive_time = (double)NAN;
  advance(r, length, 1);
  state->time_offset = before;
  state->refined_until += later;
  state->latest->drive_time = (double)NAN;
  if (state->step != r->grid.last || state->step <= strut_measure_first_step(&r->measure)) return;
  if (r->measure.quantities)
    strut_measure_step_quantities(r->model, state, &r->measure);
  else
    strut_measure_step(r->model, state, &r->measure);
}

/*
 * Denormal numbers of a decayed motion would slow the processor down, so they are flushed to zero.
 */
void strut_run_step(strut_run *r, int64_t stop) {
  assert(r->ready && stop > r->state->step);
  unsigned before = strut_subnormals_off();
  if (is_short_step_due(r))
    step_short(r);
  else
    step_to(r, stop);
  strut_subnormals_restore(before);
}

static void list_jumps(const strut_run *r) {
  const strut_element_table *t = &r->model->elements;
  strut_summary *s = r->summary;
  s->end.jump_count = 0;
  for (int32_t i = 0; i < t->count; i++) {
    const strut_element *e = &t->element[i];
    if (e->law != STRUT_LAW_FOLDING) continue;
    const double *own = &r->state->latest->rest[e->slot];
    if (own[STRUT_CURVE_JUMPS] > 0.0)
      s->end.jumps[s->end.jump_count++] =
          (strut_jump_summary){.name = strut_element_name(r->model->scene, e),
                               .count = (int64_t)own[STRUT_CURVE_JUMPS],
                               .last = own[STRUT_CURVE_LAST],
                               .freed = own[STRUT_CURVE_FREED]};
  }
}

static void fill_summary(strut_run *r, strut_status status);

/*
 * The time of the state; where a drive jumps there, just after that, as a method with events has accumulated
 * its work.
 */
static double time_of_balance(const strut_run *r) {
  double t = strut_time_grid_at(&r->grid, r->state->step), near = 2e-9 * r->dt;
  if (!r->method->events) return t;
  double now = t + r->state->time_offset;
  return strut_drive_next_break(r->model, r->state, now - near, now + 2.0 * near) <= now + near
             ? t + near
             : t;
}

static strut_status sample_balance(strut_run *r) {
  if (!r->state->balance) return STRUT_OK;
  strut_balance_sample(r->model, r->state, &r->watch.initial, time_of_balance(r), &r->watch.balance,
                       &r->summary->energy);
  if (r->method->lag > 0.0)
    strut_motion_frequency_sample(r->model, r->state, r->summary->energy.kinetic,
                                  &r->watch.frequency);
  return strut_run_check_balance(r);
}

strut_status strut_run_sample(strut_run *r, int64_t *stop) {
  const strut_run_options *o = r->options;
  int64_t n = r->state->step;
  int32_t lost = strut_run_find_lost_node(r->model, r->state);
  bool due = n >= r->check || r->state->trouble;
  strut_status limit_status = due ? strut_run_check_step_limit(r) : STRUT_OK;
  assert(r->ready && n >= r->first);
  *stop = n;
  if (limit_status) return limit_status;
  strut_status states_status = due ? strut_run_check_states(r) : STRUT_OK;
  if (states_status) return states_status;
  if (lost >= 0 && due) return strut_run_fail_lost_node(r, lost);
  if (r->model->scene->collision_count) strut_run_watch_collisions(r);
  if (r->model->rubbing.bristles) strut_run_watch_bristles(r);
  strut_status collapse_status = strut_run_check_collapse(r);
  if (collapse_status) return collapse_status;
  bool balance_due = n == r->answer.step || (n >= r->watch.balance.next && n < r->answer.step);
  strut_status balance_status = balance_due ? sample_balance(r) : STRUT_OK;
  if (balance_status) return balance_status;
  if (r->steady.wanted) detect_steady_motion(r);
  if (n == strut_measure_first_step(&r->measure))
    strut_measure_begin(r->model, r->state, &r->measure);
  if (lost < 0 && (n == strut_recording_next_step(&r->recording) ||
                   (n >= r->steps && strut_recording_lacks(&r->recording, n)))) {
    strut_status status = strut_recording_sample(r->state, &r->recording, r->error);
    if (status) return status;
  }
  if (n == r->answer.step) fill_summary(r, STRUT_OK);
  if (n >= r->steps) return STRUT_OK;
  if (o->interrupt && *o->interrupt)
    return strut_fail(r->error, STRUT_INTERRUPTED, "interrupted at t = %.9g s", strut_run_time(r));
  if (r->state->trouble == STRUT_FAILURE_WORK ||
      (o->most_evaluations > 0 && r->state->latest->evaluations > o->most_evaluations))
    return strut_fail(r->error, STRUT_WORK_LIMIT,
                      "%s used up the work budget of %lld force evaluations at t = %.9g s",
                      r->method->name, (long long)o->most_evaluations, strut_run_time(r));
  if (r->state->trouble) return strut_run_fail_method(r);
  if (o->progress && strut_run_clock() - r->clock.progress > 0.1) {
    o->progress(o->progress_context, (double)(n - r->first) / (double)(r->steps - r->first));
    r->clock.progress = strut_run_clock();
  }
  int64_t sample = strut_recording_next_step(&r->recording);
  r->check = find_next_check(r, r->chunk);
  *stop = sample > n && sample < r->check ? sample : r->check;
  return STRUT_OK;
}

/* ---- the end ---- */

/* Stores the end state for a later run. */
static void store_end_state(const strut_run *r) {
  strut_snapshot *to = r->options->to;
  if (!to) return;
  size_t bytes = (size_t)r->model->length * sizeof(double);
  memcpy(to->q, r->state->q, bytes);
  memcpy(to->v, r->state->v, bytes);
  if (to->memory) strut_history_store(r->model, r->state, to->memory);
  to->time = strut_run_time(r);
  to->refined = fmax(0.0, r->state->refined_until - (to->time - r->grid.offset));
}

static void fill_contacts(strut_run *r) {
  for (int32_t i = 0; i < r->model->contacts.count; i++)
    r->summary->end.contacts[i].band_needed = strut_stick_band_missed(r->model, &r->watch.band, i);
}

/* Angles and moments of the hinges at the end, areas and pressures of the cells. */
static void measure_elements(strut_run *r) {
  const strut_scene *scene = r->model->scene;
  strut_instant instant = {.model = r->model};
  if (!scene->hinge_count && !scene->cell_count) return;
  strut_instant_show(&instant, r->state, 1u << STRUT_OBSERVED_DRIVES,
                     strut_time_grid_at(&r->grid, r->state->step));
  for (size_t i = 0; i < scene->hinge_count; i++) {
    strut_hinge_summary *hinge = &r->summary->end.hinges[i];
    hinge->angle = strut_observe_item(&instant, STRUT_COLUMN_HINGE_ANGLE, (int32_t)i);
    hinge->moment = strut_observe_item(&instant, STRUT_COLUMN_MOMENT, (int32_t)i);
  }
  for (size_t i = 0; i < scene->cell_count; i++) {
    strut_cell_summary *cell = &r->summary->end.cells[i];
    cell->area = strut_observe_item(&instant, STRUT_COLUMN_CELL_AREA, (int32_t)i);
    cell->pressure = strut_observe_item(&instant, STRUT_COLUMN_PRESSURE, (int32_t)i);
  }
}

static void list_breaks(const strut_run *r) {
  const strut_scene *scene = r->model->scene;
  strut_summary *s = r->summary;
  s->end.break_count = 0;
  for (int32_t b = 0; b < r->model->elements.breakable_count; b++) {
    const strut_breakable *what = &r->model->elements.breakable[b];
    double time = r->state->history.broken_at[b];
    bool hinge = what->role == STRUT_ELEMENT_HINGE;
    if (!(time < HUGE_VAL)) continue;
    s->end.breaks[s->end.break_count++] = (strut_break_summary){
        .name = hinge ? scene->hinges[what->item].name : scene->members[what->item].name,
        .hinge = hinge,
        .released = time == what->time,
        .time = time};
  }
}

static void fill_summary(strut_run *r, strut_status status) {
  strut_summary *s = r->summary;
  fill_contacts(r);
  s->status = status;
  s->spent.steps = r->state->step - r->first;
  s->duration = (double)s->spent.steps * r->dt;
  if (r->state->step == r->grid.last)
    s->duration = strut_experiment_span(r->experiment, r->model->scene).duration;
  s->spent.evaluations = r->state->latest->evaluations;
  s->spent.events = r->state->events;
  s->spent.forced = r->state->forced.count;
  s->limit_fell = (strut_step_limit_violation){.limit = r->watch.limit.lowest,
                                               .time = r->watch.limit.lowest_time,
                                               .since = r->watch.limit.first_time,
                                               .steps = r->watch.limit.steps_below};
  strut_measure_finish(&r->measure, s);
  if (r->steady.wanted) strut_steady_detector_finish(&r->steady.detector, s);
  s->velocity_zero = strut_measure_is_zero(&r->measure, s);
  for (size_t i = 0; i < 2 * s->end.node_count; i++) s->end.positions[i] = r->state->q[i];
  measure_elements(r);
  list_breaks(r);
  list_jumps(r);
  if (r->state->balance) {
    (void)sample_balance(r);
    s->balance = strut_balance_judge(&s->energy, s->spent.steps);
  }
  strut_run_warn(r);
  store_end_state(r);
  r->answer.filled = true;
}

strut_status strut_run_begin(const strut_model *model, const strut_experiment *experiment,
                             const strut_run_options *options, strut_summary *summary,
                             strut_error *error, strut_run *r) {
  int64_t chunk = CHUNK_WORK / (model->members.count + model->node_count + 1);
  *summary = (strut_summary){.velocity = (double)NAN, .velocity_spread = (double)NAN};
  *r = (strut_run){.model = model,
                   .experiment = experiment,
                   .options = options,
                   .summary = summary,
                   .error = error};
  if (model->scene->cell_count || model->scene->collision_count)
    chunk = 1; /* cells that collapse and bodies that pass through each other are noticed at once */
  r->chunk = chunk < 1 ? 1 : chunk > LONGEST_CHUNK ? LONGEST_CHUNK : chunk;
  strut_status status = prepare_run(r);
  r->ready = !status;
  r->clock.start = r->clock.progress = strut_run_clock();
  return status;
}

strut_status strut_run_end(strut_run *r, strut_status status) {
  strut_summary *summary = r->summary;
  strut_error *error = r->error;
  if (r->ready) {
    if (status || !r->answer.filled) fill_summary(r, status); /* where the run ended early */
    summary->spent.wall_time = strut_run_clock() - r->clock.start;
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
  strut_steady_detector_free(&r->steady.detector);
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
      strut_run_begin(model, experiment, options, summary, error ? error : &own, &r);
  while (!status) {
    status = strut_run_sample(&r, &stop);
    if (status || stop == r.state->step) break;
    strut_run_step(&r, stop);
  }
  return strut_run_end(&r, status);
}
