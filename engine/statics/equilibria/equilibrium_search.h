/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the rooms of a search for equilibria share: the level scene, what was found so far.
 */
#ifndef STRUT_ENGINE_STATICS_EQUILIBRIA_EQUILIBRIUM_SEARCH_H
#define STRUT_ENGINE_STATICS_EQUILIBRIA_EQUILIBRIUM_SEARCH_H

#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/equilibria/level_frame.h"
#include "engine/statics/equilibria/landscape.h"
#include "engine/statics/equilibria/relax.h"
#include "engine/statics/equilibria/supports.h"

/** Why nothing can rest on the ground as it is. */
typedef enum strut_unrest {
  STRUT_UNREST_NONE,
  STRUT_UNREST_FALLS,  /* nothing holds it: no equilibrium at all */
  STRUT_UNREST_SLIDES, /* along the ground, without friction */
  STRUT_UNREST_LIFTED  /* off the ground */
} strut_unrest;

/** An equilibrium while it is being found out about. */
typedef struct strut_find {
  strut_equilibrium e; /* in level coordinates */
  int32_t group;       /* number of its supports in turn; the real ground's is the last */
  int32_t number;      /* of the point in its search */
  int32_t state;       /* the landscape's minimum that it rests in, or -1; -1 for saddles */
  bool pulls;          /* some support holds it down */
} strut_find;

typedef struct strut_hunt {
  const strut_equilibria_options *options;
  strut_equilibria *out;
  strut_error *error;
  strut_flat flat;
  strut_model *model;     /* of flat.scene */
  strut_supports supports;
  strut_unrest unrest;
  bool on_ground;         /* else there is no ground, or nothing presses on it */
  strut_potential *world; /* on the real ground */
  strut_relaxer *relaxer;
  strut_landscape landscape;
  bool explored; /* the landscape is there */
  size_t count, room;
  strut_find *finds; /* (room), in out->arena */
} strut_hunt;

/** A new one at the end; its index, or -1 when memory is out. */
int32_t strut_hunt_add(strut_hunt *hunt);

/**
 * Fills in what holds at point's shape: energy, member forces, reactions on `potential`, nodes
 * below. `set` NULL: as the scene itself stands. The point's arrays are copied, its shape oriented.
 */
strut_status strut_hunt_fill(strut_hunt *hunt, strut_find *find, const strut_potential *potential,
                             const uint8_t *held, const strut_node_set *set,
                             const strut_critical_point *point);

/** Nodes that touch the ground at q and with what force: contacts, contact_count, normal of e. */
strut_status strut_hunt_contacts(strut_hunt *hunt, const double *q, strut_equilibrium *e);

/** Lets go of the support equilibria that may stand, and judges by where they come to rest. */
strut_status strut_hunt_follow(strut_hunt *hunt);

/** Looks whether anything can rest, with a sentence in the remark if not. */
strut_unrest strut_hunt_look_for_unrest(strut_hunt *hunt);

/** Verdicts in words, and the remark on what moves freely. Names are given already. */
void strut_hunt_say(strut_hunt *hunt, strut_find *finds, size_t count);

#endif
