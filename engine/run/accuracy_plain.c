/* SPDX-License-Identifier: GPL-3.0-or-later */
/* To an accuracy by repetition: ever finer runs, until two agree. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/run/accuracy.h"

/* Two runs that agree to this part of what is wanted. */
static const double AGREE = 0.4;
enum { MOST_RUNS = 12 };

/* The k-th run of the ladder: Verlet, Verlet at half the step, then error control. */
static strut_experiment rung(const strut_accuracy *a, int k) {
  strut_experiment e = a->cheap;
  if (k < 2) {
    e.step /= k + 1;
    return e;
  }
  strut_span span = strut_scene_span(a->scene);
  e.integrator = "adaptive";
  e.step = (span.period > 0.0 ? span.period : span.duration) / 50.0;
  e.tolerance = fmax(1e-13, fmin(1e-4, 1e-2 * a->wanted) * pow(0.1, k - 2));
  return e;
}

static bool comparable(int k) { return k != 2; } /* that is the first of another method */

static void tell(const strut_accuracy *a, const strut_experiment *e, double difference, bool kept) {
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
  snprintf(s->accuracy.why, sizeof s->accuracy.why,
           kept ? "%s: the run before it, coarser, differs by %.2g m/s"
                : "%s is the finest tried; it differs by %.2g m/s from the one before, so that "
                  "the motion may be chaotic over this time",
           how, difference);
}

strut_status strut_accuracy_by_repetition(strut_accuracy *a) {
  strut_summary before = {0}, now = {0};
  strut_run_options quiet = *a->options;
  quiet.sinks = NULL, quiet.sink_count = 0, quiet.to = NULL;
  double difference = HUGE_VAL;
  bool kept = false;
  strut_experiment e = a->cheap;
  strut_status status = STRUT_OK;
  for (int k = 0; k < MOST_RUNS && !kept; k++) {
    e = rung(a, k);
    strut_summary_free(&before);
    before = now;
    a->spent += now.force_evaluations;
    now = (strut_summary){0};
    status = strut_accuracy_run(a, &e, &quiet, &now);
    if (status && status != STRUT_DIVERGED) break;
    bool both = !status && before.status == STRUT_OK && before.steps > 0;
    status = STRUT_OK;
    if (!both) continue;
    difference = fabs(now.velocity - before.velocity);
    kept = comparable(k) && difference <= AGREE * a->wanted * fmax(fabs(now.velocity), a->scale);
  }
  strut_summary_free(&before);
  if (!status && !a->options->sink_count && !a->options->to && now.status == STRUT_OK) {
    *a->summary = now;
  } else {
    a->spent += now.force_evaluations;
    strut_summary_free(&now);
    /* the last again, recorded */
    if (!status) status = strut_accuracy_run(a, &e, a->options, a->summary);
  }
  if (!status) tell(a, &e, difference, kept);
  return status;
}
