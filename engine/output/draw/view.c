/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Views: panels with structures to scale, and what stands below them. */
#include <math.h>
#include <string.h>

#include "engine/output/draw/painter.h"

static const double GAP = 12, LEAST = 46, CAPTION = 26; /* [pt] */
static const double NARROWEST = 98, SMALLEST = 72;      /* panels [pt] */
static const double COVERED = 0.22;                     /* of a view, by names */
static const double TALLEST = 1.2,
                    LOWEST = 0.6; /* of drawings: height over width at most, at least */
static const double DOT = 0.3;    /* a path seen as a dot [pt] */
enum { COLUMNS = 3, SMALL_COLUMNS = 6, TRAIL_SHADES = 64 };

/* ---- one view ---- */

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

/* From a trail's first point to its last, shortened by its gap where there is room: at the tip of an arrow, else at both ends. */
static void draw_straight(strut_canvas *canvas, const strut_trail *trail) {
  bool arrow = trail->kind == STRUT_TRAIL_ARROW;
  const double *from = trail->at[0], *to = trail->at[trail->count - 1];
  double x = to[0] - from[0], y = to[1] - from[1], length = hypot(x, y);
  double end = trail->gap > 0.0 && length > 3.0 * trail->gap ? trail->gap / length : 0.0;
  double start = arrow ? 0.0 : end;
  if (arrow && length >= fmax(2 * trail->gap, 2))
    strut_draw_arrow(canvas, from[0], from[1], to[0] - end * x, to[1] - end * y, 5, trail->pen);
  else if (!arrow)
    strut_draw_segment(canvas, from[0] + start * x, from[1] + start * y, to[0] - end * x,
                       to[1] - end * y, trail->pen);
}

/* A path that is no longer than a dot is not drawn. */
static bool is_visible(const strut_trail *trail) {
  const double *at = trail->at[0];
  for (size_t i = 1; i < trail->count; i++)
    if (hypot(trail->at[i][0] - at[0], trail->at[i][1] - at[1]) > DOT) return true;
  return false;
}

/* Its points are on the page. */
static void draw_trail(strut_canvas *canvas, const strut_trail *trail) {
  size_t shades = trail->kind == STRUT_TRAIL_SEQUENCE ? TRAIL_SHADES : 1, all = trail->count - 1;
  if (trail->kind == STRUT_TRAIL_ARROW || trail->count == 2) {
    draw_straight(canvas, trail);
    return;
  }
  for (size_t shade = 0; trail->count && is_visible(trail) && shade < shades; shade++) {
    size_t first = shade * all / shades, last = (shade + 1) * all / shades;
    strut_pen pen = trail->pen;
    if (shades > 1) pen.colour = strut_palette_sequence((double)shade / (TRAIL_SHADES - 1));
    if (last > first)
      strut_draw_line(canvas, (const double(*)[2])trail->at + first, last - first + 1, pen);
  }
}

/* Draws trails, whose points go to the page. */
static void draw_trails(strut_canvas *canvas, const strut_window *window, const strut_panel *view,
                        bool below) {
  for (strut_trail *trail = view->trails; trail < view->trails + view->trail_count; trail++) {
    if (trail->below != below) continue;
    for (size_t k = 0; k < trail->count; k++)
      strut_window_point(window, trail->at[k], trail->at[k]);
    draw_trail(canvas, trail);
  }
}

/* More than the margin takes below a view, for the forces of the ground [pt]. */
static double room_for_arrows(const strut_panel *view) {
  double room = 0.0;
  for (size_t i = 0; i < view->shape_count; i++)
    if (view->shapes[i].forces) room = fmax(room, view->shapes[i].arrow - view->margin);
  return room;
}

/* A scale bar with its length, such as "20 mm", in the lower left corner of the window's box. */
static void draw_yardstick(strut_canvas *canvas, const strut_window *window) {
  double length = strut_round_below(0.3 * window->box.width / window->scale);
  double x = window->box.x + 3, y = window->box.y + window->box.height - 4,
         end = x + length * window->scale;
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
  inside.height -= room_for_arrows(view);
  strut_window window = strut_window_fit(inside, view->bounds, view->margin);
  window.box = box;
  strut_canvas_clip(canvas, box);
  for (const strut_shape *s = view->shapes; s < end; s++)
    if (s->ground)
      strut_draw_ground(canvas, &window, s->model, s->moving ? s->style.time : (double)NAN);
  draw_trails(canvas, &window, view, true);
  for (const strut_shape *s = view->shapes; s < end; s++) strut_draw_shape(canvas, &window, s);
  draw_trails(canvas, &window, view, false);
  for (size_t i = 0; i < view->mark_count; i++) {
    strut_label mark = view->marks[i];
    strut_window_point(&window, view->marks[i].at, mark.at);
    mark.inside = box;
    strut_draw_label(canvas, &mark);
  }
  strut_canvas_unclip(canvas);
  for (const strut_shape *s = view->shapes; s < end; s++)
    if (s->names && names_fit(canvas, &window, view, s->model))
      strut_draw_names(canvas, &window, s->model, s->q, s->style.member_names);
  if (view->yardstick) draw_yardstick(canvas, &window);
  return window;
}

/* ---- several, in rows ---- */

/* What is written above a view; draws it if `draw`. */
static double write_caption(strut_canvas *canvas, strut_box box, const strut_panel *panel,
                            bool draw) {
  const strut_font bold = {.size = 8.5, .bold = true, .width = box.width, .lines = 2};
  const strut_font grey = {
      .size = panel->small ? 6.5 : 7, .colour = strut_grey(0.3), .width = box.width - 4};
  double title = strut_text_box(canvas, panel->title, bold).height + (panel->title ? 1 : 0);
  double note = strut_text_box(canvas, panel->note, grey).height;
  if (draw) strut_draw_text(canvas, box.x, box.y, panel->title, bold);
  if (draw) strut_draw_text(canvas, box.x, box.y + title, panel->note, grey);
  return title + (note > 0 ? note + 1 : 0);
}

/* How panels are laid out: so many in a row, of this size, the drawing at their foot. */
typedef struct rows {
  size_t columns;
  double width, height, drawing, gap; /* [pt] */
} rows;

/* What the views of several panels have to show. */
typedef struct extent {
  double size[2];       /* [m] */
  double margin, below; /* around it, and more for arrows [pt] */
} extent;

/* The scale in a drawing of that size [pt/m]. */
static double scale_in(const extent *self, double width, double height) {
  return fmin((width - 2 * self->margin) / self->size[0],
              (height - self->below - 2 * self->margin) / self->size[1]);
}

/* As many in a row as there is room for; or, on a page with a given aspect, as make the structures largest. */
static rows arrange(strut_canvas *canvas, double width, const strut_figure *figure,
                    const strut_panel *panels, size_t count) {
  bool small = panels->small, all = small || !(figure->aspect > 0);
  size_t most = small ? SMALL_COLUMNS : figure->columns ? figure->columns : COLUMNS;
  double least = small ? SMALLEST : figure->least_width > 0 ? figure->least_width : NARROWEST;
  double largest = 0, tallest = 0, caption = 0;
  rows best = {.gap = small ? 0.5 * GAP : GAP};
  extent e = {0};
  for (const strut_panel *view = panels; view < panels + count; view++) {
    for (int d = 0; d < 2; d++)
      e.size[d] = fmax(e.size[d], view->bounds.high[d] - view->bounds.low[d]);
    e.margin = fmax(e.margin, view->margin);
    e.below = fmax(e.below, room_for_arrows(view));
  }
  for (size_t columns = 1; columns <= most && columns <= count; columns++) {
    double deep = (double)((count + columns - 1) / columns);
    double cell = (width - (double)(columns - 1) * best.gap) / (double)columns;
    double high = TALLEST * cell;
    if (cell < least && columns > 1) break;
    if (!all) high = fmax(figure->aspect * width / deep - (count > 1 ? CAPTION : 0), LEAST);
    double scale = scale_in(&e, cell, high);
    if (scale < largest * (1 - 1e-9) && !all) continue; /* of equal scales the fewest rows win */
    largest = scale, tallest = high;
    best.columns = columns, best.width = cell;
  }
  tallest = fmax(tallest, LOWEST * best.width);
  double scale = scale_in(&e, best.width, tallest);
  best.drawing = isfinite(scale) ? scale * e.size[1] + 2 * e.margin + e.below : tallest;
  best.drawing = panels->height > 0 ? panels->height : fmax(best.drawing, LEAST);
  for (size_t i = 0; i < count; i++)
    caption =
        fmax(caption, write_caption(canvas, (strut_box){0, 0, best.width, 0}, &panels[i], false));
  best.height = caption + best.drawing;
  return best;
}

/* ---- below ---- */

static const double STICK = 17, BAR_WIDTH = 150; /* [pt] */

double strut_draw_foot(strut_canvas *canvas, strut_box box, const strut_figure *figure,
                       const strut_window *window, bool draw) {
  bool bar = figure->scale.name && figure->scale.high > figure->scale.low;
  bool stick = window && figure->yardstick;
  double row = bar     ? STRUT_SCALE_HEIGHT
               : stick ? STICK
                       : 0,
         right = fmin(BAR_WIDTH, 0.5 * box.width);
  strut_box key = strut_draw_key(canvas, box, figure->keys, figure->key_count, draw);
  bool beside = !stick && key.width + right < box.width;
  double height = beside ? fmax(key.height, row) : key.height + row;
  if (draw && bar)
    strut_draw_colour_scale(
        canvas, (strut_box){box.x + box.width - right, box.y + height - row, right, row},
        &figure->scale);
  if (draw && stick) {
    strut_window at = *window;
    at.box.x = box.x, at.box.y = box.y + height - at.box.height;
    draw_yardstick(canvas, &at);
  }
  return height;
}

double strut_draw_views(strut_canvas *canvas, strut_box box, const strut_figure *figure,
                        const strut_panel *panels, size_t count, bool foot, bool draw) {
  rows r = arrange(canvas, box.width, figure, panels, count);
  strut_window window = {.box.width = r.width};
  double height = (double)((count + r.columns - 1) / r.columns) * (r.height + r.gap) - r.gap;
  for (size_t i = 0; i < count && draw; i++) {
    strut_box cell = {box.x + (double)(i % r.columns) * (r.width + r.gap),
                      box.y + (double)(i / r.columns) * (r.height + r.gap), r.width, r.height};
    write_caption(canvas, cell, &panels[i], true);
    cell.y += r.height - r.drawing, cell.height = r.drawing;
    window = strut_draw_view(canvas, cell, &panels[i]);
  }
  box.y += height + 0.5 * GAP;
  return foot ? height + 0.5 * GAP + strut_draw_foot(canvas, box, figure, &window, draw) : height;
}
