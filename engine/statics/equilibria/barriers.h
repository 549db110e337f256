/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Passes between the stable equilibria of the real ground.
 */
#ifndef STRUT_ENGINE_STATICS_EQUILIBRIA_BARRIERS_H
#define STRUT_ENGINE_STATICS_EQUILIBRIA_BARRIERS_H

#include "engine/statics/equilibria/equilibrium_search.h"

/** More stable equilibria than this do not enter the table. */
enum { STRUT_MOST_BARRIERS_BETWEEN = 12 };

/**
 * Fills the hunt's barriers between every two equilibria that stand, of which configurations name
 * at least some: those named and those one pass away from them; without names the lowest.
 */
strut_status strut_barriers_find(strut_equilibrium_search *hunt);

#endif
