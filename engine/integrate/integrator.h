/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Methods of integration: one file per method, one row per method in the table. */
#pragma once

#include "engine/model/state.h"
#include "engine/scene/experiment.h"

/** Which steps are stable, by the eigenvalues of small motions: see step_limit.h. */
typedef enum strut_region {
  STRUT_REGION_ALL, /* every step, or one that the method chooses */
  STRUT_REGION_RK4,
  STRUT_REGION_VERLET,
  STRUT_REGION_EULER,
  STRUT_REGIONS
} strut_region;

/** What the program chooses a method for where the user names none; see strut_integrator_for. */
typedef enum strut_integrator_role {
  STRUT_ROLE_NONE,
  STRUT_ROLE_PLAIN,       /* settling, relaxing and steps that are halved */
  STRUT_ROLE_EXACT_STICK, /* the same where a friction law sticks exactly */
  STRUT_ROLE_COARSE,      /* the first, coarse run of a requested accuracy */
  STRUT_ROLE_REFERENCE,   /* chooses its steps by its own estimate of the error */
  STRUT_ROLE_PRECISE,     /* the same, for small tolerances */
  STRUT_ROLE_IMPLICIT,    /* the same, for what is stiff */
  STRUT_ROLE_STIFF        /* long steps over stiff members that hardly move */
} strut_integrator_role;

/** What a method is set up for, beside the model; see strut_experiment. */
typedef struct strut_integrator_settings {
  double step;      /* wanted [s]; a run may take slightly shorter ones, to divide a period */
  double tolerance; /* of error control [1] */
  double refine, refine_time, refine_rate, refine_memory;
} strut_integrator_settings;

/** A method. Its workspace belongs to one state, whose arena holds it: freeing the state frees it. */
typedef struct strut_integrator {
  const char *name;        /* as the language calls it */
  const char *description; /* one line for documents */
  int order;               /* of convergence on smooth scenes */
  double lag; /* phase error of a vibration per radian with z = step times rad/s, over z^2; over z^4
                 from order 3 on; 0: the method chooses its steps by its own estimate of the error */
  int evaluations; /* of the forces per step, where no event interrupts it */
  strut_region region;
  strut_integrator_role role; /* each at most once in the table */
  bool implicit_damper;       /* the ground's dampers do not limit the step */
  bool events;                /* locates events: modes of contacts are frozen within a step */
  bool rigid;                 /* keeps the lengths of rigid bars */
  bool no_ground;             /* cannot step over contacts */
  /** Allocates the workspace beside the state's own arrays; NULL: out of memory. */
  void *(*create)(const strut_model *model, strut_state *state,
                  const strut_integrator_settings *settings);
  /** Must be called whenever someone else has changed q or v; NULL where nothing depends on it. */
  void (*restart)(const strut_model *model, strut_state *state, void *workspace, double dt);
  /**
   * Advances the state by `count` steps of dt [s]; allocates nothing. Within a step a method may
   * stop wherever it likes, but it ends on the grid n dt. Trouble is left in state->trouble.
   */
  void (*advance)(const strut_model *model, strut_state *state, void *workspace, double dt,
                  int64_t count);
  /**
   * Prepares for a state->watched.observer, which then sees every piece of the motion. False: out of memory.
   * NULL: its pieces are the steps of the grid.
   */
  bool (*observe)(const strut_model *model, strut_state *state, void *workspace);
  bool no_memory;         /* cannot step elements with memory */
  bool no_sliding_masses; /* cannot step masses that slide along members */
  bool tangent;           /* carries variations along: events/location/variation.h */
  bool solves;            /* linear systems, by the libraries of linear_solver.h */
} strut_integrator;

/** The i-th method, or NULL after the last. */
STRUT_API const strut_integrator *strut_integrator_at(size_t i);
/** The method of that name, or NULL. */
STRUT_API const strut_integrator *strut_integrator_find(const char *name);
/** The method of a role other than STRUT_ROLE_NONE. */
STRUT_API const strut_integrator *strut_integrator_for(strut_integrator_role role);
/** Does it choose its steps by its own estimate of the error? */
static inline bool strut_integrator_controls_error(const strut_integrator *method) {
  return method->role == STRUT_ROLE_REFERENCE || method->role == STRUT_ROLE_PRECISE ||
         method->role == STRUT_ROLE_IMPLICIT;
}
/** The method of STRUT_ROLE_PLAIN, or of STRUT_ROLE_EXACT_STICK where the model has such a contact. */
STRUT_API const strut_integrator *strut_integrator_for_settling(const strut_model *model);
/** Index of the first contact whose friction law sticks exactly, or -1. */
STRUT_API int32_t strut_first_exact_contact(const strut_model *model);
/**
 * Advances the state by `count` steps of dt as the method does, with the samples of sampled signals: those
 * of methods without events are taken on the grid. What a sample does to the elastic energy is work of the
 * drive. All stepping goes through here.
 */
STRUT_API void strut_integrator_advance(const strut_integrator *method, const strut_model *model,
                                        strut_state *state, void *workspace, double dt,
                                        int64_t count);
/** Do all sampled signals fall on the grid of a method without events? STRUT_USAGE: no, with a step that fits. */
STRUT_API strut_status strut_integrator_check_samples(const strut_integrator *method,
                                                      const strut_model *model, double dt,
                                                      strut_error *error);
/** The settings of an experiment's method. */
static inline strut_integrator_settings strut_integrator_settings_of(
    const strut_experiment *experiment) {
  return (strut_integrator_settings){.step = experiment->step,
                                     .tolerance = experiment->tolerance,
                                     .refine = experiment->refine,
                                     .refine_time = experiment->refine_time,
                                     .refine_rate = experiment->refine_rate,
                                     .refine_memory = experiment->refine_memory};
}
/**
 * Can the experiment's method run the model? STRUT_USAGE, with what to change, where there is no such
 * method, exact Coulomb friction has none with events, contacts have one that cannot step over them,
 * or rigid bars have none that keeps them;
 * STRUT_SINGULAR with the bar where rigid bars hold each other.
 */
STRUT_API strut_status strut_integrator_check(const strut_model *model,
                                              const strut_experiment *experiment,
                                              strut_error *error);

/*
 * The motion between the steps of a run, for those who measure it: pieces without an event, one after the other.
 *
 * A method with events hands over each of its steps as it is accepted, before the event at its end
 * changes a mode. Of other methods the measurement makes one piece of each step of the grid.
 */

/** A piece of the motion; coordinate arrays are (length), pairs are for its begin and its end. */
typedef struct strut_motion_piece {
  double begin, length; /* without the state's time_offset [s] */
  double
      moment; /* signals that jump at the begin have their value from after it so much later [s] */
  const double *q[2], *v[2];        /* [m], [m/s] */
  const double *a[2];               /* [m/s^2]; NULL: of a method without events, see meter.h */
  const double *work[2], *power[2]; /* [J], [W]; only with the energy balance */
  const double *memory; /* what elements remember at the begin, as strut_history_store has it */
  bool smooth;    /* it continues the piece before: nothing has switched or jumped in between */
  bool ends_only; /* velocities have jumped within it: only its ends are known */
  /** Fills the state's held contact forces for an instant within the piece; NULL: they follow from
      q, v and t by the contacts' laws. */
  void (*hold)(const struct strut_motion_piece *piece, const strut_model *model,
               const strut_state *state, double t, const double *positions, const double *velocity);
  void *workspace; /* of the method */
} strut_motion_piece;

/** state->watched.observer; the state is at the end of the piece. */
typedef struct strut_observer {
  void (*see)(struct strut_observer *observer, strut_state *state, const strut_motion_piece *piece);
} strut_observer;
