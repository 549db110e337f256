/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Colours that stay apart in grey and to colour-blind eyes.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_PALETTE_H
#define STRUT_ENGINE_OUTPUT_DRAW_PALETTE_H

#include "engine/output/draw/canvas.h"

/**
 * A signed quantity, -1 to 1 (beyond: as the end), such as a force over the largest: from deep blue
 * (compression) over grey to orange (tension), growing brighter all the way, so that grey tells the
 * sign too; never so bright that it is lost on white.
 */
STRUT_API strut_colour strut_palette_signed(double value);
/** A quantity from 0 to 1, dark to bright: time along a way, height of a field. */
STRUT_API strut_colour strut_palette_sequence(double value);
/** The i-th of things without order; from STRUT_PALETTE_THINGS on they come again. */
STRUT_API strut_colour strut_palette_thing(size_t i);
enum { STRUT_PALETTE_THINGS = 7 };
/** Greys for frames, notes and areas: 0 black to 1 white. */
STRUT_API strut_colour strut_grey(double brightness);
/** The same colour, that much opaque. */
STRUT_API strut_colour strut_faded(strut_colour colour, double alpha);

#endif
