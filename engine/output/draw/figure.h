/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A figure as data, and the one painter that draws it.
 *
 * A figure is a page of panels below a heading. A panel is a chart (axes, series, bands, a map) or, with shapes, a
 * view of structures to scale; both have marks. Whoever has a result fills the description in by strut_add_*, whose
 * lists grow in the figure's arena; memory that is out is told once, by strut_figure_draw. The painter measures
 * texts, lays panels out, settles axes, leaves outliers out, places legends and labels clear of all else, and
 * writes the file: a picture, or the same data as JSON.
 */
#pragma once

#include "engine/base/library.h"
#include "engine/base/memory.h"
#include "engine/model/model.h"
#include "engine/output/draw/chart.h"

/* ---- what things mean: legends beside data, the key below a figure ---- */

typedef enum strut_key_sign {
  STRUT_KEY_LINE,  /* a short line by `pen`, with the marker of a look if `marked` */
  STRUT_KEY_ARROW, /* an arrow by `pen` */
  STRUT_KEY_DOT,   /* a circle by `fill` and `pen` */
  STRUT_KEY_AREA,  /* a box by `fill` */
  STRUT_KEY_WORDS  /* no sign */
} strut_key_sign;

typedef struct strut_key_item {
  strut_key_sign sign;
  strut_pen pen;
  strut_fill fill;
  bool marked;
  size_t look;
  const char *text; /* NULL: the item is left out */
} strut_key_item;

/* ---- charts ---- */

/** A point of a series, SI. What strut_add_point makes has neither whisker nor value. */
typedef struct strut_point {
  double x, y;      /* what is not finite breaks the line */
  double low, high; /* a whisker along y; NAN: none */
  double value;     /* a dot's colour on the panel's scale; NAN: it is empty */
  bool unstable;    /* the line from here on is dashed and thinner */
} strut_point;

typedef enum strut_series_kind {
  STRUT_SERIES_LINE,
  STRUT_SERIES_DOTS,     /* in the look's colour where the panel has no scale */
  STRUT_SERIES_SEQUENCE, /* a line dark to bright, as wide as its pen */
  STRUT_SERIES_ARROW     /* from the first to the last point */
} strut_series_kind;

/** Points of a chart or of the plane. */
typedef struct strut_series {
  strut_series_kind kind;
  const char *label; /* in the legend, where equal ones get one row; NULL: not there */
  size_t count;
  strut_point *points; /* (count) */
  int look;            /* index of colour, dashes and marker; -1: the series' own index */
  strut_pen pen;       /* replaces the look's line; width 0: the look */
  double bar;          /* bars from 0 instead of a line, so wide along x; 0: none */
  bool unmarked; /* else markers tell it from others: at every point of few, at some of many */
} strut_series;

/** A grey area from x = low to high, or y; its label goes into the legend, or is NULL. */
typedef struct strut_band {
  double low, high;
  bool level; /* from y = low to high */
  const char *label;
} strut_band;

/** Cells over two quantities: a category or a number at every grid point; doubtful ones are hatched. */
typedef struct strut_map {
  size_t columns, rows;
  const double *xs, *ys; /* (columns), (rows) ascending; cell edges are midpoints */
  size_t name_count;
  const char *const *names; /* (name_count) of categories; NULL: numbers */
  const double *value;      /* (rows, columns) a number, or index into names; NAN: no result */
  const bool *doubtful;     /* (rows, columns) drawn hatched; or NULL */
  const char *doubt;        /* meaning of the hatching, for the legend */
} strut_map;

/* ---- views ---- */

/** Smallest and largest x and y [m]. Starts as strut_bounds_none(). */
typedef struct strut_bounds {
  double low[2], high[2];
} strut_bounds;

STRUT_API strut_bounds strut_bounds_none(void);
/** Widens the bounds to hold a rectangle, or a point as both its corners. */
STRUT_API void strut_bounds_widen(strut_bounds *bounds, const double low[2], const double high[2]);
/** Widens the bounds by all nodes of a shape q (model->length). */
STRUT_API void strut_bounds_add(strut_bounds *bounds, const strut_model *model,
                                const double *positions);
/** The bounds of one shape. */
STRUT_API strut_bounds strut_bounds_of(const strut_model *model, const double *positions);
/** Makes the bounds as large as `size`, about their middle and from their foot on. */
STRUT_API void strut_bounds_share(strut_bounds *bounds, const double size[2]);
/** The larger extent [m]. */
STRUT_API double strut_bounds_extent(const strut_bounds *bounds);

typedef enum strut_colouring {
  STRUT_COLOUR_KIND,  /* as strut_kind_pen */
  STRUT_COLOUR_FORCE, /* by the scale of signed values up to `limit` */
  STRUT_COLOUR_ONE    /* all in `colour` */
} strut_colouring;

/** Style of a structure; zero-initialised: coloured by kind, thick and opaque. */
typedef struct strut_structure_style {
  strut_colouring colouring;
  const double *values; /* (member_count) force [N] or strain; for STRUT_COLOUR_FORCE */
  double limit;         /* largest |value| of the colour scale */
  const double
      *slack_forces;   /* (member_count) [N]: a cable with 0 is drawn slack; NULL: by length */
  strut_colour colour; /* for STRUT_COLOUR_ONE */
  double thinness;     /* widths are divided by 1 + thinness */
  double fringe;       /* added to widths: members dashed, to be seen below the same ones [pt] */
  bool no_nodes, no_supports;
  bool member_names; /* where nodes have theirs */
  double time;       /* at which masses that slide stand where they are drawn [s] */
} strut_structure_style;

/** A structure to scale. Those of a view lie over each other, the first lowest. */
typedef struct strut_shape {
  const strut_model *model;
  const double *q; /* (model->length) [m] */
  strut_structure_style style;
  bool ground; /* below it; moved as it is at style.time if `moving` */
  bool moving;
  bool names;                /* beside its nodes, where they cover little */
  const double (*forces)[2]; /* (contacts) of the ground [N]; or NULL */
  double force_limit;        /* their scale [N]; 0: that of the figure, with a key */
} strut_shape;

/** Is a member driven by an actuator? */
STRUT_API bool strut_member_is_driven(const strut_scene *scene, size_t member);
/** The pen of members of a kind, of its width in large structures; those that are driven in another colour. */
STRUT_API strut_pen strut_kind_pen(strut_member_kind kind, bool driven);

/* ---- both ---- */

typedef struct strut_panel {
  const char *title, *note; /* above it, the note in grey; may be NULL */
  /* A view: structures with one scale for x and y, the series above them. */
  size_t shape_count;
  strut_shape *shapes;
  strut_bounds bounds; /* what has to be seen [m]; all zero: shapes and series */
  double margin;       /* around it, for names and arrows [pt] */
  bool yardstick;      /* a scale bar at its foot */
  /* Else a chart. A range of NAN is found from the data. */
  strut_axis x, y;
  bool outliers; /* few values far away lie beyond the range that is found, marked and counted */
  size_t series_count, band_count;
  strut_series *series;
  strut_band *bands;
  const strut_map *map;
  double room;  /* of a range that is found, beside the data along x; along y it is 0.06 */
  double least; /* such a range of y is at least so large, */
  bool zero;    /* and holds zero */
  /* Both. */
  size_t mark_count;
  strut_label
      *marks; /* at places of the axes or of the plane; beyond the y axis a triangle at its end */
  /* At the figure's foot; limits that are equal come from the values. Name NULL: none. */
  strut_colour_scale scale;
  double height; /* [pt]; 0: by the figure's aspect */
  bool whole;    /* takes a row of its own */
  bool beside;   /* stands right of the panel before it, where the page is wide */
} strut_panel;

/** Zero-initialise; strut_figure_draw frees what is in its arena. */
typedef struct strut_figure {
  const char *title, *note; /* the heading; a plot's title replaces the first */
  bool alarm;               /* the note tells of a failure */
  size_t panel_count;
  strut_panel *panels; /* in rows; of a row all charts are as high as the highest */
  size_t columns;      /* at most; 0: 3 */
  double least_width;  /* of a panel in a row with others [pt]; 0: a chart by itself, a view 98 */
  double aspect; /* height over width: of a chart without a height, 0: 0.62; of all views, 0: any */
  bool shared_axes; /* all charts get the ranges that hold all of them, all views the bounds */
  bool one_legend;  /* of all charts, above them */
  /* The foot, below the first views or all charts: a scale bar of views, keys, a scale of colours of all. */
  bool yardstick;
  size_t key_count;
  strut_key_item *keys;
  strut_colour_scale scale; /* name NULL: none */
  strut_arena arena;        /* of lists, texts and numbers */
  bool failed;              /* memory was out */
  strut_panel spare;        /* what is filled in then */
} strut_figure;

/* ---- filling in: what is returned stays in place until the next of its list ---- */

STRUT_API strut_panel *strut_add_panel(strut_figure *figure);
STRUT_API strut_series *strut_add_series(strut_figure *figure, strut_panel *panel,
                                         const char *label);
/** One at NAN ends the line, and the next point begins another. */
STRUT_API strut_point *strut_add_point(strut_figure *figure, strut_series *series, double x,
                                       double y);
STRUT_API strut_band *strut_add_band(strut_figure *figure, strut_panel *panel, double low,
                                     double high, const char *label);
/** A text of 7 pt beside a place, as far away as a dot needs; or no text, for a dot or a ring alone. */
STRUT_API strut_label *strut_add_mark(strut_figure *figure, strut_panel *panel, double x, double y,
                                      const char *text);
STRUT_API strut_shape *strut_add_shape(strut_figure *figure, strut_panel *panel,
                                       const strut_model *model, const double *positions);
/** One of a single colour, without nodes and supports, below others. */
STRUT_API strut_shape *strut_add_ghost(strut_figure *figure, strut_panel *panel,
                                       const strut_model *model, const double *positions,
                                       double grey);
/** One in the colours of its members' forces, on its ground. */
STRUT_API strut_shape *strut_add_forces(strut_figure *figure, strut_panel *panel,
                                        const strut_model *model, const double *positions,
                                        const double *force, double limit);
/** A series of that kind, with a pen of its own and without label. */
STRUT_API strut_series *strut_add_line(strut_figure *figure, strut_panel *panel,
                                       strut_series_kind kind, strut_pen pen);
/** One of two points. */
STRUT_API void strut_add_segment(strut_figure *figure, strut_panel *panel, strut_series_kind kind,
                                 strut_pen pen, const double from[2], const double to[2]);
/** Arrows from where a shape was to its nodes, unless there are many, and their key. */
STRUT_API void strut_add_displacements(strut_figure *figure, strut_panel *panel,
                                       const strut_model *model, const double *from,
                                       const double *to);
/** An item of the key below the figure; without a text none, of equal ones the first. */
STRUT_API strut_key_item *strut_add_key(strut_figure *figure, strut_key_sign sign, strut_pen pen,
                                        const char *text);
/** A text in the arena, whatever the locale; "" where memory is out. */
STRUT_API const char *strut_figure_text(strut_figure *figure, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/** (count) numbers in the arena, those of `from` or 0 where that is NULL; NULL: memory is out. */
STRUT_API double *strut_figure_numbers(strut_figure *figure, const double *from, size_t count);
/** The scale of signed forces; without a name where the limit is 0. */
STRUT_API strut_colour_scale strut_force_scale(double limit, const strut_beyond *beyond);
/**
 * Length of the longest prefix of `text` of at most `most` bytes that splits no UTF-8 character.
 */
STRUT_API int strut_text_bytes(const char *text, int most);
/** The pen of the i-th series: its colour and dashes. */
STRUT_API strut_pen strut_series_pen(size_t look);
/** The largest of 1, 2 or 5 times a power of ten up to a value. */
STRUT_API double strut_round_below(double value);
/** The largest magnitude of those that are finite; 0 of none. */
STRUT_API double strut_largest(const double *values, size_t count);

/**
 * Draws it into the plot's file; into one that ends with .json it writes its data. Frees what the figure's arena
 * holds. Fails as strut_canvas_open and strut_canvas_commit, or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_figure_draw(const strut_plot *plot, strut_figure *figure,
                                         strut_error *error);

/** What a file becomes by the ending of its name. */
typedef enum strut_picture_format {
  STRUT_PICTURE_SVG,
  STRUT_PICTURE_PDF,
  STRUT_PICTURE_PNG,
  STRUT_PICTURE_JSON,  /* its data */
  STRUT_PICTURE_PIXELS /* of no file; an unknown ending */
} strut_picture_format;
STRUT_API strut_picture_format strut_picture_format_of(const char *path);
/** STRUT_OK if a figure can be written into a file of that name, else STRUT_USAGE with the endings there are. */
STRUT_API strut_status strut_figure_check_name(const char *path, strut_error *error);

/* The painter of figures as the rest of strut calls it: with Cairo and Pango in a module (engine/base/library.h). */

typedef struct strut_cairo_library {
  strut_library_stamp stamp;
  /** As strut_figure_draw, of a picture; the figure's arena stays. */
  strut_status (*draw)(const strut_plot *plot, strut_figure *figure, strut_error *error);
  /** As strut_canvas_open_pixels. */
  strut_status (*open)(int width, int height, double scale, strut_canvas **canvas,
                       strut_error *error);
  /**
   * Draws a figure on the whole canvas, as high as it is. Returns what strut_canvas_pixels does, or NULL where memory
   * is out.
   */
  const unsigned char *(*paint)(strut_canvas *canvas, strut_figure *figure, size_t *stride);
  /** As strut_canvas_free. */
  void (*free)(strut_canvas *canvas);
} strut_cairo_library;

/** Fails where the libraries cannot be loaded. */
STRUT_API strut_status strut_cairo_load(const strut_cairo_library **library, strut_error *error);
