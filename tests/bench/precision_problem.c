/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes of the work-precision tables, as initial value problems. */
#include <math.h>
#include <stdio.h>
#include <sys/time.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/forces.h"
#include "engine/forces/history.h"
#include "engine/model/pose.h"
#include "engine/statics/equilibria/equilibria.h"
#include "tests/bench/precision.h"
#include "tests/bench/scenes.h"

#define CRAWLER(start, hertz)                                                                      \
  {                                                                                                \
    .name = "crawler-" start "-" hertz, .title = "crawler, " start ", " hertz " Hz",               \
    .file = "models/crawler/crawler.yaml", .set = {"start=" start, "frequency=" hertz " Hz"},      \
    .periods = 300                                                                                 \
  }
#define SCENE(id, words, path, ...)                                                                \
  { .name = id, .title = words, .file = "tests/bench/precision/" path ".yaml", __VA_ARGS__ }

static const precision_scene scenes[] = {
    CRAWLER("I", "10"),
    CRAWLER("I", "12"),
    CRAWLER("I", "15"),
    CRAWLER("II", "10"),
    CRAWLER("II", "12"),
    CRAWLER("II", "15"),
    SCENE("bouncing", "bouncing frame", "bouncing", .periods = 0),
    SCENE("sliding", "sliding frame", "sliding", .periods = 0),
    SCENE("stiff-1e4", "bars 1e4 times stiffer", "stiff", .set = {"ratio=1e4"}, .loose = 1e2,
          .rigid = true),
    SCENE("stiff-1e7", "bars 1e7 times stiffer", "stiff", .set = {"ratio=1e7"}, .loose = 3e3,
          .rigid = true),
    SCENE("grid-rest", "net of 2,025 nodes, let go", "grid", .periods = 0),
    SCENE("grid-shaken", "the net, shaken", "grid", .set = {"shaking=5 N"}),
    SCENE("smooth-friction", "smooth friction", "smooth-friction", .periods = 0),
    SCENE("feedback", "arm with feedback", "feedback", .periods = 0),
    SCENE("folds", "law that folds back", "folds", .periods = 0),
    SCENE("drift", "10,000 periods", "drift", .periods = 0)};

const precision_scene *precision_scene_at(size_t i) {
  return i < sizeof scenes / sizeof scenes[0] ? &scenes[i] : NULL;
}

/* ---- reading ---- */

static void set_window(precision_problem *p) {
  strut_experiment *e = &p->setup.experiment;
  if (p->scene->periods > 0) {
    e->periods = p->scene->periods;
    e->measure_last = p->scene->periods / 3;
  }
  strut_span span = strut_experiment_span(e, &p->setup.scene);
  p->begin = span.window_start, p->end = span.duration;
  p->parts = e->periods > 0 ? (int64_t)(e->periods + 0.5) : 1;
}

static void list_coordinates(precision_problem *p) {
  const strut_model *m = p->model;
  for (int32_t i = 0; i < 2 * m->node_count; i++)
    if (!m->fixed[i]) p->coordinate[p->n++] = i;
  p->roots = 4 * m->contacts.count;
  for (int32_t j = 0; j < m->members.count; j++) p->roots += m->members.slack[j] == 0.0;
}

/* The units of tolerances, from a coarse run. */
static bool measure_scales(precision_problem *p) {
  enum { SAMPLES = 200 };
  strut_state *state = NULL;
  const strut_integrator *method = strut_integrator_find("adaptive");
  strut_experiment e = strut_experiment_default();
  e.step = p->end / (double)(p->parts * SAMPLES), e.tolerance = 1e-5;
  const strut_integrator_settings settings = strut_integrator_settings_of(&e);
  if (strut_state_create(p->model, &state, NULL) != STRUT_OK) return false;
  void *work = method->create(p->model, state, &settings);
  strut_state_reset(p->model, state);
  if (work && method->restart) method->restart(p->model, state, work, e.step);
  for (int s = 0; work && s < SAMPLES; s++) {
    strut_integrator_advance(method, p->model, state, work, e.step, 1);
    for (int i = 0; i < p->n; i++) {
      int32_t c = p->coordinate[i];
      p->reach = fmax(p->reach, fabs(state->q[c] - p->model->start[c]));
      p->speed = fmax(p->speed, fabs(state->v[c]));
    }
  }
  strut_state_free(state);
  return work != NULL;
}

bool precision_open(precision_problem *p, const precision_scene *scene, bool rigid) {
  strut_error error = {0};
  *p = (precision_problem){.scene = scene};
  strut_status status = bench_read(&p->setup, scene->file, scene->set, &error);
  if (status == STRUT_OK && rigid) p->setup.scene.bar_model = STRUT_BARS_RIGID;
  if (status == STRUT_OK) status = strut_resolve_start_equilibrium(&p->setup, &error);
  if (status == STRUT_OK) status = strut_model_compile(&p->setup.scene, &p->model, &error);
  if (status == STRUT_OK) status = strut_state_create(p->model, &p->state, &error);
  if (status == STRUT_OK) {
    strut_arena *arena = &p->state->arena;
    p->coordinate = strut_arena_allocate(arena, (size_t)p->model->length, sizeof *p->coordinate);
    p->a = strut_arena_allocate(arena, (size_t)p->model->length, sizeof *p->a);
    if (!p->coordinate || !p->a) status = strut_fail(&error, STRUT_NO_MEMORY, "out of memory");
  }
  if (status == STRUT_OK) {
    set_window(p);
    list_coordinates(p);
    if (!rigid && !measure_scales(p)) status = strut_fail(&error, STRUT_NO_MEMORY, "out of memory");
  }
  if (status == STRUT_OK) return true;
  fprintf(stderr, "strut_bench: %s: %s\n", scene->name, error.message);
  precision_close(p);
  return false;
}

void precision_close(precision_problem *p) {
  strut_state_free(p->state);
  strut_model_free(p->model);
  strut_setup_free(&p->setup);
}

/* ---- time ---- */

strut_flag precision_late;

static void set_late(int signal) {
  (void)signal;
  precision_late = 1;
}

void precision_allow(double seconds) {
  double whole = floor(seconds);
  const struct itimerval timer = {
      .it_value = {(time_t)whole, (suseconds_t)(1e6 * (seconds - whole))}};
  signal(SIGPROF, set_late);
  precision_late = 0;
  setitimer(ITIMER_PROF, &timer, NULL);
}

/* ---- the problem ---- */

static void scatter(precision_problem *p, const double *y) {
  for (int i = 0; i < p->n; i++) {
    p->state->q[p->coordinate[i]] = y[i];
    p->state->v[p->coordinate[i]] = y[p->n + i];
  }
}

void precision_start(precision_problem *p, double *y) {
  strut_state_reset(p->model, p->state);
  strut_history_begin(p->model, p->state, 0.0);
  p->evaluations = 0;
  for (int i = 0; i < p->n; i++) {
    y[i] = p->state->q[p->coordinate[i]];
    y[p->n + i] = p->state->v[p->coordinate[i]];
  }
}

bool precision_rate(precision_problem *p, double t, const double *y, double *rate) {
  p->evaluations++;
  scatter(p, y);
  strut_forces_acceleration(p->model, p->state, t, p->state->q, p->state->v, p->a);
  for (int i = 0; i < p->n; i++) {
    rate[i] = y[p->n + i];
    rate[p->n + i] = p->a[p->coordinate[i]];
  }
  return !precision_late && isfinite(p->a[p->coordinate[0]]);
}

void precision_roots(precision_problem *p, double t, const double *y, double *value) {
  const strut_model *m = p->model;
  const strut_contact_table *contacts = &m->contacts;
  const strut_member_table *members = &m->members;
  scatter(p, y);
  if (m->terms & STRUT_TERM_DRIVE) strut_drive_apply(m, p->state, t);
  for (int32_t i = 0; i < contacts->count; i++, value += 4) {
    double gap = strut_contact_gap(contacts, i, p->state->q);
    double slip = strut_contact_slip(contacts, i, p->state->v);
    double band = contacts->entry[i].friction.stick_velocity;
    bool closed = gap < 0.0, rubs = closed && band > 0.0;
    value[0] = gap;
    value[1] = closed ? strut_contact_along_normal(contacts, i, p->state->v) : 1.0;
    value[2] = rubs ? slip - band : 1.0;
    value[3] = rubs ? slip + band : 1.0;
  }
  for (int32_t j = 0; j < members->count; j++)
    if (members->slack[j] == 0.0)
      *value++ = strut_member_pose_at(members, p->state->latest->rest, j, p->state->q).stretch;
}

bool precision_renew(precision_problem *p, double t, const double *y) {
  if (!(p->model->terms & STRUT_TERM_MEMORY)) return false;
  scatter(p, y);
  return strut_history_renew(p->model, p->state, t);
}

double precision_place_at(const precision_problem *p, const double *q) {
  const strut_model *m = p->model;
  int32_t node = p->setup.experiment.measure_node;
  double sum = 0.0, mass = 0.0;
  if (node >= 0) return q[2 * node];
  for (int32_t i = 0; i < m->node_count; i++) {
    sum += m->weight[i] * q[2 * i];
    mass += m->weight[i];
  }
  return sum / mass;
}

double precision_place(precision_problem *p, const double *y) {
  scatter(p, y);
  return precision_place_at(p, p->state->q);
}
