/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The search for equilibria on small structures with closed forms: which supports are held, what
 * becomes of the shapes, what is said where nothing can rest; and shapes to stand in by name.
 */
#include "engine/statics/equilibria/equilibria.h"

#include "tests/support/structures.h"

static const double G = 9.81;

typedef struct found {
  strut_setup setup;
  strut_model *model;
  strut_equilibria all;
} found;

static void search(found *f) {
  strut_error error = {0};
  strut_equilibria_options options = {.starts = 60};
  f->model = motion_compile(&f->setup.scene);
  if (strut_equilibria_find(f->model, &f->setup.experiment, &options, &f->all, &error))
    fail_msg("%s", error.message);
}

static void found_free(found *f) {
  strut_equilibria_free(&f->all);
  strut_model_free(f->model);
  strut_setup_free(&f->setup);
}

static int32_t count(const found *f, strut_outcome fate) {
  int32_t n = 0;
  for (size_t i = 0; i < f->all.count; i++) n += f->all.list[i].outcome == fate;
  return n;
}

static const strut_equilibrium *first(const found *f, strut_outcome fate) {
  for (size_t i = 0; i < f->all.count; i++)
    if (f->all.list[i].outcome == fate) return &f->all.list[i];
  fail_msg("nothing has that fate");
  return NULL;
}

#define assert_says(text, part) check_words(text, (const char *[]){part, NULL}, __FILE__, __LINE__)

/* A triangle of bars, 1 kg/m, every node a contact; n3 above at x. */
static strut_setup triangle(double x) {
  double at[3][2] = {{0, 0}, {1, 0}, {x, 1}};
  strut_setup setup = build_falling();
  for (int i = 0; i < 3; i++) build_node(&setup.scene, at[i][0], at[i][1]);
  for (int i = 0; i < 3; i++) {
    int k = (i + 1) % 3;
    double length = hypot(at[k][0] - at[i][0], at[k][1] - at[i][1]);
    build_member(&setup.scene, STRUT_BAR, i, k, 1e6, 10, length);
  }
  for (int i = 0; i < 3; i++) build_contact(&setup.scene, i, 1e5, 100);
  return setup;
}

TEST(a_triangle_stands_on_every_side) {
  OWN(found) f = {.setup = triangle(0.4)};
  search(&f);
  double weight = (1 + hypot(0.4, 1) + hypot(0.6, 1)) * G;
  assert_int_equal(count(&f, STRUT_OUTCOME_STANDS), 3);
  for (size_t i = 0; i < f.all.count; i++) {
    const strut_equilibrium *e = &f.all.list[i];
    if (e->outcome != STRUT_OUTCOME_STANDS) continue;
    assert_string_equal(e->verdict, "stands");
    assert_int_equal(e->ends_as, i);
    double sum = 0, below = 0;
    for (int n = 0; n < 3; n++) sum += e->reaction[n][1];
    for (int k = 0; k < 2; k++) {
      below += e->normal[k];
      assert_near(e->rest[2 * e->contacts[k] + 1], -e->normal[k] / 1e5, 1e-12);
    }
    assert_near(sum, weight, 1e-9);
    assert_near(below, weight, 1e-8);
  }
  assert_string_equal(f.all.list[0].name, "n1-n2-1");
}

TEST(it_tips_over_its_foot) {
  OWN(found) f = {.setup = triangle(2.5)};
  search(&f);
  const strut_equilibrium *e = first(&f, STRUT_OUTCOME_TIPS);
  assert_all_equal(e->supports->node[0], 0, e->supports->node[1], 1);
  assert_true(e->reaction[0][1] < 0);
  assert_int_equal(e->tips_over, 1);
  assert_says(e->verdict, "tips over n2 onto n2 and n3: ");
  assert_all_equal(e->contacts[0], 1, e->contacts[1], 2);
  assert_int_equal(f.all.list[e->ends_as].outcome, STRUT_OUTCOME_STANDS);
}

/* Two bars over a span, held at both ends: nothing else is needed to hold it. */
static strut_setup truss(void) {
  strut_setup setup = build_tethered(1, 0.3, 1);
  build_support(&setup.scene, 2, 0);
  build_member(&setup.scene, STRUT_BAR, 0, 1, 1000, 0, 0);
  build_member(&setup.scene, STRUT_BAR, 1, 2, 1000, 0, 0);
  return setup;
}

TEST(a_truss_snaps) {
  OWN(found) f = {.setup = truss()};
  search(&f);
  assert_int_equal(count(&f, STRUT_OUTCOME_STANDS), 2);
  double flat = 1000 * pow(hypot(1, 0.3) - 1, 2);
  assert_true(f.all.barrier_count == 2);
  for (int i = 0; i < 2; i++) {
    assert_null(f.all.list[i].supports);
    assert_all_near(1e-12, fabs(f.all.list[i].point.q[3]), 0.3, f.all.barriers[i].height, flat);
    assert_true(f.all.barriers[i].from != f.all.barriers[i].to);
  }
  assert_near(f.all.list[f.all.barriers[0].saddle].point.q[3], 0, 1e-9);
}

/* A bar on a pin leaves one motion: its contact node alone is held. */
TEST(one_motion_needs_one_support) {
  OWN(found) f = {.setup = build_falling()};
  build_support(&f.setup.scene, 0, 0.6);
  build_node(&f.setup.scene, 0.7, 0.1);
  build_sized(&f.setup.scene, STRUT_BAR, 0, 1, 1e6, 10, 2, 1);
  build_contact(&f.setup.scene, 1, 1e5, 100);
  search(&f);
  const strut_equilibrium *e = first(&f, STRUT_OUTCOME_STANDS);
  assert_int_equal(e->supports->count, 1);
  assert_near(e->point.q[2], 0.8, 1e-4); /* 0.6, 0.8, 1 */
  assert_near(e->point.q[3], 0, 0);
  assert_all_near(1e-3, e->reaction[1][1], G, e->normal[0], G);
}

TEST(what_falls) {
  OWN(found) f = {.setup = build_falling()};
  OWN(strut_arena) arena = {0};
  strut_rest_state stand;
  strut_error error = {0};
  build_node(&f.setup.scene, 0, 0);
  build_node(&f.setup.scene, 1, 0);
  build_member(&f.setup.scene, STRUT_BAR, 0, 1, 1000, 0, 1);
  search(&f);
  assert_int_equal(f.all.count, 0);
  assert_string_equal(f.all.remark, "nothing holds the structure: it falls freely, all nodes");
  assert_fails(strut_rest_state_find(f.model, &f.setup.experiment, NULL, &arena, &stand, &error),
               STRUT_NOT_SETTLED, error, "it falls freely, all nodes");
}

TEST(a_part_that_falls) {
  OWN(found) f = {.setup = truss()};
  build_mass(&f.setup.scene, 5, 5, 1);
  f.setup.scene.gravity[1] = -G;
  search(&f);
  assert_int_equal(f.all.count, 0);
  assert_says(f.all.remark, "a part of the structure");
  assert_says(f.all.remark, "n4");
}

TEST(a_mechanism) {
  OWN(found) f = {.setup = build_setup()};
  build_support(&f.setup.scene, 0, 0);
  build_support(&f.setup.scene, 1, 0);
  build_mass(&f.setup.scene, 1.1, 1, 1);
  build_mass(&f.setup.scene, 0.1, 1, 1);
  for (int i = 1; i < 4; i++) build_member(&f.setup.scene, STRUT_BAR, i, (i + 1) % 4, 1000, 0, 0);
  search(&f);
  assert_true(f.all.count > 0);
  const strut_equilibrium *e = first(&f, STRUT_OUTCOME_FLOPPY);
  assert_int_equal(e->point.label, STRUT_FLOPPY);
  assert_string_equal(e->verdict, "nodes n3 and n4 move together without stiffness");
  assert_says(f.all.remark, "nodes n3 and n4 move together without stiffness");
}

/* What friction would have to hold is a matter of all forces, not of the slope alone. */
TEST(a_push_along_the_ground) {
  OWN(found) f = {.setup = triangle(0.4)};
  double weight = (1 + hypot(0.4, 1) + hypot(0.6, 1)) * G;
  build_load(&f.setup.scene, 2, 2.5 * weight, 0, -1);
  search(&f);
  assert_int_equal(count(&f, STRUT_OUTCOME_STANDS), 0);
  assert_says(f.all.remark, "a friction coefficient of at least 2.5 holds it");
}

/* One node has no extent to measure distances by; it rests all the same. */
TEST(one_node) {
  OWN(strut_setup) setup = build_falling();
  OWN(strut_arena) arena = {0};
  strut_rest_state stand;
  build_mass(&setup.scene, 0, 0, 1);
  build_contact(&setup.scene, 0, 1e5, 10);
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  assert_ok(strut_rest_state_find(model, &setup.experiment, "start", &arena, &stand, NULL));
  assert_near(stand.q[1], -G / 1e5, 1e-15);
}

/* A slope is level ground with gravity turned: the same solutions, but nothing rests. */
TEST(a_slope) {
  const double slope = 0.1, c = cos(slope), s = sin(slope);
  OWN(found) level = {.setup = triangle(0.4)}, steep = {.setup = triangle(0.4)};
  level.setup.scene.gravity[0] = -G * s, level.setup.scene.gravity[1] = -G * c;
  steep.setup.scene.ground.slope = slope;
  for (int i = 0; i < 3; i++) {
    double *p = steep.setup.scene.nodes[i].position, x = p[0], y = p[1];
    p[0] = c * x - s * y, p[1] = s * x + c * y;
    memcpy(steep.setup.scene.nodes[i].start, p, 2 * sizeof *p);
  }
  search(&level);
  search(&steep);
  assert_int_equal(level.all.count, steep.all.count);
  assert_true(steep.all.count >= 3);
  assert_int_equal(count(&steep, STRUT_OUTCOME_STANDS), 0);
  assert_says(steep.all.remark, "a friction coefficient of at least 0.1003 holds it"); /* tan 0.1 */
  assert_string_equal(first(&steep, STRUT_OUTCOME_NO_REST)->verdict,
                      "slides along the ground without friction");
  for (size_t i = 0; i < steep.all.count; i++) {
    const double *a = level.all.list[i].point.q, *b = steep.all.list[i].point.q;
    assert_near(steep.all.list[i].energy, level.all.list[i].energy, 1e-9);
    for (int n = 0; n < 3; n++) {
      assert_near(b[2 * n], c * a[2 * n] - s * a[2 * n + 1], 1e-9);
      assert_near(b[2 * n + 1], s * a[2 * n] + c * a[2 * n + 1], 1e-9);
    }
  }
}

TEST(supports_must_touch) {
  OWN(strut_equilibria) all;
  strut_error error = {0};
  OWN(strut_setup) setup = triangle(0.4);
  setup.scene.contact_count = 2;
  int32_t nodes[2] = {0, 2};
  strut_node_set set = {2, nodes};
  strut_equilibria_options options = {.supports = &set};
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  assert_fails(strut_equilibria_find(model, &setup.experiment, &options, &all, &error), STRUT_USAGE,
               error, "node 'n3' is no contact node");
}

/* The crawler's drawn state I as a configuration; II by its contacts alone. */
static strut_setup with_configurations(void) {
  static int32_t one[2] = {0, 3}, two[2] = {1, 3};
  static strut_node_set on_one = {2, one}, on_two = {2, two};
  static strut_configuration both[2];
  static double drawn[5][2];
  strut_setup setup = build_setup();
  structure_crawler(&setup.scene, 10, 1e-4, 0.1, false);
  for (int i = 0; i < 5; i++) memcpy(drawn[i], setup.scene.nodes[i].position, sizeof drawn[i]);
  both[0] = (strut_configuration){"I", true, drawn, 1, &on_one};
  both[1] = (strut_configuration){"II", false, drawn, 1, &on_two};
  setup.scene.configurations = both;
  setup.scene.configuration_count = 2;
  return setup;
}

TEST(stands) {
  OWN(strut_arena) arena = {0};
  strut_rest_state drawn, start, one, two;
  strut_error error = {0};
  OWN(strut_setup) setup = with_configurations();
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  assert_ok(strut_rest_state_find(model, &setup.experiment, "drawn", &arena, &drawn, &error));
  assert_ok(strut_rest_state_find(model, &setup.experiment, NULL, &arena, &start, &error));
  assert_ok(strut_rest_state_find(model, &setup.experiment, "I", &arena, &one, &error));
  assert_ok(strut_rest_state_find(model, &setup.experiment, "II", &arena, &two, &error));
  assert_false(drawn.at_rest); /* nothing carries it where it is drawn */
  assert_near(drawn.q[2], 0.0965109, 0);
  assert_near(drawn.scale, 0.14 * G, 1e-12);
  assert_true(start.at_rest && one.at_rest && two.at_rest);
  assert_all_texts(start.name, "start", two.name, "II");
  for (int k = 0; k < 10; k++) assert_same_bits(start.q[k], one.q[k]);
  assert_all_equal(one.closed_count, 2, one.closed[0], 0, one.closed[1], 3, two.closed[0], 1);
  assert_near(one.normal[0], two.normal[0], 1e-8);
  assert_near(two.q[3], one.q[1], 1e-12);
  assert_true(one.residual < 1e-10 * one.scale);
  assert_fails(strut_rest_state_find(model, &setup.experiment, "III", &arena, &two, &error),
               STRUT_USAGE, error, "choose one of: start, drawn, I, II");
}

TEST(a_run_wants_it_resolved) {
  strut_error error = {0};
  strut_summary summary;
  OWN(strut_setup) setup = with_configurations();
  motion_experiment(&setup, 1e-4, 0.01);
  setup.scene.start_equilibrium = 1;
  assert_fails(motion_try(&setup, (strut_run_options){0}, &summary, &error), STRUT_USAGE, error,
               "'II'");
  strut_summary_free(&summary);
  assert_ok(strut_resolve_start_equilibrium(&setup, &error));
  assert_int_equal(setup.scene.start_equilibrium, -1);
  assert_true(fabs(setup.scene.nodes[1].start[1]) < 1e-4 && setup.scene.nodes[0].start[1] > 0.02);
  assert_ok(strut_resolve_start_equilibrium(&setup, &error));
  for (size_t i = 0; i < setup.scene.actuator_count; i++) setup.scene.signals[0].amplitude = 0;
  summary = motion_simulate(&setup);
  for (size_t k = 0; k < 10; k++) /* it stays */
    assert_near(summary.end.positions[k], setup.scene.nodes[k / 2].start[k % 2], 1e-11);
  strut_summary_free(&summary);
}

TEST(no_such_equilibrium) {
  OWN(strut_arena) arena = {0};
  strut_rest_state stand;
  strut_error error = {0};
  OWN(strut_setup) setup = with_configurations();
  int32_t nodes[2] = {2, 3}; /* it does not stand on these two */
  setup.scene.configurations[1].sets[0].node = nodes;
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  assert_fails(strut_rest_state_find(model, &setup.experiment, "II", &arena, &stand, &error),
               STRUT_NOT_SETTLED, error, "no equilibrium fits configuration 'II'");
}

TEST(refused_memory) {
  strut_equilibria_options options = {.starts = 4};
  OWN(strut_setup) setup = triangle(2.5);
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  int64_t n = 0, step = 1;
  for (strut_status status = STRUT_NO_MEMORY; status != STRUT_OK; n += step, step += 1 + n / 20) {
    OWN(strut_equilibria) all;
    status = refused(n, strut_equilibria_find(model, &setup.experiment, &options, &all, NULL));
  }
  assert_true(n > 100);
}
