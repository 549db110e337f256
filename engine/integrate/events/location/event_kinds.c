/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What each kind of event is: the value that ends a mode, its rate, and what follows. See STRUT_EVENT_KINDS. */
#include <assert.h>
#include <math.h>

#include "engine/integrate/events/event_kernel.h"

/* ---- values and rates ---- */

/* A row need not read all that its function is given. */
#define MAYBE __attribute__((unused))

#define VALUE(name)                                                                                \
  static double name(MAYBE const strut_model *model, MAYBE const strut_event_stepper *stepper,     \
                     MAYBE const strut_step_end *end, MAYBE int32_t i)
#define RATE(name)                                                                                 \
  static double name(MAYBE const strut_event_stepper *stepper, const strut_step_end *end, int32_t i)

VALUE(no_end) { return 1.0; }
VALUE(gap) { return gap_at_end(&model->contacts, &stepper->modes, i, end, STRUT_TERMS_ALL); }
VALUE(depth) { return -gap_at_end(&model->contacts, &stepper->modes, i, end, STRUT_TERMS_ALL); }
RATE(depth_rate) { return -end->touch[i].into; }
VALUE(slip_left) {
  return margin_of_slip(&stepper->contacts.entry[i], &end->touch[i], stepper->modes.side[i]);
}
RATE(slip_rate) { return stepper->modes.side[i] * end->touch[i].slip_rate; }

/*
 * The edge of the band by which contact i leaves: that of the step's end, which may be beyond the one
 * by which it came in, where the step begins. Methods that are not exact take each end's own: a band
 * narrower than a step they pass in a step of its own, which smooths their period map.
 */
static double way_out(const strut_event_stepper *stepper, const strut_touch *touch, int32_t i) {
  double slip = stepper->formula->exact ? stepper->next->touch[i].slip : touch->slip;
  return slip < 0.0 ? -1.0 : 1.0;
}

VALUE(band_left) {
  const strut_touch *touch = &end->touch[i];
  return margin_of_band(&stepper->contacts.entry[i], way_out(stepper, touch, i) * touch->slip);
}
RATE(band_rate) {
  const strut_touch *touch = &end->touch[i];
  return -way_out(stepper, touch, i) * touch->slip_rate;
}
VALUE(stick_left) { return margin_of_stick(&stepper->contacts.entry[i], &end->touch[i]); }
VALUE(creep_out_left) {
  return margin_of_creep_out(&stepper->contacts.entry[i], &end->touch[i], stepper->modes.side[i]);
}

/*
 * Where the other forces pass what friction holds, friction inside the band drops, and the margin jumps. How
 * far they are from there bounds it on both sides, so that a search for its root is led to the jump.
 */
VALUE(creep_in_left) {
  const strut_touch *touch = &end->touch[i];
  double margin = margin_of_creep_in(&stepper->contacts.entry[i], touch, stepper->modes.side[i]);
  if (!strut_friction_drops(&stepper->contacts.entry[i].friction)) return margin;
  double room = margin_of_push(&stepper->contacts.entry[i], touch, STRUT_MODE_BAND, 0.0);
  return room > 0.0 ? fmin(room, margin) : fmax(room, margin);
}
VALUE(push_left) {
  return margin_of_push(&stepper->contacts.entry[i], &end->touch[i], stepper->modes.of[i],
                        stepper->modes.side[i]);
}
VALUE(yield_left) { return margin_of_yield(&stepper->contacts.entry[i], &end->touch[i]); }
VALUE(speed_left) {
  return stepper->modes.damper[i] > 0 ? -end->touch[i].into : end->touch[i].into;
}
RATE(speed_rate) {
  return stepper->modes.damper[i] > 0 ? -end->touch[i].into_rate : end->touch[i].into_rate;
}
VALUE(facet_left) {
  int32_t nearest;
  return strut_surface_facet_margin(&model->contacts, &stepper->modes, end, i, &nearest);
}
VALUE(of_law) { return law_value(stepper, end, i); }
RATE(turn_rate) { return end->stretch_rate[i]; }

/* ---- what follows ---- */

#define EFFECT(name)                                                                               \
  static void name(MAYBE const strut_model *model, MAYBE strut_state *state,                       \
                   MAYBE strut_event_stepper *stepper, MAYBE int32_t i, MAYBE double t)

/*
 * At the edge of Karnopp's band, u = s delta: outside friction is -s mu N, inside it balances. The
 * node goes where the acceleration on that side leads; where both lead to the edge it creeps along.
 */
static void decide_at_edge(const strut_model *model, const strut_state *state,
                           strut_event_stepper *stepper, int32_t i, bool from_inside, double t) {
  strut_contact_modes *modes = &stepper->modes;
  const strut_contact_entry *contact = &stepper->contacts.entry[i];
  double s = modes->side[i];
  strut_contact_snap(model, stepper, i, s * contact->friction.stick_velocity);
  modes->of[i] = STRUT_MODE_SLIP;
  strut_update_active_set(model, stepper);
  strut_evaluate_acceleration(model, state, stepper, t);
  const strut_touch *touch = &stepper->now->touch[i];
  double outside = s * touch->slip_rate;
  double most = strut_friction_static(&contact->friction, touch->applied) * touch->normal;
  bool pushed = fabs(touch->applied) >= most;
  modes->of[i] =
      pushed && strut_friction_drops(&contact->friction) ? STRUT_MODE_PUSH : STRUT_MODE_BAND;
  modes->side[i] = (int8_t)(modes->of[i] == STRUT_MODE_PUSH ? strut_sign(touch->applied) : s);
  strut_update_active_set(model, stepper);
  strut_evaluate_acceleration(model, state, stepper, t);
  double inside = s * stepper->now->touch[i].slip_rate;
  if (inside < 0.0 && (outside < 0.0 || !from_inside)) return;
  modes->side[i] = (int8_t)s;
  modes->of[i] = outside > 0.0 ? STRUT_MODE_SLIP : STRUT_MODE_CREEP;
}

/* Contact i by what pushes it along the ground; without a normal force yet, by forces a step later. */
static const strut_touch *pushed_touch(const strut_event_stepper *stepper, int32_t i) {
  return stepper->now->touch[i].normal > 0.0 ? &stepper->now->touch[i] : &stepper->next->touch[i];
}
static int8_t side_of_push(const strut_event_stepper *stepper, int32_t i) {
  return pushed_touch(stepper, i)->applied < 0.0 ? -1 : 1;
}

EFFECT(no_effect) {}
EFFECT(close_nearest) {
  double time = stepper->control.refine_time > 0.0
                    ? stepper->control.refine_time
                    : stepper->control.refine_memory * stepper->contacts.settling_time[i];
  strut_contact_close(model, stepper, i, -1);
  state->refined_until = fmax(state->refined_until, t + time);
}
EFFECT(open) { stepper->modes.of[i] = STRUT_MODE_OPEN; }
EFFECT(end_slip) {
  if (stick_band_edge(&stepper->contacts.entry[i]) > 0.0) {
    decide_at_edge(model, state, stepper, i, false, t);
  } else {
    strut_contact_snap(model, stepper, i, 0.0);
    stepper->modes.of[i] = STRUT_MODE_STICK;
  }
}
EFFECT(leave_band) {
  stepper->modes.side[i] = stepper->now->touch[i].slip < 0.0 ? -1 : 1;
  decide_at_edge(model, state, stepper, i, true, t);
}
EFFECT(break_stick) {
  stepper->modes.side[i] = pushed_touch(stepper, i)->friction > 0.0 ? -1 : 1;
  stepper->modes.of[i] = STRUT_MODE_SLIP;
}
EFFECT(creep_out) { stepper->modes.of[i] = STRUT_MODE_SLIP; }
EFFECT(creep_in) {
  const strut_contact_entry *contact = &stepper->contacts.entry[i];
  const strut_touch *touch = &stepper->now->touch[i];
  /* which of the two has ended it: the forces inside the band still push out of it where that is the jump */
  bool pushed = strut_friction_drops(&contact->friction) &&
                margin_of_push(contact, touch, STRUT_MODE_BAND, 0.0) <
                    fmax(0.0, stepper->modes.side[i] * (-touch->applied - touch->friction));
  stepper->modes.of[i] = pushed ? STRUT_MODE_PUSH : STRUT_MODE_BAND;
  if (pushed) stepper->modes.side[i] = side_of_push(stepper, i);
}
EFFECT(push) {
  /* back and forth without a step between: the threshold attracts from both sides */
  if (stepper->chatter.pushed == i && stepper->chatter.pushed_at == t)
    stepper->modes.of[i] = STRUT_MODE_YIELD;
  else
    stepper->modes.of[i] =
        stepper->modes.of[i] == STRUT_MODE_BAND ? STRUT_MODE_PUSH : STRUT_MODE_BAND;
  stepper->chatter.pushed = i, stepper->chatter.pushed_at = t;
  stepper->modes.side[i] = side_of_push(stepper, i);
}
EFFECT(end_yield) {
  const strut_touch *touch = &stepper->now->touch[i];
  const strut_friction *friction = &stepper->contacts.entry[i].friction;
  bool over =
      fabs(touch->applied) > strut_friction_static(friction, touch->applied) * touch->normal;
  stepper->modes.of[i] = over ? STRUT_MODE_PUSH : STRUT_MODE_BAND;
  stepper->modes.side[i] = side_of_push(stepper, i);
}
EFFECT(turn_damper) { stepper->modes.damper[i] = (int8_t)-stepper->modes.damper[i]; }
EFFECT(act) {
  strut_cable_set_acting(state, stepper, i, !stepper->laws.acting[i]);
  if (stepper->laws.item[i].whole) strut_history_apply(model, state, stepper, i, t);
}
EFFECT(pass_kink) { strut_law_pass_kink(model, state, stepper, i, t); }
EFFECT(remember) { strut_history_apply(model, state, stepper, i, t); }
EFFECT(turn) { strut_turn_round(model, state, stepper, i, t); }
EFFECT(change_facet) {
  int32_t nearest;
  strut_surface_facet_margin(&model->contacts, &stepper->modes, stepper->now, i, &nearest);
  strut_contact_close(model, stepper, i, nearest);
}

/* ---- the table ---- */

typedef enum owner { CONTACT, LAW } owner;

typedef struct event_row {
  owner of;
  double (*value)(const strut_model *model, const strut_event_stepper *stepper,
                  const strut_step_end *end, int32_t i);
  double (*rate)(const strut_event_stepper *stepper, const strut_step_end *end, int32_t i);
  void (*effect)(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                 int32_t i, double t);
} event_row;

static const event_row rows[] = {
#define STRUT_EVENT_ROW(NAME, of, value, rate, effect)                                             \
  [STRUT_EVENT_##NAME] = {of, value, rate, effect},
    STRUT_EVENT_KINDS(STRUT_EVENT_ROW)
#undef STRUT_EVENT_ROW
};

bool strut_event_is_of_law(strut_event_kind kind) { return rows[kind].of == LAW; }

double strut_event_value(const strut_model *model, const strut_event_stepper *stepper,
                         const strut_step_end *end, strut_event_kind kind, int32_t i) {
  assert(kind == STRUT_EVENT_NONE ||
         i < (strut_event_is_of_law(kind) ? stepper->laws.count : model->contacts.count));
  return rows[kind].value(model, stepper, end, i);
}

bool strut_event_rate(const strut_event_stepper *stepper, const strut_step_end *end,
                      strut_event_kind kind, int32_t i, double *rate) {
  assert(i >= 0);
  if (!rows[kind].rate) return false;
  *rate = rows[kind].rate(stepper, end, i);
  return true;
}

void strut_event_apply(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                       strut_event event, double t) {
  rows[event.kind].effect(model, state, stepper, event.index, t);
  strut_modes_derive(model, state, stepper, t);
}
