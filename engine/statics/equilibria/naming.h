/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Names for equilibria: a scene's configurations, by contacts and shape; and which way round a
 * shape that has a mirror image is shown.
 */
#ifndef STRUT_ENGINE_STATICS_EQUILIBRIA_NAMING_H
#define STRUT_ENGINE_STATICS_EQUILIBRIA_NAMING_H

#include "engine/statics/equilibria/equilibria.h"

/** Largest distance of a shape from the configuration that names it, in model sizes. */
#define STRUT_NAMED_WITHIN 0.05

/**
 * Of a shape q and its mirror image, where that is an equilibrium too (nothing acts along x, and
 * all that is held along x shares one x), takes the one that is nearest to a configuration, else to
 * the drawn shape; softest (may be NULL) goes with it. held: (length) coordinates held besides the
 * scene's. STRUT_OK or STRUT_NO_MEMORY.
 */
strut_status strut_orient_shape(const strut_model *model, const uint8_t *held, double *q,
                                double *softest);

/**
 * Names the list (count). Equilibria that stand take the names of configurations where they fit;
 * where one without a shape fits several, they are NAME, NAME-2, ...: by its contact sets in their
 * order, then by energy. The others are named by the nodes that touch the ground and numbered by
 * energy: n1-n4-2, n1-n4-saddle-1, held-n1-n4-3 for what rests only while its contacts are held,
 * equilibrium-1 and saddle-1 where nothing touches. A search with another seed gives the same names
 * as long as it finds the same shapes. Names are the scene's or in the arena.
 */
strut_status strut_name_equilibria(const strut_model *model, size_t count, strut_equilibrium **list,
                                   strut_arena *arena);

/** True if strut_name_equilibria may give this name. */
bool strut_is_listed_name(const strut_scene *scene, const char *name);

/** True where the set holds the same nodes, in any order. */
bool strut_same_nodes(const strut_node_set *set, const int32_t *nodes, int32_t count);

/** Writes "n1, n2 and n3" for the nodes with a flag; many become "n1, n2, n3 and 5 more". */
void strut_list_nodes(const strut_scene *scene, const uint8_t *flag, size_t size, char *text);

#endif
