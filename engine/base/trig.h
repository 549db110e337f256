/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Sine and cosine of an angle in turns, with the same bits on every machine.
 *
 * libm picks another routine where the processor has fused multiply-add, so its last bit may change
 * from machine to machine. These use plain products and sums only. Because the angle comes in turns
 * (cycles), its reduction is exact: a drive of f hertz at t seconds needs the turns f*t, and no
 * multiple of pi is ever subtracted.
 */
#ifndef STRUT_ENGINE_BASE_TRIG_H
#define STRUT_ENGINE_BASE_TRIG_H

#include "engine/base/export.h"

/** sine = sin(2 pi turns), cosine = cos(2 pi turns); error below 1.5 units in the last place of 1. */
STRUT_API void strut_sincos_turns(double turns, double *sine, double *cosine);

#endif
