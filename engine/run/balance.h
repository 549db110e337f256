/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The energy balance of a run: what was there, what came in, what was lost, and what does not add up.
 */
#ifndef STRUT_ENGINE_RUN_BALANCE_H
#define STRUT_ENGINE_RUN_BALANCE_H

#include "engine/forces/energy.h"
#include "engine/run/summary.h"

/** From the stored energies at the begin and now, at time t [s], and the state's ledger. */
void strut_balance_fill(const strut_model *model, strut_state *state, const strut_stored *begin,
                        double t, strut_energy *energy);

#endif
