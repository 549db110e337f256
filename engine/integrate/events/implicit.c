/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Rosenbrock's method RODAS (Hairer and Wanner: Solving Ordinary Differential Equations II, IV.7), with error control,
 * from event to event. It is L-stable: stiff bars, dampers and contacts do not bound the step while they hardly move.
 *
 * Derivatives of accelerations and powers are differences in the present modes, so that every law, signal and
 * multiplier is in them. Works are integrated as positions are.
 */
#include <gsl/gsl_linalg.h>
#include <string.h>

#include "engine/forces/tangent.h"
#include "engine/integrate/events/event_kernel.h"
#include "engine/integrate/integrator.h"

enum { STAGES = 6, POWERS = STRUT_POWER_COUNT };
static const double GAMMA = 0.25;
/* Of stage i: of the results before, of those over the step; its time; of the drift. */
#define LATE 1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950
static const double OF_RESULTS[STAGES + 1][STAGES] = {
    {0},
    {1.544},
    {0.9466785280815826, 0.2557011698983284},
    {3.314825187068521, 2.896124015972201, 0.9986419139977817},
    {LATE},
    {LATE, 1.0},
    {LATE, 1.0, 1.0}};
static const double OF_RATES[STAGES][STAGES] = {
    {0},
    {-5.6688},
    {-2.430093356833875, -0.2063599157091915},
    {-0.1073529058151375, -9.594562251023355, -20.47028614809616},
    {7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160},
    {8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136,
     -6.058818238834054}};
static const double OF_DRIFT[STAGES] = {0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0};
/* The error is the last result. */
static const strut_tableau tableau = {.stages = STAGES,
                                      .order = 4,
                                      .ahead = {0.0, 0.386, 0.21, 0.63, 1.0, 1.0, 1.0},
                                      .difference = {0.25}};

/* Steps of differences: over the size, over the fastest speed and the own one, over the step. */
static const double OF_SIZE = 1.5e-8, OF_SPEED = 1.5e-8, OF_STEP = 1e-3;

typedef struct strut_implicit {
  int32_t n, *coordinate;             /* free coordinates: where they stand */
  double *slope[2];                   /* (n, n) of accelerations, by positions and by velocities */
  double *gain[2];                    /* (n, POWERS) of powers, likewise */
  double *drift, drift_power[POWERS]; /* (n) of accelerations in time; of powers */
  double *matrix, *x;                 /* (n, n), (n) */
  size_t *pivot;
  double *known, time; /* (length) accelerations that the slopes are for, and when */
  int64_t events;      /* and after how many events: modes may change where accelerations do not */
} strut_implicit;

/* Arrays of stepper->stage: results of positions and of velocities, then what a stage is evaluated at and gives. */
enum { RESULT_Q, RESULT_V = STAGES, Q = 2 * STAGES, V, A, ARRAYS };

typedef struct trial {
  const strut_model *model;
  const strut_state *state;
  strut_event_stepper *stepper;
  strut_implicit *m;
  double t, h;
  double behind; /* what jumps where the step begins: signals are evaluated a moment before [s] */
} trial;

static void evaluate(const trial *self, double t) {
  double **w = self->stepper->stage;
  if (self->model->terms & STRUT_TERM_SUPPORT_MOTION)
    strut_support_motion_place(self->model, self->state, t, w[Q], w[V]);
  accelerate_in_modes(self->model, self->state, self->stepper, t, w[Q], w[V], w[A],
                      self->stepper->next, STRUT_TERMS_ALL, self->state->balance);
}

static void add_column(const trial *self, int k, int32_t j, double step, double *gain) {
  const strut_implicit *implicit = self->m;
  const strut_step_end *now = self->stepper->now;
  double *at = &self->stepper->stage[k ? V : Q][implicit->coordinate[j]], before = *at;
  *at += k ? fmax(step, OF_SPEED * fabs(before)) : step;
  step = *at - before;
  evaluate(self, self->t + self->behind);
  for (int32_t i = 0; i < implicit->n; i++)
    implicit->slope[k][i * implicit->n + j] =
        (self->stepper->stage[A][implicit->coordinate[i]] - now->a[implicit->coordinate[i]]) / step;
  for (int p = 0; p < POWERS; p++) gain[p] = (self->state->latest->power[p] - now->power[p]) / step;
  *at = before;
}

static void copy_now(const trial *self, double *const to[2]) {
  size_t bytes = (size_t)self->model->length * sizeof(double);
  memcpy(to[0], self->stepper->now->q, bytes);
  memcpy(to[1], self->stepper->now->v, bytes);
}

/* Slopes at now, unless they are known. */
static void differentiate(const trial *self) {
  strut_implicit *implicit = self->m;
  const strut_step_end *now = self->stepper->now;
  size_t bytes = (size_t)self->model->length * sizeof(double);
  bool same = implicit->time == self->t && implicit->events == self->state->events;
  if (same && !memcmp(implicit->known, now->a, bytes)) return;
  double size = self->model->size, later = fmax(OF_STEP * self->h, 2.0 * self->behind);
  double speed = fmax(self->stepper->control.speed, size * 1e-3);
  copy_now(self, &self->stepper->stage[Q]);
  for (int k = 0; k < 2; k++)
    for (int32_t j = 0; j < implicit->n; j++)
      add_column(self, k, j, k ? OF_SPEED * speed : OF_SIZE * size, implicit->gain[k] + j * POWERS);
  evaluate(self, self->t + later);
  for (int32_t i = 0; i < implicit->n; i++)
    implicit->drift[i] =
        (self->stepper->stage[A][implicit->coordinate[i]] - now->a[implicit->coordinate[i]]) /
        later;
  for (int p = 0; p < POWERS; p++)
    implicit->drift_power[p] = (self->state->latest->power[p] - now->power[p]) / later;
  memcpy(implicit->known, now->a, bytes);
  implicit->time = self->t, implicit->events = self->state->events;
}

/* Factors 1/(gamma h) - J, with positions eliminated. False: it is singular. */
static bool factorise(const trial *self, double rate, gsl_matrix_view *view,
                      gsl_permutation *order) {
  strut_implicit *implicit = self->m;
  size_t n = (size_t)implicit->n;
  int sign;
  for (size_t k = 0; k < n * n; k++)
    implicit->matrix[k] = -implicit->slope[1][k] - implicit->slope[0][k] / rate;
  for (size_t i = 0; i < n; i++) implicit->matrix[i * n + i] += rate;
  *view = gsl_matrix_view_array(implicit->matrix, n, n);
  *order = (gsl_permutation){n, implicit->pivot};
  gsl_linalg_LU_decomp(&view->matrix, order, &sign);
  for (size_t i = 0; i < n; i++)
    if (!(fabs(implicit->matrix[i * n + i]) > 0.0)) return false;
  return true;
}

/* start + the weighted results of `count` stages. */
static void combine(const trial *self, const double *weight, int count, double *positions,
                    double *velocity) {
  double **w = self->stepper->stage;
  copy_now(self, (double *[]){positions, velocity});
  for (int j = 0; j < count; j++)
    for (int32_t i = 0; i < self->model->length && weight[j] != 0.0; i++)
      positions[i] += weight[j] * w[RESULT_Q + j][i], velocity[i] += weight[j] * w[RESULT_V + j][i];
}

static void solve_stage(const trial *self, int i, double rate, const gsl_matrix_view *view,
                        const gsl_permutation *order) {
  strut_implicit *implicit = self->m;
  double **w = self->stepper->stage, *kq = w[RESULT_Q + i], *kv = w[RESULT_V + i];
  gsl_vector_view x = gsl_vector_view_array(implicit->x, (size_t)implicit->n);
  for (int32_t r = 0; r < implicit->n; r++) {
    int32_t at = implicit->coordinate[r];
    kq[at] = w[V][at], implicit->x[r] = w[A][at] + self->h * OF_DRIFT[i] * implicit->drift[r];
    for (int j = 0; j < i; j++) {
      kq[at] += OF_RATES[i][j] / self->h * w[RESULT_Q + j][at];
      implicit->x[r] += OF_RATES[i][j] / self->h * w[RESULT_V + j][at];
    }
  }
  for (int32_t r = 0; r < implicit->n; r++)
    for (int32_t s = 0; s < implicit->n; s++)
      implicit->x[r] +=
          implicit->slope[0][r * implicit->n + s] * kq[implicit->coordinate[s]] / rate;
  gsl_linalg_LU_svx(&view->matrix, order, &x.vector);
  for (int32_t r = 0; r < implicit->n; r++) {
    int32_t at = implicit->coordinate[r];
    kv[at] = implicit->x[r], kq[at] = (kq[at] + kv[at]) / rate;
  }
}

/* Works of stage i, as its positions. */
static void solve_works(const trial *self, int i, double rate, const double *power,
                        double (*work)[POWERS]) {
  const strut_implicit *implicit = self->m;
  double **w = self->stepper->stage;
  for (int p = 0; p < POWERS; p++) {
    double sum = power[p] + self->h * OF_DRIFT[i] * implicit->drift_power[p];
    for (int j = 0; j < i; j++) sum += OF_RATES[i][j] / self->h * work[j][p];
    for (int32_t r = 0; r < implicit->n; r++)
      sum += implicit->gain[0][r * POWERS + p] * w[RESULT_Q + i][implicit->coordinate[r]] +
             implicit->gain[1][r * POWERS + p] * w[RESULT_V + i][implicit->coordinate[r]];
    work[i][p] = sum / rate;
  }
}

/* Local error over what is allowed. */
static double estimate_error(const trial *self) {
  strut_step_control *control = &self->stepper->control;
  double **w = self->stepper->stage, q = 0.0, v = 0.0, fast = 0.0, whole = 0.0;
  for (int32_t i = 0; i < self->model->length; i++) {
    q = fmax(q, fabs(w[RESULT_Q + STAGES - 1][i])), v = fmax(v, fabs(w[RESULT_V + STAGES - 1][i]));
    fast = fmax(fast, fmax(fabs(self->stepper->now->v[i]), fabs(self->stepper->next->v[i])));
    whole += self->stepper->next->q[i] + self->stepper->next->v[i];
  }
  control->own_speed = fast;
  control->speed = fmax(control->speed, fast);
  return isfinite(whole) ? relative_error(self->model, control, self->h, q, v) : HUGE_VAL;
}

static void implicit_once(const strut_model *model, const strut_state *state,
                          strut_event_stepper *stepper, double t, double h) {
  double behind = 2.0 * moment_before(t, stepper->control.longest);
  const trial c = {model, state, stepper, stepper->implicit, t, h, behind};
  double **w = stepper->stage, rate = 1.0 / (GAMMA * h), work[STAGES][POWERS];
  gsl_matrix_view view;
  gsl_permutation order;
  if (c.m->n) differentiate(&c);
  bool regular = !c.m->n || factorise(&c, rate, &view, &order);
  for (int i = 0; i < STAGES && regular; i++) {
    combine(&c, OF_RESULTS[i], i, w[Q], w[V]);
    if (i)
      evaluate(&c, t + tableau.ahead[i] * h);
    else
      memcpy(w[A], stepper->now->a, (size_t)model->length * sizeof(double));
    if (c.m->n) solve_stage(&c, i, rate, &view, &order);
    solve_works(&c, i, rate, i ? state->latest->power : stepper->now->power, work);
  }
  strut_event_note_stage(stepper, 1.0, true);
  combine(&c, OF_RESULTS[STAGES], STAGES, stepper->next->q, stepper->next->v);
  for (int p = 0; p < POWERS; p++) stepper->gained[p] = 0.0;
  for (int i = 0; i < STAGES && state->balance && regular; i++)
    for (int p = 0; p < POWERS; p++) stepper->gained[p] += OF_RESULTS[STAGES][i] * work[i][p];
  if (model->terms & STRUT_TERM_SUPPORT_MOTION)
    strut_support_motion_place(model, state, t + h, stepper->next->q, stepper->next->v);
  evaluate_step_end(model, state, stepper, t + h, stepper->next, STRUT_TERMS_ALL, state->balance);
  stepper->control.error = regular ? estimate_error(&c) : HUGE_VAL;
  strut_event_look_between(model, state, stepper, h);
}

static void implicit_trial(const strut_model *model, const strut_state *state,
                           strut_event_stepper *stepper, double t, double h) {
  if (state->watched.rehearsals) strut_event_rehearse(implicit_once, model, state, stepper, t, h);
  implicit_once(model, state, stepper, t, h);
}

static const strut_step_formula formula = {.trial = implicit_trial,
                                           .stages = ARRAYS + 2,
                                           .exact = true,
                                           .adaptive = true,
                                           .tableau = &tableau};

static void *implicit_create(const strut_model *model, strut_state *state,
                             const strut_integrator_settings *settings) {
  strut_event_stepper *stepper = strut_event_stepper_create(model, state, &formula, settings);
  strut_arena *arena = &state->arena;
  strut_implicit *implicit = strut_arena_allocate(arena, 1, sizeof *implicit);
  int32_t *row_of;
  if (!stepper || !implicit ||
      !STRUT_ALLOCATE(arena, STRUT_NEW(row_of, model->length),
                      STRUT_NEW(implicit->coordinate, model->length)))
    return NULL;
  implicit->n = strut_number_free(model, NULL, row_of, implicit->coordinate);
  for (int32_t k = 0; k < model->feedback.state_count; k++) /* internal ones are velocities, too */
    implicit->coordinate[implicit->n++] = model->feedback.base + k;
  implicit->time = (double)NAN;
  size_t n = (size_t)implicit->n;
  stepper->implicit = implicit;
  bool ready =
      STRUT_NUMBERS(arena, n * n, &implicit->slope[0], &implicit->slope[1], &implicit->matrix) &&
      STRUT_NUMBERS(arena, n * POWERS, &implicit->gain[0], &implicit->gain[1]) &&
      STRUT_NUMBERS(arena, n, &implicit->drift, &implicit->x) &&
      STRUT_ALLOCATE(arena, STRUT_NEW(implicit->known, model->length),
                     STRUT_NEW(implicit->pivot, n));
  return ready ? stepper : NULL;
}

const strut_integrator strut_integrator_implicit = {
    .name = "implicit",
    .description =
        "Rosenbrock's RODAS 4(3) from event to event, step by error control: stiff bars "
        "and dampers with contact",
    .order = 4,
    .evaluations = STAGES,
    .role = STRUT_ROLE_IMPLICIT,
    .no_memory = true,
    .create = implicit_create,
    STRUT_STEPS_TO_EVENTS,
};
