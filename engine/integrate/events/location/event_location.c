/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finding what ends a mode within a step. See event_stepping.h. */
#include <assert.h>
#include <math.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/nearby.h"
#include "engine/integrate/events/event_kernel.h"

/* A ground damper this much weaker than the whole reaction is rounding, whatever its sign. */
static const double FAINT = 1e-11;

double strut_event_cubic_root(double g0, double d0, double g1, double d1) {
  double low = 0.0, high = 1.0, x = g0 / (g0 - g1);
  for (int k = 0; k < 60 && high - low > 1e-15; k++) {
    double r = 1.0 - x;
    double value = g0 * (1.0 + 2.0 * x) * r * r + d0 * x * r * r + g1 * x * x * (3.0 - 2.0 * x) -
                   d1 * x * x * r;
    double slope = 6.0 * x * r * (g1 - g0) + d0 * r * (r - 2.0 * x) + d1 * x * (x - 2.0 * r);
    *(value > 0.0 ? &low : &high) = x;
    double next = x - value / slope;
    if (fabs(next - x) <= 1e-15) break; /* before the bracket is asked, which x itself bounds */
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    x = next;
  }
  return x;
}

/*
 * How far contact i is from leaving its band, where that is `room` by its speed. A band entered just now
 * has its edge, but for rounding, where the step begins; so has one at whose edge the forces balance: it
 * is left when they cease to, not before.
 */
static double room_to_leave(const strut_event_stepper *stepper, int32_t i, double room) {
  const strut_contact_entry *contact = &stepper->contacts.entry[i];
  if (!stepper->formula->exact && !strut_friction_drops(&contact->friction)) return room;
  double faint = 1e-9 * stick_band_edge(contact), rate = 0.0;
  double balanced =
      STRUT_TIED * stepper->now->touch[i].normal * stepper->contacts.compliance[i].tangent;
  strut_event_rate(stepper, stepper->now, STRUT_EVENT_LEAVES_STICK_BAND, i, &rate);
  return room < faint && rate > -balanced ? faint : room;
}

/*
 * How far an event is, whose value is `room` where the step begins, with this rate, and `after` at its end. A mode that
 * begins there, but for rounding, and lasts at first, ends where the value has come back; one that does not last ends
 * at once, on whichever side of 0 rounding has left it.
 */
static double room_to_last(double least, double room, double rate, double after) {
  double begins = fmax(least, -1e-12 * after);
  return room > begins ? room : rate > 0.0 ? begins : 0.0;
}

/* Rates of the event's value at both ends of the step; false where a secant must do. */
static bool rates_of(const strut_model *model, const strut_event_stepper *stepper,
                     strut_event_kind kind, int32_t i, double h, double *d0, double *d1) {
  if (kind == STRUT_EVENT_TOUCH) {
    strut_touch a, b;
    measure_at_end(&model->contacts, &stepper->modes, stepper->now, i, STRUT_TERMS_ALL, &a);
    measure_at_end(&model->contacts, &stepper->modes, stepper->next, i, STRUT_TERMS_ALL, &b);
    *d0 = h * a.into, *d1 = h * b.into;
    return true;
  }
  if (!strut_event_rate(stepper, stepper->now, kind, i, d0) ||
      !strut_event_rate(stepper, stepper->next, kind, i, d1))
    return false;
  *d0 *= h, *d1 *= h;
  return true;
}

/* Where between now and next the event's value passes 0. */
static double fraction_of(const strut_model *model, const strut_event_stepper *stepper,
                          strut_event_kind kind, int32_t i, double h) {
  double g0 = strut_event_value(model, stepper, stepper->now, kind, i), d0, d1;
  double g1 = strut_event_value(model, stepper, stepper->next, kind, i);
  bool rated = rates_of(model, stepper, kind, i, h, &d0, &d1),
       slips = kind == STRUT_EVENT_SLIP_ENDS;
  double edge = slips ? stick_band_edge(&stepper->contacts.entry[i]) : 0.0;
  if (kind == STRUT_EVENT_LEAVES_STICK_BAND)
    g0 = room_to_leave(stepper, i, g0);
  else if (rated && !strut_event_is_of_law(kind) &&
           (stepper->formula->exact || (slips && edge == 0.0)))
    g0 = room_to_last(1e-9 * edge, g0, d0, g1);
  if (!(g0 > 0.0)) return 0.0;
  return rated ? strut_event_cubic_root(g0, d0, g1, d1) : g0 / (g0 - g1);
}

static void keep_first(const strut_model *model, const strut_event_stepper *stepper,
                       strut_event_kind kind, int32_t i, double h, strut_event *first) {
  double fraction = fraction_of(model, stepper, kind, i, h);
  if (first->kind && fraction >= first->fraction) return;
  *first = (strut_event){kind, i, fraction};
}

static void measure_cable(const strut_model *model, const strut_state *state,
                          const strut_law_switch *law, const strut_step_end *end, int32_t k) {
  const strut_member_table *members = &model->members;
  int32_t j = law->member;
  strut_member_pose pose = strut_member_pose_at(members, state->latest->rest, j, end->q);
  end->stretch[k] = pose.stretch;
  end->stretch_rate[k] = strut_member_rate(members, j, &pose, end->v) - state->latest->rest_rate[j];
  end->tension[k] =
      members->stiffness[j] * pose.stretch + members->damping[j] * end->stretch_rate[k];
}

/* Of an element that carries one sign, with that sign; of kinks, the margins of the piece. */
static void measure_element(const strut_model *model, const strut_state *state,
                            const strut_law_switch *law, const strut_step_end *end, int32_t k) {
  assert(k >= 0);
  const strut_element *element = &model->elements.element[law->element];
  strut_element_motion m = strut_element_move(model, state, law->element, end->q, end->v);
  if (law->event == STRUT_EVENT_ACTS) {
    end->stretch[k] = element->carries * m.stretch;
    end->stretch_rate[k] = element->carries * m.rate;
    end->tension[k] = element->carries * m.force;
    return;
  }
  int piece = state->modes.element_piece[law->element];
  double low, high;
  strut_law_margins(element->law, &element->numbers, piece, m.stretch, &low, &high);
  end->stretch[k] = m.stretch;
  end->stretch_rate[k] = m.rate;
  end->tension[k] = fmin(low, high);
}

/* The sensors are those of the end. */
static void measure_threshold(const strut_model *model, const strut_state *state,
                              const strut_law_switch *law, const strut_step_end *end, int32_t k) {
  assert(k >= 0);
  double now = state->latest->drive_time + state->time_offset;
  if (law->kink) {
    strut_drive_signal(model, state, end->v, law->signal - 1, now);
    end->tension[k] = end->stretch[k] = state->modes.kinks->margin[law->kink - 1];
    end->stretch_rate[k] = state->modes.kinks->rate[law->kink - 1];
    return;
  }
  end->tension[k] =
      strut_threshold_margin(model, state, law->signal - 1, now, end->v, &end->stretch_rate[k]);
  end->stretch[k] = end->tension[k];
}

/* The rest lengths are those of the end. */
static void measure_laws(const strut_model *model, const strut_state *state,
                         const strut_event_stepper *stepper, const strut_step_end *end) {
  for (int32_t n = 0, laws = strut_laws_of(&stepper->laws); n < laws; n++) {
    int32_t k = strut_law_of(&stepper->laws, n);
    const strut_law_switch *law = &stepper->laws.item[k];
    if (law->event == STRUT_EVENT_TURN) break;
    if (law->event == STRUT_EVENT_THRESHOLD)
      measure_threshold(model, state, law, end, k);
    else if (law->event >= STRUT_EVENT_SLIDER || law->whole)
      strut_history_measure(model, state, stepper, end, k);
    else if (law->member >= 0)
      measure_cable(model, state, law, end, k);
    else
      measure_element(model, state, law, end, k);
  }
  if (stepper->turns.on) strut_turns_measure(stepper, end);
}

/* Do bodies of a collision exert what the law says? Only laws of collisions may be left out of a list. */
static bool is_of_collision(const strut_model *model, const strut_law_switch *law) {
  return law->element >= 0 && model->elements.element[law->element].role == STRUT_ELEMENT_COLLISION;
}

/* Laws that may switch at `end`, in stepper->laws.nearby; those that have come near are measured at both ends. */
static void list_nearby(const strut_model *model, const strut_state *state,
                        strut_event_stepper *stepper, const strut_step_end *end) {
  const strut_nearby *near = strut_nearby_at(model, state, end->q);
  if (stepper->laws.nearby_made == near->made) return;
  stepper->laws.nearby_made = near->made;
  stepper->laws.nearby_count = 0;
  int32_t next = 0;
  for (int32_t k = 0; k < stepper->laws.count; k++) {
    const strut_law_switch *law = &stepper->laws.item[k];
    if (is_of_collision(model, law)) {
      while (next < near->count && near->element[next] < law->element) next++;
      if (next == near->count || near->element[next] != law->element) continue;
      measure_element(model, state, law, stepper->now, k);
      measure_element(model, state, law, stepper->next, k);
    }
    stepper->laws.nearby[stepper->laws.nearby_count++] = k;
  }
}

void strut_event_measure(const strut_model *model, const strut_state *state,
                         strut_event_stepper *stepper, const strut_step_end *end) {
  if (!stepper->laws.count) return;
  if (stepper->laws.nearby) list_nearby(model, state, stepper, end);
  measure_laws(model, state, stepper, end);
}

void strut_event_part_all(const strut_model *model, strut_state *state,
                          strut_event_stepper *stepper) {
  strut_law_switches *laws = &stepper->laws;
  for (int32_t k = 0; k < laws->count; k++)
    if (is_of_collision(model, &laws->item[k])) strut_cable_set_acting(state, stepper, k, false);
  laws->nearby_made = 0;
  list_nearby(model, state, stepper, stepper->now);
}

/* Is a member or a contact, so far beyond where it begins or ceases to act, and at this speed, at rest there? */
static bool grazes(const strut_event_stepper *stepper, double beyond, double speed, double h) {
  return is_at_rest(stepper, speed, h) &&
         is_at_rest(stepper, beyond * stepper->control.frequency, h);
}

/* Likewise contact i, whose friction multiplies what its gap leaves open. */
static bool touch_grazes(const strut_event_stepper *stepper, int32_t i, const strut_touch *touch,
                         double h) {
  double rubs = 1.0 + stepper->contacts.entry[i].friction.mu_kinetic;
  return grazes(stepper, rubs * touch->gap, touch->into, h);
}

/* Whether an open contact whose gap is below 0 at the step's end has come down to it. One that has just
   opened may stand below 0 by rounding, on its way up. */
static bool closes(const strut_contact_table *contacts, int32_t i,
                   const strut_event_stepper *stepper, double h) {
  strut_touch to;
  measure_at_end(contacts, &stepper->modes, stepper->next, i, STRUT_TERMS_ALL, &to);
  if (touch_grazes(stepper, i, &to, h)) return false;
  return to.into < 0.0 ||
         gap_at_end(contacts, &stepper->modes, i, stepper->now, STRUT_TERMS_ALL) > 0.0;
}

/* Has closed contact i left the ground by the end of the step, where it is at `o`, even if it is on its way down again?
   One that has just touched may be above the ground by rounding while it still moves down. */
static bool opens(const strut_event_stepper *stepper, int32_t i, const strut_touch *touch,
                  double h) {
  return touch->gap > 0.0 && (touch->into > 0.0 || stepper->now->touch[i].gap < 0.0) &&
         !touch_grazes(stepper, i, touch, h);
}

/* What ends a mode of contact i, if it comes before `first`. */
STRUT_INLINE void keep_first_of(const strut_model *model, const strut_event_stepper *stepper,
                                int32_t i, double h, unsigned terms, strut_event *first) {
  const strut_contact_modes *modes = &stepper->modes;
  const strut_contact_table *contacts = &model->contacts;
  if (modes->of[i] == STRUT_MODE_OPEN) {
    if (gap_at_end(contacts, modes, i, stepper->next, terms) < 0.0 &&
        closes(contacts, i, stepper, h))
      keep_first(model, stepper, STRUT_EVENT_TOUCH, i, h, first);
    return;
  }
  const strut_touch *touch = &stepper->next->touch[i];
  const strut_contact_entry *entry =
      terms & STRUT_TERM_SURFACES ? stepper->contacts.entry : contacts->entry;
  strut_event_kind kind = contradicting_event(&entry[i], modes, i, touch);
  if (kind) keep_first(model, stepper, kind, i, h, first);
  if (kind == STRUT_EVENT_LEAVES_STICK_BAND &&
      stepper->formula->exact) { /* it may be held before that */
    kind = event_within_band(&entry[i], modes, i, touch);
    if (kind) keep_first(model, stepper, kind, i, h, first);
  }
  int32_t nearest;
  if (frames_of(stepper->next, terms) &&
      strut_surface_facet_margin(contacts, modes, stepper->next, i, &nearest) < 0.0)
    keep_first(model, stepper, STRUT_EVENT_FACET, i, h, first);
  if (!stepper->formula->exact) return;
  if (opens(stepper, i, touch, h)) keep_first(model, stepper, STRUT_EVENT_OPEN, i, h, first);
  if (modes->damper[i] && (modes->damper[i] > 0 ? touch->into > 0.0 : touch->into < 0.0) &&
      contacts->entry[i].damping * fabs(touch->into) > FAINT * fabs(touch->normal) &&
      !is_at_rest(stepper, touch->into, h))
    keep_first(model, stepper, STRUT_EVENT_DAMPER, i, h, first);
}

/*
 * Has law k, whose value at the end of the step is `after`, been switched a rounding too early, and comes to where it
 * belongs? Of two laws that switch at once it would otherwise be switched back while the other one is located.
 */
static bool is_settling(const strut_model *model, const strut_event_stepper *stepper, int32_t k,
                        double after) {
  const strut_law_switch *law = &stepper->laws.item[k];
  double before = law_value(stepper, stepper->now, k);
  return law->event == STRUT_EVENT_ACTS && before < 0.0 && after >= before &&
         before > -FAINT * law->stiffness * model->size;
}

/*
 * Where an element whose strain has just passed a kink, on whichever side of it rounding has left it, comes back over
 * it, as a part of the step; `after`: its margin at the end. 0: it has not just passed one, or does not go on.
 */
static double kink_comes_back(const strut_model *model, const strut_state *state,
                              const strut_event_stepper *stepper, int32_t k, double h,
                              double after) {
  const strut_law_switch *law = &stepper->laws.item[k];
  if (law->event != STRUT_EVENT_KINK || stepper->now->tension[k] > 0.0) return 0.0;
  const strut_element *element = &model->elements.element[law->element];
  int piece = state->modes.element_piece[law->element];
  double low, high, way = strut_law_way(element->law, &element->numbers, piece);
  strut_law_margins(element->law, &element->numbers, piece, stepper->now->stretch[k], &low, &high);
  double sign = low < high ? way : -way, rate = h * sign * stepper->now->stretch_rate[k];
  double b[STRUT_MOST_GRADIENT], turn = state->history.turn[law->element];
  double noise = fabs(strut_element_strain(model, law->element, stepper->now->q, turn, b));
  double room = room_to_last(0.0, fmin(low, high), rate, after);
  if (!(room > 0.0 && rate > 0.0) || fmin(low, high) < -FAINT * noise) return 0.0;
  return strut_event_cubic_root(room, rate, after, h * sign * stepper->next->stretch_rate[k]);
}

/* What switches a law, if it comes before `first`. */
static void keep_first_of_laws(const strut_model *model, const strut_state *state,
                               strut_event_stepper *stepper, double h, strut_event *first) {
  strut_event_measure(model, state, stepper, stepper->next);
  int32_t laws = strut_laws_of(&stepper->laws);
  double faint = stepper->formula->adaptive ? stepper->control.tolerance : FAINT;
  for (int32_t k = 0; k < laws; k++) {
    int32_t j = strut_law_of(&stepper->laws, k);
    double after = law_value(stepper, stepper->next, j);
    if (!(after < 0.0) || is_settling(model, stepper, j, after)) continue;
    if (stepper->laws.item[j].event == STRUT_EVENT_TURN && !strut_turn_passes(model, stepper, j, h))
      continue;
    const strut_step_end *end = stepper->next;
    if (stepper->laws.item[j].member >= 0 &&
        grazes(stepper, end->stretch[j], end->stretch_rate[j], h))
      continue;
    int32_t kink = stepper->laws.item[j].kink;
    if (kink && -after <= faint * stepper->kinks.largest[kink - 1]) continue;
    double back = kink_comes_back(model, state, stepper, j, h, after);
    if (!(back > 0.0))
      keep_first(model, stepper, stepper->laws.item[j].event, j, h, first);
    else if (!first->kind || back < first->fraction)
      *first = (strut_event){STRUT_EVENT_KINK, j, back};
  }
}

/* Of `contacts` in a list and the laws of the stepper's list; NULL: of all contacts and laws. */
STRUT_INLINE strut_event first_event(const strut_model *model, const strut_state *state,
                                     strut_event_stepper *stepper, double h, const int32_t *list,
                                     int32_t contacts, unsigned terms) {
  strut_event first = {STRUT_EVENT_NONE, 0, 1.0};
  if (strut_turns_due(state, stepper)) strut_turns_look(model, state, stepper, h);
  for (int32_t k = 0; k < contacts; k++)
    keep_first_of(model, stepper, list ? list[k] : k, h, terms, &first);
  if (stepper->laws.count) keep_first_of_laws(model, state, stepper, h, &first);
  return first;
}

strut_event strut_event_first(const strut_model *model, const strut_state *state,
                              strut_event_stepper *stepper, double h) {
  if (model->contacts.surface)
    return first_event(model, state, stepper, h, state->buffers->near,
                       strut_surface_candidates(model, stepper, 0.0, state->buffers->near),
                       STRUT_TERMS_ALL);
  return first_event(model, state, stepper, h, NULL, model->contacts.count, STRUT_TERMS_COMMON);
}

/* First fraction in [0, 1] where gap + speed x + bend x^2 falls below 0; 2 if it does not. */
static double parabola_root(double gap, double speed, double bend) {
  if (!(gap > 0.0)) return speed < 0.0 || (speed == 0.0 && bend < 0.0) ? 0.0 : 2.0;
  double inside = speed * speed - 4.0 * bend * gap;
  if (!(inside >= 0.0)) return 2.0;
  double below = -speed + sqrt(inside);
  return below > 2.0 * gap ? 2.0 * gap / below : below == 2.0 * gap ? 1.0 : 2.0;
}

/* Where within the step contact i passes the ground, by the parabola that positions follow. */
static double crossing(const strut_model *model, const strut_state *state,
                       const strut_event_stepper *stepper, int32_t i, double sign, double h) {
  const strut_contact_table *contacts = &model->contacts;
  const strut_step_end *now = stepper->now;
  if (contacts->surface) {
    strut_touch o;
    strut_contact_frame frame;
    strut_surface_measure(contacts, &stepper->modes, now->motion, i, now->q, now->v, &o, &frame);
    strut_surface_measure_rates(contacts, i, now->a, &o, &frame);
    return parabola_root(sign * o.gap, sign * h * o.into, sign * 0.5 * h * h * o.into_rate);
  }
  double gap = strut_contact_gap(contacts, i, state->q),
         speed = h * strut_contact_along_normal(contacts, i, state->v);
  double bend = 0.5 * h * h * strut_contact_along_normal(contacts, i, stepper->now->a);
  return parabola_root(sign * gap, sign * speed, sign * bend);
}

strut_event strut_event_predict(const strut_model *model, const strut_state *state,
                                const strut_event_stepper *stepper, double h) {
  const strut_contact_table *contacts = &model->contacts;
  strut_event first = {STRUT_EVENT_NONE, 0, 1.0};
  bool surfaces = contacts->surface;
  int32_t count = surfaces ? strut_surface_candidates(model, stepper, 0.0, state->buffers->near)
                           : contacts->count;
  for (int32_t k = 0; k < count; k++) {
    int32_t i = surfaces ? state->buffers->near[k] : k;
    bool closed = stepper->modes.of[i] != STRUT_MODE_OPEN;
    double gap = gap_at_end(contacts, &stepper->modes, i, stepper->next, STRUT_TERMS_ALL);
    if (closed ? gap <= 0.0 : gap >= 0.0) continue;
    double fraction = crossing(model, state, stepper, i, closed ? -1.0 : 1.0, h);
    if (fraction <= 1.0 && (!first.kind || fraction < first.fraction))
      first = (strut_event){closed ? STRUT_EVENT_OPEN : STRUT_EVENT_TOUCH, i, fraction};
  }
  return first;
}

/* Where within a step an event is: its value by trials of parts of the step. See event_stepping.h. */

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
