/* SPDX-License-Identifier: GPL-3.0-or-later */
/* strut's methods and --accuracy in the work-precision tables. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/forces/history.h"
#include "engine/run/accuracy/accuracy.h"
#include "tests/bench/precision.h"
#include "tests/bench/scenes.h"

/* Steps up to step number `to`; not beyond the allowed time. */
static bool advance(const precision_problem *p, const strut_integrator *method, strut_state *state,
                    void *work, double step, int64_t to) {
  int64_t chunk = 1 + (int64_t)(2000 / p->n);
  while (state->step < to && !state->trouble && !precision_late) {
    int64_t left = to - state->step;
    strut_integrator_advance(method, p->model, state, work, step, left < chunk ? left : chunk);
  }
  return !state->trouble && !precision_late;
}

static double velocity_of(precision_problem *p, const strut_integrator *method, strut_state *state,
                          void *work, double step, int64_t steps) {
  int64_t first = (int64_t)(p->begin / p->end * (double)steps + 0.5);
  if (method->restart) method->restart(p->model, state, work, step);
  if (!advance(p, method, state, work, step, first)) return (double)NAN;
  double from = precision_place_at(p, state->q);
  if (!advance(p, method, state, work, step, steps)) return (double)NAN;
  return (precision_place_at(p, state->q) - from) / (p->end - p->begin);
}

static bool solve(precision_problem *p, const precision_method *row, double setting,
                  precision_answer *answer) {
  const strut_integrator *method = strut_integrator_find(row->like);
  strut_experiment e = p->setup.experiment;
  strut_error error = {0};
  strut_state *state = NULL;
  bool adaptive = row->ladder == PRECISION_TOLERANCES;
  int64_t longest = method->order < 8 ? 100 : 10; /* per part, as strut_experiment_choose_step */
  int64_t steps =
      p->parts * (adaptive ? longest : (int64_t)ceil(p->end / (double)p->parts / setting));
  e.integrator = row->like, e.step = p->end / (double)steps;
  if (adaptive) e.tolerance = setting;
  const strut_integrator_settings settings = strut_integrator_settings_of(&e);
  if (strut_integrator_check(p->model, &e, &error) != STRUT_OK) {
    snprintf(answer->note, sizeof answer->note, "refused: %.140s", error.message);
    return false;
  }
  if (strut_state_create(p->model, &state, &error) != STRUT_OK) return false;
  strut_state_reset(p->model, state);
  strut_history_begin(p->model, state, 0.0);
  state->limits.interrupt = &precision_late;
  double begin = bench_seconds();
  void *work = method->create(p->model, state, &settings);
  answer->velocity = work ? velocity_of(p, method, state, work, e.step, steps) : (double)NAN;
  answer->seconds = bench_seconds() - begin;
  answer->evaluations = state->latest->evaluations;
  if (state->trouble) snprintf(answer->note, sizeof answer->note, "failed");
  strut_state_free(state);
  return true;
}

static bool solve_accurately(precision_problem *p, const precision_method *row, double setting,
                             precision_answer *answer) {
  strut_experiment e = p->setup.experiment;
  strut_summary summary = {0};
  strut_error error = {0};
  const strut_run_options options = {.interrupt = &precision_late, .without_balance = true};
  (void)row;
  e.accuracy = setting;
  double begin = bench_seconds();
  strut_status status = strut_simulate_accurately(p->model, &e, &options, &summary, &error);
  answer->seconds = bench_seconds() - begin;
  answer->evaluations = summary.spent.evaluations + summary.accuracy.check_evaluations;
  answer->velocity = status == STRUT_OK ? summary.velocity : (double)NAN;
  if (status != STRUT_OK && !precision_late)
    snprintf(answer->note, sizeof answer->note, "%.150s", error.message);
  else if (!summary.accuracy.kept)
    snprintf(answer->note, sizeof answer->note, "not kept: expects %.1e",
             summary.accuracy.expected);
  strut_summary_free(&summary);
  return true;
}

#define BY_STEPS(id, row, ...)                                                                     \
  { .name = id, .strut = true, .like = row, .solve = solve, .ladder = __VA_ARGS__ }

const precision_method precision_strut_methods[] = {
    BY_STEPS("rk4", "rk4", PRECISION_STEPS),
    BY_STEPS("verlet", "verlet", PRECISION_STEPS),
    BY_STEPS("rk4-events", "rk4-events", PRECISION_STEPS),
    BY_STEPS("verlet-events", "verlet-events", PRECISION_STEPS),
    {.name = "adaptive", .strut = true, .like = "adaptive", .solve = solve},
    {.name = "adaptive8", .strut = true, .like = "adaptive8", .solve = solve},
    BY_STEPS("midpoint", "midpoint", PRECISION_LONG_STEPS),
    BY_STEPS("rk4, rigid bars", "rk4", PRECISION_STEPS, .rigid = true),
    {.name = PRECISION_ACCURACY, .strut = true, .solve = solve_accurately},
    {.name = NULL}};
