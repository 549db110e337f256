/* SPDX-License-Identifier: GPL-3.0-or-later */
/** One equilibrium on the real ground, by name, for modes, matrices and starts of runs. */
#pragma once

#include "engine/base/flag.h"
#include "engine/model/model.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"
#include "engine/statics/search/critical_point.h"

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

/* All equilibria of a scene by the paper's method: on static supports (12), then their outcome on
 * the real ground, and the barriers between the stable ones.
 */

typedef enum strut_outcome {
  STRUT_OUTCOME_STANDS,       /* rests on the contacts it was found with */
  STRUT_OUTCOME_TIPS,         /* comes to rest elsewhere */
  STRUT_OUTCOME_BELOW_GROUND, /* set aside: nodes lie under the ground */
  STRUT_OUTCOME_UNSTABLE,     /* a saddle or maximum: not followed */
  STRUT_OUTCOME_FLOPPY,
  STRUT_OUTCOME_NO_REST /* did not come to rest: falls, slides */
} strut_outcome;
/** "stands", "tips", "below ground", "unstable", "floppy", "no rest". */
STRUT_API const char *strut_outcome_name(strut_outcome outcome);

/** One equilibrium: on held contacts (supports not NULL), or as the scene itself stands. */
typedef struct strut_equilibrium {
  const char *name;               /* unique in the list; see strut_name_equilibria */
  bool configured;                /* a configuration of the scene gave the name */
  const strut_node_set *supports; /* contact nodes held, or NULL */
  strut_critical_point point;     /* shape, label, eigenvalues, starts; `down` in the list */
  double energy;                  /* (13) [J] */
  double (*reaction)[2];          /* (node_count) of supports, the scene's own too [N] */
  uint8_t *below;                 /* (node_count) 1 where under the ground */
  double *member_force;           /* (member_count) tension positive [N] */
  strut_outcome outcome;
  int32_t tips_over;    /* node about which it turns, or -1 */
  int32_t ends_as;      /* the equilibrium it ends in, or -1; itself if it stands */
  double *rest;         /* (length) where it comes to rest on the real ground, or NULL */
  double rest_energy;   /* (13) there [J] */
  double rest_residual; /* largest net force there [N] */
  double friction;      /* coefficient that holds it there along the ground; 0: it needs none [1] */
  int32_t contact_count;
  int32_t *contacts; /* nodes that touch at the end; before it is followed: supports */
  double *normal;    /* (contact_count) [N] */
  int32_t overlap;   /* collision whose bodies lie in each other here, or -1 */
  int32_t through;   /* collision: of a saddle, on a way down from it; of others, on every known way
                        here from where the drawn shape comes to rest; or -1 */
  bool collapsed;    /* two nodes coincide, or a member has no length, within 1e-4 model sizes */
  int32_t crossings; /* pairs of members that cross, away from their ends */
  char verdict[208]; /* in words: "stands", "tips over n4 onto n2, n4: II", ... */
} strut_equilibrium;

/** The lowest known path between two stable equilibria on the real ground. */
typedef struct strut_barrier {
  int32_t from, to; /* in the list */
  double height;    /* [J] above `from` */
  int32_t saddle;   /* the highest saddle on the path, in the list */
  int32_t via_count;
  int32_t *via;  /* (via_count) stable or floppy equilibria in between, in the list, or -1 */
  double direct; /* [J] of the lowest saddle that connects them directly; NAN: unknown */
  int32_t direct_saddle; /* in the list, or -1 */
} strut_barrier;

typedef struct strut_equilibria {
  size_t count;
  bool shows_all;          /* what people read lists those that do not stand, too */
  strut_equilibrium *list; /* by supports in the scene's order; those of the real ground last */
  size_t barrier_count;
  strut_barrier *barriers;
  uint64_t seed;
  int64_t starts;
  strut_missed missed;         /* stable ones not found: the largest over the searches */
  int64_t unmet;               /* stable ones, over all searches, that no random start met */
  int64_t unseen;              /* at least as many more exist in all of them, each at 95 % */
  bool cut_short;              /* some search ended early, for the structure's size */
  bool climbs;                 /* passes between stable ones were looked for */
  strut_settle_summary settle; /* how the scene's start settled; zero where it was not asked to */
  int32_t start;               /* the equilibrium it settled in, or -1: not in the list */
  char start_trouble[600];     /* why the start did not come to rest; else empty */
  char remark[400];            /* why no equilibrium was found, or what moves freely; else empty */
  strut_arena arena;
} strut_equilibria;
/** Rows of a strut_equilibria. */
STRUT_API extern const strut_value_rows strut_equilibria_values;

typedef struct strut_equilibria_options {
  int64_t starts;                 /* 0: as the experiment says */
  const uint64_t *seed;           /* NULL: as the experiment says */
  const strut_node_set *supports; /* NULL: as the experiment says */
  bool standing_only;             /* only equilibria that stand: no saddles, no barriers */
  const strut_flag *interrupt;
} strut_equilibria_options;

/** strut_equilibria_free releases it, after a failure too. The model must outlive it. */
STRUT_API strut_status strut_equilibria_find(const strut_model *model,
                                             const strut_experiment *experiment,
                                             const strut_equilibria_options *options,
                                             strut_equilibria *equilibria, strut_error *error);
STRUT_API void strut_equilibria_free(strut_equilibria *equilibria);
