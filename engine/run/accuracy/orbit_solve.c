/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/accuracy/orbit_solve.h"

#include <math.h>
#include <string.h>

double strut_accuracy_scale(const strut_accuracy *a, double velocity) {
  return fmax(fabs(velocity), a->scale);
}

void strut_orbit_solve_count(strut_orbit_solve *w) {
  int64_t made = w->cheap.evaluations + w->fine.evaluations;
  w->a->used += made > w->counted ? made - w->counted : 0;
  w->counted = made;
}

void strut_summary_append(strut_summary *whole, strut_summary *part) {
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

strut_status strut_orbit_solve_run(strut_orbit_solve *w, strut_experiment e, double tolerance,
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

void strut_orbit_solve_keep_end(strut_orbit_solve *w) {
  size_t length = (size_t)w->cheap.model->length;
  memcpy(w->orbit.y, w->end.q, length * sizeof(double));
  memcpy(w->orbit.y + length, w->end.v, length * sizeof(double));
  w->orbit.y[2 * length] = w->end.refined;
}
