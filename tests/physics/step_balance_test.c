/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The works of a Runge-Kutta step, whose powers are added up lane by lane, against the powers of its four evaluations
 * with the weights of the method: of a driven crawler on a belt.
 */
#include "tests/support/structures.h"

enum { LENGTH = 16, SETTLED = 500, STEPS = 1000 };
static const double STEP = 5e-5;

/* The works of the step that begins at the state, which is left where it is. */
static void expect_works(const motion *m, double *works) {
  static const double ahead[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1, 2, 2, 1};
  strut_state *s = m->state;
  double q[LENGTH], v[LENGTH], a[LENGTH] = {0};
  int32_t n = m->model->length;
  assert_true(n <= LENGTH);
  for (int p = 0; p < STRUT_POWER_ROOM; p++) works[p] = 0.0;
  for (int k = 0; k < 4; k++) {
    double h = ahead[k] * m->step;
    for (int32_t i = 0; i < n; i++) {
      q[i] = s->q[i] + h * (k ? v[i] : 0.0);
      v[i] = s->v[i] + h * a[i];
    }
    strut_forces_acceleration(m->model, s, ((double)s->step + ahead[k]) * m->step, q, v, a);
    for (int p = 0; p < STRUT_POWER_ROOM; p++)
      works[p] += weight[k] * m->step / 6.0 * s->latest->power[p];
  }
}

TEST(works_are_powers_with_the_weights_of_the_stages) {
  strut_setup setup = {.experiment = strut_experiment_default()};
  double works[STRUT_POWER_ROOM], before[STRUT_POWER_ROOM], most[STRUT_POWER_ROOM] = {0};
  setup.experiment.step = STEP;
  strut_scene_init(&setup.scene);
  structure_crawler(&setup.scene, 10, 1e-4, 0.1, false);
  setup.scene.ground.belt_speed = 0.05;
  OWN(motion) m = motion_begin_by(&setup, "rk4", STEP);
  m.state->balance = true;
  motion_steps(&m, SETTLED);
  for (int n = 0; n < STEPS; n++) {
    memcpy(before, m.state->work, sizeof before);
    expect_works(&m, works);
    motion_steps(&m, 1);
    for (int p = 0; p < STRUT_POWER_ROOM; p++) {
      assert_near(m.state->work[p] - before[p], works[p],
                  1e-11 * works[STRUT_POWER_EXCHANGED] + 1e-14 * fabs(before[p]));
      most[p] = fmax(most[p], fabs(works[p]));
    }
  }
  /* all that the scene has was at work */
  assert_true(most[STRUT_POWER_DRIVE] > 0 && most[STRUT_POWER_BELT] > 0 &&
              most[STRUT_POWER_MEMBERS] > 0 && most[STRUT_POWER_CONTACT] > 0 &&
              most[STRUT_POWER_FRICTION] > 0);
  strut_scene_free(&setup.scene);
}
