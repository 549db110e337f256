/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/simulate.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "engine/base/arithmetic.h"
#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
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

static strut_status check_step_limit(const strut_run *run) {
  double limit = run->summary->step_limit, duration = (double)(run->steps - run->first) * run->dt;
  if (run->dt < AT_LIMIT * limit || run->options->force) return STRUT_OK;
  if (!(limit * MOST_STEPS > duration))
    return strut_fail(run->error, STRUT_STEP_TOO_LARGE,
                      "the largest stable step of %s would be %.2g s (all contacts closed), too "
                      "small for a run of %.4g s: stiffnesses or dampings are far too large beside "
                      "the masses; check their units",
                      run->method->name, limit, duration);
  return strut_fail(run->error, STRUT_STEP_TOO_LARGE,
                    "the step %g s is %s the largest stable step of %s, %.4g s (all contacts "
                    "closed); use solver.step <= %.2g s, or --force to run anyway",
                    run->dt, run->dt > limit ? "above" : "at", run->method->name, limit,
                    0.9 * limit);
}

/* Steps for a turn of what turns fastest, below which its mean over a step is wrong, or nothing is right. */
static const double FEW_STEPS = 10.0, LEAST_STEPS_OF_TURN = 2.0;

/* Methods whose own error does not choose their steps do not notice what turns about once in a step. */
static strut_status check_turns(const strut_run *run) {
  strut_turning fastest = strut_scene_fastest_turn(run->model->scene, (double)run->steps * run->dt,
                                                   run->method->events);
  double steps = 1.0 / (fastest.rate * run->dt);
  if (strut_integrator_controls_error(run->method) || !(steps < FEW_STEPS)) return STRUT_OK;
  if (steps < LEAST_STEPS_OF_TURN && !run->options->force)
    return strut_fail(
        run->error, STRUT_STEP_TOO_LARGE,
        "%s turns at %.4g Hz, %.3g times in a step of %g s of %s, which sees "
        "nothing of that; use solver.step <= %.2g s, adaptive, or --force to run anyway",
        fastest.name, fastest.rate, 1.0 / steps, run->dt, run->method->name,
        0.5 / (FEW_STEPS * fastest.rate));
  if (!run->options->chosen)
    strut_summary_warn(run->summary, "coarse_step",
                       "%s turns at %.4g Hz, once in %.3g steps of %g s, too few to follow "
                       "it; use solver.step <= %.2g s, adaptive, or --accuracy 1%%",
                       fastest.name, fastest.rate, steps, run->dt,
                       0.5 / (FEW_STEPS * fastest.rate));
  return STRUT_OK;
}

static strut_status allocate_summary(strut_run *run) {
  const strut_scene *scene = run->model->scene;
  strut_summary *summary = run->summary;
  const strut_experiment *experiment = run->experiment;
  size_t contacts = (size_t)run->model->contacts.count;
  if (!STRUT_ALLOCATE(&summary->arena, STRUT_NEW(summary->end.node_names, scene->node_count),
                      STRUT_NEW(summary->end.positions, 2 * scene->node_count),
                      STRUT_NEW(summary->end.contacts, contacts),
                      STRUT_NEW(summary->end.hinges, scene->hinge_count),
                      STRUT_NEW(summary->end.cells, scene->cell_count),
                      STRUT_NEW(summary->end.breaks, run->model->elements.breakable_count),
                      STRUT_NEW(summary->end.jumps, run->model->elements.history_count),
                      STRUT_NEW(summary->measured, experiment->quantity_count)))
    return strut_no_memory(run->error, "for the model");
  if (!experiment->quantity_count) summary->measured = NULL;
  summary->end.node_count = scene->node_count;
  summary->end.contact_count = contacts;
  summary->end.hinge_count = scene->hinge_count;
  summary->end.cell_count = scene->cell_count;
  summary->measured_count = experiment->quantity_count;
  if (experiment->measure_node >= 0)
    summary->measured_node = scene->nodes[experiment->measure_node].name;
  for (size_t i = 0; i < summary->measured_count; i++)
    summary->measured[i] =
        (strut_measured){.name = experiment->quantities[i].name,
                         .unit = experiment->quantities[i].unit,
                         .value = (double)NAN,
                         .spread = (double)NAN,
                         .scale = (double)NAN,
                         .expected = (double)NAN,
                         .margin = (double)NAN,
                         .arrival = experiment->quantities[i].take == STRUT_TAKE_ARRIVAL};
  for (size_t i = 0; i < summary->end.node_count; i++)
    summary->end.node_names[i] = scene->nodes[i].name;
  for (size_t i = 0; i < summary->end.hinge_count; i++)
    summary->end.hinges[i] = (strut_hinge_summary){scene->hinges[i].name, (double)NAN, (double)NAN};
  for (size_t i = 0; i < summary->end.cell_count; i++)
    summary->end.cells[i] = (strut_cell_summary){scene->cells[i].name, (double)NAN, (double)NAN};
  for (size_t i = 0; i < contacts; i++)
    summary->end.contacts[i].node = strut_contact_name(scene, i);
  return STRUT_OK;
}

/*
 * Chooses the step, which divides the drive period where steady motion is detected, and the first
 * and last step number.
 */
static void choose_steps(strut_run *run, const strut_span *span) {
  const strut_experiment *experiment = run->experiment;
  double last = experiment->output_last;
  run->dt = experiment->step;
  if (run->steady.wanted) {
    run->steady.period_steps = (int64_t)ceil(span->period / run->dt * (1.0 - 1e-9));
    run->dt = span->period / (double)run->steady.period_steps;
    run->steady.recorded_periods = run->options->sink_count ? (int64_t)ceil(last - 1e-9) : 0;
    run->steady.answer_periods = experiment->steady.run_on > 1 ? experiment->steady.run_on : 1;
  }
  run->summary->step = run->dt;
  run->first = run->options->from ? llround(run->options->from->time / run->dt) : 0;
  run->steps = run->first + (int64_t)ceil(span->duration / run->dt - 1e-6);
  run->answer.step = run->steps;
  run->grid = (strut_time_grid){
      .step = run->dt, .last = run->steps, .end = (double)run->first * run->dt + span->duration};
  double offset =
      run->options->from ? run->options->from->time - (double)run->first * run->dt : 0.0;
  if (!run->steady.wanted && fabs(offset) > 1e-6 * run->dt) run->grid.offset = offset;
}

/* Places the state at the start: that of the scene, the settled one, or the end of another run. */
static strut_status place_state(strut_run *run) {
  const strut_snapshot *from = run->options->from;
  size_t bytes = (size_t)run->model->length * sizeof(double);
  run->state->step = run->first;
  run->state->time_offset = run->grid.offset;
  if (from) {
    memcpy(run->state->q, from->q, bytes);
    memcpy(run->state->v, from->v, bytes);
    run->state->refined_until = from->time - run->grid.offset + from->refined;
    return STRUT_OK;
  }
  if (!run->experiment->settle.wanted) return STRUT_OK;
  strut_status status =
      strut_settle_experiment(run->model, run->experiment, run->options->interrupt, run->state->q,
                              &run->summary->settle, run->error);
  run->summary->settle_time = run->summary->settle.time;
  return status;
}

/* What breaks or yields at the start already, which statics and settling take as whole, is warned of. */
static void begin_history(strut_run *run, double begin) {
  const strut_snapshot *from = run->options->from;
  strut_overload worst;
  if (from && from->memory) {
    strut_history_load(run->model, run->state, from->memory);
  } else if (!from && strut_history_overload(run->model, run->state->q, &worst)) {
    strut_summary_warn(run->summary, "overloaded_start",
                       "%s '%s' carries %.4g %s at the start, above the %.4g %s at which it %s; it "
                       "does so at once",
                       worst.kind, worst.name, worst.force, worst.hinge ? "N m" : "N", worst.limit,
                       worst.hinge ? "N m" : "N", worst.breaks ? "breaks" : "yields");
  }
  strut_history_begin(run->model, run->state, begin);
}

static strut_status prepare_run(strut_run *run) {
  const strut_scene *scene = run->model->scene;
  strut_span span = strut_experiment_span(run->experiment, scene);
  run->steady.wanted = run->experiment->steady.wanted && span.period > 0.0;
  choose_steps(run, &span);
  strut_status status = strut_integrator_check(run->model, run->experiment, run->error);
  if (status) return status;
  run->method = strut_integrator_find(run->experiment->integrator);
  for (size_t i = 0; i + 1 < sizeof run->summary->method && run->method->name[i]; i++)
    run->summary->method[i] = run->method->name[i];
  if (scene->start_equilibrium >= 0)
    return strut_fail(run->error, STRUT_USAGE,
                      "the run starts at the equilibrium of configuration '%s'; resolve it to "
                      "positions first with strut_resolve_start_equilibrium",
                      scene->configurations[scene->start_equilibrium].name);
  if (!run->model->mass) return strut_fail(run->error, STRUT_SINGULAR, "a free node has no mass");
  if ((status = strut_integrator_check_samples(run->method, run->model, run->dt, run->error)))
    return status;
  if ((status = check_turns(run))) return status;
  run->summary->feedback = strut_scene_has_feedback(scene);
  status =
      strut_step_limit_for_method(run->model, run->method, &run->summary->step_limit, run->error);
  if (status) return status;
  if (!run->options->force &&
      (status = strut_step_limit_check_effort(run->model, run->method, run->dt, run->error)))
    return status;
  if ((status = check_step_limit(run)) || (status = allocate_summary(run)) ||
      (status = strut_state_create(run->model, &run->state, run->error)))
    return status;
  const strut_integrator_settings settings = strut_integrator_settings_of(run->experiment);
  run->workspace = run->method->create(run->model, run->state, &settings);
  double begin = (double)run->first * run->dt;
  int64_t marks = run->steady.answer_periods > STRUT_LONGEST_REPEAT ? run->steady.answer_periods
                                                                    : STRUT_LONGEST_REPEAT;
  run->measure.grid = run->grid, run->measure.samples = run->options->samples;
  if (!run->workspace ||
      strut_measure_create(run->model, run->experiment, begin, (size_t)marks + 1, &run->measure) ||
      (run->steady.wanted &&
       strut_steady_detector_create(run->model, &run->experiment->steady, span.period, begin,
                                    &run->steady.detector)))
    return strut_no_memory(run->error, "for the model");
  bool measured = run->measure.quantities && run->method->observe &&
                  (run->options->samples || strut_quantities_need_pieces(run->measure.quantities));
  bool recorded = run->method->observe && run->experiment->output_every > 0.0;
  if ((measured || recorded) && !run->method->observe(run->model, run->state, run->workspace))
    return strut_no_memory(run->error, "for the model");
  if (measured) strut_quantities_observe(run->measure.quantities);
  if ((status = place_state(run))) return status;
  if (run->model->terms & STRUT_TERM_SUPPORT_MOTION)
    strut_support_motion_place(run->model, run->state, begin, run->state->q, run->state->v);
  if (run->model->terms & STRUT_TERM_MEMORY) begin_history(run, begin);
  run->state->balance =
      !run->options->without_balance || strut_quantities_need_balance(run->experiment);
  run->state->limits.interrupt = run->options->interrupt;
  run->state->limits.most_evaluations = run->options->most_evaluations;
  if (run->method->restart) run->method->restart(run->model, run->state, run->workspace, run->dt);
  if (!strut_step_limit_monitor_create(run->model, run->state, run->method, run->dt,
                                       &run->watch.limit) ||
      !strut_stick_band_create(run->model, run->state, run->method, run->dt, &run->watch.band) ||
      !strut_motion_frequency_create(run->model, run->state, &run->watch.frequency))
    return strut_no_memory(run->error, "for the model");
  strut_energy_reset_load_work(run->model, run->state);
  run->watch.initial = strut_energy_evaluate(run->model, run->state, begin);
  if ((status = strut_run_check_rates(run))) return status;
  if (run->options->from && run->options->from->balance && run->state->balance)
    strut_balance_continue(run->options->from->balance, run->state, &run->watch.initial);
  strut_balance_begin(run->state, &run->watch.initial, begin, run->method->evaluations,
                      &run->watch.balance);
  run->recording = (strut_recording){
      .sinks = run->options->sinks, .sink_count = run->options->sink_count, .grid = run->grid};
  return strut_recording_create(run->model, run->experiment, begin, &run->recording, run->error);
}

static void advance(strut_run *run, double dt, int64_t count) {
  strut_integrator_advance(run->method, run->model, run->state, run->workspace, dt, count);
}

/* ---- steady motion ---- */

/* A step within the period that no symmetry of the drive prefers. */
static int64_t asymmetric_phase(int64_t period) { return (int64_t)(0.382 * (double)period); }

/*
 * Samples the detector at the end of each period and once within it. Once the motion is steady, the run
 * continues for at least one period, over which contacts are measured, and which ends the summary. It may go on
 * for more that are recorded, of which the summary knows nothing: an answer does not depend on recordings.
 */
static void detect_steady_motion(strut_run *run) {
  int64_t n = run->state->step, past = (n - run->first) % run->steady.period_steps;
  if (past == asymmetric_phase(run->steady.period_steps))
    strut_steady_detector_half_period(run->state, &run->steady.detector);
  if (past != 0) return;
  double x, v;
  bool before = run->steady.detector.known;
  strut_measure_tracked_point(run->model, run->state, &run->measure, &x, &v);
  if (!strut_steady_detector_period(run->state, x, &run->steady.detector) || before) return;
  double now = (double)n * run->dt, period = run->steady.detector.period;
  int64_t periods = run->steady.answer_periods, repeats = run->steady.detector.result.repeats;
  if (run->measure.quantities && periods < repeats)
    periods = repeats; /* a window over the whole orbit */
  int64_t recorded = run->steady.recorded_periods, all = recorded > periods ? recorded : periods;
  run->answer.step = n + periods * run->steady.period_steps;
  run->steps = n + all * run->steady.period_steps;
  run->grid.last = run->measure.grid.last = run->recording.grid.last = -1;
  strut_measure_window(run->model, run->state, now, period, (size_t)periods, &run->measure);
  if (recorded > 0) run->recording.start = now + (double)(all - recorded) * period;
}

/* ---- stepping ---- */

/*
 * Finds the step at which to look at the state next: the window, a period, the end, or a check. It does not
 * depend on what is recorded.
 */
static int64_t find_next_check(const strut_run *run, int64_t chunk) {
  int64_t n = run->state->step, stop = n - (n - run->first) % chunk + chunk;
  int64_t window = strut_measure_first_step(&run->measure);
  int64_t whole = strut_time_grid_rest(&run->grid) > 0.0 ? run->steps - 1 : run->steps;
  if (stop > whole) stop = n < whole ? whole : run->steps;
  if (window > n && stop > window) stop = window;
  if (run->watch.balance.next > n && stop > run->watch.balance.next) stop = run->watch.balance.next;
  if (run->watch.limit.next > n && stop > run->watch.limit.next) stop = run->watch.limit.next;
  if (!run->steady.wanted) return stop;
  int64_t period = run->steady.period_steps, past = (n - run->first) % period,
          end = n - past + period;
  int64_t middle = n - past + asymmetric_phase(period);
  if (middle > n && stop > middle) stop = middle;
  return stop > end ? end : stop;
}

static void step_to(strut_run *run, int64_t stop) {
  int64_t n = run->state->step;
  if (n < strut_measure_first_step(&run->measure)) {
    advance(run, run->dt, stop - n);
    return;
  }
  for (; n < stop; n++) {
    advance(run, run->dt, 1);
    if (run->state->trouble) return;
    strut_measure_step(run->model, run->state, &run->measure);
  }
}

double strut_run_time(const strut_run *run) {
  return strut_time_grid_real(&run->grid, run->state->step);
}

/*
 * Makes the last step of another length. Step number times step is then not the time, so the drives
 * get the difference as offset.
 */
static void step_short(strut_run *run) {
  strut_state *state = run->state;
  double length = strut_time_grid_rest(&run->grid), before = state->time_offset;
  double later = (double)state->step * (run->dt - length);
  state->time_offset += later;
  state->refined_until -= later;
  state->latest->drive_time = (double)NAN;
  advance(run, length, 1);
  state->time_offset = before;
  state->refined_until += later;
  state->latest->drive_time = (double)NAN;
  if (state->step != run->grid.last || state->step <= strut_measure_first_step(&run->measure))
    return;
  strut_measure_step(run->model, state, &run->measure);
}

/*
 * Denormal numbers of a decayed motion would slow the processor down, so they are flushed to zero.
 */
void strut_run_step(strut_run *run, int64_t stop) {
  assert(run->ready && stop > run->state->step);
  unsigned before = strut_subnormals_off();
  strut_state *state = run->state;
  strut_recording_begin_step(&run->recording, state);
  if (state->step == run->grid.last - 1 && strut_time_grid_rest(&run->grid) > 0.0)
    step_short(run); /* the last one, shorter than the others */
  else
    step_to(run, stop);
  strut_recording_end_step(&run->recording, state);
  strut_subnormals_restore(before);
}

static void list_jumps(const strut_run *run) {
  const strut_element_table *elements = &run->model->elements;
  strut_summary *summary = run->summary;
  summary->end.jump_count = 0;
  for (int32_t i = 0; i < elements->count; i++) {
    const strut_element *element = &elements->element[i];
    if (element->law != STRUT_LAW_FOLDING) continue;
    const double *own = &run->state->latest->rest[element->slot];
    if (own[STRUT_CURVE_JUMPS] > 0.0)
      summary->end.jumps[summary->end.jump_count++] =
          (strut_jump_summary){.name = strut_element_name(run->model->scene, element),
                               .count = (int64_t)own[STRUT_CURVE_JUMPS],
                               .last = own[STRUT_CURVE_LAST],
                               .freed = own[STRUT_CURVE_FREED]};
  }
}

static void fill_summary(strut_run *run, strut_status status);

/*
 * The time of the state; where a drive jumps there, just after that, as a method with events has accumulated
 * its work.
 */
static double time_of_balance(const strut_run *run) {
  double t = strut_time_grid_at(&run->grid, run->state->step), near = 2e-9 * run->dt;
  if (!run->method->events) return t;
  double now = t + run->state->time_offset;
  return strut_drive_next_break(run->model, run->state, now - near, now + 2.0 * near) <= now + near
             ? t + near
             : t;
}

static strut_status sample_balance(strut_run *run) {
  if (!run->state->balance) return STRUT_OK;
  strut_balance_sample(run->model, run->state, &run->watch.initial, time_of_balance(run),
                       &run->watch.balance, &run->summary->energy);
  if (run->method->lag > 0.0)
    strut_motion_frequency_sample(run->model, run->state, run->summary->energy.kinetic,
                                  &run->watch.frequency);
  return strut_run_check_balance(run);
}

strut_status strut_run_sample(strut_run *run, int64_t *stop) {
  const strut_run_options *options = run->options;
  int64_t n = run->state->step;
  int32_t lost = strut_run_find_lost_node(run->model, run->state);
  bool due = n >= run->check || run->state->trouble;
  strut_status status = due ? strut_run_check_step_limit(run) : STRUT_OK;
  assert(run->ready && n >= run->first);
  *stop = n;
  if (!status && due) status = strut_run_check_states(run);
  if (!status && due && lost >= 0) return strut_run_fail_lost_node(run, lost);
  if (status) return status;
  if (run->model->scene->collision_count) strut_run_watch_collisions(run);
  if (run->model->rubbing.bristles) strut_run_watch_bristles(run);
  bool balance_due =
      n == run->answer.step || (n >= run->watch.balance.next && n < run->answer.step);
  status = strut_run_check_collapse(run);
  if (!status && balance_due) status = sample_balance(run);
  if (status) return status;
  if (run->steady.wanted) detect_steady_motion(run);
  if (n == strut_measure_first_step(&run->measure))
    strut_measure_begin(run->model, run->state, &run->measure);
  bool recorded = lost < 0 && (n == strut_recording_next_step(&run->recording, n) ||
                               (n >= run->steps && strut_recording_lacks(&run->recording, n)));
  status = strut_recording_sample(run->state, &run->recording, recorded, run->error);
  if (status) return status;
  if (n == run->answer.step) fill_summary(run, STRUT_OK);
  if (n >= run->steps) return STRUT_OK;
  if (options->interrupt && *options->interrupt)
    return strut_fail(run->error, STRUT_INTERRUPTED, "interrupted at t = %.9g s",
                      strut_run_time(run));
  if (run->state->trouble == STRUT_FAILURE_WORK ||
      (options->most_evaluations > 0 &&
       run->state->latest->evaluations > options->most_evaluations))
    return strut_fail(run->error, STRUT_WORK_LIMIT,
                      "%s used up the work budget of %lld force evaluations at t = %.9g s",
                      run->method->name, (long long)options->most_evaluations, strut_run_time(run));
  if (run->state->trouble) return strut_run_fail_method(run);
  if (options->progress && strut_run_clock() - run->clock.progress > 0.1) {
    options->progress(options->progress_context,
                      (double)(n - run->first) / (double)(run->steps - run->first));
    run->clock.progress = strut_run_clock();
  }
  int64_t sample = strut_recording_next_step(&run->recording, n);
  run->check = find_next_check(run, run->chunk);
  *stop = sample > n && sample < run->check ? sample : run->check;
  return STRUT_OK;
}

/* ---- the end ---- */

/* Stores the end state for a later run. */
static void store_end_state(const strut_run *run) {
  strut_snapshot *to = run->options->to;
  if (!to) return;
  size_t bytes = (size_t)run->model->length * sizeof(double);
  memcpy(to->q, run->state->q, bytes);
  memcpy(to->v, run->state->v, bytes);
  if (to->memory) strut_history_store(run->model, run->state, to->memory);
  to->time = strut_run_time(run);
  to->refined = fmax(0.0, run->state->refined_until - (to->time - run->grid.offset));
}

/* Angles and moments of the hinges at the end, areas and pressures of the cells. */
static void measure_elements(strut_run *run) {
  const strut_scene *scene = run->model->scene;
  strut_instant instant = {.model = run->model};
  if (!scene->hinge_count && !scene->cell_count) return;
  strut_instant_show(&instant, run->state, 1u << STRUT_OBSERVED_DRIVES,
                     strut_time_grid_at(&run->grid, run->state->step));
  for (size_t i = 0; i < scene->hinge_count; i++) {
    strut_hinge_summary *hinge = &run->summary->end.hinges[i];
    hinge->angle = strut_observe_item(&instant, STRUT_COLUMN_HINGE_ANGLE, (int32_t)i);
    hinge->moment = strut_observe_item(&instant, STRUT_COLUMN_MOMENT, (int32_t)i);
  }
  for (size_t i = 0; i < scene->cell_count; i++) {
    strut_cell_summary *cell = &run->summary->end.cells[i];
    cell->area = strut_observe_item(&instant, STRUT_COLUMN_CELL_AREA, (int32_t)i);
    cell->pressure = strut_observe_item(&instant, STRUT_COLUMN_PRESSURE, (int32_t)i);
  }
}

static void list_breaks(const strut_run *run) {
  const strut_scene *scene = run->model->scene;
  strut_summary *summary = run->summary;
  summary->end.break_count = 0;
  for (int32_t b = 0; b < run->model->elements.breakable_count; b++) {
    const strut_breakable *what = &run->model->elements.breakable[b];
    double time = run->state->history.broken_at[b];
    bool hinge = what->role == STRUT_ELEMENT_HINGE;
    if (!(time < HUGE_VAL)) continue;
    summary->end.breaks[summary->end.break_count++] = (strut_break_summary){
        .name = hinge ? scene->hinges[what->item].name : scene->members[what->item].name,
        .hinge = hinge,
        .released = time == what->time,
        .time = time};
  }
}

static void fill_summary(strut_run *run, strut_status status) {
  strut_summary *summary = run->summary;
  for (int32_t i = 0; i < run->model->contacts.count; i++)
    summary->end.contacts[i].band_needed = strut_stick_band_missed(run->model, &run->watch.band, i);
  summary->status = status;
  summary->spent.steps = run->state->step - run->first;
  summary->duration = (double)summary->spent.steps * run->dt;
  if (run->state->step == run->grid.last)
    summary->duration = strut_experiment_span(run->experiment, run->model->scene).duration;
  summary->spent.evaluations = run->state->latest->evaluations;
  summary->spent.events = run->state->events;
  summary->spent.forced = run->state->forced.count;
  summary->limit_fell = (strut_step_limit_violation){.limit = run->watch.limit.lowest,
                                                     .time = run->watch.limit.lowest_time,
                                                     .since = run->watch.limit.first_time,
                                                     .steps = run->watch.limit.steps_below};
  strut_measure_finish(&run->measure, summary);
  if (run->steady.wanted) strut_steady_detector_finish(&run->steady.detector, summary);
  summary->velocity_zero = strut_measure_is_zero(&run->measure, summary);
  for (size_t i = 0; i < 2 * summary->end.node_count; i++)
    summary->end.positions[i] = run->state->q[i];
  measure_elements(run);
  list_breaks(run);
  list_jumps(run);
  if (run->state->balance) {
    (void)sample_balance(run);
    summary->balance = strut_balance_judge(&summary->energy, summary->spent.steps);
  }
  strut_run_warn(run);
  store_end_state(run);
  run->answer.filled = true;
}

strut_status strut_run_begin(const strut_model *model, const strut_experiment *experiment,
                             const strut_run_options *options, strut_summary *summary,
                             strut_error *error, strut_run *run) {
  int64_t chunk = CHUNK_WORK / (model->members.count + model->node_count + 1);
  *summary = (strut_summary){.velocity = (double)NAN, .velocity_spread = (double)NAN};
  *run = (strut_run){.model = model,
                     .experiment = experiment,
                     .options = options,
                     .summary = summary,
                     .error = error};
  if (model->scene->cell_count || model->scene->collision_count)
    chunk = 1; /* cells that collapse and bodies that pass through each other are noticed at once */
  run->chunk = chunk < 1 ? 1 : chunk > LONGEST_CHUNK ? LONGEST_CHUNK : chunk;
  strut_status status = prepare_run(run);
  run->ready = !status;
  run->clock.start = run->clock.progress = strut_run_clock();
  return status;
}

strut_status strut_run_complete(strut_run *run, strut_status status) {
  strut_summary *summary = run->summary;
  strut_error *error = run->error;
  if (run->ready) {
    if (status || !run->answer.filled) fill_summary(run, status); /* where the run ended early */
    summary->spent.wall_time = strut_run_clock() - run->clock.start;
    strut_error first = *error;
    bool known = !run->state->trouble && strut_run_find_lost_node(run->model, run->state) < 0;
    if (status && known && strut_recording_lacks(&run->recording, run->state->step))
      (void)strut_recording_sample(run->state, &run->recording, true, error);
    strut_status written = strut_recording_finish(&run->recording, status, error);
    if (written && (!status || status == STRUT_DIVERGED || status == STRUT_INTERRUPTED))
      status = written;
    else if (status)
      *error = first;
  }
  summary->status = status;
  for (size_t i = 0; status && i + 1 < sizeof summary->reason; i++)
    if (!(summary->reason[i] = error->message[i])) break;
  run->ready = false;
  return status;
}

void strut_run_free(strut_run *run) {
  strut_recording_free(&run->recording);
  strut_measure_free(&run->measure);
  strut_steady_detector_free(&run->steady.detector);
  strut_state_free(run->state);
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
  status = strut_run_complete(&r, status);
  strut_run_free(&r);
  return status;
}
