/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The potential energy of random scenes with cells, collisions and grounds of every shape: its gradient
 * and its Hessian against differences, and the forces, the energies and the tangent stiffness of a
 * motion at rest, which know nothing of each other, against them.
 */
#include "engine/statics/potential.h"

#include "engine/forces/tangent.h"
#include "tests/models/run_model.h"
#include "tests/physics/random_world.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

enum { SCENES = 60, MOST = SLOW_PLACES };
static const double TOLERANCE = 1e-9;

typedef struct fixture {
  random_world world;
  model_run run;
  motion m;
  strut_potential *potential;
  strut_arena arena;
  double q[2 * MOST]; /* (length) */
} fixture;

static void begin(fixture *f, uint64_t seed, unsigned parts) {
  uint64_t r = seed + 99;
  random_world_make(&f->world, seed, parts);
  strcat(f->world.text, "loads: {push: {node: n2, force: [1.5, -2]}}\n");
  f->run = model_read_text("random.yaml", f->world.text, set_none);
  strut_scene *scene = &f->run.setup.scene;
  for (size_t i = 0; i < scene->ground_count; i++)
    scene->grounds[i].moves[0] = scene->grounds[i].moves[1] = false;
  for (size_t i = 0; i < scene->contact_count; i++)
    scene->contacts[i].friction.law = STRUT_FRICTION_NONE;
  scene->actuator_count = 0;
  f->m = motion_begin(scene, 1e-3);
  assert_ok(strut_potential_create(f->m.model, NULL, true, &f->arena, &f->potential, NULL));
  assert_true(f->m.model->length <= 2 * MOST);
  memcpy(f->q, f->m.model->start, (size_t)f->m.model->length * sizeof *f->q);
  for (int32_t i = 0; i < f->potential->n; i++)
    f->q[f->potential->coordinate[i]] += random_between(&r, -0.1, 0.1);
}

static void end(fixture *f) {
  strut_arena_free(&f->arena);
  motion_free(&f->m);
  model_run_free(&f->run);
}

/* Value (row 0) and gradient at a shift along coordinate j. */
static void probe(fixture *f, int32_t j, double shift, double *answer) {
  double keep = f->q[f->potential->coordinate[j]];
  f->q[f->potential->coordinate[j]] = keep + shift;
  answer[0] = strut_potential_value(f->potential, f->q);
  strut_potential_gradient(f->potential, f->q, answer + 1);
  f->q[f->potential->coordinate[j]] = keep;
}

/* Slopes of both along coordinate j by Richardson's extrapolation of central differences. */
static void slopes(fixture *f, int32_t j, double h, double *slope) {
  double high[MOST + 1], low[MOST + 1], d[3][MOST + 1];
  int32_t n = f->potential->n + 1;
  for (int k = 0; k < 3; k++) {
    probe(f, j, ldexp(h, -k), high), probe(f, j, -ldexp(h, -k), low);
    for (int32_t i = 0; i < n; i++) d[k][i] = (high[i] - low[i]) / ldexp(h, 1 - k);
  }
  for (int32_t i = 0; i < n; i++)
    slope[i] = (16 * (4 * d[2][i] - d[1][i]) - (4 * d[1][i] - d[0][i])) / 45;
}

/* True where two steps give the same: no kink is near. */
static bool is_smooth(const double *a, const double *b, int32_t n, double scale) {
  for (int32_t i = 0; i < n; i++)
    if (!(fabs(a[i] - b[i]) <= 0.3 * TOLERANCE * scale)) return false;
  return true;
}

static double largest(const double *x, int32_t n) {
  double most = 1;
  for (int32_t i = 0; i < n; i++) most = fmax(most, fabs(x[i]));
  return most;
}

/* Columns of the Hessian that were looked at, of all. */
typedef struct tally {
  int checked, all;
} tally;

static void check_derivatives(fixture *f, tally *seen) {
  int32_t n = f->potential->n;
  double g[MOST], x[MOST], column[MOST], near[MOST + 1], nearer[MOST + 1];
  strut_sparse *k = strut_potential_matrix(f->potential, &f->run.setup.scene.arena);
  assert_non_null(k);
  strut_potential_gradient(f->potential, f->q, g);
  strut_potential_hessian(f->potential, f->q, k);
  double scale = fmax(largest(k->value, k->start[n]), largest(g, n));
  for (int32_t j = 0; j < n; j++) {
    slopes(f, j, 4e-4, near), slopes(f, j, 3e-4, nearer);
    seen->all++;
    if (!is_smooth(near, nearer, n + 1, scale)) continue;
    seen->checked++;
    memset(x, 0, sizeof x);
    x[j] = 1;
    strut_sparse_multiply(k, x, column);
    assert_near(g[j], near[0], TOLERANCE * scale);
    for (int32_t i = 0; i < n; i++) assert_near(column[i], near[1 + i], TOLERANCE * scale);
  }
}

/* A motion at rest feels minus the gradient. */
static void check_forces(fixture *f) {
  double v[2 * MOST] = {0}, g[MOST];
  strut_potential_gradient(f->potential, f->q, g);
  strut_forces_evaluate(f->m.model, f->m.state, 0, f->q, v);
  double scale = largest(g, f->potential->n);
  for (int32_t i = 0; i < f->potential->n; i++)
    assert_near(f->m.state->latest->force[f->potential->coordinate[i]], -g[i], 1e-12 * scale);
}

/* So it is with what the engine keeps and with the tangent stiffness; the net force is minus the gradient. */
static void check_sums(fixture *f) {
  int32_t n = f->potential->n;
  double x[MOST], y[MOST], z[MOST], g[MOST], net[2 * MOST];
  const strut_model *model = f->m.model;
  strut_arena *arena = &f->run.setup.scene.arena;
  strut_tangent tangent;
  strut_sparse *k = strut_potential_matrix(f->potential, arena);
  strut_potential_hessian(f->potential, f->q, k);
  assert_ok(strut_tangent_assemble(model, f->q, model->members.rest, STRUT_CLOSED_TOUCHING, arena,
                                   &tangent));
  assert_int_equal(tangent.n, n);
  for (int32_t i = 0; i < n; i++) x[i] = sin(1.0 + 3.0 * i);
  strut_sparse_multiply(k, x, y);
  strut_sparse_multiply(tangent.stiffness, x, z);
  for (int32_t i = 0; i < n; i++) assert_near(y[i], z[i], 1e-9 * (1 + fabs(z[i])));
  memcpy(f->m.state->q, f->q, (size_t)model->length * sizeof *f->q);
  strut_energies stored = strut_energy_evaluate(model, f->m.state, 0);
  double kept = stored.elastic + stored.gravity;
  double loads = strut_energy_load_potential(model, f->m.state);
  double scale = fabs(stored.elastic) + fabs(stored.gravity) + fabs(loads) + stored.contact;
  assert_near(strut_potential_value(f->potential, f->q), kept + stored.contact - loads,
              1e-13 * scale);
  assert_near(strut_potential_energy(f->potential, f->q), kept, 1e-13 * scale);
  strut_potential_gradient(f->potential, f->q, g);
  strut_potential_force(f->potential, f->q, net);
  for (int32_t i = 0; i < n; i++) assert_same_bits(0 - g[i], 0 + net[f->potential->coordinate[i]]);
}

TEST(derivatives_of_the_potential) {
  static fixture f;
  static const unsigned kinds[] = {WORLD_BODIES, WORLD_GROUNDS, WORLD_BODIES | WORLD_GROUNDS,
                                   WORLD_BODIES | WORLD_SMOOTH};
  tally seen = {0, 0};
  for (int k = 0; k < 4; k++)
    for (uint64_t seed = 1; seed <= SCENES; seed++) {
      begin(&f, seed, kinds[k]);
      check_derivatives(&f, &seen);
      check_forces(&f);
      check_sums(&f);
      end(&f);
    }
  assert_within(seen.checked, 0.5 * seen.all, seen.all);
}
