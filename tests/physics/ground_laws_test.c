/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Hunt-Crossley ground and smooth friction against their closed forms; who may use Coulomb's. */
#include <gsl/gsl_integration.h>

#include "tests/support/motion.h"

static const double K = 1e4, MASS = 0.5, G = 9.81;

/*
 * m u du/dd = -c d (1 + chi u): F(u) = u/chi - ln(1 + chi u)/chi^2 falls by c d^2 / (2 m), so that
 * F(approach) = F(-departure).
 */
static double potential(double u, double chi) { return u / chi - log1p(chi * u) / (chi * chi); }

static double departure_after(double approach, double chi) {
  double low = 0, high = fmin(approach, (1 - 1e-15) / chi), wanted = potential(approach, chi);
  for (int i = 0; i < 200; i++) {
    double middle = 0.5 * (low + high);
    *(potential(-middle, chi) < wanted ? &low : &high) = middle;
  }
  return low;
}

TEST(hunt_crossley_restitution_and_depth) {
  static const double chis[] = {0.05, 0.5, 3};
  for (int k = 0; k < 3; k++) {
    OWN(strut_setup) setup = build_setup();
    double chi = chis[k], speed = 1.5, deepest = 0, before;
    int32_t node = build_mass(&setup.scene, 0, 1e-3, MASS);
    setup.scene.nodes[node].velocity[1] = -speed;
    int32_t c = build_contact(&setup.scene, node, K, 7); /* not used by this law */
    setup.scene.ground.damping_law = STRUT_DAMPING_HUNT_CROSSLEY;
    setup.scene.contacts[c].dissipation = chi;
    OWN(motion) m = motion_begin(&setup.scene, 1e-6);
    m.state->balance = true;
    before = 0.5 * MASS * speed * speed;
    do {
      motion_steps(&m, 1);
      deepest = fmax(deepest, -m.state->q[1]);
    } while (m.state->q[1] < 0 || m.state->v[1] < 0);
    assert_relative(m.state->v[1], departure_after(speed, chi), 1e-5);
    assert_relative(deepest, sqrt(2 * MASS / K * potential(speed, chi)), 1e-5);
    double after = 0.5 * MASS * m.state->v[1] * m.state->v[1];
    assert_near(m.state->work[STRUT_POWER_CONTACT], before - after, 1e-5 * before);
  }
}

/* A node that leaves faster than 1 / chi, from deep in the ground: nothing holds it back. */
TEST(hunt_crossley_never_pulls) {
  const double chi = 3, speed = 2, depth = 0.01, step = 1e-4;
  const strut_integrator *method;
  for (size_t i = 0; (method = strut_integrator_at(i)); i++) {
    OWN(strut_setup) setup = build_setup();
    if (method->no_ground) continue;
    build_contact(&setup.scene, build_mass(&setup.scene, 0, -depth, MASS), K, 0);
    setup.scene.nodes[0].velocity[1] = speed;
    setup.scene.ground.damping_law = STRUT_DAMPING_HUNT_CROSSLEY;
    setup.scene.contacts[0].dissipation = chi;
    motion_experiment(&setup, step, 1);
    OWN(motion) m = motion_begin_by(&setup, method->name, step);
    for (int k = 0; k < 10; k++) {
      motion_steps(&m, 10); /* out after 50 */
      assert_near(m.state->v[1], speed, 1e-12);
    }
    assert_near(m.state->q[1], speed * 100 * step - depth, 1e-12);
  }
}

/* A block on its static depth, so that N = m g. */
static strut_setup block(double slope, double mu, double width) {
  strut_setup setup = build_setup();
  setup.scene.ground.slope = slope;
  setup.scene.gravity[0] = G * sin(slope),
  setup.scene.gravity[1] = -G * cos(slope); /* N along the normal */
  double depth = MASS * G / K;
  int32_t node = build_mass(&setup.scene, depth * sin(slope), -depth * cos(slope), MASS);
  int32_t c = build_contact(&setup.scene, node, K, 0);
  setup.scene.contacts[c].friction =
      (strut_friction){.law = STRUT_FRICTION_SMOOTH, .mu_kinetic = mu, .width = width};
  return setup;
}

/* sqrt(u^2 + w^2) - w asinh(w/u) falls by mu g t. */
static double slid(double u, double w) { return sqrt(u * u + w * w) - w * asinh(w / u); }

TEST(smooth_friction_slows_a_block_by_its_closed_form) {
  static const double slopes[] = {0, 0.3};
  for (int k = 0; k < 2; k++) {
    const double mu = 0.3, width = 0.2, start = 1.0, time = 0.4;
    OWN(strut_setup) setup = block(slopes[k], mu, width);
    setup.scene.nodes[0].velocity[0] = start * cos(slopes[k]);
    setup.scene.nodes[0].velocity[1] = start * sin(slopes[k]);
    OWN(motion) m = motion_begin(&setup.scene, 1e-4);
    m.state->balance = true;
    motion_steps(&m, 4000);
    double u = hypot(m.state->v[0], m.state->v[1]);
    assert_near(slid(u, width), slid(start, width) - mu * G * time, 1e-8);
    assert_relative(m.state->work[STRUT_POWER_FRICTION], 0.5 * MASS * (start * start - u * u),
                    1e-8);
  }
}

/* Time to slow down from u to v: the integral of du / (mu(u) g) with the law by its words. */
static double slowing(double u, void *context) {
  const strut_friction *f = context;
  double share = 1 / (1 + u * u / (f->decay_velocity * f->decay_velocity));
  double mu = share * f->mu_static + (1 - share) * f->mu_kinetic;
  return sqrt(u * u + f->width * f->width) / (mu * G * u);
}

TEST(stribeck_friction_slows_a_block_by_its_integral) {
  double time, error;
  size_t count;
  OWN(strut_setup) setup = block(0, 0.2, 0.01);
  strut_friction *f = &setup.scene.contacts[0].friction;
  f->law = STRUT_FRICTION_STRIBECK, f->mu_static = 0.5, f->decay_velocity = 0.3;
  setup.scene.nodes[0].velocity[0] = 1.0;
  OWN(motion) m = motion_begin(&setup.scene, 1e-4);
  motion_steps(&m, 3000);
  gsl_function law = {slowing, f};
  gsl_integration_qng(&law, m.state->v[0], 1.0, 0, 1e-10, &time, &error, &count);
  assert_near(time, 0.3, 1e-8);
}

/* Under a load below mu N it creeps at w F / sqrt((mu N)^2 - F^2). */
TEST(smooth_friction_creeps) {
  const double mu = 0.4, width = 0.01, full = mu * MASS * G, push = 0.6 * full;
  OWN(strut_setup) setup = block(0, mu, width);
  build_load(&setup.scene, 0, push, 0, -1);
  OWN(motion) m = motion_begin(&setup.scene, 1e-4);
  motion_steps(&m, 10000);
  assert_relative(m.state->v[0], width * push / sqrt(full * full - push * push), 1e-9);
}

/* Friction's slope at rest, mu N / width, is a rate of decay that the step must follow. */
TEST(the_step_limit_counts_smooth_friction) {
  const double mu = 0.4, width = 1e-4;
  OWN(strut_setup) setup = block(0, mu, width);
  motion_experiment(&setup, 1e-6, 1e-4);
  OWN(strut_summary) s = motion_simulate(&setup);
  assert_relative(s.step_limit, 2.785293563405 / (mu * G / width), 1e-6);
}

TEST(exact_friction_needs_a_method_with_events) {
  strut_error error = {0};
  strut_summary summary;
  OWN(strut_setup) setup = block(0, 0.4, 0);
  strut_friction *friction = &setup.scene.contacts[0].friction;
  friction->law = STRUT_FRICTION_COULOMB, friction->mu_static = friction->mu_kinetic;
  motion_experiment(&setup, 1e-4, 1e-2);
  assert_fails(motion_try(&setup, (strut_run_options){0}, &summary, &error), STRUT_USAGE, error,
               "rk4-events");
  strut_summary_free(&summary);
  setup.experiment.integrator = "rk4-events";
  summary = motion_simulate(&setup);
  strut_summary_free(&summary);
}
