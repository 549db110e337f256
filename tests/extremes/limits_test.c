/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beside the largest stable step: growth per step, from the motion, against the method's theory. */
#include <complex.h>

#include "tests/support/motion.h"
#include "tests/support/widening.h"

/* A method on x'' = -2 zeta w x' - w^2 x maps (x, x') linearly; z = w dt. */
typedef struct map {
  double trace, determinant;
} map;

static map rk4_map(double zeta, double z) {
  double complex root = csqrt(zeta * zeta - 1), r[2];
  for (int k = 0; k < 2; k++) {
    double complex y = z * (-zeta + (k ? -root : root));
    r[k] = 1 + y * (1 + y / 2 * (1 + y / 3 * (1 + y / 4)));
  }
  return (map){creal(r[0] + r[1]), creal(r[0] * r[1])};
}

/* v += dt a(x, v), x += dt v */
static map euler_map(double zeta, double z) {
  return (map){2 - 2 * zeta * z - z * z, 1 - 2 * zeta * z};
}

/* Without damping. */
static map verlet_map(double zeta, double z) {
  (void)zeta;
  return (map){2 - z * z, 1};
}

static double growth(map m) {
  double square = m.trace * m.trace / 4 - m.determinant;
  return square < 0 ? sqrt(m.determinant) : fabs(m.trace / 2) + sqrt(square);
}

typedef struct explicit_method {
  const char *name;
  map (*map)(double zeta, double z);
  bool damped; /* damping enters this map */
} explicit_method;

static const explicit_method METHODS[] = {{"rk4", rk4_map, true},
                                          {"rk4-events", rk4_map, true},
                                          {"euler-events", euler_map, true},
                                          {"verlet-events", verlet_map, false}};
enum { METHOD_COUNT = sizeof METHODS / sizeof METHODS[0] };

static const double K = 300, MASS = 0.7;

static strut_setup oscillator(double zeta) {
  strut_setup setup = build_tethered(1, 0, MASS);
  /* of rest length zero, so that it is linear at any amplitude */
  build_sized(&setup.scene, STRUT_SPRING, 0, 1, K, 2 * zeta * sqrt(K * MASS), 0, 0);
  setup.scene.nodes[1].velocity[0] = 6.5;
  setup.scene.nodes[1].fixed[1] = true;
  return setup;
}

/* The largest z with growth 1, from the map alone: by doubling and halving. */
static double limit_of(const explicit_method *method, double zeta) {
  double low = 1e-3, high = 4;
  for (double z = low; z < high; z *= 1.001) /* the first step that grows */
    if (growth(method->map(zeta, z)) > 1 + 1e-12) {
      high = z;
      break;
    }
  low = high / 1.001;
  for (int k = 0; k < 60; k++) {
    double middle = 0.5 * (low + high);
    *(growth(method->map(zeta, middle)) > 1 + 1e-15 ? &high : &low) = middle;
  }
  return low;
}

/*
 * The map that the engine applied: its trace and determinant from two neighbouring pairs of states,
 * [s1 s2] = A [s0 s1] with s = (x, v).
 */
static map measured(double s[3][2]) {
  double base = s[0][0] * s[1][1] - s[0][1] * s[1][0];
  double next = s[1][0] * s[2][1] - s[1][1] * s[2][0];
  double cross = s[0][0] * s[2][1] - s[0][1] * s[2][0];
  return (map){cross / base, next / base};
}

static void check_growth(const explicit_method *method, double zeta, double part) {
  const double omega = sqrt(K / MASS);
  double z = part * limit_of(method, zeta), expected = growth(method->map(zeta, z));
  OWN(strut_setup) setup = oscillator(zeta);
  OWN(motion) m = motion_begin_by(&setup, method->name, z / omega);
  double worst = 0;
  for (int n = 0; n < 12; n++) {
    double s[3][2];
    for (int k = 0; k < 3; k++) {
      s[k][0] = m.state->q[2], s[k][1] = m.state->v[2];
      if (k < 2) motion_steps(&m, 1);
    }
    worst = fmax(worst, fabs(growth(measured(s)) - expected));
  }
  print_message("%s, damping ratio %g, %.2f of the limit: growth %.6f, off by %.1e\n", method->name,
                zeta, part, expected, worst);
  assert_all(part < 1 ? expected < 1 + 1e-15 : expected > 1.001, worst <= 1e-6);
}

TEST(growth_beside_the_limit) {
  static const double zeta[] = {0, 0.1, 1, 10};
  for (int k = 0; k < METHOD_COUNT; k++)
    for (int i = 0; i < (METHODS[k].damped ? 4 : 1); i++) {
      check_growth(&METHODS[k], zeta[i], 0.99);
      check_growth(&METHODS[k], zeta[i], 1.01);
    }
}
