/* SPDX-License-Identifier: GPL-3.0-or-later */
/** How a model gets its table of sliding masses; internal to engine/model. */
#ifndef STRUT_ENGINE_MODEL_SLIDING_COMPILE_H
#define STRUT_ENGINE_MODEL_SLIDING_COMPILE_H

#include "engine/model/model.h"

/** Fills the table but for the answers; before the weights. False: out of memory. */
bool strut_sliding_masses_compile(strut_model *model);
/** Finds the answers; after the mass matrix. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_sliding_masses_solve(strut_model *model);

#endif
