/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/algebra/linear_solver.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/model/algebra/cholmod_factor.h"
#include "engine/model/algebra/hot.h"

strut_status strut_linear_solver_load(strut_error *error) {
  const strut_cholmod_library *cholmod;
  return strut_cholmod_load(&cholmod, error);
}

static strut_factor *allocate_factor(int32_t n, size_t nonzeros) {
  strut_factor *factor = strut_allocate(1, sizeof *factor);
  if (!factor) return NULL;
  factor->n = n;
  factor->order = strut_allocate((size_t)n, sizeof *factor->order);
  factor->start = strut_allocate((size_t)n + 1, sizeof *factor->start);
  factor->row = strut_allocate(nonzeros, sizeof *factor->row);
  factor->value = strut_allocate(nonzeros, sizeof *factor->value);
  factor->inverse_diagonal = strut_allocate((size_t)n, sizeof *factor->inverse_diagonal);
  if (factor->order && factor->start && factor->row && factor->value && factor->inverse_diagonal)
    return factor;
  strut_factor_free(factor);
  return NULL;
}

/* CHOLMOD keeps D as the first entry of each column of L; we keep 1/D apart. */
static void copy_into(const strut_cholmod_columns *l, strut_factor *factor) {
  const int *start = l->start, *row = l->row, *order = l->order;
  const double *value = l->value;
  int32_t n = factor->n;
  assert(n == l->n);
  memcpy(factor->order, order, (size_t)n * sizeof *factor->order);
  int32_t at = 0;
  for (int32_t j = 0; j < n; j++) {
    factor->start[j] = at;
    factor->inverse_diagonal[j] = 1.0 / value[start[j]];
    for (int32_t k = start[j] + 1; k < start[j + 1]; k++, at++) {
      factor->row[at] = row[k];
      factor->value[at] = value[k];
    }
  }
  factor->start[n] = at;
}

static strut_factor *copy_out(const strut_cholmod_columns *l) {
  strut_factor *factor = allocate_factor(l->n, (size_t)(l->start[l->n] - l->n));
  if (factor) copy_into(l, factor);
  return factor;
}

/* ---- parts side by side ---- */

/* Matrices from this size on; smaller ones are in no hurry. Parts that are solved in turns. */
enum { LEAST_TO_WEAVE = 256, MOST_TURNS = 4 };

/* Which part each column belongs to; returns how many parts there are. */
static int32_t find_parts(const strut_factor *f, int32_t *part) {
  int32_t parts = 0;
  for (int32_t j = f->n - 1; j >= 0; j--)
    part[j] = f->start[j] < f->start[j + 1] ? part[f->row[f->start[j]]] : parts++;
  return parts;
}

/* Each part goes to the turn with the fewest columns so far; columns of the turns one after the other. */
static void order_turns(int32_t n, int32_t parts, const int32_t *part, int32_t *turn,
                        int32_t *old) {
  int32_t load[MOST_TURNS] = {0}, at[MOST_TURNS] = {0};
  for (int32_t p = 0; p < parts; p++) turn[p] = 0;
  for (int32_t j = 0; j < n; j++) turn[part[j]]++;
  for (int32_t p = 0; p < parts; p++) {
    int32_t least = 0, columns = turn[p];
    for (int32_t t = 1; t < MOST_TURNS; t++)
      if (load[t] < load[least]) least = t;
    load[least] += columns;
    turn[p] = least;
  }
  for (int32_t i = 0, t = 0; i < n; t = (t + 1) % MOST_TURNS) {
    while (at[t] < n && turn[part[at[t]]] != t) at[t]++;
    if (at[t] < n) old[i++] = at[t]++;
  }
}

/*
 * Stores parts of the matrix that nothing couples column by column in turns: a column waits for the one before of
 * its own part, and the processor works on the others meanwhile. Every sum keeps its order. False: out of memory.
 */
static bool weave_parts(strut_factor **factor) {
  const strut_factor *f = *factor;
  strut_arena scratch = {0};
  size_t n = (size_t)f->n;
  if (f->n < LEAST_TO_WEAVE) return true;
  int32_t *part = strut_arena_allocate(&scratch, n, sizeof *part);
  int32_t *turn = strut_arena_allocate(&scratch, n, sizeof *turn);
  int32_t *old = strut_arena_allocate(&scratch, n, sizeof *old);
  int32_t *place = strut_arena_allocate(&scratch, n, sizeof *place);
  bool good = part && turn && old && place;
  int32_t parts = good ? find_parts(f, part) : 0, at = 0;
  strut_factor *woven = parts > 1 ? allocate_factor(f->n, (size_t)f->start[f->n]) : NULL;
  if (parts > 1) good = woven;
  if (woven) order_turns(f->n, parts, part, turn, old);
  for (int32_t i = 0; i < f->n && woven; i++) place[old[i]] = i;
  for (int32_t i = 0; i < f->n && woven; i++) {
    int32_t j = old[i];
    woven->order[i] = f->order[j], woven->inverse_diagonal[i] = f->inverse_diagonal[j];
    woven->start[i] = at;
    for (int32_t k = f->start[j]; k < f->start[j + 1]; k++, at++)
      woven->row[at] = place[f->row[k]], woven->value[at] = f->value[k];
  }
  if (woven) {
    woven->start[f->n] = at;
    strut_factor_free(*factor);
    *factor = woven;
  }
  strut_arena_free(&scratch);
  return good;
}

/* ---- factors ---- */

/*
 * The row of A at which it shows not to be positive definite, or -1. CHOLMOD's L D L' stops at a
 * zero in D only, so the signs are checked here.
 */
static int32_t bad_row(const strut_cholmod_columns *l) {
  if (l->finished < l->n) return l->order[l->finished];
  for (int32_t j = 0; j < l->n; j++)
    if (!(l->value[l->start[j]] > 0)) return l->order[j];
  return -1;
}

/* Columns of the factor begin at 32-bit indices. */
static strut_status check_size(int32_t rows, double nonzeros, strut_error *error) {
  if (nonzeros <= (double)INT32_MAX) return STRUT_OK;
  return strut_fail(error, STRUT_NO_MEMORY,
                    "the factor of a matrix of %d rows would have %.3g nonzeros, more than can be "
                    "counted; lumped masses need none",
                    (int)rows, nonzeros);
}

strut_status strut_factor_create(const strut_sparse *matrix, strut_factor **factor,
                                 strut_error *error) {
  *factor = NULL;
  const strut_cholmod_library *cholmod = NULL;
  strut_status status = strut_cholmod_load(&cholmod, error);
  if (status) return status;
  double nonzeros = 0.0; /* counted by the analysis */
  strut_cholmod_columns l;
  strut_cholmod_factor *analysed = cholmod->analyse(matrix, &nonzeros);
  if (!analysed)
    return strut_fail(error, STRUT_NO_MEMORY, "out of memory while factorising a matrix");
  status = check_size(matrix->n, nonzeros, error);
  if (!status && cholmod->factorise(analysed, matrix, 0.0, &l)) {
    int32_t row = bad_row(&l);
    if (row < 0 && (*factor = copy_out(&l)) && !weave_parts(factor)) {
      strut_factor_free(*factor);
      *factor = NULL;
    }
    if (row >= 0)
      status = strut_fail(error, STRUT_SINGULAR,
                          "the matrix is not positive definite (row %d of %d)", row, matrix->n);
  }
  if (!*factor && !status) status = strut_no_memory(error, "for the factor of a matrix");
  cholmod->free(analysed);
  return status;
}

void strut_factor_free(strut_factor *factor) {
  if (!factor) return;
  strut_release(factor->order);
  strut_release(factor->start);
  strut_release(factor->row);
  strut_release(factor->value);
  strut_release(factor->inverse_diagonal);
  strut_release(factor);
}

void strut_factor_solve(const strut_factor *factor, double *restrict b) {
  const int32_t *start = factor->start, *row = factor->row;
  const double *value = factor->value;
  for (int32_t j = 0; j < factor->n; j++)
    for (int32_t k = start[j]; k < start[j + 1]; k++) b[row[k]] -= value[k] * b[j];
  for (int32_t j = factor->n - 1; j >= 0; j--) {
    double sum = b[j] * factor->inverse_diagonal[j];
    for (int32_t k = start[j]; k < start[j + 1]; k++) sum -= value[k] * b[row[k]];
    b[j] = sum;
  }
}

void strut_factor_solve_pair(const strut_factor *factor, double *restrict b) {
  const int32_t *restrict start = factor->start, *restrict row = factor->row;
  const double *restrict value = factor->value, *restrict inverse = factor->inverse_diagonal;
  int32_t n = factor->n;
  for (int32_t j = 0; j < n; j++) {
    strut_pair x = strut_pair_load(b + 2 * j);
    for (int32_t k = start[j]; k < start[j + 1]; k++)
      strut_pair_store(b + 2 * row[k], strut_pair_load(b + 2 * row[k]) - value[k] * x);
  }
  for (int32_t j = n - 1; j >= 0; j--) {
    strut_pair x = strut_pair_load(b + 2 * j) * inverse[j];
    for (int32_t k = start[j]; k < start[j + 1]; k++)
      x -= value[k] * strut_pair_load(b + 2 * row[k]);
    strut_pair_store(b + 2 * j, x);
  }
}

struct strut_ldl {
  const strut_cholmod_library *cholmod;
  strut_cholmod_factor *analysed;
  strut_factor *factor; /* of what was factorised last; NULL before */
  double *work;         /* (3 n) */
  double norm;          /* |A + shift I|_1 of it */
};

strut_status strut_ldl_create(const strut_sparse *pattern, strut_ldl **ldl, strut_error *error) {
  *ldl = NULL;
  const strut_cholmod_library *cholmod = NULL;
  strut_status status = strut_cholmod_load(&cholmod, error);
  if (status) return status;
  strut_ldl *l = *ldl = strut_allocate(1, sizeof *l);
  if (!l) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  double nonzeros = 0.0;
  l->cholmod = cholmod;
  l->analysed = cholmod->analyse(pattern, &nonzeros);
  l->work = strut_allocate(3 * (size_t)pattern->n, sizeof *l->work);
  status = l->analysed && l->work
               ? check_size(pattern->n, nonzeros, error)
               : strut_fail(error, STRUT_NO_MEMORY, "out of memory while analysing a matrix");
  if (status == STRUT_OK) return status;
  strut_ldl_free(l);
  *ldl = NULL;
  return status;
}

void strut_ldl_free(strut_ldl *ldl) {
  if (!ldl) return;
  ldl->cholmod->free(ldl->analysed);
  strut_factor_free(ldl->factor);
  strut_release(ldl->work);
  strut_release(ldl);
}

/* The largest column sum of |A + shift I|. */
static double norm_of(const strut_sparse *a, double shift, double *sum) {
  double largest = 0.0;
  for (int32_t j = 0; j < a->n; j++) sum[j] = 0.0;
  for (int32_t j = 0; j < a->n; j++) {
    sum[j] += fabs(a->value[a->start[j]] + shift);
    for (int32_t k = a->start[j] + 1; k < a->start[j + 1]; k++) {
      sum[j] += fabs(a->value[k]);
      sum[a->row[k]] += fabs(a->value[k]);
    }
  }
  for (int32_t j = 0; j < a->n; j++) largest = fmax(largest, sum[j]);
  return largest;
}

/* False where a pivot cannot be divided by. */
static bool read_inertia(const strut_cholmod_columns *l, const strut_sparse *a, double shift,
                         strut_inertia *inertia) {
  *inertia = (strut_inertia){.row = -1, .smallest = HUGE_VAL, .least = HUGE_VAL};
  if (l->finished < l->n) {
    inertia->row = l->order[l->finished];
    inertia->smallest = inertia->least = 0.0;
    return false;
  }
  for (int32_t j = 0; j < l->n; j++) {
    int32_t row = l->order[j];
    double d = l->value[l->start[j]], size = fabs(d);
    double before = fabs(a->value[a->start[row]] + shift);
    double left = before > 0 ? size / before : 1.0;
    if (!(size > 0) || !isfinite(size)) {
      *inertia = (strut_inertia){.row = row};
      return false;
    }
    if (d < 0) inertia->negative++;
    if (left < inertia->smallest) inertia->smallest = left, inertia->row = row;
    inertia->least = fmin(inertia->least, size);
    inertia->largest = fmax(inertia->largest, size);
  }
  return true;
}

strut_status strut_ldl_factorise(strut_ldl *ldl, const strut_sparse *matrix, double shift,
                                 strut_inertia *inertia) {
  strut_cholmod_columns l;
  strut_status status = STRUT_NO_MEMORY;
  *inertia = (strut_inertia){.row = -1};
  ldl->norm = norm_of(matrix, shift, ldl->work);
  if (ldl->cholmod->factorise(ldl->analysed, matrix, shift, &l)) {
    bool good = read_inertia(&l, matrix, shift, inertia);
    if (!ldl->factor) ldl->factor = allocate_factor(matrix->n, (size_t)(l.start[l.n] - matrix->n));
    if (ldl->factor && good) copy_into(&l, ldl->factor);
    if (ldl->factor) status = good ? STRUT_OK : STRUT_SINGULAR;
  }
  ldl->cholmod->forget(ldl->analysed);
  return status;
}

void strut_ldl_solve(strut_ldl *ldl, double *b) {
  const strut_factor *f = ldl->factor;
  double *x = ldl->work;
  for (int32_t i = 0; i < f->n; i++) x[i] = b[f->order[i]];
  strut_factor_solve(f, x);
  for (int32_t i = 0; i < f->n; i++) b[f->order[i]] = x[i];
}

/* Hager's method: climbs to a column of A^-1 with a large sum; then Higham's second guess. */
double strut_ldl_rcond(strut_ldl *ldl) {
  int32_t n = ldl->factor->n;
  double *x = ldl->work + n, *y = ldl->work + 2 * (size_t)n, best = 0.0, other = 0.0;
  if (n == 0 || !(ldl->norm > 0)) return n == 0 ? 1.0 : 0.0;
  for (int32_t i = 0; i < n; i++) x[i] = 1.0 / n;
  for (int turn = 0; turn < 5; turn++) {
    double sum = 0.0;
    int32_t at = 0;
    strut_ldl_solve(ldl, x);
    for (int32_t i = 0; i < n; i++) sum += fabs(x[i]);
    if (turn > 0 && !(sum > best)) break;
    best = sum;
    for (int32_t i = 0; i < n; i++) y[i] = x[i] < 0 ? -1.0 : 1.0;
    strut_ldl_solve(ldl, y);
    for (int32_t i = 0; i < n; i++)
      if (fabs(y[i]) > fabs(y[at])) at = i;
    for (int32_t i = 0; i < n; i++) x[i] = i == at ? 1.0 : 0.0;
  }
  for (int32_t i = 0; i < n; i++)
    x[i] = (i % 2 ? -1.0 : 1.0) * (1.0 + (n > 1 ? (double)i / (n - 1) : 0.0));
  strut_ldl_solve(ldl, x);
  for (int32_t i = 0; i < n; i++) other += fabs(x[i]);
  return 1.0 / (ldl->norm * fmax(best, 2.0 * other / (3.0 * n)));
}

struct strut_refactor {
  strut_factor factor;
  /* the matrix's entries in the factor's order, column by column: row, and place among its values */
  int32_t *start, *row, *from; /* (n + 1), (nonzeros) each */
  double *diagonal, *work;     /* (n) D; scratch, all 0 between calls */
  /* columns waiting for the row of their next entry, as lists */
  int32_t *head, *next, *at; /* (n) each */
};

/* A matrix of the pattern that is positive definite beyond doubt: -1 beside a heavier diagonal. */
static bool fill_example(const strut_sparse *pattern, strut_sparse *example, strut_arena *arena) {
  *example = *pattern;
  example->value =
      strut_arena_allocate(arena, (size_t)pattern->start[pattern->n], sizeof *example->value);
  if (!example->value) return false;
  for (int32_t j = 0; j < pattern->n; j++) example->value[pattern->start[j]] = 1.0;
  for (int32_t j = 0; j < pattern->n; j++)
    for (int32_t k = pattern->start[j] + 1; k < pattern->start[j + 1]; k++) {
      example->value[k] = -1.0;
      example->value[pattern->start[j]] += 1.0;
      example->value[pattern->start[pattern->row[k]]] += 1.0;
    }
  return true;
}

static bool copy_factor(const strut_factor *from, strut_factor *to, strut_arena *arena) {
  size_t n = (size_t)from->n, nonzeros = (size_t)from->start[from->n];
  to->n = from->n;
  to->order = strut_arena_allocate(arena, n, sizeof *to->order);
  to->start = strut_arena_allocate(arena, n + 1, sizeof *to->start);
  to->row = strut_arena_allocate(arena, nonzeros, sizeof *to->row);
  to->value = strut_arena_allocate(arena, nonzeros, sizeof *to->value);
  to->inverse_diagonal = strut_arena_allocate(arena, n, sizeof *to->inverse_diagonal);
  if (!to->order || !to->start || !to->row || !to->value || !to->inverse_diagonal) return false;
  memcpy(to->order, from->order, n * sizeof *to->order);
  memcpy(to->start, from->start, (n + 1) * sizeof *to->start);
  memcpy(to->row, from->row, nonzeros * sizeof *to->row);
  return true;
}

/* The place of each entry of the matrix in the factor's order. */
static void place_entries(const strut_sparse *pattern, strut_refactor *r) {
  int32_t n = pattern->n, *place = r->next;
  for (int32_t i = 0; i < n; i++) place[r->factor.order[i]] = i;
  for (int32_t pass = 0; pass < 2; pass++) {
    for (int32_t j = 0; j < n; j++)
      for (int32_t k = pattern->start[j]; k < pattern->start[j + 1]; k++) {
        int32_t a = place[j], b = place[pattern->row[k]], column = a < b ? a : b;
        if (pass == 0) {
          r->start[column + 1]++;
          continue;
        }
        int32_t to = r->start[column] + r->at[column]++;
        r->row[to] = a < b ? b : a;
        r->from[to] = k;
      }
    for (int32_t j = 0; j < n && pass == 0; j++) r->start[j + 1] += r->start[j];
  }
}

strut_refactor *strut_refactor_create(const strut_sparse *pattern, strut_arena *arena) {
  strut_refactor *r = strut_arena_allocate(arena, 1, sizeof *r);
  strut_arena scratch = {0};
  strut_sparse example;
  strut_factor *factor = NULL;
  size_t n = (size_t)pattern->n, nonzeros = (size_t)pattern->start[n];
  bool good = r && fill_example(pattern, &example, &scratch) &&
              !strut_factor_create(&example, &factor, NULL) &&
              copy_factor(factor, &r->factor, arena);
  strut_factor_free(factor);
  strut_arena_free(&scratch);
  if (!good) return NULL;
  int32_t **indices[] = {&r->row, &r->from, &r->head, &r->next, &r->at, &r->start};
  size_t counts[] = {nonzeros, nonzeros, n, n, n, n + 1};
  for (size_t i = 0; i < sizeof indices / sizeof indices[0]; i++)
    if (!(*indices[i] = strut_arena_allocate(arena, counts[i], sizeof **indices[i]))) return NULL;
  r->diagonal = strut_arena_allocate(arena, n, sizeof *r->diagonal);
  r->work = strut_arena_allocate(arena, n, sizeof *r->work);
  if (!r->diagonal || !r->work) return NULL;
  place_entries(pattern, r);
  return r;
}

/* Column k waits for the row of its entry at r->at[k], if there is one left. */
static void wait_for_next(strut_refactor *r, int32_t k) {
  if (r->at[k] == r->factor.start[k + 1]) return;
  int32_t row = r->factor.row[r->at[k]];
  r->next[k] = r->head[row];
  r->head[row] = k;
}

/* Column by column, each taking what the ones before it leave (left-looking). */
int32_t strut_refactor_apply(strut_refactor *r, const strut_sparse *matrix) {
  const strut_factor *f = &r->factor;
  double *restrict work = r->work;
  for (int32_t j = 0; j < f->n; j++) r->head[j] = -1;
  for (int32_t j = 0; j < f->n; j++) {
    for (int32_t i = r->start[j]; i < r->start[j + 1]; i++)
      work[r->row[i]] += matrix->value[r->from[i]];
    for (int32_t k = r->head[j], following; k >= 0; k = following) {
      following = r->next[k];
      double part = f->value[r->at[k]] * r->diagonal[k];
      for (int32_t i = r->at[k]; i < f->start[k + 1]; i++) work[f->row[i]] -= f->value[i] * part;
      r->at[k]++;
      wait_for_next(r, k);
    }
    double pivot = work[j];
    if (!(pivot > 0.0) || isinf(pivot)) {
      memset(work, 0, (size_t)f->n * sizeof *work);
      return f->order[j];
    }
    work[j] = 0.0;
    r->diagonal[j] = pivot;
    f->inverse_diagonal[j] = 1.0 / pivot;
    for (int32_t i = f->start[j]; i < f->start[j + 1]; i++) {
      f->value[i] = work[f->row[i]] * f->inverse_diagonal[j];
      work[f->row[i]] = 0.0;
    }
    r->at[j] = f->start[j];
    wait_for_next(r, j);
  }
  return -1;
}

void strut_refactor_solve(strut_refactor *r, double *b) {
  const strut_factor *f = &r->factor;
  for (int32_t i = 0; i < f->n; i++) r->work[i] = b[f->order[i]];
  strut_factor_solve(f, r->work);
  for (int32_t i = 0; i < f->n; i++) b[f->order[i]] = r->work[i], r->work[i] = 0.0;
}
