/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Signals: the waveforms that drive rest lengths and loads.
 *
 * A signal is a plain description; a scene owns an array of them and refers to them by index. The
 * unit of a value is the one its user expects (m for an actuator, N for a load's force factor).
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/scene/quantity.h"

typedef enum strut_signal_kind {
  STRUT_CONSTANT,   /* amplitude */
  STRUT_SINE,       /* amplitude * sin(2 pi (frequency * tau + phase)) */
  STRUT_HALF_SINE,  /* one half-wave: the sine for 0 <= tau <= 1 / (2 frequency), then 0 */
  STRUT_SQUARE,     /* +amplitude in the first half of a period, -amplitude in the second */
  STRUT_RAMP,       /* from 0 at start to amplitude at stop, linearly; holds amplitude after */
  STRUT_TABLE,      /* linear between the points; holds the first and the last value outside */
  STRUT_SUM,        /* the sum of other signals */
  STRUT_EXPRESSION, /* a program of the time, sensors and other signals */
  STRUT_DATA,       /* measured: as a table, or a spline through its points */
  STRUT_RELAY,      /* one of two values, which a program switches with hysteresis */
  STRUT_SIGNAL_KINDS
} strut_signal_kind;

/** A program of a stack machine, see signal_program.h. */
typedef struct strut_program {
  size_t length, depth;                 /* instructions; the most numbers on the stack */
  const strut_instruction *instruction; /* (length) */
} strut_program;

/** What starts a signal's own time. */
typedef enum strut_trigger_kind {
  STRUT_TRIGGER_NONE,    /* the time of the run is the signal's */
  STRUT_TRIGGER_CONTACT, /* a node touches down */
  STRUT_TRIGGER_ABOVE,   /* a sensor rises above a level */
  STRUT_TRIGGER_BELOW    /* it falls below one */
} strut_trigger_kind;

typedef struct strut_trigger {
  strut_trigger_kind kind;
  int32_t item; /* node or sensor */
  double level; /* of the sensor, in its unit */
  bool each;    /* start again each time, not only once */
} strut_trigger;

/** What a measured signal is before the first and after the last of its points. */
typedef enum strut_outside {
  STRUT_OUTSIDE_ERROR, /* a run must lie between them */
  STRUT_OUTSIDE_HOLD,
  STRUT_OUTSIDE_REPEAT /* they are one period */
} strut_outside;

/** A two-position relay with hysteresis. It has a memory: on which side its input has been last. */
typedef struct strut_relay {
  double upper, lower; /* thresholds of the input */
  double on, off;      /* the two values */
  bool on_above;       /* on since the input passed the upper threshold; else since the lower one */
  bool on_at_start;    /* where the input is between the thresholds at t = 0 */
} strut_relay;

/**
 * One waveform; tau = t - start. Except for ramp, table, data, expression and relay a signal is 0 before start
 * and after stop.
 */
typedef struct strut_signal {
  const char *name;  /* as the file calls it, or NULL: then */
  const char *owner; /* how messages call it, "the signal of actuator 'd'"; or NULL */
  const char *unit;  /* of its values, "1": none; NULL: not known */
  strut_signal_kind kind;
  double amplitude;     /* [m], [N] or [1] */
  double frequency;     /* [Hz], > 0 for sine, half-sine, square */
  double phase;         /* [turns]; sine and square */
  double start, stop;   /* [s]; default 0 and INFINITY */
  size_t point_count;   /* table, data: number of points, >= 1 */
  const double *time;   /* (point_count) [s], increasing; at two alike it jumps */
  const double *value;  /* (point_count) */
  size_t term_count;    /* sum: number of terms */
  const int32_t *terms; /* (term_count) indices of signals, each below this signal's own */
  strut_program
      program; /* expression, input of a relay: signals in it are below this signal's own */
  strut_trigger trigger; /* before it starts the signal is 0; then its time counts from there */
  double lag;            /* [s] time constant of a first-order lag; 0: none */
  double every;          /* [s] between samples, after the lag; 0: the signal is continuous */
  strut_relay relay;
  const char *data, *over; /* data: its columns of values and of times; they may be shared */
  bool smooth;             /* data: by Steffen's monotone spline instead of straight lines */
  uint32_t outside;        /* data: strut_outside */
} strut_signal;

/** Has the signal points: is it a table, or data? */
static inline bool strut_signal_has_points(const strut_signal *signal) {
  return signal->kind == STRUT_TABLE || signal->kind == STRUT_DATA;
}

/** Is the signal computed by its program? */
static inline bool strut_signal_has_program(const strut_signal *signal) {
  return signal->kind == STRUT_EXPRESSION || signal->kind == STRUT_RELAY;
}

/** Number of its points at or before t. */
STRUT_API size_t strut_signal_points_until(const strut_signal *signal, double t);
/** t within the points of repeated data, before the last; else t. */
STRUT_API double strut_signal_data_time(const strut_signal *signal, double t);

/** A signal of the given kind with the defaults above. */
STRUT_API strut_signal strut_signal_default(strut_signal_kind kind);

/**
 * Value and time derivative (from the right where they jump; the jump itself is not a rate) of
 * signal `index` of `signals` at time t [s]; NAN where it follows a sensor.
 */
STRUT_API void strut_signal_evaluate(const strut_signal *signals, int32_t index, double t,
                                     double *value, double *rate);

/**
 * First time after t [s] at which signal `index` or its rate may jump; INFINITY where it stays smooth.
 */
STRUT_API double strut_signal_next_break(const strut_signal *signals, int32_t index, double t);
/**
 * The same of signals that started at the times `started` (signals); NULL: no signal has a trigger. Breaks after
 * `until` may be left out.
 */
STRUT_API double strut_signal_next_break_since(const strut_signal *signals, const double *started,
                                               int32_t index, double t, double until);
/** Likewise of a program of the time and of signals. */
STRUT_API double strut_program_next_break(const strut_signal *signals, const double *started,
                                          const strut_program *program, double t, double until);

/**
 * Period of a signal [s]: 1 / frequency; of a sum, the longest period of its terms if every other
 * one divides it; 0 where there is none.
 */
STRUT_API double strut_signal_period(const strut_signal *signals, int32_t index);

/**
 * Finds times from `from` to `to` at which the signal may turn, jump or be steepest, in no order;
 * the first ones of each wave. Fills at most `capacity` of them and returns their number.
 */
STRUT_API size_t strut_signal_times(const strut_signal *signals, int32_t index, double from,
                                    double to, double *time, size_t capacity);

/** Largest change of the signal within `step` [s] at such a time; *when: that time. */
STRUT_API double strut_signal_jump(const strut_signal *signals, int32_t index, double step,
                                   double from, double to, double *when);

/* ---- as motions of supports and rotors ---- */

/**
 * Second time derivative of signal `index` at time t [s], from the right where it jumps. Corners and
 * jumps of the signal are not in it.
 */
STRUT_API double strut_signal_acceleration(const strut_signal *signals, int32_t index, double t);

/** Does the value itself jump after t = 0, up to the time `last` [s]? *when: at which time. */
STRUT_API bool strut_signal_value_jumps(const strut_signal *signals, int32_t index, double last,
                                        double *when);

/** Does the rate jump after t = 0 somewhere? */
STRUT_API bool strut_signal_has_corners(const strut_signal *signals, int32_t index);

/** Is the signal a function of the time alone, whose acceleration is known: no expression, nothing that
    lags, is sampled or started? */
STRUT_API bool strut_signal_is_wave(const strut_signal *signals, int32_t index);
