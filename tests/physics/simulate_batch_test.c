/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Runs in lanes against the same runs alone: summaries, recorded rows and failures, bit for bit, with
 * runs of all lengths, of other methods and topologies, that become steady, and that fail.
 */
#include <math.h>
#include <string.h>

#include "engine/integrate/batch/batch.h"
#include "engine/run/simulate.h"
#include "tests/support/build.h"
#include "tests/support/check.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"
#include "tests/support/structures.h"

enum { POINTS = 37 };

/* What a sink saw, as one number, and how much of it. */
typedef struct trace {
  size_t width, rows;
  uint64_t hash;
  strut_status ended;
} trace;

static strut_status trace_begin(void *context, const strut_record_layout *layout,
                                strut_error *error) {
  (void)error;
  *(trace *)context = (trace){.width = layout->width, .hash = 14695981039346656037u};
  return STRUT_OK;
}

static strut_status trace_rows(void *context, const double *rows, size_t count,
                               strut_error *error) {
  trace *t = context;
  (void)error;
  for (size_t i = 0; i < count * t->width; i++) {
    uint64_t bits;
    memcpy(&bits, &rows[i], sizeof bits);
    t->hash = (t->hash ^ bits) * 1099511628211u;
  }
  t->rows += count;
  return STRUT_OK;
}

static strut_status trace_end(void *context, strut_status status, strut_error *error) {
  (void)error;
  ((trace *)context)->ended = status;
  return STRUT_OK;
}

typedef struct point {
  strut_setup setup;
  strut_model *model;
  strut_run_options options;
  strut_sink sink, *sinks[1];
  trace seen;
  strut_summary summary;
  strut_status status;
  int given, back;
} point;

typedef struct points {
  point at[POINTS];
  int next, count;
} points;

static bool next_point(void *context, strut_batch_point *p) {
  points *all = context;
  if (all->next == all->count) return false;
  point *it = &all->at[all->next++];
  it->given++;
  *p = (strut_batch_point){it->model, &it->setup.experiment, &it->options, it};
  return true;
}

static void take_result(void *context, const strut_batch_point *p, strut_status status,
                        strut_summary *summary, const strut_error *error) {
  point *it = p->context;
  (void)context, (void)error;
  it->back++;
  it->status = status;
  it->summary = *summary;
  strut_model_free(it->model); /* nobody may ask for it again */
  it->model = NULL;
}

static void same_number(double a, double b) {
  if (!isnan(a) || !isnan(b)) assert_same_bits(a, b);
}

static void same_energy(const strut_energy *a, const strut_energy *b) {
  const double *x = (const double *)a, *y = (const double *)b;
  for (size_t i = 0; i < sizeof *a / sizeof *x; i++) same_number(x[i], y[i]);
}

static void same_summary(const strut_summary *a, const strut_summary *b) {
  assert_int_equal(a->status, b->status);
  assert_string_equal(a->reason, b->reason);
  same_number(a->velocity, b->velocity);
  same_number(a->velocity_spread, b->velocity_spread);
  same_number(a->window.start, b->window.start);
  same_number(a->duration, b->duration);
  assert_int_equal(a->spent.steps, b->spent.steps);
  assert_int_equal(a->spent.evaluations, b->spent.evaluations);
  assert_int_equal(a->spent.events, b->spent.events);
  assert_string_equal(a->method, b->method);
  same_number(a->step, b->step);
  same_number(a->step_limit, b->step_limit);
  same_number(a->limit_fell.limit, b->limit_fell.limit);
  assert_int_equal(a->limit_fell.steps, b->limit_fell.steps);
  assert_int_equal(a->end.node_count, b->end.node_count);
  for (size_t i = 0; i < 2 * a->end.node_count; i++)
    same_number(a->end.positions[i], b->end.positions[i]);
  assert_int_equal(a->end.contact_count, b->end.contact_count);
  for (size_t i = 0; i < a->end.contact_count; i++) {
    same_number(a->end.contacts[i].duty, b->end.contacts[i].duty);
    same_number(a->end.contacts[i].max_height, b->end.contacts[i].max_height);
    same_number(a->end.contacts[i].band_needed, b->end.contacts[i].band_needed);
  }
  same_energy(&a->energy, &b->energy);
  assert_int_equal(a->steady.kind, b->steady.kind);
  assert_int_equal(a->steady.repeats, b->steady.repeats);
  assert_int_equal(a->steady.periods, b->steady.periods);
  same_number(a->steady.interval, b->steady.interval);
  same_number(a->steady.residual, b->steady.residual);
}

/* The crawler, sometimes as something that no lane takes, or that fails. */
static void make_scene(strut_setup *setup, int i, const char *method, uint64_t *r) {
  strut_setup_init(setup);
  double mu = random_between(r, 0.05, 0.6), amplitude = random_between(r, 1e-5, 3e-4);
  structure_crawler(&setup->scene, random_between(r, 2, 20), amplitude, mu, i % 2);
  strut_experiment *e = &setup->experiment;
  e->step = random_between(r, 5e-5, 1e-4);
  e->duration = random_between(r, 0.02, 0.5);
  e->measure_last = random_between(r, 0.1, 1.0) * e->duration;
  if (i % 4 == 1)
    setup->scene.contacts[0].stiffness *= 0.9; /* the limit of the step is another one */
  if (i % 8 == 4) setup->scene.members[0].stiffness *= 0.95;
  if (i % 7 == 2) setup->scene.signals[0].kind = STRUT_HALF_SINE;
  e->integrator = (i % 11 == 5) == (strcmp(method, "rk4") == 0) ? "verlet-events" : "rk4";
  if (i % 13 == 6) setup->scene.contacts[1].friction.law = STRUT_FRICTION_SMOOTH;
  if (i % 13 == 6) setup->scene.contacts[1].friction.width = 1e-3;
  if (i % 17 == 8) setup->scene.members[3].node[0] = 4;       /* another topology */
  if (i % 17 == 9) e->step = 1e-2;                            /* refused */
  if (i % 17 == 10) setup->scene.nodes[2].velocity[1] = 1e15; /* diverges */
  if (i % 5) return;
  e->steady.wanted = true;
  e->steady.tolerance = 0.3;
  e->duration = 0, e->measure_last = 2;
  e->periods = 30, e->period_signal = 0;
}

static void make_points(points *all, int count, const char *method, bool without_balance) {
  uint64_t r = 20;
  *all = (points){.count = count};
  for (int i = 0; i < count; i++) {
    point *p = &all->at[i];
    make_scene(&p->setup, i, method, &r);
    p->model = motion_compile(&p->setup.scene);
    p->options.without_balance = without_balance;
    p->sink = (strut_sink){&p->seen, trace_begin, trace_rows, trace_end, 0};
    p->sinks[0] = &p->sink;
    if (i % 3) continue;
    p->options.sinks = p->sinks, p->options.sink_count = 1;
  }
}

static void check_alone(point *p) {
  strut_summary alone;
  trace seen = p->seen;
  strut_model *model = motion_compile(&p->setup.scene);
  assert_int_equal(p->given, 1);
  assert_int_equal(p->back, 1);
  assert_int_equal(strut_simulate(model, &p->setup.experiment, &p->options, &alone, NULL),
                   p->status);
  same_summary(&p->summary, &alone);
  assert_int_equal(p->seen.rows, seen.rows);
  assert_int_equal(p->seen.hash, seen.hash);
  assert_int_equal(p->seen.ended, seen.ended);
  strut_summary_free(&alone);
  strut_model_free(model);
}

static void compare(int32_t width, int count, const char *method, bool without_balance) {
  static points all;
  strut_setup crawler;
  strut_setup_init(&crawler);
  structure_crawler(&crawler.scene, 10, 1e-4, 0.1, false);
  crawler.experiment.integrator = method;
  strut_model *example = motion_compile(&crawler.scene);
  make_points(&all, count, method, without_balance);
  strut_simulate_batch(&(strut_batch_source){.context = &all,
                                             .next = next_point,
                                             .result = take_result,
                                             .example = example,
                                             .integrator = method,
                                             .without_balance = without_balance,
                                             .width = width});
  int failed = 0;
  for (int i = 0; i < count; i++) {
    failed += all.at[i].status != STRUT_OK;
    check_alone(&all.at[i]);
    strut_summary_free(&all.at[i].summary);
    strut_setup_free(&all.at[i].setup);
  }
  assert_true(count < 20 || (failed > 1 && failed < count / 2));
  strut_model_free(example);
  strut_setup_free(&crawler);
}

TEST(every_width) {
  for (int32_t width = 1; width <= strut_batch_widest(); width *= 2) /* 2: one by one, too */
    compare(width, POINTS, "rk4", false);
}

TEST(without_balance) { compare(0, POINTS, "rk4", true); }

TEST(events) {
  compare(4, POINTS, "verlet-events", true); /* without lanes, one by one */
  compare(0, POINTS, "verlet-events", false);
}

TEST(few_points) {
  for (int count = 0; count < 4; count++) compare(0, count, "rk4", false);
}

/* Lanes are no duty: without memory for them each run is made alone. */
TEST(no_memory_for_lanes) {
  static points all;
  strut_setup crawler;
  strut_setup_init(&crawler);
  structure_crawler(&crawler.scene, 10, 1e-4, 0.1, false);
  strut_model *example = motion_compile(&crawler.scene);
  make_points(&all, 1, "rk4", false);
  strut_fail_allocation_after(0);
  strut_simulate_batch(&(strut_batch_source){.context = &all,
                                             .next = next_point,
                                             .result = take_result,
                                             .example = example,
                                             .integrator = "rk4"});
  strut_fail_allocation_after(-1);
  assert_int_equal(all.at[0].back, 1);
  assert_int_equal(all.at[0].status, STRUT_NO_MEMORY);
  strut_summary_free(&all.at[0].summary);
  strut_setup_free(&all.at[0].setup);
  strut_model_free(example);
  strut_setup_free(&crawler);
}
