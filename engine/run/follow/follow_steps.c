/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How many fixed steps of a period a branch takes. */
#include <math.h>
#include <string.h>

#include "engine/integrate/limit/step_limit.h"
#include "engine/run/follow/follow.h"

/*
 * A step turns the fastest vibration by so much [rad] at the usual accuracy, and by its fourth root at others:
 * the crawler's bars, which ring at 3 kHz, then cost 0.03 % of its velocity. Part of the largest stable step.
 */
static const double TURN = 0.8, USUAL_ACCURACY = 1e-3, MOST_TURN = 1.0, STABLE = 0.5;
/* Travel that matters, in amplitudes a period. */
static const double LITTLE_TRAVEL = 0.3;
enum { LEAST_STEPS = 400, MOST_STEPS = 20000, MOST_DOUBLINGS = 3 };

/* Steps of the period at the present value. */
static strut_status steps_here(const strut_follow_system *s, double accuracy, double *steps,
                               strut_error *error) {
  strut_step_limit limit;
  strut_status status = strut_step_limit_estimate(s->model, &limit, error);
  double turn = fmin(TURN * pow(accuracy / USUAL_ACCURACY, 0.25), MOST_TURN);
  if (status) return status;
  double longest = STABLE * limit.of[s->map[0].method->region];
  if (limit.largest_frequency > 0.0) longest = fmin(longest, turn / limit.largest_frequency);
  *steps = fmax(*steps, ceil(s->period / longest));
  return STRUT_OK;
}

strut_status strut_follow_choose_steps(strut_follow_system *s, double accuracy, bool *good,
                                       strut_error *error) {
  const double value = s->value, at[3] = {s->low, s->high, value};
  double steps = LEAST_STEPS;
  for (int k = 0; k < 3; k++) {
    strut_status status = strut_follow_set_value(s, at[k], error);
    if (!status) status = steps_here(s, accuracy, &steps, error);
    if (status) return status;
  }
  *good = steps <= MOST_STEPS;
  return *good ? strut_follow_set_steps(s, (int64_t)steps, error) : STRUT_OK;
}

/* What a branch tells of the motion y: velocity [m/s] and amplitude over a period [m/s]. */
static bool tell_motion(strut_follow_system *s, const double *y, double *velocity, double *swing) {
  double *end = strut_arena_allocate(&s->arena, s->both, sizeof *end);
  if (!end) return false;
  memcpy(end, y, s->both * sizeof *end);
  strut_follow_period p = strut_follow_apply(s, end, true);
  *velocity = p.travel / (s->period * s->repeats);
  *swing = p.amplitude / s->period;
  return isfinite(p.travel);
}

strut_status strut_follow_check_steps(strut_follow_system *s, double *y, double accuracy,
                                      strut_error *error) {
  double *fine = strut_arena_allocate(&s->arena, s->both, sizeof *fine);
  double u[2] = {0}, swing[2] = {0};
  char reason[200];
  if (!fine) return strut_no_memory(error, "");
  for (int k = 0; k < MOST_DOUBLINGS; k++) {
    int64_t steps = s->steps_per_period;
    bool found = tell_motion(s, y, &u[0], &swing[0]);
    memcpy(fine, y, s->both * sizeof *fine);
    strut_status status = strut_follow_set_steps(s, 2 * steps, error);
    if (!status && found) status = strut_follow_correct(s, fine, &found, reason, error);
    found = found && !status && tell_motion(s, fine, &u[1], &swing[1]);
    double travel = s->travels ? fmax(fabs(u[0]), LITTLE_TRAVEL * swing[0]) : HUGE_VAL;
    bool near = found && fabs(u[1] - u[0]) <= accuracy * travel &&
                (s->travels || fabs(swing[1] - swing[0]) <= accuracy * swing[0]);
    if (!status && (near || !found)) return strut_follow_set_steps(s, steps, error);
    if (status) return status;
    memcpy(y, fine, s->both * sizeof *y);
  }
  return STRUT_OK;
}
