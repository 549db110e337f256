/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A large structure whose nodes and members are listed in any order is stored in another one: the same bits. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/integrate/domain_parts.h"
#include "engine/integrate/large_steps.h"
#include "engine/model/renumber.h"
#include "tests/support/build.h"
#include "tests/support/check.h"
#include "tests/support/motion.h"

enum { WIDE = 210, HIGH = 80, NODES = WIDE * HIGH, MOST = 4 * NODES };

static uint64_t noise = 1;

static uint32_t draw(uint32_t below) {
  noise = noise * 6364136223846793005u + 1442695040888963407u;
  return (uint32_t)((noise >> 33) % below);
}

/* The same numbers in another order. */
static void shuffle(int32_t *order, int32_t count) {
  for (int32_t i = 0; i < count; i++) order[i] = i;
  for (int32_t i = count - 1; i > 0; i--) {
    int32_t k = (int32_t)draw((uint32_t)i + 1), kept = order[i];
    order[i] = order[k], order[k] = kept;
  }
}

static void add_member(strut_scene *scene, const int32_t *place, int32_t a, int32_t b, bool cable,
                       bool damped, double mass) {
  double length = hypot((double)(a / HIGH - b / HIGH), (double)(a % HIGH - b % HIGH));
  strut_member *m = &scene->members[scene->member_count++];
  *m = strut_member_default();
  m->kind = cable ? STRUT_CABLE : STRUT_SPRING;
  m->node[0] = place[a], m->node[1] = place[b];
  m->rest_kind = STRUT_REST_LENGTH, m->rest_value = 0.97 * length;
  m->stiffness = cable ? 60.0 : 100.0 + draw(50), m->damping = damped ? 0.2 : 0.0, m->mass = mass;
}

/* A grid of X-frames that falls on its lowest row, shaken and driven; shuffled where `scattered`. */
static void grid(strut_setup *setup, bool scattered, bool consistent, bool damped) {
  strut_scene *scene = &setup->scene;
  static int32_t place[NODES], order[MOST];
  strut_setup_init(setup);
  noise = 1;
  if (scattered)
    shuffle(place, NODES);
  else
    for (int32_t i = 0; i < NODES; i++) place[i] = i;
  scene->nodes = strut_arena_allocate(&scene->arena, NODES, sizeof *scene->nodes);
  scene->members = strut_arena_allocate(&scene->arena, MOST, sizeof *scene->members);
  scene->contacts = strut_arena_allocate(&scene->arena, WIDE, sizeof *scene->contacts);
  assert_true(scene->nodes && scene->members && scene->contacts);
  scene->node_count = NODES;
  scene->mass_model = consistent ? STRUT_MASS_CONSISTENT : STRUT_MASS_LUMPED;
  for (int32_t i = 0; i < NODES; i++) {
    strut_node *n = &scene->nodes[place[i]];
    *n = strut_node_default();
    n->position[0] = n->start[0] = i / HIGH + 1e-3 * draw(20);
    n->position[1] = n->start[1] = i % HIGH + 1e-3 * draw(20);
    n->mass = 0.1 + 0.01 * draw(5);
    n->velocity[1] = -1.0;
    if (i == NODES - 1) n->fixed[0] = n->fixed[1] = true;
  }
  double mass = consistent ? 0.05 : 0.0;
  for (int32_t i = 0; i < NODES; i++) {
    bool right = i / HIGH + 1 < WIDE, up = i % HIGH + 1 < HIGH;
    if (right) add_member(scene, place, i, i + HIGH, false, damped, mass);
    if (up) add_member(scene, place, i, i + 1, false, damped, 0.0);
    if (right && up) add_member(scene, place, i, i + HIGH + 1, true, false, 0.0);
    if (right && up) add_member(scene, place, i + 1, i + HIGH, true, damped, 0.0);
  }
  if (scattered) {
    strut_member *kept = malloc(scene->member_count * sizeof *kept);
    assert_non_null(kept);
    memcpy(kept, scene->members, scene->member_count * sizeof *kept);
    shuffle(order, (int32_t)scene->member_count);
    for (size_t j = 0; j < scene->member_count; j++) scene->members[j] = kept[order[j]];
    free(kept);
  }
  scene->gravity[1] = -9.81;
  scene->ground.present = true;
  scene->ground.height = -1e-3;
  for (int32_t i = 0; i < WIDE; i++) {
    strut_contact *c = &scene->contacts[scene->contact_count++];
    *c = (strut_contact){.node = place[i * HIGH], .stiffness = 1e4, .damping = 5};
    c->friction = (strut_friction){
        .law = STRUT_FRICTION_KARNOPP, .mu_static = 0.5, .mu_kinetic = 0.4, .stick_velocity = 1e-3};
  }
  build_actuator(scene, 17, build_sine(scene, 0.05, 7.0));
  build_actuator(scene, (int32_t)scene->member_count - 3, build_sine(scene, 0.02, 11.0));
  build_load(scene, place[HIGH], 3.0, 1.0, build_sine(scene, 1.0, 3.0));
}

/* Without the check, which asks for names. */
static strut_model *compile(const strut_scene *scene) {
  strut_model *model;
  strut_error error = {0};
  assert_int_equal(strut_model_compile(scene, &model, &error), STRUT_OK);
  return model;
}

static strut_state *state_of(const strut_model *model, bool balance) {
  strut_state *state;
  strut_error error = {0};
  assert_int_equal(strut_state_create(model, &state, &error), STRUT_OK);
  state->balance = balance;
  return state;
}

static bool of_contacts(int power) {
  return power == STRUT_POWER_CONTACT || power == STRUT_POWER_FRICTION || power == STRUT_POWER_BELT;
}

/* Both orders of storage, in pieces of several lengths; with a restart between. */
static void compare(const strut_setup *setup, const char *name, int threads, bool exact,
                    bool balance) {
  const strut_integrator_settings settings = {.step = 1e-3};
  const strut_integrator *method = strut_integrator_find(name);
  strut_model *model = compile(&setup->scene);
  strut_state *usual = state_of(model, balance), *state = state_of(model, balance);
  void *workspace = method->create(model, usual, &settings);
  strut_large_steps *other;
  strut_error error = {0};
  assert_int_equal(strut_large_steps_create(model, method, &settings, threads, &other, &error),
                   STRUT_OK);
  assert_true(workspace && other);
  size_t bytes = (size_t)model->length * sizeof(double);
  strut_large_steps_restart(other, state, 1e-3);
  if (method->restart) method->restart(model, usual, workspace, 1e-3);
  for (int64_t piece = 1; piece < 8; piece++) {
    method->advance(model, usual, workspace, 1e-3, piece);
    strut_large_steps_advance(other, state, 1e-3, piece);
    assert_int_equal(usual->step, state->step);
    assert_memory_equal(usual->q, state->q, bytes);
    assert_memory_equal(usual->v, state->v, bytes);
    for (int32_t i = 0; i < model->contacts.count; i++)
      assert_same_bits(usual->latest.normal[i] + usual->latest.friction[i],
                       state->latest.normal[i] + state->latest.friction[i]);
    for (int p = 0; p < STRUT_POWER_COUNT; p++)
      if (exact ||
          of_contacts(p)) /* contacts are added up in the scene's order, however nodes are stored */
        assert_same_bits(usual->work[p], state->work[p]);
      else
        assert_near(usual->work[p], state->work[p], 1e-12 * fmax(1.0, fabs(usual->work[p])));
    if (piece != 4) continue;
    usual->v[40] = state->v[40] = 2.5;
    strut_large_steps_restart(other, state, 1e-3);
    if (method->restart) method->restart(model, usual, workspace, 1e-3);
  }
  assert_int_equal(usual->evaluations, state->evaluations);
  strut_large_steps_free(other);
  strut_state_free(usual);
  strut_state_free(state);
  strut_model_free(model);
}

static const char *const methods[] = {"rk4", "verlet", "euler"};
enum { METHODS = sizeof methods / sizeof *methods };

TEST(every_method_has_the_same_bits) {
  strut_setup setup;
  for (int consistent = 0; consistent < 2; consistent++) {
    grid(&setup, true, consistent, true);
    for (size_t i = 0; i < METHODS; i++)
      compare(&setup, methods[i], 1, false, i % 2 == (size_t)consistent);
    compare(&setup, "rk4", 3, false, true);
    strut_setup_free(&setup);
  }
  grid(&setup, true, false, false);
  for (size_t i = 0; i < METHODS; i++) compare(&setup, methods[i], 2, false, true);
  strut_setup_free(&setup);
}

/* As listed, any number of threads sums the energy balance, too, in the order of one. */
TEST(any_number_of_threads_has_the_same_bits) {
  static const int threads[] = {2, 3, 5, 8};
  strut_setup setup;
  grid(&setup, false, false, true);
  for (size_t i = 0; i < METHODS; i++)
    for (size_t k = 0; k < sizeof threads / sizeof *threads; k++)
      compare(&setup, methods[i], threads[k], true, threads[k] != 5);
  setup.scene.contact_count = 0;
  compare(&setup, "rk4", 2, true, true);
  setup.scene.load_count = setup.scene.actuator_count = 0;
  for (size_t i = 0; i < METHODS; i++) compare(&setup, methods[i], 4, true, true);
  strut_setup_free(&setup);
}

/* Rows of nodes that nothing couples; all nodes coupled; small groups; supports that differ in x and y. */
TEST(coupled_masses) {
  enum { ROWS, ALL, GROUPS, SUPPORTS, KINDS };
  static const int threads[] = {3};
  strut_setup setup;
  for (int kind = ROWS; kind < KINDS; kind++) {
    grid(&setup, false, true, true);
    strut_scene *scene = &setup.scene;
    for (size_t j = 0; j < scene->member_count && kind != ROWS; j++)
      scene->members[j].mass = kind != GROUPS || j % 37 == 0 || j % 37 == 5 ? 0.05 : 0.0;
    if (kind == SUPPORTS) scene->nodes[NODES / 2].fixed[0] = true;
    for (size_t k = 0; k < sizeof threads / sizeof *threads; k++)
      compare(&setup, methods[(size_t)kind % METHODS], threads[k], true, k != 1);
    for (size_t i = 0; i < METHODS; i++) compare(&setup, methods[i], 2, true, i != 1);
    strut_setup_free(&setup);
  }
}

/* In another order, too, the energy balance adds up the same for any number of threads. */
TEST(the_balance_does_not_depend_on_threads) {
  static const int threads[] = {1, 2, 8};
  const strut_integrator_settings settings = {.step = 1e-3};
  strut_setup setup;
  for (int consistent = 0; consistent < 2; consistent++) {
    double work[STRUT_POWER_COUNT] = {0};
    grid(&setup, true, consistent, true);
    strut_model *model = compile(&setup.scene);
    for (size_t k = 0; k < sizeof threads / sizeof *threads; k++) {
      strut_state *state = state_of(model, true);
      strut_large_steps *steps;
      strut_error error = {0};
      assert_int_equal(strut_large_steps_create(model, strut_integrator_find("rk4"), &settings,
                                                threads[k], &steps, &error),
                       STRUT_OK);
      strut_large_steps_restart(steps, state, 1e-3);
      strut_large_steps_advance(steps, state, 1e-3, 5);
      for (int p = 0; p < STRUT_POWER_COUNT; p++)
        if (k == 0)
          work[p] = state->work[p];
        else
          assert_same_bits(work[p], state->work[p]);
      strut_large_steps_free(steps);
      strut_state_free(state);
    }
    strut_model_free(model);
    strut_setup_free(&setup);
  }
}

/* All springs before all cables, as tables of a paper are: each thread would need all nodes. */
TEST(kinds_one_after_the_other_are_reordered) {
  strut_setup setup;
  grid(&setup, false, false, true);
  strut_scene *scene = &setup.scene;
  static strut_member kept[MOST];
  size_t count = 0;
  memcpy(kept, scene->members, scene->member_count * sizeof *kept);
  for (int cables = 0; cables < 2; cables++)
    for (size_t j = 0; j < scene->member_count; j++)
      if ((kept[j].kind == STRUT_CABLE) == cables) scene->members[count++] = kept[j];
  assert_int_equal(count, scene->member_count);
  strut_model *model = compile(scene);
  assert_true(strut_model_is_scattered(model));
  strut_model_free(model);
  for (size_t i = 0; i < METHODS; i++) compare(&setup, methods[i], 2, false, true);
  strut_setup_free(&setup);
}

static int by_later_node(const void *a, const void *b) {
  const strut_member *x = a, *y = b;
  int32_t later = x->node[0] > x->node[1] ? x->node[0] : x->node[1];
  int32_t other = y->node[0] > y->node[1] ? y->node[0] : y->node[1];
  if (later != other) return later > other ? 1 : -1;
  int32_t sum = x->node[0] + x->node[1], others = y->node[0] + y->node[1];
  return (sum > others) - (sum < others);
}

/* Few members lead from one half to a node of the other that is tied to much of it: ghosts of ghosts. */
TEST(a_hub_makes_no_difference) {
  enum { HUB = HIGH / 2 };
  static int32_t place[NODES];
  strut_setup setup;
  grid(&setup, false, false, true);
  strut_scene *scene = &setup.scene;
  scene->actuator_count = 0;
  for (int32_t i = 0; i < NODES; i++) place[i] = i;
  for (int32_t i = 2 * HIGH; i < 100 * HIGH && scene->member_count < MOST; i += 7)
    add_member(scene, place, HUB, i, true, true, 0.0);
  qsort(scene->members, scene->member_count, sizeof *scene->members, by_later_node);
  strut_model *model = compile(scene);
  assert_false(strut_model_is_scattered(model));
  strut_model_free(model);
  for (size_t i = 0; i < METHODS; i++) compare(&setup, methods[i], 2, true, i != 1);
  compare(&setup, "rk4", 8, true, true);
  strut_setup_free(&setup);
}

/* One, and more than a team has: as many as it has. */
TEST(one_thread_and_a_hundred) {
  enum { CELLS = 16000 };
  static strut_node node[2 * CELLS];
  static strut_member member[5 * CELLS];
  strut_setup setup;
  strut_setup_init(&setup);
  strut_scene *scene = &setup.scene;
  scene->nodes = node, scene->members = member;
  scene->node_count = 2 * CELLS, scene->mass_model = STRUT_MASS_LUMPED;
  for (int32_t i = 0; i < 2 * CELLS; i++) {
    node[i] = strut_node_default();
    node[i].position[0] = node[i].start[0] = i / 2 + 1e-3 * (i % 7);
    node[i].position[1] = node[i].start[1] = i % 2;
    node[i].mass = 0.1;
  }
  for (int32_t i = 0; i + 2 < 2 * CELLS; i++)
    for (int32_t step = 1; step < 4; step++) {
      if (step + i % 2 == 4) continue;
      strut_member *m = &member[scene->member_count++];
      *m = strut_member_default();
      m->kind = STRUT_SPRING, m->node[0] = i, m->node[1] = i + step;
      m->rest_kind = STRUT_REST_LENGTH, m->rest_value = 0.97 * hypot((i % 2 + step) / 2, step % 2);
      m->stiffness = 100.0, m->damping = 0.1;
    }
  strut_model *model = compile(scene);
  const strut_integrator_settings settings = {.step = 1e-3};
  for (size_t k = 0; k < 2 * METHODS; k++) {
    const strut_integrator *method = strut_integrator_find(methods[k / 2]);
    strut_state *usual = state_of(model, true), *state = state_of(model, true);
    void *workspace = method->create(model, usual, &settings);
    strut_domain_steps *other = strut_domain_steps_create(model, method, NULL, k % 2 ? 1 : 100);
    assert_true(workspace && other);
    strut_domain_steps_restart(other, state, 1e-3);
    method->advance(model, usual, workspace, 1e-3, 6);
    strut_domain_steps_advance(other, state, 1e-3, 6);
    assert_memory_equal(usual->q, state->q, (size_t)model->length * sizeof(double));
    assert_memory_equal(usual->work, state->work, sizeof state->work);
    strut_domain_steps_free(other);
    strut_state_free(usual);
    strut_state_free(state);
  }
  strut_model_free(model);
  scene->nodes = NULL, scene->members = NULL;
  strut_setup_free(&setup);
}

TEST(what_is_in_order_stays_as_it_is) {
  strut_setup setup;
  grid(&setup, false, false, true);
  strut_model *model = compile(&setup.scene);
  assert_true(model->members.count >= 16384);
  assert_false(strut_model_is_scattered(model));
  strut_model_free(model);
  strut_setup_free(&setup);
}

/* Members at each node keep their order of the scene; every one is stored once. */
TEST(members_at_a_node_keep_their_order) {
  strut_setup setup;
  strut_renumbering *r;
  strut_error error = {0};
  grid(&setup, true, false, true);
  strut_model *model = compile(&setup.scene);
  assert_true(strut_model_is_scattered(model));
  assert_int_equal(strut_renumbering_create(model, false, &r, &error), STRUT_OK);
  static int32_t last[NODES], met[MOST];
  for (int32_t i = 0; i < NODES; i++) last[i] = -1;
  int64_t reach = 0;
  for (int32_t k = 0; k < model->members.count; k++) {
    int32_t j = r->member[k];
    const int32_t ends[] = {(int32_t)(r->model->members.from[k] / 2),
                            (int32_t)(r->model->members.to[k] / 2)};
    met[j]++;
    reach += abs(ends[0] - ends[1]);
    assert_int_equal(ends[0], r->place[model->members.from[j] / 2]);
    for (int e = 0; e < 2; e++) {
      assert_true(last[ends[e]] < j);
      last[ends[e]] = j;
    }
  }
  for (int32_t j = 0; j < model->members.count; j++) assert_int_equal(met[j], 1);
  assert_true(reach < 10 * HIGH * (int64_t)model->members.count); /* 4000 as listed */
  strut_renumbering_free(r);
  strut_model_free(model);
  strut_setup_free(&setup);
}
