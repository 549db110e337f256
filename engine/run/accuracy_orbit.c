/* SPDX-License-Identifier: GPL-3.0-or-later */
/* To an accuracy by way of the steady orbit: cheap to come near it, accurate where it counts. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/run/accuracy.h"
#include "engine/run/orbit.h"

/* From this accuracy on the cheap method's own orbit may do, if the correction confirms it. */
static const double COARSE = 0.0099;
/* Below this one the accurate method has the last word. */
static const double FINE = 0.0019;
/* Largest error of the accurate method's velocity over its tolerance, by random points. */
static const double TOLERANCE_PER_ERROR = 1.0 / 1500.0;
/* Periods without which runs are repeated rather than an orbit looked for. */
static const double LEAST = 20.0;
/* A first correction is believed without a second one if it is this part of what is enough. */
static const double SMALL = 0.3;
enum { MOST_CORRECTIONS = 4 };

/* What the cheap map has cost until it was steady. */
typedef struct way_cost {
  int64_t evaluations, events, applied;
} way_cost;

typedef struct way {
  strut_accuracy *a;
  strut_experiment accurate;
  strut_period_map cheap, fine;
  strut_summary run; /* of the cheap method, to its steady state */
  strut_snapshot end;
  double *base;  /* (2 length + 1) fixed point of the cheap map */
  double travel; /* over one application of it [m] */
  strut_orbit orbit;
  double error; /* of orbit.velocity, estimated [m/s] */
  way_cost settled;
  bool finished;      /* the accurate method ran until it was steady */
  strut_summary last; /* of that */
  strut_arena arena;
} way;

static double size_of_velocity(const strut_accuracy *a, double v) {
  return fmax(fabs(v), a->scale);
}

static strut_status allocate(way *w, const strut_model *model) {
  size_t length = (size_t)model->length;
  w->end.q = strut_arena_allocate(&w->arena, length, sizeof(double));
  w->end.v = strut_arena_allocate(&w->arena, length, sizeof(double));
  w->base = strut_arena_allocate(&w->arena, 2 * length + 1, sizeof(double));
  w->orbit.y = strut_arena_allocate(&w->arena, 2 * length + 1, sizeof(double));
  if (w->end.q && w->end.v && w->base && w->orbit.y) return STRUT_OK;
  return strut_fail(w->a->error, STRUT_NO_MEMORY, "out of memory");
}

/* Adds what a further part of the run cost to the whole. */
static void add_part(strut_summary *whole, strut_summary *part) {
  int64_t steps = whole->steps + part->steps, events = whole->events + part->events;
  int64_t evaluations = whole->force_evaluations + part->force_evaluations;
  int64_t periods = whole->steady.periods + part->steady.periods;
  double duration = whole->duration + part->duration, wall = whole->wall_time + part->wall_time;
  double settle = whole->settle_time;
  strut_summary_free(whole);
  *whole = *part;
  *part = (strut_summary){0};
  whole->steps = steps, whole->events = events, whole->force_evaluations = evaluations;
  whole->duration = duration, whole->wall_time = wall, whole->settle_time = settle;
  whole->steady.periods = periods;
}

/* A run of `experiment` from w->end, or the scene's start, until steady; its end is w->end. */
static strut_status run_until_steady(way *w, strut_experiment e, double tolerance,
                                     int32_t successive, double periods, bool from_end,
                                     strut_summary *summary) {
  strut_accuracy *a = w->a;
  strut_snapshot from = w->end;
  e.steady.wanted = true;
  e.steady.tolerance = tolerance;
  e.steady.floor = tolerance * a->scale;
  e.steady.successive = successive;
  e.periods = fmin(e.periods, periods);
  e.measure_last = fmin(e.measure_last, e.periods);
  e.output_last = 0.0;
  strut_run_options options = {.without_ledger = true,
                               .interrupt = a->options->interrupt,
                               .progress = a->options->progress,
                               .progress_context = a->options->progress_context,
                               .from = from_end ? &from : a->options->from,
                               .to = &w->end};
  return strut_accuracy_run(a, &e, &options, summary);
}

/*
 * The cheap method until the motion repeats itself. Its steps meet the grid here and there in
 * another way each period, which may keep it from repeating itself very closely: then less must do.
 * *steady is false where even that is not reached.
 */
static strut_status run_cheap(way *w, bool *steady) {
  strut_accuracy *a = w->a;
  strut_model *model = NULL;
  double periods = strut_accuracy_periods(a), first = fmin(150.0, periods);
  strut_status status = strut_model_compile(a->scene, &model, a->error);
  if (!status) status = allocate(w, model);
  strut_model_free(model);
  if (status) return status;
  status = run_until_steady(w, a->cheap, fmax(0.1, 16.0 * a->wanted), 3, first, false, &w->run);
  if (!status && w->run.steady.kind != STRUT_MOTION_PERIODIC && periods > first) {
    strut_summary more = {0};
    status = run_until_steady(w, a->cheap, fmin(0.005, 0.5 * a->wanted), 5, periods - first, true,
                              &more);
    if (!status) add_part(&w->run, &more);
    strut_summary_free(&more);
  }
  *steady = !status && w->run.steady.kind == STRUT_MOTION_PERIODIC &&
            strut_accuracy_orbit_answers(a, &w->run.steady);
  return status == STRUT_DIVERGED ? STRUT_OK : status;
}

/* The end of the run so far as fixed point of the cheap map. */
static void take_end(way *w) {
  size_t length = (size_t)w->cheap.model->length;
  memcpy(w->base, w->end.q, length * sizeof(double));
  memcpy(w->base + length, w->end.v, length * sizeof(double));
  w->base[2 * length] = w->end.refined;
  w->travel = w->run.velocity * w->cheap.period * w->cheap.repeats;
}

static strut_status make_maps(way *w) {
  strut_accuracy *a = w->a;
  int32_t repeats = w->run.steady.repeats;
  w->accurate = a->cheap;
  w->accurate.integrator = "adaptive";
  w->accurate.tolerance = fmin(2.5e-6, fmax(1e-12, a->wanted * TOLERANCE_PER_ERROR));
  w->accurate.step = strut_scene_span(a->scene).period / 50.0;
  strut_status status = strut_period_map_create(a->scene, &a->cheap, repeats, &w->cheap, a->error);
  if (!status)
    status = strut_period_map_create(a->scene, &w->accurate, repeats, &w->fine, a->error);
  if (status) return status;
  w->cheap.time = w->fine.time = w->end.time;
  take_end(w);
  return STRUT_OK;
}

/*
 * Corrects until the next correction is expected to be small enough: each defect should be much
 * smaller than the one before, and the velocity follows it in proportion.
 */
static strut_status correct(way *w, double enough, int least) {
  double defect = HUGE_VAL;
  w->error = HUGE_VAL;
  for (int k = 0; k < MOST_CORRECTIONS; k++) {
    strut_status status = strut_orbit_correct(&w->cheap, &w->fine, w->base, w->travel,
                                              0.1 * enough * w->cheap.period, &w->orbit);
    if (status) return strut_fail(w->a->error, status, "out of memory");
    if (!w->orbit.converged || w->orbit.defect > 0.7 * defect) return STRUT_OK;
    /* the first correction is taken to be right to a half, later ones by what they achieved */
    double better = k == 0 ? 0.5 : fmax(0.1, w->orbit.defect / defect);
    defect = w->orbit.defect;
    w->error = better * fabs(w->orbit.correction);
    bool small = fabs(w->orbit.correction) <= SMALL * enough;
    if ((k + 1 >= least || small) && w->error <= enough) return STRUT_OK;
  }
  return STRUT_OK;
}

/* The motion on the orbit, by the accurate method: for what is recorded and told of contacts. */
static strut_status run_orbit(way *w, strut_summary *summary) {
  strut_accuracy *a = w->a;
  size_t length = (size_t)w->cheap.model->length;
  strut_experiment e = w->accurate;
  double last = e.output_last;
  e.measure_last = 0.0;
  memcpy(w->end.q, w->orbit.y, length * sizeof(double));
  memcpy(w->end.v, w->orbit.y + length, length * sizeof(double));
  w->end.refined = w->orbit.y[2 * length];
  e.steady.wanted = false;
  e.periods = w->cheap.repeats;
  if (a->options->sink_count && last > e.periods) e.periods = last;
  e.output_last = 0.0;
  strut_run_options options = *a->options;
  options.from = &w->end;
  options.progress = NULL;
  return strut_accuracy_run(a, &e, &options, summary);
}

/*
 * No switch in a period of a motion no faster than the stick band: all is stuck, and at which speed
 * within the band is a matter of how it came to be, not of the orbit.
 */
static bool is_stuck(const way *w) {
  const strut_contact_table *c = &w->cheap.model->contacts;
  double band = 0.0;
  for (int32_t i = 0; i < c->count; i++) band = fmax(band, c->entry[i].stick_velocity);
  return w->fine.applied > 0 && w->fine.events == 0 && fabs(w->run.velocity) <= 1.01 * band;
}

/* The error of the orbit's velocity, in parts of what is wanted. */
static double part_of_wanted(const way *w) {
  double size = size_of_velocity(w->a, w->orbit.velocity);
  return w->error / (w->a->wanted * size);
}

/*
 * The accurate method itself until it is steady: from the orbit found, of which it then is
 * independent, or, where that depends on how it came to be, from the scene's start. The run's costs
 * are added to those of the cheap one.
 */
static strut_status run_accurate(way *w, bool from_orbit, strut_summary *last) {
  strut_accuracy *a = w->a;
  size_t length = (size_t)w->cheap.model->length;
  memcpy(w->end.q, w->orbit.y, length * sizeof(double));
  memcpy(w->end.v, w->orbit.y + length, length * sizeof(double));
  w->end.refined = w->orbit.y[2 * length];
  /* where corrections fail the orbit is sensitive, and errors of a step matter more than usual */
  if (!(part_of_wanted(w) <= 0.8)) w->accurate.tolerance = fmax(1e-12, w->accurate.tolerance / 25.0);
  strut_status status = run_until_steady(w, w->accurate, fmin(0.001, 0.2 * a->wanted), 4,
                                         fmax(20.0, strut_accuracy_periods(a)), from_orbit, last);
  if (status || last->steady.kind != STRUT_MOTION_PERIODIC) return status;
  memcpy(w->orbit.y, w->end.q, length * sizeof(double));
  memcpy(w->orbit.y + length, w->end.v, length * sizeof(double));
  w->orbit.velocity = last->velocity;
  w->error = last->steady.interval;
  w->finished = true;
  return STRUT_OK;
}

static void say_why(const way *w, bool cheap_does, strut_accuracy_summary *told) {
  double step = w->cheap.dt;
  if (cheap_does)
    snprintf(told->why, sizeof told->why,
             "verlet-events with a step of %.3g s is the cheapest method that keeps it: one period "
             "by adaptive (tolerance %.1g) and its effect on the orbit change the velocity by %.2g "
             "m/s",
             step, w->accurate.tolerance, fabs(w->orbit.velocity - w->run.velocity));
  else
    snprintf(
        told->why, sizeof told->why,
        "verlet-events with a step of %.3g s until the motion was steady; its orbit was then "
        "corrected by periods of adaptive (tolerance %.1g), which changed the velocity by %.2g "
        "m/s%s",
        step, w->accurate.tolerance, fabs(w->orbit.velocity - w->run.velocity),
        w->finished ? "; adaptive went on until it was steady itself" : "");
}

/* Puts together what the parts found and cost. */
static void tell(way *w, const strut_summary *orbit, bool cheap_does) {
  strut_accuracy *a = w->a;
  strut_summary *s = a->summary;
  double velocity = cheap_does ? w->run.velocity : w->orbit.velocity;
  double error =
      fmax(w->error, fabs(orbit->velocity - w->orbit.velocity)) +
      w->accurate.tolerance / TOLERANCE_PER_ERROR / 3.0 * size_of_velocity(a, w->orbit.velocity);
  if (cheap_does) error += fabs(w->orbit.velocity - w->run.velocity);
  const way_cost *settled = &w->settled;
  int64_t corrections = w->cheap.evaluations - settled->evaluations + w->fine.evaluations;
  double corrected =
      (double)(w->cheap.applied - settled->applied + w->fine.applied) * w->cheap.period;
  *s = *orbit;
  s->velocity = velocity;
  s->velocity_spread = w->run.velocity_spread;
  s->settle_time = w->run.settle_time;
  s->steady = w->run.steady;
  if (w->finished && !cheap_does) {
    s->steady = w->last.steady;
    s->steady.periods += w->run.steady.periods;
  }
  s->steady.interval = error;
  s->steps = w->run.steps + settled->applied * w->cheap.steps;
  if (!cheap_does) /* of the grid, where the step itself varies */
    s->steps += (w->cheap.applied - settled->applied) * w->cheap.steps +
                w->fine.applied * w->fine.steps + w->last.steps;
  s->step = w->cheap.dt;
  s->step_limit = w->run.step_limit;
  s->steady.periods += settled->applied;
  s->duration = w->run.duration + (double)settled->applied * w->cheap.period +
                (cheap_does ? 0.0 : corrected + w->last.duration);
  s->force_evaluations = w->run.force_evaluations + settled->evaluations +
                         (cheap_does ? 0 : corrections + w->last.force_evaluations);
  s->events =
      w->run.events + settled->events +
      (cheap_does ? 0 : w->cheap.events - settled->events + w->fine.events + w->last.events);
  s->wall_time = w->run.wall_time;
  snprintf(s->method, sizeof s->method, "%s",
           cheap_does ? "verlet-events" : "verlet-events+adaptive");
  s->accuracy = (strut_accuracy_summary){
      .wanted = a->wanted,
      .expected = error / size_of_velocity(a, velocity),
      .scale = a->scale,
      .check_evaluations =
          a->spent + orbit->force_evaluations + (cheap_does ? corrections : 0)};
  s->accuracy.kept = s->accuracy.expected <= a->wanted;
  say_why(w, cheap_does, &s->accuracy);
}

/* What this way has cost goes to the account of the next one. */
static void give_up(way *w, strut_summary *orbit) {
  w->a->spent += w->run.force_evaluations + w->cheap.evaluations + w->fine.evaluations +
                 w->last.force_evaluations + orbit->force_evaluations;
  strut_summary_free(orbit);
}

static void release(way *w) {
  strut_period_map_free(&w->cheap);
  strut_period_map_free(&w->fine);
  strut_summary_free(&w->run);
  strut_summary_free(&w->last);
  strut_arena_free(&w->arena);
}

/*
 * From nearly steady to the fixed point of the cheap map: by extrapolation, or, where that fails, by
 * running on. *steady is false where there is none.
 */
static strut_status settle_cheap(way *w, bool *steady) {
  strut_accuracy *a = w->a;
  bool found = false;
  double enough = 0.1 * a->wanted * size_of_velocity(a, w->run.velocity) * w->cheap.period;
  strut_status status =
      strut_orbit_limit(&w->cheap, enough * w->cheap.repeats, w->base, &w->travel, &found);
  if (status) return strut_fail(a->error, status, "out of memory");
  if (!found) {
    strut_summary more = {0};
    status = run_until_steady(w, a->cheap, fmin(0.002, 0.1 * a->wanted), 5, 150.0, true, &more);
    *steady = !status && more.steady.kind == STRUT_MOTION_PERIODIC;
    if (!status) add_part(&w->run, &more);
    strut_summary_free(&more);
    take_end(w);
  }
  w->run.velocity = w->travel / (w->cheap.period * w->cheap.repeats);
  memcpy(w->orbit.y, w->base, (2 * (size_t)w->cheap.model->length + 1) * sizeof(double));
  return status;
}

/*
 * Where the cheap method never repeats itself the accurate one may: its steps meet no grid. Goes on
 * from where the cheap one ended.
 */
static strut_status find_without_cheap(way *w, strut_summary *orbit) {
  w->run.steady.repeats = 1;
  strut_status status = make_maps(w);
  w->error = HUGE_VAL;
  if (!status) status = run_accurate(w, true, &w->last);
  if (status || !w->finished || w->last.steady.repeats > 1 ||
      !strut_accuracy_orbit_answers(w->a, &w->last.steady)) {
    w->error = HUGE_VAL;
    return status;
  }
  return run_orbit(w, orbit);
}

/* The orbit, as accurately as is wanted, and the motion on it. */
static strut_status find_orbit(way *w, strut_summary *orbit, bool *cheap_does) {
  strut_accuracy *a = w->a;
  bool steady = true;
  strut_status status = make_maps(w);
  if (!status) status = settle_cheap(w, &steady);
  double size = size_of_velocity(a, w->run.velocity);
  w->error = HUGE_VAL;
  if (status) return status;
  w->settled = (way_cost){w->cheap.evaluations, w->cheap.events, w->cheap.applied};
  bool last_word = a->wanted < FINE; /* the accurate method goes on itself: come near enough */
  double enough = (last_word ? 3.0 : 0.3) * a->wanted * size;
  if (steady) status = correct(w, enough, a->wanted >= COARSE || last_word ? 1 : 2);
  if (status) return status;
  double moved = steady ? fabs(w->orbit.velocity - w->run.velocity) + w->error : HUGE_VAL;
  *cheap_does = a->wanted >= COARSE && moved <= 0.8 * a->wanted * size;
  bool stuck = is_stuck(w);
  if (stuck) *cheap_does = false;
  if (stuck || (!*cheap_does && (a->wanted < FINE || !(part_of_wanted(w) <= 0.8))))
    status = run_accurate(w, !stuck, &w->last);
  if (status || !isfinite(w->error)) return status;
  status = run_orbit(w, orbit);
  double away = fabs(orbit->velocity - w->orbit.velocity);
  if (status || w->finished || away <= 0.6 * a->wanted * size) return status;
  *cheap_does = false;
  a->spent += orbit->force_evaluations; /* its own velocity does not confirm the orbit */
  strut_summary_free(orbit);
  status = run_accurate(w, true, &w->last);
  return status ? status : run_orbit(w, orbit);
}

strut_status strut_accuracy_by_orbit(strut_accuracy *a, bool *done) {
  way w = {.a = a};
  *done = false;
  if (strut_accuracy_periods(a) < LEAST) return STRUT_OK;
  bool steady = false, cheap_does = false;
  strut_summary orbit = {0};
  const strut_experiment given = a->cheap;
  a->cheap.refine_rate = 0.5; /* its orbit will be corrected: a short refinement is enough */
  a->cheap.refine_memory = 3.0;
  strut_status status = run_cheap(&w, &steady);
  bool ran = !status && w.run.status == STRUT_OK;
  if (!status && steady)
    status = find_orbit(&w, &orbit, &cheap_does);
  else if (ran)
    status = find_without_cheap(&w, &orbit);
  *done = !status && ran && isfinite(w.error);
  if (*done)
    tell(&w, &orbit, cheap_does);
  else
    give_up(&w, &orbit);
  a->cheap = given;
  release(&w);
  return status == STRUT_DIVERGED ? STRUT_OK : status;
}
