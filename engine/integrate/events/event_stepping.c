/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The steps of methods with events: from grid point to grid point, stopping where modes end. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/forces/energy.h"
#include "engine/forces/feedback.h"
#include "engine/forces/history.h"
#include "engine/forces/moving_masses.h"
#include "engine/integrate/events/event_kernel.h"
#include "engine/integrate/events/location/event_log.h"
#include "engine/integrate/events/location/variation.h"
#include "engine/integrate/observer.h"
#include "engine/model/compile_parts.h"

/* A root this close to where the step begins, in grid steps, is there already. */
static const double AT_ONCE = 1e-9;
/*
 * After so many switches of one contact or law without a step, or STRUT_MOST_SWITCHES of all, one is taken whatever
 * the modes say: switches may follow each other faster and faster without end (Zeno).
 */
enum { MOST_AT_ONCE = 8, MOST_TRIALS = 100, MOST_HALVINGS = 30 };

/* A step above this part of the one that the method wants separates switches from those before. */
static const double SEPARATES = 0.1;

/* What contacts of surfaces need beside the others. */
static bool make_frames(const strut_model *model, strut_arena *arena, strut_step_end *end) {
  const strut_contact_table *c = &model->contacts;
  if (!c->surface) return true;
  end->frame = strut_arena_allocate(arena, (size_t)c->count, sizeof *end->frame);
  if (c->moves)
    end->motion = strut_arena_allocate(arena, model->scene->ground_count, sizeof *end->motion);
  return end->frame && (end->motion || !c->moves);
}

/* Arrays of one end of a step, with or without positions and velocities of its own. */
static bool create_step_end(const strut_model *model, strut_arena *arena, strut_step_end *end,
                            bool borrowed) {
  size_t length = (size_t)model->length, switches = strut_most_law_switches(model) + 1;
  if (!borrowed) end->q = strut_arena_allocate(arena, length, sizeof(double));
  if (!borrowed) end->v = strut_arena_allocate(arena, length, sizeof(double));
  end->a = strut_arena_allocate(arena, length, sizeof(double));
  end->structure = strut_arena_allocate(arena, length, sizeof(double));
  end->touch = strut_arena_allocate(arena, (size_t)model->contacts.count, sizeof *end->touch);
  end->tension = strut_arena_allocate(arena, switches, sizeof(double));
  end->stretch = strut_arena_allocate(arena, switches, sizeof(double));
  end->stretch_rate = strut_arena_allocate(arena, switches, sizeof(double));
  return end->q && end->v && end->a && end->structure && end->touch && end->tension &&
         end->stretch && end->stretch_rate && make_frames(model, arena, end);
}

static bool make_arrays(const strut_model *model, strut_state *state, strut_event_stepper *l) {
  strut_arena *arena = &state->arena;
  size_t contacts = (size_t)model->contacts.count, length = (size_t)model->length;
  l->entry = state->latest.grip ? state->latest.grip : model->contacts.entry;
  l->mode = strut_arena_allocate(arena, contacts, 1);
  l->side = strut_arena_allocate(arena, contacts, 1);
  l->damper = strut_arena_allocate(arena, contacts, 1);
  l->outward = strut_arena_allocate(arena, contacts, sizeof(double));
  l->body = strut_arena_allocate(arena, contacts, sizeof *l->body);
  l->closed = strut_arena_allocate(arena, contacts, sizeof *l->closed);
  l->stuck = strut_arena_allocate(arena, contacts, sizeof *l->stuck);
  l->damped = strut_arena_allocate(arena, contacts, sizeof *l->damped);
  l->response = strut_arena_allocate(arena, contacts, sizeof *l->response);
  l->settling_time = strut_arena_allocate(arena, contacts, sizeof(double));
  size_t margins = contacts + strut_most_law_switches(model);
  l->least = strut_arena_allocate(arena, margins, sizeof *l->least);
  l->scatter = strut_arena_allocate(arena, length, sizeof(double));
  l->stage = strut_arena_allocate(arena, (size_t)l->stepper->stages + 1, sizeof *l->stage);
  if (model->contacts.surface) l->facet = strut_arena_allocate(arena, contacts, sizeof *l->facet);
  bool ready = (l->facet || !model->contacts.surface) && l->mode && l->side && l->damper &&
               l->outward && l->body && l->closed && l->stuck && l->damped && l->response &&
               l->settling_time && l->least && l->scatter && l->stage;
  for (int k = 0; k < l->stepper->stages && ready; k++)
    ready = (l->stage[k] = strut_arena_allocate(arena, length, sizeof(double)));
  return ready;
}

static bool list_laws(const strut_model *model, strut_state *state, strut_event_stepper *l) {
  const strut_member_table *t = &model->members;
  size_t most = strut_most_law_switches(model);
  if (!most) return true;
  l->laws = strut_arena_allocate(&state->arena, most, sizeof *l->laws);
  l->acting = strut_arena_allocate(&state->arena, most, 1);
  if (!l->laws || !l->acting) return false;
  for (int32_t j = 0; j < t->count; j++)
    if (t->slack[j] == 0.0)
      l->laws[l->law_count++] = (strut_law_switch){.event = STRUT_EVENT_ACTS,
                                                   .member = j,
                                                   .element = -1,
                                                   .stiffness = t->stiffness[j],
                                                   .damping = t->damping[j]};
  l->cable_count = l->law_count;
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *e = &model->elements.element[i];
    double natural = strut_element_start(model, i);
    strut_law_response rest = strut_law_respond(e->law, &e->numbers, natural, natural, -1);
    bool abrupt = e->carries * rest.force > 0.0 || (rest.force == 0.0 && !(rest.slope > 0.0));
    const strut_law_switch own = {.event = STRUT_EVENT_ACTS,
                                  .member = -1,
                                  .element = i,
                                  .abrupt = abrupt,
                                  .stiffness = e->numbers.stiffness,
                                  .damping = e->damping};
    bool rubs = e->guide_friction > 0.0 && !state->forgetful;
    if (e->carries && !rubs) l->laws[l->law_count++] = own;
    if (!strut_law_kinks(e->law, &e->numbers)) continue;
    l->laws[l->law_count] = own;
    l->laws[l->law_count++].event = STRUT_EVENT_KINK;
  }
  strut_history_list(model, state, l);
  if (model->elements.scattered)
    l->nearby_laws = strut_arena_allocate(&state->arena, most, sizeof(int32_t));
  if (model->elements.scattered && !l->nearby_laws) return false;
  for (int32_t i = 0; i < model->feedback.relay_count; i++)
    l->laws[l->law_count++] = (strut_law_switch){.event = STRUT_EVENT_RELAY,
                                                 .member = -1,
                                                 .element = -1,
                                                 .relay = 1 + model->feedback.relay[i]};
  return true;
}

/* After the laws have been listed. */
static bool create_switch_counts(const strut_model *model, strut_arena *arena,
                                 strut_event_stepper *l) {
  size_t switches = (size_t)model->contacts.count + (size_t)l->law_count;
  strut_switch_counts *c = &l->counts;
  c->times = strut_arena_allocate(arena, switches, sizeof *c->times);
  c->switched = strut_arena_allocate(arena, switches, sizeof *c->switched);
  return c->times && c->switched;
}

/* Contact forces for whoever looks on. */
static bool make_held(const strut_model *model, strut_state *state) {
  size_t contacts = (size_t)model->contacts.count;
  double *normal = strut_arena_allocate(&state->arena, contacts, sizeof *normal);
  double *friction = strut_arena_allocate(&state->arena, contacts, sizeof *friction);
  state->modes.held_normal = normal, state->modes.held_friction = friction;
  return normal && friction;
}

/*
 * What rounding leaves of a pair's difference of accelerations [m/s^2]: lengths are known to a part in 1e16 of the
 * size, and the stiffest spring on the lightest node pulls by as much.
 */
static double rounding_of(const strut_model *model, const strut_tableau *pair) {
  double fastest = strut_model_fastest_spring(model), weights = 0.0;
  for (int k = 0; k <= pair->stages; k++) weights += fabs(pair->difference[k]);
  return DBL_EPSILON * model->size * fastest * fastest * weights;
}

void *strut_event_stepper_create(const strut_model *model, strut_state *state,
                                 const strut_step_formula *stepper,
                                 const strut_integrator_settings *settings) {
  strut_event_stepper *l = strut_arena_allocate(&state->arena, 1, sizeof *l);
  if (!l) return NULL;
  l->stepper = stepper;
  l->now = &l->end[0], l->next = &l->end[1];
  l->now->q = state->q, l->now->v = state->v;
  l->tolerance = settings->tolerance;
  l->rounding = stepper->adaptive ? rounding_of(model, stepper->tableau) : 0.0;
  if (!create_step_end(model, &state->arena, l->now, true) ||
      !create_step_end(model, &state->arena, l->next, false) || !make_arrays(model, state, l) ||
      !list_laws(model, state, l) || !create_switch_counts(model, &state->arena, l) ||
      !make_held(model, state) || strut_event_stepper_prepare(model, state, settings, l))
    return NULL;
  return l;
}

/* Contact forces at an end, for recording and measuring. */
static void show_contacts(const strut_model *model, strut_state *state,
                          const strut_event_stepper *l, const strut_step_end *end) {
  double *normal = (double *)state->modes.held_normal,
         *friction = (double *)state->modes.held_friction;
  for (int32_t i = 0; i < model->contacts.count; i++) {
    /* a step may end a little beyond the opening */
    bool open = l->mode[i] == STRUT_MODE_OPEN || end->touch[i].gap > 0.0;
    normal[i] = open ? 0.0 : end->touch[i].normal;
    friction[i] = open ? 0.0 : end->touch[i].friction;
  }
}

/* ---- what an observer sees ---- */

bool strut_event_stepper_observe(const strut_model *model, strut_state *state, void *workspace) {
  strut_event_stepper *l = workspace;
  strut_arena *arena = &state->arena;
  strut_event_view *view = strut_arena_allocate(arena, 1, sizeof *view);
  if (!view) return false;
  view->q = strut_arena_allocate(arena, (size_t)model->length, sizeof(double));
  view->v = strut_arena_allocate(arena, (size_t)model->length, sizeof(double));
  l->view = view;
  return view->q && view->v && create_step_end(model, arena, &view->instant, false);
}

/* Contact forces in the present modes at an instant within a step. */
STRUT_CLONES
static void hold_contacts(const strut_motion_piece *piece, const strut_model *model,
                          strut_state *state, double t, const double *q, const double *v) {
  strut_event_stepper *l = piece->workspace;
  strut_step_end *at = &l->view->instant;
  int64_t evaluations = state->evaluations;
  accelerate_in_modes(model, state, l, t, q, v, at->a, at, STRUT_TERMS_ALL, false);
  state->evaluations = evaluations; /* observing is not part of the run's cost */
  show_contacts(model, state, l, at);
}

/* Keeps the begin of a step that is about to be accepted. */
static void keep_begin(const strut_model *model, const strut_state *state, strut_event_view *view) {
  memcpy(view->q, state->q, (size_t)model->length * sizeof(double));
  memcpy(view->v, state->v, (size_t)model->length * sizeof(double));
  memcpy(view->work, state->work, sizeof view->work);
}

/* From the time at which a step that begins at t is evaluated to one after what jumps at t; see moment_before. */
static double moment_after(const strut_event_stepper *l, double t, double dt) {
  return l->next_break < HUGE_VAL ? 2.0 * moment_before(t, dt) : 0.0;
}

/* Shows the step of h that began at t and has been accepted, in whose modes l still is. */
static void show_piece(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       double t, double h, double dt) {
  const strut_step_end *begin = l->next, *end = l->now;
  const strut_event_view *view = l->view;
  const strut_motion_piece piece = {.begin = t,
                                    .length = h,
                                    .moment = moment_after(l, t, dt),
                                    .q = {view->q, end->q},
                                    .v = {view->v, end->v},
                                    .a = {begin->a, end->a},
                                    .work = {view->work, state->work},
                                    .power = {begin->power, end->power},
                                    .smooth = view->smooth,
                                    .hold = hold_contacts,
                                    .workspace = l};
  show_contacts(model, state, l, end);
  state->watched.observer->see(state->watched.observer, state, &piece);
  l->view->smooth = true;
}

/* Something has switched or jumped. */
static void end_smooth(strut_event_stepper *l) {
  if (l->view) l->view->smooth = false;
}

void strut_event_stepper_restart(const strut_model *model, strut_state *state, void *workspace,
                                 double dt) {
  strut_event_stepper *l = workspace;
  double t = (double)state->step * dt;
  memcpy(l->next->q, state->q, (size_t)model->length * sizeof(double)); /* padding included */
  memcpy(l->next->v, state->v, (size_t)model->length * sizeof(double));
  l->h = 0.0;
  l->longest = dt;
  l->fastest = 0.0;
  l->done = 0.0;
  l->at_once = l->switches = 0;
  l->pushed = -1;
  l->tried = false;
  l->next_break =
      strut_drive_next_break(model, state, t + state->time_offset + STRUT_AT_BREAK * dt);
  if (l->next_break < HUGE_VAL) t += moment_before(t, dt);
  strut_modes_start(model, state, l, t);
  show_contacts(model, state, l, l->now);
  end_smooth(l);
  if (state->watched.event_log) strut_event_log_begin(model, state, l);
  if (state->watched.variation) strut_variation_begin(model, state, l);
  l->started = true;
}

/* What a jump of rest lengths at time t has done to the elastic energy is work of the drive. */
static void accumulate_jump(const strut_model *model, strut_state *state, double t, double before) {
  if (!state->balance) return;
  double gained = strut_energy_evaluate(model, state, t).elastic - before;
  state->work[STRUT_POWER_DRIVE] += gained;
  state->work[STRUT_POWER_EXCHANGED] += fabs(gained);
}

/*
 * Where a drive or load jumps the right-hand side does: modes and accelerations are made anew. What
 * the jump of a rest length does to the elastic energy is work of the drive.
 */
static void pass_break(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       double dt) {
  double t = (double)state->step * dt + l->done;
  if (t + state->time_offset < l->next_break - STRUT_AT_BREAK * dt) return;
  double moment = moment_before(t, dt), before = 0.0;
  end_smooth(l);
  if (state->balance) before = strut_energy_evaluate(model, state, t - moment).elastic;
  l->next_break =
      strut_drive_next_break(model, state, t + state->time_offset + STRUT_AT_BREAK * dt);
  strut_feedback_sample(model, state, t, STRUT_AT_BREAK * dt);
  accumulate_jump(model, state, t + moment, before);
  if (model->terms & STRUT_TERM_MEMORY)
    strut_history_release(model, state, t + moment + state->time_offset + STRUT_AT_BREAK * dt);
  bool kicked = model->contacts.moves; /* a ground may have changed its speed at once */
  if (model->terms & STRUT_TERM_SLIDING_MASS)
    kicked = strut_sliding_masses_kick(model, state, t - 2.0 * moment, t + 0.5 * moment) || kicked;
  if (model->terms & (STRUT_TERM_SUPPORT_MOTION | STRUT_TERM_UNBALANCE)) {
    kicked = strut_support_motion_kick(model, state, t - 2.0 * moment, t + 0.5 * moment) || kicked;
    kicked = strut_unbalance_kick(model, state, t - 2.0 * moment, t + 0.5 * moment) || kicked;
    strut_support_motion_place(model, state, t + moment, state->q, state->v);
  }
  if (kicked)
    strut_modes_start(model, state, l, t + moment);
  else
    strut_modes_after_jump(model, state, l, t + moment);
  if (state->watched.variation) strut_variation_pass(model, state, l, false);
}

/* Where a value passes 0: between low and high, and the latest two points of the search. */
typedef struct search {
  double low, high;
  double x, value, last_x, last_value, size_before; /* the size of the value before the last one */
} search;

static search begin_search(double before, double fraction, double after, double first) {
  return (search){.high = fraction,
                  .x = first,
                  .last_x = before > 0.0 ? 0.0 : fraction,
                  .last_value = before > 0.0 ? before : after,
                  .size_before = HUGE_VAL};
}

/* Of the value by x: its rate where that is known, else that of the secant. */
static double slope_of(const search *s, double rate) {
  return rate != 0.0 ? rate : (s->value - s->last_value) / (s->x - s->last_x);
}

/*
 * Goes to `next`, or to the middle of the bracket, narrowed at x, where that is outside, and where two
 * steps have not made the value half as large: at a kink secants creep on from both sides.
 */
static double go_on(search *s, double next) {
  bool slow = fabs(s->value) > 0.5 * s->size_before;
  *(s->value < 0.0 ? &s->high : &s->low) = s->x;
  s->size_before = fabs(s->last_value);
  s->last_x = s->x, s->last_value = s->value;
  return next > s->low && next < s->high && !slow ? next : 0.5 * (s->low + s->high);
}

/* The latest correction was small and did not make the value smaller: the rest is rounding. */
static bool stagnant(const search *s) {
  return fabs(s->x - s->last_x) <= 1e-6 && fabs(s->value) > 0.1 * fabs(s->last_value);
}

/* Does a creeping contact balance the other forces, within STRUT_TIED? friction_in_creep lets it come no nearer. */
static bool is_balanced(const strut_event_stepper *l, const strut_event *event, double value) {
  return event->kind == STRUT_EVENT_CREEP_IN &&
         fabs(value) <= 1.5 * STRUT_TIED * l->next->touch[event->index].normal;
}

/* Where forces balance until then, an edge is left so gently that this part of a step is harmless. */
static const double BALANCED = 1e-8;

/* Is the speed at the edge of the band, within STRUT_TIED? settle_band_ties keeps it no nearer. */
static bool is_at_edge(const strut_model *model, const strut_event *event, double value) {
  if (event->kind != STRUT_EVENT_LEAVES_STICK_BAND) return false;
  double tie = STRUT_TIED * stick_band_edge(&model->contacts.entry[event->index]);
  return value > 0.5 * tie && value < 1.5 * tie;
}

/*
 * Takes the step again up to the event. Returns the length taken; l->next is its end. Exact steppers
 * go on until the root is known to 1e-13 of the step, or to rounding.
 */
static double retake(const strut_model *model, strut_state *state, strut_event_stepper *l, double t,
                     double h, strut_event *event) {
  double before = strut_event_value(model, l, l->now, event->kind, event->index);
  double after = strut_event_value(model, l, l->next, event->kind, event->index);
  search s = begin_search(before, 1.0, after, event->fraction);
  double reached = 1.0; /* the part of the step at whose end l->next is */
  for (int k = 0; k < MOST_TRIALS && s.x * h > 0.0; k++) {
    if (l->stepper->predict) l->stepper->predict(model, l, s.x * h);
    l->stepper->trial(model, state, l, t, s.x * h);
    reached = s.x;
    if (!l->stepper->exact) break;
    strut_event other = strut_event_first(model, state, l, s.x * h);
    bool same = other.kind == event->kind && other.index == event->index;
    if (other.kind && !same) { /* another one comes first */
      *event = other;
      before = strut_event_value(model, l, l->now, other.kind, other.index);
      after = strut_event_value(model, l, l->next, other.kind, other.index);
      s = begin_search(before, s.x, after, s.x * other.fraction);
      continue;
    }
    s.value = strut_event_value(model, l, l->next, event->kind, event->index);
    double rate = 0.0;
    if (strut_event_rate(l, l->next, event->kind, event->index, &rate)) rate *= h;
    double slope = slope_of(&s, rate);
    if (fabs(s.value) <= 1e-13 * fabs(slope)) break;
    bool edge = is_at_edge(model, event, s.value);
    /* forces that balance keep the speed there for a while: the value stays small, but has no root nearby */
    bool tied = edge && band_forces_balance(l, &l->next->touch[event->index], event->index);
    if (edge && !tied) break;
    /* variations need a point from which the value changes */
    if (!state->watched.variation && is_balanced(l, event, s.value)) break;
    /* a value that is not small beside those of the step's ends jumps, or has its root farther on, however little the
       search has moved */
    bool still = k > 0 && !tied && stagnant(&s),
         far = fabs(s.value) > 0.1 * (fabs(before) + fabs(after));
    if (s.value == 0.0 || (still && !far)) break;
    if (tied && s.high - s.x <= BALANCED) break;
    double x = go_on(&s, s.x - s.value / slope);
    if (tied || still) x = 0.5 * (s.low + s.high);
    if (s.high - s.low <= 1e-13) break;
    s.x = x;
  }
  return s.x * h > 0.0 ? reached * h : 0.0;
}

/* The trial over h, and what happens in it. False: the error is too large; l->h says what to try. */
static bool try_step(const strut_model *model, strut_state *state, strut_event_stepper *l, double t,
                     double h, double dt) {
  if (!l->tried) l->stepper->trial(model, state, l, t, h);
  l->tried = false;
  if (!l->stepper->adaptive) return true;
  double error = l->error;
  control_step(l, h, h < l->h);
  if (error <= 1.0) return true;
  if (!(l->h > 1e-14 * (fabs(t) + dt))) state->trouble = STRUT_FAILURE_STEP;
  return false;
}

/* A touchdown at time t may start signals: the drives jump as in pass_break. */
static void start_signals(const strut_model *model, strut_state *state, strut_event_stepper *l,
                          int32_t contact, double t, double dt) {
  double before = state->balance ? strut_energy_evaluate(model, state, t).elastic : 0.0;
  if (!strut_feedback_touch(model, state, contact, t)) return;
  l->next_break =
      strut_drive_next_break(model, state, t + state->time_offset + STRUT_AT_BREAK * dt);
  accumulate_jump(model, state, t, before);
  strut_modes_after_jump(model, state, l, t);
}

/* A relay whose input is at its threshold at time t: the drives jump likewise. */
static void switch_relay(const strut_model *model, strut_state *state, strut_event_stepper *l,
                         int32_t signal, double t) {
  double before = state->balance ? strut_energy_evaluate(model, state, t).elastic : 0.0;
  strut_relay_switch(model, state, signal, t);
  accumulate_jump(model, state, t, before);
  strut_modes_after_jump(model, state, l, t);
}

/* Where an event is in the arrays of strut_switch_counts. */
static int32_t place_of(const strut_model *model, const strut_event *event) {
  return event->index + (strut_event_is_of_law(event->kind) ? model->contacts.count : 0);
}

/* Counts an event; moved: a step has led to it. */
static void count_switch(const strut_model *model, strut_event_stepper *l, const strut_event *event,
                         bool moved) {
  strut_switch_counts *c = &l->counts;
  if (moved || l->at_once == 1) { /* after a step: that of the count before */
    for (int32_t k = 0; k < c->count; k++) c->times[c->switched[k]] = 0;
    c->count = c->most = 0;
  }
  int32_t i = place_of(model, event);
  if (!c->times[i]) c->switched[c->count++] = i;
  if (c->times[i] < UINT8_MAX) c->times[i]++;
  if (c->times[i] > c->most) c->most = c->times[i];
}

/* Must a step be taken whatever the modes say? */
static bool must_step(const strut_event_stepper *l) {
  return (l->at_once > 0 && l->counts.most >= MOST_AT_ONCE) || l->switches >= STRUT_MOST_SWITCHES;
}

/*
 * Where a contact opens within AT_ONCE, it may stick and slip in turn until then, and in the wrong mode friction
 * would push it on: a step of this length only passes the opening. Otherwise 0.
 */
static double past_opening(const strut_model *model, const strut_event_stepper *l, double h,
                           double dt) {
  double moment = 10.0 * AT_ONCE * dt;
  for (int32_t k = 0; k < l->closed_count && 2.0 * moment < h; k++) {
    const strut_touch *o = &l->now->touch[l->closed[k]];
    bool rubs = strut_friction_largest(&model->contacts.entry[l->closed[k]].friction) > 0.0;
    if (rubs && o->gap > -moment * o->into) return 2.0 * moment;
  }
  return 0.0;
}

/*
 * The step over h has been taken in modes that have switched back and forth where it begins. Where these end
 * within it, half of it is tried, and half of that: what switches back may just come back later. Another one may have
 * to switch first, or the modes hold for no time, but would after one more switch: that is left in *turn, and *h is 0.
 * False: neither, and the step over h is taken against the modes.
 */
static bool hold_modes(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       double t, double dt, double *h, strut_event *turn) {
  bool endless = l->switches >= STRUT_MOST_SWITCHES || !l->stepper->exact;
  double length = *h;
  for (int k = 0; k < MOST_HALVINGS; k++, length *= 0.5) {
    if (k > 0) l->stepper->trial(model, state, l, t, length);
    strut_event first = strut_event_first(model, state, l, length);
    if (!first.kind) {
      *h = length;
      return true;
    }
    if (endless) break;
    int most = k < MOST_HALVINGS - 1 ? MOST_AT_ONCE - 1 : MOST_AT_ONCE;
    if (first.fraction * length > AT_ONCE * dt || l->counts.times[place_of(model, &first)] > most)
      continue;
    *turn = first, *h = 0.0;
    return true;
  }
  if (l->stepper->exact && !state->forced.count++) state->forced.first = t;
  if (length < *h) l->stepper->trial(model, state, l, t, *h);
  return false;
}

/* One trial over at most h at time t; handles rejection and events. Returns the time gone, 0 if none. */
static double step_piece(const strut_model *model, strut_state *state, strut_event_stepper *l,
                         double t, double h, double dt) {
  strut_event event = {STRUT_EVENT_NONE, 0, 1.0};
  bool force = must_step(l);
  double passes = force ? past_opening(model, l, h, dt) : 0.0;
  if (passes > 0.0) h = passes, l->tried = false;
  if (l->stepper->predict && !l->tried) {
    l->stepper->predict(model, l, h);
    strut_surface_move(model, state, l->next, t + h);
    if (!force) event = strut_event_predict(model, state, l, h);
    if (event.kind) l->stepper->predict(model, l, h *= event.fraction);
  }
  if (h > AT_ONCE * dt || !event.kind) {
    if (!try_step(model, state, l, t, h, dt)) return 0.0;
    if (force && !(passes > 0.0) && hold_modes(model, state, l, t, dt, &h, &event)) force = false;
    strut_event inside = {STRUT_EVENT_NONE, 0, 1.0};
    if (!force && h > 0.0) inside = strut_event_first(model, state, l, h);
    if (inside.kind) {
      event = inside;
      double taken = event.fraction * h <= AT_ONCE * dt && !l->stepper->exact
                         ? 0.0
                         : retake(model, state, l, t, h, &event);
      bool sooner = l->stepper->adaptive && l->error > 1.0; /* something else comes before it */
      if (sooner && taken > AT_ONCE * dt) {
        control_step(l, taken, true);
        return 0.0;
      }
      h = taken > AT_ONCE * dt ? taken : 0.0;
    }
  } else {
    h = 0.0;
  }
  if (h > 0.0) {
    if (state->watched.variation) strut_variation_step(model, state, l, t, h);
    bool observed = l->view && state->watched.observer;
    if (observed) keep_begin(model, state, l->view);
    accept_step(model, state, l, state->balance);
    if (observed) show_piece(model, state, l, t, h, dt);
    l->at_once = 0;
    if (h > SEPARATES * (l->stepper->adaptive ? l->h : dt)) l->switches = 0;
  } else {
    l->at_once++;
    t += moment_after(l, t, dt);
  }
  if (state->watched.variation && event.kind)
    strut_variation_meet(model, state, l, &event, t + h, dt, h > 0.0);
  if (event.kind) {
    strut_event_apply(model, state, l, event, t + h);
    if (event.kind == STRUT_EVENT_TOUCH && model->feedback.trigger_count)
      start_signals(model, state, l, event.index, t + h, dt);
    if (event.kind == STRUT_EVENT_RELAY)
      switch_relay(model, state, l, l->laws[event.index].relay - 1, t + h);
    state->events++;
    l->switches++;
    count_switch(model, l, &event, h > 0.0);
  } else if (force) {
    strut_modes_start(model, state, l, t + h);
  } else if (strut_modes_after_step(model, l)) {
    strut_evaluate_acceleration(model, state, l, t + h);
  } else {
    return h;
  }
  end_smooth(l);
  if (state->watched.variation && (event.kind || force))
    strut_variation_pass(model, state, l, event.kind != STRUT_EVENT_NONE);
  return h;
}

/*
 * Error control may take long within one step of the grid: when interrupted, or out of work allowed, it
 * goes back to the start of it. The last two stages hold that.
 */
static bool given_up(const strut_model *model, strut_state *state, strut_event_stepper *l) {
  double **kept = l->stage + l->stepper->stages - 2;
  bool spent = is_spent(state), wanted = is_wanted_back(state);
  size_t bytes = (size_t)model->length * sizeof(double);
  if (l->done == 0.0) {
    memcpy(kept[0], state->q, bytes);
    memcpy(kept[1], state->v, bytes);
    memcpy(l->work, state->work, sizeof l->work);
    if (model->terms & STRUT_TERM_MEMORY) strut_history_store(model, state, state->history.kept);
  } else if (wanted) {
    memcpy(state->q, kept[0], bytes);
    memcpy(state->v, kept[1], bytes);
    memcpy(state->work, l->work, sizeof l->work);
    if (model->terms & STRUT_TERM_MEMORY) strut_history_load(model, state, state->history.kept);
  }
  if (wanted) state->trouble = spent ? STRUT_FAILURE_WORK : STRUT_FAILURE_INTERRUPT;
  return wanted;
}

void strut_event_stepper_step(const strut_model *model, strut_state *state, void *workspace,
                              double dt) {
  strut_event_stepper *l = workspace;
  double t = (double)state->step * dt + l->done, h = next_step_size(state, l, dt);
  double gone = step_piece(model, state, l, evaluation_time(l, t, dt), h, dt);
  if (state->watched.event_log) strut_event_log_note(model, state, l, t + gone);
  advance_within_grid(state, l, gone, dt);
  if (l->next_break < HUGE_VAL) pass_break(model, state, l, dt);
}

void strut_event_stepper_advance(const strut_model *model, strut_state *state, void *workspace,
                                 double dt, int64_t count) {
  strut_event_stepper *l = workspace;
  if (!l->started) strut_event_stepper_restart(model, state, workspace, dt);
  drives_ahead_begin(model, model->terms & STRUT_TERMS_RARE ? STRUT_TERMS_ALL : STRUT_TERMS_COMMON,
                     &l->drives);
  for (int64_t end = state->step + count; state->step < end && !state->trouble;) {
    if (l->stepper->advance_until_event && l->at_once == 0 && !model->contacts.surface &&
        !state->watched.observer)
      l->stepper->advance_until_event(model, state, l, dt, end);
    if (state->step == end || (l->stepper->adaptive && given_up(model, state, l))) break;
    strut_event_stepper_step(model, state, l, dt);
  }
  l->drives.used = false; /* whoever calls may change drives */
  show_contacts(model, state, l, l->now);
}
