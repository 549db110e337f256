/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Random scenes with every element, ground, drive and sensor by every method: energy balances close, and
 * motions are those of an accurate run, both better with half the step as the method's order says.
 */
#include "tests/models/run_model.h"
#include "tests/physics/random_world.h"
#include "tests/support/motion.h"

static uint64_t scenes = 8; /* of each kind; more of them: test_world_methods SCENES */

typedef struct outcome {
  double q[SLOW_PLACES];
  size_t n;
  double residual; /* of what was exchanged */
  int64_t events;
  bool stopped; /* a cell collapsed, or no steps lead on */
} outcome;

static outcome run(uint64_t seed, unsigned parts, const char *method, double step,
                   double tolerance) {
  static random_world world;
  outcome o = {.n = 0};
  OWN(strut_summary) s;
  random_world_make(&world, seed, parts);
  OWN(model_run) run = model_read_text("random.yaml", world.text, set_none);
  motion_experiment_by(&run.setup, step, 0.2, method);
  run.setup.experiment.tolerance = tolerance;
  o.stopped = motion_try(&run.setup, (strut_run_options){0}, &s, NULL) != STRUT_OK;
  o.n = 2 * run.setup.scene.node_count;
  if (!o.stopped) {
    memcpy(o.q, s.end.positions, o.n * sizeof *o.q);
    o.residual = fabs(s.energy.residual) / s.energy.moved, o.events = s.spent.events;
  }
  return o;
}

static double distance(const outcome *a, const outcome *b) {
  double most = 0;
  for (size_t i = 0; i < a->n; i++) most = fmax(most, fabs(a->q[i] - b->q[i]));
  return most;
}

/* What is promised of a method: errors at its step, and the least mean factor by which half is better. */
typedef struct promise {
  const char *name;
  double step, residual, error, gain;
  unsigned parts;
} promise;

static double logarithm_of_gain(double whole, double half) {
  return log(fmax(whole, 1e-13) / fmax(half, 1e-13));
}

static bool keeps_promise(const promise *by) {
  double worst = 0, far = 0, gain = 0;
  int count = 0, events = 0;
  for (uint64_t seed = 1; seed <= scenes; seed++) {
    outcome exact = run(seed, by->parts, "adaptive", 1e-2, 1e-11);
    outcome whole = run(seed, by->parts, by->name, by->step, 1e-9);
    outcome half = run(seed, by->parts, by->name, by->step / 2, 1e-9);
    if (exact.stopped || whole.stopped || half.stopped) continue;
    double error = distance(&whole, &exact);
    if (whole.residual > by->residual || error > by->error)
      print_error("%s, parts %u, seed %d: residual %.2g, error %.2g\n", by->name, by->parts,
                  (int)seed, whole.residual, error);
    worst = fmax(worst, whole.residual), far = fmax(far, error);
    gain += logarithm_of_gain(error, distance(&half, &exact));
    events += (int)exact.events;
    count++;
  }
  print_message(
      "%s, parts %u: residual %.2g, error %.2g, half a step %.2f times better; %d runs, "
      "%d events\n",
      by->name, by->parts, worst, far, exp(gain / count), count, events);
  return count > (int)scenes / 2 && worst < by->residual && far < by->error &&
         exp(gain / count) > by->gain;
}

BEFORE_ALL { scenes = (uint64_t)test_number(1, (double)scenes); }

TEST(methods_keep_their_promises) {
  static const unsigned kinds[] = {WORLD_BODIES,
                                   WORLD_GROUNDS | WORLD_LIGHT,
                                   WORLD_DRIVES,
                                   WORLD_FEEDBACK | WORLD_GROUNDS | WORLD_LIGHT,
                                   WORLD_FEEDBACK | WORLD_GROUNDS | WORLD_SAMPLES | WORLD_LIGHT,
                                   WORLD_MEMORY,
                                   WORLD_SMOOTH | WORLD_BODIES | WORLD_DRIVES};
  static const promise methods[] = {
      {"rk4-events", 1e-3, 2e-4, 5e-4, 8, 0},     {"verlet-events", 1e-3, 1e-2, 2e-2, 3, 0},
      {"euler-events", 1e-3, 5e-2, 7e-2, 1.7, 0}, {"adaptive", 1e-2, 2e-5, 1e-5, 0, 0},
      {"rk4", 1e-3, 5e-3, 5e-3, 1.3, 0},          {"midpoint", 1e-3, 1e-11, 1e-3, 2, 0}};
  bool fine = true;
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
    for (size_t m = 0; m < sizeof methods / sizeof methods[0]; m++) {
      promise by = methods[m];
      by.parts = kinds[k];
      /* it refuses shaken grounds and memory; and kinks of expressions are not located */
      bool refused = !strcmp(by.name, "midpoint") && kinds[k] & (WORLD_GROUNDS | WORLD_MEMORY);
      if (refused) continue;
      if (kinds[k] & WORLD_SAMPLES) by.gain = fmin(by.gain, 2);
      fine = keeps_promise(&by) && fine;
    }
  assert_true(fine);
}

static strut_status compile_and_run(const strut_setup *setup) {
  OWN_POINTER(strut_model) model = NULL;
  strut_summary s = {.end.node_count = 0};
  const strut_run_options options = {0};
  strut_status status = strut_model_compile(&setup->scene, &model, NULL);
  if (status == STRUT_OK) status = strut_simulate(model, &setup->experiment, &options, &s, NULL);
  if (model) strut_summary_free(&s);
  return status;
}

/* A refusal of memory at any place is passed on, and nothing leaks. */
TEST(refused_memory) {
  static random_world world;
  static const char *const methods[] = {"rk4", "rk4-events", "adaptive"};
  random_world_make(&world, 1, WORLD_ALL | WORLD_LIGHT);
  OWN(model_run) run = model_read_text("random.yaml", world.text, set_none);
  for (int m = 0; m < 3; m++) {
    motion_experiment_by(&run.setup, 1e-3, 2e-3, methods[m]);
    REFUSE_EACH(n, status, 10) status = refused(n, compile_and_run(&run.setup));
  }
}
