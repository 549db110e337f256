/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Watching a run for steady motion, and finishing it there. */
#include <math.h>
#include <string.h>

#include "engine/run/orbit/shooting.h"
#include "engine/run/simulate_parts.h"

int64_t strut_run_middle(int64_t period) { return (int64_t)(0.382 * (double)period); }

/* The state becomes the orbit's; what the change does to the stored energies is no error of the run. */
static void take_orbit(strut_run *r, const double *y) {
  size_t bytes = (size_t)r->model->length * sizeof(double);
  double t = (double)r->state->step * r->dt;
  strut_energies before = strut_energy_evaluate(r->model, r->state, t);
  memcpy(r->state->q, y, bytes);
  memcpy(r->state->v, y + r->model->length, bytes);
  r->state->refined_until = t + y[2 * r->model->length];
  if (r->method->restart) r->method->restart(r->model, r->state, r->workspace, r->dt);
  strut_energies after = strut_energy_evaluate(r->model, r->state, t);
  r->initial.kinetic += after.kinetic - before.kinetic;
  r->initial.elastic += after.elastic - before.elastic;
  r->initial.gravity += after.gravity - before.gravity;
  r->initial.contact += after.contact - before.contact;
}

/* Finishes the motion that was found to be periodic; it goes on as it is where that fails. */
static strut_status shoot(strut_run *r) {
  size_t length = (size_t)r->model->length;
  strut_steady_summary *found = &r->watch.result;
  strut_period_map map = {.model = NULL};
  double travel = 0.0, *y = strut_allocate(2 * length + 1, sizeof *y);
  if (!y) return strut_fail(r->error, STRUT_NO_MEMORY, "out of memory");
  strut_status status =
      strut_period_map_create(r->model, r->experiment, found->repeats, &map, r->error);
  if (!status) {
    map.time = (double)r->state->step * r->dt;
    map.interrupt = r->options->interrupt;
    memcpy(y, r->state->q, length * sizeof *y);
    memcpy(y + length, r->state->v, length * sizeof *y);
    y[2 * length] = fmax(0.0, r->state->refined_until - map.time);
    status = strut_shoot(&map, y, &travel, found);
    if (status == STRUT_INTERRUPTED)
      strut_fail(r->error, status, "interrupted at t = %.9g s, while the orbit was shot", map.time);
    else if (status)
      strut_fail(r->error, status, "out of memory");
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

strut_status strut_run_watch(strut_run *r) {
  int64_t n = r->state->step, past = (n - r->first) % r->period_steps;
  if (past == strut_run_middle(r->period_steps))
    strut_steady_detector_half_period(r->state, &r->watch);
  if (past != 0) return STRUT_OK;
  double x, v;
  bool before = r->watch.known;
  strut_measure_track(r->model, r->state, &r->measure, &x, &v);
  if (!strut_steady_detector_period(r->state, x, &r->watch) || before) return STRUT_OK;
  strut_status status = r->experiment->steady.shooting ? shoot(r) : STRUT_OK;
  if (status) return status;
  double now = (double)n * r->dt, period = r->watch.period;
  int64_t periods = r->more_periods, repeats = r->watch.result.repeats;
  if (r->measure.quantities && periods < repeats) periods = repeats; /* over the whole orbit */
  r->steps = n + periods * r->period_steps;
  r->grid.last = r->measure.grid.last = r->recording.grid.last = -1;
  strut_measure_window(r->model, r->state, now, period, (size_t)periods, &r->measure);
  if (r->experiment->output_last > 0.0) r->recording.start = now;
  return STRUT_OK;
}
