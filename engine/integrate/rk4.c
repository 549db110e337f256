/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The classical Runge-Kutta method of fourth order with a fixed step, as the paper uses it: the
 * force law, contact and friction included, is evaluated at every stage.
 */
#include "engine/integrate/integrator.h"
#include "engine/model/hot.h"

/* Stage values, (length) each: v2 to v4 are the velocities, a1 to a4 the accelerations. */
typedef struct rk4_workspace {
  double *q, *v2, *v3, *v4, *a1, *a2, *a3, *a4;
  strut_arena arena;
} rk4_workspace;

static void rk4_destroy(void *workspace) {
  rk4_workspace *w = workspace;
  if (!w) return;
  strut_arena_free(&w->arena);
  strut_release(w);
}

static void *rk4_create(const strut_model *model) {
  rk4_workspace *w = strut_allocate(1, sizeof *w);
  if (!w) return NULL;
  size_t both = (size_t)model->length;
  double **all[] = {&w->q, &w->v2, &w->v3, &w->v4, &w->a1, &w->a2, &w->a3, &w->a4};
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
    *all[i] = strut_arena_allocate(&w->arena, both, sizeof(double));
    if (!*all[i]) {
      rk4_destroy(w);
      return NULL;
    }
  }
  return w;
}

/* Positions and velocities of the next stage: q + h v, v0 + h a. */
STRUT_INLINE void stage(int32_t n, double h, const double *restrict q0,
                        const double *restrict v0, const double *restrict v,
                        const double *restrict a, double *restrict q, double *restrict next) {
  for (int32_t i = 0; i < n; i += STRUT_LANES) {
    strut_lanes_store(q + i, strut_lanes_load(q0 + i) + h * strut_lanes_load(v + i));
    strut_lanes_store(next + i, strut_lanes_load(v0 + i) + h * strut_lanes_load(a + i));
  }
}

/* z += h/6 (k1 + 2 (k2 + k3) + k4) */
STRUT_INLINE void combine(int32_t n, double h, double *restrict z, const double *k1,
                          const double *restrict k2, const double *restrict k3,
                          const double *restrict k4) {
  double sixth = h / 6.0;
  for (int32_t i = 0; i < n; i += STRUT_LANES) {
    strut_lanes inner = strut_lanes_load(k2 + i) + strut_lanes_load(k3 + i);
    strut_lanes sum = strut_lanes_load(k1 + i) + 2.0 * inner + strut_lanes_load(k4 + i);
    strut_lanes_store(z + i, strut_lanes_load(z + i) + sixth * sum);
  }
}

/* Forces at a stage; with the ledger, its powers enter the works with the stage's weight. */
STRUT_INLINE void evaluate(const strut_model *model, strut_state *state, double t,
                           const double *restrict q, const double *restrict v, double *restrict a,
                           double weight) {
  strut_forces_acceleration(model, state, t, q, v, a);
  if (!state->ledger) return;
  for (int p = 0; p < STRUT_POWER_COUNT; p++) state->work[p] += weight * state->power[p];
}

STRUT_CLONES
static void run_steps(const strut_model *model, strut_state *state, const rk4_workspace *w,
                      double dt, int64_t count) {
  int32_t n = model->length;
  for (int64_t k = 0; k < count; k++) {
    double step = (double)state->step;
    double begin = step * dt, middle = (step + 0.5) * dt, end = (step + 1.0) * dt;
    evaluate(model, state, begin, state->q, state->v, w->a1, dt / 6.0);
    stage(n, 0.5 * dt, state->q, state->v, state->v, w->a1, w->q, w->v2);
    evaluate(model, state, middle, w->q, w->v2, w->a2, dt / 3.0);
    stage(n, 0.5 * dt, state->q, state->v, w->v2, w->a2, w->q, w->v3);
    evaluate(model, state, middle, w->q, w->v3, w->a3, dt / 3.0);
    stage(n, dt, state->q, state->v, w->v3, w->a3, w->q, w->v4);
    evaluate(model, state, end, w->q, w->v4, w->a4, dt / 6.0);
    combine(n, dt, state->q, state->v, w->v2, w->v3, w->v4);
    combine(n, dt, state->v, w->a1, w->a2, w->a3, w->a4);
    state->step++;
  }
}

/* A clone is a local function, and the table wants an ordinary one. */
static void rk4_advance(const strut_model *model, strut_state *state, void *workspace, double dt,
                        int64_t count) {
  run_steps(model, state, workspace, dt, count);
}

const strut_integrator strut_integrator_rk4 = {
    .name = "rk4",
    .description = "classical Runge-Kutta, fixed step, forces at every stage",
    .order = 4,
    .evaluations = 4,
    .create = rk4_create,
    .advance = rk4_advance,
    .destroy = rk4_destroy,
};
