/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Dormand and Prince's pair of orders 5 and 4 (J. Comp. Appl. Math. 6, 1980) with error control,
 * from event to event. The last stage is the first of the next step.
 *
 * Errors are measured against the size of the structure, a hundredth of it, for positions, and
 * against the fastest speed so far for velocities.
 */
#include "engine/integrate/integrator.h"
#include "engine/integrate/located_kernel.h"

enum { PAIR = 7, V = 1, A = V + PAIR, STAGES = A + PAIR };

static const double ahead[PAIR] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0, 1.0};
static const double table[PAIR][PAIR - 1] = {
    {0},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
/* Weights of order 5 less those of order 4. */
static const double difference[PAIR] = {71.0 / 57600,      0.0,        -71.0 / 16695, 71.0 / 1920,
                                        -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

/* out = z + h sum_j weight[j] k[j] over `count` stages */
STRUT_INLINE void add_stages(int32_t n, double h, const double *z, double *const *k,
                             const double *weight, int count, double *out) {
  for (int32_t i = 0; i < n; i += STRUT_LANES) {
    strut_lanes sum = weight[0] * strut_lanes_load_pairs(k[0] + i);
    for (int j = 1; j < count; j++)
      if (weight[j] != 0.0) sum += weight[j] * strut_lanes_load_pairs(k[j] + i);
    strut_lanes_store(out + i, strut_lanes_load(z + i) + h * sum);
  }
}

static double largest(int32_t n, const double *x) {
  double most = 0.0;
  for (int32_t i = 0; i < n; i++) {
    if (!(fabs(x[i]) <= most)) most = fabs(x[i]);
    if (isnan(x[i])) return HUGE_VAL;
  }
  return most;
}

static double error_of(const strut_model *model, strut_located *l, double h, double *const *v,
                       double *const *a, double *scratch) {
  int32_t n = model->length;
  for (int32_t i = 0; i < n; i++) scratch[i] = 0.0;
  add_stages(n, h, scratch, v, difference, PAIR, scratch);
  double position = largest(n, scratch);
  for (int32_t i = 0; i < n; i++) scratch[i] = 0.0;
  add_stages(n, h, scratch, a, difference, PAIR, scratch);
  double velocity = largest(n, scratch);
  l->fastest = fmax(l->fastest, fmax(largest(n, l->now->v), largest(n, l->next->v)));
  double error = position / (0.01 * model->size * l->tolerance);
  if (velocity > 0.0) error = fmax(error, velocity / (l->fastest * l->tolerance));
  return error;
}

STRUT_INLINE void take(const strut_model *model, strut_state *state, strut_located *l, double t,
                       double h, bool ledger) {
  double *v[PAIR], *a[PAIR];
  for (int k = 0; k < PAIR; k++) v[k] = l->stage[V + k], a[k] = l->stage[A + k];
  v[0] = l->now->v, a[0] = l->now->a;
  v[PAIR - 1] = l->next->v, a[PAIR - 1] = l->next->a;
  int32_t n = model->length;
  for (int p = 0; p < STRUT_POWER_COUNT && ledger; p++)
    l->gained[p] = table[PAIR - 1][0] * h * l->now->power[p];
  for (int k = 1; k < PAIR; k++) {
    double *q = k == PAIR - 1 ? l->next->q : l->stage[0];
    add_stages(n, h, l->now->q, v, table[k], k, q);
    add_stages(n, h, l->now->v, a, table[k], k, v[k]);
    if (k == PAIR - 1) break;
    located_acceleration(model, state, l, t + ahead[k] * h, q, v[k], a[k], l->next, ledger);
    for (int p = 0; p < STRUT_POWER_COUNT && ledger; p++)
      l->gained[p] += table[PAIR - 1][k] * h * state->power[p];
  }
  located_finish(model, state, l, t + h, l->next, ledger);
  l->error = error_of(model, l, h, v, a, l->stage[0]);
}

STRUT_CLONES
static void adaptive_trial(const strut_model *model, strut_state *state, strut_located *l, double t,
                           double h) {
  if (state->ledger)
    take(model, state, l, t, h, true);
  else
    take(model, state, l, t, h, false);
}

static const strut_stepper stepper = {
    .trial = adaptive_trial, .stages = STAGES, .exact = true, .adaptive = true};

static void *create(const strut_model *model, strut_state *state) {
  return strut_located_create(model, state, &stepper);
}

const strut_integrator strut_integrator_adaptive = {
    .name = "adaptive",
    .description = "Dormand-Prince 5(4) from event to event, step by error control",
    .order = 5,
    .evaluations = 6,
    .events = true,
    .create = create,
    .restart = strut_located_restart,
    .advance = strut_located_advance,
};
