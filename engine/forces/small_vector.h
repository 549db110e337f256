/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: vectors for the kernel of small models. A number of each node is a row: one register of 8 lanes
 * (AVX-512) or two of 4 (AVX2). A number of each member is a register of 8 and one of 4, or three of 4.
 *
 * A file defines STRUT_SMALL_WIDTH, 8 (as by default) or 4, and includes this once, on x86-64 only.
 */
#ifndef STRUT_ENGINE_FORCES_SMALL_VECTOR_H
#define STRUT_ENGINE_FORCES_SMALL_VECTOR_H

#include <immintrin.h>

#include "engine/model/hot.h"
#include "engine/model/small_model.h"

#ifndef STRUT_SMALL_WIDTH
#define STRUT_SMALL_WIDTH 8
#endif
#if STRUT_SMALL_WIDTH == 8
#define STRUT_SMALL_TARGET __attribute__((target("avx512f,avx512dq,avx512vl")))
#else
#define STRUT_SMALL_TARGET __attribute__((target("avx2")))
#endif
#define STRUT_SMALL_INLINE static inline __attribute__((always_inline)) STRUT_SMALL_TARGET

enum { SMALL_WIDTH = STRUT_SMALL_WIDTH, SMALL_PARTS = STRUT_SMALL_NODES / STRUT_SMALL_WIDTH };

/*
 * The compiler forgets what it has read of p: of tables that stay the same it would else hold so many rows in
 * registers that the motion has to leave them.
 */
#define SMALL_READS_AGAIN(p) __asm__ volatile("" : "+r"(p))

/* For each part p of a row. */
#define SMALL_EACH(p) _Pragma("GCC unroll 2") for (int p = 0; p < SMALL_PARTS; p++)

typedef double small_real __attribute__((vector_size(8 * STRUT_SMALL_WIDTH)));
typedef long long small_bits __attribute__((vector_size(8 * STRUT_SMALL_WIDTH)));
typedef double small_real_at __attribute__((vector_size(8 * STRUT_SMALL_WIDTH), aligned(8)));
typedef long long small_bits_at __attribute__((vector_size(8 * STRUT_SMALL_WIDTH), aligned(8)));

/* A number of each node. */
typedef struct small_row {
  small_real part[SMALL_PARTS];
} small_row;
/* Positions, velocities, forces or accelerations of all nodes. */
typedef struct small_points {
  small_row x, y;
} small_points;

STRUT_SMALL_INLINE small_real small_load(const double *p) { return *(const small_real_at *)p; }
STRUT_SMALL_INLINE void small_store(double *p, small_real x) { *(small_real_at *)p = x; }
STRUT_SMALL_INLINE small_bits small_bits_load(const int64_t *p) {
  return *(const small_bits_at *)p;
}
STRUT_SMALL_INLINE strut_lanes small4_load(const double *p) { return *(const strut_lanes_at *)p; }
STRUT_SMALL_INLINE void small4_store(double *p, strut_lanes x) { *(strut_lanes_at *)p = x; }
STRUT_SMALL_INLINE small_real small_all(double x) {
#if STRUT_SMALL_WIDTH == 8
  return _mm512_set1_pd(x);
#else
  return _mm256_set1_pd(x);
#endif
}
STRUT_SMALL_INLINE small_real small_magnitude(small_real x) {
  return (small_real)((small_bits)x & INT64_MAX);
}
STRUT_SMALL_INLINE small_real small_flip(small_real x, small_bits sign) {
  return (small_real)((small_bits)x ^ sign);
}

/* Masks: in registers of their own, or of whole lanes. */
#if STRUT_SMALL_WIDTH == 8
typedef __mmask8 small_mask;
STRUT_SMALL_INLINE small_mask small_mask_load(const int64_t *p) {
  return _mm512_movepi64_mask((__m512i)small_bits_load(p));
}
STRUT_SMALL_INLINE small_mask small_less(small_real a, small_real b) {
  return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ);
}
STRUT_SMALL_INLINE small_mask small_at_least(small_real a, small_real b) {
  return _mm512_cmp_pd_mask(a, b, _CMP_GE_OQ);
}
STRUT_SMALL_INLINE small_real small_keep(small_mask mask, small_real x) {
  return _mm512_maskz_mov_pd(mask, x);
}
STRUT_SMALL_INLINE small_real small_choose(small_mask mask, small_real x, small_real y) {
  return _mm512_mask_mov_pd(y, mask, x);
}
STRUT_SMALL_INLINE small_real small_add_where(small_mask mask, small_real sum, small_real x) {
  return _mm512_mask_add_pd(sum, mask, sum, x);
}
STRUT_SMALL_INLINE small_real small_root(small_real x) { return _mm512_sqrt_pd(x); }
/* Bit p * SMALL_WIDTH and up: the lanes of part p in which the mask is set. */
STRUT_SMALL_INLINE unsigned small_set_bits(small_mask mask) { return mask; }
#else
typedef small_bits small_mask;
STRUT_SMALL_INLINE small_mask small_mask_load(const int64_t *p) { return small_bits_load(p); }
STRUT_SMALL_INLINE small_mask small_less(small_real a, small_real b) { return a < b; }
STRUT_SMALL_INLINE small_mask small_at_least(small_real a, small_real b) { return a >= b; }
STRUT_SMALL_INLINE small_real small_keep(small_mask mask, small_real x) {
  return (small_real)(mask & (small_bits)x);
}
STRUT_SMALL_INLINE small_real small_choose(small_mask mask, small_real x, small_real y) {
  return _mm256_blendv_pd(y, x, (small_real)mask);
}
STRUT_SMALL_INLINE small_real small_add_where(small_mask mask, small_real sum, small_real x) {
  return small_choose(mask, sum + x, sum);
}
STRUT_SMALL_INLINE small_real small_root(small_real x) { return _mm256_sqrt_pd(x); }
STRUT_SMALL_INLINE unsigned small_set_bits(small_mask mask) {
  return (unsigned)_mm256_movemask_pd((small_real)mask);
}
#endif

STRUT_SMALL_INLINE small_row small_row_load(const double *p) {
  small_row x;
  SMALL_EACH(k) x.part[k] = small_load(p + k * SMALL_WIDTH);
  return x;
}
STRUT_SMALL_INLINE void small_row_store(double *p, small_row x) {
  SMALL_EACH(k) small_store(p + k * SMALL_WIDTH, x.part[k]);
}
/* The other words of laws (scene/laws/words.h), of which one text each is compiled here. */
STRUT_SMALL_INLINE small_mask small_both(small_mask m, small_mask n) { return m & n; }
STRUT_SMALL_INLINE small_mask small_either(small_mask m, small_mask n) { return m | n; }
STRUT_SMALL_INLINE bool small_some(small_mask m) { return small_set_bits(m) != 0; }
STRUT_SMALL_INLINE small_real small_against(small_real x, small_real y) {
  small_real zero = {0};
  small_real flipped = small_flip(x, ~(small_bits)y & INT64_MIN);
  return small_choose(small_less(zero, small_magnitude(y)), flipped, x * -0.0);
}

/* Members come in groups of four, too. */
typedef strut_lanes small4_real;
typedef strut_lane_mask small4_mask;
STRUT_DEFINE_LAW_WORDS(STRUT_SMALL_INLINE, small4)
#define LAW(name) small4_##name
#define LAW_INLINE STRUT_SMALL_INLINE
#include "engine/scene/laws/member.h"
#undef LAW
#undef LAW_INLINE

#define LAW(name) small_##name
#define LAW_INLINE STRUT_SMALL_INLINE
#include "engine/scene/laws/friction.h"
#include "engine/scene/laws/ground.h"
#include "engine/scene/laws/member.h"
#include "engine/scene/laws/runge_kutta.h"
#undef LAW
#undef LAW_INLINE

/* What members pull with. */
typedef struct small_pulls {
#if STRUT_SMALL_WIDTH == 8
  small_real first;
  strut_lanes last;
#else
  strut_lanes part[3];
#endif
} small_pulls;

STRUT_SMALL_INLINE strut_lanes small_root_of_4(strut_lanes x) { return _mm256_sqrt_pd(x); }

#endif
