/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Assembly of the sparse mass matrix of one coordinate, supports eliminated.
 */
#ifndef STRUT_ENGINE_MODEL_MASS_MATRIX_H
#define STRUT_ENGINE_MODEL_MASS_MATRIX_H

#include "engine/model/linear_solver.h"
#include "engine/model/model.h"

/**
 * M of the free nodes of coordinate 0 (x) or 1 (y): point masses, and per member (m/6)[2 1; 1 2]
 * (consistent, exact for a uniform rigid rod) or m/2 at each end (lumped). *matrix (lower triangle)
 * and *node (its node per row) live in the model's arena. STRUT_OK or STRUT_NO_MEMORY.
 */
strut_status strut_mass_matrix(strut_model *model, int coordinate, strut_arena *scratch,
                               strut_sparse **matrix, int32_t **node);

#endif
