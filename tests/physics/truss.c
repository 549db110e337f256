/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/physics/truss.h"

#include <math.h>
#include <stdlib.h>

#include "tests/support/build.h"
#include "tests/support/check.h"

void truss_nodes(strut_scene *scene, const double (*position)[2], size_t count) {
  for (size_t i = 0; i < count; i++) build_mass(scene, position[i][0], position[i][1], 1.0);
}

void truss_ring(strut_scene *scene, int count) {
  for (int i = 0; i < count; i++) {
    double angle = 2.0 * acos(-1.0) * i / count;
    build_mass(scene, cos(angle), sin(angle), 1.0);
  }
}

void truss_members(strut_scene *scene, strut_member_kind kind, const char *pairs) {
  for (const char *at = pairs; *at;) {
    char *end;
    long from = strtol(at, &end, 10), to = strtol(end + 1, &end, 10);
    build_member(scene, kind, (int32_t)from - 1, (int32_t)to - 1, 1.0, 0.0, 0.0);
    for (at = end; *at == ' '; at++) continue;
  }
}

void truss_hold(strut_scene *scene, int number, bool x, bool y) {
  scene->nodes[number - 1].fixed[0] = x;
  scene->nodes[number - 1].fixed[1] = y;
}

void truss_look(truss *t, strut_scene *scene) {
  strut_error error = {0};
  t->scene = scene;
  assert_int_equal(strut_model_compile(scene, &t->model, &error), STRUT_OK);
  assert_int_equal(strut_rigidity_find(t->model, t->model->start, &t->found, &error), STRUT_OK);
}

void truss_free(truss *t) {
  strut_rigidity_free(&t->found);
  strut_model_free(t->model);
  strut_scene_free(t->scene);
}

/* Every state must hold without loads, every mechanism stretch nothing. */
static void check_bases(const truss *t) {
  const strut_equilibrium_matrix *a = &t->found.matrix;
  double *sum = calloc((size_t)a->rows + 1, sizeof *sum);
  double *strain = calloc((size_t)a->columns + 1, sizeof *strain);
  assert_non_null(sum);
  assert_non_null(strain);
  for (int32_t i = 0; i < t->found.states.count && t->found.states.force; i++) {
    strut_equilibrium_multiply(a, t->found.states.force + i * a->columns, sum);
    for (int32_t k = 0; k < a->rows; k++) assert_near(sum[k], 0.0, 1e-11);
  }
  for (int32_t i = 0; i < t->found.mechanisms.count && t->found.mechanisms.list; i++) {
    strut_equilibrium_elongate(a, t->found.mechanisms.list[i].motion, strain);
    for (int32_t k = 0; k < a->columns; k++) assert_near(strain[k], 0.0, 1e-12);
  }
  free(sum);
  free(strain);
}

void truss_expect(const truss *t, int32_t rank, int32_t s, int32_t f) {
  assert_int_equal(t->found.spaces.rank, rank);
  assert_int_equal(t->found.states.count, s);
  assert_int_equal(t->found.mechanisms.count, f);
  assert_int_equal(t->found.matrix.columns - t->found.matrix.rows, s - f);
  check_bases(t);
}

void truss_expect_kinds(const truss *t, int32_t rigid, int32_t infinitesimal, int32_t finite) {
  const strut_mechanisms *m = &t->found.mechanisms;
  assert_int_equal(m->rigid_body, rigid);
  assert_int_equal(m->infinitesimal, infinitesimal);
  assert_int_equal(m->finite, finite);
  assert_int_equal(m->undecided, 0);
}

void truss_expect_densities(const truss *t, const double *density, double tolerance) {
  assert_int_equal(t->found.states.count, 1);
  const double *force = t->found.states.force, *length = t->found.matrix.length;
  double factor = force[0] / length[0] / density[0];
  for (int32_t j = 0; j < t->found.matrix.columns; j++)
    assert_near(force[j] / length[j], factor * density[j], tolerance * fabs(factor));
}
