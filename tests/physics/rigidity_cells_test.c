/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rank, self-stress and mechanisms of larger structures, and of both ways to compute them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/statics/rigidity/rigidity_parts.h"
#include "tests/physics/truss.h"
#include "tests/support/build.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

static const double PI = 3.14159265358979323846;

TEST(bistable_chain) {
  static const double at[][2] = {{-1, 2}, {1, 2}, {0, 2.3}, {-1, 4}, {1, 4}, {0, 4.3}};
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_nodes(&scene, at, 6);
  truss_members(&scene, STRUT_BAR, "1-3 2-3 4-6 5-6");
  truss_members(&scene, STRUT_SPRING, "3-6");
  for (int i = 1; i <= 6; i++) truss_hold(&scene, i, true, i % 3 != 0);
  truss_look(&t, &scene);
  truss_expect(&t, 2, 3, 0);
  assert_near(t.found.spaces.kept, 0.406371, 1e-6);
  truss_free(&t);
}

TEST(zeeman) {
  static const double at[][2] = {{1, 0}, {0.975983, 0.499423}, {2, 0.25}, {0, 0}};
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_nodes(&scene, at, 4);
  truss_members(&scene, STRUT_BAR, "1-2");
  truss_members(&scene, STRUT_CABLE, "2-3 2-4");
  truss_hold(&scene, 1, true, true);
  truss_hold(&scene, 3, true, true);
  truss_hold(&scene, 4, true, true);
  truss_look(&t, &scene);
  truss_expect(&t, 2, 1, 0);
  assert_true(t.found.states.cables_pull[0]);
  truss_free(&t);
}

/* The anti-parallelogram: its bars alone move, and the walk along the motion shows it. */
TEST(x_joint) {
  double s = sqrt(0.01 - 0.0025);
  const double at[][2] = {{0, 0}, {0.05, 0}, {0.05, s}, {0, s}};
  strut_scene scene;
  truss t;
  for (int cables = 0; cables < 2; cables++) {
    strut_scene_init(&scene);
    truss_nodes(&scene, at, 4);
    truss_members(&scene, STRUT_BAR, "1-3 2-4 4-3");
    if (cables) truss_members(&scene, STRUT_CABLE, "1-4 2-3");
    truss_hold(&scene, 1, true, true);
    truss_hold(&scene, 2, true, true);
    truss_look(&t, &scene);
    if (cables) {
      truss_expect(&t, 4, 1, 0);
      assert_near(t.found.spaces.kept, 0.366025, 1e-6);
    } else {
      truss_expect(&t, 3, 0, 1);
      truss_expect_kinds(&t, 0, 0, 1);
      assert_within(t.found.mechanisms.list[0].strain, 0.0, 1e-12);
    }
    truss_free(&t);
  }
}

TEST(dual_triangle) {
  double c = cos(PI / 6), s = 0.5;
  const double at[][2] = {{0, 0}, {-c, s}, {-c, -s}, {c, s}, {c, -s}};
  strut_scene scene;
  truss t;
  strut_scene_init(&scene);
  truss_nodes(&scene, at, 5);
  truss_members(&scene, STRUT_BAR, "1-4 1-5 4-5");
  truss_members(&scene, STRUT_SPRING, "2-4 3-5");
  for (int i = 1; i <= 3; i++) truss_hold(&scene, i, true, true);
  truss_look(&t, &scene);
  truss_expect(&t, 4, 1, 0);
  assert_near(t.found.spaces.kept, 0.366025, 1e-6);
  truss_free(&t);
}

static void arm(strut_scene *scene) {
  static const double at[16][2] = {{0, 0},  {0, -1}, {1, -1}, {2, -1}, {2, 0}, {3, -1},
                                   {4, -1}, {4, 0},  {5, -1}, {6, 0},  {5, 1}, {4, 1},
                                   {3, 1},  {2, 1},  {1, 1},  {0, 1}};
  strut_scene_init(scene);
  for (int i = 0; i < 16; i++) build_mass(scene, at[i][0] * sqrt(0.5), at[i][1] * sqrt(0.5), 1.0);
  truss_members(scene, STRUT_BAR,
                "1-3 3-5 5-4 5-6 6-8 8-7 8-9 9-10 10-11 11-8 8-12 8-13 13-5 5-14 5-15 15-1");
  truss_members(scene, STRUT_CABLE,
                "1-2 2-3 3-4 4-6 6-7 7-9 11-12 12-13 13-14 14-15 15-16 16-1 1-5 5-8 8-10 9-11 "
                "6-13 3-15");
}

/* Two of its eight states are a cable each between fixed nodes; some prestress pulls all cables. */
TEST(arm) {
  strut_scene scene;
  truss t;
  int alone = 0;
  arm(&scene);
  for (int i = 1; i <= 16; i += i == 1 ? 1 : 14) truss_hold(&scene, i, true, true);
  truss_look(&t, &scene);
  truss_expect(&t, 26, 8, 0);
  assert_near(t.found.spaces.kept, 0.0761022, 1e-7);
  assert_true(t.found.cables_can_pull);
  for (int j = 16; j < 34; j++) assert_true(t.found.feasible[j] > 0);
  for (int i = 0; i < 8; i++) {
    int used = 0;
    for (int j = 0; j < 34; j++) used += t.found.states.force[34 * i + j] != 0.0;
    alone += used == 1;
  }
  assert_int_equal(alone, 2);
  assert_int_equal(t.found.bars_at_node, 6);
  truss_free(&t);
  arm(&scene);
  truss_look(&t, &scene);
  truss_expect(&t, 29, 5, 3);
  truss_expect_kinds(&t, 3, 0, 0);
  truss_free(&t);
}

/* The number of node (i, k) of a wheel of n sides; the first nodes come before it. */
static int joint(int first, int n, int i, int k) { return first + k * n + ((i % n) + n) % n; }

static void add_pair(strut_scene *scene, int from, int to) {
  build_member(scene, STRUT_BAR, from - 1, to - 1, 1.0, 0.0, 0.0);
}

/* parts: 1 spirals, 2 rim, ring, hub and spokes too, 3 radials too. */
static void wheel(strut_scene *scene, int n, int layers, int parts) {
  double ratio = sin(PI / 4) / sin(PI / 4 + PI / n);
  int first = parts >= 2 ? 2 : 1, last = layers - 1;
  strut_scene_init(scene);
  if (parts >= 2) build_mass(scene, 0, 0, 1);
  for (int k = 0; k < layers; k++)
    for (int i = 0; i < n; i++) {
      double angle = (2 * i - k) * PI / n;
      build_mass(scene, pow(ratio, k) * cos(angle), pow(ratio, k) * sin(angle), 1);
    }
  for (int i = 0; i < n; i++) {
    for (int k = 0; k < last; k++) {
      int from = joint(first, n, i, k);
      add_pair(scene, from, joint(first, n, i, k + 1));
      add_pair(scene, from, joint(first, n, i + 1, k + 1));
      if (parts >= 3 && k < last - 1) add_pair(scene, from, joint(first, n, i + 1, k + 2));
    }
    if (parts < 2) continue;
    add_pair(scene, joint(first, n, i, 0), joint(first, n, i + 1, 0));
    add_pair(scene, joint(first, n, i, last), joint(first, n, i + 1, last));
    add_pair(scene, 1, joint(first, n, i, last));
  }
}

TEST(michell_wheels) {
  static const struct {
    int sides, layers, parts, members, rank, s, inner;
  } known[] = {{6, 4, 3, 66, 47, 19, 0},   {6, 4, 2, 54, 47, 7, 0},    {6, 4, 1, 36, 36, 0, 9},
               {6, 3, 3, 48, 35, 13, 0},   {6, 3, 2, 42, 35, 7, 0},    {6, 3, 1, 24, 24, 0, 9},
               {4, 3, 3, 32, 23, 9, 0},    {4, 3, 2, 28, 23, 5, 0},    {4, 3, 1, 16, 16, 0, 5},
               {12, 4, 3, 132, 95, 37, 0}, {12, 4, 2, 108, 95, 13, 0}, {12, 4, 1, 72, 72, 0, 21}};
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    strut_scene scene;
    truss t;
    wheel(&scene, known[i].sides, known[i].layers, known[i].parts);
    truss_look(&t, &scene);
    assert_int_equal(t.found.matrix.columns, known[i].members);
    truss_expect(&t, known[i].rank, known[i].s, known[i].inner + 3);
    truss_expect_kinds(&t, 3, 0, known[i].inner);
    if (i == 0) assert_near(t.found.spaces.kept, 0.538377, 1e-6);
    assert_near(t.found.spaces.dropped, 0.0, 1e-13);
    truss_free(&t);
  }
}

/* A grid of n x n cells with one diagonal each, and a second one in every third. */
static void grid(strut_scene *scene, int n, double size, bool held) {
  strut_scene_init(scene);
  for (int y = 0; y <= n; y++)
    for (int x = 0; x <= n; x++)
      if (held && x == 0)
        build_support(scene, 0, y * size);
      else
        build_mass(scene, x * size, y * size, 1);
  for (int y = 0; y <= n; y++)
    for (int x = 0; x <= n; x++) {
      int at = 1 + y * (n + 1) + x;
      if (x < n) add_pair(scene, at, at + 1);
      if (y < n) add_pair(scene, at, at + n + 1);
      if (x == n || y == n) continue;
      add_pair(scene, at, at + n + 2);
      if ((x + y * n) % 3 == 0) add_pair(scene, at + 1, at + n + 1);
    }
}

/* The same rank, counts and null spaces from singular values and from sparse QR. */
static void compare_methods(strut_scene *scene) {
  strut_model *model = NULL;
  strut_arena arena = {0};
  strut_equilibrium_matrix a;
  strut_null_spaces dense, sparse;
  strut_error error = {0};
  assert_int_equal(strut_model_compile(scene, &model, &error), STRUT_OK);
  assert_int_equal(strut_equilibrium_matrix_build(model, model->start, &arena, &a), STRUT_OK);
  assert_int_equal(strut_null_spaces_dense(&a, &arena, &dense, &error), STRUT_OK);
  assert_int_equal(strut_null_spaces_sparse(&a, &arena, &sparse, &error), STRUT_OK);
  assert_int_equal(dense.rank, sparse.rank);
  assert_int_equal(dense.states, sparse.states);
  assert_int_equal(dense.motions, sparse.motions);
  double *out = calloc((size_t)(a.rows + a.columns), sizeof *out);
  assert_non_null(out);
  for (int32_t i = 0; i < sparse.states; i++) {
    double largest = 0.0;
    const double *state = sparse.state + (size_t)i * (size_t)a.columns;
    for (int32_t j = 0; j < a.columns; j++) largest = fmax(largest, fabs(state[j]));
    strut_equilibrium_multiply(&a, state, out);
    for (int32_t k = 0; k < a.rows; k++) assert_near(out[k], 0.0, 1e-11 * largest);
  }
  for (int32_t i = 0; i < sparse.motions; i++) {
    const double *motion = sparse.motion + (size_t)i * (size_t)a.rows;
    strut_equilibrium_elongate(&a, motion, out);
    for (int32_t j = 0; j < a.columns; j++) assert_near(out[j], 0.0, 1e-12);
    for (int32_t k = 0; k <= i; k++) {
      const double *other = sparse.motion + (size_t)k * (size_t)a.rows;
      double sum = 0.0;
      for (int32_t r = 0; r < a.rows; r++) sum += motion[r] * other[r];
      assert_near(sum, i == k, 1e-12);
    }
  }
  free(out);
  strut_arena_free(&arena);
  strut_model_free(model);
  strut_scene_free(scene);
}

TEST(methods_agree) {
  strut_scene scene;
  grid(&scene, 8, 1.0, true);
  compare_methods(&scene);
  grid(&scene, 8, 1.0, false);
  compare_methods(&scene);
  arm(&scene);
  compare_methods(&scene);
  wheel(&scene, 6, 4, 3);
  compare_methods(&scene);
  wheel(&scene, 6, 4, 1);
  compare_methods(&scene);
}

/* 20 x 20 cells: 441 nodes, by QR. */
TEST(large_grid) {
  strut_scene scene;
  truss t;
  grid(&scene, 20, 1.0, false);
  truss_look(&t, &scene);
  assert_false(t.found.spaces.dense);
  int32_t inner = 19 * 19, second = (400 + 2) / 3; /* a wheel about each inner node; diagonals */
  truss_expect(&t, 2 * 441 - 3, inner + second, 3);
  truss_expect_kinds(&t, 3, 0, 0);
  truss_free(&t);
}

/* Unit vectors know no lengths: parts of a thousandth and of a thousand metres change nothing. */
TEST(sizes_do_not_matter) {
  strut_scene scene;
  truss t;
  double kept = 0.0;
  for (int i = 0; i < 3; i++) {
    grid(&scene, 4, i == 0 ? 1.0 : i == 1 ? 1e-9 : 1e9, true);
    truss_look(&t, &scene);
    truss_expect(&t, 40, 56 + 6 - 40, 0); /* 56 members with one diagonal per cell, 6 second ones */
    if (i == 0) kept = t.found.spaces.kept;
    assert_relative(t.found.spaces.kept, kept, 1e-12);
    truss_free(&t);
  }
}

static void spine(strut_scene *scene, const char *bars) {
  static const double at[][2] = {{0, 0}, {-.1016, -.1016}, {-.1016, .1016}, {.1016, 0}};
  strut_scene_init(scene);
  for (int body = 0; body < 2; body++)
    for (int i = 0; i < 4; i++) build_mass(scene, at[i][0] + 0.1524 * body, at[i][1], 1);
  truss_members(scene, STRUT_BAR, bars);
  truss_members(scene, STRUT_CABLE, "2-6 3-7 4-6 4-7");
  truss_hold(scene, 2, true, true);
  truss_hold(scene, 3, true, true);
}

/* Vertebrae of bars: as stars they flop, and that is a finite motion; as full bodies they hold. */
TEST(spine) {
  strut_scene scene;
  truss t;
  spine(&scene, "1-2 1-3 1-4 5-6 5-7 5-8");
  truss_look(&t, &scene);
  truss_expect(&t, 10, 0, 2);
  truss_expect_kinds(&t, 0, 0, 2);
  truss_free(&t);
  spine(&scene, "1-2 1-3 1-4 2-3 2-4 3-4 5-6 5-7 5-8 6-7 6-8 7-8");
  truss_look(&t, &scene);
  truss_expect(&t, 12, 4, 0);
  assert_near(t.found.spaces.kept, 0.253, 1e-3);
  assert_true(t.found.cables_can_pull);
  truss_free(&t);
}

/* Random structures: s - f = b - d, and dense and sparse agree, bars of all directions. */
TEST(random_structures) {
  for (uint64_t seed = 1; seed <= 60; seed++) {
    uint64_t r = seed;
    strut_scene scene;
    strut_scene_init(&scene);
    int32_t nodes = 4 + random_below(&r, 12);
    for (int32_t i = 0; i < nodes; i++) {
      double x = random_between(&r, 0, 1), y = random_between(&r, 0, 1);
      if (i < 2)
        build_support(&scene, x, y);
      else
        build_mass(&scene, x, y, 1);
    }
    int32_t members = nodes + random_below(&r, 2 * nodes);
    for (int32_t j = 0; j < members; j++) {
      int32_t a = random_below(&r, nodes), b = (a + 1 + random_below(&r, nodes - 1)) % nodes;
      build_member(&scene, STRUT_BAR, a, b, 1, 0, 0);
    }
    compare_methods(&scene);
  }
}

/* Memory that runs out anywhere is an error, never a crash or a wrong answer. */
TEST(out_of_memory) {
  strut_scene scene;
  strut_model *model = NULL;
  strut_error error = {0};
  arm(&scene);
  assert_int_equal(strut_model_compile(&scene, &model, &error), STRUT_OK);
  bool done = false;
  for (int64_t n = 0; !done && n < 10000; n++) {
    strut_rigidity found;
    strut_fail_allocation_after(n);
    strut_status status = strut_rigidity_find(model, model->start, &found, &error);
    strut_fail_allocation_after(-1);
    if (status == STRUT_OK)
      done = found.states.count == 5;
    else
      assert_int_equal(status, STRUT_NO_MEMORY);
    strut_rigidity_free(&found);
  }
  assert_true(done);
  strut_model_free(model);
  strut_scene_free(&scene);
}
