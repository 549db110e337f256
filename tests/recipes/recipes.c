/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What docs/dev/recipes.md adds works: its friction law, its law of members and its strain in every method, at
 * rest and in the step limit; its method of integration on a smooth scene; and all through the language and back.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/integrate/integrator.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/run/settle.h"
#include "engine/statics/equilibria/equilibria.h"
#include "parser/language/read/read_scene.h"
#include "parser/language/write/write_scene.h"

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

int test_an_observable(void); /* observable.c */
/* things.c */
int test_a_number_of_hinges(void);
int test_a_kind_of_thing(void);

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

/* ---- runs by every method ---- */

typedef struct run_plan {
  const strut_setup *setup;
  double dt, time;
  /* Compares a state at the end. */
  void (*compare)(const strut_setup *setup, const strut_integrator *method, const double *q,
                  const double *v);
  int methods; /* runs made */
} run_plan;

static bool step(const strut_model *model, strut_state *state, const strut_integrator *method,
                 const run_plan *terms) {
  strut_integrator_settings settings = strut_integrator_settings_of(&terms->setup->experiment);
  int64_t count = llround(terms->time / terms->dt);
  settings.step = terms->dt;
  void *workspace = method->create(model, state, &settings);
  if (!workspace) return false;
  if (method->restart) method->restart(model, state, workspace, terms->dt);
  strut_integrator_advance(method, model, state, workspace, terms->dt, count);
  return true;
}

static void run(run_plan *terms, const strut_integrator *method) {
  strut_model *model = NULL;
  strut_state *state = NULL;
  bool good = !strut_model_compile(&terms->setup->scene, &model, NULL) &&
              !strut_state_create(model, &state, NULL) && step(model, state, method, terms);
  expect(good, "is not stepped", method->name, 0);
  if (good) terms->compare(terms->setup, method, state->q, state->v);
  terms->methods++;
  strut_state_free(state);
  strut_model_free(model);
}

static void run_all(run_plan *terms) {
  bool ground = terms->setup->scene.contact_count > 0;
  for (size_t i = 0; strut_integrator_at(i); i++) {
    const strut_integrator *method = strut_integrator_at(i);
    if (method->no_ground && ground) continue;
    run(terms, method);
  }
}

static double limit_of(const strut_setup *setup) {
  strut_model *model = NULL;
  strut_step_limit limit = {.limit = (double)NAN};
  if (!strut_model_compile(&setup->scene, &model, NULL))
    strut_step_limit_estimate(model, &limit, NULL);
  strut_model_free(model);
  return limit.limit;
}

/* ---- the friction law ---- */

/* Blocks in a row, joined by springs that nothing stretches, slide as one does. */
static void write_blocks(char *text, size_t size, int count) {
  int used = snprintf(text, size, "strut: 1\nname: blocks\ngravity: [0, -9.81]\nnodes:\n");
  for (int i = 0; i < count; i++)
    used += snprintf(text + used, size - (size_t)used,
                     "  n%d: {position: [%d, -9.81e-5], mass: 1}\n", i, i);
  if (count > 1) used += snprintf(text + used, size - (size_t)used, "members:\n");
  for (int i = 1; i < count; i++)
    used += snprintf(text + used, size - (size_t)used,
                     "  s%d: {kind: spring, nodes: [n%d, n%d], stiffness: 4000, damping: 20,\n"
                     "       rest_length: 1}\n",
                     i, i - 1, i);
  snprintf(text + used, size - (size_t)used,
           "ground: {stiffness: 1e5, damping: 100,\n"
           "         friction: {law: rational, mu: 0.2, width: 0.1}}\n"
           "initial: {velocity: [1, 0]}\nsolver: {step: 1e-4}\nrun: {duration: 0.3}\n");
}

/* u + w ln u falls at the rate mu g. */
static void compare_blocks(const strut_setup *setup, const strut_integrator *method,
                           const double *q, const double *v) {
  double t = 0.3, w = 0.1;
  (void)q;
  for (size_t i = 0; i < setup->scene.node_count; i++) {
    double u = v[2 * i], fell = (1 - u) - w * log(u);
    expect(fabs(fell - 0.2 * 9.81 * t) < 2e-3, "a block slides by another law", method->name, u);
  }
}

static void test_the_friction_law(int count) {
  char text[4000];
  strut_setup setup, again;
  write_blocks(text, sizeof text, count);
  if (!read_setup(text, &setup, true)) {
    expect(false, "is refused", "the friction law's scene", count);
    return;
  }
  char *written = strut_setup_write(&setup);
  bool back = written && read_setup(written, &again, true);
  expect(back && again.scene.contacts[0].friction.law == setup.scene.contacts[0].friction.law &&
             again.scene.contacts[0].friction.width == 0.1,
         "is lost when the scene is written", "the friction law", count);
  if (back) strut_setup_free(&again);
  strut_release(written);
  run_plan terms = {.setup = &setup, .dt = 1e-4, .time = 0.3, .compare = compare_blocks};
  run_all(&terms);
  expect(terms.methods >= 8, "too few runs are made", "friction law", terms.methods);
  expect(limit_of(&setup) < 0.2, "is not known to the step limit", "the law's slope", 0);
  strut_setup_free(&setup);
}

/* ---- the law of members and the strain ---- */

/*
 * Pairs of a wall and a block at 1.5 m on a member of 1 m. With the strain `span`, which bars have, the block
 * moves across as if there were none.
 */
static void write_pairs(char *text, size_t size, int count, const char *kind, bool load) {
  bool bar = !strcmp(kind, "bar");
  int used = snprintf(text, size, "strut: 1\nname: pairs\nnodes:\n");
  for (int i = 0; i < count; i++)
    used += snprintf(text + used, size - (size_t)used,
                     "  wall%d: {position: [0, %d], fixed: both}\n"
                     "  block%d: {position: [1.5, %d], mass: 1%s}\n",
                     i, 3 * i, i, 3 * i, bar && !load ? "" : ", fixed: y");
  used += snprintf(text + used, size - (size_t)used, "members:\n");
  for (int i = 0; i < count; i++)
    used += snprintf(text + used, size - (size_t)used,
                     "  m%d: {kind: %s, nodes: [wall%d, block%d], stiffness: 4, rest_length: 1,\n"
                     "       law: {kind: stiffening, scale: 0.3}}\n",
                     i, kind, i, i);
  if (load) used += snprintf(text + used, size - (size_t)used, "gravity: [5, 0]\n");
  if (bar && !load) {
    used += snprintf(text + used, size - (size_t)used, "initial: {velocities: {");
    for (int i = 0; i < count; i++)
      used += snprintf(text + used, size - (size_t)used, "%sblock%d: [0, 2]", i ? ", " : "", i);
    used += snprintf(text + used, size - (size_t)used, "}}\n");
  }
  snprintf(text + used, size - (size_t)used, "solver: {step: 1e-3}\nrun: {duration: 1}\n");
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

static double stiffened_end;

static void compare_pairs(const strut_setup *setup, const strut_integrator *method, const double *q,
                          const double *v) {
  double tolerance = method->order == 1 ? 1e-2 : 1e-5;
  bool across = setup->scene.members[0].kind == STRUT_BAR;
  (void)v;
  for (size_t i = 1; i < setup->scene.node_count; i += 2) {
    double x = q[2 * i] - 1 - stiffened_end;
    double y = q[2 * i + 1] - setup->scene.nodes[i].position[1] - (across ? 2.0 : 0.0);
    expect(fabs(x) < tolerance, "a block swings by another law", method->name, x);
    expect(fabs(y) < 1e-9, "a block is drawn across", method->name, y);
  }
}

/* At rest under 5 N: 4 x (1 + x^2 / 0.09) = 5. */
static void test_at_rest(const char *kind) {
  char text[4000];
  strut_setup setup;
  strut_model *model = NULL;
  double x = 0.5;
  for (int i = 0; i < 50; i++) x -= (4 * x * (1 + x * x / 0.09) - 5) / (4 * (1 + 3 * x * x / 0.09));
  write_pairs(text, sizeof text, 2, kind, true);
  if (!read_setup(text, &setup, true) || strut_model_compile(&setup.scene, &model, NULL)) {
    expect(false, "is refused", "the scene at rest", 0);
    return;
  }
  strut_equilibria found = {0};
  strut_equilibria_options options = {.starts = 50};
  strut_error error = {0};
  bool good = !strut_equilibria_find(model, &setup.experiment, &options, &found, &error);
  expect(good && found.count >= 1, error.message, "equilibria", (double)found.count);
  bool there = false;
  for (size_t i = 0; i < found.count; i++)
    there = there || fabs(found.list[i].point.q[2] - 1 - x) < 1e-6;
  expect(there, "no equilibrium is where the law balances the load", kind, 1 + x);
  strut_equilibria_free(&found);
  double *q = strut_allocate((size_t)model->length, sizeof *q);
  strut_settle_summary how = {0};
  good = q && !strut_settle_experiment(model, &setup.experiment, NULL, q, &how, &error);
  expect(good, error.message, "settling", 0);
  expect(good && fabs(q[2] - 1 - x) < 1e-4, "settles elsewhere", kind, good ? q[2] : 0);
  strut_release(q);
  strut_model_free(model);
  strut_setup_free(&setup);
}

static void test_the_member_law(int count, const char *kind) {
  char text[4000];
  strut_setup setup, again;
  write_pairs(text, sizeof text, count, kind, false);
  if (!read_setup(text, &setup, true)) {
    expect(false, "is refused", "the member law's scene", 0);
    return;
  }
  char *written = strut_setup_write(&setup);
  bool back = written && read_setup(written, &again, true);
  expect(back && again.scene.members[0].law.scale == 0.3, "is lost when the scene is written",
         "the member law", 0);
  if (back) strut_setup_free(&again);
  strut_release(written);
  run_plan terms = {.setup = &setup, .dt = 1e-3, .time = 1, .compare = compare_pairs};
  run_all(&terms);
  expect(terms.methods >= 9, "too few runs are made", kind, terms.methods);
  /* about the start it is 4 (1 + 3 x^2 / s^2) = 37 N/m; rk4 is stable up to 2.83 over the rate */
  double limit = limit_of(&setup);
  expect(limit > 0 && limit < 2.83 / sqrt(4 * (1 + 0.75 / 0.09)) + 0.01,
         "is not known to the step limit", kind, limit);
  strut_setup_free(&setup);
  test_at_rest(kind);
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
    strut_model *model = NULL;
    strut_state *state = NULL;
    run_plan terms = {.setup = &setup, .dt = k ? 1e-4 : 2e-4, .time = 1};
    bool good = !strut_model_compile(&setup.scene, &model, NULL) &&
                !strut_state_create(model, &state, NULL) && step(model, state, method, &terms);
    error[k] = good ? fabs(state->q[2] - (1 + 0.01 * cos(10.0))) : (double)NAN;
    strut_state_free(state);
    strut_model_free(model);
  }
  if (method) {
    expect(error[0] < 1e-4, "is far from the cosine", "the method", error[0]);
    expect(fabs(error[0] / error[1] - 2) < 0.1, "is not of first order", "the method",
           error[0] / error[1]);
  }
  strut_setup_free(&setup);
}

int main(void) {
  strut_setup setup;
  expect(!read_setup(LACKS_WIDTH, &setup, false), "is not missed", "the law's width", 0);
  test_the_friction_law(1);
  test_the_friction_law(5);
  stiffened_end = stiffened(1);
  test_the_member_law(1, "spring");
  test_the_member_law(5, "spring");
  test_the_member_law(1, "bar");
  test_the_member_law(5, "bar");
  test_the_method();
  failures += test_a_number_of_hinges();
  failures += test_a_kind_of_thing();
  failures += test_an_observable();
  if (!failures) printf("the recipes work\n");
  return failures > 0;
}
