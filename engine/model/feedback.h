/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Compiled feedback: where sensors find their values, and internal states. A model without them has none
 * of it.
 *
 * Internal states are integrated beside the motion as auxiliary coordinates of unit mass, which stand
 * behind those of the nodes and that of padding in coordinate arrays: the state is the velocity there,
 * its rate the force. Every method so integrates them at its own order. They count as fixed, so that
 * nobody else takes them for positions.
 */
#ifndef STRUT_ENGINE_MODEL_FEEDBACK_H
#define STRUT_ENGINE_MODEL_FEEDBACK_H

#include "engine/scene/scene.h"

/** Does a column need the driven rest lengths, or where shaken grounds are? */
static inline bool strut_column_needs_drives(strut_column column) {
  return strut_observable_at(column.kind)->need != STRUT_OBSERVED_MOTION;
}

/** The Maxwell branch of a member, whose force is an internal state. */
typedef struct strut_maxwell_entry {
  int32_t member, state;
  double stiffness, damping;
} strut_maxwell_entry;

typedef struct strut_feedback_table {
  int32_t count;
  const strut_column *sensor; /* (count) as strut_column_find finds them */
  bool needs_drives;          /* some sensor's value follows from the driven rest lengths */
  int32_t base, state_count;  /* states stand at base .. base + state_count - 1 of velocities */
  int32_t lag_count;
  const int32_t
      *lagged; /* (lag_count) signals with a lag; their states follow those of the scene */
  const int32_t *lag_of; /* (signals) state of a signal's lag, or -1 */
  int32_t maxwell_count;
  const strut_maxwell_entry *maxwell; /* (maxwell_count); their states follow */
  int32_t bristle_count;              /* bends of bristles, the last states */
  int32_t sampled_count;
  int32_t trigger_count;
  const int32_t *triggered; /* (trigger_count) signals with a trigger */
  const int32_t *sampled;   /* (sampled_count) signals that are sampled, terms before their sums */
  int32_t relay_count;
  const int32_t *relay; /* (relay_count) relays that are not sampled: they switch at any time */
} strut_feedback_table;

/** Does the motion depend on more of the past than positions and velocities hold? */
static inline bool strut_feedback_remembers(const strut_feedback_table *feedback) {
  return feedback->state_count || feedback->sampled_count || feedback->trigger_count ||
         feedback->relay_count;
}

struct strut_model;
/**
 * The column of a scene with the item that its function knows: an element, which is looked for from `near` on, or
 * contacts from `item` up to `other`.
 */
STRUT_API strut_column strut_column_find(const struct strut_model *model, strut_column column,
                                         int32_t near);

#endif
