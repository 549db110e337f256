/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Measures over the window: mean velocity (14) and its spread, contact duty and height. */
#pragma once

#include "engine/forces/forces.h"
#include "engine/model/state.h"
#include "engine/run/measure/meter.h"
#include "engine/run/measure/quantities.h"
#include "engine/run/measure/summary.h"

/* ---- energy balance of a run: stored energies, works, losses and residual ---- */

/**
 * Fills the balance from the stored energies at the start and now, at time t [s], and the works that
 * the state has accumulated.
 */
void strut_balance_fill(const strut_model *model, const strut_state *state,
                        const strut_energies *begin, double t, strut_energy *energy);

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
  double rubbed;                 /* the most that friction had given by some sample [J] */
  double crept;                  /* sum over samples: mean slip of feet within their bands [m/s] */
  double speed;                  /* likewise: mean speed of nodes [m/s] */
  strut_loss giver;              /* the loss that gave energy first, by more than errors explain */
  double given;                  /* how much it gave by the latest sample [J]; 0: none */
} strut_balance_monitor;

/** Starts the monitor; evaluations: of the forces per step. Without an energy balance it never samples. */
void strut_balance_begin(const strut_state *state, const strut_energies *begin, double t,
                         int evaluations, strut_balance_monitor *monitor);
/**
 * Samples at time t [s]. Fills the energy too, whose `moved` is at least the largest kinetic
 * energy.
 */
void strut_balance_sample(const strut_model *model, const strut_state *state,
                          const strut_energies *begin, double t, strut_balance_monitor *monitor,
                          strut_energy *energy);

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

/* ---- measures over the window: mean velocity (14) and its spread, contact duty and height ---- */

/**
 * The window is cut at marks: its ends and, in a run by periods, every period between. The tracked
 * point's x at a mark is found by cubic Hermite interpolation within the step around it, so that
 * periods that the step does not divide are measured exactly.
 */
typedef struct strut_measurement {
  strut_time_grid grid;
  int32_t node;          /* tracked node, or -1: centre of mass */
  double total_mass;     /* [kg] */
  bool by_periods;       /* the run is given in drive periods */
  size_t marks, next;    /* number of marks; the next one to pass */
  size_t capacity;       /* capacity for marks */
  double *time;          /* (marks) [s] */
  double *x;             /* (marks) tracked x there [m] */
  double last_x, last_v; /* tracked point after the latest step */
  int64_t window_steps;
  int64_t *contact_steps; /* (contacts) steps of the window that ended in contact */
  double *max_height;     /* (contacts) [m] */
  double *last_gap,
      *gap_before; /* (contacts) after the latest step, and after the one before it [m] */
  double
      apart; /* largest velocity of a node from the tracked point's, at the start and marks [m/s] */
  double path; /* length of the tracked x's way since the start of the window [m] */
  const strut_run_samples *samples; /* whose times are the marks; NULL: those of the experiment */
  strut_quantities *quantities;     /* NULL where the scene names none */
  strut_arena arena;
  double *work;     /* (marks) work of the drives there [J] */
  double last_work; /* and after the latest step [J] */
  double weight;    /* of the structure [N] */
  bool balance;     /* works are known */
} strut_measurement;

/**
 * Prepares for a run that starts at the time `begin`, without the offset of the grid [s]; capacity:
 * marks that a later window may need. Of the measurement, its grid and samples are the caller's. STRUT_OK or
 * STRUT_NO_MEMORY.
 */
strut_status strut_measure_create(const strut_model *model, const strut_experiment *experiment,
                                  double begin, size_t capacity, strut_measurement *measure);
/** x [m] and velocity [m/s] of the tracked point. */
void strut_measure_tracked_point(const strut_model *model, const strut_state *state,
                                 const strut_measurement *measure, double *place, double *velocity);
/** Starts another window at `begin` [s] over `periods`, within the capacity for marks. */
void strut_measure_window(const strut_model *model, strut_state *state, double begin, double period,
                          size_t periods, strut_measurement *measure);
/** First step number after which strut_measure_step must be called for every step. */
int64_t strut_measure_first_step(const strut_measurement *measure);
/** Samples the tracked point and the quantities before the first measured step. */
void strut_measure_begin(const strut_model *model, strut_state *state, strut_measurement *measure);
/** Measures after each step from then on. Allocates nothing. */
void strut_measure_step(const strut_model *model, strut_state *state, strut_measurement *measure);
/** Fills velocity, quantities, spread, window and contacts of the summary from the marks passed so far. */
void strut_measure_finish(const strut_measurement *measure, strut_summary *summary);
/** Is the mean velocity of a finished window only rounding, as of a symmetric motion? */
bool strut_measure_is_zero(const strut_measurement *measure, const strut_summary *summary);
void strut_measure_free(strut_measurement *measure);
