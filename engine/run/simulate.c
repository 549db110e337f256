/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/simulate.h"

#include <math.h>
#include <string.h>
#include <time.h>

#include "engine/base/subnormals.h"
#include "engine/integrate/step_limit.h"
#include "engine/run/settle.h"
#include "engine/run/shooting.h"
#include "engine/run/simulate_parts.h"

/* Beyond this many times the scene's size a run counts as diverged. */
static const double BEYOND = 1e10;
/* Work, in members times steps, between two looks at the state and at the interrupt flag. */
static const int64_t CHUNK_WORK = 2000, LONGEST_CHUNK = 64;

typedef struct strut_run run;

double strut_run_clock(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static strut_status refuse_large_step(const run *r) {
  double limit = r->summary->step_limit;
  if (r->dt <= limit || r->options->force) return STRUT_OK;
  return strut_fail(r->error, STRUT_STEP_TOO_LARGE,
                    "the step %g s is above the largest stable step of %s, %.4g s (all contacts "
                    "closed); use solver.step <= %.2g s, or --force to run all the same",
                    r->dt, r->method->name, limit, 0.9 * limit);
}

static strut_status fill_names(run *r) {
  const strut_scene *scene = r->model->scene;
  strut_summary *s = r->summary;
  size_t contacts = (size_t)r->model->contacts.count;
  s->node_names = strut_allocate(scene->node_count, sizeof *s->node_names);
  s->positions = strut_allocate(2 * scene->node_count, sizeof *s->positions);
  s->contacts = strut_allocate(contacts, sizeof *s->contacts);
  if (!s->node_names || !s->positions || !s->contacts)
    return strut_fail(r->error, STRUT_NO_MEMORY, "out of memory");
  s->node_count = scene->node_count;
  s->contact_count = contacts;
  for (size_t i = 0; i < s->node_count; i++) s->node_names[i] = scene->nodes[i].name;
  for (size_t i = 0; i < contacts; i++)
    s->contacts[i].node = scene->nodes[r->model->contacts.entry[i].node].name;
  return STRUT_OK;
}

/* The step, made to divide the drive's period where that is watched; first and last step. */
static void choose_steps(run *r, const strut_span *span) {
  const strut_experiment *e = &r->model->scene->experiment;
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
}

/* Where the run begins: as the scene says, settled, or where another one ended. */
static strut_status place_state(run *r) {
  const strut_snapshot *from = r->options->from;
  size_t bytes = (size_t)r->model->length * sizeof(double);
  r->state->step = r->first;
  if (from) {
    memcpy(r->state->q, from->q, bytes);
    memcpy(r->state->v, from->v, bytes);
    r->state->refined_until = from->time + from->refined;
    return STRUT_OK;
  }
  if (!r->model->scene->settle.wanted) return STRUT_OK;
  return strut_settle_state(r->model, r->state, r->options->interrupt, &r->summary->settle_time,
                            r->error);
}

/* Everything a run needs, before the first step: no memory is asked for after this. */
static strut_status prepare(run *r) {
  const strut_scene *scene = r->model->scene;
  strut_span span = strut_scene_span(scene);
  strut_step_limit limit;
  r->watching = scene->experiment.steady.wanted && span.period > 0.0;
  choose_steps(r, &span);
  strut_status status = strut_integrator_check(r->model, r->error);
  if (status) return status;
  r->method = strut_integrator_find(scene->experiment.integrator);
  for (size_t i = 0; i + 1 < sizeof r->summary->method && r->method->name[i]; i++)
    r->summary->method[i] = r->method->name[i];
  if (scene->start_equilibrium >= 0)
    return strut_fail(r->error, STRUT_USAGE,
                      "the run wants to start at the equilibrium of configuration '%s'; resolve it "
                      "into positions first (strut_stand_resolve)",
                      scene->configurations[scene->start_equilibrium].name);
  if (!r->model->mass)
    return strut_fail(r->error, STRUT_SINGULAR, "some node that can move has no mass");
  status = strut_step_limit_estimate(r->model, &limit, r->error);
  if (status) return status;
  r->summary->step_limit = strut_step_limit_of(&limit, r->method);
  if ((status = refuse_large_step(r)) || (status = fill_names(r)) ||
      (status = strut_state_create(r->model, &r->state, r->error)))
    return status;
  r->workspace = r->method->create(r->model, r->state);
  double begin = (double)r->first * r->dt;
  if (!r->workspace ||
      strut_measure_create(r->model, r->dt, begin, (size_t)r->more_periods + 1, &r->measure) ||
      (r->watching && strut_watch_create(r->model, span.period, begin, &r->watch)))
    return strut_fail(r->error, STRUT_NO_MEMORY, "out of memory");
  if ((status = place_state(r))) return status;
  r->state->ledger = !r->options->without_ledger;
  r->state->interrupt = r->options->interrupt;
  if (r->method->restart) r->method->restart(r->model, r->state, r->workspace, r->dt);
  if (!strut_guard_create(r->model, r->state, r->method, r->dt, &r->guard) ||
      !strut_stick_band_create(r->model, r->state, r->method, r->dt, &r->band))
    return strut_fail(r->error, STRUT_NO_MEMORY, "out of memory");
  strut_energy_mark(r->model, r->state);
  r->initial = strut_energy_stored(r->model, r->state, begin);
  return strut_recording_create(r->model, r->dt, begin, r->options->sinks, r->options->sink_count,
                                &r->recording, r->error);
}

/* The first node that is nowhere or too far away, or -1. */
static int32_t lost_node(const strut_model *model, const strut_state *state) {
  double bound = BEYOND * (model->size > 0 ? model->size : 1.0);
  for (int32_t i = 0; i < model->node_count; i++) {
    double x = state->q[2 * i], y = state->q[2 * i + 1];
    double vx = state->v[2 * i], vy = state->v[2 * i + 1];
    if (!(fabs(x) <= bound && fabs(y) <= bound) || isnan(vx + vy)) return i;
  }
  return -1;
}

static strut_status diverged(const run *r, int32_t node) {
  double limit = strut_guard_last_limit(r->model, &r->guard), least = r->summary->step_limit;
  double seen = (double)r->guard.last * r->dt;
  const char *remedy = r->dt > 0.5 * fmin(limit, least)
                           ? "use a smaller step"
                           : "look for a member or contact that is far too stiff or a load that "
                             "grows without bound; a smaller step may help too";
  if (r->guard.lowest > 0.0 && !r->options->force)
    return strut_guard_fail(&r->guard, r->state, least, r->error);
  if (limit < 0.99 * least)
    return strut_fail(r->error, STRUT_DIVERGED,
                      "node '%s' left all bounds at t = %.9g s with dt = %g s (largest stable step "
                      "at the start: %.4g s, at t = %.9g s: %.4g s); %s",
                      r->summary->node_names[node], (double)r->state->step * r->dt, r->dt, least,
                      seen, limit, remedy);
  return strut_fail(r->error, STRUT_DIVERGED,
                    "node '%s' left all bounds at t = %.9g s with dt = %g s (largest stable step "
                    "at the start: %.4g s); %s",
                    r->summary->node_names[node], (double)r->state->step * r->dt, r->dt, least,
                    remedy);
}

/* A method could not go on. */
static strut_status stuck(const run *r) {
  static const char *const why[] = {
      [STRUT_TROUBLE_STEP] =
          "the step needed for the tolerance became too small to matter; give a "
          "larger solver.tolerance, or look for a member of zero length",
      [STRUT_TROUBLE_NEWTON] = "the implicit step has no solution nearby; use a smaller step",
      [STRUT_TROUBLE_RIGID] =
          "rigid bars cannot keep their lengths; use a smaller step, or look for "
          "bars that hold each other",
      [STRUT_TROUBLE_INTERRUPT] = "it was interrupted"};
  if (r->state->trouble == STRUT_TROUBLE_IMPLICIT)
    return strut_fail(
        r->error, STRUT_DIVERGED,
        "%s found no solution of its step at t = %.9g s, near node '%s', with dt = %g "
        "s; use a smaller step, or look there for a member that passes through no length",
        r->method->name, (double)r->state->step * r->dt,
        r->summary->node_names[r->state->trouble_node], r->dt);
  return strut_fail(r->error, STRUT_DIVERGED, "%s could not go on at t = %.9g s: %s",
                    r->method->name, (double)r->state->step * r->dt, why[r->state->trouble]);
}

/* Has most of the energy that was exchanged come from nowhere? So it does where motions grow by
   themselves, also those that slack cables and open contacts bound. */
static bool energy_from_nowhere(const run *r) {
  strut_energy e;
  if (!(r->dt > 0.5 * r->summary->step_limit)) return false; /* then it is not the step's limit */
  strut_balance_fill(r->model, r->state, &r->initial, (double)r->state->step * r->dt, &e);
  double there = e.kinetic + e.elastic + fabs(e.gravity) + e.contact;
  return e.residual > 0.5 * (e.moved + fabs(e.initial) + there);
}

/* Every so many steps: does the step still suit the structure? */
static strut_status watch_step(run *r) {
  if (r->state->step < r->guard.next) return STRUT_OK;
  strut_stick_band_look(r->model, r->state, &r->band);
  bool garbage = !r->options->force && energy_from_nowhere(r);
  if (garbage && !(r->guard.lowest > 0.0)) strut_guard_blame(r->model, r->state, &r->guard);
  if (!garbage) strut_guard_look(r->model, r->state, &r->guard);
  if (r->options->force) return STRUT_OK;
  if (!r->guard.hopeless && !garbage) return STRUT_OK;
  return strut_guard_fail(&r->guard, r->state, r->summary->step_limit, r->error);
}

/* A place within the period that no symmetry of the drive prefers. */
static int64_t middle_of(int64_t period) { return (int64_t)(0.382 * (double)period); }

/* Where to stop stepping for a while: a sample, the window, the end, or just to look around. */
static int64_t next_stop(const run *r, int64_t chunk) {
  int64_t n = r->state->step, stop = n + chunk;
  int64_t sample = strut_recording_next_step(&r->recording);
  int64_t window = strut_measure_first_step(&r->measure);
  if (stop > r->steps) stop = r->steps;
  if (sample > n && stop > sample) stop = sample;
  if (window > n && stop > window) stop = window;
  if (!r->watching) return stop;
  int64_t period = r->period_steps, past = (n - r->first) % period, end = n - past + period;
  int64_t middle = n - past + middle_of(period);
  if (middle > n && stop > middle) stop = middle;
  return stop > end ? end : stop;
}

/* The state becomes the orbit's; what the change does to the stored energies is no error of the run. */
static void take_orbit(run *r, const double *y) {
  size_t bytes = (size_t)r->model->length * sizeof(double);
  double t = (double)r->state->step * r->dt;
  strut_stored before = strut_energy_stored(r->model, r->state, t);
  memcpy(r->state->q, y, bytes);
  memcpy(r->state->v, y + r->model->length, bytes);
  r->state->refined_until = t + y[2 * r->model->length];
  if (r->method->restart) r->method->restart(r->model, r->state, r->workspace, r->dt);
  strut_stored after = strut_energy_stored(r->model, r->state, t);
  r->initial.kinetic += after.kinetic - before.kinetic;
  r->initial.elastic += after.elastic - before.elastic;
  r->initial.gravity += after.gravity - before.gravity;
  r->initial.contact += after.contact - before.contact;
}

/* Finishes the motion that was found to be periodic; it goes on as it is where that fails. */
static strut_status shoot(run *r) {
  size_t length = (size_t)r->model->length;
  strut_steady_summary *found = &r->watch.result;
  strut_period_map map = {.model = NULL};
  double travel = 0.0, *y = strut_allocate(2 * length + 1, sizeof *y);
  if (!y) return strut_fail(r->error, STRUT_NO_MEMORY, "out of memory");
  strut_status status = strut_period_map_create(r->model->scene, &r->model->scene->experiment,
                                                found->repeats, &map, r->error);
  if (!status) {
    map.time = (double)r->state->step * r->dt;
    memcpy(y, r->state->q, length * sizeof *y);
    memcpy(y + length, r->state->v, length * sizeof *y);
    y[2 * length] = fmax(0.0, r->state->refined_until - map.time);
    status = strut_shoot(&map, y, &travel, found);
    if (status) strut_fail(r->error, status, "out of memory");
  }
  if (!status && found->shot) {
    take_orbit(r, y);
    r->watch.velocity = travel / (map.period * found->repeats);
  }
  r->shot_periods = map.applied;
  found->periods += map.applied;
  r->state->evaluations += map.evaluations;
  strut_period_map_free(&map);
  strut_release(y);
  return status;
}

/*
 * At the ends of periods, and once within each. When the motion has become steady the run goes on
 * for the periods that are recorded, at least one, over which contacts are measured.
 */
static strut_status watch_motion(run *r) {
  int64_t n = r->state->step, past = (n - r->first) % r->period_steps;
  if (past == middle_of(r->period_steps)) strut_watch_middle(r->state, &r->watch);
  if (past != 0) return STRUT_OK;
  double x, v;
  bool before = r->watch.known;
  strut_measure_track(r->model, r->state, &r->measure, &x, &v);
  if (!strut_watch_period(r->state, x, &r->watch) || before) return STRUT_OK;
  strut_status status = r->model->scene->experiment.steady.shooting ? shoot(r) : STRUT_OK;
  if (status) return status;
  double now = (double)n * r->dt, period = r->watch.period;
  r->steps = n + r->more_periods * r->period_steps;
  strut_measure_window(r->model, r->state, now, period, (size_t)r->more_periods, &r->measure);
  if (r->model->scene->experiment.output_last > 0.0) r->recording.start = now;
  return STRUT_OK;
}

static void step_to(run *r, int64_t stop) {
  int64_t n = r->state->step;
  if (n < strut_measure_first_step(&r->measure)) {
    r->method->advance(r->model, r->state, r->workspace, r->dt, stop - n);
    return;
  }
  for (; n < stop; n++) {
    r->method->advance(r->model, r->state, r->workspace, r->dt, 1);
    strut_measure_step(r->model, r->state, &r->measure);
  }
}

/* Motion that has died away must not be slow: numbers too small for full speed are zero. */
void strut_run_step(run *r, int64_t stop) {
  unsigned before = strut_subnormals_off();
  step_to(r, stop);
  strut_subnormals_restore(before);
}

strut_status strut_run_look(run *r, int64_t *stop) {
  const strut_run_options *o = r->options;
  int64_t n = r->state->step;
  int32_t lost = lost_node(r->model, r->state);
  strut_status guarded = watch_step(r);
  *stop = n;
  if (guarded) return guarded;
  if (lost >= 0) return diverged(r, lost);
  strut_status watched = r->watching ? watch_motion(r) : STRUT_OK;
  if (watched) return watched;
  if (n == strut_measure_first_step(&r->measure))
    strut_measure_begin(r->model, r->state, &r->measure);
  if (n == strut_recording_next_step(&r->recording)) {
    strut_status status = strut_recording_sample(r->model, r->state, &r->recording, r->error);
    if (status) return status;
  }
  if (n >= r->steps) return STRUT_OK;
  if (o->interrupt && *o->interrupt)
    return strut_fail(r->error, STRUT_INTERRUPTED, "interrupted at t = %.9g s", (double)n * r->dt);
  if (r->state->trouble) return stuck(r);
  if (o->progress && strut_run_clock() - r->told > 0.1) {
    o->progress(o->progress_context, (double)(n - r->first) / (double)(r->steps - r->first));
    r->told = strut_run_clock();
  }
  *stop = next_stop(r, r->chunk);
  return STRUT_OK;
}

/* The end of the run for whoever goes on from it. */
static void keep_end(const run *r) {
  strut_snapshot *to = r->options->to;
  if (!to) return;
  size_t bytes = (size_t)r->model->length * sizeof(double);
  memcpy(to->q, r->state->q, bytes);
  memcpy(to->v, r->state->v, bytes);
  to->time = (double)r->state->step * r->dt;
  to->refined = fmax(0.0, r->state->refined_until - to->time);
}

static void fill_contacts(run *r) {
  for (int32_t i = 0; i < r->model->contacts.count; i++)
    r->summary->contacts[i].band_needed = strut_stick_band_missed(r->model, &r->band, i);
}

static void fill_summary(run *r, strut_status status) {
  strut_summary *s = r->summary;
  fill_contacts(r);
  s->status = status;
  s->steps = r->state->step - r->first;
  s->duration = (double)(s->steps + r->shot_periods * r->period_steps) * r->dt;
  s->force_evaluations = r->state->evaluations;
  s->events = r->state->events;
  s->limit_fell = (strut_limit_fell){.limit = r->guard.lowest,
                                     .time = r->guard.lowest_time,
                                     .since = r->guard.first_time,
                                     .steps = r->guard.steps_below};
  strut_measure_finish(r->model, &r->measure, s);
  if (r->watching) strut_watch_finish(&r->watch, s);
  for (size_t i = 0; i < 2 * s->node_count; i++) s->positions[i] = r->state->q[i];
  if (r->state->ledger)
    strut_balance_fill(r->model, r->state, &r->initial, (double)r->state->step * r->dt, &s->energy);
  keep_end(r);
}

strut_status strut_run_begin(const strut_model *model, const strut_run_options *options,
                             strut_summary *summary, strut_error *error, run *r) {
  int64_t chunk = CHUNK_WORK / (model->members.count + model->node_count + 1);
  *summary = (strut_summary){.velocity = (double)NAN, .velocity_spread = (double)NAN};
  *r = (run){.model = model, .options = options, .summary = summary, .error = error};
  r->chunk = chunk < 1 ? 1 : chunk > LONGEST_CHUNK ? LONGEST_CHUNK : chunk;
  strut_status status = prepare(r);
  r->begun = !status;
  r->began = r->told = strut_run_clock();
  return status;
}

strut_status strut_run_end(run *r, strut_status status) {
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
  strut_watch_free(&r->watch);
  strut_state_free(r->state);
  return status;
}

strut_status strut_simulate(const strut_model *model, const strut_run_options *options,
                            strut_summary *summary, strut_error *error) {
  strut_error own = {0};
  run r;
  int64_t stop = INT64_MAX;
  strut_status status = strut_run_begin(model, options, summary, error ? error : &own, &r);
  while (!status) {
    status = strut_run_look(&r, &stop);
    if (status || stop == r.state->step) break;
    strut_run_step(&r, stop);
  }
  return strut_run_end(&r, status);
}
