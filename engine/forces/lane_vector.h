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

/* The words of laws (scene/laws/words.h), of which one text each is compiled below. */
STRUT_DEFINE_LAW_WORDS(STRUT_LANE_INLINE, lane)
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

#define LAW(name) lane_##name
#define LAW_INLINE STRUT_LANE_INLINE
#include "engine/forces/strains/direction.h"
#include "engine/scene/laws/friction.h"
#include "engine/scene/laws/ground.h"
#include "engine/scene/laws/member.h"
#include "engine/scene/laws/runge_kutta.h"
#undef LAW
#undef LAW_INLINE

#endif
