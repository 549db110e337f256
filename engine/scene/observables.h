/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Observables: numbers of the motion at a moment.
 *
 * A row of STRUT_OBSERVABLES and the function OBSERVE(ID) of engine/forces/observe.c are all that there is of one.
 * What a run records, what quantities measure, what sensors see, what studies keep, CSV, HDF5, pages, the library
 * and Python loop over the table.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"

/** What a number measures: exponents of kg, m, s and angle. */
typedef struct strut_dimension {
  float kg, m, s, angle;
} strut_dimension;

/**
 * X(OWNER, THING, TABLE, group, phrase, things, axis, file): what observables belong to. THING is the kind whose
 * names stand before the dot, COUNT where there is none; then `group` does, which messages call `phrase`. As channels
 * they are columns of the file of TABLE, whose own row says what its items are in the plural, and their axis in HDF5.
 */
#define STRUT_TABLES(X)                                                                            \
  X(NODE, NODE, NODE, NULL, NULL, "nodes", "node", "nodes.csv")                                    \
  X(MEMBER, MEMBER, MEMBER, NULL, NULL, "members", "member", "members.csv")                        \
  X(HINGE, HINGE, HINGE, NULL, NULL, "hinges", "hinge", "hinges.csv")                              \
  X(CELL, CELL, CELL, NULL, NULL, "cells", "cell", "cells.csv")                                    \
  X(DISTANCE, DISTANCE, DISTANCE, NULL, NULL, "distances", "distance_name", "distances.csv")       \
  X(CONTACT, NODE, CONTACT, NULL, NULL, "contacts", "contact_node", "contacts.csv")                \
  X(COLLISION, COLLISION, COLLISION, NULL, NULL, "collisions", "collision", "collisions.csv")      \
  X(SLIDER, SLIDER, SLIDER, NULL, NULL, "sliders", "slider", "sliders.csv")                        \
  X(SENSOR, SENSOR, SENSOR, NULL, NULL, "sensors", "sensor_name", "sensors.csv")                   \
  X(SIGNAL, SIGNAL, SIGNAL, NULL, NULL, "signals", "signal_name", "signals.csv")                   \
  X(STATE, STATE, STATE, NULL, NULL, "states", "state_name", "states.csv")                         \
  X(SYSTEM, COUNT, SYSTEM, NULL, NULL, "energies", "system", "energy.csv")                         \
  X(RUN, COUNT, RUN, NULL, NULL, "run", "run", "run.csv")

/** All owners: those, and what stands in one of their tables. */
#define STRUT_OWNERS(X)                                                                            \
  STRUT_TABLES(X)                                                                                  \
  X(PAIR, COUNT, RUN, NULL, NULL, "", "", "") /* angle(NODE, NODE) */                              \
  X(CENTRE, COUNT, RUN, "com", "the centre of mass", "", "", "")                                   \
  X(ENERGY, COUNT, SYSTEM, "energy", "the energy", "", "", "")                                     \
  X(WORK, COUNT, SYSTEM, "work", "the work", "", "", "")                                           \
  X(LOSSES, COUNT, SYSTEM, "losses", "the losses", "", "", "")

typedef enum strut_channel_owner {
#define STRUT_OWNER_ENUM(OWNER, ...) STRUT_OWNER_##OWNER,
  STRUT_OWNERS(STRUT_OWNER_ENUM) STRUT_OWNER_COUNT
} strut_channel_owner;

/* Their dimensions: X(unit, powers of kg, m, s, angle). */
#define STRUT_DIMENSION_NUMBER(X) X("1", 0, 0, 0, 0)
#define STRUT_DIMENSION_TIME(X) X("s", 0, 0, 1, 0)
#define STRUT_DIMENSION_LENGTH(X) X("m", 0, 1, 0, 0)
#define STRUT_DIMENSION_SPEED(X) X("m/s", 0, 1, -1, 0)
#define STRUT_DIMENSION_AREA(X) X("m^2", 0, 2, 0, 0)
#define STRUT_DIMENSION_AREA_RATE(X) X("m^2/s", 0, 2, -1, 0)
#define STRUT_DIMENSION_ANGLE(X) X("rad", 0, 0, 0, 1)
#define STRUT_DIMENSION_ANGLE_RATE(X) X("rad/s", 0, 0, -1, 1)
#define STRUT_DIMENSION_FORCE(X) X("N", 1, 1, -2, 0)
#define STRUT_DIMENSION_PRESSURE(X) X("N/m", 1, 0, -2, 0)
#define STRUT_DIMENSION_MOMENT(X) X("N m", 1, 2, -2, 0)
#define STRUT_DIMENSION_ENERGY(X) X("J", 1, 2, -2, 0)
#define STRUT_DIMENSION_ANGULAR_MOMENTUM(X) X("kg m^2/s", 1, 2, -1, 0)
#define STRUT_DIMENSION_ANY(X) X("SI", 0, 0, 0, 0) /* that of what is sensed */

/** What must be known of the state before: X(NEED). */
#define STRUT_OBSERVED_NEEDS(X)                                                                    \
  X(MOTION)   /* positions and velocities */                                                       \
  X(DRIVES)   /* driven rest lengths, and where shaken grounds are */                              \
  X(TENSION)  /* likewise, and with rigid bars or forces of actuators all forces */                \
  X(FORCES)   /* all forces */                                                                     \
  X(ENERGIES) /* that are stored */                                                                \
  X(BALANCE)  /* works and losses, which only the energy balance has */                            \
  X(MOMENTUM) /* the parts of all nodes */

/** How it is recorded: as a channel of its NAME; as a part of one (STRUT_CHANNEL_TABLE); not. X(HOW) */
#define STRUT_OBSERVED_RECORDS(X) X(RECORDED) X(PART) X(UNRECORDED)

/** Does a sensor see it, and its rate, too? If not, why: X(HOW, reason). */
#define STRUT_OBSERVED_SENSES(X)                                                                   \
  X(SENSED, NULL)                                                                                  \
  X(RATED, NULL)                                                                                   \
  X(REMEMBERED, "it follows from what has happened before, not from where the structure is")       \
  X(SUMMED, "it is a sum over the motion, which forces cannot follow")                             \
  X(WHOLE, "it is known only when all forces are")                                                 \
  X(TURNED, "it jumps where it passes half a turn; sense the angle of a hinge")                    \
  X(READ, "signals read it by its name")                                                           \
  X(DRIVEN, "a signal drives it")

/**
 * X(ID, OWNER, NAME, word, DIMENSION, NEED, RECORD, SENSE, text): `word` stands behind the dot of its owner, NAME
 * alone, as a channel. Those of an owner that are recorded together follow each other.
 */
#define STRUT_OBSERVABLES(X)                                                                       \
  X(TIME, RUN, "time", "time", TIME, MOTION, UNRECORDED, READ, "the time")                         \
  X(NODE_X, NODE, "x", "x", LENGTH, MOTION, PART, RATED, "of nodes")                               \
  X(NODE_Y, NODE, "y", "y", LENGTH, MOTION, PART, RATED, "of nodes")                               \
  X(NODE_VX, NODE, "vx", "vx", SPEED, MOTION, PART, SENSED, "of nodes")                            \
  X(NODE_VY, NODE, "vy", "vy", SPEED, MOTION, PART, SENSED, "of nodes")                            \
  X(HEIGHT, NODE, "height", "height", LENGTH, DRIVES, RECORDED, SENSED,                            \
    "of nodes above the ground, along its normal")                                                 \
  X(NODE_SPIN, NODE, "angular_momentum", "angular_momentum", ANGULAR_MOMENTUM, MOMENTUM, PART,     \
    WHOLE, "of nodes about the centre of mass")                                                    \
  X(NORMAL, CONTACT, "normal", "normal", FORCE, FORCES, PART, SENSED, "forces of contacts")        \
  X(FRICTION, CONTACT, "friction", "friction", FORCE, FORCES, PART, WHOLE, "forces of contacts")   \
  X(TOUCHES, CONTACT, "touches", "touches", NUMBER, DRIVES, RECORDED, SENSED,                      \
    "1 of contacts that are closed, else 0")                                                       \
  X(LENGTH, MEMBER, "length", "length", LENGTH, MOTION, PART, RATED, "of members")                 \
  X(STRETCH, MEMBER, "stretch", "stretch", LENGTH, DRIVES, RECORDED, SENSED,                       \
    "of members beyond the driven rest length")                                                    \
  X(RATE, MEMBER, "rate", "rate", SPEED, MOTION, RECORDED, SENSED, "of members' lengths")          \
  X(FORCE, MEMBER, "force", "force", FORCE, TENSION, PART, SENSED, "of members")                   \
  X(TILT, MEMBER, "member_angle", "angle", ANGLE, MOTION, RECORDED, TURNED,                        \
    "of members' directions, from +x")                                                             \
  X(PLASTIC, MEMBER, "plastic", "plastic", LENGTH, DRIVES, RECORDED, REMEMBERED,                   \
    "permanent set of members: elongation less force/stiffness")                                   \
  X(LAST_FORCE, MEMBER, "last_force", "last_force", FORCE, TENSION, RECORDED, REMEMBERED,          \
    "of members at their last nodes")                                                              \
  X(HINGE_ANGLE, HINGE, "angle", "angle", ANGLE, MOTION, PART, RATED, "of hinges")                 \
  X(HINGE_RATE, HINGE, "hinge_rate", "rate", ANGLE_RATE, MOTION, RECORDED, SENSED,                 \
    "of hinges' angles")                                                                           \
  X(MOMENT, HINGE, "moment", "moment", MOMENT, TENSION, PART, SENSED, "of hinges")                 \
  X(HINGE_PLASTIC, HINGE, "hinge_plastic", "plastic", ANGLE, DRIVES, RECORDED, REMEMBERED,         \
    "permanent set of hinges")                                                                     \
  X(ANGLE, PAIR, "angle", "angle", ANGLE, MOTION, UNRECORDED, TURNED, "of a line through nodes")   \
  X(DISTANCE, PAIR, "distance", "distance", LENGTH, MOTION, UNRECORDED, SENSED, "between nodes")   \
  X(CENTRE_X, CENTRE, "com.x", "x", LENGTH, DRIVES, RECORDED, RATED, "of the centre of mass")      \
  X(CENTRE_Y, CENTRE, "com.y", "y", LENGTH, DRIVES, RECORDED, RATED, "likewise")                   \
  X(CENTRE_VX, CENTRE, "com.vx", "vx", SPEED, DRIVES, RECORDED, SENSED, "likewise")                \
  X(CENTRE_VY, CENTRE, "com.vy", "vy", SPEED, DRIVES, RECORDED, SENSED, "likewise")                \
  X(KINETIC, ENERGY, "energy.kinetic", "kinetic", ENERGY, ENERGIES, PART, SENSED, "")              \
  X(ELASTIC, ENERGY, "energy.elastic", "elastic", ENERGY, ENERGIES, PART, SENSED, "")              \
  X(GRAVITY, ENERGY, "energy.gravity", "gravity", ENERGY, ENERGIES, PART, SENSED, "")              \
  X(GROUND, ENERGY, "energy.contact", "contact", ENERGY, ENERGIES, PART, SENSED, "")               \
  X(DRIVES, WORK, "work.drives", "drives", ENERGY, BALANCE, PART, SUMMED, "")                      \
  X(LOADS, WORK, "work.loads", "loads", ENERGY, BALANCE, PART, SUMMED, "")                         \
  X(BELT, WORK, "work.belt", "belt", ENERGY, BALANCE, PART, SUMMED, "")                            \
  X(SUPPORTS, WORK, "work.supports", "supports", ENERGY, BALANCE, PART, SUMMED, "")                \
  X(LOST_MEMBERS, LOSSES, "losses.members", "members", ENERGY, BALANCE, PART, SUMMED, "")          \
  X(LOST_CONTACT, LOSSES, "losses.contact", "contact", ENERGY, BALANCE, PART, SUMMED, "")          \
  X(LOST_FRICTION, LOSSES, "losses.friction", "friction", ENERGY, BALANCE, PART, SUMMED, "")       \
  X(TOTAL, ENERGY, "energy.total", "total", ENERGY, ENERGIES, RECORDED, SENSED,                    \
    "of all that is stored")                                                                       \
  X(LOST, LOSSES, "losses.total", "total", ENERGY, BALANCE, RECORDED, SUMMED, "of all")            \
  X(CELL_AREA, CELL, "area", "area", AREA, MOTION, PART, RATED, "of cells")                        \
  X(CELL_RATE, CELL, "cell_rate", "rate", AREA_RATE, MOTION, RECORDED, SENSED, "of cells' areas")  \
  X(PRESSURE, CELL, "pressure", "pressure", PRESSURE, DRIVES, PART, SENSED, "of cells")            \
  X(COLLISION_GAP, COLLISION, "gap", "gap", LENGTH, MOTION, RECORDED, SENSED, "of collisions")     \
  X(COLLISION_FORCE, COLLISION, "collision_force", "force", FORCE, MOTION, RECORDED, SENSED,       \
    "of collisions, pushing positive")                                                             \
  X(DISTANCE_VALUE, DISTANCE, "distance", "distance", LENGTH, MOTION, RECORDED, RATED,             \
    "of distances")                                                                                \
  X(DISTANCE_RATE, DISTANCE, "distance_rate", "rate", SPEED, MOTION, RECORDED, SENSED,             \
    "of distances")                                                                                \
  X(DISTANCE_FORCE, DISTANCE, "distance_force", "force", FORCE, MOTION, RECORDED, SENSED,          \
    "of distances, tension positive")                                                              \
  X(SENSOR, SENSOR, "sensor", "sensor", ANY, DRIVES, RECORDED, READ, "values of sensors")          \
  X(SIGNAL, SIGNAL, "signal", "signal", ANY, DRIVES, RECORDED, READ, "values of signals")          \
  X(SENSOR_RATE, SENSOR, "sensor_rate", "rate", ANY, DRIVES, RECORDED, READ, "0 if not known")     \
  X(STATE, STATE, "state", "state", ANY, MOTION, RECORDED, READ, "values of states")               \
  X(SLIDER_X, SLIDER, "slider_x", "x", LENGTH, DRIVES, RECORDED, DRIVEN, "of sliders")             \
  X(SLIDER_Y, SLIDER, "slider_y", "y", LENGTH, DRIVES, RECORDED, DRIVEN, "likewise")               \
  X(SLIDER_VX, SLIDER, "slider_vx", "vx", SPEED, DRIVES, RECORDED, DRIVEN, "likewise")             \
  X(SLIDER_VY, SLIDER, "slider_vy", "vy", SPEED, DRIVES, RECORDED, DRIVEN, "likewise")             \
  X(SLIDER_SHARE, SLIDER, "share", "share", NUMBER, DRIVES, RECORDED, DRIVEN,                      \
    "of sliders' ways along their members, from the first node")                                   \
  X(LARGEST_FORCE, RUN, "largest_force", "largest_force", FORCE, TENSION, RECORDED, WHOLE,         \
    "of all members' absolute ones")                                                               \
  X(LEAST_GAP, RUN, "least_gap", "least_gap", LENGTH, MOTION, RECORDED, WHOLE,                     \
    "of all collisions")                                                                           \
  X(SPIN, RUN, "spin", "angular_momentum", ANGULAR_MOMENTUM, MOMENTUM, UNRECORDED, WHOLE,          \
    "of the structure about the centre of mass")

typedef enum strut_column_kind {
#define STRUT_COLUMN_ENUM(ID, ...) STRUT_COLUMN_##ID,
  STRUT_OBSERVABLES(STRUT_COLUMN_ENUM) STRUT_COLUMN_COUNT
} strut_column_kind;

/** An observable of a thing: a number at every step, a column over time. */
typedef struct strut_column {
  strut_column_kind kind;
  int32_t item, other; /* node, member, hinge, ...; the second node of a pair; else -1 */
} strut_column;

#define STRUT_OBSERVED_ENUM(WORD) STRUT_OBSERVED_##WORD,
typedef enum strut_observed_need {
  STRUT_OBSERVED_NEEDS(STRUT_OBSERVED_ENUM) STRUT_OBSERVED_NEED_COUNT
} strut_observed_need;
typedef enum strut_observed_record {
  STRUT_OBSERVED_RECORDS(STRUT_OBSERVED_ENUM) STRUT_OBSERVED_RECORD_COUNT
} strut_observed_record;
#undef STRUT_OBSERVED_ENUM
#define STRUT_OBSERVED_ENUM(HOW, reason) STRUT_OBSERVED_##HOW,
typedef enum strut_observed_sense {
  STRUT_OBSERVED_SENSES(STRUT_OBSERVED_ENUM) STRUT_OBSERVED_SENSE_COUNT
} strut_observed_sense;
#undef STRUT_OBSERVED_ENUM

/** A row of the table. */
typedef struct strut_observable {
  const char *name, *word, *unit, *text;
  strut_channel_owner owner;
  int kg, m, s, angle; /* powers of its unit */
  strut_observed_need need;
  strut_observed_record record;
  strut_observed_sense sense;
} strut_observable;

STRUT_API const strut_observable *strut_observable_at(strut_column_kind kind);
/** Why no sensor sees it; NULL: one may. */
STRUT_API const char *strut_observable_unsensed(strut_column_kind kind);

/** A row of STRUT_OWNERS. */
typedef struct strut_owner_row {
  strut_channel_owner table;
  const char *group, *phrase;
  const char *things, *axis, *axis_with_total, *file;
} strut_owner_row;

STRUT_API const strut_owner_row *strut_owner_row_of(strut_channel_owner owner);
