/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: whether the end of a step contradicts a mode of a small model; see event_location.c and adaptive.c. What
 * says so here is looked at again by these, which also find where it began.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_CHECKS_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_CHECKS_H

#include "engine/integrate/events/small_events.h"

/* See settle_band_ties. */
STRUT_SMALL_INLINE void small_settle_ties(small_events *e) {
  const strut_small_contacts *c = &e->run.tables->contact;
  const strut_small_modes *m = e->modes;
  SMALL_EACH(p) {
    small_real friction = e->contacts.friction.part[p], slip = e->contacts.slip.part[p], zero = {0};
    small_real applied = e->contacts.applied.part[p], edge = SMALL_CONTACT(stick_velocity);
    small_real faint = TIED * e->contacts.normal.part[p];
    small_mask tied =
        SMALL_MODE_MASK(creep) & small_at_least(faint, small_magnitude(friction + applied));
    e->contacts.friction.part[p] =
        small_choose(tied, -applied + SMALL_MODE(side) * faint, friction);
    tied = SMALL_MODE_MASK(band) &
           small_at_least(TIED * edge, small_magnitude(small_magnitude(slip) - edge));
    small_real inside = small_choose(small_less(slip, zero), -edge, edge) * (1.0 - TIED);
    e->contacts.slip.part[p] = small_choose(tied, inside, slip);
  }
}

/* Coefficient of kinetic friction, negative. */
STRUT_SMALL_INLINE small_real small_kinetic(const strut_small_contacts *c, int p,
                                            small_real towards, bool laws) {
  small_real zero = {0};
  return small_nearer(small_less(towards, zero), c->minus_mu_kinetic_backward + p * SMALL_WIDTH,
                      c->minus_mu_kinetic + p * SMALL_WIDTH, laws);
}

/* See contradicting_event. */
STRUT_SMALL_INLINE bool small_contradicts(const small_events *e) {
  const strut_small_contacts *c = &e->run.tables->contact;
  const strut_small_modes *m = e->modes;
  bool laws = e->run.plan & STRUT_TERM_LAWS, any = false;
  SMALL_EACH(p) {
    small_real normal = e->contacts.normal.part[p], slip = e->contacts.slip.part[p];
    small_real friction = e->contacts.friction.part[p], applied = e->contacts.applied.part[p];
    small_real side = SMALL_MODE(side), edge = SMALL_MODE(edge), zero = {0};
    small_mask bad = SMALL_MODE_MASK(slips) & small_less(side * slip, edge);
    if (!e->stepper->all_sliding) {
      small_real most = small_static(c, p, applied, laws) * normal, size = small_magnitude(applied);
      if (m->any_band) {
        small_mask held = SMALL_MODE_MASK(band), pushes = SMALL_MODE_MASK(pushes);
        bad |= (held | pushes) & small_less(edge, small_magnitude(slip));
        held &= small_less(most, size), pushes &= small_at_least(most, side * applied);
        bad |= (held | pushes) & SMALL_MODE_MASK(drops);
      }
      if (m->any_held) {
        small_real held_by = small_static(c, p, -friction, laws) * normal;
        bad |= SMALL_MODE_MASK(stick) & small_less(held_by, small_magnitude(friction));
        small_real band = small_kinetic(c, p, applied, laws) * normal;
        band = small_flip(band, (small_bits)applied & INT64_MIN);
        band = small_choose(small_less(size, most), -applied, band);
        small_mask ends = small_less(side * friction, SMALL_MODE(minus_kinetic) * normal);
        ends |= small_less(side * (band - friction), zero);
        bad |= SMALL_MODE_MASK(creep) & ends;
      }
    }
    any = any || small_any(bad & SMALL_MODE_MASK(closed));
  }
  return any;
}

/* Does a contact open or close at these positions? */
STRUT_SMALL_INLINE bool small_crosses(const small_events *e, const small_points *q) {
  const strut_small_modes *m = e->modes;
  bool any = false;
  SMALL_EACH(p) {
    small_real zero = {0}, gap = SMALL_MODE(outward) * (q->y.part[p] - e->run.contacts->height);
    any = any || small_any(small_less(gap, zero));
  }
  return any;
}

/* One end of a step: the state proper, accelerations and powers. */
typedef struct small_end_point {
  small_points q, v, a;
  small_work power;
} small_end_point;

/* Gap, speed into the ground and along it, and the rate of that, of part p of all nodes. */
typedef struct small_measures {
  small_real gap, into, slip, slip_rate;
} small_measures;

STRUT_SMALL_INLINE small_measures small_measure(const small_events *e, int p,
                                                const small_end_point *x) {
  const strut_contact_table *t = e->run.contacts;
  small_real gap = x->q.y.part[p] - t->height, into = x->v.y.part[p], along = x->v.x.part[p];
  small_real rate = x->a.x.part[p];
  if (e->run.plan & STRUT_TERM_SLOPE) {
    small_real u = along, w = into;
    gap = x->q.x.part[p] * t->normal[0] + gap * t->normal[1];
    into = u * t->normal[0] + w * t->normal[1], along = u * t->tangent[0] + w * t->tangent[1];
    rate = rate * t->tangent[0] + x->a.y.part[p] * t->tangent[1];
  }
  return (small_measures){gap, into, along - small_belt(&e->run), rate};
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
    small_real side = SMALL_MODE(outward), s = SMALL_MODE(side), edge = SMALL_MODE(edge);
    small_real zero = {0}, gap = side * to.gap, beyond = s * to.slip - edge;
    small_mask bad = SMALL_CONTACT_MASK(touches) & small_less(zero, gap);
    bad &= small_dips_below(side * from.gap, side * h * from.into, gap, side * h * to.into, faint);
    small_mask slips = SMALL_MODE_MASK(slips) & small_less(zero, beyond);
    if (small_any(slips))
      bad |= slips & small_dips_below(s * from.slip - edge, s * h * from.slip_rate, beyond,
                                      s * h * to.slip_rate, slow);
    any = any || small_any(bad);
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
    small_mask turned = (SMALL_MODE_MASK(damper_on) & small_less(zero, to.into)) |
                        (SMALL_MODE_MASK(damper_off) & small_less(to.into, zero));
    turned |= small_less(SMALL_MODE(outward) * to.gap, zero);
    any = any || small_any(turned);
  }
  return any;
}

#endif
