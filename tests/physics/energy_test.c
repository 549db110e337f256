/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The energy balance of a run: closed on smooth scenes, closing with the step on the others. */
#include <signal.h>
#include <sys/time.h>

#include "tests/physics/smooth_scenes.h"
#include "tests/support/structures.h"

static strut_energy balance(void (*make)(strut_scene *), double step, double duration) {
  OWN(strut_setup) setup = build_setup();
  make(&setup.scene);
  motion_experiment(&setup, step, duration);
  OWN(strut_summary) summary = motion_simulate(&setup);
  strut_energy energy = summary.energy;
  return energy;
}

static double relative_residual(void (*make)(strut_scene *), double step, double duration) {
  strut_energy e = balance(make, step, duration);
  double now = e.kinetic + e.elastic + e.gravity + e.contact;
  double lost = e.dissipated_members + e.dissipated_contact + e.dissipated_friction;
  double done = e.drive_work + e.load_work + e.belt_work + e.support_work;
  /* the residual is what its own figures say */
  assert_near(e.residual, now - e.initial - done + lost, 1e-13 * (fabs(now) + e.moved));
  assert_all(e.moved > 0 && e.moved >= 0.99 * (fabs(done) - 1e-9), lost >= 0);
  return fabs(e.residual) / e.moved;
}

/* At several ends, for at one of them the residual may pass through zero. */
static double worst_residual(const smooth_scene *smooth, double step) {
  double worst = 0;
  for (int part = 1; part <= 5; part++)
    worst = fmax(worst, relative_residual(smooth->make, step, smooth->duration * part / 5));
  return worst;
}

TEST(smooth_scenes_close_their_balance) {
  for (int s = 0; s < SMOOTH_SCENES; s++) {
    const smooth_scene *smooth = &smooth_scenes[s];
    double error[5];
    /* twice as coarse as positions need it: energies reach rounding sooner */
    for (int k = 0; k < 5; k++) error[k] = worst_residual(smooth, ldexp(smooth->step, 1 - k));
    double order = observed_order(error, 5);
    double finest = worst_residual(smooth, ldexp(smooth->step, -6));
    print_message("%s: order %.3f, residual %.2g to %.2g, %.2g\n", smooth->name, order, error[0],
                  error[4], finest);
    assert_true(order > 3.9); /* a conservative scene loses energy at order five */
    assert_true(finest < 1e-10);
  }
}

static void bouncing_node(strut_scene *scene) {
  strut_scene_init(scene);
  scene->gravity[1] = -9.81;
  build_mass(scene, 0, 0.05, 0.5);
  build_contact(scene, 0, 1e4, 20);
}

static void crawler(strut_scene *scene) {
  strut_scene_init(scene);
  structure_crawler(scene, 10, 1e-4, 0.1, false);
}

static void belt(strut_scene *scene) {
  strut_scene_init(scene);
  scene->gravity[1] = -9.81;
  build_mass(scene, 0, -9.81e-5, 1);
  build_support(scene, -1, -9.81e-5);
  build_sized(scene, STRUT_SPRING, 1, 0, 100, 0.5, 0, 1);
  build_rough_contact(scene, 0, 1e5, 100, 0.2, 0.1, 2e-3);
  scene->ground.belt_speed = scene->nodes[0].velocity[0] = 0.1;
}

static void slack_cables(strut_scene *scene) {
  strut_scene_init(scene);
  build_support(scene, -1, 0);
  build_support(scene, 1, 0);
  build_mass(scene, 0, 0.1, 1);
  for (int i = 0; i < 2; i++) build_member(scene, STRUT_CABLE, i, 2, 500, 3, 0);
  build_actuator(scene, 0, build_sine(scene, 0.02, 2));
  scene->gravity[1] = -9.81;
  scene->nodes[2].velocity[0] = 1;
}

/* With jumps the residual falls as the step does, if not smoothly: five halvings, as a trend. */
static void check_rough(const char *name, void (*make)(strut_scene *), double step,
                        double duration) {
  double error[6];
  for (int k = 0; k < 6; k++) error[k] = relative_residual(make, ldexp(step, -k), duration);
  double order = observed_order(error, 6);
  print_message("%s: order %.2f, residual %.2g to %.2g\n", name, order, error[0], error[5]);
  assert_all(order > 0.7, error[5] < 0.25 * error[0]);
}

TEST(scenes_with_jumps_close_as_the_step_falls) {
  check_rough("bouncing node", bouncing_node, 1e-3, 1);
  check_rough("crawler", crawler, 1e-4, 0.3);
  check_rough("belt", belt, 1e-3, 2);
  check_rough("slack cables", slack_cables, 2e-3, 2);
}

/* The parts by hand where they are known. */
TEST(the_parts_of_a_sliding_block) {
  OWN(strut_setup) setup = build_falling();
  build_mass(&setup.scene, 0, -9.81e-5 * 2, 2);
  build_rough_contact(&setup.scene, 0, 1e5, 100, 0.3, 0.3, 1e-4);
  setup.scene.nodes[0].velocity[0] = 3;
  motion_experiment(&setup, 1e-4, 0.5);
  OWN(strut_summary) s = motion_simulate(&setup);
  double v = 3 - 0.3 * 9.81 * 0.5, way = 0.5 * (3 + v) * 0.5;
  assert_relative(s.energy.kinetic, v * v, 1e-12);
  assert_relative(s.energy.dissipated_friction, 0.3 * 2 * 9.81 * way, 1e-12);
  assert_relative(s.energy.contact, 0.5 * 1e5 * (9.81e-5 * 2) * (9.81e-5 * 2), 1e-10);
  assert_relative(s.energy.gravity, -2 * 9.81 * 9.81e-5 * 2, 1e-12);
  assert_near(s.energy.residual, 0, 1e-12 * s.energy.moved);
  assert_true(s.energy.elastic == 0 && s.energy.drive_work == 0 && s.energy.load_work == 0);
}

TEST(the_parts_of_a_loaded_mass) {
  OWN(strut_setup) setup = build_setup();
  build_mass(&setup.scene, 0, 0, 2);
  build_load(&setup.scene, 0, 3, 4, -1);
  motion_experiment(&setup, 1e-3, 1);
  OWN(strut_summary) s = motion_simulate(&setup);
  assert_relative(s.energy.load_work, 0.5 * 25 / 2, 1e-12); /* F^2 t^2 / 2 m */
  assert_relative(s.energy.kinetic, 0.5 * 25 / 2, 1e-12);
}

/* A slack cable stores nothing, a taut one c s^2 / 2. */
TEST(a_slack_cable_stores_nothing) {
  for (int slack = 0; slack < 2; slack++) {
    OWN(strut_setup) setup = build_setup();
    build_support(&setup.scene, 0, 0);
    build_support(&setup.scene, 0.7, 0);
    build_mass(&setup.scene, 5, 5, 2);
    build_sized(&setup.scene, STRUT_CABLE, 0, 1, 300, 1, 0, slack ? 0.9 : 0.5);
    setup.scene.nodes[2].velocity[0] = 3;
    motion_experiment(&setup, 1e-3, 0.1);
    OWN(strut_summary) s = motion_simulate(&setup);
    double stored = slack ? 0 : 0.5 * 300 * 0.2 * 0.2;
    assert_all_near(1e-14, s.energy.elastic, stored, s.energy.initial, 9 + stored);
  }
}

static strut_flag ring;

static void note_ring(int number) {
  (void)number;
  ring = 1;
}

/* One step of the grid that takes the adaptive method for ever: a signal ends it, and undoes it all. */
TEST(an_interrupted_step_is_undone_with_its_works) {
  const struct itimerval soon = {.it_value = {.tv_usec = 50000}};
  struct sigaction before, action = {.sa_handler = note_ring};
  OWN(strut_setup) setup = build_tethered(1, 0, 0.1);
  build_member(&setup.scene, STRUT_SPRING, 0, 1, 1e6, 0.01, 0);
  build_load(&setup.scene, 1, 1, 0, build_sine(&setup.scene, 1, 300));
  setup.scene.nodes[1].start[0] = 1.01;
  motion_experiment(&setup, 1e9, 1e9);
  OWN(motion) m = motion_begin_by(&setup, "adaptive", 1e9);
  m.state->balance = true;
  m.state->limits.interrupt = &ring;
  ring = 0;
  assert_int_equal(sigaction(SIGVTALRM, &action, &before), 0);
  assert_int_equal(setitimer(ITIMER_VIRTUAL, &soon, NULL), 0);
  motion_steps(&m, 1);
  assert_int_equal(sigaction(SIGVTALRM, &before, NULL), 0);
  assert_int_equal(m.state->trouble, STRUT_FAILURE_INTERRUPT);
  assert_true(m.state->latest->evaluations > 100); /* it had gone somewhere */
  assert_int_equal(m.state->step, 0);
  assert_true(m.state->q[2] == 1.01 && m.state->v[2] == 0);
  for (int p = 0; p < STRUT_POWER_COUNT; p++) assert_true(m.state->work[p] == 0);
}
