/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: forces and accelerations with the contacts' modes frozen. See event_stepping.h.
 *
 * `terms` are those that a copy knows, see STRUT_TERMS_RARE in model.h.
 */
#pragma once

#include <float.h>
#include <math.h>

#include "engine/forces/forces_kernel.h"
#include "engine/forces/history.h"
#include "engine/integrate/events/contacts/mode_law.h"
#include "engine/integrate/events/event_stepping.h"
#include "engine/model/pose.h"

/* Kinematics of contact i of a single straight ground at q, v. */
STRUT_INLINE void measure_on_line(const strut_contact_table *contacts, int32_t i,
                                  const double *restrict q, const double *restrict v,
                                  strut_touch *touch) {
  touch->gap = strut_ground_gap(contacts, q + contacts->at[i]);
  touch->into = strut_contact_along_normal(contacts, i, v);
  touch->slip = strut_contact_slip(contacts, i, v);
}

/* The frames of contacts with surfaces at an end; NULL of a single straight ground, and without STRUT_TERM_SURFACES. */
STRUT_INLINE strut_contact_frame *frames_of(const strut_step_end *end, unsigned terms) {
  return terms & STRUT_TERM_SURFACES ? end->frame : NULL;
}

/* Kinematics of contact i at an end of a step. */
STRUT_INLINE void measure_at_end(const strut_contact_table *contacts,
                                 const strut_contact_modes *modes, const strut_step_end *end,
                                 int32_t i, unsigned terms, strut_touch *touch) {
  strut_contact_frame frame;
  if (frames_of(end, terms))
    strut_surface_measure(contacts, modes, end->motion, i, end->q, end->v, touch, &frame);
  else
    measure_on_line(contacts, i, end->q, end->v, touch);
}

/* Adds the forces of the closed contacts at q, v to `force` and notes them at an end. */
STRUT_LOOP void add_contact_forces(const strut_model *model, const strut_event_stepper *stepper,
                                   const double *restrict q, const double *restrict v,
                                   double *restrict force, bool damped, strut_step_end *end,
                                   unsigned terms) {
  if (frames_of(end, terms)) {
    strut_surface_add_forces(model, stepper, q, v, force, damped, end);
    return;
  }
  const strut_contact_table table = model->contacts, *c = &table; /* which no store can change */
  strut_touch *restrict touch = end->touch;
  const int32_t *restrict closed = stepper->active.closed;
  for (int32_t k = 0, count = stepper->active.closed_count; k < count; k++) {
    int32_t i = closed[k];
    uint32_t at = c->at[i];
    strut_touch *o = &touch[i];
    measure_on_line(c, i, q, v, o);
    o->applied = strut_contact_along_ground(c, i, force);
    o->normal =
        contact_normal_force(&c->entry[i], stepper->modes.damper[i], o->gap, o->into, damped);
    o->friction = friction_in_mode(&c->entry[i], &stepper->modes, i, o);
    force[at] += o->friction * c->tangent[0] + o->normal * c->normal[0];
    force[at + 1] += o->friction * c->tangent[1] + o->normal * c->normal[1];
  }
}

/* Rates of speed of the closed contacts from the acceleration. */
STRUT_INLINE void measure_contact_rates(const strut_model *model, const strut_active_set *active,
                                        const strut_step_end *end, unsigned terms) {
  const strut_contact_table *contacts = &model->contacts;
  const double *restrict a = end->a;
  strut_touch *restrict touch = end->touch;
  const strut_contact_frame *frame = frames_of(end, terms);
  for (int32_t k = 0; k < active->closed_count && frame; k++)
    strut_surface_measure_rates(contacts, active->closed[k], a, &touch[active->closed[k]],
                                &frame[active->closed[k]]);
  for (int32_t k = 0; k < active->closed_count && !frame; k++) {
    int32_t i = active->closed[k];
    touch[i].into_rate = strut_contact_along_normal(contacts, i, a);
    touch[i].slip_rate = strut_contact_along_ground(contacts, i, a);
  }
}

/* The ground's powers, from forces and speeds noted at an end; the others are in state->latest->power. */
STRUT_INLINE void add_contact_powers(const strut_model *model, const strut_state *state,
                                     const strut_active_set *active, const strut_step_end *end,
                                     unsigned terms) {
  const strut_contact_table *contacts = &model->contacts;
  const strut_touch *restrict touch = end->touch;
  const strut_contact_frame *frame = frames_of(end, terms);
  double *power = state->latest->power, contact = power[STRUT_POWER_CONTACT],
         friction = power[STRUT_POWER_FRICTION], belt = power[STRUT_POWER_BELT],
         exchanged = power[STRUT_POWER_EXCHANGED];
  for (int32_t k = 0; k < active->closed_count; k++) {
    int32_t i = active->closed[k];
    const strut_touch *o = &touch[i];
    double damped = -(o->normal + contacts->entry[i].stiffness * o->gap) * o->into;
    double rubbed = -o->friction * o->slip, carried = o->friction * contacts->belt_speed;
    if (frame)
      carried =
          o->friction * strut_contact_belt(contacts, i) + strut_surface_moving_power(o, &frame[i]);
    contact += damped, friction += rubbed, belt += carried;
    exchanged += fabs(damped) + fabs(rubbed) + fabs(carried);
  }
  power[STRUT_POWER_CONTACT] = contact, power[STRUT_POWER_FRICTION] = friction;
  power[STRUT_POWER_BELT] = belt, power[STRUT_POWER_EXCHANGED] = exchanged;
}

/* Notes the forces of the structure at an end of a step. */
STRUT_INLINE void keep_structure_forces(const strut_model *model, const strut_state *state,
                                        strut_step_end *end, bool balance) {
  for (int32_t i = 0; i < model->length; i += STRUT_LANES)
    strut_lanes_store(end->structure + i, strut_lanes_load_pairs(state->latest->force + i));
  for (int p = 0; p < STRUT_POWER_ROOM && balance; p += STRUT_LANES)
    strut_lanes_store(end->structure_power + p, strut_lanes_load(state->latest->power + p));
}

/* Notes the motion of the grounds for which forces have just been evaluated. */
STRUT_INLINE void keep_ground_motion(const strut_model *model, const strut_state *state,
                                     strut_step_end *end, unsigned terms) {
  if (!(terms & STRUT_TERM_SURFACES) || !end->motion) return;
  for (size_t g = 0; g < model->scene->ground_count; g++)
    end->motion[g] = state->latest->ground_motion[g];
}

/* From the forces of the structure in state->latest->force to the acceleration. */
STRUT_LOOP void accelerate_closed(const strut_model *model, const strut_state *state,
                                  strut_event_stepper *stepper, const double *restrict q,
                                  const double *restrict v, double *restrict a, strut_step_end *end,
                                  unsigned terms, bool balance) {
  const strut_active_set *active = &stepper->active;
  bool sliding = model->terms & terms & STRUT_TERM_SLIDING_MASS;
  if (active->closed_count)
    add_contact_forces(model, stepper, q, v, state->latest->force, true, end, terms);
  divide_by_mass(model, state, a, terms);
  if (sliding) strut_refresh_compliances(model, state, stepper);
  if (active->stuck_count) strut_solve_stick_constraints(model, stepper, a, end);
  if (balance && active->closed_count) add_contact_powers(model, state, active, end, terms);
  if (balance && sliding) strut_sliding_masses_add_power(model, state, q, v, a);
}

/* The forces of the structure in the modes of members that may shrink to nothing. */
STRUT_LOOP void forces_in_modes(const strut_model *model, const strut_state *state,
                                const strut_event_stepper *stepper, double t,
                                const double *restrict q, const double *restrict v, unsigned terms,
                                bool balance) {
  forces_of_structure(model, state, t, q, v, terms, balance);
  if (stepper->turns.on) strut_turns_hold(model, state, stepper, q, v);
}

/* Acceleration with explicit contact dampers inside a step; contact forces into end->touch. */
STRUT_LOOP void accelerate_in_modes(const strut_model *model, const strut_state *state,
                                    strut_event_stepper *stepper, double t,
                                    const double *restrict q, const double *restrict v,
                                    double *restrict a, strut_step_end *end, unsigned terms,
                                    bool balance) {
  forces_in_modes(model, state, stepper, t, q, v, terms, balance);
  keep_ground_motion(model, state, end, terms);
  accelerate_closed(model, state, stepper, q, v, a, end, terms, balance);
}

/* Contacts at the edge of their band, but for rounding, at the end of a step. */
STRUT_INLINE void settle_band_ties(const strut_model *model, const strut_event_stepper *stepper) {
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    int32_t i = stepper->active.closed[k];
    settle_band_tie(&model->contacts.entry[i], &stepper->modes, i, &stepper->next->touch[i]);
  }
}

/* The same at the end of a step, with all that belongs to that end. */
STRUT_LOOP void evaluate_step_end(const strut_model *model, const strut_state *state,
                                  strut_event_stepper *stepper, double t, strut_step_end *end,
                                  unsigned terms, bool balance) {
  forces_in_modes(model, state, stepper, t, end->q, end->v, terms, balance);
  keep_structure_forces(model, state, end, balance);
  keep_ground_motion(model, state, end, terms);
  accelerate_closed(model, state, stepper, end->q, end->v, end->a, end, terms, balance);
  measure_contact_rates(model, &stepper->active, end, terms);
  if (end == stepper->next && !stepper->active.all_sliding) settle_band_ties(model, stepper);
  for (int p = 0; p < STRUT_POWER_COUNT && balance; p++) end->power[p] = state->latest->power[p];
}

/* next becomes now: q and v are the state's own and are copied, the rest changes hands. */
STRUT_INLINE void accept_step(const strut_model *model, strut_state *state,
                              strut_event_stepper *stepper, bool balance) {
  strut_step_end *now = stepper->next, *next = stepper->now;
  double *restrict q = now->q, *restrict v = now->v;
  for (int32_t i = 0; i < model->length; i += STRUT_LANES) {
    strut_lanes_store(next->q + i, strut_lanes_load(q + i));
    strut_lanes_store(next->v + i, strut_lanes_load(v + i));
  }
  now->q = next->q, now->v = next->v;
  next->q = q, next->v = v;
  stepper->now = now, stepper->next = next;
  if (model->terms & STRUT_TERM_ELEMENTS) strut_elements_keep_turns(model, state);
  if (model->terms & STRUT_TERM_MEMORY) strut_history_keep(model, state);
  if (stepper->turns.on) strut_turns_keep(model, state, stepper);
  stepper->fresh = true;
  for (int p = 0; p < STRUT_POWER_ROOM && balance; p += STRUT_LANES)
    strut_lanes_store(state->work + p,
                      strut_lanes_load(state->work + p) + strut_lanes_load(stepper->gained + p));
}

/* Part of what is left of a step, after which what has begun still lasts. */
static const double SOON = 0.1;

/* Part of a hundredth of the size that lengths may be off; without error control a fixed one. */
STRUT_INLINE double strut_faint_part(const strut_event_stepper *stepper) {
  return stepper->formula->adaptive ? fmax(0.1 * stepper->control.tolerance, 1e-12) : 1e-7;
}
STRUT_INLINE double strut_faint_length(const strut_model *model,
                                       const strut_event_stepper *stepper) {
  return 0.01 * strut_faint_part(stepper) * model->size;
}

/* The smaller of two fractions of a step; 0 stands for none. */
STRUT_INLINE double earlier(double one, double other) {
  return one == 0.0 || (other > 0.0 && other < one) ? other : one;
}

/* A drive's jump this close to a point of the grid, in grid steps, is there. */
static const double STRUT_AT_BREAK = 1e-9;

/*
 * Signals are evaluated a moment before the time: a step that ends where a drive jumps so sees the
 * value from before the jump, and the one that begins there that from after it.
 */
STRUT_INLINE double moment_before(double t, double dt) {
  double least = 4.0 * DBL_EPSILON * t, part = 1e-12 * dt;
  return least > part ? least : part;
}

/* Size of the next step within what is left to the grid point. */
STRUT_INLINE double next_step_size(const strut_state *state, const strut_event_stepper *stepper,
                                   double dt) {
  double rest = dt - stepper->done, h = rest;
  if (stepper->formula->adaptive) {
    h = stepper->control.h > 0.0 ? stepper->control.h : dt * 1e-3;
    if (h < rest && h > 0.5 * rest) h = 0.5 * rest;
  } else if (stepper->control.refine > 1.0 &&
             (double)state->step * dt + stepper->done < state->refined_until) {
    h = dt / stepper->control.refine;
  }
  if (stepper->next_break < HUGE_VAL) {
    double left =
        stepper->next_break - ((double)state->step * dt + stepper->done + state->time_offset);
    if (left < h) h = left;
  }
  return h > rest * (1.0 - 1e-9) ? rest : h;
}

/* What a signal does for a smaller part of its size may be missed by fixed steps. */
static const double FAINT_SIGNAL = 1e-6;
/* Steps are not shorter than this part of the longest for a signal's sake. */
static const double LEAST_SHOWN = 1e-9;

/*
 * Size of the next step, at most h, which shows what signals do within it. Methods without error control see little but
 * ends: two of their steps show what a half does.
 */
STRUT_INLINE double shown_step_size(const strut_model *model, const strut_state *state,
                                    const strut_event_stepper *stepper, double h, double dt) {
  if (!stepper->looks) return h;
  bool controlled = stepper->formula->adaptive;
  double t = (double)state->step * dt + stepper->done + state->time_offset;
  double ahead = controlled ? h : 4.0 * h,
         faint = controlled ? stepper->control.tolerance : FAINT_SIGNAL;
  double shown = strut_drive_longest_step(model, state, t, ahead, faint, LEAST_SHOWN * dt);
  return shown < ahead ? h * (shown / ahead) : h;
}

/* Error that a step of h may have in velocities [m/s]; not below rounding: a structure at rest has no speed to compare
   it with. */
STRUT_INLINE double allowed_speed(const strut_step_control *control, double h) {
  double allowed = control->speed * control->tolerance, least = h * control->rounding;
  return allowed > least ? allowed : least;
}

/* Local error of a step of h over what is allowed, by those of positions and of velocities. */
STRUT_INLINE double relative_error(const strut_model *model, const strut_step_control *control,
                                   double h, double position, double velocity) {
  double error = position / (0.01 * model->size * control->tolerance);
  double other = velocity > 0.0 ? velocity / allowed_speed(control, h) : 0.0;
  return other > error ? other : error;
}

/* Errors of what rests may be so many times that of one step, where its length is near the limit of stability. */
static const double REST = 30.0;

/* Is this a speed, after a step of h, of which error control does not know the sign? A step by derivatives keeps to
   its modes, whose kinks these do not see. */
STRUT_INLINE bool is_at_rest(const strut_event_stepper *stepper, double speed, double h) {
  return stepper->formula->adaptive && !stepper->implicit &&
         fabs(speed) <= REST * allowed_speed(&stepper->control, h);
}

/* New step after an error of stepper->control.error. */
STRUT_INLINE void control_step(strut_event_stepper *stepper, double h, bool whole) {
  strut_step_control *control = &stepper->control;
  double factor = 0.9 * pow(fmax(control->error, 1e-10), -1.0 / stepper->formula->tableau->order);
  factor = factor < 0.2 ? 0.2 : factor > 5.0 ? 5.0 : factor;
  if (!whole || factor < 1.0 || factor * h > control->h) control->h = factor * h;
}

/* Has the method made all evaluations that it may? */
STRUT_INLINE bool is_spent(const strut_state *state) {
  return state->limits.most_evaluations > 0 &&
         state->latest->evaluations > state->limits.most_evaluations;
}

/* Is it to give up, for that or on an interrupt? */
STRUT_INLINE bool is_wanted_back(const strut_state *state) {
  return is_spent(state) || (state->limits.interrupt && *state->limits.interrupt);
}

/* The time at which a step from t is evaluated; see moment_before. */
STRUT_INLINE double evaluation_time(const strut_event_stepper *stepper, double t, double dt) {
  return stepper->next_break < HUGE_VAL ? t - moment_before(t, dt) : t;
}

/* After a step of `gone`: on to the next grid point when this one is reached. */
STRUT_INLINE void advance_within_grid(strut_state *state, strut_event_stepper *stepper, double gone,
                                      double dt) {
  double rest = dt - stepper->done;
  stepper->done = gone == rest ? dt : stepper->done + gone;
  if (dt - stepper->done > 1e-12 * dt) return;
  stepper->done = 0.0;
  stepper->chatter.switches = 0;
  state->step++;
}

/* The gap of a contact at an end of a step; of a closed contact over its facet. */
STRUT_INLINE double gap_at_end(const strut_contact_table *contacts,
                               const strut_contact_modes *modes, int32_t i,
                               const strut_step_end *end, unsigned terms) {
  if (!frames_of(end, terms)) return strut_ground_gap(contacts, end->q + contacts->at[i]);
  int32_t facet = modes->of[i] == STRUT_MODE_OPEN ? -1 : modes->facet[i];
  return strut_contact_pose_at(contacts, i, end->q, end->motion, facet).gap;
}

/* The value that the switch of a law ends at 0. */
STRUT_INLINE double law_value(const strut_event_stepper *stepper, const strut_step_end *end,
                              int32_t i) {
  const strut_law_switch *law = &stepper->laws.item[i];
  if (law->event != STRUT_EVENT_ACTS) return end->tension[i];
  double k = law->stiffness, d = law->damping;
  double elastic = (k > 0.0   ? k
                    : d > 0.0 ? d / stepper->control.wanted_step
                              : 1.0) *
                   end->stretch[i];
  return strut_law_cable_margin(stepper->laws.acting[i], elastic, end->tension[i], law->abrupt);
}

/** Defines NAME_trial, the trial of a strut_step_formula, which runs `take` in copies: STRUT_COPIES. */
#define STRUT_EVENT_TRIAL(name, take)                                                              \
  STRUT_COPIES(name##_once, take,                                                                  \
               (const strut_model *model, const strut_state *state, strut_event_stepper *stepper,  \
                double t, double h),                                                               \
               model, state, stepper, t, h)                                                        \
                                                                                                   \
  static void name##_trial(const strut_model *model, const strut_state *state,                     \
                           strut_event_stepper *stepper, double t, double h) {                     \
    if (state->watched.rehearsals) strut_event_rehearse(name##_once, model, state, stepper, t, h); \
    name##_once(model, state, stepper, t, h);                                                      \
  }
