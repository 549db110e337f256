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

#include "engine/forces/small_vector.h"
#include "engine/model/state.h"

/* What a run of steps reads beside the tables: of the model as it now is, and of the drives. */
typedef struct small_run {
  const strut_small_model *tables;
  const strut_contact_table *contacts;
  unsigned plan;               /* with the terms that a copy knows */
  strut_small_row constant[2]; /* constant forces [N] */
  double slack_length_threshold[STRUT_SMALL_SLOTS], slack_force_threshold[STRUT_SMALL_SLOTS];
} small_run;

/* Rest lengths [m] and their rates [m/s] at one instant. */
typedef struct small_rest {
  double rest[STRUT_SMALL_SLOTS], rate[STRUT_SMALL_SLOTS];
} small_rest;

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
    return (PREFIX##_values){.length = length,                                                      \
                             .rate = rate,                                                          \
                             .rest = load(rest->rest + j),                                          \
                             .rest_rate = load(rest->rate + j),                                     \
                             .stiffness = load(s->stiffness + j),                                   \
                             .damping = load(s->damping + j),                                       \
                             .slack_length_threshold = load(r->slack_length_threshold + j),         \
                             .slack_force_threshold = load(r->slack_force_threshold + j)};          \
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
      powers->drive = -tension * m.rest_rate;                                                       \
      powers->exchanged = (number)((mask)powers->drive & INT64_MAX);                                \
    }                                                                                               \
    if (r->plan & STRUT_TERM_DAMPING) powers->lost = (tension - elastic) * own_rate;                \
  }

STRUT_DEFINE_SMALL_GROUP(strut_lanes, strut_lane_mask, small4, small4_load, small_root_of_4)

/* Powers of the members in the order of groups of 4, which the general kernel sums. */
typedef struct small_powers {
  strut_lanes drive, lost, both; /* both: exchanged */
} small_powers;

#if STRUT_SMALL_WIDTH == 8
STRUT_DEFINE_SMALL_GROUP(small_real, small_bits, small8, small_load, small_root)

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
  small8_powers powers = {0};
  small4_powers more = {0};
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
    small4_pull(r, rest, 8, &e, ledger, &more);
  }
  small8_pull(r, rest, 0, &d, ledger, &powers);
  px->first = d.u, py->first = d.w;
  px->last = e.u, py->last = e.w;
  if (!ledger) return;
  sum->drive = small_half(powers.drive, 0) + small_half(powers.drive, 1) + more.drive;
  sum->lost = small_half(powers.lost, 0) + small_half(powers.lost, 1) + more.lost;
  sum->both = small_half(powers.exchanged, 0) + small_half(powers.exchanged, 1) + more.exchanged;
  sum->both += sum->lost;
}
#else
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
STRUT_SMALL_INLINE small_row small_gather_pulls(const strut_small_pull *k, const small_pulls *p) {
  small_row x;
  SMALL_EACH(h) {
    small_bits at = small_bits_load(k->slot_halves + 4 * h);
    x.part[h] = _mm256_blendv_pd(small_halves(p->part[0], at), small_halves(p->part[1], at),
                                 (strut_lanes)at);
    x.part[h] = _mm256_blendv_pd(x.part[h], small_halves(p->part[2], at), (strut_lanes)(at << 1));
  }
  return x;
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
    d.x = small_difference(s, 4 * g, q->x), d.y = small_difference(s, 4 * g, q->y);
    if (r->plan & STRUT_TERM_DAMPING)
      d.u = small_difference(s, 4 * g, v->x), d.w = small_difference(s, 4 * g, v->y);
    small4_pull(r, rest, 4 * g, &d, ledger, &powers);
    px->part[g] = d.u, py->part[g] = d.w;
    if (!ledger) continue;
    sum->drive += powers.drive, sum->lost += powers.lost, sum->both += powers.exchanged;
  }
  sum->both += sum->lost;
}
#endif

/* Constant forces, and then the pulls of the members in the scene's order. */
STRUT_SMALL_INLINE small_points small_sum_pulls(const small_run *r, const small_pulls *px,
                                                const small_pulls *py) {
  const strut_small_model *s = r->tables;
  small_points f = {small_row_load(r->constant[0]), small_row_load(r->constant[1])};
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

/* What the ground does to the nodes that touch it, where it is booked. */
typedef struct small_touch {
  unsigned touching; /* a bit of each lane */
  small_row damped, rubbed, belt, exchanged;
} small_touch;

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
  small_real elastic = SMALL_CONTACT(minus_stiffness) * gap;
  small_real damper = small_damper(c, p, elastic, into, laws);
  small_real normal = elastic + damper, slip = along - t->belt_speed, friction = zero;
  small_real fx = f->x.part[p], fy = f->y.part[p];
  if (rough) friction = small_friction(c, p, normal, slip, sloped ? fx * tx + fy * ty : fx, laws);
  f->x.part[p] = small_add_where(closed, fx, sloped ? friction * tx + normal * nx : friction);
  f->y.part[p] = small_add_where(closed, fy, sloped ? friction * ty + normal * ny : normal);
  if (!ledger) return;
  touch->damped.part[p] = -damper * into;
  touch->rubbed.part[p] = -friction * slip;
  touch->exchanged.part[p] = touch->damped.part[p] + small_magnitude(touch->rubbed.part[p]);
  if (t->belt_speed == 0.0) return;
  touch->belt.part[p] = friction * t->belt_speed;
  touch->exchanged.part[p] += small_magnitude(touch->belt.part[p]);
}

/* a = M^-1 f, and 0 where there is no mass to divide by. */
STRUT_SMALL_INLINE small_row small_divide(const strut_small_model *s, int c, small_row f) {
  const strut_small_column *column = s->column[c];
  small_row a = small_permute(column, f);
  SMALL_EACH(p)
  a.part[p] = small_keep(small_mask_load(column->has + p * SMALL_WIDTH),
                         small_load(column->inverse + p * SMALL_WIDTH) * a.part[p]);
  for (int32_t j = 1, columns = s->columns; j < columns; j++) {
    column = &s->column[c][j];
    small_row x = small_permute(column, f);
    SMALL_EACH(p)
    a.part[p] = small_add_where(small_mask_load(column->has + p * SMALL_WIDTH), a.part[p],
                                small_load(column->inverse + p * SMALL_WIDTH) * x.part[p]);
  }
  return a;
}

#if STRUT_SMALL_WIDTH == 8
/* Powers in the order of strut_power. */
typedef struct small_work {
  __m512d sum;
} small_work;

/* Sums of the members' powers, place by place within groups of 4, and then of the contacts'. */
STRUT_SMALL_INLINE small_work small_sum_powers(const small_run *r, const small_powers *m,
                                               const small_touch *t) {
  enum { DRIVE_LOST_BOTH = 0x49, CONTACT_FRICTION = 0x30, EXCHANGED = 0x40, BELT = 0x04 };
  static const int64_t member[4][8] = {{0, 0, 0, 4, 0, 0, 8, 0},
                                       {1, 0, 0, 5, 0, 0, 9, 0},
                                       {2, 0, 0, 6, 0, 0, 10, 0},
                                       {3, 0, 0, 7, 0, 0, 11, 0}};
  static const int64_t contact[8][8] = {{0, 0, 0, 0, 0, 8, 0, 0},  {1, 1, 1, 1, 1, 9, 1, 1},
                                        {2, 2, 2, 2, 2, 10, 2, 2}, {3, 3, 3, 3, 3, 11, 3, 3},
                                        {4, 4, 4, 4, 4, 12, 4, 4}, {5, 5, 5, 5, 5, 13, 5, 5},
                                        {6, 6, 6, 6, 6, 14, 6, 6}, {7, 7, 7, 7, 7, 15, 7, 7}};
  __m512d sum = _mm512_setzero_pd();
  if (r->plan & (STRUT_TERM_DRIVE | STRUT_TERM_DAMPING)) {
    __m512d pair = _mm512_insertf64x4(_mm512_castpd256_pd512(m->drive), m->lost, 1);
    __m512d both = _mm512_castpd256_pd512(m->both);
#pragma GCC unroll 4
    for (int l = 0; l < 4; l++)
      sum += _mm512_maskz_permutex2var_pd(DRIVE_LOST_BOTH, pair,
                                          (__m512i)small_bits_load(member[l]), both);
  }
  for (unsigned left = t->touching; left; left &= left - 1) {
    __m512i at = (__m512i)small_bits_load(contact[__builtin_ctz(left)]);
    __m512d x =
        _mm512_maskz_permutex2var_pd(CONTACT_FRICTION, t->damped.part[0], at, t->rubbed.part[0]);
    x = _mm512_mask_permutexvar_pd(x, EXCHANGED, at, t->exchanged.part[0]);
    if (r->contacts->belt_speed != 0.0)
      x = _mm512_mask_permutexvar_pd(x, BELT, at, t->belt.part[0]);
    sum += x;
  }
  return (small_work){sum};
}

STRUT_SMALL_INLINE small_work small_work_load(const double *p) {
  return (small_work){_mm512_loadu_pd(p)};
}
STRUT_SMALL_INLINE void small_work_store(double *p, small_work w) { _mm512_storeu_pd(p, w.sum); }
STRUT_SMALL_INLINE void small_add_work(small_work *work, double weight, const small_work *power) {
  work->sum += weight * power->sum;
}
STRUT_SMALL_INLINE void small_add_powers(small_work *to, const small_work *power) {
  to->sum += power->sum;
}
#else
/* Powers in the order of strut_power. */
typedef struct small_work {
  strut_lanes low, high;
} small_work;

STRUT_SMALL_INLINE small_work small_sum_powers(const small_run *r, const small_powers *m,
                                               const small_touch *t) {
  double damped[STRUT_SMALL_NODES], rubbed[STRUT_SMALL_NODES], belt[STRUT_SMALL_NODES];
  double exchanged[STRUT_SMALL_NODES];
  strut_lanes zero = {0}, sum = zero;
  strut_lanes even = _mm256_unpacklo_pd(m->drive, m->lost),
              odd = _mm256_unpackhi_pd(m->drive, m->lost);
  strut_lanes even2 = _mm256_unpacklo_pd(m->both, zero), odd2 = _mm256_unpackhi_pd(m->both, zero);
  sum += _mm256_permute2f128_pd(even, even2, 0x20);
  sum += _mm256_permute2f128_pd(odd, odd2, 0x20);
  sum += _mm256_permute2f128_pd(even, even2, 0x31);
  sum += _mm256_permute2f128_pd(odd, odd2, 0x31);
  double contact = 0.0, friction = 0.0, moved = 0.0, both = sum[2];
  small_row_store(damped, t->damped), small_row_store(rubbed, t->rubbed);
  small_row_store(exchanged, t->exchanged);
  if (r->contacts->belt_speed != 0.0) small_row_store(belt, t->belt);
  for (unsigned left = t->touching; left; left &= left - 1) {
    int i = __builtin_ctz(left);
    contact += damped[i], friction += rubbed[i], both += exchanged[i];
    if (r->contacts->belt_speed != 0.0) moved += belt[i];
  }
  return (small_work){{sum[0], 0.0, moved, sum[1]}, {contact, friction, both, 0.0}};
}

STRUT_SMALL_INLINE small_work small_work_load(const double *p) {
  return (small_work){small4_load(p), small4_load(p + 4)};
}
STRUT_SMALL_INLINE void small_work_store(double *p, small_work w) {
  small4_store(p, w.low);
  small4_store(p + 4, w.high);
}
STRUT_SMALL_INLINE void small_add_work(small_work *work, double weight, const small_work *power) {
  work->low += weight * power->low;
  work->high += weight * power->high;
}
STRUT_SMALL_INLINE void small_add_powers(small_work *to, const small_work *power) {
  to->low += power->low;
  to->high += power->high;
}
#endif

/* Forces f and accelerations a at positions q and velocities v; the powers with the ledger. */
STRUT_SMALL_INLINE small_points small_accelerate(const small_run *r, const small_rest *rest,
                                                 const small_points *q, const small_points *v,
                                                 bool ledger, small_points *f, small_work *power) {
  small_pulls px, py;
  small_powers members = {0};
  small_touch touch = {0};
  small_members(r, rest, q, v, ledger, &px, &py, &members);
  *f = small_sum_pulls(r, &px, &py);
  if (r->plan & STRUT_TERM_CONTACT) SMALL_EACH(p)
  small_ground_part(r, p, q->x.part[p], q->y.part[p], v->x.part[p], v->y.part[p], f, ledger,
                    &touch);
  if (ledger) *power = small_sum_powers(r, &members, &touch);
  return (small_points){small_divide(r->tables, 0, f->x), small_divide(r->tables, 1, f->y)};
}

#endif
