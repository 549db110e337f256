/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Self-stress and mechanisms of structures whose answers are known, or closed forms. */
#include <math.h>
#include <string.h>

#include "tests/physics/truss.h"
#include "tests/support/build.h"
#include "tests/support/check.h"

static const double X[][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {2, 1}};

static void x_frame(strut_scene *scene) {
  strut_scene_init(scene);
  truss_nodes(scene, X, 4);
  truss_members(scene, STRUT_CABLE, "1-2 2-3 3-4 4-1");
  truss_members(scene, STRUT_BAR, "2-4 1-3");
}

TEST(x_frame) {
  static const double density[] = {1, 1, 1, 1, -1, -1};
  strut_scene scene;
  truss t;
  x_frame(&scene);
  truss_hold(&scene, 1, true, true);
  truss_hold(&scene, 2, false, true);
  truss_look(&t, &scene);
  truss_expect(&t, 5, 1, 0);
  truss_expect_densities(&t, density, 1e-13);
  assert_near(t.found.spaces.kept, 0.505, 5e-4);
  assert_near(t.found.spaces.dropped, 0.0, 1e-15);
  assert_near(t.found.states.force[0], 1.0, 0.0);
  assert_near(t.found.states.force[4], -sqrt(2.0), 1e-13);
  assert_true(t.found.states.cables_pull[0]);
  assert_true(t.found.stress.super_stable);
  assert_int_equal(t.found.bars_at_node, 1);
  assert_string_equal(t.found.tensegrity.label, "structure with tensegrity features of class 2");
  truss_free(&t);
}

/* Without supports: three rigid-body motions, none of them out of the plane, and no other. */
TEST(x_frame_unsupported) {
  strut_scene scene;
  truss t;
  x_frame(&scene);
  truss_look(&t, &scene);
  truss_expect(&t, 5, 1, 3);
  truss_expect_kinds(&t, 3, 0, 0);
  assert_near(t.found.spaces.kept, sqrt(2.0), 1e-13);
  truss_free(&t);
}

/* Its bars as cables and its cables as bars: the state must press the sides, not the cables. */
TEST(sign_follows_the_cables) {
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_nodes(&scene, X, 4);
  truss_members(&scene, STRUT_BAR, "1-2 2-3 3-4 4-1");
  truss_members(&scene, STRUT_CABLE, "2-4 1-3");
  truss_look(&t, &scene);
  truss_expect(&t, 5, 1, 3);
  assert_near(t.found.states.force[4], 1.0, 0.0);
  assert_near(t.found.states.force[0], -1.0 / sqrt(2.0), 1e-13);
  assert_false(t.found.stress.super_stable);
  truss_free(&t);
}

/* Two cells that share a cable: each cell's state by itself, none loads the other's bars. */
TEST(double_x) {
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_nodes(&scene, X, 6);
  truss_members(&scene, STRUT_BAR, "1-3 2-4 2-6 3-5");
  truss_members(&scene, STRUT_CABLE, "1-2 2-3 3-4 4-1 2-5 5-6 6-3");
  truss_hold(&scene, 1, true, true);
  truss_hold(&scene, 2, false, true);
  truss_look(&t, &scene);
  truss_expect(&t, 9, 2, 0);
  assert_near(t.found.spaces.kept, 0.2903, 5e-5);
  for (int i = 0; i < 2; i++) {
    int used = 0;
    for (int j = 0; j < 11; j++) used += t.found.states.force[11 * i + j] != 0.0;
    assert_int_equal(used, 6);
  }
  assert_true(t.found.cables_can_pull);
  /* one cell folds over the other with all lengths kept: no super stability */
  assert_int_equal(t.found.stress.nullity, 4);
  assert_true(t.found.stress.positive);
  assert_false(t.found.stress.super_stable);
  assert_int_equal(t.found.bars_at_node, 2);
  truss_free(&t);
}

/* A rhombus of bars with two cables, pinned at a corner: it only turns. */
TEST(d_bar) {
  static const double density[] = {-1, -1, -1, -1, 1, 1};
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_nodes(&scene, X, 4);
  truss_members(&scene, STRUT_BAR, "4-1 1-2 2-3 3-4");
  truss_members(&scene, STRUT_CABLE, "2-4 1-3");
  truss_hold(&scene, 1, true, true);
  truss_look(&t, &scene);
  truss_expect(&t, 5, 1, 1);
  truss_expect_kinds(&t, 1, 0, 0);
  truss_expect_densities(&t, density, 1e-13);
  assert_near(t.found.spaces.kept, 0.765, 5e-4);
  truss_free(&t);
}

/* The same without cables: the rhombus moves, by more than the plane's three ways. */
TEST(four_bars_move) {
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_nodes(&scene, X, 4);
  truss_members(&scene, STRUT_BAR, "4-1 1-2 2-3 3-4");
  truss_look(&t, &scene);
  truss_expect(&t, 4, 0, 4);
  truss_expect_kinds(&t, 3, 0, 1);
  const strut_mechanism *mode = &t.found.mechanisms.list[3];
  assert_within(mode->moved, 0.02, 0.3);
  assert_within(mode->strain, 0.0, 1e-12);
  truss_free(&t);
}

/* A rhombus folded flat opens as a rhombus or as a bar that swings: two finite motions. */
TEST(folded_rhombus) {
  static const double at[][2] = {{0, 0}, {1, 0}, {2, 0}, {1, 0}};
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_nodes(&scene, at, 4);
  truss_members(&scene, STRUT_BAR, "1-2 2-3 3-4 4-1");
  truss_look(&t, &scene);
  truss_expect(&t, 3, 1, 5);
  truss_expect_kinds(&t, 3, 0, 2);
  truss_free(&t);
}

TEST(t_bar) {
  static const double at[][2] = {{-1, 0}, {0, -1}, {1, 0}, {0, 1}};
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_nodes(&scene, at, 4);
  truss_members(&scene, STRUT_BAR, "1-3 2-4");
  truss_members(&scene, STRUT_SPRING, "1-2 3-4 2-3 4-1");
  truss_look(&t, &scene);
  truss_expect(&t, 5, 1, 3);
  assert_near(t.found.spaces.kept, sqrt(2.0), 1e-13);
  truss_free(&t);
}

TEST(half_t_bar) {
  static const double at[][2] = {{-1, 0}, {0, 0}, {1, 0}, {0, 1}};
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_nodes(&scene, at, 4);
  truss_members(&scene, STRUT_BAR, "2-4");
  truss_members(&scene, STRUT_CABLE, "1-4 3-4");
  for (int i = 1; i <= 3; i++) truss_hold(&scene, i, true, true);
  truss_look(&t, &scene);
  truss_expect(&t, 2, 1, 0);
  assert_near(t.found.spaces.kept, 1.0, 1e-14);
  assert_near(t.found.states.force[0], -sqrt(2.0), 1e-14);
  assert_near(t.found.states.force[2], 1.0, 1e-14);
  /* densities sqrt(1/2) twice and -sqrt(2) leave nothing on the free node */
  assert_true(t.found.stress.supported);
  assert_false(t.found.stress.super_stable);
  truss_free(&t);
}

static void hexagon_of_two_struts(strut_scene *scene) {
  double h = sqrt(7.0) / 4.0;
  const double at[][2] = {{0, 0},         {h, 0.75},      {h + 1, 0.75},
                          {2 * h + 1, 0}, {h + 1, -0.75}, {h, -0.75}};
  strut_scene_init(scene);
  truss_nodes(scene, at, 6);
  truss_members(scene, STRUT_CABLE, "1-2 2-3 3-4 4-5 5-6 6-1");
  truss_members(scene, STRUT_BAR, "2-6 3-5");
}

/* A prestressed infinitesimal mechanism: the shear of the upper nodes against the lower ones. */
TEST(hexagon_of_two_struts) {
  strut_scene scene;
  truss t;
  double h = sqrt(7.0) / 4.0;
  hexagon_of_two_struts(&scene);
  truss_hold(&scene, 1, true, true);
  truss_hold(&scene, 4, true, true);
  truss_look(&t, &scene);
  truss_expect(&t, 7, 1, 1);
  truss_expect_kinds(&t, 0, 1, 0);
  const double force[] = {1, h, 1, 1, h, 1, -0.75, -0.75};
  for (int j = 0; j < 8; j++) assert_near(t.found.states.force[j], force[j], 1e-13);
  assert_near(t.found.spaces.kept, 0.572, 5e-4);
  const double *d = t.found.mechanisms.list[0].motion; /* nodes 2, 3, 5, 6 */
  double unit = d[0] / -0.375;
  const double shear[] = {-0.375, 0.330718914,  -0.375, -0.330718914,
                          0.375,  -0.330718914, 0.375,  0.330718914};
  for (int i = 0; i < 8; i++) assert_near(fabs(d[i]), fabs(unit * shear[i]), 1e-9);
  assert_near(d[0], d[2], 1e-12);
  assert_near(d[4], d[6], 1e-12);
  assert_near(d[0], -d[4], 1e-12);
  assert_non_null(t.found.mechanisms.stiffener);
  assert_true(t.found.mechanisms.stiffener_pulls);
  assert_string_equal(t.found.tensegrity.label, "ideal tensegrity");
  truss_free(&t);
  hexagon_of_two_struts(&scene);
  truss_look(&t, &scene);
  truss_expect(&t, 8, 0, 4);
  truss_expect_kinds(&t, 3, 0, 1);
  assert_string_equal(t.found.tensegrity.label, "no tensegrity: no state of self-stress");
  truss_free(&t);
}

/* Where the shape carries its prestress, the stiffness of the mechanism comes from it. */
TEST(prestress_stiffens) {
  strut_scene scene;
  truss t;
  double h = sqrt(7.0) / 4.0, force[] = {1, h, 1, 1, h, 1, -0.75, -0.75};
  hexagon_of_two_struts(&scene);
  truss_hold(&scene, 1, true, true);
  truss_hold(&scene, 4, true, true);
  for (int j = 0; j < 8; j++) {
    scene.members[j].stiffness = 10.0;
    scene.members[j].rest_kind = STRUT_REST_PRETENSION;
    scene.members[j].rest_value = 0.5 * force[j];
  }
  truss_look(&t, &scene);
  assert_true(t.found.equilibrium);
  assert_true(t.found.self_equilibrium);
  assert_true(t.found.mechanisms.by_forces);
  /* by hand: sum of density |d2 - d1|^2 over |d|^2, d as above, |d|^2 = 4 (0.375^2 + (h/2)^2) */
  double sum = 0.0, a = 0.375, b = h / 2.0, all = 4 * (a * a + b * b);
  sum += 4 * 0.5 * (a * a + b * b);           /* sloping cables, length 1: their one free end */
  sum += 2 * 0.5 * h * 4 * b * b;             /* horizontal cables: ends move by -+b in y */
  sum += 2 * 0.5 * (-0.75 / 1.5) * 4 * a * a; /* struts: ends move by -+a in x */
  assert_near(t.found.mechanisms.list[0].stiffness, sum / all, 1e-12);
  truss_free(&t);
}

static void hexagon(strut_scene *scene, double shift) {
  strut_scene_init(scene);
  truss_ring(scene, 6);
  scene->nodes[0].position[0] += shift, scene->nodes[0].start[0] += shift;
  truss_members(scene, STRUT_CABLE, "1-2 2-3 3-4 4-5 5-6 6-1");
  truss_members(scene, STRUT_BAR, "1-4 2-5 3-6");
}

/* Nodes on a conic: a state of self-stress and a mechanism that any shift of a node removes. */
TEST(regular_hexagon) {
  static const double density[] = {1, 1, 1, 1, 1, 1, -0.5, -0.5, -0.5};
  static const double eigenvalues[] = {0, 0, 0, 3, 3, 3};
  strut_scene scene;
  truss t;
  hexagon(&scene, 0.0);
  truss_look(&t, &scene);
  truss_expect(&t, 8, 1, 4);
  truss_expect_kinds(&t, 3, 1, 0);
  truss_expect_densities(&t, density, 1e-13);
  assert_near(t.found.spaces.kept, sqrt(1.5), 1e-12);
  for (int i = 0; i < 6; i++) assert_near(t.found.stress.eigenvalues[i], eigenvalues[i], 1e-12);
  assert_int_equal(t.found.stress.nullity, 3);
  assert_true(t.found.stress.super_stable);
  assert_string_equal(t.found.tensegrity.label, "ideal tensegrity");
  truss_free(&t);
  static const struct {
    double shift, kept;
  } moved[] = {{1e-6, 4.08e-7}, {1e-3, 4.079e-4}, {0.1, 0.0376}};
  for (int i = 0; i < 3; i++) {
    hexagon(&scene, moved[i].shift);
    truss_look(&t, &scene);
    truss_expect(&t, 9, 0, 3);
    assert_relative(t.found.spaces.kept, moved[i].kept, 2e-3);
    truss_free(&t);
  }
}

TEST(cauchy_hexagon) {
  static const double density[] = {1, 2, 2.5, 2, 1, 0.5, -0.5, -1, -1, -0.5};
  static const double eigenvalues[] = {0, 0, 0, 1.62771868, 3, 7.37228132};
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_ring(&scene, 6);
  truss_members(&scene, STRUT_CABLE, "1-2 2-3 3-4 4-5 5-6 6-1");
  truss_members(&scene, STRUT_BAR, "1-3 2-4 3-5 4-6");
  truss_look(&t, &scene);
  truss_expect(&t, 9, 1, 3);
  truss_expect_kinds(&t, 3, 0, 0);
  truss_expect_densities(&t, density, 1e-12);
  assert_near(t.found.spaces.kept, 0.366, 5e-4);
  for (int i = 0; i < 6; i++) assert_near(t.found.stress.eigenvalues[i], eigenvalues[i], 1e-8);
  assert_true(t.found.stress.super_stable);
  truss_free(&t);
}

TEST(von_mises) {
  static const double at[][2] = {{-1, 0}, {1, 0}, {0, 0.3}};
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_nodes(&scene, at, 3);
  truss_members(&scene, STRUT_BAR, "1-3 2-3");
  truss_hold(&scene, 1, true, true);
  truss_hold(&scene, 2, true, true);
  truss_look(&t, &scene);
  truss_expect(&t, 2, 0, 0);
  /* columns at angles +-atan 0.3: squares of the singular values 2 / 1.09 and 2 * 0.09 / 1.09 */
  assert_near(t.found.spaces.kept, sqrt(0.18 / 1.09), 1e-14);
  assert_int_equal(t.found.bars_at_node, 2);
  truss_free(&t);
}

/* Flat, it is the textbook's infinitesimal mechanism: tension stiffens it, and s = f = 1. */
TEST(flat_von_mises) {
  static const double at[][2] = {{-1, 0}, {1, 0}, {0, 0}};
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_nodes(&scene, at, 3);
  truss_members(&scene, STRUT_CABLE, "1-3 2-3");
  truss_hold(&scene, 1, true, true);
  truss_hold(&scene, 2, true, true);
  truss_look(&t, &scene);
  truss_expect(&t, 1, 1, 1);
  truss_expect_kinds(&t, 0, 1, 0);
  assert_near(t.found.mechanisms.list[0].stress_form, 2.0, 1e-13); /* two densities of 1 */
  assert_true(t.found.stress.super_stable);
  truss_free(&t);
}

/* A parallelogram on two pins with a third bar in parallel: overbraced, and yet it moves. */
TEST(parallel_bars_move) {
  static const double at[][2] = {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}};
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_nodes(&scene, at, 6);
  truss_members(&scene, STRUT_BAR, "1-4 2-5 3-6 4-5 5-6 4-6");
  for (int i = 1; i <= 3; i++) truss_hold(&scene, i, true, true);
  truss_look(&t, &scene);
  /* 4-5-6 is straight: one state in it, stiffening 5 against 4-6 only; the swing stays */
  assert_int_equal(t.found.mechanisms.count - t.found.states.count, 0);
  assert_int_equal(t.found.mechanisms.finite, 1);
  truss_free(&t);
}

/* A frame of `count` directions, each a straight row of three nodes that can be stressed alone. */
static bool lies_on_conic(int count, const double *angle) {
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  build_mass(&scene, 0, 0, 1);
  for (int k = 0; k < count; k++)
    for (int i = 1; i <= 2; i++) build_mass(&scene, i * cos(angle[k]), i * sin(angle[k]), 1);
  for (int k = 0; k < count; k++) {
    int32_t near = 2 * k + 1, far = near + 1;
    build_member(&scene, STRUT_CABLE, 0, near, 1, 0, 0);
    build_member(&scene, STRUT_CABLE, near, far, 1, 0, 0);
    build_member(&scene, STRUT_BAR, 0, far, 1, 0, 0);
  }
  truss_look(&t, &scene);
  assert_true(t.found.stress.tested);
  bool on_conic = t.found.stress.on_conic;
  truss_free(&t);
  return on_conic;
}

/* Two directions, however they are turned, always lie on a conic; three that differ never do. */
TEST(two_directions_lie_on_a_conic) {
  for (int i = 0; i < 12; i++) {
    double turn = 0.5 * i, angle[] = {turn, turn + 0.9 + 0.1 * i, turn + 0.4};
    assert_true(lies_on_conic(1, angle));
    assert_true(lies_on_conic(2, angle));
    assert_false(lies_on_conic(3, angle));
    angle[2] = angle[0] + 1e-3; /* near is not on it */
    assert_false(lies_on_conic(3, angle));
  }
}
