/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: forces and accelerations of a small model with all of its state in vector registers.
 *
 * Every number goes through the operations of members_kernel.h, ground_kernel.h and mass_kernel.h in their
 * order, so that it has the same bits: nodes are lanes, a mask leaves out the lanes in which nothing is
 * added, and sums over members, rows of the mass matrix and contacts keep the scene's order.
 */
#ifndef STRUT_ENGINE_FORCES_SMALL_KERNEL_H
#define STRUT_ENGINE_FORCES_SMALL_KERNEL_H

#include "engine/forces/small_inputs.h"
#include "engine/forces/small_vector.h"
#include "engine/model/state.h"

/* What a run of steps reads beside the tables: of the model as it now is, and of the drives. */
typedef struct small_run {
  const strut_small_model *tables;
  const strut_contact_table *contacts;
  const strut_small_inputs *inputs;
  unsigned plan; /* with the terms that a copy knows */
} small_run;

/* Along the members: differences of the ends' positions and velocities, pulls. */
#define STRUT_DEFINE_SMALL_GROUP(number, mask, PREFIX, load, root)                                  \
  STRUT_DEFINE_MEMBER_LAW(STRUT_SMALL_INLINE, number, mask, PREFIX)                                 \
                                                                                                    \
  typedef struct PREFIX##_span {                                                                    \
    number x, y, u, w;                                                                              \
  } PREFIX##_span;                                                                                  \
                                                                                                    \
  STRUT_SMALL_INLINE PREFIX##_values PREFIX##_values_at(                                            \
      const small_run *r, const small_rest *rest, int j, number length, number rate) {              \
    const strut_small_model *s = r->tables;                                                         \
    return (PREFIX##_values){                                                                       \
        .length = length,                                                                           \
        .rate = rate,                                                                               \
        .rest = load(rest->rest + j),                                                               \
        .rest_rate = load(rest->rate + j),                                                          \
        .stiffness = load(s->stiffness + j),                                                        \
        .damping = load(s->damping + j),                                                            \
        .slack_length_threshold = load(r->inputs->slack_length_threshold + j),                      \
        .slack_force_threshold = load(r->inputs->slack_force_threshold + j)};                       \
  }                                                                                                 \
                                                                                                    \
  /* Pulls of the members from j on into d->u and d->w. No sum begins at 0: that changes no bit. */ \
  STRUT_SMALL_INLINE void PREFIX##_pull(const small_run *r, const small_rest *rest, int j,          \
                                        PREFIX##_span *d, bool ledger, PREFIX##_powers *powers) {   \
    number length = root(d->x * d->x + d->y * d->y), rate = {0}, elastic;                           \
    number inverse = (number)((length > 0.0) & (mask)(1.0 / length));                               \
    if (r->plan & STRUT_TERM_DAMPING) rate = (d->u * d->x + d->w * d->y) * inverse;                 \
    PREFIX##_values m = PREFIX##_values_at(r, rest, j, length, rate);                               \
    number tension = PREFIX##_law(&m, r->plan, ledger, &elastic);                                   \
    number density = tension * inverse;                                                             \
    d->u = density * d->x, d->w = density * d->y;                                                   \
    if (!ledger) return;                                                                            \
    bool driven = r->plan & STRUT_TERM_DRIVE;                                                       \
    number own_rate = driven ? m.rate - m.rest_rate : m.rate;                                       \
    if (driven) {                                                                                   \
      powers->drive = tension * m.rest_rate;                                                        \
      powers->exchanged = (number)((mask)powers->drive & INT64_MAX);                                \
    }                                                                                               \
    if (r->plan & STRUT_TERM_DAMPING) powers->lost = (tension - elastic) * own_rate;                \
  }

STRUT_DEFINE_SMALL_GROUP(strut_lanes, strut_lane_mask, small4, small4_load, small_root_of_4)

#if STRUT_SMALL_WIDTH == 8
STRUT_DEFINE_SMALL_GROUP(small_real, small_bits, small8, small_load, small_root)

/* Powers of the members; drive: what drives take. */
typedef struct small_powers {
  small8_powers first;
  small4_powers last;
} small_powers;

STRUT_SMALL_INLINE small_real small_gather(const int64_t *lane, small_row x) {
  return _mm512_permutexvar_pd((__m512i)small_bits_load(lane), x.part[0]);
}
STRUT_SMALL_INLINE small_row small_permute(const strut_small_column *column, small_row x) {
  return (small_row){{small_gather(column->lane, x)}};
}
STRUT_SMALL_INLINE small_real small_difference(const strut_small_model *s, int j, small_row x) {
  return small_gather(s->to + j, x) - small_gather(s->from + j, x);
}
STRUT_SMALL_INLINE strut_lanes small_half(small_real x, int half) {
  return half ? _mm512_extractf64x4_pd(x, 1) : _mm512_castpd512_pd256(x);
}
/* What the members pull with, at each node's k-th. */
STRUT_SMALL_INLINE small_row small_gather_pulls(const strut_small_pull *at, const small_pulls *p) {
  __m512d last = _mm512_castpd256_pd512(p->last);
  return (small_row){{_mm512_permutex2var_pd(p->first, (__m512i)small_bits_load(at->slot), last)}};
}

STRUT_SMALL_INLINE void small_members(const small_run *r, const small_rest *rest,
                                      const small_points *q, const small_points *v, bool ledger,
                                      small_pulls *px, small_pulls *py, small_powers *sum) {
  const strut_small_model *s = r->tables;
  small8_span d = {.x = small_difference(s, 0, q->x), .y = small_difference(s, 0, q->y)};
  small4_span e = {0};
  if (r->plan & STRUT_TERM_DAMPING)
    d.u = small_difference(s, 0, v->x), d.w = small_difference(s, 0, v->y);
  if (s->members > 8) {
    e.x = small_half(small_difference(s, 8, q->x), 0);
    e.y = small_half(small_difference(s, 8, q->y), 0);
    if (r->plan & STRUT_TERM_DAMPING) {
      e.u = small_half(small_difference(s, 8, v->x), 0);
      e.w = small_half(small_difference(s, 8, v->y), 0);
    }
    small4_pull(r, rest, 8, &e, ledger, &sum->last);
  }
  small8_pull(r, rest, 0, &d, ledger, &sum->first);
  px->first = d.u, py->first = d.w;
  px->last = e.u, py->last = e.w;
}
#else
/* Powers of the members, of groups of 4 together; drive: what drives take. */
typedef struct small_powers {
  small4_powers sum;
} small_powers;

STRUT_SMALL_INLINE strut_lanes small_halves(strut_lanes x, small_bits halves) {
  return (strut_lanes)_mm256_permutevar8x32_ps((__m256)x, (__m256i)halves);
}
STRUT_SMALL_INLINE strut_lanes small_gather(const int64_t *halves, small_row x) {
  small_bits at = small_bits_load(halves);
  return _mm256_blendv_pd(small_halves(x.part[0], at), small_halves(x.part[1], at),
                          (strut_lanes)at);
}
STRUT_SMALL_INLINE small_row small_permute(const strut_small_column *column, small_row x) {
  return (small_row){
      {small_gather(column->lane_halves, x), small_gather(column->lane_halves + 4, x)}};
}
STRUT_SMALL_INLINE strut_lanes small_difference(const strut_small_model *s, int j, small_row x) {
  return small_gather(s->to_halves + j, x) - small_gather(s->from_halves + j, x);
}

/* The ends of 4 members: positions and, for dampers, velocities. */
STRUT_SMALL_INLINE small4_span small_ends(const small_run *r, const int64_t *halves,
                                          strut_small_source source, const small_points *q,
                                          const small_points *v) {
  bool damped = r->plan & STRUT_TERM_DAMPING;
  small_bits at = small_bits_load(halves);
  small4_span e = {0};
  if (source != STRUT_SMALL_BOTH) {
    const int p = source == STRUT_SMALL_SECOND;
    strut_lanes x = p ? q->x.part[1] : q->x.part[0], y = p ? q->y.part[1] : q->y.part[0];
    e.x = small_halves(x, at), e.y = small_halves(y, at);
    strut_lanes u = p ? v->x.part[1] : v->x.part[0], w = p ? v->y.part[1] : v->y.part[0];
    if (damped) e.u = small_halves(u, at), e.w = small_halves(w, at);
    return e;
  }
  e.x = small_gather(halves, q->x), e.y = small_gather(halves, q->y);
  if (damped) e.u = small_gather(halves, v->x), e.w = small_gather(halves, v->y);
  return e;
}

STRUT_SMALL_INLINE void small_members(const small_run *r, const small_rest *rest,
                                      const small_points *q, const small_points *v, bool ledger,
                                      small_pulls *px, small_pulls *py, small_powers *sum) {
  const strut_small_model *s = r->tables;
  *px = *py = (small_pulls){0};
#pragma GCC unroll 3
  for (int g = 0; g < 3; g++) {
    small4_powers powers = {0};
    small4_span d = {0};
    if (4 * g >= s->members) break;
    small4_span from = small_ends(r, s->from_halves + 4 * g, s->from_source[g], q, v);
    d = small_ends(r, s->to_halves + 4 * g, s->to_source[g], q, v);
    d.x -= from.x, d.y -= from.y;
    if (r->plan & STRUT_TERM_DAMPING) d.u -= from.u, d.w -= from.w;
    small4_pull(r, rest, 4 * g, &d, ledger, &powers);
    px->part[g] = d.u, py->part[g] = d.w;
    if (!ledger) continue;
    small4_powers *to = &sum->sum;
    to->drive = g ? to->drive + powers.drive : powers.drive;
    to->lost = g ? to->lost + powers.lost : powers.lost;
    to->exchanged = g ? to->exchanged + powers.exchanged : powers.exchanged;
  }
}
#endif

/* Constant forces, and then the pulls of the members in the scene's order. */
#if STRUT_SMALL_WIDTH == 8
STRUT_SMALL_INLINE small_points small_sum_pulls(const small_run *r, const small_pulls *px,
                                                const small_pulls *py) {
  const strut_small_model *s = r->tables;
  small_points f = {small_row_load(r->inputs->constant[0]), small_row_load(r->inputs->constant[1])};
  for (int32_t k = 0, degree = s->degree; k < degree; k++) {
    const strut_small_pull *at = &s->pull[k];
    small_row x = small_gather_pulls(at, px), y = small_gather_pulls(at, py);
    SMALL_EACH(p) {
      small_bits sign = small_bits_load(at->sign + p * SMALL_WIDTH);
      small_mask has = small_mask_load(at->has + p * SMALL_WIDTH);
      f.x.part[p] = small_add_where(has, f.x.part[p], small_flip(x.part[p], sign));
      f.y.part[p] = small_add_where(has, f.y.part[p], small_flip(y.part[p], sign));
    }
  }
  return f;
}
#else
STRUT_SMALL_INLINE small_points small_sum_pulls(const small_run *r, const small_pulls *px,
                                                const small_pulls *py) {
  small_points f = {small_row_load(r->inputs->constant[0]), small_row_load(r->inputs->constant[1])};
  const strut_small_pull_turns *t = &r->tables->pull_turns;
  int32_t k = 0;
#pragma GCC unroll 3
  for (int g = 0; g < 3; g++)
    for (int32_t end = t->end[g]; k < end; k++) {
      const strut_small_pull_turn *turn = &t->turn[k];
      SMALL_EACH(h) {
        small_bits at = small_bits_load(turn->halves + 4 * h);
        small_bits sign = small_bits_load(turn->sign + 4 * h);
        small_bits has = small_bits_load(turn->has + 4 * h);
        small_bits x = (small_bits)small_halves(px->part[g], at) & has;
        small_bits y = (small_bits)small_halves(py->part[g], at) & has;
        f.x.part[h] += (strut_lanes)(x ^ sign), f.y.part[h] += (strut_lanes)(y ^ sign);
      }
    }
  return f;
}
#endif

/* What the ground takes from the nodes that touch it, where it is booked; 0 at all others. */
typedef struct small_touch {
  unsigned touching; /* a bit of each lane */
  small_row minus_damped, minus_rubbed, belt, exchanged;
} small_touch;

/* What the powers of one evaluation are made of, see small_ledger.h. */
typedef struct small_entries {
  small_powers members;
  small_touch touch;
} small_entries;

/* The numbers of contact law at part p. */
#define SMALL_CONTACT(field) small_load(c->field + p * SMALL_WIDTH)
#define SMALL_CONTACT_MASK(field) small_mask_load(c->field + p * SMALL_WIDTH)

/* See ground_damper. */
STRUT_SMALL_INLINE small_real small_damper(const strut_small_contacts *c, int p, small_real spring,
                                           small_real into, bool laws) {
  small_real zero = {0};
  small_real damper = small_keep(small_less(into, zero), SMALL_CONTACT(minus_damping) * into);
  if (!laws) return damper;
  small_real other = -spring * SMALL_CONTACT(dissipation) * into;
  other = small_choose(small_less(-spring, other), other, -spring);
  return small_choose(SMALL_CONTACT_MASK(hunt_crossley), other, damper);
}

/* x times the sign of y: 0 times x where y is 0 or no number. */
STRUT_SMALL_INLINE small_real small_times_sign(small_real x, small_real y) {
  small_real zero = {0};
  small_real flipped = small_flip(x, (small_bits)y & INT64_MIN);
  return small_choose(small_less(zero, small_magnitude(y)), flipped, x * zero);
}

/* See strut_friction_force. The applied force comes last of all, so nothing else waits for it. */
STRUT_SMALL_INLINE small_real small_friction(const strut_small_contacts *c, int p,
                                             small_real normal, small_real slip, small_real applied,
                                             bool laws) {
  small_real zero = {0}, holding = SMALL_CONTACT(mu_static);
  small_mask slides = small_at_least(small_magnitude(slip), SMALL_CONTACT(stick_velocity));
  small_real most = SMALL_CONTACT(minus_mu_kinetic) * normal;
  if (laws) {
    small_mask moves = slides & small_less(zero, small_magnitude(slip));
    small_mask back = small_less(small_choose(moves, slip, applied), zero);
    holding = small_choose(back, SMALL_CONTACT(mu_static_backward), holding);
    most = small_choose(back, SMALL_CONTACT(minus_mu_kinetic_backward) * normal, most);
  }
  small_mask pushed = small_at_least(small_magnitude(applied), holding * normal);
  small_real friction = small_choose(pushed, small_times_sign(most, applied), -applied);
  friction = small_choose(slides, small_times_sign(most, slip), friction);
  if (!laws) return friction;
  small_real width = SMALL_CONTACT(width);
  small_real smooth = most * slip / small_root(slip * slip + width * width);
  friction = small_choose(SMALL_CONTACT_MASK(smooth), smooth, friction);
  return small_choose(SMALL_CONTACT_MASK(frictionless), zero, friction);
}

/* See ground_ledger; both_signs: what dampers do is exchanged by its size. */
STRUT_SMALL_INLINE void small_book_contacts(const strut_contact_table *t, small_mask closed,
                                            small_real damper, small_real into, small_real friction,
                                            small_real slip, bool both_signs, int p,
                                            small_touch *touch) {
  small_real damped = small_keep(closed, damper * into);
  small_real rubbed = small_keep(closed, friction * slip);
  touch->minus_damped.part[p] = damped, touch->minus_rubbed.part[p] = rubbed;
  touch->exchanged.part[p] = both_signs ? small_magnitude(damped) + small_magnitude(rubbed)
                                        : small_magnitude(rubbed) - damped;
  if (t->belt_speed == 0.0) return;
  touch->belt.part[p] = small_keep(closed, friction * t->belt_speed);
  touch->exchanged.part[p] += small_magnitude(touch->belt.part[p]);
}

/* See ground_touch: adds the ground's forces on the nodes of part p. */
STRUT_SMALL_INLINE void small_ground_part(const small_run *r, int p, small_real x, small_real y,
                                          small_real u, small_real w, small_points *f, bool ledger,
                                          small_touch *touch) {
  const strut_small_contacts *c = &r->tables->contact;
  const strut_contact_table *t = r->contacts;
  bool laws = r->plan & STRUT_TERM_LAWS, sloped = r->plan & (STRUT_TERM_SLOPE | STRUT_TERM_LAWS);
  bool rough = r->plan & (STRUT_TERM_FRICTION | STRUT_TERM_LAWS);
  small_real nx = small_all(t->normal[0]), ny = small_all(t->normal[1]);
  small_real tx = small_all(t->tangent[0]), ty = small_all(t->tangent[1]), zero = {0};
  small_real gap = y - t->height, into = w, along = u;
  if (sloped) gap = x * nx + gap * ny, into = u * nx + w * ny, along = u * tx + w * ty;
  small_mask closed = small_less(gap, zero) & SMALL_CONTACT_MASK(touches);
  unsigned closed_bits = small_set_bits(closed);
  touch->touching |= closed_bits << (p * SMALL_WIDTH);
  if (SMALL_PARTS > 1 && !closed_bits) return;
  small_real elastic = SMALL_CONTACT(minus_stiffness) * gap;
  small_real damper = small_damper(c, p, elastic, into, laws);
  small_real normal = elastic + damper, slip = along - t->belt_speed, friction = zero;
  small_real fx = f->x.part[p], fy = f->y.part[p];
  if (rough) friction = small_friction(c, p, normal, slip, sloped ? fx * tx + fy * ty : fx, laws);
  f->x.part[p] = small_add_where(closed, fx, sloped ? friction * tx + normal * nx : friction);
  f->y.part[p] = small_add_where(closed, fy, sloped ? friction * ty + normal * ny : normal);
  if (!ledger) return;
  small_book_contacts(t, closed, damper, into, friction, slip, false, p, touch);
}

/* a = M^-1 f, and 0 where there is no mass to divide by. */
#if STRUT_SMALL_WIDTH == 8
STRUT_SMALL_INLINE small_points small_divide_points(const strut_small_model *s,
                                                    const small_points *f) {
  const strut_small_column *column[2] = {s->column[0], s->column[1]};
  small_real a[2], force[2] = {f->x.part[0], f->y.part[0]};
#pragma GCC unroll 2
  for (int c = 0; c < 2; c++)
    a[c] = small_keep(
        small_mask_load(column[c]->has),
        small_load(column[c]->inverse) * small_gather(column[c]->lane, (small_row){{force[c]}}));
  for (int32_t j = 1, columns = s->columns; j < columns; j++)
#pragma GCC unroll 2
    for (int c = 0; c < 2; c++) {
      const strut_small_column *at = &column[c][j];
      small_real x = small_gather(at->lane, (small_row){{force[c]}});
      a[c] = small_add_where(small_mask_load(at->has), a[c], small_load(at->inverse) * x);
    }
  return (small_points){{{a[0]}}, {{a[1]}}};
}
#else
STRUT_SMALL_INLINE strut_lanes small_share(const strut_small_mass_turn *turn, int c, int h,
                                           strut_lanes f) {
  strut_lanes x = small_halves(f, small_bits_load(turn->halves[c] + 4 * h));
  x *= small4_load(turn->minus_inverse[c] + 4 * h);
  return (strut_lanes)((small_bits)x & small_bits_load(turn->has[c] + 4 * h));
}
/* Shares are taken off, of -0 first, so that lanes without one keep their bits. */
STRUT_SMALL_INLINE small_points small_divide_points(const strut_small_model *s,
                                                    const small_points *f) {
  const strut_small_mass_turns *t = &s->mass_turns;
  strut_lanes zero = small_all(-0.0);
  small_points a = {{{zero, zero}}, {{zero, zero}}};
  int32_t k = 0;
#pragma GCC unroll 2
  for (int g = 0; g < 2; g++)
    for (int32_t end = t->end[g]; k < end; k++) SMALL_EACH(h) {
        a.x.part[h] -= small_share(&t->turn[k], 0, h, f->x.part[g]);
        a.y.part[h] -= small_share(&t->turn[k], 1, h, f->y.part[g]);
      }
  return a;
}
#endif

/* Forces f and accelerations at positions q and velocities v; with the ledger what its powers are made of. */
STRUT_SMALL_INLINE small_points small_accelerate(const small_run *r, const small_rest *rest,
                                                 const small_points *q, const small_points *v,
                                                 bool ledger, small_points *f,
                                                 small_entries *entries) {
  small_pulls px, py;
  if (ledger) *entries = (small_entries){0};
  small_members(r, rest, q, v, ledger, &px, &py, &entries->members);
  *f = small_sum_pulls(r, &px, &py);
  if (r->plan & STRUT_TERM_CONTACT) SMALL_EACH(p)
  small_ground_part(r, p, q->x.part[p], q->y.part[p], v->x.part[p], v->y.part[p], f, ledger,
                    &entries->touch);
  return small_divide_points(r->tables, f);
}

#endif
