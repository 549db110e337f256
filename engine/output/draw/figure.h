/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A figure as data, and the one painter that draws it.
 *
 * A figure is a page of panels below a heading. A panel is a chart (axes, series, bands, a map) or a view
 * (structures to scale), with marks on it. Whoever has a result fills the description in; the painter measures
 * texts, lays panels out, settles axes, leaves outliers out, places legends and labels clear of all else, and
 * writes the file: a picture, or the same data as JSON. Everything pointed to lives until the figure is drawn.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_FIGURE_H
#define STRUT_ENGINE_OUTPUT_DRAW_FIGURE_H

#include "engine/output/draw/chart.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/structure.h"

/* ---- charts ---- */

/** Markers along a line. */
typedef enum strut_markers {
  STRUT_MARKERS_AUTO, /* beside other series: at every point of few, at some of many */
  STRUT_MARKERS_ALL,
  STRUT_MARKERS_NONE
} strut_markers;

/* ---- views ---- */

/** A structure to scale. Those of a view lie over each other, the first lowest. */
typedef struct strut_shape {
  const strut_model *model;
  const double *q; /* (model->length) [m] */
  strut_structure_style style;
  const double *from; /* (model->length) arrows lead from there to the nodes [m]; or NULL */
  bool ground;        /* below it; moved as it is at style.time if `moving` */
  bool moving;
  bool names; /* beside its nodes, where they cover little */
  const double (
      *forces)[2]; /* (contacts) of the ground [N], as strut_draw_contact_forces; or NULL */
  double force_limit, arrow; /* their scale [N], [pt] */
} strut_shape;

/** The pen of arrows of displacement, for keys. */
STRUT_API strut_pen strut_displacement_pen(void);

typedef enum strut_trail_kind {
  STRUT_TRAIL_LINE,     /* by its pen */
  STRUT_TRAIL_SEQUENCE, /* dark to bright, as wide as its pen */
  STRUT_TRAIL_ARROW     /* from the first to the last point */
} strut_trail_kind;

/** A line through points of the plane, above the shapes. */
typedef struct strut_trail {
  strut_trail_kind kind;
  size_t count;
  const double (*at)[2]; /* (count) [m] */
  strut_pen pen;
  double gap; /* left free at both ends of two points, of an arrow at its tip [pt] */
  bool below; /* below the shapes */
} strut_trail;

/** Structures in a window with one scale for x and y. */
typedef struct strut_view {
  size_t shape_count, trail_count;
  const strut_shape *shapes;
  const strut_trail *trails;
  strut_bounds bounds; /* what has to be seen [m] */
  double margin;       /* around it, for names and arrows [pt] */
  bool yardstick;      /* a scale bar at its foot */
} strut_view;

/* ---- both ---- */

/** A point that is named, at a place of the axes or of the plane. */
typedef struct strut_mark {
  double at[2];
  const char *text;    /* beside it; NULL: none */
  bool dot, ring;      /* a filled circle; an empty one around what is there */
  strut_colour colour; /* of the dot */
  strut_font font;     /* of the text; size 0: 7 pt */
  double angle;        /* preferred direction of the text, counterclockwise from the right */
  double steady;       /* how much that matters, as in strut_label */
  int priority;
} strut_mark; /* Beyond the y axis it is a triangle at its end. */

typedef struct strut_panel {
  const char *title; /* may be NULL; of a view at its upper left corner */
  const char *note;  /* of a view, in grey below the title; may be NULL */
  const strut_view *view;
  /* Else a chart. A range of NAN is found from the data. */
  strut_axis x, y;
  bool
      outliers; /* few values far away lie beyond the range that is found; they are marked and counted */
  size_t series_count, band_count;
  const strut_series *series;
  const strut_band *bands;
  const strut_map *map;
  const char
      *lost; /* what points are called whose y is not finite: they lie in a strip above; or NULL */
  /* Both. */
  size_t mark_count;
  const strut_mark *marks;
  const char *beyond_text; /* a note inside the frame, where it is emptiest; or NULL */
  /* Beside it; equal limits: from the values. Name NULL: none. */
  strut_colour_scale scale;
  double height; /* [pt]; 0: by the figure's aspect */
  bool whole;    /* takes a row of its own */
  bool small;    /* a view beside many others */
} strut_panel;

typedef struct strut_figure {
  const char *title, *note; /* the heading; a plot's title replaces the first */
  bool alarm;               /* the note tells of a failure */
  size_t panel_count;
  const strut_panel *panels; /* in rows; of a row all are as high as the highest */
  size_t columns;            /* at most; 0: 3 */
  double least_width; /* of a panel, where there are several in a row [pt]; 0: one in a row */
  double aspect;      /* height over width of a panel without a height; 0: 0.66 */
  bool title_inside;  /* the title is above the first panel's frame, not a heading */
  bool shared_axes;   /* all charts get the ranges that hold all of them */
  bool one_legend;    /* of the first panel, above all */
  /* The foot, below the first views: a scale bar of theirs, keys, a scale of colours of all. */
  bool yardstick;
  size_t key_count;
  const strut_key_item *keys;
  strut_colour_scale scale; /* name NULL: none */
} strut_figure;

/** Draws it into the plot's file. Fails as strut_canvas_open and strut_canvas_commit, or STRUT_NO_MEMORY. */
STRUT_API strut_status strut_figure_draw(const strut_plot *plot, const strut_figure *figure,
                                         strut_error *error);
/** The same data as JSON text, released by the caller; NULL: no memory. */
STRUT_API char *strut_figure_json(const strut_plot *plot, const strut_figure *figure);

#endif
