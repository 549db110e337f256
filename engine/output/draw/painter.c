/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The painter of figures: heading, legend, panels in rows, key, file. */
#include <math.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/draw/painter.h"
#include "engine/output/file.h"

static const double EDGE = 5, PAGE = 510.24, BETWEEN = 2, INDENT = 30; /* [pt]; 180 mm */
static const double ASPECT = 0.62, LOWEST = 165, HIGHEST = 260;        /* of charts [1], [pt] */
static const double NAME = 13, SCALE_HEIGHT = 34;

/* A page being laid out, then drawn. */
typedef struct page {
  const strut_figure *figure;
  strut_canvas *ruler, *canvas; /* to measure texts before there is a page */
  strut_heading heading;
  strut_panel *panels;   /* (panel_count) settled */
  strut_box *boxes;      /* (panel_count) */
  double *heads;         /* (panel_count) of a view: height of its texts */
  strut_key_item *items; /* of the legend of all panels */
  size_t item_count;
  double width, height, legend, key; /* [pt] */
  strut_arena arena;
} page;

static bool is_chart(const strut_panel *p) { return p->series_count || p->map || p->mark_count; }

/* ---- what the figure leaves open ---- */

static bool settle(page *p, const strut_plot *plot) {
  size_t count = p->figure->panel_count, charts = 0;
  strut_panel *shared = strut_arena_allocate(&p->arena, count + 1, sizeof *shared);
  p->panels = strut_arena_copy(&p->arena, p->figure->panels, count, sizeof *p->panels);
  p->boxes = strut_arena_allocate(&p->arena, count + 1, sizeof *p->boxes);
  p->heads = strut_arena_allocate(&p->arena, count + 1, sizeof *p->heads);
  if (!shared || !p->panels || !p->boxes || !p->heads) return false;
  for (size_t i = 0; i < count; i++) {
    strut_panel *panel = &p->panels[i];
    if (panel->view || !is_chart(panel)) continue;
    strut_axis_choose(&panel->x, &plot->x);
    strut_axis_choose(&panel->y, &plot->y);
    if (p->figure->shared_axes)
      shared[charts++] = *panel;
    else if (!strut_panels_settle(panel, 1, &p->arena))
      return false;
  }
  if (charts && !strut_panels_settle(shared, charts, &p->arena)) return false;
  for (size_t i = count; charts && i-- > 0;)
    if (!p->panels[i].view && is_chart(&p->panels[i])) p->panels[i] = shared[--charts];
  return true;
}

static bool gather_legend(page *p) {
  size_t room = 1;
  for (size_t i = 0; i < p->figure->panel_count; i++)
    room += strut_panel_legend_room(&p->panels[i]);
  p->items = strut_arena_allocate(&p->arena, room, sizeof *p->items);
  for (size_t i = 0; p->items && p->figure->one_legend && i < p->figure->panel_count; i++)
    p->item_count = strut_panel_legend(&p->panels[i], p->items, p->item_count);
  return p->items != NULL;
}

/* ---- the page ---- */

static strut_font note_font(double width) {
  return (strut_font){.size = 7.5, .colour = strut_grey(0.3), .width = width};
}

static double head_height(const page *p, const strut_panel *panel, double width) {
  double note = panel->view && panel->note
                    ? strut_text_height(p->ruler, panel->note, note_font(width)) + BETWEEN
                    : 0;
  return panel->view && panel->title ? NAME + note : note;
}

/* Height of a panel of that width, without the texts above a view. */
static double panel_height(const page *p, const strut_panel *panel, double width) {
  double aspect = p->figure->aspect > 0 ? p->figure->aspect : ASPECT;
  if (panel->height > 0) return panel->height;
  if (!panel->view && !is_chart(panel)) return SCALE_HEIGHT;
  if (!(p->figure->least_width > 0)) return aspect * width;
  return fmax(LOWEST, fmin(aspect * width, HIGHEST));
}

/* Gives the panels from `first` on their boxes in a row at *y; returns the first of the next row. */
static size_t lay_out_row(page *p, size_t first, size_t columns, double *y) {
  const strut_figure *f = p->figure;
  double inner = p->width - 2 * EDGE, head = 0, height = 0, shared = (double)(columns - 1) * f->gap;
  size_t last = first;
  for (; last < f->panel_count && last < first + columns; last++) {
    strut_panel *panel = &p->panels[last];
    bool whole = panel->whole || columns == 1;
    if (panel->whole && last > first) break;
    double width = whole ? inner : (inner - shared) / (double)columns;
    double step = (double)(last - first) * (width + f->gap);
    p->boxes[last] = (strut_box){EDGE + step, *y, width, 0};
    p->heads[last] = head_height(p, panel, width);
    head = fmax(head, p->heads[last]);
    height = fmax(height, panel_height(p, panel, width));
    if (!panel->whole) continue;
    last++;
    break;
  }
  for (size_t i = first; i < last; i++) p->boxes[i].height = height + head, p->heads[i] = head;
  *y += height + head + (p->panels[first].view ? f->gap : 0);
  return last;
}

/* Settles all places on the page, and its height. */
static strut_status lay_out(page *p, strut_error *error) {
  const strut_figure *f = p->figure;
  double inner = p->width - 2 * EDGE, y = 0;
  strut_status status = strut_heading_measure(&p->heading, &y, error);
  if (status) return status;
  y += EDGE;
  double most = f->columns ? (double)f->columns : 3;
  double fits = f->least_width > 0 ? floor((inner + f->gap) / (f->least_width + f->gap)) : 1;
  double columns = fmax(1, fmin(fmin(most, fits), (double)f->panel_count));
  p->legend = strut_key_height(p->ruler, inner - INDENT, p->items, p->item_count);
  p->key = strut_key_height(p->ruler, inner, f->keys, f->key_count);
  y += p->legend > 0 ? p->legend + 2 * BETWEEN : 0;
  for (size_t i = 0; i < f->panel_count;) i = lay_out_row(p, i, (size_t)columns, &y);
  p->height = y + p->key + EDGE;
  return STRUT_OK;
}

static void draw_view_head(const page *p, const strut_panel *panel, strut_box box) {
  const strut_font bold = {.size = 8.5, .bold = true};
  char fitted[STRUT_FITTED_TEXT];
  if (panel->title)
    strut_draw_text(p->canvas, box.x, box.y,
                    strut_text_fit(p->canvas, panel->title, bold, box.width, 0, fitted), bold);
  strut_draw_text(p->canvas, box.x, box.y + (panel->title ? NAME - 1 : 0), panel->note,
                  note_font(box.width));
}

static bool draw_panel(page *p, size_t i) {
  const strut_panel *panel = &p->panels[i];
  strut_box box = p->boxes[i];
  if (!panel->view && is_chart(panel))
    return strut_draw_chart(p->canvas, box, panel, !p->figure->one_legend, &p->arena);
  if (!panel->view) {
    double wide = fmin(170, 0.5 * box.width);
    strut_draw_colour_scale(p->canvas,
                            (strut_box){box.x + box.width - wide, box.y, wide, box.height},
                            &panel->scale);
    return true;
  }
  draw_view_head(p, panel, box);
  box.y += p->heads[i], box.height -= p->heads[i];
  if (panel->scale.name) {
    box.width -= STRUT_SCALE_WIDTH;
    strut_draw_colour_scale(p->canvas,
                            (strut_box){box.x + box.width + 6, box.y, STRUT_SCALE_WIDTH - 6,
                                        fmin(box.height, 130)},
                            &panel->scale);
  }
  return strut_draw_view(p->canvas, box, panel, &p->arena);
}

static bool draw_page(page *p) {
  const strut_figure *f = p->figure;
  double inner = p->width - 2 * EDGE;
  bool fine = true;
  strut_heading_draw(p->canvas, &p->heading);
  if (p->item_count)
    strut_draw_key(p->canvas,
                   (strut_box){EDGE + INDENT, p->boxes[0].y - p->legend - BETWEEN, inner - INDENT,
                               p->legend},
                   p->items, p->item_count);
  for (size_t i = 0; i < f->panel_count && fine; i++) fine = draw_panel(p, i);
  strut_draw_key(p->canvas, (strut_box){EDGE, p->height - EDGE - p->key, inner, p->key}, f->keys,
                 f->key_count);
  return fine;
}

/* Draws a page that is laid out into the plot's file. */
static strut_status write_page(page *p, const strut_plot *plot, strut_error *error) {
  const char *title = p->heading.title ? p->heading.title : "";
  strut_status status =
      strut_canvas_open(plot->path, p->width, p->height, title, &p->canvas, error);
  if (status) return status;
  status =
      draw_page(p) ? strut_canvas_commit(p->canvas, error) : strut_no_memory(error, "while drawing");
  strut_canvas_free(p->canvas);
  return status;
}

/* JSON where the file's name says so. */
static strut_status write_json(const strut_plot *plot, const strut_figure *figure,
                               strut_error *error) {
  char *text = strut_figure_json(plot, figure);
  strut_status status = text ? strut_file_write_path(plot->path, text, error)
                             : strut_no_memory(error, "while drawing");
  strut_release(text);
  return status;
}

strut_status strut_figure_draw(const strut_plot *plot, const strut_figure *figure,
                               strut_error *error) {
  const char *dot = strrchr(plot->path, '.');
  if (dot && strcmp(dot, ".json") == 0) return write_json(plot, figure, error);
  page p = {.figure = figure, .width = plot->width > 0 ? plot->width : PAGE};
  p.heading = (strut_heading){.width = p.width,
                              .edge = EDGE,
                              .title = strut_plot_title(plot, figure->title),
                              .note = figure->note,
                              .alarm = figure->alarm};
  strut_c_locale locale = strut_c_locale_enter();
  strut_status status = strut_canvas_open_pixels(1, 1, 1.0, &p.ruler, error);
  if (!status && !(settle(&p, plot) && gather_legend(&p)))
    status = strut_no_memory(error, "while drawing");
  if (!status) status = lay_out(&p, error);
  if (!status) status = write_page(&p, plot, error);
  strut_canvas_free(p.ruler);
  strut_arena_free(&p.arena);
  strut_c_locale_leave(locale);
  return status;
}
