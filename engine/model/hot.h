/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Marks and vector types for code of the step loop.
 *
 * STRUT_CLONES compiles a function for wider vector registers too and picks at run time. Products
 * and sums are never fused (-ffp-contract=off), so every clone gives the same bits. Give it to local
 * functions only, each with a name of its own: clang names the clones of a public one otherwise than
 * gcc, and makes those of equal names in two files collide.
 */
#ifndef STRUT_ENGINE_MODEL_HOT_H
#define STRUT_ENGINE_MODEL_HOT_H

#include <math.h>
#include <stdbool.h>

#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(STRUT_NO_CLONES) &&                  \
    !defined(__AVX2__) && defined(__OPTIMIZE__)
#define STRUT_CLONES __attribute__((target_clones("avx2", "default")))
/** Is a strut_lanes one register in the clone that runs here? */
#define STRUT_WIDE_REGISTERS __builtin_cpu_supports("avx2")
#else
#define STRUT_CLONES
#ifdef __AVX2__
#define STRUT_WIDE_REGISTERS 1
#else
#define STRUT_WIDE_REGISTERS 0
#endif
#endif
#define STRUT_INLINE static inline __attribute__((always_inline))

/* No function with a vector in its signature is ever called: all of them are inlined. */
#pragma GCC diagnostic ignored "-Wpsabi"

/** Four doubles that are computed alike; the compiler splits them where registers are narrower. */
typedef double strut_lanes __attribute__((vector_size(32)));
typedef long long strut_lane_mask __attribute__((vector_size(32)));
/** The x and y of one node. */
typedef double strut_pair __attribute__((vector_size(16)));

/* The same at the alignment of a double; they alias doubles, and nothing else. */
typedef double strut_pair_at __attribute__((vector_size(16), aligned(8)));
typedef double strut_lanes_at __attribute__((vector_size(32), aligned(8)));

STRUT_INLINE strut_pair strut_pair_load(const double *p) { return *(const strut_pair_at *)p; }
STRUT_INLINE void strut_pair_store(double *p, strut_pair x) { *(strut_pair_at *)p = x; }
STRUT_INLINE strut_lanes strut_lanes_load(const double *p) { return *(const strut_lanes_at *)p; }
/** Two pairs side by side. */
STRUT_INLINE strut_lanes strut_lanes_join(const double *a, const double *b) {
  return __builtin_shufflevector(strut_pair_load(a), strut_pair_load(b), 0, 1, 2, 3);
}
/** Lanes from two halves, for values just stored pair by pair: a wider load would have to wait. */
STRUT_INLINE strut_lanes strut_lanes_load_pairs(const double *p) {
  return strut_lanes_join(p, p + 2);
}
STRUT_INLINE void strut_lanes_store(double *p, strut_lanes x) { *(strut_lanes_at *)p = x; }

/*
 * The words of laws (scene/laws/words.h) for four doubles side by side.
 */
typedef strut_lanes four_real;
typedef strut_lane_mask four_mask;
STRUT_INLINE four_real four_all(double x) { return (four_real){x, x, x, x}; }
STRUT_INLINE four_mask four_less(four_real a, four_real b) { return a < b; }
STRUT_INLINE four_mask four_at_least(four_real a, four_real b) { return a >= b; }
STRUT_INLINE four_mask four_both(four_mask m, four_mask n) { return m & n; }
STRUT_INLINE four_mask four_either(four_mask m, four_mask n) { return m | n; }
STRUT_INLINE bool four_some(four_mask m) { return (m[0] | m[1] | m[2] | m[3]) != 0; }
STRUT_INLINE four_real four_choose(four_mask m, four_real a, four_real b) {
  return (four_real)((m & (four_mask)a) | (~m & (four_mask)b));
}
STRUT_INLINE four_real four_keep(four_mask m, four_real a) {
  return (four_real)(m & (four_mask)a);
}
STRUT_INLINE four_real four_add_where(four_mask m, four_real sum, four_real a) {
  return four_choose(m, sum + a, sum);
}
STRUT_INLINE four_real four_magnitude(four_real a) {
  return (four_real)((four_mask)a & 0x7fffffffffffffffLL);
}
STRUT_INLINE four_real four_root(four_real a) {
  return (four_real){sqrt(a[0]), sqrt(a[1]), sqrt(a[2]), sqrt(a[3])};
}
STRUT_INLINE four_real four_whole(four_real a) {
  const double rounder = 6755399441055744.0;
  return (a + rounder) - rounder;
}
STRUT_INLINE four_real four_times_sign(four_real a, four_real b) {
  four_real zero = {0}, one = four_all(1.0);
  return a * four_choose(b > zero, one, four_choose(b < zero, -one, zero));
}

#endif
