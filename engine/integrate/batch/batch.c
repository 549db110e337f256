/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/batch/batch.h"

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

bool strut_batch_knows(const strut_integrator *method) { return method->batch; }

bool strut_batch_possible(const strut_model *model, const strut_integrator *method) {
  return strut_batch_knows(method) && strut_batch_takes_model(model);
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
  b->work = strut_arena_allocate(&b->arena, STRUT_BATCH_POWERS * width, sizeof(double));
  return good && b->work;
}

strut_batch *strut_batch_create(const strut_model *first, const strut_integrator *method,
                                int32_t width, bool balance) {
  strut_batch *b = strut_allocate(1, sizeof *b);
  if (!b) return NULL;
  b->method = method;
  b->balance = balance;
  bool good = strut_batch_tables_create(first, width, &b->arena, &b->tables) && create_stages(b);
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

/* An idle slot does what another one does, which keeps it finite. */
static void imitate(strut_batch *b, int32_t to, int32_t from) {
  assert(to >= 0 && to < STRUT_BATCH_MOST && from >= 0 && from < STRUT_BATCH_MOST);
  int32_t width = b->tables.width, length = b->tables.first->length;
  strut_batch_tables_copy(&b->tables, to, from);
  copy_rows(b->q, length, width, to, from);
  copy_rows(b->v, length, width, to, from);
  copy_rows(b->work, STRUT_BATCH_POWERS, width, to, from);
  b->dt[to] = b->dt[from];
  b->step[to] = b->step[from];
  b->driven = false;
}

void strut_batch_fill(strut_batch *b, int32_t slot, const strut_model *model, double dt) {
  assert(slot >= 0 && slot < STRUT_BATCH_MOST);
  strut_batch_tables_fill(&b->tables, slot, model);
  b->dt[slot] = dt;
  b->driven = false;
  b->filled[slot] = true;
}

void strut_batch_empty(strut_batch *b, int32_t slot) {
  assert(slot >= 0 && slot < STRUT_BATCH_MOST);
  b->filled[slot] = false;
  for (int32_t l = 0; l < b->tables.width; l++) /* those that imitate it, too */
    if (!b->filled[l]) b->tables.model[l] = NULL;
}

void strut_batch_put(strut_batch *b, int32_t slot, const strut_state *state) {
  assert(slot >= 0 && slot < STRUT_BATCH_MOST);
  int32_t width = b->tables.width, length = b->tables.first->length;
  for (int32_t i = 0; i < length; i++) {
    b->q[i * width + slot] = state->q[i];
    b->v[i * width + slot] = state->v[i];
  }
  for (int32_t p = 0; p < STRUT_BATCH_POWERS; p++) b->work[p * width + slot] = state->work[p];
  strut_batch_tables_put_elements(&b->tables, slot, state);
  b->step[slot] = (double)state->step;
  b->driven = false;
}

void strut_batch_count(const strut_batch *b, int32_t slot, strut_state *state) {
  assert(slot >= 0 && slot < STRUT_BATCH_MOST);
  int64_t before = state->step;
  state->step = (int64_t)b->step[slot];
  state->evaluations += (state->step - before) * b->method->evaluations;
}

void strut_batch_sample(const strut_batch *b, int32_t slot, strut_state *state) {
  int32_t width = b->tables.width, length = 2 * b->tables.first->node_count;
  for (int32_t i = 0; i < length; i++) {
    state->q[i] = b->q[i * width + slot];
    state->v[i] = b->v[i * width + slot];
  }
  if (b->balance) state->work[STRUT_POWER_DRIVE] = b->work[STRUT_POWER_DRIVE * width + slot];
  strut_batch_count(b, slot, state);
}

void strut_batch_get(strut_batch *b, int32_t slot, strut_state *state) {
  assert(slot >= 0 && slot < STRUT_BATCH_MOST);
  const strut_batch_tables *t = &b->tables;
  int32_t width = t->width;
  strut_batch_sample(b, slot, state);
  for (int32_t i = 0; i < 2 * t->first->node_count; i++)
    state->latest.force[i] = t->force[i * width + slot];
  strut_batch_tables_get_elements(t, slot, state);
  state->latest.drive_time = b->driven ? b->step[slot] * b->dt[slot] : (double)NAN;
  for (int32_t j = 0; j < t->first->members.slots && b->driven; j++) {
    state->latest.rest[j] = t->members.rest[j * width + slot];
    state->latest.rest_rate[j] = t->members.rest_rate[j * width + slot];
  }
  for (int32_t p = 0; p < STRUT_BATCH_POWERS && b->balance; p++) {
    state->work[p] = b->work[p * width + slot];
    state->latest.power[p] = t->power[p * width + slot];
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
