/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What charts are described with: axes, scales of colours, values beyond them; and where a figure goes. */
#pragma once

#include <math.h>

#include "engine/base/text.h"
#include "engine/output/buffer.h"
#include "engine/output/draw/canvas.h"

/** One axis as wanted. Its label reads "name in unit", such as "velocity in mm/s". */
typedef struct strut_axis {
  const char *name,
      *unit; /* the values' SI unit; "" for none. Without `shown` the ticks get a prefix */
  bool logarithmic;
  double low, high; /* the range; both NAN: from the data, with a little room */
  const char *const
      *names; /* (name_count) of categories at 0, 1, ..., instead of numbers; or NULL */
  size_t name_count;
  strut_file_unit shown; /* what ticks and label are in */
} strut_axis;

/** A linear axis whose range comes from the data. */
static inline strut_axis strut_axis_of(const char *name, const char *unit) {
  strut_axis axis = {name, unit, false, (double)NAN, (double)NAN, NULL, 0, {NULL, 0}};
  return axis;
}

/** That of a number of a file; its SI unit may be "1". */
static inline strut_axis strut_axis_in(const char *name, const char *unit, strut_file_unit shown) {
  strut_axis axis = strut_axis_of(name, unit[0] == '1' && !unit[1] ? "" : unit);
  axis.shown = shown;
  return axis;
}

/** What replaces an axis's own. Zero-initialised: nothing. */
typedef struct strut_axis_choice {
  const char *label; /* replaces the name; the unit still follows; NULL: the name stays */
  bool limited;      /* the axis goes from low to high, in its unit */
  double low, high;
  bool logarithmic;
} strut_axis_choice;

/** Widens an axis whose range is from the data by a value; values that are not finite are ignored. */
STRUT_API void strut_axis_include(strut_axis *axis, double value);
/**
 * Turns the included values into a range that can be drawn: not empty, positive on a logarithmic
 * axis, 0 to 1 where nothing was included; widened by `room` of its width on either side.
 */
STRUT_API void strut_axis_settle(strut_axis *axis, double room);

/* Outliers: few values that would take most of a scale lie beyond it, marked and counted. */

/** Values beyond a scale. Zero-initialised: none. */
typedef struct strut_beyond {
  size_t below, above; /* how many */
  double farthest;     /* of them, by magnitude */
} strut_beyond;
/**
 * Widens a range that has to be held, or (NAN, NAN), to hold (count) values, which are sorted: but for a share of
 * them at most where the others take less than a quarter of it. Those that are not finite do not count.
 */
STRUT_API strut_beyond strut_leave_out(double *values, size_t count, double share, double range[2]);
enum { STRUT_BEYOND_TEXT = 120 };
/** "3 points beyond the axis, up to 167 kJ" in `text`; "" where there are none. `what` is one of them. */
STRUT_API const char *strut_beyond_text(const strut_beyond *beyond, const char *what,
                                        const char *unit, strut_file_unit shown,
                                        char text[STRUT_BEYOND_TEXT]);

/** A colour bar beside a drawing, with name, ticks and unit. */
typedef struct strut_colour_scale {
  const char *name, *unit;
  double low, high; /* [unit]; ticks are chosen */
  strut_colours colours;
  strut_file_unit shown; /* as of an axis */
  strut_beyond beyond;   /* values that have the colours of the ends */
} strut_colour_scale;

/** Where a figure goes, its width, and what replaces its title and axes. */
typedef struct strut_plot {
  const char *path;       /* ends with .svg, .pdf, .png or .json; NULL: no figure is wanted */
  double width;           /* [pt]; 0: 180 mm */
  const char *title;      /* replaces the figure's own; NULL: the model's name */
  bool texts;             /* those of an SVG are texts, not outlines */
  strut_axis_choice x, y; /* of a figure with one pair of axes */
} strut_plot;
