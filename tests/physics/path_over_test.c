/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paths over displacements, actuators and numbers of a scene, against closed forms. */
#include "tests/physics/walk.h"

static const double SPAN = 1, HEIGHT = 0.3; /* of von Mises' truss: half its width, its height */
enum { APEX = 2 };

static double arch_stiffness(double k, double y) {
  double l = hypot(SPAN, y);
  return 2 * k * (hypot(SPAN, HEIGHT) * SPAN * SPAN / (l * l * l) - 1);
}

/* Where the truss has its limit point. */
static double limit_height(void) {
  double l = cbrt(hypot(SPAN, HEIGHT) * SPAN * SPAN);
  return sqrt(l * l - SPAN * SPAN);
}

/* The apex is pushed through: its reaction draws the curve past both limit points, which are none. */
static void check_displaced_apex(bool supported, double from) {
  const double k = 1000, until = -0.6;
  OWN(strut_setup) setup = arch(SPAN, HEIGHT, k);
  setup.scene.nodes[APEX].fixed[1] = supported;
  OWN(walk) w = walk_by(
      &setup,
      (strut_path_options){
          .over = STRUT_PATH_OVER_COORDINATE, .index = 2 * APEX + 1, .from = from, .until = until});
  const strut_path *path = &w.path;
  assert_int_equal(path->end, STRUT_PATH_UNTIL);
  assert_string_equal(path->unit, "m");
  assert_int_equal(path->event_count, 0);
  assert_true(path->points[0].at.factor == from);
  assert_true(path->points[path->point_count - 1].at.factor == until);
  double most = 0, least = 0;
  for (const strut_path_point *p = path->points; p < path->points + path->point_count; p++) {
    double y = HEIGHT + p->at.factor, l = hypot(SPAN, y);
    assert_near(p->at.q[2 * APEX + 1], y, 1e-15);
    assert_near(p->at.reaction[2 * APEX + 1], -arch_load(SPAN, HEIGHT, k, y), 1e-11);
    assert_near(p->at.force[0], k * (l - hypot(SPAN, HEIGHT)), 1e-11);
    assert_near(p->at.reaction[0], -k * (l - hypot(SPAN, HEIGHT)) * SPAN / l, 1e-11);
    assert_near(p->at.reaction[1] + p->at.reaction[3] + p->at.reaction[5], 0, 1e-11);
    assert_int_equal(p->negative, 0);
    most = fmax(most, p->at.reaction[2 * APEX + 1]);
    least = fmin(least, p->at.reaction[2 * APEX + 1]);
  }
  double limit = arch_load(SPAN, HEIGHT, k, limit_height());
  assert_all_near(0.01 * limit, most, limit, least, -limit);
}

TEST(displacement_of_a_node) {
  check_displaced_apex(true, 0);
  check_displaced_apex(false, 0);
  check_displaced_apex(false, -0.05);
  check_displaced_apex(true, -0.05);
}

/* A free node that carries a load: displaced from where that holds it. */
TEST(displacement_under_load) {
  const double k = 1000, load = 5;
  OWN(strut_setup) setup = arch(SPAN, HEIGHT, k);
  build_load(&setup.scene, APEX, 0, -load, -1);
  OWN(walk) w = walk_by(
      &setup, (strut_path_options){
                  .over = STRUT_PATH_OVER_COORDINATE, .index = 2 * APEX + 1, .until = -0.5});
  const strut_path *path = &w.path;
  double start = path->points[0].at.q[2 * APEX + 1];
  assert_relative(arch_load(SPAN, HEIGHT, k, start), load, 1e-11);
  for (const strut_path_point *p = path->points; p < path->points + path->point_count; p++)
    assert_near(p->at.reaction[2 * APEX + 1],
                load - arch_load(SPAN, HEIGHT, k, start + p->at.factor), 1e-10);
}

/* A support pulls a slack cable taut, and then a spring behind it. */
TEST(displacement_of_a_support) {
  const double spring = 300, cable = 600, slack = 0.1;
  OWN(strut_setup) setup = build_setup();
  int32_t wall = build_support(&setup.scene, 0, 0), node = build_node(&setup.scene, 1, 0);
  int32_t hand = build_support(&setup.scene, 2, 0);
  setup.scene.nodes[node].fixed[1] = true;
  build_member(&setup.scene, STRUT_SPRING, wall, node, spring, 0, 0);
  build_sized(&setup.scene, STRUT_CABLE, node, hand, cable, 0, 0, 1 + slack);
  OWN(walk) w = walk_by(
      &setup,
      (strut_path_options){.over = STRUT_PATH_OVER_COORDINATE, .index = 2 * hand, .until = 0.5});
  const strut_path *path = &w.path;
  assert_all_equal(path->event_count, 1, path->events[0].kind, STRUT_PATH_TAUT);
  assert_near(path->events[0].at.factor, slack, 1e-14);
  for (const strut_path_point *p = path->points; p < path->points + path->point_count; p++) {
    double pull = spring * cable / (spring + cable) * fmax(0, p->at.factor - slack);
    assert_all_near(1e-11, p->at.reaction[2 * hand], pull, p->at.reaction[2 * wall], -pull);
    assert_near(p->at.force[1], pull, 1e-11);
  }
}

/* The lever that presses the apex down through a spring: how long it is where the truss is at y. */
static const double LEVER_SPRING = 30, LEVER = 1;

/* What is added to the lever where the truss is at y: the lever pushes with what holds the apex. */
static double lever_length(double k, double y) {
  return arch_load(SPAN, HEIGHT, k, y) / LEVER_SPRING - (y - HEIGHT);
}

/* Where the lever turns back: its stiffness and the truss's cancel, for which |y| is unique. */
static double turning_height(double k) {
  double low = 0, high = HEIGHT;
  for (int i = 0; i < 200; i++) {
    double middle = 0.5 * (low + high);
    if (arch_stiffness(k, middle) > LEVER_SPRING)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/* An actuator of a bistable truss: it snaps where length over height has its limit points. */
TEST(actuator_snaps) {
  const double k = 1000;
  OWN(strut_setup) setup = arch(SPAN, HEIGHT, k);
  setup.scene.nodes[APEX].fixed[0] = true;
  int32_t above = build_support(&setup.scene, 0, HEIGHT + LEVER);
  int32_t member = build_sized(&setup.scene, STRUT_SPRING, above, APEX, LEVER_SPRING, 0, 0, LEVER);
  build_actuator(&setup.scene, member, build_sine(&setup.scene, 0.1, 1));
  OWN(walk) w = walk_by(
      &setup, (strut_path_options){.over = STRUT_PATH_OVER_ACTUATOR, .index = 0, .until = 1.2});
  const strut_path *path = &w.path;
  double turn = turning_height(k);
  assert_all_equal(walk_count(path, STRUT_PATH_LIMIT), 2, path->event_count, 2);
  for (int i = 0; i < 2; i++) {
    const strut_path_event *e = &path->events[i];
    double y = i ? -turn : turn;
    assert_relative(e->at.factor, lever_length(k, y), 1e-11);
    assert_near(e->at.q[2 * APEX + 1], y, 1e-8);
    assert_all_equal(e->before, i, e->after, 1 - i);
  }
  for (const strut_path_point *p = path->points; p < path->points + path->point_count; p++) {
    double y = p->at.q[2 * APEX + 1];
    assert_near(p->at.factor, lever_length(k, y), 1e-12);
    assert_near(p->at.force[2], -arch_load(SPAN, HEIGHT, k, y), 1e-10);
    assert_int_equal(p->negative, LEVER_SPRING - arch_stiffness(k, y) < 0 ? 1 : 0);
  }
}

/* Scenes of a number: the truss's stiffness, with a load of 1 N; what is not positive is refused. */
typedef struct family {
  int more_nodes; /* one more node from this value on */
  bool unloaded;
} family;

static strut_status scene_of_stiffness(void *context, double value, strut_setup *setup,
                                       strut_error *error) {
  family *f = context;
  if (value < 50) return strut_fail(error, STRUT_BAD_SCENE, "k must be 50 N/m at least");
  *setup = arch(SPAN, HEIGHT, value);
  if (f->more_nodes && value > f->more_nodes) build_support(&setup->scene, 5, 5);
  build_load(&setup->scene, APEX, 0, f->unloaded ? 0 : -1, -1);
  return STRUT_OK;
}

static strut_path_options over_stiffness(family *f, double from, double until) {
  return (strut_path_options){.over = STRUT_PATH_OVER_SCENE,
                              .name = "k",
                              .unit = "N/m",
                              .scene_at = scene_of_stiffness,
                              .context = f,
                              .from = from,
                              .until = until};
}

/* Softer and softer: the truss gives way where its limit load is the load that it carries. */
TEST(stiffness_of_a_scene) {
  family f = {0};
  OWN(strut_setup) setup;
  assert_ok(scene_of_stiffness(&f, 1000, &setup, NULL));
  strut_path_options options = over_stiffness(&f, 1000, 60);
  options.steps = 60;
  OWN(walk) w = walk_by(&setup, options);
  const strut_path *path = &w.path;
  assert_int_equal(path->events[0].kind, STRUT_PATH_LIMIT);
  double soft = 1 / arch_load(SPAN, HEIGHT, 1, limit_height());
  assert_relative(path->events[0].at.factor, soft, 1e-11);
  assert_near(path->events[0].at.q[2 * APEX + 1], limit_height(), 1e-8);
  assert_non_null(strstr(path->events[0].detail, "k can fall no further"));
  for (const strut_path_point *p = path->points; p < path->points + path->point_count; p++) {
    double y = p->at.q[2 * APEX + 1];
    assert_near(arch_load(SPAN, HEIGHT, p->at.factor, y), 1, 1e-11);
    assert_int_equal(p->negative, y < limit_height() ? 1 : 0);
  }
}

/* It ends where the scene means nothing any more, with what the scene says. */
TEST(end_of_validity) {
  family f = {.unloaded = true};
  OWN(strut_setup) setup;
  assert_ok(scene_of_stiffness(&f, 1000, &setup, NULL));
  OWN(walk) w = walk_by(&setup, over_stiffness(&f, 1000, -10));
  assert_int_equal(w.path.end, STRUT_PATH_INVALID);
  assert_near(w.path.points[w.path.point_count - 1].at.factor, 50, 1e-3);
  assert_non_null(strstr(w.path.remark, "k must be 50 N/m at least"));
  assert_non_null(strstr(w.path.remark, "the path ends at k 50"));
  strut_path_options options = over_stiffness(&f, 10, 1000);
  strut_error error = {0};
  strut_path path;
  assert_int_equal(strut_path_follow(w.model, &setup.experiment, &options, &path, &error),
                   STRUT_BAD_SCENE);
  assert_string_equal(error.message, "k must be 50 N/m at least");
  strut_path_free(&path);
}

/* A ground that is raised under a node on an upright spring: a scene's number again. */
static strut_status scene_of_ground(void *context, double value, strut_setup *setup,
                                    strut_error *error) {
  (void)context;
  (void)error;
  strut_setup_init(setup);
  int32_t top = build_support(&setup->scene, 0, 1), node = build_node(&setup->scene, 0, 0);
  setup->scene.nodes[node].fixed[0] = true;
  build_member(&setup->scene, STRUT_SPRING, top, node, 100, 0, 0);
  build_contact(&setup->scene, node, 1000, 0);
  setup->scene.ground.height = value;
  return STRUT_OK;
}

TEST(rising_ground) {
  OWN(strut_setup) setup;
  assert_ok(scene_of_ground(NULL, -0.2, &setup, NULL));
  OWN(walk) w = walk_by(&setup, (strut_path_options){.over = STRUT_PATH_OVER_SCENE,
                                                     .name = "height",
                                                     .unit = "m",
                                                     .scene_at = scene_of_ground,
                                                     .from = -0.2,
                                                     .until = 0.1});
  const strut_path *path = &w.path;
  assert_all_equal(path->event_count, 1, path->events[0].kind, STRUT_PATH_TOUCHDOWN);
  assert_near(path->events[0].at.factor, 0, 1e-13);
  for (const strut_path_point *p = path->points; p < path->points + path->point_count; p++) {
    double y = 1000 * fmax(0, p->at.factor) / 1100;
    assert_near(p->at.q[3], y, 1e-13);
    assert_all_near(1e-10, p->at.contact[0], 100 * y, p->at.reaction[1], 100 * -y);
    assert_near(p->at.force[0], -100 * y, 1e-10);
  }
}

/* A number that changes what the structure is made of, which is found on the way. */
TEST(growing_structure) {
  family grows = {.more_nodes = 1500};
  OWN(strut_setup) setup;
  assert_ok(scene_of_stiffness(&grows, 1000, &setup, NULL));
  OWN(walk) w = walk_by(&setup, over_stiffness(&grows, 1000, 2000));
  assert_int_equal(w.path.end, STRUT_PATH_INVALID);
  assert_near(w.path.points[w.path.point_count - 1].at.factor, 1500, 0.1);
  assert_non_null(strstr(w.path.remark, "changes what the structure is made of"));
}

TEST(memory) {
  family f = {0};
  OWN(strut_setup) setup;
  assert_ok(scene_of_stiffness(&f, 1000, &setup, NULL));
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  const strut_path_options all[] = {
      {.over = STRUT_PATH_OVER_COORDINATE, .index = 2 * APEX + 1, .until = -0.05, .at = "start"},
      {.over = STRUT_PATH_OVER_COORDINATE, .index = 0, .from = 0.001, .until = -0.05},
      {.until = 100}};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    REFUSE_EACH(n, status, 10) {
      OWN(strut_path) path = {0};
      status = refused(n, strut_path_follow(model, &setup.experiment, &all[i], &path, NULL));
    }
  }
}
