/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Energy balance of a run: stored energies, works, losses and residual. */
#ifndef STRUT_ENGINE_RUN_MEASURE_BALANCE_H
#define STRUT_ENGINE_RUN_MEASURE_BALANCE_H

#include "engine/forces/energy.h"
#include "engine/run/measure/summary.h"

/**
 * Fills the balance from the stored energies at the start and now, at time t [s], and the ledger of
 * the state.
 */
void strut_balance_fill(const strut_model *model, strut_state *state, const strut_energies *begin,
                        double t, strut_energy *energy);

/** What takes energy out of a run, and never gives any. */
typedef enum strut_loss {
  STRUT_LOSS_MEMBERS,
  STRUT_LOSS_CONTACT,
  STRUT_LOSS_FRICTION,
  STRUT_LOSS_COUNT
} strut_loss;

/**
 * Samples the balance during a run: the largest kinetic energy, when the balance opened most, and whether a
 * loss gave energy. The steps of the samples depend on the run alone, not on its recording.
 */
typedef struct strut_balance_monitor {
  int64_t every, next;   /* steps between samples; step of the next one, INT64_MAX: none */
  double swing;          /* the largest kinetic energy seen [J] */
  double residual, time; /* at the latest sample [J], [s] */
  double worst;          /* largest change of the residual between two samples, with its sign [J] */
  double from, to;       /* its interval [s] */
  double lost[STRUT_LOSS_COUNT]; /* at the latest sample [J] */
  double creep;                  /* what friction may have given within its bands by then [J] */
  strut_loss giver;              /* the loss that gave energy first, by more than errors explain */
  double given;                  /* how much it gave by the latest sample [J]; 0: none */
} strut_balance_monitor;

/** Starts the monitor; evaluations: of the forces per step. Without a ledger it never samples. */
void strut_balance_begin(const strut_state *state, const strut_energies *begin, double t,
                         int evaluations, strut_balance_monitor *monitor);
/**
 * Samples at time t [s]. Fills the energy too, whose `moved` is at least the largest kinetic
 * energy.
 */
void strut_balance_sample(const strut_model *model, strut_state *state, const strut_energies *begin,
                          double t, strut_balance_monitor *monitor, strut_energy *energy);

/**
 * Makes the balance of a run continue that of the one before, whose state may have been corrected in
 * between: works and losses go on from there, and what the correction added to the stored energies
 * `begin` counts as initial.
 */
void strut_balance_continue(const strut_energy *before, strut_state *state, strut_energies *begin);

/** What to say of an open balance where method and step were chosen for a wanted accuracy. */
#define STRUT_BALANCE_CHOSEN                                                                       \
  "; the wanted accuracy applies to the measured quantities only: also measure energy.total, or "  \
  "request a higher accuracy"
/** Warns of the balance of a summary where that is open, with cause and remedy; else of nothing. */
void strut_balance_warn(strut_summary *summary, const char *why);

/** Open where more than 1 % of the exchanged energy is missing, and more than rounding explains. */
strut_balance strut_balance_judge(const strut_energy *energy, int64_t steps);

#endif
