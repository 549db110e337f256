/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: steps of small models by the methods that locate events exactly: one trial, and many while nothing
 * happens.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_EXACT_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_EXACT_H

#include "engine/integrate/events/small/small_adaptive.h"
#include "engine/integrate/events/small/small_rk4_events.h"

/* The step of a pair, where `adaptive`, or of rk4-events, and what settle_band_ties does to its end. */
STRUT_SMALL_INLINE void small_exact_step(small_events *e, const strut_model *model,
                                         strut_state *state, double t, double h, bool adaptive,
                                         const small_end_point *now, small_end_point *next,
                                         small_work *gained, bool balance) {
  if (adaptive)
    small_adaptive_step(e, model, state, t, h, now, next, gained, balance);
  else
    small_rk4_events_step(e, model, state, t, h, now, next, gained, balance);
  if (e->stepper->closed_count && !e->stepper->all_sliding) small_settle_ties(e);
}

STRUT_SMALL_INLINE small_end_point small_end_now(const strut_model *model,
                                                 const strut_event_stepper *l) {
  const strut_small_model *s = model->small;
  const strut_step_end *now = l->now;
  return (small_end_point){small_read(s, now->q), small_read(s, now->v), small_read(s, now->a),
                           small_work_load(now->power)};
}

/* Where the grid step under way began; see given_up. */
typedef struct small_grid_start {
  small_points q, v;
  small_work work;
  bool known;
} small_grid_start;

STRUT_SMALL_INLINE void small_keep_start(const small_grid_start *start, const strut_model *model,
                                         strut_event_stepper *l) {
  if (!start->known) return;
  small_write(model->small, &start->q, l->stage[l->stepper->stages - 2]);
  small_write(model->small, &start->v, l->stage[l->stepper->stages - 1]);
  small_work_store(l->work, start->work);
}

/* What steps are asked for: one, from time t over h; or, quiet, those of dt to grid point `end` until
   something happens. */
typedef struct small_request {
  double t, h, dt;
  int64_t end;
  bool quiet;
} small_request;

/* The next quiet step, if there is one and nobody wants the method to give up. */
STRUT_SMALL_INLINE bool small_next_quiet(const strut_state *state, const strut_event_stepper *l,
                                         small_request *r) {
  if (state->step >= r->end || (l->stepper->adaptive && is_wanted_back(state))) return false;
  double t = (double)state->step * r->dt + l->done;
  r->h = next_step_size(state, l, r->dt);
  r->t = evaluation_time(l, t, r->dt);
  return !(t + r->h + state->time_offset > l->next_break - STRUT_AT_BREAK * r->dt);
}

/* Does anything happen in the step? */
STRUT_SMALL_INLINE bool small_is_eventful(const small_events *e, const strut_model *model, double h,
                                          bool adaptive, const small_end_point *now,
                                          const small_end_point *next) {
  if (adaptive && (!(e->stepper->error <= 1.0) || small_spent(e))) return true;
  if (small_exact_event(e, next)) return true;
  return adaptive && model->contacts.count && small_dips(e, model, h, now, next);
}

/* Leaves the step that has been tried, or is asked for, in l->next. */
STRUT_SMALL_INLINE void small_exact(const strut_model *model, strut_state *state,
                                    strut_event_stepper *l, small_request r, unsigned terms,
                                    bool adaptive, bool balance) {
  small_events e = small_events_begin(model, l, terms);
  small_kept kept;
  small_end_point now = small_end_now(model, l), next;
  small_work gained = small_work_load(l->gained), work = small_work_load(state->work);
  small_grid_start start = {.known = false};
  bool tried = false, taken = false;
  while (!r.quiet || small_next_quiet(state, l, &r)) {
    if (r.quiet && adaptive && l->done == 0.0) start = (small_grid_start){now.q, now.v, work, true};
    small_exact_step(&e, model, state, r.t, r.h, adaptive, &now, &next, &gained, balance);
    tried = !r.quiet || small_is_eventful(&e, model, r.h, adaptive, &now, &next);
    if (tried) break;
    taken = true;
    kept = small_kept_of(&e);
    now = next;
    if (balance) small_add_powers(&work, &gained);
    if (adaptive) control_step(l, r.h, r.h < l->h);
    advance_within_grid(state, l, r.h, r.dt);
  }
  if (r.quiet) l->tried = tried;
  small_keep_start(&start, model, l);
  if (!taken && !tried) return;
  if (balance) small_work_store(l->gained, gained);
  if (taken) {
    small_events at_now = small_at_kept(&e, &kept);
    small_keep_end(&at_now, model, &now.q, &now.v, &now.a, l->now, balance);
    if (balance) small_work_store(state->work, work);
    l->fresh = true;
  }
  if (tried && adaptive) small_keep_least(&e, model);
  if (tried) small_keep_end(&e, model, &next.q, &next.v, &next.a, l->next, balance);
  small_leave(&e, model, state, balance);
}

/* Defines the trial and the quiet steps of a method: copies for models with common terms only and for all, with
   the energy balance and without. */
#define STRUT_SMALL_EXACT_COPY(name, copy, terms, adaptive, balance)                               \
  STRUT_SMALL_TARGET                                                                               \
  static void name##_##copy(const strut_model *model, strut_state *state, strut_event_stepper *l,  \
                            small_request r) {                                                     \
    small_exact(model, state, l, r, terms, adaptive, balance);                                     \
  }

#define STRUT_SMALL_EXACT(name, adaptive)                                                          \
  STRUT_SMALL_EXACT_COPY(name, usual_with_balance, STRUT_SMALL_USUAL, adaptive, true)              \
  STRUT_SMALL_EXACT_COPY(name, usual, STRUT_SMALL_USUAL, adaptive, false)                          \
  STRUT_SMALL_EXACT_COPY(name, any, STRUT_TERMS_ALL, adaptive, state->balance)                     \
  static void name##_steps(const strut_model *model, strut_state *state, strut_event_stepper *l,   \
                           small_request r) {                                                      \
    if (small_copy_of(model) < 2)                                                                  \
      name##_any(model, state, l, r);                                                              \
    else if (state->balance)                                                                       \
      name##_usual_with_balance(model, state, l, r);                                               \
    else                                                                                           \
      name##_usual(model, state, l, r);                                                            \
  }                                                                                                \
                                                                                                   \
  void STRUT_SMALL_NAME(name)(const strut_model *model, strut_state *state,                        \
                              strut_event_stepper *l, double t, double h) {                        \
    name##_steps(model, state, l, (small_request){.t = t, .h = h});                                \
  }                                                                                                \
  void STRUT_SMALL_NAME(name##_quiet)(const strut_model *model, strut_state *state,                \
                                      strut_event_stepper *l, double dt, int64_t end) {            \
    name##_steps(model, state, l, (small_request){.dt = dt, .end = end, .quiet = true});           \
  }

#endif
