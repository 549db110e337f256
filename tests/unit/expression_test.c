/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Expressions: values, units, dimensions. */
#include "tests/support/test.h"
#include "tests/unit/expression_support.h"

TEST(plain_numbers_are_bare) {
  expect_bare("0", 0);
  expect_bare("1.5", 1.5);
  expect_bare("-1.5e-3", -1.5e-3);
  expect_bare("+.5", 0.5);
  expect_bare(" 2 ", 2);
  expect_bare("10 %", 0.1);
  expect_bare("10%", 0.1);
  expect_bare("35 percent", 0.35);
  expect_bare("two", 2);
}

TEST(operators_bind_as_in_mathematics) {
  expect_bare("1 + 2*3", 7);
  expect_bare("(1 + 2)*3", 9);
  expect_bare("8/4/2", 1);
  expect_bare("8 - 4 - 2", 2);
  expect_bare("2^3^2", 512);
  expect_bare("-2^2", -4);
  expect_bare("(-2)^2", 4);
  expect_bare("2^-2", 0.25);
  expect_bare("2^+2", 4);
  expect_bare("-2^-2", -0.25);
  expect_bare("--2", 2);
  expect_bare("2--2", 4);
  expect_bare("2*-3", -6);
  expect_bare("2*3^2", 18);
  expect_bare("(-1)^0", 1);
  expect_bare("7 - 2*3 + 4/2", 3);
  expect_bare("\t1\n+\r2", 3);
  expect_bare("pi", 3.14159265358979323846);
  expect_bare("2*pi", 6.28318530717958647692);
}

TEST(functions_have_their_values) {
  expect_bare("sin(pi/2)", 1);
  expect_bare("sin(30 deg)", sin(3.14159265358979323846 / 6));
  expect_bare("cos(0)", 1);
  expect_bare("cos(1 turn)", 1);
  expect_bare("tan(0.5 rad)", tan(0.5));
  expect_bare("sqrt(16)", 4);
  expect_bare("exp(1)", exp(1));
  expect_bare("log(exp(2))", 2);
  expect_bare("log10(1000)", 3);
  expect_bare("abs(-3)", 3);
  expect_bare("min(3, 1, 2)", 1);
  expect_bare("max(3, 1, 2, 5)", 5);
  expect_bare("floor(-1.5)", -2);
  expect_bare("ceil(-1.5)", -1);
  expect_bare("round(2.5)", 3);
  expect_bare("hypot(3, 4)", 5);
  expect_quantity("asin(1)", asin(1), STRUT_DIM_ANGLE);
  expect_quantity("acos(0.5)", acos(0.5), STRUT_DIM_ANGLE);
  expect_quantity("atan(1)", atan(1), STRUT_DIM_ANGLE);
  expect_quantity("atan2(1, -1)", atan2(1, -1), STRUT_DIM_ANGLE);
  expect_quantity("atan2(1 mm, 2 mm)", atan2(1, 2), STRUT_DIM_ANGLE);
}

/* The bits are those of the SI number that a person would write. */
TEST(units_scale_exactly) {
  expect_quantity("10 Hz", 10, STRUT_DIM_FREQUENCY);
  expect_quantity("10Hz", 10, STRUT_DIM_FREQUENCY);
  expect_quantity("0.1 mm", 0.0001, STRUT_DIM_LENGTH);
  expect_quantity("96.51 mm", 0.09651, STRUT_DIM_LENGTH);
  expect_quantity("23.87 mm", 0.02387, STRUT_DIM_LENGTH);
  expect_quantity("1e3mm", 1, STRUT_DIM_LENGTH);
  expect_quantity("0.1 ms", 1e-4, STRUT_DIM_TIME);
  expect_quantity("2 min", 120, STRUT_DIM_TIME);
  expect_quantity("1 h", 3600, STRUT_DIM_TIME);
  expect_quantity("100 g", 0.1, STRUT_DIM_MASS);
  expect_quantity("20 N/cm", 2000, STRUT_DIM_STIFFNESS);
  expect_quantity("0.3 N/mm", 300, STRUT_DIM_STIFFNESS);
  expect_quantity("1 / (1000 * f)", 1e-4, STRUT_DIM_TIME);
  expect_quantity("0.1 mm/s", 1e-4, STRUT_DIM_VELOCITY);
  expect_quantity("180 deg", 3.14159265358979323846, STRUT_DIM_ANGLE);
  expect_quantity("10 rad/s", 10, (strut_dimension){0, 0, -1, 1});
  expect_quantity("60 km/h", 60000.0 / 3600, STRUT_DIM_VELOCITY);
  expect_quantity("1 kg*m/s^2", 1, STRUT_DIM_FORCE);
  expect_quantity("1 kg m s^-2", 1, STRUT_DIM_FORCE);
  expect_quantity("1 cm^2", 1e-4, (strut_dimension){0, 2, 0, 0});
  expect_quantity("1 m ^ 2", 1, (strut_dimension){0, 2, 0, 0});
  expect_quantity("9.81 m / min^2", 9.81 / 3600, STRUT_DIM_ACCELERATION);
}

TEST(units_end_where_an_operator_begins) {
  expect_quantity("10 N/2", 5, STRUT_DIM_FORCE);
  expect_quantity("10 N*two", 20, STRUT_DIM_FORCE);
  expect_quantity("10 N/(2 m)", 5, STRUT_DIM_STIFFNESS);
  expect_quantity("10 N * min(1, 2)", 10, STRUT_DIM_FORCE);
  expect_quantity("10 N * (t)", 30, STRUT_DIM_FORCE);
  expect_quantity("2*a + 0.1 mm", 0.0041, STRUT_DIM_LENGTH);
  expect_quantity("-2 m", -2, STRUT_DIM_LENGTH);
  expect_quantity("3 m^2/m", 3, STRUT_DIM_LENGTH);
  expect_quantity("1 m - 1 mm", 0.999, STRUT_DIM_LENGTH);
  expect_quantity("5 t", 5000, STRUT_DIM_MASS); /* a parameter t cannot stand there */
}

TEST(dimensions_follow_the_operators) {
  expect_quantity("1 m + 2", 3, STRUT_DIM_LENGTH);
  expect_quantity("2 - 1 m", 1, STRUT_DIM_LENGTH);
  expect_quantity("2 * 3 m", 6, STRUT_DIM_LENGTH);
  expect_quantity("1 / f", 0.1, STRUT_DIM_TIME);
  expect_quantity("a * f", 0.02, STRUT_DIM_VELOCITY);
}

TEST(division_reads_its_literal_whole) {
  expect_quantity("1 m / (2 m)", 0.5, STRUT_DIM_NONE);
  expect_quantity("(1 m) / 2 m", 0.5, STRUT_DIM_NONE); /* a literal owns its unit */
  expect_quantity("sqrt(4 m^2)", 2, STRUT_DIM_LENGTH);
  expect_quantity("(2 m)^2", 4, (strut_dimension){0, 2, 0, 0});
  expect_quantity("(4 m^2)^0.5", 2, STRUT_DIM_LENGTH);
  expect_quantity("(8 m^3)^(1/3)", pow(8, 1.0 / 3), STRUT_DIM_LENGTH);
  expect_quantity("sqrt(1000 N/m / (10 kg))", 10, STRUT_DIM_FREQUENCY);
  expect_quantity("hypot(3 mm, 4 mm)", hypot(0.003, 0.004), STRUT_DIM_LENGTH);
  expect_quantity("min(1 m, 50 cm)", 0.5, STRUT_DIM_LENGTH);
  expect_quantity("max(1 mm, 0)", 0.001, STRUT_DIM_LENGTH);
  expect_quantity("abs(-1 m)", 1, STRUT_DIM_LENGTH);
  expect_quantity("exp(1 m / (1 m))", exp(1), STRUT_DIM_NONE);
  expect_bare("0.1*cos(60 deg)", 0.1 * cos(3.14159265358979323846 / 3));
}
