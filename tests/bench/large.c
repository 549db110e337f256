/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Chains and grids of X-frames, in order and shuffled, by the method's own loop and by large_steps.h:
 * nanoseconds of processor time of the busiest thread per member and step, ratios with their spread, and what
 * the memory allows.
 */
#include "tests/bench/large.h"

#include <math.h>
#include <pthread.h>
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

static double seconds(clockid_t clock) {
  struct timespec t;
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- memory ---- */

enum { TRIAD = 4000000, TRIAD_TRIES = 10 };

typedef struct triad {
  double *a, *b, *c, rate; /* bytes per second */
} triad;

static void *run_triad(void *context) {
  triad *t = context;
  for (int k = 0; k < TRIAD_TRIES; k++) {
    double begin = seconds(CLOCK_THREAD_CPUTIME_ID);
    for (int i = 0; i < TRIAD; i++) t->a[i] = t->b[i] + 3.0 * t->c[i];
    t->rate =
        fmax(t->rate, 3.0 * sizeof(double) * TRIAD / (seconds(CLOCK_THREAD_CPUTIME_ID) - begin));
  }
  return NULL;
}

/* a = b + 3 c on this thread while another does so as well, if `both`. */
static double triad_rate(bool both) {
  triad t[2] = {{NULL}};
  pthread_t other;
  bool good = true, beside = false;
  for (int k = 0; k < 2; k++) {
    double **all[] = {&t[k].a, &t[k].b, &t[k].c};
    for (int i = 0; i < 3; i++) good = (*all[i] = calloc(TRIAD, sizeof(double))) && good;
    for (int i = 0; i < TRIAD && good; i++) t[k].a[i] = t[k].b[i] = t[k].c[i] = i;
  }
  if (good && both) beside = pthread_create(&other, NULL, run_triad, &t[1]) == 0;
  if (good) run_triad(&t[0]);
  if (beside) pthread_join(other, NULL);
  for (int k = 0; k < 2; k++) free(t[k].a), free(t[k].b), free(t[k].c);
  return t[0].rate + (beside ? t[1].rate : 0.0);
}

/* What an evaluation of the forces and the stage behind it read and write once: per member ends, stiffness, rest
   length, slack, damping; per node position, velocity, acceleration, inverse mass and the next two. */
static double bytes_per_member(const strut_model *model) {
  double member = 8 + 3 * 8 + (model->terms & STRUT_TERM_DAMPING ? 8 : 0), node = 6 * 16;
  return member + node * model->node_count / model->members.count;
}

/* ---- steps ---- */

enum { TRIES = 15, WAYS = 3 };
static const int threads_of[WAYS] = {0, 1, 2}; /* 0: the method's own loop */

typedef struct timing {
  double busiest[WAYS][TRIES]; /* ns per member and step */
  bool large[WAYS], same;
} timing;

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

static bool time_steps(const strut_model *model, const char *name, timing *t) {
  const strut_integrator_settings settings = {.step = 1e-4};
  const strut_integrator *method = strut_integrator_find(name);
  strut_state *state[WAYS] = {NULL};
  strut_large_steps *large[WAYS] = {NULL};
  void *workspace = NULL;
  double members = (double)model->members.count;
  int64_t steps = (int64_t)fmax(method->evaluations == 1 ? 16.0 : 4.0, 2e6 / members);
  for (int w = 0; w < WAYS; w++) {
    if (strut_state_create(model, &state[w], NULL)) return false;
    state[w]->balance = true;
    if (w == 0) workspace = method->create(model, state[w], &settings);
    if (w > 0) strut_large_steps_create(model, method, &settings, threads_of[w], &large[w], NULL);
    if (large[w]) strut_large_steps_restart(large[w], state[w], settings.step);
    t->large[w] = w == 0 || large[w];
  }
  for (int i = 0; i < TRIES; i++)
    for (int w = 0; w < WAYS; w++) {
      if (!t->large[w]) continue;
      double all = seconds(CLOCK_PROCESS_CPUTIME_ID), own = seconds(CLOCK_THREAD_CPUTIME_ID);
      if (large[w])
        strut_large_steps_advance(large[w], state[w], settings.step, steps);
      else
        method->advance(model, state[w], workspace, settings.step, steps);
      own = seconds(CLOCK_THREAD_CPUTIME_ID) - own;
      all = seconds(CLOCK_PROCESS_CPUTIME_ID) - all;
      t->busiest[w][i] = 1e9 * fmax(own, all - own) / (double)steps / members;
    }
  t->same = true;
  for (int w = 0; w < WAYS; w++) {
    t->same = t->same && (!t->large[w] || memcmp(state[0]->q, state[w]->q,
                                                 (size_t)model->length * sizeof(double)) == 0);
  }
  for (int w = 0; w < WAYS; w++) {
    strut_large_steps_free(large[w]);
    strut_state_free(state[w]);
  }
  return true;
}

static void print_ratio(const double *x, const double *y, bool known) {
  double ratio[TRIES], low, middle, high;
  if (!known) {
    printf("  %16s", "-");
    return;
  }
  for (int i = 0; i < TRIES; i++) ratio[i] = x[i] / y[i];
  spread(ratio, &low, &middle, &high);
  printf("  %4.2f (%4.2f-%4.2f)", middle, low, high);
}

static void print_time(const double *x, bool known) {
  double low, middle, high;
  spread(x, &low, &middle, &high);
  if (known)
    printf("  %7.1f", middle);
  else
    printf("  %7s", "-");
}

static bool make_scene(strut_setup *setup, bool chain, long members, strut_mass_model mass) {
  if (chain) return bench_chain_scene(setup, (size_t)members, mass) == STRUT_OK;
  if (!make_grid(setup, (int32_t)lround(sqrt((double)members / 4.0) + 0.5))) return false;
  setup->scene.mass_model = mass;
  for (size_t j = 0; j < setup->scene.member_count && mass == STRUT_MASS_CONSISTENT; j++)
    if (setup->scene.members[j].kind == STRUT_SPRING) setup->scene.members[j].mass = 0.05;
  return true;
}

typedef struct row {
  const char *method;
  bool chain, lumped;
} row;

static void measure(const row *of, long members, double bandwidth) {
  static timing ordered, shuffled;
  double bytes = 1.0, nodes = 0.0;
  for (int pass = 0; pass < 2; pass++) {
    strut_setup setup;
    strut_model *model = NULL;
    timing *t = pass ? &shuffled : &ordered;
    *t = (timing){.same = true};
    if (!make_scene(&setup, of->chain, members,
                    of->lumped ? STRUT_MASS_LUMPED : STRUT_MASS_CONSISTENT) ||
        (pass && !shuffle(&setup.scene)) || strut_model_compile(&setup.scene, &model, NULL) ||
        !time_steps(model, of->method, t)) {
      printf("out of memory\n");
      return;
    }
    bytes = bytes_per_member(model), nodes = model->members.count;
    strut_model_free(model);
    strut_setup_free(&setup);
  }
  const strut_integrator *method = strut_integrator_find(of->method);
  int best = ordered.large[1] ? 1 : 0;
  double low, middle, high;
  printf("%-6s %-5s %-10s %8.0f", of->method, of->chain ? "chain" : "grid",
         of->lumped ? "lumped" : "consistent", nodes);
  print_time(ordered.busiest[0], true);
  print_time(ordered.busiest[1], ordered.large[1]);
  print_time(ordered.busiest[2], ordered.large[2]);
  print_ratio(ordered.busiest[best], ordered.busiest[2], ordered.large[2]);
  print_ratio(shuffled.busiest[best], ordered.busiest[best], shuffled.large[best]);
  print_ratio(shuffled.busiest[2], ordered.busiest[2], ordered.large[2] && shuffled.large[2]);
  spread(ordered.busiest[best], &low, &middle, &high);
  printf("  %5.2f%s\n", method->evaluations * bytes / bandwidth * 1e9 / middle,
         ordered.same && shuffled.same ? "" : "  other bits!");
  fflush(stdout);
}

void bench_large(long members) {
  static const long sizes[] = {1000, 10000, 100000, 1000000};
  static const row rows[] = {
      {"rk4", true, true},    {"rk4", false, true}, {"verlet", true, true}, {"verlet", false, true},
      {"euler", false, true}, {"rk4", true, false}, {"rk4", false, false}};
  double one = triad_rate(false), two = triad_rate(true);
  printf("triad: %.1f GB/s by one thread, %.1f by two\n", 1e-9 * one, 1e-9 * two);
  printf(
      "ns of processor time of the busiest thread per member and step, with the energy balance; "
      "medians, "
      "ratios with "
      "quartiles\n"
      "memory: time of a step at the triad's rate if each evaluation reads and writes all once, "
      "over that of one "
      "thread\n"
      "%-6s %-5s %-10s %8s  %7s  %7s  %7s  %16s  %16s  %16s  %s\n",
      "method", "", "masses", "members", "loop", "1", "2", "gain of 2", "shuffled, 1",
      "shuffled, 2", "memory");
  for (size_t r = 0; r < sizeof rows / sizeof *rows; r++)
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
      if (members && i > 0) break;
      measure(&rows[r], members ? members : sizes[i], one);
    }
}
