/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What each kind of event is: the value that ends a mode, its rate, and what follows. See STRUT_EVENT_KINDS. */
#include <assert.h>
#include <math.h>

#include "engine/integrate/events/event_kernel.h"

/* ---- values and rates ---- */

/* A row need not read all that its function is given. */
#define MAYBE __attribute__((unused))

#define VALUE(name)                                                                                \
  static double name(MAYBE const strut_model *model, MAYBE const strut_event_stepper *l,           \
                     MAYBE const strut_step_end *end, MAYBE int32_t i)
#define RATE(name)                                                                                 \
  static double name(MAYBE const strut_event_stepper *l, const strut_step_end *end, int32_t i)

VALUE(no_end) { return 1.0; }
VALUE(gap) { return gap_at_end(&model->contacts, l, i, end, STRUT_TERMS_ALL); }
VALUE(depth) { return -gap_at_end(&model->contacts, l, i, end, STRUT_TERMS_ALL); }
RATE(depth_rate) { return -end->touch[i].into; }
VALUE(slip_left) {
  return strut_law_margin_of_slip(l->side[i], end->touch[i].slip, stick_band_edge(&l->entry[i]));
}
RATE(slip_rate) { return l->side[i] * end->touch[i].slip_rate; }

/*
 * The edge of the band by which contact i leaves: that of the step's end, which may be beyond the one
 * by which it came in, where the step begins. Steppers that are not exact take each end's own: a band
 * narrower than a step they pass in a step of its own, which smooths their period map.
 */
static double way_out(const strut_event_stepper *l, const strut_touch *o, int32_t i) {
  double slip = l->stepper->exact ? l->next->touch[i].slip : o->slip;
  return slip < 0.0 ? -1.0 : 1.0;
}

VALUE(band_left) {
  const strut_touch *o = &end->touch[i];
  return strut_law_margin_of_band(way_out(l, o, i) * o->slip, stick_band_edge(&l->entry[i]));
}
RATE(band_rate) {
  const strut_touch *o = &end->touch[i];
  return -way_out(l, o, i) * o->slip_rate;
}
VALUE(stick_left) { return margin_of_stick(&l->entry[i], &end->touch[i]); }
VALUE(creep_out_left) { return margin_of_creep_out(&l->entry[i], &end->touch[i], l->side[i]); }

/*
 * Where the other forces pass what friction holds, friction inside the band drops, and the margin jumps. How
 * far they are from there bounds it on both sides, so that a search for its root is led to the jump.
 */
VALUE(creep_in_left) {
  const strut_touch *o = &end->touch[i];
  double margin = margin_of_creep_in(&l->entry[i], o, l->side[i]);
  if (!strut_friction_drops(&l->entry[i].friction)) return margin;
  double room = margin_of_push(&l->entry[i], o, STRUT_MODE_BAND, 0.0);
  return room > 0.0 ? fmin(room, margin) : fmax(room, margin);
}
VALUE(push_left) { return margin_of_push(&l->entry[i], &end->touch[i], l->mode[i], l->side[i]); }
VALUE(yield_left) { return margin_of_yield(&l->entry[i], &end->touch[i]); }
VALUE(speed_left) { return l->damper[i] > 0 ? -end->touch[i].into : end->touch[i].into; }
RATE(speed_rate) { return l->damper[i] > 0 ? -end->touch[i].into_rate : end->touch[i].into_rate; }
VALUE(facet_left) {
  int32_t nearest;
  return strut_surface_facet_margin(&model->contacts, l, end, i, &nearest);
}
VALUE(of_law) { return law_value(l, end, i); }

/* ---- what follows ---- */

#define EFFECT(name)                                                                               \
  static void name(MAYBE const strut_model *model, MAYBE strut_state *state,                       \
                   MAYBE strut_event_stepper *l, MAYBE int32_t i, MAYBE double t)

/*
 * At the edge of Karnopp's band, u = s delta: outside friction is -s mu N, inside it balances. The
 * node goes where the acceleration on that side leads; where both lead to the edge it creeps along.
 */
static void decide_at_edge(const strut_model *model, strut_state *state, strut_event_stepper *l,
                           int32_t i, bool from_inside, double t) {
  const strut_contact_entry *e = &l->entry[i];
  double s = l->side[i];
  strut_contact_snap(model, l, i, s * e->friction.stick_velocity);
  l->mode[i] = STRUT_MODE_SLIP;
  strut_update_active_set(model, l);
  strut_evaluate_acceleration(model, state, l, t);
  const strut_touch *o = &l->now->touch[i];
  double outside = s * o->slip_rate;
  double most = strut_friction_static(&e->friction, o->applied) * o->normal;
  bool pushed = fabs(o->applied) >= most;
  l->mode[i] = pushed && strut_friction_drops(&e->friction) ? STRUT_MODE_PUSH : STRUT_MODE_BAND;
  l->side[i] = (int8_t)(l->mode[i] == STRUT_MODE_PUSH ? strut_sign(o->applied) : s);
  strut_update_active_set(model, l);
  strut_evaluate_acceleration(model, state, l, t);
  double inside = s * l->now->touch[i].slip_rate;
  if (inside < 0.0 && (outside < 0.0 || !from_inside)) return;
  l->side[i] = (int8_t)s;
  l->mode[i] = outside > 0.0 ? STRUT_MODE_SLIP : STRUT_MODE_CREEP;
}

/*
 * Contact i by what pushes it along the ground. Without a normal force yet, other forces may begin just now:
 * those a step later say.
 */
static const strut_touch *pushed_touch(const strut_event_stepper *l, int32_t i) {
  return l->now->touch[i].normal > 0.0 ? &l->now->touch[i] : &l->next->touch[i];
}
static int8_t side_of_push(const strut_event_stepper *l, int32_t i) {
  return pushed_touch(l, i)->applied < 0.0 ? -1 : 1;
}

EFFECT(no_effect) {}
EFFECT(close_nearest) {
  double time = l->refine_time > 0.0 ? l->refine_time : l->refine_memory * l->settling_time[i];
  strut_contact_close(model, l, i, -1);
  state->refined_until = fmax(state->refined_until, t + time);
}
EFFECT(open) { l->mode[i] = STRUT_MODE_OPEN; }
EFFECT(end_slip) {
  if (stick_band_edge(&l->entry[i]) > 0.0) {
    decide_at_edge(model, state, l, i, false, t);
  } else {
    strut_contact_snap(model, l, i, 0.0);
    l->mode[i] = STRUT_MODE_STICK;
  }
}
EFFECT(leave_band) {
  l->side[i] = l->now->touch[i].slip < 0.0 ? -1 : 1;
  decide_at_edge(model, state, l, i, true, t);
}
EFFECT(break_stick) {
  l->side[i] = pushed_touch(l, i)->friction > 0.0 ? -1 : 1;
  l->mode[i] = STRUT_MODE_SLIP;
}
EFFECT(creep_out) { l->mode[i] = STRUT_MODE_SLIP; }
EFFECT(creep_in) {
  const strut_contact_entry *e = &l->entry[i];
  const strut_touch *o = &l->now->touch[i];
  /* which of the two has ended it: the forces inside the band still push out of it where that is the jump */
  bool pushed =
      strut_friction_drops(&e->friction) && margin_of_push(e, o, STRUT_MODE_BAND, 0.0) <
                                                fmax(0.0, l->side[i] * (-o->applied - o->friction));
  l->mode[i] = pushed ? STRUT_MODE_PUSH : STRUT_MODE_BAND;
  if (pushed) l->side[i] = side_of_push(l, i);
}
EFFECT(push) {
  /* back and forth without a step between: the threshold attracts from both sides */
  if (l->pushed == i && l->pushed_at == t)
    l->mode[i] = STRUT_MODE_YIELD;
  else
    l->mode[i] = l->mode[i] == STRUT_MODE_BAND ? STRUT_MODE_PUSH : STRUT_MODE_BAND;
  l->pushed = i, l->pushed_at = t;
  l->side[i] = side_of_push(l, i);
}
EFFECT(end_yield) {
  const strut_touch *o = &l->now->touch[i];
  const strut_friction *f = &l->entry[i].friction;
  bool over = fabs(o->applied) > strut_friction_static(f, o->applied) * o->normal;
  l->mode[i] = over ? STRUT_MODE_PUSH : STRUT_MODE_BAND;
  l->side[i] = side_of_push(l, i);
}
EFFECT(turn_damper) { l->damper[i] = (int8_t)-l->damper[i]; }
EFFECT(act) {
  strut_cable_set_acting(state, l, i, !l->acting[i]);
  if (l->laws[i].whole) strut_history_apply(model, state, l, i, t);
}
EFFECT(pass_kink) { strut_law_pass_kink(model, state, l, i, t); }
EFFECT(remember) { strut_history_apply(model, state, l, i, t); }
EFFECT(change_facet) {
  int32_t nearest;
  strut_surface_facet_margin(&model->contacts, l, l->now, i, &nearest);
  strut_contact_close(model, l, i, nearest);
}

/* ---- the table ---- */

typedef enum owner { CONTACT, LAW } owner;

typedef struct event_row {
  owner of;
  double (*value)(const strut_model *model, const strut_event_stepper *l, const strut_step_end *end,
                  int32_t i);
  double (*rate)(const strut_event_stepper *l, const strut_step_end *end, int32_t i);
  void (*effect)(const strut_model *model, strut_state *state, strut_event_stepper *l, int32_t i,
                 double t);
} event_row;

static const event_row rows[] = {
#define STRUT_EVENT_ROW(NAME, of, value, rate, effect)                                             \
  [STRUT_EVENT_##NAME] = {of, value, rate, effect},
    STRUT_EVENT_KINDS(STRUT_EVENT_ROW)
#undef STRUT_EVENT_ROW
};

bool strut_event_is_of_law(strut_event_kind kind) { return rows[kind].of == LAW; }

double strut_event_value(const strut_model *model, const strut_event_stepper *l,
                         const strut_step_end *end, strut_event_kind kind, int32_t i) {
  assert(kind == STRUT_EVENT_NONE ||
         i < (strut_event_is_of_law(kind) ? l->law_count : model->contacts.count));
  return rows[kind].value(model, l, end, i);
}

bool strut_event_rate(const strut_event_stepper *l, const strut_step_end *end,
                      strut_event_kind kind, int32_t i, double *rate) {
  assert(i >= 0);
  if (!rows[kind].rate) return false;
  *rate = rows[kind].rate(l, end, i);
  return true;
}

void strut_event_apply(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       strut_event event, double t) {
  rows[event.kind].effect(model, state, l, event.index, t);
  strut_modes_derive(model, state, l, t);
}
