/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Size of a model and its step limits. */
#ifndef STRUT_ENGINE_RUN_COST_ESTIMATE_H
#define STRUT_ENGINE_RUN_COST_ESTIMATE_H

#include "engine/integrate/limit/step_limit.h"

typedef struct strut_cost_estimate {
  struct {
    size_t nodes, degrees_of_freedom, bars, springs, cables, contacts, actuators, loads;
    size_t hinges, running_cables, laws, stops; /* laws: members with another law than the linear */
    size_t cells, collisions;
  } count;
  struct {
    size_t mass_nonzeros;   /* stored entries of M (lower triangle, each coordinate that differs) */
    size_t factor_nonzeros; /* entries of its sparse factor; 0 without one */
    size_t dense_entries;   /* of dense block inverses */
  } matrix;
  size_t bytes;             /* of the compiled model */
  bool feedback;            /* signals follow sensors, which frequency and step limits leave out */
  bool runnable;            /* every free coordinate has mass; otherwise the fields below are 0 */
  double largest_frequency; /* undamped, all contacts closed [rad/s] */
  double step_limit;        /* largest stable RK4 step, contact stiffness and damping counted [s] */
  strut_step_limit limits;  /* of every method: strut_step_limit_of_method */
  bool step_limit_exact;    /* from all eigenvalues; else within 1 %, or limits.bound */
} strut_cost_estimate;

/** Estimates the cost of a compiled model. */
STRUT_API strut_status strut_cost_estimate_describe(const strut_model *model,
                                                    strut_cost_estimate *estimate,
                                                    strut_error *error);

#endif
