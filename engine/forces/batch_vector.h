/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: numbers of several models at once, one model in each lane of a vector register.
 *
 * A row of lanes is one vector register or two parts, where registers are narrower: more is under way then,
 * and indices are found once for both. A file includes this once, and before that may define
 * STRUT_BATCH_WIDTH, STRUT_BATCH_PARTS and the functions' STRUT_BATCH_TARGET.
 */
#ifndef STRUT_ENGINE_FORCES_BATCH_VECTOR_H
#define STRUT_ENGINE_FORCES_BATCH_VECTOR_H

#include <math.h>

#include "engine/base/vec.h"
#include "engine/forces/batch_tables.h"
#include "engine/model/hot.h"
#include "engine/model/mass.h"

#ifndef STRUT_BATCH_WIDTH
#define STRUT_BATCH_WIDTH 2
#endif
#ifndef STRUT_BATCH_PARTS
#define STRUT_BATCH_PARTS 1
#endif
#ifndef STRUT_BATCH_TARGET
#define STRUT_BATCH_TARGET
#endif
#define STRUT_BATCH_INLINE static inline __attribute__((always_inline)) STRUT_BATCH_TARGET

enum {
  BATCH_ROW = STRUT_BATCH_WIDTH,
  BATCH_PARTS = STRUT_BATCH_PARTS,
  BATCH_WIDTH = BATCH_ROW / BATCH_PARTS
};

/* The statement for each part p of a row; p is a constant. */
#define BATCH_EACH(statement)                                                                      \
  do {                                                                                             \
    {                                                                                              \
      enum { p = 0 };                                                                              \
      statement;                                                                                   \
    }                                                                                              \
    if (BATCH_PARTS > 1) {                                                                         \
      enum { p = BATCH_PARTS - 1 };                                                                \
      statement;                                                                                   \
    }                                                                                              \
  } while (0)

/* One number of each lane of a part; arrays of them are aligned to whole vectors. */
typedef double batch_real __attribute__((vector_size(8 * STRUT_BATCH_WIDTH / STRUT_BATCH_PARTS)));
typedef long long batch_mask
    __attribute__((vector_size(8 * STRUT_BATCH_WIDTH / STRUT_BATCH_PARTS)));

STRUT_BATCH_INLINE batch_real batch_load(const double *x) { return *(const batch_real *)x; }
STRUT_BATCH_INLINE void batch_store(double *to, batch_real x) { *(batch_real *)to = x; }
/* Part p of row i of a table. */
STRUT_BATCH_INLINE batch_real batch_row(const double *table, size_t i, int p) {
  return batch_load(table + i * BATCH_ROW + p * BATCH_WIDTH);
}
STRUT_BATCH_INLINE void batch_put(double *table, size_t i, int p, batch_real x) {
  batch_store(table + i * BATCH_ROW + p * BATCH_WIDTH, x);
}

/* The words of laws (scene/laws/words.h), of which one text each is compiled below. */
STRUT_DEFINE_LAW_WORDS(STRUT_BATCH_INLINE, batch)
STRUT_BATCH_INLINE bool batch_some(batch_mask mask) {
#if defined(__x86_64__) && STRUT_BATCH_WIDTH == 8 && STRUT_BATCH_PARTS == 1
  return __builtin_ia32_cvtq2mask512(mask) != 0;
#elif defined(__x86_64__) && STRUT_BATCH_WIDTH == 4 * STRUT_BATCH_PARTS
  return __builtin_ia32_movmskpd256((batch_real)mask) != 0;
#else
  long long any = 0;
  for (int l = 0; l < BATCH_WIDTH; l++) any |= mask[l];
  return any != 0;
#endif
}
STRUT_BATCH_INLINE batch_real batch_root(batch_real x) {
  batch_real root;
  for (int l = 0; l < BATCH_WIDTH; l++) root[l] = sqrt(x[l]);
  return root;
}

#define LAW(name) batch_##name
#define LAW_INLINE STRUT_BATCH_INLINE
#include "engine/forces/strains/direction.h"
#include "engine/scene/laws/friction.h"
#include "engine/scene/laws/ground.h"
#include "engine/scene/laws/member.h"
#include "engine/scene/laws/runge_kutta.h"
#undef LAW
#undef LAW_INLINE

#endif
