/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A term that the scene does not need is not in the model; leaving it out changes no bit of the rest
 * and costs no time.
 */
#include "tests/support/instructions.h"
#include "tests/support/structures.h"

enum { FRAMES = 12 }; /* 60 members: each instruction is stepped through */

/* Nodes only: no member pulls at them. */
static void build_nodes(strut_scene *scene) {
  for (int i = 0; i < 2 * (FRAMES + 1); i++) build_mass(scene, i / 2, i % 2, 0.1);
}

/* On each node a load of 0 N, constant or on a signal. */
static void build_loads(strut_scene *scene, int32_t signal) {
  for (int32_t i = 0; i < (int32_t)scene->node_count; i++)
    build_load(scene, i, signal < 0 ? 0 : 1, signal < 0 ? 0 : 2, signal);
}

/* The lower nodes rest on a soft ground, or it lies far below them. */
static void build_ground(strut_scene *scene, unsigned terms, bool touching) {
  scene->ground.height = touching ? 0.001 : -100;
  scene->ground.slope = terms & STRUT_TERM_SLOPE ? 1e-300 : 0;
  for (int32_t i = 0; i < (int32_t)scene->node_count; i += 2)
    if (terms & STRUT_TERM_FRICTION)
      build_rough_contact(scene, i, 50, 0.1, 0, 0, 1e-3);
    else
      build_contact(scene, i, 50, 0.1);
}

/*
 * A long chain that needs exactly these terms, all of them without effect: dampers of 1e-300 N s/m,
 * cables that stay taut, strokes and loads of nothing, friction of nothing, a slope of 1e-300.
 */
static strut_scene build_chain(unsigned terms, bool touching) {
  strut_scene scene = build_scene();
  if (terms & STRUT_TERM_MEMBERS)
    structure_chain(&scene, FRAMES,
                    terms & STRUT_TERM_SOLVE ? STRUT_MASS_CONSISTENT : STRUT_MASS_LUMPED);
  else
    build_nodes(&scene);
  for (size_t j = 0; j < scene.member_count; j++) {
    strut_member *member = &scene.members[j];
    member->damping = terms & STRUT_TERM_DAMPING ? 1e-300 : 0;
    if (member->kind == STRUT_CABLE && !(terms & STRUT_TERM_SLACK)) member->kind = STRUT_SPRING;
  }
  int32_t nothing = build_sine(&scene, 0, 10);
  for (int32_t j = 0; j < (int32_t)scene.member_count && (terms & STRUT_TERM_DRIVE); j++)
    build_actuator(&scene, j, nothing);
  if (terms & STRUT_TERM_CONSTANT) build_loads(&scene, -1);
  if (terms & STRUT_TERM_LOADS) build_loads(&scene, nothing);
  if (terms & STRUT_TERM_CONTACT) build_ground(&scene, terms, touching);
  for (size_t i = 2; i < scene.node_count; i++) /* nothing stands still, so no sum is only zeros */
    scene.nodes[i].velocity[0] = 0.01 * sin((double)i), scene.nodes[i].velocity[1] = 0.02;
  return scene;
}

/* A term, and the others that are in the scene with and without it. */
typedef struct comparison {
  strut_term term;
  unsigned others;
  bool touching, same_bits;
} comparison;

enum {
  PULL = STRUT_TERM_MEMBERS,
  STAND = STRUT_TERM_MEMBERS | STRUT_TERM_CONTACT,
  ALL = 2 * STRUT_TERM_SOLVE - 1
};

static const comparison comparisons[] = {
    {STRUT_TERM_MEMBERS, 0, false, false},
    {STRUT_TERM_DAMPING, PULL, false, true},
    {STRUT_TERM_SLACK, PULL, false, true},
    {STRUT_TERM_DRIVE, PULL, false, true},
    {STRUT_TERM_CONSTANT, PULL, false, true},
    {STRUT_TERM_LOADS, PULL, false, true},
    {STRUT_TERM_CONTACT, PULL, false, true},
    {STRUT_TERM_FRICTION, STAND, true, true},
    {STRUT_TERM_SLOPE, STAND, true, true},
    {STRUT_TERM_SOLVE, PULL, false, false},
    {STRUT_TERM_DAMPING, ALL & ~(unsigned)STRUT_TERM_DAMPING, true, true},
    {STRUT_TERM_SLACK, ALL & ~(unsigned)STRUT_TERM_SLACK, true, true},
    {STRUT_TERM_DRIVE, ALL & ~(unsigned)STRUT_TERM_DRIVE, true, true},
    {STRUT_TERM_CONSTANT, ALL & ~(unsigned)STRUT_TERM_CONSTANT, true, true},
    {STRUT_TERM_LOADS, ALL & ~(unsigned)STRUT_TERM_LOADS, true, true},
    {STRUT_TERM_FRICTION, ALL & ~(unsigned)STRUT_TERM_FRICTION, true, true},
    {STRUT_TERM_SLOPE, ALL & ~(unsigned)STRUT_TERM_SLOPE, true, true}};
enum { COMPARISONS = sizeof comparisons / sizeof comparisons[0], SINGLE = 10 };

/* The same motion with and without the term, ready to step. */
typedef struct both {
  strut_scene scene[2];
  motion motion[2]; /* without, with */
} both;

static void begin_both(const comparison *c, both *b) {
  for (int with = 0; with < 2; with++) {
    unsigned terms = c->others | (with ? (unsigned)c->term : 0);
    b->scene[with] = build_chain(terms, c->touching);
    b->motion[with] = motion_begin(&b->scene[with], 1e-5);
    assert_int_equal(b->motion[with].model->terms, terms);
  }
}

static void end_both(both *b) {
  for (int with = 0; with < 2; with++) {
    motion_free(&b->motion[with]);
    strut_scene_free(&b->scene[with]);
  }
}

TEST(leaving_a_term_out_changes_no_bit) {
  for (int i = 0; i < COMPARISONS; i++) {
    both b;
    begin_both(&comparisons[i], &b);
    for (int with = 0; with < 2 && comparisons[i].same_bits; with++)
      motion_steps(&b.motion[with], 200);
    const strut_state *without = b.motion[0].state, *with = b.motion[1].state;
    for (size_t k = 0; k < 2 * b.scene[0].node_count && comparisons[i].same_bits; k++) {
      assert_same_bits(with->q[k], without->q[k]);
      assert_true(with->v[k] == without->v[k]);
    }
    end_both(&b);
  }
}

/* The body that is looked at: masses on springs, which need neither a solve nor anything else. */
static void add_body(strut_scene *scene, bool springs) {
  static const double corner[4][2] = {{0, 0}, {1, 0.1}, {0.9, 1}, {-0.1, 1.2}};
  for (int i = 0; i < 4; i++) {
    build_mass(scene, corner[i][0], corner[i][1], 0.3 + 0.1 * i);
    scene->nodes[i].velocity[0] = 0.3 * i - 0.5, scene->nodes[i].velocity[1] = 0.2;
  }
  for (int i = 0; i < 4 && springs; i++)
    build_sized(scene, STRUT_SPRING, i, (i + 1) % 4, 70, 0, 0, 0.9);
}

/* Something else in the same scene, not joined to the body, that needs the term. */
static void add_stranger(strut_scene *scene, strut_term term) {
  int32_t a = build_mass(scene, 5, 5, 1), b = build_mass(scene, 6, 5.5, 1);
  bool heavy = term == STRUT_TERM_SOLVE;
  int32_t member = build_sized(scene, term == STRUT_TERM_SLACK ? STRUT_CABLE : STRUT_SPRING, a, b,
                               90, term == STRUT_TERM_DAMPING ? 2 : 0, heavy ? 0.5 : 0, 0.8);
  for (int32_t i = 0, last = b; i < 12 && heavy; i++) { /* more than a dense block */
    int32_t next = build_node(scene, 7 + i, 5);
    build_member(scene, STRUT_BAR, last, next, 50, 0, 0.4);
    last = next;
  }
  if (term == STRUT_TERM_DRIVE) build_actuator(scene, member, build_sine(scene, 0.1, 3));
  if (term == STRUT_TERM_CONSTANT) build_load(scene, a, 1, 2, -1);
  if (term == STRUT_TERM_LOADS) build_load(scene, a, 1, 2, build_sine(scene, 2, 3));
  scene->ground.height = 5.1;
  if (term == STRUT_TERM_CONTACT) build_contact(scene, a, 100, 1);
  if (term == STRUT_TERM_FRICTION) build_rough_contact(scene, a, 100, 1, 0.5, 0.4, 0.01);
}

TEST(what_others_need_changes_no_bit) {
  for (unsigned term = STRUT_TERM_MEMBERS; term <= STRUT_TERM_SOLVE; term <<= 1) {
    strut_scene scene[2];
    motion m[2];
    if (term == STRUT_TERM_SLOPE) continue; /* there is one ground for all */
    for (int with = 0; with < 2; with++) {
      strut_scene_init(&scene[with]);
      add_body(&scene[with], term != STRUT_TERM_MEMBERS);
      if (with) add_stranger(&scene[with], (strut_term)term);
      m[with] = motion_begin(&scene[with], 1e-3);
      motion_steps(&m[with], 500);
    }
    assert_all(!(m[0].model->terms & term), m[1].model->terms & term);
    for (int k = 0; k < 8; k++) {
      assert_same_bits(m[1].state->q[k], m[0].state->q[k]);
      assert_same_bits(m[1].state->v[k], m[0].state->v[k]);
    }
    for (int with = 0; with < 2; with++) {
      motion_free(&m[with]);
      strut_scene_free(&scene[with]);
    }
  }
}

static void one_step(void *context) { motion_steps(context, 1); }

/* In instructions, which a busy machine does not change: fewer without the term than with it. */
TEST(leaving_a_term_out_saves_its_time) {
  for (int i = 0; i < SINGLE; i++) {
    both b;
    long count[2];
    begin_both(&comparisons[i], &b);
    for (int with = 0; with < 2; with++)
      count[with] = count_instructions(one_step, &b.motion[with]);
    print_message("term %u: %ld instructions without, %ld with\n", (unsigned)comparisons[i].term,
                  count[0], count[1]);
    end_both(&b);
    if (count[0] < 0 || count[1] < 0) {
      print_message("this machine does not let a process be stepped\n");
      skip();
    }
    assert_true(count[0] < count[1]);
  }
}
