/* SPDX-License-Identifier: GPL-3.0-or-later */
/* strut_modes_find against closed forms and an assembly of its own. */
#include <gsl/gsl_errno.h>

#include "engine/statics/modes/modes.h"
#include "tests/support/dense.h"
#include "tests/support/structures.h"

static const double PI = 3.14159265358979323846;

static strut_model *model;
static strut_modes modes;

static void forget(void) {
  strut_modes_free(&modes);
  strut_model_free(model);
}

AFTER_ALL { forget(); }

/* Modes of a scene, instead of those found before. */
static void find_with(const strut_setup *setup, strut_modes_options options) {
  strut_error error = {0};
  forget();
  model = motion_compile(&setup->scene);
  strut_status status = strut_modes_find(model, &setup->experiment, &options, &modes, &error);
  if (status != STRUT_OK) fail_msg("%s", error.message);
}

static void find(const strut_setup *setup) { find_with(setup, (strut_modes_options){.count = 0}); }

static size_t count_kind(strut_mode_kind kind) {
  size_t count = 0;
  for (size_t i = 0; i < modes.count; i++) count += modes.list[i].kind == kind;
  return count;
}

static const x_frame FRAME = {1, 120, .cable = {1000, 0, 0.02}, .bar = {5e4, 0, 0.3}};

BEFORE_ALL { gsl_set_error_handler_off(); }

/* Its modes that stretch members, by hand, are those found, to `tolerance`. */
static void check_x_frame(const x_frame *frame, double tolerance) {
  double kc = frame->cable.stiffness, kb = frame->bar.stiffness, q = frame->force_density;
  double mc = frame->cable.mass, mb = frame->bar.mass;
  double expected[5] = {8 * (kc + q) / (4 * mc / 3 + 2 * mb), 8 * (kc + q) / (4 * mc / 3 + 2 * mb),
                        16 * (kc - q) / (16 * mc / 3 + 4 * mb / 3),
                        8 * (kb + q) / (8 * mc / 3 + 2 * mb / 3),
                        8 * (kc + kb) / (8 * mc / 3 + 2 * mb / 3)};
  OWN(strut_setup) setup = build_setup();
  structure_x_frame(&setup.scene, frame);
  find(&setup);
  for (size_t i = 0; i < 5; i++)
    assert_relative(modes.list[3 + i].eigenvalue, expected[i], tolerance);
}

TEST(x_frame) {
  check_x_frame(&FRAME, 1e-12);
  assert_int_equal(modes.count, 8);
  for (size_t i = 0; i < 3; i++) {
    assert_int_equal(modes.list[i].kind, STRUT_MODE_RIGID);
    assert_true(modes.list[i].eigenvalue == 0);
  }
  for (size_t i = 0; i < 5; i++) {
    assert_int_equal(modes.list[3 + i].kind, STRUT_MODE_ELASTIC);
    assert_all(modes.list[3 + i].error < 1e-12, modes.list[3 + i].residual < 1e-10);
  }
  assert_string_equal(modes.list[0].description, "the structure moves along x");
  assert_string_equal(modes.list[2].description, "the structure rotates freely");
}

/* K and M of a free structure as the book has it, in doubles. */
static void assemble(const strut_setup *setup, gsl_matrix *k, gsl_matrix *m) {
  for (size_t j = 0; j < setup->scene.member_count; j++) {
    const strut_member *member = &setup->scene.members[j];
    size_t a = 2 * (size_t)member->node[0], b = 2 * (size_t)member->node[1];
    const double *p = setup->scene.nodes[member->node[0]].position;
    const double *r = setup->scene.nodes[member->node[1]].position;
    double d[2] = {r[0] - p[0], r[1] - p[1]}, length = hypot(d[0], d[1]);
    double density = member->rest_value;
    for (size_t x = 0; x < 2; x++)
      for (size_t y = 0; y < 2; y++) {
        double along = d[x] * d[y] / (length * length);
        double value = member->stiffness * along + density * ((x == y ? 1.0 : 0.0) - along);
        *gsl_matrix_ptr(k, a + x, a + y) += value;
        *gsl_matrix_ptr(k, b + x, b + y) += value;
        *gsl_matrix_ptr(k, a + x, b + y) -= value;
        *gsl_matrix_ptr(k, b + x, a + y) -= value;
        if (x != y) continue;
        *gsl_matrix_ptr(m, a + x, a + y) += member->mass / 3;
        *gsl_matrix_ptr(m, b + x, b + y) += member->mass / 3;
        *gsl_matrix_ptr(m, a + x, b + y) += member->mass / 6;
        *gsl_matrix_ptr(m, b + x, a + y) += member->mass / 6;
      }
  }
}

TEST(x_frame_with_unequal_members) {
  OWN(strut_setup) setup = build_setup();
  structure_x_frame(&setup.scene, &FRAME);
  for (size_t j = 0; j < setup.scene.member_count; j++) {
    setup.scene.members[j].stiffness *= 1 + 0.37 * (double)(j + 1);
    setup.scene.members[j].mass *= 1 + 0.61 * (double)(6 - j);
  }
  OWN_POINTER(gsl_matrix) k = gsl_matrix_calloc(8, 8), *m = gsl_matrix_calloc(8, 8);
  assemble(&setup, k, m);
  OWN_POINTER(gsl_vector) value = dense_eigenvalues(k, m);
  find(&setup);
  for (size_t i = 0; i < 3; i++)
    assert_near(gsl_vector_get(value, i), 0, 1e-9 * modes.list[7].eigenvalue);
  for (size_t i = 3; i < 8; i++)
    assert_relative(modes.list[i].eigenvalue, gsl_vector_get(value, i), 1e-10);
}

static void check_chain(strut_mass_model mass_model, bool sparse) {
  enum { N = 20 };
  const double k = 700, m = 0.03;
  OWN(strut_setup) setup = build_setup();
  setup.scene.mass_model = mass_model;
  for (int i = 0; i <= N; i++) build_node(&setup.scene, 0.1 * i, 0);
  for (int i = 0; i <= N; i++) setup.scene.nodes[i].fixed[1] = true;
  setup.scene.nodes[0].fixed[0] = setup.scene.nodes[N].fixed[0] = true;
  for (int i = 0; i < N; i++) build_member(&setup.scene, STRUT_BAR, i, i + 1, k, 0, m);
  find_with(&setup, (strut_modes_options){.count = sparse ? 6 : 0, .sparse = sparse});
  assert_int_equal(modes.count, sparse ? 6 : N - 1);
  for (size_t j = 1; j <= modes.count; j++) {
    double half = sin((double)j * PI / (2 * N)), fall = 2 * half * half; /* 1 - cos */
    double expected =
        mass_model == STRUT_MASS_LUMPED ? 2 * k / m * fall : 6 * k / m * fall / (3 - fall);
    assert_relative(modes.list[j - 1].angular_frequency, sqrt(expected), 1e-12);
    assert_relative(modes.list[j - 1].eigenvalue, expected, 1e-12);
  }
}

TEST(chain_of_twenty) {
  check_chain(STRUT_MASS_CONSISTENT, false);
  check_chain(STRUT_MASS_LUMPED, false);
  check_chain(STRUT_MASS_CONSISTENT, true);
  check_chain(STRUT_MASS_LUMPED, true);
}

TEST(free_bar) {
  for (int lumped = 0; lumped < 2; lumped++) {
    OWN(strut_setup) setup = build_setup();
    setup.scene.mass_model = lumped ? STRUT_MASS_LUMPED : STRUT_MASS_CONSISTENT;
    build_node(&setup.scene, 0.3, -2), build_node(&setup.scene, 1.7, 0.4);
    build_member(&setup.scene, STRUT_BAR, 0, 1, 3e4, 0, 0.7);
    find(&setup);
    assert_all_equal(modes.count, 4, count_kind(STRUT_MODE_RIGID), 3);
    assert_relative(modes.list[3].eigenvalue, (lumped ? 4 : 12) * 3e4 / 0.7, 1e-13);
  }
}

/* Rods hang straight down; their stretch by the weight is 1/k, and so is the frequencies' error. */
TEST(double_pendulum_goes_to_the_rigid_limit) {
  double limit[2] = {9.81 * (3 - 6 / sqrt(7)), 9.81 * (3 + 6 / sqrt(7))}, error[2][6];
  size_t count = 0;
  for (double k = 1e5; k < 2e10; k *= 10, count++) {
    OWN(strut_setup) setup = build_setup();
    structure_pendulum(&setup.scene, k, 0, true, 0);
    setup.scene.gravity[0] = 0, setup.scene.gravity[1] = -9.81;
    find(&setup);
    for (size_t i = 0; i < 2; i++) {
      error[i][count] = fabs(modes.list[i].eigenvalue / limit[i] - 1);
      assert_true(modes.list[i].error < 1e-9);
    }
  }
  assert_int_equal(count, 6);
  for (size_t i = 0; i < 2; i++) {
    assert_true(error[i][5] < 1e-8);
    for (size_t n = 1; n < 6; n++) /* ten times as stiff, a tenth of the error */
      assert_within(error[i][n - 1] / error[i][n], 9.9, 10.1);
  }
}

/* A mass on a spring with a damper: the closed form, below and above critical. */
TEST(damped_oscillator) {
  const double k = 90, m = 2.5;
  for (int i = 0; i < 3; i++) {
    double zeta = (double[]){0.03, 0.6, 1.7}[i], omega = sqrt(k / m);
    OWN(strut_setup) setup = build_setup();
    build_support(&setup.scene, 0, 0), build_mass(&setup.scene, 1, 0, m);
    setup.scene.nodes[1].fixed[1] = true;
    build_member(&setup.scene, STRUT_SPRING, 0, 1, k, 2 * zeta * m * omega, 0);
    find(&setup);
    assert_int_equal(modes.count, 1);
    assert_true(modes.damped_exactly);
    assert_relative(modes.list[0].damping_ratio, zeta, 1e-13);
    double root = sqrt(fabs(1 - zeta * zeta));
    assert_near(modes.list[0].damped_frequency, zeta < 1 ? omega * root : 0, 1e-12 * omega);
    assert_relative(modes.list[0].decay_rate, zeta < 1 ? zeta * omega : omega * (zeta - root),
                    1e-12);
  }
}

/* Two masses in a row, only one of them damped: det(z^2 M + z D + K) = 0 at what is reported. */
TEST(damping_that_couples_modes) {
  const double k[3] = {50, 80, 20}, m[2] = {1, 3}, d = 4;
  OWN(strut_setup) setup = build_setup();
  build_support(&setup.scene, 0, 0), build_mass(&setup.scene, 1, 0, m[0]),
      build_mass(&setup.scene, 2, 0, m[1]);
  build_support(&setup.scene, 3, 0);
  for (int i = 1; i < 3; i++) setup.scene.nodes[i].fixed[1] = true;
  for (int i = 0; i < 3; i++)
    build_member(&setup.scene, STRUT_SPRING, i, i + 1, k[i], i == 0 ? d : 0, 0);
  find(&setup);
  for (size_t i = 0; i < 2; i++) {
    double x = -modes.list[i].decay_rate, y = modes.list[i].damped_frequency;
    double z2[2] = {x * x - y * y, 2 * x * y};
    double a[2] = {m[0] * z2[0] + d * x + k[0] + k[1], m[0] * z2[1] + d * y};
    double b[2] = {m[1] * z2[0] + k[1] + k[2], m[1] * z2[1]};
    assert_all_near(1e-9, a[0] * b[0] - a[1] * b[1], k[1] * k[1], a[0] * b[1] + a[1] * b[0], 0);
    assert_relative(modes.list[i].damping_ratio, -x / hypot(x, y), 1e-12);
  }
  assert_true(modes.list[0].damped_frequency < modes.list[1].damped_frequency);
}

/* Four bars in a square: it may move, turn, and shear. */
TEST(mechanism_beside_rigid_motions) {
  OWN(strut_setup) setup = build_setup();
  for (int i = 0; i < 4; i++)
    build_node(&setup.scene, 5 + (i == 1 || i == 2), i >= 2), setup.scene.nodes[i].mass = 0.2;
  for (int i = 0; i < 4; i++) build_member(&setup.scene, STRUT_BAR, i, (i + 1) % 4, 1e6, 0, 0.1);
  find(&setup);
  assert_all_equal(count_kind(STRUT_MODE_RIGID), 3, count_kind(STRUT_MODE_MECHANISM), 1);
  assert_int_equal(count_kind(STRUT_MODE_ELASTIC), 4);
  assert_int_equal(modes.list[3].kind, STRUT_MODE_MECHANISM);
  assert_non_null(strstr(modes.list[3].description, "no stiffness resists"));
  const double *x = modes.list[3].shape; /* the sides keep their lengths */
  assert_all_near(1e-12, x[0], x[2], x[3], x[5], x[4], x[6], x[7], x[1]);
}

/* A weight on top of a rod falls over: one unstable motion, of the pendulum turned round. */
TEST(unstable) {
  OWN(strut_setup) setup = build_falling();
  build_support(&setup.scene, 0, 0), build_mass(&setup.scene, 0, 2, 3);
  double k = 1e6, down = 3 * 9.81 / k;
  build_sized(&setup.scene, STRUT_BAR, 0, 1, k, 0, 0, 2 + down);
  find_with(&setup, (strut_modes_options){.at = "drawn"});
  assert_int_equal(modes.list[0].kind, STRUT_MODE_UNSTABLE);
  assert_relative(modes.list[0].eigenvalue, -9.81 / 2, 1e-9);
  assert_true(modes.list[0].angular_frequency == 0);
  assert_relative(modes.list[1].eigenvalue, k / 3, 1e-12);
}

/* Frames in a row: 240 coordinates by both ways. */
TEST(sparse_is_dense) {
  OWN(strut_setup) setup = build_setup();
  structure_chain(&setup.scene, 60, STRUT_MASS_CONSISTENT);
  OWN_POINTER(strut_model) kept_model;
  OWN(strut_modes) kept;
  find_with(&setup, (strut_modes_options){.at = "drawn", .count = 12});
  assert_int_equal(modes.coordinates, 240);
  assert_true(modes.dense);
  kept_model = model, kept = modes;
  model = NULL, modes = (strut_modes){0};
  find_with(&setup, (strut_modes_options){.at = "drawn", .count = 12, .sparse = true});
  assert_false(modes.dense);
  assert_int_equal(modes.count, 12);
  for (size_t i = 0; i < 12; i++) {
    assert_relative(modes.list[i].eigenvalue, kept.list[i].eigenvalue, 1e-12);
    double same = 0, size = 0;
    for (int32_t k = 0; k < 2 * model->node_count; k++) {
      same += modes.list[i].shape[k] * kept.list[i].shape[k];
      size += kept.list[i].shape[k] * kept.list[i].shape[k];
    }
    assert_relative(fabs(same), size, 1e-8);
  }
}

/* The sparse way without supports, where K has zeros: rigid motions are named there too. */
TEST(sparse_with_rigid_motions) {
  OWN(strut_setup) setup = build_setup();
  structure_chain(&setup.scene, 30, STRUT_MASS_CONSISTENT);
  for (size_t i = 0; i < setup.scene.node_count; i++)
    setup.scene.nodes[i].fixed[0] = setup.scene.nodes[i].fixed[1] = false,
    setup.scene.nodes[i].mass = 0.1;
  find_with(&setup, (strut_modes_options){.at = "drawn", .count = 8, .sparse = true});
  assert_int_equal(modes.count, 8);
  if (modes.at_rest) assert_int_equal(count_kind(STRUT_MODE_RIGID), 3);
  assert_true(modes.list[7].error < 1e-8);
}

/*
 * Springs of 1 and `stiff` in turn, longitudinal: two masses with soft springs beside stiff pairs. The
 * soft modes are those of the stiff pairs taken as rigid, but for parts of 1 / stiff.
 */
static void check_stiffness_ratio(double stiff, bool known) {
  OWN(strut_setup) setup = build_setup();
  setup.scene.mass_model = STRUT_MASS_LUMPED;
  for (int i = 0; i < 8; i++)
    build_mass(&setup.scene, i, 0, i ? 1 : 0), setup.scene.nodes[i].fixed[1] = true;
  setup.scene.nodes[0].fixed[0] = true;
  for (int i = 0; i < 7; i++)
    build_member(&setup.scene, STRUT_SPRING, i, i + 1, i % 2 ? stiff : 1, 0, 0);
  find(&setup);
  /* Pairs of mass 2 in a chain of 4 soft springs: 3 pairs and a mass of 1 at the end, K = chain. */
  OWN_POINTER(gsl_matrix) k = gsl_matrix_calloc(4, 4), *m = gsl_matrix_calloc(4, 4);
  for (size_t i = 0; i < 4; i++) {
    gsl_matrix_set(k, i, i, i < 3 ? 2 : 1);
    gsl_matrix_set(m, i, i, i < 3 ? 2 : 1);
    if (i < 3) gsl_matrix_set(k, i, i + 1, -1), gsl_matrix_set(k, i + 1, i, -1);
  }
  OWN_POINTER(gsl_vector) value = dense_eigenvalues(k, m);
  for (size_t i = 0; i < 4; i++) {
    const strut_mode *mode = &modes.list[i];
    assert_int_equal(mode->kind, known ? STRUT_MODE_ELASTIC : STRUT_MODE_UNKNOWN);
    if (known) {
      assert_true(mode->error < 1e-9);
      assert_relative(mode->eigenvalue, gsl_vector_get(value, i), mode->error + 10 / stiff);
    } else {
      assert_true(isnan(mode->eigenvalue) && mode->error > 1e-8);
      assert_non_null(strstr(mode->description, "rounding hides its frequency"));
    }
  }
  for (size_t i = 4; i < 7; i++) assert_relative(modes.list[i].eigenvalue, 2 * stiff, 10 / stiff);
}

TEST(stiffness_ratios) {
  check_stiffness_ratio(1e6, true);
  check_stiffness_ratio(1e10, true);
  check_stiffness_ratio(1e12, false);
}

/* Soft cables around bars 1e9 times as stiff: their stretch decides, which is known. */
TEST(stiff_bars_in_soft_cables) {
  x_frame frame = FRAME;
  frame.cable.stiffness = 1, frame.bar.stiffness = 1e9, frame.force_density = 0.1;
  frame.side = 1.0 / 3;
  check_x_frame(&frame, 1e-10);
}

/* A mass in the middle of a stiff string whose tension is some last bits of its length. */
TEST(what_the_last_bits_decide_is_unknown) {
  OWN(strut_setup) setup = build_setup();
  build_support(&setup.scene, -1, 0), build_mass(&setup.scene, 0, 0, 1),
      build_support(&setup.scene, 1, 0);
  for (int i = 0; i < 2; i++)
    build_sized(&setup.scene, STRUT_CABLE, i, i + 1, 1e13, 0, 0, 1 - 1e-13);
  strut_modes_options options = {.at = "drawn"};
  find_with(&setup, options);
  assert_int_equal(modes.list[0].kind, STRUT_MODE_UNKNOWN);
  assert_true(isnan(modes.list[0].angular_frequency) && isnan(modes.list[0].damping_ratio));
  assert_within(modes.list[0].error, 1e-4, 1e-1);
  assert_int_equal(modes.list[1].kind, STRUT_MODE_ELASTIC);
  assert_relative(modes.list[1].eigenvalue, 2e13, 1e-12);
  for (int i = 0; i < 2; i++) setup.scene.members[i].rest_value = 1 - 1e-4; /* a tension of 1e9 N */
  find_with(&setup, options);
  assert_relative(modes.list[0].eigenvalue, 2 * 1e9, 1e-11);
}

/* A node without mass between two springs: condensed, as one spring of half the stiffness. */
TEST(node_without_mass) {
  OWN(strut_setup) setup = build_setup();
  strut_error error = {0};
  build_support(&setup.scene, 0, 0), build_node(&setup.scene, 1, 0),
      build_mass(&setup.scene, 2, 0, 4);
  for (int i = 1; i < 3; i++) setup.scene.nodes[i].fixed[1] = true;
  build_member(&setup.scene, STRUT_SPRING, 0, 1, 30, 0, 0);
  build_member(&setup.scene, STRUT_SPRING, 1, 2, 30, 0, 0);
  strut_modes_options options = {.at = "drawn"};
  find_with(&setup, options);
  assert_int_equal(modes.count, 1);
  assert_all_relative(1e-12, modes.list[0].eigenvalue, 15.0 / 4, modes.list[0].shape[2], 0.5);
  forget();
  setup.scene.nodes[1].fixed[1] = false; /* now it may move sideways, without mass or stiffness */
  assert_ok(strut_model_compile(&setup.scene, &model, &error));
  assert_fails(strut_modes_find(model, &setup.experiment, &options, &modes, &error), STRUT_SINGULAR,
               error, "'n2'");
}

/* The crawler in state I: a bending mode just above the paper's critical band, 8 to 10 Hz. */
TEST(crawler_bends_near_its_critical_band) {
  OWN(strut_setup) setup = build_setup();
  structure_crawler(&setup.scene, 10, 0, 0.1, false);
  find(&setup);
  assert_all_equal(modes.count, 10, modes.closed_count, 2);
  assert_int_equal(modes.list[0].kind, STRUT_MODE_RIGID);
  assert_string_equal(modes.list[0].description, "the structure moves along x");
  assert_near(modes.list[1].angular_frequency / (2 * PI), 10.3851, 1e-4);
  assert_within(modes.list[9].angular_frequency, 1.9e4, 2.1e4); /* the short bars */
  find_with(&setup, (strut_modes_options){.stuck = true});
  assert_int_equal(modes.count, 8);
  assert_near(modes.list[0].angular_frequency / (2 * PI), 19.7826, 1e-4);
}

/* Every refusal of memory is an error without a leak (the sanitizers look at that). */
TEST(out_of_memory) {
  OWN(strut_setup) setup = build_setup();
  structure_x_frame(&setup.scene, &FRAME);
  OWN_POINTER(strut_model) frame = motion_compile(&setup.scene);
  REFUSE_EACH(n, status, 9) {
    OWN(strut_modes) found;
    strut_modes_options options = {.at = "drawn"};
    status = refused(n, strut_modes_find(frame, &setup.experiment, &options, &found, NULL));
  }
}
