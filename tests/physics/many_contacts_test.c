/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Structures with many contacts, whose events come at once or soon after each other: closed forms, and falls of
   random grids by several methods. */
#include "engine/forces/forces.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

static const double G = 9.81;

static motion begin(strut_setup *setup, const char *method, double step, double tolerance) {
  setup->experiment.tolerance = tolerance;
  motion m = motion_begin_by(setup, method, step);
  m.state->balance = true;
  return m;
}

/* ---- closed forms ---- */

/*
 * Blocks of 1 kg on springs of 100 N/m to the wall, pulled out to different widths: after each half period the
 * width is smaller by 2 mu m g / k, and a block stays where the spring cannot overcome friction.
 */
enum { BLOCKS = 12 };
static const double SPRING = 100.0, MU = 0.2, GROUND = 1e5;

static double width_of(int32_t i) { return 0.05 + 0.0137 * i; }

static double block_at(double width, double t) {
  double less = MU * G / SPRING, half = acos(-1.0) / sqrt(SPRING), side = 1.0;
  for (; width > less && t > half; t -= half) width -= 2.0 * less, side = -side;
  if (width <= less) return side * width;
  return side * (less + (width - less) * cos(sqrt(SPRING) * t));
}

static strut_setup make_blocks(void) {
  strut_setup setup = build_falling();
  strut_scene *scene = &setup.scene;
  for (int32_t i = 0; i < BLOCKS; i++) {
    double y = -G / GROUND, x = width_of(i);
    int32_t block = build_mass(scene, x, y, 1.0), wall = build_support(scene, -1.0, y);
    int32_t contact = build_contact(scene, block, GROUND, 0.0);
    scene->contacts[contact].friction =
        (strut_friction){.law = STRUT_FRICTION_COULOMB, .mu_static = MU, .mu_kinetic = MU};
    build_sized(scene, STRUT_SPRING, block, wall, SPRING, 0.0, 0.0, 1.0);
  }
  return setup;
}

TEST(blocks_stop_where_coulomb_says) {
  static const char *const methods[] = {"rk4-events", "adaptive", "adaptive8"};
  for (int k = 0; k < 3; k++) {
    OWN(strut_setup) setup = make_blocks();
    OWN(motion) m = begin(&setup, methods[k], 1e-3, 1e-9);
    for (int n = 0; n < 25; n++) {
      motion_steps(&m, 70);
      for (int32_t i = 0; i < BLOCKS; i++)
        assert_near(m.state->q[4 * i], block_at(width_of(i), (double)m.state->step * m.step), 1e-9);
    }
    for (int32_t i = 0; i < BLOCKS; i++) assert_true(m.state->v[4 * i] == 0.0);
  }
}

/* ---- many switches at one moment ---- */

/* Of `adaptive`, whose steps after events differ with their number. */
static const double TOLERANCE = 1e-9;

/* Blocks that fall from one height all touch and open at once; each moves as it would alone. */
TEST(blocks_that_touch_at_once_move_as_one) {
  static const char *const methods[] = {"rk4-events", "adaptive", "adaptive8", "verlet-events"};
  for (int k = 0; k < 4; k++) {
    double alone[2] = {0.0, 0.0};
    for (int blocks = 1; blocks <= BLOCKS; blocks += BLOCKS - 1) {
      OWN(strut_setup) setup = build_falling();
      for (int i = 0; i < blocks; i++)
        build_contact(&setup.scene, build_mass(&setup.scene, i, 0.0123, 1.0), GROUND, 20.0);
      OWN(motion) m = begin(&setup, methods[k], 1e-3, TOLERANCE);
      motion_steps(&m, 100);
      if (blocks == 1) alone[0] = m.state->q[1], alone[1] = m.state->v[1];
      for (int i = 0; i < blocks; i++) {
        assert_near(m.state->q[2 * i + 1], alone[0], TOLERANCE);
        assert_near(m.state->v[2 * i + 1], alone[1], 1e3 * TOLERANCE);
      }
    }
  }
}

/* ---- random grids ---- */

static void add_member(strut_scene *scene, uint64_t *random, int32_t from, int32_t to, bool cable) {
  const double *a = scene->nodes[from].position, *b = scene->nodes[to].position;
  double length = hypot(a[0] - b[0], a[1] - b[1]);
  double rest = cable ? length * random_between(random, 0.97, 1.002) : length;
  build_sized(scene, cable ? STRUT_CABLE : STRUT_BAR, from, to, cable ? 3e3 : 5e4, 0.3, 0.1, rest);
}

static void add_contact(strut_scene *scene, uint64_t *random, int32_t node, int law) {
  int32_t i = build_contact(scene, node, 1e4, random_between(random, 0.0, 4.0));
  strut_friction *f = &scene->contacts[i].friction;
  double mu = random_between(random, 0.1, 0.6);
  if (law == 1)
    *f = (strut_friction){.law = STRUT_FRICTION_COULOMB, .mu_static = mu, .mu_kinetic = mu};
  if (law == 2)
    *f = (strut_friction){.law = STRUT_FRICTION_KARNOPP,
                          .mu_static = 1.2 * mu,
                          .mu_kinetic = mu,
                          .stick_velocity = 5e-3};
}

/* A grid that falls on its lowest nodes and slides; law: of friction, 0: none. */
enum { COLUMNS = 36, ROWS = 3, NODES = COLUMNS * ROWS, LAWS = 3 };

static strut_setup make_grid(uint64_t seed, int law, bool lumped) {
  uint64_t random = seed;
  strut_setup setup = build_falling();
  strut_scene *scene = &setup.scene;
  scene->mass_model = lumped ? STRUT_MASS_LUMPED : STRUT_MASS_CONSISTENT;
  for (int32_t c = 0; c < COLUMNS; c++)
    for (int32_t r = 0; r < ROWS; r++) {
      double up = random_between(&random, 0.0005, 0.008),
             right = random_between(&random, -0.01, 0.01);
      int32_t i = build_mass(scene, 0.1 * c + right, 0.1 * r + up, 0.05);
      scene->nodes[i].velocity[0] = 0.2 + random_between(&random, -0.1, 0.1);
      scene->nodes[i].velocity[1] = -0.8;
      if (r == 0) add_contact(scene, &random, i, law);
    }
  for (int32_t c = 0; c < COLUMNS; c++)
    for (int32_t r = 0; r < ROWS; r++) {
      int32_t i = c * ROWS + r;
      if (c + 1 < COLUMNS) add_member(scene, &random, i, i + ROWS, true);
      if (r + 1 < ROWS) add_member(scene, &random, i, i + 1, true);
      if (c + 1 == COLUMNS || r + 1 == ROWS) continue;
      add_member(scene, &random, i, i + ROWS + 1, false);
      add_member(scene, &random, i + 1, i + ROWS, false);
    }
  if (law) build_actuator(scene, COLUMNS, build_sine(scene, 1e-3, 40.0));
  if (law == 1) scene->ground.slope = -0.002;
  return setup;
}

typedef struct fall {
  double q[2 * NODES], v[2 * NODES], residual;
  int64_t events;
} fall;

static double total_energy(motion *m) {
  strut_energies e = strut_energy_evaluate(m->model, m->state, (double)m->state->step * m->step);
  const double *w = m->state->work;
  return e.kinetic + e.elastic + e.gravity + e.contact + w[STRUT_POWER_MEMBERS] +
         w[STRUT_POWER_CONTACT] + w[STRUT_POWER_FRICTION] - w[STRUT_POWER_DRIVE];
}

static void let_fall(strut_setup *setup, const char *method, double step, double tolerance,
                     fall *f) {
  OWN(motion) m = begin(setup, method, step, tolerance);
  double before = total_energy(&m);
  motion_steps(&m, llround(0.02 / step));
  assert_int_equal(m.state->trouble, STRUT_FAILURE_NONE);
  memcpy(f->q, m.state->q, sizeof f->q);
  memcpy(f->v, m.state->v, sizeof f->v);
  f->residual = total_energy(&m) - before;
  f->events = m.state->events;
}

static double distance(const double *a, const double *b) {
  double most = 0.0;
  for (int i = 0; i < 2 * NODES; i++) most = fmax(most, fabs(a[i] - b[i]));
  return most;
}

/* How far positions by steps of 0.1 ms and by error control with 1e-6 may be from those with 1e-11 [m]. */
static const double NEAR[2] = {1e-9, 5e-12};

TEST(grids_fall_alike_by_every_method_with_events) {
  static fall exact, other;
  for (int lumped = 0; lumped < 2; lumped++)
    for (int law = 0; law < LAWS; law++) {
      OWN(strut_setup) setup = make_grid(1 + (uint64_t)law, law, lumped);
      let_fall(&setup, "adaptive", 4e-5, 1e-11, &exact);
      for (int k = 0; k < 2; k++) {
        let_fall(&setup, k ? "adaptive" : "rk4-events", 1e-4, 1e-6, &other);
        assert_within(distance(other.q, exact.q), 0.0, NEAR[k]);
        assert_within(distance(other.v, exact.v), 0.0, 1e3 * NEAR[k]);
        assert_near(other.residual, 0.0, 1e-6);
        if (law < 2)
          assert_int_equal(other.events, exact.events); /* else a contact may yield to and fro */
      }
    }
}
