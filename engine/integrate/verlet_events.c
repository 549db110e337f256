/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Velocity Verlet between events, with the ground's dampers implicit: one evaluation a step, no
 * limit from the dampers, and shorter steps for a while after a touchdown.
 *
 * The dampers enter by the trapezoidal rule: v1 = v0 + h/2 (a0 + a1), where a1 contains the damper's
 * force at v1. Contacts of one body are coupled through its mass; sweeps over them converge fast,
 * since the scaled consistent mass has its eigenvalues in [1/2, 3/2].
 */
#include "engine/integrate/integrator.h"
#include "engine/integrate/located_kernel.h"

enum { PREDICTED, STAGES };

static void predict(const strut_model *model, strut_located *l, double h) {
  const double *restrict q = l->now->q, *restrict v = l->now->v, *restrict a = l->now->a;
  double *restrict next = l->next->q, *restrict speed = l->stage[PREDICTED], half = 0.5 * h;
  for (int32_t i = 0; i < model->length; i += STRUT_LANES) {
    strut_lanes rate = strut_lanes_load(v + i), bend = strut_lanes_load(a + i);
    strut_lanes_store(next + i, strut_lanes_load(q + i) + h * (rate + half * bend));
    strut_lanes_store(speed + i, rate + h * bend);
  }
}

STRUT_INLINE void correct(int32_t n, double h, const double *restrict v, const double *restrict a0,
                          const double *restrict a1, double *restrict next) {
  double half = 0.5 * h;
  for (int32_t i = 0; i < n; i += STRUT_LANES)
    strut_lanes_store(next + i, strut_lanes_load(v + i) + half * (strut_lanes_load(a0 + i) +
                                                                  strut_lanes_load_pairs(a1 + i)));
}

/* Speed into the ground at the end of the step, given the accelerations so far. */
STRUT_INLINE double final_speed(const strut_contact_table *c, const strut_located *l, int32_t i,
                                double h, const double *a1) {
  uint32_t at = c->at[i];
  const double *v = l->now->v + at, *a0 = l->now->a + at, *a = a1 + at;
  return (v[0] + 0.5 * h * (a0[0] + a[0])) * c->normal[0] +
         (v[1] + 0.5 * h * (a0[1] + a[1])) * c->normal[1];
}

/* The damper of contact i by the trapezoidal rule; returns the change of its force. */
STRUT_INLINE double solve_damper(const strut_model *model, strut_located *l, int32_t i, double h,
                                 const double *a1, strut_touch *o) {
  const strut_contact_entry *e = &model->contacts.entry[i];
  double spring = -e->stiffness * o->gap, now = l->damped[i];
  bool smooth = e->dissipation > 0.0;
  double rate = !smooth ? e->damping : spring > 0.0 ? e->dissipation * spring : 0.0;
  if (!(rate > 0.0)) return 0.0;
  double half = 0.5 * h * l->response[i].normal;
  double free = final_speed(&model->contacts, l, i, h, a1) - half * now;
  double into = free / (1.0 + half * rate), force = -rate * into;
  if (smooth) {
    if (force < -spring) force = spring > 0.0 ? -spring : 0.0;
  } else if (into > 0.0) {
    force = 0.0;
  }
  l->damped[i] = force;
  return force - now;
}

STRUT_INLINE void solve_dampers(const strut_model *model, strut_located *l, double h, double *a1,
                                strut_touch *restrict touch) {
  for (int sweep = 0; sweep < 40; sweep++) {
    double changed = 0.0, largest = 0.0;
    for (int32_t k = 0; k < l->closed_count; k++) {
      int32_t i = l->closed[k];
      double more = solve_damper(model, l, i, h, a1, &touch[i]);
      if (more != 0.0) strut_located_respond(model, l, i, more, 0.0, a1);
      if (fabs(more) > changed) changed = fabs(more);
      if (fabs(touch[i].normal) > largest) largest = fabs(touch[i].normal);
    }
    if (changed <= 1e-15 * largest || l->closed_count == 1) break;
  }
}

/* Friction again with the whole normal force, then what holds stuck nodes. */
STRUT_INLINE void solve_friction(const strut_model *model, strut_located *l, double *a1,
                                 strut_touch *restrict touch) {
  for (int32_t k = 0; k < l->closed_count; k++) {
    int32_t i = l->closed[k];
    strut_touch *o = &touch[i];
    o->normal = -model->contacts.entry[i].stiffness * o->gap + l->damped[i];
    double friction = located_friction(&model->contacts.entry[i], l->mode[i], l->side[i], o->normal,
                                       o->slip, o->applied);
    bool held = l->mode[i] == STRUT_MODE_STICK || l->mode[i] == STRUT_MODE_CREEP;
    if (held || friction == o->friction) continue;
    strut_located_respond(model, l, i, 0.0, friction - o->friction, a1);
    o->friction = friction;
  }
  if (l->stuck_count) strut_located_hold(model, l, a1, l->next);
}

STRUT_INLINE void place_again(const strut_model *model, strut_located *l) {
  for (int32_t k = 0; k < l->closed_count; k++)
    located_place(&model->contacts, l->closed[k], l->next->q, l->next->v,
                  &l->next->touch[l->closed[k]]);
}

STRUT_INLINE void take(const strut_model *model, strut_state *state, strut_located *l, double t,
                       double h, bool ledger) {
  int32_t n = model->length;
  double *predicted = l->stage[PREDICTED], *a1 = l->next->a;
  forces_of_structure(model, state, t + h, l->next->q, predicted, ledger);
  located_keep(model, state, l->next, ledger);
  if (l->closed_count)
    located_ground(model, l, l->next->q, predicted, state->force, false, l->next->touch);
  mass_kernel(model, state->force, a1, state->scratch);
  for (int32_t k = 0; k < l->closed_count; k++) l->damped[l->closed[k]] = 0.0;
  for (int pass = 0; pass < l->passes && l->closed_count; pass++) {
    solve_dampers(model, l, h, a1, l->next->touch);
    solve_friction(model, l, a1, l->next->touch);
  }
  correct(n, h, l->now->v, l->now->a, a1, l->next->v);
  if (l->closed_count) {
    place_again(model, l);
    located_rates(model, l, a1, l->next->touch);
    if (ledger) located_powers(model, state, l, l->next->touch);
  }
  for (int p = 0; p < STRUT_POWER_COUNT && ledger; p++) {
    l->next->power[p] = state->power[p];
    l->gained[p] = 0.5 * h * (l->now->power[p] + l->next->power[p]);
  }
}

STRUT_CLONES
static void verlet_events_trial(const strut_model *model, strut_state *state, strut_located *l,
                                double t, double h) {
  if (state->ledger)
    take(model, state, l, t, h, true);
  else
    take(model, state, l, t, h, false);
}

static const strut_stepper stepper = {
    .trial = verlet_events_trial, .stages = STAGES, .predict = predict};

static void *create(const strut_model *model, strut_state *state) {
  return strut_located_create(model, state, &stepper);
}

const strut_integrator strut_integrator_verlet_events = {
    .name = "verlet-events",
    .description =
        "velocity Verlet from event to event, implicit ground dampers, shorter steps "
        "after a touchdown",
    .order = 2,
    .evaluations = 1,
    .region = STRUT_REGION_VERLET,
    .implicit_damper = true,
    .events = true,
    .create = create,
    .restart = strut_located_restart,
    .advance = strut_located_advance,
};
