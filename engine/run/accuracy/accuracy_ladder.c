/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A wanted accuracy by repetition: ever finer runs until two agree, not only in the velocity, which
 * may agree by chance, but as motions. Method, tolerance and longest step all change between runs,
 * so that agreement is not a shared error.
 */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/integrate/integrator.h"
#include "engine/run/accuracy/accuracy.h"

/* Factor from one run with error control to the next. */
static const double FINER_TOLERANCE = 1.0 / 30.0;
/*
 * Tolerance of the first such run: at most, and over the wanted error. Looser ones cost hardly less, since
 * the cost is in the events and the longest step, and may agree with verlet-events on a motion that neither
 * leads to.
 */
static const double FIRST_TOLERANCE = 1e-5, FIRST_TOLERANCE_PER_ERROR = 1e-3;
/* Smallest tolerance: below it rounding dominates. */
static const double LEAST_TOLERANCE = 3e-14;
/* Moments of a track: per period or run, and the most. */
enum { MOMENTS_OF_PERIOD = 10, MOST_MOMENTS = 61 };
/* Moments are at most this part of the shortest signal time apart. */
static const double SIGNAL_FRACTION = 0.1;
/* Largest size of a track in doubles. */
static const double MOST_TRACK_NUMBERS = 4e6;
enum { MOST_RUNS = 12 };
/*
 * Longest steps per moment of the runs with error control. They grow slowly, since the tolerance bounds the error and
 * the longest step the cost. Successive ones have no common divisor: two runs so meet at moments only, and a peak that
 * both miss in between is not missed alike.
 */
static const double STEPS_OF_MOMENT[MOST_RUNS] = {3, 4, 5, 7, 9, 11, 13, 17, 19, 23, 29, 31};

/* Quantities below this part of their largest term count as zero. */
static const double ZERO_QUANTITY = 1e-3;

/* One run with its result. */
typedef struct rung {
  strut_experiment e;
  strut_summary s;
  strut_track track;
  int64_t cost; /* force evaluations */
} rung;

typedef struct ladder {
  strut_accuracy *a;
  rung rung[3], *now, *before;
  double unit;                   /* the longest steps and moments divide it [s] */
  double moment;                 /* between moments of a track [s] */
  double change, earlier_change; /* relative, of the latest two runs and of the two before */
  double earliest_change;        /* of the two before those */
  double *difference;            /* (quantities) of the latest two runs, SI */
  double *shifted;               /* (quantities) what a shifted start changes, SI */
  double sensitivity;            /* the same as `change` */
  double *results;               /* (runs, quantities + 1) of each run, then the velocity, SI */
  size_t worst;                  /* index of the quantity with the largest relative error */
  double distance;               /* of the latest two tracks */
  int runs, coarse_runs;         /* of all, the first ones, by the coarse method */
  double mean[MOST_RUNS];        /* (means) velocities of the runs with error control [m/s] */
  int means;
  double expected; /* estimated error of the latest run, relative */
  bool same_motion, kept, budget_spent;
  const strut_model *model;
  strut_arena arena;
} ladder;

/*
 * Finds the time that the longest step divides, so that both ends of the window fall on the grid: a
 * period, or the largest fraction of the run that divides the start of the window; `*meets` is
 * false where there is none.
 */
static double find_grid_unit(const strut_accuracy *a, bool *meets) {
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

/* Not positive before the first one; meaningless where only one method suits the scene. */
static int runs_with_error_control(const ladder *l) { return l->runs - l->coarse_runs; }

static double divide_evenly(double unit, double step) {
  return unit / ceil(unit / step * (1.0 - 1e-9));
}

/*
 * Fixed steps between two moments in the k-th of runs of which the first has `first`: about twice as many from run to
 * run, without a common divisor, as above.
 */
static double count_steps_of_moment(double first, int k) {
  double count = first;
  for (int i = 0; i < k; i++) count = 2.0 * count + (i % 2 ? -1.0 : 1.0);
  return count;
}

/*
 * Settings of the k-th run: ever smaller steps where only one method suits the scene, otherwise first Verlet, with
 * half the step too where the run is short, and then error control.
 */
static strut_experiment refine_experiment(const ladder *l, int k) {
  const strut_accuracy *a = l->a;
  strut_experiment e = a->coarse;
  e.steady.tolerance = fmin(e.steady.tolerance, 0.2 * a->target);
  double coarse = ceil(l->moment / e.step * (1.0 - 1e-9));
  if (a->single_method || k < l->coarse_runs) {
    e.step = l->moment / count_steps_of_moment(coarse, k);
    if (k > 0) e.refine_rate *= 0.5; /* steps after a touchdown are finer, too */
  } else {
    int further = k - l->coarse_runs;
    e.integrator = strut_integrator_for(STRUT_ROLE_REFERENCE)->name;
    e.step = l->moment / STEPS_OF_MOMENT[further];
    e.tolerance = fmin(FIRST_TOLERANCE, FIRST_TOLERANCE_PER_ERROR * a->target);
    e.tolerance = fmax(LEAST_TOLERANCE, e.tolerance * pow(FINER_TOLERANCE, further));
  }
  strut_span span = strut_experiment_span(&a->experiment, a->scene);
  double kept = (MOST_MOMENTS - 1) * l->moment;
  e.output_every = l->moment;
  e.output_last = kept < span.duration ? kept / (span.period > 0.0 ? span.period : 1.0) : 0.0;
  e.steady.run_on =
      (int64_t)ceil(e.output_last - 1e-9); /* of the answer too, whatever is recorded */
  return e;
}

static double velocity_size(const ladder *l, double velocity) {
  return fmax(fabs(velocity), l->a->scale);
}

/*
 * Error allowed for quantity i, in its unit. Relative ones refer to its value, or to a thousandth
 * of its largest term if that is larger.
 */
static double tolerated_error(const ladder *l, const strut_measured *m, size_t i) {
  const strut_quantity_definition *d = &l->a->experiment.quantities[i];
  if (d->accuracy_absolute > 0.0) return d->accuracy_absolute;
  double part = d->accuracy > 0.0 ? d->accuracy : l->a->target;
  return part * fmax(fabs(m->value), ZERO_QUANTITY * m->scale);
}

/*
 * Difference of two runs, relative to the velocity; or, where the scene names quantities, the
 * largest over its allowed error, times the wanted accuracy, so that both are comparable. Fills
 * `difference` (quantities), SI.
 */
static double compare_results(ladder *l, const strut_summary *one, const strut_summary *other,
                              double *difference) {
  double worst = 0.0;
  if (one->measured_count == 0)
    return fabs(one->velocity - other->velocity) / velocity_size(l, one->velocity);
  for (size_t i = 0; i < one->measured_count; i++) {
    const strut_measured *m = &one->measured[i];
    double apart = fabs(m->value - other->measured[i].value), allowed = tolerated_error(l, m, i);
    bool never = isnan(m->value) && isnan(other->measured[i].value) &&
                 l->a->experiment.quantities[i].take == STRUT_TAKE_ARRIVAL;
    if (never) apart = 0.0; /* neither run reaches the target */
    difference[i] = apart;
    if (apart == 0.0) continue;
    double part = l->a->target * apart / allowed;
    if (!(part <= worst)) worst = isnan(part) ? HUGE_VAL : part;
    if (worst == (isnan(part) ? HUGE_VAL : part)) l->worst = i;
  }
  return worst;
}

/* The latest run exceeded the budget: the one before it becomes the answer, if there is one. */
static strut_status discard_unfinished_run(ladder *l) {
  rung *unfinished = l->now;
  l->budget_spent = true;
  if (l->runs < 2) return STRUT_WORK_LIMIT;
  l->now = l->before;
  l->before = unfinished;
  l->runs--;
  return STRUT_OK;
}

/* Keeps the results of the latest run, for their range. */
static void keep_results(const ladder *l, const strut_summary *s) {
  double *value = l->results + (size_t)(l->runs - 1) * (l->a->experiment.quantity_count + 1);
  for (size_t i = 0; i < s->measured_count; i++) value[i] = s->measured[i].value;
  value[s->measured_count] = s->velocity;
}

/* Makes one more run without output and compares it with the one before. */
static strut_status run_next_rung(ladder *l) {
  rung *next = l->runs == 0 ? l->rung : l->now == &l->rung[1] ? &l->rung[2] : &l->rung[1];
  strut_run_options quiet = *l->a->options;
  strut_sink *sinks[] = {&next->track.sink};
  assert(next != l->now && l->runs < MOST_RUNS);
  l->before = l->now;
  l->now = next;
  strut_summary_free(&next->s);
  next->e = refine_experiment(l, l->runs++);
  strut_accuracy_begin_phase(l->a, l->runs == 1 ? "first run" : "checking by a finer run");
  quiet.sinks = sinks, quiet.sink_count = 1, quiet.to = NULL;
  strut_status status = strut_accuracy_run(l->a, &next->e, &quiet, &next->s);
  next->cost = next->s.spent.evaluations;
  l->a->check_evaluations += next->cost;
  if (status == STRUT_WORK_LIMIT) return discard_unfinished_run(l);
  l->earliest_change = l->earlier_change;
  l->earlier_change = l->change;
  l->change = l->distance = HUGE_VAL;
  if (status && status != STRUT_DIVERGED) return status;
  keep_results(l, &next->s);
  if (status || l->runs == 1 || l->before->s.status) return STRUT_OK;
  double period =
      next->e.steady.wanted ? strut_experiment_span(&l->a->experiment, l->a->scene).period : 0.0;
  l->change = compare_results(l, &next->s, &l->before->s, l->difference);
  l->distance = strut_track_distance(&next->track, &l->before->track, period);
  if (runs_with_error_control(l) > 0 && l->means < MOST_RUNS)
    l->mean[l->means++] = next->s.velocity;
  return STRUT_OK;
}

/* Tracks closer than this, relative to the range of motion, are the same motion. */
static const double SAME_MOTION = 0.03;
/*
 * The same for two runs of which the first is coarse: over the accuracy wanted, and at most. A mean velocity that is
 * small beside the nodes' may agree by chance where their motions do not.
 */
static const double SAME_MOTION_OF_COARSE = 0.5, MOST_APART_OF_COARSE = 0.005;
/*
 * Expected error that is accepted, as part of the wanted one: of two runs, the first coarse and of unknown convergence;
 * and of later runs.
 */
static const double ENOUGH_OF_COARSE = 0.2, ENOUGH = 0.3;
/*
 * The same for the first two runs with error control: both may have taken the longest step, so that
 * their tolerances changed nothing, and no third run shows the convergence.
 */
static const double ENOUGH_OF_FIRST_PAIR = 0.05;
/* The same where only one method suits the scene. */
static const double ENOUGH_ALONE = 0.05;
/* Runs converge whose differences shrink from one to the next by this factor or a smaller one. */
static const double CONVERGING = 0.7;
/* Runs needed for a mean over different motions. */
enum { LEAST_MEANS = 5 };
/* Part of the wanted error within which means of different motions must agree. */
static const double ENOUGH_OF_MEANS = 0.1;
/* Reported error over the estimate. */
static const double MARGIN = 2.0, MARGIN_OF_FIRST_PAIR = 4.0;
static const double DEVIATIONS = 4.0;

/*
 * Estimates the relative error of the latest run where it and the one before are the same motion:
 * the rest of a geometric series where a third run shows the rate, otherwise their difference.
 */
static double estimate_motion_error(const ladder *l) {
  if (!(l->distance <= SAME_MOTION)) return HUGE_VAL;
  bool series = runs_with_error_control(l) > 2 || (l->a->single_method && l->runs > 2);
  double ratio = series && l->earlier_change > 0.0 ? l->change / l->earlier_change : 0.5;
  double noise = 1e-9; /* smaller differences are rounding and show no convergence */
  if (!(ratio < CONVERGING) && l->change > noise) return HUGE_VAL;
  /* after differences that did not shrink, one that is small may be chance */
  bool stalled = l->earlier_change > CONVERGING * l->earliest_change &&
                 l->earlier_change > ENOUGH * l->a->target;
  if (series && stalled && l->change > noise) return HUGE_VAL;
  return l->change * fmax(1.0, ratio / (1.0 - fmin(ratio, CONVERGING)));
}

/*
 * Estimates the relative error of the mean velocity where all runs are different motions:
 * DEVIATIONS standard deviations of their velocities. HUGE_VAL where there are too few.
 */
static double estimate_mean_error(const ladder *l) {
  double mean = 0.0, square = 0.0;
  int first = l->means > LEAST_MEANS + 1 ? l->means - LEAST_MEANS - 1 : 0, n = l->means - first;
  if (n < LEAST_MEANS || l->a->single_method || l->now->s.measured_count) return HUGE_VAL;
  for (int k = first; k < l->means; k++) mean += l->mean[k] / n;
  for (int k = first; k < l->means; k++) square += (l->mean[k] - mean) * (l->mean[k] - mean);
  return DEVIATIONS * sqrt(square / (n - 1)) / velocity_size(l, mean);
}

/* Decides whether the latest run is accurate enough, and estimates its error. */
static void judge_agreement(ladder *l) {
  int further = runs_with_error_control(l);
  double wanted = l->a->target, enough = further < 2 ? ENOUGH_OF_COARSE : ENOUGH;
  if (further == 2) enough = ENOUGH_OF_FIRST_PAIR;
  if (l->a->single_method) enough = ENOUGH_ALONE;
  l->expected = estimate_motion_error(l);
  l->same_motion = l->distance <= SAME_MOTION;
  /* steps of one method must agree twice: a single agreement may be chance */
  bool once = l->a->single_method && l->runs < 3;
  double near = fmin(SAME_MOTION_OF_COARSE * wanted, MOST_APART_OF_COARSE);
  bool apart = further < 2 && l->distance > near;
  l->kept = strut_accuracy_is_kept(!once && !apart, l->expected, enough * wanted);
  if (l->kept || l->same_motion) return;
  l->expected = estimate_mean_error(l);
  bool zero = !l->now->s.measured_count && l->now->s.velocity_zero && l->before->s.velocity_zero;
  if (zero) l->expected = 0.0;
  l->kept = strut_accuracy_is_kept(true, l->expected, ENOUGH_OF_MEANS * wanted);
}

static bool may_refine(const ladder *l) {
  if (l->kept || l->budget_spent || l->runs >= MOST_RUNS) return false;
  if (runs_with_error_control(l) < 1 || l->a->single_method) return true;
  return l->now->e.tolerance > LEAST_TOLERANCE;
}

static strut_status create_ladder(strut_accuracy *a, ladder *l) {
  bool meets = true;
  strut_status status = STRUT_OK;
  l->model = a->model;
  l->unit = find_grid_unit(a, &meets);
  l->moment = l->unit / MOMENTS_OF_PERIOD;
  double signals = strut_accuracy_signal_time(a->scene);
  if (l->moment > SIGNAL_FRACTION * signals)
    l->moment = divide_evenly(l->moment, SIGNAL_FRACTION * signals);
  if (!meets) l->moment = divide_evenly(l->moment, fmin(l->unit / 40.0, 5.0 * a->coarse.step));
  double capacity = MOST_TRACK_NUMBERS / (2.0 * l->model->node_count);
  size_t moments = capacity < 2.0 ? 2 : capacity < MOST_MOMENTS ? (size_t)capacity : MOST_MOMENTS;
  /* Two steps of one method may lead to the same wrong motion: they must agree from the start on. */
  double duration = strut_experiment_span(&a->experiment, a->scene).duration;
  l->coarse_runs = duration <= (double)(moments - 1) * l->moment ? 2 : 1;
  for (int k = 0; k < 3 && !status; k++)
    status = strut_track_create(l->model, moments, &l->arena, &l->rung[k].track);
  size_t quantities = a->experiment.quantity_count;
  double **const arrays[] = {&l->difference, &l->shifted, &l->results};
  for (size_t k = 0; k < sizeof arrays / sizeof arrays[0] && !status; k++)
    if (!(*arrays[k] =
              strut_arena_allocate(&l->arena, MOST_RUNS * (quantities + 1), sizeof(double))))
      status = STRUT_NO_MEMORY;
  return status ? strut_fail(a->error, status, "out of memory") : STRUT_OK;
}

/* ---- sensitivity to the start ---- */

/* Shift of the start, over the size of the structure: no model is known to so many digits. */
static const double SHIFT = 1e-12;
/*
 * Only two runs with tolerances below this are checked: coarser ones differ from each other by more than the
 * shift, so that their difference contains its effect.
 */
static const double CHECKED_BELOW = 1e-8;

/* The start with every free coordinate shifted, up or down. */
static strut_status shift_start(ladder *l, strut_snapshot *start) {
  const strut_model *model = l->model;
  size_t bytes = (size_t)model->length * sizeof(double);
  strut_state *state = NULL;
  start->q = strut_arena_allocate(&l->arena, (size_t)model->length, sizeof(double));
  start->v = strut_arena_allocate(&l->arena, (size_t)model->length, sizeof(double));
  if (!start->q || !start->v) return strut_no_memory(l->a->error, "");
  strut_status status = strut_state_create(model, &state, l->a->error);
  if (status) return status;
  memcpy(start->q, state->q, bytes);
  memcpy(start->v, state->v, bytes);
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    if (!model->fixed[i]) start->q[i] += (i % 3 ? -SHIFT : SHIFT) * model->size;
  strut_state_free(state);
  return STRUT_OK;
}

/*
 * Repeats the run before the latest from the shifted start. The answer is not accepted where that changes it
 * by more than the wanted error.
 */
static strut_status check_sensitivity(ladder *l) {
  strut_accuracy *a = l->a;
  strut_run_options quiet = *a->options;
  strut_snapshot start = {.q = NULL};
  strut_summary shifted = {0};
  const rung *r = l->budget_spent ? l->now : l->before; /* the one before was not finished */
  if (!l->same_motion || a->single_method || runs_with_error_control(l) < 2) return STRUT_OK;
  if (!(r->e.tolerance < CHECKED_BELOW)) return STRUT_OK;
  strut_status status = shift_start(l, &start);
  if (status) return status;
  quiet.sink_count = 0, quiet.to = NULL, quiet.from = &start;
  strut_accuracy_begin_phase(a, "checking with a shifted start");
  a->allowed = INT64_MAX; /* the same run was within the budget before */
  status = strut_accuracy_run(a, &r->e, &quiet, &shifted);
  a->check_evaluations += shifted.spent.evaluations;
  size_t worst = l->worst;
  l->sensitivity = status ? HUGE_VAL : compare_results(l, &r->s, &shifted, l->shifted);
  l->worst = worst;
  l->kept = l->kept && l->sensitivity <= a->target;
  strut_summary_free(&shifted);
  return status == STRUT_DIVERGED ? STRUT_OK : status;
}

/* Writes such as "a velocity that differs by 2 m/s". */
static void describe_difference(const ladder *l, char *text, size_t size) {
  const strut_summary *s = l->a->summary;
  if (s->measured_count)
    snprintf(text, size, "'%.60s', which differs by %.2g %s", s->measured[l->worst].name,
             l->difference[l->worst], s->measured[l->worst].unit);
  else if (s->velocity_zero)
    snprintf(text, size, "a velocity that is zero up to rounding, as by symmetry");
  else
    snprintf(text, size, "a velocity that differs by %.2g m/s",
             l->change * velocity_size(l, s->velocity));
}

/* Explains the answer and, where the accuracy was not reached, the reason and remedy. */
static void explain_ladder(const ladder *l, char *why, size_t size) {
  const strut_accuracy *a = l->a;
  const strut_experiment *e = &l->now->e;
  char how[80], apart[120];
  describe_difference(l, apart, sizeof apart);
  if (strut_integrator_find(e->integrator)->role == STRUT_ROLE_REFERENCE)
    snprintf(how, sizeof how, "adaptive with a tolerance of %.1g and steps up to %.2g s",
             e->tolerance, e->step);
  else
    snprintf(how, sizeof how, "%s with a step of %.3g s", e->integrator, e->step);
  if (l->runs == 1)
    snprintf(why, size,
             "%s, unchecked: the budget of %.2g force evaluations was used up before a second run "
             "finished; give a larger budget",
             how, (double)a->budget);
  else if (l->kept && !l->same_motion && l->means >= LEAST_MEANS)
    snprintf(why, size, "%s: a coarser run gives a different motion, but %s, as in all %d runs",
             how, apart, l->means);
  else if (l->kept && !l->same_motion)
    snprintf(why, size, "%s: a coarser run gives a different motion, but also %s", how, apart);
  else if (l->sensitivity > a->target)
    snprintf(
        why, size,
        "%s; a start shifted by %.0e m changes the answer by %.2g of itself: the motion is too "
        "sensitive",
        how, SHIFT * l->model->size, l->sensitivity);
  else if (l->kept)
    snprintf(why, size, "%s: %s gives the same motion, and %s", how,
             runs_with_error_control(l) == 1 && !a->single_method
                 ? strut_integrator_for(STRUT_ROLE_COARSE)->name
                 : "a coarser run",
             apart);
  else if (l->same_motion)
    snprintf(why, size, "%s; a coarser run gives the same motion, but %s%s", how, apart,
             l->budget_spent ? "; the budget is used up: give a larger budget" : "");
  else
    snprintf(why, size,
             "%s; a coarser run gives a different motion, and %s: nearby motions separate, so the "
             "motion may be chaotic%s",
             how, apart, l->budget_spent ? "; a larger budget may help" : "");
}

static double choose_margin(const ladder *l) {
  return runs_with_error_control(l) == 2 && !l->a->single_method ? MARGIN_OF_FIRST_PAIR : MARGIN;
}

/* Runs whose range counts where they are the same motion: earlier ones were further from it. */
enum { LATEST = 3 };

/*
 * How far runs are from the latest, in quantity i or, behind them, in the velocity. The first run is coarser
 * by far.
 */
static double range_about_latest(const ladder *l, size_t i) {
  size_t width = l->a->experiment.quantity_count + 1;
  double latest = l->results[(size_t)(l->runs - 1) * width + i], most = 0.0;
  for (int k = l->same_motion && l->runs > LATEST ? l->runs - LATEST : 1; k < l->runs; k++)
    most = fmax(most, fabs(l->results[(size_t)k * width + i] - latest));
  return MARGIN * most;
}

/* Fills the expected error of each quantity and whether it is within the wanted one. */
static void report_quantities(const ladder *l) {
  strut_summary *s = l->a->summary;
  double factor = l->change > 0.0 && isfinite(l->expected) ? l->expected / l->change : 1.0;
  for (size_t i = 0; i < s->measured_count; i++) {
    strut_measured *m = &s->measured[i];
    m->expected = (double)NAN;
    if (l->runs > 1)
      m->expected = fmax(choose_margin(l) * factor * l->difference[i], l->shifted[i]);
    m->kept =
        l->kept || strut_accuracy_is_kept(l->same_motion, m->expected, tolerated_error(l, m, i));
    if (!m->kept && l->runs > 1) m->expected = fmax(m->expected, range_about_latest(l, i));
  }
}

/* The relative error where the runs do not converge: nothing is known of the answer but their range. */
static double range_of_runs(const ladder *l) {
  const strut_summary *s = l->a->summary;
  if (l->runs < 2) return (double)NAN;
  double worst = 0.0, change = isfinite(l->change) ? MARGIN * l->change : 0.0;
  if (!s->measured_count)
    return fmax(change, range_about_latest(l, 0) / velocity_size(l, s->velocity));
  for (size_t i = 0; i < s->measured_count; i++) {
    const strut_measured *m = &s->measured[i];
    worst = fmax(worst, range_about_latest(l, i) / tolerated_error(l, m, i));
  }
  return fmax(change, l->a->target * worst);
}

static void report_ladder(ladder *l) {
  strut_accuracy *a = l->a;
  strut_summary *s = a->summary;
  double expected = l->same_motion ? choose_margin(l) * l->expected : l->expected;
  if (!isfinite(expected)) expected = range_of_runs(l);
  if (isfinite(expected)) expected = fmax(expected, l->sensitivity);
  if (!isfinite(expected)) expected = (double)NAN; /* a single run */
  s->accuracy = (strut_accuracy_summary){.wanted = a->target,
                                         .expected = expected,
                                         .scale = a->scale,
                                         .kept = l->kept,
                                         .check_evaluations = a->check_evaluations};
  explain_ladder(l, s->accuracy.why, sizeof s->accuracy.why);
  report_quantities(l);
}

/* Delivers the latest run; repeats it where it is recorded. */
static strut_status deliver_answer(ladder *l) {
  strut_accuracy *a = l->a;
  a->check_evaluations -= l->now->cost;
  if (!a->options->sink_count && !a->options->to && l->now->s.status == STRUT_OK) {
    *a->summary = l->now->s;
    l->now->s = (strut_summary){0};
    return STRUT_OK;
  }
  strut_experiment e = l->now->e; /* the same run again, whose cost is counted once */
  strut_accuracy_begin_phase(a, "recording the answer");
  a->allowed = INT64_MAX; /* the same run was within the budget before */
  e.output_every = a->experiment.output_every;
  e.output_last = a->experiment.output_last;
  return strut_accuracy_run(a, &e, a->options, a->summary);
}

strut_status strut_accuracy_climb_ladder(strut_accuracy *a) {
  ladder l = {.a = a,
              .change = HUGE_VAL,
              .earlier_change = HUGE_VAL,
              .earliest_change = HUGE_VAL,
              .distance = HUGE_VAL,
              .expected = HUGE_VAL};
  strut_status status = create_ladder(a, &l);
  while (!status && may_refine(&l)) {
    status = run_next_rung(&l);
    if (!status && !l.budget_spent && l.runs > 1) judge_agreement(&l);
  }
  /* runs that met a limit may still agree well enough */
  bool fine = a->single_method ? l.runs > 2 : runs_with_error_control(&l) > 1;
  if (!l.kept)
    l.kept =
        strut_accuracy_is_kept(l.same_motion && fine, choose_margin(&l) * l.expected, a->target);
  if (!status) status = check_sensitivity(&l);
  if (!status) status = deliver_answer(&l);
  if (!status) report_ladder(&l);
  for (int k = 0; k < 3; k++) strut_summary_free(&l.rung[k].s);
  strut_arena_free(&l.arena);
  return status;
}
