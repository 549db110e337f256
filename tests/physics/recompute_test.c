/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every compiled force, M and M^-1 F against the slow recomputation, on 200 random scenes. */
#include "engine/model/mass.h"
#include "tests/physics/random_scene.h"
#include "tests/physics/slow_model.h"
#include "tests/support/motion.h"

enum { SCENES = 200 };
static const double TOLERANCE = 1e-13;

/* What the scenes have been seen to exercise. */
typedef struct coverage {
  int block[STRUT_DENSE_BLOCK + 1][2]; /* by size, by whether x and y share */
  int factor[2], diagonal, lumped, alone[2];
  int terms[STRUT_TERM_SOLVE + 1];
  int slack, taut, clipped, touching, flying, sticking, breaking, sliding, driven[STRUT_SUM + 1];
  int loaded[STRUT_SUM + 1], fixed_member;
} coverage;

static void check_mass(const strut_scene *scene, const strut_model *model, const slow_model *slow) {
  double scale = slow_largest(slow->mass, slow->n * slow->n);
  for (size_t c = 0; c < 2; c++) {
    const strut_mass_operator *op = &model->mass->coordinate[c];
    const strut_sparse *m = op->matrix;
    FREED double *dense = calloc(slow->n * slow->n + 1, sizeof *dense);
    size_t row_count = 0;
    assert_non_null(dense);
    for (int32_t j = 0; j < m->n; j++)
      for (int32_t k = m->start[j]; k < m->start[j + 1]; k++) {
        size_t a = 2 * (size_t)op->matrix_node[m->row[k]] + c;
        size_t b = 2 * (size_t)op->matrix_node[j] + c;
        assert_true(m->row[k] >= j);
        dense[a * slow->n + b] = dense[b * slow->n + a] = m->value[k];
      }
    for (size_t i = c; i < slow->n; i += 2) {
      row_count += !scene->nodes[i / 2].fixed[c];
      for (size_t j = c; j < slow->n; j += 2) {
        bool fixed = scene->nodes[i / 2].fixed[c] || scene->nodes[j / 2].fixed[c];
        double expected = fixed ? 0 : (double)slow->mass[i * slow->n + j];
        assert_near(dense[i * slow->n + j], expected, TOLERANCE * scale);
      }
    }
    assert_int_equal(m->n, row_count);
  }
}

static void check_forces(const strut_scene *scene, const strut_model *model, strut_state *state,
                         const slow_model *slow, double t) {
  size_t n = slow->n;
  FREED double *length = calloc(scene->member_count, sizeof *length);
  FREED double *tension = calloc(scene->member_count, sizeof *tension);
  assert_true(length && tension);
  double scale =
      fmax(slow_largest(slow->force, n), slow_largest(slow->tension, scene->member_count));
  scale = fmax(scale, slow_largest(slow->normal, scene->contact_count));
  strut_forces_evaluate(model, state, t, state->q, state->v);
  motion_members(model, state, length, tension);
  for (size_t i = 0; i < n; i++)
    assert_near(state->latest->force[i], (double)slow->force[i], TOLERANCE * scale);
  for (size_t j = 0; j < scene->member_count; j++)
    assert_near(tension[j], (double)slow->tension[j], TOLERANCE * scale);
  for (size_t i = 0; i < scene->contact_count; i++) {
    assert_near(state->latest->normal[i], (double)slow->normal[i], TOLERANCE * scale);
    assert_near(state->latest->friction[i], (double)slow->friction[i], TOLERANCE * scale);
  }
}

static void check_powers(const strut_state *state, const slow_model *slow) {
  const long double expected[] = {slow->drive,   slow->load,    slow->belt,
                                  slow->members, slow->contact, slow->rubbed};
  double scale = 0;
  for (int p = 0; p < STRUT_POWER_EXCHANGED; p++) scale += (double)fabsl(expected[p]);
  for (int p = 0; p < STRUT_POWER_EXCHANGED; p++)
    assert_near(state->latest->power[p], (double)expected[p], TOLERANCE * scale);
  assert_true(state->latest->power[STRUT_POWER_EXCHANGED] >= scale * (1 - TOLERANCE));
}

static void check_acceleration(const strut_scene *scene, const strut_model *model,
                               strut_state *state, const slow_model *slow, double t) {
  FREED double *a = calloc((size_t)model->length, sizeof *a);
  FREED double *with_balance = calloc((size_t)model->length, sizeof *a);
  assert_true(a && with_balance);
  double scale = slow_largest(slow->acceleration, slow->n);
  strut_forces_acceleration(model, state, t, state->q, state->v, a);
  for (size_t i = 0; i < slow->n; i++) {
    assert_near(a[i], (double)slow->acceleration[i], TOLERANCE * scale);
    if (scene->nodes[i / 2].fixed[i % 2]) assert_true(a[i] == 0);
  }
  state->balance = true;
  strut_forces_acceleration(model, state, t, state->q, state->v, with_balance);
  assert_memory_equal(a, with_balance, slow->n * sizeof *a);
  check_powers(state, slow);
  state->balance = false;
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

static void cover_forces(coverage *seen, const strut_scene *scene, const slow_model *slow,
                         const double *v) {
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *m = &scene->members[j];
    const strut_node *a = &scene->nodes[m->node[0]], *b = &scene->nodes[m->node[1]];
    bool cable = m->kind == STRUT_CABLE, pulls = slow->tension[j] > 0;
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
    const double *w = v + 2 * c->node;
    double slip = w[0] * cos(scene->ground.slope) + w[1] * sin(scene->ground.slope) -
                  scene->ground.belt_speed;
    bool touching = slow->normal[i] > 0, rough = c->friction.law == STRUT_FRICTION_KARNOPP;
    bool fast = fabs(slip) >= c->friction.stick_velocity;
    double bound = c->friction.mu_kinetic * (double)slow->normal[i];
    bool at_bound = fabs(fabs((double)slow->friction[i]) - bound) < 1e-9 * bound;
    seen->touching += touching;
    seen->flying += !touching;
    seen->sliding += touching && rough && fast;
    seen->breaking += touching && rough && !fast && at_bound;
    seen->sticking += touching && rough && !fast && !at_bound;
  }
}

static void recompute(uint64_t seed, coverage *seen) {
  OWN(strut_scene) scene;
  OWN_POINTER(strut_state) state;
  slow_model slow;
  double t;
  random_scene(&scene, seed);
  OWN_POINTER(strut_model) model = motion_compile(&scene);
  assert_non_null(model->mass);
  assert_ok(strut_state_create(model, &state, NULL));
  random_motion(&scene, seed, &t, state->q, state->v);
  slow_evaluate(&slow, &scene, t, state->q, state->v);
  check_forces(&scene, model, state, &slow, t);
  check_mass(&scene, model, &slow);
  check_acceleration(&scene, model, state, &slow, t);
  cover_mass(seen, &scene, model->mass);
  cover_forces(seen, &scene, &slow, state->v);
  for (unsigned term = 1; term <= STRUT_TERM_SOLVE; term <<= 1)
    seen->terms[term] += (model->terms & term) != 0;
  slow_free(&slow);
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
