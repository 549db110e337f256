/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * All stationary points of one potential: found from many starts, merged, classified and connected.
 */
#ifndef STRUT_ENGINE_STATICS_SEARCH_CRITICAL_H
#define STRUT_ENGINE_STATICS_SEARCH_CRITICAL_H

#include <signal.h>

#include "engine/statics/minimise.h"
#include "engine/statics/search/critical_point.h"

typedef struct strut_critical_set {
  size_t count;
  strut_critical_point *points; /* minima by energy, then saddles by energy, then maxima */
  int64_t starts;               /* tried for minima */
  int64_t saddle_starts;        /* tried for saddles */
  int64_t exhausted, runaway;   /* starts that ended nowhere */
  double missed; /* estimated chance that a further random start would find a new minimum: Good and
                         Turing's, one more counted than was met once, for few starts never tell 0 */
  double missed_below; /* the same, its upper 95 % limit */
  int64_t unmet;       /* minima found that no random start met: their basins are small */
  bool cut_short;      /* the structure is too large for as many starts and climbs as it asks for */
  double
      missed_one; /* upper 95 % bound on the share of starts of a minimum never seen: 3/starts-like */
  strut_arena arena;
} strut_critical_set;

typedef struct strut_critical_effort {
  int64_t starts; /* random starts for minima; 0: until `missed` is small, within reason */
  uint64_t seed;
  int32_t searches;           /* searches that share the work limit, one per support set; 0: 1 */
  bool saddles;               /* look for saddles too, and where they lead down to */
  size_t extra_count;         /* starts that the caller knows of, tried first */
  const double *const *extra; /* (extra_count) each (length) */
  size_t hint_count;          /* shapes close to a saddle with one negative eigenvalue */
  const double *const *hint;  /* (hint_count) each (length) */
  const volatile sig_atomic_t *interrupt; /* ends the search with STRUT_INTERRUPTED; may be NULL */
} strut_critical_effort;

/**
 * Starts: the model's own, mirror images member by member, `extra`, then random ones, each from a
 * generator of its own, so that threads change no bit; then what the minima found lead to, folded
 * or with the nodes of two put together, and both sides of every saddle, by steps short enough for
 * the smallest wells. Merged are points that a rigid motion of the whole, mirrored or not, carries
 * onto each other, if scene and supports fix at most three coordinates (then only placements
 * differ); else only equal points. Above STRUT_DENSE_STATICS coordinates only the model's own start
 * and `extra` are tried unless `starts` says otherwise. Below, the work is bounded, counted in
 * decomposed Hessians, to some ten seconds of one core in all; cut_short reports an early end.
 */
STRUT_API strut_status strut_critical_search(const strut_potential *potential,
                                             const strut_critical_effort *effort,
                                             strut_critical_set *set, strut_error *error);
STRUT_API void strut_critical_free(strut_critical_set *set);

/**
 * Classifies one stationary point q: label, eigenvalues, zero modes. The point's arrays are in the
 * arena.
 */
STRUT_API strut_status strut_critical_judge(const strut_potential *potential, const double *q,
                                            strut_arena *arena, strut_critical_point *point,
                                            strut_error *error);

/**
 * Largest distance between corresponding nodes after the best rigid motion carries b onto a, mirror
 * images allowed if `mirror`; *mirrored: one was used (may be NULL) [m].
 */
STRUT_API double strut_shape_distance(const strut_model *model, const double *a, const double *b,
                                      bool mirror, bool *mirrored);

#endif
