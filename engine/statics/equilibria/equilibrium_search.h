/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the rooms of a search for equilibria share: the level scene, what was found so far.
 */
#ifndef STRUT_ENGINE_STATICS_EQUILIBRIA_EQUILIBRIUM_SEARCH_H
#define STRUT_ENGINE_STATICS_EQUILIBRIA_EQUILIBRIUM_SEARCH_H

#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/equilibria/landscape.h"
#include "engine/statics/equilibria/relax.h"
#include "engine/statics/equilibria/supports.h"

/** Why nothing can rest on the ground as it is. */
typedef enum strut_instability_cause {
  STRUT_INSTABILITY_NONE,
  STRUT_INSTABILITY_FALLS,  /* nothing holds it: no equilibrium at all */
  STRUT_INSTABILITY_SLIDES, /* along the ground, without friction */
  STRUT_INSTABILITY_LIFTED  /* off the ground */
} strut_instability_cause;

/** An equilibrium while it is being found out about. */
typedef struct strut_candidate_equilibrium {
  strut_equilibrium e; /* in level coordinates */
  int32_t group;       /* number of its supports in turn; the real ground's is the last */
  int32_t number;      /* of the point in its search */
  int32_t state;       /* the landscape's minimum that it rests in, or -1; -1 for saddles */
  bool pulls;          /* some support holds it down */
} strut_candidate_equilibrium;

typedef struct strut_equilibrium_search {
  const strut_experiment *experiment;
  const strut_equilibria_options *options;
  strut_equilibria *out;
  strut_error *error;
  strut_level_frame flat;
  strut_model *model; /* of flat.scene */
  strut_supports supports;
  strut_instability_cause unrest;
  bool on_ground;         /* else there is no ground, or nothing presses on it */
  strut_potential *world; /* on the real ground */
  strut_relaxer *relaxer;
  strut_landscape landscape;
  bool explored; /* the landscape is there */
  size_t count, room;
  strut_candidate_equilibrium *finds; /* (room), in out->arena */
} strut_equilibrium_search;

/** A new one at the end; its index, or -1 when memory is out. */
int32_t strut_equilibrium_search_add(strut_equilibrium_search *hunt);

/**
 * Fills in what holds at point's shape: energy, member forces, reactions on `potential`, nodes
 * below. `set` NULL: as the scene itself stands. The point's arrays are copied, its shape oriented.
 */
strut_status strut_equilibrium_search_fill(strut_equilibrium_search *hunt,
                                           strut_candidate_equilibrium *find,
                                           const strut_potential *potential, const uint8_t *held,
                                           const strut_node_set *set,
                                           const strut_critical_point *point);

/** Nodes that touch the ground at q and with what force: contacts, contact_count, normal of e. */
strut_status strut_equilibrium_search_contacts(strut_equilibrium_search *hunt, const double *q,
                                               strut_equilibrium *e);

/** Lets go of the support equilibria that may stand, and judges by where they come to rest. */
strut_status strut_equilibrium_search_follow(strut_equilibrium_search *hunt);

/** Looks whether anything can rest, with a sentence in the remark if not. */
strut_instability_cause strut_equilibrium_search_instability(strut_equilibrium_search *hunt);

/** Verdicts in words, and the remark on what moves freely. Names are given already. */
void strut_report_candidates(strut_equilibrium_search *hunt, strut_candidate_equilibrium *finds,
                             size_t count);

/** More stable equilibria than this do not enter the table. */
enum { STRUT_MOST_BARRIERS_BETWEEN = 12 };

/**
 * Fills the hunt's barriers between every two equilibria that stand, of which configurations name
 * at least some: those named and those one pass away from them; without names the lowest.
 */
strut_status strut_barriers_find(strut_equilibrium_search *hunt);

#endif
