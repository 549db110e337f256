/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The painter of figures: heading, legend, panels in rows, foot. */
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "engine/output/draw/painter.h"

static const double EDGE = 5, PAGE = 510.24, GAP = 12, INDENT = 30, WIDE = 330; /* [pt] */
static const double ASPECT = 0.62, LOWEST = 165, HIGHEST = 260; /* of charts [1], [pt] */
static const double LINE_GAP = 1.5, HEADING_GAP = 6; /* below texts of the heading [pt] */
enum { COLUMNS = 3 };

/* A page that is measured, then drawn. */
typedef struct page {
  strut_figure *figure;  /* settled */
  const char *title;     /* NULL: none */
  strut_key_item *items; /* of the legend of all panels */
  size_t item_count;
} page;

/* Settles what the figure leaves open, panels together or each by itself. False: out of memory. */
static bool begin_page(page *self, strut_figure *figure, const strut_plot *plot) {
  size_t together = figure->shared_axes ? figure->panel_count : 1, room = 1;
  bool fine = !figure->failed;
  *self = (page){.figure = figure, .title = plot->title ? plot->title : figure->title};
  for (size_t i = 0; i < figure->panel_count; i++)
    room += strut_panel_legend_room(&figure->panels[i]);
  for (size_t i = 0; i < figure->panel_count && fine; i += together)
    fine = strut_panels_settle(&figure->panels[i], together, &figure->arena);
  self->items = strut_arena_allocate(&figure->arena, room, sizeof *self->items);
  for (size_t i = 0; self->items && figure->one_legend && i < figure->panel_count; i++)
    self->item_count = strut_panel_legend(&figure->panels[i], self->items, self->item_count);
  return fine && self->items;
}

/* ---- the page ---- */

/* Panels in a row with the first, and the width of each. */
static size_t find_row(const page *self, size_t first, double inner, double *width) {
  const strut_figure *figure = self->figure;
  const strut_panel *panel = &figure->panels[first];
  size_t left = figure->panel_count - first, count = 1;
  double columns = 1;
  if (left > 1 && panel[1].beside) { /* two by themselves */
    columns = inner >= WIDE ? 2 : 1;
    count = (size_t)columns;
  } else if (figure->least_width > 0 && !panel->whole && !panel->beside) {
    double most = figure->columns ? (double)figure->columns : COLUMNS;
    columns =
        fmax(1, fmin(fmin(most, floor(inner / figure->least_width)), (double)figure->panel_count));
    while (count < (size_t)columns && count < left && !panel[count].shape_count &&
           !panel[count].whole)
      count++;
  }
  *width = (inner - (panel[count - 1].beside ? (columns - 1) * GAP : 0)) / columns;
  return count;
}

/* Names that stand upwards below a chart make it higher. */
static double chart_height(const page *self, strut_canvas *canvas, const strut_panel *panel,
                           double width) {
  strut_axes axes = {.upwards = false};
  if (panel->x.name_count)
    axes = strut_axes_place(canvas, (strut_box){0, 0, width, LOWEST}, panel->x, panel->y);
  double aspect = self->figure->aspect > 0 ? self->figure->aspect : ASPECT;
  double height = aspect * width, scale = panel->scale.name ? STRUT_SCALE_HEIGHT : 0;
  if (self->figure->least_width > 0) height = fmax(LOWEST, fmin(height, HIGHEST));
  return panel->height > 0 ? panel->height : height + scale + (axes.upwards ? axes.ticks : 0);
}

/* The row of a chart; draws it if `fine`, which becomes false where memory is out. Returns its height. */
static double put_row(page *self, strut_canvas *canvas, strut_box box, size_t first, size_t count,
                      bool *fine) {
  const strut_panel *panels = self->figure->panels;
  double gap = panels[first + count - 1].beside ? GAP : 0, height = 0, title = 0;
  for (size_t i = first; i < first + count; i++)
    height = fmax(height, chart_height(self, canvas, &panels[i], box.width));
  box.height = height;
  for (size_t i = first; i < first + count; i++)
    if (!panels[i].shape_count)
      title = fmax(title, strut_chart_title(canvas, box, &panels[i], false));
  for (size_t i = first; i < first + count && fine && *fine; i++, box.x += box.width + gap)
    if (panels[i].shape_count)
      strut_draw_view(canvas, box, &panels[i]);
    else
      *fine = strut_draw_chart(canvas, box, title, &panels[i], !self->figure->one_legend,
                               &self->figure->arena);
  return height;
}

/* A text of the heading, which wraps; draws it if `draw`. Returns its height and the space below. */
static double put_heading(strut_canvas *canvas, strut_box box, const char *text, strut_font font,
                          bool draw) {
  font.width = box.width;
  if (draw) strut_draw_text(canvas, box.x, box.y, text, font);
  return text && *text ? strut_text_box(canvas, text, font).height + LINE_GAP : 0;
}

/* Lays all out and draws it if `fine`. Returns the height of the page. */
static double put_page(page *self, strut_canvas *canvas, double width, bool *fine) {
  const strut_figure *figure = self->figure;
  strut_box box = {EDGE, EDGE, width - 2 * EDGE, 0};
  bool draw = fine != NULL, foot = true;
  const strut_font bold = {.size = 9, .bold = true};
  const strut_font plain = {.size = 8,
                            .colour = figure->alarm ? strut_palette_thing(1) : strut_grey(0.3)};
  box.y += put_heading(canvas, box, self->title, bold, draw);
  box.y += put_heading(canvas, box, figure->note, plain, draw);
  if (box.y > EDGE) box.y += HEADING_GAP - LINE_GAP;
  const strut_box legend = {EDGE + INDENT, box.y, box.width - INDENT, 0};
  box.y += strut_draw_key(canvas, legend, self->items, self->item_count, draw).height;
  for (size_t i = 0, count; i < figure->panel_count; i += count) {
    const strut_panel *first = &figure->panels[i];
    if (i > 0 && (first->shape_count || first[-1].shape_count)) box.y += GAP;
    strut_box row = box;
    count = find_row(self, i, box.width, &row.width);
    if (count > 1 || !first->shape_count) {
      box.y += put_row(self, canvas, row, i, count, fine);
      continue;
    }
    while (i + count < figure->panel_count && first[count].shape_count &&
           first[count].small == first->small)
      count++;
    box.y += strut_draw_views(canvas, box, figure, first, count, foot, draw);
    foot = false;
  }
  if (foot && figure->key_count) box.y += 0.5 * GAP;
  return box.y + (foot ? strut_draw_foot(canvas, box, figure, NULL, draw) : 0) + EDGE;
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
  strut_canvas *canvas = NULL;
  double width = plot->width > 0 ? plot->width : PAGE;
  bool fine = begin_page(&p, figure, plot);
  if (!fine) return strut_no_memory(error, "while drawing");
  strut_status status = open_pixels(1, 1, 1.0, &canvas, error);
  if (status) return status;
  double height = put_page(&p, canvas, width, NULL);
  strut_canvas_free(canvas);
  status = strut_canvas_open(plot->path, width, height, p.title ? p.title : "", &canvas, error);
  if (status) return status;
  if (plot->texts) strut_canvas_keep_texts(canvas);
  put_page(&p, canvas, width, &fine);
  status = fine ? strut_canvas_commit(canvas, error) : strut_no_memory(error, "while drawing");
  strut_canvas_free(canvas);
  return status;
}

static const unsigned char *paint(strut_canvas *canvas, strut_figure *figure, size_t *stride) {
  page p;
  bool fine = begin_page(&p, figure, &(strut_plot){.path = NULL});
  strut_canvas_clear(canvas, strut_grey(1));
  if (fine) put_page(&p, canvas, strut_canvas_box(canvas).width, &fine);
  return fine ? strut_canvas_pixels(canvas, stride) : NULL;
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
