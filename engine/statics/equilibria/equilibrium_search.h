/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The state of a search for equilibria: the level scene and the candidates found so far.
 */
#ifndef STRUT_ENGINE_STATICS_EQUILIBRIA_EQUILIBRIUM_SEARCH_H
#define STRUT_ENGINE_STATICS_EQUILIBRIA_EQUILIBRIUM_SEARCH_H

#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/equilibria/landscape.h"
#include "engine/statics/equilibria/relax.h"
#include "engine/statics/equilibria/supports.h"

/** Why the structure cannot rest on the ground. */
typedef enum strut_instability_cause {
  STRUT_INSTABILITY_NONE,
  STRUT_INSTABILITY_FALLS,  /* nothing holds it: no equilibrium at all */
  STRUT_INSTABILITY_SLIDES, /* along the ground, without friction */
  STRUT_INSTABILITY_LIFTED  /* off the ground */
} strut_instability_cause;

/** An equilibrium under examination. */
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
  strut_level_frame level;
  strut_model *model; /* of level.scene */
  strut_supports supports;
  strut_instability_cause instability;
  bool on_ground;             /* else there is no ground, or nothing presses on it */
  strut_potential *potential; /* on the real ground */
  strut_relaxer *relaxer;
  strut_landscape landscape;
  bool explored; /* the landscape is there */
  size_t count, room;
  strut_candidate_equilibrium *candidates; /* (room), in out->arena */
} strut_equilibrium_search;

/** Appends a candidate; returns its index, or -1 if memory is out. */
int32_t strut_equilibrium_search_add(strut_equilibrium_search *search);

/**
 * Fills in what holds at point's shape: energy, member forces, reactions on `potential`, nodes
 * below. `set` NULL: as the scene itself stands. The point's arrays are copied, its shape oriented.
 */
strut_status strut_equilibrium_search_fill(strut_equilibrium_search *search,
                                           strut_candidate_equilibrium *find,
                                           const strut_potential *potential, const uint8_t *held,
                                           const strut_node_set *set,
                                           const strut_critical_point *point);

/** Nodes that touch the ground at q and with what force: contacts, contact_count, normal of e. */
strut_status strut_equilibrium_search_contacts(strut_equilibrium_search *search, const double *q,
                                               strut_equilibrium *e);

/**
 * Releases the candidates that may stand from their supports and judges them by where they come to
 * rest.
 */
strut_status strut_equilibrium_search_follow(strut_equilibrium_search *search);

/** Checks whether the structure can rest at all; if not, writes the cause to the remark. */
strut_instability_cause strut_equilibrium_search_instability(strut_equilibrium_search *search);

/** Writes the verdicts and the remark on free motions. Candidates must be named already. */
void strut_report_candidates(strut_equilibrium_search *search, strut_candidate_equilibrium *finds,
                             size_t count);

/** More stable equilibria than this do not enter the table. */
enum { STRUT_MOST_BARRIERS_BETWEEN = 12 };

/**
 * Fills search->out->barriers between every two stable equilibria of which configurations name
 * at least some: those named and those one pass away from them; without names the lowest.
 */
strut_status strut_barriers_find(strut_equilibrium_search *search);

#endif
