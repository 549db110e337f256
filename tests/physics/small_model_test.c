/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Small models in vector registers against the general kernel, bit for bit: random structures of every size
 * that fits, with all terms that the kernel takes, on every set of registers that the processor has.
 */
#include "engine/model/small_model.h"
#include "tests/support/build.h"
#include "tests/support/check.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"
#include "tests/support/structures.h"

enum { SCENES = 400 };

/* A tree of members and a few more, on nodes that lie apart. */
static void add_structure(strut_scene *scene, uint64_t *r) {
  int32_t nodes = 2 + random_below(r, 7), extra = random_below(r, 6);
  for (int32_t i = 0; i < nodes; i++) {
    double up = random_between(r, -0.3, 0.3), right = random_between(r, -0.3, 0.3);
    build_node(scene, (i % 4) + right, i / 4 + up);
    strut_node *node = &scene->nodes[i];
    node->mass = random_scale(r, 0.1, 10);
    node->velocity[0] = random_between(r, -1, 1), node->velocity[1] = random_between(r, -1, 1);
    if (!random_once_in(r, 6)) continue;
    int c = random_below(r, 2);
    node->fixed[c] = true, node->velocity[c] = 0.0;
  }
  for (int32_t j = 1; j < nodes + extra && j <= STRUT_SMALL_MEMBERS; j++) {
    int32_t a = j < nodes ? j : random_below(r, nodes), b = random_below(r, j < nodes ? j : nodes);
    if (a == b) continue;
    double mass = random_once_in(r, 2) ? random_scale(r, 0.1, 10) : 0.0;
    int32_t kind = mass > 0 ? STRUT_BAR : random_below(r, 3);
    double damping = random_once_in(r, 3) ? 0.0 : random_scale(r, 0.1, 10);
    build_member(scene, (strut_member_kind)kind, a, b, random_scale(r, 10, 1e4), damping, mass);
    scene->members[scene->member_count - 1].rest_kind = STRUT_REST_RATIO;
    scene->members[scene->member_count - 1].rest_value = random_between(r, 0.7, 1.3);
  }
}

static void add_drives(strut_scene *scene, uint64_t *r) {
  for (int i = 0; i < 3; i++) {
    bool wave = i < 2;
    strut_signal s = strut_signal_default(wave ? STRUT_SINE : STRUT_SQUARE);
    s.amplitude = random_between(r, -0.1, 0.1);
    s.frequency = random_scale(r, 0.5, 40);
    s.phase = random_between(r, -1, 1);
    if (i == 1) s.start = random_between(r, 0, 0.01), s.stop = s.start + random_between(r, 0, 0.05);
    build_signal(scene, s);
  }
  for (int32_t i = random_below(r, 5); i > 0; i--) {
    int32_t signal = random_below(r, 3);
    build_actuator(scene, random_below(r, (int32_t)scene->member_count), signal);
  }
}

/* Contacts with all laws that a plain method steps. */
static void add_ground(strut_scene *scene, uint64_t *r) {
  bool laws = random_once_in(r, 3), rough = random_once_in(r, 2);
  scene->ground.height = random_between(r, -0.5, 0.5);
  if (random_once_in(r, 3)) scene->ground.slope = random_between(r, -0.7, 0.7);
  if (random_once_in(r, 3)) scene->ground.belt_speed = random_between(r, -1, 1);
  if (laws && random_once_in(r, 2)) scene->ground.damping_law = STRUT_DAMPING_HUNT_CROSSLEY;
  for (int32_t node = 0; node < (int32_t)scene->node_count; node++) {
    if (random_once_in(r, 4)) continue;
    double mu = random_between(r, 0.1, 1), damping = random_once_in(r, 3) ? 0 : 10;
    double stiffness = random_scale(r, 100, 1e4), band = random_scale(r, 1e-3, 1);
    int32_t i = rough ? build_rough_contact(scene, node, stiffness, damping, 1.5 * mu, mu, band)
                      : build_contact(scene, node, stiffness, damping);
    strut_contact *c = &scene->contacts[i];
    c->dissipation = random_between(r, 0.1, 2);
    if (rough && random_once_in(r, 3)) c->friction.law = STRUT_FRICTION_COULOMB;
    if (!laws || !rough) continue;
    if (random_once_in(r, 3)) {
      c->friction.law = random_once_in(r, 2) ? STRUT_FRICTION_SMOOTH : STRUT_FRICTION_STRIBECK;
      c->friction.width = 0.01, c->friction.decay_velocity = 0.1;
    }
    c->friction.directional = random_once_in(r, 2);
    c->friction.mu_static_backward = 0.9, c->friction.mu_kinetic_backward = 0.5;
  }
  scene->ground.present = scene->contact_count > 0;
}

static void make_scene(strut_scene *scene, uint64_t seed) {
  uint64_t state = seed, *r = &state;
  strut_scene_init(scene);
  scene->mass_model = random_once_in(r, 3) ? STRUT_MASS_LUMPED : STRUT_MASS_CONSISTENT;
  add_structure(scene, r);
  if (!random_once_in(r, 3)) add_drives(scene, r);
  if (!random_once_in(r, 3)) scene->gravity[1] = random_between(r, -20, 0);
  if (!random_once_in(r, 4)) add_ground(scene, r);
}

static void check_array(const double *small, const double *general, int32_t count) {
  for (int32_t i = 0; i < count; i++)
    if (!isnan(small[i]) || !isnan(general[i])) assert_same_bits(small[i], general[i]);
}

static void check_states(const motion *small, const motion *general) {
  const strut_state *a = small->state, *b = general->state;
  const strut_model *m = general->model;
  assert_int_equal(a->step, b->step);
  assert_int_equal(a->evaluations, b->evaluations);
  check_array(a->q, b->q, m->length);
  check_array(a->v, b->v, m->length);
  check_array(a->latest.force, b->latest.force, 2 * m->node_count);
  check_array(a->work, b->work, STRUT_POWER_ROOM);
  check_array(a->latest.power, b->latest.power, STRUT_POWER_ROOM);
  check_array(a->latest.rest, b->latest.rest, m->members.slots);
  check_array(a->latest.rest_rate, b->latest.rest_rate, m->members.slots);
  check_array(&a->latest.drive_time, &b->latest.drive_time, 1);
  assert_int_equal(a->events, b->events);
  if (!a->modes.held_normal) return;
  check_array(a->modes.held_normal, b->modes.held_normal, m->contacts.count);
  check_array(a->modes.held_friction, b->modes.held_friction, m->contacts.count);
}

/* Steps in pieces of several lengths, with pauses in which others look on. */
static void compare(const strut_setup *setup, const char *method, strut_small_level level,
                    bool balance, int *stepped) {
  motion small, general;
  motion_begin_by(&small, setup, method, 1e-3);
  motion_begin_by(&general, setup, method, 1e-3);
  general.model->small = NULL;
  if (small.model->small && small.model->small->level >= level) {
    small.model->small->level = level;
    small.state->balance = general.state->balance = balance;
    for (int64_t count = 1; count <= 64 && !general.state->trouble; count = 3 * count + 1) {
      motion_steps(&small, count);
      motion_steps(&general, count);
      check_states(&small, &general);
    }
    ++*stepped;
  }
  motion_end(&small);
  motion_end(&general);
}

TEST(small_models_have_the_bits_of_the_general_kernel) {
  static const char *const methods[] = {"rk4",           "verlet",   "rk4-events",
                                        "verlet-events", "adaptive", "adaptive8"};
  int stepped[STRUT_SMALL_AVX512 + 1] = {0};
  for (uint64_t seed = 1; seed <= SCENES; seed++) {
    strut_setup setup = {.experiment = strut_experiment_default()};
    make_scene(&setup.scene, seed);
    for (int level = STRUT_SMALL_AVX2; level <= STRUT_SMALL_AVX512; level++)
      for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++)
        compare(&setup, methods[i], (strut_small_level)level, seed % 2, &stepped[level]);
    strut_scene_free(&setup.scene);
  }
  print_message("%d motions by AVX2, %d by AVX-512\n", stepped[STRUT_SMALL_AVX2],
                stepped[STRUT_SMALL_AVX512]);
}
