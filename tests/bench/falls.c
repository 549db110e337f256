/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A grid of X-frames, drawn uneven, that falls on its lowest row and slides: its contacts close within some tens of
   steps, and stick and slip from then on. */
#include "tests/bench/falls.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "engine/integrate/integrator.h"
#include "tests/bench/scenes.h"

enum { ROWS = 10, STEPS = 400, TRIES = 2 };
static const double STEP = 1e-4, SIDE = 0.1;

static uint64_t noise;

static double draw(double high) {
  noise = noise * 6364136223846793005u + 1442695040888963407u;
  return high * (double)(noise >> 11) * 0x1p-53;
}

static void add_member(strut_scene *scene, int32_t from, int32_t to, bool cable) {
  strut_member *m = &scene->members[scene->member_count++];
  *m = strut_member_default();
  m->kind = cable ? STRUT_CABLE : STRUT_BAR;
  m->node[0] = from, m->node[1] = to;
  m->stiffness = cable ? 3e3 : 1e5, m->damping = 0.2, m->mass = 0.1;
  if (cable) m->rest_kind = STRUT_REST_LENGTH, m->rest_value = 0.098;
}

static void add_node(strut_scene *scene, int32_t i, int32_t column, int32_t row) {
  strut_node *n = &scene->nodes[i];
  *n = strut_node_default();
  n->position[0] = n->start[0] = SIDE * column;
  n->position[1] = n->start[1] = 1e-3 + SIDE * row + draw(2e-3);
  n->velocity[0] = 0.3, n->velocity[1] = -1.0;
  if (row) return;
  strut_contact *c = &scene->contacts[scene->contact_count++];
  *c = (strut_contact){.node = i, .stiffness = 1e4, .damping = 2.0};
  c->friction = (strut_friction){
      .law = STRUT_FRICTION_KARNOPP, .mu_static = 0.3, .mu_kinetic = 0.3, .stick_velocity = 1e-3};
}

/* False: out of memory. */
static bool make_fall(strut_setup *setup, int32_t columns, strut_mass_model masses) {
  strut_scene *scene = &setup->scene;
  size_t nodes = (size_t)columns * ROWS;
  strut_setup_init(setup);
  noise = 1;
  scene->nodes = strut_arena_allocate(&scene->arena, nodes, sizeof *scene->nodes);
  scene->members = strut_arena_allocate(&scene->arena, 4 * nodes, sizeof *scene->members);
  scene->contacts = strut_arena_allocate(&scene->arena, nodes, sizeof *scene->contacts);
  if (!scene->nodes || !scene->members || !scene->contacts) return false;
  for (int32_t i = 0; i < columns * ROWS; i++) add_node(scene, i, i / ROWS, i % ROWS);
  for (int32_t i = 0; i < columns * ROWS; i++) {
    bool right = i / ROWS + 1 < columns, up = i % ROWS + 1 < ROWS;
    if (right) add_member(scene, i, i + ROWS, true);
    if (up) add_member(scene, i, i + 1, true);
    if (right && up) add_member(scene, i, i + ROWS + 1, false);
    if (right && up) add_member(scene, i + 1, i + ROWS, false);
  }
  scene->node_count = nodes;
  scene->ground.present = true;
  scene->gravity[1] = -9.81;
  scene->mass_model = masses;
  return true;
}

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct fall_cost {
  double seconds; /* of a step */
  double events;  /* in a step */
} fall_cost;

static fall_cost run(const strut_model *model, const char *name) {
  const strut_integrator *method = strut_integrator_find(name);
  strut_experiment experiment = strut_experiment_default();
  experiment.step = STEP;
  strut_integrator_settings settings = strut_integrator_settings_of(&experiment);
  strut_state *state = NULL;
  fall_cost cost = {(double)NAN, (double)NAN};
  if (strut_state_create(model, &state, NULL)) return cost;
  void *work = method->create(model, state, &settings);
  if (work) {
    state->balance = true;
    double begin = now();
    method->advance(model, state, work, STEP, STEPS);
    cost.seconds = (now() - begin) / STEPS, cost.events = (double)state->events / STEPS;
  }
  strut_state_free(state);
  return cost;
}

void bench_falls(long nodes) {
  static const char *const methods[] = {"rk4", "rk4-events", "verlet-events", "adaptive"};
  enum { COUNT = sizeof methods / sizeof methods[0] };
  int32_t columns = (int32_t)(nodes > ROWS ? nodes : 3000) / ROWS;
  printf("a grid of %d nodes falls on %d: ms of a step, times rk4, events in a step\n",
         columns * ROWS, columns);
  for (int k = 0; k < 2; k++) {
    fall_cost least[COUNT];
    strut_setup setup = {0};
    strut_model *model = NULL;
    if (!make_fall(&setup, columns, k ? STRUT_MASS_CONSISTENT : STRUT_MASS_LUMPED) ||
        strut_model_compile(&setup.scene, &model, NULL))
      return;
    for (int i = 0; i < TRIES; i++)
      for (int m = 0; m < COUNT; m++) {
        fall_cost cost = run(model, methods[m]);
        if (i == 0 || cost.seconds < least[m].seconds) least[m] = cost;
      }
    printf("%s masses\n", k ? "consistent" : "lumped");
    for (int m = 0; m < COUNT; m++)
      printf("  %-14s %8.2f %7.1f %7.1f\n", methods[m], 1e3 * least[m].seconds,
             least[m].seconds / least[0].seconds, least[m].events);
    strut_model_free(model);
    strut_setup_free(&setup);
  }
}
