/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: powers of a small model for the energy ledger, with the bits of the general kernel: members are summed place by
 * place of groups of 4, then these places, then contacts in the order of their nodes. Transpositions make what is
 * summed one after the other into lanes of one register each.
 *
 * A sum that begins at 0 is never -0, so nothing is changed by adding 0 of a contact that is open.
 */
#ifndef STRUT_ENGINE_FORCES_SMALL_LEDGER_H
#define STRUT_ENGINE_FORCES_SMALL_LEDGER_H

#include "engine/forces/small_kernel.h"

/* Powers in the order of strut_power. */
typedef struct small_work {
#if STRUT_SMALL_WIDTH == 8
  small_real all;
#else
  strut_lanes low, high;
#endif
} small_work;

#if STRUT_SMALL_WIDTH == 8
STRUT_SMALL_INLINE small_work small_work_join(strut_lanes low, strut_lanes high) {
  return (small_work){_mm512_insertf64x4(_mm512_castpd256_pd512(low), high, 1)};
}
STRUT_SMALL_INLINE strut_lanes small_work_low(small_work w) { return small_half(w.all, 0); }
STRUT_SMALL_INLINE strut_lanes small_work_high(small_work w) { return small_half(w.all, 1); }
STRUT_SMALL_INLINE small_work small_work_load(const double *p) {
  return (small_work){small_load(p)};
}
STRUT_SMALL_INLINE void small_work_store(double *p, small_work w) { small_store(p, w.all); }
STRUT_SMALL_INLINE small_work small_scaled_work(double weight, const small_work *power) {
  return (small_work){weight * power->all};
}
STRUT_SMALL_INLINE void small_add_work(small_work *work, double weight, const small_work *power) {
  work->all += weight * power->all;
}
STRUT_SMALL_INLINE void small_add_powers(small_work *to, const small_work *power) {
  to->all += power->all;
}
#else
STRUT_SMALL_INLINE small_work small_work_join(strut_lanes low, strut_lanes high) {
  return (small_work){low, high};
}
STRUT_SMALL_INLINE strut_lanes small_work_low(small_work w) { return w.low; }
STRUT_SMALL_INLINE strut_lanes small_work_high(small_work w) { return w.high; }
STRUT_SMALL_INLINE small_work small_work_load(const double *p) {
  return (small_work){small4_load(p), small4_load(p + 4)};
}
STRUT_SMALL_INLINE void small_work_store(double *p, small_work w) {
  small4_store(p, w.low);
  small4_store(p + 4, w.high);
}
STRUT_SMALL_INLINE small_work small_scaled_work(double weight, const small_work *power) {
  return (small_work){weight * power->low, weight * power->high};
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

typedef struct small_square {
  strut_lanes row[4];
} small_square;

STRUT_SMALL_INLINE small_square small_transpose(strut_lanes a, strut_lanes b, strut_lanes c,
                                                strut_lanes d) {
  strut_lanes ab0 = _mm256_unpacklo_pd(a, b), ab1 = _mm256_unpackhi_pd(a, b);
  strut_lanes cd0 = _mm256_unpacklo_pd(c, d), cd1 = _mm256_unpackhi_pd(c, d);
  return (small_square){
      {_mm256_permute2f128_pd(ab0, cd0, 0x20), _mm256_permute2f128_pd(ab1, cd1, 0x20),
       _mm256_permute2f128_pd(ab0, cd0, 0x31), _mm256_permute2f128_pd(ab1, cd1, 0x31)}};
}
/* sum + the rows, or sum - the rows, one after the other */
STRUT_SMALL_INLINE strut_lanes small_take_rows(strut_lanes sum, small_square x) {
  return (((sum - x.row[0]) - x.row[1]) - x.row[2]) - x.row[3];
}
STRUT_SMALL_INLINE strut_lanes small_add_rows(strut_lanes sum, small_square x) {
  return (((sum + x.row[0]) + x.row[1]) + x.row[2]) + x.row[3];
}
/* Lanes 4 h to 4 h + 3 of a row. */
STRUT_SMALL_INLINE strut_lanes small_quarter(small_row x, int h) {
#if STRUT_SMALL_WIDTH == 8
  return small_half(x.part[0], h);
#else
  return x.part[h];
#endif
}

/* Powers of the members in the order of groups of 4; both: exchanged. */
typedef struct small_groups {
  strut_lanes drive, lost, both;
} small_groups;

STRUT_SMALL_INLINE small_groups small_sum_groups(const small_powers *m) {
#if STRUT_SMALL_WIDTH == 8
#define SMALL_SUM_GROUPS(field)                                                                    \
  (small_half(m->first.field, 0) + small_half(m->first.field, 1) + m->last.field)
#else
#define SMALL_SUM_GROUPS(field) m->sum.field
#endif
  strut_lanes lost = SMALL_SUM_GROUPS(lost);
  return (small_groups){SMALL_SUM_GROUPS(drive), lost, SMALL_SUM_GROUPS(exchanged) + lost};
#undef SMALL_SUM_GROUPS
}

/* x in the lanes of the bits, else 0 - x, which is no -0 where x is 0. */
#define SMALL_BOOKED(x, bits) _mm256_blend_pd((strut_lanes){0} - (x), (x), bits)

/* The members' powers. */
STRUT_SMALL_INLINE small_work small_sum_members(const small_powers *m) {
  strut_lanes zero = {0};
  small_groups g = small_sum_groups(m);
  strut_lanes sum = small_add_rows(zero, small_transpose(g.drive, g.lost, g.both, zero));
  sum = SMALL_BOOKED(sum, 0xe);
  strut_lanes low = _mm256_blend_pd(_mm256_permute4x64_pd(sum, 0x40), zero, 0x6);
  return small_work_join(low, _mm256_blend_pd(sum, zero, 0xb));
}

/* Adds the powers of the contacts. */
STRUT_SMALL_INLINE void small_add_contacts(const small_run *r, const small_touch *t,
                                           small_work *power) {
  strut_lanes sum = small_work_high(*power), low = small_work_low(*power), belt = {0};
  bool moves = r->contacts->belt_speed != 0.0;
  for (int h = 0; h < 2; h++) {
    if (!(t->touching >> 4 * h & 0xf)) continue;
    if (moves) belt = small_quarter(t->belt, h);
    sum = small_add_rows(
        sum, small_transpose(small_quarter(t->minus_damped, h), small_quarter(t->minus_rubbed, h),
                             small_quarter(t->exchanged, h), belt));
  }
  sum = SMALL_BOOKED(sum, 0xc);
  if (moves) low = _mm256_blend_pd(low, _mm256_permute4x64_pd(sum, 0x30), 0x4);
  *power = small_work_join(low, _mm256_blend_pd(sum, (strut_lanes){0}, 0x8));
}

/* All powers of one evaluation. */
STRUT_SMALL_INLINE small_work small_sum_powers(const small_run *r, const small_entries *e) {
  small_work power = small_sum_members(&e->members);
  small_add_contacts(r, &e->touch, &power);
  return power;
}

/* The powers of 4 evaluations, which are lanes here. */
typedef struct small_work4 {
  strut_lanes drive, belt, lost, contact, friction, exchanged;
} small_work4;

/* What 4 evaluations have at the nodes 4 h and up: a row of each node. */
#define SMALL_ROWS_OF_4(e, field, h)                                                               \
  small_transpose(small_quarter((e)[0].touch.field, h), small_quarter((e)[1].touch.field, h),      \
                  small_quarter((e)[2].touch.field, h), small_quarter((e)[3].touch.field, h))

/* small_sum_powers of each of 4 evaluations. */
STRUT_SMALL_INLINE small_work4 small_sum_powers_of_4(const small_run *r, const small_entries *e) {
  strut_lanes zero = {0};
  small_groups g[4];
  unsigned touching = 0;
#pragma GCC unroll 4
  for (int k = 0; k < 4; k++)
    g[k] = small_sum_groups(&e[k].members), touching |= e[k].touch.touching;
  small_work4 sum = {
      .drive =
          small_take_rows(zero, small_transpose(g[0].drive, g[1].drive, g[2].drive, g[3].drive)),
      .lost = small_add_rows(zero, small_transpose(g[0].lost, g[1].lost, g[2].lost, g[3].lost)),
      .exchanged =
          small_add_rows(zero, small_transpose(g[0].both, g[1].both, g[2].both, g[3].both))};
  bool moves = r->contacts->belt_speed != 0.0;
  for (int h = 0; h < 2; h++) {
    if (!(touching >> 4 * h & 0xf)) continue;
    sum.contact = small_take_rows(sum.contact, SMALL_ROWS_OF_4(e, minus_damped, h));
    sum.friction = small_take_rows(sum.friction, SMALL_ROWS_OF_4(e, minus_rubbed, h));
    sum.exchanged = small_add_rows(sum.exchanged, SMALL_ROWS_OF_4(e, exchanged, h));
    if (moves) sum.belt = small_add_rows(sum.belt, SMALL_ROWS_OF_4(e, belt, h));
  }
  return sum;
}

/* work + weight[k] times the powers of evaluation k, one after the other. */
STRUT_SMALL_INLINE void small_add_work_of_4(small_work *work, strut_lanes weight,
                                            const small_work4 *p) {
  strut_lanes zero = {0};
  small_square low = small_transpose(weight * p->drive, zero, weight * p->belt, weight * p->lost);
  small_square high =
      small_transpose(weight * p->contact, weight * p->friction, weight * p->exchanged, zero);
  *work = small_work_join(small_add_rows(small_work_low(*work), low),
                          small_add_rows(small_work_high(*work), high));
}

/* The powers of the last of 4. */
STRUT_SMALL_INLINE small_work small_last_of_4(const small_work4 *p) {
  return small_work_join((strut_lanes){p->drive[3], 0.0, p->belt[3], p->lost[3]},
                         (strut_lanes){p->contact[3], p->friction[3], p->exchanged[3], 0.0});
}

#endif
