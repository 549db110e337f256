/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/checksum.h"

static const uint64_t PRIME_1 = 0x9E3779B185EBCA87, PRIME_2 = 0xC2B2AE3D27D4EB4F,
                      PRIME_3 = 0x165667B19E3779F9, PRIME_4 = 0x85EBCA77C2B2AE63,
                      PRIME_5 = 0x27D4EB2F165667C5;

/* Bytes are little-endian numbers; compilers make one load of this. */
static uint32_t load_32(const uint8_t *at) {
  return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static uint64_t load_64(const uint8_t *at) { return load_32(at) | (uint64_t)load_32(at + 4) << 32; }

static uint64_t rotate_left(uint64_t x, int left) { return x << left | x >> (64 - left); }

static uint64_t stir(uint64_t lane, uint64_t input) {
  return rotate_left(lane + input * PRIME_2, 31) * PRIME_1;
}

static uint64_t join(uint64_t sum, uint64_t lane) {
  return (sum ^ stir(0, lane)) * PRIME_1 + PRIME_4;
}

/* Hashes the remaining bytes, fewer than 32, and mixes for the last time. */
static uint64_t finish(uint64_t sum, const uint8_t *at, size_t left) {
  for (; left >= 8; left -= 8, at += 8)
    sum = rotate_left(sum ^ stir(0, load_64(at)), 27) * PRIME_1 + PRIME_4;
  if (left >= 4) {
    sum = rotate_left(sum ^ load_32(at) * PRIME_1, 23) * PRIME_2 + PRIME_3;
    left -= 4;
    at += 4;
  }
  for (; left > 0; left--, at++) sum = rotate_left(sum ^ *at * PRIME_5, 11) * PRIME_1;
  sum = (sum ^ sum >> 33) * PRIME_2;
  sum = (sum ^ sum >> 29) * PRIME_3;
  return sum ^ sum >> 32;
}

uint64_t strut_checksum(const void *bytes, size_t length, uint64_t seed) {
  const uint8_t *at = bytes;
  size_t left = length;
  uint64_t sum = seed + PRIME_5;
  if (left >= 32) {
    uint64_t a = seed + PRIME_1 + PRIME_2, b = seed + PRIME_2, c = seed, d = seed - PRIME_1;
    for (; left >= 32; left -= 32, at += 32) {
      a = stir(a, load_64(at));
      b = stir(b, load_64(at + 8));
      c = stir(c, load_64(at + 16));
      d = stir(d, load_64(at + 24));
    }
    sum = rotate_left(a, 1) + rotate_left(b, 7) + rotate_left(c, 12) + rotate_left(d, 18);
    sum = join(join(join(join(sum, a), b), c), d);
  }
  return finish(sum + length, at, left);
}
