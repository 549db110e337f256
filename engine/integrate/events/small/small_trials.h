/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Steps of small models between events, see engine/model/small_model.h; with the bits of the general methods.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_TRIALS_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_TRIALS_H

#include "engine/integrate/events/small/small_modes.h"

/** A step from l->now at time t over h to l->next; with error control its stages' margins into l->least. */
typedef void strut_small_trial(const strut_model *model, strut_state *state, strut_event_stepper *l,
                               double t, double h);

strut_small_trial strut_small_adaptive_avx2, strut_small_adaptive_avx512;
strut_small_trial strut_small_rk4_events_avx2, strut_small_rk4_events_avx512;

/** Steps up to grid point `end` until something happens: see a step formula's advance_until_event. */
typedef void strut_small_quiet(const strut_model *model, strut_state *state, strut_event_stepper *l,
                               double dt, int64_t end);

strut_small_quiet strut_small_verlet_events_avx2, strut_small_verlet_events_avx512;
strut_small_quiet strut_small_adaptive_quiet_avx2, strut_small_adaptive_quiet_avx512;
strut_small_quiet strut_small_rk4_events_quiet_avx2, strut_small_rk4_events_quiet_avx512;

/** The function of that name; NULL where the general kernel steps. Variations need its stages. */
#if defined(__x86_64__)
#define STRUT_SMALL_EVENTS(model, state, l, name)                                                  \
  (!strut_small_modes_of(model, state, l) || (state)->watched.variation ? NULL                     \
   : (model)->small->level == STRUT_SMALL_AVX512                        ? name##_avx512            \
                                                                        : name##_avx2)
#else
#define STRUT_SMALL_EVENTS(model, state, l, name) NULL
#endif

/** May the methods that locate events exactly make quiet steps in registers? Cables are checked by the
    general code, and so are switches that follow each other without end. */
static inline bool strut_small_is_quiet(const strut_state *state, const strut_event_stepper *l) {
  return !l->law_count && !state->watched.event_log && l->switches < STRUT_MOST_SWITCHES;
}

#endif
