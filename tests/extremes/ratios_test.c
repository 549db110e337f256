/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stiffness 1e12 times stiffness and mass 1e9 times mass, in one structure. */
#include "engine/model/mass.h"
#include "engine/statics/minimise.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

FREED_BY(strut_potential_free, strut_potential)

/* A row of springs along x, pulled at its end: it gives by the sum of pull / stiffness. */
TEST(statics_of_a_stiffness_ratio) {
  for (int links = 3; links <= 200; links += 197) { /* a dense Hessian, and a sparse one */
    const double pull = 0.01;
    OWN(strut_scene) scene = build_scene();
    OWN_POINTER(strut_potential) potential;
    strut_minimiser *minimiser;
    double stretch = 0;
    build_support(&scene, 0, 0);
    for (int32_t i = 1; i <= links; i++) {
      double stiffness = i % 3 == 1 ? 1e12 : i % 3 == 2 ? 1 : 1e3;
      build_mass(&scene, i, 0, 1);
      scene.nodes[i].fixed[1] = true;
      build_member(&scene, STRUT_SPRING, i - 1, i, stiffness, 0, 0);
      stretch += pull / stiffness;
    }
    build_load(&scene, links, pull, 0, -1);
    OWN_POINTER(strut_model) model = motion_compile(&scene);
    assert_ok(strut_potential_create(model, NULL, false, &potential, NULL));
    assert_ok(strut_minimiser_create(potential, &minimiser, NULL));
    FREED double *q = calloc((size_t)model->length, sizeof *q);
    assert_non_null(q);
    for (int32_t i = 0; i < model->length; i++) q[i] = model->start[i];
    strut_descent end = strut_minimise(minimiser, q);
    print_message("%d springs of 1 to 1e12 N/m: gives %.9f m, closed form %.9f m, %d iterations\n",
                  links, q[2 * links] - links, stretch, (int)end.iterations);
    assert_relative(q[2 * links] - links, stretch, 1e-9);
    strut_minimiser_free(minimiser);
  }
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

/* Bars of 1 kg and 1e-9 kg by turns in one connected body of 1e5 nodes: M a = f, both ways. */
TEST(masses_of_a_ratio_on_many_nodes) {
  enum { NODES = 100000 };
  OWN(strut_scene) scene = build_scene();
  uint64_t r = 5;
  for (int32_t i = 0; i < NODES; i++) {
    build_node(&scene, i / 2, i % 2);
    double mass = random_once_in(&r, 2) ? 1 : random_scale(&r, 1e-9, 1);
    if (i > 0) build_member(&scene, STRUT_BAR, i - 1, i, 1, 0, mass);
    if (i > 1) build_member(&scene, STRUT_BAR, i - 2, i, 1, 0, 1e-9);
  }
  OWN_POINTER(strut_model) model = motion_compile(&scene);
  assert_non_null(model->mass);
  size_t length = (size_t)model->length;
  FREED double *force = calloc(5 * length, sizeof *force);
  assert_non_null(force);
  double *a = force + length, *work = a + length, *back = work + length, *scale = back + length;
  for (size_t i = 0; i < 2 * NODES; i++) force[i] = random_between(&r, -1, 1);
  strut_mass_solve(model, force, a, work);
  for (size_t j = 0; j < scene.member_count; j++) {
    const strut_member *member = &scene.members[j];
    for (int c = 0; c < 2; c++) {
      size_t p = 2 * (size_t)member->node[0] + (size_t)c;
      size_t s = 2 * (size_t)member->node[1] + (size_t)c;
      back[p] += member->mass / 6 * (2 * a[p] + a[s]);
      back[s] += member->mass / 6 * (a[p] + 2 * a[s]);
      double size = member->mass / 6 * (2 * fabs(a[p]) + 2 * fabs(a[s]));
      scale[p] += size, scale[s] += size;
    }
  }
  double worst = 0;
  for (size_t i = 0; i < 2 * NODES; i++)
    worst = fmax(worst, fabs(back[i] - force[i]) / (scale[i] + fabs(force[i])));
  print_message("masses of 1e-9 to 1 kg on 1e5 nodes: M a = f to %.1e of its terms\n", worst);
  assert_true(worst <= 1e-13);
}
