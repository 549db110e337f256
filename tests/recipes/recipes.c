/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What docs/recipes.md adds works: its friction law and its law of members in every method that takes
 * them, its method of integration on a smooth scene, and all through the language and back.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/integrate/integrator.h"
#include "engine/integrate/limit/step_limit.h"
#include "parser/read/read_scene.h"
#include "parser/write/write_scene.h"

static const char BLOCK[] =
    "strut: 1\nname: block\ngravity: [0, -9.81]\n"
    "nodes: {block: {position: [0, -9.81e-5], mass: 1}}\n"
    "ground: {stiffness: 1e5, damping: 100,\n"
    "         friction: {law: rational, mu_kinetic: 0.2, width: 0.1}}\n"
    "initial: {velocity: [1, 0]}\nsolver: {step: 1e-4}\nrun: {duration: 0.3}\n";
static const char LACKS_WIDTH[] =
    "strut: 1\nname: block\nnodes: {block: {position: [0, 0], mass: 1}}\n"
    "ground: {stiffness: 1e5, friction: {law: rational, mu_kinetic: 0.2}}\n"
    "solver: {step: 1e-4}\nrun: {duration: 0.3}\n";
static const char OSCILLATOR[] =
    "strut: 1\nname: oscillator\n"
    "nodes: {wall: {position: [0, 0], fixed: both},\n"
    "        block: {position: [1, 0], mass: 1, fixed: y}}\n"
    "members: {spring: {kind: spring, nodes: [wall, block], stiffness: 100, rest_length: 1}}\n"
    "initial: {positions: {block: [1.01, 0]}}\n"
    "solver: {integrator: euler-forward, step: 1e-4}\nrun: {duration: 1}\n";

static const char STIFFENING[] =
    "strut: 1\nname: stiffening\n"
    "nodes: {wall: {position: [0, 0], fixed: both},\n"
    "        block: {position: [1.5, 0], mass: 1, fixed: y}}\n"
    "members: {spring: {kind: spring, nodes: [wall, block], stiffness: 4, rest_length: 1,\n"
    "                   law: {kind: stiffening, scale: 0.3}}}\n"
    "solver: {step: 1e-3}\nrun: {duration: 1}\n";

static int failures;

static void expect(bool good, const char *what, const char *where, double value) {
  if (good) return;
  printf("%s: %s (%.17g)\n", where, what, value);
  failures++;
}

static bool read_setup(const char *text, strut_setup *setup, bool report) {
  strut_diagnostics diagnostics = {0};
  strut_status status = strut_setup_read(setup, "recipe.yaml", text, strlen(text), NULL, 0,
                                         STRUT_FOR_RUN, &diagnostics);
  for (size_t i = 0; i < diagnostics.count && report; i++)
    printf("%s\n", diagnostics.items[i].message);
  strut_diagnostics_free(&diagnostics);
  return status == STRUT_OK;
}

/* State of node `node` after `time` by the method with steps dt; NAN where it cannot be run. */
static void run(const strut_setup *setup, const strut_integrator *method, double dt, double time,
                int32_t node, double *x, double *v) {
  strut_model *model = NULL;
  strut_state *state = NULL;
  const strut_integrator_settings settings = strut_integrator_settings_of(&setup->experiment);
  void *workspace = NULL;
  *x = *v = (double)NAN;
  if (strut_model_compile(&setup->scene, &model, NULL) == STRUT_OK &&
      strut_state_create(model, &state, NULL) == STRUT_OK &&
      (workspace = method->create(model, state, &settings))) {
    if (method->restart) method->restart(model, state, workspace, dt);
    method->advance(model, state, workspace, dt, llround(time / dt));
    *x = state->q[2 * node], *v = state->v[2 * node];
  }
  strut_state_free(state);
  strut_model_free(model);
}

/* u + w ln u falls at the rate mu g. */
static void test_the_law_in_every_method(void) {
  strut_setup setup, again;
  int runs = 0;
  if (!read_setup(BLOCK, &setup, true)) {
    expect(false, "is refused", "the friction law's scene", 0);
    return;
  }
  char *text = strut_setup_write(&setup);
  bool back = text && read_setup(text, &again, true);
  expect(back && again.scene.contacts[0].friction.law == setup.scene.contacts[0].friction.law &&
             again.scene.contacts[0].friction.width == 0.1,
         "is lost when the scene is written", "the friction law", 0);
  if (back) strut_setup_free(&again);
  strut_release(text);
  expect(!read_setup(LACKS_WIDTH, &again, false), "is not missed", "the law's width", 0);
  for (size_t i = 0; strut_integrator_at(i); i++) {
    const strut_integrator *method = strut_integrator_at(i);
    if (method->no_ground) continue;
    double x, u, t = 0.3, w = 0.1;
    run(&setup, method, 1e-4, t, 0, &x, &u);
    double fell = (1 - u) - w * log(u);
    expect(fabs(fell - 0.2 * 9.81 * t) < 2e-3, "the block slides by another law", method->name, u);
    runs++;
  }
  expect(runs >= 7, "too few methods run", "friction law", runs);
  strut_model *model = NULL;
  strut_step_limit limit = {0};
  expect(strut_model_compile(&setup.scene, &model, NULL) == STRUT_OK &&
             strut_step_limit_estimate(model, &limit, NULL) == STRUT_OK && limit.limit < 0.2,
         "is not known to the step limit", "the law's slope", limit.limit);
  strut_model_free(model);
  strut_setup_free(&setup);
}

/* x'' = -k x (1 + (x/s)^2) from x = 0.5 on, by small steps of its own; x after time t. */
static double stiffened(double t) {
  enum { STEPS = 1000000 };
  double x = 0.5, h = t / STEPS, v = 0;
  for (int i = 0; i < STEPS; i++) {
    double half = v - 0.5 * h * 4 * x * (1 + x * x / 0.09);
    x += h * half;
    v = half - 0.5 * h * 4 * x * (1 + x * x / 0.09);
  }
  return x;
}

static void test_the_member_law_in_every_method(void) {
  strut_setup setup, again;
  if (!read_setup(STIFFENING, &setup, true)) {
    expect(false, "is refused", "the member law's scene", 0);
    return;
  }
  char *text = strut_setup_write(&setup);
  bool back = text && read_setup(text, &again, true);
  expect(back && again.scene.members[0].law.scale == 0.3, "is lost when the scene is written",
         "the member law", 0);
  if (back) strut_setup_free(&again);
  strut_release(text);
  double end = 1 + stiffened(1);
  for (size_t i = 0; strut_integrator_at(i); i++) {
    const strut_integrator *method = strut_integrator_at(i);
    double x, v, tolerance = method->order == 1 ? 1e-2 : 1e-5;
    run(&setup, method, 1e-3, 1.0, 1, &x, &v);
    expect(fabs(x - end) < tolerance, "the block swings by another law", method->name, x - end);
  }
  strut_setup_free(&setup);
}

static void test_the_method(void) {
  strut_setup setup;
  if (!read_setup(OSCILLATOR, &setup, true)) {
    expect(false, "is refused", "the method's scene", 0);
    return;
  }
  const strut_integrator *method = strut_integrator_find(setup.experiment.integrator);
  expect(method && !strcmp(method->name, "euler-forward"), "is not found", "the method", 0);
  double error[2];
  for (int k = 0; method && k < 2; k++) {
    double x, v, dt = k ? 1e-4 : 2e-4;
    run(&setup, method, dt, 1.0, 1, &x, &v);
    error[k] = fabs(x - (1 + 0.01 * cos(10.0)));
  }
  if (method) {
    expect(error[0] < 1e-4, "is far from the cosine", "the method", error[0]);
    expect(fabs(error[0] / error[1] - 2) < 0.1, "is not of first order", "the method",
           error[0] / error[1]);
  }
  strut_setup_free(&setup);
}

int main(void) {
  test_the_law_in_every_method();
  test_the_member_law_in_every_method();
  test_the_method();
  if (!failures) printf("the recipes work\n");
  return failures > 0;
}
