/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The largest stable step of structures too large for all eigenvalues, against all eigenvalues: a
   step at 0.99 of the limit must map no motion onto a larger one, at 1.01 it must. */
#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>

#include "engine/forces/tangent.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/integrate/limit/tangent_limits.h"
#include "engine/model/mass.h"
#include "tests/support/random.h"
#include "tests/support/structures.h"

/* Of the row whose time is taken: the program's argument. */
static int32_t nodes = 20000;

/* Dense M^-1 K and M^-1 D, (n, n). */
typedef struct dense {
  size_t n;
  double *k, *d;
} dense;

static void fill(const strut_model *model, const strut_tangent *t, const strut_sparse *a,
                 double *out) {
  size_t n = (size_t)t->n, length = (size_t)model->length;
  double *x = calloc(n, sizeof *x), *y = calloc(n, sizeof *y),
         *full = calloc(3 * length, sizeof *x);
  assert_true(x && y && full);
  for (size_t j = 0; j < n; j++) {
    for (size_t i = 0; i < n; i++) x[i] = i == j;
    strut_sparse_multiply(a, x, y);
    for (size_t i = 0; i < 2 * length; i++) full[i] = 0;
    for (size_t i = 0; i < n; i++) full[t->coordinate[i]] = y[i];
    strut_mass_solve(model, full, full + length, full + 2 * length);
    for (size_t i = 0; i < n; i++) out[i * n + j] = full[length + (size_t)t->coordinate[i]];
  }
  free(x), free(y), free(full);
}

static dense dense_of(const strut_model *model, strut_closed closed) {
  OWN(strut_arena) arena = {0};
  strut_tangent t;
  assert_ok(strut_tangent_assemble(model, model->start, model->members.rest, closed, &arena, &t));
  dense s = {.n = (size_t)t.n};
  s.k = calloc(s.n * s.n, sizeof *s.k), s.d = calloc(s.n * s.n, sizeof *s.d);
  assert_true(s.k && s.d);
  fill(model, &t, t.stiffness, s.k);
  fill(model, &t, t.damping, s.d);
  return s;
}

static void dense_free(dense *s) { free(s->k), free(s->d); }

/* All eigenvalues of a (rows, rows) matrix, which is destroyed. */
static gsl_vector_complex *eigenvalues(gsl_matrix *a) {
  gsl_vector_complex *z = gsl_vector_complex_alloc(a->size1);
  gsl_eigen_nonsymm_workspace *w = gsl_eigen_nonsymm_alloc(a->size1);
  assert_true(z && w);
  gsl_eigen_nonsymm_params(0, 1, w);
  assert_int_equal(gsl_eigen_nonsymm(a, z, w), 0);
  gsl_eigen_nonsymm_free(w);
  gsl_matrix_free(a);
  return z;
}

static double radius(gsl_matrix *map) {
  gsl_vector_complex *z = eigenvalues(map);
  double largest = 0;
  for (size_t i = 0; i < z->size; i++)
    largest = fmax(largest, gsl_complex_abs(gsl_vector_complex_get(z, i)));
  gsl_vector_complex_free(z);
  return largest;
}

/* Velocity Verlet on (q / h, v, h a), as written: a' = -K q' - D (v + h a). */
static double verlet_growth(const dense *s, double h) {
  size_t n = s->n;
  gsl_matrix *m = gsl_matrix_calloc(3 * n, 3 * n);
  assert_non_null(m);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) {
      double k = h * h * s->k[i * n + j], d = h * s->d[i * n + j], one = i == j;
      double to[3] = {-k, -k - d, -0.5 * k - d}; /* h a' */
      double q[3] = {one, one, 0.5 * one}, v[3] = {0, one, 0.5 * one};
      for (size_t c = 0; c < 3; c++) {
        gsl_matrix_set(m, i, c * n + j, q[c]);
        gsl_matrix_set(m, n + i, c * n + j, v[c] + 0.5 * to[c]);
        gsl_matrix_set(m, 2 * n + i, c * n + j, to[c]);
      }
    }
  return radius(m);
}

/* Semi-implicit Euler on (q / h, v). */
static double euler_growth(const dense *s, double h) {
  size_t n = s->n;
  gsl_matrix *m = gsl_matrix_calloc(2 * n, 2 * n);
  assert_non_null(m);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) {
      double k = h * h * s->k[i * n + j], d = h * s->d[i * n + j], one = i == j;
      gsl_matrix_set(m, i, j, one - k);
      gsl_matrix_set(m, i, n + j, one - d);
      gsl_matrix_set(m, n + i, j, -k);
      gsl_matrix_set(m, n + i, n + j, one - d);
    }
  return radius(m);
}

/* RK4's polynomial of the eigenvalues of the first-order system; of those that do not grow anyway. */
static double rk4_growth(const gsl_vector_complex *z, double h) {
  double largest = 0;
  for (size_t i = 0; i < z->size; i++) {
    gsl_complex y = gsl_complex_mul_real(gsl_vector_complex_get(z, i), h);
    gsl_complex r = gsl_complex_rect(1, 0);
    for (int k = 4; k >= 1; k--)
      r = gsl_complex_add_real(gsl_complex_mul(r, gsl_complex_div_real(y, k)), 1);
    largest = fmax(largest, gsl_complex_abs(r));
  }
  return largest;
}

static gsl_vector_complex *spectrum(const dense *s) {
  size_t n = s->n;
  gsl_matrix *m = gsl_matrix_calloc(2 * n, 2 * n);
  double scale = 0;
  assert_non_null(m);
  for (size_t i = 0; i < n; i++) scale = fmax(scale, sqrt(fabs(s->k[i * n + i])));
  for (size_t i = 0; i < n; i++) {
    gsl_matrix_set(m, i, n + i, scale);
    for (size_t j = 0; j < n; j++) {
      gsl_matrix_set(m, n + i, j, -s->k[i * n + j] / scale);
      gsl_matrix_set(m, n + i, n + j, -s->d[i * n + j]);
    }
  }
  return eigenvalues(m);
}

/* Motions without stiffness have 1 twice, which is known to the root of rounding only. */
static const double STAYS = 1 + 1e-5, GROWS = 1 + 1e-3;

static void check_plain(const strut_model *model, const strut_step_limit *limit) {
  OWN(dense) s = dense_of(model, STRUT_CLOSED_ALL);
  gsl_vector_complex *z = spectrum(&s);
  double rk4 = limit->of[STRUT_REGION_RK4], verlet = limit->of[STRUT_REGION_VERLET];
  double euler = limit->of[STRUT_REGION_EULER];
  double g[6] = {rk4_growth(z, 0.99 * rk4),        rk4_growth(z, 1.01 * rk4),
                 verlet_growth(&s, 0.99 * verlet), verlet_growth(&s, 1.01 * verlet),
                 euler_growth(&s, 0.99 * euler),   euler_growth(&s, 1.01 * euler)};
  print_message("  rk4 %.4f %.4f, verlet %.4f %.4f, euler %.4f %.4f\n", g[0], g[1], g[2], g[3],
                g[4], g[5]);
  for (int i = 0; i < 6; i++) assert_true(i % 2 ? g[i] > GROWS : g[i] < STAYS);
  gsl_vector_complex_free(z);
}

static void check_implicit(const strut_model *model, const strut_step_limit *limit) {
  OWN(dense) s = dense_of(model, STRUT_CLOSED_UNDAMPED);
  double h = strut_step_limit_of_method(limit, strut_integrator_find("verlet-events"));
  assert_true(verlet_growth(&s, 0.99 * h) < STAYS);
  assert_true(verlet_growth(&s, 1.01 * h) > GROWS);
}

static void check(const char *name, strut_scene *scene) {
  strut_step_limit limit;
  OWN_POINTER(strut_model) model = motion_compile(scene);
  assert_ok(strut_step_limit_estimate(model, &limit, NULL));
  assert_false(limit.exact);
  print_message("%s: %.4g s, %.4g s, %.4g s\n", name, limit.of[STRUT_REGION_RK4],
                limit.of[STRUT_REGION_VERLET], limit.of[STRUT_REGION_EULER]);
  check_plain(model, &limit);
  if (model->contacts.count > 0) check_implicit(model, &limit);
  strut_scene_free(scene);
}

static double damping_of(double ratio, double stiffness, double mass) {
  return 2 * ratio * sqrt(stiffness * mass);
}

static const double RATIOS[] = {0, 0.1, 1, 10};

/* Bars in a row that zigzags, alike or with random stiffness; every member damped, or one in five. */
static strut_scene chain(double ratio, bool random, bool few, strut_mass_model mass) {
  uint64_t r = 3;
  strut_scene scene = build_scene();
  scene.mass_model = mass;
  build_support(&scene, 0, 0);
  for (int32_t i = 1; i <= 33; i++) {
    double c = random ? random_scale(&r, 1e3, 1e5) : 1e4;
    build_node(&scene, i, 0.3 * (i % 2));
    double k = few && i % 5 ? 0 : damping_of(ratio, c, 0.2);
    build_member(&scene, STRUT_BAR, i - 1, i, c, k, 0.2);
  }
  return scene;
}

BEFORE_ALL { nodes = (int32_t)test_number(1, nodes); }

TEST(chains) {
  for (int k = 0; k < 4; k++)
    for (int kind = 0; kind < 4; kind++) {
      char name[80];
      strut_scene scene = chain(RATIOS[k], kind & 1, kind & 2,
                                kind == 3 ? STRUT_MASS_LUMPED : STRUT_MASS_CONSISTENT);
      snprintf(name, sizeof name, "chain, %s, damping ratio %g in %s", kind & 1 ? "random" : "even",
               RATIOS[k], kind & 2 ? "some" : "all");
      check(name, &scene);
    }
}

/* A grid with diagonals, standing on ground whose damper is strong or weak. */
static strut_scene grid(double ratio, double ground, bool touch, double bar_mass) {
  enum { COLUMNS = 9, ROWS = 4 };
  strut_scene scene = build_scene();
  scene.gravity[1] = -9.81;
  for (int32_t y = 0; y < ROWS; y++)
    for (int32_t x = 0; x < COLUMNS; x++) build_mass(&scene, x, y, 0.1);
  for (int32_t y = 0; y < ROWS; y++)
    for (int32_t x = 0; x < COLUMNS; x++) {
      int32_t i = y * COLUMNS + x;
      double k = damping_of(ratio, 1e4, 0.3);
      if (x + 1 < COLUMNS) build_member(&scene, STRUT_BAR, i, i + 1, 1e4, k, bar_mass);
      if (y + 1 < ROWS) build_member(&scene, STRUT_BAR, i, i + COLUMNS, 1e4, k, bar_mass);
      if (x + 1 < COLUMNS && y + 1 < ROWS)
        build_member(&scene, STRUT_SPRING, i, i + COLUMNS + 1, 3e3, 0, 0);
    }
  for (int32_t x = 0; touch && x < COLUMNS; x++)
    build_rough_contact(&scene, x, 5e4, damping_of(ground, 5e4, 0.3), 0.3, 0.3, 1e-3);
  return scene;
}

TEST(grids) {
  for (int k = 0; k < 4; k++)
    for (int kind = 0; kind < 3; kind++) {
      char name[80];
      strut_scene scene = grid(RATIOS[k], RATIOS[(k + kind) % 4], kind > 0, kind == 1 ? 0 : 0.2);
      snprintf(name, sizeof name, "grid, damping ratio %g, %s ground of %g", RATIOS[k],
               kind > 0 ? "on a" : "without", RATIOS[(k + kind) % 4]);
      check(name, &scene);
    }
}

/* Prestressed X-frames in a row, in which one cable is far stiffer, and one far more damped. */
TEST(frames) {
  for (int k = 0; k < 4; k++) {
    strut_scene scene = build_scene();
    char name[80];
    structure_chain(&scene, 17, STRUT_MASS_CONSISTENT);
    for (size_t j = 0; j < scene.member_count; j++)
      scene.members[j].damping = damping_of(RATIOS[k] / 10, scene.members[j].stiffness, 0.1);
    scene.members[7].stiffness *= 1.1;
    scene.members[41].damping *= 20;
    snprintf(name, sizeof name, "frames, damping ratio %g, one member stiffer, one damped",
             RATIOS[k] / 10);
    check(name, &scene);
  }
}

/* The limit of a long even row is known; and it takes seconds. */
TEST(time_of_many_nodes) {
  for (int k = 0; k < 3; k++) {
    OWN(strut_scene) scene = build_scene();
    strut_step_limit limit;
    double omega = sqrt(12 * 1e4 / 0.2), zeta = RATIOS[k], damping = 2 * zeta * 1e4 / omega;
    for (int32_t i = 0; i < nodes; i++) {
      build_node(&scene, i, 0);
      scene.nodes[i].fixed[1] = k != 0;
      if (i) build_member(&scene, STRUT_BAR, i - 1, i, 1e4, damping, 0.2);
    }
    OWN_POINTER(strut_model) model = motion_compile(&scene);
    double begin = test_seconds();
    assert_ok(strut_step_limit_estimate(model, &limit, NULL));
    print_message("%d nodes, damping ratio %g: %.2f s\n", (int)nodes, zeta, test_seconds() - begin);
    assert_relative(limit.of[STRUT_REGION_VERLET] * omega,
                    2 * (sqrt(4 * zeta * zeta + 1) - 2 * zeta), 1e-2);
    assert_relative(limit.of[STRUT_REGION_EULER] * omega, 2 * (sqrt(zeta * zeta + 1) - zeta), 1e-2);
    if (k == 0) assert_relative(limit.limit * omega, 2.8284271, 1e-2);
    if (k == 2) assert_relative(limit.limit * omega, 2.7852936, 1e-2);
  }
}
