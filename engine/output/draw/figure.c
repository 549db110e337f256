/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The painter of figures: heading, legend, panels in rows, foot. */
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "engine/output/draw/painter.h"

static const double EDGE = 5, PAGE = 510.24, GAP = 12, INDENT = 30, WIDE = 330; /* [pt] */
static const double ASPECT = 0.62, LOWEST = 165, HIGHEST = 260;  /* of charts [1], [pt] */
static const double NARROWEST = 98, SHORTEST = 46, CAPTION = 26; /* views, their captions [pt] */
static const double TALLEST = 1.2,
                    FLATTEST = 0.6; /* of views: height over width at most, at least */
static const double LINE_GAP = 1.5, HEADING_GAP = 6; /* below texts of the heading [pt] */
static const double STICK = 17, BAR_WIDTH = 150;     /* of the foot [pt] */
enum { COLUMNS = 3 };

/* A page that is measured on a small canvas, then drawn. */
typedef struct page {
  strut_figure *figure; /* settled */
  strut_canvas *canvas;
  const char *title;   /* NULL: none */
  strut_figure legend; /* its keys are those of all panels */
  double scale;        /* of the latest view [pt/m] */
  bool measured;       /* panels are drawn, too */
} page;

/* Settles what the figure leaves open, panels together or each by itself. False: out of memory. */
static bool begin_page(page *self, strut_figure *figure, const strut_plot *plot) {
  size_t together = figure->shared_axes ? figure->panel_count : 1;
  *self = (page){.figure = figure, .title = plot->title ? plot->title : figure->title};
  for (size_t i = 0; i < figure->panel_count && !figure->failed; i += together)
    figure->failed = !strut_panels_settle(&figure->panels[i], together, &figure->arena);
  if (figure->panel_count && figure->panels->scale.name) figure->scale = figure->panels->scale;
  for (size_t i = 0; figure->one_legend && i < figure->panel_count; i++)
    strut_panel_legend(&figure->panels[i], &self->legend);
  return !figure->failed && !self->legend.failed;
}

/* ---- panels in rows ---- */

/* Consecutive charts, or views, or a chart with a view beside it. */
typedef struct group {
  const strut_panel *panels;
  size_t count, columns;
  bool views, pair;
  double width, gap, height; /* of a panel, between two, of a view [pt] */
} group;

/* What is above a panel; draws it if `draw`. Returns its height. */
static double put_caption(const page *self, strut_box box, const strut_panel *panel, bool draw) {
  double indent = panel->shape_count ? 0 : INDENT, width = box.width - indent;
  const strut_font bold = {.size = 8.5, .bold = true, .width = width, .lines = 3};
  const strut_font grey = {.size = 7, .colour = strut_grey(0.3), .width = width - 4};
  double title = strut_text_box(self->canvas, panel->title, bold).height + (panel->title ? 1 : 0);
  double note = strut_text_box(self->canvas, panel->note, grey).height;
  if (draw) strut_draw_text(self->canvas, box.x + indent, box.y, panel->title, bold);
  if (draw) strut_draw_text(self->canvas, box.x + indent, box.y + title, panel->note, grey);
  return title + (note > 0 ? note + 1 : 0);
}

/* As many views in a row as there is room for; or, on a page with a given aspect, as make the structures largest. */
static void arrange_views(group *self, const strut_figure *figure, double inner) {
  size_t most = figure->columns ? figure->columns : COLUMNS;
  double least = figure->least_width > 0 ? figure->least_width : NARROWEST, largest = 0;
  double size[2] = {0, 0}, around[2] = {0, 0}; /* what has to be seen [m], and beside it [pt] */
  for (const strut_panel *view = self->panels; view < self->panels + self->count; view++)
    for (int d = 0; d < 2; d++) {
      double below = d ? strut_view_arrows(view) : 0;
      size[d] = fmax(size[d], view->bounds.high[d] - view->bounds.low[d]);
      around[d] = fmax(around[d], 2 * view->margin + below);
    }
  for (size_t columns = 1; columns <= most && columns <= self->count; columns++) {
    double rows = (double)((self->count + columns - 1) / columns);
    double wide = (inner - (double)(columns - 1) * GAP) / (double)columns, high = TALLEST * wide;
    if (wide < least && columns > 1) break;
    if (figure->aspect > 0)
      high = fmax(figure->aspect * inner / rows - (self->count > 1 ? CAPTION : 0), SHORTEST);
    double tall = fmax(high, FLATTEST * wide);
    double scale = fmin((wide - around[0]) / size[0], (high - around[1]) / size[1]);
    /* of equal scales the fewest rows win */
    if (scale < largest * (1 - 1e-9) && figure->aspect > 0) continue;
    largest = scale;
    scale = fmin((wide - around[0]) / size[0], (tall - around[1]) / size[1]);
    self->columns = columns, self->width = wide;
    self->height = isfinite(scale) ? fmax(scale * size[1] + around[1], SHORTEST) : tall;
  }
  if (self->panels->height > 0) self->height = self->panels->height;
}

static group find_group(const strut_figure *figure, size_t first, double inner) {
  size_t left = figure->panel_count - first;
  const strut_panel *panels = &figure->panels[first];
  group g = {.panels = panels, .count = 1, .columns = 1, .views = panels->shape_count > 0};
  g.pair = left > 1 && panels[1].beside && inner >= WIDE;
  while (g.count < left && (g.pair ? g.count < 2 : (panels[g.count].shape_count > 0) == g.views))
    g.count++;
  if (g.pair)
    g.columns = 2;
  else if (!g.views && figure->least_width > 0)
    g.columns = (size_t)fmax(1, fmin(fmin((double)(figure->columns ? figure->columns : COLUMNS),
                                          floor(inner / figure->least_width)),
                                     (double)g.count));
  g.gap = g.pair || g.views ? GAP : 0;
  g.width = (inner - (double)(g.columns - 1) * g.gap) / (double)g.columns;
  if (g.views) arrange_views(&g, figure, inner);
  return g;
}

/* Names that stand upwards below a chart make it higher. */
static double chart_height(const strut_figure *figure, strut_canvas *canvas,
                           const strut_panel *panel, double width) {
  strut_axes axes = {.upwards = false};
  if (panel->x.name_count)
    axes = strut_axes_place(canvas, (strut_box){0, 0, width, LOWEST}, panel->x, panel->y);
  double aspect = figure->aspect > 0 ? figure->aspect : ASPECT;
  double height = aspect * width;
  if (figure->least_width > 0) height = fmax(LOWEST, fmin(height, HIGHEST));
  return panel->height > 0 ? panel->height : height + (axes.upwards ? axes.ticks : 0);
}

/* The row of (count) panels. Returns its height. */
static double put_row(page *self, strut_box box, const group *of, size_t first, size_t count) {
  double caption = 0, height = of->height;
  strut_figure *figure = self->figure;
  for (const strut_panel *p = of->panels + first; p < of->panels + first + count; p++) {
    caption = fmax(caption, put_caption(self, box, p, false));
    if (!of->views) height = fmax(height, chart_height(figure, self->canvas, p, box.width));
  }
  for (size_t i = first; i < first + count && self->measured; i++, box.x += box.width + of->gap) {
    const strut_panel *panel = &of->panels[i];
    const strut_box below = {box.x, box.y + caption, box.width, height};
    put_caption(self, box, panel, true);
    figure->failed |=
        !strut_draw_panel(self->canvas, below, panel, !figure->one_legend, &figure->arena);
    if (panel->shape_count) self->scale = strut_view_axes(below, panel).scale;
  }
  return caption + height;
}

static double put_group(page *self, strut_box box, const group *of) {
  double top = box.y;
  for (size_t i = 0, count; i < of->count; i += count) {
    bool whole = of->panels[i].whole && !of->views;
    strut_box row = box;
    if (!whole) row.width = of->width;
    for (count = 1; !whole && count < of->columns && i + count < of->count; count++)
      if (!of->views && of->panels[i + count].whole) break;
    if (i) row.y = box.y += of->gap;
    box.y += put_row(self, row, of, i, count);
  }
  return box.y - top;
}

/* ---- the page ---- */

/* A text of the heading, which wraps. Returns its height and the space below. */
static double put_heading(const page *self, strut_box box, const char *text, strut_font font) {
  font.width = box.width;
  strut_draw_text(self->canvas, box.x, box.y, text, font);
  return text && *text ? strut_text_box(self->canvas, text, font).height + LINE_GAP : 0;
}

/* A scale bar below views so wide, keys, and the scale of colours. Returns their height. */
static double put_foot(const page *self, strut_box box, double width) {
  const strut_figure *figure = self->figure;
  bool bar = figure->scale.name && figure->scale.high > figure->scale.low;
  bool stick = width > 0 && figure->yardstick;
  double row = bar ? STRUT_SCALE_HEIGHT : stick ? STICK : 0;
  double right = fmin(BAR_WIDTH, 0.5 * box.width);
  strut_box key = strut_draw_key(self->canvas, box, figure->keys, figure->key_count);
  bool beside = !stick && key.width + right < box.width;
  double height = beside ? fmax(key.height, row) : key.height + row;
  const strut_box place = {box.x + box.width - right, box.y + height - row, right, row};
  if (bar) strut_draw_colour_scale(self->canvas, place, &figure->scale);
  if (stick) strut_draw_yardstick(self->canvas, box.x, box.y + height, width, self->scale);
  return height;
}

/* Lays all out on a canvas and draws it. Returns the height of the page. */
static double put_page(page *self, strut_canvas *canvas, double width) {
  const strut_figure *figure = self->figure;
  strut_box box = {EDGE, EDGE, width - 2 * EDGE, 0};
  bool foot = true;
  const strut_font bold = {.size = 9, .bold = true};
  const strut_font plain = {.size = 8,
                            .colour = figure->alarm ? strut_palette_thing(1) : strut_grey(0.3)};
  self->canvas = canvas;
  box.y += put_heading(self, box, self->title, bold);
  box.y += put_heading(self, box, figure->note, plain);
  if (box.y > EDGE) box.y += HEADING_GAP - LINE_GAP;
  const strut_box legend = {EDGE + INDENT, box.y, box.width - INDENT, 0};
  box.y += strut_draw_key(canvas, legend, self->legend.keys, self->legend.key_count).height;
  for (size_t i = 0; i < figure->panel_count;) {
    const group g = find_group(figure, i, box.width);
    if (i) box.y += GAP;
    box.y += put_group(self, box, &g);
    i += g.count;
    if (!foot || !(g.views || i == figure->panel_count)) continue;
    if (g.views || figure->key_count || figure->scale.name) box.y += 0.5 * GAP;
    box.y += put_foot(self, box, g.views ? g.width : 0);
    foot = false;
  }
  self->measured = true;
  return box.y + EDGE;
}

/* What Fontconfig and Pango take for fonts and threads, the first time: without it they end the process [bytes]. */
enum { FONT_MEMORY = 256 << 20 };

static strut_status open_pixels(int width, int height, double scale, strut_canvas **canvas,
                                strut_error *error) {
  static atomic_bool ready;
  if (!ready && !strut_has_memory(FONT_MEMORY)) return strut_no_memory(error, "for fonts");
  ready = true;
  return strut_canvas_open_pixels(width, height, scale, canvas, error);
}

static strut_status draw(const strut_plot *plot, strut_figure *figure, strut_error *error) {
  page p;
  strut_canvas *small = NULL, *canvas = NULL;
  double width = plot->width > 0 ? plot->width : PAGE;
  strut_status status = begin_page(&p, figure, plot) ? open_pixels(1, 1, 1.0, &small, error)
                                                     : strut_no_memory(error, "while drawing");
  double height = status ? 0 : put_page(&p, small, width);
  if (!status)
    status = strut_canvas_open(plot->path, width, height, p.title ? p.title : "", &canvas, error);
  if (!status && plot->texts) strut_canvas_keep_texts(canvas);
  if (!status) put_page(&p, canvas, width);
  if (!status)
    status = figure->failed ? strut_no_memory(error, "while drawing")
                            : strut_canvas_commit(canvas, error);
  strut_canvas_free(small);
  strut_canvas_free(canvas);
  strut_arena_free(&p.legend.arena);
  return status;
}

static const unsigned char *paint(strut_canvas *canvas, strut_figure *figure, size_t *stride) {
  page p;
  strut_canvas_clear(canvas, strut_grey(1));
  if (begin_page(&p, figure, &(strut_plot){.path = NULL})) {
    p.measured = true;
    put_page(&p, canvas, strut_canvas_box(canvas).width);
  }
  strut_arena_free(&p.legend.arena);
  return figure->failed || p.legend.failed ? NULL : strut_canvas_pixels(canvas, stride);
}

extern STRUT_API const strut_cairo_library strut_cairo_table;
const strut_cairo_library strut_cairo_table = {.stamp = STRUT_LIBRARY_STAMP(strut_cairo_library),
                                               .draw = draw,
                                               .open = open_pixels,
                                               .paint = paint,
                                               .free = strut_canvas_free};

strut_status strut_cairo_load(const strut_cairo_library **library, strut_error *error) {
  (void)error;
  *library = &strut_cairo_table;
  return STRUT_OK;
}
