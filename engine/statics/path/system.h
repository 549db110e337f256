/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The equations of a path: equilibrium for a factor, with what is taut and touching held fixed.
 *
 * Unknown is y (n + 1): the free coordinates in units of the structure's size, then the factor in
 * units of `unit`. For path.c and path_events.c.
 */
#ifndef STRUT_ENGINE_STATICS_PATH_SYSTEM_H
#define STRUT_ENGINE_STATICS_PATH_SYSTEM_H

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_permutation.h>

#include "engine/statics/potential.h"

typedef struct strut_path_system {
  strut_model model;          /* the scene's, but for a slack table of its own: what is taut now */
  strut_potential *potential; /* without the ground, and with `base` + factor `load` as its force */
  int32_t n;
  bool drifts;         /* the load works on a motion of the whole that meets no stiffness */
  double size, unit;   /* [m], [1] */
  double *base, *load; /* (length) forces besides the load, and the load at factor 1 [N] */
  double *slack;       /* (slots) of the model above: -INFINITY pulls, INFINITY does not */
  uint8_t *touching;   /* (contacts) 1 where the ground pushes, and then pulls too */
  double *q, *g, *row; /* (length), (n), (n + 1) scratch */
  strut_sparse *sparse;
  gsl_matrix *hessian;  /* (n, n); NULL without a free coordinate */
  gsl_matrix *bordered; /* (n + 1, n + 1) */
  gsl_vector *right, *solution, *values;
  gsl_matrix *vectors;
  gsl_permutation *order;
  gsl_eigen_symm_workspace *values_only;
  gsl_eigen_symmv_workspace *eigen;
  strut_arena arena;
} strut_path_system;

/**
 * base and load (length): forces that stay, and the load at factor 1 [N]. Of the system in use the
 * address must not change. Free it after a failure too.
 */
strut_status strut_path_system_create(const strut_model *model, const double *base,
                                      const double *load, double unit, strut_path_system *system,
                                      strut_error *error);
void strut_path_system_free(strut_path_system *system);

/** y to positions (length), held ones as at the start; and back. */
void strut_path_place(strut_path_system *system, const double *y, double *q);
void strut_path_unplace(const strut_path_system *system, const double *q, double *y);

/**
 * Newton's method to equilibrium on the plane row . y = value. Iterations used, or -1: it does not
 * converge.
 */
int strut_path_correct(strut_path_system *system, const double *row, double value, double *y);

/** The unit tangent with row . tangent > 0; false where there is none. */
bool strut_path_tangent(strut_path_system *system, const double *y, const double *row,
                        double *tangent);

/** Eigenvalues of the stiffness, ascending, into system->values; `vectors`: system->vectors too. */
void strut_path_spectrum(strut_path_system *system, const double *y, bool vectors);
/** Those below zero, after strut_path_spectrum. */
int32_t strut_path_negative(const strut_path_system *system);

/** Cables first, then contacts: what may change along the path. */
int32_t strut_path_switch_count(const strut_path_system *system);
/** Above 0 where it ought to be on (pulls, touches) [m]; -INFINITY for members that are no cables. */
double strut_path_switch_value(const strut_path_system *system, int32_t which, const double *q);
bool strut_path_switch_is_on(const strut_path_system *system, int32_t which);
void strut_path_switch_set(strut_path_system *system, int32_t which, bool on);

#endif
