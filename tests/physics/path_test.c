/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paths of equilibria: limit points, forks, slackening and contact against closed forms. */
#include "tests/physics/walk.h"

static const strut_path_point *last(const walk *w) {
  assert_int_equal(w->path.end, STRUT_PATH_UNTIL);
  return &w->path.points[w->path.point_count - 1];
}

/* The number-th event of its kind. */
static const strut_path_event *event(const walk *w, strut_path_event_kind kind, int number) {
  for (size_t i = 0; i < w->path.event_count; i++)
    if (w->path.events[i].kind == kind && number-- == 0) return &w->path.events[i];
  fail_msg("no such event: %s", strut_path_event_name(kind));
  return NULL;
}

/* The truss pressed by 1 N times the factor. */
static strut_setup pressed_arch(double a, double h, double k) {
  strut_setup setup = arch(a, h, k);
  build_load(&setup.scene, 2, 0, -1, -1);
  return setup;
}

/* Both limit points, every point of the curve, and where it ends. */
static void check_arch(double a, double h, double k, double expected, double digits) {
  double rest = hypot(a, h), length = cbrt(rest * a * a), top = sqrt(length * length - a * a);
  double limit = arch_load(a, h, k, top);
  OWN(strut_setup) setup = pressed_arch(a, h, k);
  OWN(walk) w = walk_until(&setup, 1.5 * limit);
  assert_near(limit, expected, digits);
  assert_int_equal(walk_count(&w.path, STRUT_PATH_LIMIT), 2);
  for (int i = 0; i < 2; i++) {
    const strut_path_event *e = event(&w, STRUT_PATH_LIMIT, i);
    assert_relative(e->at.factor, i ? -limit : limit, 1e-12);
    assert_relative(e->at.q[5], i ? -top : top, 1e-10);
    assert_near(e->at.q[4], 0, 1e-12 * a);
  }
  for (size_t i = 0; i < w.path.point_count; i++) {
    const strut_path_point *p = &w.path.points[i];
    double y = p->at.q[5];
    assert_near(p->at.factor, arch_load(a, h, k, y), 1e-10 * limit);
    assert_int_equal(p->negative, fabs(y) > top ? 0 : 1);
  }
  assert_all(last(&w)->at.factor == 1.5 * limit, last(&w)->at.q[5] < -h);
  for (int side = -1; side <= 1;
       side += 2) { /* a hair below the limit it ends there, above on the far side */
    OWN(walk) near = walk_until(&setup, limit * (1 + side * 1e-11));
    assert_int_equal(walk_count(&near.path, STRUT_PATH_LIMIT), side + 1);
  }
}

TEST(limit_points) {
  double b = 5, h = 1;
  check_arch(b, h, 1280e6 / hypot(b, h), 3789.46e3, 0.005e3);
  check_arch(0.84523652, 1.81261557, 2.625e8, 3.03160194e8, 1);
  check_arch(1, 0.3, 1000, 9.94991696, 5e-9);
  check_arch(1, 0.5, 1, 0.04291433, 5e-9);
}

/* A node on an upright spring begins in the ground, where nothing holds it, and is lifted off. */
TEST(lifted_node) {
  const double k = 100, ground = 1000, deep = 0.05, load = 20;
  OWN(strut_setup) setup = build_setup();
  int32_t top = build_support(&setup.scene, 0, 1 - deep);
  int32_t node = build_node(&setup.scene, 0, -deep);
  setup.scene.nodes[node].fixed[0] = true;
  build_member(&setup.scene, STRUT_SPRING, top, node, k, 0, 0);
  build_contact(&setup.scene, node, ground, 0);
  build_load(&setup.scene, node, 0, 1, -1);
  OWN(walk) w = walk_until(&setup, load);
  /* spring force k (0.05 - depth) = ground depth */
  assert_near(w.path.points[0].at.q[3], -deep * k / (k + ground), 1e-13);
  assert_relative(event(&w, STRUT_PATH_LIFT_OFF, 0)->at.factor, k * deep, 1e-10);
  assert_near(last(&w)->at.q[3], load / k - deep, 1e-12);
}

/* Snelson's X, a box, lifted at one corner tips when the load is half its weight: the others leave together. */
TEST(lift_off) {
  OWN(strut_setup) setup = build_setup();
  setup.scene.gravity[1] = -9.81;
  for (int32_t i = 0; i < 4; i++) {
    build_mass(&setup.scene, i == 1 || i == 2, i > 1, 0.1);
    build_contact(&setup.scene, i, 1e5, 0);
  }
  for (int32_t i = 0; i < 4; i++)
    build_sized(&setup.scene, STRUT_CABLE, i, (i + 1) % 4, 100, 0, 0, 0.95);
  build_member(&setup.scene, STRUT_BAR, 1, 3, 1000, 0, 0);
  build_member(&setup.scene, STRUT_BAR, 0, 2, 1000, 0, 0);
  build_load(&setup.scene, 2, 0, 1, -1);
  OWN(walk) w = walk_until(&setup, 1.9);
  assert_int_equal(w.path.event_count, 0);
  strut_path path = {0};
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  strut_path_options options = {.until = 3, .steps = 60};
  assert_ok(strut_path_follow(model, &setup.experiment, &options, &path, NULL));
  assert_int_equal(path.events[0].kind, STRUT_PATH_LIFT_OFF);
  assert_int_equal(path.events[0].index, 1);
  assert_relative(path.events[0].at.factor, 0.4 * 9.81 / 2, 1e-6); /* it leans a little */
  strut_path_free(&path);
  setup.scene.loads[0].force[0] = 1, setup.scene.loads[0].force[1] = 0; /* no friction holds it */
  assert_int_equal(strut_path_follow(model, &setup.experiment, &options, &path, NULL),
                   STRUT_NOT_SETTLED);
  strut_path_free(&path);
}

/* A load with a signal is followed by its name, with its force alone; the others stay. */
TEST(named_load) {
  OWN(strut_setup) setup = build_setup();
  int32_t a = build_support(&setup.scene, 0, 0), b = build_node(&setup.scene, 1, 0);
  setup.scene.nodes[b].fixed[1] = true;
  build_member(&setup.scene, STRUT_SPRING, a, b, 100, 0, 0);
  build_load(&setup.scene, b, 5, 0, build_sine(&setup.scene, 0.1, 1));
  build_load(&setup.scene, b, -3, 0, -1);
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  for (int i = 0; i < 2; i++) {
    OWN(strut_path) path = {0};
    strut_path_options options = {.load = i ? NULL : "l1"};
    assert_ok(strut_path_follow(model, &setup.experiment, &options, &path, NULL));
    assert_near(path.points[0].at.q[2 * b], i ? 1 : 0.97, 1e-14);
    assert_near(path.points[path.point_count - 1].at.q[2 * b], i ? 0.97 : 1.02, 1e-14);
  }
}
