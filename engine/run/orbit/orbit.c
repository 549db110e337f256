/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/orbit/orbit.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/model/pose.h"

/* Members and nodes times steps between two checks of the interrupt flag. */
static const int64_t CHUNK_WORK = 200000;

strut_status strut_period_map_create(const strut_model *model, const strut_experiment *experiment,
                                     int32_t repeats, strut_period_map *map, strut_error *error) {
  *map = (strut_period_map){.model = model, .repeats = repeats};
  map->period = strut_experiment_span(experiment, model->scene).period;
  assert(repeats >= 1 && map->period > 0.0 && experiment->step > 0.0);
  map->steps = (int64_t)ceil(map->period / experiment->step * (1.0 - 1e-9));
  map->dt = map->period / (double)map->steps;
  map->measure.grid = (strut_time_grid){.step = map->dt, .last = -1};
  map->method = strut_integrator_find(experiment->integrator);
  const strut_integrator_settings settings = strut_integrator_settings_of(experiment);
  strut_status status = strut_state_create(model, &map->state, error);
  if (!status) map->workspace = map->method->create(model, map->state, &settings);
  if (!status && (!map->workspace || strut_measure_create(model, experiment, 0, 0, &map->measure)))
    status = strut_no_memory(error, "");
  if (status) {
    strut_period_map_free(map);
    return status;
  }
  map->travels = strut_model_travels(model);
  return STRUT_OK;
}

double strut_mean_along_ground(const strut_model *model, const double *positions) {
  const double *t = model->contacts.tangent;
  double sum = 0.0;
  for (int32_t i = 0; i < model->node_count; i++)
    sum += positions[2 * i] * t[0] + positions[2 * i + 1] * t[1];
  return sum / model->node_count;
}

bool strut_period_map_interrupted(const strut_period_map *map) {
  return map->interrupt && *map->interrupt;
}

bool strut_period_map_spent(const strut_period_map *map) {
  return map->most_evaluations > 0 && map->evaluations > map->most_evaluations;
}

/* Is the limit exceeded, the present application included? */
static bool is_spent_now(const strut_period_map *map) {
  return map->most_evaluations > 0 &&
         map->evaluations + map->state->latest->evaluations > map->most_evaluations;
}

/* Advances in chunks long enough for the checks to cost nothing, and short enough to interrupt promptly. */
static void advance_application(strut_period_map *map) {
  const strut_model *model = map->model;
  strut_state *state = map->state;
  int64_t most = CHUNK_WORK / (model->members.count + model->node_count + 1) + 1;
  int64_t left = map->steps * map->repeats;
  state->limits.interrupt = map->interrupt;
  if (map->most_evaluations > 0)
    state->limits.most_evaluations =
        map->most_evaluations > map->evaluations ? map->most_evaluations - map->evaluations : 1;
  while (left > 0 && !state->trouble && !strut_period_map_interrupted(map) && !is_spent_now(map)) {
    int64_t count = map->watch ? 1 : left < most ? left : most;
    strut_integrator_advance(map->method, model, state, map->workspace, map->dt, count);
    if (map->watch) map->watch(map->watch_context, state);
    left -= count;
  }
}

double strut_period_map_apply(strut_period_map *map, double *y) {
  const strut_model *model = map->model;
  strut_state *state = map->state;
  size_t bytes = (size_t)model->length * sizeof(double);
  double from, to, speed, before = strut_mean_along_ground(model, y);
  strut_state_reset(model, state);
  state->step = llround(map->time / map->dt);
  memcpy(state->q, y, bytes);
  memcpy(state->v, y + model->length, bytes);
  state->refined_until = map->time + y[2 * model->length];
  strut_measure_tracked_point(model, state, &map->measure, &from, &speed);
  if (map->method->restart) map->method->restart(model, state, map->workspace, map->dt);
  advance_application(map);
  map->evaluations += state->latest->evaluations;
  map->events += state->events;
  map->forced += state->forced.count;
  map->applied += map->repeats;
  strut_measure_tracked_point(model, state, &map->measure, &to, &speed);
  memcpy(y, state->q, bytes);
  memcpy(y + model->length, state->v, bytes);
  y[2 * model->length] = fmax(0.0, state->refined_until - (double)state->step * map->dt);
  double shift = map->travels ? strut_mean_along_ground(model, y) - before : 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    y[i] -= shift * model->contacts.tangent[i % 2];
  bool whole =
      !state->trouble && !strut_period_map_interrupted(map) && !strut_period_map_spent(map);
  return whole ? to - from : (double)NAN;
}

double strut_period_map_size(const strut_period_map *map, const double *change) {
  const strut_model *model = map->model;
  double speed = model->size * STRUT_TAU / map->period, most = 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i++) {
    most = fmax(most, fabs(change[i]) / model->size);
    most = fmax(most, fabs(change[model->length + i]) / speed);
  }
  return most;
}

void strut_period_map_subtract(const strut_period_map *map, const double *from, const double *to,
                               double *change) {
  const strut_model *model = map->model;
  const double *t = model->contacts.tangent;
  double along = 0.0;
  for (int32_t i = 0; i <= 2 * model->length; i++) change[i] = to[i] - from[i];
  for (int32_t i = 0; i < model->node_count && map->travels; i++)
    along += (change[2 * i] * t[0] + change[2 * i + 1] * t[1]) / model->node_count;
  for (int32_t i = 0; i < 2 * model->node_count; i++) change[i] -= along * t[i % 2];
}

void strut_period_map_free(strut_period_map *map) {
  strut_measure_free(&map->measure);
  strut_state_free(map->state);
  *map = (strut_period_map){.model = NULL};
}

/* The sum over a disturbance ends when its effect on the travel falls below this part of its largest. */
static const double DECAYED = 0.02;
/* Members of a sequence that are combined; stored; most periods of a disturbance; those in which it must decay. */
enum { WINDOW = 5, KEPT = WINDOW + 1, MOST_PERIODS = 20, LOST = 12 };
/*
 * The limit of a sequence from a few of its members: reduced rank extrapolation (Eddy 1979; Mesina
 * 1977; Sidi 1991). Finds the combination of successive differences, with weights of sum 1, that is
 * smallest; the members are then combined with the same weights.
 */

/* Larger weights lose more digits than extrapolation gains. */
static const double MOST_WEIGHT = 100.0;
/* Differences grow where their multiplier is above GROWN, if a fit leaves no more than FITTED of their square. */
static const double GROWN = 1.02, FITTED = 0.04;

/* Solves the small symmetric system a x = 1 in place by elimination; false if it is singular. */
static bool solve_ones(double a[WINDOW][WINDOW], int32_t n, double *vector) {
  for (int32_t i = 0; i < n; i++) vector[i] = 1.0;
  for (int32_t p = 0; p < n; p++) {
    if (!(a[p][p] > 0.0)) return false;
    for (int32_t i = p + 1; i < n; i++) {
      double f = a[i][p] / a[p][p];
      for (int32_t j = p; j < n; j++) a[i][j] -= f * a[p][j];
      vector[i] -= f * vector[p];
    }
  }
  for (int32_t i = n - 1; i >= 0; i--) {
    for (int32_t j = i + 1; j < n; j++) vector[i] -= a[i][j] * vector[j];
    vector[i] /= a[i][i];
  }
  return true;
}

/* Product of two differences, positions over the size and velocities over size times 2 pi f. */
static double multiply(const strut_period_map *map, const double *first, const double *second) {
  int32_t length = map->model->length, nodes = 2 * map->model->node_count;
  double in = map->model->size, speed = in * STRUT_TAU / map->period, product = 0.0;
  for (int32_t k = 0; k < nodes; k++)
    product +=
        first[k] * second[k] / (in * in) + first[length + k] * second[length + k] / (speed * speed);
  return product;
}

/* Weights of the differences, 1 <= count <= WINDOW. False: the system is singular, or they amplify errors. */
static bool find_extrapolation_weights(const strut_period_map *map, double *const *changes,
                                       int32_t count, double *weight) {
  double a[WINDOW][WINDOW], sum = 0.0, most = 0.0;
  assert(count >= 1 && count <= WINDOW);
  for (int32_t i = 0; i < count; i++)
    for (int32_t j = 0; j <= i; j++) a[i][j] = a[j][i] = multiply(map, changes[i], changes[j]);
  for (int32_t i = 0; i < count; i++) a[i][i] *= 1.0 + 1e-10;
  if (!solve_ones(a, count, weight)) return false;
  for (int32_t i = 0; i < count; i++) sum += weight[i];
  if (!(fabs(sum) > 0.0)) return false;
  for (int32_t i = 0; i < count; i++) most = fmax(most, fabs(weight[i] /= sum));
  return most < MOST_WEIGHT;
}

/* ---- the correction of an orbit ---- */

/* `count` states of a period map, in the arena; the first is NULL: out of memory. */
static void allocate_states(const strut_period_map *map, size_t count, strut_arena *arena,
                            double *states[]) {
  size_t both = 2 * (size_t)map->model->length + 1;
  double *all = strut_arena_allocate(arena, count * both, sizeof *all);
  for (size_t k = 0; k < count; k++) states[k] = all ? all + k * both : NULL;
}

/* A disturbance and its development over the latest periods; entry k % KEPT is after period k. */
typedef struct disturbance {
  double **d, **sum; /* (KEPT) each (2 length + 1): the disturbance; its sum so far */
  double gone[KEPT]; /* travel that the sum so far causes [m] */
  double *limit, *work;
  double travel; /* extrapolated [m]; NAN where there is none */
} disturbance;

/* Extrapolates the sums after m periods into t->limit and t->travel. Returns the size of the combined disturbance. */
static double extrapolate_disturbance(const strut_period_map *map, int m, disturbance *self) {
  double *d[WINDOW], c[WINDOW];
  int n = m < WINDOW ? m : WINDOW;
  size_t both = 2 * (size_t)map->model->length + 1;
  for (int i = 0; i < n; i++) d[i] = self->d[(m - n + i + 1) % KEPT];
  self->travel = (double)NAN;
  if (n < 2 || !find_extrapolation_weights(map, d, n, c)) return HUGE_VAL;
  self->travel = 0.0;
  memset(self->limit, 0, both * sizeof(double));
  memset(self->work, 0, both * sizeof(double));
  for (int i = 0; i < n; i++) {
    int k = (m - n + i) % KEPT;
    self->travel += c[i] * self->gone[k];
    for (size_t j = 0; j < both; j++) {
      self->limit[j] += c[i] * self->sum[k][j];
      self->work[j] += c[i] * d[i][j];
    }
  }
  return strut_period_map_size(map, self->work);
}

/*
 * Propagates the disturbance t->d[0] of `base` by C and sums it over the periods into t->limit;
 * returns the travel it causes, NAN where it does not decay. Ends where two periods in a row, or
 * the change between two extrapolations in a row, contribute less than `enough` [m].
 */
static double propagate_disturbance(strut_period_map *coarse, const double *base, double travel,
                                    double enough, disturbance *self) {
  int32_t both = 2 * coarse->model->length + 1;
  size_t bytes = (size_t)both * sizeof(double);
  double first = strut_period_map_size(coarse, self->d[0]), last = first, gone = 0.0,
         farthest = 0.0;
  double last_step = 0.0, guess = (double)NAN;
  memcpy(self->sum[0], self->d[0], bytes);
  for (int m = 1; m <= MOST_PERIODS; m++) {
    const double *before = self->d[(m - 1) % KEPT], *sum = self->sum[(m - 1) % KEPT];
    double *d = self->d[m % KEPT], *total = self->sum[m % KEPT];
    for (int32_t i = 0; i < both; i++) self->work[i] = base[i] + before[i];
    double step = strut_period_map_apply(coarse, self->work) - travel;
    strut_period_map_subtract(coarse, base, self->work, d);
    double now = strut_period_map_size(coarse, d);
    self->gone[(m - 1) % KEPT] = gone += step;
    for (int32_t i = 0; i < both; i++) total[i] = sum[i] + d[i];
    if (!isfinite(step) || !(now < 30.0 * first) || (m >= LOST && now > first)) return (double)NAN;
    farthest = fmax(farthest, fabs(step));
    double little = fmax(DECAYED * farthest, enough);
    if (fmax(fabs(step), fabs(last_step)) <= little && fmax(now, last) <= 0.3 * first) {
      memcpy(self->limit, total, bytes);
      return gone;
    }
    double rest = extrapolate_disturbance(coarse, m, self);
    if (rest <= 0.1 * first && fabs(self->travel - guess) <= little) return self->travel;
    last = now, last_step = step, guess = self->travel;
  }
  return (double)NAN;
}

strut_status strut_orbit_correct(strut_period_map *coarse, strut_period_map *reference,
                                 const double *base, double travel, double enough,
                                 strut_orbit *orbit) {
  size_t both = 2 * (size_t)coarse->model->length + 1;
  strut_arena arena = {0};
  double *states[2 * KEPT + 3], *end = NULL;
  assert(orbit->y != base && coarse->model == reference->model);
  orbit->converged = false;
  allocate_states(coarse, 2 * KEPT + 3, &arena, states);
  if (!(end = states[2 * KEPT])) return STRUT_NO_MEMORY;
  disturbance t = {.d = states,
                   .sum = states + KEPT,
                   .limit = states[2 * KEPT + 1],
                   .work = states[2 * KEPT + 2]};
  memcpy(end, orbit->y, both * sizeof *end);
  double gone = strut_period_map_apply(reference, end);
  strut_period_map_subtract(coarse, orbit->y, end, t.d[0]);
  orbit->defect = strut_period_map_size(coarse, t.d[0]);
  double more =
      isfinite(gone) ? propagate_disturbance(coarse, base, travel, enough, &t) : (double)NAN;
  if (isfinite(more)) {
    double period = coarse->period * coarse->repeats;
    for (size_t i = 0; i < both; i++) orbit->y[i] += t.limit[i];
    orbit->velocity = (gone + more) / period;
    orbit->correction = more / period;
    orbit->converged = true;
  }
  strut_arena_free(&arena);
  return STRUT_OK;
}

/* ---- the limit of a sequence of periods without running all of them ---- */

/* A window of periods: y[k + 1] = C(y[k]), d[k] their difference, travel[k] the travel. */
typedef struct window {
  double *y[WINDOW + 1], *d[WINDOW], *best;
  double travel[WINDOW], size[WINDOW];
} window;

/* Extrapolates into w->best; takes the end of the latest period where that fails. */
static void extrapolate_periods(const strut_period_map *map, window *self) {
  double c[WINDOW];
  size_t both = 2 * (size_t)map->model->length + 1;
  memcpy(self->best, self->y[WINDOW], both * sizeof(double));
  if (!find_extrapolation_weights(map, self->d, WINDOW, c)) return;
  for (size_t k = 0; k < both; k++) {
    double x = self->y[WINDOW][k];
    for (int i = 0; i < WINDOW; i++) x += c[i] * (self->y[i + 1][k] - self->y[WINDOW][k]);
    self->best[k] = x;
  }
}

/* Estimates the remaining travel per application from the decay of the differences. */
static double estimate_remaining_travel(const window *self) {
  double effect = 0.0, first = self->size[0], last = self->size[WINDOW - 1];
  for (int k = 1; k < WINDOW; k++)
    effect =
        fmax(effect, fabs(self->travel[k] - self->travel[k - 1]) / fmax(self->size[k - 1], 1e-300));
  double rate = first > 0.0 ? pow(last / first, 1.0 / (WINDOW - 1)) : 0.0;
  if (!(rate < 0.98)) rate = 0.98;
  return effect * last * rate / (1.0 - rate);
}

/*
 * Do the differences grow from period to period? They follow d[k + 1] = s d[k], or, where a pair of
 * multipliers rules, d[k + 2] = s d[k + 1] + p d[k]; both are fitted, each period with the same weight. An
 * extrapolation finds the orbit that they leave, too, but it is unstable, and no run stays on it.
 */
static bool grow(const strut_period_map *map, double *const *changes) {
  double g[WINDOW][WINDOW], a = 0.0, b = 0.0, c = 0.0, e = 0.0, f = 0.0;
  for (int i = 0; i < WINDOW; i++)
    for (int j = 0; j < WINDOW; j++) g[i][j] = multiply(map, changes[i], changes[j]);
  for (int k = 0; k + 1 < WINDOW; k++) {
    if (!(g[k][k] > 0.0) || !(g[k + 1][k + 1] > 0.0)) return false;
    a += g[k][k] / g[k + 1][k + 1];
    e += g[k][k + 1] / g[k + 1][k + 1];
  }
  const double periods = WINDOW - 1;
  double single = e / a;
  if (periods - single * e <= FITTED * periods) return fabs(single) > GROWN;
  a = b = c = e = f = 0.0;
  for (int k = 0; k + 2 < WINDOW; k++) {
    double weight = 1.0 / g[k + 2][k + 2];
    a += weight * g[k + 1][k + 1], b += weight * g[k][k + 1], c += weight * g[k][k];
    e += weight * g[k + 1][k + 2], f += weight * g[k][k + 2];
  }
  double det = a * c - b * b;
  if (!(det > 1e-6 * a * c)) return false;
  double s = (e * c - f * b) / det, p = (a * f - b * e) / det;
  if (periods - 1.0 - s * e - p * f > FITTED * (periods - 1.0)) return false;
  double root = 0.25 * s * s + p; /* z^2 = s z + p */
  double most = root < 0.0 ? sqrt(-p) : 0.5 * fabs(s) + sqrt(root);
  return most > GROWN;
}

strut_status strut_orbit_limit(strut_period_map *map, strut_extrapolation *to, double *y,
                               double *travel) {
  size_t both = 2 * (size_t)map->model->length + 1, bytes = both * sizeof(double);
  strut_arena arena = {0};
  window w;
  to->found = to->unsteady = false;
  allocate_states(map, WINDOW + 1, &arena, w.y);
  allocate_states(map, WINDOW, &arena, w.d);
  allocate_states(map, 1, &arena, &w.best);
  if (!w.y[0] || !w.d[0] || !w.best) {
    strut_arena_free(&arena);
    return STRUT_NO_MEMORY;
  }
  double before = HUGE_VAL; /* the last difference before extrapolation */
  bool jumped = false, lost = false;
  for (int cycle = 0; cycle < to->cycles && !to->found; cycle++) {
    memcpy(w.y[0], y, bytes);
    for (int k = 0; k < WINDOW; k++) {
      memcpy(w.y[k + 1], w.y[k], bytes);
      w.travel[k] = strut_period_map_apply(map, w.y[k + 1]);
      strut_period_map_subtract(map, w.y[k], w.y[k + 1], w.d[k]);
      w.size[k] = strut_period_map_size(map, w.d[k]);
      lost = lost || !isfinite(w.travel[k]);
    }
    if (lost) break;
    to->unsteady = (jumped && w.size[WINDOW - 1] > before) || grow(map, w.d);
    if (to->unsteady) break;
    if (estimate_remaining_travel(&w) <= to->enough) {
      memcpy(y, w.y[WINDOW], bytes);
      *travel = w.travel[WINDOW - 1];
      to->found = true;
      break;
    }
    if (w.size[WINDOW - 1] > to->fall * w.size[0]) break;
    before = w.size[WINDOW - 1];
    extrapolate_periods(map, &w);
    memcpy(y, w.best, bytes);
    jumped = true;
  }
  strut_arena_free(&arena);
  return STRUT_OK;
}
