/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Supported coordinates that a signal moves: position + signal(t).
 *
 * They stay out of the mass matrix that is factored. With the consistent mass their acceleration a_c
 * pushes free neighbours by -M_fc a_c; the entries of M_fc are the couplings.
 */
#ifndef STRUT_ENGINE_MODEL_SUPPORT_MOTION_H
#define STRUT_ENGINE_MODEL_SUPPORT_MOTION_H

#include <stdbool.h>
#include <stdint.h>

typedef struct strut_moved_coordinate {
  int32_t at;     /* index in coordinate arrays */
  int32_t signal; /* of the scene */
  double base;    /* position where the signal is 0 [m] */
} strut_moved_coordinate;

/** An entry of the mass matrix between a moved coordinate and a free one. */
typedef struct strut_support_coupling {
  int32_t item; /* moved coordinate */
  int32_t at;   /* index of the free one in coordinate arrays */
  double mass;  /* [kg] */
} strut_support_coupling;

typedef struct strut_support_motion_table {
  int32_t count, coupling_count;
  const strut_moved_coordinate *item;     /* (count) in the scene's order */
  const strut_support_coupling *coupling; /* (coupling_count) */
  bool corners; /* some coupled coordinate has a signal whose rate jumps */
} strut_support_motion_table;

#endif
