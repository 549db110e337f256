/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What happens between the ends of a step: of random steps of a cloud of nodes with everything that has a strain, no
 * contact and no kink is missed that a dense sampling of the nodes' cubics finds, and none is made up.
 */
#include "engine/forces/elements.h"
#include "engine/integrate/events/event_stepping.h"
#include "tests/models/run_model.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

enum { STEPS = 10000, SAMPLES = 600, NODES = 6, LENGTH = 2 * NODES };

static const char CLOUD[] =
    "nodes: {a: {position: [0, 0], mass: 1}, b: {position: [1, 0], mass: 1},\n"
    "  c: {position: [0, 1], mass: 1}, d: {position: [1, 1], mass: 1},\n"
    "  e: {position: [0, 2], mass: 1}, f: {position: [1, 2], mass: 1}}\n"
    "members:\n"
    "  r1: {kind: bar, nodes: [c, d], stiffness: 1}\n"
    "  r2: {kind: bar, nodes: [e, f], stiffness: 1}\n"
    "  rope: {kind: cable, nodes: [a, d], stiffness: 1, rest_length: 1.5}\n"
    "  run: {kind: cable, nodes: [b, c, f], stiffness: 1, rest_length: 3}\n"
    "  prop: {kind: spring, nodes: [b, e], stiffness: 1, rest_length: 0.4, law: compression_only}\n"
    "  knee: {kind: spring, nodes: [a, e], stiffness: 1, rest_length: 1,\n"
    "    law: {kind: bilinear, knee: 0.5, second_stiffness: 3}}\n"
    "collisions: {balls: {nodes: [a, b], thickness: 0.1, stiffness: 1},\n"
    "             lands: {node: a, member: r1, thickness: 0.1, stiffness: 1},\n"
    "             cross: {members: [r1, r2], thickness: 0.1, stiffness: 1}}\n"
    "distances:\n"
    "  wall: {nodes: [a, f], along: x, rest_distance: -0.5, stiffness: 1, law: compression_only}\n"
    "  line: {node: b, line: [e, f], rest_distance: -0.5, stiffness: 1, law: compression_only}\n"
    "solver: {integrator: adaptive, step: 0.1, tolerance: 1e-6}\n"
    "run: {duration: 1}\n";

/* A hinge that is not turned right round. */
static const char HINGE[] =
    "nodes: {a: {position: [0, 1], mass: 1}, b: {position: [1, 0], mass: 1},\n"
    "  c: {position: [0, 0], mass: 1}, d: {position: [1, 1], mass: 1},\n"
    "  e: {position: [-1, 0], mass: 1}, f: {position: [1, 2], mass: 1}}\n"
    "members: {r1: {kind: bar, nodes: [c, d], stiffness: 1}}\n"
    "hinges: {h: {nodes: [a, c, e], stiffness: 1,\n"
    "  law: {kind: bilinear, knee: 0.5, second_stiffness: 3}}}\n"
    "solver: {integrator: adaptive, step: 0.1, tolerance: 1e-6}\n"
    "run: {duration: 1}\n";

/* A slender cell, one end of whose short side moves. */
static const char CELL[] =
    "nodes: {a: {position: [0, 0], mass: 1}, b: {position: [0.1, 0], fixed: both},\n"
    "  c: {position: [0, 5], fixed: both}, d: {position: [9, 1], mass: 1},\n"
    "  e: {position: [9, 3], mass: 1}, f: {position: [9, 5], mass: 1}}\n"
    "cells: {cell: {nodes: [a, b, c], stiffness: 1, rest_area: 0.25, law: compression_only}}\n"
    "solver: {integrator: adaptive, step: 0.1, tolerance: 1e-6}\n"
    "run: {duration: 1}\n";

static void place(const strut_event_stepper *stepper, double h, double x, double *q, double *v) {
  const strut_step_end *now = stepper->now, *next = stepper->next;
  double r = 1.0 - x;
  for (int32_t i = 0; i < LENGTH; i++) {
    q[i] = now->q[i] * (1.0 + 2.0 * x) * r * r + h * now->v[i] * x * r * r +
           next->q[i] * x * x * (3.0 - 2.0 * x) - h * next->v[i] * x * x * r;
    v[i] = 0.0;
  }
}

/* How far law k is within its mode: negative where it has left it. */
static double margin_of(const motion *m, const strut_event_stepper *stepper, int32_t k,
                        const double *q, const double *v) {
  const strut_law_switch *law = &stepper->laws.item[k];
  const strut_model *model = m->model;
  double side = stepper->laws.acting[k] ? 1.0 : -1.0;
  if (law->element < 0) {
    int32_t j = law->member;
    const double *a = q + model->members.from[j], *b = q + model->members.to[j];
    return side * (hypot(b[0] - a[0], b[1] - a[1]) - model->members.rest[j]);
  }
  const strut_element *e = &model->elements.element[law->element];
  double stretch = strut_element_move(model, m->state, law->element, q, v).stretch, low, high;
  if (law->event == STRUT_EVENT_ACTS) return side * e->carries * stretch;
  strut_law_margins(e->law, &e->numbers, m->state->modes.element_piece[law->element], stretch, &low,
                    &high);
  return fmin(low, high);
}

/* The least margin of all laws at a part of the step. */
static double least_at(const motion *m, const strut_event_stepper *stepper, double h, double x) {
  double q[LENGTH + STRUT_LANES] = {0}, v[LENGTH + STRUT_LANES] = {0}, least = HUGE_VAL;
  place(stepper, h, x, q, v);
  for (int32_t k = 0; k < stepper->laws.count; k++)
    least = fmin(least, margin_of(m, stepper, k, q, v));
  return least;
}

static void random_end(const strut_model *model, uint64_t *seed, double *q, double *v,
                       const double *near, double far, double fast) {
  for (int32_t i = 0; i < LENGTH; i++) {
    double moves = model->fixed[i] ? 0.0 : 1.0;
    q[i] = near[i] + moves * random_between(seed, -far, far);
    v[i] = moves * random_between(seed, -fast, fast);
  }
}

/* A random step from nodes within `far` of the drawn ones; true if something happens that its ends do not show, -1 if
   they show it. */
static int look_at_step(motion *m, uint64_t *seed, double far, double most) {
  strut_event_stepper *stepper = m->workspace;
  double h = random_scale(seed, 1e-3, 1.0), fast = random_scale(seed, 0.03, 1.0) * most / h;
  random_end(m->model, seed, m->state->q, m->state->v, m->model->start, far, fast);
  m->method->restart(m->model, m->state, m->workspace, 0.1);
  stepper->turns.due = INT64_MAX; /* lengths of zero are no law's */
  strut_elements_keep_turns(m->model, m->state);
  random_end(m->model, seed, stepper->next->q, stepper->next->v, stepper->now->q, fast * h, fast);
  strut_event_measure(m->model, m->state, stepper, stepper->now);
  strut_event_measure(m->model, m->state, stepper, stepper->next);
  if (strut_event_first(m->model, m->state, stepper, h).kind) return -1;
  double part = strut_event_between(m->model, m->state, stepper, h), least = HUGE_VAL;
  if (part > 0.0) {
    assert_true(least_at(m, stepper, h, part) < 0.0);
    return 1;
  }
  for (int k = 1; k < SAMPLES; k++)
    least = fmin(least, least_at(m, stepper, h, (double)k / SAMPLES));
  assert_within(least, -1e-6, HUGE_VAL);
  return 0;
}

static void misses_nothing(const char *text, double far, double most) {
  OWN(model_run) run = model_read_text("cloud.yaml", text, set_none);
  OWN(motion) m = motion_begin_by(&run.setup, "adaptive", 0.1);
  uint64_t seed = 59;
  int32_t looked = 0, found = 0;
  for (int n = 0; n < STEPS; n++) {
    int one = look_at_step(&m, &seed, far, most);
    looked += one >= 0, found += one > 0;
  }
  assert_within(looked, STEPS / 20, STEPS);
  assert_within(found, STEPS / 200, STEPS);
}

TEST(nothing_of_a_cloud_is_missed) { misses_nothing(CLOUD, 1.5, 3.0); }
TEST(no_kink_of_a_hinge_is_missed) { misses_nothing(HINGE, 0.3, 0.3); }
TEST(no_area_is_missed) { misses_nothing(CELL, 0.1, 0.3); }

/* Masses that pass an anchor, one another, and the anchor of a spring with a table of forces. */
static const char PASSING[] =
    "nodes: {o: {position: [0, 0], fixed: both}, m: {position: [1.5, 0], mass: 1, fixed: y},\n"
    "  a: {position: [-1, 0.3], mass: 1}, b: {position: [1, 0.3], mass: 3},\n"
    "  p: {position: [0, 1], mass: 2, fixed: x}}\n"
    "members: {s: {kind: spring, nodes: [o, m], stiffness: 100, rest_length: 0.5},\n"
    "  t: {kind: spring, nodes: [a, b], stiffness: 50, rest_length: 0.4},\n"
    "  u: {kind: spring, nodes: [o, p], rest_length: 0.5,\n"
    "    law: {kind: table, points: [[-0.6, -30], [-0.2, -14], [0, 0], [1, 25]]}}}\n"
    "initial: {velocities: {a: [2, 0], b: [-1, 0]}}\n"
    "solver: {step: 0.5 ms, tolerance: 1e-10}\n"
    "run: {duration: 6 s}\n";

/* x'' = -w^2 (x - rest), mirrored where x < 0: cosines from passage to passage. */
static double passing(double x, double v, double w, double rest, double t) {
  double size = hypot(x - rest, v / w), reach = acos(-rest / size);
  double phase = atan2(-v / w, x - rest) + w * t, half = floor((phase + reach) / (2 * reach));
  return (fmod(half, 2) != 0 ? -1 : 1) * (rest + size * cos(phase - 2 * half * reach));
}

TEST(forces_turn_round_at_zero_length) {
  static const struct {
    const char *method;
    double off;
  } methods[] = {
      {"adaptive8", 1e-9}, {"adaptive", 1e-7}, {"rk4-events", 1e-8}, {"verlet-events", 1e-4}};
  double apart = passing(2, -3, sqrt(50 * 4 / 3.0), 0.4, 6), middle = 0.5 - 0.25 * 6;
  for (int k = 0; k < 4; k++) {
    OWN(model_run) run = model_read_text("passing.yaml", PASSING, set_none);
    model_simulate_by(&run, methods[k].method);
    assert_near(model_position(&run, "m")[0], passing(1.5, 0, 10, 0.5, 6), methods[k].off);
    assert_near(model_position(&run, "a")[0], middle - 0.75 * apart, methods[k].off);
    assert_near(model_position(&run, "p")[1], 0.87404697173, methods[k].off); /* scipy */
    assert_near(run.summary.energy.residual, 0, 500 * methods[k].off);
  }
}
