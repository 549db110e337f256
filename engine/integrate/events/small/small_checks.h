/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: whether the end of a step contradicts a mode of a small model; see event_location.c and adaptive.c. What
 * says so here is checked again by these, which also find where it began.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_CHECKS_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_CHECKS_H

#include "engine/integrate/events/small/small_events.h"

/* See settle_band_ties. */
STRUT_SMALL_INLINE void small_settle_ties(small_events *e) {
  const strut_small_contacts *c = &e->run.tables->contact;
  const strut_small_modes *m = e->modes;
  SMALL_EACH(p) {
    small_real *friction = &e->contacts.friction.part[p], *slip = &e->contacts.slip.part[p];
    small_real normal = e->contacts.normal.part[p], applied = e->contacts.applied.part[p];
    small_real creeps = small_friction_in_creep(SMALL_MODE(row.side), normal, *friction, applied);
    small_real inside = small_slip_in_band(*slip, SMALL_CONTACT(stick_velocity));
    *friction = small_choose(SMALL_MODE_MASK(mask.creep), creeps, *friction);
    *slip = small_choose(SMALL_MODE_MASK(mask.band), inside, *slip);
  }
}

/* Inside its band: where a contact leaves it, or where it is pushed, or no more. */
STRUT_SMALL_INLINE small_mask small_leaves_band(const strut_small_modes *m, int p, small_real slip,
                                                small_real holding, small_real applied) {
  small_real zero = {0}, side = SMALL_MODE(row.side);
  small_mask held = SMALL_MODE_MASK(mask.band), pushes = SMALL_MODE_MASK(mask.pushes);
  small_mask leaves =
      (held | pushes) &
      small_less(small_margin_of_band(small_magnitude(slip), SMALL_MODE(row.edge)), zero);
  held &= small_less(small_margin_of_holding(holding, applied), zero);
  pushes &= small_at_least(zero, small_margin_of_push(side, holding, applied));
  return leaves | ((held | pushes) & SMALL_MODE_MASK(mask.drops));
}

/* Where a contact that sticks or creeps does so no more. */
STRUT_SMALL_INLINE small_mask small_gives_way(const small_events *e, int p, small_real holding,
                                              bool laws) {
  const strut_small_contacts *c = &e->run.tables->contact;
  const strut_small_modes *m = e->modes;
  small_real normal = e->contacts.normal.part[p], friction = e->contacts.friction.part[p];
  small_real applied = e->contacts.applied.part[p], side = SMALL_MODE(row.side), zero = {0};
  small_real held = small_holding(c, p, normal, -friction, laws);
  small_real at_edge =
      small_friction_at_edge(holding, small_sliding(c, p, normal, applied, laws), applied);
  small_real out = small_margin_of_creep_out(side, SMALL_MODE(row.kinetic) * normal, friction);
  small_mask ends = small_less(out, zero);
  ends |= small_less(small_margin_of_creep_in(side, at_edge, friction), zero);
  return (SMALL_MODE_MASK(mask.stick) & small_less(small_margin_of_holding(held, friction), zero)) |
         (SMALL_MODE_MASK(mask.creep) & ends);
}

/* See contradicting_event. */
STRUT_SMALL_INLINE bool small_contradicts(const small_events *e) {
  const strut_small_contacts *c = &e->run.tables->contact;
  const strut_small_modes *m = e->modes;
  bool laws = e->run.terms & STRUT_TERM_LAWS, any = false;
  SMALL_EACH(p) {
    small_real slip = e->contacts.slip.part[p], applied = e->contacts.applied.part[p], zero = {0};
    small_real margin = small_margin_of_slip(SMALL_MODE(row.side), slip, SMALL_MODE(row.edge));
    small_mask bad = SMALL_MODE_MASK(mask.slips) & small_less(margin, zero);
    if (!e->stepper->all_sliding) {
      small_real holding = small_holding(c, p, e->contacts.normal.part[p], applied, laws);
      if (m->is.any_band) bad |= small_leaves_band(m, p, slip, holding, applied);
      if (m->is.any_held) bad |= small_gives_way(e, p, holding, laws);
    }
    any = any || small_some(bad & SMALL_MODE_MASK(mask.closed));
  }
  return any;
}

/* Does a contact open or close at these positions? */
STRUT_SMALL_INLINE bool small_crosses(const small_events *e, const small_points *q) {
  const strut_small_modes *m = e->modes;
  bool any = false;
  SMALL_EACH(p) {
    small_real zero = {0}, gap = SMALL_MODE(row.outward) * (q->y.part[p] - e->run.contacts->height);
    any = any || small_some(small_less(gap, zero));
  }
  return any;
}

/* One end of a step: the state proper, accelerations and powers. */
typedef struct small_end_point {
  small_points q, v, a;
  small_work power;
} small_end_point;

/* Gap, speed into the ground and along it, and the rates of both, of part p of all nodes. */
typedef struct small_measures {
  small_real gap, into, slip, into_rate, slip_rate;
} small_measures;

STRUT_SMALL_INLINE small_measures small_measure(const small_events *e, int p,
                                                const small_end_point *x) {
  const strut_contact_table *t = e->run.contacts;
  small_real gap = x->q.y.part[p] - t->height, into = x->v.y.part[p], along = x->v.x.part[p];
  small_real rate = x->a.x.part[p], into_rate = x->a.y.part[p];
  if (e->run.terms & STRUT_TERM_SLOPE) {
    small_real u = along, w = into;
    gap = x->q.x.part[p] * t->normal[0] + gap * t->normal[1];
    into = u * t->normal[0] + w * t->normal[1], along = u * t->tangent[0] + w * t->tangent[1];
    small_real ax = rate, ay = into_rate;
    rate = ax * t->tangent[0] + ay * t->tangent[1];
    into_rate = ax * t->normal[0] + ay * t->normal[1];
  }
  return (small_measures){gap, into, along - small_belt(&e->run), into_rate, rate};
}

/* See dip in adaptive.c: the lanes in which the cubic is below -faint. */
STRUT_SMALL_INLINE small_mask small_dips_below(small_real g0, small_real d0, small_real g1,
                                               small_real d1, double faint) {
  small_real zero = {0}, rise = g1 - g0, b = 3.0 * rise - 2.0 * d0 - d1, c = d0 + d1 - 2.0 * rise;
  small_real inside = b * b - 3.0 * c * d0;
  inside = small_choose(small_less(zero, inside), inside, zero);
  small_real x = -d0 / (b + small_root(inside));
  small_real lowest = g0 + x * (d0 + x * (b + x * c));
  return small_less(d0, zero) & small_less(zero, d1) & small_less(lowest, small_all(-faint));
}

/* See earliest_dip in adaptive.c. */
STRUT_SMALL_INLINE bool small_dips(const small_events *e, const strut_model *model, double h,
                                   const small_end_point *now, const small_end_point *next) {
  const strut_small_contacts *c = &e->run.tables->contact;
  const strut_small_modes *m = e->modes;
  double part = 0.1 * e->stepper->tolerance > 1e-12 ? 0.1 * e->stepper->tolerance : 1e-12;
  double faint = 0.01 * part * model->size, slow = part * e->stepper->fastest;
  bool any = false;
  SMALL_EACH(p) {
    small_measures from = small_measure(e, p, now), to = small_measure(e, p, next);
    small_real side = SMALL_MODE(row.outward), s = SMALL_MODE(row.side),
               edge = SMALL_MODE(row.edge);
    small_real zero = {0}, gap = side * to.gap, beyond = s * to.slip - edge;
    small_mask bad = SMALL_CONTACT_MASK(touches) & small_less(zero, gap);
    bad &= small_dips_below(side * from.gap, side * h * from.into, gap, side * h * to.into, faint);
    small_mask slips = SMALL_MODE_MASK(mask.slips);
    if (m->is.any_band) {
      small_mask band = SMALL_MODE_MASK(mask.band) | SMALL_MODE_MASK(mask.pushes);
      small_real back = small_choose(small_less(to.slip, zero), small_all(1.0), small_all(-1.0));
      s = small_choose(band, back, s), edge = small_choose(band, -edge, edge);
      beyond = s * to.slip - edge, slips |= band;
    }
    slips &= small_less(zero, beyond);
    if (small_some(slips))
      bad |= slips & small_dips_below(s * from.slip - edge, s * h * from.slip_rate, beyond,
                                      s * h * to.slip_rate, slow);
    small_mask off = SMALL_MODE_MASK(mask.damper_off);
    small_mask turns = off | SMALL_MODE_MASK(mask.damper_on);
    if (small_some(turns)) {
      small_real way = small_choose(off, small_all(1.0), small_all(-1.0));
      bad |= turns & small_less(zero, way * to.into) &
             small_dips_below(way * from.into, way * h * from.into_rate, way * to.into,
                              way * h * to.into_rate, slow);
    }
    any = any || small_some(bad);
  }
  return any;
}

/* See first_event, of exact steppers. */
STRUT_SMALL_INLINE bool small_exact_event(const small_events *e, const small_end_point *next) {
  const strut_small_modes *m = e->modes;
  bool any = e->stepper->closed_count && small_contradicts(e);
  SMALL_EACH(p) {
    small_measures to = small_measure(e, p, next);
    small_real zero = {0};
    small_mask turned = (SMALL_MODE_MASK(mask.damper_on) & small_less(zero, to.into)) |
                        (SMALL_MODE_MASK(mask.damper_off) & small_less(to.into, zero));
    turned |= small_less(SMALL_MODE(row.outward) * to.gap, zero);
    any = any || small_some(turned);
  }
  return any;
}

#endif
