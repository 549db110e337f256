/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Expressions: values, units, dimensions. */
#include "tests/support/test.h"
#include "tests/unit/expression_support.h"

static const strut_dimension AREA = {0, 2, 0, 0};

TEST(plain_numbers_are_bare) {
  EXPECT_BARE("0 = 0", "1.5 = 1.5", "-1.5e-3 = -1.5e-3", "+.5 = 0.5", " 2  = 2", "10 % = 0.1",
              "10% = 0.1", "35 percent = 0.35", "two = 2");
}

TEST(operators_bind_as_in_mathematics) {
  EXPECT_BARE("1 + 2*3 = 7", "(1 + 2)*3 = 9", "8/4/2 = 1", "8 - 4 - 2 = 2", "2^3^2 = 512",
              "-2^2 = -4", "(-2)^2 = 4", "2^-2 = 0.25", "2^+2 = 4", "-2^-2 = -0.25", "--2 = 2",
              "2--2 = 4", "2*-3 = -6", "2*3^2 = 18", "(-1)^0 = 1", "7 - 2*3 + 4/2 = 3",
              "\t1\n+\r2 = 3", "pi = 3.14159265358979323846", "2*pi = 6.28318530717958647692");
}

TEST(functions_have_their_values) {
  EXPECT_BARE("sin(pi/2) = 1", "cos(0) = 1", "cos(1 turn) = 1", "sqrt(16) = 4", "log(exp(2)) = 2",
              "log10(1000) = 3", "abs(-3) = 3", "min(3, 1, 2) = 1", "max(3, 1, 2, 5) = 5",
              "floor(-1.5) = -2", "ceil(-1.5) = -1", "round(2.5) = 3", "hypot(3, 4) = 5");
  expect_bare("sin(30 deg)", sin(3.14159265358979323846 / 6));
  expect_bare("tan(0.5 rad)", tan(0.5));
  expect_bare("exp(1)", exp(1));
  expect_quantity("asin(1)", asin(1), STRUT_DIM_ANGLE);
  expect_quantity("acos(0.5)", acos(0.5), STRUT_DIM_ANGLE);
  expect_quantity("atan(1)", atan(1), STRUT_DIM_ANGLE);
  expect_quantity("atan2(1, -1)", atan2(1, -1), STRUT_DIM_ANGLE);
  expect_quantity("atan2(1 mm, 2 mm)", atan2(1, 2), STRUT_DIM_ANGLE);
}

/* The bits are those of the SI number that a person would write. */
TEST(units_scale_exactly) {
  EXPECT_QUANTITIES(STRUT_DIM_FREQUENCY, "10 Hz = 10", "10Hz = 10");
  EXPECT_QUANTITIES(STRUT_DIM_LENGTH, "0.1 mm = 0.0001", "96.51 mm = 0.09651", "23.87 mm = 0.02387",
                    "1e3mm = 1");
  EXPECT_QUANTITIES(STRUT_DIM_TIME, "0.1 ms = 1e-4", "2 min = 120", "1 h = 3600",
                    "1 / (1000 * f) = 1e-4");
  expect_quantity("100 g", 0.1, STRUT_DIM_MASS);
  EXPECT_QUANTITIES(STRUT_DIM_STIFFNESS, "20 N/cm = 2000", "0.3 N/mm = 300");
  expect_quantity("0.1 mm/s", 1e-4, STRUT_DIM_VELOCITY);
  expect_quantity("180 deg", 3.14159265358979323846, STRUT_DIM_ANGLE);
  expect_quantity("10 rad/s", 10, (strut_dimension){0, 0, -1, 1});
  EXPECT_QUANTITIES(STRUT_DIM_FORCE, "1 kg*m/s^2 = 1", "1 kg m s^-2 = 1");
  EXPECT_QUANTITIES(AREA, "1 cm^2 = 1e-4", "1 m ^ 2 = 1");
  expect_quantity("60 km/h", 60000.0 / 3600, STRUT_DIM_VELOCITY);
  expect_quantity("9.81 m / min^2", 9.81 / 3600, STRUT_DIM_ACCELERATION);
}

TEST(units_end_where_an_operator_begins) {
  EXPECT_QUANTITIES(STRUT_DIM_FORCE, "10 N/2 = 5", "10 N*two = 20", "10 N * min(1, 2) = 10",
                    "10 N * (t) = 30");
  expect_quantity("10 N/(2 m)", 5, STRUT_DIM_STIFFNESS);
  EXPECT_QUANTITIES(STRUT_DIM_LENGTH, "2*a + 0.1 mm = 0.0041", "-2 m = -2", "3 m^2/m = 3",
                    "1 m - 1 mm = 0.999");
  expect_quantity("5 t", 5000, STRUT_DIM_MASS); /* a parameter t cannot stand there */
}

TEST(dimensions_follow_the_operators) {
  EXPECT_QUANTITIES(STRUT_DIM_LENGTH, "1 m + 2 = 3", "2 - 1 m = 1", "2 * 3 m = 6");
  expect_quantity("1 / f", 0.1, STRUT_DIM_TIME);
  expect_quantity("a * f", 0.02, STRUT_DIM_VELOCITY);
}

TEST(division_reads_its_literal_whole) {
  expect_quantity("1 m / (2 m)", 0.5, STRUT_DIM_NONE);
  expect_quantity("(1 m) / 2 m", 0.5, STRUT_DIM_NONE); /* a literal owns its unit */
  EXPECT_QUANTITIES(STRUT_DIM_LENGTH, "sqrt(4 m^2) = 2", "(4 m^2)^0.5 = 2", "min(1 m, 50 cm) = 0.5",
                    "max(1 mm, 0) = 0.001", "abs(-1 m) = 1");
  expect_quantity("(2 m)^2", 4, AREA);
  expect_quantity("sqrt(1000 N/m / (10 kg))", 10, STRUT_DIM_FREQUENCY);
  expect_quantity("(8 m^3)^(1/3)", pow(8, 1.0 / 3), STRUT_DIM_LENGTH);
  expect_quantity("hypot(3 mm, 4 mm)", hypot(0.003, 0.004), STRUT_DIM_LENGTH);
  expect_quantity("exp(1 m / (1 m))", exp(1), STRUT_DIM_NONE);
  expect_bare("0.1*cos(60 deg)", 0.1 * cos(3.14159265358979323846 / 3));
}
