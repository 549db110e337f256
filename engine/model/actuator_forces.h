/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Actuators that give a force or a moment instead of a rest length or a rest angle.
 *
 * The force acts along the gradient of a strain, the length of a member or the angle of a hinge, beside
 * whatever the member or hinge exerts itself.
 */
#ifndef STRUT_ENGINE_MODEL_ACTUATOR_FORCES_H
#define STRUT_ENGINE_MODEL_ACTUATOR_FORCES_H

#include "engine/model/elements.h"

typedef struct strut_actuator_force {
  strut_strain_kind strain; /* length, path or angle */
  int32_t member, hinge;    /* of the scene; the other one is -1 */
  int32_t signal;
  int32_t first, nodes; /* its nodes: `nodes` entries of the table's `at`, from `first` on */
} strut_actuator_force;

typedef struct strut_actuator_force_table {
  int32_t count;
  const strut_actuator_force *item; /* (count) in the scene's order */
  const uint32_t *at;               /* where the nodes' x stand in coordinate arrays: 2 * node */
} strut_actuator_force_table;

#endif
