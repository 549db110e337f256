/* SPDX-License-Identifier: GPL-3.0-or-later */
/* SHA-256 and XXH64 against published values. */
#include <stdio.h>
#include <string.h>

#include "engine/base/checksum.h"
#include "tests/support/check.h"

static void digest_of(const char *text, size_t length, size_t part, size_t times, char hex[65]) {
  strut_sha256 hash;
  uint8_t digest[STRUT_SHA256_BYTES];
  strut_sha256_begin(&hash);
  for (size_t i = 0; i < times; i++)
    for (size_t k = 0; k < length; k += part)
      strut_sha256_add(&hash, text + k, length - k < part ? length - k : part);
  strut_sha256_end(&hash, digest);
  for (int i = 0; i < STRUT_SHA256_BYTES; i++) snprintf(hex + 2 * i, 3, "%02x", digest[i]);
}

/* The examples of FIPS 180-4 and NIST's list of short messages. */
TEST(sha256) {
  static const struct {
    const char *text, *hex;
  } cases[] = {
      {"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
      {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
      {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
       "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
      {"abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmnopqrlmn"
       "op"
       "qrsmnopqrstnopqrstu",
       "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1"},
  };
  char hex[65];
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    for (size_t part = 1; part < 130; part++) {
      digest_of(cases[i].text, strlen(cases[i].text), part, 1, hex);
      assert_string_equal(hex, cases[i].hex);
    }
  char many[1000];
  memset(many, 'a', sizeof many);
  digest_of(many, sizeof many, 77, 1000, hex); /* a million of them */
  assert_string_equal(hex, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(texts_keep_their_ends) {
  uint8_t first[STRUT_SHA256_BYTES], second[STRUT_SHA256_BYTES];
  strut_sha256 hash;
  strut_sha256_begin(&hash);
  strut_sha256_add_text(&hash, "ab");
  strut_sha256_add_text(&hash, "c");
  strut_sha256_end(&hash, first);
  strut_sha256_begin(&hash);
  strut_sha256_add_text(&hash, "a");
  strut_sha256_add_text(&hash, "bc");
  strut_sha256_end(&hash, second);
  assert_true(memcmp(first, second, sizeof first) != 0);
}

/* From the sanity check of xxHash itself: its buffer of 2222 bytes, and values for some lengths. */
TEST(checksum) {
  static const uint64_t seed = 2654435761U;
  static const struct {
    size_t length;
    uint64_t plain, seeded;
  } cases[] = {
      {0, 0xEF46DB3751D8E999, 0xAC75FDA2929B17EF},
      {1, 0xE934A84ADB052768, 0x5014607643A9B4C3},
      {14, 0x8282DCC4994E35C8, 0xC3BD6BF63DEB6DF0},
      {222, 0xB641AE8CB691C174, 0x20CB8AB7AE10C14A},
  };
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
