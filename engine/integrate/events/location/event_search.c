/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where within a step an event is: its value by trials of parts of the step. See event_stepping.h. */
#include <math.h>

#include "engine/integrate/events/event_kernel.h"

enum { MOST_TRIALS = 100 };

/* Where forces balance until then, an edge is left so gently that this part of a step is harmless. */
static const double BALANCED = 1e-8;

/* Where a value passes 0: between low and high, and the latest two points of the search. */
typedef struct search {
  double low, high;
  double x, value, last_x, last_value, size_before; /* the size of the value before the last one */
  double size_at_ends;                              /* of the step in which the event was found */
} search;

static double value_at(const strut_model *model, const strut_event_stepper *stepper,
                       const strut_step_end *end, const strut_event *event) {
  return strut_event_value(model, stepper, end, event->kind, event->index);
}

/* Of an event found in the first `part` of the step, at whose end stepper->next is. */
static search begin_search(const strut_model *model, const strut_event_stepper *stepper,
                           const strut_event *event, double part) {
  double before = value_at(model, stepper, stepper->now, event),
         after = value_at(model, stepper, stepper->next, event);
  return (search){.high = part,
                  .x = part * event->fraction,
                  .last_x = before > 0.0 ? 0.0 : part,
                  .last_value = before > 0.0 ? before : after,
                  .size_before = HUGE_VAL,
                  .size_at_ends = fabs(before) + fabs(after)};
}

/*
 * Narrows the bracket at x and returns `next`, or the middle of the bracket where that is outside, and where two
 * steps have not made the value half as large: at a kink secants creep on from both sides.
 */
static double narrow(search *self, double next) {
  bool slow = fabs(self->value) > 0.5 * self->size_before;
  *(self->value < 0.0 ? &self->high : &self->low) = self->x;
  self->size_before = fabs(self->last_value);
  self->last_x = self->x, self->last_value = self->value;
  return next > self->low && next < self->high && !slow ? next : 0.5 * (self->low + self->high);
}

/* The latest correction was small and did not make the value smaller: the rest is rounding. */
static bool is_stagnant(const search *self) {
  return fabs(self->x - self->last_x) <= 1e-6 && fabs(self->value) > 0.1 * fabs(self->last_value);
}

/* Does a creeping contact balance the other forces, within STRUT_TIED? friction_in_creep lets it come no nearer. */
static bool is_balanced(const strut_event_stepper *stepper, const strut_event *event,
                        double value) {
  return event->kind == STRUT_EVENT_CREEP_IN &&
         fabs(value) <= 1.5 * STRUT_TIED * stepper->next->touch[event->index].normal;
}

/* Is the speed at the edge of the band, within STRUT_TIED? settle_band_ties keeps it no nearer. */
static bool is_at_edge(const strut_model *model, const strut_event *event, double value) {
  if (event->kind != STRUT_EVENT_LEAVES_STICK_BAND) return false;
  double tie = STRUT_TIED * stick_band_edge(&model->contacts.entry[event->index]);
  return value > 0.5 * tie && value < 1.5 * tie;
}

/* Moves x on, after a trial up to there; false where it is near enough to the root. */
static bool move_on(const strut_model *model, const strut_state *state,
                    const strut_event_stepper *stepper, const strut_event *event, double h,
                    bool first, search *self) {
  double rate = 0.0;
  self->value = value_at(model, stepper, stepper->next, event);
  if (strut_event_rate(stepper, stepper->next, event->kind, event->index, &rate)) rate *= h;
  double slope = rate != 0.0 ? rate : (self->value - self->last_value) / (self->x - self->last_x);
  if (fabs(self->value) <= 1e-13 * fabs(slope)) return false;
  bool edge = is_at_edge(model, event, self->value);
  /* forces that balance keep the speed there for a while: the value stays small, but has no root nearby */
  bool tied = edge && band_forces_balance(&stepper->contacts.compliance[event->index],
                                          &stepper->next->touch[event->index]);
  if (edge && !tied) return false;
  /* variations need a point from which the value changes */
  if (!state->watched.variation && is_balanced(stepper, event, self->value)) return false;
  /* a value that is not small beside those of the step's ends jumps, or has its root farther on, however little the
     search has moved */
  bool still = !first && !tied && is_stagnant(self),
       far = fabs(self->value) > 0.1 * self->size_at_ends;
  if (self->value == 0.0 || (still && !far)) return false;
  if (tied && self->high - self->x <= BALANCED) return false;
  double x = narrow(self, self->x - self->value / slope);
  if (tied || still) x = 0.5 * (self->low + self->high);
  if (self->high - self->low <= 1e-13) return false;
  self->x = x;
  return true;
}

double strut_event_locate(const strut_model *model, const strut_state *state,
                          strut_event_stepper *stepper, double t, double h, strut_event *event) {
  const strut_step_formula *formula = stepper->formula;
  search s = begin_search(model, stepper, event, 1.0);
  double reached = 1.0; /* the part of the step at whose end stepper->next is */
  for (int k = 0; k < MOST_TRIALS && s.x * h > 0.0; k++) {
    if (formula->predict) formula->predict(model, stepper, s.x * h);
    formula->trial(model, state, stepper, t, s.x * h);
    reached = s.x;
    if (!formula->exact) break;
    strut_event other = strut_event_first(model, state, stepper, s.x * h);
    bool same = other.kind == event->kind && other.index == event->index;
    if (other.kind && !same) { /* another one comes first */
      *event = other;
      s = begin_search(model, stepper, event, s.x);
    } else if (!move_on(model, state, stepper, event, h, k == 0, &s)) {
      break;
    }
  }
  return s.x * h > 0.0 ? reached * h : 0.0;
}
