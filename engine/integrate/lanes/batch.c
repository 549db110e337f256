/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/lanes/batch.h"

#include <assert.h>
#include <math.h>

#if defined(__x86_64__)
static bool has_eight(void) {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl");
}
static bool has_four(void) { return __builtin_cpu_supports("avx2"); }
#else
static bool has_eight(void) { return false; }
static bool has_four(void) { return false; }
#endif

int32_t strut_batch_widest(void) { return has_four() ? 8 : 1; }

bool strut_batch_knows(const strut_integrator *method) { return method->lanes; }

bool strut_batch_possible(const strut_model *model, const strut_integrator *method) {
  return strut_batch_knows(method) && strut_lanes_possible(model);
}

static void choose_kernel(strut_batch *b, bool halves) {
  int32_t width = b->tables.width;
  assert(width == 4 || width == 8);
  b->run = width == 4 ? strut_batch_rk4_4 : halves ? strut_batch_rk4_8_halves : strut_batch_rk4_8;
}

/* What rk4 needs. */
static bool create_stages(strut_batch *b) {
  size_t width = (size_t)b->tables.width, both = (size_t)b->tables.first->length * width;
  double **const all[] = {&b->q,          &b->v,    &b->stage_q, &b->stage_v[1], &b->stage_v[2],
                          &b->stage_v[3], &b->a[0], &b->a[1],    &b->a[2],       &b->a[3]};
  bool good = true;
  for (size_t i = 0; i < sizeof all / sizeof all[0] && good; i++)
    good = (*all[i] = strut_arena_allocate(&b->arena, both, sizeof(double))) != NULL;
  b->work = strut_arena_allocate(&b->arena, STRUT_LANE_POWERS * width, sizeof(double));
  return good && b->work;
}

strut_batch *strut_batch_create(const strut_model *first, const strut_integrator *method,
                                int32_t width, bool ledger) {
  strut_batch *b = strut_allocate(1, sizeof *b);
  if (!b) return NULL;
  b->method = method;
  b->ledger = ledger;
  bool good = strut_lane_tables_create(first, width, &b->arena, &b->tables) && create_stages(b);
  b->dt = strut_arena_allocate(&b->arena, (size_t)width, sizeof(double));
  b->step = strut_arena_allocate(&b->arena, (size_t)width, sizeof(double));
  if (good && b->dt && b->step) {
    choose_kernel(b, !has_eight());
    return b;
  }
  strut_batch_free(b);
  return NULL;
}

void strut_batch_halve(strut_batch *b) { choose_kernel(b, true); }

void strut_batch_free(strut_batch *b) {
  if (!b) return;
  strut_arena_free(&b->arena);
  strut_release(b);
}

static void copy_rows(double *table, int32_t rows, int32_t width, int32_t to, int32_t from) {
  for (int32_t i = 0; i < rows; i++) table[i * width + to] = table[i * width + from];
}

/* An idle lane does what another one does, which keeps it finite. */
static void imitate(strut_batch *b, int32_t to, int32_t from) {
  int32_t width = b->tables.width, length = b->tables.first->length;
  strut_lane_tables_copy(&b->tables, to, from);
  copy_rows(b->q, length, width, to, from);
  copy_rows(b->v, length, width, to, from);
  copy_rows(b->work, STRUT_LANE_POWERS, width, to, from);
  b->dt[to] = b->dt[from];
  b->step[to] = b->step[from];
  b->driven = false;
}

void strut_batch_fill(strut_batch *b, int32_t lane, const strut_model *model, double dt) {
  strut_lane_tables_fill(&b->tables, lane, model);
  b->dt[lane] = dt;
  b->driven = false;
  b->filled[lane] = true;
}

void strut_batch_empty(strut_batch *b, int32_t lane) {
  b->filled[lane] = false;
  for (int32_t l = 0; l < b->tables.width; l++) /* those that imitate it, too */
    if (!b->filled[l]) b->tables.model[l] = NULL;
}

void strut_batch_put(strut_batch *b, int32_t lane, const strut_state *state) {
  int32_t width = b->tables.width, length = b->tables.first->length;
  for (int32_t i = 0; i < length; i++) {
    b->q[i * width + lane] = state->q[i];
    b->v[i * width + lane] = state->v[i];
  }
  for (int32_t p = 0; p < STRUT_LANE_POWERS; p++) b->work[p * width + lane] = state->work[p];
  strut_lane_tables_put_elements(&b->tables, lane, state);
  b->step[lane] = (double)state->step;
  b->driven = false;
}

void strut_batch_count(const strut_batch *b, int32_t lane, strut_state *state) {
  int64_t before = state->step;
  state->step = (int64_t)b->step[lane];
  state->evaluations += (state->step - before) * b->method->evaluations;
}

void strut_batch_sample(const strut_batch *b, int32_t lane, strut_state *state) {
  int32_t width = b->tables.width, length = 2 * b->tables.first->node_count;
  for (int32_t i = 0; i < length; i++) {
    state->q[i] = b->q[i * width + lane];
    state->v[i] = b->v[i * width + lane];
  }
  if (b->ledger) state->work[STRUT_POWER_DRIVE] = b->work[STRUT_POWER_DRIVE * width + lane];
  strut_batch_count(b, lane, state);
}

void strut_batch_get(strut_batch *b, int32_t lane, strut_state *state) {
  const strut_lane_tables *t = &b->tables;
  int32_t width = t->width;
  strut_batch_sample(b, lane, state);
  for (int32_t i = 0; i < 2 * t->first->node_count; i++)
    state->force[i] = t->force[i * width + lane];
  strut_lane_tables_get_elements(t, lane, state);
  state->drive_time = b->driven ? b->step[lane] * b->dt[lane] : (double)NAN;
  for (int32_t j = 0; j < t->first->members.slots && b->driven; j++) {
    state->rest[j] = t->rest[j * width + lane];
    state->rest_rate[j] = t->rest_rate[j * width + lane];
  }
  for (int32_t p = 0; p < STRUT_LANE_POWERS && b->ledger; p++) {
    state->work[p] = b->work[p * width + lane];
    state->power[p] = t->power[p * width + lane];
  }
}

void strut_batch_advance(strut_batch *b, const int64_t *left) {
  int32_t from = 0;
  int64_t count = INT64_MAX;
  while (!b->filled[from]) from++;
  for (int32_t l = 0; l < b->tables.width; l++) {
    if (!b->filled[l] && !b->tables.model[l]) imitate(b, l, from);
    if (b->filled[l] && left[l] < count) count = left[l];
  }
  b->run(b, count);
  b->driven = true;
}
