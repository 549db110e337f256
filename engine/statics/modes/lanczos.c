/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/modes/lanczos.h"

#include <pthread.h>
#include <stdbool.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/model/algebra_calls.h"

enum {
  INTERRUPTED = 1000, /* no code of ARPACK's */
  SHIFT_INVERT = 3,
  MOST_RESTARTS = 2000,
  LEAST_VECTORS = 40
};

/* Relative error of the vectors; that of the eigenvalues is its square. */
static const double GOOD = 1e-11;

static pthread_mutex_t arpack_lock = PTHREAD_MUTEX_INITIALIZER;

typedef struct search {
  int32_t n, wanted, vectors;
  double *residual, *basis, *work, *small, *value;
  a_int *select, parameter[11], pointer[14];
} search;

/* A start that leans on no motion: bits stirred from the index. */
static double stirred(uint64_t i) {
  uint64_t z = (i + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  return (double)((z ^ (z >> 27)) >> 11) * 0x1p-53 - 0.5;
}

static bool begin(search *s, strut_arena *arena) {
  size_t n = (size_t)s->n, p = (size_t)s->vectors;
  s->residual = strut_arena_allocate(arena, n, sizeof(double));
  s->basis = strut_arena_allocate(arena, n * p, sizeof(double));
  s->work = strut_arena_allocate(arena, 3 * n, sizeof(double));
  s->small = strut_arena_allocate(arena, p * (p + 8), sizeof(double));
  s->value = strut_arena_allocate(arena, p, sizeof(double));
  s->select = strut_arena_allocate(arena, p, sizeof *s->select);
  if (!s->residual || !s->basis || !s->work || !s->small || !s->value || !s->select) return false;
  for (int32_t i = 0; i < s->n; i++) s->residual[i] = stirred((uint64_t)i);
  s->parameter[0] = 1; /* ARPACK chooses the shifts of its restarts */
  s->parameter[2] = MOST_RESTARTS;
  s->parameter[6] = SHIFT_INVERT;
  return true;
}

/* ARPACK asks for products until it is done; its pointers count from 1. */
static a_int iterate(const strut_lanczos_problem *problem, search *s) {
  a_int task = 0, info = 1; /* the residual is ours */
  a_int small = s->vectors * (s->vectors + 8);
  for (;;) {
    if (problem->interrupt && *problem->interrupt) return INTERRUPTED;
    dsaupd_c(&task, "G", s->n, "LM", s->wanted, GOOD, s->residual, s->vectors, s->basis, s->n,
             s->parameter, s->pointer, s->work, s->small, small, &info);
    double *x = s->work + s->pointer[0] - 1, *y = s->work + s->pointer[1] - 1;
    if (task == 2) {
      problem->mass(problem->context, x, y);
    } else if (task == -1) {
      problem->mass(problem->context, x, y);
      problem->solve(problem->context, y);
    } else if (task == 1) {
      memcpy(y, s->work + s->pointer[2] - 1, (size_t)s->n * sizeof *y);
      problem->solve(problem->context, y);
    } else {
      return info;
    }
  }
}

static a_int finish(const strut_lanczos_problem *problem, search *s) {
  a_int info = 0, small = s->vectors * (s->vectors + 8);
  dseupd_c(1, "A", s->select, s->value, s->basis, s->n, problem->shift, "G", s->n, "LM", s->wanted,
           GOOD, s->residual, s->vectors, s->basis, s->n, s->parameter, s->pointer, s->work,
           s->small, small, &info);
  return info;
}

static void take_sorted(const search *s, double *value, double *vector) {
  for (int32_t i = 0; i < s->wanted; i++) {
    int32_t rank = 0;
    for (int32_t k = 0; k < s->wanted; k++)
      rank += s->value[k] < s->value[i] || (s->value[k] == s->value[i] && k < i);
    value[rank] = s->value[i];
    memcpy(vector + (size_t)rank * (size_t)s->n, s->basis + (size_t)i * (size_t)s->n,
           (size_t)s->n * sizeof *vector);
  }
}

strut_status strut_lanczos(const strut_lanczos_problem *problem, int32_t count, double *value,
                           double *vector, strut_error *error) {
  strut_arena arena = {0};
  search s = {.n = problem->n, .wanted = count};
  s.vectors = 2 * count + 10 > LEAST_VECTORS ? 2 * count + 10 : LEAST_VECTORS;
  if (s.vectors > s.n) s.vectors = s.n;
  strut_status status = strut_algebra_load(error);
  if (status) return status;
  if (!begin(&s, &arena)) {
    status = strut_no_memory(error, "");
  } else {
    pthread_mutex_lock(&arpack_lock);
    strut_algebra_begin();
    a_int info = iterate(problem, &s);
    if (info == 0) info = finish(problem, &s);
    strut_algebra_end();
    pthread_mutex_unlock(&arpack_lock);
    if (info == INTERRUPTED)
      status = strut_fail(error, STRUT_INTERRUPTED, "interrupted");
    else if (info != 0 || s.parameter[4] < count)
      status = strut_fail(error, STRUT_SINGULAR,
                          "Lanczos's method found %d of the %d lowest modes (ARPACK code %d)",
                          (int)s.parameter[4], (int)count, (int)info);
    else
      take_sorted(&s, value, vector);
  }
  strut_arena_free(&arena);
  return status;
}
