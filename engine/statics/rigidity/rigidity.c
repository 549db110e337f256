/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/rigidity.h"

#include <math.h>
#include <string.h>

#include "engine/model/pose.h"
#include "engine/statics/rigidity/tensegrity.h"

static bool measure_forces(const strut_model *model, strut_rigidity *r) {
  const strut_member_table *t = &model->members;
  r->force = strut_arena_allocate(&r->arena, (size_t)t->count + 1, sizeof *r->force);
  r->density = strut_arena_allocate(&r->arena, (size_t)t->count + 1, sizeof *r->density);
  if (!r->force || !r->density) return false;
  for (int32_t j = 0; j < t->count; j++) {
    double length = r->matrix.length[j], force = t->stiffness[j] * (length - t->rest[j]);
    r->force[j] = fmax(force, t->slack[j]) + 0.0; /* + 0.0: no -0 */
    if (length > 0)
      r->density[j] = r->force[j] / length;
    else
      r->without_length++;
    r->largest_force = fmax(r->largest_force, fabs(r->force[j]));
    if (model->scene->members[j].kind == STRUT_CABLE) r->has_cables = true;
  }
  return true;
}

/* Adds what acts beside the members; also to the scale of balance. */
static void add_outer_forces(const strut_model *model, const double *q, double *net,
                             double *scale) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t at = 0; at < 2 * model->node_count && model->constant_force; at++) {
    net[at] += model->constant_force[at];
    *scale = fmax(*scale, fabs(model->constant_force[at]));
  }
  for (int32_t i = 0; i < c->count; i++) {
    double gap = strut_contact_gap(c, i, q);
    if (!(gap < 0)) continue;
    for (int k = 0; k < 2; k++)
      net[c->at[i] + (uint32_t)k] -= c->entry[i].stiffness * gap * c->normal[k];
  }
}

static double largest_free(const strut_equilibrium_matrix *a, const double *net) {
  double largest = 0.0;
  for (int32_t row = 0; row < a->rows; row++)
    largest = fmax(largest, fabs(net[a->coordinate[row]]));
  return largest;
}

static bool measure_balance(const strut_model *model, const double *q, strut_rigidity *r) {
  const strut_equilibrium_matrix *a = &r->matrix;
  strut_arena scratch = {0};
  double *net = strut_arena_allocate(&scratch, (size_t)model->length, sizeof *net);
  double *held = strut_arena_allocate(&scratch, (size_t)a->rows + 1, sizeof *held);
  bool good = net && held;
  if (good) {
    double members = r->largest_force;
    strut_equilibrium_multiply(a, r->force, held);
    for (int32_t row = 0; row < a->rows; row++) net[a->coordinate[row]] = -held[row];
    r->prestressed = members > 0;
    r->self_equilibrium =
        r->prestressed && largest_free(a, net) <= STRUT_BALANCE_TOLERANCE * members;
    add_outer_forces(model, q, net, &r->largest_force);
    r->residual = largest_free(a, net);
    r->equilibrium = r->residual <= STRUT_BALANCE_TOLERANCE * r->largest_force;
  }
  strut_arena_free(&scratch);
  return good;
}

static bool count_bars(const strut_model *model, strut_rigidity *r) {
  int32_t *bars = strut_allocate((size_t)model->node_count + 1, sizeof *bars);
  if (!bars) return false;
  for (int32_t j = 0; j < model->members.count; j++) {
    if (model->scene->members[j].kind != STRUT_BAR) continue;
    uint32_t end[2] = {model->members.from[j] / 2, model->members.to[j] / 2};
    for (int k = 0; k < 2; k++)
      if (++bars[end[k]] > r->bars_at_node) r->bars_at_node = bars[end[k]];
  }
  strut_release(bars);
  return true;
}

static strut_status pull_cables(const strut_model *model, strut_rigidity *r) {
  if (!r->states.force) return STRUT_OK;
  double *force = strut_arena_allocate(&r->arena, (size_t)r->matrix.columns, sizeof *force);
  if (!force) return STRUT_NO_MEMORY;
  if (r->states.count == 1) { /* it has been turned so that cables pull, if they can */
    memcpy(force, r->states.force, (size_t)r->matrix.columns * sizeof *force);
    r->cables_can_pull = r->states.cables_pull[0];
  } else {
    strut_status status =
        strut_self_stress_pull_cables(model, &r->states, force, &r->cables_can_pull);
    if (status != STRUT_OK) return status;
  }
  if (r->cables_can_pull) r->feasible = force;
  return STRUT_OK;
}

static void choose_stress(strut_rigidity *r) {
  r->source = STRUT_STRESS_NONE;
  if (!r->states.force) return;
  if (r->states.count == 1) {
    r->source = STRUT_STRESS_STATE;
    r->judged = r->states.force;
  } else if (r->self_equilibrium) {
    r->source = STRUT_STRESS_SHAPE;
    r->judged = r->force;
  } else if (r->feasible) {
    r->source = STRUT_STRESS_COMBINATION;
    r->judged = r->feasible;
  } else {
    r->source = STRUT_STRESS_FIRST;
    r->judged = r->states.force;
  }
}

/* A pressed cable spoils super stability, whatever the matrix says. */
static void respect_cables(const strut_model *model, strut_rigidity *r) {
  double largest = 0.0;
  for (int32_t j = 0; j < r->matrix.columns; j++) largest = fmax(largest, fabs(r->judged[j]));
  for (int32_t j = 0; j < r->matrix.columns; j++)
    if (model->scene->members[j].kind == STRUT_CABLE && r->judged[j] < -1e-9 * largest)
      r->stress.super_stable = false;
}

static strut_status find_all(const strut_model *model, const double *q, strut_rigidity *r,
                             strut_error *error) {
  strut_status status = strut_equilibrium_matrix_build(model, q, &r->arena, &r->matrix);
  if (status != STRUT_OK) return status;
  if (!measure_forces(model, r) || !measure_balance(model, q, r) || !count_bars(model, r))
    return STRUT_NO_MEMORY;
  status = strut_null_spaces_find(&r->matrix, &r->arena, &r->spaces, error);
  if (status == STRUT_OK) status = strut_self_stress_sort(model, &r->spaces, &r->arena, &r->states);
  if (status == STRUT_OK) status = pull_cables(model, r);
  if (status != STRUT_OK) return status;
  const double *force = r->prestressed && r->equilibrium ? r->force : NULL;
  status = strut_mechanisms_find(model, &r->matrix, q, &r->spaces, &r->states, force, &r->arena,
                                 &r->mechanisms);
  choose_stress(r);
  if (status == STRUT_OK && r->judged) {
    status = strut_stress_matrix_judge(model, &r->matrix, r->judged, &r->arena, &r->stress);
    respect_cables(model, r);
  }
  return status == STRUT_OK ? strut_tensegrity_judge(model, q, r) : status;
}

strut_status strut_rigidity_find(const strut_model *model, const double *q,
                                 strut_rigidity *rigidity, strut_error *error) {
  *rigidity = (strut_rigidity){0};
  strut_status status = find_all(model, q, rigidity, error);
  if (status == STRUT_NO_MEMORY) strut_fail(error, status, "out of memory");
  return status;
}

void strut_rigidity_free(strut_rigidity *rigidity) {
  strut_arena_free(&rigidity->arena);
  *rigidity = (strut_rigidity){0};
}
