/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Number literals: the grammar, correct rounding, and that neither locale nor luck matters. */
#include <locale.h>
#include <regex.h>

#include "engine/base/memory.h"
#include "parser/language/expression/expression.h"
#include "parser/language/yaml/document.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

static uint64_t seed = 42;

static bool same_bits(double a, double b) { return memcmp(&a, &b, sizeof a) == 0; }

static void expect_literal(const char *text, double value) {
  double got = -1;
  if (!strut_number_read_scaled(text, strlen(text), 0, &got)) fail_msg("'%s' was refused", text);
  if (!same_bits(got, value)) fail_msg("'%s' gave %.17g, expected %.17g", text, got, value);
}

static void expect_refusal(const char *text) {
  double got;
  if (strut_number_read_scaled(text, strlen(text), 0, &got))
    fail_msg("'%s' was read as %.17g", text, got);
}

TEST(literals_have_their_values) {
  expect_literal("0", 0);
  expect_literal("00.000e5", 0);
  expect_literal("0e99999999999999999999", 0);
  expect_literal("1", 1);
  expect_literal("007", 7);
  expect_literal(".5", 0.5);
  expect_literal("1.25e2", 125);
  expect_literal("1.25E+2", 125);
  expect_literal("1e-3", 1e-3);
  expect_literal("1e0000000000000000000003", 1e3);
  expect_literal("9007199254740993", 9007199254740992.0); /* a tie: to even */
  expect_literal("9007199254740993.00000000000000000001", 9007199254740994.0);
  expect_literal("2.2250738585072011e-308", 2.2250738585072011e-308);
  expect_literal("4.9406564584124654e-324", 4.9406564584124654e-324);
  expect_literal("1.7976931348623157e308", 1.7976931348623157e308);
  expect_literal("123456789012345678901234567890", 123456789012345678901234567890.0);
  expect_literal("0.1000000000000000055511151231257827021181583404541015625", 0.1);
}

TEST(other_texts_are_refused) {
  static const char *const texts[] = {"",         " ",
                                      "1 ",       " 1",
                                      "+1",       "-1",
                                      "1.",       ".",
                                      "1.e3",     "e3",
                                      "1e",       "1e+",
                                      "1e-",      "1e1.5",
                                      "1..2",     "1.2.3",
                                      "0x10",     "0X1p3",
                                      "1_000",    "1,5",
                                      "1'000",    "nan",
                                      "NaN",      "inf",
                                      "infinity", "1f",
                                      "1d0",      "1L",
                                      "1e5e5",    "--1",
                                      "1e999",    "1e-999",
                                      "1e309",    "1e99999999999999999999",
                                      "0.1e-400", "1e-99999999999999999999",
                                      "\xD9\xA1", "1\n",
                                      "1\t",      "#1",
                                      "1%",       "1e 5",
                                      "1 e5"};
  for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) expect_refusal(texts[i]);
  double got;
  assert_false(strut_number_read_scaled("1\0", 2, 0, &got));
  FREED char *longest = calloc(1, STRUT_NUMBER_MOST + 2);
  memset(longest, '0', STRUT_NUMBER_MOST + 1);
  assert_true(strut_number_read_scaled(longest, STRUT_NUMBER_MOST, 0, &got));
  assert_false(strut_number_read_scaled(longest, STRUT_NUMBER_MOST + 1, 0, &got));
}

TEST(length_bounds_the_literal) {
  double got;
  assert_true(strut_number_read_scaled("12345", 3, 0, &got));
  assert_true(got == 123);
  assert_true(strut_number_read_scaled("1e55", 3, 0, &got));
  assert_true(got == 1e5);
  assert_false(strut_number_read_scaled("1.5", 2, 0, &got));
  assert_all_equal(strut_number_scan("1.5e3kg", 7), 5, strut_number_scan("1e+kg", 5), 1,
                   strut_number_scan("1.kg", 4), 1, strut_number_scan("kg", 2), 0);
  assert_int_equal(strut_number_scan(".", 1), 0);
}

/* Against strtod on random literals: every bit. */
TEST(rounding_is_correct) {
  for (int i = 0; i < 300000; i++) {
    char text[80];
    int used = 0, whole = random_below(&seed, i % 2 ? 8 : 25) + 1, digits = random_below(&seed, 20);
    for (int k = 0; k < whole; k++) text[used++] = (char)('0' + random_below(&seed, 10));
    if (digits) text[used++] = '.';
    for (int k = 0; k < digits; k++) text[used++] = (char)('0' + random_below(&seed, 10));
    text[used] = '\0';
    if (random_below(&seed, 2))
      snprintf(text + used, 20, "e%d", random_below(&seed, i % 3 ? 60 : 600) - 300);
    double expected = strtod(text, NULL), got = -1;
    bool readable = isfinite(expected) && (expected != 0 || strspn(text, "0.e-+") == strlen(text));
    bool read = strut_number_read_scaled(text, strlen(text), 0, &got);
    if (expected == 0 && read)
      assert_true(got == 0);
    else if (read != readable || (read && !same_bits(got, expected)))
      fail_msg("'%s' gave %.17g, expected %.17g", text, got, expected);
  }
}

/* What %.17g prints is read back to the same bits, whatever the bits. */
TEST(every_double_comes_back) {
  for (int i = 0; i < 200000; i++) {
    uint64_t bits = random_bits(&seed) >> 1;
    double value, got;
    memcpy(&value, &bits, sizeof value);
    if (!isfinite(value) || value == 0) continue;
    char text[40];
    snprintf(text, sizeof text, "%.17g", value);
    expect_literal(text, value);
    assert_true(strut_number_read_scaled(text, strlen(text), 0, &got));
  }
}

/* A unit's power of ten goes into the literal's exponent: 0.1 ms has the bits of 1e-4. */
TEST(scaling_rounds_once) {
  for (int i = 0; i < 100000; i++) {
    char text[40], scaled[60];
    int decimal = random_below(&seed, 19) - 9;
    snprintf(text, sizeof text, "%u.%04u", random_below(&seed, 100000), random_below(&seed, 10000));
    snprintf(scaled, sizeof scaled, "%se%d", text, decimal);
    double got = -1, expected = strtod(scaled, NULL);
    assert_true(strut_number_read_scaled(text, strlen(text), decimal, &got));
    if (!same_bits(got, expected)) fail_msg("%s: %.17g, expected %.17g", scaled, got, expected);
  }
}

/* Random mutations of literals against the grammar as a regular expression. */
TEST(grammar_is_the_one_of_the_language) {
  static const char alphabet[] = "0123456789..eeEE++--xXpP_,' \tnaifNAIF";
  static const char *const seeds[] = {"1.5e3", "0.001", "10", ".5", "12e-4", "1E+10", "123.456"};
  regex_t grammar;
  assert_int_equal(
      regcomp(&grammar, "^([0-9]+([.][0-9]+)?|[.][0-9]+)([eE][-+]?[0-9]+)?$", REG_EXTENDED), 0);
  int accepted = 0, refused = 0;
  for (int i = 0; i < 200000; i++) {
    char text[32];
    snprintf(text, sizeof text, "%s", seeds[random_below(&seed, sizeof seeds / sizeof seeds[0])]);
    for (int changes = random_below(&seed, 3) + 1; changes; changes--) {
      size_t length = strlen(text), at = (size_t)random_below(&seed, (int32_t)length + 1);
      char letter = alphabet[random_below(&seed, sizeof alphabet - 1)];
      if (random_below(&seed, 3) == 0 && length) {
        memmove(text + at, text + at + (at < length), length - at + (at == length));
      } else if (random_below(&seed, 2) && at < length) {
        text[at] = letter;
      } else if (length + 2 < sizeof text) {
        memmove(text + at + 1, text + at, length - at + 1);
        text[at] = letter;
      }
    }
    double got = 0, value = strtod(text, NULL);
    bool fits = regexec(&grammar, text, 0, NULL, 0) == 0;
    bool nonzero = strcspn(text, "123456789") < strcspn(text, "eE");
    bool expected = fits && isfinite(value) && (value != 0 || !nonzero);
    bool read = strut_number_read_scaled(text, strlen(text), 0, &got);
    if (read != expected) fail_msg("'%s' was %s", text, read ? "read" : "refused");
    if (read && !same_bits(got, value)) fail_msg("'%s' gave %.17g", text, got);
    accepted += read;
    refused += !read;
  }
  regfree(&grammar);
  assert_true(accepted > 20000 && refused > 20000);
}

/* Builds a German locale in a scratch directory; NULL where that cannot be done. */
static const char *german(char *folder, size_t size) {
  char command[300];
  snprintf(folder, size, "/tmp/strut-locale-XXXXXX");
  if (!mkdtemp(folder)) return NULL;
  snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 %s/de_DE.UTF-8 >/dev/null 2>&1",
           folder);
  if (system(command) != 0 && !setlocale(LC_ALL, "de_DE.UTF-8")) return NULL;
  setenv("LOCPATH", folder, 1);
  const char *name = setlocale(LC_ALL, "de_DE.UTF-8");
  return name && strcmp(localeconv()->decimal_point, ",") == 0 ? name : NULL;
}

TEST(locale_does_not_matter) {
  char folder[64], command[100];
  const char *name = german(folder, sizeof folder);
  double got = 0;
  bool brief = false, lengthy = false, comma = true, quantity = false, shown = false;
  if (name) {
    static const char digits[] = "0.1000000000000000055511151231257827021181583404541015625";
    strut_quantity q;
    strut_expression_error error;
    OWN(strut_diagnostics) diagnostics = {0};
    brief = strut_number_read_scaled("1.5", 3, 0, &got) && got == 1.5;
    lengthy = strut_number_read_scaled(digits, strlen(digits), 0, &got) && got == 0.1;
    comma = strut_number_read_scaled("1,5", 3, 0, &got);
    quantity = strut_expression_evaluate("1234567.891011121314151617 mm", NULL, &q, &error) &&
               q.value == 1234.567891011121314151617;
    strut_diagnose(&diagnostics, (strut_place){0}, "%.1f", 0.5);
    shown = strcmp(diagnostics.items[0].message, "0.5") == 0;
  }
  setlocale(LC_ALL, "C");
  snprintf(command, sizeof command, "rm -rf %s", folder);
  if (system(command) != 0) print_message("could not remove %s\n", folder);
  if (!name) {
    print_message("no German locale here\n");
    skip();
  }
  assert_all(brief, lengthy, !comma, quantity, shown);
}
