/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which mode follows: at the start, at an event, and when several contacts hold at once. */
#include <assert.h>
#include <math.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/history.h"
#include "engine/integrate/events/event_kernel.h"

/* At rest on the ground is what is slower than this part of size times the contact's frequency; and no force what
   is below this part of the forces on the node. */
static const double TIE = 1e-12;

STRUT_CLONES
static void evaluate_now(const strut_model *model, const strut_state *state,
                         strut_event_stepper *stepper, double t) {
  strut_step_end *now = stepper->now;
  if (!stepper->fresh) {
    evaluate_step_end(model, state, stepper, t, now, STRUT_TERMS_ALL, state->balance);
  } else {
    for (int32_t i = 0; i < model->length; i++) state->latest->force[i] = now->structure[i];
    for (int p = 0; p < STRUT_POWER_COUNT; p++) state->latest->power[p] = now->structure_power[p];
    if (model->terms & STRUT_TERM_SLIDING_MASS) strut_sliding_masses_place(model, state, t);
    accelerate_closed(model, state, stepper, now->q, now->v, now->a, now, STRUT_TERMS_ALL,
                      state->balance);
    measure_contact_rates(model, &stepper->active, now, STRUT_TERMS_ALL);
    for (int p = 0; p < STRUT_POWER_COUNT; p++) now->power[p] = state->latest->power[p];
  }
  stepper->fresh = true;
}

void strut_evaluate_acceleration(const strut_model *model, const strut_state *state,
                                 strut_event_stepper *stepper, double t) {
  bool fresh = stepper->fresh;
  evaluate_now(model, state, stepper, t);
  /* a step that is not taken has left rest lengths and sensors of its end */
  if (fresh && stepper->laws.count) strut_drive_apply(model, state, t);
  strut_event_measure(model, state, stepper, stepper->now);
}

/* Along and out of the ground where the node of closed contact i is. */
static strut_contact_axes axes_now(const strut_contact_table *contacts,
                                   const strut_event_stepper *stepper, int32_t i) {
  assert(i >= 0 && i < contacts->count);
  int32_t facet = contacts->surface ? stepper->modes.facet[i] : -1;
  return strut_contact_pose_at(contacts, i, stepper->now->q, stepper->now->motion, facet).axes;
}

void strut_contact_snap(const strut_model *model, strut_event_stepper *stepper, int32_t i,
                        double slip) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_contact_table *contacts = &model->contacts;
  double *v = stepper->now->v + contacts->at[i];
  if (contacts->normal[0] == 0.0 && !contacts->surface) {
    v[0] = slip + contacts->belt_speed;
    return;
  }
  strut_touch place;
  measure_at_end(contacts, &stepper->modes, stepper->now, i, STRUT_TERMS_ALL, &place);
  double more = slip - place.slip;
  strut_contact_axes axes = axes_now(contacts, stepper, i);
  v[0] += more * axes.tangent[0];
  v[1] += more * axes.tangent[1];
}

void strut_cable_set_acting(strut_state *state, strut_event_stepper *stepper, int32_t k,
                            bool pulls) {
  assert(k >= 0 && k < stepper->laws.count);
  int32_t j = stepper->laws.item[k].member;
  stepper->laws.acting[k] = pulls;
  stepper->fresh = false;
  if (j < 0) {
    state->modes.element_acts[stepper->laws.item[k].element] = pulls ? 1 : -1;
    return;
  }
  state->modes.slack_length_threshold[j] = pulls ? -HUGE_VAL : 0.0;
  state->modes.slack_force_threshold[j] = pulls ? -HUGE_VAL : HUGE_VAL;
}

/* May the node of a contact move along it? Otherwise a support holds it. */
static bool is_free_along(const strut_model *model, const strut_event_stepper *stepper, int32_t i) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_contact_compliance *compliance = &stepper->contacts.compliance[i];
  if (!model->contacts.surface) return compliance->tangent > 0.0;
  strut_contact_axes axes = axes_now(&model->contacts, stepper, i);
  return strut_compliance_along(compliance, axes.tangent) > 1e-12 * compliance->tangent;
}

void strut_contact_close(const strut_model *model, strut_event_stepper *stepper, int32_t i,
                         int32_t facet) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_contact_entry *contact = &stepper->contacts.entry[i];
  strut_touch o;
  stepper->modes.of[i] = STRUT_MODE_SLIDE;
  if (model->contacts.surface && facet < 0)
    facet =
        strut_contact_pose_at(&model->contacts, i, stepper->now->q, stepper->now->motion, -1).facet;
  if (model->contacts.surface) stepper->modes.facet[i] = facet;
  measure_at_end(&model->contacts, &stepper->modes, stepper->now, i, STRUT_TERMS_ALL, &o);
  stepper->modes.damper[i] = 0;
  if (stepper->formula->exact && contact->damping > 0.0)
    stepper->modes.damper[i] = o.into < 0.0 ? 1 : -1;
  stepper->modes.side[i] = o.slip < 0.0 ? -1 : 1;
  if (!is_free_along(model, stepper, i)) return;
  switch (strut_friction_states(contact->friction.law)) {
    case STRUT_FRICTION_ABSENT:
    case STRUT_FRICTION_CONTINUOUS:
    case STRUT_FRICTION_BRISTLES: break;
    case STRUT_FRICTION_STICK_BAND: { /* inside, or at the edge by rounding */
      bool inside = fabs(o.slip) < contact->friction.stick_velocity * (1.0 + STRUT_TIED);
      stepper->modes.of[i] = inside ? STRUT_MODE_BAND : STRUT_MODE_SLIP;
      break;
    }
    case STRUT_FRICTION_EXACT_STICK:
      stepper->modes.of[i] = STRUT_MODE_SLIP;
      if (fabs(o.slip) >
          TIE * model->size * sqrt(contact->stiffness * stepper->contacts.compliance[i].normal))
        break;
      stepper->modes.of[i] = STRUT_MODE_STICK;
      strut_contact_snap(model, stepper, i, 0.0);
      break;
  }
}

void strut_contact_rest(strut_event_stepper *stepper, double h, bool event) {
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    int32_t i = stepper->active.closed[k];
    double into = stepper->now->touch[i].into;
    int8_t *damper = &stepper->modes.damper[i];
    bool rests = is_at_rest(stepper, into, h);
    if (rests && !event) *damper = 0;
    if (!rests && !*damper && stepper->contacts.entry[i].damping > 0.0)
      *damper = into < 0.0 ? 1 : -1;
  }
}

/* Is what holds stuck contact i no more than rounding of the forces on its node? */
static bool is_held_by_rounding(const strut_model *model, const strut_event_stepper *stepper,
                                int32_t i) {
  assert(i >= 0 && i < model->contacts.count);
  const double *force = stepper->now->structure + model->contacts.at[i];
  return fabs(stepper->now->touch[i].friction) <= TIE * hypot(force[0], force[1]);
}

/* The stuck contact that is held by more than friction can give, or -1. */
static int32_t overloaded(const strut_model *model, const strut_event_stepper *stepper) {
  double worst = 1e-12;
  int32_t found = -1;
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    int32_t i = stepper->active.closed[k];
    if (stepper->modes.of[i] != STRUT_MODE_STICK) continue;
    const strut_touch *touch = &stepper->now->touch[i];
    double most = strut_friction_static(&stepper->contacts.entry[i].friction, -touch->friction) *
                  touch->normal;
    double over = fabs(touch->friction) - most;
    if (!(over > worst * fabs(touch->friction))) continue;
    /* without a normal force yet, no friction is too little: rounding must not set the node in motion */
    if (!(touch->normal > 0.0) && is_held_by_rounding(model, stepper, i)) continue;
    worst = over / fabs(touch->friction);
    found = i;
  }
  return found;
}

void strut_modes_derive(const strut_model *model, const strut_state *state,
                        strut_event_stepper *stepper, double t) {
  for (int32_t k = 0; k <= model->contacts.count; k++) {
    strut_update_active_set(model, stepper);
    strut_evaluate_acceleration(model, state, stepper, t);
    int32_t i = overloaded(model, stepper);
    if (i < 0) return;
    stepper->modes.of[i] = STRUT_MODE_SLIP;
    stepper->modes.side[i] = stepper->now->touch[i].friction > 0.0 ? -1 : 1;
  }
}

static void set_piece(strut_state *state, strut_event_stepper *stepper, int32_t k, int piece) {
  assert(k >= 0 && k < stepper->laws.count);
  state->modes.element_piece[stepper->laws.item[k].element] = (int16_t)piece;
  stepper->fresh = false;
}

/* On the piece on which the strain is; it has been measured. */
static void find_piece(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                       int32_t k, double t) {
  assert(k >= 0 && k < stepper->laws.count);
  int32_t i = stepper->laws.item[k].element;
  const strut_element *element = &model->elements.element[i];
  bool folds = element->law == STRUT_LAW_FOLDING;
  if (folds) strut_curve_renew(model, state, i, stepper->now->q, t);
  set_piece(state, stepper, k,
            folds ? (int)state->latest->rest[element->slot + STRUT_CURVE_PIECE]
                  : strut_law_piece(element->law, &element->numbers, stepper->now->stretch[k]));
}

void strut_law_pass_kink(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                         int32_t k, double t) {
  assert(k >= 0 && k < stepper->laws.count);
  int32_t i = stepper->laws.item[k].element;
  const strut_element *element = &model->elements.element[i];
  int piece = state->modes.element_piece[i];
  double low, high, x = stepper->now->stretch[k];
  strut_law_margins(element->law, &element->numbers, piece, x, &low, &high);
  int way = low < high ? -1 : 1;
  bool folds = element->law == STRUT_LAW_FOLDING;
  set_piece(state, stepper, k,
            folds ? strut_curve_pass(model, state, i, (strut_crossing){way, x, t}) : piece + way);
}

/* Which laws act, and on which piece, as positions, velocities and drives are. */
static void start_laws(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                       double t) {
  bool changed = false, memory = model->terms & STRUT_TERM_MEMORY;
  stepper->turns.due = state->step;
  if (memory) strut_drive_apply(model, state, t);
  if (memory) strut_history_thaw(model, state, stepper);
  if (stepper->laws.nearby) strut_event_part_all(model, state, stepper);
  int32_t laws = strut_laws_of(&stepper->laws);
  for (int32_t n = 0; n < laws; n++) {
    int32_t k = strut_law_of(&stepper->laws, n);
    if (stepper->laws.item[k].event == STRUT_EVENT_KINK)
      set_piece(state, stepper, k, -1);
    else if (stepper->laws.item[k].event == STRUT_EVENT_ACTS)
      strut_cable_set_acting(state, stepper, k, true);
  }
  if (memory) strut_history_drop_gone(model, state, &stepper->laws);
  strut_modes_derive(model, state, stepper, t);
  for (int32_t n = 0; n < laws; n++) {
    int32_t k = strut_law_of(&stepper->laws, n);
    if (stepper->laws.item[k].event == STRUT_EVENT_KINK) {
      find_piece(model, state, stepper, k, t);
      changed = true;
    } else if (stepper->laws.item[k].event == STRUT_EVENT_THRESHOLD) {
      int32_t i = stepper->laws.item[k].kink - 1;
      if (i < 0 || stepper->kinks.side[i] != 0.0) continue;
      double margin = stepper->now->tension[k], rate = stepper->now->stretch_rate[k];
      stepper->kinks.side[i] = margin < 0.0 || (margin == 0.0 && rate < 0.0) ? -1.0 : 1.0;
      stepper->kinks.largest[i] = fabs(margin);
      changed = true;
    } else if (stepper->laws.item[k].event > STRUT_EVENT_THRESHOLD) {
      continue;
    } else if (stepper->laws.item[k].event != STRUT_EVENT_ACTS) {
      strut_history_start(model, state, stepper, k);
      changed = true;
    } else if (!(stepper->now->stretch[k] > 0.0 && stepper->now->tension[k] > 0.0)) {
      strut_cable_set_acting(state, stepper, k, false);
      changed = true;
    }
  }
  if (changed) strut_modes_derive(model, state, stepper, t);
}

void strut_modes_after_jump(const strut_model *model, strut_state *state,
                            strut_event_stepper *stepper, double t) {
  stepper->fresh = false;
  start_laws(model, state, stepper, t);
}

void strut_modes_start(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                       double t) {
  stepper->fresh = false;
  state->modes.kinks = stepper->kinks.count ? &stepper->kinks : NULL;
  for (int32_t i = 0; i < stepper->kinks.count; i++) stepper->kinks.side[i] = 0.0;
  strut_surface_move(model, state, stepper->now, t);
  for (int32_t i = 0; i < model->contacts.count; i++) {
    strut_touch o;
    stepper->modes.of[i] = STRUT_MODE_OPEN;
    measure_at_end(&model->contacts, &stepper->modes, stepper->now, i, STRUT_TERMS_ALL, &o);
    if (o.gap < 0.0 || (o.gap == 0.0 && o.into <= 0.0)) strut_contact_close(model, stepper, i, -1);
  }
  start_laws(model, state, stepper, t);
}

bool strut_modes_after_step(const strut_model *model, strut_event_stepper *stepper) {
  bool changed = false;
  for (int32_t k = 0; k < stepper->active.closed_count && !stepper->formula->exact; k++) {
    int32_t i = stepper->active.closed[k];
    if (!(stepper->now->touch[i].gap > 0.0)) continue;
    stepper->modes.of[i] = STRUT_MODE_OPEN;
    changed = true;
  }
  if (changed) strut_update_active_set(model, stepper);
  return changed;
}
