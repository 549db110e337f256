/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the ledger of a Runge-Kutta step of several runs at once; see step_ledger.h, whose order of sums this is.
 * What is a lane there is a place here, since lanes are runs.
 */
#ifndef STRUT_ENGINE_FORCES_LANE_LEDGER_H
#define STRUT_ENGINE_FORCES_LANE_LEDGER_H

#include "engine/forces/lane_tables.h"
#include "engine/forces/lane_vector.h"

/* See strut_power_lanes. */
typedef struct lane_contact_sums {
  lane_real minus_damped, minus_rubbed, belt, turnover;
} lane_contact_sums;
/* Of members what each stage has, of contacts sums over the stages with one weight, see strut_weight_side. */
typedef struct lane_step_sums {
  lane_member_powers member[4][STRUT_LANES][LANE_PARTS];
  lane_contact_sums contact[2][STRUT_CONTACT_LANES][LANE_PARTS];
} lane_step_sums;
/* Where one stage books. moves: the ground does in some lane. */
typedef struct lane_book {
  lane_member_powers (*member)[LANE_PARTS];
  lane_contact_sums (*contact)[LANE_PARTS];
  bool moves;
} lane_book;

STRUT_LANE_INLINE lane_book lane_book_of_stage(lane_step_sums *s, int k, bool moves) {
  return (lane_book){s->member[k], s->contact[strut_weight_side(k)], moves};
}

STRUT_LANE_INLINE void lane_clear_contact(lane_contact_sums *s, bool moves) {
  lane_real zero = {0};
  s->minus_damped = zero, s->minus_rubbed = zero, s->turnover = zero;
  if (moves) s->belt = zero;
}
STRUT_LANE_INLINE void lane_clear_member(lane_member_powers *s) {
  lane_real zero = {0};
  s->drive = zero, s->lost = zero, s->exchanged = zero;
}
/* Written out: of a loop would be made a call. */
STRUT_LANE_INLINE void lane_clear_members(lane_member_powers (*s)[LANE_PARTS]) {
  LANE_EACH(lane_clear_member(&s[0][p]));
  LANE_EACH(lane_clear_member(&s[1][p]));
  LANE_EACH(lane_clear_member(&s[2][p]));
  LANE_EACH(lane_clear_member(&s[3][p]));
}

/* All places, before the first step: those without a contact stay clear. */
STRUT_LANE_INLINE void lane_clear_sums(lane_step_sums *s) {
  for (int k = 0; k < 2; k++)
    for (int l = 0; l < STRUT_CONTACT_LANES; l++)
      LANE_EACH(lane_clear_contact(&s->contact[k][l][p], true));
}
/* At the begin of a step. */
STRUT_LANE_INLINE void lane_begin_sums(const strut_contact_table *c, bool moves,
                                       lane_step_sums *s) {
  for (int32_t i = 0; i < c->count; i++) {
    LANE_EACH(lane_clear_contact(&s->contact[0][c->entry[i].lane][p], moves));
    LANE_EACH(lane_clear_contact(&s->contact[1][c->entry[i].lane][p], moves));
  }
}

/* No sum is ever -0, so nothing is changed by adding 0 in lanes where the contact is open. */
STRUT_LANE_INLINE void lane_book_contact(lane_contact_sums *s, lane_mask where,
                                         lane_contact_powers powers) {
  lane_real damped = lane_keep(where, powers.damper), rubbed = lane_keep(where, powers.friction);
  s->minus_damped += damped, s->minus_rubbed += rubbed, s->turnover += lane_magnitude(rubbed);
}
/* The same of a ground that moves in the lanes of a mask. */
STRUT_LANE_INLINE void lane_book_belt(lane_contact_sums *s, lane_mask where, lane_mask moves,
                                      lane_contact_powers powers) {
  lane_real damped = lane_keep(where, powers.damper), rubbed = lane_keep(where, powers.friction);
  lane_real belt = lane_keep(where & moves, powers.belt);
  s->minus_damped += damped, s->minus_rubbed += rubbed, s->belt += belt;
  s->turnover += lane_magnitude(rubbed) + lane_magnitude(belt);
}

/* The weighted sums of two places of contacts, l and l + 4, that make one of members. */
STRUT_LANE_INLINE lane_contact_sums lane_weigh_contacts(const lane_step_sums *s, int l, int p) {
  const lane_contact_sums *a = &s->contact[0][l][p], *b = &s->contact[1][l][p];
  const lane_contact_sums *c = &s->contact[0][l + STRUT_LANES][p],
                          *d = &s->contact[1][l + STRUT_LANES][p];
#define LANE_WEIGH(of) .of = (a->of + 2.0 * b->of) + (c->of + 2.0 * d->of)
  return (lane_contact_sums){LANE_WEIGH(minus_damped), LANE_WEIGH(minus_rubbed), LANE_WEIGH(belt),
                             LANE_WEIGH(turnover)};
#undef LANE_WEIGH
}
/* Those of members over the stages. */
STRUT_LANE_INLINE lane_member_powers lane_weigh_members(const lane_step_sums *s, int l, int p) {
  const lane_member_powers *a = &s->member[0][l][p], *b = &s->member[1][l][p];
  const lane_member_powers *c = &s->member[2][l][p], *d = &s->member[3][l][p];
#define LANE_WEIGH(of) .of = (a->of + d->of) + 2.0 * (b->of + c->of)
  return (lane_member_powers){LANE_WEIGH(drive), LANE_WEIGH(exchanged), LANE_WEIGH(lost)};
#undef LANE_WEIGH
}

/* The sum over places. */
STRUT_LANE_INLINE lane_real lane_sum_places(const lane_real *x) {
  return (x[0] + x[2]) + (x[1] + x[3]);
}
STRUT_LANE_INLINE void lane_add_work(double *work, size_t power, int p, lane_real sixth,
                                     const lane_real *x) {
  lane_put(work, power, p, lane_row(work, power, p) + sixth * lane_sum_places(x));
}

/* Adds the works of a step, of part p. */
STRUT_LANE_INLINE void lane_end_sums(const strut_model *m, const lane_step_sums *s, int p,
                                     bool moves, lane_real sixth, double *work) {
  lane_real drive[STRUT_LANES], lost[STRUT_LANES], exchanged[STRUT_LANES];
  lane_real damped[STRUT_LANES], rubbed[STRUT_LANES], belt[STRUT_LANES], zero = {0};
  bool members = m->plan & STRUT_TERM_MEMBERS, contacts = m->plan & STRUT_TERM_CONTACT;
  for (int l = 0; l < STRUT_LANES; l++) exchanged[l] = zero;
  for (int l = 0; l < STRUT_LANES && members; l++) {
    lane_member_powers of = lane_weigh_members(s, l, p);
    drive[l] = of.drive, lost[l] = of.lost, exchanged[l] = of.exchanged + of.lost;
  }
  for (int l = 0; l < STRUT_LANES && contacts; l++) {
    lane_contact_sums of = lane_weigh_contacts(s, l, p);
    damped[l] = of.minus_damped, rubbed[l] = of.minus_rubbed, belt[l] = of.belt;
    exchanged[l] += of.turnover - of.minus_damped;
  }
  if (members) {
    lane_add_work(work, STRUT_POWER_DRIVE, p, sixth, drive);
    lane_add_work(work, STRUT_POWER_MEMBERS, p, sixth, lost);
  }
  if (contacts) {
    if (moves) lane_add_work(work, STRUT_POWER_BELT, p, sixth, belt);
    lane_add_work(work, STRUT_POWER_CONTACT, p, -sixth, damped);
    lane_add_work(work, STRUT_POWER_FRICTION, p, -sixth, rubbed);
  }
  lane_add_work(work, STRUT_POWER_EXCHANGED, p, sixth, exchanged);
}

#endif
