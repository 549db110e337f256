/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Can some self-stress pull every cable? A linear programme answers, either way. */
#include <math.h>
#include <string.h>

#include "engine/statics/linear_program.h"
#include "engine/statics/rigidity/self_stress.h"

typedef struct cables {
  const strut_self_stress *states;
  size_t members;
  int32_t count;
  int32_t *member; /* (count) cables that some state loads */
} cables;

static double force_of(const cables *c, int32_t state, int32_t member) {
  return c->states->force[(size_t)state * c->members + (size_t)member];
}

static bool list_cables(const strut_model *model, cables *c, strut_arena *scratch) {
  c->member = strut_arena_allocate(scratch, c->members + 1, sizeof *c->member);
  if (!c->member) return false;
  for (int32_t j = 0; j < model->members.count; j++) {
    bool loaded = false;
    for (int32_t i = 0; i < c->states->count; i++) loaded |= force_of(c, i, j) != 0.0;
    if (loaded && model->scene->members[j].kind == STRUT_CABLE) c->member[c->count++] = j;
  }
  return true;
}

/* A column for each state, a row for each cable: its force is at least 1. */
static bool pose(const cables *c, strut_linear_program *program, strut_arena *scratch) {
  size_t entries = (size_t)c->count * (size_t)c->states->count;
  if (!strut_linear_program_create(program, c->count, c->states->count, entries, scratch))
    return false;
  for (int32_t i = 0; i < c->states->count; i++) program->low[i] = -HUGE_VAL;
  for (int32_t r = 0; r < c->count; r++) {
    program->row_low[r] = 1.0;
    program->row_high[r] = HUGE_VAL;
    for (int32_t i = 0; i < c->states->count; i++) {
      double force = force_of(c, i, c->member[r]);
      program->cost[i] += force;
      strut_linear_program_add(program, r, i, force);
    }
  }
  return true;
}

static void combine(const cables *c, const double *weight, double *force) {
  double largest = 0.0;
  memset(force, 0, c->members * sizeof *force);
  for (int32_t i = 0; i < c->states->count; i++)
    for (size_t j = 0; j < c->members; j++) force[j] += weight[i] * force_of(c, i, (int32_t)j);
  for (size_t j = 0; j < c->members; j++) largest = fmax(largest, fabs(force[j]));
  for (size_t j = 0; j < c->members && largest > 0; j++) force[j] /= largest;
}

strut_status strut_self_stress_pull_cables(const strut_model *model,
                                           const strut_self_stress *states, double *force,
                                           bool *found) {
  *found = false;
  if (states->count == 0 || !states->force) return STRUT_OK;
  strut_arena scratch = {0};
  cables c = {.states = states, .members = (size_t)model->members.count};
  strut_linear_program program = {0};
  strut_quantity_program_end end = STRUT_PROGRAM_FAILED;
  double sum = 0.0;
  strut_status status = STRUT_NO_MEMORY;
  double *weight = strut_arena_allocate(&scratch, (size_t)states->count, sizeof *weight);
  if (weight && list_cables(model, &c, &scratch)) {
    status = STRUT_OK;
    if (c.count > 0)
      status = pose(&c, &program, &scratch)
                   ? strut_linear_program_solve(&program, weight, &sum, &end)
                   : STRUT_NO_MEMORY;
    *found = status == STRUT_OK && end == STRUT_PROGRAM_OPTIMAL;
    if (*found) combine(&c, weight, force);
  }
  strut_arena_free(&scratch);
  return status;
}
