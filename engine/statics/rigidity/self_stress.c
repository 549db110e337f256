/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/statics/rigidity/rigidity.h"

#include "engine/base/vec.h"
#include "engine/statics/algebra.h"

static const double TINY = 1e-11;      /* beside the largest force: rounding */
static const double PIVOT_SHARE = 0.1; /* of the largest entry: what a pivot must have */
static const double MOST_WORK = 4e8;   /* multiplications spent on locality */
static const double LEADS = 0.01;      /* of the largest: what a force made 1 must have */

/*
 * Reduced echelon form, members from `shift` on: 1 at its own pivot, 0 at the others. `peak` has room for
 * the peaks of the rows.
 */
static void reduce_echelon(double *rows, size_t count, size_t columns, size_t shift, double *peak) {
  size_t done = 0;
  for (size_t i = 0; i < count; i++)
    peak[i] = strut_largest_magnitude(rows + i * columns, (ptrdiff_t)columns);
  for (size_t c = 0; c < columns && done < count; c++) {
    size_t j = (c + shift) % columns, best = done;
    double largest = 0.0;
    for (size_t i = done; i < count; i++) {
      if (fabs(rows[i * columns + j]) > fabs(rows[best * columns + j])) best = i;
      largest = fmax(largest, peak[i]);
    }
    double pivot = rows[best * columns + j];
    bool last = columns - c <= count - done; /* no choice left */
    if (fabs(pivot) <= (last ? TINY : PIVOT_SHARE) * largest || pivot == 0.0) continue;
    for (size_t k = 0; k < columns; k++) {
      double swap = rows[best * columns + k];
      rows[best * columns + k] = rows[done * columns + k];
      rows[done * columns + k] = swap / pivot;
    }
    peak[best] = peak[done]; /* of the rows that are done no peak is asked for */
    for (size_t i = 0; i < count; i++) {
      double factor = rows[i * columns + j];
      if (i == done || factor == 0.0) continue;
      for (size_t k = 0; k < columns; k++)
        rows[i * columns + k] -= factor * rows[done * columns + k];
      rows[i * columns + j] = 0.0;
      if (i > done) peak[i] = strut_largest_magnitude(rows + i * columns, (ptrdiff_t)columns);
    }
    done++;
  }
}

static void drop_rounding(double *row, size_t columns) {
  double largest = strut_largest_magnitude(row, (ptrdiff_t)columns);
  for (size_t k = 0; k < columns; k++)
    if (fabs(row[k]) <= TINY * largest) row[k] = 0.0;
}

static size_t count_members(const double *row, size_t columns) {
  size_t count = 0;
  for (size_t k = 0; k < columns; k++) count += row[k] != 0.0;
  return count;
}

/*
 * Orthogonalises a candidate against the `count` rows chosen and appends it; false if nothing is
 * left.
 */
static bool add_if_independent(double *chosen, size_t count, size_t columns, const double *row) {
  double *rest = chosen + count * columns, before = strut_dot(row, row, (ptrdiff_t)columns);
  memcpy(rest, row, columns * sizeof *rest);
  double after = strut_remove_shares(chosen, count, columns, rest);
  if (after <= 1e-8 * before) return false;
  for (size_t k = 0; k < columns; k++) rest[k] /= sqrt(after);
  return true;
}

typedef struct candidate {
  size_t members, number;
  const double *row;
} candidate;

static int compare_member_counts(const void *first, const void *second) {
  const candidate *self = first, *y = second;
  if (self->members != y->members) return self->members < y->members ? -1 : 1;
  return self->number < y->number ? -1 : self->number > y->number;
}

/* Echelon forms from every member on; the states of fewest members that are add_if_independent. */
static bool choose_local(const double *basis, size_t count, size_t columns, size_t orders,
                         strut_arena *scratch, double *result) {
  size_t total = count * orders, size = count * columns, kept = 0;
  double *rows = strut_arena_allocate(scratch, total * columns, sizeof *rows);
  double *chosen = strut_arena_allocate(scratch, (count + 1) * columns, sizeof *chosen);
  candidate *list = strut_arena_allocate(scratch, total, sizeof *list);
  double *peak = strut_arena_allocate(scratch, count, sizeof *peak);
  if (!rows || !chosen || !list || !peak) return false;
  for (size_t o = 0; o < orders; o++) {
    memcpy(rows + o * size, basis, size * sizeof *rows);
    reduce_echelon(rows + o * size, count, columns, o * columns / orders, peak);
  }
  for (size_t i = 0; i < total; i++) {
    double *row = rows + i * columns;
    drop_rounding(row, columns);
    list[i] = (candidate){.members = count_members(row, columns), .number = i, .row = row};
  }
  qsort(list, total, sizeof *list, compare_member_counts);
  for (size_t i = 0; i < total && kept < count; i++) {
    if (!add_if_independent(chosen, kept, columns, list[i].row)) continue;
    memcpy(result + kept++ * columns, list[i].row, columns * sizeof *result);
  }
  return true;
}

/* The member whose force is made 1. */
static size_t unit_member(const strut_model *model, const double *force, size_t columns) {
  static const strut_member_kind order[] = {STRUT_CABLE, STRUT_SPRING, STRUT_BAR};
  double largest = strut_largest_magnitude(force, (ptrdiff_t)columns);
  for (int i = 0; i < 3; i++)
    for (size_t j = 0; j < model->scene->member_count; j++)
      if (model->scene->members[j].kind == order[i] && fabs(force[j]) > LEADS * largest) return j;
  for (size_t j = model->scene->member_count; j < columns; j++) /* hinges alone */
    if (fabs(force[j]) > LEADS * largest) return j;
  return 0;
}

static void count_cables(const strut_model *model, const double *force, size_t columns,
                         size_t *pulled, size_t *pressed) {
  *pulled = *pressed = 0;
  for (size_t j = 0; j < columns; j++) {
    if (!strut_column_is_cable(model, (int32_t)j)) continue;
    *pulled += force[j] > 0;
    *pressed += force[j] < 0;
  }
}

static bool scale_to_unit(const strut_model *model, double *force, size_t columns) {
  size_t pulled, pressed;
  double unit = force[unit_member(model, force, columns)];
  for (size_t j = 0; j < columns && unit != 0.0; j++) force[j] = force[j] / unit + 0.0; /* no -0 */
  count_cables(model, force, columns, &pulled, &pressed);
  return pressed == 0;
}

strut_status strut_self_stress_sort(const strut_model *model, const strut_null_spaces *spaces,
                                    strut_arena *arena, strut_self_stress *states) {
  *states = (strut_self_stress){.count = spaces->states};
  if (spaces->states == 0 || !spaces->state) return STRUT_OK;
  size_t count = (size_t)spaces->states, columns = (size_t)strut_equilibrium_columns(model);
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
    states->cables_pull[i] = scale_to_unit(model, states->force + i * columns, columns);
  return STRUT_OK;
}

/* Combinations of states of self-stress that pull all cables or stiffen all mechanisms. */

enum { MOST_ROUNDS = 20000, MOST_FORM_ROUNDS = 2000 };

/* A force or eigenvalue above this share of the largest counts as positive. */
static const double MARGIN = 1e-7;

typedef struct search {
  const strut_model *model;
  const strut_self_stress *states;
  const strut_stress_wish *wish;
  size_t states_count, members, motions; /* members: and hinges */
  double *weight;                        /* (states) the combination */
  double *pull;  /* (states) a demand's coefficients: it wants weight . pull > 0 */
  double *cable; /* (members) norm of a member's coefficients, 0 where nothing is asked of it */
  double *form, *value, *vector; /* (motions, motions), (motions), (motions, motions) */
} search;

/*
 * force (members) becomes the states' combination by weight (states), scaled to a largest force of
 * 1.
 */
static void combine_states(const strut_self_stress *states, size_t members, const double *weight,
                           double *force) {
  memset(force, 0, members * sizeof *force);
  for (size_t i = 0; i < (size_t)states->count; i++)
    for (size_t j = 0; j < members; j++) force[j] += weight[i] * states->force[i * members + j];
  double largest = strut_largest_magnitude(force, (ptrdiff_t)members);
  for (size_t j = 0; j < members && largest > 0; j++) force[j] /= largest;
}

static bool allocate(search *self, strut_arena *scratch) {
  size_t motions = self->motions;
  return STRUT_NUMBERS(scratch, self->states_count, &self->weight, &self->pull) &&
         STRUT_NUMBERS(scratch, self->members, &self->cable) &&
         STRUT_NUMBERS(scratch, motions, &self->value) &&
         STRUT_NUMBERS(scratch, motions * motions, &self->form, &self->vector);
}

static void measure_cables(search *self) {
  for (size_t j = 0; j < self->members; j++) {
    if (!self->wish->cables || !strut_column_is_cable(self->model, (int32_t)j)) continue;
    for (size_t i = 0; i < self->states_count; i++) {
      double t = self->states->force[i * self->members + j];
      self->cable[j] += t * t;
    }
    self->cable[j] = sqrt(self->cable[j]);
  }
}

static double norm(const double *vector, size_t n) {
  return sqrt(strut_dot(vector, vector, (ptrdiff_t)n));
}

/* The demand of the cable that is pressed most, relative to its coefficients; false: none is. */
static bool demand_of_worst_cable(search *self) {
  double worst = MARGIN * norm(self->weight, self->states_count);
  size_t at = self->members;
  for (size_t j = 0; j < self->members; j++) {
    if (self->cable[j] == 0.0) continue;
    double force = 0.0;
    for (size_t i = 0; i < self->states_count; i++)
      force += self->weight[i] * self->states->force[i * self->members + j];
    if (force / self->cable[j] > worst) continue;
    worst = force / self->cable[j];
    at = j;
  }
  if (at == self->members) return false;
  for (size_t i = 0; i < self->states_count; i++)
    self->pull[i] = self->states->force[i * self->members + at] / self->cable[at];
  return true;
}

static void set_pull_of_forms(search *self, const double *v) {
  size_t m = self->motions;
  for (size_t i = 0; i < self->states_count; i++) {
    const double *form = self->wish->forms + i * m * m;
    self->pull[i] = 0.0;
    for (size_t r = 0; r < m; r++)
      for (size_t c = 0; c < m; c++) self->pull[i] += v[r] * form[r * m + c] * v[c];
  }
  double size = norm(self->pull, self->states_count);
  for (size_t i = 0; i < self->states_count && size > 0; i++) self->pull[i] /= size;
}

/* The demand of the softest motion; *failed: it has none, so that nothing helps. */
static bool demand_of_softest_motion(search *self, bool *failed) {
  size_t m = self->motions;
  if (m == 0) return false;
  memset(self->form, 0, m * m * sizeof *self->form);
  for (size_t i = 0; i < self->states_count; i++)
    for (size_t k = 0; k < m * m; k++)
      self->form[k] += self->weight[i] * self->wish->forms[i * m * m + k];
  if (!strut_symmetric_eigen(self->form, m, self->value, self->vector)) {
    *failed = true;
    return true;
  }
  double scale = 0.0;
  for (size_t i = 0; i < self->states_count; i++)
    scale += fabs(self->weight[i]) * self->wish->scale[i];
  if (self->value[0] > MARGIN * scale) return false;
  set_pull_of_forms(self, self->vector);
  *failed = norm(self->pull, self->states_count) == 0.0;
  return true;
}

static bool find_combination(search *self) {
  bool failed = false;
  int most = self->motions > 0 ? MOST_FORM_ROUNDS : MOST_ROUNDS;
  /* start from the states that pull cables by themselves */
  for (size_t i = 0; i < self->states_count; i++)
    self->weight[i] = self->states->cables_pull[i] ? 1 : 0.1;
  for (int round = 0; round < most && !failed; round++) {
    if (!demand_of_worst_cable(self) && !demand_of_softest_motion(self, &failed)) return true;
    for (size_t i = 0; i < self->states_count; i++) self->weight[i] += self->pull[i];
  }
  return false;
}

strut_status strut_self_stress_combine(const strut_model *model, const strut_self_stress *states,
                                       const strut_stress_wish *wish, double *force, bool *found) {
  *found = false;
  if (states->count == 0 || !states->force) return STRUT_OK;
  strut_arena scratch = {0};
  search s = {.model = model, .states = states, .wish = wish};
  s.states_count = (size_t)states->count, s.members = (size_t)strut_equilibrium_columns(model);
  s.motions = (size_t)wish->motions;
  bool good = allocate(&s, &scratch);
  if (good) {
    measure_cables(&s);
    *found = find_combination(&s);
    if (*found) combine_states(states, s.members, s.weight, force);
  }
  strut_arena_free(&scratch);
  return good ? STRUT_OK : STRUT_NO_MEMORY;
}

/* Can some self-stress pull every cable? A linear programme answers, either way. */

typedef struct cables {
  const strut_self_stress *states;
  size_t members; /* and hinges */
  int32_t count;
  int32_t *member; /* (count) cables that some state loads */
} cables;

static double force_of(const cables *self, int32_t state, int32_t member) {
  return self->states->force[(size_t)state * self->members + (size_t)member];
}

static bool list_cables(const strut_model *model, cables *self, strut_arena *scratch) {
  if (!STRUT_ALLOCATE(scratch, STRUT_NEW(self->member, self->members + 1))) return false;
  for (int32_t j = 0; j < model->members.count; j++) {
    bool loaded = false;
    for (int32_t i = 0; i < self->states->count; i++) loaded |= force_of(self, i, j) != 0.0;
    if (loaded && model->scene->members[j].kind == STRUT_CABLE) self->member[self->count++] = j;
  }
  return true;
}

/* A column for each state, a row for each cable: its force is at least 1. */
static bool build_program(const cables *self, strut_linear_program *program, strut_arena *scratch) {
  size_t entries = (size_t)self->count * (size_t)self->states->count;
  if (!strut_linear_program_create(program, self->count, self->states->count, entries, scratch))
    return false;
  for (int32_t i = 0; i < self->states->count; i++) program->low[i] = -HUGE_VAL;
  for (int32_t r = 0; r < self->count; r++) {
    program->row_low[r] = 1.0;
    program->row_high[r] = HUGE_VAL;
    for (int32_t i = 0; i < self->states->count; i++) {
      double force = force_of(self, i, self->member[r]);
      program->cost[i] += force;
      strut_linear_program_add(program, r, i, force);
    }
  }
  return true;
}

strut_status strut_self_stress_pull_cables(const strut_model *model,
                                           const strut_self_stress *states, double *force,
                                           bool *found) {
  *found = false;
  if (states->count == 0 || !states->force) return STRUT_OK;
  strut_arena scratch = {0};
  cables c = {.states = states, .members = (size_t)strut_equilibrium_columns(model)};
  strut_linear_program program = {0};
  strut_linear_program_end end = STRUT_PROGRAM_FAILED;
  double sum = 0.0;
  strut_status status = STRUT_NO_MEMORY;
  double *weight = strut_arena_allocate(&scratch, (size_t)states->count, sizeof *weight);
  if (weight && list_cables(model, &c, &scratch)) {
    status = STRUT_OK;
    if (c.count > 0)
      status = build_program(&c, &program, &scratch)
                   ? strut_linear_program_solve(&program, weight, &sum, &end)
                   : STRUT_NO_MEMORY;
    *found = status == STRUT_OK && end == STRUT_PROGRAM_OPTIMAL;
    if (*found) combine_states(states, c.members, weight, force);
  }
  strut_arena_free(&scratch);
  return status;
}
