/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A free bar and a free frame: lengths, frequencies, the centre of mass; channels_test.c has angular momentum. */
#include "tests/support/oscillation.h"
#include "tests/support/structures.h"

static const double K = 1000, MASS = 0.1, L0 = 0.5;

/*
 * A bar that starts too short and is damped finds the steady length of its own spin: the mass terms
 * of both ends, m W^2/12 (consistent) or m W^2/4 (lumped) per unit of length, against the spring.
 */
static void steady_length(strut_mass_model mass_model, double share) {
  OWN(strut_scene) scene = build_scene();
  scene.mass_model = mass_model;
  int32_t a = build_node(&scene, -L0 / 2, 0), b = build_node(&scene, L0 / 2, 0);
  build_member(&scene, STRUT_BAR, a, b, K, 2, MASS);
  structure_throw(&scene, 3, -1, 40);
  OWN(motion) m = motion_begin(&scene, 2e-5);
  motion_steps(&m, 100000);
  const double *q = m.state->q, *v = m.state->v;
  double x = q[2] - q[0], y = q[3] - q[1], vx = v[2] - v[0], vy = v[3] - v[1];
  double length = hypot(x, y), spin = (x * vy - y * vx) / (length * length);
  assert_near((x * vx + y * vy) / length, 0, 1e-9);
  assert_relative(length, L0 / (1 - share * MASS * spin * spin / K), 1e-10);
  assert_true(length > 1.005 * L0);
  assert_near(v[0] + v[2], 2 * 3.0, 1e-10);
}

TEST(a_consistent_bar_spins_at_its_steady_length) {
  steady_length(STRUT_MASS_CONSISTENT, 1.0 / 12);
}

TEST(a_lumped_bar_spins_at_its_steady_length) { steady_length(STRUT_MASS_LUMPED, 1.0 / 4); }

/* Along its axis a bar is a linear oscillator, so every step of RK4 is known. */
static void vibrate(strut_mass_model mass_model, double factor) {
  OWN(strut_scene) scene = build_scene();
  double omega = sqrt(factor * K / MASS), step = 0.05 / omega, re, im, stretch = 0.01;
  scene.mass_model = mass_model;
  int32_t a = build_node(&scene, 0, 0), b = build_node(&scene, 0.3, 0.4);
  build_member(&scene, STRUT_BAR, a, b, K, 0, MASS);
  scene.nodes[1].start[0] += 0.6 * stretch;
  scene.nodes[1].start[1] += 0.8 * stretch;
  OWN(motion) m = motion_begin(&scene, step);
  motion_steps(&m, 5000);
  const double *q = m.state->q;
  rk4_oscillation(step * omega, 5000, &re, &im);
  assert_near(hypot(q[2] - q[0], q[3] - q[1]), 0.5 + stretch * re, 1e-13);
}

TEST(a_free_bar_vibrates_at_its_frequency) {
  vibrate(STRUT_MASS_CONSISTENT, 12);
  vibrate(STRUT_MASS_LUMPED, 4);
}

static strut_scene tumbling_frame(strut_mass_model mass_model, double damping) {
  x_frame frame = {1, 60, .cable = {400, damping, 0.05}, .bar = {2000, 0.1 * damping, 0.4}};
  strut_scene scene = build_scene();
  scene.mass_model = mass_model;
  structure_x_frame(&scene, &frame);
  scene.nodes[2].mass = 0.3; /* so that the middle is nowhere special */
  structure_throw(&scene, 2, 5, 6);
  scene.nodes[0].velocity[0] += 1;
  return scene;
}

/* Point masses and both halves of every member. */
static void centre(const strut_scene *scene, const double *p, double out[2]) {
  double total = 0, sum[2] = {0, 0};
  for (size_t i = 0; i < scene->node_count; i++) {
    total += scene->nodes[i].mass;
    for (size_t c = 0; c < 2; c++) sum[c] += scene->nodes[i].mass * p[2 * i + c];
  }
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *member = &scene->members[j];
    total += member->mass;
    for (size_t c = 0; c < 2; c++)
      for (int e = 0; e < 2; e++) sum[c] += 0.5 * member->mass * p[2 * (size_t)member->node[e] + c];
  }
  for (size_t c = 0; c < 2; c++) out[c] = sum[c] / total;
}

static void follow_the_parabola(strut_mass_model mass_model) {
  double at[2], speed[2], end[2], step = 1e-3;
  OWN(strut_scene) scene = tumbling_frame(mass_model, 2);
  scene.gravity[0] = 0.5, scene.gravity[1] = -9.81;
  OWN(motion) m = motion_begin(&scene, step);
  centre(&scene, m.state->q, at);
  centre(&scene, m.state->v, speed);
  for (int n = 1; n <= 10; n++) {
    double t = step * 1000 * n, path = hypot(speed[0] * t, speed[1] * t) + 0.5 * 9.81 * t * t;
    motion_steps(&m, 1000);
    centre(&scene, m.state->q, end);
    for (int c = 0; c < 2; c++)
      assert_near(end[c], at[c] + t * (speed[c] + 0.5 * t * scene.gravity[c]), 1e-12 * path);
  }
}

TEST(the_centre_of_mass_follows_its_parabola) {
  follow_the_parabola(STRUT_MASS_CONSISTENT);
  follow_the_parabola(STRUT_MASS_LUMPED);
}
