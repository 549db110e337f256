/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Structures side by side: what each consists of, how it stands, and how it moves.
 *
 * Every number equals that of the single command: `strut check`, `rigidity`, `equilibria`, `modes`,
 * `run --accuracy --steady`. Missing values are empty cells with a reason.
 */
#ifndef STRUT_ENGINE_STUDY_COMPARE_COMPARE_H
#define STRUT_ENGINE_STUDY_COMPARE_COMPARE_H

#include <stdbool.h>

#include "engine/base/flag.h"
#include "engine/model/model.h"
#include "engine/output/draw/chart.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"
#include "engine/scene/things.h"

enum { STRUT_COMPARE_MOST = 100, STRUT_COMPARE_FREQUENCIES = 3 };

/** What is compared, in order: X(NAME, key, unit); unit "" of counts, "1" of ratios. */
#define STRUT_COMPARE_TABLE(X)                                                                     \
  X(NODES, "nodes", "")                                                                            \
  X(MEMBERS, "members", "")                                                                        \
  X(BARS, "bars", "")                                                                              \
  X(SPRINGS, "springs", "")                                                                        \
  X(CABLES, "cables", "")                                                                          \
  X(CONTACTS, "contacts", "")                                                                      \
  X(ACTUATORS, "actuators", "")                                                                    \
  X(MASS, "mass", "kg")                                                                            \
  X(FREEDOMS, "degrees_of_freedom", "")                                                            \
  X(SELF_STRESSES, "self_stress_states", "") /* as drawn, like the next three */                   \
  X(MECHANISMS, "mechanisms", "")    /* all that stretch no member but rigid-body motions */       \
  X(FINITE, "finite_mechanisms", "") /* of them */                                                 \
  X(RIGID_MOTIONS, "rigid_body_motions", "")                                                       \
  X(STATES, "stable_states", "")           /* equilibria that stand */                             \
  X(LOWEST_ENERGY, "lowest_energy", "J")   /* of those */                                          \
  X(ENERGY_SPAN, "energy_span", "J")       /* from the lowest to the highest */                    \
  X(LOWEST_BARRIER, "lowest_barrier", "J") /* out of the state that a run starts in */             \
  X(PRESTRESS, "prestress", "N")           /* root of the mean square of member forces at rest */  \
  X(TENSION, "largest_tension", "N")       /* largest, at rest */                                  \
  X(COMPRESSION, "largest_compression", "N") /* largest, at rest; positive */                      \
  X(FREQUENCY_1, "frequency_1", "Hz")        /* lowest elastic ones, contacts sliding */           \
  X(FREQUENCY_2, "frequency_2", "Hz")                                                              \
  X(FREQUENCY_3, "frequency_3", "Hz")                                                              \
  X(STIFFNESS_X, "stiffness_x", "N/m") /* of the softest node under a unit load */                 \
  X(STIFFNESS_Y, "stiffness_y", "N/m")                                                             \
  X(STEP_LIMIT, "step_limit", "s") /* rk4's */                                                     \
  X(FRICTION, "friction", "1")     /* sliding, where all contacts agree */                         \
  X(DRIVE_FREQUENCY, "drive_frequency", "Hz")                                                      \
  X(DRIVE_AMPLITUDE, "drive_amplitude", "m")                                                       \
  X(VELOCITY, "velocity", "m/s")                                                                   \
  X(VELOCITY_ERROR, "velocity_error", "1")        /* expected, as a part of it */                  \
  X(TRAVEL, "travel_per_period", "m")             /* per period */                                 \
  X(DRIVE_ENERGY, "drive_energy_per_period", "J") /* per period */                                 \
  X(DRIVE_POWER, "drive_power", "W")                                                               \
  X(TRANSPORT, "cost_of_transport", "1")          /* drive power over weight times speed */        \
  X(DUTY, "contact_duty", "1")                    /* mean over the contacts that touch at all */   \
  X(EVALUATIONS, "evaluations_per_second", "1/s") /* of the forces, per simulated second */        \
  X(CPU, "cpu_per_second", "s/s")                 /* seconds per simulated second: a measurement */

typedef enum strut_compare_quantity {
#define STRUT_COMPARE_ENUM(name, key, unit) STRUT_COMPARE_##name,
  STRUT_COMPARE_TABLE(STRUT_COMPARE_ENUM)
#undef STRUT_COMPARE_ENUM
      STRUT_COMPARE_QUANTITIES
} strut_compare_quantity;

/** Description of a row. */
typedef struct strut_compare_row {
  const char *key;  /* "self_stress_states" */
  const char *unit; /* "kg", "Hz"; "" for counts and "1" for ratios */
} strut_compare_row;
STRUT_API strut_compare_row strut_compare_row_of(strut_compare_quantity quantity);

typedef struct strut_compare_cell {
  double value;       /* [unit of its row]; NAN if missing */
  const char *reason; /* why the value is missing, or NULL */
} strut_compare_cell;

/** A state in which a structure stands. */
typedef struct strut_compare_state {
  const char *name;
  double energy; /* (13) at rest on the real ground [J] */
} strut_compare_state;

/** The lowest pass known from one state to another. */
typedef struct strut_compare_barrier {
  const char *from, *to;
  double height; /* [J] above `from` */
} strut_compare_barrier;

/** A model to compare. Scenes are checked for any purpose; a start equilibrium may be unresolved. */
typedef struct strut_compare_input {
  const char *label;                   /* unique */
  strut_setup *setup;                  /* its start is resolved here, and its accuracy is set */
  const strut_difference *differences; /* (difference_count) from the first input */
  size_t difference_count;
  const char *const *without; /* (without_count) parameters that were set and it does not have */
  size_t without_count;
} strut_compare_input;

/** One structure's column. */
typedef struct strut_compare_column {
  const strut_compare_input *input;
  strut_compare_cell cell[STRUT_COMPARE_QUANTITIES];
  strut_model *model; /* as run; owned */
  const char *shape;  /* name of the equilibrium evaluated and drawn, or "drawn" */
  const double *q;    /* (length) its positions [m] */
  size_t state_count, barrier_count, contact_count;
  strut_compare_state *states;     /* by energy */
  strut_compare_barrier *barriers; /* as strut_equilibria lists them */
  double (*stiffness)[2]; /* (nodes) under unit loads in x and y [N/m]; NAN: none. Or NULL */
  int32_t softest[2];     /* node of STIFFNESS_X and _Y, or -1 */
  strut_contact_summary *contacts; /* (contact_count) in the steady motion */
  bool still;                      /* its velocity is 0 within its error */
  const char *motion;              /* "periodic", "irregular", ... or NULL */
  int32_t repeats;                 /* drive periods of a periodic one */
  const char *how;                 /* how the velocity was found, in words; or NULL */
  bool inaccurate;                 /* it is less accurate than requested */
  strut_status status; /* the worst of what was computed: STRUT_OK unless something failed */
  char message[600];
} strut_compare_column;

/** What an accuracy of 0 stands for. */
#define STRUT_COMPARE_USUAL_PERCENT 0.5

typedef struct strut_compare_options {
  double accuracy;                                  /* of velocities, relative; 0: the usual one */
  bool no_motion;                                   /* leave out runs */
  bool no_states;                                   /* leave out the search for stable states */
  const strut_flag *interrupt;                      /* may be NULL */
  void (*progress)(void *context, double fraction); /* may be NULL */
  void *progress_context;
} strut_compare_options;

/** All columns; strut_compare_free. The inputs outlive it. */
typedef struct strut_compare {
  size_t count;
  strut_compare_column *columns;
  double accuracy;
  bool no_motion, no_states;
  strut_arena arena;
} strut_compare;

/**
 * Fills a column for each of 1 to STRUT_COMPARE_MOST inputs. A failure is reported in the column of
 * its model, and the others continue. STRUT_OK, STRUT_INTERRUPTED, STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_compare_make(const strut_compare_input *inputs, size_t count,
                                          const strut_compare_options *options,
                                          strut_compare *result, strut_error *error);
/** A zeroed struct is allowed. */
STRUT_API void strut_compare_free(strut_compare *result);

/**
 * Texts in blocks of strut_allocate; NULL: memory was out. The CPU time in them is a measurement and
 * differs from run to run; nothing else does.
 */
/** Units in the header; empty where there is no value. */
STRUT_API char *strut_compare_csv(const strut_compare *result);
/** Rows of a strut_compare. */
STRUT_API extern const strut_value_rows strut_compare_values;
/** With the reasons of what is empty, all states, barriers, contacts, nodes and differences. */
STRUT_API char *strut_compare_json(const strut_compare *result);

/**
 * Draws the structures [first, first + count) of a comparison: each in the shape in which it stands,
 * members by kind, driven ones marked, its name and a few of its numbers above. They have the same scale
 * unless some are more than four times as large as others. Without a title of the plot there is none.
 * Fails as strut_canvas_open and strut_canvas_commit; STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_compare_figure(const strut_plot *plot, const strut_compare *result,
                                            size_t first, size_t count, strut_error *error);

#endif
