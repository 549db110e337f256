/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the law of a member, equations (1), (2) and (6), once for all kernels.
 *
 * A kernel defines it for a vector type of its own: members_kernel.h for several members of one run,
 * lane_kernel.h for one member of several runs. What no member of a block needs (dampers, slack, drive)
 * is compiled out, and so are the values that only that asks for.
 */
#ifndef STRUT_ENGINE_FORCES_MEMBER_LAW_H
#define STRUT_ENGINE_FORCES_MEMBER_LAW_H

#include <stdbool.h>

#include "engine/model/model.h"

/** The ledger adds up the powers of so many blocks of members, and then these sums: threads share the work. */
enum { STRUT_LEDGER_BLOCKS = 16 };

/**
 * Defines PREFIX_values, what the law asks of members; PREFIX_powers, sums of what actuators and
 * dampers do [W]; PREFIX_law, the members' tensions [N], cables never below 0; and PREFIX_tension, the same
 * with the powers added up.
 */
#define STRUT_DEFINE_MEMBER_LAW(inlined, number, mask, PREFIX)                                     \
  typedef struct PREFIX##_values {                                                                 \
    number length, rate; /* of the whole member [m], [m/s] */                                      \
    number rest, rest_rate, stiffness, damping, slack_length_threshold, slack_force_threshold;     \
  } PREFIX##_values;                                                                               \
  typedef struct PREFIX##_powers {                                                                 \
    number drive, exchanged, lost;                                                                 \
  } PREFIX##_powers;                                                                               \
                                                                                                   \
  /* The tension; *damper: what it has beyond its elastic part, where the member acts. */          \
  inlined number PREFIX##_law(const PREFIX##_values *m, unsigned terms, bool ledger,               \
                              number *damper) {                                                    \
    bool driven = terms & STRUT_TERM_DRIVE;                                                        \
    number stretch = m->length - m->rest, elastic = m->stiffness * stretch;                        \
    number tension = elastic, own_rate = driven ? m->rate - m->rest_rate : m->rate;                \
    *damper = m->damping * own_rate;                                                               \
    if (terms & STRUT_TERM_DAMPING) tension = elastic + *damper;                                   \
    if (terms & STRUT_TERM_SLACK) {                                                                \
      mask taut = stretch > m->slack_length_threshold;                                             \
      mask pulling = taut & (tension > m->slack_force_threshold);                                  \
      tension = (number)(pulling & (mask)tension);                                                 \
      mask loose = taut & ~pulling & (mask)-elastic;                                               \
      if (ledger) *damper = (number)((pulling & (mask)*damper) | loose);                           \
    }                                                                                              \
    return tension;                                                                                \
  }                                                                                                \
                                                                                                   \
  inlined number PREFIX##_tension(const PREFIX##_values *m, unsigned terms, bool ledger,           \
                                  PREFIX##_powers *powers) {                                       \
    bool driven = terms & STRUT_TERM_DRIVE;                                                        \
    number damper, tension = PREFIX##_law(m, terms, ledger, &damper);                              \
    number own_rate = driven ? m->rate - m->rest_rate : m->rate;                                   \
    if (ledger && driven) {                                                                        \
      number power = -tension * m->rest_rate;                                                      \
      powers->drive += power;                                                                      \
      powers->exchanged += (number)((mask)power & 0x7fffffffffffffffLL);                           \
    }                                                                                              \
    if (ledger && (terms & STRUT_TERM_DAMPING)) powers->lost += damper * own_rate;                 \
    return tension;                                                                                \
  }

#endif
