/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Natural frequencies and stability limits: mass matrix and tangent stiffness against closed forms. */
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_sort_vector.h>
#include <math.h>

#include "engine/forces/tangent.h"
#include "engine/model/mass.h"
#include "tests/support/build.h"
#include "tests/support/check.h"
#include "tests/support/motion.h"
#include "tests/support/structures.h"

static const double PI = 3.14159265358979323846;

/* Both matrices on the free coordinates, full; the tangent's order. */
static void fill_matrices(const strut_model *model, const strut_tangent *tangent, gsl_matrix *k,
                          gsl_matrix *m) {
  int32_t row_of[200];
  for (int32_t i = 0; i < tangent->n; i++) row_of[tangent->coordinate[i]] = i;
  const strut_sparse *s = tangent->stiffness;
  for (int32_t j = 0; j < s->n; j++)
    for (int32_t at = s->start[j]; at < s->start[j + 1]; at++) {
      gsl_matrix_set(k, (size_t)s->row[at], (size_t)j, s->value[at]);
      gsl_matrix_set(k, (size_t)j, (size_t)s->row[at], s->value[at]);
    }
  for (int32_t c = 0; c < 2; c++) {
    const strut_mass_operator *op = &model->mass->coordinate[c];
    for (int32_t j = 0; j < op->matrix->n; j++)
      for (int32_t at = op->matrix->start[j]; at < op->matrix->start[j + 1]; at++) {
        size_t a = (size_t)row_of[2 * op->matrix_node[j] + c];
        size_t b = (size_t)row_of[2 * op->matrix_node[op->matrix->row[at]] + c];
        gsl_matrix_set(m, a, b, op->matrix->value[at]);
        gsl_matrix_set(m, b, a, op->matrix->value[at]);
      }
  }
}

/* Squares of the angular frequencies at the start, ascending; their number. */
static size_t squared_frequencies(const strut_scene *scene, double *out) {
  strut_arena arena = {0};
  strut_tangent tangent;
  strut_model *model = motion_compile(scene);
  assert_int_equal(strut_tangent_assemble(model, model->start, model->members.rest,
                                          STRUT_CLOSED_NONE, &arena, &tangent),
                   STRUT_OK);
  size_t n = (size_t)tangent.n;
  assert_true(n <= 200);
  gsl_matrix *k = gsl_matrix_calloc(n, n), *m = gsl_matrix_calloc(n, n);
  gsl_vector *values = gsl_vector_alloc(n);
  gsl_eigen_gensymm_workspace *work = gsl_eigen_gensymm_alloc(n);
  fill_matrices(model, &tangent, k, m);
  assert_int_equal(gsl_eigen_gensymm(k, m, values, work), 0);
  gsl_sort_vector(values);
  for (size_t i = 0; i < n; i++) out[i] = gsl_vector_get(values, i);
  gsl_eigen_gensymm_free(work);
  gsl_vector_free(values);
  gsl_matrix_free(m);
  gsl_matrix_free(k);
  strut_model_free(model);
  strut_arena_free(&arena);
  return n;
}

static const x_frame FRAME = {.side = 0.3,
                              .cable_stiffness = 1000,
                              .bar_stiffness = 5e4,
                              .force_density = 120,
                              .cable_mass = 0.02,
                              .bar_mass = 0.3};

/* Three rigid motions, then the five others, ascending. */
static void check_frame(strut_mass_model mass_model, const double expected[5]) {
  strut_scene scene;
  double square[200];
  strut_scene_init(&scene);
  scene.mass_model = mass_model;
  structure_x_frame(&scene, &FRAME);
  assert_int_equal(squared_frequencies(&scene, square), 8);
  for (int i = 0; i < 3; i++) assert_near(square[i], 0, 1e-12 * square[7]);
  for (int i = 0; i < 5; i++) assert_relative(square[3 + i], expected[i], 1e-10);
  strut_scene_free(&scene);
}

TEST(x_frame_with_consistent_masses) {
  double kc = 1000, kb = 5e4, q = 120, mc = 0.02, mb = 0.3;
  double pair = 8 * (kc + q) / (4 * mc / 3 + 2 * mb);
  double opposed = 8 * (kb + q) / (8 * mc / 3 + 2 * mb / 3);
  check_frame(STRUT_MASS_CONSISTENT,
              (double[]){pair, pair, 16 * (kc - q) / (16 * mc / 3 + 4 * mb / 3), opposed,
                         8 * (kc + kb) / (8 * mc / 3 + 2 * mb / 3)});
  assert_relative(opposed, 1582736.8421, 1e-10);
}

TEST(x_frame_with_lumped_masses) {
  double kc = 1000, kb = 5e4, q = 120, node = 0.02 + 0.3 / 2;
  double pair = 2 * (kc + q) / node;
  check_frame(STRUT_MASS_LUMPED, (double[]){2 * (kc - q) / node, pair, pair, 2 * (kb + q) / node,
                                            2 * (kc + kb) / node});
}

/* 20 bars in a row that can only move along it. */
static void check_chain(strut_mass_model mass_model) {
  enum { N = 20 };
  const double k = 700, m = 0.03;
  strut_scene scene;
  double square[200];
  strut_scene_init(&scene);
  scene.mass_model = mass_model;
  for (int i = 0; i <= N; i++) build_node(&scene, 0.1 * i, 0);
  for (int i = 0; i <= N; i++) scene.nodes[i].fixed[1] = true;
  scene.nodes[0].fixed[0] = scene.nodes[N].fixed[0] = true;
  for (int i = 0; i < N; i++) build_member(&scene, STRUT_BAR, i, i + 1, k, 0, m);
  assert_int_equal(squared_frequencies(&scene, square), N - 1);
  for (int j = 1; j < N; j++) {
    double c = cos(j * PI / N);
    double expected =
        mass_model == STRUT_MASS_LUMPED ? 2 * k / m * (1 - c) : 6 * k / m * (1 - c) / (2 + c);
    assert_relative(square[j - 1], expected, 1e-10);
  }
  strut_scene_free(&scene);
}

TEST(chain_of_twenty_bars) {
  check_chain(STRUT_MASS_CONSISTENT);
  check_chain(STRUT_MASS_LUMPED);
}

/* Von Mises truss: half span 5, height 1, EA 1280e6; the apex starts at height y. */
static const double HALF_SPAN = 5, RISE = 1, EA = 1280e6;

static void von_mises(strut_scene *scene, double y) {
  strut_scene_init(scene);
  int32_t left = build_support(scene, -HALF_SPAN, 0), right = build_support(scene, HALF_SPAN, 0);
  int32_t apex = build_mass(scene, 0, RISE, 1000);
  scene->nodes[apex].start[1] = y;
  for (int i = 0; i < 2; i++) {
    int32_t j = build_member(scene, STRUT_BAR, i ? right : left, apex, 0, 0, 0);
    scene->members[j].axial_stiffness = EA;
  }
}

/* Vertical tangent stiffness and net force of the apex at height y. */
static void apex_response(double y, double *stiffness, double *force) {
  strut_scene scene;
  strut_arena arena = {0};
  strut_tangent tangent;
  motion m;
  von_mises(&scene, y);
  motion_begin(&m, &scene, 1e-4);
  assert_int_equal(strut_tangent_assemble(m.model, m.state->q, m.state->latest.rest,
                                          STRUT_CLOSED_NONE, &arena, &tangent),
                   STRUT_OK);
  assert_int_equal(tangent.n, 2);
  const strut_sparse *k = tangent.stiffness;
  *stiffness = k->value[k->start[2] - 1]; /* lower right */
  strut_forces_evaluate(m.model, m.state, 0, m.state->q, m.state->v);
  *force = m.state->latest.force[5];
  motion_end(&m);
  strut_arena_free(&arena);
  strut_scene_free(&scene);
}

TEST(von_mises_truss_snaps_at_its_limit_point) {
  double l0 = hypot(HALF_SPAN, RISE), l = cbrt(l0 * HALF_SPAN * HALF_SPAN);
  double y = sqrt(l * l - HALF_SPAN * HALF_SPAN), k = EA / l0, top, at_limit, force;
  apex_response(RISE, &top, &force);
  assert_relative(top, 2 * k / (l0 * l0), 1e-12); /* 2 k sin^2 */
  assert_near(force, 0, 1e-6);
  apex_response(y, &at_limit, &force);
  assert_near(at_limit, 0, 1e-10 * top);
  assert_relative(force, 2 * k * (l0 - l) * y / l, 1e-10);
  assert_relative(force, 3789.46e3, 2e-6);
  assert_near(RISE - y, 0.42643, 1e-5);
  apex_response(y + 1e-3, &at_limit, &force);
  assert_true(at_limit > 0);
  apex_response(y - 1e-3, &at_limit, &force);
  assert_true(at_limit < 0);
}

/* A load that comes at once snaps the truss below the static limit; the energy says where. */
static double lowest_apex(double load) {
  strut_scene scene;
  motion m;
  double lowest = RISE;
  von_mises(&scene, RISE);
  build_load(&scene, 2, 0, -load, -1);
  motion_begin(&m, &scene, 1e-4);
  for (int i = 0; i < 3000; i++) {
    motion_steps(&m, 1);
    lowest = fmin(lowest, m.state->q[5]);
  }
  assert_true(m.state->q[4] == 0);
  motion_end(&m);
  strut_scene_free(&scene);
  return lowest;
}

TEST(von_mises_truss_under_a_sudden_load) {
  double l0 = hypot(HALF_SPAN, RISE), k = EA / l0, threshold = 0;
  for (double y = 0; y < 0.9; y += 1e-5) {
    double shorter = l0 - hypot(HALF_SPAN, y);
    threshold = fmax(threshold, k * shorter * shorter / (RISE - y));
  }
  assert_relative(threshold, 2910.77e3, 2e-6);
  assert_true(lowest_apex(0.999 * threshold) > 0);
  assert_true(lowest_apex(1.001 * threshold) < -RISE);
}
