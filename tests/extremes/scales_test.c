/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Far from the origin, parameters of any size, a ratio of 1e12, and motion that dies into the smallest numbers. */
#include <gsl/gsl_errno.h>

#include "engine/scene/checks/check.h"
#include "tests/support/random.h"
#include "tests/support/structures.h"

static strut_setup shaken_frame(double shift) {
  const x_frame frame = {1, 60, .cable = {800, 0.3, 0.05}, .bar = {2000, 0.3, 0.1}};
  strut_setup setup = build_setup();
  structure_x_frame(&setup.scene, &frame);
  for (size_t j = 0; j < setup.scene.member_count; j++) setup.scene.members[j].kind = STRUT_SPRING;
  structure_throw(&setup.scene, 0.5, 0.25, 2);
  setup.scene.nodes[0].velocity[0] += 5;
  for (size_t i = 0; i < setup.scene.node_count; i++)
    setup.scene.nodes[i].position[0] += shift, setup.scene.nodes[i].start[0] += shift;
  return setup;
}

/* Each step rounds a position by half of 1.2e-10 m out there. */
BEFORE_ALL {
  gsl_set_error_handler_off(); /* as the program does: GSL reports by its return values */
}

TEST(a_million_metres_from_the_origin) {
  static const char *const methods[] = {"rk4", "verlet-events", "adaptive"};
  for (int k = 0; k < 3; k++) {
    double worst = 0;
    OWN(strut_setup) near = shaken_frame(0);
    OWN(strut_setup) far = shaken_frame(1e6);
    OWN(motion) a = motion_begin_by(&near, methods[k], 1e-3);
    OWN(motion) b = motion_begin_by(&far, methods[k], 1e-3);
    motion_steps(&a, 1000);
    motion_steps(&b, 1000);
    for (int i = 0; i < 8; i++)
      worst = fmax(worst, fabs(b.state->q[i] - (i % 2 ? 0 : 1e6) - a.state->q[i]));
    print_message("%s, 1e6 m from the origin: 1 m off by %.1e m after 1 s\n", methods[k], worst);
    assert_true(worst <= 1e-8);
  }
}

static double any(uint64_t *r) {
  if (random_once_in(r, 2)) return random_scale(r, 0.01, 100);
  double most = exp(random_between(r, -690, 690)); /* 1e-300 .. 1e300 */
  return random_once_in(r, 20) ? 0 : most;
}

static double either(uint64_t *r) { return random_once_in(r, 2) ? any(r) : -any(r); }

static strut_setup wild_scene(uint64_t seed) {
  uint64_t state = seed, *r = &state;
  int32_t nodes = 2 + random_below(r, 4);
  strut_setup setup = build_setup();
  setup.scene.mass_model = random_once_in(r, 2) ? STRUT_MASS_LUMPED : STRUT_MASS_CONSISTENT;
  for (int32_t i = 0; i < nodes; i++) {
    double mass = any(r), y = either(r), x = either(r);
    build_mass(&setup.scene, x, y, mass);
    for (int c = 0; c < 2; c++) {
      setup.scene.nodes[i].fixed[c] = random_once_in(r, 4);
      if (random_once_in(r, 3)) setup.scene.nodes[i].velocity[c] = either(r);
    }
  }
  for (int32_t j = 1; j < nodes; j++) {
    double rest = any(r), mass = any(r), damping = any(r), stiffness = any(r);
    int32_t from = random_below(r, j), kind = random_below(r, 3);
    build_sized(&setup.scene, (strut_member_kind)kind, from, j, stiffness, damping, mass, rest);
  }
  setup.scene.gravity[1] = -any(r);
  for (int32_t i = 0; i < nodes && random_once_in(r, 2); i++) {
    double width = any(r), mu_kinetic = any(r), mu_static = any(r), damping = any(r);
    build_rough_contact(&setup.scene, i, any(r), damping, mu_static, mu_kinetic, width);
    if (random_once_in(r, 2)) setup.scene.contacts[i].friction.law = STRUT_FRICTION_COULOMB;
  }
  setup.scene.ground.height = either(r);
  if (random_once_in(r, 2)) setup.scene.ground.belt_speed = either(r);
  const strut_integrator *method = NULL;
  size_t methods = 0;
  while (strut_integrator_at(methods)) methods++;
  do /* those that choose their steps take as many as such numbers need */
    method = strut_integrator_at((size_t)random_below(r, (int32_t)methods));
  while (strut_integrator_controls_error(method));
  setup.experiment.integrator = method->name;
  setup.experiment.refine = 1;
  setup.experiment.step = any(r);
  setup.experiment.duration = setup.experiment.step * 50;
  return setup;
}

typedef struct tally {
  int invalid, refused, stopped, answered;
} tally;

static void run_wild(uint64_t seed, tally *t) {
  strut_findings findings = {0};
  OWN_POINTER(strut_model) model = NULL;
  strut_error error = {0};
  OWN(strut_setup) setup = wild_scene(seed);
  strut_status status = strut_setup_check(&setup, STRUT_FOR_RUN, &findings);
  bool valid = !status && !findings.count;
  if (status && findings.count) assert_true(strlen(findings.items[0].message) > 10);
  strut_findings_free(&findings);
  t->invalid += !valid;
  if (valid) {
    status = strut_model_compile(&setup.scene, &model, &error);
    if (status) {
      t->refused++;
      assert_true(strlen(error.message) > 10);
    } else {
      strut_run_options options = {.force = seed % 2};
      OWN(strut_summary) s = {0};
      status = strut_simulate(model, &setup.experiment, &options, &s, &error);
      if (status) assert_true(strlen(error.message) > 10);
      *(!status ? &t->answered : s.spent.steps ? &t->stopped : &t->refused) += 1;
      for (size_t i = 0; !status && i < 2 * s.end.node_count; i++)
        assert_true(isfinite(s.end.positions[i]));
    }
  }
}

TEST(parameters_of_any_size) {
  tally t = {0};
  for (uint64_t seed = 1; seed <= 4000; seed++) run_wild(seed, &t);
  print_message("1e-300 to 1e300: %d invalid, %d refused, %d stopped with a sentence, %d answers\n",
                t.invalid, t.refused, t.stopped, t.answered);
  assert_true(t.answered > 100 && t.refused > 100);
}

/* Support - 1e12 N/m - 1 kg - 1 N/m - 1 kg: the slow mode from its end to its middle, in steps
   that the fast one bears. */
TEST(dynamics_of_a_stiffness_ratio) {
  const double stiff = 1e12, soft = 1, pi = 3.14159265358979323846;
  double sum = stiff + 2 * soft, product = stiff * soft;
  double omega = sqrt(2 * product / (sum + sqrt(sum * sum - 4 * product)));
  int64_t steps = 2600000;
  double period = 2 * pi / omega, ratio = soft / (stiff + soft - omega * omega);
  OWN(strut_scene) scene = build_scene();
  build_support(&scene, 0, 0);
  build_mass(&scene, 1, 0, 1);
  build_mass(&scene, 2, 0, 1);
  build_member(&scene, STRUT_BAR, 0, 1, stiff, 0, 0);
  build_member(&scene, STRUT_SPRING, 1, 2, soft, 0, 0);
  scene.nodes[1].start[0] = 1 + 0.25 * ratio, scene.nodes[2].start[0] = 2.25;
  OWN(motion) m = motion_begin(&scene, period / (double)steps);
  motion_steps(&m, steps / 4 * 5);
  print_message("1e12 against 1 N/m: off by %.1e m after 5/4 periods of %lld steps\n",
                fabs(m.state->q[4] - 2), (long long)steps);
  assert_near(m.state->q[4], 2, 1e-9);
  assert_near(m.state->q[2], 1, 1e-12);
}

/* The least of several times that a run of so many steps takes. */
static double time_of(strut_setup *setup, const char *method, int steps) {
  double least = HUGE_VAL;
  setup->experiment.integrator = method;
  motion_experiment(setup, 1e-3, steps * 1e-3);
  for (int k = 0; k < 7; k++) {
    double begin = test_seconds();
    OWN(strut_summary) s = motion_simulate(setup);
    least = fmin(least, test_seconds() - begin);
  }
  return least;
}

/* A damped row of springs without rest length about its support: it decays to zero itself. */
static strut_setup dying(double amplitude) {
  strut_setup setup = build_setup();
  build_support(&setup.scene, 0, 0);
  for (int32_t i = 1; i <= 12; i++) {
    build_mass(&setup.scene, 0, 0, 1);
    setup.scene.nodes[i].start[0] = amplitude * i, setup.scene.nodes[i].start[1] = -amplitude;
    build_sized(&setup.scene, STRUT_SPRING, i - 1, i, 100, 0.01, 0.1, 0);
  }
  return setup;
}

/* Amplitudes whose squares, or which themselves, are subnormal. */
TEST(motion_that_dies_is_not_slow) {
  static const char *const methods[] = {"rk4", "rk4-events", "verlet-events"};
  static const double amplitude[] = {1, 1e-154, 1e-158, 1e-161, 1e-308, 1e-312, 1e-320};
  for (int k = 0; k < 3; k++) {
    double alive = 0, slowest = 0;
    for (int i = 0; i < 7; i++) {
      OWN(strut_setup) setup = dying(amplitude[i]);
      double seconds = time_of(&setup, methods[k], 4000);
      *(i ? &slowest : &alive) = fmax(i ? slowest : 0, seconds);
    }
    print_message("%s: subnormal motion takes %.2f times as long\n", methods[k], slowest / alive);
    assert_true(slowest <= 2 * alive);
  }
}
