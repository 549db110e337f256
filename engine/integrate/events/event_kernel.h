/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: forces and accelerations with the contacts' modes frozen. See event_stepping.h.
 *
 * `terms` are those that a copy knows, see STRUT_TERMS_RARE in model.h.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_EVENT_KERNEL_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_EVENT_KERNEL_H

#include <float.h>
#include <math.h>

#include "engine/forces/forces_kernel.h"
#include "engine/integrate/events/contacts/mode_law.h"
#include "engine/integrate/events/contacts/surface_contacts.h"
#include "engine/integrate/events/event_stepping.h"
#include "engine/model/pose.h"

/* Normal force of the spring and, where `damped`, the damper, of a contact that touches. */
STRUT_INLINE double contact_normal_force(const strut_contact_entry *e, int8_t damper, double gap,
                                         double into, bool damped) {
  const strut_law_ground_numbers numbers = strut_contact_numbers(e);
  bool acts = damper ? damper > 0 : into<0.0, crossley = e->dissipation> 0.0;
  return damped ? strut_law_ground_normal_in_mode(&numbers, acts, gap, into, crossley)
                : strut_law_ground_spring(&numbers, gap);
}

/* The most that friction holds against a push, and with which it slides, in this direction [N]. */
STRUT_INLINE double holding_limit(const strut_contact_entry *e, double normal, double towards) {
  return strut_friction_static(&e->friction, towards) * normal;
}
STRUT_INLINE double sliding_limit(const strut_contact_entry *e, double normal, double towards) {
  return strut_friction_kinetic(&e->friction, towards) * normal;
}

/* Half the layer about the threshold mu_0 N in which a contact yields, relative. */
static const double STRUT_YIELD_LAYER = 1e-3;

/* Friction between holding and pushing, by how far the applied force is through the layer. */
STRUT_INLINE double yield_friction(const strut_contact_entry *e, double normal, double applied) {
  double threshold = holding_limit(e, normal, applied), half = STRUT_YIELD_LAYER * threshold;
  double size = applied < 0.0 ? -applied : applied;
  double pushed = half > 0.0 ? 0.5 + 0.5 * (size - threshold) / half : 1.0;
  pushed = pushed < 0.0 ? 0.0 : pushed > 1.0 ? 1.0 : pushed;
  double friction =
      (1.0 - pushed) * size + pushed * strut_friction_kinetic(&e->friction, applied) * normal;
  return applied < 0.0 ? friction : -friction;
}

/* Friction by the mode; a multiplier, which comes later, is 0 here. */
STRUT_INLINE double friction_in_mode(const strut_contact_entry *e, uint8_t mode, int8_t side,
                                     double normal, double slip, double applied) {
  switch ((strut_contact_mode)mode) {
    case STRUT_MODE_SLIP:
    case STRUT_MODE_PUSH: return -side * strut_friction_kinetic(&e->friction, side) * normal;
    case STRUT_MODE_SLIDE:
      return strut_friction_is_continuous(e->friction.law)
                 ? strut_friction_force(&e->friction, normal, slip, applied)
                 : 0.0;
    case STRUT_MODE_BAND:
      return strut_law_friction_in_band(holding_limit(e, normal, applied), applied);
    case STRUT_MODE_YIELD: return yield_friction(e, normal, applied);
    case STRUT_MODE_OPEN:
    case STRUT_MODE_STICK:
    case STRUT_MODE_CREEP: break;
  }
  return 0.0;
}

/* Kinematics of contact i of a single straight ground at q, v. */
STRUT_INLINE void measure_on_line(const strut_contact_table *c, int32_t i, const double *restrict q,
                                  const double *restrict v, strut_touch *touch) {
  touch->gap = strut_ground_gap(c, q + c->at[i]);
  touch->into = strut_contact_along_normal(c, i, v);
  touch->slip = strut_contact_slip(c, i, v);
}

/*
 * The frames of the contacts at an end, where these are of surfaces; NULL of a single straight ground, as a
 * copy without STRUT_TERM_SURFACES knows beforehand.
 */
STRUT_INLINE strut_contact_frame *frames_of(const strut_step_end *end, unsigned terms) {
  return terms & STRUT_TERM_SURFACES ? end->frame : NULL;
}

/* Kinematics of contact i at an end of a step. */
STRUT_INLINE void measure_at_end(const strut_contact_table *c, const strut_event_stepper *l,
                                 const strut_step_end *end, int32_t i, unsigned terms,
                                 strut_touch *touch) {
  strut_contact_frame frame;
  if (frames_of(end, terms))
    strut_surface_measure(c, l, end->motion, i, end->q, end->v, touch, &frame);
  else
    measure_on_line(c, i, end->q, end->v, touch);
}

/* Adds the forces of the closed contacts at q, v to `force` and notes them at an end. */
STRUT_LOOP void add_contact_forces(const strut_model *model, const strut_event_stepper *l,
                                   const double *restrict q, const double *restrict v,
                                   double *restrict force, bool damped, strut_step_end *end,
                                   unsigned terms) {
  const strut_contact_table *c = &model->contacts;
  strut_touch *restrict touch = end->touch;
  if (frames_of(end, terms)) {
    strut_surface_add_forces(model, l, q, v, force, damped, end);
    return;
  }
  for (int32_t k = 0; k < l->closed_count; k++) {
    int32_t i = l->closed[k];
    uint32_t at = c->at[i];
    strut_touch *o = &touch[i];
    measure_on_line(c, i, q, v, o);
    o->applied = strut_contact_along_ground(c, i, force);
    o->normal = contact_normal_force(&c->entry[i], l->damper[i], o->gap, o->into, damped);
    o->friction =
        friction_in_mode(&c->entry[i], l->mode[i], l->side[i], o->normal, o->slip, o->applied);
    force[at] += o->friction * c->tangent[0] + o->normal * c->normal[0];
    force[at + 1] += o->friction * c->tangent[1] + o->normal * c->normal[1];
  }
}

/* Rates of speed of the closed contacts from the acceleration. */
STRUT_INLINE void measure_contact_rates(const strut_model *model, const strut_event_stepper *l,
                                        const strut_step_end *end, unsigned terms) {
  const strut_contact_table *c = &model->contacts;
  const double *restrict a = end->a;
  strut_touch *restrict touch = end->touch;
  const strut_contact_frame *frame = frames_of(end, terms);
  for (int32_t k = 0; k < l->closed_count && frame; k++)
    strut_surface_measure_rates(c, l->closed[k], a, &touch[l->closed[k]], &frame[l->closed[k]]);
  for (int32_t k = 0; k < l->closed_count && !frame; k++) {
    int32_t i = l->closed[k];
    touch[i].into_rate = strut_contact_along_normal(c, i, a);
    touch[i].slip_rate = strut_contact_along_ground(c, i, a);
  }
}

/* The ground's powers, from forces and speeds noted at an end; the others are in state->latest.power. */
STRUT_INLINE void add_contact_powers(const strut_model *model, strut_state *state,
                                     const strut_event_stepper *l, const strut_step_end *end,
                                     unsigned terms) {
  const strut_contact_table *c = &model->contacts;
  const strut_touch *restrict touch = end->touch;
  const strut_contact_frame *frame = frames_of(end, terms);
  for (int32_t k = 0; k < l->closed_count; k++) {
    const strut_touch *o = &touch[l->closed[k]];
    double damper = o->normal + c->entry[l->closed[k]].stiffness * o->gap;
    double damped = -damper * o->into, rubbed = -o->friction * o->slip;
    double belt = o->friction * c->belt_speed;
    if (frame)
      belt = o->friction * strut_contact_belt(c, l->closed[k]) +
             strut_surface_moving_power(o, &frame[l->closed[k]]);
    state->latest.power[STRUT_POWER_CONTACT] += damped;
    state->latest.power[STRUT_POWER_FRICTION] += rubbed;
    state->latest.power[STRUT_POWER_BELT] += belt;
    state->latest.power[STRUT_POWER_EXCHANGED] += fabs(damped) + fabs(rubbed) + fabs(belt);
  }
}

/* Notes the forces of the structure at an end of a step. */
STRUT_INLINE void keep_structure_forces(const strut_model *model, const strut_state *state,
                                        strut_step_end *end, bool balance) {
  for (int32_t i = 0; i < model->length; i += STRUT_LANES)
    strut_lanes_store(end->structure + i, strut_lanes_load_pairs(state->latest.force + i));
  for (int p = 0; p < STRUT_POWER_ROOM && balance; p += STRUT_LANES)
    strut_lanes_store(end->structure_power + p, strut_lanes_load(state->latest.power + p));
}

/* Notes the motion of the grounds for which forces have just been evaluated. */
STRUT_INLINE void keep_ground_motion(const strut_model *model, const strut_state *state,
                                     strut_step_end *end, unsigned terms) {
  if (!(terms & STRUT_TERM_SURFACES) || !end->motion) return;
  for (size_t g = 0; g < model->scene->ground_count; g++)
    end->motion[g] = state->latest.ground_motion[g];
}

/* From the forces of the structure in state->latest.force to the acceleration. */
STRUT_LOOP void accelerate_closed(const strut_model *model, strut_state *state,
                                  strut_event_stepper *l, const double *restrict q,
                                  const double *restrict v, double *restrict a, strut_step_end *end,
                                  unsigned terms, bool balance) {
  bool sliding = model->terms & terms & STRUT_TERM_SLIDING_MASS;
  if (l->closed_count) add_contact_forces(model, l, q, v, state->latest.force, true, end, terms);
  divide_by_mass(model, state, a, terms);
  if (sliding) strut_refresh_compliances(model, state, l);
  if (l->stuck_count) strut_solve_stick_constraints(model, l, a, end);
  if (balance && l->closed_count) add_contact_powers(model, state, l, end, terms);
  if (balance && sliding) strut_sliding_masses_add_power(model, state, q, v, a);
}

/* Acceleration with explicit contact dampers inside a step; contact forces into end->touch. */
STRUT_LOOP void accelerate_in_modes(const strut_model *model, strut_state *state,
                                    strut_event_stepper *l, double t, const double *restrict q,
                                    const double *restrict v, double *restrict a,
                                    strut_step_end *end, unsigned terms, bool balance) {
  forces_of_structure(model, state, t, q, v, terms, balance);
  keep_ground_motion(model, state, end, terms);
  accelerate_closed(model, state, l, q, v, a, end, terms, balance);
}

/* Do the forces on a contact within its band balance, but for rounding? Then its speed does not change. */
STRUT_INLINE bool band_forces_balance(const strut_event_stepper *l, const strut_touch *o,
                                      int32_t i) {
  return fabs(o->slip_rate) <= STRUT_TIED * o->normal * l->response[i].tangent;
}

/* Contacts at the edge of their band, but for rounding, at the end of a step. */
STRUT_INLINE void settle_band_ties(const strut_model *model, const strut_event_stepper *l) {
  for (int32_t k = 0; k < l->closed_count; k++) {
    int32_t i = l->closed[k];
    double edge = model->contacts.entry[i].friction.stick_velocity;
    strut_touch *o = &l->next->touch[i];
    if (l->mode[i] == STRUT_MODE_CREEP)
      o->friction = strut_law_friction_in_creep(l->side[i], o->normal, o->friction, o->applied);
    if (l->mode[i] == STRUT_MODE_BAND) o->slip = strut_law_slip_in_band(o->slip, edge);
  }
}

/* The same at the end of a step, with all that belongs to that end. */
STRUT_LOOP void evaluate_step_end(const strut_model *model, strut_state *state,
                                  strut_event_stepper *l, double t, strut_step_end *end,
                                  unsigned terms, bool balance) {
  forces_of_structure(model, state, t, end->q, end->v, terms, balance);
  keep_structure_forces(model, state, end, balance);
  keep_ground_motion(model, state, end, terms);
  accelerate_closed(model, state, l, end->q, end->v, end->a, end, terms, balance);
  measure_contact_rates(model, l, end, terms);
  if (end == l->next && !l->all_sliding) settle_band_ties(model, l);
  for (int p = 0; p < STRUT_POWER_COUNT && balance; p++) end->power[p] = state->latest.power[p];
}

/* Edge of the band, or 0 where sticking is exact. */
STRUT_INLINE double stick_band_edge(const strut_contact_entry *e) {
  bool band = strut_friction_has_band(e->friction.law);
  return band ? e->friction.stick_velocity : 0.0;
}

/* Margins at whose zeros the modes of a contact end; see mode_law.h. */
STRUT_INLINE double margin_of_stick(const strut_contact_entry *e, const strut_touch *o) {
  return strut_law_margin_of_holding(holding_limit(e, o->normal, -o->friction), o->friction);
}
STRUT_INLINE double margin_of_creep_out(const strut_contact_entry *e, const strut_touch *o,
                                        double side) {
  return strut_law_margin_of_creep_out(side, sliding_limit(e, o->normal, side), o->friction);
}
STRUT_INLINE double margin_of_creep_in(const strut_contact_entry *e, const strut_touch *o,
                                       double side) {
  double holding = holding_limit(e, o->normal, o->applied);
  double sliding = sliding_limit(e, o->normal, o->applied);
  double at_edge = strut_law_friction_at_edge(holding, sliding, o->applied);
  return strut_law_margin_of_creep_in(side, at_edge, o->friction);
}
STRUT_INLINE double margin_of_push(const strut_contact_entry *e, const strut_touch *o, uint8_t mode,
                                   double side) {
  double holding = holding_limit(e, o->normal, o->applied);
  return mode == STRUT_MODE_PUSH ? strut_law_margin_of_push(side, holding, o->applied)
                                 : strut_law_margin_of_holding(holding, o->applied);
}

/* How far the applied force is from either end of the range in which a contact keeps yielding [N]. */
STRUT_INLINE double margin_of_yield(const strut_contact_entry *e, const strut_touch *o) {
  double threshold = holding_limit(e, o->normal, o->applied);
  return 2.0 * STRUT_YIELD_LAYER * threshold - fabs(fabs(o->applied) - threshold);
}

/* What but its speed ends the mode of a contact within its band. */
STRUT_INLINE strut_event_kind event_within_band(const strut_contact_entry *e, const strut_touch *o,
                                                uint8_t mode, double s) {
  if (mode == STRUT_MODE_YIELD)
    return margin_of_yield(e, o) < 0.0 ? STRUT_EVENT_YIELDED : STRUT_EVENT_NONE;
  if (!strut_friction_drops(&e->friction)) return STRUT_EVENT_NONE;
  double margin = margin_of_push(e, o, mode, s);
  bool holds = mode == STRUT_MODE_PUSH ? margin > 0.0 : !(margin < 0.0);
  return holds ? STRUT_EVENT_NONE : STRUT_EVENT_PUSH;
}

/* The event that ends the mode of a closed contact, by its state at the end of a step. */
STRUT_INLINE strut_event_kind contradicting_event(const strut_contact_entry *e,
                                                  const strut_touch *o, uint8_t mode, double s) {
  double edge = stick_band_edge(e);
#define STRUT_ENDS(margin, NAME) ((margin) < 0.0 ? STRUT_EVENT_##NAME : STRUT_EVENT_NONE)
  switch ((strut_contact_mode)mode) {
    case STRUT_MODE_SLIP: return STRUT_ENDS(strut_law_margin_of_slip(s, o->slip, edge), SLIP_ENDS);
    case STRUT_MODE_STICK:
      /* also where the gap is open by then: what holds a node lets go before that */
      return STRUT_ENDS(margin_of_stick(e, o), STICK_BREAKS);
    case STRUT_MODE_CREEP:
      if (margin_of_creep_out(e, o, s) < 0.0) return STRUT_EVENT_CREEP_OUT;
      return STRUT_ENDS(margin_of_creep_in(e, o, s), CREEP_IN);
    case STRUT_MODE_BAND:
    case STRUT_MODE_PUSH:
    case STRUT_MODE_YIELD:
      if (strut_law_margin_of_band(fabs(o->slip), edge) < 0.0) return STRUT_EVENT_LEAVES_STICK_BAND;
      return event_within_band(e, o, mode, s);
    case STRUT_MODE_OPEN:
    case STRUT_MODE_SLIDE: break;
  }
#undef STRUT_ENDS
  return STRUT_EVENT_NONE;
}

/* next becomes now: q and v are the state's own and are copied, the rest changes hands. */
STRUT_INLINE void accept_step(const strut_model *model, strut_state *state, strut_event_stepper *l,
                              bool balance) {
  strut_step_end *now = l->next, *next = l->now;
  double *restrict q = now->q, *restrict v = now->v;
  for (int32_t i = 0; i < model->length; i += STRUT_LANES) {
    strut_lanes_store(next->q + i, strut_lanes_load(q + i));
    strut_lanes_store(next->v + i, strut_lanes_load(v + i));
  }
  now->q = next->q, now->v = next->v;
  next->q = q, next->v = v;
  l->now = now, l->next = next;
  l->fresh = true;
  for (int p = 0; p < STRUT_POWER_ROOM && balance; p += STRUT_LANES)
    strut_lanes_store(state->work + p,
                      strut_lanes_load(state->work + p) + strut_lanes_load(l->gained + p));
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
STRUT_INLINE double next_step_size(const strut_state *state, const strut_event_stepper *l,
                                   double dt) {
  double rest = dt - l->done, h = rest;
  if (l->stepper->adaptive) {
    h = l->h > 0.0 ? l->h : dt * 1e-3;
    if (h < rest && h > 0.5 * rest) h = 0.5 * rest;
  } else if (l->refine > 1.0 && (double)state->step * dt + l->done < state->refined_until) {
    h = dt / l->refine;
  }
  if (l->next_break < HUGE_VAL) {
    double left = l->next_break - ((double)state->step * dt + l->done + state->time_offset);
    if (left < h) h = left;
  }
  return h > rest * (1.0 - 1e-9) ? rest : h;
}

/*
 * Local error of a step of h over what is allowed, by those of positions and of velocities. The latter is not
 * asked for beyond what rounding leaves of it: a structure at rest has no speed to compare it with.
 */
STRUT_INLINE double relative_error(const strut_model *model, const strut_event_stepper *l, double h,
                                   double position, double velocity) {
  double error = position / (0.01 * model->size * l->tolerance);
  double allowed = l->fastest * l->tolerance, least = h * l->rounding;
  double other = velocity > 0.0 ? velocity / (allowed > least ? allowed : least) : 0.0;
  return other > error ? other : error;
}

/* New step after an error of l->error. */
STRUT_INLINE void control_step(strut_event_stepper *l, double h, bool whole) {
  double factor = 0.9 * pow(fmax(l->error, 1e-10), -1.0 / l->stepper->tableau->order);
  factor = factor < 0.2 ? 0.2 : factor > 5.0 ? 5.0 : factor;
  if (!whole || factor < 1.0 || factor * h > l->h) l->h = factor * h;
}

/* Has the method made all evaluations that it may? */
STRUT_INLINE bool is_spent(const strut_state *state) {
  return state->limits.most_evaluations > 0 && state->evaluations > state->limits.most_evaluations;
}

/* Is it to give up, for that or on an interrupt? */
STRUT_INLINE bool is_wanted_back(const strut_state *state) {
  return is_spent(state) || (state->limits.interrupt && *state->limits.interrupt);
}

/* The time at which a step from t is evaluated; see moment_before. */
STRUT_INLINE double evaluation_time(const strut_event_stepper *l, double t, double dt) {
  return l->next_break < HUGE_VAL ? t - moment_before(t, dt) : t;
}

/* After a step of `gone`: on to the next grid point when this one is reached. */
STRUT_INLINE void advance_within_grid(strut_state *state, strut_event_stepper *l, double gone,
                                      double dt) {
  double rest = dt - l->done;
  l->done = gone == rest ? dt : l->done + gone;
  if (dt - l->done > 1e-12 * dt) return;
  l->done = 0.0;
  l->switches = 0;
  state->step++;
}

/* The gap of a contact at an end of a step; of a closed contact over its facet. */
STRUT_INLINE double gap_at_end(const strut_contact_table *c, const strut_event_stepper *l,
                               int32_t i, const strut_step_end *end, unsigned terms) {
  if (!frames_of(end, terms)) return strut_ground_gap(c, end->q + c->at[i]);
  int32_t facet = l->mode[i] == STRUT_MODE_OPEN ? -1 : l->facet[i];
  return strut_contact_pose_at(c, i, end->q, end->motion, facet).gap;
}

/* The value that the switch of a law ends at 0. */
STRUT_INLINE double law_value(const strut_event_stepper *l, const strut_step_end *end, int32_t i) {
  const strut_law_switch *law = &l->laws[i];
  if (law->event != STRUT_EVENT_ACTS) return end->tension[i];
  double k = law->stiffness, d = law->damping;
  double elastic = (k > 0.0 ? k : d > 0.0 ? d / l->wanted_step : 1.0) * end->stretch[i];
  return strut_law_cable_margin(l->acting[i], elastic, end->tension[i], law->abrupt);
}

/**
 * Defines NAME_trial, the trial of a strut_step_formula, which runs
 * `take(model, state, l, t, h, terms, balance)`, an inlined function, in copies as those of plain_steps.h.
 */
#define STRUT_EVENT_TRIAL(name, take)                                                              \
  STRUT_CLONES                                                                                     \
  static void name##_with_balance(const strut_model *model, strut_state *state,                    \
                                  strut_event_stepper *l, double t, double h) {                    \
    take(model, state, l, t, h, STRUT_TERMS_COMMON, true);                                         \
  }                                                                                                \
                                                                                                   \
  STRUT_CLONES                                                                                     \
  static void name##_without_balance(const strut_model *model, strut_state *state,                 \
                                     strut_event_stepper *l, double t, double h) {                 \
    take(model, state, l, t, h, STRUT_TERMS_COMMON, false);                                        \
  }                                                                                                \
                                                                                                   \
  STRUT_CLONES                                                                                     \
  static void name##_with_rare_terms(const strut_model *model, strut_state *state,                 \
                                     strut_event_stepper *l, double t, double h) {                 \
    take(model, state, l, t, h, STRUT_TERMS_ALL, state->balance);                                  \
  }                                                                                                \
                                                                                                   \
  static void name##_trial(const strut_model *model, strut_state *state, strut_event_stepper *l,   \
                           double t, double h) {                                                   \
    if (model->terms & STRUT_TERMS_RARE)                                                           \
      name##_with_rare_terms(model, state, l, t, h);                                               \
    else if (state->balance)                                                                       \
      name##_with_balance(model, state, l, t, h);                                                  \
    else                                                                                           \
      name##_without_balance(model, state, l, t, h);                                               \
  }

#endif
