/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Grids of X-frames, as listed row by row and shuffled, by rk4.c and by large_steps.h: nanoseconds of processor
 * time per member and step, of all threads and of the calling one.
 */
#include "tests/bench/large.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "engine/integrate/large_steps.h"
#include "tests/bench/scenes.h"

static uint64_t noise = 1;

static uint32_t draw(uint32_t below) {
  noise = noise * 6364136223846793005u + 1442695040888963407u;
  return (uint32_t)((noise >> 33) % below);
}

static void shuffle(int32_t *order, int32_t count) {
  for (int32_t i = 0; i < count; i++) order[i] = i;
  for (int32_t i = count - 1; i > 0; i--) {
    int32_t k = (int32_t)draw((uint32_t)i + 1), kept = order[i];
    order[i] = order[k], order[k] = kept;
  }
}

/* False: out of memory. */
static bool make_grid(strut_setup *setup, int32_t side, bool shuffled) {
  strut_scene *scene = &setup->scene;
  int32_t nodes = side * side, most = 4 * nodes, count = 0;
  static const int32_t across[4][2][2] = {
      {{0, 0}, {1, 0}}, {{0, 0}, {0, 1}}, {{0, 0}, {1, 1}}, {{0, 1}, {1, 0}}};
  strut_setup_init(setup);
  scene->nodes = strut_arena_allocate(&scene->arena, (size_t)nodes, sizeof *scene->nodes);
  scene->members = strut_arena_allocate(&scene->arena, (size_t)most, sizeof *scene->members);
  int32_t *place = malloc((size_t)nodes * sizeof *place);
  int32_t *order = malloc((size_t)most * sizeof *order);
  strut_member *listed = malloc((size_t)most * sizeof *listed);
  bool good = scene->nodes && scene->members && place && order && listed;
  for (int32_t i = 0; i < nodes && good; i++) place[i] = i;
  if (good && shuffled) shuffle(place, nodes);
  for (int32_t i = 0; i < nodes && good; i++) {
    strut_node *n = &scene->nodes[place[i]];
    *n = strut_node_default();
    n->position[0] = n->start[0] = i / side, n->position[1] = n->start[1] = i % side;
    n->mass = 0.1;
    for (int kind = 0; kind < 4; kind++) {
      const int32_t(*d)[2] = across[kind];
      int32_t x = i / side, y = i % side;
      if (x + d[1][0] >= side || y + d[1][1] >= side || y + d[0][1] >= side) continue;
      strut_member *m = &listed[count++];
      *m = strut_member_default();
      m->kind = kind < 2 ? STRUT_SPRING : STRUT_CABLE;
      m->node[0] = place[i + d[0][1]];
      m->node[1] = place[(x + d[1][0]) * side + y + d[1][1]];
      m->rest_kind = STRUT_REST_LENGTH, m->rest_value = kind < 2 ? 0.99 : 1.40;
      m->stiffness = 100.0;
    }
  }
  if (good) {
    for (int32_t j = 0; j < count; j++) order[j] = j;
    if (shuffled) shuffle(order, count);
    for (int32_t j = 0; j < count; j++) scene->members[j] = listed[order[j]];
    scene->node_count = (size_t)nodes, scene->member_count = (size_t)count;
    scene->mass_model = STRUT_MASS_LUMPED;
  }
  free(place), free(order), free(listed);
  return good;
}

static double seconds(clockid_t clock) {
  struct timespec t;
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Least of several tries, by turns. */
enum { TRIES = 15, WAYS = 4 };

static void measure(int32_t side, bool shuffled) {
  static const int threads[WAYS] = {0, 1, 2, 4};
  const strut_integrator_settings settings = {.step = 1e-3};
  const strut_integrator *method = strut_integrator_find("rk4");
  strut_setup setup;
  strut_model *model = NULL;
  strut_state *state[WAYS] = {NULL};
  strut_large_steps *large[WAYS] = {NULL};
  void *workspace = NULL;
  double all[WAYS], own[WAYS];
  if (!make_grid(&setup, side, shuffled) || strut_model_compile(&setup.scene, &model, NULL)) return;
  double members = (double)model->members.count;
  int64_t steps = (int64_t)fmax(2.0, 4e6 / members);
  for (int w = 0; w < WAYS; w++) {
    all[w] = own[w] = HUGE_VAL;
    if (strut_state_create(model, &state[w], NULL)) return;
    state[w]->ledger = true;
    if (threads[w] == 0) workspace = method->create(model, state[w], &settings);
    if (threads[w] > 0)
      strut_large_steps_create(model, method, &settings, threads[w], &large[w], NULL);
    if (large[w]) strut_large_steps_restart(large[w], state[w], 1e-3);
  }
  for (int i = 0; i < TRIES; i++)
    for (int w = 0; w < WAYS; w++) {
      double a = seconds(CLOCK_PROCESS_CPUTIME_ID), o = seconds(CLOCK_THREAD_CPUTIME_ID);
      if (large[w])
        strut_large_steps_advance(large[w], state[w], 1e-3, steps);
      else
        method->advance(model, state[w], workspace, 1e-3, steps);
      all[w] = fmin(all[w], (seconds(CLOCK_PROCESS_CPUTIME_ID) - a) / (double)steps / members);
      own[w] = fmin(own[w], (seconds(CLOCK_THREAD_CPUTIME_ID) - o) / (double)steps / members);
    }
  printf("%9.0f  %-8s", members, shuffled ? "shuffled" : "in order");
  for (int w = 0; w < WAYS; w++) {
    bool same = memcmp(state[0]->q, state[w]->q, (size_t)model->length * sizeof(double)) == 0;
    if (threads[w] && !large[w])
      printf("  %13s", "-");
    else
      printf("  %5.1f / %5.1f%s", 1e9 * own[w], 1e9 * all[w], same ? "" : "!");
  }
  printf("\n");
  for (int w = 0; w < WAYS; w++) {
    strut_large_steps_free(large[w]);
    strut_state_free(state[w]);
  }
  strut_model_free(model);
  strut_setup_free(&setup);
}

void bench_large(long members) {
  static const long sizes[] = {10000, 100000, 1000000};
  printf(
      "ns of processor time per member and step: of the calling thread / of all; rk4 with the "
      "ledger\n"
      "%9s  %-8s  %13s  %13s  %13s  %13s\n",
      "members", "listed", "rk4.c", "1 thread", "2 threads", "4 threads");
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    long wanted = members ? members : sizes[i];
    int32_t side = (int32_t)lround(sqrt((double)wanted / 4.0) + 0.5);
    measure(side, false);
    measure(side, true);
    if (members) break;
  }
}
