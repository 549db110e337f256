/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Point masses on the straight line between the two nodes of a member.
 *
 * A mass m at the share s of the line is at x = N q with N = (1 - s, s) at the member's two nodes, alike in
 * x and y. One at rest on its member adds m N'N to the mass matrix, which is factored with it. One that moves
 * stays out of that matrix M: its nodes answer through columns of M^-1 kept here, see
 * engine/forces/drives/moving_masses.h.
 */
#ifndef STRUT_ENGINE_MODEL_SLIDING_MASSES_H
#define STRUT_ENGINE_MODEL_SLIDING_MASSES_H

#include <stdbool.h>
#include <stdint.h>

#include "engine/base/status.h"

struct strut_model;

/** How nodes answer to unit forces on the two nodes of a member, cut where it is negligible. */
typedef struct strut_sliding_answer {
  int32_t count;
  const uint32_t *at; /* (count) 2 * node */
  const double *xy;   /* (count, 4) x, y by the first node, x, y by the second [1/kg] */
} strut_sliding_answer;

typedef struct strut_sliding_item {
  int32_t member; /* of the scene */
  uint32_t at[2]; /* 2 * node of the member's two nodes */
  double mass;    /* [kg] */
  double start;   /* share at t = 0 */
  double base;    /* share where the signal is 0 */
  double scale;   /* share per unit of the signal */
  int32_t signal; /* of the scene; -1: at rest */
} strut_sliding_item;

/** A moving mass at one instant. */
typedef struct strut_sliding_motion {
  double share, rate, bend; /* of its member's line [1], and its derivatives [1/s], [1/s^2] */
  double jump;              /* of the rate, while an impulse is found */
} strut_sliding_motion;

typedef struct strut_sliding_table {
  int32_t count, moving_count;
  const strut_sliding_item *item;     /* (count) in the scene's order */
  const int32_t *moving;              /* (moving_count) those that move */
  const strut_sliding_answer *answer; /* (moving_count) */
  /* (2, 2 moving_count, 2 moving_count) of x, then y: entries of M^-1 between the members' nodes [1/kg] */
  const double *between;
  bool corners;       /* some signal's rate jumps */
  bool massless_node; /* some free node has no mass but that of sliding masses */
} strut_sliding_table;

/** Mass moment beyond that of the weights at time t [s], sum of m x, of one coordinate at positions q [kg m]. */
STRUT_API double strut_sliding_moment(const struct strut_model *model, double t, int axis,
                                      const double *positions);

#endif
