/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What charts are made of: axes with ticks, frames, scales of colours. figure.h describes whole ones. */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_CHART_H
#define STRUT_ENGINE_OUTPUT_DRAW_CHART_H

#include <math.h>

#include "engine/output/buffer.h"
#include "engine/output/draw/canvas.h"

/* Axes: from a quantity's range to ticks, labels and a place on the page, with no tuning. */

/** One axis as wanted. Its label reads "name in prefix unit", such as "velocity in mm/s". */
typedef struct strut_axis {
  const char *name, *unit; /* the values' SI unit; "" for none. A prefix is chosen for the ticks */
  bool logarithmic;
  double low, high; /* the range; both NAN: from the data, with a little room */
  const char *const
      *names; /* (name_count) of categories at 0, 1, ..., instead of numbers; or NULL */
  size_t name_count;
} strut_axis;

/** A linear axis whose range comes from the data. */
static inline strut_axis strut_axis_of(const char *name, const char *unit) {
  strut_axis axis = {name, unit, false, (double)NAN, (double)NAN, NULL, 0};
  return axis;
}

/** A label and a range that replace those of an axis. Zero-initialised: none. */
typedef struct strut_axis_choice {
  const char *label; /* replaces the name; the unit still follows; NULL: the name stays */
  bool limited;      /* the axis goes from low to high, in its unit */
  double low, high;
} strut_axis_choice;

/** A pair of axes laid out in a box. strut_axes_place makes it. */
typedef struct strut_axes {
  strut_axis x, y; /* ranges settled */
  strut_box frame; /* where data go [pt] */
} strut_axes;

/**
 * Whether values from low to high [unit] differ by rounding noise only and are drawn as a constant;
 * a length or velocity far below an atom's size becomes zero.
 */
STRUT_API bool strut_is_noise(double *low, double *high, const char *unit);
/**
 * Widens an axis whose range is from the data by a value; values that are not finite are ignored.
 */
STRUT_API void strut_axis_include(strut_axis *axis, double value);
/**
 * Turns the included values into a range that can be drawn: not empty, positive on a logarithmic
 * axis, 0 to 1 where nothing was included; widened by `room` of its width on either side.
 */
STRUT_API void strut_axis_settle(strut_axis *axis, double room);
/** Replaces the name and, after strut_axis_settle, the range of an axis where `choice` has one. */
STRUT_API void strut_axis_choose(strut_axis *axis, const strut_axis_choice *choice);
/** Lays out a frame for settled axes in `box`; panels side by side line up when their boxes do. */
STRUT_API strut_axes strut_axes_place(strut_canvas *canvas, strut_box box, strut_axis x,
                                      strut_axis y);
/** Frame, ticks, faint grid and labels: before the data, so that these lie above the grid. */
STRUT_API void strut_draw_axes(strut_canvas *canvas, const strut_axes *axes);
/** Maps a pair of values to the page. */
STRUT_API void strut_axes_point(const strut_axes *axes, double x, double y, double point[2]);

enum { STRUT_MOST_TICKS = 40 };
/** Round values in [low, high], about `wanted` of them: 1, 2 or 5 times a power of ten. */
STRUT_API size_t strut_ticks(double low, double high, int wanted, double ticks[STRUT_MOST_TICKS]);
/**
 * The prefix for values up to `largest`: factor such as 1e-3 and text such as "m" ("" for 1). The
 * units "", "%", "kg" and "deg" get no prefix.
 */
STRUT_API const char *strut_prefix(double largest, const char *unit, double *factor);

/**
 * A quantity as drawings write it: as strut_quantity_of, with a real minus sign.
 */
STRUT_API strut_rounded_quantity strut_drawn_quantity(double value, int digits, const char *unit);

/* Outliers: few values that would take most of a scale lie beyond it, marked and counted. */

/** Values beyond a scale. Zero-initialised: none. */
typedef struct strut_beyond {
  size_t below, above; /* how many */
  double farthest;     /* of them, by magnitude */
} strut_beyond;
/**
 * The limit of a scale for (count) magnitudes, which are sorted, beside `other` that it has to hold: the
 * largest is left out where it exceeds four times all smaller ones, and so on, up to `share` of them.
 */
STRUT_API double strut_limit_without_outliers(double *magnitudes, size_t count, double other,
                                              double share, strut_beyond *beyond);
/**
 * Narrows *low and *high to the values, which are sorted, without a twentieth at most of them where those
 * take more than three quarters of the range. Values that are not finite do not count.
 */
STRUT_API void strut_range_without_outliers(double *values, size_t count, double *low, double *high,
                                            strut_beyond *beyond);
enum { STRUT_BEYOND_TEXT = 120 };
/** "3 points beyond the axis, up to 167 kJ" in `text`; "" where there are none. `what` is one of them. */
STRUT_API const char *strut_beyond_text(const strut_beyond *beyond, const char *what,
                                        const char *unit, char text[STRUT_BEYOND_TEXT]);
/** A side of a frame. */
typedef enum strut_side {
  STRUT_SIDE_TOP,
  STRUT_SIDE_BOTTOM,
  STRUT_SIDE_LEFT,
  STRUT_SIDE_RIGHT
} strut_side;
/** A mark at a frame's edge for what lies beyond that side: a triangle STRUT_BEYOND_SIZE high, its tip so far outside. */
STRUT_API void strut_draw_beyond(strut_canvas *canvas, const double at[2], strut_side side,
                                 double outside);
#define STRUT_BEYOND_SIZE 5.0
enum { STRUT_TICK_TEXT = 64, STRUT_MOST_MINOR = 120 };
/** The ticks of a settled axis and their texts. */
typedef struct strut_tick_set {
  size_t count, minor_count;
  double at[STRUT_MOST_TICKS];                  /* [SI] */
  double minor[STRUT_MOST_MINOR];               /* without text: logarithmic axes only */
  char text[STRUT_MOST_TICKS][STRUT_TICK_TEXT]; /* in the prefixed unit; "" for no text */
  char label[200]; /* "velocity in mm/s", with an offset where one was taken */
} strut_tick_set;
/** Fills `set` with about `wanted` ticks. */
STRUT_API void strut_axis_ticks(const strut_axis *axis, int wanted, strut_tick_set *set);

/** A colour bar beside a drawing, with name, ticks and unit. */
typedef struct strut_colour_scale {
  const char *name, *unit;
  double low, high; /* [unit]; ticks are chosen */
  strut_colours colours;
  strut_beyond beyond; /* values that have the colours of the ends */
} strut_colour_scale;
/** Its colours alone, without a frame. */
STRUT_API void strut_draw_shades(strut_canvas *canvas, strut_box strip, strut_colours colours,
                                 double low, double high);
STRUT_API void strut_draw_colour_scale(strut_canvas *canvas, strut_box box,
                                       const strut_colour_scale *scale);

/* Where a figure goes, its width, and what replaces its title and axes. */

typedef struct strut_plot {
  const char *path;       /* ends with .svg, .pdf, .png or .json; NULL: no figure is wanted */
  double width;           /* [pt]; 0: 180 mm */
  const char *title;      /* replaces the figure's own; NULL: the model's name */
  strut_axis_choice x, y; /* of a figure with one pair of axes */
} strut_plot;

/** The title that was given, else `name`. */
static inline const char *strut_plot_title(const strut_plot *plot, const char *name) {
  return plot->title ? plot->title : name;
}

#endif
