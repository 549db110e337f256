/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Matrices for other programs: Matrix Market files, and what their rows and columns are called.
 *
 * In it: node_names.csv, rows.csv (free coordinates), columns.csv (members); as .mtx files
 * connectivity (nodes x members, -1 and 1), equilibrium (rows x columns), and over the rows mass,
 * stiffness_elastic, stiffness_geometric, damping and, where nodes touch the ground,
 * stiffness_contact. The first line of each .mtx after the banner says what it is and its unit.
 */
#ifndef STRUT_ENGINE_OUTPUT_MATRIX_MARKET_H
#define STRUT_ENGINE_OUTPUT_MATRIX_MARKET_H

#include "engine/statics/rigidity/equilibrium_matrix.h"

/**
 * Writes them all, or none: those of an earlier export go when these come. q (length)
 * is the shape, `at` its name.
 */
STRUT_API strut_status strut_matrices_write(const char *directory, const strut_model *model,
                                            const double *q, const char *at, strut_error *error);

#endif
