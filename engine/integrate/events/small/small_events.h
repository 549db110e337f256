/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: forces and accelerations of a small model with the contacts' modes frozen, in vector registers. Every
 * number goes through the operations of event_kernel.h in their order, so that it has the same bits.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_EVENTS_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_EVENTS_H

#include "engine/integrate/events/event_kernel.h"
#include "engine/integrate/events/small/small_trials.h"
#include "engine/integrate/small_run.h"
#include "engine/model/dense_cholesky.h"

/* Contacts at one evaluation, each at its node's lane. */
typedef struct small_contacts {
  small_row gap, into, slip, normal, friction, applied;
} small_contacts;

/* A step under way: what it reads, and what the latest evaluation left. */
typedef struct small_events {
  small_run run;
  const strut_small_modes *modes;
  strut_event_stepper *stepper;
  small_points structure, force; /* without the ground, and with it */
  small_work structure_power, power;
  small_contacts contacts;
  small_row least, least_at; /* margins over the stages, see strut_least_margin */
  const small_rest *rest;    /* at its time, without the offset [s] */
  double time;
} small_events;

#define LAW(name) small_##name
#define LAW_INLINE STRUT_SMALL_INLINE
#include "engine/integrate/events/contacts/mode_law.h"
#undef LAW
#undef LAW_INLINE

#define SMALL_MODE(field) small_load(m->field + p * SMALL_WIDTH)
#define SMALL_MODE_MASK(field) small_mask_load(m->field + p * SMALL_WIDTH)

STRUT_SMALL_INLINE small_events small_events_begin(const strut_model *model, strut_event_stepper *l,
                                                   unsigned terms) {
  return (small_events){.run = {.tables = model->small,
                                .contacts = &model->contacts,
                                .inputs = &l->small->inputs,
                                .driven = l->small->inputs.driven,
                                .terms = small_terms_in_copy(model, terms)},
                        .modes = l->small,
                        .stepper = l};
}

/* See contact_normal_force: with explicit dampers. */
STRUT_SMALL_INLINE small_real small_normal_force(const strut_small_contacts *c,
                                                 const strut_small_modes *m, int p, small_real gap,
                                                 small_real into, bool laws) {
  const small_ground_numbers numbers = small_ground_at(c, p);
  small_real zero = {0};
  small_mask acts = SMALL_MODE_MASK(mask.damper_on);
  if (m->is.any_by_sign) acts |= SMALL_MODE_MASK(mask.damper_by_sign) & small_less(into, zero);
  return small_ground_normal_in_mode(&numbers, acts, gap, into, laws);
}

/* The most that friction holds against a push in this direction. */
STRUT_SMALL_INLINE small_real small_holding(const strut_small_contacts *c, int p, small_real normal,
                                            small_real towards, bool laws) {
  const small_friction_numbers numbers = small_friction_at(c, p);
  return small_friction_holding(&numbers, normal, towards, laws);
}

/* With which it slides. */
STRUT_SMALL_INLINE small_real small_sliding(const strut_small_contacts *c, int p, small_real normal,
                                            small_real towards, bool laws) {
  const small_friction_numbers numbers = small_friction_at(c, p);
  return small_friction_sliding(&numbers, normal, towards, laws);
}

/* See friction_in_mode. */
STRUT_SMALL_INLINE small_real small_friction_in_mode(const strut_small_contacts *c,
                                                     const strut_small_modes *m, int p,
                                                     small_real normal, small_real slip,
                                                     small_real applied, bool laws) {
  small_real friction =
      small_keep(SMALL_MODE_MASK(mask.rubs), SMALL_MODE(row.slip_factor) * normal);
  if (laws && m->is.any_by_speed) {
    const small_friction_numbers numbers = small_friction_at(c, p);
    const small_friction_choice has = small_choice_at(c, p);
    friction = small_choose(SMALL_MODE_MASK(mask.by_speed),
                            small_friction(&numbers, &has, normal, slip, applied), friction);
  }
  if (!m->is.any_band) return friction;
  small_real holding = small_holding(c, p, normal, applied, laws);
  return small_choose(SMALL_MODE_MASK(mask.band), small_friction_in_band(holding, applied),
                      friction);
}

/* See add_contact_forces. */
STRUT_SMALL_INLINE void small_add_ground(small_events *e, int p, const small_points *q,
                                         const small_points *v) {
  const strut_small_contacts *c = &e->run.tables->contact;
  const strut_contact_table *t = e->run.contacts;
  const strut_small_modes *m = e->modes;
  bool laws = e->run.terms & STRUT_TERM_LAWS, sloped = e->run.terms & STRUT_TERM_SLOPE;
  small_real x = q->x.part[p], gap = q->y.part[p] - t->height, along = v->x.part[p];
  small_real into = v->y.part[p], fx = e->force.x.part[p], fy = e->force.y.part[p], applied = fx;
  small_real nx = small_all(t->normal[0]), ny = small_all(t->normal[1]);
  small_real tx = small_all(t->tangent[0]), ty = small_all(t->tangent[1]);
  if (sloped) {
    gap = x * nx + gap * ny;
    small_real u = along, w = into;
    into = u * nx + w * ny, along = u * tx + w * ty;
    applied = fx * tx + fy * ty;
  }
  small_mask closed = SMALL_MODE_MASK(mask.closed);
  small_real normal = small_normal_force(c, m, p, gap, into, laws);
  small_real slip = along - small_belt(&e->run);
  small_real friction = small_friction_in_mode(c, m, p, normal, slip, applied, laws);
  e->contacts.gap.part[p] = gap, e->contacts.into.part[p] = into;
  e->contacts.slip.part[p] = slip, e->contacts.applied.part[p] = applied;
  e->contacts.normal.part[p] = normal, e->contacts.friction.part[p] = friction;
  small_real px = sloped ? friction * tx + normal * nx : friction;
  small_real py = sloped ? friction * ty + normal * ny : normal;
  e->force.x.part[p] = small_add_where(closed, fx, px);
  e->force.y.part[p] = small_add_where(closed, fy, py);
}

/* The multipliers that hold stuck contacts on level ground, in place: `x` of (l->stuck_count). */
STRUT_SMALL_INLINE void small_multipliers(const strut_event_stepper *l, double *x) {
  if (l->stuck_count == 1)
    x[0] /= l->response[l->stuck[0]].tangent;
  else
    strut_cholesky_solve(l->stuck_count, l->stuck_factor, x);
}

/* See strut_solve_stick_constraints. */
STRUT_SMALL_INLINE void small_hold(small_events *e, small_points *a) {
  const strut_event_stepper *l = e->stepper;
  const strut_small_modes *m = e->modes;
  strut_small_row along, more = {0};
  double x[STRUT_SMALL_NODES];
  small_row_store(along, a->x);
  for (int32_t k = 0; k < l->stuck_count; k++) x[k] = -along[m->stuck_lane[k]];
  small_multipliers(l, x);
  for (int32_t k = 0; k < l->stuck_count; k++) {
    small_real force = small_all(x[k]);
    more[m->stuck_lane[k]] = x[k];
    SMALL_EACH(p)
    a->x.part[p] = small_add_where(small_mask_load(m->stuck[k].has + p * SMALL_WIDTH), a->x.part[p],
                                   small_load(m->stuck[k].x + p * SMALL_WIDTH) * force);
  }
  SMALL_EACH(p) {
    small_real zero = {0};
    small_mask held = SMALL_MODE_MASK(mask.held);
    a->x.part[p] = small_choose(held, zero, a->x.part[p]);
    e->contacts.friction.part[p] =
        small_add_where(held, e->contacts.friction.part[p], small_load(more + p * SMALL_WIDTH));
  }
}

/* See add_contact_powers. */
STRUT_SMALL_INLINE void small_add_ground_powers(small_events *e) {
  const strut_small_contacts *c = &e->run.tables->contact;
  const strut_small_modes *m = e->modes;
  small_touch touch = {0};
  SMALL_EACH(p) {
    const small_contacts *o = &e->contacts;
    touch.touching |= small_set_bits(SMALL_MODE_MASK(mask.closed)) << (p * SMALL_WIDTH);
    const small_ground_numbers numbers = small_ground_at(c, p);
    small_real damper = o->normal.part[p] - small_ground_spring(&numbers, o->gap.part[p]);
    small_contact_powers powers =
        small_contact_power(damper, o->into.part[p], o->friction.part[p], o->slip.part[p],
                            small_all(e->run.contacts->belt_speed));
    small_accumulate_contacts(&e->run, SMALL_MODE_MASK(mask.closed), powers, true, p, &touch);
  }
  small_add_contacts(&e->run, &touch, &e->power);
}

/* Forces of all but the ground into e->structure and e->force. For shapes and `next_q` see small_accelerate. */
STRUT_SMALL_INLINE void small_structure(small_events *e, const small_rest *rest,
                                        small_shapes *shapes, const small_points *next_q,
                                        const small_points *v, bool balance) {
  small_pulls px, py;
  small4_member_powers members = {0};
  small_run run = e->run;
  if (balance) SMALL_READS_AGAIN(run.tables);
  small_members(&run, rest, shapes, next_q, v, balance, &px, &py, &members);
  e->structure = e->force = small_sum_pulls(&run, &px, &py);
  if (balance) e->structure_power = e->power = small_sum_members(&members);
}

/* See accelerate_in_modes. */
STRUT_SMALL_INLINE small_points small_accelerate_in_modes(small_events *e, const small_rest *rest,
                                                          const small_points *q,
                                                          small_shapes *shapes,
                                                          const small_points *next_q,
                                                          const small_points *v, bool balance) {
  const strut_event_stepper *l = e->stepper;
  small_structure(e, rest, shapes, next_q, v, balance);
  if (l->closed_count) SMALL_EACH(p) small_add_ground(e, p, q, v);
  small_points a = small_divide_points(e->run.tables, &e->force);
  if (l->stuck_count) small_hold(e, &a);
  if (balance && l->closed_count) small_add_ground_powers(e);
  return a;
}

/* Is there a contact with a margin that stages have to note? */
STRUT_SMALL_INLINE bool small_keeps_margins(const small_events *e) {
  return e->stepper->closed_count && (e->modes->is.any_held || e->modes->is.any_drops);
}

/* See kept_margin in adaptive.c; infinite without a normal force, too. */
STRUT_SMALL_INLINE small_real small_kept_margin(const small_events *e, int p) {
  const strut_small_contacts *c = &e->run.tables->contact;
  const strut_small_modes *m = e->modes;
  bool laws = e->run.terms & STRUT_TERM_LAWS;
  small_real zero = {0}, none = small_all(HUGE_VAL), margin = none;
  small_real normal = e->contacts.normal.part[p], side = SMALL_MODE(row.side);
  small_real friction = e->contacts.friction.part[p], applied = e->contacts.applied.part[p];
  small_real holding = small_holding(c, p, normal, applied, laws);
#define SMALL_KEEPS(mode, value) margin = small_choose(mode, value, margin)
  if (m->is.any_held) {
    small_real held = small_holding(c, p, normal, -friction, laws);
    small_real out = small_margin_of_creep_out(side, SMALL_MODE(row.kinetic) * normal, friction);
    small_real edge =
        small_friction_at_edge(holding, small_sliding(c, p, normal, applied, laws), applied);
    small_real in = small_margin_of_creep_in(side, edge, friction);
    SMALL_KEEPS(SMALL_MODE_MASK(mask.stick), small_margin_of_holding(held, friction));
    SMALL_KEEPS(SMALL_MODE_MASK(mask.creep), small_choose(small_less(out, in), out, in));
  }
  if (m->is.any_drops) {
    SMALL_KEEPS(SMALL_MODE_MASK(mask.band) & SMALL_MODE_MASK(mask.drops),
                small_margin_of_holding(holding, applied));
    SMALL_KEEPS(SMALL_MODE_MASK(mask.pushes), small_margin_of_push(side, holding, applied));
  }
#undef SMALL_KEEPS
  return small_choose(SMALL_MODE_MASK(mask.closed) & small_less(zero, normal), margin, none);
}

/* See note_stage in adaptive.c. */
STRUT_SMALL_INLINE void small_note_stage(small_events *e, double at, bool first) {
  SMALL_EACH(p) {
    small_real margin = small_kept_margin(e, p);
    small_mask less = small_less(margin, e->least.part[p]);
    e->least.part[p] = first ? margin : small_choose(less, margin, e->least.part[p]);
    e->least_at.part[p] =
        first ? small_all(at) : small_choose(less, small_all(at), e->least_at.part[p]);
  }
}

/* Whether look_between may find one in the step just made; see earliest_spent in adaptive.c. */
STRUT_SMALL_INLINE bool small_spent(const small_events *e) {
  bool any = false;
  if (!small_keeps_margins(e)) return false;
  SMALL_EACH(p)
  any = any || small_some(small_margin_is_spent(e->least.part[p], small_kept_margin(e, p)));
  return any;
}

/* The least margins of the contacts that touch, one by one, into l->least. */
STRUT_SMALL_INLINE void small_keep_least(const small_events *e, const strut_model *model) {
  const strut_event_stepper *l = e->stepper;
  bool kept = small_keeps_margins(e);
  strut_small_row margin, at;
  small_row_store(margin, e->least), small_row_store(at, e->least_at);
  for (int32_t k = 0; k < l->closed_count; k++) {
    int32_t i = l->closed[k], n = model->contacts.entry[i].node;
    l->least[i] = (strut_least_margin){kept ? margin[n] : HUGE_VAL, at[n]};
  }
}

/* The contacts that touch, one by one, into end->touch; a: the acceleration there. */
STRUT_SMALL_INLINE void small_keep_contacts(const small_events *e, const strut_model *model,
                                            const small_points *a, strut_step_end *end) {
  const strut_event_stepper *l = e->stepper;
  const strut_contact_table *c = e->run.contacts;
  const small_contacts *o = &e->contacts;
  strut_small_row row[8];
  small_points along = *a;
  if (e->run.terms & STRUT_TERM_SLOPE) SMALL_EACH(p) {
      small_real x = a->x.part[p], y = a->y.part[p];
      along.x.part[p] = x * c->tangent[0] + y * c->tangent[1];
      along.y.part[p] = x * c->normal[0] + y * c->normal[1];
    }
  small_row_store(row[0], o->gap), small_row_store(row[1], o->into),
      small_row_store(row[2], o->slip);
  small_row_store(row[3], along.y), small_row_store(row[4], along.x);
  small_row_store(row[5], o->normal), small_row_store(row[6], o->friction);
  small_row_store(row[7], o->applied);
  for (int32_t k = 0; k < l->closed_count; k++) {
    int32_t i = l->closed[k], n = model->contacts.entry[i].node;
    end->touch[i] = (strut_touch){.gap = row[0][n],
                                  .into = row[1][n],
                                  .slip = row[2][n],
                                  .into_rate = row[3][n],
                                  .slip_rate = row[4][n],
                                  .normal = row[5][n],
                                  .friction = row[6][n],
                                  .applied = row[7][n]};
  }
}

/* Rest lengths and forces as the general kernel leaves them in the state after the latest evaluation. */
STRUT_SMALL_INLINE void small_leave(const small_events *e, const strut_model *model,
                                    strut_state *state, bool balance) {
  small_write(e->run.tables, &e->force, state->latest.force);
  if (balance) small_work_store(state->latest.power, e->power);
  if (!(e->run.terms & STRUT_TERM_DRIVE)) return;
  state->latest.drive_time = e->time;
  for (int32_t i = 0; i < model->drives.count; i++) {
    int32_t j = model->drives.member[i];
    state->latest.rest[j] = e->rest->rest[j], state->latest.rest_rate[j] = e->rest->rate[j];
  }
}

/* The step's end, with all that belongs to it, as evaluate_step_end leaves it. */
STRUT_SMALL_INLINE void small_keep_end(const small_events *e, const strut_model *model,
                                       const small_points *q, const small_points *v,
                                       const small_points *a, strut_step_end *end, bool balance) {
  const strut_small_model *s = e->run.tables;
  small_write(s, q, end->q), small_write(s, v, end->v), small_write(s, a, end->a);
  small_write(s, &e->structure, end->structure);
  if (e->stepper->closed_count) small_keep_contacts(e, model, a, end);
  if (!balance) return;
  small_work_store(end->structure_power, e->structure_power);
  small_work_store(end->power, e->power);
}

/* What an evaluation leaves for an end of a step, and no more: copies of all would have to wait for it. */
typedef struct small_kept {
  small_contacts contacts;
  small_points structure;
  small_work structure_power, power;
} small_kept;

STRUT_SMALL_INLINE small_kept small_kept_of(const small_events *e) {
  return (small_kept){e->contacts, e->structure, e->structure_power, e->power};
}
STRUT_SMALL_INLINE small_events small_at_kept(const small_events *e, const small_kept *kept) {
  small_events at = *e;
  at.contacts = kept->contacts, at.structure = kept->structure;
  at.structure_power = kept->structure_power, at.power = kept->power;
  return at;
}

/* Rest lengths at the instants t + part[i] h, none before the first or after the last, into the rows of the
   modes. */
STRUT_SMALL_INLINE const small_rest *small_rest_at(const strut_model *model,
                                                   const strut_state *state, strut_small_modes *m,
                                                   double t, double h, const double *part,
                                                   int32_t count) {
  double time[SMALL_INSTANTS];
  if (!(model->terms & STRUT_TERM_DRIVE)) return m->rest;
  for (int32_t i = 0; i < (count + 3) / 4 * 4; i++)
    time[i] = t + part[i < count ? i : count - 1] * h + state->time_offset;
  small_drive(model, time, count, m->rest);
  return m->rest;
}

#endif
