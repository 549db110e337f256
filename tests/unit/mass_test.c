/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mass matrix: how it is taken apart, and that its inverse is one whatever the masses. */
#include "engine/model/mass.h"
#include "tests/support/random.h"
#include "tests/support/structures.h"

/* `count` nodes in a row, joined by bars that weigh mass, mass ratio, mass ratio^2, ... in turn. */
static void build_row(strut_scene *scene, int32_t count, double mass, double ratio) {
  int32_t first = (int32_t)scene->node_count;
  double y = (double)first;
  for (int32_t i = 0; i < count; i++) build_node(scene, i, y);
  for (int32_t i = 1; i < count; i++)
    build_member(scene, STRUT_BAR, first + i - 1, first + i, 1, 0, i % 2 ? mass : mass * ratio);
}

TEST(sets_are_sorted_by_size) {
  OWN(strut_scene) scene = build_scene();
  build_mass(&scene, 0, -1, 3);
  for (int32_t size = 2; size <= 10; size++) build_row(&scene, size, 1, 1);
  OWN_POINTER(strut_model) model = motion_compile(&scene);
  const strut_mass *mass = model->mass;
  const strut_mass_operator *op = &mass->coordinate[0];
  assert_true(mass->shared && !mass->diagonal);
  assert_int_equal(op->block_count, 7); /* 2 to 8 */
  for (int32_t b = 0; b < 7; b++) assert_int_equal(op->block_size[b], b + 2);
  assert_int_equal(mass->dense_entries, 4 + 9 + 16 + 25 + 36 + 49 + 64);
  assert_non_null(op->factor);
  assert_int_equal(op->factor->n, 9 + 10);
  assert_int_equal(mass->matrix_nonzeros, 55 + 45); /* nodes + bars */
  assert_int_equal(mass->factor_nonzeros, 19 + 17); /* rows fill nothing in */
  assert_true(mass->inverse[0] == 1.0 / 3 && mass->inverse[1] == 1.0 / 3);
  for (size_t i = 2; i < 2 * scene.node_count; i++) assert_true(mass->inverse[i] == 0);
}

/* A support cuts a row in two: 11 nodes become 5 and 5, in one coordinate or in both. */
TEST(supports_cut_sets) {
  for (int both = 0; both < 2; both++) {
    OWN(strut_scene) scene = build_scene();
    build_row(&scene, 11, 1, 1);
    scene.nodes[5].fixed[1] = true, scene.nodes[5].fixed[0] = both;
    OWN_POINTER(strut_model) model = motion_compile(&scene);
    const strut_mass *mass = model->mass;
    assert_all_equal(mass->shared, both, mass->coordinate[1].block_count, 2);
    assert_null(mass->coordinate[1].factor);
    assert_int_equal(mass->coordinate[0].block_count, both ? 2 : 0);
    assert_int_equal(mass->coordinate[0].factor != NULL, !both);
  }
}

TEST(a_node_without_mass_is_for_statics_only) {
  OWN(strut_scene) scene = build_scene();
  build_row(&scene, 3, 1, 1);
  int32_t light = build_node(&scene, 0, 1);
  build_member(&scene, STRUT_SPRING, 0, light, 1, 0, 0);
  strut_model *model = motion_compile(&scene);
  assert_null(model->mass);
  strut_model_free(model);
  scene.nodes[light].fixed[0] = true; /* still free in y */
  model = motion_compile(&scene);
  assert_null(model->mass);
  strut_model_free(model);
  scene.nodes[light].fixed[1] = true;
  model = motion_compile(&scene);
  assert_non_null(model->mass);
  strut_model_free(model);
}

/* M (M^-1 f) is f, to rounding in what the rows add up. */
static void check_inverse(const strut_scene *scene) {
  OWN_POINTER(strut_model) model = motion_compile(scene);
  size_t n = (size_t)model->length;
  double *f = calloc(4 * n, sizeof *f), *a = f + n, *work = f + 2 * n, *sums = f + 3 * n;
  uint64_t r = 9;
  assert_non_null(f);
  for (size_t i = 0; i < 2 * scene->node_count; i++) f[i] = random_between(&r, -1, 1);
  strut_mass_solve(model, f, a, work);
  for (size_t c = 0; c < 2; c++) {
    const strut_mass_operator *op = &model->mass->coordinate[c];
    const strut_sparse *m = op->matrix;
    for (size_t i = 0; i < n; i++) work[i] = sums[i] = 0;
    for (int32_t j = 0; j < m->n; j++)
      for (int32_t k = m->start[j]; k < m->start[j + 1]; k++) {
        size_t row = 2 * (size_t)op->matrix_node[m->row[k]] + c;
        size_t column = 2 * (size_t)op->matrix_node[j] + c;
        work[row] += m->value[k] * a[column], sums[row] += fabs(m->value[k] * a[column]);
        if (row == column) continue;
        work[column] += m->value[k] * a[row], sums[column] += fabs(m->value[k] * a[row]);
      }
    for (int32_t j = 0; j < m->n; j++) {
      size_t at = 2 * (size_t)op->matrix_node[j] + c;
      assert_near(work[at], f[at], 1e-14 * (sums[at] + fabs(f[at])));
    }
  }
  free(f);
}

TEST(the_inverse_is_one_at_any_mass_ratio) {
  static const double ratios[] = {1, 1e-3, 1e9, 1e-9};
  static const int32_t sizes[] = {2, 5, 8, 9, 100, 10000};
  for (int k = 0; k < 4; k++)
    for (int s = 0; s < 6; s++) {
      OWN(strut_scene) scene = build_scene();
      build_row(&scene, sizes[s], 0.3, ratios[k]);
      if (s % 2) scene.nodes[1].fixed[0] = true;
      check_inverse(&scene);
    }
}

/* Cables have a mass, too; of 1e5 nodes some are a billion times lighter than others. */
TEST(the_inverse_of_a_meshed_structure) {
  uint64_t r = 5;
  for (int large = 0; large < 2; large++) {
    OWN(strut_scene) scene = build_scene();
    structure_chain(&scene, large ? 50000 : 500, STRUT_MASS_CONSISTENT);
    for (size_t j = 0; j < scene.member_count; j++)
      scene.members[j].mass = large ? random_scale(&r, 1e-9, 1) : 0.1;
    check_inverse(&scene);
  }
}
