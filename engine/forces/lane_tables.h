/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The numbers of several models of one topology side by side, for forces of all of them at once.
 *
 * A lane is one model. Arrays are (rows, width): row by row the numbers of all lanes, so that a row is
 * a vector register. What lanes share (who is joined to whom, which nodes may touch, which masses are
 * coupled, the plan) is read from the first model's tables.
 */
#ifndef STRUT_ENGINE_FORCES_LANE_TABLES_H
#define STRUT_ENGINE_FORCES_LANE_TABLES_H

#include "engine/forces/forces.h"

/** The most lanes of a batch. */
enum { STRUT_MOST_LANES = 8 };

/** Powers of runs in lanes: all but the last, that of supports, which do not move there. */
enum { STRUT_LANE_POWERS = STRUT_POWER_SUPPORT };
_Static_assert(STRUT_POWER_SUPPORT == STRUT_POWER_COUNT - 1, "powers of lanes come first");

/** Rows of a contact, of the ground, and of a signal. */
typedef enum strut_lane_contact_row {
  STRUT_LANE_MINUS_STIFFNESS,
  STRUT_LANE_MINUS_DAMPING,
  STRUT_LANE_DISSIPATION,
#define STRUT_FRICTION_ROW(NAME, ...) STRUT_LANE_FRICTION_##NAME,
  STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
      STRUT_LANE_FRICTION_MU_STATIC_BACKWARD,
  STRUT_LANE_FRICTION_MU_KINETIC_BACKWARD,
  STRUT_LANE_FRICTION_LAW, /* strut_friction_law */
  STRUT_LANE_CONTACT_ROWS
} strut_lane_contact_row;

typedef enum strut_lane_ground_row {
  STRUT_LANE_TANGENT_X,
  STRUT_LANE_TANGENT_Y,
  STRUT_LANE_NORMAL_X,
  STRUT_LANE_NORMAL_Y,
  STRUT_LANE_HEIGHT,
  STRUT_LANE_BELT,
  STRUT_LANE_GROUND_ROWS
} strut_lane_ground_row;

typedef enum strut_lane_wave_row {
  STRUT_LANE_AMPLITUDE,
  STRUT_LANE_RATE, /* amplitude * 2 pi * frequency */
  STRUT_LANE_FREQUENCY,
  STRUT_LANE_PHASE,
  STRUT_LANE_START,
  STRUT_LANE_STOP,
  STRUT_LANE_MOST_TURNS, /* a half-wave ends at 0.5 */
  STRUT_LANE_WAVE_ROWS
} strut_lane_wave_row;

typedef struct strut_lane_tables {
  int32_t width;
  const strut_model *first;                   /* topology; as long as the tables live */
  const strut_model *model[STRUT_MOST_LANES]; /* whose numbers each lane has; NULL: none yet */
  double *stiffness, *damping, *rest0;        /* (slots, width) */
  double *rest, *rest_rate;                   /* (slots, width) now, as driven */
  double *slack_length_threshold, *slack_force_threshold; /* (slots, width) */
  double *constant;                                       /* (length, width) */
  double *contact;          /* (contacts, STRUT_LANE_CONTACT_ROWS, width) */
  double *ground;           /* (STRUT_LANE_GROUND_ROWS, width) */
  double *wave;             /* (drives + loads, STRUT_LANE_WAVE_ROWS, width) */
  bool *all_waves;          /* (drives + loads) sines and half-waves only? */
  double *load_factor;      /* (loads, width) now */
  double *load_x, *load_y;  /* (loads, width) */
  double *inverse;          /* (length, width) of masses that none couples */
  double *block_inverse[2]; /* as strut_mass_operator, times width */
  double *force;            /* (length, width) */
  /* (elements, width): numbers; what a state has of each; modes as numbers */
  double *element_stiffness, *element_damping, *element_natural;
  double *element_turn, *element_acts, *element_piece;
  double *power; /* (STRUT_LANE_POWERS, width) */
} strut_lane_tables;

/** Is there a kernel for what the model needs: no rigid bars, no factor? */
STRUT_API bool strut_lanes_possible(const strut_model *model);
/** Can both be lanes of one batch: same members, contacts, supports, drives, plan? */
STRUT_API bool strut_lanes_alike(const strut_model *a, const strut_model *b);

/** Room for `width` lanes like `first`, which must be possible, in the arena. False: out of memory. */
bool strut_lane_tables_create(const strut_model *first, int32_t width, strut_arena *arena,
                              strut_lane_tables *tables);
/** Lane `lane` becomes the model, which must be like the first one. */
void strut_lane_tables_fill(strut_lane_tables *tables, int32_t lane, const strut_model *model);
/** What a state has of each element becomes lane `lane`'s, or the other way round. */
void strut_lane_tables_put_elements(strut_lane_tables *tables, int32_t lane,
                                    const strut_state *state);
void strut_lane_tables_get_elements(const strut_lane_tables *tables, int32_t lane,
                                    strut_state *state);
/** Lane `to` becomes a copy of lane `from`. */
void strut_lane_tables_copy(strut_lane_tables *tables, int32_t to, int32_t from);

#endif
