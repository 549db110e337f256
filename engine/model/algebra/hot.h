/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Marks and vector types for code of the step loop.
 *
 * STRUT_CLONES compiles a function for wider vector registers too and picks at run time. Products
 * and sums are never fused (-ffp-contract=off), so every clone gives the same bits. Give it to local
 * functions only, each with a name of its own: clang names the clones of a public one otherwise than
 * gcc, and makes those of equal names in two files collide.
 */
#pragma once

#include <math.h>

#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(STRUT_NO_CLONES) &&                  \
    !defined(__AVX2__) && defined(__OPTIMIZE__)
#define STRUT_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define STRUT_CLONES
#endif
/** Is a strut_lanes one register, or are there clones, of which processors of today take that for which it is one? */
#if defined(__x86_64__)
#define STRUT_WIDE_REGISTERS true
#else
#define STRUT_WIDE_REGISTERS false
#endif
#define STRUT_INLINE static inline __attribute__((always_inline))
/**
 * Of a loop over everything: a copy of its own in each kernel. In WebAssembly a function of its own: what compiles that
 * keeps numbers of long functions in memory, and a page has to be loaded.
 */
#ifdef __wasm__
#define STRUT_LOOP static __attribute__((noinline, unused))
#else
#define STRUT_LOOP STRUT_INLINE
#endif

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
STRUT_INLINE strut_lanes strut_lanes_join(const double *first, const double *second) {
  return __builtin_shufflevector(strut_pair_load(first), strut_pair_load(second), 0, 1, 2, 3);
}
/** Lanes from two halves, for values just stored pair by pair: a wider load would have to wait. */
STRUT_INLINE strut_lanes strut_lanes_load_pairs(const double *p) {
  return strut_lanes_join(p, p + 2);
}
STRUT_INLINE void strut_lanes_store(double *p, strut_lanes x) { *(strut_lanes_at *)p = x; }

/**
 * Defines the words of laws (scene/laws/words.h) for PREFIX_real, a vector of doubles, and PREFIX_mask, one of
 * integers of the same size: every bit of a number for which it holds. `inlined`: what the functions are.
 */
#define STRUT_DEFINE_LAW_WORDS(inlined, PREFIX)                                                    \
  inlined PREFIX##_real PREFIX##_all(double x) { return (PREFIX##_real){0} + x; }                  \
  inlined PREFIX##_mask PREFIX##_less(PREFIX##_real a, PREFIX##_real b) { return a < b; }          \
  inlined PREFIX##_mask PREFIX##_at_least(PREFIX##_real a, PREFIX##_real b) { return a >= b; }     \
  inlined PREFIX##_mask PREFIX##_both(PREFIX##_mask m, PREFIX##_mask n) { return m & n; }          \
  inlined PREFIX##_mask PREFIX##_either(PREFIX##_mask m, PREFIX##_mask n) { return m | n; }        \
  inlined PREFIX##_real PREFIX##_choose(PREFIX##_mask m, PREFIX##_real a, PREFIX##_real b) {       \
    return (PREFIX##_real)((m & (PREFIX##_mask)a) | (~m & (PREFIX##_mask)b));                      \
  }                                                                                                \
  inlined PREFIX##_real PREFIX##_keep(PREFIX##_mask m, PREFIX##_real a) {                          \
    return (PREFIX##_real)(m & (PREFIX##_mask)a);                                                  \
  }                                                                                                \
  inlined PREFIX##_real PREFIX##_add_where(PREFIX##_mask m, PREFIX##_real sum, PREFIX##_real a) {  \
    return PREFIX##_choose(m, sum + a, sum);                                                       \
  }                                                                                                \
  inlined PREFIX##_real PREFIX##_magnitude(PREFIX##_real a) {                                      \
    return (PREFIX##_real)((PREFIX##_mask)a & 0x7fffffffffffffffLL);                               \
  }                                                                                                \
  inlined PREFIX##_real PREFIX##_whole(PREFIX##_real a) {                                          \
    const double rounder = 6755399441055744.0; /* of such numbers units are the last bits */       \
    return (a + rounder) - rounder;                                                                \
  }                                                                                                \
  inlined PREFIX##_real PREFIX##_against(PREFIX##_real a, PREFIX##_real b) {                       \
    PREFIX##_real zero = {0}, one = zero + 1.0;                                                    \
    return a * PREFIX##_choose(b > zero, -one, PREFIX##_choose(b < zero, one, -zero));             \
  }

/* Four doubles side by side. */
typedef strut_lanes four_real;
typedef strut_lane_mask four_mask;
STRUT_DEFINE_LAW_WORDS(STRUT_INLINE, four)
STRUT_INLINE four_real four_root(four_real a) {
  return (four_real){sqrt(a[0]), sqrt(a[1]), sqrt(a[2]), sqrt(a[3])};
}
