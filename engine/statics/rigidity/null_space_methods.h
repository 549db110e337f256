/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Both decompositions that strut_null_spaces_find chooses from. */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_NULL_SPACE_METHODS_H
#define STRUT_ENGINE_STATICS_RIGIDITY_NULL_SPACE_METHODS_H

#include "engine/statics/rigidity/null_spaces.h"

strut_status strut_null_spaces_dense(const strut_equilibrium_matrix *a, strut_arena *arena,
                                     strut_null_spaces *spaces, strut_error *error);
strut_status strut_null_spaces_sparse(const strut_equilibrium_matrix *a, strut_arena *arena,
                                      strut_null_spaces *spaces, strut_error *error);

#endif
