/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Running cables with friction at their guides.
 *
 * Segment k of length l has the material s (rest length) between its two nodes, and the tension
 * T = E (l/s - 1), E = stiffness times rest length, or none where it is slack. The material of all
 * segments is the rest length, which is driven at the first node. At a guide with the turning angle theta
 * the tensions differ by the factor exp(mu theta) at most (capstan): up to there the cable sticks, beyond
 * it slips. Segments joined by slipping guides share their material such that the tensions are at these
 * bounds: an equation for one tension, which has one root.
 *
 * The materials at the accepted positions are the state's history.material; those of the latest evaluation stand
 * behind the element's own slot among the natural strains, below 0 where none are remembered: the cable then slips
 * freely, as statics and settling take it. Methods with events freeze which guides slip, and where to; with others
 * that follows from the tensions. Both kinds renew the materials at the end of each step.
 */
#pragma once

#include "engine/forces/elements.h"

/** Modes of a guide, as state->history.guide_mode holds them: material slips to the first or the last node. */
enum { STRUT_GUIDE_TO_LAST = -1, STRUT_GUIDE_STICKS, STRUT_GUIDE_TO_FIRST, STRUT_GUIDE_FREE };

static inline bool strut_has_capstan(const strut_element *element) {
  return element->guide_friction > 0.0;
}

/** Does the element remember its materials? `rest`: the state's slots. */
static inline bool strut_capstan_remembers(const strut_element *element, const double *rest) {
  return strut_has_capstan(element) && rest[element->slot + 1] >= 0.0;
}

/** Adds its forces at q and v, and its powers. */
void strut_capstan_add_forces(const strut_model *model, const strut_state *state, int32_t i,
                              const double *q, const double *velocity, double *force);
/** Materials from q where none are remembered: equal tensions. */
void strut_capstan_begin(const strut_model *model, strut_state *state, int32_t i, const double *q);
/** Materials after a step, by the tensions at q; what slipping loses goes to the losses. Where nothing but the rest
    length has `jumped`, that is the energy set free. */
void strut_capstan_renew(const strut_model *model, strut_state *state, int32_t i, const double *q,
                         bool jumped);
/** Materials at q by the tensions; nothing is lost. */
void strut_capstan_place(const strut_model *model, strut_state *state, int32_t i, const double *q);
/** Materials after a step in frozen modes, at q. */
void strut_capstan_keep(const strut_model *model, strut_state *state, int32_t i, const double *q);
/** Modes by the tensions and the flows at q and v, of which those of the tensions are renewed. */
void strut_capstan_freeze(const strut_model *model, strut_state *state, int32_t i, const double *q,
                          const double *velocity);
/** A guide at some q and v: how far it is from the end of its mode, as a force [N]; and its turning angle, continued
    through straight from the side on which modes were frozen [rad]. */
typedef struct strut_capstan_guide {
  double margin, bend;
} strut_capstan_guide;
/** All its guides, the first first; `h`: a step [s]. */
void strut_capstan_measure(const strut_model *model, const strut_state *state, int32_t i,
                           const double *q, const double *velocity, double h,
                           strut_capstan_guide *guide);
/** It has passed straight. */
void strut_capstan_pass_straight(const strut_model *model, strut_state *state, int32_t i, int k);
/** How much longer than its material the whole cable is, and the rate: it is slack below 0. */
typedef struct strut_capstan_stretch {
  double stretch, rate;
} strut_capstan_stretch;
strut_capstan_stretch strut_capstan_stretch_of(const strut_model *model, const strut_state *state,
                                               int32_t i, const double *q, const double *velocity);
/** The modes in which it becomes taut at q and v, by the tensions a short time later. */
void strut_capstan_tauten(const strut_model *model, strut_state *state, int32_t i, const double *q,
                          const double *velocity, double soon);
/** Ends the mode of guide k at q. */
void strut_capstan_switch(const strut_model *model, strut_state *state, int32_t i, int k,
                          const double *q);
/** Lets all its guides follow the tensions. */
void strut_capstan_thaw(const strut_model *model, strut_state *state, int32_t i);

/** Tensions of the first and the last segment, and the largest of all, at q [N]. */
typedef struct strut_capstan_ends {
  double first, last, most;
} strut_capstan_ends;
strut_capstan_ends strut_capstan_tensions(const strut_model *model, const strut_state *state,
                                          int32_t i, const double *q, const double *velocity);
/** A cable at rest. */
typedef struct strut_capstan_rest {
  double force[STRUT_MOST_GRADIENT];         /* (2 nodes) on its nodes [N] */
  double tension[STRUT_MOST_ELEMENT_NODES];  /* (segments) [N] */
  double material[STRUT_MOST_ELEMENT_NODES]; /* (segments) after slipping [m] */
  int mode[STRUT_MOST_ELEMENT_NODES];        /* (guides) what slipped to get there */
} strut_capstan_rest;
/** The same at q, where the materials were those in `rest`: guides that hold too much slip. Equal tensions where
    none are remembered. */
void strut_capstan_find_rest(const strut_model *model, int32_t i, const double *rest,
                             const double *q, strut_capstan_rest *found);
/** Elastic energy at q with the materials in `rest` [J]. */
double strut_capstan_energy(const strut_model *model, int32_t i, const double *rest,
                            const double *q);
/** k (2 nodes, 2 nodes): the stiffness along the segments while the cable sticks at all guides. */
void strut_capstan_stiffness(const strut_model *model, int32_t i, const double *q, double *k);
