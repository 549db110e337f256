/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Lanes of a batch against single runs, bit for bit: random structures with all that a scene can have,
 * each slot with numbers of its own, slots that end and are refilled, and the crawler from both starts.
 */
#include <string.h>

#include "engine/integrate/batch/batch.h"
#include "tests/physics/random_elements.h"
#include "tests/physics/random_scene.h"
#include "tests/support/build.h"
#include "tests/support/check.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"
#include "tests/support/structures.h"

/* A point: a scene of its own, run alone for the reference and in a slot. */
typedef struct point {
  strut_setup setup;
  motion alone, slot; /* the slot's state is where it is put from and taken to */
  int64_t steps;
} point;

/* Other numbers, the same topology. */
static void vary(strut_setup *setup, uint64_t *r) {
  for (size_t i = 0; i < setup->scene.node_count; i++) {
    strut_node *node = &setup->scene.nodes[i];
    for (int c = 0; c < 2; c++) {
      node->start[c] += random_between(r, -0.05, 0.05);
      node->velocity[c] += node->fixed[c] ? 0.0 : random_between(r, -1, 1);
    }
    node->mass *= random_between(r, 0.8, 1.2);
  }
  for (size_t j = 0; j < setup->scene.member_count; j++) {
    setup->scene.members[j].stiffness *= random_between(r, 0.8, 1.2);
    setup->scene.members[j].damping *= random_between(r, 0.8, 1.2);
    setup->scene.members[j].mass *= random_between(r, 0.8, 1.2);
  }
  for (size_t i = 0; i < setup->scene.hinge_count; i++) {
    setup->scene.hinges[i].stiffness *= random_between(r, 0.8, 1.2);
    setup->scene.hinges[i].damping *= random_between(r, 0.8, 1.2);
  }
  for (size_t i = 0; i < setup->scene.signal_count; i++) {
    setup->scene.signals[i].amplitude *= random_between(r, 0.5, 1.5);
    if (setup->scene.signals[i].frequency > 0.0)
      setup->scene.signals[i].frequency = random_scale(r, 0.1, 10);
  }
  for (size_t i = 0; i < setup->scene.load_count; i++) setup->scene.loads[i].force[0] += 0.1;
  for (size_t i = 0; i < setup->scene.contact_count; i++) {
    strut_contact *c = &setup->scene.contacts[i];
    c->stiffness *= random_between(r, 0.8, 1.2), c->damping *= random_between(r, 0.8, 1.2);
    c->friction.mu_kinetic *= random_between(r, 0.5, 1.0);
    c->friction.stick_velocity *= random_between(r, 0.5, 2.0);
  }
  setup->scene.ground.height += random_between(r, -0.1, 0.1);
  setup->scene.ground.belt_speed *= random_between(r, 0.5, 1.5);
}

static void begin_point(point *p, const char *method, double step, int64_t steps, bool balance) {
  motion_begin_by(&p->alone, &p->setup, method, step);
  motion_begin_by(&p->slot, &p->setup, method, step);
  p->alone.state->balance = p->slot.state->balance = balance;
  p->steps = steps;
}

static void end_point(point *p) {
  motion_end(&p->alone);
  motion_end(&p->slot);
  strut_setup_free(&p->setup);
}

/* Some of the motions are violent and end nowhere; of that only the sign may differ. */
static void check_array(const double *slot, const double *alone, int32_t count) {
  for (int32_t i = 0; i < count; i++)
    if (!isnan(slot[i]) || !isnan(alone[i])) assert_same_bits(slot[i], alone[i]);
}

static void check_point(point *p, bool balance) {
  const strut_state *a = p->slot.state, *b = p->alone.state;
  const strut_model *m = p->slot.model;
  assert_int_equal(a->step, b->step);
  assert_int_equal(a->evaluations, b->evaluations);
  check_array(a->q, b->q, 2 * m->node_count);
  check_array(a->v, b->v, 2 * m->node_count);
  if (balance) check_array(a->work, b->work, STRUT_POWER_COUNT);
  check_array(a->latest.force, b->latest.force, 2 * m->node_count);
  check_array(a->latest.rest, b->latest.rest, m->members.slots);
  check_array(a->latest.rest_rate, b->latest.rest_rate, m->members.slots);
  if (balance) check_array(a->latest.power, b->latest.power, STRUT_POWER_COUNT);
}

/* All ways to step in slots that this processor has: how many, and whether in halves. */
typedef struct way {
  int32_t width;
  bool halves;
} way;
static const way ways[] = {{4, false}, {8, true}, {8, false}};

static size_t way_count(void) { return strut_batch_widest() == 8 ? 3 : 0; }

/* All points through one batch; each has its own length, and makes room for the next. */
static void run_in_batch(point *points, int count, way how, bool balance) {
  point *in[STRUT_BATCH_MOST] = {NULL};
  int32_t width = how.width;
  strut_batch *b = strut_batch_create(points[0].slot.model, points[0].slot.method, width, balance);
  assert_non_null(b);
  if (how.halves) strut_batch_halve(b);
  for (int next = 0, left = count; left > 0;) {
    int64_t still[STRUT_BATCH_MOST] = {0};
    for (int32_t l = 0; l < width; l++) {
      if (!in[l] && next < count) {
        in[l] = &points[next++];
        strut_batch_fill(b, l, in[l]->slot.model, in[l]->slot.step);
        strut_batch_put(b, l, in[l]->slot.state);
      }
      if (in[l]) still[l] = in[l]->steps - in[l]->slot.state->step;
    }
    strut_batch_advance(b, still);
    for (int32_t l = 0; l < width; l++) {
      if (!in[l]) continue;
      strut_batch_get(b, l, in[l]->slot.state);
      if (in[l]->slot.state->step < in[l]->steps) continue;
      motion_steps(&in[l]->alone, in[l]->steps);
      check_point(in[l], balance);
      strut_batch_empty(b, l);
      in[l] = NULL;
      left--;
    }
  }
  strut_batch_free(b);
}

/* Running cables, hinges, laws and stops, with hinges enough for groups of them; some are driven. */
static void make_elements(strut_scene *scene, uint64_t seed) {
  uint64_t r = seed;
  random_elements(scene, seed, 1.0);
  for (int32_t k = 0, n = (int32_t)scene->node_count; k < (int32_t)(seed % 4) * 2; k++)
    build_hinge(scene, k % n, (k + 1) % n, (k + 2) % n, random_between(&r, 5, 20), 0.3);
  int32_t sine = build_sine(scene, 0.05, 2);
  build_actuator(scene, random_below(&r, (int32_t)scene->member_count), sine);
  build_actuator(scene, (int32_t)scene->member_count - 1, sine);
  build_actuator(scene, -1, sine);
  scene->actuators[scene->actuator_count - 1].hinge = 0;
}

static void compare_random(uint64_t seed, void make(strut_scene *, uint64_t), way how, bool balance,
                           int *done) {
  enum { POINTS = 11 };
  static point points[POINTS];
  uint64_t r = seed;
  int count = 0;
  bool possible = true;
  for (; count < POINTS && possible; count++) {
    strut_setup_init(&points[count].setup);
    make(&points[count].setup.scene, seed);
    if (count) vary(&points[count].setup, &r);
    double slow = points[count].setup.scene.hinge_count ? 8.0 : 1.0;
    int32_t steps = 3 + random_below(&r, 200);
    begin_point(&points[count], "rk4", slow * random_scale(&r, 1e-4, 1e-3), steps, balance);
    possible = strut_batch_possible(points[0].slot.model, points[0].slot.method) &&
               strut_batch_takes_both(points[0].slot.model, points[count].slot.model);
  }
  if (possible) run_in_batch(points, count, how, balance);
  *done += possible;
  for (int i = 0; i < count; i++) end_point(&points[i]);
}

TEST(random_structures) {
  int done = 0, seeds = 150;
  for (int seed = 1; seed <= seeds; seed++)
    for (size_t w = 0; w < way_count(); w++)
      compare_random((uint64_t)seed, random_scene, ways[w], seed % 2, &done);
  assert_true(done >= seeds / 2 * (int)way_count()); /* those with a sparse factor have no slots */
}

TEST(random_elements) {
  int done = 0, seeds = 80;
  if (!way_count()) skip();
  for (int seed = 1; seed <= seeds; seed++)
    compare_random((uint64_t)seed, make_elements, ways[(size_t)seed / 2 % way_count()], seed % 2,
                   &done);
  print_message("%d of %d structures in slots\n", done, seeds);
  assert_true(done > seeds / 2);
}

static void run_crawlers(const char *method, way how, bool balance) {
  enum { POINTS = 21 };
  static point points[POINTS];
  uint64_t r = 7;
  for (int i = 0; i < POINTS; i++) {
    strut_setup_init(&points[i].setup);
    double mu = random_between(&r, 0.05, 0.6), amplitude = random_between(&r, 1e-5, 1e-3);
    structure_crawler(&points[i].setup.scene, random_between(&r, 1, 20), amplitude, mu, i % 2);
    if (i % 5 == 3) points[i].setup.scene.signals[0].kind = STRUT_HALF_SINE;
    points[i].setup.experiment.refine = i % 4;
    int32_t steps = 200 + random_below(&r, 6000);
    begin_point(&points[i], method, random_between(&r, 5e-5, 1e-4), steps, balance);
    assert_true(strut_batch_possible(points[i].slot.model, points[i].slot.method));
  }
  run_in_batch(points, POINTS, how, balance);
  for (int i = 0; i < POINTS; i++) end_point(&points[i]);
}

TEST(crawler) {
  for (size_t w = 0; w < way_count(); w++)
    for (int balance = 0; balance < 2; balance++) run_crawlers("rk4", ways[w], balance);
}

/* A slot that may take any number of steps does not end the others' before they are done. */
TEST(endless_lane) {
  static point points[2];
  const int64_t left[STRUT_BATCH_MOST] = {10, INT64_MAX};
  if (!way_count()) skip();
  for (int i = 0; i < 2; i++) {
    strut_setup_init(&points[i].setup);
    structure_crawler(&points[i].setup.scene, 10, 1e-4, 0.1, i);
    begin_point(&points[i], "rk4", 8e-5, 10, true);
  }
  strut_batch *b = strut_batch_create(points[0].slot.model, points[0].slot.method, 4, true);
  assert_non_null(b);
  for (int i = 0; i < 2; i++) {
    strut_batch_fill(b, i, points[i].slot.model, points[i].slot.step);
    strut_batch_put(b, i, points[i].slot.state);
  }
  for (int turn = 1; turn <= 2; turn++) { /* the second begins behind step 0 */
    strut_batch_advance(b, left);
    strut_batch_count(b, 0, points[0].slot.state);
    assert_int_equal(points[0].slot.state->step, 10 * turn);
  }
  strut_batch_free(b);
  for (int i = 0; i < 2; i++) end_point(&points[i]);
}

/* Blocks exactly at the edge of Karnopp's band, and pushed by exactly what holds: as alone. */
static void run_at_edges(const char *method, way how) {
  static const double belts[] = {1, -1, 0, 0, 1, -1}, pushes[] = {0, 0, 8, -8, 8, 8};
  enum { POINTS = 6 };
  static point points[POINTS];
  const double band = 0.125, depth = 1.0 / 64, k = 1024; /* N = 16, exactly */
  for (int i = 0; i < POINTS; i++) {
    strut_setup *setup = &points[i].setup;
    strut_setup_init(setup);
    build_rough_contact(&setup->scene, build_mass(&setup->scene, 0, -depth, 1), k, 0, 0.5, 0.25,
                        band);
    build_load(&setup->scene, 0, pushes[i], -16, -1);
    setup->scene.ground.belt_speed = belts[i] * band;
    begin_point(&points[i], method, 1.0 / 1024, 3, true);
    assert_true(strut_batch_possible(points[i].slot.model, points[i].slot.method));
  }
  run_in_batch(points, POINTS, how, true);
  for (int i = 0; i < POINTS; i++) {
    assert_true(points[i].alone.state->v[0] != 0.0); /* none of them is held */
    end_point(&points[i]);
  }
}

TEST(edges_of_friction) {
  for (size_t w = 0; w < way_count(); w++) run_at_edges("rk4", ways[w]);
}

/* What has no kernel, or another topology, is refused. */
TEST(refusals) {
  strut_setup chain, crawler, other;
  strut_setup_init(&chain), strut_setup_init(&crawler), strut_setup_init(&other);
  structure_chain(&chain.scene, 20, STRUT_MASS_CONSISTENT);
  structure_crawler(&crawler.scene, 10, 1e-4, 0.1, false);
  structure_crawler(&other.scene, 10, 1e-4, 0.1, false);
  other.scene.members[3].node[0] = 4;
  strut_model *a = motion_compile(&chain.scene), *b = motion_compile(&crawler.scene),
              *c = motion_compile(&other.scene);
  const strut_integrator *rk4 = strut_integrator_find("rk4");
  assert_false(strut_batch_possible(a, rk4));
  assert_true(strut_batch_possible(b, rk4));
  assert_false(strut_batch_possible(b, strut_integrator_find("adaptive")));
  assert_true(strut_batch_takes_both(b, b));
  assert_false(strut_batch_takes_both(b, c));
  assert_false(strut_batch_takes_both(a, b));
  strut_model_free(a), strut_model_free(b), strut_model_free(c);
  strut_setup_free(&chain), strut_setup_free(&crawler), strut_setup_free(&other);
}

/* The batch asks for memory a handful of times, and says so when there is none. */
/* A triangle on four nodes; each variant joins, drives, loads or touches something else. */
static strut_model *variant(strut_setup *setup, int which) {
  strut_setup_init(setup);
  setup->scene.mass_model = STRUT_MASS_LUMPED;
  for (int i = 0; i < 4; i++) build_mass(&setup->scene, i, i * i, 1);
  build_member(&setup->scene, STRUT_SPRING, which == 1 ? 3 : 0, 1, 10, 1, 0);
  build_member(&setup->scene, STRUT_SPRING, 1, which == 2 ? 3 : 2, 10, 1, 0);
  build_actuator(&setup->scene, which == 3, build_sine(&setup->scene, 0.1, 1));
  build_load(&setup->scene, which == 4 ? 2 : 1, 1, 0, 0);
  build_contact(&setup->scene, which == 5 ? 2 : 1, 100, 1);
  return motion_compile(&setup->scene);
}

TEST(only_one_topology_shares_a_batch) {
  strut_setup setup, other;
  strut_model *first = variant(&setup, 0);
  for (int which = 0; which <= 5; which++) {
    strut_model *model = variant(&other, which);
    assert_int_equal(strut_batch_takes_both(first, model), which == 0);
    assert_int_equal(strut_batch_takes_both(model, first), which == 0);
    strut_model_free(model);
    strut_setup_free(&other);
  }
  strut_model_free(first);
  strut_setup_free(&setup);
}

TEST(no_memory) {
  strut_setup crawler;
  strut_setup_init(&crawler);
  structure_crawler(&crawler.scene, 10, 1e-4, 0.1, false);
  strut_model *model = motion_compile(&crawler.scene);
  strut_batch *batch = NULL;
  int refused = 0;
  for (; !batch && refused < 100; refused++) {
    strut_fail_allocation_after(refused);
    batch = strut_batch_create(model, strut_integrator_find("rk4"), 4, true);
    strut_fail_allocation_after(-1);
  }
  assert_true(refused > 1 && batch);
  strut_batch_free(batch);
  strut_model_free(model);
  strut_setup_free(&crawler);
}
