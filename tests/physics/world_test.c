/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Every element, ground, drive, sensor and state once more: forces and accelerations of random scenes at
 * random instants, and whole motions by a Runge-Kutta method of the test's own, against the engine's.
 */
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/history.h"
#include "tests/models/run_model.h"
#include "tests/physics/random_world.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

enum { STEPS = 100 };
static uint64_t scenes = 25,
                motions = 5; /* of each kind; more of them: test_world SCENES MOTIONS */
static const double TOLERANCE = 1e-11, MOTION_TOLERANCE = 1e-9, STEP = 1e-3;

static const unsigned kinds[] = {0,
                                 WORLD_BODIES,
                                 WORLD_GROUNDS,
                                 WORLD_DRIVES,
                                 WORLD_FEEDBACK | WORLD_GROUNDS,
                                 WORLD_MEMORY,
                                 WORLD_ALL & ~WORLD_SAMPLES};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

typedef struct fixture {
  random_world world;
  model_run run;
  motion m;
  slow_world slow;
  slow_instant at;
} fixture;

static void begin(fixture *f, uint64_t seed, unsigned parts) {
  random_world_make(&f->world, seed, parts);
  f->run = model_read_text("random.yaml", f->world.text, set_none);
  f->m = motion_begin_by(&f->run.setup, "rk4", STEP);
  slow_world_begin(&f->slow, &f->run.setup.scene, f->world.texts, f->world.text_count, &f->at);
}

static void end(fixture *f) {
  motion_free(&f->m);
  model_run_free(&f->run);
}

/* Somewhere near the start, at any speed. */
static void disturb(fixture *f, uint64_t *r) {
  f->at.t = random_between(r, 0, 2);
  for (size_t i = 0; i < f->slow.n; i++) {
    if (f->run.setup.scene.nodes[i / 2].fixed[i % 2]) continue;
    f->at.q[i] += random_between(r, -0.1, 0.1);
    f->at.v[i] = random_between(r, -1, 1);
  }
  for (size_t k = 0; k < f->slow.states; k++) f->at.z[k] = random_between(r, -1, 1);
}

/* The engine's state stands at the test's instant; what is left of rounding is taken over. */
static void stand_there(fixture *f) {
  strut_state *state = f->m.state;
  int32_t base = f->m.model->feedback.base;
  f->at.t = (double)f->at.t;
  slow_world_place(&f->slow, &f->at);
  for (size_t i = 0; i < f->slow.n; i++) {
    f->at.q[i] = state->q[i] = (double)f->at.q[i];
    f->at.v[i] = state->v[i] = (double)f->at.v[i];
  }
  for (size_t k = 0; k < f->slow.states; k++)
    f->at.z[k] = state->v[base + (int32_t)k] = (double)f->at.z[k];
}

typedef struct coverage {
  int touching, flying, sticking, acting;
} coverage;

/* Contacts of the same node. */
static int grounds_of(const fixture *f, const slow_rates *r, size_t contact) {
  const strut_scene *scene = &f->run.setup.scene;
  int count = 0;
  for (size_t i = 0; i < scene->contact_count; i++)
    count += scene->contacts[i].node == scene->contacts[contact].node && r->normal[i] > 0;
  return count;
}

static void check_contacts(const fixture *f, const slow_rates *r, double scale, coverage *seen) {
  const strut_state *state = f->m.state;
  for (size_t i = 0; i < f->run.setup.scene.contact_count; i++) {
    seen->flying += r->normal[i] == 0;
    if (!(r->normal[i] > 0)) continue;
    seen->touching++;
    assert_near(state->latest->normal[i], (double)r->normal[i], TOLERANCE * scale);
    if (grounds_of(f, r, i) < 3) /* several that stick may share in many ways */
      assert_near(state->latest->friction[i], (double)r->friction[i], TOLERANCE * scale);
  }
}

static void check_rates(fixture *f, coverage *seen) {
  const strut_scene *scene = &f->run.setup.scene;
  strut_state *state = f->m.state;
  double a[2 * SLOW_PLACES], length[SLOW_ITEMS], force[SLOW_ITEMS];
  slow_rates r;
  slow_world_rates(&f->slow, &f->at, &r);
  if (r.undecided) return;
  assert_true(f->m.model->length <= 2 * SLOW_PLACES);
  strut_forces_acceleration(f->m.model, state, (double)f->at.t, state->q, state->v, a);
  double scale =
      fmax(slow_largest(r.force, f->slow.n), slow_largest(r.normal, scene->contact_count));
  double fastest = slow_largest(r.a, f->slow.n);
  for (size_t i = 0; i < f->slow.n; i++) {
    assert_near(state->latest->force[i], (double)r.force[i], TOLERANCE * scale);
    if (!scene->nodes[i / 2].fixed[i % 2]) assert_near(a[i], (double)r.a[i], TOLERANCE * fastest);
  }
  for (size_t k = 0; k < f->slow.states; k++)
    assert_near(state->latest->force[f->m.model->feedback.base + (int32_t)k], (double)r.z[k],
                TOLERANCE * (scale + slow_largest(r.z, f->slow.states)));
  check_contacts(f, &r, scale, seen);
  motion_members(f->m.model, state, length, force);
  for (size_t j = 0; j < scene->member_count; j++)
    assert_near(force[j], (double)slow_world_member(&f->slow, &f->at, j), TOLERANCE * scale);
}

BEFORE_ALL {
  scenes = (uint64_t)test_number(1, (double)scenes);
  motions = (uint64_t)test_number(2, (double)motions);
}

TEST(forces_by_definition) {
  static fixture f;
  coverage seen = {0};
  for (size_t k = 0; k < KINDS; k++)
    for (uint64_t seed = 1; seed <= scenes; seed++) {
      uint64_t r = seed;
      begin(&f, seed, kinds[k]);
      for (int again = 0; again < 3; again++) {
        disturb(&f, &r);
        stand_there(&f);
        check_rates(&f, &seen);
      }
      end(&f);
    }
  int least = 20 * (int)scenes; /* as the scenes are made, not by accident */
  assert_true(seen.touching > least && seen.flying > least);
}

/* The largest difference of the two, relative to the largest of their kind. */
static double difference(const fixture *f) {
  const strut_state *state = f->m.state;
  int32_t base = f->m.model->feedback.base;
  double far = slow_largest(f->at.q, f->slow.n), fast = slow_largest(f->at.v, f->slow.n), worst = 0;
  for (size_t i = 0; i < f->slow.n; i++) {
    worst = fmax(worst, fabs(state->q[i] - (double)f->at.q[i]) / far);
    worst = fmax(worst, fabs(state->v[i] - (double)f->at.v[i]) / fast);
  }
  for (size_t k = 0; k < f->slow.states; k++)
    worst = fmax(worst, fabs(state->v[base + (int32_t)k] - (double)f->at.z[k]) / (1 + fast));
  for (size_t j = 0; j < f->run.setup.scene.member_count; j++) {
    const strut_element *e = strut_element_of_member(&f->m.model->elements, (int32_t)j);
    if (e && e->remembers && e->law == STRUT_LAW_ELASTIC_PLASTIC)
      worst = fmax(worst, fabs(state->history.plastic[e->memory] - (double)f->slow.plastic[0][j]));
  }
  return worst;
}

/* Steps by both; returns how many. */
static int step_both(fixture *f, double *worst) {
  strut_state *state = f->m.state;
  strut_support_motion_place(f->m.model, state, 0, state->q, state->v);
  strut_history_begin(f->m.model, state, 0);
  for (int step = 0; step < STEPS; step++) {
    if (!slow_world_step(&f->slow, &f->at, (long double)STEP)) return step;
    strut_integrator_advance(f->m.method, f->m.model, state, f->m.workspace, STEP, 1);
    *worst = fmax(*worst, difference(f));
    if (!(*worst < MOTION_TOLERANCE)) return step;
  }
  return STEPS;
}

TEST(motions) {
  static fixture f;
  for (size_t k = 0; k < KINDS; k++) {
    unsigned parts = k < 4 ? kinds[k] : kinds[k] | WORLD_SAMPLES;
    double worst = 0;
    int steps = 0;
    for (uint64_t seed = 1; seed <= motions; seed++) {
      begin(&f, seed, parts);
      steps += step_both(&f, &worst);
      if (!(worst < MOTION_TOLERANCE))
        print_error("parts %u, seed %d: %g\n", parts, (int)seed, worst);
      end(&f);
      if (!(worst < MOTION_TOLERANCE)) break;
    }
    assert_true(worst < MOTION_TOLERANCE && steps > (int)motions * STEPS / 4);
  }
}

/* A mass of 1 kg in the corner of two sides, pushed along them; `rest` begins with its depth. */
static model_run rest_in_corner(motion *m, const char *rest) {
  char text[512];
  snprintf(text, sizeof text,
           "strut: 1\ngravity: [0, -9.81]\nsolver: {step: 1 ms}\nrun: {duration: 0.2}\n"
           "nodes: {a: {mass: 1, position: [0, %s}\n",
           rest);
  model_run run = model_read_text("corner.yaml", text, set_none);
  *m = motion_begin(&run.setup.scene, STEP);
  strut_forces_evaluate(m->model, m->state, 0, m->state->q, m->state->v);
  return run;
}

/* Frictions of two sides that meet flatly: found in turns they would take hundreds of turns. */
TEST(a_node_rests_in_a_flat_corner) {
  OWN(motion) m;
  OWN(model_run) run =
      rest_in_corner(&m,
                     "-4.96 mm]}}\nloads: {push: {node: a, force: [1, 0]}}\n"
                     "ground: {profile: [[-1, 0.05], [0, 0], [1, 0.05]], stiffness: 1000,"
                     " friction: {mu: 0.5, stick_velocity: 0.1}");
  assert_all_near(1e-13, m.state->latest->force[0], 0, m.state->latest->force[1], 0);
  assert_within(m.state->latest->friction[0], 0.3, 0.4);
  assert_within(m.state->latest->friction[1], -1.4, -1.3);
}

/* Too deep to be held by both: the first side breaks loose, and the second holds the rest. */
TEST(one_side_of_a_flat_corner_breaks_loose) {
  OWN(motion) m;
  OWN(model_run) run =
      rest_in_corner(&m,
                     "-10 mm]}}\nloads: {push: {node: a, force: [2, 0]}}\n"
                     "ground: {profile: [[-1, 0.0159], [0, 0], [1, -0.015]], stiffness: 1000,"
                     " friction: {mu_forward: 0.5, mu_backward: 0.2, stick_velocity: 0.1}");
  const double *f = m.state->latest->force, *t = m.state->latest->pose[1].axes.tangent;
  assert_near(m.state->latest->friction[0], 0.2 * m.state->latest->normal[0], 1e-13);
  assert_near(f[0] * t[0] + f[1] * t[1], 0, 1e-13);
  assert_within(m.state->latest->friction[1], -4.2, -4.1);
}
