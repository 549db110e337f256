/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paths with kinks, and with stiff bars: stability on each side and every digit, by closed forms. */
#include "engine/statics/potential.h"
#include "tests/physics/walk.h"
#include "tests/support/dense.h"
#include "tests/support/random.h"

static void check_event(const strut_path_event *e, strut_path_event_kind kind, double factor,
                        int32_t before, int32_t after) {
  assert_string_equal(strut_path_event_name(e->kind), strut_path_event_name(kind));
  assert_relative(e->at.factor, factor, 1e-12);
  assert_all_equal(e->before, before, e->after, after);
}

enum { TIP = 3 };
static const double STOP = 0.1, ANCHOR = 0.5, REST = 0.7, SPRING = 500, STOP_SPRING = 2000;

/*
 * A slider at (x, 0) under a compressed spring from (0, ANCHOR), which drives it from the middle;
 * cables stop it beyond -STOP and STOP. It begins at the left and is pushed to the right by 1 N; or the other way.
 */
static strut_setup toggle(double way) {
  strut_setup setup = build_setup();
  int32_t anchor = build_support(&setup.scene, 0, ANCHOR);
  int32_t left = build_support(&setup.scene, -1, 0), right = build_support(&setup.scene, 1, 0);
  int32_t tip = build_node(&setup.scene, -0.12 * way, 0);
  assert_int_equal(tip, TIP);
  setup.scene.nodes[tip].fixed[1] = true;
  build_sized(&setup.scene, STRUT_SPRING, anchor, tip, SPRING, 0, 0, REST);
  build_sized(&setup.scene, STRUT_CABLE, left, tip, STOP_SPRING, 0, 0, 1 + STOP);
  build_sized(&setup.scene, STRUT_CABLE, right, tip, STOP_SPRING, 0, 0, 1 + STOP);
  build_load(&setup.scene, tip, 1, 0, -1);
  return setup;
}

static double toggle_load(double x) {
  double load = SPRING * (1 - REST / hypot(x, ANCHOR)) * x;
  if (x > STOP) load += STOP_SPRING * (x - STOP);
  if (x < -STOP) load += STOP_SPRING * (x + STOP);
  return load;
}

/* The load turns at both kinks, where the stiffness jumps from one sign to the other, along either way. */
TEST(limit_points_at_kinks) {
  double turn = toggle_load(-STOP),
         hard = SPRING * (1 - REST * ANCHOR * ANCHOR / pow(hypot(STOP, ANCHOR), 3));
  assert_true(hard < 0 && hard + STOP_SPRING > 0); /* the tangents on the two sides */
  for (int way = 1; way >= -1; way -= 2) {
    OWN(strut_setup) setup = toggle(way);
    OWN(walk) w = walk_until(&setup, 2 * way * turn);
    assert_int_equal(w.path.event_count, 4);
    const strut_path_event *e = w.path.events;
    check_event(&e[0], STRUT_PATH_SLACK, way * turn, 0, 1);
    check_event(&e[1], STRUT_PATH_KINK_LIMIT, way * turn, 0, 1);
    check_event(&e[2], STRUT_PATH_TAUT, -way * turn, 1, 0);
    check_event(&e[3], STRUT_PATH_KINK_LIMIT, -way * turn, 1, 0);
    assert_all_equal(e[0].index, way > 0 ? 2 : 1, e[2].index, way > 0 ? 1 : 2);
    size_t unstable = 0;
    for (size_t i = 0; i < w.path.point_count; i++) {
      const strut_path_point *p = &w.path.points[i];
      double x = way * p->at.q[2 * TIP];
      assert_near(p->at.factor, way * toggle_load(x), 1e-11 * turn);
      /* the kink at -STOP is judged as the path goes on, and so is that at STOP */
      bool middle = x > -STOP - 1e-9 && x < STOP - 1e-9;
      assert_int_equal(p->negative, middle ? 1 : 0);
      unstable += middle;
    }
    assert_true(unstable > 3);
    assert_int_equal(w.path.end, STRUT_PATH_UNTIL);
  }
}

/*
 * A mast of stiffness K between two guys, loaded from above: it is straight and stable as long as
 * the guys pull, and straight but unstable as soon as they do not.
 */
TEST(bifurcation_at_kink) {
  const double mast = 5e3, top = 0.9;
  OWN(strut_setup) setup = build_setup();
  int32_t base = build_support(&setup.scene, 0, 0);
  int32_t left = build_support(&setup.scene, -1, 0), right = build_support(&setup.scene, 1, 0);
  int32_t tip = build_node(&setup.scene, 0, 1);
  build_sized(&setup.scene, STRUT_BAR, base, tip, mast, 0, 0, 1);
  build_sized(&setup.scene, STRUT_CABLE, left, tip, 1000, 0, 0, hypot(1, top));
  build_sized(&setup.scene, STRUT_CABLE, right, tip, 1000, 0, 0, hypot(1, top));
  build_load(&setup.scene, tip, 0, -1, -1);
  OWN(walk) w = walk_until(&setup, 1.5 * mast * (1 - top));
  double load = mast * (1 - top);
  assert_int_equal(w.path.event_count, 3);
  check_event(&w.path.events[0], STRUT_PATH_SLACK, load, 0, 0);
  check_event(&w.path.events[1], STRUT_PATH_SLACK, load, 0, 1);
  check_event(&w.path.events[2], STRUT_PATH_KINK_BIFURCATION, load, 0, 1);
  for (size_t i = 0; i < w.path.point_count; i++) {
    const strut_path_point *p = &w.path.points[i];
    assert_int_equal(p->negative, p->at.factor < load * (1 - 1e-9) ? 0 : 1);
    assert_near(p->at.q[2 * tip], 0, 1e-12);
  }
}

/* Von Mises' truss falls on the ground beyond its limit point, however near: stable from there, the load grows. */
TEST(touchdown_restores_stability) {
  const double a = 1, h = 0.21, k = 1000, top = sqrt(pow(a * a * hypot(a, h), 2.0 / 3) - a * a);
  const double floors[] = {0.05, top - 1e-3, top - 1e-8, top - 1e-12}, grounds[] = {1e4, 1e7};
  for (size_t i = 0; i < 8; i++) {
    double floor = floors[i / 2], ground = grounds[i % 2];
    OWN(strut_setup) setup = arch(a, h, k);
    build_contact(&setup.scene, 2, ground, 0);
    setup.scene.ground.height = floor;
    build_load(&setup.scene, 2, 0, -1, -1);
    OWN(walk) w = walk_until(&setup, 15);
    double there = arch_load(a, h, k, floor);
    assert_all_equal(w.path.event_count, 3, w.path.events[0].kind, STRUT_PATH_LIMIT,
                     w.path.events[0].after, 1);
    check_event(&w.path.events[1], STRUT_PATH_TOUCHDOWN, there, 1, 0);
    check_event(&w.path.events[2], STRUT_PATH_KINK_LIMIT, there, 1, 0);
    const strut_path_state *end = &w.path.points[w.path.point_count - 1].at;
    double push = arch_load(a, h, k, end->q[5]);
    assert_all_near(1e-8, end->contact[0], ground * (floor - end->q[5]), end->contact[0] + push,
                    15);
  }
}

/*
 * A bar of stiffness K and length l on two springs c across it, loaded along it. Shortened by d it is
 * neutral across where K d / (l - d) = 2 c (1 / s^2 + (1 - 1 / s) d^2 / s^2), s^2 = 1 + (d / l)^2; all
 * springs are as long as the bar.
 */
static double buckling_load(double bar, double spring, double length) {
  long double low = 0, high = (long double)length / 2;
  for (int i = 0; i < 300; i++) {
    long double d = (low + high) / 2, t = d / (long double)length, s = sqrtl(1 + t * t);
    long double across = 2 * (long double)spring * (1 / (s * s) + (1 - 1 / s) * t * t / (s * s));
    if ((long double)bar * d / ((long double)length - d) < across)
      low = d;
    else
      high = d;
  }
  long double t = low / (long double)length, s = sqrtl(1 + t * t);
  return (double)((long double)bar * low + 2 * (long double)spring * (1 - 1 / s) * low);
}

/* Along (x, y), a Pythagorean pair of length l: nothing is rounded as drawn. */
static double found_buckling_load(double bar, double spring, double x, double y) {
  OWN(strut_setup) setup = build_setup();
  int32_t base = build_support(&setup.scene, 0, 0), tip = build_node(&setup.scene, x, y);
  int32_t one = build_support(&setup.scene, x - y, y + x),
          other = build_support(&setup.scene, x + y, y - x);
  build_member(&setup.scene, STRUT_BAR, base, tip, bar, 0, 0);
  build_member(&setup.scene, STRUT_SPRING, tip, one, spring, 0, 0);
  build_member(&setup.scene, STRUT_SPRING, tip, other, spring, 0, 0);
  build_load(&setup.scene, tip, -x, -y, -1); /* of length l, exactly along the bar */
  double length = hypot(x, y);
  OWN(walk) w = walk_until(&setup, 3 * spring);
  double load = 0;
  for (size_t i = 0; i < w.path.event_count && load == 0; i++)
    if (w.path.events[i].kind == STRUT_PATH_BIFURCATION) {
      load = length * w.path.events[i].at.factor;
      assert_all_equal(w.path.events[i].before, 0, w.path.events[i].after, 1);
    }
  return load;
}

/* The load of a stiff bar is known to as many digits as that of a soft one. */
TEST(stiff_bars) {
  static const double stiff[] = {1e4, 1e6, 1e8, 1e9, 1e10, 1e11};
  static const double along[][2] = {{0, 1}, {3, 4}, {-5, 12}};
  for (size_t i = 0; i < sizeof stiff / sizeof *stiff; i++)
    for (size_t k = 0; k < sizeof along / sizeof *along; k++) {
      double length = hypot(along[k][0], along[k][1]);
      double load = buckling_load(stiff[i], 50, length);
      double found = found_buckling_load(stiff[i], 50, along[k][0], along[k][1]);
      assert_relative(found, load, 1e-10);
    }
}

/* Five nodes, two of them supports, each pair joined by a bar, a cable or nothing, loaded anyhow. */
static strut_setup random_net(uint64_t seed) {
  strut_setup setup = build_setup();
  build_support(&setup.scene, 0, 0);
  build_support(&setup.scene, 1 + random_between(&seed, 0, 1), 0);
  for (int i = 0; i < 3; i++) {
    double y = 0.3 + random_between(&seed, 0, 1), x = 2 * random_between(&seed, 0, 1);
    build_node(&setup.scene, x, y);
  }
  for (int32_t i = 0; i < 5; i++)
    for (int32_t k = i > 1 ? i + 1 : 2; k < 5; k++) {
      double kind = random_between(&seed, 0, 1), slack = 0.9 + 0.2 * random_between(&seed, 0, 1);
      if (kind > 0.9) continue;
      const double *a = setup.scene.nodes[i].position, *b = setup.scene.nodes[k].position;
      build_sized(&setup.scene, kind < 0.5 ? STRUT_BAR : STRUT_CABLE, i, k,
                  100 * (1 + random_between(&seed, 0, 1)), 0, 0,
                  slack * hypot(b[0] - a[0], b[1] - a[1]));
    }
  double fy = -random_between(&seed, 0, 1), fx = random_between(&seed, 0, 1) - 0.5;
  build_load(&setup.scene, 2 + (int32_t)(3 * random_between(&seed, 0, 1)), fx, fy, -1);
  return setup;
}

/* Negative eigenvalues of the potential's own second derivatives; -1 where one is about zero. */
static int32_t count_negative(const strut_potential *potential, const double *q,
                              strut_arena *arena) {
  strut_sparse *hessian = strut_potential_matrix(potential, arena);
  int32_t count = 0;
  assert_non_null(hessian);
  strut_potential_hessian(potential, q, hessian);
  OWN_POINTER(gsl_matrix) dense = dense_of(hessian, 0);
  OWN_POINTER(gsl_vector) values = dense_eigenvalues(dense, NULL);
  for (size_t i = 0; i < values->size; i++) {
    if (fabs(gsl_vector_get(values, i)) < 1e-7) return -1;
    count += gsl_vector_get(values, i) < 0;
  }
  return count;
}

/* Whether a cable hangs by a hair there. */
static bool is_at_kink(const strut_model *model, const double *q) {
  for (int32_t j = 0; j < model->members.count; j++) {
    const double *a = q + model->members.from[j], *b = q + model->members.to[j];
    double stretch = hypot(b[0] - a[0], b[1] - a[1]) - model->members.rest[j];
    if (model->scene->members[j].kind == STRUT_CABLE && fabs(stretch) < 1e-9) return true;
  }
  return false;
}

/* The largest force over length: how much a force turns with a node. */
static double find_steepest(const strut_model *model, const strut_path_point *p) {
  double most = 0;
  for (int32_t j = 0; j < model->members.count; j++) {
    const double *a = p->at.q + model->members.from[j], *b = p->at.q + model->members.to[j];
    most = fmax(most, fabs(p->at.force[j]) / hypot(b[0] - a[0], b[1] - a[1]));
  }
  return most;
}

/*
 * Points are in equilibrium, and as stable as the second derivatives of the energy say there; events
 * account for every change of it. Up to where a part hangs loose: neutral, with no sign.
 */
static void check_points(const strut_model *model, const strut_path *path, size_t *kinks) {
  strut_potential *potential;
  OWN(strut_arena) arena = {0};
  int32_t before = path->points[0].negative;
  size_t at = 0;
  assert_ok(strut_potential_create(model, NULL, true, &arena, &potential, NULL));
  assert_int_equal(potential->n, 6);
  for (size_t i = 0; i < path->point_count; i++) {
    const strut_path_point *p = &path->points[i];
    bool kink = is_at_kink(model, p->at.q);
    int32_t count = kink ? -1 : count_negative(potential, p->at.q, &arena);
    double g[6];
    if (count < 0 && (i == 0 || !kink)) break;
    if (count >= 0) assert_int_equal(p->negative, count);
    for (int32_t k = 0; k < model->length; k++)
      potential->force[k] = p->at.factor * model->constant_force[k];
    strut_potential_gradient(potential, p->at.q, g);
    double bit = find_steepest(model, p) * 1e-14; /* what rounded positions leave */
    for (int k = 0; k < 6; k++) assert_near(g[k], 0, 1e-11 * (1 + fabs(p->at.factor)) + bit);
    for (; at < path->event_count && path->events[at].at.arc <= p->at.arc; at++) {
      const strut_path_event *e = &path->events[at];
      bool exchange = e->kind >= STRUT_PATH_KINK_LIMIT;
      *kinks += exchange;
      assert_int_equal(exchange ? e->after : e->before, before);
      before = e->after;
    }
    assert_int_equal(p->negative, before);
  }
}

TEST(random_nets) {
  size_t kinks = 0, followed = 0;
  for (uint64_t seed = 1; seed <= 200; seed++) {
    OWN(strut_setup) setup = random_net(seed);
    OWN_POINTER(strut_model) model;
    assert_ok(strut_model_compile(&setup.scene, &model, NULL));
    OWN(strut_path) path;
    strut_path_options options = {.until = 60, .steps = 150};
    if (strut_path_follow(model, &setup.experiment, &options, &path, NULL) == STRUT_OK) {
      check_points(model, &path, &kinks);
      followed++;
    }
  }
  assert_true(followed > 100 && kinks > 5);
}
