/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Rigid bars: members of kind bar as constraints at the length they have at the start.
 *
 * Index-1 form: a += M^-1 J' lambda with (J M^-1 J') lambda = -(J a + Jdot v), the rows of J being
 * the bars' directions; then positions and velocities are projected onto the constraints along
 * M^-1 J' after every step. What the bar's own spring and damper would give acts along the same line,
 * so that the multiplier takes it up: both together are the bar's force. A contact within Karnopp's
 * stick band adds the row of its tangent while its friction lasts: bar forces and stick are solved
 * together. The matrix is dense, with the inverse mass between the nodes of bars and contacts.
 */
#pragma once

#include "engine/base/vec.h"
#include "engine/model/state.h"

/** Rigid bars at most: 600 take 12 MB and 40 million operations for an evaluation. */
enum { STRUT_MOST_RIGID = 600 };

typedef struct strut_rigid {
  int32_t bars, nodes, most; /* nodes of bars and contacts; rows at most: bars, then contacts */
  int32_t *member;           /* (bars) */
  double *length;            /* (bars) kept [m] */
  double *tension;           /* (bars) multipliers, tension positive [N] */
  uint32_t *at;              /* (nodes) index of their x in coordinate arrays */
  int32_t (*end)[2];         /* (bars) index of a bar's ends among the nodes */
  int32_t *foot;             /* (contacts) index of a contact's node among the nodes */
  double *inverse[2];        /* (nodes, nodes) M^-1 of x and of y [1/kg] */
  int32_t rows;              /* in use now */
  int32_t (*row)[2];         /* (most) ends of a row; the first -1 for a contact */
  strut_vec2 *direction;     /* (most) of a row */
  double *matrix;            /* (most, most) J M^-1 J', then its Cholesky factor */
  double *right;             /* (most) right-hand side, then the multipliers */
  int32_t *stuck;            /* (contacts) those within the band */
  double *free, *push;       /* (length) scratch */
  bool failed; /* an evaluation since strut_rigid_begin had bars that depend on each other */
} strut_rigid;

/** Into the state's arena, with the lengths of the state's q. False: out of memory. */
bool strut_rigid_create(const strut_model *model, strut_state *state);
/** Takes the lengths from the state's q, and stretching out of its v. */
void strut_rigid_begin(const strut_model *model, strut_state *state);
/**
 * STRUT_SINGULAR where bars at the start hold each other or supported nodes only, by name;
 * STRUT_USAGE where there are more than STRUT_MOST_RIGID.
 */
STRUT_API strut_status strut_rigid_check(const strut_model *model, strut_error *error);

/**
 * a (length): the acceleration without bars and stick in, with them out. Adds their forces to
 * state->latest->force, sets friction of contacts in the band and tensions, and with the energy balance
 * accumulates them. Where it cannot be done rigid->failed is set, and strut_rigid_project says so.
 */
void strut_rigid_accelerate(const strut_model *model, const strut_state *state, const double *q,
                            const double *velocity, double *acceleration);
/** The same from state->latest->force, where only forces are wanted. */
void strut_rigid_constrain(const strut_model *model, const strut_state *state, const double *q,
                           const double *velocity);
/** Bars with their rows factorised at q, for the filter; NULL: out of memory. */
strut_rigid *strut_rigid_standing(const strut_model *model, const double *q, strut_arena *arena);
/** Takes out of accelerations a (length) what would stretch bars; scratch: (length). */
void strut_rigid_filter(const strut_model *model, strut_rigid *rigid, double *acceleration,
                        double *scratch);
/** Puts q back onto the lengths, to 1e-12 of them, and takes stretching out of v. False: trouble. */
bool strut_rigid_project(const strut_model *model, strut_state *state, double *q, double *velocity);
/** Tension of a member [N]; 0 where it is no rigid bar. */
double strut_rigid_tension(const strut_rigid *rigid, int32_t member);
