/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Largest stable steps of the explicit methods for one damped mode, z^2 + d z + k = 0. */
#pragma once

#include "engine/forces/tangent.h"
#include "engine/integrate/integrator.h"

/** Largest h with |R(h lambda)| <= 1 for RK4's R and lambda = re + i im, re <= 0; INFINITY at 0. */
STRUT_API double strut_rk4_limit(double re, double im);

/** Velocity Verlet with forces at the predicted velocity v + h a; k [1/s^2], d [1/s]. 2/omega without damping. */
STRUT_API double strut_verlet_limit(double k, double d);

/**
 * Data of a region that the monitor of the step limit uses. A step h is stable where no motion's
 * quotient of h^2 stiff K + h damp D exceeds 1, for each of the sets.
 */
typedef struct strut_region_data {
  int sets; /* 0: every step is stable */
  struct {
    double stiff, damp;
  } set[2];
  double growth;      /* at a ratio 1 + e of the limit motions grow by e times this per step, in
                         logarithms, at least */
  bool by_eigenvalue; /* the limit takes eigenvalues of the damped problem; else K and D suffice */
} strut_region_data;
const strut_region_data *strut_region_at(strut_region region);

/* How large a step may be: the spectrum of small motions against a method's region of stability. */

typedef struct strut_step_limit {
  double largest_frequency; /* undamped, all contacts closed [rad/s]; 0 where nothing vibrates */
  double limit;             /* largest stable RK4 step [s]; INFINITY where nothing limits it */
  double of[STRUT_REGIONS]; /* largest stable step of each region, RK4's being `limit` */
  double of_implicit[STRUT_REGIONS]; /* where the ground's dampers are implicit */
  bool exact; /* from all eigenvalues; else from those that bind, within 1 % */
} strut_step_limit;

/**
 * Limits at the model's start with every contact closed, its stiffness and damping counted. Up to
 * STRUT_EXACT_LIMIT free coordinates all eigenvalues of the damped system are computed (GSL); above,
 * those that bind, from a space of motions that grows until they have settled: within 1 %, whatever
 * the damping. The model must have a mass.
 */
STRUT_API strut_status strut_step_limit_estimate(const strut_model *model, strut_step_limit *limit,
                                                 strut_error *error);

/** The same at positions q and rest lengths `rest`, with those contacts; of_implicit is as `of`. */
STRUT_API strut_status strut_step_limit_at_shape(const strut_model *model, const double *positions,
                                                 const double *rest, strut_closed closed,
                                                 strut_step_limit *limit, strut_error *error);

/** The largest stable step of one method alone [s], for less work than all of them are. */
STRUT_API strut_status strut_step_limit_for_method(const strut_model *model,
                                                   const strut_integrator *method, double *limit,
                                                   strut_error *error);

/**
 * STRUT_STEP_TOO_LARGE with the reason where a method that controls its error would take more than 1e9 steps in
 * each step dt [s] of the grid, as it follows the fastest vibration: such a run does not end.
 */
STRUT_API strut_status strut_step_limit_check_effort(const strut_model *model,
                                                     const strut_integrator *method, double dt,
                                                     strut_error *error);

/** The largest stable step of a method [s]. */
STRUT_API double strut_step_limit_of_method(const strut_step_limit *limit,
                                            const strut_integrator *method);

enum { STRUT_EXACT_LIMIT = 60 };

/* Size of a model and its step limits. */

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
  bool step_limit_exact;    /* from all eigenvalues; else within 1 % */
} strut_cost_estimate;

/** Estimates the cost of a compiled model. */
STRUT_API strut_status strut_cost_estimate_describe(const strut_model *model,
                                                    strut_cost_estimate *estimate,
                                                    strut_error *error);
