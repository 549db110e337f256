/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Colours that remain distinguishable in grey print and with colour blindness.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_PALETTE_H
#define STRUT_ENGINE_OUTPUT_DRAW_PALETTE_H

#include "engine/output/draw/canvas.h"

/**
 * A signed quantity from -1 to 1 (clamped), such as a force relative to the largest: from deep blue
 * (compression) over grey to orange (tension). Brightness increases throughout, so that grey print
 * shows the sign too, and stays visible on white.
 */
STRUT_API strut_colour strut_palette_signed(double value);
/** A quantity from 0 to 1, dark to bright: time along a path, height of a field. */
STRUT_API strut_colour strut_palette_sequence(double value);
/** A signed quantity that fills areas, -1 to 1: from blue over near white at 0 to brown. */
STRUT_API strut_colour strut_palette_diverging(double value);

/** Colour scales of maps and of the bars beside drawings. */
typedef enum strut_colours {
  STRUT_COLOURS_AUTO,       /* of a map: diverging where values have both signs, else sequential */
  STRUT_COLOURS_SEQUENTIAL, /* strut_palette_sequence from low to high */
  STRUT_COLOURS_DIVERGING,  /* strut_palette_diverging, 0 in the middle */
  STRUT_COLOURS_GREY,       /* dark to bright from low to high */
  STRUT_COLOURS_SIGNED      /* strut_palette_signed, 0 in the middle */
} strut_colours;
/** The colour of `value` on a scale from low to high; not AUTO. */
STRUT_API strut_colour strut_palette_at(strut_colours colours, double value, double low,
                                        double high);
/** The i-th colour for unordered things; repeats after STRUT_PALETTE_THINGS. */
STRUT_API strut_colour strut_palette_thing(size_t i);
enum { STRUT_PALETTE_THINGS = 7 };
/** Greys for frames, notes and areas: 0 black to 1 white. */
STRUT_API strut_colour strut_grey(double brightness);
/** The same colour with its opacity multiplied by alpha. */
STRUT_API strut_colour strut_faded(strut_colour colour, double alpha);

#endif
