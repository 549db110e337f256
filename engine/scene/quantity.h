/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Measured quantities: an expression of columns of the motion, and its reduction to a number over
 * the window.
 *
 * An expression is a short program in postfix order for a stack of numbers. The parser compiles it,
 * with all names resolved and dimensions checked; the engine evaluates it after each step of the
 * window.
 */
#ifndef STRUT_ENGINE_SCENE_QUANTITY_H
#define STRUT_ENGINE_SCENE_QUANTITY_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/** Owner of a column: how the column is written, and what its items index. */
typedef enum strut_column_owner {
  STRUT_COLUMN_OF_RUN,       /* the word alone: time */
  STRUT_COLUMN_OF_NODE,      /* NODE.y */
  STRUT_COLUMN_OF_CONTACT,   /* NODE.normal, of a node that may touch the ground */
  STRUT_COLUMN_OF_MEMBER,    /* MEMBER.force */
  STRUT_COLUMN_OF_HINGE,     /* HINGE.moment */
  STRUT_COLUMN_OF_PAIR,      /* angle(NODE, NODE) */
  STRUT_COLUMN_OF_CENTRE,    /* com.vx */
  STRUT_COLUMN_OF_ENERGY,    /* energy.kinetic */
  STRUT_COLUMN_OF_WORK,      /* work.drives */
  STRUT_COLUMN_OF_LOSSES,    /* losses.friction */
  STRUT_COLUMN_OF_CELL,      /* CELL.area */
  STRUT_COLUMN_OF_COLLISION, /* COLLISION.gap */
  STRUT_COLUMN_OF_DISTANCE,  /* DISTANCE.force */
  STRUT_COLUMN_OF_SLIDER,    /* SLIDER.share */
  STRUT_COLUMN_OF_FEEDBACK   /* the name of a sensor, a signal or a state alone; rate(SENSOR) */
} strut_column_owner;

/** X(id, owner, word, powers of kg, m, s, angle) */
#define STRUT_COLUMN_TABLE(X)                                                                      \
  X(TIME, RUN, "time", 0, 0, 1, 0)                                                                 \
  X(NODE_X, NODE, "x", 0, 1, 0, 0)                                                                 \
  X(NODE_Y, NODE, "y", 0, 1, 0, 0)                                                                 \
  X(NODE_VX, NODE, "vx", 0, 1, -1, 0)                                                              \
  X(NODE_VY, NODE, "vy", 0, 1, -1, 0)                                                              \
  X(HEIGHT, NODE, "height", 0, 1, 0, 0) /* above the ground, along its normal */                   \
  X(NORMAL, CONTACT, "normal", 1, 1, -2, 0)                                                        \
  X(FRICTION, CONTACT, "friction", 1, 1, -2, 0)                                                    \
  X(LENGTH, MEMBER, "length", 0, 1, 0, 0)                                                          \
  X(STRETCH, MEMBER, "stretch", 0, 1, 0, 0) /* length - rest length as driven */                   \
  X(RATE, MEMBER, "rate", 0, 1, -1, 0)      /* of the length */                                    \
  X(FORCE, MEMBER, "force", 1, 1, -2, 0)                                                           \
  X(TILT, MEMBER, "angle", 0, 0, 0, 1) /* of its direction, from +x, counted on beyond a turn */   \
  X(PLASTIC, MEMBER, "plastic", 0, 1, 0, 0) /* permanent set: elongation less force/stiffness */   \
  X(LAST_FORCE, MEMBER, "last_force", 1, 1, -2, 0) /* at its last node */                          \
  X(HINGE_ANGLE, HINGE, "angle", 0, 0, 0, 1)                                                       \
  X(HINGE_RATE, HINGE, "rate", 0, 0, -1, 1) /* of the angle */                                     \
  X(MOMENT, HINGE, "moment", 1, 2, -2, 0)                                                          \
  X(HINGE_PLASTIC, HINGE, "plastic", 0, 0, 0, 1) /* permanent set, as an angle */                  \
  X(ANGLE, PAIR, "angle", 0, 0, 0, 1)                                                              \
  X(DISTANCE, PAIR, "distance", 0, 1, 0, 0)                                                        \
  X(CENTRE_X, CENTRE, "x", 0, 1, 0, 0)                                                             \
  X(CENTRE_Y, CENTRE, "y", 0, 1, 0, 0)                                                             \
  X(CENTRE_VX, CENTRE, "vx", 0, 1, -1, 0)                                                          \
  X(CENTRE_VY, CENTRE, "vy", 0, 1, -1, 0)                                                          \
  X(KINETIC, ENERGY, "kinetic", 1, 2, -2, 0)                                                       \
  X(ELASTIC, ENERGY, "elastic", 1, 2, -2, 0)                                                       \
  X(GRAVITY, ENERGY, "gravity", 1, 2, -2, 0)                                                       \
  X(GROUND, ENERGY, "contact", 1, 2, -2, 0) /* of the ground's springs */                          \
  X(TOTAL, ENERGY, "total", 1, 2, -2, 0)                                                           \
  X(DRIVES, WORK, "drives", 1, 2, -2, 0)                                                           \
  X(LOADS, WORK, "loads", 1, 2, -2, 0)                                                             \
  X(BELT, WORK, "belt", 1, 2, -2, 0)                                                               \
  X(SUPPORTS, WORK, "supports", 1, 2, -2, 0)                                                       \
  X(LOST_MEMBERS, LOSSES, "members", 1, 2, -2, 0)                                                  \
  X(LOST_CONTACT, LOSSES, "contact", 1, 2, -2, 0)                                                  \
  X(LOST_FRICTION, LOSSES, "friction", 1, 2, -2, 0)                                                \
  X(LOST, LOSSES, "total", 1, 2, -2, 0)                                                            \
  X(CELL_AREA, CELL, "area", 0, 2, 0, 0)                                                           \
  X(PRESSURE, CELL, "pressure", 1, 0, -2, 0)                                                       \
  X(COLLISION_GAP, COLLISION, "gap", 0, 1, 0, 0)                                                   \
  X(COLLISION_FORCE, COLLISION, "force", 1, 1, -2, 0)                                              \
  X(DISTANCE_VALUE, DISTANCE, "distance", 0, 1, 0, 0)                                              \
  X(DISTANCE_RATE, DISTANCE, "rate", 0, 1, -1, 0)                                                  \
  X(DISTANCE_FORCE, DISTANCE, "force", 1, 1, -2, 0)                                                \
  X(SENSOR, FEEDBACK, "sensor", 0, 0, 0, 0) /* in SI units, of whatever dimension */               \
  X(SIGNAL, FEEDBACK, "signal", 0, 0, 0, 0)                                                        \
  X(SENSOR_RATE, FEEDBACK, "rate", 0, 0, 0, 0)                                                     \
  X(STATE, FEEDBACK, "state", 0, 0, 0, 0)                                                          \
  X(SLIDER_X, SLIDER, "x", 0, 1, 0, 0)                                                             \
  X(SLIDER_Y, SLIDER, "y", 0, 1, 0, 0)                                                             \
  X(SLIDER_VX, SLIDER, "vx", 0, 1, -1, 0)                                                          \
  X(SLIDER_VY, SLIDER, "vy", 0, 1, -1, 0)                                                          \
  X(SLIDER_SHARE, SLIDER, "share", 0, 0, 0, 0)        /* of its member, from the first node */     \
  X(LARGEST_FORCE, RUN, "largest_force", 1, 1, -2, 0) /* of all members' absolute ones */          \
  X(LEAST_GAP, RUN, "least_gap", 0, 1, 0, 0)          /* of all collisions */

typedef enum strut_column_kind {
#define STRUT_COLUMN_ENUM(id, ...) STRUT_COLUMN_##id,
  STRUT_COLUMN_TABLE(STRUT_COLUMN_ENUM)
#undef STRUT_COLUMN_ENUM
      STRUT_COLUMN_COUNT
} strut_column_kind;

/** A column of the motion: a number at every step. */
typedef struct strut_column {
  strut_column_kind kind;
  int32_t item, other; /* node, contact, member, hinge, ...; the second node of a pair; else -1 */
} strut_column;

/** How a result changes with its operands; see engine/run/measure/quantities.c. */
typedef enum strut_sensitivity {
  STRUT_SENSITIVITY_SUM, /* as much as they do */
  STRUT_SENSITIVITY_PRODUCT,
  STRUT_SENSITIVITY_QUOTIENT,
  STRUT_SENSITIVITY_POWER,
  STRUT_SENSITIVITY_ROOT,
  STRUT_SENSITIVITY_EXPONENTIAL,
  STRUT_SENSITIVITY_LOGARITHM, /* relative to the first */
  STRUT_SENSITIVITY_BOUNDED    /* likewise, while it is at most 1 */
} strut_sensitivity;

/** X(id, operands, word, sensitivity); the functions are those of the language. */
#define STRUT_OPERATION_TABLE(X)                                                                   \
  X(NUMBER, 0, "", SUM)                                                                            \
  X(COLUMN, 0, "", SUM)                                                                            \
  X(ADD, 2, "+", SUM)                                                                              \
  X(SUBTRACT, 2, "-", SUM)                                                                         \
  X(MULTIPLY, 2, "*", PRODUCT)                                                                     \
  X(DIVIDE, 2, "/", QUOTIENT)                                                                      \
  X(POWER, 2, "^", POWER)                                                                          \
  X(NEGATE, 1, "-", SUM)                                                                           \
  X(SIN, 1, "sin", BOUNDED)                                                                        \
  X(COS, 1, "cos", BOUNDED)                                                                        \
  X(TAN, 1, "tan", SUM)                                                                            \
  X(ASIN, 1, "asin", BOUNDED)                                                                      \
  X(ACOS, 1, "acos", BOUNDED)                                                                      \
  X(ATAN, 1, "atan", BOUNDED)                                                                      \
  X(ATAN2, 2, "atan2", LOGARITHM)                                                                  \
  X(SQRT, 1, "sqrt", ROOT)                                                                         \
  X(EXP, 1, "exp", EXPONENTIAL)                                                                    \
  X(LOG, 1, "log", LOGARITHM)                                                                      \
  X(LOG10, 1, "log10", LOGARITHM)                                                                  \
  X(TANH, 1, "tanh", BOUNDED)                                                                      \
  X(ABS, 1, "abs", SUM)                                                                            \
  X(MIN, 2, "min", SUM)                                                                            \
  X(MAX, 2, "max", SUM)                                                                            \
  X(FLOOR, 1, "floor", SUM)                                                                        \
  X(CEIL, 1, "ceil", SUM)                                                                          \
  X(ROUND, 1, "round", SUM)                                                                        \
  X(HYPOT, 2, "hypot", SUM)

typedef enum strut_operation {
#define STRUT_OPERATION_ENUM(id, ...) STRUT_OPERATION_##id,
  STRUT_OPERATION_TABLE(STRUT_OPERATION_ENUM)
#undef STRUT_OPERATION_ENUM
      STRUT_OPERATION_COUNT
} strut_operation;

/** One operation: pushes a number or a column, or replaces its operands by their result. */
typedef struct strut_instruction {
  strut_operation operation;
  strut_column column; /* of COLUMN */
  double number;       /* of NUMBER, SI */
  const char *unit;    /* of NUMBER: unit as written, such as "kg m s^-2"; or NULL */
} strut_instruction;

/** Reduction of the values of a quantity over the window. */
typedef enum strut_reduction {
  STRUT_TAKE_MEAN,
  STRUT_TAKE_MIN,
  STRUT_TAKE_MAX,
  STRUT_TAKE_RANGE, /* max - min */
  STRUT_TAKE_RMS,
  STRUT_TAKE_FINAL,  /* at the window's end */
  STRUT_TAKE_CHANGE, /* end - begin */
  STRUT_TAKE_RATE,   /* change per second */
  STRUT_TAKE_RISE,   /* sum of all increases: of the work of drives that which is positive */
  STRUT_TAKE_ARRIVAL /* time at which `target` is first reached or passed [s]; missing: never */
} strut_reduction;

typedef struct strut_quantity_definition {
  const char *name, *unit;    /* unit of the value; "1": none */
  size_t length, depth;       /* instructions; the most numbers on the stack */
  strut_instruction *program; /* (length) */
  strut_reduction take;
  double accuracy;           /* wanted; 0: that of the run */
  const char *accuracy_unit; /* `unit`; NULL: it is relative */
  double target;             /* of ARRIVAL, in the expression's SI unit */
  const char *target_unit;   /* of ARRIVAL: that unit; "1": none */
} strut_quantity_definition;

/**
 * Error allowed for a value of a quantity, in its unit, where `accuracy` is that of the run. Relative ones refer to
 * the value, or to a thousandth of its largest term, `scale`, if that is larger.
 */
static inline double strut_quantity_allowed_error(const strut_quantity_definition *definition,
                                                  double accuracy, double value, double scale) {
  if (definition->accuracy_unit) return definition->accuracy;
  double part = definition->accuracy > 0.0 ? definition->accuracy : accuracy;
  return part * fmax(fabs(value), 1e-3 * scale);
}

#endif
