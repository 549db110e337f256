/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Columns of the equilibrium matrix and stress forms of running cables and hinges, against
 * differences of their lengths and angles.
 */
#include "engine/base/vec.h"
#include "engine/statics/rigidity/rigidity.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

enum { NODES = 6 };

/* Two supports, four free nodes, bars, a cable that meets a node twice, two hinges. */
static strut_setup make(uint64_t *r) {
  strut_setup setup = build_setup();
  strut_scene *scene = &setup.scene;
  build_support(scene, -1, 0);
  build_support(scene, 1, 0);
  for (int i = 2; i < NODES; i++) {
    double y = random_between(r, -1, 1), x = random_between(r, -1, 1);
    build_node(scene, x, y);
  }
  for (int i = 2; i < NODES; i++) build_member(scene, STRUT_BAR, i % 2, i, 100, 0, 0);
  int32_t cable = build_member(scene, STRUT_CABLE, 0, 4, 100, 0, 0);
  build_guides(scene, cable, (const int32_t[]){2, 3, 2}, 3);
  for (int32_t i = 0; i < 2; i++) build_hinge(scene, i, 3 + i, 5 - i * 3, 1, 0);
  return setup;
}

/* What a column measures at positions q: a length, or an angle times the model's size. */
static double measure(const strut_model *model, int32_t column, const double *q) {
  const strut_scene *scene = model->scene;
  if (column >= model->members.count) {
    const int32_t *n = scene->hinges[column - model->members.count].node;
    double x = atan2(q[2 * n[2] + 1] - q[2 * n[1] + 1], q[2 * n[2]] - q[2 * n[1]]) -
               atan2(q[2 * n[0] + 1] - q[2 * n[1] + 1], q[2 * n[0]] - q[2 * n[1]]);
    double drawn = strut_hinge_rest(scene, (size_t)(column - model->members.count));
    return model->size * (drawn + remainder(x - drawn, STRUT_TAU));
  }
  const strut_member *m = &scene->members[column];
  double sum = 0;
  for (size_t k = 0; k <= m->guide_count; k++) {
    int32_t a = strut_member_node(m, k), b = strut_member_node(m, k + 1);
    sum += hypot(q[2 * b] - q[2 * a], q[2 * b + 1] - q[2 * a + 1]);
  }
  return sum;
}

/* The measure after a step along a motion of the free coordinates. */
static double moved(const strut_model *model, const strut_equilibrium_matrix *a, int32_t column,
                    const double *along, double far) {
  double q[2 * NODES];
  memcpy(q, model->start, sizeof q);
  for (int32_t r = 0; r < a->rows; r++) q[a->coordinate[r]] += far * along[r];
  return measure(model, column, q);
}

TEST(columns_and_forms_are_derivatives) {
  uint64_t r = 4;
  const double h = 1e-3;
  for (int round = 0; round < 20; round++) {
    OWN(strut_arena) arena = {0};
    strut_equilibrium_matrix a;
    OWN(strut_setup) setup = make(&r);
    OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
    assert_ok(strut_equilibrium_matrix_build(model, model->start, &arena, &a));
    assert_int_equal(a.columns, 7);
    double x[2 * NODES], change[8], density[8] = {0};
    for (int32_t i = 0; i < a.rows; i++) x[i] = random_between(&r, -1, 1);
    strut_equilibrium_elongate(&a, x, change);
    for (int32_t j = 0; j < a.columns; j++) {
      double value[5];
      for (int k = -2; k <= 2; k++) value[k + 2] = moved(model, &a, j, x, k * h);
      double first = (value[0] - 8 * value[1] + 8 * value[3] - value[4]) / (12 * h);
      double second =
          (-value[0] + 16 * value[1] - 30 * value[2] + 16 * value[3] - value[4]) / (12 * h * h);
      double arm = 1 + a.curvature[j] * a.curvature[j]; /* short arms bend much */
      assert_near(a.length[j], value[2], 1e-14);
      assert_near(change[j], first, 1e-8 * arm * arm);
      if (a.curved[j] < 0) continue;
      memset(density, 0, sizeof density);
      density[j] = strut_column_density(&a, j, 2.0);
      assert_near(strut_stress_form(model, &a, density, x, x), 2 * second, 1e-6 * arm * arm * arm);
    }
  }
}
