/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The numbers of several models of one topology side by side, for forces of all of them at once.
 *
 * A slot is one model. Arrays are (rows, width): row by row the numbers of all slots, so that a row is
 * a vector register. What slots share (who is joined to whom, which nodes may touch, which masses are
 * coupled, the terms) is read from the first model's tables.
 */
#ifndef STRUT_ENGINE_FORCES_BATCH_TABLES_H
#define STRUT_ENGINE_FORCES_BATCH_TABLES_H

#include "engine/forces/forces.h"

/** The most slots of a batch. */
enum { STRUT_BATCH_MOST = 8 };

/** Powers of a run in a batch: all but the last, that of supports, which do not move there. */
enum { STRUT_BATCH_POWERS = STRUT_POWER_SUPPORT };
_Static_assert(STRUT_POWER_SUPPORT == STRUT_POWER_COUNT - 1, "powers of a batch come first");

/** Rows of a contact, of the ground, and of a signal. */
typedef enum strut_batch_contact_row {
  STRUT_BATCH_MINUS_STIFFNESS,
  STRUT_BATCH_MINUS_DAMPING,
  STRUT_BATCH_DISSIPATION,
#define STRUT_FRICTION_ROW(NAME, ...) STRUT_BATCH_FRICTION_##NAME,
  STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
      STRUT_BATCH_FRICTION_MU_STATIC_BACKWARD,
  STRUT_BATCH_FRICTION_MU_KINETIC_BACKWARD,
  STRUT_BATCH_FRICTION_LAW, /* strut_friction_law */
  STRUT_BATCH_CONTACT_ROWS
} strut_batch_contact_row;

typedef enum strut_batch_ground_row {
  STRUT_BATCH_TANGENT_X,
  STRUT_BATCH_TANGENT_Y,
  STRUT_BATCH_NORMAL_X,
  STRUT_BATCH_NORMAL_Y,
  STRUT_BATCH_HEIGHT,
  STRUT_BATCH_BELT,
  STRUT_BATCH_GROUND_ROWS
} strut_batch_ground_row;

typedef enum strut_batch_wave_row {
  STRUT_BATCH_AMPLITUDE,
  STRUT_BATCH_RATE, /* amplitude * 2 pi * frequency */
  STRUT_BATCH_FREQUENCY,
  STRUT_BATCH_PHASE,
  STRUT_BATCH_START,
  STRUT_BATCH_STOP,
  STRUT_BATCH_MOST_TURNS, /* a half-wave ends at 0.5 */
  STRUT_BATCH_WAVE_ROWS
} strut_batch_wave_row;

typedef struct strut_batch_tables {
  int32_t width;
  const strut_model *first;                   /* topology; as long as the tables live */
  const strut_model *model[STRUT_BATCH_MOST]; /* whose numbers each slot has; NULL: none yet */
  double *constant;                           /* (length, width) */
  double *force;                              /* (length, width) */
  double *power;                              /* (STRUT_BATCH_POWERS, width) */
  /** (member slots, width) each. */
  struct {
    double *stiffness, *damping, *rest0;
    double *rest, *rest_rate; /* now, as driven */
    double *slack_length_threshold, *slack_force_threshold;
  } members;
  struct {
    double *contact; /* (contacts, STRUT_BATCH_CONTACT_ROWS, width) */
    double *line;    /* (STRUT_BATCH_GROUND_ROWS, width) */
  } ground;
  struct {
    double *wave;            /* (drives + loads, STRUT_BATCH_WAVE_ROWS, width) */
    bool *all_waves;         /* (drives + loads) sines and half-waves only? */
    double *load_factor;     /* (loads, width) now */
    double *load_x, *load_y; /* (loads, width) */
  } signals;
  struct {
    double *inverse;          /* (length, width) of masses that none couples */
    double *block_inverse[2]; /* as strut_mass_operator, times width */
  } mass;
  /** (elements, width) each: numbers; what a state has of each; modes as numbers. */
  struct {
    double *stiffness, *damping, *natural;
    double *turn, *acts, *piece;
  } elements;
} strut_batch_tables;

/** Is there a kernel for what the model needs: no rigid bars, no factor? */
STRUT_API bool strut_batch_takes_model(const strut_model *model);
/** Can both be slots of one batch: same members, contacts, supports, drives, terms? */
STRUT_API bool strut_batch_takes_both(const strut_model *a, const strut_model *b);

/** Room for `width` slots like `first`, which must be possible, in the arena. False: out of memory. */
bool strut_batch_tables_create(const strut_model *first, int32_t width, strut_arena *arena,
                               strut_batch_tables *tables);
/** Slot `slot` becomes the model, which must be like the first one. */
void strut_batch_tables_fill(strut_batch_tables *tables, int32_t slot, const strut_model *model);
/** What a state has of each element becomes slot `slot`'s, or the other way round. */
void strut_batch_tables_put_elements(strut_batch_tables *tables, int32_t slot,
                                     const strut_state *state);
void strut_batch_tables_get_elements(const strut_batch_tables *tables, int32_t slot,
                                     strut_state *state);
/** Slot `to` becomes a copy of slot `from`. */
void strut_batch_tables_copy(strut_batch_tables *tables, int32_t to, int32_t from);

#endif
