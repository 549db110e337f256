/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The energy balance of a run: what was there, what came in, what was lost, and what does not add up.
 */
#ifndef STRUT_ENGINE_RUN_MEASURE_BALANCE_H
#define STRUT_ENGINE_RUN_MEASURE_BALANCE_H

#include "engine/forces/energy.h"
#include "engine/run/measure/summary.h"

/** From the stored energies at the begin and now, at time t [s], and the state's ledger. */
void strut_balance_fill(const strut_model *model, strut_state *state, const strut_energies *begin,
                        double t, strut_energy *energy);

/**
 * Looks at the balance while a run goes on: how much kinetic energy there was at most, and when the
 * balance opened most. At steps that depend on the run alone, not on who records it.
 */
typedef struct strut_balance_monitor {
  int64_t every, next;   /* steps between looks; the step of the next one, INT64_MAX: none */
  double swing;          /* the largest kinetic energy seen [J] */
  double residual, time; /* at the latest look [J], [s] */
  double worst;    /* the largest change of the residual between two looks [J], with its sign */
  double from, to; /* when that was [s] */
} strut_balance_monitor;

/** evaluations: of the forces per step. `watch` is zero where no ledger is kept. */
void strut_balance_begin(const strut_state *state, const strut_energies *begin, double t,
                         int evaluations, strut_balance_monitor *watch);
/** Now, at time t [s]. Fills the energy as well, whose `moved` is no less than the largest kinetic. */
void strut_balance_sample(const strut_model *model, strut_state *state, const strut_energies *begin,
                          double t, strut_balance_monitor *watch, strut_energy *energy);

/** Open where more than 1 % of the energy moved is missing, and more than rounding explains. */
strut_balance strut_balance_judge(const strut_energy *energy, int64_t steps);

#endif
