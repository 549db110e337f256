/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/meter.h"

#include <math.h>
#include <string.h>

#include "engine/base/interpolation.h"
#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/forces.h"
#include "engine/forces/history.h"

bool strut_dense_create(const strut_model *model, strut_arena *arena, strut_dense *matrix) {
  *matrix = (strut_dense){.model = model};
  return STRUT_NUMBERS(arena, model->length, &matrix->q, &matrix->v, &matrix->begin_q,
                       &matrix->begin_v, &matrix->a[0], &matrix->a[1]) &&
         STRUT_NUMBERS(arena, strut_history_count(model), &matrix->begin_memory,
                       &matrix->end_memory);
}

void strut_dense_keep(strut_dense *matrix, const strut_state *state) {
  size_t bytes = (size_t)matrix->model->length * sizeof(double);
  memcpy(matrix->begin_q, state->q, bytes);
  memcpy(matrix->begin_v, state->v, bytes);
  memcpy(matrix->begin_work, state->work, sizeof matrix->begin_work);
  strut_history_store(matrix->model, state, matrix->begin_memory);
}

strut_motion_piece strut_dense_step(strut_dense *matrix, const strut_state *state, double t,
                                    double h) {
  return (strut_motion_piece){.begin = t,
                              .length = h,
                              .q = {matrix->begin_q, state->q},
                              .v = {matrix->begin_v, state->v},
                              .work = {matrix->begin_work, state->work},
                              .power = {matrix->power[0], matrix->power[1]},
                              .memory = matrix->begin_memory,
                              .smooth = true,
                              .ends_only = state->kicked};
}

/* Accelerations and powers at both ends of a step of the grid. */
static void accelerate_ends(strut_dense *matrix, const strut_state *state,
                            strut_motion_piece *piece) {
  int64_t evaluations = state->latest->evaluations;
  for (int k = 0; k < 2; k++) {
    double t = piece->begin + k * piece->length;
    state->latest->drive_time = (double)NAN;
    strut_forces_acceleration(matrix->model, state, t, piece->q[k], piece->v[k], matrix->a[k]);
    memcpy(matrix->power[k], state->latest->power, sizeof matrix->power[k]);
    piece->a[k] = matrix->a[k];
  }
  state->latest->evaluations = evaluations; /* observing is not part of the run's cost */
}

/* The polynomial of fifth order through values, rates and second derivatives at both ends. */
static double hermite_of_second_order(const strut_motion_piece *piece, int32_t i, double s) {
  double h = piece->length, r = 1.0 - s, s3 = s * s * s, r3 = r * r * r;
  return piece->q[0][i] * r3 * (1.0 + 3.0 * s + 6.0 * s * s) +
         h * (piece->v[0][i] * s * r3 * (1.0 + 3.0 * s) -
              piece->v[1][i] * r * s3 * (1.0 + 3.0 * r)) +
         0.5 * h * h * (piece->a[0][i] * s * s * r3 + piece->a[1][i] * r * r * s3) +
         piece->q[1][i] * s3 * (1.0 + 3.0 * r + 6.0 * r * r);
}

/* Its derivative: of fifth order, where the cubic through the rates is of fourth. */
static double slope_of_second_order(const strut_motion_piece *piece, int32_t i, double s) {
  double h = piece->length, r = 1.0 - s, rise = (piece->q[1][i] - piece->q[0][i]) / h;
  return 30.0 * rise * s * s * r * r + piece->v[0][i] * r * r * (1.0 - 3.0 * s) * (1.0 + 5.0 * s) +
         piece->v[1][i] * s * s * (1.0 - 3.0 * r) * (1.0 + 5.0 * r) +
         0.5 * h * s * r *
             (piece->a[0][i] * r * (2.0 - 5.0 * s) - piece->a[1][i] * s * (2.0 - 5.0 * r));
}

static void interpolate(strut_dense *matrix, const strut_motion_piece *piece, double s) {
  double h = piece->length;
  for (int32_t i = 0; i < matrix->model->length; i++) {
    if (piece->ends_only) {
      matrix->q[i] = piece->q[0][i] + s * (piece->q[1][i] - piece->q[0][i]);
      matrix->v[i] = piece->v[s < 1.0 ? 0 : 1][i];
    } else if (matrix->coarse) {
      double rise = piece->v[1][i] - piece->v[0][i] - h * piece->a[0][i];
      matrix->q[i] =
          strut_hermite(piece->q[0][i], piece->v[0][i], piece->q[1][i], piece->v[1][i], h, s);
      matrix->v[i] = piece->v[0][i] + s * (h * piece->a[0][i] + s * rise);
    } else {
      matrix->q[i] = hermite_of_second_order(piece, i, s);
      matrix->v[i] =
          i < 2 * matrix->model->node_count
              ? slope_of_second_order(piece, i, s)
              : strut_hermite(piece->v[0][i], piece->a[0][i], piece->v[1][i], piece->a[1][i], h, s);
    }
  }
}

double strut_dense_place(strut_dense *matrix, strut_state *state, strut_motion_piece *piece,
                         double s) {
  double t = piece->begin + fmax(s * piece->length, s < 1.0 ? piece->moment : 0.0);
  if (!matrix->away) {
    matrix->end_q = state->q, matrix->end_v = state->v;
    memcpy(matrix->end_work, state->work, sizeof matrix->end_work);
    piece->work[1] = matrix->end_work;
    strut_history_store(matrix->model, state, matrix->end_memory);
    matrix->away = true;
  }
  if (!piece->a[0]) accelerate_ends(matrix, state, piece);
  state->q = matrix->q, state->v = matrix->v;
  interpolate(matrix, piece, s);
  if (matrix->model->terms & STRUT_TERM_SUPPORT_MOTION)
    strut_support_motion_place(matrix->model, state, t, matrix->q, matrix->v);
  state->latest->drive_time = (double)NAN;
  if (piece->hold) piece->hold(piece, matrix->model, state, t, matrix->q, matrix->v);
  if (matrix->model->elements.history_slots)
    strut_history_place(matrix->model, state, piece->memory, t, piece->hold);
  for (int p = 0; p < STRUT_POWER_COUNT && state->balance; p++)
    state->work[p] = strut_hermite(piece->work[0][p], piece->power[0][p], piece->work[1][p],
                                   piece->power[1][p], piece->length, s);
  return t;
}

void strut_dense_return(strut_dense *matrix, strut_state *state, const strut_motion_piece *piece) {
  const strut_model *model = matrix->model;
  double t = piece->begin + piece->length;
  if (!matrix->away) return;
  matrix->away = false;
  state->q = matrix->end_q, state->v = matrix->end_v;
  memcpy(state->work, matrix->end_work, sizeof matrix->end_work);
  strut_history_load(model, state, matrix->end_memory);
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

static double range_of(const strut_meter *meter) { return meter->whole.high - meter->whole.low; }

/* Does the lowest value count, or the highest? */
static bool takes_low(const strut_meter *meter) {
  return meter->definition->take == STRUT_TAKE_MIN || meter->definition->take == STRUT_TAKE_RANGE;
}
static bool takes_high(const strut_meter *meter) {
  return meter->definition->take == STRUT_TAKE_MAX || meter->definition->take == STRUT_TAKE_RANGE;
}

/* To what an extreme is resolved. */
static double resolution(const strut_meter *meter) {
  strut_reduction take = meter->definition->take;
  double value = take == STRUT_TAKE_MIN   ? meter->part.low
                 : take == STRUT_TAKE_MAX ? meter->part.high
                                          : range_of(meter);
  return OF_ALLOWED *
         strut_quantity_allowed_error(meter->definition, meter->accuracy, value, meter->largest);
}

/* ---- stretches ---- */

static strut_meter_stretch begin_stretch(const strut_meter *meter, double time, double value,
                                         double origin) {
  return (strut_meter_stretch){.low = value,
                               .high = value,
                               .begin = value,
                               .origin = origin,
                               .time = time,
                               .arrival = value == meter->definition->target ? time : (double)NAN};
}

/* Reduces a stretch that ends here to its value. */
static double reduce_stretch(const strut_meter *meter, const strut_meter_stretch *stretch,
                             double time, double value, double origin) {
  double length = time - stretch->time;
  switch (meter->definition->take) {
    case STRUT_TAKE_MEAN:
      return (meter->rate_of == (size_t)-1 ? stretch->integral : origin - stretch->origin) / length;
    case STRUT_TAKE_MIN: return stretch->low;
    case STRUT_TAKE_MAX: return stretch->high;
    case STRUT_TAKE_RANGE: return stretch->high - stretch->low;
    case STRUT_TAKE_RMS: return sqrt(fmax(0.0, stretch->square) / length);
    case STRUT_TAKE_FINAL: return value;
    case STRUT_TAKE_CHANGE: return value - stretch->begin;
    case STRUT_TAKE_RATE: return (value - stretch->begin) / length;
    case STRUT_TAKE_RISE: return stretch->rise;
    case STRUT_TAKE_ARRIVAL: return stretch->arrival;
  }
  return (double)NAN;
}

void strut_meter_open(strut_meter *meter, double time, double value, double origin) {
  meter->whole = meter->part = begin_stretch(meter, time, value, origin);
  meter->parts = 0;
  meter->part_mean = meter->part_square = 0.0;
  meter->value = value;
  meter->elapsed = 0.0;
  meter->doubt = 0.0;
  meter->least = HUGE_VAL, meter->most = -HUGE_VAL, meter->missed = 0.0;
  meter->largest = fabs(value);
  meter->branch = meter->seen;
  double above = value - meter->definition->target;
  meter->side = above > 0.0 ? 1.0 : above < 0.0 ? -1.0 : 0.0;
  meter->close = fabs(above), meter->nearest = HUGE_VAL, meter->beyond = 0.0;
  meter->returned = false;
}

void strut_meter_mark(strut_meter *meter, double time, double value, double origin) {
  double of_part = reduce_stretch(meter, &meter->part, time, value, origin),
         d = of_part - meter->part_mean;
  meter->result = reduce_stretch(meter, &meter->whole, time, value, origin);
  meter->parts++;
  meter->part_mean += d / (double)meter->parts;
  meter->part_square += d * (of_part - meter->part_mean);
  meter->part = begin_stretch(meter, time, value, origin);
}

/* ---- what every way of adding a part does ---- */

/* Notes turns before the target, and how far the value then goes beyond it. */
static void note_approach(strut_meter *meter, double value) {
  double before = meter->side * (value - meter->definition->target);
  if (before <= 0.0 && !meter->returned) meter->beyond = fmax(meter->beyond, -before);
  if (before <= 0.0) return;
  if (!isnan(meter->whole.arrival)) meter->returned = true;
  if (meter->returned) return;
  if (before > meter->close + GAINED * meter->largest)
    meter->nearest = fmin(meter->nearest, meter->close);
  meter->close =
      before > meter->close + GAINED * meter->largest ? before : fmin(before, meter->close);
}

double strut_meter_margin(const strut_meter *meter) {
  if (meter->side == 0.0) return HUGE_VAL;
  double margin = fmin(meter->nearest, isnan(meter->whole.arrival) ? meter->close : meter->beyond);
  return fmin(margin, SURE * range_of(meter));
}

static void note_value(strut_meter *meter, double value) {
  strut_meter_stretch *const both[] = {&meter->whole, &meter->part};
  for (int k = 0; k < 2; k++) {
    if (!(value >= both[k]->low)) both[k]->low = value; /* a NaN remains */
    if (!(value <= both[k]->high)) both[k]->high = value;
  }
  meter->largest = fmax(meter->largest, fabs(value));
  if (meter->definition->take == STRUT_TAKE_ARRIVAL) note_approach(meter, value);
}

static void add_integrals(strut_meter *meter, double integral, double square) {
  meter->whole.integral += integral, meter->part.integral += integral;
  meter->whole.square += square, meter->part.square += square;
}

static void add_rise(strut_meter *meter, double rise) {
  meter->whole.rise += rise, meter->part.rise += rise;
}

static bool is_passed(const strut_meter *meter, double from, double to) {
  double before = from - meter->definition->target, after = to - meter->definition->target;
  return (before < 0.0 && after >= 0.0) || (before > 0.0 && after <= 0.0);
}

static bool awaits_arrival(const strut_meter *meter) {
  return meter->definition->take == STRUT_TAKE_ARRIVAL &&
         (isnan(meter->whole.arrival) || isnan(meter->part.arrival));
}

static void note_arrival(strut_meter *meter, double time) {
  if (isnan(meter->whole.arrival)) meter->whole.arrival = time;
  if (isnan(meter->part.arrival)) meter->part.arrival = time;
}

static void end_part(strut_meter *meter, double value, double length) {
  meter->before = meter->value;
  meter->elapsed = length;
  meter->value = value;
}

void strut_meter_jump(strut_meter *meter, double time, double value) {
  note_value(meter, value);
  add_rise(meter, fmax(0.0, value - meter->value));
  if (awaits_arrival(meter) && is_passed(meter, meter->value, value)) note_arrival(meter, time);
  meter->value = value;
  meter->elapsed = 0.0;
  meter->branch = meter->seen;
}

/* Does an extreme of about this value matter to what is taken? */
static bool matters(const strut_meter *meter, double value, double sign) {
  double close = RESOLVED * range_of(meter);
  strut_reduction take = meter->definition->take;
  if (take == STRUT_TAKE_ARRIVAL)
    return awaits_arrival(meter) || (!meter->returned && meter->beyond <= close);
  if (take == STRUT_TAKE_RISE) return true;
  return sign < 0.0 ? takes_low(meter) && value < meter->part.low + close
                    : takes_high(meter) && value > meter->part.high - close;
}

/* Could values down to `low` or up to `high` change an extreme? */
static bool may_exceed(const strut_meter *meter, double low, double high) {
  return (takes_low(meter) && low < meter->part.low) ||
         (takes_high(meter) && high > meter->part.high);
}

bool strut_meter_may_turn(const strut_meter *meter, double value, double length) {
  double way = meter->elapsed > 0.0 ? fabs(meter->value - meter->before) * length / meter->elapsed
                                    : HUGE_VAL;
  double reach = 2.0 * (way + fabs(value - meter->value)), target = meter->definition->target;
  double low = fmin(meter->value, value) - reach, high = fmax(meter->value, value) + reach;
  strut_reduction take = meter->definition->take;
  if (take == STRUT_TAKE_ARRIVAL) return !meter->returned && target >= low && target <= high;
  return may_exceed(meter, low, high) || take == STRUT_TAKE_MEAN || take == STRUT_TAKE_RMS ||
         take == STRUT_TAKE_RISE;
}

/* ---- parts that need no samples between their ends ---- */

/* How far the value before is from the straight line through the ends, over the length of the part. */
static double second_difference(double before, double elapsed, double from, double to,
                                double length) {
  return (to - from) - (from - before) * (length / elapsed);
}

/* Does the parabola with this second difference have an extreme that matters in the part, or not far from it? */
static bool is_near_extreme(const strut_meter *meter, double value, double bend, double length) {
  double share = length / (meter->elapsed +
                           length); /* the parabola is f + (rise - b s) s + b s^2, s = 0 to 1 */
  double b = bend * share, slope = value - meter->value - b, at = -0.5 * slope / b;
  return at > -NEAR && at < 1.0 + NEAR &&
         matters(meter, meter->value - 0.25 * slope * slope / b, b < 0.0 ? 1.0 : -1.0);
}

bool strut_meter_is_even(const strut_meter *meter, double value, double length) {
  if (!meter->inner) return true;
  if (meter->exact || !(meter->elapsed > 0.0) || meter->elapsed > 2.0 * length ||
      length > 2.0 * meter->elapsed)
    return false;
  double difference = second_difference(meter->before, meter->elapsed, meter->value, value, length);
  double bend = fabs(difference), low = fmin(meter->value, value), high = fmax(meter->value, value);
  double target = meter->definition->target, range = fmax(range_of(meter), high - low);
  if (awaits_arrival(meter) && target >= low - bend && target <= high + bend) return false;
  double exact = fmin(EXACT * range, resolution(meter)) + ROUNDED * meter->largest;
  if (bend > exact && is_near_extreme(meter, value, difference, length)) return false;
  return !(bend > EVEN * range + ROUNDED * meter->largest);
}

/* The integral over the part of the parabola through three values. */
static double integrate_parabola(double before, double elapsed, double from, double to,
                                 double length) {
  double bend = second_difference(before, elapsed, from, to, length);
  return length * (0.5 * (from + to) - bend * length / (6.0 * (length + elapsed)));
}

void strut_meter_add_even(strut_meter *meter, double value, double begin, double length) {
  double f = meter->value, b = meter->before, e = meter->elapsed;
  bool curved = meter->inner && e > 0.0;
  double integral =
      curved ? integrate_parabola(b, e, f, value, length) : 0.5 * (f + value) * length;
  double square = curved ? integrate_parabola(b * b, e, f * f, value * value, length)
                         : 0.5 * (f * f + value * value) * length;
  note_value(meter, value);
  add_integrals(meter, integral, square);
  add_rise(meter, fmax(0.0, value - f));
  if (awaits_arrival(meter) && is_passed(meter, f, value))
    note_arrival(meter, begin + length * (meter->definition->target - f) / (value - f));
  if (curved && (f - b) * (value - f) < 0.0) { /* an extreme about the value before */
    double right = (value - f) / length, left = (f - b) / e;
    double curvature = 2.0 * (right - left) / (length + e);
    double slope = (left * length + right * e) / (length + e);
    double vertex = f - 0.5 * slope * slope / curvature;
    note_value(meter, vertex);
    add_rise(meter, fabs(vertex - f));
  }
  end_part(meter, value, length);
}

/* ---- parts with samples ---- */

/* How far sample k, at an odd place, is from what those beside it foretell. */
static double off_foretold(const strut_samples *samples, int k) {
  const double *f = samples->value;
  int last = samples->count - 1;
  bool ahead = k + 3 <= last;
  if (last <= 2) return fabs(f[k] - 0.5 * (f[k - 1] + f[k + 1]));
  double sum = (ahead ? 3.0 * f[k - 1] : 3.0 * f[k + 1]) + 6.0 * (ahead ? f[k + 1] : f[k - 1]) -
               (ahead ? f[k + 3] : f[k - 3]);
  return fabs(f[k] - 0.125 * sum);
}

/* Where an extreme may lie about sample k, if it is not resolved there. */
static bool is_unresolved(const strut_meter *meter, const strut_samples *samples, int k,
                          double *low, double *high) {
  const double *f = samples->value;
  double off = off_foretold(samples, k);
  *low = fmin(f[k], fmin(f[k - 1], f[k + 1])) - off;
  *high = fmax(f[k], fmax(f[k - 1], f[k + 1])) + off;
  return off > resolution(meter) + ROUNDED * meter->largest;
}

double strut_meter_left(const strut_meter *meter, double window) {
  double missed = meter->missed / window, square = meter->whole.square / window;
  if (meter->definition->take == STRUT_TAKE_MEAN) return missed;
  if (meter->definition->take == STRUT_TAKE_RMS) return sqrt(square + missed) - sqrt(square);
  return (takes_low(meter) ? fmax(0.0, meter->whole.low - meter->least) : 0.0) +
         (takes_high(meter) ? fmax(0.0, meter->most - meter->whole.high) : 0.0);
}

bool strut_meter_is_resolved(const strut_meter *meter, const strut_samples *samples) {
  const double *f = samples->value;
  int last = samples->count - 1;
  double low = f[0], high = f[0], worst = 0.0;
  for (int k = 1; k <= last; k++) low = fmin(low, f[k]), high = fmax(high, f[k]);
  for (int k = 1; k < last; k += 2) {
    worst = fmax(worst, off_foretold(samples, k));
    double least, most;
    if (is_unresolved(meter, samples, k, &least, &most) && may_exceed(meter, least, most))
      return false;
  }
  double part = meter->exact ? EXACT : last > 2 ? RESOLVED : EVEN;
  return !(worst > part * fmax(range_of(meter), high - low) + ROUNDED * meter->largest);
}

/* The vertex of the parabola through three points; NAN: there is none between the outer ones. */
static strut_reading find_vertex(strut_reading a, strut_reading b, strut_reading c) {
  strut_reading vertex = strut_vertex(a, b, c);
  return vertex.at > a.at && vertex.at < c.at ? vertex : (strut_reading){(double)NAN, (double)NAN};
}

/* The extreme between a and c, of which b is the most extreme so far; sign: 1 of a maximum, -1 of a minimum. */
static strut_reading refine_extreme(const strut_samples *samples, strut_reading a, strut_reading b,
                                    strut_reading c, double sign, double range) {
  for (int k = 0; k < MOST_TRIALS; k++) {
    strut_reading guess = find_vertex(a, b, c);
    double wide = b.at - a.at > c.at - b.at ? a.at : c.at; /* the end farther off */
    double gap = fabs(guess.at - b.at), width = c.at - a.at;
    if (sign * (guess.value - b.value) <= GAINED * range) break;
    if (k % 3 == 2 || !(gap > 1e-9 * width)) guess.at = b.at + 0.381966 * (wide - b.at);
    strut_reading next = {guess.at, samples->sample(samples->context, guess.at)};
    if (isnan(next.value)) break;
    bool better = sign * (next.value - b.value) > 0.0;
    strut_reading *near = next.at < b.at ? &a : &c, *far = next.at < b.at ? &c : &a;
    if (better)
      *far = b, b = next;
    else
      *near = next;
  }
  return b;
}

/* When the target is passed between two points, by regula falsi that halves the end which stays. */
static double find_arrival(const strut_samples *samples, double target, strut_reading a,
                           strut_reading b) {
  double left = a.value - target, right = b.value - target;
  int side = 0;
  for (int k = 0; k < MOST_TRIALS && b.at - a.at > 1e-13 && left != 0.0; k++) {
    double at = (a.at * right - b.at * left) / (right - left);
    if (!(at > a.at && at < b.at)) break;
    double value = samples->sample(samples->context, at) - target;
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
static void pass_point(strut_meter *meter, const strut_samples *samples, strut_reading from,
                       strut_reading to) {
  note_value(meter, to.value);
  add_rise(meter, fmax(0.0, to.value - from.value));
  if (!awaits_arrival(meter) || !is_passed(meter, from.value, to.value)) return;
  double at = find_arrival(samples, meter->definition->target, from, to);
  note_arrival(meter, samples->begin + at * samples->length);
}

/* By Simpson's rule, from every sample or every second one. */
static double integrate_samples(const double *f, int last, int stride, bool squared) {
  double sum = 0.0;
  for (int k = 0; k <= last; k += stride) {
    double weight = k == 0 || k == last ? 1.0 : k / stride % 2 ? 4.0 : 2.0;
    sum += weight * (squared ? f[k] * f[k] : f[k]);
  }
  return sum * stride / (3.0 * last);
}

/* An extreme near sample k, between its neighbours; beside the ends also that of the outer half. */
static bool find_extreme(const strut_meter *meter, const strut_samples *samples, int k,
                         strut_reading *extreme) {
  int last = samples->count - 1;
  strut_reading p[3];
  for (int j = 0; j < 3; j++)
    p[j] = (strut_reading){(double)(k - 1 + j) / last, samples->value[k - 1 + j]};
  strut_reading vertex = find_vertex(p[0], p[1], p[2]);
  if (isnan(vertex.at)) return false;
  double half = 0.5 / last, sign = vertex.value > p[1].value ? 1.0 : -1.0;
  if (vertex.value == p[1].value) sign = p[0].value < p[1].value ? 1.0 : -1.0;
  /* at a kink the value turns beyond the vertex */
  double turn =
      vertex.value + sign * fmin(fabs(p[0].value - p[1].value), fabs(p[2].value - p[1].value));
  bool inside = fabs(vertex.at - p[1].at) <= half;
  bool outer = (k == 1 && vertex.at < p[1].at) || (k == last - 1 && vertex.at > p[1].at);
  if (!(inside || outer) || !matters(meter, turn, sign)) return false;
  if (inside) {
    *extreme = refine_extreme(samples, p[0], p[1], p[2], sign, range_of(meter));
    return true;
  }
  strut_reading first = {vertex.at, samples->sample(samples->context, vertex.at)};
  strut_reading a = vertex.at < p[1].at ? p[0] : p[1], c = vertex.at < p[1].at ? p[1] : p[2];
  if (!(sign * (first.value - fmax(sign * a.value, sign * c.value) * sign) > 0.0)) return false;
  *extreme = refine_extreme(samples, a, first, c, sign, range_of(meter));
  return true;
}

/* Uncertainty of the result by that of the value in a part that has just been added. */
static void add_doubt(strut_meter *meter, const strut_samples *samples,
                      const strut_meter_stretch *before) {
  const strut_meter_stretch *now = &meter->whole;
  bool lower = now->low<before->low, higher = now->high> before->high;
  switch (meter->definition->take) {
    case STRUT_TAKE_MIN: meter->doubt = lower ? samples->doubt : meter->doubt; break;
    case STRUT_TAKE_MAX: meter->doubt = higher ? samples->doubt : meter->doubt; break;
    case STRUT_TAKE_RANGE:
      meter->doubt = lower || higher ? fmax(meter->doubt, samples->doubt) : meter->doubt;
      break;
    case STRUT_TAKE_MEAN:
    case STRUT_TAKE_RMS: meter->doubt += samples->doubt * samples->length; break;
    case STRUT_TAKE_RISE: meter->doubt += samples->doubt; break;
    case STRUT_TAKE_ARRIVAL:
      if (isnan(before->arrival) && !isnan(now->arrival))
        meter->doubt = samples->length * samples->doubt /
                       fabs(samples->value[samples->count - 1] - samples->value[0]);
      break;
    case STRUT_TAKE_FINAL:
    case STRUT_TAKE_CHANGE:
    case STRUT_TAKE_RATE: break;
  }
}

void strut_meter_add(strut_meter *meter, const strut_samples *samples) {
  int last = samples->count - 1;
  strut_meter_stretch before = meter->whole;
  strut_reading at = {0.0, samples->value[0]};
  double passed = 0.0;                             /* the latest extreme */
  bool searched[STRUT_MOST_SAMPLES + 4] = {false}; /* two samples on: is an extreme known there? */
  for (int k = 1; k <= last; k++) {
    strut_reading extreme, sample = {(double)k / last, samples->value[k]};
    bool found = k < last && find_extreme(meter, samples, k, &extreme) && extreme.at > passed;
    if (found) passed = extreme.at;
    for (int j = k; found && j <= k + 4; j++) searched[j] = true;
    if (found && extreme.at < sample.at) pass_point(meter, samples, at, extreme), at = extreme;
    pass_point(meter, samples, at, sample), at = sample;
    if (found && extreme.at > sample.at) pass_point(meter, samples, at, extreme), at = extreme;
  }
  double integral[2][2]; /* of the value and its square, from all samples and from half of them */
  for (int k = 0; k < 2; k++)
    for (int half = 0; half < 2; half++)
      integral[k][half] =
          samples->length * integrate_samples(samples->value, last, 1 + half, k == 1);
  add_integrals(meter, integral[0][0], integral[1][0]);
  const double *own = integral[meter->definition->take == STRUT_TAKE_RMS];
  if (!samples->resolved && meter->rate_of == (size_t)-1) meter->missed += fabs(own[0] - own[1]);
  add_doubt(meter, samples, &before);
  for (int k = 1; k < last; k += 2) {
    double least, most;
    if (searched[k + 2] || !is_unresolved(meter, samples, k, &least, &most)) continue;
    meter->least = fmin(meter->least, least), meter->most = fmax(meter->most, most);
  }
  end_part(meter, samples->value[last], samples->length);
}
