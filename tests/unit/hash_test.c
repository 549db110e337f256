/* SPDX-License-Identifier: GPL-3.0-or-later */
/* XXH64 against published values. */
#include "engine/base/checksum.h"
#include "tests/support/check.h"

/* From the sanity check of xxHash itself: its buffer of 2222 bytes, and values for some lengths. */
TEST(checksum) {
  static const uint64_t seed = 2654435761U;
  static const struct {
    size_t length;
    uint64_t plain, seeded;
  } cases[] = {{0, 0xEF46DB3751D8E999, 0xAC75FDA2929B17EF},
               {1, 0xE934A84ADB052768, 0x5014607643A9B4C3},
               {14, 0x8282DCC4994E35C8, 0xC3BD6BF63DEB6DF0},
               {222, 0xB641AE8CB691C174, 0x20CB8AB7AE10C14A}};
  uint8_t bytes[2222];
  uint64_t generator = 2654435761U;
  for (size_t i = 0; i < sizeof bytes; i++) {
    bytes[i] = (uint8_t)(generator >> 56);
    generator *= 11400714785074694797U;
  }
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    assert_true(strut_checksum(bytes, cases[i].length, 0) == cases[i].plain);
    assert_true(strut_checksum(bytes, cases[i].length, seed) == cases[i].seeded);
  }
  assert_true(strut_checksum("abc", 3, 0) == 0x44BC2CF5AD770999);
}
