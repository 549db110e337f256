/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * To an accuracy by repetition: ever finer runs until two agree, not only in the velocity, which they
 * may do by chance, but as motions. No two runs are alike: from one to the next method, tolerance and
 * longest step change, so that what they agree on is not what they have in common.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/integrate/integrator.h"
#include "engine/run/accuracy/accuracy.h"
#include "engine/run/recorder.h"

/* ---- tracks: node positions at moments near the end of a run, which show that two runs are the same motion ---- */

typedef struct track {
  const strut_model *model; /* of the scene; any run of it may be recorded */
  size_t room, count;       /* moments there is memory for; moments of the latest run */
  double *time;             /* (room) [s] */
  double *position;         /* (room, node_count, 2) [m] */
  strut_sink sink;          /* to be given to the run */
} track;

/* Moments of two runs that are this close, relative to the time between two of them, are the same. */
static const double SAME_MOMENT = 1e-3;
/* The least motion that distances are relative to, over the structure's size. */
static const double LEAST_MOTION = 1e-4;

static strut_status begin_track(void *context, const strut_record_layout *layout,
                                strut_error *error) {
  (void)layout, (void)error;
  ((track *)context)->count = 0;
  return STRUT_OK;
}

static strut_status record_track_rows(void *context, const double *rows, size_t count,
                                      strut_error *error) {
  track *t = context;
  size_t both = 2 * (size_t)t->model->node_count;
  (void)error;
  for (size_t k = 0; k < count && t->count < t->room; k++, t->count++) {
    const double *row = rows + k * (both + 1);
    t->time[t->count] = row[0];
    memcpy(t->position + t->count * both, row + 1, both * sizeof(double));
  }
  return STRUT_OK;
}

static strut_status end_track(void *context, strut_status status, strut_error *error) {
  (void)context, (void)status, (void)error;
  return STRUT_OK;
}

static strut_status create_track(const strut_model *model, size_t room, strut_arena *arena,
                                 track *t) {
  size_t both = 2 * (size_t)model->node_count;
  *t = (track){.model = model, .room = room};
  t->sink = (strut_sink){t, begin_track, record_track_rows, end_track, STRUT_CHANNEL_POSITION};
  t->time = strut_arena_allocate(arena, room, sizeof(double));
  t->position = strut_arena_allocate(arena, room * both, sizeof(double));
  return t->time && t->position ? STRUT_OK : STRUT_NO_MEMORY;
}

/* The mean position along the ground at moment k; 0 where a support or no ground holds it. */
static double mean_along(const track *t, size_t k) {
  const strut_model *model = t->model;
  const double *q = t->position + 2 * k * (size_t)model->node_count;
  double sum = 0.0;
  if (!model->contacts.count) return 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    if (model->fixed[2 * i] || model->fixed[2 * i + 1]) return 0.0;
    sum += q[2 * i] * model->contacts.tangent[0] + q[2 * i + 1] * model->contacts.tangent[1];
  }
  return sum / model->node_count;
}

/*
 * The largest distance between two tracks at the same moments, over how far the nodes move in them: 0 for
 * the same motion, about 1 for two that have nothing in common. How far the whole has travelled along
 * the ground is left out. HUGE_VAL where the moments differ, but for whole periods [s] where `period` is not 0.
 * Motions below 1e-4 of the structure's size count as that.
 */
static double measure_track_distance(const track *a, const track *b, double period) {
  const strut_model *model = a->model;
  size_t both = 2 * (size_t)model->node_count, count = a->count;
  double away = 0.0, motion = LEAST_MOTION * model->size;
  if (count != b->count || count < 2) return HUGE_VAL;
  double apart = (a->time[count - 1] - a->time[0]) / (double)(count - 1);
  double first = mean_along(a, 0);
  for (size_t k = 0; k < count; k++) {
    double here = mean_along(a, k), there = mean_along(b, k);
    double later = a->time[k] - b->time[k];
    if (period > 0.0) later = remainder(later, period);
    if (fabs(later) > SAME_MOMENT * apart) return HUGE_VAL;
    for (size_t i = 0; i < both; i++) {
      double t = model->contacts.count ? model->contacts.tangent[i % 2] : 0.0;
      double x = a->position[k * both + i] - here * t, y = b->position[k * both + i] - there * t;
      double x0 = a->position[i] - first * t;
      away = fmax(away, fabs(x - y));
      motion = fmax(motion, fabs(x - x0));
    }
  }
  return away / motion;
}

/* ---- the ladder of runs ---- */

/* From one run by error control to the next: tolerance, and longest step. The error of a step is of fifth
   order, so that both do about as much. */
static const double FINER_TOLERANCE = 1.0 / 30.0, FINER_STEP = 0.5;
/* Least tolerance: below it rounding decides. */
static const double LEAST_TOLERANCE = 3e-14;
/* Longest steps in a period, of the first of them; and steps between two moments of a track. */
enum { STEPS_OF_PERIOD = 50, STEPS_OF_MOMENT = 5, MOST_MOMENTS = 61 };
/* Between two moments at most this part of the shortest time of a signal. */
static const double OF_SIGNAL = 0.1;
/* Doubles that a track may have. */
static const double TRACK_ROOM = 4e6;
/* Runs at most. */
enum { MOST_RUNS = 12 };

/* Of the largest value that a quantity is made of: below this part of that it counts as none. */
static const double STANDING_QUANTITY = 1e-3;

/* One run, and what is kept of it. */
typedef struct rung {
  strut_experiment e;
  strut_summary s;
  track track;
  int64_t cost; /* evaluations of the forces */
} rung;

typedef struct ladder {
  strut_accuracy *a;
  rung rung[3], *now, *before;
  double unit;   /* the longest steps and moments divide it [s] */
  double moment; /* between two moments of a track [s] */
  double apart,
      earlier; /* velocities of the latest two runs, and of the two before, over their size */
  double *difference; /* (quantities) of the latest two runs, SI */
  size_t worst;       /* the quantity that is furthest from what is wanted of it */
  double distance;    /* of the motions of the latest two */
  int runs;
  double mean[MOST_RUNS]; /* (means) velocities of the runs but the first [m/s] */
  int means;
  double expected; /* error of the latest run, relative */
  bool same_motion, kept, spent;
  const strut_model *model;
  strut_arena arena;
} ladder;

/*
 * The time that longest steps divide, so that the ends of the window fall on the grid: a period, or the
 * largest of some parts of the run that meets the window's start; `*meets` is false where none does.
 */
static double unit_of(const strut_accuracy *a, bool *meets) {
  strut_span span = strut_experiment_span(&a->experiment, a->scene);
  *meets = true;
  if (span.period > 0.0) {
    double phase = span.window_start / span.period;
    *meets = fabs(phase - round(phase)) < 1e-9;
    return span.period;
  }
  for (int n = 1; n <= 20; n++) {
    double at = span.window_start / span.duration * n;
    if (fabs(at - round(at)) < 1e-9 * n) return span.duration / n;
  }
  *meets = false;
  return span.duration;
}

static double divide(double unit, double step) { return unit / ceil(unit / step * (1.0 - 1e-9)); }

/*
 * The k-th run. A method that takes rigid bars has no other to be compared with: ever smaller steps.
 * Else Verlet first, then error control.
 */
static strut_experiment experiment_of(const ladder *l, int k) {
  const strut_accuracy *a = l->a;
  strut_experiment e = a->cheap;
  e.steady.tolerance = fmin(e.steady.tolerance, 0.2 * a->wanted);
  e.step = divide(l->moment, e.step);
  if (a->halving) e.step = ldexp(e.step, -k);
  if (!a->halving && k > 0) {
    e.integrator = strut_integrator_for(STRUT_ROLE_REFERENCE)->name;
    e.step = l->moment / STEPS_OF_MOMENT * pow(FINER_STEP, k - 1);
    e.tolerance = fmin(1e-4, 1e-2 * a->wanted) * pow(FINER_TOLERANCE, k - 1);
    e.tolerance = fmax(LEAST_TOLERANCE, e.tolerance);
  }
  strut_span span = strut_experiment_span(&a->experiment, a->scene);
  double kept = (MOST_MOMENTS - 1) * l->moment;
  e.output_every = l->moment;
  e.output_last = kept < span.duration ? kept / (span.period > 0.0 ? span.period : 1.0) : 0.0;
  return e;
}

static double size_of(const ladder *l, double velocity) {
  return fmax(fabs(velocity), l->a->scale);
}

/* What quantity i may be off by [its unit]; relative wishes are to its size, or to a thousandth of what it is
   made of where that is larger. */
static double allowed_of(const ladder *l, const strut_measured *m, size_t i) {
  const strut_quantity_definition *d = &l->a->experiment.quantities[i];
  if (d->accuracy_absolute > 0.0) return d->accuracy_absolute;
  double part = d->accuracy > 0.0 ? d->accuracy : l->a->wanted;
  return part * fmax(fabs(m->value), STANDING_QUANTITY * m->scale);
}

/*
 * How far what two runs measure is apart, relative to the velocity; or, where the scene names quantities, the
 * worst of them in parts of what it may be off by, times the accuracy wanted, so that both read alike.
 */
static double differ(ladder *l, const strut_summary *one, const strut_summary *other) {
  double worst = 0.0;
  if (one->measured_count == 0)
    return fabs(one->velocity - other->velocity) / size_of(l, one->velocity);
  for (size_t i = 0; i < one->measured_count; i++) {
    const strut_measured *m = &one->measured[i];
    double apart = fabs(m->value - other->measured[i].value), allowed = allowed_of(l, m, i);
    l->difference[i] = apart;
    if (apart == 0.0) continue;
    double part = l->a->wanted * apart / allowed;
    if (!(part <= worst)) worst = isnan(part) ? HUGE_VAL : part;
    if (worst == (isnan(part) ? HUGE_VAL : part)) l->worst = i;
  }
  return worst;
}

/* The latest run came to no end within the work allowed: the one before it has the word, if there is one. */
static strut_status give_back(ladder *l) {
  rung *cut = l->now;
  l->spent = true;
  if (l->runs < 2) return STRUT_WORK_LIMIT;
  l->now = l->before;
  l->before = cut;
  l->runs--;
  return STRUT_OK;
}

/* One more run, quietly, and how it compares with the one before. */
static strut_status climb(ladder *l) {
  rung *next = l->runs == 0 ? l->rung : l->now == &l->rung[1] ? &l->rung[2] : &l->rung[1];
  strut_run_options quiet = *l->a->options;
  strut_sink *sinks[] = {&next->track.sink};
  l->before = l->now;
  l->now = next;
  strut_summary_free(&next->s);
  next->e = experiment_of(l, l->runs++);
  strut_accuracy_begin_phase(l->a, l->runs == 1 ? "first run" : "checking by a finer run");
  quiet.sinks = sinks, quiet.sink_count = 1, quiet.to = NULL;
  strut_status status = strut_accuracy_run(l->a, &next->e, &quiet, &next->s);
  next->cost = next->s.force_evaluations;
  l->a->spent += next->cost;
  if (status == STRUT_WORK_LIMIT) return give_back(l);
  l->earlier = l->apart;
  l->apart = l->distance = HUGE_VAL;
  if (status && status != STRUT_DIVERGED) return status;
  if (status || l->runs == 1 || l->before->s.status) return STRUT_OK;
  double period =
      next->e.steady.wanted ? strut_experiment_span(&l->a->experiment, l->a->scene).period : 0.0;
  l->apart = differ(l, &next->s, &l->before->s);
  l->distance = measure_track_distance(&next->track, &l->before->track, period);
  if (l->runs > 1 && l->means < MOST_RUNS) l->mean[l->means++] = next->s.velocity;
  return STRUT_OK;
}

/* Motions that are this close, over how far the nodes move, are the same. */
static const double SAME_MOTION = 0.03;
/* Of what is wanted, what may be expected: of runs by two methods, of which one is coarse and nothing is known of
   how fast it converges; and of others. */
static const double ENOUGH_OF_TWO = 0.2, ENOUGH = 0.3;
/* The same of the first two runs by error control: their steps may still be the longest allowed, so that their
   tolerances changed nothing, and no third shows how fast they approach the answer. */
static const double ENOUGH_OF_FIRST_PAIR = 0.15;
/* The same of a method that only has itself to be compared with. */
static const double ENOUGH_ALONE = 0.05;
/* Least runs by which a mean is known, and standard deviations within which it is said to be. */
enum { LEAST_MEANS = 5 };
/* Part of what is wanted within which the means of motions that differ are believed. */
static const double ENOUGH_OF_MEANS = 0.1;
/* What is told over what is expected. */
static const double MARGIN = 2.0, MARGIN_OF_FIRST_PAIR = 4.0;
static const double DEVIATIONS = 4.0;

/*
 * The error to expect of the latest run, relative, where it and the one before are the same motion. Where a
 * third shows how fast runs approach each other, what is left of a series that goes on so; else their
 * difference.
 */
static double expect_of_motion(const ladder *l) {
  if (!(l->distance <= SAME_MOTION)) return HUGE_VAL;
  bool series = l->runs > 3 || (l->a->halving && l->runs > 2);
  double ratio = series && l->earlier > 0.0 ? l->apart / l->earlier : 0.5;
  double noise = 1e-9; /* differences of which say nothing of convergence */
  if (!(ratio < 0.7) && l->apart > noise) return HUGE_VAL;
  return l->apart * fmax(1.0, ratio / (1.0 - fmin(ratio, 0.7)));
}

/*
 * That of the mean velocity of a motion that no two runs agree on: what the runs' velocities, each of a motion of
 * its own, scatter by. HUGE_VAL where there are too few.
 */
static double expect_of_means(const ladder *l) {
  double mean = 0.0, square = 0.0;
  int first = l->means > LEAST_MEANS + 1 ? l->means - LEAST_MEANS - 1 : 0, n = l->means - first;
  if (n < LEAST_MEANS || l->a->halving || l->now->s.measured_count) return HUGE_VAL;
  for (int k = first; k < l->means; k++) mean += l->mean[k] / n;
  for (int k = first; k < l->means; k++) square += (l->mean[k] - mean) * (l->mean[k] - mean);
  return DEVIATIONS * sqrt(square / (n - 1)) / size_of(l, mean);
}

/* Whether the latest run does, and how well. */
static void judge(ladder *l) {
  double wanted = l->a->wanted, enough = l->runs == 2 ? ENOUGH_OF_TWO : ENOUGH;
  if (l->runs == 3) enough = ENOUGH_OF_FIRST_PAIR;
  if (l->a->halving) enough = ENOUGH_ALONE;
  l->expected = expect_of_motion(l);
  l->same_motion = l->distance <= SAME_MOTION;
  /* steps of one method must agree twice: once is chance where it is of first order */
  bool once = l->a->halving && l->runs < 3;
  l->kept = !once && l->expected <= enough * wanted;
  if (l->kept || l->same_motion) return;
  l->expected = expect_of_means(l);
  bool zero = !l->now->s.measured_count && l->now->s.velocity_zero && l->before->s.velocity_zero;
  if (zero) l->expected = 0.0;
  l->kept = zero || l->expected <= ENOUGH_OF_MEANS * wanted;
}

static bool may_go_on(const ladder *l) {
  if (l->kept || l->spent || l->runs >= MOST_RUNS) return false;
  if (l->runs < 2 || l->a->halving) return true;
  return l->now->e.tolerance > LEAST_TOLERANCE;
}

static strut_status create(strut_accuracy *a, ladder *l) {
  bool meets = true;
  strut_status status = STRUT_OK;
  l->model = a->model;
  l->unit = unit_of(a, &meets);
  l->moment = l->unit / (STEPS_OF_PERIOD / STEPS_OF_MOMENT);
  double signals = strut_accuracy_signal_time(a->scene);
  if (l->moment > OF_SIGNAL * signals) l->moment = divide(l->moment, OF_SIGNAL * signals);
  if (!meets) l->moment = divide(l->moment, fmin(l->unit / 40.0, 5.0 * a->cheap.step));
  double room = TRACK_ROOM / (2.0 * l->model->node_count);
  size_t moments = room < 2.0 ? 2 : room < MOST_MOMENTS ? (size_t)room : MOST_MOMENTS;
  for (int k = 0; k < 3 && !status; k++)
    status = create_track(l->model, moments, &l->arena, &l->rung[k].track);
  size_t quantities = a->experiment.quantity_count;
  if (!status && !(l->difference = strut_arena_allocate(&l->arena, quantities, sizeof(double))))
    status = STRUT_NO_MEMORY;
  return status ? strut_fail(a->error, status, "out of memory") : STRUT_OK;
}

/* "a velocity that differs by 2 m/s" */
static void name_difference(const ladder *l, char *text, size_t size) {
  const strut_summary *s = l->a->summary;
  if (s->measured_count)
    snprintf(text, size, "'%.60s', which differs by %.2g %s", s->measured[l->worst].name,
             l->difference[l->worst], s->measured[l->worst].unit);
  else if (s->velocity_zero)
    snprintf(text, size, "a velocity that is zero but for rounding, as by symmetry");
  else
    snprintf(text, size, "a velocity that differs by %.2g m/s", l->apart * size_of(l, s->velocity));
}

/* What the answer rests on, and, where it is none, why and what to do. */
static void explain(const ladder *l, char *why, size_t size) {
  const strut_accuracy *a = l->a;
  const strut_experiment *e = &l->now->e;
  char how[80], apart[120];
  name_difference(l, apart, sizeof apart);
  if (strut_integrator_find(e->integrator)->role == STRUT_ROLE_REFERENCE)
    snprintf(how, sizeof how, "adaptive with a tolerance of %.1g and steps up to %.2g s",
             e->tolerance, e->step);
  else
    snprintf(how, sizeof how, "%s with a step of %.3g s", e->integrator, e->step);
  if (l->runs == 1)
    snprintf(why, size,
             "%s, which nothing confirms: the work allowed, %.2g evaluations of the forces, was "
             "used up before a second run came to its end; give a larger budget",
             how, (double)a->budget);
  else if (l->kept && !l->same_motion)
    snprintf(why, size, "%s: a coarser run gives another motion, but %s; so do all %d of them", how,
             apart, l->means);
  else if (l->kept)
    snprintf(why, size, "%s: %s gives the same motion, and %s", how,
             l->runs == 2 && !a->halving ? strut_integrator_for(STRUT_ROLE_COARSE)->name
                                         : "a coarser run",
             apart);
  else if (l->same_motion)
    snprintf(why, size, "%s; a coarser run gives the same motion, but %s%s", how, apart,
             l->spent ? ", and the work allowed is used up; give a larger budget" : "");
  else
    snprintf(why, size,
             "%s; a coarser run gives another motion, and %s: nearby motions separate, so that "
             "this one may be chaotic over its time%s",
             how, apart, l->spent ? "; a larger budget may help" : "");
}

static double margin_of(const ladder *l) {
  return l->runs == 3 && !l->a->halving ? MARGIN_OF_FIRST_PAIR : MARGIN;
}

/* The error to expect of each quantity, and whether it is within what is wanted of that. */
static void tell_quantities(const ladder *l) {
  strut_summary *s = l->a->summary;
  double factor = l->apart > 0.0 && isfinite(l->expected) ? l->expected / l->apart : 1.0;
  for (size_t i = 0; i < s->measured_count; i++) {
    strut_measured *m = &s->measured[i];
    m->expected = l->runs > 1 ? margin_of(l) * factor * l->difference[i] : (double)NAN;
    m->kept = l->kept || (l->same_motion && m->expected <= allowed_of(l, m, i));
  }
}

static void tell(ladder *l) {
  strut_accuracy *a = l->a;
  strut_summary *s = a->summary;
  double expected = l->same_motion ? margin_of(l) * l->expected : l->expected;
  if (!isfinite(expected)) expected = (double)NAN; /* too few runs to tell */
  s->accuracy = (strut_accuracy_summary){.wanted = a->wanted,
                                         .expected = expected,
                                         .scale = a->scale,
                                         .kept = l->kept,
                                         .check_evaluations = a->spent};
  explain(l, s->accuracy.why, sizeof s->accuracy.why);
  tell_quantities(l);
}

/* The latest run is the answer; once more where it is recorded. */
static strut_status answer(ladder *l) {
  strut_accuracy *a = l->a;
  a->spent -= l->now->cost;
  if (!a->options->sink_count && !a->options->to && l->now->s.status == STRUT_OK) {
    *a->summary = l->now->s;
    l->now->s = (strut_summary){0};
    return STRUT_OK;
  }
  a->spent += l->now->cost;
  strut_experiment e = l->now->e;
  strut_accuracy_begin_phase(a, "recording the answer");
  a->allowed = INT64_MAX; /* as much as the same run took before */
  e.output_every = a->experiment.output_every;
  e.output_last = a->experiment.output_last;
  return strut_accuracy_run(a, &e, a->options, a->summary);
}

strut_status strut_accuracy_by_repetition(strut_accuracy *a) {
  ladder l = {
      .a = a, .apart = HUGE_VAL, .earlier = HUGE_VAL, .distance = HUGE_VAL, .expected = HUGE_VAL};
  strut_status status = create(a, &l);
  while (!status && may_go_on(&l)) {
    status = climb(&l);
    if (!status && !l.spent && l.runs > 1) judge(&l);
  }
  /* a series of three runs or more that could go no further may do all the same */
  if (!l.kept && l.same_motion && l.runs > 2) l.kept = margin_of(&l) * l.expected <= a->wanted;
  if (!status) status = answer(&l);
  if (!status) tell(&l);
  for (int k = 0; k < 3; k++) strut_summary_free(&l.rung[k].s);
  strut_arena_free(&l.arena);
  return status;
}
