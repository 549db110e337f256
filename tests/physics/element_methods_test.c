/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Random scenes of hinges, running cables, laws and stops by every method with events: they agree with
 * each other as their steps promise, and their energy balances close.
 */
#include <math.h>
#include <string.h>

#include "tests/physics/random_elements.h"
#include "tests/support/build.h"
#include "tests/support/check.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

enum { SCENES = 30, MOST = 16 };

/* Thrown, heavy and driven: a member by its rest length and a hinge by its rest angle. */
static void make(strut_setup *setup, uint64_t seed, double damping) {
  uint64_t r = seed + 5;
  strut_setup_init(setup);
  strut_scene *scene = &setup->scene;
  random_elements(scene, seed, damping);
  scene->gravity[1] = -3;
  for (size_t i = 1; i < scene->node_count; i++)
    for (int c = 0; c < 2; c++) scene->nodes[i].velocity[c] = random_between(&r, -0.5, 0.5);
  int32_t slow = build_sine(scene, 0.05, 1), slower = build_sine(scene, 0.2, 0.7);
  build_actuator(scene, (int32_t)scene->node_count, slow); /* the running cable */
  int32_t i = build_actuator(scene, -1, slower);
  scene->actuators[i].hinge = 0;
}

typedef struct outcome {
  double q[MOST], residual, moved, lost;
  int64_t events;
} outcome;

static outcome run(uint64_t seed, double damping, const char *method, double step,
                   double tolerance) {
  strut_setup setup;
  outcome o = {.events = 0};
  make(&setup, seed, damping);
  motion_experiment(&setup, step, 0.8);
  setup.experiment.integrator = method;
  setup.experiment.tolerance = tolerance;
  strut_summary s = motion_simulate(&setup);
  assert_true(2 * s.end.node_count <= MOST);
  memcpy(o.q, s.end.positions, 2 * s.end.node_count * sizeof *o.q);
  o.residual = s.energy.residual, o.moved = s.energy.moved;
  o.lost = s.energy.dissipated_members, o.events = s.spent.events;
  strut_summary_free(&s);
  strut_setup_free(&setup);
  return o;
}

static double distance(const outcome *a, const outcome *b) {
  double most = 0;
  for (int i = 0; i < MOST; i++) most = fmax(most, fabs(a->q[i] - b->q[i]));
  return most;
}

/* Errors of one method, in all scenes, at a step and at half of it. */
typedef struct method {
  const char *name;
  double step, tolerance;
  double most,
      least_gain; /* error at that step [m]; and the mean factor by which half a step is better */
} method;

TEST(methods_agree) {
  static const method methods[] = {{"rk4-events", 1e-3, 1e-6, 2e-5, 5},
                                   {"verlet-events", 1e-3, 1e-6, 2e-3, 2.5},
                                   {"adaptive", 1e-2, 1e-8, 1e-5, 0},
                                   {"rk4", 2.5e-4, 1e-6, 5e-3, 0},
                                   {"midpoint", 1e-3, 1e-6, 1e-2, 1.5}};
  int64_t events = 0;
  for (size_t m = 0; m < sizeof methods / sizeof methods[0]; m++) {
    const method *by = &methods[m];
    double worst = 0, gain = 0;
    for (uint64_t seed = 0; seed < SCENES; seed++) {
      outcome exact = run(seed, 1, "adaptive", 1e-2, 1e-11);
      outcome whole = run(seed, 1, by->name, by->step, by->tolerance);
      outcome half = run(seed, 1, by->name, by->step / 2, by->tolerance);
      double error = distance(&whole, &exact), better = distance(&half, &exact);
      if (error > by->most) print_error("%s, seed %d: %g\n", by->name, (int)seed, error);
      worst = fmax(worst, error);
      gain += log(fmax(error, 1e-12) / fmax(better, 1e-12)) / SCENES;
      events += exact.events;
    }
    print_message("%s: error %.2g, half a step %.2f times better\n", by->name, worst, exp(gain));
    assert_true(worst < by->most);
    assert_true(exp(gain) > by->least_gain);
  }
  assert_true(events > 5 * SCENES);
}

TEST(energy_balances_close) {
  static const method methods[] = {{"rk4-events", 1e-3, 1e-6, 2e-5, 0},
                                   {"verlet-events", 1e-3, 1e-6, 1e-3, 0},
                                   {"adaptive", 1e-2, 1e-8, 2e-5, 0},
                                   {"midpoint", 1e-3, 1e-6, 1e-8, 0}};
  for (size_t m = 0; m < sizeof methods / sizeof methods[0]; m++)
    for (int damped = 0; damped < 2; damped++) {
      double worst = 0;
      for (uint64_t seed = 0; seed < SCENES; seed++) {
        outcome o = run(seed, damped, methods[m].name, methods[m].step, methods[m].tolerance);
        double part = fabs(o.residual) / o.moved;
        if (part > methods[m].most)
          print_error("%s, seed %d, damping %d: %g\n", methods[m].name, (int)seed, damped, part);
        worst = fmax(worst, part);
        if (!damped) assert_near(o.lost / o.moved, 0, methods[m].most);
      }
      print_message("%s, damping %d: residual %.2g\n", methods[m].name, damped, worst);
      assert_true(worst < methods[m].most);
    }
}
