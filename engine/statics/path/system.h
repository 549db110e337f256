/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The equations of a path: equilibrium for a parameter, with what is taut and touching held fixed.
 *
 * Unknown is y: the free coordinates in units of the structure's size, then the parameter from
 * `from` in units of its range; n + 1 numbers, followed by n + 1 that are added to them for the
 * digits that a double does not have. A bar of 1e11 N/m turns the last bit of a metre into 1e-5 N.
 */
#ifndef STRUT_ENGINE_STATICS_PATH_SYSTEM_H
#define STRUT_ENGINE_STATICS_PATH_SYSTEM_H

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_permutation.h>

#include "engine/statics/path/parameter.h"
#include "engine/statics/path/path_elements.h"
#include "engine/statics/potential.h"

enum { STRUT_PATH_MOTIONS = 3 };

/** A member as it lies, to all digits. */
typedef struct strut_path_member {
  double length, tension, ux, uy; /* [m], [N], direction from its first node to the second */
  double across;                  /* stiffness across its direction: tension / length [N/m] */
  bool pulls;                     /* or pushes */
} strut_path_member;

typedef struct strut_path_system {
  const strut_model *model;
  strut_potential *potential; /* for the numbers of its free coordinates */
  int32_t n;
  bool drifts; /* the parameter works on a motion of the whole that meets no stiffness */
  double size; /* [m] */
  strut_path_parameter parameter;
  strut_path_terms terms, rates; /* at terms_at; about rates_at */
  strut_dd terms_at;
  double rates_at;
  bool has_terms, has_rates;
  uint8_t *pulling, *touching; /* (members), (contacts) 1 where forces act, of whatever sign */
  double *q, *q_low, *g, *slope, *row; /* (length), (length), (n), (n) dg/dy_n, (n + 1) scratch */
  strut_path_member *member;           /* (members) */
  strut_path_elements elements;
  double forces;      /* the largest force at the last place: what g is compared with [N] */
  int32_t held_count; /* motions of the whole that were given a stiffness `held_by` */
  double held_by, *held[STRUT_PATH_MOTIONS]; /* (n) each */
  gsl_matrix *hessian, *work;                /* (n, n) */
  gsl_matrix *bordered;                      /* (n + 1, n + 1) */
  gsl_vector *right, *solution, *values;
  gsl_matrix *vectors;
  gsl_permutation *order;
  gsl_eigen_symm_workspace *values_only;
  gsl_eigen_symmv_workspace *eigen;
  int32_t negative;  /* eigenvalues below zero, after strut_path_spectrum */
  double noise;      /* rounding of the stiffness's entries [N/m], likewise */
  double soft_parts; /* the largest part that an element has in a soft eigenvalue [N/m] */
  strut_arena arena;
} strut_path_system;

/**
 * `held` (length) or NULL: coordinates held besides the supports. The caller creates the parameter
 * in system->parameter before any other call; the system's address must not change. Free it after a
 * failure too.
 */
strut_status strut_path_system_create(const strut_model *model, const uint8_t *held,
                                      strut_path_system *system, strut_error *error);
void strut_path_system_free(strut_path_system *system);

/** y (2 n + 2) from positions of the free coordinates, at the parameter's start. */
void strut_path_unplace(const strut_path_system *system, const double *q, double *y);
/** The parameter's value at y. */
double strut_path_value(const strut_path_system *system, const double *y);

/** Everything at y, which need be no equilibrium; false: no scene has this value. */
bool strut_path_evaluate(strut_path_system *system, const double *y);
/** After strut_path_evaluate: reactions (length) and normal forces of contacts. */
void strut_path_reactions(const strut_path_system *system, double *reaction, double *contact);

/**
 * Newton's method to equilibrium on the plane row . y = value. Iterations used, or -1: it does not
 * converge.
 */
int strut_path_correct(strut_path_system *system, const double *row, double value, double *y);

/** The unit tangent with row . tangent > 0; false if the system is singular. */
bool strut_path_tangent(strut_path_system *system, const double *y, const double *row,
                        double *tangent);

/** Detail of the stiffness's spectrum: each level costs several times the previous one. */
typedef enum strut_path_spectrum_detail {
  STRUT_PATH_SIGNS,  /* of eigenvalues: how many are negative */
  STRUT_PATH_VALUES, /* with all digits near zero too, not only to those of the largest */
  STRUT_PATH_VECTORS /* and eigenvectors */
} strut_path_spectrum_detail;

/**
 * Eigenvalues of the stiffness, ascending, into system->values, vectors into system->vectors, the
 * number of negative ones into system->negative. False: no scene has this value.
 */
bool strut_path_spectrum(strut_path_system *system, const double *y,
                         strut_path_spectrum_detail wanted);

/** Cables first, then contacts, then elements: what may change along the path. */
int32_t strut_path_switch_count(const strut_path_system *system);
/** Index of the first switch of elements. */
int32_t strut_path_first_element_switch(const strut_path_system *system);
/**
 * Above 0 where it ought to be on (pulls, touches) [m], NAN where no scene has this value;
 * -INFINITY for what never changes: members that are no cables, kinks where an element does not act.
 */
double strut_path_switch_value(strut_path_system *system, int32_t which, const double *y);
bool strut_path_switch_is_on(const strut_path_system *system, int32_t which);
void strut_path_switch_set(strut_path_system *system, int32_t which, bool on);

#endif
