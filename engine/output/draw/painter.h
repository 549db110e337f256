/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the files of the painter share: labels, axes, keys, panels. For these files and their tests. */
#pragma once

#include "engine/base/memory.h"
#include "engine/output/draw/figure.h"

/* ---- labels (labels.c): the one place where texts are put beside what they name ---- */

/** Labels that wait, and the boxes of all texts that are drawn. Zero-initialise. */
typedef struct strut_labels {
  strut_label *list;
  size_t count, room;
  strut_box *texts; /* (text_count) [pt] */
  size_t text_count, text_room;
  strut_arena arena; /* of their texts */
  bool failed;       /* memory was out */
} strut_labels;

/** Keeps a label until strut_labels_place. */
void strut_labels_add(strut_labels *labels, const strut_label *label);
/** Notes the ink of a text that was drawn, which labels keep off. */
void strut_labels_avoid(strut_labels *labels, strut_box ink);
/**
 * Draws all that wait: the most important first, each where it covers the least ink, never over another text, with a
 * thin line to what it names where that is far. Where some find no place, a note on the page says how many.
 */
void strut_labels_place(strut_labels *labels, strut_canvas *canvas);
void strut_labels_free(strut_labels *labels);

/* ---- axes (axes.c): from a range to ticks, labels and a place on the page, with no tuning ---- */

enum { STRUT_MOST_TICKS = 40, STRUT_TICK_TEXT = 64, STRUT_MOST_MINOR = 120 };
/** Round values in [low, high], about `wanted` of them: 1, 2 or 5 times a power of ten. */
size_t strut_ticks(double low, double high, int wanted, double ticks[STRUT_MOST_TICKS]);
/**
 * The prefix for values up to `largest`: factor such as 1e-3 and text such as "m" ("" for 1). A
 * unit that takes none gets none.
 */
const char *strut_prefix(double largest, const char *unit, double *factor);
/** The ticks of a settled axis and their texts. */
typedef struct strut_tick_set {
  size_t count, minor_count;
  double at[STRUT_MOST_TICKS];                  /* [SI] */
  double minor[STRUT_MOST_MINOR];               /* without text: logarithmic axes only */
  char text[STRUT_MOST_TICKS][STRUT_TICK_TEXT]; /* in the prefixed unit; "" for no text */
  char label[200]; /* "velocity in mm/s", with an offset where one was taken */
} strut_tick_set;
/** Fills `set` with about `wanted` ticks. */
void strut_axis_ticks(const strut_axis *axis, int wanted, strut_tick_set *set);

/** Where a panel's values or the plane are on the page. */
typedef struct strut_axes {
  strut_axis x, y; /* ranges settled */
  strut_box frame; /* where data go [pt] */
  double scale;    /* of a view [pt/m] */
  double ticks;    /* height of the texts below a chart [pt] */
  bool upwards;    /* they are names too wide to stand side by side */
} strut_axes;
/** Lays out a frame for settled axes in `box`; panels side by side line up when their boxes do. */
strut_axes strut_axes_place(strut_canvas *canvas, strut_box box, strut_axis x, strut_axis y);
/** Those of the plane in `box`: a view's bounds with its margin around them and forces of the ground below. */
strut_axes strut_view_axes(strut_box box, const strut_panel *view);
/** Frame, ticks, faint grid and labels: before the data, so that these lie above the grid. */
void strut_draw_axes(strut_canvas *canvas, const strut_axes *axes);
/** Maps a pair of values, or a point of the plane, to the page. */
void strut_axes_point(const strut_axes *axes, const double place[2], double point[2]);

/* ---- what explains (legend.c) ---- */

/** Draws the marker of a series at x, y. */
void strut_draw_marker(strut_canvas *canvas, size_t look, double x, double y, double size);
/**
 * Lays a key out in lines that fill the width of `box`, or as a column of items where that is 0, from its upper left
 * corner on; longer texts wrap. Returns the box that it takes.
 */
strut_box strut_draw_key(strut_canvas *canvas, strut_box box, const strut_key_item *items,
                         size_t count);
/** A scale bar with its length, such as "20 mm", at the lower left corner of a view so wide [pt], at its scale [pt/m]. */
void strut_draw_yardstick(strut_canvas *canvas, double left, double bottom, double width,
                          double scale);
/** Draws a scale of colours with its ticks below and its name above. */
void strut_draw_colour_scale(strut_canvas *canvas, strut_box box, const strut_colour_scale *scale);
#define STRUT_SCALE_HEIGHT 34.0
#define STRUT_BEYOND_SIZE 5.0 /* an arrowhead for what lies beyond a frame or a scale [pt] */

/* ---- charts (axes.c, chart.c) ---- */

/** Settles ranges and scales that are not given, the same for all the panels. False: out of memory. */
bool strut_panels_settle(strut_panel *panels, size_t count, strut_arena *arena);
/** Adds what a panel's legend says to the keys of `legend`, unless it is there already. */
void strut_panel_legend(const strut_panel *panel, strut_figure *legend);
/** Draws a panel with settled axes in a box, a chart with its legend or without. False: out of memory. */
bool strut_draw_panel(strut_canvas *canvas, strut_box box, const strut_panel *panel, bool legend,
                      strut_arena *arena);
/** Limits of a map's cells along x or y. */
void strut_map_limits(const double *at, size_t count, double limits[2]);
/**
 * Thins (count) points of ascending x in place to at most four in each `grain` of x, which leaves
 * the drawn line unchanged. Returns the number kept; points in another order are all kept.
 */
size_t strut_thin(double (*points)[2], size_t count, double grain);

/* ---- structures (structure.c) ---- */

/**
 * Draws grounds, then shapes: members, nodes, supports, cells (filled), hinges (an arc from arm to arm), stops that act
 * (a bar across their member), masses on members (filled circles) and forces of the ground. Widths adapt to how many
 * there are.
 */
void strut_draw_shapes(strut_canvas *canvas, const strut_axes *axes, const strut_panel *view);
/** Names of nodes and, where the style says so, of members, where they cover little. */
void strut_draw_names(strut_canvas *canvas, const strut_axes *axes, const strut_panel *view);
/** More than its margin takes below a view, for the forces of the ground [pt]. */
double strut_view_arrows(const strut_panel *view);
