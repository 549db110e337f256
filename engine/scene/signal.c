/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Waveforms: values, rates, breaks, periods and second derivatives. See signal.h. */
#include "engine/scene/signal.h"

#include <math.h>

#include "engine/base/vec.h"
#include "engine/scene/signal_program.h"

strut_signal strut_signal_default(strut_signal_kind kind) {
  return (strut_signal){.kind = kind, .stop = (double)INFINITY};
}

static inline void evaluate_wave(const strut_signal *signal, double turns, double *value,
                                 double *rate) {
  double sine, cosine;
  strut_sincos_turns(turns, &sine, &cosine);
  *value = signal->amplitude * sine;
  *rate = signal->amplitude * STRUT_TAU * signal->frequency * cosine;
}

static void evaluate_ramp(const strut_signal *signal, double t, double *value, double *rate) {
  *value = *rate = 0.0;
  if (t >= signal->stop) {
    *value = signal->amplitude;
  } else if (t >= signal->start) {
    *value = signal->amplitude * ((t - signal->start) / (signal->stop - signal->start));
    *rate = signal->amplitude / (signal->stop - signal->start);
  }
}

size_t strut_signal_points_until(const strut_signal *signal, double t) {
  size_t low = 0, high = signal->point_count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (signal->time[middle] <= t)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static void evaluate_table(const strut_signal *signal, double t, double *value, double *rate) {
  size_t low = strut_signal_points_until(signal, t);
  *rate = 0.0;
  *value = signal->value[low ? low - 1 : 0];
  if (low == 0 || low == signal->point_count) return;
  double span = signal->time[low] - signal->time[low - 1],
         rise = signal->value[low] - signal->value[low - 1];
  *value += rise * ((t - signal->time[low - 1]) / span);
  *rate = rise / span;
}

/* ---- measured signals ---- */

static double span_of(const strut_signal *signal) {
  return signal->time[signal->point_count - 1] - signal->time[0];
}

/* Periods of repeated data before t, so that the time that they end at is the next one's. */
static double cycles_before(const strut_signal *signal, double t) {
  double first = signal->time[0], span = span_of(signal), k = floor((t - first) / span);
  if (signal->outside != STRUT_OUTSIDE_REPEAT) return 0.0;
  if (first + (k + 1.0) * span <= t) return k + 1.0;
  return first + k * span > t ? k - 1.0 : k;
}

double strut_signal_data_time(const strut_signal *signal, double t) {
  if (signal->outside != STRUT_OUTSIDE_REPEAT) return t;
  double within = t - cycles_before(signal, t) * span_of(signal);
  double last = signal->time[signal->point_count - 1];
  return fmin(fmax(within, signal->time[0]), nextafter(last, signal->time[0]));
}

/* The slope of a piece, the first of which is 0. */
static double secant(const strut_signal *signal, size_t i) {
  return (signal->value[i + 1] - signal->value[i]) / (signal->time[i + 1] - signal->time[i]);
}

/* Steffen's at point i: none at extrema, and so that values between points never leave them. */
static double slope_at(const strut_signal *signal, size_t i) {
  const double *t = signal->time;
  if (i == 0) return secant(signal, 0);
  if (i + 1 == signal->point_count) return secant(signal, i - 1);
  double before = secant(signal, i - 1), after = secant(signal, i);
  double mean = (before * (t[i + 1] - t[i]) + after * (t[i] - t[i - 1])) / (t[i + 1] - t[i - 1]);
  return (copysign(1.0, before) + copysign(1.0, after)) *
         fmin(fmin(fabs(before), fabs(after)), 0.5 * fabs(mean));
}

/* Value, rate and second derivative of the spline. */
static void evaluate_spline(const strut_signal *signal, double t, double result[3]) {
  size_t low = strut_signal_points_until(signal, t);
  bool outside = low == 0 || low == signal->point_count;
  result[0] = signal->value[low ? low - 1 : 0];
  result[1] = result[2] = 0.0;
  if (outside) return;
  size_t i = low - 1;
  double h = signal->time[low] - signal->time[i], u = t - signal->time[i];
  double a = slope_at(signal, i), b = slope_at(signal, low), s = secant(signal, i);
  double c = (3.0 * s - 2.0 * a - b) / h, d = (a + b - 2.0 * s) / (h * h);
  result[0] += u * (a + u * (c + u * d));
  result[1] = a + u * (2.0 * c + u * 3.0 * d);
  result[2] = 2.0 * c + 6.0 * u * d;
}

static void evaluate_data(const strut_signal *signal, double t, double *value, double *rate) {
  double spline[3], within = strut_signal_data_time(signal, t);
  if (!signal->smooth) {
    evaluate_table(signal, within, value, rate);
    return;
  }
  evaluate_spline(signal, within, spline);
  *value = spline[0], *rate = spline[1];
}

/* At the points, where rates jump or, of splines, their changes; repeated data end where they begin. */
static double next_break_of_data(const strut_signal *signal, double t) {
  bool repeats = signal->outside == STRUT_OUTSIDE_REPEAT;
  double cycles = cycles_before(signal, t), before = cycles * span_of(signal);
  for (size_t i = strut_signal_points_until(signal, t - before); i < signal->point_count; i++) {
    bool ends = repeats && i + 1 == signal->point_count;
    double at =
        ends ? signal->time[0] + (cycles + 1.0) * span_of(signal) : signal->time[i] + before;
    if (at > t && (i > 0 || !repeats)) return at;
  }
  return (double)INFINITY;
}

/* Evaluates all kinds but the sine, which strut_signal_evaluate handles first. */
static void evaluate_other(const strut_signal *signals, const strut_signal_inputs *in,
                           int32_t index, double t, double turns, double *value, double *rate) {
  const strut_signal *signal = &signals[index];
  *value = *rate = 0.0;
  /* a value outside its time */
  bool holds = signal->kind == STRUT_RAMP || strut_signal_has_points(signal) ||
               strut_signal_has_program(signal);
  if (!holds && (t < signal->start || t >= signal->stop)) return;
  switch (signal->kind) {
    case STRUT_SINE: break;
    case STRUT_RAMP: evaluate_ramp(signal, t, value, rate); break;
    case STRUT_TABLE: evaluate_table(signal, t, value, rate); break;
    case STRUT_DATA: evaluate_data(signal, t, value, rate); break;
    case STRUT_CONSTANT: *value = signal->amplitude; break;
    case STRUT_HALF_SINE:
      if (turns < 0.5) evaluate_wave(signal, turns, value, rate);
      break;
    case STRUT_SQUARE:
      *value = turns - floor(turns) < 0.5 ? signal->amplitude : -signal->amplitude;
      break;
    case STRUT_SUM:
      for (size_t i = 0; i < signal->term_count; i++) {
        double part, part_rate;
        strut_signal_follow(signals, in, signal->terms[i], t, &part, &part_rate);
        *value += part;
        *rate += part_rate;
      }
      break;
    case STRUT_EXPRESSION:
      strut_program_evaluate(&signal->program, signals, in, t, value, rate);
      break;
    case STRUT_RELAY:
      *value = in ? strut_relay_value(signal, in->relay_side[index]) : (double)NAN;
      break;
    case STRUT_SIGNAL_KINDS: break;
  }
}

/* In the signal's own time. */
static inline void evaluate_at(const strut_signal *signals, const strut_signal_inputs *in,
                               int32_t index, double t, double *value, double *rate) {
  const strut_signal *signal = &signals[index];
  double turns = signal->frequency * (t - signal->start) + signal->phase;
  if (signal->kind == STRUT_SINE && t >= signal->start && t < signal->stop)
    evaluate_wave(signal, turns, value, rate);
  else
    evaluate_other(signals, in, index, t, turns, value, rate);
}

void strut_signal_evaluate(const strut_signal *signals, int32_t index, double t, double *value,
                           double *rate) {
  evaluate_at(signals, NULL, index, t, value, rate);
}

void strut_signal_follow_unlagged(const strut_signal *signals, const strut_signal_inputs *in,
                                  int32_t index, double t, double *value, double *rate) {
  if (signals[index].trigger.kind != STRUT_TRIGGER_NONE) {
    double since = in ? in->started[index] : (double)NAN;
    *value = *rate = in ? 0.0 : (double)NAN;
    if (!(t >= since)) return;
    t -= since;
  }
  evaluate_at(signals, in, index, t, value, rate);
}

void strut_signal_follow_unsampled(const strut_signal *signals, const strut_signal_inputs *in,
                                   int32_t index, double t, double *value, double *rate) {
  const strut_signal *signal = &signals[index];
  if (!(signal->lag > 0.0)) {
    strut_signal_follow_unlagged(signals, in, index, t, value, rate);
    return;
  }
  *value = in ? in->state[in->lag_of[index]] : (double)NAN;
  *rate = in ? 0.0 : (double)NAN;
  if (!in || in->values_only) return;
  strut_signal_inputs values = *in;
  double wanted, unused;
  values.values_only = true;
  strut_signal_follow_unlagged(signals, &values, index, t, &wanted, &unused);
  *rate = (wanted - *value) / signal->lag;
}

void strut_signal_follow(const strut_signal *signals, const strut_signal_inputs *in, int32_t index,
                         double t, double *value, double *rate) {
  if (!(signals[index].every > 0.0)) {
    strut_signal_follow_unsampled(signals, in, index, t, value, rate);
    return;
  }
  *value = in ? in->held[index] : (double)NAN;
  *rate = 0.0;
}

/* The first multiple of half a period after t, counted from where the phase is 0. */
static double next_half_period(const strut_signal *signal, double t) {
  double halves = 2.0 * (signal->frequency * (t - signal->start) + signal->phase);
  double next = floor(halves) + 1.0;
  double at = signal->start + (0.5 * next - signal->phase) / signal->frequency;
  if (!(at > t)) at = signal->start + (0.5 * (next + 1.0) - signal->phase) / signal->frequency;
  return at;
}

double strut_program_next_break(const strut_signal *signals, const double *started,
                                const strut_program *program, double t, double until) {
  double first = until;
  for (size_t i = 0; i < program->length; i++)
    if (program->instruction[i].operation == STRUT_OPERATION_COLUMN &&
        program->instruction[i].column.kind == STRUT_COLUMN_SIGNAL)
      first = fmin(first, strut_signal_next_break_since(
                              signals, started, program->instruction[i].column.item, t, first));
  return fmin(first, strut_program_next_kink(program, signals, started, t, first));
}

static double next_break_inside(const strut_signal *signals, const double *started,
                                const strut_signal *signal, double t, double until) {
  double first = (double)INFINITY;
  size_t past;
  switch (signal->kind) {
    case STRUT_SQUARE: return next_half_period(signal, t);
    case STRUT_HALF_SINE: return signal->start + 0.5 / signal->frequency;
    case STRUT_TABLE:
      past = strut_signal_points_until(signal, t);
      return past < signal->point_count ? signal->time[past] : first;
    case STRUT_DATA: return next_break_of_data(signal, t);
    case STRUT_SUM:
      for (size_t i = 0; i < signal->term_count; i++)
        first = fmin(first, strut_signal_next_break_since(signals, started, signal->terms[i], t,
                                                          fmin(first, until)));
      return first;
    case STRUT_EXPRESSION:
    case STRUT_RELAY: /* its input's: there it may switch */
      return strut_program_next_break(signals, started, &signal->program, t, until);
    case STRUT_CONSTANT:
    case STRUT_SINE:
    case STRUT_RAMP:
    case STRUT_SIGNAL_KINDS: break;
  }
  return first;
}

/* Of a signal in its own time. */
static double next_break_of(const strut_signal *signals, const double *started, int32_t index,
                            double t, double until) {
  const strut_signal *signal = &signals[index];
  if (strut_signal_has_points(signal) || strut_signal_has_program(signal))
    return next_break_inside(signals, started, signal, t, until);
  if (t < signal->start) return signal->start;
  double first = next_break_inside(signals, started, signal, t, until);
  if (!(first > t)) first = (double)INFINITY;
  return t < signal->stop ? fmin(first, signal->stop) : (double)INFINITY;
}

double strut_signal_next_break_since(const strut_signal *signals, const double *started,
                                     int32_t index, double t, double until) {
  const strut_signal *signal = &signals[index];
  if (signal->trigger.kind != STRUT_TRIGGER_NONE && started) {
    double since = started[index];
    if (!(since < (double)INFINITY)) return (double)INFINITY;
    if (t < since) return since;
    return since + next_break_of(signals, started, index, t - since, until - since);
  }
  return next_break_of(signals, started, index, t, until);
}

double strut_signal_next_break(const strut_signal *signals, int32_t index, double t) {
  return strut_signal_next_break_since(signals, NULL, index, t, (double)INFINITY);
}

/* Period of a signal that repeats by itself; 0: it does not. */
static double own_period(const strut_signal *signal) {
  if (signal->kind == STRUT_SINE || signal->kind == STRUT_SQUARE) return 1.0 / signal->frequency;
  bool repeats = signal->kind == STRUT_DATA && signal->outside == STRUT_OUTSIDE_REPEAT;
  return repeats ? span_of(signal) : 0.0;
}

/* Longest period among a signal's repeating parts, or among its pulses; 0 without any. */
static double longest_period(const strut_signal *signals, int32_t index, bool pulses) {
  const strut_signal *signal = &signals[index];
  if (pulses && signal->kind == STRUT_HALF_SINE) return 1.0 / signal->frequency;
  if (!pulses && own_period(signal) > 0.0) return own_period(signal);
  double longest = 0.0;
  for (size_t i = 0; signal->kind == STRUT_SUM && i < signal->term_count; i++)
    longest = fmax(longest, longest_period(signals, signal->terms[i], pulses));
  return longest;
}

/* True where every repeating part of the signal fits a whole number of times into `period`. */
static bool repeats_within(const strut_signal *signals, int32_t index, double period) {
  const strut_signal *signal = &signals[index];
  double own = own_period(signal);
  if (own > 0.0) {
    double times = signal->kind == STRUT_DATA ? period / own : period * signal->frequency;
    return fabs(times - floor(times + 0.5)) <= 1e-9 * times;
  }
  for (size_t i = 0; signal->kind == STRUT_SUM && i < signal->term_count; i++)
    if (!repeats_within(signals, signal->terms[i], period)) return false;
  return true;
}

double strut_signal_period(const strut_signal *signals, int32_t index) {
  double longest = longest_period(signals, index, false);
  if (longest == 0.0) return longest_period(signals, index, true);
  return repeats_within(signals, index, longest) ? longest : 0.0;
}

/* ---- when signals turn or jump, and by how much ---- */

/* Turns and zeros per wave that are tested: later ones resemble them. */
enum { WAVES = 8, MOST_TIMES = 256 };

typedef struct times {
  double from, to, *time;
  size_t count, capacity;
} times;

static void add_time(times *self, double time) {
  if (time >= self->from && time <= self->to && self->count < self->capacity)
    self->time[self->count++] = time;
}

/* Adds zeros and turns, a quarter of a period apart. */
static void add_wave(const strut_signal *signal, times *self) {
  double begin = fmax(self->from, signal->start);
  double quarter = floor(4.0 * (signal->frequency * (begin - signal->start) + signal->phase));
  for (int k = 0; k < 2 * WAVES; k++)
    add_time(self, signal->start + (0.25 * (quarter + k) - signal->phase) / signal->frequency);
}

static void add_signal(const strut_signal *signals, int32_t index, times *self) {
  const strut_signal *signal = &signals[index];
  add_time(self, signal->start);
  add_time(self, signal->stop);
  if (signal->kind == STRUT_SINE || signal->kind == STRUT_SQUARE || signal->kind == STRUT_HALF_SINE)
    add_wave(signal, self);
  for (size_t i = 0; strut_signal_has_points(signal) && i < signal->point_count; i++)
    add_time(self, signal->time[i]);
  for (size_t i = 0; signal->kind == STRUT_SUM && i < signal->term_count; i++)
    add_signal(signals, signal->terms[i], self);
}

size_t strut_signal_times(const strut_signal *signals, int32_t index, double from, double to,
                          double *time, size_t capacity) {
  times t = {.from = from, .to = to, .time = time, .capacity = capacity};
  add_signal(signals, index, &t);
  return t.count;
}

double strut_signal_jump(const strut_signal *signals, int32_t index, double step, double from,
                         double to, double *when) {
  double time[MOST_TIMES], largest = 0.0;
  size_t count = strut_signal_times(signals, index, from, to, time, MOST_TIMES);
  for (size_t i = 0; i < count; i++) {
    double before, after, rate;
    strut_signal_evaluate(signals, index, time[i] - 1e-6 * step, &before, &rate);
    strut_signal_evaluate(signals, index, time[i] + step, &after, &rate);
    if (!(fabs(after - before) > largest * (1.0 + 1e-9))) continue;
    largest = fabs(after - before);
    *when = time[i];
  }
  return largest;
}

/* ---- signals as motions ---- */

/* Values below this part of the amplitude are zero but for rounding. */
static const double ROUNDING = 1e-9;

static double wave_acceleration(const strut_signal *signal, double turns) {
  double sine, cosine, omega = STRUT_TAU * signal->frequency;
  strut_sincos_turns(turns, &sine, &cosine);
  return -signal->amplitude * omega * omega * sine;
}

double strut_signal_acceleration(const strut_signal *signals, int32_t index, double t) {
  const strut_signal *signal = &signals[index];
  double turns = signal->frequency * (t - signal->start) + signal->phase, sum = 0.0, spline[3];
  bool on = t >= signal->start && t < signal->stop;
  switch (signal->kind) {
    case STRUT_SINE: return on ? wave_acceleration(signal, turns) : 0.0;
    case STRUT_HALF_SINE: return on && turns < 0.5 ? wave_acceleration(signal, turns) : 0.0;
    case STRUT_SUM:
      for (size_t i = 0; i < signal->term_count && on; i++)
        sum += strut_signal_acceleration(signals, signal->terms[i], t);
      return sum;
    case STRUT_DATA:
      if (!signal->smooth) break;
      evaluate_spline(signal, strut_signal_data_time(signal, t), spline);
      return spline[2];
    case STRUT_CONSTANT:
    case STRUT_SQUARE:
    case STRUT_RAMP:
    case STRUT_TABLE:
    case STRUT_EXPRESSION:
    case STRUT_RELAY:
    case STRUT_SIGNAL_KINDS: break;
  }
  return 0.0;
}

/* Is the signal away from zero at its time `at`, where it is switched on or off? */
static bool is_cut(const strut_signal *signal, double at) {
  double sine, cosine;
  if (signal->kind == STRUT_CONSTANT || signal->kind == STRUT_SQUARE)
    return signal->amplitude != 0.0;
  double turns = signal->frequency * (at - signal->start) + signal->phase;
  if (signal->kind == STRUT_HALF_SINE && turns >= 0.5) return false;
  strut_sincos_turns(turns, &sine, &cosine);
  return signal->amplitude != 0.0 && fabs(sine) > ROUNDING * (1.0 + fabs(turns));
}

/* A start or stop of the signal after 0 and up to `last`, if there is one. */
static bool switches_within(double time, double last) {
  return time > 0.0 && time <= last && time < HUGE_VAL;
}

bool strut_signal_value_jumps(const strut_signal *signals, int32_t index, double last,
                              double *when) {
  const strut_signal *signal = &signals[index];
  switch (signal->kind) {
    case STRUT_RAMP: return false;
    case STRUT_TABLE:
      for (size_t i = 1; i < signal->point_count; i++)
        if (signal->time[i] == signal->time[i - 1] && signal->value[i] != signal->value[i - 1] &&
            switches_within(*when = signal->time[i], last))
          return true;
      return false;
    case STRUT_DATA: /* where they are repeated */
      if (signal->outside != STRUT_OUTSIDE_REPEAT) return false;
      *when = signal->time[0] + (cycles_before(signal, 0.0) + 1.0) * span_of(signal);
      return signal->value[0] != signal->value[signal->point_count - 1] && *when <= last;
    case STRUT_SUM:
      for (size_t i = 0; i < signal->term_count; i++)
        if (strut_signal_value_jumps(signals, signal->terms[i], last, when)) return true;
      return false;
    case STRUT_SQUARE:
      *when = strut_signal_next_break(signals, index, 0.0);
      if (signal->amplitude != 0.0 && *when <= last) return true;
      break;
    case STRUT_CONSTANT:
    case STRUT_SINE:
    case STRUT_HALF_SINE:
    case STRUT_EXPRESSION:
    case STRUT_RELAY:
    case STRUT_SIGNAL_KINDS: break;
  }
  if (switches_within(*when = signal->start, last) && is_cut(signal, signal->start)) return true;
  return switches_within(*when = signal->stop, last) && is_cut(signal, signal->stop);
}

bool strut_signal_is_wave(const strut_signal *signals, int32_t index) {
  const strut_signal *signal = &signals[index];
  if (strut_signal_has_program(signal) || signal->lag > 0.0 || signal->every > 0.0) return false;
  if (signal->trigger.kind != STRUT_TRIGGER_NONE) return false;
  for (size_t i = 0; signal->kind == STRUT_SUM && i < signal->term_count; i++)
    if (!strut_signal_is_wave(signals, signal->terms[i])) return false;
  return true;
}

bool strut_signal_has_corners(const strut_signal *signals, int32_t index) {
  return strut_signal_next_break(signals, index, 0.0) < HUGE_VAL;
}
