/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/self_stress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TINY = 1e-11;      /* beside the largest force: rounding */
static const double PIVOT_SHARE = 0.1; /* of the largest entry: what a pivot must have */
static const double MOST_WORK = 4e8;   /* multiplications spent on locality */
static const double LEADS = 0.01;      /* of the largest: what a force made 1 must have */

/* Reduced echelon form, members from `shift` on: 1 at its own pivot, 0 at the others. */
static void reduce(double *rows, size_t count, size_t columns, size_t shift) {
  size_t done = 0;
  for (size_t c = 0; c < columns && done < count; c++) {
    size_t j = (c + shift) % columns, best = done;
    double largest = 0.0;
    for (size_t i = done; i < count; i++) {
      if (fabs(rows[i * columns + j]) > fabs(rows[best * columns + j])) best = i;
      for (size_t k = 0; k < columns; k++) largest = fmax(largest, fabs(rows[i * columns + k]));
    }
    double pivot = rows[best * columns + j];
    bool last = columns - c <= count - done; /* no choice left */
    if (fabs(pivot) <= (last ? TINY : PIVOT_SHARE) * largest || pivot == 0.0) continue;
    for (size_t k = 0; k < columns; k++) {
      double swap = rows[best * columns + k];
      rows[best * columns + k] = rows[done * columns + k];
      rows[done * columns + k] = swap / pivot;
    }
    for (size_t i = 0; i < count; i++) {
      double factor = rows[i * columns + j];
      if (i == done || factor == 0.0) continue;
      for (size_t k = 0; k < columns; k++)
        rows[i * columns + k] -= factor * rows[done * columns + k];
      rows[i * columns + j] = 0.0;
    }
    done++;
  }
}

static void clean(double *row, size_t columns) {
  double largest = 0.0;
  for (size_t k = 0; k < columns; k++) largest = fmax(largest, fabs(row[k]));
  for (size_t k = 0; k < columns; k++)
    if (fabs(row[k]) <= TINY * largest) row[k] = 0.0;
}

static size_t support(const double *row, size_t columns) {
  size_t count = 0;
  for (size_t k = 0; k < columns; k++) count += row[k] != 0.0;
  return count;
}

/* What is left of a candidate beside the `count` orthonormal rows chosen; makes it one of them. */
static bool independent(double *chosen, size_t count, size_t columns, const double *row) {
  double *rest = chosen + count * columns, before = 0.0, after = 0.0;
  memcpy(rest, row, columns * sizeof *rest);
  for (size_t k = 0; k < columns; k++) before += row[k] * row[k];
  for (int twice = 0; twice < 2; twice++)
    for (size_t i = 0; i < count; i++) {
      double sum = 0.0;
      for (size_t k = 0; k < columns; k++) sum += chosen[i * columns + k] * rest[k];
      for (size_t k = 0; k < columns; k++) rest[k] -= sum * chosen[i * columns + k];
    }
  for (size_t k = 0; k < columns; k++) after += rest[k] * rest[k];
  if (after <= 1e-8 * before) return false;
  for (size_t k = 0; k < columns; k++) rest[k] /= sqrt(after);
  return true;
}

typedef struct candidate {
  size_t members, number;
  const double *row;
} candidate;

static int by_members(const void *a, const void *b) {
  const candidate *x = a, *y = b;
  if (x->members != y->members) return x->members < y->members ? -1 : 1;
  return x->number < y->number ? -1 : x->number > y->number;
}

/* Echelon forms from every member on; the states of fewest members that are independent. */
static bool choose_local(const double *basis, size_t count, size_t columns, size_t orders,
                         strut_arena *scratch, double *result) {
  size_t total = count * orders, size = count * columns, kept = 0;
  double *rows = strut_arena_allocate(scratch, total * columns, sizeof *rows);
  double *chosen = strut_arena_allocate(scratch, (count + 1) * columns, sizeof *chosen);
  candidate *list = strut_arena_allocate(scratch, total, sizeof *list);
  if (!rows || !chosen || !list) return false;
  for (size_t o = 0; o < orders; o++) {
    memcpy(rows + o * size, basis, size * sizeof *rows);
    reduce(rows + o * size, count, columns, o * columns / orders);
  }
  for (size_t i = 0; i < total; i++) {
    double *row = rows + i * columns;
    clean(row, columns);
    list[i] = (candidate){.members = support(row, columns), .number = i, .row = row};
  }
  qsort(list, total, sizeof *list, by_members);
  for (size_t i = 0; i < total && kept < count; i++) {
    if (!independent(chosen, kept, columns, list[i].row)) continue;
    memcpy(result + kept++ * columns, list[i].row, columns * sizeof *result);
  }
  return true;
}

/* The member whose force is made 1. */
static size_t leader(const strut_model *model, const double *force, size_t columns) {
  static const strut_member_kind order[] = {STRUT_CABLE, STRUT_SPRING, STRUT_BAR};
  double largest = 0.0;
  for (size_t j = 0; j < columns; j++) largest = fmax(largest, fabs(force[j]));
  for (int i = 0; i < 3; i++)
    for (size_t j = 0; j < columns; j++)
      if (model->scene->members[j].kind == order[i] && fabs(force[j]) > LEADS * largest) return j;
  return 0;
}

static void count_cables(const strut_model *model, const double *force, size_t columns,
                         size_t *pulled, size_t *pressed) {
  *pulled = *pressed = 0;
  for (size_t j = 0; j < columns; j++) {
    if (model->scene->members[j].kind != STRUT_CABLE) continue;
    *pulled += force[j] > 0;
    *pressed += force[j] < 0;
  }
}

static bool scale(const strut_model *model, double *force, size_t columns) {
  size_t pulled, pressed;
  double unit = force[leader(model, force, columns)];
  for (size_t j = 0; j < columns && unit != 0.0; j++) force[j] = force[j] / unit + 0.0; /* no -0 */
  count_cables(model, force, columns, &pulled, &pressed);
  return pressed == 0;
}

strut_status strut_self_stress_sort(const strut_model *model, const strut_null_spaces *spaces,
                                    strut_arena *arena, strut_self_stress *states) {
  *states = (strut_self_stress){.count = spaces->states};
  if (spaces->states == 0 || !spaces->state) return STRUT_OK;
  size_t count = (size_t)spaces->states, columns = (size_t)model->members.count;
  strut_arena scratch = {0};
  states->force = strut_arena_allocate(arena, count * columns, sizeof *states->force);
  states->cables_pull = strut_arena_allocate(arena, count, sizeof *states->cables_pull);
  double work = (double)count * (double)count * (double)columns;
  size_t orders = (size_t)fmax(1.0, fmin((double)columns, MOST_WORK / (work * (double)count)));
  bool good = states->force && states->cables_pull &&
              choose_local(spaces->state, count, columns, orders, &scratch, states->force);
  strut_arena_free(&scratch);
  if (!good) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < count; i++)
    states->cables_pull[i] = scale(model, states->force + i * columns, columns);
  return STRUT_OK;
}
