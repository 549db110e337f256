/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The classical Runge-Kutta method for large structures, by several threads.
 *
 * Members write what they pull with, and each node then adds up its row of them in the scene's order: the sums
 * are those of rk4.c, to the last bit, wherever members are stored and however many threads there are. A thread
 * owns some members and some nodes; nothing is written by two.
 */
#ifndef STRUT_ENGINE_INTEGRATE_ROWS_H
#define STRUT_ENGINE_INTEGRATE_ROWS_H

#include "engine/integrate/integrator.h"

typedef struct strut_rows strut_rows;

/** Does the plan have no other terms than those that rows have? */
bool strut_rows_possible(const strut_model *model);
/**
 * stored: (members) where members of the scene are stored; NULL: as in the scene. NULL: out of memory.
 */
strut_rows *strut_rows_create(const strut_model *model, const int32_t *stored, int threads);
/** NULL is allowed. */
void strut_rows_free(strut_rows *rows);
/** Advances a state of the model by `count` steps of dt [s]. */
void strut_rows_advance(strut_rows *rows, strut_state *state, double dt, int64_t count);

#endif
