/* SPDX-License-Identifier: GPL-3.0-or-later */
/* To an accuracy by repetition: methods and tolerances one after the other, until two agree. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/integrate/integrator.h"
#include "engine/run/accuracy.h"

/* Two runs that agree to this part of what is wanted. */
static const double AGREE = 0.4;
/* Runs at most, and runs in a row that came no nearer to the one before. */
enum { MOST_RUNS = 12, VAIN = 3 };

/*
 * Steps of the accurate method, which are the longest it takes and where the window's ends are
 * interpolated: such that both fall on the grid, or so short that interpolating costs nothing.
 */
static double grid_of(const strut_accuracy *a) {
  strut_span span = strut_scene_span(a->scene);
  if (span.period > 0.0) {
    double phase = span.window_start / span.period;
    if (fabs(phase - round(phase)) < 1e-9 && a->scene->experiment.periods < 1e6)
      return span.period / 50.0;
    return fmin(span.period / 200.0, a->cheap.step);
  }
  for (int n = 50; n <= 400; n++) {
    double at = span.window_start / span.duration * n;
    if (fabs(at - round(at)) < 1e-9 * n) return span.duration / n;
  }
  return fmin(span.duration / 200.0, a->cheap.step);
}

/*
 * The k-th run. A method that takes rigid bars has no other to be compared with: ever smaller steps.
 * Else Verlet first; then error control, with a tolerance that shrinks. Two runs of one method at
 * steps that are too large may agree by chance; two methods hardly do.
 */
static strut_experiment rung(const strut_accuracy *a, int k) {
  strut_experiment e = a->cheap;
  e.steady.tolerance = fmin(e.steady.tolerance, 0.2 * a->wanted);
  if (a->halving) e.step = ldexp(e.step, -k);
  if (a->halving || k == 0) return e;
  e.integrator = "adaptive";
  e.step = grid_of(a);
  e.tolerance = fmax(1e-13, fmin(1e-4, 1e-2 * a->wanted) * pow(0.1, k - 1));
  return e;
}

static void tell(const strut_accuracy *a, const strut_experiment *e, const char *other,
                 double difference, bool kept) {
  strut_summary *s = a->summary;
  double size = fmax(fabs(s->velocity), a->scale);
  s->accuracy = (strut_accuracy_summary){.wanted = a->wanted,
                                         .expected = difference / size,
                                         .scale = a->scale,
                                         .kept = kept,
                                         .check_evaluations = a->spent};
  char how[80];
  if (strcmp(e->integrator, "adaptive") == 0)
    snprintf(how, sizeof how, "adaptive with a tolerance of %.1g", e->tolerance);
  else
    snprintf(how, sizeof how, "%s with a step of %.3g s", e->integrator, s->step);
  snprintf(
      s->accuracy.why, sizeof s->accuracy.why,
      kept ? "%s: %s differs by %.2g m/s"
           : "%s is the finest tried; %s differs by %.2g m/s, so that the motion may be chaotic "
             "over this time",
      how, other, difference);
}

/* What the runs have come to. */
typedef struct ladder {
  strut_summary now, before;
  double difference, earlier; /* of the latest two velocities, and of the two before [m/s] */
  bool kept;
} ladder;

/* One more run, quietly, and how it compares. */
static strut_status climb(strut_accuracy *a, const strut_experiment *e, ladder *l) {
  strut_run_options quiet = *a->options;
  quiet.sinks = NULL, quiet.sink_count = 0, quiet.to = NULL;
  strut_summary_free(&l->before);
  l->before = l->now;
  l->now = (strut_summary){0};
  strut_status status = strut_accuracy_run(a, e, &quiet, &l->now);
  a->spent += l->now.force_evaluations;
  if (status && status != STRUT_DIVERGED) return status;
  l->earlier = l->difference;
  l->difference = HUGE_VAL;
  if (status || l->before.status || l->before.steps == 0) return STRUT_OK;
  l->difference = fabs(l->now.velocity - l->before.velocity);
  double enough = AGREE * a->wanted * fmax(fabs(l->now.velocity), a->scale);
  /* steps of one method must agree twice: once is chance where it is of first order */
  l->kept = l->difference <= enough && (!a->halving || l->earlier <= 3.0 * enough);
  return STRUT_OK;
}

/* The run that answers, recorded if that is wanted: the earlier one where it is the cheaper. */
static strut_status answer(strut_accuracy *a, const strut_experiment *e, bool earlier, ladder *l) {
  strut_summary *chosen = earlier ? &l->before : &l->now;
  a->spent -= chosen->force_evaluations;
  if (!a->options->sink_count && !a->options->to && chosen->status == STRUT_OK) {
    *a->summary = *chosen;
    *chosen = (strut_summary){0};
    return STRUT_OK;
  }
  a->spent += chosen->force_evaluations;
  return strut_accuracy_run(a, e, a->options, a->summary);
}

strut_status strut_accuracy_by_repetition(strut_accuracy *a) {
  ladder l = {.difference = HUGE_VAL, .earlier = HUGE_VAL};
  strut_experiment e = a->cheap;
  strut_status status = STRUT_OK;
  int k = 0;
  for (int vain = 0; k < MOST_RUNS && vain < VAIN && !l.kept && !status; k++) {
    e = rung(a, k);
    status = climb(a, &e, &l);
    vain = k > 2 && l.difference > 0.5 * l.earlier ? vain + 1 : 0;
  }
  bool first = l.kept && !a->halving && k == 2; /* the cheap method, which the other confirms */
  const char *other = first ? "adaptive" : "the run before it, coarser,";
  if (first) e = rung(a, 0);
  if (!status) status = answer(a, &e, first, &l);
  if (!status) tell(a, &e, other, l.difference, l.kept);
  strut_summary_free(&l.before);
  strut_summary_free(&l.now);
  return status;
}
