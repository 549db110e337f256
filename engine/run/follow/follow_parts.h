/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the parts of following share. Internal to engine/run/follow. */
#ifndef STRUT_ENGINE_RUN_FOLLOW_PARTS_H
#define STRUT_ENGINE_RUN_FOLLOW_PARTS_H

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

/**
 * Newton's method from y and the value on the plane normal . (x - base) = distance; normal (n + 1), base a
 * state and a value. The derivative in the system serves as long as it converges. False: no orbit there.
 */
bool strut_follow_newton(strut_follow_walk *w, double *y, double *value, const double *normal,
                         const double *base_y, double base_value, double distance, int *rounds);
/**
 * Multipliers of the system's derivative by size; the one of shifts, 0 in it, is left out. scratch (n, n),
 * multiplier (n). False: out of memory.
 */
bool strut_follow_multipliers(const strut_follow_system *s, double *scratch,
                              double (*multiplier)[2], size_t *count);
/** Travel, work and word of the orbit at o->y, o->value. False: motion lost, or status. */
bool strut_follow_measure(strut_follow_walk *w, strut_follow_orbit *o);
/** Both that and what follows, which then takes one run less. */
bool strut_follow_examine(strut_follow_walk *w, strut_follow_orbit *o, const double *before);
/** Derivative, multipliers, tangent along `before` (n + 1). False as above. */
bool strut_follow_complete(strut_follow_walk *w, strut_follow_orbit *o, const double *before);
/** An orbit with its arrays; NULL: out of memory, which the walk's status says. */
strut_follow_orbit *strut_follow_orbit_new(strut_follow_walk *w);
/** direction (n): eigenvector of the derivative at o, of the real multiplier nearest to `value`. */
bool strut_follow_eigenvector(strut_follow_walk *w, const strut_follow_orbit *o, double value,
                              double *direction);

/* follow_word.c */

/** The word of what the system's log holds. False: out of memory. */
bool strut_follow_word_read(const strut_follow_system *s, strut_arena *arena,
                            strut_follow_word *word);
bool strut_follow_words_equal(const strut_follow_word *a, const strut_follow_word *b);
/** What changes from a to b, which are near the point of change: kind, name and sentence. */
bool strut_follow_words_compare(const strut_follow_system *s, const strut_follow_word *a,
                                const strut_follow_word *b, strut_arena *arena,
                                strut_follow_point *point);
/** As a text: "n4 down, n4 slips +, ..." in short. NULL: out of memory. */
const char *strut_follow_word_text(const strut_follow_system *s, const strut_follow_word *word,
                                   strut_arena *arena);

/* follow_special.c */

/** Locates what changes between two complete orbits of a step and appends the points. */
bool strut_follow_locate(strut_follow_walk *w, const strut_follow_orbit *a,
                         const strut_follow_orbit *b);

/* follow_walk.c */

/** Appends a point at o; `at`: arclength. Returns it, or NULL. */
strut_follow_point *strut_follow_add(strut_follow_walk *w, const strut_follow_orbit *o, double arc,
                                     strut_follow_kind kind);

#endif
