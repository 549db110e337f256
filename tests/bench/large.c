/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Chains and grids of X-frames, in order and shuffled: nanoseconds of processor time per member and step, the
 * ratio of both with its spread, and what the memory allows.
 */
#include "tests/bench/large.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "engine/integrate/integrator.h"
#include "tests/bench/scenes.h"

static uint64_t noise = 1;

static uint32_t draw(uint32_t below) {
  noise = noise * 6364136223846793005u + 1442695040888963407u;
  return (uint32_t)((noise >> 33) % below);
}

/* Nodes and members in any order. False: out of memory. */
static bool shuffle(strut_scene *scene) {
  int32_t *place = malloc(scene->node_count * sizeof *place);
  strut_node *node = malloc(scene->node_count * sizeof *node);
  bool good = place && node;
  for (uint32_t i = 0; i < scene->node_count && good; i++) place[i] = (int32_t)i;
  for (uint32_t i = (uint32_t)scene->node_count - 1; i > 0 && good; i--) {
    uint32_t k = draw(i + 1);
    int32_t kept = place[i];
    place[i] = place[k], place[k] = kept;
  }
  for (size_t i = 0; i < scene->node_count && good; i++) node[place[i]] = scene->nodes[i];
  if (good) memcpy(scene->nodes, node, scene->node_count * sizeof *node);
  for (size_t j = 0; j < scene->member_count && good; j++)
    for (int end = 0; end < 2; end++)
      scene->members[j].node[end] = place[scene->members[j].node[end]];
  for (uint32_t j = (uint32_t)scene->member_count - 1; j > 0 && good; j--) {
    uint32_t k = draw(j + 1);
    strut_member kept = scene->members[j];
    scene->members[j] = scene->members[k], scene->members[k] = kept;
  }
  free(place), free(node);
  return good;
}

/* False: out of memory. */
static bool make_grid(strut_setup *setup, int32_t side) {
  strut_scene *scene = &setup->scene;
  int32_t nodes = side * side;
  static const int32_t across[4][2][2] = {
      {{0, 0}, {1, 0}}, {{0, 0}, {0, 1}}, {{0, 0}, {1, 1}}, {{0, 1}, {1, 0}}};
  strut_setup_init(setup);
  scene->nodes = strut_arena_allocate(&scene->arena, (size_t)nodes, sizeof *scene->nodes);
  scene->members = strut_arena_allocate(&scene->arena, 4 * (size_t)nodes, sizeof *scene->members);
  if (!scene->nodes || !scene->members) return false;
  for (int32_t i = 0; i < nodes; i++) {
    int32_t x = i / side, y = i % side;
    strut_node *n = &scene->nodes[i];
    *n = strut_node_default();
    n->position[0] = n->start[0] = x, n->position[1] = n->start[1] = y;
    n->mass = 0.1;
    for (int kind = 0; kind < 4; kind++) {
      const int32_t(*d)[2] = across[kind];
      if (x + d[1][0] >= side || y + d[1][1] >= side || y + d[0][1] >= side) continue;
      strut_member *m = &scene->members[scene->member_count++];
      *m = strut_member_default();
      m->kind = kind < 2 ? STRUT_SPRING : STRUT_CABLE;
      m->node[0] = i + d[0][1];
      m->node[1] = (x + d[1][0]) * side + y + d[1][1];
      m->rest_kind = STRUT_REST_LENGTH, m->rest_value = kind < 2 ? 0.99 : 1.40;
      m->stiffness = 100.0;
    }
  }
  scene->node_count = (size_t)nodes;
  scene->mass_model = STRUT_MASS_LUMPED;
  return true;
}

static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool make_scene(strut_setup *setup, bool chain, long members, strut_mass_model mass) {
  if (chain) return bench_chain_scene(setup, (size_t)members, mass) == STRUT_OK;
  if (!make_grid(setup, (int32_t)lround(sqrt((double)members / 4.0) + 0.5))) return false;
  setup->scene.mass_model = mass;
  for (size_t j = 0; j < setup->scene.member_count && mass == STRUT_MASS_CONSISTENT; j++)
    if (setup->scene.members[j].kind == STRUT_SPRING) setup->scene.members[j].mass = 0.05;
  return true;
}

/* ---- memory ---- */

enum { TRIAD = 4000000, TRIAD_TRIES = 10 };

/* Bytes per second of a = b + 3 c. */
static double triad_rate(void) {
  double *a = calloc(TRIAD, sizeof *a), *b = calloc(TRIAD, sizeof *b),
         *c = calloc(TRIAD, sizeof *c);
  double rate = 0.0;
  bool good = a && b && c;
  for (int i = 0; i < TRIAD && good; i++) a[i] = b[i] = c[i] = i;
  for (int k = 0; k < TRIAD_TRIES && good; k++) {
    double begin = seconds();
    for (int i = 0; i < TRIAD; i++) a[i] = b[i] + 3.0 * c[i];
    rate = fmax(rate, 3.0 * sizeof(double) * TRIAD / (seconds() - begin));
  }
  free(a), free(b), free(c);
  return rate;
}

/* What an evaluation of the forces and the stage behind it read and write once: per member ends, stiffness, rest
   length, slack, damping; per node position, velocity, acceleration, inverse mass and the next two. */
static double bytes_per_member(const strut_model *model) {
  double member = 8 + 3 * 8 + (model->terms & STRUT_TERM_DAMPING ? 8 : 0), node = 6 * 16;
  return member + node * model->node_count / model->members.count;
}

/* ---- steps ---- */

enum { TRIES = 15, ORDERS = 2 };

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Median, and quarters of the tries around it. */
static void spread(const double *x, double *low, double *middle, double *high) {
  double sorted[TRIES];
  memcpy(sorted, x, sizeof sorted);
  qsort(sorted, TRIES, sizeof *sorted, ascending);
  *low = sorted[TRIES / 4], *middle = sorted[TRIES / 2], *high = sorted[TRIES - 1 - TRIES / 4];
}

/* A structure in one of the orders, being stepped. */
typedef struct subject {
  strut_setup setup;
  strut_model *model;
  strut_state *state;
  void *workspace;
  double time[TRIES]; /* ns per member and step */
} subject;

typedef struct row {
  const char *method;
  bool chain, lumped;
} row;

static bool begin(subject *s, const row *of, long members, bool shuffled) {
  const strut_integrator *method = strut_integrator_find(of->method);
  const strut_integrator_settings settings = {.step = 1e-4};
  if (!make_scene(&s->setup, of->chain, members,
                  of->lumped ? STRUT_MASS_LUMPED : STRUT_MASS_CONSISTENT) ||
      (shuffled && !shuffle(&s->setup.scene)) ||
      strut_model_compile(&s->setup.scene, &s->model, NULL) ||
      strut_state_create(s->model, &s->state, NULL))
    return false;
  s->state->balance = true;
  return (s->workspace = method->create(s->model, s->state, &settings)) != NULL;
}

static void end(subject *s) {
  strut_state_free(s->state);
  strut_model_free(s->model);
  strut_setup_free(&s->setup);
}

/* Both orders take turns. */
static void measure(const row *of, long members, double bandwidth) {
  static subject both[ORDERS];
  const strut_integrator *method = strut_integrator_find(of->method);
  double low, middle, high, count, ratio[TRIES];
  memset(both, 0, sizeof both);
  if (!begin(&both[0], of, members, false) || !begin(&both[1], of, members, true)) {
    printf("out of memory\n");
    return;
  }
  count = both[0].model->members.count;
  int64_t steps = (int64_t)fmax(method->evaluations == 1 ? 16.0 : 4.0, 2e6 / count);
  for (int i = 0; i < TRIES; i++) {
    for (subject *s = both; s < both + ORDERS; s++) {
      double begun = seconds();
      method->advance(s->model, s->state, s->workspace, 1e-4, steps);
      s->time[i] = 1e9 * (seconds() - begun) / (double)steps / count;
    }
    ratio[i] = both[1].time[i] / both[0].time[i];
  }
  spread(both[0].time, &low, &middle, &high);
  printf("%-6s %-5s %-10s %8.0f  %7.1f", of->method, of->chain ? "chain" : "grid",
         of->lumped ? "lumped" : "consistent", count, middle);
  double share = method->evaluations * bytes_per_member(both[0].model) / bandwidth * 1e9 / middle;
  spread(ratio, &low, &middle, &high);
  printf("  %4.2f (%4.2f-%4.2f)  %5.2f\n", middle, low, high, share);
  fflush(stdout);
  for (int k = 0; k < ORDERS; k++) end(&both[k]);
}

void bench_large(long members) {
  static const long sizes[] = {1000, 10000, 100000, 1000000};
  static const row rows[] = {
      {"rk4", true, true},    {"rk4", false, true}, {"verlet", true, true}, {"verlet", false, true},
      {"euler", false, true}, {"rk4", true, false}, {"rk4", false, false}};
  double rate = triad_rate();
  printf("triad: %.1f GB/s\n", 1e-9 * rate);
  printf(
      "ns of processor time per member and step, with the energy balance; shuffled: ratio with "
      "quartiles\n"
      "memory: time of a step at the triad's rate if each evaluation reads and writes all once, "
      "over that time\n"
      "%-6s %-5s %-10s %8s  %7s  %16s  %s\n",
      "method", "", "masses", "members", "time", "shuffled", "memory");
  for (size_t r = 0; r < sizeof rows / sizeof *rows; r++)
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
      if (members && i > 0) break;
      measure(&rows[r], members ? members : sizes[i], rate);
    }
}
