/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The state: all that changes while a model runs. One per run; the model stays constant.
 *
 * Coordinate arrays are (length): x, y of node 0, x, y of node 1, ... Read from top to bottom it is the order
 * in which a force evaluation works.
 */
#pragma once

#include <math.h>

#include "engine/base/flag.h"
#include "engine/model/model.h"

/** Powers that the energy balance integrates beside the motion [W]. Kernels write them by fours. */
typedef enum strut_power {
  STRUT_POWER_DRIVE,     /* actuators, on the structure */
  STRUT_POWER_LOAD,      /* loads that change with time */
  STRUT_POWER_BELT,      /* the ground's own motion, through friction */
  STRUT_POWER_MEMBERS,   /* lost in member dampers, > 0 */
  STRUT_POWER_CONTACT,   /* lost in ground dampers, > 0 */
  STRUT_POWER_FRICTION,  /* lost in friction, > 0 */
  STRUT_POWER_EXCHANGED, /* sum of the absolute values of all others */
  STRUT_POWER_SUPPORT,   /* supports that move, without a part that moving_masses.h tells */
  STRUT_POWER_COUNT,
  STRUT_POWER_ROOM = 8 /* arrays of powers have this size: whole vectors; the rest is 0 */
} strut_power;

/** Adds to one of the powers or works, and to the sum of their absolute values. */
static inline void strut_power_add(double *powers, strut_power kind, double amount) {
  powers[kind] += amount;
  powers[STRUT_POWER_EXCHANGED] += fabs(amount);
}
/** Adds to two of them, whose absolute values are added to each other first. */
static inline void strut_power_add_two(double *powers, strut_power kind, double amount,
                                       strut_power other_kind, double other) {
  powers[kind] += amount;
  powers[other_kind] += other;
  powers[STRUT_POWER_EXCHANGED] += fabs(amount) + fabs(other);
}

/**
 * Powers of the evaluations of a Runge-Kutta step that have one weight [W]; forces_kernel.h adds up the lanes
 * at its end. Of members by place in groups of STRUT_LANES; of contacts by the lane that strut_contact_entry
 * has.
 */
typedef struct strut_power_lanes {
  double drive[STRUT_LANES], lost[STRUT_LANES], driven[STRUT_LANES]; /* driven: magnitudes */
  double minus_damped[STRUT_CONTACT_LANES], minus_rubbed[STRUT_CONTACT_LANES];
  double belt[STRUT_CONTACT_LANES];
  double turnover[STRUT_CONTACT_LANES]; /* magnitudes of the last two */
} strut_power_lanes;

/** Which of two such sums stage k of a step adds to: the first, of weight 1, or the second, of weight 2. */
static inline int32_t strut_weight_side(int k) { return k == 1 || k == 2; }

/** Where an evaluation of the forces leaves its powers. */
typedef enum strut_accumulation {
  STRUT_ACCUMULATE_NOTHING,
  STRUT_ACCUMULATE_POWERS, /* in state->latest->power */
  STRUT_ACCUMULATE_LANES /* those of members and level ground in state->latest->lanes, all others in state->latest->power */
} strut_accumulation;

typedef enum strut_failure {
  STRUT_FAILURE_NONE,
  STRUT_FAILURE_STEP,      /* the step has become too small to matter */
  STRUT_FAILURE_NEWTON,    /* an implicit step has no solution nearby */
  STRUT_FAILURE_RIGID,     /* rigid bars cannot keep their lengths */
  STRUT_FAILURE_INTERRUPT, /* *interrupt was set */
  STRUT_FAILURE_WORK,      /* most_evaluations were made */
  STRUT_FAILURE_IMPLICIT,  /* an implicit step of the whole structure has no solution nearby */
  STRUT_FAILURE_RELAY,     /* a relay that switches takes its own input past the other threshold */
  STRUT_FAILURE_GUIDE      /* a cable is pulled through its guide */
} strut_failure;

/** When a method whose steps may take long gives up. Nothing of it after the reset. */
typedef struct strut_state_limits {
  const strut_flag *interrupt; /* soon after it becomes non-zero; NULL: never */
  int64_t most_evaluations;    /* of the forces: soon after so many; 0: never */
} strut_state_limits;

/** What methods with events freeze between events. */
typedef struct strut_frozen_modes {
  double
      *slack_length_threshold;   /* (slots) a member acts where both are exceeded [m], [N]: 0 for */
  double *slack_force_threshold; /* cables, -INFINITY otherwise */
  int8_t *element_acts;          /* (elements) 1 acts, -1 does not, 0 by strain and force */
  int16_t *element_piece;        /* (elements) the law's smooth piece; -1 by the strain */
  const strut_kinks *kinks;      /* of signals; NULL: by their values */
  const double *held_normal;   /* (contacts) forces [N]; both NULL with other methods, where they */
  const double *held_friction; /* follow from q, v and t alone */
} strut_frozen_modes;

/**
 * What elements remember, see forces/history.h; the slots of `rest` that belong to them follow from it. Only an
 * accepted step writes it: evaluations of the forces, of steps that are tried too, read it.
 */
typedef struct strut_history {
  double *
      turn; /* (elements) angle of hinges at the accepted positions, near which the next is taken [rad] */
  double *plastic; /* (history_count) slip of sliders */
  double
      *broken_at; /* (breakable_count) since when it carries nothing [s]; INFINITY: it does carry */
  double *
      material; /* (history_slots) of the segments of cables with guide friction [m]: see capstan.h */
  int8_t *guide_mode; /* (history_slots) likewise at the slots of these cables */
  int8_t *guide_side; /* (history_slots) the sign of the turning angles, frozen with the modes */
  double *guide_drop; /* (history_slots) what a length of cable loses as it slips [N] */
  double *kept;       /* what strut_history_store stores, as it was at an earlier time */
} strut_history;

/** Steps of exact methods with events, since the reset, in which contacts or laws switch too often to be followed. */
typedef struct strut_forced_steps {
  int64_t count;
  double first; /* when the first of them began, as n * dt [s] */
} strut_forced_steps;

/** What signals remember; arrays are (signals). */
typedef struct strut_signal_states {
  double *started;     /* when those with a trigger started [s]; INFINITY: not yet */
  int8_t *trigger_was; /* did the condition hold when last evaluated? -1: not evaluated yet */
  double *held;        /* of sampled ones the value at the latest sample; NAN before the first */
  int8_t *relay_side;  /* of relays: 1 last above, -1 last below; 0: not yet known */
} strut_signal_states;

/**
 * What the latest evaluation of the forces left, in the order in which it works: first what depends on time alone
 * (strut_drive_apply, strut_loads_apply), then on positions and velocities too (strut_forces).
 */
typedef struct strut_latest {
  double drive_time; /* the time of rest and rest_rate [s]; NAN before the first evaluation */
  double *rest;      /* (slots) rest lengths [m]; equal to the model's where not driven */
  double *rest_rate; /* (slots) [m/s] */
  strut_ground_motion
      *ground_motion;       /* (grounds) that are shaken, at drive_time; NULL where none is */
  strut_contact_pose *pose; /* (contacts) with STRUT_TERM_SURFACES */
  strut_contact_entry
      *grip; /* (contacts) the model's with the friction of drive_time; NULL: that rests */
  double *actuator_force;       /* (actuator forces) [N], [N m] */
  double *sensor, *sensor_rate; /* (sensors) in SI units */
  double *force;                /* net force on each node [N] */
  double *normal;               /* (contacts) normal force [N]; in the step only where it touches */
  double *friction;             /* (contacts) friction force along the ground [N] */
  strut_sliding_motion *sliding;  /* masses that slide, in the table's order of moving ones */
  double power[STRUT_POWER_ROOM]; /* [W]; only where the energy balance is kept */
  strut_power_lanes lanes[2];     /* see strut_weight_side */
  strut_power_lanes *accumulated; /* which of them the next evaluation adds to */
  int64_t evaluations;            /* how many there were since the reset */
} strut_latest;

/** Elements that may act near some positions; see forces/nearby.h. */
typedef struct strut_nearby {
  int32_t *element, count; /* ascending */
  double *q;               /* (length) where it was made */
  bool known;              /* made since the reset */
  int64_t made;            /* how often, ever */
} strut_nearby;

/** Room that evaluations use and leave without meaning. */
typedef struct strut_state_buffers {
  double *mass_solve;     /* (length) */
  double *support_rates;  /* (moved coordinates) */
  double *support_answer; /* (length) 0 between uses; only where supports move */
  int32_t *near;          /* (contacts) those that may touch; with STRUT_TERM_SURFACES */
  double *
      sliding_factor; /* (2, n, n) Cholesky factors of 1/m + N M^-1 N' of n sliding masses, of x, then y */
  double *sliding_push; /* (2, n) */
} strut_state_buffers;

/** Who looks on; NULL: nobody. */
typedef struct strut_state_watched {
  struct strut_event_log *event_log; /* methods with events note there when modes change, see
                                        integrate/events/location/event_log.h */
  struct strut_variation *variation; /* exact methods with events carry it along, see
                                        integrate/events/location/variation.h */
  struct strut_observer *observer;   /* sees each piece of the motion of a method with events, see
                                        integrate/integrator.h */
  int rehearsals; /* a trial of a method with events is first taken so often and thrown away, which changes no bit */
} strut_state_watched;

typedef struct strut_state {
  /* the state proper: filled by strut_state_reset, advanced by an integrator */
  int64_t step;                  /* n; time is n * dt, never a sum */
  double *q;                     /* positions [m] */
  double *v;                     /* velocities [m/s] */
  double work[STRUT_POWER_ROOM]; /* powers integrated since t = 0 [J] */
  double load_work_origin;       /* strut_energy_reset_load_work: where the works count from [J] */
  double support_work_origin;    /* strut_support_motion_reset_work: where it counts from [J] */
  double time_offset;   /* drives and loads stand where they do so much later than n * dt [s] */
  double refined_until; /* methods that refine after touchdowns do so until then [s] */
  int64_t events;       /* switches located in time, since the reset */
  strut_forced_steps forced;
  strut_failure trouble; /* why a method could not go on; it stays on the latest grid point */
  int32_t
      trouble_node; /* where, with STRUT_FAILURE_IMPLICIT; the signal, with _RELAY; with _GUIDE among the
                            nodes of all elements the first of the segment */
  double trouble_time; /* with _GUIDE [s] */
  bool kicked; /* velocities have jumped at the end of the latest step of a method without events */
  bool balance;   /* keep the energy balance? It costs some arithmetic per evaluation */
  bool forgetful; /* nothing yields or breaks: while settling; strut_state_reset keeps it */
  strut_state_limits limits;
  strut_frozen_modes modes;
  strut_history history;
  strut_signal_states signals;
  strut_state_watched watched;
  /* what evaluations of the forces write, whose state is constant */
  strut_latest *latest;
  strut_state_buffers *buffers;
  strut_nearby *nearby;      /* only with elements.scattered */
  struct strut_rigid *rigid; /* forces of rigid bars, see rigid.h; NULL where bars are elastic */
  strut_arena arena;
} strut_state;

/** What a contact is at the time of the drives. */
static inline const strut_contact_entry *strut_contact_entry_now(const strut_model *model,
                                                                 const strut_state *state,
                                                                 int32_t i) {
  return state->latest->grip ? &state->latest->grip[i] : &model->contacts.entry[i];
}

/** All memory a run needs; an integrator adds its own to the arena. STRUT_OK or STRUT_NO_MEMORY. */
STRUT_API strut_status strut_state_create(const strut_model *model, strut_state **state,
                                          strut_error *error);
/** Back to the start: positions and velocities of the scene, time 0, empty balance. */
STRUT_API void strut_state_reset(const strut_model *model, strut_state *state);
/** NULL is allowed. */
STRUT_API void strut_state_free(strut_state *state);
