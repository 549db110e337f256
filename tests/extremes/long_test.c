/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Very many steps: energy, clock and memory. The number of steps is the program's argument. */
#include "engine/forces/forces.h"
#include "tests/support/allocations.h"
#include "tests/support/motion.h"
#include "tests/support/widening.h"

static int64_t steps = 1000000;
static const double K = 300, MASS = 0.7;

static strut_setup oscillator(void) {
  strut_setup setup = build_tethered(1, 0, MASS);
  build_member(&setup.scene, STRUT_SPRING, 0, 1, K, 0, 0);
  setup.scene.nodes[1].start[0] = 1.25, setup.scene.nodes[1].velocity[0] = 1.5;
  return setup;
}

static double energy(const motion *m) {
  strut_energies e = strut_energy_evaluate(m->model, m->state, 0);
  return e.kinetic + e.elastic;
}

BEFORE_ALL { steps = (int64_t)test_number(1, (double)steps); }

/* RK4 keeps 1 - z^6/72 + z^8/576 of the energy per step, exactly. */
TEST(energy_of_rk4) {
  static const double zs[] = {0.01, 0.1};
  for (int k = 0; k < 2; k++) {
    double z = zs[k];
    OWN(strut_setup) setup = oscillator();
    OWN(motion) m = motion_begin(&setup.scene, z / sqrt(K / MASS));
    motion_steps(&m, 10);
    double before = energy(&m);
    uint64_t calls = allocations_so_far();
    long memory = resident();
    motion_steps(&m, steps);
    assert_all(allocations_so_far() == calls, resident() == memory);
    double per_step = -pow(z, 6) / 72 + pow(z, 8) / 576, ratio = energy(&m) / before;
    double expected = exp((double)steps * log1p(per_step));
    print_message("rk4, z = %g, %lld steps: energy %.12f, theory %.12f\n", z, (long long)steps,
                  ratio, expected);
    assert_relative(ratio, expected, 1e-9);
  }
}

/* Verlet's energy stays within z^2 / 4 of what it was, for ever. */
TEST(energy_of_verlet) {
  double z = 0.1, low = HUGE_VAL, high = 0;
  OWN(strut_setup) setup = oscillator();
  OWN(motion) m = motion_begin_by(&setup, "verlet-events", z / sqrt(K / MASS));
  double before = energy(&m);
  for (int part = 0; part < 2000; part++) {
    motion_steps(&m, part % 20 ? 1 : steps / 100 - 19); /* in every phase of a period */
    low = fmin(low, energy(&m) / before), high = fmax(high, energy(&m) / before);
  }
  assert_int_equal(m.state->step, steps);
  print_message("verlet, z = %g, %lld steps: energy from %.6f to %.6f of the first\n", z,
                (long long)steps, low, high);
  assert_within(low, 1 - z * z / 4, 1 + z * z / 4);
  assert_within(high, 1 - z * z / 4, 1 + z * z / 4);
  assert_true(high - low > z * z / 8); /* so that the bound means something */
}

/* The drive tells the time: its phase after so many steps of 1e-4 s, whose sum would drift. */
TEST(the_clock) {
  const double frequency = 12.70003, amplitude = 0.01, dt = 1e-4, pi = 3.14159265358979323846;
  OWN(strut_setup) setup = oscillator();
  build_actuator(&setup.scene, 0, build_sine(&setup.scene, amplitude, frequency));
  OWN(motion) m = motion_begin(&setup.scene, dt);
  motion_steps(&m, steps);
  long double turns = (long double)frequency * ((long double)steps / 10000);
  double angle = (double)(2 * acosl(-1) * (turns - floorl(turns)));
  double sine =
      (m.state->latest->rest[0] - 1) / amplitude; /* of the last stage, at the end of the step */
  double rate = 2 * pi * frequency * cos(angle);
  assert_true(fabs(cos(angle)) > 0.05);
  double late = (sine - sin(angle)) / rate;
  print_message("after %.0f s the clock is off by %.1e s\n", (double)steps * dt, late);
  assert_true(fabs(late) < 1e-9);
}
