/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * All eigenvalues and eigenvectors of a small Hessian, the soft ones to their own last digits.
 *
 * A dense solver leaves every eigenvalue with the rounding error of the largest: beside bars of
 * 1e12 N/m nothing is left of a spring of 1 N/m. The soft ones are therefore found again in the
 * space of their eigenvectors, from stretches summed member by member (Rayleigh-Ritz), which loses
 * nothing.
 */
#ifndef STRUT_ENGINE_STATICS_SPECTRUM_H
#define STRUT_ENGINE_STATICS_SPECTRUM_H

#include "engine/statics/potential.h"

typedef struct strut_spectrum {
  int32_t n;
  double *value;  /* (n) ascending [N/m] */
  double *vector; /* (n, n) the unit vector of value i in row i */
  double *noise;  /* (n) what rounding may have done to the value, positions' last bits included */
} strut_spectrum;

/** Memory for computations with n free coordinates; for one thread at a time. */
typedef struct strut_spectrum_workspace strut_spectrum_workspace;
/** NULL: out of memory. */
strut_spectrum_workspace *strut_spectrum_create(const strut_potential *potential);
void strut_spectrum_free(strut_spectrum_workspace *room);

/**
 * The spectrum of strut_potential_hessian_above(q, least), valid until the next call. `careful`:
 * noise is estimated mode by mode and soft modes are always refined; else only where the dense
 * solver's error could matter, with one noise for all. False if the Hessian is not finite.
 */
bool strut_spectrum_compute(strut_spectrum_workspace *room, const double *q, double least,
                            bool careful, strut_spectrum *spectrum);

#endif
