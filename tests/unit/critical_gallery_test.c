/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All stationary points of structures whose answers are known, built by hand. */
#include <math.h>

#include "tests/support/build.h"
#include "tests/support/check.h"
#include "tests/unit/critical_support.h"

/* P1: one shape in four placements. */
TEST(snelsons_square) {
  static const node_row node[] = {{0, 0, 3}, {1, 0, 2}, {1, 1, 0}, {0, 1, 0}};
  static const double eigenvalue[] = {41.420771, 99.582797, 157.296395, 1105.450613, 1607.664949};
  const double diagonal = sqrt(2);
  const member_row member[] = {
      {STRUT_CABLE, 1, 2, 100, 0.95},    {STRUT_CABLE, 2, 3, 100, 0.95},
      {STRUT_CABLE, 3, 4, 100, 0.95},    {STRUT_CABLE, 4, 1, 100, 0.95},
      {STRUT_BAR, 2, 4, 1000, diagonal}, {STRUT_BAR, 1, 3, 1000, diagonal}};
  fixture f = {0};
  BUILD(&f.scene, node, member);
  critical_find(&f, NULL, false, true);
  assert_minima(&f, (double[]){5.0 / 11}, 1, 1e-13);
  assert_int_equal(f.set.points[0].placements, 4);
  for (int i = 0; i < 5; i++) assert_near(f.set.points[0].eigenvalues[i], eigenvalue[i], 1e-6);
  critical_tear_down(&f);

  BUILD(&f.scene, node, member); /* the same in the air: two placements, three free motions */
  f.scene.nodes[0].fixed[0] = f.scene.nodes[0].fixed[1] = f.scene.nodes[1].fixed[1] = false;
  critical_find(&f, NULL, false, false);
  assert_minima(&f, (double[]){5.0 / 11}, 1, 1e-13);
  assert_int_equal(f.set.points[0].rigid, 3);
  assert_int_equal(f.set.points[0].zero, 3);
  assert_true(f.set.points[0].placements <= 2);
  critical_tear_down(&f);
}

/* P2: the folded twin has the same member lengths and energy, and is another shape. */
TEST(double_square) {
  static const node_row node[] = {{0, 0, 3}, {1, 0, 2}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}};
  const double d = sqrt(2);
  const member_row member[] = {{STRUT_BAR, 1, 3, 1000, d},     {STRUT_BAR, 2, 4, 1000, d},
                               {STRUT_BAR, 2, 6, 1000, d},     {STRUT_BAR, 3, 5, 1000, d},
                               {STRUT_CABLE, 1, 2, 100, 0.95}, {STRUT_CABLE, 2, 3, 100, 0.95},
                               {STRUT_CABLE, 3, 4, 100, 0.95}, {STRUT_CABLE, 4, 1, 100, 0.95},
                               {STRUT_CABLE, 2, 5, 100, 0.95}, {STRUT_CABLE, 5, 6, 100, 0.95},
                               {STRUT_CABLE, 6, 3, 100, 0.95}};
  fixture f = {0};
  BUILD(&f.scene, node, member);
  critical_find(&f, NULL, false, false);
  assert_minima(&f, (double[]){0.741869206537, 0.741869206537}, 2, 1e-11);
  double a = f.set.points[0].eigenvalues[0], b = f.set.points[1].eigenvalues[0];
  assert_near(fmin(a, b), 15.634929, 1e-6);
  assert_near(fmax(a, b), 23.4244, 1e-4);
  assert_int_equal(f.set.points[0].placements + f.set.points[1].placements, 8);
  assert_int_not_equal(f.set.points[0].shape, f.set.points[1].shape);
  critical_tear_down(&f);
}

/* P3: a rhombus of stiff bars: one prestressed shape that may turn, and one continuum of slack ones. */
TEST(d_bar) {
  static const node_row node[] = {{0, 0, 3}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const double d = sqrt(2), ea = 219.911486;
  const member_row member[] = {
      {STRUT_BAR, 4, 1, 1e7, 1},      {STRUT_BAR, 1, 2, 1e7, 1},
      {STRUT_BAR, 2, 3, 1e7, 1},      {STRUT_BAR, 3, 4, 1e7, 1},
      {STRUT_CABLE, 2, 4, ea / d, d}, {STRUT_CABLE, 1, 3, ea / d / 0.7, 0.7 * d}};
  fixture f = {0};
  BUILD(&f.scene, node, member);
  critical_find(&f, NULL, false, false);
  assert_int_equal(f.set.count, 2);
  assert_int_equal(f.set.points[0].label, STRUT_FLOPPY);
  assert_near(f.set.points[0].potential, 0, 1e-15);
  assert_int_equal(f.set.points[1].label, STRUT_STABLE);
  assert_int_equal(f.set.points[1].rigid, 1);
  assert_near(f.set.points[1].potential, 6.4389642, 1e-6);
  critical_tear_down(&f);
}

/* P5 without load: upright and hanging, and two saddles with the bar on its side. */
TEST(half_t_bar) {
  static const node_row node[] = {{-1, 0, 3}, {0, 0, 3}, {1, 0, 3}, {0, 1, 0}};
  const double bar = 1.0000043657, cable = 1.4140076829;
  const member_row member[] = {{STRUT_BAR, 2, 4, 11453019.53174 / bar, bar},
                               {STRUT_CABLE, 1, 4, 242825.130902 / cable, cable},
                               {STRUT_CABLE, 3, 4, 242825.130902 / cable, cable}};
  fixture f = {0};
  BUILD(&f.scene, node, member);
  critical_find(&f, NULL, false, true);
  assert_minima(&f, (double[]){0.00738808, 0.00738808}, 2, 1e-8);
  assert_relative(f.set.points[0].eigenvalues[0], 171703.2967, 1e-9);
  assert_relative(f.set.points[0].eigenvalues[1], 11624722.8284, 1e-9);
  assert_int_equal(f.set.points[1].shape, 0);
  assert_saddle(&f, 29049.497, 1e-3, 1);
  critical_tear_down(&f);
}

/* P6: a mechanism that prestress alone stiffens, with two kinds of saddle. */
TEST(hexagon_of_cables) {
  const double h = sqrt(7) / 4, p = 0.3;
  const node_row node[] = {{0, 0, 3},         {h, 0.75, 0},      {h + 1, 0.75, 0},
                           {2 * h + 1, 0, 3}, {h + 1, -0.75, 0}, {h, -0.75, 0}};
  const member_row member[] = {
      {STRUT_CABLE, 1, 2, 1, 1 - p},         {STRUT_CABLE, 2, 3, 1, 1 - p},
      {STRUT_CABLE, 3, 4, 1, 1 - p},         {STRUT_CABLE, 4, 5, 1, 1 - p},
      {STRUT_CABLE, 5, 6, 1, 1 - p},         {STRUT_CABLE, 6, 1, 1, 1 - p},
      {STRUT_BAR, 2, 6, 0.5, 1.5 * (1 + p)}, {STRUT_BAR, 3, 5, 0.5, 1.5 * (1 + p)}};
  fixture f = {0};
  BUILD(&f.scene, node, member);
  critical_find(&f, NULL, false, true);
  assert_minima(&f, (double[]){0.363146484, 0.363146484}, 2, 1e-9);
  assert_near(f.set.points[0].eigenvalues[0], 0.200814, 1e-6);
  assert_near(f.set.points[0].eigenvalues[1], 0.564213, 1e-6);
  assert_int_equal(f.set.points[1].shape, f.set.points[0].shape);
  assert_saddle(&f, 0.67448409, 1e-8, 1);
  assert_saddle(&f, 0.83992735, 1e-8, 1);
  critical_tear_down(&f);
}

/* P9: snap-through, and the apex beyond a support. */
TEST(von_mises_truss) {
  static const node_row node[] = {{-1, 0, 3}, {1, 0, 3}, {0, 0.5, 0}};
  const double l = sqrt(1.25);
  const member_row member[] = {{STRUT_BAR, 1, 3, 1, l}, {STRUT_BAR, 2, 3, 1, l}};
  fixture f = {0};
  BUILD(&f.scene, node, member);
  critical_find(&f, NULL, false, true);
  assert_minima(&f, (double[]){0, 0}, 2, 1e-15);
  assert_int_equal(f.set.count, 5);
  const strut_critical_point *pass = &f.set.points[2], *aside = &f.set.points[3];
  assert_near(pass->potential, (l - 1) * (l - 1), 1e-15);
  assert_near(pass->eigenvalues[0], -0.2360679775, 1e-9);
  assert_near(pass->eigenvalues[1], 2, 1e-14);
  assert_int_equal(pass->down[0] + pass->down[1], 1);
  assert_near(aside->potential, 1, 1e-15);
  assert_near(fabs(aside->q[4]), l, 1e-14);
  assert_int_equal(aside->negative, 1);
  critical_tear_down(&f);
}

/* P10: two bistable cells; the mixed states go when the coupling grows. */
TEST(bistable_cells) {
  const double l = sqrt(1.09), couplings[] = {0.01, 0.0290, 0.0293};
  const node_row node[] = {{-1, 0, 3}, {1, 0, 3}, {0, 0.3, 1}, {-1, 2, 3}, {1, 2, 3}, {0, 2.3, 1}};
  for (int i = 0; i < 3; i++) {
    fixture f = {0};
    const member_row member[] = {{STRUT_BAR, 1, 3, 1, l},
                                 {STRUT_BAR, 2, 3, 1, l},
                                 {STRUT_BAR, 4, 6, 1, l},
                                 {STRUT_BAR, 5, 6, 1, l},
                                 {STRUT_SPRING, 3, 6, couplings[i], 2}};
    BUILD(&f.scene, node, member);
    critical_find(&f, NULL, false, true);
    assert_int_equal(count_of(&f, STRUT_STABLE), i < 2 ? 4 : 2);
    if (i == 0) {
      const double e = 0.001584158416;
      assert_minima(&f, (double[]){0, 0, e, e}, 4, 1e-12);
      assert_int_equal(count_of(&f, STRUT_SADDLE), 4);
      for (int k = 4; k < 8; k++) assert_near(f.set.points[k].potential, 0.002412301, 1e-9);
      assert_int_equal(count_of(&f, STRUT_MAXIMUM), 1);
      assert_near(f.set.points[8].potential, 0.003877396, 1e-9);
    }
    critical_tear_down(&f);
  }
}

/* P11: Zeeman's machine inside and outside its cusp. */
TEST(zeemans_machine) {
  static const struct {
    double x, y;
    size_t stable;
    double energy[2];
  } answer[] = {{0, 0, 1, {0.681319842}},      {0.1, -0.25, 2, {0.708701247, 0.725778073}},
                {0.1, -0.5, 1, {0.696760380}}, {0.1, -0.3433, 2, {0}},
                {0.1, -0.3435, 1, {0}},        {0.1, -0.1447, 2, {0}},
                {0.1, -0.1444, 1, {0}}};
  for (size_t i = 0; i < sizeof answer / sizeof answer[0]; i++) {
    fixture f = {0};
    const node_row node[] = {{1, 0, 3}, {2, 0.25, 3}, {answer[i].x, answer[i].y, 3}, {1.2, 0.4, 0}};
    const member_row member[] = {
        {STRUT_BAR, 1, 4, 1e6, 0.5}, {STRUT_CABLE, 2, 4, 1, 0.25}, {STRUT_CABLE, 3, 4, 1, 0.25}};
    BUILD(&f.scene, node, member);
    critical_find(&f, NULL, false, true);
    assert_int_equal(count_of(&f, STRUT_STABLE), answer[i].stable);
    for (size_t k = 0; k < answer[i].stable && answer[i].energy[0] > 0; k++)
      assert_near(f.set.points[k].potential, answer[i].energy[k], 1e-6);
    if (i == 1) {
      assert_saddle(&f, 0.740753781, 1e-6, 1);
      assert_saddle(&f, 0.837260196, 1e-6, 1);
    }
    critical_tear_down(&f);
  }
}

/* P12: crossed bars and the parallelogram, each up and down. */
TEST(x_joint) {
  const double s = sqrt(0.0075);
  const node_row node[] = {{0, 0, 3}, {0.05, 0, 3}, {0.05, s, 0}, {0, s, 0}};
  const member_row member[] = {{STRUT_BAR, 1, 3, 1e6, 0.1},
                               {STRUT_BAR, 2, 4, 1e6, 0.1},
                               {STRUT_BAR, 4, 3, 1e6, 0.05},
                               {STRUT_CABLE, 1, 4, 100, 0.06},
                               {STRUT_CABLE, 2, 3, 100, 0.06}};
  const double crossed = 0.070758901, open = 0.26833506;
  fixture f = {0};
  BUILD(&f.scene, node, member);
  critical_find(&f, NULL, false, true);
  assert_minima(&f, (double[]){crossed, crossed, open, open}, 4, 1e-8);
  assert_near(f.set.points[0].eigenvalues[0], 32.6775, 1e-4);
  critical_tear_down(&f);
}

/*
 * P13: besides the four states of the formula, which takes a spring's length as signed, there is a
 * fifth beyond the cusp where one spring is a point: turned right round onto the fixed triangle.
 */
TEST(dual_triangle) {
  const double c = sqrt(0.75);
  const node_row node[] = {{0, 0, 3}, {-c, 0.5, 3}, {-c, -0.5, 3}, {c, -0.5, 0}, {c, 0.5, 0}};
  const member_row member[] = {{STRUT_BAR, 1, 4, 1e6, 1},
                               {STRUT_BAR, 1, 5, 1e6, 1},
                               {STRUT_BAR, 4, 5, 1e6, 1},
                               {STRUT_SPRING, 2, 4, 100, 0.8},
                               {STRUT_SPRING, 3, 5, 100, 0.8}};
  fixture f = {0};
  BUILD(&f.scene, node, member);
  critical_find(&f, NULL, false, true);
  assert_minima(&f, (double[]){0, 0, 4, 67.995, 67.995}, 5, 1e-3);
  for (size_t i = 0; i < 5; i++) {
    const double *q = f.set.points[i].q;
    double turned = fabs(atan2(q[7] + q[9], q[6] + q[8])) * 180 / acos(-1);
    assert_near(turned, i < 2 ? 132.8436 : i == 2 ? 180 : 92.2908, 1e-3);
  }
  assert_saddle(&f, 86.8588, 1e-4, 1);
  assert_saddle(&f, 143.9856, 1e-4, 1);
  critical_tear_down(&f);
}
