/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Units: the table's order and factors, and the words for dimensions. */
#include "parser/language/expression/expression.h"
#include "tests/support/test.h"

static const strut_unit *unit(const char *name) { return strut_unit_find(name, strlen(name)); }

TEST(every_unit_is_found) {
  size_t count = 0;
  for (; strut_unit_at(count); count++) {
    const strut_unit *one = strut_unit_at(count);
    assert_ptr_equal(unit(one->name), one);
    if (count) assert_true(strcmp(strut_unit_at(count - 1)->name, one->name) < 0);
    double factor = one->rest * pow(10, one->decimal);
    assert_true(fabs(factor - one->factor) <= 1e-15 * one->factor);
  }
  assert_true(count > 40);
  assert_null(strut_unit_at(count + 1));
}

TEST(other_names_are_not) {
  static const char *const names[] = {"",    "x",  "M",  "mmm", "hz", "HZ",
                                      "kgg", "m ", " m", "K",   "pi"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) assert_null(unit(names[i]));
  assert_ptr_equal(strut_unit_find("mm/s", 2), unit("mm"));
  assert_ptr_equal(strut_unit_find("min", 1), unit("m"));
}

TEST(factors_are_right) {
  static const struct {
    const char *name;
    double factor;
    strut_dimension dimension;
  } expected[] = {{"m", 1, {0, 1, 0, 0}},         {"km", 1000, {0, 1, 0, 0}},
                  {"cm", 0.01, {0, 1, 0, 0}},     {"mm", 0.001, {0, 1, 0, 0}},
                  {"um", 1e-6, {0, 1, 0, 0}},     {"nm", 1e-9, {0, 1, 0, 0}},
                  {"kg", 1, {1, 0, 0, 0}},        {"g", 0.001, {1, 0, 0, 0}},
                  {"mg", 1e-6, {1, 0, 0, 0}},     {"t", 1000, {1, 0, 0, 0}},
                  {"s", 1, {0, 0, 1, 0}},         {"ms", 0.001, {0, 0, 1, 0}},
                  {"us", 1e-6, {0, 0, 1, 0}},     {"ns", 1e-9, {0, 0, 1, 0}},
                  {"min", 60, {0, 0, 1, 0}},      {"h", 3600, {0, 0, 1, 0}},
                  {"N", 1, {1, 1, -2, 0}},        {"kN", 1000, {1, 1, -2, 0}},
                  {"mN", 0.001, {1, 1, -2, 0}},   {"uN", 1e-6, {1, 1, -2, 0}},
                  {"MN", 1e6, {1, 1, -2, 0}},     {"Hz", 1, {0, 0, -1, 0}},
                  {"kHz", 1000, {0, 0, -1, 0}},   {"mHz", 0.001, {0, 0, -1, 0}},
                  {"Pa", 1, {1, -1, -2, 0}},      {"kPa", 1e3, {1, -1, -2, 0}},
                  {"MPa", 1e6, {1, -1, -2, 0}},   {"GPa", 1e9, {1, -1, -2, 0}},
                  {"J", 1, {1, 2, -2, 0}},        {"mJ", 0.001, {1, 2, -2, 0}},
                  {"kJ", 1000, {1, 2, -2, 0}},    {"W", 1, {1, 2, -3, 0}},
                  {"rad", 1, {0, 0, 0, 1}},       {"deg", 0.017453292519943295, {0, 0, 0, 1}},
                  {"%", 0.01, {0, 0, 0, 0}},      {"turn", 6.283185307179586, {0, 0, 0, 1}},
                  {"percent", 0.01, {0, 0, 0, 0}}};
  for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
    const strut_unit *one = unit(expected[i].name);
    if (!one) fail_msg("no unit '%s'", expected[i].name);
    if (one->factor != expected[i].factor) fail_msg("'%s' is %.17g", one->name, one->factor);
    assert_true(strut_dimension_equal(one->dimension, expected[i].dimension));
  }
}

static void expect_words(strut_dimension dimension, const char *name, const char *si) {
  char buffer[80];
  assert_string_equal(strut_dimension_name(dimension, buffer, sizeof buffer), name);
  assert_string_equal(strut_dimension_unit(dimension), si);
}

TEST(dimensions_have_words) {
  expect_words(STRUT_DIM_NONE, "a number without unit", "1");
  expect_words(STRUT_DIM_LENGTH, "a length", "m");
  expect_words(STRUT_DIM_MASS, "a mass", "kg");
  expect_words(STRUT_DIM_TIME, "a time", "s");
  expect_words(STRUT_DIM_FREQUENCY, "a frequency", "Hz");
  expect_words(STRUT_DIM_ANGLE, "an angle", "rad");
  expect_words(STRUT_DIM_VELOCITY, "a velocity", "m/s");
  expect_words(STRUT_DIM_ACCELERATION, "an acceleration", "m/s^2");
  expect_words(STRUT_DIM_FORCE, "a force", "N");
  expect_words(STRUT_DIM_STIFFNESS, "a stiffness", "N/m");
  expect_words(STRUT_DIM_DAMPING, "a damping", "N s/m");
  expect_words((strut_dimension){1, 1, -1, 0}, "kg m s^-1", "SI");
  expect_words((strut_dimension){0, 0.5f, -1.25f, 3}, "m^0.5 s^-1.25 rad^3", "SI");
  expect_words((strut_dimension){0, -0.5f, 0, 0}, "m^-0.5", "SI");
}

TEST(short_buffers_are_respected) {
  char buffer[12];
  for (size_t size = 1; size <= 8; size++) {
    memset(buffer, '#', sizeof buffer);
    strut_dimension_name((strut_dimension){2, 3, -4, 5}, buffer, size);
    assert_true(strlen(buffer) < size);
    for (size_t i = size; i < sizeof buffer; i++) assert_int_equal(buffer[i], '#');
  }
  strut_dimension_name(STRUT_DIM_NONE, buffer, 0);
}

/* The examples that messages give must be what they claim. */
TEST(examples_fit) {
  const strut_dimension all[] = {STRUT_DIM_NONE,      STRUT_DIM_LENGTH,       STRUT_DIM_MASS,
                                 STRUT_DIM_TIME,      STRUT_DIM_FREQUENCY,    STRUT_DIM_ANGLE,
                                 STRUT_DIM_VELOCITY,  STRUT_DIM_ACCELERATION, STRUT_DIM_FORCE,
                                 STRUT_DIM_STIFFNESS, STRUT_DIM_DAMPING,      {1, 2, -2, 0},
                                 {1, 2, -3, 0},       {1, -1, -2, 0},         {0, 2, 0, 0},
                                 {0, 3, 0, 0},        {1, -3, 0, 0},          {0, 0, -1, 1}};
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
    strut_quantity q;
    strut_expression_error error;
    assert_non_null(strut_dimension_example(all[i]));
    if (!strut_expression_evaluate(strut_dimension_example(all[i]), NULL, &q, &error))
      fail_msg("%s", error.message);
    assert_true(strut_dimension_equal(q.dimension, all[i]));
    if (i == 0) continue;
    char text[40];
    snprintf(text, sizeof text, "1 %s", strut_dimension_unit(all[i]));
    assert_true(strut_expression_evaluate(text, NULL, &q, &error));
    assert_true(strut_dimension_equal(q.dimension, all[i]) && q.value == 1);
  }
  assert_null(strut_dimension_example((strut_dimension){1, 1, 1, 1}));
}

/* What stands behind a plain number, and nothing behind an expression. */
TEST(units_of_texts) {
  static const struct {
    const char *text, *name;
    double size;
  } cases[] = {{"0.5 mm", "mm", 1e-3},
               {"-3e1 kN/m", "kN/m", 1e3},
               {"20deg", "deg", 3.14159265358979323846 / 180},
               {"1 %", "%", 1e-2},
               {"5 N s/m", "N s/m", 1},
               {"3", NULL, 0},
               {"", NULL, 0},
               {"2 mm + 1 m", NULL, 0},
               {"2*width", NULL, 0},
               {"2 cows", NULL, 0},
               {"mm", NULL, 0},
               {"sqrt(2) m", NULL, 0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const strut_file_unit unit = strut_unit_of_text(cases[i].text, NULL);
    if (!cases[i].name) {
      assert_null(unit.name);
      continue;
    }
    assert_string_equal(unit.name, cases[i].name);
    assert_true(unit.size == cases[i].size);
  }
}

TEST(equality_allows_for_roots) {
  float third = 1.0f / 3;
  assert_true(
      strut_dimension_equal((strut_dimension){third + third + third, 0, 0, 0}, STRUT_DIM_MASS));
  assert_false(strut_dimension_equal((strut_dimension){1.01f, 0, 0, 0}, STRUT_DIM_MASS));
  assert_false(strut_dimension_equal((strut_dimension){1, 0, 0, 1}, STRUT_DIM_MASS));
}
