/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A large model stored in another order: neighbours in the structure become neighbours in memory.
 *
 * A scene may list nodes and members in any order; where neighbours stand far apart, every step waits for
 * memory. The renumbered model is the same structure with nodes in the order of Cuthill and McKee, and
 * members in the order of their nodes, so far as the members at each node keep their order of the scene: then
 * every node sums the same forces in the same order, and motions have the same bits.
 */
#ifndef STRUT_ENGINE_MODEL_RENUMBER_H
#define STRUT_ENGINE_MODEL_RENUMBER_H

#include "engine/model/model.h"

typedef struct strut_renumbering {
  strut_model
      *model; /* with tables of its own; it shares the mass factor with the model it comes from */
  const int32_t *place;  /* (node_count) where a node of the scene is stored */
  const int32_t *stored; /* (member count) where a member of the scene is stored */
  const int32_t *member; /* (member count) member of the scene that is stored at a place */
  strut_arena arena;
} strut_renumbering;

/** Would another order pay? It does not for small models, those in order, and terms that it cannot store. */
bool strut_model_is_scattered(const strut_model *model);
/**
 * `model` must stay while the renumbered one is used. free_members: the members at a node need not keep their
 * order, since who steps the model sums them in the scene's order by itself. STRUT_OK or STRUT_NO_MEMORY.
 */
strut_status strut_renumbering_create(const strut_model *model, bool free_members,
                                      strut_renumbering **renumbering, strut_error *error);
/** NULL is allowed. */
void strut_renumbering_free(strut_renumbering *renumbering);

/** Only the order of the members: (members) the scene's member that is stored at k. STRUT_OK, STRUT_NO_MEMORY. */
STRUT_API strut_status strut_member_order_create(const strut_model *model, strut_arena *arena,
                                                 int32_t **member, strut_error *error);

#endif
