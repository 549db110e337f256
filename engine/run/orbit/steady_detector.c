/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/orbit/steady_detector.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/model/pose.h"

/* Repetitions that are tested, in drive periods; the first that holds is reported. */
static const int32_t repeats[STRUT_REPEATS] = {1, 2, 3, 4, 6, 8};
/* Velocities below this part of size times frequency count as standstill. */
static const double STANDSTILL = 1e-3;
/* Relative residuals below this are rounding. */
static const double ROUNDING = 1e-11;

/* Repetitions of several periods are accepted only after these: oscillating transients resemble them. */
enum { LEAST_PERIODS = 24 };
/* Batches of an irregular motion's mean; fewest periods of an irregular motion. */
enum { BATCHES = 8, LEAST_IRREGULAR = 256 };
static const double STUDENT_7 = 2.365, STUDENT_6 = 2.447; /* 95 %, two-sided */

/* Periods over which a motion must creep; changes over half of them by this factor begin or end a motion. */
enum { CREEP_PERIODS = 3 * BATCHES };
static const double CREEP_CHANGE = 1.5;
/* Part of the velocity below which motions creep; repetitions of several periods must agree to the other. */
static const double CREEP_DIFFERENCE = 0.025;

/* Equal growth factors in a row that prove growth. */
enum { GROWTH_FACTORS = 3 };

strut_status strut_steady_detector_create(const strut_model *model, const strut_steady *wanted,
                                          double period, double begin,
                                          strut_steady_detector *detector) {
  size_t both = 2 * (size_t)model->length;
  assert(period > 0.0);
  *detector = (strut_steady_detector){.model = model,
                                      .period = period,
                                      .rules.tolerance = wanted->tolerance,
                                      .rules.floor = wanted->floor,
                                      .rules.mean_tolerance = wanted->mean_tolerance > 0.0
                                                                  ? wanted->mean_tolerance
                                                                  : wanted->tolerance,
                                      .rules.successive = wanted->successive,
                                      .rules.creep = wanted->creep,
                                      .rules.creep_after = wanted->creep_after,
                                      .drift.stride = 1};
  detector->rules.not_before = (strut_scene_last_signal_event(model->scene) - begin) / period;
  if (detector->rules.successive < 2) detector->rules.successive = 2;
  if (detector->rules.successive > STRUT_RING / 2) detector->rules.successive = STRUT_RING / 2;
  if (!(detector->rules.floor > 0.0))
    detector->rules.floor = STANDSTILL * model->size / period * detector->rules.tolerance;
  detector->travels = strut_model_travels(model);
  bool ready = STRUT_NUMBERS(&detector->arena, both, &detector->latest.middle);
  for (int k = 0; k < STRUT_RING && ready; k++)
    ready = STRUT_NUMBERS(&detector->arena, both, &detector->latest.state[k]);
  detector->rules.least_irregular =
      wanted->mean_tolerance > 0.0 ? LEAST_IRREGULAR / 2 : LEAST_IRREGULAR;
  detector->result.kind = STRUT_MOTION_TRANSIENT;
  if (ready) return STRUT_OK;
  strut_steady_detector_free(detector);
  return STRUT_NO_MEMORY;
}

static void copy_state(const strut_state *state, const strut_steady_detector *detector,
                       double *out) {
  size_t length = (size_t)detector->model->length;
  memcpy(out, state->q, length * sizeof *out);
  memcpy(out + length, state->v, length * sizeof *out);
}

/* Mean shift along the ground between two states; 0 where the structure cannot travel. */
static double mean_travel(const strut_steady_detector *detector, const double *from,
                          const double *to) {
  const double *t = detector->model->contacts.tangent;
  double sum = 0.0;
  int32_t n = detector->model->node_count;
  for (int32_t i = 0; i < n && detector->travels; i++)
    sum += (to[2 * i] - from[2 * i]) * t[0] + (to[2 * i + 1] - from[2 * i + 1]) * t[1];
  return n > 0 ? sum / n : 0.0;
}

/* Largest difference of two shapes: positions over the size, velocities over size times 2 pi f. */
static double shape_distance(const strut_steady_detector *detector, const double *first,
                             const double *second) {
  const double *t = detector->model->contacts.tangent;
  double along = mean_travel(detector, first, second), shift[2] = {along * t[0], along * t[1]};
  double size = detector->model->size, speed = size * STRUT_TAU / detector->period, most = 0.0;
  int32_t length = detector->model->length;
  for (int32_t i = 0; i < 2 * detector->model->node_count; i++) {
    most = fmax(most, fabs(second[i] - first[i] - (detector->travels ? shift[i % 2] : 0.0)) / size);
    most = fmax(most, fabs(second[length + i] - first[length + i]) / speed);
  }
  return most;
}

void strut_steady_detector_half_period(const strut_state *state, strut_steady_detector *detector) {
  copy_state(state, detector, detector->latest.middle);
}

/* The rest of a decay: the geometric series of the latest change, at a rate by whole repetitions. */
static double remaining_decay(const double *residual, int64_t now, int32_t n, int32_t over,
                              double amplitude) {
  int32_t rounds = (over + n - 1) / n;
  double last = residual[now % STRUT_RING], first = residual[(now - n * rounds) % STRUT_RING];
  if (last <= ROUNDING * amplitude) return 0.0;
  if (!(first > 0.0)) return HUGE_VAL;
  double rate = pow(last / first, 1.0 / rounds);
  return rate < 0.9999 ? rate / (1.0 - rate) : HUGE_VAL;
}

/* Change of coordinate i without the mean travel `along`, in sizes, and of its velocity in sizes times 2 pi f. */
static double scaled_change(const strut_steady_detector *detector, const double *first,
                            const double *second, double along, int32_t i, double *speed) {
  int32_t length = detector->model->length;
  double shift = detector->travels ? along * detector->model->contacts.tangent[i % 2] : 0.0;
  *speed = (first[length + i] - second[length + i]) * detector->period /
           (detector->model->size * STRUT_TAU);
  return (first[i] - second[i] - shift) / detector->model->size;
}

/*
 * Distance of the present state from the limit of its repetitions, if each is the same combination
 * of the two before: true of a decay, and of a slow beat, whose changes may fall for a while and
 * grow again.
 */
static double distance_to_limit(const strut_steady_detector *detector, int64_t now, int32_t n) {
  const double *at[4];
  double along[3], sum[2][3] = {{0.0}};
  int32_t coordinates = 2 * detector->model->node_count;
  for (int k = 0; k < 4; k++) at[k] = detector->latest.state[(now - k * n) % STRUT_RING];
  for (int k = 0; k < 3; k++) along[k] = mean_travel(detector, at[k + 1], at[k]);
  for (int32_t i = 0; i < coordinates; i++) {
    double d[3], v[3];
    for (int k = 0; k < 3; k++)
      d[k] = scaled_change(detector, at[k], at[k + 1], along[k], i, &v[k]);
    for (int r = 0; r < 2; r++)
      for (int c = 0; c < 3; c++) sum[r][c] += d[r + 1] * d[c] + v[r + 1] * v[c];
  }
  double both = sum[0][1] * sum[1][2], mixed = sum[0][2] * sum[1][1], det = both - mixed;
  double p = sum[0][1] > 0.0 ? sum[0][0] / sum[0][1] : 0.0, q = 0.0;
  if (det > 1e-14 * both) {
    p = (sum[0][0] * sum[1][2] - sum[1][0] * sum[0][2]) / det;
    q = (sum[1][0] * sum[0][1] - sum[0][0] * sum[1][1]) / det;
  }
  double most = 0.0;
  for (int32_t i = 0; i < coordinates; i++) {
    double v0, v1, d0 = scaled_change(detector, at[0], at[1], along[0], i, &v0);
    double d1 = scaled_change(detector, at[1], at[2], along[1], i, &v1);
    most = fmax(most, fmax(fabs((p + q) * d0 + q * d1), fabs((p + q) * v0 + q * v1)));
  }
  return most / fabs(1.0 - p - q);
}

/* Does a coordinate of the seemingly steady motion grow, by a constant factor each time? */
static bool something_grows(const strut_steady_detector *detector, int64_t now, int32_t n) {
  const double *at[GROWTH_FACTORS + 2];
  double along[GROWTH_FACTORS + 1];
  if (now < (GROWTH_FACTORS + 1) * n || (GROWTH_FACTORS + 1) * n >= STRUT_RING) return false;
  for (int k = 0; k < GROWTH_FACTORS + 2; k++)
    at[k] = detector->latest.state[(now - k * n) % STRUT_RING];
  for (int k = 0; k < GROWTH_FACTORS + 1; k++) along[k] = mean_travel(detector, at[k + 1], at[k]);
  for (int32_t i = 0; i < 2 * detector->model->node_count; i++) {
    double d[GROWTH_FACTORS + 1], v, least = HUGE_VAL, most = 0.0;
    for (int k = 0; k < GROWTH_FACTORS + 1; k++)
      d[k] = fabs(scaled_change(detector, at[k], at[k + 1], along[k], i, &v));
    for (int k = 0; k < GROWTH_FACTORS; k++) {
      double factor = d[k + 1] > 0.0 ? d[k] / d[k + 1] : 0.0;
      least = fmin(least, factor), most = fmax(most, factor);
    }
    bool above_rounding = d[GROWTH_FACTORS] > ROUNDING * detector->latest.amplitude;
    if (above_rounding && least > 1.0 && most - 1.0 < 1.25 * (least - 1.0)) return true;
  }
  return false;
}

static double mean_velocity(const strut_steady_detector *detector, int64_t now, int32_t periods) {
  double dx = detector->latest.place[now % STRUT_RING] -
              detector->latest.place[(now - periods) % STRUT_RING];
  return dx / (periods * detector->period);
}

/* Do neighbouring periods still approach each other? A transient may seem to repeat itself after n of them. */
static bool still_decays(const strut_steady_detector *detector, int64_t now, int32_t n) {
  int32_t over = 2 * n > detector->rules.successive ? 2 * n : detector->rules.successive;
  if (now <= over + n) return true;
  double last = 0.0, first = 0.0; /* means over n periods, whose order then does not matter */
  for (int32_t j = 0; j < n; j++) {
    last += detector->latest.residual[0][(now - j) % STRUT_RING];
    first += detector->latest.residual[0][(now - over - j) % STRUT_RING];
  }
  return last < pow(0.99, over) * first;
}

/*
 * Change of the velocity [m/s] that counts as none. Any change of a creeping motion is below a loose floor,
 * so that it would soon seem to repeat itself after one of the several numbers of periods that are tried.
 */
static double allowed_change(const strut_steady_detector *detector, double velocity, int32_t n) {
  double allowed = fmax(detector->rules.tolerance * fabs(velocity), detector->rules.floor);
  bool slow = detector->rules.creep > 0.0 && fabs(velocity) <= detector->rules.creep;
  return slow && n > 1 ? fmin(allowed, CREEP_DIFFERENCE * detector->rules.creep) : allowed;
}

/* Does the motion repeat itself every n periods? */
static bool repeats_itself(strut_steady_detector *detector, int64_t now, int k) {
  int32_t n = repeats[k], over = detector->rules.successive;
  if (now < 2 * n + over || (double)now < detector->rules.not_before + n + over) return false;
  if (!strut_scene_signals_repeat(detector->model->scene, n * detector->period)) return false;
  if (n > 1 && (now < LEAST_PERIODS + 4 * n || still_decays(detector, now, n))) return false;
  int32_t rounds = n * ((over + n - 1) / n);
  double velocity = mean_velocity(detector, now, rounds), change = 0.0;
  for (int64_t j = now - over + 1; j <= now; j++)
    change = fmax(change, detector->latest.change[k][j % STRUT_RING]);
  double rest =
      remaining_decay(detector->latest.residual[k], now, n, over, detector->latest.amplitude);
  double allowed = allowed_change(detector, velocity, n);
  double residual = detector->latest.residual[k][now % STRUT_RING];
  double still = detector->rules.floor * detector->period / detector->model->size;
  if (!(change <= allowed && change * rest <= allowed)) return false;
  /* n > 1 must meet a stricter limit, since a transient may seem to repeat */
  double alike =
      (n > 1 ? 1.0 : 4.0) * fmax(detector->rules.tolerance * detector->latest.amplitude, still);
  if (!(residual * fmax(rest, 1.0) <= alike)) return false;
  if (residual > ROUNDING * detector->latest.amplitude) {
    if (something_grows(detector, now, n)) return false;
    rest = fmax(rest, distance_to_limit(detector, now, n) / residual);
    if (!(change * rest <= allowed && residual * rest <= alike)) return false;
  }
  /* an irregular motion may return by chance, but not repeatedly */
  int32_t often = n > 1 && 2 * n > over ? 2 * n : over;
  for (int64_t j = now - often + 1; j <= now; j++)
    if (detector->latest.residual[k][j % STRUT_RING] > (n > 1 ? alike : 4.0 * alike)) return false;
  detector->result.kind = STRUT_MOTION_PERIODIC;
  detector->result.repeats = n;
  detector->result.periods = now;
  detector->result.interval = change * (1.0 + rest), detector->result.left = rest;
  detector->result.residual =
      detector->latest.amplitude > 0.0 ? residual / detector->latest.amplitude : 0.0;
  return true;
}

/*
 * Is the mean velocity of the latest periods, with its confidence interval, slower than matters? A motion
 * that sets in would show in growing changes of the shape, one that will repeat itself in falling ones.
 */
static bool creeps(strut_steady_detector *detector, int64_t now) {
  if (!(detector->rules.creep > 0.0) || !detector->travels || now < CREEP_PERIODS ||
      now < detector->rules.creep_after || (double)now < detector->rules.not_before + CREEP_PERIODS)
    return false;
  if (!strut_scene_signals_repeat(detector->model->scene, detector->period)) return false;
  double mean = mean_velocity(detector, now, CREEP_PERIODS), square = 0.0, changes[2] = {0.0};
  for (int i = 0; i < BATCHES; i++) {
    double speed = mean_velocity(detector, now - 3 * i, 3);
    square += (speed - mean) * (speed - mean);
  }
  for (int j = 0; j < CREEP_PERIODS; j++)
    changes[2 * j / CREEP_PERIODS] += detector->latest.residual[0][(now - j) % STRUT_RING];
  double interval = STUDENT_7 * sqrt(square / (BATCHES - 1) / BATCHES);
  if (!(fabs(mean) + interval <= detector->rules.creep)) return false;
  if (changes[0] > CREEP_CHANGE * changes[1] || changes[1] > CREEP_CHANGE * changes[0])
    return false;
  detector->result.kind = STRUT_MOTION_CREEPING;
  detector->result.periods = now;
  detector->result.interval = interval;
  detector->velocity = mean;
  return true;
}

/* Stores the position at equal intervals over the whole run, which double when the marks are full. */
static void add_mark(strut_steady_detector *detector, int64_t now, double x) {
  detector->drift.wander += now > 0 ? detector->latest.residual[0][now % STRUT_RING] : 0.0;
  if (now % detector->drift.stride != 0) return;
  if (detector->drift.marks == STRUT_MARKS) {
    for (int32_t i = 0; 2 * i < STRUT_MARKS; i++)
      detector->drift.mark[i] = detector->drift.mark[2 * i],
      detector->drift.wandered[i] = detector->drift.wandered[2 * i];
    detector->drift.marks = (STRUT_MARKS + 1) / 2;
    detector->drift.stride *= 2;
    if (now % detector->drift.stride != 0) return;
  }
  detector->drift.mark[detector->drift.marks] = x;
  detector->drift.wandered[detector->drift.marks++] = detector->drift.wander;
}

/* Mean velocity over the latest 8 batches of `each` intervals, its interval by Student's t, t value of its trend. */
static double batch_mean(const strut_steady_detector *detector, int32_t each, double *interval,
                         double *trend) {
  double speed[BATCHES], mean = 0.0, square = 0.0, slope = 0.0;
  double time = each * (double)detector->drift.stride * detector->period;
  for (int i = 0; i < BATCHES; i++) {
    int32_t to = detector->drift.marks - 1 - i * each;
    speed[i] = (detector->drift.mark[to] - detector->drift.mark[to - each]) / time;
    mean += speed[i] / BATCHES;
  }
  for (int i = 0; i < BATCHES; i++) {
    square += (speed[i] - mean) * (speed[i] - mean);
    slope += speed[i] * (0.5 * (BATCHES - 1) - i) / 42.0;
  }
  double rest = fmax(square - 42.0 * slope * slope, 0.0) / (BATCHES - 2);
  *trend = rest > 0.0 ? fabs(slope) / sqrt(rest / 42.0) : slope != 0.0 ? HUGE_VAL : 0.0;
  *interval = STUDENT_7 * sqrt(square / (BATCHES - 1) / BATCHES);
  return mean;
}

/* Do neighbouring periods differ as much in the latest 8 batches as in the 8 before, to 2 % or their scatter? */
static bool wanders_evenly(const strut_steady_detector *detector, int32_t each) {
  double sum[2] = {0.0, 0.0}, square[2] = {0.0, 0.0};
  for (int i = 0; i < 2 * BATCHES; i++) {
    int32_t to = detector->drift.marks - 1 - i * each;
    double part = detector->drift.wandered[to] - detector->drift.wandered[to - each];
    sum[i / BATCHES] += part, square[i / BATCHES] += part * part;
  }
  double scatter = 0.0;
  for (int k = 0; k < 2; k++)
    scatter += fmax(0.0, square[k] - sum[k] * sum[k] / BATCHES) * BATCHES / (BATCHES - 1);
  double differ = fabs(sum[0] - sum[1]);
  return sum[1] > 0.0 && (differ <= 0.02 * sum[1] || differ <= STUDENT_7 * sqrt(scatter));
}

/*
 * The mean over the latter half of a run that has not repeated itself, which batches and the last quarter confirm. The
 * motion is irregular where these are equal, without trend, with an even difference between neighbouring periods.
 */
static void judge_irregular(strut_steady_detector *detector) {
  int32_t stretches = detector->drift.marks - 1, half = stretches / 2 / BATCHES, quarter = half / 2;
  int64_t seen = detector->latest.seen - 1;
  detector->result.mean = detector->velocity, detector->result.scatter = HUGE_VAL;
  if (quarter < 1) return;
  double wide, narrow, trend, other;
  double mean = batch_mean(detector, half, &wide, &trend),
         late = batch_mean(detector, quarter, &narrow, &other);
  detector->result.mean = mean, detector->result.scatter = fmax(wide, fabs(mean - late) - narrow);
  if (seen < detector->rules.least_irregular || (double)seen < 2.0 * detector->rules.not_before)
    return;
  double times = detector->rules.mean_tolerance / detector->rules.tolerance;
  double allowed = fmax(detector->rules.mean_tolerance * fabs(mean), detector->rules.floor * times);
  if (wide > allowed || narrow > 2.0 * allowed || trend > STUDENT_6) return;
  if (fabs(mean - late) > wide + narrow) return;
  if (!wanders_evenly(detector, quarter)) return;
  detector->result.kind = STRUT_MOTION_IRREGULAR;
  detector->result.interval = wide + fabs(mean - late);
  detector->velocity = mean;
}

bool strut_steady_detector_period(const strut_state *state, double x,
                                  strut_steady_detector *detector) {
  int64_t now = detector->latest.seen++;
  double *latest = detector->latest.state[now % STRUT_RING];
  copy_state(state, detector, latest);
  detector->latest.place[now % STRUT_RING] = x;
  if (now > 0)
    detector->latest.amplitude = shape_distance(detector, detector->latest.middle, latest);
  for (int k = 0; k < STRUT_REPEATS && now >= repeats[k]; k++) {
    int32_t n = repeats[k];
    detector->latest.residual[k][now % STRUT_RING] =
        shape_distance(detector, detector->latest.state[(now - n) % STRUT_RING], latest);
    if (now < 2 * n) continue;
    detector->latest.change[k][now % STRUT_RING] =
        fabs(mean_velocity(detector, now, n) - mean_velocity(detector, now - n, n));
  }
  if (now > 0)
    detector->result.fastest =
        fmax(detector->result.fastest, detector->latest.residual[0][now % STRUT_RING]);
  if (!detector->known) add_mark(detector, now, x);
  for (int k = 0; k < STRUT_REPEATS && !detector->known; k++)
    detector->known = repeats_itself(detector, now, k);
  if (!detector->known && creeps(detector, now)) detector->known = true;
  if (detector->result.kind == STRUT_MOTION_CREEPING) return true;
  int32_t n = detector->known ? detector->result.repeats : 1;
  int32_t rounds = n * ((detector->rules.successive + n - 1) / n);
  if (now >= rounds) detector->velocity = mean_velocity(detector, now, rounds);
  return detector->known;
}

void strut_steady_detector_finish(strut_steady_detector *detector, strut_summary *summary) {
  if (!detector->known) judge_irregular(detector);
  detector->result.motion = detector->latest.amplitude;
  summary->steady = detector->result;
  if (!detector->known) {
    summary->steady.periods = detector->latest.seen > 0 ? detector->latest.seen - 1 : 0;
    if (detector->result.kind == STRUT_MOTION_IRREGULAR) summary->velocity = detector->velocity;
    return;
  }
  int64_t now = detector->latest.seen - 1;
  double square = 0.0;
  for (int32_t j = 0; j < detector->rules.successive; j++) {
    double d = mean_velocity(detector, now - j, 1) - detector->velocity;
    square += d * d;
  }
  summary->velocity = detector->velocity;
  summary->velocity_spread = sqrt(square / (detector->rules.successive - 1));
}

void strut_steady_detector_free(strut_steady_detector *detector) {
  strut_arena_free(&detector->arena);
}
