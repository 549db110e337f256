/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Dynamic relaxation on the real ground: where (10) without drive and friction comes to rest.
 *
 * The model itself is simulated, with no damping but its own, until it can end in one place only;
 * Newton's method then converges to it. The result is that of the undamped model, at less cost.
 */
#ifndef STRUT_ENGINE_STATICS_EQUILIBRIA_RELAX_H
#define STRUT_ENGINE_STATICS_EQUILIBRIA_RELAX_H

#include <signal.h>

#include "engine/statics/minimise.h"

/**
 * Potential energy of the lowest known pass out of the basin of the minimum q [J]; -INFINITY if
 * none is known: then the end is known only when the motion has died down.
 */
typedef double (*strut_pass_of)(const void *context, const double *q);

typedef enum strut_relaxed_end {
  STRUT_RELAXED_RESTS,
  STRUT_RELAXED_LEAVES, /* moves off without end: falls, slides, is lifted */
  STRUT_RELAXED_MOVES   /* still moves after the experiment's settle.limit, or 1e7 steps */
} strut_relaxed_end;

typedef struct strut_relaxed {
  strut_relaxed_end end;
  bool simulated;      /* false: below the pass from the start, or without a motion */
  double time;         /* simulated [s] */
  double residual;     /* largest net force at rest [N] */
  double acceleration; /* largest there [m/s^2]; 0 for a scene without mass */
} strut_relaxed;

/** Memory of relaxations of one model, for one thread at a time. */
typedef struct strut_relaxer strut_relaxer;
/**
 * potential: of a model without actuators, friction and loads on a signal, its ground included. It
 * must outlive the relaxer. limit: of the time that a relaxation simulates [s]. Simulated are
 * models with mass, some damping and up to STRUT_DENSE_STATICS free coordinates; others go downhill
 * from where they are.
 */
strut_status strut_relaxer_create(const strut_potential *potential, double limit,
                                  strut_relaxer **relaxer, strut_error *error);
void strut_relaxer_free(strut_relaxer *relaxer);

/** True if the model can be simulated. */
bool strut_relaxer_simulates(const strut_relaxer *relaxer);

/** Minimises from q (length) as strut_minimise does. */
strut_descent strut_relaxer_quench(strut_relaxer *relaxer, double *q);

/** Minimises without simulation, for a q with one possible end; reports as strut_relax does. */
void strut_relax_down(strut_relaxer *relaxer, double *q, strut_relaxed *relaxed);

/**
 * Lets go of q (length) with no velocity; at the end it is the shape at rest, its centre of mass
 * where the motion has left it along the ground. passes may be NULL. STRUT_OK or STRUT_INTERRUPTED.
 */
strut_status strut_relax(strut_relaxer *relaxer, double *q, strut_pass_of passes,
                         const void *context, const volatile sig_atomic_t *interrupt,
                         strut_relaxed *relaxed, strut_error *error);

#endif
