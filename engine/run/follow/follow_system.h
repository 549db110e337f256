/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The equations of a periodic motion over a parameter: G(z, p) = P(z; p) - z, with P the period map.
 *
 * Unknowns are the free coordinates over `length`, their velocities over `speed`, and the parameter
 * over its range, counted from its lower end: all of order one. Each value of the parameter has a scene
 * and a model of its own. Where the structure travels, shifts along the ground are neutral; the
 * derivative of P is kept without that direction, whose multiplier is then 0 instead of 1.
 */
#ifndef STRUT_ENGINE_RUN_FOLLOW_FOLLOW_SYSTEM_H
#define STRUT_ENGINE_RUN_FOLLOW_FOLLOW_SYSTEM_H

#include "engine/base/flag.h"
#include "engine/integrate/events/location/event_log.h"
#include "engine/integrate/events/location/variation.h"
#include "engine/run/orbit/orbit.h"

enum { STRUT_FOLLOW_MOST = 96 }; /* most free coordinates and velocities */

/** Makes the scene of a value of the parameter [SI]; strut_setup_free releases it. */
typedef struct strut_follow_scenes {
  strut_status (*setup)(void *context, double value, strut_setup *setup, strut_error *error);
  void *context;
} strut_follow_scenes;

typedef struct strut_follow_system {
  strut_follow_scenes scenes;
  double low, high; /* range of the parameter [SI] */
  /** How periods are computed. */
  struct {
    const char *method;       /* of integration */
    double tolerance;         /* of a method with error control [1] */
    int64_t steps_per_period; /* of a method with fixed steps; of others the fewest */
    int32_t repeats;          /* drive periods of P */
    int threads;
    const strut_flag *interrupt;
  } how;
  /* made by open and by the first value */
  double value; /* of the model below [SI]; NAN: there is none */
  strut_setup setup;
  strut_model *model;
  strut_period_map *map;      /* (threads) */
  double period;              /* of the drive there [s] */
  strut_event_log *log;       /* of map[0] */
  strut_variation *variation; /* of map[0]; NULL: derivatives are differences of runs */
  size_t n, both;             /* free coordinates and velocities; 2 length + 1 */
  size_t *place;              /* (n) of an unknown in a state */
  double *along;              /* (n) unit vector of shifts along the ground, or zeros */
  bool travels;
  double length, speed; /* units of the unknowns [m], [m/s] */
  /** At some point on the way. */
  struct {
    bool known;
    double *jacobian; /* (n, n) of P, without shifts */
    double *column;   /* (n) of G to the parameter over its range */
  } derivative;
  struct {
    double *there;  /* (threads, both) */
    double *end;    /* (both) */
    double *seen;   /* (4, 2 nodes) lowest and highest positions, latest positions and velocities */
    double *matrix; /* (n + 1, n + 1) */
  } buffers;
  struct {
    int64_t evaluations; /* of the forces */
    int64_t maps;        /* periods computed */
    int64_t scenes;      /* made */
  } spent;
  strut_arena arena;
} strut_follow_system;

/** Result of one application of P. */
typedef struct strut_follow_period {
  double travel;    /* [m]; NAN where the motion was lost or interrupted */
  double work;      /* done on the structure [J]; only with `works` */
  double amplitude; /* half the largest range of a coordinate [m]; only with `works` */
} strut_follow_period;

/**
 * Prepares the equations at the value [SI]; `repeats` and what stands before it in the struct must be
 * filled. STRUT_USAGE with a sentence where the scene has no such motions: no periodic drive, a memory,
 * too many coordinates, a method without events over contacts.
 */
strut_status strut_follow_open(strut_follow_system *system, double value, strut_error *error);
void strut_follow_close(strut_follow_system *system);
/** Makes the model of a value, if it is another one. */
strut_status strut_follow_set_value(strut_follow_system *system, double value, strut_error *error);
/** Changes the number of drive periods of P. */
strut_status strut_follow_set_repeats(strut_follow_system *system, int32_t repeats,
                                      strut_error *error);
/** Changes the number of steps of a period. */
strut_status strut_follow_set_steps(strut_follow_system *system, int64_t steps, strut_error *error);
/** Chooses the units by the motion from the state y (both) over one application. */
bool strut_follow_set_units(strut_follow_system *system, const double *unknowns);
/** Moves y (both) by one application at the present value; with `works` and events in s->log. */
strut_follow_period strut_follow_apply(strut_follow_system *system, double *unknowns, bool works);
/** f (n): scaled residual at y; returns its largest entry, HUGE_VAL where the motion was lost. */
double strut_follow_residual(strut_follow_system *system, const double *unknowns, double *f);
/** As strut_follow_apply, and fills jacobian at the start; only where there is `variation`. */
strut_follow_period strut_follow_carry(strut_follow_system *system, double *unknowns, bool works);
/** Fills jacobian by central differences of whole runs. */
void strut_follow_difference(strut_follow_system *system, const double *unknowns, bool *lost);
/** f (n): scaled residual of an application from y to `end`; returns its largest entry. */
double strut_follow_change(const strut_follow_system *system, const double *unknowns,
                           const double *end, double *f);
/** Fills column at y and the present value; f is the residual there. */
strut_status strut_follow_differentiate_parameter(strut_follow_system *system,
                                                  const double *unknowns, const double *f,
                                                  bool *lost, strut_error *error);
/** Fills jacobian and column at y and the present value; f is the residual there. */
strut_status strut_follow_differentiate(strut_follow_system *system, const double *unknowns,
                                        const double *f, bool *lost, strut_error *error);
/** The parameter [SI] over its range. */
static inline double strut_follow_scaled(const strut_follow_system *system, double value) {
  return (value - system->low) / (system->high - system->low);
}
/** The state y moved by a difference d (n) of unknowns. */
void strut_follow_move(const strut_follow_system *system, double *unknowns, const double *change,
                       double factor);
/** Shifts y along the ground so that the mean of the nodes is at 0, where the structure travels. */
void strut_follow_centre(const strut_follow_system *system, double *unknowns);
/** Unit of unknown i [m] or [m/s]. */
static inline double strut_follow_unit(const strut_follow_system *system, size_t i) {
  return i < system->n / 2 ? system->length : system->speed;
}
/**
 * Solves the bordered system [jacobian - 1, column; normal] x = right in place of right (n + 1); normal
 * (n + 1). False where it is singular.
 */
bool strut_follow_solve(strut_follow_system *system, const double *normal, double *right);

/** Columns (n) beside jacobian - 1, and rows (n + count) below: one for each parameter. */
typedef struct strut_follow_border {
  size_t count;
  double *column[2];
  const double *row[2];
} strut_follow_border;
/** The same of any border; scratch (n + count, n + count). */
bool strut_follow_solve_with(const strut_follow_system *system, const strut_follow_border *border,
                             double *scratch, double *right);
/** Broyden's update: the derivative that would have predicted the residual f (n) behind the step x. */
void strut_follow_update(strut_follow_system *system, const strut_follow_border *border,
                         const double *f, const double *vector);

#endif
