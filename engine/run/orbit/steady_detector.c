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

/*
 * Repetitions of more than one period are accepted only after these, since oscillating transients
 * resemble them.
 */
enum { LEAST_PERIODS = 24 };
/* Batches of an irregular motion's mean; fewest periods of an irregular motion. */
enum { BATCHES = 8, LEAST_IRREGULAR = 256 };
static const double STUDENT_7 = 2.365, STUDENT_6 = 2.447; /* 95 %, two-sided */

/*
 * Periods over which a motion must creep, in batches of three; factor of its changes over half of them that
 * is the beginning of another motion, or the end of a transient.
 */
enum { CREEP_PERIODS = 3 * BATCHES };
static const double CREEP_CHANGE = 1.5;
/*
 * Part of the velocity below which motions creep. One that slow repeats itself after several periods only
 * where its velocities differ by less than this part.
 */
static const double CREEP_DIFFERENCE = 0.025;

/* Equal growth factors in a row that prove growth. */
enum { GROWTH_FACTORS = 3 };

/* Do all unlimited signals repeat themselves after n drive periods? */
static bool drives_repeat(const strut_steady_detector *w, int32_t n) {
  const strut_scene *scene = w->model->scene;
  for (size_t i = 0; i < scene->signal_count; i++) {
    const strut_signal *s = &scene->signals[i];
    if ((s->kind != STRUT_SINE && s->kind != STRUT_SQUARE) || isfinite(s->stop)) continue;
    double turns = n * w->period * s->frequency;
    if (fabs(turns - round(turns)) > 1e-9 * fmax(1.0, turns)) return false;
  }
  return true;
}

strut_status strut_steady_detector_create(const strut_model *model, const strut_steady *wanted,
                                          double period, double begin, strut_steady_detector *w) {
  size_t both = 2 * (size_t)model->length;
  assert(period > 0.0);
  *w = (strut_steady_detector){.model = model,
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
  w->rules.not_before = (strut_scene_last_signal_event(model->scene) - begin) / period;
  if (w->rules.successive < 2) w->rules.successive = 2;
  if (w->rules.successive > STRUT_RING / 2) w->rules.successive = STRUT_RING / 2;
  if (!(w->rules.floor > 0.0))
    w->rules.floor = STANDSTILL * model->size / period * w->rules.tolerance;
  w->travels = strut_contacts_allow_travel(&model->contacts);
  for (int32_t i = 0; i < 2 * model->node_count; i++) w->travels = w->travels && !model->fixed[i];
  bool ready = (w->latest.middle = strut_arena_allocate(&w->arena, both, sizeof(double)));
  for (int k = 0; k < STRUT_RING && ready; k++)
    ready = (w->latest.state[k] = strut_arena_allocate(&w->arena, both, sizeof(double)));
  w->rules.least_irregular = wanted->mean_tolerance > 0.0 ? LEAST_IRREGULAR / 2 : LEAST_IRREGULAR;
  w->result.kind = STRUT_MOTION_TRANSIENT;
  if (ready) return STRUT_OK;
  strut_steady_detector_free(w);
  return STRUT_NO_MEMORY;
}

static void copy_state(const strut_state *state, const strut_steady_detector *w, double *out) {
  size_t length = (size_t)w->model->length;
  memcpy(out, state->q, length * sizeof *out);
  memcpy(out + length, state->v, length * sizeof *out);
}

/* Mean shift along the ground between two states; 0 where the structure cannot travel. */
static double mean_travel(const strut_steady_detector *w, const double *from, const double *to) {
  const double *t = w->model->contacts.tangent;
  double sum = 0.0;
  int32_t n = w->model->node_count;
  for (int32_t i = 0; i < n && w->travels; i++)
    sum += (to[2 * i] - from[2 * i]) * t[0] + (to[2 * i + 1] - from[2 * i + 1]) * t[1];
  return n > 0 ? sum / n : 0.0;
}

/* Largest difference of two shapes: positions over the size, velocities over size times 2 pi f. */
static double shape_distance(const strut_steady_detector *w, const double *a, const double *b) {
  const double *t = w->model->contacts.tangent;
  double along = mean_travel(w, a, b), shift[2] = {along * t[0], along * t[1]};
  double size = w->model->size, speed = size * STRUT_TAU / w->period, most = 0.0;
  int32_t length = w->model->length;
  for (int32_t i = 0; i < 2 * w->model->node_count; i++) {
    most = fmax(most, fabs(b[i] - a[i] - (w->travels ? shift[i % 2] : 0.0)) / size);
    most = fmax(most, fabs(b[length + i] - a[length + i]) / speed);
  }
  return most;
}

void strut_steady_detector_half_period(const strut_state *state, strut_steady_detector *w) {
  copy_state(state, w, w->latest.middle);
}

/*
 * The rest of a decay: the geometric series that continues the latest change. The rate follows from
 * whole repetitions, since changes differ between the periods of one.
 */
static double remaining_decay(const double *residual, int64_t now, int32_t n, int32_t over,
                              double amplitude) {
  int32_t rounds = (over + n - 1) / n;
  double last = residual[now % STRUT_RING], first = residual[(now - n * rounds) % STRUT_RING];
  if (last <= ROUNDING * amplitude) return 0.0;
  if (!(first > 0.0)) return HUGE_VAL;
  double rate = pow(last / first, 1.0 / rounds);
  return rate < 0.9999 ? rate / (1.0 - rate) : HUGE_VAL;
}

/*
 * Change from b to a of coordinate i without the mean travel `along`, in sizes, and of its velocity
 * in sizes times 2 pi f.
 */
static double scaled_change(const strut_steady_detector *w, const double *a, const double *b,
                            double along, int32_t i, double *speed) {
  int32_t length = w->model->length;
  double shift = w->travels ? along * w->model->contacts.tangent[i % 2] : 0.0;
  *speed = (a[length + i] - b[length + i]) * w->period / (w->model->size * STRUT_TAU);
  return (a[i] - b[i] - shift) / w->model->size;
}

/*
 * Distance of the present state from the limit of its repetitions, if each is the same combination
 * of the two before: true of a decay, and of a slow beat, whose changes may fall for a while and
 * grow again.
 */
static double distance_to_limit(const strut_steady_detector *w, int64_t now, int32_t n) {
  const double *at[4];
  double along[3], sum[2][3] = {{0.0}};
  int32_t coordinates = 2 * w->model->node_count;
  for (int k = 0; k < 4; k++) at[k] = w->latest.state[(now - k * n) % STRUT_RING];
  for (int k = 0; k < 3; k++) along[k] = mean_travel(w, at[k + 1], at[k]);
  for (int32_t i = 0; i < coordinates; i++) {
    double d[3], v[3];
    for (int k = 0; k < 3; k++) d[k] = scaled_change(w, at[k], at[k + 1], along[k], i, &v[k]);
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
    double v0, v1, d0 = scaled_change(w, at[0], at[1], along[0], i, &v0);
    double d1 = scaled_change(w, at[1], at[2], along[1], i, &v1);
    most = fmax(most, fmax(fabs((p + q) * d0 + q * d1), fabs((p + q) * v0 + q * v1)));
  }
  return most / fabs(1.0 - p - q);
}

/*
 * Does a coordinate of the seemingly steady motion grow? Its changes then increase by a constant
 * factor each time; mere variation has none.
 */
static bool something_grows(const strut_steady_detector *w, int64_t now, int32_t n) {
  const double *at[GROWTH_FACTORS + 2];
  double along[GROWTH_FACTORS + 1];
  if (now < (GROWTH_FACTORS + 1) * n || (GROWTH_FACTORS + 1) * n >= STRUT_RING) return false;
  for (int k = 0; k < GROWTH_FACTORS + 2; k++) at[k] = w->latest.state[(now - k * n) % STRUT_RING];
  for (int k = 0; k < GROWTH_FACTORS + 1; k++) along[k] = mean_travel(w, at[k + 1], at[k]);
  for (int32_t i = 0; i < 2 * w->model->node_count; i++) {
    double d[GROWTH_FACTORS + 1], v, least = HUGE_VAL, most = 0.0;
    for (int k = 0; k < GROWTH_FACTORS + 1; k++)
      d[k] = fabs(scaled_change(w, at[k], at[k + 1], along[k], i, &v));
    for (int k = 0; k < GROWTH_FACTORS; k++) {
      double factor = d[k + 1] > 0.0 ? d[k] / d[k + 1] : 0.0;
      least = fmin(least, factor), most = fmax(most, factor);
    }
    bool above_rounding = d[GROWTH_FACTORS] > ROUNDING * w->latest.amplitude;
    if (above_rounding && least > 1.0 && most - 1.0 < 1.25 * (least - 1.0)) return true;
  }
  return false;
}

static double mean_velocity(const strut_steady_detector *w, int64_t now, int32_t periods) {
  double dx = w->latest.place[now % STRUT_RING] - w->latest.place[(now - periods) % STRUT_RING];
  return dx / (periods * w->period);
}

/*
 * Do neighbouring periods still approach each other? A transient may seem to repeat itself after n
 * of them.
 */
static bool still_decays(const strut_steady_detector *w, int64_t now, int32_t n) {
  int32_t over = 2 * n > w->rules.successive ? 2 * n : w->rules.successive;
  if (now <= over + n) return true;
  double last = 0.0, first = 0.0; /* means over n periods, whose order then does not matter */
  for (int32_t j = 0; j < n; j++) {
    last += w->latest.residual[0][(now - j) % STRUT_RING];
    first += w->latest.residual[0][(now - over - j) % STRUT_RING];
  }
  return last < pow(0.99, over) * first;
}

/*
 * Change of the velocity [m/s] that counts as none. Any change of a creeping motion is below a loose floor,
 * so that it would soon seem to repeat itself after one of the several numbers of periods that are tried.
 */
static double allowed_change(const strut_steady_detector *w, double velocity, int32_t n) {
  double allowed = fmax(w->rules.tolerance * fabs(velocity), w->rules.floor);
  bool slow = w->rules.creep > 0.0 && fabs(velocity) <= w->rules.creep;
  return slow && n > 1 ? fmin(allowed, CREEP_DIFFERENCE * w->rules.creep) : allowed;
}

/* Does the motion repeat itself every n periods? */
static bool repeats_itself(strut_steady_detector *w, int64_t now, int k) {
  int32_t n = repeats[k], over = w->rules.successive;
  if (now < 2 * n + over || (double)now < w->rules.not_before + n + over) return false;
  if (!drives_repeat(w, n)) return false;
  if (n > 1 && (now < LEAST_PERIODS + 4 * n || still_decays(w, now, n))) return false;
  int32_t rounds = n * ((over + n - 1) / n);
  double velocity = mean_velocity(w, now, rounds), change = 0.0;
  for (int64_t j = now - over + 1; j <= now; j++)
    change = fmax(change, w->latest.change[k][j % STRUT_RING]);
  double rest = remaining_decay(w->latest.residual[k], now, n, over, w->latest.amplitude);
  double allowed = allowed_change(w, velocity, n);
  double residual = w->latest.residual[k][now % STRUT_RING];
  double still = w->rules.floor * w->period / w->model->size;
  if (!(change <= allowed && change * rest <= allowed)) return false;
  /* n > 1 must meet a stricter limit, since a transient may seem to repeat */
  double alike = (n > 1 ? 1.0 : 4.0) * fmax(w->rules.tolerance * w->latest.amplitude, still);
  if (!(residual * fmax(rest, 1.0) <= alike)) return false;
  if (residual > ROUNDING * w->latest.amplitude) {
    if (something_grows(w, now, n)) return false;
    rest = fmax(rest, distance_to_limit(w, now, n) / residual);
    if (!(change * rest <= allowed && residual * rest <= alike)) return false;
  }
  /* an irregular motion may return by chance, but not repeatedly */
  int32_t often = n > 1 && 2 * n > over ? 2 * n : over;
  for (int64_t j = now - often + 1; j <= now; j++)
    if (w->latest.residual[k][j % STRUT_RING] > (n > 1 ? alike : 4.0 * alike)) return false;
  w->result.kind = STRUT_MOTION_PERIODIC;
  w->result.repeats = n;
  w->result.periods = now;
  w->result.interval = change * (1.0 + rest);
  w->result.residual = w->latest.amplitude > 0.0 ? residual / w->latest.amplitude : 0.0;
  return true;
}

/*
 * Is the mean velocity of the latest periods, with its confidence interval, slower than matters? A motion
 * that sets in would show in growing changes of the shape, one that will repeat itself in falling ones.
 */
static bool creeps(strut_steady_detector *w, int64_t now) {
  if (!(w->rules.creep > 0.0) || !w->travels || now < CREEP_PERIODS || now < w->rules.creep_after ||
      (double)now < w->rules.not_before + CREEP_PERIODS)
    return false;
  if (!drives_repeat(w, 1)) return false;
  double mean = mean_velocity(w, now, CREEP_PERIODS), square = 0.0, changes[2] = {0.0};
  for (int i = 0; i < BATCHES; i++) {
    double speed = mean_velocity(w, now - 3 * i, 3);
    square += (speed - mean) * (speed - mean);
  }
  for (int j = 0; j < CREEP_PERIODS; j++)
    changes[2 * j / CREEP_PERIODS] += w->latest.residual[0][(now - j) % STRUT_RING];
  double interval = STUDENT_7 * sqrt(square / (BATCHES - 1) / BATCHES);
  if (!(fabs(mean) + interval <= w->rules.creep)) return false;
  if (changes[0] > CREEP_CHANGE * changes[1] || changes[1] > CREEP_CHANGE * changes[0])
    return false;
  w->result.kind = STRUT_MOTION_CREEPING;
  w->result.periods = now;
  w->result.interval = interval;
  w->velocity = mean;
  return true;
}

/*
 * Stores the position at equal intervals over the whole run, which double when the marks are full.
 */
static void add_mark(strut_steady_detector *w, int64_t now, double x) {
  w->drift.wander += now > 0 ? w->latest.residual[0][now % STRUT_RING] : 0.0;
  if (now % w->drift.stride != 0) return;
  if (w->drift.marks == STRUT_MARKS) {
    for (int32_t i = 0; 2 * i < STRUT_MARKS; i++)
      w->drift.mark[i] = w->drift.mark[2 * i], w->drift.wandered[i] = w->drift.wandered[2 * i];
    w->drift.marks = (STRUT_MARKS + 1) / 2;
    w->drift.stride *= 2;
    if (now % w->drift.stride != 0) return;
  }
  w->drift.mark[w->drift.marks] = x;
  w->drift.wandered[w->drift.marks++] = w->drift.wander;
}

/*
 * Mean velocity over the latest 8 batches of `each` intervals, its confidence interval by Student's
 * t, and the t value of its trend.
 */
static double batch_mean(const strut_steady_detector *w, int32_t each, double *interval,
                         double *trend) {
  double speed[BATCHES], mean = 0.0, square = 0.0, slope = 0.0;
  double time = each * (double)w->drift.stride * w->period;
  for (int i = 0; i < BATCHES; i++) {
    int32_t to = w->drift.marks - 1 - i * each;
    speed[i] = (w->drift.mark[to] - w->drift.mark[to - each]) / time;
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

/*
 * Is the mean difference of neighbouring periods the same in the latest 8 batches of `each`
 * intervals as in the 8 before, to 2 % or within the scatter of the batches?
 */
static bool wanders_evenly(const strut_steady_detector *w, int32_t each) {
  double sum[2] = {0.0, 0.0}, square[2] = {0.0, 0.0};
  for (int i = 0; i < 2 * BATCHES; i++) {
    int32_t to = w->drift.marks - 1 - i * each;
    double part = w->drift.wandered[to] - w->drift.wandered[to - each];
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
static void judge_irregular(strut_steady_detector *w) {
  int32_t stretches = w->drift.marks - 1, half = stretches / 2 / BATCHES, quarter = half / 2;
  int64_t seen = w->latest.seen - 1;
  w->result.mean = w->velocity, w->result.scatter = HUGE_VAL;
  if (quarter < 1) return;
  double wide, narrow, trend, other;
  double mean = batch_mean(w, half, &wide, &trend), late = batch_mean(w, quarter, &narrow, &other);
  w->result.mean = mean, w->result.scatter = fmax(wide, fabs(mean - late) - narrow);
  if (seen < w->rules.least_irregular || (double)seen < 2.0 * w->rules.not_before) return;
  double times = w->rules.mean_tolerance / w->rules.tolerance;
  double allowed = fmax(w->rules.mean_tolerance * fabs(mean), w->rules.floor * times);
  if (wide > allowed || narrow > 2.0 * allowed || trend > STUDENT_6) return;
  if (fabs(mean - late) > wide + narrow) return;
  if (!wanders_evenly(w, quarter)) return;
  w->result.kind = STRUT_MOTION_IRREGULAR;
  w->result.interval = wide + fabs(mean - late);
  w->velocity = mean;
}

bool strut_steady_detector_period(const strut_state *state, double x, strut_steady_detector *w) {
  int64_t now = w->latest.seen++;
  double *latest = w->latest.state[now % STRUT_RING];
  copy_state(state, w, latest);
  w->latest.place[now % STRUT_RING] = x;
  if (now > 0) w->latest.amplitude = shape_distance(w, w->latest.middle, latest);
  for (int k = 0; k < STRUT_REPEATS && now >= repeats[k]; k++) {
    int32_t n = repeats[k];
    w->latest.residual[k][now % STRUT_RING] =
        shape_distance(w, w->latest.state[(now - n) % STRUT_RING], latest);
    if (now < 2 * n) continue;
    w->latest.change[k][now % STRUT_RING] =
        fabs(mean_velocity(w, now, n) - mean_velocity(w, now - n, n));
  }
  if (!w->known) add_mark(w, now, x);
  for (int k = 0; k < STRUT_REPEATS && !w->known; k++) w->known = repeats_itself(w, now, k);
  if (!w->known && creeps(w, now)) w->known = true;
  if (w->result.kind == STRUT_MOTION_CREEPING) return true;
  int32_t n = w->known ? w->result.repeats : 1;
  int32_t rounds = n * ((w->rules.successive + n - 1) / n);
  if (now >= rounds) w->velocity = mean_velocity(w, now, rounds);
  return w->known;
}

void strut_steady_detector_finish(strut_steady_detector *w, strut_summary *summary) {
  if (!w->known) judge_irregular(w);
  summary->steady = w->result;
  if (!w->known) {
    summary->steady.periods = w->latest.seen > 0 ? w->latest.seen - 1 : 0;
    if (w->result.kind == STRUT_MOTION_IRREGULAR) summary->velocity = w->velocity;
    return;
  }
  int64_t now = w->latest.seen - 1;
  double square = 0.0;
  for (int32_t j = 0; j < w->rules.successive; j++) {
    double d = mean_velocity(w, now - j, 1) - w->velocity;
    square += d * d;
  }
  summary->velocity = w->velocity;
  summary->velocity_spread = sqrt(square / (w->rules.successive - 1));
}

void strut_steady_detector_free(strut_steady_detector *w) { strut_arena_free(&w->arena); }
