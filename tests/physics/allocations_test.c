/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps allocate nothing, whatever the scene needs. */
#include "tests/support/allocations.h"
#include "engine/model/mass.h"
#include "tests/physics/random_scene.h"
#include "tests/support/structures.h"

TEST(the_count_counts) {
  uint64_t before = allocations_so_far();
  void *volatile block = malloc(10);
  assert_non_null(block);
  assert_int_equal(allocations_so_far(), before + 1);
  block = realloc(block, 100000);
  assert_int_equal(allocations_so_far(), before + 2);
  free(block);
  block = calloc(10, 10);
  assert_int_equal(allocations_so_far(), before + 3);
  free(block);
}

static void check_steps(const strut_setup *setup, bool balance) {
  OWN(motion) m = motion_begin(&setup->scene, 1e-5);
  m.state->balance = balance;
  uint64_t before = allocations_so_far(), own = strut_allocation_count();
  motion_steps(&m, 1000);
  assert_all_equal(allocations_so_far(), before, strut_allocation_count(), own, m.state->step, 1000,
                   m.state->latest->evaluations, 4000);
}

/* Everything at once on top of a chain: contacts, friction, drive, loads. */
static strut_setup busy_chain(size_t frames, strut_mass_model mass_model) {
  strut_setup setup = build_falling();
  structure_chain(&setup.scene, frames, mass_model);
  int32_t sine = build_sine(&setup.scene, 1e-3, 12);
  build_actuator(&setup.scene, 1, sine);
  build_load(&setup.scene, 3, 1, 2, sine);
  build_load(&setup.scene, 2, 0, -3, -1);
  setup.scene.ground.height = -0.001, setup.scene.ground.slope = 0.01;
  for (int32_t i = 0; i < (int32_t)setup.scene.node_count; i++)
    build_rough_contact(&setup.scene, i, 1e4, 10, 0.5, 0.3, 1e-3);
  return setup;
}

static void check_kind(size_t frames, strut_mass_model mass_model, bool blocks, bool factor) {
  OWN(strut_setup) setup = busy_chain(frames, mass_model);
  strut_model *model = motion_compile(&setup.scene);
  assert_all_equal(model->mass->coordinate[0].block_count > 0, blocks,
                   model->mass->coordinate[0].factor != NULL, factor, model->mass->diagonal,
                   !blocks && !factor);
  strut_model_free(model);
  check_steps(&setup, false);
  check_steps(&setup, true);
}

TEST(steps_with_a_diagonal_mass_allocate_nothing) {
  check_kind(30, STRUT_MASS_LUMPED, false, false);
}

TEST(steps_with_dense_blocks_allocate_nothing) {
  check_kind(8, STRUT_MASS_CONSISTENT, true, false);
}

TEST(steps_with_a_sparse_factor_allocate_nothing) {
  check_kind(30, STRUT_MASS_CONSISTENT, false, true);
}

TEST(steps_of_random_scenes_allocate_nothing) {
  for (uint64_t seed = 1; seed <= 40; seed++) {
    OWN(strut_setup) setup = build_setup();
    random_scene(&setup.scene, seed);
    check_steps(&setup, seed % 2);
  }
}

static strut_status take_nothing(void *context, const strut_record_layout *layout,
                                 strut_error *error) {
  (void)context;
  (void)layout;
  (void)error;
  return STRUT_OK;
}

static strut_status take_rows(void *context, const double *rows, size_t count, strut_error *error) {
  (void)rows;
  (void)error;
  *(size_t *)context += count;
  return STRUT_OK;
}

static strut_status take_end(void *context, strut_status status, strut_error *error) {
  (void)context;
  (void)status;
  (void)error;
  return STRUT_OK;
}

/* Allocations of a whole run of so many steps, with measuring and a row every 10 steps. */
static uint64_t whole_run(int64_t steps) {
  OWN(strut_summary) summary;
  size_t rows = 0;
  strut_sink sink = {&rows, take_nothing, take_rows, take_end, 0}, *sinks[] = {&sink};
  strut_run_options options = {.sinks = sinks, .sink_count = 1};
  OWN(strut_setup) setup = busy_chain(10, STRUT_MASS_CONSISTENT);
  motion_experiment(&setup, 1e-5, 1e-5 * (double)steps);
  setup.experiment.output_every = 1e-4;
  setup.experiment.channels = 63;
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  uint64_t before = allocations_so_far();
  assert_ok(strut_simulate(model, &setup.experiment, &options, &summary, NULL));
  uint64_t count = allocations_so_far() - before;
  assert_all_equal(summary.spent.steps, steps, rows, steps / 10 + 1);
  return count;
}

TEST(a_longer_run_allocates_no_more) {
  uint64_t before = whole_run(1000);
  assert_true(before > 0);
  assert_int_equal(whole_run(5000), before);
}
