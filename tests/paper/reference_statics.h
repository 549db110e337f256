/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The crawler at rest, written straight from Table 1 and equation (13), and slow searches on that
 * energy: shares no code with the engine. Coordinates are x1, y1, ..., x5, y5 [m].
 */
#pragma once

#include <stdbool.h>

enum { STATICS = 10 };

typedef struct statics {
  double ground;      /* stiffness of the ground at every node [N/m]; 0: there is none */
  bool held[STATICS]; /* coordinates that a support holds */
} statics;

/** (13) and the ground's springs [J]. */
double statics_energy(const statics *s, const double q[STATICS]);
/** Its derivative [N], 0 where held. */
void statics_gradient(const statics *s, const double q[STATICS], double g[STATICS]);
/** Minus the net force on every coordinate, held ones too: what a support there exerts [N]. */
void statics_reaction(const statics *s, const double q[STATICS], double r[STATICS]);
/** Downhill to a minimum; false where that did not work out. */
bool statics_descend(const statics *s, double q[STATICS]);
/** Eigenvalues of the Hessian on the free coordinates, ascending; their count. */
int statics_eigenvalues(const statics *s, const double q[STATICS], double value[STATICS],
                        double vector[STATICS][STATICS]);
/** True where the lengths between all pairs of nodes are the same to `within` [m]. */
bool statics_congruent(const double a[STATICS], const double b[STATICS], double within);
