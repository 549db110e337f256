/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/equilibria/relax.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/energy.h"
#include "engine/forces/forces.h"
#include "engine/integrate/integrator.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/model/pose.h"
#include "engine/statics/search/critical.h"

/* Simulated steps between two checks of the energy; they grow while nothing is decided. */
static const int64_t FIRST_LOOK = 128, LAST_LOOK = 8192;
/* Steps after which it counts as moving on, however short they are beside initial.settle.limit. */
static const int64_t MOST_STEPS = 10000000;
/* Quenches in a row that end in one place, and the share of the first excess energy still there. */
enum { AGREE = 5 };
static const double DIED = 1e-3;
/* Distances, in model sizes: two shapes are one; the structure has moved away. */
static const double SAME = 1e-5, GONE = 1e3;
/* The share of the stable step; folded shapes are stiffer than the start that the limit is for. */
static const double CAREFUL = 0.5;
static const double GROWN = 1e-6;
enum { HALVINGS = 6 };

struct strut_relaxer {
  double limit; /* [s] */
  const strut_potential *potential;
  const strut_model *model;
  strut_minimiser *minimiser;
  strut_state *state; /* NULL: not simulated */
  const strut_integrator *method;
  void *workspace;
  double step;
  double *quenched, *last; /* (length) the minimum below the present shape, and the one before */
  double *start;           /* (length) */
  strut_arena arena;
};

static bool loses_energy(const strut_model *model) {
  if (model->mass_damping > 0) return true;
  for (int32_t j = 0; j < model->members.count; j++)
    if (model->members.damping[j] > 0) return true;
  for (int32_t i = 0; i < model->elements.count; i++)
    if (model->elements.element[i].damping > 0) return true;
  for (int32_t i = 0; i < model->contacts.count; i++)
    if (model->contacts.entry[i].damping > 0) return true;
  return false;
}

/* Creates state and integrator, unless the model cannot be simulated. */
static strut_status prepare_motion(strut_relaxer *r, strut_error *error) {
  strut_step_limit limit;
  if (!r->model->mass || !loses_energy(r->model) || r->potential->n > STRUT_DENSE_STATICS)
    return STRUT_OK;
  strut_status status = strut_step_limit_estimate(r->model, &limit, error);
  if (status) return status;
  if (!isfinite(limit.limit)) return STRUT_OK;
  r->step = CAREFUL * limit.limit;
  r->method = strut_integrator_for(STRUT_ROLE_PLAIN);
  if ((status = strut_state_create(r->model, &r->state, error))) return status;
  const strut_integrator_settings settings = {.step = r->step};
  r->workspace = r->method->create(r->model, r->state, &settings);
  return r->workspace ? STRUT_OK : strut_no_memory(error, "");
}

strut_status strut_relaxer_create(const strut_potential *potential, double limit,
                                  strut_relaxer **result, strut_error *error) {
  assert(limit > 0.0);
  strut_relaxer *r = *result = strut_allocate(1, sizeof *r);
  if (!r) return strut_no_memory(error, "");
  size_t length = (size_t)potential->model->length;
  r->potential = potential;
  r->limit = limit;
  r->model = potential->model;
  r->quenched = strut_arena_allocate(&r->arena, length, sizeof(double));
  r->last = strut_arena_allocate(&r->arena, length, sizeof(double));
  r->start = strut_arena_allocate(&r->arena, length, sizeof(double));
  strut_status status = r->quenched && r->last && r->start
                            ? strut_minimiser_create(potential, &r->minimiser, error)
                            : strut_no_memory(error, "");
  if (!status) status = prepare_motion(r, error);
  if (status) {
    strut_relaxer_free(r);
    *result = NULL;
  }
  return status;
}

void strut_relaxer_free(strut_relaxer *r) {
  if (!r) return;
  strut_state_free(r->state);
  strut_minimiser_free(r->minimiser);
  strut_arena_free(&r->arena);
  strut_release(r);
}

bool strut_relaxer_simulates(const strut_relaxer *r) { return r->state != NULL; }

strut_descent strut_relaxer_quench(strut_relaxer *r, double *q) {
  return strut_minimise(r->minimiser, q, 0.0);
}

static bool free_along_x(const strut_model *model) {
  if (model->contacts.count && !strut_contacts_are_level(&model->contacts)) return false;
  for (int32_t i = 0; i < model->node_count; i++)
    if (model->fixed[2 * i]) return false;
  return true;
}

static double centre_x(const strut_model *model, const double *q) {
  double sum = 0.0, all = 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    sum += model->weight[i] * q[2 * i];
    all += model->weight[i];
  }
  return all > 0 ? sum / all : 0.0;
}

/* No force acts along the ground, so the centre of mass stays; Newton's method knows no masses. */
static void restore_centre(const strut_model *model, double x, double *q) {
  if (!free_along_x(model)) return;
  double back = x - centre_x(model, q);
  for (int32_t i = 0; i < model->node_count; i++) q[2 * i] += back;
}

static double total_energy(const strut_relaxer *r) {
  return strut_potential_value(r->potential, r->state->q) +
         strut_energy_kinetic(r->model, r->state->v);
}

static bool has_escaped(const strut_model *model, const double *start, const double *q) {
  double bound = GONE * (model->size > 0 ? model->size : 1.0);
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    if (!(fabs(q[i] - start[i]) <= bound)) return true;
  return false;
}

/* Evidence that the minimum below the present shape is the only one left within reach. */
typedef struct verdict {
  double excess; /* at the first look [J] */
  int agreed;
} verdict;

static bool is_decided(strut_relaxer *r, double energy, const double *q, strut_pass_of passes,
                       const void *context, verdict *v) {
  size_t bytes = (size_t)r->model->length * sizeof(double);
  memcpy(r->quenched, q, bytes);
  strut_descent descent = strut_relaxer_quench(r, r->quenched);
  if (descent.end != STRUT_DESCENT_REACHED) {
    v->agreed = 0;
    return false;
  }
  if (passes && energy < passes(context, r->quenched)) return true;
  double excess = energy - strut_potential_value(r->potential, r->quenched);
  if (v->excess < 0) v->excess = excess;
  bool same = v->agreed && strut_shape_distance(r->model, r->last, r->quenched, false, NULL) <
                               SAME * r->model->size;
  v->agreed = same ? v->agreed + 1 : 1;
  memcpy(r->last, r->quenched, bytes);
  return v->agreed >= AGREE && excess <= DIED * v->excess;
}

typedef enum outcome { DECIDED, LEFT, TIME_OUT, UNSTABLE_STEP, STOPPED } outcome;

static outcome simulate(strut_relaxer *r, double step, strut_pass_of passes, const void *context,
                        const volatile sig_atomic_t *interrupt) {
  size_t bytes = (size_t)r->model->length * sizeof(double);
  verdict v = {-1.0, 0};
  strut_state_reset(r->model, r->state);
  memcpy(r->state->q, r->start, bytes);
  memset(r->state->v, 0, bytes);
  double first = total_energy(r), look = (double)FIRST_LOOK;
  if (is_decided(r, first, r->state->q, passes, context, &v)) return DECIDED;
  while (r->state->step < MOST_STEPS && (double)r->state->step * step < r->limit) {
    if (interrupt && *interrupt) return STOPPED;
    r->method->advance(r->model, r->state, r->workspace, step, (int64_t)look);
    double energy = total_energy(r);
    /* Nothing feeds the motion: an energy above the first comes from the step. */
    if (!isfinite(energy) || energy > first + GROWN * fabs(first)) return UNSTABLE_STEP;
    if (has_escaped(r->model, r->start, r->state->q)) return LEFT;
    if (is_decided(r, energy, r->state->q, passes, context, &v)) return DECIDED;
    look = fmin(1.1 * look, (double)LAST_LOOK);
  }
  return v.agreed >= AGREE ? DECIDED : TIME_OUT;
}

/* Largest acceleration at rest: the paper's break-off criterion with all speeds 0. */
static void judge_rest(strut_relaxer *r, const double *q, strut_relaxed *relaxed) {
  const strut_model *model = r->model;
  if (!r->state) return;
  size_t bytes = (size_t)model->length * sizeof(double);
  memset(r->state->v, 0, bytes);
  memset(r->last, 0, bytes);
  strut_forces_acceleration(model, r->state, 0.0, q, r->state->v, r->last);
  relaxed->acceleration = strut_largest_magnitude(r->last, 2 * model->node_count);
}

/* Minimises from q, with the centre of mass moved to x. */
static void quench_to_rest(strut_relaxer *r, double x, double *q, strut_relaxed *relaxed) {
  strut_descent descent = strut_relaxer_quench(r, q);
  relaxed->end = descent.end == STRUT_DESCENT_REACHED   ? STRUT_RELAXED_RESTS
                 : descent.end == STRUT_DESCENT_RUNAWAY ? STRUT_RELAXED_LEAVES
                                                        : STRUT_RELAXED_MOVES;
  restore_centre(r->model, x, q);
  relaxed->residual = descent.residual;
  if (relaxed->end == STRUT_RELAXED_RESTS) judge_rest(r, q, relaxed);
}

void strut_relax_down(strut_relaxer *r, double *q, strut_relaxed *relaxed) {
  *relaxed = (strut_relaxed){.end = STRUT_RELAXED_RESTS};
  quench_to_rest(r, centre_x(r->model, q), q, relaxed);
}

strut_status strut_relax(strut_relaxer *r, double *q, strut_pass_of passes, const void *context,
                         const volatile sig_atomic_t *interrupt, strut_relaxed *relaxed,
                         strut_error *error) {
  size_t bytes = (size_t)r->model->length * sizeof(double);
  outcome end = DECIDED;
  *relaxed = (strut_relaxed){.end = STRUT_RELAXED_RESTS};
  memcpy(r->start, q, bytes);
  strut_minimiser_watch(r->minimiser, interrupt);
  if (r->state) {
    double step = r->step;
    end = simulate(r, step, passes, context, interrupt);
    for (int i = 0; end == UNSTABLE_STEP && i < HALVINGS; i++)
      end = simulate(r, step *= 0.5, passes, context, interrupt);
    relaxed->time = (double)r->state->step * step;
    relaxed->simulated = r->state->step > 0;
    memcpy(q, end == DECIDED ? r->quenched : r->state->q, bytes);
  }
  if (end == STOPPED)
    return strut_fail(error, STRUT_INTERRUPTED, "interrupted while coming to rest");
  if (end == DECIDED)
    quench_to_rest(r, centre_x(r->model, r->start), q, relaxed);
  else
    relaxed->end = end == LEFT ? STRUT_RELAXED_LEAVES : STRUT_RELAXED_MOVES;
  return STRUT_OK;
}
