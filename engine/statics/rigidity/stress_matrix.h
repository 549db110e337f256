/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The stress matrix of force densities: the stiffness that member forces give to motions without
 * stretch.
 *
 * Omega has the sum of a node's force densities on its diagonal and minus a member's at its two
 * nodes (Connelly and Whiteley 1996). Its form, sum of density * |d2 - d1|^2 over members, is the
 * stiffness that a prestress gives to a mechanism d.
 */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_STRESS_MATRIX_H
#define STRUT_ENGINE_STATICS_RIGIDITY_STRESS_MATRIX_H

#include "engine/statics/rigidity/equilibrium_matrix.h"

/** The bilinear form at motions x and y (rows) of the free coordinates; density (columns) [N/m]. */
STRUT_API double strut_stress_form(const strut_model *model, const strut_equilibrium_matrix *a,
                                   const double *density, const double *x, const double *y);

/**
 * The form on the span of `count` motions (count, rows), as a symmetric (count, count) matrix.
 */
STRUT_API void strut_stress_form_on(const strut_model *model, const strut_equilibrium_matrix *a,
                                    const double *density, const double *motion, int32_t count,
                                    double *form);

typedef struct strut_stress_matrix {
  bool tested;         /* false: too large, or by_elements */
  bool by_elements;    /* running cables or hinges carry a part of the forces: not judged */
  bool supported;      /* the supports carry forces: eigenvalues on the free coordinates instead */
  int32_t count;       /* eigenvalues */
  double *eigenvalues; /* (count) ascending [N/m] */
  int32_t nullity;     /* zero to rounding */
  bool positive;       /* no eigenvalue below zero */
  bool on_conic;       /* an affine motion keeps all lengths: directions on a conic at infinity */
  bool super_stable;
} strut_stress_matrix;

/** Largest number of nodes whose stress matrix is looked at. */
enum { STRUT_DENSE_STRESS = 300 };

/**
 * Super stability (Connelly): the form is positive semidefinite, vanishes on affine motions alone
 * (nullity 3 in the plane), and no affine motion keeps all lengths. That is proven
 * for straight members: not judged where running cables or hinges carry a part. Where supports carry forces of
 * the state, the form on the free coordinates must be positive definite instead. force (columns) is
 * a state of self-stress. STRUT_OK or STRUT_NO_MEMORY; eigenvalues in the arena.
 */
STRUT_API strut_status strut_stress_matrix_judge(const strut_model *model,
                                                 const strut_equilibrium_matrix *a,
                                                 const double *force, strut_arena *arena,
                                                 strut_stress_matrix *stress);

#endif
