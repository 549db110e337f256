/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Simulations: the steps of a run however they are divided, snapshots that go on with the same bits, inputs
 * that are events, and an energy balance that closes over all of it.
 */
#include <limits.h>
#include <signal.h>
#include <stdbool.h>
#include <unistd.h>

#include "tests/abi/library.h"

static const char *const methods[] = {"rk4",          "euler",         "verlet",   "rk4-events",
                                      "euler-events", "verlet-events", "adaptive", "midpoint"};
enum { METHODS = sizeof methods / sizeof methods[0] };

static strutlib_error *error; /* of the latest call */

/* On a ground that slides; midpoint cannot step over contacts and gets the crawler without it. */
static strutlib_scene *open_for(const char *method) {
  bool hanging = strcmp(method, "midpoint") == 0;
  return library_open(hanging ? "models/basics/oscillator.yaml" : "models/crawler/crawler.yaml");
}

static strutlib_simulation *open_by(const strutlib_scene *scene, const char *method,
                                    const char *step) {
  return given(
      strutlib_simulation_open(scene, WITH_BOTH("integrator", method, "step", step), NULL, &error),
      error);
}

static const double *channel(strutlib_simulation *simulation, const char *name, size_t *count) {
  array a;
  assert_int_equal(
      strutlib_simulation_array(simulation, name, &a.data, &a.dimensions, a.shape, a.stride), 1);
  *count = array_size(&a);
  return a.data;
}

static double *input(strutlib_simulation *simulation, const char *name, size_t *count) {
  double *data;
  array a;
  assert_int_equal(
      strutlib_simulation_input(simulation, name, &data, &a.dimensions, a.shape, a.stride), 1);
  *count = array_size(&a);
  return data;
}

static void advance(strutlib_simulation *simulation, long steps) {
  if (strutlib_simulation_advance(simulation, steps, &error))
    fail_msg("%s", strutlib_error_message(error));
}

/* The call, which fills the error, has that status. */
static void expect(int status, int expected) {
  assert_int_equal(status, expected);
  strutlib_error_free(error);
}

TEST(steps_do_not_depend_on_their_division) {
  for (int m = 0; m < METHODS; m++) {
    size_t n, k;
    strutlib_scene *scene = open_for(methods[m]);
    OWN_POINTER(strutlib_simulation) whole = open_by(scene, methods[m], "0.02 ms");
    OWN_POINTER(strutlib_simulation) parts = open_by(scene, methods[m], "0.02 ms");
    strutlib_close(scene);      /* simulations stay */
    for (int i = 0; i < 4; i++) /* the oscillator has no drive */
      strutlib_simulation_set(i % 2 ? whole : parts, i < 2 ? "actuators" : "rates", "drive", 1e-4,
                              NULL);
    advance(whole, 1500);
    for (long done = 0, i = 0; done < 1500; i++) {
      long next = 1 + i % 7;
      if (next > 1500 - done) next = 1500 - done;
      advance(parts, next);
      done += next;
    }
    assert_true(strutlib_simulation_time(whole) == 1500 * strutlib_simulation_step(whole));
    const double *a = channel(whole, "position", &n), *b = channel(parts, "position", &n);
    assert_memory_equal(a, b, n * sizeof *a);
    a = channel(whole, "force", &k), b = channel(parts, "force", &k);
    assert_memory_equal(a, b, k * sizeof *a);
  }
}

/* The run ends at 0.1 s, where the simulation stands after 4000 steps. */
TEST(steps_are_those_of_a_run) {
  static const char text[] =
      "strut: 1\nbase: models/crawler/crawler.yaml\nrun: {duration: 0.1 s, measure: {last: 0.1 "
      "s}}\n"
      "output: {last: 0.1 s, every: 0.1 s, channels: [position, force, contact, energy]}\n";
  for (int m = 0; m < METHODS - 1; m++) {
    size_t n;
    OWN_POINTER(strutlib_scene) scene = library_open_text(text);
    OWN_POINTER(strutlib_result) run = given(
        strutlib_run(scene, WITH_BOTH("integrator", methods[m], "step", "0.025 ms"), NULL, &error),
        error);
    OWN_POINTER(strutlib_simulation) simulation = open_by(scene, methods[m], "0.025 ms");
    advance(simulation, 4000);
    for (int c = 0; c < 4; c++) {
      const char *name = (const char *const[]){"position", "force", "contact", "energy"}[c];
      const double *here = channel(simulation, name, &n);
      array last = array_of(run, name);
      assert_memory_equal(here, last.data + (last.shape[0] - 1) * last.stride[0], n * sizeof *here);
    }
  }
}

TEST(a_snapshot_goes_on_with_the_same_bits) {
  for (int m = 0; m < METHODS; m++) {
    size_t n, k;
    OWN_POINTER(strutlib_scene) scene = open_for(methods[m]);
    OWN_POINTER(strutlib_simulation) a = open_by(scene, methods[m], "0.02 ms"),
                                     *b = open_by(scene, methods[m], "0.02 ms");
    const double *position = channel(a, "position", &n);
    double *rest = input(a, "rest", &k), drawn = rest[k - 1];
    advance(a, 500);
    OWN_POINTER(strutlib_snapshot) snapshot = given(strutlib_simulation_snapshot(a, &error), error);
    FREED double *there = malloc(n * sizeof *there), *then = malloc(n * sizeof *then);
    memcpy(there, position, n * sizeof *there);
    advance(a, 333);
    memcpy(then, position, n * sizeof *then);
    rest[k - 1] = 0.9 * drawn;
    advance(a, 200);
    assert_memory_not_equal(position, then, n * sizeof *then);
    assert_int_equal(strutlib_simulation_restore(a, snapshot, &error), STRUTLIB_OK);
    assert_true(rest[k - 1] == drawn);
    assert_memory_equal(position, there, n * sizeof *there);
    advance(a, 333);
    assert_memory_equal(position, then, n * sizeof *then);
    expect(strutlib_simulation_restore(b, snapshot, &error), STRUTLIB_USAGE);
  }
}

/* What is stored and lost, less what was put in. */
static double balance(const double *energy) {
  return energy[0] + energy[1] + energy[2] + energy[3] - energy[4] - energy[5] - energy[6] -
         energy[7] + energy[8] + energy[9] + energy[10];
}

static double open_balance(const char *step, double *worked) {
  size_t n, k, q, l;
  OWN_POINTER(strutlib_scene) scene = open_for("rk4-events");
  OWN_POINTER(strutlib_simulation) s = open_by(scene, "rk4-events", step);
  const double *energy = channel(s, "energy", &n);
  double *rest = input(s, "rest", &k), *hold = input(s, "actuators", &q),
         *load = input(s, "load", &l), *rate = input(s, "rates", &q);
  double drawn = rest[k - 1], begin = balance(energy);
  long steps = lround(0.005 / strutlib_simulation_step(s));
  assert_true(isnan(hold[0]) && load[0] == 0.0);
  for (int i = 0; i < 40; i++) {
    rest[k - 1] = drawn * (i % 2 ? 1.01 : 0.99);
    hold[0] = i % 5 ? 1e-4 * i / 40 : (double)NAN;
    load[2] = i % 3 - 1, rate[0] = 0.01 * (i % 2);
    advance(s, steps);
  }
  *worked = strutlib_simulation_input_work(s);
  double gap = balance(energy) - begin;
  return fabs(gap);
}

TEST(the_balance_counts_what_inputs_do) {
  double coarse_work, fine_work;
  double coarse = open_balance("0.05 ms", &coarse_work),
         fine = open_balance("0.025 ms", &fine_work);
  assert_true(fabs(fine_work) > 1e-3);
  assert_true(coarse < 0.01 * fabs(coarse_work) && fine < coarse);
}

/* The member's keys: that of its stiffness, and a law. */
static void check_held_input(const char *member) {
  char text[800];
  static const char scene[] =
      "strut: 1\n"
      "parameters: {rest: 0.9 m, pull: 0 N}\n"
      "nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1 kg, fixed: y}}\n"
      "members:\n"
      "  m: {nodes: [a, b], kind: spring, %s, "
      "damping: 3 N s/m, rest_length: rest}\n"
      "loads:\n"
      "  p: {node: b, force: [pull, 0 N]}\n"
      "solver: {step: 1 ms}\n"
      "run: {duration: 1 s}\n";
  int length = snprintf(text, sizeof text, scene, member);
  assert_true(length > 0 && length < (int)sizeof text);
  size_t n;
  OWN_POINTER(strutlib_scene) plain = library_open_text(text);
  OWN_POINTER(strutlib_scene) changed =
      strutlib_scene_with(plain, WITH_BOTH("rest", "0.8 m", "pull", "7 N"), &error);
  OWN_POINTER(strutlib_simulation) a = strutlib_simulation_open(plain, NONE, NULL, &error);
  OWN_POINTER(strutlib_simulation) b = strutlib_simulation_open(changed, NONE, NULL, &error);
  assert_int_equal(strutlib_simulation_set(a, "rest", "m", 0.8, &error), STRUTLIB_OK);
  assert_int_equal(strutlib_simulation_set(a, "load", "b.x", 7.0, &error), STRUTLIB_OK);
  advance(a, 400);
  advance(b, 400);
  const double *qa = channel(a, "position", &n), *qb = channel(b, "position", &n);
  assert_memory_equal(qa, qb, n * sizeof *qa);
}

/* A rest length that is held changes the motion as a scene with that rest length: EA is over it, too. */
TEST(a_held_input_is_as_if_the_scene_had_it) {
  check_held_input("stiffness: 100 N/m");
  check_held_input("axial_stiffness: 100 N");
  check_held_input("axial_stiffness: 100 N, law: {kind: play, gap: 1 mm}");
  check_held_input("axial_stiffness: 100 N, longest: 1.5 m, stop_stiffness: 1 kN/m");
}

TEST(inputs_are_checked) {
  size_t k;
  OWN_POINTER(strutlib_scene) scene = open_for("rk4");
  strutlib_simulation *s = open_by(scene, "rk4", "0.02 ms");
  double *rest = input(s, "rest", &k), drawn = rest[0];
  rest[0] = -1.0;
  strutlib_simulation_advance(s, 10, &error);
  assert_refused(error, STRUTLIB_USAGE, "member 'm1'");
  assert_true(strutlib_simulation_time(s) == 0.0);
  rest[0] = drawn;
  advance(s, 10);
  expect(strutlib_simulation_set(s, "rest", "m10", 1.0, &error), STRUTLIB_USAGE);
  expect(strutlib_simulation_set(s, "colour", "m1", 1.0, &error), STRUTLIB_USAGE);
  expect(strutlib_simulation_set(s, "load", "n1.z", 1.0, &error), STRUTLIB_USAGE);
  expect(strutlib_simulation_advance(s, -1, &error), STRUTLIB_USAGE);
  strutlib_simulation_close(s);
  assert_null(strutlib_simulation_open(scene, WITH("step", "5 ms"), NULL, &error));
  assert_refused(error, STRUTLIB_STEP_TOO_LARGE, "");
}

TEST(a_divergence_stays_until_a_restore) {
  OWN_POINTER(strutlib_scene) scene = open_for("rk4");
  const char *names[] = {"step", "force", "integrator"}, *values[] = {"2 ms", "yes", "rk4"};
  OWN_POINTER(strutlib_simulation) s =
      strutlib_simulation_open(scene, 3, names, values, NULL, &error);
  assert_non_null(s);
  OWN_POINTER(strutlib_snapshot) snapshot = strutlib_simulation_snapshot(s, &error);
  expect(strutlib_simulation_advance(s, 100000, &error), STRUTLIB_DIVERGED);
  double time = strutlib_simulation_time(s);
  expect(strutlib_simulation_advance(s, 1, &error), STRUTLIB_DIVERGED);
  assert_true(strutlib_simulation_time(s) == time);
  assert_int_equal(strutlib_simulation_restore(s, snapshot, &error), STRUTLIB_OK);
  advance(s, 1);
}

static strutlib_control *control;

static void interrupt(int signal) {
  (void)signal;
  strutlib_interrupt(control);
}

/* The largest number of steps is a number of steps, which an interrupt ends. */
TEST(an_endless_advance_can_be_interrupted) {
  OWN_POINTER(strutlib_scene) scene = open_for("rk4");
  control = strutlib_control_create();
  OWN_POINTER(strutlib_simulation) s =
      given(strutlib_simulation_open(scene, NONE, control, &error), error);
  advance(s, 3);
  double before = strutlib_simulation_time(s);
  signal(SIGALRM, interrupt);
  alarm(1);
  expect(strutlib_simulation_advance(s, LONG_MAX, &error), STRUTLIB_INTERRUPTED);
  assert_true(strutlib_simulation_time(s) > before);
  strutlib_control_free(control);
}
