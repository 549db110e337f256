/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How accurate the latest of several runs is, and what is said of it: two must agree as motions, not by chance. */
#include <stdio.h>

#include "engine/integrate/integrator.h"
#include "engine/run/accuracy/accuracy.h"

double strut_ladder_tolerated_error(const strut_ladder *ladder, const strut_measured *measured,
                                    size_t i) {
  double allowed = strut_quantity_allowed_error(
      &ladder->a->experiment.quantities[i], ladder->a->target, measured->value, measured->scale);
  return measured->arrival ? allowed : fmax(allowed, measured->rounding);
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
/* Nor, where no convergence shows, than this part of what is wanted: errors may cancel. */
static const double OF_WANTED = 0.2;
/* Nor, where a motion repeats itself, a single run with error control, whose tolerance may add as much in each period. */
static const double OF_FIRST_RUN = 0.5;
/* Runs by the coarse method; and what those after the second may cost, over the first: as a run with error control. */
enum { MOST_COARSE_RUNS = 4 };
static const double WORTH = 5.0;
/* Different motions: so many runs with error control, whose results must agree to this part of the wanted error. */
enum { LEAST_MEANS = 5 };
static const double ENOUGH_OF_MEANS = 0.1;

/* Motions so far apart have nothing in common; after so many in a row a shifted start tells whether finer runs may. */
static const double UNRELATED = 0.3;
enum { MOST_UNRELATED = 3 };
/* Shapes that agree so much better than velocities: what differs is how fast feet creep, which depends on history. */
static const double CREEPS = 0.1;

/* The row for the runs that there are; NULL: they say nothing. */
static const strut_evidence *find_evidence(const strut_ladder *ladder) {
  int fine = strut_ladder_runs_with_error_control(ladder);
  int method = ladder->a->single_method ? ALONE : fine > 0 ? CONTROLLED : COARSE;
  int runs = method == COARSE ? ladder->runs : fine;
  for (size_t k = 0; k < sizeof EVIDENCE / sizeof EVIDENCE[0]; k++) {
    const strut_evidence *evidence = &EVIDENCE[k];
    if ((int)evidence->method == method && runs >= evidence->least && runs <= evidence->most)
      return evidence;
  }
  return NULL;
}

static bool shrinks(const strut_ladder *ladder, const strut_evidence *evidence) {
  double part = evidence->shrinks;
  if (part == 0.0) return true;
  if (evidence->leaves > 0.0 && !(ladder->distance <= part * ladder->earlier_distance))
    return false;
  if (ladder->change <= NOISE) return true;
  /* after differences that did not shrink, one that is small may be chance */
  bool stalled = ladder->earlier_change > part * ladder->earliest_change &&
                 ladder->earlier_change > evidence->enough * ladder->a->target;
  return ladder->change < part * ladder->earlier_change && !stalled;
}

/* Without convergence results may agree by chance, all but those that agree to rounding. */
static double least_by_chance(const strut_ladder *ladder, const strut_evidence *evidence) {
  bool converges = evidence->method != CONTROLLED || evidence->shrinks > 0.0;
  return converges || ladder->change <= NOISE ? 0.0
                                              : OF_WANTED * ladder->a->target / evidence->margin;
}

/* Relative error of the latest run: the rest of a geometric series where the rate is known, else the difference. */
static double estimate_error(const strut_ladder *ladder, const strut_evidence *evidence) {
  if (!(ladder->distance <= evidence->apart) || !shrinks(ladder, evidence)) return HUGE_VAL;
  double ratio = evidence->shrinks > 0.0
                     ? fmin(ladder->change / ladder->earlier_change, evidence->shrinks)
                     : 0.5;
  double rest =
      ladder->change > NOISE ? ladder->change * fmax(1.0, ratio / (1.0 - ratio)) : ladder->change;
  rest = fmax(rest, least_by_chance(ladder, evidence));
  if (evidence->leaves == 0.0) return rest;
  return fmax(rest, evidence->leaves *
                        fmax(ladder->earlier_change, OF_DISTANCE * ladder->earlier_distance));
}

/* Did no contact or law switch too often, and does the energy balance close? */
static bool is_followed(const strut_ladder *ladder, const strut_summary *summary) {
  return !summary->spent.forced && !strut_accuracy_balance_is_open(ladder->a, summary);
}

void strut_ladder_extend_coarse(strut_ladder *ladder) {
  const strut_evidence *evidence = &EVIDENCE[HALVED_AGAIN];
  if (ladder->kept || ladder->runs != ladder->coarse_runs || ladder->runs < 2) return;
  if (ladder->runs > 2 && !shrinks(ladder, evidence)) return;
  double wanted = ladder->a->target;
  double apart = fmax(ladder->distance / fmin(evidence->apart_of_wanted * wanted, evidence->apart),
                      ladder->change / (evidence->enough * wanted));
  double cost = (double)ladder->now->cost, of_steps = cost - (double)ladder->before->cost,
         spent = 0.0;
  int runs = ladder->runs;
  do {
    if (runs++ == MOST_COARSE_RUNS) return;
    apart *= evidence->leaves;
    of_steps *= 2.0, cost += of_steps, spent += cost;
  } while (apart > 1.0);
  if (spent <= WORTH * (double)ladder->rung[0].cost) ladder->coarse_runs++;
}

/* What the rest of the transient adds to quantity i of a run until its motion is steady, SI. */
static double rest_of_transient(const strut_summary *summary, size_t i) {
  const strut_measured *measured = &summary->measured[i];
  const strut_steady_summary *steady = &summary->steady;
  if (!steady->kind || measured->zero || measured->arrival) return 0.0;
  double change =
      steady->kind == STRUT_MOTION_PERIODIC ? steady->residual * measured->scale : (double)NAN;
  return (1.0 + steady->left) * fmin(measured->spread, change);
}

/* The relative error of the velocity, or of the quantity of which it is largest, that this makes. */
static double distance_from_steady(const strut_ladder *ladder) {
  const strut_summary *summary = &ladder->now->s;
  double worst = 0.0;
  if (!summary->measured_count)
    return summary->steady.interval / strut_ladder_velocity_size(ladder, summary->velocity);
  for (size_t i = 0; i < summary->measured_count; i++)
    worst = fmax(worst, rest_of_transient(summary, i) /
                            strut_ladder_tolerated_error(ladder, &summary->measured[i], i));
  return ladder->a->target * worst;
}

/* Runs whose range counts where they are the same motion: earlier ones were further from it. */
enum { LATEST = 3 };
static const double RANGE_MARGIN = 2.0;

/*
 * How far runs are from the latest, in quantity i or, behind them, in the velocity. The first run is coarser
 * by far.
 */
static double range_about_latest(const strut_ladder *ladder, size_t i) {
  size_t width = ladder->a->experiment.quantity_count + 1;
  double latest = ladder->results[(size_t)(ladder->runs - 1) * width + i], most = 0.0;
  for (int k = ladder->same_motion && ladder->runs > LATEST ? ladder->runs - LATEST : 1;
       k < ladder->runs; k++)
    most = fmax(most, fabs(ladder->results[(size_t)k * width + i] - latest));
  return RANGE_MARGIN * most;
}

/* The relative error where the runs do not converge: nothing is known of the answer but their range. */
static double range_of_runs(const strut_ladder *ladder, const strut_summary *summary) {
  if (ladder->runs < 2) return (double)NAN;
  double worst = 0.0, change = isfinite(ladder->change) ? RANGE_MARGIN * ladder->change : 0.0;
  if (!summary->measured_count)
    return fmax(change, range_about_latest(ladder, 0) /
                            strut_ladder_velocity_size(ladder, summary->velocity));
  for (size_t i = 0; i < summary->measured_count; i++) {
    const strut_measured *measured = &summary->measured[i];
    worst = fmax(worst,
                 range_about_latest(ladder, i) / strut_ladder_tolerated_error(ladder, measured, i));
  }
  return fmax(change, ladder->a->target * worst);
}

/* The error where all runs are different motions; HUGE_VAL: they are too few. */
static double estimate_mean_error(const strut_ladder *ladder) {
  const strut_summary *summary = &ladder->now->s;
  bool zero = summary->velocity_zero && ladder->before->s.velocity_zero;
  bool few = strut_ladder_runs_with_error_control(ladder) < LEAST_MEANS || ladder->a->single_method;
  for (size_t i = 0; i < summary->measured_count; i++) few = few || summary->measured[i].arrival;
  if (!summary->measured_count && zero) return 0.0;
  return few ? HUGE_VAL : range_of_runs(ladder, summary);
}

/* Do the latest runs differ by no more than feet may creep, which friction's law makes them do? */
static bool differs_by_creep(const strut_ladder *ladder) {
  const strut_summary *summary = &ladder->now->s;
  const strut_contact_table *contacts = &ladder->model->contacts;
  double band = 0.0;
  for (int32_t i = 0; i < contacts->count; i++)
    band = fmax(band, contacts->entry[i].friction.stick_velocity);
  return !summary->measured_count && strut_ladder_runs_with_error_control(ladder) > 1 &&
         summary->energy.rubbed > 0.0 && ladder->same_motion &&
         ladder->distance <= CREEPS * ladder->change &&
         fabs(summary->velocity - ladder->before->s.velocity) <= band;
}

bool strut_ladder_is_lost(const strut_ladder *ladder) {
  return ladder->unrelated == MOST_UNRELATED && !ladder->kept && !ladder->a->single_method;
}

void strut_ladder_judge(strut_ladder *ladder) {
  const strut_evidence *evidence = find_evidence(ladder);
  double wanted = ladder->a->target;
  bool followed = is_followed(ladder, &ladder->now->s);
  ladder->same_motion = ladder->distance <= SAME_MOTION;
  bool unrelated = strut_ladder_runs_with_error_control(ladder) > 1 &&
                   ladder->distance >= UNRELATED && ladder->change > ENOUGH_OF_MEANS * wanted;
  ladder->unrelated = unrelated ? ladder->unrelated + 1 : 0;
  ladder->expected = evidence ? estimate_error(ladder, evidence) : HUGE_VAL;
  ladder->margin = evidence ? evidence->margin : 1.0;
  ladder->unsteady = distance_from_steady(ladder);
  double allowed = (wanted - ladder->unsteady) / ladder->margin;
  bool near = evidence && ladder->distance <= evidence->apart_of_wanted * wanted;
  ladder->kept = evidence && strut_accuracy_is_kept(near && followed, ladder->expected,
                                                    fmin(evidence->enough * wanted, allowed));
  ladder->creeps = ladder->a->creeps || (!ladder->kept && differs_by_creep(ladder));
  if (ladder->kept || ladder->same_motion || !followed) return;
  ladder->expected = estimate_mean_error(ladder);
  ladder->kept =
      strut_accuracy_is_kept(true, ladder->expected, fmin(ENOUGH_OF_MEANS * wanted, allowed));
}

void strut_ladder_judge_last(strut_ladder *ladder) {
  bool fine = strut_ladder_runs_with_error_control(ladder) > 1 && !ladder->failed;
  if (ladder->runs < 2 || !ladder->same_motion || !is_followed(ladder, &ladder->now->s)) return;
  ladder->kept = strut_accuracy_is_kept(fine, ladder->margin * ladder->expected + ladder->unsteady,
                                        ladder->a->target);
}

/* ---- what is said ---- */

/* Writes such as "a velocity that differs by 2 m/s". */
static void describe_difference(const strut_ladder *ladder, char *text, size_t size) {
  const strut_summary *summary = ladder->a->summary;
  if (summary->measured_count)
    snprintf(text, size, "'%.60s', which differs by %.2g %s", summary->measured[ladder->worst].name,
             ladder->difference[ladder->worst], summary->measured[ladder->worst].unit);
  else if (summary->velocity_zero && !ladder->creeps)
    snprintf(text, size, "a velocity that is zero up to rounding, as by symmetry");
  else
    snprintf(text, size, "a velocity that differs by %.2g m/s",
             ladder->change * strut_ladder_velocity_size(ladder, summary->velocity));
}

/* The first arrival that is not decided; NULL: all are. */
static const strut_measured *find_undecided(const strut_ladder *ladder) {
  const strut_summary *summary = ladder->a->summary;
  for (size_t i = 0; i < summary->measured_count; i++)
    if (summary->measured[i].undecided) return &summary->measured[i];
  return NULL;
}

/* Explains the answer and, where the accuracy was not reached, the reason and remedy. */
static void explain_ladder(const strut_ladder *ladder, char *why, size_t size) {
  const strut_accuracy *accuracy = ladder->a;
  const strut_experiment *experiment = &ladder->now->e;
  const strut_measured *undecided = find_undecided(ladder);
  char how[80], apart[120];
  describe_difference(ladder, apart, sizeof apart);
  if (strut_integrator_controls_error(strut_integrator_find(experiment->integrator)))
    snprintf(how, sizeof how, "%s with a tolerance of %.1g and steps up to %.2g s",
             experiment->integrator, experiment->tolerance, experiment->step);
  else
    snprintf(how, sizeof how, "%s with a step of %.3g s", experiment->integrator, experiment->step);
  if (ladder->runs == 1)
    snprintf(why, size,
             "%s, unchecked: the budget of %.2g force evaluations was used up before a second run "
             "finished; give a larger budget",
             how, (double)accuracy->budget);
  else if (ladder->failed)
    snprintf(why, size,
             "%s; a run with a smaller tolerance failed, so nothing is known of the error", how);
  else if (accuracy->summary->spent.forced)
    snprintf(why, size,
             "%s: contacts or laws switch too often to be followed in %lld steps; choose a method "
             "and a smaller solver.step",
             how, (long long)accuracy->summary->spent.forced);
  else if (undecided)
    snprintf(why, size,
             "%s: whether '%.60s' reaches its target, or when, is not decided: an extreme comes "
             "within %.2g %s of it, "
             "and its error may be as large",
             how, undecided->name, undecided->margin,
             accuracy->experiment.quantities[undecided - accuracy->summary->measured].target_unit);
  else if (ladder->kept && !ladder->same_motion)
    snprintf(why, size, "%s: a coarser run gives a different motion, but also %s", how, apart);
  else if (ladder->sensitivity > accuracy->target)
    snprintf(
        why, size,
        "%s; a start shifted by %.0e m changes the answer by %.2g of itself: the motion is too "
        "sensitive",
        how, ladder->shift * ladder->model->size, ladder->sensitivity);
  else if (ladder->kept)
    snprintf(why, size, "%s: %s gives the same motion, and %s", how,
             strut_ladder_runs_with_error_control(ladder) == 1 && !accuracy->single_method
                 ? strut_integrator_for(STRUT_ROLE_COARSE)->name
                 : "a coarser run",
             apart);
  else if (ladder->creeps)
    snprintf(why, size,
             "%s; a coarser run gives the same shapes, but %s: feet that should stick creep within "
             "their stick bands; use 'law: coulomb', or a far smaller stick_velocity",
             how, apart);
  else if (ladder->same_motion)
    snprintf(why, size, "%s; a coarser run gives the same motion, but %s%s", how, apart,
             ladder->budget_spent ? "; the budget is used up: give a larger budget" : "");
  else
    snprintf(why, size,
             "%s; a coarser run gives a different motion, and %s: nearby motions separate, so the "
             "motion may be chaotic%s",
             how, apart, ladder->budget_spent ? "; a larger budget may help" : "");
}

/* Fills the expected error of each quantity and whether it is within the wanted one. */
static void report_quantities(const strut_ladder *ladder) {
  strut_summary *summary = ladder->a->summary;
  bool known = isfinite(ladder->expected);
  double factor = ladder->change > 0.0 && known ? ladder->expected / ladder->change : 1.0;
  const strut_evidence *evidence = find_evidence(ladder);
  double worst = known ? OF_WORST * ladder->expected / ladder->a->target : 0.0;
  if (known && evidence) worst = fmax(worst, least_by_chance(ladder, evidence) / ladder->a->target);
  double apart = ladder->same_motion ? OF_DISTANCE * ladder->distance : 0.0;
  for (size_t i = 0; i < summary->measured_count; i++) {
    strut_measured *measured = &summary->measured[i];
    measured->expected = (double)NAN;
    double allowed = strut_ladder_tolerated_error(ladder, measured, i),
           error = factor * ladder->difference[i];
    if (!measured->zero && error < HUGE_VAL)
      error = fmax(error, fmax(apart * fabs(measured->value), worst * allowed));
    if (ladder->runs > 1)
      measured->expected =
          fmax(ladder->margin * error, ladder->shifted[i]) + rest_of_transient(summary, i);
    measured->kept =
        ladder->kept || strut_accuracy_is_kept(ladder->same_motion && is_followed(ladder, summary),
                                               measured->expected, allowed);
    if (ladder->kept) measured->expected = fmin(measured->expected, allowed);
    if (!measured->kept && ladder->runs > 1)
      measured->expected = fmax(measured->expected, range_about_latest(ladder, i));
    bool decided = ladder->runs > 1 && isfinite(ladder->difference[i] + ladder->shifted[i]);
    bool unsettled = !ladder->kept && ladder->worst == i && isnan(measured->value);
    measured->undecided = measured->arrival && (!decided || unsettled);
    if (measured->undecided) measured->kept = false;
    if (measured->undecided || (measured->arrival && isnan(measured->value)))
      measured->expected = (double)NAN;
  }
}

/* The relative error of the velocity, which is printed beside the quantities. */
static double error_of_velocity(const strut_ladder *ladder, const strut_summary *summary) {
  size_t n = ladder->a->experiment.quantity_count, width = n + 1;
  const double *latest = ladder->results + (size_t)(ladder->runs - 1) * width;
  if (summary->velocity_zero || ladder->runs < 2) return 0.0;
  return (ladder->margin * fabs(latest[n] - latest[n - width]) + summary->steady.interval) /
         strut_ladder_velocity_size(ladder, summary->velocity);
}

void strut_ladder_report(strut_ladder *ladder) {
  strut_accuracy *accuracy = ladder->a;
  strut_summary *summary = accuracy->summary;
  double expected = ladder->expected;
  if (ladder->same_motion)
    expected = ladder->margin *
               fmax(expected, summary->velocity_zero ? 0.0 : OF_DISTANCE * ladder->distance);
  if (isfinite(expected)) expected += ladder->unsteady;
  if (summary->steady.kind == STRUT_MOTION_PERIODIC && !summary->velocity_zero &&
      strut_ladder_runs_with_error_control(ladder) == 1)
    expected = fmax(expected, OF_FIRST_RUN * accuracy->target + ladder->unsteady);
  if (ladder->kept) expected = fmin(expected, accuracy->target);
  if (!isfinite(expected)) expected = range_of_runs(ladder, summary);
  if (isfinite(expected))
    expected = fmax(expected, fmax(ladder->sensitivity, error_of_velocity(ladder, summary)));
  if (!isfinite(expected)) expected = (double)NAN; /* a single run */
  summary->accuracy = (strut_accuracy_summary){.wanted = accuracy->target,
                                               .expected = expected,
                                               .scale = accuracy->scale,
                                               .kept = ladder->kept,
                                               .check_evaluations = accuracy->check_evaluations};
  report_quantities(ladder);
  if (find_undecided(ladder))
    summary->accuracy.expected = (double)NAN, summary->accuracy.kept = false;
  explain_ladder(ladder, summary->accuracy.why, sizeof summary->accuracy.why);
}
