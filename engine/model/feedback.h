/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Compiled feedback: where sensors find their values. A model without sensors has none of it.
 */
#ifndef STRUT_ENGINE_MODEL_FEEDBACK_H
#define STRUT_ENGINE_MODEL_FEEDBACK_H

#include "engine/scene/scene.h"

typedef struct strut_sensor_entry {
  strut_sensor_kind kind;
  int32_t
      at; /* member, element of a hinge, contact (-1: none), coordinate, or strut_sensed_energy */
} strut_sensor_entry;

typedef struct strut_feedback_table {
  int32_t count;
  const strut_sensor_entry *sensor; /* (count) */
  bool needs_drives;                /* some sensor's value follows from the driven rest lengths */
} strut_feedback_table;

#endif
