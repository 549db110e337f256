/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What a motion without stiffness moves, and whether it leads away at one energy.
 */
#ifndef STRUT_ENGINE_STATICS_EQUILIBRIA_FLOPPY_H
#define STRUT_ENGINE_STATICS_EQUILIBRIA_FLOPPY_H

#include "engine/statics/search/critical.h"

/**
 * flag (node_count): 1 where a node moves in point->softest, once the free rigid motion is added
 * that keeps most nodes still.
 */
void strut_floppy_nodes(const strut_model *model, const strut_critical_point *point, uint8_t *flag);

/**
 * Pushed along point->softest by a fiftieth of the structure's size and let down again: does it stay
 * away, at the same energy? Else stiffness of a higher order brings it back, or it falls further.
 * False when memory is out too.
 */
bool strut_floppy_stays(const strut_potential *potential, const strut_critical_point *point);

#endif
