/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What members remember: breaks, yields, releases, folds, and the forces of Maxwell's branches. */
#pragma once

#include "engine/forces/elements.h"
#include "engine/model/state.h"

/* Elements that remember: those that break or are released, and those that yield.
 *
 * Such an element has a slot of its own among the natural strains, which follows that of its member or
 * hinge. What breaks or is released gets the natural strain INFINITY, by which it carries and stores
 * nothing. An elastic-plastic element is a spring k_1 in series with a slider that gives way at F_1,
 * beside a spring k_2: with the slip p of the slider
 *   force = k_1 (x - p) + k_2 x,  |k_1 (x - p)| <= F_1,  k_1 = k - k_2,  F_1 = yield (1 - k_2/k),
 * which is k x about a natural strain that is k_1/k p larger, and the energy stored in k_1 against k_2.
 * That shift, x - force/k, is the plastic strain: what remains when the force is taken away.
 *
 * An element on a curve that folds keeps the piece on which it is, and its jumps, in slots behind its own.
 *
 * Methods with events freeze whether the slider holds or gives way (state->modes.element_piece); p is then
 * constant, or follows from x. With others the slider gives way within a step as its force says, and p
 * is renewed at the end of each step, at which it is also decided what has broken.
 */

/** Modes of a slider, as state->modes.element_piece holds them; -1: by its force. */
enum { STRUT_SLIDER_BACK, STRUT_SLIDER_HOLDS, STRUT_SLIDER_FORTH };

/** The natural strain of an element that is gone: finite, as kernels multiply it by a stiffness of 0. */
#define STRUT_GONE 1e300

/** Has the element broken or been released, by its natural strain? */
static inline bool strut_element_is_gone(double natural) { return natural == STRUT_GONE; }

/** k_1, F_1 and k_1 / k of an elastic-plastic element. */
static inline double strut_slider_spring(const strut_element *element) {
  return element->numbers.stiffness - element->numbers.second_stiffness;
}
static inline double strut_slider_share(const strut_element *element) {
  return strut_slider_spring(element) / element->numbers.stiffness;
}
static inline double strut_slider_yield(const strut_element *element) {
  return element->numbers.yield * strut_slider_share(element);
}

/** A slider at some strain x = e - e0 of its element. */
typedef struct strut_slider {
  double force, yield; /* k_1 (x - p), and F_1 */
  double rate;         /* dx/dt */
  double plastic;      /* p that would bring the force back to the yield */
  bool acts;           /* the element is on the side that it carries */
} strut_slider;
/** Of elastic-plastic element i at q and v. */
strut_slider strut_slider_at(const strut_model *model, const strut_state *state, int32_t i,
                             const double *q, const double *velocity);
/** Sets its mode; p follows from q where it holds from now on. */
void strut_slider_set(const strut_model *model, strut_state *state, int32_t i, int mode,
                      const double *q);
/**
 * Brings a slider that is beyond its yield at q back to it. Adds to the losses what its own force does,
 * or, where something has jumped, all the energy that disappears.
 */
void strut_slider_return(const strut_model *model, strut_state *state, int32_t i, const double *q,
                         bool jumped);

/**
 * Keeps the piece of its curve on which element i is at q, for one that no method with events has frozen.
 * The energy that jumps at folds set free is lost. t: when, or NAN before a run begins, where no jump counts.
 */
void strut_curve_renew(const strut_model *model, strut_state *state, int32_t i, const double *q,
                       double t);
/** Where and when an element leaves its piece, over its end (way 1) or its begin (-1). */
typedef struct strut_crossing {
  int way;
  double x, time;
} strut_crossing;
/** The piece that element i, frozen on one, goes to; likewise. */
int strut_curve_pass(const strut_model *model, strut_state *state, int32_t i, strut_crossing at);

/** The natural strain of element i, with memory, at strain e, with the state's base slots and modes. */
double strut_history_natural(const strut_model *model, const strut_state *state, int32_t i,
                             double e);
/** Energy that is stored in the slider's spring against the one beside it, by the slots in `rest`. */
double strut_history_locked_energy(const strut_element *element, const double *rest);

/** As strut_elements_add_forces, for a block of elements with memory. */
void strut_history_add_forces(const strut_model *model, const strut_state *state,
                              const strut_element_block *block, const double *q,
                              const double *velocity, double *force);
/** Own slots after the slots that they follow have changed. */
void strut_history_follow(const strut_model *model, const strut_state *state);

/** After a step in frozen modes has been accepted: sliders that give way and cables at guides, at the state's q. */
void strut_history_keep(const strut_model *model, strut_state *state);

/** Size of what the elements of a model remember. */
static inline size_t strut_history_count(const strut_model *model) {
  const strut_element_table *elements = &model->elements;
  return (size_t)(2 * elements->history_slots + elements->history_count +
                  elements->breakable_count);
}
/** Copies it from a state, and back. */
STRUT_API void strut_history_store(const strut_model *model, const strut_state *state,
                                   double *memory);
STRUT_API void strut_history_load(const strut_model *model, strut_state *state,
                                  const double *memory);

/** Tension of a member, or size of a hinge's moment, that may break it [N], [N m]. */
double strut_breakable_load(const strut_model *model, const strut_state *state, int32_t breakable,
                            const double *q, const double *velocity);
/** Takes it out from time t on. The energy that it held is lost. */
void strut_breakable_break(const strut_model *model, strut_state *state, int32_t breakable,
                           double t);
/** Releases what is due at time t [s]. True if something was. */
bool strut_history_release(const strut_model *model, strut_state *state, double t);

/** A member or a hinge that carries more than it can. */
typedef struct strut_overload {
  const char *kind, *name; /* "member", "hinge", ...; owned by the scene */
  bool hinge;
  bool breaks;         /* the limit is that of breaking; otherwise of yielding */
  double force, limit; /* sizes [N] or [N m] */
} strut_overload;
/**
 * The worst overload at rest at positions q, where statics take everything as whole and elastic; false
 * where there is none.
 */
STRUT_API bool strut_history_overload(const strut_model *model, const double *q,
                                      strut_overload *worst);

/** Tension at the last node of element i: of a cable with guide friction another than at its first. */
double strut_element_last_force(const strut_model *model, const strut_state *state, int32_t i);
/** Plastic strain of an element, k_1/k p; 0 of one that cannot yield. */
double strut_element_plastic(const strut_model *model, const strut_state *state, int32_t element);

/**
 * After a plain step that ends at time t: what has yielded, broken or is to be released. True if forces
 * have jumped by that.
 */
bool strut_history_renew(const strut_model *model, strut_state *state, double t);
/**
 * What elements remember at time t within a step, at the state's q and v, from what they did at its begin; the method
 * has frozen their modes, or not. Nothing breaks. Losses are not those of the step.
 */
void strut_history_place(const strut_model *model, strut_state *state, const double *memory,
                         double t, bool frozen);
/** Before the first step: what is beyond its force already, or due. Keeps no balance. */
STRUT_API void strut_history_begin(const strut_model *model, strut_state *state, double t);

/* Maxwell branches of members: a spring k and a dashpot c in a row. The force F is an internal state,
 * F' = k (u' - F / c), with the rate u' of the member's length beyond its rest length. F^2 / 2k is stored
 * and F^2 / c lost.
 */

/**
 * Adds the forces of all branches at q and v and the rates of these forces to `force`, and with the
 * balance their powers. The driven rest lengths must be those of this instant.
 */
void strut_maxwell_apply(const strut_model *model, const strut_state *state, const double *q,
                         const double *velocity, double *force);
/** Force of the branch of a member, tension positive [N]; 0 without one. */
double strut_maxwell_force(const strut_model *model, const double *velocity, int32_t member);
/** Energy stored in all of them [J]. */
double strut_maxwell_energy(const strut_model *model, const double *velocity);
