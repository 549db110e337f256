/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What RK4 makes of an undamped oscillation, exactly.
 */
#pragma once

#include <complex.h>
#include <math.h>
#include <stdint.h>

#include "tests/support/widening.h"

/**
 * R(iz)^n with R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24 and z = step * angular frequency: after n steps
 * from displacement x0 and velocity v0 the displacement is re x0 + im v0 / w, and the velocity
 * re v0 - im w x0.
 */
static inline void rk4_oscillation(double z, int64_t n, double *re, double *im) {
  long double y = z, x2 = y * y;
  long double complex growth =
      (1 - x2 / 2 + x2 * x2 / 24) + (y - y * x2 / 6) * (long double complex)I;
  long double complex power = 1;
  for (; n > 0; n >>= 1, growth *= growth)
    if (n & 1) power *= growth;
  *re = (double)creall(power);
  *im = (double)cimagl(power);
}
