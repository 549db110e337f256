/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the energy balance of a Runge-Kutta step of several runs at once; see step_balance.h, whose order of
 * sums this is. What is a lane there is a place here, since a lane is a run here.
 */
#ifndef STRUT_ENGINE_FORCES_BATCH_BALANCE_H
#define STRUT_ENGINE_FORCES_BATCH_BALANCE_H

#include "engine/forces/batch_tables.h"
#include "engine/forces/batch_vector.h"

/* See strut_power_lanes. */
typedef struct batch_contact_sums {
  batch_real minus_damped, minus_rubbed, belt, turnover;
} batch_contact_sums;
/* Of members what each stage has, of contacts sums over the stages with one weight, see strut_weight_side. */
typedef struct batch_step_sums {
  batch_member_powers member[4][STRUT_LANES][BATCH_PARTS];
  batch_contact_sums contact[2][STRUT_CONTACT_LANES][BATCH_PARTS];
} batch_step_sums;
/* Where one stage accumulates. moves: the ground does in some lane. */
typedef struct batch_sums {
  batch_member_powers (*member)[BATCH_PARTS];
  batch_contact_sums (*contact)[BATCH_PARTS];
  bool moves;
} batch_sums;

STRUT_BATCH_INLINE batch_sums batch_sums_of_stage(batch_step_sums *s, int k, bool moves) {
  return (batch_sums){s->member[k], s->contact[strut_weight_side(k)], moves};
}

STRUT_BATCH_INLINE void batch_clear_contact(batch_contact_sums *s, bool moves) {
  batch_real zero = {0};
  s->minus_damped = zero, s->minus_rubbed = zero, s->turnover = zero;
  if (moves) s->belt = zero;
}
STRUT_BATCH_INLINE void batch_clear_member(batch_member_powers *s) {
  batch_real zero = {0};
  s->drive = zero, s->lost = zero, s->exchanged = zero;
}
/* Written out: of a loop would be made a call. */
STRUT_BATCH_INLINE void batch_clear_members(batch_member_powers (*s)[BATCH_PARTS]) {
  BATCH_EACH(batch_clear_member(&s[0][p]));
  BATCH_EACH(batch_clear_member(&s[1][p]));
  BATCH_EACH(batch_clear_member(&s[2][p]));
  BATCH_EACH(batch_clear_member(&s[3][p]));
}

/* All places, before the first step: those without a contact stay clear. */
STRUT_BATCH_INLINE void batch_clear_sums(batch_step_sums *s) {
  for (int k = 0; k < 2; k++)
    for (int l = 0; l < STRUT_CONTACT_LANES; l++)
      BATCH_EACH(batch_clear_contact(&s->contact[k][l][p], true));
}
/* At the begin of a step. */
STRUT_BATCH_INLINE void batch_begin_sums(const strut_contact_table *c, bool moves,
                                         batch_step_sums *s) {
  for (int32_t i = 0; i < c->count; i++) {
    BATCH_EACH(batch_clear_contact(&s->contact[0][c->entry[i].lane][p], moves));
    BATCH_EACH(batch_clear_contact(&s->contact[1][c->entry[i].lane][p], moves));
  }
}

/* No sum is ever -0, so nothing is changed by adding 0 in lanes where the contact is open. */
STRUT_BATCH_INLINE void batch_accumulate_contact(batch_contact_sums *s, batch_mask where,
                                                 batch_contact_powers powers) {
  batch_real damped = batch_keep(where, powers.damper), rubbed = batch_keep(where, powers.friction);
  s->minus_damped += damped, s->minus_rubbed += rubbed, s->turnover += batch_magnitude(rubbed);
}
/* The same of a ground that moves in the lanes of a mask. */
STRUT_BATCH_INLINE void batch_accumulate_belt(batch_contact_sums *s, batch_mask where,
                                              batch_mask moves, batch_contact_powers powers) {
  batch_real damped = batch_keep(where, powers.damper), rubbed = batch_keep(where, powers.friction);
  batch_real belt = batch_keep(where & moves, powers.belt);
  s->minus_damped += damped, s->minus_rubbed += rubbed, s->belt += belt;
  s->turnover += batch_magnitude(rubbed) + batch_magnitude(belt);
}

/* The weighted sums of two places of contacts, l and l + 4, that make one of members. */
STRUT_BATCH_INLINE batch_contact_sums batch_weigh_contacts(const batch_step_sums *s, int l, int p) {
  const batch_contact_sums *a = &s->contact[0][l][p], *b = &s->contact[1][l][p];
  const batch_contact_sums *c = &s->contact[0][l + STRUT_LANES][p],
                           *d = &s->contact[1][l + STRUT_LANES][p];
#define BATCH_WEIGH(of) .of = (a->of + 2.0 * b->of) + (c->of + 2.0 * d->of)
  return (batch_contact_sums){BATCH_WEIGH(minus_damped), BATCH_WEIGH(minus_rubbed),
                              BATCH_WEIGH(belt), BATCH_WEIGH(turnover)};
#undef BATCH_WEIGH
}
/* Those of members over the stages. */
STRUT_BATCH_INLINE batch_member_powers batch_weigh_members(const batch_step_sums *s, int l, int p) {
  const batch_member_powers *a = &s->member[0][l][p], *b = &s->member[1][l][p];
  const batch_member_powers *c = &s->member[2][l][p], *d = &s->member[3][l][p];
#define BATCH_WEIGH(of) .of = (a->of + d->of) + 2.0 * (b->of + c->of)
  return (batch_member_powers){BATCH_WEIGH(drive), BATCH_WEIGH(exchanged), BATCH_WEIGH(lost)};
#undef BATCH_WEIGH
}

/* The sum over places. */
STRUT_BATCH_INLINE batch_real batch_sum_places(const batch_real *x) {
  return (x[0] + x[2]) + (x[1] + x[3]);
}
STRUT_BATCH_INLINE void batch_add_work(double *work, size_t power, int p, batch_real sixth,
                                       const batch_real *x) {
  batch_put(work, power, p, batch_row(work, power, p) + sixth * batch_sum_places(x));
}

/* Adds the works of a step, of part p. */
STRUT_BATCH_INLINE void batch_end_sums(const strut_model *m, const batch_step_sums *s, int p,
                                       bool moves, batch_real sixth, double *work) {
  batch_real drive[STRUT_LANES], lost[STRUT_LANES], exchanged[STRUT_LANES];
  batch_real damped[STRUT_LANES], rubbed[STRUT_LANES], belt[STRUT_LANES], zero = {0};
  bool members = m->terms & STRUT_TERM_MEMBERS, contacts = m->terms & STRUT_TERM_CONTACT;
  for (int l = 0; l < STRUT_LANES; l++) exchanged[l] = zero;
  for (int l = 0; l < STRUT_LANES && members; l++) {
    batch_member_powers of = batch_weigh_members(s, l, p);
    drive[l] = of.drive, lost[l] = of.lost, exchanged[l] = of.exchanged + of.lost;
  }
  for (int l = 0; l < STRUT_LANES && contacts; l++) {
    batch_contact_sums of = batch_weigh_contacts(s, l, p);
    damped[l] = of.minus_damped, rubbed[l] = of.minus_rubbed, belt[l] = of.belt;
    exchanged[l] += of.turnover - of.minus_damped;
  }
  if (members) {
    batch_add_work(work, STRUT_POWER_DRIVE, p, sixth, drive);
    batch_add_work(work, STRUT_POWER_MEMBERS, p, sixth, lost);
  }
  if (contacts) {
    if (moves) batch_add_work(work, STRUT_POWER_BELT, p, sixth, belt);
    batch_add_work(work, STRUT_POWER_CONTACT, p, -sixth, damped);
    batch_add_work(work, STRUT_POWER_FRICTION, p, -sixth, rubbed);
  }
  batch_add_work(work, STRUT_POWER_EXCHANGED, p, sixth, exchanged);
}

#endif
