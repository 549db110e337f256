/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/checksum.h"

#include <string.h>

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

static const uint32_t constants[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

static uint32_t rotate_right(uint32_t x, int right) { return x >> right | x << (32 - right); }

/* The message schedule: a block's 16 words and what follows from them. */
static void fill_words(const uint8_t *block, uint32_t w[64]) {
  for (int i = 0; i < 16; i++)
    w[i] = (uint32_t)block[4 * i] << 24 | (uint32_t)block[4 * i + 1] << 16 |
           (uint32_t)block[4 * i + 2] << 8 | (uint32_t)block[4 * i + 3];
  for (int i = 16; i < 64; i++) {
    uint32_t near = rotate_right(w[i - 15], 7) ^ rotate_right(w[i - 15], 18) ^ w[i - 15] >> 3;
    uint32_t far = rotate_right(w[i - 2], 17) ^ rotate_right(w[i - 2], 19) ^ w[i - 2] >> 10;
    w[i] = w[i - 16] + near + w[i - 7] + far;
  }
}

static void take_block(uint32_t state[8], const uint8_t *block) {
  uint32_t w[64], s[8];
  fill_words(block, w);
  memcpy(s, state, sizeof s);
  for (int i = 0; i < 64; i++) {
    uint32_t choice = (s[4] & s[5]) ^ (~s[4] & s[6]);
    uint32_t majority = (s[0] & s[1]) ^ (s[0] & s[2]) ^ (s[1] & s[2]);
    uint32_t a = s[7] + (rotate_right(s[4], 6) ^ rotate_right(s[4], 11) ^ rotate_right(s[4], 25)) +
                 choice + constants[i] + w[i];
    uint32_t b =
        (rotate_right(s[0], 2) ^ rotate_right(s[0], 13) ^ rotate_right(s[0], 22)) + majority;
    memmove(s + 1, s, 7 * sizeof *s);
    s[4] += a;
    s[0] = a + b;
  }
  for (int i = 0; i < 8; i++) state[i] += s[i];
}

void strut_sha256_begin(strut_sha256 *hash) {
  *hash = (strut_sha256){.state = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f,
                                   0x9b05688c, 0x1f83d9ab, 0x5be0cd19}};
}

void strut_sha256_add(strut_sha256 *hash, const void *bytes, size_t length) {
  const uint8_t *from = bytes;
  while (length > 0) {
    size_t used = (size_t)(hash->length % STRUT_SHA256_BLOCK);
    size_t part = STRUT_SHA256_BLOCK - used;
    if (part > length) part = length;
    memcpy(hash->block + used, from, part);
    hash->length += part;
    from += part;
    length -= part;
    if (used + part == STRUT_SHA256_BLOCK) take_block(hash->state, hash->block);
  }
}

void strut_sha256_add_text(strut_sha256 *hash, const char *text) {
  strut_sha256_add(hash, text, strlen(text) + 1);
}

void strut_sha256_end(strut_sha256 *hash, uint8_t digest[STRUT_SHA256_BYTES]) {
  static const uint8_t padding[STRUT_SHA256_BLOCK] = {0x80};
  uint64_t bits = 8 * hash->length;
  size_t used = (size_t)(hash->length % STRUT_SHA256_BLOCK);
  uint8_t tail[8];
  for (int i = 0; i < 8; i++) tail[i] = (uint8_t)(bits >> (56 - 8 * i));
  strut_sha256_add(hash, padding, used < 56 ? 56 - used : 120 - used);
  strut_sha256_add(hash, tail, sizeof tail);
  for (int i = 0; i < STRUT_SHA256_BYTES; i++)
    digest[i] = (uint8_t)(hash->state[i / 4] >> (24 - 8 * (i % 4)));
}
