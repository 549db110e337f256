/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sine and cosine of turns against the C library's long double; the largest of some numbers. */
#include "engine/base/vec.h"
#include "tests/support/check.h"
#include "tests/support/random.h"
#include "tests/support/widening.h"

static const double BOUND = 1.5 * 0x1p-52; /* units in the last place of 1 */

/* The turn is reduced in long double, exactly, before it becomes an angle. */
static void check(double turns) {
  double sine, cosine;
  long double rest = turns - floorl(turns + 0.5L), angle = 2 * acosl(-1) * rest;
  strut_sincos_turns(turns, &sine, &cosine);
  assert_all_near(BOUND, sine, (double)sinl(angle), cosine, (double)cosl(angle));
  assert_near(sine * sine + cosine * cosine, 1, 4 * BOUND);
}

TEST(random_turns) {
  uint64_t r = 1;
  for (int i = 0; i < 200000; i++) {
    check(random_between(&r, -1, 1));
    check(random_between(&r, -1e3, 1e3));
    check(random_between(&r, -1e9, 1e9));
    check(random_scale(&r, 1e-300, 1));
    check(-random_scale(&r, 1, 0x1p52));
  }
}

/* About the places where the quadrant changes. */
TEST(quadrant_borders) {
  for (int eighth = -40; eighth <= 40; eighth++)
    for (int k = -3; k <= 3; k++) {
      double turns = eighth / 8.0, step = k < 0 ? -HUGE_VAL : HUGE_VAL;
      for (int n = 0; n < (k < 0 ? -k : k); n++) turns = nextafter(turns, step);
      check(turns);
    }
}

TEST(quarter_turns_are_exact) {
  static const double sines[] = {0, 1, 0, -1};
  for (int quarter = -4000; quarter < 4000; quarter++) {
    double sine, cosine;
    strut_sincos_turns(quarter / 4.0, &sine, &cosine);
    assert_all(sine == sines[(quarter + 4000) % 4], cosine == sines[(quarter + 4001) % 4]);
  }
}

/* A drive must not drift, however long it runs: whole turns fall away exactly. */
TEST(whole_turns_change_nothing) {
  for (double whole = 1; whole < 0x1p44; whole *= 2)
    for (int k = 0; k < 64; k++) {
      double turns = k / 64.0, s1, c1, s2, c2;
      strut_sincos_turns(turns, &s1, &c1);
      strut_sincos_turns(turns + whole, &s2, &c2);
      assert_all_near(2 * BOUND, s2, s1, c2, c1);
    }
}

TEST(the_sine_is_odd_and_the_cosine_even) {
  uint64_t r = 2;
  for (int i = 0; i < 100000; i++) {
    double turns = random_between(&r, -100, 100), s1, c1, s2, c2;
    strut_sincos_turns(turns, &s1, &c1);
    strut_sincos_turns(-turns, &s2, &c2);
    assert_true(s1 == -s2 && c1 == c2);
  }
}

TEST(huge_turns_stay_within_one) {
  for (double turns = 1; turns < 1e300; turns *= 3.7)
    for (int sign = -1; sign <= 1; sign += 2) {
      double sine, cosine;
      strut_sincos_turns(sign * turns, &sine, &cosine);
      assert_true(fabs(sine) <= 1 && fabs(cosine) <= 1);
      assert_near(sine * sine + cosine * cosine, 1, 4 * BOUND);
    }
}

TEST(largest_magnitude_keeps_what_is_no_number) {
  const double plain[] = {1, -3, 2}, poisoned[] = {1, (double)NAN, 2};
  assert_all(strut_largest_magnitude(plain, 3) == 3, strut_largest_magnitude(plain, 0) == 0);
  assert_true(isnan(strut_largest_magnitude(poisoned, 3)));
}
