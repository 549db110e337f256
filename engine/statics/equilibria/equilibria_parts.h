/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the search for equilibria is made of: the landscape, supports, relaxation, the search itself, and names.
 */
#pragma once

#include "engine/base/flag.h"
#include "engine/scene/experiment.h"
#include "engine/scene/scene.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/minimise.h"
#include "engine/statics/search/critical.h"

/* The stationary points of one potential as a landscape: basins, and the passes between them. */

typedef struct strut_landscape {
  const strut_potential *potential;
  bool merged; /* congruent shapes are one point, mirror images too */
  strut_critical_set set;
  int32_t minima; /* stable and floppy points: the first ones of the set */
  int32_t
      *through; /* (set.count) a collision that a saddle's ways down lead through, or -1; NULL: the
                        scene has no collision */
  double *lowest;    /* (minima) potential of the lowest pass out of it [J]; HUGE_VAL: none known */
  int32_t *parent;   /* (minima) scratch of the path searches below */
  strut_arena arena; /* of the above */
} strut_landscape;

/** strut_landscape_free releases it, after a failure too. */
strut_status strut_landscape_create(const strut_potential *potential,
                                    const strut_critical_effort *effort, strut_landscape *landscape,
                                    strut_error *error);
void strut_landscape_free(strut_landscape *landscape);

/** The minimum that the shape q (length) is, or -1. */
int32_t strut_landscape_find(const strut_landscape *landscape, const double *positions);

/**
 * Potential energy of the lowest known pass out of the basin of the minimum q [J]; -INFINITY if none is known: then the
 * end of a motion is known only when it has died down.
 */
double strut_landscape_pass(const strut_landscape *landscape, const double *positions);

/**
 * Index of the highest saddle on the lowest path from minimum a to minimum b; -1 if the known
 * saddles do not connect them. Saddles that lead through a collision are none.
 */
int32_t strut_landscape_path(const strut_landscape *landscape, int32_t a, int32_t b);

/* Where a change of shape pushes the bodies of a collision through each other.
 *
 * Collisions are springs of finite stiffness, and two rods that cross touch nowhere, so that the potential alone
 * keeps no body out of another. Two rods pass through each other where an end of one meets the axis of the
 * other, a node and a rod where the node does, two nodes where they come closer than half of the thickness.
 */

/** The first collision whose axes cross in the shape q (length), or come closer than half of the thickness;
    -1: none. */
int32_t strut_overlap_find(const strut_model *model, const double *positions);

/** The first collision whose bodies pass through each other while all nodes move straight from a to b (length);
    -1: none. */
int32_t strut_passage_find(const strut_model *model, const double *first, const double *second);

/** The first collision of two rods that cross in one of the shapes a and b (length) only; -1: none. No motion
    leads from one to the other without pushing an end of one rod through the other. */
int32_t strut_crossing_find(const strut_model *model, const double *first, const double *second);

/* The scene as statics sees it: nothing moves by itself, the ground is level, and static supports
 * may take the ground's place, as in (12): contact nodes held in turn.
 */

typedef struct strut_level_frame {
  strut_scene scene;    /* without actuators, loads on a signal, friction and belt; in coordinates
                          along and across the ground. Shares texts with the original */
  double shift[2];      /* by which the original is moved from the origin of the scene [m] */
  double cosine, sine;  /* of the slope that was turned away: 1, 0 on level ground */
  int32_t oblique_node; /* held in one direction on a slope: nothing is turned; or -1 */
  strut_arena arena;
} strut_level_frame;

/** The original must outlive it; strut_level_frame_free. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_level_frame_create(const strut_scene *original, strut_level_frame *level,
                                      strut_error *error);
void strut_level_frame_free(strut_level_frame *level);

/** Brings count points (x, y) of the level scene to where they are in the original, in place. */
void strut_level_frame_place(const strut_level_frame *level, size_t count, double *xy);
/** What gravity and loads do along that shift [J]; `weight`: of the nodes [kg]. */
double strut_level_frame_work(const strut_level_frame *level, const double *weight);
/** Turns count vectors (x, y) between level and original coordinates, in place. */
void strut_level_frame_to_original(const strut_level_frame *level, size_t count, double *xy);

/** More sets than this are not tried unless the scene names them. */
enum { STRUT_MOST_SUPPORTS = 120 };

typedef struct strut_supports {
  size_t count;         /* 0: the real ground alone */
  strut_node_set *sets; /* (count) */
  bool pin;             /* the first of each set is held along the ground too, the others roll */
  bool loose;           /* the scene itself holds no coordinate: shapes may be turned and moved */
  bool many;            /* there would be more sets than STRUT_MOST_SUPPORTS */
} strut_supports;

/**
 * The sets for a scene on level ground: `wanted`, else those the scene names, else every set of as
 * many contact nodes as it takes to hold the rigid motions that the scene leaves free: pairs where
 * it holds nothing, single nodes where one motion is left, none where its own supports suffice.
 * Arrays in the arena. STRUT_OK, STRUT_NO_MEMORY, or STRUT_USAGE for a wanted node that cannot
 * touch.
 */
strut_status strut_supports_choose(const strut_scene *level, const strut_search *search,
                                   const strut_node_set *wanted, strut_arena *arena,
                                   strut_supports *supports, strut_error *error);

/** Sets held (2 node_count and more) to 1 where a set holds a coordinate, else leaves it. */
void strut_supports_hold(const strut_supports *supports, const strut_node_set *set, uint8_t *held);

/**
 * Places a shape (node_count) on a set: the first node on the ground line at the x it is drawn at,
 * the second on the line, by a rigid motion where the scene allows one, else node by node.
 */
void strut_supports_place(const strut_supports *supports, const strut_scene *level,
                          const strut_node_set *set, double (*shape)[2]);

/* Dynamic relaxation on the real ground: where (10) without drive and friction comes to rest.
 *
 * The model itself is simulated, with no damping but its own, until it can end in one place only;
 * Newton's method then converges to it. The result is that of the undamped model, at less cost.
 */

typedef enum strut_relaxed_end {
  STRUT_RELAXED_RESTS,
  STRUT_RELAXED_LEAVES, /* moves off without end: falls, slides, is lifted */
  STRUT_RELAXED_MOVES   /* still moves after the experiment's settle.limit, or 1e7 steps */
} strut_relaxed_end;

typedef struct strut_relaxed {
  strut_relaxed_end end;
  double residual; /* largest net force at rest [N] */
} strut_relaxed;

/** Memory of relaxations of one model, for one thread at a time. */
typedef struct strut_relaxer strut_relaxer;
/**
 * potential: of a model without actuators, friction and loads on a signal, its ground included. It
 * must outlive the relaxer. limit: of the time that a relaxation simulates [s]. Simulated are
 * models with mass, some damping and up to STRUT_DENSE_STATICS free coordinates; others go downhill
 * from where they are.
 */
strut_status strut_relaxer_create(const strut_potential *potential, double limit,
                                  strut_relaxer **relaxer, strut_error *error);
void strut_relaxer_free(strut_relaxer *relaxer);

/**
 * Lets go of q (length) with no velocity; at the end it is the shape at rest, its centre of mass
 * where the motion has left it along the ground. passes: a landscape, or NULL. STRUT_OK or STRUT_INTERRUPTED.
 */
strut_status strut_relax(strut_relaxer *relaxer, double *positions, const strut_landscape *passes,
                         const strut_flag *interrupt, strut_relaxed *relaxed, strut_error *error);

/** The same, but of a q next to a minimum, and of a model that is not simulated, straight downhill. */
strut_status strut_relax_nearby(strut_relaxer *relaxer, double *positions,
                                const strut_flag *interrupt, strut_relaxed *relaxed,
                                strut_error *error);

/* The state of a search for equilibria: the level scene and the candidates found so far. */

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
  bool held_by_friction; /* it slides without friction, and friction can hold it */
  double *grip;   /* (contacts) largest friction over push against the pull along the ground */
  bool on_ground; /* else there is no ground, or nothing presses on it */
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

/** Nodes that the ground pushes, of one with several contacts the sum [N]. */
typedef struct strut_node_pushes {
  int32_t count, *node;
  double *normal;
} strut_node_pushes;
/** By more than `least` at q. False: out of memory. */
bool strut_closed_contacts(const strut_model *model, const double *positions, double least,
                           strut_arena *arena, strut_node_pushes *pushes);
/** Nodes that touch the ground at q and with what force: contacts, contact_count, normal of e. */
strut_status strut_equilibrium_search_contacts(strut_equilibrium_search *search,
                                               const double *positions,
                                               strut_equilibrium *equilibrium);

/**
 * Releases the candidates that may stand from their supports and judges them by where they come to
 * rest.
 */
strut_status strut_equilibrium_search_follow(strut_equilibrium_search *search);

/** Does the shape `rest` (length) of a candidate stand, on all of its supports, much as it was found on them? */
bool strut_equilibrium_search_stands(const strut_equilibrium_search *search,
                                     const strut_candidate_equilibrium *find, const double *rest);

/** Can friction hold what slides without it? Fills in `grip`; the friction is that of `scene`. */
strut_status strut_equilibrium_search_grips(strut_equilibrium_search *search,
                                            const strut_scene *scene, bool *hold);

/** Judges a candidate that may stand by whether friction holds it as its supports did. */
strut_status strut_equilibrium_search_hold(strut_equilibrium_search *search,
                                           strut_candidate_equilibrium *find);

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

/* Names for equilibria: a scene's configurations, by contacts and shape; and which way round a
 * shape that has a mirror image is shown.
 */

/** By energy, and for equal energies by shape, so that no start matters. */
bool strut_equilibrium_comes_before(const strut_model *model, const strut_equilibrium *first,
                                    const strut_equilibrium *second);

/** Largest distance of a shape from the configuration that names it, in model sizes. */
#define STRUT_NAMED_WITHIN 0.05

/**
 * Of a shape q and its mirror image, where that is an equilibrium too (nothing acts along x, and
 * all that is held along x shares one x), takes the one that is nearest to a configuration, else to
 * the drawn shape; softest (may be NULL) goes with it. held: (length) coordinates held besides the
 * scene's. STRUT_OK or STRUT_NO_MEMORY.
 */
strut_status strut_orient_shape(const strut_model *model, const uint8_t *held, double *positions,
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

/** Is the node among these? */
static inline bool strut_is_listed(const int32_t *nodes, int32_t count, int32_t node) {
  for (int32_t k = 0; k < count; k++)
    if (nodes[k] == node) return true;
  return false;
}

/** Do the nodes that touch make one of the configuration's contact sets, in any order? True where it has none. */
bool strut_rests_on_set(const strut_configuration *configuration, const int32_t *nodes,
                        int32_t count);

/** Writes "n1, n2 and n3" for the nodes with a flag; many become "n1, n2, n3 and 5 more". */
void strut_list_nodes(const strut_scene *scene, const uint8_t *flag, size_t size, char *text);
