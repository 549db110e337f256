/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Random numbers that are the same on every machine, random_scale to rounding (splitmix64).
 */
#pragma once

#include <math.h>
#include <stdint.h>

/** The state is any number; the seed. */
static inline uint64_t random_bits(uint64_t *state) {
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/** In [low, high). */
static inline double random_between(uint64_t *state, double low, double high) {
  return low + (high - low) * ((double)(random_bits(state) >> 11) * 0x1p-53);
}

/** In [low, high), evenly in the logarithm. */
static inline double random_scale(uint64_t *state, double low, double high) {
  return exp(random_between(state, log(low), log(high)));
}

/** In 0 .. count - 1. */
static inline int32_t random_below(uint64_t *state, int32_t count) {
  return (int32_t)(random_bits(state) % (uint64_t)count);
}

/** True once in `times`. */
static inline int random_once_in(uint64_t *state, int32_t times) {
  return random_below(state, times) == 0;
}
