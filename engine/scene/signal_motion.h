/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Signals as motions of supports and rotors: the second derivative, and where the value jumps. */
#ifndef STRUT_ENGINE_SCENE_SIGNAL_MOTION_H
#define STRUT_ENGINE_SCENE_SIGNAL_MOTION_H

#include <stdbool.h>

#include "engine/scene/signal.h"

/**
 * Second time derivative of signal `index` at time t [s], from the right where it jumps. Corners and
 * jumps of the signal are not in it.
 */
STRUT_API double strut_signal_acceleration(const strut_signal *signals, int32_t index, double t);

/** Does the value itself jump after t = 0, up to the time `last` [s]? *when: at which time. */
STRUT_API bool strut_signal_value_jumps(const strut_signal *signals, int32_t index, double last,
                                        double *when);

/** Does the rate jump after t = 0 somewhere? */
STRUT_API bool strut_signal_has_corners(const strut_signal *signals, int32_t index);

/** Is the signal a function of the time alone, whose acceleration is known: no expression, nothing that
    lags, is sampled or started? */
STRUT_API bool strut_signal_is_wave(const strut_signal *signals, int32_t index);

#endif
