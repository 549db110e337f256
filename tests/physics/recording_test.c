/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows for sinks: which, when, what; sinks that fail; and a run that is refused memory. */
#include "engine/forces/forces.h"
#include "tests/support/structures.h"

enum { MOST_ROWS = 2000, MOST_WIDTH = 300 };

/* A sink that remembers, and fails where it is told to. */
typedef struct memory {
  int begun, ended;
  strut_status ended_with;
  size_t width, count, calls;
  size_t offset[6], items[6], components[6];
  unsigned channels; /* bits, in the order they came */
  size_t channel_count;
  double row[MOST_ROWS][MOST_WIDTH];
  strut_status fail_begin, fail_rows, fail_end;
} memory;

static strut_status begin(void *context, const strut_record_layout *layout, strut_error *error) {
  memory *m = context;
  if (m->fail_begin) return strut_fail(error, m->fail_begin, "begin fails");
  m->begun++;
  m->width = layout->width;
  m->channel_count = layout->channel_count;
  assert_true(m->width <= MOST_WIDTH);
  for (size_t k = 0; k < layout->channel_count; k++) {
    const strut_record_channel *c = &layout->channels[k];
    m->channels |= (unsigned)c->id;
    m->offset[k] = c->offset, m->items[k] = c->items, m->components[k] = c->components;
    assert_true(c->name[0] && c->unit[0] && c->item_names[0] && c->component_names[0]);
  }
  return STRUT_OK;
}

static strut_status rows(void *context, const double *data, size_t count, strut_error *error) {
  memory *m = context;
  m->calls++;
  for (size_t i = 0; i < count && m->count < MOST_ROWS; i++, m->count++)
    memcpy(m->row[m->count], data + i * m->width, m->width * sizeof *data);
  return m->fail_rows ? strut_fail(error, m->fail_rows, "rows fail") : STRUT_OK;
}

static strut_status end(void *context, strut_status status, strut_error *error) {
  memory *m = context;
  m->ended++;
  m->ended_with = status;
  return m->fail_end ? strut_fail(error, m->fail_end, "end fails") : STRUT_OK;
}

static memory first, second;
static unsigned first_wants, second_wants; /* channels of their own */

static strut_error error; /* of the latest run */

static strut_status run(const strut_setup *setup) {
  strut_sink sinks[] = {{&first, begin, rows, end, first_wants},
                        {&second, begin, rows, end, second_wants}};
  strut_sink *all[] = {&sinks[0], &sinks[1]};
  strut_run_options options = {.sinks = all, .sink_count = 2, .force = true};
  OWN(strut_summary) summary;
  error = (strut_error){0};
  strut_status status = motion_try(setup, options, &summary, &error);
  assert_int_equal(summary.status, status);
  return status;
}

static void clean(void) {
  memset(&first, 0, sizeof first);
  memset(&second, 0, sizeof second);
  first_wants = second_wants = 0;
}

BEFORE_EACH { clean(); }

/* x = 1 + 0.5 t for the mass, which nothing moves; its mean is measured. */
static strut_setup gliding(double step, double duration, double every) {
  strut_setup setup = build_tethered(1, 0, 1);
  build_sized(&setup.scene, STRUT_CABLE, 0, 1, 10, 1, 0, 1000);
  setup.scene.nodes[1].velocity[0] = 0.5;
  motion_experiment(&setup, step, duration);
  setup.experiment.output_every = every;
  static strut_instruction x = {.operation = STRUT_OPERATION_COLUMN,
                                .column = {STRUT_COLUMN_NODE_X, 1, -1}};
  static strut_quantity_definition mean = {.name = "x", .length = 1, .depth = 1, .program = &x};
  setup.experiment.quantities = &mean, setup.experiment.quantity_count = 1;
  return setup;
}

/* With all its channels. */
static strut_setup crawler(double step, double duration, double every) {
  strut_setup setup = build_setup();
  structure_crawler(&setup.scene, 10, 1e-4, 0.1, false);
  motion_experiment(&setup, step, duration);
  setup.experiment.output_every = every, setup.experiment.channels = 63;
  return setup;
}

static void check_rows(double step, double duration, double last, double every, size_t count) {
  clean();
  OWN(strut_setup) setup = gliding(step, duration, every);
  setup.experiment.output_last = last;
  assert_ok(run(&setup));
  assert_all_equal(first.count, count, first.width, 1 + 4 + 1 + 1, first.channels,
                   STRUT_CHANNEL_POSITION | STRUT_CHANNEL_LENGTH | STRUT_CHANNEL_FORCE);
  assert_true(first.begun == 1 && first.ended == 1 && first.ended_with == STRUT_OK);
  assert_memory_equal(first.row, second.row, sizeof first.row);
  double start = last > 0 ? duration - last : 0;
  for (size_t i = 0; i < count; i++) {
    const double *row = first.row[i];
    assert_near(row[0], fmin(start + (double)i * every, duration), 1e-12);
    assert_near(row[first.offset[0] + 2], 1 + 0.5 * row[0], 1e-12 + 1e-10 * row[0]);
    assert_near(row[first.offset[1]], 1 + 0.5 * row[0], 1e-12 + 1e-10 * row[0]);
    assert_true(row[first.offset[2]] == 0);
  }
}

TEST(rows_come_at_their_times) {
  check_rows(1e-3, 1, 0, 0.01, 101);
  check_rows(1e-3, 1, 0, 0.0025, 401);  /* between steps */
  check_rows(0.01, 1, 0, 0.0007, 1430); /* many in a step */
  check_rows(1e-3, 1, 0.2, 0.01, 21);   /* the last 0.2 s only */
  check_rows(0.01, 1, 0, 0.3, 5);       /* 0, 0.3, 0.6, 0.9, and the end */
  check_rows(1e-4, 110, 1, 1 / 7.3, 9); /* far from 0 */
}

TEST(rows_are_a_thousandth_apart_if_nothing_is_said) {
  OWN(strut_setup) setup = gliding(1e-4, 2, 0);
  assert_ok(run(&setup));
  assert_int_equal(first.count, 1001);
  assert_near(first.row[1][0], 0.002, 1e-15);
}

/* A thousandth of the time is less than a step: each step once. */
TEST(no_step_is_recorded_twice) {
  OWN(strut_setup) setup = gliding(0.01, 1, 0);
  assert_ok(run(&setup));
  assert_int_equal(first.count, 101);
  for (size_t i = 0; i < 101; i++) assert_near(first.row[i][0], 0.01 * (double)i, 1e-14);
}

/* Every channel of the crawler against the state that a motion by hand has at the same step. */
TEST(every_channel_holds_what_it_says) {
  OWN(strut_setup) setup = crawler(1e-4, 0.1, 0.01);
  assert_ok(run(&setup));
  assert_all_equal(first.channel_count, 6, first.count, 11);
  assert_int_equal(first.width, 1 + 10 + 10 + 9 + 9 + 10 + 11);
  OWN(motion) m = motion_begin(&setup.scene, 1e-4);
  m.state->balance = true;
  for (size_t i = 0; i < first.count; i++) {
    const double *row = first.row[i], *energy = row + first.offset[5];
    double length[9], force[9];
    strut_forces_evaluate(m.model, m.state, row[0], m.state->q, m.state->v);
    motion_members(m.model, m.state, length, force);
    strut_energies stored = strut_energy_evaluate(m.model, m.state, row[0]);
    assert_memory_equal(row + first.offset[0], m.state->q, 10 * sizeof *row);
    assert_memory_equal(row + first.offset[1], m.state->v, 10 * sizeof *row);
    assert_memory_equal(row + first.offset[2], length, sizeof length);
    assert_memory_equal(row + first.offset[3], force, sizeof force);
    for (int c = 0; c < 5; c++) {
      assert_same_bits(row[first.offset[4] + 2 * (size_t)c], m.state->latest->normal[c]);
      assert_same_bits(row[first.offset[4] + 2 * (size_t)c + 1], m.state->latest->friction[c]);
      if (m.state->q[2 * c + 1] >= 0) assert_true(m.state->latest->normal[c] == 0);
    }
    assert_same_bits(energy[0], stored.kinetic);
    assert_same_bits(energy[1], stored.elastic);
    assert_same_bits(energy[4], m.state->work[STRUT_POWER_DRIVE]);
    assert_same_bits(energy[10], m.state->work[STRUT_POWER_FRICTION]);
    motion_steps(&m, 100);
  }
}

/* Columns of a part that are those of the whole. */
static void check_part(const memory *part, const memory *whole, strut_channels channels) {
  assert_all_equal(part->channels, channels, part->count, whole->count);
  for (size_t k = 0, w = 0; k < part->channel_count; k++, w++) {
    while (!(channels & 1u << w)) w++; /* the k-th of its bits is the w-th of all six */
    size_t size = part->items[k] * part->components[k];
    assert_int_equal(size, whole->items[w] * whole->components[w]);
    assert_true(part->offset[k] > (k ? part->offset[k - 1] : 0) &&
                part->offset[k] + size <= part->width);
    for (size_t i = 0; i < part->count; i++) {
      assert_same_bits(part->row[i][0], whole->row[i][0]);
      assert_memory_equal(part->row[i] + part->offset[k], whole->row[i] + whole->offset[w],
                          size * sizeof(double));
    }
  }
}

/* A sink may want channels that the scene does not record, and changes nothing for the others. */
TEST(each_sink_gets_the_channels_it_wants) {
  static const unsigned pairs[][2] = {
      {STRUT_CHANNEL_POSITION | STRUT_CHANNEL_CONTACT, 0},
      {0, STRUT_CHANNEL_VELOCITY},
      {STRUT_CHANNEL_ENERGY, STRUT_CHANNEL_FORCE | STRUT_CHANNEL_LENGTH | STRUT_CHANNEL_CONTACT},
      {63, STRUT_CHANNEL_POSITION}};
  static memory whole;
  OWN(strut_setup) setup = crawler(1e-4, 0.1, 5e-4);
  assert_ok(run(&setup));
  whole = first;
  assert_int_equal(whole.count, 201);
  setup.experiment.channels = STRUT_CHANNEL_FORCE | STRUT_CHANNEL_ENERGY;
  for (size_t p = 0; p < sizeof pairs / sizeof *pairs; p++) {
    clean();
    first_wants = pairs[p][0], second_wants = pairs[p][1];
    assert_ok(run(&setup));
    check_part(&first, &whole, pairs[p][0] ? pairs[p][0] : setup.experiment.channels);
    check_part(&second, &whole, pairs[p][1] ? pairs[p][1] : setup.experiment.channels);
  }
}

TEST(so_many_samples_in_a_step_are_a_mistake) {
  OWN(strut_setup) setup = gliding(0.01, 1, 1e-9);
  assert_fails(run(&setup), STRUT_USAGE, error, "100000");
}

/* Recording looks on: a run with sinks ends with the bits of one without, by any method, measured or not. */
TEST(recording_changes_no_bit) {
  const double every[] = {0.03, 0.00031, 0.0000165};
  for (size_t i = 0; strut_integrator_at(i); i++) {
    if (strut_integrator_at(i)->no_ground) continue;
    OWN(strut_setup) setup = crawler(2e-5, 0.03, 0);
    setup.experiment.channels = 0;
    setup.experiment.integrator = strut_integrator_at(i)->name;
    OWN(strut_summary) alone = motion_simulate(&setup);
    for (size_t k = 0; k < sizeof every / sizeof *every; k++) {
      clean();
      setup.experiment.output_every = every[k], setup.experiment.channels = 63;
      assert_ok(run(&setup));
      assert_memory_equal(first.row[first.count - 1] + 1, alone.end.positions, 10 * sizeof(double));
    }
  }
}

/* A mass falls onto a spring: a parabola, then a cosine, whichever steps the touchdown is in. */
TEST(samples_between_steps_do_not_reach_across_a_touchdown) {
  const double g = 9.81, k = 4e4, mass = 1, height = 0.1, w = sqrt(k / mass);
  const double touch = sqrt(2 * height / g), speed = g * touch, sag = mass * g / k;
  static const char *const methods[] = {"rk4-events", "adaptive"};
  for (int i = 0; i < 2; i++) {
    OWN(strut_setup) setup = build_falling();
    clean();
    build_contact(&setup.scene, build_mass(&setup.scene, 0, height, mass), k, 0);
    motion_experiment_by(&setup, 1e-3, touch + 0.01, methods[i]);
    setup.experiment.tolerance = 1e-9;
    setup.experiment.output_every = 1.7e-4;
    setup.experiment.channels = STRUT_CHANNEL_POSITION | STRUT_CHANNEL_VELOCITY |
                                STRUT_CHANNEL_CONTACT | STRUT_CHANNEL_ENERGY;
    assert_ok(run(&setup));
    for (size_t r = 0; r < first.count; r++) {
      double t = first.row[r][0], s = fmax(0, t - touch), c = cos(w * s), n = sin(w * s);
      double y = s > 0 ? -sag + sag * c - speed / w * n : height - 0.5 * g * t * t;
      double v = s > 0 ? -w * sag * n - speed * c : -g * t;
      assert_all_near(2e-7, first.row[r][2], y);
      assert_near(first.row[r][4], v, 2e-4);
      assert_near(first.row[r][5], s > 0 ? -k * y : 0, 1e-2);
    }
  }
}

TEST(a_sink_that_fails_stops_the_run) {
  OWN(strut_setup) setup = gliding(1e-3, 1e4, 1e-3); /* ten million rows if nobody stops it */
  second.fail_rows = STRUT_FILE_TROUBLE;
  assert_fails(run(&setup), STRUT_FILE_TROUBLE, error, "rows fail");
  assert_int_equal(second.calls, 1);
  assert_true(first.ended == 1 && second.ended == 1);
  assert_int_equal(first.ended_with, STRUT_FILE_TROUBLE);
}

TEST(a_sink_that_cannot_begin) {
  OWN(strut_setup) setup = gliding(1e-3, 1, 0.1);
  second.fail_begin = STRUT_FILE_TROUBLE;
  assert_fails(run(&setup), STRUT_FILE_TROUBLE, error, "begin fails");
  assert_true(first.begun == 1 && first.ended == 1 && first.ended_with == STRUT_FILE_TROUBLE);
  assert_true(second.ended == 0 && first.count == 0);
}

TEST(a_sink_that_cannot_end) {
  OWN(strut_setup) setup = gliding(1e-3, 1, 0.1);
  first.fail_end = STRUT_FILE_TROUBLE;
  assert_fails(run(&setup), STRUT_FILE_TROUBLE, error, "end fails");
  assert_true(first.ended == 1 && second.ended == 1 && second.count == 11);
}

/* What was recorded before a divergence is handed over, and marked. */
TEST(rows_of_a_run_that_diverges_are_kept) {
  OWN(strut_setup) setup = gliding(0.01, 1000, 0.01);
  setup.scene.members[0].kind = STRUT_BAR, setup.scene.members[0].rest_value = 1;
  setup.scene.members[0].stiffness = 2e5; /* w dt = 4.5 */
  assert_fails(run(&setup), STRUT_DIVERGED, error, "n2");
  assert_int_equal(first.ended_with, STRUT_DIVERGED);
  assert_true(first.count > 2 && first.count < 200);
  assert_near(first.row[1][0], 0.01, 1e-15);
}

/* Everything that asks for memory: blocks, a factor, contacts, drives, loads, settling, sinks. */
static strut_setup demanding(void) {
  strut_setup setup = build_setup();
  structure_chain(&setup.scene, 12, STRUT_MASS_CONSISTENT);
  setup.scene.nodes[0].fixed[0] = false; /* x and y differ */
  int32_t a = build_mass(&setup.scene, 3, 3, 1), b = build_node(&setup.scene, 4, 3),
          c = build_node(&setup.scene, 4, 4);
  build_member(&setup.scene, STRUT_BAR, a, b, 1e3, 10, 1);
  build_member(&setup.scene, STRUT_BAR, b, c, 1e3, 10, 1);
  build_actuator(&setup.scene, 3, build_sine(&setup.scene, 1e-4, 10));
  build_load(&setup.scene, b, 1e-3, 0, 0);
  for (int32_t i = 0; i < 10; i++) build_rough_contact(&setup.scene, i, 10, 1, 0.1, 0.1, 1e-3);
  setup.scene.ground.height = -1;
  setup.experiment.settle.wanted = true;
  setup.experiment.settle.speed = setup.experiment.settle.acceleration =
      1e9; /* at rest from the first step on */
  motion_experiment(&setup, 1e-5, 1e-3);
  return setup;
}

static strut_status compile_and_run(const strut_setup *setup) {
  strut_sink sink = {&first, begin, rows, end, 0}, *all[] = {&sink};
  strut_run_options options = {.sinks = all, .sink_count = 1};
  OWN_POINTER(strut_model) model = NULL;
  OWN(strut_summary) summary = {0};
  strut_status status = strut_model_compile(&setup->scene, &model, &error);
  if (!status) status = strut_simulate(model, &setup->experiment, &options, &summary, &error);
  if (!status) assert_int_equal(summary.spent.steps, 100);
  return status;
}

TEST(every_allocation_may_fail) {
  OWN(strut_setup) setup = demanding();
  REFUSE_EACH(n, status, 31) {
    error = (strut_error){0};
    clean();
    status = refused(n, compile_and_run(&setup));
    assert_int_equal(first.begun, first.ended);
    if (status) assert_true(error.message[0]);
  }
}

/* A block that exact friction holds against a push: what is recorded is what holds it. */
TEST(contact_forces_of_methods_with_events) {
  static const char *const methods[] = {"rk4-events", "verlet-events", "euler-events", "adaptive"};
  const double mass = 2, g = 9.81, k = 1e4, push = 0.2 * mass * g;
  for (int i = 0; i < 4; i++) {
    OWN(strut_setup) setup = build_falling();
    clean();
    build_contact(&setup.scene, build_mass(&setup.scene, 0, -mass * g / k, mass), k, 10);
    setup.scene.contacts[0].friction =
        (strut_friction){.law = STRUT_FRICTION_COULOMB, .mu_static = 0.5, .mu_kinetic = 0.4};
    build_load(&setup.scene, 0, push, 0, -1);
    motion_experiment_by(&setup, 1e-3, 0.1, methods[i]);
    setup.experiment.output_every = 0.01;
    setup.experiment.channels = STRUT_CHANNEL_CONTACT;
    assert_ok(run(&setup));
    assert_true(first.count == 11 && first.width == 3);
    for (size_t r = 0; r < first.count; r++)
      assert_all_near(1e-9, first.row[r][1], mass * g, first.row[r][2], -push);
  }
}
