/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Large grids of X-frames that land on the ground: energy, momentum, memory and pace over many steps.
   Arguments: nodes and steps of the large one, steps of one of 1000 nodes, nodes of the largest. */
#include "engine/forces/forces.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/run/measure/measure.h"
#include "tests/support/allocations.h"
#include "tests/support/structures.h"

enum { ROWS = 10, PARTS = 10 };
static int32_t nodes = 2000, largest_nodes = 130000;
static int64_t steps = 1000, many_steps = 4000;
/* A third of the largest stable step; where nodes stick and slip it takes less for the balance. */
static const double STEP = 5e-4, ROUGH_STEP = 1e-4;
static const double HEIGHT = 0.001, FALL = 1.0;

/* A grid of about n nodes that falls at 1 m/s, and drifts where it may slide. */
static strut_setup falling(int32_t n, strut_mass_model mass, double mu) {
  strut_setup setup = build_setup();
  structure_grid(&setup.scene, n / ROWS, ROWS, mass, HEIGHT, 0.2, mu);
  for (size_t i = 0; i < setup.scene.node_count; i++) {
    setup.scene.nodes[i].velocity[0] = 0.3;
    setup.scene.nodes[i].velocity[1] = -FALL;
  }
  return setup;
}

/* Sum of mass times velocity along x, and of its sizes; sums of rods do not hang on the mass model. */
static double momentum(const motion *m, double *size) {
  double sum = 0;
  *size = 0;
  for (int32_t i = 0; i < m->model->node_count; i++) {
    double part = m->model->weight[i] * m->state->v[2 * i];
    sum += part, *size += fabs(part);
  }
  return sum;
}

static double fastest(const motion *m) {
  double most = 0;
  for (int32_t i = 0; i < 2 * m->model->node_count; i++) {
    assert_true(isfinite(m->state->q[i]) && isfinite(m->state->v[i]));
    most = fmax(most, fabs(m->state->v[i]));
  }
  return most;
}

/* Of all that was exchanged [1]; times and losses are in the state's balance. */
static double residual(const motion *m, const strut_energies *begin) {
  strut_energy e;
  strut_balance_fill(m->model, m->state, begin, (double)m->state->step * m->step, &e);
  assert_true(e.dissipated_contact > 0 && e.moved > 0);
  return e.residual / e.moved;
}

static void begin(motion *m, const strut_setup *setup, double step, strut_energies *stored) {
  *m = motion_begin(&setup->scene, step);
  m->state->balance = true;
  strut_energy_reset_load_work(m->model, m->state);
  *stored = strut_energy_evaluate(m->model, m->state, 0);
}

/* Tenth by tenth: what a node and step takes must not grow, nor memory. */
static void march(motion *m, int64_t count) {
  double pace[PARTS], least = HUGE_VAL;
  double unit = 1e9 / ((double)m->model->node_count * (double)(count / PARTS));
  uint64_t calls = 0;
  long memory = 0;
  for (int part = 0; part < PARTS; part++) {
    if (part == 1) calls = allocations_so_far(), memory = resident(); /* all has been touched */
    double start = test_seconds();
    motion_steps(m, count / PARTS);
    pace[part] = (test_seconds() - start) * unit;
    least = fmin(least, pace[part]);
  }
  assert_true(allocations_so_far() == calls);
  assert_in_range((uint64_t)resident(), 0, (uint64_t)memory);
  print_message(
      "  ns per node and step: %.0f in the first tenth, %.0f in the last, %.0f at least\n", pace[0],
      pace[PARTS - 1], least);
}

static void land(int32_t n, int64_t count, strut_mass_model mass, double mu) {
  OWN(motion) m;
  strut_energies stored;
  double size, start = test_seconds();
  OWN(strut_setup) setup = falling(n, mass, mu);
  begin(&m, &setup, mu > 0 ? ROUGH_STEP : STEP, &stored);
  double before = momentum(&m, &size);
  print_message("%s mass, friction %g, %d nodes, %zu members, %lld steps; made in %.2f s\n",
                mass == STRUT_MASS_LUMPED ? "lumped" : "consistent", mu, (int)n,
                setup.scene.member_count, (long long)count, test_seconds() - start);
  march(&m, count);
  double after = momentum(&m, &size), left = residual(&m, &stored), speed = fastest(&m);
  print_message("  residual %.1e of the energy moved, fastest %.2f m/s, momentum changed by %.1e\n",
                left, speed, (after - before) / before);
  assert_all(fabs(left) < (mu > 0 ? 5e-2 : 5e-3), speed < 20 * FALL);
  /* each step and node rounds by half a unit, at random */
  if (!(mu > 0))
    assert_true(fabs(after - before) < 1e-13 * before * sqrt((double)count));
  else
    assert_true(fabs(after) < 0.9 * before);
}

BEFORE_ALL {
  nodes = (int32_t)test_number(1, nodes);
  steps = (int64_t)test_number(2, (double)steps);
  many_steps = (int64_t)test_number(3, (double)many_steps);
  largest_nodes = (int32_t)test_number(4, largest_nodes);
}

TEST(many_nodes) {
  land(nodes, steps, STRUT_MASS_LUMPED, 0);
  land(nodes, steps, STRUT_MASS_LUMPED, 0.3);
  land(nodes, steps, STRUT_MASS_CONSISTENT, 0.3);
}

TEST(many_steps) {
  land(1000, many_steps, STRUT_MASS_LUMPED, 0);
  land(1000, many_steps, STRUT_MASS_CONSISTENT, 0);
}

/* Grids beside each other in one scene, each where the one alone is, know nothing of each other. */
TEST(copies) {
  enum { COPIES = 50, EACH = 100 };
  OWN(strut_setup) one, all;
  strut_setup_init(&all);
  for (int copy = 0; copy < COPIES; copy++) {
    structure_grid(&all.scene, EACH / ROWS, ROWS, STRUT_MASS_LUMPED, HEIGHT, 0.2, 0.3);
    for (size_t j = all.scene.member_count / (size_t)(copy + 1) * (size_t)copy;
         j < all.scene.member_count; j++)
      for (int end = 0; end < 2; end++) all.scene.members[j].node[end] += copy * EACH;
    for (int32_t i = 0; i < EACH; i++)
      all.scene.contacts[copy * EACH + i].node = all.scene.contacts[i].node + copy * EACH;
  }
  strut_setup_init(&one);
  structure_grid(&one.scene, EACH / ROWS, ROWS, STRUT_MASS_LUMPED, HEIGHT, 0.2, 0.3);
  OWN(motion) a = motion_begin(&one.scene, STEP);
  OWN(motion) b = motion_begin(&all.scene, STEP);
  motion_steps(&a, 400), motion_steps(&b, 400);
  for (int32_t copy = 0; copy < COPIES; copy++)
    for (int32_t i = 0; i < 2 * EACH; i++) {
      assert_same_bits(b.state->q[2 * copy * EACH + i], a.state->q[i]);
      assert_same_bits(b.state->v[2 * copy * EACH + i], a.state->v[i]);
    }
}

/* A step above the limit is refused, and the one reported in its place is below. */
static void refuse_above(strut_setup *setup, const strut_model *model, double limit) {
  strut_run_options options = {0};
  strut_summary summary;
  strut_error error = {0};
  setup->experiment.step = 1.001 * limit;
  assert_int_equal(strut_simulate(model, &setup->experiment, &options, &summary, &error),
                   STRUT_STEP_TOO_LARGE);
  strut_summary_free(&summary);
  const char *reported = strstr(error.message, "solver.step <= ");
  assert_non_null(reported);
  assert_within(strtod(reported + strlen("solver.step <= "), NULL), 0.85 * limit, limit);
}

/* Compiled, its step limited, and a few steps taken by the run itself. */
static void take_largest(strut_mass_model mass) {
  strut_summary summary;
  strut_step_limit limit;
  OWN(strut_setup) setup = falling(largest_nodes, mass, 0.3);
  motion_experiment(&setup, STEP, 10 * STEP);
  double start = test_seconds();
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  double compiled = test_seconds() - start;
  assert_ok(strut_step_limit_estimate(model, &limit, NULL));
  double bounded = test_seconds() - start - compiled;
  assert_ok(strut_simulate(model, &setup.experiment, &(strut_run_options){0}, &summary, NULL));
  print_message(
      "%s mass, %d nodes, %zu members: compiled in %.2f s, largest step in %.2f s "
      "(%.4g s), 10 steps in %.2f s, peak memory %.0f MB\n",
      mass == STRUT_MASS_LUMPED ? "lumped" : "consistent", (int)largest_nodes,
      setup.scene.member_count, compiled, bounded, limit.limit,
      test_seconds() - start - compiled - bounded, (double)resident() * 1024e-6);
  /* 1.68 ms and 1.11 ms, which smaller grids of the kind are found to have */
  assert_within(limit.limit, mass == STRUT_MASS_LUMPED ? 1.66e-3 : 1.10e-3,
                mass == STRUT_MASS_LUMPED ? 1.70e-3 : 1.12e-3);
  assert_true(fabs(summary.energy.residual) < 1e-3 * summary.energy.moved);
  strut_summary_free(&summary);
  refuse_above(&setup, model, limit.limit);
}

TEST(the_largest) {
  take_largest(STRUT_MASS_LUMPED);
  take_largest(STRUT_MASS_CONSISTENT);
}
