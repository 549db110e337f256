/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Elements once more, and changes of a scene whose effect is known.
 *
 * The forces of random running cables, hinges, laws and stops are computed a second time in long double:
 * strains by their definition, gradients by differences of them, laws by the words of the language. Then
 * turned, mirrored and larger scenes must move as the turned, mirrored and larger scene.
 */
#include <math.h>
#include <stdlib.h>

#include "engine/forces/forces.h"
#include "tests/physics/random_elements.h"
#include "tests/physics/slow_elements.h"
#include "tests/support/build.h"
#include "tests/support/check.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

/* Widening is the point here; clang counts it as promotion. */
#pragma GCC diagnostic ignored "-Wdouble-promotion"

enum { SCENES = 60, MOST = SLOW_MOST };
static const double TOLERANCE = 1e-11;

/* ---- the slow way ---- */

/* Adds what an element does; carries: 1 tension only, -1 compression only. */
static void add_element(long double *force, const slow_strain *s, long double *q, const double *v,
                        const strut_law *law, double stiffness, double damping, double natural,
                        int carries) {
  long double b[2 * MOST], rate = 0, e = slow_strain_value(s, q);
  slow_strain_gradient(s, q, b);
  for (size_t k = 0; k < 2 * s->count; k++) rate += b[k] * v[2 * (size_t)s->node[k / 2] + k % 2];
  long double t = slow_law_force(law, stiffness, e, natural) + damping * rate;
  if (carries && !(carries * (e - natural) > 0 && carries * t > 0)) return;
  for (size_t k = 0; k < 2 * s->count; k++) force[2 * (size_t)s->node[k / 2] + k % 2] -= t * b[k];
}

static int sign_of(strut_carries carries) {
  return carries == STRUT_CARRIES_TENSION ? 1 : carries == STRUT_CARRIES_COMPRESSION ? -1 : 0;
}

static void add_member(long double *force, const strut_scene *scene, size_t j, long double *q,
                       const double *v) {
  static const strut_law linear = {.kind = STRUT_LAW_LINEAR};
  const strut_member *m = &scene->members[j];
  slow_strain s = slow_path_of(m);
  strut_rest rest;
  assert_true(strut_member_rest(scene, j, &rest));
  double stop = m->stop_stiffness > 0 ? m->stop_stiffness : 100 * rest.stiffness;
  int carries = m->kind == STRUT_CABLE ? 1 : sign_of(m->law.carries);
  add_element(force, &s, q, v, &m->law, rest.stiffness, m->damping, rest.length, carries);
  if (m->longest > 0) add_element(force, &s, q, v, &linear, stop, m->stop_damping, m->longest, 1);
  if (m->shortest > 0)
    add_element(force, &s, q, v, &linear, stop, m->stop_damping, m->shortest, -1);
}

static void add_hinge(long double *force, const strut_scene *scene, size_t i, long double *q,
                      const double *v) {
  const strut_hinge *h = &scene->hinges[i];
  slow_strain s = {.kind = SLOW_ANGLE, .count = 3, .near = strut_hinge_rest(scene, i)};
  for (int k = 0; k < 3; k++) s.node[k] = h->node[k];
  add_element(force, &s, q, v, &h->law, h->stiffness, h->damping, strut_hinge_rest(scene, i),
              sign_of(h->law.carries));
}

TEST(forces_by_definition) {
  for (uint64_t seed = 1; seed <= SCENES; seed++) {
    strut_setup setup;
    motion m;
    uint64_t r = seed;
    strut_setup_init(&setup);
    random_elements(&setup.scene, seed, 1.0);
    motion_begin(&m, &setup.scene, 1e-3);
    size_t n = 2 * setup.scene.node_count;
    long double q[2 * MOST], force[2 * MOST] = {0}, most = 0;
    assert_true(n <= 2 * MOST);
    for (size_t i = 0; i < n; i++) {
      bool held = setup.scene.nodes[i / 2].fixed[i % 2];
      m.state->q[i] += held ? 0 : random_between(&r, -0.1, 0.1);
      m.state->v[i] = held ? 0 : random_between(&r, -1, 1);
      q[i] = m.state->q[i];
    }
    for (size_t j = 0; j < setup.scene.member_count; j++)
      add_member(force, &setup.scene, j, q, m.state->v);
    for (size_t i = 0; i < setup.scene.hinge_count; i++)
      add_hinge(force, &setup.scene, i, q, m.state->v);
    strut_forces_evaluate(m.model, m.state, 0, m.state->q, m.state->v);
    for (size_t i = 0; i < n; i++) most = fmaxl(most, fabsl(force[i]));
    for (size_t i = 0; i < n; i++)
      assert_near(m.state->latest.force[i], (double)force[i], TOLERANCE * (double)most);
    motion_end(&m);
    strut_setup_free(&setup);
  }
}

/* ---- changes whose effect is known ---- */

static const double TURN = 0.7, LARGER = 3.0;

static void turn_pair(double *p) {
  double x = p[0], y = p[1];
  p[0] = cos(TURN) * x - sin(TURN) * y, p[1] = sin(TURN) * x + cos(TURN) * y;
}
static void mirror_pair(double *p) { p[0] = -p[0]; }
static void enlarge_pair(double *p) { p[0] *= LARGER, p[1] *= LARGER; }

static double *copied(strut_scene *scene, const double *numbers, size_t count) {
  double *copy = strut_arena_allocate(&scene->arena, count + 1, sizeof *copy);
  assert_non_null(copy);
  for (size_t i = 0; i < count && numbers; i++) copy[i] = numbers[i];
  return copy;
}

/* Sizes of strains times `by`, forces times `force`. */
static void scale_law(strut_scene *scene, strut_law *law, double by, double force) {
  double *x = copied(scene, law->x, law->count), *f = copied(scene, law->force, law->count);
  law->knee *= by, law->gap *= by, law->scale *= by;
  law->second_stiffness *= force / by;
  for (size_t i = 0; i < law->count && law->kind == STRUT_LAW_POLYNOMIAL; i++)
    f[i] *= force / pow(by, (double)i + 1);
  for (size_t i = 0; i < law->count && law->kind == STRUT_LAW_TABLE; i++) x[i] *= by, f[i] *= force;
  if (law->count) law->force = f;
  if (law->count && law->x) law->x = x;
}

static void enlarge(strut_scene *scene) {
  for (size_t j = 0; j < scene->member_count; j++) {
    strut_member *m = &scene->members[j];
    if (m->rest_kind == STRUT_REST_LENGTH) m->rest_value *= LARGER;
    m->longest *= LARGER, m->shortest *= LARGER;
    scale_law(scene, &m->law, LARGER, LARGER);
  }
  for (size_t i = 0; i < scene->hinge_count; i++) {
    strut_hinge *h = &scene->hinges[i];
    h->stiffness *= LARGER * LARGER, h->damping *= LARGER * LARGER;
    scale_law(scene, &h->law, 1, LARGER * LARGER);
  }
}

/* A mirror changes the sign of angles and moments. */
static void reflect(strut_scene *scene) {
  for (size_t i = 0; i < scene->hinge_count; i++) {
    strut_hinge *h = &scene->hinges[i];
    strut_law law = h->law;
    double *x = copied(scene, law.x, law.count), *f = copied(scene, law.force, law.count);
    h->rest_angle = -strut_hinge_rest(scene, i);
    if (law.carries != STRUT_CARRIES_BOTH)
      h->law.carries =
          law.carries == STRUT_CARRIES_TENSION ? STRUT_CARRIES_COMPRESSION : STRUT_CARRIES_TENSION;
    for (size_t k = 0; k < law.count && law.kind == STRUT_LAW_POLYNOMIAL; k++)
      f[k] = k % 2 ? -law.force[k] : law.force[k];
    for (size_t k = 0; k < law.count && law.kind == STRUT_LAW_TABLE; k++) {
      x[k] = -law.x[law.count - 1 - k];
      f[k] = -law.force[law.count - 1 - k];
    }
    if (law.count) h->law.force = f;
    if (law.count && law.x) h->law.x = x;
  }
}

static void keep(strut_scene *scene) { (void)scene; }

static void compare(void change(strut_scene *), void move(double *), const char *method) {
  for (uint64_t seed = 1; seed <= SCENES; seed++) {
    strut_setup one, other;
    motion a, b;
    strut_setup_init(&one), strut_setup_init(&other);
    random_elements(&one.scene, seed, 1.0), random_elements(&other.scene, seed, 1.0);
    for (size_t i = 0; i < one.scene.hinge_count; i++) /* has no mirror image */
      if (one.scene.hinges[i].law.kind == STRUT_LAW_EXPONENTIAL)
        one.scene.hinges[i].law.kind = other.scene.hinges[i].law.kind = STRUT_LAW_LINEAR;
    change(&other.scene); /* while it is drawn as the first */
    for (size_t i = 0; i < other.scene.node_count; i++) {
      uint64_t r = seed + i;
      for (int c = 0; c < 2 && i; c++) {
        double v = random_between(&r, -1, 1);
        one.scene.nodes[i].velocity[c] = other.scene.nodes[i].velocity[c] = v;
      }
      move(other.scene.nodes[i].position);
      move(other.scene.nodes[i].start);
      move(other.scene.nodes[i].velocity);
    }
    motion_begin_by(&a, &one, method, 1e-3);
    motion_begin_by(&b, &other, method, 1e-3);
    motion_steps(&a, 200);
    motion_steps(&b, 200);
    for (size_t i = 0; i < one.scene.node_count; i++) {
      move(a.state->q + 2 * i);
      for (size_t c = 0; c < 2; c++)
        assert_near(b.state->q[2 * i + c], a.state->q[2 * i + c], 1e-10);
    }
    motion_end(&a), motion_end(&b);
    strut_setup_free(&one), strut_setup_free(&other);
  }
}

TEST(changed_scenes) {
  static const char *const methods[] = {"rk4", "rk4-events"};
  for (int k = 0; k < 2; k++) {
    compare(keep, turn_pair, methods[k]);
    compare(reflect, mirror_pair, methods[k]);
    compare(enlarge, enlarge_pair, methods[k]);
  }
}
