/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which mode follows: at the start, at an event, and when several contacts hold at once. */
#include <assert.h>
#include <math.h>

#include "engine/forces/drives.h"
#include "engine/forces/history.h"
#include "engine/integrate/events/event_kernel.h"

/* At rest on the ground is what is slower than this part of size times the contact's frequency; and no force what
   is below this part of the forces on the node. */
static const double TIE = 1e-12;

STRUT_CLONES
static void evaluate_now(const strut_model *model, strut_state *state, strut_event_stepper *l,
                         double t) {
  strut_step_end *now = l->now;
  if (!l->fresh) {
    evaluate_step_end(model, state, l, t, now, STRUT_TERMS_ALL, state->balance);
  } else {
    for (int32_t i = 0; i < model->length; i++) state->latest.force[i] = now->structure[i];
    for (int p = 0; p < STRUT_POWER_COUNT; p++) state->latest.power[p] = now->structure_power[p];
    if (model->terms & STRUT_TERM_SLIDING_MASS) strut_sliding_masses_place(model, state, t);
    accelerate_closed(model, state, l, now->q, now->v, now->a, now, STRUT_TERMS_ALL,
                      state->balance);
    measure_contact_rates(model, l, now, STRUT_TERMS_ALL);
    for (int p = 0; p < STRUT_POWER_COUNT; p++) now->power[p] = state->latest.power[p];
  }
  l->fresh = true;
}

void strut_evaluate_acceleration(const strut_model *model, strut_state *state,
                                 strut_event_stepper *l, double t) {
  bool fresh = l->fresh;
  evaluate_now(model, state, l, t);
  /* a step that is not taken has left rest lengths and sensors of its end */
  if (fresh && l->law_count) strut_drive_apply(model, state, t);
  strut_event_measure(model, state, l, l->now);
}

/* Along and out of the ground where the node of closed contact i is. */
static strut_contact_axes axes_now(const strut_contact_table *c, const strut_event_stepper *l,
                                   int32_t i) {
  assert(i >= 0 && i < c->count);
  int32_t facet = c->surface ? l->facet[i] : -1;
  return strut_contact_pose_at(c, i, l->now->q, l->now->motion, facet).axes;
}

void strut_contact_snap(const strut_model *model, strut_event_stepper *l, int32_t i, double slip) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_contact_table *c = &model->contacts;
  double *v = l->now->v + c->at[i];
  if (c->normal[0] == 0.0 && !c->surface) {
    v[0] = slip + c->belt_speed;
    return;
  }
  strut_touch place;
  measure_at_end(c, l, l->now, i, STRUT_TERMS_ALL, &place);
  double more = slip - place.slip;
  strut_contact_axes axes = axes_now(c, l, i);
  v[0] += more * axes.tangent[0];
  v[1] += more * axes.tangent[1];
}

void strut_cable_set_acting(strut_state *state, strut_event_stepper *l, int32_t k, bool pulls) {
  assert(k >= 0 && k < l->law_count);
  int32_t j = l->laws[k].member;
  l->acting[k] = pulls;
  l->fresh = false;
  if (j < 0) {
    state->modes.element_acts[l->laws[k].element] = pulls ? 1 : -1;
    return;
  }
  state->modes.slack_length_threshold[j] = pulls ? -HUGE_VAL : 0.0;
  state->modes.slack_force_threshold[j] = pulls ? -HUGE_VAL : HUGE_VAL;
}

/* May the node of a contact move along it? Otherwise a support holds it. */
static bool is_free_along(const strut_model *model, const strut_event_stepper *l, int32_t i) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_contact_compliance *r = &l->response[i];
  if (!model->contacts.surface) return r->tangent > 0.0;
  strut_contact_axes axes = axes_now(&model->contacts, l, i);
  return strut_compliance_along(r, axes.tangent) > 1e-12 * r->tangent;
}

void strut_contact_close(const strut_model *model, strut_event_stepper *l, int32_t i,
                         int32_t facet) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_contact_entry *e = &l->entry[i];
  strut_touch o;
  l->mode[i] = STRUT_MODE_SLIDE;
  if (model->contacts.surface && facet < 0)
    facet = strut_contact_pose_at(&model->contacts, i, l->now->q, l->now->motion, -1).facet;
  if (model->contacts.surface) l->facet[i] = facet;
  measure_at_end(&model->contacts, l, l->now, i, STRUT_TERMS_ALL, &o);
  l->damper[i] = 0;
  if (l->stepper->exact && e->damping > 0.0) l->damper[i] = o.into < 0.0 ? 1 : -1;
  l->side[i] = o.slip < 0.0 ? -1 : 1;
  if (!is_free_along(model, l, i)) return;
  switch (strut_friction_states(e->friction.law)) {
    case STRUT_FRICTION_ABSENT:
    case STRUT_FRICTION_CONTINUOUS:
    case STRUT_FRICTION_BRISTLES: break;
    case STRUT_FRICTION_STICK_BAND: { /* inside, or at the edge by rounding */
      bool inside = fabs(o.slip) < e->friction.stick_velocity * (1.0 + STRUT_TIED);
      l->mode[i] = inside ? STRUT_MODE_BAND : STRUT_MODE_SLIP;
      break;
    }
    case STRUT_FRICTION_EXACT_STICK:
      l->mode[i] = STRUT_MODE_SLIP;
      if (fabs(o.slip) > TIE * model->size * sqrt(e->stiffness * l->response[i].normal)) break;
      l->mode[i] = STRUT_MODE_STICK;
      strut_contact_snap(model, l, i, 0.0);
      break;
  }
}

/* Is what holds stuck contact i no more than rounding of the forces on its node? */
static bool is_held_by_rounding(const strut_model *model, const strut_event_stepper *l, int32_t i) {
  assert(i >= 0 && i < model->contacts.count);
  const double *force = l->now->structure + model->contacts.at[i];
  return fabs(l->now->touch[i].friction) <= TIE * hypot(force[0], force[1]);
}

/* The stuck contact that is held by more than friction can give, or -1. */
static int32_t overloaded(const strut_model *model, const strut_event_stepper *l) {
  double worst = 1e-12;
  int32_t found = -1;
  for (int32_t k = 0; k < l->closed_count; k++) {
    int32_t i = l->closed[k];
    if (l->mode[i] != STRUT_MODE_STICK) continue;
    const strut_touch *o = &l->now->touch[i];
    double most = strut_friction_static(&l->entry[i].friction, -o->friction) * o->normal;
    double over = fabs(o->friction) - most;
    if (!(over > worst * fabs(o->friction))) continue;
    /* without a normal force yet, no friction is too little: rounding must not set the node in motion */
    if (!(o->normal > 0.0) && is_held_by_rounding(model, l, i)) continue;
    worst = over / fabs(o->friction);
    found = i;
  }
  return found;
}

void strut_modes_derive(const strut_model *model, strut_state *state, strut_event_stepper *l,
                        double t) {
  for (int32_t k = 0; k <= model->contacts.count; k++) {
    strut_update_active_set(model, l);
    strut_evaluate_acceleration(model, state, l, t);
    int32_t i = overloaded(model, l);
    if (i < 0) return;
    l->mode[i] = STRUT_MODE_SLIP;
    l->side[i] = l->now->touch[i].friction > 0.0 ? -1 : 1;
  }
}

static void set_piece(strut_state *state, strut_event_stepper *l, int32_t k, int piece) {
  assert(k >= 0 && k < l->law_count);
  state->modes.element_piece[l->laws[k].element] = (int16_t)piece;
  l->fresh = false;
}

/* On the piece on which the strain is; it has been measured. */
static void find_piece(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       int32_t k, double t) {
  assert(k >= 0 && k < l->law_count);
  int32_t i = l->laws[k].element;
  const strut_element *e = &model->elements.element[i];
  bool folds = e->law == STRUT_LAW_FOLDING;
  if (folds) strut_curve_renew(model, state, i, l->now->q, t);
  set_piece(state, l, k,
            folds ? (int)state->latest.rest[e->slot + STRUT_CURVE_PIECE]
                  : strut_law_piece(e->law, &e->numbers, l->now->stretch[k]));
}

void strut_law_pass_kink(const strut_model *model, strut_state *state, strut_event_stepper *l,
                         int32_t k, double t) {
  assert(k >= 0 && k < l->law_count);
  int32_t i = l->laws[k].element;
  const strut_element *e = &model->elements.element[i];
  int piece = state->modes.element_piece[i];
  double low, high, x = l->now->stretch[k];
  strut_law_margins(e->law, &e->numbers, piece, x, &low, &high);
  int way = low < high ? -1 : 1;
  bool folds = e->law == STRUT_LAW_FOLDING;
  set_piece(state, l, k,
            folds ? strut_curve_pass(model, state, i, (strut_crossing){way, x, t}) : piece + way);
}

/* Which laws act, and on which piece, as positions, velocities and drives are. */
static void start_laws(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       double t) {
  bool changed = false, memory = model->terms & STRUT_TERM_MEMORY;
  if (memory) strut_drive_apply(model, state, t);
  if (memory) strut_history_thaw(model, state, l);
  if (l->nearby_laws) strut_event_part_all(model, state, l);
  int32_t laws = strut_laws_of(l);
  for (int32_t n = 0; n < laws; n++) {
    int32_t k = strut_law_of(l, n);
    if (l->laws[k].event == STRUT_EVENT_KINK)
      set_piece(state, l, k, -1);
    else if (l->laws[k].event == STRUT_EVENT_ACTS)
      strut_cable_set_acting(state, l, k, true);
  }
  if (memory) strut_history_drop_gone(model, state, l);
  strut_modes_derive(model, state, l, t);
  for (int32_t n = 0; n < laws; n++) {
    int32_t k = strut_law_of(l, n);
    if (l->laws[k].event == STRUT_EVENT_KINK) {
      find_piece(model, state, l, k, t);
      changed = true;
    } else if (l->laws[k].event == STRUT_EVENT_RELAY) {
      continue;
    } else if (l->laws[k].event != STRUT_EVENT_ACTS) {
      strut_history_start(model, state, l, k);
      changed = true;
    } else if (!(l->now->stretch[k] > 0.0 && l->now->tension[k] > 0.0)) {
      strut_cable_set_acting(state, l, k, false);
      changed = true;
    }
  }
  if (changed) strut_modes_derive(model, state, l, t);
}

void strut_modes_after_jump(const strut_model *model, strut_state *state, strut_event_stepper *l,
                            double t) {
  l->fresh = false;
  start_laws(model, state, l, t);
}

void strut_modes_start(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       double t) {
  l->fresh = false;
  strut_surface_move(model, state, l->now, t);
  for (int32_t i = 0; i < model->contacts.count; i++) {
    strut_touch o;
    l->mode[i] = STRUT_MODE_OPEN;
    measure_at_end(&model->contacts, l, l->now, i, STRUT_TERMS_ALL, &o);
    if (o.gap < 0.0 || (o.gap == 0.0 && o.into <= 0.0)) strut_contact_close(model, l, i, -1);
  }
  start_laws(model, state, l, t);
}

bool strut_modes_after_step(const strut_model *model, strut_event_stepper *l) {
  bool changed = false;
  for (int32_t k = 0; k < l->closed_count && !l->stepper->exact; k++) {
    int32_t i = l->closed[k];
    if (!(l->now->touch[i].gap > 0.0)) continue;
    l->mode[i] = STRUT_MODE_OPEN;
    changed = true;
  }
  if (changed) strut_update_active_set(model, l);
  return changed;
}
