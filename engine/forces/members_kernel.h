/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Texts of laws for four things side by side, the vectors of model/algebra/hot.h: members, and coordinates in a
    step. */
#pragma once

#include "engine/base/vec.h"
#include "engine/model/algebra/hot.h"
#include "engine/model/state.h"

#define LAW(name) four_##name
#define LAW_INLINE STRUT_INLINE
#include "engine/scene/laws/member.h"
#include "engine/scene/laws/runge_kutta.h"
#undef LAW
#undef LAW_INLINE

/* Hot: forces along members, equations (1), (2) and (6).
 *
 * Blocks of members are worked on in groups of STRUT_LANES: gather the ends, and compute along the
 * group. Then each node of the block adds up the pulls on it in the scene's order (pull_rows.h). What no
 * member of a block needs (dampers, slack, drive) is compiled out of the block's loop.
 */

/* Vectors from the first to the second nodes of a group: their x and their y. */
typedef struct member_vectors {
  strut_lanes x, y;
} member_vectors;

STRUT_INLINE member_vectors members_gather(const double *restrict p, const uint32_t *restrict from,
                                           const uint32_t *restrict to) {
  strut_lanes even =
      strut_lanes_join(p + to[0], p + to[2]) - strut_lanes_join(p + from[0], p + from[2]);
  strut_lanes odd =
      strut_lanes_join(p + to[1], p + to[3]) - strut_lanes_join(p + from[1], p + from[3]);
  return (member_vectors){__builtin_shufflevector(even, odd, 0, 4, 2, 6),
                          __builtin_shufflevector(even, odd, 1, 5, 3, 7)};
}

/* What the law asks of the members from j on; `rate`: of the lengths [m/s]. */
STRUT_INLINE four_member_values members_values(const strut_member_table *t,
                                               const strut_state *state, int32_t j, bool driven,
                                               strut_lanes length, strut_lanes rate) {
  return (four_member_values){
      .length = length,
      .rate = rate,
      .rest = strut_lanes_load((driven ? state->latest->rest : t->rest) + j),
      .rest_rate = driven ? strut_lanes_load(state->latest->rest_rate + j) : (strut_lanes){0},
      .stiffness = strut_lanes_load(t->stiffness + j),
      .damping = strut_lanes_load(t->damping + j),
      .slack_length_threshold = strut_lanes_load(state->modes.slack_length_threshold + j),
      .slack_force_threshold = strut_lanes_load(state->modes.slack_force_threshold + j)};
}

/* Pulls of a group on the first ends: x and y of its even members, and of its odd ones. */
typedef struct member_pulls {
  strut_lanes even, odd;
} member_pulls;

/*
 * Pulls of the STRUT_LANES members from j on. A member of zero length has no direction and
 * no force.
 */
STRUT_INLINE member_pulls members_group(const strut_member_table *t, const strut_state *state,
                                        const double *restrict q, const double *restrict v,
                                        int32_t j, unsigned terms, bool balance,
                                        four_member_powers *powers) {
  const uint32_t *restrict from = t->from + j, *restrict to = t->to + j;
  member_vectors d = members_gather(q, from, to);
  strut_lanes length = four_root(d.x * d.x + d.y * d.y);
  strut_lanes inverse = four_choose(length > 0.0, 1.0 / length, (strut_lanes){0}), rate = {0};
  if ((terms & STRUT_TERM_DAMPING) || (balance && (terms & STRUT_TERM_DRIVE))) {
    member_vectors w = members_gather(v, from, to);
    rate = (w.x * d.x + w.y * d.y) * inverse; /* the products need not wait for the root */
  }
  four_member_values m = members_values(t, state, j, terms & STRUT_TERM_DRIVE, length, rate);
  bool damped = terms & STRUT_TERM_DAMPING, slack = terms & STRUT_TERM_SLACK;
  bool driven = terms & STRUT_TERM_DRIVE;
  strut_lanes damper, tension = four_member_tension(&m, damped, slack, driven, balance, &damper);
  if (balance) four_member_add_powers(&m, damped, driven, tension, damper, powers);
  strut_lanes density = tension * inverse, px = density * d.x, py = density * d.y;
  return (member_pulls){__builtin_shufflevector(px, py, 0, 4, 2, 6),
                        __builtin_shufflevector(px, py, 1, 5, 3, 7)};
}

/* Pulls of two members on their first and second ends, pair by pair. */
STRUT_INLINE void members_store_pairs(double *pull, strut_lanes pulls) {
  strut_pair one = __builtin_shufflevector(pulls, pulls, 0, 1);
  strut_pair other = __builtin_shufflevector(pulls, pulls, 2, 3);
  strut_pair_store(pull, one);
  strut_pair_store(pull + 2, other);
  strut_pair_store(pull + 2 * STRUT_LANES, -one);
  strut_pair_store(pull + 2 * STRUT_LANES + 2, -other);
}

/*
 * Pulls of a group where strut_pull_at tells. Where registers are narrower than strut_lanes, pair by pair:
 * such a vector would be put together in memory, and copying it from there would have to wait.
 */
STRUT_INLINE void members_store(double *pull, member_pulls group, bool wide) {
  if (wide) {
    strut_lanes_store(pull, group.even);
    strut_lanes_store(pull + STRUT_LANES, group.odd);
    strut_lanes_store(pull + 2 * STRUT_LANES, -group.even);
    strut_lanes_store(pull + 3 * STRUT_LANES, -group.odd);
  } else {
    members_store_pairs(pull, group.even);
    members_store_pairs(pull + STRUT_LANES, group.odd);
  }
}

/*
 * A block: its pulls go where strut_pull_at tells. The table is a copy in the caller's frame, so that no
 * store can be taken to change it.
 */
STRUT_INLINE void members_block(const strut_member_table *t, const strut_state *state,
                                const double *restrict q, const double *restrict v,
                                double *restrict pull, int32_t begin, int32_t end, unsigned terms,
                                bool balance, four_member_powers *powers) {
  bool wide = STRUT_WIDE_REGISTERS;
  for (int32_t j = begin; j < end; j += STRUT_LANES, pull += 4 * STRUT_LANES) {
    member_pulls group = members_group(t, state, q, v, j, terms, balance, powers);
    members_store(pull, group, wide);
  }
}

/* Adds the pulls of a block, whose rows have `width` of them. */
STRUT_INLINE void members_add_rows_of(const strut_pull_rows *t, int32_t width,
                                      const double *restrict pull, double *restrict force) {
  const uint32_t *restrict at = t->at;
  const uint16_t *restrict from = t->pull;
  for (int32_t i = 0, rows = t->rows; i < rows; i++, from += width) {
    strut_pair sum = strut_pair_load(force + at[i]);
    for (int32_t k = 0; k < width; k++) sum += strut_pair_load(pull + from[k]);
    strut_pair_store(force + at[i], sum);
  }
}

STRUT_LOOP void members_add_rows(const strut_pull_rows *t, double *restrict pull,
                                 double *restrict force) {
  strut_pair_store(pull + STRUT_NO_PULL, (strut_pair){-0.0, -0.0});
  switch (t->width) {
    case 1: members_add_rows_of(t, 1, pull, force); break;
    case 2: members_add_rows_of(t, 2, pull, force); break;
    case 3: members_add_rows_of(t, 3, pull, force); break;
    case 4: members_add_rows_of(t, 4, pull, force); break;
    case 5: members_add_rows_of(t, 5, pull, force); break;
    case STRUT_WIDEST_ROW: members_add_rows_of(t, STRUT_WIDEST_ROW, pull, force); break;
  }
}

/* Block b; one copy of the loop per set of terms, so none is tested inside. */
STRUT_LOOP void members_of_block(const strut_member_table *t, const strut_state *state,
                                 const double *restrict q, const double *restrict v,
                                 double *restrict force, int32_t b, bool balance,
                                 four_member_powers *powers) {
  enum { K = STRUT_TERM_DAMPING, S = STRUT_TERM_SLACK, D = STRUT_TERM_DRIVE };
  _Alignas(64) double pull[STRUT_PULL_NUMBERS];
  int32_t begin = b * STRUT_BLOCK;
  int32_t end = begin + STRUT_BLOCK < t->slots ? begin + STRUT_BLOCK : t->slots;
#define STRUT_CASE(set)                                                                            \
  case set: members_block(t, state, q, v, pull, begin, end, set, balance, powers); break
  switch (t->block_terms[b] & (K | S | D)) {
    STRUT_CASE(0);
    STRUT_CASE(K);
    STRUT_CASE(S);
    STRUT_CASE(K | S);
    STRUT_CASE(D);
    STRUT_CASE(D | K);
    STRUT_CASE(D | S);
    STRUT_CASE(D | K | S);
  }
#undef STRUT_CASE
  members_add_rows(&t->rows[b], pull, force);
}

STRUT_INLINE void members_add_powers(four_member_powers *sum, const four_member_powers *part) {
  sum->drive += part->drive, sum->exchanged += part->exchanged, sum->lost += part->lost;
}

/* In forces.c: those of all members, whose powers are added up in parts. */
void strut_many_members_add_forces(const strut_model *model, const strut_state *state,
                                   const double *q, const double *v, double *force,
                                   four_member_powers *powers);

/* Adds the forces of all members. */
STRUT_INLINE void members_kernel(const strut_model *model, const strut_state *state,
                                 const double *restrict q, const double *restrict v,
                                 double *restrict force, bool balance, four_member_powers *powers) {
  const strut_member_table t = model->members;
  if (balance && t.blocks > STRUT_BALANCE_BLOCKS) {
    strut_many_members_add_forces(model, state, q, v, force, powers);
    return;
  }
  for (int32_t b = 0; b < t.blocks; b++)
    members_of_block(&t, state, q, v, force, b, balance, powers);
}
