/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Steps of a run whose structure is large: stored in another order where the scene's is scattered
 * (engine/model/renumber.h), and by several threads where there are any (domain_parts.h). Positions,
 * velocities and contact forces have the same bits as without. In another order, the energy balance sums
 * powers of members as they are stored: its works differ in rounding, but not with the number of threads.
 */
#ifndef STRUT_ENGINE_INTEGRATE_LARGE_STEPS_H
#define STRUT_ENGINE_INTEGRATE_LARGE_STEPS_H

#include "engine/integrate/integrator.h"

typedef struct strut_large_steps strut_large_steps;

/** Threads that a run may use: one within what runs side by side already, else as OpenMP has them. */
STRUT_API int strut_large_threads(void);
/**
 * Steps to take at once between two looks at the state: 1 for small structures. The same for any number of
 * threads.
 */
STRUT_API int64_t strut_large_steps_at_once(const strut_model *model,
                                            const strut_integrator *method);
/** *steps is NULL where the method itself does as well. STRUT_OK or STRUT_NO_MEMORY. */
STRUT_API strut_status strut_large_steps_create(const strut_model *model,
                                                const strut_integrator *method,
                                                const strut_integrator_settings *settings,
                                                int threads, strut_large_steps **steps,
                                                strut_error *error);
/** NULL is allowed. */
STRUT_API void strut_large_steps_free(strut_large_steps *steps);
/** As the method's restart: whenever someone else has changed the state, and before the first step. */
STRUT_API void strut_large_steps_restart(strut_large_steps *steps, strut_state *state, double dt);
/** As strut_integrator_advance. */
STRUT_API void strut_large_steps_advance(strut_large_steps *steps, strut_state *state, double dt,
                                         int64_t count);

#endif
