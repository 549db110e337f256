/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: velocity Verlet between events for small models while nothing happens; see verlet_events.c and
 * implicit_ground.h, whose operations these are.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_VERLET_EVENTS_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_VERLET_EVENTS_H

#include "engine/integrate/events/small/small_checks.h"
#include "engine/integrate/small_verlet.h"

/* Steps due if nothing happens: where they begin, how long they are, and when their ends are. */
typedef struct small_steps {
  int32_t count;
  int64_t step[STRUT_SMALL_INSTANTS + 1];
  double done[STRUT_SMALL_INSTANTS + 1], h[STRUT_SMALL_INSTANTS], time[STRUT_SMALL_INSTANTS + 4];
} small_steps;

/* Fills in at most `most` steps, up to grid point `end` and before the next break. */
STRUT_SMALL_INLINE void small_steps_fill(strut_state *state, strut_event_stepper *l, double dt,
                                         int64_t end, int32_t most, small_steps *steps) {
  int64_t step = state->step;
  double done = l->done;
  int32_t n = 0, switches = l->switches;
  while (n < most && state->step < end) {
    double t = (double)state->step * dt + l->done, h = next_step_size(state, l, dt);
    if (t + h + state->time_offset > l->next_break - STRUT_AT_BREAK * dt) break;
    steps->step[n] = state->step, steps->done[n] = l->done, steps->h[n] = h;
    steps->time[n] = evaluation_time(l, t, dt) + h;
    advance_within_grid(state, l, h, dt);
    n++;
  }
  steps->step[n] = state->step, steps->done[n] = l->done;
  steps->count = n;
  state->step = step, l->done = done, l->switches = switches;
}

/* Rest lengths at the ends of the planned steps, from row 1 on. */
STRUT_SMALL_INLINE void small_drive_steps(const strut_model *model, const strut_state *state,
                                          strut_small_modes *m, const small_steps *steps) {
  double time[SMALL_INSTANTS];
  for (int32_t i = 0; i < (steps->count + 3) / 4 * 4; i++)
    time[i] = steps->time[i < steps->count ? i : steps->count - 1] + state->time_offset;
  small_drive(model, time, steps->count, m->rest + 1);
}

/*
 * The ground on contacts that do not answer to each other: adds to a1, the acceleration of the structure
 * alone. v, a0: at the begin of the step; speed: predicted.
 */
STRUT_SMALL_INLINE void small_implicit_ground(small_events *e, double h, const small_points *q,
                                              const small_points *v, const small_points *a0,
                                              const small_points *speed, small_points *a1) {
  const strut_small_contacts *c = &e->run.tables->contact;
  const strut_contact_table *t = e->run.contacts;
  const strut_small_modes *m = e->modes;
  bool laws = e->run.terms & STRUT_TERM_LAWS;
  small_contacts *o = &e->contacts;
  small_row x, y;
  SMALL_EACH(p) {
    small_real gap = q->y.part[p] - t->height, applied = e->force.x.part[p];
    const small_ground_numbers numbers = small_ground_at(c, p);
    small_real spring = small_ground_spring(&numbers, gap), half = 0.5 * h * SMALL_MODE(row.normal);
    small_real free = v->y.part[p] + 0.5 * h * (a0->y.part[p] + a1->y.part[p]) + half * spring;
    small_real normal = spring + small_ground_implicit_damper(&numbers, spring, free, half, laws);
    small_real slip = speed->x.part[p] - small_belt(&e->run);
    small_real friction = small_friction_in_mode(c, m, p, normal, slip, applied, laws);
    if (m->is.any_held)
      friction = small_choose(SMALL_MODE_MASK(mask.stick) | SMALL_MODE_MASK(mask.creep),
                              -a1->x.part[p] / SMALL_MODE(row.tangent), friction);
    o->gap.part[p] = gap, o->applied.part[p] = applied, o->slip.part[p] = slip;
    x.part[p] = o->friction.part[p] = friction;
    y.part[p] = o->normal.part[p] = normal;
  }
  x = small_permute(&m->answer[0], x), y = small_permute(&m->answer[1], y);
  SMALL_EACH(p) {
    small_real zero = {0};
    small_mask has = small_mask_load(m->answer[0].has + p * SMALL_WIDTH);
    a1->x.part[p] = small_add_where(has, a1->x.part[p], SMALL_MODE(answer[0].inverse) * x.part[p]);
    a1->y.part[p] = small_add_where(has, a1->y.part[p], SMALL_MODE(answer[1].inverse) * y.part[p]);
    if (m->is.any_held)
      a1->x.part[p] = small_choose(SMALL_MODE_MASK(mask.stick) | SMALL_MODE_MASK(mask.creep), zero,
                                   a1->x.part[p]);
  }
}

/* Does a cable cease or begin to act at this end of a step? See law_value and measure_cable. */
STRUT_SMALL_INLINE bool small_cable_switches(const small_events *e, const small_rest *rest,
                                             const small_points *q, const small_points *v) {
  const strut_small_model *s = e->run.tables;
  const strut_small_modes *m = e->modes;
  bool any = false;
  for (int j = 0; j < s->members; j += SMALL_WIDTH) {
    small_real x = small_difference(s, j, q->x), y = small_difference(s, j, q->y), zero = {0};
    small_real length = small_root(x * x + y * y), one = small_all(1.0);
    small_real inverse = small_keep(small_less(zero, length), one / length);
    small_real rate =
        (small_difference(s, j, v->x) * x + small_difference(s, j, v->y) * y) * inverse;
    const small_member_values values = {.length = length,
                                        .rate = rate,
                                        .rest = small_load(rest->rest + j),
                                        .rest_rate = small_load(rest->rate + j),
                                        .stiffness = small_load(s->stiffness + j),
                                        .damping = small_load(s->damping + j)};
    small_real damper, tension = small_member_tension(&values, true, false, true, false, &damper);
    small_real elastic = small_load(m->cables.elastic + j) * (length - values.rest);
    small_mask taut = small_mask_load(m->cables.taut + j),
               slack = small_mask_load(m->cables.slack + j);
    small_real margin = small_cable_margin(taut, elastic, tension, false);
    any = any || small_some((slack | taut) & small_less(margin, zero));
  }
  return any;
}

/* The steps until something happens, in registers. */
STRUT_SMALL_INLINE void small_verlet_events(const strut_model *model, strut_state *state,
                                            strut_event_stepper *l, double dt, int64_t end,
                                            unsigned terms, bool balance) {
  enum { FIRST = 4 };
  const strut_small_model *s = model->small;
  strut_small_modes *m = l->small;
  small_events e = small_events_begin(model, l, terms);
  small_kept kept;
  small_steps steps;
  small_work gained = small_work_load(l->gained), work = small_work_load(state->work);
  small_work power = small_work_load(l->now->power);
  small_points q = small_read(s, state->q), v = small_read(s, state->v);
  small_points a = small_read(s, l->now->a), q1, v1, a1;
  int64_t begin = state->step;
  int32_t taken = 0, n = 0, most = FIRST;
  int stride = e.run.terms & STRUT_TERM_DRIVE ? 1 : 0;
  bool tried = false, crosses = false;
  double t = 0.0;
  do {
    if (n && stride) m->rest[0] = m->rest[n];
    small_steps_fill(state, l, dt, end, most, &steps);
    if (steps.count && stride) small_drive_steps(model, state, m, &steps);
    for (n = 0; n < steps.count; n++) {
      const double h = steps.h[n], half = 0.5 * h;
      q1.x = small_glide(q.x, h, v.x, a.x), q1.y = small_glide(q.y, h, v.y, a.y);
      crosses = small_crosses(&e, &q1);
      if (crosses) break;
      small_points speed = {small_ahead(v.x, h, a.x), small_ahead(v.y, h, a.y)};
      small_shapes shapes = {0};
      small_measure_members(s, &q1, &shapes);
      small_structure(&e, m->rest + (n + 1) * stride, &shapes, NULL, &speed, balance);
      a1 = small_divide_points(s, &e.force);
      if (l->closed_count) small_implicit_ground(&e, h, &q1, &v, &a, &speed, &a1);
      v1.x = small_mean(v.x, half, a.x, a1.x), v1.y = small_mean(v.y, half, a.y, a1.y);
      SMALL_EACH(p) {
        e.contacts.into.part[p] = v1.y.part[p];
        e.contacts.slip.part[p] = v1.x.part[p] - small_belt(&e.run);
      }
      if (balance && l->closed_count) {
        small_work structure = e.power;
        e.power = (small_work){0};
        small_add_ground_powers(&e);
        small_add_powers(&structure, &e.power);
        e.power = structure;
      }
      if (!l->all_sliding && l->closed_count) small_settle_ties(&e);
      if (balance) {
        small_work sum = power;
        small_add_powers(&sum, &e.power);
        gained = small_scaled_work(half, &sum);
      }
      tried = (l->closed_count && small_contradicts(&e)) ||
              (l->law_count && small_cable_switches(&e, m->rest + (n + 1) * stride, &q1, &v1));
      if (tried) break;
      kept = small_kept_of(&e);
      q = q1, v = v1, a = a1, power = e.power;
      if (balance) small_add_powers(&work, &gained);
      t = steps.time[n];
    }
    taken += n;
    state->step = steps.step[n], l->done = steps.done[n];
    most = STRUT_SMALL_INSTANTS - 1;
  } while (n && n == steps.count && state->step < end && !crosses && !tried);
  if (state->step > begin) l->switches = 0;
  l->tried = tried;
  if (!taken && !tried) return;
  state->evaluations += taken + tried;
  if (balance) small_work_store(l->gained, gained);
  if (taken) {
    small_events at_now = small_at_kept(&e, &kept);
    small_keep_end(&at_now, model, &q, &v, &a, l->now, balance);
    if (balance) small_work_store(state->work, work);
    l->fresh = true;
    e.rest = m->rest + n * stride, e.time = t;
    small_leave(&e, model, state, balance);
    strut_event_measure(model, state, l, l->now);
  }
  if (!tried) return;
  small_keep_end(&e, model, &q1, &v1, &a1, l->next, balance);
  e.rest = m->rest + (n + 1) * stride, e.time = steps.time[n];
  small_leave(&e, model, state, balance);
}

/* Copies for models with common terms only and for all, with the energy balance and without. */
#define STRUT_SMALL_QUIET(name, steps)                                                             \
  STRUT_SMALL_TARGET                                                                               \
  static void name##_usual_with_balance(const strut_model *model, strut_state *state,              \
                                        strut_event_stepper *l, double dt, int64_t end) {          \
    steps(model, state, l, dt, end, STRUT_SMALL_USUAL, true);                                      \
  }                                                                                                \
  STRUT_SMALL_TARGET                                                                               \
  static void name##_usual(const strut_model *model, strut_state *state, strut_event_stepper *l,   \
                           double dt, int64_t end) {                                               \
    steps(model, state, l, dt, end, STRUT_SMALL_USUAL, false);                                     \
  }                                                                                                \
  STRUT_SMALL_TARGET                                                                               \
  static void name##_any(const strut_model *model, strut_state *state, strut_event_stepper *l,     \
                         double dt, int64_t end) {                                                 \
    steps(model, state, l, dt, end, STRUT_TERMS_ALL, state->balance);                              \
  }                                                                                                \
                                                                                                   \
  void STRUT_SMALL_NAME(name)(const strut_model *model, strut_state *state,                        \
                              strut_event_stepper *l, double dt, int64_t end) {                    \
    if (small_copy_of(model) < 2)                                                                  \
      name##_any(model, state, l, dt, end);                                                        \
    else if (state->balance)                                                                       \
      name##_usual_with_balance(model, state, l, dt, end);                                         \
    else                                                                                           \
      name##_usual(model, state, l, dt, end);                                                      \
  }

#endif
