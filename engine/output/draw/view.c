/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The view of a panel: structures to scale, and lines and marks in their plane. */
#include <math.h>

#include "engine/output/draw/painter.h"

static const double COVERED = 0.22; /* of a view, by names */
static const double DOT = 0.3;      /* a path seen as a dot [pt] */
static const double NODE = 2.5;     /* of a node as drawn [pt] */
enum { TRAIL_SHADES = 64 };

/* True if names cover little of what is seen. */
static bool names_fit(strut_canvas *canvas, const strut_window *window, const strut_panel *view,
                      const strut_model *model) {
  double covered = 0.0, seen = COVERED;
  for (int d = 0; d < 2; d++)
    seen *= (view->bounds.high[d] - view->bounds.low[d]) * window->scale + 2 * view->margin;
  for (int32_t i = 0; i < model->node_count; i++) {
    const strut_box name =
        strut_text_box(canvas, model->scene->nodes[i].name, (strut_font){.size = 7.5});
    covered += name.width * name.height;
  }
  return covered <= seen;
}

/* An arrow ends before the node at its tip; one that is no longer than that is not drawn. */
static void draw_arrow(strut_canvas *canvas, const strut_trail *trail) {
  const double *from = trail->at[0], *to = trail->at[trail->count - 1];
  double x = to[0] - from[0], y = to[1] - from[1], length = hypot(x, y);
  double end = length > 3 * NODE ? NODE / length : 0;
  if (length >= 2 * NODE)
    strut_draw_arrow(canvas, from[0], from[1], to[0] - end * x, to[1] - end * y, 5, trail->pen);
}

/* A path that is no longer than a dot is not drawn. */
static bool is_visible(const strut_trail *trail) {
  const double *at = trail->at[0];
  for (size_t i = 1; i < trail->count; i++)
    if (hypot(trail->at[i][0] - at[0], trail->at[i][1] - at[1]) > DOT) return true;
  return false;
}

/* Its points are on the page. */
static void draw_line(strut_canvas *canvas, const strut_trail *trail) {
  size_t shades = trail->kind == STRUT_TRAIL_SEQUENCE ? TRAIL_SHADES : 1, all = trail->count - 1;
  for (size_t shade = 0; trail->count && is_visible(trail) && shade < shades; shade++) {
    size_t first = shade * all / shades, last = (shade + 1) * all / shades;
    strut_pen pen = trail->pen;
    if (shades > 1)
      pen.colour = strut_palette_at(STRUT_COLOURS_SEQUENTIAL, (double)shade, 0, TRAIL_SHADES - 1);
    if (last > first)
      strut_draw_line(canvas, (const double(*)[2])trail->at + first, last - first + 1, pen);
  }
}

/* Draws trails, whose points go to the page. */
static void draw_trails(strut_canvas *canvas, const strut_window *window, const strut_panel *view) {
  for (strut_trail *trail = view->trails; trail < view->trails + view->trail_count; trail++) {
    for (size_t k = 0; k < trail->count; k++)
      strut_window_point(window, trail->at[k], trail->at[k]);
    (trail->kind == STRUT_TRAIL_ARROW ? draw_arrow : draw_line)(canvas, trail);
  }
}

double strut_view_arrows(const strut_panel *view) {
  double room = 0.0;
  for (size_t i = 0; i < view->shape_count; i++)
    if (view->shapes[i].forces) room = fmax(room, STRUT_ARROW - view->margin);
  return room;
}

void strut_draw_yardstick(strut_canvas *canvas, double left, double bottom, double width,
                          double scale) {
  double length = strut_round_below(0.3 * width / scale);
  double x = left + 3, y = bottom - 4, end = x + length * scale;
  const strut_pen pen = {.colour = strut_grey(0.2), .width = 0.9, .butt = true};
  if (!isfinite(length) || !(length > 0)) return;
  strut_draw_segment(canvas, x, y, end, y, pen);
  strut_draw_segment(canvas, x, y - 2, x, y + 2, pen);
  strut_draw_segment(canvas, end, y - 2, end, y + 2, pen);
  strut_draw_text(canvas, 0.5 * (x + end), y - 2, strut_quantity_of(length, 3, "m").text,
                  (strut_font){.size = 7, .across = 0.5, .down = 1, .halo = strut_grey(1)});
}

strut_window strut_draw_view(strut_canvas *canvas, strut_box box, const strut_panel *view) {
  const strut_shape *end = view->shapes + view->shape_count;
  strut_box inside = box;
  inside.height -= strut_view_arrows(view);
  strut_window window = strut_window_fit(inside, view->bounds, view->margin);
  window.box = box;
  strut_canvas_clip(canvas, box);
  for (const strut_shape *s = view->shapes; s < end; s++)
    if (s->ground) strut_draw_ground(canvas, &window, s);
  for (const strut_shape *s = view->shapes; s < end; s++) strut_draw_shape(canvas, &window, s);
  draw_trails(canvas, &window, view);
  for (size_t i = 0; i < view->mark_count; i++) {
    strut_label mark = view->marks[i];
    strut_window_point(&window, view->marks[i].at, mark.at);
    mark.inside = box;
    strut_draw_label(canvas, &mark);
  }
  strut_canvas_unclip(canvas);
  for (const strut_shape *s = view->shapes; s < end; s++)
    if (s->names && names_fit(canvas, &window, view, s->model))
      strut_draw_names(canvas, &window, s);
  if (view->yardstick)
    strut_draw_yardstick(canvas, box.x, box.y + box.height, box.width, window.scale);
  return window;
}
