/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One settling for whoever starts from it: the same bits, bounded, and judged for stability. */
#include <math.h>
#include <string.h>

#include "engine/run/accuracy/accuracy.h"
#include "engine/run/settle.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/equilibria/rest_state.h"
#include "tests/support/build.h"
#include "tests/support/check.h"
#include "tests/support/motion.h"

static const double G = 9.81;

/* A mass of 1 kg on a rod of 1 m, its pin in the origin, `angle` from upright. */
static void rod(strut_scene *scene, double stiffness, double angle) {
  strut_scene_init(scene);
  build_support(scene, 0, 0);
  build_mass(scene, sin(angle), cos(angle), 1);
  build_sized(scene, STRUT_BAR, 0, 1, stiffness, 10, 0, 1);
  scene->gravity[1] = -G;
  scene->settle.wanted = true;
  motion_experiment(scene, 1e-3, 0.1);
}

typedef struct settled {
  double q[64], time;
  strut_settle_summary how;
  strut_error error;
  strut_status status;
} settled;

static settled settle(const strut_scene *scene) {
  settled s = {.time = 0};
  strut_model *model = motion_compile(scene);
  assert_true(model->length <= 64);
  s.status = strut_settle_experiment(model, NULL, NULL, s.q, &s.time, &s.how, &s.error);
  strut_model_free(model);
  return s;
}

static void an_upright_rod_is_unstable(void **unused) {
  (void)unused;
  strut_scene scene;
  rod(&scene, 1e5, 0);
  settled s = settle(&scene);
  double length = 1 - G / 1e5;
  assert_int_equal(s.status, STRUT_OK);
  assert_near(s.q[3], length, 1e-12);
  assert_true(s.how.unstable);
  assert_string_equal(s.how.node, scene.nodes[1].name);
  assert_relative(s.how.stiffness, -G / length, 1e-9);
  assert_relative(s.how.growth_rate, sqrt(G / length), 1e-9);
  char text[300];
  assert_true(strut_settle_warning(&s.how, text, sizeof text));
  assert_non_null(strstr(text, scene.nodes[1].name));
  strut_scene_free(&scene);
}

/* A rod 1e6 times as stiff: the same instability beside a stiffness that is 1e10 times larger. */
static void a_stiff_rod_is_as_unstable(void **unused) {
  (void)unused;
  strut_scene scene;
  rod(&scene, 1e11, 0);
  scene.experiment.step = 1e-7;
  settled s = settle(&scene);
  assert_int_equal(s.status, STRUT_OK);
  assert_true(s.how.unstable);
  assert_relative(s.how.growth_rate, sqrt(G), 1e-6);
  strut_scene_free(&scene);
}

static void a_perturbed_rod_hangs(void **unused) {
  (void)unused;
  strut_scene scene;
  rod(&scene, 1e5, 0);
  scene.settle.perturb = true;
  settled s = settle(&scene);
  assert_int_equal(s.status, STRUT_OK);
  assert_false(s.how.unstable);
  assert_int_equal(s.how.perturbations, 1);
  assert_near(s.q[2], 0, 1e-7);
  assert_near(s.q[3], -1 - G / 1e5, 1e-9);
  settled again = settle(&scene);
  assert_memory_equal(s.q, again.q, sizeof s.q);
  char text[300];
  assert_false(strut_settle_warning(&s.how, text, sizeof text));
  strut_scene_free(&scene);
}

/* Nothing is perturbed that is stable: the bits are those without the key. */
static void a_stable_rest_is_left_alone(void **unused) {
  (void)unused;
  strut_scene scene;
  rod(&scene, 1e5, 3.0);
  settled s = settle(&scene);
  scene.settle.perturb = true;
  settled perturbed = settle(&scene);
  assert_false(s.how.unstable);
  assert_int_equal(perturbed.how.perturbations, 0);
  assert_memory_equal(s.q, perturbed.q, sizeof s.q);
  strut_scene_free(&scene);
}

/* Motions without stiffness are none that grow: two masses that float, a block that slides. */
static void free_motions_are_not_unstable(void **unused) {
  (void)unused;
  strut_scene scene;
  strut_scene_init(&scene);
  for (int i = 0; i < 3; i++) build_mass(&scene, 0.3 * i, 0.4 * (i % 2), 1 + i);
  for (int32_t i = 0; i < 3; i++) build_sized(&scene, STRUT_BAR, i, (i + 1) % 3, 1e4, 1, 0, 0.5);
  scene.settle.wanted = true;
  motion_experiment(&scene, 1e-3, 0.1);
  settled s = settle(&scene);
  assert_int_equal(s.status, STRUT_OK);
  assert_false(s.how.unstable);
  for (int32_t i = 0; i < 2; i++) build_contact(&scene, 2 * i, 1e4, 10);
  scene.gravity[1] = -G;
  s = settle(&scene);
  assert_int_equal(s.status, STRUT_OK);
  assert_false(s.how.unstable);
  strut_scene_free(&scene);
}

/* A block that friction keeps on a slope is held there. */
static void what_friction_holds_is_not_unstable(void **unused) {
  (void)unused;
  strut_scene scene;
  strut_scene_init(&scene);
  build_rough_contact(&scene, build_mass(&scene, 0, 0, 1), 1e4, 10, 0.5, 0.5, 1e-3);
  scene.gravity[1] = -G;
  scene.ground.slope = 0.2;
  motion_experiment(&scene, 1e-4, 0.01);
  scene.settle.wanted = scene.settle.friction = true;
  scene.settle.acceleration = 1e-6;
  settled s = settle(&scene);
  assert_int_equal(s.status, STRUT_OK);
  assert_false(s.how.unstable);
  strut_scene_free(&scene);
}

/* What method, step or accuracy a run has: it starts from the same bits. */
static void every_method_starts_from_the_same_bits(void **unused) {
  (void)unused;
  static const char *const method[] = {"verlet", "verlet-events", "adaptive", "midpoint", "euler"};
  strut_scene scene;
  rod(&scene, 1e5, 2.5);
  scene.settle.step = 1e-3; /* as the parser takes it from the file's solver.step */
  settled first = settle(&scene);
  assert_int_equal(first.status, STRUT_OK);
  for (size_t i = 0; i < sizeof method / sizeof method[0]; i++) {
    scene.experiment.integrator = method[i];
    scene.experiment.step = 1e-2 / (double)(1 << i);
    settled s = settle(&scene);
    assert_int_equal(s.status, STRUT_OK);
    assert_memory_equal(s.q, first.q, sizeof s.q);
    assert_int_equal(s.how.evaluations, first.how.evaluations);
  }
  strut_scene_free(&scene);
}

/* The first row of a run: where it starts. */
typedef struct first_row {
  double position[16];
  bool taken;
} first_row;

static strut_status begin(void *context, const strut_record_layout *layout, strut_error *error) {
  (void)error;
  ((first_row *)context)->taken = false;
  return layout->width <= 16 ? STRUT_OK : STRUT_USAGE;
}

static strut_status rows(void *context, const double *row, size_t count, strut_error *error) {
  first_row *to = context;
  (void)error;
  if (!to->taken && count > 0) memcpy(to->position, row + 1, 4 * sizeof *row), to->taken = true;
  return STRUT_OK;
}

static strut_status end(void *context, strut_status status, strut_error *error) {
  (void)context, (void)status, (void)error;
  return STRUT_OK;
}

static void an_accurate_run_starts_where_the_plain_one_does(void **unused) {
  (void)unused;
  strut_scene scene;
  first_row plain = {.taken = false}, accurate = {.taken = false};
  strut_sink sink = {&plain, begin, rows, end, STRUT_CHANNEL_POSITION}, *sinks[] = {&sink};
  strut_run_options options = {.sinks = sinks, .sink_count = 1};
  strut_summary s, t;
  rod(&scene, 1e5, 0);
  strut_model *model = motion_compile(&scene);
  assert_int_equal(strut_simulate(model, &options, &s, NULL), STRUT_OK);
  sink.context = &accurate;
  scene.experiment.accuracy = 0.01;
  assert_int_equal(strut_simulate_accurately(&scene, &options, &t, NULL), STRUT_OK);
  assert_true(plain.taken && accurate.taken);
  assert_memory_equal(plain.position, accurate.position, sizeof plain.position);
  assert_true(s.settle.unstable && t.settle.unstable);
  assert_int_equal(s.settle.evaluations, t.settle.evaluations); /* of one settling */
  assert_same_bits(s.settle_time, t.settle_time);
  strut_summary_free(&s);
  strut_summary_free(&t);
  strut_model_free(model);
  strut_scene_free(&scene);
}

/* `start` of statics is that state too; its list of equilibria knows it as the saddle it is. */
static void statics_start_from_the_same_bits(void **unused) {
  (void)unused;
  for (int perturb = 0; perturb < 2; perturb++) {
    strut_scene scene;
    rod(&scene, 1e5, 0);
    scene.settle.perturb = perturb;
    settled s = settle(&scene);
    strut_model *model = motion_compile(&scene);
    strut_arena arena = {0};
    strut_rest_state stand;
    assert_int_equal(strut_rest_state_find(model, NULL, &arena, &stand, NULL), STRUT_OK);
    assert_memory_equal(stand.q, s.q, (size_t)model->length * sizeof *s.q);
    assert_true(stand.at_rest);
    assert_int_equal(stand.settle.unstable, !perturb);
    strut_equilibria_options options = {0};
    strut_equilibria all;
    assert_int_equal(strut_equilibria_find(model, &options, &all, NULL), STRUT_OK);
    assert_true(all.start >= 0);
    assert_int_equal(all.list[all.start].point.label, perturb ? STRUT_STABLE : STRUT_SADDLE);
    strut_equilibria_free(&all);
    strut_arena_free(&arena);
    strut_model_free(model);
    strut_scene_free(&scene);
  }
}

/* A mass that falls for ever: it ends after so many evaluations, and says who moves and how fast. */
static void settling_is_bounded_in_work(void **unused) {
  (void)unused;
  strut_scene scene;
  strut_scene_init(&scene);
  build_mass(&scene, 0, 0, 1);
  scene.gravity[1] = -G;
  motion_experiment(&scene, 1e-3, 0.1);
  scene.settle.wanted = true;
  scene.settle.evaluations = 4000;
  settled s = settle(&scene);
  assert_int_equal(s.status, STRUT_NOT_SETTLED);
  assert_non_null(strstr(s.error.message, "4000 evaluations"));
  assert_non_null(strstr(s.error.message, scene.nodes[0].name));
  assert_non_null(strstr(s.error.message, "9.81 m/s")); /* after 1000 steps of 1 ms */
  assert_non_null(strstr(s.error.message, "initial.settle.evaluations"));
  strut_scene_free(&scene);
}

/* A step above the stability limit, and none at all: it is chosen. */
static void a_step_that_is_not_stable_is_replaced(void **unused) {
  (void)unused;
  static const double step[] = {0.1, -1};
  for (size_t i = 0; i < 2; i++) {
    strut_scene scene;
    rod(&scene, 1e5, 2.5);
    scene.settle.step = step[i];
    settled s = settle(&scene);
    assert_int_equal(s.status, STRUT_OK);
    assert_within(s.how.step, 1e-3, 2.83 / sqrt(1e5));
    assert_near(s.q[3], -1 - G / 1e5, 1e-9);
    strut_scene_free(&scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_upright_rod_is_unstable),
      cmocka_unit_test(a_stiff_rod_is_as_unstable),
      cmocka_unit_test(a_perturbed_rod_hangs),
      cmocka_unit_test(a_stable_rest_is_left_alone),
      cmocka_unit_test(free_motions_are_not_unstable),
      cmocka_unit_test(what_friction_holds_is_not_unstable),
      cmocka_unit_test(every_method_starts_from_the_same_bits),
      cmocka_unit_test(an_accurate_run_starts_where_the_plain_one_does),
      cmocka_unit_test(statics_start_from_the_same_bits),
      cmocka_unit_test(settling_is_bounded_in_work),
      cmocka_unit_test(a_step_that_is_not_stable_is_replaced),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
