/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Branches of periodic motions over a parameter, stable and unstable, by pseudo-arclength (Keller 1977),
 * with their Floquet multipliers and the points where their kind changes.
 *
 * A branch is followed both ways from a motion. Between two of its points special ones are located:
 * where a multiplier passes the unit circle, where the branch turns, and where the sequence of touchdowns,
 * slips and other events changes.
 */
#pragma once

#include "engine/base/status.h"
#include "engine/integrate/events/location/event_log.h"
#include "engine/integrate/events/location/variation.h"
#include "engine/run/orbit/orbit.h"

/*
 * The equations of a periodic motion over one or two parameters: G(z, p) = P(z; p) - z, with P the period map.
 *
 * Unknowns are the free coordinates over `length`, their velocities over `speed`, and each parameter over its
 * range: all of order one. Each value of the parameters has a scene and a model of its own. Where the structure
 * travels, shifts along the ground are neutral; the derivative of P is kept without that direction, whose
 * multiplier is then 0 instead of 1.
 *
 * Functions return false where the motion is lost or `status` stops everything.
 */

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

/** Kinds of points: X(NAME, word, what it is). */
#define STRUT_FOLLOW_TABLE(X)                                                                      \
  X(REGULAR, "", "a point of the branch")                                                          \
  X(START, "start", "the motion from which the branch was followed")                               \
  X(END, "end", "the branch ends, or leaves the range")                                            \
  X(CUSP, "cusp", "of a curve: two folds meet; between two points, interpolated")                  \
  X(FOLD, "fold", "the branch turns: a multiplier passes 1")                                       \
  X(BRANCHING, "branching", "a multiplier passes 1 though the branch does not turn")               \
  X(DOUBLING, "period-doubling", "a multiplier passes -1")                                         \
  X(TORUS, "torus", "a pair of multipliers passes the unit circle")                                \
  X(TOUCH, "grazing", "a node begins or ceases to touch the ground")                               \
  X(LIFT, "lift-off", "a node begins or ceases to leave the ground for a moment")                  \
  X(STICK, "stick", "a node begins or ceases to stick for a moment")                               \
  X(SLIP, "slip", "a node begins or ceases to slip one way for a moment")                          \
  X(SWITCH, "switch", "a cable or an element begins or ceases to change its mode")                 \
  X(MEETING, "meeting", "two events change their order")

typedef enum strut_follow_kind {
#define STRUT_FOLLOW_ENUM(name, word, what) STRUT_FOLLOW_##name,
  STRUT_FOLLOW_TABLE(STRUT_FOLLOW_ENUM) STRUT_FOLLOW_KINDS
} strut_follow_kind;

/** The word of a kind, "" of a regular point. */
STRUT_API const char *strut_follow_kind_word(strut_follow_kind kind);

/** A point of a branch or a curve. Texts and arrays belong to it. */
typedef struct strut_follow_point {
  strut_follow_kind kind;
  strut_follow_motion at;
  double arc;       /* along the branch, from its lower end [1] */
  double velocity;  /* [m/s] */
  double work;      /* of drives, loads and belts in a drive period [J] */
  double amplitude; /* half the largest range of a coordinate in a repetition [m] */
  bool stable;      /* of a curve: all multipliers but the one that decides are within the circle */
  double multiplier[2]; /* the largest of these, real and imaginary part; NAN where there is none */
  const char *word;     /* the events of a period */
  const char *node;     /* of an event, or a member or element; or NULL */
  const char *detail;   /* of a special point: a sentence without full stop; or NULL */
  bool changes;         /* of a special point: stability changes there */
  int32_t unstable[2];  /* multipliers outside the unit circle before and behind it */
  double *critical;     /* (n) of DOUBLING: direction of the doubled motion; or NULL */
} strut_follow_point;

/** Motions over one parameter, or a curve of special ones over two. */
typedef struct strut_follow_branch {
  strut_follow_kind kind; /* of a curve: FOLD, DOUBLING, TOUCH or LIFT */
  const char *node;       /* of TOUCH and LIFT; or NULL */
  int32_t repeats;        /* drive periods after which its motions repeat */
  size_t count, room, start;
  strut_follow_point *points; /* (count) by arc */
  const char *ends[2];        /* why it ends there: sentences without full stop */
  bool travels;
  strut_arena arena;
} strut_follow_branch;

typedef struct strut_follow_limits {
  int32_t steps;  /* most steps each way */
  double longest; /* step of a parameter, in its range */
  /** Fraction of the range covered; may be NULL. */
  void (*progress)(void *context, double fraction);
  void *progress_context;
} strut_follow_limits;

/**
 * Moves y (both), near a periodic motion at the system's values, onto it. False where Newton's method does not
 * converge, and `reason` (200) says why.
 */
STRUT_API bool strut_follow_correct(strut_follow_system *system, double *unknowns, char *reason);
/**
 * Chooses the steps of a period, of a method that takes fixed ones, for the fastest vibrations at both ends of
 * the range and here. False: there would be too many, or status.
 */
STRUT_API bool strut_follow_choose_steps(strut_follow_system *system, double accuracy);
/**
 * Compares the motion y (both) with what half the step makes of it, and halves the step until velocity or
 * amplitude agree to the accuracy.
 */
STRUT_API void strut_follow_check_steps(strut_follow_system *system, double *unknowns,
                                        double accuracy);
/**
 * Follows the branch both ways from the motion y at the system's value, which is on it; `direction` (n):
 * NULL, or that in which the branch leaves y, of a doubled branch. The branch is to be freed in any case;
 * with STRUT_INTERRUPTED it holds what was followed so far.
 */
STRUT_API strut_status strut_follow_branch_make(strut_follow_system *system, const double *unknowns,
                                                const double *direction,
                                                const strut_follow_limits *limits,
                                                strut_follow_branch *branch);
STRUT_API void strut_follow_branch_free(strut_follow_branch *branch);
/** Is the motion y at the value on the branch, which has the same repeats? Corrects to find out. */
STRUT_API bool strut_follow_is_on(strut_follow_system *system, const strut_follow_branch *branch,
                                  const double *unknowns);

/* Curves of special points over two parameters: folds, period doublings, grazings and lift-offs.
 *
 * On the surface of periodic motions a test function vanishes along such a curve: det(dP - 1) at folds,
 * det(dP + 1) at doublings, the extremum of a node's gap at grazings and lift-offs. The curve is followed by
 * arclength in state and parameters; across it the root is found by a secant, so that no derivative of the
 * test function is needed. Where a curve of folds has a cusp its points are regular; only its projection to
 * the parameters turns back.
 */

/** Where a curve starts: near a motion. */
typedef struct strut_follow_curve_start {
  strut_follow_kind kind;
  const char *node; /* of TOUCH and LIFT */
  strut_follow_motion at;
} strut_follow_curve_start;

/** Can curves of the kind be followed? */
STRUT_API bool strut_follow_curve_known(strut_follow_kind kind);
/**
 * Follows the curve both ways; the system is open over two parameters at values near the start, with its units.
 * Where the start is on no curve, count is 0 and ends[0] says why. The curve is to be freed in any case; with
 * STRUT_INTERRUPTED it holds what was followed so far.
 */
STRUT_API strut_status strut_follow_curve_make(strut_follow_system *system,
                                               const strut_follow_curve_start *start,
                                               const strut_follow_limits *limits,
                                               strut_follow_branch *curve);
/** Does the curve pass the start, which has as many repeats? */
STRUT_API bool strut_follow_curve_passes(const strut_follow_system *system,
                                         const strut_follow_branch *curve,
                                         const strut_follow_curve_start *start);
