/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The largest stable step: RK4's own limits, closed forms of structures, and the truth of it. */
#include "engine/integrate/limit/step_limit.h"

#include "tests/physics/random_scene.h"
#include "tests/support/structures.h"

static const double PI = 3.14159265358979323846, IMAGINARY = 2.8284271247461903;

TEST(limits_on_the_axes) {
  assert_all_relative(1e-9, strut_rk4_limit(0, 1), IMAGINARY, strut_rk4_limit(0, -250),
                      IMAGINARY / 250, strut_rk4_limit(-1, 0), 2.7852935634);
  assert_relative(strut_rk4_limit(-4e5, 0), 2.7852935634 / 4e5, 1e-9);
  assert_true(isinf(strut_rk4_limit(0, 0)));
  assert_true(isinf(strut_rk4_limit(3, 0))); /* grows by itself, whatever the step */
}

/* Largest stable w h of a damped mode: measured, to the digits given. */
TEST(limits_of_damped_modes) {
  static const double known[][2] = {{0.01, 2.8486}, {0.05, 2.9098}, {0.1, 2.9509}, {0.2, 2.9401},
                                    {0.3, 2.8353},  {0.5, 2.6225},  {0.7, 2.6980}, {1, 2.7853}};
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
    double zeta = known[i][0];
    assert_near(strut_rk4_limit(-zeta, sqrt(1 - zeta * zeta)), known[i][1], 6e-5);
  }
}

static strut_step_limit limit_of(const strut_setup *setup) {
  strut_step_limit limit;
  OWN_POINTER(strut_model) model = motion_compile(&setup->scene);
  assert_ok(strut_step_limit_estimate(model, &limit, NULL));
  return limit;
}

/* One mass on a damped spring, and one on damped ground. */
TEST(limit_of_a_damped_oscillator) {
  static const double known[][2] = {{0, 2.8284271},  {0.2, 2.9401},   {0.5, 2.6225},
                                    {2, 0.74631717}, {10, 0.1396135}, {100, 0.013926816}};
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
    for (int grounded = 0; grounded < 2; grounded++) {
      const double k = 900, mass = 4, omega = 15;
      OWN(strut_setup) setup = build_setup();
      build_mass(&setup.scene, 1, 0.5, mass);
      double damping = known[i][0] * 2 * sqrt(k * mass);
      if (grounded)
        build_contact(&setup.scene, 0, k, damping);
      else
        build_member(&setup.scene, STRUT_SPRING, build_support(&setup.scene, 0, 0), 0, k, damping,
                     0);
      strut_step_limit limit = limit_of(&setup);
      assert_true(limit.exact);
      assert_relative(limit.largest_frequency, omega, 1e-9);
      assert_relative(limit.limit * omega, known[i][1], 1e-4);
    }
}

/* Of a mass on damped ground each method has a limit of its own; implicit dampers have none. */
TEST(limit_of_each_method_on_damped_ground) {
  const double k = 900, mass = 4, omega = 15, zetas[] = {0.2, 2};
  const double rk4[] = {2.9401, 0.74631717};
  const strut_integrator *method;
  for (int z = 0; z < 2; z++)
    for (size_t i = 0; (method = strut_integrator_at(i)); i++) {
      double zeta = zetas[z], limit, expected = INFINITY;
      OWN(strut_setup) setup = build_setup();
      build_mass(&setup.scene, 0, 0.5, mass);
      build_contact(&setup.scene, 0, k, zeta * 2 * sqrt(k * mass));
      OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
      assert_ok(strut_step_limit_for_method(model, method, &limit, NULL));
      if (method->region == STRUT_REGION_RK4) expected = rk4[z] / omega;
      if (method->region == STRUT_REGION_EULER) expected = 2 / omega * (hypot(zeta, 1) - zeta);
      if (method->region == STRUT_REGION_VERLET)
        expected = strut_verlet_limit(omega * omega, 2 * zeta * omega);
      if (method->implicit_damper) expected = 2 / omega;
      if (isinf(expected))
        assert_true(isinf(limit));
      else
        assert_relative(limit, expected, 1e-4);
    }
}

TEST(nothing_limits_free_masses) {
  OWN(strut_setup) setup = build_setup();
  build_mass(&setup.scene, 0, 0, 1);
  strut_step_limit limit = limit_of(&setup);
  assert_true(isinf(limit.limit) && limit.largest_frequency == 0);
}

/* A row of bars between supports that can only move along itself: its frequencies are known. */
static strut_setup row_of_bars(int bars, strut_mass_model mass_model, double damping) {
  strut_setup setup = build_setup();
  setup.scene.mass_model = mass_model;
  for (int i = 0; i <= bars; i++) build_node(&setup.scene, i, 0);
  for (int i = 0; i <= bars; i++) setup.scene.nodes[i].fixed[1] = true;
  setup.scene.nodes[0].fixed[0] = setup.scene.nodes[bars].fixed[0] = true;
  for (int i = 0; i < bars; i++) build_member(&setup.scene, STRUT_BAR, i, i + 1, 1e4, damping, 0.2);
  return setup;
}

static double highest(int bars, strut_mass_model mass_model) {
  double c = cos((bars - 1) * PI / bars), square = 1e4 / 0.2;
  return sqrt(mass_model == STRUT_MASS_LUMPED ? 2 * square * (1 - c)
                                              : 6 * square * (1 - c) / (2 + c));
}

/* Below the size of all eigenvalues the limit is exact, above it within a hundredth. */
TEST(limit_of_rows_of_bars) {
  static const int sizes[] = {5, 30, 61, 62, 200, 2000};
  for (int s = 0; s < 12; s++) {
    strut_mass_model mass_model = s % 2 ? STRUT_MASS_LUMPED : STRUT_MASS_CONSISTENT;
    OWN(strut_setup) setup = row_of_bars(sizes[s / 2], mass_model, 0);
    strut_step_limit limit = limit_of(&setup);
    double omega = highest(sizes[s / 2], mass_model), expected = IMAGINARY / omega;
    assert_int_equal(limit.exact, sizes[s / 2] <= 61);
    if (limit.exact)
      assert_relative(limit.limit, expected, 1e-6);
    else
      assert_within(limit.limit, 0.99 * expected, expected);
    assert_within(limit.largest_frequency, 0.9999 * omega, 1.01 * omega);
  }
}

/* Over-damped rows: modes of damping ratio 3 at the highest frequency. */
TEST(limit_of_damped_rows) {
  static const int sizes[] = {20, 100};
  for (int s = 0; s < 2; s++) {
    double omega = highest(sizes[s], STRUT_MASS_CONSISTENT), zeta = 3;
    OWN(strut_setup) setup = row_of_bars(sizes[s], STRUT_MASS_CONSISTENT, 2 * zeta * 1e4 / omega);
    double expected = 2.7852935634 / (omega * (zeta + sqrt(zeta * zeta - 1)));
    strut_step_limit limit = limit_of(&setup);
    if (limit.exact)
      assert_relative(limit.limit, expected, 1e-6);
    else
      assert_within(limit.limit, 0.99 * expected, 1.001 * expected);
  }
}

/* Kinetic energy of small motions about the start after many steps, as a factor. */
static double growth(const strut_setup *setup, const char *method, double step, int64_t steps) {
  double before = 0, after = 0;
  OWN(motion) m = motion_begin_by(setup, method, step);
  for (size_t i = 0; i < 2 * setup->scene.node_count; i++) {
    if (setup->scene.nodes[i / 2].fixed[i % 2]) continue;
    m.state->v[i] = 1e-9 * sin(1.3 * (double)i + 1);
    before += m.state->v[i] * m.state->v[i];
  }
  motion_steps(&m, steps);
  for (size_t i = 0; i < 2 * setup->scene.node_count; i++) after += m.state->v[i] * m.state->v[i];
  return after / before;
}

/* The truth of it: just below the limit small motions stay small, just above they grow. */
TEST(the_limit_is_where_motions_begin_to_grow) {
  x_frame frame = {1, 0, .cable = {400, 0.3, 0.05}, .bar = {2000, 0.2, 0.4}};
  for (int i = 0; i < 14; i++) {
    const strut_integrator *method = strut_integrator_at((size_t)(i / 2));
    int lumped = i % 2;
    if (!method || method->region == STRUT_REGION_ALL) continue;
    OWN(strut_setup) setup = build_setup();
    setup.scene.mass_model = lumped ? STRUT_MASS_LUMPED : STRUT_MASS_CONSISTENT;
    structure_x_frame(&setup.scene, &frame);
    for (int j = 0; j < 4; j++) setup.scene.members[j].kind = STRUT_SPRING;
    strut_step_limit all = limit_of(&setup);
    double limit = strut_step_limit_of_method(&all, method);
    double below = growth(&setup, method->name, 0.99 * limit, 2000);
    double above = growth(&setup, method->name, 1.01 * limit, 2000);
    print_message("%s: %.3g below the limit, %.3g above\n", method->name, below, above);
    assert_all(below<100, above> 1e4);
  }
}

TEST(the_crawler) {
  OWN(strut_setup) setup = build_setup();
  structure_crawler(&setup.scene, 10, 1e-4, 0.1, false);
  strut_step_limit limit = limit_of(&setup);
  assert_true(limit.exact);
  assert_within(limit.limit, 1.2e-4, 1.45e-4); /* the paper's step of 1e-4 s is just below it */
  assert_within(limit.largest_frequency, 1.95e4, 2.3e4);
}

/* Above 60 coordinates the estimate, below all eigenvalues: two copies of a scene tell them apart. */
TEST(the_estimate_is_within_a_percent) {
  int compared = 0;
  for (uint64_t seed = 1; seed <= 150; seed++) {
    strut_setup setup = build_setup();
    random_scene(&setup.scene, seed);
    strut_step_limit exact = limit_of(&setup);
    if (!exact.exact || isinf(exact.limit)) {
      strut_setup_free(&setup);
      continue;
    }
    for (int i = 0; i < 61; i++)
      build_mass(&setup.scene, i, 50, 1); /* free, they only add coordinates */
    strut_step_limit estimate = limit_of(&setup);
    assert_false(estimate.exact);
    for (int region = STRUT_REGION_RK4; region < STRUT_REGIONS; region++) {
      assert_within(estimate.of[region], 0.99 * exact.of[region], 1.002 * exact.of[region]);
      if (region != STRUT_REGION_RK4)
        assert_within(estimate.of_implicit[region], 0.99 * exact.of_implicit[region],
                      1.002 * exact.of_implicit[region]);
    }
    compared++;
    strut_setup_free(&setup);
  }
  assert_true(compared > 50);
}
