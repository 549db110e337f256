/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the parts of following share. Internal to engine/run/follow. */
#pragma once

#include "engine/run/follow/follow.h"

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

/** A periodic motion on a branch or, over two parameters, on the surface of all motions. */
typedef struct strut_follow_orbit {
  strut_follow_motion at;
  double *tangent[2];      /* (m) orthonormal, one for each parameter */
  double (*multiplier)[2]; /* (n) the largest first */
  size_t multipliers;
  strut_follow_signature signature;
  double velocity, work, amplitude,
      distance; /* distance: from the begin of the step, along its tangent */
  strut_follow_word word;
  bool complete;                           /* multipliers, signature and tangents are there */
  const struct strut_follow_orbit *before; /* from which the step came; or NULL */
} strut_follow_orbit;

/** What a walk along a branch or a curve works on. */
typedef struct strut_follow_walk {
  strut_follow_system *s;
  const strut_follow_limits *limits;
  strut_follow_branch *branch;
  double arc;
  size_t begin;   /* first point of this way in the branch */
  bool backwards; /* the points go into the branch in reverse order, with negative arcs */
} strut_follow_walk;

/* follow_orbit.c */

/** The planes row[k] . (x - base) = offset[k], as many as there are parameters. */
typedef struct strut_follow_planes {
  const strut_follow_motion *base;
  const double *row[2]; /* (m) */
  double offset[2];
} strut_follow_planes;

/**
 * Newton's method from the motion to that on the planes. The derivative in the system serves as long as it
 * converges. False: no orbit there.
 */
bool strut_follow_newton(strut_follow_system *system, const strut_follow_planes *planes,
                         strut_follow_motion *motion, int *rounds);
/** Travel, work and word of the orbit, whose state is centred; the word is in the arena. */
bool strut_follow_measure(strut_follow_system *system, strut_arena *arena,
                          strut_follow_orbit *orbit);
/** Both that and what follows, which then takes one run less. */
bool strut_follow_examine(strut_follow_system *system, strut_arena *arena,
                          strut_follow_orbit *orbit, const double *before);
/** Derivative, multipliers, tangents; that of a single parameter along `before` (m). */
bool strut_follow_complete(strut_follow_system *system, strut_follow_orbit *orbit,
                           const double *before);
/** An orbit with its arrays, at the motion unless that is NULL; NULL: out of memory. */
strut_follow_orbit *strut_follow_orbit_new(strut_follow_system *system, strut_arena *arena,
                                           const strut_follow_motion *from);
/** direction (n): eigenvector of the derivative at o, of the real multiplier nearest to `value`. */
bool strut_follow_eigenvector(strut_follow_system *system, const strut_follow_orbit *orbit,
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

/** A test function that vanishes along a curve of special points. Zero-initialise. */
typedef struct strut_follow_criterion {
  strut_follow_kind kind;
  int32_t contact; /* of TOUCH and LIFT */
  double phase;    /* of the extremum, in repetitions; that of the last point, and of the next */
  double next_phase;
} strut_follow_criterion;

/** Value of the test function at a motion, which is completed where that is needed. False: none, or status. */
bool strut_follow_criterion_at(strut_follow_system *system, strut_follow_criterion *criterion,
                               strut_follow_orbit *orbit, double *value);
/** Chooses the contact and the phase by the gaps of the node's contacts. False: none is near zero. */
bool strut_follow_criterion_choose(strut_follow_system *system, strut_follow_criterion *criterion,
                                   const strut_follow_motion *motion, const char *node);

/* follow_walk.c */

/** Appends a point at o; `at`: arclength. Returns it, or NULL. */
strut_follow_point *strut_follow_add(strut_follow_walk *walk, const strut_follow_orbit *orbit,
                                     double arc, strut_follow_kind kind);
/** The points of the way back, which were appended behind `forth`, go before those of the way forth. */
void strut_follow_order(strut_follow_branch *branch, size_t forth);
/** Has the way come back to where it began? */
bool strut_follow_is_closed(const strut_follow_walk *walk, const strut_follow_orbit *begin,
                            const strut_follow_orbit *orbit, double step);
