/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Methods with events step from grid point to grid point: docs/dev/architecture.md, "From stick to slip". */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/forces.h"
#include "engine/forces/history.h"
#include "engine/integrate/events/event_kernel.h"
#include "engine/integrate/events/location/event_log.h"
#include "engine/integrate/events/location/variation.h"
#include "engine/integrate/integrator.h"

/* A root this close to where the step begins, in grid steps, is there already. */
static const double AT_ONCE = 1e-9;
/*
 * After so many switches of one contact or law without a step, or MOST_SWITCHES of all with hardly a step between, one
 * is taken whatever the modes say: switches may follow each other faster and faster without end (Zeno).
 */
enum { MOST_AT_ONCE = 8, MOST_SWITCHES = 2000, MOST_HALVINGS = 30, MOST_LOOKS = 8 };

/* A step above this part of the one that the method wants separates switches from those before. */
static const double SEPARATES = 0.1;

/* Contact forces at an end, for recording and measuring. */
static void show_contacts(const strut_model *model, const strut_state *state,
                          const strut_event_stepper *stepper, const strut_step_end *end) {
  double *normal = (double *)state->modes.held_normal,
         *friction = (double *)state->modes.held_friction;
  for (int32_t i = 0; i < model->contacts.count; i++) {
    /* a step may end a little beyond the opening */
    bool open = stepper->modes.of[i] == STRUT_MODE_OPEN || end->touch[i].gap > 0.0;
    normal[i] = open ? 0.0 : end->touch[i].normal;
    friction[i] = open ? 0.0 : end->touch[i].friction;
  }
}

/* ---- what an observer sees ---- */

bool strut_event_stepper_observe(const strut_model *model, strut_state *state, void *workspace) {
  strut_event_stepper *stepper = workspace;
  strut_arena *arena = &state->arena;
  strut_event_view *view = strut_arena_allocate(arena, 1, sizeof *view);
  if (!view) return false;
  stepper->view = view;
  return STRUT_NUMBERS(arena, model->length, &view->q, &view->v) &&
         STRUT_NUMBERS(arena, strut_history_count(model), &view->memory) &&
         strut_step_end_create(model, arena, false, &view->instant);
}

/* Contact forces in the present modes at an instant within a step. */
STRUT_CLONES
static void hold_contacts(const strut_motion_piece *piece, const strut_model *model,
                          const strut_state *state, double t, const double *positions,
                          const double *velocity) {
  strut_event_stepper *stepper = piece->workspace;
  strut_step_end *at = &stepper->view->instant;
  int64_t evaluations = state->latest->evaluations;
  accelerate_in_modes(model, state, stepper, t, positions, velocity, at->a, at, STRUT_TERMS_ALL,
                      false);
  state->latest->evaluations = evaluations; /* observing is not part of the run's cost */
  show_contacts(model, state, stepper, at);
}

/* From the time at which a step that begins at t is evaluated to one after what jumps at t; see moment_before. */
static double moment_after(const strut_event_stepper *stepper, double t, double dt) {
  return stepper->next_break < HUGE_VAL ? 2.0 * moment_before(t, dt) : 0.0;
}

/* Something has switched or jumped. */
static void end_smooth(strut_event_stepper *stepper) {
  if (stepper->view) stepper->view->smooth = false;
}

static void find_next_break(const strut_model *model, const strut_state *state,
                            strut_event_stepper *stepper, double t, double dt) {
  stepper->next_break = strut_drive_next_break(
      model, state, t + state->time_offset + STRUT_AT_BREAK * dt, (double)INFINITY);
}

/* On which side of their thresholds sensors begin; nodes that just touch when the run begins have touched down. */
static void begin_triggers(const strut_model *model, strut_state *state,
                           strut_event_stepper *stepper, double t, double dt) {
  const strut_contact_table *contacts = &model->contacts;
  strut_drive_apply(model, state, t);
  strut_threshold_begin(model, state);
  for (int32_t i = 0; i < contacts->count && state->step == 0; i++)
    if (strut_contact_gap_at(contacts, i, state->q, state->latest->ground_motion) == 0.0 &&
        strut_feedback_touch(model, state, i, t))
      find_next_break(model, state, stepper, t, dt);
}

void strut_event_stepper_restart(const strut_model *model, strut_state *state, void *workspace,
                                 double dt) {
  strut_event_stepper *stepper = workspace;
  double t = (double)state->step * dt;
  memcpy(stepper->next->q, state->q, (size_t)model->length * sizeof(double)); /* padding included */
  memcpy(stepper->next->v, state->v, (size_t)model->length * sizeof(double));
  stepper->control.h = 0.0;
  stepper->control.longest = dt;
  stepper->control.fastest = stepper->control.speed = stepper->control.own_speed = 0.0;
  stepper->done = 0.0;
  stepper->chatter.at_once = stepper->chatter.switches = 0;
  stepper->chatter.pushed = -1;
  stepper->tried = stepper->turns.on = false;
  stepper->laws.count = stepper->turns.first;
  find_next_break(model, state, stepper, t, dt);
  stepper->looks = strut_drive_is_looked_at(model);
  if (stepper->next_break < HUGE_VAL) t += moment_before(t, dt);
  if (model->feedback.trigger_count) begin_triggers(model, state, stepper, t, dt);
  strut_modes_start(model, state, stepper, t);
  show_contacts(model, state, stepper, stepper->now);
  end_smooth(stepper);
  if (state->watched.event_log) strut_event_log_begin(model, state, stepper);
  if (state->watched.variation) strut_variation_begin(model, state, stepper);
  stepper->started = true;
}

/* What a jump of rest lengths at time t has done to the elastic energy is work of the drive. */
static void accumulate_jump(const strut_model *model, strut_state *state, double t, double before) {
  if (!state->balance) return;
  double gained = strut_energy_evaluate(model, state, t).elastic - before;
  strut_power_add(state->work, STRUT_POWER_DRIVE, gained);
}

/*
 * Where a drive or load jumps the right-hand side does: modes and accelerations are made anew. What
 * the jump of a rest length does to the elastic energy is work of the drive.
 */
static void pass_break(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                       double dt) {
  double t = (double)state->step * dt + stepper->done;
  if (t + state->time_offset < stepper->next_break - STRUT_AT_BREAK * dt) return;
  double moment = moment_before(t, dt), before = 0.0;
  end_smooth(stepper);
  if (state->balance) before = strut_energy_evaluate(model, state, t - moment).elastic;
  find_next_break(model, state, stepper, t, dt);
  strut_feedback_sample(model, state, t, STRUT_AT_BREAK * dt);
  accumulate_jump(model, state, t + moment, before);
  if (model->terms & STRUT_TERM_MEMORY)
    strut_history_release(model, state, t + moment + state->time_offset + STRUT_AT_BREAK * dt);
  bool kicked = model->contacts.moves; /* a ground may have changed its speed at once */
  kicked = strut_moving_kick(model, state, t - 2.0 * moment, t + 0.5 * moment) || kicked;
  strut_support_motion_place(model, state, t + moment, state->q, state->v);
  if (kicked)
    strut_modes_start(model, state, stepper, t + moment);
  else
    strut_modes_after_jump(model, state, stepper, t + moment);
  if (state->watched.variation) strut_variation_pass(model, state, stepper, false);
}

/* A touchdown at time t may start signals: the drives jump as in pass_break. */
static void start_signals(const strut_model *model, strut_state *state,
                          strut_event_stepper *stepper, int32_t contact, double t, double dt) {
  double before = state->balance ? strut_energy_evaluate(model, state, t).elastic : 0.0;
  if (!strut_feedback_touch(model, state, contact, t)) return;
  find_next_break(model, state, stepper, t, dt);
  accumulate_jump(model, state, t, before);
  strut_modes_after_jump(model, state, stepper, t);
}

/* The contact that the event closes, by a mode of its own or as an element; -1: none. */
static int32_t touched_by(const strut_model *model, const strut_event_stepper *stepper,
                          const strut_event *event) {
  if (event->kind == STRUT_EVENT_TOUCH) return event->index;
  if (event->kind != STRUT_EVENT_ACTS || !stepper->laws.acting[event->index]) return -1;
  int32_t i = stepper->laws.item[event->index].element;
  const strut_element *element = i >= 0 ? &model->elements.element[i] : NULL;
  bool ground =
      element && (element->role == STRUT_ELEMENT_FOOT || element->role == STRUT_ELEMENT_CONTACT);
  return ground ? element->contact : -1;
}

/* At a threshold at time t the drives jump likewise. */
static void pass_threshold(const strut_model *model, strut_state *state,
                           strut_event_stepper *stepper, const strut_law_switch *law, double t,
                           double dt) {
  double before = state->balance ? strut_energy_evaluate(model, state, t).elastic : 0.0;
  if (law->kink)
    stepper->kinks.side[law->kink - 1] *= -1.0;
  else
    strut_threshold_pass(model, state, law->signal - 1, t);
  find_next_break(model, state, stepper, t, dt);
  accumulate_jump(model, state, t, before);
  strut_modes_after_jump(model, state, stepper, t);
}

void strut_event_rehearse(strut_event_trial *trial, const strut_model *model,
                          const strut_state *state, strut_event_stepper *stepper, double t,
                          double h) {
  const strut_step_control control = stepper->control;
  double far = stepper->formula->predict ? h : 2.0 * h;
  for (int k = 0; k < state->watched.rehearsals; k++) trial(model, state, stepper, t, far);
  stepper->control = control;
}

/* ---- a piece of a step ---- */

/** A piece of a step from stepper->now, and what ends it. */
typedef struct step_piece {
  double t;  /* where it begins; behind what jumps there once it is known to have no length [s] */
  double h;  /* its length; 0: a mode ends where it begins [s] */
  double dt; /* the step of the grid [s] */
  strut_event event; /* what ends a mode at its end; kind NONE: nothing does */
  bool forced;       /* taken against the modes */
} step_piece;

/* Where an event is in the arrays of strut_chatter. */
static int32_t place_of(const strut_model *model, const strut_event *event) {
  return event->index + (strut_event_is_of_law(event->kind) ? model->contacts.count : 0);
}

static void count_switch(const strut_model *model, strut_chatter *chatter,
                         const step_piece *piece) {
  chatter->switches++;
  if (piece->h > 0.0 || chatter->at_once == 1) { /* after a step: that of the count before */
    for (int32_t k = 0; k < chatter->count; k++) chatter->times[chatter->switched[k]] = 0;
    chatter->count = chatter->most = 0;
  }
  int32_t i = place_of(model, &piece->event);
  if (!chatter->times[i]) chatter->switched[chatter->count++] = i;
  if (chatter->times[i] < UINT8_MAX) chatter->times[i]++;
  if (chatter->times[i] > chatter->most) chatter->most = chatter->times[i];
}

/* A kink that switches back and forth where the piece begins, as where a signal's sign leads back to it from both sides,
   is met by its values from now on. */
static void release_kink(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                         const step_piece *piece, int32_t kink) {
  if (stepper->chatter.times[place_of(model, &piece->event)] < MOST_AT_ONCE) return;
  stepper->kinks.at[kink] = NULL;
  stepper->kinks.margin[kink] = 1.0;
  stepper->chatter.at_once = 0;
  if (!state->forced.count++) state->forced.first = piece->t;
}

/* Predicts positions, where the method knows them before forces. A touchdown or opening on the way ends the piece. */
static void predict_piece(const strut_model *model, const strut_state *state,
                          strut_event_stepper *stepper, step_piece *piece) {
  const strut_step_formula *formula = stepper->formula;
  if (!formula->predict || stepper->tried) return;
  formula->predict(model, stepper, piece->h);
  strut_surface_move(model, state, stepper->next, piece->t + piece->h);
  if (piece->forced) return;
  piece->event = strut_event_predict(model, state, stepper, piece->h);
  if (!piece->event.kind) return;
  formula->predict(model, stepper, piece->h *= piece->event.fraction);
  if (!(piece->h > AT_ONCE * piece->dt)) piece->h = 0.0;
}

/* Takes the piece to stepper->next. False: the error is too large; control.h says what to try. */
static bool take_piece(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                       const step_piece *piece) {
  const strut_step_control *control = &stepper->control;
  if (!stepper->tried) stepper->formula->trial(model, state, stepper, piece->t, piece->h);
  stepper->tried = false;
  if (!stepper->formula->adaptive) return true;
  double error = control->error;
  control_step(stepper, piece->h, piece->h < control->h);
  if (error <= 1.0) return true;
  if (!(control->h > 1e-14 * (fabs(piece->t) + piece->dt))) state->trouble = STRUT_FAILURE_STEP;
  return false;
}

/* Takes the piece again over a part of it, where something happens that its end does not show. */
static void take_part(const strut_model *model, const strut_state *state,
                      strut_event_stepper *stepper, step_piece *piece, double part) {
  const strut_step_formula *formula = stepper->formula;
  piece->h *= part;
  if (formula->predict) formula->predict(model, stepper, piece->h);
  formula->trial(model, state, stepper, piece->t, piece->h);
}

/* Where the end contradicts a mode, goes back to where that begins. False: something else shows before it. */
static bool locate_end(const strut_model *model, const strut_state *state,
                       strut_event_stepper *stepper, step_piece *piece) {
  strut_event first = strut_event_first(model, state, stepper, piece->h);
  bool looks = stepper->formula->exact || stepper->laws.count || model->contacts.surface;
  for (int k = 0; looks && k < MOST_LOOKS && !first.kind && !stepper->formula->adaptive; k++) {
    double part = strut_event_between(model, state, stepper, piece->h);
    if (!(part > 0.0)) break;
    take_part(model, state, stepper, piece, part);
    first = strut_event_first(model, state, stepper, piece->h);
  }
  if (!first.kind) return true;
  piece->event = first;
  if (stepper->formula->exact || !(first.fraction * piece->h <= AT_ONCE * piece->dt))
    piece->h = strut_event_locate(model, state, stepper, piece->t, piece->h, &piece->event);
  else
    piece->h = 0.0;
  if (!(piece->h > AT_ONCE * piece->dt)) piece->h = 0.0;
  if (!(piece->h > 0.0 && stepper->formula->adaptive && stepper->control.error > 1.0)) return true;
  control_step(stepper, piece->h, true);
  return false;
}

/*
 * Where a contact opens within AT_ONCE, it may stick and slip in turn until then, and in the wrong mode friction
 * would push it on: a step of this length only passes the opening. Otherwise 0.
 */
static double past_opening(const strut_model *model, const strut_event_stepper *stepper,
                           const step_piece *piece) {
  const strut_active_set *active = &stepper->active;
  double moment = 10.0 * AT_ONCE * piece->dt;
  for (int32_t k = 0; k < active->closed_count && 2.0 * moment < piece->h; k++) {
    const strut_touch *touch = &stepper->now->touch[active->closed[k]];
    const strut_friction *friction = &model->contacts.entry[active->closed[k]].friction;
    if (strut_friction_largest(friction) > 0.0 && touch->gap > -moment * touch->into)
      return 2.0 * moment;
  }
  return 0.0;
}

/*
 * The piece has been taken in modes that have switched back and forth where it begins. Where these end within it, half
 * of it is tried, and half of that: what switches back may just come back later. Another mode may have to switch first,
 * or the modes hold for no time, but would after one more switch: that is left in the piece, which then has no length.
 * False: neither, and the piece is taken against the modes.
 */
static bool hold_modes(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                       step_piece *piece) {
  const strut_step_formula *formula = stepper->formula;
  const strut_chatter *chatter = &stepper->chatter;
  bool endless = chatter->switches >= MOST_SWITCHES || !formula->exact;
  double length = piece->h;
  for (int k = 0; k < MOST_HALVINGS; k++, length *= 0.5) {
    if (k > 0) formula->trial(model, state, stepper, piece->t, length);
    strut_event first = strut_event_first(model, state, stepper, length);
    if (!first.kind) {
      piece->h = length;
      return true;
    }
    if (endless) break;
    int most = k < MOST_HALVINGS - 1 ? MOST_AT_ONCE - 1 : MOST_AT_ONCE;
    if (first.fraction * length > AT_ONCE * piece->dt ||
        chatter->times[place_of(model, &first)] > most)
      continue;
    piece->event = first, piece->h = 0.0;
    return true;
  }
  if (formula->exact && !state->forced.count++) state->forced.first = piece->t;
  if (length < piece->h) formula->trial(model, state, stepper, piece->t, piece->h);
  return false;
}

/* Predicts, takes and locates where modes have switched too often. False as that of take_piece. */
static bool force_piece(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                        step_piece *piece) {
  double passes = past_opening(model, stepper, piece);
  piece->forced = true;
  if (passes > 0.0) piece->h = passes, stepper->tried = false;
  predict_piece(model, state, stepper, piece);
  if (!take_piece(model, state, stepper, piece)) return false;
  piece->forced = passes > 0.0 || !hold_modes(model, state, stepper, piece);
  return true;
}

/* Shows the piece, which has been accepted and in whose modes the stepper still is. */
static void show_piece(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                       const step_piece *piece) {
  const strut_step_end *begin = stepper->next, *end = stepper->now;
  const strut_event_view *view = stepper->view;
  const strut_motion_piece seen = {.begin = piece->t,
                                   .length = piece->h,
                                   .moment = moment_after(stepper, piece->t, piece->dt),
                                   .q = {view->q, end->q},
                                   .v = {view->v, end->v},
                                   .a = {begin->a, end->a},
                                   .work = {view->work, state->work},
                                   .power = {begin->power, end->power},
                                   .memory = view->memory,
                                   .smooth = view->smooth,
                                   .hold = hold_contacts,
                                   .workspace = stepper};
  show_contacts(model, state, stepper, end);
  state->watched.observer->see(state->watched.observer, state, &seen);
  stepper->view->smooth = true;
}

/* Speeds that errors compare with, how far margins of kinks go, and which contacts are at rest. */
static void keep_scales(strut_event_stepper *stepper, const step_piece *piece) {
  for (int32_t k = 0; k < stepper->laws.count; k++) {
    int32_t i = stepper->laws.item[k].kink - 1;
    if (i >= 0)
      stepper->kinks.largest[i] = fmax(stepper->kinks.largest[i], fabs(stepper->now->tension[k]));
  }
  if (stepper->formula->adaptive) strut_contact_rest(stepper, piece->h, piece->event.kind);
  stepper->control.fastest = fmax(stepper->control.fastest, stepper->control.own_speed);
  stepper->control.speed = stepper->control.fastest;
}

/* Makes stepper->next the state. */
static void accept_piece(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                         step_piece *piece) {
  bool observed = stepper->view && state->watched.observer;
  if (!(piece->h > 0.0)) {
    stepper->chatter.at_once++;
    piece->t += moment_after(stepper, piece->t, piece->dt);
    return;
  }
  if (state->watched.variation) strut_variation_step(model, state, stepper, piece->t, piece->h);
  if (observed) {
    strut_event_view *view = stepper->view;
    memcpy(view->q, state->q, (size_t)model->length * sizeof(double));
    memcpy(view->v, state->v, (size_t)model->length * sizeof(double));
    memcpy(view->work, state->work, sizeof view->work);
    strut_history_store(model, state, view->memory);
  }
  accept_step(model, state, stepper, state->balance);
  if (stepper->scales) keep_scales(stepper, piece);
  if (observed) show_piece(model, state, stepper, piece);
  stepper->chatter.at_once = 0;
  if (piece->h > SEPARATES * (stepper->formula->adaptive ? stepper->control.h : piece->dt))
    stepper->chatter.switches = 0;
}

/* The mode that ends at the piece's end gives way to the next one, and what follows from that. */
static void meet_event(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                       const step_piece *piece) {
  const strut_event *event = &piece->event;
  double t = piece->t + piece->h;
  if (state->watched.variation)
    strut_variation_meet(model, state, stepper, event, t, piece->dt, piece->h > 0.0);
  strut_event_apply(model, state, stepper, *event, t);
  int32_t touched = model->feedback.trigger_count ? touched_by(model, stepper, event) : -1;
  if (touched >= 0) start_signals(model, state, stepper, touched, t, piece->dt);
  if (event->kind == STRUT_EVENT_THRESHOLD)
    pass_threshold(model, state, stepper, &stepper->laws.item[event->index], t, piece->dt);
  state->events++;
  count_switch(model, &stepper->chatter, piece);
  if (event->kind == STRUT_EVENT_THRESHOLD && stepper->laws.item[event->index].kink)
    release_kink(model, state, stepper, piece, stepper->laws.item[event->index].kink - 1);
}

/* Modes and accelerations at the piece's end. */
static void switch_modes(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                         const step_piece *piece) {
  if (piece->event.kind)
    meet_event(model, state, stepper, piece);
  else if (piece->forced)
    strut_modes_start(model, state, stepper, piece->t + piece->h);
  else if (strut_modes_after_step(model, stepper))
    strut_evaluate_acceleration(model, state, stepper, piece->t + piece->h);
  else
    return;
  end_smooth(stepper);
  if (state->watched.variation && (piece->event.kind || piece->forced))
    strut_variation_pass(model, state, stepper, piece->event.kind != STRUT_EVENT_NONE);
}

/* One trial over at most h at time t. Returns the time gone, 0 if none. */
static double advance_piece(const strut_model *model, strut_state *state,
                            strut_event_stepper *stepper, double t, double h, double dt) {
  step_piece piece = {.t = t, .h = h, .dt = dt};
  const strut_chatter *chatter = &stepper->chatter;
  if ((chatter->at_once > 0 && chatter->most >= MOST_AT_ONCE) ||
      chatter->switches >= MOST_SWITCHES) { /* whatever the modes say */
    if (!force_piece(model, state, stepper, &piece)) return 0.0;
  } else {
    predict_piece(model, state, stepper, &piece);
    bool moves = piece.h > 0.0;
    if (moves && !take_piece(model, state, stepper, &piece)) return 0.0;
    if (moves && !locate_end(model, state, stepper, &piece)) return 0.0;
  }
  accept_piece(model, state, stepper, &piece);
  switch_modes(model, state, stepper, &piece);
  return piece.h;
}

/*
 * Error control may take long within one step of the grid: when interrupted, or out of work allowed, it
 * goes back to the start of it. The last two stages hold that.
 */
static bool given_up(const strut_model *model, strut_state *state, strut_event_stepper *stepper) {
  double **kept = stepper->stage + stepper->formula->stages - 2;
  bool spent = is_spent(state), wanted = is_wanted_back(state);
  size_t bytes = (size_t)model->length * sizeof(double);
  if (stepper->done == 0.0) {
    memcpy(kept[0], state->q, bytes);
    memcpy(kept[1], state->v, bytes);
    memcpy(stepper->control.work, state->work, sizeof stepper->control.work);
    if (model->terms & STRUT_TERM_MEMORY) strut_history_store(model, state, state->history.kept);
  } else if (wanted) {
    memcpy(state->q, kept[0], bytes);
    memcpy(state->v, kept[1], bytes);
    memcpy(state->work, stepper->control.work, sizeof stepper->control.work);
    strut_elements_keep_turns(model, state);
    if (model->terms & STRUT_TERM_MEMORY) strut_history_load(model, state, state->history.kept);
  }
  if (wanted) state->trouble = spent ? STRUT_FAILURE_WORK : STRUT_FAILURE_INTERRUPT;
  return wanted;
}

/* One step within the grid's, and what happens in it. */
static void take_step(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                      double dt) {
  double t = (double)state->step * dt + stepper->done;
  double h = shown_step_size(model, state, stepper, next_step_size(state, stepper, dt), dt);
  double gone = advance_piece(model, state, stepper, evaluation_time(stepper, t, dt), h, dt);
  if (state->watched.event_log) strut_event_log_note(model, state, stepper, t + gone);
  advance_within_grid(state, stepper, gone, dt);
  if (stepper->next_break < HUGE_VAL) pass_break(model, state, stepper, dt);
}

void strut_event_stepper_advance(const strut_model *model, strut_state *state, void *workspace,
                                 double dt, int64_t count) {
  strut_event_stepper *stepper = workspace;
  if (!stepper->started) strut_event_stepper_restart(model, state, workspace, dt);
  for (int64_t end = state->step + count; state->step < end && !state->trouble;) {
    if (stepper->formula->advance_until_event && stepper->chatter.at_once == 0 &&
        !model->contacts.surface && !state->watched.observer && !state->watched.rehearsals)
      stepper->formula->advance_until_event(model, state, stepper, dt, end);
    if (state->step == end || (stepper->formula->adaptive && given_up(model, state, stepper)))
      break;
    take_step(model, state, stepper, dt);
  }
  show_contacts(model, state, stepper, stepper->now);
}
