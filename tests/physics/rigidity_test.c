/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rank, self-stress and mechanisms by closed forms, by two methods, and of random structures; the gallery has the
   structures whose answers are known. */
#include "engine/statics/rigidity/rigidity_parts.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

static void truss_nodes(strut_scene *scene, const double (*position)[2], size_t count) {
  for (size_t i = 0; i < count; i++) build_mass(scene, position[i][0], position[i][1], 1.0);
}

/* Members between nodes numbered from 1, of stiffness 1 and at rest as drawn. */
static void truss_members(strut_scene *scene, strut_member_kind kind, const char *pairs) {
  for (const char *at = pairs; *at;) {
    char *end;
    long from = strtol(at, &end, 10), to = strtol(end + 1, &end, 10);
    build_member(scene, kind, (int32_t)from - 1, (int32_t)to - 1, 1.0, 0.0, 0.0);
    for (at = end; *at == ' '; at++) continue;
  }
}

static void truss_hold(strut_scene *scene, int number, bool x, bool y) {
  scene->nodes[number - 1].fixed[0] = x;
  scene->nodes[number - 1].fixed[1] = y;
}

/* A scene compiled and looked at where it is drawn. */
typedef struct truss {
  strut_scene *scene;
  strut_model *model;
  strut_rigidity found;
} truss;

static truss truss_look(strut_scene *scene) {
  truss t = {.scene = scene};
  assert_ok(strut_model_compile(scene, &t.model, NULL));
  assert_ok(strut_rigidity_find(t.model, t.model->start, &t.found, NULL));
  return t;
}

static void truss_free(truss *t) {
  strut_rigidity_free(&t->found);
  strut_model_free(t->model);
  strut_scene_free(t->scene);
}

/* Every state must hold without loads, every mechanism stretch nothing. */
static void check_bases(const truss *t) {
  const strut_equilibrium_matrix *a = &t->found.matrix;
  FREED double *sum = calloc((size_t)a->rows + 1, sizeof *sum);
  FREED double *strain = calloc((size_t)a->columns + 1, sizeof *strain);
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
}

static void truss_expect(const truss *t, int32_t rank, int32_t s, int32_t f) {
  assert_all_equal(t->found.spaces.rank, rank, t->found.states.count, s, t->found.mechanisms.count,
                   f, t->found.matrix.columns - t->found.matrix.rows, s - f);
  check_bases(t);
}

static void truss_expect_kinds(const truss *t, int32_t rigid, int32_t infinitesimal,
                               int32_t finite) {
  const strut_mechanisms *m = &t->found.mechanisms;
  assert_all_equal(m->rigid_body, rigid, m->infinitesimal, infinitesimal, m->finite, finite);
  assert_int_equal(m->undecided, 0);
}

/* Expects force densities of the only state, up to a factor that is that of the first. */
static void truss_expect_densities(const truss *t, const double *density, double tolerance) {
  assert_int_equal(t->found.states.count, 1);
  const double *force = t->found.states.force, *length = t->found.matrix.length;
  double factor = force[0] / length[0] / density[0];
  for (int32_t j = 0; j < t->found.matrix.columns; j++)
    assert_near(force[j] / length[j], factor * density[j], tolerance * fabs(factor));
}

static const double X[][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {2, 1}};

static void x_frame(strut_scene *scene) {
  strut_scene_init(scene);
  truss_nodes(scene, X, 4);
  truss_members(scene, STRUT_CABLE, "1-2 2-3 3-4 4-1");
  truss_members(scene, STRUT_BAR, "2-4 1-3");
}

TEST(x_frame) {
  static const double density[] = {1, 1, 1, 1, -1, -1};
  strut_scene scene;
  x_frame(&scene);
  truss_hold(&scene, 1, true, true);
  truss_hold(&scene, 2, false, true);
  OWN(truss) t = truss_look(&scene);
  truss_expect(&t, 5, 1, 0);
  truss_expect_densities(&t, density, 1e-13);
  assert_near(t.found.spaces.kept, 0.505, 5e-4);
  assert_near(t.found.spaces.dropped, 0.0, 1e-15);
  assert_near(t.found.states.force[0], 1.0, 0.0);
  assert_near(t.found.states.force[4], -sqrt(2.0), 1e-13);
  assert_all(t.found.states.cables_pull[0], t.found.stress.super_stable);
  assert_int_equal(t.found.bars_at_node, 1);
  assert_string_equal(t.found.tensegrity.label, "structure with tensegrity features of class 2");
}

/* Its bars as cables and its cables as bars: the state must press the sides, not the cables. */
TEST(sign_follows_the_cables) {
  strut_scene scene = build_scene();
  truss_nodes(&scene, X, 4);
  truss_members(&scene, STRUT_BAR, "1-2 2-3 3-4 4-1");
  truss_members(&scene, STRUT_CABLE, "2-4 1-3");
  OWN(truss) t = truss_look(&scene);
  truss_expect(&t, 5, 1, 3);
  assert_near(t.found.states.force[4], 1.0, 0.0);
  assert_near(t.found.states.force[0], -1.0 / sqrt(2.0), 1e-13);
  assert_false(t.found.stress.super_stable);
}

/* The same without cables: the rhombus moves, by more than the plane's three ways. */
TEST(four_bars_move) {
  strut_scene scene = build_scene();
  truss_nodes(&scene, X, 4);
  truss_members(&scene, STRUT_BAR, "4-1 1-2 2-3 3-4");
  OWN(truss) t = truss_look(&scene);
  truss_expect(&t, 4, 0, 4);
  truss_expect_kinds(&t, 3, 0, 1);
  const strut_mechanism *mode = &t.found.mechanisms.list[3];
  assert_within(mode->moved, 0.02, 0.3);
  assert_within(mode->strain, 0.0, 1e-12);
}

/* A rhombus folded flat opens as a rhombus or as a bar that swings: two finite motions. */
TEST(folded_rhombus) {
  static const double at[][2] = {{0, 0}, {1, 0}, {2, 0}, {1, 0}};
  strut_scene scene = build_scene();
  truss_nodes(&scene, at, 4);
  truss_members(&scene, STRUT_BAR, "1-2 2-3 3-4 4-1");
  OWN(truss) t = truss_look(&scene);
  truss_expect(&t, 3, 1, 5);
  truss_expect_kinds(&t, 3, 0, 2);
}

static strut_scene hexagon_of_two_struts(void) {
  double h = sqrt(7.0) / 4.0;
  const double at[][2] = {{0, 0},         {h, 0.75},      {h + 1, 0.75},
                          {2 * h + 1, 0}, {h + 1, -0.75}, {h, -0.75}};
  strut_scene scene = build_scene();
  truss_nodes(&scene, at, 6);
  truss_members(&scene, STRUT_CABLE, "1-2 2-3 3-4 4-5 5-6 6-1");
  truss_members(&scene, STRUT_BAR, "2-6 3-5");
  return scene;
}

/* Where the shape carries its prestress, the stiffness of the mechanism comes from it. */
TEST(prestress_stiffens) {
  double h = sqrt(7.0) / 4.0, force[] = {1, h, 1, 1, h, 1, -0.75, -0.75};
  strut_scene scene = hexagon_of_two_struts();
  truss_hold(&scene, 1, true, true);
  truss_hold(&scene, 4, true, true);
  for (int j = 0; j < 8; j++) {
    scene.members[j].stiffness = 10.0;
    scene.members[j].rest_kind = STRUT_REST_PRETENSION;
    scene.members[j].rest_value = 0.5 * force[j];
  }
  OWN(truss) t = truss_look(&scene);
  assert_all(t.found.equilibrium, t.found.self_equilibrium, t.found.mechanisms.by_forces);
  /* by hand: sum of density |d2 - d1|^2 over |d|^2, d as above, |d|^2 = 4 (0.375^2 + (h/2)^2) */
  double sum = 0.0, a = 0.375, b = h / 2.0, all = 4 * (a * a + b * b);
  sum += 4 * 0.5 * (a * a + b * b);           /* sloping cables, length 1: their one free end */
  sum += 2 * 0.5 * h * 4 * b * b;             /* horizontal cables: ends move by -+b in y */
  sum += 2 * 0.5 * (-0.75 / 1.5) * 4 * a * a; /* struts: ends move by -+a in x */
  assert_near(t.found.mechanisms.list[0].stiffness, sum / all, 1e-12);
}

/* Flat, it is the textbook's infinitesimal mechanism: tension stiffens it, and s = f = 1. */
TEST(flat_von_mises) {
  static const double at[][2] = {{-1, 0}, {1, 0}, {0, 0}};
  strut_scene scene = build_scene();
  truss_nodes(&scene, at, 3);
  truss_members(&scene, STRUT_CABLE, "1-3 2-3");
  truss_hold(&scene, 1, true, true);
  truss_hold(&scene, 2, true, true);
  OWN(truss) t = truss_look(&scene);
  truss_expect(&t, 1, 1, 1);
  truss_expect_kinds(&t, 0, 1, 0);
  assert_near(t.found.mechanisms.list[0].stress_form, 2.0, 1e-13); /* two densities of 1 */
  assert_true(t.found.stress.super_stable);
}

/* A parallelogram on two pins with a third bar in parallel: overbraced, and yet it moves. */
TEST(parallel_bars_move) {
  static const double at[][2] = {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}};
  strut_scene scene = build_scene();
  truss_nodes(&scene, at, 6);
  truss_members(&scene, STRUT_BAR, "1-4 2-5 3-6 4-5 5-6 4-6");
  for (int i = 1; i <= 3; i++) truss_hold(&scene, i, true, true);
  OWN(truss) t = truss_look(&scene);
  /* 4-5-6 is straight: one state in it, stiffening 5 against 4-6 only; the swing stays */
  assert_int_equal(t.found.mechanisms.count - t.found.states.count, 0);
  assert_int_equal(t.found.mechanisms.finite, 1);
}

/* A frame of `count` directions, each a straight row of three nodes that can be stressed alone. */
static bool lies_on_conic(int count, const double *angle) {
  strut_scene scene = build_scene();
  build_mass(&scene, 0, 0, 1);
  for (int k = 0; k < count; k++)
    for (int i = 1; i <= 2; i++) build_mass(&scene, i * cos(angle[k]), i * sin(angle[k]), 1);
  for (int k = 0; k < count; k++) {
    int32_t near = 2 * k + 1, far = near + 1;
    build_member(&scene, STRUT_CABLE, 0, near, 1, 0, 0);
    build_member(&scene, STRUT_CABLE, near, far, 1, 0, 0);
    build_member(&scene, STRUT_BAR, 0, far, 1, 0, 0);
  }
  OWN(truss) t = truss_look(&scene);
  assert_true(t.found.stress.tested);
  return t.found.stress.on_conic;
}

/* Two directions, however they are turned, always lie on a conic; three that differ never do. */
TEST(two_directions_lie_on_a_conic) {
  for (int i = 0; i < 12; i++) {
    double turn = 0.5 * i, angle[] = {turn, turn + 0.9 + 0.1 * i, turn + 0.4};
    assert_all(lies_on_conic(1, angle), lies_on_conic(2, angle));
    assert_false(lies_on_conic(3, angle));
    angle[2] = angle[0] + 1e-3; /* near is not on it */
    assert_false(lies_on_conic(3, angle));
  }
}

static const double PI = 3.14159265358979323846;

static strut_scene arm(void) {
  static const double at[16][2] = {{0, 0},  {0, -1}, {1, -1}, {2, -1}, {2, 0}, {3, -1},
                                   {4, -1}, {4, 0},  {5, -1}, {6, 0},  {5, 1}, {4, 1},
                                   {3, 1},  {2, 1},  {1, 1},  {0, 1}};
  strut_scene scene = build_scene();
  for (int i = 0; i < 16; i++) build_mass(&scene, at[i][0] * sqrt(0.5), at[i][1] * sqrt(0.5), 1.0);
  truss_members(&scene, STRUT_BAR,
                "1-3 3-5 5-4 5-6 6-8 8-7 8-9 9-10 10-11 11-8 8-12 8-13 13-5 5-14 5-15 15-1");
  truss_members(&scene, STRUT_CABLE,
                "1-2 2-3 3-4 4-6 6-7 7-9 11-12 12-13 13-14 14-15 15-16 16-1 1-5 5-8 8-10 9-11 "
                "6-13 3-15");
  return scene;
}

/* The number of node (i, k) of a wheel of n sides; the first nodes come before it. */
static int joint(int first, int n, int i, int k) { return first + k * n + ((i % n) + n) % n; }

static void add_pair(strut_scene *scene, int from, int to) {
  build_member(scene, STRUT_BAR, from - 1, to - 1, 1.0, 0.0, 0.0);
}

/* parts: 1 spirals, 2 rim, ring, hub and spokes too, 3 radials too. */
static strut_scene wheel(int n, int layers, int parts) {
  double ratio = sin(PI / 4) / sin(PI / 4 + PI / n);
  int first = parts >= 2 ? 2 : 1, last = layers - 1;
  strut_scene scene = build_scene();
  if (parts >= 2) build_mass(&scene, 0, 0, 1);
  for (int k = 0; k < layers; k++)
    for (int i = 0; i < n; i++) {
      double angle = (2 * i - k) * PI / n;
      build_mass(&scene, pow(ratio, k) * cos(angle), pow(ratio, k) * sin(angle), 1);
    }
  for (int i = 0; i < n; i++) {
    for (int k = 0; k < last; k++) {
      int from = joint(first, n, i, k);
      add_pair(&scene, from, joint(first, n, i, k + 1));
      add_pair(&scene, from, joint(first, n, i + 1, k + 1));
      if (parts >= 3 && k < last - 1) add_pair(&scene, from, joint(first, n, i + 1, k + 2));
    }
    if (parts < 2) continue;
    add_pair(&scene, joint(first, n, i, 0), joint(first, n, i + 1, 0));
    add_pair(&scene, joint(first, n, i, last), joint(first, n, i + 1, last));
    add_pair(&scene, 1, joint(first, n, i, last));
  }
  return scene;
}

/* A grid of n x n cells with one diagonal each, and a second one in every third. */
static strut_scene grid(int n, double size, bool held) {
  strut_scene scene = build_scene();
  for (int y = 0; y <= n; y++)
    for (int x = 0; x <= n; x++)
      if (held && x == 0)
        build_support(&scene, 0, y * size);
      else
        build_mass(&scene, x * size, y * size, 1);
  for (int y = 0; y <= n; y++)
    for (int x = 0; x <= n; x++) {
      int at = 1 + y * (n + 1) + x;
      if (x < n) add_pair(&scene, at, at + 1);
      if (y < n) add_pair(&scene, at, at + n + 1);
      if (x == n || y == n) continue;
      add_pair(&scene, at, at + n + 2);
      if ((x + y * n) % 3 == 0) add_pair(&scene, at + 1, at + n + 1);
    }
  return scene;
}

/* The same rank, counts and null spaces from singular values and from sparse QR. */
static void compare_methods(strut_scene *scene) {
  OWN_POINTER(strut_model) model = NULL;
  OWN(strut_arena) arena = {0};
  strut_equilibrium_matrix a;
  strut_null_spaces dense, sparse;
  assert_ok(strut_model_compile(scene, &model, NULL));
  assert_ok(strut_equilibrium_matrix_build(model, model->start, &arena, &a));
  assert_ok(strut_null_spaces_dense(&a, &arena, &dense, NULL));
  assert_ok(strut_null_spaces_sparse(&a, &arena, &sparse, NULL));
  assert_all_equal(dense.rank, sparse.rank, dense.states, sparse.states);
  assert_int_equal(dense.motions, sparse.motions);
  FREED double *out = calloc((size_t)(a.rows + a.columns), sizeof *out);
  assert_non_null(out);
  for (int32_t i = 0; i < sparse.states; i++) {
    double largest = 0.0;
    const double *state = sparse.state + (size_t)i * (size_t)a.columns;
    for (int32_t j = 0; j < a.columns; j++) largest = fmax(largest, fabs(state[j]));
    strut_equilibrium_multiply(&a, state, out);
    for (int32_t k = 0; k < a.rows; k++) assert_near(out[k], 0.0, 1e-11 * largest);
  }
  for (int32_t i = 0; i < sparse.motions; i++) {
    const double *move = sparse.motion + (size_t)i * (size_t)a.rows;
    strut_equilibrium_elongate(&a, move, out);
    for (int32_t j = 0; j < a.columns; j++) assert_near(out[j], 0.0, 1e-12);
    for (int32_t k = 0; k <= i; k++) {
      const double *other = sparse.motion + (size_t)k * (size_t)a.rows;
      double sum = 0.0;
      for (int32_t r = 0; r < a.rows; r++) sum += move[r] * other[r];
      assert_near(sum, i == k, 1e-12);
    }
  }
  strut_scene_free(scene);
}

TEST(methods_agree) {
  strut_scene scenes[] = {grid(8, 1.0, true), grid(8, 1.0, false), arm(), wheel(6, 4, 3),
                          wheel(6, 4, 1)};
  for (int i = 0; i < 5; i++) compare_methods(&scenes[i]);
}

/* 20 x 20 cells: 441 nodes, by QR. */
TEST(large_grid) {
  strut_scene scene = grid(20, 1.0, false);
  OWN(truss) t = truss_look(&scene);
  assert_false(t.found.spaces.dense);
  int32_t inner = 19 * 19, second = (400 + 2) / 3; /* a wheel about each inner node; diagonals */
  truss_expect(&t, 2 * 441 - 3, inner + second, 3);
  truss_expect_kinds(&t, 3, 0, 0);
}

/* Unit vectors know no lengths: parts of a thousandth and of a thousand metres change nothing. */
TEST(sizes_do_not_matter) {
  strut_scene scene;
  truss t;
  double kept = 0.0;
  for (int i = 0; i < 3; i++) {
    scene = grid(4, i == 0 ? 1.0 : i == 1 ? 1e-9 : 1e9, true);
    t = truss_look(&scene);
    truss_expect(&t, 40, 56 + 6 - 40, 0); /* 56 members with one diagonal per cell, 6 second ones */
    if (i == 0) kept = t.found.spaces.kept;
    assert_relative(t.found.spaces.kept, kept, 1e-12);
    truss_free(&t);
  }
}

/* Random structures: s - f = b - d, and dense and sparse agree, bars of all directions. */
TEST(random_structures) {
  for (uint64_t seed = 1; seed <= 60; seed++) {
    uint64_t r = seed;
    strut_scene scene = build_scene();
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
  OWN_POINTER(strut_model) model = NULL;
  OWN(strut_scene) scene = arm();
  assert_ok(strut_model_compile(&scene, &model, NULL));
  REFUSE_EACH(n, status, 5) {
    OWN(strut_rigidity) found;
    status = refused(n, strut_rigidity_find(model, model->start, &found, NULL));
    if (status == STRUT_OK) assert_int_equal(found.states.count, 5);
  }
}
