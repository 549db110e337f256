/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of many collisions only those of near bodies are evaluated, and the motion is the same to the last bit. */
#include "engine/forces/nearby.h"

#include "engine/forces/elements.h"
#include "tests/models/run_model.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

enum { RODS = 49, ROW = 7 };

/* Rods in rows that fly about; each collides with all others. */
static void read_crowd(uint64_t *r, double mu, model_run *run) {
  char *text = malloc(400 * RODS + 1000), *at = text;
  at += sprintf(at, "strut: 1\nnodes:\n");
  for (int k = 0; k < RODS; k++) {
    double x = 0.15 * (k % ROW), y = 0.15 * (k / ROW), lean = random_between(r, -0.04, 0.04);
    at += sprintf(at, "  a%d: {position: [%g, %g], mass: 0.01}\n", k, x, y);
    at += sprintf(at, "  b%d: {position: [%g, %g], mass: 0.01}\n", k, x + 0.1, y + lean);
  }
  at += sprintf(at, "members:\n");
  for (int k = 0; k < RODS; k++)
    at += sprintf(at, "  m%d: {kind: bar, nodes: [a%d, b%d], stiffness: 1e3}\n", k, k, k);
  at += sprintf(at,
                "collisions: {hit: {between: all, thickness: 0.02, stiffness: 500, damping: 0.1, "
                "friction: {mu: %g, width: 0.01}}}\n",
                mu);
  at += sprintf(at, "initial:\n  velocities:\n");
  for (int k = 0; k < RODS; k++) {
    double vy = random_between(r, -2, 2), vx = random_between(r, -2, 2);
    at += sprintf(at, "    a%d: [%g, %g]\n", k, vx, vy);
  }
  sprintf(at, "solver: {step: 0.2 ms}\nrun: {duration: 1 s}\n");
  *run = model_read_text("crowd.yaml", text, set_none);
  assert_ok(strut_model_compile(&run->setup.scene, &run->model, NULL));
  free(text);
}

/* Positions and velocities after so many steps; evaluations in `*evaluations`. */
static void fly(const model_run *run, const char *method, double *end, int64_t *events) {
  const strut_integrator *by = strut_integrator_find(method);
  strut_integrator_settings settings = strut_integrator_settings_of(&run->setup.experiment);
  OWN_POINTER(strut_state) state = NULL;
  size_t length = (size_t)run->model->length;
  assert_ok(strut_state_create(run->model, &state, NULL));
  state->balance = true;
  void *workspace = by->create(run->model, state, &settings);
  assert_non_null(workspace);
  strut_integrator_advance(by, run->model, state, workspace, 2e-4, 400);
  assert_int_equal(state->trouble, STRUT_FAILURE_NONE);
  memcpy(end, state->q, length * sizeof *end);
  memcpy(end + length, state->v, length * sizeof *end);
  *events = state->events;
  if (run->model->elements.scattered) assert_true(state->nearby->made > 1);
}

TEST(bits_are_those_of_all_collisions) {
  static const char *const methods[] = {"rk4", "verlet", "rk4-events", "verlet-events", "adaptive"};
  for (size_t m = 0; m < 2 * sizeof methods / sizeof *methods; m++) {
    uint64_t r = 11 + m;
    OWN(model_run) run = {0};
    read_crowd(&r, m % 2 ? 0.3 : 0.0, &run);
    strut_element_table *t = (strut_element_table *)&run.model->elements;
    assert_true(t->scattered);
    size_t count = 2 * (size_t)run.model->length;
    FREED double *few = calloc(count, sizeof *few), *all = calloc(count, sizeof *all);
    int64_t events[2] = {0};
    fly(&run, methods[m / 2], few, &events[0]);
    t->scattered = false;
    fly(&run, methods[m / 2], all, &events[1]);
    assert_memory_equal(few, all, count * sizeof *few);
    assert_true(events[0] == events[1]);
    if (m / 2 > 1) assert_true(events[0] > 10);
  }
}

/* Whoever touches is listed, few others are, and bodies that jump are found as well. */
TEST(lists_have_whoever_touches) {
  uint64_t r = 3;
  OWN(model_run) run = {0};
  read_crowd(&r, 0.0, &run);
  const strut_model *model = run.model;
  OWN_POINTER(strut_state) state = NULL;
  assert_ok(strut_state_create(model, &state, NULL));
  FREED double *q = calloc((size_t)model->length, sizeof *q);
  double b[STRUT_MOST_GRADIENT];
  int64_t listed = 0, touching = 0, times = 300;
  memcpy(q, state->q, (size_t)model->length * sizeof *q);
  for (int64_t n = 0; n < times; n++) {
    double way = n % 50 ? 0.004 : 0.3;
    for (int32_t i = 0; i < model->length; i++) q[i] += random_between(&r, -way, way);
    const strut_nearby *near = strut_nearby_at(model, state, q);
    listed += near->count;
    for (int32_t i = 0, k = 0; i < model->elements.count; i++) {
      bool has = k < near->count && near->element[k] == i;
      assert_int_equal(strut_nearby_find(near, i), k);
      const strut_element *e = &model->elements.element[i];
      bool touches = strut_element_strain(model, i, q, 0.0, b) < e->natural;
      touching += touches;
      assert_true(has || !touches);
      k += has;
    }
  }
  assert_all(touching > times, listed < times * model->elements.count / 10);
}

/* The largest stable step takes as many bodies as may be packed together to touch, not all of them. */
TEST(few_crowd_at_a_node) {
  uint64_t r = 5;
  OWN(model_run) run = {0};
  read_crowd(&r, 0.0, &run);
  int32_t at_node[2 * RODS] = {0};
  for (int32_t i = 0; i < run.model->elements.count; i++) {
    const strut_element *e = &run.model->elements.element[i];
    for (int32_t k = 0; k < e->nodes && e->crowds; k++)
      at_node[run.model->elements.at[e->first + k] / 2]++;
  }
  for (int n = 0; n < 2 * RODS; n++) assert_in_range(at_node[n], 1, 8);
}
