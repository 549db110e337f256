/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Steps of a run whose model is stored in another order than the scene's (engine/model/renumber.h), with the
 * same bits of positions, velocities and contact forces. The ledger sums powers of members in the order in which
 * they are stored: its works differ in rounding.
 */
#ifndef STRUT_ENGINE_INTEGRATE_RENUMBERED_H
#define STRUT_ENGINE_INTEGRATE_RENUMBERED_H

#include "engine/integrate/integrator.h"

typedef struct strut_renumbered strut_renumbered;

/** *renumbered is NULL where another order does not pay. STRUT_OK or STRUT_NO_MEMORY. */
STRUT_API strut_status strut_renumbered_create(const strut_model *model,
                                               const strut_integrator *method,
                                               const strut_integrator_settings *settings,
                                               strut_renumbered **renumbered, strut_error *error);
/** NULL is allowed. */
STRUT_API void strut_renumbered_free(strut_renumbered *renumbered);
/** As the method's restart: whenever someone else has changed the state, and before the first step. */
STRUT_API void strut_renumbered_restart(strut_renumbered *renumbered, strut_state *state,
                                        double dt);
/** As strut_integrator_advance. */
STRUT_API void strut_renumbered_advance(strut_renumbered *renumbered, strut_state *state, double dt,
                                        int64_t count);

#endif
