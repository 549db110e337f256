/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Variations against what they must be: differences of runs, the same with steps a tenth as long, and Liouville's
 * theorem, by which the determinant is exp of minus the integral of damping over mass.
 */
#include "engine/integrate/events/location/variation.h"

#include "tests/physics/driven_scenes.h"
#include "tests/support/structures.h"

enum { MOST = 24 };

/* Places of the free coordinates, then of their velocities behind `length`. */
typedef struct unknowns {
  int32_t n, length, place[MOST];
} unknowns;

static unknowns unknowns_of(const strut_model *m) {
  unknowns u = {.length = m->length};
  for (int32_t i = 0; i < 2 * m->node_count; i++)
    if (!m->fixed[i]) u.place[u.n++] = i;
  for (int32_t i = 0; i < u.n; i++) u.place[u.n + i] = m->length + u.place[i];
  return u;
}

/* Takes z (2 length) through `count` steps from the start; jacobian (2 n, 2 n) of its unknowns, or NULL. */
static void advance(motion *m, int64_t count, double *z, double *jacobian) {
  size_t bytes = (size_t)m->model->length * sizeof(double);
  strut_state_reset(m->model, m->state);
  memcpy(m->state->q, z, bytes);
  memcpy(m->state->v, z + m->model->length, bytes);
  if (jacobian && !m->state->watched.variation)
    m->state->watched.variation = strut_variation_create(m->model, m->state);
  strut_variation *x = m->state->watched.variation;
  m->state->watched.variation = jacobian ? x : NULL;
  if (jacobian) strut_variation_reset(x);
  m->method->restart(m->model, m->state, m->workspace, m->step);
  motion_steps(m, count);
  memcpy(z, m->state->q, bytes);
  memcpy(z + m->model->length, m->state->v, bytes);
  for (int32_t i = 0; jacobian && i < 4 * x->n * x->n; i++)
    jacobian[i] = x->columns[i / (2 * x->n) * x->stride + i % (2 * x->n)];
  m->state->watched.variation = x;
}

/* The same by central differences, `unit` (2) of positions and speeds. */
static void difference(motion *m, int64_t count, const double *z, const double *unit,
                       double *jacobian) {
  const unknowns u = unknowns_of(m->model);
  RELEASED double *end = strut_allocate(2 * (size_t)u.length, sizeof *end);
  for (int32_t j = 0; j < 2 * u.n; j++) {
    double step = unit[j / u.n];
    for (int side = -1; side <= 1; side += 2) {
      memcpy(end, z, 2 * (size_t)u.length * sizeof *end);
      end[u.place[j]] += side * step;
      advance(m, count, end, NULL);
      for (int32_t i = 0; i < 2 * u.n; i++) {
        double *entry = &jacobian[i * 2 * u.n + j];
        *entry = (side < 0 ? 0.0 : *entry) + side * end[u.place[i]] / (2.0 * step);
      }
    }
  }
}

static double determinant(double a[4]) { return a[0] * a[3] - a[1] * a[2]; }

/* ---- Liouville ---- */

static const char *const methods[] = {"rk4-events", "adaptive"};

TEST(a_damped_oscillator_shrinks_volumes_by_its_damping) {
  const double w = 9.0, zeta = 0.05;
  for (size_t k = 0; k < 2; k++) {
    OWN(strut_setup) setup;
    driven_oscillator(&setup, w, zeta);
    OWN(motion) m = motion_begin_by(&setup, methods[k], 1e-3);
    double *z = strut_allocate(2 * (size_t)m.model->length, sizeof *z), jacobian[4];
    memcpy(z, m.model->start, (size_t)m.model->length * sizeof *z);
    advance(&m, 1000, z, jacobian);
    assert_relative(determinant(jacobian), exp(-2.0 * zeta * w), 1e-6);
    strut_release(z);
  }
}

/* A mass of 1 kg on a spring that strikes the ground, damped there while it comes down. */
static strut_setup striking_mass(double ground_damping) {
  strut_setup setup = build_setup();
  build_support(&setup.scene, 0, 1.01);
  build_mass(&setup.scene, 0, 0.01, 1);
  build_member(&setup.scene, STRUT_SPRING, 0, 1, 100, 0.5, 0);
  build_load(&setup.scene, 1, 0, 3, build_sine(&setup.scene, 1, 1.4));
  build_contact(&setup.scene, 1, 2000, ground_damping);
  setup.scene.nodes[1].fixed[0] = true;
  return setup;
}

TEST(strikes_on_a_damped_ground_shrink_volumes_while_they_go_down) {
  const double damping = 8.0, step = 2e-5;
  enum { COUNT = 50000 };
  for (size_t k = 0; k < 2; k++) {
    OWN(strut_setup) setup = striking_mass(damping);
    OWN(motion) m = motion_begin_by(&setup, methods[k], step);
    double *z = strut_allocate(2 * (size_t)m.model->length, sizeof *z), jacobian[4], down = 0.0;
    memcpy(z, m.model->start, (size_t)m.model->length * sizeof *z);
    strut_state_reset(m.model, m.state);
    m.method->restart(m.model, m.state, m.workspace, step);
    for (int i = 0; i < COUNT; i++) {
      motion_steps(&m, 1);
      down += m.state->q[3] < 0.0 && m.state->v[3] < 0.0 ? step : 0.0;
    }
    assert_true(down > 0.02);
    advance(&m, COUNT, z, jacobian);
    assert_relative(determinant(jacobian), exp(-0.5 * COUNT * step - damping * down), 2e-3);
    strut_release(z);
  }
}

/* ---- the crawler: friction with a band, creep along its edge, touchdowns, ground dampers ---- */

enum { PERIODS = 30, STEPS = 3000, FINE = 30000 };

static double largest(int32_t n, const double *a, const double *b, const double *unit) {
  double most = 0.0;
  for (int32_t i = 0; i < n; i++)
    for (int32_t j = 0; j < n; j++) {
      double x = a[i * n + j] - (b ? b[i * n + j] : 0.0);
      most = fmax(most, fabs(x) * unit[2 * j / n] / unit[2 * i / n]);
    }
  return most;
}

static motion begin_crawler(strut_setup *setup, const char *method, int64_t steps) {
  strut_setup_init(setup);
  structure_crawler(&setup->scene, 10, 1e-4, 0.2, false);
  setup->experiment.tolerance = 1e-7;
  return motion_begin_by(setup, method, 0.1 / (double)steps);
}

/* Its derivative over a period from a steady motion against differences of runs with 30000 steps, relative to its
   largest entry: with the same steps, or error control to 1e-7, within 0.3 %; with 3000 steps within 15 %, for the
   phase in which 300 oscillations of the bars end. */
TEST(a_period_of_the_crawler_is_differentiated_through_all_its_events) {
  const double unit[2] = {1e-3, 1e-3 * 2.0 * 3.14159265358979 * 10.0};
  const double small[2] = {1e-7 * unit[0], 1e-7 * unit[1]};
  strut_setup setup;
  double jacobian[4][MOST * MOST];
  motion m = begin_crawler(&setup, "rk4-events", STEPS);
  size_t both = 2 * (size_t)m.model->length;
  RELEASED double *z = strut_allocate(both, sizeof *z), *end = strut_allocate(both, sizeof *end);
  memcpy(z, m.model->start, both / 2 * sizeof *z);
  for (int i = 0; i < PERIODS; i++) advance(&m, STEPS, z, NULL);
  memcpy(end, z, both * sizeof *end);
  int32_t n = 2 * unknowns_of(m.model).n;
  assert_true(n <= MOST);
  advance(&m, STEPS, end, jacobian[0]);
  assert_true(m.state->events > 50);
  motion_free(&m);
  strut_setup_free(&setup);
  m = begin_crawler(&setup, "rk4-events", FINE);
  memcpy(end, z, both * sizeof *end);
  advance(&m, FINE, end, jacobian[1]);
  difference(&m, FINE, z, small, jacobian[2]);
  motion_free(&m);
  strut_setup_free(&setup);
  m = begin_crawler(&setup, "adaptive", 50);
  memcpy(end, z, both * sizeof *end);
  advance(&m, 50, end, jacobian[3]);
  double whole = largest(n, jacobian[2], NULL, unit);
  assert_within(largest(n, jacobian[0], jacobian[2], unit) / whole, 0.0, 0.15);
  assert_within(largest(n, jacobian[1], jacobian[2], unit) / whole, 0.0, 3e-3);
  assert_within(largest(n, jacobian[3], jacobian[2], unit) / whole, 0.0, 3e-3);
  motion_free(&m);
  strut_setup_free(&setup);
}
