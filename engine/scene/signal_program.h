/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Feedback: sensors, and programs that compute signals from the time, sensors and other signals.
 *
 * A program is in postfix order for a stack of numbers, as that of a measured quantity (quantity.h).
 * The parser compiles it, with names resolved and dimensions checked. Its columns are TIME, SENSOR,
 * SENSOR_RATE, SIGNAL and STATE; each number has a value and a rate, so that the rate of the result is
 * known exactly.
 */
#pragma once

#include <stdbool.h>

#include "engine/scene/quantity.h"
#include "engine/scene/signal.h"

/** Most numbers on the stack of a program. */
enum { STRUT_MOST_PROGRAM_DEPTH = 64 };

/** A number that signals may follow: an observable, or one that `of` names. */
typedef struct strut_sensor {
  const char *name;
  uint32_t kind;   /* strut_column_kind; TIME: as `of` says */
  int32_t item;    /* of the scene: member, hinge, node, cell, distance or collision */
  uint32_t along;  /* of a node's x and vx: 0 x, 1 y */
  uint32_t energy; /* of the kinetic energy: 1 the elastic one, 2 the total */
  size_t length;
  strut_instruction *of; /* (length) one column */
} strut_sensor;

/** What a sensor sees. */
static inline strut_column strut_sensor_column(const strut_sensor *sensor) {
  if (sensor->length) return sensor->of->column;
  uint32_t kind = sensor->kind + sensor->along + sensor->energy;
  if (sensor->energy == 2) kind = STRUT_COLUMN_TOTAL;
  return (strut_column){(strut_column_kind)kind, sensor->item, -1};
}

/** A number that the run integrates beside the motion: z(0) = start, dz/dt = rate. */
typedef struct strut_internal_state {
  const char *name;
  double start;
  const char *unit; /* of start, such as "rad"; NULL: none */
  strut_program rate;
} strut_internal_state;

/** Where abs, min and max have kinks, each by its instruction, and the sides on which they are. */
typedef struct strut_kinks {
  int32_t count;
  const strut_instruction **at; /* (count) NULL: not watched any more */
  double *
      side; /* (count) 1: abs is its operand, max the first one, min the second; -1; 0: by their values */
  double *margin, *rate; /* (count) of the latest evaluation: how far it is on that side */
  bool controlled;       /* steps have error control */
  double *largest;       /* (count) of the margins' sizes at ends of steps */
} strut_kinks;

/** What signals are computed from, beside the time. */
typedef struct strut_signal_inputs {
  const double *sensor, *sensor_rate; /* (sensors) values in SI units, and their rates */
  const double *state;                /* internal states, then those of signals with a lag */
  const strut_internal_state *states;
  const int32_t *lag_of;    /* (signals) the state that is the signal's lagged value, or -1 */
  const double *held;       /* (signals) values of sampled signals since the latest sample */
  const double *started;    /* (signals) when those with a trigger started [s]; INFINITY: not yet */
  bool values_only;         /* rates are not wanted */
  const strut_kinks *kinks; /* NULL: none is held */
  const int8_t *relay_side; /* (signals) of relays: 1 above, -1 below, see strut_relay_value */
} strut_signal_inputs;

/** Value of a relay whose input was last above its upper threshold (side 1) or below its lower (-1). */
static inline double strut_relay_value(const strut_signal *relay, int8_t side) {
  return (side > 0) == relay->relay.on_above ? relay->relay.on : relay->relay.off;
}

/** True where the rate of a sensor follows from positions and velocities alone. */
static inline bool strut_sensor_has_rate(const strut_sensor *sensor) {
  strut_column_kind kind = strut_sensor_column(sensor).kind;
  return kind == STRUT_COLUMN_TIME || /* it senses nothing, and has been refused for that */
         strut_observable_at(kind)->sense == STRUT_OBSERVED_RATED;
}

/** Value of an operation of one operand or two. */
STRUT_API double strut_operation_apply(strut_operation operation, double a, double b);
/** Operands of an operation. */
STRUT_API int strut_operation_operands(strut_operation operation);

/**
 * Value and rate of signal `index` at time t [s], as strut_signal_evaluate; `in` (NULL: there are
 * none, and what follows a sensor is NAN) are the inputs of signals that follow the motion.
 */
STRUT_API void strut_signal_follow(const strut_signal *signals, const strut_signal_inputs *in,
                                   int32_t index, double t, double *value, double *rate);

/** The same before it is sampled, and before its lag. */
STRUT_API void strut_signal_follow_unsampled(const strut_signal *signals,
                                             const strut_signal_inputs *in, int32_t index, double t,
                                             double *value, double *rate);
STRUT_API void strut_signal_follow_unlagged(const strut_signal *signals,
                                            const strut_signal_inputs *in, int32_t index, double t,
                                            double *value, double *rate);

/** Value and rate of a program whose signals are among `signals`. */
STRUT_API void strut_program_evaluate(const strut_program *program, const strut_signal *signals,
                                      const strut_signal_inputs *in, double t, double *value,
                                      double *rate);

struct strut_scene;
/** Instructions of signals at which what follows the motion has kinks, and the signals of these, in arrays with room
    for them or NULL. Returns how many. */
STRUT_API int32_t strut_scene_kinks(const struct strut_scene *scene, const strut_instruction **at,
                                    int32_t *signal);

/** What a signal depends on. */
typedef struct strut_signal_traits {
  bool follows;   /* sensors, internal states or its own history */
  int32_t sensor; /* one whose rate is not known, and with it that of the signal; or -1 */
  int32_t
      damped; /* one of the force of a member with a damper, which the signal's rate follows; or -1 */
} strut_signal_traits;
/** Of signal `index` of a valid scene. */
STRUT_API strut_signal_traits strut_signal_describe(const struct strut_scene *scene, int32_t index);
/** What turns fastest in a scene: waves, sines of expressions, oscillators, unbalances. */
typedef struct strut_turning {
  double rate;    /* [1/s]; 0: nothing turns */
  char name[120]; /* such as "signal 's'" */
} strut_turning;
/**
 * Finds it within `last` [s]. `stops`: the method stops where a signal jumps, so that squares and halves of
 * sines do not count.
 */
STRUT_API strut_turning strut_scene_fastest_turn(const struct strut_scene *scene, double last,
                                                 bool stops);
/** Has the program a column of one of two kinds? */
STRUT_API bool strut_program_reads(const strut_program *program, strut_column_kind one,
                                   strut_column_kind other);
/** Does some signal or internal state follow a sensor? Modes and step limits know nothing of that. */
STRUT_API bool strut_scene_has_feedback(const struct strut_scene *scene);

/*
 * What signals do over an interval of time, by interval arithmetic: kinks of expressions, and steps that hide nothing.
 *
 * Sensors and internal states stand still meanwhile: how they move is the motion's, and error control sees it.
 */

typedef struct strut_range {
  double low, high;
} strut_range;

/** All values and rates of a signal over some time; from rounding outwards. */
typedef struct strut_signal_bounds {
  strut_range value, rate;
  bool follows; /* depends on more than the time */
} strut_signal_bounds;

/** Of a program from time `from` to `to` [s], which may be INFINITY; `in` as that of strut_program_evaluate. */
STRUT_API strut_signal_bounds strut_program_bound(const strut_program *program,
                                                  const strut_signal *signals,
                                                  const strut_signal_inputs *in, double from,
                                                  double to);

/**
 * First time after t [s], up to `until`, at which the program may have a kink or a jump as a function of time alone:
 * where the argument of abs, min, max, floor, ceil, round or atan2 passes its edge. Those of its signals are not
 * looked for. INFINITY if it has none. If the work allowed is used up, a time before which none lies.
 */
STRUT_API double strut_program_next_kink(const strut_program *program, const strut_signal *signals,
                                         const double *started, double t, double until);

/**
 * The longest step from time t [s], at most h, over which the program's values and rates at begin, middle and end show
 * how it changes between them; changes of less than `faint` of its largest value are left out. Not below `least`.
 */
STRUT_API double strut_program_longest_step(const strut_program *program,
                                            const strut_signal *signals,
                                            const strut_signal_inputs *in, double t, double h,
                                            double faint, double least);

/** The same of signal `index`, in whose own time it is. */
STRUT_API double strut_signal_longest_step(const strut_signal *signals,
                                           const strut_signal_inputs *in, int32_t index, double t,
                                           double h, double faint, double least);

/** Must steps be short enough for the signal? Other waves are smooth between their breaks, and as long as they say. */
STRUT_API bool strut_signal_is_looked_at(const strut_signal *signal);
