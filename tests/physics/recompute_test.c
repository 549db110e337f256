/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every compiled force, M and M^-1 F against the slow recomputation, on 200 random scenes. */
#include "engine/model/mass.h"
#include "tests/physics/random_scene.h"
#include "tests/physics/slow_world.h"
#include "tests/support/motion.h"

enum { SCENES = 200 };
static const double TOLERANCE = 1e-13;

/* What the scenes have been seen to exercise. */
typedef struct coverage {
  int block[STRUT_DENSE_BLOCK + 1][2]; /* by size, by whether x and y share */
  int factor[2], diagonal, lumped, alone[2];
  int terms[STRUT_TERM_SOLVE + 1];
  int slack, taut, touching, flying, sticking, breaking, sliding, driven[STRUT_SUM + 1];
  int loaded[STRUT_SUM + 1], fixed_member;
} coverage;

/* A scene in its motion, by both. */
typedef struct fixture {
  strut_scene scene;
  strut_model *model;
  strut_state *state;
  slow_world slow;
  slow_instant at;
  slow_rates rates;
} fixture;

static void check_mass(const fixture *f) {
  static long double mass[SLOW_NODES][SLOW_NODES];
  slow_world_mass(&f->scene, mass);
  size_t nodes = f->scene.node_count;
  double scale = slow_largest(mass[0], nodes * SLOW_NODES);
  for (size_t c = 0; c < 2; c++) {
    const strut_mass_operator *op = &f->model->mass->coordinate[c];
    const strut_sparse *m = op->matrix;
    FREED double *dense = calloc(nodes * nodes + 1, sizeof *dense);
    size_t row_count = 0;
    assert_non_null(dense);
    for (int32_t j = 0; j < m->n; j++)
      for (int32_t k = m->start[j]; k < m->start[j + 1]; k++) {
        size_t a = (size_t)op->matrix_node[m->row[k]], b = (size_t)op->matrix_node[j];
        assert_true(m->row[k] >= j);
        dense[a * nodes + b] = dense[b * nodes + a] = m->value[k];
      }
    for (size_t i = 0; i < nodes; i++) {
      row_count += !f->scene.nodes[i].fixed[c];
      for (size_t j = 0; j < nodes; j++) {
        bool fixed = f->scene.nodes[i].fixed[c] || f->scene.nodes[j].fixed[c];
        assert_near(dense[i * nodes + j], fixed ? 0 : (double)mass[i][j], TOLERANCE * scale);
      }
    }
    assert_int_equal(m->n, row_count);
  }
}

static void check_forces(const fixture *f) {
  const strut_latest *latest = f->state->latest;
  double length[SLOW_ITEMS], tension[SLOW_ITEMS];
  long double slow[SLOW_ITEMS] = {0};
  for (size_t j = 0; j < f->scene.member_count; j++)
    slow[j] = slow_world_member(&f->slow, &f->at, j);
  double scale = fmax(slow_largest(f->rates.force, f->slow.n), slow_largest(slow, SLOW_ITEMS));
  scale = fmax(scale, slow_largest(f->rates.normal, f->scene.contact_count));
  strut_forces_evaluate(f->model, f->state, (double)f->at.t, f->state->q, f->state->v);
  motion_members(f->model, f->state, length, tension);
  for (size_t i = 0; i < f->slow.n; i++)
    assert_near(latest->force[i], (double)f->rates.force[i], TOLERANCE * scale);
  for (size_t j = 0; j < f->scene.member_count; j++)
    assert_near(tension[j], (double)slow[j], TOLERANCE * scale);
  for (size_t i = 0; i < f->scene.contact_count; i++) {
    assert_near(latest->normal[i], (double)f->rates.normal[i], TOLERANCE * scale);
    assert_near(latest->friction[i], (double)f->rates.friction[i], TOLERANCE * scale);
  }
}

static void check_powers(const fixture *f) {
  const double *power = f->state->latest->power;
  long double expected[STRUT_POWER_EXCHANGED];
  double scale = 0;
  slow_world_powers(&f->slow, &f->at, &f->rates, expected);
  for (int p = 0; p < STRUT_POWER_EXCHANGED; p++) scale += (double)fabsl(expected[p]);
  for (int p = 0; p < STRUT_POWER_EXCHANGED; p++)
    assert_near(power[p], (double)expected[p], TOLERANCE * scale);
  assert_true(power[STRUT_POWER_EXCHANGED] >= scale * (1 - TOLERANCE));
}

static void check_acceleration(const fixture *f) {
  double a[2 * SLOW_PLACES] = {0}, with_balance[2 * SLOW_PLACES] = {0};
  double t = (double)f->at.t, scale = slow_largest(f->rates.a, f->slow.n);
  assert_true(f->model->length <= 2 * SLOW_PLACES);
  strut_forces_acceleration(f->model, f->state, t, f->state->q, f->state->v, a);
  for (size_t i = 0; i < f->slow.n; i++) {
    assert_near(a[i], (double)f->rates.a[i], TOLERANCE * scale);
    if (f->scene.nodes[i / 2].fixed[i % 2]) assert_true(a[i] == 0);
  }
  f->state->balance = true;
  strut_forces_acceleration(f->model, f->state, t, f->state->q, f->state->v, with_balance);
  assert_memory_equal(a, with_balance, f->slow.n * sizeof *a);
  check_powers(f);
  f->state->balance = false;
}

static void cover_mass(coverage *seen, const strut_scene *scene, const strut_mass *mass) {
  for (int c = 0; c < 2; c++) {
    const strut_mass_operator *op = &mass->coordinate[c];
    for (int32_t b = 0; b < op->block_count; b++) seen->block[op->block_size[b]][mass->shared]++;
    seen->factor[mass->shared] += op->factor != NULL;
    for (size_t i = 0; i < scene->node_count; i++)
      seen->alone[mass->shared] += op->inverse[2 * i + (size_t)c] > 0;
  }
  seen->diagonal += mass->diagonal;
  seen->lumped += scene->mass_model == STRUT_MASS_LUMPED;
}

static void cover_forces(coverage *seen, const fixture *f) {
  const strut_scene *scene = &f->scene;
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *m = &scene->members[j];
    const strut_node *a = &scene->nodes[m->node[0]], *b = &scene->nodes[m->node[1]];
    bool cable = m->kind == STRUT_CABLE, pulls = slow_world_member(&f->slow, &f->at, j) > 0;
    seen->slack += cable && !pulls;
    seen->taut += cable && pulls;
    seen->fixed_member += a->fixed[0] && a->fixed[1] && b->fixed[0] && b->fixed[1];
  }
  for (size_t i = 0; i < scene->actuator_count; i++)
    seen->driven[scene->signals[scene->actuators[i].signal].kind]++;
  for (size_t i = 0; i < scene->load_count; i++)
    if (scene->loads[i].signal >= 0) seen->loaded[scene->signals[scene->loads[i].signal].kind]++;
  for (size_t i = 0; i < scene->contact_count; i++) {
    const strut_contact *c = &scene->contacts[i];
    const double *w = f->state->v + 2 * c->node;
    double slip = w[0] * cos(scene->ground.slope) + w[1] * sin(scene->ground.slope) -
                  scene->ground.belt_speed;
    bool touching = f->rates.normal[i] > 0, rough = c->friction.law == STRUT_FRICTION_KARNOPP;
    bool fast = fabs(slip) >= c->friction.stick_velocity;
    double bound = c->friction.mu_kinetic * (double)f->rates.normal[i];
    bool at_bound = fabs(fabs((double)f->rates.friction[i]) - bound) < 1e-9 * bound;
    seen->touching += touching;
    seen->flying += !touching;
    seen->sliding += touching && rough && fast;
    seen->breaking += touching && rough && !fast && at_bound;
    seen->sticking += touching && rough && !fast && !at_bound;
  }
}

static void recompute(uint64_t seed, coverage *seen) {
  static fixture f;
  double t;
  random_scene(&f.scene, seed);
  f.model = motion_compile(&f.scene);
  assert_non_null(f.model->mass);
  assert_ok(strut_state_create(f.model, &f.state, NULL));
  random_motion(&f.scene, seed, &t, f.state->q, f.state->v);
  slow_world_begin(&f.slow, &f.scene, NULL, 0, &f.at);
  f.at.t = t;
  for (size_t i = 0; i < f.slow.n; i++) f.at.q[i] = f.state->q[i], f.at.v[i] = f.state->v[i];
  slow_world_rates(&f.slow, &f.at, &f.rates);
  assert_false(f.rates.undecided);
  check_forces(&f);
  check_mass(&f);
  check_acceleration(&f);
  cover_mass(seen, &f.scene, f.model->mass);
  cover_forces(seen, &f);
  for (unsigned term = 1; term <= STRUT_TERM_SOLVE; term <<= 1)
    seen->terms[term] += (f.model->terms & term) != 0;
  strut_state_free(f.state);
  strut_model_free(f.model);
  strut_scene_free(&f.scene);
}

TEST(random_scenes_agree_with_a_slow_recomputation) {
  coverage seen = {0};
  for (uint64_t seed = 1; seed <= SCENES; seed++) recompute(seed, &seen);
  /* A scene that exercises something must be among them, else the test says nothing about it. */
  for (int shared = 0; shared < 2; shared++) {
    for (int size = 2; size <= STRUT_DENSE_BLOCK; size++)
      assert_true(seen.block[size][shared] >= 3);
    assert_all(seen.factor[shared] >= 10, seen.alone[shared] >= 10);
  }
  assert_true(seen.diagonal >= 10 && seen.diagonal < SCENES / 2 && seen.lumped >= 10);
  for (unsigned term = 1; term <= STRUT_TERM_SOLVE; term <<= 1) assert_true(seen.terms[term] >= 20);
  for (int kind = STRUT_CONSTANT; kind <= STRUT_SUM; kind++)
    assert_true(seen.driven[kind] >= 5 && seen.loaded[kind] >= 5);
  assert_true(seen.slack >= 50 && seen.taut >= 50 && seen.fixed_member >= 20);
  assert_true(seen.touching >= 50 && seen.flying >= 50);
  assert_true(seen.sticking >= 10 && seen.breaking >= 10 && seen.sliding >= 50);
}
