/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paths where several things happen at once: equal and nearly equal parts, unloading, a length through zero. */
#include "tests/physics/walk.h"

static const strut_path_point *last_of(const strut_path *path) {
  return &path->points[path->point_count - 1];
}

enum { MOST = 4 };
static const double BAR = 1e6;

/* Columns of two links side by side; of column i node 3 i + 1 is the middle, drawn off by `off`. */
static strut_setup columns(int count, const double *stiffness, double off) {
  strut_setup setup = build_setup();
  for (int i = 0; i < count; i++) {
    int32_t foot = build_support(&setup.scene, 3.0 * i, 0);
    int32_t middle = build_mass(&setup.scene, 3.0 * i + off, 1, 1.0);
    int32_t top = build_mass(&setup.scene, 3.0 * i, 2, 1.0);
    setup.scene.nodes[top].fixed[0] = true;
    build_sized(&setup.scene, STRUT_BAR, foot, middle, BAR, 0, 0, 1);
    build_sized(&setup.scene, STRUT_BAR, middle, top, BAR, 0, 0, 1);
    int32_t hinge = build_hinge(&setup.scene, foot, middle, top, stiffness[i], 0);
    setup.scene.hinges[hinge].rest_angle = 3.14159265358979323846;
    build_load(&setup.scene, top, 0, -1, -1);
  }
  return setup;
}

/* Straight: P (1 - P/BAR) = 2 k. */
static double buckling_load(double stiffness) {
  return 0.5 * BAR * (1 - sqrt(1 - 8 * stiffness / BAR));
}

/* -1, 0, 1: the side to which a column has given way; else the moment at its joint is not that of its load. */
static int side_of(const strut_path_point *p, int column, double stiffness) {
  const double *foot = p->at.q + 6 * column, *middle = foot + 2;
  double x = middle[0] - foot[0], y = middle[1] - foot[1], lean = atan2(x, y);
  if (fabs(x) < 1e-8) return 0;
  assert_near(p->at.factor * x, 2 * stiffness * lean, 1e-9);
  return x > 0 ? 1 : -1;
}

/*
 * Each column is straight, or leans to either side: all combinations but the straight one branch off, each as
 * unstable as it has straight columns.
 */
TEST(equal_columns) {
  const double stiffness[MOST] = {1, 1, 1, 1};
  for (int n = 1, all = 3; n <= MOST; n++, all *= 3) {
    OWN(strut_setup) setup = columns(n, stiffness, 0);
    OWN(walk) w = walk_by(&setup, (strut_path_options){.until = 6, .branches = 2});
    bool seen[81] = {false};
    assert_int_equal(w.path.event_count, 1);
    assert_relative(w.path.events[0].at.factor, buckling_load(1), 1e-10);
    assert_all_equal(w.path.events[0].before, 0, w.path.events[0].after, n);
    assert_int_equal(w.path.branch_count, all - 1);
    for (size_t b = 0; b < w.path.branch_count; b++) {
      const strut_path *branch = &w.path.branches[b];
      int place = 0, straight = 0;
      assert_int_equal(branch->end, STRUT_PATH_UNTIL);
      assert_true(branch->from.twin > 0);
      for (int i = 0; i < n; i++) {
        int side = side_of(last_of(branch), i, 1);
        place = 3 * place + side + 1, straight += side == 0;
      }
      assert_false(seen[place]);
      seen[place] = true;
      assert_int_equal(last_of(branch)->negative, straight);
    }
  }
}

/* The same with two bifurcations beside one another: all four stable shapes are found. */
TEST(nearly_equal_columns) {
  for (int digits = 2; digits <= 8; digits++) {
    const double stiffness[2] = {1, 1 + pow(10, -digits)};
    OWN(strut_setup) setup = columns(2, stiffness, 0);
    OWN(walk) w = walk_by(&setup, (strut_path_options){.until = 6, .branches = 3});
    bool seen[9] = {false};
    int stable = 0;
    assert_int_equal(w.path.event_count, 2);
    for (int i = 0; i < 2; i++) {
      assert_relative(w.path.events[i].at.factor, buckling_load(stiffness[i]), 1e-10);
      assert_int_equal(w.path.events[i].after, i + 1);
    }
    for (size_t b = 0; b < w.path.branch_count; b++) {
      const strut_path_point *p = last_of(&w.path.branches[b]);
      int place = 3 * side_of(p, 0, stiffness[0]) + side_of(p, 1, stiffness[1]) + 4;
      stable += p->negative == 0 && !seen[place];
      seen[place] = true;
    }
    assert_int_equal(stable, 4);
  }
}

/* From either buckled shape the load falls to where the column is straight, and on. */
TEST(unloading) {
  const double stiffness = 1;
  for (int side = -1; side <= 1; side += 2) {
    OWN(strut_setup) setup = columns(1, &stiffness, 0.01 * side);
    OWN(walk) w = walk_by(&setup, (strut_path_options){.from = 3, .until = 0.5});
    assert_all_equal(side_of(&w.path.points[0], 0, 1), side, w.path.event_count, 1);
    assert_int_equal(w.path.events[0].kind, STRUT_PATH_BIFURCATION);
    assert_relative(w.path.events[0].at.factor, buckling_load(1), 1e-9);
    assert_int_equal(w.path.end, STRUT_PATH_UNTIL);
    assert_int_equal(side_of(last_of(&w.path), 0, 1), 0);
  }
}

/* Shallow trusses under equal loads, uncoupled; at rest with their tops at 0.2, drawn with them at `top`. */
static strut_setup trusses(double k, double l, double drawn) {
  strut_setup setup = build_setup();
  for (int i = 0; i < 2; i++) {
    int32_t left = build_support(&setup.scene, 3.0 * i - 1, 0);
    int32_t right = build_support(&setup.scene, 3.0 * i + 1, 0);
    int32_t top = build_mass(&setup.scene, 3.0 * i, drawn, 1.0);
    setup.scene.nodes[top].fixed[0] = true;
    build_sized(&setup.scene, STRUT_BAR, left, top, i ? l : k, 0, 0, hypot(1, 0.2));
    build_sized(&setup.scene, STRUT_BAR, right, top, i ? l : k, 0, 0, hypot(1, 0.2));
    build_load(&setup.scene, top, 0, -1, -1);
  }
  return setup;
}

/* The largest force of one of stiffness 1, where length^3 = length drawn. */
static double limit_load(void) {
  double drawn = sqrt(1.04), length = cbrt(drawn), y = sqrt(length * length - 1);
  return 2 * y * (drawn / length - 1);
}

/*
 * However little they differ, only the weaker one snaps at its limit; then the other one turns back, too. The path
 * has four turns of each kind, all but two at the weaker one's load.
 */
TEST(nearly_equal_trusses) {
  static const int weak[8] = {1, -1, 0, -1, 1, 0, 1, -1};
  for (int digits = 2; digits <= 8; digits++)
    for (int back = 0; back < 2; back++) { /* from both ends */
      double strong = 100 * (1 + pow(10, -digits));
      OWN(strut_setup) setup = trusses(100, strong, back ? -0.3 : 0.2);
      strut_path_options options = {.from = back ? 2 : 0, .until = back ? -0.4 : 2};
      OWN(walk) w = walk_by(&setup, options);
      assert_all_equal(walk_count(&w.path, STRUT_PATH_LIMIT), 8, w.path.event_count, 8);
      for (int i = 0; i < 8; i++) {
        double load = weak[i] ? weak[i] * 100 : i == 2 ? strong : -strong;
        assert_relative(w.path.events[back ? 7 - i : i].at.factor, load * limit_load(), 1e-11);
      }
      assert_int_equal(w.path.end, STRUT_PATH_UNTIL);
    }
}

/* Equal ones: a limit point from which two paths lead on which only one has snapped. */
TEST(equal_trusses) {
  OWN(strut_setup) setup = trusses(100, 100, 0.2);
  OWN(walk) w = walk_by(&setup, (strut_path_options){.until = 2, .branches = 1});
  assert_all_equal(w.path.event_count, 2, w.path.events[0].kind, STRUT_PATH_LIMIT,
                   w.path.events[0].after, 2, w.path.branch_count, 2);
  for (size_t b = 0; b < 2; b++) {
    const strut_path *branch = &w.path.branches[b];
    assert_relative(branch->from.factor, 100 * limit_load(), 1e-11);
    assert_all_equal(branch->end, STRUT_PATH_JOINED, branch->from.twin, 2 - (int)b);
    const strut_path_point *p = &branch->points[3];
    assert_int_equal(p->negative, 1);
    assert_true((p->at.q[5] - 0.2 - (p->at.q[11] - 0.2)) * (b ? 1 : -1) != 0);
  }
}

/* A strut on a spring that is pressed to nothing: there its force of k l turns round, whatever its law. */
static void press_to_nothing(strut_law_kind law) {
  const double k = 0.5, rest = 2, load = 5;
  OWN(strut_setup) setup = build_setup();
  int32_t a = build_support(&setup.scene, 0, 0), c = build_support(&setup.scene, 100, -1);
  int32_t b = build_mass(&setup.scene, 100, 1, 1.0);
  setup.scene.nodes[b].fixed[0] = true;
  build_member(&setup.scene, STRUT_BAR, a, b, 1e7 / hypot(100, 1), 0, 0);
  build_member(&setup.scene, STRUT_SPRING, b, c, k, 0, 0);
  build_load(&setup.scene, b, 0, -load, -1);
  setup.scene.members[1].law.kind = law;
  setup.scene.members[1].law.knee = 10, setup.scene.members[1].law.second_stiffness = k;
  OWN(walk) w = walk_by(&setup, (strut_path_options){.until = 1});
  assert_int_equal(walk_count(&w.path, STRUT_PATH_ZERO_LENGTH), 1);
  const strut_path_event *e = &w.path.events[2], *turn = &w.path.events[1];
  assert_all_equal(turn->kind, STRUT_PATH_LIMIT, e->kind, STRUT_PATH_ZERO_LENGTH);
  assert_all_near(1e-9, e->at.q[2 * b + 1], -1, e->at.factor, -k * rest / load);
  assert_true(w.path.end == STRUT_PATH_UNTIL && last_of(&w.path)->at.q[2 * b + 1] < -1);
  bool before = false;
  for (size_t i = 0; i < w.path.point_count; i++)
    before = before || fabs(w.path.points[i].at.factor - k * rest / load) < 1e-9;
  assert_true(before);
}
TEST(zero_length) { press_to_nothing(STRUT_LAW_LINEAR); }
TEST(zero_length_of_a_law) { press_to_nothing(STRUT_LAW_BILINEAR); }
