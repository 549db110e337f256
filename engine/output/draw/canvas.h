/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A page to draw on: SVG, PDF or PNG, whichever its file's name ends with; or pixels in memory.
 *
 * Cairo and Pango draw it. Lengths are points, 1/72 inch; x runs right and y down
 * from the upper left corner. Drawing never fails: strut_canvas_commit reports errors. The same
 * drawing gives the same bytes; there is no date in them.
 */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "engine/base/status.h"

typedef struct strut_canvas strut_canvas;

/** Each from 0 to 1; alpha 0 is nothing at all. */
typedef struct strut_colour {
  double red, green, blue, alpha;
} strut_colour;

/** A rectangle [pt]; x, y is its upper left corner. */
typedef struct strut_box {
  double x, y, width, height;
} strut_box;

/** Style of a line. Zero dash lengths: solid. */
typedef struct strut_pen {
  strut_colour colour;
  double width;   /* [pt] */
  double dash[4]; /* ink, gap, ink, gap [pt]; 0 from the first unused one on */
  bool butt;      /* ends where its last point is; else ends are round */
} strut_pen;

/** Fill of an area: a colour, with hatching in another colour over it; alpha 0: none. */
typedef struct strut_fill {
  strut_colour colour, hatch;
} strut_fill;

/** Style of a text. Font size in pt; 0: 8. */
typedef struct strut_font {
  double size;
  bool bold, italic;
  strut_colour colour; /* alpha 0: black */
  strut_colour halo;   /* drawn around the letters, to be read over lines; alpha 0: none */
  double across;       /* part of the text's width left of x: 0 left, 0.5 centred, 1 right */
  double down;         /* part of its height above y: 0 top, 0.5 middle, 1 bottom */
  bool upwards;        /* turned by a quarter, read from below; across and down turn with it */
  double width;        /* breaks lines at this width [pt]; 0: never */
  int lines;           /* at most, the last one with an ellipsis where it is cut; 0: any number */
} strut_font;

/** A page that becomes the file `path`; `title` goes into the metadata of a PDF. */
STRUT_API strut_status strut_canvas_open(const char *path, double width, double height,
                                         const char *title, strut_canvas **canvas,
                                         strut_error *error);
/** Has an SVG's texts be texts, which programs can edit, rather than outlines. */
STRUT_API void strut_canvas_keep_texts(strut_canvas *canvas);
/** A page of width by height pixels, white, on which `scale` pixels are a point. */
STRUT_API strut_status strut_canvas_open_pixels(int width, int height, double scale,
                                                strut_canvas **canvas, strut_error *error);
/** The canvas's pixels, (height, *stride) bytes: blue, green, red, unused. Owned by the canvas. */
STRUT_API const unsigned char *strut_canvas_pixels(strut_canvas *canvas, size_t *stride);
/** Makes the file appear. */
STRUT_API strut_status strut_canvas_commit(strut_canvas *canvas, strut_error *error);
/** NULL is allowed; a page that was not committed leaves no file. */
STRUT_API void strut_canvas_free(strut_canvas *canvas);

/** Size of the page [pt]. */
STRUT_API strut_box strut_canvas_box(const strut_canvas *canvas);
/** Fills the page with one colour. */
STRUT_API void strut_canvas_clear(strut_canvas *canvas, strut_colour colour);
/** Nothing is drawn outside the box until strut_canvas_unclip. They nest. */
STRUT_API void strut_canvas_clip(strut_canvas *canvas, strut_box box);
STRUT_API void strut_canvas_unclip(strut_canvas *canvas);

/** A line through (count) points. */
STRUT_API void strut_draw_line(strut_canvas *canvas, const double (*points)[2], size_t count,
                               strut_pen pen);
STRUT_API void strut_draw_segment(strut_canvas *canvas, double x1, double y1, double x2, double y2,
                                  strut_pen pen);
/**
 * (count) separate lines in one piece: ends 2 i and 2 i + 1 of (2 count) points belong together.
 */
STRUT_API void strut_draw_segments(strut_canvas *canvas, const double (*ends)[2], size_t count,
                                   strut_pen pen);
/** A closed outline through (count) points; a fill or a pen may be NULL. */
STRUT_API void strut_draw_polygon(strut_canvas *canvas, const double (*points)[2], size_t count,
                                  const strut_fill *fill, const strut_pen *pen);
STRUT_API void strut_draw_box(strut_canvas *canvas, strut_box box, const strut_fill *fill,
                              const strut_pen *pen);
STRUT_API void strut_draw_circle(strut_canvas *canvas, double x, double y, double radius,
                                 const strut_fill *fill, const strut_pen *pen);
/** An arrow from the first to the second point, its head as long as `head` [pt] or the arrow. */
STRUT_API void strut_draw_arrow(strut_canvas *canvas, double x1, double y1, double x2, double y2,
                                double head, strut_pen pen);
/**
 * A text at x, y. Any text is allowed: letters of any script, either direction, no markup. A quantity such
 * as "50 us" is drawn with the Greek letter.
 */
STRUT_API void strut_draw_text(strut_canvas *canvas, double x, double y, const char *text,
                               strut_font font);
/** A text's width and height [pt], unrotated; zero without one. */
STRUT_API strut_box strut_text_box(strut_canvas *canvas, const char *text, strut_font font);

enum { STRUT_HIGHEST_PRIORITY = 3 };
/** A text beside what it names. */
typedef struct strut_label {
  const char *text;
  strut_font font;     /* its across, down and upwards are not used */
  double at[2];        /* what is named [pt] */
  double gap;          /* from there to the text at least [pt] */
  double angle;        /* preferred direction, counterclockwise from the right */
  double steady;       /* how much that matters: 0 not at all, 1 usually */
  strut_box inside;    /* the text stays in here; zero: the page */
  int priority;        /* 0 to STRUT_HIGHEST_PRIORITY; higher ones are placed first */
  bool dot, ring;      /* a filled circle there; an empty one around what is there */
  strut_colour colour; /* of the dot */
} strut_label;
/**
 * Draws a label's dot or ring at once, and its text near its place when all else is drawn (by strut_canvas_commit or _pixels): where it covers
 * no other text and least ink, with a thin line from what is named if that is far. Labels that find no
 * place are left out, and a note on the page counts them.
 */
STRUT_API void strut_draw_label(strut_canvas *canvas, const strut_label *label);

/** Sum of darkness of all that was drawn inside a box but texts [pt^2]. */
STRUT_API double strut_canvas_ink(strut_canvas *canvas, strut_box box);

/**
 * A coordinate [pt] on a grid of 1/64 pt, for decisions of layout: points that differ by rounding get the same one.
 * What is symmetric lies on multiples of 1/2 pt; the rounding changes far from those.
 */
static inline double strut_settle_coordinate(double x) { return floor(64.0 * x + 0.36) / 64.0; }

/* Colours that remain distinguishable in grey print and with colour blindness. */

/** Colour scales of maps and of the bars beside drawings. */
typedef enum strut_colours {
  STRUT_COLOURS_AUTO,       /* of a map: diverging where values have both signs, else sequential */
  STRUT_COLOURS_SEQUENTIAL, /* dark to bright from low to high: time along a path, height of a field */
  STRUT_COLOURS_DIVERGING, /* of areas: from blue over near white at 0 in the middle to brown */
  STRUT_COLOURS_GREY,      /* dark to bright from low to high */
  STRUT_COLOURS_SIGNED /* from deep blue (compression) over grey at 0 to orange: ever brighter, visible on white */
} strut_colours;
/** The colour of `value`, clamped, on a scale from low to high; not AUTO. */
STRUT_API strut_colour strut_palette_at(strut_colours colours, double value, double low,
                                        double high);
/** The i-th colour for unordered things; repeats after STRUT_PALETTE_THINGS. */
STRUT_API strut_colour strut_palette_thing(size_t i);
enum { STRUT_PALETTE_THINGS = 7 };
/** Greys for frames, notes and areas: 0 black to 1 white. */
STRUT_API strut_colour strut_grey(double brightness);
/** The same colour with its opacity multiplied by alpha. */
STRUT_API strut_colour strut_faded(strut_colour colour, double alpha);
