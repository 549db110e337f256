/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Expressions that are refused: the place and the words; limits; random texts. */
#include "engine/base/memory.h"
#include "tests/support/check.h"
#include "tests/support/random.h"
#include "tests/unit/expression_support.h"

TEST(malformed_numbers_are_named) {
  const char *point = "a number has one decimal point and digits after it";
  expect_error("1.", 0, 2, point);
  expect_error("1.2.3", 0, 4, point);
  expect_error("2*1..5", 2, 2, point);
  expect_error("1_000", 0, 5, "digits cannot be grouped with '_'");
  expect_error("0x1F", 0, 4, "hexadecimal numbers are not allowed");
  expect_error("1e", 0, 2, "the exponent of this number has no digits");
  expect_error("1e+", 0, 2, "the exponent of this number has no digits");
  expect_error("nan", 0, 3, "'nan' is not allowed, expected a finite number");
  expect_error("-inf", 1, 3, "'inf' is not allowed, expected a finite number");
  expect_error(".inf", 0, 1, "unexpected '.', expected a number");
  expect_error("1e999", 0, 5, "this number is beyond the range of numbers");
  expect_error("1e308 km", 0, 5, "this number is beyond the range of numbers");
  expect_error("1e308 h", 0, 7, "this number is beyond the range of numbers");
  expect_error("1e-999", 0, 6, "this number is beyond the range of numbers");
}

TEST(wrong_units_are_named) {
  expect_error("10 mmm", 3, 3, "unknown unit 'mmm'; did you mean 'mm'?");
  expect_error("10 hz", 3, 2, "unknown unit 'hz'; did you mean 'Hz'?");
  expect_error("10 parsec", 3, 6, "unknown unit 'parsec'");
  expect_error("2 pi", 2, 2, "expected an operator before 'pi'; write '*' to multiply");
  expect_error("2 two", 2, 3, "expected an operator before 'two'; write '*' to multiply");
  expect_error("2 sin(1)", 2, 3, "expected an operator before 'sin'; write '*' to multiply");
  expect_error("2*a + mm", 6, 2, "the unit 'mm' needs a number before it, such as '1 mm'");
  expect_error("1/Hz", 2, 2, "the unit 'Hz' needs a number before it, such as '1 Hz'");
  expect_error("10 N*t", 5, 1,
               "'t' is a unit and a parameter; rename the parameter, or write '* (t)' for it");
  expect_error("10 N / t", 7, 1,
               "'t' is a unit and a parameter; rename the parameter, or write '/ (t)' for it");
  const char *power = "the power of a unit is a whole number such as 2";
  expect_error("1 m^0.5", 4, 2, power);
  expect_error("1 m^(2)", 4, 0, power);
  expect_error("1 m^x", 4, 1, power);
  expect_error("1 m^99", 4, 2, power);
  expect_error("1 m^-", 4, 1, power);
  expect_error("1 N q", 4, 1, "unexpected 'q', expected an operator or the end");
}

TEST(names_are_looked_up) {
  expect_error("amplitud", 0, 8, "unknown parameter 'amplitud'; did you mean 'amplitude'?");
  expect_error("1 + tow", 4, 3, "unknown parameter 'tow'; did you mean 'two'?");
  expect_error("xyzzy", 0, 5, "unknown parameter 'xyzzy'");
  expect_error("sine(1)", 0, 4, "unknown function 'sine'; did you mean 'sin'?");
  expect_error("two(1)", 0, 3, "'two' is not a function; write '*' to multiply");
  expect_error("sin", 0, 3, "the function 'sin' needs its arguments in parentheses");
  expect_error("2*lost", 2, 4, ""); /* the lookup has said why */
  strut_quantity q;
  strut_expression_error error;
  assert_false(strut_expression_evaluate("foo", NULL, &q, &error));
  assert_string_equal(error.message, "unknown name 'foo'");
  assert_all(strut_expression_reserved("pi", 2), strut_expression_reserved("atan2", 5));
  assert_false(strut_expression_reserved("atan", 3));
  assert_false(strut_expression_reserved("mm", 2));
}

TEST(wrong_dimensions_are_named) {
  expect_error("2*(1 m + 1 s)", 3, 9, "'+' joins a length and a time, expected equal dimensions");
  expect_error("1 m - f", 0, 7, "'-' joins a length and a frequency, expected equal dimensions");
  expect_error("min(1 m, 1 kg)", 0, 14,
               "'min' joins a length and a mass, expected equal dimensions");
  expect_error("2^(1 m)", 0, 7, "the exponent is a length, expected a number without unit");
  expect_error("sin(1 m)", 0, 8, "'sin' takes an angle, got a length");
  expect_error("sin(1 Hz * (1 s) * 1 kg)", 0, 24, "'sin' takes an angle, got a mass");
  expect_error("exp(1 deg)", 0, 10, "'exp' takes a number without unit, got an angle");
  expect_error("floor(2 mm)", 0, 11, "'floor' takes a number without unit, got a length");
  expect_error("asin(1 N m s)", 0, 13, "'asin' takes a number without unit, got kg m^2 s^-1");
  expect_error("(1 m)^500", 0, 9, "the power of a unit is too high");
  expect_error("sin(1, 2)", 0, 9, "'sin' takes 1 argument, got 2");
  expect_error("atan2(1)", 0, 8, "'atan2' takes 2 arguments, got 1");
  expect_error("min(1)", 0, 6, "'min' takes 2 to 16 arguments, got 1");
  expect_error("max(1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1)", 0, 36, "more than 16 arguments");
}

TEST(results_are_finite) {
  expect_error("2 + 1/(2 - 2)", 4, 9, "division by zero");
  expect_error("sqrt(-1)", 0, 8, "the result of 'sqrt' is not a real number");
  expect_error("log(0)", 0, 6, "the result of 'log' is not finite");
  expect_error("log(-1)", 0, 7, "the result of 'log' is not a real number");
  expect_error("asin(2)", 0, 7, "the result of 'asin' is not a real number");
  expect_error("exp(1000)", 0, 9, "the result of 'exp' is not finite");
  expect_error("1e200*1e200", 0, 11, "the result of '*' is not finite");
  expect_error("1e308 + 1e308", 0, 13, "the result of '+' is not finite");
  expect_error("(-8)^0.5", 0, 8, "the result of '^' is not a real number");
  expect_error("0^-1", 0, 4, "the result of '^' is not finite");
  expect_error("10^400", 0, 6, "the result of '^' is not finite");
}

TEST(syntax_is_strict) {
  const char *early = "the expression ends too early, expected a number, a name or '('";
  expect_error("", 0, 0, "a number is missing here");
  expect_error("  ", 0, 2, "a number is missing here");
  expect_error("1 +", 3, 0, early);
  expect_error("2*", 2, 0, early);
  expect_error("-", 1, 0, early);
  expect_error("(", 1, 0, early);
  expect_error("(1", 2, 0, "the expression ends too early, expected an operator or ')'");
  expect_error("sin(1", 5, 0, "the expression ends too early, expected an operator, ',' or ')'");
  expect_error("()", 1, 1, "unexpected ')', expected a number, a name or '('");
  expect_error("sin()", 4, 1, "unexpected ')', expected a number, a name or '('");
  expect_error("min(1,)", 6, 1, "unexpected ')', expected a number, a name or '('");
  expect_error("1)", 1, 1, "unexpected ')', expected an operator or the end");
  expect_error("2(3)", 1, 1, "unexpected '(', expected an operator or the end");
  expect_error("(1)(2)", 3, 1, "unexpected '(', expected an operator or the end");
  expect_error("*2", 0, 1, "unexpected '*', expected a number, a name or '('");
  expect_error("2**3", 1, 2, "unexpected '**'; powers are written '^'");
  expect_error("f=7", 1, 1, "unexpected '='; a value is one expression");
  expect_error("5 % 3", 4, 1, "unexpected '3', expected an operator or the end");
  expect_error("1;2", 1, 1, "unexpected ';', expected an operator or the end");
  expect_error("\"1\"", 0, 1, "unexpected '\"', expected a number, a name or '('");
}

/* Offsets count characters, not bytes. */
TEST(pasted_characters_are_explained) {
  expect_error("10\u00A0mm", 2, 1,
               "unexpected '\u00A0'; this is a no-break space; use a plain one");
  expect_error("\u22125", 0, 1, "unexpected '\u2212'; write '-' for minus");
  expect_error("2\u00D73", 1, 1, "unexpected '\u00D7'; write '*' to multiply");
  expect_error("10 \u00B5m", 3, 1, "unexpected '\u00B5'; write 'u' for micro, as in 'um'");
  expect_error("90\u00B0", 2, 1, "unexpected '\u00B0'; write 'deg' for degrees");
  expect_error("3 m\u00B2", 3, 1, "unexpected '\u00B2'; write '^2'");
  expect_error("2*\u03C0", 2, 1, "unexpected '\u03C0'; write 'pi'");
  expect_error("\u00E4", 0, 1, "unexpected '\u00E4', expected a number, a name or '('");
}

static char *nest(const char *open, const char *middle, const char *close, int levels) {
  char *text = calloc(1, (size_t)levels * 8 + 64);
  for (int i = 0; i < levels; i++) strcat(text, open);
  strcat(text, middle);
  for (int i = 0; i < levels; i++) strcat(text, close);
  return text;
}

static bool accepts(char *text) {
  strut_quantity q;
  strut_expression_error error = {0};
  bool fine = strut_expression_evaluate(text, NULL, &q, &error);
  if (!fine) assert_true(error.message[0] != '\0');
  free(text);
  return fine;
}

TEST(nesting_and_length_are_limited) {
  assert_true(accepts(nest("(", "1", ")", 64)));
  assert_false(accepts(nest("(", "1", ")", 65)));
  assert_true(accepts(nest("-", "1", "", 64)));
  assert_false(accepts(nest("-", "1", "", 65)));
  assert_true(accepts(nest("1^", "1", "", 64)));
  assert_false(accepts(nest("1^", "1", "", 65)));
  assert_true(accepts(nest("abs(", "1", ")", 64)));
  assert_false(accepts(nest("abs(", "1", ")", 65)));
  assert_true(accepts(nest("1+", "1", "", 499)));
  assert_true(accepts(nest("1+", "11", "", 499)));
  assert_false(accepts(nest("1+", "111", "", 499)));
  assert_false(accepts(nest("(", "1", ")", 100000)));
  expect_error("((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((1", 65, 1,
               "more than 64 levels of nesting");
}

/* No text of the expression's own letters makes it crash, allocate or return what is not finite. */
TEST(random_texts_are_survived) {
  static const char *const parts[] = {
      "1", "2.5", "e",    "m",        "s",     "kg", "N",   "/",     "*",   "+",  "-",   "^",
      "(", ")",   ",",    "sin",      "min",   "pi", "two", "a",     "f",   " ",  "1e3", "%",
      ".", "_",   "lost", "\xC3\xA4", "sqrt(", "0",  "x",   "1e308", "deg", "\t", "2 mm"};
  uint64_t seed = 12345, allocations = strut_allocation_count();
  int accepted = 0;
  for (int i = 0; i < 60000; i++) {
    char text[200] = "";
    for (int32_t n = 1 + random_below(&seed, 9); n; n--)
      strcat(text, parts[random_below(&seed, sizeof parts / sizeof parts[0])]);
    strut_quantity q;
    strut_expression_error error;
    if (strut_expression_evaluate(text, &test_scope, &q, &error)) {
      assert_true(isfinite(q.value));
      accepted++;
    } else {
      assert_true(error.offset + error.length <= strlen(text));
    }
  }
  assert_all(accepted > 500, strut_allocation_count() == allocations);
}

TEST(lookups_are_few) {
  int calls = 0;
  strut_scope counting = {.lookup = test_lookup, .names = test_scope.names, .context = &calls};
  strut_quantity q;
  strut_expression_error error;
  assert_true(strut_expression_evaluate("10 mm", &counting, &q, &error));
  assert_true(strut_expression_evaluate("0.1", &counting, &q, &error));
  assert_int_equal(calls, 0);
  assert_true(strut_expression_evaluate("10 N/m", &counting, &q, &error));
  assert_int_equal(calls, 1);
}
