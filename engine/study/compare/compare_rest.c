/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Properties of a structure at rest: rigidity, forces, states, frequencies. */
#include <math.h>
#include <stdlib.h>

#include "engine/base/vec.h"
#include "engine/model/pose.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/rigid_motions.h"
#include "engine/statics/rigidity/equilibrium_matrix.h"
#include "engine/statics/rigidity/linear_matrices.h"
#include "engine/statics/rigidity/rigidity.h"
#include "engine/study/compare/compare_parts.h"

static void put_counts(strut_compare_work *work, const strut_rigidity *r) {
  const strut_mechanisms *m = &r->mechanisms;
  strut_compare_put(work, STRUT_COMPARE_SELF_STRESSES, r->states.count);
  strut_compare_put(work, STRUT_COMPARE_MECHANISMS, m->count - m->rigid_body);
  strut_compare_put(work, STRUT_COMPARE_FINITE, m->finite);
  strut_compare_put(work, STRUT_COMPARE_RIGID_MOTIONS, m->rigid_body);
}

static void put_forces(strut_compare_work *work, const strut_rigidity *r, size_t count) {
  double squares = 0.0, tension = 0.0, compression = 0.0;
  if (count == 0) {
    strut_compare_leave(work, STRUT_COMPARE_PRESTRESS, STRUT_COMPARE_COMPRESSION,
                        "there are no members");
    return;
  }
  for (size_t j = 0; j < count; j++) {
    squares += r->force[j] * r->force[j];
    tension = fmax(tension, r->force[j]);
    compression = fmax(compression, -r->force[j]);
  }
  strut_compare_put(work, STRUT_COMPARE_PRESTRESS, sqrt(squares / (double)count));
  strut_compare_put(work, STRUT_COMPARE_TENSION, tension);
  strut_compare_put(work, STRUT_COMPARE_COMPRESSION, compression);
}

/* Evaluates the drawn shape, as `strut rigidity` does. */
static strut_status evaluate_drawn(strut_compare_work *work, const strut_model *model) {
  strut_error error = {0};
  strut_arena scratch = {0};
  strut_rest_state drawn;
  strut_rigidity r = {0};
  strut_status status = strut_rest_state_find(model, &work->column->input->setup->experiment,
                                              "drawn", &scratch, &drawn, &error);
  if (status == STRUT_OK) status = strut_rigidity_find(model, drawn.q, &r, &error);
  if (status == STRUT_OK)
    put_counts(work, &r);
  else
    status = strut_compare_leave_failed(work, STRUT_COMPARE_SELF_STRESSES,
                                        STRUT_COMPARE_RIGID_MOTIONS, &error, status, true);
  strut_rigidity_free(&r);
  strut_arena_free(&scratch);
  return status;
}

strut_status strut_compare_rigidity(strut_compare_work *work, const strut_model *model) {
  strut_error error = {0};
  strut_rigidity r = {0};
  strut_status status = evaluate_drawn(work, model);
  if (status != STRUT_OK || !work->rest.q) return status;
  status = strut_rigidity_find(model, work->rest.q, &r, &error);
  if (status == STRUT_OK)
    put_forces(work, &r, model->scene->member_count);
  else
    status = strut_compare_leave_failed(work, STRUT_COMPARE_PRESTRESS, STRUT_COMPARE_COMPRESSION,
                                        &error, status, true);
  strut_rigidity_free(&r);
  return status;
}

/* ---- states ---- */

static int by_energy(const void *a, const void *b) {
  const strut_compare_state *x = a, *y = b;
  return (x->energy > y->energy) - (x->energy < y->energy);
}

static double rest_energy(const strut_equilibrium *e) {
  return e->rest ? e->rest_energy : e->energy;
}

static strut_status keep_states(strut_compare_work *work, const strut_equilibria *all) {
  strut_compare_column *c = work->column;
  c->states = strut_arena_allocate(work->arena, all->count + 1, sizeof *c->states);
  c->barriers = strut_arena_allocate(work->arena, all->barrier_count + 1, sizeof *c->barriers);
  const char **names = strut_arena_allocate(work->arena, all->count + 1, sizeof *names);
  if (!c->states || !c->barriers || !names) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < all->count; i++) {
    names[i] = strut_arena_format(work->arena, "%s", all->list[i].name);
    if (!names[i]) return STRUT_NO_MEMORY;
    if (all->list[i].outcome == STRUT_OUTCOME_STANDS)
      c->states[c->state_count++] = (strut_compare_state){names[i], rest_energy(&all->list[i])};
  }
  for (size_t i = 0; i < all->barrier_count; i++)
    c->barriers[c->barrier_count++] = (strut_compare_barrier){
        names[all->barriers[i].from], names[all->barriers[i].to], all->barriers[i].height};
  qsort(c->states, c->state_count, sizeof *c->states, by_energy);
  return STRUT_OK;
}

/* The name under which the list has the equilibrium that a run starts in, or NULL. */
static const char *start_name(const strut_compare_work *work, const strut_model *model,
                              const strut_equilibria *all) {
  const double *q = work->rest.q;
  if (!q) return NULL;
  for (size_t i = 0; i < all->count; i++) {
    const strut_equilibrium *e = &all->list[i];
    const double *p = e->rest ? e->rest : e->point.q;
    double shift = p[0] - q[0], apart = 0.0; /* along the ground it may lie anywhere */
    if (e->outcome != STRUT_OUTCOME_STANDS) continue;
    for (int32_t k = 0; k < 2 * model->node_count; k++)
      apart = fmax(apart,
                   fabs(p[k] - q[k] -
                        (k % 2 || !strut_contacts_allow_travel(&model->contacts) ? 0.0 : shift)));
    if (apart <= 1e-3 * model->size) return e->name;
  }
  return NULL;
}

static void put_barrier(strut_compare_work *work, const char *from, const strut_equilibria *all) {
  const strut_compare_quantity at = STRUT_COMPARE_LOWEST_BARRIER;
  double lowest = HUGE_VAL;
  for (size_t i = 0; from && i < all->barrier_count; i++)
    if (all->list[all->barriers[i].from].name == from)
      lowest = fmin(lowest, all->barriers[i].height);
  if (isfinite(lowest))
    strut_compare_put(work, at, lowest);
  else
    strut_compare_leave(
        work, at, at,
        from ? "no path to another state is known" : "the start is in none of the listed states");
}

static void put_states(strut_compare_work *work, const char *from, const strut_equilibria *all) {
  const strut_compare_column *c = work->column;
  strut_compare_put(work, STRUT_COMPARE_STATES, (double)c->state_count);
  if (c->state_count == 0) {
    const char *why = strut_arena_format(
        work->arena, "%s", all->remark[0] ? all->remark : "there is no state in which it stands");
    strut_compare_leave(work, STRUT_COMPARE_LOWEST_ENERGY, STRUT_COMPARE_LOWEST_BARRIER,
                        why ? why : "there is none");
    return;
  }
  double low = c->states[0].energy, high = c->states[c->state_count - 1].energy;
  strut_compare_put(work, STRUT_COMPARE_LOWEST_ENERGY, low);
  strut_compare_put(work, STRUT_COMPARE_ENERGY_SPAN, high - low);
  put_barrier(work, from, all);
}

strut_status strut_compare_states(strut_compare_work *work, const strut_model *model) {
  const strut_equilibria_options wanted = {.interrupt = work->options->interrupt};
  strut_error error = {0};
  strut_equilibria all = {0};
  if (work->options->no_states) {
    strut_compare_leave(work, STRUT_COMPARE_STATES, STRUT_COMPARE_LOWEST_BARRIER, "not requested");
    return STRUT_OK;
  }
  strut_status status =
      strut_equilibria_find(model, &work->column->input->setup->experiment, &wanted, &all, &error);
  if (status == STRUT_OK) {
    status = keep_states(work, &all);
    if (status == STRUT_OK) put_states(work, start_name(work, model, &all), &all);
  } else {
    status = strut_compare_leave_failed(work, STRUT_COMPARE_STATES, STRUT_COMPARE_LOWEST_BARRIER,
                                        &error, status, true);
  }
  strut_equilibria_free(&all);
  return status;
}

/* ---- frequencies ---- */

strut_status strut_compare_frequencies(strut_compare_work *work, const strut_model *model) {
  const strut_modes_options wanted = {.at = NULL};
  strut_error error = {0};
  strut_modes modes = {0};
  strut_status status =
      strut_modes_find(model, &work->column->input->setup->experiment, &wanted, &modes, &error);
  if (status == STRUT_OK) {
    int found = 0;
    strut_compare_leave(work, STRUT_COMPARE_FREQUENCY_1, STRUT_COMPARE_FREQUENCY_3,
                        "the model has fewer elastic modes");
    for (size_t i = 0; i < modes.count && found < STRUT_COMPARE_FREQUENCIES; i++)
      if (modes.list[i].kind == STRUT_MODE_ELASTIC)
        strut_compare_put(work, (strut_compare_quantity)(STRUT_COMPARE_FREQUENCY_1 + found++),
                          modes.list[i].angular_frequency / STRUT_TAU);
  } else {
    status = strut_compare_leave_failed(work, STRUT_COMPARE_FREQUENCY_1, STRUT_COMPARE_FREQUENCY_3,
                                        &error, status, false);
  }
  strut_modes_free(&modes);
  return status;
}

/* ---- stiffness of every node ---- */

enum { MOST = 1000 }; /* free coordinates: K is dense here */
static const double NOTHING = 1e-9, PIVOT = 1e-12;

typedef struct stiff {
  size_t n;
  double *k;     /* (n, n) K, then its Cholesky factor in the lower triangle */
  double *rigid; /* (rigid_count, n) orthonormal */
  int32_t rigid_count;
  double *load; /* (n) */
} stiff;

static void add_sparse(stiff *s, const strut_sparse *a) {
  for (int32_t j = 0; a && j < a->n; j++)
    for (int32_t at = a->start[j]; at < a->start[j + 1]; at++) {
      size_t r = (size_t)a->row[at], c = (size_t)j;
      s->k[r * s->n + c] += a->value[at];
      if (r != c) s->k[c * s->n + r] += a->value[at];
    }
}

/* Adds to K a contact stiffness along the ground, equal to that normal to it. */
static void hold_contacts(stiff *s, const strut_model *model, const double *q,
                          const int32_t *row_of) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t i = 0; i < c->count; i++) {
    uint32_t at = c->at[i];
    const strut_contact_pose pose = strut_contact_pose_at(c, i, q, NULL, -1);
    const double *t = pose.axes.tangent;
    if (!(pose.gap < 0)) continue;
    for (uint32_t a = 0; a < 2; a++)
      for (uint32_t b = 0; b < 2; b++)
        if (row_of[at + a] >= 0 && row_of[at + b] >= 0)
          s->k[(size_t)row_of[at + a] * s->n + (size_t)row_of[at + b]] +=
              c->entry[i].stiffness * t[a] * t[b];
  }
}

static double largest_diagonal(const stiff *s) {
  double largest = 0.0;
  for (size_t i = 0; i < s->n; i++) largest = fmax(largest, fabs(s->k[i * s->n + i]));
  return largest;
}

/* x' K y */
static double form(const stiff *s, const double *x, const double *y) {
  double sum = 0.0;
  for (size_t i = 0; i < s->n; i++)
    for (size_t j = 0; j < s->n; j++) sum += x[i] * s->k[i * s->n + j] * y[j];
  return sum;
}

/* Finds the rigid motions without stiffness in K, as combinations, and adds stiffness against them. */
static void lift_rigid(stiff *s) {
  double a[3][3] = {{0}}, value[3], vector[3][3], largest = largest_diagonal(s);
  int32_t count = s->rigid_count, kept = 0;
  for (int32_t i = 0; i < 3; i++)
    for (int32_t j = 0; j < 3; j++) {
      bool both = i < count && j < count;
      a[i][j] = both ? form(s, s->rigid + (size_t)i * s->n, s->rigid + (size_t)j * s->n)
                     : (i == j) * 2.0 * largest * (double)s->n; /* unused: sorted to the end */
    }
  strut_symmetric_3(a, value, vector);
  while (kept < count && fabs(value[kept]) <= NOTHING * largest) kept++;
  for (size_t i = 0; i < s->n; i++) {
    double r[3] = {0, 0, 0}, combined[3];
    for (int32_t m = 0; m < count; m++) r[m] = s->rigid[(size_t)m * s->n + i];
    for (int32_t m = 0; m < kept; m++)
      combined[m] = vector[m][0] * r[0] + vector[m][1] * r[1] + vector[m][2] * r[2];
    for (int32_t m = 0; m < kept; m++) s->rigid[(size_t)m * s->n + i] = combined[m];
  }
  s->rigid_count = kept;
  for (int32_t m = 0; m < kept; m++) {
    const double *x = s->rigid + (size_t)m * s->n;
    for (size_t i = 0; i < s->n; i++)
      for (size_t j = 0; j < s->n; j++) s->k[i * s->n + j] += largest * x[i] * x[j];
  }
}

/* False where K is not positive definite. */
static bool factorise(stiff *s) {
  for (size_t j = 0; j < s->n; j++) {
    double *row = s->k + j * s->n, before = row[j];
    for (size_t i = 0; i <= j; i++) {
      double *other = s->k + i * s->n, sum = row[i];
      for (size_t m = 0; m < i; m++) sum -= row[m] * other[m];
      if (i < j)
        row[i] = sum / other[i];
      else if (!(sum > PIVOT * before))
        return false;
      else
        row[j] = sqrt(sum);
    }
  }
  return true;
}

/* Stiffness of coordinate `at` under a unit load there. */
static double stiffness_of(stiff *s, size_t at) {
  double compliance = 0.0;
  for (size_t i = 0; i < s->n; i++) s->load[i] = i == at ? 1.0 : 0.0;
  for (int32_t m = 0; m < s->rigid_count; m++) {
    const double *x = s->rigid + (size_t)m * s->n;
    for (size_t i = 0; i < s->n; i++) s->load[i] -= x[at] * x[i];
  }
  for (size_t i = 0; i < s->n; i++) { /* |L^-1 e|^2 = e' K^-1 e */
    const double *row = s->k + i * s->n;
    double sum = s->load[i];
    for (size_t m = 0; m < i; m++) sum -= row[m] * s->load[m];
    s->load[i] = sum / row[i];
    compliance += s->load[i] * s->load[i];
  }
  return compliance > 0.0 ? 1.0 / compliance : (double)NAN;
}

static void put_softest(strut_compare_work *work, const strut_model *model) {
  strut_compare_column *c = work->column;
  for (int d = 0; d < 2; d++) {
    const strut_compare_quantity at = d ? STRUT_COMPARE_STIFFNESS_Y : STRUT_COMPARE_STIFFNESS_X;
    for (int32_t i = 0; i < model->node_count; i++) {
      bool softer = c->softest[d] < 0 || c->stiffness[i][d] < c->stiffness[c->softest[d]][d];
      if (isfinite(c->stiffness[i][d]) && softer) c->softest[d] = i;
    }
    if (c->softest[d] >= 0)
      strut_compare_put(work, at, c->stiffness[c->softest[d]][d]);
    else
      strut_compare_leave(work, at, at, "no node can move in that direction");
  }
}

static strut_status measure(strut_compare_work *work, const strut_model *model,
                            const strut_potential *potential, stiff *s) {
  strut_compare_column *c = work->column;
  size_t nodes = (size_t)model->node_count;
  c->stiffness = strut_arena_allocate(work->arena, nodes, sizeof *c->stiffness);
  if (!c->stiffness) return STRUT_NO_MEMORY;
  s->rigid_count = strut_rigid_motions(potential, work->rest.q, s->rigid);
  lift_rigid(s);
  if (!factorise(s)) {
    c->stiffness = NULL;
    strut_compare_leave(work, STRUT_COMPARE_STIFFNESS_X, STRUT_COMPARE_STIFFNESS_Y,
                        "a motion has no stiffness");
    return STRUT_OK;
  }
  for (size_t i = 0; i < nodes; i++)
    for (size_t d = 0; d < 2; d++) {
      int32_t row = potential->row_of[2 * i + d];
      c->stiffness[i][d] = row < 0 ? (double)NAN : stiffness_of(s, (size_t)row);
    }
  put_softest(work, model);
  return STRUT_OK;
}

strut_status strut_compare_stiffness(strut_compare_work *work, const strut_model *model) {
  strut_arena scratch = {0};
  strut_potential *potential = NULL;
  strut_linear_matrices matrices;
  strut_error error = {0};
  strut_status status = strut_potential_create(model, NULL, true, &potential, &error);
  stiff s = {.n = status == STRUT_OK ? (size_t)potential->n : 0};
  if (status == STRUT_OK && (s.n == 0 || s.n > MOST)) {
    strut_compare_leave(work, STRUT_COMPARE_STIFFNESS_X, STRUT_COMPARE_STIFFNESS_Y,
                        s.n ? "more than 1000 free coordinates" : "nothing can move");
  } else if (status == STRUT_OK) {
    s.k = strut_arena_allocate(&scratch, s.n * s.n, sizeof *s.k);
    s.rigid = strut_arena_allocate(&scratch, 3 * s.n, sizeof *s.rigid);
    s.load = strut_arena_allocate(&scratch, s.n, sizeof *s.load);
    status = s.k && s.rigid && s.load
                 ? strut_linear_matrices_build(model, work->rest.q, &scratch, &matrices)
                 : STRUT_NO_MEMORY;
    if (status == STRUT_OK) {
      add_sparse(&s, matrices.elastic);
      add_sparse(&s, matrices.geometric);
      add_sparse(&s, matrices.contact);
      hold_contacts(&s, model, work->rest.q, potential->row_of);
      status = measure(work, model, potential, &s);
    }
  }
  strut_potential_free(potential);
  strut_arena_free(&scratch);
  return status;
}
