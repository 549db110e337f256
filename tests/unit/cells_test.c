/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws of cells: force, slope and drive against differences of the energy; a cell of a scene. */
#include "engine/scene/law.h"
#include "tests/support/check.h"

static const strut_law_numbers numbers = {.area = 2.0, .exponent = 1.4, .outside = 3.0};

static double energy(strut_law_kind kind, double e, double e0) {
  return strut_law_respond(kind, &numbers, e, e0, -1).energy;
}

static double force(strut_law_kind kind, double e, double e0) {
  return strut_law_respond(kind, &numbers, e, e0, -1).force;
}

/* Richardson's extrapolation of a central difference. */
static double slope_of(double (*f)(strut_law_kind, double, double), strut_law_kind kind, double e,
                       double e0, bool over_area) {
  double d[2], h = 1e-3 * (over_area ? e : e0);
  for (int k = 0; k < 2; k++, h /= 2)
    d[k] = over_area ? (f(kind, e + h, e0) - f(kind, e - h, e0)) / (2 * h)
                     : (f(kind, e, e0 + h) - f(kind, e, e0 - h)) / (2 * h);
  return (4 * d[1] - d[0]) / 3;
}

TEST(force_is_the_slope_of_the_energy) {
  for (int kind = STRUT_LAW_PRESSURE; kind < STRUT_LAW_COUNT; kind++) {
    assert_near(energy((strut_law_kind)kind, 2, 5), 0, 1e-15);
    for (double e = 0.1; e < 20; e *= 1.37)
      for (double e0 = 0.5; e0 < 50; e0 *= 3.1) {
        strut_law_kind k = (strut_law_kind)kind;
        strut_law_response at = strut_law_respond(k, &numbers, e, e0, -1);
        double scale = fabs(at.force) + fabs(at.energy) + e0;
        assert_near(at.force, slope_of(energy, k, e, e0, true), 1e-9 * scale / e);
        assert_near(at.slope, slope_of(force, k, e, e0, true), 1e-9 * scale / e);
        assert_near(at.excess, slope_of(energy, k, e, e0, false), 1e-9 * scale);
      }
  }
}

/* With next to no area left the force goes straight on, and pushes ever more. */
TEST(a_collapsed_gas_stays_finite) {
  for (int kind = STRUT_LAW_ISOTHERMAL; kind < STRUT_LAW_COUNT; kind++) {
    strut_law_kind k = (strut_law_kind)kind;
    double least = STRUT_CELL_COLLAPSED * numbers.area, h = 1e-9;
    assert_relative(force(k, least - h, 5), force(k, least + h, 5), 1e-5);
    assert_relative(energy(k, least - h, 5), energy(k, least + h, 5), 1e-6);
    for (double e = least; e > -5; e -= 0.1) {
      assert_true(isfinite(force(k, e, 5)) && isfinite(energy(k, e, 5)));
      assert_true(force(k, e - 0.1, 5) < force(k, e, 5));
      assert_true(energy(k, e - 0.1, 5) > energy(k, e, 5));
    }
  }
}
