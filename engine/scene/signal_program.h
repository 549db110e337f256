/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Feedback: sensors, and programs that compute signals from the time, sensors and other signals.
 *
 * A program is in postfix order for a stack of numbers, as that of a measured quantity (quantity.h).
 * The parser compiles it, with names resolved and dimensions checked. Its columns are TIME, SENSOR,
 * SENSOR_RATE, SIGNAL and STATE; each number has a value and a rate, so that the rate of the result is
 * known exactly.
 */
#ifndef STRUT_ENGINE_SCENE_SIGNAL_PROGRAM_H
#define STRUT_ENGINE_SCENE_SIGNAL_PROGRAM_H

#include <stdbool.h>

#include "engine/scene/quantity.h"
#include "engine/scene/signal.h"

/** Most numbers on the stack of a program. */
enum { STRUT_MOST_PROGRAM_DEPTH = 64 };

typedef enum strut_sensor_kind {
  STRUT_SENSOR_LENGTH,          /* of a member [m] */
  STRUT_SENSOR_FORCE,           /* of a member, tension positive [N] */
  STRUT_SENSOR_ANGLE,           /* of a hinge [rad] */
  STRUT_SENSOR_CONTACT,         /* 1 while a node touches the ground, else 0 */
  STRUT_SENSOR_POSITION,        /* of a node, along x or y [m] */
  STRUT_SENSOR_VELOCITY,        /* likewise [m/s] */
  STRUT_SENSOR_ENERGY,          /* of the structure [J] */
  STRUT_SENSOR_AREA,            /* of a cell [m^2] */
  STRUT_SENSOR_PRESSURE,        /* in a cell [N/m] */
  STRUT_SENSOR_DISTANCE,        /* of a distance [m] */
  STRUT_SENSOR_CONTACT_FORCE,   /* of all grounds on a node, normal to them [N] */
  STRUT_SENSOR_COLLISION_FORCE, /* of a collision, pushing positive [N] */
  STRUT_SENSOR_KINDS
} strut_sensor_kind;

typedef enum strut_sensed_energy {
  STRUT_SENSED_KINETIC,
  STRUT_SENSED_ELASTIC,
  STRUT_SENSED_TOTAL
} strut_sensed_energy;

/** A number that signals may follow. */
typedef struct strut_sensor {
  const char *name;
  strut_sensor_kind kind;
  int32_t item;    /* of the scene: member, hinge, node, cell, distance or collision */
  uint32_t along;  /* of POSITION and VELOCITY: 0 x, 1 y */
  uint32_t energy; /* of ENERGY: strut_sensed_energy */
} strut_sensor;

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
static inline bool strut_sensor_has_rate(strut_sensor_kind kind) {
  return kind == STRUT_SENSOR_LENGTH || kind == STRUT_SENSOR_ANGLE ||
         kind == STRUT_SENSOR_POSITION || kind == STRUT_SENSOR_AREA ||
         kind == STRUT_SENSOR_DISTANCE;
}

/** True where a sensor needs the driven rest lengths, or where shaken grounds are. */
static inline bool strut_sensor_needs_drives(strut_sensor_kind kind) {
  return kind == STRUT_SENSOR_FORCE || kind == STRUT_SENSOR_ENERGY ||
         kind == STRUT_SENSOR_CONTACT || kind == STRUT_SENSOR_PRESSURE ||
         kind == STRUT_SENSOR_CONTACT_FORCE;
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

#endif
