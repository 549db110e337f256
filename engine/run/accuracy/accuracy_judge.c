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

/* Tracks closer than this, relative to the range of motion, are the same motion. */
static const double SAME_MOTION = 0.03;
/*
 * The same for two runs only: over the accuracy wanted, and, where the first is coarse, at most. A mean velocity that
 * is small beside the nodes' may agree by chance where their motions do not.
 */
static const double SAME_MOTION_OF_TWO = 0.5, MOST_APART_OF_COARSE = 0.005;
/* The same for coarse runs that converge, each with half the step of the one before. */
static const double MOST_APART_OF_CONVERGING = 0.01, CONVERGING_STEPS = 0.5;
/* Part that half the step leaves of what two runs of the coarse method, of order 2, differ by. */
static const double LEFT_BY_HALF_STEP = 0.25;
/* Runs by the coarse method; and what those after the second may cost, over the first: as a run with error control. */
enum { MOST_COARSE_RUNS = 4 };
static const double WORTH = 5.0;
/*
 * Expected error that is accepted, as part of the wanted one: of two runs by one method or by two, which show no
 * convergence; of two whose motions are further apart than that; and of later runs. Where the first two with error
 * control both took the longest step, so that their tolerances changed nothing, an error of order 1 in it is three
 * times their difference.
 */
static const double ENOUGH_OF_TWO = 0.2, ENOUGH_OF_TWO_APART = 0.05, ENOUGH = 0.3;
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
 * Expected error over the distance of coarse motions, of which the latest is a third away from the limit. Velocities
 * may agree by chance.
 */
static const double OF_DISTANCE = 0.5;

/* The same for coarse runs; of three, what the first two led to expect, if that is more. */
static double estimate_coarse_error(const strut_ladder *l) {
  double error = fmax(l->change, OF_DISTANCE * l->distance);
  if (l->runs < 3) return error;
  double earlier = fmax(l->earlier_change, OF_DISTANCE * l->earlier_distance);
  return fmax(error, LEFT_BY_HALF_STEP * earlier);
}

/*
 * Estimates the relative error of the latest run where it and the one before are the same motion:
 * the rest of a geometric series where a third run shows the rate, otherwise their difference.
 */
static double estimate_motion_error(const strut_ladder *l) {
  if (!(l->distance <= SAME_MOTION)) return HUGE_VAL;
  bool series = strut_ladder_runs_with_error_control(l) > 2 || (l->a->single_method && l->runs > 2);
  if (strut_ladder_is_coarse(l, 2)) return estimate_coarse_error(l);
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
static double estimate_mean_error(const strut_ladder *l) {
  double mean = 0.0, square = 0.0;
  int first = l->means > LEAST_MEANS + 1 ? l->means - LEAST_MEANS - 1 : 0, n = l->means - first;
  if (n < LEAST_MEANS || l->a->single_method || l->now->s.measured_count) return HUGE_VAL;
  for (int k = first; k < l->means; k++) mean += l->mean[k] / n;
  for (int k = first; k < l->means; k++) square += (l->mean[k] - mean) * (l->mean[k] - mean);
  return DEVIATIONS * sqrt(square / (n - 1)) / strut_ladder_velocity_size(l, mean);
}

static bool coarse_runs_converge(const strut_ladder *l) {
  return strut_ladder_is_coarse(l, 3) && l->distance <= CONVERGING_STEPS * l->earlier_distance &&
         l->change <= CONVERGING_STEPS * l->earlier_change;
}

/* Largest distance of the motions of two runs of which the first is coarse. */
static double allowed_distance(const strut_ladder *l, bool converging) {
  double most = converging ? MOST_APART_OF_CONVERGING : MOST_APART_OF_COARSE;
  return fmin(SAME_MOTION_OF_TWO * l->a->target, most);
}

void strut_ladder_extend_coarse(strut_ladder *l) {
  if (l->kept || l->runs != l->coarse_runs || !strut_ladder_is_coarse(l, 2)) return;
  if (l->runs > 2 && !coarse_runs_converge(l)) return;
  double apart =
      fmax(l->distance / allowed_distance(l, true), l->change / (ENOUGH_OF_TWO * l->a->target));
  double cost = (double)l->now->cost, of_steps = cost - (double)l->before->cost, spent = 0.0;
  int runs = l->runs;
  do {
    if (runs++ == MOST_COARSE_RUNS) return;
    apart *= LEFT_BY_HALF_STEP;
    of_steps *= 2.0, cost += of_steps, spent += cost;
  } while (apart > 1.0);
  if (spent <= WORTH * (double)l->rung[0].cost) l->coarse_runs++;
}

/* Did no contact or law switch too often, and does the energy balance close? */
static bool is_followed(const strut_ladder *l, const strut_summary *s) {
  return !s->spent.forced && !strut_accuracy_balance_is_open(l->a, s);
}

void strut_ladder_judge(strut_ladder *l) {
  int further = strut_ladder_runs_with_error_control(l);
  double wanted = l->a->target, enough = further < 3 ? ENOUGH_OF_TWO : ENOUGH;
  if (further == 2 && l->distance > SAME_MOTION_OF_TWO * wanted) enough = ENOUGH_OF_TWO_APART;
  if (l->a->single_method) enough = ENOUGH_ALONE;
  l->expected = estimate_motion_error(l);
  l->same_motion = l->distance <= SAME_MOTION;
  /* steps of one method must agree twice: a single agreement may be chance */
  bool once = l->a->single_method && l->runs < 3;
  bool converging = coarse_runs_converge(l),
       diverging = strut_ladder_is_coarse(l, 3) && !converging;
  bool apart = further < 2 && (diverging || l->distance > allowed_distance(l, converging));
  bool followed = is_followed(l, &l->now->s);
  l->kept = strut_accuracy_is_kept(!once && !apart && followed, l->expected, enough * wanted);
  if (l->kept || l->same_motion || !followed) return;
  l->expected = estimate_mean_error(l);
  bool zero = !l->now->s.measured_count && l->now->s.velocity_zero && l->before->s.velocity_zero;
  if (zero) l->expected = 0.0;
  l->kept = strut_accuracy_is_kept(true, l->expected, ENOUGH_OF_MEANS * wanted);
}

static double choose_margin(const strut_ladder *l) {
  return strut_ladder_runs_with_error_control(l) == 2 && !l->a->single_method ? MARGIN_OF_FIRST_PAIR
                                                                              : MARGIN;
}

void strut_ladder_judge_last(strut_ladder *l) {
  bool fine = l->a->single_method ? l->runs > 2 : strut_ladder_runs_with_error_control(l) > 1;
  if (!is_followed(l, &l->now->s) || l->failed) fine = false;
  if (!l->kept)
    l->kept = strut_accuracy_is_kept(l->same_motion && fine, choose_margin(l) * l->expected,
                                     l->a->target);
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

/* Runs whose range counts where they are the same motion: earlier ones were further from it. */
enum { LATEST = 3 };

/*
 * How far runs are from the latest, in quantity i or, behind them, in the velocity. The first run is coarser
 * by far.
 */
static double range_about_latest(const strut_ladder *l, size_t i) {
  size_t width = l->a->experiment.quantity_count + 1;
  double latest = l->results[(size_t)(l->runs - 1) * width + i], most = 0.0;
  for (int k = l->same_motion && l->runs > LATEST ? l->runs - LATEST : 1; k < l->runs; k++)
    most = fmax(most, fabs(l->results[(size_t)k * width + i] - latest));
  return MARGIN * most;
}

/* Fills the expected error of each quantity and whether it is within the wanted one. */
static void report_quantities(const strut_ladder *l) {
  strut_summary *s = l->a->summary;
  double factor = l->change > 0.0 && isfinite(l->expected) ? l->expected / l->change : 1.0;
  for (size_t i = 0; i < s->measured_count; i++) {
    strut_measured *m = &s->measured[i];
    m->expected = (double)NAN;
    if (l->runs > 1)
      m->expected = fmax(choose_margin(l) * factor * l->difference[i], l->shifted[i]);
    m->kept = l->kept || strut_accuracy_is_kept(l->same_motion && is_followed(l, s), m->expected,
                                                strut_ladder_tolerated_error(l, m, i));
    if (!m->kept && l->runs > 1) m->expected = fmax(m->expected, range_about_latest(l, i));
    bool decided = l->runs > 1 && isfinite(l->difference[i] + l->shifted[i]);
    bool unsettled = !l->kept && l->worst == i && isnan(m->value);
    m->undecided = m->arrival && (!decided || unsettled);
    if (m->undecided) m->kept = false;
    if (m->undecided || (m->arrival && isnan(m->value))) m->expected = (double)NAN;
  }
}

/* The relative error where the runs do not converge: nothing is known of the answer but their range. */
static double range_of_runs(const strut_ladder *l) {
  const strut_summary *s = l->a->summary;
  if (l->runs < 2) return (double)NAN;
  double worst = 0.0, change = isfinite(l->change) ? MARGIN * l->change : 0.0;
  if (!s->measured_count)
    return fmax(change, range_about_latest(l, 0) / strut_ladder_velocity_size(l, s->velocity));
  for (size_t i = 0; i < s->measured_count; i++) {
    const strut_measured *m = &s->measured[i];
    worst = fmax(worst, range_about_latest(l, i) / strut_ladder_tolerated_error(l, m, i));
  }
  return fmax(change, l->a->target * worst);
}

void strut_ladder_report(strut_ladder *l) {
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
  report_quantities(l);
  if (find_undecided(l)) s->accuracy.expected = (double)NAN, s->accuracy.kept = false;
  explain_ladder(l, s->accuracy.why, sizeof s->accuracy.why);
}
