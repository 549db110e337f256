/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interval arithmetic of signals. See signal_program.h. */
#include <assert.h>
#include <float.h>
#include <math.h>

#include "engine/scene/signal_program.h"

#include "engine/base/vec.h"

/* What an evaluation goes by, and what it has found. */
typedef struct bounder {
  const strut_signal *signals;
  const strut_signal_inputs *in; /* NULL: what follows the motion may be anything */
  const double *started;         /* NULL: no signal has a trigger */
  double from, to;
  bool undecided;    /* an argument that depends on the time alone may pass an edge within */
  uint64_t branches; /* on which sides the arguments are, each hashed to the others */
} bounder;

static const strut_range ANY = {-HUGE_VAL, HUGE_VAL}, ZERO = {0.0, 0.0};
static const strut_signal_bounds ANYTHING = {{-HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, HUGE_VAL}, true};

/* ---- ranges ---- */

static strut_range exactly(double x) { return isnan(x) ? ANY : (strut_range){x, x}; }

/* From low to high, and what rounding of them may leave out. */
static strut_range outward(double low, double high) {
  if (!(low < HUGE_VAL && high > -HUGE_VAL)) return ANY;
  return (strut_range){low - 2.0 * DBL_EPSILON * fabs(low), high + 2.0 * DBL_EPSILON * fabs(high)};
}

static strut_range hull(strut_range a, strut_range b) {
  return (strut_range){fmin(a.low, b.low), fmax(a.high, b.high)};
}

static bool has(strut_range a, double x) { return a.low <= x && x <= a.high; }
static double width(strut_range a) { return a.high - a.low; }
static double size_of(strut_range a) { return fmax(fabs(a.low), fabs(a.high)); }
static strut_range plus(strut_range a, strut_range b) {
  return outward(a.low + b.low, a.high + b.high);
}
static strut_range negative(strut_range a) { return (strut_range){-a.high, -a.low}; }

static double product(double a, double b) { return a == 0.0 || b == 0.0 ? 0.0 : a * b; }

static strut_range times(strut_range a, strut_range b) {
  double w = product(a.low, b.low), x = product(a.low, b.high), y = product(a.high, b.low),
         z = product(a.high, b.high);
  return outward(fmin(fmin(w, x), fmin(y, z)), fmax(fmax(w, x), fmax(y, z)));
}

static strut_range inverse(strut_range a) {
  return has(a, 0.0) && a.low != 0.0 && a.high != 0.0 ? ANY
         : a.low == 0.0 && a.high == 0.0              ? ANY
         : a.low == 0.0                               ? outward(1.0 / a.high, HUGE_VAL)
         : a.high == 0.0                              ? outward(-HUGE_VAL, 1.0 / a.low)
                                                      : outward(1.0 / a.high, 1.0 / a.low);
}

static strut_range magnitude(strut_range a) {
  return a.low >= 0.0 ? a : a.high <= 0.0 ? negative(a) : (strut_range){0.0, size_of(a)};
}

static strut_range square(strut_range a) {
  strut_range m = magnitude(a);
  return outward(m.low * m.low, m.high * m.high);
}

static strut_range root(strut_range a) { return outward(sqrt(fmax(a.low, 0.0)), sqrt(a.high)); }

/* Of the sine of `turns` full turns. */
static strut_range sine_of_turns(strut_range turns) {
  if (!(width(turns) < 1.0)) return (strut_range){-1.0, 1.0};
  double a = sin(STRUT_TAU * (turns.low - floor(turns.low)));
  double b = sin(STRUT_TAU * (turns.high - floor(turns.high)));
  double slack = 8.0 * DBL_EPSILON * (1.0 + size_of(turns));
  bool top = floor(turns.high - 0.25) > floor(turns.low - 0.25);
  bool bottom = floor(turns.high - 0.75) > floor(turns.low - 0.75);
  return (strut_range){bottom ? -1.0 : fmin(a, b) - slack, top ? 1.0 : fmax(a, b) + slack};
}

static strut_range sine(strut_range x, double ahead) {
  return sine_of_turns((strut_range){x.low / STRUT_TAU + ahead, x.high / STRUT_TAU + ahead});
}

static strut_range rising(double (*f)(double), strut_range x) {
  return outward(f(x.low), f(x.high));
}

/* x^n, n whole. */
static strut_range whole_power(strut_range x, double n) {
  if (n < 0.0) return inverse(whole_power(x, -n));
  if (fmod(n, 2.0) == 0.0) x = magnitude(x);
  return outward(pow(x.low, n), pow(x.high, n));
}

static strut_range power(strut_range x, strut_range y) {
  if (width(y) == 0.0 && y.low == floor(y.low) && fabs(y.low) < 1e9) return whole_power(x, y.low);
  if (x.low < 0.0) return ANY;
  double a = pow(x.low, y.low), b = pow(x.low, y.high), c = pow(x.high, y.low),
         d = pow(x.high, y.high);
  return outward(fmin(fmin(a, b), fmin(c, d)), fmax(fmax(a, b), fmax(c, d)));
}

/* ---- operations ---- */

/* slope * rate, 0 where nothing changes. */
static strut_range chain(strut_range slope, strut_range rate) {
  return rate.low == 0.0 && rate.high == 0.0 ? ZERO : times(slope, rate);
}

static void note_branch(bounder *self, uint64_t side) {
  self->branches = (self->branches ^ side) * UINT64_C(0x100000001b3);
}

/* Notes the side of 0 on which x is. 1 above, -1 below, 0: not known. */
static int side_of(bounder *self, strut_range x, bool follows, bool still) {
  int side = x.low > 0.0 ? 1 : x.high < 0.0 ? -1 : 0;
  note_branch(self, side < 0 ? 1 : 2);
  if (side == 0 && !follows && !still) self->undecided = true;
  return side;
}

static bool is_still(strut_signal_bounds a) { return a.rate.low == 0.0 && a.rate.high == 0.0; }

static strut_signal_bounds least_of(bounder *self, strut_signal_bounds x, strut_signal_bounds y) {
  strut_range above = plus(y.value, negative(x.value));
  int side = side_of(self, above, x.follows || y.follows, is_still(x) && is_still(y));
  strut_signal_bounds both = {{fmin(x.value.low, y.value.low), fmin(x.value.high, y.value.high)},
                              hull(x.rate, y.rate),
                              false};
  return side > 0 ? x : side < 0 ? y : both;
}

static strut_signal_bounds opposite(strut_signal_bounds x) {
  return (strut_signal_bounds){negative(x.value), negative(x.rate), x.follows};
}

static strut_signal_bounds size(bounder *self, strut_signal_bounds x) {
  int side = side_of(self, x.value, x.follows, is_still(x));
  if (side != 0) return side > 0 ? x : opposite(x);
  return (strut_signal_bounds){magnitude(x.value), hull(x.rate, negative(x.rate)), x.follows};
}

static strut_signal_bounds stairs(bounder *self, strut_signal_bounds x, double (*f)(double)) {
  strut_range value = {f(x.value.low), f(x.value.high)};
  note_branch(self, (uint64_t)(int64_t)fmax(fmin(value.high, 1e15), -1e15));
  if (value.low != value.high && !x.follows && !is_still(x)) self->undecided = true;
  return (strut_signal_bounds){isnan(width(value)) ? ANY : value, ZERO, x.follows};
}

static strut_signal_bounds angle(bounder *self, strut_signal_bounds y, strut_signal_bounds x) {
  strut_range far = plus(square(x.value), square(y.value));
  strut_range turn = plus(times(x.value, y.rate), negative(times(y.value, x.rate)));
  strut_signal_bounds result = {
      {-0.5 * STRUT_TAU, 0.5 * STRUT_TAU}, chain(inverse(far), turn), false};
  bool follows = x.follows || y.follows;
  int side = x.value.low > 0.0 ? 1 : side_of(self, y.value, follows, is_still(y));
  if (side == 0) return result;
  double c[4] = {atan2(y.value.low, x.value.low), atan2(y.value.low, x.value.high),
                 atan2(y.value.high, x.value.low), atan2(y.value.high, x.value.high)};
  result.value =
      outward(fmin(fmin(c[0], c[1]), fmin(c[2], c[3])), fmax(fmax(c[0], c[1]), fmax(c[2], c[3])));
  return result;
}

static strut_signal_bounds distance(strut_signal_bounds x, strut_signal_bounds y) {
  strut_signal_bounds result = {.value = root(plus(square(x.value), square(y.value)))};
  double most = hypot(size_of(x.rate), size_of(y.rate)); /* whatever the direction */
  strut_range along = plus(times(x.value, x.rate), times(y.value, y.rate));
  result.rate = chain(inverse(result.value), along);
  result.rate = (strut_range){fmax(result.rate.low, -most), fmin(result.rate.high, most)};
  return result;
}

static strut_signal_bounds raise_bounds(strut_signal_bounds x, strut_signal_bounds y) {
  strut_signal_bounds result = {.value = power(x.value, y.value)};
  strut_range less = {y.value.low - 1.0, y.value.high - 1.0};
  strut_range slope = times(y.value, power(x.value, less));
  result.rate = chain(slope, x.rate);
  if (!is_still(y)) {
    strut_range log_of = x.value.low > 0.0 ? rising(log, x.value) : ANY;
    result.rate = plus(result.rate, times(times(result.value, log_of), y.rate));
  }
  return result;
}

static strut_signal_bounds combine(bounder *self, strut_operation operation, strut_signal_bounds x,
                                   strut_signal_bounds y) {
  strut_signal_bounds result = ANYTHING;
  switch ((int)operation) {
    case STRUT_OPERATION_ADD:
      result = (strut_signal_bounds){plus(x.value, y.value), plus(x.rate, y.rate), false};
      break;
    case STRUT_OPERATION_SUBTRACT:
      result = (strut_signal_bounds){plus(x.value, negative(y.value)),
                                     plus(x.rate, negative(y.rate)), false};
      break;
    case STRUT_OPERATION_MULTIPLY:
      result.value = times(x.value, y.value);
      result.rate = plus(times(x.rate, y.value), times(x.value, y.rate));
      break;
    case STRUT_OPERATION_DIVIDE:
      result.value = times(x.value, inverse(y.value));
      result.rate = plus(x.rate, negative(chain(result.value, y.rate)));
      result.rate = chain(inverse(y.value), result.rate);
      break;
    case STRUT_OPERATION_POWER: result = raise_bounds(x, y); break;
    case STRUT_OPERATION_MIN: result = least_of(self, x, y); break;
    case STRUT_OPERATION_MAX: result = opposite(least_of(self, opposite(x), opposite(y))); break;
    case STRUT_OPERATION_ATAN2: result = angle(self, x, y); break;
    case STRUT_OPERATION_HYPOT: result = distance(x, y); break;
    default: break;
  }
  result.follows = x.follows || y.follows;
  return result;
}

static strut_signal_bounds apply(bounder *self, strut_operation operation, strut_signal_bounds a) {
  const double ten = 2.30258509299404568402; /* log 10 */
  const strut_range x = a.value, one = {1.0, 1.0};
  strut_range y = ANY, slope = ANY;
  switch ((int)operation) {
    case STRUT_OPERATION_NEGATE: return opposite(a);
    case STRUT_OPERATION_ABS: return size(self, a);
    case STRUT_OPERATION_FLOOR: return stairs(self, a, floor);
    case STRUT_OPERATION_CEIL: return stairs(self, a, ceil);
    case STRUT_OPERATION_ROUND: return stairs(self, a, round);
    case STRUT_OPERATION_SIN: y = sine(x, 0.0), slope = sine(x, 0.25); break;
    case STRUT_OPERATION_COS: y = sine(x, 0.25), slope = sine(x, 0.5); break;
    case STRUT_OPERATION_TAN:
      if (width(x) < 3.0 && !has(sine(x, 0.25), 0.0))
        y = rising(tan, x), slope = plus(one, square(y));
      break;
    case STRUT_OPERATION_ASIN:
    case STRUT_OPERATION_ACOS:
      if (x.low < -1.0 || x.high > 1.0) break;
      y = operation == STRUT_OPERATION_ASIN ? rising(asin, x) : outward(acos(x.high), acos(x.low));
      slope = inverse(root(plus(one, negative(square(x)))));
      if (operation == STRUT_OPERATION_ACOS) slope = negative(slope);
      break;
    case STRUT_OPERATION_ATAN: y = rising(atan, x), slope = inverse(plus(one, square(x))); break;
    case STRUT_OPERATION_SQRT: y = root(x), slope = times(exactly(0.5), inverse(y)); break;
    case STRUT_OPERATION_EXP: slope = y = rising(exp, x); break;
    case STRUT_OPERATION_LOG:
    case STRUT_OPERATION_LOG10:
      if (x.low < 0.0) break;
      y = rising(operation == STRUT_OPERATION_LOG ? log : log10, x), slope = inverse(x);
      if (operation == STRUT_OPERATION_LOG10) slope = times(exactly(1.0 / ten), slope);
      break;
    case STRUT_OPERATION_TANH: y = rising(tanh, x), slope = plus(one, negative(square(y))); break;
    default: break;
  }
  return (strut_signal_bounds){y, chain(slope, a.rate), a.follows};
}

/* ---- signals ---- */

/* A value that stays while the motion does; any where none is known. */
static strut_signal_bounds held(const bounder *self, double value) {
  if (!self->in) return ANYTHING;
  return (strut_signal_bounds){exactly(value), ZERO, true};
}

static strut_signal_bounds bound_wave(const strut_signal *signal, double from, double to) {
  double begin = signal->frequency * (from - signal->start) + signal->phase;
  double end = signal->frequency * (to - signal->start) + signal->phase;
  if (signal->kind == STRUT_HALF_SINE) begin = fmax(begin, 0.0), end = fmin(end, 0.5);
  if (!(begin <= end)) return (strut_signal_bounds){ZERO, ZERO, false};
  strut_range turns = {begin, end}, later = {begin + 0.25, end + 0.25};
  return (strut_signal_bounds){
      times(exactly(signal->amplitude), sine_of_turns(turns)),
      times(exactly(signal->amplitude * STRUT_TAU * signal->frequency), sine_of_turns(later)),
      false};
}

/* Of a signal that is linear between its points. */
static strut_signal_bounds bound_pieces(const bounder *self, int32_t index, double from,
                                        double to) {
  double value, rate;
  strut_signal_evaluate(self->signals, index, from, &value, &rate);
  strut_signal_bounds result = {exactly(value), exactly(rate), false};
  for (double t = from; t < to;) {
    t = strut_signal_next_break(self->signals, index, t);
    strut_signal_evaluate(self->signals, index, nextafter(fmin(t, to), from), &value, &rate);
    result.value = hull(result.value, exactly(value)); /* before a jump */
    strut_signal_evaluate(self->signals, index, fmin(t, to), &value, &rate);
    result.value = hull(result.value, exactly(value));
    if (t < to) result.rate = hull(result.rate, exactly(rate));
  }
  return result;
}

/* Of a spline, which is monotone between its points: at most twice as steep as straight lines. */
static strut_signal_bounds bound_spline(const bounder *self, int32_t index, double from,
                                        double to) {
  const strut_signal *signal = &self->signals[index];
  double value, rate, begin = strut_signal_data_time(signal, from), end = begin + (to - from);
  size_t i = strut_signal_points_until(signal, begin), last = signal->point_count - 1;
  bool wraps = signal->outside == STRUT_OUTSIDE_REPEAT && end >= signal->time[last];
  strut_signal_evaluate(self->signals, index, from, &value, &rate);
  strut_signal_bounds result = {exactly(value), exactly(rate), false};
  strut_signal_evaluate(self->signals, index, to, &value, &rate);
  result.value = hull(result.value, exactly(value));
  for (i = wraps || i == 0 ? 1 : i; i <= last && (wraps || signal->time[i - 1] <= end); i++) {
    double rise = signal->value[i] - signal->value[i - 1];
    result.rate = hull(result.rate, exactly(2.0 * rise / (signal->time[i] - signal->time[i - 1])));
    result.rate = hull(result.rate, ZERO);
    if (wraps || signal->time[i] <= end)
      result.value = hull(result.value, exactly(signal->value[i]));
    if (wraps && i == 1) result.value = hull(result.value, exactly(signal->value[0]));
  }
  return result;
}

static strut_signal_bounds bound_signal(bounder *self, int32_t index, double from, double to);

static strut_signal_bounds bound_program(bounder *self, const strut_program *program, double from,
                                         double to);

static strut_signal_bounds bound_kind(bounder *self, int32_t index, double from, double to) {
  const strut_signal *signal = &self->signals[index];
  bool holds = signal->kind == STRUT_RAMP || strut_signal_has_points(signal) ||
               strut_signal_has_program(signal);
  strut_signal_bounds result = {ZERO, ZERO, false};
  double half = 2.0 * (signal->frequency * (from - signal->start) + signal->phase);
  if (!holds && (to < signal->start || from >= signal->stop)) return result;
  switch (signal->kind) {
    case STRUT_CONSTANT: result.value = exactly(signal->amplitude); break;
    case STRUT_SINE:
    case STRUT_HALF_SINE:
      result = bound_wave(signal, fmax(from, signal->start), fmin(to, signal->stop));
      break;
    case STRUT_SQUARE:
      if (from >= signal->start &&
          floor(half) == floor(half + 2.0 * signal->frequency * (to - from)))
        result.value =
            exactly(fmod(floor(half), 2.0) == 0.0 ? signal->amplitude : -signal->amplitude);
      else
        result.value = (strut_range){-fabs(signal->amplitude), fabs(signal->amplitude)};
      break;
    case STRUT_RAMP:
    case STRUT_TABLE: return bound_pieces(self, index, from, to);
    case STRUT_DATA:
      return signal->smooth ? bound_spline(self, index, from, to)
                            : bound_pieces(self, index, from, to);
    case STRUT_SUM:
      for (size_t i = 0; i < signal->term_count; i++) {
        strut_signal_bounds part = bound_signal(self, signal->terms[i], from, to);
        result.value = plus(result.value, part.value), result.rate = plus(result.rate, part.rate);
        result.follows = result.follows || part.follows;
      }
      break;
    case STRUT_EXPRESSION: return bound_program(self, &signal->program, from, to);
    case STRUT_RELAY:
      return held(self,
                  self->in ? strut_relay_value(signal, self->in->relay_side[index]) : (double)NAN);
    case STRUT_SIGNAL_KINDS: break;
  }
  if (from < signal->start || to >= signal->stop) result.value = hull(result.value, ZERO);
  return result;
}

static strut_signal_bounds bound_signal(bounder *self, int32_t index, double from, double to) {
  const strut_signal *signal = &self->signals[index];
  const bounder outside = *self;
  if (signal->every > 0.0) return held(self, self->in ? self->in->held[index] : (double)NAN);
  if (signal->lag > 0.0)
    return held(self, self->in ? self->in->state[self->in->lag_of[index]] : (double)NAN);
  if (signal->trigger.kind != STRUT_TRIGGER_NONE) {
    double since = self->started ? self->started[index] : (double)NAN;
    if (isnan(since)) return ANYTHING;
    if (to < since) return (strut_signal_bounds){ZERO, ZERO, false};
    from = fmax(from - since, 0.0), to -= since;
  }
  strut_signal_bounds result = bound_kind(self, index, from, to);
  self->undecided = outside.undecided; /* of its own kinks strut_signal_next_break knows */
  self->branches = outside.branches;
  return result;
}

static strut_signal_bounds bound_column(bounder *self, strut_column column, double from,
                                        double to) {
  switch ((int)column.kind) {
    case STRUT_COLUMN_TIME: return (strut_signal_bounds){{from, to}, {1.0, 1.0}, false};
    case STRUT_COLUMN_SIGNAL: return bound_signal(self, column.item, from, to);
    case STRUT_COLUMN_SENSOR:
      return held(self, self->in ? self->in->sensor[column.item] : (double)NAN);
    case STRUT_COLUMN_SENSOR_RATE:
      return held(self, self->in ? self->in->sensor_rate[column.item] : (double)NAN);
    case STRUT_COLUMN_STATE:
      return held(self, self->in ? self->in->state[column.item] : (double)NAN);
    default: return ANYTHING;
  }
}

static strut_signal_bounds bound_program(bounder *self, const strut_program *program, double from,
                                         double to) {
  strut_signal_bounds stack[STRUT_MOST_PROGRAM_DEPTH];
  size_t top = 0;
  for (size_t i = 0; i < program->length; i++) {
    const strut_instruction *instruction = &program->instruction[i];
    int operands = strut_operation_operands(instruction->operation);
    assert(top >= (size_t)operands && top < STRUT_MOST_PROGRAM_DEPTH + (size_t)operands);
    if (instruction->operation == STRUT_OPERATION_NUMBER) {
      stack[top++] = (strut_signal_bounds){exactly(instruction->number), ZERO, false};
    } else if (operands == 0) {
      stack[top++] = bound_column(self, instruction->column, from, to);
    } else if (operands == 1) {
      stack[top - 1] = apply(self, instruction->operation, stack[top - 1]);
    } else {
      top--;
      stack[top - 1] = combine(self, instruction->operation, stack[top - 1], stack[top]);
    }
  }
  assert(top == 1);
  return stack[0];
}

strut_signal_bounds strut_program_bound(const strut_program *program, const strut_signal *signals,
                                        const strut_signal_inputs *in, double from, double to) {
  bounder b = {.signals = signals, .in = in, .started = in ? in->started : NULL};
  return bound_program(&b, program, from, to);
}

/* ---- kinks ---- */

/* Intervals that are looked at for one kink, and the width of the first finite one [s]. */
enum { MOST_INTERVALS = 4000, LOOKS_OF_WIDTH = 50 };
static const double FIRST_WIDTH = 1e3;
/* Kinks are known to this part of the time, or to so much [s]. No run lasts LATEST [s]. */
static const double RESOLUTION = 4.0 * DBL_EPSILON, LEAST_WIDTH = 1e-20, LATEST = 1e15;

static bool may_kink(const strut_program *program) {
  for (size_t i = 0; i < program->length; i++) switch ((int)program->instruction[i].operation) {
      case STRUT_OPERATION_ABS:
      case STRUT_OPERATION_MIN:
      case STRUT_OPERATION_MAX:
      case STRUT_OPERATION_FLOOR:
      case STRUT_OPERATION_CEIL:
      case STRUT_OPERATION_ROUND:
      case STRUT_OPERATION_ATAN2: return true;
      default: break;
    }
  return false;
}

static uint64_t branches_at(const bounder *self, const strut_program *program, double t) {
  bounder at = *self;
  at.branches = 0;
  bound_program(&at, program, t, t);
  return at.branches;
}

/* The end of a short time, between t and `end`, over which the branches change as they do from t to `end`. */
static double narrow(const bounder *self, const strut_program *program, double t, double end) {
  uint64_t before = branches_at(self, program, t);
  while (end - t > RESOLUTION * fabs(t) + LEAST_WIDTH) {
    double middle = t + 0.5 * (end - t);
    if (!(middle > t && middle < end)) break;
    if (branches_at(self, program, middle) == before)
      t = middle;
    else
      end = middle;
  }
  return end;
}

double strut_program_next_kink(const strut_program *program, const strut_signal *signals,
                               const double *started, double t, double until) {
  bounder b = {.signals = signals, .started = started};
  double wide = until - t,
         part = RESOLUTION; /* grows where bounds do not tell, as where edges are only touched */
  if (!may_kink(program) || !(until > t)) return (double)INFINITY;
  for (int k = 0; k < MOST_INTERVALS && t < LATEST; k++) {
    double end = fmin(t + wide, until), least = part * fabs(t) + part / RESOLUTION * LEAST_WIDTH;
    if (k % LOOKS_OF_WIDTH == LOOKS_OF_WIDTH - 1) part *= 2.0;
    b.undecided = false;
    bound_program(&b, program, t, end);
    if (!b.undecided && end >= until) return (double)INFINITY;
    if (!b.undecided) {
      t = end, wide *= 4.0;
    } else if (wide > FIRST_WIDTH && !isfinite(wide)) {
      wide = FIRST_WIDTH;
    } else if (wide > least) {
      wide *= 0.25;
    } else {
      end = t + least;
      if (branches_at(&b, program, t) != branches_at(&b, program, end))
        return narrow(&b, program, t, end);
      t = end, part *= 2.0, wide = 2.0 * least;
    }
  }
  return t < LATEST ? t : (double)INFINITY;
}

/* ---- steps ---- */

/*
 * A step shows what the signal does where its rate could not take it further than SHOWN times as far as the values at
 * begin, middle and end are apart, nor differ by more than TWICE as much as the rates there do, but for half of what
 * makes those values: parabolas pass this at any length, sines up to half a period.
 */
static const double SHOWN = 4.0, TWICE = 2.0, UNSHOWN = 0.5;
/* Intervals are wider than what they hold, by a part of their length: they are looked at in so many pieces. */
enum { PIECES = 8, MOST_HALVINGS = 60 };

/* What a step is looked at by. */
typedef struct look {
  const strut_program *program; /* NULL: the wave of the signal */
  int32_t signal;
  const strut_signal *signals;
  const strut_signal_inputs *in;
  double faint;
} look;

static strut_signal_bounds bound_between(const look *self, double from, double to) {
  bounder b = {
      .signals = self->signals, .in = self->in, .started = self->in ? self->in->started : NULL};
  if (self->program) return strut_program_bound(self->program, self->signals, self->in, from, to);
  return bound_kind(&b, self->signal, from, to);
}

/* `seen`: hulls of values and rates at begin, middle and end; `all`: of the whole step; `faint`: what may be missed. */
static bool is_shown(strut_signal_bounds seen, strut_signal_bounds all, double h, double faint) {
  double shown = width(seen.value), apart = width(seen.rate);
  if (width(all.value) <= faint) return true;
  return h * size_of(all.rate) <= SHOWN * shown + faint &&
         h * (width(all.rate) - TWICE * apart) <= UNSHOWN * shown + faint;
}

static strut_signal_bounds hull_of(strut_signal_bounds a, strut_signal_bounds b) {
  return (strut_signal_bounds){hull(a.value, b.value), hull(a.rate, b.rate), false};
}

static bool resolves(const look *self, double t, double h) {
  strut_signal_bounds all = bound_between(self, t, t + h);
  if (is_still(all)) return true;
  strut_signal_bounds seen = bound_between(self, t, t);
  for (int k = 1; k <= 2; k++)
    seen = hull_of(seen, bound_between(self, t + 0.5 * k * h, t + 0.5 * k * h));
  if (is_shown(seen, all, h, 0.0)) return true;
  double largest = size_of(bound_between(self, 0.0, HUGE_VAL).value);
  double faint = self->faint * (largest < HUGE_VAL ? largest : size_of(all.value));
  if (!(faint < HUGE_VAL)) faint = 0.0;
  if (is_shown(seen, all, h, faint)) return true;
  all = seen;
  for (int k = 0; k < PIECES; k++)
    all = hull_of(all, bound_between(self, t + k * h / PIECES, t + (k + 1) * h / PIECES));
  return is_shown(seen, all, h, faint);
}

static double longest_step(const look *self, double t, double h, double least) {
  double shorter = h;
  for (int k = 0; k < MOST_HALVINGS && !resolves(self, t, shorter); k++) {
    shorter *= 0.5;
    if (shorter > least) continue;
    /* a place that is passed; or the bounds say nothing of this program */
    return resolves(self, t + least, least) ? fmin(least, h) : h;
  }
  return shorter;
}

static bool reads_time(const strut_program *program) {
  return strut_program_reads(program, STRUT_COLUMN_TIME, STRUT_COLUMN_SIGNAL);
}

bool strut_signal_is_looked_at(const strut_signal *signal) {
  return signal->kind == STRUT_HALF_SINE ||
         (strut_signal_has_program(signal) && reads_time(&signal->program));
}

double strut_program_longest_step(const strut_program *program, const strut_signal *signals,
                                  const strut_signal_inputs *in, double t, double h, double faint,
                                  double least) {
  const look l = {program, -1, signals, in, faint};
  return reads_time(program) ? longest_step(&l, t, h, least) : h;
}

double strut_signal_longest_step(const strut_signal *signals, const strut_signal_inputs *in,
                                 int32_t index, double t, double h, double faint, double least) {
  const strut_signal *signal = &signals[index];
  const look l = {NULL, index, signals, in, faint};
  if (signal->every > 0.0 || !strut_signal_is_looked_at(signal)) return h;
  if (signal->trigger.kind != STRUT_TRIGGER_NONE) {
    double since = in ? in->started[index] : HUGE_VAL;
    if (!(t >= since)) return h;
    t -= since;
  }
  if (strut_signal_has_program(signal))
    return strut_program_longest_step(&signal->program, signals, in, t, h, faint, least);
  return longest_step(&l, t, h, least);
}
