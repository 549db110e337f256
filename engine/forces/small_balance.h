/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: powers of a small model for the energy balance, with the bits of the general kernel: members are
 * summed place by place of groups of 4, then these places, then contacts in the order of their nodes.
 * Transpositions make what is summed one after the other into lanes of one register each.
 *
 * A sum that begins at 0 is never -0, so nothing is changed by adding 0 of a contact that is open.
 */
#ifndef STRUT_ENGINE_FORCES_SMALL_BALANCE_H
#define STRUT_ENGINE_FORCES_SMALL_BALANCE_H

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
STRUT_SMALL_INLINE void small_add_works(small_work *work, double sixth, const small_work *sign,
                                        const small_work *sum) {
  work->all += sixth * sign->all * sum->all;
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
STRUT_SMALL_INLINE void small_add_works(small_work *work, double sixth, const small_work *sign,
                                        const small_work *sum) {
  work->low += sixth * sign->low * sum->low;
  work->high += sixth * sign->high * sum->high;
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

/* x in the lanes of the bits, else 0 - x, which is no -0 where x is 0. */
#define SMALL_ACCUMULATED(x, bits) _mm256_blend_pd((strut_lanes){0} - (x), (x), bits)

/* The members' powers. */
STRUT_SMALL_INLINE small_work small_sum_members(const small4_member_powers *m) {
  strut_lanes zero = {0};
  strut_lanes both = m->exchanged + m->lost;
  strut_lanes sum = small_add_rows(zero, small_transpose(m->drive, m->lost, both, zero));
  sum = SMALL_ACCUMULATED(sum, 0xe);
  strut_lanes low = _mm256_blend_pd(_mm256_permute4x64_pd(sum, 0x40), zero, 0x6);
  return small_work_join(low, _mm256_blend_pd(sum, zero, 0xb));
}

/* Adds the powers of the contacts. */
STRUT_SMALL_INLINE void small_add_contacts(const small_run *r, const small_touch *t,
                                           small_work *power) {
  strut_lanes sum = small_work_high(*power), low = small_work_low(*power), belt = {0};
  bool moves = r->terms & STRUT_SMALL_BELT;
  for (int h = 0; h < 2; h++) {
    if (!(t->touching >> 4 * h & 0xf)) continue;
    if (moves) belt = small_quarter(t->belt, h);
    sum = small_add_rows(
        sum, small_transpose(small_quarter(t->minus_damped, h), small_quarter(t->minus_rubbed, h),
                             small_quarter(t->exchanged, h), belt));
  }
  sum = SMALL_ACCUMULATED(sum, 0xc);
  if (moves) low = _mm256_blend_pd(low, _mm256_permute4x64_pd(sum, 0x30), 0x4);
  *power = small_work_join(low, _mm256_blend_pd(sum, (strut_lanes){0}, 0x8));
}

/* Powers of one evaluation of a step, lane by lane, see strut_power_lanes. */
typedef struct small_stage_powers {
  small4_member_powers members;
  small_row minus_damped, minus_rubbed, belt;
} small_stage_powers;

/*
 * Here the compiler has x in memory: powers wait for the end of the step, and registers are wanted for the
 * motion.
 */
#define SMALL_WAITS_IN_MEMORY(x) __asm__ volatile("" : "+m"(x))

STRUT_SMALL_INLINE void small_accumulate_touch(const small_run *r, const small_touch *t,
                                               small_stage_powers *to) {
  to->minus_damped = t->minus_damped, to->minus_rubbed = t->minus_rubbed;
  if (r->terms & STRUT_SMALL_BELT) to->belt = t->belt;
}

/*
 * The weighted sums of what stages have: of members; of contacts, see step_balance_contacts; of magnitudes of
 * two.
 */
STRUT_SMALL_INLINE strut_lanes small_weigh(strut_lanes k1, strut_lanes k2, strut_lanes k3,
                                           strut_lanes k4) {
  return (k1 + k4) + 2.0 * (k2 + k3);
}
STRUT_SMALL_INLINE small_row small_weigh_rows(small_row k1, small_row k2, small_row k3,
                                              small_row k4) {
  SMALL_EACH(p)
  k1.part[p] = (k1.part[p] + k4.part[p]) + 2.0 * (k2.part[p] + k3.part[p]);
  return k1;
}
STRUT_SMALL_INLINE strut_lanes small_join_halves(small_row x) {
  return small_quarter(x, 0) + small_quarter(x, 1);
}
STRUT_SMALL_INLINE small_row small_turnover(const small_stage_powers *k, bool moves) {
  small_row x;
  SMALL_EACH(p) {
    x.part[p] = small_magnitude(k->minus_rubbed.part[p]);
    if (moves) x.part[p] += small_magnitude(k->belt.part[p]);
  }
  return x;
}

/* a0 + a2, a1 + a3, b0 + b2, b1 + b3 */
STRUT_SMALL_INLINE strut_lanes small_fold(strut_lanes a, strut_lanes b) {
  return _mm256_permute2f128_pd(a, b, 0x20) + _mm256_permute2f128_pd(a, b, 0x31);
}
/* The sums of the lanes of a, b, c and d, in the order of step_balance_add. */
STRUT_SMALL_INLINE strut_lanes small_sum_lanes(strut_lanes a, strut_lanes b, strut_lanes c,
                                               strut_lanes d) {
  strut_lanes ac = small_fold(a, c), bd = small_fold(b, d);
  return _mm256_unpacklo_pd(ac, bd) + _mm256_unpackhi_pd(ac, bd);
}

/* See strut_step_balance_end; k: of the four stages. */
STRUT_SMALL_INLINE void small_end_stages(const small_run *r, const small_stage_powers *k,
                                         double sixth, small_work *work) {
  strut_lanes zero = {0}, belt = zero, damped = zero, rubbed = zero, turnover = zero;
  bool moves = r->terms & STRUT_SMALL_BELT;
#define SMALL_WEIGH(weigh, field) weigh(k[0].field, k[1].field, k[2].field, k[3].field)
  strut_lanes drive = SMALL_WEIGH(small_weigh, members.drive),
              lost = SMALL_WEIGH(small_weigh, members.lost);
  strut_lanes driven = SMALL_WEIGH(small_weigh, members.exchanged);
  if (r->terms & STRUT_TERM_CONTACT) {
    damped = small_join_halves(SMALL_WEIGH(small_weigh_rows, minus_damped));
    rubbed = small_join_halves(SMALL_WEIGH(small_weigh_rows, minus_rubbed));
    turnover = small_join_halves(
        small_weigh_rows(small_turnover(&k[0], moves), small_turnover(&k[1], moves),
                         small_turnover(&k[2], moves), small_turnover(&k[3], moves)));
    if (moves) belt = small_join_halves(SMALL_WEIGH(small_weigh_rows, belt));
  }
#undef SMALL_WEIGH
  strut_lanes exchanged = (driven + lost) + (turnover - damped);
  strut_lanes first = small_sum_lanes(drive, zero, belt, lost);
  strut_lanes last = small_sum_lanes(damped, rubbed, exchanged, zero);
  small_work all = small_work_join(first, last);
  small_work signs = small_work_join((strut_lanes){-1, 1, 1, 1}, (strut_lanes){-1, -1, 1, 1});
  small_add_works(work, sixth, &signs, &all);
}

#endif
