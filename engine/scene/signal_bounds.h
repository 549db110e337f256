/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What signals do over an interval of time, by interval arithmetic: kinks of expressions, and steps that hide nothing.
 *
 * Sensors and internal states stand still meanwhile: how they move is the motion's, and error control sees it.
 */
#ifndef STRUT_ENGINE_SCENE_SIGNAL_BOUNDS_H
#define STRUT_ENGINE_SCENE_SIGNAL_BOUNDS_H

#include "engine/scene/signal_program.h"

typedef struct strut_range {
  double low, high;
} strut_range;

/** All values and rates of a signal over some time; from rounding outwards. */
typedef struct strut_signal_bounds {
  strut_range value, rate;
  bool follows; /* depends on more than the time */
} strut_signal_bounds;

/** Of a program from time `from` to `to` [s], which may be INFINITY; `in` as that of strut_program_evaluate. */
STRUT_API strut_signal_bounds strut_program_bound(const strut_program *program,
                                                  const strut_signal *signals,
                                                  const strut_signal_inputs *in, double from,
                                                  double to);

/**
 * First time after t [s], up to `until`, at which the program may have a kink or a jump as a function of time alone:
 * where the argument of abs, min, max, floor, ceil, round or atan2 passes its edge. Those of its signals are not
 * looked for. INFINITY: none. Where the work allowed does not suffice, a time up to which there is none.
 */
STRUT_API double strut_program_next_kink(const strut_program *program, const strut_signal *signals,
                                         const double *started, double t, double until);

/**
 * The longest step from time t [s], at most h, over which the program's values and rates at begin, middle and end show
 * how it changes between them; changes of less than `faint` of its largest value are left out. Not below `least`.
 */
STRUT_API double strut_program_longest_step(const strut_program *program,
                                            const strut_signal *signals,
                                            const strut_signal_inputs *in, double t, double h,
                                            double faint, double least);

/** The same of signal `index`, in whose own time it is. */
STRUT_API double strut_signal_longest_step(const strut_signal *signals,
                                           const strut_signal_inputs *in, int32_t index, double t,
                                           double h, double faint, double least);

/** Must steps be short enough for the signal? Other waves are smooth between their breaks, and as long as they say. */
STRUT_API bool strut_signal_is_looked_at(const strut_signal *signal);

#endif
