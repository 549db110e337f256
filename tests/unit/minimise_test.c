/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Descents: from anywhere, at any condition, by eigenvectors and by sparse factors. */
#include "engine/statics/minimise.h"

#include "tests/support/random.h"
#include "tests/support/structures.h"

typedef struct fixture {
  strut_scene scene;
  strut_model *model;
  strut_potential *potential;
  strut_minimiser *minimiser;
  double *q;
} fixture;

static void compile(fixture *f, const uint8_t *held, bool ground) {
  assert_ok(strut_model_compile(&f->scene, &f->model, NULL));
  assert_ok(strut_potential_create(f->model, held, ground, &f->scene.arena, &f->potential, NULL));
  assert_ok(strut_minimiser_create(f->potential, &f->scene.arena, &f->minimiser, NULL));
  f->q = strut_arena_allocate(&f->scene.arena, (size_t)f->model->length, sizeof *f->q);
  memcpy(f->q, f->model->start, (size_t)f->model->length * sizeof *f->q);
}

static void fixture_free(fixture *f) {
  strut_model_free(f->model);
  strut_scene_free(&f->scene);
}

/* The crawler on node 1 pinned and node 4 held in y. */
static void crawler(fixture *f) {
  const uint8_t held[64] = {1, 1, [7] = 1};
  strut_scene_init(&f->scene);
  structure_crawler(&f->scene, 10, 1e-4, 0.1, false);
  compile(f, held, false);
}

static void assert_reached(const strut_descent *d) {
  assert_int_equal(d->end, STRUT_DESCENT_REACHED);
  assert_true(d->residual <= 8 * d->rounding);
}

TEST(the_crawlers_first_state) {
  static const double known[5][2] = {{0, 0},
                                     {96.5109e-3, 23.8714e-3},
                                     {52.6668e-3, 28.3691e-3},
                                     {60.2933e-3, 0},
                                     {43.4758e-3, 10.6875e-3}};
  OWN(fixture) f = {0};
  crawler(&f);
  strut_descent d = strut_minimise(f.minimiser, f.q);
  double force[64];
  assert_reached(&d);
  assert_true(d.iterations < 10);
  assert_near(strut_potential_energy(f.potential, f.q), 22.706131, 1e-6);
  for (int i = 0; i < 10; i++) assert_near(f.q[i], known[i / 2][i % 2], 1e-7);
  strut_potential_force(f.potential, f.q, force);
  assert_all_near(1e-5, -force[1], 0.262996, -force[7], 1.110404);
}

/* Bars 300 times stiffer than the springs: still a few dozen steps, and always to a minimum. */
TEST(from_random_shapes) {
  OWN(fixture) f = {0};
  uint64_t r = 1;
  int steps = 0;
  crawler(&f);
  for (int turn = 0; turn < 200; turn++) {
    for (int32_t i = 0; i < f.potential->n; i++)
      f.q[f.potential->coordinate[i]] = random_between(&r, -0.07, 0.07);
    double before = strut_potential_value(f.potential, f.q);
    strut_descent d = strut_minimise(f.minimiser, f.q);
    assert_reached(&d);
    assert_true(strut_potential_value(f.potential, f.q) < before);
    assert_true(d.iterations < 120);
    steps += d.iterations;
  }
  assert_true(steps < 200 * 50);
}

/* Springs of 1 and `ratio` N/m in turn along x, unit load at the end: the tip moves by their sum. */
static double tip_error(int32_t springs, double ratio, bool sparse, strut_descent *d) {
  OWN(fixture) f = {.scene = build_scene()};
  double sum = 0;
  build_support(&f.scene, 0, 0);
  for (int32_t i = 1; i <= springs; i++) {
    double stiffness = i % 2 ? 1 : ratio;
    build_node(&f.scene, i, 0);
    f.scene.nodes[i].fixed[1] = true;
    build_sized(&f.scene, STRUT_SPRING, i - 1, i, stiffness, 0, 0, 1);
    sum += 1 / stiffness;
  }
  build_load(&f.scene, springs, 1, 0, -1);
  for (int i = 0; sparse && i < STRUT_DENSE_STATICS; i++) { /* far away, to make it large */
    build_node(&f.scene, 0, 10 + i);
    f.scene.nodes[springs + 1 + i].fixed[1] = true;
    build_sized(&f.scene, STRUT_SPRING, 0, springs + 1 + i, 1, 0, 0, 9);
  }
  compile(&f, NULL, false);
  *d = strut_minimise(f.minimiser, f.q);
  double tip = f.q[2 * springs]; /* before f goes */
  return fabs(tip - springs - sum) / sum;
}

TEST(stiffness_ratios) {
  for (int sparse = 0; sparse < 2; sparse++)
    for (int32_t springs = 2; springs <= 60; springs += 29)
      for (double ratio = 1e3; ratio < 1e13; ratio *= 1e3) {
        strut_descent d;
        double error = tip_error(springs, ratio, sparse, &d);
        assert_int_equal(d.end, STRUT_DESCENT_REACHED);
        assert_true(error < 1e-9);
      }
}

/* A drawn shape that is symmetric stands on the ridge; the descent leaves it. */
TEST(it_leaves_a_ridge) {
  OWN(fixture) f = {.scene = build_scene()};
  build_support(&f.scene, -1, 0);
  build_support(&f.scene, 1, 0);
  build_node(&f.scene, 0, 0);
  build_sized(&f.scene, STRUT_BAR, 0, 2, 1, 0, 0, sqrt(1.25));
  build_sized(&f.scene, STRUT_BAR, 1, 2, 1, 0, 0, sqrt(1.25));
  compile(&f, NULL, false);
  strut_descent d = strut_polish(f.minimiser, f.q);
  assert_int_equal(d.end, STRUT_DESCENT_REACHED);
  assert_near(f.q[5], 0, 1e-15); /* polishing stays on it */
  d = strut_minimise(f.minimiser, f.q);
  assert_reached(&d);
  assert_all_near(1e-14, fabs(f.q[5]), 0.5, f.q[4], 0);
}

/* A bouncing ball's rest: weight over the ground's stiffness below the line, from a metre above. */
TEST(it_falls_onto_the_ground) {
  OWN(fixture) f = {.scene = build_scene()};
  build_mass(&f.scene, 0.3, 1, 2);
  build_contact(&f.scene, 0, 1e5, 0);
  f.scene.gravity[1] = -10;
  compile(&f, NULL, true);
  strut_descent d = strut_minimise(f.minimiser, f.q);
  assert_reached(&d);
  assert_near(f.q[1], -2e-4, 1e-17);
  assert_near(f.q[0], 0.3, 0);
}

TEST(without_ground_it_falls_for_ever) {
  OWN(fixture) f = {.scene = build_scene()};
  build_mass(&f.scene, 0.3, 1, 2);
  f.scene.gravity[1] = -10;
  compile(&f, NULL, true);
  assert_int_equal(strut_minimise(f.minimiser, f.q).end, STRUT_DESCENT_RUNAWAY);
}

/* A mass on a slack cable falls until the cable holds it, then hangs. */
TEST(a_slack_cable_catches) {
  OWN(fixture) f = {.scene = build_scene()};
  build_support(&f.scene, 0, 0);
  build_mass(&f.scene, 0.4, -0.2, 1);
  build_sized(&f.scene, STRUT_CABLE, 0, 1, 1000, 0, 0, 1);
  f.scene.gravity[1] = -10;
  compile(&f, NULL, false);
  strut_descent d = strut_minimise(f.minimiser, f.q);
  assert_reached(&d);
  assert_near(f.q[2], 0, 1e-13);
  assert_near(f.q[3], -1.01, 1e-14);
}

/* A free prestressed square finds its side (gallery P1), wherever it drifts. */
TEST(a_free_body) {
  OWN(fixture) f = {.scene = build_scene()};
  const double corner[4][2] = {{0, 0}, {1, 0.05}, {1.1, 1}, {0, 1}};
  for (int i = 0; i < 4; i++) build_node(&f.scene, corner[i][0], corner[i][1]);
  for (int i = 0; i < 4; i++) build_sized(&f.scene, STRUT_CABLE, i, (i + 1) % 4, 100, 0, 0, 0.95);
  for (int i = 0; i < 2; i++) build_sized(&f.scene, STRUT_BAR, i, i + 2, 1000, 0, 0, sqrt(2));
  compile(&f, NULL, true);
  strut_descent d = strut_minimise(f.minimiser, f.q);
  assert_reached(&d);
  assert_near(strut_potential_value(f.potential, f.q), 5.0 / 11.0, 1e-14);
  for (int i = 0; i < 4; i++) {
    const double *a = f.q + 2 * i, *b = f.q + 2 * ((i + 1) % 4);
    assert_near(hypot(a[0] - b[0], a[1] - b[1]), 1095.0 / 1100.0, 1e-13);
  }
}

/* A hanging net of 12 by 12 prestressed cables by sparse factors. */
TEST(a_large_net) {
  enum { SIDE = 12 };
  OWN(fixture) f = {.scene = build_scene()};
  for (int i = 0; i < SIDE * SIDE; i++) {
    build_mass(&f.scene, i % SIDE, (double)(i / SIDE), 0.1);
    bool edge = i / SIDE == SIDE - 1;
    f.scene.nodes[i].fixed[0] = f.scene.nodes[i].fixed[1] = edge;
  }
  for (int32_t i = 0; i < SIDE * SIDE; i++) {
    if (i % SIDE < SIDE - 1) build_sized(&f.scene, STRUT_CABLE, i, i + 1, 200, 0, 0, 0.8);
    if (i / SIDE < SIDE - 1) build_sized(&f.scene, STRUT_CABLE, i, i + SIDE, 200, 0, 0, 0.9);
  }
  f.scene.gravity[1] = -10;
  compile(&f, NULL, false);
  strut_descent d = strut_minimise(f.minimiser, f.q);
  assert_reached(&d);
  assert_true(d.step < 1e-13);
  for (int32_t i = 0; i < SIDE; i++) /* symmetric about the middle */
    assert_near(f.q[2 * i] + f.q[2 * (SIDE - 1 - i)], SIDE - 1, 1e-11);
}

TEST(refused_memory) {
  for (int large = 0; large < 2; large++) {
    OWN(fixture) f = {.scene = build_scene()};
    structure_chain(&f.scene, large ? 40 : 2, STRUT_MASS_LUMPED);
    compile(&f, NULL, false);
    REFUSE_EACH(n, status, 1) {
      OWN(strut_arena) arena = {0};
      strut_minimiser *m;
      status = refused(n, strut_minimiser_create(f.potential, &arena, &m, NULL));
    }
  }
}
