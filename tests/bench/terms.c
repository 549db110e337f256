/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/terms.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "engine/integrate/integrator.h"
#include "tests/bench/scenes.h"

enum { STEPS = 4000, MOST_REPEATS = 1001 };

typedef void (*change)(strut_setup *setup);

/* One side of a row: the crawler after these changes (NULL: none), by this method. */
typedef struct side {
  const char *method;
  change changes[2];
  bool without_balance;
} side;

typedef struct row {
  const char *term;
  side with, without;
} row;

static void no_damping(strut_setup *s) {
  for (size_t i = 0; i < s->scene.member_count; i++) s->scene.members[i].damping = 0.0;
}
static void cables(strut_setup *s) {
  for (size_t i = 3; i < s->scene.member_count; i++) s->scene.members[i].kind = STRUT_CABLE;
}
static void no_drive(strut_setup *s) { s->scene.actuator_count = 0; }
static void no_ground(strut_setup *s) {
  s->scene.contact_count = 0, s->scene.ground.present = false;
}
static void no_friction(strut_setup *s) {
  for (size_t i = 0; i < s->scene.contact_count; i++)
    s->scene.contacts[i].friction = (strut_friction){.law = STRUT_FRICTION_NONE};
}
static void smooth(strut_setup *s) {
  for (size_t i = 0; i < s->scene.contact_count; i++)
    s->scene.contacts[i].friction = (strut_friction){
        .law = STRUT_FRICTION_SMOOTH, .mu_static = 0.1, .mu_kinetic = 0.1, .width = 1e-4};
}
static void exact(strut_setup *s) {
  for (size_t i = 0; i < s->scene.contact_count; i++)
    s->scene.contacts[i].friction.law = STRUT_FRICTION_COULOMB;
}
static void hunt_crossley(strut_setup *s) {
  s->scene.ground.damping_law = STRUT_DAMPING_HUNT_CROSSLEY;
  for (size_t i = 0; i < s->scene.contact_count; i++) s->scene.contacts[i].dissipation = 5.0;
}
static void slope(strut_setup *s) { s->scene.ground.slope = 1e-300; }
static void lumped(strut_setup *s) { s->scene.mass_model = STRUT_MASS_LUMPED; }
static void rigid(strut_setup *s) { s->scene.bar_model = STRUT_BARS_RIGID; }

static const row rows[] = {
    {"member dampers", {"rk4", {NULL}, false}, {"rk4", {no_damping}, false}},
    {"slack cables", {"rk4", {cables}, false}, {"rk4", {NULL}, false}},
    {"drive", {"rk4", {NULL}, false}, {"rk4", {no_drive}, false}},
    {"friction", {"rk4", {NULL}, false}, {"rk4", {no_friction}, false}},
    {"contact and friction", {"rk4", {NULL}, false}, {"rk4", {no_ground}, false}},
    {"  the same, verlet-events",
     {"verlet-events", {NULL}, false},
     {"verlet-events", {no_ground}, false}},
    {"slope", {"rk4", {slope}, false}, {"rk4", {NULL}, false}},
    {"smooth friction (karnopp)", {"rk4", {smooth}, false}, {"rk4", {NULL}, false}},
    {"Hunt-Crossley (printed)", {"rk4", {hunt_crossley}, false}, {"rk4", {NULL}, false}},
    {"exact friction (karnopp)",
     {"verlet-events", {exact}, false},
     {"verlet-events", {NULL}, false}},
    {"consistent mass (lumped)", {"rk4", {NULL}, false}, {"rk4", {lumped}, false}},
    {"rigid bars (elastic)", {"rk4", {rigid}, false}, {"rk4", {NULL}, false}},
    {"balance of works", {"rk4", {NULL}, false}, {"rk4", {NULL}, true}},
    {"  the same, verlet-events",
     {"verlet-events", {NULL}, false},
     {"verlet-events", {NULL}, true}},
    {"events (rk4)", {"rk4-events", {NULL}, false}, {"rk4", {NULL}, false}},
    {"events (verlet), no ground",
     {"verlet-events", {no_ground}, false},
     {"verlet", {no_ground}, false}},
};

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ns of a force evaluation over STEPS steps from the start; NAN where the method refuses. */
static double run(const strut_model *model, const side *it) {
  const double dt = 5e-5;
  strut_state *state = NULL;
  double time = (double)NAN;
  strut_experiment experiment = strut_experiment_default();
  experiment.integrator = it->method;
  experiment.step = dt;
  const strut_integrator_settings settings = strut_integrator_settings_of(&experiment);
  if (strut_integrator_check(model, &experiment, NULL) || strut_state_create(model, &state, NULL))
    return time;
  const strut_integrator *method = strut_integrator_find(it->method);
  void *work = method->create(model, state, &settings);
  if (work) {
    state->balance = !it->without_balance;
    if (method->restart) method->restart(model, state, work, dt);
    double begin = now();
    method->advance(model, state, work, dt, STEPS);
    time = 1e9 * (now() - begin) / (double)state->evaluations;
  }
  strut_state_free(state);
  return time;
}

/* NULL where there is no such model. */
static strut_model *make(const side *it, strut_setup *setup) {
  strut_model *model = NULL;
  if (bench_crawler_scene(setup, 10.0, 1e-4, 0.1)) return NULL;
  for (int i = 0; i < 2; i++)
    if (it->changes[i]) it->changes[i](setup);
  return strut_model_compile(&setup->scene, &model, NULL) ? NULL : model;
}

static void time_row(const row *it, int repeats) {
  static double times[2][MOST_REPEATS];
  strut_setup scenes[2] = {0};
  const side *sides[2] = {&it->with, &it->without};
  strut_model *models[2];
  for (int k = 0; k < 2; k++) models[k] = make(sides[k], &scenes[k]);
  for (int r = 0; r < repeats; r++)
    for (int k = 0; k < 2; k++) times[k][r] = models[k] ? run(models[k], sides[k]) : (double)NAN;
  for (int k = 0; k < 2; k++) {
    qsort(times[k], (size_t)repeats, sizeof times[k][0], ascending);
    strut_model_free(models[k]);
    strut_setup_free(&scenes[k]);
  }
  double with = times[0][repeats / 2], without = times[1][repeats / 2];
  printf("  %-32s %10.1f %10.1f %10.2f %10.2f\n", it->term, with, without, with / without,
         without / with);
}

void bench_terms(int repeats) {
  printf("crawler, 10 Hz, friction 0.1, ns of a force evaluation\n  %-32s %10s %10s %10s %10s\n",
         "term (instead of)", "with", "without", "with/w.o.", "w.o./with");
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) time_row(&rows[i], repeats);
}
