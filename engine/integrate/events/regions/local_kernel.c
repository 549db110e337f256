/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/events/regions/local_kernel.h"

#include <math.h>
#include <string.h>

#include "engine/integrate/events/event_kernel.h"
#include "engine/integrate/events/regions/local_events.h"

/* ---- the halo: positions by the polynomial of degree 5 with the positions, velocities and accelerations of both
   ends, velocities by that of degree 3 ---- */

void strut_local_place_halo(strut_local_events *p, double part, double *q, double *v) {
  const strut_local_region *r = &p->region;
  const strut_step_end *b = p->whole.begin, *e = p->whole.end;
  double x = part, h = p->whole.span, x2 = x * x, x3 = x2 * x, rest = 1.0 - x;
  double rise = x3 * (10.0 - x * (15.0 - 6.0 * x));
  double v0 = h * (x - x3 * (6.0 - x * (8.0 - 3.0 * x))), v1 = h * x3 * (x * (7.0 - 3.0 * x) - 4.0);
  double a0 = 0.5 * h * h * x2 * rest * rest * rest, a1 = 0.5 * h * h * x3 * rest * rest;
  double up = x2 * (3.0 - 2.0 * x), s0 = h * x * rest * rest, s1 = -h * x2 * rest;
  double slope = 6.0 * x * rest / h, d0 = rest * (1.0 - 3.0 * x), d1 = x * (3.0 * x - 2.0);
  for (int32_t k = 0; k < r->halo_count; k++)
    for (int32_t i = 2 * r->halo[k], c = 0; c < 2; i++, c++) {
      double more = e->v[i] - b->v[i];
      q[i] = b->q[i] + rise * (e->q[i] - b->q[i]) + v0 * b->v[i] + v1 * e->v[i] + a0 * b->a[i] +
             a1 * e->a[i];
      v[i] = b->v[i] + up * more + s0 * b->a[i] + s1 * e->a[i];
      r->halo_a[2 * k + c] = slope * more + d0 * b->a[i] + d1 * e->a[i];
    }
}

/* ---- forces ---- */

void strut_local_load_members(const strut_model *model, strut_local_events *p) {
  const strut_member_table *t = &model->members;
  const strut_local_region *r = &p->region;
  int32_t count = r->member_count, slots = (count + STRUT_LANES - 1) / STRUT_LANES * STRUT_LANES;
  for (int32_t k = 0; k < slots; k++) {
    bool pad = k >= count;
    int32_t j = pad ? 0 : r->member[k];
    p->members.from[k] = pad ? 2 * (uint32_t)model->node_count : t->from[j];
    p->members.to[k] = pad ? p->members.from[k] : t->to[j];
    p->members.stiffness[k] = pad ? 0.0 : t->stiffness[j];
    p->members.damping[k] = pad ? 0.0 : t->damping[j];
    p->members.rest[k] = pad ? 0.0 : t->rest[j];
    p->shell.latest.rest_rate[k] = 0.0;
    p->shell.modes.slack_length_threshold[k] = p->shell.modes.slack_force_threshold[k] = -HUGE_VAL;
  }
  p->members.table.count = count, p->members.table.slots = slots;
}

static void refresh_members(const strut_model *model, const strut_state *state,
                            strut_local_events *p) {
  const strut_local_region *r = &p->region;
  for (int32_t k = 0; k < r->member_count; k++) {
    int32_t j = r->member[k];
    p->shell.modes.slack_length_threshold[k] = state->modes.slack_length_threshold[j];
    p->shell.modes.slack_force_threshold[k] = state->modes.slack_force_threshold[j];
  }
  for (int32_t k = 0; k < r->member_count && model->terms & STRUT_TERM_DRIVE; k++) {
    p->members.rest[k] = state->latest.rest[r->member[k]];
    p->shell.latest.rest_rate[k] = state->latest.rest_rate[r->member[k]];
  }
}

/* A region's evaluations count by its nodes. */
static void count_evaluation(const strut_model *model, strut_state *state, strut_local_events *p) {
  p->evaluated += p->region.node_count;
  if (p->evaluated < model->node_count) return;
  p->evaluated -= model->node_count;
  state->evaluations++;
}

STRUT_INLINE void add_members(const strut_local_events *p, strut_state *state, const double *q,
                              const double *v, bool driven, bool balance) {
  enum { KEPT = STRUT_TERM_DAMPING | STRUT_TERM_SLACK, ALL = KEPT | STRUT_TERM_DRIVE };
  four_member_powers powers = {0};
  for (int32_t j = 0; j < p->members.table.slots; j += STRUT_LANES) {
    member_pulls pulls =
        members_group(&p->members.table, &p->shell, q, v, j, driven ? ALL : KEPT, balance, &powers);
    members_scatter(&p->members.table, j, pulls,
                    state->latest.force); /* made anew at each event: no rows */
  }
  for (int l = 0; l < STRUT_LANES && balance; l++) {
    state->latest.power[STRUT_POWER_DRIVE] += powers.drive[l];
    state->latest.power[STRUT_POWER_MEMBERS] += powers.lost[l];
    state->latest.power[STRUT_POWER_EXCHANGED] += powers.exchanged[l] + powers.lost[l];
  }
}

/* All forces but the ground's. */
STRUT_INLINE void region_forces(const strut_model *model, strut_state *state, strut_local_events *p,
                                double t, const double *q, const double *v, bool balance) {
  const strut_local_region *r = &p->region;
  const double *constant = model->terms & STRUT_TERM_CONSTANT ? model->constant_force : NULL;
  count_evaluation(model, state, p);
  for (int k = 0; k < STRUT_POWER_COUNT && balance; k++) state->latest.power[k] = 0.0;
  for (int32_t k = 0; k < r->node_count; k++)
    for (int32_t i = 2 * r->node[k]; i < 2 * r->node[k] + 2; i++)
      state->latest.force[i] = constant ? constant[i] : 0.0;
  if ((model->terms & STRUT_TERM_DRIVE) && t != state->latest.drive_time)
    strut_drive_apply(model, state, t);
  refresh_members(model, state, p);
  if (model->terms & STRUT_TERM_DRIVE)
    add_members(p, state, q, v, true, balance);
  else
    add_members(p, state, q, v, false, balance);
}

STRUT_INLINE void region_accelerations(const strut_model *model, strut_state *state,
                                       strut_event_stepper *l, const double *q, const double *v,
                                       double *a, strut_step_end *end, bool balance) {
  strut_local_events *p = l->within;
  if (l->closed_count)
    add_contact_forces(model, l, q, v, state->latest.force, true, end, STRUT_TERMS_COMMON);
  strut_local_region_divide(model, &p->region, state->latest.force, a);
  if (l->stuck_count) strut_local_hold(model, l, a, end);
  if (balance && l->closed_count) add_contact_powers(model, state, l, end, STRUT_TERMS_COMMON);
}

/* As evaluate_step_end; the halo has been placed. */
STRUT_INLINE void region_end(const strut_model *model, strut_state *state, strut_event_stepper *l,
                             double t, strut_step_end *end, bool balance) {
  const strut_local_region *r = &l->within->region;
  region_forces(model, state, l->within, t, end->q, end->v, balance);
  for (int32_t k = 0; k < r->node_count; k++)
    for (int32_t i = 2 * r->node[k]; i < 2 * r->node[k] + 2; i++)
      end->structure[i] = state->latest.force[i];
  for (int k = 0; k < STRUT_POWER_COUNT && balance; k++)
    end->structure_power[k] = state->latest.power[k];
  region_accelerations(model, state, l, end->q, end->v, end->a, end, balance);
  measure_contact_rates(model, l, end, STRUT_TERMS_COMMON);
  if (end == l->next) settle_band_ties(model, l);
  for (int k = 0; k < STRUT_POWER_COUNT && balance; k++) end->power[k] = state->latest.power[k];
}

STRUT_CLONES
static void region_now(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       double t, bool balance) {
  const strut_local_region *r = &l->within->region;
  strut_step_end *now = l->now;
  strut_local_place_halo(l->within, (t - l->within->whole.start) / l->within->whole.span, now->q,
                         now->v);
  if (!l->fresh) {
    region_end(model, state, l, t, now, balance);
    return;
  }
  for (int32_t k = 0; k < r->node_count; k++)
    for (int32_t i = 2 * r->node[k]; i < 2 * r->node[k] + 2; i++)
      state->latest.force[i] = now->structure[i];
  for (int k = 0; k < STRUT_POWER_COUNT && balance; k++)
    state->latest.power[k] = now->structure_power[k];
  region_accelerations(model, state, l, now->q, now->v, now->a, now, balance);
  measure_contact_rates(model, l, now, STRUT_TERMS_COMMON);
  for (int k = 0; k < STRUT_POWER_COUNT && balance; k++) now->power[k] = state->latest.power[k];
}

void strut_local_evaluate(const strut_model *model, strut_state *state, strut_event_stepper *l,
                          double t) {
  region_now(model, state, l, t, state->balance);
  l->fresh = true;
}

/* ---- steps ---- */

/* q = q0 + h sum v, speed = v0 + h sum a at the region's nodes, over `count` stages. */
STRUT_INLINE void region_stage(const strut_local_region *r, double h, const strut_step_end *now,
                               double *const *v, double *const *a, const double *weight, int count,
                               double *q, double *speed) {
  for (int32_t k = 0; k < r->node_count; k++) {
    int32_t i = 2 * r->node[k];
    strut_pair x = weight[0] * strut_pair_load(v[0] + i), y = weight[0] * strut_pair_load(a[0] + i);
    for (int j = 1; j < count; j++) {
      x += weight[j] * strut_pair_load(v[j] + i);
      y += weight[j] * strut_pair_load(a[j] + i);
    }
    strut_pair_store(q + i, strut_pair_load(now->q + i) + h * x);
    strut_pair_store(speed + i, strut_pair_load(now->v + i) + h * y);
  }
}

/* Local error over what is allowed, as that of the whole structure. */
STRUT_INLINE double region_error(const strut_model *model, const strut_event_stepper *l, double h,
                                 double *const *v, double *const *a) {
  const strut_local_region *r = &l->within->region;
  const double *difference = l->stepper->tableau->difference;
  int count = l->stepper->tableau->stages + 1;
  double position = 0.0, velocity = 0.0;
  for (int32_t k = 0; k < r->node_count; k++)
    for (int32_t i = 2 * r->node[k]; i < 2 * r->node[k] + 2; i++) {
      double x = 0.0, y = 0.0;
      for (int j = 0; j < count; j++) x += difference[j] * v[j][i], y += difference[j] * a[j][i];
      if (!(fabs(h * x) <= position)) position = fabs(h * x);
      if (!(fabs(h * y) <= velocity)) velocity = fabs(h * y);
    }
  double error = relative_error(model, l, h, position, velocity);
  return error == error ? error : HUGE_VAL;
}

STRUT_INLINE void take(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       double t, double h, bool balance) {
  const strut_tableau *tableau = l->stepper->tableau;
  strut_local_events *p = l->within;
  int stages = tableau->stages;
  double *v[STRUT_MOST_STAGES + 1], *a[STRUT_MOST_STAGES + 1], *q = l->stage[0];
  v[0] = l->now->v, a[0] = l->now->a;
  for (int k = 1; k < stages; k++) v[k] = l->stage[k], a[k] = l->stage[stages - 1 + k];
  v[stages] = l->next->v, a[stages] = l->next->a;
  const double *last = tableau->weight[stages];
  for (int k = 0; k < STRUT_POWER_COUNT && balance; k++)
    l->gained[k] = last[0] * h * l->now->power[k];
  for (int s = 1; s < stages; s++) {
    double at = t + tableau->ahead[s] * h;
    region_stage(&p->region, h, l->now, v, a, tableau->weight[s], s, q, v[s]);
    strut_local_place_halo(p, (at - p->whole.start) / p->whole.span, q, v[s]);
    region_forces(model, state, p, at, q, v[s], balance);
    region_accelerations(model, state, l, q, v[s], a[s], l->next, balance);
    if (l->stepper->adaptive) l->stepper->note_stage(l, tableau->ahead[s], s == 1);
    for (int k = 0; k < STRUT_POWER_COUNT && balance; k++)
      l->gained[k] += last[s] * h * state->latest.power[k];
  }
  region_stage(&p->region, h, l->now, v, a, last, stages, l->next->q, l->next->v);
  strut_local_place_halo(p, (t + h - p->whole.start) / p->whole.span, l->next->q, l->next->v);
  region_end(model, state, l, t + h, l->next, balance);
  if (!l->stepper->adaptive) return;
  l->error = region_error(model, l, h, v, a);
  l->stepper->look_between(model, state, l, h);
}

STRUT_CLONES
static void take_with_balance(const strut_model *model, strut_state *state, strut_event_stepper *l,
                              double t, double h) {
  take(model, state, l, t, h, true);
}

STRUT_CLONES
static void take_without_balance(const strut_model *model, strut_state *state,
                                 strut_event_stepper *l, double t, double h) {
  take(model, state, l, t, h, false);
}

void strut_local_trial(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       double t, double h) {
  if (state->balance)
    take_with_balance(model, state, l, t, h);
  else
    take_without_balance(model, state, l, t, h);
}

/* ---- a step's end a little earlier or later ---- */

STRUT_INLINE void shift_nodes(const strut_event_stepper *l, double from, double d) {
  const strut_local_region *r = &l->within->region;
  const strut_step_end *now = l->now, *next = l->next;
  double d2 = 0.5 * d * d, d3 = d * d * d / 6.0, inverse = 1.0 / from;
  for (int32_t k = 0; k < r->node_count; k++) {
    int32_t i = 2 * r->node[k];
    strut_pair v = strut_pair_load(next->v + i), a = strut_pair_load(next->a + i);
    strut_pair a0 = strut_pair_load(now->a + i);
    strut_pair mean = (v - strut_pair_load(now->v + i)) * inverse;
    strut_pair jerk = (2.0 * a0 + 4.0 * a - 6.0 * mean) * inverse;
    strut_pair bend = (6.0 * (a0 + a) - 12.0 * mean) * inverse * inverse;
    strut_pair_store(next->q + i, strut_pair_load(next->q + i) + d * v + d2 * a + d3 * jerk);
    strut_pair_store(next->v + i, v + d * a + d2 * jerk + d3 * bend);
  }
}

STRUT_CLONES
static void shift(const strut_model *model, strut_state *state, strut_event_stepper *l, double t,
                  double from, double to, bool balance) {
  strut_local_events *p = l->within;
  strut_step_end *next = l->next;
  double half = 0.5 * (to - from);
  for (int k = 0; k < STRUT_POWER_COUNT && balance; k++) l->gained[k] += half * next->power[k];
  shift_nodes(l, from, to - from);
  strut_local_place_halo(p, (t + to - p->whole.start) / p->whole.span, next->q, next->v);
  region_end(model, state, l, t + to, next, balance);
  for (int k = 0; k < STRUT_POWER_COUNT && balance; k++) l->gained[k] += half * next->power[k];
}

void strut_local_shift(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       double t, double from, double to) {
  shift(model, state, l, t, from, to, state->balance);
}
