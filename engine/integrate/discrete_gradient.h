/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Forces averaged over a step between two shapes, such that they do the work that energies change by.
 *
 * With stretches s0 and s1 of a member at the begin and the end of a step h its tension is what (1)
 * and (2) give on average while the stretch goes evenly from one to the other: c (s0 + s1) / 2 +
 * k (s1 - s0) / h, and of a cable the parts where it is taut. It acts along the sum of the member's
 * vectors at both ends, over the sum of its lengths. So the elastic energy changes by exactly what
 * springs do, dampers take what they should, and the moment about any point is balanced (Simo, Tarnow
 * and Wong, Comput. Methods Appl. Mech. Eng. 100, 1992; Gonzalez, J. Nonlinear Sci. 6, 1996).
 * A rest length that jumps changes a spring at once and gives a damper no blow, as everywhere else.
 * Ground and rigid bars are not in it.
 */
#pragma once

#include "engine/model/state.h"

/** A step, and what its members do: (count) arrays in member order. */
typedef struct strut_discrete_gradient {
  double begin, h;   /* [s] */
  double *length0;   /* at its begin [m] */
  double *rest0;     /* (slots) rest lengths there [m] */
  double *rest_rate; /* (slots) at the middle of the step [m/s] */
  double *sum[2];    /* x and y of the member's vectors at both ends, added [m] */
  double *lengths;   /* lengths at both ends, added [m] */
  double *tension;   /* on average [N] */
  double *slope;     /* d tension / d length at the end [N/m] */
  double *middle; /* (length) positions half-way, where the gradients of elements are taken [m] */
  double *strain0, *energy0; /* (elements) strains and energies [J] at the begin */
  double *element_slope;     /* (elements) d force / d strain at the end, not below 0 */
  double *end_velocity;      /* (length) with feedback: 2 u - v0 [m/s] */
} strut_discrete_gradient;

/** Arrays in the state's arena. False: out of memory. */
bool strut_discrete_gradient_create(const strut_model *model, strut_state *state,
                                    strut_discrete_gradient *step);
/** Sets the step off at positions q (length), and rest lengths to those at its end. */
void strut_discrete_gradient_begin(const strut_model *model, const strut_state *state,
                                   const double *positions, double begin, double h,
                                   strut_discrete_gradient *step);
/**
 * Net forces on the nodes over the step that ends at q1 with velocity u on average, (length) both,
 * into state->latest->force; with the energy balance powers, which times h are the works. Loads are taken at the
 * middle of the step. Counts as an evaluation.
 */
void strut_discrete_gradient_forces(const strut_model *model, const strut_state *state,
                                    strut_discrete_gradient *step, const double *q1,
                                    const double *u);
/** Tensions as (1) gives them at the state's q, with its rest lengths, into `tension` (count). */
void strut_discrete_gradient_tensions(const strut_model *model, const strut_state *state,
                                      double *tension);
