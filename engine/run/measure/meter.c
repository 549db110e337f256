/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/meter.h"

#include <math.h>
#include <string.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/support_motion.h"
#include "engine/forces/forces.h"

bool strut_dense_create(const strut_model *model, strut_arena *arena, strut_dense *d) {
  double **const arrays[] = {&d->q, &d->v, &d->begin_q, &d->begin_v, &d->a[0], &d->a[1]};
  *d = (strut_dense){.model = model};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    if (!(*arrays[i] = strut_arena_allocate(arena, (size_t)model->length, sizeof(double))))
      return false;
  return true;
}

void strut_dense_keep(strut_dense *d, const strut_state *state) {
  size_t bytes = (size_t)d->model->length * sizeof(double);
  memcpy(d->begin_q, state->q, bytes);
  memcpy(d->begin_v, state->v, bytes);
  memcpy(d->begin_work, state->work, sizeof d->begin_work);
}

strut_motion_piece strut_dense_step(strut_dense *d, const strut_state *state, double t, double h) {
  return (strut_motion_piece){.begin = t,
                              .length = h,
                              .q = {d->begin_q, state->q},
                              .v = {d->begin_v, state->v},
                              .work = {d->begin_work, state->work},
                              .power = {d->power[0], d->power[1]},
                              .smooth = true,
                              .ends_only = state->kicked};
}

/* Accelerations and powers at both ends of a step of the grid. */
static void accelerate_ends(strut_dense *d, const strut_state *state, strut_motion_piece *piece) {
  int64_t evaluations = state->latest->evaluations;
  for (int k = 0; k < 2; k++) {
    double t = piece->begin + k * piece->length;
    state->latest->drive_time = (double)NAN;
    strut_forces_acceleration(d->model, state, t, piece->q[k], piece->v[k], d->a[k]);
    memcpy(d->power[k], state->latest->power, sizeof d->power[k]);
    piece->a[k] = d->a[k];
  }
  state->latest->evaluations = evaluations; /* observing is not part of the run's cost */
}

/* The polynomial of fifth order through values, rates and second derivatives at both ends. */
static double hermite_of_second_order(const strut_motion_piece *p, int32_t i, double s) {
  double h = p->length, r = 1.0 - s, s3 = s * s * s, r3 = r * r * r;
  return p->q[0][i] * r3 * (1.0 + 3.0 * s + 6.0 * s * s) +
         h * (p->v[0][i] * s * r3 * (1.0 + 3.0 * s) - p->v[1][i] * r * s3 * (1.0 + 3.0 * r)) +
         0.5 * h * h * (p->a[0][i] * s * s * r3 + p->a[1][i] * r * r * s3) +
         p->q[1][i] * s3 * (1.0 + 3.0 * r + 6.0 * r * r);
}

static void interpolate(strut_dense *d, const strut_motion_piece *p, double s) {
  double h = p->length;
  for (int32_t i = 0; i < d->model->length; i++) {
    if (d->coarse) {
      double rise = p->v[1][i] - p->v[0][i] - h * p->a[0][i];
      d->q[i] = strut_hermite(p->q[0][i], p->v[0][i], p->q[1][i], p->v[1][i], h, s);
      d->v[i] = p->v[0][i] + s * (h * p->a[0][i] + s * rise);
    } else {
      d->q[i] = hermite_of_second_order(p, i, s);
      d->v[i] = strut_hermite(p->v[0][i], p->a[0][i], p->v[1][i], p->a[1][i], h, s);
    }
  }
}

double strut_dense_place(strut_dense *d, strut_state *state, strut_motion_piece *piece, double s) {
  double t = piece->begin + fmax(s * piece->length, s < 1.0 ? piece->moment : 0.0);
  if (!d->away) {
    d->end_q = state->q, d->end_v = state->v;
    memcpy(d->end_work, state->work, sizeof d->end_work);
    piece->work[1] = d->end_work;
    d->away = true;
  }
  if (!piece->a[0]) accelerate_ends(d, state, piece);
  state->q = d->q, state->v = d->v;
  interpolate(d, piece, s);
  if (d->model->terms & STRUT_TERM_SUPPORT_MOTION)
    strut_support_motion_place(d->model, state, t, d->q, d->v);
  for (int p = 0; p < STRUT_POWER_COUNT && state->balance; p++)
    state->work[p] = strut_hermite(piece->work[0][p], piece->power[0][p], piece->work[1][p],
                                   piece->power[1][p], piece->length, s);
  state->latest->drive_time = (double)NAN;
  if (piece->hold) piece->hold(piece, d->model, state, t, d->q, d->v);
  return t;
}

void strut_dense_return(strut_dense *d, strut_state *state, const strut_motion_piece *piece) {
  const strut_model *model = d->model;
  double t = piece->begin + piece->length;
  if (!d->away) return;
  d->away = false;
  state->q = d->end_q, state->v = d->end_v;
  memcpy(state->work, d->end_work, sizeof d->end_work);
  state->latest->drive_time = (double)NAN;
  strut_drive_apply(model, state, t);
  if (model->terms & (STRUT_TERMS_RARE | STRUT_TERM_ELEMENTS | STRUT_TERM_RIGID))
    strut_forces_observe(model, state, t);
}

/* Second differences below this part of the range are even: some 70 samples in an oscillation. */
static const double EVEN = 2e-3;

/* Beside extremes that matter: below this part; and how far from a part that is, in its length. */
static const double EXACT = 1e-6, NEAR = 0.5;

/* Samples within this part of the range of what their neighbours foretell are resolved. */
static const double RESOLVED = 1e-2;

/* Where an extreme may lie: within this part of the error that is allowed for it. */
static const double OF_ALLOWED = 0.05;

/* Values and their differences are known to this part of the largest one. */
static const double ROUNDED = 1e-12;

/* Searches for extremes end when they gain less than this part of the range. */
static const double GAINED = 1e-10;

/* Further from a target than this part of the range, extremes need not be known well. */
static const double SURE = 0.05;

enum { MOST_TRIALS = 40 };

typedef struct place {
  double at, value; /* fraction of the part; value there */
} place;

static double range_of(const strut_meter *m) { return m->whole.high - m->whole.low; }

/* To what an extreme is resolved. */
static double resolution(const strut_meter *m) {
  strut_reduction take = m->definition->take;
  double value = take == STRUT_TAKE_MIN   ? m->part.low
                 : take == STRUT_TAKE_MAX ? m->part.high
                                          : range_of(m);
  return OF_ALLOWED * strut_quantity_allowed_error(m->definition, m->accuracy, value, m->largest);
}

/* ---- stretches ---- */

static strut_meter_stretch begin_stretch(const strut_meter *m, double time, double value,
                                         double origin) {
  return (strut_meter_stretch){.low = value,
                               .high = value,
                               .begin = value,
                               .origin = origin,
                               .time = time,
                               .arrival = value == m->definition->target ? time : (double)NAN};
}

/* Reduces a stretch that ends here to its value. */
static double reduce_stretch(const strut_meter *m, const strut_meter_stretch *s, double time,
                             double value, double origin) {
  double length = time - s->time;
  switch (m->definition->take) {
    case STRUT_TAKE_MEAN:
      return (m->rate_of == (size_t)-1 ? s->integral : origin - s->origin) / length;
    case STRUT_TAKE_MIN: return s->low;
    case STRUT_TAKE_MAX: return s->high;
    case STRUT_TAKE_RANGE: return s->high - s->low;
    case STRUT_TAKE_RMS: return sqrt(fmax(0.0, s->square) / length);
    case STRUT_TAKE_FINAL: return value;
    case STRUT_TAKE_CHANGE: return value - s->begin;
    case STRUT_TAKE_RATE: return (value - s->begin) / length;
    case STRUT_TAKE_RISE: return s->rise;
    case STRUT_TAKE_ARRIVAL: return s->arrival;
  }
  return (double)NAN;
}

void strut_meter_open(strut_meter *m, double time, double value, double origin) {
  m->whole = m->part = begin_stretch(m, time, value, origin);
  m->parts = 0;
  m->part_mean = m->part_square = 0.0;
  m->value = value;
  m->elapsed = 0.0;
  m->doubt = 0.0;
  m->least = HUGE_VAL, m->most = -HUGE_VAL;
  m->largest = fabs(value);
  m->branch = m->seen;
  double above = value - m->definition->target;
  m->side = above > 0.0 ? 1.0 : above < 0.0 ? -1.0 : 0.0;
  m->close = fabs(above), m->nearest = HUGE_VAL, m->beyond = 0.0;
  m->returned = false;
}

void strut_meter_mark(strut_meter *m, double time, double value, double origin) {
  double of_part = reduce_stretch(m, &m->part, time, value, origin), d = of_part - m->part_mean;
  m->result = reduce_stretch(m, &m->whole, time, value, origin);
  m->parts++;
  m->part_mean += d / (double)m->parts;
  m->part_square += d * (of_part - m->part_mean);
  m->part = begin_stretch(m, time, value, origin);
}

/* ---- what every way of adding a part does ---- */

/* Notes turns before the target, and how far the value then goes beyond it. */
static void note_approach(strut_meter *m, double value) {
  double before = m->side * (value - m->definition->target);
  if (before <= 0.0 && !m->returned) m->beyond = fmax(m->beyond, -before);
  if (before <= 0.0) return;
  if (!isnan(m->whole.arrival)) m->returned = true;
  if (m->returned) return;
  if (before > m->close + GAINED * m->largest) m->nearest = fmin(m->nearest, m->close);
  m->close = before > m->close + GAINED * m->largest ? before : fmin(before, m->close);
}

double strut_meter_margin(const strut_meter *m) {
  if (m->side == 0.0) return HUGE_VAL;
  double margin = fmin(m->nearest, isnan(m->whole.arrival) ? m->close : m->beyond);
  return fmin(margin, SURE * range_of(m));
}

static void note_value(strut_meter *m, double value) {
  strut_meter_stretch *const both[] = {&m->whole, &m->part};
  for (int k = 0; k < 2; k++) {
    if (!(value >= both[k]->low)) both[k]->low = value; /* a NaN remains */
    if (!(value <= both[k]->high)) both[k]->high = value;
  }
  m->largest = fmax(m->largest, fabs(value));
  if (m->definition->take == STRUT_TAKE_ARRIVAL) note_approach(m, value);
}

static void add_integrals(strut_meter *m, double integral, double square) {
  m->whole.integral += integral, m->part.integral += integral;
  m->whole.square += square, m->part.square += square;
}

static void add_rise(strut_meter *m, double rise) { m->whole.rise += rise, m->part.rise += rise; }

static bool is_passed(const strut_meter *m, double from, double to) {
  double before = from - m->definition->target, after = to - m->definition->target;
  return (before < 0.0 && after >= 0.0) || (before > 0.0 && after <= 0.0);
}

static bool awaits_arrival(const strut_meter *m) {
  return m->definition->take == STRUT_TAKE_ARRIVAL &&
         (isnan(m->whole.arrival) || isnan(m->part.arrival));
}

static void note_arrival(strut_meter *m, double time) {
  if (isnan(m->whole.arrival)) m->whole.arrival = time;
  if (isnan(m->part.arrival)) m->part.arrival = time;
}

static void end_part(strut_meter *m, double value, double length) {
  m->before = m->value;
  m->elapsed = length;
  m->value = value;
}

void strut_meter_jump(strut_meter *m, double time, double value) {
  note_value(m, value);
  add_rise(m, fmax(0.0, value - m->value));
  if (awaits_arrival(m) && is_passed(m, m->value, value)) note_arrival(m, time);
  m->value = value;
  m->elapsed = 0.0;
  m->branch = m->seen;
}

/* Does an extreme of about this value matter to what is taken? */
static bool matters(const strut_meter *m, double value, double sign) {
  double close = RESOLVED * range_of(m);
  switch (m->definition->take) {
    case STRUT_TAKE_MIN: return sign < 0.0 && value < m->part.low + close;
    case STRUT_TAKE_MAX: return sign > 0.0 && value > m->part.high - close;
    case STRUT_TAKE_RANGE:
      return sign > 0.0 ? value > m->part.high - close : value < m->part.low + close;
    case STRUT_TAKE_RISE: return true;
    case STRUT_TAKE_ARRIVAL: return awaits_arrival(m) || (!m->returned && m->beyond <= close);
    case STRUT_TAKE_MEAN:
    case STRUT_TAKE_RMS:
    case STRUT_TAKE_FINAL:
    case STRUT_TAKE_CHANGE:
    case STRUT_TAKE_RATE: break;
  }
  return false;
}

/* Could values down to `low` or up to `high` change an extreme? */
static bool may_exceed(const strut_meter *m, double low, double high) {
  strut_reduction take = m->definition->take;
  bool lower = take == STRUT_TAKE_MIN || take == STRUT_TAKE_RANGE;
  bool higher = take == STRUT_TAKE_MAX || take == STRUT_TAKE_RANGE;
  return (lower && low < m->part.low) || (higher && high > m->part.high);
}

bool strut_meter_may_turn(const strut_meter *m, double value, double length) {
  double way = m->elapsed > 0.0 ? fabs(m->value - m->before) * length / m->elapsed : HUGE_VAL;
  double reach = 2.0 * (way + fabs(value - m->value)), target = m->definition->target;
  double low = fmin(m->value, value) - reach, high = fmax(m->value, value) + reach;
  switch (m->definition->take) {
    case STRUT_TAKE_MIN:
    case STRUT_TAKE_MAX:
    case STRUT_TAKE_RANGE: return may_exceed(m, low, high);
    case STRUT_TAKE_ARRIVAL: return !m->returned && target >= low && target <= high;
    case STRUT_TAKE_MEAN:
    case STRUT_TAKE_RMS:
    case STRUT_TAKE_RISE: return true;
    case STRUT_TAKE_FINAL:
    case STRUT_TAKE_CHANGE:
    case STRUT_TAKE_RATE: break;
  }
  return false;
}

/* ---- parts that need no samples between their ends ---- */

/* How far the value before is from the straight line through the ends, over the length of the part. */
static double second_difference(double before, double elapsed, double from, double to,
                                double length) {
  return (to - from) - (from - before) * (length / elapsed);
}

/* Does the parabola with this second difference have an extreme that matters in the part, or not far from it? */
static bool is_near_extreme(const strut_meter *m, double value, double bend, double length) {
  double share =
      length / (m->elapsed + length); /* the parabola is f + (rise - b s) s + b s^2, s = 0 to 1 */
  double b = bend * share, slope = value - m->value - b, at = -0.5 * slope / b;
  return at > -NEAR && at < 1.0 + NEAR &&
         matters(m, m->value - 0.25 * slope * slope / b, b < 0.0 ? 1.0 : -1.0);
}

bool strut_meter_is_even(const strut_meter *m, double value, double length) {
  if (!m->inner) return true;
  if (!(m->elapsed > 0.0) || m->elapsed > 2.0 * length || length > 2.0 * m->elapsed) return false;
  double difference = second_difference(m->before, m->elapsed, m->value, value, length);
  double bend = fabs(difference), low = fmin(m->value, value), high = fmax(m->value, value);
  double target = m->definition->target, range = fmax(range_of(m), high - low);
  if (awaits_arrival(m) && target >= low - bend && target <= high + bend) return false;
  double exact = fmin(EXACT * range, resolution(m)) + ROUNDED * m->largest;
  if (bend > exact && is_near_extreme(m, value, difference, length)) return false;
  return !(bend > EVEN * range + ROUNDED * m->largest);
}

/* The integral over the part of the parabola through three values. */
static double integrate_parabola(double before, double elapsed, double from, double to,
                                 double length) {
  double bend = second_difference(before, elapsed, from, to, length);
  return length * (0.5 * (from + to) - bend * length / (6.0 * (length + elapsed)));
}

void strut_meter_add_even(strut_meter *m, double value, double begin, double length) {
  double f = m->value, b = m->before, e = m->elapsed;
  bool curved = m->inner && e > 0.0;
  double integral =
      curved ? integrate_parabola(b, e, f, value, length) : 0.5 * (f + value) * length;
  double square = curved ? integrate_parabola(b * b, e, f * f, value * value, length)
                         : 0.5 * (f * f + value * value) * length;
  note_value(m, value);
  add_integrals(m, integral, square);
  add_rise(m, fmax(0.0, value - f));
  if (awaits_arrival(m) && is_passed(m, f, value))
    note_arrival(m, begin + length * (m->definition->target - f) / (value - f));
  if (curved && (f - b) * (value - f) < 0.0) { /* an extreme about the value before */
    double right = (value - f) / length, left = (f - b) / e;
    double curvature = 2.0 * (right - left) / (length + e);
    double slope = (left * length + right * e) / (length + e);
    double vertex = f - 0.5 * slope * slope / curvature;
    note_value(m, vertex);
    add_rise(m, fabs(vertex - f));
  }
  end_part(m, value, length);
}

/* ---- parts with samples ---- */

/* How far sample k, at an odd place, is from what those beside it foretell. */
static double off_foretold(const strut_samples *s, int k) {
  const double *f = s->value;
  int last = s->count - 1;
  bool ahead = k + 3 <= last;
  if (last <= 2) return fabs(f[k] - 0.5 * (f[k - 1] + f[k + 1]));
  double sum = (ahead ? 3.0 * f[k - 1] : 3.0 * f[k + 1]) + 6.0 * (ahead ? f[k + 1] : f[k - 1]) -
               (ahead ? f[k + 3] : f[k - 3]);
  return fabs(f[k] - 0.125 * sum);
}

/* Where an extreme may lie about sample k, if it is not resolved there. */
static bool is_unresolved(const strut_meter *m, const strut_samples *s, int k, double *low,
                          double *high) {
  const double *f = s->value;
  double off = off_foretold(s, k);
  *low = fmin(f[k], fmin(f[k - 1], f[k + 1])) - off;
  *high = fmax(f[k], fmax(f[k - 1], f[k + 1])) + off;
  return off > resolution(m) + ROUNDED * m->largest;
}

double strut_meter_left(const strut_meter *m) {
  strut_reduction take = m->definition->take;
  bool lower = take == STRUT_TAKE_MIN || take == STRUT_TAKE_RANGE;
  bool higher = take == STRUT_TAKE_MAX || take == STRUT_TAKE_RANGE;
  return (lower ? fmax(0.0, m->whole.low - m->least) : 0.0) +
         (higher ? fmax(0.0, m->most - m->whole.high) : 0.0);
}

bool strut_meter_is_resolved(const strut_meter *m, const strut_samples *s) {
  const double *f = s->value;
  int last = s->count - 1;
  double low = f[0], high = f[0], worst = 0.0;
  for (int k = 1; k <= last; k++) low = fmin(low, f[k]), high = fmax(high, f[k]);
  for (int k = 1; k < last; k += 2) {
    worst = fmax(worst, off_foretold(s, k));
    double least, most;
    if (is_unresolved(m, s, k, &least, &most) && may_exceed(m, least, most)) return false;
  }
  double part = last > 2 ? RESOLVED : EVEN;
  return !(worst > part * fmax(range_of(m), high - low) + ROUNDED * m->largest);
}

/* The vertex of the parabola through three points; NAN: there is none between the outer ones. */
static place find_vertex(place a, place b, place c) {
  double left = (b.value - a.value) / (b.at - a.at), right = (c.value - b.value) / (c.at - b.at);
  double bend = (right - left) / (c.at - a.at);
  double slope = left + bend * (b.at - a.at); /* at b */
  double at = b.at - 0.5 * slope / bend;
  if (!(at > a.at && at < c.at)) return (place){(double)NAN, (double)NAN};
  return (place){at, b.value - 0.25 * slope * slope / bend};
}

/* The extreme between a and c, of which b is the most extreme so far; sign: 1 of a maximum, -1 of a minimum. */
static place refine_extreme(const strut_samples *s, place a, place b, place c, double sign,
                            double range) {
  for (int k = 0; k < MOST_TRIALS; k++) {
    place guess = find_vertex(a, b, c);
    double wide = b.at - a.at > c.at - b.at ? a.at : c.at; /* the end farther off */
    double gap = fabs(guess.at - b.at), width = c.at - a.at;
    if (sign * (guess.value - b.value) <= GAINED * range) break;
    if (k % 3 == 2 || !(gap > 1e-9 * width)) guess.at = b.at + 0.381966 * (wide - b.at);
    place next = {guess.at, s->sample(s->context, guess.at)};
    if (isnan(next.value)) break;
    bool better = sign * (next.value - b.value) > 0.0;
    place *near = next.at < b.at ? &a : &c, *far = next.at < b.at ? &c : &a;
    if (better)
      *far = b, b = next;
    else
      *near = next;
  }
  return b;
}

/* When the target is passed between two points, by regula falsi that halves the end which stays. */
static double find_arrival(const strut_samples *s, double target, place a, place b) {
  double left = a.value - target, right = b.value - target;
  int side = 0;
  for (int k = 0; k < MOST_TRIALS && b.at - a.at > 1e-13 && left != 0.0; k++) {
    double at = (a.at * right - b.at * left) / (right - left);
    if (!(at > a.at && at < b.at)) break;
    double value = s->sample(s->context, at) - target;
    if (value == 0.0) return at;
    if ((value > 0.0) == (right > 0.0)) {
      b.at = at, right = value;
      if (side == 1) left *= 0.5;
      side = 1;
    } else {
      a.at = at, left = value;
      if (side == -1) right *= 0.5;
      side = -1;
    }
    if (fabs(value) <= 1e-15 * (fabs(target) + fabs(value))) return at;
  }
  return left == 0.0 ? a.at : b.at - (b.at - a.at) * (right / (right - left));
}

/* Moves on from one point to the next: extremes, increases, arrival. */
static void pass_point(strut_meter *m, const strut_samples *s, place from, place to) {
  note_value(m, to.value);
  add_rise(m, fmax(0.0, to.value - from.value));
  if (!awaits_arrival(m) || !is_passed(m, from.value, to.value)) return;
  double at = find_arrival(s, m->definition->target, from, to);
  note_arrival(m, s->begin + at * s->length);
}

static double integrate_samples(const double *f, int last, bool squared) {
  double sum = 0.0;
  for (int k = 0; k <= last; k++) {
    double weight = k == 0 || k == last ? 1.0 : k % 2 ? 4.0 : 2.0;
    sum += weight * (squared ? f[k] * f[k] : f[k]);
  }
  return sum / (3.0 * last);
}

/* An extreme near sample k, between its neighbours; beside the ends also that of the outer half. */
static bool find_extreme(const strut_meter *m, const strut_samples *s, int k, place *extreme) {
  int last = s->count - 1;
  place p[3];
  for (int j = 0; j < 3; j++) p[j] = (place){(double)(k - 1 + j) / last, s->value[k - 1 + j]};
  place vertex = find_vertex(p[0], p[1], p[2]);
  if (isnan(vertex.at)) return false;
  double half = 0.5 / last, sign = vertex.value > p[1].value ? 1.0 : -1.0;
  if (vertex.value == p[1].value) sign = p[0].value < p[1].value ? 1.0 : -1.0;
  /* at a kink the value turns beyond the vertex */
  double turn =
      vertex.value + sign * fmin(fabs(p[0].value - p[1].value), fabs(p[2].value - p[1].value));
  bool inside = fabs(vertex.at - p[1].at) <= half;
  bool outer = (k == 1 && vertex.at < p[1].at) || (k == last - 1 && vertex.at > p[1].at);
  if (!(inside || outer) || !matters(m, turn, sign)) return false;
  if (inside) {
    *extreme = refine_extreme(s, p[0], p[1], p[2], sign, range_of(m));
    return true;
  }
  place first = {vertex.at, s->sample(s->context, vertex.at)};
  place a = vertex.at < p[1].at ? p[0] : p[1], c = vertex.at < p[1].at ? p[1] : p[2];
  if (!(sign * (first.value - fmax(sign * a.value, sign * c.value) * sign) > 0.0)) return false;
  *extreme = refine_extreme(s, a, first, c, sign, range_of(m));
  return true;
}

/* Uncertainty of the result by that of the value in a part that has just been added. */
static void add_doubt(strut_meter *m, const strut_samples *s, const strut_meter_stretch *before) {
  const strut_meter_stretch *now = &m->whole;
  bool lower = now->low<before->low, higher = now->high> before->high;
  switch (m->definition->take) {
    case STRUT_TAKE_MIN: m->doubt = lower ? s->doubt : m->doubt; break;
    case STRUT_TAKE_MAX: m->doubt = higher ? s->doubt : m->doubt; break;
    case STRUT_TAKE_RANGE: m->doubt = lower || higher ? fmax(m->doubt, s->doubt) : m->doubt; break;
    case STRUT_TAKE_MEAN:
    case STRUT_TAKE_RMS: m->doubt += s->doubt * s->length; break;
    case STRUT_TAKE_RISE: m->doubt += s->doubt; break;
    case STRUT_TAKE_ARRIVAL:
      if (isnan(before->arrival) && !isnan(now->arrival))
        m->doubt = s->length * s->doubt / fabs(s->value[s->count - 1] - s->value[0]);
      break;
    case STRUT_TAKE_FINAL:
    case STRUT_TAKE_CHANGE:
    case STRUT_TAKE_RATE: break;
  }
}

void strut_meter_add(strut_meter *m, const strut_samples *s) {
  int last = s->count - 1;
  strut_meter_stretch before = m->whole;
  place at = {0.0, s->value[0]};
  double passed = 0.0;                             /* the latest extreme */
  bool searched[STRUT_MOST_SAMPLES + 4] = {false}; /* two samples on: is an extreme known there? */
  for (int k = 1; k <= last; k++) {
    place extreme, sample = {(double)k / last, s->value[k]};
    bool found = k < last && find_extreme(m, s, k, &extreme) && extreme.at > passed;
    if (found) passed = extreme.at;
    for (int j = k; found && j <= k + 4; j++) searched[j] = true;
    if (found && extreme.at < sample.at) pass_point(m, s, at, extreme), at = extreme;
    pass_point(m, s, at, sample), at = sample;
    if (found && extreme.at > sample.at) pass_point(m, s, at, extreme), at = extreme;
  }
  add_integrals(m, s->length * integrate_samples(s->value, last, false),
                s->length * integrate_samples(s->value, last, true));
  add_doubt(m, s, &before);
  for (int k = 1; k < last; k += 2) {
    double least, most;
    if (searched[k + 2] || !is_unresolved(m, s, k, &least, &most)) continue;
    m->least = fmin(m->least, least), m->most = fmax(m->most, most);
  }
  end_part(m, s->value[last], s->length);
}
