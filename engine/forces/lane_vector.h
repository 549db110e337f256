/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: numbers of several models at once, one model in each lane of a vector register.
 *
 * A row of lanes is one vector register or two parts, where registers are narrower: more is under way then,
 * and indices are found once for both. A file includes this once, and before that may define
 * STRUT_LANE_WIDTH, STRUT_LANE_PARTS and the functions' STRUT_LANE_TARGET.
 */
#ifndef STRUT_ENGINE_FORCES_LANE_VECTOR_H
#define STRUT_ENGINE_FORCES_LANE_VECTOR_H

#include <math.h>

#include "engine/base/trig.h"
#include "engine/base/vec.h"
#include "engine/forces/lane_tables.h"
#include "engine/model/hot.h"
#include "engine/model/mass.h"

#ifndef STRUT_LANE_WIDTH
#define STRUT_LANE_WIDTH 2
#endif
#ifndef STRUT_LANE_PARTS
#define STRUT_LANE_PARTS 1
#endif
#ifndef STRUT_LANE_TARGET
#define STRUT_LANE_TARGET
#endif
#define STRUT_LANE_INLINE static inline __attribute__((always_inline)) STRUT_LANE_TARGET

enum {
  LANE_ROW = STRUT_LANE_WIDTH,
  LANE_PARTS = STRUT_LANE_PARTS,
  LANE_WIDTH = LANE_ROW / LANE_PARTS
};

/* The statement for each part p of a row; p is a constant. */
#define LANE_EACH(statement)                                                                       \
  do {                                                                                             \
    {                                                                                              \
      enum { p = 0 };                                                                              \
      statement;                                                                                   \
    }                                                                                              \
    if (LANE_PARTS > 1) {                                                                          \
      enum { p = LANE_PARTS - 1 };                                                                 \
      statement;                                                                                   \
    }                                                                                              \
  } while (0)

/* One number of each lane of a part; arrays of them are aligned to whole vectors. */
typedef double lane_real __attribute__((vector_size(8 * STRUT_LANE_WIDTH / STRUT_LANE_PARTS)));
typedef long long lane_mask __attribute__((vector_size(8 * STRUT_LANE_WIDTH / STRUT_LANE_PARTS)));

STRUT_LANE_INLINE lane_real lane_load(const double *x) { return *(const lane_real *)x; }
STRUT_LANE_INLINE void lane_store(double *to, lane_real x) { *(lane_real *)to = x; }
/* Part p of row i of a table. */
STRUT_LANE_INLINE lane_real lane_row(const double *table, size_t i, int p) {
  return lane_load(table + i * LANE_ROW + p * LANE_WIDTH);
}
STRUT_LANE_INLINE void lane_put(double *table, size_t i, int p, lane_real x) {
  lane_store(table + i * LANE_ROW + p * LANE_WIDTH, x);
}

/* mask ? x : y */
STRUT_LANE_INLINE lane_real lane_choose(lane_mask mask, lane_real x, lane_real y) {
  return (lane_real)((mask & (lane_mask)x) | (~mask & (lane_mask)y));
}
/* x in the lanes of the mask, 0 in others. */
STRUT_LANE_INLINE lane_real lane_keep(lane_mask mask, lane_real x) {
  return (lane_real)(mask & (lane_mask)x);
}
STRUT_LANE_INLINE lane_real lane_magnitude(lane_real x) {
  return (lane_real)((lane_mask)x & 0x7fffffffffffffffLL);
}
STRUT_LANE_INLINE bool lane_some(lane_mask mask) {
#if defined(__x86_64__) && STRUT_LANE_WIDTH == 8 && STRUT_LANE_PARTS == 1
  return __builtin_ia32_cvtq2mask512(mask) != 0;
#elif defined(__x86_64__) && STRUT_LANE_WIDTH == 4 * STRUT_LANE_PARTS
  return __builtin_ia32_movmskpd256((lane_real)mask) != 0;
#else
  long long any = 0;
  for (int l = 0; l < LANE_WIDTH; l++) any |= mask[l];
  return any != 0;
#endif
}
STRUT_LANE_INLINE lane_real lane_root(lane_real x) {
  lane_real root;
  for (int l = 0; l < LANE_WIDTH; l++) root[l] = sqrt(x[l]);
  return root;
}

/* The other words of laws (scene/laws/words.h), of which one text each is compiled here. */
STRUT_LANE_INLINE lane_real lane_all(double x) { return (lane_real){0} + x; }
STRUT_LANE_INLINE lane_mask lane_less(lane_real a, lane_real b) { return a < b; }
STRUT_LANE_INLINE lane_mask lane_at_least(lane_real a, lane_real b) { return a >= b; }
STRUT_LANE_INLINE lane_mask lane_both(lane_mask m, lane_mask n) { return m & n; }
STRUT_LANE_INLINE lane_mask lane_either(lane_mask m, lane_mask n) { return m | n; }
STRUT_LANE_INLINE lane_real lane_add_where(lane_mask m, lane_real sum, lane_real a) {
  return lane_choose(m, sum + a, sum);
}
STRUT_LANE_INLINE lane_real lane_whole(lane_real a) {
  const double rounder = 6755399441055744.0;
  return (a + rounder) - rounder;
}
STRUT_LANE_INLINE lane_real lane_times_sign(lane_real a, lane_real b) {
  lane_real zero = {0}, one = lane_all(1.0);
  return a * lane_choose(b > zero, one, lane_choose(b < zero, -one, zero));
}

#define LAW(name) lane_##name
#define LAW_INLINE STRUT_LANE_INLINE
#include "engine/scene/laws/friction.h"
#include "engine/scene/laws/ground.h"
#include "engine/scene/laws/member.h"
#include "engine/forces/strains/direction.h"
#undef LAW
#undef LAW_INLINE

#endif
