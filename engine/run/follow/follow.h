/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Branches of periodic motions over a parameter, stable and unstable, by pseudo-arclength (Keller 1977),
 * with their Floquet multipliers and the points where their kind changes.
 *
 * A branch is followed both ways from a motion. Between two of its points special ones are located:
 * where a multiplier passes the unit circle, where the branch turns, and where the sequence of touchdowns,
 * slips and other events changes.
 */
#ifndef STRUT_ENGINE_RUN_FOLLOW_FOLLOW_H
#define STRUT_ENGINE_RUN_FOLLOW_FOLLOW_H

#include "engine/run/follow/follow_system.h"

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
  STRUT_FOLLOW_TABLE(STRUT_FOLLOW_ENUM)
#undef STRUT_FOLLOW_ENUM
      STRUT_FOLLOW_KINDS
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

#endif
