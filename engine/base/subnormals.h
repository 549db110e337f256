/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Numbers below 2.3e-308 count as zero between these two calls, on processors that are slow with
 * them (x86: 100 cycles and more for each). Other results keep their bits. The mode is the thread's:
 * no one else's code may run in between.
 */
#ifndef STRUT_ENGINE_BASE_SUBNORMALS_H
#define STRUT_ENGINE_BASE_SUBNORMALS_H

#if defined(__SSE2__)
#include <xmmintrin.h>

/** The mode, for strut_subnormals_restore in another thread. */
static inline unsigned strut_subnormals_mode(void) { return _mm_getcsr(); }

/** The mode before, for strut_subnormals_restore. */
static inline unsigned strut_subnormals_off(void) {
  unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040u); /* results are flushed to zero, operands are taken as zero */
  return before;
}

/** Only the two bits of it: exceptions that were raised in between stay raised. */
static inline void strut_subnormals_restore(unsigned before) {
  _mm_setcsr((_mm_getcsr() & ~0x8040u) | (before & 0x8040u));
}

#else

static inline unsigned strut_subnormals_mode(void) { return 0; }
static inline unsigned strut_subnormals_off(void) { return 0; }
static inline void strut_subnormals_restore(unsigned before) { (void)before; }

#endif
#endif
