/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A fast checksum of 64 bits, the published XXH64: tells a record that is whole from one that is
 * not, at a cost of some 0.1 ns a byte. Not meant against people who mean harm.
 */
#ifndef STRUT_ENGINE_BASE_CHECKSUM_H
#define STRUT_ENGINE_BASE_CHECKSUM_H

#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"

/** XXH64 of the bytes with a seed; the same on every machine. */
STRUT_API uint64_t strut_checksum(const void *bytes, size_t length, uint64_t seed);

/* SHA-256 (FIPS 180-4): names that two different contents never share. */

enum { STRUT_SHA256_BYTES = 32, STRUT_SHA256_BLOCK = 64 };

/** Bytes on the way. Made by strut_sha256_begin. */
typedef struct strut_sha256 {
  uint32_t state[8];
  uint64_t length; /* of all bytes so far */
  uint8_t block[STRUT_SHA256_BLOCK];
} strut_sha256;

void strut_sha256_begin(strut_sha256 *hash);
void strut_sha256_add(strut_sha256 *hash, const void *bytes, size_t length);
/** A text with the NUL at its end, so that "ab" "c" differs from "a" "bc". */
void strut_sha256_add_text(strut_sha256 *hash, const char *text);
/** The hash is of no use afterwards. */
void strut_sha256_end(strut_sha256 *hash, uint8_t digest[STRUT_SHA256_BYTES]);

#endif
