/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What following folds over two parameters is made of: the surface, the criterion, the curve, the parts of a
 * walk.
 */
#ifndef STRUT_ENGINE_RUN_FOLLOW_FOLLOW_PARTS_H
#define STRUT_ENGINE_RUN_FOLLOW_FOLLOW_PARTS_H

#include "engine/run/follow/follow.h"
#include "engine/run/follow/follow_system.h"

/* Periodic motions over two parameters: the surface G(z, p1, p2) = 0.
 *
 * Unknowns are those of follow_system.h and a second parameter, over its range as the first. At a point the
 * surface has a plane of tangents, the null space of [dP - 1, dG/dp1, dG/dp2], which is of full rank at
 * folds, too. Other points are found by Newton's method with two more equations.
 */

/** Makes the scene of two values [SI]; strut_setup_free releases it. */
typedef struct strut_follow_plane {
  strut_status (*setup)(void *context, const double values[2], strut_setup *setup,
                        strut_error *error);
  void *context;
} strut_follow_plane;

/** A motion on the surface. */
typedef struct strut_follow_surface_point {
  double value[2];         /* [SI] */
  double *y;               /* (both) */
  double *basis[2];        /* (n + 2) orthonormal tangents; once complete */
  double (*multiplier)[2]; /* (n) the largest first; once complete */
  size_t multipliers;
  double *jacobian; /* (n, n) of the period map, without shifts; once complete */
  bool complete;
} strut_follow_surface_point;

/** Must not move once it is open. Zero-initialise but for what stands before `second`. */
typedef struct strut_follow_surface {
  strut_follow_system s; /* over the first parameter; `scenes` and the range are filled by open */
  strut_follow_plane scenes;
  double low[2], high[2]; /* ranges [SI] */
  double second;          /* value of the second parameter in s [SI] */
  size_t m;               /* n + 2 */
  double *second_column;  /* (n) derivative of G to the second parameter over its range */
  double *f, *x;          /* (n), (m) scratch */
  double *matrix;         /* (m, m) scratch */
  strut_status status;    /* what stops everything */
  strut_error *error;
  strut_arena arena;
} strut_follow_surface;

/**
 * Prepares the equations at two values; s.repeats and what stands before it in s must be filled, and the
 * ranges. As strut_follow_open.
 */
strut_status strut_follow_surface_open(strut_follow_surface *surface, const double value[2],
                                       strut_error *error);
void strut_follow_surface_close(strut_follow_surface *surface);
/** Makes the model of two values. False: that scene is not valid, or status. */
bool strut_follow_surface_set(strut_follow_surface *surface, const double value[2]);
/** An empty point in the arena; NULL: out of memory. */
strut_follow_surface_point *strut_follow_surface_point_new(const strut_follow_surface *surface,
                                                           strut_arena *arena);
void strut_follow_surface_point_copy(const strut_follow_surface *surface,
                                     const strut_follow_surface_point *from,
                                     strut_follow_surface_point *to);
/** Unknown i of b less that of a, each of order one; i up to n + 1. */
double strut_follow_surface_difference(const strut_follow_surface *surface,
                                       const strut_follow_surface_point *first,
                                       const strut_follow_surface_point *second, size_t i);
/** Moves p by a multiple of a direction (n + 2); it is incomplete then. */
void strut_follow_surface_move(const strut_follow_surface *surface,
                               strut_follow_surface_point *point, const double *direction,
                               double factor);
/**
 * Newton's method from p to the motion with rows[k] . (p - base) = offset[k]. The derivative of an earlier
 * point serves while it makes the residual fall. False: there is none, or status.
 */
bool strut_follow_surface_correct(strut_follow_surface *surface, strut_follow_surface_point *point,
                                  const strut_follow_surface_point *base,
                                  const double *const rows[2], const double offset[2]);
/** Derivative, tangents and multipliers at p, which is a motion. False as above. */
bool strut_follow_surface_complete(strut_follow_surface *surface,
                                   strut_follow_surface_point *point);

/* Test functions that vanish along curves of special points. Internal to engine/run/follow. */

/** Which test function, and what it needs. Zero-initialise. */
typedef struct strut_follow_criterion {
  strut_follow_kind kind;
  int32_t contact; /* of TOUCH and LIFT */
  double phase;    /* of the extremum, in repetitions; that of the last point, and of the next */
  double next_phase;
  bool phased;     /* phase is known */
  double *scratch; /* (n, n) */
} strut_follow_criterion;

/** Value of the test function at a motion, which is completed where that is needed. False: none, or status. */
bool strut_follow_criterion_at(strut_follow_surface *surface, strut_follow_criterion *criterion,
                               strut_follow_surface_point *point, double *value);
/** Chooses the contact and the phase by the gaps of the node's contacts. False: none is near zero. */
bool strut_follow_criterion_choose(strut_follow_surface *surface, strut_follow_criterion *criterion,
                                   const strut_follow_surface_point *point, const char *node);

/* Curves of special points over two parameters: folds, period doublings, grazings and lift-offs.
 *
 * On the surface of periodic motions a test function vanishes along such a curve: det(dP - 1) at folds,
 * det(dP + 1) at doublings, the extremum of a node's gap at grazings and lift-offs. The curve is followed by
 * arclength in state and parameters; across it the root is found by a secant, so that no derivative of the
 * test function is needed. Where a curve of folds has a cusp its points are regular; only its projection to
 * the parameters turns back.
 */

/** A point of a curve. The state belongs to the curve. */
typedef struct strut_follow_curve_point {
  double value[2], arc; /* of the parameters [SI]; along the curve, from its lower end [1] */
  double velocity, work, amplitude; /* as of a point of a branch */
  bool cusp;                        /* two folds meet; between two points, interpolated */
  bool stable;          /* all multipliers but the one that decides are within the unit circle */
  double multiplier[2]; /* the largest of these; NAN where there is none */
  double *y;            /* (both) */
} strut_follow_curve_point;

typedef struct strut_follow_curve {
  strut_follow_kind kind; /* FOLD, DOUBLING, TOUCH or LIFT */
  int32_t contact;        /* of TOUCH and LIFT */
  int32_t repeats;
  const char *node; /* of TOUCH and LIFT; or NULL */
  size_t count, start;
  strut_follow_curve_point *points; /* (count) by arc */
  const char *ends[2];              /* why it ends there: sentences without full stop */
  int64_t maps;
  bool travels;
  strut_arena arena;
} strut_follow_curve;

/** Where a curve starts: near a motion y (both) at two values. */
typedef struct strut_follow_curve_start {
  strut_follow_kind kind;
  const char *node; /* of TOUCH and LIFT */
  double value[2];  /* [SI] */
  const double *y;
} strut_follow_curve_start;

typedef struct strut_follow_curve_limits {
  int32_t steps;  /* most steps each way */
  double longest; /* step of a parameter, in its range */
} strut_follow_curve_limits;

/** Can curves of the kind be followed? */
STRUT_API bool strut_follow_curve_known(strut_follow_kind kind);
/**
 * Follows the curve both ways; the surface is open at values near the start, with its units. Where the
 * start is on no curve, count is 0 and ends[0] says why. The curve is to be freed in any case; with
 * STRUT_INTERRUPTED it holds what was followed so far.
 */
STRUT_API strut_status strut_follow_curve_make(strut_follow_surface *surface,
                                               const strut_follow_curve_start *start,
                                               const strut_follow_curve_limits *limits,
                                               strut_follow_curve *curve, strut_error *error);
STRUT_API void strut_follow_curve_free(strut_follow_curve *curve);
/** Does the curve pass the start, which has as many repeats? */
STRUT_API bool strut_follow_curve_passes(const strut_follow_surface *surface,
                                         const strut_follow_curve *curve,
                                         const strut_follow_curve_start *start);

/* What the parts of following share. Internal to engine/run/follow. */

/** An event of an orbit, and how long its mode lasts. */
typedef struct strut_follow_letter {
  int32_t item;
  int8_t mode;
  double time, lasts; /* [periods] */
} strut_follow_letter;

/** The events of an orbit in their order. */
typedef struct strut_follow_word {
  size_t count;
  strut_follow_letter *letter; /* (count) */
  int8_t *first;               /* (items) modes at the start */
} strut_follow_word;

/** How many multipliers are outside the unit circle, and where. */
typedef struct strut_follow_signature {
  int32_t plus, minus, pairs; /* real above 1, real below -1, complex pairs */
  int32_t turn;               /* sign of the tangent's part along the parameter */
} strut_follow_signature;

/** A periodic motion on a branch. */
typedef struct strut_follow_orbit {
  double value;
  double *y;               /* (both) */
  double *tangent;         /* (n + 1) of length 1 */
  double (*multiplier)[2]; /* (n) the largest first */
  size_t multipliers;
  strut_follow_signature signature;
  double velocity, work, amplitude,
      distance; /* distance: from the begin of the step, along its tangent */
  strut_follow_word word;
  bool complete;                           /* multipliers, signature and tangent are there */
  const struct strut_follow_orbit *before; /* from which the step came; or NULL */
} strut_follow_orbit;

/** What a walk along a branch works on. */
typedef struct strut_follow_walk {
  strut_follow_system *s;
  const strut_follow_limits *limits;
  strut_follow_branch *branch;
  strut_error *error;
  strut_status status; /* what stops everything */
  double *right;       /* (n + 1) scratch */
  double *f, *try_y;   /* (n), (both) scratch */
  double *trials;      /* (2, both), (2, n) scratch of Newton's method */
  double *eigen;       /* (n, n) scratch */
  size_t room;
  double arc;
  size_t begin;   /* first point of this way in the branch */
  bool rough;     /* orbits need not be exact now */
  bool exact;     /* they are not corrected afterwards */
  bool backwards; /* the points go into the branch in reverse order, with negative arcs */
} strut_follow_walk;

/* follow_orbit.c */

/** The plane normal . (x - base) = distance; normal (n + 1), base a state and a value. */
typedef struct strut_follow_section {
  const double *normal, *base_y;
  double base_value, distance;
} strut_follow_section;

/**
 * Newton's method from y and the value on a plane. The derivative in the system serves as long as it
 * converges. False: no orbit there.
 */
bool strut_follow_newton(strut_follow_walk *walk, double *unknowns, double *value,
                         const strut_follow_section *plane, int *rounds);
/**
 * Multipliers of the system's derivative by size; the one of shifts, 0 in it, is left out. scratch (n, n),
 * multiplier (n). False: out of memory.
 */
bool strut_follow_multipliers(const strut_follow_system *system, double *scratch,
                              double (*multiplier)[2], size_t *count);
/** Travel, work and word of the orbit at o->y, o->value. False: motion lost, or status. */
bool strut_follow_measure(strut_follow_walk *walk, strut_follow_orbit *orbit);
/** Both that and what follows, which then takes one run less. */
bool strut_follow_examine(strut_follow_walk *walk, strut_follow_orbit *orbit, const double *before);
/** Derivative, multipliers, tangent along `before` (n + 1). False as above. */
bool strut_follow_complete(strut_follow_walk *walk, strut_follow_orbit *orbit,
                           const double *before);
/** An orbit with its arrays; NULL: out of memory, which the walk's status says. */
strut_follow_orbit *strut_follow_orbit_new(strut_follow_walk *walk);
/** direction (n): eigenvector of the derivative at o, of the real multiplier nearest to `value`. */
bool strut_follow_eigenvector(strut_follow_walk *walk, const strut_follow_orbit *orbit,
                              double value, double *direction);

/* follow_word.c */

/** The word of what the system's log holds. False: out of memory. */
bool strut_follow_word_read(const strut_follow_system *system, strut_arena *arena,
                            strut_follow_word *word);
bool strut_follow_words_equal(const strut_follow_word *first, const strut_follow_word *second);
/** What changes from a to b, which are near the point of change: kind, name and sentence. */
bool strut_follow_words_compare(const strut_follow_system *system, const strut_follow_word *first,
                                const strut_follow_word *second, strut_arena *arena,
                                strut_follow_point *point);
/** As a text: "n4 down, n4 slips +, ..." in short. NULL: out of memory. */
const char *strut_follow_word_text(const strut_follow_system *system, const strut_follow_word *word,
                                   strut_arena *arena);

/* follow_special.c */

/** Locates what changes between two complete orbits of a step and appends the points. */
bool strut_follow_locate(strut_follow_walk *walk, const strut_follow_orbit *first,
                         const strut_follow_orbit *second);

/* follow_walk.c */

/** Appends a point at o; `at`: arclength. Returns it, or NULL. */
strut_follow_point *strut_follow_add(strut_follow_walk *walk, const strut_follow_orbit *orbit,
                                     double arc, strut_follow_kind kind);

#endif
