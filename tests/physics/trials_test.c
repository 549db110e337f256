/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Steps that are tried write nothing: random scenes with every element, ground, drive and sensor end with the same
 * bits where every trial of a method with events is first taken twice as far and thrown away, and where forces are
 * evaluated anywhere between steps.
 */
#include "tests/models/run_model.h"
#include "tests/physics/random_world.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

enum { STEPS = 150, SCENES = 4, LEAST_RUNS = 12, ROOM = SLOW_PLACES + 64 };

/* Forces of a structure that is torn apart, at another time. */
static void evaluate_wildly(motion *m, uint64_t seed) {
  static double q[ROOM], v[ROOM];
  const strut_model *model = m->model;
  assert_true((size_t)model->length <= sizeof q / sizeof *q);
  for (int32_t i = 0; i < model->length; i++) {
    double far = model->fixed[i] ? 0.0 : random_between(&seed, -2.0, 2.0) * model->size;
    q[i] = m->state->q[i] + far;
    v[i] = m->state->v[i] + (model->fixed[i] ? 0.0 : random_between(&seed, -9.0, 9.0));
  }
  double t = ((double)m->state->step + random_between(&seed, 0.1, 3.0)) * m->step;
  strut_forces_evaluate(model, m->state, t, q, v);
}

static bool is_finite(const motion *m) {
  bool finite = !m->state->trouble;
  for (int32_t i = 0; i < m->model->length; i++) finite = finite && fabs(m->state->q[i]) < 1e3;
  return finite;
}

/* Fills q, v and the works after STEPS steps. False: the run has ended before. */
static bool run(const random_world *world, const char *method, bool disturbed, double *end) {
  OWN(model_run) run = model_read_text("random.yaml", world->text, set_none);
  motion_experiment(&run.setup, 1e-3, 0.2);
  OWN(motion) m = motion_begin_by(&run.setup, method, 1e-3);
  m.state->balance = true;
  for (int n = 0; n < STEPS && is_finite(&m); n++) {
    m.state->watched.rehearsals = disturbed ? 2 : 0;
    motion_steps(&m, 1);
    if (disturbed) evaluate_wildly(&m, (uint64_t)n);
  }
  bool whole = is_finite(&m);
  size_t n = (size_t)m.model->length;
  memset(end, 0, (2 * ROOM + STRUT_POWER_ROOM) * sizeof *end);
  memcpy(end, m.state->q, n * sizeof *end);
  memcpy(end + ROOM, m.state->v, n * sizeof *end);
  memcpy(end + 2 * ROOM, m.state->work, sizeof m.state->work);
  return whole;
}

static void keeps_its_bits(const char *method, unsigned refused) {
  static const unsigned kinds[] = {WORLD_BODIES, WORLD_GROUNDS | WORLD_LIGHT,
                                   WORLD_DRIVES, WORLD_FEEDBACK | WORLD_GROUNDS | WORLD_LIGHT,
                                   WORLD_MEMORY, WORLD_MEMORY | WORLD_DRIVES};
  static random_world world;
  static double plain[2 * ROOM + STRUT_POWER_ROOM], tried[sizeof plain / sizeof *plain];
  int runs = 0;
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
    for (uint64_t seed = 1; seed <= SCENES && !(kinds[k] & refused); seed++) {
      random_world_make(&world, seed, kinds[k]);
      if (!run(&world, method, false, plain) || !run(&world, method, true, tried)) continue;
      if (memcmp(plain, tried, sizeof plain) != 0)
        fail_msg("%s, parts %u, seed %d: a trial has left a trace", method, kinds[k], (int)seed);
      runs++;
    }
  print_message("%s: %d runs\n", method, runs);
  assert_true(runs >= (refused ? LEAST_RUNS / 2 : LEAST_RUNS));
}

TEST(rk4) { keeps_its_bits("rk4", 0); }
TEST(euler) { keeps_its_bits("euler", 0); }
TEST(verlet) { keeps_its_bits("verlet", 0); }
TEST(midpoint) { keeps_its_bits("midpoint", WORLD_GROUNDS | WORLD_MEMORY); }
TEST(rk4_events) { keeps_its_bits("rk4-events", 0); }
TEST(verlet_events) { keeps_its_bits("verlet-events", 0); }
TEST(euler_events) { keeps_its_bits("euler-events", 0); }
TEST(adaptive) { keeps_its_bits("adaptive", 0); }
TEST(adaptive8) { keeps_its_bits("adaptive8", 0); }
