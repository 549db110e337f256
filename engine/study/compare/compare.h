/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Structures side by side: what each consists of, how it stands, and how it moves.
 *
 * Every number equals that of the single command: `strut check`, `rigidity`, `equilibria`, `modes`,
 * `run --accuracy --steady`. Missing values are empty cells with a reason.
 */
#pragma once

#include <stdbool.h>

#include "engine/base/flag.h"
#include "engine/model/model.h"
#include "engine/output/draw/chart.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"
#include "engine/scene/things.h"
#include "engine/statics/equilibria/equilibria.h"

enum { STRUT_COMPARE_MOST = 100 };

/**
 * What is compared, in order: X(NAME, key, unit, GROUP, value, reason); unit "" of counts, "1" of ratios. A group is
 * computed at once, see compare.c, where `f` has its facts; the reason is that of a value which is not finite.
 */
#define STRUT_COMPARE_TABLE(X)                                                                     \
  X(NODES, "nodes", "", STRUCTURE, (double)f->scene->node_count, NULL)                             \
  X(MEMBERS, "members", "", STRUCTURE, (double)f->scene->member_count, NULL)                       \
  X(BARS, "bars", "", STRUCTURE, count_members(f, STRUT_BAR), NULL)                                \
  X(SPRINGS, "springs", "", STRUCTURE, count_members(f, STRUT_SPRING), NULL)                       \
  X(CABLES, "cables", "", STRUCTURE, count_members(f, STRUT_CABLE), NULL)                          \
  X(CONTACTS, "contacts", "", STRUCTURE, (double)f->scene->contact_count, NULL)                    \
  X(ACTUATORS, "actuators", "", STRUCTURE, (double)f->scene->actuator_count, NULL)                 \
  X(MASS, "mass", "kg", STRUCTURE, strut_scene_mass(f->scene), NULL)                               \
  X(FREEDOMS, "degrees_of_freedom", "", STRUCTURE, free_coordinates(f->scene), NULL)               \
  X(SELF_STRESSES, "self_stress_states", "", RIGIDITY, f->rigidity.states.count, NULL)             \
  /* all that stretch no member but rigid-body motions */                                          \
  X(MECHANISMS, "mechanisms", "", RIGIDITY,                                                        \
    f->rigidity.mechanisms.count - f->rigidity.mechanisms.rigid_body, NULL)                        \
  X(FINITE, "finite_mechanisms", "", RIGIDITY, f->rigidity.mechanisms.finite, NULL)                \
  X(RIGID_MOTIONS, "rigid_body_motions", "", RIGIDITY, f->rigidity.mechanisms.rigid_body, NULL)    \
  X(STATES, "stable_states", "", STABLE, (double)c->state_count, NULL)                             \
  X(LOWEST_ENERGY, "lowest_energy", "J", STABLE, state_energy(c, 0), why_no_state(f))              \
  X(ENERGY_SPAN, "energy_span", "J", STABLE,                                                       \
    state_energy(c, c->state_count - 1) - state_energy(c, 0), why_no_state(f))                     \
  /* out of the state that a run starts in */                                                      \
  X(LOWEST_BARRIER, "lowest_barrier", "J", STABLE, lowest_barrier(f),                              \
    !c->state_count ? why_no_state(f)                                                              \
    : f->start < 0  ? "the start is in none of the listed states"                                  \
                    : "no path to another state is known")                                          \
  /* root of the mean square of member forces, and the largest ones */                             \
  X(PRESTRESS, "prestress", "N", FORCES, root_mean_square(f), no_members)                          \
  X(TENSION, "largest_tension", "N", FORCES, largest_force(f, 1.0), no_members)                    \
  X(COMPRESSION, "largest_compression", "N", FORCES, largest_force(f, -1.0), no_members)           \
  /* elastic, contacts sliding */                                                                  \
  X(FREQUENCY_1, "frequency_1", "Hz", FREQUENCIES, frequency(f, 0), fewer_modes)                   \
  X(FREQUENCY_2, "frequency_2", "Hz", FREQUENCIES, frequency(f, 1), fewer_modes)                   \
  X(FREQUENCY_3, "frequency_3", "Hz", FREQUENCIES, frequency(f, 2), fewer_modes)                   \
  /* of the softest node under a unit load */                                                      \
  X(STIFFNESS_X, "stiffness_x", "N/m", STIFFNESS, least_stiffness(c, 0), held)                     \
  X(STIFFNESS_Y, "stiffness_y", "N/m", STIFFNESS, least_stiffness(c, 1), held)                     \
  /* rk4's */                                                                                      \
  X(STEP_LIMIT, "step_limit", "s", LIMIT, f->plan.runnable ? f->plan.step_limit : (double)NAN,     \
    f->plan.runnable ? "the step is not limited" : "a free node has no mass")                      \
  /* sliding */                                                                                    \
  X(FRICTION, "friction", "1", STRUCTURE, common_friction(f->scene),                               \
    f->scene->contact_count ? "friction differs between contacts" : "no contact nodes")            \
  X(DRIVE_FREQUENCY, "drive_frequency", "Hz", STRUCTURE, drive_frequency(f),                       \
    why_no_drive(f, "the drive is not periodic"))                                                  \
  X(DRIVE_AMPLITUDE, "drive_amplitude", "m", STRUCTURE, drive_amplitude(f),                        \
    why_no_drive(f, "the drive has no single amplitude"))                                          \
  X(VELOCITY, "velocity", "m/s", MOTION, f->run.velocity, NULL)                                    \
  X(VELOCITY_ERROR, "velocity_error", "1", MOTION, f->run.accuracy.expected, NULL) /* expected */  \
  X(TRAVEL, "travel_per_period", "m", MOTION, f->run.velocity * f->period, no_periods)             \
  X(DRIVE_ENERGY, "drive_energy_per_period", "J", WINDOW, f->power * f->period,                    \
    f->scene->actuator_count ? no_periods : no_drive)                                              \
  X(DRIVE_POWER, "drive_power", "W", WINDOW, f->power, f->scene->actuator_count ? NULL : no_drive) \
  /* drive power over weight times speed */                                                        \
  X(TRANSPORT, "cost_of_transport", "1", WINDOW, cost_of_transport(f),                             \
    !f->scene->actuator_count   ? no_drive                                                         \
    : !(weight(f->scene) > 0.0) ? "there is no weight"                                             \
    : c->still                  ? "the velocity is zero within its error"                          \
                                : "the drives do no work")                                                          \
  /* mean over the contacts that touch at all */                                                   \
  X(DUTY, "contact_duty", "1", WINDOW, mean_duty(c), "nothing touches a ground")                   \
  /* of the forces; seconds per simulated second: a measurement */                                 \
  X(EVALUATIONS, "evaluations_per_second", "1/s", MOTION, evaluations(&f->run) / f->run.duration,  \
    NULL)                                                                                          \
  X(CPU, "cpu_per_second", "s/s", MOTION, f->cpu / f->run.duration, NULL)

typedef enum strut_compare_quantity {
#define STRUT_COMPARE_ENUM(name, ...) STRUT_COMPARE_##name,
  STRUT_COMPARE_TABLE(STRUT_COMPARE_ENUM) STRUT_COMPARE_QUANTITIES
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
  strut_model *model;          /* as run; owned */
  const char *shape;           /* name of the equilibrium evaluated and drawn, or "drawn" */
  const double *q;             /* (length) its positions [m] */
  strut_equilibria equilibria; /* owned */
  size_t state_count, contact_count;
  const int32_t *states;  /* (state_count) equilibria that stand, by energy */
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
 * Rows of a strut_compare, with a CSV of `models`. The CPU time in them is a measurement and differs from run to run;
 * nothing else does.
 */
STRUT_API extern const strut_value_rows strut_compare_values;

/**
 * Draws the structures [first, first + count) of a comparison: each in the shape in which it stands,
 * members by kind, driven ones marked, its name and a few of its numbers above. They have the same scale
 * unless some are more than four times as large as others. Without a title of the plot there is none.
 * Fails as strut_canvas_open and strut_canvas_commit; STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_compare_figure(const strut_plot *plot, const strut_compare *result,
                                            size_t first, size_t count, strut_error *error);
