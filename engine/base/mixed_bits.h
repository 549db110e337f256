/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Numbers that look random, from an index. */
#pragma once

#include <stdint.h>

/** Bits that look random: the last steps of SplitMix64. */
static inline uint64_t strut_mix_bits(uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/** The next number from 0 to below 1 after a state, by Vigna's splitmix64: any state does. */
static inline double strut_draw_uniform(uint64_t *state) {
  return (double)(strut_mix_bits(*state += 0x9e3779b97f4a7c15u) >> 11) * 0x1p-53;
}

/** -1 to 1, from an index: entries of a vector that leans on no motion. */
static inline double strut_stirred(uint64_t i) {
  return (double)(strut_mix_bits((i + 1) * 0x9e3779b97f4a7c15u) >> 11) * 0x1p-52 - 1.0;
}
