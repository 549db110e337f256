/* SPDX-License-Identifier: GPL-3.0-or-later */
/** One equilibrium on the real ground, by name, for modes, matrices and starts of runs. */
#ifndef STRUT_ENGINE_STATICS_EQUILIBRIA_REST_STATE_H
#define STRUT_ENGINE_STATICS_EQUILIBRIA_REST_STATE_H

#include "engine/model/model.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"

typedef struct strut_rest_state {
  const char *name; /* "drawn", "start", a configuration's, or one that the list of all gives */
  double *q;        /* (length) [m] */
  bool at_rest;     /* false where it is no equilibrium on the real ground: as drawn, or listed on
                        supports that it does not stand on */
  double residual;  /* largest net force on a free coordinate [N] */
  double scale;     /* sum of the weights and loads [N], or of member forces without any */
  int32_t closed_count;
  int32_t *closed;             /* (closed_count) nodes that touch the ground */
  double *normal;              /* (closed_count) forces of the ground on them [N] */
  strut_settle_summary settle; /* how the scene's start settled; zero where it was not asked to */
} strut_rest_state;

/**
 * name NULL or "start": the equilibrium that the scene's start comes to rest in, where the scene
 * settles the very positions that its run starts from (engine/run/settle.h); "drawn": the drawn
 * shape as it is; else a configuration of the scene: from its positions where it has some, else by
 * a search on its contacts; "n1-n4-2" and the like: from the list that strut_equilibria_find makes
 * with the scene's own effort. All in the arena. Fails with STRUT_USAGE and a suggestion for an
 * unknown name, STRUT_NOT_SETTLED where there is no such equilibrium, naming the nodes that move,
 * STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_rest_state_find(const strut_model *model,
                                             const strut_experiment *experiment, const char *name,
                                             strut_arena *arena, strut_rest_state *rest,
                                             strut_error *error);

/**
 * Moves the nodes' start positions to the equilibrium that the scene names as its start, and sets
 * start_equilibrium to -1. Does nothing if the scene names none. Compiles the scene.
 */
STRUT_API strut_status strut_resolve_start_equilibrium(strut_setup *setup, strut_error *error);

#endif
