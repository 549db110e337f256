/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The potential energy in small: members of no length, a slope, no memory. Random scenes: world_statics_test.c. */
#include "engine/statics/potential.h"

#include "tests/physics/random_scene.h"
#include "tests/support/motion.h"

/* A spring of no length and no rest length pulls alike everywhere; one with a rest length not. */
TEST(members_of_zero_length) {
  OWN(strut_scene) scene = build_scene();
  OWN_POINTER(strut_model) model;
  strut_potential *p;
  OWN(strut_arena) arena = {0};
  build_support(&scene, 0, 0);
  build_node(&scene, 0, 0);
  build_node(&scene, 1, 0);
  build_sized(&scene, STRUT_SPRING, 0, 1, 7, 0, 0, 0);
  build_sized(&scene, STRUT_SPRING, 0, 2, 5, 0, 0, 1);
  build_sized(&scene, STRUT_CABLE, 0, 1, 3, 0, 0, 0);
  assert_ok(strut_model_compile(&scene, &model, NULL));
  assert_ok(strut_potential_create(model, NULL, true, &arena, &p, NULL));
  strut_sparse *k = strut_potential_matrix(p, &arena);
  double g[4];
  strut_potential_hessian(p, model->start, k);
  strut_potential_gradient(p, model->start, g);
  for (int i = 0; i < 4; i++) assert_near(g[i], 0, 0);
  assert_all_near(0, k->value[k->start[0]], 7, k->value[k->start[1]], 7, k->value[k->start[2]], 5);
  assert_near(k->value[k->start[3]], 0, 0);
  double q[12] = {0};
  strut_potential_hessian(p, q, k);
  assert_all_near(0, k->value[k->start[2]], 0, k->value[k->start[3]], 0);
}

/* A weight on a soft ground that slopes: the force is the load's plus the ground's push. */
TEST(a_slope_pushes_along_its_normal) {
  OWN(strut_scene) scene = build_scene();
  OWN_POINTER(strut_model) model;
  OWN(strut_arena) arena = {0};
  strut_potential *p;
  build_mass(&scene, 1, 0.4, 2);
  build_contact(&scene, 0, 1000, 5);
  build_load(&scene, 0, 3, 4, -1);
  scene.ground.slope = 0.5;
  scene.gravity[1] = -10;
  assert_ok(strut_model_compile(&scene, &model, NULL));
  assert_ok(strut_potential_create(model, NULL, true, &arena, &p, NULL));
  double depth = sin(0.5) - 0.4 * cos(0.5), force[8];
  assert_true(depth > 0);
  strut_potential_force(p, model->start, force);
  assert_near(force[0], 3 - 1000 * depth * sin(0.5), 1e-11);
  assert_near(force[1], 4 - 20 + 1000 * depth * cos(0.5), 1e-11);
  assert_near(p->force_scale, 25, 1e-14);
  assert_ok(strut_potential_create(model, NULL, false, &arena, &p, NULL));
  strut_potential_force(p, model->start, force);
  assert_all_near(0, force[0], 3, force[1], -16);
}

/* A refusal of memory at any place is passed on. */
TEST(refused_memory) {
  OWN(strut_scene) scene;
  OWN_POINTER(strut_model) model;
  random_scene(&scene, 3);
  assert_ok(strut_model_compile(&scene, &model, NULL));
  REFUSE_EACH(n, status, 1) {
    OWN(strut_arena) arena = {0};
    strut_potential *p;
    status = refused(n, strut_potential_create(model, NULL, true, &arena, &p, NULL));
  }
}
