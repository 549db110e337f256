/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Equilibria of structures with hinges, running cables, other laws and stops, against brute force:
 * an energy written once more here, and descents from thousands of random shapes by GSL.
 */
#include <gsl/gsl_multimin.h>

#include "engine/base/vec.h"
#include "engine/statics/search/critical.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

FREED_BY(gsl_vector_free, gsl_vector)

enum {
  ANCHORS = 3,
  FREE = 3,
  NODES = ANCHORS + FREE,
  UNKNOWNS = 2 * FREE,
  BRUTE = 1500,
  MOST = 400
};

static const double STOP = 60.0, NEAR = 1e-4;

typedef struct structure {
  strut_setup setup;
  double rest[16]; /* of members */
} structure;

static int32_t add_spring(structure *s, uint64_t *r, int32_t a, int32_t b) {
  double rest = random_between(r, 0.7, 1.7);
  return build_sized(&s->setup.scene, STRUT_SPRING, a, b, random_between(r, 5, 20), 0, 0, rest);
}

/* A node in or on the unit square about the middle. */
static void add_nodes(structure *s, uint64_t *r) {
  for (int i = 0; i < ANCHORS; i++) {
    double turn = STRUT_TAU * (i + random_between(r, -0.2, 0.2)) / ANCHORS;
    build_support(&s->setup.scene, cos(turn), sin(turn));
  }
  for (int i = 0; i < FREE; i++) {
    double y = random_between(r, -0.7, 0.7), x = random_between(r, -0.7, 0.7);
    build_node(&s->setup.scene, x, y);
  }
}

static void add_hinge(strut_scene *scene, uint64_t *r, int32_t a, int32_t b, int32_t c) {
  int32_t h = build_hinge(scene, a, b, c, random_between(r, 0.1, 1.0), 0);
  scene->hinges[h].rest_angle = random_between(r, -STRUT_TAU / 2, STRUT_TAU / 2);
}

/* Springs that hold every free node, a running cable, two hinges, stops and a hardening spring. */
static void make(structure *s, uint64_t seed) {
  uint64_t r = seed;
  strut_setup_init(&s->setup);
  strut_scene *scene = &s->setup.scene;
  add_nodes(s, &r);
  for (int32_t i = 0; i < FREE; i++) {
    add_spring(s, &r, i % ANCHORS, ANCHORS + i);
    add_spring(s, &r, ANCHORS + i, ANCHORS + (i + 1) % FREE);
  }
  strut_member *stopped = &scene->members[add_spring(s, &r, 1, ANCHORS)];
  stopped->shortest = 0.5, stopped->longest = 0.9, stopped->stop_stiffness = STOP;
  strut_member *hard = &scene->members[add_spring(s, &r, 2, ANCHORS + 1)];
  const double cubic[] = {random_between(&r, -3, 5), 0, random_between(&r, 10, 40)};
  hard->law.kind = STRUT_LAW_POLYNOMIAL;
  hard->law.count = 3, hard->law.force = build_numbers(scene, cubic, 3);
  hard->stiffness = 0;
  double rest = random_between(&r, 1.5, 3), stiffness = random_between(&r, 5, 20);
  int32_t cable = build_sized(scene, STRUT_CABLE, 0, 2, stiffness, 0, 0, rest);
  build_guides(scene, cable, (const int32_t[]){ANCHORS + 1, ANCHORS + 2}, 2);
  add_hinge(scene, &r, 0, ANCHORS, ANCHORS + 1);
  add_hinge(scene, &r, ANCHORS, ANCHORS + 1, ANCHORS + 2);
  for (size_t j = 0; j < scene->member_count; j++) s->rest[j] = scene->members[j].rest_value;
}

/* ---- the energy once more, straight from the scene, with derivatives by differences ---- */

typedef struct brute {
  const structure *s;
  double q[2 * NODES];
} brute;

static double distance(const double *q, int32_t a, int32_t b) {
  return hypot(q[2 * b] - q[2 * a], q[2 * b + 1] - q[2 * a + 1]);
}

static double member_energy(const structure *s, size_t j, const double *q) {
  const strut_member *m = &s->setup.scene.members[j];
  double length = 0;
  for (size_t k = 0; k <= m->guide_count; k++)
    length += distance(q, strut_member_node(m, k), strut_member_node(m, k + 1));
  double x = length - s->rest[j], sum = 0;
  if (m->law.kind == STRUT_LAW_POLYNOMIAL)
    sum = m->law.force[0] * x * x / 2 + m->law.force[2] * x * x * x * x / 4;
  else if (m->kind != STRUT_CABLE || x > 0)
    sum = m->stiffness * x * x / 2;
  if (length < m->shortest) sum += STOP * (m->shortest - length) * (m->shortest - length) / 2;
  if (m->longest > 0 && length > m->longest)
    sum += STOP * (length - m->longest) * (length - m->longest) / 2;
  return sum;
}

static double hinge_energy(const strut_hinge *h, const double *q) {
  const double *a = q + 2 * h->node[0], *b = q + 2 * h->node[1], *c = q + 2 * h->node[2];
  double x = atan2(c[1] - b[1], c[0] - b[0]) - atan2(a[1] - b[1], a[0] - b[0]) - h->rest_angle;
  x = remainder(x, STRUT_TAU);
  return h->stiffness * x * x / 2;
}

static double energy_at(const structure *s, const double *q) {
  double sum = 0;
  for (size_t j = 0; j < s->setup.scene.member_count; j++) sum += member_energy(s, j, q);
  for (size_t i = 0; i < s->setup.scene.hinge_count; i++)
    sum += hinge_energy(&s->setup.scene.hinges[i], q);
  return sum;
}

static double energy(const gsl_vector *x, void *context) {
  brute *b = context;
  for (size_t i = 0; i < UNKNOWNS; i++) b->q[2 * ANCHORS + i] = gsl_vector_get(x, i);
  return energy_at(b->s, b->q);
}

static void gradient(const gsl_vector *x, void *context, gsl_vector *g) {
  brute *b = context;
  const double h = 1e-4;
  energy(x, b);
  for (size_t i = 0; i < UNKNOWNS; i++) {
    double *at = &b->q[2 * ANCHORS + i], here = *at, e[4];
    const double far[4] = {-2 * h, -h, h, 2 * h};
    for (int k = 0; k < 4; k++) *at = here + far[k], e[k] = energy_at(b->s, b->q);
    *at = here;
    gsl_vector_set(g, i, (e[0] - 8 * e[1] + 8 * e[2] - e[3]) / (12 * h));
  }
}

/* The largest slope of the energy along a free coordinate. */
static double slope_at(brute *b, const gsl_vector *x, gsl_vector *g) {
  gradient(x, b, g);
  return fmax(gsl_vector_max(g), -gsl_vector_min(g));
}

static void both(const gsl_vector *x, void *context, double *f, gsl_vector *g) {
  *f = energy(x, context);
  gradient(x, context, g);
}

/* Down to a minimum, away from cusps: pushed aside a little it comes back to the same energy. */
static bool descend(brute *b, gsl_multimin_fdfminimizer *m, gsl_vector *x) {
  gsl_multimin_function_fdf f = {energy, gradient, both, UNKNOWNS, b};
  for (int again = 0; again < 4; again++) {
    gsl_multimin_fdfminimizer_set(m, &f, x, 0.02, 0.1);
    for (int k = 0; k < 300 && gsl_multimin_fdfminimizer_iterate(m) == GSL_SUCCESS; k++)
      if (gsl_multimin_test_gradient(m->gradient, 1e-8) == GSL_SUCCESS) break;
    gsl_vector_memcpy(x, m->x);
  }
  return slope_at(b, x, m->gradient) < 1e-5;
}

typedef struct minima {
  size_t count;
  double at[MOST][UNKNOWNS];
  int hits[MOST];
} minima;

static double apart(const double *a, const double *b) {
  double most = 0;
  for (size_t i = 0; i < UNKNOWNS; i++) most = fmax(most, fabs(a[i] - b[i]));
  return most;
}

static void remember(minima *found, const double *x) {
  for (size_t i = 0; i < found->count; i++)
    if (apart(found->at[i], x) < NEAR) {
      found->hits[i]++;
      return;
    }
  assert_true(found->count < MOST);
  memcpy(found->at[found->count], x, sizeof found->at[0]);
  found->hits[found->count++] = 1;
}

/* Is it a minimum? A point 1e-3 away in every one of many directions lies higher. */
static bool is_lowest(brute *b, const double *x, uint64_t *r) {
  double q[2 * NODES];
  memcpy(q, b->q, sizeof q);
  memcpy(q + 2 * ANCHORS, x, UNKNOWNS * sizeof *x);
  double here = energy_at(b->s, q);
  for (int k = 0; k < 200; k++) {
    for (size_t i = 0; i < UNKNOWNS; i++)
      q[2 * ANCHORS + i] = x[i] + random_between(r, -1e-3, 1e-3);
    if (energy_at(b->s, q) < here - 1e-12) return false;
  }
  return true;
}

static void search_brutely(brute *b, minima *found) {
  uint64_t r = 77;
  OWN_POINTER(gsl_vector) x = gsl_vector_alloc(UNKNOWNS);
  gsl_multimin_fdfminimizer *m =
      gsl_multimin_fdfminimizer_alloc(gsl_multimin_fdfminimizer_vector_bfgs2, UNKNOWNS);
  for (int k = 0; k < BRUTE; k++) {
    for (size_t i = 0; i < UNKNOWNS; i++) gsl_vector_set(x, i, random_between(&r, -2, 2));
    if (descend(b, m, x) && is_lowest(b, x->data, &r)) remember(found, x->data);
  }
  gsl_multimin_fdfminimizer_free(m);
}

/* Every minimum that brute force met is among those of the search, and each of those is one. */
static void check_structure(uint64_t seed) {
  structure s;
  strut_critical_set set;
  OWN(strut_arena) arena = {0};
  strut_potential *potential;
  static minima known;
  make(&s, seed);
  OWN_POINTER(strut_model) model = motion_compile(&s.setup.scene);
  assert_ok(strut_potential_create(model, NULL, false, &arena, &potential, NULL));
  strut_critical_effort effort = {.seed = 1, .saddles = true};
  assert_ok(strut_critical_search(potential, &effort, &set, NULL));
  brute b = {.s = &s};
  memcpy(b.q, model->start, sizeof b.q);
  known = (minima){0};
  search_brutely(&b, &known);
  OWN_POINTER(gsl_vector) slopes = gsl_vector_alloc(UNKNOWNS);
  size_t stable = 0;
  for (size_t i = 0; i < set.count; i++) {
    const strut_critical_point *p = &set.points[i];
    assert_near(p->potential, energy_at(&s, p->q), 1e-12 * (1 + p->potential));
    gsl_vector_const_view x = gsl_vector_const_view_array(p->q + 2 * ANCHORS, UNKNOWNS);
    assert_within(slope_at(&b, &x.vector, slopes), 0, 1e-2);
    stable += p->label == STRUT_STABLE;
  }
  for (size_t k = 0; k < known.count; k++) {
    double nearest = HUGE_VAL;
    for (size_t i = 0; i < set.count; i++)
      if (set.points[i].label == STRUT_STABLE)
        nearest = fmin(nearest, apart(set.points[i].q + 2 * ANCHORS, known.at[k]));
    if (!(nearest < NEAR))
      print_error("seed %d: a minimum met %d times was missed\n", (int)seed, known.hits[k]);
    assert_true(nearest < NEAR);
  }
  assert_true(stable >= known.count);
  strut_critical_free(&set);
  strut_setup_free(&s.setup);
}

/* Where a running cable pulls a hinge's arm to nothing there is no angle, and no equilibrium. */
BEFORE_ALL { gsl_set_error_handler_off(); }

TEST(a_hinge_without_an_arm_is_at_rest_nowhere) { check_structure(10); }

TEST(all_stable_shapes_are_found) {
  for (uint64_t seed = 1; seed <= 5; seed++) check_structure(seed);
}
