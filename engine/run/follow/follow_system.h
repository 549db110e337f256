/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The equations of a periodic motion over one or two parameters: G(z, p) = P(z; p) - z, with P the period map.
 *
 * Unknowns are the free coordinates over `length`, their velocities over `speed`, and each parameter over its
 * range: all of order one. Each value of the parameters has a scene and a model of its own. Where the structure
 * travels, shifts along the ground are neutral; the derivative of P is kept without that direction, whose
 * multiplier is then 0 instead of 1.
 *
 * Functions return false where the motion is lost or `status` stops everything.
 */
#ifndef STRUT_ENGINE_RUN_FOLLOW_FOLLOW_SYSTEM_H
#define STRUT_ENGINE_RUN_FOLLOW_FOLLOW_SYSTEM_H

#include "engine/base/flag.h"
#include "engine/integrate/events/location/event_log.h"
#include "engine/integrate/events/location/variation.h"
#include "engine/run/orbit/orbit.h"

enum { STRUT_FOLLOW_MOST = 96 }; /* most free coordinates and velocities */

/** Makes the scene of values of the parameters [SI]; strut_setup_free releases it. */
typedef struct strut_follow_scenes {
  strut_status (*setup)(void *context, const double values[2], strut_setup *setup,
                        strut_error *error);
  void *context;
} strut_follow_scenes;

/** A motion by its state at the start of a period, over values of the parameters. */
typedef struct strut_follow_motion {
  double value[2]; /* [SI]; the second stays where there is one parameter */
  double *y;       /* (both) */
} strut_follow_motion;

/** To which residual Newton's method goes. */
typedef enum strut_follow_precision {
  STRUT_FOLLOW_CLOSE, /* the usual one, where one more step follows */
  STRUT_FOLLOW_ROUGH, /* while events are located */
  STRUT_FOLLOW_EXACT
} strut_follow_precision;

typedef struct strut_follow_system {
  strut_follow_scenes scenes;
  size_t parameters;      /* that are unknowns: 1 or 2 */
  double low[2], high[2]; /* their ranges [SI] */
  /** How periods are computed. */
  struct {
    const char *method;       /* of integration */
    double tolerance;         /* of a method with error control [1] */
    int64_t steps_per_period; /* of a method with fixed steps; of others the fewest */
    int32_t repeats;          /* drive periods of P */
    int threads;
    const strut_flag *interrupt;
  } how;
  strut_follow_precision precision;
  /* made by open and by the first value */
  strut_status status; /* what stops everything */
  strut_error *error;
  double value[2]; /* of the model below [SI]; NAN: there is none */
  strut_setup setup;
  strut_model *model;
  strut_period_map *map;      /* (threads) */
  double period;              /* of the drive there [s] */
  strut_event_log *log;       /* of map[0] */
  strut_variation *variation; /* of map[0]; NULL: derivatives are differences of runs */
  size_t n, m, both;          /* free coordinates and velocities; with parameters; 2 length + 1 */
  size_t *place;              /* (n) of an unknown in a state */
  double *along;              /* (n) unit vector of shifts along the ground, or zeros */
  bool travels;
  double length, speed; /* units of the unknowns [m], [m/s] */
  /** At some point on the way. */
  struct {
    bool known;
    double *jacobian;  /* (n, n) of P, without shifts */
    double *column[2]; /* (n) of G to each parameter over its range */
  } derivative;
  struct {
    double *there;  /* (threads, both) */
    double *end;    /* (both) */
    double *seen;   /* (4, 2 nodes) lowest and highest positions, latest positions and velocities */
    double *matrix; /* (m, m) */
    double *trials; /* (2, both + n) of Newton's method */
    double *f, *x;  /* (n), (m) */
  } buffers;
  double *upward; /* (m) unit vector of the last parameter */
  strut_arena arena;
} strut_follow_system;

/** Result of one application of P. */
typedef struct strut_follow_period {
  double travel;    /* [m]; NAN where the motion was lost or interrupted */
  double work;      /* done on the structure [J]; only with `works` */
  double amplitude; /* half the largest range of a coordinate [m]; only with `works` */
} strut_follow_period;

/**
 * Prepares the equations at the values [SI]; what stands before `precision` in the struct must be filled.
 * STRUT_USAGE with a sentence where the scene has no such motions: no periodic drive, a memory, too many
 * coordinates, a method without events over contacts.
 */
strut_status strut_follow_open(strut_follow_system *system, const double value[2],
                               strut_error *error);
void strut_follow_close(strut_follow_system *system);
/** Makes the model of the values, if they are others. */
bool strut_follow_set_value(strut_follow_system *system, const double value[2]);
/** Changes the numbers of drive periods of P and of steps of a period. */
bool strut_follow_set_periods(strut_follow_system *system, int32_t repeats, int64_t steps);
/** Is the interrupt flag set? Then the status says so. */
bool strut_follow_interrupted(strut_follow_system *system);
/** An array in the arena; NULL: out of memory, which the status says. */
void *strut_follow_allocate(strut_follow_system *system, strut_arena *arena, size_t count,
                            size_t size);
/** Chooses the units by the motion from the state y (both) over one application. */
bool strut_follow_set_units(strut_follow_system *system, const double *unknowns);
/** Moves y (both) by one application at the present value; with `works` and events in s->log. */
strut_follow_period strut_follow_apply(strut_follow_system *system, double *unknowns, bool works);
/** f (n): scaled residual at y; returns its largest entry, HUGE_VAL where the motion was lost. */
double strut_follow_residual(strut_follow_system *system, const double *unknowns, double *f);
/** As strut_follow_apply, and fills jacobian at the start; only where there is `variation`. */
strut_follow_period strut_follow_carry(strut_follow_system *system, double *unknowns, bool works);
/** f (n): what changes from y to `end` in unknowns; returns its largest entry. */
double strut_follow_change(const strut_follow_system *system, const double *unknowns,
                           const double *end, double *f);
/** Fills the jacobian at the motion; in any case f (n) is the residual there. */
bool strut_follow_differentiate_states(strut_follow_system *system,
                                       const strut_follow_motion *motion, double *f);
/** Fills the columns at the motion; f is the residual there. */
bool strut_follow_differentiate_parameters(strut_follow_system *system,
                                           const strut_follow_motion *motion, const double *f);
/** The k-th parameter [SI] over its range. */
static inline double strut_follow_scaled(const strut_follow_system *system, size_t k,
                                         double value) {
  return (value - system->low[k]) / (system->high[k] - system->low[k]);
}
/** The motion moved by a multiple of a difference (m) of unknowns. */
void strut_follow_move(const strut_follow_system *system, strut_follow_motion *motion,
                       const double *change, double factor);
/** change (m): unknowns of `to` less those of `from`; returns its length. */
double strut_follow_between(const strut_follow_system *system, const strut_follow_motion *from,
                            const strut_follow_motion *to, double *change);
/** Shifts y along the ground so that the mean of the nodes is at 0, where the structure travels. */
void strut_follow_centre(const strut_follow_system *system, double *unknowns);
/** Unit of unknown i [m] or [m/s]. */
static inline double strut_follow_unit(const strut_follow_system *system, size_t i) {
  return i < system->n / 2 ? system->length : system->speed;
}
/**
 * Solves the bordered system [jacobian - 1, columns; rows] x = right in place of right (m), a row (m) for each
 * parameter. False where it is singular.
 */
bool strut_follow_solve(strut_follow_system *system, const double *const rows[2], double *right);
/** Broyden's update: the derivative that would have predicted the residual f (n) behind the step x (m). */
void strut_follow_update(strut_follow_system *system, const double *f, const double *vector);
/** Part of a step at which a cubic has its extremum: it rises by that, with slopes a and b at its ends. */
double strut_follow_extremum(double rise, double a, double b);

#endif
