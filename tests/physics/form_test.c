/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Form finding: shapes from densities and lengths, rest lengths from prestress, and that they hold. */
#include "engine/statics/form/form.h"
#include "tests/support/motion.h"

static strut_status find(strut_setup *setup, strut_form_options options, strut_form *form,
                         strut_error *error) {
  strut_status status = strut_form_find(setup, &options, form, error);
  if (status && !error->message[0]) fail_msg("a refusal without a sentence");
  return status;
}

static strut_form form_of(strut_setup *setup, strut_form_options options) {
  strut_form form;
  strut_error error = {0};
  strut_status status = find(setup, options, &form, &error);
  if (status) print_error("%s\n", error.message);
  assert_ok(status);
  return form;
}

/* Force of a member as the scene starts. */
static double force_of(const strut_setup *setup, size_t j) {
  strut_rest rest;
  const strut_member *m = &setup->scene.members[j];
  const double *a = setup->scene.nodes[m->node[0]].start, *b = setup->scene.nodes[m->node[1]].start;
  assert_true(strut_member_rest(&setup->scene, j, &rest));
  return rest.stiffness * (hypot(b[0] - a[0], b[1] - a[1]) - rest.length);
}

static double length_of(const strut_setup *setup, size_t j) {
  const strut_member *m = &setup->scene.members[j];
  const double *a = setup->scene.nodes[m->node[0]].start, *b = setup->scene.nodes[m->node[1]].start;
  return hypot(b[0] - a[0], b[1] - a[1]);
}

/* Runs the scene's own experiment step by step; no node may leave its place by 1e-9 of `size`. */
static void check_holds(const strut_setup *setup, double size) {
  const strut_experiment *e = &setup->experiment;
  assert_true(e->duration >= 10 && e->step > 0);
  OWN(motion) m = motion_begin(&setup->scene, e->step);
  for (int part = 0; part < 50; part++) {
    motion_steps(&m, (int64_t)(e->duration / e->step / 50));
    for (size_t i = 0; i < 2 * setup->scene.node_count; i++)
      assert_near(m.state->q[i], setup->scene.nodes[i / 2].start[i % 2], 1e-9 * size);
  }
}

static void give_density(strut_setup *setup, int32_t member, double density) {
  setup->scene.members[member].rest_kind = STRUT_REST_FORCE_DENSITY;
  setup->scene.members[member].rest_value = density;
}

/* A cable net between supports with weights: sum of q (x_j - x_i) + f = 0 at every free node. */
TEST(net) {
  OWN(strut_setup) setup = build_falling();
  int32_t a = build_support(&setup.scene, 0, 0), b = build_mass(&setup.scene, 1, 0, 0.1);
  int32_t c = build_mass(&setup.scene, 2, 0, 0.2), d = build_support(&setup.scene, 3, 0.5);
  int32_t e = build_support(&setup.scene, 1.5, -1);
  const int32_t ends[4][2] = {{a, b}, {b, c}, {c, d}, {b, e}};
  const double density[4] = {10, 8, 10, 3};
  for (int j = 0; j < 4; j++)
    give_density(&setup, build_member(&setup.scene, STRUT_CABLE, ends[j][0], ends[j][1], 500, 0, 0),
                 density[j]);
  strut_form form = form_of(&setup, (strut_form_options){0});
  assert_int_equal(form.from, STRUT_FORM_DENSITIES);
  assert_true(form.density_change == 0 && form.run_added && !form.massless);
  /* by hand: [21 -8; -8 18] x = right */
  double right[2][2] = {{10 * 0 + 3 * 1.5, 10 * 3}, {3 * -1 - 0.981, 10 * 0.5 - 1.962}};
  for (int k = 0; k < 2; k++) {
    double det = 21.0 * 18 - 64, *r = right[k];
    assert_near(setup.scene.nodes[b].start[k], (18 * r[0] + 8 * r[1]) / det, 1e-12);
    assert_near(setup.scene.nodes[c].start[k], (8 * r[0] + 21 * r[1]) / det, 1e-12);
  }
  for (size_t j = 0; j < 4; j++)
    assert_relative(force_of(&setup, j) / length_of(&setup, j), density[j], 1e-10);
  check_holds(&setup, 3);
}

/* A hexagon of cables (q) and diagonals (-q / 2), drawn badly; standing by itself. */
static strut_setup hexagon(double diagonal) {
  static const double drawn[6][2] = {{1.02, 0.03}, {0.5, 0.9},   {-0.45, 0.8},
                                     {-1.1, 0},    {-0.5, -0.9}, {0.5, -0.8}};
  strut_setup setup = build_setup();
  for (int i = 0; i < 6; i++) build_mass(&setup.scene, drawn[i][0], drawn[i][1], 1);
  for (int i = 0; i < 6; i++)
    give_density(&setup, build_member(&setup.scene, STRUT_CABLE, i, (i + 1) % 6, 100, 0, 0), 1);
  for (int i = 0; i < 3; i++)
    give_density(&setup, build_member(&setup.scene, STRUT_BAR, i, i + 3, 1000, 0, 0), diagonal);
  return setup;
}

TEST(standing_hexagon) {
  for (int i = 0; i < 2; i++) {
    double diagonal = i ? -0.4 : -0.5, q[9];
    OWN(strut_setup) setup = hexagon(diagonal);
    strut_form form = form_of(&setup, (strut_form_options){0});
    for (size_t j = 0; j < 9; j++) q[j] = force_of(&setup, j) / length_of(&setup, j);
    /* nearest to (1 x 6, diagonal x 3) along (1 x 6, -1/2 x 3) */
    double share = (6 - 1.5 * diagonal) / 6.75;
    for (size_t j = 0; j < 9; j++) assert_near(q[j], j < 6 ? share : -0.5 * share, 1e-9);
    assert_near(form.density_change, fmax(fabs(share - 1), fabs(-0.5 * share - diagonal)), 1e-12);
    /* an affine image of the regular one: opposite sides are parallel and alike, the centre stays */
    for (int k = 0; k < 2; k++) {
      double sum = 0;
      for (size_t n = 0; n < 6; n++) sum += setup.scene.nodes[n].position[k] / 6;
      assert_near(sum, k ? 0.005 : -0.005, 1e-12);
      for (size_t n = 0; n < 3; n++) {
        double side = setup.scene.nodes[n + 1].position[k] - setup.scene.nodes[n].position[k];
        double other =
            setup.scene.nodes[(n + 4) % 6].position[k] - setup.scene.nodes[n + 3].position[k];
        assert_near(side, -other, 1e-12);
      }
    }
    check_holds(&setup, 2);
  }
}

/* Four cables and two bars, not square, with weight: on supports, or standing on the ground. */
static void frame(strut_setup *setup, bool ground) {
  strut_setup_init(setup);
  setup->scene.gravity[1] = -9.81;
  static const double drawn[4][2] = {{0, 0}, {1, 0}, {1.2, 1}, {0, 0.8}};
  for (int32_t i = 0; i < 4; i++) {
    build_mass(&setup->scene, drawn[i][0], drawn[i][1], 0.1);
    if (ground) build_contact(&setup->scene, i, 1e5, 10);
  }
  for (int i = 0; i < 4; i++) build_member(&setup->scene, STRUT_CABLE, i, (i + 1) % 4, 1000, 0, 0);
  for (int i = 0; i < 2; i++) build_member(&setup->scene, STRUT_BAR, i, i + 2, 1e5, 0, 0.2);
  if (ground) return;
  setup->scene.nodes[0].fixed[0] = setup->scene.nodes[0].fixed[1] = setup->scene.nodes[1].fixed[1] =
      true;
}

static void check_prestress(strut_form_objective objective, bool ground) {
  const double least = 3;
  OWN(strut_setup) setup;
  frame(&setup, ground);
  strut_form form =
      form_of(&setup, (strut_form_options){.objective = objective, .least_tension = least});
  double smallest = HUGE_VAL;
  assert_int_equal(form.from, STRUT_FORM_PRESTRESS);
  assert_true(form.moved == 0);
  for (size_t j = 0; j < 4; j++) smallest = fmin(smallest, force_of(&setup, j));
  assert_relative(smallest, least, 1e-8); /* s = 1: the one freedom is used up by a bound */
  for (size_t i = 0; i < 4; i++)          /* weight on two feet, on springs of 1e5 N/m */
    assert_near(setup.scene.nodes[i].start[1], setup.scene.nodes[i].position[1],
                ground && i < 2 ? 0.8 * 9.81 / 1e5 : 1e-12);
  check_holds(&setup, 1.2);
}

TEST(prestress_under_weight) {
  for (int objective = 0; objective < 3; objective++)
    for (int ground = 0; ground < 2; ground++)
      check_prestress((strut_form_objective)objective, ground);
}

/* The shape of lengths that fit together is the one drawn from them; of those that do not, rest. */
TEST(lengths) {
  OWN(strut_setup) setup;
  frame(&setup, false);
  setup.scene.gravity[1] = 0;
  for (size_t j = 0; j < 6; j++) {
    setup.scene.members[j].rest_kind = STRUT_REST_LENGTH;
    setup.scene.members[j].rest_value = length_of(&setup, j);
  }
  for (size_t i = 2; i < 4; i++)
    setup.scene.nodes[i].start[0] += 0.03, setup.scene.nodes[i].start[1] -= 0.02;
  strut_form form = form_of(&setup, (strut_form_options){0});
  assert_int_equal(form.from, STRUT_FORM_LENGTHS);
  assert_near(form.moved, 0, 1e-12);
  for (size_t j = 0; j < 4; j++) setup.scene.members[j].rest_value *= 0.95;
  form_of(&setup, (strut_form_options){0});
  for (size_t i = 0; i < 2 * 4; i++)
    assert_same_bits(setup.scene.nodes[i / 2].position[i % 2],
                     setup.scene.nodes[i / 2].start[i % 2]);
  for (size_t j = 0; j < 4; j++) assert_true(force_of(&setup, j) > 10);
  check_holds(&setup, 1.2);
}

TEST(refusals) {
  strut_setup setup;
  strut_form form;
  strut_error error = {0};
  frame(&setup, false);
  for (int i = 0; i < 4; i++) setup.scene.nodes[i].fixed[0] = setup.scene.nodes[i].fixed[1] = false;
  assert_fails(find(&setup, (strut_form_options){0}, &form, &error), STRUT_NOT_SETTLED, error,
               "at n1, n2, n3 and n4");
  strut_setup_free(&setup);
  frame(&setup, false);
  setup.scene.members[5].node[1] = 0,
  setup.scene.members[5].node[0] = 2;        /* the same bar, told backwards */
  setup.scene.members[4].kind = STRUT_CABLE; /* and nothing to push n2 from n4 */
  assert_int_equal(find(&setup, (strut_form_options){0}, &form, &error), STRUT_NOT_SETTLED);
  strut_setup_free(&setup);
  setup = hexagon(-0.5); /* cables that push */
  setup.scene.members[0].rest_value = -1;
  assert_fails(find(&setup, (strut_form_options){0}, &form, &error), STRUT_NOT_SETTLED, error,
               "cables only pull");
  strut_setup_free(&setup);
  setup = hexagon(-0.5); /* held by its diagonals pulling: it folds */
  for (int32_t j = 0; j < 9; j++) setup.scene.members[j].kind = STRUT_SPRING;
  for (int32_t j = 0; j < 9; j++) setup.scene.members[j].rest_value *= -1;
  assert_fails(find(&setup, (strut_form_options){0}, &form, &error), STRUT_NOT_SETTLED, error,
               "not stable");
  strut_setup_free(&setup);
}

TEST(memory) {
  REFUSE_EACH(n, status, 20) {
    OWN(strut_setup) setup;
    strut_form form;
    strut_form_options options = {.objective = STRUT_FORM_SQUARES};
    if (n % 2)
      frame(&setup, true);
    else
      setup = hexagon(-0.4);
    status = refused(n, strut_form_find(&setup, &options, &form, NULL));
  }
}
