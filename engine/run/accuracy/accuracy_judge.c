/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How accurate the latest of several runs is: two must agree, not only in the velocity, which may agree by chance, but
 * as motions. And what is said of it.
 */
#include <stdio.h>

#include "engine/integrate/integrator.h"
#include "engine/run/accuracy/ladder_parts.h"

double strut_ladder_tolerated_error(const strut_ladder *l, const strut_measured *m, size_t i) {
  double allowed = strut_quantity_allowed_error(&l->a->experiment.quantities[i], l->a->target,
                                                m->value, m->scale);
  return m->arrival ? allowed : fmax(allowed, m->rounding);
}

double strut_ladder_arrival_doubt(const strut_measured *one, const strut_measured *other) {
  double apart = fabs(one->margin - other->margin) + one->rounding;
  if (one->margin == HUGE_VAL && other->margin == HUGE_VAL) return 0.0;
  if (isnan(one->value) != isnan(other->value) || !(one->margin > 0.0)) return HUGE_VAL;
  return 1.5 * apart / one->margin;
}

/*
 * The table of evidence: what the latest runs must be, and how near to each other, to say how accurate the latest one
 * is. Motions are apart by strut_track_distance; results differ by l->change. For each number of runs there is one row
 * at most; its scene, of tests/cli/accuracy_test.sh, is wrong or costs far more without it.
 */
typedef struct strut_evidence {
  enum { COARSE, CONTROLLED, ALONE } method; /* the latter: the only one that suits the scene */
  int least, most;        /* runs of it; those by the coarse method are the first */
  double apart_of_wanted; /* distance of the two latest motions at most, over the wanted error */
  double apart;           /* and over the range of motion */
  double shrinks;         /* a difference over the one before at most; 0: whatever it was */
  double leaves;          /* what is left of the difference before, by the order of the method */
  double enough;          /* estimate over the wanted error at most */
  double margin;          /* reported error over the estimate */
} strut_evidence;

/* Tracks closer than this, relative to the range of motion, are the same motion. */
static const double SAME_MOTION = 0.03;
enum { HALVED_AGAIN = 1, ANY = STRUT_LADDER_RUNS };
static const strut_evidence EVIDENCE[] = {
    /* half the step, over all of a short run: small velocities may agree by chance (chance) */
    {COARSE, 2, 2, 0.4, 0.005, 0.0, 0.0, 0.2, 2.0},
    /* half of it again, where that converges (grid) */
    {COARSE, 3, ANY, 0.4, 0.01, 0.5, 0.25, 0.2, 2.0},
    /* another method, another grid: both may be of another branch than the motion's (branch) */
    {CONTROLLED, 1, 1, 0.5, 0.005, 0.0, 0.0, 0.2, 2.0},
    /* a thirtieth of the tolerance: differs by a third of an error of order 1 in the longest step (pair) */
    {CONTROLLED, 2, 2, 0.5, SAME_MOTION, 0.0, 0.0, 0.2, 4.0},
    /* again: differences that grew, or hardly shrank, may be small by chance (growing, stalled) */
    {CONTROLLED, 3, ANY, HUGE_VAL, SAME_MOTION, 0.7, 0.0, 0.3, 2.0},
    /* half the step, twice, with nothing else to compare with (rod) */
    {ALONE, 3, ANY, HUGE_VAL, SAME_MOTION, 0.7, 0.0, 0.05, 2.0},
};

/* Differences below this are rounding, and show no convergence. */
static const double NOISE = 1e-9;
/* What is reported is no less than this part of the distance of the motions: results may agree by chance. */
static const double OF_DISTANCE = 0.5;
/* Nor, over what is allowed of it, than this part of what is reported of the quantity that is known worst. */
static const double OF_WORST = 0.1;
/* Runs by the coarse method; and what those after the second may cost, over the first: as a run with error control. */
enum { MOST_COARSE_RUNS = 4 };
static const double WORTH = 5.0;
/* Different motions: so many runs with error control, whose results must agree to this part of the wanted error. */
enum { LEAST_MEANS = 5 };
static const double ENOUGH_OF_MEANS = 0.1;

/* The row for the runs that there are; NULL: they say nothing. */
static const strut_evidence *find_evidence(const strut_ladder *l) {
  int fine = strut_ladder_runs_with_error_control(l);
  int method = l->a->single_method ? ALONE : fine > 0 ? CONTROLLED : COARSE;
  int runs = method == COARSE ? l->runs : fine;
  for (size_t k = 0; k < sizeof EVIDENCE / sizeof EVIDENCE[0]; k++) {
    const strut_evidence *e = &EVIDENCE[k];
    if ((int)e->method == method && runs >= e->least && runs <= e->most) return e;
  }
  return NULL;
}

static bool shrinks(const strut_ladder *l, const strut_evidence *e) {
  double part = e->shrinks;
  if (part == 0.0) return true;
  if (e->leaves > 0.0 && !(l->distance <= part * l->earlier_distance)) return false;
  if (l->change <= NOISE) return true;
  /* after differences that did not shrink, one that is small may be chance */
  bool stalled =
      l->earlier_change > part * l->earliest_change && l->earlier_change > e->enough * l->a->target;
  return l->change < part * l->earlier_change && !stalled;
}

/* Relative error of the latest run: the rest of a geometric series where the rate is known, else the difference. */
static double estimate_error(const strut_ladder *l, const strut_evidence *e) {
  if (!(l->distance <= e->apart) || !shrinks(l, e)) return HUGE_VAL;
  double ratio = e->shrinks > 0.0 ? fmin(l->change / l->earlier_change, e->shrinks) : 0.5;
  double rest = l->change > NOISE ? l->change * fmax(1.0, ratio / (1.0 - ratio)) : l->change;
  if (e->leaves == 0.0) return rest;
  return fmax(rest, e->leaves * fmax(l->earlier_change, OF_DISTANCE * l->earlier_distance));
}

/* Did no contact or law switch too often, and does the energy balance close? */
static bool is_followed(const strut_ladder *l, const strut_summary *s) {
  return !s->spent.forced && !strut_accuracy_balance_is_open(l->a, s);
}

void strut_ladder_extend_coarse(strut_ladder *l) {
  const strut_evidence *e = &EVIDENCE[HALVED_AGAIN];
  if (l->kept || l->runs != l->coarse_runs || !strut_ladder_is_coarse(l, 2)) return;
  if (l->runs > 2 && !shrinks(l, e)) return;
  double wanted = l->a->target;
  double apart = fmax(l->distance / fmin(e->apart_of_wanted * wanted, e->apart),
                      l->change / (e->enough * wanted));
  double cost = (double)l->now->cost, of_steps = cost - (double)l->before->cost, spent = 0.0;
  int runs = l->runs;
  do {
    if (runs++ == MOST_COARSE_RUNS) return;
    apart *= e->leaves;
    of_steps *= 2.0, cost += of_steps, spent += cost;
  } while (apart > 1.0);
  if (spent <= WORTH * (double)l->rung[0].cost) l->coarse_runs++;
}

/* Runs whose range counts where they are the same motion: earlier ones were further from it. */
enum { LATEST = 3 };
static const double RANGE_MARGIN = 2.0;

/*
 * How far runs are from the latest, in quantity i or, behind them, in the velocity. The first run is coarser
 * by far.
 */
static double range_about_latest(const strut_ladder *l, size_t i) {
  size_t width = l->a->experiment.quantity_count + 1;
  double latest = l->results[(size_t)(l->runs - 1) * width + i], most = 0.0;
  for (int k = l->same_motion && l->runs > LATEST ? l->runs - LATEST : 1; k < l->runs; k++)
    most = fmax(most, fabs(l->results[(size_t)k * width + i] - latest));
  return RANGE_MARGIN * most;
}

/* The relative error where the runs do not converge: nothing is known of the answer but their range. */
static double range_of_runs(const strut_ladder *l, const strut_summary *s) {
  if (l->runs < 2) return (double)NAN;
  double worst = 0.0, change = isfinite(l->change) ? RANGE_MARGIN * l->change : 0.0;
  if (!s->measured_count)
    return fmax(change, range_about_latest(l, 0) / strut_ladder_velocity_size(l, s->velocity));
  for (size_t i = 0; i < s->measured_count; i++) {
    const strut_measured *m = &s->measured[i];
    worst = fmax(worst, range_about_latest(l, i) / strut_ladder_tolerated_error(l, m, i));
  }
  return fmax(change, l->a->target * worst);
}

/* The error where all runs are different motions; HUGE_VAL: they are too few. */
static double estimate_mean_error(const strut_ladder *l) {
  const strut_summary *s = &l->now->s;
  bool zero = s->velocity_zero && l->before->s.velocity_zero;
  bool few = strut_ladder_runs_with_error_control(l) < LEAST_MEANS || l->a->single_method;
  for (size_t i = 0; i < s->measured_count; i++) few = few || s->measured[i].arrival;
  if (!s->measured_count && zero) return 0.0;
  return few ? HUGE_VAL : range_of_runs(l, s);
}

void strut_ladder_judge(strut_ladder *l) {
  const strut_evidence *e = find_evidence(l);
  double wanted = l->a->target;
  bool followed = is_followed(l, &l->now->s);
  l->same_motion = l->distance <= SAME_MOTION;
  l->expected = e ? estimate_error(l, e) : HUGE_VAL;
  l->margin = e ? e->margin : 1.0;
  bool near = e && l->distance <= e->apart_of_wanted * wanted;
  l->kept = e && strut_accuracy_is_kept(near && followed, l->expected, e->enough * wanted);
  if (l->kept || l->same_motion || !followed) return;
  l->expected = estimate_mean_error(l);
  l->kept = strut_accuracy_is_kept(true, l->expected, ENOUGH_OF_MEANS * wanted);
}

void strut_ladder_judge_last(strut_ladder *l) {
  bool fine = strut_ladder_runs_with_error_control(l) > 1 && !l->failed;
  if (l->runs < 2 || !l->same_motion || !is_followed(l, &l->now->s)) return;
  l->kept = strut_accuracy_is_kept(fine, l->margin * l->expected, l->a->target);
}

/* ---- what is said ---- */

/* Writes such as "a velocity that differs by 2 m/s". */
static void describe_difference(const strut_ladder *l, char *text, size_t size) {
  const strut_summary *s = l->a->summary;
  if (s->measured_count)
    snprintf(text, size, "'%.60s', which differs by %.2g %s", s->measured[l->worst].name,
             l->difference[l->worst], s->measured[l->worst].unit);
  else if (s->velocity_zero)
    snprintf(text, size, "a velocity that is zero up to rounding, as by symmetry");
  else
    snprintf(text, size, "a velocity that differs by %.2g m/s",
             l->change * strut_ladder_velocity_size(l, s->velocity));
}

/* The first arrival that is not decided; NULL: all are. */
static const strut_measured *find_undecided(const strut_ladder *l) {
  const strut_summary *s = l->a->summary;
  for (size_t i = 0; i < s->measured_count; i++)
    if (s->measured[i].undecided) return &s->measured[i];
  return NULL;
}

/* Explains the answer and, where the accuracy was not reached, the reason and remedy. */
static void explain_ladder(const strut_ladder *l, char *why, size_t size) {
  const strut_accuracy *a = l->a;
  const strut_experiment *e = &l->now->e;
  const strut_measured *undecided = find_undecided(l);
  char how[80], apart[120];
  describe_difference(l, apart, sizeof apart);
  if (strut_integrator_controls_error(strut_integrator_find(e->integrator)))
    snprintf(how, sizeof how, "%s with a tolerance of %.1g and steps up to %.2g s", e->integrator,
             e->tolerance, e->step);
  else
    snprintf(how, sizeof how, "%s with a step of %.3g s", e->integrator, e->step);
  if (l->runs == 1)
    snprintf(why, size,
             "%s, unchecked: the budget of %.2g force evaluations was used up before a second run "
             "finished; give a larger budget",
             how, (double)a->budget);
  else if (l->failed)
    snprintf(why, size,
             "%s; a run with a smaller tolerance failed, so nothing is known of the error", how);
  else if (a->summary->spent.forced)
    snprintf(why, size,
             "%s: contacts or laws switch too often to be followed in %lld steps; choose a method "
             "and a smaller solver.step",
             how, (long long)a->summary->spent.forced);
  else if (undecided)
    snprintf(why, size,
             "%s: whether '%.60s' reaches its target, or when, is not decided: an extreme comes "
             "within %.2g %s of it, "
             "and its error may be as large",
             how, undecided->name, undecided->margin,
             a->experiment.quantities[undecided - a->summary->measured].target_unit);
  else if (l->kept && !l->same_motion)
    snprintf(why, size, "%s: a coarser run gives a different motion, but also %s", how, apart);
  else if (l->sensitivity > a->target)
    snprintf(
        why, size,
        "%s; a start shifted by %.0e m changes the answer by %.2g of itself: the motion is too "
        "sensitive",
        how, l->shift * l->model->size, l->sensitivity);
  else if (l->kept)
    snprintf(why, size, "%s: %s gives the same motion, and %s", how,
             strut_ladder_runs_with_error_control(l) == 1 && !a->single_method
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

/* Fills the expected error of each quantity and whether it is within the wanted one. */
static void report_quantities(const strut_ladder *l) {
  strut_summary *s = l->a->summary;
  bool known = isfinite(l->expected);
  double factor = l->change > 0.0 && known ? l->expected / l->change : 1.0;
  double worst = known ? OF_WORST * l->expected / l->a->target : 0.0;
  double apart = l->same_motion ? OF_DISTANCE * l->distance : 0.0;
  for (size_t i = 0; i < s->measured_count; i++) {
    strut_measured *m = &s->measured[i];
    m->expected = (double)NAN;
    double allowed = strut_ladder_tolerated_error(l, m, i), error = factor * l->difference[i];
    if (!m->zero && error < HUGE_VAL)
      error = fmax(error, fmax(apart * fabs(m->value), worst * allowed));
    if (l->runs > 1) m->expected = fmax(l->margin * error, l->shifted[i]);
    m->kept = l->kept ||
              strut_accuracy_is_kept(l->same_motion && is_followed(l, s), m->expected, allowed);
    if (l->kept) m->expected = fmin(m->expected, allowed);
    if (!m->kept && l->runs > 1) m->expected = fmax(m->expected, range_about_latest(l, i));
    bool decided = l->runs > 1 && isfinite(l->difference[i] + l->shifted[i]);
    bool unsettled = !l->kept && l->worst == i && isnan(m->value);
    m->undecided = m->arrival && (!decided || unsettled);
    if (m->undecided) m->kept = false;
    if (m->undecided || (m->arrival && isnan(m->value))) m->expected = (double)NAN;
  }
}

void strut_ladder_report(strut_ladder *l) {
  strut_accuracy *a = l->a;
  strut_summary *s = a->summary;
  double expected = l->expected;
  if (l->same_motion)
    expected = l->margin * fmax(expected, s->velocity_zero ? 0.0 : OF_DISTANCE * l->distance);
  if (l->kept) expected = fmin(expected, a->target);
  if (!isfinite(expected)) expected = range_of_runs(l, s);
  if (isfinite(expected)) expected = fmax(expected, l->sensitivity);
  if (!isfinite(expected)) expected = (double)NAN; /* a single run */
  s->accuracy = (strut_accuracy_summary){.wanted = a->target,
                                         .expected = expected,
                                         .scale = a->scale,
                                         .kept = l->kept,
                                         .check_evaluations = a->check_evaluations};
  report_quantities(l);
  if (find_undecided(l)) s->accuracy.expected = (double)NAN, s->accuracy.kept = false;
  explain_ladder(l, s->accuracy.why, sizeof s->accuracy.why);
}
